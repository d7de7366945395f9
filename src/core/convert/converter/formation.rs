//! The steps from a base segment to its quadrilateral (4.3.4): what each phase does with what sides, top and form say, and where an
//! attempt that fails leads to.

use super::Converter;
use crate::core::convert::event::{Event, Why};
use crate::core::convert::phase::{Attempt, Base, Phase};
use crate::core::convert::top::{MOST_SWAPS, Recovery, crossings, recover_step};
use crate::core::fault::Fault;
use crate::core::front::sector::Side;
use crate::core::mesh::ids::NodeId;

impl Converter<'_> {
    /// Takes an attempt back; the next one follows, or where there is none the segment is put off (docs/algorithm.md,
    /// "Rescue").
    pub(super) fn fail(&mut self, base: Base, attempt: Attempt, why: Why) -> (Phase, Event) {
        if self.keeps_history() {
            // What this very step did is not part of the state before it.
            self.mesh.take_back(self.step_mark);
            self.undone = Some(self.mesh.take_back_to_redo(attempt.mark));
        } else {
            self.mesh.take_back(attempt.mark);
        }
        self.counts.rolled_back += 1;
        let next = match self.next_attempt(&base, &attempt) {
            Some(attempt) => Phase::PrepareSide { base, attempt, side: Side::Left, left: None },
            None => Phase::Defer { base },
        };
        (next, Event::RolledBack { attempt: attempt.number, why })
    }

    pub(super) fn step_side(
        &mut self,
        base: Base,
        attempt: Attempt,
        side: Side,
        left: Option<NodeId>,
    ) -> (Phase, Event) {
        match self.prepare_side(&base, &attempt, side, left) {
            Ok((top, event)) => {
                let tops = match side {
                    Side::Left => [Some(top), None],
                    Side::Right => [left, Some(top)],
                };
                // A dead edge is never divided; what cannot be divided and must be fails in its own step.
                let next = match event {
                    Event::SideIsFront { .. } => self.after_side(base, attempt, side, tops),
                    _ => match self.division(&base, &attempt, side, top) {
                        Ok(None) => self.after_side(base, attempt, side, tops),
                        _ => Phase::DivideSide { base, attempt, side, tops },
                    },
                };
                (next, event)
            }
            Err(why) => self.fail(base, attempt, why),
        }
    }

    pub(super) fn after_side(&self, base: Base, attempt: Attempt, side: Side, tops: [Option<NodeId>; 2]) -> Phase {
        match (side, tops) {
            (Side::Right, [Some(c), Some(d)]) => Phase::RecoverTop { base, attempt, tops: [c, d], swaps: 0 },
            _ => Phase::PrepareSide { base, attempt, side: Side::Right, left: tops[0] },
        }
    }

    pub(super) fn step_divide(
        &mut self,
        base: Base,
        attempt: Attempt,
        side: Side,
        mut tops: [Option<NodeId>; 2],
    ) -> Result<(Phase, Event), Fault> {
        let Some(top) = tops[side.index()] else { return Ok(self.fail(base, attempt, Why::NoSide(side))) };
        match self.division(&base, &attempt, side, top) {
            Ok(Some(division)) => {
                let (node, event) = self.divide_side(side, division);
                tops[side.index()] = Some(node);
                Ok((self.after_side(base, attempt, side, tops), event))
            }
            // Somebody has changed the parameters since it was judged.
            Ok(None) => self.act(self.after_side(base, attempt, side, tops)),
            Err(why) => Ok(self.fail(base, attempt, why)),
        }
    }

    /// The edges that the top edge crosses, from C on, where the next step recovers it and none of them is dead; none where it is
    /// there.
    pub fn top_crossings(&self) -> Option<Vec<[NodeId; 2]>> {
        let Phase::RecoverTop { tops: [c, d], .. } = *self.phase() else { return None };
        if self.mesh.are_joined(c, d) {
            return Some(Vec::new());
        }
        let found = crossings(&self.mesh, c, d).ok()?;
        Some(found.into_iter().map(|h| [self.mesh.origin(h), self.mesh.target(h)]).collect())
    }

    pub(super) fn step_top(&mut self, base: Base, attempt: Attempt, tops: [NodeId; 2], swaps: u8) -> (Phase, Event) {
        let [c, d] = tops;
        match recover_step(&mut self.mesh, c, d, &[base.a, base.b, c, d]) {
            Ok(Recovery::Found) => (Phase::Form { base, attempt, tops }, Event::TopFound { ends: tops, swaps }),
            Ok(Recovery::Changed(_)) if swaps == MOST_SWAPS => self.fail(base, attempt, Why::TopTooLong),
            Ok(Recovery::Changed(event)) => (Phase::RecoverTop { base, attempt, tops, swaps: swaps + 1 }, event),
            Err(why) => self.fail(base, attempt, why),
        }
    }

    pub(super) fn step_form(&mut self, base: Base, attempt: Attempt, tops: [NodeId; 2]) -> (Phase, Event) {
        match self.form(&base, &attempt, tops) {
            Ok(event) => {
                let Event::Formed { element, .. } = event else { unreachable!("form forms") };
                self.counts.formed += 1;
                let right_replaced = attempt.tops[1].is_some() && attempt.tops[0].is_none();
                self.counts.right_replaced += u64::from(right_replaced);
                self.counts.rescued += u64::from(attempt.tops[0].is_some());
                (self.begin_local(element, attempt.mark), event)
            }
            Err(why) => self.fail(base, attempt, why),
        }
    }

    /// Closes the loop of a segment from which no quadrilateral can be formed, where it is a small one
    /// (docs/algorithm.md, "Small loops"); else puts the segment off until something near it changes.
    pub(super) fn step_defer(&mut self, base: Base) -> (Phase, Event) {
        let segment = self.base_half_edge(&base);
        let mark = self.mesh.mark();
        if let Some((quads, event)) = segment.and_then(|h| self.close_beside(h)) {
            self.counts.closed += quads;
            self.refresh(mark);
            return (Phase::Select, event);
        }
        self.counts.deferred += 1;
        if let Some(h) = segment {
            let mut queue = self.take_queue();
            queue.defer(&mut self.mesh, h);
            self.queue = Some(queue);
        }
        (Phase::Select, Event::Deferred { a: base.a, b: base.b })
    }
}
