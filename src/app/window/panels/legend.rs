//! The legend of the view's lines, in the bar above it. The classes of front segments are table 1 in small drawings;
//! the row by which the base was selected is lit.

use eframe::egui::epaint::PathShape;
use eframe::egui::{Align2, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo};

use super::{icon_button, line, note};
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::core::case::Selection;
use crate::render::palette::{Palette, Rgba};
use crate::render::scene::FRONT;

/// The size of a drawing of table 1 in the bar, and in the table itself.
const SMALL: Vec2 = Vec2::new(20.0, 14.0);
const LARGE: Vec2 = Vec2::new(44.0, 26.0);

/// The width of the menu of layers.
const LAYERS: f32 = 250.0;
/// The space between entries in points.
const SPACING: f32 = 2.0;

/// The rows of table 1: which frontal angles of the base are below theta_rect, at A and at B.
const ROWS: [([bool; 2], &str); 4] = [
    ([true, true], "\u{3b8}_{A} and \u{3b8}_{B} below \u{3b8}_{rect}"),
    ([true, false], "\u{3b8}_{A} below \u{3b8}_{rect}, \u{3b8}_{B} not"),
    ([false, true], "\u{3b8}_{B} below \u{3b8}_{rect}, \u{3b8}_{A} not"),
    ([false, false], "neither; or the smallest H, if nothing else is within c\u{b7}H_{min}"),
];

