//! Allocations: a frame of the fast engine makes none after the first, and a picture takes few bytes per sample.
//!
//! A test crate of its own, of one test, for its allocator counts what the whole process does.

#![cfg(feature = "png")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};

use shiftvox::fast::{Fast, FastOptions};
use shiftvox::frame::{Colors, Frame};
use shiftvox::graph::{Graph, Silent};
use shiftvox::machine::Machine;
use shiftvox::picture::png::Pixels;
use shiftvox::picture::{Background, Buffer, Resolver, Rows, Shading};
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::scene::{NoMeshes, OpenOptions, open};

/// The system's allocator, counting.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);
/// Bytes in use, and the most that were since [`peak_of`] began.
static IN_USE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

fn taken(bytes: usize) {
    ALLOCATIONS.fetch_add(1, Ordering::SeqCst);
    let in_use = IN_USE.fetch_add(bytes, Ordering::SeqCst) + bytes;
    PEAK.fetch_max(in_use, Ordering::SeqCst);
}

// SAFETY: every call is handed on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        taken(layout.size());
        // SAFETY: the caller keeps the contract, which is the system's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), Ordering::SeqCst);
        // SAFETY: as in `alloc`; the pointer came from there.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // Both may be there for a while.
        taken(size);
        IN_USE.fetch_sub(layout.size(), Ordering::SeqCst);
        // SAFETY: as in `dealloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// Most bytes in use during `work`, beside those in use before.
fn peak_of(work: impl FnOnce()) -> usize {
    let before = IN_USE.load(Ordering::SeqCst);
    PEAK.store(before, Ordering::SeqCst);
    work();
    PEAK.load(Ordering::SeqCst) - before
}

/// Allocations of `draw`.
fn allocations(mut draw: impl FnMut()) -> usize {
    let before = ALLOCATIONS.load(Ordering::SeqCst);
    draw();
    ALLOCATIONS.load(Ordering::SeqCst) - before
}

fn graph(spec: &str) -> Graph {
    let opened = open(spec, &OpenOptions::default(), &NoMeshes, &Silent);
    opened.expect("a scene").graph
}

fn set_up(graph: &Graph, (width, height): (u32, u32), options: &SetupOptions) -> FrameSetup {
    let side = f64::from(1u32 << graph.depth);
    let camera = Camera {
        eye: glam::DVec3::new(1.6, -0.7, 1.25) * side,
        target: glam::DVec3::splat(0.4) * side,
        up: glam::DVec3::Z,
        fov_degrees: 60.0,
        width,
        height,
    };
    FrameSetup::new(&camera, &graph.placement, graph.depth, options).expect("a frame")
}

fn a_frame_allocates_nothing_after_the_first(graph: &Graph, lod_px: f64) {
    let options = SetupOptions {
        lod_px,
        ..SetupOptions::default()
    };
    let setup = set_up(graph, (301, 200), &options);
    let options = FastOptions {
        threads: 1,
        ..FastOptions::default()
    };
    let mut fast = Fast::new(options, Box::new(Machine::default()));
    let mut frame = Frame::new(setup.width, setup.height, false);
    let view = graph.view();
    let mut draw = || fast.draw(&view, &setup, &mut frame).expect("a frame");
    assert!(allocations(&mut draw) > 0, "the count counts nothing");
    assert_eq!(allocations(&mut draw), 0);
    assert!(frame.drawn() > 1000);
    let mut colors = Colors::new(setup.width, setup.height);
    let of_node: &[[u8; 3]] = &graph.color;
    let mut draw = || {
        fast.draw_colors(&view, of_node, &setup, &mut colors)
            .expect("a frame")
    };
    assert_eq!(allocations(&mut draw), 0);
    assert!(colors.words.iter().filter(|&&word| word != 0).count() > 1000);
}

fn a_picture_takes_few_bytes_per_sample(
    graph: &Graph,
    aa_log2: u32,
    [of_nodes, of_voxels]: [f64; 2],
) {
    let options = SetupOptions {
        aa_log2,
        ..SetupOptions::default()
    };
    let setup = set_up(graph, (2048 >> aa_log2, 2048 >> aa_log2), &options);
    let draw = |mut frame: Frame, buffers: &[Buffer]| {
        let mut fast = Fast::new(FastOptions::default(), Box::new(Machine::default()));
        fast.draw(&graph.view(), &setup, &mut frame).expect("drawn");
        let background = Background::default();
        let resolver = Resolver::new(&frame, graph, &setup, Shading::Lambert, background);
        let resolver = resolver.expect("of one size");
        let (width, height) = resolver.size();
        let colors = resolver.colors(0..height).expect("colours");
        let pixels = Pixels::opaque(width, height, colors);
        pixels.write(io::sink()).expect("a picture");
        for &buffer in buffers {
            for rows in resolver.steps() {
                let values = resolver.rows(buffer, rows).expect("rows");
                std::hint::black_box(values.bytes());
            }
        }
    };
    let colors_alone = peak_of(|| draw(Frame::nodes_only(setup.width, setup.height), &[]));
    let all = [Buffer::Depth, Buffer::Normal, Buffer::Voxel, Buffer::Color];
    let with_buffers = peak_of(|| draw(Frame::new(setup.width, setup.height, false), &all));
    for (peak, most) in [(colors_alone, of_nodes), (with_buffers, of_voxels)] {
        let each = peak as f64 / (f64::from(setup.width) * f64::from(setup.height));
        assert!(each < most, "{each} bytes per sample, more than {most}");
    }
}

#[test]
fn memory_of_frames_and_pictures() {
    let [terrain, sponge] = ["gen:terrain,depth=7", "gen:menger,depth=3"].map(graph);
    for graph in [&terrain, &sponge] {
        a_frame_allocates_nothing_after_the_first(graph, 0.0);
        a_frame_allocates_nothing_after_the_first(graph, 1.0);
    }
    a_picture_takes_few_bytes_per_sample(&terrain, 0, [10.0, 24.0]);
    a_picture_takes_few_bytes_per_sample(&terrain, 1, [6.0, 22.0]);
}
