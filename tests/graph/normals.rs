//! Normals that are estimated, and averages.

use std::collections::BTreeMap;

use glam::DVec3;
use shiftvox::graph::{Graph, PackedNormal, Voxel};

use crate::{at, build};

/// All indices of a cube for which a test holds.
pub(crate) fn solid(side: i32, inside: impl Fn(DVec3) -> bool) -> Vec<Voxel> {
    let index = |i| [i / side / side, i / side % side, i % side];
    let middle = |index: [i32; 3]| DVec3::from_array(index.map(|c| f64::from(c) + 0.5));
    let all = (0..side * side * side).map(index);
    all.filter(|&index| inside(middle(index))).map(at).collect()
}

fn normals(graph: &Graph) -> BTreeMap<[i64; 3], Option<DVec3>> {
    let normal = |node| graph.normal_of(node).decode();
    let voxels = graph.voxels();
    { voxels }
        .map(|cell| (graph.file_index(&cell), normal(cell.node)))
        .collect()
}

#[test]
fn averages_are_over_finest_voxels_in_linear_light() {
    // Three white voxels in one octant, one black in another: 3/4 of the light.
    let voxel = |index, color, normal| Voxel {
        index,
        color,
        normal: Some(PackedNormal::encode(normal)),
    };
    let white = [[0, 0, 0], [0, 0, 1], [0, 1, 0]].map(|index| voxel(index, [255; 3], DVec3::X));
    let graph = build(&[&white[..], &[voxel([3; 3], [0; 3], DVec3::Y)]].concat());
    assert_eq!(graph.level_start, [0, 1, 3, 7]);
    // 0.75 encodes to 0.88 of 255.
    assert_eq!([0, 1, 2].map(|node| graph.color_of(node)[0]), [225, 255, 0]);
    let normal = graph.normal_of(0).decode().unwrap();
    assert!(normal.dot(DVec3::new(3.0, 1.0, 0.0).normalize()) > 0.999);
}

#[test]
fn normals_of_a_ball_point_outwards() {
    let middle = DVec3::splat(25.0);
    let distance = |p: DVec3| (p - middle).length();
    let ball = solid(50, |p| distance(p) < 22.0);
    let shell = solid(50, |p| (21.0..22.0).contains(&distance(p)));
    for (voxels, worst_limit) in [(ball, 12.0), (shell, 40.0)] {
        let (mut sum, mut worst, mut count) = (0.0, 0.0f64, 0.0);
        for (index, normal) in normals(&build(&voxels)) {
            let outward = DVec3::from_array(index.map(|c| c as f64 + 0.5)) - middle;
            // Voxels that cannot be seen have none.
            if let Some(normal) = normal.filter(|_| outward.length() >= 21.0) {
                let degrees = libm::acos(normal.dot(outward.normalize()).min(1.0)).to_degrees();
                sum += degrees;
                count += 1.0;
                worst = worst.max(degrees);
            }
        }
        let mean = sum / count;
        let is_good = count > 4500.0 && mean < 4.0 && worst < worst_limit;
        assert!(is_good, "{count} normals, mean {mean}, worst {worst}");
    }
}

#[test]
fn normals_of_faces_walls_and_edges() {
    // A block: faces, an edge, a corner, and nothing inside.
    let block = normals(&build(&solid(12, |_| true)));
    assert_eq!(block[&[0, 6, 6]], Some(DVec3::NEG_X));
    assert_eq!(block[&[6, 11, 6]], Some(DVec3::Y));
    assert_eq!(block[&[6, 6, 6]], None);
    assert!(block[&[11; 3]].unwrap().dot(DVec3::ONE.normalize()) > 0.999);
    // A concave edge.
    let step = normals(&build(&solid(12, |p| p.x < 6.0 || p.z < 6.0)));
    let concave = step[&[5, 6, 6]].unwrap();
    let is_between = concave.x > 0.5 && concave.z > 0.1 && concave.y == 0.0;
    assert!(is_between, "{concave}");
    // A wall one voxel thick has the normal of its plane, slanted ones too.
    let wall = normals(&build(&solid(16, |p| p.z < 1.0)));
    assert_eq!(wall[&[8, 8, 0]].map(|n| n.abs()), Some(DVec3::Z));
    let plane = DVec3::new(1.0, 2.0, 4.0);
    let slanted = build(&solid(32, |p| (p.dot(plane) / 4.0 - 24.0).abs() <= 0.5));
    for (index, normal) in normals(&slanted) {
        if index.iter().all(|&c| (3..29).contains(&c)) {
            let likeness = normal.unwrap().dot(plane.normalize()).abs();
            assert!(likeness > 0.97, "{index:?}: {likeness}");
        }
    }
    // A voxel alone has none.
    let lone = normals(&build(&[at([0, 0, 0]), at([100, 0, 0])]));
    assert!(lone.values().all(Option::is_none));
}

#[test]
fn normals_are_the_same_wherever_the_object_lies() {
    // Clusters fall differently over the object as it moves by a voxel.
    let ball = solid(21, |p| (p - DVec3::splat(10.0)).length() < 9.3);
    let plain = normals(&build(&ball));
    for shift in 1..4 {
        // A stray voxel fixes the box, far enough away to have no say.
        let moved = normals(&build(&[&ball[..], &[at([-8 - shift, -8, -8])]].concat()));
        for (index, a) in &plain {
            match (a, moved[index]) {
                (Some(a), Some(b)) => assert!(a.dot(b) > 0.95, "{index:?}: {a} {b}"),
                (a, b) => assert_eq!(*a, b, "{index:?}"),
            }
        }
    }
}
