//! A filling drawn: its quadrilaterals and the places of its nodes, smoothed on its own, outside of the mesh.

use glam::DVec2;
use smallvec::SmallVec;

use super::disc::{Disc, Polygon};
use super::filled::{Filled, fill};
use super::filling::Filling;
use crate::core::convert::relax::energy::{self, Judged};
use crate::core::kernel::Metric2;
use crate::core::kernel::predicates::convex;
use crate::core::mesh::{ElementId, Mesh, NodeId};
use crate::core::metric::MetricSource;

/// Sweeps of every smoothing, and one more for the root of the number of its quadrilaterals, up to a bound.
const SWEEPS: usize = 10;
const MOST_SWEEPS: usize = 60;
/// A sweep that moves no node by this share of the distance to a neighbour is the last one.
const SETTLED: f64 = 0.01;
/// Smoothings at the most: the nodes move, and with them the metric by which they were smoothed.
const MOST_SMOOTHINGS: usize = 4;
/// Shapes of the metric that differ by less are taken for the same: r + 1/r - 2, where the aspect ratio changes by the
/// factor r.
const LARGEST_CHANGE: f64 = 0.02;
/// A drawing is given up after its first smoothing if more quadrilaterals than this are not convex, and more than one
/// in twenty: few of those come right.
const MOST_FOLDED: usize = 2;

/// What is known of the shapes of the metric.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shapes {
    /// They are about the same all along the border.
    Equal,
    /// Those of the border are known, those inside between them.
    Guessed,
    /// They were measured.
    Measured,
}

/// The drawing of a filling.
#[derive(Clone, Debug, Default)]
pub(super) struct Draft {
    filled: Filled,
    /// The neighbours of each new node.
    neighbours: Vec<SmallVec<[u32; 6]>>,
    /// The metrics of all nodes.
    metrics: Vec<Metric2>,
    /// Their shapes: the metrics with the determinant 1.
    shapes: Vec<Metric2>,
}

