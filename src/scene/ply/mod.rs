//! PLY files of any contents, element by element. Voxel clouds are read here in the crate, meshes in `shiftvox-mesh`.
//!
//! A file is read as a stream. Memory depends neither on the file nor on the counts in its header.

mod header;
mod source;

use std::io::BufRead;

use super::fault::{Fault, Problem, printable};
use super::numbers::{Number, Scalar};
pub use header::{Element, Header, Property};
pub(in crate::scene) use source::Source;

const MAX_LINE: usize = 1 << 20;

/// Numbers decoded together, if a row has no more.
const MOST_NUMBERS: usize = 2048;

const CUT: &str = "the file is cut short; export or copy it again";

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Encoding {
    /// One element per line.
    Ascii,
    Binary {
        big_endian: bool,
    },
}

pub struct PlyFile<'a, R> {
    pub header: Header,
    source: Source<'a, R>,
    scratch: Vec<u8>,
}

pub struct Row<'r> {
    pub number: u64,
    pub offset: u64,
    /// One number per property; 0 for a list.
    pub values: &'r [Number],
    pub lists: [&'r [Number]; 2],
}

/// Whether the header of a PLY file declares faces or strips of triangles, so that it is a mesh. `false` for a damaged header.
pub(super) fn has_faces<R: BufRead>(reader: &mut R) -> bool {
    let faces = |element: &Element| {
        [&b"face"[..], b"tristrips"].contains(&&element.name[..]) && element.count > 0
    };
    PlyFile::open(reader).is_ok_and(|file| file.header.elements.iter().any(faces))
}

impl<'a, R: BufRead> PlyFile<'a, R> {
    pub fn open(reader: &'a mut R) -> Result<Self, Problem> {
        let mut source = Source::new(reader);
        let header = header::read(&mut source)?;
        Ok(Self {
            header,
            source,
            scratch: Vec::new(),
        })
    }

    pub fn offset(&self) -> u64 {
        self.source.offset
    }

