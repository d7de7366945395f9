//! Two runs in the main view: beside each other with one camera, or over each other with what differs outlined.

use eframe::egui::{self, Rect, Shape, Stroke, Ui, Vec2};
use glam::DVec3;

use super::{ViewFrame, Views, whole_pixels};
use crate::app::window::command::Command;
use crate::app::window::pair::{Arrangement, PairCommand, Which};
use crate::app::window::panels::two_runs;
use crate::app::window::state::{Pair, State, ViewCamera, ViewKind};
use crate::app::window::theme::ink;
use crate::core::mesh::{ElementId, Mesh};
use crate::core::run::compare::Overlap;
use crate::render::camera::Camera;
use crate::render::palette::{Palette, Rgba};

/// Height of the heading of a run in points.
const HEADING: f32 = 26.0;

/// The colours of what only one run has: cool for A, a warm neutral for B.
pub fn colours(palette: &Palette) -> [Rgba; 2] {
    [palette.front[1], palette.strong.mixed(palette.broken, 0.4)]
}

/// Shows both runs; `state` is the first one.
pub fn show(
    ui: &mut Ui,
    state: &State,
    pair: &Pair,
    views: &mut [Views; 2],
    commands: &mut Vec<Command>,
    palette: &'static Palette,
) {
    let rect = whole_pixels(ui.max_rect(), ui.pixels_per_point());
    let middle = whole_pixels(rect, 1.0).center().x;
    let (left, right) = rect.split_left_right_at_x(middle);
    let halves = [left, right.with_min_x(middle + 2.0)];
    ui.painter().vline(middle + 1.0, rect.y_range(), (2.0, ink(palette.line)));
    for (which, half) in Which::ALL.into_iter().zip(halves) {
        let heading = half.with_max_y(half.top() + HEADING);
        two_runs::view_heading(ui, heading, state, which, commands, palette);
    }
    match pair.arrangement {
        Arrangement::SideBySide => {
            for ((which, half), views) in Which::ALL.into_iter().zip(halves).zip(views) {
                view(ui, half.with_min_y(half.top() + HEADING), state, which, views, commands, palette);
            }
        }
        Arrangement::Over => {
            let below = rect.with_min_y(rect.top() + HEADING);
            let which = pair.active;
            let shown = view(ui, below, state, which, &mut views[which as usize], commands, palette);
            if let Some(overlap) = &pair.overlap {
                let camera = shown.or_else(|| camera_of(state.of(which)));
                outline(ui, below, state, overlap, camera, palette);
            }
            key(ui, below, palette);
        }
    }
}

/// The view of one run: the other one is not seen there. Returns its camera where that has just moved.
pub fn view(
    ui: &mut Ui,
    rect: Rect,
    state: &State,
    which: Which,
    views: &mut Views,
    commands: &mut Vec<Command>,
    palette: &'static Palette,
) -> Option<Camera> {
    let mut asked = Vec::new();
    ui.scope_builder(egui::UiBuilder::new().max_rect(rect).id_salt(which.name()), |ui| {
        views.space(ui, state.of(which), &mut asked, palette);
    });
    let moved = asked.iter().rev().find_map(|command| match command {
        Command::MoveCamera(ViewKind::Plane | ViewKind::Space, ViewCamera { camera, .. }) => *camera,
        _ => None,
    });
    commands.extend(asked.into_iter().map(|command| Command::Pair(PairCommand::In(which, Box::new(command)))));
    moved
}

fn camera_of(state: &State) -> Option<Camera> {
    if state.is_in_space() { state.view().space.camera } else { state.view().plane.camera }
}

/// Outlines what only one run has: solid for A, dashed for B.
fn outline(ui: &Ui, rect: Rect, state: &State, overlap: &Overlap, camera: Option<Camera>, palette: &Palette) {
    let Some(camera) = camera else { return };
    let (frame, painter) = (ViewFrame { camera, rect }, ui.painter_at(rect));
    let in_space = state.is_in_space();
    for ((which, only), colour) in Which::ALL.into_iter().zip(&overlap.only).zip(colours(palette)) {
        let Some(moment) = &state.of(which).run().moment else { continue };
        let stroke = Stroke::new(1.6, ink(colour));
        for &element in only.iter().filter(|e| moment.mesh.has_element(**e)) {
            let Some(corners) = corners(&moment.mesh, element, in_space.then_some(&camera)) else { continue };
            let mut line: Vec<egui::Pos2> = corners.iter().map(|p| frame.place(*p)).collect();
            if !Rect::from_points(&line).intersects(rect) {
                continue;
            }
            match which {
                Which::A => drop(painter.add(Shape::closed_line(line, stroke))),
                Which::B => {
                    line.push(line[0]);
                    painter.extend(Shape::dashed_line(&line, stroke, 4.0, 3.0));
                }
            }
        }
    }
}

/// The corners of an element in the view; `None` where it is turned away from the camera.
fn corners(mesh: &Mesh, element: ElementId, in_space: Option<&Camera>) -> Option<Vec<DVec3>> {
    let nodes: Vec<_> = mesh.corners(element).collect();
    match in_space {
        None => Some(nodes.iter().map(|n| mesh.uv(*n).extend(0.0)).collect()),
        Some(camera) => {
            let normal = nodes.iter().map(|n| mesh.normal(*n)).sum::<DVec3>();
            (normal.dot(camera.towards()) > 0.0).then(|| nodes.iter().map(|n| mesh.xyz(*n)).collect())
        }
    }
}

/// What the outlines mean.
fn key(ui: &Ui, rect: Rect, palette: &Palette) {
    let painter = ui.painter_at(rect);
    let mut at = rect.right_top() + Vec2::new(-118.0, 18.0);
    let plate = Rect::from_min_size(at - Vec2::new(8.0, 12.0), Vec2::new(118.0, 44.0));
    painter.rect_filled(plate, 3.0, ink(palette.label_plate));
    for (which, colour) in Which::ALL.into_iter().zip(colours(palette)) {
        let line = [at, at + Vec2::new(28.0, 0.0)];
        let stroke = Stroke::new(1.6, ink(colour));
        match which {
            Which::A => drop(painter.add(Shape::line_segment(line, stroke))),
            Which::B => painter.extend(Shape::dashed_line(&line, stroke, 4.0, 3.0)),
        }
        let font = crate::app::window::theme::regular(crate::app::window::theme::TABLE);
        let text = format!("only in {}", which.name());
        painter.text(at + Vec2::new(38.0, 0.0), egui::Align2::LEFT_CENTER, text, font, ink(palette.label));
        at.y += 20.0;
    }
}
