//! The caption of a picture: a text in rows below it.

use glam::DVec2;

use crate::render::vector::page::{Anchor, Page, width};

/// The distance of the rows, and the room above and below all of them, in font sizes.
pub(super) const ROW: f64 = 1.3;
const AROUND: f64 = 0.5;
/// The share of the width of the page that a row takes at most. Widths of texts are estimates.
pub(super) const SHARE: f64 = 0.96;

/// A caption, broken into rows as wide as the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Caption<'a> {
    /// The text.
    pub text: &'a str,
    /// The font size in points.
    pub size: f64,
    /// The rows that it has at least, so that pictures with captions of different lengths are alike.
    pub rows: usize,
}

impl<'a> Caption<'a> {
    /// Its text in the rows that it takes on a page of some width: whole words, where a word is not wider than the
    /// page.
    pub fn wrapped(&self, page: f64) -> Vec<&'a str> {
        let room = SHARE * page;
        let fits = |text: &str| width(text, self.size) <= room;
        let (mut rows, mut left) = (Vec::new(), self.text.trim());
        while !left.is_empty() {
            let ends = left.char_indices().map(|(at, c)| at + c.len_utf8());
            // At least one character, or there would be no end.
            let most = ends.enumerate().take_while(|&(k, end)| k == 0 || fits(&left[..end])).map(|(_, end)| end).last();
            let most = most.unwrap_or(left.len());
            let is_whole = most == left.len() || left[most..].starts_with(' ');
            let row = if is_whole { most } else { left[..most].rfind(' ').filter(|at| *at > 0).unwrap_or(most) };
            rows.push(left[..row].trim_end());
            left = left[row..].trim_start();
        }
        rows
    }

    /// Its height on a page of some width.
    pub fn height(&self, page: f64) -> f64 {
        let rows = self.wrapped(page).len().max(self.rows);
        (rows as f64 * ROW + AROUND) * self.size
    }

    /// Writes it below `top`.
    pub(super) fn write(&self, page: &mut Page, page_width: f64, top: f64) {
        let left = 0.5 * (1.0 - SHARE) * page_width;
        for (k, row) in self.wrapped(page_width).into_iter().enumerate() {
            let baseline = top + (k as f64 * ROW + 0.5 * AROUND + 1.0) * self.size;
            page.text(DVec2::new(left, baseline), self.size, Anchor::Start, row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_caption_is_broken_between_words_and_nothing_of_it_is_lost() {
        let text = "Segment 12 → 7 is the next base: class 1, since both frontal angles are below θrect.";
        for page in [40.0, 60.0, 90.0, 200.0, 1000.0] {
            let rows = Caption { text, size: 7.0, rows: 0 }.wrapped(page);
            assert_eq!(rows.join(" "), text, "{page}");
            assert!(rows.iter().all(|row| width(row, 7.0) <= page), "{rows:?}");
        }
        let one = |rows| Caption { text: "a", size: 10.0, rows };
        assert_eq!((one(0).height(90.0), one(3).height(90.0)), (18.0, 44.0));
    }

    #[test]
    fn a_word_wider_than_the_page_is_broken_and_an_empty_caption_has_no_rows() {
        let rows = Caption { text: "abcdefgh ij", size: 10.0, rows: 0 }.wrapped(20.0);
        assert_eq!(rows.concat(), "abcdefghij");
        assert!(rows.len() > 3, "{rows:?}");
        assert!(Caption { text: " ", size: 10.0, rows: 0 }.wrapped(20.0).is_empty());
        assert_eq!(Caption { text: "ab", size: 10.0, rows: 0 }.wrapped(0.1), ["a", "b"]);
    }
}
