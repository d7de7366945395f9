//! The views of the mesh: in space or in its plane, as a whole or near the decision, and through the metric of a node.

mod cameras;
mod faces;
mod following;
mod given;
pub mod pair;
mod space;
mod spotlight;
mod stage;
mod tools;

use std::sync::Arc;

use eframe::egui::{self, PaintCallbackInfo, Rect, Role, Sense, Ui, Vec2, WidgetInfo};
use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, ScreenDescriptor};
use eframe::wgpu;
use glam::{DVec2, DVec3};

use cameras::{aim, metric_lens, other_end, steer};
pub use cameras::{lens_node, middle};
pub use tools::area as tools_area;

use super::command::Command;
use super::labels;
use super::panels::{self, actions, on_click};
use super::presentation::Audience;
use super::session::Moment;
use super::state::{Look, State, SurfaceView, ViewCamera, ViewKind};
use super::theme::ink;
use super::words;
use crate::core::mesh::{ElementId, Mesh, NodeId};
use crate::core::run::Changes;
use crate::core::run::explain::plain;
use crate::render::camera::Camera;
use crate::render::gpu::{Light, Painter, VIEWS, View};
use crate::render::palette::{Palette, Rgba};
use crate::render::pick;
use crate::render::scene::{Decision, Form, Outlined, Scene, Shading};
use following::{LEAST, Places};
use stage::Stage;

/// A view beside the main one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lens {
    /// The normalised space of a node, where unit edges have length 1 and right angles look right.
    Metric,
    /// The whole mesh, or the decision if the main view shows the whole mesh.
    Whole,
}

/// The views of a run: 0 is the main one, then come the lens, the whole, and the plane beside space.
const LENS: usize = 1;
const WHOLE: usize = 2;
const BESIDE: usize = 3;

/// After so many seconds without a movement the pointer of a presentation is hidden, and points at nothing.
const REST: f32 = 2.0;

/// A place or a direction of a node.
type OfNode = fn(&Mesh, NodeId) -> DVec3;

/// Where nodes lie in the plane, which faces the view however it is turned there.
const IN_PLANE: Places<OfNode, OfNode> = Places { place: |mesh, n| mesh.uv(n).extend(0.0), normal: |_, _| DVec3::ZERO };

/// All views of a run, and the two scenes that they share: one of the plane and one in space.
#[derive(Default)]
pub struct Views {
    /// The number of the first view on the graphics card.
    first: usize,
    plane: Stage,
    space: Stage,
    pub shading: Shading,
    hint: Option<ElementId>,
    /// Labels of the views in the frame before.
    labels: [labels::Memory; VIEWS],
    /// What the open context menu is about.
    menu_of: Option<Outlined>,
    /// The point about which a drag in space turns the mesh.
    pivot: Option<DVec3>,
    /// The part of the scene in space that hides labels.
    cover: space::Covering,
    /// The last request to look somewhere that the views have followed.
    looked: u64,
    /// The camera that goes where the decision is.
    following: following::Following,
    /// The audience of a presentation; none in the window.
    pub audience: Option<Audience>,
}

/// The camera of a view and its rectangle on the screen.
#[derive(Clone, Copy)]
pub struct ViewFrame {
    pub camera: Camera,
    pub rect: Rect,
}

impl ViewFrame {
    pub fn size(&self) -> DVec2 {
        DVec2::new(f64::from(self.rect.width()), f64::from(self.rect.height()))
    }

    /// Where a point lies on the screen.
    pub fn place(&self, p: DVec3) -> egui::Pos2 {
        let at = self.camera.project(p, self.size());
        self.rect.min + Vec2::new(at.x as f32, at.y as f32)
    }

    /// The point of the plane at a place of the screen.
    pub fn plane(&self, at: egui::Pos2) -> Option<DVec2> {
        self.camera.unproject(self.inside(at), self.size())
    }

    fn inside(&self, at: egui::Pos2) -> DVec2 {
        let at = at - self.rect.min;
        DVec2::new(f64::from(at.x), f64::from(at.y))
    }
}

impl Views {
    /// The views of a run beside others, by its number from 0.
    pub fn of_run(number: usize) -> Views {
        Views { first: number * VIEWS, ..Views::default() }
    }

    /// Whether a mesh has been shown.
    pub fn has_shown(&self) -> bool {
        self.plane.has_shown() || self.space.has_shown()
    }

