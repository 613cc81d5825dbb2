//! A file built by external sort is the one that is built in memory.

use std::fs;
use std::path::Path;

use proptest::prelude::*;
use shiftvox::graph::{
    BuildError, ExternalBuilder, ExternalError, ExternalOptions, ExternalReport, Silent, Voxel,
};
use shiftvox::picture::npy::{Array, Values, encode};
use shiftvox::scene::{self, BuiltFile, NoMeshes, OpenError, OpenOptions, Source};

use crate::{PLACE, at, build, bytes_of, generated, voxels};

fn options(memory: u64, temporary: &Path) -> ExternalOptions {
    ExternalOptions {
        memory,
        temporary: temporary.to_owned(),
    }
}

/// The file built within `memory`, and the report; nothing else may be left.
fn external(voxels: &[Voxel], memory: u64) -> (Vec<u8>, ExternalReport) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.vxg");
    let mut builder = ExternalBuilder::new(options(memory, folder.path()));
    voxels.iter().for_each(|&voxel| builder.push(voxel));
    let report = builder.finish(PLACE, &path, false, &Silent).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    (fs::read(path).unwrap(), report)
}

/// The first place where two files differ.
fn difference(a: &[u8], b: &[u8]) -> Option<usize> {
    let first = a.iter().zip(b).position(|(a, b)| a != b);
    first.or((a.len() != b.len()).then_some(a.len().min(b.len())))
}

/// Memory from nothing, for runs of two voxels, to more than enough.
const MEMORY: [u64; 6] = [0, 3000, 12_000, 50_000, 400_000, 64 << 20];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn every_byte_is_that_of_the_file_built_in_memory(voxels in voxels(400), which in 0..MEMORY.len()) {
        let (file, report) = external(&voxels, MEMORY[which]);
        let expected = bytes_of(&build(&voxels));
        prop_assert_eq!(difference(&file, &expected), None);
        prop_assert_eq!(report.bytes, file.len() as u64);
    }
}

/// Solids, walls, wires and hills, cut in blocks of one cluster and more.
#[test]
fn generated_scenes_are_the_same_in_any_memory() {
    const SOME: &[u64] = &[2000, 40_000, 400_000, 4 << 20, 64 << 20];
    for (scene, memory) in [
        ("gen:terrain,depth=7", SOME),
        ("gen:sphere,depth=6", SOME),
        ("gen:menger,depth=3", SOME),
        ("gen:wires,depth=5", SOME),
        ("gen:random,depth=5,density=30", SOME),
        // So large that work is split below the level of whole clusters.
        ("gen:shell,depth=8", &[8 << 20]),
    ] {
        let voxels = generated(scene);
        // From the far end, so that the lowest corner comes last.
        let reversed: Vec<Voxel> = voxels.iter().rev().copied().collect();
        let expected = bytes_of(&build(&voxels));
        for &memory in memory {
            for order in [&voxels, &reversed] {
                let (file, report) = external(order, memory);
                assert_eq!(difference(&file, &expected), None, "{scene}, {memory}");
                // A run's records take 16 bytes, and are written before the levels.
                assert!(report.temporary_written >= report.temporary_bytes);
                assert!(report.runs == 1 || report.temporary_bytes >= 16 * report.voxels);
                assert!(report.runs > 50 || memory > 2000);
                assert!(report.runs == 1 || memory < 64 << 20);
            }
        }
    }
}

/// Threads of a pool wait for runs that the same threads sort.
#[test]
fn all_threads_of_a_pool_may_build_at_once() {
    let voxels = generated("gen:sphere,depth=5");
    let expected = bytes_of(&build(&voxels));
    let (sender, receiver) = std::sync::mpsc::channel();
    std::thread::spawn(move || sender.send(rayon::broadcast(|_| external(&voxels, 64 << 20).0)));
    let files = receiver.recv_timeout(std::time::Duration::from_secs(100));
    assert!(files.unwrap().iter().all(|file| *file == expected));
}

