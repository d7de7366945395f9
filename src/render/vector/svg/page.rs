//! The text of an SVG file: header with embedded data, paths and text.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec2;

use super::Sheet;
use super::Weights;
use crate::core::record::figure;
use crate::render::look::Ink;
use crate::render::palette::{ground, letter};

/// The font of figures: the characters of IBM Plex Sans that they need.
pub(in crate::render::vector) const FONT: &[u8] =
    include_bytes!("../../../../assets/fonts/QuadfrontFigure-Regular.ttf");
/// Its name.
pub(in crate::render::vector) const FAMILY: &str = "Quadfront Figure";

/// An SVG being written.
pub struct Page {
    svg: String,
    weights: Weights,
    hatched: bool,
    ink: Ink,
}

impl Page {
    /// A page as wide as the sheet; it embeds the font where there is text.
    pub fn new(sheet: &Sheet<'_>, height: f64, has_text: bool) -> Page {
        let (w, h) = (Short(sheet.width), Short(sheet.height.unwrap_or(height)));
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}pt\" height=\"{h}pt\" viewBox=\"0 0 {w} {h}\">\n\
             <title>{}</title>\n<desc>{}</desc>\n",
            escaped(sheet.title),
            escaped(sheet.description)
        );
        if let Some(run) = sheet.run {
            svg.push_str(&figure::metadata(run));
        }
        if has_text {
            let font = STANDARD.encode(FONT);
            // Writing to a String cannot fail.
            let _ = writeln!(
                svg,
                "<style>@font-face{{font-family:\"{FAMILY}\";src:url(data:font/ttf;base64,{font})}}</style>"
            );
        }
        if !sheet.look.transparent {
            let fill = ground(sheet.look.ink);
            let _ = writeln!(svg, "<rect width=\"{w}\" height=\"{h}\" fill=\"{fill}\"/>");
        }
        Page { svg, weights: sheet.weights, hatched: false, ink: sheet.look.ink }
    }

    /// The weights of its medium.
    pub fn weights(&self) -> Weights {
        self.weights
    }

    /// Clips everything until [`Page::unclip`] to a box.
    pub fn clip(&mut self, number: usize, at: DVec2, size: DVec2) {
        let _ = writeln!(
            self.svg,
            "<clipPath id=\"part{number}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n\
             <g clip-path=\"url(#part{number})\">",
            Short(at.x),
            Short(at.y),
            Short(size.x),
            Short(size.y)
        );
    }

    /// Ends the clipping.
    pub fn unclip(&mut self) {
        self.svg.push_str("</g>\n");
    }

    /// Defines the hatching, once.
    pub fn define_hatch(&mut self) {
        if !std::mem::replace(&mut self.hatched, true) {
            let [apart, width] = [1.2, 0.3].map(|length| Short(length * self.weights.line));
            let _ = writeln!(
                self.svg,
                "<pattern id=\"hatch\" width=\"{apart}\" height=\"{apart}\" patternUnits=\"userSpaceOnUse\" \
                 patternTransform=\"rotate(45)\"><rect width=\"{width}\" height=\"{apart}\" fill=\"#404040\"/>\
                 </pattern>"
            );
        }
    }

    /// Writes a path unless it is empty.
    pub fn path(&mut self, path: &Path, attributes: &str) {
        if !path.is_empty() {
            let _ = writeln!(self.svg, "<path {attributes} d=\"{}\"/>", path.data.trim_end());
        }
    }

    /// Writes a text anchored with its start, middle or end at a point of its baseline.
    pub fn text(&mut self, at: DVec2, size: f64, anchor: &str, text: &str) {
        self.text_in(at, size, anchor, letter(self.ink), text);
    }

    /// As [`Page::text`], in this ink.
    pub fn text_in(&mut self, at: DVec2, size: f64, anchor: &str, ink: &str, text: &str) {
        self.placed_text(&format!("x=\"{}\" y=\"{}\"", Short(at.x), Short(at.y)), size, anchor, ink, text);
    }

    /// Writes a vertical text with its middle at a point of its baseline.
    pub fn upright_text(&mut self, at: DVec2, size: f64, text: &str) {
        let place = format!("transform=\"translate({} {}) rotate(-90)\"", Short(at.x), Short(at.y));
        self.placed_text(&place, size, "middle", letter(self.ink), text);
    }

    fn placed_text(&mut self, place: &str, size: f64, anchor: &str, ink: &str, text: &str) {
        let _ = writeln!(
            self.svg,
            "<text {place} font-family=\"{FAMILY}, IBM Plex Sans, Arial, sans-serif\" font-size=\"{}\" \
             text-anchor=\"{anchor}\" fill=\"{ink}\">{}</text>",
            Short(size),
            escaped(text)
        );
    }

    /// Writes a plate in the colour of the ground with rounded corners, to go under a text.
    pub fn plate(&mut self, [low, high]: [DVec2; 2]) {
        self.bar([low, high], &format!("fill=\"{}\" fill-opacity=\"0.9\" rx=\"0.8\"", ground(self.ink)));
    }

    /// A rectangle.
    pub fn bar(&mut self, area: [DVec2; 2], attributes: &str) {
        self.rectangle(area, attributes, "/>");
    }

    /// A rectangle with a text that viewers show under the pointer.
    pub fn bar_that_says(&mut self, area: [DVec2; 2], attributes: &str, text: &str) {
        self.rectangle(area, attributes, &format!("><title>{}</title></rect>", escaped(text)));
    }

    fn rectangle(&mut self, [low, high]: [DVec2; 2], attributes: &str, end: &str) {
        let size = high - low;
        let _ = writeln!(
            self.svg,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" {attributes}{end}",
            Short(low.x),
            Short(low.y),
            Short(size.x),
            Short(size.y)
        );
    }

    /// The whole file.
    pub fn finish(mut self) -> String {
        self.svg.push_str("</svg>\n");
        self.svg
    }
}

/// Many polygons or lines as one path element, which avoids seams between neighbours and keeps the file short.
#[derive(Default)]
pub struct Path {
    data: String,
}

impl Path {
    /// Adds a polygon or line through points of the page.
    pub fn walk(&mut self, points: impl Iterator<Item = DVec2>, closed: bool) {
        for (k, p) in points.enumerate() {
            let letter = if k == 0 { 'M' } else { 'L' };
            // Writing to a String cannot fail.
            let _ = write!(self.data, "{letter}{} {}", Short(p.x), Short(p.y));
        }
        self.data.push_str(if closed { "Z\n" } else { "\n" });
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.data.is_empty()
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
pub struct Short(pub f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Adding zero turns -0 into 0.
        write!(f, "{}", (self.0 * 1000.0).round() / 1000.0 + 0.0)
    }
}

fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            // XML allows no other control characters, and not these two.
            c if c.is_control() && c != '\n' && c != '\t' || matches!(c, '\u{FFFE}' | '\u{FFFF}') => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_short_and_never_minus_nothing() {
        assert_eq!([1.0, -0.0001, 0.1 + 0.2, 1234.56789].map(|x| Short(x).to_string()), ["1", "0", "0.3", "1234.568"]);
    }
}
