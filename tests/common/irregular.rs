//! Irregular nodes, counted from the quadrilaterals of a file alone.

use std::collections::BTreeMap;

use quadfront::core::soup::MeshFile;

/// How many nodes inside do not have four quadrilaterals.
pub fn irregular_inside(mesh: &MeshFile) -> usize {
    let mut edges: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    let mut at = vec![0; mesh.points.len()];
    for quad in &mesh.quads {
        for k in 0..4 {
            let [a, b] = [quad[k], quad[(k + 1) % 4]];
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
            at[a as usize] += 1;
        }
    }
    let mut inner = vec![true; at.len()];
    let border = edges.iter().filter(|(_, count)| **count == 1);
    border.for_each(|([a, b], _)| [a, b].into_iter().for_each(|&n| inner[n as usize] = false));
    (0..at.len()).filter(|&n| inner[n] && at[n] != 4).count()
}
