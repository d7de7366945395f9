//! Lifting of loops of space curves into the chart of a face. On a closed surface, a curve has an image on every sheet,
//! and a loop is a chain of images that closes in the chart itself. A seam occurs twice in its loop, once from either
//! side.

use std::sync::Arc;

use glam::DVec2;
use rustc_hash::FxHashMap;

use super::chart::Chart;
use super::image::Image;
use super::named_curve::{NamedCurve, image_on};
use crate::core::fault::Fault;
use crate::core::kernel::decimal::{number, point_text};

/// Ends of images closer than this fraction of the surface's size coincide.
const MEET: f64 = 1e-6;

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

/// Images of curves in one chart.
pub(super) struct Lift<'a> {
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
    pub fn new(chart: &'a Arc<Chart>, curves: &'a [NamedCurve], face: &'a str) -> Lift<'a> {
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
        Lift { chart, curves, face, images: FxHashMap::default(), moves }
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
            image_on(self.chart, &self.curves[curve], by, self.face)
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
        let outside = image.uvs().find(|uv| {
            (0..2).any(|axis| {
                let [first, last] = domain[axis];
                let margin = 1e-6 * (last - first);
                let t = [uv.x, uv.y][axis];
                !(goes_round && surface.closed()[axis] || t >= first - margin && t <= last + margin)
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

    /// Extends the chain from `at` by backtracking until it contains all curves and returns to `start`.
    fn extend(&mut self, chain: &mut Chain<'_>, start: DVec2, at: DVec2) -> bool {
        let tolerance = MEET * self.chart.surface().size();
        if chain.steps.len() == chain.list.len() {
            return at.distance(start) <= tolerance;
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
                    if from.distance(at) > tolerance {
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
