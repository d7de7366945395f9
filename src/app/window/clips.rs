//! Fewer calls for the graphics: each clip rectangle of egui costs one, and most of what is painted lies within its
//! own.

use eframe::egui::emath::TSTransform;
use eframe::egui::epaint::{ClippedShape, RectShape};
use eframe::egui::{Context, CornerRadius, FullOutput, Plugin, Rect, Shape};

/// How far soft edges reach out of a shape, in points.
const SOFT: f32 = 1.0;

/// egui draws rectangles that are thinner than this, in points, as lines.
const THIN: f32 = 2.5;

/// Takes the clip rectangle off everything that it does not cut, so that neighbours in the order of painting are drawn
/// together.
pub struct FewerClips;

impl Plugin for FewerClips {
    fn debug_name(&self) -> &'static str {
        "fewer clips"
    }

    fn output_hook(&mut self, _: &Context, output: &mut FullOutput) {
        let mut shapes = Vec::with_capacity(output.shapes.len());
        for shape in output.shapes.drain(..) {
            unclip(shape, &mut shapes);
        }
        output.shapes = shapes;
    }
}

/// Adds what can be seen of a shape.
fn unclip(clipped: ClippedShape, shapes: &mut Vec<ClippedShape>) {
    let ClippedShape { mut clip_rect, mut shape, transform_after_tessellation } = clipped;
    if transform_after_tessellation != TSTransform::IDENTITY || matches!(shape, Shape::Callback(_)) {
        shapes.push(ClippedShape { clip_rect, shape, transform_after_tessellation });
        return;
    }
    let reach = match &mut shape {
        Shape::Vec(parts) => {
            for shape in parts.drain(..) {
                unclip(ClippedShape { clip_rect, shape, transform_after_tessellation }, shapes);
            }
            return;
        }
        Shape::Rect(rect) if ends_at_pixels(rect) => {
            // Cut by the clip rectangle it is a rectangle again.
            let seen = rect.rect.intersect(clip_rect);
            if seen.size().min_elem() > THIN {
                rect.rect = seen;
            }
            rect.rect
        }
        Shape::Text(_) | Shape::Mesh(_) => shape.visual_bounding_rect(),
        _ => shape.visual_bounding_rect().expand(SOFT),
    };
    if !clip_rect.intersects(reach) || !reach.is_positive() {
        return;
    }
    if clip_rect.contains_rect(reach) {
        clip_rect = Rect::EVERYTHING;
    }
    shapes.push(ClippedShape { clip_rect, shape, transform_after_tessellation });
}

/// Whether a rectangle is plain, so that egui rounds it to pixels as it does a clip rectangle.
fn ends_at_pixels(shape: &RectShape) -> bool {
    shape.round_to_pixels != Some(false)
        && shape.corner_radius == CornerRadius::ZERO
        && shape.stroke.is_empty()
        && shape.blur_width == 0.0
        && shape.brush.is_none()
        && shape.angle == 0.0
        && shape.rect.size().min_elem() > THIN
}

#[cfg(test)]
mod tests {
    use eframe::egui::epaint::{ClippedPrimitive, Primitive, TessellationOptions, Tessellator};
    use eframe::egui::{Color32, Pos2, Rgba, Stroke, StrokeKind, Vec2, pos2};

    use super::*;

    fn rect(left: f32, top: f32, right: f32, bottom: f32) -> Rect {
        Rect::from_min_max(pos2(left, top), pos2(right, bottom))
    }

    fn unclipped(clip_rect: Rect, shape: impl Into<Shape>) -> Vec<ClippedShape> {
        let mut shapes = Vec::new();
        unclip(
            ClippedShape { clip_rect, shape: shape.into(), transform_after_tessellation: TSTransform::IDENTITY },
            &mut shapes,
        );
        shapes
    }

    #[test]
    fn only_what_a_clip_rectangle_cuts_keeps_it() {
        let clip = rect(0.0, 0.0, 100.0, 50.0);
        let disc = |x: f32| Shape::circle_filled(pos2(x, 20.0), 5.0, Color32::RED);
        let clips = |shape: Shape| unclipped(clip, shape).iter().map(|shape| shape.clip_rect).collect::<Vec<_>>();
        assert_eq!(clips(disc(50.0)), [Rect::EVERYTHING]);
        assert_eq!(clips(disc(5.5)), [clip], "its soft edge is cut");
        assert_eq!(clips(disc(98.0)), [clip]);
        assert!(clips(disc(120.0)).is_empty());
        assert_eq!(clips(Shape::Vec(vec![disc(50.0), disc(98.0), disc(-20.0)])), [Rect::EVERYTHING, clip]);
        let framed = RectShape::new(clip, 0.0, Color32::RED, Stroke::new(1.0, Color32::BLUE), StrokeKind::Middle);
        assert_eq!(clips(framed.into()), [clip]);
    }

