//! Division of curves at equal metric arclength, with even loops (docs/algorithm.md, "Curves divided at equal metric
//! length", "Even loops").

mod forced;
mod gaps;
mod hard;
mod loops;
mod ties;

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

pub use gaps::Gaps;
use loops::{Side, walks};
use ties::Tie;

use super::length::{Along, Piece, give, give_least, give_or_take, measure, share_out};
use crate::core::fault::Fault;
use crate::core::geometry::assembly::{loop_name, placed};
use crate::core::geometry::curve::distance_to_segment;
use crate::core::geometry::{CurveId, DirectedCurve, Domain, DomainCurve, Turning};
use crate::core::kernel::DisjointSets;
use crate::core::metric::{ForcedSide, MetricSource};

/// More segments than this on all curves together are refused, since such sizes must be an error.
const MOST_SEGMENTS: f64 = 2e7;

/// A divided domain: nodes on curves. Each curve is divided once, however many faces it bounds; on surfaces, all its
/// images are divided at the same points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DividedDomain {
    /// Coordinates of each node: first the vertices of the domain in their order, then the nodes inside curves.
    pub nodes: Vec<DVec2>,
    /// The nodes of each curve from its start to its end.
    pub chains: Vec<Vec<u32>>,
    /// The parameters of those nodes.
    pub parameters: Vec<Vec<f64>>,
    /// On surfaces: for each node the first node at the same point in space. Empty in the plane.
    pub joined: Vec<u32>,
    /// On surfaces: the point in space of each node. Empty in the plane.
    pub xyz: Vec<DVec3>,
    /// The number of curves with more segments than the sizes ask for, to keep their shape.
    pub shaped: usize,
    /// Nodes at hard points, each with the number of its point.
    pub hard: Vec<(u32, u32)>,
    /// The segments that are much shorter than the metric asks for.
    pub forced: Vec<ForcedSide>,
    /// Whether there are narrow gaps with nodes that face each other.
    pub is_facing: bool,
}

/// A segment shorter than this in the metric forces sizes: less than what rounding and even loops make of a longer
/// curve.
pub(super) const SHORT: f64 = 0.4;

/// The number of rounds in which loops are made even and facing pieces equal.
const EVENINGS: usize = 8;

/// The metric lengths of the curves and their numbers of segments.
pub struct Division<'a> {
    pub(super) domain: &'a Domain,
    metric: &'a dyn MetricSource,
    /// The smooth pieces of each curve, between its corners; empty for an image that follows another.
    pieces: Vec<Vec<Piece>>,
    /// Pieces that face each other across narrow gaps.
    ties: Vec<Tie>,
    /// For a side of a piece along a narrow gap that beyond the gap.
    across_gaps: BTreeMap<Side, Side>,
    /// Rows of quadrilaterals across each narrow gap.
    layers: u32,
    /// For each curve, whether it is divided by its turning too, because sizes alone would lose its shape.
    turns: Vec<bool>,
    /// The number of curves with more segments than the sizes ask for, to keep their shape.
    shaped: usize,
}

/// All of the division, for tests.
#[cfg(test)]
pub(super) fn divide(domain: &Domain, metric: &dyn MetricSource) -> Result<DividedDomain, Fault> {
    let mut division = Division::measure(domain, metric)?;
    division.even_out()?;
    division.nodes()
}

