//! What every step did, in little memory: for every step its kind and the number of quadrilaterals after it, and the
//! whole event for as many steps as the budget allows (replay recovers the others).

use serde::Serialize;

use super::births::Born;
use super::front_count::FrontCount;
use super::last_changes::ChangeLog;
use super::sample::Sample;
use crate::core::convert::{Event, EventKind};

/// Steps in a chunk of events.
const CHUNK: usize = 4096;
/// Set beside the kind where no local post-processing is under way after the step.
const AT_REST: u8 = 0x80;

/// Smallest and largest angle of a quadrilateral, each in the metric of its node, in radians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Angles {
    /// The smallest one.
    pub min: f32,
    /// The largest one.
    pub max: f32,
}

/// The steps of a run as far as they are known. Step s leads from state s - 1 to state s; the first step is 1.
#[derive(Clone, Debug, Default)]
pub struct Log {
    /// The [`EventKind`] of each step as a number, with [`AT_REST`].
    kinds: Vec<u8>,
    nq: Vec<u32>,
    /// Number of quadrilaterals at step 0.
    given: u64,
    chunks: Vec<Option<Box<[Event]>>>,
    /// The events of the last chunk, which is not full yet.
    tail: Vec<Event>,
    /// The counts of the front after each step that changed them.
    fronts: Vec<(u64, FrontCount)>,
    /// The angles of the quadrilaterals that were formed.
    quads: Vec<(u64, Angles)>,
    samples: Vec<Sample>,
    born: Born,
    changes: ChangeLog,
    /// The events of all chunks before this one were dropped.
    given_up: usize,
}

impl Log {
    /// The last known step.
    pub fn known(&self) -> u64 {
        self.kinds.len() as u64
    }

    /// The kind of what a step did, from 1 to [`known`](Log::known).
    pub fn kind(&self, step: u64) -> Option<EventKind> {
        let index = usize::try_from(step.checked_sub(1)?).ok()?;
        self.kinds.get(index).copied().map(kind_of)
    }

    /// The number of quadrilaterals after a step.
    pub fn nq(&self, step: u64) -> u64 {
        let index = usize::try_from(step).unwrap_or(usize::MAX).min(self.nq.len());
        index.checked_sub(1).map_or(self.given, |index| u64::from(self.nq[index]))
    }

    /// Whether no local post-processing (4.3.6) is under way after a step.
    pub fn is_at_rest(&self, step: u64) -> bool {
        match step.checked_sub(1) {
            None => true,
            Some(index) => self.kinds.get(index as usize).is_some_and(|kind| kind & AT_REST != 0),
        }
    }

    /// What a step did; `None` where the step is not known, or its event was dropped to save memory.
    pub fn event(&self, step: u64) -> Option<&Event> {
        let index = usize::try_from(step.checked_sub(1)?).ok()?;
        match self.chunks.get(index / CHUNK) {
            Some(chunk) => chunk.as_ref()?.get(index % CHUNK),
            None => self.tail.get(index - CHUNK * self.chunks.len()),
        }
    }

    /// The counts of the front after a step.
    pub fn front(&self, step: u64) -> FrontCount {
        let count = self.fronts.partition_point(|point| point.0 <= step);
        count.checked_sub(1).map_or(FrontCount::default(), |index| self.fronts[index].1)
    }

    /// The counts of the front after each step that changed them; the first entry is step 0.
    pub fn fronts(&self) -> &[(u64, FrontCount)] {
        &self.fronts
    }

    /// The angles of the quadrilateral that a step formed, right after that step.
    pub fn angles(&self, step: u64) -> Option<Angles> {
        let index = self.quads.binary_search_by_key(&step, |quad| quad.0).ok()?;
        Some(self.quads[index].1)
    }

    /// Invariants and statistics along the run, by step: about one sample per thousand steps.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    /// What the steps made.
    pub fn born(&self) -> &Born {
        &self.born
    }

    /// What the steps changed.
    pub fn changes(&self) -> &ChangeLog {
        &self.changes
    }

    pub(super) fn changes_mut(&mut self) -> &mut ChangeLog {
        &mut self.changes
    }

    pub(super) fn born_mut(&mut self) -> &mut Born {
        &mut self.born
    }

