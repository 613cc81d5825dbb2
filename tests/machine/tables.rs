//! The table of rules in `SPEC.md` names source files, which name their rules.

use std::fs;
use std::path::Path;

fn read(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{file}: {error}"))
}

#[test]
fn each_file_names_the_rules_that_it_implements() {
    let spec = read("SPEC.md");
    let rows: Vec<&str> = spec.lines().filter(|row| row.starts_with("| R")).collect();
    assert!(rows.len() > 9);
    for row in rows {
        let mut cells = row.trim_matches('|').split('|').map(str::trim);
        let rule = cells.next().and_then(|cell| cell.split(' ').next());
        for (engine, files) in ["machine", "fast", "rays"].into_iter().zip(cells) {
            for file in files.split('`').filter(|name| name.ends_with(".rs")) {
                let text = read(&format!("src/{engine}/{file}"));
                let mut words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '.');
                let is_named = words.any(|word| Some(word.trim_end_matches('.')) == rule);
                assert!(is_named, "src/{engine}/{file}: {rule:?}");
            }
        }
    }
}
