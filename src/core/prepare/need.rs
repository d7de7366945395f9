//! What a conversion will need, estimated from the metric on the first triangles, or from triangles that are given.

use glam::DVec2;

use crate::core::case::Parameters;
use crate::core::fault::{Fault, FaultKind};
use crate::core::mesh::TriangleSet;
use crate::core::metric::measure::triangle_area;
use crate::core::metric::{MetricSource, Sizing};
use crate::core::progress::{Need, Watch};

/// Parts, all about as large, into which the triangles are divided first.
const PARTS: usize = 1_000;
/// Parts that are divided again are those that differ from their halves most, until all together differ by this part of
/// the whole.
const EXACT: f64 = 0.1;
/// How often a part is halved at most, and how many are.
const HALVED: [usize; 2] = [40, 10_000];
/// Triangles of a unit mesh for each quadrilateral that comes of them.
const TRIANGLES_PER_QUAD: f64 = 2.4;

/// Whether the sizes that a metric asks for on the triangles of the boundary, of which the mesh has so many copies, are
/// within `max_quads` and what the watch allows, before any memory is spent on them. The estimate is rough, so that
/// only what is beyond doubt is refused for `max_quads`. The adaptation itself holds the bound.
///
/// # Errors
/// They ask for more, or the watch's own fault.
pub(super) fn allow_sizes(
    set: &TriangleSet,
    sizing: &Sizing,
    parameters: &Parameters,
    copies: u32,
    watch: &mut dyn Watch,
) -> Result<(), Fault> {
    let (quads, max_quads) = (f64::from(copies) * metric_area(set, sizing), parameters.max_quads);
    if quads > 4.0 * max_quads as f64 {
        let fault = format!("The metric requires about {quads:.1e} quadrilaterals, but max_quads is {max_quads}");
        return Err(Fault::new(fault).of_kind(FaultKind::Limit).remedy("Increase the sizes or max_quads"));
    }
    // The adaptation makes no more than max_quads.
    allow(Need::of(quads.min(max_quads as f64), Some(parameters.size_scale)), watch)
}

/// Whether the watch allows what so many given triangles need.
///
/// # Errors
/// The watch's own fault.
pub(super) fn allow_triangles(triangles: usize, watch: &mut dyn Watch) -> Result<(), Fault> {
    allow(Need::of(triangles as f64 / TRIANGLES_PER_QUAD, None), watch)
}

fn allow(need: Need, watch: &mut dyn Watch) -> Result<(), Fault> {
    watch.allow(&need).map_err(|fault| fault.of_kind(FaultKind::Limit))
}

/// The area of triangles in a metric: about the number of quadrilaterals that it asks for (docs/algorithm.md,
/// "Adaptation to the metric"). A place where the metric fails counts nothing: who comes there says so.
fn metric_area(set: &TriangleSet, sizing: &Sizing) -> f64 {
    let of = |triangle: &[u32; 3]| Part::of(sizing, triangle.map(|n| set.uv[n as usize]));
    let mut large: Vec<Part> = set.triangles.iter().map(of).collect();
    let most = large.iter().map(Part::area).sum::<f64>() / PARTS as f64;
    // No part becomes smaller than half of that, so that this count suffices.
    let enough = large.len() + 2 * PARTS;
    let mut parts = Vec::new();
    while let Some(part) = large.pop() {
        let halves = part.halves(sizing);
        if part.area() > most && parts.len() + large.len() < enough {
            large.extend(halves);
        } else {
            parts.push((part, halves));
        }
    }
    let area = |halves: &[Part; 2]| halves[0].quads + halves[1].quads;
    let mut left = HALVED[1];
    for _ in 0..HALVED[0] {
        let sum: f64 = parts.iter().map(|(_, halves)| area(halves)).sum();
        let (exact, before) = (EXACT * sum / parts.len() as f64, left);
        let mut finer = Vec::with_capacity(2 * parts.len());
        for (part, halves) in parts {
            if left > 0 && (area(&halves) - part.quads).abs() > exact {
                left -= 1;
                finer.extend(halves.map(|half| (half, half.halves(sizing))));
            } else {
                finer.push((part, halves));
            }
        }
        parts = finer;
        if left == 0 || left == before {
            break;
        }
    }
    parts.iter().map(|(_, halves)| area(halves)).sum()
}

/// A part of a triangle.
#[derive(Clone, Copy)]
struct Part {
    /// Its corners; the side between the first two is the longest in the metric, or where that fails the oldest.
    corners: [DVec2; 3],
    /// Its area in the metric at its middle.
    quads: f64,
}

impl Part {
    fn of(sizing: &Sizing, corners: [DVec2; 3]) -> Part {
        let [a, b, c] = corners;
        let Ok(metric) = sizing.metric((a + b + c) / 3.0) else { return Part { corners, quads: 0.0 } };
        let turned = [[a, b, c], [b, c, a], [c, a, b]];
        let side = |[from, to, _]: &[DVec2; 3]| metric.norm2(*to - *from);
        let corners = turned.into_iter().max_by(|a, b| side(a).total_cmp(&side(b))).unwrap_or(corners);
        Part { corners, quads: triangle_area(&metric, a, b, c) }
    }

    /// Its area in the plane.
    fn area(&self) -> f64 {
        let [a, b, c] = self.corners;
        0.5 * (b - a).perp_dot(c - a).abs()
    }

    /// Its halves, on both sides of the line from the middle of the longest side.
    fn halves(&self, sizing: &Sizing) -> [Part; 2] {
        let [a, b, c] = self.corners;
        let middle = a.midpoint(b);
        [[c, a, middle], [b, c, middle]].map(|half| Part::of(sizing, half))
    }
}
