//! The card of a question: what is asked, the answers so far with their reasons, hints, and the way on.

use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{Button, Event, Frame, Id, Label, RichText, ScrollArea, TextEdit, Ui, WidgetInfo};

use super::{StudyPanel, TEXT};
use crate::app::window::command::Command;
use crate::app::window::panels::{note, on_click, part};
use crate::app::window::session::Posed;
use crate::app::window::state::State;
use crate::app::window::study::{Study, StudyCommand, Subject, Try, sign};
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::lesson::built_in::LESSONS;
use crate::core::question::{Answer, Kind, Verdict};
use crate::core::run::explain::plain;
use crate::render::palette::Palette;

/// The height that answers and hints may take before they scroll.
const MOST: f32 = 260.0;

/// Shows it.
pub fn show(ui: &mut Ui, state: &State, local: &mut StudyPanel, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(study) = state.study() else { return };
    ui.add_space(4.0);
    let frame = Frame::NONE.fill(ink(palette.field)).stroke((1.0, ink(palette.line))).corner_radius(4.0);
    frame.inner_margin(14).show(ui, |ui| {
        ui.set_width(ui.available_width());
        if let Some(posed) = study.posed() {
            question(ui, state, study, posed, local, commands, palette);
            ui.add_space(10.0);
        }
        ways_on(ui, study, commands, palette);
    });
    ui.add_space(6.0);
}

fn question(
    ui: &mut Ui,
    state: &State,
    study: &Study,
    posed: &Posed,
    local: &mut StudyPanel,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let text = format!("**{}**", posed.text.replace("**", ""));
    ui.add(Label::new(theme::formula(&text, TEXT, ink(palette.text), ink(palette.strong))).wrap());
    let is_open = state.open_question().is_some();
    if is_open {
        part(ui, "answers", |ui| answers(ui, posed, local, commands, palette));
    } else if study.is_asking() && !state.run().is_busy() && study.taught.is_some() {
        ui.add(Label::new(note("It is about another step.", palette)).wrap());
        part(ui, "return", |ui| {
            on_click(&ui.button("Back to the question"), Command::Study(StudyCommand::Return), commands);
        });
    }
    let said = study.tries.len() + study.hints;
    if said == 0 && study.remark.is_none() {
        return;
    }
    ui.add_space(8.0);
    ScrollArea::vertical().max_height(MOST).stick_to_bottom(true).show(ui, |ui| {
        study.tries.iter().for_each(|one| tried(ui, one, palette));
        for hint in study.taken_hints() {
            let text = format!("Hint: {}", hint.text);
            ui.add(Label::new(theme::formula(&text, theme::BODY, ink(palette.text), ink(palette.strong))).wrap());
        }
        if let Some(remark) = &study.remark {
            ui.add(Label::new(note(remark, palette)).wrap());
        }
    });
}

/// Choices, or what to click, with a field for those who write.
fn answers(ui: &mut Ui, posed: &Posed, local: &mut StudyPanel, commands: &mut Vec<Command>, palette: &Palette) {
    let (kind, step) = (posed.asked.kind, posed.asked.step);
    ui.add_space(4.0);
    let choices = kind.choices();
    if !choices.is_empty() {
        ui.horizontal_wrapped(|ui| {
            for choice in choices {
                let name = plain(choice.words());
                let text = theme::formula(choice.words(), theme::BODY, ink(palette.text), ink(palette.strong));
                let response = ui.add(Button::new(text));
                response.widget_info(|| WidgetInfo::labeled(eframe::egui::Role::Button, true, &name));
                on_click(&response, Command::Study(StudyCommand::Answer(Answer::Choice(*choice))), commands);
            }
        });
        return;
    }
    let (what, hint) = match kind {
        Kind::Segment => ("Click the segment in the view, or write its nodes.", "12-40"),
        Kind::Node => ("Click the node in the view, or write its number.", "number"),
        Kind::Count => ("Write the number.", "number"),
        _ => ("Click the edge in the view, or write its nodes.", "12-40"),
    };
    ui.add(Label::new(note(what, palette)).wrap());
    if local.typed.0 != step {
        local.typed = (step, String::new());
    }
    // Who writes without a click into the field means it.
    let written = if ui.memory(|memory| memory.focused().is_none()) { digits(ui) } else { String::new() };
    local.typed.1 += &written;
    ui.horizontal(|ui| {
        let field = TextEdit::singleline(&mut local.typed.1).hint_text(hint).desired_width(120.0);
        let response = ui.add(field);
        response.widget_info(|| WidgetInfo::labeled(eframe::egui::Role::TextInput, true, "Your answer"));
        if !written.is_empty() {
            response.request_focus();
            write_on(ui, response.id, local.typed.1.chars().count());
        }
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(eframe::egui::Key::Enter));
        let is_given = ui.button("Answer").clicked() || entered;
        if is_given && !local.typed.1.trim().is_empty() {
            let text = std::mem::take(&mut local.typed.1);
            commands.push(Command::Study(StudyCommand::AnswerText(text)));
        }
    });
}