    /// The main view.
    pub fn space(&mut self, ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &'static Palette) {
        let rect = whole_pixels(ui.max_rect(), ui.pixels_per_point());
        let Some(moment) = state.run().moment.clone() else {
            self.canvas(ui, rect, "space", state);
            ui.painter().rect_filled(rect, 0.0, ink(palette.ground));
            return empty(ui, state, commands, palette);
        };
        let look = state.view().look.take(&mut self.looked);
        let on_surfaces = moment.mesh.embedding().is_some();
        match state.workspace().surfaces.view {
            SurfaceView::Plane => self.in_plane(ui, rect, 0, look, state, &moment, commands, palette),
            _ if !on_surfaces => self.in_plane(ui, rect, 0, look, state, &moment, commands, palette),
            SurfaceView::Space => self.in_space(ui, rect, look, state, &moment, commands, palette),
            SurfaceView::Both => {
                let middle = whole_pixels(rect, 1.0).center().x;
                let (left, right) = rect.split_left_right_at_x(middle);
                let right = right.with_min_x(middle + 2.0);
                self.in_space(ui, left, look, state, &moment, commands, palette);
                self.in_plane(ui, right, BESIDE, look, state, &moment, commands, palette);
                ui.painter().vline(middle + 1.0, rect.y_range(), (2.0, ink(palette.line)));
            }
        }
        if on_surfaces && self.audience.is_none() {
            tools::show(ui, rect, state, commands, palette);
        }
    }

