//! How the file of a mesh is read: its unit, groups and near points.

use eframe::egui::{self, Ui};

use super::{number, rounded, row, unless_default};
use crate::app::window::import::{Import, ImportOptions, UNITS};
use crate::app::window::panels::{choice, note};
use crate::core::case::Taking;
use crate::core::soup::{Ignored, Weld};
use crate::render::palette::Palette;

/// The name of the permission to ignore groups.
const IGNORE_GROUPS: &str = "ignore";
/// What is done with near points.
const JOINED: &str = "joined";
const JOINED_UP_TO: &str = "joined up to";
const KEPT_APART: &str = "kept apart";

pub(super) fn unit(ui: &mut Ui, options: &mut ImportOptions, taking: &Taking, dragging: &mut bool, palette: &Palette) {
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
        options.mesh_size = options.mesh_size.map(|size| rounded(size * scale / taking.scale));
    }
}

pub(super) fn groups(ui: &mut Ui, options: &mut ImportOptions, palette: &Palette) {
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

/// How near points are joined.
pub(super) fn near(ui: &mut Ui, options: &mut ImportOptions, import: &Import, dragging: &mut bool, palette: &Palette) {
    let tip = "Points that are far closer to each other than the edges are long are joined, or those up to a distance, \
               or none (--weld)";
    row(ui, "near points", tip, palette, |ui| {
        let words = [JOINED, JOINED_UP_TO, KEPT_APART];
        let before = match options.weld {
            Weld::Auto => 0,
            Weld::Within(distance) if distance > 0.0 => 1,
            Weld::Within(_) => 2,
        };
        let mut now = before;
        let all = (0..words.len()).map(|k| (k, words[k]));
        choice(ui, "Near points", 112.0, words[before], &mut now, all);
        if now != before {
            let edge = import.loaded.as_ref().map_or(0.0, |loaded| loaded.mean_edge * import.taking().scale);
            // A thousandth of an edge, with one digit, to start from.
            let start = format!("{:.0e}", 1e-3 * edge).parse().unwrap_or(1e-6);
            options.weld = [Weld::Auto, Weld::Within(start), Weld::Within(0.0)][now];
        }
        if let Weld::Within(distance) = &mut options.weld
            && *distance > 0.0
        {
            let speed = 0.01 * *distance;
            *dragging |= number(ui, distance, [1e-12, 1e12], speed, "", "Distance of near points").dragged();
        }
    });
}
