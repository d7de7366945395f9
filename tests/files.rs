//! Promises about files: what is written reads back the same, what others write is read, what is broken is refused with
//! its place, and no bytes make a reader panic or hang.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use glam::DVec3;
use quadfront::core::io::format::{Format, WriteOptions, read_bytes, read_mesh, write_mesh, write_to};
use quadfront::core::io::medit;
use quadfront::core::io::mesh_file::{Data, FRONT, Group, MeshFile};
use quadfront::core::io::save::{abandon, save};
use quadfront::core::mesh::soundness::{Allow, examine};
use quadfront::core::metric::tensor::Metric3;

const TEXT: WriteOptions = WriteOptions { msh2: false };
const MSH2: WriteOptions = WriteOptions { msh2: true };

/// Two squares of two regions, one of them halved, with a boundary, a metric and data; nothing lies on a round number.
fn plates() -> MeshFile {
    let points = [(0.0, 0.0), (0.1, -1e-7), (1.0 / 3.0, 0.2), (0.0, 0.7), (1.1, 0.0), (1.0, 1e17f64.recip())];
    let mut mesh = MeshFile {
        points: points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect(),
        lines: vec![[0, 1], [1, 4], [3, 0]],
        triangles: vec![[1, 4, 5], [1, 5, 2]],
        quads: vec![[0, 1, 2, 3]],
        line_tags: vec![7, 7, 0],
        triangle_tags: vec![2, 2],
        quad_tags: vec![1],
        groups: vec![
            Group { dimension: 1, tag: 7, name: "floor".into() },
            Group { dimension: 2, tag: 1, name: "left & \"plate\"".replace('"', "'") },
            Group { dimension: 2, tag: 2, name: "right".into() },
        ],
        ..MeshFile::default()
    };
    mesh.metric = Some((1..=6).map(|i| tensor(f64::from(i))).collect());
    mesh.point_data = vec![Data { name: "u".into(), values: vec![0.1, -2e-9, 3.0, 4e20, 5.5, 6.0] }];
    mesh.element_data = vec![Data { name: "quality".into(), values: vec![0.25, 0.5, 1.0 / 7.0] }];
    mesh
}

/// A planar metric (z is free) whose determinant is a perfect square, so that the completion of a planar `.sol` is exact.
fn tensor(i: f64) -> Metric3 {
    Metric3 { xx: 4.0 * i, xy: 0.0, xz: 0.0, yy: i, yz: 0.0, zz: 2.0 * i }
}

fn bytes_of(format: Format, mesh: &MeshFile, options: WriteOptions) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_to(&mut bytes, format, mesh, options).unwrap();
    bytes
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

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
    assert_eq!(read, MeshFile { lines: vec![], line_tags: vec![], groups: vec![], ..mesh });
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
    let cells = state.triangles.len() + state.quads.len() + 1;
    assert!(text.contains(&format!("NumberOfCells=\"{cells}\"")), "{text}");
    let read = read_bytes("a.vtu", &bytes, Format::Vtu).unwrap();
    assert_eq!(read, MeshFile { lines: vec![[0, 1]], line_tags: vec![], groups: vec![], ..state });
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
fn what_gmsh_writes_is_read_alike_in_both_versions_as_text_and_binary() {
    let text = read_mesh(&data("plates_41a.msh"), None).unwrap();
    assert_eq!((text.points.len(), text.lines.len(), text.triangles.len(), text.quads.len()), (20, 4, 14, 6));
    assert_eq!((text.line_tags[0], text.triangle_tags[0], text.quad_tags[0]), (7, 1, 2));
    let names: Vec<_> = text.groups.iter().map(|group| (group.dimension, group.tag, group.name.as_str())).collect();
    assert_eq!(names, [(1, 7, "floor"), (2, 1, "left plate"), (2, 2, "right")]);
    let mixed = Allow { triangles: true, ..Allow::default() };
    assert_eq!(examine(&text).verdict(mixed), Ok(()));
    for other in ["plates_41b.msh", "plates_22a.msh", "plates_22b.msh"] {
        let mut mesh = read_mesh(&data(other), None).unwrap();
        // Gmsh writes sixteen digits into text, one less than it takes.
        assert!(mesh.points.iter().zip(&text.points).all(|(p, q)| p.distance(*q) < 1e-15), "{other}");
        mesh.points.clone_from(&text.points);
        assert_eq!(mesh, text, "{other}");
    }
}

