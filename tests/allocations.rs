//! A frame of the fast engine allocates nothing after the first.
//!
//! A test crate of its own, for its allocator counts every allocation.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use shiftvox::fast::{Fast, FastOptions};
use shiftvox::frame::{Colors, Frame};
use shiftvox::graph::{BuildOptions, Builder, Graph, Silent};
use shiftvox::machine::Machine;
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox::scene::generate::Spec;

/// The system's allocator, counting.
struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is handed on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract, which is the system's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as in `alloc`; the pointer came from there.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as in `dealloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

fn scene(spec: &str) -> Graph {
    let spec = Spec::parse(spec).expect("a generator");
    let mut builder = Builder::new(BuildOptions::default());
    spec.voxels(&mut |voxel| builder.push(voxel), &Silent);
    builder.finish(([0.0; 3], 1.0), &Silent).expect("a graph")
}

/// Allocations of `draw`.
fn allocations(mut draw: impl FnMut()) -> u64 {
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    draw();
    ALLOCATIONS.load(Ordering::Relaxed) - before
}

#[test]
fn a_frame_allocates_nothing_after_the_first() {
    let scenes = ["gen:terrain,depth=7", "gen:menger,depth=3"].map(scene);
    for graph in &scenes {
        let side = f64::from(1u32 << graph.depth);
        let camera = Camera {
            eye: glam::DVec3::new(1.6, -0.7, 1.25) * side,
            target: glam::DVec3::splat(0.4) * side,
            up: glam::DVec3::Z,
            fov_degrees: 60.0,
            width: 301,
            height: 200,
        };
        for lod_px in [0.0, 1.0] {
            let options = SetupOptions {
                lod_px,
                ..SetupOptions::default()
            };
            let setup =
                FrameSetup::new(&camera, &graph.placement, graph.depth, &options).expect("a frame");
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
                let drawn = fast.draw_colors(&view, of_node, &setup, &mut colors);
                drawn.expect("a frame");
            };
            assert_eq!(allocations(&mut draw), 0);
            assert!(colors.words.iter().filter(|&&word| word != 0).count() > 1000);
        }
    }
}
