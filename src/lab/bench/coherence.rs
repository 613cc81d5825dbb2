//! `bench coherence`: what the next frame of a turntable could take from the last.
//!
//! The camera circles its target; each frame is compared with the one
//! before. Nothing is timed: shares are the same in every run.

use std::collections::HashSet;

use glam::DVec3;
use serde::Serialize;

use super::candidate::Candidate;
use super::harness::BenchError;
use super::measure::Subject;
use crate::frame::NO_NODE;
use crate::graph::Progress;
use crate::project::{Camera, Contents, FrameSetup, SetupOptions, Viewer};
#[cfg(feature = "cli")]
use crate::report::plot::{Chart, Panel, Series};
use crate::report::{Cell, Table};

/// Pairs of frames, and what they have in common.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Common {
    /// Pairs of frames.
    pub pairs: u32,
    /// Samples of the later frames that show a node.
    pub samples: u64,
    /// Those of them that show the node that they showed before.
    pub samples_same: u64,
    /// Nodes that the later frames show, each once for each frame.
    pub nodes: u64,
    /// Those of them that the earlier frame showed too, anywhere.
    pub nodes_seen_before: u64,
}

impl Common {
    /// Adds a frame and the one before it.
    pub fn add(&mut self, before: &[u32], after: &[u32]) {
        let seen = |&&node: &&u32| node != NO_NODE;
        let old: HashSet<u32> = before.iter().filter(seen).copied().collect();
        let new: HashSet<u32> = after.iter().filter(seen).copied().collect();
        let same = |(before, after): &(&u32, &u32)| before == after && **after != NO_NODE;
        self.pairs += 1;
        self.samples += after.iter().filter(seen).count() as u64;
        self.samples_same += before.iter().zip(after).filter(same).count() as u64;
        self.nodes += new.len() as u64;
        self.nodes_seen_before += new.intersection(&old).count() as u64;
    }

    /// Share of the nodes that the frame before showed too, 0 to 1; 0 of none.
    #[must_use]
    pub fn node_share(&self) -> f64 {
        share(self.nodes_seen_before, self.nodes)
    }

    /// Share of the samples that show the same node as before, 0 to 1; 0 of none.
    #[must_use]
    pub fn sample_share(&self) -> f64 {
        share(self.samples_same, self.samples)
    }
}

fn share(part: u64, of: u64) -> f64 {
    part as f64 / of.max(1) as f64
}

/// What frames a step apart have in common.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CoherenceRow {
    /// The scene.
    pub scene: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// How far the camera goes around between two frames, degrees.
    pub step_degrees: f64,
    /// What was counted.
    #[serde(flatten)]
    pub common: Common,
    /// [`Common::node_share`].
    pub node_share: f64,
    /// [`Common::sample_share`].
    pub sample_share: f64,
}

/// Where turntables begin, degrees: so that a step does not stand for one view alone.
const STARTS: [f64; 4] = [0.0, 90.0, 180.0, 270.0];

/// Compares frames that lie each of the steps apart, from four sides.
///
/// # Errors
/// When a frame cannot be set up or drawn.
pub fn run(
    subject: &Subject,
    size: (u32, u32),
    options: &SetupOptions,
    steps: &[f64],
    candidate: &Candidate,
    progress: &dyn Progress,
) -> Result<Vec<CoherenceRow>, BenchError> {
    let graph = &subject.graph;
    let engine = (candidate.make)(rayon::current_num_threads());
    let mut viewer = Viewer::new(graph.view(), engine, Contents::Nodes);
    let mut draw = |degrees: f64| {
        let camera = Camera {
            width: size.0,
            height: size.1,
            ..turned(&subject.camera, degrees)
        };
        let setup = FrameSetup::new(&camera, &graph.placement, graph.depth, options)?;
        let drawn = viewer.draw(&setup);
        drawn.map_err(|source| BenchError::Engine {
            who: format!("{}, {}", subject.name, candidate.name),
            source,
        })?;
        Ok::<_, BenchError>(viewer.frame().map_or_else(Vec::new, |f| f.node.clone()))
    };
    let mut common = vec![Common::default(); steps.len()];
    let frames = STARTS.len() * (steps.len() + 1);
    progress.begin("drawing", frames as u64);
    for start in STARTS {
        let before = draw(start)?;
        progress.advance(1);
        for (common, step) in common.iter_mut().zip(steps) {
            common.add(&before, &draw(start + step)?);
            progress.advance(1);
        }
    }
    progress.end();
    let row = |(&step_degrees, common): (&f64, Common)| CoherenceRow {
        scene: subject.name.clone(),
        width: size.0,
        height: size.1,
        step_degrees,
        common,
        node_share: common.node_share(),
        sample_share: common.sample_share(),
    };
    Ok(steps.iter().zip(common).map(row).collect())
}