    /// The kinds of the steps from `from` to `until` (both included).
    pub fn kinds(&self, from: u64, until: u64) -> impl Iterator<Item = EventKind> + '_ {
        let until = usize::try_from(until).unwrap_or(usize::MAX).min(self.kinds.len());
        let from = usize::try_from(from.saturating_sub(1)).unwrap_or(usize::MAX).min(until);
        self.kinds[from..until].iter().copied().map(kind_of)
    }

    /// A log without steps, of a run that starts with this number of quadrilaterals.
    pub(super) fn beginning_with(given: u64) -> Log {
        Log { given, ..Log::default() }
    }

    pub(super) fn push_front(&mut self, step: u64, front: FrontCount) {
        if self.fronts.last().is_none_or(|last| last.1 != front) {
            self.fronts.push((step, front));
        }
    }

    pub(super) fn push_angles(&mut self, step: u64, angles: Angles) {
        self.quads.push((step, angles));
    }

    pub(super) fn push_sample(&mut self, sample: Sample) {
        self.samples.push(sample);
    }

    /// Appends what a step did.
    pub(super) fn push(&mut self, event: Event, nq: u64, at_rest: bool) {
        self.kinds.push(event.kind() as u8 | if at_rest { AT_REST } else { 0 });
        self.nq.push(u32::try_from(nq).unwrap_or(u32::MAX));
        self.push_event(event);
    }

    fn push_event(&mut self, event: Event) {
        self.tail.push(event);
        if self.tail.len() == CHUNK {
            self.chunks.push(Some(std::mem::take(&mut self.tail).into()));
        }
    }

    /// Appends the steps of a later log.
    pub(super) fn append(&mut self, later: Log) {
        self.kinds.extend(later.kinds);
        self.nq.extend(later.nq);
        self.fronts.extend(later.fronts);
        self.quads.extend(later.quads);
        self.samples.extend(later.samples);
        self.born.append(&later.born);
        self.changes.append(later.changes);
        for event in later.chunks.into_iter().flatten().flatten().chain(later.tail) {
            self.push_event(event);
        }
    }

    /// Drops all steps after this one.
    pub(super) fn truncate(&mut self, step: u64) {
        let count = usize::try_from(step).unwrap_or(usize::MAX).min(self.kinds.len());
        self.kinds.truncate(count);
        self.nq.truncate(count);
        let step = count as u64;
        self.fronts.truncate(self.fronts.partition_point(|point| point.0 <= step));
        self.quads.truncate(self.quads.partition_point(|quad| quad.0 <= step));
        self.samples.truncate(self.samples.partition_point(|sample| sample.step <= step));
        self.born.truncate(step);
        self.changes.truncate(step);
        if count < CHUNK * self.chunks.len() {
            let partial = self.chunks.swap_remove(count / CHUNK);
            self.chunks.truncate(count / CHUNK);
            // If the events of this chunk were dropped, drop the whole chunk: an empty one would shift all later
            // events.
            self.tail = match partial {
                Some(chunk) => chunk[..count % CHUNK].to_vec(),
                None => return self.truncate((count - count % CHUNK) as u64),
            };
        } else {
            self.tail.truncate(count - CHUNK * self.chunks.len());
        }
        self.given_up = self.given_up.min(self.chunks.len());
    }

    /// The memory it takes, in bytes.
    pub fn bytes(&self) -> usize {
        let kept = self.chunks.iter().flatten().count() * CHUNK + self.tail.capacity();
        let figures = self.fronts.capacity() * size_of::<(u64, FrontCount)>()
            + self.quads.capacity() * size_of::<(u64, Angles)>()
            + self.samples.capacity() * size_of::<Sample>()
            + self.born.bytes()
            + self.changes.bytes();
        self.kinds.capacity()
            + 4 * self.nq.capacity()
            + figures
            + kept * size_of::<Event>()
            + 16 * self.chunks.capacity()
    }

    /// Drops events, the oldest first, until the log takes no more than `budget` bytes, as far as possible.
    pub(super) fn give_up(&mut self, budget: usize) {
        while self.bytes() > budget && self.given_up < self.chunks.len() {
            self.chunks[self.given_up] = None;
            self.given_up += 1;
        }
    }

    /// The first and the last step of the chunk that holds the event of `step`.
    pub(super) fn chunk_of(&self, step: u64) -> (u64, u64) {
        let first = step.saturating_sub(1) / CHUNK as u64 * CHUNK as u64;
        (first + 1, self.known().min(first + CHUNK as u64))
    }

    /// The next step after `from` whose kind is wanted.
    pub fn next_of(&self, from: u64, wanted: impl Fn(EventKind) -> bool) -> Option<u64> {
        let first = usize::try_from(from).ok()?;
        let found = self.kinds.get(first..)?.iter().position(|&kind| wanted(kind_of(kind)))?;
        Some(from + found as u64 + 1)
    }

    /// The last step up to `until` (included) whose kind is wanted.
    pub fn last_of(&self, until: u64, wanted: impl Fn(EventKind) -> bool) -> Option<u64> {
        let count = usize::try_from(until).unwrap_or(usize::MAX).min(self.kinds.len());
        let found = self.kinds[..count].iter().rposition(|&kind| wanted(kind_of(kind)))?;
        Some(found as u64 + 1)
    }

    /// The step that selected the base of the quadrilateral that is under way after a step; `None` where none is.
    pub fn selection(&self, step: u64) -> Option<u64> {
        let last = self.last_of(step, |kind| !is_of_an_attempt(kind))?;
        (self.kind(last) == Some(EventKind::BaseSelected)).then_some(last)
    }

    /// The first step after `after` that leaves at least `nq` quadrilaterals and no local post-processing under way.
    pub fn first_with(&self, nq: u64, after: u64) -> Option<u64> {
        let first = usize::try_from(after).ok()?;
        let numbers = self.nq.get(first..)?.iter().zip(&self.kinds[first..]);
        let found = numbers.into_iter().position(|(&n, kind)| u64::from(n) >= nq && kind & AT_REST != 0)?;
        Some(after + found as u64 + 1)
    }

    /// The next step after `from` that completes a quadrilateral and its local post-processing (4.3.6): that of the
    /// last quadrilateral while it is under way. `None` where there is no further one, or where it is not known yet.
    pub fn next_quad(&self, from: u64) -> Option<u64> {
        let made = if self.is_at_rest(from) { self.next_of(from, makes_quads)? } else { from };
        self.rest_after(made)
    }

    /// The last step before `from` that completed a quadrilateral and its local post-processing, or the beginning.
    pub fn previous_quad(&self, from: u64) -> u64 {
        let mut until = from.saturating_sub(1);
        while let Some(made) = self.last_of(until, makes_quads) {
            match self.rest_after(made).filter(|&rest| rest < from) {
                Some(rest) => return rest,
                None => until = made - 1,
            }
        }
        0
    }

    /// The first step from this one on after which no local post-processing is under way.
    fn rest_after(&self, step: u64) -> Option<u64> {
        (step..=self.known()).find(|&step| self.is_at_rest(step))
    }
}

