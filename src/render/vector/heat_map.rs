//! A sweep as a figure: a heat map with the value of a figure of the report in each cell.

use std::fmt::Write;

use glam::DVec2;

use super::page::{Anchor, Coat, Page, Path, Stroke, width};
use super::sheet::{COLUMN, PAGE, Sheet};
use super::weights::{LABEL, NOTE};
use crate::core::kernel::number::{counted, fixed, grouped};
use crate::core::record::report::figures::{Better, Figure};
use crate::core::record::sweep::{Axis, Cell, Sweep};
use crate::render::colour_map::ColourMap;
use crate::render::look::{Ink, Look};
use crate::render::palette::{Paint, Rgba, letter, note};

/// The ink of axes and marks.
const INK: Ink = Ink::Colour;
/// The room above the cells, for two lines of text.
const ABOVE: f64 = 22.0;
/// The room below the cells, for numbers and name of the axis.
const BELOW: f64 = 24.0;
/// The distance between two lines of the legend.
const LINE: f64 = 9.0;
/// The smallest and the largest width of a cell with its number, and the height.
const NARROWEST: f64 = 16.0;
const WIDEST: f64 = 40.0;
const HEIGHT: f64 = 13.0;
/// The widths of the scale of colours and of the gap before it.
const BAR: f64 = 7.0;
const GAP: f64 = 8.0;
/// The margin beside texts, and the place of a text of the legend.
const MARGIN: f64 = 2.0;
const AFTER_MARK: f64 = 11.0;
/// The number of steps in which the scale of colours is drawn.
const STEPS: u32 = 64;

/// The range of a figure in a sweep, with its colours and the decimals of its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The smallest and the largest value.
    pub range: [f64; 2],
    decimals: Option<usize>,
}

impl Scale {
    /// The scale of a figure; `None` where no cell has it.
    pub fn of(sweep: &Sweep, figure: &Figure) -> Option<Scale> {
        let values: Vec<f64> = (0..sweep.cells().len()).filter_map(|cell| sweep.value(cell, figure)).collect();
        let low = values.iter().copied().reduce(f64::min)?;
        let high = values.iter().copied().reduce(f64::max)?;
        let is_whole = values.iter().all(|x| x.fract() == 0.0 && x.abs() < 1e15);
        // Three digits of the largest number, two of the differences.
        let digits = |x: f64, digits: i32| if x > 0.0 { digits - 1 - libm::floor(libm::log10(x)) as i32 } else { 0 };
        let decimals = digits(high.abs().max(low.abs()), 3).max(digits(high - low, 2)).clamp(0, 4) as usize;
        Some(Scale { range: [low, high], decimals: (!is_whole).then_some(decimals) })
    }

    /// The colour of a value.
    pub fn colour(&self, value: f64) -> Rgba {
        let [low, high] = self.range;
        ColourMap::Cividis.at(if high > low { ((value - low) / (high - low)) as f32 } else { 0.5 })
    }

    /// The colour of text on the colour of a value: black or white, whichever is easier to read.
    pub fn ink(&self, value: f64) -> Rgba {
        let dark = contrast(self.colour(value), BLACK) >= contrast(self.colour(value), WHITE);
        if dark { BLACK } else { WHITE }
    }

    /// A value as text, with as many decimals as all others.
    pub fn text(&self, value: f64) -> String {
        match self.decimals {
            None if value >= 0.0 => grouped(value as u64),
            decimals => fixed(value, decimals.unwrap_or(0)),
        }
    }

    /// A value with its unit.
    pub fn text_with_unit(&self, value: f64, figure: &Figure) -> String {
        let space = if matches!(figure.unit, "" | "°") { "" } else { " " };
        format!("{}{space}{}", self.text(value), figure.unit)
    }
}

const BLACK: Rgba = Rgba([0, 0, 0, 0xFF]);
const WHITE: Rgba = Rgba([0xFF; 4]);

/// Contrast after WCAG 2: 1 (none) to 21.
fn contrast(a: Rgba, b: Rgba) -> f64 {
    let luminance = |Rgba([r, g, b, _]): Rgba| {
        let [r, g, b] = [r, g, b].map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.03928 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
        });
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// What a figure means, with the direction that is better.
pub fn meaning(figure: &Figure) -> String {
    match figure.better {
        Better::Less => format!("{}; less is better", figure.doc),
        Better::More => format!("{}; more is better", figure.doc),
        Better::Neither => figure.doc.to_owned(),
    }
}

