//! The background mesh that a case itself holds: a small one, for the figures of the paper.

use glam::DVec2;

use super::Background;
use crate::core::background::adapt::Adapted;
use crate::core::background::import::import;
use crate::core::case::Case;
use crate::core::fault::Fault;
use crate::core::kernel::predicates::convex;
use crate::core::mesh::half_edge::{Mesh, NewElement};
use crate::core::mesh::ids::ElementId;
use crate::core::mesh::names::Names;
use crate::core::metric::field::{Field, MetricSource, Sizing};
use crate::core::soup::mesh_file::MeshFile;

/// A small mesh that the case itself holds, as it is: nodes keep its numbers, and its quadrilaterals stand already.
pub(super) fn from_elements(
    case: &Case,
    points: &[DVec2],
    triangles: &[[u32; 3]],
    quads: &[[u32; 4]],
) -> Result<Background, Fault> {
    if case.gradation.is_some() {
        return Err(Fault::new("The case has a background and bounds the gradation").remedy("Leave gradation out"));
    }
    for (i, q) in quads.iter().enumerate() {
        let [a, b, c, d] = q.map(|n| points[n as usize]);
        if !convex(a, b, c, d) {
            return Err(Fault::new(format!("quads[{i}] is not strictly convex and anticlockwise"))
                .remedy("Give the numbers of its points anticlockwise, and no corner of 180 degrees or more"));
        }
    }
    // Halved for the checks that triangle meshes go through; the halves are joined again afterwards.
    let halves = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let file = MeshFile {
        points: points.iter().map(|p| p.extend(0.0)).collect(),
        triangles: triangles.iter().copied().chain(halves).collect(),
        ..MeshFile::default()
    };
    let imported = import(&file, false)?;
    if let Some(repair) = imported.repairs.first() {
        return Err(Fault::new(format!("The background would have to be mended: {repair}"))
            .remedy("Write it as it shall be: nothing is mended in a mesh that a case holds"));
    }
    let set = &imported.set;
    let fields = case.fields.iter().map(|spec| Field::compile(spec, &|_| None)).collect::<Result<_, _>>()?;
    let sizing = Sizing::new(fields, case.parameters.size_scale);
    sizing.survey(&set.uv, &|_| false)?;
    let metric = set.uv.iter().map(|&uv| sizing.metric(uv)).collect::<Result<_, _>>()?;
    let mut mesh = Mesh::from_triangles(set, metric);
    for first in (triangles.len() as u32..set.triangles.len() as u32).step_by(2) {
        let [a, b, c] = mesh.triangle(ElementId(first));
        let [_, _, d] = mesh.triangle(ElementId(first + 1));
        mesh.replace(&[ElementId(first + 1), ElementId(first)], &[NewElement::quad([a, b, c, d], 0)]);
    }
    mesh.commit();
    let names = Names::of_faces(imported.regions);
    Ok(Background { mesh, sizing, names, adapted: Adapted::default(), repairs: Vec::new() })
}
