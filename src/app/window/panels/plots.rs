//! Figs. 23 and 24 of the current state: edge lengths in the metric, smallest and largest angles of the quadrilaterals
//! in the metric; the lowest quality now and when quadrilaterals were formed. Each number leads to what has it.

mod numbers;

use std::sync::{Arc, Weak};

use eframe::egui::{Label, RichText, Role, ScrollArea, Ui, Vec2b, WidgetInfo};
use egui_plot::{Bar, BarChart, Legend, Plot};

use super::{inset, line, note};
use crate::app::window::command::Command;
use crate::app::window::session::{Goal, Moment};
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::mesh::ElementId;
use crate::render::palette::{Palette, Rgba};
use crate::render::scene::{Outlined, metric_angles};
use numbers::{BARS, Extremes, LONGEST, Numbers};

/// Height of all that is not a plot.
const WORDS: f32 = 196.0;

/// What the panel keeps for itself.
#[derive(Default)]
pub struct PlotsState {
    /// The state that was measured last; a weak reference, since its mesh is updated once nobody uses it.
    of: Weak<Moment>,
    numbers: Option<Numbers>,
}

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, local: &mut PlotsState, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = &state.run().moment else { return };
    if !std::ptr::eq(local.of.as_ptr(), Arc::as_ptr(moment)) {
        *local = PlotsState { of: Arc::downgrade(moment), numbers: None };
    }
    let numbers = local.numbers.get_or_insert_with(|| Numbers::of(moment));
    let half = 0.5 * (ui.available_height() - WORDS);
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        inset().show(ui, |ui| plots(ui, state, moment, numbers, half, commands, palette));
    });
}

fn plots(
    ui: &mut Ui,
    state: &State,
    moment: &Moment,
    numbers: &Numbers,
    half: f32,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    ui.spacing_mut().item_spacing.y = 2.0;
    head(ui, "Quality in the metric, 0 to 1", palette);
    quality(ui, state, moment, commands, palette);
    head(ui, "Edge lengths in the metric, proportion of edges (fig. 23)", palette);
    edges(ui, numbers, commands, palette);
    let [dead, live] = numbers.lengths.clone();
    let all = dead.iter().chain(&live).sum::<u32>().max(1);
    let series = [("quads", dead, palette.front[1]), ("triangles", live, palette.hint)];
    if let Some([low, high]) = chart(ui, "lengths", half, [0.0, LONGEST], series, f64::from(all), palette) {
        let mesh = &moment.mesh;
        let fits = |length: f64| length >= low && (length < high || high >= LONGEST);
        let edges = mesh.edges().filter(|h| fits(mesh.length(*h)));
        let lit = edges.map(|h| Outlined::Edge(mesh.ends(h))).collect();
        let what = format!("edges of {} to {} in the metric", words::fixed(low, 2), words::fixed(high, 2));
        light(commands, lit, &what);
    }
    head(ui, "Smallest and largest angle of each quad in the metric, degrees (fig. 24)", palette);
    angles(ui, "in the metric", numbers.in_metric, commands, palette);
    angles(ui, "in space", numbers.in_space, commands, palette);
    let [least, greatest] = numbers.angles.clone();
    let series = [("smallest", least, palette.front[1]), ("largest", greatest, palette.front[2])];
    if let Some([low, high]) = chart(ui, "angles", half, [0.0, 180.0], series, 1.0, palette) {
        let mesh = &moment.mesh;
        let fits = |angle: f64| angle.to_degrees() >= low && (angle.to_degrees() < high || high >= 180.0);
        let quads = mesh.elements().filter(|e| mesh.is_quad(*e) && metric_angles(mesh, *e).into_iter().any(fits));
        let lit = quads.map(Outlined::Element).collect();
        let what = format!(
            "quads whose smallest or largest angle in the metric is {}° to {}°",
            words::fixed(low, 0),
            words::fixed(high, 0)
        );
        light(commands, lit, &what);
    }
}

/// The lowest quality now, and of all quadrilaterals when they were formed.
fn quality(ui: &mut Ui, state: &State, moment: &Moment, commands: &mut Vec<Command>, palette: &Palette) {
    ui.horizontal_wrapped(|ui| {
        match moment.worst {
            Some((e, quality)) => {
                let text = format!("lowest now {}", words::fixed(quality, 2));
                let tip = format!("Select quadrilateral {}, which has it", e.0);
                link(ui, text, &tip, [Command::Pick(Some(Outlined::Element(e)))], commands, palette);
            }
            None => _ = ui.label(note("no quadrilaterals yet", palette)),
        }
        if let Some((step, e, quality)) = state.run().worst_formed(moment.step) {
            let text = format!("lowest when formed {}", words::fixed(quality, 2));
            let tip = format!(
                "Go to step {}, which formed quadrilateral {}. Those that close small loops are not counted",
                words::grouped(step),
                e.0
            );
            let asked = [Command::Go(Goal::Step(step)), Command::Pick(Some(Outlined::Element(e)))];
            link(ui, text, &tip, asked, commands, palette);
        }
    });
}

