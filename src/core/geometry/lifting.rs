//! Lifting of loops of space curves into the chart of a face. On a closed surface, a curve has an image on every sheet,
//! and a loop is a chain of images that closes in the chart itself. A seam occurs twice in its loop, once from either
//! side.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::chart::{Chart, singular_edges};
use super::face_surface::FaceSurface;
use super::image::Image;
use super::named_curve::{NamedCurve, image_on};
use super::surface::{Edge, NurbsSurface};
use crate::core::fault::Fault;
use crate::core::kernel::decimal::{number, point_text};

/// The number of chains of images that are tried for a loop.
const PATIENCE: usize = 20_000;

/// An image in a loop.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The index of the curve.
    pub curve: usize,
    /// Its image.
    pub image: Image,
    /// Whether the loop traverses it from start to end.
    pub forward: bool,
}

/// A face in its chart: the images of its curves, chained into loops.
pub(in crate::core) struct Lifted {
    pub surface: FaceSurface,
    /// Outer loop, holes.
    pub loops: Vec<Vec<Piece>>,
    pub cracks: Vec<Piece>,
    pub repeated: Vec<Piece>,
}

/// Candidate charts of a face with these outer curves: one about each singular point, the nearest to the curves first,
/// and then the parametric plane.
pub(super) fn charts_for(
    surface: &Arc<NurbsSurface>,
    outer: &[usize],
    reversed: bool,
    curves: &[NamedCurve],
) -> Vec<Chart> {
    let points: Vec<DVec3> = outer.iter().flat_map(|&c| curves[c].curve.polyline()).collect();
    let domain = surface.domain();
    let mut edges: Vec<(f64, Edge)> = singular_edges(surface)
        .into_iter()
        .map(|edge| {
            let apex = surface.at(edge.uv(domain[1 - edge.axis][0], domain[edge.axis][usize::from(edge.last)]), 1).p;
            (points.iter().map(|p| p.distance(apex)).fold(f64::INFINITY, f64::min), edge)
        })
        .collect();
    edges.sort_by(|a, b| a.0.total_cmp(&b.0));
    let about = |(_, edge): (f64, Edge)| Chart::about(Arc::clone(surface), edge, reversed);
    let mut charts: Vec<Chart> = edges.into_iter().map(about).collect();
    charts.push(Chart::sheet(Arc::clone(surface), reversed));
    charts
}

/// Images of curves in one chart.
pub(super) struct Lift<'a> {
    /// The distance in space up to which ends of curves are one and curves lie on their surface, if it is given.
    tolerance: Option<f64>,
    chart: &'a Arc<Chart>,
    curves: &'a [NamedCurve],
    face: &'a str,
    /// By curve and sheet.
    images: FxHashMap<(usize, usize), Result<Image, Fault>>,
    /// The translations of (u, v) by whole periods, which do not change the point.
    moves: Vec<DVec2>,
}

/// A partial chain.
struct Chain<'a> {
    list: &'a [usize],
    used: Vec<bool>,
    /// Index in the list, sheet, and whether forward.
    steps: Vec<(usize, usize, bool)>,
    /// The length and end of the longest chain found.
    longest: (usize, DVec2),
    patience: usize,
}

/// Surface parameters for messages.
fn uv_text(uv: DVec2) -> String {
    format!("u = {}, v = {}", number(uv.x), number(uv.y))
}

