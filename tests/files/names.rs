//! Named groups of faces and lines survive from every format to every format, as far as the two can carry them; what
//! they name stays where it was.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::Path;

use glam::DVec3;
use quadfront::core::case::Case;
use quadfront::core::convert::conversion::convert;
use quadfront::core::formats::format::{read_bytes, read_mesh, write_mesh};
use quadfront::core::formats::{Format, WriteOptions};
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{Allow, Group, MeshFile};

use super::grid::grid;
use super::{MSH2, TEXT, bytes_of, data};

/// The groups of [`plate`]: dimension, name, tag; how long or large they are seen from above, and within which x and y.
const GROUPS: [(u8, &str, u32, [f64; 5]); 7] = [
    (1, "tongue", 3, [0.25, 0.125, 0.375, 0.5, 0.5]),
    (1, "floor", 4, [1.0, 0.0, 1.0, 0.0, 0.0]),
    (1, "rib", 5, [1.0, 0.75, 0.75, 0.0, 1.0]),
    (1, "the seam", 6, [1.0, 0.5, 0.5, 0.0, 1.0]),
    (1, "rim", 12, [1.0, 1.0, 1.0, 0.0, 1.0]),
    (2, "left plate", 7, [0.5, 0.0, 0.5, 0.0, 1.0]),
    (2, "right", 9, [0.5, 0.5, 1.0, 0.0, 1.0]),
];

/// A plate of `2 n` by `2 n` squares, `n` a multiple of 4, bent up along a parabola: two regions and the line between
/// them, two sides of it, a line across one region and one that ends within the other.
pub fn plate(n: u32, height: f64) -> MeshFile {
    let n = 2 * n;
    let mut mesh = grid(n, |x, _| height * x * x);
    mesh.triangle_tags = (0..2 * n * n).map(|t| if t / 2 % n < n / 2 { 7 } else { 9 }).collect();
    let sides = (0..(n + 1) * (n + 1)).flat_map(|a| [[a, a + 1], [a, a + n + 1]]);
    for side in sides.filter(|side| side[1] < (n + 1) * (n + 1) && (side[1] != side[0] + 1 || side[1] % (n + 1) != 0)) {
        let [p, q] = side.map(|k| mesh.points[k as usize]);
        let on = |[_, x0, x1, y0, y1]: &[f64; 5]| {
            [p, q].iter().all(|p| (*x0..=*x1).contains(&p.x) && (*y0..=*y1).contains(&p.y))
        };
        if let Some((_, _, tag, _)) = GROUPS.iter().find(|group| group.0 == 1 && on(&group.3)) {
            mesh.lines.push(side);
            mesh.line_tags.push(*tag);
        }
    }
    mesh.groups = GROUPS.map(|(dimension, name, tag, _)| Group { dimension, tag, name: name.to_owned() }).to_vec();
    mesh
}

