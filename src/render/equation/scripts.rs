//! Subscripts, superscripts and limits.

use super::{Drawing, Setting, X_HEIGHT};
use crate::core::lesson::equation::Term;

/// How far scripts of a single letter are moved at least, in ems.
const UP: f32 = 0.38;
const DOWN: f32 = 0.2;
/// How far scripts stand beyond the edges of what is larger than a letter.
const BEYOND_TOP: f32 = 0.28;
const BEYOND_FOOT: f32 = 0.06;
/// The least room between a subscript and a superscript.
const BETWEEN: f32 = 0.1;
/// The room after scripts.
const AFTER: f32 = 0.05;
/// The room between a sum and its limits.
const TO_LIMITS: f32 = 0.13;

impl Setting<'_> {
    /// A term with what stands at its right.
    pub(super) fn scripts(self, base: &Term, low: &[Term], high: &[Term]) -> Drawing {
        let em = self.em();
        let base_drawing = self.term(base);
        let is_letter = matches!(base, Term::Sign(_) | Term::Digits(_) | Term::Function { .. });
        let (above, below) = (base_drawing.extent.above, base_drawing.extent.below);
        let mut x = base_drawing.extent.width;
        let mut drawing = Drawing::default();
        drawing.put(base_drawing, 0.0, 0.0);
        // Signs that fonts have raised are part of the line.
        let is_raised = |term: &&Term| matches!(term, Term::Sign(sign) if sign.is_raised());
        let (raised, high) = high.split_at(high.iter().take_while(is_raised).count());
        let foot = x;
        if !raised.is_empty() {
            let raised = self.row(raised);
            let width = raised.extent.width;
            drawing.put(raised, x, 0.0);
            x += width;
        }
        let low = (!low.is_empty()).then(|| self.script().row(low));
        let high = (!high.is_empty()).then(|| self.script().row(high));
        let up = high.as_ref().map_or(0.0, |high| {
            let of_base = if is_letter { 0.0 } else { above - BEYOND_TOP * em };
            of_base.max(UP * em).max(high.extent.below + 0.25 * X_HEIGHT * em)
        });
        let mut down = low.as_ref().map_or(0.0, |low| {
            let of_base = if is_letter { 0.0 } else { below + BEYOND_FOOT * em };
            of_base.max(DOWN * em).max(low.extent.above - 0.8 * X_HEIGHT * em)
        });
        if let (Some(low), Some(high)) = (&low, &high) {
            let room = (up - high.extent.below) + (down - low.extent.above);
            down += (BETWEEN * em - room).max(0.0);
        }
        for (script, x, y) in [(low, foot, down), (high, x, -up)] {
            if let Some(script) = script {
                drawing.put(script, x, y);
            }
        }
        drawing.extent.width += AFTER * em;
        drawing
    }

    /// A term with what stands below and above it.
    pub(super) fn limits(self, base: &Term, low: &[Term], high: &[Term]) -> Drawing {
        let base = self.term(base);
        let [low, high] = [low, high].map(|row| self.script().row(row));
        let room = TO_LIMITS * self.em();
        let width = [&base, &low, &high].map(|part| part.extent.width).into_iter().fold(0.0, f32::max);
        let down = base.extent.below + room + low.extent.above;
        let up = base.extent.above + room + high.extent.below;
        let mut drawing = Drawing::default();
        for (part, y) in [(base, 0.0), (low, down), (high, -up)] {
            // An empty limit takes no room.
            if !part.texts.is_empty() {
                let x = 0.5 * (width - part.extent.width);
                drawing.put(part, x, y);
            }
        }
        drawing.extent.width = width;
        drawing
    }
}
