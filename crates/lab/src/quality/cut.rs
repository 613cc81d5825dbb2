//! The cut of a frame: the nodes that its level of detail draws as solids.

use shiftvox::graph::{Graph, Store};
use shiftvox::project::FrameSetup;

/// The graph at the level of detail of a camera: nodes that a frame with this set-up draws as solids
/// have no children.
///
/// The decision is that of clip space: a node with children is a solid if its least depth is at
/// least the set-up's depth for its level (`FrameSetup::lod_depth`). It depends on the camera and on
/// the level and place of the node, not on the coverage rule. (In screen space `any` and `center`
/// decide by a record's box, with results around this one.) Nodes entirely behind the eye are
/// solids, too: they are never visible. Shared and cyclic nodes are written once per place.
#[must_use]
pub fn cut_at(graph: &Graph, setup: &FrameSetup) -> Graph {
    /// A node at a place.
    struct Cell {
        node: u32,
        level: u32,
        corner: [i64; 3],
    }
    let depth_of = |cell: &Cell| {
        // Least and greatest depth of the eight corners: linear, so by edges.
        let side = 1i128 << (graph.depth - cell.level);
        let mut least = i128::from(setup.origin_clip[2]);
        let mut greatest = least;
        for k in 0..3 {
            let edge = i128::from(setup.edge_clip[k][2]);
            let low = edge * i128::from(cell.corner[k]);
            least += low + (edge * side).min(0);
            greatest += low + (edge * side).max(0);
        }
        (least, greatest)
    };
    let mut cells = vec![Cell {
        node: graph.root,
        level: 0,
        corner: [0; 3],
    }];
    let (mut mask, mut first) = (Vec::new(), Vec::new());
    let mut place = 0;
    while let Some(cell) = cells.get(place) {
        let (least, greatest) = depth_of(cell);
        let limit = setup.lod_depth.get(cell.level as usize);
        let is_small = limit.is_some_and(|&limit| limit != i64::MAX && least >= limit.into());
        let is_solid = cell.level >= graph.depth || is_small || greatest <= 0;
        let (level, corner) = (cell.level + 1, cell.corner);
        let children = if is_solid {
            [None; 8]
        } else {
            graph.children(cell.node)
        };
        let mut bits = 0u8;
        first.push(cells.len() as u32);
        for (octant, node) in children.into_iter().enumerate() {
            let Some(node) = node else { continue };
            bits |= 1 << octant;
            let side = 1i64 << (graph.depth - level);
            let axis = |k: usize| corner[k] + side * (octant as i64 >> (2 - k) & 1);
            cells.push(Cell {
                node,
                level,
                corner: [axis(0), axis(1), axis(2)],
            });
        }
        mask.push(bits);
        place += 1;
    }
    let voxels = mask.iter().filter(|&&bits| bits == 0).count();
    Graph {
        depth: graph.depth,
        root: 0,
        mask: Store::from(mask),
        first: Store::from(first),
        links: Store::from(Vec::new()),
        color: Store::from(
            cells
                .iter()
                .map(|c| graph.color_of(c.node))
                .collect::<Vec<_>>(),
        ),
        normal: Store::from(
            cells
                .iter()
                .map(|c| graph.normal_of(c.node))
                .collect::<Vec<_>>(),
        ),
        opacity: match graph.opacity.is_empty() {
            true => Store::from(Vec::new()),
            false => Store::from(
                cells
                    .iter()
                    .map(|c| graph.view().opacity_of(c.node))
                    .collect::<Vec<_>>(),
            ),
        },
        level_start: Vec::new(),
        voxels: voxels as u64,
        placement: graph.placement,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use shiftvox::frame::Frame;
    use shiftvox::graph::Placement;
    use shiftvox::project::{Camera, Engine, SetupOptions};
    use shiftvox::rays::Rays;

    /// Sierpinski's tetrahedron of so many levels: one node.
    fn sierpinski(depth: u32) -> Graph {
        crate::test_graphs::one_node(depth, 0b0110_1001, [9, 8, 7])
    }

    fn set_up(away: f64, lod_px: f64) -> FrameSetup {
        let camera = Camera {
            eye: DVec3::new(8.3, 8.1 - away, 9.2),
            target: DVec3::new(8.3, 9.1 - away, 9.2),
            up: DVec3::Z,
            fov_degrees: 60.0,
            width: 64,
            height: 64,
        };
        let options = SetupOptions {
            lod_px,
            ..SetupOptions::default()
        };
        FrameSetup::new(&camera, &Placement::default(), 4, &options).unwrap()
    }

    #[test]
    fn the_cut_is_what_is_drawn() {
        let graph = sierpinski(4);
        for away in [20.0, 60.0, 300.0] {
            let setup = set_up(away, 1.0);
            let cut = cut_at(&graph, &setup);
            let draw = |graph: &Graph, setup: &FrameSetup| {
                let mut frame = Frame::new(64, 64, false);
                Rays.render(&graph.view(), setup, &mut frame).unwrap();
                frame.voxel
            };
            assert_eq!(draw(&cut, &setup.without_detail()), draw(&graph, &setup));
        }
    }

    #[test]
    fn without_level_of_detail_the_cut_is_the_scene() {
        let graph = sierpinski(4);
        let setup = set_up(30.0, 0.0);
        let cut = cut_at(&graph, &setup);
        assert_eq!(cut.validate(), Ok(()));
        assert_eq!(cut.voxels, graph.voxels);
        let draw = |graph: &Graph| {
            let mut frame = Frame::new(64, 64, false);
            Rays.render(&graph.view(), &setup, &mut frame).unwrap();
            frame.voxel
        };
        assert_eq!(draw(&cut), draw(&graph));
    }

    #[test]
    fn farther_away_fewer_nodes_are_left() {
        let graph = sierpinski(4);
        let nodes =
            [20.0, 60.0, 300.0, 5000.0].map(|away| cut_at(&graph, &set_up(away, 1.0)).len());
        assert!(nodes.windows(2).all(|w| w[0] >= w[1]), "{nodes:?}");
        assert!(nodes[0] > 4 * nodes[2] && nodes[3] == 1, "{nodes:?}");
        // All of it behind the eye.
        assert_eq!(cut_at(&graph, &set_up(-60.0, 0.0)).len(), 1);
    }
}
