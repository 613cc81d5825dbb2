//! A frame of rays as a workload of the cycle model, with everything counted.

use std::collections::BTreeSet;

use hwmodel::count::Counter;
use hwmodel::cycles::{self, Child, CycleReport, Hardware, ImageNode, NoObserver, TurnLog};
use hwmodel::shifts::ShiftProbe;
use hwmodel::{Datapath, Format, Memory, OpClass, Overflow, WideWord, Word};

use super::ray::Ray;
use super::view::View;
use super::{LEVEL_BITS, RayStage, Rival, order};
use crate::model::ModelError;
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, GraphView, NodeLayout};
use shiftvox::project::{EngineError, FrameSetup};

#[derive(Debug)]
pub struct Cast {
    pub frame: Frame,
    pub cycles: CycleReport,
    /// Its operations and accesses. Accesses of nodes are those of the node buffer, if there is one.
    pub counter: Counter,
    /// Shifts that are no wires.
    pub shifts: ShiftProbe,
    /// Words, and the wide words of the sums.
    pub format: Format,
    /// Distances from ray to ray: each has six sums that the hardware keeps.
    pub steps: u64,
}

type Probes = (TurnLog, (Counter, ShiftProbe));

/// Casts a frame's rays on a ray caster's hardware, as [`Rival::beside`] makes it.
pub fn cast(
    graph: &Graph,
    setup: &FrameSetup,
    rival: &Rival,
    hardware: &Hardware,
) -> Result<Cast, ModelError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    frame.clear();
    if setup.depth > rival.stack.entries {
        let why = format!(
            "stack.entries is {}; the scene has {} levels",
            rival.stack.entries, setup.depth
        );
        return Err(cycles::HardwareError(why).into());
    }
    let plain = Format::new(rival.bits, 0)
        .map_err(|error| cycles::HardwareError(format!("bits of the ray caster: {error}")))?;
    let view = View::new(setup, rival.bits, plain.wide().bits());
    let format = plain.with_wide_bits(rival.bits + view.guard);
    let probes = (TurnLog::new(hardware), (Counter::new(), ShiftProbe::new()));
    let graph = graph.view();
    let organisation = hardware.organisation;
    let samples: Vec<(u32, u32)> = order::samples(setup.width, setup.height).collect();
    let steps: BTreeSet<(i64, i64)> = samples
        .windows(2)
        .map(|pair| {
            let [from, to] = [pair[0], pair[1]].map(|(i, j)| (i64::from(i), i64::from(j)));
            (to.0 - from.0, to.1 - from.1)
        })
        .collect();
    let mut rays = Rays {
        graph: &graph,
        layout: NodeLayout::new(&graph, organisation.leaf_masks, organisation.bricks),
        depth: setup.depth,
        sums: [WideWord::ZERO; 6],
        samples,
        view,
        dp: Datapath::new(format, Overflow::Trap, probes),
        frame: &mut frame,
        waiting: Vec::new(),
        free: Vec::new(),
    };
    let cycles = cycles::simulate(hardware, &mut rays, &mut NoObserver)?;
    let (_, (counter, shifts)) = rays.dp.into_probe();
    Ok(Cast {
        frame,
        cycles,
        counter,
        shifts,
        format,
        steps: steps.len() as u64,
    })
}

/// Deepest level of a graph, and one more.
const LEVELS: usize = 32;

#[derive(Debug, Clone, Copy)]
enum Work {
    /// The step to a ray, by its place in the order.
    Next(usize),
    /// A ray that begins: its sample, direction and moments.
    First(usize, [Word; 6]),
    /// A ray in a cell, with the nodes above it by level.
    Step(usize, Ray, [u32; LEVELS]),
}

struct Rays<'a> {
    graph: &'a GraphView<'a>,
    layout: NodeLayout,
    depth: u32,
    samples: Vec<(u32, u32)>,
    view: View,
    sums: [WideWord; 6],
    dp: Datapath<Probes>,
    frame: &'a mut Frame,
    waiting: Vec<Work>,
    free: Vec<u32>,
}

/// Places of a ray and of the next one among children: any that differ.
const RAY: u8 = 0;
const NEXT: u8 = 7;

