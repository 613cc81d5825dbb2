//! Whole frames in Verilator against the machine: every event with all its bits, in order; the picture; the cycles.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use serde_json::Value;
use tempfile::TempDir;

use super::tools::{is_there, rtl, run, shiftvox, text};

/// A machine of `rtl/`: its folder and its hardware's file, the rules that it draws by, where its modules are.
struct Machine {
    name: &'static str,
    rules: &'static [&'static str],
    folders: &'static [&'static str],
    /// Its simulator, made once.
    made: OnceLock<(TempDir, PathBuf)>,
}

static STAGE_A: Machine = Machine {
    name: "stage_a",
    rules: &["--paper"],
    folders: &["machine", "stage_a", "blocks"],
    made: OnceLock::new(),
};
static STAGE_B: Machine = Machine {
    name: "stage_b",
    rules: &["--coverage", "exact", "--cage", "frame"],
    folders: &["machine", "stage_b", "blocks_exact", "blocks"],
    made: OnceLock::new(),
};

impl Machine {
    /// The simulator of words of 32 bits, for pictures up to 256 x 256.
    fn simulator(&self) -> &str {
        let (_, path) = self.made.get_or_init(|| {
            let shelter = tempfile::tempdir().unwrap();
            let arguments = "--binary -O3 --x-assign fast --x-initial fast -CFLAGS -O1 -Wno-fatal -Wno-WIDTH \
                             --top-module frame_tb tb/frame_tb.v -o frame -I. --Mdir";
            let mut arguments: Vec<String> =
                arguments.split_whitespace().map(str::to_owned).collect();
            arguments.push(text(shelter.path()).to_owned());
            arguments.extend(self.folders.iter().map(|folder| format!("-I{folder}")));
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            run(&rtl(), "verilator", &arguments);
            let path = shelter.path().join("frame");
            (shelter, path)
        });
        text(path)
    }
}

/// What crossed a port, the first number; and where, and what, as far as the simulation writes it down.
type Event = (u8, u64, String);

/// Hexadecimal digits of a record's box in screen space, and of its planes, which come last: words of 32 and 64 bits.
const BOX: usize = 4 * 8;
const PLANES: usize = 12 * 16;

/// Events of a frame from its vectors.
fn expected_events(folder: &Path) -> Vec<Event> {
    let rows = |name: &str| {
        let text = fs::read_to_string(folder.join(name)).unwrap();
        let rows = text.lines().filter(|line| !line.starts_with("//"));
        rows.map(str::to_owned).collect::<Vec<_>>()
    };
    let records = rows("turns.records.hex");
    rows("turns.ports.hex")
        .iter()
        .map(|row| {
            // 3 bits of port, 32 of address, 40 of data.
            let row = u128::from_str_radix(row, 16).unwrap();
            let (port, address) = ((row >> 72) as u8, (row >> 40) as u64 & 0xffff_ffff);
            let data = row as u64 & 0xff_ffff_ffff;
            let data = match port {
                1 => records[data as usize].trim_start_matches('0').to_owned(),
                3 => format!("{data:x}"),
                6 => data.to_string(),
                _ => String::new(),
            };
            (port, address, data)
        })
        .collect()
}

/// Events that the simulation wrote down. Of a record stage A has no planes, and B no box in screen space.
fn simulated_events(folder: &Path, machine: &Machine) -> Vec<Event> {
    let text = fs::read_to_string(folder.join("events.txt")).unwrap();
    text.lines()
        .map(|line| {
            let mut words = line.split(' ');
            let mut next = || words.next().unwrap_or_default();
            let (port, address) = (next().parse().unwrap(), next().parse().unwrap());
            let mut data = next().to_owned();
            if port == 1 {
                let more = next();
                let (no_box, no_planes) = match machine.name {
                    "stage_a" => (0, PLANES),
                    _ => (BOX, 0),
                };
                data += &"0".repeat(no_box);
                // Before the box is a bit that was written down already.
                data += &more[more.len() - (BOX + PLANES - no_box - no_planes)..];
                data += &"0".repeat(no_planes);
                data = data.trim_start_matches('0').to_owned();
            }
            (port, address, data)
        })
        .collect()
}

/// Whole numbers of a `.npy` file.
fn numbers(path: &Path) -> Vec<i32> {
    let bytes = fs::read(path).unwrap();
    let head = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let number = |bytes: &[u8]| i32::from_le_bytes(bytes.try_into().unwrap());
    bytes[head..].chunks_exact(4).map(number).collect()
}

/// What a frame showed.
#[derive(Debug)]
struct Agreement {
    events: usize,
    samples: usize,
    /// Simulated hardware, cycle model.
    cycles: [u64; 2],
}

