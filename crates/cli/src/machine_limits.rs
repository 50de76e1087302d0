//! What a machine has left: memory and room on a disk, asked before the work.

use std::path::Path;

/// Bytes of memory that this process may still have: what the system says is available, and what a control group leaves.
#[cfg(target_os = "linux")]
pub(crate) fn memory_available() -> Option<u64> {
    let read = |path: &str| std::fs::read_to_string(path).ok();
    let line = |text: String, name: &str| {
        let line =
            text.lines().find_map(|line| line.strip_prefix(name))?.trim().trim_end_matches("kB").trim().to_owned();
        line.parse::<u64>().ok()
    };
    let system = read("/proc/meminfo").and_then(|text| line(text, "MemAvailable:")).map(|kb| kb * 1024);
    // "max" where there is no limit, which is no number.
    let number = |path: &str| read(path).and_then(|text| text.trim().parse::<u64>().ok());
    let group = number("/sys/fs/cgroup/memory.max")
        .map(|most| most.saturating_sub(number("/sys/fs/cgroup/memory.current").unwrap_or(0)));
    system.into_iter().chain(group).min()
}

/// Not known on other systems.
#[cfg(not(target_os = "linux"))]
pub(crate) fn memory_available() -> Option<u64> {
    None
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
