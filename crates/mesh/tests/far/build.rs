//! Splits, ray budgets, refused options, unfinished builds.

use std::fs;

use shiftvox::graph::Silent;
use shiftvox_mesh::far::build::Outside;
use shiftvox_mesh::far::record::Node;
use shiftvox_mesh::far::store::encode;
use shiftvox_mesh::far::view::{self, ViewOptions};
use shiftvox_mesh::far::{BuildError, BuildOptions, build, build_outside};
use shiftvox_mesh::generate::{Kind, generate, ply};
use shiftvox_mesh::open::read_mesh;
use shiftvox_mesh::{Instances, ListFolder, Surface};

use super::city::{city, far, file_of, options, view};
use super::shared::{card, disc, mesh_of};

#[test]
fn equal_triangles_are_split_by_number() {
    let mesh = mesh_of([[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]; 100]);
    let options = BuildOptions {
        leaf_triangles: 2,
        ..options()
    };
    let data = build(&mesh, &options, &Silent).unwrap();
    let leaves = data.nodes.iter().filter(|node| node.is_leaf());
    let triangles: Vec<u32> = leaves.map(|leaf| leaf.triangles).collect();
    assert_eq!(triangles, [1; 100]);
}

/// Where triangles fill their voxels and are fewer, a pixel sees one of them.
#[test]
fn solids_have_no_voxels_that_outnumber_their_triangles() {
    let most_per_triangle = |kind| {
        let options = BuildOptions {
            rays: Some(10_000),
            ..BuildOptions::default()
        };
        let data = build(&generate(kind, 1), &options, &Silent).unwrap();
        let below = data.nodes.iter().filter(|node| node.level > 1);
        let share = below.map(|node| f64::from(node.touched) / f64::from(node.triangles));
        share.fold(0.0, f64::max)
    };
    let [scan, grass] = [Kind::Scan, Kind::Grass].map(most_per_triangle);
    assert!(scan < 3.5 && grass > 6.0, "{scan} {grass}");
}

/// Another texture on the same triangles is another mesh.
#[test]
fn an_unfinished_build_continues_with_its_own_mesh_alone() {
    let folder = tempfile::tempdir().unwrap();
    let outside = Outside {
        memory: None,
        folder: folder.path(),
        unfinished: Some(&folder.path().join("a.unfinished")),
    };
    let [one, other] = [0, 102].map(|around| card(&disc(around), 8, 0.0, "map_Kd a.png"));
    let taken = |mesh| {
        let built = build_outside(mesh, &options(), &outside, &Silent);
        built.map(|built| (built.taken(), built.data.nodes.len()))
    };
    let (before, nodes) = taken(&one).unwrap();
    assert!(before == 0 && nodes > 1);
    assert!(matches!(taken(&other), Err(BuildError::File { .. })));
    assert_eq!(taken(&one), Ok((nodes, nodes)));
    fs::write(folder.path().join("a.unfinished"), "a note").unwrap();
    assert!(matches!(taken(&one), Err(BuildError::File { .. })));
}

#[test]
fn a_mesh_in_files_gives_the_same_bytes() {
    let place = tempfile::tempdir().unwrap();
    let village = generate(Kind::Village, 3);
    let path = |name: &str| place.path().join(name);
    fs::write(path("a.ply"), ply(&village)).unwrap();
    let (mut obj, mut text) = (String::new(), "solid \u{e4}\n".to_owned());
    for (number, corners) in (0..village.len())
        .map(|n| village.triangle(n).corners)
        .enumerate()
    {
        text.push_str("facet normal 0 0 1 outer loop");
        for [x, y, z] in corners.map(|corner| corner.to_array()) {
            obj.push_str(&format!("v {x} {y} {z}\nvn {y} {z} 1\n"));
            text.push_str(&format!(" VERTEX {x} {y} {z}"));
        }
        text.push_str(" endloop endfacet\n");
        let [a, b, c] = [1, 2, 3].map(|k| 3 * number + k);
        obj.push_str(&format!("f {a}//{c} {b}//{b} {c}//{a}\n"));
    }
    fs::write(path("a.obj"), obj).unwrap();
    fs::write(path("a.stl"), text + "endsolid").unwrap();
    for name in ["a.ply", "a.obj", "a.stl"] {
        let folder = ListFolder::new(place.path(), 0);
        let [held, mapped] = [None, Some(&folder)].map(|within| {
            let read = read_mesh(&path(name), Default::default(), within, &Silent);
            read.unwrap().0
        });
        // Corners of an STL are not joined in files.
        assert!(mapped == held || name == "a.stl" && mapped.len() == held.len());
        assert!(mapped.bytes() == 0 && held.bytes() > 0 && folder.bytes() > 0);
        let outside = Outside {
            memory: Some(200 << 20),
            folder: place.path(),
            unfinished: None,
        };
        let mut bytes = Vec::new();
        let built = build_outside(&mapped, &options(), &outside, &Silent);
        built.unwrap().write_to(&mut bytes).unwrap();
        let expected = encode(&build(&held, &options(), &Silent).unwrap()).unwrap();
        assert!(bytes == expected, "{name}");
    }
    assert_eq!(fs::read_dir(place.path()).unwrap().count(), 3);
}

#[test]
fn a_ray_budget_is_kept() {
    let [few, more, enough] = [4_000, 8_000, 4_000_000].map(|rays| {
        let rays = Some(rays);
        let options = BuildOptions {
            rays,
            grid: 12,
            ..options()
        };
        let data = build(&city(true), &options, &Silent).unwrap();
        let sum = |of: fn(&Node) -> u64| -> u64 { data.nodes.iter().map(of).sum() };
        (
            sum(|n| n.rays.into()),
            sum(|n| n.untested.into()),
            sum(|n| n.touched.into()),
            sum(Node::voxels),
        )
    });
    assert!(
        (3_800..=4_000).contains(&few.0) && (7_800..=8_000).contains(&more.0),
        "{few:?} {more:?} {enough:?}"
    );
    // A voxel that no ray reached is kept and not regarded as hidden.
    assert!(
        few.1 > more.1 && more.1 > 0 && enough.1 == 0,
        "{few:?} {more:?} {enough:?}"
    );
    assert!(few.2 == enough.2 && few.3 > enough.3, "{few:?} {enough:?}");
}

#[test]
fn invalid_options_are_refused() {
    for (grid, leaf_triangles, distance_voxels) in [
        (1, 2, 1.0),
        (256, 2, 1.0),
        (2, 1, 1.0),
        (2, 2, 0.9),
        (2, 2, f64::NAN),
    ] {
        let options = BuildOptions {
            grid,
            leaf_triangles,
            distance_voxels,
            ..options()
        };
        let refused = build(&city(false), &options, &Silent);
        assert!(matches!(refused, Err(BuildError::Option(_))), "{options:?}");
    }
    let nothing = Instances::new(city(false), Vec::new());
    let refused = build(&nothing, &options(), &Silent);
    assert_eq!(refused.err(), Some(BuildError::Empty));
    let file = file_of(&far(false));
    for (voxel_px, width) in [
        (0.0, 8),
        (-1.0, 8),
        (f64::NAN, 8),
        (f64::INFINITY, 8),
        (1.0, 0),
    ] {
        let mut view = view(0.0, 0.5, 60.0, 8);
        view.width = width;
        let options = ViewOptions {
            voxel_px,
            ..ViewOptions::default()
        };
        assert!(view::draw(&file, &view, &options).is_err(), "{options:?}");
    }
}
