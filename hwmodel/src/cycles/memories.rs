//! Memories under contention. A port serves accesses in the order in which their visits start.

use std::collections::VecDeque;
use std::ops::Range;

use super::hardware::{Banks, Cache, Hardware, Pixels};
use super::outer::{Dram, OuterPort, Region};
use super::report::{CacheReport, Cause};
use crate::Memory;
use crate::memory::PIXEL_BITS;

/// Cycles of lookup and inspection on sequential hardware.
const LOOK_UP: u64 = 2;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Access {
    pub(super) address: u64,
    pub(super) memory: Memory,
    pub(super) write: bool,
}

#[derive(Debug, Clone)]
pub(super) struct Port {
    cycle: u64,
    used: u32,
    per_cycle: u32,
    pub(super) accesses: u64,
}

impl Port {
    pub(super) fn new(per_cycle: u32) -> Self {
        Self {
            cycle: 0,
            used: 0,
            per_cycle,
            accesses: 0,
        }
    }

    #[inline]
    pub(super) fn book(&mut self, at: u64) -> u64 {
        self.accesses += 1;
        if at > self.cycle {
            self.cycle = at;
            self.used = 1;
        } else if self.used < self.per_cycle {
            self.used += 1;
        } else {
            self.cycle += 1;
            self.used = 1;
        }
        self.cycle
    }

    /// Allows no more accesses before `until`, and one fewer in it.
    fn hold(&mut self, until: u64) {
        if until > self.cycle {
            self.cycle = until;
            self.used = 1;
        }
    }

    pub(super) fn bound(&self) -> u64 {
        self.accesses.div_ceil(u64::from(self.per_cycle))
    }
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Served {
    pub(super) issued: u64,
    pub(super) done: u64,
    pub(super) cause: Cause,
}

#[derive(Debug, Clone, Copy)]
struct Line {
    number: u64,
    ready: u64,
}

#[derive(Debug)]
pub(super) struct CacheState {
    of: Cache,
    region: Region,
    sets: u64,
    /// Most recently used first in each set.
    lines: Vec<Line>,
    pub(super) port: Port,
    /// Cycles in which the misses in flight are done, oldest at `misses mod slots`.
    slots: Vec<u64>,
    misses: u64,
    delayed: u64,
    /// On sequential hardware.
    free_at: u64,
    coming_in: VecDeque<Range<u64>>,
}

impl CacheState {
    fn new(of: Cache, region: Region) -> Self {
        let lines = of.sets() as usize * of.ways as usize;
        Self {
            of,
            region,
            sets: u64::from(of.sets()),
            lines: vec![
                Line {
                    number: u64::MAX,
                    ready: 0
                };
                lines
            ],
            port: Port::new(of.ports),
            slots: vec![0; of.misses as usize],
            misses: 0,
            delayed: 0,
            free_at: 0,
            coming_in: VecDeque::new(),
        }
    }

    #[inline]
    fn access(&mut self, address: u64, at: u64, outer: &mut OuterPort) -> Served {
        let issued = self.port.book(at);
        self.look_up(address, issued, outer)
    }

    /// The first cycle from `now` in which sequential hardware can look something up.
    pub(super) fn free_from(&mut self, now: u64) -> u64 {
        while self.coming_in.front().is_some_and(|line| line.end <= now) {
            self.coming_in.pop_front();
        }
        let mut free = now.max(self.free_at);
        for line in &self.coming_in {
            if line.contains(&free) {
                free = line.end;
            }
        }
        free
    }

    /// An access of sequential hardware in a cycle in which the port is free (rule 12).
    pub(super) fn access_alone(&mut self, address: u64, at: u64, outer: &mut OuterPort) -> Served {
        self.port.accesses += 1;
        let misses = self.misses;
        let served = self.look_up(address, at, outer);
        self.free_at = served.issued + LOOK_UP;
        if self.misses > misses {
            let moving = outer.of.cycles(8 * u64::from(self.of.line_bytes));
            self.coming_in.push_back(served.done - moving..served.done);
        }
        served
    }