#[test]
fn the_other_byte_order_is_read_too() {
    let number = |x: u64| x.to_be_bytes().to_vec();
    let mut bytes = b"$MeshFormat\n4.1 1 8\n".to_vec();
    bytes.extend(1i32.to_be_bytes());
    bytes.extend(b"\n$EndMeshFormat\n$Nodes\n");
    bytes.extend([1, 3, 1, 3].map(number).concat());
    bytes.extend([2i32, 1, 0].map(i32::to_be_bytes).concat());
    bytes.extend([3, 10, 20, 30].map(number).concat());
    bytes.extend([0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 2.5, 0.0].map(f64::to_be_bytes).concat());
    bytes.extend(b"\n$EndNodes\n$Elements\n");
    bytes.extend([1, 1, 1, 1].map(number).concat());
    bytes.extend([2i32, 1, 2].map(i32::to_be_bytes).concat());
    bytes.extend([1, 5, 10, 20, 30].map(number).concat());
    bytes.extend(b"\n$EndElements\n");
    let mesh = read_bytes("big.msh", &bytes, Format::Msh).unwrap();
    assert_eq!((mesh.points[2], mesh.triangles[0]), (DVec3::new(0.0, 2.5, 0.0), [0, 1, 2]));
}

#[test]
fn obj_takes_every_form_of_a_face() {
    let text = "# a\nv 0 0 0 1 1 1\nv 1 0 0\r\nv 1 1 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1/1 3//1\nf -4 -3 -2 -1\nf 1 2 3 4 9\nv 5 5 5\n\
                v 6 6 6\nv 7 7 7\nv 8 8 8\nv 9 9 9\n";
    let mesh = read_bytes("a.obj", text.as_bytes(), Format::Obj).unwrap();
    assert_eq!((mesh.triangles, mesh.quads), (vec![[0, 1, 2]], vec![[0, 1, 2, 3]]));
    assert_eq!((mesh.polygons, mesh.triangle_tags.len()), (vec![vec![0, 1, 2, 3, 8]], 0));
}

#[test]
fn an_independent_reader_finds_in_our_obj_what_we_wrote() {
    let mesh = plates();
    let bytes = bytes_of(Format::Obj, &mesh, TEXT);
    let (models, _) =
        tobj::load_obj_buf(&mut &bytes[..], &tobj::LoadOptions::default(), |_| Ok(Default::default())).unwrap();
    let mut faces = Vec::new();
    for model in &models {
        let position = |k: &u32| {
            let p = &model.mesh.positions[3 * *k as usize..][..3];
            [p[0], p[1], p[2]]
        };
        let corners: Vec<[f64; 3]> = model.mesh.indices.iter().map(position).collect();
        // Where all faces of a group are triangles there are no arities.
        let sides =
            if model.mesh.face_arities.is_empty() { &vec![3; corners.len() / 3] } else { &model.mesh.face_arities };
        let mut rest = &corners[..];
        for &n in sides {
            let (face, after) = rest.split_at(n as usize);
            faces.push((model.name.clone(), face.to_vec()));
            rest = after;
        }
    }
    let place = |k: &u32| mesh.points[*k as usize].to_array();
    let name = |tag: u32| mesh.group_name(2, tag).unwrap().replace(' ', "_");
    let triangles =
        mesh.triangles.iter().zip(&mesh.triangle_tags).map(|(t, &tag)| (name(tag), t.iter().map(place).collect()));
    let quads = mesh.quads.iter().zip(&mesh.quad_tags).map(|(q, &tag)| (name(tag), q.iter().map(place).collect()));
    assert_eq!(faces, triangles.chain(quads).collect::<Vec<(String, Vec<[f64; 3]>)>>());
}

#[test]
fn groups_of_obj_are_regions_and_come_back() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no all\ng left side\nf 1 2 3\ng right\nf 1 3 4\ng left\nf 1 2 4\n";
    let mesh = read_bytes("a.obj", text.as_bytes(), Format::Obj).unwrap();
    assert_eq!(mesh.triangle_tags, [1, 2, 1]);
    assert_eq!([1, 2].map(|tag| mesh.group_name(2, tag)), [Some("left"), Some("right")]);
    assert_eq!(read_bytes("a.obj", &bytes_of(Format::Obj, &mesh, TEXT), Format::Obj).unwrap(), mesh);
}