impl Draft {
    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.filled.bytes()
            + size_of::<SmallVec<[u32; 6]>>() * self.neighbours.capacity()
            + size_of::<Metric2>() * (self.metrics.capacity() + self.shapes.capacity())
    }

    /// Draws a filling of a polygon and judges it. None where a quadrilateral is not strictly convex, or a node has no
    /// metric.
    pub fn draw(
        &mut self,
        mesh: &Mesh,
        source: &dyn MetricSource,
        polygon: &Polygon,
        filling: &Filling,
    ) -> Option<Judged> {
        let first = polygon.border.len();
        fill(filling, &polygon.sides, polygon.border.iter().map(|&n| mesh.uv(n)), &mut self.filled);
        self.gather_neighbours(first);
        self.metrics.clear();
        self.metrics.extend(polygon.border.iter().map(|&n| mesh.metric(n)));
        self.metrics.resize(self.filled.places.len(), Metric2::isotropic(1.0));
        let mut shapes = self.guess_shapes(first);
        for smoothing in 1..=MOST_SMOOTHINGS {
            self.smooth(first, shapes);
            if smoothing == 1 && self.folded() > MOST_FOLDED.max(self.filled.quads.len() / 20) {
                return None;
            }
            if self.measure(first, source)? < LARGEST_CHANGE {
                break;
            }
            shapes = Shapes::Measured;
        }
        let Filled { quads, places } = &self.filled;
        let mut judged = Judged::NOTHING;
        for quad in quads {
            let p = quad.map(|n| places[n as usize]);
            if !convex(p[0], p[1], p[2], p[3]) {
                return None;
            }
            judged += energy::judge_corners(p, quad.map(|n| &self.metrics[n as usize]));
        }
        Some(judged)
    }

    /// Gathers the neighbours of the new nodes.
    fn gather_neighbours(&mut self, first: usize) {
        let Filled { quads, places } = &self.filled;
        self.neighbours.clear();
        self.neighbours.resize(places.len() - first, SmallVec::new());
        for quad in quads {
            for k in 0..4 {
                // Each edge at an inner node starts there in one of its two quadrilaterals.
                if let Some(k_inner) = (quad[k] as usize).checked_sub(first) {
                    self.neighbours[k_inner].push(quad[(k + 1) % 4]);
                }
            }
        }
    }

    /// Guesses the shapes of the metric: at the new nodes, whose places are too crude yet to ask for the metric, the
    /// mean of the border.
    fn guess_shapes(&mut self, first: usize) -> Shapes {
        self.shapes.clear();
        self.shapes.extend(self.metrics[..first].iter().map(shape));
        let zero = Metric2 { uu: 0.0, uv: 0.0, vv: 0.0 };
        let mean = shape(&self.shapes.iter().fold(zero, |sum, m| plus(&sum, m)));
        let equal = self.shapes.iter().all(|m| change(m, &mean) < LARGEST_CHANGE);
        self.shapes.resize(self.filled.places.len(), mean);
        if equal { Shapes::Equal } else { Shapes::Guessed }
    }

    /// Asks for the metric at the new nodes. Returns the largest change of its shape; none where a node has no metric.
    fn measure(&mut self, first: usize, source: &dyn MetricSource) -> Option<f64> {
        let mut largest = 0.0f64;
        for k in first..self.metrics.len() {
            let place = self.filled.places[k];
            self.metrics[k] = place.is_finite().then(|| source.metric(place))?.ok()?;
            let (old, new) = (self.shapes[k], shape(&self.metrics[k]));
            largest = largest.max(change(&old, &new));
            self.shapes[k] = new;
        }
        Some(largest)
    }

    /// How many quadrilaterals are not convex.
    fn folded(&self) -> usize {
        let is_convex = |quad: &&[u32; 4]| {
            let p = quad.map(|n| self.filled.places[n as usize]);
            (0..4).all(|k| (p[(k + 1) % 4] - p[k]).perp_dot(p[(k + 3) % 4] - p[k]) > 0.0)
        };
        self.filled.quads.len() - self.filled.quads.iter().filter(is_convex).count()
    }

    /// Moves the new nodes to the middle of their neighbours, over and over, by successive over-relaxation. An edge has
    /// the weight M / sqrt(det M): the map is harmonic in the metric M.
    fn smooth(&mut self, first: usize, shapes: Shapes) {
        let Filled { quads, places } = &mut self.filled;
        let sweeps = (SWEEPS + quads.len().isqrt()).min(MOST_SWEEPS);
        let over = if quads.len() < 60 { 1.2 } else { 1.6 };
        for sweep in 1..=sweeps {
            let factor = if sweep + 3 > sweeps { 1.0 } else { over };
            let mut settled = true;
            for (k, around) in self.neighbours.iter().enumerate() {
                let place = places[first + k];
                let by = if shapes == Shapes::Equal {
                    // All weigh the same.
                    around.iter().map(|&n| places[n as usize]).sum::<DVec2>() / around.len() as f64 - place
                } else {
                    let own = self.shapes[first + k];
                    let (mut sum, mut weight) = (DVec2::ZERO, Metric2 { uu: 0.0, uv: 0.0, vv: 0.0 });
                    for &n in around {
                        let w = plus(&own, &self.shapes[n as usize]);
                        sum += w.times(places[n as usize] - place);
                        weight = plus(&weight, &w);
                    }
                    if shapes == Shapes::Guessed {
                        // The shape is the middle of those around as well.
                        self.shapes[first + k] = shape(&plus(&weight, &times(&own, -(around.len() as f64))));
                    }
                    // Cramer's rule.
                    DVec2::new(weight.vv * sum.x - weight.uv * sum.y, weight.uu * sum.y - weight.uv * sum.x)
                        / weight.det()
                };
                let by = by * factor;
                let edge = places[around[0] as usize] - place;
                settled &= by.length_squared() < SETTLED * SETTLED * edge.length_squared();
                places[first + k] = place + by;
            }
            if settled {
                break;
            }
        }
    }

    /// Puts the drawing into the mesh in place of the disc; returns the new nodes and elements. None where that is
    /// refused.
    pub fn place(&self, mesh: &mut Mesh, disc: &Disc) -> Option<(Vec<NodeId>, Vec<ElementId>)> {
        let border = &disc.polygon.border;
        let first = border.len();
        let new: Vec<(DVec2, Metric2)> =
            self.filled.places[first..].iter().copied().zip(self.metrics[first..].iter().copied()).collect();
        mesh.refill(&disc.elements, &disc.inner, border, &new, &self.filled.quads).ok()
    }
}

fn plus(a: &Metric2, b: &Metric2) -> Metric2 {
    Metric2 { uu: a.uu + b.uu, uv: a.uv + b.uv, vv: a.vv + b.vv }
}

fn times(m: &Metric2, by: f64) -> Metric2 {
    Metric2 { uu: m.uu * by, uv: m.uv * by, vv: m.vv * by }
}

/// r + 1/r - 2, where the aspect ratio of a shape changes by the factor r.
fn change(old: &Metric2, new: &Metric2) -> f64 {
    old.uu * new.vv - 2.0 * old.uv * new.uv + old.vv * new.uu - 2.0
}

/// The metric with the determinant 1.
fn shape(m: &Metric2) -> Metric2 {
    times(m, 1.0 / m.det().sqrt())
}
