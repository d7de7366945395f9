//! What a check finds wrong with a mesh that was made.

use super::export::Export;
use crate::core::fault::Fault;
use crate::core::kernel::decimal::point_text;
use crate::core::mesh::{ElementId, Mesh};
use crate::core::soup::Allow;
use crate::core::soup::soundness::examine;

/// How many places a message names.
const TOLD: usize = 3;

impl Export {
    /// What is wrong with the mesh that these arrays are of: its structure, exact convexity, folds over its surface
    /// with their places, and the file as others will see it. On the way to the end there are triangles.
    pub fn flaw(&self, mesh: &Mesh, on_the_way: bool) -> Option<Fault> {
        // Both sides of a crack lie at the same place.
        let allow = Allow { triangles: on_the_way, seams: true, branching: mesh.embedding().is_some() };
        if let Err(what) = mesh.check() {
            return Some(Fault::new(format!("The mesh is invalid: {what}")));
        }
        let folded = if allow.triangles { Vec::new() } else { mesh.folded() };
        if folded.is_empty() {
            let fault = examine(&self.file).verdict(allow).err()?;
            let has_none = fault.remedy.is_empty() && mesh.embedding().is_some();
            return Some(if has_none { fault.remedy("Ask for other sizes there") } else { fault });
        }
        let corners = |e: ElementId| mesh.corners(e).map(|n| mesh.xyz(n)).collect::<Vec<_>>();
        let places: Vec<String> = folded.iter().take(TOLD).map(|&e| point_text(corners(e)[0])).collect();
        let what = match folded.len() {
            1 => format!("1 quadrilateral folds over its surface, at {}", places[0]),
            n if n <= TOLD => format!("{n} quadrilaterals fold over their surface, at {}", places.join(", ")),
            n => format!("{n} quadrilaterals fold over their surface, the first at {}", places.join(", ")),
        };
        Some(
            Fault::new(format!("The mesh is too coarse for its surface: {what}"))
                .showing(folded.iter().map(|&e| corners(e)))
                .remedy("Ask for smaller sizes there, for example by a metric of kind \"curvature\""),
        )
    }
}
