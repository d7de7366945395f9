//! Changes parameters: from the current step on, or for the whole run, which is then opened again.

use super::State;
use crate::app::window::command::Rules;
use crate::core::case::Parameters;
use crate::core::run::{Edit, EditKind};

impl State {
    /// Changes a parameter from the current step on.
    pub(super) fn set(&mut self, key: &'static str, value: String) {
        let Some(step) = self.run.moment.as_ref().map(|moment| moment.step) else { return };
        if self.parameter(key).as_ref() == Some(&value) {
            return;
        }
        match EditKind::parameter(key, &value) {
            Ok(kind) => self.edit([Edit { step, kind }]),
            Err(fault) => self.complain(&fault),
        }
    }

    /// Changes all parameters that do not belong to the case from the current step on.
    pub(super) fn set_rules(&mut self, rules: Rules) {
        let Some(moment) = &self.run.moment else { return };
        let (step, now) = (moment.step, &moment.parameters);
        let wanted = now.with_rules_of(rules.parameters());
        let differ = Parameters::KEYS.into_iter().filter(|key| now.text_of(key) != wanted.text_of(key));
        let kinds = differ.filter_map(|key| EditKind::parameter(key, &wanted.text_of(key)?).ok());
        let edits: Vec<Edit> = kinds.map(|kind| Edit { step, kind }).collect();
        if edits.is_empty() {
            return self.notice(format!("All parameters have these values already: {}.", rules.name()));
        }
        self.edit(edits);
    }

    /// Opens the run again with another value of a parameter that belongs to its case.
    pub(super) fn set_for_case(&mut self, key: &'static str, value: String) {
        let (Some(opened), Some(source)) = (&self.run.opened, &self.run.source) else { return };
        let mut parameters = opened.run.parameters.clone();
        if let Err(fault) = parameters.set(key, &value) {
            return self.complain(&fault);
        }
        if parameters != opened.run.parameters {
            let (source, mut overrides) = (source.clone(), self.run.overrides.clone());
            overrides.set.retain(|set| set.0 != key);
            overrides.set.push((key.to_owned(), value));
            self.open(source, overrides);
        }
    }

    /// Adds edits, each in place of one of its step that changes the same thing.
    pub(super) fn edit(&mut self, edits: impl IntoIterator<Item = Edit>) {
        self.change(|document| {
            for edit in edits {
                document.edits.retain(|old| old.step != edit.step || !edit.kind.replaces(&old.kind));
                let place = document.edits.partition_point(|old| old.step <= edit.step);
                document.edits.insert(place, edit);
            }
        });
    }
}
