//! Faces, edges and nodes of a mesh, with what they are coloured by.

use glam::{DVec2, DVec3};

use super::{ColourBy, Dot, Face, Layers, Line, Scene, Shading, ink, relative};
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::ids::{ElementId, HalfEdgeId};
use crate::core::metric::measure::triangle_area;
use crate::render::palette::{Palette, Rgba};

const NOWHERE: u32 = u32::MAX;

/// Widths of mesh edges in points: live, dead.
const EDGES: [f32; 2] = [0.75, 0.95];

impl Shading {
    /// The values of `by` over a mesh; `births` has the step at which each element slot was last made.
    pub fn of(mesh: &Mesh, by: ColourBy, births: &[u64]) -> Shading {
        let logarithmic = matches!(by, ColourBy::HValue | ColourBy::Area);
        if by == ColourBy::State {
            return Shading::default();
        }
        let value = |e: ElementId| match by {
            ColourBy::State => f64::NAN,
            ColourBy::HValue => {
                let nodes: Vec<_> = mesh.corners(e).collect();
                nodes.iter().map(|n| mesh.metric_ref(*n).min_size()).sum::<f64>() / nodes.len() as f64
            }
            ColourBy::Angle => angles(mesh, e)[0].to_degrees(),
            ColourBy::Level if mesh.is_quad(e) => f64::from(mesh.level(e)),
            ColourBy::Birth if mesh.is_quad(e) => births.get(e.index()).map_or(f64::NAN, |b| *b as f64),
            ColourBy::Level | ColourBy::Birth => f64::NAN,
            ColourBy::Quality => mesh.quality(e),
            ColourBy::Area => metric_area(mesh, e),
        };
        let slots = (0..mesh.element_slots() as u32).map(ElementId);
        let values: Vec<f64> = slots.map(|e| if mesh.has_element(e) { value(e) } else { f64::NAN }).collect();
        let finite = || values.iter().copied().filter(|v| v.is_finite());
        let range = match by {
            ColourBy::Quality => [0.0, 1.0],
            ColourBy::Angle => [0.0, 90.0],
            _ => [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)],
        };
        let range = if range[0] <= range[1] { range } else { [0.0, 1.0] };
        Shading { by, values, range, logarithmic }
    }

    /// The place of a value between the ends of the range, 0 to 1.
    pub fn share(&self, value: f64) -> f32 {
        let scale = |v: f64| if self.logarithmic { libm::log(v) } else { v };
        let [low, high] = self.range.map(scale);
        if high > low { ((scale(value) - low) / (high - low)) as f32 } else { 0.5 }
    }

    fn colour(&self, e: ElementId) -> Option<Rgba> {
        let value = self.values.get(e.index()).copied().filter(|v| v.is_finite())?;
        Some(self.by.map()?.at(self.share(value)))
    }
}

/// The least and the greatest inner angle of an element in the plane, radians.
pub fn angles(mesh: &Mesh, e: ElementId) -> [f64; 2] {
    let angle = |h: HalfEdgeId| {
        let p = mesh.uv(mesh.origin(h));
        let (out, back) = (mesh.uv(mesh.target(h)) - p, mesh.uv(mesh.origin(mesh.previous(h))) - p);
        libm::atan2(out.perp_dot(back), out.dot(back)).rem_euclid(std::f64::consts::TAU)
    };
    mesh.half_edges(e).map(angle).fold([f64::INFINITY, 0.0], |[low, high], a| [low.min(a), high.max(a)])
}

/// The area of an element in the metric of its nodes.
pub fn metric_area(mesh: &Mesh, e: ElementId) -> f64 {
    let nodes: Vec<_> = mesh.corners(e).collect();
    let at = |k: usize| mesh.uv(nodes[k]);
    let part = |a: usize, b: usize, c: usize| {
        [a, b, c].iter().map(|k| triangle_area(mesh.metric_ref(nodes[*k]), at(a), at(b), at(c))).sum::<f64>() / 3.0
    };
    if nodes.len() == 4 { part(0, 1, 2) + part(0, 2, 3) } else { part(0, 1, 2) }
}

