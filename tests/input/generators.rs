//! Generated scenes: the benchmark's voxel for voxel, the others by what they promise.

use shiftvox::graph::{Silent, Voxel};
use shiftvox::scene::generate::{GENERATORS, Spec};
use std::collections::{HashMap, HashSet};
use xxhash_rust::xxh3::Xxh3;

type Colored = ([i32; 3], [u8; 3]);

/// All voxels of a spec, sorted; none is given twice.
fn scene(spec: &str) -> Vec<Colored> {
    let spec = Spec::parse(spec).expect(spec);
    let mut voxels = Vec::new();
    spec.voxels(
        &mut |Voxel {
                  index,
                  color,
                  normal,
              }| {
            assert_eq!(normal, None);
            voxels.push((index, color));
        },
        &Silent,
    );
    voxels.sort_unstable();
    assert!(
        voxels.is_sorted_by(|a, b| a.0 < b.0),
        "{spec} gives a voxel twice"
    );
    voxels
}

fn digest(voxels: &[Colored]) -> u64 {
    let mut hash = Xxh3::new();
    for (index, color) in voxels {
        index.iter().for_each(|c| hash.update(&c.to_le_bytes()));
        hash.update(color);
    }
    hash.digest()
}

fn filled(voxels: &[Colored]) -> HashSet<[i32; 3]> {
    voxels.iter().map(|v| v.0).collect()
}

/// Voxel counts and digests of the reference program's scenes.
const REFERENCE: [(&str, u32, usize, u64); 11] = [
    ("terrain", 5, 2_637, 0x9f32_f0b5_1907_22b5),
    ("terrain", 6, 11_998, 0xdadf_6386_4925_109f),
    ("terrain", 7, 55_125, 0x14e0_616b_c40a_3751),
    ("terrain", 8, 229_393, 0x24c1_2599_7dc5_b315),
    ("terrain", 9, 962_576, 0xc135_e4a0_688e_8330),
    ("terrain", 10, 3_892_443, 0x155c_ea14_aece_0de6),
    ("menger", 1, 20, 0x6003_ca20_19a2_5099),
    ("menger", 2, 400, 0xf5a4_7d09_31c9_5053),
    ("menger", 3, 8_000, 0x5672_4b03_55de_6be0),
    ("menger", 4, 160_000, 0x0112_0026_1f18_75de),
    ("menger", 5, 3_200_000, 0x0509_ac92_c690_7f2a),
];

#[test]
fn benchmark_scenes_have_the_reference_digests() {
    for (name, depth, count, expected) in REFERENCE {
        let voxels = scene(&format!("gen:{name},depth={depth}"));
        assert_eq!(voxels.len(), count, "{name} {depth}");
        assert_eq!(digest(&voxels), expected, "{name} {depth}");
    }
}

/// The other scenes at a small depth: nothing changes them unnoticed.
#[test]
fn scenes_do_not_change() {
    let expected: HashMap<&str, (usize, u64)> = HashMap::from([
        ("gen:checker,depth=4", (2048, 0x0c1e1f2597c6e497)),
        ("gen:maze,depth=5,seed=1", (1985, 0xc2dd0861c4b8b01e)),
        ("gen:maze,depth=5,seed=2", (1985, 0x1336c1db35424952)),
        (
            "gen:random,depth=5,density=10,seed=1",
            (3231, 0xc5aee2e5a598d65d),
        ),
        (
            "gen:random,depth=5,density=30,seed=9",
            (9744, 0x9f7f81477f105bd2),
        ),
        ("gen:shell,depth=5", (4496, 0xb763414f1220091f)),
        ("gen:sierpinski,depth=5", (1024, 0x0c11c01abbed9ec0)),
        ("gen:sphere,depth=5", (17256, 0x3da976b40d791ec7)),
        ("gen:terrain,depth=6,seed=2", (11901, 0x3048b781d36ece49)),
        ("gen:truss,depth=5", (6318, 0xf8338915bedea5b8)),
        ("gen:wires,depth=5", (2148, 0xb610b35e846605e1)),
    ]);
    for generator in GENERATORS {
        let start = format!("gen:{},", generator.name);
        let covered = expected.keys().any(|spec| spec.starts_with(&start));
        assert!(
            covered || generator.name == "menger",
            "{} has no digest",
            generator.name
        );
    }
    let mut wrong = Vec::new();
    for (spec, expected) in expected {
        let voxels = scene(spec);
        let got = (voxels.len(), digest(&voxels));
        if got != expected {
            wrong.push(format!("(\"{spec}\", ({}, {:#018x})),", got.0, got.1));
        }
    }
    wrong.sort();
    assert!(wrong.is_empty(), "now:\n{}", wrong.join("\n"));
}

