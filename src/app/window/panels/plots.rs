//! Figs. 23 and 24 of the current state: edge lengths in the metric, least and greatest angles of the elements.

use eframe::egui::{RichText, Ui, Vec2b};
use egui_plot::{Bar, BarChart, Legend, Plot};

use super::line;
use crate::app::window::command::Command;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::mesh::ElementId;
use crate::render::palette::{Palette, Rgba};
use crate::render::scene::{Outlined, angles};

/// The greatest edge length of the bars, and how many bars there are.
const LONGEST: f64 = 3.0;
const BARS: usize = 36;

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = state.run().moment.as_deref() else { return };
    let half = 0.5 * (ui.available_height() - 60.0);
    let (edges, mean) = lengths(moment);
    head(
        ui,
        "Edge lengths in the metric, proportion of edges (fig. 23)",
        format!("mean {}, unit is 1", words::fixed(mean, 3)),
        palette,
    );
    let [dead, live] = edges;
    let all = dead.iter().chain(&live).sum::<u32>().max(1);
    let series = [("quads", dead, palette.front[1]), ("triangles", live, palette.hint)];
    if let Some([low, high]) = chart(ui, "lengths", half, [0.0, LONGEST], series, f64::from(all), palette) {
        let mesh = &moment.mesh;
        let fits = |length: f64| length >= low && (length < high || high >= LONGEST);
        let edges = mesh.edges().filter(|h| fits(mesh.length(*h)));
        let lit = edges.map(|h| Outlined::Edge(mesh.ends(h))).collect();
        light(commands, lit, &format!("edges of {} to {}", words::fixed(low, 2), words::fixed(high, 2)));
    }
    let (least, greatest, worst) = corner_angles(moment);
    let note = worst.map(|(e, angle)| format!("smallest {}°, of element {}", words::degrees(angle), e.0));
    if head(ui, "Smallest and largest angle of each quad, degrees (fig. 24)", note.unwrap_or_default(), palette)
        && let Some((e, _)) = worst
    {
        commands.push(Command::Pick(Some(Outlined::Element(e))));
    }
    let series = [("least", least, palette.front[1]), ("greatest", greatest, palette.front[2])];
    if let Some([low, high]) = chart(ui, "angles", half, [0.0, 180.0], series, 1.0, palette) {
        let mesh = &moment.mesh;
        let fits = |angle: f64| (low..high).contains(&angle.to_degrees());
        let quads = mesh.elements().filter(|e| mesh.is_quad(*e) && angles(mesh, *e).into_iter().any(fits));
        let lit = quads.map(Outlined::Element).collect();
        let what = format!("quads with an angle from {}° to {}°", words::fixed(low, 0), words::fixed(high, 0));
        light(commands, lit, &what);
    }
}

/// Highlights what a bar stands for.
fn light(commands: &mut Vec<Command>, lit: Vec<Outlined>, what: &str) {
    let notice = format!("{} {what} are highlighted in the views.", words::grouped(lit.len() as u64));
    commands.push(Command::LightUp(lit, notice));
}

/// The heading of a plot. Returns whether its note was clicked.
fn head(ui: &mut Ui, title: &str, note: String, palette: &Palette) -> bool {
    let mut clicked = false;
    ui.horizontal(|ui| {
        ui.set_height(26.0);
        ui.add_space(12.0);
        ui.label(RichText::new(title).font(theme::semibold(theme::BODY)).color(ink(palette.strong)));
        if !note.is_empty() {
            clicked = ui.link(line(note, palette.weak)).clicked();
        }
    });
    clicked
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
    let at = shown.response.interact_pointer_pos().filter(|_| shown.response.clicked())?;
    let x = shown.transform.value_from_position(at).x;
    let bar = ((x - range[0]) / width).floor();
    (0.0..BARS as f64).contains(&bar).then(|| [range[0] + bar * width, range[0] + (bar + 1.0) * width])
}

/// Counts of edges of quadrilaterals and of live triangles by metric length, and the mean length of all.
fn lengths(moment: &Moment) -> ([Vec<u32>; 2], f64) {
    let mut counts = [vec![0; BARS], vec![0; BARS]];
    let (mut sum, mut number) = (0.0, 0);
    for h in moment.mesh.edges() {
        let length = moment.mesh.length(h);
        let dead =
            moment.mesh.is_quad(h.element()) || moment.mesh.twin(h).is_some_and(|t| moment.mesh.is_quad(t.element()));
        let bar = ((length / LONGEST * BARS as f64) as usize).min(BARS - 1);
        counts[usize::from(!dead)][bar] += 1;
        (sum, number) = (sum + length, number + 1);
    }
    (counts, sum / f64::from(number.max(1)))
}

type Worst = Option<(ElementId, f64)>;

/// Counts of quadrilaterals by their least and greatest angles in the plane, and the one with the least.
fn corner_angles(moment: &Moment) -> (Vec<u32>, Vec<u32>, Worst) {
    let (mut least, mut greatest) = (vec![0; BARS], vec![0; BARS]);
    let mut worst: Worst = None;
    for e in moment.mesh.elements().filter(|e| moment.mesh.is_quad(*e)) {
        let [low, high] = angles(&moment.mesh, e);
        let bar = |angle: f64| ((angle / std::f64::consts::PI * BARS as f64).max(0.0) as usize).min(BARS - 1);
        least[bar(low)] += 1;
        greatest[bar(high)] += 1;
        if worst.is_none_or(|w| low < w.1) {
            worst = Some((e, low));
        }
    }
    (least, greatest, worst)
}
