//! The parameters at the current step: a change takes effect from this step on.

use eframe::egui::{self, Align, Layout, RichText, Role, ScrollArea, Slider, Ui, Vec2, WidgetInfo};

use super::{choice, icon_button, inset, on_click};
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::core::case::Parameters;
use crate::core::run::EditKind;
use crate::render::palette::Palette;

/// A number: key, name, range, decimals, unit, the paper's value, and its effect.
struct Number {
    key: &'static str,
    name: &'static str,
    range: [f64; 2],
    decimals: usize,
    unit: &'static str,
    paper: &'static str,
    tip: &'static str,
}

const NUMBERS: [Number; 9] = [
    Number {
        key: "theta_rect",
        name: "θ rect",
        range: [90.0, 180.0],
        decimals: 1,
        unit: "°",
        paper: "paper 135",
        tip: "Below this frontal angle the neighbouring front segment is the side edge (4.3.4), and table 1 has its classes.",
    },
    Number {
        key: "c",
        name: "c",
        range: [0.5, 4.0],
        decimals: 2,
        unit: "",
        paper: "1.5–2.0",
        tip: "A segment is within reach if what the selection window compares is below c times the smallest H-value (4.3.3).",
    },
    Number {
        key: "theta_seam",
        name: "θ seam",
        range: [0.0, 90.0],
        decimals: 1,
        unit: "°",
        paper: "30, fig. 12: 45",
        tip: "At or below this frontal angle a front corner is closed by a seam (4.3.6).",
    },
    Number {
        key: "seam_widening",
        name: "widening",
        range: [1.0, 3.0],
        decimals: 2,
        unit: "×",
        paper: "paper 1",
        tip: "Where a corner is crowded or its segments are short, it is closed up to θ seam times this, at most 90°.",
    },
    Number {
        key: "side_deviation",
        name: "side dev.",
        range: [0.0, 90.0],
        decimals: 1,
        unit: "°",
        paper: "paper 30",
        tip: "The greatest deviation of a side edge from its target direction (eq. 8).",
    },
    Number {
        key: "side_split",
        name: "side split",
        range: [1.0, 4.0],
        decimals: 2,
        unit: "×",
        paper: "paper 1.5",
        tip: "A live side edge longer than this times the base is divided (4.3.4).",
    },
    Number {
        key: "whole_below",
        name: "whole",
        range: [0.0, 2.0],
        decimals: 2,
        unit: "",
        paper: "paper 0",
        tip: "A side edge shorter than this in the metric is not divided.",
    },
    Number {
        key: "layers",
        name: "layers",
        range: [0.0, 20.0],
        decimals: 0,
        unit: "",
        paper: "none",
        tip: "Rows that are offset from the boundary before the front starts.",
    },
    Number {
        key: "theta_revr",
        name: "θ revr",
        range: [180.0, 360.0],
        decimals: 1,
        unit: "°",
        paper: "225; classifies only",
        tip: "Angles above this count as reversals (fig. 12). For display only: the mesh does not change.",
    },
];

const SWITCHES: [(&str, &str, &str); 7] = [
    ("bisector", "aim sides at the bisector", "Off: always at the right angle, as the paper says."),
    ("placement", "place new top nodes", "Off: the paper's eq. 9 on front nodes."),
    ("smoothing", "smooth around each quad", "Eqs. 9 and 10, section 4.3.6."),
    ("enhancement", "enhance around each quad", "Local swaps and node deletion, section 4.3.6."),
    ("seaming", "seam small corners", "Section 4.3.6, fig. 18."),
    ("splitting", "split at slender triangles", "Section 4.3.6, fig. 19."),
    ("post_processing", "clean up at the end", "Clean-up and smoothing of the whole mesh, section 4.3.7."),
];

const SELECTION: [(&str, &str); 4] = [
    ("table1", "table 1 (paper)"),
    ("shortest", "shortest segment"),
    ("smallest_angle", "smallest frontal angles"),
    ("level", "by rows, as in Q-Morph"),
];

