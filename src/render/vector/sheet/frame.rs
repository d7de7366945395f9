//! The map from coordinates of the mesh to the page.

use glam::DVec2;

use super::{Sheet, Weights};
use crate::render::look::Layer;

/// Margin around the mesh on paper in points: half of the widest line, and a little more.
const MARGIN: f64 = 1.0;
/// The margin with labels beside the boundary.
const MARGIN_FOR_LABELS: f64 = 9.0;

/// A frame on the page, x to the right and y down, with the map of the mesh into it.
#[derive(Clone, Copy, Debug)]
pub struct PageFrame {
    /// The top left corner of the mesh, in its coordinates.
    corner: DVec2,
    /// That corner on the page.
    origin: DVec2,
    /// Points per unit of the mesh.
    pub scale: f64,
    /// The top left corner of the frame.
    pub left_top: DVec2,
    /// Its size.
    pub size: DVec2,
    /// How far lines and marks may reach beyond their points.
    reach: f64,
}

impl PageFrame {
    /// A frame at the top left of the page, with a box of the plane centred in it and scaled to fit.
    pub fn fit(bounds: Option<[DVec2; 2]>, width: f64, height: Option<f64>, sheet: &Sheet<'_>) -> PageFrame {
        let (look, Weights { line, text }) = (&sheet.look, sheet.weights);
        let [low, high] = bounds.unwrap_or([DVec2::ZERO, DVec2::ONE]);
        let size = high - low;
        let has_labels = [Layer::H, Layer::Angles].iter().any(|layer| look.layers.has(*layer));
        let margin = match look.part {
            Some(_) => 0.0,
            None if has_labels => (MARGIN_FOR_LABELS * text).max(MARGIN * line),
            None => MARGIN * line,
        };
        // Limit the magnification of a tall picture, and give one without size a scale.
        let span = size.x.max(size.y * 0.1);
        let mut scale = (width - 2.0 * margin).max(1.0) / if span > 0.0 { span } else { 1.0 };
        let height = height.unwrap_or(size.y * scale + 2.0 * margin).max(1.0);
        let inner = (height - 2.0 * margin).max(1.0);
        if size.y * scale > inner {
            scale = inner / size.y;
        }
        let page = DVec2::new(width, height);
        PageFrame {
            corner: DVec2::new(low.x, high.y),
            origin: 0.5 * (page - size * scale),
            scale,
            left_top: DVec2::ZERO,
            size: page,
            reach: 2.0 * line,
        }
    }

    /// The same frame elsewhere on the page.
    pub fn moved(&self, left_top: DVec2) -> PageFrame {
        PageFrame { origin: self.origin + left_top, left_top, ..*self }
    }

    /// The page position of a point of the mesh.
    pub fn place(&self, p: DVec2) -> DVec2 {
        self.origin + self.turned(p - self.corner)
    }

    /// The page direction of a direction in the mesh.
    pub fn turned(&self, d: DVec2) -> DVec2 {
        DVec2::new(d.x, -d.y) * self.scale
    }

    /// Whether a shape with these corners may overlap the frame.
    pub fn sees(&self, corners: &[DVec2]) -> bool {
        let placed = corners.iter().map(|p| self.place(*p));
        let [low, high] = placed.fold([DVec2::INFINITY, DVec2::NEG_INFINITY], |[a, b], p| [a.min(p), b.max(p)]);
        (high + self.reach).cmpge(self.left_top).all() && (low - self.reach).cmple(self.left_top + self.size).all()
    }

    /// Whether a box on the page lies inside the frame.
    pub fn holds(&self, [low, high]: [DVec2; 2]) -> bool {
        low.cmpge(self.left_top).all() && high.cmple(self.left_top + self.size).all()
    }
}
