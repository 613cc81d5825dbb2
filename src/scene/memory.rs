//! How much memory there is, and how many voxels may be gathered in it.

/// Bytes a voxel that building in memory takes at the least: 20 while it is
/// pushed and sorted, 5 in the graph. Surfaces take 29 (`spec/graph.md`).
const LEAST_BYTES: u64 = 25;

/// Memory that this process can still take, bytes; none where the system does not report it.
#[must_use]
pub fn available() -> Option<u64> {
    let info = std::fs::read_to_string("/proc/meminfo").ok()?;
    let free = mem_available(&info)?;
    // A container may have less than its machine.
    let read = |name: &str| -> Option<u64> {
        let text = std::fs::read_to_string(format!("/sys/fs/cgroup/{name}")).ok()?;
        text.trim().parse().ok()
    };
    let granted = read("memory.max").map(|max| {
        let used = read("memory.current").unwrap_or(0);
        max.saturating_sub(used)
    });
    Some(granted.map_or(free, |granted| granted.min(free)))
}

fn mem_available(info: &str) -> Option<u64> {
    let line = info
        .lines()
        .find(|line| line.starts_with("MemAvailable:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// Most voxels that can be built in so many bytes.
pub(super) fn most_voxels(bytes: u64) -> u64 {
    bytes / LEAST_BYTES
}

/// Bytes that building so many voxels takes at the least.
pub(super) fn least_bytes(voxels: u64) -> u64 {
    voxels.saturating_mul(LEAST_BYTES)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn available_memory_is_read() {
        let info = "MemTotal:       24689932 kB\nMemAvailable:   24055212 kB\n";
        assert_eq!(mem_available(info), Some(24_055_212 * 1024));
        for broken in ["", "MemAvailable:", "MemAvailable: x kB"] {
            assert_eq!(mem_available(broken), None, "{broken}");
        }
    }
}
