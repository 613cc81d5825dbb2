//! Rare inputs for the machine's blocks: ends of their ranges, ties, and random numbers. Where a block adds, they leave
//! some bits, so that no result leaves its word.

use crate::machine::stages::RecordStage;
use hwmodel::{Datapath, Narrow, Probe, WideWord, Word};

use crate::frame::{Blend, Frame, QuadNode};
use crate::graph::{GraphView, Opacity};
use crate::machine::MachineOptions;
use crate::machine::alpha::BlendColor;
use crate::machine::cage::{CageCoordinate, with_cage};
use crate::machine::children::{centre_and_order, child_cube, child_span, pool};
use crate::machine::constants::BlendEye;
use crate::machine::decide::apply_level_of_detail;
use crate::machine::engine::Machine;
use crate::machine::planes::{self, Silhouette};
use crate::machine::quadrants::{self, Halves, ImageBox};
use crate::machine::record::{Clip, Cube, ImagePlace, Planes, Pose, Record, Screen};
use crate::machine::state::State;
use crate::machine::{size, smallest_node, to_screen};
use crate::project::options::SCREEN_GUARD_SHIFT;
use crate::project::{ALL_LEFT, Coverage, EngineError, FrameSetup, OPAQUE_ENOUGH, SHARES};
use crate::split_mix::SplitMix;

impl Machine {
    /// Gives `rounds` rounds of inputs to the blocks of a frame. Fails when the system refuses the memory of the frame.
    pub fn show_directed<P: Probe>(
        &mut self,
        graph: &GraphView<'_>,
        setup: &FrameSetup,
        probe: P,
        rounds: u32,
    ) -> Result<P, EngineError> {
        let mut frame = Frame::nodes_only(0, 0);
        let canvas = (self.emptied(setup, &mut frame)?, &mut frame);
        let options = MachineOptions::default();
        let mut inputs = Inputs::new(setup);
        with_cage!(setup, L => {
            let mut state = State::<P, L, ()>::new(options, graph, setup, canvas, probe, ());
            all_vectors(&mut state);
            if setup.options.coverage.blends() {
                all_shares(&mut state.dp, &mut inputs);
            }
            for _ in 0..rounds {
                round(&mut state, &mut inputs, &setup.options.coverage);
            }
            Ok(state.finish().1)
        })
    }
}

fn round<P: Probe, L: CageCoordinate>(
    state: &mut State<'_, P, L, ()>,
    inputs: &mut Inputs,
    coverage: &Coverage,
) {
    if coverage.blends() {
        blending(&mut state.dp, inputs);
    }
    object_space(state, inputs);
    cages(state, inputs);
    fit(state, inputs);
    depths_and_sizes(state, inputs);
    match coverage.draws_outlines() {
        true => outlines(state, inputs),
        false => screen_space(state, inputs),
    }
}

fn all_vectors<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>) {
    let (dp, fill) = (&mut state.dp, &mut state.canvas.fill);
    for bits in 0..16u8 {
        let halves = |at: u8| Halves {
            low: bits >> at & 1 != 0,
            high: bits >> at & 2 != 0,
        };
        quadrants::quadrants(dp, halves(0), halves(2));
    }
    let levels = state.job.constants.levels;
    let root = QuadNode::ROOT;
    for vector in 0..16u8 {
        let kept = fill.replace(root, vector);
        fill.is_full(dp, root);
        for overlapped in 0..16 {
            fill.rejects(dp, root, overlapped);
        }
        let _ = fill.replace(root, kept);
        if levels == 0 {
            continue;
        }
        for quadrant in 0..4 {
            // A sample whose vectors are those of the row, so that its parent's is updated.
            let parent = (1..levels).fold(root, |parent, _| parent.quadrant(0));
            let sample = parent.quadrant(quadrant);
            let before = fill.replace(sample, vector);
            let above = fill.replace(parent, vector);
            fill.mark(dp, sample);
            let _ = fill.replace(sample, before);
            let _ = fill.replace(parent, above);
        }
    }
}

