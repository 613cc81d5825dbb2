//! Far voxels.

use serde_json::{Value, json};

use super::mesh_view::light_of;
use super::{Drawn, MeshDrawing};
use crate::far::FarFile;
use crate::far::view::{self, FarCounts, Opacity, ViewOptions};
use crate::raster::RasterCamera;
use shiftvox::drawing::Figures;
use shiftvox::picture::{Background, Shading};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FarStyle {
    /// Largest voxel, pixels; above 0.
    pub voxel_px: f64,
    /// Samples per pixel and axis, as a power of two.
    pub aa_log2: u32,
    pub opacity: Opacity,
    pub shading: Shading,
    pub background: Background,
}

impl FarStyle {
    pub fn options(&self, view: &RasterCamera) -> ViewOptions {
        ViewOptions {
            voxel_px: self.voxel_px,
            samples_across: 1 << self.aa_log2,
            opacity: self.opacity,
            light: light_of(view, self.shading),
            background: self.background.color(),
        }
    }
}

pub fn of_far(file: &FarFile, style: FarStyle) -> MeshDrawing<'_> {
    let draw = move |view: &RasterCamera| {
        let (drawn, counts) = view::draw(file, view, &style.options(view))?;
        let details = vec![("engine", json!("far")), ("memory", json!(resident(file)))];
        // A node's number; where none is seen all bits are set.
        Ok(Drawn::new(
            drawn,
            |node| node as i32,
            counters(&counts),
            details,
        ))
    };
    MeshDrawing::new(file.mesh_box(), style.aa_log2, Box::new(draw))
}

/// The use of a memory budget; `None` without one.
fn resident(file: &FarFile) -> Option<Value> {
    let resident = file.resident()?;
    Some(json!({
        "bytes": resident.bytes,
        "most_bytes": resident.most_bytes,
        "nodes_released": resident.released,
    }))
}

fn counters(counts: &FarCounts) -> Figures {
    let counters = [
        ("nodes_visited", counts.visited),
        ("nodes_outside", counts.outside),
        ("voxel_nodes", counts.voxel_nodes),
        ("leaves", counts.leaves),
        ("opaque_voxels", counts.opaque_voxels),
        ("transparent_voxels", counts.transparent_voxels),
        ("triangles", counts.triangles),
        ("bytes", counts.bytes),
    ];
    counters.map(|(name, count)| (name, count.into())).to_vec()
}
