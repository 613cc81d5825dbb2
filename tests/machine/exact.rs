//! Under exact coverage the picture is defined once: machine, fast engine and
//! oracle show the same voxel and node at every sample, at every level of
//! detail and number of samples a pixel. (`draw` compares the fast engine.)

use crate::common::*;
use proptest::prelude::*;
use shiftvox::frame::Frame;
use shiftvox::graph::Graph;
use shiftvox::project::{CageKind, Camera, Coverage, Engine, FrameSetup, SetupError, SetupOptions};
use shiftvox::rays::Rays;

fn exact(cage: CageKind, lod_px: f64) -> SetupOptions {
    SetupOptions {
        cage,
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

fn check(
    graph: &Graph,
    camera: &Camera,
    (cage, lod_px, aa_log2): (CageKind, f64, u32),
) -> Result<(), TestCaseError> {
    let options = SetupOptions {
        aa_log2,
        ..exact(cage, lod_px)
    };
    let setup = setup(graph, camera, &options);
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
    #![proptest_config(cases(150))]

    #[test]
    fn random_octrees(
        graph in any_octree(3, 0.2),
        camera in any_camera(8.0, 1..40),
        cage in any_cage(),
        lod_px in any_lod(),
        aa_log2 in 0..3u32,
    ) {
        check(&graph, &camera, (cage, lod_px, aa_log2))?;
    }

    #[test]
    fn random_graphs(
        (graph, camera) in any_graph(1..7).prop_flat_map(|graph| {
            let side = f64::from(1u32 << graph.depth);
            (Just(graph), any_camera(side, 1..40))
        }),
        cage in any_cage(),
        lod_px in any_lod(),
        aa_log2 in 0..3u32,
    ) {
        check(&graph, &camera, (cage, lod_px, aa_log2))?;
    }

    #[test]
    fn a_solid_cube_seen_from_everywhere(
        camera in any_camera(4.0, 1..40),
        cage in any_cage(),
        lod_px in any_lod(),
        aa_log2 in 0..3u32,
    ) {
        check(&solid(2), &camera, (cage, lod_px, aa_log2))?;
    }
}

proptest! {
    #![proptest_config(cases(80))]

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

/// There is no other tolerance than 0 to ask for.
#[test]
fn a_tolerance_is_refused_with_the_reason() {
    let graph = solid(2);
    let camera = camera([9.0, 7.0, 6.0], [2.0; 3], 16);
    for coverage in [Coverage::Exact, Coverage::Alpha] {
        for tolerance_px in [1.0 / 256.0, 0.125, f64::INFINITY] {
            let options = SetupOptions {
                tolerance_px,
                ..SetupOptions::of(coverage)
            };
            let error = FrameSetup::new(&camera, &graph.placement, graph.depth, &options)
                .expect_err("no such frame");
            assert_eq!(error, SetupError::Tolerance(tolerance_px));
            assert!(
                error.to_string().contains("approximates nothing"),
                "{error}"
            );
        }
    }
    for coverage in [Coverage::Any, Coverage::Center] {
        assert_eq!(SetupOptions::of(coverage).tolerance_px, 0.125);
    }
    assert_eq!(SetupOptions::default().tolerance_px, 0.0);
}
