//! The transport: a row of buttons with the status line, and the timeline below it.

use eframe::egui::{self, Align, ComboBox, Layout, Rect, RichText, Ui, Vec2};

use super::{icon_button, in_lines, on_click, timeline};
use crate::app::window::command::{Command, KINDS};
use crate::app::window::icons;
use crate::app::window::layout::Pane;
use crate::app::window::measure::Times;
use crate::app::window::session::{Direction, Goal, Verdict};
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::run::explain::plain;
use crate::render::palette::Palette;

/// The speeds to choose from, in quadrilaterals a second.
const SPEEDS: [f32; 7] = [1.0, 2.0, 4.0, 8.0, 16.0, 30.0, 60.0];

/// The height of the row of buttons.
const TRANSPORT: f32 = 36.0;
/// The room at the sides of the sentence of a step, and the height of a line of it.
const SIDE: f32 = 14.0;
const LINE: f32 = 17.0;
/// The width of nearly all sentences.
const LONGEST: f32 = 1240.0;

/// What the panel keeps for itself.
#[derive(Default)]
pub struct TimeState {
    timeline: timeline::TimelineState,
    /// How long frames take.
    pub times: Times,
}

/// Shows both; `window` is the first run.
pub fn show(ui: &mut Ui, window: &State, local: &mut TimeState, commands: &mut Vec<Command>, palette: &Palette) {
    let state = window.active();
    let rect = ui.max_rect();
    let row = Rect::from_min_size(rect.min, Vec2::new(rect.width(), TRANSPORT));
    let told = Rect::from_min_size(row.left_bottom(), Vec2::new(rect.width(), narration_height(rect.width())));
    ui.scope_builder(egui::UiBuilder::new().max_rect(row.shrink2(Vec2::new(8.0, 0.0))), |ui| {
        ui.horizontal_centered(|ui| transport(ui, state, &local.times, commands, palette));
    });
    ui.scope_builder(egui::UiBuilder::new().max_rect(told.shrink2(Vec2::new(SIDE, 0.0))), |ui| {
        narration(ui, state, commands, palette);
    });
    ui.painter().hline(rect.x_range(), told.bottom(), (1.0, ink(palette.line)));
    progress(ui, row, state, palette);
    let below = Rect::from_min_max(told.left_bottom(), rect.max);
    ui.scope_builder(egui::UiBuilder::new().max_rect(below), |ui| {
        timeline::show(ui, window, &mut local.timeline, commands, palette);
    });
    ui.advance_cursor_after_rect(rect);
}

fn transport(ui: &mut Ui, state: &State, times: &Times, commands: &mut Vec<Command>, palette: &Palette) {
    let open = state.run().moment.is_some();
    ui.spacing_mut().item_spacing.x = 3.0;
    let step = state.run().moment.as_ref().map_or(0, |moment| moment.step);
    let at_end = state.run().recorded && step == state.run().track.len() as u64;
    let (back, on) = (open && step > 0, open && !at_end);
    let play = if state.run().playing.is_some() { icons::PAUSE } else { icons::PLAY };
    for (icon, command, enabled) in [
        (icons::SKIP_BACK, Command::Go(Goal::Step(0)), back),
        (icons::CARET_DOUBLE_LEFT, Command::Go(Goal::Quads(-1)), back),
        (icons::CARET_LEFT, Command::Go(Goal::Steps(-1)), back),
        (play, Command::Play, on),
        (icons::CARET_RIGHT, Command::Go(Goal::Steps(1)), on),
        (icons::CARET_DOUBLE_RIGHT, Command::Go(Goal::Quads(1)), on),
        (icons::SKIP_FORWARD, Command::Go(Goal::End), on),
    ] {
        icon_button(ui, icon, theme::TRANSPORT_ICON, command, enabled, commands);
    }
    rule(ui, palette);
    for (icon, direction, enabled) in
        [(icons::ARROW_LINE_LEFT, Direction::Back, back), (icons::ARROW_LINE_RIGHT, Direction::Forward, on)]
    {
        icon_button(ui, icon, theme::TRANSPORT_ICON, Command::ToBreakpoint(direction), enabled, commands);
    }
    let roomy = ui.available_width() > 900.0;
    if roomy {
        ui.label(RichText::new("breakpoint").font(theme::regular(theme::TABLE)).color(ink(palette.weak)));
    }
    rule(ui, palette);
    if ui.available_width() > 330.0 {
        speed(ui, state, commands);
    }
    if ui.available_width() > 620.0 {
        kinds(ui, commands, open);
    }
    ui.add_space(10.0);
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        icon_button(ui, icons::LIST, theme::TRANSPORT_ICON, Command::Messages, true, commands);
        icon_button(ui, icons::BOOKMARK, theme::TRANSPORT_ICON, Command::Bookmark, open, commands);
        if state.run().is_busy() && state.run().since.is_some_and(|since| since.elapsed().as_millis() > 150) {
            on_click(&ui.button("Stop"), Command::Stop, commands);
        } else {
            verdict(ui, state, times, palette);
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| status(ui, state, palette));
    });
}

