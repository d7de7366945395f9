//! Breakpoints, watchpoints and bookmarks.

use eframe::egui::{
    self, Align, Id, Key, Label, Layout, Modifiers, RichText, Role, ScrollArea, Sense, TextEdit, Ui, WidgetInfo,
};

use super::{icon_button, inset, line, note, on_click};
use crate::app::window::command::Command;
use crate::app::window::session::Goal;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::{icons, words};
use crate::core::run::breakpoint::{FIELDS, Holds};
use crate::core::run::{Condition, Watched};
use crate::render::palette::Palette;
use crate::render::scene::Outlined;

/// The greatest number of completions.
const OFFERED: usize = 6;

/// What the panel keeps for itself.
#[derive(Default)]
pub struct BreakpointsState {
    /// The condition that is being typed.
    field: String,
}

/// Shows the breakpoints and watchpoints.
pub fn show(ui: &mut Ui, state: &State, local: &mut BreakpointsState, commands: &mut Vec<Command>, palette: &Palette) {
    inset().show(ui, |ui| {
        let offers = offers(&local.field);
        let below = 34.0 + if local.field.is_empty() { 0.0 } else { 20.0 * (offers.len() as f32 + 1.5) };
        let room = (ui.available_height() - below).max(30.0);
        ScrollArea::vertical().max_height(room).auto_shrink([false, true]).show(ui, |ui| {
            if state.document().breakpoints.is_empty() && state.document().watches.is_empty() {
                ui.add(Label::new(note("None yet. Try quad.min_angle < 30.", palette)).wrap());
                let text = "Or select a node, an edge or an element and press Watch in the inspector.";
                ui.add(Label::new(note(text, palette)).wrap());
            }
            conditions(ui, state, commands, palette);
            watches(ui, state, commands, palette);
        });
        field(ui, &mut local.field, &offers, commands, palette);
    });
}

fn conditions(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    for (k, breakpoint) in state.document().breakpoints.iter().enumerate() {
        ui.horizontal(|ui| {
            let mut on = breakpoint.is_on;
            if ui.checkbox(&mut on, &breakpoint.condition).on_hover_text("Switch it on or off").changed() {
                commands.push(Command::SwitchBreakpoint(k));
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                icon_button(ui, icons::X, 13.0, Command::RemoveBreakpoint(k), true, commands);
                if let Some(hits) = state.run().hits.get(k) {
                    let text = format!("{} in this run", words::grouped(hits.len() as u64));
                    ui.label(note(text, palette)).on_hover_text("How often it holds in the recorded part of the run");
                }
            });
        });
    }
}

/// Something that is watched, as the views know it.
pub fn outlined(watched: Watched) -> Outlined {
    match watched {
        Watched::Node(node) => Outlined::Node(node),
        Watched::Edge(a, b) => Outlined::Edge([a, b]),
        Watched::Element(element) => Outlined::Element(element),
    }
}

fn watches(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    for (k, watch) in state.document().watches.iter().enumerate() {
        let what = outlined(watch.watched);
        ui.horizontal(|ui| {
            let mut on = watch.is_on;
            let name = format!("{}  {}", icons::EYE, words::thing(what));
            let response = ui.checkbox(&mut on, name);
            response.widget_info(|| {
                WidgetInfo::selected(Role::CheckBox, true, on, format!("Watch {}", words::thing(what)))
            });
            if response.hovered() {
                commands.push(Command::Hover(what));
            }
            if response.on_hover_text("Stop where it is touched, forward and back").changed() {
                commands.push(Command::SwitchWatch(k));
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let button = egui::Button::new(RichText::new(icons::X).font(theme::regular(13.0)));
                let response = ui.add(button.frame_when_inactive(false));
                let label = format!("Stop watching {}", words::thing(what));
                response.widget_info(|| WidgetInfo::labeled(Role::Button, true, label.clone()));
                on_click(&response.on_hover_text(&label), Command::Watch(what), commands);
                let touched = ui.add(Label::new(note("last touch", palette)).sense(Sense::click()).selectable(false));
                let touched = touched.on_hover_text("Go back to the step that touched it last");
                on_click(&touched, Command::LastTouch(what), commands);
            });
        });
    }
}

