//! The mesh in space: orbit, pan, zoom, and picking from front to back.

use eframe::egui::{self, PointerButton, Rect, Ui};
use glam::{DQuat, DVec2, DVec3};

use super::cameras::{extent_of, is_seen_well, near, scale_for, zoom};
use super::following::Places;
use super::{ViewFrame, Views, labelled, moved, paint};
use crate::app::window::command::Command;
use crate::app::window::labels;
use crate::app::window::session::Moment;
use crate::app::window::state::{Look, State, ViewCamera, ViewKind};
use crate::core::mesh::{Mesh, NodeId};
use crate::render::camera::{Bearing, Camera};
use crate::render::gpu::Light;
use crate::render::palette::Palette;
use crate::render::pick::{self, Cover};
use crate::render::scene::{ColourBy, Decision, Outlined};

/// Margin around a fitted mesh, in points.
pub(super) const MARGIN: f64 = 44.0;

/// A base whose normal has less than this in common with the direction towards the eye is turned to the front.
const FACING: f64 = 0.3;

/// The last cover, and the scene and camera that it is of.
#[derive(Default)]
pub(super) struct Covering {
    of: Option<(u64, Camera, DVec2)>,
    cover: Cover,
}

impl Views {
    /// The mesh in space.
    pub(super) fn in_space(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        look: Option<Look>,
        state: &State,
        moment: &Moment,
        commands: &mut Vec<Command>,
        palette: &'static Palette,
    ) {
        let response = self.canvas(ui, rect, "space", state);
        let size = DVec2::new(f64::from(rect.width()), f64::from(rect.height()));
        let (mut camera, mut is_fitted) = aim(state, moment, size, look);
        let places = Places { place: |mesh: &Mesh, n| mesh.xyz(n), normal: |mesh: &Mesh, n| mesh.normal(n) };
        if let Some(guided) = self.guided(ui, state, moment, camera, size, &places) {
            (camera, is_fitted) = (guided, false);
        }
        if self.steer(ui, &response, &mut camera, rect, moment) {
            is_fitted = false;
            self.following.leave();
        }
        moved(state.view().space, ViewKind::Space, ViewCamera { camera: Some(camera), is_fitted, size }, commands);
        let frame = ViewFrame { camera, rect };
        let pointer = response.hover_pos().filter(|_| !response.dragged());
        // Picking needs the elements of the current state.
        let form = state.workspace().surfaces.form();
        self.space.update(state, moment, palette, &frame, form, true, &mut self.shading);
        let hovered = pointer
            .and_then(|at| pick::pick_in_space(&self.space.scene, &moment.mesh, &camera, size, frame.inside(at)));
        self.point(ui, &response, state, hovered, commands);
        let hidden = state.workspace().surfaces.hidden.share();
        let light = match self.shading.by {
            ColourBy::State => Light::on_surfaces(palette.dark),
            _ => Light::ON_DATA,
        };
        paint(ui, self.first, &frame, &self.space.scene, palette, light, hidden);
        let of = Some((self.space.scene.shape(), camera, size));
        if self.cover.of != of {
            self.cover = Covering { of, cover: Cover::of(&self.space.scene, &camera, size) };
        }
        let over = labels::LabelledScene { frame: &frame, scene: &self.space.scene, cover: Some(&self.cover.cover) };
        labelled(ui, &over, state, moment, palette, self.audience, &mut self.labels[0]);
        labels::shading(ui, &frame, &self.shading, palette);
    }

    /// Orbit by dragging, pan by dragging with another button or Shift, zoom to the pointer by the wheel or two
    /// fingers. Returns whether the camera has moved.
    fn steer(&mut self, ui: &Ui, response: &egui::Response, camera: &mut Camera, rect: Rect, moment: &Moment) -> bool {
        let frame = ViewFrame { camera: *camera, rect };
        if response.drag_started() {
            // The point that is grabbed stays under the pointer; beside the mesh, the drag turns about its middle.
            let press = ui.input(|input| input.pointer.press_origin());
            let hit = press.and_then(|at| pick::hit(&self.space.scene, camera, frame.size(), frame.inside(at)));
            self.pivot =
                hit.map(|hit| hit.place).or_else(|| middle_of(moment.mesh.nodes().map(|n| moment.mesh.xyz(n))));
        }
        orbit(ui, response, camera, frame, self.pivot)
    }
}