impl<'a> Division<'a> {
    /// Measures the curves and gives each the number of segments closest to its length, or the fixed one.
    ///
    /// # Errors
    /// If the metric fails, sizes are far too small, or a fixed number is less than the number of pieces.
    pub fn measure(domain: &'a Domain, metric: &'a dyn MetricSource) -> Result<Self, Fault> {
        let (pieces, ties) = (Vec::with_capacity(domain.curves.len()), Vec::new());
        let turns = vec![false; domain.curves.len()];
        let mut division =
            Division { domain, metric, pieces, ties, across_gaps: BTreeMap::new(), layers: 1, turns, shaped: 0 };
        let mut total = 0.0;
        for (id, curve) in domain.curves.iter().enumerate() {
            if curve.first.index() != id {
                division.pieces.push(Vec::new());
                continue;
            }
            let along = division.along(curve);
            let mut pieces = measure(&along, &hard::parameters(domain, curve.first))?;
            let length: f64 = curve.segments.map_or_else(|| pieces.iter().map(Piece::length).sum(), f64::from);
            total += length;
            bearable(curve, length, total)?;
            match curve.segments {
                None => {
                    pieces.iter_mut().for_each(|piece| piece.divide(&along));
                    give_least(&mut pieces, domain.least_segments(curve.first));
                    if let Some(turning) = &curve.turning {
                        division.shape(curve, turning, &mut pieces)?;
                    }
                    give_or_take(&mut pieces, domain.more_segments(curve.first));
                }
                Some(n) => {
                    if (n as usize) < pieces.len() {
                        let fault = Fault::new(format!(
                            "The curve \"{}\" has {} pieces between corners, but only {n} segments",
                            curve.name,
                            pieces.len()
                        ));
                        let remedy = format!("Give it at least {} segments", pieces.len());
                        return Err(placed(fault.remedy(remedy), &curve.place));
                    }
                    share_out(&mut pieces, n);
                }
            }
            division.pieces.push(pieces);
        }
        Ok(division)
    }

