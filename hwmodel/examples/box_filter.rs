//! Another accelerator: the mean of every four pixels of a line, by a sliding sum.
//! `cargo run --release -p hwmodel --example box_filter`

use hwmodel::cost::{CostTable, energy_of};
use hwmodel::count::Counter;
use hwmodel::cycles::{Child, Hardware, NoObserver, TurnLog, Workload, simulate};
use hwmodel::{Datapath, Format, Memory, Overflow, Trap, Word};

hwmodel::stages! {
    enum Block {
        Load = "load",
        Sum = "sliding sum",
    }
}

const PIXELS: u32 = 4096;

/// Its datapath, the last four pixels, and their sum.
struct Filter(Datapath<(TurnLog, Counter)>, [Word; 4], Word);

impl Workload for Filter {
    type Error = Trap;

    fn start(&mut self, children: &mut Vec<Child>) -> Result<(), Trap> {
        children.push(Child::only(0));
        Ok(())
    }

    fn turn(&mut self, at: u32, children: &mut Vec<Child>) -> Result<(), Trap> {
        let Self(dp, last, sum) = self;
        dp.stage(Block::Load);
        dp.read(Memory::Node, at.into()); // through the first cache
        let new = dp.load(at * 37 % 256);
        dp.stage(Block::Sum);
        let more = dp.add(*sum, new);
        *sum = dp.sub(more, last[at as usize % 4]);
        last[at as usize % 4] = new;
        let _mean = dp.shr(*sum, 2);
        dp.write(Memory::Pixel, at.into());
        children.extend((at + 1 < PIXELS).then(|| Child::only(at + 1)));
        dp.trap().map_or(Ok(()), Err)
    }

    fn log(&mut self) -> &mut TurnLog {
        &mut self.0.probe_mut().0
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (hardware, table) = (Hardware::preset("tiny")?, CostTable::load_shipped()?);
    let probes = (TurnLog::new(&hardware), Counter::new());
    let dp = Datapath::new(Format::new(16, 0)?, Overflow::Trap, probes);
    let mut filter = Filter(dp, [Word::ZERO; 4], Word::ZERO);
    let cycles = simulate(&hardware, &mut filter, &mut NoObserver)?.cycles;
    let (_, counter) = filter.0.into_probe();
    let picojoules = energy_of(&counter, &table)?.total;
    let operations = counter.ops();
    println!("{operations} operations, {cycles} cycles, {picojoules:.1} pJ");
    Ok(())
}
