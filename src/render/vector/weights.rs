//! The weights of lines and text on a medium. On paper they are those of the palette, in points. A picture with its
//! size in pixels is seen on a screen, where a line thinner than a pixel fades and a small text cannot be read.

/// The width in points of the thinnest line on paper, edges of crowded elements apart.
const THINNEST: f64 = 0.25;
/// Size of captions and letters on paper in points.
pub const LABEL: f64 = 7.0;
/// Size of notes and numbers on paper in points: the smallest that is legible in print.
pub const NOTE: f64 = 6.0;
/// The width of the thinnest line and the size of notes on a screen, in pixels.
const SCREEN_LINE: f64 = 1.0;
const SCREEN_NOTE: f64 = 12.0;

/// Factors on the widths and sizes of paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// The factor on widths of lines, dashes and dots.
    pub line: f64,
    /// The factor on sizes of text, and on the room around it.
    pub text: f64,
}

impl Weights {
    /// The weights on paper.
    pub const PAPER: Weights = Weights { line: 1.0, text: 1.0 };

    /// The weights of a picture of pixels of this many points, at least those on paper.
    pub fn of_pixels(pixel: f64) -> Weights {
        let line = f64::max(1.0, SCREEN_LINE * pixel / THINNEST);
        Weights { line, text: f64::max(1.0, SCREEN_NOTE * pixel / NOTE) }
    }

    /// Size of captions and letters in points.
    pub fn label(&self) -> f64 {
        LABEL * self.text
    }

    /// Size of notes and numbers in points.
    pub fn note(&self) -> f64 {
        NOTE * self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_a_screen_lines_have_a_pixel_and_notes_twelve_and_on_paper_nothing_is_less_than_usual() {
        let pixel = 0.75;
        let screen = Weights::of_pixels(pixel);
        assert_eq!((THINNEST * screen.line, screen.note(), screen.label()), (pixel, 12.0 * pixel, 14.0 * pixel));
        assert_eq!(Weights::of_pixels(0.1), Weights::PAPER);
    }
}
