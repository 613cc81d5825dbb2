//! Tables of a document in JSON: each table is one line that names its rows and columns.

use serde_json::Value;

use crate::report::{Cell, Table};

#[derive(Debug, Clone, Copy)]
pub struct TableSpec {
    pub title: &'static str,
    /// The array of its rows, as a path with dots. A `*` matches every field of an object.
    pub rows: &'static str,
    /// Columns with blanks between them: `head=path:factor:digits`. Head, factor and digits may be missing. The path `*`
    /// is the name of the field that matched a `*` of `rows`. A `!` before a column leaves out rows in which it is zero.
    pub columns: &'static str,
}

const LINES: &str = "part=* name operation bits=width !times each=each.value::4 total::1 fit=each.fit rows=each.rows \
                     source=each.source";

/// The tables of a report for a terminal.
pub const SHORT: [TableSpec; 5] = [
    TableSpec {
        title: "Operations by stage and class",
        rows: "operations_by_stage",
        columns: "stage add=operations.add sub=operations.sub compare=operations.compare \
                  min_max=operations.min_max select=operations.select shift=operations.shift \
                  logic=operations.logic divide_step=operations.divide_step",
    },
    TableSpec {
        title: "Cycles by stage, and the waiting of records by cause",
        rows: "simulated.cycles.stages",
        columns: "stage !visits busy held used_percent=utilisation:100:1 block_busy=stalls.block_busy \
                  cache_miss=stalls.cache_miss memory_port=stalls.memory_port bank_conflict=stalls.bank_conflict \
                  pixel_port=stalls.pixel_port stack_spill=stalls.stack_spill steal=stalls.steal",
    },
    TableSpec {
        title: "Memories",
        rows: "memories",
        columns: "memory reads writes read_kilobytes=read_bits:1.220703125e-4:1 \
                  written_kilobytes=written_bits:1.220703125e-4:1",
    },
    TableSpec {
        title: "Bounds: the cycles that each resource needs at least",
        rows: "simulated.cycles.bounds",
        columns: "resource !cycles percent_of_the_frame=share:100:1",
    },
    TableSpec {
        title: "Both designs; the ratio's median and 90 % interval by what is uncertain about prices",
        rows: "comparison",
        columns: "what unit light ray_caster ratio median low high p_light_less decides turns_at",
    },
];

/// Further tables, with `-v`.
pub const LONG: [TableSpec; 8] = [
    TableSpec {
        title: "By octree level",
        rows: "levels",
        columns: "level records operations",
    },
    TableSpec {
        title: "A record on the stack",
        rows: "record",
        columns: "field !bits held",
    },
    TableSpec {
        title: "Numbers of a record, and the bits of each",
        rows: "numbers",
        columns: "name count seen proven used",
    },
    TableSpec {
        title: "Records on the stack by kind",
        rows: "records_by_kind",
        columns: "kind bits popped !pushed",
    },
    TableSpec {
        title: "Units against the clock",
        rows: "clock.units",
        columns: "stage class bits=width delay_ns=delay_ps:1e-3:2 depth depth_needed rows source",
    },
    TableSpec {
        title: "Energy of the light hardware, pJ",
        rows: "cost.*.lines",
        columns: LINES,
    },
    TableSpec {
        title: "Area of the light hardware, NAND2 equivalents",
        rows: "area.*.lines",
        columns: LINES,
    },
    TableSpec {
        title: "Energy of the ray caster, pJ",
        rows: "ray_caster.cost.*.lines",
        columns: LINES,
    },
];

impl TableSpec {
    pub fn of(&self, document: &Value) -> Table {
        let columns: Vec<Column> = self.columns.split_whitespace().map(Column::new).collect();
        let heads: Vec<&'static str> = columns.iter().map(|column| column.head).collect();
        let mut table = Table::new(self.title, &heads);
        for (name, row) in rows("", document, self.rows) {
            let cells: Vec<Cell> = columns.iter().map(|of| of.cell(name, row)).collect();
            let is_zero = |cell: &Cell| match cell {
                Cell::Count(count) => *count == 0,
                other => *other == Cell::None,
            };
            let mut needed = columns.iter().zip(&cells).filter(|(of, _)| of.is_needed);
            if !needed.any(|(_, cell)| is_zero(cell)) {
                table.rows.push(cells);
            }
        }
        table
    }
}

