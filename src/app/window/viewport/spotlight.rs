//! A spotlight: all of a view but the quadrilateral at hand is dimmed, with a soft edge.

use eframe::egui::epaint::{Mesh, Vertex, WHITE_UV};
use eframe::egui::{Pos2, Rect, Shape, Ui, Vec2};

use super::ViewFrame;
use crate::app::window::theme::ink;
use crate::core::mesh::NodeId;
use crate::render::palette::Palette;
use crate::render::scene::{Decision, Scene};

/// How far from base, sides and top the light is full, and from where on it is dim, in points.
const FULL: f32 = 44.0;
const DIM: f32 = 150.0;
/// How much of the ground covers what is dim.
const SHARE: f32 = 0.72;
/// The distance of the places between which the light is interpolated.
const GRID: f32 = 14.0;

/// Dims a view, where there is a quadrilateral at hand.
pub(super) fn show(ui: &Ui, frame: &ViewFrame, scene: &Scene, decision: &Decision, palette: &Palette) {
    let place = |node: NodeId| scene.spot(node).map(|spot| frame.place(spot.at));
    let lit = lines(decision, place);
    if lit.is_empty() {
        return;
    }
    ui.painter_at(frame.rect).add(Shape::mesh(dimmed(frame.rect, &lit, palette)));
}

/// Base, sides and top on the screen, as far as they are known, and the diagonals: what is between them is lit as well.
fn lines(decision: &Decision, place: impl Fn(NodeId) -> Option<Pos2>) -> Vec<[Pos2; 2]> {
    let Some([a, b]) = decision.base else { return Vec::new() };
    let [c, d] = decision.tops;
    let ends = [(Some(a), Some(b)), (Some(a), c), (Some(b), d), (c, d), (Some(a), d), (Some(b), c)];
    let known = ends.into_iter().filter_map(|(from, to)| from.zip(to));
    known.filter_map(|(from, to)| place(from).zip(place(to))).map(|(p, q)| [p, q]).collect()
}

/// The dark over a rectangle, which leaves out what is lit.
fn dimmed(rect: Rect, lit: &[[Pos2; 2]], palette: &Palette) -> Mesh {
    let count = |length: f32| (length / GRID).ceil().max(1.0) as u32;
    let (columns, rows) = (count(rect.width()), count(rect.height()));
    let step = Vec2::new(rect.width() / columns as f32, rect.height() / rows as f32);
    let ground = ink(palette.ground);
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let pos = rect.min + Vec2::new(column as f32 * step.x, row as f32 * step.y);
            let color = ground.gamma_multiply(SHARE * darkness(pos, lit));
            mesh.vertices.push(Vertex { pos, uv: WHITE_UV, color });
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let first = row * (columns + 1) + column;
            mesh.add_triangle(first, first + 1, first + columns + 1);
            mesh.add_triangle(first + 1, first + columns + 2, first + columns + 1);
        }
    }
    mesh
}

/// How dark it is at a place: 0 near what is lit, 1 far from it.
fn darkness(at: Pos2, lit: &[[Pos2; 2]]) -> f32 {
    let distance = lit.iter().map(|line| distance(at, *line)).fold(f32::INFINITY, f32::min);
    let t = ((distance - FULL) / (DIM - FULL)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn distance(at: Pos2, [p, q]: [Pos2; 2]) -> f32 {
    let along = q - p;
    let share = (at - p).dot(along) / along.length_sq().max(f32::MIN_POSITIVE);
    at.distance(p + share.clamp(0.0, 1.0) * along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::palette::DARK;

    #[test]
    fn what_is_decided_is_lit_and_what_is_far_from_it_is_dim() {
        let at = |node: NodeId| {
            [(100.0, 200.0), (180.0, 200.0), (100.0, 120.0), (180.0, 120.0)]
                .get(node.0 as usize)
                .map(|&(x, y)| Pos2::new(x, y))
        };
        let [a, b, c, d] = [0, 1, 2, 3].map(NodeId);
        let base = Decision { base: Some([a, b]), tops: [None; 2] };
        assert_eq!(lines(&base, at), [[at(a).unwrap(), at(b).unwrap()]]);
        assert!(lines(&Decision::default(), at).is_empty());
        assert_eq!(lines(&Decision { base: Some([a, b]), tops: [Some(c), None] }, at).len(), 3);
        let whole = lines(&Decision { base: Some([a, b]), tops: [Some(c), Some(d)] }, at);
        assert_eq!(whole.len(), 6);
        for corner in [a, b, c, d] {
            assert_eq!(darkness(at(corner).unwrap(), &whole), 0.0);
        }
        assert_eq!(darkness(Pos2::new(140.0, 160.0), &whole), 0.0);
        assert_eq!(darkness(Pos2::new(500.0, 160.0), &whole), 1.0);
        let half = darkness(Pos2::new(180.0 + 0.5 * (FULL + DIM), 160.0), &whole);
        assert!((half - 0.5).abs() < 1e-6, "{half}");
        // The top is dim where only the base is known.
        assert!(darkness(at(c).unwrap(), &lines(&base, at)) > 0.0);
    }

    #[test]
    fn the_dark_covers_the_view_and_its_edge_is_soft() {
        let rect = Rect::from_min_size(Pos2::new(10.0, 20.0), Vec2::new(643.0, 401.0));
        let lit = [[Pos2::new(300.0, 200.0), Pos2::new(340.0, 200.0)]];
        let mesh = dimmed(rect, &lit, &DARK);
        assert!(mesh.is_valid());
        let bounds = mesh.calc_bounds();
        assert!(bounds.min.distance(rect.min) < 1e-3 && bounds.max.distance(rect.max) < 1e-3);
        let area = |t: &[u32]| {
            let [p, q, r] = [0, 1, 2].map(|k| mesh.vertices[t[k] as usize].pos);
            let (u, v) = (q - p, r - p);
            0.5 * f64::from((u.x * v.y - u.y * v.x).abs())
        };
        let covered: f64 = mesh.indices.chunks(3).map(area).sum();
        assert!((covered - f64::from(rect.area())).abs() < 1.0, "every point is covered once: {covered}");
        let alpha = |v: &Vertex| i32::from(v.color.a());
        assert_eq!(mesh.vertices.iter().map(alpha).min(), Some(0));
        assert!((mesh.vertices.iter().map(alpha).max().unwrap() - (SHARE * 255.0) as i32).abs() <= 2);
        // From one place to the next it changes by a fraction.
        let jump = mesh
            .indices
            .chunks(3)
            .map(|t| (alpha(&mesh.vertices[t[0] as usize]) - alpha(&mesh.vertices[t[1] as usize])).abs());
        assert!(jump.max().unwrap() < 60);
    }
}
