//! A graph holds exactly the voxels that were pushed, however it was made.

use std::collections::BTreeMap;

use glam::DVec3;
use proptest::prelude::*;
use shiftvox::graph::{
    BuildError, BuildOptions, Builder, Graph, LinkedGraph, MergeBy, Normals, PackedNormal, Silent,
    Voxel, merge,
};

use shiftvox::split_mix::SplitMix;

use crate::{parts, voxels};

const PLACE: ([f64; 3], f64) = ([0.0; 3], 1.0);

fn build_with(normals: Normals, voxels: &[Voxel]) -> Graph {
    let mut builder = Builder::new(BuildOptions { normals });
    builder.extend(voxels.iter().copied());
    let graph = builder.finish(PLACE, &Silent).unwrap();
    graph.validate().unwrap();
    graph
}

fn build(voxels: &[Voxel]) -> Graph {
    build_with(Normals::FromSurface, voxels)
}

fn at(index: [i32; 3]) -> Voxel {
    Voxel {
        index,
        color: [200, 100, 50],
        normal: None,
    }
}

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

fn last_by_index(voxels: &[Voxel]) -> BTreeMap<[i64; 3], Voxel> {
    voxels
        .iter()
        .map(|v| (v.index.map(i64::from), *v))
        .collect()
}

