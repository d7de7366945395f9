//! The elements of a mesh, how they lie together, and the mesh of some of them.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use glam::DVec3;

use crate::core::kernel::DisjointSets;
use crate::core::soup::mesh_file::tag_of;
use crate::core::soup::{Group, Members, MeshFile};

/// The elements of a mesh: triangles, then quadrilaterals, then polygons.
pub(super) struct Faces {
    /// Corners by point; points at the same place are one.
    corners: Vec<Vec<u32>>,
    centres: Vec<DVec3>,
    tags: Vec<u32>,
}

/// The corners of all elements.
pub(super) fn corners(mesh: &MeshFile) -> impl Iterator<Item = &[u32]> {
    let triangles = mesh.triangles.iter().map(|t| &t[..]);
    triangles.chain(mesh.quads.iter().map(|q| &q[..])).chain(mesh.polygons.iter().map(|p| &p[..]))
}

impl Faces {
    pub fn of(mesh: &MeshFile) -> Faces {
        let mut first: BTreeMap<[u64; 3], u32> = BTreeMap::new();
        let key = |p: &DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
        let points: Vec<u32> = mesh.points.iter().zip(0..).map(|(p, i)| *first.entry(key(p)).or_insert(i)).collect();
        let centre =
            |face: &[u32]| face.iter().map(|&n| mesh.points[n as usize]).sum::<DVec3>() / face.len().max(1) as f64;
        let tags = [
            (&mesh.triangle_tags, mesh.triangles.len()),
            (&mesh.quad_tags, mesh.quads.len()),
            (&mesh.polygon_tags, mesh.polygons.len()),
        ];
        Faces {
            corners: corners(mesh).map(|face| face.iter().map(|&n| points[n as usize]).collect()).collect(),
            centres: corners(mesh).map(centre).collect(),
            tags: tags.iter().flat_map(|(tags, count)| (0..*count).map(|i| tag_of(tags, i))).collect(),
        }
    }

    pub fn count(&self) -> usize {
        self.corners.len()
    }

    /// The tag of each element.
    pub fn tags(&self) -> Vec<u32> {
        self.tags.clone()
    }

    /// The connected piece of each element.
    pub fn pieces(&self) -> Vec<u32> {
        let most = self.corners.iter().flatten().max().map_or(0, |most| *most as usize + 1);
        let mut sets = DisjointSets::new(most);
        for face in &self.corners {
            face.windows(2).for_each(|pair| sets.join(pair[0], pair[1]));
        }
        self.corners.iter().map(|face| face.first().map_or(0, |&n| sets.find(n))).collect()
    }

    /// The elements on each side, by its ends.
    fn sides(&self) -> BTreeMap<[u32; 2], Vec<usize>> {
        let mut sides: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
        for (face, corners) in self.corners.iter().enumerate() {
            for (k, &a) in corners.iter().enumerate() {
                let b = corners[(k + 1) % corners.len()];
                sides.entry([a.min(b), a.max(b)]).or_default().push(face);
            }
        }
        sides
    }

    /// The neighbours of each element over its sides, ascending.
    fn neighbours(&self) -> Vec<BTreeSet<usize>> {
        let mut neighbours = vec![BTreeSet::new(); self.count()];
        for faces in self.sides().values() {
            for &face in faces {
                neighbours[face].extend(faces.iter().copied().filter(|&other| other != face));
            }
        }
        neighbours
    }

    /// All elements, ring after ring around the one nearest to a place, and then those that are not connected with it.
    pub fn rings(&self, place: DVec3) -> Vec<usize> {
        let distance = |face: usize| (self.centres[face] - place).length_squared();
        let nearest = |a: &usize, b: &usize| distance(*a).total_cmp(&distance(*b)).then(a.cmp(b));
        let neighbours = self.neighbours();
        let (mut order, mut is_known) = (Vec::new(), vec![false; self.count()]);
        let mut starts: Vec<usize> = (0..self.count()).collect();
        starts.sort_by(nearest);
        for start in starts {
            if is_known[start] {
                continue;
            }
            is_known[start] = true;
            let mut waiting = VecDeque::from([start]);
            while let Some(face) = waiting.pop_front() {
                order.push(face);
                let mut next: Vec<usize> = neighbours[face].iter().copied().filter(|&f| !is_known[f]).collect();
                next.sort_by(nearest);
                next.iter().for_each(|&face| is_known[face] = true);
                waiting.extend(next);
            }
        }
        order
    }

