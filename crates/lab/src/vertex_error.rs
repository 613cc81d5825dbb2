//! How far the image-order paper's screen-space midpoints are from the truth.
//!
//! Collinearity survives a perspective projection, midpoints do not. Here a
//! cube's lattice of vertices is projected exactly for the first levels, then
//! halved on the screen with floor midpoints in fixed point, as the machine
//! with `--cage corners` does it, and compared with the projection of every
//! vertex. The integers are the machine's: a test compares them one by one.
//!
//! The arithmetic is written anew, on whole lattices in place of eight
//! corners, so that it can contradict the machine.

use std::fmt;

use glam::DVec3;
use serde::Serialize;

use shiftvox::graph::Placement;
use shiftvox::project::{
    CageKind, Camera, CameraError, Coverage, FrameSetup, SetupError, SetupOptions,
};

/// Most levels that a lattice may have: 129^3 vertices, 130 MB.
pub const MAX_DEPTH: u32 = 7;

/// A named view of the unit cube `[0, 1]^3`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NamedCamera {
    /// What a table calls it.
    pub name: String,
    /// The camera, in cube sides.
    pub camera: Camera,
}

/// The error after some exact levels, over all vertices of the finest lattice.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LevelError {
    /// Octree levels that were projected exactly before the first screen-space midpoint.
    pub exact_levels: u32,
    /// Greatest distance from the exact projection, pixels.
    pub worst_px: f64,
    /// Mean distance, pixels.
    pub mean_px: f64,
    /// Distance that 99.9 % of the vertices do not exceed, pixels.
    pub percentile_99_9_px: f64,
}

/// One view's errors, by growing number of exact levels from 0.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CameraVertexErrors {
    /// The view.
    pub view: NamedCamera,
    /// Its errors.
    pub levels: Vec<LevelError>,
}

/// The table: a row for each view.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VertexErrorTable {
    /// Octree levels of the cube's lattice, which has `(2^depth + 1)^3` vertices.
    pub depth: u32,
    /// Rows.
    pub rows: Vec<CameraVertexErrors>,
}

/// Why there is no table.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VertexErrorError {
    /// The camera sees nothing.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The view cannot be set up.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A vertex has no place on the screen.
    #[error("view \"{0}\": a part of the cube is not before the eye, so it has no projection")]
    BehindEye(String),
    /// Too many levels, or more exact ones than there are.
    #[error(
        "{exact_levels} exact levels of {depth}: at most {MAX_DEPTH} levels, all of them exact"
    )]
    Levels {
        /// Levels that were to be exact.
        exact_levels: u32,
        /// Levels in all.
        depth: u32,
    },
}

/// Picture side of the standard views, pixels.
const SIDE_PX: u32 = 1024;
/// Half the diagonal of a unit cube.
const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_6;

/// Levels of the standard table's lattice.
pub const STANDARD_DEPTH: u32 = 5;
/// Exact levels of its last column.
pub const STANDARD_EXACT_LEVELS: u32 = 4;

/// The four standard views, 1024 x 1024, all looking at the cube's centre.
///
/// Three see the cube in direction (1, 0.9, 0.6) from 1.5, 4 and 16 sides
/// away, counted from half a side off the centre, with a field of view in which a sphere
/// around the cube fills the picture. The fourth stands 0.3 sides before a
/// face, seven eighths along its width and at half its height, and sees 60 degrees.
#[must_use]
pub fn standard_views() -> Vec<NamedCamera> {
    let centre = DVec3::splat(0.5);
    let camera = |eye: DVec3, fov_degrees: f64| Camera {
        eye,
        target: centre,
        up: DVec3::Z,
        fov_degrees,
        width: SIDE_PX,
        height: SIDE_PX,
    };
    let direction = DVec3::new(1.0, 0.9, 0.6).normalize();
    let mut views: Vec<NamedCamera> = [1.5, 4.0, 16.0]
        .into_iter()
        .map(|away: f64| NamedCamera {
            name: format!("{away} sides away"),
            camera: camera(
                centre + direction * (away + 0.5),
                2.0 * libm::atan(HALF_DIAGONAL / away).to_degrees(),
            ),
        })
        .collect();
    views.push(NamedCamera {
        name: "0.3 sides from a face".to_owned(),
        camera: camera(DVec3::new(0.875, -0.3, 0.5), 60.0),
    });
    views
}

