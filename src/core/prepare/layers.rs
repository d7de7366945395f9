//! Boundary offsetting (paper 4.3.3, point 3, fig. 10) on some loops only: all other segments start at the level at
//! which offsetting ends, so that they are not selected before.

use glam::DVec2;
use rustc_hash::FxHashSet;

use crate::core::background::DividedDomain;
use crate::core::case::Parameters;
use crate::core::fault::Fault;
use crate::core::geometry::Domain;
use crate::core::kernel::spelling::nearest;
use crate::core::mesh::{HalfEdgeId, Mesh};

/// Indices of the curves on whose loops rows are offset; `None` for all loops or none.
///
/// # Errors
/// A name of no curve.
pub(super) fn layered_curves(domain: &Domain, parameters: &Parameters) -> Result<Option<Vec<usize>>, Fault> {
    // On surfaces, the images of a curve on its faces share its name.
    let numbers = |name: &String| {
        let found: Vec<usize> = (0..domain.curves.len()).filter(|&c| domain.curves[c].name == *name).collect();
        if found.is_empty() {
            let fault =
                Fault::new(format!("layered_loops names \"{}\", but no curve has this name", name.escape_debug()));
            return Err(match nearest(name, domain.curves.iter().map(|curve| curve.name.as_str())) {
                Some(near) => fault.remedy(format!("The nearest name is \"{near}\"")),
                None => fault.remedy("Name a curve of each loop"),
            });
        }
        Ok(found)
    };
    let curves: Vec<Vec<usize>> = parameters.layered_loops.iter().map(numbers).collect::<Result<_, _>>()?;
    let curves = curves.concat();
    Ok((parameters.layers > 0 && !curves.is_empty()).then_some(curves))
}

/// Restricts offsetting to the loops along the curves.
pub(super) fn offset_only(mesh: &mut Mesh, divided: &DividedDomain, curves: &[usize], layers: u32) {
    // Boundary nodes have not moved, so their positions identify them; adding zero turns -0 into 0.
    let bits = |p: DVec2| [(p.x + 0.0).to_bits(), (p.y + 0.0).to_bits()];
    let mut named = FxHashSet::default();
    for chain in curves.iter().map(|&curve| &divided.chains[curve]) {
        for pair in chain.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|n| bits(divided.nodes[n as usize]));
            named.insert([a, b]);
            named.insert([b, a]);
        }
    }
    let segments: Vec<HalfEdgeId> = mesh.front().collect();
    let mut layered = vec![false; mesh.node_slots()];
    for &start in &segments {
        let follows = named.contains(&mesh.ends(start).map(|n| bits(mesh.uv(n))));
        if !follows || layered[mesh.origin(start).index()] {
            continue;
        }
        mesh.front_loop(start).for_each(|h| layered[mesh.origin(h).index()] = true);
    }
    for h in segments {
        let node = mesh.origin(h);
        if !layered[node.index()] {
            mesh.set_first_level(node, u16::try_from(layers).unwrap_or(u16::MAX));
        }
    }
}
