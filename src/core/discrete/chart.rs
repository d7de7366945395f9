//! Charts: parts of a surface of triangles that can be laid into the plane one to one (docs/algorithm.md, "Charts of
//! triangles").
//!
//! The features divide the surface into parts. A part with holes whose map stretches too much is slit from one border
//! to another along the shortest path; a part that is not a disc for another reason, or that stretches too much, is cut
//! in two between its two most distant triangles, recursively. Along a slit, or a feature that ends inside a chart, the
//! chart has two nodes at each point. If the texture coordinates of the file are a good enough map of a part, they give
//! its charts.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec2, DVec3};

use super::as_rigid_as_possible;
use super::edges::{Corner, Edges, Groups, Triangles};
use super::features::Feature;
use super::planar_map::{Stretch, StretchBound, stretch};
use super::tutte;
use crate::core::fault::Fault;
use crate::core::kernel::DisjointSets;
use crate::core::progress::{Cancel, Stage, Watch};

/// Triangles with their map to the plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Its triangles, as ascending indices into the surface.
    pub triangles: Vec<u32>,
    /// Their corners, as indices into `points` and `uv`.
    pub local: Vec<[u32; 3]>,
    /// The surface point of each node; two nodes at a slit share one.
    pub points: Vec<u32>,
    /// Number of nodes of each border loop. These nodes come first, loop after loop, with the chart to their left.
    pub loops: Vec<u32>,
    /// Position of each node in the plane: as rigid as possible, or if that is not injective, Tutte's embedding.
    pub uv: Vec<DVec2>,
    /// The stretch of the map.
    pub stretch: Stretch,
}

/// A chart with holes beyond this stretch is slit.
const WITH_HOLES: StretchBound = StretchBound { shape: 2.0, area: 4.0 };

/// A part with more triangles is cut without an attempt to map it: its halves take less time and memory, and are
/// converted in parallel.
const MOST_TRIANGLES: usize = 1 << 18;
/// Triangles processed between two checks for cancellation.
const BATCH: usize = 1 << 12;

/// Cuts a surface into charts, sorted by their first triangles.
///
/// # Errors
/// [`Fault::stopped`].
pub fn charts(
    mesh: &Triangles,
    edges: &Edges,
    features: &[Option<Feature>],
    bound: StretchBound,
    watch: &mut dyn Watch,
) -> Result<Vec<Chart>, Fault> {
    let cancel = watch.cancel();
    cancel.check()?;
    let total = mesh.triangles.len() as u64;
    watch.tell(Stage::Chart, 0, total);
    let surface = CutSurface::new(mesh, edges, features, cancel.clone());
    let all = SurfacePart::of((0..mesh.triangles.len() as u32).collect());
    let mut waiting = surface.connected(&all);
    let (mut charts, mut done, mut shown) = (Vec::new(), 0, 0);
    waiting.retain(|part| match surface.textured(part, bound) {
        Some(found) => {
            done += part.triangles.len() as u64;
            charts.extend(found);
            false
        }
        None => true,
    });
    while let Some(part) = waiting.pop() {
        // The result of cancelled work is invalid.
        cancel.check()?;
        shown = shown.max(done);
        watch.tell(Stage::Chart, shown, total);
        let mut tell = |share: f64| {
            // Half, since the part may still be cut; progress never goes back.
            shown = shown.max(done + (0.5 * share * part.triangles.len() as f64) as u64);
            watch.tell(Stage::Chart, shown, total);
        };
        let next = surface.chart(&part, bound, &mut tell);
        cancel.check()?;
        match next {
            Next::Accept(chart) => {
                done += chart.triangles.len() as u64;
                charts.push(*chart);
            }
            Next::Slit(slits) => waiting.push(SurfacePart { slits, ..part }),
            Next::Cut => {
                for half in surface.halves(&part) {
                    waiting.extend(surface.connected(&SurfacePart::of(half)));
                }
            }
        }
    }
    cancel.check()?;
    charts.sort_unstable_by_key(|chart| chart.triangles[0]);
    Ok(charts)
}

