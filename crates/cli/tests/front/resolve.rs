//! Hand-made frames become the pictures that are written here as text.

use glam::DVec3;
use shiftvox::fast::{Fast, FastOptions};
use shiftvox::frame::{Frame, NO_NODE};
use shiftvox::graph::{Graph, PackedNormal, Placement, Silent};
use shiftvox::machine::Machine;
use shiftvox::picture::{
    Background, NO_DEPTH, Picture, ResolveError, Resolver, Shader, Shading, hash, hash_rows,
    resolve,
};
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};
use shiftvox_mesh::open::{OpenOptions, open};

/// Three voxels without children: red, green and blue. The last one has a normal along +X.
fn graph(placement: Placement) -> Graph {
    Graph {
        depth: 2,
        root: 0,
        mask: Vec::new().into(),
        first: Vec::new().into(),
        links: Vec::new().into(),
        color: vec![[255, 0, 0], [0, 255, 0], [0, 0, 255]].into(),
        opacity: Vec::new().into(),
        normal: vec![
            PackedNormal(0),
            PackedNormal(0),
            PackedNormal(255 << 8 | 128),
        ]
        .into(),
        level_start: Vec::new(),
        voxels: 3,
        placement,
    }
}

/// Looks along +Y at the middle of a cube of 4 voxels, from 6 voxels before its front face.
fn setup(placement: &Placement, side: u32, aa_log2: u32) -> FrameSetup {
    let world = |voxel: DVec3| {
        let index = voxel + DVec3::from_array(placement.origin_index.map(|i| i as f64));
        DVec3::from_array(placement.world_origin) + index * placement.voxel_size
    };
    let camera = Camera {
        eye: world(DVec3::new(2.0, -6.0, 2.0)),
        target: world(DVec3::new(2.0, 2.0, 2.0)),
        up: DVec3::Z,
        fov_degrees: 40.0,
        width: side,
        height: side,
    };
    let options = SetupOptions {
        aa_log2,
        ..SetupOptions::default()
    };
    FrameSetup::new(&camera, placement, 2, &options).expect("a frame")
}

fn see(frame: &mut Frame, x: u32, y: u32, node: u32, voxel: [i32; 4]) {
    let at = (y * frame.width + x) as usize;
    frame.node[at] = node;
    frame.voxel[at] = voxel;
}

/// One letter a pixel: red, green, blue, `.` for nothing, `?` for anything else.
fn letters(picture: &Picture) -> Vec<String> {
    let letter = |pixel: &[u8; 4]| match pixel {
        [255, 0, 0, 255] => 'r',
        [0, 255, 0, 255] => 'g',
        [0, 0, 255, 255] => 'b',
        [_, _, _, 0] => '.',
        _ => '?',
    };
    let rows = picture.rgba.chunks(picture.width as usize);
    rows.map(|row| row.iter().map(letter).collect()).collect()
}

#[test]
fn flat_colours_are_those_of_the_nodes() {
    let placement = Placement::default();
    let setup = setup(&placement, 3, 0);
    let mut frame = Frame::new(3, 3, false);
    see(&mut frame, 1, 0, 0, [2, 0, 3, 2]);
    see(&mut frame, 0, 1, 1, [0, 0, 2, 2]);
    see(&mut frame, 1, 1, 2, [1, 0, 1, 2]);
    see(&mut frame, 2, 2, 0, [3, 0, 0, 2]);
    let picture = resolve(
        &frame,
        &graph(placement),
        &setup,
        Shading::Flat,
        Background::None,
    );
    assert_eq!(letters(&picture.unwrap()), [".r.", "gb.", "..r"]);
}

