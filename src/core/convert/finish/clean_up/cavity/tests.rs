use std::collections::BTreeMap;

use glam::DVec2;
use proptest::prelude::*;

use super::filled::{Filled, fill};
use super::filling::{Filling, fillings, least_irregular};

/// The nodes of a polygon with so many edges on each side: those of a regular one.
fn regular(sides: &[u32]) -> Vec<DVec2> {
    let corner = |k: usize| {
        let turn = std::f64::consts::TAU * k as f64 / sides.len().max(3) as f64;
        DVec2::new(libm::cos(turn), libm::sin(turn))
    };
    let n = sides.len();
    let between = |k: usize, t: f64| {
        let (a, b) = (corner(k), corner((k + 1) % n));
        if n == 1 {
            let turn = std::f64::consts::TAU * t;
            return DVec2::new(libm::cos(turn), libm::sin(turn));
        }
        // With two corners the sides bulge.
        let bulge = if n == 2 { (a - b).perp() * t * (1.0 - t) * 2.0 } else { DVec2::ZERO };
        a + (b - a) * t + bulge
    };
    (0..n)
        .flat_map(|k| (0..sides[k]).map(move |i| (k, f64::from(i) / f64::from(sides[k]))))
        .map(|(k, t)| between(k, t))
        .collect()
}

/// Says what is wrong with the quadrilaterals of a filling, counted from the quadrilaterals alone.
fn faults(filling: &Filling, sides: &[u32]) -> Result<(), TestCaseError> {
    let mut filled = Filled::default();
    let border: u32 = sides.iter().sum();
    fill(filling, sides, regular(sides).into_iter(), &mut filled);
    prop_assert_eq!(filled.quads.len() as u64, filling.quads(sides), "{:?}", filling);
    // Each side of a quadrilateral is met once from each side, or lies on the border.
    let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    let mut valence = vec![0; filled.places.len()];
    for quad in &filled.quads {
        for k in 0..4 {
            let (a, b) = (quad[k], quad[(k + 1) % 4]);
            prop_assert!(a != b);
            *edges.entry((a, b)).or_default() += 1;
            valence[a as usize] += 1;
        }
    }
    for (&(a, b), &count) in &edges {
        prop_assert_eq!(count, 1);
        let outer = b == (a + 1) % border && a < border;
        prop_assert!(outer != edges.contains_key(&(b, a)), "{:?} {:?}: {} {}", filling, sides, a, b);
    }
    let mut node = 0;
    for &edges in sides {
        for k in 0..edges {
            prop_assert_eq!(
                valence[node],
                if k == 0 && sides.len() > 1 { 1 } else { 2 },
                "{:?} {:?} at {}",
                filling,
                sides,
                node
            );
            node += 1;
        }
    }
    let inside = &valence[node..];
    let irregular = inside.iter().filter(|&&n| n != 4).count();
    prop_assert_eq!(irregular, filling.irregular());
    // Euler's formula: the excesses inside sum to the number of corners less four.
    let sum: i32 = inside.iter().map(|n| n - 4).sum();
    let corners = if let [_] = sides { 0 } else { sides.len() as i32 };
    prop_assert_eq!(sum, corners - 4);
    Ok(())
}

proptest! {
    #[test]
    fn every_filling_is_a_disc_that_fits_its_polygon(sides in prop::collection::vec(1_u32..14, 1..=6)) {
        for filling in fillings(&sides) {
            prop_assert_eq!(filling.irregular(), least_irregular(&sides));
            faults(&filling, &sides)?;
        }
    }
}

#[test]
fn polygons_that_can_be_filled_are_filled() {
    let some = |sides: &[u32]| !fillings(sides).is_empty();
    assert_eq!(fillings(&[3, 5, 3, 5]), [Filling::Grid]);
    assert!(
        some(&[12])
            && some(&[4, 4, 4])
            && some(&[3, 3, 3, 3, 2])
            && some(&[6, 4, 4, 4])
            && some(&[5, 5])
            && some(&[4; 6])
    );
    // An odd number of edges, a side as long as the two others, sides too short for spokes.
    assert!(!some(&[4, 4, 5]) && !some(&[2, 2, 4]) && !some(&[1, 1, 1, 1, 1, 1]));
}

#[test]
fn opposite_sides_that_differ_take_one_pair_and_as_many_places_as_there_is_room() {
    let found = fillings(&[10, 8, 8, 8]);
    assert!(found.len() > 8 && found.iter().all(|filling| filling.irregular() == 2));
    let mut counts: Vec<u64> = found.iter().map(|filling| filling.quads(&[10, 8, 8, 8])).collect();
    counts.sort_unstable();
    counts.dedup();
    assert!(counts.len() > 2 && counts.iter().all(|n| (64..=80).contains(n)), "{counts:?}");
}
