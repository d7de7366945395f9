//! The parameters at the current step, in groups: a change takes effect from this step on. What belongs to the case is
//! changed by opening the run again.

mod rows;

use std::cell::Cell;

use eframe::egui::{
    self, Align, CollapsingHeader, Layout, RichText, Role, ScrollArea, Slider, SliderClamping, TextEdit, Ui, Vec2,
    WidgetInfo,
};

use super::{choice, icon_button, inset, on_click};
use crate::app::window::command::{Command, Rules};
use crate::app::window::icons;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::core::case::Parameters;
use crate::core::kernel::Shortest;
use crate::core::run::EditKind;
use crate::render::palette::Palette;
use rows::{CaseRow, GROUPS, Group, Kind, OF_CASE, Row};

/// Width of the names of numbers and lists, and height of a row.
const NAMES: f32 = 86.0;
const HEIGHT: f32 = 24.0;
/// How many characters a number has room for.
const ROOM: usize = 8;

/// What the panel keeps for itself.
#[derive(Default)]
pub struct ParametersState {
    /// The parameter that is being dragged: it takes effect when the user lets go.
    dragged: Option<(&'static str, f64)>,
    /// The parameter of the case that is being typed.
    typed: Option<(&'static str, String)>,
}

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, local: &mut ParametersState, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = &state.run().moment else { return };
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        inset().show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 5.0;
            rules(ui, &moment.parameters, commands, palette);
            for (k, group) in GROUPS.iter().enumerate() {
                header(group, state, &moment.parameters, k == 0, palette).show(ui, |ui| {
                    for row in group.rows {
                        let mut panel = Panel { state, parameters: &moment.parameters, commands, palette };
                        panel.row(ui, row, local);
                    }
                });
            }
            CollapsingHeader::new(title("Of the case", palette)).show(ui, |ui| {
                for row in &OF_CASE {
                    of_case(ui, row, state, local, commands, palette);
                }
            });
        });
    });
}

/// The button in the panel's bar.
pub fn reset(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let changed = state.document().edits.iter().any(|edit| matches!(edit.kind, EditKind::Parameter { .. }));
    icon_button(ui, icons::RESET, theme::ICON, Command::ResetParameters, changed, commands);
}

/// Buttons that set all parameters at once.
fn rules(ui: &mut Ui, now: &Parameters, commands: &mut Vec<Command>, palette: &Palette) {
    ui.horizontal(|ui| {
        ui.label(RichText::new("set all to").color(ink(palette.text)));
        for rules in Rules::ALL {
            let holds = now.with_rules_of(rules.parameters()) == *now;
            let response = ui.add(egui::Button::new(rules.name()).selected(holds));
            let tip = match rules {
                Rules::Paper => "The paper's rules and values, as --paper sets them",
                Rules::Default => "The defaults of this program",
            };
            let kept = OF_CASE.map(|row| row.key).join(", ");
            let tip = format!("{tip}, from this step on. What belongs to the case stays: layers, {kept}.");
            on_click(&response.on_hover_text(tip), Command::SetRules(rules), commands);
        }
    });
}

fn title(text: impl Into<String>, palette: &Palette) -> RichText {
    RichText::new(text).font(theme::semibold(theme::BODY)).color(ink(palette.strong))
}

/// The heading of a group, with the number of parameters that differ from the case.
fn header(group: &Group, state: &State, now: &Parameters, open: bool, palette: &Palette) -> CollapsingHeader {
    let case = state.parameters_of_case();
    let changed = group.rows.iter().filter(|row| case.is_some_and(|case| differ(case, now, row.key))).count();
    let text = match changed {
        0 => group.name.to_owned(),
        count => format!("{}  ·  {count} changed", group.name),
    };
    CollapsingHeader::new(title(text, palette)).id_salt(group.name).default_open(open)
}

fn differ(a: &Parameters, b: &Parameters, key: &str) -> bool {
    a.text_of(key) != b.text_of(key)
}

