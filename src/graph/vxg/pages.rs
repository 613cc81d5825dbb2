//! Pages of a mapped file in memory, as the system reports them (Linux: `/proc/self/smaps`).

use std::ops::Range;

use crate::graph::{Graph, Store};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct MappedPages {
    pub page_bytes: u64,
    /// Pages of the whole file.
    pub mapped: u64,
    /// Pages in this process's page table: those touched since the file was opened, and those that the system adds
    /// with them (Linux: cached pages of the same group of 16).
    pub resident: u64,
}

impl Graph {
    /// Pages of the mapped file; none where the graph owns its arrays or the system does not report them.
    pub fn mapped_pages(&self) -> Option<MappedPages> {
        let Store::Mapped(map, _) = &self.color else {
            return None;
        };
        let start = map.as_ptr() as u64;
        let smaps = std::fs::read_to_string("/proc/self/smaps").ok()?;
        parse(&smaps, start..start + map.len() as u64)
    }
}

/// Adds up the parts of a mapping, which the system may have split.
fn parse(smaps: &str, addresses: Range<u64>) -> Option<MappedPages> {
    let (mut page_bytes, mut resident) = (0, 0);
    let mut inside = false;
    for line in smaps.lines() {
        let Some((name, value)) = line.split_once(char::is_whitespace) else {
            continue;
        };
        if let Some((from, _)) = name.split_once('-') {
            let from = u64::from_str_radix(from, 16).ok()?;
            inside = addresses.contains(&from);
            continue;
        }
        let kibibytes = || value.split_whitespace().next()?.parse::<u64>().ok();
        match name {
            "KernelPageSize:" if inside => page_bytes = 1024 * kibibytes()?,
            "Rss:" if inside => resident += 1024 * kibibytes()?,
            _ => {}
        }
    }
    let pages = |bytes: u64| bytes.div_ceil(page_bytes);
    (page_bytes > 0).then(|| MappedPages {
        page_bytes,
        mapped: pages(addresses.end - addresses.start),
        resident: pages(resident),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_the_mapping_are_added_and_others_left_out() {
        let part = |addresses: &str, rss: u32| {
            format!(
                "{addresses} r--p 00000000 fe:00 12 /a b/c.vxg\nSize: 64 kB\nKernelPageSize: 4 kB\n\
                 Rss: {rss} kB\nReferenced: 4 kB\nVmFlags: rd mr mw me\n"
            )
        };
        let smaps = part("7000-8000", 400)
            + &part("10000-18000", 12)
            + &part("18000-1a000", 8)
            + &part("1a000-1b000", 4);
        let expected = MappedPages {
            page_bytes: 4096,
            mapped: 10,
            resident: 5,
        };
        assert_eq!(parse(&smaps, 0x10000..0x19fff), Some(expected));
        assert_eq!(parse(&smaps, 0x20000..0x30000), None);
        assert_eq!(parse("", 0..1), None);
    }
}
