//! Scenes that are hard on a renderer, each a line of text.

use std::fmt;
use std::str::FromStr;

use shiftvox::graph::{Builder, Graph, LinkedGraph, MAX_DEPTH, Silent, Voxel};
use shiftvox::scene::generate::Spec;
use shiftvox::split_mix::SplitMix;

#[derive(Debug, Clone, PartialEq)]
pub enum StressScene {
    /// A specification.
    Generated(String),
    /// A plane through the cube's middle: `plane:depth,a,b,c` with its normal, c not 0. No line passes through, not even at
    /// corners.
    Plane { depth: u32, normal: [i64; 3] },
    /// A full cube, one node that is all of its own children: `solid:depth`.
    Solid { depth: u32 },
    /// A random graph whose nodes have any nodes as children: `cyclic:depth,seed`.
    Cyclic { depth: u32, seed: u64 },
}

const MOST_PLANE_DEPTH: u32 = 10;

impl fmt::Display for StressScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Generated(spec) => f.write_str(spec),
            Self::Plane {
                depth,
                normal: [a, b, c],
            } => write!(f, "plane:{depth},{a},{b},{c}"),
            Self::Solid { depth } => write!(f, "solid:{depth}"),
            Self::Cyclic { depth, seed } => write!(f, "cyclic:{depth},{seed}"),
        }
    }
}

impl FromStr for StressScene {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, rest) = text.split_once(':').unwrap_or((text, ""));
        if kind == "gen" {
            Spec::parse(text).map_err(|e| e.to_string())?;
            return Ok(Self::Generated(text.to_owned()));
        }
        let wrong = || {
            format!(
                "`{text}` is no scene: gen:..., plane:depth,a,b,c, solid:depth \
                 or cyclic:depth,seed"
            )
        };
        let (depth, rest) = rest.split_once(',').unwrap_or((rest, ""));
        let depth: u32 = depth.parse().map_err(|_| wrong())?;
        let most = match kind {
            "plane" => MOST_PLANE_DEPTH,
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
            Self::Generated(spec) => ["gen:sphere", "gen:shell"]
                .iter()
                .any(|of| spec.starts_with(of)),
            Self::Cyclic { .. } => false,
        }
    }

    /// Makes it. Fails in words, where there is nothing to draw or too much.
    pub(super) fn graph(&self) -> Result<Graph, String> {
        match self {
            Self::Generated(spec) => {
                let spec = Spec::parse(spec).map_err(|e| e.to_string())?;
                match spec.linked() {
                    Some(graph) => Ok(graph),
                    None => {
                        let mut at = Vec::new();
                        spec.voxels(&mut |voxel| at.push(voxel.index), &Silent);
                        built(at)
                    }
                }
            }
            Self::Plane { depth, normal } => built(plane(*depth, *normal)),
            Self::Solid { depth } => {
                let mut graph = LinkedGraph::new(*depth);
                graph.add_node([90, 160, 200], [Some(0); 8]);
                graph.build().map_err(|e| e.to_string())
            }
            Self::Cyclic { depth, seed } => cyclic(*depth, *seed),
        }
    }
}

fn built(voxels: Vec<[i32; 3]>) -> Result<Graph, String> {
    let mut builder = Builder::default();
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
        ] {
            let scene: StressScene = text.parse().unwrap();
            assert_eq!(scene.to_string(), text);
            assert_eq!(scene.graph().unwrap().depth, depth, "{text}");
        }
        for bad in "plane:4,1,1,0 solid:31 cube gen:x".split(' ') {
            assert!(bad.parse::<StressScene>().is_err(), "{bad}");
        }
    }
}
