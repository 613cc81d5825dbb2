//! Results as rows and columns, for people and for programs.

use std::fmt::Write;

use serde::Serialize;

/// One entry.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A whole number.
    Count(u64),
    /// A number, and the digits after the point that people see.
    Number(f64, #[serde(skip)] usize),
    /// Empty.
    None,
}

impl Cell {
    /// A time in milliseconds: three significant digits or more.
    #[must_use]
    pub fn ms(time: f64) -> Self {
        let digits = match time {
            t if t < 1.0 => 3,
            t if t < 10.0 => 2,
            t if t < 100.0 => 1,
            _ => 0,
        };
        Self::Number(time, digits)
    }

    /// A ratio or an exponent.
    #[must_use]
    pub fn ratio(value: f64) -> Self {
        Self::Number(value, 3)
    }

    /// As people read it; digits of whole numbers in groups of three.
    #[must_use]
    pub fn for_people(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => grouped(*count),
            Self::Number(value, digits) => format!("{value:.digits$}"),
            Self::None => "-".to_owned(),
        }
    }

    /// As programs read it: all digits, nothing for nothing.
    fn for_programs(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Number(value, _) => value.to_string(),
            Self::None => String::new(),
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
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

/// A table. Every row is as long as `columns`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// What it shows.
    pub title: String,
    /// What the columns hold; in words that CSV readers take as names too.
    pub columns: Vec<&'static str>,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    #[must_use]
    pub fn new(title: impl Into<String>, columns: &[&'static str]) -> Self {
        Self {
            title: title.into(),
            columns: columns.to_vec(),
            rows: Vec::new(),
        }
    }

    /// A table without rows whose columns are named in a line, with blanks between them.
    #[must_use]
    pub fn of(title: impl Into<String>, columns: &'static str) -> Self {
        let columns: Vec<&'static str> = columns.split_whitespace().collect();
        Self::new(title, &columns)
    }

    /// Whether a column has an entry in words, which are set to the left.
    #[must_use]
    pub fn is_of_words(&self, column: usize) -> bool {
        let words = |row: &Vec<Cell>| matches!(row.get(column), Some(Cell::Text(_)));
        self.rows.iter().any(words)
    }

    /// The table without some columns.
    #[must_use]
    pub fn without(&self, names: &[&str]) -> Self {
        let kept: Vec<usize> = (0..self.columns.len())
            .filter(|&column| !names.contains(&self.columns[column]))
            .collect();
        let rows = self.rows.iter();
        Self {
            title: self.title.clone(),
            columns: kept.iter().map(|&column| self.columns[column]).collect(),
            rows: rows
                .map(|row| kept.iter().map(|&column| row[column].clone()).collect())
                .collect(),
        }
    }

    /// The table in CSV (RFC 4180): a line of names, then the rows.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = self.columns.join(",") + "\r\n";
        for row in &self.rows {
            let fields: Vec<String> = row.iter().map(|c| quoted(&c.for_programs())).collect();
            text += &fields.join(",");
            text += "\r\n";
        }
        text
    }

    /// The table in Markdown under its title.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = format!("**{}**\n\n| {} |\n|", self.title, self.columns.join(" | "));
        for column in 0..self.columns.len() {
            text += if self.is_of_words(column) {
                "---|"
            } else {
                "--:|"
            };
        }
        text.push('\n');
        for row in &self.rows {
            let cells = row.iter().map(|cell| cell.for_people().replace('|', "\\|"));
            // Writing to a string does not fail.
            let _ = writeln!(text, "| {} |", cells.collect::<Vec<_>>().join(" | "));
        }
        text
    }
}

/// A CSV field, in quotes where it must be.
fn quoted(field: &str) -> String {
    if field.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

/// A number with its digits in groups of three.
#[must_use]
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

    fn table() -> Table {
        let mut table = Table::new("Two scenes", &["scene", "ms", "records"]);
        let row = |scene: &str, ms, records: Option<u64>| {
            vec![Cell::from(scene), Cell::ms(ms), Cell::from(records)]
        };
        table
            .rows
            .push(row("gen:menger,depth=2", 12.345, Some(1_234_567)));
        table.rows.push(row("a \"b\" | c", 0.5, None));
        table
    }

    #[test]
    fn groups_of_digits() {
        for (number, text) in [
            (0u64, "0"),
            (999, "999"),
            (1000, "1,000"),
            (1_234_567, "1,234,567"),
        ] {
            assert_eq!(grouped(number), text);
        }
    }

    #[test]
    fn csv_keeps_digits_and_quotes() {
        let expected = "scene,ms,records\r\n\
                        \"gen:menger,depth=2\",12.345,1234567\r\n\
                        \"a \"\"b\"\" | c\",0.5,\r\n";
        assert_eq!(table().csv(), expected);
    }

    #[test]
    fn columns_can_be_left_out() {
        let less = table().without(&["ms", "nothing"]);
        assert_eq!(less.columns, ["scene", "records"]);
        assert_eq!(less.rows[1], [Cell::from("a \"b\" | c"), Cell::None]);
    }

    #[test]
    fn markdown_is_for_people() {
        let expected = "**Two scenes**\n\n| scene | ms | records |\n|---|--:|--:|\n\
                        | gen:menger,depth=2 | 12.3 | 1,234,567 |\n\
                        | a \"b\" \\| c | 0.500 | - |\n";
        assert_eq!(table().markdown(), expected);
    }
}
