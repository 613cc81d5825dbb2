//! Names and contents of the files that a picture becomes.

use std::path::{Path, PathBuf};

use super::args::{Aov, Setting};
use super::error::{CliError, Kind};
use crate::picture::npy::{Array, Values};
use crate::picture::{Picture, npy, png, store};

/// The file of a buffer: `{out stem}.{aov}.npy` beside the picture.
pub(super) fn aov_path(picture: &Path, aov: Aov) -> PathBuf {
    picture.with_extension(format!("{}.npy", aov.name()))
}

/// All files that a picture and its buffers become.
pub(super) fn paths(picture: &Path, aovs: &[Aov]) -> Vec<PathBuf> {
    let beside = aovs.iter().map(|&aov| aov_path(picture, aov));
    std::iter::once(picture.to_owned()).chain(beside).collect()
}

/// Fails before the work if a file would have to be replaced without `--force`.
pub(super) fn check_free(paths: &[PathBuf], force: bool) -> Result<(), CliError> {
    for path in paths {
        store::check_free(path, force)?;
    }
    Ok(())
}

/// Whether the name is one of a picture that we write.
pub(super) fn check_picture_name(path: &Path) -> Result<(), CliError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    if ending.eq_ignore_ascii_case("png") {
        return Ok(());
    }
    Err(
        CliError::usage(format!("{}: pictures are written as PNG", path.display()))
            .advise("end the name in .png; for numbers use --aov, which writes .npy files"),
    )
}

/// Writes a picture and its buffers.
pub(super) fn write(
    picture: &Picture,
    path: &Path,
    aovs: &[Aov],
    force: bool,
) -> Result<(), CliError> {
    let bytes = png::encode(picture.width, picture.height, &picture.rgba)
        .map_err(|e| CliError::new(Kind::Run, format!("{}: {e}", path.display())))?;
    store::write(path, &bytes, force)?;
    for &aov in aovs {
        let bytes = npy::encode(&buffer(picture, aov));
        store::write(&aov_path(path, aov), &bytes, force)?;
    }
    Ok(())
}

fn buffer(picture: &Picture, aov: Aov) -> Array {
    let (values, entries) = match aov {
        Aov::Depth => (Values::F32(picture.depth.clone()), 1),
        Aov::Normal => (Values::F32(picture.normal.as_flattened().to_vec()), 3),
        Aov::Voxel => (Values::I32(picture.voxel.as_flattened().to_vec()), 4),
        Aov::Node => (Values::I32(picture.node.clone()), 1),
        Aov::Records => {
            let records = picture.records.clone();
            let zeros = || vec![0.0; picture.node.len()];
            (Values::F32(records.unwrap_or_else(zeros)), 1)
        }
        Aov::Color => (Values::U8(picture.rgba.as_flattened().to_vec()), 4),
    };
    let mut shape = vec![picture.height as usize, picture.width as usize];
    if entries > 1 {
        shape.push(entries);
    }
    Array { shape, values }
}

/// The two files that `--outdir` leaves.
pub(super) fn record_paths(outdir: &Path) -> [PathBuf; 2] {
    [outdir.join("config.toml"), outdir.join("stats.json")]
}

/// Writes the resolved configuration and the report of a run.
pub(super) fn write_record(
    outdir: &Path,
    settings: Vec<Setting>,
    report: &serde_json::Value,
    force: bool,
) -> Result<(), CliError> {
    let table: toml::Table = settings
        .into_iter()
        .map(|(name, value)| (name.to_owned(), value))
        .collect();
    let [config, stats] = record_paths(outdir);
    store::write(&config, table.to_string().as_bytes(), force)?;
    store::write(&stats, format!("{report:#}\n").as_bytes(), force)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buffers_stand_beside_the_picture() {
        let found = paths(Path::new("a/b.c.png"), &[Aov::Depth]);
        assert_eq!(
            found,
            [Path::new("a/b.c.png"), Path::new("a/b.c.depth.npy")]
        );
    }
}
