//! The views: the mesh in space, the same from the other end of the zoom, and through the metric of a node.

use std::sync::Arc;

use eframe::egui::{self, PaintCallbackInfo, PointerButton, Rect, Role, Sense, Ui, Vec2, WidgetInfo};
use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, ScreenDescriptor};
use eframe::wgpu;
use glam::{DMat2, DVec2};

use super::command::Command;
use super::labels;
use super::session::Moment;
use super::state::{Look, State};
use super::theme::ink;
use crate::core::convert::candidates::Passed;
use crate::core::front::sector::Side;
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::render::camera::Camera;
use crate::render::gpu::{Painter, View};
use crate::render::palette::{Palette, Rgba};
use crate::render::pick;
use crate::render::scene::{self, Decision, Outlined, Overlay, Scene, Shading};

/// Points left free around a fitted mesh.
const MARGIN: f64 = 34.0;
/// Points for a unit in the metric lens.
const LENS: f64 = 92.0;
/// Points for the base segment when the decision is looked at.
const DECISION: f64 = 180.0;

/// A view beside the main one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lens {
    /// The normalised space of a node, where unit edges have length 1 and right angles look right.
    Metric,
    /// The whole mesh, or where the main view shows that, the decision.
    Whole,
}

/// All views, with the scene that they share.
#[derive(Default)]
pub struct Views {
    scene: Arc<Scene>,
    pub shading: Shading,
    seen_mesh: Option<(u64, bool)>,
    seen_over: Option<u64>,
    hint: Option<ElementId>,
}

/// A view's camera with its place on the screen.
#[derive(Clone, Copy)]
pub struct Frame {
    pub camera: Camera,
    pub rect: Rect,
}

impl Frame {
    pub fn size(&self) -> DVec2 {
        DVec2::new(f64::from(self.rect.width()), f64::from(self.rect.height()))
    }

    /// Where a point of the plane lies on the screen.
    pub fn place(&self, p: DVec2) -> egui::Pos2 {
        let at = self.camera.project(p.extend(0.0), self.size());
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
    /// The main view.
    pub fn space(&mut self, ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>, palette: &'static Palette) {
        let rect = whole_pixels(ui.max_rect(), ui.pixels_per_point());
        let response = ui.interact(rect, ui.scope_id().with("space"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, spoken(state)));
        let Some(moment) = state.moment.clone() else {
            return empty(ui, state, commands, palette);
        };
        let size = DVec2::new(f64::from(rect.width()), f64::from(rect.height()));
        let mut camera = aim(state, &moment, size);
        steer(ui, &response, &mut camera, rect);
        state.camera = Some(camera);
        let frame = Frame { camera, rect };
        self.hover(ui, &response, state, &moment, &frame, commands);
        self.update(state, &moment, palette, &frame);
        self.paint(ui, 0, &frame, palette);
        labels::show(ui, &frame, state, &moment, palette, labels::Which::Main);
        labels::shading(ui, &frame, &self.shading, palette);
    }

    /// Another view of the same scene.
    pub fn other(&mut self, ui: &mut Ui, state: &mut State, lens: Lens, palette: &'static Palette) {
        let rect = whole_pixels(ui.max_rect(), ui.pixels_per_point());
        let Some(moment) = state.moment.clone() else { return };
        let size = DVec2::new(f64::from(rect.width()), f64::from(rect.height()));
        let camera = match lens {
            Lens::Metric => metric_lens(state, &moment),
            Lens::Whole => other_end(state, &moment, size),
        };
        let Some(camera) = camera else {
            let text = "Pick a node or a front segment to see it in its own metric.";
            let font = super::theme::regular(super::theme::TABLE);
            ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, text, font, ink(palette.weak));
            return;
        };
        let frame = Frame { camera, rect };
        self.update(state, &moment, palette, &frame);
        self.paint(ui, if lens == Lens::Metric { 1 } else { 2 }, &frame, palette);
        let which = if lens == Lens::Metric { labels::Which::Lens } else { labels::Which::Whole };
        labels::show(ui, &frame, state, &moment, palette, which);
    }

