//! The run along its steps: lanes for kinds of events, invariants, curves, bookmarks, and the play head. Click or drag
//! to seek; the wheel zooms, sideways it moves, a double click shows the whole run.

mod columns;

use eframe::egui::{
    self, Align2, Mesh, Pos2, Rangef, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo,
};

use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::pair::Which;
use crate::app::window::session::{Goal, Verdict};
use crate::app::window::state::{Pair, State};
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::run::timeline::CurveKind;
use crate::render::palette::{Palette, Rgba};
use columns::{Columns, Curve, Row};

/// The label column and the counts, in points.
const LABELS: f32 = 118.0;
const COUNTS: f32 = 104.0;
const LANE: f32 = 12.0;
const GAP: f32 = 2.0;
/// Height of the ruler with bookmarks and breakpoints.
const RULER: f32 = 24.0;
/// Height of a curve.
const CURVE: f32 = 24.0;
/// Opacity before and after the current step.
const TIMES: [f32; 2] = [0.8, 0.38];
/// How near to a bookmark a click must be, in points.
const NEAR: f32 = 6.0;

/// What the timeline keeps for itself.
#[derive(Default)]
pub struct TimelineState {
    columns: Columns,
    /// Those of the other run, where there are two.
    others: Columns,
    /// The row whose kinds have rows of their own.
    open_row: Option<usize>,
    /// The steps that are shown, unless those are all, and the number of the run that they belong to.
    span: Option<[f64; 2]>,
    run: u64,
    /// The step that a drag has asked for.
    seeking: Option<u64>,
}

/// Shows the timeline of the run that the panels show, and the lanes of the other one where there are two; `window` is
/// the first run.
pub fn show(ui: &mut Ui, window: &State, local: &mut TimelineState, commands: &mut Vec<Command>, palette: &Palette) {
    let state = window.active();
    let rect = ui.max_rect();
    let plot = Rect::from_min_max(
        Pos2::new(rect.left() + LABELS, rect.top() + 4.0),
        Pos2::new((rect.right() - COUNTS).max(rect.left() + LABELS + 10.0), rect.bottom() - 4.0),
    );
    let response =
        ui.interact(plot.expand2(Vec2::new(6.0, 4.0)), ui.scope_id().with("timeline"), Sense::click_and_drag());
    if std::mem::replace(&mut local.run, state.run().number) != state.run().number {
        local.span = None;
    }
    let Some(moment) = &state.run().moment else { return };
    let spoken = format!("Timeline: step {} of {}", moment.step, state.run().track.len());
    response.widget_info(|| WidgetInfo::labeled(Role::Slider, true, spoken.clone()));
    let other = window.pair().map(|pair| window.of(pair.active.other()));
    let all = [Some(state), other].into_iter().flatten().map(|state| state.run().track.len()).max();
    let axis = Axis { plot, span: turn(ui, &response, plot, all.unwrap_or(0), local) };
    local.columns.update(state, local.open_row, axis.span, plot.width());
    let mut lanes = plot.top() + RULER;
    if let Some(other) = other {
        local.others.update(other, None, axis.span, plot.width());
        if window.active_run() == Which::B {
            lanes += local.others.rows().len() as f32 * (LANE + GAP) + GAP;
        }
    }
    let step = seek(&response, &axis, lanes, state, local, moment.step);
    commands.extend(step.map(|step| Command::Go(Goal::Step(step))));
    let TimelineState { columns, others, open_row, .. } = local;
    let painter = ui.painter_at(rect);
    let worst = moment.worst.map(|worst| worst.1);
    let drawing = Drawing { painter, axis, palette, now: moment.step, worst };
    let mut y = drawing.ruler(state, plot.top());
    let fits = |y: f32, height: f32| y + height <= plot.bottom() + 2.0;
    let first = y;
    for which in Which::ALL.into_iter().filter(|which| *which == Which::A || other.is_some()) {
        let (shown, columns) =
            if which == window.active_run() { (state, &*columns) } else { (window.of(which), &*others) };
        let top = y;
        for lane in columns.rows() {
            if !fits(y, LANE) {
                break;
            }
            drawing.lane(lane, y, shown.run().track.len());
            if which == window.active_run()
                && let Some(group) = label_button(ui, &drawing.axis, lane, y)
            {
                *open_row = if *open_row == Some(group) { None } else { Some(group) };
            }
            y += LANE + GAP;
        }
        if other.is_some() {
            drawing.letter(which, 0.5 * (top + y - GAP), which == window.active_run());
            y += GAP;
        }
    }
    if let Some(step) = window.pair().and_then(Pair::first_difference) {
        drawing.first_difference(step, plot.top(), [first, y - GAP]);
    }
    if fits(y, LANE) {
        drawing.invariants(columns, y, state);
        y += LANE + GAP;
    }
    for curve in columns.curves() {
        if !fits(y, CURVE) {
            break;
        }
        drawing.curve(curve, columns, y);
        y += CURVE + GAP;
    }
    drawing.head(y.min(plot.bottom()));
    if let Some(at) = response.hover_pos() {
        response.on_hover_text_at_pointer(hovered(&drawing.axis, state, columns, at));
    }
}

