//! The engine's skips and short cuts, each to be switched off for measurements.

/// Skips and short cuts. None changes a bit of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Switches {
    /// Leave nodes of whose windows all samples are drawn.
    pub hidden: bool,
    /// Stop when the picture is full.
    pub full: bool,
    /// Leave nodes that are beside the picture or hold no sample.
    pub off_screen: bool,
    /// Take two levels, or one, in one step of 64 lanes.
    pub bricks: bool,
    /// Fill blocks and tiles of samples inside large solids without looking at
    /// each sample, and leave those beside them.
    pub whole_blocks: bool,
    /// Leave children that do not exist at once. Off, above bricks, all eight
    /// are looked at first. A brick has a lane for each of 64 parts, whether it
    /// exists or not.
    pub absent_children: bool,
}

impl Default for Switches {
    fn default() -> Self {
        Self {
            hidden: true,
            full: true,
            off_screen: true,
            bricks: true,
            whole_blocks: true,
            absent_children: true,
        }
    }
}