#[test]
fn scenes_fit_their_cube_and_come_in_the_same_order() {
    for generator in GENERATORS {
        for depth in generator.keys[0].least..=6 {
            let spec =
                Spec::parse(&format!("gen:{},depth={depth}", generator.name)).expect("a spec");
            if generator.name == "menger" && depth > 4 {
                continue;
            }
            let order = || {
                let mut voxels = Vec::new();
                spec.voxels(&mut |voxel| voxels.push(voxel), &Silent);
                voxels
            };
            let voxels = order();
            assert_eq!(voxels, order());
            let side = if generator.name == "menger" {
                3i32.pow(depth)
            } else {
                1 << depth
            };
            assert!(
                voxels
                    .iter()
                    .flat_map(|v| v.index)
                    .all(|c| (0..side).contains(&c)),
                "{spec}"
            );
        }
    }
}

#[test]
fn seeds_and_densities_are_followed() {
    for name in ["terrain,depth=5", "random", "maze"] {
        let digests: HashSet<u64> = (0..8)
            .map(|seed| digest(&scene(&format!("gen:{name},seed={seed}"))))
            .collect();
        assert_eq!(digests.len(), 8, "{name}");
    }
    for (density, within) in [
        (0, 0),
        (1, 1000),
        (10, 1000),
        (50, 1000),
        (90, 1000),
        (100, 0),
    ] {
        let count = scene(&format!("gen:random,depth=6,density={density}")).len();
        let expected = 64 * 64 * 64 * density / 100;
        assert!(
            count.abs_diff(expected) <= within,
            "{density} percent: {count}"
        );
    }
}

#[test]
fn symmetric_scenes_are_symmetric() {
    for spec in [
        "sphere,depth=5",
        "shell,depth=6",
        "menger,depth=3",
        "truss,depth=5",
    ] {
        let voxels = filled(&scene(&format!("gen:{spec}")));
        let last = voxels.iter().flatten().max().copied().expect("voxels");
        for &[x, y, z] in &voxels {
            assert!(
                voxels.contains(&[y, x, z]) && voxels.contains(&[z, y, x]),
                "{spec}"
            );
            // The truss's cells are of two sizes and not in mirrored order.
            if !spec.starts_with("truss") {
                assert!(voxels.contains(&[last - x, y, z]), "{spec}");
            }
        }
    }
}

#[test]
fn a_ball_is_the_voxels_whose_centres_are_in_it() {
    for depth in 1..=5 {
        let side = 1i32 << depth;
        let voxels = filled(&scene(&format!("gen:sphere,depth={depth}")));
        for z in 0..side {
            for y in 0..side {
                for x in 0..side {
                    let off = [x, y, z].map(|c| (2 * c + 1 - side).pow(2));
                    let in_ball = off.iter().sum::<i32>() <= side * side;
                    assert_eq!(voxels.contains(&[x, y, z]), in_ball);
                }
            }
        }
    }
}

#[test]
fn the_shell_holds_water_over_faces_edges_and_corners() {
    for depth in 3..=6 {
        let side = 1i32 << depth;
        let shell = filled(&scene(&format!("gen:shell,depth={depth}")));
        let ball = filled(&scene(&format!("gen:sphere,depth={depth}")));
        assert!(shell.is_subset(&ball) && shell.len() < ball.len());
        // From outside, by steps over faces, edges and corners.
        let mut reached = HashSet::from([[-1, -1, -1]]);
        let mut rim = vec![[-1, -1, -1]];
        while let Some([x, y, z]) = rim.pop() {
            for step in 0..27 {
                let next = [x + step % 3 - 1, y + step / 3 % 3 - 1, z + step / 9 - 1];
                let in_reach = next.iter().all(|c| (-1..=side).contains(c));
                if in_reach && !shell.contains(&next) && reached.insert(next) {
                    rim.push(next);
                }
            }
        }
        assert!(
            reached.is_disjoint(&ball),
            "the shell of depth {depth} leaks"
        );
        // And it is no thicker than that needs: all of it is next to the outside.
        for &[x, y, z] in &shell {
            let outside = (0..27)
                .map(|step| [x + step % 3 - 1, y + step / 3 % 3 - 1, z + step / 9 - 1])
                .any(|next| !ball.contains(&next));
            assert!(outside);
        }
    }
}

