//! What can be measured: anything that draws a picture from a camera.
//!
//! An experiment does not depend on how a picture is made. It asks a
//! [`DrawingMethod`] what it is called and how it is set, sets it up for a camera,
//! lets it draw frames, which are timed, and lets it show one, which is not.

use crate::measure::Spread;
use crate::picture::Picture;
use crate::project::{Camera, Stats};

/// A way to draw a scene: an engine with its settings, or any other renderer.
pub trait DrawingMethod: Send {
    /// Which family it is of, such as `voxels`: methods of one family have the
    /// same settings by name and order.
    fn family(&self) -> &'static str;

    /// Its name, unlike that of every other in the experiment.
    fn name(&self) -> String;

    /// Its settings: names and values.
    fn settings(&self) -> Vec<(&'static str, String)>;

    /// A word by which plots give it a colour, such as its drawing rule.
    fn kind(&self) -> String;

    /// Makes ready for a camera, buffers too: what a frame's time does not contain.
    ///
    /// # Errors
    /// When it cannot draw from this camera.
    fn begin(&mut self, camera: &Camera) -> Result<(), Refused>;

    /// Draws a frame: clear, traverse, colours of the samples. Timed.
    ///
    /// # Errors
    /// When the frame cannot be finished.
    fn draw(&mut self) -> Result<(), Refused>;

    /// Draws the frame once more, and measures it.
    ///
    /// # Errors
    /// When the frame cannot be finished.
    fn show(&mut self) -> Result<Shown, Refused>;

    /// Draws the frame once more, and its picture alone.
    ///
    /// # Errors
    /// When the frame cannot be finished.
    fn picture(&mut self) -> Result<Picture, Refused>;

    /// Draws the picture with the decisions of level of detail that another
    /// camera would make, from the camera that it is ready for; `None` of what
    /// has no such decisions.
    ///
    /// # Errors
    /// When the frame cannot be finished.
    fn picture_with_cut_of(&mut self, other: &Camera) -> Result<Option<Picture>, Refused>;

    /// Lets go of what was made for a camera.
    fn end(&mut self);
}

/// Why a method has no picture: an overflow, a view that collapses.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Refused(pub String);

impl Refused {
    /// For a reason.
    pub fn because(reason: impl std::fmt::Display) -> Self {
        Self(reason.to_string())
    }
}

/// A drawn frame and its figures.
#[derive(Debug, Clone)]
pub struct Shown {
    /// The picture, before a background: opaque.
    pub picture: Picture,
    /// Share of each pixel that shows something, 0 to 1.
    pub shares: Vec<f32>,
    /// What its samples see; `None` for what has no samples of voxels.
    pub samples: Option<Samples>,
    /// How far its vertices are from exact projection; empty for what has none.
    pub vertices: Vec<VertexLevel>,
    /// What it counted of a frame. The same names in the same order for all
    /// methods of a family; the first is its work: what the machine-independent
    /// plots have across.
    pub counters: Stats,
    /// Remarks, such as which engine drew in its place.
    pub remark: Option<String>,
}

/// What samples see, of a picture with `2^aa_log2` of them along each axis of a pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Samples {
    /// Samples a pixel and axis, as a power of two.
    pub aa_log2: u32,
    /// As a frame has them: lowest corner in finest voxels, and level.
    pub voxel: Vec<[i32; 4]>,
}

/// How far vertices of one octree level are from their exact projections.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct VertexLevel {
    /// Octree level, 0 = root.
    pub level: u32,
    /// Records whose vertices were examined.
    pub records: u64,
    /// Those of them that are held in screen space.
    pub on_screen: u64,
    /// Distances, pixels.
    pub px: Spread,
}

/// All levels together: worst of the worst, mean of all, and the greatest percentile.
#[must_use]
pub fn over_levels(levels: &[VertexLevel]) -> Option<Spread> {
    let count: u64 = levels.iter().map(|level| level.px.count).sum();
    let most = |of: fn(&Spread) -> f64| levels.iter().map(|l| of(&l.px)).fold(0.0, f64::max);
    let sum: f64 = levels.iter().map(|l| l.px.mean * l.px.count as f64).sum();
    (count > 0).then(|| Spread {
        count,
        mean: sum / count as f64,
        percentile_99_9: most(|px| px.percentile_99_9),
        worst: most(|px| px.worst),
    })
}
