//! The loops that must be even (docs/algorithm.md, "Even loops"): the walks along the borders of the faces, and what
//! narrow gaps leave of them.

use std::collections::BTreeMap;

use smallvec::SmallVec;

use super::{CurveId, DirectedCurve, Division};
use crate::core::geometry::{Domain, DomainFace};
use crate::core::kernel::parity;

/// A side of a piece: its curve, its number, whether it is the left one.
pub(super) type Side = (CurveId, usize, bool);

/// Which loops each piece is on.
pub(super) struct Loops {
    /// For each loop whether its number of segments is odd.
    pub odd: Vec<bool>,
    /// For each piece of each curve the loops that pass it an odd number of times, ascending.
    pub of: Vec<Vec<SmallVec<[u32; 2]>>>,
}

/// Pieces of which one may get a segment more or fewer, to make loops even.
struct Column {
    /// The loops that this changes, ascending.
    rows: Vec<u32>,
    /// The cheapest change: the resulting relative length error, of what, the new number. `None` where all is fixed.
    toggle: Option<(f64, Toggled, u32)>,
}

/// What gets a segment more or fewer.
#[derive(Clone, Copy)]
enum Toggled {
    /// A piece of a curve.
    Piece(usize, usize),
    /// All pieces of a tie.
    Tie(usize),
}

impl Loops {
    /// Without any loop.
    fn none(division: &Division<'_>) -> Loops {
        let of = division.pieces.iter().map(|pieces| vec![SmallVec::new(); pieces.len()]).collect();
        Loops { odd: Vec::new(), of }
    }

    /// Begins a loop; one with so many segments on rungs.
    fn begin(&mut self, rungs: usize) {
        self.odd.push(rungs % 2 == 1);
    }

    /// Lets the last loop pass a piece.
    fn pass(&mut self, (curve, piece): (CurveId, usize), segments: u32) {
        let Some(last) = self.odd.len().checked_sub(1) else { return };
        self.odd[last] ^= segments % 2 == 1;
        let known = &mut self.of[curve.index()][piece];
        if known.last() == Some(&(last as u32)) {
            known.pop();
        } else {
            known.push(last as u32);
        }
    }
}

/// The walks of all faces, in their order, each with the number of its face.
pub(super) fn walks(domain: &Domain) -> impl Iterator<Item = (usize, &Vec<DirectedCurve>)> {
    domain.faces.iter().enumerate().flat_map(|(f, face)| face.walks.iter().map(move |walk| (f, walk)))
}

