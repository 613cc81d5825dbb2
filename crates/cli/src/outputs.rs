//! Names and contents of the files that a picture becomes.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::error::CliError;
use shiftvox::budget;
use shiftvox::drawing::{Buffers, Shown};
use shiftvox::picture::{Buffer, Rows, npy};
use shiftvox::whole;
use shiftvox::whole::Prepared;

/// The file of a buffer: `{out stem}.{aov}.npy` beside the picture.
pub(super) fn buffer_path(picture: &Path, buffer: Buffer) -> PathBuf {
    picture.with_extension(format!("{}.npy", buffer.name()))
}

pub(super) fn paths(picture: &Path, buffers: &[Buffer]) -> Vec<PathBuf> {
    let beside = buffers.iter().map(|&buffer| buffer_path(picture, buffer));
    std::iter::once(picture.to_owned()).chain(beside).collect()
}

pub(super) fn check_free(paths: &[PathBuf], force: bool) -> Result<(), CliError> {
    for path in paths {
        whole::check_free(path, force)?;
    }
    Ok(())
}

pub(super) fn check_room(
    picture: &Path,
    buffers: &[Buffer],
    (width, height): (u32, u32),
    pictures: usize,
) -> Result<(), CliError> {
    let pixels = u64::from(width) * u64::from(height) * pictures as u64;
    let bytes = |buffer: &Buffer| match buffer {
        Buffer::Color => 4,
        other => 4 * other.entries() as u64,
    };
    let needed = pixels.saturating_mul(buffers.iter().map(bytes).sum());
    Ok(budget::check_disk(whole::folder_of(picture), needed)?)
}

pub(crate) fn check_text(path: &Path) -> Result<&str, CliError> {
    let wrong = || CliError::usage(format!("{}: the name is not UTF-8", path.display()));
    path.to_str().ok_or_else(wrong)
}

pub(super) fn check_picture_name(path: &Path) -> Result<(), CliError> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    if ending.eq_ignore_ascii_case("png") {
        return Ok(());
    }
    Err(
        CliError::usage(format!("{}: pictures are written as PNG", path.display()))
            .advise("end the name in .png, or in / for a folder; for numbers use --aov, which writes .npy files"),
    )
}

/// Writes a picture's colours and the requested buffers: all of them or none.
pub(super) fn write(
    shown: &Shown<'_>,
    path: &Path,
    buffers: &[Buffer],
    force: bool,
) -> Result<(), CliError> {
    Ok(whole::keep(prepare(shown, path, buffers, force)?)?)
}

pub(super) fn prepare(
    shown: &Shown<'_>,
    path: &Path,
    buffers: &[Buffer],
    force: bool,
) -> Result<Vec<Prepared>, CliError> {
    let picture = whole::prepare(path, force, |file| {
        let mut file = BufWriter::new(file);
        shown.pixels.write(&mut file).map_err(io::Error::other)?;
        file.flush()
    })?;
    let mut files = vec![picture];
    for &buffer in buffers {
        let path = buffer_path(path, buffer);
        files.push(prepare_buffer(&shown.buffers, buffer, &path, force)?);
    }
    Ok(files)
}

fn prepare_buffer(
    picture: &Buffers<'_>,
    buffer: Buffer,
    path: &Path,
    force: bool,
) -> Result<Prepared, CliError> {
    let (width, height) = picture.size();
    let mut shape = vec![height as usize, width as usize];
    if buffer.entries() > 1 {
        shape.push(buffer.entries());
    }
    let mut failed = None;
    let written = whole::prepare(path, force, |file| {
        file.write_all(&npy::header(&shape, &buffer.none()))?;
        for rows in picture.steps() {
            match picture.rows(buffer, rows) {
                Ok(values) => file.write_all(&values.bytes())?,
                Err(error) => {
                    failed = Some(error);
                    return Err(io::Error::other("rows cannot be made"));
                }
            }
        }
        Ok(())
    });
    if let Some(error) = failed {
        return Err(error.into());
    }
    Ok(written?)
}
