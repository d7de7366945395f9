//! Borders, interfaces, groups and points of what is given are kept: odd interfaces are divided as rarely as possible,
//! groups that overlap do not cut and are all written again.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::DVec3;
use quadfront::core::case::{Case, ImportOptions, MeshUse};
use quadfront::core::convert::conversion::{Converted, convert};
use quadfront::core::formats::format::{read_bytes, read_mesh, write_to};
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{Allow, Ignored, MeshFile};

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// The quadrilaterals of a case, which are sound.
fn converted(case: &Case) -> (Converted, MeshFile) {
    let done = convert(case, &mut Nobody).unwrap();
    let file = Export::of(&done.mesh, &done.names).file;
    examine(&file).verdict(Allow::default()).unwrap();
    assert!(file.triangles.is_empty());
    (done, file)
}

fn converted_mesh(name: &str, options: &ImportOptions) -> (Converted, MeshFile) {
    converted(&options.case(data(name), None).unwrap())
}

/// The area of an element in space.
fn area(mesh: &MeshFile, corners: &[u32]) -> f64 {
    let p: Vec<DVec3> = corners.iter().map(|&k| mesh.points[k as usize]).collect();
    0.5 * (1..p.len() - 1).map(|k| (p[k] - p[0]).cross(p[k + 1] - p[0])).sum::<DVec3>().length()
}

/// The area of every group of elements, by region and by further membership.
fn areas(mesh: &MeshFile) -> BTreeMap<String, f64> {
    let mut found = BTreeMap::new();
    let elements: Vec<(&[u32], u32)> = {
        let tag = |tags: &[u32], i: usize| tags.get(i).copied().unwrap_or(0);
        let triangles = mesh.triangles.iter().enumerate().map(|(i, t)| (&t[..], tag(&mesh.triangle_tags, i)));
        triangles.chain(mesh.quads.iter().enumerate().map(|(i, q)| (&q[..], tag(&mesh.quad_tags, i)))).collect()
    };
    let name = |tag: u32| mesh.group_name(2, tag).unwrap_or("region 0").to_owned();
    for (corners, tag) in &elements {
        *found.entry(name(*tag)).or_insert(0.0) += area(mesh, corners);
    }
    for members in mesh.members.iter().filter(|members| members.dimension == 2) {
        let own: f64 = members.of.iter().map(|&k| area(mesh, elements[k as usize].0)).sum();
        *found.entry(name(members.tag)).or_insert(0.0) += own;
    }
    found
}

/// The mesh after it is written and read again.
fn read_back(mesh: &MeshFile, format: Format) -> MeshFile {
    let mut bytes = Vec::new();
    write_to(&mut bytes, format, mesh, WriteOptions { msh2: false }).unwrap();
    read_bytes("again", &bytes, format).unwrap()
}

fn near(a: &BTreeMap<String, f64>, b: &BTreeMap<String, f64>) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|((m, x), (n, y))| m == n && (x - y).abs() < 1e-9 * x.abs().max(1.0))
}

#[test]
fn an_odd_interface_in_the_plane_is_divided_as_in_space() {
    for name in ["odd_interface_min.msh", "odd_interface_min_tilt.msh"] {
        for split_odd in [false, true] {
            let given = read_mesh(&data(name), None).unwrap();
            // In the plane the triangles are converted by default.
            let used = Some(MeshUse::Triangles);
            let options = ImportOptions { used, split_odd, ..ImportOptions::default() };
            let (done, quads) = converted_mesh(name, &options);
            assert_eq!(done.repairs.len(), 1, "{:?}", done.repairs);
            assert!(done.repairs[0].starts_with("1 side "), "{:?}", done.repairs);
            let found = areas(&quads);
            assert!(near(&found, &areas(&given)), "{name}: {found:?}");
            assert_eq!(found.keys().collect::<Vec<_>>(), ["grain", "matrix"]);
        }
    }
}

