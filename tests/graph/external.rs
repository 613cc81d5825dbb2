//! A file built by external sort is the one that is built in memory.

use std::fs;
use std::path::Path;

use proptest::prelude::*;
use shiftvox::graph::{
    BuildError, BuildOptions, Builder, ExternalBuilder, ExternalError, ExternalOptions,
    ExternalReport, Normals, Silent, Voxel, vxg,
};
use shiftvox::picture::npy::{Array, Values, encode};
use shiftvox::scene::generate::Spec;
use shiftvox::scene::{self, BuiltFile, NoMeshes, OpenError, OpenOptions, Source};

use crate::voxels;

const PLACE: ([f64; 3], f64) = ([0.5, -2.0, 1e3], 0.25);

fn options(memory: u64, normals: Normals, temporary: &Path) -> ExternalOptions {
    ExternalOptions {
        build: BuildOptions { normals },
        memory,
        temporary: temporary.to_owned(),
    }
}

/// The file built within `memory`, and the report; nothing else may be left.
fn external(voxels: &[Voxel], memory: u64, normals: Normals) -> (Vec<u8>, ExternalReport) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.vxg");
    let mut builder = ExternalBuilder::new(options(memory, normals, folder.path()));
    voxels.iter().for_each(|&voxel| builder.push(voxel));
    let report = builder.finish(PLACE, &path, false, &Silent).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    (fs::read(path).unwrap(), report)
}

fn in_memory(voxels: &[Voxel], normals: Normals) -> Vec<u8> {
    let mut builder = Builder::new(BuildOptions { normals });
    builder.extend(voxels.iter().copied());
    let graph = builder.finish(PLACE, &Silent).unwrap();
    let mut bytes = Vec::new();
    vxg::write_to(&graph, &mut bytes).unwrap();
    bytes
}

/// The first place where two files differ.
fn difference(a: &[u8], b: &[u8]) -> Option<usize> {
    if a.len() != b.len() {
        return Some(a.len().min(b.len()));
    }
    a.iter().zip(b).position(|(a, b)| a != b)
}

/// Memory from nothing, for runs of two voxels, to more than enough.
const MEMORY: [u64; 6] = [0, 3000, 12_000, 50_000, 400_000, 64 << 20];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn every_byte_is_that_of_the_file_built_in_memory(voxels in voxels(400), which in 0..MEMORY.len()) {
        for normals in [Normals::FromSurface, Normals::None] {
            let (file, report) = external(&voxels, MEMORY[which], normals);
            let expected = in_memory(&voxels, normals);
            prop_assert_eq!(difference(&file, &expected), None);
            prop_assert_eq!(report.pushed, voxels.len() as u64);
            prop_assert_eq!(report.bytes, file.len() as u64);
        }
    }
}

/// Solids, walls, wires and hills, cut in blocks of one cluster and more.
#[test]
fn generated_scenes_are_the_same_in_any_memory() {
    let scenes = [
        "gen:terrain,depth=7",
        "gen:sphere,depth=6",
        "gen:menger,depth=3",
        "gen:wires,depth=5",
        "gen:random,depth=5,density=30",
    ];
    for scene in scenes {
        let spec = Spec::parse(scene).unwrap();
        let mut voxels = Vec::new();
        spec.voxels(&mut |voxel| voxels.push(voxel), &Silent);
        // From the far end, so that the lowest corner comes last.
        let reversed: Vec<Voxel> = voxels.iter().rev().copied().collect();
        let expected = in_memory(&voxels, Normals::FromSurface);
        let mut runs = Vec::new();
        for memory in [2000, 40_000, 400_000, 4 << 20, 64 << 20] {
            for order in [&voxels, &reversed] {
                let (file, report) = external(order, memory, Normals::FromSurface);
                assert_eq!(difference(&file, &expected), None, "{scene}, {memory}");
                runs.push(report.runs);
                // A run's records take 16 bytes, and are written before the levels.
                assert!(report.temporary_written >= report.temporary_bytes);
                assert!(report.runs == 1 || report.temporary_bytes >= 16 * report.voxels);
            }
        }
        assert!(runs[0] > 50 && runs.ends_with(&[1, 1]), "{scene}: {runs:?}");
    }
}