#[test]
fn depth_is_where_the_ray_enters() {
    let placement = Placement {
        origin_index: [-7, 100, 3],
        world_origin: [0.5, -2.0, 8.0],
        voxel_size: 0.25,
        mesh: None,
    };
    let setup = setup(&placement, 3, 0);
    let mut frame = Frame::new(3, 3, false);
    // The middle ray runs along +Y through (2, y, 2), on the edge of four voxels. It enters or touches the whole object
    // and one of its octants.
    see(&mut frame, 1, 1, 0, [0, 0, 0, 0]);
    // Missed by its ray: the depth of the centre, (0.5, 3.5, 0.5).
    see(&mut frame, 2, 0, 1, [0, 3, 0, 2]);
    // The slanted ray enters the octant at y 2 from the side or the front.
    see(&mut frame, 0, 1, 2, [0, 2, 0, 1]);
    let graph = graph(placement);
    let picture = resolve(&frame, &graph, &setup, Shading::Flat, Background::None).unwrap();
    let close = |at: usize, expected: f64| {
        let found = f64::from(picture.depth[at]);
        assert!(
            (found - expected).abs() < 1e-6,
            "pixel {at}: {found}, not {expected}"
        );
    };
    close(4, 6.0 * 0.25);
    close(2, 9.5 * 0.25);
    close(3, 8.0 * 0.25);
    assert_eq!(picture.depth[0], NO_DEPTH);
    assert_eq!(picture.voxel[2], [-7, 103, 3, 2]);
    assert_eq!(picture.voxel[3], [-7, 102, 3, 1]);
    assert_eq!(picture.voxel[0], [0, 0, 0, -1]);
    assert_eq!((picture.node[0], picture.node[3]), (-1, 2));
    // No normal of its own: the face that is entered. The last has one.
    assert_eq!(picture.normal[4], [0.0, -1.0, 0.0]);
    assert_eq!(picture.normal[3], [1.0, 0.0, 0.0]);
}

#[test]
fn inside_a_voxel_the_depth_is_zero() {
    let placement = Placement::default();
    let mut camera = Camera {
        eye: DVec3::new(1.3, 1.2, 1.1),
        target: DVec3::new(2.0, 2.0, 2.0),
        up: DVec3::Z,
        fov_degrees: 60.0,
        width: 2,
        height: 2,
    };
    let mut depth_at = |target: DVec3| {
        camera.target = target;
        let setup = FrameSetup::new(&camera, &placement, 2, &SetupOptions::default()).unwrap();
        let mut frame = Frame::new(2, 2, false);
        see(&mut frame, 0, 0, 0, [0, 0, 0, 1]);
        let graph = graph(placement);
        resolve(&frame, &graph, &setup, Shading::Lambert, Background::None)
            .unwrap()
            .depth[0]
    };
    assert_eq!(depth_at(DVec3::new(2.0, 2.0, 2.0)), 0.0);
    assert_eq!(depth_at(DVec3::new(-2.0, 0.0, 0.0)), 0.0);
}

#[test]
fn samples_are_averaged_in_linear_light() {
    let placement = Placement::default();
    let setup = setup(&placement, 1, 1);
    let mut frame = Frame::new(2, 2, true);
    see(&mut frame, 0, 0, 0, [0, 0, 3, 2]);
    see(&mut frame, 1, 1, 1, [3, 0, 0, 2]);
    frame.records = Some(vec![1.0, 2.0, 3.0, 4.0]);
    let graph = graph(placement);
    let resolved = |background| resolve(&frame, &graph, &setup, Shading::Flat, background).unwrap();
    // A quarter of full light is byte 137, half of it 188.
    let black = resolved(Background::Color([0; 3]));
    assert_eq!(black.rgba, [[137, 137, 0, 255]]);
    let white = resolved(Background::Color([255; 3]));
    assert_eq!(white.rgba, [[225, 225, 188, 255]]);
    // The mean of the two that see something, at half coverage.
    let clear = resolved(Background::None);
    assert_eq!(clear.rgba, [[188, 188, 0, 128]]);
    // The other buffers are those of the sample right of and below the middle; records add up.
    assert_eq!((clear.node[0], clear.voxel[0]), (1, [3, 0, 0, 2]));
    assert_eq!(clear.records, Some(vec![10.0]));
}

#[test]
fn a_frame_of_another_size_is_refused() {
    let placement = Placement::default();
    let setup = setup(&placement, 3, 0);
    let frame = Frame::new(3, 2, false);
    let graph = graph(placement);
    assert!(resolve(&frame, &graph, &setup, Shading::Flat, Background::None).is_err());
}

