//! Nodes moved to where the elements around them fold least.

use glam::DVec2;
use smallvec::SmallVec;

use super::{FOLDED, Unfolding};
use crate::core::convert::relax::energy;
use crate::core::kernel::Metric2;
use crate::core::mesh::sines::Corners;
use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, NodeId};

/// Nodes are moved until the sines around are this large; larger is not better here.
const ENOUGH: f64 = 0.1;
/// Steps of a search for a better place, by the metric at the node, and the directions of each.
const STEPS: [f64; 5] = [0.4, 0.2, 0.1, 0.05, 0.02];
pub(super) const DIRECTIONS: [[f64; 2]; 8] =
    [[1.0, 0.0], [0.7, 0.7], [0.0, 1.0], [-0.7, 0.7], [-1.0, 0.0], [-0.7, -0.7], [0.0, -1.0], [0.7, -0.7]];
/// The sines around a corner that is moved by little are this large, or the next.
const NUDGED: [f64; 3] = [0.1, 0.05, 0.02];
/// Steps of a search for such a place, by the metric at the corner.
const NUDGES: [f64; 6] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.4];
/// Towards nodes around, the steps are by these parts of the way.
const PARTS: [f64; 3] = [2.0, 0.1, 0.005];
/// How often the nodes at hand are moved in turn.
const ROUNDS: usize = 4;

/// Where a node may be moved.
#[derive(Clone, Copy)]
enum Reach {
    /// Along axes of the metric, by this size.
    Axes(f64),
    /// Towards the nodes around, by this part of the way.
    Towards(f64),
}

