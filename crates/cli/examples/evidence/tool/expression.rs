//! Figures from the JSON of commands: `(five - three) / 2e6`, `drawn.results[width=512].coverage.extra`.
//!
//! A path begins with the name of a run, or `row`; `.key` takes a field, of every element if it is an array;
//! `[key=value]` keeps the elements with that field; `[3]` takes one. `sum(path)` adds all values. A path must name one
//! value, so a filter that fits two is an error and not a wrong figure.

use serde_json::Value;

/// Where a name's document is found.
pub(crate) type Lookup<'a> = &'a dyn Fn(&str) -> Result<&'a Value, String>;

/// A figure or words.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Figure {
    /// A number.
    Number(f64),
    /// Words.
    Text(String),
    /// `null`: not measured, shown as `-`.
    None,
}

impl Figure {
    fn number(&self) -> Result<f64, String> {
        match self {
            Self::Number(number) => Ok(*number),
            other => Err(format!("{other:?} is no number")),
        }
    }
}

/// Evaluates an expression.
pub(crate) fn evaluate(text: &str, lookup: Lookup<'_>) -> Result<Figure, String> {
    let mut parser = Parser {
        rest: text.trim(),
        lookup,
    };
    let figure = parser.sum().map_err(|e| format!("in `{text}`: {e}"))?;
    if parser.rest.is_empty() {
        Ok(figure)
    } else {
        Err(format!("in `{text}`: what is `{}`?", parser.rest))
    }
}

/// The values of a path, those of an array one by one.
pub(crate) fn elements<'a>(path: &str, lookup: Lookup<'a>) -> Result<Vec<&'a Value>, String> {
    let mut parser = Parser { rest: path, lookup };
    let values = parser.path()?;
    if !parser.rest.is_empty() {
        return Err(format!("in `{path}`: what is `{}`?", parser.rest));
    }
    Ok(flatten(values))
}

/// Names that the paths of an expression begin with.
pub(crate) fn names(text: &str) -> Vec<String> {
    let mut depth = 0;
    let mut plain = String::new();
    for c in text.chars() {
        match c {
            '[' => depth += 1,
            ']' => depth -= 1,
            _ if depth == 0 => plain.push(c),
            _ => {}
        }
    }
    let mut found: Vec<String> = Vec::new();
    for path in plain.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == '.')) {
        let name = path.split('.').next().unwrap_or_default();
        let starts = name.starts_with(|c: char| c.is_ascii_alphabetic());
        if starts && name != "sum" && !found.iter().any(|known| known == name) {
            found.push(name.to_owned());
        }
    }
    found
}

struct Parser<'t, 'v> {
    rest: &'t str,
    lookup: Lookup<'v>,
}

impl<'v> Parser<'_, 'v> {
    fn take(&mut self, token: char) -> bool {
        self.rest = self.rest.trim_start();
        if let Some(rest) = self.rest.strip_prefix(token) {
            self.rest = rest.trim_start();
            return true;
        }
        false
    }

    fn sum(&mut self) -> Result<Figure, String> {
        let mut left = self.product()?;
        loop {
            if self.take('+') {
                left = Figure::Number(left.number()? + self.product()?.number()?);
            } else if self.take('-') {
                left = Figure::Number(left.number()? - self.product()?.number()?);
            } else {
                return Ok(left);
            }
        }
    }

    fn product(&mut self) -> Result<Figure, String> {
        let mut left = self.factor()?;
        loop {
            if self.take('*') {
                left = Figure::Number(left.number()? * self.factor()?.number()?);
            } else if self.take('/') {
                left = Figure::Number(left.number()? / self.factor()?.number()?);
            } else {
                return Ok(left);
            }
        }
    }

    fn factor(&mut self) -> Result<Figure, String> {
        if self.take('(') {
            let inner = self.sum()?;
            return if self.take(')') {
                Ok(inner)
            } else {
                Err("a ) is missing".to_owned())
            };
        }
        if self.rest.starts_with(|c: char| c.is_ascii_digit()) {
            let end = self
                .rest
                .find(|c: char| !(c.is_ascii_alphanumeric() || c == '.'))
                .unwrap_or(self.rest.len());
            let (number, rest) = self.rest.split_at(end);
            self.rest = rest.trim_start();
            let number = number.parse().map_err(|e| format!("{e}: `{number}`"))?;
            return Ok(Figure::Number(number));
        }
        if let Some(rest) = self.rest.strip_prefix("sum(") {
            self.rest = rest;
            let mut total = 0.0;
            for value in flatten(self.path()?) {
                total += figure(value)?.number()?;
            }
            return if self.take(')') {
                Ok(Figure::Number(total))
            } else {
                Err("a ) is missing".to_owned())
            };
        }
        match self.path()?.as_slice() {
            [one] => figure(one),
            several => Err(format!("{} values where one was expected", several.len())),
        }
    }

    fn word(&mut self) -> Result<String, String> {
        let end = self
            .rest
            .find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))
            .unwrap_or(self.rest.len());
        if end == 0 {
            return Err(format!("a name was expected at `{}`", self.rest));
        }
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        Ok(word.to_owned())
    }

    fn path(&mut self) -> Result<Vec<&'v Value>, String> {
        let name = self.word()?;
        let mut values = vec![(self.lookup)(&name)?];
        loop {
            if let Some(rest) = self.rest.strip_prefix('.') {
                self.rest = rest;
                let key = self.word()?;
                values = flatten(values)
                    .into_iter()
                    .map(|value| value.get(&key).ok_or(format!("there is no `{key}`")))
                    .collect::<Result<_, _>>()?;
            } else if let Some(rest) = self.rest.strip_prefix('[') {
                let end = rest.find(']').ok_or("a ] is missing")?;
                let (filter, after) = rest.split_at(end);
                self.rest = &after[1..];
                let all = flatten(values);
                values = match filter.split_once('=') {
                    Some((key, wanted)) => all
                        .into_iter()
                        .filter(|value| fits(value, key, wanted))
                        .collect(),
                    None => {
                        let index: usize =
                            filter.parse().map_err(|e| format!("[{filter}]: {e}"))?;
                        vec![*all.get(index).ok_or(format!("there is no [{index}]"))?]
                    }
                };
            } else {
                self.rest = self.rest.trim_start();
                return Ok(values);
            }
        }
    }
}

