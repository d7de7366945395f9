//! The front as a table: every segment with the values that its selection depends on (4.3.3), its loop, and the order
//! in which the segments would be chosen.

use std::collections::BTreeSet;

use serde::{Serialize, Serializer};

use crate::core::case::{HMinOver, Parameters, Selection};
use crate::core::convert::Converter;
use crate::core::front::Segment;
use crate::core::front::segment::{Key, layer};
use crate::core::mesh::{HalfEdgeId, NodeId};

/// One segment of the front.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Its half-edge in its live triangle.
    pub h: HalfEdgeId,
    /// Left node.
    pub a: NodeId,
    /// Right node.
    pub b: NodeId,
    /// Class of table 1.
    pub class: u8,
    /// H-value (eq. 6).
    pub h_value: f64,
    /// Length in the metric.
    pub length_metric: f64,
    /// Length in the plane.
    pub length_physical: f64,
    /// Frontal angles at A and B, radians.
    #[serde(serialize_with = "degrees")]
    pub theta: [f64; 2],
    /// Rows from the boundary.
    pub level: u16,
    /// The number of its face on surfaces; 0 in the plane.
    pub face: u32,
    /// The index of its loop in [`FrontTable::loops`].
    pub front_loop: u32,
    /// Whether it is deferred until something near it changes.
    pub is_deferred: bool,
    /// The value compared with c Hmin.
    pub window: f64,
}

fn degrees<S: Serializer>(radians: &[f64; 2], serializer: S) -> Result<S::Ok, S::Error> {
    radians.map(f64::to_degrees).serialize(serializer)
}

/// One closed chain of the front.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Loop {
    /// Number of its segments, which should be even (docs/algorithm.md, "The parity invariant").
    pub segments: u32,
    /// Its length in the metric.
    pub length_metric: f64,
}

/// The sort key of the selection; the smallest comes first.
pub(super) type Order = (u8, Key, HalfEdgeId);

/// All segments of the front of a state.
#[derive(Clone, Debug)]
pub struct FrontTable {
    /// The segments, sorted by half-edge.
    pub rows: Vec<Row>,
    /// The loops.
    pub loops: Vec<Loop>,
    /// The smallest H-value (4.3.3, step i) over the segments that the parameters say; infinite where none waits.
    pub h_min: f64,
    /// The smallest layer of the waiting segments, where rows are offset first.
    pub(super) layer: u32,
    /// The face that is being converted; none where all is converted together.
    face: Option<u32>,
    pub(super) parameters: Parameters,
}

impl FrontTable {
    /// The front of a state.
    pub fn of(converter: &Converter<'_>) -> FrontTable {
        let (mesh, parameters) = (&converter.mesh, converter.parameters().clone());
        let mut rows = Vec::new();
        let mut place = vec![0_u32; 4 * mesh.element_slots()];
        for h in mesh.front() {
            let segment = Segment::measure(mesh, h, &parameters);
            rows.push(Row::of(&segment, mesh.is_deferred(h), &parameters));
            place[h.index()] = rows.len() as u32;
        }
        let mut loops = Vec::new();
        let mut seen = vec![false; rows.len()];
        for first in 0..rows.len() {
            if seen[first] {
                continue;
            }
            let mut met = Loop { segments: 0, length_metric: 0.0 };
            let mut at = first;
            while !std::mem::replace(&mut seen[at], true) {
                rows[at].front_loop = loops.len() as u32;
                met.segments += 1;
                met.length_metric += rows[at].length_metric;
                // A loop of the front consists of front segments only.
                at = place[mesh.front_after(rows[at].h).index()] as usize - 1;
            }
            loops.push(met);
        }
        let face = converter.face();
        let mut table = FrontTable { rows, loops, h_min: f64::INFINITY, layer: 0, face, parameters };
        table.layer = table.waiting().map(|row| row.layer(&table.parameters)).min().unwrap_or(0);
        table.h_min = table.least().map_or(f64::INFINITY, |row| row.h_value);
        table
    }