/// The steps that are shown, after zooming and scrolling.
fn turn(ui: &Ui, response: &Response, plot: Rect, all: usize, local: &mut TimelineState) -> [f64; 2] {
    let all = all.max(1) as f64;
    let mut span = local.span.filter(|span| span[1] <= all).unwrap_or([0.0, all]);
    if let Some(at) = response.hover_pos() {
        let scroll = ui.input(|input| input.smooth_scroll_delta());
        if scroll.y != 0.0 {
            let share = f64::from((at.x - plot.left()) / plot.width());
            span = zoomed(span, all, share, libm::exp(f64::from(-scroll.y) * 0.004));
        }
        if scroll.x != 0.0 {
            let by = f64::from(-scroll.x / plot.width()) * (span[1] - span[0]);
            let by = by.clamp(-span[0], all - span[1]);
            span = [span[0] + by, span[1] + by];
        }
    }
    if response.double_clicked() {
        span = [0.0, all];
    }
    local.span = (span[1] - span[0] < all).then_some(span);
    span
}

/// The step to go to: a click or a drag goes to the step under the pointer; a click near a bookmark or a breakpoint
/// goes there, and one in a row of events to an event of the row. `lanes`: where the rows of this run begin.
fn seek(
    response: &Response,
    axis: &Axis,
    lanes: f32,
    state: &State,
    local: &mut TimelineState,
    now: u64,
) -> Option<u64> {
    let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) else {
        local.seeking = None;
        return None;
    };
    let mut step = axis.step(at.x).round().clamp(0.0, state.run().track.len() as f64) as u64;
    let away = |mark: &u64| (axis.x(*mark as f64) - at.x).abs();
    let reach = [-NEAR, NEAR].map(|by| axis.step(at.x + by).clamp(0.0, state.run().track.len() as f64) as u64);
    let row = (at.y - lanes).div_euclid(LANE + GAP);
    let nearest = if at.y < axis.plot.top() + RULER {
        let marks = state
            .document()
            .bookmarks
            .iter()
            .map(|mark| mark.step)
            .chain(stops(state).flat_map(|hits| within(hits, reach)));
        marks.min_by(|a, b| away(a).total_cmp(&away(b)))
    } else if let Some(lane) = local.columns.rows().get(row as usize).filter(|_| response.clicked() && row >= 0.0) {
        let steps = (reach[0].max(1)..=reach[1]).filter(|step| {
            state.run().track.get(*step as usize - 1).is_some_and(|tracked| lane.kinds.contains(&tracked.kind))
        });
        steps.min_by(|a, b| away(a).total_cmp(&away(b)))
    } else {
        None
    };
    step = nearest.filter(|mark| away(mark) < NEAR).unwrap_or(step);
    (step != now && local.seeking.replace(step) != Some(step)).then_some(step)
}

/// The steps at which each breakpoint that is on is met.
fn stops(state: &State) -> impl Iterator<Item = &[u64]> {
    let on = state.document().breakpoints.iter().zip(&state.run().hits);
    on.filter(|(breakpoint, _)| breakpoint.is_on).map(|(_, hits)| hits.as_slice())
}

/// Those of some steps in order that lie in a range.
fn within(steps: &[u64], [low, high]: [u64; 2]) -> impl Iterator<Item = u64> + '_ {
    steps[steps.partition_point(|step| *step < low)..].iter().copied().take_while(move |step| *step <= high)
}

