//! `.vox` scene graphs that share nodes. Random ones are compared with a reader that goes down every path, places every
//! voxel by the format's rule, and keeps the last at an index. Small files place a model very often.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use shiftvox::graph::Silent;
use shiftvox::scene::{
    NoMeshes, OpenError, OpenOptions, Opened, ReadOptions, SceneError, open_bytes, read_voxels_from,
};
use shiftvox::split_mix::SplitMix;

use crate::input_support::{VoxFile, read, refused};

/// Numbers that depend on the seed alone.
struct Dice(SplitMix);

impl Dice {
    fn below(&mut self, end: u32) -> u32 {
        self.0.below(u64::from(end)) as u32
    }
}

enum Kind {
    /// Translation, rotation byte, child.
    Moves([i32; 3], u8, u32),
    Groups(Vec<u32>),
    Shows(Vec<u32>),
}

struct Model {
    size: [u32; 3],
    voxels: Vec<[u8; 4]>,
}

struct Graph {
    models: Vec<Model>,
    /// A child has a higher number than its parents; the last ones are shapes.
    nodes: Vec<Kind>,
}

fn rotation(dice: &mut Dice) -> u8 {
    let first = dice.below(3);
    let second = (first + 1 + dice.below(2)) % 3;
    (first | second << 2 | dice.below(8) << 4) as u8
}

impl Graph {
    fn random(seed: u64, inner: u32) -> Self {
        let mut dice = Dice(SplitMix::new(seed));
        // Small scenes overlap; large ones use all of a byte and of a translation.
        let [side, span] = [[3, 4], [256, 10_000]][usize::from(seed.is_multiple_of(4))];
        let models = (0..1 + dice.below(3)).map(|_| {
            let size = [0; 3].map(|_| 1 + dice.below(side));
            let voxels = (0..1 + dice.below(4)).map(|_| {
                let [x, y, z] = size.map(|side| dice.below(side) as u8);
                [x, y, z, dice.below(4) as u8]
            });
            let voxels = voxels.collect();
            Model { size, voxels }
        });
        let models: Vec<Model> = models.collect();
        let shapes = 1 + dice.below(3);
        let end = inner + shapes;
        let mut nodes = Vec::new();
        for number in 0..inner {
            let below = |dice: &mut Dice| number + 1 + dice.below((end - number - 1).min(4));
            nodes.push(if dice.below(2) == 0 {
                let by = [0; 3].map(|_| dice.below(span) as i32 - span as i32 / 2);
                Kind::Moves(by, rotation(&mut dice), below(&mut dice))
            } else {
                Kind::Groups((0..dice.below(4)).map(|_| below(&mut dice)).collect())
            });
        }
        for _ in 0..shapes {
            let shown = (0..1 + dice.below(2)).map(|_| dice.below(models.len() as u32));
            nodes.push(Kind::Shows(shown.collect()));
        }
        Self { models, nodes }
    }

    fn file(&self) -> VoxFile {
        let mut file = VoxFile::new();
        for model in &self.models {
            file = file.model(model.size, &model.voxels);
        }
        for (number, node) in (0..).zip(&self.nodes) {
            file = match node {
                Kind::Moves(by, rotation, child) => {
                    let by = by.map(|c| c.to_string()).join(" ");
                    let rotation = rotation.to_string();
                    file.transform(
                        number,
                        &[],
                        *child,
                        -1,
                        &[&[("_r", &rotation), ("_t", &by)]],
                    )
                }
                Kind::Groups(children) => file.group(number, children),
                Kind::Shows(models) => {
                    let models: Vec<_> = models.iter().map(|&model| (model, &[][..])).collect();
                    file.shape(number, &models)
                }
            };
        }
        file
    }

    /// The voxels below a node. `to` maps a centre, in half voxels, to its place.
    fn place(
        &self,
        number: u32,
        to: &dyn Fn([i64; 3]) -> [i64; 3],
        found: &mut BTreeMap<[i32; 3], u8>,
    ) {
        match &self.nodes[number as usize] {
            Kind::Moves(by, rotation, child) => {
                let [first, second] = [usize::from(rotation & 3), usize::from(rotation >> 2 & 3)];
                let from = [first, second, 3 - first - second];
                let moved = |v: [i64; 3]| {
                    to([0, 1, 2].map(|row| {
                        let turned = v[from[row]]
                            * if rotation >> (4 + row) & 1 == 1 {
                                -1
                            } else {
                                1
                            };
                        turned + 2 * i64::from(by[row])
                    }))
                };
                self.place(*child, &moved, found);
            }
            Kind::Groups(children) => {
                for &child in children {
                    self.place(child, to, found);
                }
            }
            Kind::Shows(models) => {
                for &model in models {
                    let Model { size, voxels } = &self.models[model as usize];
                    for [x, y, z, color] in voxels.iter().filter(|voxel| voxel[3] != 0) {
                        let p = [*x, *y, *z].map(i64::from);
                        let centre = [0, 1, 2].map(|k| 2 * (p[k] - i64::from(size[k] / 2)) + 1);
                        found.insert(to(centre).map(|c| (c >> 1) as i32), *color);
                    }
                }
            }
        }
    }
}

