//! A probe that writes the inputs and outputs of blocks, and the events of the ports to memories, as lines of JSON.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use hwmodel::cycles::StackHolds;
use hwmodel::{Format, Probe, Signal};

use super::VectorsError;
use super::blocks::{Description, Descriptions, absence, describe};
use super::folder::failed;
use super::ports::Ports;
use shiftvox::machine::{Block, NumberSpan, Port};
use shiftvox::project::FrameSetup;

pub(super) const TURNS: &str = "turns.jsonl";

pub(super) fn file_name(block: &str) -> String {
    format!("{block}.jsonl")
}

fn name_of(port: Port) -> &'static str {
    match port {
        Port::Pop => "pop",
        Port::Push => "push",
        Port::FillRead => "fill_read",
        Port::FillWrite => "fill_write",
        Port::NodeRead => "node_read",
        Port::AttributeRead => "attribute_read",
        Port::PixelWrite => "pixel_write",
        Port::Made => "made",
    }
}

#[derive(Debug)]
struct Lines {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Lines {
    fn create(path: PathBuf) -> Result<Self, VectorsError> {
        let file = File::create(&path).map_err(|e| failed(&path, e))?;
        let file = BufWriter::new(file);
        Ok(Self { path, file })
    }

    fn write(&mut self, line: &str) -> Result<(), VectorsError> {
        writeln!(self.file, "{line}").map_err(|e| failed(&self.path, e))
    }

    fn finish(&mut self) -> Result<(), VectorsError> {
        self.file.flush().map_err(|e| failed(&self.path, e))
    }
}

#[derive(Debug)]
pub(super) struct Recording {
    pub(super) block: Block,
    pub(super) description: &'static Description,
    pub(super) ports: [Ports; 2],
    pub(super) rows: u64,
    /// Rows from the frame's records. They come first.
    pub(super) frame_rows: u64,
    /// Least and greatest values of inputs and outputs in those rows.
    pub(super) seen: [Vec<NumberSpan>; 2],
    file: Option<Lines>,
}

#[derive(Debug)]
pub(super) struct Turns {
    pub(super) record: Ports,
    pub(super) turns: u64,
    pub(super) events: u64,
    file: Lines,
    /// Whether records lie on the stack, and not parents.
    stacks_records: bool,
}

/// Records the first turns of a frame, and then the rows made for the blocks.
#[derive(Debug)]
pub(super) struct Recorder {
    folder: PathBuf,
    setup: FrameSetup,
    blocks: Vec<Recording>,
    turns: Option<Turns>,
    records: u64,
    is_open: bool,
    is_directed: bool,
    error: Option<VectorsError>,
}

impl Recorder {
    /// Of the first `records` records of a frame, into a folder that exists.
    pub(super) fn new(
        folder: &Path,
        setup: &FrameSetup,
        records: u64,
        stack: StackHolds,
    ) -> Result<Self, VectorsError> {
        let cage = setup.options.cage;
        let recording = |block: Block| {
            let description = describe(block);
            Recording {
                block,
                description,
                ports: [&description.inputs, &description.outputs].map(|of| Ports::new(of, cage)),
                rows: 0,
                frame_rows: 0,
                seen: Default::default(),
                file: None,
            }
        };
        // Turns that blend are not recorded.
        let turns = (!setup.options.coverage.blends()).then(|| {
            Ok::<_, VectorsError>(Turns {
                record: Ports::new(&Descriptions::shipped().record, cage),
                turns: 0,
                events: 0,
                file: Lines::create(folder.join(TURNS))?,
                stacks_records: stack == StackHolds::Children,
            })
        });
        Ok(Self {
            turns: turns.transpose()?,
            folder: folder.to_owned(),
            setup: setup.clone(),
            blocks: Block::ALL.map(recording).into(),
            records,
            is_open: true,
            is_directed: false,
            error: None,
        })
    }

    /// The frame is drawn. Further rows are made for the blocks.
    pub(super) fn begin_directed(&mut self) {
        for recording in &mut self.blocks {
            recording.frame_rows = recording.rows;
        }
        self.is_open = self.error.is_none();
        self.is_directed = true;
    }

    /// The recordings in the order of [`Block::ALL`], and the turns, once all files are complete.
    pub(super) fn finish(mut self) -> Result<(Vec<Recording>, Option<Turns>), VectorsError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        let blocks = self.blocks.iter_mut().filter_map(|of| of.file.as_mut());
        let turns = self.turns.iter_mut().map(|of| &mut of.file);
        blocks.chain(turns).try_for_each(Lines::finish)?;
        Ok((self.blocks, self.turns))
    }

    fn record_row(&mut self, number: u32, rows: [&[Signal]; 2]) -> Result<(), VectorsError> {
        let format = self.setup.format;
        let Some(recording) = self.blocks.get_mut(number as usize) else {
            let port = Port::ALL.get(number as usize - self.blocks.len());
            return match (&mut self.turns, port, rows) {
                (Some(turns), Some(&port), [&[address], data]) if !self.is_directed => {
                    turns.record(port, address, data, format)
                }
                _ => Ok(()),
            };
        };
        if self.is_directed && absence(recording.block, &self.setup).is_some() {
            return Ok(());
        }
        let name = recording.description.name.as_str();
        let packed = |side: usize| recording.ports[side].packed(rows[side], format);
        let (Some(into), Some(out)) = (packed(0), packed(1)) else {
            return Err(VectorsError::Misfit(name));
        };
        let file = match &mut recording.file {
            Some(file) => file,
            none => none.insert(Lines::create(self.folder.join(file_name(name)))?),
        };
        file.write(&format!(r#"{{"in":"{into}","out":"{out}"}}"#))?;
        recording.rows += 1;
        if !self.is_directed {
            for (seen, signals) in recording.seen.iter_mut().zip(rows) {
                let one = |signal: &Signal| NumberSpan::of(signal.value.into());
                if seen.is_empty() {
                    seen.extend(signals.iter().map(one));
                }
                for (seen, signal) in seen.iter_mut().zip(signals) {
                    *seen = seen.with(one(signal));
                }
            }
        }
        Ok(())
    }
}

impl Turns {
    fn record(
        &mut self,
        port: Port,
        address: Signal,
        data: &[Signal],
        format: Format,
    ) -> Result<(), VectorsError> {
        let is_record = match port {
            Port::Pop | Port::Push => self.stacks_records,
            other => other == Port::Made,
        };
        let data = match is_record {
            true => {
                let row = self.record.packed(data, format);
                row.ok_or(VectorsError::Misfit(TURNS))?
            }
            false => {
                let join = |all: u64, of: &Signal| all << of.kind.bits(format) | of.value as u64;
                format!("{:x}", data.iter().fold(0, join))
            }
        };
        self.turns += u64::from(port == Port::Made || port == Port::Pop && self.stacks_records);
        self.events += 1;
        let (port, address) = (name_of(port), address.value);
        self.file.write(&format!(
            r#"{{"port":"{port}","address":{address},"data":"{data}"}}"#
        ))
    }
}

impl Probe for Recorder {
    const TAPS: bool = true;

    fn record(&mut self, index: u64, _level: u32) {
        self.is_open = index < self.records && self.error.is_none();
    }

    fn is_tapping(&self) -> bool {
        self.is_open
    }

    fn tap(&mut self, block: u32, stimulus: &[Signal], expected: &[Signal]) {
        if let Err(error) = self.record_row(block, [stimulus, expected]) {
            self.error = Some(error);
            self.is_open = false;
        }
    }
}
