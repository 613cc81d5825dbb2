//! Whole turns: what records take from the machine's memories and give to them, in order.
//!
//! A turn begins with the record that is popped; what stands before the first pop is the start, which
//! pushes the whole object. Records stand in a file of their own, once each, in the order in which they were pushed.
//! Where parents lie on the stack, a turn begins with the record that is made or worked back, and those stand there.

use std::path::Path;

use hwmodel::cycles::StackHolds;
use hwmodel::{Format, Signal, SignalKind};
use serde_json::{Value, json};

use super::VectorsError;
use super::manifest_fields::fields;
use super::ports::{BIT, LEVEL, Ports, WIDE, WORD};
use super::rows::{Rows, file_name, packed};
use shiftvox::machine::Port;
use shiftvox::project::FrameSetup;

const NODE: SignalKind = SignalKind::Unsigned(20);
const ADDRESS: SignalKind = SignalKind::Unsigned(32);
const PORT: SignalKind = SignalKind::Unsigned(3);
/// A node's mask of children and where they begin; anything else is shorter.
const DATA: SignalKind = SignalKind::Unsigned(40);

/// Names of the two files: `turns.ports.hex`, `turns.records.hex`.
const NAME: &str = "turns";
const EVENTS: &str = "ports";
const RECORDS: &str = "records";

/// The files of turns in the making.
#[derive(Debug)]
pub(super) struct Turns {
    format: Format,
    events: (Rows, Ports),
    records: (Rows, Ports),
    /// What lies on the stack: the number of the record's row, and the row.
    stack: Vec<(u64, String)>,
    turns: u64,
    event_rows: u64,
    record_rows: u64,
    /// Whether records lie on the stack, and not parents.
    stacks_records: bool,
}

/// A port's name, and what its address and data are.
fn describe(port: Port) -> (&'static str, &'static str) {
    match port {
        Port::Pop => (
            "pop",
            "address: place on the stack; data: the record's row, or of a parent \
             children left << 13 | octree level << 7 | quadtree level << 1 | inside",
        ),
        Port::Push => ("push", "as pop"),
        Port::FillRead => (
            "fill_read",
            "address: quadtree node; data: its vector, or its word of 16 samples",
        ),
        Port::FillWrite => ("fill_write", "as fill_read"),
        Port::NodeRead => (
            "node_read",
            "address: octree node, or a word of a brick; data: mask of its children << 32 | where they begin",
        ),
        Port::AttributeRead => ("attribute_read", "address: octree node; data: 0"),
        Port::PixelWrite => (
            "pixel_write",
            "address: row * width + column; data: the octree node that it shows",
        ),
        Port::Made => (
            "made",
            "where parents lie on the stack; address: 1 if worked back from another, without node and w_min; \
             data: the record's row",
        ),
    }
}

fn event_ports(setup: &FrameSetup) -> Ports {
    Ports::new(setup.options.cage)
        .one("port", PORT, "which port, by its number")
        .one("address", ADDRESS, "see the port")
        .one("data", DATA, "see the port")
}

/// As the machine shows a record.
fn record_ports(setup: &FrameSetup) -> Ports {
    let clip = "of the vertices in clip space, relative to the quadtree node";
    let plane = "silhouette plane of the edge, relative to the quadtree node";
    let ports = Ports::new(setup.options.cage)
        .one("solid", BIT, "a solid voxel, or a part of one")
        .one("inside", BIT, "the box lies inside the quadtree node")
        .one("in_screen_space", BIT, "the vertices are in screen space")
        .one("level", LEVEL, "octree level")
        .one(
            "voxel_level",
            LEVEL,
            "level of the voxel that it is a part of",
        )
        .one("quad_level", LEVEL, "quadtree level")
        .one("node", ADDRESS, "octree node")
        .each("quad", &["x", "y"], NODE, "quadtree node's column and row")
        .axes("min", WORD, "lowest vertex")
        .axes("max", WORD, "highest vertex")
        .cage("x", "X of the vertices; in screen space x in samples")
        .cage("y", "Y of the vertices; in screen space y in samples")
        .cage("w", clip)
        .one("w_min", WORD, clip)
        .each("span_x", &["low", "high"], WORD, "in screen space: the box")
        .each("span_y", &["low", "high"], WORD, "in screen space: the box");
    let ports = ["x", "y", "z"].iter().fold(ports, |ports, axis| {
        ports.each(&format!("edge_{axis}"), &["a", "b", "c"], WIDE, plane)
    });
    ports.each(
        "axis",
        &["x_c", "y_c", "z_c"],
        WIDE,
        "c of the plane across the axis",
    )
}

