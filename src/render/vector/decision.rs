//! A decision as a figure: what a step did, by which rule, and the table of what it chose from.

use glam::DVec2;

use super::page::{Anchor, Coat, Page, Path, Stroke, width};
use super::sheet::{Caption, Sheet};
use crate::core::run::explain::Table;
use crate::render::palette::{figure, letter, note};
use crate::render::picture::Role;

/// The height of a row and the gap before a part, in font sizes.
const ROW: f64 = 1.45;
const PART: f64 = 0.7;
/// The margin beside the table, and the least gap between its columns, in font sizes.
const MARGIN: f64 = 0.5;
const GAP: f64 = 1.2;

/// A decision in words and numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// Which step it is.
    pub heading: String,
    /// What it did and why, each in a sentence.
    pub sentences: Vec<String>,
    /// What it chose from.
    pub table: Option<Table>,
}

/// Draws a decision. The page is as high as it takes, unless it has a height.
pub fn draw(decision: &Decision, sheet: &Sheet<'_>) -> Page {
    let (size, label) = (sheet.weights.note(), sheet.weights.label());
    let rows = |text: &str| wrapped(text, size, sheet.width).len() as f64;
    let told: f64 = decision.sentences.iter().map(|text| rows(text)).sum();
    let mut height = ROW * label + (ROW * told + PART) * size;
    let layout = decision.table.as_ref().map(|table| Layout::of(table, size, sheet.width));
    if let (Some(table), Some(layout)) = (&decision.table, &layout) {
        height += PART * size + ROW * label + ROW * size * layout.rows(table) + 0.3 * size;
    }
    let mut page = Page::new(sheet, height);
    let ink = sheet.look.ink;
    let mut y = label;
    page.text(DVec2::new(MARGIN * size, y), label, Anchor::Start, &decision.heading);
    y += PART * size;
    for (k, sentence) in decision.sentences.iter().enumerate() {
        let colour = if k == 0 { letter(ink) } else { note(ink) };
        for row in wrapped(sentence, size, sheet.width) {
            y += ROW * size;
            page.text_in(DVec2::new(MARGIN * size, y), size, Anchor::Start, colour, row);
        }
    }
    if let (Some(table), Some(layout)) = (&decision.table, &layout) {
        y += PART * size + ROW * label;
        page.text(DVec2::new(MARGIN * size, y), label, Anchor::Start, &table.title);
        page.text_in(DVec2::new(sheet.width - MARGIN * size, y), size, Anchor::End, note(ink), &table.counts);
        layout.draw(&mut page, table, sheet, y);
    }
    page
}

fn wrapped(text: &str, size: f64, page: f64) -> Vec<&str> {
    Caption { text, size, rows: 0 }.wrapped(page - MARGIN * size)
}

/// The columns of a table: numbers end at a place, words begin at one.
struct Layout {
    size: f64,
    /// Where each column of numbers ends.
    ends: Vec<f64>,
    /// Where words begin, and the room for them.
    words: Option<[f64; 2]>,
}

impl Layout {
    fn of(table: &Table, size: f64, page: f64) -> Layout {
        let numbers = table.head.len() - usize::from(table.ends_in_words);
        let widest = |k: usize| {
            let texts = table.entries.iter().filter_map(|entry| entry.texts.get(k)).chain(table.head.get(k));
            texts.map(|text| width(text, size)).fold(0.0, f64::max)
        };
        let widths: Vec<f64> = (0..numbers).map(widest).collect();
        let room = page - 2.0 * MARGIN * size;
        // What is left is shared among the gaps, unless words take it.
        let free = (room - widths.iter().sum::<f64>()) / (numbers.max(2) - 1) as f64;
        let gap = if table.ends_in_words { GAP * size } else { free.clamp(0.4 * size, 4.0 * GAP * size) };
        let mut x = MARGIN * size;
        let mut ends = Vec::new();
        for width in widths {
            x += width;
            ends.push(x);
            x += gap;
        }
        let words = table.ends_in_words.then_some([x, (page - MARGIN * size - x).max(8.0 * size)]);
        Layout { size, ends, words }
    }

    /// The rows of words of an entry, at least one.
    fn words<'t>(&self, texts: &'t [String]) -> Vec<&'t str> {
        let text = texts.get(self.ends.len()).map_or("", String::as_str);
        self.words.map_or_else(Vec::new, |[_, room]| Caption { text, size: self.size, rows: 0 }.wrapped(room))
    }

    /// The rows of the whole table.
    fn rows(&self, table: &Table) -> f64 {
        let of = |texts: &[String]| self.words(texts).len().max(1) as f64;
        1.0 + table.entries.iter().map(|entry| of(&entry.texts)).sum::<f64>()
    }

    fn draw(&self, page: &mut Page, table: &Table, sheet: &Sheet<'_>, top: f64) {
        let (size, ink) = (self.size, sheet.look.ink);
        let mut y = top + ROW * size;
        let row = |page: &mut Page, y: f64, texts: &[String], colour| {
            for (k, (text, end)) in texts.iter().zip(&self.ends).enumerate() {
                // The first column begins at the margin.
                let (x, anchor) = if k == 0 { (MARGIN * size, Anchor::Start) } else { (*end, Anchor::End) };
                page.text_in(DVec2::new(x, y), size, anchor, colour, text);
            }
            let words = self.words(texts);
            for (k, text) in words.iter().enumerate() {
                let at = DVec2::new(self.words.map_or(0.0, |[x, _]| x), y + ROW * size * k as f64);
                page.text_in(at, size, Anchor::Start, colour, text);
            }
            words.len().max(1) as f64 * ROW * size
        };
        row(page, y, &table.head, note(ink));
        let mut line = Path::default();
        let below = y + 0.4 * size;
        line.walk([DVec2::new(0.0, below), DVec2::new(sheet.width, below)].into_iter(), false);
        page.path(line, Coat::line(Stroke::of(note(ink), 0.35 * sheet.weights.line)));
        y += ROW * size;
        for entry in &table.entries {
            let height = self.words(&entry.texts).len().max(1) as f64 * ROW * size;
            if let Some(ground) = figure(Role::DeadQuad, ink).fill.filter(|_| entry.is_chosen) {
                let low = y - 1.02 * size;
                page.bar([DVec2::new(0.0, low), DVec2::new(sheet.width, low + height)], Coat::area(ground));
            }
            y += row(page, y, &entry.texts, letter(ink));
        }
    }
}
