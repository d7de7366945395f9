//! Permission for operations, which injected refusals may deny.

use glam::DVec2;

use super::Mesh;
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::mesh::refusals::{Operation, Refusal, Refusals};

impl Mesh {
    /// Makes operations fail from now on as `refusals` determines; `None`, the default, refuses nothing. For tests of
    /// code that depends on operations that may fail.
    pub fn set_refusals(&mut self, refusals: Option<Refusals>) {
        self.refusals = refusals;
    }

    /// Permits an operation at some nodes.
    ///
    /// # Errors
    /// [`Refusal::Injected`], if refusals are set.
    #[inline]
    pub(in crate::core) fn permit(&self, operation: Operation, nodes: &[NodeId]) -> Result<(), Refusal> {
        match &self.refusals {
            None => Ok(()),
            Some(refusals) => self.permit_by(refusals, operation, nodes),
        }
    }

    #[cold]
    fn permit_by(&self, refusals: &Refusals, operation: Operation, nodes: &[NodeId]) -> Result<(), Refusal> {
        let words = nodes.iter().flat_map(|&n| [u64::from(n.0), self.uv(n).x.to_bits(), self.uv(n).y.to_bits()]);
        if refusals.refuses(operation, words) { Err(Refusal::Injected) } else { Ok(()) }
    }

    /// Permits the move of a node to `uv`.
    ///
    /// # Errors
    /// [`Refusal::Injected`], if refusals are set.
    #[inline]
    pub(in crate::core) fn permit_move(&self, node: NodeId, uv: DVec2) -> Result<(), Refusal> {
        match &self.refusals {
            Some(refusals)
                if refusals.refuses(Operation::Move, [u64::from(node.0), uv.x.to_bits(), uv.y.to_bits()]) =>
            {
                Err(Refusal::Injected)
            }
            _ => Ok(()),
        }
    }

    /// Whether an operation on two neighbouring triangles, in either order, is permitted.
    pub(in crate::core) fn permits_pair(&self, operation: Operation, [t, u]: [ElementId; 2]) -> bool {
        let words = [t.min(u), t.max(u)].map(|e| u64::from(e.0));
        !self.refusals.is_some_and(|refusals| refusals.refuses(operation, words))
    }
}
