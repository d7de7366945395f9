//! The groups of an exported mesh that divide nothing: points, and groups that overlap others.

use std::collections::BTreeMap;

use glam::DVec2;

use super::{Export, NONE};
use crate::core::kernel::PlaneTriangles;
use crate::core::mesh::{ElementId, GroupsByPlace, Mesh, Named, Names};
use crate::core::soup::{Group, Members};

/// Adds the members of further groups; `line_of` has the line of each exported line, `tags` the tag of each face.
pub(super) fn add(export: &mut Export, mesh: &Mesh, names: &Names, line_of: &[Option<u32>], tags: &[u32]) {
    let further = &names.further;
    points(export, mesh, names);
    of_faces(export, mesh, names, tags);
    for (named, lines) in &further.lines {
        let is_in = |k: &u32| line_of[*k as usize].is_some_and(|line| lines.contains(&line));
        members(export, 1, named, (0..line_of.len() as u32).filter(is_in).collect());
    }
    if let Some(groups) = &further.faces {
        let middles = middles(export);
        for (k, (named, of)) in by_place(groups, &middles).into_iter().enumerate() {
            let of = if of.is_empty() { around(export, groups, &groups.groups[k].1) } else { of };
            members(export, 2, named, of);
        }
    }
}

/// Adds the groups of whole faces. A group with the name of a face has its tag.
fn of_faces(export: &mut Export, mesh: &Mesh, names: &Names, tags: &[u32]) {
    if names.further.of_faces.is_empty() {
        return;
    }
    let (live, dead): (Vec<ElementId>, Vec<ElementId>) = mesh.elements().partition(|e| mesh.is_triangle(*e));
    let regions: Vec<u32> = live.iter().chain(&dead).map(|e| mesh.region(*e)).collect();
    let mut free = (1..).filter(|tag| !tags.contains(tag));
    for (named, faces) in &names.further.of_faces {
        let same = names.faces.iter().position(|face| face.name == named.name);
        let tag = same.map(|face| tags[face]).or_else(|| free.next());
        let is_in = |k: &u32| {
            let region = regions[*k as usize];
            faces.contains(&region) && Some(tags[region as usize]) != tag
        };
        let of = (0..regions.len() as u32).filter(is_in).collect();
        members(export, 2, &Named { tag, ..named.clone() }, of);
    }
}

/// Adds the points that are kept, by group.
fn points(export: &mut Export, mesh: &Mesh, names: &Names) {
    let kept = &names.further.points;
    if kept.is_empty() {
        return;
    }
    // The exported index of each output point.
    let mut index: BTreeMap<u32, u32> = BTreeMap::new();
    for (node, exported) in mesh.nodes().zip(&export.points) {
        if let Some(point) = mesh.point(node) {
            index.insert(point.0, exported.0);
        }
    }
    let given: Vec<u32> = kept.iter().filter_map(|(named, _)| named.as_ref()?.tag).collect();
    let mut groups: Vec<(Named, Vec<u32>)> = Vec::new();
    for (named, point) in kept {
        let Some(&at) = index.get(&point.0) else { continue };
        let named = named.clone().unwrap_or_default();
        match groups.iter_mut().find(|group| group.0 == named) {
            Some((_, of)) => of.push(at),
            None => groups.push((named, vec![at])),
        }
    }
    let mut free = (1..).filter(|tag| !given.contains(tag));
    for (mut named, mut of) in groups {
        of.sort_unstable();
        of.dedup();
        if named.name.is_empty() {
            export.file.members.push(Members { dimension: 0, tag: 0, of });
        } else {
            named.tag = named.tag.or_else(|| free.next());
            members(export, 0, &named, of);
        }
    }
}

/// Adds the members of a group, and the group.
fn members(export: &mut Export, dimension: u8, named: &Named, of: Vec<u32>) {
    let file = &mut export.file;
    let Some(tag) = named.tag.filter(|_| !of.is_empty()) else { return };
    if file.groups.iter().all(|group| (group.dimension, group.tag) != (dimension, tag)) {
        let before = file.groups.partition_point(|group| group.dimension <= dimension);
        file.groups.insert(before, Group { dimension, tag, name: named.name.clone() });
    }
    file.members.push(Members { dimension, tag, of });
}

/// The middle of each exported element in the parametric plane: triangles, then quadrilaterals.
fn middles(export: &Export) -> Vec<DVec2> {
    let middle = |nodes: &[u32]| nodes.iter().map(|&n| export.uv[n as usize]).sum::<DVec2>() / nodes.len() as f64;
    export.triangles.iter().map(|t| middle(t)).chain(export.quads.iter().map(|q| middle(q))).collect()
}

/// The elements around the middles of given triangles: for a group so small that no element has its middle in one.
fn around(export: &Export, groups: &GroupsByPlace, own: &[u32]) -> Vec<u32> {
    // Cut along the diagonal that leaves the larger least half: a quadrilateral may have a reflex angle.
    let area = |t: &[u32; 3]| {
        let [p, q, r] = t.map(|n| export.uv[n as usize]);
        (q - p).perp_dot(r - p)
    };
    let least = |halves: &[[u32; 3]; 2]| area(&halves[0]).min(area(&halves[1]));
    let cut = |&[a, b, c, d]: &[u32; 4]| {
        let ways = [[[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]];
        if least(&ways[1]) > least(&ways[0]) { ways[1] } else { ways[0] }
    };
    let halves: Vec<[u32; 3]> = export.triangles.iter().copied().chain(export.quads.iter().flat_map(cut)).collect();
    let Ok(elements) = PlaneTriangles::new(&export.uv, &halves) else { return Vec::new() };
    let triangles = export.triangles.len() as u32;
    let element = |half: u32| half.checked_sub(triangles).map_or(half, |half| triangles + half / 2);
    let middle = |t: u32| groups.triangles[t as usize].map(|n| groups.uv[n as usize]).iter().sum::<DVec2>() / 3.0;
    let mut found: Vec<u32> =
        own.iter().filter_map(|&t| elements.find(middle(t))).map(|found| element(found.triangle)).collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// The places that lie in the triangles of each group, by index.
fn by_place<'a>(groups: &'a GroupsByPlace, places: &[DVec2]) -> Vec<(&'a Named, Vec<u32>)> {
    let Ok(triangles) = PlaneTriangles::new(&groups.uv, &groups.triangles) else { return Vec::new() };
    let at: Vec<u32> = places.iter().map(|&place| triangles.find(place).map_or(NONE, |found| found.triangle)).collect();
    let of = |(named, own): &'a (Named, Vec<u32>)| {
        let mut is_own = vec![false; groups.triangles.len()];
        own.iter().for_each(|&t| is_own[t as usize] = true);
        let is_in = |k: &u32| is_own.get(at[*k as usize] as usize) == Some(&true);
        (named, (0..at.len() as u32).filter(is_in).collect())
    };
    groups.groups.iter().map(of).collect()
}
