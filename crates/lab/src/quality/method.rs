//! Anything that draws a picture from a camera.

use crate::measure::Spread;
use crate::report::Cell;
use shiftvox::drawing::{DrawError, Drawable, Figures, Shown};
use shiftvox::graph::Graph;
use shiftvox::project::{Camera, Stats};

/// A way to draw a scene: an engine with its settings, or any other renderer.
pub struct Method<'m> {
    /// Its family, such as `voxels`. Methods of a family have the same settings and counters.
    pub family: &'static str,
    /// Its name, unlike that of every other method.
    pub name: String,
    /// Its settings: names and values.
    pub settings: Vec<(&'static str, Cell)>,
    /// A word by which plots colour it, such as its coverage rule.
    pub kind: String,
    /// The graph whose voxels it draws, if it draws any.
    pub graph: Option<&'m Graph>,
    /// Bytes of its data.
    pub bytes: Option<u64>,
    /// Time to make that, milliseconds.
    pub build_ms: Option<f64>,
    /// Makes a drawing that has drawn no frame.
    pub drawing: Box<dyn Fn() -> Box<dyn Drawable + 'm> + 'm>,
    /// Examines a drawn frame.
    pub examine: Box<Examine<'m>>,
    /// Draws with the level of detail of another camera, if it has levels of detail.
    pub with_cut_of: Option<Box<WithCutOf<'m>>>,
}

/// See [`Method::examine`].
pub type Examine<'m> = dyn Fn(&Shown<'_>, &Camera) -> Result<Examined, Refused> + 'm;
/// See [`Method::with_cut_of`]: the camera, then the one that chooses the level of detail.
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
pub(super) fn drawn<'d>(
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

/// Properties of a drawn frame beside its colours.
#[derive(Debug, Clone, Default)]
pub struct Examined {
    /// Share of each pixel that is covered, 0 to 1.
    pub shares: Vec<f32>,
    /// Voxels at the samples; `None` for methods that draw no voxels.
    pub samples: Option<Samples>,
    /// Distances of vertices from their exact projections, pixels.
    pub vertices: Option<Spread>,
    /// Counters of the frame. The first is the method's work.
    pub counters: Stats,
    /// A remark, such as which engine drew in its place.
    pub remark: Option<String>,
}

/// Voxels at the samples, with `2^aa_log2` samples along each axis of a pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Samples per pixel and axis, as a power of two.
    pub aa_log2: u32,
    /// As in a frame: lowest corner in finest voxels, and level.
    pub voxel: Vec<[i32; 4]>,
    /// Depth of each pixel.
    pub depth: Vec<f32>,
}

/// A counter of a method, and the counters of its drawing of which it is the sum.
pub(super) type Sum = (&'static str, &'static [&'static str]);

/// Counters as sums; missing parts count as 0.
pub(super) fn sums(figures: &Figures, of: &[Sum]) -> Stats {
    let count = |name: &&str| {
        let figure = figures.iter().find(|(of, _)| of == name);
        figure.and_then(|(_, value)| value.as_u64()).unwrap_or(0)
    };
    let sum = |&(name, parts): &Sum| (name, parts.iter().map(count).sum());
    of.iter().map(sum).collect()
}
