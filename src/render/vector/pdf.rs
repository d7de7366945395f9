//! PDF: vectors, text that can be selected, in the glyphs of the font that it uses, and the run as an attached file;
//! the same bytes for the same page. A point of the page is a point of the PDF.

use std::f64::consts::SQRT_2;

use glam::DVec2;
use krilla::color::rgb;
use krilla::embed::{AssociationKind, EmbeddedFile, MimeType};
use krilla::geom::{self, PathBuilder, Point, Transform};
use krilla::metadata::Metadata;
use krilla::num::NormalizedF32;
use krilla::page::PageSettings;
use krilla::paint::{self, Fill, FillRule, LineCap, StrokeDash};
use krilla::surface::Surface;
use krilla::text::{Font, GlyphId, KrillaGlyph};
use krilla::{Document, SerializeSettings};
use skrifa::instance::{LocationRef, Size};
use skrifa::metrics::GlyphMetrics;
use skrifa::{FontRef, MetadataProvider};

use super::page::{Anchor, Cap, Coat, FONT, Item, Page, Path, Stroke, Text, rounded};
use crate::core::fault::Fault;
use crate::core::kernel::number::grouped;
use crate::core::record::figure::{ATTACHED, ATTACHED_TYPE};
use crate::render::palette::{HATCHING, Paint, Rgba};

/// The largest page in points that readers of PDF must be able to show.
const MOST: f64 = 14_400.0;
/// The length of a line that is a dot. Lines without length are left out.
const DOT: f64 = 0.001;
/// The control points of a quarter circle, as a share of the radius.
const QUARTER: f64 = 0.552_284_749_8;

