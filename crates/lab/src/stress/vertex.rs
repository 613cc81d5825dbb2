//! The machine's vertices against the specification, bit for bit, and against the true projection.

use glam::DVec3;

use super::specified::SpecifiedVertices;
use super::subject::Subject;
use crate::bounds::{Bounds, Cube, Space};
use shiftvox::machine::Cage;
use shiftvox::project::{CageKind, FrameSetup};

/// The space and the cage in which vertices are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Hold {
    Clip,
    Corners,
    Frame,
}

impl Hold {
    pub const ALL: [Self; 3] = [Self::Clip, Self::Corners, Self::Frame];

    pub fn name(self) -> &'static str {
        match self {
            Self::Clip => "clip space, both cages",
            Self::Corners => "screen space, corners",
            Self::Frame => "screen space, frame",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Worst {
    pub vertices: u64,
    /// Largest error, samples, of those within the picture.
    pub error_px: f64,
    pub bound_px: f64,
    /// Largest quotient of error and bound, over all vertices before the eye.
    pub tightest: f64,
}

impl Worst {
    pub(super) fn merge(&mut self, other: &Self) {
        self.vertices += other.vertices;
        self.tightest = self.tightest.max(other.tightest);
        if other.error_px > self.error_px {
            (self.error_px, self.bound_px) = (other.error_px, other.bound_px);
        }
    }

    fn note(&mut self, error_px: f64, bound_px: f64, is_in_picture: bool) {
        self.vertices += 1;
        if bound_px.is_finite() {
            self.tightest = self.tightest.max(error_px / bound_px);
            if is_in_picture && error_px > self.error_px {
                (self.error_px, self.bound_px) = (error_px, bound_px);
            }
        }
    }
}

#[derive(Default)]
pub(super) struct Vertices {
    pub(super) worst: [Worst; 3],
    pub(super) differs: Option<String>,
    pub(super) beyond: Option<String>,
}

/// Error of the check's own arithmetic, samples per sample of the root's side.
const CHECK_ERROR: f64 = 1e-14;

pub(super) fn check_path(
    subject: &dyn Subject,
    setup: &FrameSetup,
    bounds: &Bounds,
    path: &[u8],
    found: &mut Vertices,
) {
    // A trap here is a trap of the frame, too, or of a root far outside the picture.
    let Ok(way) = subject.cages_along(setup, path) else {
        return;
    };
    let specified = SpecifiedVertices::new(setup);
    let mut changed: Option<usize> = None;
    for (level, held) in way.iter().enumerate() {
        let here = &path[..level];
        if changed.is_none() && !matches!(held, Cage::Clip(_)) {
            changed = Some(level);
            let (is, least) = specified.change_depths(here);
            if is < least {
                found.differs.get_or_insert_with(|| {
                    format!(
                        "the voxel at path {here:?} changed to screen space at depth {is}, nearer than {least}"
                    )
                });
            }
        }
        let right = specified.held(here, changed);
        if right.as_ref() != Some(held) {
            found.differs.get_or_insert_with(|| {
                format!(
                    "the voxel at path {here:?}, changed at {changed:?}: held {held:?}, by the specification {right:?}"
                )
            });
        }
        measure(setup, bounds, &specified, here, changed, held, found);
    }
}

fn cube(specified: &SpecifiedVertices<'_>, setup: &FrameSetup, path: &[u8]) -> Cube {
    let (corner, side) = specified.cube(path);
    let unit = libm::ldexp(1.0, -(setup.sub_levels as i32));
    Cube {
        corner: DVec3::from_array(corner.map(|c| c as f64 * unit)),
        side: side as f64 * unit,
    }
}

fn measure(
    setup: &FrameSetup,
    bounds: &Bounds,
    specified: &SpecifiedVertices<'_>,
    path: &[u8],
    changed: Option<usize>,
    held: &Cage,
    found: &mut Vertices,
) {
    let voxel = cube(specified, setup, path);
    let levels = (path.len() - changed.unwrap_or(path.len())) as u32;
    let top = cube(specified, setup, &path[..changed.unwrap_or(path.len())]);
    let root = libm::ldexp(1.0, setup.levels as i32);
    let (hold, space) = match (held, setup.options.cage) {
        (Cage::Clip(_), _) => (Hold::Clip, Space::Clip),
        (Cage::Screen(_), CageKind::Corners) => (Hold::Corners, Space::Corners(top)),
        (Cage::Screen(_), CageKind::Frame) => (Hold::Frame, Space::Frame(top)),
    };
    let size = [setup.width, setup.height].map(f64::from);
    for vertex in 0..8usize {
        let bit = |k: usize| (vertex >> (2 - k) & 1) as f64;
        let u = voxel.corner + DVec3::new(bit(0), bit(1), bit(2)) * voxel.side;
        let near = libm::ldexp(setup.near as f64, -(setup.clip_frac as i32));
        if bounds.depth(u) < near {
            continue;
        }
        let Some(truth) = bounds.project(u) else {
            continue;
        };
        let bound = bounds.vertex(space, levels, u);
        let mut note = |off: f64, bound: f64| {
            let bound = bound + CHECK_ERROR * root;
            let inside = (0..2).all(|c| (0.0..=size[c]).contains(&truth[c]));
            found.worst[hold as usize].note(off, bound, inside);
            if off > bound && found.beyond.is_none() {
                found.beyond = Some(format!(
                    "{}: vertex {vertex} of path {path:?}, changed at {changed:?}, is off by \
                     {off:.3e} samples, more than {bound:.3e}",
                    hold.name()
                ));
            }
        };
        match held {
            Cage::Clip([x, y, w]) => {
                for (c, x) in [x, y].into_iter().enumerate() {
                    let is = x[vertex] as f64 / w[vertex] as f64 * root;
                    // Behind the eye once it is rounded: the bound is then infinite.
                    if w[vertex] > 0 {
                        note((is - truth[c]).abs(), bound[c]);
                    }
                }
            }
            Cage::Screen(positions) => {
                for (c, x) in positions.iter().enumerate() {
                    let is = libm::ldexp(x[vertex] as f64, -(setup.format.frac() as i32));
                    note((is - truth[c]).abs(), bound[c]);
                }
            }
        }
    }
}
