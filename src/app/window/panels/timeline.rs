//! The run along its steps: a lane for each kind of event, curves, bookmarks, and the play head. Click or drag to seek; the wheel
//! zooms.

use eframe::egui::{self, Align2, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo};

use crate::app::window::command::Command;
use crate::app::window::session::{Goal, Tracked};
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::render::palette::{Palette, Rgba};

/// The label column and the counts, in points.
const LABELS: f32 = 118.0;
const COUNTS: f32 = 92.0;
const LANE: f32 = 12.0;
const GAP: f32 = 2.0;
const CURVE: f32 = 24.0;

/// The kinds of a lane.
const LANES: [(&str, &[&str]); 5] = [
    ("quad formed", &["formed"]),
    ("swap", &["side_swapped", "top_swapped", "enhanced"]),
    ("divide, delete", &["side_divided", "node_removed"]),
    ("seam, close, finish", &["seamed", "transition_seamed", "split", "closed", "patched", "cleaned", "swept"]),
    ("rolled back", &["rolled_back", "deferred"]),
];

/// Shows the timeline.
pub fn show(ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>, palette: &Palette) {
    let rect = ui.max_rect();
    let plot = Rect::from_min_max(
        Pos2::new(rect.left() + LABELS, rect.top() + 4.0),
        Pos2::new((rect.right() - COUNTS).max(rect.left() + LABELS + 10.0), rect.bottom() - 4.0),
    );
    let response =
        ui.interact(plot.expand2(Vec2::new(6.0, 4.0)), ui.scope_id().with("timeline"), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Slider, true, "Timeline"));
    let Some(moment) = state.moment.clone() else { return };
    let all = state.track.len().max(1) as f64;
    let mut span = state.timeline.filter(|_| state.track.len() > 1).unwrap_or([0.0, all]);
    if let Some(at) = response.hover_pos() {
        let scroll = ui.input(|input| input.smooth_scroll_delta());
        if scroll.y != 0.0 {
            span = zoomed(
                span,
                all,
                f64::from((at.x - plot.left()) / plot.width()),
                libm::exp(f64::from(-scroll.y) * 0.004),
            );
            state.timeline = (span[1] - span[0] < all).then_some(span);
        }
    }
    let axis = Axis { plot, span };
    if (response.dragged() || response.clicked())
        && let Some(at) = response.interact_pointer_pos()
    {
        let step = axis.step(at.x).round().clamp(0.0, state.track.len() as f64) as u64;
        if step != moment.step && state.seeking != Some(step) {
            state.seeking = Some(step);
            commands.push(Command::Go(Goal::Step(step)));
        }
    } else {
        state.seeking = None;
    }
    let painter = ui.painter_at(rect);
    let mut y = ruler(&painter, &axis, state, palette, plot.top());
    for (name, kinds) in LANES {
        if y + LANE > plot.bottom() {
            break;
        }
        lane(&painter, &axis, state, palette, y, name, kinds, moment.step);
        y += LANE + GAP;
    }
    if y + LANE <= plot.bottom() {
        invariants(&painter, &axis, palette, y, moment.broken.as_deref());
        y += LANE + GAP;
    }
    for (name, of) in [("front length", Curve::Front), ("quality, worst", Curve::Quality)] {
        if y + CURVE > plot.bottom() + 2.0 {
            break;
        }
        curve(&painter, &axis, state, palette, y, name, of, moment.step);
        y += CURVE + GAP;
    }
    head(&painter, &axis, palette, moment.step, y.min(plot.bottom()));
    if let Some(at) = response.hover_pos() {
        let step = axis.step(at.x).round().max(0.0) as usize;
        if let Some(tracked) = step.checked_sub(1).and_then(|i| state.track.get(i)) {
            let text = format!("step {}  ·  {}", words::grouped(step as u64), words::kind(tracked.kind));
            response.on_hover_text_at_pointer(text);
        }
    }
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

    /// The steps that can be seen, as places in the track.
    fn seen(&self, count: usize) -> std::ops::Range<usize> {
        let first = (self.span[0].max(0.0) as usize).min(count);
        first..(self.span[1].ceil() as usize).clamp(first, count)
    }
}

