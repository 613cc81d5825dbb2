//! MagicaVoxel's and VoxelShop's `.vox`.
//!
//! The files, in import order:
//!
//! | file | contents |
//! |---|---|
//! | `chunk` | chunks and their fields, with every size checked before it is used |
//! | `model` | voxels, and the rule for those outside `SIZE` |
//! | `palette` | the colours of colour indices |
//! | `transform` | rotations in a byte, and the index of a transformed voxel |
//! | `nodes` | the scene graph as the file stores it |
//! | `walk` | all placements of models, from the root down |
//! | `placements` | the different ones of these |
//! | `quantize`, `write` | the palette of a file to write, and its chunks |

mod chunk;
mod model;
mod nodes;
mod palette;
mod placements;
mod quantize;
mod transform;
mod walk;
mod write;

pub use write::{VoxWriter, VoxWritten};

use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem};
use crate::scene::input::Input;
use crate::scene::{OutOfBounds, ReadOptions, SceneInfo};
use chunk::Chunk;
use model::Model;
use nodes::SceneGraph;
use palette::Palette;
use placements::Placement;
use transform::Transform;

/// The contents of the file's chunks.
struct Contents<'a> {
    models: Vec<Model<'a>>,
    graph: SceneGraph,
    palette: Palette,
}

/// Passes on the voxels of a `.vox` file.
pub(super) fn read(
    input: &mut Input<'_>,
    options: &ReadOptions,
    emitter: &mut Emitter<'_>,
) -> Result<SceneInfo, Problem> {
    let mut info = SceneInfo::default();
    let bytes = input.bytes().map_err(Problem::Read)?;
    let contents = read_contents(&bytes, options, &mut info)?;
    survey(&contents, options, &mut info)?;
    if contents.graph.is_empty() {
        place_bare_models(&contents, options, emitter, &mut info)?;
    } else {
        let placements = placements::find(&contents, options, &mut info)?;
        let voxels = placements
            .iter()
            .map(|placed| placed.model.voxels.len() as u64);
        // Places are fewer than 2^20, and a model has fewer voxels than 2^30.
        emitter.expect(voxels.sum())?;
        for Placement { model, transform } in placements {
            place(model, Some(&transform), &contents.palette, options, emitter)?;
        }
    }
    if info.hidden_instances > 0 {
        info.warnings.push(format!(
            "{} hidden models were left out",
            info.hidden_instances
        ));
    }
    Ok(info)
}

/// Reads all chunks of voxels, placements and colours.
fn read_contents<'a>(
    bytes: &'a [u8],
    options: &ReadOptions,
    info: &mut SceneInfo,
) -> Result<Contents<'a>, Problem> {
    let mut contents = Contents {
        models: Vec::new(),
        graph: SceneGraph::default(),
        palette: Palette::default_colors(),
    };
    let mut size: Option<(Chunk<'_>, [u32; 3])> = None;
    let chunks = chunk::chunks(bytes)?;
    let left_over = chunks.left_over();
    if left_over > 0 {
        info.warnings.push(format!(
            "{left_over} bytes after the end of the file's main chunk were not read"
        ));
    }
    for chunk in chunks {
        let chunk = chunk?;
        match &chunk.id {
            b"SIZE" => {
                if let Some((first, _)) = size {
                    return Err(lonely_size(&first).into());
                }
                size = Some((chunk, model::read_size(&chunk)?));
            }
            b"XYZI" => {
                let Some((_, size)) = size.take() else {
                    return Err(Fault::new(
                        "chunk XYZI",
                        chunk.offset as u64,
                        "a chunk SIZE before each XYZI",
                        "an XYZI without one",
                        "the file's exporter is at fault; open it in MagicaVoxel and save it again",
                    )
                    .into());
                };
                contents.models.push(model::read_voxels(&chunk, size)?);
            }
            b"RGBA" => {
                contents.palette = Palette::read(&chunk)?;
                contents.palette.entries().clone_into(&mut info.palette);
            }
            b"IMAP" => palette::check_index_map(&chunk)?,
            b"nTRN" | b"nGRP" | b"nSHP" => contents.graph.add_node(&chunk, options.frame)?,
            b"LAYR" => contents.graph.add_layer(&chunk)?,
            // Materials, cameras, notes, render settings, and chunks of later versions.
            _ => {}
        }
    }
    if let Some((chunk, _)) = size {
        return Err(lonely_size(&chunk).into());
    }
    if contents.models.is_empty() {
        return Err(Fault::new(
            "chunk MAIN",
            8,
            "at least one model (chunks SIZE and XYZI)",
            "none",
            "save the scene again with something in it",
        )
        .into());
    }
    Ok(contents)
}

