//! The memory that the machine and the limits of the process leave, as Linux tells it in files, or that a page may
//! have; elsewhere nothing is known, and nothing is refused.

use std::fs;

use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::decimal::number;
use crate::core::kernel::number::grouped;
use crate::core::progress::Need;
use crate::core::run::history::BUDGET;

/// Bytes that stay free: what a conversion needs is an estimate, and others need memory too.
const SPARE: f64 = 32e6;

/// What a command keeps in memory beside the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Beside {
    /// Nothing.
    Nothing,
    /// Data for viewing.
    Data,
    /// The states of so many runs, for going back.
    States(usize),
    /// Other conversions like this one, so many.
    Conversions(usize),
}

/// Bytes of the states of a run for each quadrilateral, as far as their budget reaches.
const STATES_PER_QUAD: f64 = 20e3;

impl Beside {
    /// Bytes beside the conversion itself.
    fn bytes(self, need: &Need) -> f64 {
        match self {
            Beside::Nothing | Beside::Data => 0.0,
            Beside::States(runs) => runs as f64 * (STATES_PER_QUAD * need.quads).min(BUDGET as f64),
            Beside::Conversions(others) => others as f64 * need.bytes(false),
        }
    }
}

/// Whether there is memory for what a conversion needs, with what is kept beside it.
///
/// # Errors
/// There is less: how much it needs, how much is free and why no more, and the size scale that would fit.
pub(super) fn allow(need: &Need, beside: Beside) -> Result<(), Fault> {
    Free::now(&|path| fs::read_to_string(path).ok()).map_or(Ok(()), |free| free.allow(need, beside))
}

/// Memory that is free.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Free {
    bytes: f64,
    /// What leaves no more.
    bound: Bound,
}

/// What WebAssembly can still address, of its 4 GiB; none elsewhere.
#[cfg(target_arch = "wasm32")]
fn page() -> Option<f64> {
    Some((65_536.0 - core::arch::wasm32::memory_size(0) as f64) * 65_536.0)
}

#[cfg(not(target_arch = "wasm32"))]
fn page() -> Option<f64> {
    None
}

/// What bounds the memory of a process.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bound {
    Machine,
    AddressSpace,
    Data,
    Group,
    Page,
}

impl Free {
    /// The least that anything leaves; `read` gives the text of a file, if there is one.
    fn now(read: &dyn Fn(&str) -> Option<String>) -> Option<Free> {
        let machine = || {
            let text = read("/proc/meminfo")?;
            Some(kilobytes(&text, "MemAvailable:")? + kilobytes(&text, "SwapFree:").unwrap_or(0.0))
        };
        let limit = |name: &str, used: &str| {
            let [limits, status] = ["/proc/self/limits", "/proc/self/status"].map(read);
            // "unlimited" is no number.
            let soft = limits?
                .lines()
                .find_map(|line| line.strip_prefix(name)?.split_whitespace().next()?.parse::<f64>().ok());
            Some(soft? - kilobytes(&status?, used)?)
        };
        let all: [(Option<f64>, Bound); 5] = [
            (machine(), Bound::Machine),
            (limit("Max address space", "VmSize:"), Bound::AddressSpace),
            (limit("Max data size", "VmData:"), Bound::Data),
            (group(read), Bound::Group),
            (page(), Bound::Page),
        ];
        let known = all.into_iter().filter_map(|(bytes, bound)| Some(Free { bytes: bytes?, bound }));
        known.min_by(|a, b| a.bytes.total_cmp(&b.bytes))
    }

    fn allow(self, need: &Need, beside: Beside) -> Result<(), Fault> {
        let with_data = beside == Beside::Data;
        let kept = beside.bytes(need);
        let (bytes, free) = (need.bytes(with_data) + kept, self.bytes - SPARE);
        if bytes <= free {
            return Ok(());
        }
        let fault = Fault::new(format!(
            "This needs about {} of memory, for about {} quadrilaterals, but {} {}",
            amount(bytes),
            grouped(rounded(need.quads)),
            amount(self.bytes.max(0.0)),
            self.bound.words()
        ));
        let more = self.bound.remedy();
        let remedy = match need.size_scale_within(free - kept, with_data) {
            Some(scale) => format!("size_scale = {} would fit; or {more}", number(scale)),
            None => format!("{}{}", more[..1].to_uppercase(), &more[1..]),
        };
        Err(fault.of_kind(FaultKind::Limit).remedy(remedy))
    }
}