/// An entry of the legend.
#[derive(Clone, Copy)]
enum Entry {
    Line(Rgba, f32, &'static str),
    Class(u8),
}

/// Shows the legend, from the right: buttons first; `kept` points are left free for the tabs.
pub fn show(ui: &mut Ui, kept: f32, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    ui.spacing_mut().item_spacing.x = SPACING;
    ui.spacing_mut().button_padding.x = 4.0;
    for (icon, command) in [(icons::CORNERS_OUT, Command::Fit), (icons::CROSSHAIR, Command::ShowDecision)] {
        icon_button(ui, icon, theme::ICON, command, state.run().moment.is_some(), commands);
    }
    layers(ui, state, commands, palette);
    ui.add_space(4.0);
    // In the order in which they are shown; what comes first gets room first.
    let entries = [
        (1, Entry::Line(palette.base, 5.0, "base")),
        (2, Entry::Line(palette.side, 3.2, "sides, top")),
        (0, Entry::Class(1)),
        (0, Entry::Class(2)),
        (0, Entry::Class(3)),
        (0, Entry::Class(4)),
        (3, Entry::Line(palette.changed_edge, 2.5, "last change")),
    ];
    let font = theme::regular(theme::HEAD);
    let width = |entry: Entry| match entry {
        Entry::Line(_, _, text) => {
            ui.painter().layout_no_wrap(text.to_owned(), font.clone(), ink(palette.weak)).size().x + 28.0
        }
        Entry::Class(_) => SMALL.x + 11.0,
    };
    let widths = entries.map(|entry| width(entry.1));
    let mut room = ui.available_width() - kept;
    let mut shown = [false; 7];
    for wanted in 0..4 {
        for k in (0..entries.len()).filter(|k| entries[*k].0 == wanted) {
            room -= widths[k] + SPACING;
            shown[k] = room >= 0.0;
        }
    }
    let lit = applied(state);
    for k in (0..entries.len()).rev().filter(|k| shown[*k]) {
        let (rect, response) = ui.allocate_exact_size(Vec2::new(widths[k], ui.available_height()), Sense::hover());
        match entries[k].1 {
            Entry::Line(colour, width, text) => {
                let text = ui.painter().layout_no_wrap(text.to_owned(), font.clone(), ink(palette.weak));
                let swatch = Rect::from_center_size(rect.left_center() + Vec2::new(9.0, 0.0), Vec2::new(14.0, width));
                ui.painter().rect_filled(swatch, 0.5 * width, ink(colour));
                let at = Align2::LEFT_CENTER.anchor_size(rect.left_center() + Vec2::new(20.0, 0.0), text.size()).min;
                ui.painter().galley(at, text, ink(palette.weak));
            }
            Entry::Class(class) => {
                let is_lit = lit == Some(class);
                let said = if is_lit { ": selected the base" } else { "" };
                response
                    .widget_info(|| WidgetInfo::labeled(Role::Label, true, format!("Row {class} of table 1{said}")));
                if is_lit {
                    ui.painter().rect_filled(rect.shrink2(Vec2::new(0.0, 3.0)), 3.0, ink(palette.accent_row));
                }
                let colour = ink(if is_lit { palette.accent } else { palette.weak });
                let left = rect.left_center() + Vec2::new(3.0, 0.0);
                ui.painter().text(left, Align2::LEFT_CENTER, class, font.clone(), colour);
                let at = Rect::from_center_size(rect.right_center() - Vec2::new(0.5 * SMALL.x, 0.0), SMALL);
                draw(ui, at.shrink(1.5), class, palette);
                response.on_hover_ui(|ui| table(ui, state, palette));
            }
        }
    }
}

/// The row of table 1 by which the base under way was selected; none if it was selected in another way.
fn applied(state: &State) -> Option<u8> {
    let selecting = &state.run().moment.as_ref()?.selecting;
    let base = selecting.base.filter(|base| !base.picked)?;
    let table = &selecting.table;
    let row = table.rows.iter().find(|row| [row.a, row.b] == [base.a, base.b])?;
    (table.parameters().selection == Selection::Table1).then(|| if table.is_within_reach(row) { row.class } else { 4 })
}

/// Table 1: the classes of front segments in the order in which bases are selected from them.
pub fn table(ui: &mut Ui, state: &State, palette: &Palette) {
    let lit = applied(state);
    ui.spacing_mut().item_spacing.y = 3.0;
    for (class, (_, text)) in (1..).zip(ROWS) {
        let is_lit = lit == Some(class);
        let ground = if is_lit { palette.accent_row } else { Rgba::default() };
        let frame = eframe::egui::Frame::NONE.fill(ink(ground)).corner_radius(3.0).inner_margin(3);
        frame.show(ui, |ui| {
            ui.horizontal(|ui| {
                let colour = if is_lit { palette.accent } else { palette.text };
                ui.label(line(class.to_string(), colour));
                let (rect, _) = ui.allocate_exact_size(LARGE, Sense::hover());
                draw(ui, rect.shrink(3.0), class, palette);
                let text = theme::formula(text, theme::TABLE, ink(colour), ink(palette.strong));
                ui.add(eframe::egui::Label::new(text).wrap());
            });
        });
    }
    let selecting = state.run().moment.as_ref().map(|moment| &moment.selecting);
    let rule = selecting.map_or(Selection::Table1, |selecting| selecting.table.parameters().selection);
    let is_picked = selecting.and_then(|selecting| selecting.base).is_some_and(|base| base.picked);
    let said = match lit {
        Some(class) => format!("Row {class} selected the base."),
        None if is_picked => "You chose the base, whatever its row.".to_owned(),
        None if rule != Selection::Table1 => {
            format!("This run does not select by table 1, but by selection = {}.", rule.word())
        }
        None => "The row that selects a base is lit while its quadrilateral is made.".to_owned(),
    };
    ui.add(eframe::egui::Label::new(note(said, palette)).wrap());
}

/// A front segment with its two neighbours, the live side up; a frontal angle below theta_rect is filled.
fn draw(ui: &Ui, rect: Rect, class: u8, palette: &Palette) {
    let k = usize::from(class.clamp(1, 4)) - 1;
    let is_below = ROWS[k].0;
    let base = [rect.left() + 0.28 * rect.width(), rect.right() - 0.28 * rect.width()];
    let y = rect.bottom() - 1.0;
    let thin = Stroke::new(1.2, ink(palette.weak));
    for ((x, out), is_below) in base.into_iter().zip([-1.0, 1.0]).zip(is_below) {
        let corner = Pos2::new(x, y);
        let far = if is_below {
            Pos2::new(x + 0.1 * out * rect.width(), rect.top())
        } else {
            Pos2::new(if out < 0.0 { rect.left() } else { rect.right() }, y)
        };
        if is_below {
            let radius = 0.55 * rect.height();
            let end = libm::atan2(f64::from(y - far.y), f64::from(far.x - x));
            let begin = if out < 0.0 { 0.0 } else { std::f64::consts::PI };
            let arc = (0..=8).map(|step| {
                let angle = begin + (end - begin) * f64::from(step) / 8.0;
                corner + radius * Vec2::new(libm::cos(angle) as f32, -libm::sin(angle) as f32)
            });
            let wedge: Vec<Pos2> = std::iter::once(corner).chain(arc).collect();
            ui.painter().add(Shape::Path(PathShape::convex_polygon(
                wedge,
                ink(palette.label.faded(0.8)),
                Stroke::NONE,
            )));
        }
        ui.painter().line_segment([corner, far], thin);
    }
    let stroke = Stroke::new(FRONT[k], ink(palette.front[k]));
    ui.painter().line_segment([Pos2::new(base[0], y), Pos2::new(base[1], y)], stroke);
}

fn layers(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let button = eframe::egui::RichText::new(icons::STACK).font(theme::regular(theme::ICON));
    let shown = ui.menu_button(button, |ui| {
        ui.set_width(LAYERS);
        super::layers::list(ui, state, commands, palette);
    });
    let response = shown.response.on_hover_text("Layers and colours");
    response.widget_info(|| eframe::egui::WidgetInfo::labeled(eframe::egui::Role::Button, true, "Layers and colours"));
}
