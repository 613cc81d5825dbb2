//! Rare inputs for the machine's blocks: ends of their ranges, ties, and random numbers. No result leaves its word:
//! where a block adds, numbers stay some bits below the ends of the format.

use hwmodel::{Probe, Stage, WideWord, Word};

use super::directed_blending::{all_shares, blending};
use super::inputs::{Inputs, SPARE};
use crate::frame::{Frame, QuadNode};
use crate::graph::GraphView;
use crate::machine::MachineOptions;
use crate::machine::cage::{CageCoordinate, with_cage};
use crate::machine::children::{centre_and_order, child_cube, pool};
use crate::machine::engine::Machine;
use crate::machine::planes::{self, Silhouette};
use crate::machine::push::child_span;
use crate::machine::quadrants::{self, Halves};
use crate::machine::record::{Cube, ImagePlace, Planes, Pose, Record, Screen};
use crate::machine::state::State;
use crate::machine::verdict::apply_level_of_detail;
use crate::machine::{size, smallest_node, to_screen};
use crate::project::FrameSetup;
use crate::project::options::SCREEN_GUARD_SHIFT;

impl Machine {
    /// Gives `rounds` rounds of inputs to the blocks of a frame.
    pub fn show_directed<P: Probe>(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        probe: P,
        rounds: u32,
    ) -> P {
        with_cage!(setup, L => self.directed_as::<P, L>(graph, setup, probe, rounds))
    }

    fn directed_as<P: Probe, L: CageCoordinate>(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        probe: P,
        rounds: u32,
    ) -> P {
        let mut frame = Frame::nodes_only(setup.width, setup.height);
        let canvas = (self.emptied(setup, &mut frame), &mut frame);
        let options = MachineOptions::default();
        let mut state = State::<P, L, ()>::new(options, graph, setup, canvas, probe, ());
        let mut inputs = Inputs::new(setup);
        all_vectors(&mut state);
        let blends = setup.options.coverage.blends();
        if blends {
            all_shares(&mut state, &mut inputs);
        }
        for _ in 0..rounds {
            if blends {
                blending(&mut state, &mut inputs);
            }
            object_space(&mut state, &mut inputs);
            cages(&mut state, &mut inputs);
            fit(&mut state, &mut inputs);
            depths_and_sizes(&mut state, &mut inputs);
            if setup.options.coverage.draws_outlines() {
                outlines(&mut state, &mut inputs);
            } else {
                screen_space(&mut state, &mut inputs);
            }
        }
        state.finish().1
    }
}

fn all_vectors<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>) {
    for bits in 0..16u8 {
        let halves = |at: u8| Halves {
            low: bits >> at & 1 != 0,
            high: bits >> at & 2 != 0,
        };
        quadrants::quadrants(&mut state.dp, halves(0), halves(2));
    }
    let levels = state.job.constants.levels;
    let root = QuadNode::ROOT;
    for vector in 0..16u8 {
        let kept = state.canvas.fill.replace(root, vector);
        state.canvas.fill.is_full(&mut state.dp, root);
        for overlapped in 0..16 {
            state.canvas.fill.rejects(&mut state.dp, root, overlapped);
        }
        let _ = state.canvas.fill.replace(root, kept);
        if levels == 0 {
            continue;
        }
        for quadrant in 0..4 {
            // A sample whose vectors are those of the row, so that its parent's is updated.
            let mut parent = root;
            while parent.level + 1 < levels {
                parent = parent.quadrant(0);
            }
            let sample = parent.quadrant(quadrant);
            let before = state.canvas.fill.replace(sample, vector);
            let above = state.canvas.fill.replace(parent, vector);
            state.canvas.fill.mark(&mut state.dp, sample);
            let _ = state.canvas.fill.replace(sample, before);
            let _ = state.canvas.fill.replace(parent, above);
        }
    }
}

/// Cubes of object space: the whole range of words.
fn object_space<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let mut cube = inputs.cube(0);
    if inputs.flag() {
        // Both ends of the range: their sum has a carry.
        cube.max = cube.min;
    }
    for k in 0..3 {
        let centre = state.dp.midpoint(cube.min[k], cube.max[k]);
        let any = inputs.word(0);
        state.job.constants.eye_floor[k] = if inputs.flag() { centre } else { any };
    }
    let (centre, _) = centre_and_order(&mut state.dp, &state.job, &cube);
    let octant = inputs.level(7) as u8;
    let counts = &mut state.traversal.counts;
    child_cube(&mut state.dp, &state.job, counts, &cube, octant, &centre);
}

