//! Rows at walls (docs/algorithm.md, "Rows at walls"): the nodes of a boundary layer are laid on the normals of the
//! wall at the heights that are asked for, one row a step, from the wall outwards.

mod stems;

use glam::DVec2;

use self::stems::{Stand, stands};
use crate::core::convert::event::Event;
use crate::core::convert::relax::energy;
use crate::core::mesh::{Mesh, NodeId};
use crate::core::metric::MetricSource;

/// Times that a row is tried; in between the nodes beyond it give way.
const ROUNDS: usize = 4;
/// A node that is laid leaves the elements around at least this quality,
const LEAST_QUALITY: f64 = 0.55;
/// or this share of what the worst had.
const KEPT_QUALITY: f64 = 0.9;
/// So many rows are the first, of which the heights matter most.
const FIRST_ROWS: u32 = 5;
/// Where an element is of lower quality than this, the nodes at it of the first rows, and of those beyond, are smoothed
/// like others.
const POOR: [f64; 2] = [0.55, 0.9];
/// A node that would have to go farther than this, in its metric, belongs to another row or stem.
const FARTHEST: f64 = 3.0;

/// The laying of rows under way. Where nodes are to stand follows from the structure and from the wall, neither of
/// which changes any more.
#[derive(Clone, Debug)]
pub struct RowLaying {
    /// Row by row.
    stands: Vec<Stand>,
    /// The stand of each node; `NONE` without one.
    of_node: Vec<u32>,
    /// The next row, from 0.
    next: u32,
}

/// No stand.
const NONE: u32 = u32::MAX;

/// What a row has become.
struct Laid {
    nodes: u32,
    /// Mean angle between edges and normals, radians.
    lean: f64,
}

impl RowLaying {
    /// The rows of a face, or of all, before any of them is laid.
    pub fn begin(mesh: &Mesh, source: &dyn MetricSource, face: Option<u32>) -> RowLaying {
        let stands = stands(mesh, source, face);
        let mut of_node = vec![NONE; if stands.is_empty() { 0 } else { mesh.node_slots() }];
        (0..).zip(&stands).for_each(|(k, stand)| of_node[stand.node.index()] = k);
        RowLaying { stands, of_node, next: 0 }
    }

    /// Lays the next row as far as the elements around allow. None where no row is left, or the last one could not be
    /// laid anywhere.
    pub fn step(&mut self, mesh: &mut Mesh, source: &dyn MetricSource) -> Option<Event> {
        let row: Vec<Stand> = self.row(self.next).to_vec();
        let stand_ready = |stand: &&Stand| mesh.is_fixed(stand.below) || self.is_held(mesh, stand.below);
        let ready: Vec<Stand> = row.iter().filter(stand_ready).copied().collect();
        if ready.is_empty() {
            return None;
        }
        let before = state_of(mesh, &row);
        let beyond = self.beyond(mesh, &ready);
        for _ in 0..ROUNDS {
            let waiting = ready.iter().filter(|stand| !lay(mesh, source, stand)).count();
            for &node in &beyond {
                energy::relax(mesh, node, source);
            }
            if waiting == 0 {
                break;
            }
        }
        let after = state_of(mesh, &row);
        self.next += 1;
        Some(Event::RowLaid {
            row: self.next,
            nodes: row.len() as u32,
            laid: after.nodes,
            lean: [before.lean, after.lean],
        })
    }

    /// Whether a node stands where its row wants it: it is not to be moved any more.
    fn is_held(&self, mesh: &Mesh, node: NodeId) -> bool {
        self.stand(node).is_some_and(|stand| stand.row < self.next && mesh.uv(node) == stand.place)
    }

    /// Where a node is to stand.
    fn stand(&self, node: NodeId) -> Option<&Stand> {
        self.of_node.get(node.index()).and_then(|&k| self.stands.get(k as usize))
    }

    /// Whether the last smoothing leaves a node where its row wants it, since no element around is poor.
    pub fn stays(&self, mesh: &Mesh, node: NodeId) -> bool {
        let poor = POOR[usize::from(self.stand(node).is_some_and(|stand| stand.row >= FIRST_ROWS))];
        self.is_held(mesh, node) && mesh.worst_quality_at(node) >= poor
    }

    /// The stands of a row.
    fn row(&self, row: u32) -> &[Stand] {
        let [from, to] = [row, row + 1].map(|row| self.stands.partition_point(|stand| stand.row < row));
        &self.stands[from..to]
    }

    /// The free nodes up to two edges away from those of a row that are not of this row or one before it, by id.
    fn beyond(&self, mesh: &Mesh, row: &[Stand]) -> Vec<NodeId> {
        let is_laid = |n: NodeId| self.stand(n).is_some_and(|stand| stand.row <= self.next);
        let mut nodes: Vec<NodeId> = row.iter().map(|stand| stand.node).collect();
        for _ in 0..2 {
            let around: Vec<NodeId> = nodes.iter().flat_map(|&n| mesh.neighbours(n)).collect();
            nodes.extend(around.into_iter().filter(|&n| !mesh.is_fixed(n) && !is_laid(n)));
            nodes.sort_unstable();
            nodes.dedup();
        }
        nodes.retain(|&n| !is_laid(n));
        nodes
    }

    /// The number of rows laid.
    pub fn mark(&self) -> u32 {
        self.next
    }

    /// Takes back all rows but so many.
    pub fn take_back(&mut self, mark: u32) {
        self.next = mark;
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of::<Stand>() * self.stands.capacity() + size_of::<u32>() * self.of_node.capacity()
    }

    /// Appends what the next steps depend on: nothing where there is no wall.
    pub fn write_state(&self, bytes: &mut Vec<u8>) {
        if !self.stands.is_empty() {
            bytes.extend_from_slice(&self.next.to_le_bytes());
        }
    }
}

/// How many nodes of a row stand where they are to stand, and how much their stems lean.
fn state_of(mesh: &Mesh, row: &[Stand]) -> Laid {
    let lean = |stand: &Stand| {
        let edge = mesh.uv(stand.node) - mesh.uv(stand.below);
        libm::atan2(stand.normal.perp_dot(edge).abs(), stand.normal.dot(edge))
    };
    let nodes = row.iter().filter(|stand| mesh.uv(stand.node) == stand.place).count();
    Laid { nodes: nodes as u32, lean: row.iter().map(lean).sum::<f64>() / row.len() as f64 }
}

/// Moves a node to its place, or towards it as far as the elements around allow. Whether it has come there.
fn lay(mesh: &mut Mesh, source: &dyn MetricSource, stand: &Stand) -> bool {
    let (node, there) = (stand.node, stand.place);
    let here = mesh.uv(node);
    if here == there {
        return true;
    }
    if mesh.metric_ref(node).norm2(there - here) > FARTHEST * FARTHEST {
        return false;
    }
    let worst = mesh.worst_quality_at(node);
    let mut step = 1.0;
    for _ in 0..4 {
        let place: DVec2 = if step == 1.0 { there } else { here + (there - here) * step };
        let is_whole = step == 1.0;
        step *= 0.5;
        if mesh.can_move(node, place).is_err() {
            continue;
        }
        let Ok(metric) = source.metric(place) else { continue };
        let quality = mesh.fan(node).map(|h| mesh.quality_with(h, place, &metric)).fold(f64::INFINITY, f64::min);
        if quality >= LEAST_QUALITY || quality >= KEPT_QUALITY * worst {
            mesh.move_node(node, place, metric);
            return is_whole;
        }
    }
    false
}