impl Bound {
    /// What there is so much of.
    fn words(self) -> &'static str {
        match self {
            Bound::Machine => "are free on this machine",
            Bound::AddressSpace => "are left to this process by its limit of address space (ulimit -v)",
            Bound::Data => "are left to this process by its limit of data (ulimit -d)",
            Bound::Group => "are left by the limit of its control group",
            Bound::Page => "are left to a page of a browser",
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Bound::Machine => "free memory, or use a machine that has more",
            Bound::AddressSpace => "raise the limit (ulimit -v)",
            Bound::Data => "raise the limit (ulimit -d)",
            Bound::Group => "raise the limit of the control group or container",
            Bound::Page => "use quadfront on a machine",
        }
    }
}

/// The value of a line such as `VmSize:   3892 kB`, in bytes.
fn kilobytes(text: &str, name: &str) -> Option<f64> {
    let value = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(1024.0 * value.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// What the control groups of the process leave, of both versions: the least of its own and of those above it.
fn group(read: &dyn Fn(&str) -> Option<String>) -> Option<f64> {
    let groups = read("/proc/self/cgroup")?;
    let mut least: Option<f64> = None;
    for line in groups.lines() {
        // Number, controllers, path.
        let mut parts = line.splitn(3, ':');
        let (Some(_), Some(controllers), Some(path)) = (parts.next(), parts.next(), parts.next()) else { continue };
        let [root, limit, used, reclaimed] = match controllers {
            "" => ["/sys/fs/cgroup", "memory.max", "memory.current", "inactive_file"],
            _ if controllers.split(',').any(|name| name == "memory") => {
                ["/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"]
            }
            _ => continue,
        };
        // In a container the path may be that outside, and only the root is there.
        let mut path = path.trim_end_matches('/');
        loop {
            let bytes = |file: &str| read(&format!("{root}{path}/{file}"))?.trim().parse::<f64>().ok();
            if let (Some(limit), Some(used)) = (bytes(limit), bytes(used)) {
                // Files that are only cached give way.
                let statistics = read(&format!("{root}{path}/memory.stat")).unwrap_or_default();
                let cached =
                    statistics.lines().find_map(|line| line.strip_prefix(reclaimed)?.trim().parse::<f64>().ok());
                let left = limit - (used - cached.unwrap_or(0.0)).max(0.0);
                least = Some(least.map_or(left, |least| least.min(left)));
            }
            match path.rfind('/') {
                Some(end) => path = &path[..end],
                None => break,
            }
        }
    }
    least
}

/// Bytes as people read them: `740 MB`, `14 GB`.
fn amount(bytes: f64) -> String {
    match bytes {
        _ if bytes < 995e6 => format!("{:.0} MB", bytes / 1e6),
        _ if bytes < 9.95e9 => format!("{:.1} GB", bytes / 1e9),
        _ => format!("{:.0} GB", bytes / 1e9),
    }
}

/// A count of two digits.
fn rounded(count: f64) -> u64 {
    let mut unit = 1.0;
    while count / unit >= 100.0 {
        unit *= 10.0;
    }
    ((count / unit).round() * unit) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    const MEMINFO: &str = "MemTotal: 24105000 kB\nMemAvailable:    2000000 kB\nSwapFree:   500000 kB\n";
    const LIMITS: &str = "Limit      Soft Limit  Hard Limit  Units\nMax data size     unlimited   unlimited  bytes\n\
                          Max address space         1000000000           unlimited            bytes\n";
    const STATUS: &str = "VmPeak:	  200000 kB\nVmSize:	  100000 kB\nVmData:	  50000 kB\n";

    fn free(files: &[(&str, &str)]) -> Option<Free> {
        Free::now(&|path| files.iter().find(|file| file.0 == path).map(|file| file.1.to_owned()))
    }

    #[test]
    fn the_least_of_machine_limits_and_groups_is_free() {
        assert_eq!(free(&[]), None);
        let machine = ("/proc/meminfo", MEMINFO);
        assert_eq!(free(&[machine]), Some(Free { bytes: 2.5e6 * 1024.0, bound: Bound::Machine }));
        let limits = [machine, ("/proc/self/limits", LIMITS), ("/proc/self/status", STATUS)];
        assert_eq!(free(&limits), Some(Free { bytes: 1e9 - 102.4e6, bound: Bound::AddressSpace }));
    }

    #[test]
    fn a_control_group_leaves_what_it_and_those_above_it_leave() {
        let groups = ("/proc/self/cgroup", "4:cpu,memory:/a/b\n0::/c\n");
        let first = [
            groups,
            ("/sys/fs/cgroup/memory/a/memory.limit_in_bytes", "900\n"),
            ("/sys/fs/cgroup/memory/a/memory.usage_in_bytes", "500\n"),
            ("/sys/fs/cgroup/memory/a/memory.stat", "inactive_file 7\ntotal_inactive_file 200\n"),
        ];
        assert_eq!(free(&first), Some(Free { bytes: 600.0, bound: Bound::Group }));
        let both = [
            first.as_slice(),
            &[
                ("/sys/fs/cgroup/c/memory.max", "max\n"),
                ("/sys/fs/cgroup/c/memory.current", "5\n"),
                ("/sys/fs/cgroup/memory.max", "50\n"),
                ("/sys/fs/cgroup/memory.current", "20\n"),
            ],
        ]
        .concat();
        assert_eq!(free(&both), Some(Free { bytes: 30.0, bound: Bound::Group }));
        assert_eq!(free(&[groups]), None);
    }

    #[test]
    fn what_does_not_fit_is_refused_with_a_scale_that_does() {
        let free = Free { bytes: 6e9, bound: Bound::AddressSpace };
        for beside in [Beside::Nothing, Beside::Data, Beside::States(2)] {
            let need = |size_scale: f64| Need::of(400.0 / (size_scale * size_scale), Some(size_scale));
            let fault = free.allow(&need(0.005), beside).unwrap_err();
            assert!(fault.what.contains(&format!("{} quadrilaterals", grouped(16_000_000))), "{fault}");
            assert!(fault.what.contains("6.0 GB") && fault.remedy.contains("ulimit -v"), "{fault}");
            let words = fault.remedy.strip_prefix("size_scale = ").unwrap();
            let scale: f64 = words.split_whitespace().next().unwrap().parse().unwrap();
            assert!(free.allow(&need(scale), beside).is_ok(), "{fault}");
            assert!(free.allow(&need(0.98 * scale), beside).is_err(), "{fault}");
        }
        let given = free.allow(&Need::of(1e9, None), Beside::Nothing).unwrap_err();
        assert_eq!(given.remedy, "Raise the limit (ulimit -v)");
        // Others like this one take as much each.
        let others = free.allow(&Need::of(3e6, Some(1.0)), Beside::Conversions(1)).unwrap_err();
        assert!(
            others.remedy.starts_with("size_scale = ") && free.allow(&Need::of(2e6, None), Beside::Nothing).is_ok()
        );
        let nothing = Free { bytes: 1e6, bound: Bound::Machine }.allow(&Need::of(1.0, Some(1.0)), Beside::Nothing);
        assert!(nothing.unwrap_err().remedy.starts_with("Free memory"));
    }

    #[test]
    fn amounts_have_two_digits() {
        assert_eq!([7.4e8, 1.44e9, 1.94e10].map(amount), ["740 MB", "1.4 GB", "19 GB"]);
        assert_eq!([0.4, 99.0, 16_012_345.0].map(rounded), [0, 99, 16_000_000]);
    }
}
