//! Exports the converter's mesh for files and measurements: without tombstones, and with one point for all copies of a
//! node.

mod further;

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::statistics::{Measured, OnSurfaces};
use crate::core::fault::Fault;
use crate::core::geometry::Atlas;
use crate::core::mesh::{ElementId, Mesh, Named, Names, PointId};
use crate::core::metric::Sizing;
use crate::core::metric::straight_quad::StraightQuad;
use crate::core::run::Births;
use crate::core::soup::mesh_file::{BUILT_IN, ELEMENT_ID, FRONT, NODE_ID};
use crate::core::soup::{Data, Group, MeshFile};

/// Tag of lines with elements on one side (the boundary, both sides of a crack), unless a line of the file has it.
const BOUNDARY: u32 = 1;
/// Likewise of lines with elements on both sides (curves between faces, repeated lines).
const INSIDE: u32 = 2;
/// Likewise of the segments of the merging front.
const FRONT_TAG: u32 = 3;

/// No point yet.
const NONE: u32 = u32::MAX;

/// An exported mesh.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Export {
    /// Coordinates of each node.
    pub uv: Vec<DVec2>,
    /// Output point of each node: its index in the points of `file`.
    pub points: Vec<PointId>,
    /// Triangles by nodes.
    pub triangles: Vec<[u32; 3]>,
    /// Quadrilaterals by nodes.
    pub quads: Vec<[u32; 4]>,
    /// Points, elements, lines along all curves, and groups.
    pub file: MeshFile,
    /// The surfaces of the mesh; `None` in the plane.
    pub atlas: Option<Arc<Atlas>>,
    /// A position in the parametric plane for each point.
    pub chart: Vec<DVec2>,
}

impl Export {
    /// Exports a mesh whose faces and lines have these names; nodes and elements keep their order. Groups keep the tags
    /// of the file; sides on no line go to the groups `boundary` and `inside`.
    ///
    /// Events name nodes and elements by their ids, which are data: elements have `element_id`, points have `node_id`
    /// and, where a curve has a node on each side, `node_id_2` and so on (-1 where a point has fewer nodes).
    pub fn of(mesh: &Mesh, names: &Names) -> Export {
        Export::with_nodes(mesh, names).0
    }

    /// Exports an intermediate mesh. Elements also have `live` (1 for triangles, 0 for quadrilaterals), `level` and
    /// `region` (the tag of the group), and the merging front is a group of lines, each with its live triangle to the
    /// left.
    pub fn of_state(mesh: &Mesh, names: &Names) -> Export {
        let (mut export, node_at) = Export::with_nodes(mesh, names);
        let tags = face_tags(mesh, names);
        let (live, dead): (Vec<ElementId>, Vec<ElementId>) = mesh.elements().partition(|e| mesh.is_triangle(*e));
        let data = |name: &str, value: &dyn Fn(ElementId) -> f64| Data {
            name: name.to_owned(),
            values: live.iter().chain(&dead).map(|e| value(*e)).collect(),
        };
        let file = &mut export.file;
        file.element_data.extend([
            data("live", &|e| f64::from(u8::from(mesh.is_triangle(e)))),
            data("level", &|e| f64::from(mesh.level(e))),
            data("region", &|e| f64::from(tags.get(mesh.region(e) as usize).copied().unwrap_or(0))),
        ]);
        let (_, front) = line_tags(names);
        for h in mesh.front() {
            let nodes = mesh.ends(h);
            file.lines.push(nodes.map(|n| export.points[node_at[n.index()] as usize].0));
            file.line_tags.push(front);
        }
        if file.line_tags.contains(&front) {
            let before = file.groups.partition_point(|group| group.dimension == 1);
            file.groups.insert(before, Group { dimension: 1, tag: front, name: FRONT.to_owned() });
        }
        export
    }

