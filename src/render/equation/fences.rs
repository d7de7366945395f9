//! Brackets that grow with what is between them.

use super::{Drawing, Extent, Face, Setting, Stroke};
use crate::core::lesson::equation::Term;

/// How much of what they hold brackets cover, and how much they leave at most, in ems: a bracket need not be as high.
const SHARE: f32 = 0.92;
const LEFT_OVER: f32 = 0.25;
/// The thickness of brackets, in ems: that of the bracket of the font.
const THICK: f32 = 0.075;
/// The room on either side of a bracket.
const BESIDE: f32 = 0.07;
/// Pieces of a bend.
const PIECES: usize = 24;

impl Setting<'_> {
    /// Terms between brackets.
    pub(super) fn fenced(self, fences: [Option<char>; 2], inside: &[Term]) -> Drawing {
        let inside = self.row(inside);
        let half = (inside.extent.above - self.axis()).max(inside.extent.below + self.axis());
        let height = (2.0 * SHARE * half).max(2.0 * half - LEFT_OVER * self.em());
        let mut drawing = Drawing::default();
        let mut x = 0.0;
        let [left, right] = fences.map(|fence| fence.map(|fence| self.fence(fence, height)));
        for part in [left, Some(inside), right].into_iter().flatten() {
            let width = part.extent.width;
            drawing.put(part, x, 0.0);
            x += width;
        }
        drawing.extent.width = x;
        drawing
    }

    /// A bracket of a height: that of the font where it is high enough.
    fn fence(self, fence: char, height: f32) -> Drawing {
        let (em, axis) = (self.em(), self.axis());
        let glyph = self.text(&fence.to_string(), Face::Upright, em);
        if glyph.extent.above + glyph.extent.below >= height {
            return glyph;
        }
        let depth = match fence {
            '|' => 0.0,
            '[' | ']' => 0.16 * em,
            // Higher ones are bent more, but never much.
            _ => (0.12 * height).clamp(0.2 * em, 0.4 * em),
        };
        let opening = match fence {
            '(' | ')' => bow(depth, height),
            '[' | ']' => {
                let half = 0.5 * height;
                vec![[depth, -half], [0.0, -half], [0.0, half], [depth, half]]
            }
            '{' | '}' => brace(depth, height),
            _ => vec![[0.0, -0.5 * height], [0.0, 0.5 * height]],
        };
        let is_closing = matches!(fence, ')' | ']' | '}');
        let thickness = THICK * em;
        let edge = BESIDE * em + 0.5 * thickness;
        let placed = |[x, y]: [f32; 2]| [edge + if is_closing { depth - x } else { x }, y - axis];
        let points = opening.into_iter().map(placed).collect();
        let half = 0.5 * (height + thickness);
        let extent = Extent { width: 2.0 * edge + depth, above: half + axis, below: half - axis };
        Drawing { extent, strokes: vec![Stroke { points, thickness }], ..Drawing::default() }
    }
}

/// An arc of a circle, from top to foot about the middle; it opens to the right.
fn bow(depth: f32, height: f32) -> Vec<[f32; 2]> {
    let radius = (0.25 * height * height + depth * depth) / (2.0 * depth);
    let point = |k: usize| {
        let y = height * (k as f32 / PIECES as f32 - 0.5);
        [radius - (radius * radius - y * y).max(0.0).sqrt(), y]
    };
    (0..=PIECES).map(point).collect()
}

/// A brace, from top to foot about the middle; its tip is on the left.
fn brace(depth: f32, height: f32) -> Vec<[f32; 2]> {
    let (half, middle) = (0.5 * height, 0.5 * depth);
    let bend = (0.25 * height).min(depth);
    let curve = |from: [f32; 2], by: [f32; 2], to: [f32; 2]| {
        (0..=PIECES / 2).map(move |k| {
            let t = 2.0 * k as f32 / PIECES as f32;
            let at = |i: usize| (1.0 - t) * (1.0 - t) * from[i] + 2.0 * t * (1.0 - t) * by[i] + t * t * to[i];
            [at(0), at(1)]
        })
    };
    let upper: Vec<[f32; 2]> = curve([depth, -half], [middle, -half], [middle, bend - half])
        .chain(curve([middle, -bend], [middle, 0.0], [0.0, 0.0]))
        .collect();
    let lower = upper.iter().rev().skip(1).map(|[x, y]| [*x, -y]);
    upper.iter().copied().chain(lower).collect()
}
