//! What a lesson tells: the part at hand with its numbers, words that light what they mean, and the decisions that led
//! to the state.

use std::ops::Range;

use eframe::egui::text::{LayoutJob, TextFormat};
use eframe::egui::{Align, Label, Layout, Response, RichText, Role, ScrollArea, Sense, Ui, Vec2, WidgetInfo};

use super::{StudyPanel, TEXT, heading};
use crate::app::window::command::Command;
use crate::app::window::equation::equation;
use crate::app::window::panels::{note, on_click, part};
use crate::app::window::session::Goal;
use crate::app::window::state::State;
use crate::app::window::study::{Study, StudyCommand, Subject, outlined};
use crate::app::window::theme::{self, ink};
use crate::app::window::{icons, words};
use crate::core::lesson::{Block, Equation, Piece, Scene, Shown};
use crate::core::run::explain::plain;
use crate::render::palette::{Palette, Rgba};

/// The room between two blocks of text, and how far items of lists are set in.
const GAP: f32 = 9.0;
const INDENT: f32 = 16.0;
/// The size of equations.
const EQUATION: f32 = 17.0;

/// The least height of the list of decisions, and what is left free below it.
const LEAST: f32 = 96.0;
const BELOW: f32 = 20.0;

/// Shows it; `room` is the height that can be seen at once.
pub fn show(
    ui: &mut Ui,
    room: f32,
    state: &State,
    local: &mut StudyPanel,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let Some(study) = state.study() else { return };
    match &study.subject {
        Subject::Lesson { lesson, part: at, .. } => {
            let section = if lesson.section.is_empty() { String::new() } else { format!(" \u{b7} {}", lesson.section) };
            let above = format!("{}{section}", lesson.title.to_uppercase());
            head(ui, &above, &format!("{} of {}", at + 1, lesson.parts.len()), palette);
            let Some(here) = lesson.parts.get(*at) else { return };
            title(ui, &here.heading, palette);
            if let Some(scene) = study.taught.as_ref().and_then(|taught| taught.scene.as_ref()) {
                for ((block, pieces), set) in here.blocks.iter().zip(&scene.text).zip(&scene.equations) {
                    show_block(ui, block, set.as_ref(), pieces, commands, palette);
                    ui.add_space(GAP);
                }
            }
        }
        Subject::Prediction { series, drawn, at } => predicted(ui, study, series.is_some(), drawn.len(), *at, palette),
    }
    if let Some(scene) = study.taught.as_ref().and_then(|taught| taught.scene.as_ref()) {
        away(ui, state, scene, commands, palette);
    }
    where_we_are(ui, room, state, study, local, commands, palette);
}

/// The line above a heading: what it is of, and how far one is.
fn head(ui: &mut Ui, above: &str, count: &str, palette: &Palette) {
    ui.add_space(8.0);
    ui.horizontal_top(|ui| {
        let font = theme::regular(theme::HEAD);
        let width = ui.painter().layout_no_wrap(count.to_owned(), font.clone(), ink(palette.weak)).size().x;
        let room = Vec2::new((ui.available_width() - width - 12.0).max(1.0), 0.0);
        ui.allocate_ui(room, |ui| {
            ui.set_width(room.x);
            ui.add(Label::new(RichText::new(above).font(font.clone()).color(ink(palette.weak))).wrap());
        });
        ui.with_layout(Layout::right_to_left(Align::TOP), |ui| {
            ui.label(RichText::new(count).font(font).color(ink(palette.weak)));
        });
    });
}

fn title(ui: &mut Ui, text: &str, palette: &Palette) {
    ui.add_space(6.0);
    ui.add(Label::new(RichText::new(text).font(theme::semibold(20.0)).color(ink(palette.strong))).wrap());
    ui.add_space(8.0);
}

