//! `compare`: the difference of two pictures or two buffers.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::console::Console;
use super::error::{CliError, Kind};
use super::report;
use shiftvox::bounded;
use shiftvox::budget;
use shiftvox::picture::npy::{self, Array, Values};
use shiftvox::picture::png::{self, Image};
use shiftvox::whole;
use shiftvox_lab::measure::{ColorError, CoverageError, count_differing, difference};

#[derive(Debug, Args)]
pub(super) struct CompareArgs {
    /// File under test, .png or .npy
    #[arg(value_name = "A")]
    a: PathBuf,
    /// Reference of the same kind and size
    #[arg(value_name = "B")]
    b: PathBuf,
    /// Bounds, beyond which the exit code is 3. VALUE bounds the number of differing pixels, NAME=VALUE a number of the
    /// report, from below for psnr_*, else from above
    #[arg(
        long,
        value_name = "[NAME=]VALUE",
        value_delimiter = ',',
        default_value = "0",
        value_parser = threshold
    )]
    threshold: Vec<(String, f64)>,
    /// Picture of the differences of two pictures, four times as bright
    #[arg(long, value_name = "FILE")]
    diff: Option<PathBuf>,
    /// Replace existing files
    #[arg(long)]
    force: bool,
}

/// Reads a bound and its name.
fn threshold(text: &str) -> Result<(String, f64), String> {
    let (name, bound) = text.split_once('=').unwrap_or(("differing", text));
    let number = bound.parse().ok().filter(|bound: &f64| !bound.is_nan());
    let number = number.ok_or_else(|| format!("`{bound}` is no number"))?;
    Ok((name.to_owned(), number))
}

enum Content {
    Picture(Image),
    Buffer(Array),
}

