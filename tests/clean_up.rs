//! Clean-up over a distance: where a grid is possible the mesh is one, elsewhere few nodes are irregular, and what the
//! steps say of the cavities that they fill anew is true.
#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};

use quadfront::core::case::{Case, built_in};
use quadfront::core::convert::background;
use quadfront::core::convert::conversion::convert;
use quadfront::core::convert::{Converter, Event};
use quadfront::core::mesh::{ElementId, Mesh, NodeId};
use quadfront::core::metric::measure::angle;
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::run::explain;

#[path = "common/irregular.rs"]
mod irregular;
use irregular::irregular_inside;

/// Quadrilaterals and irregular nodes inside of a case.
fn converted(case: &Case) -> [usize; 2] {
    let done = convert(case, &mut Nobody).unwrap();
    let made = Export::of(&done.mesh, &done.names).file;
    assert!(made.triangles.is_empty());
    [made.quads.len(), irregular_inside(&made)]
}

fn scaled(name: &str, size_scale: f64) -> Case {
    let mut case = built_in::named(name).unwrap().unwrap();
    case.parameters.size_scale *= size_scale;
    case
}

/// A polygon with elements of one size.
fn polygon(points: &[[f64; 2]], h: f64) -> Case {
    let text = format!(
        "version = 1\n[[curve]]\nname = \"p\"\nkind = \"polyline\"\npoints = {points:?}\nclosed = true\n[[face]]\n\
         name = \"f\"\nouter = [\"p\"]\n[[metric]]\nkind = \"uniform\"\nh = {h}\n"
    );
    Case::parse(&text, "polygon", "polygon.toml", std::path::Path::new(".")).unwrap()
}

/// A disk with elements of one size.
fn disk() -> Case {
    let text = "version = 1\n[[curve]]\nname = \"c\"\nkind = \"circle\"\ncentre = [0, 0]\nradius = 1\n[[face]]\nname = \"f\"\n\
                outer = [\"c\"]\n[[metric]]\nkind = \"uniform\"\nh = 0.07\n";
    Case::parse(text, "disk", "disk.toml", std::path::Path::new(".")).unwrap()
}

#[test]
fn where_a_grid_is_possible_the_mesh_is_one() {
    assert_eq!(converted(&scaled("uniform", 0.2)), [10_000, 0]);
    assert_eq!(converted(&scaled("uniform", 0.1)), [40_000, 0]);
    assert_eq!(converted(&polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]], 0.05)), [800, 0]);
    let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    assert_eq!(converted(&polygon(&l, 0.05)), [1200, 0]);
    let arms = [[1, 0], [2, 0], [2, 1], [3, 1], [3, 2], [2, 2], [2, 3], [1, 3], [1, 2], [0, 2], [0, 1], [1, 1]];
    assert_eq!(converted(&polygon(&arms.map(|p| p.map(f64::from)), 0.1)), [500, 0]);
}

#[test]
fn where_no_grid_is_possible_few_nodes_are_irregular() {
    let [quads, irregular] = converted(&scaled("sphere", 1.0));
    assert!(quads > 800 && irregular == 8, "sphere: {irregular} of {quads}");
    let [quads, irregular] = converted(&disk());
    assert!(quads > 600 && irregular == 4, "disk: {irregular} of {quads}");
    // Five corners of 108 degrees with one element each: one node at least.
    let corner = |k: u32| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 5.0);
        [cos, sin]
    };
    let [quads, irregular] = converted(&polygon(&[0, 1, 2, 3, 4].map(corner), 0.05));
    assert!(quads > 700 && (1..=15).contains(&irregular), "pentagon: {irregular} of {quads}");
}

/// Rows between each quadrilateral and the boundary, found by going inwards from the boundary row by row.
fn rows(mesh: &Mesh) -> BTreeMap<ElementId, u16> {
    let beside = |e| mesh.half_edges(e).map(|h| mesh.twin(h).map(|t| t.element()));
    let mut row: Vec<ElementId> = mesh.elements().filter(|&e| beside(e).any(|other| other.is_none())).collect();
    let mut rows = BTreeMap::new();
    for number in 0.. {
        row.retain(|&e| rows.insert(e, number).is_none());
        if row.is_empty() {
            break;
        }
        let next = row.iter().flat_map(|&e| beside(e).flatten()).filter(|e| !rows.contains_key(e));
        row = next.collect::<BTreeSet<_>>().into_iter().collect();
    }
    rows
}

