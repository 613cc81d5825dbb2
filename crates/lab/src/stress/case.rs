//! A frame of the sweep, as a line of text that draws it again.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use super::scene::StressScene;
use shiftvox::graph::{Graph, Placement};
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupError, SetupOptions};

#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    pub scene: StressScene,
    /// The camera, in finest voxels from the object's lowest corner.
    pub camera: Camera,
    /// Distance of object and camera from the world's origin, voxels along each axis.
    pub shift: i64,
    pub options: SetupOptions,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (camera, options) = (&self.camera, &self.options);
        write!(f, "scene={}", self.scene)?;
        if self.shift != 0 {
            write!(f, ";shift={}", self.shift)?;
        }
        for (key, v) in [
            ("eye", camera.eye),
            ("target", camera.target),
            ("up", camera.up),
        ] {
            write!(f, ";{key}={},{},{}", v.x, v.y, v.z)?;
        }
        let (width, height) = (camera.width, camera.height);
        match camera.ortho {
            Some(height_world) => write!(f, ";ortho={height_world}")?,
            None => write!(f, ";fov={}", camera.fov_degrees)?,
        }
        write!(f, ";size={width}x{height}")?;
        write!(f, ";bits={}", options.bits)?;
        if let Some(frac) = options.frac {
            write!(f, ";frac={frac}")?;
        }
        let (cage, coverage) = (options.cage.name(), options.coverage.name());
        write!(f, ";cage={cage};tolerance={}", options.tolerance_px)?;
        write!(f, ";coverage={coverage};lod={}", options.lod_px)
    }
}

impl FromStr for Case {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut scene = None;
        let mut camera = Camera::looking(DVec3::ZERO, DVec3::Y, 60.0, (48, 48));
        let mut shift = 0;
        let mut options = SetupOptions::default();
        for part in text.split(';').filter(|part| !part.is_empty()) {
            let (key, value) = part
                .split_once('=')
                .ok_or_else(|| format!("`{part}` is not of the form key=value"))?;
            let wrong = |what: &str| format!("{key} must be {what}, not `{value}`");
            let whole = |what: &str| value.parse::<u32>().map_err(|_| wrong(what));
            let real = |what: &str| {
                let number = value.parse::<f64>().ok().filter(|n| !n.is_nan());
                number.ok_or_else(|| wrong(what))
            };
            match key {
                "scene" => scene = Some(value.parse()?),
                "eye" => camera.eye = vector(value).ok_or_else(|| wrong("x,y,z"))?,
                "target" => camera.target = vector(value).ok_or_else(|| wrong("x,y,z"))?,
                "up" => camera.up = vector(value).ok_or_else(|| wrong("x,y,z"))?,
                "fov" => camera.fov_degrees = real("degrees")?,
                "ortho" => camera.ortho = Some(real("world units")?),
                "size" => {
                    let (width, height) = value.split_once('x').unwrap_or((value, value));
                    let side = |text: &str| text.parse().map_err(|_| wrong("pixels, as 48x48"));
                    (camera.width, camera.height) = (side(width)?, side(height)?);
                }
                "shift" => {
                    shift = value
                        .parse()
                        .ok()
                        .filter(|shift: &i64| shift.abs() < 1 << 50)
                        .ok_or_else(|| wrong("whole voxels, less than 2^50"))?;
                }
                "bits" => options.bits = whole("16 to 64")?,
                "frac" => options.frac = Some(whole("a number of bits")?),
                "tolerance" => options.tolerance_px = real("pixels, or inf")?,
                "lod" => options.lod_px = real("pixels")?,
                "cage" => {
                    let named = CageKind::ALL.into_iter().find(|cage| cage.name() == value);
                    options.cage = named.ok_or_else(|| wrong("corners or frame"))?;
                }
                "coverage" => {
                    let named = Coverage::ALL.into_iter().find(|rule| rule.name() == value);
                    options.coverage = named.ok_or_else(|| wrong("any, center, exact or alpha"))?;
                }
                _ => {
                    return Err(format!(
                        "a case has no `{key}`: it has scene, eye, target, up, fov, ortho, size, shift, \
                         bits, frac, cage, tolerance, coverage and lod"
                    ));
                }
            }
        }
        Ok(Self {
            scene: scene.ok_or("a case needs a scene=...")?,
            camera,
            shift,
            options,
        })
    }
}

fn vector(text: &str) -> Option<DVec3> {
    let parts: Vec<f64> = text
        .split(',')
        .map(|part| part.parse().ok().filter(|n: &f64| n.is_finite()))
        .collect::<Option<_>>()?;
    <[f64; 3]>::try_from(parts).ok().map(DVec3::from_array)
}

impl Case {
    pub(super) fn world_camera(&self) -> Camera {
        let by = DVec3::splat(self.shift as f64);
        Camera {
            eye: self.camera.eye + by,
            target: self.camera.target + by,
            ..self.camera
        }
    }

    /// The placement of the object. Cameras count from its lowest corner.
    pub(super) fn placement(&self, graph: &Graph) -> Placement {
        Placement {
            origin_index: [self.shift; 3],
            ..graph.placement
        }
    }

    pub(super) fn setup(&self, graph: &Graph) -> Result<FrameSetup, SetupError> {
        let (camera, placement) = (self.world_camera(), self.placement(graph));
        FrameSetup::new(&camera, &placement, graph.depth, &self.options)
    }
}
