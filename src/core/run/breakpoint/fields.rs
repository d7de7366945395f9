//! The fields that conditions can name, with their meanings.

use super::StepFacts;
use crate::core::convert::{Event, EventKind, WhyKind};
use crate::core::front::Side;

/// The type of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// A number.
    Number,
    /// An angle in degrees.
    Degrees,
    /// Yes or no: the field by itself is a condition.
    Flag,
    /// The kind of an event.
    Kind,
    /// Why an attempt was rolled back.
    Why,
    /// Left or right.
    Side,
}

impl Holds {
    /// The words that a field of this type can be compared with; none for numbers.
    pub fn words(self) -> &'static [&'static str] {
        match self {
            Holds::Kind => EventKind::NAMES,
            Holds::Why => WhyKind::NAMES,
            Holds::Side => &["left", "right"],
            Holds::Flag => &["true", "false"],
            Holds::Number | Holds::Degrees => &[],
        }
    }

    /// Reads a value of this type.
    pub(super) fn value(self, word: &str) -> Option<Value> {
        match self {
            Holds::Number | Holds::Degrees => word.parse().ok().filter(|n: &f64| n.is_finite()).map(Value::Number),
            Holds::Flag => word.parse().ok().map(Value::Flag),
            Holds::Kind => word.parse().ok().map(Value::Kind),
            Holds::Why => word.parse().ok().map(Value::Why),
            Holds::Side => Side::BOTH
                .into_iter()
                .zip(self.words())
                .find(|(_, name)| **name == word)
                .map(|(side, _)| Value::Side(side)),
        }
    }
}

/// The value of a field, or the one it is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Flag(bool),
    Kind(EventKind),
    Why(WhyKind),
    Side(Side),
}

