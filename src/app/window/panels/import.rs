//! The import of a mesh file: the options of the command line as a form, what the mesh is like, and what was repaired.

use eframe::egui::{
    self, Align, Button, DragValue, Frame, Grid, Layout, Panel, ProgressBar, Response, RichText, Role, ScrollArea,
    Sense, Slider, SliderClamping, Ui, Vec2, WidgetInfo,
};

mod near_points;
mod part;

use super::{choice, heading, inset, line, note, on_click};
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::import::{Gesture, Import, ImportOptions, KINDS, Shown, UNITS};
use crate::app::window::state::{Progress, State};
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::case::{MeshUse, Taking};
use crate::core::discrete::Feature;
use crate::core::geometry::ShapeLimits;
use crate::core::kernel::Shortest;
use crate::core::soup::{Ignored, NOT_JOINED, NOT_READ, Weld};
use crate::render::palette::{Palette, Rgba};
use crate::render::scene::{feature_line, seam_line};

/// Width of the panel, and of the names of its rows.
const WIDTH: f32 = 344.0;
const NAMES: f32 = 92.0;
/// The names of the uses of a mesh, and of the permission to divide a side.
const REMESH: &str = "remesh its shape";
const TRIANGLES: &str = "convert its triangles";
const SPLIT_ODD: &str = "divide a side of odd borders";
/// The name of the permission to ignore groups.
const IGNORE_GROUPS: &str = "ignore";
/// The first chord error when the user asks for sizes by curvature: the distance of a chord from its arc, over the
/// radius.
const CHORD: f64 = 0.01;

/// How the sizes of elements are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sizing {
    OfMesh,
    Uniform,
    ByCurvature,
}

/// Shows it at the left of the view.
pub fn show(ui: &mut Ui, state: &State, plain: Frame, commands: &mut Vec<Command>, palette: &Palette) {
    let is_opening = state.run().is_opening();
    let opening = state.run().progress.clone().filter(|_| is_opening);
    let Some(import) = &state.run().import else { return };
    let progress = if is_opening { opening } else { import.progress.clone() };
    Panel::left("import").exact_size(WIDTH).resizable(false).frame(plain).show(ui, |ui| {
        Panel::bottom("import buttons").resizable(false).frame(inset()).show(ui, |ui| {
            under_way(ui, import, is_opening, progress.as_ref(), palette);
            buttons(ui, import, is_opening, commands);
        });
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            inset().show(ui, |ui| {
                ui.set_width(WIDTH - 28.0);
                title(ui, import, palette);
                refusal(ui, import, palette);
                ui.add_enabled_ui(!is_opening, |ui| form(ui, import, commands, palette));
                counts(ui, import, palette);
            });
        });
    });
}

fn title(ui: &mut Ui, import: &Import, palette: &Palette) {
    let name = import.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    ui.add_space(2.0);
    let text = RichText::new(name).font(theme::semibold(theme::TITLE)).color(ink(palette.strong));
    ui.add(egui::Label::new(text).truncate()).on_hover_text(import.path.display().to_string());
    let kind = if import.is_part() {
        "Faces on exact surfaces: choose the unit and the sizes."
    } else {
        "A mesh without CAD: choose how to import it."
    };
    ui.label(note(kind, palette));
}

/// Why the mesh was refused, and what to do.
fn refusal(ui: &mut Ui, import: &Import, palette: &Palette) {
    let Some(fault) = &import.refused else { return };
    heading(ui, "Refused", "", palette);
    ui.horizontal_top(|ui| {
        ui.label(RichText::new(icons::X_CIRCLE).font(theme::regular(theme::ICON)).color(ink(palette.broken)));
        ui.vertical(|ui| {
            ui.add(egui::Label::new(RichText::new(format!("{}.", fault.what)).color(ink(palette.strong))).wrap());
            if !fault.remedy.is_empty() {
                let remedy = RichText::new(format!("{}.", in_the_panel(&fault.remedy))).color(ink(palette.text));
                ui.add(egui::Label::new(remedy).wrap());
            }
            let name = import.path.display().to_string();
            let place = fault.place.strip_prefix(&name).unwrap_or(&fault.place).trim_start_matches([',', ' ']);
            if !place.is_empty() {
                ui.add(egui::Label::new(note(place, palette)).wrap());
            }
        });
    });
    if !fault.shapes.is_empty() {
        swatch(ui, (palette.broken, 3.2), "offending elements".to_owned(), palette);
    }
}