/// Draws the heat map of a figure; `description` says what it was made of.
pub fn draw(sweep: &Sweep, figure: &Figure, description: &str) -> Page {
    let map = HeatMap::of(sweep, figure);
    let unit = if figure.unit.is_empty() { String::new() } else { format!(" ({})", figure.unit) };
    let heading = format!("{}: {}{unit}", sweep.case.name, figure.name);
    let title = format!("{heading}, {}", sweep.case.title);
    let meaning = meaning(figure);
    let legend = map.legend();
    let texts = legend.iter().map(|line| map.corner.x + AFTER_MARK + width(&line.1, NOTE));
    let lines = texts.chain([width(&heading, LABEL), width(&meaning, NOTE)].map(|width| MARGIN + width));
    let width = lines.map(|width| width + MARGIN).fold(map.width, f64::max);
    let sheet = Sheet { width, ..Sheet::column(&title, description, Look::default()) };
    let below = LINE * legend.len() as f64;
    let height = map.corner.y + map.cell.y * map.shape[1] as f64 + BELOW + below;
    let mut page = Page::new(&sheet, height);
    page.text(DVec2::new(MARGIN, 1.2 * LABEL), LABEL, Anchor::Start, &heading);
    page.text(DVec2::new(MARGIN, 1.2 * LABEL + 1.4 * NOTE), NOTE, Anchor::Start, &meaning);
    map.cells(&mut page);
    map.axes(&mut page);
    map.scale_of_colours(&mut page);
    let first = DVec2::new(map.corner.x, height - below + 0.5 * LINE);
    for (k, (mark, text)) in legend.iter().enumerate() {
        legend_line(&mut page, first + DVec2::new(0.0, LINE * k as f64), *mark, text);
    }
    page
}

/// The marks of the legend.
#[derive(Clone, Copy, PartialEq)]
enum Mark {
    Best,
    Own,
    Refused,
    Empty,
    None,
}

struct HeatMap<'a> {
    sweep: &'a Sweep,
    figure: &'a Figure,
    scale: Option<Scale>,
    shape: [usize; 2],
    /// The top left corner of the cells.
    corner: DVec2,
    /// The size of a cell.
    cell: DVec2,
    /// Whether the cells have their numbers.
    numbered: bool,
    /// The width of the page.
    width: f64,
}

