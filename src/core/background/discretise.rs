//! Curves divided at equal metric arclength, with even loops (spec 2.9 and step 1 of 3).

use glam::DVec2;

use super::parity;
use crate::core::fault::Fault;
use crate::core::geometry::domain::{CurveId, DirectedCurve, Domain, DomainCurve};
use crate::core::geometry::place::told;
use crate::core::metric::field::MetricSource;

/// More segments than this on all curves together are refused: the sizes cannot be meant.
const MOST_SEGMENTS: f64 = 2e7;

/// A divided domain: nodes on curves. Each curve is divided once, whatever number of faces it bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct DividedDomain {
    /// Coordinates of each node: the domain's vertices come first, in their order, then the nodes inside curves.
    pub nodes: Vec<DVec2>,
    /// Nodes of each curve from its start to its end.
    pub chains: Vec<Vec<u32>>,
}

/// Lengths of the curves in the metric, and into how many segments they are to be divided.
pub struct Division<'a> {
    domain: &'a Domain,
    metric: &'a dyn MetricSource,
    /// The smooth straight or curved pieces of each curve, between its corners.
    pieces: Vec<Vec<Piece>>,
}

/// A piece of a curve between two corners.
struct Piece {
    /// Parameters and metric lengths from the piece's start, ascending; between two the curve is resolved.
    table: Vec<(f64, f64)>,
    segments: u32,
}

impl Piece {
    fn length(&self) -> f64 {
        self.table[self.table.len() - 1].1
    }

    /// How far metric lengths are from 1 when divided into `n` segments.
    fn error(&self, n: u32) -> f64 {
        (self.length() / f64::from(n) - 1.0).abs()
    }

    fn stretched(&self) -> f64 {
        self.length() / f64::from(self.segments)
    }
}

/// Divides the curves of a domain into segments of about unit metric length, all topological loops even and of at least
/// four segments.
///
/// # Errors
/// Where the metric fails, where fixed numbers of segments do not allow even loops, and where the sizes ask for more
/// segments than could be meant.
pub fn divide(domain: &Domain, metric: &dyn MetricSource) -> Result<DividedDomain, Fault> {
    let mut division = Division::measure(domain, metric)?;
    division.even_out()?;
    division.nodes()
}

impl<'a> Division<'a> {
    /// Measures the curves and gives each the number of segments nearest to its length, or the fixed one.
    ///
    /// # Errors
    /// Where the metric fails, sizes are absurdly small, or a fixed number is less than the curve has pieces.
    pub fn measure(domain: &'a Domain, metric: &'a dyn MetricSource) -> Result<Self, Fault> {
        let mut division = Division { domain, metric, pieces: Vec::with_capacity(domain.curves.len()) };
        let mut total = 0.0;
        for curve in &domain.curves {
            let mut pieces = measure(curve, metric)?;
            let length: f64 = pieces.iter().map(Piece::length).sum();
            total += length;
            if !(total < MOST_SEGMENTS) {
                return Err(about(
                    curve,
                    Fault::new(format!("The curve \"{}\" is {length:.3e} target sizes long", curve.name))
                        .remedy("Ask for larger sizes along it"),
                ));
            }
            match curve.segments {
                None => {
                    for piece in &mut pieces {
                        piece.segments = (piece.length().round() as u32).max(1);
                    }
                    let closed = curve.ends[0] == curve.ends[1];
                    while closed && pieces.iter().map(|p| p.segments).sum::<u32>() < 3 {
                        most_stretched(&mut pieces).segments += 1;
                    }
                }
                Some(n) => {
                    if (n as usize) < pieces.len() {
                        return Err(about(
                            curve,
                            Fault::new(format!(
                                "The curve \"{}\" has {} pieces between corners and is to have {n} segments",
                                curve.name,
                                pieces.len()
                            ))
                            .remedy(format!("Give it at least {} segments", pieces.len())),
                        ));
                    }
                    share_out(&mut pieces, n);
                }
            }
            division.pieces.push(pieces);
        }
        Ok(division)
    }

    /// The number of segments of a curve.
    pub fn segments(&self, id: CurveId) -> u32 {
        self.pieces[id.index()].iter().map(|p| p.segments).sum()
    }

    /// Gives the curve about half as many segments again, by an even number; `false` where nothing would come of it.
    pub fn refine(&mut self, id: CurveId) -> bool {
        let curve = &self.domain.curves[id.index()];
        if curve.segments.is_some() || curve.curve.straight() {
            return false;
        }
        let more = (self.segments(id) / 4 * 2).max(2);
        for _ in 0..more {
            most_stretched(&mut self.pieces[id.index()]).segments += 1;
        }
        true
    }

