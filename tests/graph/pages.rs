//! Pages of a mapped file that a frame touches: from the nodes that a probe sees fetched and the pixels show, and as the
//! system counts them.
#![cfg(target_os = "linux")]

use std::collections::BTreeSet;
use std::path::Path;

use glam::DVec3;
use hwmodel::{Memory, Probe, StageLevel};
use shiftvox::frame::{Frame, NO_NODE};
use shiftvox::graph::{BuildOptions, Builder, Graph, Silent, vxg};
use shiftvox::machine::Machine;
use shiftvox::picture::{Background, Shading, resolve};
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::scene::generate::Spec;

/// Bytes of a page where a probe's addresses are counted.
const PAGE: u64 = 4096;

/// Nodes whose mask and child list the machine fetches.
#[derive(Debug, Default)]
struct Fetched(BTreeSet<u64>);

impl Probe for Fetched {
    fn read(&mut self, memory: Memory, address: u64, _: StageLevel) {
        if memory == Memory::Node {
            self.0.insert(address);
        }
    }
}

/// Pages of an array of the file that hold the items of some nodes.
fn pages_of<'n>(nodes: impl Iterator<Item = &'n u64>, item_bytes: u64) -> u64 {
    let ends = |&node: &u64| {
        [
            node * item_bytes / PAGE,
            ((node + 1) * item_bytes - 1) / PAGE,
        ]
    };
    let pages: BTreeSet<u64> = nodes.flat_map(ends).collect();
    pages.len() as u64
}

/// The whole object from outside, above one corner.
fn outside_view(graph: &Graph, pixels: u32) -> FrameSetup {
    let side = f64::from(1u32 << graph.depth) * graph.placement.voxel_size;
    let camera = Camera {
        eye: DVec3::new(1.6, -0.7, 1.25) * side,
        target: DVec3::new(0.5, 0.5, 0.3) * side,
        up: DVec3::Z,
        fov_degrees: 60.0,
        width: pixels,
        height: pixels,
    };
    FrameSetup::new(
        &camera,
        &graph.placement,
        graph.depth,
        &SetupOptions::default(),
    )
    .unwrap()
}

/// Nodes and pages that a frame touched.
struct Touched {
    /// Distinct nodes whose mask or child list the machine fetched.
    fetched: u64,
    /// Pages that hold these.
    shape_pages: u64,
    /// Distinct nodes that are seen.
    seen: u64,
    /// Pages that hold their colours and normals.
    attribute_pages: u64,
    /// Pages in the process's table after drawing and colouring.
    resident: u64,
}

fn touched(path: &Path, pixels: u32) -> Touched {
    let graph = vxg::open(path).unwrap();
    let setup = outside_view(&graph, pixels);
    let mut frame = Frame::new(pixels, pixels, false);
    let mut machine = Machine::default();
    machine.render(&graph.view(), &setup, &mut frame).unwrap();
    resolve(
        &frame,
        &graph,
        &setup,
        Shading::default(),
        Background::default(),
    )
    .unwrap();
    let resident = graph.mapped_pages().unwrap().resident;
    let (_, Fetched(nodes)) = Machine::default()
        .render_probed(&graph.view(), &setup, &mut frame, Fetched::default())
        .unwrap();
    let inner = graph.mask.len() as u64;
    let with_shape = || nodes.iter().filter(|&&node| node < inner);
    let seen = frame.node.iter().filter(|&&node| node != NO_NODE);
    let seen: BTreeSet<u64> = seen.map(|&node| u64::from(node)).collect();
    Touched {
        fetched: nodes.len() as u64,
        shape_pages: pages_of(with_shape(), 1) + pages_of(with_shape(), 4),
        seen: seen.len() as u64,
        attribute_pages: pages_of(seen.iter(), 3) + pages_of(seen.iter(), 2),
        resident,
    }
}

/// The system's figures against what the machine fetches.
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
    let touched = touched(&path, 128);
    assert!(touched.seen > 1000 && touched.fetched > touched.seen);
    let untouched = vxg::open(&path).unwrap();
    let (pages, resident) = (untouched.mapped_pages().unwrap(), touched.resident);
    let length = std::fs::metadata(&path).unwrap().len();
    assert_eq!(pages.mapped, length.div_ceil(pages.page_bytes));
    // Nothing is read on opening.
    assert_eq!(pages.resident, 0);
    // Fetched nodes count fully, though the child list is not read of all;
    // and where one array ends in a page, another begins.
    let all = touched.shape_pages + touched.attribute_pages;
    assert!(
        3 * resident >= 2 * all && resident <= 16 * all,
        "{resident}, {all}"
    );
}
