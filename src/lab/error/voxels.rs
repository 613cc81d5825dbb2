//! The project's own engines as a method.

use hwmodel::count::Counter;
use hwmodel::cycles::Organisation;
use hwmodel::{Memory, Stage};

use super::cut::cut_at;
use super::method::{DrawingMethod, Refused, Samples, Shown};
use super::vertices::vertex_levels;
use crate::frame::{Colors, Frame, NO_NODE};
use crate::graph::{Graph, GraphView};
use crate::lab::bench::MakeEngine;
use crate::lab::model::record::{record_bits, record_fields};
use crate::machine::Machine;
use crate::picture::{Background, Picture, Shading, lights, resolve};
use crate::project::{CageKind, Camera, Coverage, Engine, FrameSetup, SetupOptions, Stats};

/// How samples become colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PixelStyle {
    /// Shading.
    pub shading: Shading,
    /// What is behind the object; a colour, so that pictures are opaque.
    pub background: [u8; 3],
}

impl Default for PixelStyle {
    fn default() -> Self {
        let background = match Background::default() {
            Background::Color(color) => color,
            Background::None => [0; 3],
        };
        Self {
            shading: Shading::default(),
            background,
        }
    }
}

/// An engine of this project with settings. Times are the engine's; counters
/// are those of the machine, which draws the same bits, so that methods can be
/// compared by what the hardware would do.
pub struct VoxelMethod<'g> {
    graph: &'g Graph,
    options: SetupOptions,
    engine_name: &'static str,
    make: MakeEngine,
    engine: Box<dyn Engine + Send>,
    style: PixelStyle,
    ready: Option<Ready>,
}

/// What is made for a camera.
struct Ready {
    camera: Camera,
    setup: FrameSetup,
    colors: Colors,
    /// Light of the nodes without a lamp, under the rule that blends.
    light: Vec<[u16; 3]>,
}

/// Bytes that an access moves: child mask and list of a node, its colour
/// and normal, a fill vector (four bits, a byte here), a pixel's node.
const NODE_BYTES: u64 = 5;
const ATTRIBUTE_BYTES: u64 = 5;
const FILL_VECTOR_BYTES: u64 = 1;
const PIXEL_BYTES: u64 = 4;
const ACCUMULATOR_BYTES: u64 = (hwmodel::memory::ACCUMULATOR_BITS as u64).div_ceil(8);

