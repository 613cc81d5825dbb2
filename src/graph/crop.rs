//! The part of a scene within a box, to look inside.

use std::ops::Range;
use std::str::FromStr;

use super::{BuildError, Builder, Graph, Progress};

/// A box of voxels: ranges of file indices along x, y and z.
///
/// As text `0..20,..,-5..`. An end is not included. A missing number means the end of the scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crop(pub [Range<i64>; 3]);

impl FromStr for Crop {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let range = |text: &str| {
            let ends = text.trim().split_once("..");
            let end = |text: &str, all: i64| match text {
                "" => Some(all),
                text => text.parse().ok(),
            };
            let range = ends.and_then(|(from, to)| Some(end(from, i64::MIN)?..end(to, i64::MAX)?));
            let range = range.ok_or_else(|| {
                format!("`{text}` is no range of voxel indices, such as 3..9, ..20 or ..")
            })?;
            match range.is_empty() {
                true => Err(format!("`{text}` is empty: the end is not included")),
                false => Ok(range),
            }
        };
        let ranges = text.split(',').map(range).collect::<Result<Vec<_>, _>>()?;
        let three = <[Range<i64>; 3]>::try_from(ranges);
        three.map(Self).map_err(|ranges| {
            format!(
                "{} ranges, and three are needed: along x, y and z, such as ..20,..,3..9",
                ranges.len()
            )
        })
    }
}

impl Graph {
    /// The voxels within a box, in the same place, without opacities. Faces that the box lays open get normals of their
    /// own.
    ///
    /// # Errors
    /// [`BuildError`], also if no voxel is left, and as [`Graph::finest_voxels`].
    pub fn cropped(&self, crop: &Crop, progress: &dyn Progress) -> Result<Self, BuildError> {
        let mut builder = Builder::default();
        let is_inside = |index: [i32; 3]| {
            let mut axes = crop.0.iter().zip(index);
            axes.all(|(range, at)| range.contains(&i64::from(at)))
        };
        for voxel in self.finest_voxels()?.filter(|voxel| is_inside(voxel.index)) {
            builder.push(voxel);
        }
        let place = &self.placement;
        let mut graph = builder.finish((place.world_origin, place.voxel_size), progress)?;
        graph.placement.mesh = place.mesh;
        Ok(graph)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Silent, Voxel};

    #[test]
    fn a_box_keeps_its_voxels_in_place() {
        let mut builder = Builder::default();
        let indices: Vec<[i32; 3]> = (0..300)
            .map(|i| [i * 7 % 11 - 4, i * 5 % 13, i * 3 % 17 + 90])
            .collect();
        for &index in &indices {
            let color = index.map(|c| c as u8);
            builder.push(Voxel {
                index,
                color,
                normal: None,
            });
        }
        let graph = builder.finish(([1.0, 2.0, 3.0], 0.5), &Silent).unwrap();
        let crop: Crop = "..3,2..9,95..".parse().unwrap();
        let part = graph.cropped(&crop, &Silent).unwrap();
        let mut found: Vec<_> = part
            .finest_voxels()
            .unwrap()
            .map(|v| (v.index, v.color))
            .collect();
        let all = graph.finest_voxels().unwrap().map(|v| (v.index, v.color));
        let mut expected: Vec<_> = all
            .filter(|([x, y, z], _)| *x < 3 && (2..9).contains(y) && *z >= 95)
            .collect();
        found.sort_unstable();
        expected.sort_unstable();
        assert!(!expected.is_empty() && expected.len() < indices.len());
        assert_eq!(found, expected);
        assert_eq!(part.placement.world_origin, [1.0, 2.0, 3.0]);
        let nothing: Crop = "50..,..,..".parse().unwrap();
        assert!(graph.cropped(&nothing, &Silent).is_err());
        for wrong in [
            "",
            "1..2",
            "..,..",
            "5..5,..,..",
            "..,..,..,..",
            "a..,..,..",
        ] {
            assert!(wrong.parse::<Crop>().is_err(), "{wrong}");
        }
    }
}
