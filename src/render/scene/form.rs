//! The form of a mesh in a scene: in its parametric plane, or in space with flat or curved elements. A curved element
//! is divided in the parametric plane, and each piece is lifted onto the surface.

use glam::{DVec2, DVec3};

use super::{Face, Line, Scene, relative};
use crate::core::mesh::{ElementId, Mesh, NodeId};

/// The form in which a mesh is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// In the parametric plane.
    #[default]
    Plane,
    /// In space; elements are flat between their nodes.
    Flat,
    /// In space; elements follow the surface.
    Curved,
    /// In space: imported triangles, which are not a mesh yet.
    Given,
}

impl Form {
    /// Whether it is drawn in space.
    pub fn is_in_space(self) -> bool {
        self != Form::Plane
    }

    /// Pieces of an edge in a mesh with this many elements: the small elements of large meshes look the same flat.
    pub(super) fn pieces(self, elements: usize) -> usize {
        match (self, elements) {
            (Form::Plane | Form::Flat | Form::Given, _) => 1,
            (Form::Curved, ..4_000) => 4,
            (Form::Curved, ..40_000) => 2,
            (Form::Curved, _) => 1,
        }
    }
}

/// The position of a node, and the unit normal of the surface there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Its position.
    pub at: DVec3,
    /// The normal.
    pub normal: DVec3,
}

impl Default for Spot {
    fn default() -> Self {
        Spot { at: DVec3::ZERO, normal: DVec3::Z }
    }
}

impl Spot {
    /// The spot of a node.
    pub(super) fn of(mesh: &Mesh, node: NodeId, form: Form) -> Spot {
        match form {
            Form::Plane => Spot { at: mesh.uv(node).extend(0.0), normal: DVec3::Z },
            _ => Spot { at: mesh.xyz(node), normal: mesh.normal(node) },
        }
    }

    /// The spot of the surface over a point of the plane.
    fn over(mesh: &Mesh, p: DVec2) -> Spot {
        let Some(embedding) = mesh.embedding() else { return Spot { at: p.extend(0.0), normal: DVec3::Z } };
        let at = embedding.atlas.at(p);
        Spot { at: at.xyz, normal: at.normal() }
    }
}

/// A unit vector as a point of an unfolded octahedron, in 32767ths.
pub(super) fn folded(n: DVec3) -> [i16; 2] {
    let n = n / (n.x.abs() + n.y.abs() + n.z.abs()).max(f64::MIN_POSITIVE);
    let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
    let [x, y] = if n.z >= 0.0 { [n.x, n.y] } else { [(1.0 - n.y.abs()) * sign(n.x), (1.0 - n.x.abs()) * sign(n.y)] };
    [x, y].map(|x| (x.clamp(-1.0, 1.0) * 32767.0).round() as i16)
}

impl Scene {
    /// The form in which the mesh is drawn.
    pub fn form(&self) -> Form {
        self.form
    }

    /// It increases with changes of faces, but not of overlays.
    pub fn shape(&self) -> u64 {
        self.faces.newest()
    }

    /// Faces per element.
    pub fn faces_per_element(&self) -> usize {
        self.pieces * self.pieces
    }

    /// The position of a node that the scene has drawn.
    pub fn spot(&self, node: NodeId) -> Option<&Spot> {
        self.spots.get(node.index())
    }

    pub(super) fn at(&self, node: NodeId) -> DVec3 {
        self.spots[node.index()].at
    }

    /// The faces of an element, in one colour.
    pub(super) fn element_faces(&self, mesh: &Mesh, e: ElementId, colour: u32) -> Vec<Face> {
        let corner = |k: u32| mesh.origin(e.half_edge(k.min(mesh.sides(e) as u32 - 1)));
        let nodes = [0, 1, 2, 3].map(corner);
        let face = |spots: [Spot; 4]| Face {
            corners: spots.map(|spot| relative(spot.at, self.anchor)),
            normals: spots.map(|spot| folded(spot.normal)),
            colour,
        };
        let spots = nodes.map(|n| self.spots[n.index()]);
        let n = self.pieces;
        if n == 1 {
            return vec![face(spots)];
        }
        let [a, b, c, d] = nodes.map(|n| mesh.uv(n));
        let part = |i: usize| i as f64 / n as f64;
        // Shared sides run where those of the other faces do: move the surface by that much there, and less away from
        // them.
        let moved: Vec<Option<Vec<DVec3>>> = (0..4)
            .map(|k| {
                let ends = [nodes[k], nodes[(k + 1) % 4]];
                let joint = self.joint(mesh, ends)?;
                let [p, q] = ends.map(|n| mesh.uv(n));
                let own = |k: usize| Spot::over(mesh, p.lerp(q, part(k))).at;
                let at = |k: usize| if k == 0 || k == n { DVec3::ZERO } else { joint[k] - own(k) };
                Some((0..=n).map(at).collect())
            })
            .collect();
        let by = |side: usize, k: usize| moved[side].as_ref().map_or(DVec3::ZERO, |moved| moved[k]);
        let mut grid = Vec::with_capacity((n + 1) * (n + 1));
        for j in 0..=n {
            for i in 0..=n {
                grid.push(match (i, j) {
                    (0, 0) => spots[0],
                    (i, 0) if i == n => spots[1],
                    (i, j) if i == n && j == n => spots[2],
                    (0, j) if j == n => spots[3],
                    _ => {
                        let (s, t) = (part(i), part(j));
                        let mut spot = Spot::over(mesh, a.lerp(b, s).lerp(d.lerp(c, s), t));
                        spot.at += by(0, i) * (1.0 - t) + by(1, j) * s + by(2, n - i) * t + by(3, n - j) * (1.0 - s);
                        spot
                    }
                });
            }
        }
        let at = |i: usize, j: usize| grid[j * (n + 1) + i];
        let cell = |k: usize| (k % n, k / n);
        let cells = (0..n * n).map(cell);
        cells.map(|(i, j)| face([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])).collect()
    }