proptest! {
    /// Every voxel is at its place and no other, the last one pushed there, with its own normal if it has one; cells come in
    /// Morton order, in a tight box.
    #[test]
    fn a_graph_holds_its_voxels(voxels in voxels(200)) {
        let all = last_by_index(&voxels);
        let graph = build_with(Normals::None, &voxels);
        let shown = |v: &Voxel| (v.color, v.normal.unwrap_or_default());
        let expected: BTreeMap<_, _> = all.iter().map(|(index, v)| (*index, shown(v))).collect();
        prop_assert_eq!(graph.voxels, expected.len() as u64);
        prop_assert_eq!(seen(&graph), expected);
        let with_normals = build(&voxels);
        for (index, (_, normal)) in seen(&with_normals) {
            prop_assert!(all[&index].normal.is_none_or(|own| own == normal));
        }
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

    #[test]
    fn merging_changes_nothing_seen(voxels in voxels(200)) {
        let graph = build(&voxels);
        let (merged, report) = merge(&graph, MergeBy::ShapeAndAttributes, &Silent);
        merged.validate().unwrap();
        prop_assert_eq!(seen(&merged), seen(&graph));
        prop_assert_eq!(merged.nodes_per_level().iter().sum::<u64>(), report.nodes_after);
        prop_assert!(report.nodes_after <= report.nodes_before);
        // Merging again finds nothing more, and the general way finds the same.
        let (again, _) = merge(&merged, MergeBy::ShapeAndAttributes, &Silent);
        prop_assert_eq!(parts(&again), parts(&merged));
        let mut unordered = graph.clone();
        unordered.level_start.clear();
        let (general, _) = merge(&unordered, MergeBy::ShapeAndAttributes, &Silent);
        let (shape, _) = merge(&graph, MergeBy::Shape, &Silent);
        general.validate().unwrap();
        shape.validate().unwrap();
        prop_assert_eq!(seen(&general), seen(&graph));
        prop_assert!(general.len() <= merged.len() && shape.len() <= merged.len());
        prop_assert!(seen(&shape).keys().eq(seen(&graph).keys()));
    }
}

#[test]
fn averages_are_over_finest_voxels_in_linear_light() {
    // Three white voxels in one octant, one black in another: 3/4 of the light.
    let white = [[0, 0, 0], [0, 0, 1], [0, 1, 0]];
    let mut voxels: Vec<Voxel> = white
        .map(|index| Voxel {
            index,
            color: [255; 3],
            normal: Some(PackedNormal::encode(DVec3::X)),
        })
        .to_vec();
    voxels.push(Voxel {
        index: [3, 3, 3],
        color: [0; 3],
        normal: Some(PackedNormal::encode(DVec3::Y)),
    });
    let graph = build(&voxels);
    assert_eq!(graph.level_start, [0, 1, 3, 7]);
    // 0.75 encodes to 0.88 of 255.
    assert_eq!(graph.color_of(0), [225; 3]);
    let normal = graph.normal_of(0).decode().unwrap();
    assert!(normal.dot(DVec3::new(3.0, 1.0, 0.0).normalize()) > 0.999);
    assert_eq!(graph.color_of(1), [255; 3]);
    assert_eq!(graph.color_of(2), [0; 3]);
}

#[test]
fn one_voxel_is_a_root_without_children() {
    let graph = build(&[at([i32::MIN, 7, i32::MAX])]);
    assert_eq!((graph.depth, graph.len(), graph.voxels), (0, 1, 1));
    assert!(graph.mask.is_empty() && graph.first.is_empty());
    assert_eq!(
        graph.placement.origin_index,
        [i64::from(i32::MIN), 7, i64::from(i32::MAX)]
    );
    assert_eq!(graph.voxels().count(), 1);
    let (merged, _) = merge(&graph, MergeBy::ShapeAndAttributes, &Silent);
    merged.validate().unwrap();
    assert_eq!(seen(&merged), seen(&graph));
}

#[test]
fn the_longest_box_is_built_and_a_longer_one_is_refused() {
    let far = (1 << 21) - 1;
    let graph = build(&[at([-5, 0, 0]), at([far - 5, 0, 3])]);
    assert_eq!(graph.depth, 21);
    assert_eq!(graph.voxels, 2);

    let mut builder = Builder::new(BuildOptions::default());
    builder.extend([at([0, 0, -1]), at([0, 0, far])]);
    let refused = builder.finish(PLACE, &Silent).unwrap_err();
    assert_eq!(
        refused,
        BuildError::TooLarge {
            axis: 'z',
            extent: (1 << 21) + 1
        }
    );

    let empty = Builder::new(BuildOptions::default()).finish(PLACE, &Silent);
    assert_eq!(empty.unwrap_err(), BuildError::Empty);
    let mut builder = Builder::new(BuildOptions::default());
    builder.push(at([0; 3]));
    assert_eq!(
        builder.finish(([0.0; 3], 0.0), &Silent).unwrap_err(),
        BuildError::Placement
    );
}

/// All indices of a cube for which a test holds.
fn solid(side: i32, inside: impl Fn(DVec3) -> bool) -> Vec<Voxel> {
    let mut voxels = Vec::new();
    for i in 0..side * side * side {
        let index = [i / side / side, i / side % side, i % side];
        if inside(DVec3::from_array(index.map(|c| f64::from(c) + 0.5))) {
            voxels.push(at(index));
        }
    }
    voxels
}

#[test]
fn normals_of_a_ball_point_outwards() {
    let middle = DVec3::splat(25.0);
    let distance = |p: DVec3| (p - middle).length();
    let ball = solid(50, |p| distance(p) < 22.0);
    let shell = solid(50, |p| (21.0..22.0).contains(&distance(p)));
    for (name, voxels, mean_limit, worst_limit) in
        [("ball", ball, 4.0, 12.0), ("shell", shell, 4.0, 40.0)]
    {
        let graph = build(&voxels);
        let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0.0);
        for cell in graph.voxels() {
            let index = graph.file_index(&cell).map(|c| c as f64 + 0.5);
            let outward = DVec3::from_array(index) - middle;
            if outward.length() < 21.0 {
                continue;
            }
            // Voxels that cannot be seen have none.
            let Some(normal) = graph.normal_of(cell.node).decode() else {
                continue;
            };
            let degrees = libm::acos(normal.dot(outward.normalize()).min(1.0)).to_degrees();
            sum += degrees;
            count += 1.0;
            worst = worst.max(degrees);
        }
        assert!(count > 4500.0, "{name}: only {count} normals");
        assert!(sum / count < mean_limit, "{name}: mean {}", sum / count);
        assert!(worst < worst_limit, "{name}: worst {worst}");
    }
}

