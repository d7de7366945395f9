//! Segments of the boundary that are shorter than the metric asks for.

use super::{DividedDomain, Division, SHORT};
use crate::core::fault::Fault;
use crate::core::metric::ForcedSide;
use crate::core::metric::measure::length;

/// A segment of a curve that faces share is much shorter than one of them asks for if its length in the metric of that
/// face is less: the face has no other say.
const SHORT_SHARED: f64 = 0.7;

impl Division<'_> {
    /// Notes the segments of a curve that are much shorter than the metric asks for. On a curve that faces share, one
    /// of them may ask for much longer ones than the others.
    ///
    /// # Errors
    /// If the metric fails.
    pub(super) fn push_forced(&self, divided: &mut DividedDomain, c: usize, chain: &[u32]) -> Result<(), Fault> {
        let at = |node: u32| match divided.xyz.get(node as usize) {
            Some(&xyz) => xyz,
            None => divided.nodes[node as usize].extend(0.0),
        };
        let by_nodes_of = |w: &[u32]| -> Result<f64, Fault> {
            let [a, b] = [w[0], w[1]].map(|node| divided.nodes[node as usize]);
            Ok(length(&self.metric.metric(a.midpoint(b))?, b - a))
        };
        let mut forced = Vec::new();
        let is_shared = self.domain.images(self.domain.curves[c].first).len() > 1;
        let most = if is_shared { SHORT_SHARED } else { SHORT };
        let mut note = |w: &[u32], metric_length: f64| {
            if metric_length < most {
                forced.push(ForcedSide::standing([at(w[0]), at(w[1])], metric_length));
            }
        };
        if self.domain.curves[c].first.index() != c {
            for w in chain.windows(2) {
                note(w, by_nodes_of(w)?);
            }
        } else {
            let mut from = 0;
            for piece in &self.pieces[c] {
                let to = from + piece.segments as usize;
                for w in chain[from..=to].windows(2) {
                    // Where a curve is divided by its turning, the length of the piece is not that of its sizes.
                    // Several faces have one length for a piece.
                    let by_nodes = self.turns[c] || is_shared;
                    note(w, if by_nodes { by_nodes_of(w)? } else { piece.segment_length() });
                }
                from = to;
            }
        }
        divided.forced.extend(forced.into_iter().filter(|side| side.size > 0.0));
        Ok(())
    }
}
