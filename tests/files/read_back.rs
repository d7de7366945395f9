//! What is written reads back the same; files appear whole or not at all.

use std::fs;
use std::path::Path;
use std::process::Command;

use glam::DVec3;
use quadfront::core::formats::Format;
use quadfront::core::formats::format::{read_bytes, read_mesh, write_mesh};
use quadfront::core::formats::save::{abandon, save};
use quadfront::core::kernel::Metric3;
use quadfront::core::soup::mesh_file::FRONT;
use quadfront::core::soup::{Group, MeshFile};

use super::{MSH2, TEXT, bytes_of, plates};

#[test]
fn msh_of_both_versions_reads_back_the_same_in_every_bit() {
    for options in [TEXT, MSH2] {
        let bytes = bytes_of(Format::Msh, &plates(), options);
        assert_eq!(read_bytes("a.msh", &bytes, Format::Msh).unwrap(), plates());
    }
}

#[test]
fn interleaved_regions_keep_the_order_of_their_elements() {
    let mut mesh = MeshFile::default();
    for i in 0..6u32 {
        mesh.points.push(DVec3::new(f64::from(i), 0.0, 0.5));
        mesh.points.push(DVec3::new(f64::from(i), 1.0, 0.5));
    }
    mesh.quads = (0..5).map(|i| [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1]).collect();
    mesh.quad_tags = vec![3, 1, 0, 1, 3];
    for options in [TEXT, MSH2] {
        let bytes = bytes_of(Format::Msh, &mesh, options);
        assert_eq!(read_bytes("a.msh", &bytes, Format::Msh).unwrap(), mesh);
    }
}

#[test]
fn msh_lists_the_data_of_points_in_the_order_of_the_points_as_readers_without_tags_need_it() {
    // The first tag of each line in a section: the tags of nodes in $Nodes, those of values in $NodeData.
    let tags = |text: &str, section: &str, blocks: bool| -> Vec<Vec<u64>> {
        let heading = format!("${section}\n");
        let parts = text.split(heading.as_str()).skip(1);
        let lines = parts.map(|part| part.split("$End").next().unwrap().lines().collect::<Vec<_>>());
        lines
            .map(|lines| {
                let mut tags = Vec::new();
                let mut at = if blocks { 1 } else { 8 };
                while at < lines.len() {
                    let count = if blocks { lines[at].split(' ').nth(3).unwrap().parse().unwrap() } else { 1 };
                    let first = if blocks { at + 1 } else { at };
                    let tag = |line: &&str| line.split(' ').next().unwrap().parse::<u64>().unwrap();
                    tags.extend(lines[first..first + count].iter().map(tag));
                    at += if blocks { 1 + 2 * count } else { 1 };
                }
                tags
            })
            .collect()
    };
    // The boundary's entity comes first, and its points are not the first ones.
    let mut mesh = plates();
    mesh.lines = vec![[3, 0], [5, 2]];
    mesh.line_tags = vec![7, 7];
    let text = String::from_utf8(bytes_of(Format::Msh, &mesh, TEXT)).unwrap();
    let nodes = tags(&text, "Nodes", true).concat();
    assert!(!nodes.is_sorted() && nodes.len() == mesh.points.len());
    let of_data = tags(&text, "NodeData", false);
    assert!(of_data.len() > 1 && of_data.iter().all(|tags| *tags == nodes), "{nodes:?} {of_data:?}");
}

#[test]
fn medit_reads_back_the_same_with_its_metric_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mesh");
    let mut mesh = plates();
    mesh.groups.clear();
    mesh.point_data.clear();
    mesh.element_data.clear();
    write_mesh(&path, Format::Medit, &mesh, TEXT).unwrap();
    assert_eq!(read_mesh(&path, None).unwrap(), mesh);
    // In space: all six components, in Medit's order.
    mesh.points[0].z = -0.3;
    mesh.metric = Some(vec![Metric3 { xx: 9.0, xy: 0.1, xz: 0.2, yy: 8.0, yz: 0.3, zz: 7.0 }; 6]);
    write_mesh(&path, Format::Medit, &mesh, TEXT).unwrap();
    assert!(fs::read_to_string(path.with_extension("sol")).unwrap().contains("\n9 0.1 8 0.2 0.3 7\n"));
    assert_eq!(read_mesh(&path, None).unwrap(), mesh);
    // Another metric may be named, for a mesh of any format.
    let (msh, sol) = (folder.path().join("b.msh"), folder.path().join("other.sol"));
    write_mesh(&msh, Format::Msh, &MeshFile { metric: None, ..mesh.clone() }, TEXT).unwrap();
    fs::write(&sol, "MeshVersionFormatted 2 Dimension 3 SolAtVertices 6 1 1 .5 .5 .5 .5 .5 .5 End").unwrap();
    let metric = read_mesh(&msh, Some(&sol)).unwrap().metric.unwrap();
    assert_eq!(metric[5], Metric3 { xx: 4.0, xy: 0.0, xz: 0.0, yy: 4.0, yz: 0.0, zz: 4.0 });
}

