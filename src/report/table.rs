//! Results as rows and columns, for people and for programs.

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
    /// What the columns hold.
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
    fn columns_can_be_left_out() {
        let less = table().without(&["ms", "nothing"]);
        assert_eq!(less.columns, ["scene", "records"]);
        assert_eq!(less.rows[1], [Cell::from("a \"b\" | c"), Cell::None]);
    }
}
