//! Results as named cells in rows, written as text, CSV and JSON.

use std::fmt::Write;

use serde_json::Value;

#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    Text(String),
    Count(u64),
    /// A number, and how many digits after the point people see.
    Number(f64, usize),
    None,
}

impl Cell {
    /// A time in milliseconds with three significant digits.
    pub(crate) fn ms(time: f64) -> Self {
        let digits = match time {
            t if t < 1.0 => 3,
            t if t < 10.0 => 2,
            t if t < 100.0 => 1,
            _ => 0,
        };
        Self::Number(time, digits)
    }

    pub(crate) fn ratio(value: f64) -> Self {
        Self::Number(value, 3)
    }

    pub(crate) fn number(&self) -> Option<f64> {
        match self {
            Self::Count(count) => Some(*count as f64),
            Self::Number(value, _) => Some(*value),
            Self::Text(_) | Self::None => None,
        }
    }

    pub(super) fn for_people(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => grouped(*count),
            Self::Number(value, digits) => format!("{value:.digits$}"),
            Self::None => "-".to_owned(),
        }
    }

    fn for_programs(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Number(value, _) => value.to_string(),
            Self::None => String::new(),
        }
    }

    fn json(&self) -> Value {
        match self {
            Self::Text(text) => text.as_str().into(),
            Self::Count(count) => (*count).into(),
            // JSON has no infinity.
            Self::Number(value, _) if value.is_infinite() => value.to_string().into(),
            Self::Number(value, _) => (*value).into(),
            Self::None => Value::Null,
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::None, Into::into)
    }
}

/// One measurement: cells by the names of their columns, most important first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Row(Vec<(&'static str, Cell)>);

impl Row {
    pub fn put(&mut self, name: &'static str, cell: impl Into<Cell>) {
        let cell = cell.into();
        match self.0.iter_mut().find(|(found, _)| *found == name) {
            Some((_, old)) => *old = cell,
            None => self.0.push((name, cell)),
        }
    }

    pub fn get(&self, name: &str) -> &Cell {
        let found = self.0.iter().find(|(found, _)| *found == name);
        found.map_or(&Cell::None, |(_, cell)| cell)
    }

    pub fn number(&self, name: &str) -> f64 {
        self.get(name).number().unwrap_or(f64::NAN)
    }

    /// A cell as text; empty if it was never set.
    pub fn text(&self, name: &str) -> String {
        match self.get(name) {
            Cell::None => String::new(),
            cell => cell.for_people(),
        }
    }

    pub fn json(&self) -> Value {
        let set = self.0.iter().filter(|(_, cell)| *cell != Cell::None);
        set.map(|(name, cell)| ((*name).to_owned(), cell.json()))
            .collect()
    }
}

/// A table. Every row is as long as `columns`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    pub title: String,
    pub columns: Vec<&'static str>,
    pub rows: Vec<Vec<Cell>>,
}

const TEXT_WIDTH: usize = 100;
const CELL_WIDTH: usize = 40;
const MOST_KEY_WIDTH: usize = 60;

