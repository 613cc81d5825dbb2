//! How many bytes a sample takes while a picture is drawn and written.
//!
//! A test crate of its own, for its allocator counts the bytes that are in use.

#![cfg(feature = "png")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io;
use std::sync::atomic::{AtomicUsize, Ordering};

use shiftvox::fast::{Fast, FastOptions};
use shiftvox::frame::Frame;
use shiftvox::graph::Silent;
use shiftvox::machine::Machine;
use shiftvox::picture::png::Pixels;
use shiftvox::picture::{Background, Buffer, Resolver, Rows, Shading};
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::scene::{NoMeshes, OpenOptions, open};

/// The system's allocator, counting.
struct Counting;

/// Bytes in use, and the most that were since [`peak_of`] began.
static IN_USE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

fn taken(bytes: usize) {
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

/// One test, so that no other is counted with it.
#[test]
fn a_picture_takes_few_bytes_a_sample() {
    let opened = open(
        "gen:terrain,depth=7",
        &OpenOptions::default(),
        &NoMeshes,
        &Silent,
    )
    .expect("a scene");
    let graph = &opened.graph;
    let side = f64::from(1u32 << graph.depth);
    for (aa_log2, of_nodes, of_voxels) in [(0, 10.0, 24.0), (1, 6.0, 22.0)] {
        let camera = Camera {
            eye: glam::DVec3::new(1.6, -0.7, 1.25) * side,
            target: glam::DVec3::splat(0.4) * side,
            up: glam::DVec3::Z,
            fov_degrees: 60.0,
            width: 2048 >> aa_log2,
            height: 2048 >> aa_log2,
        };
        let options = SetupOptions {
            aa_log2,
            ..SetupOptions::default()
        };
        let setup =
            FrameSetup::new(&camera, &graph.placement, graph.depth, &options).expect("a frame");
        let samples = f64::from(setup.width) * f64::from(setup.height);
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
            let each = peak as f64 / samples;
            assert!(each < most, "{each} bytes a sample, more than {most}");
        }
    }
}
