//! Several faces in the plane: the active one is framed, the others are dimmed.

use eframe::egui::{Pos2, Shape, Stroke, Ui};
use glam::DVec2;

use super::{ViewFrame, middle};
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::theme::ink;
use crate::core::mesh::Mesh;
use crate::render::palette::Palette;
use crate::render::scene::{Decision, Outlined};

/// The least and greatest coordinates of each face in the plane; none if it has no nodes.
fn bounds(mesh: &Mesh) -> Vec<Option<[DVec2; 2]>> {
    let Some(embedding) = mesh.embedding() else { return Vec::new() };
    let mut bounds = vec![None; embedding.atlas.charts().len()];
    for p in mesh.nodes().map(|n| mesh.uv(n)) {
        if let Some(bounds) = bounds.get_mut(embedding.atlas.chart_of(p)) {
            let [low, high] = bounds.unwrap_or([p, p]);
            *bounds = Some([low.min(p), high.max(p)]);
        }
    }
    bounds
}

/// The face of the selection, or else of the decision.
fn active(state: &State, moment: &Moment) -> Option<usize> {
    let base = Decision::of(&moment.phase).base.map(Outlined::Edge);
    let place = state.document().picked.or(base).and_then(|what| middle(moment, what))?;
    Some(moment.mesh.embedding()?.atlas.chart_of(place))
}

/// Frames the active face and dims the others, if there are several.
pub(super) fn show(ui: &Ui, frame: &ViewFrame, state: &State, moment: &Moment, palette: &Palette) {
    let is_alone = moment.mesh.embedding().is_none_or(|embedding| embedding.atlas.charts().len() < 2);
    let Some(active) = active(state, moment).filter(|_| !is_alone) else { return };
    let painter = ui.painter_at(frame.rect);
    for (k, bounds) in bounds(&moment.mesh).into_iter().enumerate() {
        let Some([low, high]) = bounds else { continue };
        let room = DVec2::splat(0.02 * (high - low).max_element());
        let (low, high) = (low - room, high + room);
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        let corners: Vec<Pos2> = corners.map(|p| frame.place(p.extend(0.0))).to_vec();
        if k == active {
            painter.add(Shape::closed_line(corners, Stroke::new(1.25, ink(palette.selection.faded(0.7)))));
        } else {
            painter.add(Shape::convex_polygon(corners, ink(palette.ground.faded(0.6)), Stroke::NONE));
        }
    }
}
