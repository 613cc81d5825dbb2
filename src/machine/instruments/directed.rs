//! Inputs that a frame seldom or never brings, given to the machine's blocks: ends of their ranges, ties, and
//! random numbers. The probe sees what crosses the blocks' borders, as it does in a frame.
//!
//! Every input is such that no result leaves its word: where a block adds, numbers keep some bits' distance from
//! the ends of the format; where it does not, they do not.

use hwmodel::{Narrow, Probe, Stage, WideWord, Word};

use crate::frame::{Blend, Frame, QuadNode};
use crate::graph::{GraphView, Opacity};
use crate::machine::MachineOptions;
use crate::machine::alpha::BlendColor;
use crate::machine::cage::{CageCoordinate, with_cage};
use crate::machine::children::{child_span, pool};
use crate::machine::constants::BlendEye;
use crate::machine::engine::Machine;
use crate::machine::planes::{self, Silhouette};
use crate::machine::quadrants::{self, Halves};
use crate::machine::record::{Clip, Cube, ImagePlace, Planes, Pose, Record, Screen};
use crate::machine::smallest_node::{self, Fill};
use crate::machine::state::State;
use crate::machine::{size, to_screen};
use crate::project::options::SCREEN_GUARD_SHIFT;
use crate::project::{ALL_LEFT, Coverage, FrameSetup, OPAQUE_ENOUGH, SHARES};
use crate::split_mix::SplitMix;

/// Bits that words keep from the ends of the format where they are added, doubled or halved a few times.
const SPARE: u32 = 8;

/// Numbers at the ends of ranges, and random ones.
struct Inputs {
    dice: SplitMix,
    bits: u32,
    wide_bits: u32,
}

impl Inputs {
    /// A number of at most `bits` bits with its sign: an end of the range, next to nothing, or any.
    fn number(&mut self, bits: u32) -> i64 {
        let most = i64::MAX >> (64 - bits);
        let ends = [-most - 1, -most, most, most - 1, -2, -1, 0, 1, 2];
        // Every third is one of these.
        let choice = self.dice.below(27) as usize;
        if let Some(&end) = ends.get(choice) {
            return end;
        }
        // As many bits as any other number of bits.
        let length = 1 + self.dice.below(u64::from(bits)) as u32;
        (self.dice.bits() as i64) >> (64 - length)
    }

    fn word(&mut self, spare: u32) -> Word {
        Word::from_host(self.number(self.bits - spare))
    }

    fn words<const N: usize>(&mut self, spare: u32) -> [Word; N] {
        std::array::from_fn(|_| self.word(spare))
    }

    fn flag(&mut self) -> bool {
        self.dice.below(2) == 1
    }

    /// -1, 0 or 1.
    fn step(&mut self) -> Word {
        Word::from_host(self.dice.below(3) as i64 - 1)
    }

    fn level(&mut self, most: u32) -> u32 {
        self.dice.below(u64::from(most) + 1) as u32
    }

    /// A coordinate whose numbers are independent of one another.
    fn cage<P: Probe, L: CageCoordinate>(&mut self, state: &mut State<'_, P, L, ()>) -> L {
        let any = L::from_frame(&mut state.dp, Word::ZERO, [Word::ZERO; 3]);
        any.map(|_| self.word(SPARE))
    }

    fn clip<P: Probe, L: CageCoordinate>(&mut self, state: &mut State<'_, P, L, ()>) -> Clip<L> {
        let [x, y, w] = [(); 3].map(|()| self.cage(state));
        let (w_min, _) = w.span(&mut state.dp);
        Clip { x, y, w, w_min }
    }

    /// Planes of small coefficients, which have ties, or of large ones.
    fn planes(&mut self) -> Planes {
        let bits = if self.flag() { 2 } else { self.wide_bits >> 1 };
        let mut number = || WideWord::from_host(self.number(bits));
        Planes {
            edge: std::array::from_fn(|_| std::array::from_fn(|_| number())),
            axis_c: std::array::from_fn(|_| number()),
        }
    }

