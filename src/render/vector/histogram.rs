//! Histograms as figures: edge lengths in the metric (fig. 23), smallest and largest angles of the elements (fig. 24).

use glam::DVec2;

use super::page::{Anchor, Coat, Page, Path, Stroke, width};
use super::sheet::Sheet;
use super::weights::Weights;
use crate::core::kernel::number::{fixed, grouped};
use crate::core::record::Statistics;
use crate::core::record::statistics::{ANGLE_CLASSES, LENGTH_CLASSES};
use crate::render::look::Ink;
use crate::render::palette::{bars, letter};

/// Margins around the axes on paper in points, for the numbers of the vertical and of the horizontal axis.
const LEFT: f64 = 27.0;
const BELOW: f64 = 22.0;
const ABOVE: f64 = 12.0;
const RIGHT: f64 = 6.0;
/// Ratio of height to width where the page has no height.
const SHAPE: f64 = 0.62;
/// Bars with smaller counts have the count above them.
const FEW: u64 = 12;
/// What the vertical axis of proportions counts: a hundredth of a percent.
const PARTS: f64 = 1e4;

/// A histogram of one series or two.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// The titles of the horizontal and of the vertical axis.
    axes: [String; 2],
    /// A note above the plot.
    note: String,
    /// The beginning of the first class and the end of the last one.
    range: [f64; 2],
    /// The distance between two numbers on the axis, and their decimals.
    tick: (f64, usize),
    /// Counts by class for each series, with a name where there are several.
    series: Vec<(&'static str, Vec<u64>)>,
    /// The number of all, where the vertical axis has proportions of it and not counts.
    all: Option<u64>,
}

impl Histogram {
    /// Edge lengths in the metric, as proportions of all edges (fig. 23); the classes are 0.1 wide.
    pub fn of_lengths(statistics: &Statistics) -> Histogram {
        let lengths = &statistics.lengths;
        // To the next half beyond the longest edge; the last class contains all longer edges.
        let last = lengths.edges.iter().rposition(|count| *count > 0).map_or(0, |k| k + 1);
        let classes = last.next_multiple_of(5).clamp(20, LENGTH_CLASSES);
        Histogram {
            axes: ["length of edge in the metric".to_owned(), "proportion of edges".to_owned()],
            note: format!(
                "{}, {} edges: {} ± {}; above bars: number of edges",
                elements(statistics),
                grouped(statistics.edges as u64),
                fixed(lengths.mean, 2),
                fixed(lengths.deviation, 2)
            ),
            range: [0.0, 0.1 * classes as f64],
            tick: (0.5, 1),
            series: vec![("", lengths.edges[..classes].to_vec())],
            all: Some(lengths.edges.iter().sum()),
        }
    }

    /// Smallest and largest angles of the elements in the metric (fig. 24); the classes are 10 degrees wide.
    pub fn of_angles(statistics: &Statistics) -> Histogram {
        let angles = &statistics.metric_angles;
        Histogram {
            axes: ["angle in the metric, degrees".to_owned(), "number of elements".to_owned()],
            note: format!("{}: {}° to {}°", elements(statistics), fixed(angles.min, 1), fixed(angles.max, 1)),
            range: [0.0, 10.0 * ANGLE_CLASSES as f64],
            tick: (30.0, 0),
            series: vec![
                ("least", angles.least_of_element.to_vec()),
                ("greatest", angles.greatest_of_element.to_vec()),
            ],
            all: None,
        }
    }

    /// Draws the histogram.
    pub fn draw(&self, sheet: &Sheet<'_>) -> Page {
        let height = sheet.height.unwrap_or(SHAPE * sheet.width);
        let (note, text) = (sheet.weights.note(), sheet.weights.text);
        let mut page = Page::new(sheet, height);
        let most = self.series.iter().flat_map(|s| &s.1).copied().max().unwrap_or(0).max(1);
        let most = (self.height(most).ceil() as u64).max(1);
        let step = step(most);
        let top = most.div_ceil(step) * step;
        let plot = Plot {
            low: DVec2::new(LEFT * text, height - BELOW * text),
            high: DVec2::new(sheet.width - RIGHT * text, ABOVE * text),
            range: self.range,
            top: top as f64,
        };
        page.text(DVec2::new(plot.high.x, note), note, Anchor::End, self.note_within(plot.high.x, note));
        self.bars(&mut page, &plot, sheet);
        self.axes(&mut page, &plot, sheet.look.ink, step, top);
        page
    }