impl<'a> HeatMap<'a> {
    fn of(sweep: &'a Sweep, figure: &'a Figure) -> HeatMap<'a> {
        let scale = Scale::of(sweep, figure);
        let shape = sweep.shape();
        let widest = |texts: &[String]| texts.iter().map(|text| width(text, NOTE)).fold(0.0, f64::max);
        let numbers: Vec<String> = scale.iter().flat_map(|scale| scale.range.map(|x| scale.text(x))).collect();
        let numbers = widest(&numbers);
        let left = sweep.axes().get(1).map_or(4.0, |axis| 1.5 * LABEL + widest(&axis.values) + 5.0);
        let right = GAP + BAR + 3.0 + numbers + 2.0;
        let columns = shape[0] as f64;
        let wanted = (numbers.max(widest(&sweep.axes()[0].values)) + 5.0).max(NARROWEST);
        // More cells than fit on the width of a page with their numbers are drawn without them.
        let numbered = left + wanted * columns + right <= PAGE;
        let each = if numbered {
            wanted.max(((COLUMN - left - right) / columns).min(WIDEST))
        } else {
            (PAGE - left - right) / columns
        };
        let height = if numbered || shape[1] == 1 { HEIGHT } else { each.clamp(1.0, HEIGHT) };
        let (corner, cell) = (DVec2::new(left, ABOVE), DVec2::new(each, height));
        let width = (left + each * columns + right).max(COLUMN);
        HeatMap { sweep, figure, scale, shape, corner, cell, numbered, width }
    }

    /// The box of a cell; the rows grow upward.
    fn place(&self, cell: usize) -> [DVec2; 2] {
        let (column, row) = (cell % self.shape[0], cell / self.shape[0]);
        let low = self.corner + self.cell * DVec2::new(column as f64, (self.shape[1] - 1 - row) as f64);
        [low, low + self.cell]
    }

    fn cells(&self, page: &mut Page) {
        for (k, cell) in self.sweep.cells().iter().enumerate() {
            let area = self.place(k);
            let name = self.sweep.name(k);
            // White lines between the cells, where there is room for them.
            let line = (self.cell.min_element() > 4.0).then(|| Stroke::of(WHITE, 0.3));
            let filled = |paint: Paint| Coat { stroke: line, ..Coat::area(paint) };
            let value = self.sweep.value(k, self.figure);
            match (cell, self.scale.zip(value)) {
                (_, Some((scale, value))) => {
                    let text = scale.text_with_unit(value, self.figure);
                    page.bar_that_says(area, filled(scale.colour(value).into()), &format!("{name}: {text}"));
                }
                (Some(Cell::Refused(why)), _) => {
                    page.bar_that_says(area, filled(Paint::Hatch), &format!("{name}: refused. {why}"));
                }
                (Some(Cell::Figures(_)), _) => page.bar_that_says(area, empty(), &format!("{name}: none")),
                (None, _) => page.bar_that_says(area, empty(), &format!("{name}: not computed")),
            }
        }
        if let Some(own) = self.sweep.own() {
            own_mark(page, self.place(own)[0], self.cell.min_element());
        }
        for best in self.sweep.best(self.figure) {
            best_mark(page, self.place(best));
        }
        // Numbers last, so that no mark covers them.
        for k in (0..self.sweep.cells().len()).filter(|_| self.numbered) {
            let [low, high] = self.place(k);
            if let Some((scale, value)) = self.scale.zip(self.sweep.value(k, self.figure)) {
                let at = 0.5 * (low + high) + DVec2::new(0.0, 0.35 * NOTE);
                page.text_in(at, NOTE, Anchor::Middle, scale.ink(value), &scale.text(value));
            }
        }
    }

    fn axes(&self, page: &mut Page) {
        let end = self.corner + self.cell * DVec2::new(self.shape[0] as f64, self.shape[1] as f64);
        let axis = &self.sweep.axes()[0];
        let room = axis.values.iter().map(|value| width(value, NOTE) + 3.0).fold(0.0, f64::max);
        let mut ticks = Path::default();
        for k in (0..axis.values.len()).step_by(thinned(room, self.cell.x)) {
            let at = DVec2::new(self.corner.x + self.cell.x * (k as f64 + 0.5), end.y);
            ticks.walk([at, at + DVec2::new(0.0, 2.0)].into_iter(), false);
            page.text(at + DVec2::new(0.0, 2.5 + NOTE), NOTE, Anchor::Middle, &axis.values[k]);
        }
        let middle = 0.5 * (self.corner + end);
        page.text(DVec2::new(middle.x, end.y + 5.0 + NOTE + LABEL), LABEL, Anchor::Middle, &heading(axis));
        if let Some(axis) = self.sweep.axes().get(1) {
            for k in (0..axis.values.len()).step_by(thinned(NOTE + 1.0, self.cell.y)) {
                let at = DVec2::new(self.corner.x, end.y - self.cell.y * (k as f64 + 0.5));
                ticks.walk([at, at - DVec2::new(2.0, 0.0)].into_iter(), false);
                page.text(at + DVec2::new(-3.0, 0.35 * NOTE), NOTE, Anchor::End, &axis.values[k]);
            }
            page.upright_text(DVec2::new(1.1 * LABEL, middle.y), LABEL, &heading(axis));
        }
        page.path(ticks, Coat::line(Stroke::of(letter(INK), 0.5)));
    }

    fn scale_of_colours(&self, page: &mut Page) {
        let Some(scale) = self.scale else { return };
        let x = self.corner.x + self.cell.x * self.shape[0] as f64 + GAP;
        let height = (self.cell.y * self.shape[1] as f64).max(3.0 * NOTE);
        let [low, high] = scale.range;
        let steps = if high > low { STEPS } else { 1 };
        let at = |share: f64| self.corner.y + height * (1.0 - share);
        for k in 0..steps {
            let [from, to] = [k, k + 1].map(|k| f64::from(k) / f64::from(steps));
            let area = [DVec2::new(x, at(to)), DVec2::new(x + BAR, at(from))];
            let colour = scale.colour(low + (high - low) * 0.5 * (from + to));
            // An outline of the same colour closes the seams between the steps.
            page.bar(area, Coat::area(colour).outlined(Stroke::of(colour, 0.1)));
        }
        let ends = if high > low { vec![(high, 0.8 * NOTE), (low, 0.0)] } else { vec![(low, 0.8 * NOTE)] };
        for (value, below) in ends {
            let share = if high > low { (value - low) / (high - low) } else { 1.0 };
            page.text(DVec2::new(x + BAR + 3.0, at(share) + below), NOTE, Anchor::Start, &scale.text(value));
        }
    }

    fn legend(&self) -> Vec<(Mark, String)> {
        let (sweep, figure) = (self.sweep, self.figure);
        let mut lines = Vec::new();
        let value = |cell| self.scale.zip(sweep.value(cell, figure)).map(|(scale, x)| scale.text_with_unit(x, figure));
        let best = sweep.best(figure);
        if let Some(text) = best.first().and_then(|cell| value(*cell)) {
            let place = if best.len() == 1 { sweep.name(best[0]) } else { format!("{} cells", best.len()) };
            lines.push((Mark::Best, format!("best: {text} at {place}")));
        }
        match sweep.own() {
            Some(own) => {
                let text = value(own).map_or_else(String::new, |text| format!("{text} at "));
                lines.push((Mark::Own, format!("the case's own values: {text}{}", sweep.name(own))));
            }
            None => {
                let own = sweep
                    .axes()
                    .iter()
                    .map(|axis| axis.with_value(&sweep.parameters.text_of(axis.key).unwrap_or_default()));
                let own = own.collect::<Vec<_>>().join(", ");
                lines.push((Mark::None, format!("the case's own values are not among the cells: {own}")));
            }
        }
        let refused = sweep.cells().iter().filter(|cell| matches!(cell, Some(Cell::Refused(_)))).count();
        if refused > 0 {
            lines.push((Mark::Refused, format!("refused: {}", counted(refused as u64, "cell"))));
        }
        let missing = sweep.missing().len();
        if missing > 0 {
            lines.push((Mark::Empty, format!("not computed: {}", counted(missing as u64, "cell"))));
        }
        lines
    }
}

