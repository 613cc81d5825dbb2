//! A graph holds exactly the voxels that were pushed, however it was made.

use std::collections::BTreeMap;

use proptest::prelude::*;
use shiftvox::graph::{BuildError, Builder, Graph, LinkedGraph, PackedNormal, Silent, Voxel};
use shiftvox::split_mix::SplitMix;

use crate::normals::solid;
use crate::{PLACE, at, build, parts, voxels};

/// Colour and normal of each index, found by walking.
fn seen(graph: &Graph) -> BTreeMap<[i64; 3], ([u8; 3], PackedNormal)> {
    let mut seen = BTreeMap::new();
    for cell in graph.voxels() {
        assert_eq!(cell.level, graph.depth);
        let attributes = (graph.color_of(cell.node), graph.normal_of(cell.node));
        assert!(seen.insert(graph.file_index(&cell), attributes).is_none());
    }
    seen
}

/// Corner, level and colour of each cell, in order.
fn cells(graph: &Graph) -> Vec<([i32; 3], u32, [u8; 3])> {
    let cells = graph.voxels();
    { cells }
        .map(|c| (c.corner, c.level, graph.color_of(c.node)))
        .collect()
}

fn last_by_index(voxels: &[Voxel]) -> BTreeMap<[i64; 3], Voxel> {
    let by_index = voxels.iter().map(|v| (v.index.map(i64::from), *v));
    by_index.collect()
}

/// Every node is at the place where a walk meets it.
fn check_places(graph: &Graph) {
    let mut met = 0;
    let mut stack = vec![(graph.root, [0i32; 3], 0u32)];
    while let Some((node, corner, level)) = stack.pop() {
        let [x, y, z] = corner;
        assert_eq!(graph.place_of(node), Some([x, y, z, level as i32]));
        met += 1;
        for (octant, child) in graph.children(node).into_iter().enumerate() {
            let side = 1 << (graph.depth - level - u32::from(child.is_some()));
            let along = [0, 1, 2].map(|k| corner[k] + side * (octant as i32 >> (2 - k) & 1));
            stack.extend(child.map(|child| (child, along, level + 1)));
        }
    }
    assert_eq!(met, graph.len());
    let beyond = [graph.len() as u32, u32::MAX].map(|node| graph.place_of(node));
    assert_eq!(beyond, [None; 2]);
}

proptest! {
    /// Every voxel is at its place and no other, the last one pushed there, with its own normal if it has one; cells come in
    /// Morton order, in a tight box.
    #[test]
    fn a_graph_holds_its_voxels(voxels in voxels(200)) {
        let all = last_by_index(&voxels);
        let graph = build(&voxels);
        let seen = seen(&graph);
        prop_assert_eq!(graph.voxels, all.len() as u64);
        prop_assert!(seen.keys().eq(all.keys()));
        for (index, (color, normal)) in seen {
            let given = all[&index];
            prop_assert_eq!(color, given.color);
            prop_assert!(given.normal.is_none_or(|own| own == normal));
        }
        check_places(&graph);
        // Octants from the root down, as the order defines.
        let octant = |corner: [i32; 3], b: u32| {
            (corner[0] >> b & 1) << 2 | (corner[1] >> b & 1) << 1 | (corner[2] >> b & 1)
        };
        let path = |corner| (0..graph.depth).rev().map(|b| octant(corner, b)).collect::<Vec<_>>();
        prop_assert!(graph.voxels().map(|cell| path(cell.corner)).is_sorted());
        let mut longest = 0;
        for axis in 0..3 {
            let along = || all.keys().map(|index| index[axis]);
            let (low, high) = (along().min().unwrap(), along().max().unwrap());
            prop_assert_eq!(graph.placement.origin_index[axis], low);
            longest = longest.max(high - low + 1);
        }
        prop_assert!(1i64 << graph.depth >= longest);
        prop_assert!(graph.depth == 0 || 1i64 << (graph.depth - 1) < longest);
    }

    #[test]
    fn the_order_of_pushing_and_threads_do_not_matter(voxels in voxels(200), seed in any::<u64>()) {
        let unique: Vec<Voxel> = last_by_index(&voxels).into_values().collect();
        let mut shuffled = unique.clone();
        let mut dice = SplitMix::new(seed);
        for i in (1..shuffled.len()).rev() {
            shuffled.swap(i, dice.below(i as u64 + 1) as usize);
        }
        let plain = parts(&build(&unique));
        prop_assert_eq!(&parts(&build(&shuffled)), &plain);
        prop_assert_eq!(&parts(&build(&voxels)), &plain);
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            prop_assert_eq!(&pool.install(|| parts(&build(&unique))), &plain);
        }
    }

}

#[test]
fn boxes_of_one_voxel_and_of_the_longest_side() {
    let one = build(&[at([i32::MIN, 7, i32::MAX])]);
    assert_eq!((one.depth, one.len(), one.mask.len()), (0, 1, 0));
    assert_eq!(
        one.placement.origin_index,
        [i64::from(i32::MIN), 7, i64::from(i32::MAX)]
    );
    let far = (1 << 21) - 1;
    let graph = build(&[at([-5, 0, 0]), at([far - 5, 0, 3])]);
    assert_eq!((graph.depth, graph.voxels), (21, 2));
    let refused = |voxels: &[Voxel], place| {
        let mut builder = Builder::default();
        voxels.iter().for_each(|&voxel| builder.push(voxel));
        builder.finish(place, &Silent).unwrap_err()
    };
    let (axis, extent) = ('z', (1 << 21) + 1);
    let wide = refused(&[at([0, 0, -1]), at([0, 0, far])], PLACE);
    assert_eq!(wide, BuildError::TooLarge { axis, extent });
    assert_eq!(refused(&[], PLACE), BuildError::Empty);
    let flat = refused(&[at([0; 3])], ([0.0; 3], 0.0));
    assert_eq!(flat, BuildError::Placement);
}

