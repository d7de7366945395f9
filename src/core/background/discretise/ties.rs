//! Pieces that face each other across narrow gaps: they get equal counts, and nodes that face each other.

use std::collections::BTreeMap;

use super::gaps::{Gaps, SAME, Stretch, straightened};
use super::{CurveId, Division, Piece, give_least};
use crate::core::fault::Fault;
use crate::core::geometry::Domain;

/// Pieces that face each other, directly or across others. The first divides itself, the others follow.
#[derive(Clone, Debug)]
pub(super) struct Tie {
    members: Vec<Member>,
}

/// A curve and the number of a piece of it.
type Place = (CurveId, usize);

#[derive(Clone, Debug)]
struct Member {
    curve: CurveId,
    piece: usize,
    /// The member that it follows; `None` for the first.
    follows: Option<Facing>,
}

#[derive(Clone, Debug)]
struct Facing {
    member: usize,
    /// Parameters of facing places, on the other member ascending, and here.
    rungs: Vec<[f64; 2]>,
    /// Whether rungs stand at right angles on the other member.
    upright: bool,
}

impl Division<'_> {
    /// The same division, in which the stretches along narrow gaps are pieces that are tied to each other.
    ///
    /// # Errors
    /// If the metric fails.
    pub fn across(mut self, gaps: &Gaps) -> Result<Self, Fault> {
        let mut cuts: BTreeMap<CurveId, Vec<f64>> = BTreeMap::new();
        for side in gaps.strips.iter().flat_map(|strip| &strip.sides) {
            cuts.entry(side.curve).or_default().extend([side.from, side.to]);
        }
        for (curve, cuts) in &mut cuts {
            cuts.sort_by(f64::total_cmp);
            let along = self.along(&self.domain.curves[curve.index()]);
            for &t in cuts.iter() {
                let pieces = &mut self.pieces[curve.index()];
                let room = |piece: &Piece| piece.length_at(t).min(piece.length() - piece.length_at(t));
                let is_inside = |piece: &Piece| piece.start() < t && t < piece.end() && room(piece) > SAME;
                if let Some(k) = pieces.iter().position(is_inside) {
                    let parts = pieces[k].cut(&along, t)?;
                    pieces.splice(k..=k, parts);
                }
            }
        }
        for curve in cuts.into_keys().map(|id| &self.domain.curves[id.index()]) {
            let (along, least) = (self.along(curve), self.least(curve));
            let pieces = &mut self.pieces[curve.first.index()];
            for piece in pieces.iter_mut() {
                piece.divide(&along);
                if let Some(turning) = &curve.turning {
                    piece.keeps_shape(&along, turning)?;
                    piece.segments = piece.segments.max(piece.least);
                }
            }
            give_least(pieces, least);
        }
        self.layers = gaps.layers;
        self.tie(gaps);
        self.level_ties();
        Ok(self)
    }

    /// Ties the pieces along gaps.
    fn tie(&mut self, gaps: &Gaps) {
        let place = |this: &Self, side: &Stretch| (side.curve, this.piece_at(side.curve, 0.5 * (side.from + side.to)));
        // The strips at each piece: the number, whether it is the first side, and the piece beyond.
        type Strips = Vec<(usize, bool, Place)>;
        let mut at: BTreeMap<Place, Strips> = BTreeMap::new();
        for (k, strip) in gaps.strips.iter().enumerate() {
            let [a, b] = [0, 1].map(|i| place(self, &strip.sides[i]));
            at.entry(a).or_default().push((k, true, b));
            at.entry(b).or_default().push((k, false, a));
            let is_alike = strip.rungs[0][1] < strip.rungs[1][1];
            let sides = [(a.0, a.1, strip.is_left), (b.0, b.1, strip.is_left != is_alike)];
            self.across_gaps.extend([(sides[0], sides[1]), (sides[1], sides[0])]);
        }
        for strip in &gaps.strips {
            let root = place(self, &strip.sides[0]);
            if self.piece(root).tie.is_some() {
                continue;
            }
            let number = self.ties.len() as u32;
            let mut members = vec![Member { curve: root.0, piece: root.1, follows: None }];
            self.piece_mut(root).tie = Some(number);
            let mut next = 0;
            while let Some(member) = members.get(next) {
                for &(k, is_first, other) in at.get(&(member.curve, member.piece)).into_iter().flatten() {
                    if self.piece(other).tie.is_some() {
                        continue;
                    }
                    self.piece_mut(other).tie = Some(number);
                    let mut rungs = gaps.strips[k].rungs.clone();
                    if !is_first {
                        rungs.iter_mut().for_each(|rung| rung.reverse());
                        rungs.sort_by(|a, b| a[0].total_cmp(&b[0]));
                    }
                    let follows = Some(Facing { member: next, rungs, upright: is_first });
                    members.push(Member { curve: other.0, piece: other.1, follows });
                }
                next += 1;
            }
            self.ties.push(Tie { members });
        }
    }

    fn piece(&self, (curve, piece): Place) -> &Piece {
        &self.pieces[curve.index()][piece]
    }

    fn piece_mut(&mut self, (curve, piece): Place) -> &mut Piece {
        &mut self.pieces[curve.index()][piece]
    }

    /// The pieces of a tie.
    pub(super) fn tied(&self, tie: usize) -> impl Iterator<Item = Place> {
        self.ties[tie].members.iter().map(|member| (member.curve, member.piece))
    }

    /// Whether pieces that face each other have different numbers of segments.
    pub fn is_unlevel(&self) -> bool {
        let counts = |tie: usize| self.tied(tie).map(|place| self.piece(place).segments);
        (0..self.ties.len()).any(|tie| counts(tie).any(|count| counts(tie).next() != Some(count)))
    }

    /// Gives all pieces of a tie as many segments as the one with the most; whether any piece has changed.
    pub fn level_ties(&mut self) -> bool {
        let mut has_changed = false;
        for tie in 0..self.ties.len() {
            let most = self.tied(tie).map(|place| self.piece(place).segments).max().unwrap_or(1);
            has_changed |= self.set_tied(tie, most);
        }
        has_changed
    }

    /// Gives all pieces of a tie this many segments; whether any piece has changed.
    pub(super) fn set_tied(&mut self, tie: usize, segments: u32) -> bool {
        let mut has_changed = false;
        for place in self.tied(tie).collect::<Vec<_>>() {
            let piece = self.piece_mut(place);
            has_changed |= piece.segments != segments;
            piece.segments = segments;
        }
        has_changed
    }

    /// Lets all pieces be divided alone.
    pub(super) fn untie(&mut self) {
        self.ties.clear();
        self.across_gaps.clear();
        self.pieces.iter_mut().flatten().for_each(|piece| piece.tie = None);
    }

    /// The cheapest change of the number of segments of a tie by one: the resulting relative length error, the new
    /// number.
    pub(super) fn best_toggle_of_tie(&self, tie: usize) -> Option<(f64, u32)> {
        let places = || self.tied(tie).map(|place| self.piece(place));
        let n = places().next()?.segments;
        let least_of = |(curve, piece): Place| {
            let least = self.domain.least_segments(curve);
            self.pieces[curve.index()][piece].least.max(least)
        };
        let least = self.tied(tie).map(least_of).max()?;
        let error = |n: u32| places().map(|piece| piece.error(n)).fold(0.0, f64::max);
        let changed = [n + 1, n - 1].into_iter().filter(|&changed| changed > n || n > least);
        changed.map(|n| (error(n), n)).min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The parameters that divide the tied pieces.
    ///
    /// # Errors
    /// If the metric fails.
    pub(super) fn facing_places(&self) -> Result<BTreeMap<Place, Vec<f64>>, Fault> {
        let mut all = BTreeMap::new();
        for tie in &self.ties {
            let mut places: Vec<Vec<f64>> = Vec::new();
            for member in &tie.members {
                let place = (member.curve, member.piece);
                let own = match &member.follows {
                    None => self.piece(place).divisions(&self.along(&self.domain.curves[member.curve.index()]))?,
                    Some(facing) => {
                        let other = tie.members[facing.member].curve;
                        facing.places(self.domain, [other, member.curve], &places[facing.member])
                    }
                };
                all.insert(place, own.clone());
                places.push(own);
            }
        }
        Ok(all)
    }
}