#[test]
fn normals_of_faces_walls_and_edges() {
    // A block: faces, an edge, a corner, and nothing inside.
    let block = build(&solid(12, |_| true));
    let normal = |graph: &Graph, index: [i64; 3]| seen(graph)[&index].1.decode();
    assert_eq!(normal(&block, [0, 6, 6]), Some(DVec3::NEG_X));
    assert_eq!(normal(&block, [6, 11, 6]), Some(DVec3::Y));
    assert_eq!(normal(&block, [6, 6, 6]), None);
    let corner = normal(&block, [11, 11, 11]).unwrap();
    assert!(corner.dot(DVec3::ONE.normalize()) > 0.999);
    // A concave edge.
    let step = build(&solid(12, |p| p.x < 6.0 || p.z < 6.0));
    let concave = normal(&step, [5, 6, 6]).unwrap();
    assert!(
        concave.x > 0.5 && concave.z > 0.1 && concave.y == 0.0,
        "{concave}"
    );
    // A wall one voxel thick has the normal of its plane, slanted ones too.
    let wall = build(&solid(16, |p| p.z < 1.0));
    assert_eq!(normal(&wall, [8, 8, 0]).map(|n| n.abs()), Some(DVec3::Z));
    let plane = DVec3::new(1.0, 2.0, 4.0);
    let slanted = build(&solid(32, |p| (p.dot(plane) / 4.0 - 24.0).abs() <= 0.5));
    for (index, (_, normal)) in seen(&slanted) {
        if index.iter().all(|&c| (3..29).contains(&c)) {
            let likeness = normal.decode().unwrap().dot(plane.normalize()).abs();
            assert!(likeness > 0.97, "{index:?}: {likeness}");
        }
    }
    // A voxel alone has none.
    let lone = build(&[at([0, 0, 0]), at([100, 0, 0])]);
    assert!(seen(&lone).values().all(|(_, normal)| normal.is_none()));
}

#[test]
fn normals_are_the_same_wherever_the_object_lies() {
    // Clusters fall differently over the object as it moves by a voxel.
    let ball = solid(21, |p| (p - DVec3::splat(10.0)).length() < 9.3);
    let plain = build(&ball);
    for shift in 1..4 {
        // A stray voxel fixes the box, far enough away to have no say.
        let mut moved: Vec<Voxel> = ball.clone();
        moved.push(at([-8 - shift, -8, -8]));
        let graph = build(&moved);
        let moved = seen(&graph);
        for (index, (_, normal)) in seen(&plain) {
            let (a, b) = (normal.decode(), moved[&index].1.decode());
            match (a, b) {
                (Some(a), Some(b)) => assert!(a.dot(b) > 0.95, "{index:?}: {a} {b}"),
                _ => assert_eq!(a, b, "{index:?}"),
            }
        }
    }
}

fn sierpinski(depth: u32) -> Graph {
    let mut graph = LinkedGraph::new(depth);
    let own = Some(0);
    graph.add_node([9, 8, 7], [own, None, None, own, None, own, own, None]);
    let graph = graph.build().unwrap();
    graph.validate().unwrap();
    graph
}

#[test]
fn a_sierpinski_tetrahedron_is_one_node() {
    let graph = sierpinski(4);
    assert_eq!((graph.len(), graph.voxels), (1, 256));
    let cells: Vec<_> = graph.voxels().collect();
    assert_eq!(cells.len(), 256);
    for cell in cells {
        // Its voxels have an even number of ones in each bit of x, y, z.
        assert_eq!(cell.corner[0] ^ cell.corner[1] ^ cell.corner[2], 0);
    }
    assert_eq!(graph.nodes_per_level(), [1; 5]);
    assert_eq!(sierpinski(30).voxels, 1 << 60);
    assert_eq!(sierpinski(30).voxels().take(1000).count(), 1000);
}

