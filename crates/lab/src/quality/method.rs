//! Anything that draws a picture from a camera.

use crate::report::Cell;
use shiftvox::drawing::{DrawError, Drawable, Figures, Shown};
use shiftvox::graph::Graph;
use shiftvox::project::{Camera, Stats};

pub struct Method<'m> {
    /// Its family, such as `voxels`. Methods of a family have the same settings and counters.
    pub(super) family: &'static str,
    pub(super) name: String,
    pub(super) settings: Vec<(&'static str, Cell)>,
    /// A word by which plots colour it, such as its coverage rule.
    pub(super) kind: String,
    pub(super) graph: Option<&'m Graph>,
    pub(super) bytes: u64,
    /// Time to make its data, milliseconds.
    pub build_ms: Option<f64>,
    pub(super) drawing: Box<dyn Fn() -> Box<dyn Drawable + 'm> + 'm>,
    pub(super) examine: Box<Examine<'m>>,
}

pub(super) type Examine<'m> = dyn Fn(&Shown<'_>, &Camera) -> Result<Examined, Refused> + 'm;

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
    pub(super) fn because(reason: impl std::fmt::Display) -> Self {
        Self(reason.to_string())
    }
}

impl From<DrawError> for Refused {
    fn from(reason: DrawError) -> Self {
        Self::because(reason)
    }
}

#[derive(Default)]
pub(super) struct Examined {
    pub(super) shares: Vec<f32>,
    /// `aa_log2` and the voxels at the samples, as in a frame; `None` for methods without voxels.
    pub(super) samples: Option<(u32, Vec<[i32; 4]>)>,
    /// Counters of the frame. The first is the method's work.
    pub(super) counters: Stats,
    pub(super) remark: Option<String>,
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