    /// The parameters by which it is ordered.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// The value below which a key is within reach: c Hmin (4.3.3, step ii).
    pub fn reach(&self) -> f64 {
        self.parameters.c * self.h_min
    }

    /// The segment that has Hmin (4.3.3, step i); `None` where none counts.
    pub fn least(&self) -> Option<&Row> {
        let counts = |row: &&Row| match self.parameters.h_min_over {
            HMinOver::Front if row.is_deferred => self.is_of_face(row),
            _ => self.competes(row),
        };
        self.rows.iter().filter(counts).min_by(|a, b| a.h_value.total_cmp(&b.h_value).then(a.h.cmp(&b.h)))
    }

    /// The face that is being converted, from 0; `None` where all are at once.
    pub fn face(&self) -> Option<u32> {
        self.face
    }

    /// Whether a segment is on the face that is being converted.
    pub fn is_of_face(&self, row: &Row) -> bool {
        self.face.is_none_or(|face| row.face == face)
    }

    /// Whether no front is left on the face that is being converted.
    pub fn is_closed(&self) -> bool {
        !self.rows.iter().any(|row| self.is_of_face(row))
    }

    /// Whether a segment waits, on the current face and in the row that is offset first, if rows are.
    pub fn competes(&self, row: &Row) -> bool {
        !row.is_deferred && self.is_of_face(row) && row.layer(&self.parameters) == self.layer
    }

    /// The segment from A to B.
    pub fn find(&self, a: NodeId, b: NodeId) -> Option<&Row> {
        self.rows.iter().find(|row| row.a == a && row.b == b)
    }

    /// The segment that the rules would choose; `None` where every segment of the current face is deferred.
    pub fn choice(&self) -> Option<&Row> {
        self.waiting().min_by_key(|row| self.order(row))
    }

    /// The number of waiting segments that come before this one: 0 for the choice itself. `None` where it is deferred,
    /// or on a face that is converted later.
    pub fn rank(&self, row: &Row) -> Option<usize> {
        if row.is_deferred || !self.is_of_face(row) {
            return None;
        }
        let order = self.order(row);
        Some(self.waiting().filter(|other| self.order(other) < order).count())
    }

    /// The indices of the rows in the order in which they would be chosen; deferred ones come last.
    pub fn in_order(&self) -> Vec<usize> {
        let mut places: Vec<usize> = (0..self.rows.len()).collect();
        places.sort_by_cached_key(|&place| (self.rows[place].is_deferred, self.order(&self.rows[place])));
        places
    }

    /// The number of waiting segments, on the current face.
    pub fn waiting_count(&self) -> usize {
        self.waiting().count()
    }

