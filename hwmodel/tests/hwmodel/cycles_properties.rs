//! Properties of every simulation, on random records and random hardware.
use std::collections::BTreeMap;

use crate::common::*;
use hwmodel::cycles::{
    Cache, Child, CycleReport, Dram, Hardware, ImageNode, Independence, NoObserver, StackOverflow,
    Unit, VisitSpan, simulate,
};
use hwmodel::memory::RecordBits;
use hwmodel::{Memory, OpClass, Probe};
use proptest::prelude::*;

struct Dice(u64);

impl Dice {
    fn below(&mut self, end: u32) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % u64::from(end)) as u32
    }

    fn one_in(&mut self, of: u32) -> bool {
        self.below(of) == 0
    }

    fn of<T: Copy, const N: usize>(&mut self, values: [T; N]) -> T {
        values[self.below(N as u32) as usize]
    }
}

fn acts(dice: &mut Dice) -> Vec<Act> {
    let mut acts = vec![act(|log| {
        log.read(Memory::Stack, 0, at(RecordStage::Pop, 0))
    })];
    for stage in RecordStage::ALL {
        if dice.one_in(2) {
            continue;
        }
        for _ in 0..dice.below(3) {
            let (class, bits) = (dice.of(OpClass::ALL), dice.of([3, 16, 33, 64]));
            let times = 1 + dice.below(20);
            acts.push(act(move |log| log.op(class, bits, at(stage, 0), times)));
        }
        for _ in 0..dice.below(4) {
            let address = dice.below(64).into();
            let (memory, is_write) = dice.of([
                (Memory::Node, false),
                (Memory::Attribute, false),
                (Memory::FillVector, false),
                (Memory::FillVector, true),
                (Memory::Pixel, true),
                (Memory::Stack, true),
            ]);
            acts.push(act(move |log| match is_write {
                true => log.write(memory, address, at(stage, 0)),
                false => log.read(memory, address, at(stage, 0)),
            }));
        }
    }
    acts
}

fn part_of(mut part: ImageNode, dice: &mut Dice) -> ImageNode {
    while part.level < 6 && dice.one_in(2) {
        part = ImageNode {
            level: part.level + 1,
            x: part.x << 1 | dice.below(2),
            y: part.y << 1 | dice.below(2),
        };
    }
    part
}

fn records(seed: u64, most: u32) -> Vec<Node> {
    let mut dice = Dice(seed);
    let first = Child {
        item: 1,
        place: 0,
        image_node: ImageNode::default(),
    };
    let mut nodes = vec![Node::default()];
    nodes[0].children.push(first);
    let mut unmade = std::collections::VecDeque::from([first]);
    let mut made = 2;
    while let Some(of) = unmade.pop_front() {
        let mut node = Node {
            acts: acts(&mut dice),
            children: Vec::new(),
        };
        for place in 0..8 {
            if made < most && dice.one_in(3) {
                let child = Child {
                    item: made,
                    place,
                    image_node: part_of(of.image_node, &mut dice),
                };
                made += 1;
                node.children.push(child);
                unmade.push_back(child);
            }
        }
        nodes.push(node);
    }
    nodes
}

fn unit(dice: &mut Dice) -> Unit {
    Unit {
        count: 1 + dice.below(9),
        latency: dice.below(5),
        interval: 1 + dice.below(3),
        width: dice.of([4, 16, 33, 64]),
    }
}

fn cache(dice: &mut Dice) -> Cache {
    let (ways, line_bytes) = (1 + dice.below(4), 16 << dice.below(3));
    Cache {
        bytes: ways * line_bytes * (1 + dice.below(4)),
        ways,
        line_bytes,
        entry_bytes: 8,
        ports: 1 + dice.below(2),
        hit_latency: dice.below(3),
        // Beyond the timing wheel now and then.
        miss_latency: dice.of([0, 10, 100, 1500]),
        misses: 1 + dice.below(4),
    }
}

