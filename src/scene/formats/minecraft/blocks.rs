//! Colours of blocks.
//!
//! A name has the colour of the longest row of whole words in it: `dark_oak_stairs` is `dark_oak`, and `oak_leaves` is
//! `leaves`. So a short table covers slabs, stairs, walls and all sixteen dyes. The colours are near the mean of the
//! blocks' faces.

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Block {
    /// Nothing that can be seen.
    Air,
    Solid([u8; 3]),
}

const INVISIBLE: [&str; 6] = [
    "air",
    "cave_air",
    "void_air",
    "structure_void",
    "barrier",
    "light",
];

#[rustfmt::skip]
const COLORS: &[(&str, u32)] = &[
    // Dyes: wool, concrete, terracotta, carpets, beds, glass.
    ("white", 0xe9ecec), ("orange", 0xf07613), ("magenta", 0xbd44b3), ("light_blue", 0x3aafd9), ("yellow", 0xf8c527),
    ("lime", 0x70b919), ("pink", 0xed8dac), ("gray", 0x3e4447), ("light_gray", 0x8e8e86), ("cyan", 0x158991),
    ("purple", 0x792aac), ("blue", 0x35399d), ("brown", 0x724728), ("green", 0x546d1b), ("red", 0xa12722),
    ("black", 0x141519), ("terracotta", 0x985e43), ("glass", 0xc5dfe3), ("tinted_glass", 0x2c272e),
    // Woods.
    ("oak", 0xa2834f), ("spruce", 0x735531), ("birch", 0xc0af79), ("jungle", 0xa07351), ("acacia", 0xa85a32),
    ("dark_oak", 0x432b14), ("pale_oak", 0xe4dad8), ("mangrove", 0x763631), ("cherry", 0xe3b3ad), ("bamboo", 0xc2ad50),
    ("crimson", 0x653147), ("warped", 0x2b6963), ("oak_log", 0x6d5533), ("spruce_log", 0x3b2611),
    ("birch_log", 0xd9d7d2), ("jungle_log", 0x554419), ("acacia_log", 0x676157), ("dark_oak_log", 0x3c2e1a),
    ("oak_wood", 0x6d5533), ("spruce_wood", 0x3b2611), ("birch_wood", 0xd9d7d2), ("jungle_wood", 0x554419),
    ("acacia_wood", 0x676157), ("dark_oak_wood", 0x3c2e1a), ("crafting_table", 0x80603c), ("chest", 0x9c7130),
    ("barrel", 0x866439), ("bookshelf", 0x755f3b), ("ladder", 0x7d6036), ("lectern", 0xae8953), ("scaffolding", 0xaa8449),
    // Plants.
    ("leaves", 0x48782a), ("cherry_leaves", 0xe5adc2), ("azalea", 0x5a7330), ("grass_block", 0x6f8f4a), ("grass", 0x6f9a45),
    ("fern", 0x6f9a45), ("vine", 0x48782a), ("vines", 0x48782a), ("moss", 0x596d2d), ("sapling", 0x4d6a28),
    ("lily_pad", 0x205f2b), ("sugar_cane", 0x94c065), ("cactus", 0x55812b), ("kelp", 0x578c2d), ("seagrass", 0x337f2b),
    ("wheat", 0xa69b45), ("hay_block", 0xa68b26), ("pumpkin", 0xc57518), ("jack_o_lantern", 0xd79835),
    ("melon", 0x6f9119), ("dandelion", 0xf4d424), ("poppy", 0xc8281c), ("mushroom", 0x98755b),
    ("red_mushroom_block", 0xc82e2d), ("brown_mushroom_block", 0x957050), ("mushroom_stem", 0xcbc4b9),
    // Ground.
    ("dirt", 0x866043), ("coarse_dirt", 0x77553b), ("podzol", 0x5b3f18), ("mycelium", 0x6f6265), ("farmland", 0x8f6646),
    ("dirt_path", 0x947a41), ("mud", 0x3c393c), ("mud_brick", 0x896750), ("mud_bricks", 0x896750), ("clay", 0xa0a6b3),
    ("gravel", 0x837f7e), ("sand", 0xdbcfa3), ("red_sand", 0xbe6621), ("sandstone", 0xd8cb9b),
    ("red_sandstone", 0xba631d), ("snow", 0xf9fefe), ("ice", 0x91b7fd), ("packed_ice", 0x8db4fa), ("blue_ice", 0x74a7fd),
    ("water", 0x3f76e4), ("lava", 0xcf5b13), ("magma", 0x8e3f20), ("fire", 0xd4892a), ("obsidian", 0x0f0b19),
    // Stones.
    ("stone", 0x7d7d7d), ("smooth_stone", 0x9e9e9e), ("cobblestone", 0x7f7f7f), ("mossy_cobblestone", 0x6e765e),
    ("stone_brick", 0x7a7979), ("stone_bricks", 0x7a7979), ("mossy_stone_brick", 0x737969),
    ("mossy_stone_bricks", 0x737969), ("granite", 0x956755), ("diorite", 0xbcbcbc), ("andesite", 0x888888),
    ("deepslate", 0x505052), ("tuff", 0x6c6d66), ("calcite", 0xdfe0dc), ("dripstone", 0x866b5c), ("bedrock", 0x555555),
    ("basalt", 0x49484d), ("blackstone", 0x2a2328), ("brick", 0x966153), ("bricks", 0x966153), ("quartz", 0xebe5de),
    ("prismarine", 0x639c97), ("dark_prismarine", 0x335b4b), ("sea_lantern", 0xacc7be), ("purpur", 0xa97da9),
    ("end_stone", 0xdbde9e), ("netherrack", 0x612626), ("nether_brick", 0x2c1519), ("nether_bricks", 0x2c1519),
    ("red_nether_bricks", 0x450709), ("soul_sand", 0x513e32), ("soul_soil", 0x4b392e), ("nether_wart_block", 0x720202),
    ("glowstone", 0xab8354), ("shroomlight", 0xf09246), ("amethyst", 0x8561bf), ("sculk", 0x0c1d24), ("bone_block", 0xd1ceb3),
    // Ores, metals and devices.
    ("ore", 0x7d7a74), ("coal_block", 0x101010), ("iron", 0xdcdcdc), ("gold", 0xf6d03d), ("diamond", 0x62ede4),
    ("emerald", 0x2acb57), ("lapis", 0x1e438c), ("redstone", 0xaf1805), ("netherite", 0x423d3f), ("copper", 0xc06b4f),
    ("exposed_copper", 0xa17d67), ("weathered_copper", 0x6c996e), ("oxidized_copper", 0x52a284), ("lantern", 0x6a5b53),
    ("torch", 0xe0b050), ("rail", 0x7d6f58), ("furnace", 0x6e6d6d), ("smoker", 0x555351), ("piston", 0x6d6864),
    ("dispenser", 0x7a7a7a), ("dropper", 0x7a7a7a), ("observer", 0x626262), ("hopper", 0x4c4a4c), ("anvil", 0x484848),
    ("cauldron", 0x4a494a), ("chain", 0x333a4a), ("lever", 0x6f6758), ("tnt", 0xb64235), ("sponge", 0xc3c04a),
    ("slime_block", 0x6fc05b), ("honey_block", 0xfbb934), ("honeycomb_block", 0xe5941d), ("cobweb", 0xe4e9ea),
    ("target", 0xe5b0a6), ("beacon", 0x75ddd7),
];

