//! The strip below a lesson: back and step, a sentence for the step at hand, and a bar for each lesson or question.

use eframe::egui::{self, Align, Label, Layout, Rect, Response, Role, Sense, Ui, UiBuilder, Vec2, WidgetInfo};

use crate::app::window::command::Command;
use crate::app::window::panels::{note, on_click};
use crate::app::window::session::Goal;
use crate::app::window::state::State;
use crate::app::window::study::{Study, StudyCommand, Subject};
use crate::app::window::theme::{self, ink};
use crate::app::window::{icons, words};
use crate::core::lesson::built_in::{self, LESSONS};
use crate::core::question::Verdict;
use crate::core::run::explain::plain;
use crate::render::palette::{Palette, Rgba};

/// The size of the sentence, and the room that buttons and the step take beside it.
const SENTENCE: f32 = 16.0;
const BESIDE: f32 = 170.0;
/// The height of the row of bars, and that of a bar.
const BARS: f32 = 26.0;
const BAR: f32 = 4.0;

/// Shows it.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let rect = ui.max_rect();
    ui.painter().hline(rect.x_range(), rect.top() + 0.5, (1.0, ink(palette.line)));
    let (row, bars) = rect.split_top_bottom_at_y(rect.bottom() - BARS);
    let row = row.shrink2(Vec2::new(16.0, 0.0));
    let at = |rect: Rect, layout: Layout| UiBuilder::new().max_rect(rect).layout(layout);
    ui.scope_builder(at(row, Layout::left_to_right(Align::Center)), |ui| buttons(ui, state, commands));
    ui.scope_builder(at(row, Layout::right_to_left(Align::Center)), |ui| step(ui, state, palette));
    sentence(ui, row.shrink2(Vec2::new(BESIDE, 2.0)), state, palette);
    if let Some(study) = state.study() {
        let room = bars.shrink2(Vec2::new((0.1 * bars.width()).min(156.0), 0.0));
        ui.scope_builder(UiBuilder::new().max_rect(room), |ui| show_bars(ui, room, state, study, commands, palette));
    }
    ui.advance_cursor_after_rect(rect);
}

fn buttons(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let Some(moment) = &state.run().moment else { return };
    let at_end = state.run().recorded && moment.step == state.run().track.len() as u64;
    let by = |by| if state.steps_by_operation() { Goal::Steps(by) } else { Goal::Quads(by) };
    for (text, goal, enabled, key) in [
        (format!("{} Back", icons::CARET_LEFT), by(-1), moment.step > 0, "Left"),
        (format!("Step {}", icons::CARET_RIGHT), by(1), !at_end, "Right"),
    ] {
        let name = if key == "Left" { "Back" } else { "Step" };
        let response = ui.add_enabled(enabled, egui::Button::new(text)).on_hover_text(key);
        response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
        on_click(&response, Command::Go(goal), commands);
    }
}

fn step(ui: &mut Ui, state: &State, palette: &Palette) {
    let Some(moment) = &state.run().moment else { return };
    let more = if state.run().recorded { "" } else { "\u{2026}" };
    let all = words::grouped(state.run().track.len() as u64);
    ui.label(note(format!("step {} / {all}{more}", words::grouped(moment.step)), palette));
}

/// What the step at hand did, in the middle.
fn sentence(ui: &mut Ui, rect: Rect, state: &State, palette: &Palette) {
    let Some(moment) = &state.run().moment else { return };
    let lay = |size: f32| {
        let mut job = theme::formula(&moment.narration, size, ink(palette.strong), ink(palette.strong));
        (job.wrap.max_width, job.wrap.max_rows, job.halign) = (rect.width(), 3, Align::Center);
        ui.painter().layout_job(job)
    };
    let usual = lay(SENTENCE);
    let galley = if usual.elided || usual.size().y > rect.height() { lay(theme::BODY) } else { usual };
    let response = ui.interact(rect, ui.scope_id().with("sentence"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Status, true, plain(&moment.narration)));
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_live(egui::accesskit::Live::Polite));
    let top = rect.center().y - 0.5 * galley.size().y;
    ui.painter().galley(egui::pos2(rect.center().x, top), galley.clone(), ink(palette.strong));
    if galley.elided {
        response.on_hover_text(plain(&moment.narration));
    }
}

/// A bar for each lesson of the tour, for each part of another lesson, or for each question of a series.
fn show_bars(ui: &mut Ui, rect: Rect, state: &State, study: &Study, commands: &mut Vec<Command>, palette: &Palette) {
    let learned = &state.workspace().learned;
    let bars: Vec<(String, Rgba, Option<StudyCommand>)> = match &study.subject {
        Subject::Lesson { lesson, .. } if study.tour_place().is_some() => LESSONS
            .iter()
            .map(|(name, _)| {
                let is_here = *name == lesson.name;
                let (said, colour) = match () {
                    () if is_here => (", open", palette.base),
                    () if learned.is_done(name) => (", done", palette.holds),
                    () => ("", palette.line),
                };
                let title = built_in::title(name).unwrap_or(name);
                (format!("{title}{said}"), colour, (!is_here).then_some(StudyCommand::Open(name)))
            })
            .collect(),
        Subject::Lesson { lesson, part, .. } => (0..lesson.parts.len())
            .map(|k| {
                let colour = if k == *part { palette.base } else { palette.line };
                (lesson.parts[k].heading.clone(), colour, (k != *part).then_some(StudyCommand::Part(k)))
            })
            .collect(),
        Subject::Prediction { drawn, at, .. } => drawn
            .iter()
            .enumerate()
            .map(|(k, question)| {
                let given = study.score.given().iter();
                let given = given.clone().find(|given| (given.step, given.kind) == (question.step, question.kind));
                let (said, colour) = match given.map(|given| given.verdict) {
                    Some(Verdict::Right) => (", right", palette.holds),
                    Some(Verdict::Partly) => (", right in part", palette.changed_edge),
                    Some(Verdict::Wrong) => (", wrong", palette.broken),
                    None if k == *at && !study.is_over => (", asked now", palette.base),
                    None => ("", palette.line),
                };
                (format!("Question {}{said}", k + 1), colour, None)
            })
            .collect(),
    };
    let gap = 6.0;
    let width = ((rect.width() - gap * (bars.len().max(1) - 1) as f32) / bars.len().max(1) as f32).max(1.0);
    for (k, (name, colour, command)) in bars.into_iter().enumerate() {
        let left = rect.left() + k as f32 * (width + gap);
        let place = Rect::from_min_size(egui::pos2(left, rect.top()), Vec2::new(width, rect.height()));
        let response = bar(ui, k, place, &name, colour, command.is_some());
        if let Some(command) = command {
            on_click(&response, Command::Study(command), commands);
        }
        response.on_hover_ui(|ui| {
            ui.add(Label::new(name).wrap());
        });
    }
}

fn bar(ui: &Ui, k: usize, rect: Rect, name: &str, colour: Rgba, leads: bool) -> Response {
    let sense = if leads { Sense::click() } else { Sense::hover() };
    let response = ui.interact(rect, ui.scope_id().with(("bar", k)), sense);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, leads, name));
    let height = if response.hovered() && leads { 2.0 * BAR } else { BAR };
    let line = Rect::from_center_size(rect.center() - Vec2::new(0.0, 2.0), Vec2::new(rect.width(), height));
    ui.painter().rect_filled(line, 2.0, ink(colour));
    response
}
