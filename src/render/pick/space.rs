//! Picking in space: of everything under the pointer, the item nearest to the eye, and nothing that is hidden.

use glam::{DVec2, DVec3};

use super::{NEAR, nearest};
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NodeId};
use crate::render::camera::Camera;
use crate::render::scene::{Outlined, Scene};

/// Tolerance in points: an item this far behind a face still counts as visible.
const SLACK: f64 = 1.5;
/// Points of a cell of a cover, and how far a place may lie behind what its cell shows.
const CELL: f64 = 5.0;
const DEPTH: f64 = 8.0;

/// An element under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The element.
    pub element: ElementId,
    /// The position on it.
    pub place: DVec3,
}

/// The drawn elements as triangles on the screen: x, y, and nearness to the eye.
fn triangles<'a>(
    scene: &'a Scene,
    camera: &'a Camera,
    size: DVec2,
) -> impl Iterator<Item = (ElementId, [DVec3; 3])> + 'a {
    let each = scene.faces_per_element();
    let faces = scene.faces.items().iter().enumerate().filter(|(_, face)| face.colour != 0);
    faces.flat_map(move |(k, face)| {
        let seen = |p: [f32; 3]| camera.seen(scene.anchor + DVec3::from_array(p.map(f64::from)), size);
        let [a, b, c, d] = face.corners.map(seen);
        let e = ElementId((k / each) as u32);
        [(e, [a, b, c]), (e, [a, c, d])]
    })
}

/// The nearness of a triangle to the eye at a screen position; `None` where it does not cover that position.
fn nearness([a, b, c]: &[DVec3; 3], at: DVec2) -> Option<f64> {
    let [p, q, r] = [a, b, c].map(|v| v.truncate());
    let area = (q - p).perp_dot(r - p);
    if area == 0.0 {
        return None;
    }
    let (u, v) = ((q - at).perp_dot(r - at) / area, (r - at).perp_dot(p - at) / area);
    let w = 1.0 - u - v;
    (u >= 0.0 && v >= 0.0 && w >= 0.0).then_some(u * a.z + v * b.z + w * c.z)
}

/// The triangles near a screen position.
fn around(scene: &Scene, camera: &Camera, size: DVec2, at: DVec2) -> Vec<(ElementId, [DVec3; 3])> {
    let reach = NEAR.iter().fold(0.0, |m: f64, n| m.max(*n)) + 1.0;
    let near = |corners: &[DVec3; 3]| {
        let [a, b, c] = corners.map(|p| p.truncate());
        let (low, high) = (a.min(b).min(c) - reach, a.max(b).max(c) + reach);
        at.cmpge(low).all() && at.cmple(high).all()
    };
    triangles(scene, camera, size).filter(|(_, corners)| near(corners)).collect()
}

fn nearest_of(near: &[(ElementId, [DVec3; 3])], at: DVec2) -> Option<(ElementId, f64)> {
    let covering = near.iter().filter_map(|(e, corners)| Some((*e, nearness(corners, at)?)));
    covering.min_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)))
}

/// The element visible at a screen position.
pub fn hit(scene: &Scene, camera: &Camera, size: DVec2, at: DVec2) -> Option<Hit> {
    let (element, z) = nearest_of(&around(scene, camera, size, at), at)?;
    Some(Hit { element, place: camera.place(at.extend(z), size) })
}

/// What is at a screen position. `scene` is that of the mesh in space.
pub fn pick_in_space(scene: &Scene, mesh: &Mesh, camera: &Camera, size: DVec2, at: DVec2) -> Option<Outlined> {
    let near = around(scene, camera, size, at);
    let inside = nearest_of(&near, at).map(|hit| hit.0).filter(|e| mesh.has_element(*e));
    let here: Vec<ElementId> = match inside {
        Some(e) => vec![e],
        None => {
            // Beside the mesh, an outline can still be hit.
            let mut here: Vec<ElementId> = near.iter().map(|t| t.0).filter(|e| mesh.has_element(*e)).collect();
            here.dedup();
            here
        }
    };
    let spokes = here.iter().flat_map(|e| mesh.corners(*e)).flat_map(|n| mesh.fan(n));
    let mut sides: Vec<HalfEdgeId> = spokes.flat_map(|h| [h, mesh.previous(h)]).collect();
    sides.sort_unstable();
    sides.dedup();
    let seen = |n: NodeId| scene.spot(n).map_or(DVec3::INFINITY, |spot| camera.seen(spot.at, size));
    let is_seen = |[a, b]: [NodeId; 2], share: f64| {
        let p = seen(a).lerp(seen(b), share);
        // An edge may run below its own elements where these are drawn curved.
        let own = |e: ElementId| mesh.has_element(e) && mesh.corners(e).any(|n| n == a || n == b);
        let over = |(e, corners): &(ElementId, [DVec3; 3])| {
            nearness(corners, p.truncate()).is_some_and(|z| z > p.z + SLACK) && !own(*e)
        };
        !near.iter().any(over)
    };
    nearest(mesh, &sides, at, &|n| seen(n).truncate(), &is_seen).or(inside.map(Outlined::Element))
}

/// A coarse depth buffer by cells of the screen: it decides which labels are hidden.
#[derive(Clone, Debug, Default)]
pub struct Cover {
    columns: usize,
    rows: usize,
    nearest: Vec<f32>,
}

