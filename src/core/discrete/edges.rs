//! Edges of a list of triangles, with any number of triangles at each, in any orientation.

use glam::{DVec2, DVec3};

use crate::core::fault::Fault;
use crate::core::progress::Cancel;
use crate::core::soup::Elements;

/// Triangles in space by point index; whoever builds this has checked the indices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// The points.
    pub points: Vec<DVec3>,
    /// Triangles, anticlockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The region of each triangle.
    pub region: Vec<u32>,
    /// Texture coordinates of the corners of each triangle, if they have any; empty without a texture.
    pub texture: Vec<Option<[DVec2; 3]>>,
    /// The element of the file that each triangle belongs to
    /// ([`MeshFile::origins`](crate::core::soup::MeshFile::origins)); empty without a file.
    pub origin: Vec<u32>,
    /// The numbering of the file's elements, for messages.
    pub elements: Elements,
    /// Edges on lines of the file, which are kept whatever the shape: ends, the smaller first, and index of the line;
    /// by ascending ends.
    pub lines: Vec<([u32; 2], u32)>,
    /// Hard points: points that become nodes, ascending, each with its number.
    pub hard: Vec<(u32, u32)>,
}

impl Triangles {
    /// The number of a hard point.
    pub fn hard_number(&self, point: u32) -> Option<u32> {
        self.hard.binary_search_by_key(&point, |hard| hard.0).ok().map(|k| self.hard[k].1)
    }
}

/// A side of a triangle: it begins at corner `corner % 3` of triangle `corner / 3`.
pub type Corner = u32;

/// An edge and the triangle sides on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge<'a> {
    /// Its ends, the smaller first.
    pub ends: [u32; 2],
    /// The sides, by ascending corner.
    pub sides: &'a [Corner],
}

/// Items `0..n` by group, both ascending: a counting sort, since sorting by comparison would take as long as all the
/// rest.
pub(super) struct Groups {
    start: Vec<u32>,
    /// The items, group after group.
    pub items: Vec<u32>,
}

impl Groups {
    /// Sorts `count` items into groups `0..groups`.
    pub fn of(count: usize, groups: usize, group: impl Fn(u32) -> u32) -> Groups {
        let mut start = vec![0; groups + 1];
        (0..count as u32).for_each(|item| start[group(item) as usize + 1] += 1);
        for k in 0..groups {
            start[k + 1] += start[k];
        }
        let mut free = start.clone();
        let mut items = vec![0; count];
        for item in 0..count as u32 {
            let next = &mut free[group(item) as usize];
            items[*next as usize] = item;
            *next += 1;
        }
        Groups { start, items }
    }

    /// The items of a group.
    pub fn get(&self, group: u32) -> &[u32] {
        &self.items[self.start[group as usize] as usize..self.start[group as usize + 1] as usize]
    }

    /// Each group, for sorting its items.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut [u32]> {
        let mut rest = &mut self.items[..];
        self.start.windows(2).map(move |range| {
            let (group, after) = std::mem::take(&mut rest).split_at_mut((range[1] - range[0]) as usize);
            rest = after;
            group
        })
    }
}

/// All edges, by ascending ends.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    ends: Vec<[u32; 2]>,
    /// Offset of the sides of each edge, then their number.
    start: Vec<u32>,
    sides: Vec<Corner>,
    /// The edge of each side.
    of_side: Vec<u32>,
}

impl Edges {
    /// The edges of the triangles.
    pub fn of(triangles: &[[u32; 3]]) -> Edges {
        Edges::unless(triangles, &Cancel::default()).unwrap_or_default()
    }

    /// As [`Edges::of`], with cancellation.
    ///
    /// # Errors
    /// [`Fault::stopped`].
    pub fn unless(triangles: &[[u32; 3]], cancel: &Cancel) -> Result<Edges, Fault> {
        let key = |corner: Corner| {
            let t = triangles[corner as usize / 3];
            let [a, b] = [t[corner as usize % 3], t[(corner as usize + 1) % 3]];
            [a.min(b), a.max(b)]
        };
        let nodes = triangles.as_flattened().iter().max().map_or(0, |&last| last as usize + 1);
        let mut sides = Groups::of(3 * triangles.len(), nodes, |corner| key(corner)[0]);
        cancel.check()?;
        sides.iter_mut().for_each(|sides| sides.sort_unstable_by_key(|&corner| (key(corner)[1], corner)));
        cancel.check()?;
        let sides = sides.items;
        let mut edges = Edges { of_side: vec![0; sides.len()], ..Edges::default() };
        for (i, &corner) in sides.iter().enumerate() {
            if edges.ends.last() != Some(&key(corner)) {
                edges.ends.push(key(corner));
                edges.start.push(i as u32);
            }
            edges.of_side[corner as usize] = edges.ends.len() as u32 - 1;
        }
        edges.start.push(sides.len() as u32);
        edges.sides = sides;
        cancel.check()?;
        Ok(edges)
    }

    /// Number of edges.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// An edge by its index.
    pub fn get(&self, edge: usize) -> Edge<'_> {
        let sides = self.start[edge] as usize..self.start[edge + 1] as usize;
        Edge { ends: self.ends[edge], sides: &self.sides[sides] }
    }

    /// The index of the edge between two points.
    pub fn between(&self, [a, b]: [u32; 2]) -> Option<usize> {
        self.ends.binary_search(&[a.min(b), a.max(b)]).ok()
    }

    /// The index of the edge of a side.
    pub fn of_side(&self, corner: Corner) -> usize {
        self.of_side[corner as usize] as usize
    }
}

impl Triangles {
    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|k| self.points[k as usize])
    }

    /// Twice the area vector of a triangle, along its outer normal.
    pub fn area_vector(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// Names triangles for a message by the numbers of the file ([`Elements::describe`]).
    pub fn describe(&self, triangles: &[u32]) -> String {
        let origin = |&triangle: &u32| self.origin.get(triangle as usize).copied().unwrap_or(triangle);
        self.elements.describe(&triangles.iter().map(origin).collect::<Vec<_>>())
    }

    /// The ends of a side, in its direction.
    pub fn side(&self, corner: Corner) -> [u32; 2] {
        let t = self.triangles[corner as usize / 3];
        [t[corner as usize % 3], t[(corner as usize + 1) % 3]]
    }
}
