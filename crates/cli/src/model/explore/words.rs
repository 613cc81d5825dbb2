//! A point in words.

use serde_json::Value;

use shiftvox_lab::model::explore::front::FrontPoint;
use shiftvox_lab::model::explore::lines::PointLine;

/// What a point gives up, in words.
pub(super) fn given_up(point: &FrontPoint) -> String {
    let exchanges = point.gives_up.iter().map(ToString::to_string);
    exchanges.collect::<Vec<_>>().join("; ")
}

/// What a point is made of, as far as points differ in it.
pub(super) fn values(line: &PointLine, points: &[PointLine]) -> String {
    let varies = |key: &str, value: &Value| {
        let mut others = points.iter().map(|other| other.values.get(key));
        others.any(|other| other != Some(value))
    };
    let hardware = line.values.get("hardware").and_then(Value::as_str);
    let mut words = vec![hardware.unwrap_or_default().to_owned()];
    for (key, value) in &line.values {
        if key != "hardware" && varies(key, value) {
            let value = value
                .as_str()
                .map_or_else(|| value.to_string(), str::to_owned);
            words.push(format!("{key} {value}"));
        }
    }
    words.join(", ")
}
