//! A set-associative cache with LRU replacement.

/// Three numbers that do not make a cache.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "{size_bytes} bytes with {ways} lines of {line_bytes} bytes per set are not a cache: it has 1 to 65535 ways, whole \
     sets, and at most 2^28 lines"
)]
pub struct CacheError {
    /// Requested size, bytes.
    pub size_bytes: u64,
    /// Requested ways.
    pub ways: u32,
    /// Requested bytes per line.
    pub line_bytes: u32,
}

/// A cache of `size_bytes / (ways * line_bytes)` sets. A line's set is its number modulo the number of sets.
#[derive(Debug, Clone)]
pub struct Cache {
    line_bytes: u64,
    ways: usize,
    sets: u64,
    /// Lines by set, most recently used first; `NONE` where empty.
    lines: Vec<u64>,
    hits: u64,
    misses: u64,
}

const NONE: u64 = u64::MAX;
const MAX_LINES: u64 = 1 << 28;

impl Cache {
    /// An empty cache.
    ///
    /// # Errors
    /// When the size is not a whole number of sets, at least one, or above 2^28 lines; when `ways` is not 1 to 65535 or
    /// `line_bytes` is 0.
    pub fn new(size_bytes: u64, ways: u32, line_bytes: u32) -> Result<Self, CacheError> {
        let set_bytes = u64::from(ways) * u64::from(line_bytes);
        let is_sound = set_bytes > 0
            && ways <= 65535
            && size_bytes > 0
            && size_bytes.is_multiple_of(set_bytes)
            && size_bytes / u64::from(line_bytes) <= MAX_LINES;
        if !is_sound {
            return Err(CacheError {
                size_bytes,
                ways,
                line_bytes,
            });
        }
        let lines = size_bytes / u64::from(line_bytes);
        Ok(Self {
            line_bytes: u64::from(line_bytes),
            ways: ways as usize,
            sets: size_bytes / set_bytes,
            lines: vec![NONE; lines as usize],
            hits: 0,
            misses: 0,
        })
    }

    /// Accesses the line of a byte, and returns whether it was present. A missing line replaces the least recently used
    /// one of its set.
    pub fn access(&mut self, byte_address: u64) -> bool {
        let line = byte_address / self.line_bytes;
        let first = (line % self.sets) as usize * self.ways;
        let set = &mut self.lines[first..first + self.ways];
        let found = set.iter().position(|&there| there == line);
        set[..=found.unwrap_or(self.ways - 1)].rotate_right(1);
        set[0] = line;
        match found {
            Some(_) => self.hits += 1,
            None => self.misses += 1,
        }
        found.is_some()
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
