//! Outer memory: the port that all requests share, and the banks of a DRAM behind it (rule 15 of [the parent
//! module](super)).

use std::io::{self, Write};

use serde::{Deserialize, Serialize};

use super::hardware::OuterMemory;
use crate::memory::PIXEL_BITS;

/// Banks that each keep one row open. Times are cycles of the design's clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "docs/hardware-model.md explains each setting")]
pub struct Dram {
    pub banks: u32,
    pub row_bytes: u32,
    /// From the opening of a row to the column's command.
    pub t_rcd: u32,
    /// To close a row.
    pub t_rp: u32,
    /// From the column's command to the data.
    pub t_cl: u32,
}

impl Dram {
    /// Cycles of a request that finds another row open.
    pub(super) fn slowest(self) -> u64 {
        u64::from(self.t_rp) + u64::from(self.t_rcd) + u64::from(self.t_cl)
    }
}

/// Requests by the state of their bank.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct RowReport {
    /// Their row was open.
    pub hits: u64,
    /// No row was open.
    pub opened: u64,
    /// Another row was open.
    pub replaced: u64,
}

/// A request to outer memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct OuterRequest {
    /// In which the port accepts it.
    pub cycle: u64,
    /// In bytes.
    pub address: u64,
    pub bytes: u64,
    pub write: bool,
}

/// Data in outer memory. Each region begins at a multiple of 2^30 bytes, in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Region {
    Nodes,
    Attributes,
    Pixels,
    /// Records without an entry on the stack, which are a stack themselves.
    Spilled,
}

impl Region {
    fn start(self) -> u64 {
        (self as u64) << 30
    }
}

/// The course of a request.
#[derive(Debug, Clone, Copy)]
pub(super) struct Booked {
    /// In which the port accepts it.
    pub(super) begun: u64,
    /// For which it takes the port.
    pub(super) moving: u64,
    /// Further cycles, for its bank.
    pub(super) late: u64,
}

#[derive(Debug, Clone, Copy, Default)]
struct Bank {
    row: Option<u64>,
    free_at: u64,
    busy: u64,
}

#[derive(Debug, Clone)]
pub(super) struct OuterPort {
    pub(super) of: OuterMemory,
    free_at: u64,
    pixel_bits: u64,
    spilled_bytes: u64,
    pub(super) busy: u64,
    banks: Vec<Bank>,
    rows: RowReport,
    /// All requests, if an observer watches them.
    pub(super) log: Option<Vec<OuterRequest>>,
}

impl OuterPort {
    pub(super) fn new(of: OuterMemory) -> Self {
        let banks = of.dram.map_or(0, |dram| dram.banks as usize);
        Self {
            of,
            free_at: 0,
            pixel_bits: 0,
            spilled_bytes: 0,
            busy: 0,
            banks: vec![Bank::default(); banks],
            rows: RowReport::default(),
            log: None,
        }
    }

    /// The line of a cache that holds a byte of a region.
    #[inline]
    pub(super) fn book_line(
        &mut self,
        at: u64,
        line: u64,
        line_bytes: u32,
        region: Region,
    ) -> Booked {
        let bytes = u64::from(line_bytes);
        self.book(at, 8 * bytes, region.start() + line * bytes, false)
    }

    /// Returns the cycle when a pixel has left; neighbours share words.
    pub(super) fn book_pixel(&mut self, at: u64, pixel: u64) -> u64 {
        let bytes = u64::from(self.of.bytes_per_cycle.max(1));
        let bits = self.pixel_bits + u64::from(PIXEL_BITS);
        self.pixel_bits = bits % (8 * bytes);
        let address = pixel * u64::from(PIXEL_BITS / 8) / bytes * bytes;
        let complete = bits - self.pixel_bits;
        let of = self.book(at, complete, Region::Pixels.start() + address, true);
        of.begun + of.moving + of.late
    }

    /// A record goes onto the spilled ones, or the topmost comes back.
    pub(super) fn book_spilled(&mut self, at: u64, bits: u64, write: bool) -> Booked {
        let bytes = bits.div_ceil(8);
        let below = self.spilled_bytes.saturating_sub(bytes);
        let (address, top) = match write {
            true => (self.spilled_bytes, self.spilled_bytes + bytes),
            false => (below, below),
        };
        self.spilled_bytes = top;
        self.book(at, bits, Region::Spilled.start() + address, write)
    }

    #[inline]
    fn book(&mut self, at: u64, bits: u64, address: u64, write: bool) -> Booked {
        let moving = self.of.cycles(bits);
        let mut begun = at;
        if moving > 0 {
            begun = at.max(self.free_at);
            self.free_at = begun + moving;
            self.busy += moving;
        }
        let mut booked = Booked {
            begun,
            moving,
            late: 0,
        };
        if bits > 0 {
            if let Some(dram) = self.of.dram {
                booked.late = self.visit_bank(dram, address, booked);
            }
            if let Some(log) = &mut self.log {
                log.push(OuterRequest {
                    cycle: begun,
                    address,
                    bytes: bits.div_ceil(8),
                    write,
                });
            }
        }
        booked
    }

