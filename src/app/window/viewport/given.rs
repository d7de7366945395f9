//! The mesh that is about to be converted: its features and charts, before there is a mesh of the program's own.

use eframe::egui::{self, Rect, Role, Sense, Ui, Vec2, WidgetInfo};
use eframe::egui_wgpu::Callback;
use glam::{DQuat, DVec2};

use super::space::{MARGIN, orbit};
use super::{Frame, Picture, Views, tools, whole_pixels};
use crate::app::window::command::Command;
use crate::app::window::import::Loaded;
use crate::app::window::state::{Look, State};
use crate::app::window::theme::ink;
use crate::render::camera::{Bearing, Camera};
use crate::render::gpu::{Light, View};
use crate::render::palette::Palette;
use crate::render::pick;

/// The number of the view's picture on the card: that of the main view.
const INDEX: usize = 0;

impl Views {
    /// The main view while a mesh is about to be converted.
    pub fn given(&mut self, ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>, palette: &'static Palette) {
        let rect = whole_pixels(ui.max_rect(), ui.pixels_per_point());
        let response = ui.interact(rect, ui.scope_id().with("given"), Sense::click_and_drag());
        let look = state.look.take();
        let hidden = state.space.hidden.share();
        let Some(import) = &mut state.import else { return };
        let spoken = match &import.shown {
            Some(shown) => format!("Mesh of {} triangles, as it was given", shown.scene.faces.items().len()),
            None => "No mesh yet".to_owned(),
        };
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, spoken.as_str()));
        ui.painter().rect_filled(rect, 0.0, ink(palette.ground));
        let Some(loaded) = import.loaded.clone() else {
            return words(ui, rect, "The mesh is being read.", palette);
        };
        let Some(shown) = import.shown.clone() else {
            return words(ui, rect, "Its features and charts are being sought.", palette);
        };
        let size = DVec2::new(f64::from(rect.width()), f64::from(rect.height()));
        let mut camera = match import.camera {
            None => {
                import.fitted = true;
                let side = if loaded.is_plane { Bearing::Z } else { Bearing::Iso };
                fit(&loaded, side.turn(), size)
            }
            Some(camera) if import.fitted && import.size != size => fit(&loaded, camera.turn, size),
            Some(camera) => camera,
        };
        import.size = size;
        match look {
            Some(Look::Fit) => (camera, import.fitted) = (fit(&loaded, camera.turn, size), true),
            Some(Look::From(side)) => (camera, import.fitted) = (fit(&loaded, side.turn(), size), true),
            _ => {}
        }
        let frame = Frame { camera, rect };
        if response.drag_started() {
            let press = ui.input(|input| input.pointer.press_origin());
            let hit = press.and_then(|at| pick::hit(&shown.scene, &camera, size, frame.inside(at)));
            self.pivot = Some(hit.map_or(shown.scene.anchor, |hit| hit.place));
        }
        if orbit(ui, &response, &mut camera, frame, self.pivot) {
            import.fitted = false;
        }
        import.camera = Some(camera);
        let view = View {
            camera,
            size,
            pixels: ui.pixels_per_point(),
            ground: palette.ground,
            light: if loaded.is_plane { Light::NONE } else { Light::on_surfaces(palette.dark) },
            hidden,
        };
        let picture = Picture { scene: shown.scene.clone(), view, index: INDEX };
        ui.painter().add(Callback::new_paint_callback(rect, picture));
        tools::show_sides(ui, rect, state, commands, palette);
    }
}

fn fit(loaded: &Loaded, turn: DQuat, size: DVec2) -> Camera {
    Camera::fit_in_space(loaded.mesh.points.iter().copied(), turn, size, MARGIN)
}

fn words(ui: &mut Ui, rect: Rect, text: &str, palette: &Palette) {
    let inner = Rect::from_center_size(rect.center(), Vec2::new((rect.width() - 40.0).max(1.0), 40.0));
    ui.scope_builder(egui::UiBuilder::new().max_rect(inner), |ui| {
        ui.vertical_centered(|ui| ui.label(crate::app::window::panels::note(text, palette)));
    });
}
