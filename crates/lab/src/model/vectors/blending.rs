//! What the blocks of the stage *blend* are.

use hwmodel::{SignalKind, Stage};

use super::description::{Description, OBJECT};
use super::ports::{BIT, LEVEL, Ports, WORD};
use shiftvox::project::CageKind;

/// They have no cage among their wires: either will do.
const NO_CAGE: CageKind = CageKind::Frame;
const FOUR: SignalKind = SignalKind::Unsigned(4);
const SHARE: SignalKind = SignalKind::Unsigned(5);
const WEIGHT: SignalKind = SignalKind::Unsigned(9);
const COLOR: SignalKind = SignalKind::Unsigned(16);
const SUM: SignalKind = SignalKind::Unsigned(24);
const COUNT: &str = "v of the axis: what the side counts for, sixteenths";
const COLORS: [&str; 3] = ["red", "green", "blue"];

/// The way from the eye to a voxel, one axis.
pub(super) fn way() -> Description {
    Description::new(
        "blend_way",
        &[Stage::Blend],
        "11",
        "way = |((min + max) >> 1 >> shift) - eye|, the first sum with its carry",
        Ports::new(NO_CAGE)
            .one("min", WORD, OBJECT)
            .one("max", WORD, OBJECT)
            .one("eye", WORD, "the eye, shifted already")
            .one("shift", LEVEL, "k of the section"),
        Ports::new(NO_CAGE).one("way", WORD, "d of the axis"),
    )
}

/// Shares of the sides that are seen.
pub(super) fn shares() -> Description {
    Description::new(
        "blend_shares",
        &[Stage::Blend],
        "11",
        "with s = max(way_x + way_y + way_z, 1): share_x = (floor(32 way_x / s) + 1) >> 1, share_y the same of way_y but at most 16 - share_x, share_z = 16 - share_x - share_y",
        Ports::new(NO_CAGE).axes("way", WORD, "d of the axis"),
        Ports::new(NO_CAGE).axes("share", SHARE, "u of the axis, sixteenths"),
    )
}

/// What the sides count for.
pub(super) fn counts() -> Description {
    Description::new(
        "blend_counts",
        &[Stage::Blend],
        "11",
        "with n = the square root of the sum of the squares, to the nearest: count = share^2 / n to the nearest, halves up",
        Ports::new(NO_CAGE).axes("share", SHARE, "u of the axis, sixteenths"),
        Ports::new(NO_CAGE).axes("count", SHARE, COUNT),
    )
}

/// A voxel's weight.
pub(super) fn weight() -> Description {
    Description::new(
        "blend_weight",
        &[Stage::Blend],
        "11",
        "with a = opacity_high where high is set, else opacity_low: weight = 256 where an axis has a = 15, else the sum of (a + (a >> 3)) count",
        ["x", "y", "z"]
            .iter()
            .fold(Ports::new(NO_CAGE), |ports, axis| {
                let meaning = "the voxel's opacity from that side";
                ports.each(&format!("opacity_{axis}"), &["low", "high"], FOUR, meaning)
            })
            .axes("high", BIT, "the eye is on the high side")
            .axes("count", SHARE, COUNT),
        Ports::new(NO_CAGE).one("weight", WEIGHT, "w: 256 lets nothing through"),
    )
}

/// What a sample takes of a voxel.
pub(super) fn sample() -> Description {
    Description::new(
        "blend_sample",
        &[Stage::Blend],
        "11",
        "with m = (left weight + 128) >> 8: full = left - m <= 64, and then m = left; rest = left - m; after = sum + m light; first = left is 256",
        Ports::new(NO_CAGE)
            .one("left", WEIGHT, "T: what the sample still lets through")
            .one("weight", WEIGHT, "w of the voxel")
            .each("light", &COLORS, COLOR, "linear light of the voxel")
            .each("sum", &COLORS, SUM, "C: what the sample has so far"),
        Ports::new(NO_CAGE)
            .one("rest", WEIGHT, "T, written back")
            .each("after", &COLORS, SUM, "C, written back")
            .one("first", BIT, "the first voxel that the sample takes")
            .one("full", BIT, "opaque enough: the fill bit is to be set"),
    )
}
