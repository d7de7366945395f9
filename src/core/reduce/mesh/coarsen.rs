//! Fewer triangles by collapsed edges: points inside the surface move onto a neighbour, where no triangle turns over.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::subset::subset;
use super::{Draft, changed};
use crate::core::fault::Fault;
use crate::core::reduce::search::Search;
use crate::core::soup::MeshFile;

/// Passes over the mesh.
const PASSES: usize = 16;
/// The least cosine between the normals of a triangle before and after.
const LEAST_COSINE: f64 = 0.5;

/// Collapses edges, many at once, as long as it still shows.
pub(super) fn reduce(search: &mut Search<'_>) -> Result<(), Fault> {
    for _ in 0..PASSES {
        let Some(mesh) = search.best.mesh() else { return Ok(()) };
        let (before, collapses) = (mesh.triangles.len(), collapses(mesh));
        search.thin(collapses.len(), |base, kept| {
            let moved = (0..collapses.len()).filter(|i| kept.binary_search(i).is_err()).map(|i| collapses[i]);
            collapsed(base, &moved.collect::<Vec<_>>())
        })?;
        if search.best.mesh().is_none_or(|mesh| mesh.triangles.len() == before) {
            return Ok(());
        }
    }
    Ok(())
}

/// The draft with points moved onto others, and without the triangles that this flattens.
fn collapsed(draft: &Draft, collapses: &[(u32, u32)]) -> Option<Draft> {
    let moved: BTreeMap<u32, u32> = collapses.iter().copied().collect();
    let draft = changed(draft, |mesh| {
        let to = |n: &mut u32| *n = moved.get(n).copied().unwrap_or(*n);
        mesh.triangles.as_flattened_mut().iter_mut().for_each(to);
    })?;
    let mesh = draft.mesh()?;
    let mesh = subset(mesh, |i| !matches!(mesh.triangles.get(i), Some([a, b, c]) if a == b || b == c || c == a))?;
    Some(draft.with_mesh(mesh))
}

/// Points with the neighbours that they can move onto. No two of them share a triangle, so that all can move at once.
fn collapses(mesh: &MeshFile) -> Vec<(u32, u32)> {
    if !mesh.quads.is_empty() || !mesh.polygons.is_empty() {
        return Vec::new();
    }
    let mut triangles_at: Vec<Vec<usize>> = vec![Vec::new(); mesh.points.len()];
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        triangle.iter().for_each(|&n| triangles_at[n as usize].push(i));
    }
    let around = |n: u32| -> BTreeMap<u32, usize> {
        let mut around = BTreeMap::new();
        for &i in &triangles_at[n as usize] {
            mesh.triangles[i].iter().filter(|&&m| m != n).for_each(|&m| *around.entry(m).or_insert(0) += 1);
        }
        around
    };
    let on_lines: BTreeSet<u32> = mesh.lines.as_flattened().iter().copied().collect();
    let mut is_taken = vec![false; mesh.points.len()];
    let mut found = Vec::new();
    for n in 0..mesh.points.len() as u32 {
        let ring = around(n);
        let is_inside =
            ring.len() > 2 && ring.values().all(|&count| count == 2) && ring.len() == triangles_at[n as usize].len();
        let tags: BTreeSet<_> = triangles_at[n as usize].iter().map(|&i| mesh.triangle_tags.get(i)).collect();
        if !is_inside
            || tags.len() > 1
            || on_lines.contains(&n)
            || is_taken[n as usize]
            || ring.keys().any(|&m| is_taken[m as usize])
        {
            continue;
        }
        let at = |m: u32| mesh.points[m as usize];
        let mut targets: Vec<u32> = ring.keys().copied().collect();
        targets
            .sort_by(|&a, &b| at(a).distance_squared(at(n)).total_cmp(&at(b).distance_squared(at(n))).then(a.cmp(&b)));
        let fits = |&to: &u32| {
            let shared = around(to).keys().filter(|m| ring.contains_key(m)).count();
            shared == 2 && triangles_at[n as usize].iter().all(|&i| stays(mesh, mesh.triangles[i], n, to))
        };
        if let Some(to) = targets.into_iter().find(fits) {
            ring.keys().for_each(|&m| is_taken[m as usize] = true);
            is_taken[n as usize] = true;
            found.push((n, to));
        }
    }
    found
}

/// Whether a triangle keeps its side, or vanishes, when one of its corners moves onto another point.
fn stays(mesh: &MeshFile, triangle: [u32; 3], from: u32, to: u32) -> bool {
    if triangle.contains(&to) {
        return true;
    }
    let normal = |triangle: [u32; 3]| {
        let [a, b, c] = triangle.map(|n| mesh.points[n as usize]);
        (b - a).cross(c - a).normalize_or(DVec3::ZERO)
    };
    normal(triangle).dot(normal(triangle.map(|n| if n == from { to } else { n }))) > LEAST_COSINE
}