    /// Adds data. Elements get `quality` (in the metric, docs/algorithm.md, "Quality") and `face` (numbered from 1),
    /// and with `births` from a run, `level` and `step`, the step that made them (-1 for triangles). Where there are
    /// quadrilaterals they get Verdict's measures by their own names (-1 for triangles). Points get the metric and the
    /// position in the parametric plane (of a point on several faces, in the first).
    ///
    /// # Errors
    /// A point without a metric.
    pub fn describe(&mut self, mesh: &Mesh, sizing: &Sizing, births: Option<&Births>) -> Result<(), Fault> {
        let (live, dead): (Vec<ElementId>, Vec<ElementId>) = mesh.elements().partition(|e| mesh.is_triangle(*e));
        let data = &mut self.file.element_data;
        let mut add = |name: &str, value: &dyn Fn(ElementId) -> f64| {
            if data.iter().all(|data| data.name != name) {
                data.push(Data {
                    name: name.to_owned(),
                    values: live.iter().chain(&dead).map(|e| value(*e)).collect(),
                });
            }
        };
        add("quality", &|e| mesh.quality(e));
        add("face", &|e| f64::from(mesh.region(e) + 1));
        if let Some(births) = births {
            add("level", &|e| f64::from(mesh.level(e)));
            add("step", &|e| births.step(e).map_or(-1.0, |step| step as f64));
        }
        if !dead.is_empty() {
            let of = |e: ElementId, measure: fn(&StraightQuad) -> f64| {
                if mesh.is_quad(e) { measure(&StraightQuad(mesh.quad(e).map(|n| mesh.xyz(n)))) } else { -1.0 }
            };
            add("scaled_jacobian", &|e| of(e, StraightQuad::scaled_jacobian));
            add("aspect_ratio", &|e| of(e, StraightQuad::aspect_ratio));
            add("skew", &|e| of(e, StraightQuad::skew));
            add("warpage", &|e| of(e, StraightQuad::warpage));
        }
        self.file.metric = Some(self.chart.iter().map(|&p| sizing.metric3_at(p)).collect::<Result<_, _>>()?);
        self.file.uv = Some(self.chart.clone());
        Ok(())
    }

    /// The exported mesh, and the exported index of each node slot.
    fn with_nodes(mesh: &Mesh, names: &Names) -> (Export, Vec<u32>) {
        let atlas = mesh.embedding().map(|embedding| Arc::clone(&embedding.atlas));
        let mut export = Export { atlas, ..Export::default() };
        let mut node_at = vec![NONE; mesh.node_slots()];
        let mut point_at: Vec<u32> = Vec::new();
        for node in mesh.nodes() {
            let uv = mesh.uv(node);
            node_at[node.index()] = export.uv.len() as u32;
            export.uv.push(uv);
            let mut new_point = || {
                export.file.points.push(mesh.xyz(node));
                export.chart.push(uv);
                export.file.points.len() as u32 - 1
            };
            let point = match mesh.point(node) {
                None => new_point(),
                Some(shared) => {
                    if shared.index() >= point_at.len() {
                        point_at.resize(shared.index() + 1, NONE);
                    }
                    let at = &mut point_at[shared.index()];
                    if *at == NONE {
                        *at = new_point();
                    }
                    *at
                }
            };
            export.points.push(PointId(point));
        }
        let file = &mut export.file;
        let points = &export.points;
        let point_of = |node: u32| points[node as usize].0;
        let tags = face_tags(mesh, names);
        let tag_of = |e: ElementId| tags[mesh.region(e) as usize];
        for e in mesh.elements() {
            if mesh.is_triangle(e) {
                let nodes = mesh.triangle(e).map(|n| node_at[n.index()]);
                export.triangles.push(nodes);
                file.triangles.push(nodes.map(point_of));
                file.triangle_tags.push(tag_of(e));
            } else {
                let nodes = mesh.quad(e).map(|n| node_at[n.index()]);
                export.quads.push(nodes);
                file.quads.push(nodes.map(point_of));
                file.quad_tags.push(tag_of(e));
            }
        }
        file.point_data = node_ids(mesh, points, file.points.len());
        let (live, dead): (Vec<ElementId>, Vec<ElementId>) = mesh.elements().partition(|e| mesh.is_triangle(*e));
        let values = live.iter().chain(&dead).map(|e| f64::from(e.0)).collect();
        file.element_data = vec![Data { name: ELEMENT_ID.to_owned(), values }];
        let mut sides = Vec::new();
        for h in mesh.edges().filter(|h| mesh.twin(*h).is_none()) {
            let ends = mesh.ends(h);
            let [a, b] = ends.map(|n| point_of(node_at[n.index()]));
            let [p, q] = ends.map(|n| mesh.point(n));
            let line = p.zip(q).and_then(|(p, q)| names.line_of([p, q]));
            sides.push(([a.min(b), a.max(b)], [a, b], line));
        }
        sides.sort_unstable();
        let mut line_of: Vec<Option<u32>> = Vec::new();
        let (of_line, _) = line_tags(names);
        let [boundary, inside] = [BOUNDARY, INSIDE].map(|kind| of_line[names.lines.len() + kind as usize - 1]);
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            let named = same[0].2.map(|line| of_line[line as usize]);
            file.lines.push(same[0].1);
            line_of.push(same[0].2);
            file.line_tags.push(named.unwrap_or(if same.len() == 1 { boundary } else { inside }));
        }
        let built_in = [boundary, inside].into_iter().zip(BUILT_IN);
        let lines = of_line.iter().copied().zip(names.lines.iter().map(|line| line.name.as_str())).chain(built_in);
        let faces = tags.iter().copied().zip(names.faces.iter().map(|face| face.name.as_str()));
        let has_line: BTreeSet<u32> = file.line_tags.iter().copied().collect();
        let all =
            lines.filter(|line| has_line.contains(&line.0)).map(|line| (1, line)).chain(faces.map(|face| (2, face)));
        let mut known = BTreeSet::new();
        for (dimension, (tag, name)) in all {
            if known.insert((dimension, tag)) {
                file.groups.push(Group { dimension, tag, name: name.to_owned() });
            }
        }
        further::add(&mut export, mesh, names, &line_of, &tags);
        (export, node_at)
    }

    /// The mesh as input of the statistics.
    pub fn measured(&self) -> Measured<'_> {
        Measured {
            uv: &self.uv,
            points: &self.points,
            triangles: &self.triangles,
            quads: &self.quads,
            surfaces: self.atlas.as_deref().map(|atlas| OnSurfaces { atlas, xyz: &self.file.points }),
        }
    }
}

