//! With tolerance 0 and exact coverage the machine's voxels are the oracle's at
//! every level of detail: no sample more, none less, none other.

use crate::common::*;
use proptest::prelude::*;
use shiftvox::frame::{Frame, NO_VOXEL};
use shiftvox::graph::Graph;
use shiftvox::project::{CageKind, Camera, Coverage, Engine, FrameSetup, SetupOptions};
use shiftvox::rays::Rays;

fn exact(cage: CageKind, lod_px: f64) -> SetupOptions {
    SetupOptions {
        cage,
        tolerance_px: 0.0,
        coverage: Coverage::Exact,
        lod_px,
        ..SetupOptions::default()
    }
}

fn oracle(graph: &Graph, setup: &FrameSetup) -> Frame {
    let mut frame = Frame::new(setup.width, setup.height, false);
    Rays.render(&graph.view(), setup, &mut frame)
        .expect("the oracle never fails");
    frame
}

fn differing(a: &Frame, b: &Frame) -> String {
    let mut report = String::new();
    for (at, (x, y)) in a.voxel.iter().zip(&b.voxel).enumerate() {
        if x != y {
            let (row, column) = (at / a.width as usize, at % a.width as usize);
            report += &format!("({column}, {row}): machine {x:?}, oracle {y:?}\n");
        }
    }
    report
}

fn check(graph: &Graph, camera: &Camera, cage: CageKind, lod_px: f64) -> Result<(), TestCaseError> {
    let setup = setup(graph, camera, &exact(cage, lod_px));
    let machine = draw(graph, &setup);
    let oracle = oracle(graph, &setup);
    prop_assert!(
        machine.voxel == oracle.voxel && machine.node == oracle.node,
        "{}",
        differing(&machine, &oracle)
    );
    Ok(())
}

fn any_cage() -> impl Strategy<Value = CageKind> {
    prop_oneof![Just(CageKind::Corners), Just(CageKind::Frame)]
}

/// None; parts of a sample, among them such as no short sum of powers of two
/// is; samples, many samples; more than the picture.
fn any_lod() -> impl Strategy<Value = f64> {
    prop_oneof![
        2 => Just(0.0),
        2 => Just(1.0),
        2 => 0.01..8.0f64,
        1 => prop_oneof![Just(0.5), Just(16.0), Just(4096.0)],
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn random_octrees(
        graph in any_octree(3, 0.2),
        camera in any_camera(8.0, 1..40),
        cage in any_cage(),
        lod_px in any_lod(),
    ) {
        check(&graph, &camera, cage, lod_px)?;
    }

    #[test]
    fn random_graphs(
        (graph, camera) in any_graph(1..7).prop_flat_map(|graph| {
            let side = f64::from(1u32 << graph.depth);
            (Just(graph), any_camera(side, 1..40))
        }),
        cage in any_cage(),
        lod_px in any_lod(),
    ) {
        check(&graph, &camera, cage, lod_px)?;
    }

    #[test]
    fn a_solid_cube_seen_from_everywhere(
        camera in any_camera(4.0, 1..40),
        cage in any_cage(),
        lod_px in any_lod(),
    ) {
        check(&solid(2), &camera, cage, lod_px)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Level of detail covers what the true picture covers, and more only
    /// within its size of it.
    #[test]
    fn level_of_detail_loses_no_sample(
        graph in any_octree(3, 0.15),
        camera in any_camera(8.0, 1..40),
        cage in any_cage(),
        lod_px in prop_oneof![Just(0.5), Just(1.0), Just(4.0)],
    ) {
        let setup = setup(&graph, &camera, &exact(cage, lod_px));
        let machine = draw(&graph, &setup);
        let oracle = oracle(&graph, &setup.without_detail());
        for (at, (drawn, covered)) in machine.voxel.iter().zip(&oracle.voxel).enumerate() {
            prop_assert!(drawn[3] >= 0 || covered[3] < 0, "sample {} is lost", at);
        }
    }
}

#[test]
fn a_camera_on_a_face_and_on_a_corner() {
    let graph = octree(3, &|[x, y, z]| (x + 2 * y + 3 * z) % 4 == 0);
    for eye in [
        [0.0, 4.0, 4.0],
        [4.0, 4.0, 4.0],
        [8.0, 8.0, 8.0],
        [3.0, 2.0, 8.0],
    ] {
        for target in [[4.0, 4.0, 3.5], [8.0, 3.0, 4.0], [1.0, 1.0, 1.0]] {
            let camera = camera(eye, target, 64);
            let setup = setup(&graph, &camera, &exact(CageKind::Frame, 0.0));
            let machine = draw(&graph, &setup);
            let oracle = oracle(&graph, &setup);
            assert!(
                machine.voxel == oracle.voxel,
                "eye {eye:?}: {}",
                differing(&machine, &oracle)
            );
            assert!(machine.voxel.iter().any(|&v| v != NO_VOXEL));
        }
    }
}

#[test]
fn sierpinski_at_depth_30() {
    let graph = sierpinski(30);
    let side = f64::from(1u32 << 30);
    for eye in [[-0.7, -0.9, 0.6], [0.501, 0.499, 0.5], [1.0, 1.0, 1.0]] {
        let camera = camera(eye.map(|c| c * side), [side * 0.3; 3], 64);
        for lod_px in [0.0, 0.7, 1.0] {
            check(&graph, &camera, CageKind::Frame, lod_px).expect("equal pictures");
        }
    }
}