/// What to do with a part.
enum Next {
    /// Accept it as a chart.
    Accept(Box<Chart>),
    /// Slit it along these sides.
    Slit(Vec<Corner>),
    /// Cut it in two.
    Cut,
}

/// Connected triangles, ascending, and the sides (both of an edge) along which they are slit, ascending.
#[derive(Debug)]
pub(super) struct SurfacePart {
    pub triangles: Vec<u32>,
    pub slits: Vec<Corner>,
}

impl SurfacePart {
    fn of(triangles: Vec<u32>) -> SurfacePart {
        SurfacePart { triangles, slits: Vec::new() }
    }
}

/// A surface cut at its features: the side opposite each side across an edge that is no feature.
pub(super) struct CutSurface<'a> {
    pub mesh: &'a Triangles,
    pub beyond: Vec<Option<Corner>>,
    centre: Vec<DVec3>,
    /// Coordinates in the plane are multiples of this power of two.
    pub grid: f64,
    cancel: Cancel,
}

impl<'a> CutSurface<'a> {
    fn new(mesh: &'a Triangles, edges: &Edges, features: &[Option<Feature>], cancel: Cancel) -> Self {
        let mut beyond = vec![None; 3 * mesh.triangles.len()];
        for (edge, _) in features.iter().enumerate().filter(|(_, feature)| feature.is_none()) {
            if let [a, b] = *edges.get(edge).sides {
                beyond[a as usize] = Some(b);
                beyond[b as usize] = Some(a);
            }
        }
        let centre = (0..mesh.triangles.len()).map(|t| mesh.corners(t).iter().sum::<DVec3>() / 3.0).collect();
        let (low, high) =
            mesh.points.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
        let size = (high - low).max_element();
        // Small enough for exact coordinates of ten thousand charts side by side, each as wide as the surface.
        let grid = if size > 0.0 { libm::ldexp(1.0, libm::ilogb(size) - 37) } else { 1.0 };
        CutSurface { mesh, beyond, centre, grid, cancel }
    }

    /// The sides of a triangle.
    pub fn sides(triangle: u32) -> [Corner; 3] {
        [3 * triangle, 3 * triangle + 1, 3 * triangle + 2]
    }

    /// The connected pieces of a part, each ascending; the one with the first triangle comes last.
    pub fn connected(&self, part: &SurfacePart) -> Vec<SurfacePart> {
        let triangles = &part.triangles;
        let mut left = vec![true; triangles.len()];
        let mut pieces = Vec::new();
        for first in 0..triangles.len() {
            if !std::mem::replace(&mut left[first], false) {
                continue;
            }
            let mut piece = vec![first as u32];
            let mut next = 0;
            while next < piece.len() {
                if next.is_multiple_of(BATCH) && self.cancel.is_asked() {
                    return pieces;
                }
                for side in Self::sides(triangles[piece[next] as usize]) {
                    if let Some(at) = self.neighbour(part, side).filter(|&at| left[at]) {
                        left[at] = false;
                        piece.push(at as u32);
                    }
                }
                next += 1;
            }
            piece.sort_unstable();
            piece.iter_mut().for_each(|at| *at = triangles[*at as usize]);
            let in_piece = |side: &Corner| piece.binary_search(&(side / 3)).is_ok();
            let slits = part.slits.iter().copied().filter(in_piece).collect();
            pieces.push(SurfacePart { triangles: piece, slits });
        }
        pieces.reverse();
        pieces
    }