impl Table {
    pub fn new(title: impl Into<String>, columns: &[&'static str]) -> Self {
        Self {
            title: title.into(),
            columns: columns.to_vec(),
            rows: Vec::new(),
        }
    }

    pub fn collect(title: impl Into<String>, rows: &[Row]) -> Self {
        let mut columns: Vec<&'static str> = Vec::new();
        for (name, _) in rows.iter().flat_map(|row| &row.0) {
            if !columns.contains(name) {
                columns.push(name);
            }
        }
        Self::of_columns(title, rows, &columns)
    }

    /// A table of some columns of measurements, named with blanks between them.
    pub(crate) fn select(title: &str, rows: &[Row], columns: &'static str) -> Self {
        let columns: Vec<&'static str> = columns.split_whitespace().collect();
        Self::of_columns(title, rows, &columns)
    }

    fn of_columns(title: impl Into<String>, rows: &[Row], columns: &[&'static str]) -> Self {
        let cells = |row: &Row| columns.iter().map(|name| row.get(name).clone()).collect();
        Self {
            rows: rows.iter().map(cells).collect(),
            ..Self::new(title, columns)
        }
    }

    /// Whether a column has an entry in words, which are set to the left.
    fn is_of_words(&self, column: usize) -> bool {
        let words = |row: &Vec<Cell>| matches!(row.get(column), Some(Cell::Text(_)));
        self.rows.iter().any(words)
    }

    /// The table without columns that are empty or the same in every row. Their values are in the
    /// title.
    pub(crate) fn condensed(mut self) -> Self {
        let is_constant = |column: usize| {
            let mut rows = self.rows.iter().map(|row| &row[column]);
            let first = rows.next();
            self.rows.len() > 1 && rows.all(|cell| Some(cell) == first)
        };
        let constants: Vec<bool> = (0..self.columns.len()).map(is_constant).collect();
        let mut told = Vec::new();
        for (column, _) in constants.iter().enumerate().filter(|(_, is)| **is) {
            let (name, cell) = (self.columns[column], &self.rows[0][column]);
            if *cell != Cell::None {
                told.push(format!("{} {}", name.replace('_', " "), cell.for_people()));
            }
        }
        if !told.is_empty() {
            self.title = format!("{}: {}", self.title, told.join(", "));
        }
        let mut is_constant = constants.iter();
        self.columns.retain(|_| is_constant.next() == Some(&false));
        for row in &mut self.rows {
            let mut is_constant = constants.iter();
            row.retain(|_| is_constant.next() == Some(&false));
        }
        self
    }

    /// The table as text, by [`in_lines`].
    pub fn text(&self) -> String {
        let column = |(column, name): (usize, &&'static str)| {
            let cells = self.rows.iter().map(|row| row[column].for_people());
            TextColumn::new(self.is_of_words(column), name, cells)
        };
        let columns: Vec<TextColumn> = self.columns.iter().enumerate().map(column).collect();
        in_lines(&self.title, &columns)
    }

    pub fn csv(&self) -> String {
        let mut text = self.columns.join(",") + "\r\n";
        for row in &self.rows {
            let fields: Vec<String> = row.iter().map(|c| quoted(&c.for_programs())).collect();
            text += &fields.join(",");
            text += "\r\n";
        }
        text
    }
}

/// A column of text for [`in_lines`].
pub struct TextColumn {
    is_of_words: bool,
    width: usize,
    /// The name and the cells, each in lines.
    cells: Vec<Vec<String>>,
}

impl TextColumn {
    /// The name is broken at each `_`.
    pub fn new(is_of_words: bool, name: &str, cells: impl Iterator<Item = String>) -> Self {
        let head = name.split('_').map(str::to_owned).collect();
        let cells = cells.map(|cell| wrapped(&cell, CELL_WIDTH));
        let cells: Vec<Vec<String>> = std::iter::once(head).chain(cells).collect();
        let widths = cells.iter().flatten().map(|line| line.chars().count());
        Self {
            is_of_words,
            width: widths.max().unwrap_or(0),
            cells,
        }
    }
}

/// A title and columns in lines of at most 100 letters: words to the left, numbers to the right. Columns without room go
/// to a second block, which begins with the first columns of words again.
pub fn in_lines(title: &str, columns: &[TextColumn]) -> String {
    let width = |block: &[&TextColumn]| block.iter().map(|of| of.width + 2).sum::<usize>();
    let mut keys: Vec<&TextColumn> = columns.iter().take(1).collect();
    let further = columns.iter().skip(1);
    for key in further.take_while(|column| column.is_of_words) {
        if width(&keys) + key.width < MOST_KEY_WIDTH {
            keys.push(key);
        }
    }
    let mut text = wrapped(title, TEXT_WIDTH).join("\n");
    let mut block: Vec<&TextColumn> = Vec::new();
    for column in columns {
        if width(&block) + column.width > TEXT_WIDTH && block.len() > keys.len() {
            text += &(of_block(&block) + "\n");
            block.clone_from(&keys);
        }
        block.push(column);
    }
    text + &of_block(&block)
}
fn of_block(block: &[&TextColumn]) -> String {
    let mut text = String::from("\n");
    for row in 0..block.first().map_or(0, |column| column.cells.len()) {
        let lines = block.iter().map(|column| column.cells[row].len()).max();
        let lines = lines.unwrap_or(0);
        for at in 0..lines {
            let mut line = String::new();
            for column in block {
                let (cell, width) = (&column.cells[row], column.width);
                // Heads stand on the table, cells hang from their line.
                let at = match row {
                    0 => (at + cell.len()).checked_sub(lines),
                    _ => Some(at),
                };
                let cell = at.and_then(|at| cell.get(at)).map_or("", String::as_str);
                // Writing to a string does not fail.
                let _ = match column.is_of_words {
                    true => write!(line, "{cell:<width$}  "),
                    false => write!(line, "{cell:>width$}  "),
                };
            }
            text = text + "\n" + line.trim_end();
        }
    }
    text
}

/// A text in lines of at most so many letters, broken at blanks; longer words stay whole.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.len() - 1;
        let letters = lines[line].chars().count() + 1 + word.chars().count();
        if lines[line].is_empty() {
            lines[line] += word;
        } else if letters <= width {
            lines[line] = format!("{} {word}", lines[line]);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}

fn quoted(field: &str) -> String {
    if field.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

pub fn grouped(number: impl Into<u128>) -> String {
    let digits = number.into().to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(scene: &str, ms: f64, records: Option<u64>) -> Row {
        let mut row = Row::default();
        row.put("scene", scene);
        row.put("frame_ms", Cell::ms(ms));
        row.put("size", 64u64);
        if records.is_some() {
            row.put("records", records);
        }
        row
    }

    #[test]
    fn rows_in_every_form() {
        let rows = [
            row("gen:menger,depth=2", 12.345, Some(1_234_567)),
            row("a \"b\" | c", 0.5, None),
        ];
        let table = Table::collect("Two", &rows);
        assert_eq!(
            table.csv(),
            "scene,frame_ms,size,records\r\n\"gen:menger,depth=2\",12.345,64,1234567\r\n\
             \"a \"\"b\"\" | c\",0.5,64,\r\n"
        );
        assert_eq!(
            table.condensed().text(),
            "Two: size 64\n\n\
             \x20                   frame\n\
             scene                  ms    records\n\
             gen:menger,depth=2   12.3  1,234,567\n\
             a \"b\" | c           0.500          -"
        );
        let json = r#"{"frame_ms":0.5,"scene":"a \"b\" | c","size":64}"#;
        assert_eq!(rows[1].json().to_string(), json);
        assert_eq!(Cell::Number(f64::INFINITY, 1).json(), "inf");
        let texts = [0u64, 999, 1000, 1_234_567].map(grouped);
        assert_eq!(texts, ["0", "999", "1,000", "1,234,567"]);
    }

    #[test]
    fn wide_tables_fit_a_terminal() {
        let long = || Cell::from("letters ".repeat(5));
        let text = |name: &'static str, cells: [Cell; 4]| {
            let table = Table {
                rows: vec![cells.to_vec()],
                ..Table::new("word ".repeat(40), &[name, "b", "c", "d"])
            };
            table.text()
        };
        let wide = text("a_first", [long(), long(), long(), long()]);
        assert!(wide.lines().all(|line| line.len() <= TEXT_WIDTH), "{wide}");
        assert_eq!(wide.matches("first").count(), 3, "{wide}");
        let keyed = text("key", ["k".into(), long(), Cell::None, long()]);
        assert_eq!(keyed.matches("key").count(), 1, "{keyed}");
    }
}