impl<'g> VoxelMethod<'g> {
    /// An engine on one thread.
    pub fn new(
        graph: &'g Graph,
        (engine_name, make): (&'static str, MakeEngine),
        options: SetupOptions,
        style: PixelStyle,
    ) -> Self {
        Self {
            graph,
            options,
            engine_name,
            make,
            engine: make(1),
            style,
            ready: None,
        }
    }

    /// The settings that frames are drawn with.
    #[must_use]
    pub fn options(&self) -> &SetupOptions {
        &self.options
    }

    /// `handed`: whether the fast engine left the frame to the machine.
    fn remark(&self, handed: bool) -> Option<String> {
        let o = &self.options;
        let is_paper = (o.cage, o.coverage) == (CageKind::Corners, Coverage::Any)
            && o.tolerance_px.is_infinite();
        match (is_paper, handed) {
            (true, true) => Some("the paper's; drawn by the machine".to_owned()),
            (true, false) => Some("the paper's".to_owned()),
            (false, true) => Some("drawn by the machine".to_owned()),
            (false, false) => None,
        }
    }

    fn counters(&self, setup: &FrameSetup) -> Result<Stats, Refused> {
        let mut frame = Frame::nodes_only(setup.width, setup.height);
        let drawn =
            Machine::default().render_probed(&self.graph.view(), setup, &mut frame, Counter::new());
        let (stats, counter) = drawn.map_err(Refused::because)?;
        let stat = |name: &str| stats.iter().find(|(n, _)| *n == name).map_or(0, |s| s.1);
        let at = |stages: &[Stage]| counter.sum(|cell| stages.contains(&cell.stage));
        let record = u64::from(
            record_bits(&record_fields(
                setup,
                self.graph.len(),
                Organisation::default(),
            ))
            .div_ceil(8),
        );
        let bytes = [
            (Memory::Stack, record),
            (Memory::Node, NODE_BYTES),
            (Memory::Attribute, ATTRIBUTE_BYTES),
            (Memory::FillVector, FILL_VECTOR_BYTES),
            (Memory::Pixel, PIXEL_BYTES),
            (Memory::Accumulator, ACCUMULATOR_BYTES),
        ];
        let touched = bytes
            .iter()
            .map(|&(memory, size)| size * (counter.reads(memory) + counter.writes(memory)));
        Ok(vec![
            ("operations", counter.ops()),
            ("records", stat("records")),
            (
                "vertex_operations",
                at(&[Stage::VertexPool, Stage::ChildBox, Stage::ToScreen]),
            ),
            ("quadtree_operations", at(&[Stage::QuadtreeFit])),
            ("bytes_touched", touched.sum()),
            ("changed_to_screen", stat("changed_to_screen")),
        ])
    }
}

/// A tolerance in words: `1/8`, `0`, `inf`.
#[must_use]
pub fn tolerance_in_words(tolerance_px: f64) -> String {
    if tolerance_px.is_infinite() {
        return "inf".to_owned();
    }
    let inverse = 1.0 / tolerance_px;
    if tolerance_px < 1.0 && inverse.is_finite() && inverse == libm::round(inverse) {
        return format!("1/{inverse}");
    }
    tolerance_px.to_string()
}

impl DrawingMethod for VoxelMethod<'_> {
    fn family(&self) -> &'static str {
        "voxels"
    }

    fn name(&self) -> String {
        let o = &self.options;
        let mut name = o.coverage.name().to_owned();
        if !o.coverage.draws_outlines() {
            name += &format!(" {}", tolerance_in_words(o.tolerance_px));
        }
        name += &format!(" {}", o.cage.name());
        if o.bits != 64 || o.frac.is_some() {
            name += &format!(" {} bits", o.bits);
        }
        if let Some(frac) = o.frac {
            name += &format!(" .{frac}");
        }
        if o.lod_px != o.coverage.default_lod() {
            name += &format!(" lod {}", o.lod_px);
        }
        if o.aa_log2 > 0 {
            name += &format!(" aa {}", 1 << o.aa_log2);
        }
        if self.engine_name != "fast" {
            name += &format!(", {}", self.engine_name);
        }
        name
    }

    fn settings(&self) -> Vec<(&'static str, String)> {
        let o = &self.options;
        vec![
            ("coverage", o.coverage.name().to_owned()),
            ("tolerance", tolerance_in_words(o.tolerance_px)),
            ("cage", o.cage.name().to_owned()),
            ("bits", o.bits.to_string()),
            ("lod", o.lod_px.to_string()),
            ("aa", (1 << o.aa_log2).to_string()),
            ("engine", self.engine_name.to_owned()),
        ]
    }

    fn kind(&self) -> String {
        let aa = match self.options.aa_log2 {
            0 => String::new(),
            aa => format!(", aa {}", 1 << aa),
        };
        format!("{}{aa}", self.options.coverage.name())
    }

    fn begin(&mut self, camera: &Camera) -> Result<(), Refused> {
        let graph = self.graph;
        let setup = FrameSetup::new(camera, &graph.placement, graph.depth, &self.options);
        let setup = setup.map_err(Refused::because)?;
        let mut colors = Colors::new(setup.width, setup.height);
        // Pages are there before the first frame.
        colors.words.fill(1);
        self.ready = Some(Ready {
            camera: *camera,
            light: lights(graph, &setup, Shading::Flat),
            setup,
            colors,
        });
        Ok(())
    }

    fn draw(&mut self) -> Result<(), Refused> {
        let Some(Ready {
            setup,
            colors,
            light,
            ..
        }) = &mut self.ready
        else {
            return Err(Refused::because("no camera yet"));
        };
        let graph = self.graph;
        let view = GraphView {
            light,
            ..graph.view()
        };
        self.engine
            .draw_colors(&view, &graph.color, setup, colors)
            .map_err(Refused::because)
    }

    fn show(&mut self) -> Result<Shown, Refused> {
        let Some(Ready { setup, camera, .. }) = &self.ready else {
            return Err(Refused::because("no camera yet"));
        };
        let mut frame = Frame::new(setup.width, setup.height, false);
        let light = lights(self.graph, setup, self.style.shading);
        let view = GraphView {
            light: &light,
            ..self.graph.view()
        };
        let drawn = self.engine.render(&view, setup, &mut frame);
        let stats = drawn.map_err(Refused::because)?;
        let handed = stats.iter().any(|(name, _)| *name == "handed_to_machine");
        let background = Background::Color(self.style.background);
        let picture = resolve(&frame, self.graph, setup, self.style.shading, background)
            .map_err(Refused::because)?;
        let aa_log2 = setup.options.aa_log2;
        Ok(Shown {
            shares: shares(&frame, aa_log2),
            vertices: vertex_levels(camera, setup, &frame.voxel),
            counters: self.counters(setup)?,
            picture,
            samples: Some(Samples {
                aa_log2,
                voxel: frame.voxel,
            }),
            remark: self.remark(handed),
        })
    }

    fn picture(&mut self) -> Result<Picture, Refused> {
        let Some(Ready { setup, .. }) = &self.ready else {
            return Err(Refused::because("no camera yet"));
        };
        let mut frame = Frame::new(setup.width, setup.height, false);
        let light = lights(self.graph, setup, self.style.shading);
        let view = GraphView {
            light: &light,
            ..self.graph.view()
        };
        self.engine
            .draw(&view, setup, &mut frame)
            .map_err(Refused::because)?;
        let background = Background::Color(self.style.background);
        resolve(&frame, self.graph, setup, self.style.shading, background).map_err(Refused::because)
    }

    fn picture_with_cut_of(&mut self, other: &Camera) -> Result<Option<Picture>, Refused> {
        let Some(Ready { camera, .. }) = &self.ready else {
            return Err(Refused::because("no camera yet"));
        };
        if self.options.lod_px == 0.0 {
            return Ok(None);
        }
        let (placement, depth) = (&self.graph.placement, self.graph.depth);
        let setup_of = |camera: &Camera, options: &SetupOptions| {
            FrameSetup::new(camera, placement, depth, options).map_err(Refused::because)
        };
        let cut = cut_at(self.graph, &setup_of(other, &self.options)?);
        // Solids are exactly the nodes that the cut stops at.
        let options = SetupOptions {
            lod_px: 0.0,
            ..self.options
        };
        let mut on_cut = VoxelMethod::new(&cut, (self.engine_name, self.make), options, self.style);
        on_cut.begin(camera)?;
        on_cut.picture().map(Some)
    }

    fn end(&mut self) {
        self.ready = None;
        self.engine = (self.make)(1);
    }
}