impl Division<'_> {
    /// The loops that are the walks.
    pub(super) fn whole_loops(&self) -> Loops {
        let mut loops = Loops::none(self);
        for (_, walk) in walks(self.domain) {
            self.add_walk(walk, &mut loops);
        }
        loops
    }

    /// The walks, and the loops that are left of them when the narrow gaps are cut off along the rungs at their ends: a
    /// row of quadrilaterals goes through a gap alone only if these are even too.
    pub(super) fn loops_beside_gaps(&self) -> Loops {
        let mut loops = self.whole_loops();
        for face in &self.domain.faces {
            self.add_cut(face, &mut loops);
        }
        loops
    }

    fn add_walk(&self, walk: &[DirectedCurve], loops: &mut Loops) {
        loops.begin(0);
        for curve in walk.iter().map(|step| self.first(step.curve)) {
            for (k, piece) in self.pieces[curve.index()].iter().enumerate() {
                loops.pass((curve, k), piece.segments);
            }
        }
    }

    fn add_cut(&self, face: &DomainFace, loops: &mut Loops) {
        let mut sides: Vec<Side> = Vec::new();
        let mut next: Vec<usize> = Vec::new();
        for walk in &face.walks {
            let begin = sides.len();
            for step in walk {
                let curve = self.first(step.curve);
                let count = self.pieces[curve.index()].len();
                sides.extend((0..count).map(|k| (curve, if step.forward { k } else { count - 1 - k }, step.forward)));
            }
            next.extend(begin + 1..sides.len());
            next.push(begin);
        }
        let number: BTreeMap<Side, usize> = sides.iter().copied().zip(0..).collect();
        let beyond = |side: &Side| self.across_gaps.get(side).and_then(|side| number.get(side)).copied();
        let partner: Vec<Option<usize>> = sides.iter().map(beyond).collect();
        let mut is_seen: Vec<bool> = partner.iter().map(Option::is_some).collect();
        if is_seen.iter().all(|is| !is) {
            return;
        }
        for from in 0..sides.len() {
            if is_seen[from] {
                continue;
            }
            let (mut at, mut passed, mut rungs) = (from, Vec::new(), 0);
            while !is_seen[at] {
                is_seen[at] = true;
                passed.push(at);
                at = next[at];
                // A rung leads to the end of the piece beyond.
                while let Some(beyond) = partner[at].filter(|_| rungs <= sides.len() * self.layers as usize) {
                    rungs += self.layers as usize;
                    at = next[beyond];
                }
            }
            loops.begin(rungs);
            for (curve, piece, _) in passed.into_iter().map(|i| sides[i]) {
                loops.pass((curve, piece), self.pieces[curve.index()][piece].segments);
            }
        }
    }

    /// Makes loops even.
    ///
    /// # Errors
    /// The numbers of loops that cannot be even together.
    pub(super) fn even_once(&mut self, loops: &Loops) -> Result<(), Vec<u32>> {
        let mut columns: Vec<Column> = Vec::new();
        for (c, of) in loops.of.iter().enumerate() {
            // Any piece of a curve will do, as far as the pieces are on the same loops.
            let mut alike: BTreeMap<&[u32], Vec<usize>> = BTreeMap::new();
            for (k, rows) in of.iter().enumerate().filter(|(k, _)| self.pieces[c][*k].tie.is_none()) {
                alike.entry(rows).or_default().push(k);
            }
            columns.extend(alike.into_iter().map(|(rows, pieces)| Column {
                rows: rows.to_vec(),
                toggle: self.best_toggle(c, &pieces).map(|(error, piece, n)| (error, Toggled::Piece(c, piece), n)),
            }));
        }
        for tie in 0..self.ties.len() {
            let mut rows: Vec<u32> = self.tied(tie).flat_map(|(c, k)| &loops.of[c.index()][k]).copied().collect();
            rows.sort_unstable();
            let odd = rows.chunk_by(|a, b| a == b).filter(|group| group.len() % 2 == 1);
            let toggle = self.best_toggle_of_tie(tie).map(|(error, n)| (error, Toggled::Tie(tie), n));
            columns.push(Column { rows: odd.map(|group| group[0]).collect(), toggle });
        }
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); loops.odd.len()];
        for (column, number) in columns.iter().zip(0..) {
            column.rows.iter().for_each(|&row| rows[row as usize].push(number));
        }
        let cost: Vec<Option<f64>> = columns.iter().map(|column| column.toggle.map(|toggle| toggle.0)).collect();
        let toggled = parity::toggles(&rows, &loops.odd, &cost)?;
        for (_, what, n) in columns.iter().zip(toggled).filter(|(_, is)| *is).filter_map(|(column, _)| column.toggle) {
            match what {
                Toggled::Piece(c, piece) => self.pieces[c][piece].segments = n,
                Toggled::Tie(tie) => {
                    self.set_tied(tie, n);
                }
            }
        }
        Ok(())
    }

    /// The cheapest change of the number of segments of one of these pieces of a curve by one: the resulting relative
    /// length error, the piece, its new number.
    fn best_toggle(&self, c: usize, pieces: &[usize]) -> Option<(f64, usize, u32)> {
        let curve = &self.domain.curves[c];
        if curve.segments.is_some() || curve.first.index() != c {
            return None;
        }
        let may_shrink = self.segments(CurveId(c as u32)) > self.least(curve);
        let mut best: Option<(f64, usize, u32)> = None;
        for (i, piece) in pieces.iter().map(|&i| (i, &self.pieces[c][i])) {
            let n = piece.segments;
            for changed in [n + 1, n - 1] {
                if (changed > n || (may_shrink && changed >= piece.least))
                    && best.is_none_or(|b| piece.error(changed) < b.0)
                {
                    best = Some((piece.error(changed), i, changed));
                }
            }
        }
        best
    }
}
