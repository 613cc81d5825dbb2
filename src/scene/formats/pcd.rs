//! Clouds of the Point Cloud Library: a header in text, then points in text or binary numbers.

use glam::DVec3;

use super::cloud::Cloud;
use super::xyz::MAX_LINE;
use crate::graph::KnownNormals;
use crate::scene::DEFAULT_COLOR;
use crate::scene::emit::Emitter;
use crate::scene::fault::{Fault, Problem, printable};
use crate::scene::input::Input;
use crate::scene::numbers::{Number, Scalar};
use crate::scene::ply::Source;

const AGAIN: &str = "the file is damaged or cut short; save or copy it again";
const MAX_POINT: usize = 1 << 16;

/// A field of a point, of which the first number counts.
struct Field {
    name: Vec<u8>,
    scalar: Scalar,
    /// Its places among the numbers and the bytes of a point.
    number: usize,
    byte: usize,
}

struct Header {
    fields: Vec<Field>,
    numbers: usize,
    bytes: usize,
    points: u64,
    is_text: bool,
}

pub(super) fn read(input: &mut Input<'_>, emitter: &mut Emitter<'_>) -> Result<(), Problem> {
    let mut source = Source::new(&mut input.reader);
    let mut header = read_header(&mut source)?;
    let find = |name: &str| header.fields.iter().position(|f| f.name == name.as_bytes());
    let three = |names: [&str; 3]| {
        let [a, b, c] = names.map(find);
        Some([a?, b?, c?])
    };
    let missing = || fault("header", 0, "the fields x, y and z", "not all of them");
    let positions = three(["x", "y", "z"]).ok_or_else(missing)?;
    let normals = three(["normal_x", "normal_y", "normal_z"]);
    let color = find("rgb").or(find("rgba"));
    if let Some(at) = color.filter(|_| !header.is_text)
        && header.fields[at].scalar == Scalar::F32
    {
        // Bits that are no number would change on their way through one.
        header.fields[at].scalar = Scalar::U32;
    }
    let (mut cloud, mut known) = (Cloud::new(emitter.options), KnownNormals::default());
    let (mut line, mut values) = (Vec::new(), Vec::new());
    for point in 0..header.points {
        let begin = source.offset;
        let part = || (format!("point {point}"), begin);
        let cut = || {
            let expected = format!("{} points", header.points);
            fault(&part().0, begin, expected, "the end of the file")
        };
        values.clear();
        if header.is_text {
            if !source.line(&mut line, MAX_LINE, "points")? {
                return Err(cut().into());
            }
            let words = words(&line);
            let numbers: Option<Vec<Number>> = words.iter().map(|w| Number::parse(w)).collect();
            let numbers = numbers.filter(|numbers| numbers.len() == header.numbers);
            let numbers = numbers.ok_or_else(|| {
                let expected = format!("{} numbers", header.numbers);
                fault(&part().0, begin, expected, printable(&line))
            })?;
            values.extend(header.fields.iter().map(|field| numbers[field.number]));
        } else {
            let decode = |bytes: &[u8]| {
                let value = |field: &Field| field.scalar.decode_one(false, &bytes[field.byte..]);
                values.extend(header.fields.iter().map(value));
            };
            let read = source.bytes(header.bytes, &mut line, decode)?;
            read.ok_or_else(cut)?;
        }
        let normal = normals.map(|at| DVec3::from_array(at.map(|k| values[k].real())));
        let normal = normal.map(|normal| known.encode(normal));
        let normal = normal.filter(|normal| !normal.is_none());
        let color = color.map_or(DEFAULT_COLOR, |at| {
            packed(header.fields[at].scalar, values[at])
        });
        let position = positions.map(|at| values[at]);
        cloud.point(position, color, normal, |_| part(), emitter)?;
    }
    cloud.finish(&mut emitter.info)
}

/// Red, green and blue in the bits of one number, whose type may be `float`.
fn packed(scalar: Scalar, value: Number) -> [u8; 3] {
    let bits = match (scalar, value) {
        (Scalar::F32, value) => (value.real() as f32).to_bits(),
        (_, Number::Whole(bits)) => bits as u32,
        (_, Number::Real(_)) => 0,
    };
    let [_, r, g, b] = bits.to_be_bytes();
    [r, g, b]
}

fn words(line: &[u8]) -> Vec<&[u8]> {
    let words = line.split(u8::is_ascii_whitespace);
    words.filter(|word| !word.is_empty()).collect()
}

