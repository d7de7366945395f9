//! Repair of quadrilaterals that fold over their surface, one at a time after the last smoothing. Everything before
//! works in the parametric plane, where all stays strictly convex; between straight sides in space a corner may still
//! turn against the surface, or a node between two faces have two edges only, or what lies on two faces come to one
//! place. The nodes around are moved first (`moving`); where that does not help the quadrilateral has an edge rotated,
//! is collapsed along a diagonal, or pillowed: a smaller one is inlaid, with four between the two. What is flat or
//! turned even then has its nodes moved in every way that is left.

mod moving;

use std::sync::Arc;

use glam::{DVec2, DVec3};

use self::moving::DIRECTIONS;
use super::worklist::Worklist;
use crate::core::convert::event::{Event, Mending};
use crate::core::convert::relax::{Nodes, elements_around, energy, put, settle};
use crate::core::convert::sums::summed;
use crate::core::mesh::{ElementId, Mesh, NewElement, NodeId, Operation, PointId};
use crate::core::metric::MetricSource;
use crate::core::progress::Cancel;
use crate::core::soup::weld::weld;

/// A quadrilateral with a corner whose sine against the surface is below this is to be repaired.
const FOLDED: f64 = 1e-3;
/// One below this is flat or inverted to any reader. In the slivers of a surface many remain between the two.
const FLAT: f64 = 1e-7;
/// How far a node is moved from the place of another.
const STIRRED: f64 = 0.05;
/// Nodes nearer than this part of the largest coordinate are at one place.
const SAME_PLACE: f64 = 4e-9;
/// How far the nodes of an inlaid quadrilateral lie from the corners towards the middle.
const INLAID: [f64; 5] = [0.4, 0.6, 0.25, 0.5, 0.33];
/// Looks at one quadrilateral that folds at the start, on average: a repair may send its neighbours to be looked at.
const LOOKS: usize = 24;

summed! {
/// Repairs that were made.
pub struct Unfolded {
    /// Times that nodes were moved.
    pub moved: usize,
    /// Edges that were rotated.
    pub rotated: usize,
    /// Quadrilaterals that were collapsed.
    pub collapsed: usize,
    /// Quadrilaterals that were pillowed.
    pub pillowed: usize,
}
}

/// The repair under way.
#[derive(Clone)]
pub(super) struct Unfolding<'a> {
    source: Arc<dyn MetricSource + Send + Sync + 'a>,
    /// Nodes of quadrilaterals to be repaired.
    pub list: Worklist,
    /// Nodes of two faces with two edges between both, each with its copy on the other face, ascending.
    doublets: Vec<[NodeId; 2]>,
    /// The points of quadrilaterals that a later one on another face has too, each ascending, all ascending.
    doubles: Vec<[PointId; 4]>,
    /// Free nodes at the place of another in space, ascending.
    coincident: Vec<NodeId>,
    /// The nodes on borders by their points, ascending: they never change.
    copies: Vec<(PointId, NodeId)>,
    /// Nodes of an element nearer than this in space are at one place.
    near: f64,
}

