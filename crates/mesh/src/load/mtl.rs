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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_have_names_after_their_options() {
        let options = "-s 2 2 -o 0.5 0 0 -clamp on -mm 0 1 sub/a b.png";
        assert_eq!(file_name(options).as_deref(), Some("sub/a b.png"));
        assert_eq!(file_name("-clamp on"), None);
        assert_eq!(file_name(""), None);
    }

    #[test]
    fn materials_with_what_is_odd_about_them() {
        let text =
            b"# c\nKd 1 1 1\nnewmtl a b\n Kd 1 0 0.5\nTr 0.25\nnewmtl c\nKd 0.5\nd -halo 0.5\n\
            map_Kd wood.png\nnewmtl d\nKd spectral x.rfl\nnewmtl \xfc\n";
        let library = read(text, &LoadOptions::default());
        let (materials, textures): (Vec<Material>, Vec<_>) = library.materials.into_iter().unzip();
        let names: Vec<&str> = materials.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["a b", "c", "d", "\u{fffd}"]);
        assert_eq!(materials[0].diffuse[..2], [1.0, 0.0]);
        assert_eq!(materials[0].alpha, 0.75);
        assert_eq!(materials[1].alpha, 0.5);
        assert_eq!(materials[2].diffuse, materials[3].diffuse);
        assert_eq!(library.odd_line, Some(11));
        let wood = Some("wood.png".to_owned());
        assert_eq!(textures, [None, wood, None, None]);
    }
}
