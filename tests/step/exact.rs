//! Files by Open CASCADE, held against what Open CASCADE says of them.

use glam::DVec3;
use quadfront::core::case::{DomainSource, ImportOptions};
use quadfront::core::geometry::{Domain, complex};
use quadfront::core::soup::Allow;

use super::{area_and_volume, bytes_of, case_of, folder, mesh_of, names, sides};

const BRANCHING: Allow = Allow { triangles: false, seams: false, branching: true };

/// What Open CASCADE computed for a file.
struct Oracle {
    name: String,
    faces: usize,
    area: f64,
    volume: f64,
    /// Points on its faces.
    points: Vec<DVec3>,
}

fn oracles() -> Vec<Oracle> {
    let text = std::fs::read_to_string(folder().join("oracle.txt")).unwrap();
    let mut found: Vec<Oracle> = Vec::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let number = |k: usize| words[k].parse::<f64>().unwrap();
        if line.starts_with(' ') {
            found.last_mut().unwrap().points.push(DVec3::new(number(0), number(1), number(2)));
        } else {
            let faces = words[1].parse().unwrap();
            found.push(Oracle { name: words[0].to_owned(), faces, area: number(2), volume: number(3), points: vec![] });
        }
    }
    found
}

/// Files whose bodies touch, so that one of two faces is left out.
const TOUCHING: [&str; 1] = ["two_boxes"];
/// Files with surfaces that are no solids.
const SHEETS: [&str; 2] = ["bspline_patch", "vase"];

#[test]
fn all_faces_are_taken_and_points_by_open_cascade_lie_on_their_surfaces() {
    let oracles = oracles();
    assert_eq!(oracles.iter().map(|oracle| oracle.name.clone()).collect::<Vec<_>>(), names());
    for oracle in oracles {
        let (case, part) = case_of(&bytes_of(&oracle.name), &oracle.name, &ImportOptions::default()).unwrap();
        let left_out = usize::from(TOUCHING.contains(&oracle.name.as_str()));
        assert_eq!(part.spec.faces.len() + left_out, oracle.faces, "{}", oracle.name);
        let DomainSource::Surfaces(spec) = &case.domain else { panic!() };
        let mut within = spec.clone();
        within.tolerance = part.spec.tolerance;
        assert_eq!(within, *spec);
        let domain = complex::build(spec).unwrap_or_else(|fault| panic!("{}: {fault}", oracle.name));
        for point in oracle.points {
            let far = distance(&domain, point);
            assert!(far < 1e-6 * part.diagonal, "{}: {point} is {far} away", oracle.name);
        }
    }
}

/// The distance of a point from the surfaces of a domain.
fn distance(domain: &Domain, point: DVec3) -> f64 {
    let charts = domain.spatial.as_ref().unwrap().atlas.charts();
    let of = |surface: &quadfront::core::geometry::FaceSurface| match surface {
        quadfront::core::geometry::FaceSurface::Chart(chart) => chart.locate(point).1,
        quadfront::core::geometry::FaceSurface::Facets(_) => f64::INFINITY,
    };
    charts.iter().map(of).fold(f64::INFINITY, f64::min)
}

#[test]
fn meshes_are_sound_closed_and_of_the_area_and_volume_of_the_solid() {
    for oracle in oracles() {
        let name = oracle.name.as_str();
        let (case, part) = case_of(&bytes_of(name), name, &ImportOptions::default()).unwrap();
        let touches = TOUCHING.contains(&name);
        let allow = if touches { BRANCHING } else { Allow::default() };
        let coarse = mesh_of(&case, name, allow);
        let [once, _, more] = sides(&coarse);
        assert_eq!((once > 0, more > 0), (SHEETS.contains(&name), touches), "{name}");
        // Fine enough for the areas.
        let size = Some(part.diagonal / 40.0);
        let options = ImportOptions { mesh_size: size, curvature: Some(0.005), ..ImportOptions::default() };
        let (case, _) = case_of(&bytes_of(name), name, &options).unwrap();
        let mesh = mesh_of(&case, name, allow);
        let [area, volume] = area_and_volume(&mesh);
        let common = if touches { 100.0 } else { 0.0 };
        assert!((area / (oracle.area - common) - 1.0).abs() < 0.01, "{name}: area {area}, {}", oracle.area);
        if !touches && oracle.volume > 0.0 && !SHEETS.contains(&name) {
            assert!((volume / oracle.volume - 1.0).abs() < 0.02, "{name}: volume {volume}, {}", oracle.volume);
        }
    }
}

#[test]
fn nodes_lie_on_the_exact_surfaces_and_edges_of_faces_are_kept() {
    for name in names() {
        let (case, part) = case_of(&bytes_of(&name), &name, &ImportOptions::default()).unwrap();
        let allow = if TOUCHING.contains(&name.as_str()) { BRANCHING } else { Allow::default() };
        let mesh = mesh_of(&case, &name, allow);
        let DomainSource::Surfaces(spec) = &case.domain else { panic!() };
        let domain = complex::build(spec).unwrap();
        let far = mesh.points.iter().map(|&p| distance(&domain, p)).fold(0.0, f64::max);
        assert!(far < 1e-3 * part.diagonal, "{name}: a node is {far} away");
        // Quadrilaterals of two faces meet along sides only: every side between them is a line of the mesh.
        let lines: std::collections::BTreeSet<[u32; 2]> =
            mesh.lines.iter().map(|l| [l[0].min(l[1]), l[0].max(l[1])]).collect();
        let mut of_side: std::collections::BTreeMap<[u32; 2], Vec<u32>> = std::collections::BTreeMap::new();
        for (quad, tag) in mesh.quads.iter().zip(&mesh.quad_tags) {
            for k in 0..4 {
                let [a, b] = [quad[k], quad[(k + 1) % 4]];
                of_side.entry([a.min(b), a.max(b)]).or_default().push(*tag);
            }
        }
        let is_between = |tags: &Vec<u32>| tags.iter().any(|tag| *tag != tags[0]);
        let between = of_side.iter().filter(|(_, tags)| is_between(tags));
        assert!(between.into_iter().all(|(side, _)| lines.contains(side)), "{name}");
    }
}

#[test]
fn the_text_of_the_case_is_the_whole_part() {
    for name in ["filleted_box", "loft", "cone"] {
        let (case, _) = case_of(&bytes_of(name), name, &ImportOptions::default()).unwrap();
        let again =
            quadfront::Case::parse(&case.text, name, &format!("{name}.step"), std::path::Path::new("")).unwrap();
        assert_eq!(again.domain, case.domain);
        assert_eq!(mesh_of(&again, name, Allow::default()), mesh_of(&case, name, Allow::default()));
    }
}