impl<'a> Unfolding<'a> {
    /// The repair at its beginning.
    pub fn begin(mesh: &Mesh, source: Arc<dyn MetricSource + Send + Sync + 'a>, recording: bool) -> Unfolding<'a> {
        let mut copies: Vec<_> = mesh.nodes().filter_map(|n| Some((mesh.point(n)?, n))).collect();
        copies.sort_unstable();
        let (doublets, (doubles, later)) = (doublets(mesh, &copies), doubles(mesh));
        let (coincident, near) = coincident(mesh, &copies);
        let list = Worklist::new(0, false);
        let mut work = Unfolding { source, list, doublets, doubles, coincident, copies, near };
        let folded: Vec<ElementId> = mesh.elements().filter(|&e| work.folds(mesh, e)).collect();
        let all = folded.len() + later.len() + work.doublets.len() + work.coincident.len();
        work.list = Worklist::new(LOOKS * all, recording);
        folded.iter().chain(&later).for_each(|&e| work.list.add(mesh.quad(e)[0]));
        work.doublets.iter().for_each(|&[node, _]| work.list.add(node));
        work.coincident.iter().for_each(|&node| work.list.add(node));
        work
    }

    /// Bytes that it takes beside its list.
    pub fn bytes_of_rest(&self) -> usize {
        size_of::<NodeId>() * (2 * self.doublets.capacity() + self.coincident.capacity())
            + size_of::<[PointId; 4]>() * self.doubles.capacity()
            + size_of::<(PointId, NodeId)>() * self.copies.capacity()
    }

    /// Repairs the next quadrilateral; what cannot be repaired is skipped. None where nothing waits any more.
    pub fn step(&mut self, mesh: &mut Mesh, keep_journal: bool) -> Option<Event> {
        while let Some(node) = self.list.take() {
            if !mesh.has_node(node) {
                continue;
            }
            let Some((before, element)) = self.at_fault(mesh, node) else { continue };
            let mut nodes: Vec<NodeId> = mesh.corners(element).collect();
            let how = if before >= FOLDED && self.coincident.binary_search(&node).is_ok() {
                self.stirred(mesh, node).then_some(Mending::Moved)
            } else if before < FOLDED && self.moved_or_nudged(mesh, element) {
                Some(Mending::Moved)
            } else if before < FOLDED
                && let Some(new) = self.rotated(mesh, element, None)
            {
                nodes.extend(new);
                Some(Mending::Rotated { new })
            } else if before < FOLDED
                && let Some(kept) = self.collapsed(mesh, element)
            {
                nodes.retain(|&n| mesh.has_node(n));
                Some(Mending::Collapsed { kept })
            } else {
                let pillowed = self.pillowed(mesh, element).map(|inner| {
                    nodes.extend(inner);
                    Mending::Pillowed { inner }
                });
                let is_doublet = before >= FOLDED && self.is_doublet(mesh, node);
                let rotated = pillowed.or_else(|| {
                    let new = is_doublet.then(|| self.rotated(mesh, element, Some(node))).flatten()?;
                    nodes.extend(new);
                    Some(Mending::Rotated { new })
                });
                rotated.or_else(|| (before < FLAT && self.moved_anyhow(mesh, element)).then_some(Mending::Moved))
            };
            if how.is_some() {
                for &n in &nodes {
                    let waits =
                        |e: ElementId| mesh.is_quad(e) && (self.sine(mesh, e) < FOLDED || self.is_double(mesh, e));
                    if mesh.elements_at(n).any(waits) {
                        self.list.add(n);
                    }
                }
            }
            if !keep_journal {
                mesh.commit();
            }
            if let Some(how) = how {
                let after = self.star_sine(mesh, nodes[0]);
                return Some(Event::Unfolded { element, how, sine: [before, after] });
            }
        }
        None
    }

    /// The quadrilateral at a node that is to be repaired, and its least sine: the worst one that folds; else one that
    /// has the points of another, or makes a doublet with another, or any where the node lies on another.
    fn at_fault(&self, mesh: &Mesh, node: NodeId) -> Option<(f64, ElementId)> {
        let quads = || mesh.elements_at(node).filter(|&e| mesh.is_quad(e));
        let worst = quads().map(|e| (self.sine(mesh, e), e)).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        if worst.0 < FOLDED {
            return Some(worst);
        }
        if let Some(double) = quads().find(|&e| self.is_double(mesh, e)) {
            return Some((self.sine(mesh, double), double));
        }
        let is_doublet = self.is_doublet(mesh, node);
        (is_doublet || self.coincident.binary_search(&node).is_ok()).then_some(worst)
    }

    fn is_doublet(&self, mesh: &Mesh, node: NodeId) -> bool {
        let pair = self.doublets.binary_search_by_key(&node, |pair| pair[0]).ok().map(|k| self.doublets[k]);
        pair.is_some_and(|pair| pair.iter().all(|&n| mesh.fan(n).count() == 1))
    }

    fn is_double(&self, mesh: &Mesh, e: ElementId) -> bool {
        points(mesh, e).is_some_and(|points| self.doubles.binary_search(&points).is_ok())
    }

    /// The least sine of a quadrilateral's corners in space, against its own normal and that of the surface: 0 or less
    /// where it folds, and where a side is nothing.
    fn sine(&self, mesh: &Mesh, e: ElementId) -> f64 {
        mesh.least_sine(e, self.near)
    }

    /// The least sine of the elements around a node.
    fn star_sine(&self, mesh: &Mesh, node: NodeId) -> f64 {
        mesh.elements_at(node).map(|e| self.sine(mesh, e)).fold(f64::INFINITY, f64::min)
    }

    fn folds(&self, mesh: &Mesh, e: ElementId) -> bool {
        mesh.is_quad(e) && self.sine(mesh, e) < FOLDED
    }

    /// How many elements around nodes are flat or turned, and how many fold.
    fn flaws(&self, mesh: &Mesh, nodes: &[NodeId]) -> [usize; 2] {
        let quads = elements_around(mesh, nodes).into_iter().filter(|&e| mesh.is_quad(e));
        let sines: Vec<f64> = quads.map(|e| self.sine(mesh, e)).collect();
        [FLAT, FOLDED].map(|least| sines.iter().filter(|&&sine| sine < least).count())
    }

    /// Moves a free node a little, to leave the place of another; whether that folds nothing.
    fn stirred(&self, mesh: &mut Mesh, node: NodeId) -> bool {
        let axes = energy::unit_axes(&mesh.metric(node));
        DIRECTIONS.iter().any(|&[x, y]| {
            let place = mesh.uv(node) + (axes[0] * x + axes[1] * y) * STIRRED;
            let (Ok(metric), Ok(())) = (self.source.metric(place), mesh.can_move(node, place)) else { return false };
            let mark = mesh.mark();
            mesh.move_node(node, place, metric);
            let folds = self.star_sine(mesh, node) < FOLDED;
            if folds {
                mesh.take_back(mark);
            }
            !folds
        })
    }

    /// Rotates an edge of a quadrilateral; the ends that it has then. None where not fewer elements around fold then;
    /// for a node that needs an edge more, where it gets none, or more fold.
    fn rotated(&self, mesh: &mut Mesh, element: ElementId, needy: Option<NodeId>) -> Option<[NodeId; 2]> {
        for h in mesh.half_edges(element).collect::<Vec<_>>() {
            let Ok(ring) = mesh.hexagon(h) else { continue };
            let before = self.flaws(mesh, &ring);
            for by in [1, 2] {
                let mark = mesh.mark();
                let core = Nodes::from_slice(&ring);
                if mesh.rotate_edge(h, by).is_ok() && settle(mesh, &*self.source, &core) {
                    self.improve_in_turn(mesh, &core);
                    let after = self.flaws(mesh, &ring);
                    let is_better = match needy {
                        None => after < before,
                        Some(node) => after <= before && mesh.fan(node).count() > 1,
                    };
                    if is_better {
                        return Some([ring[by], ring[by + 3]]);
                    }
                }
                mesh.take_back(mark);
            }
        }
        None
    }

    /// Merges two opposite corners of a quadrilateral, so that it goes; the node that both become. None where not fewer
    /// elements around fold then.
    fn collapsed(&self, mesh: &mut Mesh, element: ElementId) -> Option<NodeId> {
        let before = self.flaws(mesh, &mesh.quad(element));
        for h_ab in mesh.half_edges(element).collect::<Vec<_>>() {
            let mark = mesh.mark();
            let [a, b, c, d] = [0, 1, 2, 3].map(|i| mesh.origin(element.half_edge((h_ab.corner() + i) % 4)));
            let middle = mesh.uv(a).midpoint(mesh.uv(c));
            if mesh.collapse_diamond(h_ab).is_ok()
                && (mesh.is_fixed(c) || put(mesh, &*self.source, c, middle))
                && settle(mesh, &*self.source, &Nodes::from_slice(&[b, c, d]))
            {
                let core = [b, c, d];
                self.improve_in_turn(mesh, &core);
                if self.flaws(mesh, &core) < before {
                    return Some(c);
                }
            }
            mesh.take_back(mark);
        }
        None
    }

    /// Places in space of the free nodes around the copies of a node on other faces.
    fn free_beside(&self, mesh: &Mesh, node: NodeId) -> Vec<DVec3> {
        let Some(point) = mesh.point(node) else { return Vec::new() };
        let copies = &self.copies[self.copies.partition_point(|copy| copy.0 < point)..];
        let others = copies.iter().take_while(|copy| copy.0 == point).map(|copy| copy.1).filter(|&n| n != node);
        let elements = others.flat_map(|n| mesh.elements_at(n));
        let free = elements.flat_map(|e| mesh.corners(e)).filter(|&n| !mesh.is_fixed(n));
        free.map(|n| mesh.xyz(n)).collect()
    }

    /// Inlays a quadrilateral; its nodes. None where what comes of it would fold too.
    fn pillowed(&self, mesh: &mut Mesh, element: ElementId) -> Option<[NodeId; 4]> {
        let corners = mesh.quad(element);
        mesh.permit(Operation::Pillow, &corners).ok()?;
        let (p, region) = (corners.map(|n| mesh.uv(n)), mesh.region(element));
        let middle = p.iter().sum::<DVec2>() * 0.25;
        // Where another sheet lies on this one, the inner nodes must not come to its own.
        let beside: Vec<DVec3> = corners.iter().flat_map(|&n| self.free_beside(mesh, n)).collect();
        INLAID.iter().find_map(|&part| {
            let mark = mesh.mark();
            let places = p.map(|p| p.lerp(middle, part));
            let embedding = mesh.embedding()?;
            let lies_on = |place: &DVec2| beside.iter().any(|q| embedding.atlas.xyz(*place).distance(*q) <= self.near);
            if places.iter().any(lies_on) {
                return None;
            }
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
                self.improve_in_turn(mesh, &inner);
                if made.iter().all(|&e| self.sine(mesh, e) >= FOLDED) {
                    return Some(inner);
                }
            }
            mesh.take_back(mark);
            None
        })
    }
}

