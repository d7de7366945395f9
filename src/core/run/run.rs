//! The run as a value: the case, everything else that determines its states, and what the user saves with it.

use std::sync::Arc;

use super::shown::Shown;
use crate::core::case::{Case, Parameters};
use crate::core::convert::{Converter, background};
use crate::core::fault::{Fault, FaultKind};
use crate::core::mesh::NodeId;
use crate::core::prepare::Background;
use crate::core::progress::Watch;

/// Parameters of the background mesh: they can change for a whole run only.
pub const OF_BACKGROUND: [&str; 4] = ["size_scale", "layered_loops", "faces", "max_quads"];

/// A change to the run at a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// The step from which on the change takes effect.
    pub step: u64,
    /// The change.
    pub kind: EditKind,
}

/// The change that an edit makes.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EditKind {
    /// A new value of a parameter, written as [`Parameters::set`] takes it.
    Parameter {
        /// Its key.
        key: String,
        /// Its value.
        value: String,
    },
    /// The next selection chooses the front segment from A to B.
    Base {
        /// Its left node.
        a: NodeId,
        /// Its right node.
        b: NodeId,
    },
}

impl EditKind {
    /// A change of a parameter, checked.
    ///
    /// # Errors
    /// An unknown key, a value of the wrong kind or out of range, a parameter of the background.
    pub fn parameter(key: &str, value: &str) -> Result<EditKind, Fault> {
        let mut parameters = Parameters::default();
        parameters.set(key, value)?;
        if OF_BACKGROUND.contains(&key) {
            return Err(Fault::new(format!("{key} belongs to the background mesh and cannot change at a step"))
                .of_kind(FaultKind::Parameter)
                .remedy("Change it for the whole run"));
        }
        // The canonical text, so that a saved run reads back unchanged.
        let value = parameters.text_of(key).unwrap_or_else(|| value.trim().to_owned());
        Ok(EditKind::Parameter { key: key.to_owned(), value })
    }

    /// Whether both change the same thing, so that the later one of a step replaces the earlier one.
    pub fn replaces(&self, other: &EditKind) -> bool {
        match (self, other) {
            (EditKind::Parameter { key, .. }, EditKind::Parameter { key: other, .. }) => key == other,
            (EditKind::Base { .. }, EditKind::Base { .. }) => true,
            _ => false,
        }
    }
}

/// A step with a note.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bookmark {
    /// The step.
    pub step: u64,
    /// What the user says of it, as Markdown.
    pub note: String,
}

/// The view of a state in plain numbers: `core` does not know what they mean on a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point at the centre of the view, in units of the case.
    pub target: [f64; 3],
    /// The orientation of the view: a unit quaternion (x, y, z, w).
    pub turn: [f64; 4],
    /// The height of the view, in units of the case.
    pub height: f64,
}

impl Camera {
    /// The turn of a view that looks straight down at the plane.
    pub const OF_THE_PLANE: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

    /// Whether the view looks straight down at the plane, as views of the plane do.
    pub fn is_of_the_plane(&self) -> bool {
        self.target[2] == 0.0 && self.turn == Camera::OF_THE_PLANE
    }
}

/// A run: its case, parameters and edits at steps determine each of its states, bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The case as in its file, with its text. A mesh that it names stays in its own file.
    pub case: Case,
    /// The parameters from step 0 on; they replace those of the case.
    pub parameters: Parameters,
    /// Sorted by step; edits of one step are in the order in which they are applied.
    edits: Vec<Edit>,
    /// Sorted by step.
    pub bookmarks: Vec<Bookmark>,
    /// The last view of it.
    pub camera: Option<Camera>,
    /// What the figure shows, where the run comes from a figure.
    pub shown: Option<Shown>,
}

impl Run {
    /// The run of a case, without changes.
    pub fn of(case: Case) -> Run {
        let parameters = case.parameters.clone();
        Run { case, parameters, edits: Vec::new(), bookmarks: Vec::new(), camera: None, shown: None }
    }

    /// The edits, sorted by step.
    pub fn edits(&self) -> &[Edit] {
        &self.edits
    }

    /// Replaces all edits; edits of one step keep their order.
    pub fn set_edits(&mut self, mut edits: Vec<Edit>) {
        edits.sort_by_key(|edit| edit.step);
        self.edits = edits;
    }

    /// The edits with one added; it replaces an edit of the same step that changes the same thing.
    pub fn edits_with(&self, edit: Edit) -> Vec<Edit> {
        let mut edits = self.edits.clone();
        edits.retain(|old| old.step != edit.step || !edit.kind.replaces(&old.kind));
        let place = edits.partition_point(|old| old.step <= edit.step);
        edits.insert(place, edit);
        edits
    }

    /// The edits of a step.
    pub fn edits_at(&self, step: u64) -> &[Edit] {
        let first = self.edits.partition_point(|edit| edit.step < step);
        let count = self.edits[first..].partition_point(|edit| edit.step == step);
        &self.edits[first..first + count]
    }

