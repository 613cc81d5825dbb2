//! The engine, its rules and its words.

use std::fmt;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use hwmodel::Overflow;

use super::scene::SceneArgs;
use super::setting::{Setting, word};
use super::values::Tolerance;
use shiftvox::fast::Instructions;
use shiftvox::project::{CageKind, Coverage, SetupOptions};
use shiftvox_mesh::far::view::Opacity;

/// An engine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum EngineName {
    /// The same bits as the machine, as fast as the processor goes.
    #[default]
    Fast,
    /// The image-order paper's loop in machine words: adders and shifts.
    Machine,
    /// The exact reference: what each sample's centre sees, by plain rays.
    Rays,
    /// Far voxels, of a .far file; see `convert`.
    Far,
    /// Textured voxels, of a .tvx file; see `convert`.
    Textured,
}

/// How often textured voxels are eroded: a number, or `auto`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Erosion {
    /// The level of fewest faces whose texels are at most a pixel.
    #[default]
    Auto,
    /// So often; beyond the last level primitives alone are left.
    Level(u32),
}

impl FromStr for Erosion {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let level = text.parse().map(Self::Level);
        level.map_err(|_| "expected a number of erosions, 0 or more, or auto".to_owned())
    }
}

impl fmt::Display for Erosion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => f.write_str("auto"),
            Self::Level(level) => level.fmt(f),
        }
    }
}

/// By which rules a frame is drawn, in which words.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Engine")]
pub struct RuleArgs {
    /// How a record holds its projected vertices [default: frame]
    #[arg(long, value_enum, conflicts_with = "paper")]
    pub cage: Option<CageKind>,
    /// Of --coverage any and center: largest deviation in pixels at which a record may change from
    /// clip to screen space, 0 never, inf at once [default: 0.125]. With exact and alpha, whose
    /// picture is defined without approximation, it is 0 and nothing else
    #[arg(long, value_name = "PX|inf", conflicts_with = "paper")]
    pub tolerance: Option<Tolerance>,
    /// Coverage rule: the pixels that a voxel covers [default: exact]
    #[arg(long, value_enum, conflicts_with = "paper")]
    pub coverage: Option<Coverage>,
    /// As the image-order paper has it: --cage corners --tolerance inf --coverage any
    #[arg(long)]
    pub paper: bool,
    /// Nodes of at most this many pixels are drawn as one voxel; 0: only leaves [default: 0.5 with
    /// exact, else 1]. Of --engine far and --erosion auto: the largest voxel or texel, above 0
    /// [default: 1]
    #[arg(long, value_name = "PX")]
    pub lod: Option<f64>,
    /// Width of a machine word in bits, 16 to 64 [default: 64; of `model`: 32]
    #[arg(long, value_name = "BITS")]
    pub bits: Option<u32>,
    /// Fraction bits of a word [default: as many as the frame leaves room for]
    #[arg(long, value_name = "BITS")]
    pub frac: Option<u32>,
    /// Result of an operation that overflows a word [default: trap]
    #[arg(long, value_enum)]
    pub overflow: Option<Overflow>,
}

/// The engine, its rules and its words.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Engine")]
pub struct EngineArgs {
    /// Engine that draws [default: fast; a .far file's is far, a .tvx file's textured]
    #[arg(long, value_enum)]
    pub engine: Option<EngineName>,
    /// By which rules, in which words.
    #[command(flatten)]
    pub rules: RuleArgs,
    /// Instructions of the fast engine; never changes a bit of output
    #[arg(long, value_enum, default_value_t)]
    pub isa: Instructions,
    /// Opacities of --engine far [default: six]
    #[arg(long, value_enum, value_name = "KIND")]
    pub far_opacity: Option<Opacity>,
    /// How often --engine textured erodes its voxels, or auto: the level of fewest faces, of all
    /// grids, whose texels are no larger than a pixel [default: auto]
    #[arg(long, value_name = "K|auto")]
    pub erosion: Option<Erosion>,
    /// The grid of --erosion K, by its number of cells [default: the coarsest whose texels are no
    /// larger than a pixel, or else the finest]
    #[arg(long, value_name = "CELLS")]
    pub erosion_grid: Option<u32>,
}

impl RuleArgs {
    /// Whether a rule or setting was given that only the machine's steps have.
    pub fn are_of_machine(&self) -> bool {
        let of_machine = self.cage.is_some() || self.tolerance.is_some() || self.overflow.is_some();
        of_machine || self.options(0).coverage != Coverage::Exact
    }