    /// The pointer in a view.
    fn canvas(&self, ui: &Ui, rect: Rect, name: &str, state: &State) -> egui::Response {
        let response = ui.interact(rect, ui.scope_id().with(name), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, spoken(state)));
        ui.ctx().accesskit_node_builder(response.id, |node| node.set_description(described(state)));
        response
    }

    /// The mesh in its plane.
    fn in_plane(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        index: usize,
        look: Option<Look>,
        state: &State,
        moment: &Moment,
        commands: &mut Vec<Command>,
        palette: &'static Palette,
    ) {
        let response = self.canvas(ui, rect, "plane", state);
        let size = DVec2::new(f64::from(rect.width()), f64::from(rect.height()));
        let (mut camera, mut is_fitted) = aim(state, moment, size, look);
        // Where it is beside a view in space, that one follows the decisions.
        if index == 0
            && let Some(guided) = self.guided(ui, state, moment, camera, size, &IN_PLANE)
        {
            (camera, is_fitted) = (guided, false);
        }
        let aimed = camera;
        steer(ui, &response, &mut camera, rect);
        if camera != aimed {
            is_fitted = false;
            self.following.leave();
        }
        moved(state.view().plane, ViewKind::Plane, ViewCamera { camera: Some(camera), is_fitted, size }, commands);
        let frame = ViewFrame { camera, rect };
        let pointer = response.hover_pos().filter(|_| !response.dragged());
        let hovered = pointer.and_then(|at| {
            let p = frame.plane(at)?;
            let project = |p: DVec2| frame.camera.project(p.extend(0.0), frame.size());
            pick::pick(&moment.mesh, p, frame.inside(at), &project, self.hint)
        });
        self.point(ui, &response, state, hovered, commands);
        self.plane.update(state, moment, palette, &frame, Form::Plane, true, &mut self.shading);
        paint(ui, self.first + index, &frame, &self.plane.scene, palette, Light::NONE, 0.0);
        faces::show(ui, &frame, state, moment, palette);
        let over = labels::LabelledScene { frame: &frame, scene: &self.plane.scene, cover: None };
        labelled(ui, &over, state, moment, palette, self.audience, &mut self.labels[index]);
        if index == 0 {
            labels::shading(ui, &frame, &self.shading, palette);
        }
    }

    /// The camera of this frame, where it follows the decisions and moves.
    fn guided<P: Fn(&Mesh, NodeId) -> DVec3, N: Fn(&Mesh, NodeId) -> DVec3>(
        &mut self,
        ui: &Ui,
        state: &State,
        moment: &Moment,
        camera: Camera,
        size: DVec2,
        places: &Places<P, N>,
    ) -> Option<Camera> {
        let (follows, least) = match self.audience {
            None => (state.workspace().follows, LEAST[0]),
            Some(audience) => (audience.follows, LEAST[1]),
        };
        let follows = follows.then_some(least);
        self.following.guide(ui, state, follows, moment, camera, size, places)
    }

    /// Another view of the same scene.
    pub fn other(&mut self, ui: &mut Ui, state: &State, lens: Lens, palette: &'static Palette) {
        let rect = whole_pixels(ui.max_rect(), ui.pixels_per_point());
        let ground = |ui: &Ui| ui.painter().rect_filled(rect, 0.0, ink(palette.ground));
        let Some(moment) = state.run().moment.clone() else {
            ground(ui);
            return;
        };
        let size = DVec2::new(f64::from(rect.width()), f64::from(rect.height()));
        let camera = match lens {
            Lens::Metric => metric_lens(state, &moment),
            Lens::Whole => other_end(state, &moment, size),
        };
        let Some(camera) = camera else {
            ground(ui);
            let text = "Select a node or a front segment to see it in its own metric.";
            return instead(ui, rect, 60.0, text, palette);
        };
        let frame = ViewFrame { camera, rect };
        let (which, k) =
            if lens == Lens::Metric { (labels::ViewRole::Lens, LENS) } else { (labels::ViewRole::Whole, WHOLE) };
        self.plane.update(state, &moment, palette, &frame, Form::Plane, false, &mut self.shading);
        paint(ui, self.first + k, &frame, &self.plane.scene, palette, Light::NONE, 0.0);
        let over = labels::LabelledScene { frame: &frame, scene: &self.plane.scene, cover: None };
        labels::show(ui, &over, state, &moment, palette, which, None, &mut self.labels[k]);
    }

    /// Reports what is under the pointer, and selects, shows and offers actions.
    fn point(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        state: &State,
        hovered: Option<Outlined>,
        commands: &mut Vec<Command>,
    ) {
        if let Some(Outlined::Element(e)) = hovered {
            self.hint = Some(e);
        }
        // An element under the pointer is not to be taken for a part of the lesson. No question asks for one.
        let is_element = |what: &Outlined| matches!(what, Outlined::Element(_));
        let shown = hovered.filter(|what| state.shown_study().is_none() || !is_element(what));
        // A pointer that rests points at nothing that an audience should see.
        let rests = self.audience.is_some() && rests(ui);
        let shown = shown.filter(|_| !rests);
        commands.extend(shown.map(Command::Hover));
        on_click(response, Command::Pick(hovered), commands);
        if response.double_clicked()
            && let Some(what) = hovered
        {
            commands.push(Command::Show(what));
        }
        if response.secondary_clicked() {
            self.menu_of = hovered;
        }
        if let Some(what) = self.menu_of {
            response.context_menu(|ui| {
                actions::menu(ui, state, what, commands);
            });
        }
        if rests && response.hovered() {
            ui.ctx().set_cursor_icon(egui::CursorIcon::None);
        } else if shown.is_some() && response.hovered() {
            ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        }
    }

    /// Notes the differences from the state before.
    pub fn note(&mut self, changes: &Changes, slots: usize) {
        self.plane.note(changes, slots);
        self.space.note(changes, slots);
    }
}

/// Whether the pointer has not moved for a while; the frame in which it comes to rest is drawn.
fn rests(ui: &Ui) -> bool {
    let still = ui.input(|input| input.pointer.time_since_last_movement());
    if still < REST {
        ui.ctx().request_repaint_after(std::time::Duration::from_secs_f32(REST - still));
    }
    still >= REST
}

/// Labels over a main view, and the light of a presentation.
fn labelled(
    ui: &Ui,
    over: &labels::LabelledScene<'_>,
    state: &State,
    moment: &Moment,
    palette: &Palette,
    audience: Option<Audience>,
    memory: &mut labels::Memory,
) {
    labels::show(ui, over, state, moment, palette, labels::ViewRole::Main, audience, memory);
    if audience.is_some_and(|audience| audience.spotlight) {
        spotlight::show(ui, over.frame, over.scene, &moment.decision(), palette);
    }
}

/// Draws a scene; `hidden`: the opacity of hidden lines.
fn paint(ui: &Ui, index: usize, frame: &ViewFrame, scene: &Arc<Scene>, palette: &Palette, light: Light, hidden: f32) {
    let (camera, size, pixels, ground) = (frame.camera, frame.size(), ui.pixels_per_point(), palette.ground);
    let view = View { camera, size, pixels, ground, light, hidden };
    let picture = Picture { scene: scene.clone(), view, index };
    ui.painter().add(Callback::new_paint_callback(frame.rect, picture));
}

