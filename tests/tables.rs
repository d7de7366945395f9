//! Promise: the tables of elements and nodes agree with the report, and with numbers recomputed from coordinates.
#![allow(clippy::unwrap_used)]

use glam::DVec3;
use quadfront::core::case::built_in;
use quadfront::core::convert::Converter;
use quadfront::core::kernel::condition::Condition;
use quadfront::core::mesh::{ElementId, NodeId};
use quadfront::core::prepare::Background;
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::record::statistics::Statistics;
use quadfront::core::run::{
    Changes, ElementFacts, ElementRow, ElementTable, History, LastChanges, NodePlace, NodeTable, Query, Row, Run,
    Steps, Watched, csv,
};
use quadfront::render::scene::space_angles;

fn history(name: &str, scale: f64) -> (History, Background) {
    let mut run = Run::of(built_in::named(name).unwrap().unwrap());
    run.parameters.size_scale *= scale;
    let background = run.background(&mut Nobody).unwrap();
    (History::of(run, &background, 64 << 20).unwrap(), background)
}

/// The table of the elements of a state, measured as a whole.
fn elements(state: &Converter<'_>, born: &[u64]) -> ElementTable {
    let mut table = ElementTable::default();
    table.follow(&state.mesh, &Changes::Everything, |slot| steps(born, 0, slot));
    table
}

/// The steps of a slot, from those of birth by slot.
fn steps(born: &[u64], changed: u64, slot: u32) -> Steps {
    Steps { born: born.get(slot as usize).copied().unwrap_or(0), changed }
}

