//! What the model found, as one page.

use super::findings::Findings;
use super::summary;
use crate::error::{CliError, Kind};
use crate::experiment::context::Context;
use shiftvox::picture::{Background, Shading, png, resolve};
use shiftvox_lab::model::fill_bits;
use shiftvox_lab::report::html::Page;
use shiftvox_lab::report::plot::{self, Panel};

/// The page. `heat`: a PNG; `most`: records of its brightest sample.
pub(super) fn html(
    found: &Findings,
    panels: &[Panel],
    heat: &[u8],
    most: f32,
) -> Result<String, CliError> {
    let graph = &found.subject.graph;
    let shown = resolve(
        &found.counted.frame,
        graph,
        &found.setup,
        Shading::Lambert,
        Background::default(),
    )?;
    let picture = png::encode(shown.width, shown.height, &shown.rgba)
        .map_err(|error| CliError::new(Kind::Run, error))?;
    let cycles = &found.simulated.cycles;
    let mut page = Page::new(&format!("The light hardware draws {}", found.name));
    page.lines(&Context::now().command_line());
    page.text(&format!("What limits: {}.", cycles.bottleneck.sentence));
    let figure = |value: String, what: &str| (value, what.to_owned());
    let (energy, ..) = found.cost.total();
    page.key_figures(&[
        figure(
            format!("{:.1}", cycles.frames_per_second),
            "frames a second",
        ),
        figure(format!("{:.1}", cycles.cycles_per_pixel), "cycles a pixel"),
        figure(
            format!("{:.0}", found.counted.operations_per_record()),
            "operations a record",
        ),
        figure(format!("{}", found.counted.record_bits()), "bits a record"),
        figure(
            format!("{:.0} k", found.area.total / 1e3),
            "NAND2 equivalents",
        ),
        figure(format!("{:.1} uJ", energy / 1e6), "a frame"),
        figure(format!("{:.1}", cycles.parallelism), "work over span"),
        figure(
            format!(
                "{}",
                fill_bits::fill_store_bits(&found.setup, &found.hardware) / 8192
            ),
            "kilobytes of fill vectors",
        ),
    ]);
    page.pictures(&[
        (&picture, "The picture"),
        (
            heat,
            &format!("Records by pixel, logarithmic; brightest: {most:.1}"),
        ),
    ]);
    page.chapter("Summary");
    page.table(&summary::summary(found));
    for table in summary::short_tables(found) {
        page.chapter(title_of(&table.title));
        page.table(&table);
    }
    page.chapter("Plots");
    for panel in panels {
        page.plot(&plot::svg(std::slice::from_ref(panel)), "");
    }
    page.chapter("Details, line by line");
    for table in summary::long_tables(found) {
        page.section(&table.title);
        page.table(&table);
    }
    Ok(page.finish())
}

/// A table's title up to its colon, for the contents.
fn title_of(title: &str) -> &str {
    title.split(':').next().unwrap_or(title)
}
