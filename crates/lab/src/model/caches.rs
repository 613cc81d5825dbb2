//! The same frame with node caches of many sizes, on the light hardware and by
//! the ray caster: who needs less can turn with that one number.

use hwmodel::Overflow;
use hwmodel::cycles::{Hardware, NoObserver};
use rayon::prelude::*;
use serde::Serialize;

use super::ModelError;
use super::cost::{self, Prices};
use super::frame::{self, Counted};
use super::range::{Range, Winner};
use super::ray_caster;
use super::ray_cycles::RayHardware;
use crate::float_rays::RayOrder;
use shiftvox::frame::Frame;
use shiftvox::graph::{Graph, Progress};
use shiftvox::project::FrameSetup;

/// Sizes of the node cache, bytes: 4 KiB to 1 MiB.
pub const SIZES: [u32; 5] = [4 << 10, 16 << 10, 64 << 10, 256 << 10, 1 << 20];

/// A design with a node cache of one size.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct CachePoint {
    /// Order of the rays; none for the light hardware.
    pub order: Option<RayOrder>,
    /// Energy of the frame, pJ.
    pub energy_pj: Range,
    /// Cycles: simulated, or of the ray caster no fewer than.
    pub cycles: u64,
    /// Lines of nodes brought in.
    pub node_misses: u64,
}

/// All designs with a node cache of one size.
#[derive(Debug, Clone, Serialize)]
pub struct CacheRow {
    /// Size of the node cache.
    pub bytes: u32,
    /// The light hardware.
    pub light: CachePoint,
    /// The ray caster, by order of its rays.
    pub ray_caster: Vec<CachePoint>,
    /// Of those, the one of least energy.
    pub best: CachePoint,
    /// Who needs less energy, the ray caster in its best order.
    pub winner: Winner,
    /// Who needs less if both pay the same for outer memory, low or high.
    pub at_equal_prices: Winner,
}

impl CacheRow {
    /// Both designs at a size; none where no rays were cast.
    fn new(bytes: u32, light: CachePoint, ray_caster: Vec<CachePoint>) -> Option<Self> {
        let energy = |point: &CachePoint| point.energy_pj.value;
        let best = *ray_caster
            .iter()
            .min_by(|a, b| energy(a).total_cmp(&energy(b)))?;
        Some(Self {
            bytes,
            winner: Winner::by_ranges(light.energy_pj, best.energy_pj),
            at_equal_prices: Winner::at_equal_prices(light.energy_pj, best.energy_pj),
            light,
            ray_caster,
            best,
        })
    }
}

/// A frame of the light hardware as it was counted, and what it is drawn of.
#[derive(Debug, Clone, Copy)]
pub struct Drawn<'a> {
    /// What is drawn.
    pub graph: &'a Graph,
    /// The view.
    pub setup: &'a FrameSetup,
    /// What the machine did.
    pub counted: &'a Counted,
    /// The true picture.
    pub exact: &'a Frame,
}

/// The table. `orders`: of the rays that are cast.
///
/// # Errors
/// When the hardware cannot have a cache of one of the sizes, or the cost
/// tables lack a figure.
pub fn table(
    drawn: Drawn<'_>,
    overflow: Overflow,
    hardware: &Hardware,
    orders: &[RayOrder],
    prices: &Prices,
    progress: &dyn Progress,
) -> Result<Vec<CacheRow>, ModelError> {
    let Drawn {
        graph,
        setup,
        counted,
        exact,
    } = drawn;
    let with = |bytes: u32| {
        let mut hardware = hardware.clone();
        hardware.node_cache.bytes = bytes;
        hardware.check().map(|()| hardware)
    };
    progress.begin(
        "sizes of the node cache",
        (SIZES.len() + orders.len()) as u64,
    );
    let casts = orders.par_iter().map(|&order| {
        let cast = ray_caster::cast(graph, setup, hardware, &SIZES, order, exact);
        progress.advance(1);
        cast
    });
    let casts = casts.collect::<Result<Vec<_>, _>>()?;
    let rays = RayHardware::shipped();
    let row = |(at, &bytes): (usize, &u32)| {
        let hardware = with(bytes)?;
        let simulated =
            frame::simulate(&graph.view(), setup, &hardware, overflow, &mut NoObserver)?;
        let cycles = &simulated.1.cycles;
        let widths = frame::widths(setup, graph, &hardware);
        let energy = cost::frame_cost(counted, cycles, &widths, setup, &hardware, prices)?;
        let light = CachePoint {
            order: None,
            energy_pj: Range::new(energy.total()),
            cycles: cycles.cycles,
            node_misses: cycles.node_cache.misses,
        };
        let of_rays = |cast: &ray_caster::RayRun| {
            let report = ray_caster::price(cast, at, &hardware, &rays, prices)?;
            Ok(CachePoint {
                order: Some(report.order),
                energy_pj: Range::new(report.cost.total()),
                cycles: report.cycles.cycles,
                node_misses: report.node_misses,
            })
        };
        let points = casts.iter().map(of_rays);
        let points = points.collect::<Result<_, ModelError>>()?;
        progress.advance(1);
        Ok(CacheRow::new(bytes, light, points))
    };
    let rows = SIZES.par_iter().enumerate().map(row);
    let rows = rows.collect::<Result<Vec<_>, ModelError>>()?;
    progress.end();
    Ok(rows.into_iter().flatten().collect())
}