/// A camera that went around its target, about the direction that is up.
pub(in crate::lab) fn turned(camera: &Camera, degrees: f64) -> Camera {
    let axis = camera.up.normalize_or_zero();
    let (sin, cos) = libm::sincos(degrees.to_radians());
    let offset = camera.eye - camera.target;
    let along = axis * axis.dot(offset);
    let around: DVec3 = (offset - along) * cos + axis.cross(offset) * sin;
    Camera {
        eye: camera.target + along + around,
        ..*camera
    }
}

/// The rows as a table.
#[must_use]
pub fn table(rows: &[CoherenceRow]) -> Table {
    let columns = [
        "scene",
        "size",
        "step_degrees",
        "pairs",
        "nodes",
        "node_share",
        "samples",
        "sample_share",
    ];
    let title = "What a turntable's next frame has in common with the last";
    let mut table = Table::new(title, &columns);
    for row in rows {
        table.rows.push(vec![
            Cell::Text(row.scene.clone()),
            Cell::Text(format!("{}x{}", row.width, row.height)),
            Cell::ratio(row.step_degrees),
            u64::from(row.common.pairs).into(),
            row.common.nodes.into(),
            Cell::ratio(row.node_share),
            row.common.samples.into(),
            Cell::ratio(row.sample_share),
        ]);
    }
    table
}

/// Shares by step, a plot for each scene.
#[cfg(feature = "cli")]
#[must_use]
pub fn panels(rows: &[CoherenceRow]) -> Vec<Panel> {
    let panel = |rows: &[CoherenceRow]| {
        let points = rows.iter().flat_map(|row| {
            [
                ("nodes seen before", row.node_share),
                ("samples that show the same node", row.sample_share),
            ]
            .map(|(name, share)| (name.to_owned(), (row.step_degrees, share)))
        });
        let scene = rows.first().map_or("", |row| row.scene.as_str());
        let across = "degrees between two frames";
        Panel::Chart(Chart::growth(
            scene,
            across,
            "share",
            Series::collect(points),
        ))
    };
    rows.chunk_by(|a, b| a.scene == b.scene)
        .map(panel)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_two_frames_have_in_common() {
        let mut common = Common::default();
        common.add(&[1, 1, 2, NO_NODE], &[1, 3, NO_NODE, NO_NODE]);
        let expected = Common {
            pairs: 1,
            samples: 2,
            samples_same: 1,
            nodes: 2,
            nodes_seen_before: 1,
        };
        assert_eq!(common, expected);
        common.add(&[3], &[3]);
        assert_eq!(
            (common.node_share(), common.sample_share()),
            (2.0 / 3.0, 2.0 / 3.0)
        );
        assert_eq!(Common::default().node_share(), 0.0);
    }

    #[test]
    fn a_turn_keeps_height_and_distance() {
        let camera = Camera {
            eye: DVec3::new(5.0, 1.0, 7.0),
            target: DVec3::new(2.0, 1.0, 3.0),
            up: DVec3::Z * 4.0,
            fov_degrees: 60.0,
            width: 1,
            height: 1,
        };
        let quarter = turned(&camera, 90.0).eye;
        assert!(
            (quarter - DVec3::new(2.0, 4.0, 7.0)).length() < 1e-12,
            "{quarter}"
        );
        assert_eq!(turned(&camera, 0.0), camera);
    }
}