/// The text for the step under the pointer.
fn hovered(axis: &Axis, state: &State, columns: &Columns, at: Pos2) -> String {
    let step = axis.step(at.x).round().clamp(0.0, state.run().track.len() as f64) as u64;
    let Some(tracked) = step.checked_sub(1).and_then(|k| state.run().track.get(k as usize)) else {
        return "step 0".to_owned();
    };
    let mut text = format!("step {}  \u{b7}  {}", words::grouped(step), words::kind(tracked.kind));
    let all = state.document().breakpoints.iter().zip(&state.run().hits);
    for (breakpoint, _) in all.filter(|(breakpoint, hits)| breakpoint.is_on && hits.binary_search(&step).is_ok()) {
        text += &format!("\nbreakpoint: {}", breakpoint.condition);
    }
    let [loops, odd] = tracked.loops;
    let [segments, loops] =
        [(tracked.front.into(), "segment"), (loops.into(), "loop")].map(|(n, one)| words::counted(n, one));
    text += &format!("\nfront: {segments}, {loops}, {odd} odd");
    text += &format!("\n{}", words::counted(tracked.live.into(), "live triangle"));
    if let Some(worst) = columns.worst_formed(step).filter(|worst| worst.is_finite()) {
        let worst = words::fixed(worst, 2);
        text += &format!("\nquality in the metric when formed (dots): the lowest up to here {worst} (line)");
    }
    let next = state.run().samples.partition_point(|sample| sample.step < step);
    if let Some(sample) = state.run().samples.get(next.min(state.run().samples.len().saturating_sub(1))) {
        let verdict = columns.broken(sample).unwrap_or_else(|| "invariants hold".to_owned());
        let at = words::grouped(sample.step);
        text += &format!(
            "\nchecked at step {at}: {verdict}; lowest quality there {}; area in the plane {}, in the metric {}; \
             nodes \u{2212} edges + elements {}",
            words::fixed(sample.worst_quality, 2),
            words::size(sample.area),
            words::size(sample.area_metric),
            words::fixed(sample.euler as f64, 0)
        );
    }
    text
}

/// The name of a row with several kinds is a button that gives each kind its own row, and back.
fn label_button(ui: &Ui, axis: &Axis, lane: &Row, y: f32) -> Option<usize> {
    let group = lane.group?;
    let rect =
        Rect::from_min_max(Pos2::new(axis.plot.left() - LABELS + 4.0, y), Pos2::new(axis.plot.left() - 8.0, y + LANE));
    let response = ui.interact(rect, ui.scope_id().with(("lane", lane.name.as_str())), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Lane: {}", lane.name)));
    let tip = if lane.is_open { "One row for these kinds" } else { "A row for each of these kinds" };
    response.on_hover_text(tip).clicked().then_some(group)
}

struct Axis {
    plot: Rect,
    span: [f64; 2],
}

impl Axis {
    fn x(&self, step: f64) -> f32 {
        let share = (step - self.span[0]) / (self.span[1] - self.span[0]);
        self.plot.left() + self.plot.width() * share as f32
    }

    fn step(&self, x: f32) -> f64 {
        self.span[0] + f64::from((x - self.plot.left()) / self.plot.width()) * (self.span[1] - self.span[0])
    }
}

/// The span after zooming by `factor` around a place; at most the whole run, at least 20 steps.
fn zoomed(span: [f64; 2], all: f64, at: f64, factor: f64) -> [f64; 2] {
    let width = span[1] - span[0];
    let new = (width * factor).clamp(20.0_f64.min(all), all);
    let start = (span[0] + at * (width - new)).clamp(0.0, all - new);
    [start, start + new]
}

struct Drawing<'a> {
    painter: egui::Painter,
    axis: Axis,
    palette: &'a Palette,
    now: u64,
    /// The lowest quality of a quadrilateral now.
    worst: Option<f64>,
}