impl Unfolding<'_> {
    /// Moves free corners of a quadrilateral: each in turn, or, where it is bent against its own mean normal alone, one
    /// of them by little; the way that leaves the better shape in the metric, which asked for the places where they
    /// are. Whether fewer elements around fold then; otherwise all is as before.
    pub(super) fn moved_or_nudged(&self, mesh: &mut Mesh, element: ElementId) -> bool {
        let corners = mesh.quad(element);
        let least_quality = |mesh: &Mesh| {
            let around = corners.iter().flat_map(|&n| mesh.elements_at(n));
            around.map(|e| mesh.quality(e)).fold(f64::INFINITY, f64::min)
        };
        let mark = mesh.mark();
        let Some((node, place, metric)) = self.nudge(mesh, element) else { return self.moved(mesh, element) };
        mesh.move_node(node, place, metric);
        let nudged = least_quality(mesh);
        mesh.take_back(mark);
        if self.moved(mesh, element) {
            if least_quality(mesh) >= nudged {
                return true;
            }
            mesh.take_back(mark);
        }
        mesh.move_node(node, place, metric);
        true
    }

    /// The place of one free corner of a quadrilateral at which nothing around it folds and shapes in the metric are
    /// best, for one that is bent against its own mean normal alone.
    fn nudge(&self, mesh: &Mesh, element: ElementId) -> Option<(NodeId, DVec2, Metric2)> {
        if mesh.least_surface_sine(element) < FOLDED {
            return None;
        }
        let free: SmallVec<[NodeId; 4]> = mesh.corners(element).filter(|&n| !mesh.is_fixed(n)).collect();
        NUDGED.into_iter().find_map(|enough| {
            let mut best: Option<(f64, NodeId, DVec2, Metric2)> = None;
            for &node in &free {
                let (from, axes) = (mesh.uv(node), energy::unit_axes(&mesh.metric(node)));
                let mut star = Star::of(mesh, node);
                for [x, y] in NUDGES.iter().flat_map(|step| DIRECTIONS.map(|[x, y]| [x * step, y * step])) {
                    let place = from + axes[0] * x + axes[1] * y;
                    let is_free = mesh.can_move(node, place).is_ok();
                    if !is_free || star.least_sine_at(mesh, place, self.near, enough) <= enough {
                        continue;
                    }
                    let Ok(metric) = self.source.metric(place) else { continue };
                    let around = mesh.fan(node).map(|h| mesh.quality_with(h, place, &metric));
                    let quality = around.fold(f64::INFINITY, f64::min);
                    if best.as_ref().is_none_or(|best| quality > best.0) {
                        best = Some((quality, node, place, metric));
                    }
                }
            }
            best.map(|(_, node, place, metric)| (node, place, metric))
        })
    }

    /// Moves the free corners of a quadrilateral in turn, each to where the least sine around it is greatest. Whether
    /// fewer elements around fold then; otherwise all is as before.
    pub(super) fn moved(&self, mesh: &mut Mesh, element: ElementId) -> bool {
        self.moved_in_turn(mesh, &mesh.quad(element))
    }

    /// The same in every other way: another corner first, which decides where the others have room; all together.
    pub(super) fn moved_anyhow(&self, mesh: &mut Mesh, element: ElementId) -> bool {
        let mut corners = mesh.quad(element);
        let in_turn = (1..corners.len()).any(|_| {
            corners.rotate_left(1);
            self.moved_in_turn(mesh, &corners)
        });
        in_turn || self.moved_together(mesh, element)
    }

    fn moved_in_turn(&self, mesh: &mut Mesh, corners: &[NodeId]) -> bool {
        let (mark, before) = (mesh.mark(), self.flaws(mesh, corners));
        self.improve_in_turn(mesh, corners);
        let is_better = self.flaws(mesh, corners) < before;
        if !is_better {
            mesh.take_back(mark);
        }
        is_better
    }

    /// Moves the free corners of a quadrilateral together towards a node around it, then each by itself. Whether fewer
    /// elements around fold then: one node alone cannot leave a facet that is flat in space.
    fn moved_together(&self, mesh: &mut Mesh, element: ElementId) -> bool {
        let corners = mesh.quad(element);
        let before = self.flaws(mesh, &corners);
        let free: Vec<NodeId> = corners.into_iter().filter(|&n| !mesh.is_fixed(n)).collect();
        if free.len() < 2 {
            return false;
        }
        let mut around: Vec<NodeId> =
            free.iter().flat_map(|&n| ring(mesh, n)).filter(|n| !corners.contains(n)).collect();
        around.sort_unstable();
        around.dedup();
        let parts = PARTS.into_iter().flat_map(|fineness| STEPS.map(|step| step * fineness));
        parts.flat_map(|part| around.iter().map(move |&to| (part, to))).any(|(part, to)| {
            let (mark, to) = (mesh.mark(), mesh.uv(to));
            let is_moved = free.iter().all(|&n| {
                let place = mesh.uv(n).lerp(to, part);
                self.source.metric(place).map(|metric| mesh.move_node(n, place, metric)).is_ok()
            });
            let is_better = is_moved && free.iter().all(|&n| mesh.can_move(n, mesh.uv(n)).is_ok()) && {
                self.improve_in_turn(mesh, &free);
                self.flaws(mesh, &corners) < before
            };
            if !is_better {
                mesh.take_back(mark);
            }
            is_better
        })
    }

    /// Moves free nodes in turn, each to where the least sine around it is greatest.
    pub(super) fn improve_in_turn(&self, mesh: &mut Mesh, nodes: &[NodeId]) {
        for _ in 0..ROUNDS {
            let moves = nodes.iter().filter(|&&node| self.improve(mesh, node)).count();
            if moves == 0 {
                break;
            }
        }
    }

    /// Moves a free node to where the least sine around it is greatest; whether there is a better place.
    fn improve(&self, mesh: &mut Mesh, node: NodeId) -> bool {
        if mesh.is_fixed(node) {
            return false;
        }
        let mut is_moved = false;
        let mut best = self.star_sine(mesh, node);
        let mut star = Star::of(mesh, node);
        // Steps by the size that is asked for, then by that of the elements that are there; then towards the nodes
        // around, and ever finer: in slivers there is no room for others, and in a facet that is flat in space the
        // metric does not show its width.
        let (from, metric) = (mesh.uv(node), mesh.metric(node));
        let shortest = mesh.neighbours(node).map(|n| metric.norm2(mesh.uv(n) - from)).fold(1.0, f64::min).sqrt();
        let around: Vec<DVec2> = ring(mesh, node).map(|n| mesh.uv(n)).collect();
        let stages = [Reach::Axes(1.0), Reach::Axes(shortest)].into_iter().chain(PARTS.map(Reach::Towards));
        for (reach, step) in stages.flat_map(|reach| STEPS.map(|step| (reach, step))) {
            let enough = if matches!(reach, Reach::Axes(_)) { ENOUGH } else { FOLDED };
            if best >= enough {
                break;
            }
            let (from, metric) = (mesh.uv(node), mesh.metric(node));
            let places: SmallVec<[DVec2; 16]> = match reach {
                Reach::Axes(size) => {
                    let axes = energy::unit_axes(&metric);
                    DIRECTIONS.iter().map(|[x, y]| from + (axes[0] * x + axes[1] * y) * (step * size)).collect()
                }
                Reach::Towards(part) => around.iter().map(|&to| from.lerp(to, step * part)).collect(),
            };
            let mut found: Option<(f64, DVec2, Metric2)> = None;
            for place in places {
                let least = found.map_or(best, |found| found.0);
                if mesh.can_move(node, place).is_err() {
                    continue;
                }
                let sine = star.least_sine_at(mesh, place, self.near, least);
                if sine > least
                    && let Ok(metric) = self.source.metric(place)
                {
                    found = Some((sine, place, metric));
                }
            }
            if let Some((sine, place, metric)) = found {
                mesh.move_node(node, place, metric);
                (best, is_moved) = (sine, true);
            }
        }
        is_moved
    }
}

/// The elements around a node, each with the corner that the node is.
struct Star(Vec<(Corners, usize)>);

impl Star {
    fn of(mesh: &Mesh, node: NodeId) -> Star {
        let of = |h: HalfEdgeId| (mesh.corners_in_space(h.element()), h.corner() as usize);
        Star(mesh.fan(node).map(of).collect())
    }

    /// The least sine of the elements with the node elsewhere; where it is not above `floor`, any number that is not.
    fn least_sine_at(&mut self, mesh: &Mesh, place: DVec2, near: f64, floor: f64) -> f64 {
        let embedding = mesh.embedding().map(|embedding| &**embedding);
        let xyz = embedding.map_or_else(|| place.extend(0.0), |embedding| embedding.atlas.xyz(place));
        let mut least = f64::INFINITY;
        for (corners, own) in &mut self.0 {
            corners.put(*own, place, xyz);
            least = least.min(corners.least_sine(embedding, near, floor));
            if least <= floor {
                break;
            }
        }
        least
    }
}

/// The other corners of the elements around a node.
fn ring(mesh: &Mesh, node: NodeId) -> impl Iterator<Item = NodeId> {
    mesh.elements_at(node).flat_map(|e| mesh.corners(e)).filter(move |&n| n != node)
}
