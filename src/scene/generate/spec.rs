//! Specifications of generated scenes, such as `gen:terrain,depth=10,seed=1`.

use super::list::{GENERATORS, Generator, Settings, Shape};
use crate::graph::{Graph, Progress, Voxel};

pub const PREFIX: &str = "gen:";

/// A scene that can be generated: a generator and its settings, all in range.
#[derive(Debug, Clone, Copy)]
pub struct Spec {
    generator: &'static Generator,
    settings: Settings,
}

#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SpecError(String);

impl Spec {
    /// Keys left out have the generator's defaults.
    pub fn parse(text: &str) -> Result<Self, SpecError> {
        let wrong = |message: String| Err(SpecError(message));
        let Some(body) = text.strip_prefix(PREFIX) else {
            return wrong(format!(
                "a generated scene is written gen:NAME,key=value,...; `{text}` does not begin with gen:"
            ));
        };
        let mut parts = body.split(',').map(str::trim);
        let name = parts.next().unwrap_or_default();
        let Some(generator) = GENERATORS.iter().find(|g| g.name == name) else {
            let names: Vec<&str> = GENERATORS.iter().map(|g| g.name).collect();
            let names = names.join(", ");
            return wrong(format!("there is no generator `{name}`; there are {names}"));
        };
        let mut settings = Settings::default();
        for range in generator.keys {
            *settings.of(range.key) = range.default;
        }
        let mut given = Vec::new();
        for part in parts {
            let Some((key, value)) = part.split_once('=') else {
                return wrong(format!("`{part}` is not of the form key=value"));
            };
            let (key, value) = (key.trim(), value.trim());
            let Some(range) = generator.keys.iter().find(|range| range.key == key) else {
                let known = generator.keys.iter().map(|k| {
                    let (least, most, default) = (k.least, k.most, k.default);
                    format!("{} ({least} to {most}, default {default})", k.key)
                });
                let known = known.collect::<Vec<String>>().join(", ");
                return wrong(format!("{name} has no key `{key}`; it takes {known}"));
            };
            if given.contains(&key) {
                return wrong(format!("{key} is given twice"));
            }
            given.push(key);
            let (least, most) = (range.least, range.most);
            match value.parse() {
                Ok(number) if (least..=most).contains(&number) => *settings.of(key) = number,
                _ => {
                    return wrong(format!(
                        "{key} of {name} must be a whole number from {least} to {most}, not `{value}`"
                    ));
                }
            }
        }
        Ok(Self {
            generator,
            settings,
        })
    }

    /// A lower bound of the scene's voxels: 0 if a better one takes long to compute.
    pub fn least_voxels(&self) -> u64 {
        let power = |base: u64| base.saturating_pow(self.settings.depth);
        match self.generator.name {
            "checker" => power(8) / 2,
            "menger" => power(20),
            // Two of each column: its lowest, and the ground.
            "terrain" => 2 * power(4),
            _ => 0,
        }
    }

    pub fn linked(&self) -> Option<Graph> {
        match self.generator.shape {
            Shape::Voxels(_) => None,
            Shape::Linked(make) => Some(make(&self.settings)),
        }
    }

    /// Each voxel once, always in the same order. A cyclic scene is walked: at depth 30 that takes years.
    pub fn voxels(&self, sink: &mut dyn FnMut(Voxel), progress: &dyn Progress) {
        match self.generator.shape {
            Shape::Voxels(make) => make(&self.settings, sink, progress),
            Shape::Linked(make) => {
                let graph = make(&self.settings);
                progress.begin("walking the graph", 0);
                for cell in graph.voxels() {
                    sink(Voxel {
                        index: cell.corner,
                        color: graph.color_of(cell.node),
                        normal: None,
                    });
                }
                progress.end();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_those_given_or_defaults() {
        let settings = |text| Spec::parse(text).unwrap().settings;
        let of = |depth, seed, density| Settings {
            depth,
            seed,
            density,
        };
        assert_eq!(settings("gen:terrain"), of(10, 1, 0));
        assert_eq!(settings("gen:terrain,seed=7, depth=12"), of(12, 7, 0));
        assert_eq!(settings("gen:random,seed=2"), of(6, 2, 10));
    }

    #[test]
    fn errors_say_what_there_is() {
        let names = "there is no generator `hills`; there are checker, maze, menger, random, shell, \
                     sierpinski, sphere, terrain, truss, wires";
        for (text, part) in [
            ("terrain", "does not begin with gen:"),
            ("gen:hills", names),
            (
                "gen:menger,sead=3",
                "`sead`; it takes depth (1 to 8, default 5)",
            ),
            ("gen:menger,depth=9", "whole number from 1 to 8, not `9`"),
            ("gen:menger,depth=0", "from 1 to 8, not `0`"),
            ("gen:terrain,depth=1.5", "whole number"),
            ("gen:menger,depth=3,depth=4", "depth is given twice"),
            ("gen:menger,deep", "key=value"),
        ] {
            let error = Spec::parse(text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn no_scene_has_fewer_voxels_than_its_least() {
        for text in [
            "gen:checker,depth=4",
            "gen:menger,depth=3",
            "gen:terrain,depth=6",
        ] {
            let spec = Spec::parse(text).unwrap();
            let mut voxels = 0;
            spec.voxels(&mut |_| voxels += 1, &crate::graph::Silent);
            let least = spec.least_voxels();
            let is_near = least > 0 && (least..=2 * least).contains(&voxels);
            assert!(is_near, "{text}: {voxels}");
        }
    }
}
