//! Loaders under mutated files of every format: bytes changed, files cut off, headers that lie. None panics, hangs, or
//! takes more memory than a few times the file. Two seconds of it in `make test`, an hour in `make soak`
//! (`QUADFRONT_SOAK_SECONDS`); `QUADFRONT_SOAK_FILES` names a folder with further files to mutate, `QUADFRONT_SEED`
//! where the numbers begin.
//!
//! Its own program, since it counts all memory that is asked for.
#![allow(clippy::unwrap_used)]

#[path = "common/environment.rs"]
mod environment;
#[path = "common/grid.rs"]
mod grid;
#[path = "common/xor_shift.rs"]
mod xor_shift;

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use grid::grid;
use peak_alloc::PeakAlloc;
use quadfront::core::formats::format::{read_bytes, write_to};
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::soup::{Group, MeshFile};
use xor_shift::XorShift;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// Memory while a file is read, over its size.
const MOST: usize = 16;
/// Likewise of OBJ: `tobj` holds a hundred bytes for each face, whose text may have eight, in a list that doubles.
const MOST_OF_OBJ: usize = 32;
/// What any file may take, however small: messages, and the first rooms of lists. The parser of PLY makes room for up
/// to 65 536 numbers of a list before it reads them.
fn little(format: Format) -> usize {
    if format == Format::Ply { (64 << 10) + (65_536 * 8) } else { 64 << 10 }
}
/// Nothing takes as long as this.
const HANGS: Duration = Duration::from_secs(20);

/// When the file at hand was begun (milliseconds since the start, plus one), and which it is: for the watchdog.
static BEGUN: AtomicU64 = AtomicU64::new(0);
static ROUND: AtomicU64 = AtomicU64::new(0);

/// A wavy plate with two regions and a named side.
fn plate(n: u32) -> MeshFile {
    let mut mesh = grid(n, |x, y| 0.1 * x * (1.0 - y));
    mesh.triangle_tags = (0..2 * n * n).map(|t| 1 + u32::from(t / 2 % n > n / 2)).collect();
    mesh.lines = (0..n).map(|k| [k, k + 1]).collect();
    mesh.line_tags = vec![3; n as usize];
    for (dimension, tag, name) in [(1, 3, "floor"), (2, 1, "left"), (2, 2, "right")] {
        mesh.groups.push(Group { dimension, tag, name: name.to_owned() });
    }
    mesh
}

/// Files of all formats, small ones and some that are larger.
fn samples() -> Vec<(String, Format, Vec<u8>)> {
    let mut samples = Vec::new();
    for n in [2, 40] {
        for format in Format::written() {
            for msh2 in [false, true] {
                if !msh2 || format == Format::Msh {
                    let mut bytes = Vec::new();
                    write_to(&mut bytes, format, &plate(n), WriteOptions { msh2 }).unwrap();
                    samples.push((format!("plate of {n}, {format:?}"), format, bytes));
                }
            }
        }
    }
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data")];
    folders.extend(std::env::var_os("QUADFRONT_SOAK_FILES").map(Into::into));
    for folder in folders {
        let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        for path in paths {
            let Ok(format) = Format::from_path(&path) else { continue };
            let bytes = fs::read(&path).unwrap();
            if bytes.len() <= 4 << 20 {
                samples.push((path.display().to_string(), format, bytes));
            }
        }
    }
    samples
}

