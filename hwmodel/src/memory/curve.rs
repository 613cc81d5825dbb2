//! Miss curves by stack distances (Mattson et al., "Evaluation techniques for storage hierarchies", IBM Systems Journal
//! 1970). A fully associative LRU cache of `c` lines has a line exactly if fewer than `c` others were used since.

use serde::{Deserialize, Serialize};

use crate::hash::NumberMap;

/// One size of cache, in lines and bytes, and its misses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "names of the other fields say what they are")]
pub struct MissPoint {
    pub lines: u64,
    pub bytes: u64,
    pub misses: u64,
    /// `misses` divided by accesses, 0 to 1; 0 without accesses.
    pub miss_rate: f64,
}

/// Misses of caches of all sizes, from one pass over the accesses.
///
/// ```
/// use hwmodel::memory::MissCurve;
///
/// let mut curve = MissCurve::new(32); // lines of 32 bytes
/// for _ in 0..10 {
///     for node in 0..3 {
///         curve.access(node * 32, 8);
///     }
/// }
/// // Three lines in turn: two are never enough, three always.
/// assert_eq!((curve.misses(2), curve.misses(3)), (30, 3));
/// ```
#[derive(Debug, Clone)]
pub struct MissCurve {
    line_bytes: u32,
    last: NumberMap<u64, u32>,
    /// Binary indexed tree over times: 1 where a line was last accessed then.
    tree: Vec<u32>,
    now: u32,
    distances: Vec<u64>,
    newest: Option<u64>,
    accesses: u64,
}

const FIRST_TIMES: usize = 1 << 12;

impl MissCurve {
    /// An empty curve for lines of `line_bytes`, at least 1.
    pub fn new(line_bytes: u32) -> Self {
        Self {
            line_bytes: line_bytes.max(1),
            last: NumberMap::default(),
            tree: vec![0; FIRST_TIMES],
            now: 0,
            distances: Vec::new(),
            newest: None,
            accesses: 0,
        }
    }

    /// Bytes of a line.
    pub fn line_bytes(&self) -> u32 {
        self.line_bytes
    }

    /// Accesses each line of `bytes` bytes, at least one.
    pub fn access(&mut self, byte_address: u64, bytes: u64) {
        let line_bytes = u64::from(self.line_bytes);
        let end = byte_address.saturating_add(bytes.saturating_sub(1));
        for line in byte_address / line_bytes..=end / line_bytes {
            self.access_line(line);
        }
    }

    fn access_line(&mut self, line: u64) {
        self.accesses += 1;
        if self.newest == Some(line) {
            self.note(0);
            return;
        }
        self.newest = Some(line);
        if self.now as usize + 1 == self.tree.len() {
            self.renumber();
        }
        let now = self.now;
        self.now += 1;
        if let Some(before) = self.last.insert(line, now) {
            // Lines accessed since: all less those last accessed up to `before`.
            let distance = self.last.len() as u64 - u64::from(self.marks_up_to(before));
            self.note(distance as usize);
            self.mark(before, 0u32.wrapping_sub(1));
        }
        self.mark(now, 1);
    }

    fn note(&mut self, distance: usize) {
        if self.distances.len() <= distance {
            self.distances.resize(distance + 1, 0);
        }
        self.distances[distance] += 1;
    }

    fn mark(&mut self, time: u32, add: u32) {
        let mut at = time as usize + 1;
        while let Some(sum) = self.tree.get_mut(at) {
            *sum = sum.wrapping_add(add);
            at += at & at.wrapping_neg();
        }
    }

    fn marks_up_to(&self, time: u32) -> u32 {
        let mut at = time as usize + 1;
        let mut sum = 0u32;
        while at > 0 {
            sum = sum.wrapping_add(self.tree[at]);
            at &= at - 1;
        }
        sum
    }

    /// Numbers the last accesses from 0 again.
    fn renumber(&mut self) {
        let mut times: Vec<&mut u32> = self.last.values_mut().collect();
        times.sort_unstable();
        for (new, time) in (0u32..).zip(&mut times) {
            **time = new;
        }
        let lines = times.len();
        self.now = lines as u32;
        self.tree.clear();
        self.tree.resize((4 * lines).max(FIRST_TIMES), 0);
        for time in 0..self.now {
            self.mark(time, 1);
        }
    }

    /// One that spans lines counts once per line.
    pub fn accesses(&self) -> u64 {
        self.accesses
    }

    /// Number of different lines.
    pub fn distinct_lines(&self) -> u64 {
        self.last.len() as u64
    }

    /// Misses of a fully associative cache of so many lines.
    pub fn misses(&self, lines: u64) -> u64 {
        let kept = usize::try_from(lines).unwrap_or(usize::MAX);
        let far = self.distances.iter().skip(kept);
        self.distinct_lines() + far.sum::<u64>()
    }

    /// The curve at 1, 2, 4, ... lines, up to a size that holds all.
    pub fn points(&self) -> Vec<MissPoint> {
        let sizes = (0..).map(|power| 1 << power);
        let last = self.distinct_lines().max(1).next_power_of_two();
        sizes
            .take_while(|&lines| lines <= last)
            .map(|lines| {
                let misses = self.misses(lines);
                MissPoint {
                    lines,
                    bytes: lines * u64::from(self.line_bytes),
                    misses,
                    miss_rate: misses as f64 / self.accesses.max(1) as f64,
                }
            })
            .collect()
    }
}
