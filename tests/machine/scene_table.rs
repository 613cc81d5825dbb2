//! The scenes that every engine must draw to the same bits. They have small voxels and large leaves, are thin and solid,
//! shared and cyclic, 30 levels deep, or a million voxels from the origin. Some are files of `tests/data`.

use std::sync::LazyLock;

use shiftvox::graph::Graph;

use crate::common::{octree, sierpinski, solid};
use crate::scenes::graph_of;

const NAMES: [&str; 13] = [
    "gen:checker,depth=5",
    "gen:maze,depth=6",
    "gen:menger,depth=4",
    "gen:random,depth=6,density=3,seed=5",
    "gen:shell,depth=7",
    "gen:sierpinski,depth=16",
    "gen:sphere,depth=6",
    "gen:terrain,depth=9",
    "gen:truss,depth=7",
    "gen:wires,depth=7",
    "axes.vox",
    "extended.vox",
    "sphere.vox",
];

/// Names and graphs.
pub(crate) static SCENES: LazyLock<Vec<(&str, Graph)>> = LazyLock::new(|| {
    let mut scenes: Vec<_> = NAMES.map(|name| (name, graph_of(name))).into();
    let mut terrain = graph_of("gen:terrain,depth=6");
    terrain.placement.origin_index = [1 << 20, -(1 << 20), 1 << 20];
    let planes = octree(4, &|[x, y, z]| (x + 2 * y + 3 * z) % 5 == 0);
    scenes.extend([
        ("a Sierpinski tetrahedron of 30 levels", sierpinski(30)),
        ("a solid cube of one node", solid(3)),
        ("voxels in diagonal planes", planes),
        ("a terrain far from the origin", terrain),
    ]);
    scenes
});
