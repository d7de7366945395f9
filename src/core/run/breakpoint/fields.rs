//! The fields that conditions can name, each with what it means.

use super::Moment;
use crate::core::convert::event::{Event, Why};

/// What a field holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// A number.
    Number,
    /// An angle in degrees.
    Degrees,
    /// Yes or no: the field alone is a condition.
    Flag,
    /// The kind of an event.
    Kind,
    /// Why an attempt was taken back.
    Why,
    /// left or right.
    Side,
}

impl Holds {
    /// The words that can be compared with; none for numbers and flags.
    pub fn words(self) -> &'static [&'static str] {
        match self {
            Holds::Kind => Event::KINDS,
            Holds::Why => &[
                "no_side",
                "no_division",
                "top_blocked",
                "top_through_node",
                "top_too_long",
                "too_long",
                "not_disc",
                "not_convex",
                "poor",
                "odd_loop",
                "no_metric",
            ],
            Holds::Side => &["left", "right"],
            Holds::Flag => &["true", "false"],
            Holds::Number | Holds::Degrees => &[],
        }
    }
}

/// What a field has, or is compared with.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Flag(bool),
    Word(String),
}

/// A field that conditions can name.
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub holds: Holds,
    /// What it means, for whoever writes a condition.
    pub doc: &'static str,
    pub(super) of: fn(&Moment<'_>) -> Option<Value>,
}

fn number(n: impl Into<f64>) -> Option<Value> {
    Some(Value::Number(n.into()))
}

fn degrees(radians: f64) -> Option<Value> {
    number(radians.to_degrees())
}

/// A field of one kind of event.
macro_rules! of_event {
    ($pattern:pat => $value:expr) => {
        |moment| match *moment.event {
            $pattern => $value,
            _ => None,
        }
    };
}