#[test]
fn sparse_numbers_volumes_points_and_unknown_sections_are_taken() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\nany $thing\n$EndComments\n$Nodes\n4\n900 0 0 1\n7 0 0 0\n\
                8 1 0 0\n20 0 1 0\n$EndNodes\n$Elements\n3\n5 15 2 0 1 7\n6 4 2 0 1 7 8 20 900\n9 2 0 7 8 20\n$EndElements\n\
                $Periodic\n0\n$EndPeriodic\n";
    let mesh = read_bytes("a.msh", text.as_bytes(), Format::Msh).unwrap();
    assert_eq!((mesh.points[3].z, mesh.triangles[0]), (1.0, [0, 1, 2]));
    assert_eq!(mesh.skipped, [("tetrahedron".to_string(), 1)]);
    let text = "MeshVersionFormatted 2\nDimension 3\n# remark\nRidges\n2\n1 2\nTriangles 1\n1 2 3 5\nVertices\n3\n0 0 0 0\n1 0 0 \
                0\n0 1 0 0\nTetrahedra\n1\n1 2 3 1 0\nCorners 1 1\nEnd\n";
    let mesh = read_bytes("a.mesh", text.as_bytes(), Format::Medit).unwrap();
    assert_eq!((mesh.points.len(), mesh.triangles, mesh.triangle_tags), (3, vec![[0, 1, 2]], vec![5]));
    assert_eq!(mesh.skipped, [("tetrahedron".to_string(), 1)]);
}

#[test]
fn what_is_broken_is_refused_with_its_line_and_a_reason() {
    let two = |nodes: &str, elements: &str| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{nodes}\n$EndNodes\n$Elements\n{elements}\n$EndElements\n"
        )
    };
    let three = "3\n1 0 0 0\n2 1 0 0\n3 0 1 0";
    let sol = "MeshVersionFormatted 2\nDimension 2\nVertices 1\n";
    let nodes = "*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n";
    let cases = [
        (Format::Msh, String::new(), "a: The file is empty"),
        (Format::Msh, " \n\n".into(), "a: The file is empty"),
        (
            Format::Msh,
            "$MeshFormat\n4.0 0 8\n".into(),
            "a, line 2: MSH version 4.0 is not read. Save it as MSH 4.1 or 2.2.",
        ),
        (Format::Msh, "$NOD\n1\n".into(), "line 1: The section \"$NOD\" stands before $MeshFormat"),
        (Format::Msh, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n".into(), "There is no section $Nodes"),
        (
            Format::Msh,
            two("99999999999\n1 0 0 0", "0"),
            "line 5: 99999999999 as a number of nodes is more than the file",
        ),
        (Format::Msh, two("2\n1 0 0 0", "0"), "line 7: \"$EndNodes\" stands where the number of a node is expected"),
        (Format::Msh, two("1\n1 0 0 0\n2 0 0 0", "0"), "line 7: \"2\" stands where $EndNodes is expected. The counts"),
        (Format::Msh, two("2\n1 0 0 0\n2 0 nan 0", "0"), "line 7: NaN stands where a coordinate is expected"),
        (Format::Msh, two("2\n1 0 0 0\n1 0 1 0", "0"), "Node 1 comes twice"),
        (Format::Msh, two(three, "1\n1 2 2 0 1 1 2 4"), "line 12: An element has the node 4, which does not exist"),
        (
            Format::Msh,
            two(three, "1\n1 9 2 0 1 1 2 3 1 2 3"),
            "line 12: Elements of higher order (type 9) are not read",
        ),
        (Format::Msh, two(three, "1\n1 777 2 0 1 1 2 3"), "line 12: Element type 777 is not known"),
        (Format::Medit, "Vertices\n".into(), "does not begin with MeshVersionFormatted"),
        (Format::Medit, format!("{sol}0 x 0\n"), "line 4: \"x\" stands where a coordinate is expected"),
        (
            Format::Medit,
            format!("{sol}0 0 0\nTriangles 1\n1 1 2 0\n"),
            "line 6: An element has the vertex 2, and there are 1",
        ),
        (Format::Medit, format!("{sol}0 0 0\nEdges 1\n0 1 0\n"), "An element has the vertex 0"),
        (Format::Medit, format!("{sol}0 0 0\nTrianglesP2 1\n"), "Elements of higher order (TrianglesP2)"),
        (Format::Medit, format!("{sol}0 0 0\nEdges 1000000\n1 1 0\n"), "1000000 as a number of elements is more than"),
        (Format::Obj, "v 0 0\n".into(), "a, line 1: \"\" stands where a coordinate is expected"),
        (Format::Obj, "v 0 0 0\n\nf 1 1 2\nf 1 1 1\n".into(), "a, line 3: A face has the vertex 2, and there are 1"),
        (Format::Obj, "v 0 0 0\nf 1 1 -2\n".into(), "line 2: \"-2\" stands where a vertex of the face is expected"),
        (Format::Obj, "v 0 0 inf\n".into(), "line 1: \"inf\" stands where a coordinate"),
        (
            Format::Inp,
            format!("{nodes}*ELEMENT, TYPE=S4\n1, 1, 2, 3\n"),
            "line 6: \"\" stands where a node of the element",
        ),
        (Format::Inp, format!("{nodes}*ELEMENT, TYPE=S8R\n"), "line 5: Elements of type S8R are not read"),
        (Format::Inp, format!("{nodes}2, 1, 1\n*Element, type=S3\n"), "Node 2 comes twice"),
        (Format::Inp, "hello\n".into(), "There is no keyword line"),
        (Format::Vtu, "<a>".into(), "This is no VTK file"),
        (Format::Vtu, "<VTKFile type=\"PolyData\">".into(), "This is no uncompressed UnstructuredGrid"),
    ];
    for (format, text, told) in cases {
        let fault = read_bytes("a", text.as_bytes(), format).expect_err(&text).to_string();
        assert!(fault.contains(told), "{fault}\n  instead of {told}\n  for {text:?}");
    }
}

