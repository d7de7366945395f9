//! Points of borders that are close to points or sides of elements that they do not belong to.

use glam::DVec3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::core::progress::Cancel;

/// A point is close to another, or to a side, below this fraction of the shortest side at either of them.
pub const CLOSE: f64 = 0.1;
/// A point is beside a side, rather than beside an end of it, where its foot is this fraction of the side inside.
const INSIDE: f64 = 1e-6;
/// Limit of the pairs that are measured, for each point and side: many triangles around one place make many pairs.
const PAIRS: usize = 64;
/// Points and sides looked at between two checks for cancellation.
const BATCH: usize = 1 << 12;

/// A point of a border that is close to another point, or to a side, without an element that has both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Close {
    /// The point.
    pub point: u32,
    /// How far away the other is.
    pub distance: f64,
    /// The shortest side at either of them.
    pub local: f64,
}

/// Items by group, each group ascending.
struct Lists {
    start: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    fn get(&self, group: u32) -> &[u32] {
        &self.items[self.start[group as usize] as usize..self.start[group as usize + 1] as usize]
    }
}

/// The elements of a mesh with their sides: which points are on a border, and what is at each point.
pub struct Borders<'a> {
    points: &'a [DVec3],
    /// The corners of each element.
    corners: Lists,
    /// The elements at each point.
    elements: Lists,
    /// The sides of all elements, ascending, each with its ends in ascending order and its element.
    sides: Vec<([u32; 2], u32)>,
    /// Whether each point is an end of a side of one element only.
    pub is_border: Vec<bool>,
    /// The length of the shortest side at each point; infinite without any.
    pub shortest: Vec<f64>,
}

impl<'a> Borders<'a> {
    /// Of elements whose corners all exist.
    pub fn of<'f>(points: &'a [DVec3], faces: impl Iterator<Item = &'f [u32]>) -> Borders<'a> {
        let mut corners = Lists { start: vec![0], items: Vec::new() };
        let mut sides = Vec::new();
        for (element, face) in (0..).zip(faces) {
            corners.items.extend_from_slice(face);
            corners.start.push(corners.items.len() as u32);
            let ends = face.iter().zip(face.iter().cycle().skip(1)).map(|(&a, &b)| [a.min(b), a.max(b)]);
            sides.extend(ends.filter(|[a, b]| a != b).map(|ends| (ends, element)));
        }
        sides.sort_unstable();
        let mut elements = Lists { start: vec![0; points.len() + 1], items: vec![0; corners.items.len()] };
        corners.items.iter().for_each(|&k| elements.start[k as usize + 1] += 1);
        (0..points.len()).for_each(|k| elements.start[k + 1] += elements.start[k]);
        let mut free = elements.start.clone();
        for element in 0..corners.start.len() as u32 - 1 {
            for &k in corners.get(element) {
                elements.items[free[k as usize] as usize] = element;
                free[k as usize] += 1;
            }
        }
        let (mut is_border, mut shortest) = (vec![false; points.len()], vec![f64::INFINITY; points.len()]);
        for alike in sides.chunk_by(|a, b| a.0 == b.0) {
            let ends = alike[0].0.map(|end| end as usize);
            let long = points[ends[0]].distance(points[ends[1]]);
            for end in ends {
                is_border[end] |= alike.len() == 1;
                shortest[end] = shortest[end].min(long);
            }
        }
        Borders { points, corners, elements, sides, is_border, shortest }
    }

    /// The mean length of the sides.
    pub fn mean_side(&self) -> f64 {
        let long = |side: &([u32; 2], u32)| {
            let [a, b] = side.0.map(|end| self.points[end as usize]);
            a.distance(b)
        };
        self.sides.iter().map(long).sum::<f64>() / self.sides.len().max(1) as f64
    }

    /// The elements at a point.
    pub fn elements_at(&self, point: u32) -> &[u32] {
        self.elements.get(point)
    }

    /// The corners of an element.
    pub fn corners(&self, element: u32) -> &[u32] {
        self.corners.get(element)
    }

    /// Whether an element has both points.
    fn are_of_one_element(&self, a: u32, b: u32) -> bool {
        self.elements_at(a).iter().any(|&element| self.corners(element).contains(&b))
    }

    /// What is [`CLOSE`] to the points of the borders, by point; empty when cancelled. Of a mesh with very many
    /// triangles around one place, only a part of it.
    pub fn close(&self, cancel: &Cancel) -> Vec<Close> {
        let (mut found, mut left) = (Vec::new(), PAIRS * (self.points.len() + self.sides.len()));
        let boxed = |k: u32| {
            let (p, far) = (self.points[k as usize], DVec3::splat(CLOSE * self.shortest[k as usize]));
            GeomWithData::new(Rectangle::from_corners((p - far).to_array(), (p + far).to_array()), k)
        };
        let border: Vec<u32> = (0..self.points.len() as u32).filter(|&k| self.is_border[k as usize]).collect();
        if border.is_empty() {
            return found;
        }
        let tree: RTree<GeomWithData<Rectangle<[f64; 3]>, u32>> =
            RTree::bulk_load(border.into_iter().map(boxed).collect());
        for (other, &p) in (0_u32..).zip(self.points) {
            if (other as usize).is_multiple_of(BATCH) && cancel.is_asked() {
                return Vec::new();
            }
            if self.elements_at(other).is_empty() {
                continue;
            }
            for near in tree.locate_all_at_point(p.to_array()).map(|near| near.data).take(left) {
                left -= 1;
                let distance = p.distance(self.points[near as usize]);
                let local = self.shortest[near as usize].min(self.shortest[other as usize]);
                if near != other && distance <= CLOSE * local && !self.are_of_one_element(near, other) {
                    found.push(Close { point: near, distance, local });
                }
            }
        }
        for (at, alike) in self.sides.chunk_by(|a, b| a.0 == b.0).enumerate() {
            if at.is_multiple_of(BATCH) && cancel.is_asked() {
                return Vec::new();
            }
            let [a, b] = alike[0].0.map(|end| self.points[end as usize]);
            let (along, long) = (b - a, a.distance(b));
            let around = AABB::from_corners(a.min(b).to_array(), a.max(b).to_array());
            for near in tree.locate_in_envelope_intersecting(around).map(|near| near.data).take(left) {
                left -= 1;
                let p = self.points[near as usize] - a;
                let t = p.dot(along) / (long * long);
                let distance = (p - t * along).length();
                let local = self.shortest[near as usize].min(long);
                let is_beside = t > INSIDE && t < 1.0 - INSIDE && distance <= CLOSE * local;
                if is_beside && !alike.iter().any(|side| self.corners(side.1).contains(&near)) {
                    found.push(Close { point: near, distance, local });
                }
            }
        }
        found.sort_unstable_by(|a, b| a.point.cmp(&b.point).then(a.distance.total_cmp(&b.distance)));
        found
    }
}