/// A field that conditions can name.
pub struct Field {
    /// Its name.
    pub name: &'static str,
    /// Its type.
    pub holds: Holds,
    /// Its meaning, for people who write conditions.
    pub doc: &'static str,
    pub(super) of: fn(&StepFacts<'_>) -> Option<Value>,
}

fn number(n: impl Into<f64>) -> Option<Value> {
    Some(Value::Number(n.into()))
}

fn degrees(radians: f64) -> Option<Value> {
    number(radians.to_degrees())
}

/// The value of a field that one kind of event has.
macro_rules! of_event {
    ($pattern:pat => $value:expr) => {
        |facts| match *facts.event {
            $pattern => $value,
            _ => None,
        }
    };
}

/// Makes the table of fields: for each its name, its type, its meaning and its value.
macro_rules! fields {
    ($($name:literal: $holds:ident, $doc:literal => $of:expr;)*) => {
        /// All fields, in the order of the list that users see.
        pub const FIELDS: &[Field] = &[$(Field { name: $name, holds: Holds::$holds, doc: $doc, of: $of },)*];
    };
}

fields! {
    "kind": Kind, "kind of the event" => |m| Some(Value::Kind(m.event.kind()));
    "step": Number, "step number" => |m| number(m.step as f64);
    "nq": Number, "number of quadrilaterals" => |m| number(m.nq as f64);
    "quad.quality": Number, "quality of the new quadrilateral, 0 to 1" =>
        of_event!(Event::Formed { quality, .. } => number(quality));
    "quad.min_angle": Degrees, "smallest angle of the new quadrilateral, in the metric" =>
        |m| m.angles.and_then(|angles| degrees(angles.min.into()));
    "quad.max_angle": Degrees, "largest angle of the new quadrilateral, in the metric" =>
        |m| m.angles.and_then(|angles| degrees(angles.max.into()));
    "quad.level": Number, "row of the new quadrilateral, counted from the boundary" =>
        of_event!(Event::Formed { level, .. } => number(level));
    "quad.merged": Number, "number of triangles merged into the new quadrilateral" =>
        of_event!(Event::Formed { merged, .. } => number(merged));
    "quad.attempt": Number, "attempt that formed the quadrilateral, from 0" =>
        of_event!(Event::Formed { attempt, .. } => number(attempt));
    "quad.element": Number, "id of the new quadrilateral" =>
        of_event!(Event::Formed { element, .. } => number(element.0));
    "front.segments": Number, "number of segments of the front" => |m| number(m.front.segments);
    "front.loops": Number, "number of loops of the front" => |m| number(m.front.loops);
    "front.odd": Number, "number of loops with an odd number of segments" => |m| number(m.front.odd);
    "front.live": Number, "number of live triangles" => |m| number(m.front.live);
    "base.class": Number, "class of the base segment in table 1, 1 to 4" =>
        of_event!(Event::BaseSelected { class, .. } => number(class));
    "base.h_value": Number, "H-value (eq. 6) of the base segment" =>
        of_event!(Event::BaseSelected { h_value, .. } => number(h_value));
    "base.key": Number, "key of the base segment, held against the reach" =>
        of_event!(Event::BaseSelected { key, .. } => number(key));
    "base.reach": Number, "reach at the selection, c Hmin" =>
        of_event!(Event::BaseSelected { reach, .. } => number(reach));
    "base.length": Number, "length of the base segment in the metric" =>
        of_event!(Event::BaseSelected { length_metric, .. } => number(length_metric));
    "base.level": Number, "rows between the base segment and the boundary" =>
        of_event!(Event::BaseSelected { level, .. } => number(level));
    "base.theta_a": Degrees, "frontal angle at the left node of the base segment" =>
        of_event!(Event::BaseSelected { theta, .. } => degrees(theta[0]));
    "base.theta_b": Degrees, "frontal angle at the right node of the base segment" =>
        of_event!(Event::BaseSelected { theta, .. } => degrees(theta[1]));
    "base.within_reach": Flag, "the base segment is within c Hmin" =>
        of_event!(Event::BaseSelected { within_reach, .. } => Some(Value::Flag(within_reach)));
    "base.picked": Flag, "the user picked the base segment" =>
        of_event!(Event::BaseSelected { picked, .. } => Some(Value::Flag(picked)));
    "side": Side, "side edge that the step is about" => side;
    "side.deviation": Degrees, "deviation of the side edge from the direction aimed at" =>
        of_event!(Event::SideChosen { edge } | Event::SideSwapped { edge, .. } => degrees(edge.deviation));
    "recovery.failed": Flag, "the top edge could not be recovered" => recovery_failed;
    "recovery.swaps": Number, "number of swaps that recovered the top edge" =>
        of_event!(Event::TopFound { swaps, .. } => number(swaps));
    "rollback.why": Why, "why the attempt was rolled back" => |m| rolled_back(m).map(Value::Why);
    "seam.angle": Degrees, "frontal angle that the seam closed" =>
        of_event!(Event::Seamed { corner, .. } | Event::TransitionSeamed { corner, .. } => degrees(corner.angle));
    "split.ratio": Number, "width divided by height of the slender triangle at which the front was split" =>
        of_event!(Event::Split { ratio, .. } => number(ratio));
    "fallback": Flag, "a second pass or the last resort is at work" => fallback;
}

fn side(facts: &StepFacts<'_>) -> Option<Value> {
    let side = match *facts.event {
        Event::SideIsFront { side, .. } | Event::SideDivided { side, .. } => side,
        Event::SideChosen { edge } | Event::SideSwapped { edge, .. } => edge.side,
        _ => return None,
    };
    Some(Value::Side(side))
}

fn rolled_back(facts: &StepFacts<'_>) -> Option<WhyKind> {
    let Event::RolledBack { why, .. } = facts.event else { return None };
    Some(why.kind())
}

fn recovery_failed(facts: &StepFacts<'_>) -> Option<Value> {
    let why = rolled_back(facts);
    Some(Value::Flag(matches!(
        why,
        Some(WhyKind::TopBlocked | WhyKind::TopThroughNode | WhyKind::TopTooLong | WhyKind::TopStuck)
    )))
}

fn fallback(facts: &StepFacts<'_>) -> Option<Value> {
    let kind = facts.event.kind();
    Some(Value::Flag(matches!(kind, EventKind::SecondPass | EventKind::Matched | EventKind::Patched)))
}
