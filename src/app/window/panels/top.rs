//! The bar with the menus, the name of the case, and the field for commands.

use eframe::egui::{
    self, Align, Align2, Button, Layout, MenuBar, RichText, Role, ScrollArea, Sense, Ui, Vec2, WidgetInfo,
};

use super::on_click;
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::pair::PairCommand;
use crate::app::window::presentation::PresentationCommand;
use crate::app::window::session::{Goal, Source};
use crate::app::window::state::{State, SurfaceView};
use crate::app::window::study::{Study, StudyCommand, Subject};
use crate::app::window::sweep::SweepCommand;
use crate::app::window::theme::{self, ink};
use crate::app::window::view_layer::ViewLayer;
use crate::core::case::built_in;
use crate::core::lesson::built_in::{LESSONS, title as lesson_title};
use crate::core::question::Series;
use crate::render::camera::Bearing;
use crate::render::palette::Palette;
use crate::render::scene::ColourBy;

/// How much of the window's height a list in a menu leaves free.
const ROOM: f32 = 120.0;
/// The width of a menu of cases, at most.
const TITLES: f32 = 560.0;

/// Shows the bar.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let bar = ui.max_rect();
    ui.painter().hline(bar.x_range(), bar.bottom() - 0.5, (1.0, ink(palette.line)));
    let menus_end = ui.horizontal_centered(|ui| {
        ui.add_space(8.0);
        ui.label(RichText::new("quadfront").font(theme::semibold(theme::BODY)).color(ink(palette.strong)));
        ui.add_space(6.0);
        MenuBar::new().ui(ui, |ui| menus(ui, state, commands)).inner
    });
    let right = egui::UiBuilder::new().max_rect(bar).layout(Layout::right_to_left(Align::Center));
    let field_start = ui.scope_builder(right, |ui| {
        ui.add_space(8.0);
        field(ui, bar.width(), commands, palette)
    });
    if let Some(study) = state.study().filter(|study| study.explores) {
        back(ui, study, bar, commands, palette);
    } else if let Some([name, title]) = named(state) {
        let room = bar.with_min_x(menus_end.inner + 16.0).with_max_x(field_start.inner - 16.0);
        heading(ui, room, bar.center().x, name, title, palette);
    }
}

/// Name and title in a room, around `centre` where they fit there. A title that is cut is told in whole where one
/// points at it.
fn heading(ui: &Ui, room: egui::Rect, centre: f32, name: String, title: String, palette: &Palette) {
    let name = ui.painter().layout_no_wrap(name, theme::semibold(theme::BODY), ink(palette.strong));
    if room.width() < name.size().x {
        return;
    }
    let after = name.size().x + 8.0;
    let mut job =
        egui::text::LayoutJob::simple_singleline(title.clone(), theme::regular(theme::BODY), ink(palette.weak));
    job.wrap = egui::text::TextWrapping::truncate_at_width((room.width() - after).max(0.0));
    let shown = ui.painter().layout_job(job);
    let width = after + shown.size().x;
    let left = (centre - 0.5 * width).min(room.right() - width).max(room.left());
    let place = |x: f32, size: Vec2| Align2::LEFT_CENTER.anchor_size(egui::pos2(x, room.center().y), size);
    let (name_place, title_place) = (place(left, name.size()), place(left + after, shown.size()));
    let (is_cut, said) = (shown.elided, format!("{} {title}", name.text()));
    ui.painter().galley(name_place.min, name, ink(palette.strong));
    ui.painter().galley(title_place.min, shown, ink(palette.weak));
    let response = ui.interact(name_place.union(title_place), ui.scope_id().with("title"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, said.clone()));
    if is_cut {
        response.on_hover_text(title);
    }
}