fn legend_line(page: &mut Page, at: DVec2, mark: Mark, text: &str) {
    let area = [at + DVec2::new(0.0, -2.5), at + DVec2::new(8.0, 2.5)];
    match mark {
        Mark::Best => best_mark(page, area),
        Mark::Own => own_mark(page, area[0], HEIGHT),
        Mark::Refused => page.bar(area, Coat::area(Paint::Hatch)),
        Mark::Empty => page.bar(area, empty()),
        Mark::None => {}
    }
    page.text(at + DVec2::new(AFTER_MARK, 0.35 * NOTE), NOTE, Anchor::Start, text);
}

/// The outline of a cell without a value.
fn empty() -> Coat {
    Coat::line(Stroke { dash: Some([1.0, 1.0]), ..Stroke::of(Rgba([0xB0, 0xB0, 0xB0, 0xFF]), 0.3) })
}

/// The name of an axis with its unit.
fn heading(axis: &Axis) -> String {
    let mut text = axis.key.to_owned();
    if !axis.unit().is_empty() {
        // Writing to a String cannot fail.
        let _ = write!(text, " ({})", axis.unit());
    }
    text
}

/// Of how many cells one gets its number on the axis.
fn thinned(room: f64, cell: f64) -> usize {
    (room / cell.max(1e-3)).ceil().max(1.0) as usize
}

/// The outline of the best cells, seen on dark and on light colours.
fn best_mark(page: &mut Page, [low, high]: [DVec2; 2]) {
    for (inset, ink, width) in [(1.3, WHITE, 0.7), (0.5, letter(INK), 1.1)] {
        let inset = DVec2::splat(inset).min(0.3 * (high - low));
        page.bar([low + inset, high - inset], Coat::line(Stroke::of(ink, width)));
    }
}