    /// Neighbouring rows lie in neighbouring banks.
    fn visit_bank(&mut self, dram: Dram, address: u64, booked: Booked) -> u64 {
        let row = address / u64::from(dram.row_bytes);
        let number = (row % u64::from(dram.banks)) as usize;
        let bank = &mut self.banks[number];
        let (rows, cycles) = match bank.row.replace(row) {
            Some(open) if open == row => (&mut self.rows.hits, u64::from(dram.t_cl)),
            Some(_) => (&mut self.rows.replaced, dram.slowest()),
            None => {
                let cycles = dram.slowest() - u64::from(dram.t_rp);
                (&mut self.rows.opened, cycles)
            }
        };
        *rows += 1;
        let ends = booked.begun.max(bank.free_at) + cycles;
        bank.free_at = ends + booked.moving;
        bank.busy += cycles + booked.moving;
        ends - booked.begun
    }

    pub(super) fn rows(&self) -> Option<RowReport> {
        self.of.dram.map(|_| self.rows)
    }

    /// Cycles of the busiest bank.
    pub(super) fn bank_bound(&self) -> Option<u64> {
        self.banks.iter().map(|bank| bank.busy).max()
    }
}

/// Bytes of a request in [`write_ramulator`].
const BURST_BYTES: u64 = 64;

/// Writes the memory trace that Ramulator reads with `--mode=dram`. A request of 64 bytes is a line, its address in
/// hexadecimal and `R` or `W`, in the order in which the port accepts them. The format has no times. A request of fewer
/// bytes is a line of its own.
pub fn write_ramulator(mut requests: Vec<OuterRequest>, mut to: impl Write) -> io::Result<()> {
    requests.sort_by_key(|request| request.cycle);
    for request in requests {
        let way = if request.write { 'W' } else { 'R' };
        let bursts =
            request.address / BURST_BYTES..=(request.address + request.bytes - 1) / BURST_BYTES;
        for burst in bursts {
            writeln!(to, "{:#x} {way}", burst * BURST_BYTES)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight bytes per cycle; two banks of rows of 64 bytes, 3 + 5 + 7 cycles.
    fn port() -> OuterPort {
        let dram = Dram {
            banks: 2,
            row_bytes: 64,
            t_rcd: 5,
            t_rp: 3,
            t_cl: 7,
        };
        OuterPort::new(OuterMemory {
            bytes_per_cycle: 8,
            dram: Some(dram),
        })
    }

    /// Cycles in which requests of 32 bytes begin, and further cycles for their bank.
    #[test]
    fn rows_by_hand() {
        let mut port = port();
        for (at, line, begun, late) in [
            (0, 0, 0, 12),     // bank 0, row 0: opened; its data come in cycles 12 to 15
            (0, 2, 4, 12),     // bank 1, row 1: opened
            (20, 1, 20, 7),    // bank 0, row 0 again
            (20, 4, 24, 22),   // bank 0, row 2: its bank is free in cycle 31, 15 more
            (100, 5, 100, 7),  // row 2 again
            (100, 0, 104, 22), // row 0: the bank is free in cycle 111
        ] {
            let of = port.book_line(at, line, 32, Region::Nodes);
            assert_eq!((of.begun, of.moving, of.late), (begun, 4, late), "{line}");
        }
        let [hits, opened, replaced] = [2; 3];
        let expected = RowReport {
            hits,
            opened,
            replaced,
        };
        assert_eq!(port.rows(), Some(expected));
        // Bank 0: 12 + 7 + 15 + 7 + 15, and five transfers.
        assert_eq!(port.bank_bound(), Some(56 + 5 * 4));
        port.of.dram = None;
        assert_eq!(port.book_line(200, 0, 32, Region::Nodes).late, 0);
    }

    /// A line of 128 bytes, three pixels of which two complete a word, and records of 65 bytes that come back.
    #[test]
    fn a_trace_for_ramulator_by_hand() {
        let mut port = port();
        port.log = Some(Vec::new());
        port.book_line(0, 1, 128, Region::Attributes);
        for pixel in [0, 1, 30] {
            port.book_pixel(50, pixel);
        }
        for write in [true, true, false, false] {
            port.book_spilled(90, 8 * 65, write);
        }
        let mut text = Vec::new();
        write_ramulator(port.log.take().unwrap(), &mut text).unwrap();
        let expected = "0x40000080 R\n0x400000c0 R\n0x80000040 W\n\
            0xc0000000 W\n0xc0000040 W\n0xc0000040 W\n0xc0000080 W\n\
            0xc0000040 R\n0xc0000080 R\n0xc0000000 R\n0xc0000040 R\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }
}