    #[inline]
    fn look_up(&mut self, address: u64, issued: u64, outer: &mut OuterPort) -> Served {
        if let Some(served) = self.find(address, issued) {
            return served;
        }
        let slot = (self.misses % self.slots.len() as u64) as usize;
        self.misses += 1;
        let line = self.line_number(address);
        let from = issued.max(self.slots[slot]);
        let request = outer.book_line(from, line, self.of.line_bytes, self.region);
        let begun = request.begun;
        self.port.hold(begun);
        let away = u64::from(self.of.miss_latency).max(request.moving) + request.late;
        let done = begun + u64::from(self.of.hit_latency) + away;
        self.slots[slot] = done;
        self.put(address, done);
        Served {
            issued: begun,
            done,
            cause: Cause::CacheMiss,
        }
    }

    /// An access to a buffer before another cache, which serves its misses.
    #[inline]
    fn access_before(
        &mut self,
        address: u64,
        at: u64,
        (behind, outer): (&mut Self, &mut OuterPort),
    ) -> Served {
        let issued = self.port.book(at);
        if let Some(served) = self.find(address, issued) {
            return served;
        }
        self.misses += 1;
        let found = issued + u64::from(self.of.hit_latency);
        let served = behind.access(address, found, outer);
        self.put(address, served.done);
        Served { issued, ..served }
    }

    fn line_number(&self, address: u64) -> u64 {
        let byte = address.wrapping_mul(u64::from(self.of.entry_bytes));
        byte >> self.of.line_bytes.trailing_zeros()
    }

    fn set(&mut self, number: u64) -> &mut [Line] {
        let ways = self.of.ways as usize;
        let start = (number % self.sets) as usize * ways;
        &mut self.lines[start..start + ways]
    }

    /// An access whose line is there or on its way.
    #[inline]
    fn find(&mut self, address: u64, issued: u64) -> Option<Served> {
        let hit = issued + u64::from(self.of.hit_latency);
        let number = self.line_number(address);
        let set = self.set(number);
        let way = set.iter().position(|line| line.number == number)?;
        let line = set[way];
        set.copy_within(0..way, 1);
        set[0] = line;
        let late = line.ready > hit;
        self.delayed += u64::from(late);
        Some(Served {
            issued,
            done: hit.max(line.ready),
            cause: if late {
                Cause::CacheMiss
            } else {
                Cause::MemoryPort
            },
        })
    }

    /// Replaces the least recently used line of the set.
    #[inline]
    fn put(&mut self, address: u64, ready: u64) {
        let number = self.line_number(address);
        let set = self.set(number);
        set.copy_within(0..set.len() - 1, 1);
        set[0] = Line { number, ready };
    }

    pub(super) fn report(&self) -> CacheReport {
        let accesses = self.port.accesses;
        CacheReport {
            accesses,
            misses: self.misses,
            delayed_hits: self.delayed,
            hit_rate: hit_rate(accesses, self.misses),
            bytes_in: self.misses * u64::from(self.of.line_bytes),
        }
    }

    pub(super) fn miss_bound(&self) -> u64 {
        let each = u64::from(self.of.hit_latency) + u64::from(self.of.miss_latency);
        self.misses * each / self.slots.len() as u64
    }
}

fn hit_rate(accesses: u64, misses: u64) -> f64 {
    match accesses {
        0 => 1.0,
        _ => 1.0 - misses as f64 / accesses as f64,
    }
}

#[derive(Debug, Clone)]
pub(super) struct BanksState {
    latency: u32,
    reads: Vec<Port>,
    writes: Vec<Port>,
}

impl BanksState {
    fn new(of: Banks) -> Self {
        let banks = of.banks as usize;
        Self {
            latency: of.latency,
            reads: vec![Port::new(of.read_ports); banks],
            writes: vec![Port::new(of.write_ports); banks],
        }
    }

