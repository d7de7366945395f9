//! A run beside a finished mesh, such as one of another program: what both have, and the first step of the run that
//! made a quadrilateral which the mesh does not have.

use std::collections::BTreeSet;

use serde::Serialize;

use crate::core::fault::Fault;
use crate::core::mesh::{ElementId, PointId};
use crate::core::progress::Watch;
use crate::core::record::{Measured, Statistics};
use crate::core::run::Run;
use crate::core::run::compare::{Did, NodesInSpace, did_at};
use crate::core::run::history::{BUDGET, History};
use crate::core::soup::MeshFile;

/// What a run and a mesh have in common.
#[derive(Serialize)]
pub(super) struct Finished {
    /// The first step that made a quadrilateral which the mesh does not have; the last step where the mesh has more.
    /// `None` where both have the same quadrilaterals.
    pub first_difference: Option<Parted>,
    /// How many quadrilaterals both have: their corners lie within [`NEAR`](crate::core::run::compare::NEAR) of each
    /// other.
    pub both: usize,
    /// How many only the run has, and only the mesh.
    pub only: [usize; 2],
    /// The statistics of the mesh in the metric of the case; `None` on surfaces, where its nodes have no place in the
    /// parametric plane.
    pub statistics: Option<Statistics>,
}

/// A step after which a run and a mesh have not the same quadrilaterals.
#[derive(Serialize)]
pub(super) struct Parted {
    /// The step.
    pub step: u64,
    /// The corners of the quadrilateral that the mesh does not have; `None` where the mesh has more.
    pub corners: Option<[[f64; 3]; 4]>,
    /// What the run did there.
    pub did: Option<Did>,
}

/// Compares the end of a run with a mesh of quadrilaterals.
///
/// # Errors
/// A mesh with other elements, a conversion that cannot continue, cancellation.
pub(super) fn compare(run: &Run, other: &MeshFile, watch: &mut dyn Watch) -> Result<Finished, Fault> {
    let background = run.background(watch)?;
    let mut history = History::of(run.clone(), &background, BUDGET)?;
    history.seek(u64::MAX)?;
    let end = history.step();
    let mesh = &history.state().mesh;
    let quads: Vec<ElementId> = mesh.elements().filter(|e| mesh.is_quad(*e)).collect();
    let nodes = NodesInSpace::of(mesh);
    let corners = |e: ElementId| mesh.quad(e).map(|n| mesh.xyz(n));
    let ours: Vec<Option<[usize; 4]>> = quads.iter().map(|e| nodes.at_corners(corners(*e))).collect();
    let theirs: Vec<Option<[usize; 4]>> =
        other.quads.iter().map(|quad| nodes.at_corners(quad.map(|n| other.points[n as usize]))).collect();
    let [of_ours, of_theirs] = [&ours, &theirs].map(|all| all.iter().flatten().collect::<BTreeSet<_>>());
    let missing = quads.iter().zip(&ours).filter(|(_, quad)| quad.is_none_or(|quad| !of_theirs.contains(&quad)));
    let missing: Vec<ElementId> = missing.map(|(e, _)| *e).collect();
    let both = quads.len() - missing.len();
    // Two quadrilaterals of the mesh near one of the run count once.
    let more = theirs.len() - of_theirs.intersection(&of_ours).count();
    let born = history.log().born().of_quads(end, mesh.element_slots());
    let first = missing.iter().map(|e| (born[e.index()], *e)).min();
    let parted = match first {
        Some((step, e)) => Some((step, Some(corners(e).map(|p| p.to_array())))),
        None if more > 0 => Some((end, None)),
        None => None,
    };
    let only = [missing.len(), more];
    let statistics = match mesh.embedding() {
        Some(_) => None,
        None => {
            let uv: Vec<_> = other.points.iter().map(|p| p.truncate()).collect();
            let points: Vec<_> = (0..uv.len() as u32).map(PointId).collect();
            let measured = Measured { uv: &uv, points: &points, triangles: &[], quads: &other.quads, surfaces: None };
            Some(Statistics::measure(measured, &background.sizing)?)
        }
    };
    let parted =
        parted.map(|(step, corners)| Ok::<_, Fault>(Parted { step, corners, did: did_at(&mut history, step)? }));
    Ok(Finished { first_difference: parted.transpose()?, both, only, statistics })
}
