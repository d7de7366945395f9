//! The timeline of a run as a figure: lanes of events, where the invariants hold, and curves, as the window shows them.

use glam::DVec2;

use super::page::{Anchor, Cap, Coat, Page, Path, Stroke, width};
use super::sheet::Sheet;
use crate::core::kernel::number::{counted, grouped};
use crate::core::run::timeline::{CurveKind, LANES, Lane, Span, Timeline, Tracked, count};
use crate::render::look::Ink;
use crate::render::palette::{Paint, Rgba, figure, letter, note, verdicts};
use crate::render::picture::Role;

/// The heights of a lane and of a curve, and the gap below each, in sizes of notes.
const LANE: f64 = 1.5;
const CURVE: f64 = 4.5;
const GAP: f64 = 0.35;
/// The heights of the heading and of the numbers of steps, in sizes of notes.
const HEADING: f64 = 2.2;
const RULER: f64 = 1.6;
/// The room beside texts, in sizes of notes.
const BESIDE: f64 = 0.7;
/// The width of a column on paper in points: events in it are drawn as one.
const COLUMN: f64 = 0.5;

/// A run over time: its record, what follows from it, and the step that is pointed out.
#[derive(Clone, Copy)]
pub struct OverTime<'a> {
    /// The record of each step.
    pub track: &'a [Tracked],
    /// What follows from it.
    pub timeline: &'a Timeline,
    /// The step at which values are told.
    pub now: u64,
}

/// Draws the timeline.
pub fn draw(run: OverTime<'_>, sheet: &Sheet<'_>) -> Page {
    let size = sheet.weights.note();
    let rows = HEADING + RULER + (LANES.len() + 1) as f64 * (LANE + GAP) + CurveKind::ALL.len() as f64 * (CURVE + GAP);
    let mut page = Page::new(sheet, rows * size);
    let names = LANES.iter().map(|lane| lane.name).chain(CurveKind::ALL.iter().map(|curve| curve.name()));
    let left = names.map(|name| width(name, size)).fold(0.0, f64::max) + BESIDE * size;
    let drawing = Drawing {
        run,
        size,
        ink: sheet.look.ink,
        line: sheet.weights.line,
        plot: [left, sheet.width - right(&run, size)],
    };
    drawing.heading(&mut page);
    drawing.ruler(&mut page);
    let mut y = (HEADING + RULER) * size;
    let kinds = LANES.map(|lane| lane.kinds);
    let counts = count(run.track, &kinds, &drawing.span());
    for (lane, counts) in LANES.iter().zip(&counts) {
        drawing.lane(&mut page, lane, &counts.bins, y);
        drawing.label(&mut page, y + 0.5 * LANE * size, lane.name, &grouped(counts.total), letter(drawing.ink));
        y += (LANE + GAP) * size;
    }
    drawing.invariants(&mut page, y);
    y += (LANE + GAP) * size;
    for curve in CurveKind::ALL {
        drawing.curve(&mut page, curve, y);
        y += (CURVE + GAP) * size;
    }
    drawing.head(&mut page, y - GAP * size);
    page
}

/// The room right of the plot.
fn right(run: &OverTime<'_>, size: f64) -> f64 {
    let most = grouped(run.track.len() as u64);
    let texts = ["broken".to_owned(), format!("to {most}")];
    texts.iter().map(|text| width(text, size)).fold(0.0, f64::max) + BESIDE * size
}

struct Drawing<'a> {
    run: OverTime<'a>,
    /// The size of text.
    size: f64,
    ink: Ink,
    /// The factor on widths of lines.
    line: f64,
    /// The left and the right end of the plot.
    plot: [f64; 2],
}

