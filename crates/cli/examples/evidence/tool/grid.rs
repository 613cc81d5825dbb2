//! A block's table: what it should say, and what the page says.

use std::collections::BTreeSet;

use serde_json::Value;

use super::expression::{elements, evaluate, names};
use super::format::show;
use super::registry::{Block, Column, Cost, Kind, Page, Row, Vars, substitute};
use super::runs::{Concrete, Runs};

/// Which figures are computed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Select {
    /// Blocks and rows that take long, too.
    pub(crate) long: bool,
    /// Times and instructions, too.
    pub(crate) times: bool,
}

impl Select {
    fn kind(self, kind: Kind) -> bool {
        match kind {
            Kind::Exact => true,
            Kind::Time => self.times,
            Kind::Instructions => self.times && super::has_valgrind(),
        }
    }

    /// Whether a block or row of this cost is computed.
    pub(crate) fn cost(self, cost: Cost) -> bool {
        self.long || cost == Cost::Quick
    }
}

/// A table; a cell that was not computed is `None`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grid {
    /// The first is the head.
    pub(crate) rows: Vec<Vec<Option<String>>>,
    /// Whether the first column is words.
    words: Vec<bool>,
    /// Whether the number of rows is known.
    complete: bool,
}

fn row_vars(page: &Page, row: &Row) -> Vars {
    row.vars(&page.vars)
}

/// The runs that a block's selected figures need.
pub(crate) fn needed(
    page: &Page,
    block: &Block,
    select: Select,
) -> Result<BTreeSet<Concrete>, String> {
    let mut found = BTreeSet::new();
    let mut add = |names: Vec<String>, vars: &Vars| -> Result<(), String> {
        for name in names.iter().filter(|name| *name != "row") {
            let run = block
                .runs
                .get(name)
                .ok_or(format!("{}: there is no run `{name}`", block.name))?;
            found.insert(Concrete::new(run, vars, &page.prepare));
        }
        Ok(())
    };
    for row in &block.rows {
        if !select.cost(row.cost.unwrap_or(block.cost)) {
            continue;
        }
        let vars = row_vars(page, row);
        if let Some(each) = &row.each {
            add(names(&substitute(each, &vars)), &vars)?;
        }
        for column in block.columns.iter().filter(|c| select.kind(c.kind)) {
            for value in column.value.iter().flat_map(|v| v.list()) {
                add(names(&substitute(value, &vars)), &vars)?;
            }
        }
    }
    for picture in &block.pictures {
        if select.cost(block.cost) && select.kind(picture.kind) {
            add(vec![picture.run.clone()], &page.vars)?;
        }
    }
    Ok(found)
}

impl Grid {
    /// Computes a block's table from runs.
    pub(crate) fn build(
        page: &Page,
        block: &Block,
        runs: &Runs,
        select: Select,
    ) -> Result<Self, String> {
        let told = |e: String| format!("{}: {e}", block.name);
        let mut grid = Self {
            rows: vec![block.columns.iter().map(|c| Some(c.head.clone())).collect()],
            words: block.columns.iter().map(|c| c.text.is_some()).collect(),
            complete: true,
        };
        for row in &block.rows {
            let vars = row_vars(page, row);
            let chosen = select.cost(row.cost.unwrap_or(block.cost));
            let lookup = |name: &str| match block.runs.get(name) {
                Some(run) => runs.value(&Concrete::new(run, &vars, &page.prepare)),
                None => Err(format!("there is no run `{name}`")),
            };
            let found: Vec<Option<&Value>> = match &row.each {
                None => vec![None],
                Some(_) if !chosen => {
                    grid.complete = false;
                    continue;
                }
                Some(each) => elements(&substitute(each, &vars), &lookup)
                    .map_err(told)?
                    .into_iter()
                    .map(Some)
                    .collect(),
            };
            for element in found {
                let with_row = |name: &str| match (name, element) {
                    ("row", Some(element)) => Ok(element),
                    _ => lookup(name),
                };
                let mut vars = vars.clone();
                // Scalars of the element, for filters of other runs.
                for (key, value) in element.and_then(Value::as_object).into_iter().flatten() {
                    if let Some(text) = value.as_str() {
                        vars.insert(format!("row.{key}"), text.to_owned());
                    } else if value.is_number() || value.is_null() {
                        vars.insert(format!("row.{key}"), value.to_string());
                    }
                }
                let cells: Result<Vec<_>, String> = block
                    .columns
                    .iter()
                    .map(|column| {
                        cell(column, &vars, &with_row, chosen && select.kind(column.kind))
                    })
                    .collect();
                grid.rows.push(cells.map_err(told)?);
            }
        }
        if block.transpose {
            grid = grid.transposed();
        }
        Ok(grid)
    }

    fn transposed(self) -> Self {
        let columns = self.rows[0].len();
        let rows = (0..columns)
            .map(|c| self.rows.iter().map(|row| row[c].clone()).collect())
            .collect();
        Self {
            words: (0..self.rows.len()).map(|c| c == 0).collect(),
            rows,
            complete: self.complete,
        }
    }

    /// The table that a part of a page has.
    pub(crate) fn parse(lines: &[&str]) -> Self {
        let rows: Vec<Vec<Option<String>>> = lines
            .iter()
            .filter(|line| line.starts_with('|') && !is_rule(line))
            .map(|line| cells(line).map(|cell| Some(cell.to_owned())).collect())
            .collect();
        Self {
            rows,
            words: Vec::new(),
            complete: true,
        }
    }