/// What is said of a prediction.
fn predicted(ui: &mut Ui, study: &Study, is_series: bool, count: usize, at: usize, palette: &Palette) {
    let said = match (study.is_over, is_series, count) {
        (true, ..) => "the end".to_owned(),
        (_, true, 0) => String::new(),
        (_, true, _) => format!("{} of {count}", at + 1),
        _ => format!("question {}", study.score.given().len() + usize::from(study.is_asking())),
    };
    head(ui, "PREDICT", &said, palette);
    title(ui, "What comes next?", palette);
    let text = match &study.subject {
        Subject::Prediction { series: Some(series), drawn, .. } if drawn.is_empty() && !study.is_over => {
            format!("The run is recorded to its end first; then seed {} draws the questions.", series.seed)
        }
        Subject::Prediction { series: Some(series), drawn, .. } if drawn.is_empty() => {
            format!("No step of this run answers such questions (seed {}).", series.seed)
        }
        Subject::Prediction { series: Some(series), .. } => format!(
            "Seed {} drew {} from this run. The same seed draws the same ones, on every machine.",
            series.seed,
            words::counted(count as u64, "question")
        ),
        _ if study.is_over => "No further step of this run leaves anything to predict.".to_owned(),
        _ => "Predict the steps of this run one after another. Each answer comes with its reason.".to_owned(),
    };
    paragraph(ui, &text, palette);
    let (tally, streak) = (study.score.tally(), study.score.streak());
    if tally.all() > 0 {
        ui.add_space(GAP);
        let partly = if tally.partly > 0 { format!(", {} partly", tally.partly) } else { String::new() };
        let mut text = format!("**{} of {}** right{partly}.", tally.right, tally.all());
        if streak > 1 {
            text += &format!(" {streak} in a row.");
        }
        paragraph(ui, &text, palette);
    }
    if study.is_over && tally.all() > 0 {
        let missed: Vec<String> = study
            .score
            .by_rule()
            .into_iter()
            .filter(|(_, tally)| tally.wrong > 0)
            .map(|(rule, tally)| format!("{} ({} of {})", rule.words(), tally.wrong, tally.all()))
            .collect();
        ui.add_space(GAP);
        let text = match missed.is_empty() {
            true => "No rule was missed.".to_owned(),
            false => format!("Missed: {}.", missed.join(", ")),
        };
        paragraph(ui, &text, palette);
    }
}

fn paragraph(ui: &mut Ui, text: &str, palette: &Palette) {
    ui.add(Label::new(theme::formula(text, TEXT, ink(palette.text), ink(palette.strong))).wrap());
}

/// A block of a part.
fn show_block(
    ui: &mut Ui,
    block: &Block,
    set: Option<&Equation>,
    pieces: &[Shown],
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    match (block, set) {
        (_, Some(set)) => {
            let words: String = pieces.iter().map(|shown| shown.text.as_str()).collect();
            let wide = ui.painter().layout_no_wrap(plain(&words), theme::regular(TEXT), ink(palette.weak)).size().x;
            // What it says is weak, beside it where there is room, else below.
            let is_beside = ui
                .horizontal(|ui| {
                    ui.add_space(INDENT);
                    equation(ui, set, EQUATION, ink(palette.strong));
                    let is_beside = wide + GAP <= ui.available_width();
                    if is_beside {
                        ui.add_space(GAP);
                        text(ui, pieces, palette.weak, commands, palette);
                    }
                    is_beside
                })
                .inner;
            if !is_beside {
                ui.horizontal(|ui| {
                    ui.add_space(INDENT);
                    text(ui, pieces, palette.weak, commands, palette);
                });
            }
        }
        (Block::Item(_), None) => {
            ui.horizontal_top(|ui| {
                ui.add_space(INDENT - 12.0);
                ui.label(RichText::new("\u{2022}").font(theme::regular(TEXT)).color(ink(palette.weak)));
                ui.vertical(|ui| text(ui, pieces, palette.text, commands, palette));
            });
        }
        (_, None) => text(ui, pieces, palette.text, commands, palette),
    }
}

/// Text with words that are lit, and light what they mean while the pointer is on them.
fn text(ui: &mut Ui, pieces: &[Shown], colour: Rgba, commands: &mut Vec<Command>, palette: &Palette) {
    if pieces.is_empty() {
        return;
    }
    let mut job = LayoutJob::default();
    let mut meant: Vec<(Range<usize>, &Shown)> = Vec::new();
    for shown in pieces {
        let from = job.text.chars().count();
        append(&mut job, shown, colour, palette);
        meant.push((from..job.text.chars().count(), shown));
    }
    job.wrap.max_width = ui.available_width().max(1.0);
    let galley = ui.painter().layout_job(job);
    let said = plain(&pieces.iter().map(|shown| shown.text.as_str()).collect::<String>());
    let (rect, response) = ui.allocate_exact_size(galley.size(), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, said.clone()));
    ui.painter().galley(rect.min, galley.clone(), ink(palette.text));
    if let Some(at) = response.hover_pos() {
        let character = galley.cursor_from_pos(at - rect.min).index.0;
        let lights = meant.iter().find(|(range, _)| range.contains(&character)).and_then(|(_, shown)| {
            let things = shown.lights.as_ref()?;
            (!things.is_empty()).then(|| outlined(things))
        });
        commands.extend(lights.map(|things| Command::Study(StudyCommand::PointAt(things))));
    }
}