/// Writes a page as a PDF file. It has no dates.
///
/// # Errors
/// A size that is not possible.
pub fn write(page: &Page) -> Result<Vec<u8>, Fault> {
    let [width, height] = page.size.to_array().map(short);
    if page.size.max_element() > MOST {
        let fault = refuse(format!("a page of {} x {} pt is too large", width.round(), height.round()));
        return Err(fault.remedy(format!("A side has at most {} pt; choose a smaller size", grouped(MOST as u64))));
    }
    let size = PageSettings::from_wh(width, height).ok_or_else(|| refuse("it has no size"))?;
    let type_ = Type::read().ok_or_else(|| refuse("its font cannot be read"))?;
    let mut document = Document::new_with(SerializeSettings { enable_tagging: false, ..SerializeSettings::default() });
    let program = format!("{} {}", env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"));
    let told = Metadata::new().title(plain(&page.title)).description(plain(&page.description));
    document.set_metadata(told.creator(program.clone()).producer(program).language("en".to_owned()));
    if let Some(run) = &page.run {
        document.embed_file(attached(run));
    }
    let mut sheet = document.start_page_with(size);
    let mut surface = sheet.surface();
    let mut writer = Writer { surface: &mut surface, page, type_, clips: 0 };
    if let Some(ground) = page.ground {
        writer.bar([DVec2::ZERO, page.size], &Coat::area(ground), 0.0);
    }
    page.items.iter().for_each(|item| writer.item(item));
    // Each clipping has an end, or the writer of the page is wrong.
    debug_assert_eq!(writer.clips, 0);
    surface.finish();
    sheet.finish();
    document.finish().map_err(|error| refuse(format!("{error:?}")))
}

fn refuse(error: impl std::fmt::Display) -> Fault {
    Fault::new(format!("The PDF cannot be written: {error}"))
}

/// The run as an attached file, which other programs can save, too.
fn attached(run: &str) -> EmbeddedFile {
    EmbeddedFile {
        path: ATTACHED.to_owned(),
        mime_type: MimeType::new(ATTACHED_TYPE),
        description: Some("The run that this figure shows; quadfront opens the figure itself, too".to_owned()),
        association_kind: AssociationKind::Source,
        data: run.as_bytes().to_vec().into(),
        modification_date: None,
        // It can be read without any program.
        compress: Some(false),
        location: None,
    }
}

/// A text without control characters.
fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

fn short(length: f64) -> f32 {
    rounded(length) as f32
}

fn colour(Rgba([r, g, b, _]): Rgba) -> paint::Paint {
    rgb::Color::new(r, g, b).into()
}

fn opacity(share: f32) -> NormalizedF32 {
    NormalizedF32::new(share).unwrap_or(NormalizedF32::ONE)
}

fn stroke(stroke: &Stroke) -> paint::Stroke {
    paint::Stroke {
        paint: colour(stroke.colour),
        width: short(stroke.width),
        // As in SVG.
        miter_limit: 4.0,
        line_cap: if stroke.cap == Some(Cap::Round) { LineCap::Round } else { LineCap::Butt },
        opacity: opacity(stroke.opacity),
        dash: stroke.dash.map(|dash| StrokeDash { array: dash.map(short).to_vec(), offset: 0.0 }),
        ..paint::Stroke::default()
    }
}

/// The font of figures. It has neither kerning nor ligatures: a glyph for each character.
struct Type {
    font: Font,
    glyphs: skrifa::charmap::Charmap<'static>,
    widths: GlyphMetrics<'static>,
}

impl Type {
    fn read() -> Option<Type> {
        let font = Font::new(FONT.to_vec().into(), 0)?;
        let read = FontRef::new(FONT).ok()?;
        let widths = read.glyph_metrics(Size::new(1.0), LocationRef::default());
        Some(Type { font, glyphs: read.charmap(), widths })
    }

    /// The glyphs of a text, and its width at the size 1.
    fn set(&self, text: &str) -> (Vec<KrillaGlyph>, f32) {
        let glyph = |(at, c): (usize, char)| {
            let glyph = self.glyphs.map(c).unwrap_or_default();
            let advance = self.widths.advance_width(glyph).unwrap_or(0.0);
            KrillaGlyph::new(GlyphId::new(glyph.to_u32()), advance, 0.0, 0.0, 0.0, at..at + c.len_utf8(), None)
        };
        let glyphs: Vec<KrillaGlyph> = text.char_indices().map(glyph).collect();
        let width = glyphs.iter().map(|glyph| glyph.x_advance).sum();
        (glyphs, width)
    }
}

struct Writer<'w, 's> {
    surface: &'w mut Surface<'s>,
    page: &'w Page,
    type_: Type,
    /// How many clippings are in force.
    clips: usize,
}

impl Writer<'_, '_> {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Path(path, coat) => {
                if let Some(outline) = outline(path) {
                    self.coated(&outline, bounds(path), coat);
                }
            }
            Item::Bar { area, coat, corner, says: _ } => self.bar(*area, coat, *corner),
            Item::Text(text) => self.text(text),
            Item::Clip(area) => {
                if let Some(outline) = rectangle(*area, 0.0) {
                    self.surface.push_clip_path(&outline, &FillRule::NonZero);
                    self.clips += 1;
                }
            }
            Item::Unclip if self.clips > 0 => {
                self.surface.pop();
                self.clips -= 1;
            }
            Item::Unclip => {}
        }
    }

    fn bar(&mut self, area: [DVec2; 2], coat: &Coat, corner: f64) {
        if let Some(outline) = rectangle(area, corner) {
            self.coated(&outline, area, coat);
        }
    }

    fn coated(&mut self, outline: &geom::Path, bounds: [DVec2; 2], coat: &Coat) {
        let fill = |paint| Fill { paint, opacity: opacity(coat.opacity), rule: FillRule::NonZero };
        let filled = match coat.fill {
            Some(Paint::Colour(paint)) => Some(fill(colour(paint))),
            Some(Paint::Hatch) => {
                self.hatch(outline, bounds);
                None
            }
            None => None,
        };
        // Without either, the surface would fill with black.
        if filled.is_some() || coat.stroke.is_some() {
            self.surface.set_fill(filled);
            self.surface.set_stroke(coat.stroke.as_ref().map(stroke));
            self.surface.draw_path(outline);
        }
    }

    /// Hatches an area. Lines of its own are the same in every reader, unlike tiles.
    fn hatch(&mut self, outline: &geom::Path, [low, high]: [DVec2; 2]) {
        let hatching = self.page.hatching();
        let mut lines = PathBuilder::new();
        // Along a line x + y is the same.
        let number = |p: DVec2| (p.x + p.y) / SQRT_2 / hatching.apart;
        let (first, last) = (number(low).floor() as i64 - 1, number(high).ceil() as i64);
        for k in first..=last {
            let sum = SQRT_2 * (k as f64 * hatching.apart + 0.5 * hatching.width);
            lines.move_to(short(sum - high.y), short(high.y));
            lines.line_to(short(sum - low.y), short(low.y));
        }
        let Some(lines) = lines.finish() else { return };
        self.surface.push_clip_path(outline, &FillRule::NonZero);
        self.surface.set_fill(None);
        self.surface.set_stroke(Some(stroke(&Stroke::of(HATCHING, hatching.width))));
        self.surface.draw_path(&lines);
        self.surface.pop();
    }

    fn text(&mut self, text: &Text) {
        let Text { at, size, anchor, colour: ink, text, upright } = text;
        let text = plain(text);
        let (glyphs, width) = self.type_.set(&text);
        let share = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5,
            Anchor::End => 1.0,
        };
        let (size, back) = (short(*size), share * width * short(*size));
        let turn = if *upright { -90.0 } else { 0.0 };
        let [x, y] = at.to_array().map(short);
        let start = if *upright {
            self.surface.push_transform(&Transform::from_rotate_at(turn, x, y));
            Point::from_xy(x - back, y)
        } else {
            Point::from_xy(x - back, y)
        };
        self.surface.set_stroke(None);
        let rule = FillRule::NonZero;
        self.surface.set_fill(Some(Fill { paint: colour(*ink), opacity: NormalizedF32::ONE, rule }));
        self.surface.draw_glyphs(start, &glyphs, self.type_.font.clone(), &text, size, false);
        if *upright {
            self.surface.pop();
        }
    }
}

