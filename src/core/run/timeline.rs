//! A run over time, as the window and figures show it: lanes of events, curves, and where the invariants do not hold.

use super::log::Log;
use super::sample::Sample;
use crate::core::convert::{Event, EventKind};
use crate::core::kernel::number::{UNDEFINED, counted, fixed, grouped, size};
use crate::core::kernel::worded::worded;
use crate::core::mesh::ElementId;

/// The record of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracked {
    /// What the step did.
    pub kind: EventKind,
    /// How many quadrilaterals there are after it.
    pub standing: u32,
    /// Segments of the front after it.
    pub front: u32,
    /// Loops of the front, and how many of them are odd.
    pub loops: [u16; 2],
    /// Live triangles after it.
    pub live: u32,
    /// The quadrilateral that it formed, with its quality.
    pub formed: Option<(ElementId, f64)>,
}

impl Tracked {
    /// The record of a step of a log; `None` where it is not known.
    pub fn of(log: &Log, step: u64) -> Option<Tracked> {
        let formed = match log.event(step) {
            Some(Event::Formed { element, quality, .. }) => Some((*element, *quality)),
            _ => None,
        };
        let front = log.front(step);
        Some(Tracked {
            kind: log.kind(step)?,
            standing: log.nq(step) as u32,
            front: front.segments,
            loops: [front.loops, front.odd].map(|count| count.min(u16::MAX.into()) as u16),
            live: front.live,
            formed,
        })
    }
}

/// A row of ticks, and the kinds of events that share it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lane {
    /// Its name on the screen.
    pub name: &'static str,
    /// What it shows.
    pub kinds: &'static [EventKind],
    /// Whether these are failures.
    pub is_failure: bool,
}

/// The lanes, from top to bottom.
pub const LANES: [Lane; 5] = [
    Lane { name: "quad formed", kinds: &[EventKind::Formed], is_failure: false },
    Lane {
        name: "swap",
        kinds: &[EventKind::SideSwapped, EventKind::TopSwapped, EventKind::Enhanced],
        is_failure: false,
    },
    Lane { name: "divide, delete", kinds: &[EventKind::SideDivided, EventKind::NodeRemoved], is_failure: false },
    Lane {
        name: "seam, close, finish",
        kinds: &[
            EventKind::Seamed,
            EventKind::TransitionSeamed,
            EventKind::Split,
            EventKind::Closed,
            EventKind::Matched,
            EventKind::Patched,
            EventKind::LastResort,
            EventKind::Cleaned,
            EventKind::Refilled,
            EventKind::RowLaid,
            EventKind::Swept,
        ],
        is_failure: false,
    },
    Lane {
        name: "rolled back",
        kinds: &[
            EventKind::RolledBack,
            EventKind::Deferred,
            EventKind::SecondPass,
            EventKind::SeamRefused,
            EventKind::SplitRefused,
        ],
        is_failure: true,
    },
];

/// The events of a lane: how many there are in the whole run, and in each column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Counted {
    /// In the whole run.
    pub total: u64,
    /// In each column.
    pub bins: Vec<u32>,
}

/// The steps that are shown, over columns from the left to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The first and the last step.
    pub steps: [f64; 2],
    /// The number of columns between them.
    pub columns: usize,
}

impl Span {
    /// The place of a step, in columns.
    pub fn place(&self, step: f64) -> f64 {
        (step - self.steps[0]) / (self.steps[1] - self.steps[0]) * self.columns as f64
    }

    /// The steps of a track that are shown, as indices.
    pub fn seen(&self, track: &[Tracked]) -> std::ops::Range<usize> {
        let first = (self.steps[0].max(0.0) as usize).min(track.len());
        first..(self.steps[1].ceil() as usize).clamp(first, track.len())
    }
}

/// Counts the events of some lanes. An event is in the column that is nearest to its step.
pub fn count(track: &[Tracked], lanes: &[&[EventKind]], span: &Span) -> Vec<Counted> {
    let mut counts = vec![Counted { total: 0, bins: vec![0; span.columns + 1] }; lanes.len()];
    let lane_of = |kind| lanes.iter().position(|kinds| kinds.contains(kind));
    let lane_of: Vec<Option<usize>> = EventKind::ALL.iter().map(lane_of).collect();
    let seen = span.seen(track);
    for (k, tracked) in track.iter().enumerate() {
        let Some(lane) = lane_of[tracked.kind as usize] else { continue };
        counts[lane].total += 1;
        let column = span.place((k + 1) as f64).round().max(0.0) as usize;
        if seen.contains(&k)
            && let Some(bin) = counts[lane].bins.get_mut(column)
        {
            *bin += 1;
        }
    }
    counts
}