/// The ids of the nodes of each point, ascending: the first ones, the second ones and so on; -1 past the last one.
fn node_ids(mesh: &Mesh, point_of: &[PointId], points: usize) -> Vec<Data> {
    let mut ids: Vec<Vec<f64>> = Vec::new();
    for (node, point) in mesh.nodes().zip(point_of) {
        let free = ids.iter().position(|ids| ids[point.index()] < 0.0).unwrap_or(ids.len());
        if free == ids.len() {
            ids.push(vec![-1.0; points]);
        }
        ids[free][point.index()] = f64::from(node.0);
    }
    let name = |rank: usize| if rank == 1 { NODE_ID.to_owned() } else { format!("{NODE_ID}_{rank}") };
    ids.into_iter().zip(1..).map(|(values, rank)| Data { name: name(rank), values }).collect()
}

/// The tag of each face: that of the file, otherwise the next free one from 1 in the order of the names, equal for
/// faces of one name (the charts of a region).
fn face_tags(mesh: &Mesh, names: &Names) -> Vec<u32> {
    let further = names.further.faces.iter().flat_map(|groups| &groups.groups);
    let mut tags = tags_of(&names.faces, &further.filter_map(|(named, _)| named.tag).collect());
    // Faces without names get their numbers.
    let faces = mesh.elements().map(|e| mesh.region(e) + 1).max().unwrap_or(0);
    (tags.len() as u32..faces).for_each(|face| tags.push(face + 1));
    tags
}

/// The tags of the lines, then of `boundary` and `inside`; and the tag of the merging front.
fn line_tags(names: &Names) -> (Vec<u32>, u32) {
    let further: BTreeSet<u32> = names.further.lines.iter().filter_map(|(named, _)| named.tag).collect();
    let mut tags = tags_of(&names.lines, &further);
    // The default tags, or the next free ones.
    for own in [BOUNDARY, INSIDE, FRONT_TAG] {
        let free = (own..).find(|tag| !tags.contains(tag) && !further.contains(tag)).unwrap_or(own);
        tags.push(free);
    }
    let front = tags.pop().unwrap_or(FRONT_TAG);
    (tags, front)
}

