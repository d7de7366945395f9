//! A page of vectors: what a figure draws, in order, whatever file it is written to.

use glam::DVec2;

use super::sheet::Sheet;
use super::weights::Weights;
use crate::render::look::Ink;
use crate::render::palette::{Paint, Rgba, ground, letter};

/// The font of figures: the characters of IBM Plex Sans that they need.
pub(super) const FONT: &[u8] = include_bytes!("../../../assets/fonts/QuadfrontFigure-Regular.ttf");
/// Its name.
pub(super) const FAMILY: &str = "Quadfront Figure";

/// What is drawn on a page.
#[derive(Clone, Debug)]
pub struct Page {
    /// One line on what it shows.
    pub title: String,
    /// A longer description.
    pub description: String,
    /// The text of the embedded run.
    pub run: Option<String>,
    /// Width and height in points.
    pub size: DVec2,
    /// The colour of the ground; `None`: transparent.
    pub(super) ground: Option<Rgba>,
    /// What is drawn, from the lowest to the topmost.
    pub(super) items: Vec<Item>,
    /// The factor on the hatching.
    pub(super) weights: Weights,
    ink: Ink,
}

/// One thing on a page.
#[derive(Clone, Debug)]
pub(super) enum Item {
    Path(Path, Coat),
    Bar {
        area: [DVec2; 2],
        coat: Coat,
        /// The radius of the corners.
        corner: f64,
        /// A text that viewers show under the pointer, where they can.
        says: Option<String>,
    },
    Text(Text),
    /// Everything until [`Item::Unclip`] is clipped to a box.
    Clip([DVec2; 2]),
    Unclip,
}

/// A text in one line.
#[derive(Clone, Debug)]
pub(super) struct Text {
    /// The point of its baseline at which it is anchored.
    pub at: DVec2,
    pub size: f64,
    pub anchor: Anchor,
    pub colour: Rgba,
    pub text: String,
    /// Whether it runs upward, not to the right.
    pub upright: bool,
}

/// The part of a text that stands at its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// How an area or a line is painted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coat {
    /// What fills it.
    pub(super) fill: Option<Paint>,
    /// The opacity of what fills it.
    pub(super) opacity: f32,
    /// Its outline.
    pub(super) stroke: Option<Stroke>,
}

impl Coat {
    /// An area of this paint.
    pub fn area(paint: impl Into<Paint>) -> Coat {
        Coat { fill: Some(paint.into()), opacity: 1.0, stroke: None }
    }

    /// A line.
    pub fn line(stroke: Stroke) -> Coat {
        Coat { fill: None, opacity: 1.0, stroke: Some(stroke) }
    }

    /// The same with an outline.
    pub fn outlined(self, stroke: Stroke) -> Coat {
        Coat { stroke: Some(stroke), ..self }
    }
}

/// A line in points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub colour: Rgba,
    /// Its width.
    pub width: f64,
    /// Its ends; `None`: cut off, where it does not matter.
    pub cap: Option<Cap>,
    /// The lengths that are drawn and left out.
    pub dash: Option<[f64; 2]>,
    /// Its opacity.
    pub opacity: f32,
}

impl Stroke {
    /// A whole line.
    pub fn of(colour: Rgba, width: f64) -> Stroke {
        Stroke { colour, width, cap: None, dash: None, opacity: 1.0 }
    }
}

/// The ends of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cap {
    /// Cut off.
    Butt,
    /// Half circles.
    Round,
}

impl Page {
    /// An empty page as wide as the sheet, and as high unless that has its own height.
    pub fn new(sheet: &Sheet<'_>, height: f64) -> Page {
        let Sheet { title, description, run, width, weights, look, .. } = sheet;
        Page {
            title: (*title).to_owned(),
            description: (*description).to_owned(),
            run: run.map(str::to_owned),
            size: DVec2::new(*width, sheet.height.unwrap_or(height)),
            ground: (!look.transparent).then(|| ground(look.ink)),
            items: Vec::new(),
            weights: *weights,
            ink: look.ink,
        }
    }

    /// The weights of its medium.
    pub fn weights(&self) -> Weights {
        self.weights
    }

    /// Clips everything until [`Page::unclip`] to a box.
    pub fn clip(&mut self, area: [DVec2; 2]) {
        self.items.push(Item::Clip(area));
    }

