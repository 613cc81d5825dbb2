//! Messages to a page: the length of a head in four bytes (least significant first), the head as JSON, and the picture if
//! there is one.

use serde_json::{Value, json};

use crate::request::{MOST_FILE, MOST_PIXELS, MOST_SAMPLES, Request};
use crate::{Answer, Program};

/// The head of the first message.
#[must_use]
pub fn hello(program: &impl Program) -> Value {
    let mut hello = program.hello();
    hello["ask"] = json!("hello");
    hello["version"] = json!(env!("CARGO_PKG_VERSION"));
    hello["most_pixels"] = json!(MOST_PIXELS);
    hello["most_samples"] = json!(MOST_SAMPLES);
    hello["most_file"] = json!(MOST_FILE);
    hello
}

/// The bytes of a message.
#[must_use]
pub fn message((head, picture): Answer) -> Vec<u8> {
    let head = head.to_string();
    let mut bytes = (head.len() as u32).to_le_bytes().to_vec();
    bytes.extend_from_slice(head.as_bytes());
    bytes.extend_from_slice(&picture);
    bytes
}

/// The answer of a [`Program::drawer`] to a request's text, or a refusal.
pub fn answer(
    drawer: &mut impl FnMut(&Request) -> Result<Answer, String>,
    message: &str,
) -> Answer {
    let request = serde_json::from_str::<Request>(message)
        .map_err(|error| format!("this message is not understood: {error}"));
    let mut seq = None;
    let drawn = request.and_then(|request| {
        seq = Some(request.seq);
        request.check()?;
        let (mut head, picture) = drawer(&request)?;
        head["ask"] = json!(request.ask);
        Ok((head, picture))
    });
    let refused = |reason| (json!({ "ask": "error", "error": reason }), Vec::new());
    let (mut head, picture) = drawn.unwrap_or_else(refused);
    head["seq"] = json!(seq);
    (head, picture)
}

/// An answer to [`Ask::Pick`](crate::Ask::Pick).
///
/// - `voxel`: index in the file, in finest voxels, and level. A negative level means no voxel.
/// - `levels`: level of the finest voxels.
/// - `origin`: world position of index 0.
/// - `size`: world length of a finest voxel's side.
#[must_use]
pub fn picked(voxel: [i32; 4], color: [u8; 3], levels: u32, origin: [f64; 3], size: f64) -> Answer {
    let [i, j, k, level] = voxel;
    let head = u32::try_from(level).ok().map(|level| {
        let low: Vec<f64> = [i, j, k]
            .iter()
            .zip(origin)
            .map(|(&index, origin)| origin + size * f64::from(index))
            .collect();
        let side = size * f64::from(1u32 << levels.saturating_sub(level).min(31));
        json!({ "index": [i, j, k], "level": level, "levels": levels, "color": color, "low": low, "side": side })
    });
    (json!({ "voxel": head }), Vec::new())
}

/// The command line of a page's picture or figures. `camera` has flags.
#[must_use]
pub fn command(
    verb: &str,
    scene: &str,
    words: impl Iterator<Item = String>,
    [width, height]: [u32; 2],
    camera: &str,
) -> String {
    let words: String = words.map(|word| word + " ").collect();
    let scene = quoted(scene);
    format!("shiftvox {verb} {scene} {words}--size={width}x{height} {camera}")
}

/// A scene's name, quoted for bash and zsh.
fn quoted(name: &str) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "/._-+:,=".contains(letter);
    if !name.is_empty() && !name.starts_with('-') && name.chars().all(is_plain) {
        return name.to_owned();
    }
    let begin = if name.starts_with('-') { "./" } else { "" };
    if !name.contains(char::is_control) {
        return format!("'{begin}{}'", name.replace('\'', r"'\''"));
    }
    let escaped = |letter: char| match letter {
        letter if letter.is_ascii_control() || letter == '\'' || letter == '\\' => {
            format!("\\x{:02x}", u32::from(letter))
        }
        letter => letter.to_string(),
    };
    format!(
        "$'{begin}{}'",
        name.chars().map(escaped).collect::<String>()
    )
}

#[cfg(test)]
mod tests {
    #[test]
    fn names_come_through_a_shell() {
        for (name, expected) in [
            ("a/b.vox", "a/b.vox"),
            ("gen:menger,depth=3", "gen:menger,depth=3"),
            ("it's $HOME.vox", r"'it'\''s $HOME.vox'"),
            ("-o.vox", "'./-o.vox'"),
            ("'\n.vox", r"$'\x27\x0a.vox'"),
        ] {
            assert_eq!(super::quoted(name), expected);
        }
    }
}
