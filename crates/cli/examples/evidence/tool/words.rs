//! What a page may not say: that it is out of date, and figures that no command makes.

use super::grid::{cells, is_rule};
use super::registry::{Allow, Allowed};

/// Words by which a page calls its own figures old or bad.
const STALE: &[&str] = &[
    "are from before",
    "is from before",
    "an earlier version",
    "version before this",
    "build before this",
    "builds before this",
    "out of date",
    "outdated",
    "stale",
    "not remade",
    "not rerun",
    "to be rerun",
    "to be remade",
    "came later",
    "taken under load",
    "under a load of",
    "a busy machine",
    "shared with other",
    "other builds",
    "other work ran",
    "measured before",
    "single runs and rough",
];

/// What a page says that it may not.
pub(crate) fn faults(
    page: &str,
    text: &str,
    blocks: &[std::ops::Range<usize>],
    allow: &Allow,
) -> Vec<String> {
    let mut found = Vec::new();
    for (line, phrase, around) in stale(text) {
        if !is_allowed(&allow.phrase, page, &around) {
            found.push(format!(
                "{page}:{line}: `{phrase}`: a page may not call itself out of date"
            ));
        }
    }
    for (line, head) in tables(text, blocks) {
        if !is_allowed(&allow.table, page, &head) {
            found.push(format!(
                "{page}:{line}: a table of figures that no command makes: `{head}`; give it a block, or a reason in \
                 docs/evidence/allow.toml"
            ));
        }
    }
    found
}

/// Exceptions that no page needs.
pub(crate) fn unused(allow: &Allow, pages: &[(String, String)]) -> Vec<String> {
    let lists = [&allow.table, &allow.plot, &allow.phrase];
    lists
        .into_iter()
        .flatten()
        .filter(|entry| {
            if entry.reason.is_empty() {
                return true;
            }
            let wanted = squeeze(&entry.text);
            !pages
                .iter()
                .any(|(page, text)| *page == entry.page && squeeze(text).contains(&wanted))
        })
        .map(|entry| {
            format!(
                "allow.toml: {} has no `{}` any more",
                entry.page, entry.text
            )
        })
        .collect()
}

fn is_allowed(list: &[Allowed], page: &str, text: &str) -> bool {
    list.iter()
        .any(|entry| entry.page == page && text.contains(&squeeze(&entry.text)))
}

fn squeeze(text: &str) -> String {
    text.split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
        .to_lowercase()
}

/// Line, phrase, and the words around it.
fn stale(text: &str) -> Vec<(usize, &'static str, String)> {
    let mut found = Vec::new();
    // Phrases may be broken by an end of line.
    let mut all = String::new();
    let mut starts = Vec::new();
    for line in text.lines() {
        starts.push(all.len());
        all += &squeeze(line);
        all.push(' ');
    }
    for phrase in STALE {
        for (at, _) in all.match_indices(phrase) {
            let line = starts.partition_point(|start| *start <= at);
            let before = all[..at].char_indices().rev().nth(60).map_or(0, |(i, _)| i);
            let after = all[at..]
                .char_indices()
                .nth(80)
                .map_or(all.len(), |(i, _)| at + i);
            found.push((line, *phrase, all[before..after].to_owned()));
        }
    }
    found.sort();
    found
}

/// Line and head of tables with mostly figures, outside blocks.
fn tables(text: &str, blocks: &[std::ops::Range<usize>]) -> Vec<(usize, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (number, line) in lines.iter().enumerate() {
        let outside = !blocks.iter().any(|block| block.contains(&number));
        if outside && number > 0 && line.starts_with('|') && is_rule(line) {
            let body = lines[number + 1..]
                .iter()
                .take_while(|line| line.starts_with('|'));
            let (mut figures, mut filled) = (0, 0);
            for cell in body.flat_map(|line| cells(line).skip(1)) {
                filled += usize::from(!cell.is_empty());
                figures += usize::from(is_figure(cell));
            }
            if figures * 2 >= filled && figures > 1 {
                found.push((number, squeeze(lines[number - 1])));
            }
        }
    }
    found
}

fn is_figure(cell: &str) -> bool {
    let cell = cell.trim_start_matches(['*', '+', '-', '<', '~', '≈', ' ']);
    cell.starts_with(|c: char| c.is_ascii_digit())
}

/// Plots that a page shows, as it writes their paths.
pub(crate) fn plots(text: &str) -> Vec<String> {
    text.split("](")
        .skip(1)
        .filter_map(|rest| rest.split_once(')'))
        .map(|(path, _)| path.to_owned())
        .filter(|path| path.ends_with(".svg") && !path.contains("://"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_may_not_be_said() {
        let allow = Allow::default();
        let page = "# A\n\nThese are from\nbefore.\n\n| a | b |\n|---|--:|\n| x | 1 |\n| y | 2 |\n";
        let found = faults("a.md", page, &[], &allow);
        assert_eq!(found.len(), 2, "{found:?}");
        assert!(
            found[0].starts_with("a.md:3: `are from before`"),
            "{found:?}"
        );
        assert!(found[1].starts_with("a.md:6: a table"), "{found:?}");
        // In a block, words still count.
        assert_eq!(faults("a.md", page, &[5..9, 20..21], &allow).len(), 1);
        let words =
            "| flag | meaning |\n|---|---|\n| a | 1 is a number |\n| b | none |\n| c | none |\n";
        assert_eq!(faults("a.md", words, &[], &allow), [""; 0]);
    }

    #[test]
    fn plots_of_a_page() {
        assert_eq!(
            plots("a ![x](p/a.svg) [y](b.md) [z](https://c/d.svg)"),
            ["p/a.svg"]
        );
    }
}
