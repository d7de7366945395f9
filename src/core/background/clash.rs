//! Clashes of divided curves: chords that cross or come too close although their curves do not.

use glam::DVec2;

use super::discretise::DividedDomain;
use crate::core::fault::Fault;
use crate::core::geometry::{CurveId, Domain};
use crate::core::kernel::decimal::{number, point_text};
use crate::core::kernel::predicates::orient;

/// A chord of a divided curve: the curve, and the index of the chord.
pub type DividedChord = (CurveId, u32);

/// The reason why divided curves cannot be triangulated.
#[derive(Clone, Debug)]
pub struct Clash {
    /// The chords whose refinement may help.
    pub chords: Vec<DividedChord>,
    /// The fault if it does not help.
    pub fault: Fault,
}

/// What is wrong with a triangle that is not [`firm`](crate::core::kernel::predicates::firm), to follow "is".
pub fn too_thin(a: DVec2, b: DVec2, c: DVec2) -> String {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let ratio = orient(a, b, c) / longest / longest;
    if ratio <= 0.0 {
        "without area".to_owned()
    } else if ratio < 1e-7 {
        format!("only {} times as high as long; the minimum is 1e-7", number(ratio))
    } else {
        "too small at this distance from the origin".to_owned()
    }
}

/// The chords that begin or end at the nodes, ascending.
pub(super) fn chords_at(divided: &DividedDomain, nodes: &[u32]) -> Vec<DividedChord> {
    let mut chords = Vec::new();
    for (chain, id) in divided.chains.iter().zip(0..) {
        let at_one = chain.windows(2).zip(0..).filter(|(w, _)| w.iter().any(|n| nodes.contains(n)));
        chords.extend(at_one.map(|(_, k)| (CurveId(id), k)));
    }
    chords
}

/// A clash of chords; its fault names the curves of the first ones.
pub(super) fn clash(domain: &Domain, chords: Vec<DividedChord>, verb: &str, at: DVec2) -> Box<Clash> {
    let mut curves: Vec<CurveId> = Vec::new();
    for (id, _) in &chords {
        if !curves.contains(id) && curves.len() < 2 {
            curves.push(*id);
        }
    }
    let named = |id: &CurveId| format!("\"{}\"", domain.curves[id.index()].name);
    let what = match curves.as_slice() {
        [] => format!("Curves {verb}"),
        [one] => format!("The curve {} {verb}", named(one)),
        [one, other, ..] => format!("The curves {} and {} {verb} when divided into segments", named(one), named(other)),
    };
    let fault = Fault::new(what)
        .at(format!("at {}", point_text(at)))
        .remedy("Move them apart, reduce the sizes there, or fix larger numbers of segments");
    Box::new(Clash { chords, fault })
}
