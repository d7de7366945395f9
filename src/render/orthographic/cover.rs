//! The faces of a mesh as they hide each other and lines: what is seen of each, by the planes and the outlines of the
//! faces themselves, without samples.
//!
//! A face is one triangle, or a quadrilateral as two triangles along a diagonal, since its corners need not lie in a
//! plane. What a triangle hides of another one is its part before the plane of that one; which corners are before the
//! plane is decided by an exact predicate, so triangles with common corners or edges hide each other nowhere along
//! them, and triangles that cross are cut where they cross.

mod areas;

use glam::{DVec2, DVec3};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};
use smallvec::SmallVec;

use self::areas::Lattice;

/// Distances below this share of the size of the picture are none: points so near to a plane lie in it.
const IN_PLANE: f64 = 1e-8;
/// Areas narrower and lines shorter than this share of the size of the picture are not seen.
const NARROW: f64 = 1e-7;

/// A triangle of a face, anticlockwise in the picture. The third coordinate is the nearness to the viewer.
#[derive(Clone, Copy, Debug)]
struct Half {
    corners: [DVec3; 3],
    /// The length of the normal: twice the area in space.
    normal: f64,
}

impl Half {
    /// The signed distance of a point from its plane, positive towards the viewer; zero in the plane.
    fn before(&self, p: DVec3, in_plane: f64) -> f64 {
        let [a, b, c, p] =
            [self.corners[0], self.corners[1], self.corners[2], p].map(|p| robust::Coord3D { x: p.x, y: p.y, z: p.z });
        // The predicate is positive on the side from which the corners run clockwise.
        let distance = -robust::orient3d(a, b, c, p) / self.normal;
        if distance.abs() > in_plane { distance } else { 0.0 }
    }

    /// The range of nearness.
    fn nearness(&self) -> [f64; 2] {
        let [a, b, c] = self.corners.map(|p| p.z);
        [a.min(b).min(c), a.max(b).max(c)]
    }

    fn has(&self, corner: DVec3) -> bool {
        self.corners.contains(&corner)
    }

    /// The corners other than one of them, if it has that.
    fn opposite(&self, corner: DVec3) -> Option<[DVec3; 2]> {
        let at = self.corners.iter().position(|p| *p == corner)?;
        Some([self.corners[(at + 1) % 3], self.corners[(at + 2) % 3]])
    }
}

/// A face as its triangles; one without area in the picture has none.
#[derive(Clone, Debug, Default)]
struct Face {
    halves: SmallVec<[u32; 2]>,
    /// Whether one triangle is seen from the other side than the other one: its corners are not its outline.
    is_folded: bool,
}

/// What is seen of a face.
#[derive(Clone, Debug, PartialEq)]
pub enum SeenFace {
    /// All of it.
    Whole,
    /// Only the area within these outlines: anticlockwise around it, clockwise around its holes. None: it is hidden.
    Parts(Vec<Vec<DVec2>>),
}

/// How a line lies on the faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnFaces {
    /// Along edges, or off the faces.
    Along,
    /// As the diagonal that a swap would make: it passes below or above the two faces that it belongs to.
    Diagonal,
}

/// The faces of a mesh in a picture.
pub struct Cover {
    halves: Vec<Half>,
    faces: Vec<Face>,
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, u32>>,
    lattice: Lattice,
    in_plane: f64,
    narrow: f64,
}

impl Cover {
    /// Faces with three or four corners, in the coordinates of the picture.
    pub fn of(faces: impl Iterator<Item = SmallVec<[DVec3; 4]>>) -> Cover {
        let (mut halves, mut made) = (Vec::new(), Vec::new());
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for face in faces {
            let (mut own, mut sides) = (Face::default(), [false; 2]);
            if face.iter().all(|p| p.is_finite()) {
                face.iter().for_each(|p| (low, high) = (low.min(*p), high.max(*p)));
                for corners in triangles(&face) {
                    if let Some((half, is_turned)) = as_seen(corners) {
                        own.halves.push(halves.len() as u32);
                        halves.push(half);
                        sides[usize::from(is_turned)] = true;
                    }
                }
            }
            made.push(Face { is_folded: sides == [true; 2], ..own });
        }
        let size = if halves.is_empty() { 0.0 } else { (high - low).max_element() };
        let lattice = Lattice::over(low.truncate(), high.truncate());
        let tree = RTree::bulk_load(halves.iter().enumerate().map(|(k, half)| boxed(half, k as u32)).collect());
        Cover { halves, faces: made, tree, lattice, in_plane: IN_PLANE * size, narrow: NARROW * size }
    }

