//! What a machine has left: memory and room on a disk, asked before the work.

mod control_groups;

use std::path::Path;

/// Bytes of memory that this process may still have. Three limits count, and the least of them decides: the free memory of the system,
/// the limits of the process's control groups, and its own limit on data (`ulimit -d`). Known on Linux only.
pub(crate) fn memory_available() -> Option<u64> {
    let system = kibibytes("/proc/meminfo", "MemAvailable:");
    let groups = text("/proc/self/cgroup").zip(text("/proc/self/mountinfo"));
    let group = groups.and_then(|(groups, mounts)| control_groups::memory_left(&groups, &mounts, |path| text(path)));
    system.into_iter().chain(left_of("Max data size", "VmData:")).chain(group).min()
}

/// Bytes that the process's own limit on its address space leaves (`ulimit -v`); `None` without such a limit.
pub(crate) fn address_space_left() -> Option<u64> {
    left_of("Max address space", "VmSize:")
}

/// What a limit of the process leaves beside what it uses, bytes.
fn left_of(limit: &str, used: &str) -> Option<u64> {
    let limits = text("/proc/self/limits")?;
    // The word "unlimited" is no number.
    let line = limits.lines().find_map(|line| line.strip_prefix(limit))?;
    let most: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(most.saturating_sub(kibibytes("/proc/self/status", used).unwrap_or(0)))
}

/// The bytes of a line `name 12 kB`.
fn kibibytes(path: &str, name: &str) -> Option<u64> {
    let text = text(path)?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()? * 1024)
}

fn text(path: impl AsRef<Path>) -> Option<String> {
    std::fs::read_to_string(path).ok()
}

/// Bytes that may still be written where this file is to be, if the system tells.
#[cfg(unix)]
pub(crate) fn room_for(path: &Path) -> Option<u64> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // Devices and pipes take whatever comes.
    if std::fs::metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
        return None;
    }
    let room = rustix::fs::statvfs(folder).ok()?;
    Some(room.f_bavail.saturating_mul(room.f_frsize))
}

/// Not known on other systems.
#[cfg(not(unix))]
pub(crate) fn room_for(_: &Path) -> Option<u64> {
    None
}

/// Bytes in words: `512 B`, `3.4 MB`, `12.0 GB`.
pub(crate) fn bytes(bytes: u64) -> String {
    let value = bytes as f64;
    match value {
        _ if bytes < 1000 => format!("{bytes} B"),
        _ if value < 1e6 => format!("{:.1} kB", value / 1e3),
        _ if value < 1e9 => format!("{:.1} MB", value / 1e6),
        _ if value < 1e12 => format!("{:.1} GB", value / 1e9),
        _ => format!("{:.1} TB", value / 1e12),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_told_in_words() {
        for (size, text) in
            [(12, "12 B"), (3_400_000, "3.4 MB"), (12_000_000_000, "12.0 GB"), (2_500_000_000_000, "2.5 TB")]
        {
            assert_eq!(bytes(size), text);
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_machine_has_some_memory_and_a_folder_some_room() {
        assert!(memory_available().unwrap() > 0);
        assert!(room_for(&Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).unwrap() > 0);
        assert_eq!(room_for(Path::new("/dev/null")), None);
    }
}
