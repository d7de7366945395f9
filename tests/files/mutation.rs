//! No bytes make a reader panic, hang or break its promise.

use std::fs;
use std::time::{Duration, Instant};

use quadfront::core::formats::format::read_bytes;
use quadfront::core::formats::{Format, medit};
use quadfront::core::soup::MeshFile;
use quadfront::core::soup::soundness::examine;

use super::foreign::SETS;
use super::xor_shift::XorShift;
use super::{MSH2, TEXT, bytes_of, data, plates};

#[test]
fn truncated_files_are_refused_or_lack_only_their_end() {
    for (format, bytes) in samples() {
        let whole = read_bytes("a", &bytes, format).unwrap();
        for cut in 0..bytes.len() {
            if let Ok(mesh) = read_bytes("a", &bytes[..cut], format) {
                // Formats without counts cannot know that something is missing.
                let same = mesh.points.len() <= whole.points.len() && mesh.quads.len() <= whole.quads.len();
                assert!(same, "{format:?} cut at {cut}");
            }
        }
    }
}

/// A file of every kind that a reader knows.
fn samples() -> Vec<(Format, Vec<u8>)> {
    let mut samples: Vec<_> = Format::written().map(|format| (format, bytes_of(format, &plates(), TEXT))).collect();
    samples.push((Format::Msh, bytes_of(Format::Msh, &plates(), MSH2)));
    samples.push((Format::Inp, SETS.as_bytes().to_vec()));
    for name in ["plates_41a.msh", "plates_41b.msh", "plates_22a.msh", "plates_22b.msh"] {
        samples.push((Format::Msh, fs::read(data(name)).unwrap()));
    }
    for (format, names) in [
        (Format::Ply, &["plate_binary.ply", "plate_text.ply"][..]),
        (Format::Stl, &["plate_binary.stl", "plate_text.stl"]),
        (Format::Glb, &["plates.glb"]),
        (Format::Gltf, &["plates.gltf"]),
    ] {
        samples.extend(names.iter().map(|name| (format, fs::read(data(name)).unwrap())));
    }
    samples
}

/// Bytes changed, cut out, doubled, swapped for hostile numbers and words.
fn mutate(bytes: &mut Vec<u8>, random: &mut XorShift) {
    const HOSTILE: [&[u8]; 16] = [
        b"-1",
        b"0",
        b"4294967295",
        b"18446744073709551615",
        b"1e999",
        b"nan",
        b"\n",
        b" ",
        b"$Elements",
        b"\xff\xfe",
        b"1e-320",
        b"99999999",
        b"\"",
        b"<",
        b",",
        b"f",
    ];
    for _ in 0..=random.below(3) {
        if bytes.is_empty() {
            return;
        }
        let at = random.below(bytes.len());
        let longest = if random.below(4) == 0 { 40 } else { 2 };
        let to = (at + 1 + random.below(longest)).min(bytes.len());
        match random.below(6) {
            0 => bytes[at] = random.below(256) as u8,
            1 => bytes[at] ^= 1 << random.below(8),
            2 => drop(bytes.drain(at..to)),
            3 => {
                let part = bytes[at..to].to_vec();
                let place = random.below(bytes.len());
                bytes.splice(place..place, part);
            }
            4 => drop(bytes.splice(at..to.min(at + 4), HOSTILE[random.below(HOSTILE.len())].iter().copied())),
            _ => bytes.truncate(at),
        }
    }
}

/// `QUADFRONT_SOAK_ROUNDS` sets the number of rounds (`make soak`).
#[test]
fn no_mutation_of_a_file_makes_a_reader_panic_hang_or_break_its_promise() {
    let rounds = crate::environment::number("QUADFRONT_SOAK_ROUNDS").unwrap_or(400);
    let samples = samples();
    let mut read = 0u64;
    for round in 0..rounds {
        for (sample, (format, bytes)) in samples.iter().enumerate() {
            let mut random = XorShift::of(round * 64 + sample as u64 + 1);
            let mut bytes = bytes.clone();
            mutate(&mut bytes, &mut random);
            let begin = Instant::now();
            if let Ok(mesh) = read_bytes("a", &bytes, *format) {
                read += 1;
                keeps_its_promise(&mesh);
                examine(&mesh);
                keeps_its_promise(&mesh.clone().triangulated().0);
                let _ = medit::read_metric("a", &bytes, mesh.points.len());
            }
            assert!(begin.elapsed() < Duration::from_secs(2), "round {round} of sample {sample} ({format:?}) is slow");
        }
    }
    let sol = b"MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n2\n1 3\n1 0 1 0 0 1\n2 0 2 0 0 2\nEnd\n";
    for round in 0..rounds {
        let mut bytes = sol.to_vec();
        mutate(&mut bytes, &mut XorShift::of(round + 1));
        read += u64::from(medit::read_metric("a", &bytes, 2).is_ok());
    }
    assert!(read > rounds, "mutations are too wild to test what comes behind the header: {read}");
}

/// What `MeshFile` says of itself.
fn keeps_its_promise(mesh: &MeshFile) {
    let count = mesh.points.len() as u32;
    assert!(mesh.points.iter().all(|p| p.is_finite()));
    assert!(mesh.lines.iter().flatten().all(|&node| node < count));
    assert!(mesh.triangles.iter().flatten().all(|&node| node < count));
    assert!(mesh.quads.iter().flatten().all(|&node| node < count));
    assert!(mesh.polygons.iter().all(|polygon| polygon.len() > 4 && polygon.iter().all(|&node| node < count)));
    let elements = mesh.triangles.len() + mesh.quads.len();
    let tags = [
        (&mesh.line_tags, mesh.lines.len()),
        (&mesh.triangle_tags, mesh.triangles.len()),
        (&mesh.quad_tags, mesh.quads.len()),
        (&mesh.polygon_tags, mesh.polygons.len()),
    ];
    assert!(tags.iter().all(|(tags, count)| tags.is_empty() || tags.len() == *count));
    assert!(mesh.point_data.iter().all(|data| data.values.len() == mesh.points.len()));
    assert!(mesh.element_data.iter().all(|data| data.values.len() == elements));
    assert!(mesh.metric.as_ref().is_none_or(|metric| metric.len() == mesh.points.len()));
}