#[test]
fn a_set_of_abaqus_is_kept_as_a_set_and_can_be_ignored() {
    // Three elements that lie apart: no border, which would be odd around each of them.
    let given = read_mesh(&data("i_cps3.inp"), None).unwrap();
    let (done, quads) = converted_mesh("i_cps3.inp", &ImportOptions::default());
    assert_eq!(
        done.repairs,
        [
            "1 group was kept without a cut",
            "not read: keyword *PART, *ASSEMBLY, *INSTANCE, *MATERIAL and *ELASTIC",
            "not read: node set Set-1"
        ]
    );
    let [own, whole] = ["E1", "region 0"].map(|name| areas(&quads)[name]);
    assert!(own > 0.0 && own < 8.0 * areas(&given)["E1"] && (whole - areas(&given)["region 0"]).abs() < 1e-9);
    assert_eq!(areas(&read_back(&quads, Format::Inp))["E1"], own);
    for ignore_groups in [Ignored::All, Ignored::Named(vec!["E1".to_owned()])] {
        let (done, quads) = converted_mesh("i_cps3.inp", &ImportOptions { ignore_groups, ..ImportOptions::default() });
        assert!(done.repairs.iter().all(|told| !told.contains("divided")), "{:?}", done.repairs);
        assert!(quads.groups.iter().all(|group| group.name != "E1"));
    }
    let ignore_groups = Ignored::Named(vec!["E2".to_owned()]);
    let case = ImportOptions { ignore_groups, ..ImportOptions::default() }.case(data("i_cps3.inp"), None).unwrap();
    assert!(convert(&case, &mut Nobody).unwrap_err().to_string().contains("\"E1\""));
}

#[test]
fn an_element_in_several_groups_keeps_all() {
    let given = read_mesh(&data("multi_phys41.msh"), None).unwrap();
    let expected = BTreeMap::from([("all".to_owned(), 3.0), ("right".to_owned(), 1.0)]);
    assert!(near(&areas(&given), &expected), "{:?}", areas(&given));
    for used in ["triangles", "shape"] {
        let text = format!("version = 1\nmesh = \"multi_phys41.msh\"\nuse = \"{used}\"\n");
        let case = Case::parse(&text, "a", "a.toml", data("").as_path()).unwrap();
        let (_, quads) = converted(&case);
        for mesh in [&quads, &read_back(&quads, Format::Msh), &read_back(&quads, Format::Inp)] {
            assert!(near(&areas(mesh), &expected), "{used}: {:?}", areas(mesh));
        }
    }
}

#[test]
fn a_set_that_overlaps_others_does_not_cut_the_mesh() {
    // The sections make regions of LEFT and RIGHT; LOAD lies across both, and one element is in LEFT alone.
    let mut text = "*NODE\n".to_owned();
    let n = 9;
    for k in 0..n * n {
        text += &format!("{}, {}, {}\n", k + 1, k % n, k / n);
    }
    text += "*ELEMENT, TYPE=S3\n";
    let mut left = Vec::new();
    for k in 0..(n - 1) * (n - 1) {
        let (i, j) = (k % (n - 1), k / (n - 1));
        let a = j * n + i + 1;
        text += &format!("{}, {a}, {}, {}\n", 2 * k + 1, a + 1, a + n + 1);
        text += &format!("{}, {a}, {}, {}\n", 2 * k + 2, a + n + 1, a + n);
        if i < 4 {
            left.extend([2 * k + 1, 2 * k + 2]);
        }
    }
    let list = |numbers: &[usize]| numbers.iter().map(|k| format!("{k},\n")).collect::<String>();
    let right: Vec<usize> = (1..=2 * (n - 1) * (n - 1)).filter(|k| !left.contains(k)).collect();
    text += &format!("*ELSET, ELSET=LEFT\n{}*ELSET, ELSET=RIGHT\n{}", list(&left), list(&right));
    text += "*ELSET, ELSET=LOAD, GENERATE\n39, 89\n*SHELL SECTION, ELSET=LEFT\n1.\n*SHELL SECTION, ELSET=RIGHT\n1.\n";
    let given = read_bytes("a.inp", text.as_bytes(), Format::Inp).unwrap();
    let expected = [("LEFT", 32.0), ("LOAD", 25.5), ("RIGHT", 32.0)].map(|(name, area)| (name.to_owned(), area));
    assert_eq!(areas(&given), BTreeMap::from(expected));
    let (done, quads) = converted(&Case::of_mesh_in_memory("sets", given));
    assert_eq!(done.repairs, ["1 group was kept without a cut"]);
    // The grid comes back as it would without LOAD, whose quadrilaterals are those within it.
    assert_eq!(quads.quads.len(), 64);
    let found = areas(&quads);
    assert_eq!((found["LEFT"], found["RIGHT"]), (32.0, 32.0));
    assert!((found["LOAD"] - 25.5).abs() <= 1.0, "{found:?}");
    assert!(near(&areas(&read_back(&quads, Format::Msh)), &found));
}