    /// All elements along an axis.
    pub fn along(&self, axis: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.count()).collect();
        order.sort_by(|&a, &b| self.centres[a][axis].total_cmp(&self.centres[b][axis]).then(a.cmp(&b)));
        order
    }

    /// For each element the number of its pair: two neighbours, or one without a free neighbour.
    pub fn pairs(&self) -> Vec<u32> {
        let neighbours = self.neighbours();
        let mut pair = vec![u32::MAX; self.count()];
        let mut count = 0;
        for face in 0..self.count() {
            if pair[face] != u32::MAX {
                continue;
            }
            pair[face] = count;
            if let Some(&other) = neighbours[face].iter().find(|&&other| pair[other] == u32::MAX) {
                pair[other] = count;
            }
            count += 1;
        }
        pair
    }
}

/// The mesh of some elements, with the points and lines on them; `None` without any.
pub(super) fn subset(mesh: &MeshFile, keep: impl Fn(usize) -> bool) -> Option<MeshFile> {
    let (triangles, quads) = (mesh.triangles.len(), mesh.quads.len());
    let (mut is_used, mut sides) = (vec![false; mesh.points.len()], BTreeSet::new());
    for (_, face) in corners(mesh).enumerate().filter(|(i, _)| keep(*i)) {
        for (k, &a) in face.iter().enumerate() {
            let b = face[(k + 1) % face.len()];
            is_used[a as usize] = true;
            sides.insert([a.min(b), a.max(b)]);
        }
    }
    let used: Vec<usize> = (0..is_used.len()).filter(|&i| is_used[i]).collect();
    if used.is_empty() {
        return None;
    }
    let mut number = vec![0; is_used.len()];
    used.iter().zip(0_u32..).for_each(|(&old, new)| number[old] = new);
    let new = |n: u32| number[n as usize];
    let kept = |first: usize, count: usize| (0..count).filter(|i| keep(first + i)).collect::<Vec<usize>>();
    let tags = |tags: &[u32], kept: &[usize]| kept.iter().filter_map(|&i| tags.get(i).copied()).collect();
    let lines: Vec<usize> = (0..mesh.lines.len())
        .filter(|&i| {
            let [a, b] = mesh.lines[i];
            sides.contains(&[a.min(b), a.max(b)])
        })
        .collect();
    let [t, q, p] = [(0, triangles), (triangles, quads), (triangles + quads, mesh.polygons.len())]
        .map(|(first, count)| kept(first, count));
    let mut part = MeshFile {
        points: used.iter().map(|&i| mesh.points[i]).collect(),
        lines: lines.iter().map(|&i| mesh.lines[i].map(new)).collect(),
        triangles: t.iter().map(|&i| mesh.triangles[i].map(new)).collect(),
        quads: q.iter().map(|&i| mesh.quads[i].map(new)).collect(),
        polygons: p.iter().map(|&i| mesh.polygons[i].iter().map(|&n| new(n)).collect()).collect(),
        line_tags: tags(&mesh.line_tags, &lines),
        triangle_tags: tags(&mesh.triangle_tags, &t),
        quad_tags: tags(&mesh.quad_tags, &q),
        polygon_tags: tags(&mesh.polygon_tags, &p),
        metric: mesh.metric.as_ref().map(|metric| used.iter().map(|&i| metric[i]).collect()),
        ..MeshFile::default()
    };
    // What is kept of the points, lines and elements, in the new order.
    let elements: Vec<usize> = t
        .into_iter()
        .chain(q.into_iter().map(|i| triangles + i))
        .chain(p.into_iter().map(|i| triangles + quads + i))
        .collect();
    for Members { dimension, tag, of } in &mesh.members {
        let kept = [&used, &lines, &elements][usize::from((*dimension).min(2))];
        let is_in = |old: &usize| of.binary_search(&(*old as u32)).is_ok();
        let of: Vec<u32> = (0..).zip(kept).filter(|(_, old)| is_in(old)).map(|(new, _)| new).collect();
        if !of.is_empty() {
            part.members.push(Members { dimension: *dimension, tag: *tag, of });
        }
    }
    let has = |group: &Group| {
        part.members.iter().any(|members| (members.dimension, members.tag) == (group.dimension, group.tag))
            || match group.dimension {
                1 => part.line_tags.contains(&group.tag),
                2 => [&part.triangle_tags, &part.quad_tags, &part.polygon_tags]
                    .iter()
                    .any(|tags| tags.contains(&group.tag)),
                _ => false,
            }
    };
    part.groups = mesh.groups.iter().filter(|group| has(group)).cloned().collect();
    Some(part)
}