/// The standard table.
///
/// # Errors
/// None of [`VertexErrorError`] is expected of the standard views.
pub fn standard_table() -> Result<VertexErrorTable, VertexErrorError> {
    vertex_error(&standard_views(), STANDARD_DEPTH, STANDARD_EXACT_LEVELS)
}

/// Errors of a lattice of `depth` levels with 0, 1, ... `exact_levels` of
/// them exact, for each view.
///
/// # Errors
/// [`VertexErrorError`]: levels out of range (`exact_levels <= depth <=`
/// [`MAX_DEPTH`]), a camera that cannot see, or a vertex that is not before it.
pub fn vertex_error(
    views: &[NamedCamera],
    depth: u32,
    exact_levels: u32,
) -> Result<VertexErrorTable, VertexErrorError> {
    if depth > MAX_DEPTH || exact_levels > depth {
        return Err(VertexErrorError::Levels {
            exact_levels,
            depth,
        });
    }
    let rows = views
        .iter()
        .map(|view| row(view, depth, exact_levels))
        .collect::<Result<_, _>>()?;
    Ok(VertexErrorTable { depth, rows })
}

fn row(
    view: &NamedCamera,
    depth: u32,
    exact_levels: u32,
) -> Result<CameraVertexErrors, VertexErrorError> {
    let setup = set_up(&view.camera, depth)?;
    let behind = || VertexErrorError::BehindEye(view.name.clone());
    let truth = project_all(&view.camera, depth)?.ok_or_else(behind)?;
    let unit_px = libm::ldexp(1.0, -(setup.format.frac() as i32));
    let levels = (0..=exact_levels)
        .map(|exact_levels| {
            let lattice = ScreenVertices::projected(&setup, exact_levels).ok_or_else(behind)?;
            let lattice = lattice.halved(depth - exact_levels);
            let mut errors: Vec<f64> = lattice
                .vertices
                .iter()
                .zip(&truth)
                .map(|(vertex, exact)| {
                    let off = [0, 1].map(|c| vertex[c] as f64 * unit_px - exact[c]);
                    libm::hypot(off[0], off[1])
                })
                .collect();
            errors.sort_unstable_by(f64::total_cmp);
            let rank = (errors.len() * 999).div_ceil(1000) - 1;
            Ok(LevelError {
                exact_levels,
                worst_px: errors[errors.len() - 1],
                mean_px: errors.iter().sum::<f64>() / errors.len() as f64,
                percentile_99_9_px: errors[rank],
            })
        })
        .collect::<Result<_, VertexErrorError>>()?;
    Ok(CameraVertexErrors {
        view: view.clone(),
        levels,
    })
}

/// The image-order paper's machine on a unit cube of `2^depth` voxels a side.
fn set_up(camera: &Camera, depth: u32) -> Result<FrameSetup, SetupError> {
    let placement = Placement {
        voxel_size: libm::ldexp(1.0, -(depth as i32)),
        ..Placement::default()
    };
    let options = SetupOptions {
        cage: CageKind::Corners,
        tolerance_px: f64::INFINITY,
        coverage: Coverage::Any,
        ..SetupOptions::of(Coverage::Any)
    };
    FrameSetup::new(camera, &placement, depth, &options)
}

/// Pixel positions of the finest lattice's vertices, x slowest, z fastest;
/// `None` where one is not before the eye. The error is far below a screen
/// unit; so the table also holds the set-up's rounding of the view, a unit or two.
fn project_all(camera: &Camera, depth: u32) -> Result<Option<Vec<[f64; 2]>>, CameraError> {
    let axes = camera.axes()?;
    let centre = [camera.width, camera.height].map(|side| f64::from(side) / 2.0);
    let side = libm::ldexp(1.0, -(depth as i32));
    Ok(lattice_points(1 << depth)
        .map(|point| {
            let point = DVec3::from_array(point.map(|c| c as f64 * side)) - camera.eye;
            let w = point.dot(axes.forward);
            (w > 0.0).then(|| {
                [
                    centre[0] + axes.focal_px * point.dot(axes.right) / w,
                    centre[1] - axes.focal_px * point.dot(axes.up) / w,
                ]
            })
        })
        .collect())
}