/// A remedy, with the panel's names in place of the command line's options.
fn in_the_panel(remedy: &str) -> String {
    let words =
        [("(--use shape)", REMESH), ("(--split-odd)", SPLIT_ODD), ("with --skip-bad-faces", part::SKIP_BAD_FACES)];
    words.into_iter().fold(remedy.to_owned(), |text, (option, word)| text.replace(option, &format!("(below: {word})")))
}

/// A row of the form: its name and its widgets.
fn row(ui: &mut Ui, name: &str, tip: &str, palette: &Palette, widgets: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| {
        ui.set_height(24.0);
        ui.allocate_ui_with_layout(Vec2::new(NAMES, 24.0), Layout::left_to_right(Align::Center), |ui| {
            ui.set_width(NAMES);
            ui.label(RichText::new(name).color(ink(palette.text))).on_hover_text(tip);
        });
        widgets(ui);
    });
}

/// A number that can be dragged and typed.
fn number(ui: &mut Ui, value: &mut f64, [least, most]: [f64; 2], speed: f64, unit: &str, name: &str) -> Response {
    let before = *value;
    let field = DragValue::new(value)
        .speed(speed)
        .suffix(unit)
        .max_decimals(12)
        .custom_formatter(|value, _| Shortest(value).to_string())
        .update_while_editing(false);
    let response = ui.add_sized(Vec2::new(84.0, 22.0), field);
    response.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, name));
    // A range of the field would clamp what was given elsewhere, too.
    if *value != before {
        *value = if value.is_nan() { before } else { value.clamp(least, most) };
    }
    response
}

fn form(ui: &mut Ui, import: &Import, commands: &mut Vec<Command>, palette: &Palette) {
    let mut options = import.options.clone();
    let mut dragging = false;
    heading(ui, "Import", "as on the command line", palette);
    ui.spacing_mut().item_spacing.y = 5.0;
    if import.is_part() {
        part::form(ui, &mut options, import, &mut dragging, palette);
    } else {
        form_of_mesh(ui, &mut options, import, &mut dragging, palette);
    }
    // The end of a drag is reported too.
    let gesture = if dragging { Gesture::Dragging } else { Gesture::Done };
    if options != import.options || import.gesture != gesture {
        commands.push(Command::SetImport(Box::new(options), gesture));
    }
}

/// The options of a mesh.
fn form_of_mesh(ui: &mut Ui, options: &mut ImportOptions, import: &Import, dragging: &mut bool, palette: &Palette) {
    let taking = import.taking();
    unit(ui, options, &taking, dragging, palette);
    // Once groups are ignored, the mesh has none.
    let has_groups = import.loaded.as_ref().is_some_and(|loaded| loaded.has_groups);
    if has_groups || options.ignore_groups != Ignored::Nothing {
        groups(ui, options, palette);
    }
    near_points::form(ui, options, import, dragging, palette);
    used(ui, options, import, palette);
    sizes(ui, options, import, dragging, palette);
    let charted = import.has_charts();
    ui.add_enabled_ui(charted, |ui| {
        let defaults = Taking::default();
        let tip = "Folds beyond this angle are edges to keep (--feature-angle)";
        row(ui, "feature angle", tip, palette, |ui| {
            let default = hundredths(defaults.feature_angle.to_degrees());
            let before = options.feature_angle.unwrap_or(default);
            let mut degrees = before;
            *dragging |= measure(ui, &mut degrees, Taking::ANGLES, false, "°", "Feature angle");
            if degrees != before {
                options.feature_angle = unless_default(degrees, default);
            }
        });
        let tip = "How far shapes may be stretched when the surface is flattened (--chart-stretch)";
        row(ui, "chart stretch", tip, palette, |ui| {
            let before = taking.chart_stretch;
            let mut stretch = before;
            *dragging |= measure(ui, &mut stretch, Taking::STRETCHES, true, "", "Chart stretch");
            if stretch != before {
                options.chart_stretch = unless_default(stretch, defaults.chart_stretch);
            }
        });
    });
    if !charted && import.loaded.is_some() {
        let text = "Triangles in the plane are converted as they are: features and charts are not needed.";
        ui.label(note(text, palette));
    }
}

/// A slider with its number. Returns whether one of them is being dragged.
fn measure(ui: &mut Ui, value: &mut f64, range: [f64; 2], logarithmic: bool, unit: &str, name: &str) -> bool {
    ui.spacing_mut().slider_width = 104.0;
    let slider = Slider::new(value, range[0]..=range[1]).logarithmic(logarithmic).clamping(SliderClamping::Edits);
    let slider = ui.add(slider.show_value(false));
    slider.widget_info(|| WidgetInfo::slider(true, *value, format!("{name} slider")));
    if slider.changed() {
        *value = hundredths(*value);
    }
    let typed = number(ui, value, range, (range[1] - range[0]) / 400.0, unit, name);
    slider.dragged() || typed.dragged()
}