/// Draws a view on the hardware and on the machine, and compares all but the cycles. `simulator`: the command that
/// runs it. `Err`: what differs.
fn compare(
    machine: &Machine,
    simulator: &[&str],
    view: &[&str],
) -> Result<Agreement, String> {
    let shelter = tempfile::tempdir().unwrap();
    let folder = shelter.path().join("frame");
    let hardware = rtl().join(format!("{}.toml", machine.name));
    let common = [view, machine.rules, &["--bits", "32"]].concat();
    let rows = [
        "--vectors",
        text(&folder),
        "--vector-records",
        "100000000",
        "--json",
    ];
    let of_model = [&["model", "--hw", text(&hardware)], &common[..], &rows].concat();
    let model: Value = serde_json::from_str(&shiftvox(shelter.path(), &of_model)).unwrap();
    let of_render = [
        "--engine",
        "machine",
        "-o",
        "picture.png",
        "--aov",
        "node,voxel",
    ];
    shiftvox(
        shelter.path(),
        &[&["render"], &common[..], &of_render].concat(),
    );

    let (program, arguments) = simulator.split_first().unwrap();
    let printed = run(&folder, program, &[arguments, &["+events"]].concat());
    let cycles = printed
        .lines()
        .find_map(|line| line.strip_suffix(" cycles"));
    let cycles = cycles
        .ok_or_else(|| printed.clone())?
        .trim()
        .parse()
        .unwrap();

    let (expected, simulated) = (expected_events(&folder), simulated_events(&folder, machine));
    let pairs = expected.iter().zip(&simulated);
    if let Some(at) = pairs
        .clone()
        .position(|(expected, simulated)| expected != simulated)
    {
        let (expected, simulated) = (&expected[at], &simulated[at]);
        return Err(format!("event {at}: {simulated:?}, not {expected:?}"));
    }
    if expected.len() != simulated.len() {
        return Err(format!(
            "{} events, not {}",
            simulated.len(),
            expected.len()
        ));
    }

    let nodes = numbers(&shelter.path().join("picture.node.npy"));
    let voxels = numbers(&shelter.path().join("picture.voxel.npy"));
    let mut drawn = vec![-1i32; nodes.len()];
    // From the object's lowest corner to the file's indices: the same for all.
    let mut moved = None;
    for line in fs::read_to_string(folder.join("pixels.txt"))
        .unwrap()
        .lines()
    {
        let pixel: Vec<i32> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        let [at, node, x, y, z, level] = pixel[..] else {
            return Err(format!("pixel {line}"));
        };
        let at = at as usize;
        drawn[at] = node;
        let [ix, iy, iz, shown] = voxels[4 * at..][..4] else {
            unreachable!("four numbers a sample");
        };
        let by = [ix - x, iy - y, iz - z];
        if shown != level || *moved.get_or_insert(by) != by {
            return Err(format!("sample {at} shows voxel {x}, {y}, {z}, {level}"));
        }
    }
    if drawn != nodes {
        return Err("other samples are drawn".to_owned());
    }
    Ok(Agreement {
        events: simulated.len(),
        samples: drawn.iter().filter(|&&node| node >= 0).count(),
        cycles: [
            cycles,
            model["simulated"]["cycles"]["cycles"]
                .as_u64()
                .unwrap_or_default(),
        ],
    })
}

/// As [`compare`], on the machine's own simulator; the cycles are equal, too.
fn agree(machine: &Machine, view: &[&str]) -> Agreement {
    let agreement = compare(machine, &[machine.simulator()], view)
        .unwrap_or_else(|error| panic!("{} {view:?}: {error}", machine.name));
    eprintln!("{} {view:?}: {agreement:?}", machine.name);
    assert_eq!(
        agreement.cycles[0], agreement.cycles[1],
        "{} {view:?}",
        machine.name
    );
    agreement
}

const TREE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/tree.vox");
/// In the middle of the sponge's hollow, looking at a corner of it.
const INSIDE: [&str; 7] = [
    "gen:menger,depth=3",
    "--size",
    "64",
    "--eye",
    "13.4,12.7,13.5",
    "--target",
    "20,16,11",
];

#[test]
fn the_bundled_tree_has_the_machines_events_picture_and_cycles() {
    if !is_there("verilator") {
        return;
    }
    let agreement = agree(&STAGE_A, &[TREE, "--size", "64"]);
    assert!(agreement.events > 1_000_000 && agreement.samples > 1000);
}

#[test]
fn an_eye_inside_too() {
    if !is_there("verilator") {
        return;
    }
    agree(&STAGE_A, &INSIDE);
}

