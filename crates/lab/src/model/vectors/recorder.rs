//! A probe that writes what crosses the borders of blocks, row by row.

use std::path::{Path, PathBuf};

use hwmodel::cycles::StackHolds;
use hwmodel::{Format, Probe, Signal};

use super::VectorsError;
use super::blocks::describe;
use super::description::{Description, absence};
use super::rows::{EXPECTED, Rows, STIMULUS, file_name, packed};
use super::turns::Turns;
use shiftvox::machine::{Block, NumberSpan, Port};
use shiftvox::project::FrameSetup;

/// A block's files and how many rows they have by now.
#[derive(Debug)]
pub(super) struct Recording {
    pub(super) description: Description,
    pub(super) rows: u64,
    /// Of them, those that the frame's records brought.
    pub(super) frame_rows: u64,
    /// Least and greatest values of inputs and outputs in those rows.
    pub(super) seen: [Vec<NumberSpan>; 2],
    /// Whether the frame's rules have the block.
    is_there: bool,
    files: Option<(Rows, Rows)>,
}

/// Writes the rows of a frame's first records.
#[derive(Debug)]
pub(super) struct Recorder {
    folder: PathBuf,
    format: Format,
    /// By the block's number.
    blocks: Vec<Recording>,
    turns: Option<Turns>,
    records: u64,
    is_open: bool,
    is_directed: bool,
    error: Option<VectorsError>,
}

impl Recorder {
    /// Of the first `records` records of a frame, into a folder that is there.
    pub(super) fn new(
        folder: &Path,
        setup: &FrameSetup,
        records: u64,
        stack: StackHolds,
    ) -> Result<Self, VectorsError> {
        let recording = |&block: &Block| Recording {
            description: describe(block, setup),
            rows: 0,
            frame_rows: 0,
            seen: Default::default(),
            is_there: absence(block, setup).is_none(),
            files: None,
        };
        Ok(Self {
            turns: Turns::create(folder, setup, stack)?,
            folder: folder.to_owned(),
            format: setup.format,
            blocks: Block::ALL.iter().map(recording).collect(),
            records,
            is_open: true,
            is_directed: false,
            error: None,
        })
    }

    /// The frame is drawn; what follows are inputs made for the blocks.
    pub(super) fn begin_directed(&mut self) {
        for recording in &mut self.blocks {
            recording.frame_rows = recording.rows;
        }
        self.is_open = self.error.is_none();
        self.is_directed = true;
    }

    /// What was recorded, blocks in the order of [`Block::ALL`], once all files are whole.
    pub(super) fn finish(mut self) -> Result<(Vec<Recording>, Option<Turns>), VectorsError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        for recording in &mut self.blocks {
            if let Some((stimulus, expected)) = &mut recording.files {
                stimulus.finish()?;
                expected.finish()?;
            }
        }
        if let Some(turns) = &mut self.turns {
            turns.finish()?;
        }
        Ok((self.blocks, self.turns))
    }

    fn record_row(
        &mut self,
        block: u32,
        stimulus: &[Signal],
        expected: &[Signal],
    ) -> Result<(), VectorsError> {
        let Some(recording) = self.blocks.get_mut(block as usize) else {
            let port = Port::ALL.get(block as usize - self.blocks.len());
            let (&port, &[address]) = port
                .zip(stimulus.first_chunk())
                .ok_or(VectorsError::Unknown(block))?;
            return match &mut self.turns {
                Some(turns) if !self.is_directed => turns.record(port, address, expected),
                _ => Ok(()),
            };
        };
        if self.is_directed && !recording.is_there {
            return Ok(());
        }
        let description = &recording.description;
        let into = packed(stimulus, &description.stimulus, self.format);
        let out = packed(expected, &description.expected, self.format);
        let (Some(into), Some(out)) = (into, out) else {
            return Err(VectorsError::Misfit(description.name));
        };
        let (to_stimulus, to_expected) = match &mut recording.files {
            Some(files) => files,
            files @ None => {
                let create = |end: &str, ports| {
                    let name = file_name(description.name, end);
                    Rows::create(self.folder.join(name), self.format, ports)
                };
                files.insert((
                    create(STIMULUS, &description.stimulus)?,
                    create(EXPECTED, &description.expected)?,
                ))
            }
        };
        to_stimulus.write(&into)?;
        to_expected.write(&out)?;
        recording.rows += 1;
        if !self.is_directed {
            for (seen, signals) in recording.seen.iter_mut().zip([stimulus, expected]) {
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

impl Probe for Recorder {
    const TAPS: bool = true;

    fn record(&mut self, index: u64, _level: u32) {
        self.is_open = index < self.records && self.error.is_none();
    }

    fn is_tapping(&self) -> bool {
        self.is_open
    }

    fn tap(&mut self, block: u32, stimulus: &[Signal], expected: &[Signal]) {
        if let Err(error) = self.record_row(block, stimulus, expected) {
            self.error = Some(error);
            self.is_open = false;
        }
    }
}