#[test]
fn a_metric_that_is_none_is_refused_by_its_vertex() {
    let told = |text: &str| medit::read_metric("a.sol", text.as_bytes(), 2).unwrap_err().to_string();
    let head = "MeshVersionFormatted 2\nDimension 2\nSolAtVertices\n";
    let fault = told(&format!("{head}2\n1 3\n1 0 1\n1 2 1\n"));
    assert_eq!(
        fault,
        "a.sol, line 7: The metric of vertex 2 is not positive definite. Its eigenvalues must be positive."
    );
    assert!(told(&format!("{head}2\n1 1\n1\n-3\n")).contains("line 7: The size of vertex 2 is -3, not positive"));
    assert!(told(&format!("{head}2\n1 1\n1\n1e-200\n")).contains("vertex 2 is not positive definite"));
    assert!(told(&format!("{head}3\n1 1\n1\n3\n1\n")).contains("has 3 values, and the mesh 2 vertices"));
    assert!(told(&format!("{head}2\n1 2\n1 1\n")).contains("no metric"));
    assert!(told(&format!("{head}2\n1 3\n1 0 1\n")).contains("more than the file can hold"));
    assert!(told("MeshVersionFormatted 2\nDimension 2\nEnd\n").contains("no section SolAtVertices"));
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

#[test]
fn a_folder_for_a_mesh_and_a_sol_of_another_mesh_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mesh");
    fs::create_dir(&path).unwrap();
    assert!(read_mesh(&path, None).unwrap_err().to_string().contains("a.mesh: This is a folder"));
    assert!(write_mesh(&path, Format::Medit, &plates(), TEXT).unwrap_err().what.contains("This is a folder"));
    let path = folder.path().join("b.mesh");
    write_mesh(&path, Format::Medit, &plates(), TEXT).unwrap();
    fs::write(path.with_extension("sol"), "MeshVersionFormatted 2\nDimension 2\nSolAtVertices 1 1 1 .5").unwrap();
    let told = read_mesh(&path, None).unwrap_err().to_string();
    assert!(told.contains("b.sol, line 3: The metric has 1 values, and the mesh 6 vertices"), "{told}");
}

#[test]
fn formats_are_known_by_their_extension_and_others_are_refused_with_the_list() {
    assert_eq!(Format::from_path(Path::new("x/A.MSH")), Ok(Format::Msh));
    let told = |name: &str| Format::from_path(Path::new(name)).unwrap_err().to_string();
    assert_eq!(
        told("a.xyz"),
        "a.xyz: The format \".xyz\" is not known. Known are .msh, .mesh, .vtu, .obj, .inp, .ply, .stl, .gltf, .glb."
    );
    assert!(told("a").contains("no extension"));
    assert!(told("a.meshb").contains("Use its text form, .mesh"));
}