    pub(super) fn waiting(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| !row.is_deferred && self.is_of_face(row))
    }

    /// Whether the segment is within c Hmin and of class 1, 2 or 3 (4.3.3, steps ii and iii).
    pub fn is_within_reach(&self, row: &Row) -> bool {
        row.class < 4 && row.layer(&self.parameters) == self.layer && row.window < self.reach()
    }

    /// The sort key of a segment.
    pub(super) fn order(&self, row: &Row) -> Order {
        let layer = f64::from(row.layer(&self.parameters));
        if self.parameters.selection != Selection::Table1 {
            let Key([first, second, third]) = row.key(&self.parameters);
            return (0, Key([layer * 1e9 + first, second, third]), row.h);
        }
        if self.is_within_reach(row) {
            return (row.class, Key([layer, row.window, row.theta_sum()]), row.h);
        }
        (4, Key([layer, row.h_value, row.theta_sum()]), row.h)
    }

    /// The interval of c, from (excluded) to (included), in which this segment stays the choice, all else unchanged.
    /// `None` where it is not the choice, or where the selection does not depend on c.
    pub fn margin_of_c(&self, row: &Row) -> Option<[f64; 2]> {
        if self.parameters.selection != Selection::Table1 || self.choice()?.h != row.h {
            return None;
        }
        let best = BestOfClass::of(self);
        let c = self.parameters.c;
        // The choice changes only where the best segment of a class comes within reach, at window = c Hmin.
        let bounds = best.bounds_of_c(self.h_min);
        let mut at = bounds.partition_point(|bound| *bound < c).clamp(1, bounds.len() - 1);
        let stays = |low: f64, high: f64| best.choice(between(low, high) * self.h_min) == Some(row.h);
        let (mut low, mut high) = (bounds[at - 1], bounds[at]);
        for k in (1..at).rev() {
            if bounds[k - 1] < bounds[k] && !stays(bounds[k - 1], bounds[k]) {
                break;
            }
            low = bounds[k - 1];
        }
        while at + 1 < bounds.len() && (bounds[at] == bounds[at + 1] || stays(bounds[at], bounds[at + 1])) {
            at += 1;
            high = bounds[at];
        }
        Some([low, high])
    }

    /// The first interval of c, from (excluded) to (included), in which a segment that is not the choice would be it,
    /// all else unchanged. `None` where there is none, or where the selection does not depend on c.
    pub fn chosen_for_c(&self, row: &Row) -> Option<[f64; 2]> {
        let is_waiting = !row.is_deferred && self.is_of_face(row);
        if self.parameters.selection != Selection::Table1 || !is_waiting || self.choice()?.h == row.h {
            return None;
        }
        let best = BestOfClass::of(self);
        let mut bounds = best.bounds_of_c(self.h_min);
        bounds.dedup();
        let chosen = |pair: &&[f64]| best.choice(between(pair[0], pair[1]) * self.h_min) == Some(row.h);
        let mut found = bounds.windows(2).skip_while(|pair| !chosen(pair)).take_while(chosen);
        let first = found.next()?;
        Some([first[0], found.last().map_or(first[1], |pair| pair[1])])
    }

    /// The interval of theta_rect in radians, from (excluded) to (included), between 90 and 180 degrees, in which this
    /// segment stays the choice, all else unchanged. `None` where it is not the choice, or where the selection does not
    /// depend on it.
    pub fn margin_of_theta_rect(&self, row: &Row) -> Option<[f64; 2]> {
        let rect = self.parameters.theta_rect;
        if self.parameters.selection != Selection::Table1 || self.choice()?.h != row.h {
            return None;
        }
        let limits = [std::f64::consts::FRAC_PI_2, std::f64::consts::PI];
        // The classes change only where theta_rect crosses a frontal angle.
        let mut turns: Vec<(f64, usize)> = Vec::new();
        for (i, row) in self.rows.iter().enumerate().filter(|(_, row)| self.competes(row)) {
            turns.extend(row.theta.iter().filter(|t| (limits[0]..=limits[1]).contains(*t)).map(|&t| (t, i)));
        }
        turns.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        // A frontal angle equal to theta_rect does not count as below it.
        let first_above = turns.partition_point(|turn| turn.0 < rect);
        let reach = self.parameters.c * self.h_min;
        let walk = |turns: &mut dyn Iterator<Item = (f64, usize)>, up: bool| {
            let mut best = BestOfClass::of(self);
            let mut turns = turns.peekable();
            while let Some((angle, i)) = turns.next() {
                let other = &self.rows[i];
                // Once theta_rect exceeds its angle, an end counts as a side. Equal angles change together.
                let below = |t: f64| if up { t <= angle } else { t < angle };
                best.put(self, other, class_of(other.theta.map(below)));
                let decided = turns.peek().is_none_or(|next| next.0 != angle);
                if decided && best.choice(reach) != Some(row.h) {
                    return Some(angle);
                }
            }
            None
        };
        let high = walk(&mut turns[first_above..].iter().copied(), true);
        let low = walk(&mut turns[..first_above].iter().rev().copied(), false);
        Some([low.unwrap_or(limits[0]), high.unwrap_or(limits[1])])
    }
}