impl Drawing<'_> {
    fn text(&self, at: Pos2, anchor: Align2, text: impl ToString, colour: Rgba) {
        self.painter.text(at, anchor, text, theme::regular(theme::TIMELINE), ink(colour));
    }

    /// The column of the play head.
    fn head_column(&self) -> f32 {
        self.axis.x(self.now as f64) - self.axis.plot.left()
    }

    fn ruler(&self, state: &State, top: f32) -> f32 {
        let Drawing { axis, palette, .. } = self;
        let width = axis.span[1] - axis.span[0];
        let wanted = width / f64::from(axis.plot.width() / 90.0);
        let power = libm::pow(10.0, libm::floor(libm::log10(wanted.max(1.0))));
        let every = [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|e| *e >= wanted).unwrap_or(10.0 * power);
        let mut tick = (axis.span[0] / every).ceil() * every;
        let head = axis.x(self.now as f64);
        while tick <= axis.span[1] {
            let x = axis.x(tick);
            if (x - head).abs() > 34.0 {
                self.text(Pos2::new(x, top), Align2::CENTER_TOP, words::grouped(tick as u64), palette.weak);
            }
            tick += every;
        }
        for mark in &state.document().bookmarks {
            let x = axis.x(mark.step as f64);
            if axis.plot.x_range().contains(x) {
                self.text(Pos2::new(x, top + 12.0), Align2::CENTER_TOP, icons::BOOKMARK, palette.text);
            }
        }
        // Breakpoints stand where they hold: one mark for all steps of a pixel.
        for hits in stops(state) {
            let mut rest = &hits[hits.partition_point(|step| (*step as f64) < axis.span[0])..];
            while let Some(&step) = rest.first().filter(|step| **step as f64 <= axis.span[1]) {
                let x = axis.x(step as f64);
                self.painter.circle_filled(Pos2::new(x, top + 19.0), 2.2, ink(palette.strong));
                rest = &rest[rest.partition_point(|step| axis.x(*step as f64) < x + 1.0)..];
            }
        }
        top + RULER
    }

    fn label(&self, y: f32, name: &str, count: &str, colour: Rgba) {
        let plot = self.axis.plot;
        self.text(Pos2::new(plot.left() - 9.0, y), Align2::RIGHT_CENTER, name, self.palette.weak);
        self.count(y, count, colour);
    }

    fn count(&self, y: f32, count: &str, colour: Rgba) {
        let right = self.axis.plot.right() + COUNTS - 32.0;
        self.text(Pos2::new(right, y), Align2::RIGHT_CENTER, count, colour);
    }

    /// The letter of a run beside its lanes.
    fn letter(&self, which: Which, y: f32, is_active: bool) {
        let at = Pos2::new(self.axis.plot.left() - LABELS + 10.0, y);
        let colour = if is_active { self.palette.accent } else { self.palette.text };
        self.painter.text(at, Align2::LEFT_CENTER, which.name(), theme::semibold(theme::BODY), ink(colour));
    }

    /// Tints the part in which two runs are the same, and marks its end.
    fn first_difference(&self, step: u64, top: f32, [from, until]: [f32; 2]) {
        let Drawing { axis, palette, .. } = self;
        let x = axis.x(step as f64).clamp(axis.plot.left(), axis.plot.right());
        let same = Rect::from_min_max(Pos2::new(axis.plot.left(), from), Pos2::new(x, until));
        self.painter.rect_filled(same, 0.0, ink(palette.holds.faded(0.14)));
        let line = [Pos2::new(x, top + 14.0), Pos2::new(x, until)];
        self.painter.extend(Shape::dashed_line(&line, Stroke::new(1.2, ink(palette.accent)), 4.0, 3.0));
        let (text, font) = ("first difference", theme::regular(theme::TIMELINE));
        let text = self.painter.layout_no_wrap(text.to_owned(), font, ink(palette.accent));
        let head = axis.plot.left() + self.head_column();
        let sides = [x + 4.0, x - 4.0 - text.size().x].map(|left| Rangef::new(left, left + text.size().x));
        let fits = |side: &&Rangef| axis.plot.x_range().contains(side.min) && axis.plot.x_range().contains(side.max);
        // Where there is room on both sides, the play head does not cross it.
        let is_clear = |side: &&Rangef| !side.expand(2.0).contains(head);
        let mut in_plot = sides.iter().filter(fits);
        let side = in_plot.clone().find(is_clear).or_else(|| in_plot.next()).unwrap_or(&sides[0]);
        let left = side.min;
        self.painter.galley(Pos2::new(left, top + 12.0), text, ink(palette.accent));
    }

    /// One tick for each event, or a density strip if there are several in many columns.
    fn lane(&self, lane: &Row, y: f32, steps: usize) {
        let plot = self.axis.plot;
        let end = self.axis.x(steps as f64).clamp(plot.left(), plot.right());
        let ground = Rect::from_min_max(Pos2::new(plot.left(), y), Pos2::new(end, y + LANE));
        self.painter.rect_filled(ground, 0.0, ink(self.palette.line.faded(0.45)));
        let colour = if lane.is_failure { self.palette.broken } else { self.palette.dead_edge };
        let head = self.head_column();
        let most = lane.bins.iter().copied().max().unwrap_or(1).max(1) as f32;
        let is_dense = lane.bins.iter().filter(|count| **count > 1).count() > lane.bins.len() / 8;
        // One mesh without soft edges: there are hundreds of columns.
        let left = self.painter.round_to_pixel_center(plot.left()) - 0.5 / self.painter.pixels_per_point();
        let mut columns = Mesh::default();
        for (k, count) in lane.bins.iter().enumerate().filter(|(_, count)| **count > 0) {
            let time = TIMES[usize::from(k as f32 > head + 0.5)];
            let (density, margin) = if is_dense { (0.2 + 0.8 * *count as f32 / most, 0.0) } else { (1.0, 2.0) };
            let column = Rect::from_min_size(Pos2::new(left + k as f32, y), Vec2::new(1.0, LANE));
            columns.add_colored_rect(column.shrink2(Vec2::new(0.0, margin)), ink(colour.faded(time * density)));
        }
        self.painter.add(columns);
        self.label(y + 0.5 * LANE, &lane.name, &words::grouped(lane.total), self.palette.text);
    }

    fn invariants(&self, columns: &Columns, y: f32, state: &State) {
        let Drawing { axis, palette, .. } = self;
        let middle = y + 0.5 * LANE;
        let known = axis.x(state.run().track.len() as f64).min(axis.plot.right());
        let line = Stroke::new(3.0, ink(palette.holds.faded(0.8)));
        self.painter.hline(axis.plot.left()..=known.max(axis.plot.left()), middle, line);
        for [from, until] in columns.broken_spans() {
            let red = Stroke::new(5.0, ink(palette.broken));
            let [a, b] = [*from, *until].map(|step| axis.x(step as f64).clamp(axis.plot.left(), axis.plot.right()));
            self.painter.hline(a..=b.max(a + 2.0), middle, red);
        }
        let is_broken = matches!(state.run().verdict, Verdict::Broken(_)) || !columns.broken_spans().is_empty();
        let (text, colour) = if is_broken { ("broken", palette.broken) } else { ("hold", palette.holds) };
        self.label(middle, "invariants", text, colour);
    }

    fn curve(&self, curve: &Curve, columns: &Columns, y: f32) {
        let plot = self.axis.plot;
        let place = |x: f32, value: f32| {
            Pos2::new(plot.left() + x, y + CURVE - 2.0 - (CURVE - 4.0) * value / curve.top.max(f32::MIN_POSITIVE))
        };
        for &(x, value) in &curve.dots {
            let time = TIMES[usize::from(x > self.head_column())];
            self.painter.circle_filled(place(x, value), 0.9, ink(self.palette.weak.faded(time)));
        }
        let head = self.head_column();
        let split = curve.line.partition_point(|point| point.0 <= head);
        for (part, fade) in [(0..split, 0.95), (split.saturating_sub(1)..curve.line.len(), TIMES[1])] {
            let line: Vec<Pos2> = curve.line[part].iter().map(|&(x, value)| place(x, value)).collect();
            self.painter.add(Shape::line(line, Stroke::new(1.3, ink(self.palette.text.faded(fade)))));
        }
        let value = columns.value(curve.of, self.now);
        let middle = y + 0.5 * CURVE;
        if curve.of == CurveKind::Quality {
            // Two numbers: in the mesh as it is, and of all quadrilaterals when they were formed.
            let now = words::fixed(self.worst.unwrap_or(f64::NAN), 2);
            self.label(middle, curve.of.name(), "", self.palette.text);
            self.count(middle - 0.25 * CURVE, &format!("now {now}"), self.palette.text);
            self.count(middle + 0.25 * CURVE, &format!("formed {value}"), self.palette.weak);
        } else {
            self.label(middle, curve.of.name(), &value, self.palette.text);
        }
    }

    fn head(&self, bottom: f32) {
        let Drawing { axis, palette, now, .. } = self;
        let x = axis.x(*now as f64);
        if !(axis.plot.left() - 1.0..=axis.plot.right() + 1.0).contains(&x) {
            return;
        }
        let top = axis.plot.top();
        let accent = ink(palette.base);
        let font = theme::semibold(theme::TIMELINE);
        self.painter.text(Pos2::new(x, top), Align2::CENTER_TOP, words::grouped(*now), font, ink(palette.accent));
        self.painter.vline(x, top + 16.0..=bottom, Stroke::new(2.0, accent));
        let tip = [Pos2::new(x - 4.5, top + 14.0), Pos2::new(x + 4.5, top + 14.0), Pos2::new(x, top + 21.0)];
        self.painter.add(Shape::convex_polygon(tip.to_vec(), accent, Stroke::NONE));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zooming_stays_within_the_run_and_keeps_the_step_under_the_pointer() {
        let span = zoomed([0.0, 1000.0], 1000.0, 0.25, 0.5);
        assert_eq!(span, [125.0, 625.0]);
        assert_eq!(zoomed(span, 1000.0, 0.5, 10.0), [0.0, 1000.0]);
        assert_eq!(zoomed([0.0, 10.0], 10.0, 0.5, 0.1), [0.0, 10.0]);
    }
}