fn least(rows: &ElementTable, value: impl Fn(&ElementRow) -> f64) -> f64 {
    rows.rows().map(value).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_tables_of_a_finished_mesh_have_the_extremes_and_counts_of_its_report() {
    for (name, scale) in [("example1", 1.5), ("wing", 2.0), ("two-faces", 1.0)] {
        let (mut history, background) = history(name, scale);
        history.seek(u64::MAX).unwrap();
        let mesh = &history.state().mesh;
        let export = Export::of(mesh, &background.names);
        let report = Statistics::measure(export.measured(), &background.sizing).unwrap();
        let table = elements(history.state(), &[]);
        assert_eq!(table.rows().count(), report.quads + report.triangles, "{name}");
        let close = |found: f64, expected: f64, what: &str| {
            assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{name}: {what} {found} {expected}");
        };
        close(least(&table, |e| e.quality), report.quality.unwrap().min, "quality");
        close(least(&table, |e| e.angles_metric[0]), report.metric_angles.min, "angle");
        close(-least(&table, |e| -e.angles_metric[1]), report.metric_angles.max, "angle");
        let jacobian = |e: &ElementRow| e.jacobian_metric.unwrap();
        close(least(&table, jacobian), report.metric_scaled_jacobian.unwrap().min, "Jacobian");
        let jacobian = |e: &ElementRow| e.jacobian_space.unwrap();
        close(least(&table, jacobian), report.physical_scaled_jacobian.unwrap().min, "Jacobian in space");
        let mean = table.rows().map(jacobian).sum::<f64>() / report.quads as f64;
        close(mean, report.physical_scaled_jacobian.unwrap().mean, "mean Jacobian in space");
        close(least(&table, |e| e.angles_space[0]), report.physical_angles.min, "angle in space");
        close(-least(&table, |e| -e.angles_space[1]), report.physical_angles.max, "angle in space");
        // The report integrates the metric along edges; the table has it at both ends. Where sizes change slowly both
        // agree.
        if name == "example1" {
            assert!((least(&table, |e| e.lengths_metric[0]) / report.lengths.min - 1.0).abs() < 0.005);
            assert!((least(&table, |e| -e.lengths_metric[1]) / -report.lengths.max - 1.0).abs() < 0.005);
        }
        let mut nodes = NodeTable::default();
        nodes.follow(mesh, &Changes::Everything, |_| Steps::default());
        let inside = nodes.rows().filter(|n| n.is_irregular.is_some()).count();
        let irregular = nodes.rows().filter(|n| n.is_irregular == Some(true)).count();
        assert_eq!([inside, irregular], [report.irregular.interior, report.irregular.irregular], "{name}");
    }
}

/// The angles of an element from the coordinates of its corners, in degrees: by the arc cosine, and its complement to a
/// full turn where the corner turns against the diagonals.
fn from_coordinates(corners: &[DVec3]) -> Vec<f64> {
    let count = corners.len();
    let normal = match corners {
        [a, b, c, d] => (*c - *a).cross(*d - *b),
        [a, b, c] => (*b - *a).cross(*c - *a),
        _ => unreachable!(),
    };
    let angle = |k: usize| {
        let [last, p, next] = [k + count - 1, k, k + 1].map(|k| corners[k % count]);
        let (out, back) = ((next - p).normalize(), (last - p).normalize());
        let theta = libm::acos(out.dot(back).clamp(-1.0, 1.0)).to_degrees();
        if out.cross(back).dot(normal) < 0.0 { 360.0 - theta } else { theta }
    };
    (0..count).map(angle).collect()
}

#[test]
fn angles_in_space_follow_from_the_coordinates_of_the_file_in_the_report_the_tables_and_the_explanations() {
    for (name, scale) in [("wing", 2.0), ("torus", 2.0), ("sphere", 2.0), ("example1", 2.0)] {
        let (mut history, background) = history(name, scale);
        history.extend(u64::MAX);
        let end = history.end().unwrap();
        let mut bent: f64 = 0.0;
        for step in [end / 2, end] {
            history.seek(step).unwrap();
            let mesh = &history.state().mesh;
            let export = Export::of_state(mesh, &background.names);
            let report = Statistics::measure(export.measured(), &background.sizing).unwrap();
            let table = elements(history.state(), &[]);
            let file = &export.file;
            let points = |nodes: &[u32]| nodes.iter().map(|n| file.points[*n as usize]).collect::<Vec<_>>();
            let all = file.triangles.iter().map(|t| points(t)).chain(file.quads.iter().map(|q| points(q)));
            let all: Vec<Vec<f64>> = all.map(|corners| from_coordinates(&corners)).collect();
            // The file has the triangles first.
            let (live, dead): (Vec<ElementId>, Vec<ElementId>) = mesh.elements().partition(|e| mesh.is_triangle(*e));
            let close = |found: f64, expected: f64, what: &str| {
                assert!((found - expected).abs() < 1e-5, "{name} at {step}: {what} {found} {expected}");
            };
            for (e, angles) in live.iter().chain(&dead).zip(&all) {
                let told = ElementFacts::of(mesh, *e).unwrap();
                let row = table.row(e.0).unwrap();
                let shown = space_angles(mesh, *e).map(f64::to_degrees);
                assert_eq!(told.angles_physical.len(), angles.len());
                told.angles_physical.iter().zip(angles).for_each(|(a, b)| close(*a, *b, "explained"));
                let ends = [angles.iter().copied().fold(360.0, f64::min), angles.iter().copied().fold(0.0, f64::max)];
                for k in 0..2 {
                    close(row.angles_space[k], ends[k], "in the table");
                    close(shown[k], ends[k], "plotted");
                }
                if angles.len() == 4 {
                    // Flat quadrilaterals have a full turn.
                    bent = bent.max(360.0 - angles.iter().sum::<f64>());
                }
            }
            let angles = || all.iter().flatten().copied();
            close(report.physical_angles.min, angles().fold(360.0, f64::min), "reported");
            close(report.physical_angles.max, angles().fold(0.0, f64::max), "reported");
            let good = angles().filter(|angle| (60.0..=120.0).contains(angle)).count() as f64;
            let share = good / angles().count() as f64;
            assert!((report.physical_angles.share_60_120 - share).abs() < 2e-3, "{name}: {share}");
        }
        assert_eq!(bent > 0.1, name != "example1", "{name} is curved: {bent}");
    }
}

#[test]
fn in_a_uniform_plane_case_every_number_follows_from_the_coordinates() {
    let (mut history, _) = history("uniform", 1.0);
    history.extend(u64::MAX);
    history.seek(history.end().unwrap() / 2).unwrap();
    let mesh = &history.state().mesh;
    let table = elements(history.state(), &[]);
    let size = 1.0 / mesh.metric(NodeId(0)).uu.sqrt();
    assert!(table.rows().any(|row| row.is_live) && table.rows().any(|row| !row.is_live));
    for row in table.rows() {
        let nodes: Vec<NodeId> = mesh.corners(row.element).collect();
        let count = nodes.len();
        let p = |k: usize| mesh.uv(nodes[k % count]);
        let lengths: Vec<f64> = (0..count).map(|k| (p(k + 1) - p(k)).length()).collect();
        let sines: Vec<f64> = (0..count)
            .map(|k| {
                (p(k + 1) - p(k)).perp_dot(p(k + count - 1) - p(k)) / (lengths[k] * lengths[(k + count - 1) % count])
            })
            .collect();
        let shoelace = 0.5 * (0..count).map(|k| p(k).perp_dot(p(k + 1))).sum::<f64>();
        let low = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{row:?} {expected}");
        close(row.lengths_space[0], low(&lengths));
        close(row.area_space, shoelace);
        assert_eq!(row.is_live, count == 3);
        if let Some(jacobian) = row.jacobian_space {
            close(jacobian, low(&sines));
        }
        let cosines = (0..count).map(|k| {
            let (a, b) = (p(k + 1) - p(k), p(k + count - 1) - p(k));
            a.dot(b) / (a.length() * b.length())
        });
        let least_angle = libm::acos(cosines.fold(-1.0, f64::max)).to_degrees();
        assert!((row.angles_space[0] - least_angle).abs() < 1e-6, "{row:?}");
        // Lengths and areas in the metric are those in space over the size.
        close(row.lengths_metric[0] * size, row.lengths_space[0]);
        close(row.lengths_metric[1] * size, row.lengths_space[1]);
        close(row.area_metric * size * size, row.area_space);
        assert!((row.angles_metric[0] - row.angles_space[0]).abs() < 1e-9, "{row:?}");
        assert_eq!(row.jacobian_metric.is_some(), count == 4);
    }
}

#[test]
fn a_table_that_follows_a_run_is_that_of_the_whole_mesh_wherever_one_goes() {
    for name in ["example1", "two-faces"] {
        let (mut history, _) = history(name, 2.0);
        history.seek(u64::MAX).unwrap();
        let end = history.step();
        let (mut elements, mut nodes) = (ElementTable::default(), NodeTable::default());
        let (mut small, mut seen, mut last) = (0, Vec::new(), LastChanges::default());
        for step in [0, 1, 2, 3, 60, 61, 62, 61, 30, end / 2, end / 2 + 1, end / 2 - 3, end - 1, end, end - 2, 5] {
            history.seek(step).unwrap();
            let changes = history.take_changes();
            small += u32::from(changes != Changes::Everything);
            let mesh = history.state().mesh.without_journal();
            let born = history.log().born().of_quads(step, mesh.element_slots());
            last.follow(history.log().changes(), step);
            let of_element = |slot| steps(&born, last.of_element(slot), slot);
            elements.follow(&mesh, &changes, of_element);
            let mut whole = ElementTable::default();
            whole.follow(&mesh, &Changes::Everything, of_element);
            assert!(elements.rows().eq(whole.rows()), "{name}: elements at step {step}");
            let born = history.log().born().of_nodes(step, mesh.node_slots());
            let of_node = |slot| steps(&born, last.of_node(slot), slot);
            nodes.follow(&mesh, &changes, of_node);
            let mut whole = NodeTable::default();
            whole.follow(&mesh, &Changes::Everything, of_node);
            assert!(nodes.rows().eq(whole.rows()), "{name}: nodes at step {step}");
            let segments: Vec<[NodeId; 2]> = mesh.front().map(|h| mesh.ends(h)).collect();
            for node in nodes.rows() {
                let is_of_front = segments.iter().flatten().any(|n| *n == node.node);
                assert_eq!(node.place == NodePlace::Front, is_of_front, "{node:?} at step {step}");
            }
            seen.push(elements.rows().count());
        }
        assert!(small > 8 && seen[0] > seen[13], "{small} {seen:?}");
    }
}

#[test]
fn a_list_is_filtered_and_sorted_and_what_lacks_the_field_comes_last() {
    let (mut history, _) = history("example1", 2.0);
    history.extend(u64::MAX);
    history.seek(history.end().unwrap() / 2).unwrap();
    let step = history.step();
    let born = history.log().born().of_quads(step, history.state().mesh.element_slots());
    let mut last = LastChanges::default();
    last.follow(history.log().changes(), step);
    let mut table = ElementTable::default();
    let steps = |slot| steps(&born, last.of_element(slot), slot);
    table.follow(&history.state().mesh, &Changes::Everything, steps);
    let field = |name: &str| ElementRow::FIELDS.iter().position(|field| field.name == name).unwrap();
    let filter = Condition::parse("quad && quality < .9", ElementRow::FIELDS).unwrap();
    let query = Query { field: field("quality"), descending: false, filter: Some(filter) };
    let found = table.list(&query);
    let qualities: Vec<f64> = found.slots.iter().map(|&slot| table.row(slot).unwrap().quality).collect();
    assert!(qualities.is_sorted() && qualities.len() > 3 && qualities.iter().all(|q| *q < 0.9));
    let all = table.rows().filter(|e| !e.is_live && e.quality < 0.9).count();
    assert_eq!([found.slots.len(), found.of], [all, table.rows().count()]);
    for descending in [false, true] {
        let found = table.list(&Query { field: field("jacobian"), descending, filter: None });
        let is_live: Vec<bool> = found.slots.iter().map(|&slot| table.row(slot).unwrap().is_live).collect();
        assert!(is_live.is_sorted() && is_live[is_live.len() - 1] && !is_live[0]);
        let values: Vec<f64> = found.slots.iter().filter_map(|&slot| table.row(slot)?.jacobian_metric).collect();
        assert!(values.is_sorted_by(|a, b| if descending { a >= b } else { a <= b }));
    }
    let fault = Condition::parse("qality < .3", ElementRow::FIELDS).unwrap_err().to_string();
    assert!(fault.contains("quality"), "{fault}");
    // As comma-separated values, each row can be read back.
    let text = csv(found.slots.iter().filter_map(|&slot| table.row(slot)));
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(names.len(), ElementRow::FIELDS.len());
    for (line, &slot) in lines.zip(&found.slots) {
        let row = table.row(slot).unwrap();
        let values: Vec<&str> = line.split(',').collect();
        assert_eq!(values.len(), names.len());
        assert_eq!(values[0].parse::<u32>().unwrap(), slot);
        assert_eq!(values[field("quality")].parse::<f64>().unwrap(), row.quality);
        assert_eq!(values[field("born")].parse::<u64>().ok(), row.born);
        assert_eq!(values[field("changed")].parse::<u64>().ok(), Some(row.changed));
        let touched = history.touches(Watched::Element(ElementId(slot)), 1).unwrap().pop();
        assert_eq!(row.changed, touched.unwrap_or(0), "{row:?}");
        assert_eq!(history.made(ElementId(slot)).unwrap(), row.born);
    }
}
