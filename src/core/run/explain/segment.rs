//! A segment of the front with all that its selection depends on (4.3.3).

use serde::Serialize;

use super::{Corner, MetricFacts};
use crate::core::case::{Parameters, Selection};
use crate::core::mesh::{Mesh, NodeId};
use crate::core::run::front_table::{FrontTable, Loop, Row};

/// The place of a segment in the order of the rules (4.3.3, table 1), and what puts it there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Verdict {
    /// It comes first.
    First,
    /// It is deferred until something near it changes.
    Deferred,
    /// Its face is converted later.
    LaterFace,
    /// Rows nearer to the boundary come first.
    LaterRow,
    /// Its key is not below c Hmin (steps ii and iii), and there are segments whose keys are.
    OutOfReach,
    /// It is of class 4: such a segment is chosen, by its H-value, only where no other is within reach (step iii).
    ClassFour,
    /// A segment of a better class is within reach.
    BetterClass {
        /// That class.
        class: u8,
    },
    /// Another segment of its class has a smaller key; or of all segments, where the order is not that of table 1.
    LargerKey,
    /// No segment is within reach, and another one has a smaller H-value (step iii).
    LargerH,
    /// The first segment has the same key, or H-value, and a smaller sum of frontal angles; or a lower id.
    Tied,
}

impl Verdict {
    fn of(table: &FrontTable, row: &Row) -> Verdict {
        if row.is_deferred {
            return Verdict::Deferred;
        }
        if !table.is_of_face(row) {
            return Verdict::LaterFace;
        }
        let Some(choice) = table.choice() else { return Verdict::Deferred };
        if choice.h == row.h {
            return Verdict::First;
        }
        if !table.competes(row) {
            return Verdict::LaterRow;
        }
        let parameters = &table.parameters;
        if parameters.selection != Selection::Table1 {
            let [key, least] = [row, choice].map(|row| row.primary_key(parameters));
            return if key > least { Verdict::LargerKey } else { Verdict::Tied };
        }
        match [row, choice].map(|row| table.is_within_reach(row)) {
            [true, _] if choice.class < row.class => Verdict::BetterClass { class: choice.class },
            [true, _] if choice.window < row.window => Verdict::LargerKey,
            [false, true] if row.class == 4 => Verdict::ClassFour,
            [false, true] => Verdict::OutOfReach,
            [false, false] if choice.h_value < row.h_value => Verdict::LargerH,
            _ => Verdict::Tied,
        }
    }
}

/// A segment of the front, explained.
#[derive(Clone, Debug, Serialize)]
pub struct SegmentFacts {
    /// Its numbers.
    pub row: Row,
    /// The metrics of A and B.
    pub metric: [MetricFacts; 2],
    /// The smallest sizes at A and B, whose mean is the H-value (eq. 6): on surfaces those in space.
    pub smallest_sizes: [f64; 2],
    /// Length in the parametric plane; that in space is `row.length_physical`.
    pub length_parametric: f64,
    /// The classes of its frontal angles.
    pub corners: [Corner; 2],
    /// Its loop.
    pub front_loop: Loop,
    /// The smallest H-value (step i).
    pub h_min: f64,
    /// The value below which a key is within reach: c Hmin.
    pub reach: f64,
    /// How many waiting segments come before it, and how many there are; `None` where it is deferred.
    pub rank: Option<(usize, usize)>,
    /// Its place in the order of the rules.
    pub verdict: Verdict,
    /// Whether it is the base of the current quadrilateral.
    pub is_base: bool,
    /// Where it comes first: the interval of c in which it stays first.
    pub margin_of_c: Option<[f64; 2]>,
    /// Where it does not come first: an interval of c in which it would.
    pub chosen_for_c: Option<[f64; 2]>,
    /// Where it comes first: the interval of theta_rect in which it stays first, in degrees.
    pub margin_of_theta_rect: Option<[f64; 2]>,
    /// Why it was or was not selected, or would or would not be selected now: sentences.
    pub why: Vec<String>,
    #[serde(skip)]
    pub(super) parameters: Parameters,
}

impl SegmentFacts {
    /// A segment of a front, without the sentences; `None` where it is not on it.
    pub(super) fn of(table: &FrontTable, mesh: &Mesh, [a, b]: [NodeId; 2], is_base: bool) -> Option<SegmentFacts> {
        let row = *table.find(a, b)?;
        Some(SegmentFacts {
            row,
            metric: [a, b].map(|n| MetricFacts::of(mesh, n)),
            smallest_sizes: [a, b].map(|n| mesh.smallest_size(n)),
            length_parametric: mesh.uv(a).distance(mesh.uv(b)),
            corners: row.theta.map(|theta| Corner::of(theta, &table.parameters)),
            front_loop: table.loops[row.front_loop as usize],
            h_min: table.h_min,
            reach: table.reach(),
            rank: table.rank(&row).map(|rank| (rank, table.waiting_count())),
            verdict: Verdict::of(table, &row),
            is_base,
            margin_of_c: table.margin_of_c(&row),
            chosen_for_c: table.chosen_for_c(&row),
            margin_of_theta_rect: table.margin_of_theta_rect(&row).map(|margin| margin.map(f64::to_degrees)),
            why: Vec::new(),
            parameters: table.parameters.clone(),
        })
    }
}
