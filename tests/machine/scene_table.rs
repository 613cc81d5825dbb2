//! The scenes that every engine must draw to the same bits. They have small voxels and large leaves, are thin and solid,
//! shared and cyclic, 30 levels deep, or a million voxels from the origin. Some are voxel files.

use std::sync::OnceLock;

use shiftvox::graph::Graph;

use crate::common::{octree, sierpinski, solid};
use crate::scenes::graph_of;

pub(crate) struct TestScene {
    pub(crate) name: &'static str,
    graph: OnceLock<Graph>,
}

const fn scene(name: &'static str) -> TestScene {
    TestScene {
        name,
        graph: OnceLock::new(),
    }
}

/// Generators, files of `tests/data`, and graphs by hand.
pub(crate) static SCENES: [TestScene; 17] = [
    scene("gen:checker,depth=5"),
    scene("gen:maze,depth=6"),
    scene("gen:menger,depth=4"),
    scene("gen:random,depth=6,density=3,seed=5"),
    scene("gen:shell,depth=7"),
    scene("gen:sierpinski,depth=16"),
    scene("gen:sphere,depth=6"),
    scene("gen:terrain,depth=9"),
    scene("gen:truss,depth=7"),
    scene("gen:wires,depth=7"),
    scene("axes.vox"),
    scene("extended.vox"),
    scene("sphere.vox"),
    scene("a Sierpinski tetrahedron of 30 levels"),
    scene("a solid cube of one node"),
    scene("voxels in diagonal planes"),
    scene("a terrain far from the origin"),
];

impl TestScene {
    pub(crate) fn graph(&self) -> &Graph {
        // In a pool of its own: a worker that waits for parts of the graph takes up other work, which may wait for the
        // same graph.
        let pool = || rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let build = || pool().expect("a thread").install(|| self.build());
        let spawned = || std::thread::scope(|scope| scope.spawn(build).join());
        self.graph.get_or_init(|| spawned().expect("a graph"))
    }

    fn build(&self) -> Graph {
        match self.name {
            "a Sierpinski tetrahedron of 30 levels" => sierpinski(30),
            "a solid cube of one node" => solid(3),
            "voxels in diagonal planes" => octree(4, &|[x, y, z]| (x + 2 * y + 3 * z) % 5 == 0),
            "a terrain far from the origin" => {
                let mut graph = graph_of("gen:terrain,depth=6");
                graph.placement.origin_index = [1 << 20, -(1 << 20), 1 << 20];
                graph
            }
            name => graph_of(name),
        }
    }
}
