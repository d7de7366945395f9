//! Boundary offsetting (paper 4.3.3, point 3, fig. 10) on some loops only: all other segments start at the level at
//! which offsetting ends, so that they are not selected before.

use glam::DVec2;
use rustc_hash::FxHashSet;

use crate::core::background::DividedDomain;
use crate::core::case::Parameters;
use crate::core::fault::Fault;
use crate::core::geometry::{Domain, Joint};
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

/// No rows are offset from the mirror line of a half: in the whole mesh it is no boundary.
pub(super) fn not_along_the_line(mesh: &mut Mesh, layers: u32) {
    if layers == 0 || mesh.symmetry().is_none() {
        return;
    }
    let glued: Vec<HalfEdgeId> = mesh.front().filter(|&h| is_glued(mesh, h)).collect();
    for h in glued {
        mesh.set_first_level(mesh.origin(h), u16::try_from(layers).unwrap_or(u16::MAX));
    }
}

/// Whether a side lies on the mirror line of a half and is to be an inner edge of the whole.
fn is_glued(mesh: &Mesh, h: HalfEdgeId) -> bool {
    mesh.symmetry().is_some_and(|symmetry| symmetry.joint(mesh, h) == Some(Joint::Glued))
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
        // The mirror line of a half joins what are separate loops of the whole.
        let all: Vec<HalfEdgeId> = mesh.front_loop(start).collect();
        let first = all.iter().position(|&h| is_glued(mesh, h)).unwrap_or(0);
        let all = [&all[first..], &all[..first]].concat();
        let own = all.split(|&h| is_glued(mesh, h)).find(|part| part.contains(&start));
        own.unwrap_or_default().iter().for_each(|&h| layered[mesh.origin(h).index()] = true);
    }
    for h in segments {
        let node = mesh.origin(h);
        if !layered[node.index()] {
            mesh.set_first_level(node, u16::try_from(layers).unwrap_or(u16::MAX));
        }
    }
}
