//! Places of two meshes that count as one: the same for nodes, for quadrilaterals and for the front around a base.

use glam::DVec2;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use crate::core::kernel::Metric2;
use crate::core::mesh::{Mesh, NodeId};

/// How near a place of B must be to one of A to count as the same: a length in the metric at that of A, in which an
/// edge has length 1.
pub const NEAR: f64 = 0.1;

/// A place of A in the parametric plane, with its metric.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub at: DVec2,
    metric: Metric2,
}

impl Place {
    pub fn of(mesh: &Mesh, node: NodeId) -> Place {
        Place { at: mesh.uv(node), metric: mesh.metric(node) }
    }

    /// The square of the distance from here to a place of B.
    fn distance2(&self, to: DVec2) -> f64 {
        self.metric.norm2(to - self.at)
    }

    /// Whether a place of B is the same.
    pub fn is_at(&self, other: DVec2) -> bool {
        self.distance2(other) <= NEAR * NEAR
    }
}

/// Places of A, to be found by those of B. They have the numbers in which they were given.
pub(super) struct Places {
    /// Each in the box around all that is near it.
    tree: RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>,
    places: Vec<Place>,
}

impl Places {
    pub fn of(places: Vec<Place>) -> Places {
        let around = |(k, Place { at, metric }): (usize, &Place)| {
            let det = metric.det();
            let reach = NEAR * DVec2::new((metric.vv / det).sqrt(), (metric.uu / det).sqrt());
            GeomWithData::new(Rectangle::from_corners((*at - reach).to_array(), (*at + reach).to_array()), k)
        };
        Places { tree: RTree::bulk_load(places.iter().enumerate().map(around).collect()), places }
    }

    /// The numbers of the places that are the same as one of B, in no particular order.
    pub fn near(&self, other: DVec2) -> impl Iterator<Item = usize> + '_ {
        let found = self.tree.locate_in_envelope_intersecting(AABB::from_point(other.to_array()));
        found.map(|item| item.data).filter(move |k| self.places[*k].is_at(other))
    }

    /// The number of the nearest one of them; the lowest where several are as near.
    pub fn nearest(&self, other: DVec2) -> Option<usize> {
        let distance2 = |k: usize| self.places[k].distance2(other);
        self.near(other).min_by(|x, y| distance2(*x).total_cmp(&distance2(*y)).then(x.cmp(y)))
    }
}