    /// What is measured along a curve.
    fn along(&self, curve: &'a DomainCurve) -> Along<'a> {
        let turning = curve.turning.as_deref().filter(|_| self.turns[curve.first.index()]);
        Along { images: self.domain.images(curve.first), metric: self.metric, turning }
    }

    /// Keeps the shape of a curve that is divided by its sizes: by a few segments more, or else by its turning.
    fn shape(&mut self, curve: &'a DomainCurve, turning: &Turning, pieces: &mut Vec<Piece>) -> Result<(), Fault> {
        let number = |pieces: &[Piece]| pieces.iter().map(|piece| piece.segments).sum::<u32>();
        let by_sizes = number(pieces);
        give_least(pieces, turning.least);
        let (along, mut keeps) = (self.along(curve), true);
        for piece in pieces.iter_mut() {
            keeps &= piece.keeps_shape(&along, turning)?;
        }
        if !keeps {
            self.turns[curve.first.index()] = true;
            let along = self.along(curve);
            *pieces = measure(&along, &hard::parameters(self.domain, curve.first))?;
            let length = pieces.iter().map(Piece::length).sum();
            bearable(curve, length, length)?;
            pieces.iter_mut().for_each(|piece| piece.divide(&along));
            give_least(pieces, turning.least);
        }
        self.shaped += usize::from(number(pieces) > by_sizes || !keeps);
        Ok(())
    }

    /// The number of segments of a curve.
    pub fn segments(&self, id: CurveId) -> u32 {
        self.pieces[self.first(id).index()].iter().map(|p| p.segments).sum()
    }

    /// The least number of segments of a curve.
    fn least(&self, curve: &DomainCurve) -> u32 {
        let closed = self.domain.least_segments(curve.first);
        curve.turning.as_ref().map_or(closed, |turning| turning.least.max(closed))
    }

    /// The piece of a curve that contains a parameter.
    fn piece_at(&self, id: CurveId, t: f64) -> usize {
        let pieces = &self.pieces[id.index()];
        pieces.partition_point(|piece| piece.end() < t).min(pieces.len() - 1)
    }

    /// The point of a curve at a parameter; its vertices at its ends.
    fn point(&self, id: CurveId, t: f64) -> DVec2 {
        let curve = &self.domain.curves[id.index()];
        if t == 0.0 {
            curve.first()
        } else if t == 1.0 {
            curve.last()
        } else {
            curve.curve.point(t)
        }
    }

    /// The curve that determines the division of this one.
    pub fn first(&self, id: CurveId) -> CurveId {
        self.domain.curves[id.index()].first
    }

    /// Whether a curve is an image of triangle edges.
    pub fn is_polygonal(&self, id: CurveId) -> bool {
        self.domain.curves[id.index()].curve.polygonal()
    }

    /// Refines a curve because of one of its chords, given by its parameters: an image of triangle edges at its point
    /// farthest from the chord, any other curve by about half of its segments. Adds even numbers; `false` if nothing
    /// changes.
    pub fn refine(&mut self, id: CurveId, chord: [f64; 2]) -> bool {
        let id = self.first(id);
        if self.is_polygonal(id) {
            return self.split_at_farthest(id, chord);
        }
        if self.domain.curves[id.index()].segments.is_some()
            || self.domain.images(id).iter().all(|image| image.curve.straight_between_corners())
        {
            return false;
        }
        let more = (self.segments(id) / 4 * 2).max(2);
        give(&mut self.pieces[id.index()], more);
        true
    }

    /// Makes a node of the point of a polygonal curve that is farthest from a chord, relative to the length of the
    /// chord.
    fn split_at_farthest(&mut self, id: CurveId, [from, to]: [f64; 2]) -> bool {
        let images = self.domain.images(id);
        let deviation = |t: f64| {
            let off = images.iter().map(|image| {
                let [a, b, p] = [from, to, t].map(|t| image.curve.point(t));
                distance_to_segment(p, a, b) / a.distance(b).max(f64::MIN_POSITIVE)
            });
            off.fold(0.0, f64::max)
        };
        let inside = images[0].fine.iter().map(|entry| entry.0).filter(|&t| from < t && t < to);
        let Some((_, t)) = inside.map(|t| (deviation(t), t)).max_by(|a, b| a.0.total_cmp(&b.0)) else { return false };
        let pieces = &mut self.pieces[id.index()];
        let Some(k) = pieces.iter().position(|piece| t < piece.end()) else { return false };
        let Some(parts) = pieces[k].split(t) else { return false };
        pieces.splice(k..=k, parts);
        true
    }

    /// Makes every boundary walk even, and gives walks and loops at least four segments. Pieces that face each other
    /// keep equal numbers, unless the loops cannot be even then.
    ///
    /// # Errors
    /// If fixed numbers do not allow that: names the loop with its number of segments.
    pub fn even_out(&mut self) -> Result<(), Fault> {
        for _ in 0..EVENINGS {
            if self.ties.is_empty() {
                break;
            }
            let loops = self.loops_beside_gaps();
            if self.even_once(&loops).is_err() {
                let loops = self.whole_loops();
                if self.even_once(&loops).is_err() {
                    break;
                }
            }
            self.fill_up()?;
            if !self.level_ties() {
                return Ok(());
            }
        }
        self.untie();
        let loops = self.whole_loops();
        self.even_once(&loops).map_err(|blamed| {
            let walks: Vec<_> = walks(self.domain).collect();
            let blamed: Vec<_> = blamed.iter().map(|&r| walks[r as usize]).collect();
            self.odd_fault(&blamed)
        })?;
        self.fill_up()
    }

    /// Gives walks and loops at least four segments.
    ///
    /// # Errors
    /// If fixed numbers do not allow that.
    fn fill_up(&mut self) -> Result<(), Fault> {
        let walks: Vec<_> = walks(self.domain).collect();
        // Curves that no walk traverses an odd number of times.
        let mut doubled = vec![true; self.pieces.len()];
        let single = walks.iter().flat_map(|(_, walk)| self.single_curves(walk));
        single.for_each(|c| doubled[c as usize] = false);
        let loops = self.domain.faces.iter().enumerate().flat_map(|(f, face)| face.loops.iter().map(move |l| (f, l)));
        for (f, steps) in loops.chain(walks) {
            while steps.iter().map(|s| self.segments(s.curve)).sum::<u32>() < 4 {
                let longest =
                    |id: CurveId| self.pieces[id.index()].iter().map(Piece::segment_length).fold(0.0, f64::max);
                let free = steps
                    .iter()
                    .map(|s| self.first(s.curve))
                    .filter(|id| self.domain.curves[id.index()].segments.is_none());
                let Some(id) = free.max_by(|a, b| longest(*a).total_cmp(&longest(*b)).then(b.cmp(a))) else {
                    return Err(self.loop_fault(f, steps, |name, n| {
                        Fault::new(format!("The {name} has {n} segments; it needs at least 4"))
                            .remedy("Give its curves more segments, or leave the numbers out")
                    }));
                };
                // One more segment on a line that is traversed twice keeps every loop even; other curves need two.
                give(&mut self.pieces[id.index()], if doubled[id.index()] { 1 } else { 2 });
            }
        }
        self.open_lenses();
        Ok(())
    }

    /// If two curves connect the same points in space, such as on both sides of a narrow gap, and one is bent and a
    /// single chord while the other is straight and divided, the nodes of the latter would lie on the chord of the
    /// former, which is therefore divided too.
    fn open_lenses(&mut self) {
        let Some(spatial) = self.domain.spatial.clone() else { return };
        let ends_of = |id: CurveId| {
            let mut ends = self.domain.curves[id.index()].ends.map(|v| spatial.vertex_of[v as usize]);
            ends.sort_unstable();
            ends
        };
        let ids = (0..self.pieces.len() as u32).map(CurveId);
        let mut by_ends: Vec<_> = ids.filter(|&id| self.first(id) == id).map(|id| (ends_of(id), id)).collect();
        by_ends.sort_unstable();
        for curves in by_ends.chunk_by(|a, b| a.0 == b.0) {
            if curves.iter().any(|&(_, id)| self.segments(id) > 1 && spatial.curves[id.index()].is_chord()) {
                for &(_, id) in curves {
                    if self.segments(id) == 1 && self.is_polygonal(id) {
                        self.refine(id, [0.0, 1.0]);
                    }
                }
            }
        }
    }

    /// A fault about a loop of a face, made from its name and its number of segments, with its place.
    fn loop_fault(&self, f: usize, steps: &[DirectedCurve], fault: impl Fn(&str, u32) -> Fault) -> Fault {
        let curve = &self.domain.curves[steps[0].curve.index()];
        let n = steps.iter().map(|s| self.segments(s.curve)).sum();
        placed(fault(&self.loop_name(f, steps), n), &curve.place)
    }

    fn loop_name(&self, f: usize, steps: &[DirectedCurve]) -> String {
        let face = &self.domain.faces[f];
        if steps.iter().all(|s| s.curve == steps[0].curve) {
            return format!("boundary loop \"{}\"", self.domain.curves[steps[0].curve.index()].name);
        }
        match face.loops.iter().position(|l| l.iter().any(|s| steps.contains(s))) {
            Some(i) => loop_name(&face.name, i),
            None => format!("loop of internal lines of \"{}\"", face.name),
        }
    }

    fn odd_fault(&self, blamed: &[(usize, &Vec<DirectedCurve>)]) -> Fault {
        let mut fixed: Vec<u32> = blamed.iter().flat_map(|(_, walk)| self.single_curves(walk)).collect();
        fixed.sort_unstable();
        let fixed: Vec<CurveId> = fixed
            .chunk_by(|a, b| a == b)
            .filter(|g| g.len() % 2 == 1)
            .map(|g| CurveId(g[0]))
            .filter(|id| self.domain.curves[id.index()].segments.is_some())
            .collect();
        let name = |id: &CurveId| format!("\"{}\"", self.domain.curves[id.index()].name);
        let remedy = match fixed.as_slice() {
            [one] => {
                let n = self.segments(*one);
                format!("Set the segments of {} to {} or {}, or leave the number out", name(one), n.max(2) - 1, n + 1)
            }
            several => {
                let names: Vec<String> = several.iter().map(name).collect();
                format!("Change the segments of one of {} by one, or leave one number out", names.join(", "))
            }
        };
        if let [(f, walk)] = blamed {
            return self.loop_fault(*f, walk, |name, n| {
                Fault::new(format!("The {name} has {n} segments; an all-quad mesh needs an even count"))
                    .remedy(remedy.clone())
            });
        }
        let names: Vec<String> = blamed.iter().map(|(f, walk)| format!("the {}", self.loop_name(*f, walk))).collect();
        let total: u32 = fixed.iter().map(|id| self.segments(*id)).sum();
        let fault = Fault::new(format!(
            "An all-quad mesh needs even loops, and {} cannot all be even: \
             their fixed curves have {total} segments together",
            names.join(", ")
        ));
        placed(fault.remedy(remedy), &self.domain.curves[blamed[0].1[0].curve.index()].place)
    }

    /// The curves of a walk except those that it traverses twice, ascending.
    fn single_curves(&self, walk: &[DirectedCurve]) -> Vec<u32> {
        let mut ids: Vec<u32> = walk.iter().map(|d| self.first(d.curve).0).collect();
        ids.sort_unstable();
        ids.chunk_by(|a, b| a == b).filter(|g| g.len() % 2 == 1).map(|g| g[0]).collect()
    }

    /// For each vertex of the plane the first vertex at the same point in space. Vertices are joined by the curves
    /// whose images end in them: faces, or sides of a cut, that meet in a point but share no curve remain separate.
    fn joined_vertices(&self) -> Vec<u32> {
        let mut sets = DisjointSets::new(self.domain.vertices.len());
        for curve in &self.domain.curves {
            let first = &self.domain.curves[curve.first.index()];
            sets.join(curve.ends[0], first.ends[0]);
            sets.join(curve.ends[1], first.ends[1]);
        }
        (0..self.domain.vertices.len() as u32).map(|v| sets.find(v)).collect()
    }

    /// The nodes, at equal metric arclength in each piece of each curve.
    ///
    /// # Errors
    /// If the metric fails.
    pub fn nodes(&self) -> Result<DividedDomain, Fault> {
        let mut divided =
            DividedDomain { nodes: self.domain.vertices.clone(), shaped: self.shaped, ..DividedDomain::default() };
        if let Some(spatial) = &self.domain.spatial {
            divided.joined = self.joined_vertices();
            divided.xyz = spatial.vertex_of.iter().map(|&v| spatial.vertices[v as usize]).collect();
        }
        let facing = self.facing_places()?;
        divided.is_facing = !facing.is_empty();
        // The parameters of the last first image.
        let mut parameters: Vec<f64> = Vec::new();
        for (c, curve) in self.domain.curves.iter().enumerate() {
            let is_first = curve.first.index() == c;
            if is_first {
                parameters.clear();
                let (pieces, along) = (&self.pieces[c], self.along(curve));
                for (i, piece) in pieces.iter().enumerate() {
                    match facing.get(&(curve.first, i)) {
                        Some(places) => parameters.extend(places),
                        None => parameters.extend(piece.divisions(&along)?),
                    }
                    if i + 1 < pieces.len() {
                        parameters.push(piece.end());
                    }
                }
            }
            let mut chain = vec![curve.ends[0]];
            for (k, &t) in parameters.iter().enumerate() {
                let node = divided.nodes.len() as u32;
                chain.push(node);
                divided.nodes.push(curve.curve.point(t));
                if let Some(spatial) = &self.domain.spatial {
                    // Images of one curve are consecutive, beginning with the first.
                    divided.joined.push(if is_first { node } else { divided.chains[curve.first.index()][k + 1] });
                    divided.xyz.push(spatial.curves[c].point(t));
                }
            }
            chain.push(curve.ends[1]);
            self.push_forced(&mut divided, c, &chain)?;
            divided.chains.push(chain);
            divided.parameters.push([0.0].into_iter().chain(parameters.iter().copied()).chain([1.0]).collect());
        }
        hard::place(self.domain, &mut divided);
        Ok(divided)
    }
}

/// Refuses a curve that is this long, where this many segments on all curves are too many.
fn bearable(curve: &DomainCurve, length: f64, total: f64) -> Result<(), Fault> {
    if total <= MOST_SEGMENTS {
        return Ok(());
    }
    let fault = Fault::new(format!("The curve \"{}\" would get {length:.3e} segments", curve.name));
    Err(placed(fault.remedy("Increase the sizes along it, or give fewer segments"), &curve.place))
}

#[cfg(test)]
pub(super) mod tests;
