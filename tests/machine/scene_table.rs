//! The scenes that every engine must draw to the same bits.
//!
//! Graphs of all kinds: small voxels and large leaves, thin and solid, shared and cyclic, 30 levels
//! deep, a million voxels from the origin, and voxel files.

use std::path::Path;
use std::sync::OnceLock;

use shiftvox::graph::Graph;

use crate::common::{octree, sierpinski, solid};
use crate::scenes::{graph_of_file, graph_of_spec};

/// A scene of the table. Its graph is made when it is first needed.
pub(crate) struct TestScene {
    /// The name in messages.
    pub(crate) name: &'static str,
    source: Source,
    graph: OnceLock<Graph>,
}

#[derive(Clone, Copy)]
enum Source {
    /// A generator: the name is the specification.
    Spec,
    /// A file of `tests/data`, by its name.
    File,
    /// Made by hand.
    Made(fn() -> Graph),
}

const fn scene(name: &'static str, source: Source) -> TestScene {
    TestScene {
        name,
        source,
        graph: OnceLock::new(),
    }
}

/// All scenes.
pub(crate) static SCENES: [TestScene; 17] = [
    scene("gen:checker,depth=5", Source::Spec),
    scene("gen:maze,depth=6", Source::Spec),
    scene("gen:menger,depth=4", Source::Spec),
    scene("gen:random,depth=6,density=3,seed=5", Source::Spec),
    scene("gen:shell,depth=7", Source::Spec),
    scene("gen:sierpinski,depth=16", Source::Spec),
    scene("gen:sphere,depth=6", Source::Spec),
    scene("gen:terrain,depth=9", Source::Spec),
    scene("gen:truss,depth=7", Source::Spec),
    scene("gen:wires,depth=7", Source::Spec),
    scene("axes.vox", Source::File),
    scene("extended.vox", Source::File),
    scene("sphere.vox", Source::File),
    scene(
        "a Sierpinski tetrahedron of 30 levels",
        Source::Made(|| sierpinski(30)),
    ),
    scene("a solid cube of one node", Source::Made(|| solid(3))),
    scene(
        "voxels in diagonal planes",
        Source::Made(|| octree(4, &|[x, y, z]| (x + 2 * y + 3 * z) % 5 == 0)),
    ),
    scene(
        "a terrain far from the origin",
        Source::Made(|| {
            let mut graph = graph_of_spec("gen:terrain,depth=6");
            graph.placement.origin_index = [1 << 20, -(1 << 20), 1 << 20];
            graph
        }),
    ),
];

impl TestScene {
    /// The scene's graph.
    pub(crate) fn graph(&self) -> &Graph {
        // On a thread and in a pool of its own. A worker that waits for parts of the graph takes up other work, which
        // may wait for the same graph.
        let pool = || rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let build = || pool().expect("a thread").install(|| self.build());
        let spawned = || std::thread::scope(|scope| scope.spawn(build).join());
        self.graph.get_or_init(|| spawned().expect("a graph"))
    }

    fn build(&self) -> Graph {
        match self.source {
            Source::Spec => graph_of_spec(self.name),
            Source::File => {
                let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
                graph_of_file(&data.join(self.name)).expect(self.name)
            }
            Source::Made(make) => make(),
        }
    }
}
