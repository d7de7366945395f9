//! Where the views look: requests to the main view, the lens, and the view of the whole mesh.

use eframe::egui::{self, PointerButton, Rect, Ui};
use glam::{DMat2, DVec2, DVec3};

use super::ViewFrame;
use crate::app::window::session::Moment;
use crate::app::window::state::{Look, State, ViewCamera};
use crate::core::mesh::{Mesh, NodeId};
use crate::render::camera::Camera;
use crate::render::scene::{self, Decision, Outlined};

/// Margin around a fitted mesh, in points.
const MARGIN: f64 = 34.0;
/// Points per unit in the metric lens.
const LENS: f64 = 92.0;
/// The length of the base segment in points where the view shows the decision: the least, however far its other nodes
/// are, and the greatest.
const DECISION: [f64; 2] = [60.0, 180.0];

/// The camera of the view of the plane after a request, and whether it shows the whole mesh.
pub(super) fn aim(state: &State, moment: &Moment, size: DVec2, look: Option<Look>) -> (Camera, bool) {
    let bounds = scene::bounds(&moment.mesh).unwrap_or([DVec2::ZERO, DVec2::ONE]);
    let fitted = Camera::fit(bounds, size, MARGIN);
    let ViewCamera { camera, mut is_fitted, size: before } = state.view().plane;
    // A view that still shows the whole mesh goes on doing so when its size changes, and when a half gets its image.
    let stays = |camera: &Camera| !is_fitted || (before == size && shows(camera, bounds, size));
    let mut camera = camera.filter(stays).unwrap_or(fitted);
    match look {
        // A side is a view of space.
        None | Some(Look::From(_)) => {}
        Some(Look::Fit) => (camera, is_fitted) = (fitted, true),
        Some(Look::Decision) => {
            let ends = Decision::of(&moment.phase).base.or(state.picked_segment()).or(moment.decision().base);
            if let Some((place, scale)) =
                ends.and_then(|ends| near(moment, ends, size, |mesh, n| mesh.uv(n).extend(0.0)))
            {
                camera.look_at(place.truncate(), scale);
                is_fitted = false;
            }
        }
        // A camera of space does not fit the plane.
        Some(Look::Kept(_)) if moment.mesh.embedding().is_some() && state.is_in_space() => {}
        Some(Look::Kept(kept)) => {
            camera.take_up(&kept, size);
            is_fitted = false;
        }
        Some(Look::At(what)) => {
            if let Some(p) = middle(moment, what) {
                let scale = camera.scale;
                camera.look_at(p, scale);
                is_fitted = false;
            }
        }
        Some(Look::Near(what)) => {
            if let Some((place, extent)) = extent_of(moment, what, |mesh, n| mesh.uv(n).extend(0.0))
                && !is_seen_well(&camera, size, place, extent)
            {
                camera.look_at(place.truncate(), scale_for(camera.points_per_unit(), extent, size));
                is_fitted = false;
            }
        }
    }
    (camera, is_fitted)
}

/// How large something is to be in points where a view is moved to show it, and how small it may be otherwise.
const FOUND: [f64; 2] = [80.0, 14.0];
/// The room that a view leaves around what it shows.
const ROOM: f64 = 24.0;

/// The middle of something and the largest distance from there to its nodes, where it exists.
pub(super) fn extent_of(
    moment: &Moment,
    what: Outlined,
    place: impl Fn(&Mesh, NodeId) -> DVec3,
) -> Option<(DVec3, f64)> {
    let mesh = &moment.mesh;
    let nodes: Vec<NodeId> = match what {
        Outlined::Node(node) => {
            mesh.has_node(node).then(|| [node].into_iter().chain(mesh.neighbours(node)).collect())?
        }
        Outlined::Edge(ends) => ends.to_vec(),
        Outlined::Element(e) => mesh.has_element(e).then(|| mesh.corners(e).collect())?,
    };
    if !nodes.iter().all(|n| mesh.has_node(*n)) {
        return None;
    }
    let places: Vec<DVec3> = nodes.iter().map(|&n| place(mesh, n)).collect();
    let middle = match what {
        Outlined::Node(_) => places[0],
        _ => places.iter().sum::<DVec3>() / places.len() as f64,
    };
    let extent = places.iter().map(|p| p.distance(middle)).fold(0.0, f64::max);
    Some((middle, extent.max(f64::MIN_POSITIVE)))
}

/// Whether a view shows all of a box.
fn shows(camera: &Camera, [low, high]: [DVec2; 2], size: DVec2) -> bool {
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    corners.iter().all(|p| {
        let at = camera.project(p.extend(0.0), size);
        at.cmpge(DVec2::ZERO).all() && at.cmple(size).all()
    })
}

/// Whether something lies in a view with room around it and is large enough to be seen.
pub(super) fn is_seen_well(camera: &Camera, size: DVec2, place: DVec3, extent: f64) -> bool {
    let at = camera.project(place, size);
    let is_inside = at.cmpgt(DVec2::splat(ROOM)).all() && at.cmplt(size - ROOM).all();
    let shown = extent * camera.points_per_unit();
    is_inside && (FOUND[1]..=reach(size)).contains(&shown)
}

/// The scale at which something has a good size, unless it is larger already and has room.
pub(super) fn scale_for(scale: f64, extent: f64, size: DVec2) -> f64 {
    scale.max(FOUND[0] / extent).min(reach(size) / extent)
}

/// How far what a view shows may reach from its middle, in points.
fn reach(size: DVec2) -> f64 {
    (0.5 * size.min_element() - ROOM).max(ROOM)
}

