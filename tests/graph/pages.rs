//! Pages of a mapped file: none are read on opening, and a frame reads those of its nodes.
#![cfg(target_os = "linux")]

use glam::DVec3;
use hwmodel::Memory;
use hwmodel::count::Counter;
use shiftvox::frame::Frame;
use shiftvox::graph::{BuildOptions, Builder, Silent, vxg};
use shiftvox::machine::Machine;
use shiftvox::project::{Camera, FrameSetup, SetupOptions};
use shiftvox::scene::generate::Spec;

#[test]
fn a_frame_has_the_pages_of_its_nodes_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("terrain.vxg");
    let mut builder = Builder::new(BuildOptions::default());
    let spec = Spec::parse("gen:terrain,depth=9").unwrap();
    spec.voxels(&mut |voxel| builder.push(voxel), &Silent);
    let graph = builder.finish(([0.0; 3], 1.0), &Silent).unwrap();
    assert_eq!(graph.mapped_pages(), None);
    vxg::write(&graph, &path, false).unwrap();

    let mapped = vxg::open(&path).unwrap();
    let before = mapped.mapped_pages().unwrap();
    let length = std::fs::metadata(&path).unwrap().len();
    assert_eq!(before.mapped, length.div_ceil(before.page_bytes));
    assert_eq!(before.resident, 0);

    let side = f64::from(1u32 << graph.depth);
    let camera = Camera {
        eye: DVec3::new(1.6, -0.7, 1.25) * side,
        target: DVec3::new(0.5, 0.5, 0.3) * side,
        up: DVec3::Z,
        fov_degrees: 60.0,
        width: 128,
        height: 128,
    };
    let options = SetupOptions::default();
    let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, &options).unwrap();
    let mut frame = Frame::new(128, 128, false);
    let drawn =
        Machine::default().render_probed(&mapped.view(), &setup, &mut frame, Counter::new());
    let nodes = drawn.unwrap().1.reads(Memory::Node);
    let resident = mapped.mapped_pages().unwrap().resident;
    // A node lies in two arrays. Pages of neighbours may be read along, up to 16.
    let most = 16 * 2 * nodes.min(before.mapped);
    assert!(
        (10..=most).contains(&resident) && resident < before.mapped,
        "{resident} of {before:?}, {nodes} nodes"
    );
}
