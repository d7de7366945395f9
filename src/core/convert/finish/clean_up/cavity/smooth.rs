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

/// Sweeps of every drawing, and one more for the root of the number of its quadrilaterals, up to a bound.
const SWEEPS: usize = 10;
const MOST_SWEEPS: usize = 60;
/// A sweep that moves no node by this share of the distance to a neighbour is the last one.
const SETTLED: f64 = 0.01;

/// The drawing of a filling.
#[derive(Clone, Debug, Default)]
pub(super) struct Draft {
    filled: Filled,
    /// The neighbours of each new node.
    neighbours: Vec<SmallVec<[u32; 6]>>,
    /// The metrics of all nodes.
    metrics: Vec<Metric2>,
}

impl Draft {
    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.filled.bytes()
            + size_of::<SmallVec<[u32; 6]>>() * self.neighbours.capacity()
            + size_of::<Metric2>() * self.metrics.capacity()
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
        self.smooth(first);
        let Filled { quads, places } = &self.filled;
        self.metrics.clear();
        self.metrics.extend(polygon.border.iter().map(|&n| mesh.metric(n)));
        for &place in &places[first..] {
            self.metrics.push(source.metric(place).ok()?);
        }
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

    /// Moves the new nodes to the middle of their neighbours, over and over, by successive over-relaxation.
    fn smooth(&mut self, first: usize) {
        let Filled { quads, places } = &mut self.filled;
        self.neighbours.clear();
        self.neighbours.resize(places.len() - first, SmallVec::new());
        for quad in quads.iter() {
            for k in 0..4 {
                // Each edge at an inner node starts there in one of its two quadrilaterals.
                if let Some(k_inner) = (quad[k] as usize).checked_sub(first) {
                    self.neighbours[k_inner].push(quad[(k + 1) % 4]);
                }
            }
        }
        let sweeps = (SWEEPS + quads.len().isqrt()).min(MOST_SWEEPS);
        let over = if quads.len() < 60 { 1.2 } else { 1.6 };
        for sweep in 1..=sweeps {
            let factor = if sweep + 3 > sweeps { 1.0 } else { over };
            let mut settled = true;
            for (k, around) in self.neighbours.iter().enumerate() {
                let middle = around.iter().map(|&n| places[n as usize]).sum::<DVec2>() / around.len() as f64;
                let place = places[first + k];
                let by = (middle - place) * factor;
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
