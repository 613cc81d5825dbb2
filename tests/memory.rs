//! Allocations: a frame of the fast engine makes none after the first, and a picture takes few bytes per sample.
//!
//! The allocator counts the whole process, so this test has a crate of its own.

#![cfg(feature = "png")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::io;
use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};

use glam::DVec3;
use shiftvox::fast::{Fast, FastOptions};
use shiftvox::frame::{Colors, Frame};
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::picture::png::Pixels;
use shiftvox::picture::{Background, Buffer, Resolver, Rows, Shading};
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};

/// The system's allocator, counting.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);
/// Bytes in use, and the most that were since [`measure`] began.
static IN_USE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, SeqCst);
        let in_use = IN_USE.fetch_add(layout.size(), SeqCst) + layout.size();
        PEAK.fetch_max(in_use, SeqCst);
        // SAFETY: the caller keeps the contract, which is the system's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        IN_USE.fetch_sub(layout.size(), SeqCst);
        // SAFETY: as in `alloc`. The pointer came from there.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// The allocations of `work`, and the most bytes in use during it, beside those in use before.
fn measure(work: impl FnOnce()) -> (usize, usize) {
    let (allocations, in_use) = (ALLOCATIONS.load(SeqCst), IN_USE.load(SeqCst));
    PEAK.store(in_use, SeqCst);
    work();
    (
        ALLOCATIONS.load(SeqCst) - allocations,
        PEAK.load(SeqCst) - in_use,
    )
}

fn set_up(graph: &Graph, size: (u32, u32), (lod_px, aa_log2): (f64, u32)) -> FrameSetup {
    let side = f64::from(1u32 << graph.depth);
    let [eye, target] = [DVec3::new(1.6, -0.7, 1.25), DVec3::splat(0.4)];
    let camera = Camera::looking(eye * side, target * side, 60.0, size);
    let options = SetupOptions {
        lod_px,
        aa_log2,
        ..SetupOptions::default()
    };
    FrameSetup::new(&camera, &graph.placement, graph.depth, &options).expect("a frame")
}

fn fast(threads: usize) -> Fast {
    let options = FastOptions {
        threads,
        ..FastOptions::default()
    };
    Fast::new(options, Box::new(Machine::default()))
}

fn a_frame_allocates_nothing_after_the_first(graph: &Graph, lod_px: f64) {
    let setup = set_up(graph, (301, 200), (lod_px, 0));
    let (mut fast, view) = (fast(1), graph.view());
    let mut frame = Frame::new(setup.width, setup.height, false);
    let mut draw = || measure(|| drop(fast.render(&view, &setup, &mut frame).expect("a frame"))).0;
    let [first, second] = [draw(), draw()];
    // The counts alone.
    assert!(first > 1 && second == 1, "{first}, {second}");
    let mut colors = Colors::new(setup.width, setup.height);
    let draw = || {
        fast.draw_colors(&view, &graph.color, &setup, &mut colors)
            .expect("a frame")
    };
    assert_eq!(measure(draw).0, 0);
    let colored = colors.words.iter().filter(|&&word| word != 0).count();
    assert!(frame.drawn().min(colored) > 1000);
}

fn a_picture_takes_few_bytes_per_sample(graph: &Graph, aa_log2: u32, most: [f64; 2]) {
    let setup = set_up(graph, (2048 >> aa_log2, 2048 >> aa_log2), (0.5, aa_log2));
    let draw = |mut frame: Frame, buffers: &[Buffer]| {
        fast(0)
            .render(&graph.view(), &setup, &mut frame)
            .expect("drawn");
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
    let (width, height) = (setup.width, setup.height);
    let all = [Buffer::Depth, Buffer::Normal, Buffer::Voxel, Buffer::Color];
    let peaks = [
        measure(|| draw(Frame::nodes_only(width, height), &[])).1,
        measure(|| draw(Frame::new(width, height, false), &all)).1,
    ];
    let each = peaks.map(|peak| peak as f64 / (f64::from(width) * f64::from(height)));
    assert!(
        each[0] < most[0] && each[1] < most[1],
        "{each:?} bytes per sample, at most {most:?}"
    );
}

#[test]
fn memory_of_frames_and_pictures() {
    let [terrain, sponge] = ["terrain,depth=7", "menger,depth=3"]
        .map(|spec| shiftvox::Scene::generate(spec).expect(spec));
    for scene in [&terrain, &sponge] {
        for lod_px in [0.0, 1.0] {
            a_frame_allocates_nothing_after_the_first(scene.graph(), lod_px);
        }
    }
    a_picture_takes_few_bytes_per_sample(terrain.graph(), 0, [10.0, 24.0]);
    a_picture_takes_few_bytes_per_sample(terrain.graph(), 1, [6.0, 22.0]);
}
