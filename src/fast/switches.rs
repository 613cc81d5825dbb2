//! Skips and short cuts, each switched off for measurements.

/// None changes a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Switches {
    /// Skip nodes whose windows are full.
    pub hidden: bool,
    /// Stop when the picture is full.
    pub full: bool,
    /// Skip nodes beside the picture or without a sample.
    pub off_screen: bool,
    /// Draw two levels, or one, in one step of 64 lanes.
    pub bricks: bool,
    /// Fill blocks and tiles inside large solids at once, and skip those beside them.
    pub whole_blocks: bool,
    /// Skip absent children at once. Off: above bricks, all eight are tested first; a brick has a lane for each of 64
    /// parts in any case.
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
