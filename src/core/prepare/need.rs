//! What a conversion will need, estimated from the metric on the first triangles, or from triangles that are given.

use glam::DVec2;

use crate::core::case::Parameters;
use crate::core::fault::{Fault, FaultKind};
use crate::core::mesh::TriangleSet;
use crate::core::metric::measure::triangle_area;
use crate::core::metric::{MetricSource, Sizing};
use crate::core::progress::{Need, Watch};

/// Places at which the metric is looked at, all over the triangles, and the most where it changes.
const PLACES: [usize; 2] = [2_000, 50_000];
/// A triangle is divided for the integral until its quarters together differ from it by at most this part.
const EXACT: f64 = 0.1;
/// How often a triangle is divided at most.
const DEEPEST: u32 = 12;
/// Triangles of a unit mesh for each quadrilateral that comes of them.
const TRIANGLES_PER_QUAD: f64 = 2.4;

/// Whether the sizes that a metric asks for on the triangles of the boundary are within `max_quads` and what the watch
/// allows, before any memory is spent on them. The estimate is rough, so that only what is beyond doubt is refused for
/// `max_quads`. The adaptation itself holds the bound.
///
/// # Errors
/// They ask for more, or the watch's own fault.
pub(super) fn allow_sizes(
    set: &TriangleSet,
    sizing: &Sizing,
    parameters: &Parameters,
    watch: &mut dyn Watch,
) -> Result<(), Fault> {
    let (quads, max_quads) = (metric_area(set, sizing), parameters.max_quads);
    if quads > 4.0 * max_quads as f64 {
        let fault = format!("The metric requires about {quads:.1e} quadrilaterals, but max_quads is {max_quads}");
        return Err(Fault::new(fault).of_kind(FaultKind::Limit).remedy("Increase the sizes or max_quads"));
    }
    // The adaptation makes no more than max_quads.
    watch.allow(&Need::of(quads.min(max_quads as f64), Some(parameters.size_scale)))
}

/// Whether the watch allows what so many given triangles need.
///
/// # Errors
/// The watch's own fault.
pub(super) fn allow_triangles(triangles: usize, watch: &mut dyn Watch) -> Result<(), Fault> {
    watch.allow(&Need::of(triangles as f64 / TRIANGLES_PER_QUAD, None))
}

/// The area of triangles in a metric: about the number of quadrilaterals that it asks for (docs/algorithm.md,
/// "Adaptation to the metric"). A place where the metric fails counts nothing: who comes there says so.
fn metric_area(set: &TriangleSet, sizing: &Sizing) -> f64 {
    let corners = |triangle: &[u32; 3]| triangle.map(|n| set.uv[n as usize]);
    let area = |[a, b, c]: [DVec2; 3]| 0.5 * (b - a).perp_dot(c - a).abs();
    let all: f64 = set.triangles.iter().map(|triangle| area(corners(triangle))).sum();
    let mut left = PLACES[1];
    let mut sum = 0.0;
    for triangle in &set.triangles {
        let p = corners(triangle);
        // Quarters of quarters, until there are as many places as the triangle's part of the whole asks for.
        let places = PLACES[0] as f64 * area(p) / all.max(f64::MIN_POSITIVE);
        let least = (libm::log2(places.max(1.0)) / 2.0).ceil() as u32;
        sum += integral(sizing, p, measured(sizing, p), least, DEEPEST, &mut left);
    }
    sum
}

/// The metric area of a triangle by its middle.
fn measured(sizing: &Sizing, [a, b, c]: [DVec2; 3]) -> f64 {
    sizing.metric((a + b + c) / 3.0).map_or(0.0, |metric| triangle_area(&metric, a, b, c))
}

/// The metric area of a triangle, which is `whole` by its middle: by its quarters, at least `least` times.
fn integral(sizing: &Sizing, [a, b, c]: [DVec2; 3], whole: f64, least: u32, most: u32, left: &mut usize) -> f64 {
    if most == 0 || *left < 4 {
        return whole;
    }
    *left -= 4;
    let [d, e, f] = [a.midpoint(b), b.midpoint(c), c.midpoint(a)];
    let quarters = [[a, d, f], [d, b, e], [f, e, c], [d, e, f]];
    let parts = quarters.map(|quarter| measured(sizing, quarter));
    let sum: f64 = parts.iter().sum();
    if least == 0 && (sum - whole).abs() <= EXACT * sum {
        return sum;
    }
    let deeper = quarters.into_iter().zip(parts);
    deeper.map(|(quarter, part)| integral(sizing, quarter, part, least.saturating_sub(1), most - 1, left)).sum()
}
