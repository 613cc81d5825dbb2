//! A frame of the sweep, as a line of text that draws it again.

use std::fmt;
use std::str::FromStr;

use glam::DVec3;

use super::scene::StressScene;
use shiftvox::graph::{Graph, Placement};
use shiftvox::project::{CageKind, Camera, Coverage, FrameSetup, SetupError, SetupOptions};

/// A scene, a camera and settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// The scene.
    pub scene: StressScene,
    /// The camera, in finest voxels from the object's lowest corner.
    pub camera: Camera,
    /// Distance of object and camera from the world's origin, voxels along each axis.
    pub shift: i64,
    /// Settings.
    pub options: SetupOptions,
}

impl Case {
    /// Camera and settings by their keys, seen from another origin.
    fn settings(&self, origin: DVec3) -> Vec<(&'static str, String)> {
        let (camera, options) = (&self.camera, &self.options);
        let vector = |v: DVec3| format!("{},{},{}", v.x, v.y, v.z);
        let mut all = vec![
            ("eye", vector(camera.eye + origin)),
            ("target", vector(camera.target + origin)),
            ("up", vector(camera.up)),
            ("fov", camera.fov_degrees.to_string()),
            ("size", format!("{}x{}", camera.width, camera.height)),
            ("bits", options.bits.to_string()),
        ];
        all.extend(options.frac.map(|frac| ("frac", frac.to_string())));
        all.extend([
            ("cage", options.cage.name().to_owned()),
            ("tolerance", options.tolerance_px.to_string()),
            ("coverage", options.coverage.name().to_owned()),
            ("lod", options.lod_px.to_string()),
        ]);
        all
    }
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "scene={}", self.scene)?;
        if self.shift != 0 {
            write!(f, ";shift={}", self.shift)?;
        }
        let mut settings = self.settings(DVec3::ZERO).into_iter();
        settings.try_for_each(|(key, value)| write!(f, ";{key}={value}"))
    }
}

impl FromStr for Case {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut scene = None;
        let mut camera = Camera {
            eye: DVec3::ZERO,
            target: DVec3::Y,
            up: DVec3::Z,
            fov_degrees: 60.0,
            width: 48,
            height: 48,
        };
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
                "eye" | "target" | "up" => {
                    let vector = vector(value).ok_or_else(|| wrong("x,y,z"))?;
                    match key {
                        "eye" => camera.eye = vector,
                        "target" => camera.target = vector,
                        _ => camera.up = vector,
                    }
                }
                "fov" => camera.fov_degrees = real("degrees")?,
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
                        "a case has no `{key}`: it has scene, eye, target, up, fov, size, shift, \
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
    /// The camera in world units.
    #[must_use]
    pub fn world_camera(&self) -> Camera {
        let by = DVec3::splat(self.shift as f64);
        Camera {
            eye: self.camera.eye + by,
            target: self.camera.target + by,
            ..self.camera
        }
    }

    /// The placement of the object.
    #[must_use]
    pub fn placement(&self, graph: &Graph) -> Placement {
        let mut placement = graph.placement;
        // Cameras count from the object's lowest corner.
        placement.origin_index = [self.shift; 3];
        placement
    }

    /// The frame.
    ///
    /// # Errors
    /// When it cannot be set up.
    pub fn setup(&self, graph: &Graph) -> Result<FrameSetup, SetupError> {
        FrameSetup::new(
            &self.world_camera(),
            &self.placement(graph),
            graph.depth,
            &self.options,
        )
    }

    /// The command that draws the picture, where `render` can.
    #[must_use]
    pub fn render_line(&self, graph: &Graph) -> Option<String> {
        let StressScene::Generated(spec) = &self.scene else {
            return None;
        };
        if self.shift != 0 {
            return None;
        }
        let lowest = DVec3::from_array(graph.placement.origin_index.map(|c| c as f64));
        let flags = self.settings(lowest).into_iter();
        let flags: String = flags
            .map(|(key, value)| format!(" --{key} {value}"))
            .collect();
        Some(format!(
            "shiftvox render {spec} --engine machine{flags} -o failing.png"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_comes_back_from_its_text() {
        let text = "scene=gen:shell,depth=4;eye=1.5,-0.1,1e30;target=0,0,0.1;up=0,0,1;fov=0.5;size=40x30;shift=-7\
                    ;bits=17;frac=3;cage=corners;tolerance=inf;coverage=any;lod=0.5";
        let case: Case = text.parse().unwrap();
        let again: Case = case.to_string().parse().unwrap();
        assert_eq!(case, again);
        assert_eq!(case.options.bits, 17);
        assert!(case.options.tolerance_px.is_infinite());
        for bad in [
            "",
            "eye=1,2,3",
            "scene=solid:3;bits=x",
            "scene=solid:3;what=1",
            "scene=solid:3;eye=1,2",
        ] {
            assert!(bad.parse::<Case>().is_err(), "{bad}");
        }
    }
}
