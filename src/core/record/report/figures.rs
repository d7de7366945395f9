//! The figures of a report by name: for sweeps, comparisons, and conditions on what a conversion ends with.

use super::Report;
use crate::core::kernel::condition::{Field, Holds};
use crate::core::record::statistics::{Range, VerdictSpreads};

/// Whether less or more of a figure is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// Less is better.
    Less,
    /// More is better.
    More,
    /// Neither.
    Neither,
}

/// A figure of a report.
pub struct Figure {
    /// Its name.
    pub name: &'static str,
    /// Its unit, empty for a plain number.
    pub unit: &'static str,
    /// Which direction is better.
    pub better: Better,
    /// Its meaning, a phrase.
    pub doc: &'static str,
    of: fn(&Report) -> Option<f64>,
}

impl Figure {
    /// The figure with a name.
    pub fn named(name: &str) -> Option<&'static Figure> {
        FIGURES.iter().find(|figure| figure.name == name)
    }

    /// The figure in a report; `None` where the mesh has none, such as a scaled Jacobian without quadrilaterals.
    pub fn of(&self, report: &Report) -> Option<f64> {
        (self.of)(report).filter(|figure| figure.is_finite())
    }
}

/// The figures as fields of conditions, in the order of [`FIGURES`].
pub fn fields() -> Vec<Field> {
    FIGURES.iter().map(|figure| Field { name: figure.name, holds: Holds::Number, doc: figure.doc }).collect()
}

/// Makes the table of figures: for each its name, its unit, which direction is better, its meaning and its value.
macro_rules! figures {
    ($($name:literal, $unit:literal, $better:ident, $doc:literal => $of:expr;)*) => {
        /// All figures, in the order of the lists that users see.
        pub const FIGURES: &[Figure] =
            &[$(Figure { name: $name, unit: $unit, better: Better::$better, doc: $doc, of: $of },)*];
    };
}

figures! {
    "quads", "", Neither, "quadrilaterals" => |r| count(r.mesh.quads);
    "nodes", "", Neither, "nodes" => |r| count(r.mesh.nodes);
    "background_triangles", "", Neither, "triangles of the background mesh" => |r| count(r.background_triangles);
    "irregular", "%", Less, "irregular nodes, of the nodes inside faces" => |r| Some(r.mesh.irregular.percent);
    "irregular_nodes", "", Less, "irregular nodes inside faces" => |r| count(r.mesh.irregular.irregular);
    "min_angle", "°", More, "smallest angle, metric" => |r| Some(r.mesh.metric_angles.min);
    "max_angle", "°", Less, "largest angle, metric" => |r| Some(r.mesh.metric_angles.max);
    "good_angles", "%", More, "angles within 60–120°, metric" => |r| percent(r.mesh.metric_angles.share_60_120);
    "fair_angles", "%", More, "angles within 30–160°, metric" => |r| percent(r.mesh.metric_angles.share_30_160);
    "space.min_angle", "°", More, "smallest angle, in space" => |r| Some(r.mesh.physical_angles.min);
    "space.max_angle", "°", Less, "largest angle, in space" => |r| Some(r.mesh.physical_angles.max);
    "space.good_angles", "%", More, "angles within 60–120°, in space" =>
        |r| percent(r.mesh.physical_angles.share_60_120);
    "length.mean", "", Neither, "mean edge length, metric" => |r| Some(r.mesh.lengths.mean);
    "length.deviation", "", Less, "standard deviation of the edge lengths, metric" => |r| Some(r.mesh.lengths.deviation);
    "length.min", "", More, "shortest edge, metric" => |r| Some(r.mesh.lengths.min);
    "length.max", "", Less, "longest edge, metric" => |r| Some(r.mesh.lengths.max);
    "length.unit", "%", More, "edges of metric length 0.71–1.41" => |r| percent(r.mesh.lengths.share_unit);
    "quality.min", "", More, "least quality, metric" => |r| least(r.mesh.quality);
    "quality.mean", "", More, "mean quality, metric" => |r| mean(r.mesh.quality);
    "jacobian.min", "", More, "least scaled Jacobian, metric" => |r| least(r.mesh.metric_scaled_jacobian);
    "jacobian.mean", "", More, "mean scaled Jacobian, metric" => |r| mean(r.mesh.metric_scaled_jacobian);
    "space.jacobian.min", "", More, "least scaled Jacobian, in space" => |r| least(r.mesh.physical_scaled_jacobian);
    "space.jacobian.mean", "", More, "mean scaled Jacobian, in space" => |r| mean(r.mesh.physical_scaled_jacobian);
    "verdict.jacobian.min", "", More, "least scaled Jacobian, Verdict" => |r| verdict(r).map(|v| v.scaled_jacobian.min);
    "verdict.aspect.max", "", Less, "greatest aspect ratio, Verdict" => |r| verdict(r).map(|v| v.aspect_ratio.max);
    "verdict.skew.max", "", Less, "greatest skew, Verdict" => |r| verdict(r).map(|v| v.skew.max);
    "verdict.warpage.min", "", More, "least warpage, Verdict, 1 where flat" => |r| verdict(r).map(|v| v.warpage.min);
    "last_resort", "", Less, "quadrilaterals made by the last resort" => |r| count(r.last_resort.quads);
    "steps", "", Less, "steps of the front" => |r| event(r, "front_step");
    "rolled_back", "", Less, "attempts rolled back" => |r| event(r, "front_rolled_back");
    "deferred", "", Less, "segments deferred" => |r| event(r, "front_deferred");
    "seams", "", Neither, "seams" => |r| event(r, "front_seam");
    "splits", "", Neither, "splits of the front" => |r| event(r, "front_split");
    "seconds", "s", Less, "time" => |r| (!r.timing.is_empty()).then(|| super::total(&r.timing));
}

fn count(count: usize) -> Option<f64> {
    Some(count as f64)
}

fn percent(share: f64) -> Option<f64> {
    Some(100.0 * share)
}

fn least(range: Option<Range>) -> Option<f64> {
    range.map(|range| range.min)
}

fn mean(range: Option<Range>) -> Option<f64> {
    range.map(|range| range.mean)
}

fn verdict(report: &Report) -> Option<VerdictSpreads> {
    report.mesh.verdict
}

fn event(report: &Report, kind: &str) -> Option<f64> {
    report.events.get(kind).map(|count| *count as f64)
}
