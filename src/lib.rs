//! Exact voxel rendering on the CPU, and a model of hardware that needs only adders and shifts.
//!
//! `shiftvox` draws voxel files without a GPU, and counts what the same picture would cost simple hardware that has
//! adders, shifts, logic and compares, and no multiplier, divider or floating point. Its default picture is exact: at
//! each sample it shows the first voxel on the ray, proved against an oracle in wide integers, the same on every
//! platform, instruction set and number of threads.
//!
//! ```
//! use shiftvox::{Buffer, Camera, Renderer, Scene, Voxel};
//!
//! // A red voxel in front of a blue one, seen from the front.
//! let voxel = |y, color| Voxel { index: [0, y, 0], color, normal: None };
//! let scene = Scene::from_voxels([voxel(0, [255, 0, 0]), voxel(1, [0, 0, 255])])?;
//! let camera = Camera::fit(&scene).azimuth(0.0).elevation(0.0);
//! let picture = Renderer::new().buffers([Buffer::Voxel]).render(&scene, &camera, 32, 32)?;
//! assert_eq!(picture.voxel_at(16, 16)?, Some(([0, 0, 0], 1))); // index, and level in the graph
//! let [red, _, blue, _] = picture.rgba()[16 * 32 + 16];
//! assert!(red > 100 && blue == 0);
//! # #[cfg(feature = "png")]
//! picture.save_png(std::env::temp_dir().join("red.png"))?;
//! # Ok::<(), shiftvox::Error>(())
//! ```
//!
//! **Use it** for pictures of voxel files, where there is no GPU or where they must be the same everywhere; to study what
//! a renderer in hardware would cost; as a reference for another voxel renderer. **Not** for frame rates of a GPU, for
//! light that bounces, or for scenes that change every frame.
//!
//! # What is where
//!
//! | | |
//! |---|---|
//! | [`Scene`] | opens voxel files and meshes, makes generated scenes, builds voxels of your own; [`SceneOptions`] |
//! | [`Camera`] | fitted to a scene, or placed |
//! | [`Renderer`] | engine ([`EngineKind`]), drawing rule ([`Coverage`]), level of detail, samples a pixel, machine words |
//! | [`Picture`] | colours, depths, normals, voxels, counters; PNG and NumPy files; a hash |
//! | [`Engine`] | the engines themselves ([`Fast`], [`Machine`], [`Rays`]), frame after frame without a picture |
//! | [`hwmodel`] | words that cannot multiply, and the model of cycles, memory, area and energy |
//!
//! `examples/` has programs to begin with; the command line does the same and more. The rules are in `SPEC.md`, the
//! layers of the source in `ARCHITECTURE.md`.
//!
//! # Features
//!
//! | feature | default | what for |
//! |---|---|---|
//! | `png` | yes | [`Picture::save_png`] |
//! | `mesh` | yes | meshes, far voxels and textured voxels; without it meshes are refused, and a binary `.stl` is not recognised |
//! | `lab` | yes | experiments: time against error, stress, the hardware model of whole frames; needs `mesh` |
//! | `cli` | yes | the command line; needs all of them |
//! | `view` | yes | the command `view`, a page for a browser; needs `cli` |
//!
//! Without them (`default-features = false`) the renderer and its voxel formats are left.

mod api;

pub use api::{Camera, EngineKind, Error, FittedCamera, Picture, Renderer, Scene, Up, View};

pub use fast::{Declined, Fast, FastOptions, Instructions, Switches};
pub use frame::Frame;
pub use graph::{Graph, GraphView, PackedNormal, Voxel};
pub use machine::{Machine, MachineOptions, Simulated};
pub use picture::{Background, Buffer, Shading};
pub use project::{
    CageKind, CameraError, Coverage, Engine, EngineError, FrameSetup, OCCLUSION_ORDER, SetupError,
    SetupOptions, Stats,
};
pub use rays::Rays;

pub use hwmodel;
pub use hwmodel::Overflow;

// Internal modules, public for this project's own tests and tools. They may change in any version and are no part of
// the API.
#[doc(hidden)]
pub mod bounded;
#[doc(hidden)]
pub mod budget;
#[doc(hidden)]
pub mod drawing;
#[doc(hidden)]
pub mod fast;
#[doc(hidden)]
pub mod frame;
#[doc(hidden)]
pub mod graph;
#[doc(hidden)]
pub mod machine;
#[doc(hidden)]
pub mod picture;
#[doc(hidden)]
pub mod project;
#[doc(hidden)]
pub mod rays;
#[doc(hidden)]
pub mod scene;
#[doc(hidden)]
pub mod split_mix;
#[doc(hidden)]
pub mod srgb;
#[doc(hidden)]
pub mod whole;

/// Runs the programs of a tutorial as tests.
#[cfg(all(doctest, feature = "png"))]
#[doc = include_str!("../docs/tutorial-library.md")]
struct TutorialLibrary;