    /// Ends the clipping.
    pub fn unclip(&mut self) {
        self.items.push(Item::Unclip);
    }

    /// Draws a path unless it is empty.
    pub fn path(&mut self, path: Path, coat: Coat) {
        if !path.is_empty() {
            self.items.push(Item::Path(path, coat));
        }
    }

    /// Draws a text anchored at a point of its baseline.
    pub fn text(&mut self, at: DVec2, size: f64, anchor: Anchor, text: &str) {
        self.text_in(at, size, anchor, letter(self.ink), text);
    }

    /// As [`Page::text`], in this colour.
    pub fn text_in(&mut self, at: DVec2, size: f64, anchor: Anchor, colour: Rgba, text: &str) {
        self.items.push(Item::Text(Text { at, size, anchor, colour, text: text.to_owned(), upright: false }));
    }

    /// Draws a vertical text with its middle at a point of its baseline.
    pub fn upright_text(&mut self, at: DVec2, size: f64, text: &str) {
        let (anchor, colour) = (Anchor::Middle, letter(self.ink));
        self.items.push(Item::Text(Text { at, size, anchor, colour, text: text.to_owned(), upright: true }));
    }

    /// Draws a plate in the colour of the ground with rounded corners, to go under a text.
    pub fn plate(&mut self, area: [DVec2; 2]) {
        let coat = Coat { opacity: 0.9, ..Coat::area(ground(self.ink)) };
        self.items.push(Item::Bar { area, coat, corner: 0.8, says: None });
    }

    /// Draws a rectangle.
    pub fn bar(&mut self, area: [DVec2; 2], coat: Coat) {
        self.items.push(Item::Bar { area, coat, corner: 0.0, says: None });
    }

    /// Draws a rectangle with a text that viewers show under the pointer, where they can.
    pub fn bar_that_says(&mut self, area: [DVec2; 2], coat: Coat, text: &str) {
        self.items.push(Item::Bar { area, coat, corner: 0.0, says: Some(text.to_owned()) });
    }
}

/// Many polygons or lines as one path, which avoids seams between neighbours and keeps files short.
#[derive(Clone, Debug, Default)]
pub struct Path {
    points: Vec<DVec2>,
    /// The number of points up to the end of each polygon or line, and whether it is closed.
    ends: Vec<(usize, bool)>,
}

impl Path {
    /// Adds a polygon or line through points of the page.
    pub fn walk(&mut self, points: impl Iterator<Item = DVec2>, closed: bool) {
        let before = self.points.len();
        self.points.extend(points);
        if self.points.len() > before {
            self.ends.push((self.points.len(), closed));
        }
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Its polygons and lines, and whether each is closed.
    pub(super) fn parts(&self) -> impl Iterator<Item = (&[DVec2], bool)> {
        let starts = std::iter::once(0).chain(self.ends.iter().map(|end| end.0));
        starts.zip(&self.ends).map(|(start, &(end, closed))| (&self.points[start..end], closed))
    }
}

/// The width of a text in the font of figures, in points.
pub fn width(text: &str, size: f64) -> f64 {
    let of = |c: char| match c {
        '0'..='9' | '−' => 0.6,
        ' ' => 0.236,
        '\u{2009}' => 0.12,
        '.' | ',' | ':' | 'i' | 'l' | '|' => 0.27,
        '°' => 0.35,
        'M' | 'W' | 'm' | 'w' => 0.84,
        'A'..='Z' => 0.64,
        _ => 0.55,
    };
    size * text.chars().map(of).sum::<f64>()
}

/// A length in points rounded to a thousandth: finer than any printer, and the same on every machine.
pub(super) fn rounded(length: f64) -> f64 {
    // Adding zero turns -0 into 0.
    (length * 1000.0).round() / 1000.0 + 0.0
}

/// The hatching of areas: parallel lines from the lower left to the upper right that are `apart` across and as wide as
/// `width`; one of them begins at the corner of the page.
pub(super) struct Hatching {
    pub apart: f64,
    pub width: f64,
}

impl Page {
    /// The hatching in the weights of the page.
    pub(super) fn hatching(&self) -> Hatching {
        Hatching { apart: 1.2 * self.weights.line, width: 0.3 * self.weights.line }
    }
}