fn flatten(values: Vec<&Value>) -> Vec<&Value> {
    let mut all = Vec::new();
    for value in values {
        match value {
            Value::Array(elements) => all.extend(elements),
            other => all.push(other),
        }
    }
    all
}

fn fits(value: &Value, key: &str, wanted: &str) -> bool {
    let field = key.split('.').try_fold(value, |at, part| at.get(part));
    match field {
        Some(Value::String(text)) => text == wanted,
        Some(Value::Number(number)) => wanted.parse::<f64>().ok() == number.as_f64(),
        Some(Value::Bool(truth)) => wanted == truth.to_string(),
        Some(Value::Null) => wanted == "null",
        _ => false,
    }
}

fn figure(value: &Value) -> Result<Figure, String> {
    match value {
        Value::Null => Ok(Figure::None),
        Value::Bool(truth) => Ok(Figure::Text(if *truth { "yes" } else { "no" }.to_owned())),
        Value::Number(number) => Ok(Figure::Number(number.as_f64().unwrap_or(f64::NAN))),
        Value::String(text) => Ok(Figure::Text(text.clone())),
        other => Err(format!("{other} is no figure")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn paths_filters_and_sums() {
        let document = json!({
            "results": [
                { "scene": "gen:terrain,depth=9", "width": 512, "n": 3, "cells": [{ "t": 1 }, { "t": 4 }] },
                { "scene": "gen:terrain,depth=9", "width": 1024, "n": 8, "cells": [] },
            ],
            "none": null,
        });
        let lookup = |name: &str| {
            if name == "run" {
                Ok(&document)
            } else {
                Err(format!("no run `{name}`"))
            }
        };
        let number = |text: &str| evaluate(text, &lookup).and_then(|f| f.number());
        let first = "run.results[scene=gen:terrain,depth=9][width=512]";
        assert_eq!(number(&format!("{first}.n")), Ok(3.0));
        assert_eq!(
            number(&format!("(run.results[1].n - {first}.n) / 2 + 1e1")),
            Ok(12.5)
        );
        assert_eq!(number(&format!("sum({first}.cells.t) * 2")), Ok(10.0));
        assert_eq!(evaluate("run.none", &lookup), Ok(Figure::None));
        assert!(number("run.results.n").unwrap_err().contains("2 values"));
        assert!(
            number("run.results[width=7].n")
                .unwrap_err()
                .contains("0 values")
        );
        assert!(number("other.n").is_err());
        assert!(number("run.nothing").is_err());
        assert_eq!(
            elements("run.results[width=512]", &lookup).map(|e| e.len()),
            Ok(1)
        );
        assert_eq!(
            names("(big.a[x=y.z].b - small) / 2e6 + sum(row.c.d) * big.x"),
            ["big", "small", "row"]
        );
    }
}