fn edges(ui: &mut Ui, numbers: &Numbers, commands: &mut Vec<Command>, palette: &Palette) {
    ui.horizontal_wrapped(|ui| {
        ui.label(note(format!("mean {}", words::fixed(numbers.mean, 2)), palette));
        for (name, (ends, length)) in ["shortest", "longest"].into_iter().zip(numbers.edges.into_iter().flatten()) {
            let text = format!("{name} {}", words::fixed(length, 2));
            let tip = format!("Select edge {}, which has this length", words::edge(ends));
            link(ui, text, &tip, [Command::Pick(Some(Outlined::Edge(ends)))], commands, palette);
        }
    });
}

fn angles(ui: &mut Ui, space: &str, extremes: Extremes<ElementId>, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(extremes) = extremes else { return };
    ui.horizontal_wrapped(|ui| {
        ui.label(note(space, palette));
        for (name, (e, angle)) in ["smallest", "largest"].into_iter().zip(extremes) {
            let text = format!("{name} {}°", words::degrees(angle));
            let tip = format!("Select quadrilateral {}, which has this angle {space}", e.0);
            link(ui, text, &tip, [Command::Pick(Some(Outlined::Element(e)))], commands, palette);
        }
    });
}

/// A number that leads to what has it.
fn link<const N: usize>(
    ui: &mut Ui,
    text: String,
    tip: &str,
    asked: [Command; N],
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    if ui.link(line(text, palette.text).underline()).on_hover_text(tip).clicked() {
        commands.extend(asked);
    }
}

/// Highlights what a bar stands for.
fn light(commands: &mut Vec<Command>, lit: Vec<Outlined>, what: &str) {
    let notice = format!("{} {what} are highlighted in the views.", words::grouped(lit.len() as u64));
    commands.push(Command::LightUp(lit, notice));
}

/// The heading of a plot.
fn head(ui: &mut Ui, title: &str, palette: &Palette) {
    ui.add_space(4.0);
    let text = RichText::new(title).font(theme::semibold(theme::BODY)).color(ink(palette.strong));
    ui.add(Label::new(text).wrap());
}

/// Shows bars as high as their counts divided by `unit`; the one under the pointer says its count. Returns the ends of
/// one that was clicked.
fn chart(
    ui: &mut Ui,
    id: &str,
    height: f32,
    range: [f64; 2],
    series: [(&str, Vec<u32>, Rgba); 2],
    unit: f64,
    palette: &Palette,
) -> Option<[f64; 2]> {
    let width = (range[1] - range[0]) / BARS as f64;
    let plot = Plot::new(id)
        .height(height.max(80.0))
        .allow_drag(false)
        .allow_scroll(false)
        .allow_zoom(false)
        .allow_boxed_zoom(false)
        .show_grid(Vec2b::FALSE)
        .legend(Legend::default())
        .include_x(range[0])
        .include_x(range[1]);
    let shown = plot.show(ui, |plot| {
        for (k, (name, counts, colour)) in series.into_iter().enumerate() {
            let fill = ink(colour);
            let bars = counts.iter().enumerate().map(|(i, count)| {
                let middle = range[0] + (i as f64 + 0.3 + 0.4 * k as f64) * width;
                let label = format!("{name}: {}", words::grouped(u64::from(*count)));
                Bar::new(middle, f64::from(*count) / unit).name(label).width(0.36 * width).fill(fill)
            });
            let colour = if colour == palette.hint { colour.faded(0.7) } else { colour };
            let chart = BarChart::new(name, bars.collect()).color(ink(colour));
            plot.bar_chart(chart.element_formatter(Box::new(|bar, _| bar.name.clone())));
        }
    });
    shown.response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, format!("Plot of {id}")));
    let at = shown.response.interact_pointer_pos().filter(|_| shown.response.clicked())?;
    let x = shown.transform.value_from_position(at).x;
    let bar = ((x - range[0]) / width).floor();
    (0.0..BARS as f64).contains(&bar).then(|| [range[0] + bar * width, range[0] + (bar + 1.0) * width])
}
