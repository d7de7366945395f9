//! A mesh as stored in a file: points, elements by index, tags, groups and data. Deliberately absent: connectivity.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::counting::{Counting, Elements, enumerate};
use crate::core::kernel::Metric3;
use crate::core::kernel::box_tree::extent;
use crate::core::mesh::Named;

/// The name of the group of lines that form the merging front of an intermediate mesh.
pub const FRONT: &str = "front";
/// The name of the element data that holds the ids by which events name elements.
pub const ELEMENT_ID: &str = "element_id";
/// The name of the point data that holds the ids by which events name nodes; of further nodes of a point, with `_2` and
/// so on.
pub const NODE_ID: &str = "node_id";
/// The names of the line groups of every exported mesh: lines with elements on one side, and with elements on both.
pub const BUILT_IN: [&str; 2] = ["boundary", "inside"];

/// A named group of elements (Gmsh's physical group).
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Dimension of its elements: 0 for points, 1 for lines, 2 for faces.
    pub dimension: u8,
    /// The tag of its elements.
    pub tag: u32,
    /// Its name.
    pub name: String,
}

/// Points in a group, or elements in a group besides the one of their tag.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Members {
    /// Dimension of the group: 0 for points, 1 for lines, 2 for faces.
    pub dimension: u8,
    /// The tag of the group; 0 for points that must be kept, but are in no group.
    pub tag: u32,
    /// The points, the lines, or the elements (triangles, then quadrilaterals, then polygons), by ascending index.
    pub of: Vec<u32>,
}

/// A named scalar field: one value for each point or element.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    /// Name in the file (`quality`, `live`).
    pub name: String,
    /// The values; for elements, triangles come before quadrilaterals.
    pub values: Vec<f64>,
}

/// Content of a file, other than elements, that is not read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Omitted {
    /// What it is ("keyword").
    pub kind: String,
    /// The names of what is of this kind, with their counts ("*MATERIAL", 2); empty where the kind says all.
    pub names: Vec<(String, usize)>,
}

/// Nodes of elements of second order that are no corners: they bend elements whose corners are in the mesh. A side has
/// one for all elements that share it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SecondOrder {
    /// The ends of a side, the smaller index first, and its node; each side once, by ascending ends.
    pub sides: Vec<([u32; 2], DVec3)>,
    /// The corners of a quadrilateral, and the node in its middle; each once, by ascending corners.
    pub centres: Vec<([u32; 4], DVec3)>,
}

/// Points and elements of a surface mesh. Indices are zero-based; whoever builds this has checked them against
/// `points`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    /// Coordinates in space.
    pub points: Vec<DVec3>,
    /// Boundary or curve segments.
    pub lines: Vec<[u32; 2]>,
    /// Triangles, anticlockwise seen from outside (in the plane, from +z).
    pub triangles: Vec<[u32; 3]>,
    /// Quadrilaterals, likewise.
    pub quads: Vec<[u32; 4]>,
    /// Polygons with five or more corners, likewise.
    pub polygons: Vec<Vec<u32>>,
    /// Tag of the group of each line; empty, or as long as `lines`.
    pub line_tags: Vec<u32>,
    /// Tag of the group of each triangle; empty, or as long as `triangles`.
    pub triangle_tags: Vec<u32>,
    /// Tag of the group of each quadrilateral; empty, or as long as `quads`.
    pub quad_tags: Vec<u32>,
    /// Tag of the group of each polygon; empty, or as long as `polygons`.
    pub polygon_tags: Vec<u32>,
    /// Names of the groups.
    pub groups: Vec<Group>,
    /// The points in groups, and the elements that are in groups besides the one of their tag.
    pub members: Vec<Members>,
    /// The metric tensor at each point, if the file has one.
    pub metric: Option<Vec<Metric3>>,
    /// The position of each point in the parametric plane, if the file has one.
    pub uv: Option<Vec<DVec2>>,
    /// Scalar fields at points.
    pub point_data: Vec<Data>,
    /// Scalar fields at elements (triangles first, then quadrilaterals).
    pub element_data: Vec<Data>,
    /// Texture coordinates, if the file has them.
    pub texture: Option<Texture>,
    /// Element types in the file that are not read, with their counts ("tetrahedron", 12).
    pub skipped: Vec<(String, usize)>,
    /// What else of the file is not read.
    pub omitted: Vec<Omitted>,
    /// The nodes that elements of second order have besides their corners.
    pub second_order: SecondOrder,
    /// How the file numbers its points and elements.
    pub counting: Counting,
}