    /// The triangles whose boxes meet a box, in their order.
    fn near(&self, low: DVec2, high: DVec2) -> Vec<u32> {
        let found = self.tree.locate_in_envelope_intersecting(AABB::from_corners(low.to_array(), high.to_array()));
        let mut found: Vec<u32> = found.map(|leaf| leaf.data).collect();
        found.sort_unstable();
        found
    }

    /// The parts of a line one after another, with their ends as shares of the line, and whether faces hide them.
    pub fn parts(&self, ends: [DVec3; 2], on: OnFaces) -> Vec<([f64; 2], bool)> {
        let [a, b] = ends;
        if !(a.is_finite() && b.is_finite()) {
            return vec![([0.0, 1.0], false)];
        }
        let near = self.near(a.min(b).truncate(), a.max(b).truncate());
        let beside = if on == OnFaces::Diagonal { self.swapped(&near, ends) } else { Vec::new() };
        let others = near.iter().filter(|k| !beside.contains(k));
        let mut hidden: Vec<[f64; 2]> = others.filter_map(|&k| self.hides(&self.halves[k as usize], ends)).collect();
        hidden.sort_by(|p, q| p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])));
        // Seen from its end a line is a point.
        let length = (b - a).truncate().length();
        let least = if length > self.narrow { self.narrow / length } else { 0.0 };
        let mut merged: Vec<[f64; 2]> = Vec::new();
        for [from, to] in hidden {
            match merged.last_mut() {
                Some(last) if from <= last[1] + least => last[1] = last[1].max(to),
                _ => merged.push([from, to]),
            }
        }
        merged.retain(|[from, to]| to - from > least);
        let (mut parts, mut at) = (Vec::new(), 0.0);
        for [from, to] in merged {
            let (from, to) = (if from > least { from } else { 0.0 }, if to < 1.0 - least { to } else { 1.0 });
            if from > at {
                parts.push(([at, from], false));
            }
            parts.push(([from, to], true));
            at = to;
        }
        if at < 1.0 {
            parts.push(([at, 1.0], false));
        }
        parts
    }

    /// The triangles that the swap of an edge would join to have a diagonal with these ends.
    fn swapped(&self, near: &[u32], [a, b]: [DVec3; 2]) -> Vec<u32> {
        let with = |end: DVec3, other: DVec3| {
            near.iter().filter_map(move |&k| {
                let half = &self.halves[k as usize];
                half.opposite(end).filter(|_| !half.has(other)).map(|edge| (k, edge))
            })
        };
        let mut joined = Vec::new();
        for (first, edge) in with(a, b) {
            let across = with(b, a).filter(|(_, other)| other.iter().all(|p| edge.contains(p)));
            joined.extend(across.flat_map(|(second, _)| [first, second]));
        }
        joined
    }

    /// The part of a line behind a triangle.
    fn hides(&self, half: &Half, [a, b]: [DVec3; 2]) -> Option<[f64; 2]> {
        if half.nearness()[1] < a.z.min(b.z) {
            return None;
        }
        let mut range = [0.0, 1.0];
        // Cuts the range where a linear function is negative.
        let mut cut = |at_a: f64, at_b: f64| {
            if at_a < 0.0 && at_b <= 0.0 || at_a <= 0.0 && at_b < 0.0 {
                range = [1.0, 0.0];
            } else if at_a < 0.0 {
                range[0] = f64::max(range[0], at_a / (at_a - at_b));
            } else if at_b < 0.0 {
                range[1] = f64::min(range[1], at_a / (at_a - at_b));
            }
        };
        let [p, q, r] = half.corners.map(|p| p.truncate());
        for (from, to) in [(p, q), (q, r), (r, p)] {
            let inside = |place: DVec3| (to - from).perp_dot(place.truncate() - from);
            cut(inside(a), inside(b));
        }
        let behind = [a, b].map(|end| -half.before(end, self.in_plane));
        if behind == [0.0; 2] {
            return None;
        }
        cut(behind[0], behind[1]);
        (range[1] > range[0]).then_some(range)
    }
}