    fn hover(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        state: &mut State,
        moment: &Moment,
        frame: &Frame,
        commands: &mut Vec<Command>,
    ) {
        let pointer = response.hover_pos().filter(|_| !response.dragged());
        let hovered = pointer.and_then(|at| {
            let p = frame.plane(at)?;
            let project = |p: DVec2| frame.camera.project(p.extend(0.0), frame.size());
            pick::pick(&moment.mesh, p, frame.inside(at), &project, self.hint)
        });
        if let Some(Outlined::Element(e)) = hovered {
            self.hint = Some(e);
        }
        if (response.hovered() || response.dragged() || state.hover_from_view) && state.hovered != hovered {
            state.hovered = hovered;
            state.hover_from_view = hovered.is_some();
            state.over_epoch += 1;
        }
        if response.clicked() {
            commands.push(Command::Pick(hovered));
        }
        if response.double_clicked()
            && let Some(what) = hovered
        {
            commands.push(Command::Show(what));
        }
        if hovered.is_some() && response.hovered() {
            ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        }
    }

    /// Brings the scene up to date with the state.
    fn update(&mut self, state: &State, moment: &Moment, palette: &Palette, frame: &Frame) {
        let served = frame.camera.is_served_by(self.scene.anchor, frame.size());
        let wanted = Some((state.mesh_epoch, palette.dark));
        let main = state.camera == Some(frame.camera);
        if self.seen_mesh != wanted || (main && !served) {
            let anchor =
                if served && self.seen_mesh.is_some() || !main { self.scene.anchor } else { frame.camera.centre };
            let by = state.kept.colour_by;
            self.shading = Shading::of(&moment.mesh, by, &state.births(by, moment));
            let scene = Arc::make_mut(&mut self.scene);
            scene.set_mesh(&moment.mesh, anchor, &moment.changed, &self.shading, state.kept.layers, palette);
            self.seen_mesh = wanted;
            self.seen_over = None;
        }
        if self.seen_over != Some(state.over_epoch) {
            let background = state.opened.as_ref().filter(|_| state.kept.layers.background);
            let overlay = Overlay {
                mesh: &moment.mesh,
                front: &moment.front,
                changed: &moment.changed,
                decision: Decision::of(&moment.phase),
                refused: &refused(moment),
                picked: state.kept.picked,
                hovered: state.hovered,
                background: background.map(|opened| &opened.background.mesh),
            };
            Arc::make_mut(&mut self.scene).set_overlay(&overlay, state.kept.layers, palette);
            self.seen_over = Some(state.over_epoch);
        }
    }

    fn paint(&self, ui: &Ui, index: usize, frame: &Frame, palette: &Palette) {
        let view =
            View { camera: frame.camera, size: frame.size(), pixels: ui.pixels_per_point(), ground: palette.ground };
        let picture = Picture { scene: self.scene.clone(), view, index };
        ui.painter().add(Callback::new_paint_callback(frame.rect, picture));
    }
}

/// Edges that were there and are not the side, while one is chosen.
fn refused(moment: &Moment) -> Vec<[NodeId; 2]> {
    let (Some(tried), Some([a, b])) = (&moment.candidates, Decision::of(&moment.phase).base) else { return Vec::new() };
    let from = if tried.side == Side::Left { a } else { b };
    let edges = tried.edges.iter().filter(|edge| edge.swap.is_none() && edge.passed == Some(Passed::Farther));
    edges.map(|edge| [from, edge.node]).collect()
}

/// What screen readers hear of the view.
fn spoken(state: &State) -> String {
    match &state.moment {
        Some(moment) => format!("Mesh at step {}, {} quadrilaterals", moment.step, moment.standing),
        None => "No mesh".to_owned(),
    }
}

fn empty(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    if state.is_busy() {
        return;
    }
    let rect = Rect::from_center_size(ui.max_rect().center(), Vec2::new(420.0, 80.0));
    ui.scope_builder(egui::UiBuilder::new().max_rect(rect), |ui| {
        ui.vertical_centered(|ui| {
            ui.colored_label(ink(palette.weak), "No case is open. Drop a case or a mesh here, or");
            for command in [Command::Open(super::Source::BuiltIn("example1".into())), Command::OpenPath] {
                if ui.button(command.name()).clicked() {
                    commands.push(command);
                }
            }
        });
    });
}

/// A rectangle on whole pixels, so that the picture is laid down as it was drawn.
fn whole_pixels(rect: Rect, pixels: f32) -> Rect {
    let whole = |x: f32| (x * pixels).round() / pixels;
    Rect::from_min_max(
        egui::pos2(whole(rect.min.x), whole(rect.min.y)),
        egui::pos2(whole(rect.max.x).max(rect.min.x + 1.0), whole(rect.max.y).max(rect.min.y + 1.0)),
    )
}

