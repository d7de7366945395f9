//! The contents of the timeline by columns of pixels, computed again only when the run, the span or the width changes.

use crate::app::window::session::Tracked;
use crate::app::window::state::State;
use crate::app::window::words;
use crate::core::convert::EventKind;
use crate::core::kernel::worded::worded;
use crate::core::run::Sample;

/// The rows: each with the kinds that share it.
const ROWS: [(&str, &[EventKind]); 5] = [
    ("quad formed", &[EventKind::Formed]),
    ("swap", &[EventKind::SideSwapped, EventKind::TopSwapped, EventKind::Enhanced]),
    ("divide, delete", &[EventKind::SideDivided, EventKind::NodeRemoved]),
    (
        "seam, close, finish",
        &[
            EventKind::Seamed,
            EventKind::TransitionSeamed,
            EventKind::Split,
            EventKind::Closed,
            EventKind::Matched,
            EventKind::Patched,
            EventKind::LastResort,
            EventKind::Cleaned,
            EventKind::Refilled,
            EventKind::Swept,
        ],
    ),
    (
        "rolled back",
        &[
            EventKind::RolledBack,
            EventKind::Deferred,
            EventKind::SecondPass,
            EventKind::SeamRefused,
            EventKind::SplitRefused,
        ],
    ),
];
/// The row of failures.
const FAILURES: usize = 4;

/// One row of ticks.
pub struct Lane {
    pub name: String,
    /// How many events there are in the whole run.
    pub total: u64,
    /// How many there are in each column.
    pub bins: Vec<u32>,
    pub is_failure: bool,
    /// The row of kinds that it belongs to, if there are several.
    pub group: Option<usize>,
    pub is_open: bool,
    pub kinds: &'static [EventKind],
}

worded! {
    /// The quantity of a curve, in the order in which they are shown as far as there is room.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum CurveKind by name {
        Front = "front length",
        Quality = "worst quality, metric",
        Live = "live triangles",
        Loops = "loops",
    }
}

impl CurveKind {
    fn of(self, tracked: &Tracked) -> f32 {
        match self {
            CurveKind::Front => tracked.front as f32,
            CurveKind::Quality => tracked.formed.map_or(1.0, |formed| formed.1 as f32),
            CurveKind::Live => tracked.live as f32,
            CurveKind::Loops => f32::from(tracked.loops[0]),
        }
    }
}

/// One curve: places in points from the left, with values.
pub struct Curve {
    pub of: CurveKind,
    pub line: Vec<(f32, f32)>,
    pub dots: Vec<(f32, f32)>,
    /// The value at the top.
    pub top: f32,
}

/// Everything that the timeline shows.
#[derive(Default)]
pub struct Columns {
    seen: Option<(u64, [f64; 2], usize, Option<usize>)>,
    lanes: Vec<Lane>,
    curves: Vec<Curve>,
    /// The lowest quality that a quadrilateral formed up to each step had when it was formed.
    worst: Vec<f64>,
    /// Front, live triangles and loops after each step.
    figures: Vec<[u32; 3]>,
    first: Option<Sample>,
    broken: Vec<[u64; 2]>,
}

impl Columns {
    /// Counts again if anything has changed.
    pub fn update(&mut self, state: &State, open_row: Option<usize>, span: [f64; 2], width: f32) {
        let columns = width.max(1.0) as usize;
        let seen = Some((state.run().track_epoch, span, columns, open_row));
        if self.seen == seen {
            return;
        }
        if self.seen.is_none_or(|before| before.0 != state.run().track_epoch) {
            self.follow(state);
        }
        self.seen = seen;
        let place = |step: usize| ((step as f64 - span[0]) / (span[1] - span[0]) * columns as f64) as f32;
        let first = (span[0].max(0.0) as usize).min(state.run().track.len());
        let last = (span[1].ceil() as usize).clamp(first, state.run().track.len());
        self.count_lanes(state, open_row, first..last, columns, &place);
        self.curves.clear();
        for of in CurveKind::ALL {
            self.curves.push(self.curve_of(of, state, first..last, columns, &place));
        }
    }

    /// Follows the record of the run.
    fn follow(&mut self, state: &State) {
        let mut worst = f64::INFINITY;
        let qualities = state.run().track.iter().map(|tracked| {
            worst = tracked.formed.map_or(worst, |formed| worst.min(formed.1));
            worst
        });
        self.worst = qualities.collect();
        self.figures = state.run().track.iter().map(|t| [t.front, t.live, t.loops[0].into()]).collect();
        self.first = state.run().samples.first().copied();
        self.broken.clear();
        let mut before = 0;
        for sample in &state.run().samples {
            if self.broken(sample).is_some() {
                self.broken.push([before, sample.step]);
            }
            before = sample.step;
        }
        // Parity is known after every step.
        if self.first.is_some_and(|first| first.front.odd == 0) {
            for (k, _) in state.run().track.iter().enumerate().filter(|(_, tracked)| tracked.loops[1] > 0) {
                let step = k as u64 + 1;
                match self.broken.last_mut() {
                    Some(last) if last[1] + 1 == step => last[1] = step,
                    _ => self.broken.push([step, step]),
                }
            }
        }
    }

