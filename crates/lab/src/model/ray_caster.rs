//! For comparison: a ray caster in floating point, drawing the same view with
//! the same node format and caches, counted and priced by the same tables.

use hwmodel::Memory;
use hwmodel::cost::{Breakdown, CostError, CostTable, Tally, energy_of_tallies};
use hwmodel::cycles::{self, Hardware};
use hwmodel::memory::{Cache, PIXEL_BITS};
use serde::{Deserialize, Serialize};

use super::ModelError;
use super::area::{self, DesignArea};
use super::cost::{FrameCost, OuterTraffic, Prices, outer_energy};
use super::frame;
use super::ray_cycles::{self, RayCycles, RayHardware, RayMisses};
use crate::float_rays::{self, FloatRayCounts, FloatStep, RayOrder, RayRead};
use crate::measure::CoverageError;
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, NodeLayout};
use shiftvox::project::FrameSetup;

#[derive(Debug, Clone, Serialize)]
pub struct RayCasterReport {
    pub order: RayOrder,
    pub counts: FloatRayCounts,
    pub node_hits: u64,
    pub node_misses: u64,
    pub attribute_misses: u64,
    pub cost: FrameCost,
    /// Lower bound on its cycles.
    pub cycles: RayCycles,
    pub area: DesignArea,
    pub error: CoverageError,
    pub orders: Vec<OrderEnergy>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OrderEnergy {
    pub order: RayOrder,
    pub energy_pj: f64,
}

/// A frame's rays, cast in one order beside caches of several sizes.
#[derive(Debug)]
pub struct RayRun {
    order: RayOrder,
    counts: FloatRayCounts,
    /// Hits and misses of nodes, for each node cache asked for.
    nodes: Vec<(u64, u64)>,
    attribute_misses: u64,
    error: CoverageError,
}

fn cache_of(cache: &cycles::Cache) -> Cache {
    Cache::new(cache.bytes, cache.ways, cache.line_bytes)
}

/// Casts a frame's rays beside node caches of several sizes. `exact` is the true picture.
pub fn cast(
    graph: &Graph,
    setup: &FrameSetup,
    hardware: &Hardware,
    node_caches: &[u32],
    order: RayOrder,
    exact: &Frame,
) -> Result<RayRun, ModelError> {
    let mut frame = Frame::new(setup.width, setup.height, false);
    let mut nodes = Vec::new();
    for &bytes in node_caches {
        let like = hardware.node_cache;
        nodes.push(cache_of(&cycles::Cache { bytes, ..like }));
    }
    let mut attributes = cache_of(&hardware.attribute_cache);
    let node_entry = u64::from(hardware.node_cache.entry_bytes);
    let attribute_entry = u64::from(hardware.attribute_cache.entry_bytes);
    let view = graph.view();
    let organisation = hardware.organisation;
    let layout = NodeLayout::new(&view, organisation.leaf_masks, organisation.bricks);
    let counts = float_rays::count(
        &view,
        setup,
        &mut frame,
        order,
        layout,
        &mut |read| match read {
            RayRead::Node(word) => {
                for cache in &mut nodes {
                    cache.access(word * node_entry);
                }
            }
            RayRead::Attribute(node) => {
                attributes.access(u64::from(node) * attribute_entry);
            }
        },
    );
    Ok(RayRun {
        order,
        counts,
        nodes: nodes.iter().map(|c| (c.hits(), c.misses())).collect(),
        attribute_misses: attributes.misses(),
        error: frame::error(&frame, exact),
    })
}

/// Prices a run with the node cache of `hardware`, which was the `at`th that it had.
pub fn price(
    run: &RayRun,
    at: usize,
    hardware: &Hardware,
    rays: &RayHardware,
    prices: &Prices,
) -> Result<RayCasterReport, CostError> {
    let (node_hits, node_misses) = run.nodes[at];
    let misses = RayMisses {
        node: node_misses,
        attribute: run.attribute_misses,
    };
    let counts = run.counts;
    let line_bits = |cache: &cycles::Cache| 8 * u64::from(cache.line_bytes);
    let traffic = OuterTraffic {
        node_bits: misses.node * line_bits(&hardware.node_cache),
        attribute_bits: misses.attribute * line_bits(&hardware.attribute_cache),
        pixel_bits: counts.of(FloatStep::PixelWrite) * u64::from(PIXEL_BITS),
        ..OuterTraffic::default()
    };
    let cost = cost_of(&counts, &traffic, hardware, rays, &prices.table)?;
    Ok(RayCasterReport {
        order: run.order,
        counts,
        node_hits,
        node_misses,
        attribute_misses: run.attribute_misses,
        orders: vec![OrderEnergy {
            order: run.order,
            energy_pj: cost.total().value,
        }],
        cost,
        cycles: ray_cycles::cycles(&counts, misses, &traffic, rays, hardware),
        area: area::of_rays(rays, hardware, prices)?,
        error: run.error,
    })
}

/// Casts a frame's rays in an order, or, where none is chosen, in the order of
/// least energy. `exact`: the true picture.
pub fn measure(
    graph: &Graph,
    setup: &FrameSetup,
    hardware: &Hardware,
    prices: &Prices,
    order: Option<RayOrder>,
    exact: &Frame,
) -> Result<RayCasterReport, ModelError> {
    let tried = order.map_or(RayOrder::ALL.to_vec(), |order| vec![order]);
    let sizes = [hardware.node_cache.bytes];
    let cast = |order| cast(graph, setup, hardware, &sizes, order, exact);
    let runs: Vec<RayRun> = tried.into_iter().map(cast).collect::<Result<_, _>>()?;
    let rays = RayHardware::shipped();
    Ok(cheapest(&runs, 0, hardware, &rays, prices)?)
}

/// Of runs in several orders, the one of least energy, priced as [`price`] does. There must be one.
pub fn cheapest(
    runs: &[RayRun],
    at: usize,
    hardware: &Hardware,
    rays: &RayHardware,
    prices: &Prices,
) -> Result<RayCasterReport, CostError> {
    let price = |run| price(run, at, hardware, rays, prices);
    let reports: Vec<RayCasterReport> = runs.iter().map(price).collect::<Result<_, _>>()?;
    let orders = reports.iter().flat_map(|report| report.orders.clone());
    let orders = orders.collect();
    let energy = |report: &RayCasterReport| report.cost.total().value;
    let best = reports
        .into_iter()
        .min_by(|a, b| energy(a).total_cmp(&energy(b)));
    let Some(best) = best else {
        unreachable!("there is an order");
    };
    Ok(RayCasterReport { orders, ..best })
}

fn cost_of(
    counts: &FloatRayCounts,
    traffic: &OuterTraffic,
    hardware: &Hardware,
    rays: &RayHardware,
    table: &CostTable,
) -> Result<FrameCost, CostError> {
    let tally = |&step: &FloatStep| {
        let (name, width) = ray_cycles::operation(step)?;
        Some(Tally {
            operation: name.to_owned(),
            width,
            times: counts.of(step),
        })
    };
    let operations: Vec<Tally> = FloatStep::ALL.iter().filter_map(tally).collect();
    let mut on_chip = Breakdown::default();
    let cache = |of: &cycles::Cache| (u64::from(of.bytes), 8 * of.entry_bytes);
    let nodes = cache(&hardware.node_cache);
    let attributes = cache(&hardware.attribute_cache);
    let stack = (ray_cycles::stack_bits(rays) / 8, ray_cycles::ASIDE_BITS);
    let (read, write) = ("sram_read", "sram_write");
    for (memory, operation, (bytes, bits), step) in [
        (Memory::Node, read, nodes, FloatStep::NodeRead),
        (
            Memory::Attribute,
            read,
            attributes,
            FloatStep::AttributeRead,
        ),
        (Memory::Stack, read, stack, FloatStep::StackRead),
        (Memory::Stack, write, stack, FloatStep::StackWrite),
    ] {
        let each = table.memory_energy(operation, bytes, bits)?;
        on_chip.push(memory.name(), operation, bits, counts.of(step), each);
    }
    Ok(FrameCost {
        operations: energy_of_tallies(&operations, table)?,
        on_chip,
        outer: outer_energy(traffic, table)?,
        traffic: *traffic,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten reads of attributes and two lines of them, nothing else.
    #[test]
    fn attributes_are_billed() {
        let hardware = Hardware::preset("paper").unwrap();
        let mut counts = FloatRayCounts::default();
        counts.add(FloatStep::AttributeRead, 10, 0);
        let run = RayRun {
            order: RayOrder::Rows,
            counts,
            nodes: vec![(0, 0)],
            attribute_misses: 2,
            error: CoverageError::default(),
        };
        let prices = Prices::shipped().unwrap();
        let report = price(&run, 0, &hardware, &RayHardware::shipped(), &prices).unwrap();
        // Two misses of 61 cycles, four at once.
        assert_eq!(report.cycles.cycles, 30);
        let units = report.area.units.lines.iter();
        let adders = units.filter(|line| line.operation == "float_add");
        for (found, expected) in [
            // 64 bits from 8 KB are 10 pJ; a line of 64 bytes is eight words of 1950 pJ.
            (report.cost.on_chip.total, 100.0),
            (report.cost.outer.total, 2.0 * 8.0 * 1950.0),
            // Four of the row's middle.
            (
                adders.map(|line| line.total).sum(),
                4.0 * (5243.1 + 7112.8) / 2.0,
            ),
        ] {
            assert!((found - expected).abs() < 1e-6, "{found}, {expected}");
        }
    }
}