impl<'a> Lift<'a> {
    pub fn new(chart: &'a Arc<Chart>, curves: &'a [NamedCurve], face: &'a str, tolerance: Option<f64>) -> Lift<'a> {
        let surface = chart.surface();
        let period = [0, 1].map(|axis| surface.period(axis));
        let mut moves = vec![DVec2::ZERO];
        // A disc has no seam, even if its surface has one.
        if !chart.is_disc() {
            for a in [0.0, -1.0, 1.0, -2.0, 2.0] {
                for b in [0.0, -1.0, 1.0, -2.0, 2.0] {
                    let by = DVec2::new(a * period[0].unwrap_or(0.0), b * period[1].unwrap_or(0.0));
                    if !moves.contains(&by) {
                        moves.push(by);
                    }
                }
            }
        }
        Lift { tolerance, chart, curves, face, images: FxHashMap::default(), moves }
    }

    /// The image of a curve on a sheet.
    fn image(&mut self, curve: usize, sheet: usize) -> Result<Image, Fault> {
        if let Some(known) = self.images.get(&(curve, sheet)) {
            return known.clone();
        }
        let by = self.moves[sheet];
        let made = if sheet > 0 && self.chart.keeps_lines() {
            // The sheets of the parametric plane are translated copies of each other.
            let shift = self.chart.of_uv(by) - self.chart.of_uv(DVec2::ZERO);
            self.image(curve, 0).map(|image| image.moved(shift))
        } else {
            image_on(self.chart, &self.curves[curve], by, self.face, self.tolerance)
        };
        let made = made.and_then(|image| self.within(curve, image));
        self.images.insert((curve, sheet), made.clone());
        made
    }

    /// Refuses an image that leaves the surface's parameter range.
    fn within(&self, curve: usize, image: Image) -> Result<Image, Fault> {
        let surface = self.chart.surface();
        let domain = surface.domain();
        // A sector ends at its seam; the parametric plane and a disc continue across it.
        let goes_round = self.chart.keeps_lines() || self.chart.is_disc();
        let margin = [0, 1].map(|axis: usize| 1e-6 * (domain[axis][1] - domain[axis][0]));
        let singular = singular_edges(surface);
        // At a singular point the parameter along its edge means nothing.
        let is_singular = |along: usize, across: f64| {
            let at = |edge: &Edge| {
                let value = domain[edge.axis][usize::from(edge.last)];
                edge.axis != along && (across - value).abs() <= margin[edge.axis]
            };
            singular.iter().any(at)
        };
        let outside = image.uvs().find(|uv| {
            (0..2).any(|axis| {
                let [first, last] = domain[axis];
                let (t, across) = ([uv.x, uv.y][axis], [uv.y, uv.x][axis]);
                let is_inside = t >= first - margin[axis] && t <= last + margin[axis];
                !(is_inside || goes_round && surface.closed()[axis] || is_singular(axis, across))
            })
        });
        match outside {
            None => Ok(image),
            Some(uv) => {
                let [[u0, u1], [v0, v1]] = domain;
                let named = &self.curves[curve];
                Err(Fault::new(format!(
                    "The curve \"{}\" leaves the surface of the face \"{}\"",
                    named.name, self.face
                ))
                .at(format!("at {}", uv_text(uv)))
                .remedy(format!("Keep it within the surface: u from {u0} to {u1}, v from {v0} to {v1}")))
            }
        }
    }

    /// A single curve, not in a loop.
    pub fn single(&mut self, curve: usize) -> Result<Piece, Fault> {
        Ok(Piece { curve, image: self.image(curve, 0)?, forward: true })
    }

    /// Chains curves, given in any order and direction, into one loop that closes in the chart. `what` is the loop's
    /// name.
    pub fn chain(&mut self, list: &[usize], what: &str) -> Result<Vec<Piece>, Fault> {
        if list.is_empty() {
            return Err(Fault::new(format!("The {what} has no curves")).remedy("Name the curves of a closed loop"));
        }
        for (i, c) in list.iter().enumerate() {
            // Report a fault of a curve before a fault of the loop.
            let any = (1..self.moves.len()).fold(self.image(*c, 0), |found, sheet| found.or(self.image(*c, sheet)));
            any.or_else(|_| self.image(*c, 0))?;
            if list[..i].iter().filter(|d| *d == c).count() > 1 {
                let name = &self.curves[*c].name;
                return Err(Fault::new(format!("The {what} names the curve \"{name}\" three times"))
                    .remedy("Name a curve once, or a seam twice"));
            }
        }
        let mut longest = (0, DVec2::ZERO);
        for sheet in 0..self.moves.len() {
            let Ok(first) = self.image(list[0], sheet) else { continue };
            let mut chain = Chain {
                list,
                used: vec![false; list.len()],
                steps: vec![(0, sheet, true)],
                longest,
                patience: PATIENCE,
            };
            chain.used[0] = true;
            if self.extend(&mut chain, first.point(0.0), first.point(1.0)) {
                let piece = |&(i, sheet, forward): &(usize, usize, bool)| {
                    Ok(Piece { curve: list[i], image: self.image(list[i], sheet)?, forward })
                };
                return chain.steps.iter().map(piece).collect();
            }
            longest = chain.longest;
            // The other sheets of the parametric plane give the same result.
            if self.chart.keeps_lines() {
                break;
            }
        }
        let uv = self.chart.uv(longest.1);
        let on = self.chart.at(longest.1).xyz;
        let names: Vec<String> = list.iter().map(|c| format!("\"{}\"", self.curves[*c].name)).collect();
        let fault =
            Fault::new(format!("The {what} does not close on its surface: {} do not form a chain", names.join(", ")))
                .at(format!("the chain breaks off at {} ({})", point_text(on), uv_text(uv)));
        Err(fault.remedy(if self.moves.len() > 1 {
            "Make the ends meet; a loop around a closed surface needs a seam, named twice"
        } else {
            "Make the ends meet, or name the missing curve"
        }))
    }

    /// The images of directed curves that follow one another, and by how much the end of the last is past the start of
    /// the first, in u and v: by nothing, or by whole periods.
    ///
    /// # Errors
    /// Curves that do not lie on the surface, and loops that do not close.
    pub fn follow(&mut self, steps: &[(usize, bool)]) -> Result<(Vec<Piece>, DVec2), Fault> {
        let mut refusal: Option<Fault> = None;
        for first in 0..self.moves.len() {
            match self.follow_from(steps, first) {
                Ok(found) => return Ok(found),
                Err(fault) => refusal = refusal.or(Some(fault)),
            }
            // The other sheets of the parametric plane give the same result.
            if self.chart.keeps_lines() {
                break;
            }
        }
        Err(refusal.unwrap_or_else(Fault::stopped))
    }

    /// The same with the first curve on a sheet.
    fn follow_from(&mut self, steps: &[(usize, bool)], first: usize) -> Result<(Vec<Piece>, DVec2), Fault> {
        let end = |image: &Image, forward: bool| image.point(if forward { 1.0 } else { 0.0 });
        let mut pieces: Vec<Piece> = Vec::new();
        let mut used: Vec<(usize, usize)> = Vec::new();
        let (mut start, mut at) = (DVec2::ZERO, DVec2::ZERO);
        for &(curve, forward) in steps {
            let mut refusal: Option<Fault> = None;
            let mut found: Option<(usize, Image)> = None;
            for sheet in if pieces.is_empty() { first..first + 1 } else { 0..self.moves.len() } {
                // A curve is not traversed twice on the same sheet.
                if used.contains(&(curve, sheet)) {
                    continue;
                }
                match self.image(curve, sheet) {
                    Ok(image) if pieces.is_empty() || self.meet(end(&image, !forward), at) => {
                        found = Some((sheet, image));
                        break;
                    }
                    Ok(_) => {}
                    Err(fault) => refusal = refusal.or(Some(fault)),
                }
            }
            let Some((sheet, image)) = found else {
                return Err(refusal.unwrap_or_else(|| self.broken(curve, at)));
            };
            if pieces.is_empty() {
                start = end(&image, !forward);
            }
            at = end(&image, forward);
            used.push((curve, sheet));
            pieces.push(Piece { curve, image, forward });
        }
        if pieces.is_empty() || self.meet(at, start) {
            return Ok((pieces, DVec2::ZERO));
        }
        let uv = self.chart.uv(start);
        match self.moves.iter().find(|by| self.meet(at, self.chart.of_uv(uv + **by))) {
            Some(past) => Ok((pieces, *past)),
            None => Err(self.broken(steps[0].0, at)),
        }
    }

    /// The fault of a loop that breaks off before a curve.
    fn broken(&self, curve: usize, at: DVec2) -> Fault {
        let (uv, on) = (self.chart.uv(at), self.chart.at(at).xyz);
        let name = &self.curves[curve].name;
        let what = format!(
            "A loop of the face \"{}\" does not close on its surface: it breaks off before \"{name}\"",
            self.face
        );
        Fault::new(what)
            .at(format!("at {} ({})", point_text(on), uv_text(uv)))
            .remedy("Make the ends meet, or give a larger tolerance (a key of the case)")
    }

    /// Whether two ends of images coincide.
    fn meet(&self, p: DVec2, q: DVec2) -> bool {
        self.chart.same_place(p, q, self.tolerance)
    }

    /// Extends the chain from `at` by backtracking until it contains all curves and returns to `start`.
    fn extend(&mut self, chain: &mut Chain<'_>, start: DVec2, at: DVec2) -> bool {
        if chain.steps.len() == chain.list.len() {
            return self.meet(at, start);
        }
        if chain.steps.len() > chain.longest.0 {
            chain.longest = (chain.steps.len(), at);
        }
        if chain.patience == 0 {
            return false;
        }
        chain.patience -= 1;
        for i in 0..chain.list.len() {
            let curve = chain.list[i];
            // A curve that is listed twice is used in the order of the list.
            if chain.used[i] || (0..i).any(|j| !chain.used[j] && chain.list[j] == curve) {
                continue;
            }
            for forward in [true, false] {
                for sheet in 0..self.moves.len() {
                    // A curve is not traversed twice on the same sheet.
                    if chain.steps.iter().any(|&(j, s, _)| chain.list[j] == curve && s == sheet) {
                        continue;
                    }
                    let Ok(image) = self.image(curve, sheet) else { continue };
                    let (from, to) = (image.point(0.0), image.point(1.0));
                    let (from, to) = if forward { (from, to) } else { (to, from) };
                    if !self.meet(from, at) {
                        continue;
                    }
                    chain.used[i] = true;
                    chain.steps.push((i, sheet, forward));
                    if self.extend(chain, start, to) {
                        return true;
                    }
                    chain.steps.pop();
                    chain.used[i] = false;
                }
            }
        }
        false
    }

    /// The pieces, translated by whole periods into the polygon `around` if that is possible.
    pub fn brought_inside(&self, pieces: Vec<Piece>, around: &[DVec2]) -> Vec<Piece> {
        if !self.chart.keeps_lines() {
            return pieces;
        }
        let probe: Vec<DVec2> = pieces.iter().flat_map(|piece| piece.image.points()).collect();
        let shift = |by: &DVec2| self.chart.of_uv(*by) - self.chart.of_uv(DVec2::ZERO);
        let inside = |by: &&DVec2| probe.iter().filter(|p| Self::holds(around, **p + shift(by))).count();
        // The translation with the most points inside, the first among equals.
        let best = self.moves.iter().rev().max_by_key(inside).map_or(DVec2::ZERO, shift);
        pieces.into_iter().map(|piece| Piece { image: piece.image.moved(best), ..piece }).collect()
    }

    /// The polygon of a loop, in its order.
    pub fn polygon(pieces: &[Piece]) -> Vec<DVec2> {
        let mut points = Vec::new();
        for piece in pieces {
            let mut own: Vec<DVec2> = piece.image.points().collect();
            if !piece.forward {
                own.reverse();
            }
            own.pop();
            points.extend(own);
        }
        points
    }

    /// Whether a polygon contains a point, by ray crossings; on the boundary the answer is arbitrary.
    pub fn holds(polygon: &[DVec2], p: DVec2) -> bool {
        let mut inside = false;
        for (i, a) in polygon.iter().enumerate() {
            let b = polygon[(i + 1) % polygon.len()];
            if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) {
                inside = !inside;
            }
        }
        inside
    }
}