fn hundredths(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// A default needs no option.
fn unless_default(value: f64, default: f64) -> Option<f64> {
    (value != default).then_some(value)
}

fn unit(ui: &mut Ui, options: &mut ImportOptions, taking: &Taking, dragging: &mut bool, palette: &Palette) {
    let mut scale = taking.scale;
    row(ui, "unit", "The unit of lengths after scaling (--scale)", palette, |ui| {
        // The conversions that users think of; some have the same scale.
        let mut known: Vec<(f64, String)> = vec![(1.0, "as in the file".to_owned())];
        for (to, metres) in [UNITS[2], UNITS[0]] {
            let others = UNITS.iter().filter(|unit| unit.0 != to);
            known.extend(others.map(|&(from, own)| (rounded(own / metres), format!("{from} to {to}"))));
        }
        let now = known.iter().find(|unit| unit.0 == scale).map_or("other", |unit| unit.1.as_str()).to_owned();
        choice(ui, "Unit", 112.0, now, &mut scale, known);
        ui.label(note("×", palette));
        let speed = 0.01 * scale;
        *dragging |= number(ui, &mut scale, Taking::SCALES, speed, "", "Scale").dragged();
    });
    if scale != taking.scale {
        options.scale = unless_default(scale, 1.0);
        // Sizes are in the scaled unit.
        if let Weld::Within(distance) = &mut options.weld {
            *distance = rounded(*distance * scale / taking.scale);
        }
        options.mesh_size = options.mesh_size.map(|size| rounded(size * scale / taking.scale));
    }
}

fn groups(ui: &mut Ui, options: &mut ImportOptions, palette: &Palette) {
    let tip = "Read the mesh as if it had no groups, so that none divides it (--ignore-groups)";
    row(ui, "groups", tip, palette, |ui| {
        let before = options.ignore_groups == Ignored::All;
        let mut all = before;
        ui.checkbox(&mut all, IGNORE_GROUPS).on_hover_text(tip);
        if all != before {
            options.ignore_groups = if all { Ignored::All } else { Ignored::Nothing };
        }
        // Some of them are named on the command line.
        if let Ignored::Named(names) = &options.ignore_groups {
            ui.add(egui::Label::new(note(format!("without {}", names.join(", ")), palette)).truncate());
        }
    });
}

/// Rounds to twelve digits, as a person would write the number.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

fn used(ui: &mut Ui, options: &mut ImportOptions, import: &Import, palette: &Palette) {
    let now = import.used();
    let words = [(MeshUse::Shape, REMESH), (MeshUse::Triangles, TRIANGLES)];
    for (k, (use_, text)) in words.into_iter().enumerate() {
        row(ui, if k == 0 { "use" } else { "" }, "What the mesh is used for (--use)", palette, |ui| {
            if ui.radio(now == use_, text).clicked() && now != use_ {
                options.used = (use_ != import.use_by_default()).then_some(use_);
            }
        });
    }
    if now == MeshUse::Triangles {
        let tip = "Quadrilaterals need an even number of sides around the mesh and around each hole. If the number is \
                   odd, the longest side is divided in two; otherwise such a mesh is refused (--split-odd)";
        row(ui, "", tip, palette, |ui| {
            ui.checkbox(&mut options.split_odd, SPLIT_ODD).on_hover_text(tip);
        });
    }
}

fn sizes(ui: &mut Ui, options: &mut ImportOptions, import: &Import, dragging: &mut bool, palette: &Palette) {
    let Some(loaded) = &import.loaded else { return };
    let before = match (options.mesh_size, options.curvature) {
        (None, _) => Sizing::OfMesh,
        (Some(_), None) => Sizing::Uniform,
        (Some(_), Some(_)) => Sizing::ByCurvature,
    };
    let own = match (&loaded.part, loaded.has_metric) {
        (Some(_), _) => "by its curvature and edges",
        (None, true) => "as given in the mesh",
        (None, false) => "as its triangles",
    };
    let mut wanted = before;
    row(ui, "size", "The size of elements (--mesh-size, --curvature)", palette, |ui| {
        let name = |sizing: Sizing| match sizing {
            Sizing::OfMesh => own,
            Sizing::Uniform => "the same everywhere",
            Sizing::ByCurvature => "finer where it is curved",
        };
        let all = [Sizing::OfMesh, Sizing::Uniform, Sizing::ByCurvature].map(|sizing| (sizing, name(sizing)));
        choice(ui, "Size of elements", 180.0, name(before), &mut wanted, all);
    });
    if wanted != before {
        // Two digits are enough to start from.
        let mean = loaded.mean_edge * import.taking().scale;
        let plain: f64 = format!("{mean:.1e}").parse().unwrap_or(mean);
        options.mesh_size = (wanted != Sizing::OfMesh).then(|| options.mesh_size.unwrap_or(plain));
        options.curvature = (wanted == Sizing::ByCurvature).then_some(CHORD);
    }
    if let Some(size) = &mut options.mesh_size {
        let name = if options.curvature.is_some() { "where flat" } else { "edge length" };
        row(ui, name, "In the unit of the scaled mesh", palette, |ui| {
            let speed = 0.01 * *size;
            *dragging |= number(ui, size, [1e-12, 1e12], speed, "", "Edge length").dragged();
        });
    }
    if let Some(chord) = &mut options.curvature {
        row(ui, "chord error", "How far a chord may be from its arc, over the radius", palette, |ui| {
            *dragging |= number(ui, chord, [1e-6, 0.5], 0.0002, "", "Chord error").dragged();
        });
    }
    // Given triangles keep their borders as they are.
    if import.used() == MeshUse::Shape {
        let tip = "How far a chord may be from a border, over the radius, whatever the sizes are (--chord)";
        row(ui, "border error", tip, palette, |ui| {
            let before = options.chord.unwrap_or(ShapeLimits::CHORD);
            let mut chord = before;
            *dragging |= number(ui, &mut chord, [1e-6, 1.0], 0.001, "", "Border error").dragged();
            if chord != before {
                options.chord = unless_default(chord, ShapeLimits::CHORD);
            }
        });
    }
}

fn counts(ui: &mut Ui, import: &Import, palette: &Palette) {
    let Some(loaded) = &import.loaded else { return };
    heading(ui, if loaded.part.is_some() { "The part" } else { "The mesh" }, "", palette);
    let grouped = |n: usize| words::grouped(n as u64);
    let census = loaded.census;
    let extent = loaded.extent * import.taking().scale;
    let grid = Grid::new("counts").num_columns(2).striped(false).spacing(Vec2::new(12.0, 4.0)).min_col_width(NAMES);
    grid.show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(note(name, palette));
            ui.add(egui::Label::new(line(value, palette.text)).wrap());
            ui.end_row();
        };
        row("extent", extent.to_array().map(three_digits).join(" × "));
        if let Some(part) = &loaded.part {
            part::counts(part, &mut row);
            row("boundary loops", grouped(census.border_loops));
            return;
        }
        row("nodes", grouped(census.nodes));
        row("triangles", grouped(census.triangles));
        row("components", grouped(census.components));
        row("boundary loops", grouped(census.border_loops));
        if loaded.regions > 1 {
            row("regions", grouped(loaded.regions));
        }
    });
    let Some(shown) = &import.shown else { return };
    ui.add_space(6.0);
    if loaded.part.is_none() {
        features(ui, shown, palette);
    }
    divisions(ui, import, shown, palette);
    let is_repair = |told: &&String| ![NOT_READ, NOT_JOINED].iter().any(|other| told.starts_with(other));
    let repaired = loaded.repairs.iter().filter(is_repair).map(String::as_str).collect();
    let not_joined = loaded.repairs.iter().filter_map(|told| told.strip_prefix(NOT_JOINED)).collect();
    let not_read = loaded.repairs.iter().filter_map(|told| told.strip_prefix(NOT_READ)).collect();
    let title = if loaded.part.is_some() { "Told" } else { "Repaired" };
    told(ui, title, (icons::CHECK, palette.holds), repaired, palette);
    told(ui, "Not joined", (icons::X, palette.broken), not_joined, palette);
    told(ui, "Not read", (icons::X, palette.text), not_read, palette);
}

