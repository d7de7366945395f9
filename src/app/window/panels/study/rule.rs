//! The rule at work: table 1 as drawings, what decided the last step, and how sure one is of each rule.

use eframe::egui::{Label, Rect, Role, Sense, Ui, Vec2, WidgetInfo};

use super::heading;
use crate::app::window::command::Command;
use crate::app::window::panels::{inspector, legend, note};
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::convert::{Event, EventKind};
use crate::core::question::Tally;
use crate::core::run::explain::plain;
use crate::render::palette::Palette;

/// The width of the bar of a rule, and the height of its row.
const BAR: f32 = 130.0;
const ROW: f32 = 24.0;

/// Shows it.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = state.run().moment.clone() else { return };
    let rect = words::degrees(moment.parameters.theta_rect);
    heading(ui, "Table 1", &format!("which segment comes next, \u{3b8}rect = {rect}\u{b0}"), palette);
    legend::table(ui, state, palette);
    let table = &moment.selecting.table;
    if let Some(face) = table.face().filter(|_| !table.rows.iter().all(|row| table.is_of_face(row))) {
        let text = format!("Faces are converted one after the other: only the front of face {} counts now.", face + 1);
        ui.add(Label::new(note(text, palette)).wrap());
    }
    decision(ui, state, &moment, commands, palette);
    let learned = state.workspace().learned.by_rule();
    if !learned.is_empty() {
        heading(ui, "Your rules", "what you miss", palette);
        learned.into_iter().for_each(|(rule, tally)| row(ui, rule.words(), tally, palette));
    }
}

/// What the step at hand looked at, and why it did what it did.
fn decision(ui: &mut Ui, state: &State, moment: &Moment, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(event) = &moment.event else { return };
    heading(ui, "The last step", section_of(event.kind()), palette);
    if inspector::candidates_of_base(ui, state, moment, commands, palette) {
        return;
    }
    let why = match event {
        Event::BaseSelected { .. } => moment.base.as_ref().map_or(&moment.about, |base| &base.why),
        _ => &moment.about,
    };
    for text in why {
        let text = theme::formula(text, theme::BODY, ink(palette.text), ink(palette.strong));
        ui.add(Label::new(text).wrap());
        ui.add_space(3.0);
    }
}

/// The section of the paper that a step belongs to.
fn section_of(kind: EventKind) -> &'static str {
    match kind {
        EventKind::BaseSelected | EventKind::Deferred => "4.3.3",
        EventKind::SideIsFront
        | EventKind::SideChosen
        | EventKind::SideSwapped
        | EventKind::SideDivided
        | EventKind::TopSwapped
        | EventKind::TopFound
        | EventKind::Formed
        | EventKind::RolledBack => "4.3.4",
        _ => "4.3.6",
    }
}

/// How sure one is of a rule.
fn row(ui: &mut Ui, name: &str, tally: Tally, palette: &Palette) {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(ui.available_width(), ROW), Sense::hover());
    let partly = if tally.partly > 0 { format!(", {} in part", tally.partly) } else { String::new() };
    let said = format!("{name}: {} of {} right{partly}", tally.right, tally.all());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, plain(&said)));
    let font = theme::regular(theme::BODY);
    ui.painter().text(rect.left_center(), eframe::egui::Align2::LEFT_CENTER, name, font, ink(palette.text));
    let width = BAR.min(0.4 * rect.width());
    let middle = rect.right_center() - Vec2::new(0.5 * width, 0.0);
    let rail = Rect::from_center_size(middle, Vec2::new(width, 6.0));
    ui.painter().rect_filled(rail, 2.0, ink(palette.line));
    let share = tally.share().unwrap_or(0.0) as f32;
    let done = rail.with_max_x(rail.left() + share * rail.width());
    let colour = if share < 0.6 { palette.base } else { palette.holds };
    ui.painter().rect_filled(done, 2.0, ink(colour));
    response.on_hover_text(said);
}
