//! A field for boundary layers: small across named curves, growing with the distance from them.

use glam::{DVec2, DVec3};

use super::box_tree::{BoxTree, share_along};
use super::tensor::{LARGEST_ANISOTROPY, Metric3};
use crate::core::fault::Fault;

/// The size of a field that asks for nothing, as a multiple of the extent of its curves. It matters only where no other
/// field bounds the sizes.
const UNBOUNDED: f64 = 1e3;

/// The curves as segments and the sizes about them.
#[derive(Clone, Debug)]
pub(super) struct BoundaryLayer {
    tree: BoxTree,
    /// In the tree's order.
    segments: Vec<[DVec2; 2]>,
    /// Diagonal of the box about all curves.
    extent: f64,
    first: f64,
    /// Growth of the size with the distance.
    slope: f64,
    along: Option<f64>,
    far: f64,
}

impl BoundaryLayer {
    /// # Errors
    /// Sizes that are not positive and finite, a growth below 1, no curve, curves without length.
    pub fn new(
        polylines: &[Vec<DVec2>],
        first: f64,
        growth: f64,
        along: Option<f64>,
        far: Option<f64>,
    ) -> Result<BoundaryLayer, Fault> {
        for (name, size) in [("first", Some(first)), ("along", along), ("far", far)] {
            if let Some(size) = size
                && !(1e-60..=1e60).contains(&size)
            {
                return Err(Fault::new(format!("{name} = {size} is no size")).remedy("Give a positive finite number"));
            }
        }
        if !(growth >= 1.0 && growth.is_finite()) {
            return Err(Fault::new(format!("growth = {growth} is less than 1 or not finite"))
                .remedy("Give the ratio of a row's height to that of the row before, such as 1.2"));
        }
        if far.is_some_and(|far| far < first) {
            return Err(Fault::new("far is smaller than first")
                .remedy("far is the largest size that is asked for across the curves"));
        }
        if let Some(along) = along
            && (along > LARGEST_ANISOTROPY * first || first > LARGEST_ANISOTROPY * along)
        {
            return Err(Fault::new(format!(
                "first = {first} and along = {along} differ by a factor of more than {LARGEST_ANISOTROPY:e}"
            )));
        }
        let mut segments = Vec::new();
        for line in polylines {
            segments.extend(line.windows(2).map(|w| [w[0], w[1]]).filter(|[a, b]| a != b));
        }
        let boxes: Vec<_> = segments.iter().map(|[a, b]| (a.min(*b), a.max(*b))).collect();
        let (low, high) =
            boxes.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), b| (low.min(b.0), high.max(b.1)));
        let extent = (high - low).length();
        if !(extent > 0.0 && extent.is_finite()) {
            return Err(Fault::new("The curves of a boundary layer have no length"));
        }
        let (tree, order) = BoxTree::new(&boxes);
        let segments = order.into_iter().map(|i| segments[i as usize]).collect();
        let far = far.unwrap_or(UNBOUNDED * extent.max(first));
        Ok(BoundaryLayer { tree, segments, extent, first, slope: growth - 1.0, along, far })
    }

    /// Whether it gives a tensor of itself; if not, it only cuts back those of others.
    pub fn is_tensor(&self) -> bool {
        self.along.is_some()
    }

    /// The direction across the curves at `p` and the size along it; `None` when `p` is not finite.
    ///
    /// The size is `min(first + (growth - 1) distance, far)`: rows that each are `growth` times the one before lie at distances
    /// that make it so. The direction is the gradient of the distance; on a curve it is the normal of its segment.
    #[inline]
    fn across(&self, p: DVec2) -> Option<(DVec2, f64)> {
        let foot = |[a, b]: [DVec2; 2]| a.lerp(b, share_along(p, a, b));
        let (id, distance2) = self.tree.nearest(p, |id| foot(self.segments[id as usize]).distance_squared(p))?;
        let segment = self.segments[id as usize];
        let distance = distance2.sqrt();
        // Nearer than this the foot's rounding would turn the direction.
        let direction =
            if distance > 1e-9 * self.extent { p - foot(segment) } else { (segment[1] - segment[0]).perp() };
        Some((direction / direction.length(), (self.first + self.slope * distance).min(self.far)))
    }

    /// The field at `p` intersected with what other fields ask for there; `None` when `p` is not finite.
    #[inline]
    pub fn intersect(&self, others: Option<Metric3>, p: DVec2) -> Option<Metric3> {
        let (n, h) = self.across(p)?;
        let n = n.extend(0.0);
        let Some(along) = self.along else {
            // Alone, it must be bounded somehow, and no further than the tensor can hold.
            let others = others
                .unwrap_or_else(|| Metric3::isotropic((UNBOUNDED * self.extent).min(0.1 * LARGEST_ANISOTROPY * h)));
            return Some(others.intersect_slab(n, h));
        };
        let h = h.min(LARGEST_ANISOTROPY * along);
        let (across, along) = (1.0 / (h * h), 1.0 / (along * along));
        let m = Metric3::from_eigen([across, along, along], [n, n.truncate().perp().extend(0.0), DVec3::Z]);
        Some(others.map_or(m, |others| Metric3::intersect(&others, &m)))
    }
}