    /// The height of a bar in units of the vertical axis.
    fn height(&self, count: u64) -> f64 {
        self.all.map_or(count as f64, |all| PARTS * count as f64 / all.max(1) as f64)
    }

    /// A number on the vertical axis, of numbers that are `step` apart.
    fn number(&self, height: u64, step: u64) -> String {
        let decimals = (0..4).rev().find(|k| step.is_multiple_of(10_u64.pow(*k))).map_or(4, |k| 4 - k as usize);
        if self.all.is_some() { fixed(height as f64 / PARTS, decimals) } else { grouped(height) }
    }

    /// As many clauses of the note as have room.
    fn note_within(&self, room: f64, size: f64) -> &str {
        let mut text = &self.note[..];
        while width(text, size) > room
            && let Some(end) = text.rfind([',', ':', ';'])
        {
            text = &text[..end];
        }
        text
    }

    fn bars(&self, page: &mut Page, plot: &Plot, sheet: &Sheet<'_>) {
        let styles = bars(sheet.look.ink);
        let (note, Weights { line, text }) = (sheet.weights.note(), sheet.weights);
        let coat = |i: usize| {
            let [fill, stroke] = styles[i.min(1)];
            Coat::area(fill).outlined(Stroke::of(stroke, 0.4 * line))
        };
        let count = self.series.len() as f64;
        let mut taken = f64::NEG_INFINITY;
        let classes = self.series.first().map_or(0, |s| s.1.len());
        let class = (self.range[1] - self.range[0]) / classes.max(1) as f64;
        let mut numbers = Vec::new();
        for k in 0..classes {
            for (i, (_, counts)) in self.series.iter().enumerate().filter(|s| s.1.1[k] > 0) {
                let share = |part: f64| self.range[0] + class * (k as f64 + 0.08 + 0.84 * (i as f64 + part) / count);
                let (low, high) = (plot.at(share(0.0), 0.0), plot.at(share(1.0), self.height(counts[k])));
                // The outline lies inside the bar.
                let inset = DVec2::new(0.2 * line, 0.0);
                let area = [DVec2::new(low.x, high.y) + inset, DVec2::new(high.x, low.y) - inset];
                page.bar(area, coat(i));
                if counts[k] < FEW {
                    numbers.push((DVec2::new(0.5 * (low.x + high.x), high.y - 1.5 * text), counts[k].to_string()));
                }
            }
        }
        for (at, number) in numbers {
            let half = 0.5 * width(&number, note);
            if at.x - half > taken {
                page.text(at, note, Anchor::Middle, &number);
                taken = at.x + half + 0.3 * text;
            }
        }
        if self.series.len() > 1 {
            let mut x = plot.low.x + 6.0 * text;
            for (i, (name, _)) in self.series.iter().enumerate() {
                let box_at = DVec2::new(x, plot.high.y + 2.0 * text);
                page.bar([box_at, box_at + DVec2::new(5.0, 4.0) * text], coat(i));
                page.text(box_at + DVec2::new(7.0, 4.2) * text, note, Anchor::Start, name);
                x += 15.0 * text + width(name, note);
            }
        }
    }