    /// The invariant that does not hold in a sample: orientation, area, Euler's number, parity of the loops.
    pub fn broken(&self, sample: &Sample) -> Option<String> {
        let first = self.first?;
        if sample.inverted > 0 {
            let are = if sample.inverted == 1 { "is" } else { "are" };
            return Some(format!("{} {are} not positive", words::counted(sample.inverted as u64, "element")));
        }
        if sample.euler != first.euler {
            return Some(format!("nodes \u{2212} edges + elements was {} at step 0", first.euler));
        }
        if (sample.area - first.area).abs() > 1e-9 * first.area.abs() {
            return Some(format!("the area was {} at step 0", words::size(first.area)));
        }
        let odd = u64::from(sample.front.odd);
        let are = if odd == 1 { "is" } else { "are" };
        (first.front.odd == 0 && odd > 0).then(|| format!("{} {are} odd", words::counted(odd, "loop")))
    }

    fn count_lanes(
        &mut self,
        state: &State,
        open_row: Option<usize>,
        seen: std::ops::Range<usize>,
        columns: usize,
        place: &dyn Fn(usize) -> f32,
    ) {
        self.lanes.clear();
        for (k, (name, kinds)) in ROWS.iter().enumerate() {
            let is_open = open_row == Some(k);
            let group = (kinds.len() > 1).then_some(k);
            let lane = |name: String, kinds| Lane {
                name,
                total: 0,
                bins: vec![0; columns + 1],
                is_failure: k == FAILURES,
                group,
                is_open,
                kinds,
            };
            if is_open {
                self.lanes.extend(kinds.chunks(1).map(|kind| lane(words::kind(kind[0]), kind)));
            } else {
                self.lanes.push(lane((*name).to_owned(), kinds));
            }
        }
        let lane_of = |kind| self.lanes.iter().position(|lane| lane.kinds.contains(kind));
        let lanes: Vec<Option<usize>> = EventKind::ALL.iter().map(lane_of).collect();
        for (k, tracked) in state.run().track.iter().enumerate() {
            let Some(lane) = lanes[tracked.kind as usize] else { continue };
            self.lanes[lane].total += 1;
            if seen.contains(&k)
                && let Some(bin) = self.lanes[lane].bins.get_mut(place(k + 1).round().max(0.0) as usize)
            {
                *bin += 1;
            }
        }
    }

    fn curve_of(
        &self,
        of: CurveKind,
        state: &State,
        seen: std::ops::Range<usize>,
        columns: usize,
        place: &dyn Fn(usize) -> f32,
    ) -> Curve {
        let mut curve = Curve { of, line: Vec::new(), dots: Vec::new(), top: 1.0 };
        let every = (seen.len() / (2 * columns).max(1)).max(1);
        for k in seen.clone().step_by(every) {
            let value =
                if of == CurveKind::Quality { self.worst[k].min(1.0) as f32 } else { of.of(&state.run().track[k]) };
            curve.line.push((place(k + 1), value));
        }
        match of {
            CurveKind::Quality => {
                let formed = seen.filter_map(|k| Some((k, state.run().track[k].formed?.1)));
                let dots: Vec<_> = formed.map(|(k, quality)| (place(k + 1), quality as f32)).collect();
                let every = (dots.len() / columns.max(1)).max(1);
                curve.dots = dots.into_iter().step_by(every).collect();
            }
            _ => curve.top = curve.line.iter().map(|point| point.1).fold(1.0, f32::max),
        }
        curve
    }

    pub fn lanes(&self) -> &[Lane] {
        &self.lanes
    }

    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }

    /// Ranges of steps in which an invariant does not hold.
    pub fn broken_spans(&self) -> &[[u64; 2]] {
        &self.broken
    }

    /// The lowest quality that a quadrilateral formed up to a step had when it was formed.
    pub fn worst_formed(&self, step: u64) -> Option<f64> {
        self.worst.get(step.checked_sub(1)? as usize).copied()
    }

    /// The value of a curve at a step.
    pub fn value(&self, of: CurveKind, step: u64) -> String {
        let k = step.checked_sub(1).map(|k| k as usize);
        let figures = match k {
            None => self.first.map(|first| [first.front.segments, first.front.live, first.front.loops]),
            Some(k) => self.figures.get(k).copied(),
        };
        let figure = |at: usize| figures.map_or(words::UNDEFINED.to_owned(), |f| words::grouped(f[at].into()));
        match of {
            CurveKind::Front => figure(0),
            CurveKind::Live => figure(1),
            CurveKind::Loops => figure(2),
            CurveKind::Quality => words::fixed(self.worst_formed(step).unwrap_or(f64::NAN), 2),
        }
    }
}