/// The camera of the main view, after what was asked of it.
fn aim(state: &mut State, moment: &Moment, size: DVec2) -> Camera {
    let bounds = scene::bounds(&moment.mesh).unwrap_or([DVec2::ZERO, DVec2::ONE]);
    let fitted = Camera::fit(bounds, size, MARGIN);
    let mut camera = state.camera.unwrap_or(fitted);
    // A view that still shows the whole mesh goes on doing so when its size changes.
    if state.fitted && state.view_size != size {
        camera = fitted;
    }
    state.view_size = size;
    match state.look.take() {
        None => {}
        Some(Look::Fit) => (camera, state.fitted) = (fitted, true),
        Some(Look::Decision) => {
            if let Some([a, b]) = Decision::of(&moment.phase).base.or(state.picked_segment()) {
                near(&mut camera, moment, [a, b]);
                state.fitted = false;
            }
        }
        Some(Look::Kept(kept)) => {
            camera.take_up(&kept, size);
            state.fitted = false;
        }
        Some(Look::At(what)) => {
            if let Some(p) = middle(moment, what) {
                let scale = camera.scale;
                camera.look_at(p, scale);
                state.fitted = false;
            }
        }
    }
    if state.camera.is_some_and(|before| before != camera) && state.fitted && camera != fitted {
        state.fitted = false;
    }
    camera
}

fn near(camera: &mut Camera, moment: &Moment, [a, b]: [NodeId; 2]) {
    let mesh = &moment.mesh;
    if mesh.has_node(a) && mesh.has_node(b) {
        let (p, q) = (mesh.uv(a), mesh.uv(b));
        camera.look_at(0.5 * (p + q), DECISION / p.distance(q).max(f64::MIN_POSITIVE));
    }
}

/// The middle of something that is there.
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

/// Pan by dragging, zoom by the wheel or two fingers, turn by dragging with the second button.
fn steer(ui: &Ui, response: &egui::Response, camera: &mut Camera, rect: Rect) {
    let drag = response.drag_delta();
    let by = DVec2::new(f64::from(drag.x), f64::from(drag.y));
    if response.dragged_by(PointerButton::Primary) || response.dragged_by(PointerButton::Middle) {
        camera.pan(by);
    } else if response.dragged_by(PointerButton::Secondary) {
        camera.orbit(by);
    }
    let Some(at) = response.hover_pos() else { return };
    let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
    let factor = f64::from(pinch) * libm::exp(f64::from(scroll) * 0.004);
    if factor != 1.0 {
        let frame = Frame { camera: *camera, rect };
        camera.zoom(factor, frame.inside(at), frame.size());
    }
}

/// The node whose metric the lens shows, and the node that lies to its right: A and B of what is picked or of the decision.
pub fn lens_node(state: &State, moment: &Moment) -> Option<(NodeId, Option<NodeId>)> {
    let found = match (state.kept.picked, state.picked_segment().or(Decision::of(&moment.phase).base)) {
        (Some(Outlined::Node(node)), _) => (node, None),
        (_, Some([a, b])) => (a, Some(b)),
        _ => return None,
    };
    moment.mesh.has_node(found.0).then_some(found)
}

/// The metric of that node: its symmetric root, turned so that A to B runs right and the live side is up.
fn metric_lens(state: &State, moment: &Moment) -> Option<Camera> {
    let mesh = &moment.mesh;
    let (node, towards) = lens_node(state, moment)?;
    let root = mesh.metric(node).sqrt();
    let root = DMat2::from_cols(DVec2::new(root.uu, root.uv), DVec2::new(root.uv, root.vv));
    let towards = towards.filter(|b| mesh.has_node(*b));
    let along = towards.map(|b| (root * (mesh.uv(b) - mesh.uv(node))).normalize_or(DVec2::X));
    let turn = along.map_or(DMat2::IDENTITY, |d| DMat2::from_cols(DVec2::new(d.x, -d.y), DVec2::new(d.y, d.x)));
    let mut camera = Camera::through_lens(mesh.uv(node), turn * root, LENS);
    if along.is_some() {
        // The base runs right from A: what comes of it lies up and to the right.
        camera.pan(DVec2::new(-40.0, 60.0));
    }
    Some(camera)
}

/// The other end of the zoom: the whole mesh, or the decision where the main view shows the whole already.
fn other_end(state: &State, moment: &Moment, size: DVec2) -> Option<Camera> {
    let whole = Camera::fit(scene::bounds(&moment.mesh)?, size, 14.0);
    let decision = Decision::of(&moment.phase).base.or(state.picked_segment());
    let mut camera = whole;
    if let (true, Some(ends)) = (state.fitted, decision) {
        near(&mut camera, moment, ends);
        camera.scale *= 0.7;
    }
    Some(camera)
}

/// What egui's renderer is handed: the scene as it was when the frame was made.
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