/// Who needs less energy where, as the figures have it.
#[must_use]
pub fn sentence(rows: &[CacheRow]) -> String {
    let by_ranges = who(rows, |row| row.winner);
    let equal = who(rows, |row| row.at_equal_prices);
    format!(
        "Energy of the frame over the size of the node cache, the ray caster in its best order: {by_ranges}. \
         If both pay the same for a word of outer memory, be it the low or the high price: {equal}."
    )
}

fn who(rows: &[CacheRow], winner: fn(&CacheRow) -> Winner) -> String {
    let mut parts = Vec::new();
    for same in rows.chunk_by(|a, b| winner(a) == winner(b)) {
        let [first, .., last] = same else {
            parts.push(part(winner(&same[0]), &size(same[0].bytes)));
            continue;
        };
        let sizes = format!("{} to {}", size(first.bytes), size(last.bytes));
        parts.push(part(winner(first), &sizes));
    }
    parts.join("; ")
}

fn part(winner: Winner, sizes: &str) -> String {
    match winner {
        Winner::Neither => format!("at {sizes} neither wins, for the ranges overlap"),
        winner => format!("at {sizes} the {} needs less", winner.name()),
    }
}

/// Bytes in KiB or MiB.
#[must_use]
pub fn size(bytes: u32) -> String {
    if bytes >= 1 << 20 && bytes.is_multiple_of(1 << 20) {
        format!("{} MiB", bytes >> 20)
    } else {
        format!("{} KiB", bytes >> 10)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(bytes: u32, light: (f64, f64), rays: &[(f64, f64)]) -> CacheRow {
        let point = |order, (low, high): (f64, f64)| CachePoint {
            order,
            energy_pj: Range::new((f64::midpoint(low, high), low, high)),
            cycles: 1,
            node_misses: 1,
        };
        let ray_caster: Vec<_> = RayOrder::ALL
            .iter()
            .zip(rays)
            .map(|(&order, &range)| point(Some(order), range))
            .collect();
        CacheRow::new(bytes, point(None, light), ray_caster).unwrap()
    }

    #[test]
    fn the_sentence_says_what_the_figures_say() {
        let rows = [
            row(4096, (1.0, 2.0), &[(9.0, 10.0), (3.0, 4.0)]),
            row(16384, (1.0, 2.0), &[(1.5, 3.0), (8.0, 9.0)]),
            row(65536, (3.0, 4.0), &[(1.0, 2.0), (8.0, 9.0)]),
            row(1 << 20, (3.0, 4.0), &[(1.0, 2.0), (0.5, 1.0)]),
        ];
        assert_eq!(rows[0].best.order, Some(RayOrder::Tiles));
        assert_eq!(
            sentence(&rows),
            "Energy of the frame over the size of the node cache, the ray caster in its best order: \
             at 4 KiB the light hardware needs less; at 16 KiB neither wins, for the ranges overlap; \
             at 64 KiB to 1 MiB the ray caster needs less. If both pay the same for a word of outer memory, \
             be it the low or the high price: at 4 KiB to 16 KiB the light hardware needs less; \
             at 64 KiB to 1 MiB the ray caster needs less."
        );
    }
}
