//! The rule that blends, against a plain reference.

use crate::common::*;
use crate::scenes::*;
use glam::DVec3;
use proptest::prelude::*;
use shiftvox::frame::{Blend, Frame, NO_NODE};
use shiftvox::graph::Graph;
use shiftvox::machine::Machine;
use shiftvox::project::{Camera, Coverage, Engine, SetupOptions};

/// The blend of a ray, nearest voxel first: `SPEC.md`, section 11, in products and quotients. `None`: it grazes one.
fn reference(graph: &Graph, light: &[[u16; 3]], camera: &Camera, at: [f64; 2]) -> Option<Blend> {
    let axes = camera.axes().expect("a camera");
    let across = at[0] - f64::from(camera.width) / 2.0;
    let down = at[1] - f64::from(camera.height) / 2.0;
    let ray = axes.forward * axes.focal_px + axes.right * across - axes.up * down;
    let mut met = Vec::new();
    for cell in graph.voxels() {
        let corner = DVec3::from_array(cell.corner.map(f64::from));
        let [low, high] = [0.0, 1.0].map(|side| (corner + side - camera.eye) / ray);
        let (enter, leave) = (low.min(high).max_element(), low.max(high).min_element());
        if (enter - leave).abs() < 1e-5 * leave.abs() {
            return None;
        }
        if enter < leave && leave > 0.0 {
            met.push((enter, cell.node as usize, cell.corner.map(i64::from)));
        }
    }
    met.sort_by(|a, b| a.0.total_cmp(&b.0));
    let eye = camera.eye.to_array().map(|c| c.floor() as i64);
    let mut sample = Blend::default();
    for (_, node, corner) in met {
        let way = [0, 1, 2].map(|k| (corner[k] - eye[k]).abs());
        let all = way.iter().sum::<i64>().max(1);
        let nearest = |k: usize| (32 * way[k] / all + 1) / 2;
        let x = nearest(0);
        let y = nearest(1).min(16 - x);
        let squares = [x, y, 16 - x - y].map(|share| (share * share) as f64);
        let length = squares.iter().sum::<f64>().sqrt().round();
        let (mut weight, mut is_whole) = (0, false);
        for k in 0..3 {
            let sides = graph.opacity[node].0[k];
            let nibble = match corner[k] <= eye[k] {
                true => sides >> 4,
                false => sides & 15,
            };
            // Halves up: no square over a length ends in a quarter of a half.
            weight += i64::from(nibble + nibble / 8) * (squares[k] / length + 0.5).floor() as i64;
            is_whole |= nibble == 15;
        }
        let weight = if is_whole { 256 } else { weight };
        let left = i64::from(sample.left);
        let mut taken = (left * weight + 128) / 256;
        if left - taken <= 64 && weight > 0 {
            taken = left;
        }
        sample.left -= taken as u16;
        for c in 0..3 {
            sample.light[c] += taken as u32 * u32::from(light[node][c]);
        }
    }
    Some(sample)
}

fn any_opacities() -> impl Strategy<Value = Vec<[u8; 3]>> {
    let nibble = prop_oneof![2 => Just(0u8), 1 => Just(15), 4 => 0..16u8];
    let byte = (nibble.clone(), nibble).prop_map(|(low, high)| low | high << 4);
    proptest::collection::vec(proptest::array::uniform3(byte), 700)
}

proptest! {
    #![proptest_config(cases(30))]

    #[test]
    fn each_sample_is_what_its_ray_takes(
        graph in any_octree(3, 0.4),
        opacities in any_opacities(),
        seed: u64,
    ) {
        // From outside, beside all lattice planes, and leaves of the finest level alone: the reference in f64 handles no
        // more.
        let camera = camera_at(CameraPlace::Outside, &graph, (23, 17), &mut Dice::new(seed));
        prop_assume!((camera.eye - camera.eye.round()).abs().min_element() > 1e-3);
        let graph = with_opacities(&graph, &opacities);
        let light = lights(&graph);
        let options = SetupOptions { lod_px: 0.0, ..SetupOptions::of(Coverage::Alpha) };
        let setup = setup(&graph, &camera, &options);
        let view = graph.lit(&light);
        let mut frame = Frame::new(setup.width, setup.height, false);
        let drawn = Machine::default().render(&view, &setup, &mut frame);
        prop_assert!(drawn.is_ok());
        for (sample, drawn) in (0..).zip(frame.blend.expect("blended")) {
            let (x, y) = (sample % camera.width, sample / camera.width);
            let at = [x, y].map(|c| f64::from(c) + 0.5);
            if let Some(right) = reference(&graph, &light, &camera, at) {
                prop_assert_eq!(drawn, right, "at {}, {}", x, y);
            }
        }
    }

    /// The promises of `SPEC.md`, section 11.
    #[test]
    fn opaque_voxels_are_exact_and_more_opacity_leaves_less(
        (graph, camera) in any_view(any_octree(3, 0.4), 5..24),
        opacities in any_opacities(),
        more in any_opacities(),
    ) {
        let drawn = |graph: &Graph, coverage| {
            let (frame, _) = draw(graph, &setup(graph, &camera, &SetupOptions::of(coverage)));
            let left = frame.blend.iter().flatten().map(|blend| blend.left);
            (left.collect::<Vec<u16>>(), frame)
        };
        let left = |opacities: &[[u8; 3]]| {
            drawn(&with_opacities(&graph, opacities), Coverage::Alpha).0
        };
        let (_, exact) = drawn(&graph, Coverage::Exact);
        let (opaque_left, opaque) = drawn(&graph, Coverage::Alpha);
        prop_assert_eq!((&opaque.node, &opaque.voxel), (&exact.node, &exact.voxel));
        let all_or_nothing = exact.node.iter().map(|&node| if node == NO_NODE { 256 } else { 0 });
        prop_assert_eq!(opaque_left, all_or_nothing.collect::<Vec<u16>>());

        let nibbles = |a: u8, b: u8| (a & 15).max(b & 15) | (a & 240).max(b & 240);
        let most = |(a, b): (&[u8; 3], &[u8; 3])| [0, 1, 2].map(|k| nibbles(a[k], b[k]));
        let more: Vec<_> = opacities.iter().zip(&more).map(most).collect();
        prop_assert!(left(&more).iter().zip(&left(&opacities)).all(|(more, some)| more <= some));
    }
}