impl Row {
    fn of(segment: &Segment, is_deferred: bool, parameters: &Parameters) -> Row {
        Row {
            h: segment.h,
            a: segment.a,
            b: segment.b,
            class: segment.class,
            h_value: segment.h_value,
            length_metric: segment.length_metric,
            length_physical: segment.length_physical,
            theta: segment.theta,
            level: segment.level,
            face: segment.face,
            front_loop: 0,
            is_deferred,
            window: segment.window(parameters.selection_window),
        }
    }

    fn key(&self, parameters: &Parameters) -> Key {
        let Row { h, a, b, class, h_value, length_metric, length_physical, theta, level, face, .. } = *self;
        Segment { h, a, b, class, h_value, length_metric, length_physical, theta, level, face }.key(parameters)
    }

    /// The key by which it is ordered, without what decides where keys are equal.
    pub fn primary_key(&self, parameters: &Parameters) -> Key {
        let Key(key) = self.key(parameters);
        if parameters.selection == Selection::Level { Key(key) } else { Key([key[0], 0.0, 0.0]) }
    }

    pub(super) fn theta_sum(&self) -> f64 {
        self.theta[0] + self.theta[1]
    }

    pub(super) fn layer(&self, parameters: &Parameters) -> u32 {
        layer(self.face, self.level, parameters)
    }
}

/// The class of table 1, from whether the angles at A and at B are below theta_rect.
fn class_of(below: [bool; 2]) -> u8 {
    match below {
        [true, true] => 1,
        [true, false] => 2,
        [false, true] => 3,
        [false, false] => 4,
    }
}

/// A value between two bounds, of which the upper one may be infinite.
fn between(low: f64, high: f64) -> f64 {
    if high.is_finite() { 0.5 * (low + high) } else { low + 1.0 }
}

/// The waiting segments of the smallest layer in classes 1 to 3, each class in order.
struct BestOfClass {
    classes: [BTreeSet<(Key, HalfEdgeId)>; 3],
    smallest: Option<HalfEdgeId>,
}

impl BestOfClass {
    fn of(table: &FrontTable) -> BestOfClass {
        let of_layer = || table.rows.iter().filter(|row| table.competes(row));
        let smallest = of_layer().min_by_key(|row| (Key([0.0, row.h_value, row.theta_sum()]), row.h));
        let mut best = BestOfClass { classes: Default::default(), smallest: smallest.map(|row| row.h) };
        for row in of_layer() {
            best.put(table, row, row.class);
        }
        best
    }

    /// Moves a segment into a class.
    fn put(&mut self, table: &FrontTable, row: &Row, class: u8) {
        if row.layer(&table.parameters) != table.layer {
            return;
        }
        let entry = (Key([0.0, row.window, row.theta_sum()]), row.h);
        for (k, waiting) in (1..).zip(&mut self.classes) {
            if k == class {
                waiting.insert(entry);
            } else {
                waiting.remove(&entry);
            }
        }
    }

    /// The values of c at which the choice may change, sorted, between 0 and infinity.
    fn bounds_of_c(&self, h_min: f64) -> Vec<f64> {
        let firsts = self.classes.iter().filter_map(|waiting| waiting.first());
        let mut bounds: Vec<f64> = firsts.map(|(Key([_, window, _]), _)| window / h_min).collect();
        bounds.extend([0.0, f64::INFINITY]);
        bounds.sort_unstable_by(f64::total_cmp);
        bounds
    }

    /// The choice where segments with a window value below `reach` are within reach.
    fn choice(&self, reach: f64) -> Option<HalfEdgeId> {
        let firsts = self.classes.iter().filter_map(|waiting| waiting.first());
        let within = firsts.into_iter().find(|(Key([_, window, _]), _)| *window < reach);
        within.map(|(_, h)| *h).or(self.smallest)
    }
}