fn hardware(seed: u64, independence: Independence) -> Hardware {
    let dice = &mut Dice(seed);
    let mut hardware = Hardware::preset("tiny").unwrap();
    hardware.lanes = 1 + dice.below(5);
    hardware.contexts = 1 + dice.below(5);
    hardware.independence = independence;
    hardware.steal_cycles = dice.below(4);
    for class in OpClass::ALL {
        let unit = unit(dice);
        if !hardware.wires.contains(&class) {
            hardware.units.insert(class, unit);
        }
    }
    hardware.node_cache = cache(dice);
    hardware.attribute_cache = cache(dice);
    hardware.stack.entries = 1 + dice.below(40);
    hardware.stack.ports = 1 + dice.below(2);
    hardware.stack.latency = dice.below(3);
    hardware.fill_vectors.banks = 1 + dice.below(4);
    hardware.fill_vectors.read_ports = 1 + dice.below(2);
    hardware.fill_vectors.latency = dice.below(3);
    hardware.pixels.write_ports = 1 + dice.below(2);
    hardware.pixels.buffer = 1 + dice.below(4);
    hardware.pixels.drain_interval = dice.below(9);
    hardware.outer_memory.bytes_per_cycle = dice.below(4) * 3;
    hardware.stack.record = RecordBits::uniform(dice.below(2000));
    hardware
}

fn run(nodes: &[Node], hardware: &Hardware) -> (CycleReport, Vec<u32>) {
    let mut workload = Listed::new(nodes, hardware);
    let report = simulate(hardware, &mut workload, &mut NoObserver).unwrap();
    (report, workload.turns)
}

fn depth_first(nodes: &[Node]) -> Vec<u32> {
    let mut stack = vec![1];
    let mut order = Vec::new();
    while let Some(item) = stack.pop() {
        order.push(item);
        let children = &nodes[item as usize].children;
        stack.extend(children.iter().rev().map(|child| child.item));
    }
    order
}

fn any_independence() -> impl Strategy<Value = Independence> {
    use Independence::{Both, Classes, Image, None};
    prop::sample::select(vec![None, Classes, Image, Both])
}

