//! What the timing programs measure with: processor time of one run, and peak memory.
#![allow(dead_code, reason = "not every program uses all of it")]

use std::fs;
use std::time::{Duration, Instant};

/// How times are taken here, for the heading.
pub fn clock() -> &'static str {
    if processor_time().is_some() {
        "processor time of the one thread (/proc/thread-self/schedstat)"
    } else {
        "time on the clock: other processes slow it down"
    }
}

/// Runs `work` several times and gives the last result with the median of the seconds.
pub fn median_of<T>(runs: usize, mut work: impl FnMut() -> T) -> (T, f64) {
    let (mut result, mut seconds) = once(&mut work);
    let mut all = vec![seconds];
    for _ in 1..runs {
        drop(result);
        (result, seconds) = once(&mut work);
        all.push(seconds);
    }
    all.sort_by(f64::total_cmp);
    (result, all[all.len() / 2])
}

fn once<T>(work: &mut impl FnMut() -> T) -> (T, f64) {
    let start = now();
    let result = work();
    (result, since(start))
}

/// A moment to measure from.
#[derive(Clone, Copy)]
pub struct Moment {
    clock: Instant,
    processor: Option<f64>,
}

/// This moment.
pub fn now() -> Moment {
    Moment { clock: Instant::now(), processor: processor_time() }
}

/// Seconds since then.
pub fn since(then: Moment) -> f64 {
    match (then.processor, processor_time()) {
        (Some(before), Some(after)) => after - before,
        _ => then.clock.elapsed().as_secs_f64(),
    }
}

/// Seconds that this thread has run, where the system tells.
fn processor_time() -> Option<f64> {
    // The count is brought up to date when the thread gives way.
    std::thread::sleep(Duration::from_micros(1));
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    // A system that does not count says 0.
    (nanoseconds > 0.0).then_some(nanoseconds * 1e-9)
}

/// The peak of resident memory since [`forget_peak`], in bytes, where the system tells.
pub fn peak_memory() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? * 1024.0)
}

/// Lets the peak of resident memory start anew from what is resident now; `false` where the system does not let it.
pub fn forget_peak() -> bool {
    fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// The exponent of the cost between two sizes.
pub fn exponent(sizes: [usize; 2], seconds: [f64; 2]) -> f64 {
    libm::log(seconds[1] / seconds[0]) / libm::log(sizes[1] as f64 / sizes[0] as f64)
}
