//! Films: temporal flicker under small camera motion.
//!
//! *Flicker* is the change from frame to frame that the reference does not have. *Pop* is the change
//! of one picture when its level of detail is that of the frame before: see
//! [`cut_at`](super::cut_at).

use rayon::prelude::*;

use super::method::{Method, Refused, drawn};
use crate::measure::{Flicker, LinearPicture, SizeError};
use shiftvox::project::Camera;

/// A film against its reference. Linear light from 0 to 1, root of the mean square over pixels and
/// channels; by step, from the second frame on.
pub(super) struct Film {
    /// Flicker of the whole film, and by step.
    pub(super) flicker: (f64, Vec<f64>),
    /// Pop of the whole film, and by step; `None` without level of detail.
    pub(super) pop: Option<(f64, Vec<f64>)>,
    /// Mean distance of a frame from its reference.
    pub(super) error: f64,
}

/// Flicker of frames against their references.
pub(super) fn flicker(
    film: &[LinearPicture],
    truth: &[LinearPicture],
) -> Result<(f64, Vec<f64>), SizeError> {
    let mut flicker = Flicker::default();
    for (frame, right) in film.iter().zip(truth) {
        flicker.push(frame.clone(), right.clone())?;
    }
    Ok((flicker.rms(), flicker.by_step()))
}

/// Films a method.
pub(super) fn film(
    method: &Method<'_>,
    cameras: &[Camera],
    truth: &[LinearPicture],
) -> Result<Film, Refused> {
    let light =
        |camera: &Camera, rgba: &[[u8; 4]]| LinearPicture::of((camera.width, camera.height, rgba));
    let mut film = Vec::new();
    let mut pops = Vec::new();
    let mut drawing = (method.drawing)();
    for (at, camera) in cameras.iter().enumerate() {
        let shown = drawn(drawing.as_mut(), camera)?;
        film.push(light(camera, &shown.pixels.rgba()));
        let before = at.checked_sub(1).map(|before| &cameras[before]);
        if let (Some(before), Some(with_cut_of)) = (before, &method.with_cut_of) {
            let [own, other] = [camera, before].map(|chooser| with_cut_of(camera, chooser));
            let (own, other) = (light(camera, &own?), light(camera, &other?));
            pops.push(own.rms(&other).map_err(Refused::because)?);
        }
    }
    let errors: Vec<f64> = film
        .par_iter()
        .zip(truth)
        .map(|(frame, right)| frame.rms(right))
        .collect::<Result<_, _>>()
        .map_err(Refused::because)?;
    let squares: f64 = pops.iter().map(|pop| pop * pop).sum();
    let pop = libm::sqrt(squares / pops.len().max(1) as f64);
    Ok(Film {
        flicker: flicker(&film, truth).map_err(Refused::because)?,
        pop: (!pops.is_empty()).then_some((pop, pops)),
        error: errors.iter().sum::<f64>() / errors.len().max(1) as f64,
    })
}
