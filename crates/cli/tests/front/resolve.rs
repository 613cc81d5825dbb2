//! Frames become pictures: by hand, and against the plain rule.

use glam::DVec3;
use shiftvox::Scene;
use shiftvox::fast::{Fast, FastOptions};
use shiftvox::frame::{Frame, NO_NODE};
use shiftvox::graph::{Graph, PackedNormal, Placement};
use shiftvox::machine::Machine;
use shiftvox::picture::{
    Background, NO_DEPTH, ResolveError, Resolver, Shader, Shading, hash, hash_rows, resolve,
};
use shiftvox::project::{Camera, Engine, FrameSetup, SetupOptions};

/// Three voxels without children: red, green and blue. The last one has a normal along +X.
fn graph(placement: Placement) -> Graph {
    let normals = [0, 0, 255 << 8 | 128].map(PackedNormal);
    Graph {
        depth: 2,
        root: 0,
        mask: Vec::new().into(),
        first: Vec::new().into(),
        links: Vec::new().into(),
        color: vec![[255, 0, 0], [0, 255, 0], [0, 0, 255]].into(),
        opacity: Vec::new().into(),
        normal: normals.to_vec().into(),
        level_start: Vec::new(),
        voxels: 3,
        placement,
    }
}

/// A square picture of a cube of 4 voxels, with eye and target in voxels.
fn small(
    placement: Placement,
    side: u32,
    aa_log2: u32,
    [eye, target]: [DVec3; 2],
) -> (FrameSetup, Graph) {
    let origin = DVec3::from_array(placement.origin_index.map(|i| i as f64));
    let world = |voxel: DVec3| {
        DVec3::from_array(placement.world_origin) + (voxel + origin) * placement.voxel_size
    };
    let setup = setup(
        &placement,
        2,
        [world(eye), world(target)],
        40.0,
        (side, side),
        [aa_log2, 0],
    );
    (setup, graph(placement))
}

fn setup(
    placement: &Placement,
    depth: u32,
    [eye, target]: [DVec3; 2],
    fov_degrees: f64,
    size: (u32, u32),
    [aa_log2, lod_px]: [u32; 2],
) -> FrameSetup {
    let camera = Camera::looking(eye, target, fov_degrees, size);
    let mut options = SetupOptions::default();
    (options.aa_log2, options.lod_px) = (aa_log2, f64::from(lod_px));
    FrameSetup::new(&camera, placement, depth, &options).unwrap()
}

/// Along +Y at the middle of the cube, from 6 voxels before its front face.
const FRONT: [DVec3; 2] = [DVec3::new(2.0, -6.0, 2.0), DVec3::splat(2.0)];

fn see(frame: &mut Frame, x: u32, y: u32, node: u32, voxel: [i32; 4]) {
    let at = (y * frame.width + x) as usize;
    frame.node[at] = node;
    frame.voxel[at] = voxel;
}

#[test]
fn depth_is_where_the_ray_enters() {
    let placement = Placement {
        origin_index: [-7, 100, 3],
        world_origin: [0.5, -2.0, 8.0],
        voxel_size: 0.25,
        mesh: None,
    };
    let (setup, graph) = small(placement, 3, 0, FRONT);
    let mut frame = Frame::new(3, 3, false);
    // The middle ray runs along +Y through (2, y, 2), on the edge of four voxels. It enters or touches the whole object
    // and one of its octants.
    see(&mut frame, 1, 1, 0, [0, 0, 0, 0]);
    // Missed by its ray: the depth of the centre, (0.5, 3.5, 0.5).
    see(&mut frame, 2, 0, 1, [0, 3, 0, 2]);
    // The slanted ray enters the octant at y 2 from the side or the front.
    see(&mut frame, 0, 1, 2, [0, 2, 0, 1]);
    let picture = resolve(&frame, &graph, &setup, Shading::Flat, Background::None).unwrap();
    let depths = [4, 2, 3].map(|at: usize| (picture.depth[at] * 4e5).round() / 1e5);
    assert_eq!((depths, picture.depth[0]), ([6.0, 9.5, 8.0], NO_DEPTH));
    let voxels = [2, 3, 0].map(|at: usize| picture.voxel[at]);
    assert_eq!(voxels, [[-7, 103, 3, 2], [-7, 102, 3, 1], [0, 0, 0, -1]]);
    assert_eq!((picture.node[0], picture.node[3]), (-1, 2));
    // No normal of its own: the face that is entered. The last has one.
    assert_eq!(
        [picture.normal[4], picture.normal[3]],
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]
    );
    frame.height = 2;
    assert!(resolve(&frame, &graph, &setup, Shading::Flat, Background::None).is_err());
    // From within a voxel it is zero, also of a voxel behind the eye.
    for target in [DVec3::splat(2.0), DVec3::new(-2.0, 0.0, 0.0)] {
        let within = [DVec3::new(1.3, 1.2, 1.1), target];
        let (setup, graph) = small(Placement::default(), 2, 0, within);
        let mut frame = Frame::new(2, 2, false);
        see(&mut frame, 0, 0, 0, [0, 0, 0, 1]);
        let picture = resolve(&frame, &graph, &setup, Shading::Lambert, Background::None);
        assert_eq!(picture.unwrap().depth[0], 0.0);
    }
}

