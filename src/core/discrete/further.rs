//! The groups of a file that overlap others, by the places of their triangles in the parametric plane.

use std::sync::Arc;

use glam::DVec2;

use crate::core::mesh::GroupsByPlace;
use crate::core::soup::{MeshFile, Repair};

/// The groups of elements besides those of their tags; `element` is the element of the file that each triangle of the
/// parametric plane belongs to. `None` without any.
pub(in crate::core) fn groups_by_place(
    file: &MeshFile,
    uv: &[DVec2],
    triangles: &[[u32; 3]],
    element: &[u32],
    repairs: &mut Vec<String>,
) -> Option<Arc<GroupsByPlace>> {
    let further: Vec<_> = file.members.iter().filter(|members| members.dimension == 2).collect();
    if further.is_empty() {
        return None;
    }
    let own = |of: &[u32]| -> Vec<u32> {
        (0..).zip(element).filter(|(_, element)| of.binary_search(element).is_ok()).map(|(t, _)| t).collect()
    };
    let groups = further.iter().map(|members| (file.named(2, members.tag), own(&members.of))).collect();
    Repair::FurtherGroup.report(further.len(), repairs);
    Some(Arc::new(GroupsByPlace { uv: uv.to_vec(), triangles: triangles.to_vec(), groups }))
}