    /// Makes every boundary walk even, and walks and loops at least four segments long.
    ///
    /// # Errors
    /// Where fixed numbers do not allow that: names the loop with its number of segments.
    pub fn even_out(&mut self) -> Result<(), Fault> {
        let walks: Vec<(usize, &Vec<DirectedCurve>)> =
            self.domain.faces.iter().enumerate().flat_map(|(f, face)| face.walks.iter().map(move |w| (f, w))).collect();
        let rows: Vec<Vec<u32>> = walks.iter().map(|(_, walk)| single_columns(walk)).collect();
        let odd: Vec<bool> =
            rows.iter().map(|row| row.iter().map(|&c| self.segments(CurveId(c))).sum::<u32>() % 2 == 1).collect();
        let best: Vec<Option<(f64, usize, u32)>> = (0..self.pieces.len()).map(|c| self.best_toggle(c)).collect();
        let cost: Vec<Option<f64>> = best.iter().map(|b| b.map(|b| b.0)).collect();
        let toggled = parity::toggles(&rows, &odd, &cost).map_err(|blamed| {
            let blamed: Vec<_> = blamed.iter().map(|&r| walks[r as usize]).collect();
            self.odd_fault(&blamed)
        })?;
        for (c, best) in best.iter().enumerate() {
            if let (true, Some((_, piece, n))) = (toggled[c], *best) {
                self.pieces[c][piece].segments = n;
            }
        }
        let doubled: Vec<bool> = {
            let mut doubled = vec![false; self.pieces.len()];
            for (_, walk) in &walks {
                let mut ids: Vec<u32> = walk.iter().map(|d| d.curve.0).collect();
                ids.sort_unstable();
                ids.chunk_by(|a, b| a == b).filter(|g| g.len() == 2).for_each(|g| doubled[g[0] as usize] = true);
            }
            doubled
        };
        let loops = self.domain.faces.iter().enumerate().flat_map(|(f, face)| face.loops.iter().map(move |l| (f, l)));
        for (f, steps) in loops.chain(walks) {
            while steps.iter().map(|s| self.segments(s.curve)).sum::<u32>() < 4 {
                let stretched = |id: CurveId| self.pieces[id.index()].iter().map(Piece::stretched).fold(0.0, f64::max);
                let free = steps.iter().map(|s| s.curve).filter(|id| self.domain.curves[id.index()].segments.is_none());
                let Some(id) = free.max_by(|a, b| stretched(*a).total_cmp(&stretched(*b)).then(b.cmp(a))) else {
                    return Err(self.told_loop(f, steps, |name, n| {
                        Fault::new(format!("The {name} has {n} segments; it needs at least 4"))
                            .remedy("Give its curves more segments, or leave the numbers out")
                    }));
                };
                // One more on a line that is run twice leaves every loop even; elsewhere it has to be two.
                for _ in 0..if doubled[id.index()] { 1 } else { 2 } {
                    most_stretched(&mut self.pieces[id.index()]).segments += 1;
                }
            }
        }
        Ok(())
    }

    /// The cheapest way to change the curve's number by one: relative length error after it, the piece, its new number.
    fn best_toggle(&self, c: usize) -> Option<(f64, usize, u32)> {
        let curve = &self.domain.curves[c];
        if curve.segments.is_some() {
            return None;
        }
        let least = if curve.ends[0] == curve.ends[1] { 3 } else { 1 };
        let may_shrink = self.segments(CurveId(c as u32)) > least;
        let mut best: Option<(f64, usize, u32)> = None;
        for (i, piece) in self.pieces[c].iter().enumerate() {
            let n = piece.segments;
            for changed in [n + 1, n - 1] {
                if (changed > n || (may_shrink && changed > 0)) && best.is_none_or(|b| piece.error(changed) < b.0) {
                    best = Some((piece.error(changed), i, changed));
                }
            }
        }
        best
    }

    /// A fault about a loop of a face, with its name, its number of segments and its place.
    fn told_loop(&self, f: usize, steps: &[DirectedCurve], fault: impl Fn(&str, u32) -> Fault) -> Fault {
        let curve = &self.domain.curves[steps[0].curve.index()];
        let n = steps.iter().map(|s| self.segments(s.curve)).sum();
        about(curve, fault(&self.loop_name(f, steps), n))
    }