impl Rays<'_> {
    fn hand_over(&mut self, work: Work, place: u8, children: &mut Vec<Child>) {
        let (Work::Next(at) | Work::First(at, _) | Work::Step(at, ..)) = work;
        let (x, y) = self.samples[at];
        let item = match self.free.pop() {
            Some(item) => item,
            None => {
                self.waiting.push(work);
                (self.waiting.len() - 1) as u32
            }
        };
        self.waiting[item as usize] = work;
        let level = u32::BITS - 1;
        children.push(Child {
            item,
            place,
            image_node: ImageNode { level, x, y },
        });
    }

    fn next(&mut self, at: usize, children: &mut Vec<Child>) {
        let dp = &mut self.dp;
        dp.begin_record(at as u64, 0);
        dp.stage(RayStage::Next);
        let sample = self.samples[at];
        match at.checked_sub(1) {
            None => {
                let first = self.view.first(sample);
                self.sums = first.map(WideWord::from_host);
            }
            Some(before) => {
                let step = self.view.step(self.samples[before], sample);
                for (sum, step) in self.sums.iter_mut().zip(step) {
                    *sum = dp.add(*sum, WideWord::from_host(step));
                }
            }
        }
        // The bits above the guard: wires.
        let guard = self.view.guard;
        let words = self.sums.map(|sum| dp.load(sum.to_host() >> guard));
        self.hand_over(Work::First(at, words), RAY, children);
        if at + 1 < self.samples.len() {
            self.hand_over(Work::Next(at + 1), NEXT, children);
        }
    }

    fn first(&mut self, at: usize, words: [Word; 6], children: &mut Vec<Child>) {
        let [x, y, z, a, b, c] = words;
        self.dp.begin_record(at as u64, 0);
        self.dp.stage(RayStage::Setup);
        let sums = ([x, y, z], [a, b, c]);
        let ray = Ray::enter(&mut self.dp, sums, &self.view.eye, self.depth);
        if let Some(ray) = ray {
            let root = self.graph.root;
            self.dp.stage(RayStage::Step);
            self.meet(at, ray, root, [root; LEVELS], children);
        }
    }

    /// A ray in the cell of a node.
    fn meet(
        &mut self,
        at: usize,
        mut ray: Ray,
        node: u32,
        mut above: [u32; LEVELS],
        children: &mut Vec<Child>,
    ) {
        let level = self.depth - ray.size;
        let is_solid = self.graph.mask(node) == 0 || ray.size == 0;
        // The mask's eight bits, and the counter of levels.
        self.dp.control(OpClass::Logic, 8);
        self.dp.control(OpClass::Compare, LEVEL_BITS);
        if !(is_solid && self.layout.leaf_masks) {
            let mut is_read = false;
            for word in self.layout.words(node, level) {
                self.dp.read(Memory::Node, word);
                is_read = true;
            }
            if is_read && level > 0 {
                self.dp.write(Memory::Stack, u64::from(level));
            }
        }
        if is_solid {
            return self.hit(at, &ray, node);
        }
        above[level as usize] = node;
        ray.descend(&mut self.dp);
        self.hand_over(Work::Step(at, ray, above), RAY, children);
    }

    fn step(&mut self, at: usize, mut ray: Ray, above: [u32; LEVELS], children: &mut Vec<Child>) {
        let level = (self.depth - ray.size - 1) as usize;
        self.dp.begin_record(at as u64, level as u32 + 1);
        self.dp.stage(RayStage::Step);
        let octant = ray
            .low
            .iter()
            .fold(0u8, |bits, low| bits << 1 | (low >> ray.size & 1) as u8);
        // A bit of each place, of 24, by the level.
        for _ in 0..3 {
            self.dp.and_bits(24, 0, 0);
        }
        // The octant, and its bit of the node's mask.
        let octant = self.dp.xor_bits(3, octant, ray.mirror);
        let mask = self.graph.mask(above[level]);
        if self.dp.and_bits(8, mask, 1 << octant) != 0
            && let Some(child) = self.graph.child(above[level], octant)
        {
            return self.meet(at, ray, child, above, children);
        }
        if !ray.advance(&mut self.dp, self.depth) {
            return;
        }
        let up = (self.depth - ray.size - 1) as usize;
        let is_stored = |level: usize| !self.layout.words(above[level], level as u32).is_empty();
        if (up + 1..=level).any(is_stored) {
            self.dp.read(Memory::Stack, up as u64);
        }
        self.hand_over(Work::Step(at, ray, above), RAY, children);
    }

    fn hit(&mut self, at: usize, ray: &Ray, node: u32) {
        let (i, j) = self.samples[at];
        let place = j as usize * self.frame.width as usize + i as usize;
        self.dp.stage(RayStage::Hit);
        self.dp.read(Memory::Attribute, u64::from(node));
        self.dp.write(Memory::Pixel, place as u64);
        self.frame.node[place] = node;
        if let Some(voxel) = self.frame.voxel.get_mut(place) {
            let highest = (1u32 << self.depth) - (1 << ray.size);
            for k in 0..3 {
                let low = ray.low[k];
                let is_mirrored = ray.mirror & (4 >> k) != 0;
                voxel[k] = if is_mirrored { highest - low } else { low } as i32;
            }
            voxel[3] = (self.depth - ray.size) as i32;
        }
    }
}

impl cycles::Workload for Rays<'_> {
    type Error = EngineError;

    fn start(&mut self, children: &mut Vec<Child>) -> Result<(), EngineError> {
        if !self.samples.is_empty() {
            self.hand_over(Work::Next(0), NEXT, children);
        }
        Ok(())
    }

    fn turn(&mut self, item: u32, children: &mut Vec<Child>) -> Result<(), EngineError> {
        let work = self.waiting[item as usize];
        self.free.push(item);
        match work {
            Work::Next(at) => self.next(at, children),
            Work::First(at, words) => self.first(at, words, children),
            Work::Step(at, ray, above) => self.step(at, ray, above, children),
        }
        match self.dp.trap() {
            Some(trap) => Err(trap.into()),
            None => Ok(()),
        }
    }

    fn log(&mut self) -> &mut TurnLog {
        &mut self.dp.probe_mut().0
    }
}
