//! What Linux tells of memory: of the machine, of control groups of both versions, of the limit of a process.

use std::{fs, path::Path};

/// The least of what all of them leave.
pub(super) fn left() -> Option<u64> {
    [available(), of_groups(), of_address_space()].into_iter().flatten().min()
}

/// Without swapping, of the whole machine.
fn available() -> Option<u64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

/// Where the control groups of a version are, and what their files are called.
struct Groups {
    root: &'static str,
    most: &'static str,
    taken: &'static str,
    /// In `memory.stat`: of files, which the system drops if it needs the memory.
    dropped: &'static str,
}

/// What the control groups leave, which are one in the other.
fn of_groups() -> Option<u64> {
    let own = fs::read_to_string("/proc/self/cgroup").ok()?;
    let groups = own.lines().filter_map(|line| {
        let (_, line) = line.split_once(':')?;
        let (controllers, path) = line.split_once(':')?;
        let groups = if controllers.is_empty() {
            let [most, taken] = ["memory.max", "memory.current"];
            Groups { root: "/sys/fs/cgroup", most, taken, dropped: "inactive_file" }
        } else if controllers.split(',').any(|controller| controller == "memory") {
            let [most, taken] = ["memory.limit_in_bytes", "memory.usage_in_bytes"];
            Groups { root: "/sys/fs/cgroup/memory", most, taken, dropped: "total_inactive_file" }
        } else {
            return None;
        };
        groups.left(Path::new(path))
    });
    groups.min()
}

impl Groups {
    /// What a group and those above it leave, as far as they are seen: a container may see its own alone, as the root.
    fn left(&self, path: &Path) -> Option<u64> {
        let all = path.ancestors().filter_map(|path| path.strip_prefix("/").ok());
        all.filter_map(|path| self.left_in(&Path::new(self.root).join(path))).min()
    }

    fn left_in(&self, group: &Path) -> Option<u64> {
        let read = |name: &str| fs::read_to_string(group.join(name)).ok();
        let number = |text: &str| text.trim().parse::<u64>().ok();
        let (most, taken) = (number(&read(self.most)?)?, number(&read(self.taken)?)?);
        let stat = read("memory.stat").unwrap_or_default();
        let dropped = stat.lines().find_map(|line| number(line.strip_prefix(self.dropped)?));
        Some(most.saturating_sub(taken.saturating_sub(dropped.unwrap_or(0))))
    }
}

/// What the limit of the address space leaves.
fn of_address_space() -> Option<u64> {
    use rustix::{
        param::page_size,
        process::{Resource, getrlimit},
    };
    let most = getrlimit(Resource::As).current?;
    let text = fs::read_to_string("/proc/self/statm").ok()?;
    let pages: u64 = text.split_whitespace().next()?.parse().ok()?;
    Some(most.saturating_sub(pages.saturating_mul(page_size() as u64)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_memory_is_left_and_not_all() {
        let left = left().unwrap();
        let text = fs::read_to_string("/proc/meminfo").unwrap();
        let all = text.lines().find_map(|line| line.strip_prefix("MemTotal:")).unwrap();
        let all: u64 = all.trim().trim_end_matches("kB").trim().parse().unwrap();
        assert!(left > 1 << 20 && left < all * 1024, "{left} of {all} kB");
    }

    /// A group within another, written as the system writes them: the tighter one counts, and no group that cannot be read.
    #[test]
    fn the_tightest_group_counts() {
        let root = tempfile::tempdir().unwrap();
        let inner = root.path().join("jobs/one");
        fs::create_dir_all(&inner).unwrap();
        let put = |folder: &Path, files: [(&str, &str); 3]| {
            for (name, text) in files {
                fs::write(folder.join(name), text).unwrap();
            }
        };
        let groups = Groups {
            root: Box::leak(root.path().to_str().unwrap().to_owned().into_boxed_str()),
            most: "memory.max",
            taken: "memory.current",
            dropped: "inactive_file",
        };
        let found = || groups.left(Path::new("/jobs/one"));
        assert_eq!(found(), None);
        put(
            root.path(),
            [("memory.max", "1000\n"), ("memory.current", "700\n"), ("memory.stat", "")],
        );
        assert_eq!(found(), Some(300));
        let stat = "anon 500\ninactive_file 150\n";
        put(&inner, [("memory.max", "800\n"), ("memory.current", "700\n"), ("memory.stat", stat)]);
        assert_eq!(found(), Some(250));
        put(&inner, [("memory.max", "max\n"), ("memory.current", "700\n"), ("memory.stat", stat)]);
        assert_eq!(found(), Some(300));
        put(&inner, [("memory.max", "5\n"), ("memory.current", "700\n"), ("memory.stat", stat)]);
        assert_eq!(found(), Some(0));
    }
}