impl Scene {
    /// Makes faces, edges and nodes those of `mesh`, relative to `anchor`; `changed` are what the last operation changed.
    pub fn set_mesh(
        &mut self,
        mesh: &Mesh,
        anchor: DVec3,
        changed: &[ElementId],
        shading: &Shading,
        layers: Layers,
        palette: &Palette,
    ) {
        self.anchor = anchor;
        self.generation += 1;
        self.set_faces(mesh, changed, shading, layers, palette);
        self.set_edges(mesh, layers, palette);
        self.set_nodes(mesh, layers, palette);
    }

    fn set_faces(&mut self, mesh: &Mesh, changed: &[ElementId], shading: &Shading, layers: Layers, palette: &Palette) {
        let anchor = self.anchor;
        self.faces.clear();
        self.faces.resize(mesh.element_slots(), Face::default());
        for e in mesh.elements() {
            let (shown, plain) = match mesh.is_quad(e) {
                true => (layers.dead, palette.dead),
                false => (layers.live, palette.live),
            };
            if shown {
                let colour = shading.colour(e).unwrap_or(plain);
                self.faces[e.index()] = Face { corners: corners(mesh, e, anchor), colour: ink(colour) };
            }
        }
        if shading.by != ColourBy::State {
            return;
        }
        for &e in changed.iter().filter(|e| mesh.has_element(**e)) {
            self.faces[e.index()] = Face { corners: corners(mesh, e, anchor), colour: ink(palette.changed) };
        }
    }

    fn set_edges(&mut self, mesh: &Mesh, layers: Layers, palette: &Palette) {
        let slots = 4 * mesh.element_slots();
        self.place.truncate(slots);
        if self.place.len() < slots {
            self.place.resize(slots, NOWHERE);
        }
        let mut used = vec![false; self.edges.len()];
        let mut homeless: Vec<(HalfEdgeId, Line)> = Vec::new();
        for h in mesh.edges() {
            let Some(line) = self.edge(mesh, h, layers, palette) else { continue };
            match self.place[h.index()] {
                NOWHERE => homeless.push((h, line)),
                place if used[place as usize] => homeless.push((h, line)),
                place => {
                    used[place as usize] = true;
                    self.edges[place as usize] = line;
                }
            }
        }
        self.free.clear();
        for (place, _) in used.iter().enumerate().filter(|(_, used)| !**used).rev() {
            self.edges[place] = Line::default();
            self.free.push(place as u32);
        }
        for (h, line) in homeless {
            let place = self.free.pop().unwrap_or_else(|| {
                self.edges.push(Line::default());
                (self.edges.len() - 1) as u32
            });
            self.edges[place as usize] = line;
            self.place[h.index()] = place;
        }
    }

    fn edge(&self, mesh: &Mesh, h: HalfEdgeId, layers: Layers, palette: &Palette) -> Option<Line> {
        let sides = [Some(h), mesh.twin(h)];
        let dead = sides.iter().flatten().any(|h| mesh.is_quad(h.element()));
        let shown = sides.iter().flatten().any(|h| if mesh.is_quad(h.element()) { layers.dead } else { layers.live });
        if !shown {
            return None;
        }
        let [a, b] = [mesh.origin(h), mesh.target(h)].map(|n| mesh.uv(n));
        let heights = sides.iter().flatten().map(|h| room_over(mesh, *h, a, b));
        Some(Line {
            ends: [a, b].map(|p| relative(p, self.anchor)),
            colour: ink(if dead { palette.dead_edge } else { palette.live_edge }),
            width: EDGES[usize::from(dead)],
            dash: [0.0; 2],
            room: heights.fold(f64::INFINITY, f64::min) as f32,
        })
    }

