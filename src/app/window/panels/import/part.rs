//! The import of a CAD file: the unit, the sizes, and whether faces may be left out.

use eframe::egui::Ui;

use super::{choice, row, sizes};
use crate::app::window::import::{Import, ImportOptions, PartFacts};
use crate::app::window::words;
use crate::core::step::Unit;
use crate::render::palette::Palette;

/// The name of the permission to leave out faces.
pub(super) const SKIP_BAD_FACES: &str = "leave out bad faces";

/// The options of a CAD file.
pub(super) fn form(ui: &mut Ui, options: &mut ImportOptions, import: &Import, dragging: &mut bool, palette: &Palette) {
    row(ui, "unit", "The unit of the coordinates of the result (--unit)", palette, |ui| {
        let own = import.loaded.as_ref().and_then(|loaded| loaded.part.as_ref()).map(|part| part.unit.clone());
        let of_file = match (own, options.step.unit) {
            (Some(own), None) => format!("that of the file ({own})"),
            _ => "that of the file".to_owned(),
        };
        let mut known = vec![(None, of_file)];
        known.extend(Unit::ALL.map(|unit| (Some(unit), unit.word().to_owned())));
        let now = known.iter().find(|unit| unit.0 == options.step.unit).map_or(String::new(), |unit| unit.1.clone());
        let before = options.step.unit;
        choice(ui, "Unit", 180.0, now, &mut options.step.unit, known);
        if options.step.unit != before {
            // A size in another unit would be of another order.
            (options.mesh_size, options.curvature) = (None, None);
        }
    });
    sizes(ui, options, import, dragging, palette);
    let tip = "Go on without the faces that cannot be taken, instead of refusing the file (--skip-bad-faces)";
    row(ui, "faces", tip, palette, |ui| {
        ui.checkbox(&mut options.step.skip_bad_faces, SKIP_BAD_FACES).on_hover_text(tip);
    });
}

/// Its rows of the table of counts.
pub(super) fn counts(part: &PartFacts, row: &mut impl FnMut(&str, String)) {
    row("unit", part.unit.clone());
    for (name, count) in [("faces", part.faces), ("edges", part.edges), ("bodies", part.bodies)] {
        row(name, words::grouped(count as u64));
    }
}
