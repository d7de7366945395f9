//! The mirror image of a half that is converted (docs/algorithm.md, "Symmetry").

use std::sync::Arc;

use super::Converter;
use crate::core::convert::event::Event;
use crate::core::convert::front::Done;
use crate::core::convert::phase::Phase;
use crate::core::fault::Fault;

impl Converter<'_> {
    /// Whether the mesh is still one half of a symmetric one.
    pub(super) fn is_half(&self, phase: &Phase) -> bool {
        self.mesh.symmetry().is_some() && !matches!(phase, Phase::Mirror | Phase::Done)
    }

    /// Joins its mirror image to the half.
    pub(super) fn add_image(&mut self) -> Result<Done, Fault> {
        let Some(symmetry) = self.mesh.symmetry().map(Arc::clone) else { return Ok((Phase::Done, None)) };
        let [nodes, quads] = self.mesh.add_image(&symmetry, &*self.source)?;
        if !self.keeps_journal() {
            self.mesh.commit();
        }
        let on_line = self.mesh.nodes().filter(|&n| symmetry.mirror().holds(self.mesh.uv(n))).count();
        Ok((Phase::Done, Some(Event::Mirrored { quads, nodes, on_line })))
    }
}
