//! The metric with bounded gradation, as a table at the nodes of a first mesh.

use glam::{DVec2, DVec3};

use crate::core::fault::Fault;
use crate::core::kernel::Metric3;
use crate::core::mesh::{Mesh, NodeId};
use crate::core::metric::gradation::bound_gradation;
use crate::core::metric::{Field, Sizing};

/// The field at the nodes of a mesh, with gradation bounded by `beta`, as a table. Coincident nodes (on curves between
/// faces, on both sides of cracks) are one node of the table: bounded separately, they would differ, and rounding would
/// decide which of the two applies along the curve.
pub(super) fn bounded(mesh: &Mesh, sizing: &Sizing, beta: f64) -> Result<Field, Fault> {
    let (points, place) = places(mesh);
    let mut metrics = points.iter().map(|&uv| sizing.metric3_at(uv)).collect::<Result<Vec<_>, _>>()?;
    let edges: Vec<[u32; 2]> = mesh.edges().map(|h| mesh.ends(h).map(|n| place[n.index()])).collect();
    let triangles: Vec<[u32; 3]> = mesh.elements().map(|e| mesh.triangle(e).map(|n| place[n.index()])).collect();
    let Some(embedding) = mesh.embedding() else {
        let in_space: Vec<_> = points.iter().map(|p| p.extend(0.0)).collect();
        bound_gradation(&in_space, &edges, &mut metrics, beta);
        return Field::table(&points, &triangles, metrics);
    };
    // On surfaces, nodes of different charts may be one point in space, through which sizes spread from face to face.
    let mut space_of: Vec<u32> = vec![0; points.len()];
    let (mut in_space, mut shared): (Vec<DVec3>, Vec<Metric3>) = (Vec::new(), Vec::new());
    let mut of_point: Vec<Option<u32>> = vec![None; embedding.points.len()];
    for node in mesh.nodes() {
        let here = place[node.index()] as usize;
        let known = mesh.point(node).and_then(|p| of_point[p.index()]);
        let number = known.unwrap_or_else(|| {
            in_space.push(mesh.xyz(node));
            shared.push(metrics[here]);
            in_space.len() as u32 - 1
        });
        if known.is_some() {
            let both = Metric3::intersect(&shared[number as usize], &metrics[here]);
            shared[number as usize] = both;
        }
        if let Some(point) = mesh.point(node) {
            of_point[point.index()] = Some(number);
        }
        space_of[here] = number;
    }
    let edges: Vec<[u32; 2]> = edges.iter().map(|e| e.map(|n| space_of[n as usize])).collect();
    bound_gradation(&in_space, &edges, &mut shared, beta);
    Field::table(&points, &triangles, space_of.iter().map(|&n| shared[n as usize]).collect())
}

/// The distinct positions of a mesh's nodes, in the order of their first nodes, and the position of each node slot.
fn places(mesh: &Mesh) -> (Vec<DVec2>, Vec<u32>) {
    let uv = |n: u32| mesh.uv(NodeId(n));
    let by_place = |a: &u32, b: &u32| uv(*a).x.total_cmp(&uv(*b).x).then(uv(*a).y.total_cmp(&uv(*b).y));
    let mut sorted: Vec<u32> = (0..mesh.node_slots() as u32).collect();
    sorted.sort_by(by_place);
    let mut first: Vec<u32> = vec![0; sorted.len()];
    for here in sorted.chunk_by(|a, b| by_place(a, b).is_eq()) {
        here.iter().for_each(|&n| first[n as usize] = here[0]);
    }
    let (mut points, mut place) = (Vec::new(), vec![0; first.len()]);
    for n in 0..first.len() {
        if first[n] as usize == n {
            place[n] = points.len() as u32;
            points.push(uv(n as u32));
        } else {
            place[n] = place[first[n] as usize];
        }
    }
    (points, place)
}