#[test]
fn what_cannot_be_built_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.vxg");
    fs::write(&path, b"precious").unwrap();
    let nowhere = folder.path().join("no/folder");
    let refused = |step: i32, count: i32, size: f64, overwrite, temporary: &Path| {
        let mut builder = ExternalBuilder::new(options(0, temporary));
        (0..count).for_each(|x| builder.push(at([x * step, 0, 0])));
        let refused = builder.finish(([0.0; 3], size), &path, overwrite, &Silent);
        assert_eq!(fs::read(&path).unwrap(), b"precious");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        refused.unwrap_err()
    };
    use ExternalError::{Build, Temporary, Write};
    let here = folder.path();
    let empty = refused(1, 0, 1.0, true, here);
    assert!(matches!(empty, Build(BuildError::Empty)), "{empty}");
    let wide = refused(40_000, 100, 1.0, true, here);
    let is_wide = matches!(wide, Build(BuildError::TooLarge { axis: 'x', .. }));
    assert!(is_wide, "{wide}");
    let flat = refused(1, 1, 0.0, true, here);
    assert!(matches!(flat, Build(BuildError::Placement)), "{flat}");
    let second = refused(1, 100, 1.0, false, here);
    assert!(matches!(second, Write(_)), "{second}");
    let lost = refused(1, 100, 1.0, true, &nowhere);
    let is_named = lost.to_string().contains("no/folder");
    assert!(is_named && matches!(lost, Temporary { .. }), "{lost}");
}

fn build_file(source: &str, memory: u64, output: &Path) -> Result<BuiltFile, OpenError> {
    let found = Source::find(source)?;
    let reading = OpenOptions::default();
    let external = options(memory, output.parent().unwrap());
    scene::build_file(found, &reading, &NoMeshes, external, output, true, &Silent)
}

/// Importers and generators lead to the same file by both ways.
#[test]
fn files_of_every_format_are_built_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let [ply, npy, path] = ["scene.ply", "scene.npy", "out.vxg"].map(|n| folder.path().join(n));
    let voxels = generated("gen:terrain,depth=6");
    let mut out = fs::File::create(&ply).unwrap();
    scene::write_ply(&mut out, voxels.iter().copied(), true).unwrap();
    let indices = voxels.iter().flat_map(|voxel| voxel.index).collect();
    let array = Array {
        shape: vec![voxels.len(), 3],
        values: Values::I32(indices),
    };
    fs::write(&npy, encode(&array)).unwrap();

    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let files = [ply, npy, data.join("sphere.vox"), data.join("extended.vox")];
    let files = files.iter().map(|path| path.to_str().unwrap());
    for source in files.chain(["gen:wires,depth=4", "gen:sierpinski,depth=20"]) {
        let reading = OpenOptions::default();
        let opened =
            scene::open_source(Source::find(source).unwrap(), &reading, &NoMeshes, &Silent)
                .unwrap();
        let built = build_file(source, 10_000, &path).unwrap();
        let file = fs::read(&path).unwrap();
        let expected = bytes_of(&opened.graph);
        assert_eq!(difference(&file, &expected), None, "{source}");
        let counts = (built.voxels, built.bytes, built.warnings);
        assert_eq!(
            counts,
            (opened.graph.voxels, file.len() as u64, opened.info.warnings)
        );
    }
    // A graph is no list of voxels.
    let again = folder.path().join("again.vxg");
    let refused = build_file(path.to_str().unwrap(), 10_000, &again);
    assert!(refused.unwrap_err().to_string().contains(".vxg graph"));
    // A scene of more nodes than 32 bits can number is rejected at once.
    let refused = build_file("gen:menger,depth=8", 64 << 20, &again).unwrap_err();
    let told = refused.to_string();
    assert!(refused.is_limit() && told.contains("25600000000"), "{told}");
    assert!(!again.exists());
}