/// Nodes with one quadrilateral on each of two faces and only two edges in space: each copy with the other, ascending.
fn doublets(mesh: &Mesh, copies: &[(PointId, NodeId)]) -> Vec<[NodeId; 2]> {
    let mut found = Vec::new();
    for copies in copies.chunk_by(|a, b| a.0 == b.0) {
        let &[(_, a), (_, b)] = copies else { continue };
        let others = |n: NodeId| {
            let mut points: Vec<_> = mesh.neighbours(n).map(|n| mesh.point(n)).collect();
            points.sort_unstable();
            points
        };
        if mesh.fan(a).count() == 1 && mesh.fan(b).count() == 1 && others(a) == others(b) {
            found.extend([[a, b], [b, a]]);
        }
    }
    found.sort_unstable();
    found
}

/// The points of a quadrilateral whose nodes all lie on borders, ascending.
fn points(mesh: &Mesh, e: ElementId) -> Option<[PointId; 4]> {
    let [a, b, c, d] = mesh.quad(e).map(|n| mesh.point(n));
    let mut points = [a?, b?, c?, d?];
    points.sort_unstable();
    Some(points)
}

/// The points of quadrilaterals that have those of an earlier one on another face, and these quadrilaterals.
fn doubles(mesh: &Mesh) -> (Vec<[PointId; 4]>, Vec<ElementId>) {
    let quads = mesh.elements().filter(|&e| mesh.is_quad(e));
    let mut quads: Vec<([PointId; 4], ElementId)> = quads.filter_map(|e| Some((points(mesh, e)?, e))).collect();
    quads.sort_unstable();
    quads.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| w[1]).unzip()
}

