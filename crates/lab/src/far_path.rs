//! A walk around far voxels and up to them: what anti-aliased voxels cost, frame by frame.
//!
//! Wagner et al. 2007, Fig. 5: frames per second along a path, with voxels that have
//! opacities and with opaque ones. At every place all kinds draw, one after the
//! other, each with what it remembers of its own last frame.

use glam::{DQuat, DVec3};
use serde::Serialize;

use crate::bench::Clock;
use crate::error::PixelStyle;
use crate::methods::opacity_in_words;
use crate::report::plot::{Axis, Chart, Panel, Scale, Series};
use crate::report::{Cell, Table};
use shiftvox::project::Camera;
use shiftvox_mesh::drawing::mesh_view::{light_of, view_of};
use shiftvox_mesh::far::FarFile;
use shiftvox_mesh::far::view::{FarCounts, FarViewer, Opacity, ViewError, ViewOptions};

/// What is walked.
#[derive(Debug, Clone, PartialEq)]
pub struct FarPathPlan {
    /// Frames of the walk, 2 or more.
    pub frames: u32,
    /// Pixels across and down.
    pub size: (u32, u32),
    /// Largest voxel, pixels.
    pub voxel_px: f64,
    /// Which kinds of opacities draw.
    pub opacities: Vec<Opacity>,
    /// Whether hidden nodes are left out.
    pub culling: bool,
    /// How often the walk is walked; a frame's time is its least.
    pub runs: u32,
}

/// A walk of one kind.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FarPathTimes {
    /// What opacities are used for.
    pub opacity: &'static str,
    /// Time of each frame, milliseconds, the least of the runs.
    pub ms: Vec<f64>,
    /// Sums over the frames of one run.
    pub sums: Sums,
}

/// Counts of all frames of a walk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[allow(missing_docs, reason = "named as in `FarCounts`")]
pub struct Sums {
    pub visited: u64,
    pub queries: u64,
    pub hidden: u64,
    pub voxel_nodes: u64,
    pub leaves: u64,
    pub opaque_voxels: u64,
    pub transparent_voxels: u64,
    pub triangles: u64,
}

impl Sums {
    fn add(&mut self, counts: &FarCounts) {
        self.visited += counts.visited;
        self.queries += counts.queries;
        self.hidden += counts.hidden;
        self.voxel_nodes += counts.voxel_nodes;
        self.leaves += counts.leaves;
        self.opaque_voxels += counts.opaque_voxels;
        self.transparent_voxels += counts.transparent_voxels;
        self.triangles += counts.triangles;
    }
}

/// The camera of a frame: once around, from two and a half sizes away to a
/// third of one and back, from a little above.
#[must_use]
pub fn camera(file: &FarFile, frame: u32, plan: &FarPathPlan) -> Camera {
    let (low, high) = file.bounds();
    let target = (low + high) / 2.0;
    let size = (high - low).length();
    let way = f64::from(frame) / f64::from(plan.frames.max(1));
    let near = 0.5 - 0.5 * libm::cos(std::f64::consts::TAU * way);
    let distance = size * (2.5 + (0.33 - 2.5) * near);
    let up = if file.y_up() { DVec3::Y } else { DVec3::Z };
    let side = if file.y_up() { DVec3::Z } else { DVec3::X };
    let turned = DQuat::from_axis_angle(up, std::f64::consts::TAU * way) * side;
    Camera {
        eye: target + (turned + up * 0.3).normalize() * distance,
        target,
        up,
        fov_degrees: 50.0,
        width: plan.size.0,
        height: plan.size.1,
    }
}

/// Walks.
///
/// # Errors
/// When the file's data is damaged or the picture too large.
pub fn walk(file: &FarFile, plan: &FarPathPlan) -> Result<Vec<FarPathTimes>, ViewError> {
    let style = PixelStyle::default();
    let mut walks: Vec<FarPathTimes> = plan
        .opacities
        .iter()
        .map(|&opacity| FarPathTimes {
            opacity: opacity_in_words(opacity),
            ms: vec![f64::INFINITY; plan.frames as usize],
            sums: Sums::default(),
        })
        .collect();
    for run in 0..plan.runs.max(1) {
        let viewers = plan.opacities.iter().map(|_| FarViewer::new(file));
        let mut viewers: Vec<FarViewer<'_>> = viewers.collect();
        for frame in 0..plan.frames {
            // Up is never along the view, and all numbers are finite.
            let Ok(view) = view_of(&camera(file, frame, plan), file.bounds()) else {
                continue;
            };
            let kinds = plan.opacities.iter().zip(&mut viewers).zip(&mut walks);
            for ((&opacity, viewer), walk) in kinds {
                let options = ViewOptions {
                    voxel_px: plan.voxel_px,
                    opacity,
                    light: light_of(&view, style.shading),
                    background: Some(style.background),
                    culling: plan.culling,
                    ..ViewOptions::default()
                };
                let clock = Clock::start();
                let (picture, counts) = viewer.draw(&view, &options)?;
                let ms = clock.elapsed().wall_ms;
                std::hint::black_box(picture);
                let least = &mut walk.ms[frame as usize];
                *least = least.min(ms);
                if run == 0 {
                    walk.sums.add(&counts);
                }
            }
        }
    }
    Ok(walks)
}

/// The share of a walk's frames that is faster, from 0 to 1: its quantile.
fn quantile(ms: &[f64], share: f64) -> f64 {
    let mut sorted = ms.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    let place = libm::round(share * last as f64) as usize;
    sorted.get(place).copied().unwrap_or(f64::NAN)
}

/// A row for each kind; counts are means of a frame.
#[must_use]
pub fn table(name: &str, walks: &[FarPathTimes]) -> Table {
    let columns = "opacity median_ms slowest_tenth_ms worst_ms nodes_visited queries hidden \
        voxel_nodes leaves opaque_voxels transparent_voxels triangles";
    let title = format!("{name}: a walk, means of a frame");
    let mut table = Table::of(title, columns);
    for walk in walks {
        let mean = |sum: u64| Cell::Count(sum / walk.ms.len().max(1) as u64);
        let sums = &walk.sums;
        table.rows.push(vec![
            walk.opacity.into(),
            Cell::ms(quantile(&walk.ms, 0.5)),
            Cell::ms(quantile(&walk.ms, 0.9)),
            Cell::ms(quantile(&walk.ms, 1.0)),
            mean(sums.visited),
            mean(sums.queries),
            mean(sums.hidden),
            mean(sums.voxel_nodes),
            mean(sums.leaves),
            mean(sums.opaque_voxels),
            mean(sums.transparent_voxels),
            mean(sums.triangles),
        ]);
    }
    table
}

/// Frames per second along the way.
#[must_use]
pub fn panel(name: &str, walks: &[FarPathTimes]) -> Panel {
    let series = walks.iter().map(|walk| {
        let points = walk.ms.iter().enumerate();
        let points = points.map(|(frame, ms)| (frame as f64, 1e3 / ms));
        Series::curve(format!("opacity {}", walk.opacity), points)
    });
    let axis = |label: &str| Axis {
        label: label.to_owned(),
        scale: Scale::Linear,
    };
    Panel::Chart(Chart {
        title: name.to_owned(),
        x: axis("frame"),
        y: axis("frames per second"),
        series: series.collect(),
        level: None,
    })
}
