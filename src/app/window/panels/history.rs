//! The changes of the user, and the transcript: what the steps around the current one did, a sentence each.

use eframe::egui::{Align, Response, Role, ScrollArea, Sense, Ui, Vec2, WidgetInfo};

use super::{heading, inset, note, on_click, part};
use crate::app::window::command::Command;
use crate::app::window::session::Goal;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::convert::EventKind;
use crate::core::run::EditKind;
use crate::core::run::explain::plain;
use crate::render::palette::Palette;

/// The transcript is told in pages of this many steps: that of the step which is looked at, and those beside it.
const PAGE: u64 = 40;
/// The width of the numbers of the steps, and the room between two sentences.
const NUMBERS: f32 = 52.0;
const GAP: f32 = 5.0;

/// What the panel keeps for itself.
#[derive(Default)]
pub struct HistoryState {
    /// The run and the step that it showed last.
    shown: (u64, u64),
    /// The step whose surroundings are told: the current one, until the user looks elsewhere.
    about: u64,
    /// Whether the current step is still to be brought into view: sentences that come move it.
    seeks: bool,
}

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, local: &mut HistoryState, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = &state.run().moment else { return };
    let now = (state.run().number, moment.step);
    if local.shown != now {
        *local = HistoryState { shown: now, about: moment.step, seeks: true };
    }
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        inset().show(ui, |ui| {
            changes(ui, state, commands, palette);
            heading(ui, "Transcript", "a sentence for each step", palette);
            transcript(ui, state, local, commands, palette);
        });
    });
}

/// What the user has changed.
fn changes(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    heading(ui, "Changes of this run", "", palette);
    if state.document().edits.is_empty() {
        ui.label(note("None: the run has the parameters of the case.", palette));
    }
    for edit in &state.document().edits {
        let what = match &edit.kind {
            EditKind::Parameter { key, value } => format!("{key} = {value}"),
            EditKind::Base { a, b } => format!("base {}", words::segment([*a, *b])),
        };
        let button = ui.button(format!("from step {}: {what}", words::grouped(edit.step)));
        on_click(&button, Command::Go(Goal::Step(edit.step)), commands);
    }
}

/// The steps of the pages around one, the earliest first; the current one is brought into view when the run has moved.
fn transcript(ui: &mut Ui, state: &State, local: &mut HistoryState, commands: &mut Vec<Command>, palette: &Palette) {
    let run = state.run();
    let known = run.track.len() as u64;
    if known == 0 {
        ui.label(note("No step is recorded yet.", palette));
        return;
    }
    let page = local.about.max(1).min(known).div_ceil(PAGE) - 1;
    let (from, until) = (page.saturating_sub(1) * PAGE + 1, ((page + 2) * PAGE).min(known));
    // While work is under way the question waits.
    if !run.has_asked_for_transcript(from, until) && !run.is_busy() {
        commands.push(Command::TellTranscript(from, until));
    }
    let (now, seeks) = (local.shown.1, local.seeks);
    let mut seek = |ui: &mut Ui, text: &str, about: u64| {
        part(ui, text, |ui| {
            if ui.button(text).clicked() {
                local.about = about;
            }
        });
    };
    if from > 1 {
        seek(ui, "Earlier steps", from - 1);
    }
    for step in from..=until {
        let Some(tracked) = run.track.get(step as usize - 1) else { break };
        let text = run.sentence(step).map_or_else(|| words::kind(tracked.kind).to_owned(), str::to_owned);
        let response = row(ui, step, &text, tracked.kind, now, palette);
        if step == now && seeks {
            response.scroll_to_me(Some(Align::Center));
            local.seeks = run.sentence(step).is_none();
        }
        on_click(&response, Command::Go(Goal::Step(step)), commands);
    }
    if until < known {
        seek(ui, "Later steps", until + 1);
    }
}

/// A step: its number, and what it did.
fn row(ui: &mut Ui, step: u64, text: &str, kind: EventKind, now: u64, palette: &Palette) -> Response {
    let colour = match kind {
        _ if step > now => palette.hint,
        EventKind::RolledBack => palette.broken,
        _ => palette.text,
    };
    let number = ui.painter().layout_no_wrap(words::grouped(step), theme::regular(theme::TABLE), ink(palette.weak));
    let mut job = theme::formula(text, theme::TABLE, ink(colour), ink(palette.strong));
    job.wrap.max_width = (ui.available_width() - NUMBERS).max(1.0);
    let told = ui.painter().layout_job(job);
    let size = Vec2::new(ui.available_width(), told.size().y + GAP);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| {
        WidgetInfo::selected(Role::Button, true, step == now, format!("Step {}: {}", words::grouped(step), plain(text)))
    });
    if ui.is_rect_visible(rect) {
        let ground = if step == now { Some(palette.accent_row) } else { response.hovered().then_some(palette.stripe) };
        if let Some(ground) = ground {
            ui.painter().rect_filled(rect.expand2(Vec2::new(6.0, 0.0)), 2.0, ink(ground));
        }
        let at = rect.min + Vec2::new(0.0, 0.5 * GAP);
        ui.painter().galley(at + Vec2::new(NUMBERS - 10.0 - number.size().x, 0.0), number, ink(palette.weak));
        ui.painter().galley(at + Vec2::new(NUMBERS, 0.0), told, ink(colour));
    }
    response
}