    /// The curve of an edge that several faces share: the mean of the curves that they would draw. Drawn straight in
    /// the plane of each face, the edge would leave gaps.
    fn joint(&self, mesh: &Mesh, [a, b]: [NodeId; 2]) -> Option<Vec<DVec3>> {
        let n = self.pieces;
        let copies = |node: NodeId| mesh.point(node).and_then(|point| self.copies.get(point.index()));
        let (starts, ends) = (copies(a)?, copies(b)?);
        if n == 1 || starts.len() < 2 && ends.len() < 2 || !is_outer(mesh, a, b) {
            return None;
        }
        let pairs = starts.iter().flat_map(|a| ends.iter().map(|b| [*a, *b]));
        let chains = pairs.filter(|[a, b]| mesh.has_node(*a) && mesh.has_node(*b) && is_outer(mesh, *a, *b));
        let chains: Vec<[DVec2; 2]> = chains.map(|ends| ends.map(|n| mesh.uv(n))).collect();
        let at = |k: usize| {
            let places = chains.iter().map(|[p, q]| Spot::over(mesh, p.lerp(*q, k as f64 / n as f64)).at);
            places.sum::<DVec3>() / chains.len() as f64
        };
        (chains.len() > 1).then(|| (0..=n).map(at).collect())
    }

    /// Lines from one node to the other along the surface; all but the ends is taken from `line`.
    pub(super) fn chain(&self, mesh: &Mesh, [a, b]: [NodeId; 2], line: Line) -> impl Iterator<Item = Line> + use<> {
        let n = self.pieces;
        let (p, q) = (mesh.uv(a), mesh.uv(b));
        let joint = self.joint(mesh, [a, b]);
        let place = |k: usize| match (k, &joint) {
            (0, _) => self.at(a),
            (k, _) if k == n => self.at(b),
            (k, Some(joint)) => joint[k],
            (k, None) => Spot::over(mesh, p.lerp(q, k as f64 / n as f64)).at,
        };
        let places: Vec<[f32; 3]> = (0..=n).map(|k| relative(place(k), self.anchor)).collect();
        (0..n).map(move |k| Line { ends: [places[k], places[k + 1]], ..line })
    }

    /// Records the position of a node.
    pub(super) fn set_spot(&mut self, mesh: &Mesh, node: NodeId) {
        self.spots[node.index()] = Spot::of(mesh, node, self.form);
        if self.pieces > 1
            && let Some(point) = mesh.point(node)
        {
            if self.copies.len() <= point.index() {
                self.copies.resize(point.index() + 1, Vec::new());
            }
            let copies = &mut self.copies[point.index()];
            if let Err(place) = copies.binary_search(&node) {
                copies.insert(place, node);
            }
            // Nodes may have been deleted or moved by steps back.
            copies.retain(|n| mesh.has_node(*n) && mesh.point(*n) == Some(point));
        }
    }
}

/// Whether the edge between these nodes has an element on one side only.
fn is_outer(mesh: &Mesh, a: NodeId, b: NodeId) -> bool {
    let found = |a: NodeId, b: NodeId| mesh.fan(a).find(|h| mesh.target(*h) == b);
    found(a, b).or_else(|| found(b, a)).is_some_and(|h| mesh.twin(h).is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_is_unfolded_as_it_was() {
        for k in 0..400 {
            let (sin, cos) = libm::sincos(f64::from(k));
            let z = f64::from(k - 200) / 200.0;
            let r = (1.0 - z * z).sqrt();
            let n = DVec3::new(r * cos, r * sin, z);
            let [x, y] = folded(n).map(|x| f64::from(x) / 32767.0);
            // As the shader unpacks it.
            let z = 1.0 - x.abs() - y.abs();
            let t = (-z).max(0.0);
            let m = DVec3::new(x - t * x.signum(), y - t * y.signum(), z).normalize();
            assert!(m.distance(n) < 1e-4, "{n} {m}");
        }
    }
}