    /// The set-up's options, at so many samples per pixel and axis (as a power of two).
    #[must_use]
    pub fn options(&self, aa_log2: u32) -> SetupOptions {
        let base = if self.paper {
            SetupOptions::paper()
        } else {
            SetupOptions::of(self.coverage.unwrap_or_default())
        };
        SetupOptions {
            bits: self.bits.unwrap_or(base.bits),
            frac: self.frac,
            cage: self.cage.unwrap_or(base.cage),
            tolerance_px: self.tolerance.map_or(base.tolerance_px, |t| t.0),
            coverage: base.coverage,
            lod_px: self.lod.unwrap_or(base.lod_px),
            aa_log2,
        }
    }

    /// Pixels of the largest voxel of a .far file, or texel of a .tvx file.
    #[must_use]
    pub fn mesh_lod(&self) -> f64 {
        self.lod.unwrap_or(1.0)
    }

    /// How scenes are read that are drawn so: meshes with opacities for the rule that blends.
    #[must_use]
    pub fn scene_args(&self, scene: &SceneArgs) -> SceneArgs {
        let blends = self.coverage.is_some_and(Coverage::blends);
        SceneArgs {
            opacities: scene.opacities || blends,
            ..scene.clone()
        }
    }

    /// The datapath's reaction to an overflow.
    #[must_use]
    pub fn overflow(&self) -> Overflow {
        self.overflow.unwrap_or_default()
    }

    /// Settings that the engines of voxels have alone.
    fn settings(&self) -> Vec<Setting> {
        let options = self.options(0);
        let tolerance = Tolerance(options.tolerance_px);
        let mut settings = vec![
            ("cage", word(&options.cage)),
            ("tolerance", tolerance.to_string().into()),
            ("coverage", word(&options.coverage)),
            ("bits", i64::from(options.bits).into()),
            ("overflow", word(&self.overflow())),
        ];
        settings.extend(self.frac.map(|frac| ("frac", i64::from(frac).into())));
        settings
    }
}

impl EngineArgs {
    /// Flags of the command line that not every engine follows, by their long names.
    #[must_use]
    pub fn given(&self) -> Vec<&'static str> {
        let flags = [
            ("cage", self.rules.cage.is_some()),
            ("tolerance", self.rules.tolerance.is_some()),
            ("coverage", self.rules.coverage.is_some()),
            ("paper", self.rules.paper),
            ("bits", self.rules.bits.is_some()),
            ("frac", self.rules.frac.is_some()),
            ("overflow", self.rules.overflow.is_some()),
            ("isa", self.isa != Instructions::Auto),
            ("far-opacity", self.far_opacity.is_some()),
            ("erosion", self.erosion.is_some()),
            ("erosion-grid", self.erosion_grid.is_some()),
        ];
        let given = flags.into_iter().filter(|&(_, is_given)| is_given);
        given.map(|(name, _)| name).collect()
    }

    /// Refuses flags that the engine of voxels does not follow.
    ///
    /// # Errors
    /// The purpose of the first such flag.
    pub fn check_of_voxels(&self) -> Result<(), String> {
        if self.far_opacity.is_some() {
            return Err("--far-opacity is for .far files".to_owned());
        }
        if self.erosion.is_some() || self.erosion_grid.is_some() {
            return Err("--erosion and --erosion-grid are for .tvx files".to_owned());
        }
        if self.isa != Instructions::Auto
            && self.engine.is_some_and(|engine| engine != EngineName::Fast)
        {
            return Err("--isa is for --engine fast".to_owned());
        }
        Ok(())
    }

    /// Every setting of an engine, for a configuration file. `None` means engines of different kinds,
    /// and the settings that all of them have.
    #[must_use]
    pub fn settings(&self, engine: Option<EngineName>) -> Vec<Setting> {
        let mut settings = vec![("isa", word(&self.isa))];
        settings.extend(engine.map(|engine| ("engine", word(&engine))));
        let erosion = self.erosion.unwrap_or_default();
        let lod = || ("lod", self.rules.options(0).lod_px.into());
        let mesh_lod = || ("lod", self.rules.mesh_lod().into());
        match engine {
            // The default is not the same for all.
            None => settings.extend(self.rules.lod.map(|lod| ("lod", lod.into()))),
            Some(EngineName::Far) => {
                settings.push(mesh_lod());
                settings.push(("far-opacity", word(&self.far_opacity.unwrap_or_default())));
            }
            Some(EngineName::Textured) => {
                // The level of a texel's size is what auto finds.
                settings.extend((erosion == Erosion::Auto).then(mesh_lod));
                settings.push(("erosion", erosion.to_string().into()));
                settings.extend(
                    self.erosion_grid
                        .map(|g| ("erosion-grid", i64::from(g).into())),
                );
            }
            Some(EngineName::Fast | EngineName::Machine | EngineName::Rays) => {
                settings.push(lod());
                settings.extend(self.rules.settings());
            }
        }
        settings
    }
}