    /// Maps a part to the plane; `tell` receives the progress, from 0 to 1.
    fn chart(&self, part: &SurfacePart, bound: StretchBound, tell: &mut dyn FnMut(f64)) -> Next {
        if part.triangles.len() > MOST_TRIANGLES {
            return Next::Cut;
        }
        let mut chart = self.nodes(part);
        // When cancelled, the result is not used.
        let Ok(edges) = Edges::unless(&chart.local, &self.cancel) else { return Next::Cut };
        let euler = chart.points.len() as i64 - edges.len() as i64 + chart.local.len() as i64;
        let holes = chart.loops.len() as i64 - 1;
        // A single triangle is mapped as it is, whatever its shape.
        let is_single = part.triangles.len() == 1;
        if holes < 0 || euler != 1 - holes {
            return Next::Cut;
        }
        let xyz: Vec<DVec3> = chart.points.iter().map(|&p| self.mesh.points[p as usize]).collect();
        let rigid = as_rigid_as_possible::map(&xyz, &chart.local, &edges, &chart.loops, self.grid, &self.cancel, tell);
        let mapped = match rigid {
            None if holes == 0 && !self.cancel.is_asked() => {
                tutte::map(&xyz, &chart.local, chart.loops[0] as usize, self.grid, &self.cancel)
            }
            found => found,
        };
        // The last resort, which repaired surfaces do not need.
        let mapped = mapped.or_else(|| {
            is_single
                .then(|| as_rigid_as_possible::flattened([0, 1, 2].map(|k| xyz[chart.local[0][k] as usize])).to_vec())
        });
        if let Some(uv) = mapped {
            chart.stretch = stretch(&xyz, &chart.local, &uv);
            chart.uv = uv;
            let bound = if holes == 0 { bound } else { WITH_HOLES };
            if is_single || bound.allows(chart.stretch) {
                return Next::Accept(Box::new(chart));
            }
        }
        if holes > 0 { Next::Slit(self.slit(part, &chart, &edges, &xyz)) } else { Next::Cut }
    }

    /// The nodes of a part: corners joined across its edges. An empty chart when cancelled.
    pub fn nodes(&self, part: &SurfacePart) -> Chart {
        let triangles = &part.triangles;
        let mut nodes = DisjointSets::new(3 * triangles.len());
        let mut border_sides: Vec<Corner> = Vec::new();
        let after = |corner: u32| corner - corner % 3 + (corner + 1) % 3;
        for (at, &t) in triangles.iter().enumerate() {
            if at.is_multiple_of(BATCH) && self.cancel.is_asked() {
                return Chart::default();
            }
            for side in Self::sides(t) {
                let own = 3 * at as u32 + side % 3;
                match self.neighbour(part, side) {
                    Some(there) => {
                        let other = 3 * there as u32 + self.beyond[side as usize].unwrap_or(side) % 3;
                        nodes.join(own, after(other));
                        nodes.join(after(own), other);
                    }
                    None => border_sides.push(own),
                }
            }
        }
        let set: Vec<u32> = (0..3 * triangles.len() as u32).map(|corner| nodes.find(corner)).collect();
        if self.cancel.is_asked() {
            return Chart::default();
        }
        // The border, loop after loop; then the interior nodes breadth first.
        let mut side_at = vec![u32::MAX; set.len()];
        border_sides.iter().for_each(|&side| side_at[set[side as usize] as usize] = side);
        let (mut order, mut loops) = (Vec::new(), Vec::new());
        let mut number = vec![u32::MAX; set.len()];
        for &first in &border_sides {
            let before = order.len();
            let mut side = first;
            while number[set[side as usize] as usize] == u32::MAX {
                number[set[side as usize] as usize] = order.len() as u32;
                order.push(side);
                side = side_at[set[after(side) as usize] as usize];
            }
            if order.len() > before {
                loops.push((order.len() - before) as u32);
            }
        }
        if order.is_empty() {
            number[set[0] as usize] = 0;
            order.push(0);
        }
        let corners = Groups::of(set.len(), set.len(), |corner| set[corner as usize]);
        let mut next = 0;
        while next < order.len() {
            if next.is_multiple_of(BATCH) && self.cancel.is_asked() {
                return Chart::default();
            }
            let node = set[order[next] as usize];
            for &corner in corners.get(node) {
                for near in [after(corner), after(after(corner))] {
                    let number = &mut number[set[near as usize] as usize];
                    if *number == u32::MAX {
                        *number = order.len() as u32;
                        order.push(near);
                    }
                }
            }
            next += 1;
        }
        let point = |corner: u32| self.mesh.triangles[triangles[corner as usize / 3] as usize][corner as usize % 3];
        Chart {
            triangles: triangles.clone(),
            local: (0..triangles.len()).map(|t| [0, 1, 2].map(|k| number[set[3 * t + k] as usize])).collect(),
            points: order.into_iter().map(point).collect(),
            loops,
            uv: Vec::new(),
            stretch: Stretch::default(),
        }
    }

