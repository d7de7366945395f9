//! Selections (4.3.3).

use std::collections::{BTreeMap, BTreeSet};

use quadfront::core::case::HMinOver;
use quadfront::core::convert::{Converter, Event};
use quadfront::core::mesh::NodeId;

use crate::oracle::{Measured, Oracle};

fn close(ours: f64, theirs: f64, tolerance: f64) -> bool {
    (ours - theirs).abs() <= tolerance * theirs.abs().max(1e-300)
}

/// Holds one selection against the oracle. `state` is the state after it: a selection changes no mesh.
pub fn examine(state: &Converter<'_>, event: &Event) {
    let Event::BaseSelected {
        a,
        b,
        h_value,
        h_min,
        deferred,
        class,
        theta,
        length_metric,
        length_physical,
        within_reach,
        ..
    } = *event
    else {
        panic!("{event:?}")
    };
    let parameters = state.parameters();
    let front = Oracle { mesh: &state.mesh }.front(state.face(), parameters);
    let waiting = || front.values().filter(|s| !s.is_deferred);
    assert_eq!(deferred as usize, front.len() - waiting().count());
    let layer = waiting().map(|s| s.layer).min().unwrap();
    let counts = |s: &&Measured| match parameters.h_min_over {
        HMinOver::Front if s.is_deferred => true,
        _ => !s.is_deferred && s.layer == layer,
    };
    let least = front.values().filter(counts).map(|s| s.h).fold(f64::INFINITY, f64::min);
    let told = &front[&[a, b]];
    // On surfaces the root of a difference loses half of the digits where the metric is nearly isotropic.
    let exact = if state.mesh.embedding().is_some() { 1e-7 } else { 1e-12 };
    assert!(close(h_value, told.h, exact) && close(h_min, least, exact), "{h_min} {least} {told:?}");
    assert!(close(length_metric, told.length, 1e-10) && close(length_physical, told.physical, 1e-10), "{told:?}");
    let turned = |k: usize| (theta[k] - told.theta[k]).abs().to_degrees();
    // The arc cosine loses half of the digits near a straight angle.
    assert!(turned(0) < 1e-5 && turned(1) < 1e-5, "{theta:?} {told:?}");
    assert_eq!(class, told.class);
    let window = |s: &Measured| match parameters.text_of("selection_window").unwrap().as_str() {
        "physical_length" => s.physical,
        "h_value" => s.h,
        _ => s.length * s.h,
    };
    // What is as far as the reach but for rounding may be on either side of it.
    let reach = parameters.c * least;
    let in_reach = |s: &Measured| s.class < 4 && window(s) < reach * (1.0 - exact);
    let out_of_reach = |s: &Measured| s.class == 4 || window(s) > reach * (1.0 + exact);
    assert!(if within_reach { !out_of_reach(told) } else { !in_reach(told) }, "{told:?}");
    for (ends, other) in front.iter().filter(|(_, s)| !s.is_deferred && s.layer == layer) {
        if in_reach(other) {
            assert!(within_reach && class <= other.class, "{ends:?} {other:?} before {told:?}");
            if class == other.class {
                assert!(window(told) <= window(other) * (1.0 + exact), "{ends:?} {other:?} before {told:?}");
            }
        } else if !within_reach {
            assert!(told.h <= other.h * (1.0 + exact), "{ends:?} {other:?} before {told:?}");
        }
    }
    assert_eq!(told.layer, layer);
    loops_are_even(&front);
}

/// The invariant of the front (docs/algorithm.md, "The parity invariant").
fn loops_are_even(front: &BTreeMap<[NodeId; 2], Measured>) {
    let mut left: BTreeSet<[NodeId; 2]> = front.keys().copied().collect();
    while let Some(first) = left.pop_first() {
        let (mut segments, mut at) = (1, [first[1], front[&first].next]);
        while at != first {
            assert!(left.remove(&at), "{at:?} is in two loops");
            segments += 1;
            at = [at[1], front[&at].next];
        }
        assert_eq!(segments % 2, 0, "the loop through {first:?} has {segments} segments");
    }
}
