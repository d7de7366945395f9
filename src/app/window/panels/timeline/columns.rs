//! The contents of the timeline by columns of pixels, computed again only when the run, the span or the width changes.

use std::ops::Deref;

use super::CURVE;
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

/// The points of a line, places ascending, that are needed to show each of them within `error` of its value: a line
/// goes on for as long as one slope serves all that it passes.
fn simplified(line: &[(f32, f32)], error: f32) -> Vec<(f32, f32)> {
    let Some(&first) = line.first() else { return Vec::new() };
    let any = [f32::NEG_INFINITY, f32::INFINITY];
    let slope = |from: (f32, f32), (place, value): (f32, f32)| (value - from.1) / (place - from.0);
    let (mut kept, mut from, mut last, mut slopes) = (vec![first], first, first, any);
    for &next in &line[1..] {
        if !(slopes[0]..=slopes[1]).contains(&slope(from, next)) {
            kept.push(last);
            (from, slopes) = (last, any);
        }
        let [low, high] = [next.1 - error, next.1 + error].map(|value| slope(from, (next.0, value)));
        (slopes, last) = ([slopes[0].max(low), slopes[1].min(high)], next);
    }
    kept.extend((last != from).then_some(last));
    kept
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
        curve.line = simplified(&curve.line, 0.3 * curve.top / CURVE);
        curve
    }

    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    pub fn curves(&self) -> &[Curve] {
        &self.curves
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value of a line at a place.
    fn at(line: &[(f32, f32)], place: f32) -> f32 {
        let k = line.partition_point(|point| point.0 < place).clamp(1, line.len() - 1);
        let [a, b] = [line[k - 1], line[k]];
        a.1 + (b.1 - a.1) * (place - a.0) / (b.0 - a.0)
    }

    #[test]
    fn a_simplified_line_shows_each_value_within_the_error() {
        let wave = |k: i32| (k as f32, 40.0 * libm::sinf(0.01 * k as f32) + (k * 7919 % 13) as f32 * 0.05);
        let jump = |k: i32| (k as f32, if k < 500 { 3.0 } else { 90.0 });
        let straight = |k: i32| (k as f32, 2.0 * k as f32);
        for (line, most) in [(wave as fn(i32) -> (f32, f32), 200), (jump, 4), (straight, 2)] {
            let line: Vec<_> = (0..1000).map(line).collect();
            let kept = simplified(&line, 0.5);
            assert!(kept.len() <= most, "{}", kept.len());
            for point in &line {
                assert!((at(&kept, point.0) - point.1).abs() <= 0.501, "{point:?}");
            }
        }
        assert!(simplified(&[], 1.0).is_empty());
        assert_eq!(simplified(&[(1.0, 2.0)], 1.0), [(1.0, 2.0)]);
    }
}
