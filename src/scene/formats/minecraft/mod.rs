//! Minecraft's blocks: Sponge schematics (`.schem`) of versions 2 and 3, and schematics of the mod Litematica.

mod blocks;
mod nbt;

use std::collections::BTreeSet;

use blocks::Block;
use nbt::{Cursor, Value, content, fault};

use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem};
use crate::scene::input::Input;

/// Most block states of a palette. Minecraft has some 30,000.
const MOST_STATES: i64 = 1 << 20;

pub(super) fn read(input: &mut Input<'_>, emitter: &mut Emitter<'_>) -> Result<(), Problem> {
    let bytes = content(input)?;
    let root = Cursor::root(&bytes)?;
    let mut scene = Scene {
        emitter,
        unknown: BTreeSet::new(),
    };
    if let Some(Value::Compound(regions)) = root.get("Regions")? {
        regions.entries(|_, region| match region {
            Value::Compound(region) => scene.region(region),
            _ => Err(fault(
                regions.offset(),
                "regions that are compounds",
                "another value",
            )),
        })?;
    } else {
        // In version 3 the schematic is an entry, in version 2 the file.
        let schematic = match root.get("Schematic")? {
            Some(Value::Compound(schematic)) => schematic,
            _ => root,
        };
        scene.schematic(schematic)?;
    }
    if let Some(first) = scene.unknown.first() {
        let count = scene.unknown.len();
        emitter.info.warnings.push(format!(
            "kinds of blocks without a colour of their own, which got the default one: {count}, such as {first:?}"
        ));
    }
    Ok(())
}

struct Scene<'s, 'e> {
    emitter: &'s mut Emitter<'e>,
    /// Names of blocks without a colour of their own.
    unknown: BTreeSet<String>,
}

/// The block of each number.
type Palette = Vec<Option<Block>>;

impl Scene<'_, '_> {
    /// Blocks of a Sponge schematic: numbers of 7 bits per byte, x first, then z, then y.
    fn schematic(&mut self, schematic: Cursor<'_>) -> Result<(), Problem> {
        let (blocks, data) = match schematic.get("Blocks")? {
            Some(Value::Compound(blocks)) => (blocks, "Data"),
            Some(Value::Bytes(_)) if schematic.get("BlockData")?.is_none() => {
                let advice =
                    "save it as .schem, for example with WorldEdit: //schem save NAME sponge.3";
                let found = "numbers of blocks, as in files .schematic of Minecraft before 1.13";
                return Err(Fault::new("NBT", 0, "names of blocks", found, advice).into());
            }
            _ => (schematic, "BlockData"),
        };
        let at = schematic.offset();
        let missing = |what: &str| fault(at, format!("an entry {what:?} of its type"), "none");
        let mut size = [0; 3];
        for (side, name) in size.iter_mut().zip(["Width", "Height", "Length"]) {
            let Some(Value::Whole(value)) = schematic.get(name)? else {
                return Err(missing(name));
            };
            // Stored with a sign, and meant without.
            *side = u64::from(value as u16);
        }
        let Some(Value::Compound(states)) = blocks.get("Palette")? else {
            return Err(missing("Palette"));
        };
        let Some(Value::Bytes(bytes)) = blocks.get(data)? else {
            return Err(missing(data));
        };
        let mut palette = Palette::new();
        states.entries(|name, number| {
            let Value::Whole(number @ 0..MOST_STATES) = number else {
                return Err(fault(
                    states.offset(),
                    "numbers from 0 to 1048575",
                    "another value",
                ));
            };
            let number = number as usize;
            palette.resize(palette.len().max(number + 1), None);
            palette[number] = Some(self.block(name));
            Ok(())
        })?;
        let mut numbers = bytes.iter();
        let mut next = || {
            let mut number = 0u64;
            for shift in (0..32).step_by(7) {
                let byte = *numbers.next()?;
                number |= u64::from(byte & 127) << shift;
                if byte < 128 {
                    return Some(number);
                }
            }
            None
        };
        self.grid(&palette, size, [0; 3], at, |_| next())
    }

