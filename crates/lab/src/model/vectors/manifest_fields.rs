//! The fields of a row as the manifest lists them.

use hwmodel::Format;
use serde_json::{Value, json};

use super::ports::{Field, Ports};

/// A file of rows: its name, widths, fields. `more`: what else is known of a field, by its place.
pub(super) fn fields(
    format: Format,
    ports: &Ports,
    file: Option<String>,
    more: &dyn Fn((usize, &Field)) -> Value,
) -> Value {
    let all: Vec<Value> = ports
        .placed(format)
        .enumerate()
        .map(|(at, (field, lowest))| {
            let mut entry = json!({
                "name": field.name,
                "bits": field.kind.bits(format),
                "signed": field.kind.is_signed(),
                "lowest_bit": lowest,
                "meaning": field.meaning,
            });
            if let (Value::Object(to), Value::Object(more)) = (&mut entry, more((at, field))) {
                to.extend(more);
            }
            entry
        })
        .collect();
    json!({
        "file": file,
        "bits": ports.bits(format),
        "digits": ports.digits(format),
        "fields": all,
    })
}
