//! Fields by the distance from named curves: boundary layers, with small sizes across the curves, and isotropic sizes
//! that grow with the distance.

use glam::{DVec2, DVec3};

use crate::core::fault::Fault;
use crate::core::geometry::Line;
use crate::core::kernel::Metric3;
use crate::core::kernel::box_tree::{BoxTree, Spot, extent, share_along};
use crate::core::kernel::tensor::LARGEST_ANISOTROPY;

/// The size where a field sets no limit, as a multiple of the extent of its curves. It matters only if no other field
/// bounds the sizes.
const UNBOUNDED: f64 = 1e3;

/// Closer to a curve than this fraction of its extent, the direction towards it is lost in rounding errors.
const ON_CURVE: f64 = 1e-9;

/// Segments of curves, with a search for the nearest.
#[derive(Clone, Debug)]
struct Near<P> {
    tree: BoxTree<P>,
    /// In the order of the tree.
    segments: Vec<[P; 2]>,
    /// The diagonal of the bounding box of all curves.
    extent: f64,
}

impl<P: Spot> Near<P> {
    fn new(lines: &[Vec<P>]) -> Result<Near<P>, Fault> {
        let mut segments = Vec::new();
        for line in lines {
            segments.extend(line.windows(2).map(|w| [w[0], w[1]]).filter(|[a, b]| a != b));
        }
        let boxes: Vec<_> = segments.iter().map(|[a, b]| (a.least(*b), a.greatest(*b))).collect();
        let (low, high) = extent(segments.iter().flatten().copied());
        let extent = (high - low).inner(high - low).sqrt();
        if !(extent > 0.0 && extent.is_finite()) {
            return Err(Fault::new("The curves have zero length"));
        }
        let (tree, order) = BoxTree::new(&boxes);
        let segments = order.into_iter().map(|i| segments[i as usize]).collect();
        Ok(Near { tree, segments, extent })
    }

    /// The nearest segment, its nearest point, and the distance; `None` when `p` is not finite.
    #[inline]
    fn find(&self, p: P) -> Option<([P; 2], P, f64)> {
        let foot = |[a, b]: [P; 2]| a.between(b, share_along(p, a, b));
        let (id, distance2) = self.tree.nearest(p, |id| foot(self.segments[id as usize]).distance2(p))?;
        let segment = self.segments[id as usize];
        Some((segment, foot(segment), distance2.sqrt()))
    }
}

/// Curves in the plane or in space.
#[derive(Clone, Debug)]
enum Curves {
    Plane(Near<DVec2>),
    Space(Near<DVec3>),
}

impl Curves {
    fn new(lines: &[Line]) -> Result<Curves, Fault> {
        let plane: Option<Vec<Vec<DVec2>>> =
            lines.iter().map(|line| if let Line::Plane(points) = line { Some(points.clone()) } else { None }).collect();
        match plane {
            Some(lines) => Near::new(&lines).map(Curves::Plane),
            None => Near::new(&lines.iter().map(Line::in_space).collect::<Vec<_>>()).map(Curves::Space),
        }
    }

    fn extent(&self) -> f64 {
        match self {
            Curves::Plane(near) => near.extent,
            Curves::Space(near) => near.extent,
        }
    }

    /// The distance of a point; `None` when it is not finite.
    #[inline]
    fn distance(&self, uv: DVec2, xyz: DVec3) -> Option<f64> {
        Some(match self {
            Curves::Plane(near) => near.find(uv)?.2,
            Curves::Space(near) => near.find(xyz)?.2,
        })
    }
}

/// Refuses sizes outside 1e-60 to 1e60.
pub(super) fn check_named_sizes(sizes: &[(&str, Option<f64>)]) -> Result<(), Fault> {
    for (name, size) in sizes {
        if let Some(size) = size
            && !(1e-60..=1e60).contains(size)
        {
            return Err(
                Fault::new(format!("{name} = {size} is not a valid size")).remedy("Give a positive finite number")
            );
        }
    }
    Ok(())
}

fn check_growth(growth: f64) -> Result<(), Fault> {
    if growth >= 1.0 && growth.is_finite() {
        return Ok(());
    }
    Err(Fault::new(format!("growth = {growth} is less than 1 or not finite"))
        .remedy("Give the height ratio of successive rows, such as 1.2"))
}

/// An isotropic size that grows with the distance from curves.
#[derive(Clone, Debug)]
pub(super) struct Distance {
    curves: Curves,
    first: f64,
    /// Derivative of the size by the distance.
    slope: f64,
    far: f64,
}

impl Distance {
    /// # Errors
    /// Sizes that are not positive and finite, a growth below 1, curves of zero length.
    pub fn new(lines: &[Line], first: f64, growth: f64, far: f64) -> Result<Distance, Fault> {
        check_named_sizes(&[("first", Some(first)), ("far", Some(far))])?;
        check_growth(growth)?;
        if far < first {
            return Err(Fault::new("far is smaller than first").remedy("far is the largest size of this field"));
        }
        Ok(Distance { curves: Curves::new(lines)?, first, slope: growth - 1.0, far })
    }

