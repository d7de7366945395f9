//! SVG: vector paths, widths in points, text in an embedded font, the same bytes for the same page.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec2;

use super::page::{Anchor, Cap, Coat, FAMILY, FONT, Item, Page, Path, Stroke, Text, rounded};
use crate::core::record::figure;
use crate::render::palette::{HATCHING, Paint};

/// Writes a page as an SVG file. It brings its font along where it has text.
pub fn write(page: &Page) -> String {
    let [w, h] = page.size.to_array().map(Short);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}pt\" height=\"{h}pt\" viewBox=\"0 0 {w} {h}\">\n\
         <title>{}</title>\n<desc>{}</desc>\n",
        escaped(&page.title),
        escaped(&page.description)
    );
    if let Some(run) = &page.run {
        svg.push_str(&figure::metadata(run));
    }
    if page.items.iter().any(|item| matches!(item, Item::Text(_))) {
        let font = STANDARD.encode(FONT);
        // Writing to a String cannot fail.
        let _ =
            writeln!(svg, "<style>@font-face{{font-family:\"{FAMILY}\";src:url(data:font/ttf;base64,{font})}}</style>");
    }
    if let Some(ground) = page.ground {
        let _ = writeln!(svg, "<rect width=\"{w}\" height=\"{h}\" fill=\"{ground}\"/>");
    }
    let mut writer = Writer { svg, page, hatched: false, clips: 0 };
    page.items.iter().for_each(|item| writer.item(item));
    writer.svg.push_str("</svg>\n");
    writer.svg
}

struct Writer<'a> {
    svg: String,
    page: &'a Page,
    /// Whether the hatching is defined.
    hatched: bool,
    clips: usize,
}

impl Writer<'_> {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Path(path, coat) => {
                self.define_hatching(coat);
                let _ = writeln!(self.svg, "<path {} d=\"{}\"/>", attributes(coat, 0.0), data(path));
            }
            Item::Bar { area, coat, corner, says } => {
                self.define_hatching(coat);
                let end = says
                    .as_ref()
                    .map_or_else(|| "/>".to_owned(), |text| format!("><title>{}</title></rect>", escaped(text)));
                let _ = writeln!(self.svg, "<rect {} {}{end}", place(*area), attributes(coat, *corner));
            }
            Item::Text(text) => self.text(text),
            Item::Clip(area) => {
                let number = self.clips;
                self.clips += 1;
                let _ = writeln!(
                    self.svg,
                    "<clipPath id=\"part{number}\"><rect {}/></clipPath>\n<g clip-path=\"url(#part{number})\">",
                    place(*area)
                );
            }
            Item::Unclip => self.svg.push_str("</g>\n"),
        }
    }

    /// Defines the hatching where it is used for the first time.
    fn define_hatching(&mut self, coat: &Coat) {
        if coat.fill == Some(Paint::Hatch) && !std::mem::replace(&mut self.hatched, true) {
            let hatching = self.page.hatching();
            let [apart, width] = [hatching.apart, hatching.width].map(Short);
            let _ = writeln!(
                self.svg,
                "<pattern id=\"hatch\" width=\"{apart}\" height=\"{apart}\" patternUnits=\"userSpaceOnUse\" \
                 patternTransform=\"rotate(45)\"><rect width=\"{width}\" height=\"{apart}\" fill=\"{HATCHING}\"/>\
                 </pattern>"
            );
        }
    }

    fn text(&mut self, text: &Text) {
        let Text { at, size, anchor, colour, text, upright } = text;
        let [x, y] = at.to_array().map(Short);
        let place = if *upright {
            format!("transform=\"translate({x} {y}) rotate(-90)\"")
        } else {
            format!("x=\"{x}\" y=\"{y}\"")
        };
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let _ = writeln!(
            self.svg,
            "<text {place} font-family=\"{FAMILY}, IBM Plex Sans, Arial, sans-serif\" font-size=\"{}\" \
             text-anchor=\"{anchor}\" fill=\"{colour}\">{}</text>",
            Short(*size),
            escaped(text)
        );
    }
}

fn place([low, high]: [DVec2; 2]) -> String {
    let ([x, y], [w, h]) = (low.to_array().map(Short), (high - low).to_array().map(Short));
    format!("x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"")
}

/// The attributes of a coat; `corner` is the radius of corners.
fn attributes(coat: &Coat, corner: f64) -> String {
    let fill = coat.fill.map_or_else(
        || "none".to_owned(),
        |fill| match fill {
            Paint::Colour(colour) => colour.to_string(),
            Paint::Hatch => "url(#hatch)".to_owned(),
        },
    );
    let mut text = format!("fill=\"{fill}\"");
    if coat.opacity < 1.0 {
        let _ = write!(text, " fill-opacity=\"{}\"", coat.opacity);
    }
    if corner > 0.0 {
        let _ = write!(text, " rx=\"{}\"", Short(corner));
    }
    let Some(Stroke { colour, width, cap, dash, opacity }) = coat.stroke else { return text };
    let _ = write!(text, " stroke=\"{colour}\" stroke-width=\"{}\"", Short(width));
    if let Some(cap) = cap {
        let _ = write!(text, " stroke-linecap=\"{}\"", if cap == Cap::Round { "round" } else { "butt" });
    }
    if let Some(dash) = dash {
        let [on, off] = dash.map(Short);
        let _ = write!(text, " stroke-dasharray=\"{on} {off}\"");
    }
    if opacity < 1.0 {
        let _ = write!(text, " stroke-opacity=\"{opacity}\"");
    }
    text
}

fn data(path: &Path) -> String {
    let mut data = String::new();
    for (points, closed) in path.parts() {
        for (k, p) in points.iter().enumerate() {
            let letter = if k == 0 { 'M' } else { 'L' };
            let _ = write!(data, "{letter}{} {}", Short(p.x), Short(p.y));
        }
        data.push_str(if closed { "Z\n" } else { "\n" });
    }
    data.truncate(data.trim_end().len());
    data
}

/// A rounded length.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", rounded(self.0))
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