fn read_header<R: std::io::BufRead>(source: &mut Source<'_, R>) -> Result<Header, Problem> {
    let mut line = Vec::new();
    let (mut names, mut sizes, mut types, mut counts) = (vec![], vec![], vec![], vec![]);
    let [mut width, mut height, mut points] = [None; 3];
    let is_text = loop {
        let begin = source.offset;
        if !source.line(&mut line, MAX_LINE, "header")? {
            return Err(fault("header", begin, "a line DATA", "the end of the file").into());
        }
        let wrong = |expected: &str| fault("header", begin, expected, printable(&line));
        let list = |words: &[&[u8]]| words.iter().map(|w| w.to_vec()).collect::<Vec<_>>();
        let words = words(&line);
        let number = |word: &[u8]| {
            let number = std::str::from_utf8(word)
                .ok()
                .and_then(|w| w.parse::<u64>().ok());
            number.ok_or_else(|| wrong("a whole number"))
        };
        match words[..] {
            [] | [b"VERSION" | b"VIEWPOINT", ..] => {}
            [first, ..] if first.starts_with(b"#") => {}
            [b"FIELDS", ref rest @ ..] => names = list(rest),
            [b"SIZE", ref rest @ ..] => sizes = list(rest),
            [b"TYPE", ref rest @ ..] => types = list(rest),
            [b"COUNT", ref rest @ ..] => {
                counts = rest.iter().map(|w| number(w)).collect::<Result<_, _>>()?;
            }
            [b"WIDTH", word] => width = Some(number(word)?),
            [b"HEIGHT", word] => height = Some(number(word)?),
            [b"POINTS", word] => points = Some(number(word)?),
            [b"DATA", b"ascii"] => break true,
            [b"DATA", b"binary"] => break false,
            [b"DATA", b"binary_compressed"] => {
                let expected = "DATA ascii or DATA binary";
                let advice = "convert it: pcl_convert_pcd_ascii_binary IN.pcd OUT.pcd 1";
                let found = printable(&line);
                return Err(Fault::new("header", begin, expected, found, advice).into());
            }
            _ => {
                return Err(
                    wrong("FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, POINTS or DATA").into(),
                );
            }
        }
    };
    let end = source.offset;
    let wrong = |expected: &str, found: String| fault("header", end, expected, found);
    if counts.is_empty() {
        counts = vec![1; names.len()];
    }
    if [sizes.len(), types.len(), counts.len()] != [names.len(); 3] {
        let found = format!("{}, {} and {}", sizes.len(), types.len(), counts.len());
        let expected = format!("SIZE, TYPE and COUNT of {} fields", names.len());
        return Err(wrong(&expected, found).into());
    }
    let (mut fields, mut numbers, mut bytes) = (Vec::new(), 0, 0);
    for (k, name) in names.into_iter().enumerate() {
        let scalar = match (&types[k][..], &sizes[k][..]) {
            ([kind @ (b'I' | b'U' | b'F')], &[size]) => Scalar::of(kind.to_ascii_lowercase(), size),
            _ => None,
        };
        let scalar = scalar.ok_or_else(|| {
            let found = printable(&[&types[k][..], b" ", &sizes[k]].concat());
            wrong("the types I and U of 1 to 8 bytes or F of 4 or 8", found)
        })?;
        let count = usize::try_from(counts[k]).unwrap_or(usize::MAX);
        if count > (MAX_POINT - bytes) / scalar.size() || count == 0 {
            let expected = format!("1 number or more per field, in {MAX_POINT} bytes at most");
            return Err(wrong(&expected, count.to_string()).into());
        }
        let (number, byte) = (numbers, bytes);
        fields.push(Field {
            name,
            scalar,
            number,
            byte,
        });
        numbers += count;
        bytes += count * scalar.size();
    }
    let product = || width?.checked_mul(height.unwrap_or(1));
    let points = points.or_else(product);
    let missing = || wrong("a line POINTS, or WIDTH and HEIGHT", "none".to_owned());
    Ok(Header {
        fields,
        numbers,
        bytes,
        points: points.ok_or_else(missing)?,
        is_text,
    })
}

fn fault(
    part: &str,
    offset: u64,
    expected: impl Into<String>,
    found: impl Into<String>,
) -> Box<Fault> {
    Fault::new(part, offset, expected, found, AGAIN)
}
