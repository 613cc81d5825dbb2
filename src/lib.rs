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

mod api;

#[doc(hidden)]
pub use api::start_threads;
pub use api::{Camera, EngineKind, Error, FittedCamera, Picture, Renderer, Scene};
pub use hwmodel;

/// The identity of all pictures: a hash of the golden pictures and counts (`crates/web/src/golden.txt`), 32 bytes as
/// hexadecimal digits. Tests draw them on each supported computer. Versions with the same identity draw the same pictures.
pub const IDENTITY: &str = "ef1eeba30704778e788244a2aeda202095eec8ae088ae87ab199da411bd1d868";

/// Exports items with an example each, in which there are a scene and a camera.
macro_rules! with_examples {
    ($($module:ident::$item:ident $code:literal)+) => {
        $(
            #[doc = concat!(
                "```\n# use shiftvox::*;\n",
                "# let scene = Scene::generate(\"menger,depth=2\")?;\n",
                "# let camera = Camera::fit(&scene);\n",
                $code,
                "\n# Ok::<(), shiftvox::Error>(())\n```"
            )]
            #[doc(inline)]
            pub use $module::$item;
        )+
    };
}

with_examples! {
    api::Up "assert_eq!(scene.up(), Up::Z); // voxel files; meshes have mostly `Up::Y`
let lying = scene.with_up(Up::Y);
let camera = Camera::fit(&lying);"
    api::View "fn side_by_side(scene: &Scene, views: [&impl View; 2]) -> Result<[Picture; 2], Error> {
    let [left, right] = views.map(|view| Renderer::new().render(scene, view, 32, 32));
    Ok([left?, right?])
}
let inside = Camera::look_at([4.5, 0.5, 4.5], [4.5, 9.0, 4.5]);
side_by_side(&scene, [&inside, &inside.clone().field_of_view(100.0)])?;
side_by_side(&scene, [&camera, &camera.clone().azimuth(90.0)])?;"
    budget::Shortage r#"match Renderer::new().render(&scene, &camera, 64, 64) {
    Err(Error::Memory(short)) => println!("{} bytes are needed, {:?} are free", short.needed, short.free),
    other => drop(other?),
}"#
    graph::PackedNormal "let voxel = Voxel {
    index: [0, 0, 0],
    color: [200, 180, 160],
    normal: Some(PackedNormal::encode([0.0, 0.6, 0.8].into())),
};
Scene::from_voxels([voxel])?;"
    graph::Voxel "let row = (0..10).map(|x| Voxel { index: [x, 0, 0], color: [25 * x as u8, 80, 80], normal: None });
assert_eq!(Scene::from_voxels(row)?.voxels(), 10);"
    machine::Simulated r#"use shiftvox::hwmodel::cycles::Hardware;
let hardware = Hardware::preset("light").expect("it ships");
let simulated: Simulated = Renderer::new().word(32, None).simulate(&scene, &camera, 32, 32, &hardware)?;
assert!(simulated.cycles.cycles > 0);"#
    picture::Background "let clear = Renderer::new().background(Background::None);
let corner = clear.render(&scene, &camera, 32, 32)?.pixel(0, 0);
assert_eq!(corner.map(|[.., alpha]| alpha), Some(0));"
    picture::Buffer "let renderer = Renderer::new().buffers([Buffer::Depth, Buffer::Normal]);
let picture = renderer.render(&scene, &camera, 32, 32)?;
assert_eq!(picture.depth()?.len(), picture.normals()?.len());"
    picture::Shading "// Colours as the file has them: any pixel that is not background has the colour of a voxel.
Renderer::new().shading(Shading::Flat).render(&scene, &camera, 32, 32)?;"
    project::CageKind "// The two ways to store a voxel's projected vertices show the same picture, for other operations.
let machine = Renderer::new().count_operations();
let frame = machine.render(&scene, &camera, 16, 16)?;
let corners = machine.cage(CageKind::Corners).render(&scene, &camera, 16, 16)?;
assert_eq!(frame.rgba(), corners.rgba());
assert_ne!(frame.operations(), corners.operations());"
    project::CameraError "let nowhere = Camera::look_at([1.0; 3], [1.0; 3]);
let drawn = Renderer::new().render(&scene, &nowhere, 32, 32);
assert!(matches!(drawn, Err(Error::Setup(SetupError::Camera(CameraError::NoDirection)))));"
    project::Coverage r#"let exact = Renderer::new().render(&scene, &camera, 32, 32)?;
let any = Renderer::new().coverage(Coverage::Any).render(&scene, &camera, 32, 32)?;
assert!(any.counter("samples_drawn") > exact.counter("samples_drawn"));"#
    project::EngineError r#"// Words that are too short for a frame: an error, unless another `Overflow` is chosen.
let short = Renderer::new().engine(EngineKind::Machine).word(16, Some(12));
match short.render(&scene, &camera, 32, 32) {
    Err(Error::Engine(EngineError::Trap(trap))) => println!("{trap}"),
    other => drop(other),
}"#
    project::OCCLUSION_ORDER "// From any octant the nearest child comes first, and the farthest last.
for eye in 0..8 {
    let order = OCCLUSION_ORDER.map(|child| child ^ 7 ^ eye);
    assert_eq!((order[0], order[7]), (eye, eye ^ 7));
}"
    project::SetupError "let drawn = Renderer::new().tolerance(1.0).render(&scene, &camera, 32, 32);
assert!(matches!(drawn, Err(Error::Setup(SetupError::Tolerance(_))))); // `Coverage::Exact` approximates nothing"
    project::Stop "use std::time::{Duration, Instant};
// No picture may take longer than a minute.
let end = Instant::now() + Duration::from_secs(60);
let renderer = Renderer::new().stopped_by(&Stop::when(move || Instant::now() > end));
renderer.render(&scene, &camera, 32, 32)?;
let stopped = renderer.stopped_by(&Stop::when(|| true)).render(&scene, &camera, 32, 32);
assert!(matches!(stopped, Err(Error::Engine(EngineError::Stopped))));"
    hwmodel::Overflow "// Saturating words draw on where exact ones would be too short.
let machine = Renderer::new().engine(EngineKind::Machine).overflow(Overflow::Saturate);
machine.word(24, None).render(&scene, &camera, 32, 32)?;"
}

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
