//! A field for a condition over a table of fields: it completes what is typed, and says what is wrong with it.

use eframe::egui::{self, Id, Key, Label, Modifiers, RichText, Role, Sense, TextEdit, Ui, WidgetInfo};

use super::line;
use crate::app::window::theme::{self, ink};
use crate::core::kernel::condition::{Condition, Field, Holds};
use crate::render::palette::Palette;

/// The greatest number of completions.
const OFFERED: usize = 6;

/// The field.
pub struct ConditionField {
    /// Its name for screen readers, which identifies it.
    pub name: &'static str,
    /// What is shown while it is empty.
    pub hint: &'static str,
    /// The fields that a condition can name.
    pub fields: &'static [Field],
}

/// What has become of its text in a frame.
pub struct Typed {
    /// The condition, where the text is one.
    pub condition: Option<Condition>,
    /// Whether the user has pressed Enter.
    entered: bool,
}

impl Typed {
    /// Whether the user has entered a condition.
    pub fn is_entered(&self) -> bool {
        self.entered && self.condition.is_some()
    }
}

impl ConditionField {
    /// The height that it takes with its completions, in points.
    pub fn height(&self, text: &str) -> f32 {
        34.0 + if text.is_empty() { 0.0 } else { 20.0 * (self.offers(text).len() as f32 + 1.5) }
    }

    /// Shows it.
    pub fn show(&self, ui: &mut Ui, text: &mut String, palette: &Palette) -> Typed {
        let offers = self.offers(text);
        let id = Id::unique(self.name);
        // Tab takes the first completion; it must not leave the field.
        let has_focus = ui.memory(|memory| memory.has_focus(id));
        let taken = has_focus && !offers.is_empty() && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Tab));
        let field =
            TextEdit::singleline(text).id(id).lock_focus(true).hint_text(self.hint).desired_width(f32::INFINITY);
        let response = ui.add(field);
        response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, self.name));
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        let mut chosen = taken.then(|| offers[0].0.clone());
        let parsed = Condition::parse(text, self.fields);
        if entered {
            response.request_focus();
        }
        if entered && parsed.is_ok() {
            return Typed { condition: parsed.ok(), entered };
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
            if let Some(mut edit) = TextEdit::load_state(ui.ctx(), id) {
                let end = egui::text::CCursor::new(text.chars().count());
                edit.cursor.set_char_range(Some(egui::text::CCursorRange::one(end)));
                edit.store(ui.ctx(), id);
            }
        } else if let (Err(fault), false) = (&parsed, text.trim().is_empty()) {
            // While the user types it is a hint; after Enter, until it is corrected, an error.
            let colour = if response.has_focus() { palette.weak } else { palette.broken };
            ui.add(Label::new(line(fault.to_string(), colour)).wrap());
        }
        Typed { condition: parsed.ok(), entered }
    }

    /// Completions of the word that is being typed, with their meaning.
    fn offers(&self, text: &str) -> Vec<(String, String)> {
        if text.trim().is_empty() {
            return Vec::new();
        }
        let start = word_start(text);
        let (before, word) = text.split_at(start);
        let before = before.trim_end();
        let compared = ["==", "!="].iter().find_map(|sign| before.strip_suffix(sign)).map(str::trim_end);
        if let Some(field) = compared {
            let name = &field[word_start(field)..];
            let words = self.fields.iter().find(|f| f.name == name).map_or(&[][..], |field| field.holds.words());
            let fits = words.iter().filter(|w| w.contains(word) && **w != word);
            return fits.take(OFFERED).map(|w| ((*w).to_owned(), String::new())).collect();
        }
        let is_value = before.ends_with(['<', '>', '=']);
        if word.is_empty() || is_value || self.fields.iter().any(|field| field.name == word) {
            return Vec::new();
        }
        let mut fits: Vec<_> = self.fields.iter().filter(|field| field.name.contains(word)).collect();
        fits.sort_by_key(|field| !field.name.starts_with(word));
        let unit = |holds: Holds| if holds == Holds::Degrees { ", degrees" } else { "" };
        fits.iter().take(OFFERED).map(|f| (f.name.to_owned(), format!("{}{}", f.doc, unit(f.holds)))).collect()
    }
}

/// Where the word at the end of a text begins.
fn word_start(text: &str) -> usize {
    let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    text.rfind(|c| !is_word(c)).map_or(0, |at| at + text[at..].chars().next().map_or(1, char::len_utf8))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::run::breakpoint::FIELDS;

    fn names(text: &str) -> Vec<String> {
        let field = ConditionField { name: "", hint: "", fields: FIELDS };
        field.offers(text).into_iter().map(|offer| offer.0).collect()
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
