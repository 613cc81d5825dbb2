//! The camera, by coordinates or by name.

use clap::{Args, ValueEnum};
use glam::DVec3;

use super::values::point;
use shiftvox::project::{Bounds, Camera, DEFAULT_FOV, Direction, Lens, Up, fit_camera};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ViewName {
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

#[derive(Debug, Clone, Default, PartialEq, Args)]
#[command(next_help_heading = "Camera")]
pub(crate) struct CameraArgs {
    /// Position of the eye, world units
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "target",
          conflicts_with_all = ["view", "azimuth", "elevation", "zoom"], value_parser = point)]
    pub(crate) eye: Option<DVec3>,
    /// A point seen in the middle of the picture, world units
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "eye",
          value_parser = point)]
    pub(crate) target: Option<DVec3>,
    /// A direction seen pointing up [default: the file's up axis]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, requires = "eye",
          value_parser = point)]
    pub(crate) up: Option<DVec3>,
    /// Vertical field of view in degrees [default: 40]
    #[arg(long, value_name = "DEG")]
    pub(crate) fov: Option<f64>,
    /// Parallel rays (orthographic). With --view iso that is isometric, with --elevation 30 edges rise
    /// one pixel in two. The picture is HEIGHT world units high, as in --ortho=256 [default: fitted]
    #[arg(long, value_name = "HEIGHT", num_args = 0..=1, require_equals = true, conflicts_with = "fov")]
    pub(crate) ortho: Option<Option<f64>>,
    /// Named view, fitted to the object [default: iso]. In model and bench, the terrain, the sponge
    /// and the bundled tree have default views of their own
    #[arg(long, value_enum)]
    pub(crate) view: Option<ViewName>,
    /// Degrees around the up axis, 0 from the front and 90 from the right [default: the view's]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    pub(crate) azimuth: Option<f64>,
    /// Degrees above the horizon [default: the view's]
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    pub(crate) elevation: Option<f64>,
    /// Magnification of the fitted view [default: 1]
    #[arg(long, value_name = "FACTOR")]
    pub(crate) zoom: Option<f64>,
}

impl CameraArgs {
    /// The camera for an object, turned by `turn` degrees around the up axis through its target.
    pub(crate) fn camera(
        &self,
        bounds: &Bounds,
        up: Up,
        (width, height): (u32, u32),
        turn: f64,
    ) -> Camera {
        let fov_degrees = self.fov.unwrap_or(DEFAULT_FOV);
        if let (Some(eye), Some(target)) = (self.eye, self.target) {
            return Camera {
                eye,
                target,
                up: self.up.unwrap_or(up.axis()),
                fov_degrees,
                ortho: self.ortho.flatten(),
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
        let lens = match self.ortho {
            Some(_) => Lens::Ortho,
            None => Lens::Degrees(fov_degrees),
        };
        let mut camera = fit_camera(bounds, up, direction, lens, zoom, (width, height));
        camera.ortho = self.ortho.flatten().or(camera.ortho);
        camera
    }

    pub(crate) fn check(&self) -> Result<(), String> {
        if self.fov.is_some_and(|fov| !(fov > 0.0 && fov < 180.0)) {
            return Err("--fov must lie between 0 and 180 degrees".to_owned());
        }
        if self.eye.is_some() && self.ortho == Some(None) {
            return Err("with --eye, --ortho needs a height: --ortho=HEIGHT".to_owned());
        }
        if let Some(Some(height)) = self.ortho {
            if !(height > 0.0 && height.is_finite()) {
                return Err("--ortho must be a height above 0".to_owned());
            }
            if self.zoom.is_some() {
                return Err(
                    "--ortho=HEIGHT and --zoom both give the size: leave one out".to_owned(),
                );
            }
        }
        let is_zoom = |zoom: f64| zoom > 0.0 && zoom.is_finite();
        if self.zoom.is_some_and(|zoom| !is_zoom(zoom)) {
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
}
