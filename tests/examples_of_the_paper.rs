//! Promise: the tables in the notes of examples 1 to 6, beside the paper's figures, are what the program gives, to 3 %;
//! and the layer of figure 20 forms where the notes of example 1 say.
#![allow(clippy::unwrap_used)]

use quadfront::core::case::{Case, built_in};
use quadfront::core::convert::conversion::convert;
use quadfront::core::mesh::{Mesh, NodeId};
use quadfront::core::progress::Nobody;
use quadfront::core::record::Report;
use quadfront::core::run::Run;

const EXAMPLES: [&str; 7] = ["example1", "example2", "example2-half", "example3", "example4", "example5", "example6"];

/// A row of a table: the name, the size scale where it has one, and the paper's, `--paper`'s and the default's value.
#[derive(Debug)]
struct Row<'a> {
    name: &'a str,
    scale: Option<&'a str>,
    values: [&'a str; 3],
}

fn rows(notes: &str) -> Vec<Row<'_>> {
    let lines = notes.lines().filter(|line| line.starts_with("| ")).skip(1);
    lines
        .map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
            let (name, scale) = match cells[0].split_once(", c = ") {
                Some((name, scale)) => (name, Some(scale)),
                None => (cells[0], None),
            };
            Row { name, scale, values: [cells[1], cells[2], cells[3]] }
        })
        .collect()
}

/// The figures of a conversion, by the names of the rows.
fn figures(report: &serde_json::Value) -> impl Fn(&str) -> f64 + use<> {
    let at = |path: &str| report.pointer(path).and_then(serde_json::Value::as_f64).unwrap();
    let (triangles, quads) = (at("/background_triangles"), at("/mesh/quads"));
    let angle = ["min", "max", "share_60_120"].map(|key| at(&format!("/mesh/metric_angles/{key}")));
    let length = at("/mesh/lengths/mean");
    move |name| match name {
        "triangles" => triangles,
        "quadrilaterals" => quads,
        "quadrilaterals / triangles" => quads / triangles,
        "mean length" => length,
        "least angle" => angle[0],
        "greatest angle" => angle[1],
        "% of angles in 60-120" => 100.0 * angle[2],
        _ => panic!("{name}"),
    }
}

fn with_size(case: &Case, scale: Option<&str>, paper: bool) -> Case {
    let mut case = case.clone();
    if paper {
        case.parameters = case.parameters.read_as_paper();
    }
    if let Some(scale) = scale {
        case.parameters.set("size_scale", scale).unwrap();
    }
    case
}

#[test]
fn the_tables_in_the_notes_are_what_the_program_gives() {
    for name in EXAMPLES {
        let case = built_in::named(name).unwrap().unwrap();
        let rows = rows(&case.notes);
        assert!(rows.len() >= 7, "{name} has a table");
        assert!(case.notes.contains("\nWhy: "), "{name} says why");
        let mut scales: Vec<_> = rows.iter().map(|row| row.scale).collect();
        scales.dedup();
        for scale in scales {
            for (column, paper) in [(1, true), (2, false)] {
                let case = with_size(&case, scale, paper);
                let report = Report::of(&case, &convert(&case, &mut Nobody).unwrap()).unwrap();
                assert!(report.valid);
                let figure = figures(&serde_json::to_value(&report).unwrap());
                for row in rows.iter().filter(|row| row.scale == scale) {
                    let (told, measured) = (row.values[column].parse::<f64>().unwrap(), figure(row.name));
                    assert!((told / measured - 1.0).abs() < 0.03, "{name}, {row:?}: {measured}");
                }
            }
        }
    }
}

/// The share of the segments of the outer boundary that quadrilaterals cover, and how many quadrilaterals do not touch
/// that boundary.
fn layer(mesh: &Mesh) -> (f64, usize) {
    let is_outer = |a: NodeId, b: NodeId| {
        let (p, q) = (mesh.uv(a), mesh.uv(b));
        [0.0, 1.0].into_iter().any(|side| p.x == side && q.x == side || p.y == side && q.y == side)
    };
    let (mut segments, mut covered, mut elsewhere) = (0, 0, 0);
    for e in mesh.elements() {
        let corners: Vec<NodeId> = mesh.corners(e).collect();
        let n = corners.len();
        let outer = (0..n).filter(|&k| is_outer(corners[k], corners[(k + 1) % n])).count();
        segments += outer;
        covered += if n == 4 { outer } else { 0 };
        elsewhere += usize::from(n == 4 && outer == 0);
    }
    (covered as f64 / segments as f64, elsewhere)
}

#[test]
fn the_layer_of_figure_20_forms_where_every_boundary_segment_is_within_reach() {
    let at = |c: &str, quads: usize| {
        let mut case = with_size(&built_in::named("example1").unwrap().unwrap(), None, true);
        case.parameters.set("c", c).unwrap();
        let run = Run::of(case);
        let mut converter = run.start(&run.background(&mut Nobody).unwrap()).unwrap();
        while converter.mesh.elements().filter(|&e| converter.mesh.is_quad(e)).count() < quads {
            converter.step().unwrap();
        }
        layer(&converter.mesh)
    };
    // With the printed rule the front starts along the line x = y.
    let (covered, elsewhere) = at("2", 100);
    assert!(covered < 0.2 && elsewhere > 80, "{covered} {elsewhere}");
    let (covered, elsewhere) = at("15", 50);
    assert!(covered > 0.5 && elsewhere == 0, "{covered} {elsewhere}");
    let (covered, elsewhere) = at("15", 100);
    assert!(covered == 1.0 && elsewhere <= 4, "{covered} {elsewhere}");
}