    /// The first step at which two lists of edits differ; `None` where they are equal.
    pub(super) fn first_difference(before: &[Edit], after: &[Edit]) -> Option<u64> {
        let same = before.iter().zip(after).take_while(|(a, b)| a == b).count();
        let steps = [before.get(same), after.get(same)];
        steps.into_iter().flatten().map(|edit| edit.step).min()
    }

    /// The parameters in force at a step, with its edits applied.
    ///
    /// # Errors
    /// An invalid edit.
    pub fn parameters_at(&self, step: u64) -> Result<Parameters, Fault> {
        let mut parameters = self.parameters.clone();
        for edit in self.edits.iter().take_while(|edit| edit.step <= step) {
            if let EditKind::Parameter { key, value } = &edit.kind {
                parameters.set(key, value).map_err(|fault| fault.at(format!("edit of step {}", edit.step)))?;
            }
        }
        Ok(parameters)
    }

    /// The case with the parameters of the run.
    pub fn case_in_force(&self) -> Case {
        Case { parameters: self.parameters.clone(), ..self.case.clone() }
    }

    /// Makes the background mesh of the run.
    ///
    /// # Errors
    /// As [`background`].
    pub fn background(&self, watch: &mut dyn Watch) -> Result<Background, Fault> {
        background(&self.case_in_force(), watch)
    }

    /// A converter at step 0, with the edits of step 0 applied.
    ///
    /// # Errors
    /// An invalid edit.
    pub fn start(&self, background: &Background) -> Result<Converter<'static>, Fault> {
        let sizing = Arc::new(background.sizing.clone());
        let mut converter = Converter::new(background.mesh.clone(), sizing, self.parameters.clone());
        self.make_edits(&mut converter, 0)?;
        Ok(converter)
    }

    /// Applies the edits of a step to a converter that has just reached it.
    ///
    /// # Errors
    /// An invalid edit.
    pub fn make_edits(&self, converter: &mut Converter<'_>, step: u64) -> Result<(), Fault> {
        let edits = self.edits_at(step);
        if edits.iter().any(|edit| matches!(edit.kind, EditKind::Parameter { .. })) {
            converter.set_parameters(self.parameters_at(step)?);
        }
        for edit in edits {
            if let EditKind::Base { a, b } = edit.kind {
                converter.pick(a, b);
            }
        }
        Ok(())
    }

    /// Applies parameters and edits to a keyframe, which is stored before the edits of its step.
    pub(super) fn enter(&self, converter: &mut Converter<'_>, step: u64) -> Result<(), Fault> {
        converter.set_parameters(self.parameters_at(step)?);
        self.make_edits(converter, step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;

    fn run() -> Run {
        Run::of(built_in::named("example1").unwrap().unwrap())
    }

    #[test]
    fn an_edit_replaces_one_of_its_step_that_changes_the_same_thing() {
        let mut run = run();
        for (step, key, value) in
            [(7, "c", "1.5"), (3, "theta_rect", "120"), (7, "theta_seam", "45"), (7, "c", "1.8"), (9, "c", "2.5")]
        {
            let edits = run.edits_with(Edit { step, kind: EditKind::parameter(key, value).unwrap() });
            run.set_edits(edits);
        }
        let steps: Vec<_> = run.edits().iter().map(|edit| edit.step).collect();
        assert_eq!(steps, [3, 7, 7, 9]);
        let c = |step| run.parameters_at(step).unwrap().c;
        assert_eq!([c(0), c(6), c(7), c(8), c(9)], [2.0, 2.0, 1.8, 1.8, 2.5]);
        assert_eq!(run.edits_at(7).len(), 2);
        assert_eq!(run.edits_at(8).len(), 0);
    }

    #[test]
    fn the_first_difference_of_two_lists_of_edits_is_the_first_step_where_they_differ() {
        let edit = |step, value| Edit { step, kind: EditKind::parameter("c", value).unwrap() };
        let (a, b, c) = (edit(3, "1.5"), edit(8, "1.6"), edit(8, "1.7"));
        assert_eq!(Run::first_difference(&[a.clone(), b.clone()], &[a.clone(), c.clone()]), Some(8));
        assert_eq!(Run::first_difference(&[a.clone(), b.clone()], std::slice::from_ref(&c)), Some(3));
        assert_eq!(Run::first_difference(&[a.clone(), b.clone()], std::slice::from_ref(&a)), Some(8));
        assert_eq!(Run::first_difference(std::slice::from_ref(&a), std::slice::from_ref(&a)), None);
    }

    #[test]
    fn parameters_of_the_background_cannot_change_at_a_step() {
        for (key, value) in [("size_scale", "0.5"), ("max_quads", "9"), ("faces", "left"), ("layered_loops", "hole")] {
            let fault = EditKind::parameter(key, value).unwrap_err();
            assert!(fault.what.contains("background"), "{fault}");
        }
        assert!(EditKind::parameter("theta_rect", "135deg").is_err());
    }
}
