//! Quadrilaterals that fold over their surface, mended one at a time after the last smoothing. Everything before works in the
//! parametric plane, where all stays strictly convex; between straight sides in space a corner may still turn against the surface,
//! or a node between two faces have two edges only. The nodes around are moved first; where that does not help the
//! quadrilateral is pillowed: a smaller one is inlaid, with four between the two.

use std::sync::Arc;

use glam::DVec2;

use super::energy;
use super::event::{Event, Mending};
use super::worklist::{ListMark, Worklist};
use crate::core::mesh::half_edge::{Mesh, NewElement};
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::mesh::refusals::Operation;
use crate::core::metric::field::MetricSource;
use crate::core::metric::tensor::Metric2;

/// A quadrilateral with a corner whose sine against the surface is below this is to be mended.
const FOLDED: f64 = 1e-3;
/// Nodes are moved until the sines around are this large; larger is not better here.
const ENOUGH: f64 = 0.1;
/// Steps of a search for a better place, by the metric at the node, and the directions of each.
const STEPS: [f64; 5] = [0.4, 0.2, 0.1, 0.05, 0.02];
const DIRECTIONS: [[f64; 2]; 8] =
    [[1.0, 0.0], [0.7, 0.7], [0.0, 1.0], [-0.7, 0.7], [-1.0, 0.0], [-0.7, -0.7], [0.0, -1.0], [0.7, -0.7]];
/// How often the nodes at hand are moved in turn.
const ROUNDS: usize = 4;
/// How far the nodes of an inlaid quadrilateral lie from the corners towards the middle.
const INLAID: [f64; 3] = [0.4, 0.6, 0.25];
/// Looks at one quadrilateral that folds at the start, on average: what was mended may send its neighbours to be looked at.
const LOOKS: usize = 24;

/// What was mended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unfolded {
    /// Quadrilaterals that no longer fold since nodes were moved.
    pub moved: usize,
    /// Quadrilaterals that were pillowed.
    pub pillowed: usize,
}

/// The mending under way.
#[derive(Clone)]
pub(super) struct Unfolding<'a> {
    source: Arc<dyn MetricSource + Send + Sync + 'a>,
    /// Nodes of quadrilaterals that are to be mended.
    list: Worklist,
    /// Nodes of two faces with two edges between both, and one of each quadrilateral that has the points of another; ascending.
    shared: Vec<NodeId>,
}

