//! Wavefront text: lines, whatever the file makes of them.

use std::borrow::Cow;

/// The text of a file without byte order mark. Invalid UTF-8 is replaced, which changes only names of materials. Lines may
/// end as on an old Macintosh.
pub(super) fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    let text = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    match String::from_utf8_lossy(text) {
        text if !text.contains('\n') => text.replace('\r', "\n").into(),
        Cow::Borrowed(text) => joined(text),
        Cow::Owned(text) => joined(&text).into_owned().into(),
    }
}

/// The text with each line that ends in a backslash joined with the next. The ends that are taken out follow the joined
/// line, so that later lines keep their numbers. A comment is not continued: it may end in a path.
fn joined(text: &str) -> Cow<'_, str> {
    if !text.contains("\\\n") && !text.contains("\\\r\n") {
        return text.into();
    }
    let mut result = String::with_capacity(text.len());
    let mut open = 0;
    for line in text.split_inclusive('\n') {
        let content = line.trim_end_matches(['\n', '\r']);
        let is_comment = open == 0 && content.trim_start().starts_with('#');
        match content.strip_suffix('\\') {
            Some(part) if content.len() < line.len() && !is_comment => {
                result.push_str(part);
                result.push(' ');
                open += 1;
            }
            _ => {
                result.push_str(line);
                if content.len() == line.len() && open > 0 {
                    continue;
                }
                result.extend(std::iter::repeat_n('\n', std::mem::take(&mut open)));
            }
        }
    }
    result.into()
}