#[test]
fn a_maze_has_one_way_between_any_two_rooms() {
    for (depth, seed) in [(2, 1), (4, 1), (5, 3), (6, 7)] {
        let side = (1i32 << depth) - 1;
        let voxels = filled(&scene(&format!("gen:maze,depth={depth},seed={seed}")));
        let open = |x: i32, y: i32| !voxels.contains(&[x, y, 1]);
        let squares = || (0..side).flat_map(|y| (0..side).map(move |x| (x, y)));
        assert!(squares().all(|(x, y)| voxels.contains(&[x, y, 0])));
        for (x, y) in squares() {
            let room = x % 2 == 1 && y % 2 == 1;
            let post = x % 2 == 0 && y % 2 == 0;
            let rim = x == 0 || y == 0 || x == side - 1 || y == side - 1;
            assert!(!room || open(x, y));
            assert!(!(post || rim) || !open(x, y));
        }
        let mut reached = HashSet::from([(1, 1)]);
        let mut rim = vec![(1, 1)];
        while let Some((x, y)) = rim.pop() {
            for next in [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)] {
                if open(next.0, next.1) && reached.insert(next) {
                    rim.push(next);
                }
            }
        }
        let open_squares = squares().filter(|&(x, y)| open(x, y)).count();
        let rooms = (side / 2).pow(2) as usize;
        // All reached, and a tree: one door less than rooms.
        assert_eq!(reached.len(), open_squares);
        assert_eq!(open_squares, 2 * rooms - 1);
    }
}

#[test]
fn wires_are_thin_and_whole() {
    let side = 64i32;
    let voxels = filled(&scene("gen:wires,depth=6"));
    for x in 0..side {
        let here = voxels.iter().filter(|v| v[0] == x).count();
        assert!((1..=81).contains(&here));
    }
    assert_eq!(voxels.iter().filter(|v| v[0] == 0).count(), 1);
    assert_eq!(voxels.iter().filter(|v| v[0] == side - 1).count(), 81);
    // Every voxel hangs on one nearer to the pivot.
    for &[x, y, z] in voxels.iter().filter(|v| v[0] > 0) {
        let held = (0..9).any(|n| voxels.contains(&[x - 1, y + n % 3 - 1, z + n / 3 - 1]));
        assert!(held, "({x}, {y}, {z}) floats");
    }
}

#[test]
fn a_truss_has_the_voxels_of_its_bars() {
    // 9 lines of 9 coordinates: along each axis 81 bars, joints counted once.
    for depth in [4, 5, 8] {
        let side = 1usize << depth;
        assert_eq!(
            scene(&format!("gen:truss,depth={depth}")).len(),
            3 * 81 * (side - 9) + 729
        );
    }
}

#[test]
fn the_cyclic_scene_is_one_node() {
    let spec = Spec::parse("gen:sierpinski").expect("a spec");
    let graph = spec.linked().expect("a graph with a cycle");
    assert_eq!((graph.len(), graph.depth, graph.voxels), (1, 30, 1 << 60));
    assert_eq!((graph.mask.len(), graph.normal.len()), (1, 1));
    let view = graph.view();
    let children: Vec<u8> = (0..8)
        .filter(|&octant| view.child(0, octant) == Some(0))
        .collect();
    assert_eq!(children, [0, 3, 5, 6]);
    // Voxels: where the bits of the three coordinates have an even sum, each by itself.
    let voxels = filled(&scene("gen:sierpinski,depth=4"));
    for [x, y, z] in (0..16 * 256).map(|i| [i >> 8, i >> 4 & 15, i & 15]) {
        assert_eq!(voxels.contains(&[x, y, z]), x ^ y ^ z == 0);
    }
    for other in GENERATORS.iter().filter(|g| g.name != "sierpinski") {
        let spec = Spec::parse(&format!("gen:{}", other.name)).expect("a spec");
        assert!(spec.linked().is_none());
    }
}