/// What all rows need.
struct Panel<'a> {
    state: &'a State,
    parameters: &'a Parameters,
    commands: &'a mut Vec<Command>,
    palette: &'a Palette,
}

impl Panel<'_> {
    fn row(&mut self, ui: &mut Ui, row: &Row, local: &mut ParametersState) {
        let Some(now) = self.parameters.text_of(row.key) else { return };
        ui.horizontal(|ui| {
            ui.set_height(HEIGHT);
            match row.kind {
                Kind::Switch => {
                    let mut on = now == "true";
                    let response = ui.checkbox(&mut on, row.name);
                    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, on, row.key));
                    if response.on_hover_text(row.tip()).changed() {
                        self.commands.push(Command::Set(row.key, on.to_string()));
                    }
                }
                Kind::Choice(words) => {
                    self.name(ui, row.name, &row.tip());
                    let text = words.iter().find(|word| word.0 == now).map_or(now.as_str(), |word| word.1);
                    let mut word = now.as_str();
                    choice(ui, row.key, 150.0, text, &mut word, words.iter().copied());
                    if word != now {
                        self.commands.push(Command::Set(row.key, word.to_owned()));
                    }
                }
                Kind::Number(usual, decimals, unit) => {
                    self.name(ui, row.name, &row.tip());
                    let why_not = (row.key == "layers" && !self.parameters.layered_loops.is_empty())
                        .then_some("The rows on the loops of layered_loops belong to the background mesh.");
                    let response = ui.add_enabled_ui(why_not.is_none(), |ui| {
                        self.number(ui, row.key, &now, (usual, decimals, unit), local);
                    });
                    if let Some(why) = why_not {
                        response.response.on_disabled_hover_text(why);
                    }
                }
            }
            if self.state.parameters_of_case().is_some_and(|case| differ(case, self.parameters, row.key)) {
                self.back(ui, row.key);
            }
        });
    }

    fn name(&self, ui: &mut Ui, name: &str, tip: &str) {
        ui.allocate_ui_with_layout(Vec2::new(NAMES, HEIGHT), Layout::left_to_right(Align::Center), |ui| {
            ui.set_width(NAMES);
            ui.label(RichText::new(name).color(ink(self.palette.text))).on_hover_text(tip);
        });
    }

    fn number(
        &mut self,
        ui: &mut Ui,
        key: &'static str,
        now: &str,
        (usual, decimals, unit): ([f64; 2], usize, &str),
        local: &mut ParametersState,
    ) {
        let (Ok(in_force), Some(limits)) =
            (now.parse::<f64>(), Parameters::kind_of(key).and_then(|kind| kind.limits()))
        else {
            return;
        };
        let mut value = local.dragged.filter(|dragged| dragged.0 == key).map_or(in_force, |dragged| dragged.1);
        let before = value;
        let range = widened(usual, in_force);
        ui.spacing_mut().slider_width = 84.0;
        // By default sliders clamp also values that nobody touches.
        let slider = Slider::new(&mut value, range[0]..=range[1]).clamping(SliderClamping::Edits).show_value(false);
        let slid = ui.add(slider);
        slid.widget_info(|| WidgetInfo::slider(true, value, format!("{key} slider")));
        let shown = short(value);
        // What is no number, so that it is refused with a word and not dropped.
        let refused = Cell::new(None);
        let field = egui::DragValue::new(&mut value)
            .speed((usual[1] - usual[0]) / 400.0)
            .custom_formatter(|value, _| short(value))
            // What is left as it stands keeps the digits for which there is no room.
            .custom_parser(|text| {
                let value = if text == shown { Some(before) } else { parsed(text, unit) };
                refused.set(value.is_none().then(|| text.to_owned()));
                value
            })
            .suffix(unit)
            .update_while_editing(false);
        let typed = ui.add_sized(Vec2::new(62.0, 22.0), field);
        typed.widget_info(|| WidgetInfo::drag_value(true, value));
        typed.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, key));
        let typed = typed.on_hover_text(format!("{key} = {now}"));
        self.commands.extend(refused.take().map(|text| Command::Set(key, text)));
        let busy = slid.dragged() || typed.dragged();
        if value != before || (local.dragged.is_some_and(|dragged| dragged.0 == key) && !busy) {
            if value != before && (slid.changed() || typed.dragged()) {
                value = rounded(value, decimals).clamp(limits[0], limits[1]);
            }
            if busy {
                local.dragged = Some((key, value));
            } else {
                local.dragged = None;
                self.commands.push(Command::Set(key, value.to_string()));
            }
        }
    }

    /// A button that resets a parameter to the value of the case.
    fn back(&mut self, ui: &mut Ui, key: &'static str) {
        let Some(value) = self.state.parameters_of_case().and_then(|case| case.text_of(key)) else { return };
        let response = ui.add(egui::Button::new(icons::RESET).small());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Reset {key}")));
        let response = response.on_hover_text(format!("Reset to {value}, the value of the case, from this step on"));
        on_click(&response, Command::Set(key, value), self.commands);
    }
}