#[test]
fn what_cannot_be_built_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.vxg");
    let builder = || ExternalBuilder::new(options(0, Normals::FromSurface, folder.path()));
    let at = |x: i32| Voxel {
        index: [x, 0, 0],
        ..Voxel::default()
    };
    let refused = builder().finish(PLACE, &path, true, &Silent).unwrap_err();
    assert!(matches!(refused, ExternalError::Build(BuildError::Empty)));

    let mut wide = builder();
    (0..100).for_each(|x| wide.push(at(x * 40_000)));
    let refused = wide.finish(PLACE, &path, true, &Silent).unwrap_err();
    let found = matches!(
        refused,
        ExternalError::Build(BuildError::TooLarge { axis: 'x', .. })
    );
    assert!(found, "{refused}");

    let mut flat = builder();
    flat.push(at(1));
    let place = ([0.0; 3], 0.0);
    let refused = flat.finish(place, &path, true, &Silent).unwrap_err();
    assert!(matches!(
        refused,
        ExternalError::Build(BuildError::Placement)
    ));

    fs::write(&path, b"precious").unwrap();
    let mut second = builder();
    (0..100).for_each(|x| second.push(at(x)));
    let refused = second.finish(PLACE, &path, false, &Silent).unwrap_err();
    assert!(matches!(refused, ExternalError::Write(_)), "{refused}");
    assert_eq!(fs::read(&path).unwrap(), b"precious");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);

    let nowhere = options(0, Normals::None, &folder.path().join("no/folder"));
    let mut lost = ExternalBuilder::new(nowhere);
    (0..100).for_each(|x| lost.push(at(x)));
    assert_eq!(lost.len(), 100);
    let refused = lost.finish(PLACE, &path, true, &Silent).unwrap_err();
    assert!(
        matches!(refused, ExternalError::Temporary { .. }),
        "{refused}"
    );
    assert!(refused.to_string().contains("no/folder"), "{refused}");
    assert_eq!(fs::read(&path).unwrap(), b"precious");
}

fn build_file(
    source: &str,
    external: ExternalOptions,
    output: &Path,
) -> Result<BuiltFile, OpenError> {
    let found = Source::find(source)?;
    let reading = OpenOptions::default();
    scene::build_file(found, &reading, &NoMeshes, external, output, true, &Silent)
}

/// Importers and generators lead to the same file by both ways.
#[test]
fn files_of_every_format_are_built_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let ply = folder.path().join("scene.ply");
    let npy = folder.path().join("scene.npy");
    let spec = Spec::parse("gen:terrain,depth=6").unwrap();
    let mut voxels = Vec::new();
    spec.voxels(&mut |voxel| voxels.push(voxel), &Silent);
    let mut out = fs::File::create(&ply).unwrap();
    scene::write_ply(&mut out, voxels.iter().copied(), true).unwrap();
    let indices = voxels.iter().flat_map(|voxel| voxel.index).collect();
    let array = Array {
        shape: vec![voxels.len(), 3],
        values: Values::I32(indices),
    };
    fs::write(&npy, encode(&array)).unwrap();

    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let mut sources: Vec<String> = [ply, npy, data.join("sphere.vox"), data.join("extended.vox")]
        .map(|path| path.to_str().unwrap().to_owned())
        .into();
    sources.push("gen:wires,depth=4".to_owned());
    sources.push("gen:sierpinski,depth=20".to_owned());
    for source in sources {
        let reading = OpenOptions::default();
        let opened = scene::open(&source, &reading, &NoMeshes, &Silent).unwrap();
        let mut expected = Vec::new();
        vxg::write_to(&opened.graph, &mut expected).unwrap();
        let path = folder.path().join("out.vxg");
        let external = options(10_000, Normals::FromSurface, folder.path());
        let built = build_file(&source, external, &path).unwrap();
        let file = fs::read(&path).unwrap();
        assert_eq!(difference(&file, &expected), None, "{source}");
        assert_eq!(
            (built.voxels, built.bytes),
            (opened.graph.voxels, file.len() as u64)
        );
        assert_eq!(built.info, opened.info);
    }
    // A graph is no list of voxels.
    let path = folder.path().join("again.vxg");
    let source = folder.path().join("out.vxg");
    let external = options(10_000, Normals::FromSurface, folder.path());
    let refused = build_file(source.to_str().unwrap(), external, &path);
    assert!(refused.unwrap_err().to_string().contains(".vxg graph"));
}

/// A scene of more nodes than 32 bits can number is rejected at once.
#[test]
fn scenes_beyond_all_numbers_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.vxg");
    let external = options(64 << 20, Normals::FromSurface, folder.path());
    let source = "gen:menger,depth=8";
    let refused = build_file(source, external, &path).unwrap_err();
    assert!(
        refused.is_limit() && refused.to_string().contains("25600000000"),
        "{refused}"
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