fn rule(ui: &mut Ui, palette: &Palette) {
    ui.add_space(5.0);
    let (rect, _) = ui.allocate_exact_size(Vec2::new(1.0, 20.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 0.0, ink(palette.line));
    ui.add_space(5.0);
}

fn speed(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let text = |speed: f32| format!("{speed} quads/s");
    let combo = ComboBox::from_id_salt("speed").selected_text(text(state.workspace().speed)).width(92.0);
    let shown = combo.show_ui(ui, |ui| {
        for speed in SPEEDS {
            let label = ui.selectable_label(state.workspace().speed == speed, text(speed));
            on_click(&label, Command::Speed(speed), commands);
        }
    });
    shown.response.on_hover_text("How fast to play");
}

fn kinds(ui: &mut Ui, commands: &mut Vec<Command>, open: bool) {
    ui.add_enabled_ui(open, |ui| {
        let shown = ui.menu_button("go to…", |ui| {
            if ui.button(Command::GoTo.name()).clicked() {
                commands.push(Command::GoTo);
                ui.close();
            }
            ui.separator();
            for kind in KINDS {
                ui.horizontal(|ui| {
                    for (icon, direction) in
                        [(icons::CARET_LEFT, Direction::Back), (icons::CARET_RIGHT, Direction::Forward)]
                    {
                        icon_button(ui, icon, theme::ICON, Command::Go(Goal::Kind(kind, direction)), true, commands);
                    }
                    ui.label(words::kind(kind));
                });
            }
        });
        shown.response.on_hover_text("A step, a number of quadrilaterals, or the next event of a kind");
    });
}

fn verdict(ui: &mut Ui, state: &State, times: &Times, palette: &Palette) {
    let Some(moment) = &state.run().moment else { return };
    let (icon, text, colour) = match &state.run().verdict {
        Verdict::Holds | Verdict::Looking => (icons::CHECK_CIRCLE, "invariants hold".to_owned(), palette.holds),
        Verdict::Broken(what) => (icons::X_CIRCLE, what.clone(), palette.broken),
    };
    let text = if ui.available_width() > 300.0 { format!("{icon} {text}") } else { icon.to_owned() };
    let text = RichText::new(text).font(theme::regular(theme::TABLE)).color(ink(colour));
    ui.label(text).on_hover_text(
        "The mesh is sound: twins agree, every element is positive, and every loop of the front is even",
    );
    if state.view().times {
        ui.label(super::note(times.told(moment.took), palette)).on_hover_text(
            "From the request for a state to its arrival, and from one frame to the next while something moves",
        );
    }
}

fn status(ui: &mut Ui, state: &State, palette: &Palette) {
    if state.run().is_busy() && state.run().since.is_some_and(|since| since.elapsed().as_millis() > 150) {
        let text = match &state.run().progress {
            Some(progress) => words::progress(progress),
            None => "Working".to_owned(),
        };
        ui.label(text);
        return;
    }
    let Some(moment) = &state.run().moment else { return };
    let quads = words::counted(moment.standing, "quad");
    let all = state.run().track.last().map(|t| u64::from(t.standing));
    let more = if state.run().recorded { "" } else { "…" };
    let at = format!(
        "**step {}** / {}{more}   ",
        words::grouped(moment.step),
        words::grouped(state.run().track.len() as u64)
    );
    // Clean-up removes some: the number at the end is no total.
    let end = all.filter(|_| state.run().recorded).map(|all| format!(" ({} at the end)", words::grouped(all)));
    let text = format!("{at}**{quads}**{}", end.unwrap_or_default());
    // The row has room for two lines.
    let mut job = theme::formula(&text, theme::BODY, ink(palette.text), ink(palette.strong));
    job.wrap.max_width = ui.available_width().max(1.0);
    job.wrap.max_rows = 2;
    let galley = ui.painter().layout_job(job);
    ui.label(galley);
}

/// The lines of the sentence of a step in a window of some width: no step changes them.
fn narration_lines(width: f32) -> usize {
    (LONGEST / (width - 2.0 * SIDE).max(1.0)).ceil() as usize
}

/// Their height.
fn narration_height(width: f32) -> f32 {
    LINE * narration_lines(width) as f32 + 6.0
}

/// What the last step did, in a sentence. A click shows the transcript.
fn narration(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = &state.run().moment else { return };
    let (text, width) = (&moment.narration, ui.max_rect().width());
    let galley =
        in_lines(ui.painter(), text, width, narration_lines(width + 2.0 * SIDE), &[theme::TABLE, theme::HEAD], palette);
    let tip = if galley.elided { plain(text) } else { "Show the transcript".to_owned() };
    let told = ui.add(egui::Label::new(galley).selectable(false).sense(egui::Sense::click()));
    told.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Status, true, plain(text)));
    // Screen readers say it when it changes.
    ui.ctx().accesskit_node_builder(told.id, |node| node.set_live(egui::accesskit::Live::Polite));
    on_click(&told.on_hover_text(tip), Command::Reveal(Pane::History), commands);
}

/// A thin bar over the row while work is under way.
fn progress(ui: &Ui, row: Rect, state: &State, palette: &Palette) {
    let Some(progress) = &state.run().progress else { return };
    let share = if progress.total > 0 { progress.done as f32 / progress.total as f32 } else { 0.0 };
    let bar = Rect::from_min_size(row.min, Vec2::new(row.width() * share.clamp(0.0, 1.0), 3.0));
    ui.painter().rect_filled(bar, 0.0, ink(palette.base));
}
