//! The edits of a run: left out, made a parameter of the case, or made earlier. A case cannot become smaller than the
//! run must be to reach the steps of its edits.

use super::document::{Keys, Node};
use super::draft::{Draft, changed_parameters};
use super::search::Search;
use crate::core::fault::Fault;
use crate::core::run::EditKind;

/// Leaves out edits, and has those that are left take effect earlier.
pub(super) fn reduce(search: &mut Search<'_>) -> Result<(), Fault> {
    let edits = search.best.edits.clone();
    search.thin(edits.len(), |base, kept| {
        Some(Draft { edits: kept.iter().map(|&i| edits[i].clone()).collect(), ..base.clone() })
    })?;
    let mut k = 0;
    while k < search.best.edits.len() {
        let is_gone = match of_the_case(&search.best, k) {
            Some(draft) => search.offer(draft)?,
            None => false,
        };
        if !is_gone {
            earlier(search, k)?;
            k += 1;
        }
    }
    Ok(())
}

/// The draft in which the value that an edit gives a parameter is that of the case; `None` for another edit.
fn of_the_case(draft: &Draft, k: usize) -> Option<Draft> {
    let EditKind::Parameter { key, value } = &draft.edits[k].kind else { return None };
    let mut parameters = draft.run().ok()?.parameters;
    parameters.set(key, value).ok()?;
    let mut draft = draft.changed(|keys| keys.set("parameters", Node::Table(Keys(changed_parameters(&parameters)))));
    draft.edits.remove(k);
    Some(draft)
}

/// Moves an edit to the earliest step that halving the steps before it finds.
fn earlier(search: &mut Search<'_>, mut k: usize) -> Result<(), Fault> {
    let (mut too_early, mut step) = (None, search.best.edits[k].step);
    while step > too_early.map_or(0, |early: u64| early + 1) {
        // The first step first: an edit there belongs to no place in the run.
        let tried = too_early.map_or(0, |early| early + (step - early) / 2);
        let mut draft = search.best.clone();
        let mut edit = draft.edits.remove(k);
        edit.step = tried;
        let place = draft.edits.partition_point(|other| other.step <= tried);
        draft.edits.insert(place, edit);
        if search.offer(draft)? {
            (step, k) = (tried, place);
        } else {
            too_early = Some(tried);
        }
    }
    Ok(())
}
