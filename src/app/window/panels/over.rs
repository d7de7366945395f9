//! What opens over the window: all commands by name, all keys, and fields for a step or a path.

mod offers;

use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{self, Align2, Area, Button, Context, Key, Label, Order, RichText, ScrollArea, TextEdit, Ui, Vec2};

use super::on_click;
use crate::app::window::command::{Command, Purpose, groups};
use crate::app::window::mesh_out;
use crate::app::window::pair::PairCommand;
use crate::app::window::session::Source;
use crate::app::window::state::{Overlay, State, outlined};
use crate::app::window::sweep::{SweepCommand, SweepWork};
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::formats::Format;
use crate::core::record::link::Link;
use crate::render::palette::Palette;

const WIDTH: f32 = 460.0;

/// What the overlay keeps for itself.
#[derive(Default)]
pub struct OverState {
    /// What was shown in the frame before.
    shown: Overlay,
    /// The text of its field.
    field: String,
}

/// Shows what is open.
pub fn show(context: &Context, state: &State, local: &mut OverState, commands: &mut Vec<Command>, palette: &Palette) {
    let over = state.view().overlay;
    if over != local.shown {
        local.field = match over {
            Overlay::Mesh => mesh_out::suggested_path(state.active()),
            Overlay::Sweep => state.sweep().map_or_else(String::new, SweepWork::suggested_path),
            _ => String::new(),
        };
        local.shown = over;
    }
    if over == Overlay::Nothing {
        return;
    }
    let shadow = egui::Shadow { offset: [0, 6], blur: 18, spread: 0, color: egui::Color32::from_black_alpha(80) };
    let frame = super::floating(palette).shadow(shadow);
    let area =
        Area::new(egui::Id::unique("over")).order(Order::Foreground).anchor(Align2::CENTER_TOP, Vec2::new(0.0, 60.0));
    let shown = area.show(context, |ui| {
        frame.show(ui, |ui| {
            ui.set_width(WIDTH);
            match over {
                Overlay::Palette => palette_list(ui, state, &mut local.field, commands, palette),
                Overlay::Help => help(ui, palette),
                Overlay::GoTo => {
                    if field(ui, &mut local.field, "A step such as 812, or nq=100", "Step or NQ") {
                        commands.push(Command::GoToText(local.field.clone()));
                    }
                    missing(ui, state.active(), &local.field, commands, palette);
                }
                Overlay::Find => {
                    let hint = "quad 467, node 12, edge 12-40, segment 4-5, .5 .3, step 812, nq 9";
                    if field(ui, &mut local.field, hint, "Number or coordinates") {
                        commands.push(Command::GoToText(local.field.clone()));
                    }
                    missing(ui, state.active(), &local.field, commands, palette);
                }
                Overlay::Path => {
                    let hint = "The path of a case (.toml) or a mesh, the name of a built-in case, or a link";
                    if field(ui, &mut local.field, hint, "Path") {
                        let named = local.field.trim();
                        let open = match Link::is_link(named) {
                            true => Command::OpenLink(named.to_owned()),
                            false => Command::Open(Source::named(named)),
                        };
                        commands.extend([Command::CloseOverlay, open]);
                    }
                }
                Overlay::PathBeside => {
                    let hint = "The path of a case, a run or a mesh, or the name of a built-in case";
                    if field(ui, &mut local.field, hint, "Path of the second run") {
                        let source = Source::named(local.field.trim());
                        let open = PairCommand::OpenBeside(source, Box::default());
                        commands.extend([Command::CloseOverlay, Command::Pair(open)]);
                    }
                }
                Overlay::Mesh => {
                    let hint = "A name such as part.vtu; its extension chooses the format";
                    if field(ui, &mut local.field, hint, "Path of the mesh") {
                        commands.push(Command::SaveMeshAs(local.field.clone()));
                    }
                    about_the_mesh(ui, state.active().run().is_at_the_end(), palette);
                }
                Overlay::Sweep => {
                    let hint = "A name such as sweep.svg; its extension chooses the format";
                    if field(ui, &mut local.field, hint, "Path of the sweep") {
                        commands.push(Command::Sweep(SweepCommand::SaveAs(local.field.clone())));
                    }
                    about_the_sweep(ui, state, palette);
                }
                Overlay::Nothing => {}
            }
        });
    });
    let elsewhere = context.input(|input| {
        input.pointer.any_pressed() && input.pointer.interact_pos().is_some_and(|at| !shown.response.rect.contains(at))
    });
    if elsewhere {
        commands.push(Command::CloseOverlay);
    }
}

/// A field with the focus; what it suggests is selected at first, so that typing replaces it. Returns whether the user
/// has pressed Enter.
fn field(ui: &mut Ui, text: &mut String, hint: &str, name: &str) -> bool {
    let id = egui::Id::unique(("field over the window", name));
    let field = TextEdit::singleline(text).id(id).hint_text(hint).desired_width(WIDTH);
    let response = ui.add(field);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, name));
    let entered = response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if !entered && !response.has_focus() {
        response.request_focus();
        let mut edit = TextEdit::load_state(ui.ctx(), id).unwrap_or_default();
        let ends = [0, text.chars().count()].map(CCursor::new);
        edit.cursor.set_char_range(Some(CCursorRange::two(ends[0], ends[1])));
        edit.store(ui.ctx(), id);
    }
    entered
}

