//! Hard points of a divided domain: nodes exactly there.

use super::DividedDomain;
use crate::core::geometry::{CurveId, Domain, PointOn};

/// The parameters of a curve at which hard points lie, ascending.
pub(super) fn parameters(domain: &Domain, id: CurveId) -> Vec<f64> {
    let on_curve = |on: &PointOn| match on {
        PointOn::Curve(own, t) if *own == id => Some(*t),
        _ => None,
    };
    let mut found: Vec<f64> = domain.points.iter().filter_map(|point| on_curve(&point.on)).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// Places nodes at the hard points: those of curves and vertices are there already, but for rounding.
pub(super) fn place(domain: &Domain, divided: &mut DividedDomain) {
    for (number, point) in (0..).zip(&domain.points) {
        match &point.on {
            PointOn::Vertices(vertices) => {
                for &vertex in vertices {
                    if domain.spatial.is_none() {
                        divided.nodes[vertex as usize] = point.uv;
                    }
                    divided.hard.push((vertex, number));
                }
            }
            PointOn::Curve(id, t) => {
                if let Some(k) = divided.parameters[id.index()].iter().position(|known| known == t) {
                    let node = divided.chains[id.index()][k];
                    divided.nodes[node as usize] = point.uv;
                    divided.hard.push((node, number));
                }
            }
            PointOn::Face => {
                let node = divided.nodes.len() as u32;
                divided.nodes.push(point.uv);
                if domain.spatial.is_some() {
                    divided.joined.push(node);
                    divided.xyz.push(point.xyz);
                }
                divided.hard.push((node, number));
            }
        }
    }
}