fn object_space<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let (dp, job) = (&mut state.dp, &mut state.job);
    let mut cube = inputs.cube(0);
    if inputs.flag() {
        // Both ends of the range: their sum has a carry.
        cube.max = cube.min;
    }
    for k in 0..3 {
        let centre = dp.midpoint(cube.min[k], cube.max[k]);
        let any = inputs.word(0);
        job.constants.eye_floor[k] = if inputs.flag() { centre } else { any };
    }
    let (centre, _) = centre_and_order(dp, job, &cube);
    let octant = inputs.level(7) as u8;
    let counts = &mut state.canvas.counts;
    child_cube(dp, job, counts, &cube, octant, &centre);
}

fn cages<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let dp = &mut state.dp;
    let cage: L = inputs.cage(dp);
    dp.stage(RecordStage::VertexPool);
    pool(dp, &cage);
    dp.stage(RecordStage::ChildBox);
    child_span(dp, &cage);
}

/// X such that a node's edge, its bisector, or the limit of a box passes through the vertices, or nearly.
fn beside_an_edge<P: Probe, L: CageCoordinate>(
    dp: &mut Datapath<P>,
    inputs: &mut Inputs,
    w: &L,
) -> L {
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
    x.moved(dp, step)
}

fn fit<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let (dp, c, fill) = (&mut state.dp, &state.job.constants, &state.canvas.fill);
    let mut clip: Clip<L> = inputs.clip(dp);
    [clip.x, clip.y] = [(); 2].map(|()| beside_an_edge(dp, inputs, &clip.w));
    // A fit doubles planes once per level.
    let mut planes = Planes::default();
    for plane in planes.edge.as_flattened_mut() {
        *plane = WideWord::from_host(inputs.number(8));
    }
    let place = ImagePlace {
        quad: inputs.quad(c.levels),
        inside: false,
    };
    dp.stage(RecordStage::QuadtreeFit);
    clip.quadrants(dp, c, place.quad);
    smallest_node::near_node(dp, &clip.x, &clip.w);
    smallest_node::near_node(dp, &clip.y, &clip.w);
    smallest_node::clip(dp, c, fill, place, &mut clip, &mut planes);
}

fn depths_and_sizes<P: Probe, L: CageCoordinate>(
    state: &mut State<'_, P, L, ()>,
    inputs: &mut Inputs,
) {
    let (dp, c) = (&mut state.dp, &mut state.job.constants);
    let mut clip: Clip<L> = inputs.clip(dp);
    let level = inputs.level(c.depth);
    let least = inputs.word(1);
    let one = Word::from_host(inputs.number(1));
    clip.w_min = match inputs.flag() {
        true => dp.add(least, one),
        false => inputs.word(0),
    };
    let kept = c.lod_depth[level as usize].replace(least);
    let mut record = Record {
        cube: Cube {
            solid: false,
            ..inputs.cube(level)
        },
        place: ImagePlace::ROOT,
        pose: Pose::Clip(clip, Planes::default()),
    };
    dp.stage(RecordStage::OnePixel);
    apply_level_of_detail(dp, c, &mut record);
    c.lod_depth[level as usize] = kept;

    clip.w_min = inputs.word(SPARE);
    let below = inputs.level(c.levels);
    size::clip_at_most(dp, &clip, &c.size_limit, below);
    let (edges_x, edges_w) = (inputs.words(SPARE), inputs.words(SPARE));
    let step = inputs.step();
    size::edges_at_most(dp, edges_x, edges_w, |dp, size| dp.add(size, step));
}

