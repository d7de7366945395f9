//! The view of a mesh that is about to be converted: its features and charts.

use eframe::egui::{Role, Sense, Ui, WidgetInfo};
use glam::{DQuat, DVec2, DVec3};

use super::space::{MARGIN, middle_of, orbit};
use super::{ViewFrame, Views, instead, moved, paint, tools, whole_pixels};
use crate::app::window::command::Command;
use crate::app::window::import::Loaded;
use crate::app::window::state::{Look, State, ViewCamera, ViewKind};
use crate::app::window::theme::ink;
use crate::app::window::words;
use crate::render::camera::{Bearing, Camera};
use crate::render::gpu::Light;
use crate::render::palette::Palette;
use crate::render::pick;

/// The picture on the graphics card: that of the main view.
const INDEX: usize = 0;

impl Views {
    /// The main view while a mesh is about to be converted.
    pub fn given(&mut self, ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &'static Palette) {
        let rect = whole_pixels(ui.max_rect(), ui.pixels_per_point());
        let response = ui.interact(rect, ui.scope_id().with("given"), Sense::click_and_drag());
        let look = state.view().look.take(&mut self.looked);
        let hidden = state.workspace().surfaces.hidden.share();
        let Some(import) = &state.run().import else { return };
        let marks = import.shown.as_ref().map_or_else(Default::default, |shown| shown.wanted.marks.clone());
        let spoken = match (&import.shown, marks.len()) {
            (Some(shown), marks) => {
                let mesh = format!(
                    "Mesh of {}, as imported",
                    words::counted(shown.scene.faces.items().len() as u64, "triangle")
                );
                match marks {
                    0 => mesh,
                    1 => mesh + ", one element marked",
                    n => format!("{mesh}, {n} elements marked"),
                }
            }
            (None, _) => "No mesh yet".to_owned(),
        };
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, spoken.as_str()));
        ui.painter().rect_filled(rect, 0.0, ink(palette.ground));
        let Some(loaded) = import.loaded.clone() else {
            return instead(ui, rect, 40.0, "The mesh is being read.", palette);
        };
        let Some(shown) = import.shown.clone() else {
            return instead(ui, rect, 40.0, "Its features and charts are being computed.", palette);
        };
        let size = DVec2::new(f64::from(rect.width()), f64::from(rect.height()));
        let mut is_fitted = import.view.is_fitted;
        let mut camera = match import.view.camera {
            None => {
                // The view stays near the elements for which the mesh is refused until the user looks elsewhere.
                let marks = import.refused.as_ref().map_or(&[][..], |fault| &fault.shapes);
                is_fitted = marks.is_empty();
                let side = if loaded.is_plane { Bearing::Z } else { side_of(marks, &loaded) };
                let all = fit(&loaded, side.turn(), size);
                if marks.is_empty() { all } else { look_at(marks, loaded.mean_edge, all, size) }
            }
            Some(camera) if is_fitted && import.view.size != size => fit(&loaded, camera.turn, size),
            Some(camera) => camera,
        };
        match look {
            Some(Look::Fit) => (camera, is_fitted) = (fit(&loaded, camera.turn, size), true),
            Some(Look::From(side)) => (camera, is_fitted) = (fit(&loaded, side.turn(), size), true),
            _ => {}
        }
        let frame = ViewFrame { camera, rect };
        if response.drag_started() {
            let press = ui.input(|input| input.pointer.press_origin());
            let hit = press.and_then(|at| pick::hit(&shown.scene, &camera, size, frame.inside(at)));
            self.pivot = Some(hit.map_or(shown.scene.anchor, |hit| hit.place));
        }
        if orbit(ui, &response, &mut camera, frame, self.pivot) {
            is_fitted = false;
        }
        moved(import.view, ViewKind::Import, ViewCamera { camera: Some(camera), is_fitted, size }, commands);
        let light = if loaded.is_plane { Light::NONE } else { Light::on_surfaces(palette.dark) };
        paint(ui, INDEX, &ViewFrame { camera, rect }, &shown.scene, palette, light, hidden);
        tools::show_sides(ui, rect, state, commands, palette);
    }
}

fn fit(loaded: &Loaded, turn: DQuat, size: DVec2) -> Camera {
    Camera::fit_in_space(loaded.mesh.points.iter().copied(), turn, size, MARGIN)
}

/// The side from which marked elements are seen: the usual one, unless they are at the back.
fn side_of(marks: &[Vec<DVec3>], loaded: &Loaded) -> Bearing {
    let corners = loaded.mesh.triangles.as_flattened().iter().map(|&k| loaded.mesh.points[k as usize]);
    let out = match (middle_of(marks.iter().flatten().copied()), middle_of(corners)) {
        (Some(marks), Some(all)) if marks.distance(all) > 0.1 * loaded.extent.max_element() => marks - all,
        _ => return Bearing::Iso,
    };
    let [azimuth, elevation, _] = Bearing::Iso.angles();
    let around = |quarter: i32| azimuth + 90.0 * f64::from(quarter);
    let sides = [elevation, -elevation]
        .into_iter()
        .flat_map(|elevation| (-1..3).map(move |quarter| Bearing::Angles([around(quarter), elevation, 0.0])));
    let seen = |side: &Bearing| (side.turn() * out).z / out.length();
    if seen(&Bearing::Iso) > 0.0 {
        return Bearing::Iso;
    }
    sides.max_by(|a, b| seen(a).total_cmp(&seen(b))).unwrap_or_default()
}

/// A camera on some elements, with enough around them to see where they are; `all` sees the whole mesh.
fn look_at(marks: &[Vec<DVec3>], mean_edge: f64, all: Camera, size: DVec2) -> Camera {
    let ends = || marks.iter().flatten().copied();
    let (low, high) = ends().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let room = 0.5 * (high - low).max_element() + 2.0 * mean_edge;
    let around = ends().flat_map(|p| [p - room, p + room]);
    let near = Camera::fit_in_space(around, all.turn, size, MARGIN);
    // It never looks from farther away than for the whole mesh.
    if near.scale > all.scale { near.come_from(&all) } else { all }
}
