//! The report of a conversion: JSON for programs (keys in a fixed order) and a summary for people.

mod counts;
pub mod figures;
mod symmetry;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::io;

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::ser::{Formatter, PrettyFormatter};

pub use symmetry::SymmetryRecord;

use super::export::Export;
use super::statistics::{Angles, Range, Statistics};
use crate::core::case::{Case, Parameters};
use crate::core::convert::Converted;
use crate::core::fault::Fault;
use crate::core::kernel::number::{counted, grouped, size};
use crate::core::prepare::Spacing;
use crate::core::progress::Stage;
use crate::core::soup::{NOT_JOINED, NOT_READ};

/// The report of a conversion.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Report {
    /// The program that made it.
    pub program: Program,
    /// The case.
    pub case: CaseRecord,
    /// The parameters used, angles in degrees.
    #[serde(serialize_with = "parameters")]
    pub parameters: Parameters,
    /// Number of triangles of the background mesh.
    pub background_triangles: usize,
    /// Number of faces (regions).
    pub regions: usize,
    /// Whether the mesh passes all checks: only quadrilaterals, conforming, strictly convex by exact predicates, and on
    /// surfaces against the mean normal of each.
    pub valid: bool,
    /// Statistics of the mesh.
    pub mesh: Statistics,
    /// Whether the mesh lies on surfaces, so that physical values are those in space.
    #[serde(skip)]
    pub on_surfaces: bool,
    /// How many nodes have a mirror image, if the case asks for symmetry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub symmetry: Option<SymmetryRecord>,
    /// The share of the last resort.
    pub last_resort: LastResort,
    /// Repairs of a given mesh, and what of its file is not read, as readable phrases.
    pub repairs: Vec<String>,
    /// What the boundary makes of the sizes that are asked for; left out where it makes nothing of them.
    #[serde(skip_serializing_if = "Spacing::is_plain")]
    pub spacing: Spacing,
    /// Number of events by kind.
    pub events: BTreeMap<String, u64>,
    /// Seconds by stage: the only value that differs between two runs of the same case.
    #[serde(serialize_with = "timing")]
    pub timing: Vec<(Stage, f64)>,
}

/// Name and version of the program.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Program {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
}

/// A case in a report.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CaseRecord {
    /// Short name.
    pub name: String,
    /// One line for display.
    pub title: String,
    /// The text of the case file, from which the run can be repeated; empty for a mesh without one.
    pub text: String,
}

/// The part of the last resort (docs/algorithm.md, "The last resort").
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct LastResort {
    /// Number of quadrilaterals made by it.
    pub quads: usize,
    /// Number of all quadrilaterals made before the clean-up.
    pub of: usize,
    /// The ratio of the two, 0 to 1.
    pub share: f64,
}

impl Program {
    /// This program.
    pub fn this() -> Program {
        Program { name: env!("CARGO_PKG_NAME").to_owned(), version: env!("CARGO_PKG_VERSION").to_owned() }
    }
}

impl CaseRecord {
    /// The record of a case.
    pub fn of(case: &Case) -> CaseRecord {
        CaseRecord { name: case.name.clone(), title: case.title.clone(), text: case.text.clone() }
    }
}

impl LastResort {
    /// `quads` of `all` quadrilaterals were made by the last resort.
    pub fn of(quads: usize, all: usize) -> LastResort {
        LastResort { quads, of: all, share: if all == 0 { 0.0 } else { quads as f64 / all as f64 } }
    }
}

impl Report {
    /// The report of a conversion that was taken to its end; its mesh is checked and measured.
    ///
    /// # Errors
    /// Where the metric fails.
    pub fn of(case: &Case, converted: &Converted) -> Result<Report, Fault> {
        let export = Export::of(&converted.mesh, &converted.names);
        Report::of_export(case, converted, &export, export.flaw(&converted.mesh, false).is_none())
    }

    /// As [`Report::of`], also on the way, of arrays that were checked: whether they are `valid`.
    ///
    /// # Errors
    /// Where the metric fails.
    pub fn of_export(case: &Case, converted: &Converted, export: &Export, valid: bool) -> Result<Report, Fault> {
        let resort = converted.last_resort.quads();
        Ok(Report {
            program: Program::this(),
            case: CaseRecord::of(case),
            parameters: case.parameters.clone(),
            background_triangles: converted.triangles,
            regions: converted.names.faces.len(),
            valid,
            mesh: Statistics::measure(export.measured(), &converted.sizing)?,
            on_surfaces: converted.mesh.embedding().is_some(),
            symmetry: converted.mesh.symmetry().map(|symmetry| SymmetryRecord::of(export, symmetry.mirror())),
            last_resort: LastResort::of(resort, (converted.counts.formed + converted.counts.closed) as usize + resort),
            repairs: converted.repairs.clone(),
            spacing: converted.spacing.clone(),
            events: counts::events(converted),
            timing: Vec::new(),
        })
    }

