//! Where the nodes of rows at walls are to stand (docs/algorithm.md, "Rows at walls"): stems go from the nodes of the
//! wall outwards, each along the normal of its node, as far as lines of edges cross regularly.

use std::f64::consts::PI;

use glam::DVec2;
use smallvec::SmallVec;

use crate::core::convert::wall::{WallNode, is_asked, opposite};
use crate::core::mesh::{HalfEdgeId, Mesh, NodeId};
use crate::core::metric::MetricSource;

/// Beside a corner normals lean towards it, by at most the angle with this sine: 10 degrees.
const MOST_LEAN: f64 = 0.173_648_177_666_930_3;
/// Rounds in which a normal becomes more like those beside it.
const FAN_ROUNDS: usize = 4;
/// At a corner of less than 180 degrees a stem is at most this much longer than its rows are high.
const MOST_STRETCH: f64 = 2.0;

/// A node of a row, and where it is to stand.
#[derive(Clone, Copy, Debug)]
pub struct Stand {
    pub node: NodeId,
    /// The node before it on its stem.
    pub below: NodeId,
    /// Its row, from 0.
    pub row: u32,
    pub place: DVec2,
    /// The direction of its stem.
    pub normal: DVec2,
}

/// The stems of a node of a wall.
struct Foot {
    wall: WallNode,
    /// The normal of the wall; none at a corner, or where not exactly one edge leaves it.
    normal: Option<DVec2>,
    /// What a stem is longer than its rows are high.
    stretch: f64,
    /// The directions of the stems along its edges off the wall.
    directions: SmallVec<[DVec2; 4]>,
}

/// The nodes of all rows at the walls of a face, or of all: row by row, each node once.
pub fn stands(mesh: &Mesh, source: &dyn MetricSource, face: Option<u32>) -> Vec<Stand> {
    if !source.has_walls() {
        return Vec::new();
    }
    let wall = mesh.nodes_of(face).filter_map(|node| WallNode::of(mesh, source, node));
    let mut feet: Vec<Foot> = wall.map(Foot::of).collect();
    fan_out(mesh, &mut feet);
    let mut claims = Claims { of_node: vec![None; mesh.node_slots()], stands: Vec::new() };
    for foot in &feet {
        for (&h, &direction) in foot.wall.off.iter().zip(&foot.directions) {
            foot.climb(mesh, source, h, direction, &mut claims);
        }
    }
    let mut stands: Vec<Stand> = claims.stands.into_iter().map(|(stand, _)| stand).collect();
    stands.sort_by_key(|stand| stand.row);
    stands
}

impl Foot {
    fn of(wall: WallNode) -> Foot {
        let is_single = wall.off.len() == 1;
        let normal = wall.normal().filter(|_| is_single);
        let theta = wall.theta;
        let along = wall.to_beside[1].normalize();
        let share = theta / (wall.off.len() + 1) as f64;
        let direction = |k: usize| {
            let (sin, cos) = libm::sincos(share * (k + 1) as f64);
            normal.unwrap_or(along * cos + along.perp() * sin)
        };
        let directions = (0..wall.off.len()).map(direction).collect();
        let stretch = if is_single && theta < PI { (1.0 / libm::sin(0.5 * theta)).min(MOST_STRETCH) } else { 1.0 };
        Foot { wall, normal, stretch, directions }
    }

    /// The direction of its only stem, more like those of the stems beside it; none at a corner.
    fn leaning(&self, foot_of: &[Option<u32>], feet: &[Foot]) -> Option<DVec2> {
        let normal = self.normal?;
        let [before, after] = self.wall.beside.map(|n| foot_of[n.index()].map(|k| &feet[k as usize].directions));
        let before = before.and_then(|directions| directions.last());
        let after = after.and_then(|directions| directions.first());
        let own = self.directions[0] * 2.0;
        let sum = [before, after].into_iter().flatten().fold(own, |sum, direction| sum + *direction).normalize();
        let lean = normal.perp_dot(sum).clamp(-MOST_LEAN, MOST_LEAN);
        Some(normal * (1.0 - lean * lean).sqrt() + normal.perp() * lean)
    }

    /// Follows the stem of an edge off the wall, and says where its nodes are to stand.
    fn climb(&self, mesh: &Mesh, source: &dyn MetricSource, off: HalfEdgeId, normal: DVec2, claims: &mut Claims) {
        let (mut h, mut below, mut distance) = (off, self.wall.node, 0.0);
        // A stem has no more nodes than the mesh.
        for (row, height) in (0..mesh.node_count() as u32).zip(self.wall.rows.heights()) {
            let node = mesh.target(h);
            distance += height * self.stretch;
            let place = mesh.uv(self.wall.node) + normal * distance;
            if mesh.is_fixed(node) || !is_asked(source, place, normal, height, row) {
                return;
            }
            claims.add(Stand { node, below, row, place, normal });
            let Some(up) = opposite(mesh, h) else { return };
            (h, below) = (up, node);
        }
    }
}

/// Lets the normals beside corners lean towards the stems there, so that stems fan out.
fn fan_out(mesh: &Mesh, feet: &mut [Foot]) {
    let mut foot_of: Vec<Option<u32>> = vec![None; mesh.node_slots()];
    (0..).zip(feet.iter()).for_each(|(k, foot)| foot_of[foot.wall.node.index()] = Some(k));
    for _ in 0..FAN_ROUNDS {
        let leaning: Vec<Option<DVec2>> = feet.iter().map(|foot| foot.leaning(&foot_of, feet)).collect();
        for (foot, direction) in feet.iter_mut().zip(leaning) {
            if let (Some(direction), Some(normal)) = (direction, foot.normal) {
                foot.directions[0] = direction;
                foot.stretch = 1.0 / direction.dot(normal);
            }
        }
    }
}

/// What stems ask of nodes. Where two cross, as in a corner, the wall that is fewer rows away has the say; where both
/// are as far, the node is to stand half-way.
struct Claims {
    of_node: Vec<Option<u32>>,
    /// With the number of stems that agree on the row.
    stands: Vec<(Stand, u32)>,
}

impl Claims {
    fn add(&mut self, stand: Stand) {
        let Some(known) = self.of_node[stand.node.index()] else {
            self.of_node[stand.node.index()] = Some(self.stands.len() as u32);
            self.stands.push((stand, 1));
            return;
        };
        let (before, stems) = &mut self.stands[known as usize];
        if stand.row < before.row {
            (*before, *stems) = (stand, 1);
        } else if stand.row == before.row {
            before.place = before.place.lerp(stand.place, 1.0 / f64::from(*stems + 1));
            *stems += 1;
        }
    }
}
