//! Files of each format, edited and repaired, and every use of such a file. The fuzz target has it too.

use std::hint::black_box;
use std::path::Path;
use std::sync::OnceLock;

use shiftvox::drawing::{Drawable, GraphDrawing, GraphStyle};
use shiftvox::fast::{Fast, FastOptions};
use shiftvox::graph::{Graph, LinkedGraph, Silent, vxg};
use shiftvox::machine::Machine;
use shiftvox::picture::{Background, Shading, hash_rows};
use shiftvox::project::{Direction, Engine, Lens, SetupOptions, fit_camera};
use shiftvox_mesh::drawing::{FarStyle, TexturedStyle, of_far, of_textured};
use shiftvox_mesh::far::{self, FarFile, view::Opacity};
use shiftvox_mesh::open::{OpenOptions, open_bytes};
use shiftvox_mesh::textured::{self, Element, TexturedFile, view::Erosion};
use shiftvox_mesh::{ColorSpace, MeshFormat, no_files, read};

use super::seal;

const OBJ: &str = "v 0 0 0\nv 4 0 1\nv 4 4 2\nv 0 4 1\nv 1 1 5\nv 1.2 1 5\nv 3 3 9\nv 0 0 3\n\
                   v 4 0 3\nv 4 4 3\nv 0 4 3\nf 1 2 3 4\nf 5 6 7\nf 8 9 10 11\n";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Vxg,
    Far,
    Tvx,
}

/// Small files of every kind, and how many of their bytes are header and tables.
pub(crate) fn sound_files() -> Vec<(Format, Vec<u8>, usize)> {
    let mut files = Vec::new();
    for graph in graphs() {
        let mut bytes = Vec::new();
        vxg::write_to(&graph, &mut bytes).unwrap();
        files.push((Format::Vxg, bytes, 512));
    }
    let (text, colors) = (OBJ.as_bytes(), ColorSpace::default());
    let mesh = read(text, MeshFormat::Obj, "a", &no_files, colors, &Silent).unwrap();
    for (leaf_triangles, opacity, hybrid) in [
        (1000, Opacity::Six, false),
        (3, Opacity::Six, false),
        (2, Opacity::None, false),
        (3, Opacity::Six, true),
    ] {
        let options = far::BuildOptions {
            rays: Some(500),
            grid: 4,
            leaf_triangles,
            opacity,
            hybrid,
            ..far::BuildOptions::default()
        };
        let data = far::build(&mesh, &options, &Silent).unwrap();
        let fields = 128 + far::record::NODE_BYTES * data.nodes.len();
        files.push((Format::Far, far::store::encode(&data).unwrap(), fields));
    }
    for (grids, element) in [(vec![2], Element::Sides), (vec![2, 4], Element::Cube)] {
        let fields = 128 + 80 * grids.len();
        let options = textured::BuildOptions {
            grids,
            texels: 2,
            element,
        };
        let data = textured::build(&mesh, &options, &Silent).unwrap();
        files.push((Format::Tvx, textured::store::encode(&data).unwrap(), fields));
    }
    files
}

fn graphs() -> [Graph; 3] {
    let [tree, with_opacities] = [false, true].map(|opacities| {
        let mut options = OpenOptions::default();
        options.mesh.depth = 3;
        options.mesh.opacities = opacities;
        let opened = open_bytes(OBJ.as_bytes(), "a.obj", &options, &Silent);
        opened.unwrap().graph
    });
    let mut cyclic = LinkedGraph::new(7);
    let (one, two) = (Some(0), Some(1));
    cyclic.add_node([1, 2, 3], [one, None, None, two, None, one, two, None]);
    cyclic.add_node([9, 9, 9], [None; 8]);
    [tree, with_opacities, cyclic.build().unwrap()]
}

/// Values that fields of numbers rarely expect, as `f64` and as `f32`.
const ODD: [f64; 6] = [f64::NAN, f64::INFINITY, 1e308, -1e30, 1e-38, -1.0];

