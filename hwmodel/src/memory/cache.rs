//! A set-associative cache with LRU replacement.

/// A line's set is its number modulo the number of sets.
#[derive(Debug, Clone)]
pub struct Cache {
    line_bytes: u64,
    ways: usize,
    /// Lines by set, most recently used first; `NONE` where empty.
    lines: Vec<u64>,
    hits: u64,
    misses: u64,
}

const NONE: u64 = u64::MAX;

impl Cache {
    /// An empty cache of whole sets: `bytes` is a multiple of `ways * line_bytes`, and none of them is 0.
    pub fn new(bytes: u32, ways: u32, line_bytes: u32) -> Self {
        Self {
            line_bytes: u64::from(line_bytes),
            ways: ways as usize,
            lines: vec![NONE; (bytes / line_bytes) as usize],
            hits: 0,
            misses: 0,
        }
    }

    /// Accesses the line of a byte. A missing line replaces the least recently used one of its set.
    pub fn access(&mut self, byte_address: u64) {
        let line = byte_address / self.line_bytes;
        let sets = self.lines.len() / self.ways;
        let first = (line % sets as u64) as usize * self.ways;
        let set = &mut self.lines[first..first + self.ways];
        let found = set.iter().position(|&there| there == line);
        set[..=found.unwrap_or(self.ways - 1)].rotate_right(1);
        set[0] = line;
        match found {
            Some(_) => self.hits += 1,
            None => self.misses += 1,
        }
    }

    /// Accesses that found their line.
    pub fn hits(&self) -> u64 {
        self.hits
    }

    /// Accesses that did not find their line.
    pub fn misses(&self) -> u64 {
        self.misses
    }
}
