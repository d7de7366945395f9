//! Terms one after another, and single ones.

use super::{Drawing, Face, Level, Setting};
use crate::core::lesson::equation::{Class, Sign, Term, classes};

/// How much larger sums are where there is room.
const LARGE: f32 = 1.4;

impl Setting<'_> {
    /// Terms one after another, with the room that their classes leave.
    pub(super) fn row(self, row: &[Term]) -> Drawing {
        let mut drawing = Drawing::default();
        let mut x = 0.0;
        let mut before = None;
        for (term, class) in row.iter().zip(classes(row)) {
            match (term, class) {
                (Term::Space(room), _) => x += f32::from(*room) / 18.0 * self.em(),
                (term, Some(class)) => {
                    x += before.map_or(0.0, |before| self.room(before, class));
                    let part = self.term(term);
                    let width = part.extent.width;
                    drawing.put(part, x, 0.0);
                    x += width;
                    before = Some(class);
                }
                (_, None) => {}
            }
        }
        drawing.extent.width = x.max(0.0);
        drawing
    }

    /// The room between neighbours: the table of chapter 18 of the TeXbook, in eighteenths of the font size.
    fn room(self, left: Class, right: Class) -> f32 {
        use Class::{Binary, Closing, Inner, Opening, Operator, Ordinary, Punctuation, Relation};
        let is_roomy = self.level <= Level::Text;
        let eighteenths = match (left, right) {
            (Opening, _) | (_, Closing) => 0.0,
            (Ordinary | Closing | Operator | Inner, Operator) | (Operator, Ordinary) => 3.0,
            (Relation, Relation) | (Ordinary | Closing, Ordinary | Opening) | (Operator, Opening) => 0.0,
            (Relation, Punctuation) => 0.0,
            _ if !is_roomy => 0.0,
            (Binary, _) | (_, Binary) => 4.0,
            (Punctuation, _) => 3.0,
            (Relation, _) | (_, Relation) => 5.0,
            (Inner, Ordinary | Opening | Punctuation | Inner) | (Ordinary | Closing | Operator, Inner) => 3.0,
            (Ordinary | Closing | Operator, Punctuation) => 0.0,
        };
        eighteenths / 18.0 * self.em()
    }

    /// One term.
    pub(super) fn term(self, term: &Term) -> Drawing {
        match term {
            Term::Sign(sign) => self.sign(*sign),
            Term::Digits(text) | Term::Text(text) => self.text(text, Face::Upright, self.em()),
            Term::Function { name, .. } => self.text(name, Face::Upright, self.em()),
            Term::Value(quantity) => self.text(quantity.name(), Face::Upright, self.em()),
            Term::Group(row) => self.row(row),
            Term::Fraction { above, below } => self.fraction_of(above, below),
            Term::Root { degree, inside } => self.root(degree, inside),
            Term::Scripts { base, low, high } if self.is_display() && base.has_limits() => self.limits(base, low, high),
            Term::Scripts { base, low, high } => self.scripts(base, low, high),
            Term::Fenced { fences, inside } => self.fenced(*fences, inside),
            Term::Space(_) => Drawing::default(),
        }
    }

    fn sign(self, sign: Sign) -> Drawing {
        let text = sign.glyph.to_string();
        if sign.is_slanted() {
            return self.text(&text, Face::Italic, self.em());
        }
        if !(sign.is_large() && self.is_display()) {
            return self.text(&text, Face::Upright, self.em());
        }
        // Large ones stand in the middle of the line.
        let large = self.text(&text, Face::Upright, LARGE * self.em());
        let middle = 0.5 * (large.extent.above - large.extent.below);
        let mut drawing = Drawing::default();
        drawing.put(large, 0.0, middle - self.axis());
        drawing
    }
}
