//! The walls of a planar domain: the nodes of the curves that a boundary layer names (docs/algorithm.md, "Rows at
//! walls").

use crate::core::background::DividedDomain;
use crate::core::case::Case;
use crate::core::geometry::Domain;
use crate::core::metric::{FieldSpec, Rows, Walls};

/// The rows that the boundary layers of a case ask for, at the nodes of their curves. None on surfaces, where rows
/// follow the metric alone. `with_images` adds the names of their images to those of curves, in the half of a symmetric
/// domain.
pub(super) fn of_fields(
    case: &Case,
    domain: &Domain,
    divided: &DividedDomain,
    with_images: &dyn Fn(&[String]) -> Option<Vec<String>>,
) -> Walls {
    let mut walls = Walls::default();
    if domain.spatial.is_some() {
        return walls;
    }
    for field in &case.fields {
        let FieldSpec::BoundaryLayer { curves, first, growth, far, .. } = field else { continue };
        let curves = with_images(curves).unwrap_or_else(|| curves.clone());
        let rows = Rows { first: *first, growth: *growth, far: far.unwrap_or(f64::INFINITY) };
        let rows = rows.scaled(case.parameters.size_scale);
        for (curve, chain) in domain.curves.iter().zip(&divided.chains) {
            if curves.contains(&curve.name) {
                chain.iter().for_each(|&node| walls.add(divided.nodes[node as usize], rows));
            }
        }
    }
    walls
}
