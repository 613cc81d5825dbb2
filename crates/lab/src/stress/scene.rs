//! Scenes that are hard on a renderer, each a line of text.

use std::fmt;
use std::str::FromStr;

use shiftvox::graph::{
    BuildOptions, Builder, Graph, LinkedGraph, MAX_DEPTH, Normals, Silent, Voxel,
};
use shiftvox::scene::generate::Spec;
use shiftvox::split_mix::SplitMix;

#[derive(Debug, Clone, PartialEq)]
pub enum StressScene {
    Generated(Spec),
    /// A plane through the cube's middle: `plane:depth,a,b,c` with its normal, c not 0. No line passes through, not even at
    /// corners.
    Plane {
        depth: u32,
        normal: [i64; 3],
    },
    /// A full cube, one node that is all of its own children: `solid:depth`.
    Solid {
        depth: u32,
    },
    /// A random graph whose nodes have any nodes as children: `cyclic:depth,seed`.
    Cyclic {
        depth: u32,
        seed: u64,
    },
    /// A few voxels: `voxels:depth,x.y.z+x.y.z`.
    Voxels {
        depth: u32,
        at: Vec<[i32; 3]>,
    },
}

const MOST_LISTED_DEPTH: u32 = 20;
const MOST_PLANE_DEPTH: u32 = 10;

impl fmt::Display for StressScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Generated(spec) => spec.fmt(f),
            Self::Plane {
                depth,
                normal: [a, b, c],
            } => write!(f, "plane:{depth},{a},{b},{c}"),
            Self::Solid { depth } => write!(f, "solid:{depth}"),
            Self::Cyclic { depth, seed } => write!(f, "cyclic:{depth},{seed}"),
            Self::Voxels { depth, at } => {
                let voxels: Vec<String> =
                    at.iter().map(|[x, y, z]| format!("{x}.{y}.{z}")).collect();
                write!(f, "voxels:{depth},{}", voxels.join("+"))
            }
        }
    }
}

impl FromStr for StressScene {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
        if kind == "gen" {
            return Spec::parse(text)
                .map(Self::Generated)
                .map_err(|e| e.to_string());
        }
        let wrong = || {
            format!(
                "`{text}` is no scene: gen:..., plane:depth,a,b,c, solid:depth, \
                 cyclic:depth,seed or voxels:depth,x.y.z+x.y.z"
            )
        };
        let (depth, rest) = rest.split_once(',').unwrap_or((rest, ""));
        let depth: u32 = depth.parse().map_err(|_| wrong())?;
        let most = match kind {
            "plane" => MOST_PLANE_DEPTH,
            "voxels" => MOST_LISTED_DEPTH,
            _ => MAX_DEPTH,
        };
        if depth > most {
            return Err(format!("`{text}`: at most {most} levels"));
        }
        match kind {
            "solid" if rest.is_empty() => Ok(Self::Solid { depth }),
            "cyclic" => Ok(Self::Cyclic {
                depth,
                seed: rest.parse().map_err(|_| wrong())?,
            }),
            "plane" => {
                let numbers: Vec<i64> = rest
                    .split(',')
                    .map(|n| n.parse().ok().filter(|n: &i64| n.abs() < 1 << 20))
                    .collect::<Option<_>>()
                    .ok_or_else(wrong)?;
                match numbers[..] {
                    [a, b, c] if c != 0 => Ok(Self::Plane {
                        depth,
                        normal: [a, b, c],
                    }),
                    _ => Err(wrong()),
                }
            }
            "voxels" => {
                let voxel = |text: &str| -> Option<[i32; 3]> {
                    let at: Vec<i32> = text
                        .split('.')
                        .map(|c| c.parse().ok().filter(|c| (0..1 << depth).contains(c)))
                        .collect::<Option<_>>()?;
                    at.try_into().ok()
                };
                let at = rest
                    .split('+')
                    .map(voxel)
                    .collect::<Option<_>>()
                    .ok_or_else(wrong)?;
                Ok(Self::Voxels { depth, at })
            }
            _ => Err(wrong()),
        }
    }
}

impl StressScene {
    /// Whether its surface is closed: no line of sight passes between its
    /// voxels where the oracle's rays next to it do not.
    pub(super) fn is_closed(&self) -> bool {
        match self {
            Self::Plane { .. } | Self::Solid { .. } => true,
            Self::Generated(spec) => matches!(spec.generator().name, "sphere" | "shell"),
            Self::Cyclic { .. } | Self::Voxels { .. } => false,
        }
    }

    /// Makes it. Fails in words, where there is nothing to draw or too much.
    pub(super) fn graph(&self) -> Result<Graph, String> {
        match self {
            Self::Generated(spec) => match spec.linked() {
                Some(graph) => Ok(graph),
                None => {
                    let mut at = Vec::new();
                    spec.voxels(&mut |voxel| at.push(voxel.index), &Silent);
                    built(at)
                }
            },
            Self::Plane { depth, normal } => built(plane(*depth, *normal)),
            Self::Solid { depth } => {
                let mut graph = LinkedGraph::new(*depth);
                graph.add_node([90, 160, 200], [Some(0); 8]);
                graph.build().map_err(|e| e.to_string())
            }
            Self::Cyclic { depth, seed } => cyclic(*depth, *seed),
            Self::Voxels { depth, at } => listed(*depth, at),
        }
    }

