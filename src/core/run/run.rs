//! The run as a value: with the case everything that determines each of its states, and what a person keeps beside it.

use std::sync::Arc;

use super::shown::Shown;
use crate::core::case::Case;
use crate::core::case::parameters::Parameters;
use crate::core::convert::converter::Converter;
use crate::core::fault::{Fault, FaultKind};
use crate::core::mesh::ids::NodeId;
use crate::core::prepare::{Background, background};
use crate::core::progress::Watch;

/// Parameters that the background mesh is made with: they can be changed for a whole run only.
pub const OF_BACKGROUND: [&str; 2] = ["size_scale", "max_quads"];

/// A change of the run at a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// What follows from this step on is changed.
    pub step: u64,
    /// What is changed.
    pub kind: EditKind,
}

/// What an edit changes.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EditKind {
    /// A parameter is given another value, both as [`Parameters::set`] takes them.
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
    /// The change of a parameter, checked.
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
        // As it is written everywhere else, so that a run reads back as it was.
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

/// A step with a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bookmark {
    /// The step.
    pub step: u64,
    /// What a person calls it.
    pub name: String,
}

/// From where a state was looked at, in plain numbers: the core does not know what they mean on a screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The point looked at, in units of the case.
    pub target: [f64; 3],
    /// How the view is turned: a unit quaternion (x, y, z, w).
    pub turn: [f64; 4],
    /// What is seen from the lower to the upper edge, in units of the case.
    pub height: f64,
}

/// A run: case, parameters and edits at steps give every state of it, bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The case as its file says it; its text is kept with it, a mesh that it names lies in its own file.
    pub case: Case,
    /// The parameters from step 0 on, in place of the case's.
    pub parameters: Parameters,
    /// By step; of one step in the order in which they are made.
    edits: Vec<Edit>,
    /// By step.
    pub bookmarks: Vec<Bookmark>,
    /// From where it was looked at last.
    pub camera: Option<Camera>,
    /// What is shown of it, where it comes from a figure.
    pub shown: Option<Shown>,
}

impl Run {
    /// The run of a case as it is.
    pub fn of(case: Case) -> Run {
        let parameters = case.parameters.clone();
        Run { case, parameters, edits: Vec::new(), bookmarks: Vec::new(), camera: None, shown: None }
    }

    /// The edits, by step.
    pub fn edits(&self) -> &[Edit] {
        &self.edits
    }

    /// Replaces all edits; those of one step stay in their order.
    pub fn set_edits(&mut self, mut edits: Vec<Edit>) {
        edits.sort_by_key(|edit| edit.step);
        self.edits = edits;
    }

    /// The edits with one more; it takes the place of one of the same step that changes the same thing.
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

    /// The first step at which two lists of edits say different things; `None` where they say the same.
    pub(super) fn first_difference(before: &[Edit], after: &[Edit]) -> Option<u64> {
        let same = before.iter().zip(after).take_while(|(a, b)| a == b).count();
        let steps = [before.get(same), after.get(same)];
        steps.into_iter().flatten().map(|edit| edit.step).min()
    }

    /// The parameters in force at a step, its edits made.
    ///
    /// # Errors
    /// An edit that is no valid one.
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

    /// The background mesh of the run.
    ///
    /// # Errors
    /// As [`background`].
    pub fn background(&self, watch: &mut dyn Watch) -> Result<Background, Fault> {
        background(&self.case_in_force(), watch)
    }

    /// A converter at step 0, with the edits of step 0 made.
    ///
    /// # Errors
    /// An edit that is no valid one.
    pub fn start(&self, background: &Background) -> Result<Converter<'static>, Fault> {
        let sizing = Arc::new(background.sizing.clone());
        let mut converter = Converter::new(background.mesh.clone(), sizing, self.parameters.clone());
        self.make_edits(&mut converter, 0)?;
        Ok(converter)
    }

    /// Makes the edits of a step on a converter that has just come there.
    ///
    /// # Errors
    /// An edit that is no valid one.
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

    /// Makes a state that was kept raw, before the edits of its step, the state of that step.
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
        let told: Vec<_> = run.edits().iter().map(|edit| edit.step).collect();
        assert_eq!(told, [3, 7, 7, 9]);
        let c = |step| run.parameters_at(step).unwrap().c;
        assert_eq!([c(0), c(6), c(7), c(8), c(9)], [2.0, 2.0, 1.8, 1.8, 2.5]);
        assert_eq!(run.edits_at(7).len(), 2);
        assert_eq!(run.edits_at(8).len(), 0);
    }

    #[test]
    fn two_lists_of_edits_differ_first_where_one_says_what_the_other_does_not() {
        let edit = |step, value| Edit { step, kind: EditKind::parameter("c", value).unwrap() };
        let (a, b, c) = (edit(3, "1.5"), edit(8, "1.6"), edit(8, "1.7"));
        assert_eq!(Run::first_difference(&[a.clone(), b.clone()], &[a.clone(), c.clone()]), Some(8));
        assert_eq!(Run::first_difference(&[a.clone(), b.clone()], std::slice::from_ref(&c)), Some(3));
        assert_eq!(Run::first_difference(&[a.clone(), b.clone()], std::slice::from_ref(&a)), Some(8));
        assert_eq!(Run::first_difference(std::slice::from_ref(&a), std::slice::from_ref(&a)), None);
    }

    #[test]
    fn what_the_background_is_made_with_cannot_change_at_a_step() {
        let fault = EditKind::parameter("size_scale", "0.5").unwrap_err();
        assert!(fault.what.contains("background"), "{fault}");
        assert!(EditKind::parameter("theta_rect", "135deg").is_err());
    }
}
