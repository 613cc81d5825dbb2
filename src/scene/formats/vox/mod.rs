//! MagicaVoxel's and VoxelShop's `.vox`.
//!
//! `chunk`, `palette`, `transform` and `graph` (the scene graph) read a file, `quantize` and `write` make one.

mod chunk;
mod graph;
mod palette;
mod quantize;
mod transform;
mod write;

pub use write::{VoxWriter, VoxWritten};

use crate::scene::SceneInfo;
use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem};
use crate::scene::input::Input;
use chunk::{Chunk, Fields};
use graph::SceneGraph;
use palette::Palette;
use transform::Transform;

const AGAIN: &str = "open the file in MagicaVoxel and save it again";
const DAMAGED: &str =
    "the file is damaged or its exporter is at fault; open it in MagicaVoxel and save it again";

struct Model<'a> {
    size: [u32; 3],
    voxels: &'a [[u8; 4]],
    /// Those of a colour other than 0.
    visible: u64,
    offset: u64,
}

struct Contents<'a> {
    models: Vec<Model<'a>>,
    graph: SceneGraph,
    palette: Palette,
}

pub(super) fn read(input: &mut Input<'_>, emitter: &mut Emitter<'_>) -> Result<(), Problem> {
    let bytes = input.bytes().map_err(Problem::Read)?;
    let contents = read_contents(&bytes, &mut emitter.info)?;
    let warnings = &mut emitter.info.warnings;
    survey(&contents, warnings);
    let (models, mut hidden) = (&contents.models, 0);
    let placed: Vec<(&Model<'_>, Option<Transform>)> = if contents.graph.is_empty() {
        if models.len() > 1 {
            warnings.push(format!(
                "the file has {} models and no scene graph; all were read into the same space, as nothing says where they go",
                models.len()
            ));
        }
        models.iter().map(|model| (model, None)).collect()
    } else {
        let placements;
        (placements, hidden) = contents.graph.placements(models.len(), warnings)?;
        let of =
            |(number, transform): (u32, Transform)| (&models[number as usize], Some(transform));
        placements.into_iter().map(of).collect()
    };
    // Places are fewer than 2^20, and a model has fewer voxels than 2^30.
    emitter.expect(placed.iter().map(|(model, _)| model.visible).sum())?;
    for (model, transform) in placed {
        place(model, transform, &contents.palette, emitter)?;
    }
    if hidden > 0 {
        let warning = format!("{hidden} hidden models were left out");
        emitter.info.warnings.push(warning);
    }
    Ok(())
}

fn read_contents<'a>(bytes: &'a [u8], info: &mut SceneInfo) -> Result<Contents<'a>, Problem> {
    let mut contents = Contents {
        models: Vec::new(),
        graph: SceneGraph::default(),
        palette: Palette::default_colors(),
    };
    let mut size: Option<(Chunk<'_>, [u32; 3])> = None;
    let (chunks, left_over) = chunk::chunks(bytes)?;
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
                let mut fields = Fields::new(&chunk);
                let mut side = |axis| fields.u32(&format!("the size along {axis}"));
                size = Some((chunk, [side("x")?, side("y")?, side("z")?]));
            }
            b"XYZI" => {
                let Some((_, size)) = size.take() else {
                    let (expected, found) =
                        ("a chunk SIZE before each XYZI", "an XYZI without one");
                    let at = chunk.offset as u64;
                    return Err(Fault::new("chunk XYZI", at, expected, found, DAMAGED).into());
                };
                let mut fields = Fields::new(&chunk);
                let count = fields.count("voxels", 4)? as usize;
                let voxels = &fields.rest().as_chunks::<4>().0[..count];
                contents.models.push(Model {
                    size,
                    voxels,
                    visible: voxels.iter().filter(|voxel| voxel[3] != 0).count() as u64,
                    offset: fields.offset(),
                });
            }
            b"RGBA" => {
                contents.palette = Palette::read(&chunk)?;
                contents.palette.entries().clone_into(&mut info.palette);
            }
            b"nTRN" | b"nGRP" | b"nSHP" => contents.graph.add_node(&chunk)?,
            b"LAYR" => contents.graph.add_layer(&chunk)?,
            _ => {}
        }
    }
    if let Some((chunk, _)) = size {
        return Err(lonely_size(&chunk).into());
    }
    if contents.models.is_empty() {
        let expected = "at least one model (chunks SIZE and XYZI)";
        let advice = "save the scene again with something in it";
        return Err(Fault::new("chunk MAIN", 8, expected, "none", advice).into());
    }
    Ok(contents)
}

fn lonely_size(chunk: &Chunk<'_>) -> Box<Fault> {
    let (expected, found) = ("a chunk XYZI after each SIZE", "a SIZE without one");
    Fault::new("chunk SIZE", chunk.offset as u64, expected, found, DAMAGED)
}

/// Counts voxels, each model once.
fn survey(contents: &Contents<'_>, warnings: &mut Vec<String>) {
    let (mut empty, mut outside) = (0u64, 0u64);
    let mut without_color = false;
    let given = contents.palette.given;
    for model in &contents.models {
        empty += model.voxels.len() as u64 - model.visible;
        for [x, y, z, color] in model.voxels {
            without_color |= given > 0 && usize::from(*color) > given;
            outside += u64::from(!is_inside([*x, *y, *z], model.size));
        }
    }
    if empty > 0 {
        warnings.push(format!(
            "{empty} voxels have colour index 0, which means empty, and were left out"
        ));
    }
    if without_color {
        warnings.push(format!(
            "some voxels use colours beyond the palette's {given} entries; MagicaVoxel's default colours were used for them"
        ));
    }
    if outside > 0 {
        warnings.push(format!(
            "{outside} voxels lie outside their model's SIZE and were taken modulo 256, nearest to the middle of SIZE"
        ));
    }
}

fn place(
    model: &Model<'_>,
    transform: Option<Transform>,
    palette: &Palette,
    emitter: &mut Emitter<'_>,
) -> Result<(), Problem> {
    for (i, [x, y, z, color]) in model.voxels.iter().enumerate() {
        if *color == 0 {
            continue;
        }
        let stored = [x, y, z];
        let position = [0, 1, 2].map(|axis| unwrap(*stored[axis], model.size[axis]));
        let index = transform.map_or(position, |t| t.place(position, model.size));
        emitter.voxel(index, palette.color(*color), None, || {
            (format!("voxel {i} of a model"), model.offset + 4 * i as u64)
        })?;
    }
    Ok(())
}

fn is_inside(position: [u8; 3], size: [u32; 3]) -> bool {
    (0..3).all(|axis| u32::from(position[axis]) < size[axis])
}

/// The coordinate of a stored byte. Outside `SIZE` it is the number congruent to it modulo 256 that is nearest to the
/// middle of `SIZE`: one of the 256 numbers from `floor(SIZE / 2) - 128` on.
fn unwrap(byte: u8, size: u32) -> i64 {
    let byte = u32::from(byte);
    let is_wrapped = byte >= size && byte >= size / 2 + 128;
    i64::from(byte) - if is_wrapped { 256 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::unwrap;

    #[test]
    fn unwrapping_takes_the_nearest_number_to_the_middle() {
        for (size, byte) in (0..=300).flat_map(|size| (0..=255).map(move |byte| (size, byte))) {
            let middle = i64::from(size / 2);
            let near = (middle - 128..middle + 128).find(|n| n.rem_euclid(256) == i64::from(byte));
            let inside = (u32::from(byte) < size).then_some(i64::from(byte));
            assert_eq!(Some(unwrap(byte, size)), inside.or(near));
        }
    }
}