#[test]
fn what_another_program_writes_as_stl_ply_and_gltf_is_the_same_plate() {
    for (name, plates) in [
        ("plate_binary.stl", 1),
        ("plate_text.stl", 1),
        ("plate_binary.ply", 1),
        ("plate_text.ply", 1),
        ("plates.glb", 2),
        ("plates.gltf", 2),
    ] {
        let mesh = read_mesh(&data(name), None).unwrap();
        // Two plates of 2 by 1 side by side, joined where they touch.
        assert_eq!((mesh.points.len(), mesh.triangles.len()), (6 + 4 * (plates - 1), 4 * plates), "{name}");
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| mesh.points[k as usize]);
            0.5 * (b - a).cross(c - a).z
        };
        assert_eq!(mesh.triangles.iter().map(area).sum::<f64>(), 2.0 * plates as f64, "{name}");
        if plates == 2 {
            assert_eq!(mesh.group_name(2, 2), Some("right"));
        }
    }
}

#[test]
fn ply_reads_back_points_elements_and_tags() {
    let mesh = read_bytes("a", &bytes_of(Format::Ply, &plates(), TEXT), Format::Ply).unwrap();
    let plates = plates();
    assert_eq!((&mesh.points, &mesh.triangles, &mesh.quads), (&plates.points, &plates.triangles, &plates.quads));
    assert_eq!((&mesh.triangle_tags, &mesh.quad_tags), (&plates.triangle_tags, &plates.quad_tags));
}

#[test]
fn stl_is_read_whatever_its_solids_are_called_and_however_its_binary_form_begins() {
    let facet = "facet normal 0 0 nan outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet";
    let text = format!("solid\n{facet}\nendsolid\nSOLID second part\n{facet}\nendsolid second part");
    let mesh = read_bytes("a.stl", text.as_bytes(), Format::Stl).unwrap();
    assert_eq!((mesh.points.len(), mesh.triangles.len()), (3, 2));
    assert_eq!((mesh.triangle_tags.as_slice(), mesh.group_name(2, 2)), (&[1, 2][..], Some("second part")));
    let mut binary = fs::read(data("plate_binary.stl")).unwrap();
    binary[..6].copy_from_slice(b"solid ");
    assert_eq!(read_bytes("a.stl", &binary, Format::Stl).unwrap().triangles.len(), 4);
    binary.pop();
    assert!(read_bytes("a.stl", &binary, Format::Stl).is_err());
}

#[test]
fn ply_that_announces_what_it_cannot_hold_is_refused() {
    for header in [
        "element vertex 18446744073709551615\nproperty float x\nproperty float y\nproperty float z",
        "element vertex 4000000000\nproperty float x\nproperty float y\nproperty float z",
        "element nothing 1000000000000",
        "element vertex 1\nproperty float x",
    ] {
        for encoding in ["ascii", "binary_little_endian", "binary_big_endian"] {
            let text = format!("ply\nformat {encoding} 1.0\n{header}\nend_header\n0 0 0\n");
            assert!(read_bytes("a.ply", text.as_bytes(), Format::Ply).is_err(), "{text}");
        }
    }
    let told = |text: &str| read_bytes("a.ply", text.as_bytes(), Format::Ply).unwrap_err().to_string();
    let head =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    assert!(
        told(&format!("{head}0 0 0\n1 one 0\n")).starts_with("a.ply, line 9: "),
        "{}",
        told(&format!("{head}0 0 0\n1 one 0\n"))
    );
}

#[test]
fn truncated_files_are_refused_or_lack_only_their_end() {
    for (format, bytes) in samples() {
        let whole = read_bytes("a", &bytes, format).unwrap();
        for cut in 0..bytes.len() {
            if let Ok(mesh) = read_bytes("a", &bytes[..cut], format) {
                // Formats without counts cannot know that something is missing.
                let same = mesh.points.len() <= whole.points.len() && mesh.quads.len() <= whole.quads.len();
                assert!(same, "{format:?} cut at {cut}");
            }
        }
    }
}

/// A file of every kind that a reader knows.
fn samples() -> Vec<(Format, Vec<u8>)> {
    let mut samples: Vec<_> = Format::written().map(|format| (format, bytes_of(format, &plates(), TEXT))).collect();
    samples.push((Format::Msh, bytes_of(Format::Msh, &plates(), MSH2)));
    for name in ["plates_41a.msh", "plates_41b.msh", "plates_22a.msh", "plates_22b.msh"] {
        samples.push((Format::Msh, fs::read(data(name)).unwrap()));
    }
    for (format, names) in [
        (Format::Ply, &["plate_binary.ply", "plate_text.ply"][..]),
        (Format::Stl, &["plate_binary.stl", "plate_text.stl"]),
        (Format::Glb, &["plates.glb"]),
        (Format::Gltf, &["plates.gltf"]),
    ] {
        samples.extend(names.iter().map(|name| (format, fs::read(data(name)).unwrap())));
    }
    samples
}

