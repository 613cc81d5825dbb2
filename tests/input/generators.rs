//! Generated scenes do not change. Where the reference program has the scene, the digest is its.

use shiftvox::graph::{Silent, Voxel};
use shiftvox::scene::generate::{GENERATORS, Spec};

use crate::digest;

/// Voxels and digest of each.
const SCENES: [(&str, usize, u64); 21] = [
    // Of the reference program.
    ("terrain,depth=6", 11_998, 0xdadf_6386_4925_109f),
    ("terrain,depth=8", 229_393, 0x24c1_2599_7dc5_b315),
    ("terrain,depth=10", 3_892_443, 0x155c_ea14_aece_0de6),
    ("menger,depth=2", 400, 0xf5a4_7d09_31c9_5053),
    ("menger,depth=4", 160_000, 0x0112_0026_1f18_75de),
    ("menger,depth=5", 3_200_000, 0x0509_ac92_c690_7f2a),
    // Of this program.
    ("checker,depth=4", 2048, 0x0c1e1f2597c6e497),
    ("maze,depth=5", 1985, 0xc2dd0861c4b8b01e),
    ("maze,depth=5,seed=2", 1985, 0x1336c1db35424952),
    ("maze,depth=6,seed=7", 12161, 0xce586e0bf28ae101),
    ("random,depth=5,density=10", 3231, 0xc5aee2e5a598d65d),
    ("random,depth=5,density=30,seed=9", 9744, 0x9f7f81477f105bd2),
    ("random,depth=6,density=90", 235766, 0x1d96ed6a0150eda0),
    ("random,depth=6,density=100", 262144, 0x1668f7c4de21db86),
    ("shell,depth=6", 18608, 0xd7f0a65a7aae06f6),
    ("sierpinski,depth=5", 1024, 0x0c11c01abbed9ec0),
    ("sphere,depth=5", 17256, 0x3da976b40d791ec7),
    ("terrain,depth=6,seed=2", 11901, 0x3048b781d36ece49),
    ("truss,depth=5", 6318, 0xf8338915bedea5b8),
    ("truss,depth=8", 60750, 0xafad93bcf4f3b6b0),
    ("wires,depth=6", 4740, 0x69802db171f482e8),
];

#[test]
fn scenes_have_their_digests() {
    let found = SCENES.map(|(text, ..)| {
        let spec = Spec::parse(&format!("gen:{text}")).unwrap();
        let mut voxels = Vec::new();
        let mut sink = |v: Voxel| {
            assert_eq!(v.normal, None);
            voxels.push((v.index, v.color));
        };
        spec.voxels(&mut sink, &Silent);
        voxels.sort_unstable();
        let distinct = voxels.is_sorted_by(|a, b| a.0 < b.0);
        assert!(distinct, "{text} gives a voxel twice");
        (text, voxels.len(), digest(&voxels))
    });
    assert_eq!(found, SCENES);
}

#[test]
fn every_generator_has_a_digest_and_one_has_a_cycle() {
    for generator in GENERATORS {
        let mut specs = SCENES.iter().map(|(spec, ..)| spec);
        assert!(specs.any(|spec| spec.starts_with(generator.name)));
        let spec = Spec::parse(&format!("gen:{}", generator.name)).unwrap();
        let linked = spec.linked().inspect(|graph| graph.validate().unwrap());
        let nodes = linked.map(|graph| (graph.len(), graph.depth, graph.voxels));
        let expected = (generator.name == "sierpinski").then_some((1, 30, 1 << 60));
        assert_eq!(nodes, expected);
    }
}