/// Appends a piece in its style.
fn append(job: &mut LayoutJob, shown: &Shown, colour: Rgba, palette: &Palette) {
    let (colour, strong) = match shown.piece {
        Piece::Lit(_) | Piece::LitValue(_) | Piece::Named(..) => (palette.accent, palette.accent),
        Piece::Emphasis(_) | Piece::Value(_) | Piece::Code(_) => (palette.strong, palette.strong),
        Piece::Plain(_) => (colour, palette.strong),
    };
    let is_slanted = matches!(shown.piece, Piece::Emphasis(_));
    let formula = theme::formula(&shown.text, TEXT, ink(colour), ink(strong));
    for section in &formula.sections {
        let format = TextFormat { italics: is_slanted, ..section.format.clone() };
        job.append(&formula.text[section.byte_range.start.0..section.byte_range.end.0], 0.0, format);
    }
}

/// A way back, where the learner has stepped away.
fn away(ui: &mut Ui, state: &State, scene: &Scene, commands: &mut Vec<Command>, palette: &Palette) {
    let is_away = state.run().moment.as_ref().is_some_and(|moment| moment.step != scene.step);
    if is_away && !state.run().is_busy() {
        let text = format!("This part is about step {}.", words::grouped(scene.step));
        part(ui, "away", |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.label(note(text, palette));
                let back = ui.button("Back to it");
                on_click(&back, Command::Study(StudyCommand::Return), commands);
            });
        });
    }
}

/// The decisions that led to the state, each with a link to its step.
fn where_we_are(
    ui: &mut Ui,
    room: f32,
    state: &State,
    study: &Study,
    local: &mut StudyPanel,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let Some(moment) = &state.run().moment else { return };
    let known = study.decisions.as_ref().filter(|(step, _)| *step == moment.step);
    let Some((_, decisions)) = known else {
        if study.asked_decisions != Some(moment.step) && !state.run().is_busy() {
            commands.push(Command::Study(StudyCommand::TellDecisions));
        }
        return;
    };
    if decisions.is_empty() {
        return;
    }
    heading(ui, "Where we are", &words::counted(decisions.len() as u64, "decision"), palette);
    // The list scrolls alone: what is told stays in sight.
    let used = ui.cursor().top() - ui.min_rect().top();
    let list = ScrollArea::vertical().id_salt("decisions").max_height((room - used - BELOW).max(LEAST));
    list.show(ui, |ui| {
        for decision in decisions {
            let is_now = decision.step == moment.step;
            let response = row(ui, &decision.text, is_now, palette);
            let now = (state.run().number, moment.step);
            if is_now && std::mem::replace(&mut local.seen, now) != now {
                response.scroll_to_me(None);
            }
            on_click(&response, Command::Go(Goal::Step(decision.step)), commands);
        }
    });
}

fn row(ui: &mut Ui, text: &str, is_now: bool, palette: &Palette) -> Response {
    const SIGN: f32 = 20.0;
    let colour = ink(if is_now { palette.strong } else { palette.text });
    let mut job = theme::formula(text, theme::BODY, colour, ink(palette.strong));
    job.wrap.max_width = (ui.available_width() - SIGN).max(1.0);
    let galley = ui.painter().layout_job(job);
    let size = Vec2::new(ui.available_width(), galley.size().y + 6.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_now, plain(text)));
    let ground = if is_now { Some(palette.accent_row) } else { response.hovered().then_some(palette.stripe) };
    if let Some(ground) = ground {
        ui.painter().rect_filled(rect.expand2(Vec2::new(6.0, 0.0)), 3.0, ink(ground));
    }
    let (sign, sign_colour) = if is_now { (icons::CARET_RIGHT, palette.accent) } else { (icons::CHECK, palette.holds) };
    let at = rect.min + Vec2::new(0.0, 3.0);
    ui.painter().text(at, eframe::egui::Align2::LEFT_TOP, sign, theme::regular(theme::BODY), ink(sign_colour));
    ui.painter().galley(at + Vec2::new(SIGN, 0.0), galley, colour);
    response.on_hover_cursor(eframe::egui::CursorIcon::PointingHand)
}