/// The way back to a lesson that is left for a while.
fn back(ui: &mut Ui, study: &Study, bar: egui::Rect, commands: &mut Vec<Command>, palette: &Palette) {
    let name = if study.lesson().is_some() { "Back to the lesson" } else { "Back to the question" };
    let text = RichText::new(name).font(theme::semibold(theme::BODY)).color(ink(palette.ground));
    let place = egui::Rect::from_center_size(bar.center(), Vec2::new(170.0, 24.0));
    let middle = egui::UiBuilder::new().max_rect(place).layout(Layout::top_down(Align::Center));
    ui.scope_builder(middle, |ui| {
        let response = ui.add(Button::new(text).fill(ink(palette.base))).on_hover_text("E");
        on_click(&response, Command::Study(StudyCommand::Explore), commands);
    });
}

/// The title without the name in front of it.
fn title(title: &str, name: &str) -> String {
    let rest = title.split_once(": ").map_or(title, |parts| parts.1);
    if rest == name { String::new() } else { rest.to_owned() }
}

fn item(ui: &mut Ui, command: Command, commands: &mut Vec<Command>) {
    let key = command.key().unwrap_or_default();
    if ui.add(Button::new(command.name()).shortcut_text(key)).clicked() {
        commands.push(command);
        ui.close();
    }
}

fn items<const N: usize>(ui: &mut Ui, all: [Command; N], commands: &mut Vec<Command>) {
    all.into_iter().for_each(|command| item(ui, command, commands));
}

/// The menus. Returns where they end.
fn menus(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) -> f32 {
    ui.menu_button("Case", |ui| {
        items(ui, [Command::OpenDialog, Command::OpenPath, Command::Reopen, Command::Import], commands);
        items(
            ui,
            [Command::SaveRun, Command::SaveMesh, Command::CopyLink, Command::SavePage, Command::Notes],
            commands,
        );
        ui.separator();
        items(ui, [PairCommand::Fork, PairCommand::AskBeside].map(Command::Pair), commands);
        ui.separator();
        let mut open = |ui: &mut Ui, cases: &[(&str, &str)]| {
            ui.set_min_width(TITLES.min(0.6 * ui.ctx().content_rect().width()));
            for (name, _) in cases {
                let button = Button::new(built_in::title(name).unwrap_or(name)).shortcut_text(*name).wrap();
                if ui.add(button).clicked() {
                    commands.push(Command::Open(Source::BuiltIn((*name).to_owned())));
                    ui.close();
                }
            }
        };
        ui.menu_button("Built-in cases", |ui| {
            // A small window has no room for all of them.
            let height = ui.ctx().content_rect().height() - ROOM;
            ScrollArea::vertical().max_height(height).show(ui, |ui| open(ui, built_in::CASES));
        });
        ui.menu_button("Figures of the paper", |ui| open(ui, built_in::FIGURES));
    });
    ui.menu_button("Parameters", |ui| {
        items(ui, [Command::ResetParameters, Command::Undo, Command::Redo], commands);
        ui.separator();
        items(ui, SweepCommand::ALL.map(Command::Sweep), commands);
    });
    ui.menu_button("View", |ui| {
        let looks = [Command::Fit, Command::ShowDecision, Command::ToggleFollow, Command::FindWorst];
        items(ui, looks, commands);
        items(ui, [Command::ToggleTheme, Command::ResetLayout], commands);
        ui.separator();
        let [present, spotlight, _] = PresentationCommand::ALL.map(Command::Presentation);
        items(ui, [present, spotlight], commands);
        ui.separator();
        ui.menu_button("Surfaces", |ui| {
            items(ui, SurfaceView::ALL.map(Command::SurfaceView), commands);
            ui.separator();
            items(ui, [Bearing::Iso, Bearing::X, Bearing::Y, Bearing::Z].map(Command::LookFrom), commands);
            ui.separator();
            items(ui, [Command::HiddenLines, Command::ToggleCurved], commands);
        });
        ui.separator();
        items(ui, ViewLayer::ALL.map(Command::Layer), commands);
        ui.separator();
        items(ui, ColourBy::ALL.map(Command::ColourBy), commands);
    });
    ui.menu_button("Figure", |ui| {
        ui.add_enabled_ui(state.run().moment.is_some(), |ui| {
            items(ui, [Command::Figures, Command::Export, Command::Screenshot], commands);
        });
    });
    ui.menu_button("Learn", |ui| learn(ui, state, commands));
    let last = ui.menu_button("Help", |ui| {
        items(ui, [Command::Help, Command::Palette, Command::Messages, Command::Go(Goal::Step(0))], commands);
    });
    last.response.rect.right()
}