    #[test]
    fn a_plain_rectangle_is_cut() {
        let clip = rect(0.0, 0.0, 100.0, 50.0);
        let filled = |rect: Rect| unclipped(clip, RectShape::filled(rect, 0.0, Color32::RED));
        for (whole, seen) in [
            (rect(-10.0, 10.0, 40.0, 20.0), rect(0.0, 10.0, 40.0, 20.0)),
            (rect(-10.0, -10.0, 140.0, 120.0), clip),
            (clip, clip),
        ] {
            let [shape] = &filled(whole)[..] else { panic!("{whole}") };
            assert_eq!((shape.clip_rect, shape.shape.visual_bounding_rect()), (Rect::EVERYTHING, seen));
        }
        // egui draws what is thin in another way.
        let thin = rect(98.0, 10.0, 120.0, 20.0);
        let [shape] = &filled(thin)[..] else { panic!() };
        assert_eq!((shape.clip_rect, shape.shape.visual_bounding_rect()), (clip, thin));
    }

    const SIZE: usize = 100;

    /// The colours at the middle of each pixel of a picture.
    fn painted(primitives: &[ClippedPrimitive]) -> Vec<Rgba> {
        let mut picture = vec![Rgba::BLACK; SIZE * SIZE];
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(mesh) = primitive else { panic!("only meshes") };
            for (k, pixel) in picture.iter_mut().enumerate() {
                let at = pos2((k % SIZE) as f32 + 0.5, (k / SIZE) as f32 + 0.5);
                for corners in mesh.indices.chunks(3).filter(|_| clip_rect.contains(at)) {
                    let [a, b, c] = [0, 1, 2].map(|k| mesh.vertices[corners[k] as usize]);
                    let twice = |p: Pos2, q: Pos2, r: Pos2| (q - p).x * (r - p).y - (q - p).y * (r - p).x;
                    let all = twice(a.pos, b.pos, c.pos);
                    let parts = [twice(at, b.pos, c.pos), twice(a.pos, at, c.pos), twice(a.pos, b.pos, at)];
                    let [u, v, w] = parts.map(|part| part / all);
                    if all != 0.0 && u.min(v).min(w) >= 0.0 {
                        let over = Rgba::from(a.color) * u + Rgba::from(b.color) * v + Rgba::from(c.color) * w;
                        *pixel = over + *pixel * (1.0 - over.a());
                    }
                }
            }
        }
        picture
    }

    #[test]
    fn what_is_seen_is_the_same_and_takes_fewer_meshes() {
        let (mut shapes, mut fewer) = (Vec::new(), Vec::new());
        for row in 0..8 {
            let clip_rect = Rect::from_min_size(pos2(10.0, 12.0 * row as f32), Vec2::new(80.0, 10.0));
            let at = |x: f32, y: f32| clip_rect.min + Vec2::new(x, y);
            for shape in [
                Shape::rect_filled(clip_rect.expand(3.0), 0.0, Color32::from_gray(20 * row)),
                Shape::line_segment([at(5.2, 2.3), at(60.4, 7.1)], (1.5, Color32::GREEN)),
                Shape::circle_filled(at(40.3, 4.8), 3.0, Color32::from_rgba_unmultiplied(0, 0, 255, 100)),
                // One of them is cut.
                Shape::circle_filled(at(if row == 3 { 78.2 } else { 70.2 }, 5.1), 3.5, Color32::YELLOW),
                Shape::rect_filled(Rect::from_min_max(at(20.0, 3.0), at(99.0, 6.0)), 0.0, Color32::BLUE),
            ] {
                let clipped = ClippedShape { clip_rect, shape, transform_after_tessellation: TSTransform::IDENTITY };
                unclip(clipped.clone(), &mut fewer);
                shapes.push(clipped);
            }
        }
        let meshes = |shapes| {
            let options = TessellationOptions { prerasterized_discs: false, ..TessellationOptions::default() };
            Tessellator::new(1.0, options, [1, 1], Vec::new()).tessellate_shapes(shapes)
        };
        let [before, after] = [shapes, fewer].map(meshes);
        assert_eq!((before.len(), after.len()), (8, 3));
        let differences = painted(&before)
            .into_iter()
            .zip(painted(&after))
            .filter(|(a, b)| a.to_array().iter().zip(b.to_array()).any(|(a, b)| (a - b).abs() > 0.01));
        assert_eq!(differences.count(), 0);
    }
}