    /// The warning if more than blanks follows what was read.
    pub fn unread(&mut self) -> Result<Option<&'static str>, Problem> {
        let more = self.source.has_more()?;
        Ok(more.then_some("what follows the last element of the header was not read"))
    }

    pub fn skip(&mut self, element: &Element) -> Result<(), Problem> {
        let is_list = |property: &Property| property.list.is_some();
        let is_text = self.header.encoding == Encoding::Ascii;
        if is_text || element.properties.iter().any(is_list) {
            return self.rows(element, [None; 2], |_| Ok(()));
        }
        let sizes = element.properties.iter().map(|p| p.scalar.size() as u64);
        let bytes = element.count.saturating_mul(sizes.sum());
        match self.source.skip(bytes)? {
            true => Ok(()),
            false => Err(cut(element, 0, self.offset()).into()),
        }
    }

    /// Reads all elements of the next kind. `lists`: numbers of the properties whose lists are kept.
    pub fn rows(
        &mut self,
        element: &Element,
        lists: [Option<usize>; 2],
        mut visit: impl FnMut(Row<'_>) -> Result<(), Problem>,
    ) -> Result<(), Problem> {
        let (mut values, mut kept) = (Vec::new(), [Vec::new(), Vec::new()]);
        if let Encoding::Binary { big_endian } = self.header.encoding
            && element.properties.iter().all(|p| p.list.is_none())
        {
            return self.plain_rows(element, big_endian, visit);
        }
        for number in 0..element.count {
            let mut offset = self.source.offset;
            values.clear();
            kept.iter_mut().for_each(Vec::clear);
            let is_whole = match self.header.encoding {
                Encoding::Ascii => match self.text_line()? {
                    None => false,
                    Some(begin) => {
                        offset = begin;
                        let fault = |expected: String, found: String, advice: &str| {
                            Fault::new(part(element, number), begin, expected, found, advice)
                        };
                        parse_row(&self.scratch, element, lists, &mut values, &mut kept, fault)?;
                        true
                    }
                },
                Encoding::Binary { big_endian } => {
                    let mut is_whole = true;
                    for (at, property) in element.properties.iter().enumerate() {
                        let kept = kept.iter_mut().zip(lists);
                        let kept = kept.into_iter().find(|(_, list)| *list == Some(at));
                        let kept = kept.map(|(kept, _)| kept);
                        let value = self.binary((element, number), property, big_endian, kept)?;
                        is_whole &= value.is_some();
                        values.extend(value);
                        if !is_whole {
                            break;
                        }
                    }
                    is_whole
                }
            };
            if !is_whole {
                return Err(cut(element, number, self.source.offset).into());
            }
            visit(Row {
                number,
                offset,
                values: &values,
                lists: [&kept[0], &kept[1]],
            })?;
        }
        Ok(())
    }

    /// Rows without lists: those in the reader's buffer together, property by property.
    fn plain_rows(
        &mut self,
        element: &Element,
        big_endian: bool,
        mut visit: impl FnMut(Row<'_>) -> Result<(), Problem>,
    ) -> Result<(), Problem> {
        let width = element.properties.len();
        let stride = element.properties.iter().map(|p| p.scalar.size()).sum();
        let most = (MOST_NUMBERS / width.max(1)).max(1);
        let mut values = vec![Number::Whole(0); most * width];
        let mut number = 0;
        while number < element.count {
            let left = usize::try_from(element.count - number).unwrap_or(usize::MAX);
            let buffered = self.source.buffered()?.checked_div(stride).unwrap_or(1);
            let rows = buffered.clamp(1, left.min(most));
            let offset = self.source.offset;
            let decode = |bytes: &[u8]| {
                let mut begin = 0;
                for (at, property) in element.properties.iter().enumerate() {
                    let rows = bytes
                        .chunks_exact(stride)
                        .zip(values.chunks_exact_mut(width));
                    let numbers = rows.map(|(row, values)| (&row[begin..], &mut values[at]));
                    property.scalar.decode(big_endian, numbers);
                    begin += property.scalar.size();
                }
            };
            let read = self
                .source
                .bytes(rows * stride, &mut self.scratch, decode)?;
            if read.is_none() {
                return Err(cut(element, number, self.source.offset).into());
            }
            for row in 0..rows {
                visit(Row {
                    number: number + row as u64,
                    offset: offset + (row * stride) as u64,
                    values: &values[row * width..][..width],
                    lists: [&[]; 2],
                })?;
            }
            number += rows as u64;
        }
        Ok(())
    }

    fn text_line(&mut self) -> Result<Option<u64>, Problem> {
        loop {
            let begin = self.source.offset;
            if !self.source.line(&mut self.scratch, MAX_LINE, "body")? {
                return Ok(None);
            }
            if !self.scratch.trim_ascii().is_empty() {
                return Ok(Some(begin));
            }
        }
    }

    /// Reads a binary number, or a list and returns 0; `None` if the file ends first.
    fn binary(
        &mut self,
        (element, number): (&Element, u64),
        property: &Property,
        big_endian: bool,
        kept: Option<&mut Vec<Number>>,
    ) -> Result<Option<Number>, Problem> {
        let Some(length) = property.list else {
            return self.source.number(property.scalar, big_endian);
        };
        let offset = self.source.offset;
        let Some(length) = self.source.number(length, big_endian)? else {
            return Ok(None);
        };
        let Some(length) = length.whole().and_then(|length| u64::try_from(length).ok()) else {
            return Err(Fault::new(
                part(element, number),
                offset,
                "a list's length that is not negative",
                length.to_string(),
                "the file is damaged; export it again",
            )
            .into());
        };
        let Some(kept) = kept else {
            let bytes = length.saturating_mul(property.scalar.size() as u64);
            return Ok(self.source.skip(bytes)?.then_some(Number::Whole(0)));
        };
        for _ in 0..length {
            match self.source.number(property.scalar, big_endian)? {
                Some(number) => kept.push(number),
                None => return Ok(None),
            }
        }
        Ok(Some(Number::Whole(0)))
    }
}

fn part(element: &Element, number: u64) -> String {
    format!("{} {number}", element.name.escape_ascii())
}

fn cut(element: &Element, number: u64, offset: u64) -> Box<Fault> {
    let expected = "as many elements as the header says";
    Fault::new(
        part(element, number),
        offset,
        expected,
        "the end of the file",
        CUT,
    )
}

fn parse_row(
    line: &[u8],
    element: &Element,
    lists: [Option<usize>; 2],
    values: &mut Vec<Number>,
    kept: &mut [Vec<Number>; 2],
    fault: impl Fn(String, String, &str) -> Box<Fault>,
) -> Result<(), Box<Fault>> {
    let mut words = line
        .split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty());
    let mut next = |property: &Property| {
        let word = words.next();
        let number = word.and_then(Number::parse);
        // In a column of a real type `1` is 1.0: the colour of full brightness, not the byte 1.
        let number = number.map(|number| match property.scalar.is_integer() {
            true => number,
            false => Number::Real(number.real()),
        });
        number.ok_or_else(|| {
            fault(
                format!("a number for property {}", property.name.escape_ascii()),
                word.map_or("the end of the line".to_owned(), printable),
                "every element needs a line with a number for every property of the header",
            )
        })
    };
    for (at, property) in element.properties.iter().enumerate() {
        let value = next(property)?;
        values.push(value);
        if property.list.is_some() {
            // A length that is no whole number ends the line early, and that is an error.
            for _ in 0..value.whole().unwrap_or(i64::MAX) {
                let number = next(property)?;
                for (kept, list) in kept.iter_mut().zip(lists) {
                    if list == Some(at) {
                        kept.push(number);
                    }
                }
            }
        }
    }
    match words.next() {
        None => Ok(()),
        Some(_) if element.properties.is_empty() => Ok(()),
        Some(word) => Err(fault(
            format!(
                "one number for each of {} properties",
                element.properties.len()
            ),
            format!("{} after them", printable(word)),
            "every element needs a line of its own",
        )),
    }
}

impl Scalar {
    fn from_ply(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }
}
