//! `--methods`: which methods are measured, in one line.
//!
//! A method is `NAME[=VALUE][:KEY=VALUE]...`, such as `exact:bits=24` or `far=six:aa=2`. All combinations of values with
//! `+` between them are measured.

use clap::ValueEnum;

use crate::args::{self, RuleArgs};
use crate::engines;
use shiftvox::project::{CageKind, Coverage, SetupOptions};
use shiftvox_mesh::far::view::Opacity;

pub(super) const OF_VOXELS: &str = "\
    exact:cage=frame+corners,any:tolerance=0.125+0+0.015625+inf:cage=frame+corners,\
    center:tolerance=0.125+0+0.015625+inf:cage=frame+corners,exact:aa=2+4,any:aa=2,center:aa=2,\
    exact:lod=0+1+2,any:lod=0+0.5+2,center:lod=0+0.5+2,exact:bits=48+32+24+20+16,\
    any:bits=48+32+24+20+16,center:bits=48+32+24+20+16";
pub(super) const OF_MESHES: &str = "\
    triangles,decimated,hybrid,hybrid:aa=2:lod=2,center,exact,exact:aa=4,alpha,alpha:lod=2,alpha:aa=2,\
    far=none,far=scalar+six:aa=1+2,far=six:aa=4,textured=0+1,textured=auto:aa=1+2";

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Choice {
    Voxels(SetupOptions, &'static str),
    /// One of so many triangles.
    Triangles {
        one_of: u32,
        aa_log2: u32,
    },
    Far {
        is_hybrid: bool,
        opacity: Opacity,
        voxel_px: f64,
        aa_log2: u32,
    },
    /// Textured voxels with a number of erosions, or with automatic erosion.
    Textured {
        level: Option<u32>,
        aa_log2: u32,
    },
}

#[derive(Debug, Clone)]
pub(super) struct Choices(Vec<Choice>);

pub(super) fn of_list(list: &[Choices]) -> Vec<Choice> {
    let mut all: Vec<Choice> = Vec::new();
    for choice in list.iter().flat_map(|choices| &choices.0) {
        if !all.contains(choice) {
            all.push(*choice);
        }
    }
    all
}

pub(super) fn default(is_mesh: bool) -> Vec<Choice> {
    let text = if is_mesh { OF_MESHES } else { OF_VOXELS };
    let list: Result<Vec<Choices>, _> = text.split(',').map(str::parse).collect();
    of_list(&list.unwrap_or_default())
}

/// Settings of an alternative by name. The method's own value has the method's name.
type Settings<'t> = Vec<(&'t str, &'t str)>;

fn combinations<'t>(alternatives: &[(&'t str, Vec<&'t str>)]) -> Vec<Settings<'t>> {
    let mut all: Vec<Settings<'t>> = vec![Vec::new()];
    for (key, values) in alternatives {
        let with = |one: Settings<'t>| {
            let values = values.iter();
            values.map(move |value| [&one[..], &[(*key, *value)]].concat())
        };
        all = all.into_iter().flat_map(with).collect();
    }
    all
}

fn take<T>(
    settings: &mut Settings<'_>,
    key: &str,
    read: impl Fn(&str) -> Option<T>,
) -> Result<Option<T>, String> {
    let Some(at) = settings.iter().position(|(found, _)| *found == key) else {
        return Ok(None);
    };
    let (_, text) = settings.remove(at);
    match read(text) {
        Some(value) => Ok(Some(value)),
        None => Err(format!("`{text}` is no value of `{key}`")),
    }
}

fn parsed<T: std::str::FromStr>(text: &str) -> Option<T> {
    text.parse().ok()
}

fn word<T: ValueEnum>(text: &str) -> Option<T> {
    T::from_str(text, false).ok()
}

fn aa_log2(text: &str) -> Option<u32> {
    let of = ["1", "2", "4"].iter().position(|known| *known == text)?;
    Some(of as u32)
}

fn above_zero(text: &str) -> Option<f64> {
    parsed(text).filter(|value: &f64| *value > 0.0 && value.is_finite())
}