    fn cube(&mut self, level: u32) -> Cube {
        Cube {
            min: self.words(0),
            max: self.words(0),
            node: 0,
            level,
            voxel_level: level,
            solid: true,
        }
    }

    fn quad(&mut self, levels: u32) -> QuadNode {
        let level = self.level(levels);
        let mut place = || self.dice.below(1 << level) as u32;
        QuadNode {
            level,
            x: place(),
            y: place(),
        }
    }
}

impl Machine {
    /// Gives inputs of `rounds` rounds to the blocks of a frame.
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
        let mut inputs = Inputs {
            dice: SplitMix::new(0),
            bits: setup.format.bits(),
            wide_bits: setup.format.wide().bits(),
        };
        all_vectors(&mut state);
        let blends = setup.options.coverage == Coverage::Alpha;
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

/// All short vectors: there are few.
fn all_vectors<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>) {
    for bits in 0..16u8 {
        let halves = |at: u8| Halves {
            low: bits >> at & 1 != 0,
            high: bits >> at & 2 != 0,
        };
        quadrants::quadrants(&mut state.dp, halves(0), halves(2));
    }
    let levels = state.constants.levels;
    let root = QuadNode::ROOT;
    for vector in 0..16u8 {
        let kept = state.canvas.fill.replace(root, vector);
        state.is_full(root);
        let fill = Fill {
            vectors: &state.canvas.fill,
            reject: true,
        };
        for overlapped in 0..16 {
            fill.rejects(&mut state.dp, root, overlapped);
        }
        let _ = state.canvas.fill.replace(root, kept);
        if levels == 0 {
            continue;
        }
        for quadrant in 0..4 {
            // A sample below which vectors stand as in the row, so that its parent's is updated.
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
        state.constants.eye_floor[k] = if inputs.flag() { centre } else { any };
    }
    let (centre, _) = state.centre_and_order(&cube);
    let octant = inputs.level(7) as u8;
    state.child_cube(&cube, octant, &centre);
}

/// Cages by themselves.
fn cages<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let cage = inputs.cage(state);
    state.dp.stage(Stage::VertexPool);
    pool(&mut state.dp, &cage);
    state.dp.stage(Stage::ChildBox);
    child_span(&mut state.dp, &cage);
}

/// X, such that a node's edge, its bisector, or where a box leaves it too far, goes through the vertices, or nearly.
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
    // A fit doubles planes once a level.
    let mut planes = Planes::default();
    for plane in planes.edge.as_flattened_mut() {
        *plane = WideWord::from_host(inputs.number(8));
    }
    let place = ImagePlace {
        quad: inputs.quad(state.constants.levels),
        inside: false,
    };
    state.dp.stage(Stage::QuadtreeFit);
    quadrants::of_clip(&mut state.dp, &state.constants, place.quad, &clip);
    let fill = Fill {
        vectors: &state.canvas.fill,
        reject: true,
    };
    let (dp, constants) = (&mut state.dp, &state.constants);
    smallest_node::near_node(dp, &clip.x, &clip.w);
    smallest_node::near_node(dp, &clip.y, &clip.w);
    smallest_node::clip(dp, constants, &fill, place, &mut clip, &mut planes);
}

/// Comparisons of depths and sizes, with ties.
fn depths_and_sizes<P: Probe, L: CageCoordinate>(
    state: &mut State<'_, P, L, ()>,
    inputs: &mut Inputs,
) {
    let mut clip = inputs.clip(state);
    let level = inputs.level(state.constants.depth);
    let least = inputs.word(1);
    let one = Word::from_host(inputs.number(1));
    clip.w_min = if inputs.flag() {
        state.dp.add(least, one)
    } else {
        inputs.word(0)
    };
    let kept = state.constants.lod_depth[level as usize].replace(least);
    let mut record = Record {
        cube: Cube {
            solid: false,
            ..inputs.cube(level)
        },
        place: ImagePlace::ROOT,
        pose: Pose::Clip(clip, Planes::default()),
    };
    state.dp.stage(Stage::OnePixel);
    state.apply_level_of_detail(&mut record);
    state.constants.lod_depth[level as usize] = kept;

    clip.w_min = inputs.word(SPARE);
    let below = inputs.level(state.constants.levels);
    let limit = state.constants.size_limit.clone();
    size::clip_at_most(&mut state.dp, &clip, &limit, below);
    let (edges_x, edges_w) = (inputs.words(SPARE), inputs.words(SPARE));
    let step = inputs.step();
    size::edges_at_most(&mut state.dp, edges_x, edges_w, |dp, size| {
        dp.add(size, step)
    });
}