/// The corner of the cell with the case's own values.
fn own_mark(page: &mut Page, corner: DVec2, size: f64) {
    let side = 0.35 * size;
    let mut path = Path::default();
    path.walk([corner, corner + DVec2::new(side, 0.0), corner + DVec2::new(0.0, side)].into_iter(), true);
    page.path(path, Coat::area(WHITE).outlined(Stroke::of(note(INK), 0.4)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::record::report::figures::FIGURES;
    use crate::core::run::Run;
    use crate::render::vector::svg;

    /// A sweep of example 1 in which cell k has the figures k + 0.5, and the last cell is not known.
    fn sweep(axes: &[&str]) -> Sweep {
        let run = Run::of(built_in::named("example1").unwrap().unwrap());
        let axes = axes.iter().map(|axis| Axis::parse(axis).unwrap()).collect();
        let mut sweep = Sweep::new(&run, axes).unwrap();
        for k in 0..sweep.cells().len() - 1 {
            sweep.fill(k, Cell::Figures(vec![Some(k as f64 + 0.5); FIGURES.len()]));
        }
        sweep
    }

    fn figure(name: &str) -> &'static Figure {
        Figure::named(name).unwrap()
    }

    #[test]
    fn numbers_can_be_read_on_every_colour() {
        let scale = Scale { range: [0.0, 1.0], decimals: None };
        for k in 0..=1000 {
            let value = f64::from(k) / 1000.0;
            let contrast = contrast(scale.colour(value), scale.ink(value));
            assert!(contrast >= 4.5, "at {value}: {contrast}");
        }
    }

    #[test]
    fn numbers_have_the_digits_that_tell_them_apart() {
        let text = |values: &[f64]| {
            let mut sweep = sweep(&["c=1:3:.5"]);
            for (k, value) in values.iter().enumerate() {
                sweep.fill(k, Cell::Figures(vec![Some(*value); FIGURES.len()]));
            }
            let scale = Scale::of(&sweep, figure("quads"));
            values.iter().map(|value| scale.unwrap().text(*value)).collect::<Vec<_>>()
        };
        assert_eq!(text(&[1.0, 2.0, 1234.0, 5.0]), ["1", "2", "1\u{2009}234", "5"]);
        assert_eq!(text(&[4.52, 11.44, 7.0, 8.0]), ["4.5", "11.4", "7.0", "8.0"]);
        assert_eq!(text(&[0.9512, 0.9531, 0.952, 0.953]), ["0.9512", "0.9531", "0.9520", "0.9530"]);
        assert_eq!(text(&[1234.5, 2345.6, 2000.5, 2001.5]), ["1234", "2346", "2000", "2002"]);
    }

    #[test]
    fn the_best_cell_is_the_least_or_the_largest_and_rows_grow_upward() {
        let sweep = sweep(&["c=2,3", "theta_rect=120,135,150"]);
        let map = |name| svg::write(&draw(&sweep, figure(name), ""));
        let (less, more, neither) = (map("irregular"), map("min_angle"), map("quads"));
        assert!(less.contains(">best: 0.50 % at c = 2, theta_rect = 120°</text>"), "{less}");
        assert!(more.contains(">best: 4.50° at c = 2, theta_rect = 150°</text>"), "{more}");
        assert!(!neither.contains("best: "), "{neither}");
        assert!(less.contains(">the case's own values: 2.50 % at c = 2, theta_rect = 135°</text>"), "{less}");
        assert!(less.contains(">not computed: 1 cell</text>") && less.contains("3, theta_rect = 150°: not computed"));
        let map = HeatMap::of(&sweep, figure("quads"));
        let [low, high] = [map.place(0), map.place(5)];
        assert!(low[0].y > high[0].y && low[0].x < high[0].x);
    }

    #[test]
    fn maps_of_every_size_are_finite_and_fit_their_page() {
        for axes in
            [&["c=2"][..], &["c=1:101:.1"], &["c=2", "eps1=0:1:.001"], &["selection=table1,level", "layers=0,1"]]
        {
            let mut sweep = sweep(axes);
            sweep.fill(0, Cell::Refused("<no>".to_owned()));
            let svg = svg::write(&draw(&sweep, figure("quads"), "a & b"));
            let drawn = svg.split("</style>").last().unwrap();
            assert!(!drawn.contains("NaN") && !drawn.contains("inf") && drawn.contains("&lt;no&gt;"), "{drawn}");
            let map = HeatMap::of(&sweep, figure("quads"));
            assert!(map.width <= PAGE + 1e-9 && map.place(sweep.cells().len() - 1)[1].x <= map.width, "{axes:?}");
        }
    }
}