/// Faults in what connects the blocks: file, text, what somebody might have written.
const FAULTS: [(&str, &str, &str); 9] = [
    ("machine", "r_node : first + count", "r_node : first"),
    ("machine", "marked <= after", "marked <= vector"),
    (
        "machine",
        "for (r = 7; r >= 0; r = r - 1)",
        "for (r = 0; r < 8; r = r + 1)",
    ),
    ("cache", "valid[{set, way}] <= 1", "valid[{set, way}] <= 0"),
    ("memory", "<= data_in", "<= ~data_in"),
    ("verdict", "one & ~before_near", "~before_near"),
    ("image_step", ".low_half_x(half[0])", ".low_half_x(half[2])"),
    ("to_screen", "(column - 4)", "(column - 3)"),
    ("frame_constants", "vector[3 + i]", "vector[4 + i]"),
];

/// A small frame, in Icarus Verilog: as it is, and with each fault.
#[test]
fn a_fault_between_the_blocks_is_found() {
    if !is_there("iverilog") {
        return;
    }
    let machine = &STAGE_A;
    let view = ["gen:menger,depth=2", "--size", "7x8", "--view", "iso"];
    let shelter = tempfile::tempdir().unwrap();
    let modules = shelter.path();
    let compiled = modules.join("frame.vvp");
    let nothing = ("", "", "");
    for (file, right, fault) in [nothing].into_iter().chain(FAULTS) {
        // Of modules in several folders the first counts.
        for folder in machine.folders.iter().rev() {
            for path in fs::read_dir(rtl().join(folder)).unwrap() {
                let path = path.unwrap().path();
                let mut source = fs::read_to_string(&path).unwrap();
                if path.file_stem().unwrap() == file {
                    assert_eq!(source.matches(right).count(), 1, "{file}: {right}");
                    source = source.replace(right, fault);
                }
                fs::write(modules.join(path.file_name().unwrap()), source).unwrap();
            }
        }
        let arguments = "-g2012 -I . -s frame_tb tb/frame_tb.v -o";
        let mut arguments: Vec<&str> = arguments.split(' ').collect();
        let modules = text(modules);
        arguments.extend([text(&compiled), "-I", modules, "-y", modules]);
        run(&rtl(), "iverilog", &arguments);
        let simulator = ["vvp", "-n", text(&compiled), "+most=200000"];
        let compared = compare(machine, &simulator, &view);
        let is_right = compared.is_ok_and(|agreement| agreement.cycles[0] == agreement.cycles[1]);
        assert_eq!(is_right, file.is_empty(), "{file}: {fault}");
    }
}

/// The bundled tree, a sponge, terrain, and an eye within them; sizes that fill the picture's quadtree and that do not.
#[test]
#[ignore = "takes minutes"]
fn many_scenes() {
    if !is_there("verilator") {
        return;
    }
    let views: [&[&str]; 6] = [
        &[TREE, "--size", "128"],
        &[
            TREE,
            "--size",
            "200x90",
            "--azimuth",
            "80",
            "--elevation",
            "-20",
        ],
        &["gen:menger,depth=4", "--size", "96", "--view", "iso"],
        &[
            "gen:terrain,depth=7",
            "--size",
            "128x64",
            "--lod",
            "0",
            "--view",
            "right",
        ],
        &[
            "gen:terrain,depth=6",
            "--size",
            "64",
            "--eye",
            "20.2,30.7,25.1",
            "--target",
            "40,40,10",
        ],
        &[
            "gen:menger,depth=3",
            "--size",
            "50x70",
            "--lod",
            "4",
            "--zoom",
            "6",
        ],
    ];
    for view in views {
        agree(&STAGE_A, view);
    }
}

/// Scattered voxels by seed, from all sides and from within, at random sizes and levels of detail.
#[test]
#[ignore = "takes minutes"]
fn two_hundred_random_views() {
    if !is_there("verilator") {
        return;
    }
    let mut state = 1u64;
    let mut next = |most: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % most
    };
    let mut unlike = 0;
    for at in 0..200 {
        let scene = format!("gen:random,depth={},seed={}", 2 + next(4), next(1000));
        let size = format!("{}x{}", 1 + next(60), 1 + next(60));
        let lod = ["0", "1", "3"][next(3) as usize];
        let [azimuth, elevation, zoom] = [next(360), next(180), 1 + next(8)].map(|n| n.to_string());
        let elevation = (elevation.parse::<i64>().unwrap() - 90).to_string();
        let elevation = format!("--elevation={elevation}");
        let view = [
            &scene,
            "--size",
            &size,
            "--lod",
            lod,
            "--azimuth",
            &azimuth,
            &elevation,
            "--zoom",
            &zoom,
        ];
        let agreement =
            compare(&STAGE_A, &[STAGE_A.simulator()], &view).unwrap_or_else(|error| panic!("{at} {view:?}: {error}"));
        let [simulated, model] = agreement.cycles;
        if simulated != model {
            eprintln!("{at} {view:?}: {simulated} cycles, {model} in the model");
            unlike += 1;
        }
    }
    eprintln!("200 random views: all events and pictures equal; cycles unlike in {unlike}");
    assert_eq!(unlike, 0);
}
