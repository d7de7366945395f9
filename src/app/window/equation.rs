//! Equations in panels.

use eframe::egui::{
    Color32, FontId, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use super::theme::{equation_italic, regular};
use crate::core::lesson::Equation;
use crate::render::equation::{Drawing, Extent, Face, Measure};

/// Room around an equation, in its font sizes.
const AROUND: f32 = 0.15;
/// Equations are set no smaller than this part of their size, however narrow the panel.
const LEAST: f32 = 0.35;

/// Sets an equation at a font size, and smaller where the panel is too narrow for it. Screen readers and tests have it
/// as text.
pub fn equation(ui: &mut Ui, equation: &Equation, size: f32, colour: Color32) -> Response {
    Typeset::new(ui, equation, size).show(ui, colour)
}

/// An equation that is laid out for a panel.
#[derive(Clone, Debug)]
pub struct Typeset {
    drawing: Drawing,
    text: String,
    around: f32,
}

impl Typeset {
    /// Lays out an equation at a font size, or smaller, so that it fits the room there is.
    pub fn new(ui: &Ui, equation: &Equation, size: f32) -> Typeset {
        let fonts = Fonts(ui.painter());
        let room = ui.available_width() - 2.0 * AROUND * size;
        let least = LEAST * size;
        let mut at = size;
        let mut drawing = Drawing::of(equation, at, &fonts);
        // Widths do not shrink quite as sizes do, since glyphs and bars are fitted to pixels.
        for _ in 0..4 {
            let width = drawing.extent.width;
            if width <= room || at <= least {
                break;
            }
            at = (at * (room / width).clamp(0.5, 0.99)).max(least);
            drawing = Drawing::of(equation, at, &fonts);
        }
        Typeset { drawing, text: equation.text(), around: AROUND * size }
    }

    /// Its size in points, with the room around it.
    pub fn size(&self) -> Vec2 {
        let Extent { width, above, below } = self.drawing.extent;
        vec2(width, above + below) + Vec2::splat(2.0 * self.around)
    }

    /// How far its baseline is below its top.
    pub fn baseline(&self) -> f32 {
        self.drawing.extent.above + self.around
    }

    /// Draws it.
    pub fn show(&self, ui: &mut Ui, colour: Color32) -> Response {
        let (rect, response) = ui.allocate_exact_size(self.size(), Sense::hover());
        if ui.is_rect_visible(rect) {
            let at = rect.left_top() + vec2(self.around, self.baseline());
            self.paint(ui.painter(), at, colour);
        }
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &self.text));
        response
    }

    /// Draws it with the left end of its baseline at a place.
    fn paint(&self, painter: &Painter, at: Pos2, colour: Color32) {
        let place = |[x, y]: [f32; 2]| at + vec2(x, y);
        for text in &self.drawing.texts {
            let galley = painter.layout_no_wrap(text.text.clone(), font(text.face, text.size), colour);
            let first = galley.rows.first().and_then(|row| Some(row.pos.y + row.glyphs.first()?.pos.y));
            painter.galley(place(text.at) - vec2(0.0, first.unwrap_or(0.0)), galley, colour);
        }
        let pixel = painter.pixels_per_point();
        let snapped = |x: f32| (x * pixel).round() / pixel;
        for bar in &self.drawing.bars {
            // Whole pixels, or bars of one thickness would look different.
            let thickness = snapped(bar.thickness).max(1.0 / pixel);
            let left = place(bar.at);
            let top = snapped(left.y - 0.5 * bar.thickness);
            let rect = Rect::from_min_size(pos2(left.x, top), vec2(bar.length, thickness));
            painter.rect_filled(rect, 0.0, colour);
        }
        for stroke in &self.drawing.strokes {
            let points = stroke.points.iter().map(|point| place(*point)).collect();
            painter.add(Shape::line(points, Stroke::new(stroke.thickness, colour)));
        }
    }
}

fn font(face: Face, size: f32) -> FontId {
    match face {
        Face::Upright => regular(size),
        Face::Italic => equation_italic(size),
    }
}

/// The fonts of the window.
struct Fonts<'a>(&'a Painter);

impl Measure for Fonts<'_> {
    fn extent(&self, text: &str, face: Face, size: f32) -> Extent {
        let galley = self.0.layout_no_wrap(text.to_owned(), font(face, size), Color32::PLACEHOLDER);
        let glyphs = || galley.rows.iter().flat_map(|row| &row.glyphs);
        let inked = || glyphs().filter(|glyph| !glyph.uv_rect.is_nothing());
        let width = glyphs().last().map_or(0.0, |glyph| glyph.pos.x + glyph.advance_width);
        let above = inked().map(|glyph| -glyph.uv_rect.offset.y).fold(0.0, f32::max);
        let below = inked().map(|glyph| glyph.uv_rect.offset.y + glyph.uv_rect.size.y).fold(f32::MIN, f32::max);
        Extent { width, above, below: if below == f32::MIN { 0.0 } else { below } }
    }
}

#[cfg(test)]
mod tests;
