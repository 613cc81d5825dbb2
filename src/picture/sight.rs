//! The point at which a sample's ray meets its voxel. Only `+ - * /` and square roots in f64, which IEEE 754 rounds
//! correctly: the same bits on every computer.

use glam::{DMat3, DVec3};

use crate::project::FrameSetup;

/// A ray that misses a cube by less than this share of the depth counts as a hit: `exact` draws on the outline itself,
/// where f64 rounds either way.
const GRAZE: f64 = 1e-9;

pub(super) struct Sight {
    origin: [i64; 3],
    edge: [[i64; 3]; 3],
    depth: u32,
    /// Whether the clip vectors of all points of the object fit 64 bits.
    is_narrow: bool,
    pub(super) to_object: DMat3,
    depth_unit: f64,
    pub(super) root_doubled: f64,
    axes: [DVec3; 3],
    ortho: Option<OrthoDepth>,
}

/// Depth of parallel rays: too small a part of the large `W` of their distant eye.
struct OrthoDepth {
    /// Zero of depth, object coordinates.
    eye: DVec3,
    /// Along the rays, world units per voxel.
    forward: DVec3,
}

/// The visible part of a voxel's cube at a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Meeting {
    /// View-axis depth in world units, 0 or more; of parallel rays below 0 behind the eye.
    pub(super) depth: f64,
    pub(super) face: DVec3,
    pub(super) ray: DVec3,
}

impl Sight {
    pub(super) fn new(setup: &FrameSetup) -> Self {
        let column = |k: usize| {
            let edge = setup.edge_clip[k];
            DVec3::new(edge[0] as f64, edge[1] as f64, edge[2] as f64)
        };
        let to_clip = DMat3::from_cols(column(0), column(1), column(2));
        let to_object = inverse(&to_clip);
        // Rows of the view: the gradients of X, Y and W over the object. W grows along the view axis; the share of W in
        // X and Y is removed.
        let rows = to_clip.transpose();
        let forward = match setup.ortho_eye {
            None => rows.z_axis.normalize(),
            // W's small integers are coarse. The ray in the middle of the picture leaves both of its planes' gradients
            // unchanged.
            Some(_) => {
                let root = (1u64 << setup.levels) as f64;
                let plane =
                    |row: DVec3, size: u32| row - rows.z_axis * (f64::from(size) / 2.0 / root);
                let [x, y] = [(rows.x_axis, setup.width), (rows.y_axis, setup.height)]
                    .map(|(row, size)| plane(row, size));
                let along = x.cross(y).normalize();
                if along.dot(rows.z_axis) < 0.0 {
                    -along
                } else {
                    along
                }
            }
        };
        let across = |row: DVec3| (row - forward * row.dot(forward)).normalize();
        Self {
            origin: setup.origin_clip,
            edge: setup.edge_clip,
            depth: setup.depth,
            is_narrow: is_narrow(setup),
            to_object,
            depth_unit: setup.depth_unit_world(),
            root_doubled: 2.0 * (1u64 << setup.levels) as f64,
            axes: [across(rows.x_axis), -across(rows.y_axis), -forward],
            ortho: setup.ortho_eye.map(|eye| OrthoDepth {
                eye: eye.into(),
                forward: forward * setup.placement.voxel_size,
            }),
        }
    }

    pub(super) fn axes(&self) -> [DVec3; 3] {
        self.axes
    }

    pub(super) fn meet(&self, x: u32, y: u32, voxel: [i32; 4]) -> Meeting {
        let (corner, side) = self.cube(voxel);
        let eye = -(self.to_object * corner);
        let direction = self.direction(x, y);
        let (enter, exit, axis) = slabs(eye, direction, side);
        let hit = exit >= 0.0 && enter - exit <= GRAZE * exit;
        if hit && enter > 0.0 {
            let mut face = DVec3::ZERO;
            face[axis] = if direction[axis] > 0.0 { -1.0 } else { 1.0 };
            return Meeting {
                depth: self.depth(enter, voxel, eye + direction * enter),
                face,
                ray: direction.normalize_or_zero(),
            };
        }
        let depth = if hit {
            0.0
        } else {
            let to_centre = (0..3)
                .map(|k| self.edge[k][2] as f64 * (side / 2.0))
                .sum::<f64>();
            (corner.z + to_centre).max(0.0)
        };
        Meeting {
            depth: self.depth(depth, voxel, DVec3::splat(side / 2.0)),
            face: facing(eye - DVec3::splat(side / 2.0)),
            ray: direction.normalize_or_zero(),
        }
    }

