//! `bench ablation`: what each technique is worth, by switching it off.

use serde::Serialize;

use super::candidate::{Candidate, Family, Frames};
use super::harness::{BenchError, Contender, Drawer, Harness, Measured};
use super::measure::{Subject, as_map, counter, picture_of};
use super::statistics::Summary;
use crate::measure::CoverageError;
use crate::report::plot::{Bar, Panel};
use crate::report::{Cell, Table};
use shiftvox::project::{Contents, FrameSetup, SetupOptions, Stats, Viewer};

/// What tables call an engine with everything on.
pub const WHOLE: &str = "everything on";

/// An engine without one of its techniques, measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AblationRow {
    /// The scene.
    pub scene: String,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// The engine.
    pub engine: &'static str,
    /// What is off, or [`WHOLE`].
    pub variant: &'static str,
    /// What that means.
    pub about: &'static str,
    /// Wall time of a frame.
    pub wall: Summary,
    /// Processor time of a frame.
    pub thread: Option<Summary>,
    /// Time over that of the engine with everything on.
    pub time_ratio: f64,
    /// How much the engine had to do.
    pub work: Option<u64>,
    /// What that counts.
    pub work_unit: &'static str,
    /// All that it counted.
    #[serde(serialize_with = "as_map")]
    pub counters: Stats,
    /// Samples that show another voxel than with everything on.
    pub changed: u64,
    /// How far the picture is from the reference.
    pub coverage: CoverageError,
}

impl AblationRow {
    /// The size in words: `512x512`.
    #[must_use]
    pub fn size(&self) -> String {
        format!("{}x{}", self.width, self.height)
    }

    /// The median that disturbs least, as in [`super::Timing`].
    fn median_ms(&self) -> f64 {
        self.thread.unwrap_or(self.wall).median_ms
    }
}

/// Measures families on a scene, all variants in one race, on one thread.
///
/// # Errors
/// When a frame cannot be set up or drawn, or there are no threads.
pub fn run(
    subject: &Subject,
    size: (u32, u32),
    options: &SetupOptions,
    families: &[Family],
    reference: &Candidate,
    harness: &mut Harness<'_>,
) -> Result<Vec<AblationRow>, BenchError> {
    let setup = subject.setup(size, options)?;
    let right = picture_of(reference, &subject.graph, &setup)?;
    let mut contenders = Vec::new();
    let mut rows: Vec<AblationRow> = Vec::new();
    for family in families {
        let whole = family.whole;
        let contender = |variant: &str, setup: FrameSetup, make: super::MakeEngine| {
            let name = format!("{}, {}, {variant}", subject.name, whole.name);
            Contender::alone(name, &subject.graph, setup, make(1))
        };
        rows.push(blank(subject, size, &whole, WHOLE, whole.about));
        contenders.push(contender(WHOLE, setup.clone(), whole.make));
        for variant in family.variants {
            let mut options = *options;
            (variant.adjust)(&mut options);
            rows.push(blank(subject, size, &whole, variant.name, variant.about));
            let setup = subject.setup(size, &options)?;
            let contender = contender(variant.name, setup, variant.make);
            contenders.push(with_frames(contender, variant.frames)?);
        }
    }
    // Pictures of the families' wholes come before those of their variants.
    let mut whole_picture = Vec::new();
    let measured = harness.race(&mut contenders, &mut |place, frame| {
        let row = &mut rows[place];
        if row.variant == WHOLE {
            whole_picture.clone_from(&frame.voxel);
        }
        row.changed = crate::measure::count_differing(&frame.voxel, &whole_picture);
        row.coverage = CoverageError::between(&frame.voxel, &right);
    })?;
    let mut whole_ms = 0.0;
    for ((row, measured), contender) in rows.iter_mut().zip(measured).zip(&contenders) {
        fill_in(row, measured);
        if row.variant == WHOLE {
            whole_ms = row.median_ms();
        }
        row.time_ratio = ratio(row.median_ms(), whole_ms);
        if !contender.attributes.is_empty() {
            let read = contender.attributes.len() as u64;
            row.counters.push(("attributes_read", read));
        }
    }
    Ok(rows)
}