struct Comparison {
    kind: &'static str,
    numbers: Vec<(&'static str, f64)>,
    diff: Option<(u32, u32, Vec<[u8; 4]>)>,
}

pub(super) fn run(args: &CompareArgs, console: &Console) -> Result<(), CliError> {
    if let Some(path) = &args.diff {
        super::outputs::check_picture_name(path)?;
        whole::check_free(path, args.force)?;
    }
    let comparison = match (read(&args.a)?, read(&args.b)?) {
        (Content::Picture(a), Content::Picture(b)) => pictures(&a, &b)?,
        (Content::Buffer(a), Content::Buffer(b)) => buffers(&a, &b)?,
        _ => return Err(CliError::input("a picture and a buffer cannot be compared")),
    };
    if let Some(path) = &args.diff {
        let (width, height, rgba) = comparison
            .diff
            .as_ref()
            .ok_or_else(|| CliError::usage("--diff draws the difference of pictures only"))?;
        let bytes = png::encode(*width, *height, rgba)
            .map_err(|e| CliError::new(Kind::Run, e).at(path.display()))?;
        whole::write(path, &bytes, args.force)?;
    }
    print(args, &comparison, console)?;
    judge(&args.threshold, &comparison.numbers)
}

/// Memory of a comparison of two pictures, per pixel, and of reading one.
const PICTURE_BYTES: u64 = 80;
const READING_BYTES: u64 = 64 << 20;

fn read(path: &Path) -> Result<Content, CliError> {
    let content = || -> Result<Content, CliError> {
        let bytes = bounded::read(path, u64::MAX).map_err(CliError::of_reading)?;
        if npy::is_npy(&bytes) {
            budget::check("a buffer that is compared", bytes.len() as u64)?;
            return npy::decode(&bytes)
                .map(Content::Buffer)
                .map_err(CliError::input);
        }
        if let Some((width, height)) = png::size(&bytes) {
            let pixels = u64::from(width) * u64::from(height);
            let needed = pixels * PICTURE_BYTES + READING_BYTES;
            budget::check("pictures that are compared", needed)?;
        }
        png::decode(&bytes).map(Content::Picture).map_err(|e| {
            let advice =
                "compare takes .png pictures and .npy buffers, recognised by their content";
            CliError::input(e).advise(advice)
        })
    };
    content().map_err(|error| error.at(path.display()))
}

fn pictures(a: &Image, b: &Image) -> Result<Comparison, CliError> {
    let (a, b) = (
        (a.width, a.height, &a.rgba[..]),
        (b.width, b.height, &b.rgba[..]),
    );
    let failed = |e| CliError::new(Kind::Failed, e);
    let error = ColorError::between(a, b).map_err(failed)?;
    let diff = difference(a, b).map_err(failed)?;
    let numbers = [
        ("pixels", error.pixels as f64),
        ("differing", error.differing as f64),
        ("max_abs", f64::from(error.max_abs)),
        ("mean_abs", error.mean_abs),
        ("mse_srgb", error.mse_srgb),
        ("psnr_srgb", error.psnr_srgb),
        ("mse_linear", error.mse_linear),
        ("psnr_linear", error.psnr_linear),
    ];
    Ok(Comparison {
        kind: "picture",
        numbers: numbers.into(),
        diff: Some((a.0, a.1, diff)),
    })
}

fn buffers(a: &Array, b: &Array) -> Result<Comparison, CliError> {
    if a.shape != b.shape {
        let message = format!(
            "the buffers differ in shape: {:?} and {:?}",
            a.shape, b.shape
        );
        return Err(CliError::new(Kind::Failed, message));
    }
    let entries: usize = a.shape.iter().skip(2).product();
    let entries = entries.max(1);
    let (differing, max_abs) = match (&a.values, &b.values) {
        (Values::U8(a), Values::U8(b)) => spread(a, b, entries),
        (Values::I32(a), Values::I32(b)) => spread(a, b, entries),
        (Values::F32(a), Values::F32(b)) => spread(a, b, entries),
        _ => return Err(CliError::new(Kind::Failed, "the buffers differ in type")),
    };
    let mut numbers = vec![
        (
            "pixels",
            (a.shape.iter().product::<usize>() / entries) as f64,
        ),
        ("differing", differing as f64),
        ("max_abs", max_abs),
    ];
    if let (Values::I32(a), Values::I32(b), 4) = (&a.values, &b.values, entries) {
        let error = CoverageError::between(a.as_chunks::<4>().0, b.as_chunks::<4>().0);
        numbers.extend([
            ("covered", error.covered as f64),
            ("extra", error.extra as f64),
            ("missing", error.missing as f64),
            ("wrong_voxel", error.wrong_voxel as f64),
        ]);
    }
    Ok(Comparison {
        kind: "buffer",
        numbers,
        diff: None,
    })
}

fn spread<T: PartialEq + Copy + Into<f64>>(a: &[T], b: &[T], entries: usize) -> (usize, f64) {
    let pixels = a.chunks(entries).zip(b.chunks(entries));
    let apart = pixels.filter(|(p, q)| count_differing(p, q) > 0).count();
    let differing = a.iter().zip(b).filter(|(x, y)| x != y);
    let distances = differing.map(|(&x, &y)| (x.into() - y.into()).abs());
    (apart, distances.fold(0.0, f64::max))
}

fn print(args: &CompareArgs, comparison: &Comparison, console: &Console) -> Result<(), CliError> {
    let (a, b) = (args.a.display().to_string(), args.b.display().to_string());
    let mut fields = json!({ "a": a, "b": b, "kind": comparison.kind });
    let mut rows = Vec::new();
    for (name, value) in &comparison.numbers {
        fields[*name] = number(*value);
        rows.push(vec![(*name).to_owned(), report::figure(&fields[*name])]);
    }
    if console.json {
        console.report("compare", fields);
        return Ok(());
    }
    console.data(report::table(&[comparison.kind, "value"], &rows))
}

/// A whole number as such. JSON has no infinity.
fn number(value: f64) -> Value {
    match value {
        value if !value.is_finite() => json!("inf"),
        value if value.fract() == 0.0 && value.abs() < 9e15 => json!(value as i64),
        value => json!(value),
    }
}

fn judge(thresholds: &[(String, f64)], numbers: &[(&str, f64)]) -> Result<(), CliError> {
    for (name, bound) in thresholds {
        let Some((_, value)) = numbers.iter().find(|(found, _)| found == name) else {
            let names: Vec<&str> = numbers.iter().map(|(name, _)| *name).collect();
            let message = format!("--threshold: there is no `{name}` here");
            let advice = format!("there are: {}", names.join(", "));
            return Err(CliError::usage(message).advise(advice));
        };
        let (good, side) = match name.starts_with("psnr") {
            true => (value >= bound, "at least"),
            false => (value <= bound, "at most"),
        };
        if !good {
            let value = report::figure(&number(*value));
            let message = format!("{name}: {value} ({side} {bound} allowed)");
            return Err(CliError::new(Kind::Failed, message));
        }
    }
    Ok(())
}
