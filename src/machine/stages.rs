//! The machine's stages.

use hwmodel::Stage;
use hwmodel::cycles::{Hardware, HardwareError};

hwmodel::stages! {
    /// The stages of the record loop, in the order in which a record meets them.
    #[derive(serde::Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum RecordStage {
        Pop = "pop",
        Filled = "filled?",
        ToScreen = "to screen",
        OnePixel = "one pixel?",
        Centre = "centre",
        Order = "order",
        /// The vertices that the children share.
        VertexPool = "vertex pool",
        ChildBox = "child box",
        /// The smallest unfilled quadtree node that holds the box.
        QuadtreeFit = "quadtree fit",
        Push = "push",
        Draw = "draw",
        Blend = "blend",
        FillUpdate = "fill update",
    }
}

/// Reports the first setting of a design that the machine cannot follow.
pub fn check_hardware(hardware: &Hardware) -> Result<(), HardwareError> {
    hardware.check()?;
    hardware.check_stages(&RecordStage::ALL.map(Stage::from))
}