/// Random graphs, some of them cyclic, have the same cells and colours when their lists lie side by side. A node is
/// where `links` had it.
#[test]
fn lists_side_by_side_are_the_same_object() {
    for seed in 1..60u64 {
        let mut dice = SplitMix::new(seed);
        let mut below = |most: u64| dice.below(most);
        let nodes = 1 + below(7) as u32;
        let mut linked = LinkedGraph::new(3);
        for node in 0..nodes {
            let children =
                std::array::from_fn(|_| (below(3) == 0).then(|| below(u64::from(nodes)) as u32));
            linked.add_node([node as u8, 0, 0], children);
        }
        let linked = linked.build().unwrap();
        let laid_out = linked.side_by_side().unwrap();
        laid_out.validate().unwrap();
        assert_eq!(laid_out.len(), 1 + linked.links.len());
        assert_eq!(laid_out.voxels, linked.voxels);
        assert_eq!(laid_out.voxels().count(), linked.voxels().count());
        for (expected, found) in linked.voxels().zip(laid_out.voxels()) {
            assert_eq!(
                (found.corner, found.level),
                (expected.corner, expected.level)
            );
            let node = match found.node as usize {
                0 => linked.root,
                at => linked.links[at - 1],
            };
            assert_eq!(node, expected.node);
            assert_eq!(laid_out.color_of(found.node), linked.color_of(node));
        }
    }
}

#[test]
fn equal_nodes_of_cyclic_graphs_merge() {
    // Two nodes that take turns, with equal colours: one node would do.
    let mut graph = LinkedGraph::new(6);
    graph.add_node(
        [1; 3],
        [Some(1), None, None, Some(1), None, None, None, Some(2)],
    );
    graph.add_node(
        [1; 3],
        [Some(0), None, None, Some(0), None, None, None, Some(2)],
    );
    graph.add_node([5; 3], [None; 8]);
    let graph = graph.build().unwrap();
    graph.validate().unwrap();
    let (merged, report) = merge(&graph, MergeBy::ShapeAndAttributes, &Silent);
    merged.validate().unwrap();
    assert_eq!((report.nodes_before, report.nodes_after), (3, 2));
    let corners = |graph: &Graph| -> Vec<_> {
        graph
            .voxels()
            .map(|c| (c.corner, c.level, graph.color_of(c.node)))
            .collect()
    };
    assert_eq!(corners(&merged), corners(&graph));
    // Solid leaves fill their cube: the count is of finest voxels.
    assert_eq!(merged.voxels, graph.voxels);
    let finest: u64 = graph
        .voxels()
        .map(|c| 1 << (3 * (graph.depth - c.level)))
        .sum();
    assert_eq!(finest, graph.voxels);
}

#[test]
fn a_full_cube_merges_to_a_node_a_level() {
    let graph = build_with(Normals::None, &solid(16, |_| true));
    let (merged, report) = merge(&graph, MergeBy::ShapeAndAttributes, &Silent);
    merged.validate().unwrap();
    assert_eq!(report.nodes_after, 5);
    assert_eq!(merged.level_start, [0, 1, 2, 3, 4, 5]);
    assert_eq!(merged.voxels, 4096);
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
    let (dag, _) = merge(&tree, MergeBy::Shape, &Silent);
    let breaks: [(&str, Break); 16] = [
        ("depth", |g| g.depth = 31),
        ("root", |g| g.root = g.len() as u32),
        ("normal", |g| g.normal = g.normal[1..].to_vec().into()),
        ("color", |g| g.color = Vec::new().into()),
        ("voxels", |g| g.voxels += 1),
        ("voxel_size", |g| g.placement.voxel_size = f64::NAN),
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
    for graph in [&tree, &dag] {
        for (i, (array, change)) in breaks.iter().enumerate() {
            let mut broken = graph.clone();
            change(&mut broken);
            let invalid = broken
                .validate()
                .expect_err(&format!("change {i} of {array}"));
            assert_eq!(invalid.array, *array, "change {i}: {invalid}");
        }
    }
    // A child less: in a tree, the list of the node after it begins too late.
    let mut broken = tree.clone();
    mask(&mut broken, |masks| masks[1] &= masks[1] - 1);
    let invalid = broken.validate().unwrap_err();
    assert_eq!((invalid.array, invalid.index), ("first", 2));
    let mut broken = dag.clone();
    let mut links = dag.links.to_vec();
    links[3] = dag.len() as u32;
    broken.links = links.into();
    assert_eq!(broken.validate().unwrap_err().array, "links");
}