/// All `(cells + 1)^3` points of a lattice, x slowest, z fastest.
fn lattice_points(cells: i64) -> impl Iterator<Item = [i64; 3]> {
    (0..=cells)
        .flat_map(move |x| (0..=cells).flat_map(move |y| (0..=cells).map(move |z| [x, y, z])))
}

/// Screen positions (x, y) of `(cells + 1)^3` vertices, x slowest, z fastest,
/// in the units of the set-up's format.
#[derive(Debug, Clone, PartialEq)]
struct ScreenVertices {
    cells: usize,
    vertices: Vec<[i64; 2]>,
}

impl ScreenVertices {
    /// The lattice of octree level `level`, every vertex projected: the
    /// quotient of its clip vector's integers, rounded down. `None` where a
    /// vertex is not before the eye.
    fn projected(setup: &FrameSetup, level: u32) -> Option<Self> {
        let bits = setup.levels + setup.format.frac();
        let step = 1i64 << (setup.depth - level);
        let vertices = lattice_points(1 << level)
            .map(|point| {
                let clip: [i128; 3] = [0, 1, 2].map(|c| {
                    (0..3).fold(i128::from(setup.origin_clip[c]), |sum, k| {
                        sum + i128::from(point[k] * step) * i128::from(setup.edge_clip[k][c])
                    })
                });
                let [x, y, w] = clip;
                let quotient = |x: i128| i64::try_from((x << bits).div_euclid(w)).ok();
                if w <= 0 {
                    return None;
                }
                Some([quotient(x)?, quotient(y)?])
            })
            .collect::<Option<_>>()?;
        Some(Self {
            cells: 1 << level,
            vertices,
        })
    }

    /// Halved `times` times.
    fn halved(self, times: u32) -> Self {
        (0..times).fold(self, |lattice, _| lattice.halved_once())
    }

    /// Twice as many cells a side: floor midpoints along x, then y, then z.
    /// Neighbouring cells make the same midpoints on the face that they share.
    fn halved_once(&self) -> Self {
        let coarse = self.cells + 1;
        let fine = 2 * self.cells + 1;
        let at = |[x, y, z]: [usize; 3]| (x * fine + y) * fine + z;
        let mut vertices = vec![[0; 2]; fine * fine * fine];
        for x in 0..coarse {
            for y in 0..coarse {
                for z in 0..coarse {
                    vertices[at([2 * x, 2 * y, 2 * z])] =
                        self.vertices[(x * coarse + y) * coarse + z];
                }
            }
        }
        // Along `axis` the odd places are new; along later axes only even ones exist yet.
        for axis in 0..3 {
            let stride = |other: usize| if other > axis { 2 } else { 1 };
            for x in (0..fine).step_by(stride(0)) {
                for y in (0..fine).step_by(stride(1)) {
                    for z in (0..fine).step_by(stride(2)) {
                        let here = [x, y, z];
                        if here[axis] % 2 == 0 {
                            continue;
                        }
                        let (mut below, mut above) = (here, here);
                        below[axis] -= 1;
                        above[axis] += 1;
                        let (a, b) = (vertices[at(below)], vertices[at(above)]);
                        vertices[at(here)] = [0, 1].map(|c| (a[c] + b[c]) >> 1);
                    }
                }
            }
        }
        Self {
            cells: 2 * self.cells,
            vertices,
        }
    }
}