struct XorShift(u64);

impl XorShift {
    fn below(&mut self, bound: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % bound.max(1) as u64) as usize
    }
}

/// Bytes changed, cut out, doubled, swapped for hostile numbers and words.
fn mutate(bytes: &mut Vec<u8>, random: &mut XorShift) {
    const HOSTILE: [&[u8]; 16] = [
        b"-1",
        b"0",
        b"4294967295",
        b"18446744073709551615",
        b"1e999",
        b"nan",
        b"\n",
        b" ",
        b"$Elements",
        b"\xff\xfe",
        b"1e-320",
        b"99999999",
        b"\"",
        b"<",
        b",",
        b"f",
    ];
    for _ in 0..=random.below(3) {
        if bytes.is_empty() {
            return;
        }
        let at = random.below(bytes.len());
        let longest = if random.below(4) == 0 { 40 } else { 2 };
        let to = (at + 1 + random.below(longest)).min(bytes.len());
        match random.below(6) {
            0 => bytes[at] = random.below(256) as u8,
            1 => bytes[at] ^= 1 << random.below(8),
            2 => drop(bytes.drain(at..to)),
            3 => {
                let part = bytes[at..to].to_vec();
                let place = random.below(bytes.len());
                bytes.splice(place..place, part);
            }
            4 => drop(bytes.splice(at..to.min(at + 4), HOSTILE[random.below(HOSTILE.len())].iter().copied())),
            _ => bytes.truncate(at),
        }
    }
}

/// `QUADFRONT_SOAK_ROUNDS` sets the number of rounds (`make soak`).
#[test]
fn no_mutation_of_a_file_makes_a_reader_panic_hang_or_break_its_promise() {
    let rounds = std::env::var("QUADFRONT_SOAK_ROUNDS").ok().and_then(|text| text.parse().ok()).unwrap_or(400u64);
    let samples = samples();
    let mut read = 0u64;
    for round in 0..rounds {
        for (sample, (format, bytes)) in samples.iter().enumerate() {
            let mut random =
                XorShift(0x9e37_79b9_7f4a_7c15 ^ (round * 64 + sample as u64 + 1).wrapping_mul(0xd134_2543_de82_ef95));
            random.below(1);
            let mut bytes = bytes.clone();
            mutate(&mut bytes, &mut random);
            let begin = Instant::now();
            if let Ok(mesh) = read_bytes("a", &bytes, *format) {
                read += 1;
                keeps_its_promise(&mesh);
                examine(&mesh);
                keeps_its_promise(&mesh.clone().triangulated().0);
                let _ = medit::read_metric("a", &bytes, mesh.points.len());
            }
            assert!(begin.elapsed() < Duration::from_secs(2), "round {round} of sample {sample} ({format:?}) is slow");
        }
    }
    let sol = b"MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n2\n1 3\n1 0 1 0 0 1\n2 0 2 0 0 2\nEnd\n";
    for round in 0..rounds {
        let mut bytes = sol.to_vec();
        mutate(&mut bytes, &mut XorShift(round + 1));
        read += u64::from(medit::read_metric("a", &bytes, 2).is_ok());
    }
    assert!(read > rounds, "mutations are too wild to test what comes behind the header: {read}");
}

/// What `MeshFile` says of itself.
fn keeps_its_promise(mesh: &MeshFile) {
    let count = mesh.points.len() as u32;
    assert!(mesh.points.iter().all(|p| p.is_finite()));
    assert!(mesh.lines.iter().flatten().all(|&node| node < count));
    assert!(mesh.triangles.iter().flatten().all(|&node| node < count));
    assert!(mesh.quads.iter().flatten().all(|&node| node < count));
    assert!(mesh.polygons.iter().all(|polygon| polygon.len() > 4 && polygon.iter().all(|&node| node < count)));
    let elements = mesh.triangles.len() + mesh.quads.len();
    let tags = [
        (&mesh.line_tags, mesh.lines.len()),
        (&mesh.triangle_tags, mesh.triangles.len()),
        (&mesh.quad_tags, mesh.quads.len()),
        (&mesh.polygon_tags, mesh.polygons.len()),
    ];
    assert!(tags.iter().all(|(tags, count)| tags.is_empty() || tags.len() == *count));
    assert!(mesh.point_data.iter().all(|data| data.values.len() == mesh.points.len()));
    assert!(mesh.element_data.iter().all(|data| data.values.len() == elements));
    assert!(mesh.metric.as_ref().is_none_or(|metric| metric.len() == mesh.points.len()));
}
