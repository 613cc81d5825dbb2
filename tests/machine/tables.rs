//! Tables that name source files: of the rules, in `SPEC.md`, and of the machine's counters.

use std::fs;
use std::path::Path;

use shiftvox::machine::COUNTERS;

fn read(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// The rows of the rules' table: the rule, and the cells of `src/machine`, `src/fast` and `src/rays`.
fn rules(spec: &str) -> Vec<(&str, [&str; 3])> {
    let rows = spec.lines().filter(|line| line.starts_with("| R"));
    rows.map(|row| {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let rule = cells[0].split(' ').next().expect("a name");
        (rule, [cells[1], cells[2], cells[3]])
    })
    .collect()
}

#[test]
fn each_file_names_the_rules_that_it_implements() {
    let spec = read("SPEC.md");
    let rules = rules(&spec);
    assert!(rules.len() > 9);
    for (rule, cells) in rules {
        for (engine, files) in ["machine", "fast", "rays"].into_iter().zip(cells) {
            for file in files.split('`').filter(|name| name.ends_with(".rs")) {
                let text = read(&format!("src/{engine}/{file}"));
                let mut words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '.');
                let is_named = words.any(|word| word.trim_end_matches('.') == rule);
                assert!(is_named, "src/{engine}/{file}: {rule}");
            }
        }
    }
}

#[test]
fn counters_are_counted_where_their_table_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/machine");
    let names = fs::read_dir(folder).expect("a folder").map(|entry| {
        let name = entry.expect("an entry").file_name();
        name.into_string().expect("a name in ASCII")
    });
    let files: Vec<String> = names.filter(|name| name.ends_with(".rs")).collect();
    for counter in COUNTERS {
        let counted = format!("counts.{} ", counter.name);
        let found = files.iter().filter(|file| {
            let text = read(&format!("src/machine/{file}"));
            text.contains(&format!("{counted}+= ")) || text.contains(&format!("{counted}= "))
        });
        let mut found: Vec<&str> = found.map(String::as_str).collect();
        let mut expected = counter.counted_in.to_vec();
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected, "{}", counter.name);
    }
}