impl fmt::Display for VertexErrorTable {
    /// A Markdown table: `worst / mean` in pixels.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.rows.iter().map(|row| row.levels.len()).max();
        write!(f, "| camera |")?;
        for exact_levels in 0..columns.unwrap_or(0) {
            write!(f, " {exact_levels} exact |")?;
        }
        write!(f, "\n|---|")?;
        for _ in 0..columns.unwrap_or(0) {
            write!(f, "---|")?;
        }
        writeln!(f)?;
        for row in &self.rows {
            write!(f, "| {} |", row.view.name)?;
            for level in &row.levels {
                write!(f, " {} / {} |", short(level.worst_px), short(level.mean_px))?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// About three figures, at most three decimals.
fn short(px: f64) -> String {
    let decimals = match px {
        100.0.. => 0,
        10.0.. => 1,
        1.0.. => 2,
        _ => 3,
    };
    format!("{px:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use shiftvox::machine::{Cage, cages_along};

    /// Way down to a cell of the finest lattice.
    fn path(depth: u32, cell: [usize; 3]) -> Vec<u8> {
        (0..depth)
            .rev()
            .map(|bit| {
                cell.iter()
                    .fold(0, |octant, c| octant << 1 | (c >> bit & 1) as u8)
            })
            .collect()
    }

    #[test]
    fn the_lattice_is_the_machines() {
        const DEPTH: u32 = 3;
        for view in standard_views() {
            let setup = set_up(&view.camera, DEPTH).expect("a view");
            let mut compared = 0;
            for exact_levels in 0..=DEPTH {
                let lattice = ScreenVertices::projected(&setup, exact_levels)
                    .expect("a cube before the eye")
                    .halved(DEPTH - exact_levels);
                let mut changing = setup.clone();
                changing.screen_depth[..exact_levels as usize].fill(i64::MAX);
                for cell in lattice_points(7) {
                    let cell = cell.map(|c| c as usize);
                    let way = path(DEPTH, cell);
                    let cages = cages_along(&changing, &way).expect("no overflow");
                    let changed = &cages[exact_levels as usize..];
                    let [Cage::Screen(_), ..] = changed else {
                        panic!("a record that may change: {cages:?}");
                    };
                    let [.., Cage::Screen(corners)] = changed else {
                        panic!("{cages:?}");
                    };
                    for corner in 0..8 {
                        let [x, y, z] = [0, 1, 2].map(|k| cell[k] + (corner >> (2 - k) & 1));
                        let vertex = lattice.vertices[(x * 9 + y) * 9 + z];
                        assert_eq!(
                            [corners[0][corner], corners[1][corner]],
                            vertex,
                            "{}, {exact_levels} exact, {cell:?}, corner {corner}",
                            view.name
                        );
                        compared += 1;
                    }
                }
            }
            assert_eq!(compared, 4 * 512 * 8);
        }
    }

    #[test]
    fn all_levels_exact_leave_rounding_only() {
        let table = vertex_error(&standard_views(), 3, 3).expect("a table");
        for row in &table.rows {
            let unit = libm::ldexp(1.0, -16);
            let last = row.levels[3];
            // Rounded down in two coordinates; and the set-up rounds the
            // view, which is seen most in the narrow one.
            assert!(last.worst_px < 4.0 * unit, "{row:?}");
            assert!(last.mean_px > 0.0);
        }
    }

    #[test]
    fn what_cannot_be_projected_is_refused() {
        let mut view = standard_views().remove(0);
        view.camera.eye = DVec3::new(0.4, 0.5, 0.6);
        assert!(matches!(
            vertex_error(&[view.clone()], 3, 1),
            Err(VertexErrorError::BehindEye(_))
        ));
        view.camera.eye = view.camera.target;
        assert!(vertex_error(&[view.clone()], 3, 1).is_err());
        assert!(matches!(
            vertex_error(&[], MAX_DEPTH + 1, 1),
            Err(VertexErrorError::Levels { .. })
        ));
        assert!(vertex_error(&[], 2, 3).is_err());
    }

    #[test]
    fn the_table_reads_well() {
        let table = VertexErrorTable {
            depth: 5,
            rows: vec![CameraVertexErrors {
                view: standard_views().remove(1),
                levels: vec![LevelError {
                    exact_levels: 0,
                    worst_px: 16.9,
                    mean_px: 0.123_4,
                    percentile_99_9_px: 12.0,
                }],
            }],
        };
        assert_eq!(
            table.to_string(),
            "| camera | 0 exact |\n|---|---|\n| 4 sides away | 16.9 / 0.123 |\n"
        );
    }
}
