//! The views: the mesh in space, the same from the other end of the zoom, and through the metric of a node.

mod cameras;

use std::sync::Arc;

use eframe::egui::{self, PaintCallbackInfo, Rect, Role, Sense, Ui, Vec2, WidgetInfo};
use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, ScreenDescriptor};
use eframe::wgpu;
use glam::DVec2;

use cameras::{aim, metric_lens, other_end, steer};
pub use cameras::{lens_node, middle};

use super::command::Command;
use super::labels;
use super::panels::{self, inspector};
use super::session::Moment;
use super::state::State;
use super::theme::ink;
use crate::core::convert::candidates::Passed;
use crate::core::front::sector::Side;
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::run::history::Changes;
use crate::render::camera::Camera;
use crate::render::gpu::{Painter, View};
use crate::render::palette::{Palette, Rgba};
use crate::render::pick;
use crate::render::scene::{ColourBy, Decision, Drawn, Outlined, Overlay, Scene, Shading};

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
    seen_style: Option<(u64, bool)>,
    seen_over: Option<u64>,
    hint: Option<ElementId>,
    /// Labels of the views in the frame before.
    labels: [labels::Memory; 3],
    /// What the open menu is about.
    menu_of: Option<Outlined>,
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
    /// Whether a mesh has been shown.
    pub fn has_shown(&self) -> bool {
        self.seen_style.is_some()
    }

    /// The main view.
    pub fn space(&mut self, ui: &mut Ui, state: &mut State, commands: &mut Vec<Command>, palette: &'static Palette) {
        let rect = whole_pixels(ui.max_rect(), ui.pixels_per_point());
        let response = ui.interact(rect, ui.scope_id().with("space"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, spoken(state)));
        let Some(moment) = state.moment.clone() else {
            ui.painter().rect_filled(rect, 0.0, ink(palette.ground));
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
        labels::show(ui, &frame, state, &moment, palette, labels::Which::Main, &mut self.labels[0]);
        labels::shading(ui, &frame, &self.shading, palette);
    }

    /// Another view of the same scene.
    pub fn other(&mut self, ui: &mut Ui, state: &mut State, lens: Lens, palette: &'static Palette) {
        let rect = whole_pixels(ui.max_rect(), ui.pixels_per_point());
        let ground = |ui: &Ui| ui.painter().rect_filled(rect, 0.0, ink(palette.ground));
        let Some(moment) = state.moment.clone() else {
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
            let inner = Rect::from_center_size(rect.center(), Vec2::new((rect.width() - 40.0).max(1.0), 60.0));
            ui.scope_builder(egui::UiBuilder::new().max_rect(inner), |ui| {
                ui.vertical_centered(|ui| ui.add(egui::Label::new(panels::note(text, palette)).wrap()));
            });
            return;
        };
        let frame = Frame { camera, rect };
        self.update(state, &moment, palette, &frame);
        self.paint(ui, if lens == Lens::Metric { 1 } else { 2 }, &frame, palette);
        let (which, k) = if lens == Lens::Metric { (labels::Which::Lens, 1) } else { (labels::Which::Whole, 2) };
        labels::show(ui, &frame, state, &moment, palette, which, &mut self.labels[k]);
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
        if response.secondary_clicked() {
            self.menu_of = hovered;
        }
        if let Some(what) = self.menu_of {
            response.context_menu(|ui| {
                ui.label(super::words::thing(what));
                if ui.button("Select").clicked() {
                    commands.push(Command::Pick(Some(what)));
                    ui.close();
                }
                if ui.button(Command::Show(what).name()).clicked() {
                    commands.push(Command::Show(what));
                    ui.close();
                }
                inspector::past::actions(ui, state, what, commands);
            });
        }
        if hovered.is_some() && response.hovered() {
            ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
        }
    }

    /// Brings the scene up to date with the state: by what changed, where it is only that.
    fn update(&mut self, state: &mut State, moment: &Moment, palette: &Palette, frame: &Frame) {
        let served = frame.camera.is_served_by(self.scene.anchor, frame.size());
        let style = Some((state.style_epoch, palette.dark));
        let main = state.camera == Some(frame.camera);
        let again = self.seen_style != style || (main && !served);
        if again || !state.changes.is_nothing() {
            let by = state.kept.colour_by;
            let range = self.shading.range;
            if by != ColourBy::State || self.shading.by != by {
                self.shading = Shading::of(&moment.mesh, by, &state.births(by, moment));
            }
            let drawn = Drawn {
                mesh: &moment.mesh,
                changed: &moment.changed,
                shading: &self.shading,
                layers: state.kept.layers,
                palette,
            };
            let scene = Arc::make_mut(&mut self.scene);
            match state.changes.take() {
                Changes::Some { nodes, elements } if !again && self.shading.range == range => {
                    scene.patch_mesh(&drawn, &nodes, &elements);
                }
                _ => {
                    let keep = (served && self.seen_style.is_some()) || !main;
                    scene.set_mesh(&drawn, if keep { scene.anchor } else { frame.camera.centre });
                    self.seen_style = style;
                }
            }
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
                lit: &state.lit,
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