/// A field for a parameter that belongs to the case.
fn of_case(
    ui: &mut Ui,
    row: &CaseRow,
    state: &State,
    local: &mut ParametersState,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let Some(now) = state.parameters_of_case().and_then(|case| case.text_of(row.key)) else { return };
    ui.horizontal(|ui| {
        ui.set_height(HEIGHT);
        ui.allocate_ui_with_layout(Vec2::new(NAMES, HEIGHT), Layout::left_to_right(Align::Center), |ui| {
            ui.set_width(NAMES);
            ui.label(RichText::new(row.name).color(ink(palette.text))).on_hover_text(row.tip());
        });
        let typed = local.typed.take_if(|typed| typed.0 == row.key);
        let mut text = typed.map_or_else(|| now.clone(), |typed| typed.1);
        let hint = if now.is_empty() { "all" } else { "" };
        let response = ui.add(TextEdit::singleline(&mut text).hint_text(hint).desired_width(150.0));
        response.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, row.key));
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        if response.has_focus() {
            local.typed = Some((row.key, text));
        } else if entered && text.trim() != now {
            commands.push(Command::SetForCase(row.key, text.trim().to_owned()));
        }
        response.on_hover_text(row.tip());
    });
}

/// A range that has a value.
fn widened([low, high]: [f64; 2], value: f64) -> [f64; 2] {
    [low.min(value), high.max(value)]
}

/// A number with all its digits, or as many as there is room for.
fn short(value: f64) -> String {
    let all = Shortest(value).to_string();
    let whole = format!("{value:.0}.").len();
    if all.len() <= ROOM { all } else { format!("{:.*}", ROOM.saturating_sub(whole), value) }
}

fn parsed(text: &str, unit: &str) -> Option<f64> {
    text.trim().trim_end_matches(unit).trim().replace('\u{2212}', "-").parse().ok()
}

fn rounded(value: f64, decimals: usize) -> f64 {
    let scale = libm::pow(10.0, decimals as f64);
    (value * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slider_widens_to_a_value_outside_its_range() {
        assert_eq!(widened([1.0, 4.0], 10.0), [1.0, 10.0]);
        assert_eq!(widened([1.0, 4.0], 0.5), [0.5, 4.0]);
        assert_eq!(widened([1.0, 4.0], 2.0), [1.0, 4.0]);
    }

    #[test]
    fn numbers_have_all_digits_where_there_is_room() {
        assert_eq!(["135", "1.5", "0.12345"].map(|text| short(text.parse().unwrap())), ["135", "1.5", "0.12345"]);
        assert_eq!(short(123.456_789_012), "123.4568");
        assert_eq!(parsed("120 °", "°"), Some(120.0));
        assert_eq!(parsed("much", ""), None);
    }
}