/// The picture's colours by the words of `spec/picture.md`, sample by sample.
fn plain_colors(
    frame: &Frame,
    graph: &Graph,
    setup: &FrameSetup,
    shading: Shading,
    background: Background,
) -> Vec<[u8; 4]> {
    let shader = Shader::new(graph, setup, shading, background);
    let side = 1u32 << setup.options.aa_log2;
    let samples = side * side;
    let mut pixels = Vec::new();
    for y in 0..frame.height / side {
        for x in 0..frame.width / side {
            let (mut sum, mut seen) = ([0u32; 3], 0u32);
            for (j, i) in (0..side).flat_map(|j| (0..side).map(move |i| (j, i))) {
                let (x, y) = (x * side + i, y * side + j);
                let at = (y * frame.width + x) as usize;
                let light = if frame.node[at] == NO_NODE {
                    shader.background().unwrap_or([0; 3])
                } else {
                    seen += 1;
                    shader.light(x, y, frame.node[at], frame.voxel[at])
                };
                for c in 0..3 {
                    sum[c] += light[c];
                }
            }
            pixels.push(if background != Background::None {
                let [r, g, b] = shader.encode(sum.map(|c| (c + samples / 2) / samples));
                [r, g, b, 255]
            } else if seen == 0 {
                [0; 4]
            } else {
                let [r, g, b] = shader.encode(sum.map(|c| (c + seen / 2) / seen));
                [r, g, b, ((255 * seen + samples / 2) / samples) as u8]
            });
        }
    }
    pixels
}

/// Scenes with and without normals, drawn from outside, near and within.
#[test]
fn colours_are_those_of_the_plain_rule() {
    let scenes = [
        "gen:terrain,depth=6",
        "gen:menger,depth=3",
        "gen:random,depth=4",
        "gen:wires,depth=5",
        "gen:sierpinski,depth=5",
    ];
    let mut compared = 0;
    for scene in scenes {
        let opened = open(scene, &OpenOptions::default(), &Silent).unwrap();
        let mut without = opened.graph.clone();
        without.normal = vec![PackedNormal::NONE; without.len()].into();
        let side = f64::from(1u32 << opened.graph.depth);
        for (graph, eye) in [
            (&opened.graph, [1.6, -0.7, 1.25]),
            (&opened.graph, [0.47, 0.52, 0.61]),
            (&without, [-0.9, 1.3, 0.8]),
        ] {
            for (aa_log2, lod_px) in [(0, 0.0), (0, 3.0), (1, 1.0), (2, 1.0)] {
                let camera = Camera {
                    eye: DVec3::from_array(eye) * side,
                    target: DVec3::splat(0.45) * side,
                    up: DVec3::Z,
                    fov_degrees: 75.0,
                    width: 53,
                    height: 38,
                };
                let options = SetupOptions {
                    aa_log2,
                    lod_px,
                    ..SetupOptions::default()
                };
                let setup =
                    FrameSetup::new(&camera, &graph.placement, graph.depth, &options).unwrap();
                let mut fast = Fast::new(FastOptions::default(), Box::new(Machine::default()));
                let mut frame = Frame::new(setup.width, setup.height, false);
                fast.draw(&graph.view(), &setup, &mut frame).unwrap();
                let mut nodes = frame.clone();
                nodes.voxel.clear();
                for shading in [Shading::Lambert, Shading::Flat] {
                    for background in [Background::None, Background::default()] {
                        let plain = plain_colors(&frame, graph, &setup, shading, background);
                        let picture = resolve(&frame, graph, &setup, shading, background).unwrap();
                        assert_eq!(picture.rgba, plain, "{scene} {eye:?} {aa_log2} {lod_px}");
                        compared += picture.drawn();
                        // Nodes alone suffice where each is in one place.
                        let of_nodes = resolve(&nodes, graph, &setup, shading, background);
                        match graph.links.is_empty() {
                            true => assert_eq!(of_nodes.unwrap(), picture),
                            false => assert_eq!(of_nodes, Err(ResolveError::Voxel)),
                        }
                        let resolver =
                            Resolver::new(&frame, graph, &setup, shading, background).unwrap();
                        assert_eq!(hash_rows(&resolver), Ok(hash(&picture)));
                        let rgb: Vec<[u8; 3]> = resolver.colors(0..picture.height).unwrap();
                        assert!(rgb.iter().zip(&plain).all(|(a, b)| a[..] == b[..3]));
                    }
                }
            }
        }
    }
    assert!(compared > 100_000, "{compared}");
}