/// A list under a heading, each with an icon; nothing without entries.
fn told(ui: &mut Ui, title: &str, (icon, colour): (&str, Rgba), entries: Vec<&str>, palette: &Palette) {
    if entries.is_empty() {
        return;
    }
    heading(ui, title, "", palette);
    for entry in entries {
        ui.horizontal(|ui| {
            ui.label(RichText::new(icon).font(theme::regular(theme::TABLE)).color(ink(colour)));
            ui.add(egui::Label::new(line(entry.to_owned(), palette.text)).wrap());
        });
    }
}

/// The features of a mesh, by kind.
fn features(ui: &mut Ui, shown: &Shown, palette: &Palette) {
    let named = named_count;
    for (kind, count) in KINDS.into_iter().zip(shown.counts) {
        let (one, several) = match kind {
            Feature::Fold => ("feature edge", "feature edges"),
            Feature::Region => ("edge between regions", "edges between regions"),
            Feature::Line => ("edge on a line of the file", "edges on lines of the file"),
            Feature::Boundary => ("edge of the boundary", "edges of the boundary"),
            Feature::Branching => ("edge of three triangles or more", "edges of three triangles or more"),
            Feature::Conflict => ("edge with inconsistent triangles", "edges with inconsistent triangles"),
        };
        if count > 0 || kind == Feature::Fold {
            swatch(ui, feature_line(palette, kind), named(count, one, several), palette);
        }
    }
}

