//! Far voxels.

use serde_json::{Value, json};

use super::mesh_view::light_of;
use super::{Drawn, Method, MethodDrawing, MethodError};
use crate::far::FarFile;
use crate::far::view::{self, FarCounts, Opacity, ViewOptions};
use crate::raster::RasterCamera;
use shiftvox::drawing::Figures;
use shiftvox::graph::MeshBox;
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

/// A file of far voxels, and how it is drawn.
#[derive(Clone)]
pub struct FarMethod<'f> {
    file: &'f FarFile,
    style: FarStyle,
}

pub type FarDrawing<'f> = MethodDrawing<FarMethod<'f>>;

impl<'f> FarDrawing<'f> {
    pub fn new(file: &'f FarFile, style: FarStyle) -> Self {
        Self::of(FarMethod { file, style })
    }
}

impl Method for FarMethod<'_> {
    fn mesh_box(&self) -> MeshBox {
        self.file.mesh_box()
    }

    fn aa_log2(&self) -> u32 {
        self.style.aa_log2
    }

    fn draw(&mut self, view: &RasterCamera) -> Result<Drawn, MethodError> {
        let options = self.style.options(view);
        let (drawn, counts) = view::draw(self.file, view, &options)?;
        let (size, nodes) = ((drawn.width, drawn.height), drawn.node);
        let (coverage, counters) = (drawn.coverage, counters(&counts));
        Ok(Drawn::new(
            size,
            drawn.rgba,
            drawn.depth,
            nodes,
            coverage,
            counters,
        ))
    }

    fn details(&self) -> Figures {
        vec![
            ("engine", json!("far")),
            ("memory", json!(resident(self.file))),
        ]
    }
}

/// The use of a memory budget; `None` without one.
pub fn resident(file: &FarFile) -> Option<Value> {
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