/// The groups of points, each with the places of its points.
fn points(mesh: &MeshFile) -> Vec<(String, Vec<DVec3>)> {
    let name = |tag: u32| mesh.group_name(0, tag).unwrap_or("none").to_owned();
    let of = |of: &[u32]| of.iter().map(|&k| mesh.points[k as usize]).collect();
    mesh.members.iter().filter(|m| m.dimension == 0).map(|m| (name(m.tag), of(&m.of))).collect()
}

/// The corners of elements at a place.
fn corners_at(mesh: &MeshFile, p: DVec3) -> usize {
    mesh.quads.iter().flatten().filter(|&&k| mesh.points[k as usize] == p).count()
}

#[test]
fn points_in_groups_become_nodes_exactly_and_keep_their_group() {
    let place = DVec3::new(0.4, 0.8, 0.0);
    for used in ["triangles", "shape"] {
        for scale in ["", "[parameters]\nsize_scale = 0.5\n", "[[metric]]\nkind = \"uniform\"\nh = 0.3\n"] {
            let text = format!("version = 1\nmesh = \"embedded.msh\"\nuse = \"{used}\"\n{scale}");
            let (_, quads) = converted(&Case::parse(&text, "a", "a.toml", data("").as_path()).unwrap());
            assert_eq!(points(&quads), [("sensor".to_owned(), vec![place])], "{used} {scale}");
            assert!(corners_at(&quads, place) >= 3, "{used} {scale}");
            assert_eq!(points(&read_back(&quads, Format::Msh)), points(&quads));
            assert_eq!(points(&read_back(&quads, Format::Medit)), [("none".to_owned(), vec![place])]);
        }
    }
    // The same point as a required vertex, and tilted out of the plane.
    let mut given = read_mesh(&data("embedded.msh"), None).unwrap();
    given = read_back(&given, Format::Medit);
    assert_eq!(points(&given), [("none".to_owned(), vec![place])]);
    given.points.iter_mut().for_each(|p| p.z = 0.3 * p.x + 0.1 * p.x * p.y);
    let place = points(&given)[0].1[0];
    for used in ["triangles", "shape"] {
        let text = format!("version = 1\nmesh = \"a.mesh\"\nuse = \"{used}\"\n");
        let folder = tempfile::tempdir().unwrap();
        let mut file = std::fs::File::create(folder.path().join("a.mesh")).unwrap();
        write_to(&mut file, Format::Medit, &given, WriteOptions { msh2: false }).unwrap();
        let (_, quads) = converted(&Case::parse(&text, "a", "a.toml", folder.path()).unwrap());
        assert_eq!(points(&quads), [("none".to_owned(), vec![place])], "{used}");
        assert!(corners_at(&quads, place) >= 3, "{used}");
    }
}

/// A plate with a hole and points.
const PLATE: &str = r#"
    version = 1
    [[curve]]
    name = "frame"
    kind = "polyline"
    points = [[0, 0], [2, 0], [2, 1], [0, 1]]
    closed = true
    [[curve]]
    name = "hole"
    kind = "circle"
    centre = [0.6, 0.5]
    radius = 0.2
    [[face]]
    name = "plate"
    outer = ["frame"]
    holes = [["hole"]]
    [[metric]]
    kind = "uniform"
    h = 0.15
"#;

fn plate(more: &str) -> Case {
    Case::parse(&format!("{PLATE}{more}"), "plate", "plate.toml", Path::new("")).unwrap()
}