    /// The same scene as a list of voxels, if it has no more than `most`.
    pub(super) fn as_voxels(&self, most: usize) -> Option<Self> {
        let graph = self.graph().ok()?;
        // A cyclic scene's voxels may be too many to walk through.
        if graph.voxels > most as u64 || graph.depth > MOST_LISTED_DEPTH {
            return None;
        }
        let mut at = Vec::new();
        for cell in graph.voxels() {
            let side = 1i32 << (graph.depth - cell.level);
            for i in 0..side * side * side {
                let offset = [i / (side * side), i / side % side, i % side];
                at.push([0, 1, 2].map(|k| cell.corner[k] + offset[k]));
                if at.len() > most {
                    return None;
                }
            }
        }
        at.sort_unstable();
        Some(Self::Voxels {
            depth: graph.depth,
            at,
        })
    }
}

fn built(voxels: Vec<[i32; 3]>) -> Result<Graph, String> {
    let mut builder = Builder::new(BuildOptions {
        normals: Normals::None,
    });
    for index in voxels {
        builder.push(Voxel {
            index,
            color: [200, 120, 60],
            normal: None,
        });
    }
    let graph = builder.finish(([0.0; 3], 1.0), &Silent);
    graph.map_err(|e| e.to_string())
}

/// A tree of exactly so many levels, whatever the voxels' extent.
fn listed(depth: u32, at: &[[i32; 3]]) -> Result<Graph, String> {
    if at.is_empty() {
        return Err("a scene needs a voxel".to_owned());
    }
    let mut children: Vec<[Option<u32>; 8]> = vec![[None; 8]];
    for voxel in at {
        let mut node = 0usize;
        for bit in (0..depth).rev() {
            let octant = voxel
                .iter()
                .fold(0, |octant, c| octant << 1 | (c >> bit & 1) as usize);
            node = match children[node][octant] {
                Some(child) => child as usize,
                None => {
                    children.push([None; 8]);
                    let child = children.len() as u32 - 1;
                    children[node][octant] = Some(child);
                    child as usize
                }
            };
        }
    }
    let mut graph = LinkedGraph::new(depth);
    for children in children {
        graph.add_node([200, 120, 60], children);
    }
    graph.build().map_err(|e| e.to_string())
}

/// All voxels `p` with `0 <= normal p - middle < |normal|` (the sum of magnitudes).
fn plane(depth: u32, normal: [i64; 3]) -> Vec<[i32; 3]> {
    let mut voxels = Vec::new();
    let side = 1i64 << depth;
    let thickness: i64 = normal.iter().map(|n| n.abs()).sum();
    let offset = normal.iter().sum::<i64>() * side / 2;
    for x in 0..side {
        for y in 0..side {
            let rest = normal[0] * x + normal[1] * y - offset;
            for z in 0..side {
                if (0..thickness).contains(&(rest + normal[2] * z)) {
                    voxels.push([x as i32, y as i32, z as i32]);
                }
            }
        }
    }
    voxels
}

/// Up to eight nodes, a third of whose children exist, any nodes each.
fn cyclic(depth: u32, seed: u64) -> Result<Graph, String> {
    let mut numbers = SplitMix::new(seed);
    let nodes = 1 + numbers.below(8);
    let mut graph = LinkedGraph::new(depth);
    for node in 0..nodes {
        let children = std::array::from_fn(|_| {
            let exists = numbers.below(3) == 0 || node == 0 && numbers.below(3) == 0;
            exists.then(|| numbers.below(nodes) as u32)
        });
        let shade = (node * 30) as u8;
        graph.add_node([255 - shade, shade, 120], children);
    }
    graph.build().map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_what_their_text_says() {
        for (text, depth) in [
            ("gen:shell,depth=4", 4),
            ("plane:4,3,5,7", 4),
            ("solid:30", 30),
            ("cyclic:6,3", 6),
            ("voxels:2,0.0.0+3.1.2", 2),
        ] {
            let scene: StressScene = text.parse().unwrap();
            assert_eq!(scene.to_string(), text);
            let graph = scene.graph().unwrap();
            assert_eq!(graph.depth, depth, "{text}");
            // The same voxels as a list, if they are few.
            let listed = scene.as_voxels(1000);
            assert_eq!(listed.is_some(), graph.voxels <= 1000, "{text}");
            let voxels = |graph: Graph| {
                let mut at: Vec<_> = graph.voxels().map(|cell| cell.corner).collect();
                at.sort_unstable();
                at
            };
            if let Some(listed) = listed {
                assert_eq!(voxels(graph), voxels(listed.graph().unwrap()), "{text}");
            }
        }
        for bad in "plane:4,1,1,0 solid:31 voxels:2,4.0.0 voxels:2, cube gen:x".split(' ') {
            assert!(bad.parse::<StressScene>().is_err(), "{bad}");
        }
    }
}