/// The triangles of a face with three or four corners. Of the two diagonals of a quadrilateral the first one is taken,
/// unless the other one alone leaves it on one side: at a corner that turns inwards.
fn triangles(face: &[DVec3]) -> SmallVec<[[DVec3; 3]; 2]> {
    let &[a, b, c, d] = face else { return face.first_chunk().copied().into_iter().collect() };
    let normal = |[p, q, r]: [DVec3; 3]| (q - p).cross(r - p);
    let agree = |pair: [[DVec3; 3]; 2]| normal(pair[0]).dot(normal(pair[1])) >= 0.0;
    let (first, second) = ([[a, b, c], [a, c, d]], [[b, c, d], [b, d, a]]);
    if !agree(first) && agree(second) { second.into() } else { first.into() }
}

/// A triangle anticlockwise in the picture, and whether it was turned for that; none where it has no area there.
fn as_seen([a, b, c]: [DVec3; 3]) -> Option<(Half, bool)> {
    let [p, q, r] = [a, b, c].map(|p| robust::Coord { x: p.x, y: p.y });
    let turn = robust::orient2d(p, q, r);
    let normal = (b - a).cross(c - a).length();
    let corners = if turn > 0.0 { [a, b, c] } else { [a, c, b] };
    (turn != 0.0 && normal > 0.0).then_some((Half { corners, normal }, turn < 0.0))
}

/// A triangle with its box, for the tree.
fn boxed(half: &Half, number: u32) -> GeomWithData<Rectangle<[f64; 2]>, u32> {
    let [a, b, c] = half.corners.map(|p| p.truncate());
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    GeomWithData::new(Rectangle::from_corners(low.to_array(), high.to_array()), number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    fn cover(faces: &[&[DVec3]]) -> Cover {
        Cover::of(faces.iter().map(|face| face.iter().copied().collect()))
    }

    #[test]
    fn the_diagonal_of_a_swap_is_not_hidden_by_the_two_triangles_that_it_passes_below() {
        // A ridge from b to c; the diagonal from a to d lies below it.
        let [a, b, c, d] = [place(-1.0, 0.0, 0.0), place(0.0, -1.0, 1.0), place(0.0, 1.0, 1.0), place(1.0, 0.0, 0.0)];
        let ridge: [&[DVec3]; 2] = [&[a, b, c], &[b, d, c]];
        let parts = |faces: &[&[DVec3]], on| cover(faces).parts([a, d], on);
        assert_eq!(parts(&ridge, OnFaces::Diagonal), [([0.0, 1.0], false)]);
        assert_eq!(parts(&ridge, OnFaces::Along), [([0.0, 1.0], true)]);
        let above: &[DVec3] =
            &[place(-2.0, -2.0, 5.0), place(0.0, -2.0, 5.0), place(0.0, 2.0, 5.0), place(-2.0, 2.0, 5.0)];
        let hidden = parts(&[ridge[0], ridge[1], above], OnFaces::Diagonal);
        assert_eq!(hidden, [([0.0, 0.5], true), ([0.5, 1.0], false)]);
    }

    #[test]
    fn a_quadrilateral_with_a_corner_that_turns_inwards_is_divided_within() {
        let dart = [place(3.0, 0.0, 0.0), place(-1.0, 2.0, 0.0), place(0.0, 0.0, 0.0), place(-1.0, -2.0, 0.0)];
        for k in 0..4 {
            let mut face = dart;
            face.rotate_left(k);
            let halves = triangles(&face);
            let area = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).truncate().perp_dot((c - a).truncate());
            assert!(halves.iter().all(|half| area(*half) > 0.0), "{k}: {halves:?}");
            assert_eq!(cover(&[&face]).seen(0), SeenFace::Whole, "{k}");
        }
    }

    #[test]
    fn faces_at_the_same_place_and_places_without_end_hide_nothing() {
        let face = [place(0.0, 0.0, 0.0), place(1.0, 0.0, 0.0), place(1.0, 1.0, 0.0), place(0.0, 1.0, 0.0)];
        let endless = [place(f64::NAN, 0.0, 0.0), place(1.0, 0.0, 9.0), place(1.0, 1.0, 9.0)];
        let cover = cover(&[&face, &face, &endless]);
        assert_eq!((cover.seen(0), cover.seen(1), cover.seen(2)), (SeenFace::Whole, SeenFace::Whole, SeenFace::Whole));
        assert_eq!(cover.parts([endless[0], face[1]], OnFaces::Along), [([0.0, 1.0], false)]);
        let point = [place(0.5, 0.5, -1.0), place(0.5, 0.5, -2.0)];
        assert_eq!(cover.parts(point, OnFaces::Along), [([0.0, 1.0], true)], "a line seen from its end");
    }
}
