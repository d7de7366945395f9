//! Grids of quadrilaterals that were cut along diagonals are given back: as many quadrilaterals as before, and no
//! irregular node. Other triangles imply what they implied before.
#![allow(clippy::unwrap_used)]

use glam::{DVec2, DVec3};
use quadfront::core::background::implied_metric::implied_metric;
use quadfront::core::background::import::import;
use quadfront::core::case::Case;
use quadfront::core::convert::conversion::convert;
use quadfront::core::discrete::right_angled::right_angles;
use quadfront::core::formats::format::write_mesh;
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::kernel::{LogMetric2, Metric2};
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::soup::{MeshFile, Weld};

#[path = "common/irregular.rs"]
mod irregular;
#[path = "common/xor_shift.rs"]
mod xor_shift;
use irregular::irregular_inside;
use xor_shift::XorShift;

/// Which diagonal cuts the square in column i and row j: whether it is the falling one.
type Cut = fn(i: u32, j: u32, random: &mut XorShift) -> bool;

const CUTS: [(&str, Cut); 4] = [
    ("one way", |_, _, _| false),
    ("union jack", |i, j, _| (i + j) % 2 == 1),
    ("zigzag", |_, j, _| j % 2 == 1),
    ("random", |_, _, random| random.below(2) == 1),
];

/// A grid of `n` by `m` squares cut along diagonals; `place` maps columns and rows to points.
fn cut_grid([n, m]: [u32; 2], cut: Cut, place: impl Fn(DVec2) -> DVec3) -> MeshFile {
    let random = &mut XorShift::of(7);
    let mut file = MeshFile::default();
    for j in 0..=m {
        file.points.extend((0..=n).map(|i| place(DVec2::new(f64::from(i), f64::from(j)))));
    }
    for (j, i) in (0..m).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| (j + y) * (n + 1) + i + x);
        let falling = cut(i, j, random);
        file.triangles.extend(if falling { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] });
    }
    file
}

/// Moves the inner nodes of such a grid by up to `far` along each axis.
fn with_noise(mut file: MeshFile, [n, m]: [u32; 2], far: f64) -> MeshFile {
    let random = &mut XorShift::of(11);
    let mut drawn = || far * (random.below(2001) as f64 / 1000.0 - 1.0);
    for (j, i) in (1..m).flat_map(|j| (1..n).map(move |i| (j, i))) {
        file.points[(j * (n + 1) + i) as usize] += DVec3::new(drawn(), drawn(), 0.0);
    }
    file
}

/// Quadrilaterals and irregular inner nodes of the conversion of a mesh's own triangles, counted apart from the report.
fn converted(file: &MeshFile) -> [usize; 2] {
    let folder = tempfile::tempdir().unwrap();
    write_mesh(&folder.path().join("a.msh"), Format::Msh, file, WriteOptions::default()).unwrap();
    let text = "version = 1\nmesh = \"a.msh\"\nuse = \"triangles\"\n";
    let case = Case::parse(text, "a", "a.toml", folder.path()).unwrap();
    let done = convert(&case, &mut Nobody).unwrap();
    let made = Export::of(&done.mesh, &done.names).file;
    assert!(made.triangles.is_empty());
    [made.quads.len(), irregular_inside(&made)]
}

#[test]
fn a_grid_that_was_cut_along_diagonals_is_given_back() {
    let quarter = |p: DVec2| {
        let (sin, cos) = libm::sincos(std::f64::consts::FRAC_PI_2 * p.x / 40.0);
        DVec3::new(cos, sin, 0.0) * (2.0 - p.y / 40.0)
    };
    let turned = |p: DVec2| DVec2::from_angle(0.3).rotate(p).extend(0.0);
    for (name, cut) in CUTS {
        let grids: [(&str, MeshFile); 6] = [
            ("square", cut_grid([40, 40], cut, |p| p.extend(0.0))),
            ("stretched", cut_grid([40, 40], cut, |p| DVec3::new(10.0 * p.x, p.y, 0.0))),
            ("turned", cut_grid([40, 40], cut, turned)),
            ("turned and stretched", cut_grid([40, 40], cut, |p| turned(p * DVec2::new(0.1, 1.0)))),
            ("quarter of an annulus", cut_grid([40, 40], cut, quarter)),
            ("dome", cut_grid([40, 40], cut, |p| p.extend(0.01 * (p * (40.0 - p)).element_sum()))),
        ];
        for (shape, file) in grids {
            assert_eq!(converted(&file), [1600, 0], "{name}, {shape}");
        }
        let oblong = cut_grid([40, 30], cut, |p| DVec3::new(0.7 * p.x, 1.3 * p.y, 0.0));
        assert_eq!(converted(&oblong), [1200, 0], "{name}, oblong");
        let noisy = with_noise(cut_grid([40, 40], cut, |p| p.extend(0.0)), [40, 40], 0.01);
        assert_eq!(converted(&noisy), [1600, 0], "{name}, noise of 1 %");
    }
}

/// Two halves of `n` by `n` squares: a cut grid to the left, to the right a lattice of equilateral triangles in rows of
/// the same height.
fn half_grid(n: u32) -> MeshFile {
    cut_grid(
        [2 * n, n],
        |_, j, _| j % 2 == 1,
        |p| {
            let beyond = (p.x - f64::from(n)).max(0.0);
            let shift = if p.y % 2.0 == 1.0 && beyond > 0.0 { 0.5 } else { 0.0 };
            DVec3::new(p.x.min(f64::from(n)) + (beyond + shift) * 1.154_700_538, p.y, 0.0)
        },
    )
}

