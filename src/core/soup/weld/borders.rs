//! Points of borders that are close to points or sides of elements that they do not belong to.

use glam::DVec3;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::core::kernel::decimal::{number, point_text};
use crate::core::progress::Cancel;

/// A point is close to another, or to a side, below this fraction of the shortest side at either of them.
pub const CLOSE: f64 = 0.1;
/// A point is beside a side, rather than beside an end of it, where its foot is this fraction of the side inside.
const INSIDE: f64 = 1e-6;
/// Limits of the pairs that are measured: for each point, for each side or triangle, and for each of these on average.
/// Many triangles around one place make many pairs.
const AT_POINT: usize = 32;
const AT_SIDE: usize = 1024;
const ON_AVERAGE: usize = 32;
/// Places that are named.
const NAMED: usize = 5;
/// How the words of [`Borders::not_joined`] begin.
pub const NOT_JOINED: &str = "not joined: ";
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
        let (mut found, mut left) = (Vec::new(), ON_AVERAGE * self.sides.len());
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
            for near in tree.locate_all_at_point(p.to_array()).map(|near| near.data).take(AT_POINT) {
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
            let most = left.min(AT_SIDE);
            for near in tree.locate_in_envelope_intersecting(around).map(|near| near.data).take(most) {
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

    /// Appends the points of borders that are [`CLOSE`] to the inside of triangles that touch none of their elements.
    fn close_to_triangles(&self, found: &mut Vec<Close>, cancel: &Cancel) {
        let border = (0..self.points.len() as u32).filter(|&k| self.is_border[k as usize]);
        let place = |k: u32| GeomWithData::new(self.points[k as usize].to_array(), k);
        let tree: RTree<GeomWithData<[f64; 3], u32>> = RTree::bulk_load(border.map(place).collect());
        let elements = self.corners.start.len() as u32 - 1;
        let mut left = ON_AVERAGE * elements as usize;
        for element in 0..elements {
            if (element as usize).is_multiple_of(BATCH) && cancel.is_asked() {
                return;
            }
            let &[a, b, c] = self.corners(element) else { continue };
            let p = [a, b, c].map(|k| self.points[k as usize]);
            let local = (0..3).map(|k| p[k].distance(p[(k + 1) % 3])).fold(f64::INFINITY, f64::min);
            let margin = DVec3::splat(CLOSE * local);
            let (low, high) = (p[0].min(p[1]).min(p[2]) - margin, p[0].max(p[1]).max(p[2]) + margin);
            let normal = (p[1] - p[0]).cross(p[2] - p[0]);
            let (around, most) = (AABB::from_corners(low.to_array(), high.to_array()), left.min(AT_SIDE));
            for near in tree.locate_in_envelope(around).take(most) {
                left -= 1;
                let (point, q) = (near.data, self.points[near.data as usize]);
                let is_over = (0..3).all(|k| (p[(k + 1) % 3] - p[k]).cross(q - p[k]).dot(normal) > 0.0);
                let distance = ((q - p[0]).dot(normal) / normal.length()).abs();
                let local = local.min(self.shortest[point as usize]);
                let touches = |k: u32| k == point || self.are_of_one_element(k, point);
                if is_over && distance <= CLOSE * local && ![a, b, c].into_iter().any(touches) {
                    found.push(Close { point, distance, local });
                }
            }
        }
    }

    /// What is to be told of borders that nearly touch; nothing where none do. In the plane, what is at exactly one
    /// place is a crack.
    pub fn not_joined(&self, in_space: bool, cancel: &Cancel) -> Option<String> {
        let mut close = self.close(cancel);
        if in_space {
            self.close_to_triangles(&mut close, cancel);
        } else {
            close.retain(|close| close.distance > 0.0);
        }
        let nearest = close.iter().map(|close| close.distance).reduce(f64::min)?;
        let mut points: Vec<u32> = close.iter().map(|close| close.point).collect();
        points.sort_unstable();
        points.dedup();
        let place = |&k: &u32| match in_space {
            true => point_text(self.points[k as usize]),
            false => point_text(self.points[k as usize].truncate()),
        };
        let places: Vec<String> = points.iter().take(NAMED).map(place).collect();
        let more = match points.len() - places.len() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let (count, are) = match points.len() {
            1 => ("1 point of a border".to_owned(), "is"),
            n => (format!("{n} points of borders"), "are"),
        };
        let away = number(nearest);
        let places = places.join(", ");
        Some(format!("{NOT_JOINED}{count} {are} close to other elements, {away} away or more, at {places}{more}"))
    }
}