    /// The present slits of a part, and the shortest path from its first border loop to another one.
    fn slit(&self, part: &SurfacePart, chart: &Chart, edges: &Edges, xyz: &[DVec3]) -> Vec<Corner> {
        let mut near: Vec<Vec<u32>> = vec![Vec::new(); xyz.len()];
        let inner = (0..edges.len()).filter(|&edge| edges.get(edge).sides.len() == 2);
        for edge in inner {
            edges.get(edge).ends.iter().for_each(|&end| near[end as usize].push(edge as u32));
        }
        let (first, border) = (chart.loops[0], chart.loops.iter().sum::<u32>());
        let mut reached = vec![(f64::INFINITY, u32::MAX); xyz.len()];
        let mut queue: BinaryHeap<Reverse<(u64, u32)>> = BinaryHeap::new();
        for node in 0..first {
            reached[node as usize].0 = 0.0;
            queue.push(Reverse((0, node)));
        }
        let mut end = None;
        while let Some(Reverse((bits, node))) = queue.pop() {
            if reached[node as usize].0.to_bits() != bits {
                continue;
            }
            if (first..border).contains(&node) {
                end = Some(node);
                break;
            }
            for &edge in &near[node as usize] {
                let [a, b] = edges.get(edge as usize).ends;
                let other = if a == node { b } else { a };
                let far = f64::from_bits(bits) + xyz[a as usize].distance(xyz[b as usize]);
                if far < reached[other as usize].0 {
                    reached[other as usize] = (far, edge);
                    queue.push(Reverse((far.to_bits(), other)));
                }
            }
        }
        let mut slits = part.slits.clone();
        while let Some(node) = end.take() {
            let edge = reached[node as usize].1;
            if edge != u32::MAX {
                let edge = edges.get(edge as usize);
                let side = |&corner: &Corner| 3 * part.triangles[corner as usize / 3] + corner % 3;
                slits.extend(edge.sides.iter().map(side));
                end = Some(if edge.ends[0] == node { edge.ends[1] } else { edge.ends[0] });
            }
        }
        slits.sort_unstable();
        slits
    }

    /// Two halves of a part, divided half-way between two distant triangles; invalid when cancelled.
    fn halves(&self, part: &SurfacePart) -> [Vec<u32>; 2] {
        let triangles = &part.triangles;
        let farthest = |from: u32| {
            let reached = self.reach(part, &[from]);
            let far = reached.iter().enumerate().max_by(|a, b| a.1.0.total_cmp(&b.1.0).then(b.0.cmp(&a.0)));
            far.map_or(from, |(at, _)| triangles[at])
        };
        let one = farthest(triangles[0]);
        let mut seeds = [one, farthest(one)];
        if seeds[0] == seeds[1] {
            seeds = [triangles[0], triangles[triangles.len() - 1]];
        }
        let mut owner: Vec<u8> = self.reach(part, &seeds).iter().map(|reached| reached.1).collect();
        for _ in 0..2 {
            if self.cancel.is_asked() {
                return [Vec::new(), Vec::new()];
            }
            // Restart each half from its middle: the triangle farthest from the dividing line.
            let meeting = |at: usize| {
                Self::sides(triangles[at])
                    .iter()
                    .any(|&side| self.neighbour(part, side).is_some_and(|n| owner[n] != owner[at]))
            };
            let line: Vec<u32> = (0..triangles.len()).filter(|&at| meeting(at)).map(|at| triangles[at]).collect();
            if line.is_empty() {
                break;
            }
            let depth = self.reach(part, &line);
            let deepest = |own: u8| {
                let own = (0..triangles.len()).filter(|&at| owner[at] == own);
                own.max_by(|&a, &b| depth[a].0.total_cmp(&depth[b].0).then(b.cmp(&a))).map(|at| triangles[at])
            };
            let (Some(a), Some(b)) = (deepest(0), deepest(1)) else { break };
            owner = self.reach(part, &[a, b]).iter().map(|reached| reached.1).collect();
        }
        self.shorten(part, &mut owner);
        let half =
            |own: u8| triangles.iter().zip(&owner).filter(|(_, o)| (**o == 0) == (own == 0)).map(|(&t, _)| t).collect();
        [half(0), half(1)]
    }

