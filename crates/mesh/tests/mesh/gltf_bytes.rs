//! Bytes of glTF documents: addresses, binary files, damage.
#![allow(
    unreachable_pub,
    reason = "a module of test crates, and of a fuzz target"
)]

use serde_json::{Value, json};

/// Number below `end`, which is 1 or more.
pub type Choose<'c> = dyn FnMut(u32) -> u32 + 'c;

/// Changes, removes or repeats something anywhere in a document.
pub fn damage(value: &mut Value, choose: &mut Choose<'_>) {
    let inner = match value {
        Value::Array(list) => list.len(),
        Value::Object(map) => map.len(),
        _ => 0,
    };
    if inner == 0 || choose(5) == 0 {
        *value = match (choose(8), &*value) {
            (0, Value::Number(n)) => json!(n.as_f64().unwrap_or(0.0) + 1.0),
            (1, _) => json!(u64::MAX),
            (2, _) => json!(-1),
            (3, _) => json!(1e308),
            (4, _) => json!(u32::MAX - choose(3)),
            (5, _) => json!({"count": 1, "indices": {"bufferView": 0}}),
            (6, _) => json!("data:;base64,AA=A"),
            _ => json!(choose(8)),
        };
        return;
    }
    let at = choose(inner as u32) as usize;
    match value {
        Value::Array(list) => match choose(8) {
            0 => drop(list.remove(at)),
            1 => list.push(list[at].clone()),
            _ => damage(&mut list[at], choose),
        },
        Value::Object(map) => {
            let key = map.keys().nth(at).cloned().unwrap_or_default();
            match choose(8) {
                0 => drop(map.remove(&key)),
                1 => drop(map.insert("sparse".into(), json!({"count": 1}))),
                _ => damage(&mut map[&key], choose),
            }
        }
        _ => {}
    }
}

/// Bytes as an address.
pub fn data_uri(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::from("data:application/octet-stream;base64,");
    for chunk in bytes.chunks(3) {
        let word = chunk
            .iter()
            .enumerate()
            .fold(0u32, |w, (i, b)| w | u32::from(*b) << (16 - 8 * i));
        for i in 0..4 {
            text.push(if i <= chunk.len() {
                char::from(DIGITS[(word >> (18 - 6 * i) & 63) as usize])
            } else {
                '='
            });
        }
    }
    text
}

/// A binary file of a document and its buffer.
pub fn glb(json: &str, buffer: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2u32.to_le_bytes());
    bytes.extend((12 + 8 + json.len() as u32 + 8 + buffer.len() as u32).to_le_bytes());
    for (kind, content) in [(b"JSON", &json[..]), (b"BIN\0", buffer)] {
        bytes.extend((content.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(content);
    }
    bytes
}