/// Turns, moves and zooms a view in space; a drag turns about `pivot`. Returns whether the camera has moved.
pub(super) fn orbit(
    ui: &Ui,
    response: &egui::Response,
    camera: &mut Camera,
    frame: ViewFrame,
    pivot: Option<DVec3>,
) -> bool {
    let before = *camera;
    let drag = response.drag_delta();
    let by = DVec2::new(f64::from(drag.x), f64::from(drag.y));
    let shift = ui.input(|input| input.modifiers.shift);
    if response.dragged_by(PointerButton::Primary) && !shift {
        camera.orbit_about(by, pivot.unwrap_or(camera.centre));
    } else if response.dragged() {
        camera.pan(by);
    }
    zoom(ui, response, camera, &frame);
    *camera != before
}

fn fit(moment: &Moment, turn: DQuat, size: DVec2) -> Camera {
    Camera::fit_in_space(moment.mesh.nodes().map(|n| moment.mesh.xyz(n)), turn, size, MARGIN)
}

/// The middle of the least box around some points.
pub(super) fn middle_of(points: impl Iterator<Item = DVec3>) -> Option<DVec3> {
    let ends = points.map(|p| [p, p]);
    ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).map(|[low, high]| 0.5 * (low + high))
}

/// The camera of the view of space after a request, and whether it shows the whole mesh.
fn aim(state: &State, moment: &Moment, size: DVec2, look: Option<Look>) -> (Camera, bool) {
    let before = state.view().space;
    let (mut camera, mut is_fitted) = match before.camera {
        None => (fit(moment, Bearing::Iso.turn(), size), true),
        // A view that still shows the whole mesh goes on doing so when its size changes.
        Some(camera) if before.is_fitted && before.size != size => (fit(moment, camera.turn, size), true),
        Some(camera) => (camera, before.is_fitted),
    };
    match look {
        None => {}
        Some(Look::Fit) => {
            if let Some((_, normal)) =
                Decision::of(&moment.phase).base.and_then(|b| place_of(moment, Outlined::Edge(b)))
                && normal.dot(camera.towards()) < FACING
            {
                camera.face(normal);
            }
            (camera, is_fitted) = (fit(moment, camera.turn, size), true);
        }
        Some(Look::From(side)) => (camera, is_fitted) = (fit(moment, side.turn(), size), true),
        // A camera of the plane looks straight down at it.
        Some(Look::Kept(kept)) if kept.is_of_the_plane() => {}
        Some(Look::Kept(kept)) => {
            camera.take_up(&kept, size);
            is_fitted = false;
        }
        Some(Look::Decision) => {
            let ends = Decision::of(&moment.phase).base.or(state.picked_segment()).or(moment.decision().base);
            if let Some(ends) = ends {
                let found = near(moment, ends, size, |mesh, n| mesh.xyz(n));
                if let Some(((place, scale), (_, normal))) = found.zip(place_of(moment, Outlined::Edge(ends))) {
                    // What lies on the far side is turned to the front.
                    if normal.dot(camera.towards()) < FACING {
                        camera.face(normal);
                    }
                    camera.look_at_place(place, scale);
                    is_fitted = false;
                }
            }
        }
        Some(Look::At(what)) => {
            if let Some((place, _)) = place_of(moment, what) {
                camera.centre_on(place);
                is_fitted = false;
            }
        }
        Some(Look::Near(what)) => {
            let found = extent_of(moment, what, |mesh, n| mesh.xyz(n));
            if let Some(((place, extent), (_, normal))) = found.zip(place_of(moment, what)) {
                let is_behind = normal.dot(camera.towards()) < 0.3;
                if is_behind {
                    camera.face(normal);
                }
                if is_behind || !is_seen_well(&camera, size, place, extent) {
                    camera.look_at_place(place, scale_for(camera.points_per_unit(), extent, size));
                    is_fitted = false;
                }
            }
        }
    }
    (camera, is_fitted)
}

/// Where something lies in space, and the normal there.
fn place_of(moment: &Moment, what: Outlined) -> Option<(DVec3, DVec3)> {
    let mesh = &moment.mesh;
    let nodes: Vec<NodeId> = match what {
        Outlined::Node(node) => vec![node],
        Outlined::Edge(ends) => ends.to_vec(),
        Outlined::Element(e) if mesh.has_element(e) => mesh.corners(e).collect(),
        Outlined::Element(_) => return None,
    };
    if !nodes.iter().all(|n| mesh.has_node(*n)) {
        return None;
    }
    let sum = nodes.iter().map(|n| mesh.xyz(*n)).sum::<DVec3>();
    let normal = nodes.iter().map(|n| mesh.normal(*n)).sum::<DVec3>();
    Some((sum / nodes.len() as f64, normal.normalize_or(DVec3::Z)))
}