/// Silhouettes.
fn outlines<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let depth = state.constants.depth;
    let mut planes = inputs.planes();
    let kept = state.constants.axis_ab;
    let axes = inputs.planes();
    state.constants.axis_ab = axes.edge.map(|[a, b, _]| [a, b]);
    if depth > 0 {
        let parent_level = inputs.level(depth - 1);
        let octant = inputs.level(7) as u8;
        state.dp.stage(Stage::VertexPool);
        planes::of_child(
            &mut state.dp,
            &state.constants,
            &planes,
            parent_level,
            octant,
        );
    }
    let quadrant = inputs.level(3) as u8;
    let mut moved = planes;
    state.dp.stage(Stage::QuadtreeFit);
    planes::move_to_quadrant(&mut state.dp, &state.constants, &mut moved, quadrant);
    let level = inputs.level(depth);
    let mut cube = inputs.cube(level);
    // The eye lies beside the cube along the other axes, beside a face of it or anywhere along this one.
    let axis = inputs.level(2) as usize;
    for k in 0..3 {
        let [any, other] = inputs.words(0);
        let step = inputs.step();
        let c = &mut state.constants;
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
    state.constants.positive = inputs.flag();
    if inputs.flag() {
        planes.edge = [planes.edge[0]; 3];
    }
    let w_min = inputs.word(0);
    state.dp.stage(Stage::Draw);
    let silhouette = Silhouette::new(&mut state.dp, &state.constants, &cube, &planes, w_min);
    for below in [0, 1] {
        let mut silhouette = silhouette.clone();
        silhouette.cover(&mut state.dp, below);
        silhouette.in_quadrant(&mut state.dp, quadrant);
    }
    state.constants.axis_ab = kept;
}

/// A voxel of any opacities that is seen along ways, from an eye beside its centre; `shift`: of the eye.
fn blend_voxel<P: Probe, L: CageCoordinate>(
    state: &mut State<'_, P, L, ()>,
    inputs: &mut Inputs,
    (ways, shift): ([Word; 3], u32),
) {
    let mut cube = inputs.cube(0);
    let dp = &mut state.dp;
    for k in 0..3 {
        // The sum of both ends may have a carry; an odd one loses its half.
        let [a, b] = inputs.words(SPARE);
        (cube.min[k], cube.max[k]) = (a, if inputs.flag() { a } else { b });
    }
    let centre: [Word; 3] = std::array::from_fn(|k| dp.midpoint(cube.min[k], cube.max[k]));
    let eye = BlendEye {
        shift,
        at: std::array::from_fn(|k| {
            let centre = dp.shr(centre[k], shift);
            match inputs.flag() {
                true => dp.add(centre, ways[k]),
                false => dp.sub(centre, ways[k]),
            }
        }),
    };
    // Any side of each voxel, also with the eye in its centre.
    let eye_floor = std::array::from_fn(|k| {
        let step = inputs.step();
        dp.add(centre[k], step)
    });
    // Full, just not, half, or any.
    let mut side = || match inputs.dice.below(6) {
        0..=2 => 15,
        3 => [14, 8, 7][inputs.dice.below(3) as usize],
        _ => inputs.dice.below(16) as u8,
    };
    let opacity = Opacity::new(std::array::from_fn(|_| [side(), side()]));
    BlendColor::of_voxel(dp, &eye, &eye_floor, &cube, opacity, [0; 3]);
}