/// Where a view looks to show a decision, and the scale: all its nodes if they have room beside a base that can be
/// read, and the base alone otherwise.
pub(super) fn near(
    moment: &Moment,
    base: [NodeId; 2],
    size: DVec2,
    place: impl Fn(&Mesh, NodeId) -> DVec3,
) -> Option<(DVec3, f64)> {
    let mesh = &moment.mesh;
    let decision = moment.decision();
    let tops = decision.tops.into_iter().flatten().filter(|_| decision.base == Some(base));
    let nodes: Vec<NodeId> = base.into_iter().chain(tops).collect();
    if !nodes.iter().all(|n| mesh.has_node(*n)) {
        return None;
    }
    let places: Vec<DVec3> = nodes.into_iter().map(|n| place(mesh, n)).collect();
    let [least, most] = DECISION.map(|length| length / places[0].distance(places[1]).max(f64::MIN_POSITIVE));
    let (low, high) = places.iter().fold((places[0], places[0]), |(low, high), p| (low.min(*p), high.max(*p)));
    let middle = 0.5 * (low + high);
    let extent = places.iter().map(|p| p.distance(middle)).fold(f64::MIN_POSITIVE, f64::max);
    let scale = reach(size) / extent;
    Some(if scale < least { (0.5 * (places[0] + places[1]), least) } else { (middle, scale.min(most)) })
}

/// The middle of something in the plane, if it exists.
pub fn middle(moment: &Moment, what: Outlined) -> Option<DVec2> {
    let mesh = &moment.mesh;
    match what {
        Outlined::Node(node) => mesh.has_node(node).then(|| mesh.uv(node)),
        Outlined::Edge([a, b]) => (mesh.has_node(a) && mesh.has_node(b)).then(|| 0.5 * (mesh.uv(a) + mesh.uv(b))),
        Outlined::Element(e) => mesh.has_element(e).then(|| {
            let corners: Vec<DVec2> = mesh.corners(e).map(|n| mesh.uv(n)).collect();
            corners.iter().sum::<DVec2>() / corners.len() as f64
        }),
    }
}

/// Pan by dragging, zoom by the wheel or two fingers, turn by dragging with the right button.
pub(super) fn steer(ui: &Ui, response: &egui::Response, camera: &mut Camera, rect: Rect) {
    let drag = response.drag_delta();
    let by = DVec2::new(f64::from(drag.x), f64::from(drag.y));
    if response.dragged_by(PointerButton::Primary) || response.dragged_by(PointerButton::Middle) {
        camera.pan(by);
    } else if response.dragged_by(PointerButton::Secondary) {
        camera.orbit(by);
    }
    zoom(ui, response, camera, &ViewFrame { camera: *camera, rect });
}

/// Zooms to the pointer by the wheel or two fingers.
pub(super) fn zoom(ui: &Ui, response: &egui::Response, camera: &mut Camera, frame: &ViewFrame) {
    let Some(at) = response.hover_pos() else { return };
    let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
    let factor = f64::from(pinch) * libm::exp(f64::from(scroll) * 0.004);
    if factor != 1.0 {
        camera.zoom(factor, frame.inside(at), frame.size());
    }
}

/// The node whose metric the lens shows, and the node to its right: A and B of the selection or of the decision.
pub fn lens_node(state: &State, moment: &Moment) -> Option<(NodeId, Option<NodeId>)> {
    let found = match (state.document().picked, state.picked_segment().or(Decision::of(&moment.phase).base)) {
        (Some(Outlined::Node(node)), _) => (node, None),
        (_, Some([a, b])) => (a, Some(b)),
        _ => return None,
    };
    moment.mesh.has_node(found.0).then_some(found)
}

/// The metric of that node: its symmetric root, turned so that A to B runs right and the live side is up.
pub(super) fn metric_lens(state: &State, moment: &Moment) -> Option<Camera> {
    let mesh = &moment.mesh;
    let (node, towards) = lens_node(state, moment)?;
    let root = mesh.metric(node).sqrt();
    let root = DMat2::from_cols(DVec2::new(root.uu, root.uv), DVec2::new(root.uv, root.vv));
    let towards = towards.filter(|b| mesh.has_node(*b));
    let along = towards.map(|b| (root * (mesh.uv(b) - mesh.uv(node))).normalize_or(DVec2::X));
    let turn = along.map_or(DMat2::IDENTITY, |d| DMat2::from_cols(DVec2::new(d.x, -d.y), DVec2::new(d.y, d.x)));
    let mut camera = Camera::through_lens(mesh.uv(node), turn * root, LENS);
    if along.is_some() {
        // The base runs right from A: its quadrilateral lies up and to the right.
        camera.pan(DVec2::new(-40.0, 60.0));
    }
    Some(camera)
}

/// The whole mesh, or the decision if the main view shows the whole mesh already.
pub(super) fn other_end(state: &State, moment: &Moment, size: DVec2) -> Option<Camera> {
    let whole = Camera::fit(scene::bounds(&moment.mesh)?, size, 14.0);
    let decision = Decision::of(&moment.phase).base.or(state.picked_segment());
    let mut camera = whole;
    if let Some(ends) = decision.filter(|_| state.view().plane.is_fitted)
        && let Some((place, scale)) = near(moment, ends, size, |mesh, n| mesh.uv(n).extend(0.0))
    {
        camera.look_at(place.truncate(), 0.7 * scale);
    }
    Some(camera)
}
