//! Checks of memory and disk space before they are used, for objects whose size depends on a file or a flag.

use std::fmt;
use std::path::{Path, PathBuf};

/// Too little memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, thiserror::Error)]
pub struct Shortage {
    /// The object's name.
    pub what: &'static str,
    /// Least bytes that it needs.
    pub needed: u64,
    /// Free bytes; `None` if the system does not report them.
    pub free: Option<u64>,
}

impl fmt::Display for Shortage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, needed, free } = self;
        write!(f, "{what}: at least {needed} bytes of memory are needed, ")?;
        match free {
            Some(free) => write!(f, "and {free} are free"),
            None => write!(f, "and the system has refused them"),
        }
    }
}

/// Fails if an object needs more memory than the system reports as free.
pub fn check(what: &'static str, needed: u64) -> Result<(), Shortage> {
    match available() {
        Some(free) if needed > free => Err(Shortage {
            what,
            needed,
            free: Some(free),
        }),
        _ => Ok(()),
    }
}

#[derive(Debug, Clone, PartialEq, Eq, Hash, thiserror::Error)]
#[error("{}: {needed} bytes of disk are needed, and {free} are free", folder.display())]
pub struct DiskShortage {
    pub folder: PathBuf,
    pub needed: u64,
    pub free: u64,
}

/// Fails if files in a folder, which need not exist, need more than the system reports as free on its disk.
pub fn check_disk(folder: &Path, needed: u64) -> Result<(), DiskShortage> {
    match free_disk(folder) {
        Some(free) if needed > free => Err(DiskShortage {
            folder: folder.to_owned(),
            needed,
            free,
        }),
        _ => Ok(()),
    }
}

/// Bytes that can be written in a folder. `None` if the system does not report them.
pub fn free_disk(folder: &Path) -> Option<u64> {
    #[cfg(unix)]
    {
        let mut of = folder
            .ancestors()
            .map(|above| match above.as_os_str().is_empty() {
                true => Path::new("."),
                false => above,
            });
        let found = of.find_map(|above| rustix::fs::statvfs(above).ok())?;
        Some(found.f_bavail.saturating_mul(found.f_frsize))
    }
    #[cfg(not(unix))]
    {
        let _ = folder;
        None
    }
}

/// An empty list with capacity for so many items. Errors: [`Shortage`] if the system refuses it.
pub fn room<T>(what: &'static str, items: usize) -> Result<Vec<T>, Shortage> {
    let mut list = Vec::new();
    let refused = |_| refused::<T>(what, items);
    list.try_reserve_exact(items).map_err(refused)?;
    Ok(list)
}

#[cold]
pub(crate) fn refused<T>(what: &'static str, items: usize) -> Shortage {
    Shortage {
        what,
        needed: (items as u64).saturating_mul(size_of::<T>() as u64),
        free: available(),
    }
}

/// A list of equal items. Errors: [`Shortage`] if the system refuses it.
pub fn filled<T: Clone>(what: &'static str, item: T, items: usize) -> Result<Vec<T>, Shortage> {
    let mut list = room(what, items)?;
    list.resize(items, item);
    Ok(list)
}

/// Memory that this process can still take, bytes, if it is reported. It is the least of the computer's free memory, the limit of the process's container (Linux: control groups), and the rest of
/// a limited address space (`ulimit -v`).
pub fn available() -> Option<u64> {
    let read = |name: &str| std::fs::read_to_string(name).ok();
    let free = kibibytes_of(&read("/proc/meminfo")?, "MemAvailable:")?;
    let number = |name: &str| read(name)?.trim().parse::<u64>().ok();
    let granted = number("/sys/fs/cgroup/memory.max").map(|max| {
        let used = number("/sys/fs/cgroup/memory.current").unwrap_or(0);
        max.saturating_sub(used)
    });
    let addresses = read("/proc/self/limits").as_deref().and_then(address_space);
    let left = addresses.map(|most| {
        let status = read("/proc/self/status").unwrap_or_default();
        most.saturating_sub(kibibytes_of(&status, "VmSize:").unwrap_or(0))
    });
    [granted, left].into_iter().flatten().chain([free]).min()
}

/// Resident memory of this process, bytes. `None` if the system does not report it.
pub fn resident() -> Option<u64> {
    kibibytes_of(&status()?, "VmRSS:")
}

/// The part of [`resident`] that is pages of mapped files.
pub fn resident_files() -> Option<u64> {
    let status = status()?;
    let of = |name: &str| kibibytes_of(&status, name);
    Some(of("RssFile:")? + of("RssShmem:")?)
}

fn status() -> Option<String> {
    std::fs::read_to_string("/proc/self/status").ok()
}

fn kibibytes_of(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    kibibytes.checked_mul(1024)
}

/// The process's limit of address space, bytes.
fn address_space(limits: &str) -> Option<u64> {
    let mut lines = limits.lines();
    let line = lines.find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_had_is_reported_with_figures() {
        let info = "MemTotal:       24689932 kB\nMemAvailable:   24055212 kB\n";
        assert_eq!(kibibytes_of(info, "MemAvailable:"), Some(24_055_212 * 1024));
        assert_eq!(kibibytes_of("MemAvailable: x kB", "MemAvailable:"), None);
        let limits = "Limit  Soft\nMax address space         1024 9 bytes\n";
        assert_eq!(address_space(limits), Some(1024));
        assert_eq!(address_space(&limits.replace("1024", "unlimited")), None);
        let error = filled("a test", 7u64, usize::MAX / 8).expect_err("too large");
        assert_eq!(error.needed, usize::MAX as u64 / 8 * 8);
        assert_eq!(filled("a test", 7u8, 3), Ok(vec![7; 3]));
        assert!(check("a test", u64::MAX).is_err() || available().is_none());
        assert_eq!(check("a test", 1), Ok(()));
        let below = std::env::temp_dir().join("not/there");
        assert_eq!(check_disk(&below, 1), Ok(()));
        let short = check_disk(&below, u64::MAX);
        assert!(
            cfg!(not(unix)) || short.is_err_and(|short| short.free > 0 && short.folder == below)
        );
    }
}
