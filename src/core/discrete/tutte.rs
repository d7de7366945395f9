//! Tutte's embedding of a disc of triangles: the border on a circle by arc length, every interior node at a weighted
//! mean of its neighbours (Tutte 1963) with mean-value weights (Floater 2003). Positive weights and a convex border
//! make it injective.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::planar_map::{is_positive, snapped};
use super::sparse::Means;
use crate::core::progress::Cancel;

/// Least weight relative to a node's largest, which bounds the influence of nearly degenerate triangles.
const LEAST_WEIGHT: f64 = 1e-4;

/// The nodes of a disc in the plane; the first `border` ones are on the border, anticlockwise. Coordinates are
/// multiples of `grid`. `None` if rounding inverts a triangle, or when cancelled.
pub fn map(xyz: &[DVec3], triangles: &[[u32; 3]], border: usize, grid: f64, cancel: &Cancel) -> Option<Vec<DVec2>> {
    let lengths: Vec<f64> = (0..border).map(|k| xyz[k].distance(xyz[(k + 1) % border])).collect();
    let around: f64 = lengths.iter().sum();
    if around.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) || border < 3 {
        return None;
    }
    // Bounds the shortest border segments from below.
    let least = 1e-3 * around / border as f64;
    let pieces: Vec<f64> = lengths.iter().map(|l| l.max(least)).collect();
    let all: f64 = pieces.iter().sum();
    let radius = around / TAU;
    let mut uv = Vec::with_capacity(xyz.len());
    let mut along = 0.0;
    for piece in &pieces {
        let (sin, cos) = libm::sincos(TAU * along / all);
        uv.push(DVec2::new(cos, sin) * radius);
        along += piece;
    }
    let inner = xyz.len() - border;
    if inner > 0 {
        let weights = weights(xyz, triangles, border);
        if cancel.is_asked() {
            return None;
        }
        let mut right = vec![DVec2::ZERO; inner];
        let mut rows = Vec::with_capacity(inner);
        for (i, row) in weights.iter().enumerate() {
            let sum: f64 = row.iter().map(|w| w.1).sum();
            let mut inside = Vec::with_capacity(row.len());
            for &(node, weight) in row {
                let weight = weight / sum;
                match (node as usize).checked_sub(border) {
                    Some(column) => inside.push((column as u32, weight)),
                    None => right[i] += weight * uv[node as usize] / radius,
                }
            }
            rows.push(inside);
        }
        let means = Means::new(rows.into_iter().take_while(|_| !cancel.is_asked()));
        if cancel.is_asked() {
            return None;
        }
        let solver = means.factored(&xyz[border..], &|| !cancel.is_asked())?;
        uv.extend(solver.solve(&right)?.into_iter().map(|p| p * radius));
    }
    uv.iter_mut().for_each(|p| *p = snapped(*p, grid));
    is_positive(triangles, &uv).then_some(uv)
}

/// For each interior node, its neighbours, ascending, with their mean-value weights: (tan(alpha/2) + tan(beta/2)) /
/// length, with the angles at the node on both sides of the edge.
fn weights(xyz: &[DVec3], triangles: &[[u32; 3]], border: usize) -> Vec<Vec<(u32, f64)>> {
    let mut weights: Vec<Vec<(u32, f64)>> = vec![Vec::with_capacity(8); xyz.len() - border];
    for t in triangles {
        for k in 0..3 {
            let [at, b, c] = [t[k], t[(k + 1) % 3], t[(k + 2) % 3]];
            let Some(row) = (at as usize).checked_sub(border) else { continue };
            let [to_b, to_c] = [b, c].map(|n| xyz[n as usize] - xyz[at as usize]);
            let (long_b, long_c) = (to_b.length(), to_c.length());
            let tangent = half_angle_tangent(to_b, to_c);
            for (node, long) in [(b, long_b), (c, long_c)] {
                let weight = tangent / long.max(f64::MIN_POSITIVE);
                weights[row].push((node, weight));
            }
        }
    }
    for row in &mut weights {
        row.sort_by_key(|w| w.0);
        row.dedup_by(|next, first| {
            let is_same = next.0 == first.0;
            first.1 += if is_same { next.1 } else { 0.0 };
            is_same
        });
        let greatest = row.iter().map(|w| w.1).filter(|w| w.is_finite()).fold(0.0, f64::max);
        for (_, weight) in row.iter_mut() {
            let bound = if weight.is_finite() { *weight } else { greatest };
            *weight = if greatest > 0.0 { bound.max(LEAST_WEIGHT * greatest) } else { 1.0 };
        }
    }
    weights
}

/// tan(angle / 2) without an angle: sin / (1 + cos).
fn half_angle_tangent(a: DVec3, b: DVec3) -> f64 {
    let sine = a.cross(b).length();
    let cosine = a.dot(b);
    sine / (a.length() * b.length() + cosine).max(1e-12 * sine).max(f64::MIN_POSITIVE)
}
