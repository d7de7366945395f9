//! The small background mesh in a case file, for the figures of the paper.

use glam::DVec2;

use super::Background;
use crate::core::background::import::import;
use crate::core::case::Case;
use crate::core::fault::Fault;
use crate::core::kernel::predicates::convex;
use crate::core::mesh::{ElementId, Mesh, Names, NewElement};
use crate::core::metric::{Field, MetricSource, Sizing};
use crate::core::soup::MeshFile;

/// The mesh in a case file, unchanged: nodes keep their numbers, and its quadrilaterals exist from the start.
pub(super) fn from_elements(
    case: &Case,
    points: &[DVec2],
    triangles: &[[u32; 3]],
    quads: &[[u32; 4]],
) -> Result<Background, Fault> {
    if case.gradation.is_some() {
        return Err(Fault::new("The case has a background and bounds the gradation").remedy("Remove gradation"));
    }
    for (i, q) in quads.iter().enumerate() {
        let [a, b, c, d] = q.map(|n| points[n as usize]);
        if !convex(a, b, c, d) {
            return Err(Fault::new(format!("quads[{i}] is not strictly convex and anticlockwise"))
                .remedy("List its points anticlockwise, with all corners below 180 degrees"));
        }
    }
    // Split for the checks of triangle meshes; the halves are merged again below.
    let halves = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let file = MeshFile {
        points: points.iter().map(|p| p.extend(0.0)).collect(),
        triangles: triangles.iter().copied().chain(halves).collect(),
        ..MeshFile::default()
    };
    let imported = import(&file, false, None)?;
    if let Some(repair) = imported.repairs.first() {
        return Err(Fault::new(format!("The background needs a repair: {repair}"))
            .remedy("Correct it: a mesh in a case file is not repaired"));
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
    Ok(Background::given(mesh, sizing, names))
}
