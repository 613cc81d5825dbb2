//! The engine, its rules and its words.

use clap::{Args, ValueEnum};
use hwmodel::Overflow;

use super::scene::SceneArgs;
use super::values::tolerance;
use shiftvox::fast::Instructions;
use shiftvox::project::{CageKind, Coverage, SetupOptions};
use shiftvox_mesh::far::view::Opacity;
use shiftvox_mesh::textured::view::Erosion;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(crate) enum EngineName {
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

fn erosion(text: &str) -> Result<Erosion, String> {
    match text {
        "auto" => Ok(Erosion::Auto { texel_px: 1.0 }),
        text => text
            .parse()
            .map(|level| Erosion::Level { level, cells: None })
            .map_err(|_| "expected a number of erosions, 0 or more, or auto".to_owned()),
    }
}

#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Engine")]
pub(crate) struct RuleArgs {
    /// How a record holds its projected vertices [default: frame]
    #[arg(long, value_enum, conflicts_with = "paper")]
    pub(crate) cage: Option<CageKind>,
    /// Largest deviation in pixels at which a record of --coverage any or center changes from clip
    /// to screen space, 0 for never and inf for at once [default: 0.125]
    #[arg(long, value_name = "PX|inf", conflicts_with = "paper",
          value_parser = tolerance)]
    pub(crate) tolerance: Option<f64>,
    /// Coverage rule [default: exact]
    #[arg(long, value_enum, conflicts_with = "paper")]
    pub(crate) coverage: Option<Coverage>,
    /// Rules of the image-order paper: --cage corners --tolerance inf --coverage any
    #[arg(long)]
    pub(crate) paper: bool,
    /// Draw nodes of at most this many pixels as one voxel, with 0 only leaves [default: 0.5 with
    /// exact and alpha, else 1]. For --engine far and --erosion auto, the largest voxel or texel
    /// [default: 1]
    #[arg(long, value_name = "PX")]
    pub(crate) lod: Option<f64>,
    /// Width of a machine word in bits, 16 to 64 [default: 64, of `model` 32]
    #[arg(long, value_name = "BITS")]
    pub(crate) bits: Option<u32>,
    /// Fraction bits of a word [default: as many as the frame leaves room for]
    #[arg(long, value_name = "BITS")]
    pub(crate) frac: Option<u32>,
    /// Result of an operation that overflows a word [default: trap]
    #[arg(long, value_enum)]
    pub(crate) overflow: Option<Overflow>,
}

#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Engine")]
pub(crate) struct EngineArgs {
    /// Engine that draws [default: fast, for .far files far, for .tvx files textured]
    #[arg(long, value_enum)]
    pub(crate) engine: Option<EngineName>,
    #[command(flatten)]
    pub(crate) rules: RuleArgs,
    /// Instructions of the fast engine, which never change the output
    #[arg(long, value_enum, default_value_t)]
    pub(crate) isa: Instructions,
    /// Opacities of --engine far [default: six]
    #[arg(long, value_enum, value_name = "KIND")]
    pub(crate) far_opacity: Option<Opacity>,
    /// Erosions of --engine textured [default: auto, the level with the fewest faces whose texels
    /// are at most a pixel]
    #[arg(long, value_name = "K|auto", value_parser = erosion)]
    pub(crate) erosion: Option<Erosion>,
    /// Cells of the grid of --erosion K [default: the coarsest grid whose texels are at most a
    /// pixel, or else the finest]
    #[arg(long, value_name = "CELLS")]
    pub(crate) erosion_grid: Option<u32>,
}

impl RuleArgs {
    /// Whether a rule of the machine alone was given.
    pub(crate) fn are_of_machine(&self) -> bool {
        let of_machine = self.cage.is_some() || self.tolerance.is_some() || self.overflow.is_some();
        of_machine || self.options(0).coverage != Coverage::Exact
    }

    /// The set-up's options with 2^`aa_log2` samples per pixel and axis.
    pub(crate) fn options(&self, aa_log2: u32) -> SetupOptions {
        let base = if self.paper {
            SetupOptions::paper()
        } else {
            SetupOptions::of(self.coverage.unwrap_or_default())
        };
        SetupOptions {
            bits: self.bits.unwrap_or(base.bits),
            frac: self.frac,
            cage: self.cage.unwrap_or(base.cage),
            tolerance_px: self.tolerance.unwrap_or(base.tolerance_px),
            coverage: base.coverage,
            lod_px: self.lod.unwrap_or(base.lod_px),
            aa_log2,
        }
    }

    /// The scene's flags, with opacities of meshes for the rule that blends.
    pub(crate) fn scene_args(&self, scene: &SceneArgs) -> SceneArgs {
        let blends = self.coverage.is_some_and(Coverage::blends);
        SceneArgs {
            opacities: scene.opacities || blends,
            ..scene.clone()
        }
    }

    pub(crate) fn overflow(&self) -> Overflow {
        self.overflow.unwrap_or_default()
    }
}

impl EngineArgs {
    /// Given flags that not every engine follows, by their long names.
    pub(crate) fn given(&self) -> Vec<&'static str> {
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
    pub(crate) fn check_of_voxels(&self) -> Result<(), String> {
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
}