    /// Blocks of a region of Litematica: numbers of as few bits as the palette needs, packed into words of 64 bits.
    fn region(&mut self, region: Cursor<'_>) -> Result<(), Problem> {
        let at = region.offset();
        let missing = |what: &str| fault(at, format!("an entry {what:?} of its type"), "none");
        let vector = |name: &str| {
            let mut vector = [0; 3];
            let Some(Value::Compound(parts)) = region.get(name)? else {
                return Err(missing(name));
            };
            for (part, axis) in vector.iter_mut().zip(["x", "y", "z"]) {
                let Some(Value::Whole(value)) = parts.get(axis)? else {
                    return Err(missing(name));
                };
                *part = i64::from(value as i32);
            }
            Ok(vector)
        };
        let (corner, extent) = (vector("Position")?, vector("Size")?);
        // A negative extent leads from the corner downwards.
        let low = [0, 1, 2].map(|k| corner[k] + (extent[k] + 1).min(0));
        let size = extent.map(i64::unsigned_abs);
        let Some(Value::List {
            kind: 10,
            count,
            at: states,
        }) = region.get("BlockStatePalette")?
        else {
            return Err(missing("BlockStatePalette"));
        };
        let Some(Value::Longs(words)) = region.get("BlockStates")? else {
            return Err(missing("BlockStates"));
        };
        let mut palette = Palette::new();
        states.compounds(count, |state| {
            let Some(Value::Text(name)) = state.get("Name")? else {
                return Err(missing("Name"));
            };
            palette.push(Some(self.block(name)));
            Ok(())
        })?;
        let bits = u64::from(
            count
                .saturating_sub(1)
                .checked_ilog2()
                .map_or(2, |log| (log + 1).max(2)),
        );
        let words = words.as_chunks::<8>().0;
        let word = |n: u64| {
            words
                .get(usize::try_from(n).ok()?)
                .map(|w| u64::from_be_bytes(*w))
        };
        self.grid(&palette, size, low, at, |number| {
            let begin = number.checked_mul(bits)?;
            let (first, shift) = (begin / 64, begin % 64);
            let mut value = word(first)? >> shift;
            if shift + bits > 64 {
                value |= word(first + 1)? << (64 - shift);
            }
            Some(value & ((1 << bits) - 1))
        })
    }

    /// Voxels of a grid whose axes are east, up and south. `number` gives the palette's number of each block, in order.
    fn grid(
        &mut self,
        palette: &[Option<Block>],
        [width, height, length]: [u64; 3],
        low: [i64; 3],
        at: usize,
        mut number: impl FnMut(u64) -> Option<u64>,
    ) -> Result<(), Problem> {
        let count = width
            .checked_mul(height)
            .and_then(|n| n.checked_mul(length));
        let count = count.ok_or_else(|| fault(at, "fewer blocks", "sizes beyond 64 bits"))?;
        for n in 0..count {
            let cut = || fault(at, format!("{count} blocks"), format!("{n}"));
            let number = number(n).ok_or_else(cut)?;
            let block = usize::try_from(number).ok().and_then(|n| *palette.get(n)?);
            let unnamed = || fault(at, "numbers of the palette", number.to_string());
            if let Block::Solid(color) = block.ok_or_else(unnamed)? {
                let [x, z, y] = [n % width, n / width % length, n / width / length];
                let east = low[0] + x as i64;
                let south = low[2] + z as i64;
                let index = [east, -1 - south, low[1] + y as i64];
                self.emitter
                    .voxel(index, color, None, || ("blocks".to_owned(), at as u64))?;
            }
        }
        Ok(())
    }

    fn block(&mut self, name: &[u8]) -> Block {
        let name = String::from_utf8_lossy(name);
        // Without properties: `minecraft:oak_log[axis=y]`.
        let name = name.split('[').next().unwrap_or_default();
        blocks::find(name.rsplit(':').next().unwrap_or_default()).unwrap_or_else(|| {
            self.unknown.insert(name.to_owned());
            Block::Solid(crate::scene::DEFAULT_COLOR)
        })
    }
}
