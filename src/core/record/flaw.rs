//! What a check finds wrong with a mesh that was made.

use super::export::Export;
use crate::core::fault::Fault;
use crate::core::kernel::decimal::number;
use crate::core::mesh::Mesh;
use crate::core::soup::Allow;
use crate::core::soup::soundness::examine;

impl Export {
    /// What is wrong with the mesh that these arrays are of: its structure, exact convexity, folds over its surface,
    /// and the file as others will see it. On the way to the end there are triangles.
    pub fn flaw(&self, mesh: &Mesh, on_the_way: bool) -> Option<Fault> {
        // Both sides of a crack lie at the same place.
        let allow = Allow { triangles: on_the_way, seams: true, branching: mesh.embedding().is_some() };
        if let Err(what) = mesh.check() {
            return Some(Fault::new(format!("The mesh is invalid: {what}")));
        }
        let folded = if allow.triangles { Vec::new() } else { mesh.folded() };
        let Some(first) = folded.first().and_then(|&e| mesh.corners(e).next()) else {
            let fault = examine(&self.file).verdict(allow).err()?;
            let has_none = fault.remedy.is_empty() && mesh.embedding().is_some();
            return Some(if has_none { fault.remedy("Ask for other sizes there") } else { fault });
        };
        let [x, y, z] = mesh.xyz(first).to_array().map(number);
        let what = match folded.len() {
            1 => "1 quadrilateral folds over its surface".to_owned(),
            n => format!("{n} quadrilaterals fold over their surface"),
        };
        Some(
            Fault::new(format!("The mesh is too coarse for its surface: {what} (the first at {x}, {y}, {z})"))
                .remedy("Ask for smaller sizes there, for example by a metric of kind \"curvature\""),
        )
    }
}
