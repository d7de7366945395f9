//! Charts that the file brings itself: texture coordinates, where they lay a part of the surface into the plane one to
//! one and do not stretch it too much (docs/algorithm.md, "Charts of triangles").

use glam::{DVec2, DVec3};

use super::chart::{Chart, CutSurface, SurfacePart};
use super::edges::{Corner, Edges};
use super::planar_map::{StretchBound, is_embedded, is_positive, snapped, stretch};

/// A texture with more than 1 + 1/64 pieces per triangle is too fragmented to give charts.
const TRIANGLES_PER_PIECE: usize = 64;

impl Chart {
    /// Whether it has this number of border loops and the topology of a plane region.
    fn is_planar_with(&self, loops: usize) -> bool {
        let edges = Edges::of(&self.local).len();
        self.loops.len() == loops && loops > 0 && self.points.len() + self.local.len() + loops == edges + 2
    }
}

impl CutSurface<'_> {
    /// The charts of a part by its texture, cut at the texture's seams. `None` if a triangle has no texture
    /// coordinates, if there are too many pieces, if a piece is not injective or stretches beyond the bound, or if the
    /// texture cuts a disc, which can be mapped as a whole.
    pub fn textured(&self, part: &SurfacePart, bound: StretchBound) -> Option<Vec<Chart>> {
        let triangles = &part.triangles;
        if !triangles.iter().all(|&t| self.texture_of(t).is_some()) {
            return None;
        }
        let mut slits: Vec<Corner> =
            triangles.iter().flat_map(|&t| Self::sides(t)).filter(|&side| self.is_seam(side)).collect();
        slits.sort_unstable();
        let is_whole = slits.iter().all(|&side| self.neighbour(part, side).is_none());
        if !is_whole && self.nodes(part).is_planar_with(1) {
            return None;
        }
        let pieces = self.connected(&SurfacePart { triangles: triangles.clone(), slits });
        if pieces.len() > 1 + triangles.len() / TRIANGLES_PER_PIECE {
            return None;
        }
        pieces.iter().map(|piece| self.by_texture(piece, bound)).collect()
    }

    fn texture_of(&self, triangle: u32) -> Option<[DVec2; 3]> {
        *self.mesh.texture.get(triangle as usize)?
    }

    /// Whether a side is on a seam or the border of the texture.
    fn is_seam(&self, side: Corner) -> bool {
        let ends = |side: Corner| {
            let places = self.texture_of(side / 3)?;
            Some([places[side as usize % 3], places[(side as usize + 1) % 3]])
        };
        let beyond = self.beyond[side as usize].and_then(ends);
        !matches!((ends(side), beyond), (Some([a, b]), Some([c, d])) if a == d && b == c)
    }

    /// The chart of a piece without seams.
    fn by_texture(&self, piece: &SurfacePart, bound: StretchBound) -> Option<Chart> {
        let mut chart = self.nodes(piece);
        if !chart.is_planar_with(chart.loops.len()) {
            return None;
        }
        let mut uv = vec![DVec2::ZERO; chart.points.len()];
        for (&t, local) in chart.triangles.iter().zip(&chart.local) {
            let places = self.texture_of(t)?;
            (0..3).for_each(|k| uv[local[k] as usize] = places[k]);
        }
        // Scaled to the area in space, moved to the origin, and mirrored back: textures are often mirrored.
        let xyz: Vec<DVec3> = chart.points.iter().map(|&p| self.mesh.points[p as usize]).collect();
        let doubled = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| uv[k as usize]);
            (b - a).perp_dot(c - a)
        };
        let in_plane: f64 = chart.local.iter().map(doubled).sum();
        let in_space: f64 = chart.triangles.iter().map(|&t| self.mesh.area_vector(t as usize).length()).sum();
        let scale = (in_space / in_plane.abs()).sqrt();
        if !(scale.is_finite() && scale > 0.0) {
            return None;
        }
        let origin = uv.iter().fold(DVec2::INFINITY, |low, &p| low.min(p));
        let axes = DVec2::new(scale, scale * in_plane.signum());
        uv.iter_mut().for_each(|p| *p = snapped((*p - origin) * axes, self.grid));
        if !is_positive(&chart.local, &uv) || !is_embedded(&uv, &chart.loops) {
            return None;
        }
        chart.stretch = stretch(&xyz, &chart.local, &uv);
        chart.uv = uv;
        bound.allows(chart.stretch).then_some(chart)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::edges::Triangles;
    use crate::core::discrete::features::ANGLE;
    use crate::core::discrete::fixtures::{charted, plate, tube};

    fn found(mesh: &Triangles) -> Vec<Chart> {
        charted(mesh, ANGLE, StretchBound::default())
    }

    /// Sets the texture by a function of position and the triangle's centroid.
    fn lay(mesh: &mut Triangles, at: impl Fn(DVec3, DVec3) -> DVec2) {
        mesh.texture = (0..mesh.triangles.len())
            .map(|t| {
                let corners = mesh.corners(t);
                let middle = corners.iter().sum::<DVec3>() / 3.0;
                Some(corners.map(|p| at(p, middle)))
            })
            .collect();
    }

    /// Once around the tube, with a seam at angle 0.
    fn around(p: DVec3, middle: DVec3) -> DVec2 {
        let angle = |p: DVec3| libm::atan2(p.y, p.x).rem_euclid(std::f64::consts::TAU);
        let (own, near) = (angle(p), angle(middle));
        let turn = ((near - own) / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        DVec2::new(own + turn, p.z)
    }

    #[test]
    fn a_tube_is_unrolled_by_its_texture_mirrored_or_not() {
        for mirrored in [1.0, -1.0] {
            let mut mesh = tube(24, 10, 4.0);
            lay(&mut mesh, |p, middle| around(p, middle) * DVec2::new(0.1 * mirrored, 0.1));
            let charts = found(&mesh);
            assert_eq!((charts.len(), charts[0].loops.len()), (1, 1));
            // The points on the seam count twice.
            assert_eq!(charts[0].points.len(), mesh.points.len() + 11);
            let stretch = charts[0].stretch;
            assert!(stretch.shape < 1.01 && stretch.area < 1.01, "{stretch:?}");
            let width = charts[0].uv.iter().fold(0.0_f64, |wide, p| wide.max(p.x));
            assert!((width - std::f64::consts::TAU).abs() < 0.05, "{width}");
        }
    }

    #[test]
    fn a_folded_overlapping_stretched_or_fragmented_texture_is_not_used() {
        let own = found(&plate(8, 0.1));
        let textures: [&dyn Fn(DVec3, DVec3) -> DVec2; 4] = [
            // Folded along the middle.
            &|p, _| DVec2::new((p.x - 0.5).abs(), p.y),
            // Stretched.
            &|p, _| DVec2::new(p.x, 0.1 * p.y),
            // A spiral that runs over itself.
            &|p, _| {
                let (sin, cos) = libm::sincos(9.0 * p.x);
                DVec2::new(cos, sin) * (1.0 + 0.5 * p.y)
            },
            // Each triangle by itself.
            &|p, middle| p.truncate() + middle.truncate(),
        ];
        for texture in textures {
            let mut mesh = plate(8, 0.1);
            lay(&mut mesh, texture);
            assert_eq!(found(&mesh), own);
        }
        let mut mesh = plate(8, 0.1);
        lay(&mut mesh, |p, _| DVec2::new(p.y, 2.0 * p.x));
        assert_ne!(found(&mesh), own);
        mesh.texture[5] = None;
        assert_eq!(found(&mesh), own);
    }
}
