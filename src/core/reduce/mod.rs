//! The smallest case that still shows something: delta debugging of cases, meshes and edits.
//!
//! | what | where |
//! |---|---|
//! | what a case must show: a condition on a step or on the end, a panic | [`Question`], [`Finding`], [`Panic`] |
//! | the case as a tree that can be changed and written | [`Draft`] |
//! | dropping parts in large pieces first | `search` |
//! | the files of the smallest case | [`Written`] |
//! | edits and parts that can be left out | `edits`, `parts` |
//! | simpler curves, metrics and meshes | `shapes`, `sizes`, `mesh` |
//!
//! A draft is judged by its text, as it will be written. What costs much more than the original is abandoned, by steps
//! and triangles and not by time, so that the same case gives the same smallest case on every machine.

mod document;
mod draft;
mod failure;
mod question;
mod search;
mod corners;
mod edits;
mod parts;
mod shapes;
mod sizes;
mod mesh;
mod written;

pub use draft::{Draft, Size};
pub use failure::Panic;
use parts::OPTIONS;
pub use question::{Budget, Finding, Question, end_fields};
use search::Search;
pub use search::{Judge, Tell};
pub use written::{Written, does_not_show};

use crate::core::fault::Fault;

/// Rounds over all kinds of reductions.
const ROUNDS: usize = 4;

/// The smallest draft that was found.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// The draft.
    pub draft: Draft,
    /// What it shows.
    pub finding: Finding,
    /// Number of drafts judged.
    pub tests: u64,
    /// Whether all drafts were judged, and nothing more can be left out.
    pub is_least: bool,
}

/// Reduces a draft that shows `finding`, judging at most `most` drafts.
///
/// # Errors
/// Those of `judge` (which says whether the work was cancelled) and of `tell`.
pub fn reduce<'s>(
    draft: Draft,
    finding: Finding,
    most: u64,
    judge: &'s mut Judge<'s>,
    tell: &'s mut Tell<'s>,
) -> Result<Reduced, Fault> {
    let mut search = Search::new(draft, finding, most, judge, tell);
    search.offer(search.best.changed(|_| {}))?;
    for _ in 0..ROUNDS {
        let before = search.best.clone();
        parts::reduce(&mut search)?;
        mesh::reduce(&mut search)?;
        shapes::reduce(&mut search)?;
        sizes::reduce(&mut search)?;
        if search.best == before {
            break;
        }
    }
    sizes::shorten_numbers(&mut search)?;
    mesh::shorten_numbers(&mut search)?;
    let is_least = !search.is_over();
    Ok(Reduced { draft: search.best, finding: search.finding, tests: search.tests, is_least })
}
