//! A mesh as files know it: points and elements by index, with tags, groups and data; no connectivity.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::counting::{Counting, Elements, things_told};
use crate::core::kernel::tensor::Metric3;
use crate::core::mesh::names::Named;

/// The name of the group of lines that are the merging front of a mesh on the way.
pub const FRONT: &str = "front";
/// The names of the groups of lines that every mesh has: those with elements on one side, and those with elements on both.
pub const BUILT_IN: [&str; 2] = ["boundary", "inside"];

/// A named group of elements (Gmsh's physical group).
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// 0 points, 1 lines, 2 surfaces.
    pub dimension: u8,
    /// The tag that elements carry.
    pub tag: u32,
    /// Its name.
    pub name: String,
}

/// One number for each point or each element, with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    /// Name as files show it (`quality`, `live`).
    pub name: String,
    /// One value each: for elements, triangles come first and quadrilaterals after them.
    pub values: Vec<f64>,
}

/// Points and elements of a surface mesh; indices are zero-based and have been checked against `points` by whoever
/// made this.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    /// Coordinates in space.
    pub points: Vec<DVec3>,
    /// Boundary or curve segments.
    pub lines: Vec<[u32; 2]>,
    /// Triangles, anticlockwise seen from outside (in the plane: from +z).
    pub triangles: Vec<[u32; 3]>,
    /// Quadrilaterals, likewise.
    pub quads: Vec<[u32; 4]>,
    /// Polygons of five corners and more, likewise.
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
    /// The metric at each point, where the file has one.
    pub metric: Option<Vec<Metric3>>,
    /// The place of each point in the parametric plane, where the file has one.
    pub uv: Option<Vec<DVec2>>,
    /// Numbers at points.
    pub point_data: Vec<Data>,
    /// Numbers at elements (triangles first, then quadrilaterals).
    pub element_data: Vec<Data>,
    /// Texture coordinates, where the file has them.
    pub texture: Option<Texture>,
    /// Element types that the file has and that are not read, with their counts ("tetrahedron", 12).
    pub skipped: Vec<(String, usize)>,
    /// How the file counts its points and elements.
    pub counting: Counting,
}

/// Where the corners of elements lie on a texture, by the number of the place: a point may lie at several places, one for each
/// side of a seam. Numbers may lead nowhere.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Texture {
    /// The places.
    pub places: Vec<DVec2>,
    /// For each triangle the places of its corners.
    pub triangles: Vec<[u32; 3]>,
    /// Likewise for each quadrilateral.
    pub quads: Vec<[u32; 4]>,
    /// And for each polygon.
    pub polygons: Vec<Vec<u32>>,
}

impl Texture {
    /// The number of no place.
    pub const NOWHERE: u32 = u32::MAX;

    /// Takes in the places of a triangle's corners; nothing where the file has no places so far.
    pub(in crate::core) fn place_triangle(&mut self, triangle: usize, places: [u32; 3]) {
        if !self.places.is_empty() {
            self.triangles.resize(triangle, [Self::NOWHERE; 3]);
            self.triangles.push(places);
        }
    }

    /// Likewise of a quadrilateral.
    pub(in crate::core) fn place_quad(&mut self, quad: usize, places: [u32; 4]) {
        if !self.places.is_empty() {
            self.quads.resize(quad, [Self::NOWHERE; 4]);
            self.quads.push(places);
        }
    }

    /// The texture with something said of every element of a mesh; none where it has no places.
    pub(in crate::core) fn of_all(mut self, mesh: &MeshFile) -> Option<Texture> {
        if self.places.is_empty() {
            return None;
        }
        self.triangles.resize(mesh.triangles.len(), [Self::NOWHERE; 3]);
        self.quads.resize(mesh.quads.len(), [Self::NOWHERE; 4]);
        self.polygons.resize(mesh.polygons.len(), Vec::new());
        Some(self)
    }

    /// Where the corners of a triangle lie, if all lie somewhere.
    pub fn of_triangle(&self, triangle: usize) -> Option<[DVec2; 3]> {
        let place = |k: usize| {
            let place = self.triangles.get(triangle)?[k];
            self.places.get(place as usize).copied().filter(|p| p.is_finite() && p.abs().max_element() < 1e9)
        };
        Some([place(0)?, place(1)?, place(2)?])
    }
}

impl MeshFile {
    /// Whether every point lies in the plane z = 0.
    pub fn is_flat(&self) -> bool {
        self.points.iter().all(|p| p.z == 0.0)
    }

    /// Whether all points of a mesh that elements have lie in one plane of constant z.
    pub fn is_plane(&self) -> bool {
        let elements = self.triangles.as_flattened().iter().chain(self.quads.as_flattened());
        let points = elements.chain(self.polygons.iter().flatten()).filter_map(|&k| self.points.get(k as usize));
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in points {
            (low, high) = (low.min(*p), high.max(*p));
        }
        let extent = high - low;
        // Points that are not finite are refused with their numbers later on.
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

    /// The lines, by their place in `lines`, that are in a group of their own: not those that every mesh has anyway.
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

    /// The lines of the merging front, by their place in `lines`; none in a mesh that is no state of a conversion.
    pub fn front_lines(&self) -> impl Iterator<Item = usize> + '_ {
        let group = self.groups.iter().find(|group| group.dimension == 1 && group.name == FRONT);
        let is_front = move |i: &usize| group.is_some_and(|group| tag_of(&self.line_tags, *i) == group.tag);
        (0..self.lines.len()).filter(is_front)
    }

