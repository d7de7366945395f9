//! Corner sines of elements with straight sides in space, relative to the surface normal and to the element's own mean
//! normal: they show where elements fold over.

use glam::{DVec2, DVec3};
use smallvec::SmallVec;

use super::half_edge::{Embedding, Mesh};
use super::ids::{ElementId, NodeId};

/// The corners of an element, anticlockwise: in the plane and in space.
#[derive(Clone, Debug)]
pub struct Corners {
    uv: SmallVec<[DVec2; 4]>,
    xyz: SmallVec<[DVec3; 4]>,
}

impl Corners {
    /// Moves a corner.
    pub fn put(&mut self, corner: usize, uv: DVec2, xyz: DVec3) {
        (self.uv[corner], self.xyz[corner]) = (uv, xyz);
    }

    /// The least corner sine relative to the surface normal at the corner and, in space, also to the element's own mean
    /// normal, as solvers have it; at most 0 if a side is no longer than `near`. In the plane the normal is z. A result
    /// that is not above `floor` may be any number not above `floor`.
    pub fn least_sine(&self, embedding: Option<&Embedding>, near: f64, floor: f64) -> f64 {
        let count = self.xyz.len();
        if (0..count).any(|k| self.xyz[k].distance(self.xyz[(k + 1) % count]) <= near) {
            return 0.0;
        }
        let mut least = f64::INFINITY;
        if embedding.is_some() {
            least = self.own_sines().fold(least, f64::min);
        }
        for sine in self.surface_sines(embedding) {
            if least <= floor {
                break;
            }
            least = least.min(sine);
        }
        least
    }

    /// The sine of each corner relative to the element's own mean normal: for a quadrilateral those of
    /// [`StraightQuad::corner_sines`](crate::core::metric::straight_quad::StraightQuad::corner_sines).
    fn own_sines(&self) -> impl Iterator<Item = f64> {
        let count = self.xyz.len();
        // The area vector of the element, times two.
        let own = (self.xyz[2] - self.xyz[0]).cross(self.xyz[count - 1] - self.xyz[1]).normalize_or_zero();
        (0..count).map(move |k| self.corner(k).dot(own))
    }

    /// The sine of each corner relative to the surface normal there.
    fn surface_sines(&self, embedding: Option<&Embedding>) -> impl Iterator<Item = f64> {
        let middle = self.uv.iter().sum::<DVec2>() / self.uv.len() as f64;
        (0..self.uv.len()).map(move |k| {
            // The normal is not unique at an apex: take that of a point slightly inside the element.
            let within = self.uv[k].lerp(middle, 1e-3);
            self.corner(k).dot(embedding.map_or(DVec3::Z, |embedding| embedding.atlas.at(within).normal()))
        })
    }

    /// The cross product of the unit sides at a corner.
    fn corner(&self, k: usize) -> DVec3 {
        let (count, at) = (self.xyz.len(), self.xyz[k]);
        let (next, previous) = (self.xyz[(k + 1) % count] - at, self.xyz[(k + count - 1) % count] - at);
        next.cross(previous) / (next.length() * previous.length()).max(f64::MIN_POSITIVE)
    }
}

impl Mesh {
    /// The corners of an element.
    pub fn corners_in_space(&self, e: ElementId) -> Corners {
        let nodes: SmallVec<[NodeId; 4]> = self.corners(e).collect();
        Corners { uv: nodes.iter().map(|&n| self.uv(n)).collect(), xyz: nodes.iter().map(|&n| self.xyz(n)).collect() }
    }

    /// The elements on surfaces with a corner, between straight sides in space, that is inverted relative to the
    /// surface normal or to the element's own mean normal: they fold over, as in a mesh too coarse for the curvature.
    /// None in the plane.
    pub fn folded(&self) -> Vec<ElementId> {
        let Some(embedding) = self.embedding() else { return Vec::new() };
        let folds = |sine: f64| sine.is_nan() || sine <= 0.0;
        let is_folded = |e: &ElementId| {
            let corners = self.corners_in_space(*e);
            corners.own_sines().any(folds) || corners.surface_sines(Some(embedding)).any(folds)
        };
        self.elements().filter(is_folded).collect()
    }

    /// The least sine of an element's corners in space; see [`Corners::least_sine`].
    pub fn least_sine(&self, e: ElementId, near: f64) -> f64 {
        self.corners_in_space(e).least_sine(self.embedding().map(|embedding| &**embedding), near, f64::NEG_INFINITY)
    }

    /// The least sine of an element's corners in space relative to the surface normal alone.
    pub fn least_surface_sine(&self, e: ElementId) -> f64 {
        let embedding = self.embedding().map(|embedding| &**embedding);
        self.corners_in_space(e).surface_sines(embedding).fold(f64::INFINITY, f64::min)
    }
}
