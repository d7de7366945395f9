//! The quantities that elements can be coloured by, and their values.

use crate::core::kernel::worded::worded;
use crate::core::mesh::{ElementId, Mesh};
use crate::core::metric::measure::{angle, triangle_area};
use crate::render::colour_map::ColourMap;
use crate::render::palette::Rgba;

worded! {
    /// The quantity that elements are coloured by.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum ColourBy by name {
        /// Live and dead.
        #[default]
        State = "live and dead",
        /// The mean of the smallest target sizes at the nodes (eq. 6), on a logarithmic scale.
        HValue = "H",
        /// The smallest angle in the metric (eq. 5), in degrees.
        Angle = "smallest angle, metric",
        /// Rows from the boundary.
        Level = "level",
        /// Quality in the metric.
        Quality = "quality, metric",
        /// The step that made the element.
        Birth = "step of birth",
        /// Area in the metric.
        Area = "metric area",
    }
}

impl ColourBy {
    /// Its colour map; `None` where the state is shown.
    pub fn map(self) -> Option<ColourMap> {
        match self {
            ColourBy::State => None,
            ColourBy::HValue | ColourBy::Birth | ColourBy::Area => Some(ColourMap::Viridis),
            ColourBy::Angle | ColourBy::Quality => Some(ColourMap::Cividis),
            ColourBy::Level => Some(ColourMap::Batlow),
        }
    }
}

/// The values that elements are coloured by, with their range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shading {
    /// The quantity.
    pub by: ColourBy,
    /// A value for each element slot; NaN where there is none.
    pub values: Vec<f64>,
    /// The smallest and the largest value.
    pub range: [f64; 2],
    /// Whether the colour scale is logarithmic.
    pub logarithmic: bool,
}

impl Shading {
    /// The values of `by` over a mesh; `births` has the step at which each element slot was last made.
    pub fn of(mesh: &Mesh, by: ColourBy, births: &[u64]) -> Shading {
        let logarithmic = matches!(by, ColourBy::HValue | ColourBy::Area);
        if by == ColourBy::State {
            return Shading::default();
        }
        let value = |e: ElementId| match by {
            ColourBy::State => f64::NAN,
            ColourBy::HValue => {
                let nodes: Vec<_> = mesh.corners(e).collect();
                nodes.iter().map(|n| mesh.smallest_size(*n)).sum::<f64>() / nodes.len() as f64
            }
            ColourBy::Angle => metric_angles(mesh, e)[0].to_degrees(),
            ColourBy::Level if mesh.is_quad(e) => f64::from(mesh.level(e)),
            ColourBy::Birth if mesh.is_quad(e) => births.get(e.index()).map_or(f64::NAN, |b| *b as f64),
            ColourBy::Level | ColourBy::Birth => f64::NAN,
            ColourBy::Quality => mesh.quality(e),
            ColourBy::Area => metric_area(mesh, e),
        };
        let slots = (0..mesh.element_slots() as u32).map(ElementId);
        let values: Vec<f64> = slots.map(|e| if mesh.has_element(e) { value(e) } else { f64::NAN }).collect();
        let finite = || values.iter().copied().filter(|v| v.is_finite());
        let range = match by {
            ColourBy::Quality => [0.0, 1.0],
            ColourBy::Angle => [0.0, 90.0],
            _ => [finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max)],
        };
        let range = if range[0] <= range[1] { range } else { [0.0, 1.0] };
        Shading { by, values, range, logarithmic }
    }

    /// The relative position of a value in the range, 0 to 1.
    pub fn share(&self, value: f64) -> f32 {
        let scale = |v: f64| if self.logarithmic { libm::log(v) } else { v };
        let [low, high] = self.range.map(scale);
        if high > low { ((scale(value) - low) / (high - low)) as f32 } else { 0.5 }
    }

    pub(super) fn colour(&self, e: ElementId) -> Option<Rgba> {
        let value = self.values.get(e.index()).copied().filter(|v| v.is_finite())?;
        Some(self.by.map()?.at(self.share(value)))
    }
}

/// The smallest and the largest inner angle of an element, each in the metric of its node (eq. 5), in radians.
pub fn metric_angles(mesh: &Mesh, e: ElementId) -> [f64; 2] {
    extremes(mesh.half_edges(e).map(|h| {
        let [node, next, last] = [mesh.origin(h), mesh.target(h), mesh.apex(h)];
        let p = mesh.uv(node);
        angle(mesh.metric_ref(node), mesh.uv(next) - p, mesh.uv(last) - p)
    }))
}

/// The smallest and the largest angle of an element in space, in radians.
pub fn space_angles(mesh: &Mesh, e: ElementId) -> [f64; 2] {
    extremes(mesh.angles_in_space(e).into_iter())
}

fn extremes(angles: impl Iterator<Item = f64>) -> [f64; 2] {
    angles.fold([f64::INFINITY, 0.0], |[low, high], angle| [low.min(angle), high.max(angle)])
}

/// The area of an element in the metric of its nodes.
pub fn metric_area(mesh: &Mesh, e: ElementId) -> f64 {
    let nodes: Vec<_> = mesh.corners(e).collect();
    let at = |k: usize| mesh.uv(nodes[k]);
    let part = |a: usize, b: usize, c: usize| {
        [a, b, c].iter().map(|k| triangle_area(mesh.metric_ref(nodes[*k]), at(a), at(b), at(c))).sum::<f64>() / 3.0
    };
    if nodes.len() == 4 { part(0, 1, 2) + part(0, 2, 3) } else { part(0, 1, 2) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::fixtures::two_squares;

    #[test]
    fn unit_squares_have_unit_metric_area_together_and_their_smallest_angle_is_half_a_right_one() {
        let mesh = two_squares();
        let area: f64 = mesh.elements().map(|e| metric_area(&mesh, e)).sum();
        assert!((area - 2.0).abs() < 1e-12);
        let shading = Shading::of(&mesh, ColourBy::Angle, &[]);
        assert!(shading.values.iter().all(|v| (v - 45.0).abs() < 1e-9));
        assert_eq!(shading.share(45.0), 0.5);
    }
}