/// All shares of the three sides: ways whose sum is 16 are shares.
fn all_shares<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    for x in 0..=SHARES {
        for y in 0..=SHARES - x {
            let ways = [x, y, SHARES - x - y].map(Word::from_host);
            blend_voxel(state, inputs, (ways, 0));
        }
    }
}

/// Blending: ways with ties of their shares or of any size, and samples of which a part of the light is left.
fn blending<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let bits = if inputs.flag() {
        6
    } else {
        inputs.bits - SPARE
    };
    let ways = std::array::from_fn(|_| Word::from_host(inputs.number(bits)));
    let shift = inputs.level(3);
    blend_voxel(state, inputs, (ways, shift));

    let all = u64::from(ALL_LEFT);
    let left = match inputs.flag() {
        true => all,
        false => inputs.dice.below(all + 1),
    };
    // As much as leaves a sample just open or just full; all; any.
    let enough = left.saturating_sub(u64::from(OPAQUE_ENOUGH)) * all / left.max(1);
    let weight = match inputs.dice.below(4) {
        0 => inputs.dice.below(all + 1),
        1 => all,
        _ => (enough + inputs.dice.below(3)).min(all),
    };
    let light = [(); 3].map(|()| match inputs.dice.below(3) {
        0 => u64::from(u16::MAX),
        _ => inputs.dice.below(1 << 16),
    });
    // What a sample has is no more than what it took of the light.
    let most = (all - left) * u64::from(u16::MAX);
    let sums = [(); 3].map(|()| match inputs.dice.below(3) {
        0 => most,
        _ => inputs.dice.below(most + 1),
    });
    let color = BlendColor {
        weight: Narrow::from_host(weight as u32),
        light: light.map(|channel| Narrow::from_host(channel as u32)),
    };
    let mut sample = Blend {
        left: left as u16,
        light: sums.map(|sum| sum as u32),
    };
    color.add_to(&mut state.dp, 0, &mut sample);
}

/// Boxes and centres in screen space, and the way there.
fn screen_space<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let place = ImagePlace {
        quad: inputs.quad(state.constants.levels),
        inside: inputs.flag(),
    };
    let [x, y] = [(); 2].map(|()| inputs.cage(state));
    let below = state.constants.levels - place.quad.level;
    let [left, right] = state.constants.half_sample_places;
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
    let fill = Fill {
        vectors: &state.canvas.fill,
        reject: true,
    };
    smallest_node::screen(&mut state.dp, &state.constants, &fill, place, &spans);
    let screen = Screen { x, y, spans };
    let limit = if inputs.flag() {
        state.dp.sub(spans[0].1, spans[0].0)
    } else {
        inputs.word(SPARE)
    };
    state.dp.stage(Stage::OnePixel);
    size::screen_at_most(&mut state.dp, &screen, limit);
    state.dp.stage(Stage::Draw);
    size::screen_sample(&mut state.dp, &state.constants, place, &screen);

    let mut clip = inputs.clip(state);
    let centre = clip.x.centre(&mut state.dp);
    let step = inputs.step();
    let doubled = state.dp.shl(centre, 1);
    let w = match inputs.flag() {
        true => state.dp.add(doubled, step),
        false => inputs.word(SPARE),
    };
    // Beyond the node's edges a centre is none of it.
    let across = ImagePlace {
        inside: false,
        ..place
    };
    size::clip_sample(&mut state.dp, &state.constants, across, &clip, w);
    let level = inputs.level(state.constants.depth) as usize;
    let least = if inputs.flag() { clip.w_min } else { w };
    if inputs.flag() {
        // The guard's edge goes through the vertices, in the whole picture.
        let dp = &mut state.dp;
        clip.x = clip.w.map(|w| {
            let part = dp.shr(w, SCREEN_GUARD_SHIFT);
            dp.neg(part)
        });
    }
    let kept = state.constants.screen_depth[level].replace(least);
    to_screen::may_change(&mut state.dp, &state.constants, level as u32, place, &clip);
    state.constants.screen_depth[level] = kept;
}