fn cages<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let cage = inputs.cage(state);
    state.dp.stage(Stage::VertexPool);
    pool(&mut state.dp, &cage);
    state.dp.stage(Stage::ChildBox);
    child_span(&mut state.dp, &cage);
}

/// X such that a node's edge, its bisector, or the limit of a box passes through the vertices, or nearly.
fn beside_an_edge<P: Probe, L: CageCoordinate>(
    state: &mut State<'_, P, L, ()>,
    inputs: &mut Inputs,
    w: &L,
) -> L {
    let dp = &mut state.dp;
    let x = match inputs.dice.below(6) {
        0 => w.map(|_| Word::ZERO),
        1 => *w,
        2 => w.map(|w| dp.neg(w)),
        3 => w.map(|w| dp.shl(w, 1)),
        4 => w.map(|w| dp.shr(w, 1)),
        _ => w.map(|_| inputs.word(SPARE)),
    };
    let x = x.map(|x| match inputs.dice.below(8) {
        0 => inputs.word(SPARE),
        _ => x,
    });
    let step = inputs.step();
    x.moved(&mut state.dp, step)
}

/// Boxes against quadtree nodes.
fn fit<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let mut clip = inputs.clip(state);
    [clip.x, clip.y] = [(); 2].map(|()| beside_an_edge(state, inputs, &clip.w));
    // A fit doubles planes once per level.
    let mut planes = Planes::default();
    for plane in planes.edge.as_flattened_mut() {
        *plane = WideWord::from_host(inputs.number(8));
    }
    let place = ImagePlace {
        quad: inputs.quad(state.job.constants.levels),
        inside: false,
    };
    state.dp.stage(Stage::QuadtreeFit);
    quadrants::of_clip(&mut state.dp, &state.job.constants, place.quad, &clip);
    let (dp, constants, fill) = (&mut state.dp, &state.job.constants, &state.canvas.fill);
    smallest_node::near_node(dp, &clip.x, &clip.w);
    smallest_node::near_node(dp, &clip.y, &clip.w);
    smallest_node::clip(dp, constants, fill, place, &mut clip, &mut planes);
}

fn depths_and_sizes<P: Probe, L: CageCoordinate>(
    state: &mut State<'_, P, L, ()>,
    inputs: &mut Inputs,
) {
    let mut clip = inputs.clip(state);
    let level = inputs.level(state.job.constants.depth);
    let least = inputs.word(1);
    let one = Word::from_host(inputs.number(1));
    clip.w_min = if inputs.flag() {
        state.dp.add(least, one)
    } else {
        inputs.word(0)
    };
    let kept = state.job.constants.lod_depth[level as usize].replace(least);
    let mut record = Record {
        cube: Cube {
            solid: false,
            ..inputs.cube(level)
        },
        place: ImagePlace::ROOT,
        pose: Pose::Clip(clip, Planes::default()),
    };
    state.dp.stage(Stage::OnePixel);
    apply_level_of_detail(&mut state.dp, &state.job.constants, &mut record);
    state.job.constants.lod_depth[level as usize] = kept;

    clip.w_min = inputs.word(SPARE);
    let below = inputs.level(state.job.constants.levels);
    let limit = state.job.constants.size_limit.clone();
    size::clip_at_most(&mut state.dp, &clip, &limit, below);
    let (edges_x, edges_w) = (inputs.words(SPARE), inputs.words(SPARE));
    let step = inputs.step();
    size::edges_at_most(&mut state.dp, edges_x, edges_w, |dp, size| {
        dp.add(size, step)
    });
}