#[test]
fn samples_are_averaged_in_linear_light() {
    let (setup, graph) = small(Placement::default(), 1, 1, FRONT);
    let mut frame = Frame::new(2, 2, true);
    see(&mut frame, 0, 0, 0, [0, 0, 3, 2]);
    see(&mut frame, 1, 1, 1, [3, 0, 0, 2]);
    frame.records = Some(vec![1.0, 2.0, 3.0, 4.0]);
    let backgrounds = [
        Background::Color([0; 3]),
        Background::Color([255; 3]),
        Background::None,
    ];
    let pictures = backgrounds
        .map(|background| resolve(&frame, &graph, &setup, Shading::Flat, background).unwrap());
    // A quarter of full light is byte 137, half of it 188. Without a background: the mean of the two that see something,
    // at half coverage.
    assert_eq!(
        pictures.each_ref().map(|picture| picture.rgba[0]),
        [[137, 137, 0, 255], [225, 225, 188, 255], [188, 188, 0, 128]]
    );
    // The other buffers are those of the sample right of and below the middle; records add up.
    let [picture, ..] = pictures;
    assert_eq!((picture.node[0], picture.voxel[0]), (1, [3, 0, 0, 2]));
    assert_eq!(picture.records, Some(vec![10.0]));
}

/// The picture's colours by the words of `spec/picture.md`, sample by sample.
fn plain_colors(frame: &Frame, shader: &Shader<'_>, side: u32) -> Vec<[u8; 4]> {
    let samples = side * side;
    let pixel = |at: u32| {
        let width = frame.width / side;
        let (mut sum, mut seen) = ([0u32; 3], 0u32);
        for sample in 0..samples {
            let x = at % width * side + sample % side;
            let y = at / width * side + sample / side;
            let at = (y * frame.width + x) as usize;
            let is_seen = frame.node[at] != NO_NODE;
            seen += u32::from(is_seen);
            let light = match is_seen {
                true => shader.light(x, y, frame.node[at], frame.voxel[at]),
                false => shader.background().unwrap_or([0; 3]),
            };
            sum = [0, 1, 2].map(|c| sum[c] + light[c]);
        }
        let counted = shader.background().map_or(seen, |_| samples);
        if counted == 0 {
            return [0; 4];
        }
        let [r, g, b] = shader.encode(sum.map(|c| (c + counted / 2) / counted));
        [r, g, b, ((255 * counted + samples / 2) / samples) as u8]
    };
    (0..frame.width * frame.height / samples)
        .map(pixel)
        .collect()
}

/// Scenes with and without normals, drawn from outside, near and within.
#[test]
fn colours_are_those_of_the_plain_rule() {
    let mut compared = 0;
    for spec in "terrain,depth=6 menger,depth=3 random,depth=4 wires,depth=5".split(' ') {
        let scene = Scene::generate(spec).unwrap();
        let mut without = scene.graph().clone();
        without.normal = vec![PackedNormal::NONE; without.len()].into();
        for (graph, eye, aa_log2, lod_px) in [
            (scene.graph(), [1.6, -0.7, 1.25], 0, 0),
            (scene.graph(), [1.6, -0.7, 1.25], 1, 1),
            (scene.graph(), [0.47, 0.52, 0.61], 0, 3),
            (&without, [-0.9, 1.3, 0.8], 0, 0),
            (&without, [-0.9, 1.3, 0.8], 2, 1),
        ] {
            let side = f64::from(1u32 << graph.depth);
            let eye_and_target = [DVec3::from_array(eye), DVec3::splat(0.45)].map(|at| at * side);
            let fine = [aa_log2, lod_px];
            let setup = setup(
                &graph.placement,
                graph.depth,
                eye_and_target,
                75.0,
                (53, 38),
                fine,
            );
            let mut fast = Fast::new(FastOptions::default(), Box::new(Machine::default()));
            let mut frame = Frame::new(setup.width, setup.height, false);
            fast.render(&graph.view(), &setup, &mut frame).unwrap();
            let mut nodes = frame.clone();
            nodes.voxel.clear();
            for (shading, background) in [
                (Shading::Lambert, Background::None),
                (Shading::Lambert, Background::default()),
                (Shading::Flat, Background::None),
            ] {
                let shader = Shader::new(graph, &setup, shading, background);
                let plain = plain_colors(&frame, &shader, 1 << aa_log2);
                let picture = resolve(&frame, graph, &setup, shading, background).unwrap();
                assert_eq!(picture.rgba, plain, "{spec} {eye:?} {aa_log2} {lod_px}");
                compared += picture.drawn();
                for (at, node) in picture.node.iter().enumerate() {
                    let is_drawn = [picture.depth[at].is_finite(), picture.voxel[at][3] >= 0];
                    assert_eq!(is_drawn, [*node >= 0; 2], "{spec}");
                    let length = glam::Vec3::from_array(picture.normal[at]).length();
                    assert!(
                        (length - f32::from(u8::from(*node >= 0))).abs() < 1e-5,
                        "{length}"
                    );
                }
                // Nodes alone suffice where each is in one place.
                let of_nodes = resolve(&nodes, graph, &setup, shading, background);
                match graph.links.is_empty() {
                    true => assert_eq!(of_nodes.unwrap(), picture),
                    false => assert_eq!(of_nodes, Err(ResolveError::Voxel)),
                }
                let resolver = Resolver::new(&frame, graph, &setup, shading, background).unwrap();
                assert_eq!(hash_rows(&resolver), Ok(hash(&picture)));
                let rgb: Vec<[u8; 3]> = resolver.colors(0..picture.height).unwrap();
                assert!(rgb.iter().zip(&plain).all(|(a, b)| a[..] == b[..3]));
            }
        }
    }
    assert!(compared > 30_000, "{compared}");
}
