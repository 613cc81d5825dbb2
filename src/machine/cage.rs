//! Cages (`SPEC.md`, R4): one coordinate of a voxel's eight projected vertices, as eight corners (the image-order
//! paper) or as one corner and three edges. A cage has two in screen space (x, y), three in clip space (X, Y, W).

use hwmodel::{Datapath, Probe, Signal, Wires, Word};

/// With the type of a set-up's cage coordinates.
macro_rules! with_cage {
    ($setup:expr, $coordinate:ident => $body:expr) => {
        match $setup.options.cage {
            $crate::project::CageKind::Corners => {
                type $coordinate = $crate::machine::cage::Corners;
                $body
            }
            $crate::project::CageKind::Frame => {
                type $coordinate = $crate::machine::cage::CornerAndEdges;
                $body
            }
        }
    };
}
pub(super) use with_cage;

pub(super) trait Linear: Copy + std::fmt::Debug + Wires {
    /// Applies a linear function to each number.
    fn map(&self, f: impl FnMut(Word) -> Word) -> Self;

    /// Applies a linear function to each pair of numbers.
    fn zip(&self, other: &Self, f: impl FnMut(Word, Word) -> Word) -> Self;
}

pub(super) trait CageCoordinate: Linear {
    /// Of a parallelepiped with this corner and these edges (along x, y, z).
    fn from_frame<P: Probe>(dp: &mut Datapath<P>, corner: Word, edges: [Word; 3]) -> Self;

    /// All numbers of the children.
    type Pool: Copy;

    /// The children's vertices lie between this coordinate's least and greatest.
    fn pool<P: Probe>(&self, dp: &mut Datapath<P>) -> Self::Pool;

    /// One child's; no operation.
    fn child(pool: &Self::Pool, octant: usize) -> Self;

    /// Numbers for making children one at a time.
    type Seed: Copy;

    fn seed<P: Probe>(&self, dp: &mut Datapath<P>) -> Self::Seed;

    fn grow<P: Probe>(dp: &mut Datapath<P>, seed: &Self::Seed, octant: usize) -> Self;

    fn all(pool: &Self::Pool) -> [Self; 8] {
        std::array::from_fn(|octant| Self::child(pool, octant))
    }

    fn span<P: Probe>(&self, dp: &mut Datapath<P>) -> (Word, Word);

    /// Of the lowest and the highest corner, rounded down.
    fn centre<P: Probe>(&self, dp: &mut Datapath<P>) -> Word;

    fn vertices<P: Probe>(&self, dp: &mut Datapath<P>) -> [Word; 8];

    /// The edges from the lowest corner along x, y, z.
    fn edges<P: Probe>(&self, dp: &mut Datapath<P>) -> [Word; 3];

    /// The parent's coordinate: undoes exact halving.
    fn of_parent<P: Probe>(&self, dp: &mut Datapath<P>, octant: u8) -> Self;

    fn moved<P: Probe>(&self, dp: &mut Datapath<P>, by: Word) -> Self;

    /// Of the vertices' quotients `x / w`, by `divide`.
    fn project<P: Probe>(
        dp: &mut Datapath<P>,
        x: &Self,
        w: &Self,
        divide: impl FnMut(&mut Datapath<P>, Word, Word) -> Word,
    ) -> Self;
}

