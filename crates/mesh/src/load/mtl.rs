//! Material libraries of Wavefront files: `newmtl`, `Kd`, `d`, `Tr`, `map_Kd` and `map_d`, in capitals or
//! not. All else is passed over.

use shiftvox::scene::DEFAULT_COLOR;

use super::text;
use crate::texture::Wrap;
use crate::{ColorSpace, Material};

pub(super) struct Library {
    /// In the order of the file.
    pub(super) materials: Vec<(Material, Pictures)>,
    pub(super) warnings: Vec<String>,
}

/// Names of the pictures that a material's colour and opacity are multiplied by.
#[derive(Debug, Clone, Default)]
pub(super) struct Pictures {
    pub(super) color: Option<String>,
    pub(super) opacity: Option<String>,
    pub(super) place: Place,
}

/// The place of a picture: texture coordinates are multiplied by the scale, and the offset is added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) scale: [f64; 2],
    pub(super) offset: [f64; 2],
    pub(super) wrap: Wrap,
    /// Its brightness changes.
    has_levels: bool,
}

impl Default for Place {
    fn default() -> Self {
        Self {
            scale: [1.0; 2],
            offset: [0.0; 2],
            wrap: Wrap::Repeat,
            has_levels: false,
        }
    }
}

#[derive(Default)]
struct Found {
    name: String,
    color: Option<[f32; 3]>,
    alpha: f32,
    pictures: Pictures,
    is_emissive: bool,
    /// It colours the light that it lets through.
    is_filter: bool,
    has_ambient_picture: bool,
}

pub(super) fn read(bytes: &[u8], colors: ColorSpace) -> Library {
    let text = text::decoded(bytes);
    let mut found: Vec<Found> = Vec::new();
    let mut odd_line = None;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let (key, rest) = (key.to_ascii_lowercase(), rest.trim());
        let words = rest.split_whitespace();
        let words = words.take_while(|word| !word.starts_with('#'));
        let mut numbers = words.map(|word| word.parse::<f32>().ok());
        let is_understood = match (&key[..], found.last_mut()) {
            ("newmtl", _) => {
                found.push(Found {
                    name: rest.to_owned(),
                    alpha: 1.0,
                    ..Found::default()
                });
                true
            }
            ("ke" | "map_ke", Some(last)) => {
                last.is_emissive |= key == "map_ke" || numbers.any(|number| number > Some(0.0));
                true
            }
            ("tf", Some(last)) => {
                let colors: Vec<f32> = numbers.flatten().take(3).collect();
                last.is_filter = colors.iter().any(|&of| of != colors[0]);
                true
            }
            ("map_ka", Some(last)) => {
                last.has_ambient_picture = true;
                true
            }
            ("kd", Some(last)) => {
                let numbers: Option<Vec<f32>> = numbers.take(3).collect();
                let color = match numbers.as_deref() {
                    Some(&[r, g, b]) => Some([r, g, b]),
                    Some(&[grey]) => Some([grey; 3]),
                    _ => None,
                };
                last.color = color.or(last.color);
                color.is_some()
            }
            ("d" | "tr", Some(last)) => {
                // `d -halo 0.5` is opacity too.
                let value = numbers.last().flatten().filter(|v| v.is_finite());
                if let Some(value) = value {
                    last.alpha = if key == "d" { value } else { 1.0 - value };
                }
                value.is_some()
            }
            ("map_kd" | "map_d", Some(last)) => {
                let found = picture(rest);
                let is_understood = found.is_some();
                if let Some((name, place)) = found {
                    let is_color = key == "map_kd";
                    // One place serves both pictures.
                    if is_color || last.pictures.color.is_none() {
                        last.pictures.place = place;
                    }
                    *(match is_color {
                        true => &mut last.pictures.color,
                        false => &mut last.pictures.opacity,
                    }) = Some(name);
                }
                is_understood
            }
            _ => true,
        };
        if !is_understood {
            odd_line.get_or_insert(number);
        }
    }
    let odd = odd_line.map(|line| format!("line {line} is not understood and was passed over"));
    let count = |is_meant: fn(&&Found) -> bool| found.iter().filter(is_meant).count();
    let counts = [
        (count(|of| of.is_emissive), "emit light, which is not drawn"),
        (
            count(|of| of.is_filter && of.alpha < 1.0),
            "colour the light behind them (Tf), which is not drawn",
        ),
        (
            count(|of| of.pictures.place.has_levels),
            "change the brightness of a picture (-mm), which is not drawn",
        ),
        (
            count(|of| of.has_ambient_picture && of.pictures.color.is_none()),
            "have a picture of ambient light alone (map_Ka), which is not drawn",
        ),
    ];
    let counts = counts.into_iter().filter(|(count, _)| *count > 0);
    let counts = counts.map(|(count, what)| format!("{count} materials {what}"));
    let warnings = odd.into_iter().chain(counts).collect();
    let materials = found.into_iter().map(|found| found.material(colors));
    Library {
        materials: materials.collect(),
        warnings,
    }
}

/// The name and the options of a `map_Kd` or `map_d`: `-s 1 1 1 -clamp on wood grain.png`.
fn picture(mut rest: &str) -> Option<(String, Place)> {
    let mut place = Place::default();
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace)?;
        rest = after.trim_start();
        // Up to three numbers, or exactly so many words.
        let (most, any) = match option {
            "-s" | "-o" | "-t" => (3, false),
            "-mm" => (2, true),
            _ => (1, true),
        };
        for k in 0..most {
            let found = rest.split_once(char::is_whitespace);
            let number = found.map(|(word, _)| word.parse::<f64>());
            if !any && !matches!(number, Some(Ok(_))) {
                break;
            }
            let ((word, after), number) = (found?, number?);
            match (option, number) {
                ("-s", Ok(number)) if k < 2 => place.scale[k] = number,
                ("-o", Ok(number)) if k < 2 => place.offset[k] = number,
                ("-clamp", _) if word == "on" => place.wrap = Wrap::Clamp,
                ("-mm", number) => place.has_levels |= number != Ok([0.0, 1.0][k]),
                _ => {}
            }
            rest = after.trim_start();
        }
    }
    (!rest.is_empty()).then(|| (rest.to_owned(), place))
}

impl Found {
    fn material(self, colors: ColorSpace) -> (Material, Pictures) {
        let color = match (&self.pictures.color, self.color) {
            // Programs that write a black factor, or none, mean the picture alone.
            (Some(_), None | Some([0.0, 0.0, 0.0])) => Some([1.0; 3]),
            (_, color) => color,
        };
        let material = match color {
            Some(color) => Material::of_numbers(self.name, color, colors, self.alpha),
            None => Material {
                alpha: self.alpha.clamp(0.0, 1.0),
                ..Material::of_srgb(self.name, DEFAULT_COLOR)
            },
        };
        (material, self.pictures)
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn options_take_one_number_or_more() {
        let scale =
            |options: &str| super::picture(options).map(|(name, place)| (name, place.scale));
        let name = || "a.png".to_owned();
        assert_eq!(scale("-s 2 a.png"), Some((name(), [2.0, 1.0])));
        assert_eq!(scale("-s 2 3 a.png"), Some((name(), [2.0, 3.0])));
        assert_eq!(scale("-s 2 3 1 -mm 0 1 a.png"), Some((name(), [2.0, 3.0])));
        assert_eq!(scale("-clamp on"), None);
    }
}
