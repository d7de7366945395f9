//! Limits the chords of the curves of a domain.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::domain::Domain;
use super::domain_curve::CurveId;
use super::turning::{ShapeLimits, Turning};

impl Domain {
    /// Limits the chords of the curves for which `is_shape` holds, by index, except those whose number of segments is
    /// fixed.
    pub fn limit_chords(&mut self, limits: &ShapeLimits, is_shape: &dyn Fn(usize) -> bool) {
        for id in (0..self.curves.len() as u32).map(CurveId) {
            let curve = &self.curves[id.index()];
            if curve.first != id || curve.segments.is_some() || !is_shape(id.index()) {
                continue;
            }
            let in_space = |t: f64, uv: DVec2| match &self.spatial {
                Some(spatial) => spatial.curves[id.index()].point(t),
                None => uv.extend(0.0),
            };
            let points: Vec<(f64, DVec3)> = curve.fine.iter().map(|&(t, uv)| (t, in_space(t, uv))).collect();
            let turning = Turning::of(&points, curve.curve.corners(), self.is_closed(id), limits);
            self.curves[id.index()].turning = turning.map(Arc::new);
        }
    }
}