/// Free nodes at the place of another node in space, ascending: two sheets of the surface lie on each other there. And
/// how near that is.
fn coincident(mesh: &Mesh, copies: &[(PointId, NodeId)]) -> (Vec<NodeId>, f64) {
    // Fixed nodes first, so that free ones are found to be where those are; of several at one point only the first.
    let mut nodes: Vec<NodeId> = copies.chunk_by(|a, b| a.0 == b.0).map(|at_point| at_point[0].1).collect();
    nodes.extend(mesh.nodes().filter(|&n| !mesh.is_fixed(n)));
    let mut places: Vec<DVec3> = nodes.iter().map(|&n| mesh.xyz(n)).collect();
    let near = SAME_PLACE * places.iter().fold(0.0, |largest, p| p.abs().max_element().max(largest));
    let standing = weld(&mut places, SAME_PLACE, &Cancel::default());
    // A place is kept under a new number the first time it is seen.
    let mut next = 0;
    let is_later = |at: &u32| {
        let is_new = *at == next;
        next += u32::from(is_new);
        !is_new
    };
    let later: Vec<bool> = standing.iter().map(is_later).collect();
    let mut found: Vec<NodeId> =
        nodes.iter().zip(later).filter(|(n, later)| *later && !mesh.is_fixed(**n)).map(|(n, _)| *n).collect();
    found.sort_unstable();
    (found, near)
}