#[test]
fn points_of_a_case_become_nodes_inside_on_curves_and_at_corners() {
    let (sin, cos) = libm::sincos(1.0);
    let places = [(1.3, 0.37), (1.7, 0.0), (2.0, 1.0), (0.6 + 0.2 * cos, 0.5 + 0.2 * sin), (1.32, 0.72)];
    let mut more = String::new();
    for (k, (x, y)) in places.iter().enumerate() {
        more += &format!("[[point]]\nname = \"p{k}\"\nat = [{x:?}, {y:?}]\n");
    }
    more += "size = 0.02\n";
    let (_, quads) = converted(&plate(&more));
    let found = points(&quads);
    for (k, (x, y)) in places.iter().enumerate() {
        let place = DVec3::new(*x, *y, 0.0);
        assert_eq!(found[k], (format!("p{k}"), vec![place]));
        assert!(corners_at(&quads, place) >= if *x == 2.0 { 1 } else { 2 }, "p{k}");
    }
    // The size asked for at the last one holds there, and grades away.
    let around = |p: DVec3, r: f64| {
        let sides = quads.quads.iter().flat_map(|q| (0..4).map(move |k| [q[k], q[(k + 1) % 4]]));
        let ends = sides.map(|side| side.map(|k| quads.points[k as usize]));
        let near: Vec<f64> = ends.filter(|[a, b]| a.midpoint(*b).distance(p) < r).map(|[a, b]| a.distance(b)).collect();
        near.iter().sum::<f64>() / near.len() as f64
    };
    let last = DVec3::new(1.32, 0.72, 0.0);
    assert!((0.012..0.04).contains(&around(last, 0.04)), "{}", around(last, 0.04));
    assert!(around(DVec3::new(1.8, 0.2, 0.0), 0.2) > 0.08);
    let told = |more: &str| convert(&plate(more), &mut Nobody).unwrap_err().to_string();
    assert!(told("[[point]]\nname = \"in the hole\"\nat = [0.6, 0.5]\n").contains("\"in the hole\" lies outside"));
    let parsed = |more: &str| Case::parse(&format!("{PLATE}{more}"), "plate", "plate.toml", Path::new(""));
    assert!(parsed("[[point]]\nname = \"p\"\nat = [1, 0.5]\ngrowth = 1.3\n").unwrap_err().to_string().contains("size"));
}

/// Random places of points in a plate, most of them close together.
#[test]
fn any_number_of_points_gives_a_sound_mesh_with_all_of_them() {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31)
    };
    for round in 0..24 {
        let count = 1 + round % 9;
        let spread = [1.0, 0.2, 0.05][round % 3];
        let mut more = String::new();
        for k in 0..count {
            let (x, y) = (1.4 + spread * 0.5 * (random() - 0.5), 0.5 + spread * 0.9 * (random() - 0.5));
            more += &format!("[[point]]\nname = \"p{k}\"\nat = [{x:?}, {y:?}]\n");
        }
        let (_, quads) = converted(&plate(&more));
        assert_eq!(points(&quads).len(), count, "{more}");
    }
}

/// The nodes of the loop around a hole, by its middle and its largest radius; and the area that it encloses.
fn hole(mesh: &MeshFile, middle: DVec3, radius: f64) -> (Vec<DVec3>, f64) {
    let on = |k: u32| mesh.points[k as usize].distance(middle) <= 1.001 * radius;
    let border: Vec<[DVec3; 2]> = (mesh.lines.iter().filter(|line| line.iter().all(|&k| on(k))))
        .map(|line| line.map(|k| mesh.points[k as usize]))
        .collect();
    let area = border.iter().map(|[a, b]| 0.5 * (*a - middle).cross(*b - middle).length()).sum();
    (border.into_iter().map(|[a, _]| a).collect(), area)
}