    /// The report as indented JSON, lists of numbers on one line, with a final line break.
    pub fn json(&self) -> String {
        let mut bytes = Vec::new();
        let mut serializer = serde_json::Serializer::with_formatter(&mut bytes, ListsOnOneLine::default());
        self.serialize(&mut serializer).expect("a report is representable as JSON");
        bytes.push(b'\n');
        String::from_utf8(bytes).expect("JSON is UTF-8")
    }

    /// The report in a few lines for people, with a final line break.
    pub fn summary(&self) -> String {
        let mesh = &self.mesh;
        let mut text = format!("{}: {}\n", self.case.name, self.case.title);
        let mut row = |head: &str, value: String| row(&mut text, head, &value);
        row(
            "mesh",
            format!(
                "{}, {}, {}; {}",
                counted(mesh.quads as u64, "quadrilateral"),
                counted(mesh.nodes as u64, "node"),
                counted(self.regions as u64, "face"),
                if self.valid { "valid" } else { "NOT VALID" }
            ),
        );
        row("background", counted(self.background_triangles as u64, "triangle"));
        row("angles, metric", angles(&mesh.metric_angles));
        row(if self.on_surfaces { "angles, space" } else { "angles, plane" }, angles(&mesh.physical_angles));
        row("edge length", lengths(mesh));
        row(
            "irregular nodes",
            format!(
                "{} of {} inside, {:.1} %",
                grouped(mesh.irregular.irregular as u64),
                grouped(mesh.irregular.interior as u64),
                mesh.irregular.percent
            ),
        );
        if let (Some(metric), Some(plane)) = (mesh.metric_scaled_jacobian, mesh.physical_scaled_jacobian) {
            row(
                "scaled Jacobian",
                format!(
                    "{} in the metric; {} in {}",
                    range(metric),
                    range(plane),
                    if self.on_surfaces { "space" } else { "the plane" }
                ),
            );
        }
        if let Some(verdict) = mesh.verdict {
            row(
                "by Verdict",
                format!(
                    "scaled Jacobian at least {:.3}, aspect ratio at most {}, skew at most {:.3}, \
                     warpage at least {:.3}",
                    verdict.scaled_jacobian.min,
                    size(verdict.aspect_ratio.max),
                    verdict.skew.max,
                    verdict.warpage.min
                ),
            );
        }
        if let Some(symmetry) = &self.symmetry {
            row("symmetry", symmetry.text());
        }
        row(
            "last resort",
            format!(
                "made {} of {} before clean-up, {:.1} %",
                grouped(self.last_resort.quads as u64),
                counted(self.last_resort.of as u64, "quadrilateral"),
                100.0 * self.last_resort.share
            ),
        );
        rows_of_work(&mut text, &self.repairs, &self.spacing, &self.timing);
        text
    }
}

/// Writes one row of a summary.
fn row(text: &mut String, head: &str, value: &str) {
    // Writing to a String cannot fail.
    let _ = writeln!(text, "  {head:<16} {value}");
}

/// Writes the last rows of a summary: spacing, repairs and times.
fn rows_of_work(text: &mut String, repairs: &[String], spacing: &Spacing, timing: &[(Stage, f64)]) {
    for phrase in spacing.phrases() {
        row(text, "spacing", &phrase);
    }
    for told in repairs {
        match (told.strip_prefix(NOT_READ), told.strip_prefix(NOT_JOINED)) {
            (Some(what), _) => row(text, "not read", what),
            (_, Some(what)) => row(text, "not joined", what),
            _ => row(text, "repaired", told),
        }
    }
    if !timing.is_empty() {
        row(text, "time", &times(timing));
    }
}

/// JSON with indented objects, and arrays (histograms) on one line.
#[derive(Default)]
struct ListsOnOneLine(PrettyFormatter<'static>);

impl Formatter for ListsOnOneLine {
    fn begin_object<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.begin_object(out)
    }

    fn end_object<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.end_object(out)
    }

    fn begin_object_key<W: ?Sized + io::Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.0.begin_object_key(out, first)
    }

    fn begin_object_value<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.begin_object_value(out)
    }

    fn end_object_value<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.0.end_object_value(out)
    }
}

