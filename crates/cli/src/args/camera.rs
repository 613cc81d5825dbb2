//! The camera, by coordinates or by name.

use clap::{Args, ValueEnum};
use glam::DVec3;

use super::setting::{Setting, word};
use super::values::Point;
use shiftvox::project::{Bounds, Camera, DEFAULT_FOV, Direction, Up, fit_camera};

/// Where the camera stands around the object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ViewName {
    /// From a corner, above: azimuth 45, elevation 35.264 degrees.
    Iso,
    /// From the front: -Y in Z-up files, +Z in Y-up files.
    Front,
    /// From behind.
    Back,
    /// From the left, -X.
    Left,
    /// From the right, +X.
    Right,
    /// From above.
    Top,
    /// From below.
    Bottom,
}

impl ViewName {
    fn direction(self) -> Direction {
        let (azimuth, elevation) = match self {
            Self::Iso => (45.0, 35.264),
            Self::Front => (0.0, 0.0),
            Self::Right => (90.0, 0.0),
            Self::Back => (180.0, 0.0),
            Self::Left => (270.0, 0.0),
            Self::Top => (0.0, 90.0),
            Self::Bottom => (0.0, -90.0),
        };
        Direction { azimuth, elevation }
    }
}

/// The camera. By default the whole object is seen from a corner.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Camera")]
pub struct CameraArgs {
    /// Position of the eye, world units
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "target",
          conflicts_with_all = ["view", "azimuth", "elevation", "zoom"])]
    pub eye: Option<Point>,
    /// A point seen in the middle of the picture, world units
    #[arg(
        long,
        value_name = "X,Y,Z",
        allow_hyphen_values = true,
        requires = "eye"
    )]
    pub target: Option<Point>,
    /// A direction seen pointing up [default: the file's up axis]
    #[arg(
        long,
        value_name = "X,Y,Z",
        allow_hyphen_values = true,
        requires = "eye"
    )]
    pub up: Option<Point>,
    /// Vertical field of view in degrees [default: 40]
    #[arg(long, value_name = "DEG")]
    pub fov: Option<f64>,
    /// Named view, fitted to the object [default: iso; terrain, sponge and bundled tree have views of
    /// their own in model and bench]
    #[arg(long, value_enum)]
    pub view: Option<ViewName>,
    /// Degrees around the up axis: 0 from the front, 90 from the right [default: the view's]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    pub azimuth: Option<f64>,
    /// Degrees above the horizon [default: the view's]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    pub elevation: Option<f64>,
    /// Magnification of the fitted view [default: 1]
    #[arg(long, value_name = "FACTOR")]
    pub zoom: Option<f64>,
}

impl CameraArgs {
    /// The camera for an object, turned by `turn` degrees around the up axis through its target.
    #[must_use]
    pub fn camera(
        &self,
        bounds: &Bounds,
        up: Up,
        (width, height): (u32, u32),
        turn: f64,
    ) -> Camera {
        let fov_degrees = self.fov.unwrap_or(DEFAULT_FOV);
        if let (Some(eye), Some(target)) = (self.eye, self.target) {
            let camera_up = self.up.map_or(up.axis(), |point| point.0);
            let turned = |v: DVec3| turned_about(v, camera_up, turn);
            return Camera {
                eye: if turn == 0.0 {
                    eye.0
                } else {
                    target.0 + turned(eye.0 - target.0)
                },
                target: target.0,
                up: camera_up,
                fov_degrees,
                width,
                height,
            };
        }
        let named = self.view.unwrap_or(ViewName::Iso).direction();
        let direction = Direction {
            azimuth: self.azimuth.unwrap_or(named.azimuth) + turn,
            elevation: self.elevation.unwrap_or(named.elevation),
        };
        let zoom = self.zoom.unwrap_or(1.0);
        fit_camera(bounds, up, direction, fov_degrees, zoom, (width, height))
    }

    /// Whether the numbers make sense, in words if they do not.
    ///
    /// # Errors
    /// Names the wrong flag and its valid values.
    pub fn check(&self) -> Result<(), String> {
        if self.fov.is_some_and(|fov| !(fov > 0.0 && fov < 180.0)) {
            return Err("--fov must lie between 0 and 180 degrees".to_owned());
        }
        if self
            .zoom
            .is_some_and(|zoom| !(zoom > 0.0 && zoom.is_finite()))
        {
            return Err("--zoom must be above 0".to_owned());
        }
        let angles = [("--azimuth", self.azimuth), ("--elevation", self.elevation)];
        for (name, angle) in angles {
            if angle.is_some_and(|angle| !angle.is_finite()) {
                return Err(format!("{name} must be a number of degrees"));
            }
        }
        Ok(())
    }

    /// The given settings, for a configuration file.
    #[must_use]
    pub fn settings(&self) -> Vec<Setting> {
        let mut settings = Vec::new();
        for (name, point) in [("eye", self.eye), ("target", self.target), ("up", self.up)] {
            settings.extend(point.map(|point| (name, point.to_string().into())));
        }
        settings.extend(self.view.map(|view| ("view", word(&view))));
        let numbers = [
            ("fov", self.fov),
            ("azimuth", self.azimuth),
            ("elevation", self.elevation),
            ("zoom", self.zoom),
        ];
        settings.extend(
            numbers
                .into_iter()
                .filter_map(|(k, v)| Some((k, v?.into()))),
        );
        settings
    }
}

/// A vector turned about an axis by so many degrees.
fn turned_about(v: DVec3, axis: DVec3, degrees: f64) -> DVec3 {
    let Some(axis) = axis.try_normalize() else {
        return v;
    };
    let radians = degrees * (std::f64::consts::PI / 180.0);
    let along = axis * axis.dot(v);
    let across = v - along;
    along + across * libm::cos(radians) + axis.cross(across) * libm::sin(radians)
}

/// A camera as settings: eye, target, up and field of view.
#[must_use]
pub fn camera_settings(camera: &Camera) -> Vec<Setting> {
    vec![
        ("eye", Point(camera.eye).to_string().into()),
        ("target", Point(camera.target).to_string().into()),
        ("up", Point(camera.up).to_string().into()),
        ("fov", camera.fov_degrees.into()),
    ]
}

/// A camera as a line of flags to paste.
#[must_use]
pub fn camera_line(camera: &Camera) -> String {
    format!(
        "--eye {} --target {} --up {} --fov {}",
        Point(camera.eye),
        Point(camera.target),
        Point(camera.up),
        camera.fov_degrees
    )
}