impl<'a> Unfolding<'a> {
    /// The mending at its beginning.
    pub fn begin(mesh: &Mesh, source: Arc<dyn MetricSource + Send + Sync + 'a>, recording: bool) -> Unfolding<'a> {
        let mut shared = doublets(mesh);
        shared.extend(doubles(mesh));
        shared.sort_unstable();
        let folded = folded(mesh);
        let mut list = Worklist::new(LOOKS * (folded.len() + shared.len()), recording);
        for e in folded {
            list.add(mesh.quad(e)[0]);
        }
        shared.iter().for_each(|&node| list.add(node));
        Unfolding { source, list, shared }
    }

    pub fn list(&self) -> &Worklist {
        &self.list
    }

    pub fn list_mut(&mut self) -> &mut Worklist {
        &mut self.list
    }

    /// Takes the list back to a mark.
    pub fn take_back(&mut self, mark: ListMark) {
        self.list.take_back(mark);
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        self.list.bytes() + size_of::<NodeId>() * self.shared.capacity()
    }

    /// Mends the next quadrilateral; what cannot be mended is passed over. None where nothing waits any more.
    pub fn step(&mut self, mesh: &mut Mesh, keep_journal: bool) -> Option<Event> {
        while let Some(node) = self.list.take() {
            if !mesh.has_node(node) {
                continue;
            }
            let worst = mesh.fan(node).map(|h| h.element()).filter(|&e| mesh.is_quad(e));
            let worst = worst.map(|e| (sine(mesh, e), e)).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let Some((before, element)) = worst else { continue };
            let mut nodes: Vec<NodeId> = mesh.corners(element).collect();
            let is_shared = self.shared.binary_search(&node).is_ok() && mesh.fan(node).count() == 1;
            let how = if before < FOLDED && self.moved(mesh, element) {
                Some(Mending::Moved)
            } else if before < FOLDED || is_shared {
                self.pillowed(mesh, element).map(|inner| {
                    nodes.extend(inner);
                    Mending::Pillowed { inner }
                })
            } else {
                None
            };
            if how.is_some() {
                for &n in &nodes {
                    let folds = |e: ElementId| mesh.is_quad(e) && sine(mesh, e) < FOLDED;
                    if mesh.fan(n).any(|h| folds(h.element())) {
                        self.list.add(n);
                    }
                }
            }
            if !keep_journal {
                mesh.commit();
            }
            if let Some(how) = how {
                let after = mesh.fan(nodes[0]).map(|h| sine(mesh, h.element())).fold(f64::INFINITY, f64::min);
                return Some(Event::Unfolded { element, how, sine: [before, after] });
            }
        }
        None
    }

    /// Moves the free corners of a quadrilateral in turn, each to where the least sine around it is greatest. Whether the
    /// quadrilateral no longer folds, and nothing around that did not; otherwise all is as before.
    fn moved(&self, mesh: &mut Mesh, element: ElementId) -> bool {
        let corners = mesh.quad(element);
        let around = |mesh: &Mesh| {
            let elements = corners.iter().flat_map(|&n| mesh.fan(n).map(|h| h.element()));
            elements.map(|e| sine(mesh, e)).fold(f64::INFINITY, f64::min)
        };
        let (mark, before) = (mesh.mark(), around(mesh));
        for _ in 0..ROUNDS {
            for node in corners {
                self.improve(mesh, node);
            }
            if sine(mesh, element) >= ENOUGH {
                break;
            }
        }
        let is_better = sine(mesh, element) >= FOLDED && around(mesh) >= before.min(FOLDED);
        if !is_better {
            mesh.take_back(mark);
        }
        is_better
    }

    /// Moves a free node to where the least sine around it is greatest.
    fn improve(&self, mesh: &mut Mesh, node: NodeId) {
        if mesh.is_fixed(node) {
            return;
        }
        let mut best = star_sine(mesh, node);
        for step in STEPS {
            if best >= ENOUGH {
                return;
            }
            let (from, metric) = (mesh.uv(node), mesh.metric(node));
            let axes = energy::unit_axes(&metric);
            let mut found: Option<(f64, DVec2, Metric2)> = None;
            for [x, y] in DIRECTIONS {
                let place = from + (axes[0] * x + axes[1] * y) * step;
                let (Ok(metric), Ok(())) = (self.source.metric(place), mesh.can_move(node, place)) else { continue };
                let mark = mesh.mark();
                mesh.move_node(node, place, metric);
                let sine = star_sine(mesh, node);
                mesh.take_back(mark);
                if sine > found.map_or(best, |found| found.0) {
                    found = Some((sine, place, metric));
                }
            }
            if let Some((sine, place, metric)) = found {
                mesh.move_node(node, place, metric);
                best = sine;
            }
        }
    }

    /// Inlays a quadrilateral; its nodes. None where what comes of it would fold too.
    fn pillowed(&self, mesh: &mut Mesh, element: ElementId) -> Option<[NodeId; 4]> {
        let corners = mesh.quad(element);
        mesh.permit(Operation::Pillow, &corners).ok()?;
        let (p, region) = (corners.map(|n| mesh.uv(n)), mesh.region(element));
        let middle = p.iter().sum::<DVec2>() * 0.25;
        INLAID.iter().find_map(|&part| {
            let mark = mesh.mark();
            let places = p.map(|p| p.lerp(middle, part));
            let metrics = places.map(|place| self.source.metric(place).ok());
            let inner = match metrics {
                [Some(a), Some(b), Some(c), Some(d)] => [a, b, c, d],
                _ => return None,
            };
            let mut at = places.into_iter().zip(inner);
            let inner: [NodeId; 4] = std::array::from_fn(|_| {
                let (place, metric) = at.next().expect("there are four");
                mesh.add_node(place, metric)
            });
            let mut new = vec![NewElement::quad(inner, region)];
            for k in 0..4 {
                let l = (k + 1) % 4;
                new.push(NewElement::quad([corners[k], corners[l], inner[l], inner[k]], region));
            }
            let made = mesh.replace(&[element], &new);
            let is_convex = made.iter().all(|&e| mesh.stays_positive(e, mesh.quad(e)[0], mesh.uv(mesh.quad(e)[0])));
            if is_convex {
                for _ in 0..ROUNDS {
                    inner.iter().for_each(|&node| self.improve(mesh, node));
                }
                if made.iter().all(|&e| sine(mesh, e) >= FOLDED) {
                    return Some(inner);
                }
            }
            mesh.take_back(mark);
            None
        })
    }
}

/// The least sine of a quadrilateral's corners in space, against its own normal and that of the surface; 0 or less where it folds.
fn sine(mesh: &Mesh, e: ElementId) -> f64 {
    mesh.least_sine(e)
}

fn star_sine(mesh: &Mesh, node: NodeId) -> f64 {
    mesh.fan(node).map(|h| sine(mesh, h.element())).fold(f64::INFINITY, f64::min)
}

/// Quadrilaterals that fold, ascending.
fn folded(mesh: &Mesh) -> Vec<ElementId> {
    mesh.elements().filter(|&e| mesh.is_quad(e) && sine(mesh, e) < FOLDED).collect()
}

/// Nodes between two faces, each with one quadrilateral there, that have but two edges in space: one of both copies, ascending.
fn doublets(mesh: &Mesh) -> Vec<NodeId> {
    let mut at_point: Vec<(u32, NodeId)> = mesh.nodes().filter_map(|n| Some((mesh.point(n)?.0, n))).collect();
    at_point.sort_unstable();
    let mut found = Vec::new();
    for copies in at_point.chunk_by(|a, b| a.0 == b.0) {
        let &[(_, a), (_, b)] = copies else { continue };
        let others = |n: NodeId| {
            let mut points: Vec<_> = mesh.neighbours(n).map(|n| mesh.point(n)).collect();
            points.sort_unstable();
            points
        };
        if mesh.fan(a).count() == 1 && mesh.fan(b).count() == 1 && others(a) == others(b) {
            found.push(a);
        }
    }
    found
}

/// A node of each quadrilateral whose points are those of an earlier one on another face: it is alone there, and so are the others.
fn doubles(mesh: &Mesh) -> Vec<NodeId> {
    let alone = |e: ElementId| mesh.half_edges(e).all(|h| mesh.twin(h).is_none());
    let mut quads: Vec<([u32; 4], ElementId)> = Vec::new();
    for e in mesh.elements().filter(|&e| mesh.is_quad(e) && alone(e)) {
        let mut points = mesh.quad(e).map(|n| mesh.point(n).map_or(u32::MAX, |p| p.0));
        points.sort_unstable();
        quads.push((points, e));
    }
    quads.sort_unstable();
    let later = quads.windows(2).filter(|w| w[0].0 == w[1].0);
    later.map(|w| mesh.quad(w[1].1)[0]).collect()
}