    fn axes(&self, page: &mut Page, plot: &Plot, ink: Ink, step: u64, top: u64) {
        let (note, label, Weights { line, text }) = (page.weights().note(), page.weights().label(), page.weights());
        let mut path = Path::default();
        let (corner, end) = (plot.low, DVec2::new(plot.high.x, plot.low.y));
        path.walk([DVec2::new(corner.x, plot.high.y), corner, end].into_iter(), false);
        let mut numbers = Vec::new();
        for k in 0..=(top / step) {
            let at = plot.at(self.range[0], (k * step) as f64);
            path.walk([at, at - DVec2::new(2.0 * text, 0.0)].into_iter(), false);
            numbers.push((at + DVec2::new(-3.5 * text, 0.35 * note), Anchor::End, self.number(k * step, step)));
        }
        let (tick, decimals) = self.tick;
        let mut taken = f64::NEG_INFINITY;
        let ticks = ((self.range[1] - self.range[0]) / tick + 1e-6) as u32;
        for k in 0..=ticks {
            let x = self.range[0] + tick * f64::from(k);
            let at = plot.at(x, 0.0);
            path.walk([at, at + DVec2::new(0.0, 2.0 * text)].into_iter(), false);
            let number = fixed(x, decimals);
            let half = 0.5 * width(&number, note);
            // Where the text is large, every other number has no room, or more of them.
            if at.x - half > taken {
                taken = at.x + half + 1.0 * text;
                numbers.push((at + DVec2::new(0.0, 3.0 * text + 0.8 * note), Anchor::Middle, number));
            }
        }
        page.path(path, Coat::line(Stroke::of(letter(ink), 0.5 * line)));
        for (at, anchor, number) in numbers {
            page.text(at, note, anchor, &number);
        }
        let below = DVec2::new(0.5 * (plot.low.x + plot.high.x), plot.low.y + BELOW * text - 0.35 * label);
        page.text(below, label, Anchor::Middle, &self.axes[0]);
        page.upright_text(DVec2::new(label, 0.5 * (plot.low.y + plot.high.y)), label, &self.axes[1]);
    }
}

/// The map from values of a plot to the page.
struct Plot {
    /// The corner on the page at the smallest value and height 0.
    low: DVec2,
    /// The opposite corner.
    high: DVec2,
    range: [f64; 2],
    top: f64,
}

impl Plot {
    fn at(&self, x: f64, height: f64) -> DVec2 {
        let share = DVec2::new((x - self.range[0]) / (self.range[1] - self.range[0]), height / self.top);
        self.low + share * (self.high - self.low)
    }
}

/// A round step with which an axis up to `most` has three to six numbers.
fn step(most: u64) -> u64 {
    let mut power = 1;
    loop {
        for k in [1, 2, 5] {
            if most.div_ceil(k * power) <= 5 {
                return k * power;
            }
        }
        power *= 10;
    }
}

fn elements(statistics: &Statistics) -> String {
    let many = |n: usize, one: &str, more: &str| format!("{} {}", grouped(n as u64), if n == 1 { one } else { more });
    match (statistics.quads, statistics.triangles) {
        (0, n) => many(n, "triangle", "triangles"),
        (n, _) => many(n, "quadrilateral", "quadrilaterals"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_counts_or_proportions_of_all() {
        let histogram = |all| Histogram {
            axes: [String::new(), String::new()],
            note: String::new(),
            range: [0.0, 1.0],
            tick: (0.5, 1),
            series: vec![("", vec![3, 7, 40])],
            all,
        };
        let (counts, proportions) = (histogram(None), histogram(Some(50)));
        assert_eq!([3, 40].map(|count| counts.height(count)), [3.0, 40.0]);
        assert_eq!([3, 40].map(|count| proportions.height(count)), [600.0, 8000.0]);
        assert_eq!([(20, 10), (2000, 1000)].map(|(height, step)| counts.number(height, step)), ["20", "2\u{2009}000"]);
        let numbers = [(2000, 2000), (400, 200), (1500, 500), (15, 5)];
        assert_eq!(numbers.map(|(height, step)| proportions.number(height, step)), ["0.2", "0.04", "0.15", "0.0015"]);
    }

    #[test]
    fn axes_have_few_and_round_numbers() {
        assert_eq!([1, 5, 6, 12, 37, 100, 1_000_000].map(step), [1, 1, 2, 5, 10, 20, 200_000]);
        for most in 1..3000_u64 {
            assert!((1..=5).contains(&most.div_ceil(step(most))), "{most}");
        }
    }
}
