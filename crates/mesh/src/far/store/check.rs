//! Whether a hierarchy makes sense: every field of every node.

use crate::far::record::{MOST_COLORS, Node};

/// Checks all nodes against each other and against the sizes of the sections. Errors: node, expected value.
pub(super) fn check(
    nodes: &[Node],
    data_bytes: u64,
    triangles: u64,
) -> Result<(), (usize, String)> {
    let fault = |node: usize, expected: String| Err((node, expected));
    let is_root = |n: &Node| {
        [u32::from(n.level), n.first_triangle] == [0; 2] && u64::from(n.triangles) == triangles
    };
    if !nodes.first().is_some_and(is_root) {
        return fault(0, format!("a root with all {triangles} triangles"));
    }
    let mut has_parent = vec![false; nodes.len()];
    has_parent[0] = true;
    let (mut before, mut numbered) = (0u64, 0u64);
    for (i, node) in nodes.iter().enumerate() {
        check_alone(node).or_else(|expected| fault(i, expected.to_owned()))?;
        if node.data_at < before || node.data_at > data_bytes || i == 0 && node.data_at > 0 {
            let range = format!("data from byte {before} to {data_bytes} of its section");
            return fault(i, range);
        }
        before = node.data_at;
        numbered += node.voxels() + u64::from(node.surface);
        if !has_parent[i] {
            return fault(i, "a parent before it".to_owned());
        }
        if node.is_leaf() {
            continue;
        }
        check_children(nodes, i).or_else(|expected| fault(i, expected.to_owned()))?;
        for child in node.below() {
            if std::mem::replace(&mut has_parent[child], true) {
                return fault(child, "one parent, not two".to_owned());
            }
        }
    }
    if numbered >= u64::from(u32::MAX) {
        return fault(0, "fewer than 2^32 voxels and triangles".to_owned());
    }
    Ok(())
}

fn check_alone(node: &Node) -> Result<(), &'static str> {
    let is_box = (0..3).all(|k| {
        let (low, high) = (node.low[k], node.high[k]);
        low.is_finite() && high.is_finite() && low <= high
    });
    let vertices: u64 = node.vertices.iter().map(|&n| u64::from(n)).sum();
    let is_surface = node.surface <= node.triangles && vertices <= 3 * u64::from(node.surface);
    let has_colors = usize::from(node.colors) <= MOST_COLORS && node.is_flat <= 1;
    let has_colors = has_colors && node.is_painted <= 1;
    let leaf = node.children == [0; 2] && node.surface == node.triangles;
    let has_no_grid = node.origin == [0.0; 3] && node.voxel == 0.0 && node.cells == [0; 3];
    let without_grid = node.is_leaf() || has_no_grid;
    let counts = [
        node.touched,
        node.untested,
        node.rays,
        node.hits,
        node.crossings,
    ];
    let is_empty = counts == [0; 5] && node.counts == [0; 6];
    let is_grid = node.voxel > 0.0
        && node.voxel.is_finite()
        && node.origin.iter().all(|c| c.is_finite())
        && node.cells.iter().all(|&c| c > 0);
    let cells: u64 = node.cells.iter().map(|&c| u64::from(c)).product();
    let touched = u64::from(node.touched);
    let is_counted = u64::from(node.untested) <= node.voxels() && node.voxels() <= touched;
    let rules = [
        (node.is_leaf <= 1, "a leaf or not, 1 or 0"),
        (node.triangles > 0, "triangles"),
        (is_box, "a box of finite numbers"),
        (
            node.error.is_finite() && node.error >= 0.0,
            "an error of 0 or more",
        ),
        (
            is_surface,
            "no more triangles than it has, of three vertices each",
        ),
        (
            has_colors,
            "at most 256 colours, flat triangles or not, and paint or not",
        ),
        (
            !node.is_leaf() || leaf,
            "all of a leaf's triangles, and no children",
        ),
        (
            !without_grid || has_no_grid && is_empty,
            "no voxels or rays without a grid",
        ),
        (
            !has_no_grid || node.is_leaf() || node.surface == 0,
            "no surface without a grid",
        ),
        (without_grid || is_grid, "a grid"),
        (
            without_grid && node.across == 0 || !without_grid && (2..=4).contains(&node.across),
            "2 to 4 half voxels across a pixel, or 0 without a grid",
        ),
        (
            without_grid || is_counted && touched <= cells,
            "no more voxels than triangles touch, of those that its grid has",
        ),
        (node.hits <= node.rays, "no more hits than rays"),
    ];
    let broken = rules.into_iter().find(|(holds, _)| !holds);
    broken.map_or(Ok(()), |(_, expected)| Err(expected))
}

fn check_children(nodes: &[Node], number: usize) -> Result<(), &'static str> {
    let node = &nodes[number];
    let [near, far] = node.children.map(|child| child as usize);
    let is_alone = far == 0;
    if near != number + 1 || near >= nodes.len() || !is_alone && (far <= near || far >= nodes.len())
    {
        return Err("its first child after it and its second after that");
    }
    let mut next = u64::from(node.first_triangle);
    for child in node.below().map(|child| &nodes[child]) {
        if u64::from(child.first_triangle) != next {
            return Err("children that share its triangles");
        }
        next += u64::from(child.triangles);
        if Some(child.level) != node.level.checked_add(1) {
            return Err("children one level below");
        }
    }
    if next != u64::from(node.first_triangle) + u64::from(node.triangles) {
        return Err("children that share its triangles");
    }
    Ok(())
}
