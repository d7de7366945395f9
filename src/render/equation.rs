//! Equations as texts, bars and strokes at their places, with the room between them that TeX leaves. What is drawn is
//! told in points from the left end of the baseline, y downwards; how wide a text is, the [`Measure`] says.

mod fences;
mod row;
mod scripts;
mod stacked;

use crate::core::lesson::Equation;

/// A family of letters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Digits, operators, names of functions.
    Upright,
    /// Variables.
    Italic,
}

/// How large something is, in points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// From its left end to where the next thing begins.
    pub width: f32,
    /// What it covers above the baseline.
    pub above: f32,
    /// What it covers below the baseline.
    pub below: f32,
}

/// Knows the fonts.
pub trait Measure {
    /// The extent of a text; above and below it is that of its ink.
    fn extent(&self, text: &str, face: Face, size: f32) -> Extent;
}

/// A text at its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// The text.
    pub text: String,
    /// Its letters.
    pub face: Face,
    /// The font size in points.
    pub size: f32,
    /// The left end of its baseline.
    pub at: [f32; 2],
    /// Its extent there.
    pub extent: Extent,
}

/// A horizontal bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Its left end, on its middle line.
    pub at: [f32; 2],
    /// Its length.
    pub length: f32,
    /// Its thickness.
    pub thickness: f32,
}

/// Straight lines from point to point.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// The points.
    pub points: Vec<[f32; 2]>,
    /// The thickness of the lines.
    pub thickness: f32,
}

/// An equation, or a part of one, with everything at its place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// The extent of the whole.
    pub extent: Extent,
    /// Texts.
    pub texts: Vec<Text>,
    /// Bars of fractions.
    pub bars: Vec<Bar>,
    /// Signs of roots, brackets that have grown.
    pub strokes: Vec<Stroke>,
}

impl Drawing {
    /// Lays out an equation at a font size in points.
    pub fn of(equation: &Equation, size: f32, measure: &dyn Measure) -> Drawing {
        let setting = Setting { measure, size, level: Level::Display };
        setting.row(equation.row())
    }

    /// Takes another drawing in, moved; the extent grows with it.
    fn put(&mut self, other: Drawing, x: f32, y: f32) {
        let moved = |[a, b]: [f32; 2]| [a + x, b + y];
        self.extent.width = self.extent.width.max(x + other.extent.width);
        self.extent.above = self.extent.above.max(other.extent.above - y);
        self.extent.below = self.extent.below.max(other.extent.below + y);
        self.texts.extend(other.texts.into_iter().map(|text| Text { at: moved(text.at), ..text }));
        self.bars.extend(other.bars.into_iter().map(|bar| Bar { at: moved(bar.at), ..bar }));
        let strokes = other.strokes.into_iter();
        self.strokes
            .extend(strokes.map(|stroke| Stroke { points: stroke.points.into_iter().map(moved).collect(), ..stroke }));
    }
}

/// How much room there is: scripts are smaller, and what stands in a fraction is set more tightly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Display,
    Text,
    Script,
    Second,
}

/// The place at which something is set.
#[derive(Clone, Copy)]
struct Setting<'m> {
    measure: &'m dyn Measure,
    /// The font size of the equation.
    size: f32,
    level: Level,
}

/// Sizes of scripts, and of scripts of scripts, in that of the equation: seventeen points become twelve and eleven.
const SCRIPT: f32 = 0.72;
const SECOND: f32 = 0.62;
/// The height of the middle line of plus, minus and bars, in ems: that of IBM Plex Sans.
const AXIS: f32 = 0.305;
/// The height of its small letters.
const X_HEIGHT: f32 = 0.516;
/// The thickness of bars: a little less than that of its minus, as such a bar is long.
const BAR: f32 = 0.058;

impl<'m> Setting<'m> {
    /// The font size here.
    fn em(self) -> f32 {
        let factor = match self.level {
            Level::Display | Level::Text => 1.0,
            Level::Script => SCRIPT,
            Level::Second => SECOND,
        };
        self.size * factor
    }

    fn at(self, level: Level) -> Setting<'m> {
        Setting { level, ..self }
    }

    /// Where scripts are set.
    fn script(self) -> Setting<'m> {
        self.at(if self.level <= Level::Text { Level::Script } else { Level::Second })
    }

    /// Where numerators and denominators are set.
    fn fraction(self) -> Setting<'m> {
        match self.level {
            Level::Display => self.at(Level::Text),
            _ => self.script(),
        }
    }

    fn is_display(self) -> bool {
        self.level == Level::Display
    }

    fn axis(self) -> f32 {
        AXIS * self.em()
    }

    /// The thickness of a bar: never less than a point.
    fn bar(self) -> f32 {
        (BAR * self.em()).max(1.0)
    }

    /// A text by itself.
    fn text(self, text: &str, face: Face, size: f32) -> Drawing {
        let extent = self.measure.extent(text, face, size);
        let text = Text { text: text.to_owned(), face, size, at: [0.0, 0.0], extent };
        Drawing { extent, texts: vec![text], ..Drawing::default() }
    }
}

#[cfg(test)]
mod tests;