    /// The metric at a point; `None` when the point is not finite.
    #[inline]
    pub fn metric(&self, uv: DVec2, xyz: DVec3) -> Option<Metric3> {
        let distance = self.curves.distance(uv, xyz)?;
        Some(Metric3::isotropic((self.first + self.slope * distance).min(self.far)))
    }
}

/// Small sizes across curves, growing with the distance.
#[derive(Clone, Debug)]
pub(super) struct BoundaryLayer {
    curves: Curves,
    first: f64,
    /// Derivative of the size by the distance.
    slope: f64,
    along: Option<f64>,
    far: f64,
}

impl BoundaryLayer {
    /// # Errors
    /// Sizes that are not positive and finite, a growth below 1, no curves, curves of zero length.
    pub fn new(
        lines: &[Line],
        first: f64,
        growth: f64,
        along: Option<f64>,
        far: Option<f64>,
    ) -> Result<BoundaryLayer, Fault> {
        check_named_sizes(&[("first", Some(first)), ("along", along), ("far", far)])?;
        check_growth(growth)?;
        if far.is_some_and(|far| far < first) {
            return Err(Fault::new("far is smaller than first")
                .remedy("far is the largest size of this field across the curves"));
        }
        if let Some(along) = along
            && (along > LARGEST_ANISOTROPY * first || first > LARGEST_ANISOTROPY * along)
        {
            return Err(Fault::new(format!(
                "first = {first} and along = {along} differ by a factor of more than {LARGEST_ANISOTROPY:e}"
            )));
        }
        let curves = Curves::new(lines)?;
        let far = far.unwrap_or(UNBOUNDED * curves.extent().max(first));
        Ok(BoundaryLayer { curves, first, slope: growth - 1.0, along, far })
    }

    /// Whether it defines a tensor by itself; if not, it only limits the tensors of other fields.
    pub fn is_tensor(&self) -> bool {
        self.along.is_some()
    }

    /// A unit vector across the curves and the size along it; `None` when the point is not finite. On a curve in space,
    /// the size holds in all directions across it, and the second value is the direction of the curve.
    ///
    /// The size is `min(first + (growth - 1) distance, far)`, which is the height of the row at that distance if each
    /// row is `growth` times as high as the one before. The direction is the gradient of the distance; on a curve of
    /// the plane it is the normal of its segment.
    #[inline]
    fn across(&self, uv: DVec2, xyz: DVec3) -> Option<(DVec3, Option<DVec3>, f64)> {
        let size = |distance: f64| (self.first + self.slope * distance).min(self.far);
        match &self.curves {
            Curves::Plane(near) => {
                let (segment, foot, distance) = near.find(uv)?;
                let direction =
                    if distance > ON_CURVE * near.extent { uv - foot } else { (segment[1] - segment[0]).perp() };
                Some(((direction / direction.length()).extend(0.0), None, size(distance)))
            }
            Curves::Space(near) => {
                let (segment, foot, distance) = near.find(xyz)?;
                if distance > ON_CURVE * near.extent {
                    return Some(((xyz - foot) / (xyz - foot).length(), None, size(distance)));
                }
                let along = (segment[1] - segment[0]).normalize();
                Some((along.any_orthonormal_vector(), Some(along), size(distance)))
            }
        }
    }

    /// The field at a point, intersected with the metric of other fields there; `None` when the point is not finite.
    #[inline]
    pub fn intersect(&self, others: Option<Metric3>, uv: DVec2, xyz: DVec3) -> Option<Metric3> {
        let (n, on, h) = self.across(uv, xyz)?;
        let Some(along) = self.along else {
            // Without other fields, bound the sizes within the anisotropy that a tensor can represent.
            let others = others.unwrap_or_else(|| {
                Metric3::isotropic((UNBOUNDED * self.curves.extent()).min(0.1 * LARGEST_ANISOTROPY * h))
            });
            let m = others.intersect_slab(n, h);
            return Some(on.map_or(m, |along| m.intersect_slab(n.cross(along), h)));
        };
        // Where rows are higher than elements are to be long, these grow with them: far away no element stands on end.
        let along = if along > self.first { along.max(h) } else { along };
        let h = h.min(LARGEST_ANISOTROPY * along);
        let (across, along) = (1.0 / (h * h), 1.0 / (along * along));
        let m = match (&self.curves, on) {
            (Curves::Plane(_), _) => {
                Metric3::from_eigen([across, along, along], [n, n.truncate().perp().extend(0.0), DVec3::Z])
            }
            (Curves::Space(_), Some(curve)) => Metric3::from_eigen([across, across, along], [n, n.cross(curve), curve]),
            (Curves::Space(_), None) => {
                let (a, b) = n.any_orthonormal_pair();
                Metric3::from_eigen([across, along, along], [n, a, b])
            }
        };
        Some(others.map_or(m, |others| Metric3::intersect(&others, &m)))
    }
}
