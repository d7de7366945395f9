//! The choice of the points that are merged.

use eframe::egui::Ui;

use super::{choice, number, row};
use crate::app::window::import::{Import, ImportOptions};
use crate::core::soup::Weld;
use crate::render::palette::Palette;

/// What is done with near points.
const MERGED: &str = "merged";
const MERGED_UP_TO: &str = "merged up to";
const KEPT_APART: &str = "kept apart";

/// Which points are merged.
pub fn form(ui: &mut Ui, options: &mut ImportOptions, import: &Import, dragging: &mut bool, palette: &Palette) {
    let tip = "Points of borders that are far closer to each other than the edges there are long are merged, or those up \
               to a distance, or none (--weld)";
    row(ui, "near points", tip, palette, |ui| {
        let word = |weld: Weld| match weld {
            Weld::Auto => MERGED,
            Weld::Within(distance) if distance > 0.0 => MERGED_UP_TO,
            Weld::Within(_) => KEPT_APART,
        };
        // A thousandth of an edge, with one digit, to start from.
        let edge = import.loaded.as_ref().map_or(1.0, |loaded| loaded.mean_edge * import.taking().scale);
        let start = match options.weld {
            Weld::Within(distance) if distance > 0.0 => distance,
            _ => format!("{:.0e}", 1e-3 * edge).parse().unwrap_or(1e-3),
        };
        let all = [Weld::Auto, Weld::Within(start), Weld::Within(0.0)].map(|weld| (weld, word(weld)));
        let now = word(options.weld);
        choice(ui, "Near points", 112.0, now, &mut options.weld, all);
        if let Weld::Within(distance) = &mut options.weld
            && *distance > 0.0
        {
            let speed = 0.01 * *distance;
            *dragging |= number(ui, distance, [1e-12, 1e12], speed, "", "Distance of near points").dragged();
        }
    });
}