/// What the panel keeps for itself.
#[derive(Default)]
pub struct ParametersState {
    /// The parameter that is being dragged: it takes effect when the user lets go.
    dragged: Option<(&'static str, f64)>,
}

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, local: &mut ParametersState, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = &state.run().moment else { return };
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        inset().show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 5.0;
            for number in &NUMBERS {
                row(ui, state, local, &moment.parameters, number, commands, palette);
            }
            selection(ui, &moment.parameters, commands, palette);
            for (key, name, tip) in SWITCHES {
                let mut on = moment.parameters.text_of(key).as_deref() == Some("true");
                if ui.checkbox(&mut on, name).on_hover_text(tip).changed() {
                    commands.push(Command::Set(key, on.to_string()));
                }
            }
        });
    });
}

/// The button in the panel's bar.
pub fn reset(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let changed = state.document().edits.iter().any(|edit| matches!(edit.kind, EditKind::Parameter { .. }));
    icon_button(ui, icons::RESET, theme::ICON, Command::ResetParameters, changed, commands);
}

fn row(
    ui: &mut Ui,
    state: &State,
    local: &mut ParametersState,
    parameters: &Parameters,
    number: &Number,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let in_force: f64 = parameters.text_of(number.key).and_then(|text| text.parse().ok()).unwrap_or(f64::NAN);
    let mut value = local.dragged.filter(|t| t.0 == number.key).map_or(in_force, |t| t.1);
    let before = value;
    ui.horizontal(|ui| {
        ui.set_height(24.0);
        let label = RichText::new(number.name).color(ink(palette.text));
        ui.allocate_ui_with_layout(Vec2::new(58.0, 24.0), Layout::left_to_right(Align::Center), |ui| {
            ui.set_width(58.0);
            ui.label(label).on_hover_text(number.tip);
        });
        ui.spacing_mut().slider_width = 84.0;
        let [low, high] = number.range;
        let slider = Slider::new(&mut value, low..=high).show_value(false);
        let dragged = ui.add(slider);
        dragged.widget_info(|| WidgetInfo::slider(true, value, format!("{} slider", number.key)));
        let text = egui::DragValue::new(&mut value)
            .range(low..=high)
            .speed((high - low) / 400.0)
            .fixed_decimals(number.decimals)
            .suffix(number.unit)
            .update_while_editing(false);
        let typed = ui.add_sized(Vec2::new(60.0, 22.0), text);
        typed.widget_info(|| WidgetInfo::drag_value(true, value));
        typed.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, number.key));
        let changed_here = state.parameters_of_case().and_then(|case| case.text_of(number.key));
        let changed = changed_here.is_some_and(|case| parameters.text_of(number.key).as_ref() != Some(&case));
        let busy = dragged.dragged() || typed.dragged();
        if value != before || (local.dragged.is_some_and(|t| t.0 == number.key) && !busy) {
            let value = rounded(value, number.decimals);
            if busy {
                local.dragged = Some((number.key, value));
            } else {
                local.dragged = None;
                commands.push(Command::Set(number.key, value.to_string()));
            }
        }
        if changed {
            back(ui, state, number.key, commands);
        } else {
            let paper = RichText::new(number.paper).font(theme::regular(theme::HEAD)).color(ink(palette.weak));
            ui.add(egui::Label::new(paper).truncate());
        }
    });
}

/// A button that resets a parameter to the value of the case.
fn back(ui: &mut Ui, state: &State, key: &'static str, commands: &mut Vec<Command>) {
    let Some(value) = state.parameters_of_case().and_then(|case| case.text_of(key)) else { return };
    let response = ui.add(egui::Button::new(format!("{} {value}", icons::RESET)).small());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Reset {key}")));
    let response = response.on_hover_text("Reset to the value of the case, from this step on");
    on_click(&response, Command::Set(key, value), commands);
}

fn rounded(value: f64, decimals: usize) -> f64 {
    let scale = libm::pow(10.0, decimals as f64);
    (value * scale).round() / scale
}

fn selection(ui: &mut Ui, parameters: &Parameters, commands: &mut Vec<Command>, palette: &Palette) {
    let now = parameters.text_of("selection").unwrap_or_default();
    ui.horizontal(|ui| {
        ui.label(RichText::new("select by").color(ink(palette.text)));
        let text = SELECTION.iter().find(|s| s.0 == now).map_or(now.as_str(), |s| s.1);
        let mut word = now.as_str();
        choice(ui, "selection", 170.0, text, &mut word, SELECTION);
        if word != now {
            commands.push(Command::Set("selection", word.to_owned()));
        }
    });
}