/// Words in the middle of a view that shows nothing.
fn instead(ui: &mut Ui, rect: Rect, height: f32, text: &str, palette: &Palette) {
    let inner = Rect::from_center_size(rect.center(), Vec2::new((rect.width() - 40.0).max(1.0), height));
    ui.scope_builder(egui::UiBuilder::new().max_rect(inner), |ui| {
        ui.vertical_centered(|ui| ui.add(egui::Label::new(panels::note(text, palette)).wrap()));
    });
}

/// Reports where a view looks, if that has changed.
fn moved(before: ViewCamera, view: ViewKind, camera: ViewCamera, commands: &mut Vec<Command>) {
    if camera != before {
        commands.push(Command::MoveCamera(view, camera));
    }
}

/// The state in words: a heading, and its description.
#[cfg(target_arch = "wasm32")]
pub fn in_words(state: &State) -> [String; 2] {
    [spoken(state), described(state)]
}

/// The description of the view for screen readers.
fn spoken(state: &State) -> String {
    match &state.run().moment {
        Some(moment) => format!("Mesh at step {}, {}", moment.step, words::counted(moment.standing, "quadrilateral")),
        None => "No mesh".to_owned(),
    }
}

/// The state as text, for screen readers: the front, the base, what the last step did and why, and what comes next.
fn described(state: &State) -> String {
    let Some(moment) = &state.run().moment else { return String::new() };
    let (segments, loops) = (moment.front.len() as u64, moment.loops.len() as u64);
    let mut said = vec![match segments {
        0 => "The front is closed.".to_owned(),
        _ => {
            let loops = words::counted(loops, "loop");
            format!("The front has {} in {loops}.", words::counted(segments, "segment"))
        }
    }];
    let base = Decision::of(&moment.phase).base;
    if let Some(s) = base.and_then(|ends| moment.front.iter().find(|s| [s.a, s.b] == ends)) {
        said.push(format!("The base is {}, of class {}.", words::segment([s.a, s.b]), s.class));
    }
    said.extend(std::iter::once(&moment.narration).chain(&moment.about).cloned());
    // What comes next is the answer to a question that is open.
    if state.open_question().is_none() {
        said.push(format!("Next: {}", moment.next));
    }
    plain(&said.join(" "))
}

fn empty(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    if state.run().is_busy() {
        return;
    }
    let rect = Rect::from_center_size(ui.max_rect().center(), Vec2::new(420.0, 80.0));
    ui.scope_builder(egui::UiBuilder::new().max_rect(rect), |ui| {
        ui.vertical_centered(|ui| {
            ui.colored_label(ink(palette.weak), "No case is open. Drop a case or a mesh file here, or");
            for command in [Command::Open(super::Source::BuiltIn("example1".into())), Command::OpenPath] {
                on_click(&ui.button(command.name()), command, commands);
            }
        });
    });
}

/// Rounds a rectangle to whole pixels, so that the picture is not resampled.
fn whole_pixels(rect: Rect, pixels: f32) -> Rect {
    let whole = |x: f32| (x * pixels).round() / pixels;
    Rect::from_min_max(
        egui::pos2(whole(rect.min.x), whole(rect.min.y)),
        egui::pos2(whole(rect.max.x).max(rect.min.x + 1.0), whole(rect.max.y).max(rect.min.y + 1.0)),
    )
}

/// A picture for egui's renderer: the scene as it was when the frame was made.
struct Picture {
    scene: Arc<Scene>,
    view: View,
    index: usize,
}

impl CallbackTrait for Picture {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(painter) = resources.get_mut::<Painter>() {
            painter.draw(device, queue, encoder, self.index, &self.view, &self.scene);
        }
        Vec::new()
    }

    fn paint(&self, _: PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, resources: &CallbackResources) {
        if let Some(painter) = resources.get::<Painter>() {
            painter.lay(self.index, pass);
        }
    }
}

/// A colour of the palette for labels.
pub fn class_colour(palette: &Palette, class: u8) -> Rgba {
    palette.front[usize::from(class.clamp(1, 4)) - 1]
}