    fn loop_name(&self, f: usize, steps: &[DirectedCurve]) -> String {
        let face = &self.domain.faces[f];
        if steps.iter().all(|s| s.curve == steps[0].curve) {
            return format!("boundary loop \"{}\"", self.domain.curves[steps[0].curve.index()].name);
        }
        match face.loops.iter().position(|l| l.iter().any(|s| steps.contains(s))) {
            Some(0) => format!("outer loop of \"{}\"", face.name),
            Some(i) => format!("hole {i} of \"{}\"", face.name),
            None => format!("loop of internal lines of \"{}\"", face.name),
        }
    }

    fn odd_fault(&self, blamed: &[(usize, &Vec<DirectedCurve>)]) -> Fault {
        let mut fixed: Vec<u32> = blamed.iter().flat_map(|(_, walk)| single_columns(walk)).collect();
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
            return self.told_loop(*f, walk, |name, n| {
                Fault::new(format!("The {name} has {n} segments; an all-quad mesh needs an even count"))
                    .remedy(remedy.clone())
            });
        }
        let names: Vec<String> = blamed.iter().map(|(f, walk)| format!("the {}", self.loop_name(*f, walk))).collect();
        let total: u32 = fixed.iter().map(|id| self.segments(*id)).sum();
        let fault = Fault::new(format!(
            "An all-quad mesh needs even loops, and {} cannot all be even: their fixed curves have {total} segments together",
            names.join(", ")
        ));
        about(&self.domain.curves[blamed[0].1[0].curve.index()], fault.remedy(remedy))
    }

    /// The nodes: each piece of each curve at equal metric arclength.
    ///
    /// # Errors
    /// Where the metric fails.
    pub fn nodes(&self) -> Result<DividedDomain, Fault> {
        let mut nodes = self.domain.vertices.clone();
        let mut chains = Vec::with_capacity(self.pieces.len());
        for (curve, pieces) in self.domain.curves.iter().zip(&self.pieces) {
            let mut chain = vec![curve.ends[0]];
            for (i, piece) in pieces.iter().enumerate() {
                let n = piece.segments;
                let mut at = 0;
                for k in 1..n {
                    let target = piece.length() * (f64::from(k) / f64::from(n));
                    while at + 2 < piece.table.len() && piece.table[at + 1].1 <= target {
                        at += 1;
                    }
                    let t =
                        self.parameter(curve, piece.table[at], piece.table[at + 1], target, 1e-7 * piece.stretched())?;
                    chain.push(nodes.len() as u32);
                    nodes.push(curve.curve.point(t));
                }
                if i + 1 < pieces.len() {
                    chain.push(nodes.len() as u32);
                    nodes.push(curve.curve.point(piece.table[piece.table.len() - 1].0));
                }
            }
            chain.push(curve.ends[1]);
            chains.push(chain);
        }
        Ok(DividedDomain { nodes, chains })
    }

    /// The parameter between two entries of a table at which the length is `target`, by Newton within a bracket.
    fn parameter(
        &self,
        curve: &DomainCurve,
        from: (f64, f64),
        to: (f64, f64),
        target: f64,
        tolerance: f64,
    ) -> Result<f64, Fault> {
        let (mut low, mut high) = (from.0, to.0);
        let mut t = from.0 + (to.0 - from.0) * ((target - from.1) / (to.1 - from.1)).clamp(0.0, 1.0);
        for _ in 0..50 {
            let off = from.1 + gauss(curve, self.metric, from.0, t)? - target;
            if off.abs() <= tolerance {
                break;
            }
            if off > 0.0 {
                high = t
            } else {
                low = t
            }
            let next = t - off / speed(curve, self.metric, t)?;
            t = if next > low && next < high { next } else { 0.5 * (low + high) };
            if high - low <= 4.0 * f64::EPSILON * high.abs() {
                break;
            }
        }
        Ok(t)
    }
}

/// Columns of a walk in the parity system: its curves but those that it runs twice, ascending.
fn single_columns(walk: &[DirectedCurve]) -> Vec<u32> {
    let mut ids: Vec<u32> = walk.iter().map(|d| d.curve.0).collect();
    ids.sort_unstable();
    ids.chunk_by(|a, b| a == b).filter(|g| g.len() % 2 == 1).map(|g| g[0]).collect()
}