/// Sets the cursor of a field that gets the focus behind what stands there.
fn write_on(ui: &Ui, field: Id, length: usize) {
    let mut kept = TextEdit::load_state(ui.ctx(), field).unwrap_or_default();
    kept.cursor.set_char_range(Some(CCursorRange::one(CCursor::new(length))));
    kept.store(ui.ctx(), field);
}

/// What is written of the numbers of nodes in this frame.
fn digits(ui: &Ui) -> String {
    let is_part = |c: char| c.is_ascii_digit() || c == '-';
    ui.input(|input| {
        let texts = input.events.iter().filter_map(|event| match event {
            Event::Text(text) => Some(text.as_str()),
            _ => None,
        });
        texts.filter(|text| text.chars().all(is_part)).collect()
    })
}

/// An answer with its verdict and its reason.
fn tried(ui: &mut Ui, one: &Try, palette: &Palette) {
    let colour = match one.judged.verdict {
        _ if one.is_shown => palette.holds,
        Verdict::Right => palette.holds,
        Verdict::Partly => palette.accent,
        Verdict::Wrong => palette.broken,
    };
    let mut job = theme::formula(
        &format!("{} {}", sign(one.judged.verdict), one.answer.words()),
        theme::BODY,
        ink(colour),
        ink(colour),
    );
    let why = format!("   **{}.** {}", one.word(), one.judged.why.join(" "));
    let why = theme::formula(&why, theme::BODY, ink(palette.text), ink(palette.strong));
    for section in &why.sections {
        job.append(&why.text[section.byte_range.start.0..section.byte_range.end.0], 0.0, section.format.clone());
    }
    ui.add(Label::new(job).wrap());
    ui.add_space(3.0);
}

/// Hint, back, explore and the score, and below them what leads on: always at the same place, so that a second click
/// does nothing else.
fn ways_on(ui: &mut Ui, study: &Study, commands: &mut Vec<Command>, palette: &Palette) {
    part(ui, "ways on", |ui| {
        ui.horizontal_wrapped(|ui| {
            if let Some(posed) = study.posed().filter(|_| study.is_asking()) {
                let more = study.hints < posed.hints.len();
                let hint = ui.add_enabled(more, Button::new("Hint")).on_hover_text("H");
                on_click(&hint, Command::Study(StudyCommand::Hint), commands);
            }
            if study.lesson().is_some_and(|(_, part)| part > 0) {
                on_click(&ui.button("Previous part"), Command::Study(StudyCommand::PartBack), commands);
            }
            on_click(&ui.button("Explore freely").on_hover_text("E"), Command::Study(StudyCommand::Explore), commands);
            if matches!(study.subject, Subject::Prediction { .. }) && !study.score.given().is_empty() {
                on_click(&ui.button("Save the answers"), Command::Study(StudyCommand::Save), commands);
            }
        });
        ui.add_space(4.0);
        ui.horizontal_wrapped(|ui| {
            if !study.is_over {
                let text = RichText::new(onward(study)).font(theme::semibold(theme::BODY));
                // The one thing that leads on stands out, unless a question is to be answered first.
                let button = match study.is_asking() {
                    true => Button::new(text),
                    false => Button::new(text.color(ink(palette.ground))).fill(ink(palette.base)),
                };
                let response = ui.add_enabled(study.taught.is_some(), button);
                let command = Command::Study(StudyCommand::Continue);
                on_click(&response.on_hover_text("Enter"), command, commands);
            }
            let tally = study.score.tally();
            if tally.all() > 0 {
                ui.label(note(format!("{} of {} right", tally.right, words::grouped(tally.all().into())), palette));
            }
        });
    });
}

/// The words of the button that leads on.
fn onward(study: &Study) -> &'static str {
    let questions = study.taught.as_ref().map_or(0, |taught| taught.posed.len());
    match study.lesson() {
        _ if study.is_asking() => "Show the answer",
        Some((lesson, part)) if part + 1 == lesson.parts.len() && study.question + 1 >= questions => {
            match study.tour_place() {
                Some(at) if at + 1 < LESSONS.len() => "Next lesson",
                _ => "End of the lesson",
            }
        }
        _ => "Continue",
    }
}