fn choice(name: &str, settings: &mut Settings<'_>) -> Result<Choice, String> {
    let samples = take(settings, "aa", aa_log2)?.unwrap_or(0);
    match name {
        "triangles" => Ok(Choice::Triangles {
            one_of: 1,
            aa_log2: samples,
        }),
        "decimated" => {
            let at_least_two = |text: &str| parsed(text).filter(|&one_of: &u32| one_of > 1);
            Ok(Choice::Triangles {
                one_of: take(settings, name, at_least_two)?.unwrap_or(4),
                aa_log2: samples,
            })
        }
        "far" | "hybrid" => Ok(Choice::Far {
            is_hybrid: name == "hybrid",
            opacity: take(settings, "far", word)?.unwrap_or(Opacity::Six),
            voxel_px: take(settings, "lod", above_zero)?.unwrap_or(1.0),
            aa_log2: samples,
        }),
        "textured" => {
            let level = |text: &str| match text {
                "auto" => Some(None),
                text => parsed(text).map(Some),
            };
            Ok(Choice::Textured {
                level: take(settings, name, level)?.flatten(),
                aa_log2: samples,
            })
        }
        rule => {
            let rule: Coverage = word(rule).ok_or(format!("`{rule}` is no method"))?;
            let engine = |text: &str| {
                let able = [engines::FAST.name, engines::MACHINE.name];
                able.into_iter().find(|name| *name == text)
            };
            let pixels = |text: &str| parsed(text).filter(|px: &f64| *px >= 0.0);
            let width = |text: &str| parsed(text).filter(|bits| (16..=64).contains(bits));
            let tolerance = take(settings, "tolerance", |text| args::tolerance(text).ok())?;
            if rule.draws_outlines() && tolerance.is_some_and(|tolerance| tolerance != 0.0) {
                return Err(format!("{} has no tolerance: it is exact", rule.name()));
            }
            let rules = RuleArgs {
                coverage: Some(rule),
                tolerance,
                cage: take(settings, "cage", word::<CageKind>)?,
                bits: take(settings, "bits", width)?,
                lod: take(settings, "lod", pixels)?,
                ..RuleArgs::default()
            };
            let engine = take(settings, "engine", engine)?.unwrap_or(engines::FAST.name);
            Ok(Choice::Voxels(rules.options(samples), engine))
        }
    }
}

impl std::str::FromStr for Choices {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = text.trim().split(':');
        let first = parts.next().unwrap_or_default();
        let name = first.split('=').next().unwrap_or_default();
        let mut alternatives: Vec<(&str, Vec<&str>)> = Vec::new();
        let own = Some(first).filter(|first| first.contains('='));
        for part in own.into_iter().chain(parts) {
            let (key, values) = part
                .split_once('=')
                .ok_or_else(|| format!("`{part}` is no setting; expected KEY=VALUE[+VALUE]"))?;
            alternatives.push((key, values.split('+').collect()));
        }
        let name = match name {
            "paper" => {
                alternatives.extend([("tolerance", vec!["inf"]), ("cage", vec!["corners"])]);
                "any"
            }
            name => name,
        };
        let defaults: &[(&str, &str)] = match name {
            "triangles" | "hybrid" => &[("aa", "1+2+4")],
            "decimated" => &[("decimated", "4+16+64+256"), ("aa", "1+2+4")],
            "far" => &[("far", "none+scalar+six")],
            _ => &[],
        };
        for (key, values) in defaults {
            if !alternatives.iter().any(|(found, _)| found == key) {
                alternatives.push((key, values.split('+').collect()));
            }
        }
        let mut choices = Vec::new();
        for mut settings in combinations(&alternatives) {
            choices.push(choice(name, &mut settings)?);
            if let Some((key, _)) = settings.first() {
                return Err(format!("`{name}` has no setting `{key}`"));
            }
        }
        Ok(Self(choices))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_become_methods() {
        let default_rule = Choice::Voxels(SetupOptions::default(), engines::FAST.name);
        assert_eq!(default(false)[0], default_rule);
        for (text, methods) in [
            (OF_VOXELS, 2 + 2 * 8 + 3 * (1 + 3 + 5) + 1),
            (OF_MESHES, 3 + 12 + 3 + 1 + 6 + 6 + 4),
            ("exact:bits=24+32:aa=2", 2),
            ("exact,exact:aa=1", 1),
            ("paper:bits=20", 1),
            ("far", 3),
            ("far=six:aa=1+2:lod=1+2", 4),
            ("decimated=2+8", 6),
            ("textured=auto+0+3", 3),
            ("any:engine=fast+machine", 2),
        ] {
            let list: Vec<Choices> = text.split(',').map(|one| one.parse().unwrap()).collect();
            assert_eq!(of_list(&list).len(), methods, "{text}");
        }
        let wrong = ",most,exact:aa=3,exact:bits=8,exact:tolerance=1,exact:engine=rays,exact=2,exact:fov,far=many,\
                     far:bits=32,hybrid:lod=0,decimated=1";
        for wrong in wrong.split(',') {
            assert!(wrong.parse::<Choices>().is_err(), "{wrong}");
        }
    }
}
