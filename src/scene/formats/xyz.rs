//! Points in text, one per line: `x y z`, then colours or other columns.

use super::cloud::Cloud;
use crate::scene::DEFAULT_COLOR;
use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem, printable};
use crate::scene::input::Input;
use crate::scene::numbers::Number;
use crate::scene::ply::Source;

pub(super) const MAX_LINE: usize = 1 << 12;

pub(super) fn read(input: &mut Input<'_>, emitter: &mut Emitter<'_>) -> Result<(), Problem> {
    let mut source = Source::new(&mut input.reader);
    let mut cloud = Cloud::new(emitter.options);
    let mut line = Vec::new();
    let mut numbers = Vec::new();
    // Columns, and the first one of the colours.
    let mut layout: Option<(usize, Option<usize>)> = None;
    for number in 1.. {
        let begin = source.offset;
        if !source.line(&mut line, MAX_LINE, "points")? {
            break;
        }
        let Some(words) = words(&line, layout.is_none()) else {
            continue;
        };
        let part = || (format!("line {number}"), begin);
        if has_decimal_commas(&line) {
            let advice = "write decimal points in place of commas";
            let expected = "commas, semicolons or spaces between numbers";
            return Err(Fault::new(part().0, begin, expected, printable(&line), advice).into());
        }
        let fault = |expected: String, found: &[u8]| {
            let advice = "every line needs the same columns; export the points again";
            Fault::new(part().0, begin, expected, printable(found), advice)
        };
        numbers.clear();
        for word in words {
            let parsed = Number::parse(word);
            numbers.push(parsed.ok_or_else(|| fault("a number".to_owned(), word))?);
        }
        let (columns, colors) = *layout.get_or_insert_with(|| (numbers.len(), colors(&numbers)));
        if numbers.len() != columns || columns < 3 {
            let expected = format!("{} numbers", columns.max(3));
            return Err(fault(expected, &line).into());
        }
        let mut color = DEFAULT_COLOR;
        for (k, at) in (colors.unwrap_or(columns)..columns).take(3).enumerate() {
            let byte = numbers[at].whole().and_then(|n| u8::try_from(n).ok());
            color[k] = byte.ok_or_else(|| {
                let expected = "colours from 0 to 255, as in the first line".to_owned();
                let advice = "if these are no colours, such as normals, leave the columns out";
                Fault::new(part().0, begin, expected, printable(&line), advice)
            })?;
        }
        let position = [numbers[0], numbers[1], numbers[2]];
        cloud.point(position, color, None, |_| part(), emitter)?;
    }
    if let Some((columns @ 4.., None)) = layout {
        emitter.info.warnings.push(format!(
            "columns from 4 of {columns} are not drawn: colours are three whole numbers from 0 to 255"
        ));
    }
    cloud.finish(&mut emitter.info)
}

/// The words of a line, or `None` of a comment, a blank line, or, before the first point, names of columns or the number
/// of points.
fn words(line: &[u8], may_be_names: bool) -> Option<impl Iterator<Item = &[u8]>> {
    let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line);
    let text = line.trim_ascii();
    let is_data = !text.is_empty() && !text.starts_with(b"#") && !text.starts_with(b"//");
    let is_head = matches!(text, [b'x' | b'X', ..]) || text.iter().all(u8::is_ascii_digit);
    let is_data = is_data && !(may_be_names && is_head);
    let ends = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b',' | b';');
    is_data.then(|| text.split(ends).filter(|word| !word.is_empty()))
}

/// Whether commas stand within the words of a line that other characters separate.
fn has_decimal_commas(line: &[u8]) -> bool {
    let parts = line
        .trim_ascii()
        .split(|byte| byte.is_ascii_whitespace() || *byte == b';');
    let words: Vec<&[u8]> = parts
        .map(|word| word.strip_suffix(b",").unwrap_or(word))
        .collect();
    words.len() > 1
        && words
            .iter()
            .any(|word| word[..].iter().skip(1).any(|byte| *byte == b','))
}

/// The columns from the fourth, or of seven columns from the fifth (after an intensity), if the first point has bytes there.
fn colors(first: &[Number]) -> Option<usize> {
    let at = if first.len() == 7 { 4 } else { 3 };
    let is_byte = |n: &Number| matches!(n, Number::Whole(0..=255));
    first.get(at..at + 3)?.iter().all(is_byte).then_some(at)
}

/// Whether the first line with contents has three numbers or more, and only numbers.
pub(super) fn is_xyz(beginning: &[u8], _: u64) -> bool {
    let first = beginning
        .split(|byte| *byte == b'\n')
        .find_map(|line| words(line, true));
    first.is_some_and(|mut words| {
        let mut numbers = 0;
        words.all(|word| {
            numbers += 1;
            Number::parse(word).is_some()
        }) && numbers >= 3
    })
}