/// A path; `None` where it has no points that are numbers.
fn outline(path: &Path) -> Option<geom::Path> {
    let mut builder = PathBuilder::new();
    for (points, closed) in path.parts() {
        let is_dot = !closed && points.iter().all(|p| *p == points[0]);
        let end = is_dot.then(|| points[0] + DVec2::new(DOT, 0.0));
        for (k, p) in points.iter().take(if is_dot { 1 } else { points.len() }).chain(&end).enumerate() {
            let [x, y] = p.to_array().map(short);
            if k == 0 { builder.move_to(x, y) } else { builder.line_to(x, y) }
        }
        if closed {
            builder.close();
        }
    }
    builder.finish()
}

/// The box around a path.
fn bounds(path: &Path) -> [DVec2; 2] {
    let all = path.parts().flat_map(|(points, _)| points);
    all.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[low, high], p| [low.min(*p), high.max(*p)])
}

/// A rectangle with rounded corners; `None` where it has no area, which SVG does not draw either.
fn rectangle([low, high]: [DVec2; 2], corner: f64) -> Option<geom::Path> {
    if !(high.x > low.x && high.y > low.y) {
        return None;
    }
    let mut builder = PathBuilder::new();
    let [l, t, r, b] = [low.x, low.y, high.x, high.y].map(short);
    let size = 0.5 * (high - low).min_element();
    let [c, k] = [corner.min(size), corner.min(size) * (1.0 - QUARTER)].map(short);
    builder.move_to(l + c, t);
    builder.line_to(r - c, t);
    if c > 0.0 {
        builder.cubic_to(r - k, t, r, t + k, r, t + c);
    }
    builder.line_to(r, b - c);
    if c > 0.0 {
        builder.cubic_to(r, b - k, r - k, b, r - c, b);
    }
    builder.line_to(l + c, b);
    if c > 0.0 {
        builder.cubic_to(l + k, b, l, b - k, l, b - c);
    }
    builder.line_to(l, t + c);
    if c > 0.0 {
        builder.cubic_to(l, t + k, l + k, t, l + c, t);
    }
    builder.close();
    builder.finish()
}
