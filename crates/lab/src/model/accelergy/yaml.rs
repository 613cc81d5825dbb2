//! A YAML file as a JSON value: one document of maps, lists, texts and numbers, without aliases.

use saphyr_parser::{Event, Parser, ScalarStyle, ScanError, Span};
use serde_json::{Number, Value};

/// Levels of maps and lists, and three more: the file, its document and a text. A table of Accelergy has seven.
const MOST_LEVELS: u32 = 20;

pub(super) fn document(text: &str) -> Result<Value, String> {
    let mut events = Parser::new_from_str(text);
    let document = value(&mut events, MOST_LEVELS)?;
    // Of the document's end and the file's, neither is a value.
    for _ in 0..2 {
        if value(&mut events, MOST_LEVELS)?.is_some() {
            return Err("it has several documents".to_owned());
        }
    }
    document.ok_or_else(|| "it is empty".to_owned())
}

/// The next value, or `None` at the end of a list, map or file.
fn value<'t>(
    events: &mut impl Iterator<Item = Result<(Event<'t>, Span), ScanError>>,
    levels: u32,
) -> Result<Option<Value>, String> {
    let Some(event) = events.next() else {
        return Ok(None);
    };
    let (event, _) = event.map_err(|error| error.to_string())?;
    let levels = levels
        .checked_sub(1)
        .ok_or("its lists are nested too deeply")?;
    let mut next = || value(events, levels);
    Ok(Some(match event {
        Event::Nothing | Event::StreamStart | Event::DocumentStart(_) => return next(),
        Event::SequenceEnd | Event::MappingEnd | Event::DocumentEnd | Event::StreamEnd => {
            return Ok(None);
        }
        Event::Alias(_) => return Err("it has aliases".to_owned()),
        Event::Scalar(text, ScalarStyle::Plain, ..) => {
            let number = text.parse().ok().and_then(Number::from_f64);
            match (number, &*text) {
                (Some(number), _) => Value::Number(number),
                (None, "" | "~" | "null" | "Null" | "NULL") => Value::Null,
                (None, text) => text.into(),
            }
        }
        Event::Scalar(text, ..) => text.into_owned().into(),
        Event::SequenceStart(..) => {
            let mut list = Vec::new();
            while let Some(entry) = next()? {
                list.push(entry);
            }
            list.into()
        }
        Event::MappingStart(..) => {
            let mut map = serde_json::Map::new();
            while let Some(key) = next()? {
                let key = key.as_str().ok_or("a key is no text")?.to_owned();
                let told = format!("the key {key} comes twice");
                if map.insert(key, next()?.unwrap_or_default()).is_some() {
                    return Err(told);
                }
            }
            map.into()
        }
    }))
}