/// The summary of a background mesh: counts, edge lengths and quality.
pub fn background_summary(
    case: &Case,
    mesh: &Statistics,
    repairs: &[String],
    spacing: &Spacing,
    timing: &[(Stage, f64)],
) -> String {
    let quality = mesh.quality.map_or_else(|| "\u{2013}".to_owned(), range);
    let mut text = format!("{}: {}\n", case.name, case.title);
    let nodes = counted(mesh.nodes as u64, "node");
    row(&mut text, "background", &format!("{}, {nodes}", counted(mesh.triangles as u64, "triangle")));
    row(&mut text, "edge length", &lengths(mesh));
    row(&mut text, "quality, metric", &quality);
    if case.symmetry.is_some() {
        row(&mut text, "symmetry", "one half; the last step of the conversion adds its mirror image");
    }
    rows_of_work(&mut text, repairs, spacing, timing);
    text
}

/// The key of a stage in reports.
fn word(stage: Stage) -> &'static str {
    match stage {
        Stage::Read => "read",
        Stage::Repair => "mend",
        Stage::Chart => "chart",
        Stage::Divide => "divide",
        Stage::Triangulate => "triangulate",
        Stage::Adapt => "adapt",
        Stage::Convert => "convert",
        Stage::Finish => "finish",
        Stage::Check => "check",
        Stage::Draw => "draw",
        Stage::Write => "write",
    }
}

fn parameters<S: Serializer>(parameters: &Parameters, serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(Parameters::KEYS.len()))?;
    for key in Parameters::KEYS {
        let text = parameters.text_of(key).unwrap_or_default();
        match (key, text.parse::<u64>(), text.parse::<f64>(), text.parse::<bool>()) {
            ("layered_loops", ..) => map.serialize_entry(key, &parameters.layered_loops)?,
            ("faces", ..) => map.serialize_entry(key, &parameters.faces)?,
            (_, Ok(count), ..) => map.serialize_entry(key, &count)?,
            (.., Ok(number), _) => map.serialize_entry(key, &number)?,
            (.., Ok(flag)) => map.serialize_entry(key, &flag)?,
            _ => map.serialize_entry(key, &text)?,
        }
    }
    map.end()
}

fn timing<S: Serializer>(timing: &[(Stage, f64)], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(timing.len() + 1))?;
    for (stage, seconds) in timing {
        map.serialize_entry(word(*stage), seconds)?;
    }
    map.serialize_entry("total", &total(timing))?;
    map.end()
}

fn total(timing: &[(Stage, f64)]) -> f64 {
    timing.iter().map(|t| t.1).sum()
}

fn times(timing: &[(Stage, f64)]) -> String {
    let parts: Vec<_> = timing.iter().map(|(stage, seconds)| format!("{} {seconds:.2}", word(*stage))).collect();
    format!("{:.2} s ({})", total(timing), parts.join(", "))
}

fn angles(angles: &Angles) -> String {
    format!(
        "{:.1}\u{2013}{:.1}\u{b0}, {} within 60\u{2013}120\u{b0}, {} within 30\u{2013}160\u{b0}",
        angles.min,
        angles.max,
        percent(angles.share_60_120),
        percent(angles.share_30_160)
    )
}

fn lengths(mesh: &Statistics) -> String {
    let lengths = &mesh.lengths;
    format!(
        "{:.2} \u{b1} {:.2} in the metric ({:.2}\u{2013}{:.2}), {} within 0.71\u{2013}1.41",
        lengths.mean,
        lengths.deviation,
        lengths.min,
        lengths.max,
        percent(lengths.share_unit)
    )
}

/// A percentage rounded down, so that 100 % means all.
fn percent(share: f64) -> String {
    format!("{:.1} %", (share * 1000.0 + 1e-9).floor() / 10.0)
}