    #[inline]
    fn access(&mut self, access: Access, at: u64) -> Served {
        let bank = (access.address % self.reads.len() as u64) as usize;
        let (issued, latency) = if access.write {
            (self.writes[bank].book(at), 1)
        } else {
            (self.reads[bank].book(at), self.latency)
        };
        Served {
            issued,
            done: issued + u64::from(latency),
            cause: Cause::BankConflict,
        }
    }

    fn accesses(&self) -> (u64, u64) {
        let all = |ports: &[Port]| ports.iter().map(|port| port.accesses).sum();
        (all(&self.reads), all(&self.writes))
    }

    fn bound(&self) -> u64 {
        let ports = self.reads.iter().chain(&self.writes);
        ports.map(Port::bound).max().unwrap_or(0)
    }
}

#[derive(Debug)]
pub(super) struct PixelsState {
    of: Pixels,
    pub(super) port: Port,
    leaving: Vec<u64>,
    last: u64,
}

impl PixelsState {
    fn new(of: Pixels) -> Self {
        Self {
            of,
            port: Port::new(of.write_ports),
            leaving: vec![0; of.buffer as usize],
            last: 0,
        }
    }

    #[inline]
    fn write(&mut self, pixel: u64, at: u64, outer: &mut OuterPort) -> Served {
        let slot = (self.port.accesses % self.leaving.len() as u64) as usize;
        let ported = self.port.book(at);
        let issued = ported.max(self.leaving[slot]);
        self.port.hold(issued);
        let drained = issued.max(self.last) + u64::from(self.of.drain_interval);
        self.last = match self.of.own_port {
            true => drained,
            false => drained.max(outer.book_pixel(issued, pixel)),
        };
        self.leaving[slot] = self.last;
        Served {
            issued,
            done: issued + 1,
            cause: Cause::PixelPort,
        }
    }

    pub(super) fn last(&self) -> u64 {
        self.last
    }

    pub(super) fn drain_bound(&self) -> u64 {
        self.port.accesses * u64::from(self.of.drain_interval)
    }
}

#[derive(Debug)]
pub(super) struct Memories {
    pub(super) stacks: Vec<Port>,
    stack_latency: u64,
    pub(super) nodes: CacheState,
    /// By lane.
    buffers: Vec<CacheState>,
    pub(super) attributes: CacheState,
    fill: Vec<BanksState>,
    pub(super) pixels: PixelsState,
    pub(super) outer: OuterPort,
}

impl Memories {
    pub(super) fn new(hardware: &Hardware) -> Self {
        let stacks = hardware.stacks() as usize;
        let fills = if hardware.hands_out_tiles() {
            stacks
        } else {
            1
        };
        Self {
            stacks: vec![Port::new(hardware.stack.ports); stacks],
            stack_latency: u64::from(hardware.stack.latency),
            nodes: CacheState::new(hardware.node_cache, Region::Nodes),
            buffers: hardware.node_buffer.map_or_else(Vec::new, |of| {
                let buffer = |_| CacheState::new(of, Region::Nodes);
                (0..stacks).map(buffer).collect()
            }),
            attributes: CacheState::new(hardware.attribute_cache, Region::Attributes),
            fill: vec![BanksState::new(hardware.fill_vectors); fills],
            pixels: PixelsState::new(hardware.pixels),
            outer: OuterPort::new(hardware.outer_memory),
        }
    }

    pub(super) fn buffer_report(&self) -> Option<CacheReport> {
        let reports = self.buffers.iter().map(CacheState::report);
        let (accesses, misses, delayed_hits, bytes_in) = reports
            .map(|of| (of.accesses, of.misses, of.delayed_hits, of.bytes_in))
            .reduce(|a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2, a.3 + b.3))?;
        Some(CacheReport {
            accesses,
            misses,
            delayed_hits,
            hit_rate: hit_rate(accesses, misses),
            bytes_in,
        })
    }