/// A contender that comes to its frames like this.
fn with_frames(contender: Contender<'_>, frames: Frames) -> Result<Contender<'_>, BenchError> {
    let Contender { graph, drawer, .. } = contender;
    let (drawer, attributes) = match (frames, drawer) {
        (Frames::Kept, Drawer::Engine(engine)) => {
            let viewer = Viewer::new(graph.view(), engine, Contents::Voxels);
            (Drawer::Viewer(Box::new(viewer)), Vec::new())
        }
        (Frames::WithAttributesOf(fetched), drawer) => {
            let nodes = fetched(&graph.view(), &contender.setup);
            let failed = |source| BenchError::Engine {
                who: contender.name.clone(),
                source,
            };
            (drawer, nodes.map_err(failed)?)
        }
        (_, drawer) => (drawer, Vec::new()),
    };
    Ok(Contender {
        drawer,
        attributes,
        ..contender
    })
}

fn blank(
    subject: &Subject,
    size: (u32, u32),
    whole: &Candidate,
    variant: &'static str,
    about: &'static str,
) -> AblationRow {
    AblationRow {
        scene: subject.name.clone(),
        width: size.0,
        height: size.1,
        engine: whole.name,
        variant,
        about,
        wall: Summary::default(),
        thread: None,
        time_ratio: 1.0,
        work: None,
        work_unit: whole.work,
        counters: Stats::new(),
        changed: 0,
        coverage: CoverageError::default(),
    }
}

fn fill_in(row: &mut AblationRow, measured: Measured) {
    row.wall = measured.wall;
    row.thread = measured.thread;
    row.work = counter(&measured.counters, row.work_unit);
    row.counters = measured.counters;
}

/// A time over another, which is above 0.
fn ratio(ms: f64, of_ms: f64) -> f64 {
    ms / of_ms.max(f64::MIN_POSITIVE)
}

/// The rows as a table.
#[must_use]
pub fn table(rows: &[AblationRow]) -> Table {
    let columns = "scene size engine variant median_ms deviation_ms thread_median_ms time_ratio \
        work work_unit picture changed extra missing other_voxel";
    let mut table = Table::of("Techniques switched off in turn", columns);
    for row in rows {
        let picture = if row.changed == 0 { "same" } else { "changed" };
        table.rows.push(vec![
            Cell::Text(row.scene.clone()),
            Cell::Text(row.size()),
            row.engine.into(),
            row.variant.into(),
            Cell::ms(row.wall.median_ms),
            Cell::ms(row.wall.deviation_ms),
            row.thread.map_or(Cell::None, |t| Cell::ms(t.median_ms)),
            Cell::ratio(row.time_ratio),
            row.work.into(),
            row.work_unit.into(),
            picture.into(),
            row.changed.into(),
            row.coverage.extra.into(),
            row.coverage.missing.into(),
            row.coverage.wrong_voxel.into(),
        ]);
    }
    table
}

/// What each variant means.
#[must_use]
pub fn legend(families: &[Family]) -> Table {
    let mut table = Table::new("What is switched off", &["engine", "variant", "meaning"]);
    for family in families {
        for variant in family.variants {
            table.rows.push(vec![
                family.whole.name.into(),
                variant.name.into(),
                variant.about.into(),
            ]);
        }
    }
    table
}

/// Bars for each scene.
#[must_use]
pub fn panels(rows: &[AblationRow]) -> Vec<Panel> {
    let bar = |row: &AblationRow| Bar {
        name: format!("{}, {}", row.engine, row.variant),
        value: row.wall.median_ms,
    };
    rows.chunk_by(|a, b| a.scene == b.scene)
        .map(|of_scene| Panel::Bars {
            title: of_scene.first().map_or_else(String::new, |row| {
                format!("{}, {}, ms a frame", row.scene, row.size())
            }),
            bars: of_scene.iter().map(bar).collect(),
        })
        .collect()
}