    /// Depth of a point with this `W`, in world units; the point's place counts from the voxel's lowest corner.
    fn depth(&self, w: f64, voxel: [i32; 4], place: DVec3) -> f64 {
        let Some(OrthoDepth { eye, forward }) = &self.ortho else {
            return w * self.depth_unit;
        };
        let [x, y, z, _] = voxel.map(f64::from);
        (DVec3::new(x, y, z) - eye + place).dot(*forward)
    }

    /// Unit object direction of a sample's ray, as in [`Sight::meet`].
    pub(super) fn ray(&self, x: u32, y: u32) -> DVec3 {
        self.direction(x, y).normalize_or_zero()
    }

    /// The object direction of a sample's ray along which `W` grows by one.
    fn direction(&self, x: u32, y: u32) -> DVec3 {
        self.to_object
            * DVec3::new(
                f64::from(2 * x + 1) / self.root_doubled,
                f64::from(2 * y + 1) / self.root_doubled,
                1.0,
            )
    }

    /// Clip vector of a voxel's lowest corner, rounded once, and the voxel's side in finest voxels.
    fn cube(&self, voxel: [i32; 4]) -> (DVec3, f64) {
        let [x, y, z, _] = voxel;
        let is_inside = |c: i32| u64::try_from(c).is_ok_and(|c| c < 1 << self.depth);
        // Both ways round the exact sum once, to the nearest `f64`.
        let clip = |c: usize| {
            let edge = [self.edge[0][c], self.edge[1][c], self.edge[2][c]];
            if self.is_narrow && is_inside(x) && is_inside(y) && is_inside(z) {
                let along =
                    edge[0] * i64::from(x) + edge[1] * i64::from(y) + edge[2] * i64::from(z);
                return (self.origin[c] + along) as f64;
            }
            let sum: i128 = (0..3)
                .map(|k| i128::from(edge[k]) * i128::from(voxel[k]))
                .sum();
            (i128::from(self.origin[c]) + sum) as f64
        };
        let level = voxel[3].clamp(0, self.depth as i32) as u32;
        let side = (1u64 << (self.depth - level)) as f64;
        (DVec3::new(clip(0), clip(1), clip(2)), side)
    }
}

fn is_narrow(setup: &FrameSetup) -> bool {
    let within = |c: usize| {
        let longest: u128 = (0..3)
            .map(|k| u128::from(setup.edge_clip[k][c].unsigned_abs()) << setup.depth)
            .sum();
        longest + u128::from(setup.origin_clip[c].unsigned_abs()) <= i64::MAX as u128
    };
    (0..3).all(within)
}

fn inverse(m: &DMat3) -> DMat3 {
    let (a, b, c) = (m.x_axis, m.y_axis, m.z_axis);
    let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
    let determinant = a.dot(bc);
    DMat3::from_cols(bc / determinant, ca / determinant, ab / determinant).transpose()
}

/// The positions at which a ray enters and leaves the cube from 0 to `side`, and the axis of the face of entry: of equal
/// ones the first.
fn slabs(eye: DVec3, direction: DVec3, side: f64) -> (f64, f64, usize) {
    let (mut enter, mut exit, mut axis) = (f64::NEG_INFINITY, f64::INFINITY, 0);
    for k in 0..3 {
        if direction[k] == 0.0 {
            if eye[k] < 0.0 || eye[k] > side {
                return (f64::INFINITY, f64::NEG_INFINITY, k);
            }
            continue;
        }
        let at_low = -eye[k] / direction[k];
        let at_high = (side - eye[k]) / direction[k];
        if at_low.min(at_high) > enter {
            enter = at_low.min(at_high);
            axis = k;
        }
        exit = exit.min(at_low.max(at_high));
    }
    (enter, exit, axis)
}

/// The face turned most towards the eye, which is `offset` away from the centre.
fn facing(offset: DVec3) -> DVec3 {
    let axis = (1..3).fold(0, |best, k| {
        if offset[k].abs() > offset[best].abs() {
            k
        } else {
            best
        }
    });
    let mut face = DVec3::ZERO;
    face[axis] = if offset[axis] < 0.0 { -1.0 } else { 1.0 };
    face
}