impl Drawing<'_> {
    fn steps(&self) -> f64 {
        self.run.track.len().max(1) as f64
    }

    fn span(&self) -> Span {
        let columns = ((self.plot[1] - self.plot[0]) / (COLUMN * self.line)).max(1.0) as usize;
        Span { steps: [0.0, self.steps()], columns }
    }

    fn x(&self, step: f64) -> f64 {
        self.plot[0] + (self.plot[1] - self.plot[0]) * step / self.steps()
    }

    fn heading(&self, page: &mut Page) {
        let OverTime { track, now, .. } = self.run;
        let standing = |step: u64| step.checked_sub(1).and_then(|k| track.get(k as usize)).map_or(0, |t| t.standing);
        let all = track.len() as u64;
        let quads = |step| counted(standing(step).into(), "quadrilateral");
        let mut text = format!("{}, {}", counted(all, "step"), quads(all));
        if now < all {
            text += &format!("; values at step {}, {}", grouped(now), quads(now));
        }
        page.text(DVec2::new(0.0, 1.1 * self.size), self.size, Anchor::Start, &text);
    }

    /// The numbers of steps, as far apart as they have room.
    fn ruler(&self, page: &mut Page) {
        let OverTime { track, now, .. } = self.run;
        let room = width(&grouped(track.len() as u64), self.size) + 2.0 * self.size;
        let wanted = (self.steps() * room / (self.plot[1] - self.plot[0])).max(1.0);
        let power = libm::pow(10.0, libm::floor(libm::log10(wanted)));
        let every = [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|every| *every >= wanted);
        let every = every.unwrap_or(10.0 * power);
        let base = (HEADING + RULER) * self.size;
        let mut ticks = Path::default();
        let head = (now < track.len() as u64).then(|| self.x(now as f64));
        for k in 0..=(self.steps() / every) as u32 {
            let step = every * f64::from(k);
            let x = self.x(step);
            let at = |above: f64| DVec2::new(x, base - above * self.size);
            ticks.walk([at(0.35), at(0.1)].into_iter(), false);
            if head.is_none_or(|head| (head - x).abs() > room) {
                page.text_in(at(0.6), self.size, Anchor::Middle, note(self.ink), &grouped(step as u64));
            }
        }
        page.path(ticks, Coat::line(Stroke::of(note(self.ink), 0.35 * self.line)));
    }

    /// A name left of the plot, and a value right of it.
    fn label(&self, page: &mut Page, middle: f64, name: &str, value: &str, colour: Rgba) {
        let y = middle + 0.35 * self.size;
        let beside = BESIDE * self.size;
        page.text_in(DVec2::new(self.plot[0] - beside, y), self.size, Anchor::End, note(self.ink), name);
        page.text_in(DVec2::new(self.plot[1] + beside, y), self.size, Anchor::Start, colour, value);
    }

    /// A tick for each event, or where many are in one column, columns the darker the more there are.
    fn lane(&self, page: &mut Page, lane: &Lane, bins: &[u32], y: f64) {
        let height = LANE * self.size;
        let [from, to] = self.plot;
        let ground = figure(Role::DeadQuad, self.ink).fill.unwrap_or(Paint::Colour(Rgba::default()));
        page.bar([DVec2::new(from, y), DVec2::new(to, y + height)], Coat::area(ground));
        let [_, broken] = verdicts(self.ink);
        let colour = if lane.is_failure { broken } else { letter(self.ink) };
        let each = (to - from) / (bins.len().max(2) - 1) as f64;
        let most = bins.iter().copied().max().unwrap_or(0).max(1);
        let is_dense = bins.iter().filter(|count| **count > 1).count() > bins.len() / 8;
        // One path for all columns of the same height of colour: paths are few, and have no seams.
        let levels = if is_dense { 8.min(most) } else { 1 };
        for level in 1..=levels {
            let mut ticks = Path::default();
            let is_here = |count: u32| count > 0 && (count * levels).div_ceil(most) == level;
            for (k, _) in bins.iter().enumerate().filter(|(_, count)| !is_dense && **count > 0 || is_here(**count)) {
                let x = from + each * k as f64;
                let inset = if is_dense { 0.0 } else { 0.12 * height };
                ticks.walk([DVec2::new(x, y + inset), DVec2::new(x, y + height - inset)].into_iter(), false);
            }
            let opacity = if is_dense { 0.25 + 0.75 * level as f32 / levels as f32 } else { 1.0 };
            let width = if is_dense { each } else { 0.5 * self.line };
            page.path(ticks, Coat::line(Stroke { opacity, ..Stroke::of(colour, width) }));
        }
    }

    fn invariants(&self, page: &mut Page, y: f64) {
        let middle = y + 0.5 * LANE * self.size;
        let [holds, broken] = verdicts(self.ink);
        let line = |a: f64, b: f64| {
            let mut path = Path::default();
            path.walk([DVec2::new(a, middle), DVec2::new(b, middle)].into_iter(), false);
            path
        };
        page.path(line(self.plot[0], self.plot[1]), Coat::line(Stroke::of(holds, 1.5 * self.line)));
        let spans = self.run.timeline.broken_spans();
        for [from, until] in spans {
            let [a, b] = [*from, *until].map(|step| self.x(step as f64));
            page.path(line(a, b.max(a + self.line)), Coat::line(Stroke::of(broken, 3.0 * self.line)));
        }
        let (text, colour) = if spans.is_empty() { ("hold", holds) } else { ("broken", broken) };
        self.label(page, middle, "invariants", text, colour);
    }

    fn curve(&self, page: &mut Page, of: CurveKind, y: f64) {
        let OverTime { track, timeline, now } = self.run;
        let steps = track.len() as u64;
        let most = (1..=steps).map(|step| timeline.height(of, step)).fold(1.0, f64::max);
        let (top, bottom) = (y + 0.1 * CURVE * self.size, y + CURVE * self.size);
        let place = |step: u64, height: f64| {
            DVec2::new(self.x(step as f64), bottom - (bottom - top) * height.clamp(0.0, most) / most)
        };
        let mut axis = Path::default();
        let low = |x: f64| DVec2::new(x, bottom);
        axis.walk([low(self.plot[0]), low(self.plot[1])].into_iter(), false);
        page.path(axis, Coat::line(Stroke::of(note(self.ink), 0.25 * self.line)));
        if of == CurveKind::Quality {
            let mut dots = Path::default();
            for (step, tracked) in (1..).zip(track) {
                if let Some((_, quality)) = tracked.formed {
                    let p = place(step, quality);
                    dots.walk([p, p].into_iter(), false);
                }
            }
            let dot = Stroke { cap: Some(Cap::Round), ..Stroke::of(note(self.ink), 0.8 * self.line) };
            page.path(dots, Coat::line(dot));
        }
        // A point where the value changes is enough: between, it stays.
        let mut path = Path::default();
        let mut points: Vec<DVec2> = Vec::new();
        for step in 1..=steps {
            let p = place(step, timeline.height(of, step));
            match points[..] {
                [.., a, b] if a.y == p.y && b.y == p.y => {
                    points.pop();
                    points.push(p);
                }
                _ => points.push(p),
            }
        }
        path.walk(points.into_iter(), false);
        page.path(path, Coat::line(Stroke::of(letter(self.ink), 0.5 * self.line)));
        let value = timeline.value(of, now);
        self.label(page, y + 0.5 * CURVE * self.size, of.name(), &value, letter(self.ink));
        let scale = if of == CurveKind::Quality { "0 to 1".to_owned() } else { format!("to {}", grouped(most as u64)) };
        let at = DVec2::new(self.plot[1] + BESIDE * self.size, top + 0.8 * self.size);
        page.text_in(at, self.size, Anchor::Start, note(self.ink), &scale);
    }

    /// The line at the step whose values are told, unless that is the end.
    fn head(&self, page: &mut Page, bottom: f64) {
        let OverTime { track, now, .. } = self.run;
        if now >= track.len() as u64 {
            return;
        }
        let x = self.x(now as f64);
        let base = (HEADING + RULER) * self.size;
        let colour = figure(Role::Base, self.ink).stroke.unwrap_or(letter(self.ink));
        let mut path = Path::default();
        path.walk([DVec2::new(x, base - 0.4 * self.size), DVec2::new(x, bottom)].into_iter(), false);
        page.path(path, Coat::line(Stroke::of(colour, 0.75 * self.line)));
        let half = 0.5 * width(&grouped(now), self.size);
        let at = DVec2::new(x.clamp(self.plot[0] + half, self.plot[1] - half), base - 0.6 * self.size);
        page.text_in(at, self.size, Anchor::Middle, colour, &grouped(now));
    }
}
