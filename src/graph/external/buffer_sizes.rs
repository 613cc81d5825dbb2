use super::record::MAX_RUN;

const PROGRAM: u64 = 48 << 20;
const LEAST_READER: u64 = 64 << 10;
const MAX_FAN_IN: u64 = 256;
const CLUSTER_BYTES: u64 = 64 * 5 + 9 * 8 + 96;
/// Streams that may be open together: four for each of 21 levels, and a few.
const SPOOLS: u64 = 96;

const MAX_BLOCK_SHIFT: u32 = 7;

fn block_bytes(shift: u32) -> u64 {
    let side = 1u64 << shift;
    (side + 2).pow(3) * 8 + side.pow(3) * 16
}

/// Sizes of the buffers of an external build. First there are two buffers of voxels, then the readers of the merge and
/// the halo's buffer, and last the halo's readers, a block and a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct BufferSizes {
    pub(super) run_records: usize,
    pub(super) merge_bytes: usize,
    pub(super) fan_in: usize,
    pub(super) halo_records: usize,
    /// Blocks are `2^block_shift` clusters a side.
    pub(super) block_shift: u32,
    pub(super) chunk_clusters: usize,
    /// Bytes of a stream's buffer; whole items of 1, 2, 3, 4 and 16 bytes.
    pub(super) spool_bytes: usize,
}

impl BufferSizes {
    /// Divides `memory` bytes. Below some megabytes the program is larger than the limit, and buffers are smallest.
    pub(super) fn new(memory: u64) -> Self {
        let memory = memory - PROGRAM.min(memory / 4);
        let eighth = memory / 8;
        let block_shift = (0..=MAX_BLOCK_SHIFT)
            .rev()
            .find(|&shift| block_bytes(shift) <= eighth)
            .unwrap_or(0);
        Self {
            run_records: (3 * eighth / 16).clamp(2, MAX_RUN as u64) as usize,
            merge_bytes: (2 * eighth).min(512 << 20) as usize,
            fan_in: (2 * eighth / LEAST_READER).clamp(2, MAX_FAN_IN) as usize,
            halo_records: (eighth / 16).clamp(2, 1 << 22) as usize,
            block_shift,
            chunk_clusters: (eighth / CLUSTER_BYTES).clamp(1, 1 << 15) as usize,
            spool_bytes: (eighth / SPOOLS / 48 * 48).clamp(48, 48 << 12) as usize,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stage_stays_within_the_limit() {
        for memory in [64u64 << 20, 100 << 20, 512 << 20, 1 << 30, 64 << 30] {
            let sizes = BufferSizes::new(memory);
            let spools = SPOOLS * sizes.spool_bytes as u64;
            let merge = sizes.merge_bytes as u64;
            let pushing = 2 * 16 * sizes.run_records as u64;
            let merging = merge + 16 * sizes.halo_records as u64 + spools;
            let clusters = CLUSTER_BYTES * sizes.chunk_clusters as u64;
            let working = merge + block_bytes(sizes.block_shift) + clusters + spools;
            let most = pushing.max(merging).max(working);
            assert!(
                PROGRAM.min(memory / 4) + most <= memory,
                "{memory}: {sizes:?}"
            );
            assert!(merge / sizes.fan_in as u64 >= LEAST_READER);
        }
    }
}