/// Whether a step of this kind makes quadrilaterals; clean-up does not count.
fn makes_quads(kind: EventKind) -> bool {
    matches!(kind, EventKind::Formed | EventKind::Closed | EventKind::Patched)
}

/// Whether a step of this kind leaves the quadrilateral under way that was under way before.
fn is_of_an_attempt(kind: EventKind) -> bool {
    matches!(
        kind,
        EventKind::SideIsFront
            | EventKind::SideChosen
            | EventKind::SideSwapped
            | EventKind::SideDivided
            | EventKind::TopSwapped
            | EventKind::TopSmoothed
            | EventKind::TopFound
            | EventKind::NodeRemoved
            | EventKind::RolledBack
    )
}

fn kind_of(stored: u8) -> EventKind {
    EventKind::ALL[usize::from(stored & !AT_REST)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::mesh::NodeId;

    fn event(i: u64) -> Event {
        if i.is_multiple_of(10) { Event::SecondPass } else { Event::Deferred { a: NodeId(i as u32), b: NodeId(0) } }
    }

    fn log(steps: u64) -> Log {
        let mut log = Log::default();
        for i in 1..=steps {
            log.push(event(i), i / 10, i % 10 > 4);
        }
        log
    }

    #[test]
    fn steps_are_found_by_kind_and_by_number_of_quadrilaterals() {
        let log = log(10_000);
        let is_second_pass = |kind| kind == EventKind::SecondPass;
        assert_eq!(log.next_of(0, is_second_pass), Some(10));
        assert_eq!(log.next_of(10, is_second_pass), Some(20));
        assert_eq!(log.last_of(10, is_second_pass), Some(10));
        assert_eq!(log.last_of(9, is_second_pass), None);
        assert_eq!(log.next_of(10_000, |_| true), None);
        assert_eq!((log.nq(0), log.nq(25), log.nq(99_999)), (0, 2, 1000));
        assert_eq!(log.first_with(3, 0), Some(35));
        assert_eq!(log.first_with(3, 36), Some(37));
        let kinds = [0, 10, 11].map(|step| log.kind(step));
        assert_eq!(kinds, [None, Some(EventKind::SecondPass), Some(EventKind::Deferred)]);
    }

    #[test]
    fn events_belong_to_their_steps_after_appending_truncating_and_dropping() {
        let mut whole = log(9000);
        let mut later = Log::default();
        for i in 9001..=13_000 {
            later.push(event(i), i / 10, true);
        }
        whole.append(later);
        assert!((1..=13_000).all(|i| whole.event(i) == Some(&event(i))));
        whole.truncate(8195);
        assert_eq!((whole.known(), whole.event(8196)), (8195, None));
        assert!((1..=8195).all(|i| whole.event(i) == Some(&event(i))));
        whole.give_up(0);
        assert_eq!((whole.event(4096), whole.event(8192), whole.event(8193)), (None, None, Some(&event(8193))));
        assert!(whole.bytes() < 16_384 * 8, "{}", whole.bytes());
        whole.truncate(5000);
        assert_eq!(whole.known(), 4096, "the rest of a chunk without events is not kept");
        assert_eq!(whole.chunk_of(4097), (4097, 4096));
        assert_eq!(whole.chunk_of(4096), (1, 4096));
    }
}