impl Turns {
    /// Of a frame; `None` where voxels are blended.
    pub(super) fn create(
        folder: &Path,
        setup: &FrameSetup,
        stack: StackHolds,
    ) -> Result<Option<Self>, VectorsError> {
        if setup.options.coverage.blends() {
            return Ok(None);
        }
        let file = |end: &str, ports: Ports| {
            let path = folder.join(file_name(NAME, end));
            Rows::create(path, setup.format, &ports).map(|rows| (rows, ports))
        };
        Ok(Some(Self {
            format: setup.format,
            events: file(EVENTS, event_ports(setup))?,
            records: file(RECORDS, record_ports(setup))?,
            stack: Vec::new(),
            turns: 0,
            event_rows: 0,
            record_rows: 0,
            stacks_records: stack == StackHolds::Children,
        }))
    }

    /// Something crosses a port.
    pub(super) fn record(
        &mut self,
        port: Port,
        address: Signal,
        data: &[Signal],
    ) -> Result<(), VectorsError> {
        let misfit = || VectorsError::Misfit(NAME);
        let of_record = || packed(data, &self.records.1, self.format).ok_or_else(misfit);
        let place = usize::try_from(address.value).map_err(|_| misfit())?;
        let data = match port {
            Port::Push if self.stacks_records => {
                let row = of_record()?;
                self.records.0.write(&row)?;
                self.stack.truncate(place);
                self.stack.push((self.record_rows, row));
                self.record_rows += 1;
                self.record_rows - 1
            }
            Port::Made => {
                self.turns += 1;
                self.records.0.write(&of_record()?)?;
                self.record_rows += 1;
                self.record_rows - 1
            }
            Port::Pop if self.stacks_records => {
                self.turns += 1;
                let row = of_record()?;
                let top = self.stack.get(place).filter(|(_, pushed)| *pushed == row);
                top.ok_or_else(misfit)?.0
            }
            _ => data.iter().fold(0, |all, signal| {
                all << signal.kind.bits(self.format) | signal.value as u64
            }),
        };
        let row = [
            (PORT, port as i64),
            (ADDRESS, address.value),
            (DATA, data as i64),
        ]
        .map(|(kind, value)| Signal { kind, value });
        let row = packed(&row, &self.events.1, self.format).ok_or_else(misfit)?;
        self.event_rows += 1;
        self.events.0.write(&row)
    }

    /// All is in the files.
    pub(super) fn finish(&mut self) -> Result<(), VectorsError> {
        self.events.0.finish()?;
        self.records.0.finish()
    }

    /// What the manifest says of them.
    pub(super) fn entry(&self) -> Value {
        let file = |end: &str, ports: &Ports, rows: u64| {
            let mut entry = fields(self.format, ports, Some(file_name(NAME, end)), &|_| {
                json!({})
            });
            entry["rows"] = json!(rows);
            entry
        };
        let ports = Port::ALL.map(|port| {
            let (name, meaning) = describe(port);
            json!({ "name": name, "number": port as u8, "meaning": meaning })
        });
        json!({
            "turns": self.turns,
            "ports": ports,
            "events": file(EVENTS, &self.events.1, self.event_rows),
            "records": file(RECORDS, &self.records.1, self.record_rows),
        })
    }
}