/// A number with what is counted.
fn named_count(n: usize, one: &str, several: &str) -> String {
    format!("{} {}", words::grouped(n as u64), if n == 1 { one } else { several })
}

/// The charts of a mesh, or the faces of a part, in their colours.
fn divisions(ui: &mut Ui, import: &Import, shown: &Shown, palette: &Palette) {
    let named = named_count;
    match &shown.division {
        Some(division) => {
            let seams = division.seams.len();
            if seams > 0 {
                let text = named(seams, "edge cut for the plane", "edges cut for the plane");
                swatch(ui, seam_line(palette), text, palette);
            }
            ui.horizontal(|ui| {
                let (rect, _) = ui.allocate_exact_size(Vec2::new(30.0, 16.0), Sense::hover());
                let count = division.charts.min(palette.charts.len());
                let width = 30.0 / count.max(1) as f32;
                for (k, colour) in palette.charts.iter().take(count).enumerate() {
                    let part =
                        egui::Rect::from_min_size(rect.min + Vec2::new(k as f32 * width, 2.0), Vec2::new(width, 12.0));
                    ui.painter().rect_filled(part, 0.0, ink(*colour));
                }
                let [one, several] = if import.is_part() { ["face", "faces"] } else { ["chart", "charts"] };
                ui.label(line(named(division.charts, one, several), palette.text));
            });
        }
        None if import.has_charts() && import.refused.is_none() => {
            ui.label(note("The charts are being computed.", palette));
        }
        None => {}
    }
}

/// A line as the view draws it, with its meaning.
fn swatch(ui: &mut Ui, (colour, width): (Rgba, f32), text: String, palette: &Palette) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(Vec2::new(30.0, 16.0), Sense::hover());
        ui.painter().hline(rect.x_range(), rect.center().y, (width, ink(colour)));
        ui.label(line(text, palette.text));
    });
}

fn three_digits(value: f64) -> String {
    Shortest(format!("{value:.2e}").parse().unwrap_or(value)).to_string()
}

/// The progress of the work. It always takes its room, so that no button moves from under the pointer.
fn under_way(ui: &mut Ui, import: &Import, is_opening: bool, progress: Option<&Progress>, palette: &Palette) {
    let (rect, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), 30.0), Sense::hover());
    let text = match progress {
        Some(progress) => words::progress(progress),
        None if is_opening => "Converting".to_owned(),
        None if import.is_behind() => "Reading".to_owned(),
        None => return,
    };
    let share = match progress {
        Some(Progress { done, total, .. }) if *total > 0 => (*done as f32 / *total as f32).clamp(0.0, 1.0),
        _ => 0.0,
    };
    ui.scope_builder(egui::UiBuilder::new().max_rect(rect), |ui| {
        ui.label(note(text, palette));
        let bar = ProgressBar::new(share).desired_height(3.0).corner_radius(0.0).fill(ink(palette.base));
        ui.add(bar).widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, "Progress"));
    });
}

fn buttons(ui: &mut Ui, import: &Import, is_opening: bool, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let ready = import.is_ready() && !is_opening;
        let convert = Button::new(RichText::new("Convert").font(theme::semibold(theme::BODY)));
        on_click(&ui.add_enabled(ready, convert.min_size(Vec2::new(120.0, 28.0))), Command::Convert, commands);
        let cancel = Button::new("Cancel").min_size(Vec2::new(84.0, 28.0));
        let tip = if is_opening { "Back to the import" } else { "Do not import this mesh  (Esc)" };
        on_click(&ui.add(cancel).on_hover_text(tip), Command::CancelImport, commands);
    });
    ui.add_space(4.0);
}
