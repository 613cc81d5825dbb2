//! The forms of a list of statistics.

use hwmodel::statistics::{SCHEMA, Statistics, Value};

fn some() -> Statistics {
    let mut statistics = Statistics::new();
    statistics.add("machine.records", u64::MAX, "Count", "records, all of them");
    statistics.add(
        "machine.ops.w32.vertex pool",
        3u64,
        "Count",
        "adds \"in\" the pool",
    );
    statistics.add("machine.energy", 2.5, "pJ", "energy\nof everything");
    statistics.add("machine.rate", f64::NAN, "Ratio", "of nothing");
    statistics
}

#[test]
fn as_gem5_writes_them() {
    let text = some().to_stats_txt();
    let lines: Vec<String> = text
        .lines()
        .filter(|line| !line.is_empty())
        .map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect();
    assert_eq!(
        lines,
        [
            "---------- Begin Simulation Statistics ----------",
            "machine.records 18446744073709551615 # records, all of them (Count)",
            "machine.ops.w32.vertex_pool 3 # adds \"in\" the pool (Count)",
            "machine.energy 2.500000 # energy of everything (pJ)",
            "machine.rate nan # of nothing (Ratio)",
            "---------- End Simulation Statistics ----------",
        ]
    );
    // Columns stand under one another.
    let at: Vec<_> = text.lines().filter_map(|line| line.find(" # ")).collect();
    assert!(at[1..].iter().all(|&column| column == at[1]), "{at:?}");
}

#[test]
fn csv_is_quoted_where_it_must_be() {
    assert_eq!(
        some().to_csv(),
        "name,value,unit,description\n\
         machine.records,18446744073709551615,Count,\"records, all of them\"\n\
         machine.ops.w32.vertex_pool,3,Count,\"adds \"\"in\"\" the pool\"\n\
         machine.energy,2.5,pJ,\"energy\nof everything\"\n\
         machine.rate,,Ratio,of nothing\n"
    );
}

#[test]
fn json_there_and_back() {
    let mut statistics = Statistics::new();
    statistics.add("count", u64::MAX, "Count", "a count");
    statistics.add("measure", 3.0, "pJ", "a measure that is whole");
    let json = serde_json::to_string(&statistics).unwrap();
    assert!(
        json.starts_with(&format!("{{\"schema\":{SCHEMA},")),
        "{json}"
    );
    let back: Statistics = serde_json::from_str(&json).unwrap();
    assert_eq!(back, statistics);
    assert_eq!(back.get("measure").unwrap().value, Value::Measure(3.0));
    assert_eq!(back.get("count").unwrap().value, Value::Count(u64::MAX));
    assert_eq!(back.get("none"), None);
    assert_eq!(back.schema(), SCHEMA);
}