fn range(range: Range) -> String {
    format!("least {:.3}, mean {:.3}", range.min, range.mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::kernel::Metric2;
    use crate::core::mesh::PointId;
    use crate::core::metric::{BadMetric, MetricSource};
    use crate::core::record::statistics::Measured;
    use glam::DVec2;

    /// Size 1, growing with x.
    struct Growing;

    impl MetricSource for Growing {
        fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
            Ok(Metric2::isotropic(1.0 + 0.25 * uv.x))
        }
    }

    /// Three quadrilaterals around a node inside: the least irregular mesh there is.
    fn three_quads() -> Report {
        let uv: Vec<_> = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-0.75, 1.0), (-0.75, -0.5), (0.5, -1.0)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        let points: Vec<_> = (0..7).map(PointId).collect();
        let quads = [[0, 1, 2, 3], [0, 3, 4, 5], [0, 5, 6, 1]];
        let mesh = Measured { uv: &uv, points: &points, triangles: &[], quads: &quads, surfaces: None };
        Report {
            program: Program { name: "quadfront".to_owned(), version: "0.0.0".to_owned() },
            case: CaseRecord {
                name: "three".to_owned(),
                title: "Three quadrilaterals".to_owned(),
                text: String::new(),
            },
            parameters: Parameters::default(),
            background_triangles: 1234,
            regions: 1,
            valid: true,
            mesh: Statistics::measure(mesh, &Growing).unwrap(),
            on_surfaces: false,
            symmetry: None,
            last_resort: LastResort::of(3, 3),
            repairs: vec!["2 clockwise triangles were reversed".to_owned()],
            spacing: Spacing::default(),
            events: BTreeMap::from([("front_seam".to_owned(), 2), ("front_step".to_owned(), 31)]),
            timing: vec![(Stage::Adapt, 0.25), (Stage::Convert, 1.5)],
        }
    }

    #[test]
    fn the_summary_says_what_matters_in_a_few_lines() {
        insta::assert_snapshot!(three_quads().summary());
    }

    #[test]
    fn every_figure_has_the_value_of_the_json_or_none() {
        let report = three_quads();
        let json: serde_json::Value = serde_json::from_str(&report.json()).unwrap();
        let expected = |name: &str| -> Option<f64> {
            let (path, factor) = match name {
                "quads" => ("/mesh/quads", 1.0),
                "nodes" => ("/mesh/nodes", 1.0),
                "background_triangles" => ("/background_triangles", 1.0),
                "irregular" => ("/mesh/irregular/percent", 1.0),
                "irregular_nodes" => ("/mesh/irregular/irregular", 1.0),
                "min_angle" => ("/mesh/metric_angles/min", 1.0),
                "max_angle" => ("/mesh/metric_angles/max", 1.0),
                "good_angles" => ("/mesh/metric_angles/share_60_120", 100.0),
                "fair_angles" => ("/mesh/metric_angles/share_30_160", 100.0),
                "space.min_angle" => ("/mesh/physical_angles/min", 1.0),
                "space.max_angle" => ("/mesh/physical_angles/max", 1.0),
                "space.good_angles" => ("/mesh/physical_angles/share_60_120", 100.0),
                "length.mean" => ("/mesh/lengths/mean", 1.0),
                "length.deviation" => ("/mesh/lengths/deviation", 1.0),
                "length.min" => ("/mesh/lengths/min", 1.0),
                "length.max" => ("/mesh/lengths/max", 1.0),
                "length.unit" => ("/mesh/lengths/share_unit", 100.0),
                "quality.min" => ("/mesh/quality/min", 1.0),
                "quality.mean" => ("/mesh/quality/mean", 1.0),
                "jacobian.min" => ("/mesh/metric_scaled_jacobian/min", 1.0),
                "jacobian.mean" => ("/mesh/metric_scaled_jacobian/mean", 1.0),
                "space.jacobian.min" => ("/mesh/physical_scaled_jacobian/min", 1.0),
                "space.jacobian.mean" => ("/mesh/physical_scaled_jacobian/mean", 1.0),
                "verdict.jacobian.min" => ("/mesh/verdict/scaled_jacobian/min", 1.0),
                "verdict.aspect.max" => ("/mesh/verdict/aspect_ratio/max", 1.0),
                "verdict.skew.max" => ("/mesh/verdict/skew/max", 1.0),
                "verdict.warpage.min" => ("/mesh/verdict/warpage/min", 1.0),
                "last_resort" => ("/last_resort/quads", 1.0),
                "steps" => ("/events/front_step", 1.0),
                "rolled_back" => ("/events/front_rolled_back", 1.0),
                "deferred" => ("/events/front_deferred", 1.0),
                "seams" => ("/events/front_seam", 1.0),
                "splits" => ("/events/front_split", 1.0),
                "seconds" => ("/timing/total", 1.0),
                name => panic!("{name} is not in this table"),
            };
            json.pointer(path).and_then(serde_json::Value::as_f64).map(|value| factor * value)
        };
        for figure in figures::FIGURES {
            assert_eq!(figure.of(&report), expected(figure.name), "{}", figure.name);
        }
    }

    #[test]
    fn the_json_has_its_keys_in_a_fixed_order() {
        insta::assert_snapshot!(three_quads().json());
    }
}
