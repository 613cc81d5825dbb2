//! Material libraries of Wavefront files: names, diffuse colours, opacities.
//!
//! Read: `newmtl`, `Kd r g b` (of one number, all three are it), `d`, `Tr`.
//! All else, textures among it, is passed over.

use super::{LoadOptions, text};
use crate::mesh::Material;

/// What a library holds.
#[derive(Debug, Default)]
pub(super) struct Library {
    /// Materials in the order of the file; of two of one name the last counts.
    pub(super) materials: Vec<Material>,
    /// Materials whose colour is a texture, which is not read.
    pub(super) textured: usize,
    /// First line that could not be understood.
    pub(super) odd_line: Option<usize>,
}

/// Reads a library. What cannot be understood is passed over.
pub(super) fn read(bytes: &[u8], options: &LoadOptions) -> Library {
    let text = text::decoded(bytes);
    let mut library = Library::default();
    let mut current: Option<Open> = None;
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        let (key, rest) = line
            .split_once(char::is_whitespace)
            .map_or((line, ""), |(key, rest)| (key, rest.trim()));
        if key == "newmtl" {
            if let Some(open) = current.replace(Open::new(rest)) {
                library.close(open, options);
            }
            continue;
        }
        let Some(open) = &mut current else { continue };
        let understood = match key {
            "Kd" => open.colored(rest),
            "d" => open.alpha_from(rest, |d| d),
            "Tr" => open.alpha_from(rest, |tr| 1.0 - tr),
            "map_Kd" => {
                open.textured = true;
                true
            }
            _ => true,
        };
        if !understood {
            library.odd_line.get_or_insert(number + 1);
        }
    }
    if let Some(open) = current {
        library.close(open, options);
    }
    library
}

impl Library {
    fn close(&mut self, open: Open, options: &LoadOptions) {
        self.textured += usize::from(open.textured);
        let material = match open.color {
            Some(color) => Material::of_numbers(open.name, color, options.mtl_colors, open.alpha),
            None => Material {
                alpha: open.alpha.clamp(0.0, 1.0),
                ..Material::of_srgb(open.name, options.default_color)
            },
        };
        self.materials.push(material);
    }
}

/// A material of which more lines may follow.
struct Open {
    name: String,
    color: Option<[f32; 3]>,
    alpha: f32,
    textured: bool,
}

impl Open {
    fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            color: None,
            alpha: 1.0,
            textured: false,
        }
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
    fn materials_with_what_is_odd_about_them() {
        let text =
            b"# c\nKd 1 1 1\nnewmtl a b\n Kd 1 0 0.5\nTr 0.25\nnewmtl c\nKd 0.5\nd -halo 0.5\n\
            map_Kd wood.png\nnewmtl d\nKd spectral x.rfl\nnewmtl \xfc\n";
        let library = read(text, &LoadOptions::default());
        let names: Vec<&str> = library.materials.iter().map(|m| m.name.as_str()).collect();
        assert_eq!(names, ["a b", "c", "d", "\u{fffd}"]);
        assert_eq!(library.materials[0].diffuse[..2], [1.0, 0.0]);
        assert_eq!(library.materials[0].alpha, 0.75);
        assert_eq!(library.materials[1].alpha, 0.5);
        assert_eq!(library.materials[2].diffuse, library.materials[3].diffuse);
        assert_eq!((library.textured, library.odd_line), (1, Some(11)));
    }
}
