//! Numbers out of a glTF document's buffers, every place checked.

use glam::DVec3;

use super::document::{BufferView, Document};
use super::{Buffers, Problem, broken, fault_of};

#[derive(Debug)]
pub(super) struct Numbers<'b> {
    bytes: &'b [u8],
    stride: usize,
    pub(super) count: usize,
    pub(super) width: usize,
    component: u32,
    size: usize,
    normalized: bool,
}

impl<'b> Numbers<'b> {
    pub(super) fn find(
        document: &Document,
        buffers: &'b Buffers,
        number: usize,
    ) -> Result<Self, Problem> {
        let wrong = |expected: &str, found: &str| -> Problem {
            broken("accessor", number, expected, found)
        };
        let accessor = document
            .accessors
            .get(number)
            .ok_or_else(|| wrong("an accessor of this number", "none"))?;
        if accessor.sparse.is_some() {
            return Err(fault_of(
                "accessor",
                number,
                "plain numbers",
                "a sparse accessor, which is not read",
                "export without sparse accessors or morph targets",
            ));
        }
        let width = match accessor.shape.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            other => return Err(wrong("SCALAR, VEC2, VEC3 or VEC4", other)),
        };
        let size = match accessor.component_type {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            5125 | 5126 => 4,
            other => {
                let found = other.to_string();
                return Err(wrong("a component type from 5120 to 5126", &found));
            }
        };
        let view = accessor
            .buffer_view
            .and_then(|v| document.buffer_views.get(v));
        let content = view.and_then(|view| Some((view, view_bytes(view, buffers)?)));
        let (view, content) =
            content.ok_or_else(|| wrong("a buffer view within its buffer", "none"))?;
        let element = (width * size) as u64;
        let stride = view.byte_stride.unwrap_or(element);
        if stride < element {
            let found = stride.to_string();
            return Err(wrong("a stride of at least an element", &found));
        }
        let needed = match accessor.count {
            0 => Some(0),
            count => (count - 1)
                .checked_mul(stride)
                .and_then(|n| n.checked_add(element)),
        };
        let bytes = needed.and_then(|needed| slice(content, accessor.byte_offset, needed));
        let bytes = bytes.ok_or_else(|| {
            let count = accessor.count;
            let expected = format!("{count} elements of {element} bytes within the buffer view");
            wrong(&expected, &format!("{} bytes", content.len()))
        })?;
        Ok(Self {
            bytes,
            stride: stride as usize,
            count: accessor.count as usize,
            width,
            component: accessor.component_type,
            size,
            normalized: accessor.normalized,
        })
    }

    /// Number `k` of an element as it is meant; 0 outside.
    pub(super) fn real(&self, element: usize, k: usize) -> f32 {
        let (value, full) = match (self.component, self.raw(element, k)) {
            (5120, &[a]) => (f32::from(a as i8), 127.0),
            (5121, &[a]) => (f32::from(a), 255.0),
            (5122, &[a, b]) => (f32::from(i16::from_le_bytes([a, b])), 32767.0),
            (5123, &[a, b]) => (f32::from(u16::from_le_bytes([a, b])), 65535.0),
            (5125, &[a, b, c, d]) => (u32::from_le_bytes([a, b, c, d]) as f32, 4_294_967_295.0),
            (5126, &[a, b, c, d]) => return f32::from_le_bytes([a, b, c, d]),
            _ => return 0.0,
        };
        match self.normalized {
            true => (value / full).max(-1.0),
            false => value,
        }
    }

    pub(super) fn point(&self, element: usize) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| f64::from(self.real(element, k))))
    }

    /// An index, where the numbers are whole and not negative.
    pub(super) fn index(&self, element: usize) -> Option<u32> {
        match (self.component, self.raw(element, 0)) {
            (5121, &[a]) if self.width == 1 => Some(a.into()),
            (5123, &[a, b]) if self.width == 1 => Some(u16::from_le_bytes([a, b]).into()),
            (5125, &[a, b, c, d]) if self.width == 1 => Some(u32::from_le_bytes([a, b, c, d])),
            _ => None,
        }
    }

    fn raw(&self, element: usize, k: usize) -> &[u8] {
        let at = element * self.stride + k * self.size;
        let is_inside = element < self.count && k < self.width;
        let range = if is_inside { at..at + self.size } else { 0..0 };
        self.bytes.get(range).unwrap_or_default()
    }
}

pub(super) fn view_bytes<'b>(view: &BufferView, buffers: &'b Buffers) -> Option<&'b [u8]> {
    let buffer = buffers.by_number.get(view.buffer)?;
    slice(buffer, view.byte_offset, view.byte_length)
}

fn slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let begin = usize::try_from(offset).ok()?;
    let end = begin.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(begin..end)
}