/// Does one edit, of 64 random bits. Three of four are among the first `fields` bytes.
fn edit(bytes: &mut [u8], fields: usize, choice: u64) {
    let taken = |from: u32, bits: u32| choice >> from & ((1 << bits) - 1);
    let width = 1usize << taken(0, 2);
    let range = match taken(2, 2) {
        0 => bytes.len(),
        _ => fields.min(bytes.len()),
    };
    let place = |number: u64| number as usize % (range / width).max(1) * width;
    let field = |at: usize| {
        let mut field = [0; 8];
        field[..width].copy_from_slice(bytes.get(at..at + width)?);
        Some(u64::from_le_bytes(field))
    };
    let at = place(taken(8, 24));
    let Some(old) = field(at) else { return };
    let value = taken(32, 32);
    let odd = ODD[value as usize % ODD.len()];
    let new = match taken(4, 4) {
        0 => 0,
        1 => u64::MAX,
        2..4 => old.wrapping_add(1),
        4..6 => old.wrapping_sub(1),
        6 => old << 1,
        7..10 => old ^ 1 << (value % (8 * width as u64)),
        10 => value,
        11 => u64::from(value as u8),
        12 => field(place(value)).unwrap_or(old),
        _ if width == 8 => odd.to_bits(),
        _ => u64::from((odd as f32).to_bits()),
    };
    bytes[at..at + width].copy_from_slice(&new.to_le_bytes()[..width]);
}

/// A sound file of some formats after edits, repaired. The first choice is the file, and whether places within it are
/// repaired too.
pub(crate) fn edited(
    formats: &[Format],
    mut choices: impl Iterator<Item = u64>,
) -> Option<(Format, Vec<u8>)> {
    static FILES: OnceLock<Vec<(Format, Vec<u8>, usize)>> = OnceLock::new();
    let first = choices.next()?;
    let files = FILES.get_or_init(sound_files).iter();
    let files: Vec<_> = files.filter(|file| formats.contains(&file.0)).collect();
    let (format, bytes, fields) = files[first as usize % files.len()];
    let mut bytes = bytes.clone();
    choices.for_each(|choice| edit(&mut bytes, *fields, choice));
    let seal = match format {
        Format::Vxg => seal::vxg,
        Format::Far => seal::far,
        Format::Tvx => seal::tvx,
    };
    Some((*format, seal(bytes, first >> 32 & 3 != 0)?))
}

pub(crate) fn is_sound(format: Format, bytes: &[u8]) -> bool {
    match format {
        Format::Vxg => vxg::from_bytes(bytes).is_ok(),
        Format::Far => FarFile::from_bytes(bytes).is_ok_and(|file| file.verify().is_ok()),
        Format::Tvx => TexturedFile::from_bytes(bytes).is_ok_and(|file| file.verify().is_ok()),
    }
}

/// Reads, verifies and draws a file as the program does. Returns whether it is sound. Graphs are mapped from `path`.
pub(crate) fn exercise(format: Format, bytes: &[u8], path: &Path) -> bool {
    let (shading, background) = (Shading::Lambert, Background::default());
    match format {
        Format::Vxg => {
            let read = vxg::from_bytes(bytes);
            // Large files are mapped and drawn without verification.
            std::fs::write(path, bytes).unwrap();
            let opened = vxg::open(path);
            assert_eq!(vxg::verify(path).is_ok(), read.is_ok());
            assert!(opened.is_ok() || read.is_err());
            if let Ok(graph) = &opened {
                let style = GraphStyle {
                    options: SetupOptions::default(),
                    shading,
                    background,
                    buffers: Vec::new(),
                    is_hashed: true,
                };
                let machine = || Box::new(Machine::default());
                let engine = || -> Box<dyn Engine + Send> {
                    Box::new(Fast::new(FastOptions::default(), machine()))
                };
                let up = shiftvox::Up::Z;
                draw(&mut GraphDrawing::new(graph, up, style, engine));
            }
        }
        Format::Far => {
            let Ok(file) = FarFile::from_bytes(bytes) else {
                return false;
            };
            let style = FarStyle {
                voxel_px: 1.0,
                aa_log2: 0,
                opacity: Opacity::Six,
                shading,
                background,
            };
            draw(&mut of_far(&file, style));
        }
        Format::Tvx => {
            let Ok(file) = TexturedFile::from_bytes(bytes) else {
                return false;
            };
            let style = TexturedStyle {
                erosion: Erosion::Auto { texel_px: 1.0 },
                aa_log2: 0,
                shading,
                background,
            };
            draw(&mut of_textured(&file, style));
        }
    }
    is_sound(format, bytes)
}

/// Draws a small picture from near and far. An open file can be drawn.
fn draw(drawable: &mut dyn Drawable) {
    let (bounds, up) = (drawable.bounds(), drawable.up());
    for zoom in [0.05, 1.0, 20.0] {
        let camera = fit_camera(
            &bounds,
            up,
            Direction::CORNER,
            Lens::Degrees(40.0),
            zoom,
            (12, 12),
        );
        assert!(camera.axes().is_ok(), "{camera:?}");
        if drawable.draw(&camera, 1).is_ok() {
            let shown = drawable.shown().ok().flatten();
            black_box(shown.map(|shown| hash_rows(&shown.buffers).is_ok()));
        }
    }
}
