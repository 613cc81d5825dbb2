//! Requests of a page, in JSON.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Most pixels of a picture: 2048 x 2048.
pub(crate) const MOST_PIXELS: u64 = 1 << 22;
/// Most samples of a picture: 16 per pixel at 1024 x 1024.
pub(crate) const MOST_SAMPLES: u64 = 1 << 24;
/// Most bytes of a dropped file.
pub(crate) const MOST_FILE: usize = 256 << 20;
const MOST_LETTERS: usize = 64;

/// Flags of `render` that a page may set. None of them names a file.
pub const FLAGS: &str = "background bits cage coverage crop engine erosion erosion-grid far-opacity frac \
                         isa lod overflow shade tolerance";

/// Values of flags by their names.
pub type Flags = BTreeMap<String, String>;

/// A request.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// The page's own number, which the answer repeats.
    pub(crate) seq: u64,
    /// The kind of answer.
    pub ask: Ask,
    /// Place in the list of scenes.
    pub scene: usize,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Samples per pixel and axis.
    pub aa: u32,
    /// `None`: a camera that is fitted to the scene.
    #[serde(default)]
    pub camera: Option<Camera>,
    /// Flags of [`FLAGS`] that are set.
    #[serde(default)]
    pub flags: Flags,
    /// The buffer of `render` that is shown, if it is not `color`.
    #[serde(default)]
    pub show: Option<String>,
    /// The picked pixel, across and down.
    #[serde(default)]
    pub at: [u32; 2],
    /// Whether the answer has the picture's hash.
    #[serde(default)]
    pub hash: bool,
    /// Whether the picture is a PNG file, not four bytes per pixel.
    #[serde(default)]
    pub png: bool,
}

/// The kind of answer that a page asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Ask {
    /// A picture.
    Picture,
    /// The voxel that a pixel of a picture shows.
    Pick,
    /// Figures of the hardware model.
    Figures,
}

/// A placed camera. JSON has no infinity and no NaN: they come as `null`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "named as in the camera of render")]
pub struct Camera {
    pub eye: [Option<f64>; 3],
    pub target: [Option<f64>; 3],
    pub up: [Option<f64>; 3],
    pub fov: Option<f64>,
    #[serde(default)]
    pub ortho: Option<f64>,
}

impl Camera {
    /// Eye, target, up and degrees; what is `null` is NaN, with which a camera sees nothing.
    #[must_use]
    pub fn numbers(&self) -> ([[f64; 3]; 3], f64) {
        let number = |number: Option<f64>| number.unwrap_or(f64::NAN);
        let points = [self.eye, self.target, self.up].map(|point| point.map(number));
        (points, number(self.fov))
    }
}

/// Refuses a picture that is too large, with `aa` samples per pixel and axis.
///
/// # Errors
/// The reason.
pub fn check_size([width, height]: [u32; 2], aa: u32) -> Result<(), String> {
    let pixels = u64::from(width) * u64::from(height);
    let samples = pixels.saturating_mul(u64::from(aa).pow(2));
    if pixels <= MOST_PIXELS && samples <= MOST_SAMPLES {
        return Ok(());
    }
    let most = format!("{MOST_PIXELS} pixels and {MOST_SAMPLES} samples");
    Err(format!("a page's picture has at most {most}"))
}

impl Request {
    pub(crate) fn check(&self) -> Result<(), String> {
        for (name, value) in &self.flags {
            if !FLAGS.split(' ').any(|flag| flag == name) {
                return Err("a page may not set this flag".to_owned());
            }
            let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "+-.,".contains(letter);
            if value.len() > MOST_LETTERS || !value.chars().all(is_plain) {
                return Err(format!("--{name} has no such value"));
            }
        }
        check_size(self.size, self.aa)
    }

    /// Those of these flags that are set, as words of a command line.
    pub fn words(&self, of: &str) -> impl Iterator<Item = String> {
        let flags = of
            .split(' ')
            .filter_map(|name| self.flags.get_key_value(name));
        flags.map(|(name, value)| format!("--{name}={value}"))
    }
}
