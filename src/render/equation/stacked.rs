//! Fractions and roots.

use super::{Bar, Drawing, Extent, Setting, Stroke, X_HEIGHT};
use crate::core::lesson::equation::Term;

/// How far baselines of numerators and denominators are from that of the fraction at least, in ems.
const UP: f32 = 0.676;
const DOWN: f32 = 0.686;
const UP_TIGHTLY: f32 = 0.394;
const DOWN_TIGHTLY: f32 = 0.345;
/// How much longer a bar is at either end, and the room beside it.
const LONGER: f32 = 0.06;
const BESIDE: f32 = 0.08;
/// The sign of a root: where its strokes meet, and how high the first one begins.
const ROOT: [f32; 4] = [0.03, 0.14, 0.3, 0.5];
const HOOK: f32 = 0.42;
/// How far a bar goes beyond what it covers.
const OVERHANG: f32 = 0.06;

impl Setting<'_> {
    /// A fraction.
    pub(super) fn fraction_of(self, above: &[Term], below: &[Term]) -> Drawing {
        let [above, below] = [above, below].map(|row| self.fraction().row(row));
        let (em, bar, axis) = (self.em(), self.bar(), self.axis());
        let (up, down, clearance) = match self.is_display() {
            true => (UP, DOWN, 3.0 * bar),
            false => (UP_TIGHTLY, DOWN_TIGHTLY, 1.5 * bar),
        };
        let up = (up * em).max(axis + 0.5 * bar + clearance + above.extent.below);
        let down = (down * em).max(0.5 * bar + clearance + below.extent.above - axis);
        let length = above.extent.width.max(below.extent.width) + 2.0 * LONGER * em;
        let width = length + 2.0 * BESIDE * em;
        let mut drawing = Drawing::default();
        drawing.bars.push(Bar { at: [BESIDE * em, -axis], length, thickness: bar });
        for (part, y) in [(above, -up), (below, down)] {
            let x = 0.5 * (width - part.extent.width);
            drawing.put(part, x, y);
        }
        drawing.extent.width = width;
        drawing
    }

    /// A root.
    pub(super) fn root(self, degree: &[Term], inside: &[Term]) -> Drawing {
        let inside = self.row(inside);
        let (em, bar) = (self.em(), self.bar());
        let clearance = bar + 0.25 * if self.is_display() { X_HEIGHT * em } else { bar };
        let foot = inside.extent.below.max(0.02 * em);
        // Roots of small letters are as high as those of large ones beside them.
        let top = inside.extent.above.max(X_HEIGHT * em) + clearance + 0.5 * bar;
        let mut drawing = Drawing::default();
        let mut x = 0.0;
        if !degree.is_empty() {
            let degree = self.script().script().row(degree);
            let width = degree.extent.width;
            let raised = HOOK * em + 0.1 * em + degree.extent.below - foot;
            drawing.put(degree, 0.0, -raised);
            x = (width - ROOT[1] * em).max(0.0);
        }
        let [start, hook, valley, peak] = ROOT.map(|k| x + k * em);
        let (end, hook_y) = (peak + inside.extent.width + OVERHANG * em, foot - HOOK * em);
        let points = vec![[start, hook_y + 0.06 * em], [hook, hook_y], [valley, foot], [peak, -top], [end, -top]];
        // The stroke that goes down is the thick one.
        drawing.strokes.push(Stroke { points: vec![points[1], points[2]], thickness: 1.7 * bar });
        drawing.strokes.push(Stroke { points, thickness: bar });
        drawing.put(inside, peak, 0.0);
        let sign = Extent { width: end, above: top + 0.5 * bar, below: foot + 0.5 * bar };
        drawing.put(Drawing { extent: sign, ..Drawing::default() }, 0.0, 0.0);
        drawing.extent.width = end;
        drawing
    }
}