/// All fields, in the order in which they are offered.
pub const FIELDS: &[Field] = &[
    Field {
        name: "kind",
        holds: Holds::Kind,
        doc: "what the step did",
        of: |m| Some(Value::Word(m.event.kind().into())),
    },
    Field { name: "step", holds: Holds::Number, doc: "number of the step", of: |m| number(m.step as f64) },
    Field { name: "nq", holds: Holds::Number, doc: "quadrilaterals that stand", of: |m| number(m.nq as f64) },
    Field {
        name: "quad.quality",
        holds: Holds::Number,
        doc: "quality of the quadrilateral that was formed, 0 to 1",
        of: of_event!(Event::Formed { quality, .. } => number(quality)),
    },
    Field {
        name: "quad.min_angle",
        holds: Holds::Degrees,
        doc: "least angle of the quadrilateral that was formed, in the metric",
        of: |m| m.angles.and_then(|angles| degrees(angles.min.into())),
    },
    Field {
        name: "quad.max_angle",
        holds: Holds::Degrees,
        doc: "largest angle of the quadrilateral that was formed, in the metric",
        of: |m| m.angles.and_then(|angles| degrees(angles.max.into())),
    },
    Field {
        name: "quad.level",
        holds: Holds::Number,
        doc: "row of the quadrilateral that was formed, counted from the boundary",
        of: of_event!(Event::Formed { level, .. } => number(level)),
    },
    Field {
        name: "quad.eaten",
        holds: Holds::Number,
        doc: "triangles that the quadrilateral ate",
        of: of_event!(Event::Formed { eaten, .. } => number(eaten)),
    },
    Field {
        name: "quad.attempt",
        holds: Holds::Number,
        doc: "which attempt formed the quadrilateral, from 0",
        of: of_event!(Event::Formed { attempt, .. } => number(attempt)),
    },
    Field {
        name: "quad.element",
        holds: Holds::Number,
        doc: "id of the quadrilateral that was formed",
        of: of_event!(Event::Formed { element, .. } => number(element.0)),
    },
    Field {
        name: "front.segments",
        holds: Holds::Number,
        doc: "segments of the front",
        of: |m| number(m.front.segments),
    },
    Field {
        name: "front.loops",
        holds: Holds::Number,
        doc: "closed chains of the front",
        of: |m| number(m.front.loops),
    },
    Field {
        name: "front.odd",
        holds: Holds::Number,
        doc: "loops with an odd number of segments",
        of: |m| number(m.front.odd),
    },
    Field { name: "front.live", holds: Holds::Number, doc: "live triangles", of: |m| number(m.front.live) },
    Field {
        name: "base.class",
        holds: Holds::Number,
        doc: "class of table 1 of the chosen base segment, 1 to 4",
        of: of_event!(Event::BaseSelected { class, .. } => number(class)),
    },
    Field {
        name: "base.h_value",
        holds: Holds::Number,
        doc: "H-value (eq. 6) of the chosen base segment",
        of: of_event!(Event::BaseSelected { h_value, .. } => number(h_value)),
    },
    Field {
        name: "base.length",
        holds: Holds::Number,
        doc: "length of the chosen base segment in the metric",
        of: of_event!(Event::BaseSelected { length_metric, .. } => number(length_metric)),
    },
    Field {
        name: "base.level",
        holds: Holds::Number,
        doc: "rows between the chosen base segment and the boundary",
        of: of_event!(Event::BaseSelected { level, .. } => number(level)),
    },
    Field {
        name: "base.theta_a",
        holds: Holds::Degrees,
        doc: "frontal angle at the left node of the chosen base segment",
        of: of_event!(Event::BaseSelected { theta, .. } => degrees(theta[0])),
    },
    Field {
        name: "base.theta_b",
        holds: Holds::Degrees,
        doc: "frontal angle at the right node of the chosen base segment",
        of: of_event!(Event::BaseSelected { theta, .. } => degrees(theta[1])),
    },
    Field {
        name: "base.within_reach",
        holds: Holds::Flag,
        doc: "the chosen base segment is within c Hmin",
        of: of_event!(Event::BaseSelected { within_reach, .. } => Some(Value::Flag(within_reach))),
    },
    Field {
        name: "base.picked",
        holds: Holds::Flag,
        doc: "a person picked the base segment",
        of: of_event!(Event::BaseSelected { picked, .. } => Some(Value::Flag(picked))),
    },
    Field { name: "side", holds: Holds::Side, doc: "which side edge the step is about", of: side },
    Field {
        name: "side.deviation",
        holds: Holds::Degrees,
        doc: "how far the side edge is from the direction that was aimed at",
        of: |m| match *m.event {
            Event::SideChosen { edge } | Event::SideSwapped { edge, .. } => degrees(edge.deviation),
            _ => None,
        },
    },
    Field {
        name: "recovery.failed",
        holds: Holds::Flag,
        doc: "the top edge could not be recovered",
        of: |m| Some(Value::Flag(matches!(rolled_back(m), Some("top_blocked" | "top_through_node" | "top_too_long")))),
    },
    Field {
        name: "recovery.swaps",
        holds: Holds::Number,
        doc: "swaps that the recovery of the top edge took",
        of: of_event!(Event::TopFound { swaps, .. } => number(swaps)),
    },
    Field {
        name: "rollback.why",
        holds: Holds::Why,
        doc: "why the attempt was taken back",
        of: |m| rolled_back(m).map(|why| Value::Word(why.into())),
    },
    Field {
        name: "seam.angle",
        holds: Holds::Degrees,
        doc: "frontal angle that was seamed",
        of: |m| match *m.event {
            Event::Seamed { angle, .. } | Event::TransitionSeamed { angle, .. } => degrees(angle),
            _ => None,
        },
    },
    Field {
        name: "split.ratio",
        holds: Holds::Number,
        doc: "width over height of the slender triangle at which the front was split",
        of: of_event!(Event::Split { ratio, .. } => number(ratio)),
    },
    Field {
        name: "fallback",
        holds: Holds::Flag,
        doc: "the front was left: a second pass, or the last resort at work",
        of: |m| {
            let left = matches!(m.event, Event::SecondPass | Event::Matched { .. } | Event::Patched { .. });
            Some(Value::Flag(left))
        },
    },
];

fn side(moment: &Moment<'_>) -> Option<Value> {
    let side = match *moment.event {
        Event::SideIsFront { side, .. } | Event::SideDivided { side, .. } => side,
        Event::SideChosen { edge } | Event::SideSwapped { edge, .. } => edge.side,
        _ => return None,
    };
    Some(Value::Word(Holds::Side.words()[side.index()].into()))
}

/// The word for why an attempt was taken back.
fn rolled_back(moment: &Moment<'_>) -> Option<&'static str> {
    let Event::RolledBack { why, .. } = moment.event else { return None };
    Some(match why {
        Why::NoSide(_) => "no_side",
        Why::NoDivision(_) => "no_division",
        Why::TopBlocked(_) => "top_blocked",
        Why::TopThroughNode(_) => "top_through_node",
        Why::TopTooLong => "top_too_long",
        Why::TooLong(_) => "too_long",
        Why::NotDisc => "not_disc",
        Why::NotConvex => "not_convex",
        Why::Poor(_) => "poor",
        Why::OddLoop(_) => "odd_loop",
        Why::NoMetric => "no_metric",
    })
}
