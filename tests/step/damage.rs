//! No bytes make the reader panic or hang, and every refusal says where.

use std::time::{Duration, Instant};

use quadfront::core::case::{DomainSource, ImportOptions};
use quadfront::core::geometry::complex;

use super::xor_shift::XorShift;
use super::{bytes_of, case_of, environment, names, skipping};

/// Words that change what an instance is.
const HOSTILE: [&str; 22] = [
    "0.",
    "-1.",
    "1.E300",
    "1.E-300",
    "1.E999",
    "$",
    "*",
    "()",
    "(((",
    ")",
    ".F.",
    ".T.",
    "#1",
    "#99999999",
    "''",
    ";",
    "PLANE",
    "CIRCLE",
    "CONICAL_SURFACE",
    "B_SPLINE_CURVE_WITH_KNOTS",
    "SPHERICAL_SURFACE",
    "99999999999",
];

fn mutate(bytes: &mut Vec<u8>, random: &mut XorShift) {
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len().max(1)).min(bytes.len());
        let is_mark = |b: &u8| matches!(b, b',' | b'(' | b')' | b';' | b'=');
        // From one mark to the next: a parameter.
        let from = at + bytes[at..].iter().position(is_mark).map_or(0, |k| k + 1);
        let to = from + bytes[from..].iter().position(is_mark).unwrap_or(0);
        match random.below(7) {
            0 if at < bytes.len() => bytes[at] = random.below(256) as u8,
            1 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            2 => drop(bytes.drain(at..(at + random.below(40)).min(bytes.len()))),
            3 => {
                let part = bytes[from..to].to_vec();
                let place = random.below(bytes.len());
                bytes.splice(place..place, part);
            }
            4 | 5 => drop(bytes.splice(from..to, HOSTILE[random.below(HOSTILE.len())].bytes())),
            _ if random.below(20) == 0 => bytes.truncate(at),
            _ => {
                // Another number of an instance.
                let digits = random.below(200).to_string();
                bytes.splice(from..to, format!("#{digits}").into_bytes());
            }
        }
    }
}

/// `QUADFRONT_SOAK_SECONDS` sets how long it goes on (`make soak`); here each file is changed a few dozen times.
#[test]
fn no_mutation_makes_the_reader_panic_or_hang() {
    let seconds = environment::number("QUADFRONT_SOAK_SECONDS");
    let files: Vec<(String, Vec<u8>)> = names().into_iter().map(|name| (name.clone(), bytes_of(&name))).collect();
    let begin = Instant::now();
    let (mut taken, mut refused, mut built, mut round) = (0_u64, 0_u64, 0_u64, 0_u64);
    loop {
        let is_over = match seconds {
            Some(seconds) => begin.elapsed() > Duration::from_secs(seconds),
            None => round >= 25,
        };
        if is_over {
            break;
        }
        for (k, (name, bytes)) in files.iter().enumerate() {
            let mut random = XorShift::of(round * 64 + k as u64 + 1);
            let mut bytes = bytes.clone();
            mutate(&mut bytes, &mut random);
            let options = if random.below(2) == 0 { skipping() } else { ImportOptions::default() };
            let since = Instant::now();
            match case_of(&bytes, name, &options) {
                Ok((case, _)) => {
                    taken += 1;
                    let DomainSource::Surfaces(spec) = &case.domain else { panic!() };
                    built += u64::from(complex::build(spec).is_ok());
                }
                Err(fault) => {
                    refused += 1;
                    assert!(!fault.what.is_empty() && fault.to_string().contains(name.as_str()), "{fault:?}");
                }
            }
            assert!(since.elapsed() < Duration::from_secs(20), "round {round} of {name} is slow");
        }
        round += 1;
    }
    println!("{round} rounds: {taken} taken, {built} of them built, {refused} refused");
    assert!(taken > 0 && built > 0 && refused > 0);
}

#[test]
fn a_file_that_is_cut_off_is_refused() {
    let bytes = bytes_of("cone");
    for k in 1..10 {
        let cut = &bytes[..bytes.len() * k / 10];
        let fault = case_of(cut, "cone", &skipping()).unwrap_err();
        assert!(fault.what.contains("cut off"), "{fault}");
    }
}
