//! Tables of the inspector: every column is as wide as its texts, and what does not fit beside them goes on the lines
//! below, so that nothing is cut however narrow the panel is.

use std::sync::Arc;

use eframe::egui::{Galley, Pos2, Rect, Response, Role, Sense, Ui, Vec2, WidgetInfo};

use crate::app::window::theme::{self, ink};
use crate::render::palette::{Palette, Rgba};

/// The least gap between columns in points, and the greatest.
const GAPS: [f32; 2] = [7.0, 20.0];
/// The height of a line.
const LINE: f32 = 20.0;
/// How far texts below a row are set in.
const INDENT: f32 = 12.0;

/// A row: its texts, their colour, and what lies behind them.
pub struct TableRow {
    pub texts: Vec<String>,
    pub colour: Rgba,
    pub ground: Option<Rgba>,
}

/// What the last column holds.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Last {
    /// Numbers, aligned to the right as in the other columns.
    Numbers,
    /// Words, which may be long.
    Words,
}

/// Shows a table; returns what each row says of the pointer.
pub fn table(ui: &mut Ui, head: &[&str], rows: &[TableRow], last: Last, palette: &Palette) -> Vec<Response> {
    let font = theme::regular(theme::TABLE);
    let lay =
        |ui: &Ui, text: &str, colour: Rgba| ui.painter().layout_no_wrap(text.to_owned(), font.clone(), ink(colour));
    let columns = head.len();
    let mut widths: Vec<f32> = head.iter().map(|text| lay(ui, text, palette.weak).size().x).collect();
    let cells: Vec<Vec<Arc<Galley>>> =
        rows.iter().map(|row| row.texts.iter().map(|text| lay(ui, text, row.colour)).collect()).collect();
    let fixed = columns - usize::from(last == Last::Words);
    for row in &cells {
        for (width, cell) in widths.iter_mut().zip(row).take(fixed) {
            *width = width.max(cell.size().x);
        }
    }
    let all = ui.available_width();
    // As many columns as there is room for.
    let wide = |count: usize| widths[..count].iter().sum::<f32>() + GAPS[0] * (count.max(1) - 1) as f32;
    let beside = (1..=fixed).rev().find(|&count| wide(count) <= all).unwrap_or(1);
    let spare = if last == Last::Numbers { all - wide(beside) } else { 0.0 };
    let gap = (GAPS[0] + spare / (beside.max(2) - 1) as f32).clamp(GAPS[0], GAPS[1]);
    // The first column is aligned to the left, numbers to the right.
    let mut ends = Vec::new();
    let mut x = 0.0;
    for width in &widths[..beside] {
        x += width;
        ends.push(x);
        x += gap;
    }
    let place = |rect: Rect, k: usize, galley: &Galley| match (k, ends.get(k)) {
        (0, _) => rect.left(),
        (_, Some(end)) => rect.left() + end - galley.size().x,
        _ => rect.left() + x,
    };
    let draw = |ui: &Ui, rect: Rect, k: usize, galley: Arc<Galley>| {
        let at = Pos2::new(place(rect, k, &galley), rect.top() + 0.5 * (LINE - galley.size().y));
        ui.painter().galley(at, galley, ink(palette.text));
    };
    let (top, _) = ui.allocate_exact_size(Vec2::new(all, LINE), Sense::hover());
    for (k, text) in head.iter().enumerate() {
        let galley = lay(ui, text, palette.weak);
        if k < beside || (k == fixed && x + galley.size().x <= all) {
            draw(ui, top, k, galley);
        }
    }
    let mut responses = Vec::new();
    for (row, cells) in rows.iter().zip(cells) {
        let is_short =
            last == Last::Words && beside == fixed && cells.get(fixed).is_none_or(|cell| x + cell.size().x <= all);
        let shown = if is_short { columns } else { beside };
        let named = (shown..columns).map(|k| match last {
            Last::Words if k == fixed => row.texts[k].clone(),
            _ => format!("{} {}", head[k], row.texts[k]),
        });
        let rest = named.collect::<Vec<_>>().join("   ");
        let below = (!rest.is_empty())
            .then(|| ui.painter().layout(rest, font.clone(), ink(row.colour), (all - INDENT).max(1.0)));
        let height = LINE + below.as_ref().map_or(0.0, |below| below.size().y + 3.0);
        let (rect, response) = ui.allocate_exact_size(Vec2::new(all, height), Sense::click());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, row.texts.join("  ")));
        if let Some(ground) = row.ground {
            ui.painter().rect_filled(rect.expand2(Vec2::new(4.0, 0.0)), 0.0, ink(ground));
        }
        for (k, galley) in cells.into_iter().take(shown).enumerate() {
            draw(ui, rect, k, galley);
        }
        if let Some(below) = below {
            ui.painter().galley(rect.left_top() + Vec2::new(INDENT, LINE - 2.0), below, ink(row.colour));
        }
        responses.push(response);
    }
    responses
}
