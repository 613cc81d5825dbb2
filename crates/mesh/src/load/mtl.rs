//! Material libraries of Wavefront files: names, diffuse colours, opacities.
//!
//! Read: `newmtl`, `Kd r g b` (of one number, all three are it), `map_Kd`, `d`, `Tr`.
//! All else is passed over.

use shiftvox::scene::DEFAULT_COLOR;

use super::{LoadOptions, text};
use crate::Material;

#[derive(Debug, Default)]
pub(super) struct Library {
    /// In the order of the file, each with the name of the picture that its colour is multiplied by.
    pub(super) materials: Vec<(Material, Option<String>)>,
    /// First line that could not be understood.
    pub(super) odd_line: Option<usize>,
}

pub(super) fn read(bytes: &[u8], options: &LoadOptions) -> Library {
    let text = text::decoded(bytes);
    let mut found: Vec<Found> = Vec::new();
    let mut odd_line = None;
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        let (key, rest) = line
            .split_once(char::is_whitespace)
            .map_or((line, ""), |(key, rest)| (key, rest.trim()));
        if key == "newmtl" {
            let name = rest.to_owned();
            found.push(Found {
                name,
                alpha: 1.0,
                ..Found::default()
            });
            continue;
        }
        let Some(last) = found.last_mut() else {
            continue;
        };
        let understood = match key {
            "Kd" => last.colored(rest),
            "d" => last.alpha_from(rest, |d| d),
            "Tr" => last.alpha_from(rest, |tr| 1.0 - tr),
            "map_Kd" => {
                last.texture = file_name(rest);
                last.texture.is_some()
            }
            _ => true,
        };
        if !understood {
            odd_line.get_or_insert(number + 1);
        }
    }
    let materials = found.into_iter().map(|found| found.material(options));
    Library {
        materials: materials.collect(),
        odd_line,
    }
}

/// The name in a `map_Kd`, after its options: `-s 1 1 1 -clamp on wood grain.png`.
fn file_name(rest: &str) -> Option<String> {
    let mut rest = rest.trim();
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace)?;
        rest = after.trim_start();
        // Up to three numbers, or exactly so many words.
        let (most, any) = match option {
            "-s" | "-o" | "-t" => (3, false),
            "-mm" => (2, true),
            _ => (1, true),
        };
        for _ in 0..most {
            let (word, after) = rest.split_once(char::is_whitespace)?;
            if !any && word.parse::<f64>().is_err() {
                break;
            }
            rest = after.trim_start();
        }
    }
    (!rest.is_empty()).then(|| rest.to_owned())
}

#[derive(Default)]
struct Found {
    name: String,
    color: Option<[f32; 3]>,
    alpha: f32,
    texture: Option<String>,
}

impl Found {
    fn material(self, options: &LoadOptions) -> (Material, Option<String>) {
        // A black factor would make the picture black. Programs that write it mean the picture alone. So do those that
        // write none.
        let color = match (&self.texture, self.color) {
            (Some(_), None | Some([0.0, 0.0, 0.0])) => Some([1.0; 3]),
            (_, color) => color,
        };
        let material = match color {
            Some(color) => Material::of_numbers(self.name, color, options.mtl_colors, self.alpha),
            None => Material {
                alpha: self.alpha.clamp(0.0, 1.0),
                ..Material::of_srgb(self.name, DEFAULT_COLOR)
            },
        };
        (material, self.texture)
    }

    fn colored(&mut self, rest: &str) -> bool {
        let numbers: Option<Vec<f32>> = rest
            .split_whitespace()
            .take(3)
            .map(|word| word.parse().ok())
            .collect();
        self.color = match numbers.as_deref() {
            Some(&[r, g, b]) => Some([r, g, b]),
            Some(&[r]) => Some([r; 3]),
            _ => return false,
        };
        true
    }

    fn alpha_from(&mut self, rest: &str, opacity: impl Fn(f32) -> f32) -> bool {
        // `d -halo 0.5` is opacity too.
        let last = rest.split_whitespace().last();
        match last.and_then(|word| word.parse::<f32>().ok()) {
            Some(value) if value.is_finite() => {
                self.alpha = opacity(value);
                true
            }
            _ => false,
        }
    }
}