struct Column {
    head: &'static str,
    path: &'static str,
    factor: Option<f64>,
    digits: usize,
    is_needed: bool,
}

impl Column {
    fn new(text: &'static str) -> Self {
        let (is_needed, text) = match text.strip_prefix('!') {
            Some(text) => (true, text),
            None => (false, text),
        };
        let (named, rest) = text.split_once(':').unwrap_or((text, ""));
        let (head, path) = named.split_once('=').unwrap_or((named, named));
        let (factor, digits) = rest.split_once(':').unwrap_or((rest, ""));
        Self {
            head,
            path,
            factor: factor.parse().ok(),
            digits: digits.parse().unwrap_or(3),
            is_needed,
        }
    }

    fn cell(&self, name: &str, row: &Value) -> Cell {
        if self.path == "*" {
            return name.into();
        }
        let value = self
            .path
            .split('.')
            .try_fold(row, |value, key| value.get(key));
        match value {
            None | Some(Value::Null | Value::Array(_) | Value::Object(_)) => Cell::None,
            Some(Value::Bool(is)) => if *is { "yes" } else { "no" }.into(),
            Some(Value::String(text)) => text.as_str().into(),
            Some(Value::Number(number)) => match (number.as_u64(), self.factor) {
                (Some(count), None) => count.into(),
                _ => {
                    let value = number.as_f64().unwrap_or(f64::NAN) * self.factor.unwrap_or(1.0);
                    Cell::Number(value, self.digits)
                }
            },
        }
    }
}

/// The rows at a path, each with the name of the field that matched a `*`.
fn rows<'v>(name: &'v str, value: &'v Value, path: &str) -> Vec<(&'v str, &'v Value)> {
    let (key, rest) = path.split_once('.').unwrap_or((path, ""));
    match value {
        Value::Array(all) if path.is_empty() => all.iter().map(|row| (name, row)).collect(),
        Value::Object(fields) if key == "*" => {
            let fields = fields.iter();
            fields.flat_map(|(name, of)| rows(name, of, rest)).collect()
        }
        _ => value
            .get(key)
            .map_or_else(Vec::new, |of| rows(name, of, rest)),
    }
}

/// Every figure of a document as a row: its path and its value.
pub fn figures(document: &Value) -> Table {
    let mut table = Table::new("Figures", &["name", "value"]);
    add_figures("", document, &mut table);
    table
}

fn add_figures(path: &str, value: &Value, table: &mut Table) {
    let below = |key: &str| match path {
        "" => key.to_owned(),
        path => format!("{path}.{key}"),
    };
    match value {
        Value::Object(fields) => {
            for (key, value) in fields {
                add_figures(&below(key), value, table);
            }
        }
        Value::Array(items) => {
            for (at, value) in items.iter().enumerate() {
                add_figures(&below(&at.to_string()), value, table);
            }
        }
        value => {
            let column = Column::new("value::6");
            let row = serde_json::json!({ "value": value });
            table
                .rows
                .push(vec![Cell::Text(path.to_owned()), column.cell("", &row)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn rows_columns_and_figures_of_a_document() {
        let document = json!({
            "parts": {
                "a": { "lines": [{ "n": 3, "of": { "x": 0.25 }, "is": true }, { "n": 0, "is": false }] },
                "b": { "lines": [{ "n": 1, "of": null, "is": "so" }] },
                "c": 7,
            }
        });
        let spec = TableSpec {
            title: "T",
            rows: "parts.*.lines",
            columns: "part=* !n half=n:0.5:1 x=of.x::2 is",
        };
        let csv = "part,n,half,x,is\r\na,3,1.5,0.25,yes\r\nb,1,0.5,,so\r\n";
        let table = spec.of(&document);
        assert_eq!(table.csv(), csv);
        assert_eq!(
            table.rows[0][2..4],
            [Cell::Number(1.5, 1), Cell::Number(0.25, 2)]
        );
        let all = figures(&document);
        assert_eq!(all.rows.len(), 9);
        assert_eq!(all.rows[1], ["parts.a.lines.0.n".into(), Cell::Count(3)]);
    }
}