fn outlines<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let depth = state.job.constants.depth;
    let mut planes = inputs.planes();
    let kept = state.job.constants.axis_ab;
    let axes = inputs.planes();
    state.job.constants.axis_ab = axes.edge.map(|[a, b, _]| [a, b]);
    if depth > 0 {
        let parent_level = inputs.level(depth - 1);
        let octant = inputs.level(7) as u8;
        state.dp.stage(Stage::VertexPool);
        planes::of_child(
            &mut state.dp,
            &state.job.constants,
            &planes,
            parent_level,
            octant,
        );
    }
    let quadrant = inputs.level(3) as u8;
    let mut moved = planes;
    state.dp.stage(Stage::QuadtreeFit);
    planes::move_to_quadrant(&mut state.dp, &state.job.constants, &mut moved, quadrant);
    let level = inputs.level(depth);
    let mut cube = inputs.cube(level);
    // The eye lies beside the cube along the other axes, beside one of its faces or anywhere along this one.
    let axis = inputs.level(2) as usize;
    for k in 0..3 {
        let [any, other] = inputs.words(0);
        let step = inputs.step();
        let c = &mut state.job.constants;
        let dp = &mut state.dp;
        if k < axis {
            (cube.min[k], cube.max[k]) = (dp.min(any, other), dp.max(any, other));
            (c.eye_floor[k], c.eye_ceil[k]) = (cube.min[k], cube.max[k]);
            continue;
        }
        let [min, max] = inputs.words(1);
        (cube.min[k], cube.max[k]) = (min, max);
        let (above, below) = (dp.add(max, step), dp.add(min, step));
        c.eye_floor[k] = if inputs.flag() { above } else { any };
        c.eye_ceil[k] = if inputs.flag() { below } else { other };
    }
    state.job.constants.positive = inputs.flag();
    if inputs.flag() {
        planes.edge = [planes.edge[0]; 3];
    }
    let w_min = inputs.word(0);
    state.dp.stage(Stage::Draw);
    let silhouette = Silhouette::new(&mut state.dp, &state.job.constants, &cube, &planes, w_min);
    for below in [0, 1] {
        let mut silhouette = silhouette.clone();
        silhouette.cover(&mut state.dp, below);
        silhouette.in_quadrant(&mut state.dp, quadrant);
    }
    state.job.constants.axis_ab = kept;
}

/// Boxes and centres in screen space, and the way there.
fn screen_space<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let place = ImagePlace {
        quad: inputs.quad(state.job.constants.levels),
        inside: inputs.flag(),
    };
    let [x, y] = [(); 2].map(|()| inputs.cage(state));
    let below = state.job.constants.levels - place.quad.level;
    let [left, right] = state.job.constants.half_sample_places;
    // Edges and middles of nodes, in halves of their width, or nearly.
    let mut beside = |column: u32| {
        let near = i64::from(column << 1) + inputs.dice.below(3) as i64;
        let edge = Word::from_host(near << (below + left) >> right);
        let step = inputs.step();
        match inputs.dice.below(4) {
            0 => inputs.word(SPARE),
            _ => state.dp.add(edge, step),
        }
    };
    let spans = [place.quad.x, place.quad.y].map(|column| (beside(column), beside(column)));
    state.dp.stage(Stage::QuadtreeFit);
    let fill = &state.canvas.fill;
    smallest_node::screen(&mut state.dp, &state.job.constants, fill, place, &spans);
    let screen = Screen { x, y, spans };
    let limit = if inputs.flag() {
        state.dp.sub(spans[0].1, spans[0].0)
    } else {
        inputs.word(SPARE)
    };
    state.dp.stage(Stage::OnePixel);
    size::screen_at_most(&mut state.dp, &screen, limit);
    state.dp.stage(Stage::Draw);
    size::screen_sample(&mut state.dp, &state.job.constants, place, &screen);

    let mut clip = inputs.clip(state);
    let centre = clip.x.centre(&mut state.dp);
    let step = inputs.step();
    let doubled = state.dp.shl(centre, 1);
    let w = match inputs.flag() {
        true => state.dp.add(doubled, step),
        false => inputs.word(SPARE),
    };
    // Centres beyond the node's edges are rejected.
    let across = ImagePlace {
        inside: false,
        ..place
    };
    size::clip_sample(&mut state.dp, &state.job.constants, across, &clip, w);
    let level = inputs.level(state.job.constants.depth) as usize;
    let least = if inputs.flag() { clip.w_min } else { w };
    if inputs.flag() {
        // The guard's edge passes through the vertices, in the whole picture.
        let dp = &mut state.dp;
        clip.x = clip.w.map(|w| {
            let part = dp.shr(w, SCREEN_GUARD_SHIFT);
            dp.neg(part)
        });
    }
    let kept = state.job.constants.screen_depth[level].replace(least);
    to_screen::may_change(
        &mut state.dp,
        &state.job.constants,
        level as u32,
        place,
        &clip,
    );
    state.job.constants.screen_depth[level] = kept;
}