/// Random graphs, some of them cyclic, have the same cells and colours when their lists lie side by side. A node is where
/// `links` had it.
#[test]
fn cyclic_graphs_side_by_side_are_the_same_object() {
    for seed in 1..60u64 {
        let mut dice = SplitMix::new(seed);
        let mut below = |most: u64| dice.below(most);
        let nodes = 1 + below(7) as u32;
        let mut linked = LinkedGraph::new(3);
        for node in 0..nodes {
            let children =
                std::array::from_fn(|_| (below(3) == 0).then(|| below(u64::from(nodes)) as u32));
            linked.add_node([node as u8 / 2, 0, 0], children);
        }
        let linked = linked.build().unwrap();
        let laid_out = linked.side_by_side().unwrap();
        laid_out.validate().unwrap();
        assert_eq!(cells(&laid_out), cells(&linked));
        // Solid leaves fill their cube: the count is of finest voxels.
        let finest = cells(&laid_out)
            .iter()
            .map(|(_, level, _)| 1 << (3 * (3 - level)))
            .sum();
        assert_eq!((laid_out.voxels, linked.voxels), (finest, finest));
        assert_eq!(laid_out.len(), 1 + linked.links.len());
        for (expected, found) in linked.voxels().zip(laid_out.voxels()) {
            let node = match found.node as usize {
                0 => linked.root,
                at => linked.links[at - 1],
            };
            assert_eq!(node, expected.node);
        }
    }
}

#[test]
fn impossible_links_are_refused() {
    let refused = |graph: &LinkedGraph| graph.build().unwrap_err().array;
    let mut graph = LinkedGraph::new(2);
    assert_eq!(refused(&graph), "color");
    graph.add_node([0; 3], [None, Some(1), None, None, None, None, None, None]);
    assert_eq!(refused(&graph), "links");
    assert_eq!(graph.add_node([0; 3], [None; 8]), 1);
    assert!(graph.build().is_ok());
    let mut deep = LinkedGraph::new(31);
    deep.add_node([0; 3], [None; 8]);
    assert_eq!(refused(&deep), "depth");
}

/// Each way to break a graph, and the array that `validate` must name.
#[test]
fn validate_names_what_is_broken() {
    type Break = fn(&mut Graph);
    fn first(graph: &mut Graph, change: impl Fn(&mut Vec<u32>)) {
        let mut entries = graph.first.to_vec();
        change(&mut entries);
        graph.first = entries.into();
    }
    fn mask(graph: &mut Graph, change: impl Fn(&mut Vec<u8>)) {
        let mut entries = graph.mask.to_vec();
        change(&mut entries);
        graph.mask = entries.into();
    }
    let tree = build(&solid(6, |p| p.x + p.y < 6.0));
    let breaks: [(&str, Break); 20] = [
        ("depth", |g| g.depth = 31),
        ("root", |g| g.root = g.len() as u32),
        ("normal", |g| g.normal = g.normal[1..].to_vec().into()),
        ("color", |g| g.color = Vec::new().into()),
        ("opacity", |g| g.opacity = vec![Default::default()].into()),
        ("voxels", |g| g.voxels += 1),
        ("voxel_size", |g| g.placement.voxel_size = f64::NAN),
        ("voxel_size", |g| g.placement.voxel_size = 5e-324),
        ("world_origin", |g| g.placement.world_origin[1] = 1e16),
        ("world_origin", |g| g.placement.world_origin[2] = f64::NAN),
        ("placement", |g| g.placement.origin_index[1] = i64::MIN),
        ("level_start", |g| g.level_start[1] = 2),
        ("level_start", |g| *g.level_start.last_mut().unwrap() += 1),
        ("level_start", |g| g.level_start.truncate(2)),
        ("first", |g| first(g, |entries| entries[1] = u32::MAX)),
        ("first", |g| first(g, |entries| entries[0] += 1)),
        ("first", |g| first(g, |entries| entries.push(1))),
        ("first", |g| first(g, |entries| entries.truncate(2))),
        ("mask", |g| {
            first(g, |entries| entries.push(0));
            mask(g, |masks| masks.push(0));
        }),
        ("mask", |g| g.mask = vec![0; g.len() + 1].into()),
    ];
    for (i, (array, change)) in breaks.iter().enumerate() {
        let mut broken = tree.clone();
        change(&mut broken);
        let invalid = broken.validate().expect_err(array);
        assert_eq!(invalid.array, *array, "change {i}: {invalid}");
    }
    // A child less: in a tree, the list of the node after it begins too late.
    let mut broken = tree.clone();
    mask(&mut broken, |masks| masks[1] &= masks[1] - 1);
    let invalid = broken.validate().unwrap_err();
    assert_eq!((invalid.array, invalid.index), ("first", 2));
    let mut broken = LinkedGraph::new(2);
    broken.add_node([0; 3], [Some(0); 8]);
    let mut broken = broken.build().unwrap();
    broken.links = vec![1; 8].into();
    assert_eq!(broken.validate().unwrap_err().array, "links");
}
