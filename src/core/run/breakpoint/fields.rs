//! The fields that conditions can name, with their meanings.

use super::StepFacts;
use crate::core::convert::{Event, EventKind, WhyKind};
use crate::core::front::Side;
use crate::core::kernel::condition::Holds::{Degrees, Flag, Number};
use crate::core::kernel::condition::{Holds, Value, fields};

/// The kind of an event.
const KIND: Holds = Holds::Words {
    words: EventKind::NAMES,
    short: &[
        ("seam", "seamed"),
        ("quad", "formed"),
        ("form", "formed"),
        ("base", "base_selected"),
        ("rollback", "rolled_back"),
    ],
};

/// Why an attempt was rolled back.
const WHY: Holds = Holds::Words { words: WhyKind::NAMES, short: &[] };

/// A side.
const SIDE: Holds = Holds::Words { words: &["left", "right"], short: &[] };

/// The value of a field that one kind of event has.
macro_rules! of_event {
    ($pattern:pat => $value:expr) => {
        |facts| match *facts.event {
            $pattern => $value,
            _ => None,
        }
    };
}

fields! {
    StepFacts<'_>;
    "kind": KIND, "kind of the event" => |m| Some(Value::Word(m.event.kind().name()));
    "step": Number, "step number" => |m| Value::number(m.step as f64);
    "nq": Number, "number of quadrilaterals" => |m| Value::number(m.nq as f64);
    "quad.quality": Number, "quality of the new quadrilateral, 0 to 1" =>
        of_event!(Event::Formed { quality, .. } => Value::number(quality));
    "quad.min_angle": Degrees, "smallest angle of the new quadrilateral, in the metric" =>
        |m| m.angles.and_then(|angles| Value::degrees(angles.min.into()));
    "quad.max_angle": Degrees, "largest angle of the new quadrilateral, in the metric" =>
        |m| m.angles.and_then(|angles| Value::degrees(angles.max.into()));
    "quad.level": Number, "row of the new quadrilateral, counted from the boundary" =>
        of_event!(Event::Formed { level, .. } => Value::number(level));
    "quad.merged": Number, "number of triangles merged into the new quadrilateral" =>
        of_event!(Event::Formed { merged, .. } => Value::number(merged));
    "quad.attempt": Number, "attempt that formed the quadrilateral, from 0" =>
        of_event!(Event::Formed { attempt, .. } => Value::number(attempt));
    "quad.element": Number, "id of the new quadrilateral" =>
        of_event!(Event::Formed { element, .. } => Value::number(element.0));
    "front.segments": Number, "number of segments of the front" => |m| Value::number(m.front.segments);
    "front.loops": Number, "number of loops of the front" => |m| Value::number(m.front.loops);
    "front.odd": Number, "number of loops with an odd number of segments" => |m| Value::number(m.front.odd);
    "front.live": Number, "number of live triangles" => |m| Value::number(m.front.live);
    "base.class": Number, "class of the base segment in table 1, 1 to 4" =>
        of_event!(Event::BaseSelected { class, .. } => Value::number(class));
    "base.h_value": Number, "H-value (eq. 6) of the base segment" =>
        of_event!(Event::BaseSelected { h_value, .. } => Value::number(h_value));
    "base.key": Number, "key of the base segment, held against the reach" =>
        of_event!(Event::BaseSelected { key, .. } => Value::number(key));
    "base.reach": Number, "reach at the selection, c Hmin" =>
        of_event!(Event::BaseSelected { reach, .. } => Value::number(reach));
    "base.length": Number, "length of the base segment in the metric" =>
        of_event!(Event::BaseSelected { length_metric, .. } => Value::number(length_metric));
    "base.level": Number, "rows between the base segment and the boundary" =>
        of_event!(Event::BaseSelected { level, .. } => Value::number(level));
    "base.theta_a": Degrees, "frontal angle at the left node of the base segment" =>
        of_event!(Event::BaseSelected { theta, .. } => Value::degrees(theta[0]));
    "base.theta_b": Degrees, "frontal angle at the right node of the base segment" =>
        of_event!(Event::BaseSelected { theta, .. } => Value::degrees(theta[1]));
    "base.within_reach": Flag, "the base segment is within c Hmin" =>
        of_event!(Event::BaseSelected { within_reach, .. } => Some(Value::Flag(within_reach)));
    "base.picked": Flag, "the user picked the base segment" =>
        of_event!(Event::BaseSelected { picked, .. } => Some(Value::Flag(picked)));
    "side": SIDE, "side edge that the step is about" => side;
    "side.deviation": Degrees, "deviation of the side edge from the direction aimed at" =>
        of_event!(Event::SideChosen { edge } | Event::SideSwapped { edge, .. } => Value::degrees(edge.deviation));
    "recovery.failed": Flag, "the top edge could not be recovered" => recovery_failed;
    "recovery.swaps": Number, "number of swaps that recovered the top edge" =>
        of_event!(Event::TopFound { swaps, .. } => Value::number(swaps));
    "rollback.why": WHY, "why the attempt was rolled back" => |m| rolled_back(m).map(|why| Value::Word(why.name()));
    "seam.angle": Degrees, "frontal angle that the seam closed" =>
        of_event!(Event::Seamed { corner, .. } | Event::TransitionSeamed { corner, .. } => Value::degrees(corner.angle));
    "split.ratio": Number, "width divided by height of the slender triangle at which the front was split" =>
        of_event!(Event::Split { ratio, .. } => Value::number(ratio));
    "fallback": Flag, "a second pass or the last resort is at work" => fallback;
}

fn side(facts: &StepFacts<'_>) -> Option<Value> {
    let side = match *facts.event {
        Event::SideIsFront { side, .. } | Event::SideDivided { side, .. } => side,
        Event::SideChosen { edge } | Event::SideSwapped { edge, .. } => edge.side,
        _ => return None,
    };
    Some(Value::Word(match side {
        Side::Left => "left",
        Side::Right => "right",
    }))
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