#[test]
fn quadrilaterals_of_a_face_that_is_filled_anew_have_their_rows_as_levels() {
    let done = convert(&built_in::named("example2").unwrap().unwrap(), &mut Nobody).unwrap();
    assert!(done.finished.cleaned_up.refills > 0);
    let rows = rows(&done.mesh);
    assert!(rows.len() > 200 && rows.values().any(|&row| row > 2));
    for (e, row) in rows {
        assert_eq!(done.mesh.level(e), row, "{e:?}");
    }
}

/// Nodes whose number of elements is not four inside, or not that of right angles that fit at a boundary.
fn irregular(mesh: &Mesh) -> i64 {
    let fits = |n: NodeId| {
        if !mesh.is_fixed(n) {
            return 4;
        }
        let (p, metric) = (mesh.uv(n), mesh.metric(n));
        let corner = |h| angle(&metric, mesh.uv(mesh.target(h)) - p, mesh.uv(mesh.apex(h)) - p);
        let theta: f64 = mesh.fan(n).map(corner).sum();
        (theta / std::f64::consts::FRAC_PI_2).round().max(1.0) as usize
    };
    mesh.nodes().filter(|&n| mesh.elements_at(n).count() != fits(n)).count() as i64
}

#[test]
fn what_a_step_says_of_a_cavity_is_what_it_did() {
    let (mut refills, mut removing) = (0, 0);
    for name in ["gear", "example1", "crack"] {
        let case = scaled(name, 1.0);
        let made = background(&case, &mut Nobody).unwrap();
        let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
        loop {
            let before = [converter.mesh.element_count() as i64, irregular(&converter.mesh)];
            match converter.step().unwrap() {
                Event::Finished => break,
                Event::Refilled { sides, quads, irregular: nodes, energy } => {
                    let [quads, nodes] = [quads, nodes].map(|told| told.map(i64::from));
                    let after = [converter.mesh.element_count() as i64, irregular(&converter.mesh)];
                    assert_eq!(
                        [after[0] - before[0], after[1] - before[1]],
                        [quads[1] - quads[0], nodes[1] - nodes[0]]
                    );
                    assert!(sides.iter().sum::<u32>() % 2 == 0 && sides[1] > 0, "{name}: {sides:?}");
                    let removed = nodes[0] - nodes[1];
                    let most = if removed == 0 { -0.5 } else { 3.5 * removed as f64 };
                    assert!(removed >= 0 && energy[1] <= energy[0] + most, "{name}: {energy:?} for {removed}");
                    refills += 1;
                    removing += i32::from(removed > 0);
                }
                _ => {}
            }
        }
    }
    assert!(refills > 40 && removing > 20, "{refills} cavities, {removing} of them with fewer irregular nodes");
}

#[test]
fn what_a_step_says_of_a_disk_is_what_it_did() {
    let case = disk();
    let made = background(&case, &mut Nobody).unwrap();
    let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
    let edges =
        made.mesh.elements().flat_map(|e| made.mesh.half_edges(e)).filter(|&h| made.mesh.twin(h).is_none()).count();
    loop {
        let before = [converter.mesh.element_count() as u32, irregular(&converter.mesh) as u32];
        let event = converter.step().unwrap();
        assert_ne!(event, Event::Finished, "the disk is filled anew as a whole");
        if let Event::Refilled { sides, quads, irregular: nodes, .. } = event {
            let after = [converter.mesh.element_count() as u32, irregular(&converter.mesh) as u32];
            assert_eq!(sides, [edges as u32, 0, 0, 0, 0, 0], "one border without a corner");
            assert_eq!([quads, nodes], [[before[0], after[0]], [before[1], after[1]]]);
            assert_eq!(after[1], 4);
            let text = explain::event(&event);
            assert!(text.starts_with(&format!("cavity with a border of {edges} edges filled anew")), "{text}");
            return;
        }
    }
}
