//! Clusters of 4^3 voxels, and the 8^3 voxels around one.

/// The voxels around a cluster, `[z][y]`, bit x; the cluster's own are 2 to 5 along each axis.
pub(in crate::graph) type Surroundings = [[u8; 8]; 8];

/// Occupancy of 4^3 voxels, in two orders.
#[derive(Debug, Clone, Copy)]
pub(in crate::graph) struct Cluster {
    pub(in crate::graph) morton: u64,
    /// Bit `z * 16 + y * 4 + x`.
    pub(in crate::graph) by_rows: u64,
}

impl From<u64> for Cluster {
    fn from(morton: u64) -> Self {
        Self {
            morton,
            by_rows: to_rows(morton),
        }
    }
}

pub(super) const MORTON_TO_XYZ: [[usize; 3]; 64] = {
    let mut table = [[0; 3]; 64];
    let mut bit = 0;
    while bit < 64 {
        let mut axis = 0;
        while axis < 3 {
            table[bit][axis] = (bit >> (5 - axis) & 1) << 1 | (bit >> (2 - axis) & 1);
            axis += 1;
        }
        bit += 1;
    }
    table
};

fn to_rows(word: u64) -> u64 {
    let mut rows = 0u64;
    let mut left = word;
    while left != 0 {
        let [x, y, z] = MORTON_TO_XYZ[left.trailing_zeros() as usize];
        rows |= 1 << (z * 16 + y * 4 + x);
        left &= left - 1;
    }
    rows
}

/// Puts cluster `(x * 3 + y) * 3 + z` of the 27 in and around the surroundings' middle into its place.
#[inline]
pub(in crate::graph) fn put(rows: &mut Surroundings, neighbour: usize, cluster_rows: u64) {
    const SPAN: [(usize, usize, usize); 3] = [(0, 2, 2), (2, 0, 4), (6, 0, 2)];
    let (to_x, from_x, count_x) = SPAN[neighbour / 9];
    let (to_y, from_y, _) = SPAN[neighbour / 3 % 3];
    let (to_z, from_z, count_z) = SPAN[neighbour % 3];
    let keep = ((1u64 << count_x) - 1) * 0x0101_0101;
    for k in 0..count_z {
        // A plane's four rows, each in a byte. Shifts drop those out of the surroundings.
        let rows_of_two = cluster_rows >> (16 * (from_z + k)) & 0xffff;
        let rows_of_two = (rows_of_two | rows_of_two << 8) & 0x00ff_00ff;
        let four = (rows_of_two | rows_of_two << 4) & 0x0f0f_0f0f;
        let placed = (four >> from_x & keep) << to_x >> (8 * from_y) << (8 * to_y);
        let plane = &mut rows[to_z + k];
        *plane = (u64::from_le_bytes(*plane) | placed).to_le_bytes();
    }
}

/// Whether all six faces of a cluster's voxel are covered.
pub(super) fn enclosed(rows: &Surroundings, [x, y, z]: [usize; 3]) -> bool {
    let (y, z) = (y + 2, z + 2);
    let along_x = rows[z][y] >> (x + 1) & 0b101 == 0b101;
    let across = rows[z][y - 1] & rows[z][y + 1] & rows[z - 1][y] & rows[z + 1][y];
    along_x && across >> (x + 2) & 1 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One voxel in each neighbour, seen at its place in the surroundings.
    #[test]
    fn rows_of_the_surroundings_are_where_they_should_be() {
        for (neighbour, bit) in (0..27).flat_map(|n| (0..64).map(move |bit| (n, bit))) {
            let mut rows = Surroundings::default();
            put(&mut rows, neighbour, to_rows(1 << bit));
            let offset = [neighbour / 9, neighbour / 3 % 3, neighbour % 3];
            let at = [0, 1, 2].map(|k| (MORTON_TO_XYZ[bit][k] + 4 * offset[k]).wrapping_sub(2));
            let mut expected = Surroundings::default();
            if at.iter().all(|&c| c < 8) {
                expected[at[2]][at[1]] = 1 << at[0];
            }
            assert_eq!(rows, expected, "neighbour {neighbour} bit {bit}");
        }
    }
}
