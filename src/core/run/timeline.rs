//! What is drawn along a run: a lane for every kind of work.

use serde::Serialize;

use super::log::Log;
use crate::core::convert::event::Event;

/// The kinds of work, each a lane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Lane {
    /// Base segments chosen (4.3.3).
    Base,
    /// Side edges (4.3.4).
    Sides,
    /// Top edges (4.3.4).
    Top,
    /// Quadrilaterals formed.
    Formed,
    /// Attempts taken back, segments put off, second passes.
    Failed,
    /// Enhancement and smoothing around a new quadrilateral (4.3.6).
    Local,
    /// Seams (4.3.6).
    Seams,
    /// Splits of the front (4.3.6).
    Splits,
    /// Small loops closed, and the last resort.
    Closing,
    /// Clean-up and smoothing of the whole mesh (4.3.7), and what belongs to no other lane.
    Finishing,
}

impl Lane {
    /// All lanes, from above.
    pub const ALL: [Lane; 10] = [
        Lane::Base,
        Lane::Sides,
        Lane::Top,
        Lane::Formed,
        Lane::Failed,
        Lane::Local,
        Lane::Seams,
        Lane::Splits,
        Lane::Closing,
        Lane::Finishing,
    ];

    /// The lane of a kind of event.
    pub fn of(kind: &str) -> Lane {
        match kind {
            "base_selected" | "pick_lost" => Lane::Base,
            _ if kind.starts_with("side_") => Lane::Sides,
            _ if kind.starts_with("top_") => Lane::Top,
            "formed" => Lane::Formed,
            "rolled_back" | "deferred" | "second_pass" => Lane::Failed,
            "enhanced" | "smoothed" | "node_removed" => Lane::Local,
            "seamed" | "transition_seamed" | "seam_refused" => Lane::Seams,
            "split" => Lane::Splits,
            "closed" | "matched" | "patched" | "last_resort" => Lane::Closing,
            _ => Lane::Finishing,
        }
    }

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Lane::Base => "base",
            Lane::Sides => "sides",
            Lane::Top => "top",
            Lane::Formed => "formed",
            Lane::Failed => "taken back",
            Lane::Local => "local",
            Lane::Seams => "seams",
            Lane::Splits => "splits",
            Lane::Closing => "closing",
            Lane::Finishing => "finishing",
        }
    }
}

/// How many steps of each lane fall into each of `columns` equal parts of the steps from `from` to `until` (both included):
/// by column, then by the index of the lane in [`Lane::ALL`]. Linear in the number of steps.
pub fn lanes(log: &Log, from: u64, until: u64, columns: usize) -> Vec<[u32; Lane::ALL.len()]> {
    let mut counts = vec![[0; Lane::ALL.len()]; columns];
    let from = from.max(1);
    if columns == 0 || until < from {
        return counts;
    }
    let lane_of: Vec<usize> = Event::KINDS.iter().map(|kind| Lane::of(kind) as usize).collect();
    let steps = until - from + 1;
    for (i, kind) in log.kind_indices(from, until).enumerate() {
        let column = i as u128 * columns as u128 / u128::from(steps);
        counts[column as usize][lane_of[kind]] += 1;
    }
    counts
}
