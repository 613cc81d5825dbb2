//! What can be measured: anything that draws a picture from a camera.
//!
//! An experiment does not depend on how a picture is made. A [`Method`] says what it is called and
//! how it is set, and makes a [`Drawable`], which draws.

use crate::measure::Spread;
use shiftvox::drawing::{DrawError, Drawable, Figures, Shown};
use shiftvox::project::{Camera, Stats};

/// A way to draw a scene: an engine with its settings, or any other renderer.
pub struct Method<'m> {
    /// Which family it is of, such as `voxels`: methods of one family have the
    /// same settings by name and order.
    pub family: &'static str,
    /// Its name, unlike that of every other in the experiment.
    pub name: String,
    /// Its settings: names and values.
    pub settings: Vec<(&'static str, String)>,
    /// A word by which plots give it a colour, such as its drawing rule.
    pub kind: String,
    /// Makes what draws it, which remembers no other frame.
    pub drawing: Box<dyn Fn() -> Box<dyn Drawable + 'm> + 'm>,
    /// Examines a frame that was drawn from a camera.
    pub examine: Box<Examine<'m>>,
    /// Draws from a camera with the level of detail that another one would choose; `None` of what
    /// has no such choice.
    pub with_cut_of: Option<Box<WithCutOf<'m>>>,
}

/// See [`Method::examine`].
pub type Examine<'m> = dyn Fn(&Shown<'_>, &Camera) -> Result<Examined, Refused> + 'm;
/// See [`Method::with_cut_of`]: the camera, then the one that chooses. Makes colours.
pub type WithCutOf<'m> = dyn Fn(&Camera, &Camera) -> Result<Vec<[u8; 4]>, Refused> + 'm;

impl Method<'_> {
    /// Draws a frame, and examines it.
    ///
    /// # Errors
    /// When the method cannot draw from this camera.
    pub fn show(&self, camera: &Camera) -> Result<(Vec<[u8; 4]>, Examined), Refused> {
        let mut drawing = (self.drawing)();
        let shown = drawn(drawing.as_mut(), camera)?;
        let examined = (self.examine)(&shown, camera)?;
        Ok((shown.pixels.rgba(), examined))
    }
}

/// Draws a frame.
pub(crate) fn drawn<'d>(
    drawing: &'d mut (dyn Drawable + '_),
    camera: &Camera,
) -> Result<Shown<'d>, Refused> {
    drawing.draw(camera, 1)?;
    let shown = drawing.shown()?;
    shown.ok_or_else(|| Refused::because("nothing was drawn"))
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

impl From<DrawError> for Refused {
    fn from(reason: DrawError) -> Self {
        Self::because(reason)
    }
}

/// What experiments ask of a drawn frame beside its colours.
#[derive(Debug, Clone, Default)]
pub struct Examined {
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
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Samples a pixel and axis, as a power of two.
    pub aa_log2: u32,
    /// As a frame has them: lowest corner in finest voxels, and level.
    pub voxel: Vec<[i32; 4]>,
    /// Depth of each pixel.
    pub depth: Vec<f32>,
}

/// A counter of a method, as a sum of counters of what draws it; see `sums`.
pub type Sum = (&'static str, &'static [&'static str]);

/// Counters as sums of other ones; those that are not there count as 0.
pub(crate) fn sums(figures: &Figures, of: &[Sum]) -> Stats {
    let count = |name: &&str| {
        let figure = figures.iter().find(|(of, _)| of == name);
        figure.and_then(|(_, value)| value.as_u64()).unwrap_or(0)
    };
    let sum = |&(name, parts): &Sum| (name, parts.iter().map(count).sum());
    of.iter().map(sum).collect()
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