    /// The index in the part of the triangle across a side.
    pub fn neighbour(&self, part: &SurfacePart, side: Corner) -> Option<usize> {
        let beyond = self.beyond[side as usize]?;
        let at = part.triangles.binary_search(&(beyond / 3)).ok()?;
        (part.slits.is_empty() || part.slits.binary_search(&side).is_err()).then_some(at)
    }

    /// Smooths the dividing line of two halves: a triangle with two neighbours in the other half moves to it.
    fn shorten(&self, part: &SurfacePart, owner: &mut [u8]) {
        for _ in 0..3 {
            let mut moved = false;
            for at in 0..part.triangles.len() {
                if at.is_multiple_of(BATCH) && self.cancel.is_asked() {
                    return;
                }
                let beyond = Self::sides(part.triangles[at]).map(|side| self.neighbour(part, side).map(|n| owner[n]));
                let foreign = beyond.iter().flatten().filter(|&&o| o != owner[at]).count();
                let own = beyond.iter().flatten().filter(|&&o| o == owner[at]).count();
                if foreign == 2 && own == 1 {
                    owner[at] = 1 - owner[at].min(1);
                    moved = true;
                }
            }
            if !moved {
                return;
            }
        }
    }

    /// For each triangle of a part, the distance along centroids to the nearest seed, and which seed that is (at most
    /// 255; ties by order). Unreachable triangles belong to the first seed.
    fn reach(&self, part: &SurfacePart, seeds: &[u32]) -> Vec<(f64, u8)> {
        let mut reached = vec![(f64::INFINITY, 0_u8); part.triangles.len()];
        // Non-negative floats are ordered like their bits.
        let mut queue: BinaryHeap<Reverse<(u64, u8, u32)>> = BinaryHeap::new();
        for (i, seed) in seeds.iter().enumerate() {
            if let Ok(at) = part.triangles.binary_search(seed) {
                let owner = i.min(255) as u8;
                if reached[at].0 > 0.0 {
                    reached[at] = (0.0, owner);
                    queue.push(Reverse((0, owner, at as u32)));
                }
            }
        }
        let mut looked = 0_usize;
        while let Some(Reverse((bits, owner, at))) = queue.pop() {
            looked += 1;
            if looked.is_multiple_of(BATCH) && self.cancel.is_asked() {
                break;
            }
            let at = at as usize;
            if reached[at] != (f64::from_bits(bits), owner) {
                continue;
            }
            for side in Self::sides(part.triangles[at]) {
                let Some(next) = self.neighbour(part, side) else { continue };
                let far = f64::from_bits(bits)
                    + self.centre[part.triangles[at] as usize].distance(self.centre[part.triangles[next] as usize]);
                if far < reached[next].0 {
                    reached[next] = (far, owner);
                    queue.push(Reverse((far.to_bits(), owner, next as u32)));
                }
            }
        }
        reached.iter_mut().filter(|r| r.0 == f64::INFINITY).for_each(|r| r.0 = 0.0);
        reached
    }
}

#[cfg(test)]
mod tests;