/// The share of each pixel's samples that see something.
fn shares(frame: &Frame, aa_log2: u32) -> Vec<f32> {
    let (side, across) = (1usize << aa_log2, frame.width as usize);
    let (width, height) = (across >> aa_log2, frame.height as usize >> aa_log2);
    let pixel = |x: usize, y: usize| {
        let rows = (0..side).map(|j| (y * side + j) * across + x * side);
        let samples = (side * side) as f32;
        if let Some(blend) = &frame.blend {
            let taken = rows.flat_map(|at| &blend[at..at + side]);
            return taken.map(|b| 1.0 - f32::from(b.left) / 256.0).sum::<f32>() / samples;
        }
        let seen = rows.flat_map(|at| &frame.node[at..at + side]);
        seen.filter(|&&node| node != NO_NODE).count() as f32 / samples
    };
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| pixel(x, y))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_in_words() {
        let words = [0.0, 0.125, 1.0 / 64.0, 0.3, 2.0, f64::INFINITY].map(tolerance_in_words);
        assert_eq!(words, ["0", "1/8", "1/64", "0.3", "2", "inf"]);
    }

    #[test]
    fn shares_of_samples() {
        let mut frame = Frame::nodes_only(4, 2);
        for at in [0, 2, 3, 6, 7] {
            frame.node[at] = 0;
        }
        assert_eq!(shares(&frame, 1), [0.25, 1.0]);
        assert_eq!(shares(&frame, 0)[..4], [1.0, 0.0, 1.0, 1.0]);
    }
}