/// One to four changes. Runs of digits are replaced whole, so that counts lie instead of being no numbers.
fn mutate(bytes: &mut Vec<u8>, random: &mut XorShift) {
    const NUMBERS: [&str; 14] = [
        "-1",
        "0",
        "1",
        "2",
        "3",
        "7",
        "65536",
        "1000000",
        "99999999",
        "4294967295",
        "18446744073709551615",
        "1e999",
        "nan",
        "1e-320",
    ];
    for _ in 0..=random.below(4) {
        if bytes.is_empty() {
            return;
        }
        // Half of the changes within the first part, where headers are.
        let within = if random.below(2) == 0 { bytes.len().min(400) } else { bytes.len() };
        let at = random.below(within);
        let longest = if random.below(4) == 0 { 4000 } else { 8 };
        let to = (at + 1 + random.below(longest)).min(bytes.len());
        match random.below(8) {
            0 => bytes[at] = random.next() as u8,
            1 => bytes[at] ^= 1 << random.below(8),
            2 => drop(bytes.drain(at..to)),
            3 => {
                let part = bytes[at..to].to_vec();
                let place = random.below(bytes.len());
                bytes.splice(place..place, part);
            }
            4 => bytes.truncate(at),
            5 | 6 => {
                let Some(begin) = (at..bytes.len()).find(|&k| bytes[k].is_ascii_digit()) else { continue };
                let end = (begin..bytes.len()).find(|&k| !bytes[k].is_ascii_digit()).unwrap_or(bytes.len());
                bytes.splice(begin..end, NUMBERS[random.below(NUMBERS.len())].bytes());
            }
            _ => {
                let value = match random.below(4) {
                    0 => u64::MAX >> random.below(64),
                    1 => 1 << random.below(64),
                    2 => random.next(),
                    _ => random.below(100) as u64,
                };
                let value = value.to_le_bytes();
                let long = if random.below(2) == 0 { 4 } else { 8 };
                bytes.iter_mut().skip(at).zip(&value[..long]).for_each(|(byte, new)| *byte = *new);
            }
        }
    }
}

#[test]
fn no_mutation_of_a_file_takes_a_loader_down_or_more_memory_than_a_few_times_the_file() {
    let limit = Duration::from_secs(environment::number("QUADFRONT_SOAK_SECONDS").unwrap_or(2));
    let first = environment::number("QUADFRONT_SEED").unwrap_or(1);
    let samples = samples();
    let start = Instant::now();
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(Duration::from_millis(500));
            let begun = BEGUN.load(Ordering::SeqCst);
            let now = start.elapsed().as_millis() as u64 + 1;
            if begun > 0 && now.saturating_sub(begun) > HANGS.as_millis() as u64 {
                eprintln!("round {} hangs", ROUND.load(Ordering::SeqCst));
                std::process::abort();
            }
        }
    });
    let (mut rounds, mut read) = (0_u64, 0_u64);
    let mut slowest = (Duration::ZERO, String::new());
    // The greatest share of what is allowed, by format.
    let mut most: Vec<(String, f64)> = Vec::new();
    'all: loop {
        for (sample, (name, format, whole)) in samples.iter().enumerate() {
            if start.elapsed() > limit && rounds >= samples.len() as u64 {
                break 'all;
            }
            let seed = first + rounds;
            rounds += 1;
            let mut bytes = whole.clone();
            mutate(&mut bytes, &mut XorShift::of(seed));
            ROUND.store(seed, Ordering::SeqCst);
            BEGUN.store(start.elapsed().as_millis() as u64 + 1, Ordering::SeqCst);
            let begun = Instant::now();
            let before = MEMORY.current_usage();
            MEMORY.reset_peak_usage();
            let mesh = read_bytes("a", &bytes, *format);
            let taken = MEMORY.peak_usage().saturating_sub(before);
            let spent = begun.elapsed();
            BEGUN.store(0, Ordering::SeqCst);
            let case = || format!("round {seed}: sample {sample}, {name}");
            // The file itself is in memory besides.
            let most_of_format = if *format == Format::Obj { MOST_OF_OBJ } else { MOST };
            let share = (taken + bytes.len()) as f64 / (most_of_format * bytes.len()).max(little(*format)) as f64;
            assert!(share <= 1.0, "{} of {} bytes takes {taken}", case(), bytes.len());
            if spent > slowest.0 {
                slowest = (spent, case());
            }
            let format = format!("{format:?}");
            match most.iter_mut().find(|known| known.0 == format) {
                Some(known) => known.1 = known.1.max(share),
                None => most.push((format, share)),
            }
            let Ok(mesh) = mesh else { continue };
            read += 1;
            let count = mesh.points.len() as u32;
            assert!(mesh.points.iter().all(|p| p.is_finite()), "{}", case());
            let corners = mesh.triangles.as_flattened().iter().chain(mesh.quads.as_flattened());
            assert!(corners.chain(mesh.lines.as_flattened()).all(|&corner| corner < count), "{}", case());
        }
    }
    println!(
        "{rounds} files, {read} of them read; the slowest took {:.0} ms ({}); most memory over what is allowed: {most:.2?}",
        slowest.0.as_secs_f64() * 1e3,
        slowest.1
    );
    assert!(read * 20 > rounds, "mutations are too wild: {read} of {rounds} are read");
}
