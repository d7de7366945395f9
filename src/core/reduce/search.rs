//! The search for a smaller case that still shows it: delta debugging over lists of parts.

use std::collections::BTreeSet;

use super::corners::sharpest;
use super::draft::Draft;
use super::question::Finding;
use crate::core::fault::Fault;
use crate::core::kernel::Fingerprint;

/// Judges a draft: what it shows, `None` where it does not show it.
pub type Judge<'j> = dyn FnMut(&Draft) -> Result<Option<Finding>, Fault> + 'j;

/// Hears of each draft that was judged: how many there were, the smallest one that shows it, and whether that is new.
pub type Tell<'t> = dyn FnMut(u64, &Draft, &Finding, bool) -> Result<(), Fault> + 't;

/// The smallest draft so far, and the means to find a smaller one.
pub(super) struct Search<'s> {
    /// The smallest draft that shows it.
    pub best: Draft,
    /// What it shows.
    pub finding: Finding,
    /// Number of drafts judged.
    pub tests: u64,
    most: u64,
    /// The sharpest corner that a draft may have.
    sharpest: u32,
    seen: BTreeSet<Fingerprint>,
    judge: &'s mut Judge<'s>,
    tell: &'s mut Tell<'s>,
}

impl<'s> Search<'s> {
    /// A search that begins with a draft that shows it, and judges at most `most` drafts.
    pub fn new(best: Draft, finding: Finding, most: u64, judge: &'s mut Judge<'s>, tell: &'s mut Tell<'s>) -> Self {
        let seen = BTreeSet::from([best.fingerprint()]);
        let sharpest = sharpest(&best);
        Search { best, finding, tests: 0, most, sharpest, seen, judge, tell }
    }

    /// Whether no further draft is judged.
    pub fn is_over(&self) -> bool {
        self.tests >= self.most
    }

    /// Takes a draft if it still shows it.
    ///
    /// # Errors
    /// The work was cancelled, or `tell` failed.
    pub fn offer(&mut self, draft: Draft) -> Result<bool, Fault> {
        if self.is_over() || !self.seen.insert(draft.fingerprint()) || sharpest(&draft) < self.sharpest {
            return Ok(false);
        }
        self.tests += 1;
        let found = (self.judge)(&draft)?;
        let is_new = found.is_some();
        if let Some(finding) = found {
            (self.best, self.finding) = (draft, finding);
        }
        (self.tell)(self.tests, &self.best, &self.finding, is_new)?;
        Ok(is_new)
    }

    /// Drops as many of `count` parts as it can: in large pieces first, then in smaller ones, down to single parts,
    /// until none can be dropped. `with` makes the draft that keeps the parts of these numbers (ascending), of the
    /// draft that was the smallest at the beginning.
    ///
    /// # Errors
    /// As [`Search::offer`].
    pub fn thin(&mut self, count: usize, with: impl Fn(&Draft, &[usize]) -> Option<Draft>) -> Result<(), Fault> {
        let base = self.best.clone();
        let mut kept: Vec<usize> = (0..count).collect();
        let mut chunk = count;
        while chunk > 0 {
            let (mut start, mut dropped) = (0, false);
            while start < kept.len() && !self.is_over() {
                let end = (start + chunk).min(kept.len());
                let rest: Vec<usize> = [&kept[..start], &kept[end..]].concat();
                let is_taken = match with(&base, &rest) {
                    Some(draft) => self.offer(draft)?,
                    None => false,
                };
                if is_taken {
                    kept = rest;
                    dropped = true;
                } else {
                    start = end;
                }
            }
            chunk = match chunk {
                1 if dropped => 1,
                1 => 0,
                _ => chunk.div_ceil(2).min(kept.len()),
            };
        }
        Ok(())
    }
}