fn lonely_size(chunk: &Chunk<'_>) -> Box<Fault> {
    Fault::new(
        "chunk SIZE",
        chunk.offset as u64,
        "a chunk XYZI after each SIZE",
        "a SIZE without one",
        "the file is cut short or its exporter is at fault; export it again",
    )
}

/// Counts the voxels of all models, each model once, and rejects those that the options reject.
fn survey(
    contents: &Contents<'_>,
    options: &ReadOptions,
    info: &mut SceneInfo,
) -> Result<(), Box<Fault>> {
    info.models = u32::try_from(contents.models.len()).unwrap_or(u32::MAX);
    info.nodes = u32::try_from(contents.graph.len()).unwrap_or(u32::MAX);
    info.has_colors = true;
    let mut empty = 0u64;
    let mut without_color = false;
    let given = contents.palette.given;
    for (number, model) in contents.models.iter().enumerate() {
        info.stored_voxels += model.voxels.len() as u64;
        for (i, [x, y, z, color]) in model.voxels.iter().enumerate() {
            empty += u64::from(*color == 0);
            without_color |= given > 0 && usize::from(*color) > given;
            if model::is_inside([*x, *y, *z], model.size) {
                continue;
            }
            info.outside_size += 1;
            if options.oob == OutOfBounds::Error {
                return Err(Fault::new(
                    format!("model {number}, voxel {i}"),
                    model.offset + 4 * i as u64,
                    format!("a position inside SIZE {:?}", model.size),
                    format!("{:?}", [x, y, z]),
                    "choose what to do with such voxels: wrap, keep or drop them",
                ));
            }
        }
    }
    if empty > 0 {
        info.warnings.push(format!(
            "{empty} voxels have colour index 0, which means empty, and were left out"
        ));
    }
    if without_color {
        info.warnings.push(format!(
            "some voxels use colours beyond the palette's {given} entries; MagicaVoxel's default colours were used for them"
        ));
    }
    if info.outside_size > 0 {
        let what = match options.oob {
            OutOfBounds::Wrap => "were taken modulo 256, nearest to the middle of SIZE",
            OutOfBounds::Keep => "were kept as they stand",
            OutOfBounds::Drop | OutOfBounds::Error => "were left out",
        };
        info.warnings.push(format!(
            "{} voxels lie outside their model's SIZE and {what}",
            info.outside_size
        ));
    }
    Ok(())
}

/// Places the models of a file without scene graph: each at its own coordinates.
fn place_bare_models(
    contents: &Contents<'_>,
    options: &ReadOptions,
    emitter: &mut Emitter<'_>,
    info: &mut SceneInfo,
) -> Result<(), Problem> {
    let models = &contents.models;
    if models.len() > 1 && options.model.is_none() {
        info.warnings.push(format!(
            "the file has {} models and no scene graph; all were read into the same space, as nothing says where they go",
            models.len()
        ));
    }
    let chosen = match options.model {
        None => &models[..],
        Some(number) => {
            let number = number as usize;
            models.get(number..=number).ok_or_else(|| {
                Fault::new(
                    "chunk MAIN",
                    8,
                    format!("model {number}, which was asked for"),
                    format!("{} models, numbered from 0", models.len()),
                    "choose another model",
                )
            })?
        }
    };
    for model in chosen {
        info.instances += 1;
        place(model, None, &contents.palette, options, emitter)?;
    }
    Ok(())
}

/// Passes on the voxels of one placement of a model, at their own coordinates without a transform.
fn place(
    model: &Model<'_>,
    transform: Option<&Transform>,
    palette: &Palette,
    options: &ReadOptions,
    emitter: &mut Emitter<'_>,
) -> Result<(), Problem> {
    for (i, [x, y, z, color]) in model.voxels.iter().enumerate() {
        if *color == 0 {
            continue;
        }
        let Some(position) = model::position([*x, *y, *z], model.size, options.oob) else {
            continue;
        };
        let index = match transform {
            Some(transform) => transform.place(position, model.size),
            None => position,
        };
        emitter.voxel(index, palette.color(*color), None, || {
            (format!("voxel {i} of a model"), model.offset + 4 * i as u64)
        })?;
    }
    Ok(())
}
