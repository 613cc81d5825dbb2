//! Helpers of the tests of costs.

use hwmodel::cost::CostTable;

pub(crate) fn shipped() -> CostTable {
    CostTable::load_shipped().expect("well-formed tables")
}

#[track_caller]
pub(crate) fn near(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 1e-9 * expected.abs().max(1.0),
        "{found} is not {expected}"
    );
}