fn is_independent(rule: Independence, earlier: &Child, later: &Child) -> bool {
    let class = |child: &Child| [0, 1, 1, 1, 2, 2, 2, 3][child.place as usize];
    let same_class = class(earlier) == class(later);
    let (a, b) = (earlier.image_node, later.image_node);
    let level = a.level.min(b.level);
    let ancestor = |of: ImageNode| [of.x, of.y].map(|at| at >> (of.level - level));
    let disjoint = ancestor(a) != ancestor(b);
    match rule {
        Independence::None => false,
        Independence::Classes => same_class,
        Independence::Image => disjoint,
        Independence::Both => same_class || disjoint,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn cycles_lie_between_every_bound_and_the_serial_sum(
        seed: u64, hw: u64, independence in any_independence(), most in 2..200u32, banks in 0..4u32,
    ) {
        let nodes = records(seed, most);
        let mut hardware = hardware(hw, independence);
        hardware.outer_memory.dram = (banks > 0).then_some(Dram {
            banks,
            row_bytes: 256,
            t_rcd: (hw % 9) as u32,
            t_rp: (hw % 7) as u32,
            t_cl: (hw % 5) as u32,
        });
        let (report, mut turns) = run(&nodes, &hardware);
        prop_assert!(report.bounds.iter().all(|bound| bound.cycles <= report.cycles));
        prop_assert!(report.span <= report.work);
        prop_assert!(report.cycles <= report.serial, "{} > {}", report.cycles, report.serial);
        let sum = report.context_cycles;
        prop_assert_eq!(
            sum.working + sum.stalled + sum.order_wait + sum.no_record,
            report.cycles * hardware.all_contexts()
        );
        prop_assert_eq!(report.stages.iter().map(|stage| stage.alone).sum::<u64>(), report.work);
        turns.sort_unstable();
        prop_assert_eq!(turns, (1..nodes.len() as u32).collect::<Vec<_>>());
        prop_assert_eq!(run(&nodes, &hardware).0, report);
    }

    #[test]
    fn no_record_begins_before_what_it_waits_for_is_finished(
        seed: u64, hw: u64, independence in any_independence(),
    ) {
        let nodes = records(seed, 120);
        let hardware = hardware(hw, independence);
        let (mut workload, mut visits) = (Listed::new(&nodes, &hardware), Vec::<VisitSpan>::new());
        simulate(&hardware, &mut workload, &mut visits).unwrap();
        visits.sort_by_key(|visit| (visit.lane, visit.context, visit.arrives, visit.ends));
        for pair in visits.windows(2) {
            let [a, b] = [&pair[0], &pair[1]];
            prop_assert!(a.arrives <= a.begins && a.begins <= a.ends);
            let are_of_one = (a.lane, a.context) == (b.lane, b.context);
            prop_assert!(!are_of_one || a.ends <= b.arrives, "a context is in two blocks at once");
        }
        let mut times: BTreeMap<u32, (u64, u64)> = BTreeMap::new();
        for visit in &visits {
            if let Some(&item) = workload.turns.get(visit.record as usize) {
                let time = times.entry(item).or_insert((visit.arrives, visit.ends));
                *time = (time.0.min(visit.arrives), time.1.max(visit.ends));
            }
        }
        // First and last cycle of each record and all below it: children come later in the list.
        let mut whole = times.clone();
        for item in (1..nodes.len() as u32).rev() {
            for child in &nodes[item as usize].children {
                let (begins, ends) = whole[&child.item];
                prop_assert!(begins >= times[&item].1, "a child before its parent");
                let of = whole.get_mut(&item).unwrap();
                of.1 = of.1.max(ends);
            }
        }
        for node in &nodes {
            for (i, later) in node.children.iter().enumerate() {
                for earlier in &node.children[..i] {
                    prop_assert!(
                        is_independent(independence, earlier, later)
                            || whole[&later.item].0 >= whole[&earlier.item].1
                    );
                }
            }
        }
    }

    /// With one context the order is the serial one, so that nothing that is
    /// made faster or wider can make the frame slower. Only pixels that reach
    /// the outer memory earlier may delay a miss there.
    #[test]
    fn with_one_context_better_parts_are_never_slower(
        seed: u64, hw: u64, independence in any_independence(), which in 0..22usize,
    ) {
        let nodes = records(seed, 100);
        let mut hardware = hardware(hw, independence);
        (hardware.lanes, hardware.contexts) = (1, 1);
        if (17..20).contains(&which) {
            hardware.outer_memory.bytes_per_cycle = 0;
        }
        let (before, turns) = run(&nodes, &hardware);
        prop_assert_eq!(&turns, &depth_first(&nodes));
        improve(&mut hardware, which);
        let (after, turns) = run(&nodes, &hardware);
        prop_assert_eq!(&turns, &depth_first(&nodes));
        prop_assert!(after.cycles <= before.cycles, "{} > {}", after.cycles, before.cycles);
    }
}

fn improve(hardware: &mut Hardware, which: usize) {
    let mut none = unit(&mut Dice(0));
    let unit = hardware
        .units
        .get_mut(&OpClass::ALL[which % 8])
        .unwrap_or(&mut none);
    match which {
        0..4 => unit.count += 1,
        4..6 => unit.latency = unit.latency.saturating_sub(1),
        6 => unit.interval = 1,
        7 => unit.width *= 2,
        8 => hardware.stack.ports += 1,
        9 => hardware.stack.entries += 5,
        10 => hardware.stack.spill_cycles /= 2,
        11 => hardware.node_cache.ports += 1,
        12 => hardware.node_cache.misses += 1,
        13 => hardware.node_cache.miss_latency /= 2,
        14 => {
            // As many sets, each with more lines: what was a hit stays one.
            let cache = &mut hardware.node_cache;
            cache.bytes += cache.sets() * cache.line_bytes;
            cache.ways += 1;
        }
        15 => hardware.fill_vectors.banks *= 2,
        16 => hardware.fill_vectors.read_ports += 1,
        17 => hardware.pixels.write_ports += 1,
        18 => hardware.pixels.buffer += 1,
        20 => hardware.outer_memory.bytes_per_cycle *= 2,
        21 => hardware.stack.record = RecordBits::uniform(hardware.stack.record.clip / 2),
        _ => hardware.pixels.drain_interval /= 2,
    }
}

/// With several contexts a better part may make a frame slower: records then meet in another order (Graham's anomalies
/// of list scheduling). The test fixes how often, and by how much, on these records.
#[test]
fn anomalies_with_several_contexts_are_rare_and_small() {
    let (mut slower, mut worst) = (0, 1.0f64);
    for seed in 0..2000 {
        let nodes = records(seed, 100);
        let mut hardware = hardware(seed, Independence::Both);
        let before = run(&nodes, &hardware).0.cycles;
        improve(&mut hardware, seed as usize % 20);
        let after = run(&nodes, &hardware).0.cycles;
        slower += u32::from(after > before);
        worst = worst.max(after as f64 / before as f64);
    }
    assert_eq!(slower, 109);
    assert!((1.15..1.16).contains(&worst), "{worst}");
}

#[test]
fn a_stack_that_does_not_spill_overflows() {
    let nodes = records(3, 200);
    let mut hardware = hardware(3, Independence::None);
    hardware.stack.entries = 2;
    hardware.stack.overflow = StackOverflow::Error;
    let mut workload = Listed::new(&nodes, &hardware);
    let error = simulate(&hardware, &mut workload, &mut NoObserver).unwrap_err();
    assert!(error.to_string().contains("the 2 entries of lane"));
}