worded! {
    /// The quantity of a curve, in the order in which they are shown as far as there is room.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum CurveKind by name {
        /// Segments of the front.
        Front = "front length",
        /// The lowest quality that a quadrilateral had when it was formed.
        Quality = "worst quality, metric",
        /// Live triangles.
        Live = "live triangles",
        /// Loops of the front.
        Loops = "loops",
    }
}

/// What follows from the record of a run.
#[derive(Clone, Debug, Default)]
pub struct Timeline {
    /// The lowest quality that a quadrilateral formed up to each step had when it was formed.
    worst: Vec<f64>,
    /// Front, live triangles and loops after each step.
    figures: Vec<[u32; 3]>,
    first: Option<Sample>,
    broken: Vec<[u64; 2]>,
}

impl Timeline {
    /// Follows the record of a run, and its samples in order; the first one is that of step 0.
    pub fn of(track: &[Tracked], samples: &[Sample]) -> Timeline {
        let mut worst = f64::INFINITY;
        let qualities = track.iter().map(|tracked| {
            worst = tracked.formed.map_or(worst, |formed| worst.min(formed.1));
            worst
        });
        let worst = qualities.collect();
        let figures = track.iter().map(|t| [t.front, t.live, t.loops[0].into()]).collect();
        let mut timeline = Timeline { worst, figures, first: samples.first().copied(), broken: Vec::new() };
        let mut before = 0;
        for sample in samples {
            if timeline.broken(sample).is_some() {
                timeline.broken.push([before, sample.step]);
            }
            before = sample.step;
        }
        // Parity is known after every step.
        if timeline.first.is_some_and(|first| first.front.odd == 0) {
            for (k, _) in track.iter().enumerate().filter(|(_, tracked)| tracked.loops[1] > 0) {
                let step = k as u64 + 1;
                match timeline.broken.last_mut() {
                    Some(last) if last[1] + 1 == step => last[1] = step,
                    _ => timeline.broken.push([step, step]),
                }
            }
        }
        timeline
    }

    /// The invariant that does not hold in a sample: orientation, area, Euler's number, parity of the loops.
    pub fn broken(&self, sample: &Sample) -> Option<String> {
        let first = self.first?;
        if sample.inverted > 0 {
            let are = if sample.inverted == 1 { "is" } else { "are" };
            return Some(format!("{} {are} not positive", counted(sample.inverted as u64, "element")));
        }
        let (area, euler) = sample.invariants(&first);
        let then = if sample.shared.is_some() { "for both halves" } else { "at step 0" };
        if sample.euler != euler {
            return Some(format!("nodes \u{2212} edges + elements was {euler} {then}"));
        }
        if (sample.area - area).abs() > 1e-9 * area.abs() {
            return Some(format!("the area was {} {then}", size(area)));
        }
        let odd = u64::from(sample.front.odd);
        let are = if odd == 1 { "is" } else { "are" };
        (first.front.odd == 0 && odd > 0).then(|| format!("{} {are} odd", counted(odd, "loop")))
    }

    /// Ranges of steps in which an invariant does not hold.
    pub fn broken_spans(&self) -> &[[u64; 2]] {
        &self.broken
    }

    /// The lowest quality that a quadrilateral formed up to a step had when it was formed.
    pub fn worst_formed(&self, step: u64) -> Option<f64> {
        self.worst.get(step.checked_sub(1)? as usize).copied()
    }

    /// The height of a curve after a step from 1 on: a quality is 1 before the first quadrilateral.
    pub fn height(&self, of: CurveKind, step: u64) -> f64 {
        match of {
            CurveKind::Quality => self.worst_formed(step).unwrap_or(1.0).min(1.0),
            _ => self.figure(of, step).map_or(0.0, f64::from),
        }
    }

    /// The value of a curve at a step.
    pub fn value(&self, of: CurveKind, step: u64) -> String {
        match of {
            CurveKind::Quality => fixed(self.worst_formed(step).unwrap_or(f64::NAN), 2),
            _ => self.figure(of, step).map_or(UNDEFINED.to_owned(), |figure| grouped(figure.into())),
        }
    }

    fn figure(&self, of: CurveKind, step: u64) -> Option<u32> {
        let figures = match step.checked_sub(1) {
            None => self.first.map(|first| [first.front.segments, first.front.live, first.front.loops]),
            Some(k) => self.figures.get(k as usize).copied(),
        };
        let place = match of {
            CurveKind::Front => 0,
            CurveKind::Live => 1,
            CurveKind::Loops => 2,
            CurveKind::Quality => return None,
        };
        figures.map(|figures| figures[place])
    }
}
