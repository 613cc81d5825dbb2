//! Numbers out of a glTF document's buffers, every place checked.

use std::cmp::Ordering;

use glam::DVec3;

use super::document::{BufferView, Document};
use super::{Buffers, Problem, broken};

#[derive(Debug)]
pub(super) struct Numbers<'b> {
    layout: Layout,
    /// `None`: all are 0.
    bytes: Option<&'b [u8]>,
    /// Numbers of elements in ascending order, and their values.
    sparse: Option<Box<[Numbers<'b>; 2]>>,
    pub(super) count: usize,
}

#[derive(Debug, Clone, Copy)]
struct Layout {
    stride: usize,
    width: usize,
    component: u32,
    size: usize,
    normalized: bool,
}

impl<'b> Numbers<'b> {
    pub(super) fn find(
        document: &Document,
        buffers: &'b Buffers<'_>,
        number: usize,
    ) -> Result<Self, Problem> {
        let wrong = |expected: &str, found: &str| -> Problem {
            broken("accessor", number, expected, found)
        };
        let accessor = document
            .accessors
            .get(number)
            .ok_or_else(|| wrong("an accessor of this number", "none"))?;
        let width = match accessor.shape.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            other => return Err(wrong("SCALAR, VEC2, VEC3 or VEC4", other)),
        };
        let size = |component: u32| match component {
            5120 | 5121 => Ok(1),
            5122 | 5123 => Ok(2),
            5125 | 5126 => Ok(4),
            other => {
                let found = other.to_string();
                Err(wrong("a component type from 5120 to 5126", &found))
            }
        };
        let part = |view: Option<usize>, offset: u64, count: u64, width: usize, component: u32| {
            let size = size(component)?;
            let view = view.and_then(|v| document.buffer_views.get(v));
            let content = view.and_then(|view| Some((view, view_bytes(view, buffers)?)));
            let (view, content) = content.ok_or_else(|| {
                document.no_data("accessor", number, "a buffer view within its buffer")
            })?;
            let element = (width * size) as u64;
            let stride = view.byte_stride.unwrap_or(element);
            if stride < element {
                let found = stride.to_string();
                return Err(wrong("a stride of at least an element", &found));
            }
            let needed = match count {
                0 => Some(0),
                count => (count - 1)
                    .checked_mul(stride)
                    .and_then(|n| n.checked_add(element)),
            };
            let bytes = needed.and_then(|needed| slice(content, offset, needed));
            let bytes = bytes.ok_or_else(|| {
                let expected =
                    format!("{count} elements of {element} bytes within the buffer view");
                wrong(&expected, &format!("{} bytes", content.len()))
            })?;
            let layout = Layout {
                stride: stride as usize,
                width,
                component,
                size,
                normalized: accessor.normalized,
            };
            Ok(Self {
                layout,
                bytes: Some(bytes),
                sparse: None,
                count: count as usize,
            })
        };
        let (component, count) = (accessor.component_type, accessor.count);
        let view = accessor.buffer_view;
        let dense = || part(view, accessor.byte_offset, count, width, component);
        let Some(sparse) = &accessor.sparse else {
            return dense();
        };
        let (at, to) = (&sparse.indices, &sparse.values);
        let kind = at.component_type.unwrap_or(0);
        let few = sparse.count;
        let indices = part(Some(at.buffer_view), at.byte_offset, few, 1, kind)?;
        let values = part(Some(to.buffer_view), to.byte_offset, few, width, component)?;
        let mut all = match view {
            Some(_) => dense()?,
            None => Self {
                layout: values.layout,
                bytes: None,
                sparse: None,
                count: usize::try_from(count).unwrap_or(usize::MAX),
            },
        };
        all.sparse = Some(Box::new([indices, values]));
        Ok(all)
    }

    /// Sparse elements are found by bisection, so they must be in order.
    pub(super) fn check_order(&self, number: usize) -> Result<(), Problem> {
        let Some([indices, _]) = self.sparse.as_deref() else {
            return Ok(());
        };
        let mut next = 0;
        for element in 0..indices.count {
            let index = indices.index(element).map(|index| index as usize);
            let index = index.filter(|index| (next..self.count).contains(index));
            let wrong = || {
                let expected = "sparse indices in ascending order, below its count";
                broken("accessor", number, expected, "others")
            };
            next = index.ok_or_else(wrong)? + 1;
        }
        Ok(())
    }

    /// Number `k` of an element as it is meant; 0 outside.
    pub(super) fn real(&self, element: usize, k: usize) -> f32 {
        let (value, full) = match (self.layout.component, self.raw(element, k)) {
            (5120, &[a]) => (f32::from(a as i8), 127.0),
            (5121, &[a]) => (f32::from(a), 255.0),
            (5122, &[a, b]) => (f32::from(i16::from_le_bytes([a, b])), 32767.0),
            (5123, &[a, b]) => (f32::from(u16::from_le_bytes([a, b])), 65535.0),
            (5125, &[a, b, c, d]) => (u32::from_le_bytes([a, b, c, d]) as f32, 4_294_967_295.0),
            (5126, &[a, b, c, d]) => return f32::from_le_bytes([a, b, c, d]),
            _ => return 0.0,
        };
        match self.layout.normalized {
            true => (value / full).max(-1.0),
            false => value,
        }
    }

    /// Whether an element has a number `k`.
    pub(super) fn has(&self, k: usize) -> bool {
        k < self.layout.width
    }

    pub(super) fn point(&self, element: usize) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| f64::from(self.real(element, k))))
    }

    /// An index, where the numbers are whole and not negative.
    pub(super) fn index(&self, element: usize) -> Option<u32> {
        match (self.layout.component, self.raw(element, 0)) {
            (5121, &[a]) if self.layout.width == 1 => Some(a.into()),
            (5123, &[a, b]) if self.layout.width == 1 => Some(u16::from_le_bytes([a, b]).into()),
            (5125, &[a, b, c, d]) if self.layout.width == 1 => {
                Some(u32::from_le_bytes([a, b, c, d]))
            }
            _ => None,
        }
    }

    fn raw(&self, element: usize, k: usize) -> &[u8] {
        let Layout {
            stride,
            width,
            size,
            ..
        } = self.layout;
        if element >= self.count || k >= width {
            return &[];
        }
        if let Some([indices, values]) = self.sparse.as_deref() {
            let (mut low, mut high) = (0, indices.count);
            while low < high {
                let middle = low.midpoint(high);
                let index = indices.index(middle);
                match index.map(|index| (index as usize).cmp(&element)) {
                    Some(Ordering::Less) => low = middle + 1,
                    Some(Ordering::Equal) => return values.raw(middle, k),
                    _ => high = middle,
                }
            }
        }
        let at = element * stride + k * size;
        match self.bytes {
            Some(bytes) => bytes.get(at..at + size).unwrap_or_default(),
            None => &[0; 4][..size],
        }
    }
}

pub(super) fn view_bytes<'b>(view: &BufferView, buffers: &'b Buffers<'_>) -> Option<&'b [u8]> {
    let buffer = buffers.by_number.get(view.buffer)?;
    slice(buffer, view.byte_offset, view.byte_length)
}

fn slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let begin = usize::try_from(offset).ok()?;
    let end = begin.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(begin..end)
}
