//! The case of a CAD file: its faces and curves as text, with the sizes of the import options.

use std::path::Path;

use super::{Case, ImportOptions, VERSION};
use crate::core::fault::{Fault, FaultKind};
use crate::core::progress::Pace;
use crate::core::step::{self, Part};

/// Without a size, elements are as large as this fraction of the diagonal where nothing bends, and at most as long as
/// the shorter edges.
const SIZE: f64 = 1.0 / 30.0;
/// Without a size, the distance between chord and arc, divided by the radius.
const CHORD: f64 = 0.03;

impl ImportOptions {
    /// The case of a STEP file, and the part that it has: all of the part is in the text of the case. `name` is that of
    /// the case, `place` that of the file in messages. Without [`ImportOptions::mesh_size`] sizes follow the curvature.
    ///
    /// # Errors
    /// Options for meshes, and those of [`step::read`].
    pub fn case_of_step(&self, bytes: &[u8], name: &str, place: &str, pace: &dyn Pace) -> Result<(Case, Part), Fault> {
        self.check_for_step().map_err(|fault| fault.at(place))?;
        let part = step::read(place, bytes, &self.step, pace)?;
        let text = self.text_of(&part, place);
        let mut case = Case::parse(&text, name, place, Path::new(""))?;
        case.told.clone_from(&part.told);
        Ok((case, part))
    }

    /// Refuses options that mean nothing for surfaces.
    ///
    /// # Errors
    /// The first of them, with what to do instead.
    pub fn check_for_step(&self) -> Result<(), Fault> {
        let for_meshes = ["use", "split_odd", "feature_angle", "chart_stretch", "scale", "ignore_groups", "weld"];
        let Some((key, _)) = self.lines().into_iter().find(|line| for_meshes.contains(&line.0)) else { return Ok(()) };
        let option = format!("--{}", key.replace('_', "-"));
        let remedy = if key == "scale" { "Give the unit that you want: --unit m" } else { "Leave it out" };
        Err(Fault::new(format!("{option} applies to meshes, and this is a CAD file"))
            .of_kind(FaultKind::Parameter)
            .remedy(remedy))
    }

    /// The text of the case of a part.
    fn text_of(&self, part: &Part, place: &str) -> String {
        let file = Path::new(place).file_name().unwrap_or_default().to_string_lossy();
        let quoted = |text: String| toml::Value::String(text).to_string();
        let count = |n: usize, of: &str| format!("{n} {of}{}", if n == 1 { "" } else { "s" });
        let mut notes = format!(
            "Read from {file} ({}): {}, {}; lengths in {}.",
            part.schema,
            count(part.spec.faces.len(), "face"),
            count(part.spec.curves.len(), "edge"),
            part.unit
        );
        part.told.iter().for_each(|sentence| notes.push_str(&format!("\n- {sentence}")));
        let chord = self.chord.map_or_else(String::new, |chord| format!("chord = {chord:?}\n"));
        let tolerance = part.spec.tolerance.map_or_else(String::new, |most| format!("tolerance = {most:?}\n"));
        let sized = match self.mesh_size {
            Some(_) => self.clone(),
            None => ImportOptions {
                mesh_size: Some(rounded((SIZE * part.diagonal).min(part.short_edge))),
                curvature: Some(CHORD),
                ..self.clone()
            },
        };
        let metric =
            sized.lines().into_iter().find(|line| line.0 == "[[metric]]").map(|line| line.1).unwrap_or_default();
        format!(
            "version = {VERSION}\ntitle = {}\nnotes = {}\n{tolerance}{chord}\n{metric}\n{}",
            quoted(format!("Part {file}")),
            quoted(notes),
            part.tables()
        )
    }
}

/// A number with two digits.
fn rounded(number: f64) -> f64 {
    format!("{number:.1e}").parse().unwrap_or(number)
}
