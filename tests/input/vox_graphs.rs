//! Random `.vox` scene graphs that share nodes, against a reader that knows nothing of sharing: it goes down every path,
//! places every voxel by the format's rule, and the last at an index counts.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use crate::input_support::{VoxFile, read};
use shiftvox::graph::Silent;
use shiftvox::scene::{NoMeshes, OpenOptions, ReadOptions, open_bytes};
use shiftvox::split_mix::SplitMix;

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
        for _ in 0..4 {
            dice.below(2);
        }
        let models = (0..1 + dice.below(3)).map(|_| {
            let size = [0; 3].map(|_| 1 + dice.below(3));
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
                let by = [0; 3].map(|_| dice.below(4) as i32 - 2);
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

    fn bytes(&self) -> Vec<u8> {
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
        file.bytes()
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
    for seed in 0..300 {
        let graph = Graph::random(seed, 1 + seed as u32 % 12);
        let mut expected = BTreeMap::new();
        graph.place(0, &|v| v, &mut expected);
        let mut file = graph.bytes();
        // The palette comes last, in the same chunk.
        let chunk = VoxFile::new().palette(&palette).bytes();
        file.extend(&chunk[20..]);
        let length = (file.len() - 20) as u32;
        file[16..20].copy_from_slice(&length.to_le_bytes());
        let (voxels, info) = read(&file, &ReadOptions::default()).unwrap();
        let found: BTreeMap<[i32; 3], u8> = voxels.iter().map(|v| (v.index, v.color[0])).collect();
        assert_eq!(found, expected, "seed {seed}");
        assert!(info.voxels <= info.instances as u64 * 4, "seed {seed}");
    }
}

#[test]
fn graphs_of_any_sharing_are_read_or_refused_in_time() {
    let started = Instant::now();
    for seed in 0..60 {
        let file = Graph::random(1000 + seed, 30 + seed as u32 * 4).bytes();
        // Some hold no voxels, and how much memory is free decides of others.
        if let Ok(opened) = open_bytes(&file, "a.vox", &OpenOptions::default(), &NoMeshes, &Silent)
        {
            assert!(opened.graph.voxels < 1 << 24);
        }
    }
    assert!(
        started.elapsed() < Duration::from_secs(30),
        "{:?}",
        started.elapsed()
    );
}