    pub(super) fn fill_accesses(&self) -> (u64, u64) {
        let all = self.fill.iter().map(BanksState::accesses);
        all.fold((0, 0), |sum, of| (sum.0 + of.0, sum.1 + of.1))
    }

    pub(super) fn fill_bound(&self) -> u64 {
        self.fill.iter().map(BanksState::bound).max().unwrap_or(0)
    }

    /// Serves an access from cycle `at`; `lane` is the index of its stack.
    #[inline]
    pub(super) fn serve(&mut self, access: Access, at: u64, lane: usize) -> Served {
        match access.memory {
            Memory::Stack => {
                let issued = self.stacks[lane].book(at);
                let latency = if access.write { 1 } else { self.stack_latency };
                Served {
                    issued,
                    done: issued + latency,
                    cause: Cause::MemoryPort,
                }
            }
            Memory::Node => match self.buffers.get_mut(lane) {
                None => self.nodes.access(access.address, at, &mut self.outer),
                Some(buffer) => {
                    buffer.access_before(access.address, at, (&mut self.nodes, &mut self.outer))
                }
            },
            Memory::Attribute => self.attributes.access(access.address, at, &mut self.outer),
            Memory::FillVector => {
                let of = lane % self.fill.len();
                self.fill[of].access(access, at)
            }
            Memory::Pixel => self.pixels.write(access.address, at, &mut self.outer),
            // Beside the blending block, with a port to read and one to write: never waited for.
            Memory::Accumulator => Served {
                issued: at,
                done: at + 1,
                cause: Cause::MemoryPort,
            },
        }
    }
}

/// Cycles of an access without waiting, and with the longest wait.
#[derive(Debug, Clone)]
pub(super) struct Latencies {
    alone: [[u64; 2]; Memory::ALL.len()],
    worst: [u64; Memory::ALL.len()],
}

impl Latencies {
    pub(super) fn new(hardware: &Hardware) -> Self {
        let mut alone = [[1; 2]; Memory::ALL.len()];
        let mut worst = [0; Memory::ALL.len()];
        let caches = [
            (Memory::Node, hardware.node_cache),
            (Memory::Attribute, hardware.attribute_cache),
        ];
        alone[Memory::Stack as usize][0] = u64::from(hardware.stack.latency);
        alone[Memory::FillVector as usize][0] = u64::from(hardware.fill_vectors.latency);
        for (memory, cache) in caches {
            alone[memory as usize] = [u64::from(cache.hit_latency); 2];
        }
        for memory in Memory::ALL {
            let [read, write] = alone[memory as usize];
            worst[memory as usize] = 1 + read.max(write);
        }
        if let Some(buffer) = hardware.node_buffer {
            let hit = u64::from(buffer.hit_latency);
            alone[Memory::Node as usize] = [hit; 2];
            worst[Memory::Node as usize] += hit;
        }
        let bank = hardware.outer_memory.dram.map_or(0, Dram::slowest);
        for (memory, cache) in caches {
            // Its own line, and the one before it at the port; its bank's work, to its last byte.
            let moving = hardware
                .outer_memory
                .cycles(8 * u64::from(cache.line_bytes));
            worst[memory as usize] += u64::from(cache.miss_latency).max(moving) + moving;
            if bank > 0 {
                worst[memory as usize] += bank + moving;
            }
            // It must get the lane again.
            worst[memory as usize] += u64::from(hardware.hands_out_tiles());
        }
        let moving = match hardware.pixels.own_port {
            true => 0,
            false => hardware.outer_memory.cycles(u64::from(PIXEL_BITS)) + bank,
        };
        worst[Memory::Pixel as usize] += u64::from(hardware.pixels.drain_interval) + moving;
        Self { alone, worst }
    }

    #[inline]
    pub(super) fn alone(&self, access: Access) -> u64 {
        self.alone[access.memory as usize][usize::from(access.write)]
    }

    #[inline]
    pub(super) fn worst(&self, access: Access) -> u64 {
        self.worst[access.memory as usize]
    }
}