fn outlines<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let (dp, c) = (&mut state.dp, &mut state.job.constants);
    let mut planes = inputs.planes();
    let kept = c.axis_ab;
    c.axis_ab = inputs.planes().edge.map(|[a, b, _]| [a, b]);
    if c.depth > 0 {
        let parent_level = inputs.level(c.depth - 1);
        let octant = inputs.level(7) as u8;
        dp.stage(RecordStage::VertexPool);
        planes::of_child(dp, c, &planes, parent_level, octant);
    }
    let quadrant = inputs.level(3) as u8;
    dp.stage(RecordStage::QuadtreeFit);
    let mut moved = planes;
    planes::move_to_quadrant(dp, c, &mut moved, quadrant);
    let level = inputs.level(c.depth);
    let mut cube = inputs.cube(level);
    // Along earlier axes the eye is within the cube; along others near its faces, or anywhere.
    let axis = inputs.level(2) as usize;
    for k in 0..3 {
        let [any, other] = inputs.words(0);
        let step = inputs.step();
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
    c.positive = inputs.flag();
    if inputs.flag() {
        planes.edge = [planes.edge[0]; 3];
    }
    let w_min = inputs.word(0);
    dp.stage(RecordStage::Draw);
    let silhouette = Silhouette::new(dp, c, &cube, &planes, w_min);
    for below in [0, 1] {
        let mut silhouette = silhouette.clone();
        silhouette.cover(dp, below);
        silhouette.in_quadrant(dp, quadrant);
    }
    c.axis_ab = kept;
}

fn screen_space<P: Probe, L: CageCoordinate>(state: &mut State<'_, P, L, ()>, inputs: &mut Inputs) {
    let (dp, c, fill) = (&mut state.dp, &mut state.job.constants, &state.canvas.fill);
    let place = ImagePlace {
        quad: inputs.quad(c.levels),
        inside: inputs.flag(),
    };
    let [x, y]: [L; 2] = [(); 2].map(|()| inputs.cage(dp));
    let below = c.levels - place.quad.level;
    let [left, right] = c.half_sample_places;
    // Edges and middles of nodes, in halves of their width, or nearly.
    let mut beside = |column: u32| {
        let near = i64::from(column << 1) + inputs.dice.below(3) as i64;
        let edge = Word::from_host(near << (below + left) >> right);
        let step = inputs.step();
        match inputs.dice.below(4) {
            0 => inputs.word(SPARE),
            _ => dp.add(edge, step),
        }
    };
    let spans = [place.quad.x, place.quad.y].map(|column| (beside(column), beside(column)));
    dp.stage(RecordStage::QuadtreeFit);
    smallest_node::screen(dp, c, fill, place, &spans);
    let screen = Screen { x, y, spans };
    let limit = match inputs.flag() {
        true => dp.sub(spans[0].1, spans[0].0),
        false => inputs.word(SPARE),
    };
    dp.stage(RecordStage::OnePixel);
    size::screen_at_most(dp, &screen, limit);
    dp.stage(RecordStage::Draw);
    size::screen_sample(dp, c, place, &screen);

    let mut clip: Clip<L> = inputs.clip(dp);
    let centre = clip.x.centre(dp);
    let step = inputs.step();
    let doubled = dp.shl(centre, 1);
    let w = match inputs.flag() {
        true => dp.add(doubled, step),
        false => inputs.word(SPARE),
    };
    // Centres beyond the node's edges are rejected.
    let across = ImagePlace {
        inside: false,
        ..place
    };
    size::clip_sample(dp, c, across, &clip, w);
    let level = inputs.level(c.depth) as usize;
    let least = if inputs.flag() { clip.w_min } else { w };
    if inputs.flag() {
        // The guard's edge passes through the vertices, in the whole picture.
        clip.x = clip.w.map(|w| {
            let part = dp.shr(w, SCREEN_GUARD_SHIFT);
            dp.neg(part)
        });
    }
    let kept = c.screen_depth[level].replace(least);
    to_screen::may_change(dp, c, level as u32, place, &clip);
    c.screen_depth[level] = kept;
}