/// The span after zooming by `factor` around a place; at most the whole run, at least 20 steps.
fn zoomed(span: [f64; 2], all: f64, at: f64, factor: f64) -> [f64; 2] {
    let width = span[1] - span[0];
    let new = (width * factor).clamp(20.0_f64.min(all), all);
    let start = (span[0] + at * (width - new)).clamp(0.0, all - new);
    [start, start + new]
}

fn ruler(painter: &egui::Painter, axis: &Axis, state: &State, palette: &Palette, top: f32) -> f32 {
    let width = axis.span[1] - axis.span[0];
    let wanted = width / f64::from(axis.plot.width() / 90.0);
    let power = libm::pow(10.0, libm::floor(libm::log10(wanted.max(1.0))));
    let every = [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|e| *e >= wanted).unwrap_or(10.0 * power);
    let mut tick = (axis.span[0] / every).ceil() * every;
    let head = state.moment.as_ref().map_or(-1e9, |moment| axis.x(moment.step as f64));
    while tick <= axis.span[1] {
        let x = axis.x(tick);
        if (x - head).abs() > 34.0 {
            let text = words::grouped(tick as u64);
            painter.text(
                Pos2::new(x, top),
                Align2::CENTER_TOP,
                text,
                theme::regular(theme::TIMELINE),
                ink(palette.weak),
            );
        }
        tick += every;
    }
    for step in &state.kept.bookmarks {
        let x = axis.x(*step as f64);
        let font = theme::regular(theme::TIMELINE);
        painter.text(
            Pos2::new(x, top + 12.0),
            Align2::CENTER_TOP,
            crate::app::window::icons::BOOKMARK,
            font,
            ink(palette.text),
        );
    }
    top + 24.0
}

fn label(painter: &egui::Painter, axis: &Axis, palette: &Palette, y: f32, name: &str, count: &str, colour: Rgba) {
    let font = theme::regular(theme::TIMELINE);
    let left = Pos2::new(axis.plot.left() - 9.0, y);
    painter.text(left, Align2::RIGHT_CENTER, name, font.clone(), ink(palette.weak));
    let right = Pos2::new(axis.plot.right() + COUNTS - 32.0, y);
    painter.text(right, Align2::RIGHT_CENTER, count, font, ink(colour));
}

fn lane(
    painter: &egui::Painter,
    axis: &Axis,
    state: &State,
    palette: &Palette,
    y: f32,
    name: &str,
    kinds: &[&str],
    now: u64,
) {
    let ground = Rect::from_min_size(Pos2::new(axis.plot.left(), y), Vec2::new(axis.plot.width(), LANE));
    painter.rect_filled(ground, 0.0, ink(palette.line.faded(0.45)));
    let is_of = |tracked: &Tracked| kinds.contains(&tracked.kind);
    let total = state.track.iter().filter(|t| is_of(t)).count();
    let colour = if kinds.contains(&"rolled_back") { palette.broken } else { palette.dead_edge };
    let columns = axis.plot.width().max(1.0) as usize;
    let mut bins = vec![0_u32; columns + 1];
    let seen = axis.seen(state.track.len());
    let per_pixel = seen.len() as f32 / columns as f32;
    for k in seen.filter(|k| is_of(&state.track[*k])) {
        let column = (axis.x((k + 1) as f64) - axis.plot.left()).round();
        if let Some(bin) = bins.get_mut(column.max(0.0) as usize) {
            *bin += 1;
        }
    }
    let head = axis.x(now as f64) - axis.plot.left();
    let most = (per_pixel * 0.5).max(1.0);
    for (k, count) in bins.iter().enumerate().filter(|(_, count)| **count > 0) {
        let past = if k as f32 <= head + 0.5 { 0.8 } else { 0.38 };
        let density = (0.35 + 0.65 * *count as f32 / most).min(1.0);
        let x = axis.plot.left() + k as f32;
        painter.vline(x, y + 2.0..=y + LANE - 2.0, Stroke::new(1.2, ink(colour.faded(past * density))));
    }
    label(painter, axis, palette, y + 0.5 * LANE, name, &words::grouped(total as u64), palette.text);
}