/// The tags of names: their own, or the next free ones that no further group has either.
fn tags_of(named: &[Named], further: &BTreeSet<u32>) -> Vec<u32> {
    let given: BTreeSet<u32> = named.iter().filter_map(|named| named.tag).collect();
    let mut free = (1..).filter(|tag| !given.contains(tag) && !further.contains(tag));
    let mut known: FxHashMap<&str, u32> = FxHashMap::default();
    named
        .iter()
        .map(|named| match named.tag {
            Some(tag) => tag,
            None => *known.entry(&named.name).or_insert_with(|| free.next().unwrap_or(u32::MAX)),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::kernel::Metric2;
    use crate::core::mesh::{Mesh, NewElement, NodeId, TriangleSet};

    /// Two triangles of two faces with doubled nodes along their common line.
    fn two_faces(points: [u32; 6], names: [&str; 2]) -> Export {
        let uv = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        let set = TriangleSet {
            uv: uv.map(|(x, y)| DVec2::new(x, y)).to_vec(),
            point: points.map(PointId).to_vec(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            region: vec![0, 1],
            ..TriangleSet::default()
        };
        let mesh = Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); 6]);
        Export::of(&mesh, &Names::of_faces(names.map(Named::new).to_vec()))
    }

    #[test]
    fn copies_of_a_node_are_one_point_and_the_line_between_faces_is_inside() {
        let export = two_faces([0, 1, 2, 1, 3, 2], ["left", "right"]);
        assert_eq!((export.uv.len(), export.file.points.len()), (6, 4));
        assert_eq!(export.file.triangles, [[0, 1, 2], [1, 3, 2]]);
        assert_eq!(export.file.triangle_tags, [1, 2]);
        // Points 1 and 2 have a node of each face.
        let ids: Vec<_> = export.file.point_data.iter().map(|data| (&data.name[..], &data.values[..])).collect();
        assert_eq!(ids, [("node_id", &[0.0, 1.0, 2.0, 4.0][..]), ("node_id_2", &[-1.0, 3.0, 5.0, -1.0])]);
        let inside: Vec<_> = (0..5).filter(|i| export.file.line_tags[*i] == INSIDE).collect();
        assert_eq!(inside.len(), 1);
        assert_eq!(export.file.lines.len(), 5);
        let names: Vec<_> = export.file.groups.iter().map(|g| g.name.as_str()).collect();
        assert_eq!(names, ["boundary", "inside", "left", "right"]);
    }

    #[test]
    fn faces_of_one_name_are_one_group() {
        let named = |a: &str, b: &str| {
            let file = two_faces([0, 1, 2, 1, 3, 2], [a, b]).file;
            (file.triangle_tags, file.groups.iter().filter(|g| g.dimension == 2).count())
        };
        assert_eq!(named("shell", "shell"), (vec![1, 1], 1));
        assert_eq!(named("shell", "rib"), (vec![1, 2], 2));
    }

    #[test]
    fn a_state_has_its_front_as_lines_and_live_level_and_region_at_elements() {
        let uv = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (2.0, 0.0)];
        let set = TriangleSet {
            uv: uv.map(|(x, y)| DVec2::new(x, y)).to_vec(),
            point: (0..5).map(PointId).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3], [1, 4, 2]],
            region: vec![0; 3],
            ..TriangleSet::default()
        };
        let mut mesh = Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); 5]);
        let corners = [0, 1, 2, 3].map(NodeId);
        let new = mesh.replace(&[ElementId(0), ElementId(1)], &[NewElement::quad(corners, 0)]);
        mesh.set_level(new[0], 4);
        let file = Export::of_state(&mesh, &Names::of_faces(vec![Named::new("plate")])).file;
        assert_eq!((file.triangles.len(), file.quads.len()), (1, 1));
        let values = |all: &[Data]| all.iter().map(|d| (d.name.clone(), d.values.clone())).collect::<Vec<_>>();
        let expected =
            [("element_id", [2.0, 1.0]), ("live", [1.0, 0.0]), ("level", [0.0, 4.0]), ("region", [1.0, 1.0])];
        assert_eq!(values(&file.element_data), expected.map(|(name, values)| (name.to_owned(), values.to_vec())));
        assert_eq!(values(&file.point_data), [("node_id".to_owned(), vec![0.0, 1.0, 2.0, 3.0, 4.0])]);
        let mut front: Vec<_> =
            (0..file.lines.len()).filter(|i| file.line_tags[*i] == FRONT_TAG).map(|i| file.lines[i]).collect();
        front.sort_unstable();
        assert_eq!(front, [[1, 4], [2, 1], [4, 2]]);
        assert_eq!(file.group_name(1, FRONT_TAG), Some("front"));
    }

    #[test]
    fn the_sides_of_a_crack_have_separate_points_and_lines() {
        let export = two_faces([0, 1, 2, 3, 4, 5], ["left", "right"]);
        assert_eq!((export.file.points.len(), export.file.lines.len()), (6, 6));
        assert!(export.file.line_tags.iter().all(|tag| *tag == BOUNDARY));
    }
}