    fn set_nodes(&mut self, mesh: &Mesh, layers: Layers, palette: &Palette) {
        self.dots.clear();
        self.dots.resize(mesh.node_slots(), Dot { least: f32::INFINITY, ..Dot::default() });
        if !layers.nodes {
            return;
        }
        let mut on_front = vec![false; mesh.node_slots()];
        for h in mesh.front() {
            on_front[mesh.origin(h).index()] = true;
        }
        for node in mesh.nodes() {
            let p = mesh.uv(node);
            let nearest = mesh.neighbours(node).map(|n| mesh.uv(n).distance_squared(p)).fold(f64::INFINITY, f64::min);
            let front = on_front[node.index()];
            self.dots[node.index()] = Dot {
                at: relative(p, self.anchor),
                radius: 2.6,
                fill: ink(if front { palette.label } else { palette.weak }),
                ring: ink(palette.ground),
                ring_width: 0.8,
                room: nearest.sqrt() as f32,
                least: if front { 6.0 } else { 14.0 },
            };
        }
    }
}

fn corners(mesh: &Mesh, e: ElementId, anchor: DVec3) -> [[f32; 3]; 4] {
    let mut corners = [[0.0; 3]; 4];
    for k in 0..4 {
        let corner = (k as u32).min(mesh.sides(e) as u32 - 1);
        corners[k] = relative(mesh.uv(mesh.origin(e.half_edge(corner))), anchor);
    }
    corners
}

/// The height over the side `h` from `a` to `b` of its element: of a quadrilateral the mean of its two other corners.
fn room_over(mesh: &Mesh, h: HalfEdgeId, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let height = |h: HalfEdgeId| (along.perp_dot(mesh.uv(mesh.origin(h)) - a) / along.length()).abs();
    let last = mesh.previous(h);
    if mesh.is_triangle(h.element()) { height(last) } else { 0.5 * (height(last) + height(mesh.previous(last))) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::mesh::ids::PointId;
    use crate::core::mesh::triangle_set::TriangleSet;
    use crate::core::metric::tensor::Metric2;
    use crate::render::palette::DARK;

    fn strip() -> Mesh {
        let uv: Vec<_> = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 1.0)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        let set = TriangleSet {
            point: (0..6).map(PointId).collect(),
            triangles: vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]],
            region: vec![0; 4],
            uv,
            ..TriangleSet::default()
        };
        Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); 6])
    }

    fn drawn(mesh: &Mesh, scene: &mut Scene) {
        let shading = Shading::default();
        scene.set_mesh(mesh, DVec3::ZERO, &[], &shading, Layers::default(), &DARK);
    }

    #[test]
    fn a_swap_changes_the_places_of_its_own_edge_alone() {
        let mut mesh = strip();
        let mut scene = Scene::default();
        drawn(&mesh, &mut scene);
        let before = scene.edges.clone();
        assert_eq!(before.len(), 9);
        let h = mesh.edges().find(|&h| mesh.can_swap(h).is_ok()).unwrap();
        mesh.swap(h);
        drawn(&mesh, &mut scene);
        assert_eq!(scene.edges.len(), before.len());
        let changed = scene.edges.iter().zip(&before).filter(|(a, b)| a.ends != b.ends).count();
        // The swapped edge itself; of the four around it those whose half-edge changed its slot move with it.
        assert!((1..=5).contains(&changed), "{changed}");
        let mut ends: Vec<_> = scene.edges.iter().map(|l| format!("{:?}", l.ends)).collect();
        ends.sort();
        ends.dedup();
        assert_eq!(ends.len(), 9, "every edge once");
    }

    #[test]
    fn a_layer_that_is_off_is_not_drawn() {
        let mesh = strip();
        let mut scene = Scene::default();
        let layers = Layers { live: false, nodes: false, ..Layers::default() };
        scene.set_mesh(&mesh, DVec3::ZERO, &[], &Shading::default(), layers, &DARK);
        assert!(scene.faces.iter().all(|f| f.colour == 0) && scene.edges.is_empty());
        assert!(scene.dots.iter().all(|d| d.least.is_infinite()));
    }

    #[test]
    fn unit_squares_have_unit_metric_area_together_and_their_smallest_angle_is_half_a_right_one() {
        let mesh = strip();
        let area: f64 = mesh.elements().map(|e| metric_area(&mesh, e)).sum();
        assert!((area - 2.0).abs() < 1e-12);
        let shading = Shading::of(&mesh, ColourBy::Angle, &[]);
        assert!(shading.values.iter().all(|v| (v - 45.0).abs() < 1e-9));
        assert_eq!(shading.share(45.0), 0.5);
    }
}