impl Facing {
    /// The parameters here, ascending, that face those on the other curve.
    fn places(&self, domain: &Domain, [other, own]: [CurveId; 2], theirs: &[f64]) -> Vec<f64> {
        let [other, own] = [other, own].map(|id| &domain.curves[id.index()]);
        let between = |s: f64| {
            let k = self.rungs.partition_point(|rung| rung[0] <= s).clamp(1, self.rungs.len() - 1);
            let ([s0, t0], [s1, t1]) = (self.rungs[k - 1], self.rungs[k]);
            t0 + (t1 - t0) * ((s - s0) / (s1 - s0)).clamp(0.0, 1.0)
        };
        let upright = |s: f64| {
            let (p, slope) = other.curve.at(s);
            straightened(own, between(s), p, slope.perp())
        };
        let ascending = |mut places: Vec<f64>| {
            if places.first() > places.last() {
                places.reverse();
            }
            places
        };
        let guessed = ascending(theirs.iter().map(|&s| between(s)).collect());
        if !self.upright {
            return guessed;
        }
        let exact = ascending(theirs.iter().map(|&s| upright(s)).collect());
        let [from, to] = [self.rungs[0][1], self.rungs[self.rungs.len() - 1][1]];
        let all = [from.min(to)].into_iter().chain(exact.iter().copied()).chain([from.max(to)]);
        let all: Vec<f64> = all.collect();
        if all.windows(2).all(|w| w[0] < w[1]) { exact } else { guessed }
    }
}
