//! How far a vertex can be from where it should be: bounds that are derived in `spec/bounds.md`, in
//! real numbers, from the camera and the machine's fraction bits.

use glam::DVec3;

use shiftvox::graph::Placement;
use shiftvox::project::{Camera, CameraError};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Widths {
    /// Fraction bits of clip vectors, of a finest voxel.
    pub clip_frac: u32,
    /// Fraction bits of screen positions, of a sample.
    pub screen_frac: u32,
    /// Samples per pixel and axis, as a power of two.
    pub aa_log2: u32,
}

/// Relative error of a sum of a few `f64`.
const REAL_ERROR: f64 = 8.0 * f64::EPSILON;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cube {
    pub corner: DVec3,
    pub side: f64,
}

impl Cube {
    fn vertex(&self, vertex: usize) -> DVec3 {
        let bit = |place: usize| (vertex >> place & 1) as f64;
        self.corner + DVec3::new(bit(2), bit(1), bit(0)) * self.side
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Space {
    /// X, Y and W: both cages.
    Clip,
    /// On the screen, as eight corners since this cube was projected.
    Corners(Cube),
    /// On the screen, as a corner and three edges.
    Frame(Cube),
}

/// A view in real numbers, and what rounding does to it.
#[derive(Debug, Clone)]
pub struct Bounds {
    eye: DVec3,
    /// Clip vectors of a voxel's edges: X, Y in parts of the image root, W in voxels.
    edge: [DVec3; 3],
    root: f64,
    widths: Widths,
    /// Error of the eye in `f64`, voxels along each axis.
    eye_error: f64,
}

impl Bounds {
    /// Of a camera's view of an object that lies at `placement`.
    pub fn new(
        camera: &Camera,
        placement: &Placement,
        widths: Widths,
    ) -> Result<Self, CameraError> {
        let axes = camera.axes()?;
        let size = f64::from(camera.width.max(camera.height));
        let root_px = libm::exp2(libm::ceil(libm::log2(size)));
        let [half_width, half_height] =
            [camera.width, camera.height].map(|side| f64::from(side) / 2.0);
        let across = (axes.forward * half_width + axes.right * axes.focal_px) / root_px;
        let down = (axes.forward * half_height - axes.up * axes.focal_px) / root_px;
        let index = placement.origin_index.map(|c| c as f64);
        let lowest = DVec3::from_array(placement.world_origin)
            + DVec3::from_array(index) * placement.voxel_size;
        let far = [
            camera.eye,
            DVec3::from_array(placement.world_origin),
            lowest,
        ];
        let reach = far
            .iter()
            .map(|v| v.abs().max_element())
            .fold(0.0, f64::max);
        Ok(Self {
            eye: (camera.eye - lowest) / placement.voxel_size,
            edge: [0, 1, 2].map(|k| DVec3::new(across[k], down[k], axes.forward[k])),
            root: root_px * f64::from(1u32 << widths.aa_log2),
            widths,
            eye_error: reach / placement.voxel_size * f64::EPSILON,
        })
    }

    /// X, Y (parts of the root times depth) and W (voxels) of a point.
    fn clip(&self, u: DVec3) -> DVec3 {
        let from_eye = u - self.eye;
        (0..3).map(|k| self.edge[k] * from_eye[k]).sum()
    }

    /// Where a point is seen, samples; `None` where it is not before the eye.
    pub fn project(&self, u: DVec3) -> Option<[f64; 2]> {
        let clip = self.clip(u);
        (clip.z > 0.0).then(|| [clip.x / clip.z, clip.y / clip.z].map(|x| x * self.root))
    }

    /// Depth of a point, voxels.
    pub fn depth(&self, u: DVec3) -> f64 {
        self.clip(u).z
    }

    /// Most, in voxels of depth, by which rounding moves a coordinate of a point's clip vector. Each
    /// component of an edge moves by half a unit. So does the origin, which is made from the rounded
    /// edges.
    fn shift(&self, u: DVec3) -> f64 {
        let steps = (u - self.eye).abs().element_sum();
        let eye = self.eye.abs().element_sum();
        let longest = self.edge.iter().map(|e| e.abs().max_element());
        let longest = longest.fold(0.0, f64::max);
        let real = longest * (3.0 * self.eye_error + REAL_ERROR * (steps + eye));
        self.unit() / 2.0 * (steps + 1.0) + real
    }

    fn unit(&self) -> f64 {
        libm::ldexp(1.0, -(self.widths.clip_frac as i32))
    }

    /// The host's rounding error of a point before the eye, samples. It is infinite if the rounded
    /// point may be behind the eye.
    pub fn host(&self, u: DVec3) -> [f64; 2] {
        let (clip, shift) = (self.clip(u), self.shift(u));
        let left = clip.z - shift;
        [clip.x, clip.y].map(|x| {
            if left <= 0.0 {
                return f64::INFINITY;
            }
            self.root * shift * (1.0 + (x / clip.z).abs()) / left
        })
    }

    /// How far the vertex at `u` may be from its projection along x and y, samples, if it is held in
    /// `space`, `levels` below the level of the cube that changed. The sum of the host's rounding of
    /// edges and origin, the deviation of the screen's straight lines from perspective, and the
    /// rounding of quotients, midpoints and edges.
    pub fn vertex(&self, space: Space, levels: u32, u: DVec3) -> [f64; 2] {
        let unit = libm::ldexp(1.0, -(self.widths.screen_frac as i32));
        let levels = f64::from(levels);
        let (deviation, rounding) = match space {
            Space::Clip => ([0.0; 2], 0.0),
            Space::Corners(cube) => (self.corner_deviation(&cube), (1.0 + 1.5 * levels) * unit),
            Space::Frame(cube) => (self.frame_deviation(&cube), (3.0 + 3.0 * levels) * unit),
        };
        let host = self.host(u);
        [0, 1].map(|c| host[c] + deviation[c] + rounding)
    }

    /// Of the rounded view: depths that the cube's edges span, the greatest speed of a position along
    /// each edge (times the depth, samples), and the least depth.
    fn speeds(&self, cube: &Cube, c: usize) -> ([f64; 3], [f64; 3], f64) {
        let half = self.unit() / 2.0;
        let span = self.edge.map(|e| (e.z.abs() + half) * cube.side);
        let mut speed = [0.0f64; 3];
        let mut least = f64::INFINITY;
        for vertex in 0..8 {
            let u = cube.vertex(vertex);
            let clip = self.clip(u);
            least = least.min((clip.z - self.shift(u)).max(0.0));
            let x = clip[c] / clip.z;
            let x_moves = self.host(u)[c] / self.root;
            for (k, most) in speed.iter_mut().enumerate() {
                let edge = self.edge[k];
                let rounding = half * (1.0 + x.abs() + x_moves) + edge.z.abs() * x_moves;
                let moves = (edge[c] - x * edge.z).abs() + rounding;
                *most = most.max(moves * cube.side * self.root);
            }
        }
        (span, speed, least)
    }

    /// Interpolation between eight true corners: an eighth of the greatest
    /// second derivative along each edge, `2 D E / W^2`.
    fn corner_deviation(&self, cube: &Cube) -> [f64; 2] {
        [0, 1].map(|c| {
            let (span, speed, least) = self.speeds(cube, c);
            (0..3).map(|k| speed[k] * span[k]).sum::<f64>() / (4.0 * least * least)
        })
    }

    /// The affine map through a corner and the ends of three edges.
    fn frame_deviation(&self, cube: &Cube) -> [f64; 2] {
        [0, 1].map(|c| {
            let (span, speed, least) = self.speeds(cube, c);
            let all: f64 = span.iter().sum();
            let part = |k: usize| {
                let others = all - span[k];
                // The most of f (others + (1 - f) span) for f from 0 to 1.
                let most = if others >= span[k] {
                    others
                } else {
                    all * all / (4.0 * span[k])
                };
                speed[k] * most
            };
            (0..3).map(part).sum::<f64>() / (least * least)
        })
    }
}
