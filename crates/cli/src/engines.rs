//! Engines, and the variants that `bench time` measures.

use clap::builder::{PossibleValue, PossibleValuesParser};

use super::args::{EngineArgs, EngineName};
use super::error::CliError;
use shiftvox::fast::{Fast, FastOptions, Switches};
use shiftvox::machine::{Machine, MachineOptions};
use shiftvox::project::{Engine, Stop};
use shiftvox::rays::Rays;
use shiftvox_lab::bench::{Candidate, Family, Variant};
use shiftvox_lab::float_rays::FloatRays;

pub(super) type Maker = Box<dyn Fn() -> Box<dyn Engine + Send>>;

/// `stop` ends the engines' drawings.
pub(super) fn maker(args: &EngineArgs, stop: &Stop) -> Result<Maker, CliError> {
    let stop = stop.clone();
    let instructions = args.isa;
    let machine = MachineOptions {
        overflow: args.rules.overflow(),
        ..MachineOptions::default()
    };
    let refused = |message: &str, advice: &str| Err(CliError::usage(message).advise(advice));
    match args.engine.unwrap_or_default() {
        EngineName::Fast => {
            let options = FastOptions {
                instructions,
                ..FastOptions::default()
            };
            Ok(Box::new(move || {
                let machine = Machine::new(machine).stopped_by(&stop);
                Box::new(Fast::new(options, Box::new(machine)).stopped_by(&stop))
            }))
        }
        EngineName::Machine => Ok(Box::new(move || {
            Box::new(Machine::new(machine).stopped_by(&stop))
        })),
        EngineName::Rays if args.rules.options(0).coverage.blends() => refused(
            "--engine rays casts one ray per sample and blends nothing: it has no --coverage alpha",
            "take --engine machine, which defines the picture, or fast, which has its bits",
        ),
        EngineName::Rays if args.rules.are_of_machine() => refused(
            "--engine rays draws exact coverage only, and has no --paper, --cage, --tolerance and --overflow",
            "take --engine machine for these rules",
        ),
        EngineName::Rays => Ok(Box::new(move || Box::new(Rays::stopped_by(&stop)))),
        EngineName::Far => refused(
            "--engine far draws a .far file, and only render, turntable and view do",
            "make one of a mesh: shiftvox convert MESH OUT.far; then shiftvox render OUT.far",
        ),
        EngineName::Textured => refused(
            "--engine textured draws a .tvx file, and only render, turntable and view do",
            "make one of a mesh: shiftvox convert MESH OUT.tvx; then shiftvox render OUT.tvx",
        ),
    }
}

pub(super) const MACHINE: Candidate = Candidate {
    name: "machine",
    about: "the paper's loop in machine words",
    work: "records",
    parallel: false,
    make: |_| Box::new(Machine::default()),
};

pub(super) const FAST: Candidate = Candidate {
    name: "fast",
    about: "the machine's bits, sample by sample",
    work: "records",
    parallel: true,
    make: |threads| fast(threads, |_| {}),
};

fn machine(switch: fn(&mut MachineOptions)) -> Box<dyn Engine + Send> {
    let mut options = MachineOptions::default();
    switch(&mut options);
    Box::new(Machine::new(options))
}

fn fast(threads: usize, switch: fn(&mut Switches)) -> Box<dyn Engine + Send> {
    let mut switches = Switches::default();
    switch(&mut switches);
    let options = FastOptions {
        threads,
        switches,
        ..FastOptions::default()
    };
    Box::new(Fast::new(options, Box::new(Machine::default())))
}

pub(super) const REFERENCE: Candidate = Candidate {
    name: "rays",
    about: "the exact reference, in wide integers",
    work: "nodes_tested",
    parallel: true,
    make: |_| Box::new(Rays::default()),
};

const FLOAT_RAYS: Candidate = Candidate {
    name: "float-rays",
    about: "an ordinary ray caster in f32",
    work: "steps",
    parallel: false,
    make: |_| Box::new(FloatRays),
};

const CANDIDATES: &[Candidate] = &[FAST, MACHINE, REFERENCE, FLOAT_RAYS];
pub(super) const MEASURED: [&str; 4] = ["fast", "machine", "rays", "float-rays"];

pub(super) fn names() -> PossibleValuesParser {
    let name = |c: &Candidate| PossibleValue::new(c.name).help(c.about);
    CANDIDATES.iter().map(name).collect::<Vec<_>>().into()
}

fn slug(variant: &Variant) -> String {
    variant.name.replace(' ', "-")
}

/// Reads a value of `--variants`: `all`, or a variant's name with hyphens.
pub(super) fn variant_name(text: &str) -> Result<String, String> {
    let variants = || FAST_VARIANTS.iter().chain(MACHINE_VARIANTS);
    if text == "all" || variants().any(|variant| slug(variant) == text) {
        return Ok(text.to_owned());
    }
    let lines = variants().map(|variant| format!("\n  {}: {}", slug(variant), variant.about));
    Err(format!(
        "expected all, or one of{}",
        lines.collect::<String>()
    ))
}

/// Engines by name with those of some variants that they have, by name or as values of flags.
pub(super) fn families(engines: &[String], variants: &[String]) -> Result<Vec<Family>, CliError> {
    let is_asked = |variant: &&Variant| {
        let mut asked = variants.iter();
        asked.any(|name| name == "all" || *name == slug(variant) || name == variant.name)
    };
    let family = |engine: &String| {
        let whole = CANDIDATES.iter().find(|candidate| candidate.name == engine);
        let whole = whole.ok_or_else(|| CliError::usage(format!("there is no engine `{engine}`")));
        let of: &[Variant] = match engine.as_str() {
            "fast" => FAST_VARIANTS,
            "machine" => MACHINE_VARIANTS,
            _ => &[],
        };
        Ok(Family {
            whole: *whole?,
            variants: of.iter().filter(is_asked).copied().collect(),
        })
    };
    let families = engines
        .iter()
        .map(family)
        .collect::<Result<Vec<Family>, CliError>>()?;
    if !variants.is_empty() && families.iter().all(|family| family.variants.is_empty()) {
        return Err(CliError::usage("none of these engines has such a variant"));
    }
    Ok(families)
}

const NO_LEVEL_OF_DETAIL: Variant = Variant {
    name: "level of detail off",
    about: "--lod 0: down to the leaves; the picture changes towards the exact one",
    adjust: |options| options.lod_px = 0.0,
    make: None,
};

const FAST_VARIANTS: &[Variant] = &[
    Variant {
        name: "hidden windows looked into",
        about: "occluded nodes are descended; the picture must be the same",
        make: Some(|threads| fast(threads, |on| on.hidden = false)),
        adjust: |_| {},
    },
    Variant {
        name: "bricks off",
        about: "voxel by voxel in the last levels; the picture must be the same",
        make: Some(|threads| fast(threads, |on| on.bricks = false)),
        adjust: |_| {},
    },
    NO_LEVEL_OF_DETAIL,
];

const MACHINE_VARIANTS: &[Variant] = &[
    Variant {
        name: "occlusion order off",
        about: "children in the order 0 to 7 for every eye: the picture is WRONG",
        make: Some(|_| machine(|options| options.order = [0, 1, 2, 3, 4, 5, 6, 7])),
        adjust: |_| {},
    },
    Variant {
        name: "fill-vector rejection off",
        about: "occluded records are descended; the picture must be the same",
        make: Some(|_| machine(|options| options.reject_filled = false)),
        adjust: |_| {},
    },
    NO_LEVEL_OF_DETAIL,
];
