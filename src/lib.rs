//! Exact voxel rendering on the CPU, and a model of hardware that needs only adders and shifts.
//!
//! `shiftvox` draws voxel files without a GPU, and counts what the same picture would cost simple hardware that has
//! adders, shifts, logic and compares, and no multiplier, divider or floating point. Its default picture is exact: each
//! sample shows the first voxel on its ray, the same on every platform, instruction set and number of threads.
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
//! a renderer in hardware would cost; as a reference for another voxel renderer. **Do not use it** for the frame rates of
//! a GPU, for light that bounces, or for scenes that change every frame.
//!
//! # The names
//!
//! | | |
//! |---|---|
//! | [`Scene`] | opens voxel files, generates scenes, builds [`Voxel`]s of your own; which axis is [`Up`] |
//! | [`Camera`], [`FittedCamera`] | placed, or fitted to a scene; either is a [`View`] |
//! | [`Renderer`] | the engine ([`EngineKind`]), the drawing rule ([`Coverage`]), samples per pixel, light ([`Shading`]), [`Background`], and for the machine its [`CageKind`] and [`Overflow`] |
//! | [`Picture`] | colours, and the requested [`Buffer`]s; counters; PNG and NumPy files; a hash |
//! | [`Error`] | every failure, with [`SetupError`], [`CameraError`], [`EngineError`] and [`Shortage`] |
//! | [`hwmodel`], [`Simulated`] | words that cannot multiply, and the model of cycles, memory, area and energy |
//!
//! Meshes are opened by the crate `shiftvox-mesh`. `examples/` has programs to begin with; the program `shiftvox` does
//! the same and more. The rules are in `SPEC.md`, the layers of the source in `ARCHITECTURE.md`.
//!
//! # Features
//!
//! | feature | default | purpose |
//! |---|---|---|
//! | `png` | yes | [`Picture::save_png`] |
//! | `clap` | no | settings as values of command-line flags |
//! | `mutants` | no | machines with one deliberate fault each, for tests of tests |

mod api;

pub use api::{Camera, EngineKind, Error, FittedCamera, Picture, Renderer, Scene};
pub use hwmodel;

#[doc(inline)]
pub use api::{Up, View};
#[doc(inline)]
pub use budget::Shortage;
#[doc(inline)]
pub use graph::{PackedNormal, Voxel};
#[doc(inline)]
pub use hwmodel::Overflow;
#[doc(inline)]
pub use machine::Simulated;
#[doc(inline)]
pub use picture::{Background, Buffer, Shading};
#[doc(inline)]
pub use project::{CageKind, CameraError, Coverage, EngineError, OCCLUSION_ORDER, SetupError};

// Modules for the other crates of this workspace; not part of the API.
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