/// Lessons and predictions.
fn learn(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let study = |command| Command::Study(command);
    items(ui, [study(StudyCommand::Resume)], commands);
    ui.menu_button("Lessons", |ui| {
        ui.set_min_width(TITLES.min(0.6 * ui.ctx().content_rect().width()));
        let height = ui.ctx().content_rect().height() - ROOM;
        ScrollArea::vertical().max_height(height).show(ui, |ui| {
            for ((name, _), number) in LESSONS.iter().zip(1..) {
                let done = if state.workspace().learned.is_done(name) { icons::CHECK } else { "" };
                let title = format!("{number}. {}", lesson_title(name).unwrap_or(name));
                if ui.add(Button::new(title).shortcut_text(done).wrap()).clicked() {
                    commands.push(study(StudyCommand::Open(name)));
                    ui.close();
                }
            }
        });
    });
    ui.separator();
    ui.add_enabled_ui(state.run().moment.is_some(), |ui| {
        items(ui, [StudyCommand::Predict, StudyCommand::PredictSeries(Series::default())].map(study), commands);
    });
    if state.study().is_some() {
        ui.separator();
        items(ui, [StudyCommand::Explore, StudyCommand::Save, StudyCommand::Leave].map(study), commands);
    }
}

/// What stands in the middle of the bar: the case, or the lesson.
fn named(state: &State) -> Option<[String; 2]> {
    // The panel of an import shows its name.
    let opened = state.run().opened.as_ref().filter(|_| state.run().import.is_none())?;
    let case = &opened.run.case;
    Some(match state.shown_study().map(|study| &study.subject) {
        Some(Subject::Lesson { lesson, .. }) => {
            let at = state.study().and_then(Study::tour_place);
            let number = at.map(|at| format!("Lesson {} of {}", at + 1, LESSONS.len()));
            [number.unwrap_or_else(|| "Lesson".to_owned()), lesson.title.clone()]
        }
        Some(Subject::Prediction { .. }) => ["Predict".to_owned(), case.title.clone()],
        None => [case.name.clone(), title(&case.title, &case.name)],
    })
}

/// A button that looks like a field and opens the palette. Returns its left end.
fn field(ui: &mut Ui, room: f32, commands: &mut Vec<Command>, palette: &Palette) -> f32 {
    let width = if room > 800.0 { 250.0 } else { 60.0 };
    let (rect, response) = ui.allocate_exact_size(Vec2::new(width, 22.0), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, Command::Palette.name()));
    let line = if response.hovered() { palette.hint } else { palette.line };
    let painter = ui.painter_at(rect);
    painter.rect(rect, 4.0, ink(palette.field), (1.0, ink(line)), egui::StrokeKind::Inside);
    let font = theme::regular(theme::TABLE);
    let left = rect.left_center() + Vec2::new(9.0, 0.0);
    painter.text(left, Align2::LEFT_CENTER, icons::MAGNIFYING_GLASS, font.clone(), ink(palette.weak));
    if width > 100.0 {
        let text = left + Vec2::new(20.0, 0.0);
        painter.text(text, Align2::LEFT_CENTER, Command::Palette.name(), font.clone(), ink(palette.weak));
        let right = rect.right_center() - Vec2::new(9.0, 0.0);
        painter.text(right, Align2::RIGHT_CENTER, "Ctrl+P", theme::regular(theme::HEAD), ink(palette.hint));
    }
    on_click(&response.on_hover_text(Command::Palette.tip()), Command::Palette, commands);
    rect.left()
}