fn invariants(painter: &egui::Painter, axis: &Axis, palette: &Palette, y: f32, broken: Option<&str>) {
    let colour = if broken.is_some() { palette.broken } else { palette.holds };
    let middle = y + 0.5 * LANE;
    painter.hline(axis.plot.x_range(), middle, Stroke::new(3.0, ink(colour.faded(0.8))));
    label(painter, axis, palette, middle, "invariants", if broken.is_some() { "broken" } else { "hold" }, colour);
}

#[derive(Clone, Copy, PartialEq)]
enum Curve {
    Front,
    Quality,
}

fn curve(
    painter: &egui::Painter,
    axis: &Axis,
    state: &State,
    palette: &Palette,
    y: f32,
    name: &str,
    of: Curve,
    now: u64,
) {
    let seen = axis.seen(state.track.len());
    let mut points: Vec<(u64, f32)> = Vec::new();
    let (mut worst, mut most) = (1.0_f32, 1.0_f32);
    let mut dots = Vec::new();
    for (k, tracked) in state.track.iter().enumerate().take(seen.end) {
        let step = (k + 1) as u64;
        match of {
            Curve::Quality => {
                if let Some((_, quality)) = tracked.formed {
                    worst = worst.min(quality);
                    if k >= seen.start {
                        dots.push((step, quality));
                        points.push((step, worst));
                    }
                }
            }
            Curve::Front => {
                most = most.max(tracked.front as f32);
                if k >= seen.start {
                    points.push((step, tracked.front as f32));
                }
            }
        }
    }
    let place = |step: u64, value: f32| {
        let top = if of == Curve::Front { most } else { 1.0 };
        Pos2::new(axis.x(step as f64), y + CURVE - 2.0 - (CURVE - 4.0) * value / top)
    };
    let columns = axis.plot.width() as usize;
    if dots.len() <= 2 * columns {
        for (step, quality) in dots {
            let colour = palette.weak.faded(if step <= now { 0.8 } else { 0.38 });
            painter.circle_filled(place(step, quality), 0.9, ink(colour));
        }
    }
    let every = (points.len() / (2 * columns).max(1)).max(1);
    for (past, alpha) in [(true, 0.95), (false, 0.38)] {
        let part = points.iter().step_by(every).filter(|p| (p.0 <= now) == past);
        let line: Vec<Pos2> = part.map(|p| place(p.0, p.1)).collect();
        painter.add(Shape::line(line, Stroke::new(1.3, ink(palette.text.faded(alpha)))));
    }
    let value = match of {
        Curve::Front => state.moment.as_ref().map_or(String::new(), |m| words::grouped(m.front.len() as u64)),
        Curve::Quality => {
            let until = &state.track[..(now as usize).min(state.track.len())];
            let worst = until.iter().filter_map(|t| t.formed).map(|f| f.1).fold(f32::INFINITY, f32::min);
            words::fixed(f64::from(worst), 2)
        }
    };
    label(painter, axis, palette, y + 0.5 * CURVE, name, &value, palette.text);
}

fn head(painter: &egui::Painter, axis: &Axis, palette: &Palette, step: u64, bottom: f32) {
    let x = axis.x(step as f64);
    if !(axis.plot.left() - 1.0..=axis.plot.right() + 1.0).contains(&x) {
        return;
    }
    let top = axis.plot.top();
    let accent = ink(palette.base);
    painter.text(
        Pos2::new(x, top),
        Align2::CENTER_TOP,
        words::grouped(step),
        theme::semibold(theme::TIMELINE),
        ink(palette.accent),
    );
    painter.vline(x, top + 16.0..=bottom, Stroke::new(2.0, accent));
    let tip = [Pos2::new(x - 4.5, top + 14.0), Pos2::new(x + 4.5, top + 14.0), Pos2::new(x, top + 21.0)];
    painter.add(Shape::convex_polygon(tip.to_vec(), accent, Stroke::NONE));
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