/// Why what was looked for is not there, and where it is.
fn missing(ui: &mut Ui, state: &State, text: &str, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(missing) = state.run().missing.as_ref().filter(|missing| missing.text == text) else { return };
    ui.add_space(4.0);
    ui.add(Label::new(RichText::new(&missing.why).color(ink(palette.text))).wrap());
    let Some(what) = missing.sought.named().map(outlined) else { return };
    let ended = missing
        .ended
        .map(|step| (step - 1, format!("Step {} removed it: go to the step before", words::grouped(step))));
    let begins = missing.begins.map(|step| (step, format!("Step {} makes it: go there", words::grouped(step))));
    for (step, text) in ended.into_iter().chain(begins) {
        on_click(&ui.button(text), Command::FindAt(step, what), commands);
    }
}

/// What is saved, in which format and where.
fn about_the_mesh(ui: &mut Ui, is_at_the_end: bool, palette: &Palette) {
    let known: Vec<&str> = Format::written().map(Format::extension).collect();
    let mut lines =
        vec![format!("Enter saves the current mesh in the format of the extension: .{}", known.join(", ."))];
    if !is_at_the_end {
        lines.push("It is not finished and still has triangles; Esc, then End, goes to the finished mesh".to_owned());
    }
    tell(ui, lines, palette);
}

/// What is saved of the sweep.
fn about_the_sweep(ui: &mut Ui, state: &State, palette: &Palette) {
    let figure = state.workspace().sweep.figure().name;
    let mut lines = vec![format!(
        "Enter saves a heat map of {figure} as .svg, .pdf or .png, and all figures of each run as .csv or .json"
    )];
    if state.sweep().is_some_and(SweepWork::is_running) {
        lines.push("The sweep goes on: runs that are not there yet are left empty".to_owned());
    }
    tell(ui, lines, palette);
}

/// Notes below the field for a path, and the folder of names.
fn tell(ui: &mut Ui, mut lines: Vec<String>, palette: &Palette) {
    if let Ok(folder) = std::env::current_dir() {
        lines.push(format!("A name without a folder is saved in {}", folder.display()));
    }
    for line in lines {
        ui.add_space(4.0);
        ui.add(Label::new(super::note(line, palette)).wrap());
    }
}

fn palette_list(ui: &mut Ui, state: &State, text: &mut String, commands: &mut Vec<Command>, palette: &Palette) {
    let hint = "All commands by name; also c = 1.5, or break where quad.min_angle < 30";
    let entered = field(ui, text, hint, "Name of a command");
    let wanted: Vec<String> = text.to_lowercase().split_whitespace().map(str::to_owned).collect();
    let fits = |name: &str| wanted.iter().all(|word| name.to_lowercase().contains(word));
    let mut found: Vec<(String, Command)> =
        Command::all().into_iter().filter(|c| *c != Command::Escape).map(|command| (command.name(), command)).collect();
    found.extend(offers::at_hand(state, state.active()));
    found.retain(|(name, _)| fits(name));
    if let Some(command) = offers::typed(text) {
        found.insert(0, (command.name(), command));
    }
    let mut chosen = found.first().filter(|_| entered).map(|found| found.1.clone());
    ui.add_space(4.0);
    ScrollArea::vertical().max_height(380.0).min_scrolled_height(380.0).show(ui, |ui| {
        for (k, (name, command)) in found.iter().enumerate() {
            let colour = if k == 0 { palette.strong } else { palette.text };
            let name = RichText::new(name).color(ink(colour));
            let button = Button::new(name)
                .shortcut_text(command.key().unwrap_or_default())
                .frame_when_inactive(k == 0)
                .min_size(Vec2::new(WIDTH - 12.0, 22.0));
            if ui.add(button).clicked() {
                chosen = Some(command.clone());
            }
        }
        if found.is_empty() {
            ui.label(super::note("No command matches.", palette));
        }
    });
    if let Some(command) = chosen {
        text.clear();
        commands.extend([Command::CloseOverlay, command]);
    }
}

fn help(ui: &mut Ui, palette: &Palette) {
    ui.label(RichText::new("Keys").font(theme::semibold(theme::TITLE)).color(ink(palette.strong)));
    ui.add_space(6.0);
    ScrollArea::vertical().max_height(460.0).min_scrolled_height(460.0).show(ui, |ui| {
        egui::Grid::new("keys").num_columns(2).spacing(Vec2::new(26.0, 3.0)).show(ui, |ui| {
            let row = |ui: &mut Ui, keys: &str, what: &str| {
                ui.label(RichText::new(keys).color(ink(palette.strong)));
                ui.label(what);
                ui.end_row();
            };
            for (purpose, entries) in groups() {
                let head = RichText::new(purpose.name()).font(theme::semibold(theme::BODY));
                ui.label(head.color(ink(palette.weak)));
                ui.end_row();
                entries.iter().for_each(|(keys, command)| row(ui, keys, &command.name()));
                if purpose == Purpose::Views {
                    for (keys, what) in [
                        ("drag, middle drag", "Move the mesh"),
                        ("wheel, pinch", "Zoom at the pointer"),
                        ("right drag", "Turn the mesh; F looks straight down again"),
                        ("click, double click", "Select; show in the middle"),
                    ] {
                        row(ui, keys, what);
                    }
                }
            }
        });
    });
}
