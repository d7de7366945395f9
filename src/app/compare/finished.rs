//! A run beside a finished mesh, such as one of another program: what both have, and the first step of the run that
//! made a quadrilateral which the mesh does not have.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use rstar::primitives::GeomWithData;
use rstar::{PointDistance, RTree};
use serde::Serialize;

use crate::core::fault::Fault;
use crate::core::mesh::{ElementId, Mesh, PointId};
use crate::core::progress::Watch;
use crate::core::record::{Measured, Statistics};
use crate::core::run::Run;
use crate::core::run::compare::{Did, did_at};
use crate::core::run::history::{BUDGET, History};
use crate::core::soup::MeshFile;

/// How near a node of the mesh must be to one of the run to count as the same, as a part of the shortest edge there.
const NEAR: f64 = 0.1;

/// What a run and a mesh have in common.
#[derive(Serialize)]
pub(super) struct Finished {
    /// The first step that made a quadrilateral which the mesh does not have; the last step where the mesh has more.
    /// `None` where both have the same quadrilaterals.
    pub first_difference: Option<Parted>,
    /// How many quadrilaterals both have: their corners lie within [`NEAR`] of each other.
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
    let nodes = Nodes::of(mesh);
    let corners = |e: ElementId| mesh.quad(e).map(|n| mesh.xyz(n));
    let ours: Vec<Option<[usize; 4]>> = quads.iter().map(|e| nodes.sorted(corners(*e))).collect();
    let theirs: Vec<Option<[usize; 4]>> =
        other.quads.iter().map(|quad| nodes.sorted(quad.map(|n| other.points[n as usize]))).collect();
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

/// The nodes of a run, copies on both sides of a curve as one.
struct Nodes {
    /// Places with their numbers and the squares of how near another node must be.
    tree: RTree<GeomWithData<[f64; 3], (usize, f64)>>,
}

impl Nodes {
    fn of(mesh: &Mesh) -> Nodes {
        let mut near: BTreeMap<[u64; 3], f64> = BTreeMap::new();
        for node in mesh.nodes() {
            let edges = mesh.neighbours(node).map(|other| mesh.xyz(node).distance(mesh.xyz(other)));
            let shortest = edges.fold(f64::INFINITY, f64::min);
            let known = near.entry(mesh.xyz(node).to_array().map(f64::to_bits)).or_insert(f64::INFINITY);
            *known = known.min(NEAR * shortest);
        }
        let place = |(k, (bits, near)): (usize, (&[u64; 3], &f64))| {
            GeomWithData::new(bits.map(f64::from_bits), (k, near * near))
        };
        Nodes { tree: RTree::bulk_load(near.iter().enumerate().map(place).collect()) }
    }

    /// The numbers of the nodes at four corners, sorted; `None` where there is no node at one of them.
    fn sorted(&self, corners: [DVec3; 4]) -> Option<[usize; 4]> {
        let mut found = [0; 4];
        for (number, p) in found.iter_mut().zip(corners) {
            let node = self.tree.nearest_neighbor(p.to_array())?;
            if node.distance_2(&p.to_array()) > node.data.1 {
                return None;
            }
            *number = node.data.0;
        }
        found.sort_unstable();
        Some(found)
    }
}