    /// The groups of elements, and of lines those that some of `lines` are in.
    pub(in crate::core) fn groups_with(&self, lines: &[usize]) -> impl Iterator<Item = &Group> {
        let tags: BTreeSet<u32> = lines.iter().map(|&i| tag_of(&self.line_tags, i)).collect();
        self.groups.iter().filter(move |group| match group.dimension {
            1 => tags.contains(&group.tag),
            dimension => dimension == 2,
        })
    }

    /// The first element at each of some lines, triangles before quadrilaterals, and which of its sides it is.
    pub(in crate::core) fn sides_at(&self, lines: &[usize]) -> Vec<Option<(usize, usize)>> {
        let key = |a: u32, b: u32| [a.min(b), a.max(b)];
        let ends = |&i: &usize| key(self.lines[i][0], self.lines[i][1]);
        let mut first: FxHashMap<[u32; 2], Option<(usize, usize)>> = lines.iter().map(|i| (ends(i), None)).collect();
        if first.is_empty() {
            return Vec::new();
        }
        let elements = self.triangles.iter().map(|t| &t[..]).chain(self.quads.iter().map(|q| &q[..]));
        for (number, corners) in elements.enumerate() {
            for (k, &corner) in corners.iter().enumerate() {
                if let Some(known) = first.get_mut(&key(corner, corners[(k + 1) % corners.len()])) {
                    known.get_or_insert((number, k));
                }
            }
        }
        lines.iter().map(|i| first[&ends(i)]).collect()
    }

    /// What the region of a tag is called.
    pub fn region(&self, tag: u32) -> Named {
        Named::tagged(self.group_name(2, tag).map_or_else(|| format!("region {tag}"), str::to_owned), tag)
    }

    /// The groups of lines by number, and the number of that of each line: none for lines without a tag, and for the merging front
    /// of a state, which says nothing about the shape.
    pub fn line_groups(&self) -> (Vec<Named>, Vec<Option<u32>>) {
        let tags: Vec<u32> = (0..self.lines.len()).map(|i| tag_of(&self.line_tags, i)).collect();
        let is_group = |tag: &u32| *tag > 0 && self.group_name(1, *tag) != Some(FRONT);
        let known: Vec<u32> = tags.iter().copied().filter(is_group).collect::<BTreeSet<u32>>().into_iter().collect();
        let name = |&tag: &u32| {
            Named::tagged(self.group_name(1, tag).map_or_else(|| format!("line {tag}"), str::to_owned), tag)
        };
        (
            known.iter().map(name).collect(),
            tags.iter().map(|tag| known.binary_search(tag).ok().map(|k| k as u32)).collect(),
        )
    }

    /// Where each triangle comes from once quadrilaterals and polygons are cut ([`MeshFile::triangulated`]): the place of its element
    /// among all triangles, then quadrilaterals, then polygons.
    pub fn origins(&self) -> Vec<u32> {
        let (triangles, quads) = (self.triangles.len() as u32, self.quads.len() as u32);
        let cut = |first: u32, corners: usize| std::iter::repeat_n(first, corners.saturating_sub(2));
        let mut origins: Vec<u32> = (0..triangles).collect();
        origins.extend((triangles..triangles + quads).flat_map(|place| cut(place, 4)));
        let polygons = (triangles + quads..).zip(&self.polygons);
        origins.extend(polygons.flat_map(|(place, polygon)| cut(place, polygon.len())));
        origins
    }

    /// Its elements, to be called by their numbers where the file is no more.
    pub fn elements(&self) -> Elements {
        let [triangles, quads, polygons] = [self.triangles.len(), self.quads.len(), self.polygons.len()];
        Elements::new([triangles, quads, polygons], self.counting.clone())
    }

    /// What elements are called: see [`Elements::told`].
    pub fn elements_told(&self, places: &[u32]) -> String {
        self.elements().told(places)
    }

    /// What points are called: "point 7", "points 3, 7 and 9".
    pub fn points_told(&self, points: &[u32]) -> String {
        let mut points = points.to_vec();
        points.sort_unstable();
        points.dedup();
        let numbers = points.iter().filter_map(|&point| self.counting.points.number(point as usize));
        things_told(["point", "points"], points.len(), numbers)
    }
}

/// The tensor back, if it is finite and positive definite.
pub(in crate::core) fn positive_definite(m: Metric3) -> Option<Metric3> {
    m.is_spd().then_some(m)
}

/// The tag of element `i`, 0 where there are no tags.
pub(in crate::core) fn tag_of(tags: &[u32], i: usize) -> u32 {
    tags.get(i).copied().unwrap_or(0)
}