/// Texture coordinates of the corners of elements, as indices into `uv`: a point has one for each side of a seam.
/// Indices may be out of range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Texture {
    /// The texture coordinates.
    pub uv: Vec<DVec2>,
    /// For each triangle, those of its corners.
    pub triangles: Vec<[u32; 3]>,
    /// Likewise for each quadrilateral.
    pub quads: Vec<[u32; 4]>,
    /// Likewise for each polygon.
    pub polygons: Vec<Vec<u32>>,
}

impl Texture {
    /// The index of a corner without a texture coordinate.
    pub const NONE: u32 = u32::MAX;

    /// Sets the corners of a triangle, unless the file has no texture coordinates so far.
    pub(in crate::core) fn set_triangle(&mut self, triangle: usize, corners: [u32; 3]) {
        if !self.uv.is_empty() {
            self.triangles.resize(triangle, [Self::NONE; 3]);
            self.triangles.push(corners);
        }
    }

    /// Likewise for a quadrilateral.
    pub(in crate::core) fn set_quad(&mut self, quad: usize, corners: [u32; 4]) {
        if !self.uv.is_empty() {
            self.quads.resize(quad, [Self::NONE; 4]);
            self.quads.push(corners);
        }
    }

    /// The texture with an entry for every element of the mesh; `None` if it has no coordinates.
    pub(in crate::core) fn filled(mut self, mesh: &MeshFile) -> Option<Texture> {
        if self.uv.is_empty() {
            return None;
        }
        self.triangles.resize(mesh.triangles.len(), [Self::NONE; 3]);
        self.quads.resize(mesh.quads.len(), [Self::NONE; 4]);
        self.polygons.resize(mesh.polygons.len(), Vec::new());
        Some(self)
    }

    /// The texture coordinates of a triangle's corners, if all three exist and are of usable magnitude.
    pub fn of_triangle(&self, triangle: usize) -> Option<[DVec2; 3]> {
        let corner = |k: usize| {
            let index = self.triangles.get(triangle)?[k];
            self.uv.get(index as usize).copied().filter(|p| p.is_finite() && p.abs().max_element() < 1e9)
        };
        Some([corner(0)?, corner(1)?, corner(2)?])
    }
}

impl MeshFile {
    /// Whether all its elements are quadrilaterals.
    pub fn is_of_quads(&self) -> bool {
        !self.quads.is_empty() && self.triangles.is_empty() && self.polygons.is_empty()
    }

    /// Whether every point lies in the plane z = 0.
    pub fn is_flat(&self) -> bool {
        self.points.iter().all(|p| p.z == 0.0)
    }

    /// Whether all points used by elements lie in one plane of constant z.
    pub fn is_plane(&self) -> bool {
        let elements = self.triangles.as_flattened().iter().chain(self.quads.as_flattened());
        let points = elements.chain(self.polygons.iter().flatten()).filter_map(|&k| self.points.get(k as usize));
        let SecondOrder { sides, centres } = &self.second_order;
        let middles = sides.iter().map(|side| side.1).chain(centres.iter().map(|centre| centre.1));
        let (low, high) = extent(points.copied().chain(middles));
        let extent = high - low;
        // Points that are not finite are refused later, by number.
        let least = 1e-9 * extent.x.max(extent.y).max(high.z.abs());
        extent.z.partial_cmp(&least) != Some(Ordering::Greater)
    }

    /// The name of a group.
    pub fn group_name(&self, dimension: u8, tag: u32) -> Option<&str> {
        self.groups
            .iter()
            .find(|group| group.dimension == dimension && group.tag == tag)
            .map(|group| group.name.as_str())
    }

    /// Indices of the lines in named groups other than [`BUILT_IN`].
    pub fn own_lines(&self) -> Vec<usize> {
        let built_in: Vec<u32> = self
            .groups
            .iter()
            .filter(|group| group.dimension == 1 && BUILT_IN.contains(&group.name.as_str()))
            .map(|group| group.tag)
            .collect();
        let is_own = |i: &usize| !matches!(tag_of(&self.line_tags, *i), tag if tag == 0 || built_in.contains(&tag));
        (0..self.lines.len()).filter(is_own).collect()
    }

