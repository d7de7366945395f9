//! How often what happened in a conversion, by names.

use std::collections::BTreeMap;

use crate::core::background::Adapted;
use crate::core::convert::{Converted, Counts};

/// Numbers of events by kind.
pub(super) fn events(converted: &Converted) -> BTreeMap<String, u64> {
    let Adapted { divisions, collapses, swaps, moves } = converted.adapted;
    let (resort, finished) = (converted.last_resort, converted.finished);
    let cleaned_up = finished.cleaned_up;
    let Counts {
        steps,
        formed,
        right_replaced,
        rescued,
        rolled_back,
        deferred,
        seamed,
        transitions,
        split,
        enhanced,
        removed,
        closed,
    } = converted.counts;
    let front = [
        ("front_closed", closed),
        ("front_deferred", deferred),
        ("front_enhanced", enhanced),
        ("front_formed", formed),
        ("front_node_removed", removed),
        ("front_rescued", rescued),
        ("front_right_replaced", right_replaced),
        ("front_rolled_back", rolled_back),
        ("front_seam", seamed),
        ("front_split", split),
        ("front_step", steps),
        ("front_transition_seam", transitions),
    ];
    let counts = [
        ("background_collapse", collapses),
        ("background_division", divisions),
        ("background_move", moves),
        ("background_swap", swaps),
        ("clean_up_collapse", cleaned_up.collapses),
        ("clean_up_doublet", cleaned_up.doublets),
        ("clean_up_opening", cleaned_up.openings),
        ("clean_up_refill", cleaned_up.refills),
        ("clean_up_refused", cleaned_up.refused),
        ("clean_up_rotation", cleaned_up.rotations),
        ("last_resort_division", resort.divided),
        ("last_resort_merge", resort.merged),
        ("last_resort_recut", resort.recut),
        ("last_resort_template_quad", resort.template_quads),
        ("rows_laid_node", finished.laid),
        ("smoothing_move", finished.moves),
        ("unfolding_collapsed", finished.unfolded.collapsed),
        ("unfolding_moved", finished.unfolded.moved),
        ("unfolding_pillowed", finished.unfolded.pillowed),
        ("unfolding_rotated", finished.unfolded.rotated),
    ];
    let counts = counts.into_iter().map(|(name, count)| (name, count as u64));
    counts.chain(front).map(|(name, count)| (name.to_owned(), count)).collect()
}