/// Completions of the word that is being typed, with their meaning.
fn offers(text: &str) -> Vec<(String, String)> {
    if text.trim().is_empty() {
        return Vec::new();
    }
    let start = word_start(text);
    let (before, word) = text.split_at(start);
    let before = before.trim_end();
    let compared = ["==", "!="].iter().find_map(|sign| before.strip_suffix(sign)).map(str::trim_end);
    if let Some(field) = compared {
        let name = &field[word_start(field)..];
        let words = FIELDS.iter().find(|f| f.name == name).map_or(&[][..], |field| field.holds.words());
        let fits = words.iter().filter(|w| w.contains(word) && **w != word);
        return fits.take(OFFERED).map(|w| ((*w).to_owned(), String::new())).collect();
    }
    let is_value = before.ends_with(['<', '>', '=']);
    if word.is_empty() || is_value || FIELDS.iter().any(|field| field.name == word) {
        return Vec::new();
    }
    let mut fits: Vec<_> = FIELDS.iter().filter(|field| field.name.contains(word)).collect();
    fits.sort_by_key(|field| !field.name.starts_with(word));
    let unit = |holds: Holds| if holds == Holds::Degrees { ", degrees" } else { "" };
    fits.iter().take(OFFERED).map(|f| (f.name.to_owned(), format!("{}{}", f.doc, unit(f.holds)))).collect()
}

/// Where the word at the end of a text begins.
fn word_start(text: &str) -> usize {
    let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    text.rfind(|c| !is_word(c)).map_or(0, |at| at + text[at..].chars().next().map_or(1, char::len_utf8))
}

fn field(ui: &mut Ui, text: &mut String, offers: &[(String, String)], commands: &mut Vec<Command>, palette: &Palette) {
    let id = Id::unique("condition");
    // Tab takes the first completion; it must not leave the field.
    let has_focus = ui.memory(|memory| memory.has_focus(id));
    let taken = has_focus && !offers.is_empty() && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Tab));
    let field = TextEdit::singleline(text)
        .id(id)
        .lock_focus(true)
        .hint_text("a condition, e.g. kind == seamed")
        .desired_width(f32::INFINITY);
    let response = ui.add(field);
    response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Condition of a new breakpoint"));
    let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    let mut chosen = taken.then(|| offers[0].0.clone());
    let parsed = Condition::parse(text);
    if entered && parsed.is_ok() {
        commands.push(Command::AddBreakpoint(std::mem::take(text)));
        return;
    }
    for (k, (name, doc)) in offers.iter().enumerate() {
        let line = RichText::new(format!("{name}   {doc}")).font(theme::regular(theme::TABLE));
        let line = line.color(ink(if k == 0 { palette.strong } else { palette.text }));
        let offer = ui.add(Label::new(line).sense(Sense::click()).selectable(false).truncate());
        offer.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Use {name}")));
        if offer.on_hover_text(if k == 0 { "Tab takes it" } else { doc }).clicked() {
            chosen = Some(name.clone());
        }
    }
    if let Some(chosen) = chosen {
        text.truncate(word_start(text));
        *text += &chosen;
        text.push(' ');
        response.request_focus();
        if let Some(mut edit) = egui::TextEdit::load_state(ui.ctx(), id) {
            let end = egui::text::CCursor::new(text.chars().count());
            edit.cursor.set_char_range(Some(egui::text::CCursorRange::one(end)));
            edit.store(ui.ctx(), id);
        }
    } else if let (Err(fault), false) = (&parsed, text.trim().is_empty()) {
        // While the user types it is a hint; after Enter, until it is corrected, an error.
        let colour = if response.has_focus() { palette.weak } else { palette.broken };
        ui.add(Label::new(line(fault.to_string(), colour)).wrap());
    }
    if entered {
        response.request_focus();
    }
}

/// Shows the bookmarks.
pub fn bookmarks(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    inset().show(ui, |ui| {
        if state.document().bookmarks.is_empty() {
            ui.label(note("None yet. Ctrl+B bookmarks the current step.", palette));
        }
        for step in &state.document().bookmarks {
            let what = step.checked_sub(1).and_then(|k| state.run().track.get(k as usize));
            let what = what.map_or(String::new(), |tracked| words::kind(tracked.kind));
            let text = format!("{}  step {}   {what}", icons::BOOKMARK, words::grouped(*step));
            on_click(&ui.button(text).on_hover_text("Go to that step"), Command::Go(Goal::Step(*step)), commands);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<String> {
        offers(text).into_iter().map(|offer| offer.0).collect()
    }

    #[test]
    fn fields_are_offered_while_one_types_and_words_after_a_comparison() {
        assert!(names("").is_empty());
        assert_eq!(names("quad.mi"), ["quad.min_angle"]);
        assert_eq!(names("kind == seamed && angle")[..2], ["quad.min_angle", "quad.max_angle"]);
        assert!(names("kind == rolled").contains(&"rolled_back".to_owned()));
        assert!(names("quad.min_angle < 3").is_empty());
        assert!(names("quad.min_angle").is_empty(), "it is there already");
    }
}