#[test]
fn part_of_a_mesh_may_be_a_cut_grid() {
    let file = half_grid(20);
    for (t, right) in file.triangles.iter().zip(right_angles(&file.points, &file.triangles)) {
        let x = t.iter().map(|&k| file.points[k as usize].x).sum::<f64>() / 3.0;
        if x < 19.0 {
            let weight = right.map_or(0.0, |right| right.weight);
            assert!(weight > if x < 18.0 { 0.999 } else { 0.0 }, "{weight} at {x}");
        } else if x > 22.5 {
            assert_eq!(right, None, "at {x}");
        }
    }
    let [quads, irregular] = converted(&file);
    assert!(quads > 700 && irregular < 20, "{quads} quadrilaterals, {irregular} irregular nodes");
}

/// The metric in which each triangle is equilateral, averaged at the points: what all triangles implied once.
fn equilateral(file: &MeshFile) -> Vec<Metric2> {
    let mut sums = vec![(LogMetric2::ZERO, 0.0); file.points.len()];
    for t in &file.triangles {
        let [a, b, c] = t.map(|k| file.points[k as usize].truncate());
        let sum =
            [b - a, c - b, a - c].iter().fold([0.0; 3], |s, e| [s[0] + e.y * e.y, s[1] + e.x * e.y, s[2] + e.x * e.x]);
        let doubled = (b - a).perp_dot(c - a);
        let factor = 0.5 / (doubled * doubled);
        let ln = Metric2 { uu: factor * sum[0], uv: -factor * sum[1], vv: factor * sum[2] }.ln();
        for &k in t {
            sums[k as usize] = (sums[k as usize].0.plus(1.0, &ln), sums[k as usize].1 + 1.0);
        }
    }
    sums.iter().map(|(sum, count)| LogMetric2::ZERO.plus(1.0 / count, sum).exp()).collect()
}

#[test]
fn triangles_that_are_no_cut_grid_imply_what_they_implied_before() {
    let lattice = |stretch: DVec2| {
        move |p: DVec2| (DVec2::new(p.x + 0.5 * (p.y % 2.0), 0.75_f64.sqrt() * p.y) * stretch).extend(0.0)
    };
    let zigzag: Cut = |_, j, _| j % 2 == 1;
    for stretch in [DVec2::ONE, DVec2::new(10.0, 1.0), DVec2::new(1.0, 10.0)] {
        for noise in [0.0, 0.1] {
            let file = with_noise(cut_grid([30, 30], zigzag, lattice(stretch)), [30, 30], noise);
            let set = import(&file, Weld::Auto, false).unwrap().set;
            let (found, expected) = (implied_metric(&set), equilateral(&file));
            for (found, expected) in found.iter().zip(&expected) {
                for (found, expected) in [(found.uu, expected.uu), (found.uv, expected.uv), (found.vv, expected.vv)] {
                    assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1e-3), "{found} {expected}");
                }
            }
        }
    }
}

/// Whether triangles pair, by brute force: two share a side that is opposite to the corner of each whose angle is
/// nearest to a right angle after a stretch that makes the sides there equal.
fn pairs(file: &MeshFile) -> Vec<bool> {
    let opposite = |t: &[u32; 3]| {
        let off = |k: usize| {
            let [o, a, b] = [0, 1, 2].map(|i| file.points[t[(k + i) % 3] as usize]);
            let (e, f) = (a - o, b - o);
            let [long, short] = if e.length() > f.length() { [e, f] } else { [f, e] };
            (long.project_onto(short).length() / short.length(), k)
        };
        let (off, k) = (0..3).map(off).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        let mut side = [t[(k + 1) % 3], t[(k + 2) % 3]];
        side.sort_unstable();
        (off, side)
    };
    let of: Vec<(f64, [u32; 2])> = file.triangles.iter().map(opposite).collect();
    let paired = |t: usize| of[t].0 < 0.1 && (0..of.len()).any(|u| u != t && of[u].1 == of[t].1 && of[u].0 < 0.1);
    (0..of.len()).map(paired).collect()
}

#[test]
fn all_that_pairs_in_a_grid_counts_as_right_angled_and_nothing_in_an_ordinary_mesh() {
    for (name, cut) in CUTS {
        let file = with_noise(cut_grid([12, 9], cut, |p| p.extend(0.0)), [12, 9], 0.02);
        let paired = pairs(&file);
        let right = right_angles(&file.points, &file.triangles);
        assert!(paired.iter().all(|paired| *paired), "{name}");
        assert!(right.iter().all(|right| right.is_some_and(|right| right.weight == 1.0)), "{name}");
        for (t, right) in file.triangles.iter().zip(right) {
            let [o, a, b] = [0, 1, 2].map(|k| file.points[t[(right.unwrap().corner + k) % 3] as usize]);
            assert!((a - o).dot(b - o).abs() < 0.1, "{name}");
        }
    }
    let lattice = |p: DVec2| DVec3::new(p.x + 0.5 * (p.y % 2.0), 0.75_f64.sqrt() * p.y, 0.0);
    let ordinary = with_noise(cut_grid([12, 10], |_, j, _| j % 2 == 1, lattice), [12, 10], 0.1);
    assert!(right_angles(&ordinary.points, &ordinary.triangles).iter().all(Option::is_none));
}