fn most_stretched(pieces: &mut [Piece]) -> &mut Piece {
    let at = (0..pieces.len()).max_by(|&a, &b| pieces[a].stretched().total_cmp(&pieces[b].stretched()).then(b.cmp(&a)));
    &mut pieces[at.expect("a curve has at least one piece")]
}

/// Divides `n` segments among the pieces so that the longest are as short as can be, at least one each.
fn share_out(pieces: &mut [Piece], n: u32) {
    // As many as fit rounded down, then the rest to those that are stretched most.
    let total: f64 = pieces.iter().map(Piece::length).sum();
    let mut given = 0;
    for piece in pieces.iter_mut() {
        piece.segments = ((piece.length() / total * f64::from(n)) as u32).max(1);
        given += piece.segments;
    }
    while given < n {
        most_stretched(pieces).segments += 1;
        given += 1;
    }
    while given > n {
        // Pieces raised to one may have taken from the others: those that suffer least give back.
        let least = (0..pieces.len()).filter(|&i| pieces[i].segments > 1).min_by(|&a, &b| {
            let after = |i: usize| pieces[i].length() / f64::from(pieces[i].segments - 1);
            after(a).total_cmp(&after(b)).then(a.cmp(&b))
        });
        let Some(i) = least else { return };
        pieces[i].segments -= 1;
        given -= 1;
    }
}

fn about(curve: &DomainCurve, fault: Fault) -> Fault {
    if curve.place.is_empty() { fault } else { fault.at(curve.place.clone()) }
}

/// Metric length of the derivative at `t`.
fn speed(curve: &DomainCurve, metric: &dyn MetricSource, t: f64) -> Result<f64, Fault> {
    let (p, d) = curve.curve.at(t);
    let m = metric.metric(p).map_err(|bad| {
        about(
            curve,
            Fault::new(bad.what.clone()).at(format!("on the curve \"{}\" at {}", curve.name, told(bad.place.uv))),
        )
    })?;
    Ok((m.uu * d.x * d.x + 2.0 * m.uv * d.x * d.y + m.vv * d.y * d.y).max(0.0).sqrt())
}

/// Metric length between two parameters by three-point Gauss quadrature.
fn gauss(curve: &DomainCurve, metric: &dyn MetricSource, a: f64, b: f64) -> Result<f64, Fault> {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    // sqrt(3/5)
    let off = 0.774_596_669_241_483_4 * half;
    let ends = speed(curve, metric, middle - off)? + speed(curve, metric, middle + off)?;
    Ok(half * (5.0 * ends + 8.0 * speed(curve, metric, middle)?) / 9.0)
}

/// The pieces of a curve with their tables of length, halved until the quadrature agrees with itself.
fn measure(curve: &DomainCurve, metric: &dyn MetricSource) -> Result<Vec<Piece>, Fault> {
    let corners = curve.curve.corners();
    let breaks = curve.curve.breaks();
    let parts = (64 / (breaks.len() - 1)).clamp(2, 32);
    let mut pieces: Vec<Piece> = Vec::new();
    let mut table = vec![(0.0, 0.0)];
    let mut stack = Vec::new();
    let mut next_corner = 0;
    for w in breaks.windows(2) {
        for i in (0..parts).rev() {
            let at = |i: usize| if i == parts { w[1] } else { w[0] + (w[1] - w[0]) * i as f64 / parts as f64 };
            stack.push((at(i), at(i + 1), None, 0));
        }
        while let Some((a, b, known, depth)) = stack.pop() {
            let whole = match known {
                Some(length) => length,
                None => gauss(curve, metric, a, b)?,
            };
            let middle = 0.5 * (a + b);
            let (first, second) = (gauss(curve, metric, a, middle)?, gauss(curve, metric, middle, b)?);
            let both = first + second;
            if (both - whole).abs() <= 1e-6 + 1e-7 * both || depth >= 30 || table.len() > 2_000_000 {
                let before: f64 = table[table.len() - 1].1;
                table.push((middle, before + first));
                table.push((b, before + both));
            } else {
                stack.push((middle, b, Some(second), depth + 1));
                stack.push((a, middle, Some(first), depth + 1));
            }
        }
        let at_corner = corners.get(next_corner).is_some_and(|&t| t <= w[1]);
        if at_corner || w[1] >= 1.0 {
            next_corner += 1;
            pieces.push(Piece { table: std::mem::replace(&mut table, vec![(w[1], 0.0)]), segments: 1 });
        }
    }
    Ok(pieces)
}

#[cfg(test)]
pub(super) mod tests;
