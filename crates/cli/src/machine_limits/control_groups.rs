//! The memory that the control groups of a process leave it, in both versions of control groups.

use std::path::{Path, PathBuf};

/// The files of one version: the limit of a group, and its use. `of_files` are the keys in `memory.stat` of cached files, whose memory
/// the kernel takes back when it is short.
struct Version {
    most: &'static str,
    used: &'static str,
    of_files: [&'static str; 2],
}

const V1: Version = Version {
    most: "memory.limit_in_bytes",
    used: "memory.usage_in_bytes",
    of_files: ["total_inactive_file", "total_active_file"],
};

const V2: Version = Version { most: "memory.max", used: "memory.current", of_files: ["inactive_file", "active_file"] };

/// Bytes that the tightest of the groups leaves, those above it included; `None` where none has a limit. `groups` is the text of
/// `/proc/self/cgroup`, `mounts` that of `/proc/self/mountinfo`, and `read` reads a file.
pub(super) fn memory_left(groups: &str, mounts: &str, read: impl Fn(&Path) -> Option<String>) -> Option<u64> {
    let number = |path: PathBuf| read(&path)?.trim().parse::<u64>().ok();
    let mut least = None;
    for (version, group) in groups.lines().filter_map(memory_group) {
        let Some((top, folder)) = mounts.lines().find_map(|line| folder(line, version, group)) else { continue };
        let files = if version == 1 { V1 } else { V2 };
        for folder in folder.ancestors().take_while(|folder| folder.starts_with(&top)) {
            // "max", where there is no limit, is no number.
            let Some(most) = number(folder.join(files.most)) else { continue };
            let used = number(folder.join(files.used)).unwrap_or(0);
            let stat = read(&folder.join("memory.stat")).unwrap_or_default();
            let of_files: u64 = stat.lines().filter_map(|line| line.split_once(' ')).fold(0, |sum, (key, value)| {
                let counts = files.of_files.contains(&key);
                sum + if counts { value.trim().parse().unwrap_or(0) } else { 0 }
            });
            let left = most.saturating_sub(used.saturating_sub(of_files));
            least = Some(least.map_or(left, |least: u64| least.min(left)));
        }
    }
    least
}

/// The version of a line of `/proc/self/cgroup` that limits memory, and its group: `0::/job` or `5:cpu,memory:/job`.
fn memory_group(line: &str) -> Option<(u8, &str)> {
    let mut parts = line.splitn(3, ':');
    let (number, controllers, group) = (parts.next()?, parts.next()?, parts.next()?);
    match controllers {
        "" if number == "0" => Some((2, group)),
        _ => controllers.split(',').any(|name| name == "memory").then_some((1, group)),
    }
}

/// Where a line of `/proc/self/mountinfo` shows a group: the top of what is mounted, and the group's folder in it. A container may
/// show a part of all groups only, from a root on, and the group by another name.
fn folder(line: &str, version: u8, group: &str) -> Option<(PathBuf, PathBuf)> {
    let (before, after) = line.split_once(" - ")?;
    let mut after = after.split(' ');
    let (kind, options) = (after.next()?, after.nth(1).unwrap_or_default());
    let fits = match version {
        1 => kind == "cgroup" && options.split(',').any(|option| option == "memory"),
        _ => kind == "cgroup2",
    };
    let mut before = before.split(' ').skip(3);
    let (root, top) = (before.next()?, PathBuf::from(before.next()?));
    let inside = Path::new(group).strip_prefix(root).unwrap_or(Path::new(""));
    fits.then(|| (top.clone(), top.join(inside)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOUNTS: &str = "\
24 30 0:22 / /proc rw,nosuid - proc proc rw
35 30 0:28 / /sys/fs/cgroup rw,nosuid shared:9 - cgroup2 cgroup2 rw,nsdelegate
36 30 0:29 / /sys/fs/cgroup/cpu rw - cgroup cgroup rw,cpu,cpuacct
37 30 0:30 / /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory
";

    fn left(groups: &str, mounts: &str, files: &[(&str, &str)]) -> Option<u64> {
        memory_left(groups, mounts, |path| {
            let found = files.iter().find(|(name, _)| path == Path::new(name));
            found.map(|(_, text)| (*text).to_owned())
        })
    }

    #[test]
    fn the_groups_own_limit_counts_and_those_above_it() {
        let own = [
            ("/sys/fs/cgroup/farm/job/memory.max", "1000\n"),
            ("/sys/fs/cgroup/farm/job/memory.current", "300\n"),
            ("/sys/fs/cgroup/farm/memory.max", "max\n"),
        ];
        assert_eq!(left("0::/farm/job\n", MOUNTS, &own), Some(700));
        let above = [("/sys/fs/cgroup/farm/memory.max", "2000\n"), ("/sys/fs/cgroup/farm/memory.current", "1900\n")];
        assert_eq!(left("0::/farm/job\n", MOUNTS, &[&own[..2], &above].concat()), Some(100));
        // What is left of a group that has more than its limit.
        assert_eq!(left("0::/farm\n", MOUNTS, &[above[0], ("/sys/fs/cgroup/farm/memory.current", "2001")]), Some(0));
        assert_eq!(left("0::/other\n", MOUNTS, &own), None);
        assert_eq!(left("", MOUNTS, &own), None);
    }

    #[test]
    fn memory_of_files_can_be_had_back() {
        let files = [
            ("/sys/fs/cgroup/job/memory.max", "1000"),
            ("/sys/fs/cgroup/job/memory.current", "900"),
            ("/sys/fs/cgroup/job/memory.stat", "anon 250\nfile 650\ninactive_file 400\nactive_file 200\n"),
        ];
        assert_eq!(left("0::/job\n", MOUNTS, &files), Some(700));
    }

    #[test]
    fn groups_of_version_1_are_found_by_their_controller() {
        let files = [
            ("/sys/fs/cgroup/memory/slurm/job_7/memory.limit_in_bytes", "5000"),
            ("/sys/fs/cgroup/memory/slurm/job_7/memory.usage_in_bytes", "1500"),
            ("/sys/fs/cgroup/memory/slurm/job_7/memory.stat", "inactive_file 9\ntotal_inactive_file 500\n"),
            ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712"),
        ];
        let groups = "12:cpu,cpuacct:/\n5:memory:/slurm/job_7\n0::/user.slice\n";
        assert_eq!(left(groups, MOUNTS, &files), Some(4000));
        assert_eq!(left("5:hugetlb,memory:/slurm/job_7\n", MOUNTS, &files), Some(4000));
        assert_eq!(left("5:cpu:/slurm/job_7\n", MOUNTS, &files), None);
    }

    #[test]
    fn a_container_shows_its_part_of_the_groups() {
        let mounts = "35 30 0:28 /docker/ab /sys/fs/cgroup ro - cgroup2 cgroup rw\n";
        let files = [("/sys/fs/cgroup/memory.max", "100"), ("/sys/fs/cgroup/job/memory.max", "60")];
        assert_eq!(left("0::/docker/ab\n", mounts, &files), Some(100));
        assert_eq!(left("0::/docker/ab/job\n", mounts, &files), Some(60));
        // A group outside of what is shown, as in a namespace of its own.
        assert_eq!(left("0::/\n", mounts, &files), Some(100));
    }
}