#[test]
fn a_small_hole_keeps_its_shape_whatever_the_sizes_are() {
    let (done, quads) = converted(&Case::read(&data("coarse_hole.toml")).unwrap());
    let area_of_circle = std::f64::consts::PI * 0.36;
    let (nodes, area) = hole(&quads, DVec3::new(5.0, 5.0, 0.0), 0.6);
    assert!(nodes.len() >= 8 && (area / area_of_circle - 1.0).abs() < 0.1, "{} {area}", nodes.len());
    assert_eq!(done.repairs, ["1 curve was divided more finely than the sizes ask, to keep the shape"]);
    // The limits of the case decide.
    let text = std::fs::read_to_string(data("coarse_hole.toml")).unwrap();
    let edges = |keys: &str| {
        let case = Case::parse(&text.replace("version = 1", &format!("version = 1\n{keys}")), "a", "a", Path::new(""));
        hole(&converted(&case.unwrap()).1, DVec3::new(5.0, 5.0, 0.0), 0.6).0.len()
    };
    assert_eq!(edges("least_segments = 12"), 12);
    assert!(edges("chord = 0.01") >= 22);
    assert!(edges("chord = 1\nleast_segments = 3") <= 6);
    assert!(Case::parse("version = 1\nchord = 0\n", "a", "a", Path::new("")).is_err());
}

#[test]
fn chords_keep_their_distance_where_sizes_vary_and_curves_that_do_already_are_divided_by_sizes_alone() {
    let with_sizes = |h: &str, keys: &str| {
        let text = PLATE.replace("kind = \"uniform\"\n    h = 0.15", &format!("kind = \"formula\"\n    h1 = \"{h}\""));
        let text = text.replace("version = 1", &format!("version = 1\n{keys}"));
        assert!(text.contains(h));
        converted(&Case::parse(&text, "plate", "plate.toml", Path::new("")).unwrap())
    };
    let middle = DVec3::new(0.6, 0.5, 0.0);
    let mut shaped = 0;
    for chord in [0.1, 0.03] {
        for growth in [0.3, 0.8, 2.0, 6.0] {
            let (done, quads) = with_sizes(&format!("0.03 + {growth}*abs(x - 0.4)"), &format!("chord = {chord}"));
            shaped += usize::from(done.repairs.iter().any(|told| told.starts_with("1 curve was divided more finely")));
            let ends = quads.lines.iter().map(|line| line.map(|k| quads.points[k as usize]));
            let on_hole = ends.filter(|ends| ends.iter().all(|p| p.distance(middle) < 0.2001));
            let off = on_hole.map(|[a, b]| 1.0 - a.midpoint(b).distance(middle) / 0.2).fold(0.0, f64::max);
            assert!(off > 0.0 && off < 1.02 * chord, "{chord} {growth}: {off}");
        }
    }
    assert!(shaped > 2, "{shaped}");
    let fine = |keys: &str| with_sizes("0.04 + 0.05*abs(x - 0.4)", keys);
    let (done, quads) = fine("");
    assert!(done.repairs.is_empty(), "{:?}", done.repairs);
    assert_eq!(quads, fine("chord = 1\nleast_segments = 3").1);
}

#[test]
fn the_hole_of_a_flat_mesh_keeps_its_shape_to_a_tenth_of_its_radius() {
    let plain = ImportOptions::default();
    let sized = ImportOptions { mesh_size: Some(15.0), curvature: Some(0.01), ..ImportOptions::default() };
    for (options, least) in [(plain, 11), (sized, 20)] {
        let (done, quads) = converted_mesh("plate_hole_soup.obj", &options);
        assert!(100 * done.last_resort.quads() < quads.quads.len(), "{:?}", done.last_resort);
        let middle = DVec3::new(0.0, 25.0, 25.0);
        let (nodes, area) = hole(&quads, middle, 10.0);
        assert!(nodes.len() >= least, "{}", nodes.len());
        // The distance of each chord from the circle through the corners of the hole.
        let mut ends = quads.lines.iter().map(|line| line.map(|k| quads.points[k as usize]));
        let inside = |p: DVec3| p.distance(middle) < 12.0;
        assert!(ends.all(|[a, b]| !inside(a) || !inside(b) || a.midpoint(b).distance(middle) >= 9.0));
        assert!(area > 0.88 * std::f64::consts::PI * 100.0, "{area}");
    }
}