    /// Indices of the lines of the merging front; none unless the mesh is an intermediate state.
    pub fn front_lines(&self) -> impl Iterator<Item = usize> + '_ {
        let group = self.groups.iter().find(|group| group.dimension == 1 && group.name == FRONT);
        let is_front = move |i: &usize| group.is_some_and(|group| tag_of(&self.line_tags, *i) == group.tag);
        (0..self.lines.len()).filter(is_front)
    }

    /// The corners and the tag of each triangle, then of each quadrilateral.
    pub(in crate::core) fn faces(&self) -> impl Iterator<Item = (&[u32], u32)> {
        let triangles = self.triangles.iter().enumerate().map(|(i, t)| (&t[..], tag_of(&self.triangle_tags, i)));
        triangles.chain(self.quads.iter().enumerate().map(|(i, q)| (&q[..], tag_of(&self.quad_tags, i))))
    }

    /// The groups of faces, and the groups of the given lines.
    pub(in crate::core) fn groups_with(&self, lines: &[usize]) -> impl Iterator<Item = &Group> {
        let tags: BTreeSet<u32> = lines.iter().map(|&i| tag_of(&self.line_tags, i)).collect();
        self.groups.iter().filter(move |group| match group.dimension {
            1 => tags.contains(&group.tag),
            dimension => dimension == 2,
        })
    }

    /// For each of the given lines, the first element with that side (triangles before quadrilaterals), and which side
    /// it is.
    pub(in crate::core) fn sides_at(&self, lines: &[usize]) -> Vec<Option<(usize, usize)>> {
        let key = |a: u32, b: u32| [a.min(b), a.max(b)];
        let ends = |&i: &usize| key(self.lines[i][0], self.lines[i][1]);
        let mut first: FxHashMap<[u32; 2], Option<(usize, usize)>> = lines.iter().map(|i| (ends(i), None)).collect();
        if first.is_empty() {
            return Vec::new();
        }
        for (number, (corners, _)) in self.faces().enumerate() {
            for (k, &corner) in corners.iter().enumerate() {
                if let Some(known) = first.get_mut(&key(corner, corners[(k + 1) % corners.len()])) {
                    known.get_or_insert((number, k));
                }
            }
        }
        lines.iter().map(|i| first[&ends(i)]).collect()
    }

    /// The region with a tag: the name of its group, or "region" and the tag.
    pub fn region(&self, tag: u32) -> Named {
        self.named(2, tag)
    }

    /// For each triangle of [`MeshFile::triangulated`], the index of its original element, counting triangles, then
    /// quadrilaterals, then polygons.
    pub fn origins(&self) -> Vec<u32> {
        let (triangles, quads) = (self.triangles.len() as u32, self.quads.len() as u32);
        let cut = |first: u32, corners: usize| std::iter::repeat_n(first, corners.saturating_sub(2));
        let mut origins: Vec<u32> = (0..triangles).collect();
        origins.extend((triangles..triangles + quads).flat_map(|place| cut(place, 4)));
        let polygons = (triangles + quads..).zip(&self.polygons);
        origins.extend(polygons.flat_map(|(place, polygon)| cut(place, polygon.len())));
        origins
    }

    /// The numbering of its elements, for messages after the file is gone.
    pub fn elements(&self) -> Elements {
        let [triangles, quads, polygons] = [self.triangles.len(), self.quads.len(), self.polygons.len()];
        Elements { triangles, quads, polygons, counting: self.counting.clone() }
    }

    /// Appends a triangle, quadrilateral or polygon with its number in the file. Returns the tags of its kind, to which
    /// the caller may append one; `None`, and no element, with fewer than three corners.
    pub(in crate::core) fn push_face(&mut self, corners: &[u32], number: u64) -> Option<&mut Vec<u32>> {
        match *corners {
            [a, b, c] => {
                self.counting.triangles.push(self.triangles.len(), number);
                self.triangles.push([a, b, c]);
                Some(&mut self.triangle_tags)
            }
            [a, b, c, d] => {
                self.counting.quads.push(self.quads.len(), number);
                self.quads.push([a, b, c, d]);
                Some(&mut self.quad_tags)
            }
            [] | [_] | [_, _] => None,
            _ => {
                self.counting.polygons.push(self.polygons.len(), number);
                self.polygons.push(corners.to_vec());
                Some(&mut self.polygon_tags)
            }
        }
    }

    /// Clears the tags of each kind of element that has no tag but 0.
    pub(in crate::core) fn clear_zero_tags(&mut self) {
        let tags = [&mut self.line_tags, &mut self.triangle_tags, &mut self.quad_tags, &mut self.polygon_tags];
        for tags in tags {
            if tags.iter().all(|&tag| tag == 0) {
                *tags = Vec::new();
            }
        }
    }

    /// Names elements for a message: see [`Elements::describe`].
    pub fn describe_elements(&self, indices: &[u32]) -> String {
        self.elements().describe(indices)
    }

    /// Names points for a message: "point 7", "points 3, 7 and 9".
    pub fn describe_points(&self, points: &[u32]) -> String {
        let mut points = points.to_vec();
        points.sort_unstable();
        points.dedup();
        let numbers = points.iter().filter_map(|&point| self.counting.points.number(point as usize));
        enumerate(["point", "points"], points.len(), numbers)
    }
}

/// The tag of element `i`; 0 without tags.
pub(in crate::core) fn tag_of(tags: &[u32], i: usize) -> u32 {
    tags.get(i).copied().unwrap_or(0)
}
