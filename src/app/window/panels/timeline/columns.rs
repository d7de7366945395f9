//! The contents of the timeline by columns of pixels, computed again only when the run, the span or the width changes.

use std::ops::Deref;

use crate::app::window::state::State;
use crate::app::window::words;
use crate::core::convert::EventKind;
use crate::core::run::timeline::{CurveKind, LANES, Span, Timeline, count};

/// One row of ticks.
pub struct Row {
    pub name: String,
    /// How many events there are in the whole run.
    pub total: u64,
    /// How many there are in each column.
    pub bins: Vec<u32>,
    pub is_failure: bool,
    /// The lane of several kinds that it belongs to.
    pub group: Option<usize>,
    pub is_open: bool,
    pub kinds: &'static [EventKind],
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
    rows: Vec<Row>,
    curves: Vec<Curve>,
    timeline: Timeline,
}

impl Deref for Columns {
    type Target = Timeline;

    fn deref(&self) -> &Timeline {
        &self.timeline
    }
}

impl Columns {
    /// Counts again if anything has changed.
    pub fn update(&mut self, state: &State, open_row: Option<usize>, steps: [f64; 2], width: f32) {
        let span = Span { steps, columns: width.max(1.0) as usize };
        let seen = Some((state.run().track_epoch, steps, span.columns, open_row));
        if self.seen == seen {
            return;
        }
        if self.seen.is_none_or(|before| before.0 != state.run().track_epoch) {
            self.timeline = Timeline::of(&state.run().track, &state.run().samples);
        }
        self.seen = seen;
        self.count_rows(state, open_row, &span);
        self.curves = CurveKind::ALL.into_iter().map(|of| self.curve_of(of, state, &span)).collect();
    }

    fn count_rows(&mut self, state: &State, open_row: Option<usize>, span: &Span) {
        self.rows.clear();
        for (k, lane) in LANES.into_iter().enumerate() {
            let is_open = open_row == Some(k);
            let group = (lane.kinds.len() > 1).then_some(k);
            let is_failure = lane.is_failure;
            let row = |name, kinds| Row { name, total: 0, bins: Vec::new(), is_failure, group, is_open, kinds };
            if is_open {
                self.rows.extend(lane.kinds.chunks(1).map(|kind| row(words::kind(kind[0]), kind)));
            } else {
                self.rows.push(row(lane.name.to_owned(), lane.kinds));
            }
        }
        let kinds: Vec<_> = self.rows.iter().map(|row| row.kinds).collect();
        for (row, counted) in self.rows.iter_mut().zip(count(&state.run().track, &kinds, span)) {
            (row.total, row.bins) = (counted.total, counted.bins);
        }
    }

    fn curve_of(&self, of: CurveKind, state: &State, span: &Span) -> Curve {
        let track = &state.run().track;
        let mut curve = Curve { of, line: Vec::new(), dots: Vec::new(), top: 1.0 };
        let seen = span.seen(track);
        let place = |k: usize| span.place((k + 1) as f64) as f32;
        let every = (seen.len() / (2 * span.columns).max(1)).max(1);
        for k in seen.clone().step_by(every) {
            curve.line.push((place(k), self.timeline.height(of, k as u64 + 1) as f32));
        }
        match of {
            CurveKind::Quality => {
                let formed = seen.filter_map(|k| Some((k, track[k].formed?.1)));
                let dots: Vec<_> = formed.map(|(k, quality)| (place(k), quality as f32)).collect();
                let every = (dots.len() / span.columns.max(1)).max(1);
                curve.dots = dots.into_iter().step_by(every).collect();
            }
            _ => curve.top = curve.line.iter().map(|point| point.1).fold(1.0, f32::max),
        }
        curve
    }

    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }
}
