//! Files of each format, edited and put right, and all that is done with such a file.

use std::hint::black_box;
use std::path::Path;
use std::sync::OnceLock;

use shiftvox::drawing::{Drawable, GraphDrawing, GraphStyle};
use shiftvox::fast::{Fast, FastOptions};
use shiftvox::graph::{Graph, LinkedGraph, MergeBy, Silent, merge, vxg};
use shiftvox::machine::Machine;
use shiftvox::picture::{Background, Shading, hash_rows};
use shiftvox::project::{Direction, SetupOptions, fit_camera};
use shiftvox_mesh::drawing::{Erosion, FarDrawing, FarStyle, TexturedDrawing, TexturedStyle};
use shiftvox_mesh::far::{self, FarFile, view::Opacity};
use shiftvox_mesh::open::{MeshOptions, OpenOptions, open_bytes};
use shiftvox_mesh::textured::{self, Element, TexturedFile};
use shiftvox_mesh::{LoadOptions, MeshFormat, Nothing, read};

use super::{edit, seal};

/// Two squares and a thin spike.
const OBJ: &str = "v 0 0 0\nv 4 0 1\nv 4 4 2\nv 0 4 1\nv 1 1 5\nv 1.2 1 5\nv 3 3 9\nv 0 0 3\n\
                   v 4 0 3\nv 4 4 3\nv 0 4 3\nf 1 2 3 4\nf 5 6 7\nf 8 9 10 11\n";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Vxg,
    Far,
    Tvx,
}

/// A sound file, and how many of its bytes are header and tables.
struct Sound {
    format: Format,
    bytes: Vec<u8>,
    fields: usize,
}

/// Small files of every kind that there is, made by the program.
fn sound_files() -> &'static [Sound] {
    static FILES: OnceLock<Vec<Sound>> = OnceLock::new();
    FILES.get_or_init(|| {
        let mut files = Vec::new();
        for graph in graphs() {
            let mut bytes = Vec::new();
            vxg::write_to(&graph, &mut bytes).unwrap();
            files.push(Sound {
                format: Format::Vxg,
                bytes,
                fields: 512,
            });
        }
        let load = LoadOptions::default();
        let mesh = read(
            OBJ.as_bytes(),
            MeshFormat::Obj,
            "a",
            &Nothing,
            &load,
            &Silent,
        )
        .unwrap();
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
            let bytes = far::store::encode(&data).unwrap();
            let fields = 128 + far::record::NODE_BYTES * data.nodes.len();
            files.push(Sound {
                format: Format::Far,
                bytes,
                fields,
            });
        }
        for (grids, element) in [(vec![2], Element::Sides), (vec![2, 4], Element::Cube)] {
            let fields = 128 + 80 * grids.len();
            let options = textured::BuildOptions {
                grids,
                texels: 2,
                element,
            };
            let data = textured::build(&mesh, &options, &Silent).unwrap();
            let bytes = textured::store::encode(&data).unwrap();
            files.push(Sound {
                format: Format::Tvx,
                bytes,
                fields,
            });
        }
        files
    })
}

/// A tree, the same with opacities, with equal subtrees merged, and a cyclic graph.
fn graphs() -> Vec<Graph> {
    let of_mesh = |opacities| {
        let options = OpenOptions {
            mesh: MeshOptions {
                depth: 3,
                opacities,
                ..MeshOptions::default()
            },
            ..OpenOptions::default()
        };
        open_bytes(OBJ.as_bytes(), "a.obj", &options, &Silent)
            .unwrap()
            .graph
    };
    let tree = of_mesh(false);
    let (dag, _) = merge(&tree, MergeBy::Shape, &Silent);
    let mut cyclic = LinkedGraph::new(7);
    let (one, two) = (Some(0), Some(1));
    cyclic.add_node([1, 2, 3], [one, None, None, two, None, one, two, None]);
    cyclic.add_node([9, 9, 9], [None; 8]);
    vec![tree, of_mesh(true), dag, cyclic.build().unwrap()]
}

/// A sound file after edits, with lengths and checksums put right: the first choice is that of the file, and whether
/// places within it are put right too. None where a length is beyond reason.
pub(crate) fn edited(mut choices: impl Iterator<Item = u64>) -> Option<(Format, Vec<u8>)> {
    let first = choices.next()?;
    let files = sound_files();
    let sound = &files[first as usize % files.len()];
    let mut bytes = sound.bytes.clone();
    for choice in choices {
        edit::edit(&mut bytes, sound.fields, choice);
    }
    let place = first >> 32 & 3 != 0;
    let sealed = match sound.format {
        Format::Vxg => seal::vxg(bytes, place),
        Format::Far => seal::far(bytes, place),
        Format::Tvx => seal::tvx(bytes, place),
    };
    Some((sound.format, sealed?))
}

/// Does with a file what the program does. Gives whether it was found sound; `path` is that of a file to map.
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
            if let Ok(graph) = &read {
                let mut again = Vec::new();
                vxg::write_to(graph, &mut again).unwrap();
                // All but reserved parts of the header.
                assert!(again[512..] == bytes[512..]);
                assert_eq!(vxg::from_bytes(&again).unwrap().placement, graph.placement);
                assert!(merge(graph, MergeBy::Shape, &Silent).0.validate().is_ok());
            }
            if let Ok(graph) = &opened {
                draw_graph(graph, shading, background);
            }
            read.is_ok()
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
            draw(&mut FarDrawing::new(&file, style));
            file.verify().is_ok()
        }
        Format::Tvx => {
            let Ok(file) = TexturedFile::from_bytes(bytes) else {
                return false;
            };
            for erosion in [
                Erosion::Auto { texel_px: 1.0 },
                Erosion::Level {
                    level: 1,
                    cells: None,
                },
            ] {
                let style = TexturedStyle {
                    erosion,
                    aa_log2: 0,
                    shading,
                    background,
                };
                draw(&mut TexturedDrawing::new(&file, style));
            }
            file.verify().is_ok()
        }
    }
}

fn draw_graph(graph: &Graph, shading: Shading, background: Background) {
    let style = GraphStyle {
        options: SetupOptions::default(),
        shading,
        background,
        buffers: Vec::new(),
        is_hashed: true,
    };
    let up = shiftvox::Up::Z;
    let engine = || -> Box<dyn shiftvox::project::Engine + Send> {
        Box::new(Fast::new(
            FastOptions::default(),
            Box::new(Machine::default()),
        ))
    };
    draw(&mut GraphDrawing::new(graph, up, style, engine));
}

/// Draws a small picture from near and far. A file that opens can be drawn.
fn draw(drawable: &mut dyn Drawable) {
    let (bounds, up) = (drawable.bounds(), drawable.up());
    for zoom in [0.05, 1.0, 20.0] {
        let camera = fit_camera(&bounds, up, Direction::CORNER, 40.0, zoom, (12, 12));
        assert!(camera.axes().is_ok(), "{camera:?}");
        if drawable.draw(&camera, 1).is_ok() {
            let shown = drawable.shown().ok().flatten();
            black_box(shown.map(|shown| hash_rows(&shown.buffers).is_ok()));
        }
    }
}