/// How long or large each group is, seen from above, and where it lies.
fn measured(mesh: &MeshFile) -> BTreeMap<(u8, String), [f64; 5]> {
    let mut found: BTreeMap<(u8, String), [f64; 5]> = BTreeMap::new();
    let mut add = |dimension: u8, name: String, corners: &[u32]| {
        let p: Vec<DVec3> = corners.iter().map(|&k| mesh.points[k as usize]).collect();
        let n = p.len();
        let size = match p[..] {
            [a, b] => a.truncate().distance(b.truncate()),
            _ => 0.5 * (0..n).map(|k| p[k].truncate().perp_dot(p[(k + 1) % n].truncate())).sum::<f64>(),
        };
        let nowhere = [0.0, f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        let [sum, x0, x1, y0, y1] = found.entry((dimension, name)).or_insert(nowhere);
        *sum += size;
        for p in p {
            (*x0, *x1, *y0, *y1) = (x0.min(p.x), x1.max(p.x), y0.min(p.y), y1.max(p.y));
        }
    };
    let (lines, line_of) = mesh.line_groups();
    for (corners, line) in mesh.lines.iter().zip(line_of) {
        if let Some(line) = line {
            add(1, lines[line as usize].name.clone(), corners);
        }
    }
    let tag = |tags: &[u32], i: usize| tags.get(i).copied().unwrap_or(0);
    mesh.triangles.iter().enumerate().for_each(|(i, t)| add(2, mesh.region(tag(&mesh.triangle_tags, i)).name, t));
    mesh.quads.iter().enumerate().for_each(|(i, q)| add(2, mesh.region(tag(&mesh.quad_tags, i)).name, q));
    found
}

/// How a format spells the name of a group that has this tag in the mesh that is written.
fn spelled(format: Format, dimension: u8, name: &str, tag: u32) -> String {
    match format {
        Format::Obj => name.replace(' ', "_"),
        Format::Inp if name.contains(' ') => {
            format!("{}_{tag}_{}", if dimension == 1 { "CURVE" } else { "SURFACE" }, name.replace(' ', "_"))
        }
        // It has numbers alone.
        Format::Medit => format!("{} {tag}", if dimension == 1 { "line" } else { "region" }),
        _ => name.to_owned(),
    }
}

fn check(mesh: &MeshFile, expected: &BTreeMap<(u8, String), [f64; 5]>, what: &str) {
    let found = measured(mesh);
    for (group, [size, where_it_lies @ ..]) in expected {
        let Some([own, at @ ..]) = found.get(group) else { panic!("{what}: {group:?} is lost: {:?}", found.keys()) };
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        assert!(
            near(*size, *own) && at.iter().zip(where_it_lies).all(|(a, b)| near(*a, *b)),
            "{what}: {group:?} {own} {at:?}"
        );
    }
    let mut others = found.keys().filter(|group| !expected.contains_key(group));
    assert!(
        others.all(|(dimension, name)| *dimension == 1 && ["boundary", "inside"].contains(&name.as_str())
            || what.ends_with("Medit")),
        "{what}: {found:?}"
    );
}

/// The quadrilaterals of a mesh file, used as a word says.
fn converted(path: &Path, used: &str) -> MeshFile {
    let name = path.file_name().unwrap().to_str().unwrap();
    let text = format!("version = 1\nmesh = \"{name}\"\nuse = \"{used}\"\n");
    let done = convert(&Case::parse(&text, "a", "a.toml", path.parent().unwrap()).unwrap(), &mut Nobody).unwrap();
    let file = Export::of(&done.mesh, &done.names).file;
    examine(&file).verdict(Allow { branching: true, ..Allow::default() }).unwrap();
    // Lines run along sides of quadrilaterals.
    let key = |a: u32, b: u32| [a.min(b), a.max(b)];
    let sides: BTreeSet<[u32; 2]> =
        file.quads.iter().flat_map(|q| [0, 1, 2, 3].map(|k| key(q[k], q[(k + 1) % 4]))).collect();
    assert!(file.lines.iter().all(|[a, b]| sides.contains(&key(*a, *b))));
    file
}

/// Every format that is written, both versions of Gmsh's.
fn outputs() -> impl Iterator<Item = (Format, WriteOptions)> {
    Format::written().map(|format| (format, TEXT)).chain([(Format::Msh, MSH2)])
}

#[test]
fn groups_survive_from_every_format_to_every_format() {
    let folder = tempfile::tempdir().unwrap();
    for ((from, options), height) in outputs().flat_map(|from| [(from, 0.0), (from, 0.3)]) {
        let path = folder.path().join("a").with_extension(from.extension());
        write_mesh(&path, from, &plate(4, height), options).unwrap();
        let given: Vec<(u8, String, [f64; 5])> = GROUPS
            .iter()
            .map(|(dimension, name, tag, at)| (*dimension, spelled(from, *dimension, name, *tag), *at))
            .collect();
        for used in ["triangles", "shape"] {
            let quads = converted(&path, used);
            for (to, options) in outputs() {
                let back = read_bytes("a", &bytes_of(to, &quads, options), to).unwrap();
                let expected = given.iter().map(|(dimension, name, at)| {
                    let group = quads.groups.iter().find(|group| (group.dimension, &group.name) == (*dimension, name));
                    let tag = group.unwrap_or_else(|| panic!("{from:?}: {name} is lost: {:?}", quads.groups)).tag;
                    ((*dimension, spelled(to, *dimension, name, tag)), *at)
                });
                check(&back, &expected.collect(), &format!("{height}, {from:?} {used} {to:?}"));
            }
            // Where a format has numbers they are the same ones.
            if matches!(from, Format::Msh | Format::Medit | Format::Vtu | Format::Ply) {
                for (dimension, name, tag, _) in GROUPS {
                    assert_eq!(
                        quads.group_name(dimension, tag),
                        Some(&*spelled(from, dimension, name, tag)),
                        "{from:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn names_of_solids_and_of_nodes_survive_into_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = plate(4, 0.3);
    let mut text = String::new();
    for (tag, name) in [(7, "left plate"), (9, "right")] {
        writeln!(text, "solid {name}").unwrap();
        for (t, _) in mesh.triangles.iter().zip(&mesh.triangle_tags).filter(|(_, own)| **own == tag) {
            let corners =
                t.map(|k| mesh.points[k as usize].as_vec3()).map(|p| format!("vertex {} {} {}", p.x, p.y, p.z));
            writeln!(text, "facet normal 0 0 1 outer loop {} endloop endfacet", corners.join(" ")).unwrap();
        }
        writeln!(text, "endsolid {name}").unwrap();
    }
    let stl = folder.path().join("a.stl");
    std::fs::write(&stl, text).unwrap();
    for (path, names) in [(stl, ["left plate", "right"]), (data("plates.gltf"), ["left", "right"])] {
        let given = read_mesh(&path, None).unwrap();
        assert_eq!(given.groups.iter().map(|group| group.name.as_str()).collect::<Vec<_>>(), names);
        for used in ["triangles", "shape"] {
            let quads = converted(&path, used);
            for (to, options) in outputs() {
                let back = measured(&read_bytes("a", &bytes_of(to, &quads, options), to).unwrap());
                for (name, tag) in names.iter().zip(1..) {
                    let name = spelled(to, 2, name, tag);
                    let area = back.get(&(2, name.clone())).map(|at| at[0]);
                    let own = measured(&given)[&(2, names[tag as usize - 1].to_owned())][0];
                    assert!(area.is_some_and(|area| (area - own).abs() < 1e-6), "{to:?}: {name} {area:?} {own}");
                }
            }
        }
    }
}