#[test]
fn vtu_reads_back_the_surface_with_its_data() {
    let mesh = plates();
    let read = read_bytes("a.vtu", &bytes_of(Format::Vtu, &mesh, TEXT), Format::Vtu).unwrap();
    // Lines in no group stay behind, and a name is one name however often it is given.
    assert_eq!(read, MeshFile { lines: mesh.lines[..2].to_vec(), line_tags: vec![7, 7], ..mesh });
}

#[test]
fn the_front_of_a_state_is_cells_of_a_vtu_and_data_stay_with_their_elements() {
    let mut state = plates();
    let front = 1 + state.line_tags.iter().max().unwrap();
    state.lines.push([0, 1]);
    state.line_tags.push(front);
    state.groups.insert(0, Group { dimension: 1, tag: front, name: FRONT.to_string() });
    let bytes = bytes_of(Format::Vtu, &state, TEXT);
    let text = String::from_utf8(bytes.clone()).unwrap();
    let cells = state.triangles.len() + state.quads.len() + 3;
    assert!(text.contains(&format!("NumberOfCells=\"{cells}\"")), "{text}");
    let read = read_bytes("a.vtu", &bytes, Format::Vtu).unwrap();
    let own = [&state.lines[..2], &state.lines[3..]].concat();
    state.groups.sort_by_key(|group| (group.dimension, group.tag));
    assert_eq!(read, MeshFile { lines: own, line_tags: vec![7, 7, front], ..state.clone() });
    // A line has the data of the element beside it: of the quadrilateral, which comes third.
    let quality = text.split("Name=\"quality\"").nth(1).unwrap().lines().skip(1).take(6).collect::<Vec<_>>();
    assert_eq!(quality, ["0.25", "0.5", "0.14285714285714285", "0.14285714285714285", "0.25", "0.14285714285714285"]);
}

#[test]
fn obj_and_inp_read_back_points_and_elements() {
    let mesh = plates();
    for format in [Format::Obj, Format::Inp] {
        let read = read_bytes("a", &bytes_of(format, &mesh, TEXT), format).unwrap();
        assert_eq!(
            (read.points, read.triangles, read.quads),
            (mesh.points.clone(), mesh.triangles.clone(), mesh.quads.clone())
        );
    }
    let inp = String::from_utf8(bytes_of(Format::Inp, &mesh, TEXT)).unwrap();
    assert!(inp.contains("*ELSET, ELSET=right\n1, 2\n") && inp.contains("*NSET, NSET=floor\n1, 2, 5\n"), "{inp}");
    assert!(inp.contains("*ELSET, ELSET=SURFACE_1_left____plate_\n3\n"), "{inp}");
}

#[test]
fn groups_of_obj_are_regions_and_come_back() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no all\ng left side\nf 1 2 3\ng right\nf 1 3 4\ng left\nf 1 2 4\n";
    let mut mesh = read_bytes("a.obj", text.as_bytes(), Format::Obj).unwrap();
    mesh.omitted.clear();
    assert_eq!(mesh.triangle_tags, [1, 2, 1]);
    assert_eq!([1, 2].map(|tag| mesh.group_name(2, tag)), [Some("left"), Some("right")]);
    assert_eq!(read_bytes("a.obj", &bytes_of(Format::Obj, &mesh, TEXT), Format::Obj).unwrap(), mesh);
}

#[test]
fn ply_reads_back_points_elements_and_tags() {
    let mesh = read_bytes("a", &bytes_of(Format::Ply, &plates(), TEXT), Format::Ply).unwrap();
    let plates = plates();
    assert_eq!((&mesh.points, &mesh.triangles, &mesh.quads), (&plates.points, &plates.triangles, &plates.quads));
    assert_eq!((&mesh.triangle_tags, &mesh.quad_tags), (&plates.triangle_tags, &plates.quad_tags));
}

#[test]
fn giving_up_halfway_leaves_the_old_file_and_nothing_beside_it() {
    // Giving up is for the whole process, so another one does it: this test again, told by a variable where.
    const PLACE: &str = "QUADFRONT_TEST_GIVE_UP";
    if let Some(folder) = std::env::var_os(PLACE) {
        let path = Path::new(&folder).join("a.msh");
        let fault = save(&path, |out| {
            out.write_all(&[0; 1 << 20])?;
            abandon();
            assert_eq!(fs::read_dir(&folder)?.count(), 1);
            Ok(())
        });
        assert!(fault.unwrap_err().what.contains("given up"));
        assert!(save(&path, |_| Ok(())).is_err());
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.msh"), "old").unwrap();
    let this = "giving_up_halfway_leaves_the_old_file_and_nothing_beside_it";
    let child =
        Command::new(std::env::current_exe().unwrap()).args(["--exact", this]).env(PLACE, folder.path()).output();
    let child = child.unwrap();
    assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stdout));
    assert_eq!(fs::read(folder.path().join("a.msh")).unwrap(), b"old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