/// The eight vertices, in Morton order, of a corner and three edges: seven adds.
#[inline]
fn parallelepiped<P: Probe>(dp: &mut Datapath<P>, corner: Word, [x, y, z]: [Word; 3]) -> [Word; 8] {
    let mut v = [corner; 8];
    v[4] = dp.add(v[0], x);
    v[2] = dp.add(v[0], y);
    v[6] = dp.add(v[4], y);
    for low in [0, 2, 4, 6] {
        v[low + 1] = dp.add(v[low], z);
    }
    v
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Numbers<const N: usize>([Word; N]);

/// Eight corners in Morton order (`x << 2 | y << 1 | z`).
pub(super) type Corners = Numbers<8>;

/// One corner and the three edges that leave it along x, y, z.
pub(super) type CornerAndEdges = Numbers<4>;

impl<const N: usize> Wires for Numbers<N> {
    fn show(&self, to: &mut Vec<Signal>) {
        self.0.show(to);
    }
}

impl<const N: usize> Linear for Numbers<N> {
    #[inline]
    fn map(&self, f: impl FnMut(Word) -> Word) -> Self {
        Self(self.0.map(f))
    }

    #[inline]
    fn zip(&self, other: &Self, mut f: impl FnMut(Word, Word) -> Word) -> Self {
        Self(std::array::from_fn(|i| f(self.0[i], other.0[i])))
    }
}

impl CageCoordinate for Corners {
    type Pool = [Word; 27];

    fn from_frame<P: Probe>(dp: &mut Datapath<P>, corner: Word, edges: [Word; 3]) -> Self {
        Self(parallelepiped(dp, corner, edges))
    }

    /// The image-order paper's 27-vertex pool (3.4): midpoints along x, then y, then z. The order is normative, as they
    /// are rounded down.
    #[inline]
    fn pool<P: Probe>(&self, dp: &mut Datapath<P>) -> [Word; 27] {
        // pool[9 * i + 3 * j + k], i, j, k in 0..3 along x, y, z.
        let mut pool = [Word::ZERO; 27];
        for (corner, &value) in self.0.iter().enumerate() {
            let (i, j, k) = (corner >> 2, corner >> 1 & 1, corner & 1);
            pool[18 * i + 6 * j + 2 * k] = value; // host: an index
        }
        for j in [0, 2] {
            for k in [0, 2] {
                let at = 3 * j + k; // host: an index
                pool[9 + at] = dp.midpoint(pool[at], pool[18 + at]);
            }
        }
        for i in 0..3 {
            for k in [0, 2] {
                let at = 9 * i + k; // host: an index
                pool[at + 3] = dp.midpoint(pool[at], pool[at + 6]);
            }
        }
        for i in 0..3 {
            for j in 0..3 {
                let at = 9 * i + 3 * j; // host: an index
                pool[at + 1] = dp.midpoint(pool[at], pool[at + 2]);
            }
        }
        pool
    }

    type Seed = [Word; 27];

    fn seed<P: Probe>(&self, dp: &mut Datapath<P>) -> Self::Seed {
        self.pool(dp)
    }

    fn grow<P: Probe>(_: &mut Datapath<P>, seed: &Self::Seed, octant: usize) -> Self {
        Self::child(seed, octant)
    }

    #[inline]
    fn child(pool: &[Word; 27], octant: usize) -> Self {
        // Index of the child's lowest corner, masked to avoid a bounds check.
        const LOWEST: [u8; 8] = [0, 1, 3, 4, 9, 10, 12, 13];
        let low = usize::from(LOWEST[octant & 7]);
        Self(std::array::from_fn(|corner| {
            let (a, b, c) = (corner >> 2, corner >> 1 & 1, corner & 1);
            pool[low + 9 * a + 3 * b + c] // host: an index
        }))
    }

    #[inline]
    fn span<P: Probe>(&self, dp: &mut Datapath<P>) -> (Word, Word) {
        let mut around = |a: (Word, Word), b: (Word, Word)| (dp.min(a.0, b.0), dp.max(a.1, b.1));
        let [a, b, c, d, e, f, g, h] = self.0.map(|corner| (corner, corner));
        let (ab, cd, ef, gh) = (around(a, b), around(c, d), around(e, f), around(g, h));
        let (abcd, efgh) = (around(ab, cd), around(ef, gh));
        around(abcd, efgh)
    }

    #[inline]
    fn centre<P: Probe>(&self, dp: &mut Datapath<P>) -> Word {
        dp.midpoint(self.0[0], self.0[7])
    }

    #[inline]
    fn vertices<P: Probe>(&self, _: &mut Datapath<P>) -> [Word; 8] {
        self.0
    }

    #[inline]
    fn edges<P: Probe>(&self, dp: &mut Datapath<P>) -> [Word; 3] {
        [4, 2, 1].map(|end| dp.sub(self.0[end], self.0[0]))
    }

    /// The vertex of the octant stays; all others are twice as far from it.
    fn of_parent<P: Probe>(&self, dp: &mut Datapath<P>, octant: u8) -> Self {
        let shared = self.0[usize::from(octant & 7)];
        Self(std::array::from_fn(|corner| {
            if corner == usize::from(octant & 7) {
                return shared;
            }
            let doubled = dp.shl(self.0[corner], 1);
            dp.sub(doubled, shared)
        }))
    }

    fn moved<P: Probe>(&self, dp: &mut Datapath<P>, by: Word) -> Self {
        Self(self.0.map(|value| dp.add(value, by)))
    }

    fn project<P: Probe>(
        dp: &mut Datapath<P>,
        x: &Self,
        w: &Self,
        mut divide: impl FnMut(&mut Datapath<P>, Word, Word) -> Word,
    ) -> Self {
        x.zip(w, |x, w| divide(dp, x, w))
    }
}

impl CageCoordinate for CornerAndEdges {
    /// The children's lowest corners, and their edges.
    type Pool = ([Word; 8], [Word; 3]);

    fn from_frame<P: Probe>(_: &mut Datapath<P>, corner: Word, [x, y, z]: [Word; 3]) -> Self {
        Self([corner, x, y, z])
    }

    #[inline]
    fn pool<P: Probe>(&self, dp: &mut Datapath<P>) -> Self::Pool {
        let Self([corner, edges @ ..]) = self.seed(dp);
        (parallelepiped(dp, corner, edges), edges)
    }

    type Seed = Self;

    /// Halves edges towards zero, so that children stay within their parent.
    #[inline]
    fn seed<P: Probe>(&self, dp: &mut Datapath<P>) -> Self {
        let Self([corner, edges @ ..]) = *self;
        let [x, y, z] = edges.map(|edge| {
            let sign = Word::from_host(i64::from(dp.bit(edge, 63)));
            dp.midpoint(edge, sign)
        });
        Self([corner, x, y, z])
    }

    #[inline]
    fn grow<P: Probe>(dp: &mut Datapath<P>, seed: &Self, octant: usize) -> Self {
        let Self([mut corner, x, y, z]) = *seed;
        for (k, edge) in [x, y, z].into_iter().enumerate() {
            if octant >> (2 - k) & 1 != 0 {
                corner = dp.add(corner, edge);
            }
        }
        Self([corner, x, y, z])
    }

    #[inline]
    fn child(&(corners, [x, y, z]): &Self::Pool, octant: usize) -> Self {
        Self([corners[octant & 7], x, y, z])
    }

    #[inline]
    fn span<P: Probe>(&self, dp: &mut Datapath<P>) -> (Word, Word) {
        let Self([corner, edges @ ..]) = *self;
        let (mut low, mut high) = (corner, corner);
        for edge in edges {
            let below = dp.min(edge, Word::ZERO);
            let above = dp.max(edge, Word::ZERO);
            low = dp.add(low, below);
            high = dp.add(high, above);
        }
        (low, high)
    }

    #[inline]
    fn centre<P: Probe>(&self, dp: &mut Datapath<P>) -> Word {
        let Self([corner, x, y, z]) = *self;
        let xy = dp.add(x, y);
        let half = dp.midpoint(xy, z);
        dp.add(corner, half)
    }

    #[inline]
    fn vertices<P: Probe>(&self, dp: &mut Datapath<P>) -> [Word; 8] {
        let Self([corner, edges @ ..]) = *self;
        parallelepiped(dp, corner, edges)
    }

    #[inline]
    fn edges<P: Probe>(&self, _: &mut Datapath<P>) -> [Word; 3] {
        let Self([_, edges @ ..]) = *self;
        edges
    }

    fn of_parent<P: Probe>(&self, dp: &mut Datapath<P>, octant: u8) -> Self {
        let Self([mut corner, edges @ ..]) = *self;
        for (k, edge) in edges.into_iter().enumerate() {
            if octant >> (2 - k) & 1 != 0 {
                corner = dp.sub(corner, edge);
            }
        }
        let [x, y, z] = edges.map(|edge| dp.shl(edge, 1));
        Self([corner, x, y, z])
    }

    fn moved<P: Probe>(&self, dp: &mut Datapath<P>, by: Word) -> Self {
        let Self([corner, x, y, z]) = *self;
        Self([dp.add(corner, by), x, y, z])
    }

    /// Divides for four of the eight vertices; the edges are differences.
    fn project<P: Probe>(
        dp: &mut Datapath<P>,
        x: &Self,
        w: &Self,
        mut divide: impl FnMut(&mut Datapath<P>, Word, Word) -> Word,
    ) -> Self {
        let corner = divide(dp, x.0[0], w.0[0]);
        let [a, b, c] = [1, 2, 3].map(|k| {
            let end_x = dp.add(x.0[0], x.0[k]);
            let end_w = dp.add(w.0[0], w.0[k]);
            let end = divide(dp, end_x, end_w);
            dp.sub(end, corner)
        });
        Self([corner, a, b, c])
    }
}
