//! A run over time: one lane for each kind of work.

use serde::Serialize;

use super::log::Log;
use crate::core::convert::EventKind;

/// The kinds of work; each is a lane.
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
    /// Attempts rolled back, segments deferred, second passes.
    Failed,
    /// Enhancement and smoothing around a new quadrilateral (4.3.6).
    Local,
    /// Seams (4.3.6).
    Seams,
    /// Splits of the front (4.3.6).
    Splits,
    /// Small loops closed, and the last resort.
    Closing,
    /// Clean-up and smoothing of the whole mesh (4.3.7), and the end of faces and of the run.
    Finishing,
}

impl Lane {
    /// All lanes, from top to bottom.
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
    pub fn of(kind: EventKind) -> Lane {
        match kind {
            EventKind::BaseSelected | EventKind::PickLost => Lane::Base,
            EventKind::SideIsFront | EventKind::SideChosen | EventKind::SideSwapped | EventKind::SideDivided => {
                Lane::Sides
            }
            EventKind::TopSwapped | EventKind::TopSmoothed | EventKind::TopFound => Lane::Top,
            EventKind::Formed => Lane::Formed,
            EventKind::RolledBack | EventKind::Deferred | EventKind::SecondPass => Lane::Failed,
            EventKind::Enhanced | EventKind::Smoothed | EventKind::NodeRemoved => Lane::Local,
            EventKind::Seamed | EventKind::TransitionSeamed | EventKind::SeamRefused => Lane::Seams,
            EventKind::Split | EventKind::SplitRefused => Lane::Splits,
            EventKind::Closed | EventKind::Matched | EventKind::Patched | EventKind::LastResort => Lane::Closing,
            EventKind::Cleaned
            | EventKind::Refilled
            | EventKind::Swept
            | EventKind::Unfolded
            | EventKind::FaceConverted
            | EventKind::PostProcessed
            | EventKind::Finished => Lane::Finishing,
        }
    }

    /// Its name on the screen.
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

/// Counts the steps of each lane in `columns` equal parts of the steps from `from` to `until` (both included): by
/// column, then by the index of the lane in [`Lane::ALL`]. Linear in the number of steps.
pub fn lanes(log: &Log, from: u64, until: u64, columns: usize) -> Vec<[u32; Lane::ALL.len()]> {
    let mut counts = vec![[0; Lane::ALL.len()]; columns];
    let from = from.max(1);
    if columns == 0 || until < from {
        return counts;
    }
    let steps = until - from + 1;
    for (i, kind) in log.kinds(from, until).enumerate() {
        let column = i as u128 * columns as u128 / u128::from(steps);
        counts[column as usize][Lane::of(kind) as usize] += 1;
    }
    counts
}
