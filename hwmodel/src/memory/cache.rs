//! A set-associative cache with LRU replacement.

/// Why three numbers do not make a cache.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CacheError {
    /// A line has no bytes.
    #[error("a cache line has at least 1 byte, not 0")]
    NoLine,
    /// A set has no ways, or more than 65535.
    #[error("a cache has 1 to 65535 ways, not {0}")]
    Ways(u32),
    /// The size is not a whole number of sets.
    #[error(
        "a cache of {size_bytes} bytes is not made of whole sets of {ways} lines of {line_bytes} bytes"
    )]
    Sets {
        /// Requested size, bytes.
        size_bytes: u64,
        /// Requested ways.
        ways: u32,
        /// Requested bytes per line.
        line_bytes: u32,
    },
    /// The cache is too large to be simulated. The cache is too large to be simulated.
    #[error("a cache of {0} lines is too large: at most 2^28")]
    TooLarge(u64),
}

/// A cache of `size_bytes / (ways * line_bytes)` sets. A line's set is its number modulo the number of sets.
///
/// ```
/// use hwmodel::memory::Cache;
///
/// // Two sets of one line each.
/// let mut cache = Cache::new(128, 1, 64)?;
/// assert!(!cache.access(0)); // a miss: line 0 is brought in
/// assert!(cache.access(63)); // the same line
/// assert!(!cache.access(128)); // line 2 takes its place
/// assert!(!cache.access(0));
/// assert_eq!((cache.hits(), cache.misses()), (1, 3));
/// # Ok::<(), hwmodel::memory::CacheError>(())
/// ```
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

/// An empty place.
const NONE: u64 = u64::MAX;
const MAX_LINES: u64 = 1 << 28;

impl Cache {
    /// An empty cache.
    ///
    /// # Errors
    /// When the size is not a whole number of sets, at least one, or above 2^28 lines; when `ways` is not 1 to 65535 or
    /// `line_bytes` is 0.
    pub fn new(size_bytes: u64, ways: u32, line_bytes: u32) -> Result<Self, CacheError> {
        if line_bytes == 0 {
            return Err(CacheError::NoLine);
        }
        if ways == 0 || ways > 65535 {
            return Err(CacheError::Ways(ways));
        }
        let set_bytes = u64::from(ways) * u64::from(line_bytes);
        if size_bytes == 0 || !size_bytes.is_multiple_of(set_bytes) {
            return Err(CacheError::Sets {
                size_bytes,
                ways,
                line_bytes,
            });
        }
        let lines = size_bytes / u64::from(line_bytes);
        if lines > MAX_LINES {
            return Err(CacheError::TooLarge(lines));
        }
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

    /// Hits divided by accesses, 0..=1; `None` before the first access.
    pub fn hit_rate(&self) -> Option<f64> {
        let accesses = self.hits + self.misses;
        (accesses > 0).then(|| self.hits as f64 / accesses as f64)
    }
}
