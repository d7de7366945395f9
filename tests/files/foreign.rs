//! What other programs write, in all the forms that formats allow.

use std::fs;

use glam::DVec3;
use quadfront::core::formats::Format;
use quadfront::core::formats::format::{read_bytes, read_mesh};
use quadfront::core::soup::Allow;
use quadfront::core::soup::soundness::examine;

use super::data;

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
fn lines_of_obj_are_taken_in_every_form_with_their_groups() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2\ng rail left\nf 1 2 3\nl 1 2/2 -1\ng other\nl 3/1 1/2\n";
    let mesh = read_bytes("a.obj", text.as_bytes(), Format::Obj).unwrap();
    assert_eq!((mesh.lines, mesh.line_tags), (vec![[0, 1], [0, 1], [1, 2], [2, 0]], vec![0, 1, 1, 2]));
    let names: Vec<_> = mesh.groups.iter().map(|group| (group.dimension, group.tag, group.name.as_str())).collect();
    assert_eq!(names, [(1, 1, "rail"), (1, 2, "other"), (2, 1, "rail")]);
    let told = |text: &str| read_bytes("a.obj", text.as_bytes(), Format::Obj).unwrap_err().to_string();
    assert!(told("v 0 0 0\nl 1 2\n").contains("line 2: A face or line refers to vertex 2"));
    assert!(told("v 0 0 0\nl 1 x\n").contains("Expected a vertex of the line, found \"x\""));
}

/// Sets and surfaces as Abaqus's users write them.
pub const SETS: &str = "*Node\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, 2, 0\n*Element, type=S3, elset=EALL\n10, 1, 2, 3\n11, 1, 3, 4\n\
                        *ELEMENT, TYPE=S3, ELSET=eall\n14, 2, 5, 3\n*Elset, elset=\"left part\", generate\n10, 13, 1\n\
                        *ELSET, ELSET=NOBODY\n99, EALL\n*ELSET, ELSET=ODD, GENERATE\n11, 9999999999, 2\n\
                        *SURFACE, NAME=Floor\n10, E1\n14, E1\nEALL, SPOS\n*SURFACE, TYPE=NODE, NAME=N\n1, 1.0\n";

#[test]
fn sets_of_elements_are_regions_and_surfaces_of_edges_are_lines() {
    let mesh = read_bytes("a.inp", SETS.as_bytes(), Format::Inp).unwrap();
    let names: Vec<_> = mesh.groups.iter().map(|group| (group.dimension, group.name.as_str())).collect();
    // An element is in the smallest of its sets; a set without elements of its own is none.
    assert_eq!(names, [(1, "Floor"), (2, "EALL"), (2, "left part"), (2, "ODD")]);
    let of = |tag: &u32| mesh.group_name(2, *tag).unwrap();
    assert_eq!(mesh.triangle_tags.iter().map(of).collect::<Vec<_>>(), ["left part", "ODD", "EALL"]);
    assert_eq!((mesh.lines.as_slice(), mesh.line_tags.as_slice()), (&[[0, 1], [1, 4]][..], &[1, 1][..]));
}
