//! The scenes that every engine must draw to the same bits. They have small voxels and large leaves, are thin and solid,
//! shared and cyclic, 30 levels deep, or a million voxels from the origin. Some are files of `tests/data`.

use std::sync::OnceLock;

use shiftvox::graph::Graph;

use crate::common::{octree, sierpinski, solid};
use crate::scenes::graph_of;

pub(crate) struct TestScene {
    pub(crate) name: &'static str,
    build: fn(&str) -> Graph,
    graph: OnceLock<Graph>,
}

const fn scene(name: &'static str, build: fn(&str) -> Graph) -> TestScene {
    TestScene {
        name,
        build,
        graph: OnceLock::new(),
    }
}

const fn made(name: &'static str) -> TestScene {
    scene(name, graph_of)
}

pub(crate) static SCENES: [TestScene; 17] = [
    made("gen:checker,depth=5"),
    made("gen:maze,depth=6"),
    made("gen:menger,depth=4"),
    made("gen:random,depth=6,density=3,seed=5"),
    made("gen:shell,depth=7"),
    made("gen:sierpinski,depth=16"),
    made("gen:sphere,depth=6"),
    made("gen:terrain,depth=9"),
    made("gen:truss,depth=7"),
    made("gen:wires,depth=7"),
    made("axes.vox"),
    made("extended.vox"),
    made("sphere.vox"),
    scene("a Sierpinski tetrahedron of 30 levels", |_| sierpinski(30)),
    scene("a solid cube of one node", |_| solid(3)),
    scene("voxels in diagonal planes", |_| {
        octree(4, &|[x, y, z]| (x + 2 * y + 3 * z) % 5 == 0)
    }),
    scene("a terrain far from the origin", |_| {
        let mut graph = graph_of("gen:terrain,depth=6");
        graph.placement.origin_index = [1 << 20, -(1 << 20), 1 << 20];
        graph
    }),
];

impl TestScene {
    pub(crate) fn graph(&self) -> &Graph {
        // In a pool of its own: a worker that waits for parts of the graph takes up other work, which may wait for the
        // same graph.
        let pool = || rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let build = || {
            pool()
                .expect("a thread")
                .install(|| (self.build)(self.name))
        };
        let spawned = || std::thread::scope(|scope| scope.spawn(build).join());
        self.graph.get_or_init(|| spawned().expect("a graph"))
    }
}