/// The block of a name without its namespace, or `None` if the table has no colour.
pub(super) fn find(name: &str) -> Option<Block> {
    if INVISIBLE.contains(&name) {
        return Some(Block::Air);
    }
    // Surrounded by `_`, words of a row match only whole words.
    let name = format!("_{name}_");
    let is_in = |(words, _): &&(&str, u32)| name.contains(&format!("_{words}_"));
    let longest = COLORS
        .iter()
        .filter(is_in)
        .max_by_key(|(words, _)| words.len());
    longest.map(|&(_, color)| {
        let [_, r, g, b] = color.to_be_bytes();
        Block::Solid([r, g, b])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_row_of_whole_words_counts() {
        for (name, like) in [
            ("dark_oak_stairs", "dark_oak"),
            ("oak_leaves", "leaves"),
            ("light_blue_stained_glass_pane", "light_blue"),
            ("waxed_exposed_cut_copper_slab", "exposed_cut_copper"),
            ("polished_blackstone_brick_wall", "blackstone"),
        ] {
            assert_eq!(find(name), find(like), "{name}");
        }
        assert_eq!(
            find("red_sandstone"),
            Some(Block::Solid([0xba, 0x63, 0x1d]))
        );
        assert_eq!(find("cave_air"), Some(Block::Air));
        assert_eq!(find("ironclad"), None);
        // Words of each row are its own.
        for (words, _) in COLORS {
            assert_eq!(
                COLORS.iter().filter(|(other, _)| other == words).count(),
                1,
                "{words}"
            );
        }
    }
}