/// A voxel of random opacities, these distances of the eye from its centre, and this shift.
fn blend_voxel<P: Probe>(
    dp: &mut Datapath<P>,
    inputs: &mut Inputs,
    (ways, shift): ([Word; 3], u32),
) {
    let mut cube = inputs.cube(0);
    for k in 0..3 {
        if inputs.flag() {
            // Otherwise the whole range: an odd sum loses its half.
            cube.max[k] = cube.min[k];
        }
    }
    let centre: [Word; 3] = std::array::from_fn(|k| dp.midpoint(cube.min[k], cube.max[k]));
    let eye = BlendEye {
        shift,
        at: std::array::from_fn(|k| {
            let centre = dp.shr(centre[k], shift);
            towards_zero(dp, centre, ways[k])
        }),
    };
    // Any side of each voxel, also with the eye in its centre.
    let eye_floor = std::array::from_fn(|k| {
        let step = Word::from_host(inputs.number(1) & 1);
        towards_zero(dp, centre[k], step)
    });
    // Full, almost full, half, or random.
    let mut side = || match inputs.dice.below(6) {
        0..=2 => 15,
        3 => [14, 8, 7][inputs.dice.below(3) as usize],
        _ => inputs.dice.below(16) as u8,
    };
    let opacity = Opacity::new(std::array::from_fn(|_| [side(), side()]));
    BlendColor::of_voxel(dp, &eye, &eye_floor, &cube, opacity, [0; 3]);
}

fn towards_zero<P: Probe>(dp: &mut Datapath<P>, from: Word, by: Word) -> Word {
    match dp.is_negative(from) {
        true => dp.add(from, by),
        false => dp.sub(from, by),
    }
}

/// Ways whose sum is 16 are shares. Ties of two sides, whose sum is 32.
fn all_shares<P: Probe>(dp: &mut Datapath<P>, inputs: &mut Inputs) {
    for x in 0..=SHARES {
        for y in 0..=SHARES - x {
            let ways = [x, y, SHARES - x - y].map(Word::from_host);
            blend_voxel(dp, inputs, (ways, 0));
        }
    }
    for x in 0..=2 * SHARES {
        let ways = [x, 2 * SHARES - x, 0].map(Word::from_host);
        blend_voxel(dp, inputs, (ways, 0));
    }
}

/// Any ways, and partly transparent samples.
fn blending<P: Probe>(dp: &mut Datapath<P>, inputs: &mut Inputs) {
    let bits = if inputs.flag() {
        6
    } else {
        inputs.bits - SPARE
    };
    let ways = std::array::from_fn(|_| {
        let way = Word::from_host(inputs.number(bits));
        let back = dp.neg(way);
        dp.max(way, back)
    });
    let shift = inputs.level(3);
    blend_voxel(dp, inputs, (ways, shift));

    let all = u64::from(ALL_LEFT);
    let left = match inputs.flag() {
        true => all,
        false => inputs.dice.below(all + 1),
    };
    // A sample that is then just open or just full, or any.
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
    // A sample's light is at most its share.
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
    color.add_to(dp, 0, &mut sample);
}

/// Spare bits of words that are added, doubled or halved a few times.
const SPARE: u32 = 8;

struct Inputs {
    dice: SplitMix,
    bits: u32,
    wide_bits: u32,
}

impl Inputs {
    fn new(setup: &FrameSetup) -> Self {
        Self {
            dice: SplitMix::new(0),
            bits: setup.format.bits(),
            wide_bits: setup.format.wide().bits(),
        }
    }

    /// A number of `bits` bits with its sign: an end of the range, near zero, or random.
    fn number(&mut self, bits: u32) -> i64 {
        let most = i64::MAX >> (64 - bits);
        let ends = [-most - 1, -most, most, most - 1, -2, -1, 0, 1, 2];
        // Every third is one of these.
        let choice = self.dice.below(27) as usize;
        if let Some(&end) = ends.get(choice) {
            return end;
        }
        // Every number of bits is equally frequent.
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

    /// Of independent numbers.
    fn cage<P: Probe, L: CageCoordinate>(&mut self, dp: &mut Datapath<P>) -> L {
        let any = L::from_frame(dp, Word::ZERO, [Word::ZERO; 3]);
        any.map(|_| self.word(SPARE))
    }

    fn clip<P: Probe, L: CageCoordinate>(&mut self, dp: &mut Datapath<P>) -> Clip<L> {
        let [x, y, w]: [L; 3] = [(); 3].map(|()| self.cage(dp));
        let (w_min, _) = w.span(dp);
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
