//! What is broken is refused with its place and a remedy.

use std::fs;
use std::path::Path;

use quadfront::core::formats::format::{read_bytes, read_mesh, write_mesh};
use quadfront::core::formats::{Format, medit};

use super::{TEXT, plates};

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
            "a, line 2: MSH version 4.0 is not supported. Save it as MSH 4.1 or 2.2.",
        ),
        (Format::Msh, "$NOD\n1\n".into(), "line 1: The section \"$NOD\" precedes $MeshFormat"),
        (Format::Msh, "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n".into(), "There is no section $Nodes"),
        (
            Format::Msh,
            two("99999999999\n1 0 0 0", "0"),
            "line 5: 99999999999 as a number of nodes is more than the file",
        ),
        (Format::Msh, two("2\n1 0 0 0", "0"), "line 7: Expected the number of a node, found \"$EndNodes\""),
        (Format::Msh, two("1\n1 0 0 0\n2 0 0 0", "0"), "line 7: Expected $EndNodes, found \"2\". The counts"),
        (Format::Msh, two("2\n1 0 0 0\n2 0 nan 0", "0"), "line 7: Expected a coordinate, found NaN"),
        (Format::Msh, two("2\n1 0 0 0\n1 0 1 0", "0"), "node number 1 is used twice"),
        (Format::Msh, two(three, "1\n1 2 2 0 1 1 2 4"), "line 12: An element refers to node 4, which does not exist"),
        (Format::Msh, two(three, "1\n1 9 2 0 1 1 2 3 1 2"), "line 13: Expected the number of a node"),
        (Format::Msh, two(three, "1\n1 777 2 0 1 1 2 3"), "line 12: Unknown element type 777"),
        (Format::Medit, "Vertices\n".into(), "does not begin with MeshVersionFormatted"),
        (Format::Medit, format!("{sol}0 x 0\n"), "line 4: Expected a coordinate, found \"x\""),
        (Format::Medit, format!("{sol}0 0 0\nTriangles 1\n1 1 2 0\n"), "line 6: An element refers to vertex 2 of 1"),
        (Format::Medit, format!("{sol}0 0 0\nEdges 1\n0 1 0\n"), "An element refers to vertex 0"),
        (Format::Medit, format!("{sol}0 0 0\nTrianglesP2 1\n1 1 1 1 1\n"), "Expected a vertex"),
        (Format::Medit, format!("{sol}0 0 0\nEdges 1000000\n1 1 0\n"), "1000000 as a number of elements is more than"),
        (Format::Obj, "v 0 0\n".into(), "a, line 1: Expected a coordinate, found \"\""),
        (Format::Obj, "v 0 0 0\n\nf 1 1 2\nf 1 1 1\n".into(), "a, line 3: A face or line refers to vertex 2 of 1"),
        (Format::Obj, "v 0 0 0\nf 1 1 -2\n".into(), "line 2: A face or line refers to vertex -2 of 1"),
        (Format::Obj, "v 0 0 inf\n".into(), "line 1: Expected a coordinate"),
        (Format::Inp, format!("{nodes}*ELEMENT, TYPE=S4\n1, 1, 2, 3\n"), "line 6: Expected a node of the element"),
        (Format::Inp, format!("{nodes}2, 1, 1\n*Element, type=S3\n"), "node number 2 is used twice"),
        (Format::Inp, "hello\n".into(), "There is no keyword line"),
        (Format::Vtu, "<a>".into(), "This is not a VTK file"),
        (Format::Vtu, "<VTKFile type=\"PolyData\">".into(), "This is not an uncompressed UnstructuredGrid"),
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
    assert!(told(&format!("{head}3\n1 1\n1\n3\n1\n")).contains("has 3 values, but the mesh has 2 vertices"));
    assert!(told(&format!("{head}2\n1 2\n1 1\n")).contains("do not form a metric"));
    assert!(told(&format!("{head}2\n1 3\n1 0 1\n")).contains("more than the file can hold"));
    assert!(told("MeshVersionFormatted 2\nDimension 2\nEnd\n").contains("no section SolAtVertices"));
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
    assert!(told.contains("b.sol, line 3: The metric has 1 values, but the mesh has 6 vertices"), "{told}");
}

#[test]
fn formats_are_known_by_their_extension_and_others_are_refused_with_the_list() {
    assert_eq!(Format::from_path(Path::new("x/A.MSH")), Ok(Format::Msh));
    let told = |name: &str| Format::from_path(Path::new(name)).unwrap_err().to_string();
    assert_eq!(
        told("a.xyz"),
        "a.xyz: Unknown format \".xyz\". Use one of .msh, .mesh, .vtu, .obj, .inp, .ply, .stl, .gltf, .glb."
    );
    assert!(told("a").contains("no extension"));
    assert!(told("a.meshb").contains("Use the text format, .mesh"));
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