#[test]
fn shared_graphs_are_what_they_unfold_to() {
    let palette: Vec<[u8; 4]> = (1..=255).map(|i| [i, 0, 0, 255]).collect();
    for seed in 0..400 {
        let graph = Graph::random(seed, 1 + seed as u32 % 12);
        let mut expected = BTreeMap::new();
        graph.place(0, &|v| v, &mut expected);
        let file = graph.file().palette(&palette).bytes();
        let (voxels, info) = read(&file, &ReadOptions::default()).unwrap();
        let found: BTreeMap<[i32; 3], u8> = voxels.iter().map(|v| (v.index, v.color[0])).collect();
        assert_eq!(found, expected, "seed {seed}");
        assert!(info.voxels <= info.instances as u64 * 4, "seed {seed}");
    }
}

fn open(file: &[u8]) -> Result<Opened, OpenError> {
    open_bytes(file, "a.vox", &OpenOptions::default(), &NoMeshes, &Silent)
}

#[test]
fn graphs_of_any_sharing_are_read_or_refused_in_time() {
    let started = Instant::now();
    for seed in 0..60 {
        let file = Graph::random(1000 + seed, 30 + seed as u32 * 4)
            .file()
            .bytes();
        // Some hold no voxels, and how much memory is free decides of others.
        if let Ok(opened) = open(&file) {
            assert!(opened.graph.voxels < 1 << 24);
        }
    }
    let took = started.elapsed();
    assert!(took < Duration::from_secs(30), "{took:?}");
}

/// One slab of 256 x 256, placed `2^levels` times: each level is a group whose children are twice the next one,
/// moved by the two translations.
fn slab(levels: u32, apart: [&str; 2]) -> Vec<u8> {
    let voxels: Vec<[u8; 4]> = (0..=255u8)
        .flat_map(|y| (0..=255).map(move |x| [x, y, 0, 1]))
        .collect();
    let mut file = VoxFile::new().model([256, 256, 1], &voxels);
    file = file.transform(0, &[], 1, -1, &[&[]]);
    for level in 0..levels {
        let group = 1 + 3 * level;
        file = file.group(group, &[group + 1, group + 2]);
        for (side, by) in [(1, apart[0]), (2, apart[1])] {
            let by = by.replace('N', &(1u64 << level).to_string());
            file = file.transform(group + side, &[], group + 3, -1, &[&[("_t", &by)]]);
        }
    }
    file.shape(1 + 3 * levels, &[(0, &[])]).bytes()
}

#[test]
fn a_model_at_one_place_costs_once_however_often_it_is_placed_there() {
    let file = slab(17, ["0 0 0", "0 0 0"]);
    let (voxels, info) = read(&file, &ReadOptions::default()).unwrap();
    assert_eq!((voxels.len(), info.instances), (65_536, 1 << 17));
    let said = "131071 placements put a model where it is already";
    assert!(info.warnings[0].starts_with(said), "{:?}", info.warnings);
    assert_eq!(open(&file).unwrap().graph.voxels, 65_536);
}

#[test]
fn more_voxels_than_are_wanted_are_refused_before_the_first() {
    let file = slab(10, ["0 0 0", "0 0 N"]);
    let all = 65_536 << 10;
    let count = |most_voxels| {
        let options = ReadOptions {
            most_voxels,
            ..ReadOptions::default()
        };
        let mut seen = 0u64;
        let read = read_voxels_from(&file, "slab", &options, &mut |_| seen += 1, &Silent);
        (read, seen)
    };
    let (refused, seen) = count(all - 1);
    let refused = refused.unwrap_err();
    assert!(matches!(refused, SceneError::TooMany { voxels, .. } if voxels == all));
    assert!(refused.is_limit() && seen == 0, "{refused}");
    let (read, seen) = count(all);
    assert_eq!((read.unwrap().voxels, seen), (all, all));
    // 2^17 places a voxel apart: 2^33 voxels.
    let refused = open(&slab(17, ["0 0 0", "0 0 N"])).unwrap_err();
    let told = refused.to_string();
    assert!(
        refused.is_limit() && told.starts_with("a.vox: 8589934592 voxels or more"),
        "{told}"
    );
}

#[test]
fn shared_nodes_and_models_count_as_visits() {
    // Groups one below the other, of twice the next one each.
    let tower = |floors: u32, models: usize| {
        let mut file = VoxFile::new().model([1, 1, 1], &[[0, 0, 0, 1]]);
        for floor in 0..floors {
            file = file.group(floor, &[floor + 1, floor + 1]);
        }
        file.shape(floors, &vec![(0, &[][..]); models]).bytes()
    };
    // All at one place, so that they are read once.
    let (voxels, info) = read(&tower(5, 1), &ReadOptions::default()).unwrap();
    assert_eq!((voxels.len(), info.instances), (1, 32));
    let limit = "at most 1048576 placed nodes";
    refused([(tower(40, 1), limit), (tower(17, 256), limit)]);
    assert!(
        read(&tower(40, 1), &ReadOptions::default())
            .unwrap_err()
            .is_limit()
    );
}