    /// Takes from the page what was not computed, where the shape is the same.
    pub(crate) fn keep(&mut self, page: &Self) {
        let same = self.rows.len() == page.rows.len()
            && self.rows.first().map(Vec::len) == page.rows.first().map(Vec::len);
        for (r, row) in self.rows.iter_mut().enumerate() {
            for (c, cell) in row.iter_mut().enumerate() {
                if cell.is_none() {
                    let old = if same { page.rows[r].get(c) } else { None };
                    *cell = Some(old.cloned().flatten().unwrap_or_else(|| "-".to_owned()));
                }
            }
        }
    }

    /// What the page says otherwise.
    pub(crate) fn differences(&self, page: &Self) -> Vec<String> {
        let mut found = Vec::new();
        if self.rows.first().map(Vec::len) == Some(0) {
            return found;
        }
        if self.complete && self.rows.len() != page.rows.len() {
            found.push(format!(
                "{} rows, the page has {}",
                self.rows.len() - 1,
                page.rows.len().saturating_sub(1)
            ));
            return found;
        }
        let rows = if self.complete { self.rows.len() } else { 1 };
        for (computed, shown) in self.rows.iter().zip(&page.rows).take(rows) {
            if computed.len() != shown.len() {
                found.push(format!(
                    "{} columns, the page has {}",
                    computed.len(),
                    shown.len()
                ));
                continue;
            }
            for (c, (new, old)) in computed.iter().zip(shown).enumerate() {
                if let (Some(new), Some(old)) = (new, old)
                    && escape(new) != *old
                {
                    let head = page.rows[0][c].as_deref().unwrap_or_default();
                    let row: Vec<&str> = shown
                        .iter()
                        .take(3)
                        .filter_map(|cell| cell.as_deref())
                        .collect();
                    found.push(format!(
                        "row `{}`, column `{head}`: the page says {old}, the command {new}",
                        row.join(" | ")
                    ));
                }
            }
        }
        found
    }

    /// As Markdown.
    pub(crate) fn markdown(&self) -> String {
        let mut text = String::new();
        for (index, row) in self.rows.iter().enumerate() {
            text.push('|');
            for cell in row {
                text += &format!(" {} |", escape(cell.as_deref().unwrap_or("-")));
            }
            text.push('\n');
            if index == 0 {
                text.push('|');
                for (column, words) in self.words.iter().enumerate() {
                    let named = |row: &Vec<Option<String>>| {
                        let first = row[column].as_deref().and_then(|cell| cell.chars().next());
                        first.is_some_and(|c| c.is_alphabetic() || c == '`')
                    };
                    let words = *words || self.rows.iter().skip(1).any(named);
                    text += if words { "---|" } else { "--:|" };
                }
                text.push('\n');
            }
        }
        text
    }
}

fn cell<'a>(
    column: &Column,
    vars: &Vars,
    lookup: &'a dyn Fn(&str) -> Result<&'a Value, String>,
    wanted: bool,
) -> Result<Option<String>, String> {
    if let Some(text) = &column.text {
        return Ok(Some(substitute(text, vars)));
    }
    if !wanted {
        return Ok(None);
    }
    let values = column.value.as_ref().ok_or(format!(
        "column `{}` has neither text nor value",
        column.head
    ))?;
    let figures: Result<Vec<_>, String> = values
        .list()
        .iter()
        .map(|value| evaluate(&substitute(value, vars), lookup))
        .collect();
    show(&figures?, &column.show).map(Some)
}

fn escape(cell: &str) -> String {
    cell.replace('|', "\\|")
}

/// The cells of a line of a table.
pub(crate) fn cells(line: &str) -> impl Iterator<Item = &str> {
    let inner = line.trim().trim_start_matches('|');
    let inner = inner.strip_suffix('|').unwrap_or(inner);
    // No cell of ours has a bar of its own but `\|`.
    inner.split('|').map(str::trim)
}

/// Whether a line is what divides a table's head from its rows.
pub(crate) fn is_rule(line: &str) -> bool {
    line.contains("--") && line.chars().all(|c| matches!(c, '|' | '-' | ':' | ' '))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_that_differs_is_found() {
        let page = [
            "| a | b |",
            "|---|--:|",
            "| x | 1,000 |",
            "| y | - |",
            "",
            "<sub>foot</sub>",
        ];
        let page = Grid::parse(&page);
        let row = |cells: [Option<&str>; 2]| cells.map(|c| c.map(str::to_owned)).to_vec();
        let mut computed = Grid {
            rows: vec![
                row([Some("a"), Some("b")]),
                row([Some("x"), Some("1,000")]),
                row([Some("y"), None]),
            ],
            words: vec![true, false],
            complete: true,
        };
        assert_eq!(computed.differences(&page), [""; 0]);
        computed.rows[1][1] = Some("1,001".to_owned());
        let found = computed.differences(&page);
        assert_eq!(found.len(), 1);
        assert!(
            found[0].contains("the page says 1,000, the command 1,001"),
            "{found:?}"
        );
        // What was not computed stays as the page has it.
        computed.keep(&page);
        assert_eq!(
            computed.markdown(),
            "| a | b |\n|---|--:|\n| x | 1,001 |\n| y | - |\n"
        );
        computed.rows.pop();
        assert_eq!(computed.differences(&page), ["1 rows, the page has 2"]);
        let turned = computed.transposed();
        assert_eq!(turned.markdown(), "| a | x |\n|---|--:|\n| b | 1,001 |\n");
    }
}