impl Cover {
    /// The cover of a scene in a view of `size` points.
    pub fn of(scene: &Scene, camera: &Camera, size: DVec2) -> Cover {
        let count = |points: f64| ((points / CELL).ceil().clamp(1.0, 4096.0)) as usize;
        let (columns, rows) = (count(size.x), count(size.y));
        let mut nearest = vec![f32::NEG_INFINITY; columns * rows];
        for (_, corners) in triangles(scene, camera, size) {
            let [a, b, c] = corners.map(|p| p.truncate() / CELL - 0.5);
            // The centres of cells within the bounding box.
            let (low, high) = (a.min(b).min(c).ceil().max(DVec2::ZERO), a.max(b).max(c).floor());
            let until = high.min(DVec2::new(columns as f64, rows as f64) - 1.0);
            if !(low.cmple(until).all() && low.is_finite()) {
                continue;
            }
            for row in low.y as usize..=until.y as usize {
                for column in low.x as usize..=until.x as usize {
                    let at = (DVec2::new(column as f64, row as f64) + 0.5) * CELL;
                    if let Some(z) = nearness(&corners, at) {
                        let cell = &mut nearest[row * columns + column];
                        *cell = cell.max(z as f32);
                    }
                }
            }
        }
        Cover { columns, rows, nearest }
    }

    /// Whether a position (from `Camera::seen`) lies behind the drawn elements.
    pub fn hides(&self, seen: DVec3) -> bool {
        let (x, y) = (seen.x / CELL, seen.y / CELL);
        let inside = x >= 0.0 && y >= 0.0 && x < self.columns as f64 && y < self.rows as f64;
        inside && f64::from(self.nearest[y as usize * self.columns + x as usize]) > seen.z + DEPTH
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::progress::Nobody;
    use crate::core::run::{History, Run};
    use crate::render::camera::Bearing;
    use crate::render::palette::DARK;
    use crate::render::scene::{Drawn, Form, Layers, Shading};

    const SIZE: DVec2 = DVec2::new(800.0, 600.0);

    fn sphere(form: Form) -> (Scene, History) {
        let mut case = built_in::named("sphere").unwrap().unwrap();
        case.parameters.size_scale = 2.0;
        let history = History::open(Run::of(case), &mut Nobody).unwrap();
        let mut scene = Scene::default();
        let (mesh, shading, layers) = (&history.state().mesh, Shading::default(), Layers::default());
        scene.set_mesh(&Drawn { mesh, changed: &[], shading: &shading, layers, palette: &DARK, form }, DVec3::ZERO);
        (scene, history)
    }

    #[test]
    fn of_a_sphere_the_near_half_is_hit_and_the_far_half_never() {
        for form in [Form::Flat, Form::Curved] {
            let (scene, history) = sphere(form);
            let mesh = &history.state().mesh;
            let camera = Camera::fit_in_space(mesh.nodes().map(|n| mesh.xyz(n)), Bearing::Iso.turn(), SIZE, 20.0);
            let radius = 0.5 * (SIZE.y - 40.0);
            let (mut hits, mut named) = (0, [0; 3]);
            for k in 0..400 {
                let (sin, cos) = libm::sincos(f64::from(k) * 2.4);
                let r = 0.9 * radius * (f64::from(k) / 400.0).sqrt();
                let at = 0.5 * SIZE + DVec2::new(r * cos, r * sin);
                let hit = hit(&scene, &camera, SIZE, at).unwrap();
                hits += 1;
                let z = camera.seen(hit.place, SIZE).z;
                assert!(z > 0.0, "{form:?}: {at} {z} {:?}", hit.place);
                let nodes: Vec<NodeId> = match pick_in_space(&scene, mesh, &camera, SIZE, at).unwrap() {
                    Outlined::Node(n) => (named[0] += 1, vec![n]).1,
                    Outlined::Edge(ends) => (named[1] += 1, ends.to_vec()).1,
                    Outlined::Element(e) => (named[2] += 1, mesh.corners(e).collect()).1,
                };
                assert!(nodes.iter().any(|n| camera.seen(mesh.xyz(*n), SIZE).z > 0.0), "{nodes:?} is behind");
            }
            assert_eq!(hits, 400);
            assert!(named.iter().all(|count| *count > 5), "{named:?}");
            assert!(hit(&scene, &camera, SIZE, DVec2::new(5.0, 5.0)).is_none());
        }
    }

    #[test]
    fn a_cover_hides_the_far_half_of_a_sphere() {
        let (scene, history) = sphere(Form::Flat);
        let mesh = &history.state().mesh;
        let camera = Camera::fit_in_space(mesh.nodes().map(|n| mesh.xyz(n)), Bearing::X.turn(), SIZE, 20.0);
        let cover = Cover::of(&scene, &camera, SIZE);
        let nodes = mesh.nodes().map(|n| camera.seen(mesh.xyz(n), SIZE));
        // Near the outline both halves fall into one cell.
        let (near, far): (Vec<_>, Vec<_>) = nodes.filter(|p| p.z.abs() > 60.0).partition(|p| p.z > 0.0);
        assert!(near.len() > 20 && far.len() > 20);
        assert!(near.iter().all(|p| !cover.hides(*p)));
        assert!(far.iter().all(|p| cover.hides(*p)));
    }
}
