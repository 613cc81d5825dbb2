//! Which settings `bench error` measures.

use clap::Args;

use crate::args::{RuleArgs, Tolerance};
use shiftvox::project::{CageKind, Coverage, SetupOptions};

/// Which settings are measured. Any list makes it all combinations of what is
/// listed, with the default for what is not.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Settings that are measured")]
pub(super) struct SelectArgs {
    /// Drawing rules
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    pub(super) coverages: Vec<Coverage>,
    /// Tolerances, pixels, of the rules any and center; exact has 0 alone
    #[arg(long, value_delimiter = ',', value_name = "PX|inf,...")]
    tolerances: Vec<Tolerance>,
    /// Cages
    #[arg(long, value_enum, value_delimiter = ',', value_name = "LIST")]
    cages: Vec<CageKind>,
    /// Widths of a word, bits, 16 to 64
    #[arg(long, value_delimiter = ',', value_name = "BITS,...",
          value_parser = clap::value_parser!(u32).range(16..=64))]
    bits: Vec<u32>,
    /// Levels of detail, pixels; 0: only leaves
    #[arg(long, value_delimiter = ',', value_name = "PX,...")]
    lods: Vec<f64>,
    /// Samples a pixel and axis: 1, 2, 4
    #[arg(long, value_delimiter = ',', value_name = "N,...", value_parser = samples)]
    aas: Vec<u32>,
    /// Engines that draw and are timed; counters are always the machine's [default: fast]
    #[arg(long, value_delimiter = ',', value_name = "LIST",
          value_parser = clap::builder::PossibleValuesParser::new(["fast", "machine"]))]
    pub(super) engines: Vec<String>,
}

/// Samples along an axis, as their logarithm.
fn samples(text: &str) -> Result<u32, String> {
    match text.trim() {
        "1" => Ok(0),
        "2" => Ok(1),
        "4" => Ok(2),
        _ => Err("expected 1, 2 or 4".to_owned()),
    }
}

const CAGES: [CageKind; 2] = [CageKind::Frame, CageKind::Corners];

/// One setting of each kind.
#[derive(Clone, Copy)]
struct Choice {
    coverage: Coverage,
    tolerance: f64,
    cage: CageKind,
    bits: u32,
    lod: f64,
    aa_log2: u32,
}

impl Choice {
    fn default_with(coverage: Coverage) -> Self {
        let rule = RuleArgs {
            coverage: Some(coverage),
            ..RuleArgs::default()
        };
        let options = rule.options(0);
        Self {
            coverage,
            tolerance: options.tolerance_px,
            cage: CageKind::Frame,
            bits: options.bits,
            lod: options.lod_px,
            aa_log2: 0,
        }
    }

    fn options(self) -> SetupOptions {
        let engine = RuleArgs {
            coverage: Some(self.coverage),
            tolerance: Some(Tolerance(self.tolerance)),
            cage: Some(self.cage),
            bits: Some(self.bits),
            lod: Some(self.lod),
            ..RuleArgs::default()
        };
        engine.options(self.aa_log2)
    }
}

impl SelectArgs {
    /// The settings that are measured, the default first if it is among them.
    pub(super) fn options(&self) -> Vec<SetupOptions> {
        let listed = !(self.coverages.is_empty()
            && self.tolerances.is_empty()
            && self.cages.is_empty()
            && self.bits.is_empty()
            && self.lods.is_empty()
            && self.aas.is_empty());
        let choices = if listed {
            self.combinations()
        } else {
            standard()
        };
        choices.into_iter().map(Choice::options).collect()
    }

    fn combinations(&self) -> Vec<Choice> {
        /// What was listed, or else the default alone.
        fn list<T: Copy>(given: &[T], default: T) -> Vec<T> {
            match given {
                [] => vec![default],
                given => given.to_vec(),
            }
        }
        let tolerances: Vec<f64> = self.tolerances.iter().map(|t| t.0).collect();
        let mut choices = Vec::new();
        for coverage in list(&self.coverages, Coverage::default()) {
            let tolerances = match has_tolerances(coverage) {
                true => list(&tolerances, 0.125),
                false => vec![0.0],
            };
            let lods = list(&self.lods, Choice::default_with(coverage).lod);
            for cage in list(&self.cages, CAGES[0]) {
                for bits in list(&self.bits, 64) {
                    for &lod in &lods {
                        for aa_log2 in list(&self.aas, 0) {
                            choices.extend(tolerances.iter().map(|&tolerance| Choice {
                                coverage,
                                tolerance,
                                cage,
                                bits,
                                lod,
                                aa_log2,
                            }));
                        }
                    }
                }
            }
        }
        choices
    }
}

/// Whether a rule takes other tolerances than 0.
fn has_tolerances(coverage: Coverage) -> bool {
    !coverage.draws_outlines()
}

/// Around the default settings: every drawing rule with every tolerance it has and
/// both cages; and each rule with other levels of detail, formats, and samples a pixel.
fn standard() -> Vec<Choice> {
    let mut choices = Vec::new();
    for coverage in Coverage::UNBLENDED {
        let default = Choice::default_with(coverage);
        let tolerances: &[f64] = match has_tolerances(coverage) {
            true => &[0.125, 0.0, 1.0 / 64.0, f64::INFINITY],
            false => &[0.0],
        };
        for cage in CAGES {
            choices.extend(tolerances.iter().map(|&tolerance| Choice {
                cage,
                tolerance,
                ..default
            }));
        }
        // The other rules take seconds for a frame of 16 samples a pixel.
        let most = if coverage.draws_outlines() { 2 } else { 1 };
        choices.extend((1..=most).map(|aa_log2| Choice { aa_log2, ..default }));
        let lods = [0.0, 0.5, 1.0, 2.0].into_iter();
        let lods = lods.filter(|&lod| lod != default.lod);
        choices.extend(lods.map(|lod| Choice { lod, ..default }));
        choices.extend([48, 32, 24, 20, 16].map(|bits| Choice { bits, ..default }));
    }
    choices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_settings_are_unlike_each_other_and_begin_with_the_default() {
        let none = SelectArgs {
            coverages: Vec::new(),
            tolerances: Vec::new(),
            cages: Vec::new(),
            bits: Vec::new(),
            lods: Vec::new(),
            aas: Vec::new(),
            engines: Vec::new(),
        };
        let standard = none.options();
        assert_eq!(standard[0], SetupOptions::default());
        assert_eq!(standard.len(), 2 + 2 * 8 + 3 * (1 + 3 + 5) + 1);
        for (place, options) in standard.iter().enumerate() {
            assert!(!standard[..place].contains(options), "{options:?}");
        }
        let some = SelectArgs {
            bits: vec![24, 32],
            aas: vec![1],
            ..none
        };
        let some = some.options();
        assert_eq!(some.len(), 2);
        assert_eq!(
            (some[0].bits, some[0].aa_log2, some[0].lod_px),
            (24, 1, 0.5)
        );
    }
}
