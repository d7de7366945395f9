//! Edges of a list of triangles, with the triangles at each: no matter how many, and which way they turn.

use glam::{DVec2, DVec3};

use crate::core::fault::Fault;
use crate::core::progress::Cancel;
use crate::core::soup::counting::Elements;

/// Triangles in space by the places of their corners in a list of points; whoever makes one has checked the places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// Corners.
    pub points: Vec<DVec3>,
    /// Triangles, each with its outside on the side from which it is seen anticlockwise.
    pub triangles: Vec<[u32; 3]>,
    /// The region of each triangle.
    pub region: Vec<u32>,
    /// Where the corners of each triangle lie on a texture, if they do; empty where there is none.
    pub texture: Vec<Option<[DVec2; 3]>>,
    /// The element of the file that each triangle comes from ([`MeshFile::origins`](crate::core::soup::mesh_file::MeshFile::origins)); empty
    /// where there is no file.
    pub origin: Vec<u32>,
    /// What the elements of the file are called.
    pub elements: Elements,
    /// Edges on lines that are kept whatever the shape is there: their ends, the smaller one first, and the number of the line; by ascending ends.
    pub lines: Vec<([u32; 2], u32)>,
}

/// A side of a triangle: the one that begins at corner `corner % 3` of triangle `corner / 3`.
pub type Corner = u32;

/// An edge and the sides that lie on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge<'a> {
    /// Its ends, the smaller one first.
    pub ends: [u32; 2],
    /// The sides, by ascending corner.
    pub sides: &'a [Corner],
}

/// Things `0..n` by the group that each belongs to, groups and the things of each ascending: in one pass, where sorting so many
/// would take as long as all the rest.
pub(super) struct Groups {
    start: Vec<u32>,
    /// The things, group after group.
    pub items: Vec<u32>,
}

impl Groups {
    /// Groups `0..groups` of so many things.
    pub fn of(things: usize, groups: usize, group: impl Fn(u32) -> u32) -> Groups {
        let mut start = vec![0; groups + 1];
        (0..things as u32).for_each(|thing| start[group(thing) as usize + 1] += 1);
        for k in 0..groups {
            start[k + 1] += start[k];
        }
        let mut free = start.clone();
        let mut items = vec![0; things];
        for thing in 0..things as u32 {
            let place = &mut free[group(thing) as usize];
            items[*place as usize] = thing;
            *place += 1;
        }
        Groups { start, items }
    }

    /// The things of a group.
    pub fn get(&self, group: u32) -> &[u32] {
        &self.items[self.start[group as usize] as usize..self.start[group as usize + 1] as usize]
    }

    /// Each group, to put its things into another order.
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
    /// Where the sides of each edge begin, and at last their number.
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

    /// As [`Edges::of`], unless the work is told to end.
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

    /// How many there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// An edge by its place.
    pub fn get(&self, edge: usize) -> Edge<'_> {
        let sides = self.start[edge] as usize..self.start[edge + 1] as usize;
        Edge { ends: self.ends[edge], sides: &self.sides[sides] }
    }

    /// The place of the edge between two points.
    pub fn between(&self, [a, b]: [u32; 2]) -> Option<usize> {
        self.ends.binary_search(&[a.min(b), a.max(b)]).ok()
    }

    /// The place of the edge on which a side lies.
    pub fn of_side(&self, corner: Corner) -> usize {
        self.of_side[corner as usize] as usize
    }
}

impl Triangles {
    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|k| self.points[k as usize])
    }

    /// Twice the area of a triangle along its outer normal.
    pub fn area_vector(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a)
    }

    /// What triangles are called, as the file counts its elements ([`Elements::told`]).
    pub fn told(&self, triangles: &[u32]) -> String {
        let origin = |&triangle: &u32| self.origin.get(triangle as usize).copied().unwrap_or(triangle);
        self.elements.describe(&triangles.iter().map(origin).collect::<Vec<_>>())
    }

    /// Where a side begins and ends.
    pub fn side(&self, corner: Corner) -> [u32; 2] {
        let t = self.triangles[corner as usize / 3];
        [t[corner as usize % 3], t[(corner as usize + 1) % 3]]
    }
}
