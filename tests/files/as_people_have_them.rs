//! Files as other programs and people leave them: any line ends, blank lines, comments, statements over several lines,
//! bytes after the end; and what of them is not read is told.

use std::fmt::Write;
use std::fs;

use glam::{DVec2, DVec3};
use quadfront::core::formats::format::{read_bytes, read_mesh};
use quadfront::core::formats::{Format, medit};
use quadfront::core::soup::{Group, MeshFile};

use super::xor_shift::XorShift;
use super::{MSH2, TEXT, bytes_of, data, plates};

fn read(name: &str) -> MeshFile {
    read_mesh(&data(name), None).unwrap_or_else(|fault| panic!("{fault}"))
}

fn told(format: Format, text: &str) -> Vec<String> {
    read_bytes("a", text.as_bytes(), format).unwrap_or_else(|fault| panic!("{fault}")).not_read()
}

/// The points of the triangles, corner by corner.
fn places(mesh: &MeshFile) -> Vec<[f64; 3]> {
    mesh.triangles.as_flattened().iter().map(|&k| mesh.points[k as usize].to_array()).collect()
}

/// The same triangles in the same order, to the precision of a file.
fn same_places(name: &str, mesh: &MeshFile, whole: &MeshFile) {
    let near = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).all(|axis| (a[axis] - b[axis]).abs() < 1e-6);
    let (found, expected) = (places(mesh), places(whole));
    assert_eq!(found.len(), expected.len(), "{name}");
    assert!(found.iter().zip(&expected).all(near), "{name}");
}

#[test]
fn o_cr_o_cont_o_comment_p_cr_p_blankline_and_f_trailing_are_one_mesh() {
    let text = fs::read_to_string(data("o_cr.obj")).unwrap();
    assert!(!text.contains('\n') && text.contains('\r'));
    let whole = read_bytes("a", text.replace('\r', "\n").as_bytes(), Format::Obj).unwrap();
    assert_eq!((whole.points.len(), whole.triangles.len()), (169, 288));
    for (name, not_read) in [
        ("o_cr.obj", None),
        ("o_cont.obj", None),
        ("o_comment.obj", None),
        ("p_cr.ply", None),
        ("p_blankline.ply", Some("not read: vertex property nx, ny and nz")),
        ("f_trailing.stl", Some("not read: 37 bytes after the last triangle")),
    ] {
        let mesh = read(name);
        same_places(name, &mesh, &whole);
        assert_eq!(mesh.not_read(), not_read.into_iter().collect::<Vec<_>>(), "{name}");
        if name.starts_with('o') {
            assert_eq!(mesh, whole, "{name}");
        }
    }
}

#[test]
fn s_cr_an_stl_with_lines_that_end_with_cr_is_read() {
    let whole = read("o_cr.obj");
    let mut text = String::from("solid x\n");
    for corners in places(&whole).as_chunks::<3>().0 {
        text += "facet normal 0 0 1\nouter loop\n";
        corners.iter().for_each(|[x, y, z]| writeln!(text, "vertex {x:e} {y:e} {z:e}").unwrap());
        text += "endloop\nendfacet\n";
    }
    text += "endsolid x\n";
    let mesh = read_bytes("s_cr.stl", text.replace('\n', "\r").as_bytes(), Format::Stl).unwrap();
    same_places("s_cr.stl", &mesh, &whole);
    assert_eq!((mesh.points.len(), mesh.group_name(2, 1)), (169, Some("x")));
}

#[test]
fn i_cont_keywords_and_elements_of_abaqus_go_on_in_the_next_line() {
    let text = fs::read_to_string(data("i_cont.inp")).unwrap();
    let joined = text.replace(",\n ", ", ").replace(",\nELSET", ", ELSET");
    assert!(text.contains("TYPE=CPE3,\n") && joined.lines().all(|line| !line.ends_with(',')));
    let (mesh, whole) = (read("i_cont.inp"), read_bytes("a", joined.as_bytes(), Format::Inp).unwrap());
    assert!(mesh.triangles.len() > 100);
    assert_eq!(mesh, whole);
}

/// Text files of every format, with how a comment stands on a line of its own.
fn texts() -> Vec<(Format, String, Option<&'static str>)> {
    let comment = |format| match format {
        Format::Obj | Format::Medit => Some("# remark"),
        Format::Inp => Some("** remark"),
        Format::Vtu => Some("<!-- <remark> 1 -->"),
        _ => None,
    };
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let mut texts: Vec<_> =
        Format::written().map(|format| (format, text(bytes_of(format, &plates(), TEXT)), comment(format))).collect();
    texts.push((Format::Msh, text(bytes_of(Format::Msh, &plates(), MSH2)), None));
    for (format, name) in
        [(Format::Stl, "plate_text.stl"), (Format::Gltf, "plates.gltf"), (Format::Msh, "plates_22a.msh")]
    {
        texts.push((format, fs::read_to_string(data(name)).unwrap().replace("\r\n", "\n"), None));
    }
    texts
}

#[test]
fn line_ends_blank_lines_and_comments_change_nothing_in_any_format() {
    for (format, text, comment) in texts() {
        let whole = read_bytes("a", text.as_bytes(), format).unwrap();
        let holds = |what: &str, text: &str| {
            let mesh = read_bytes("a", text.as_bytes(), format).unwrap_or_else(|fault| panic!("{what}: {fault}"));
            assert_eq!(mesh, whole, "{format:?}, {what}");
        };
        holds("CR LF", &text.replace('\n', "\r\n"));
        holds("CR", &text.replace('\n', "\r"));
        holds("blank lines", &text.replace('\n', "\n\n"));
        holds("blank lines of CR", &text.replace('\n', "\r \r"));
        holds("blanks at the ends of lines", &text.replace('\n', " \t\n"));
        holds("blank lines at the end", &format!("{text}\n \n\n"));
        holds("no line end at the end", text.trim_end());
        if let Some(comment) = comment {
            holds("comments", &text.replace('\n', &format!("\n{comment}\n")));
        }
    }
    let sol = "MeshVersionFormatted 2\nDimension 2\nSolAtVertices\n2\n1 3\n1 0 1\n2 0 2\nEnd\n";
    let whole = medit::read_metric("a", sol.as_bytes(), 2).unwrap();
    for text in [sol.replace('\n', "\r"), sol.replace('\n', "\r\n"), sol.replace('\n', "\n# remark\n\n")] {
        assert_eq!(medit::read_metric("a", text.as_bytes(), 2).unwrap(), whole, "{text:?}");
    }
}

#[test]
fn the_place_of_a_fault_is_its_line_whatever_ends_the_lines() {
    for end in ["\n", "\r\n", "\r"] {
        for (format, lines, line) in [
            (Format::Obj, &["v 0 0 0", "v 1 0 \\", " 0", "# f x", "f 1 2 x"][..], 5),
            (Format::Medit, &["MeshVersionFormatted 2", "Dimension 2", "Vertices 1", "0 0 x"], 4),
            (Format::Inp, &["*NODE", "1, 0, 0", "", "2, x, 0"], 4),
            (Format::Stl, &["solid", "facet normal 0 0 1", "outer loop", "vertex 0 0 x"], 4),
            (Format::Ply, &[PLY_HEAD, "0 0 0", "1 one 0"], 9),
            (Format::Msh, &["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", "1", "1 0 x 0"], 6),
            (
                Format::Vtu,
                &["<VTKFile type=\"UnstructuredGrid\">", "<Points>", "<DataArray format=\"ascii\">", "0 x"],
                4,
            ),
        ] {
            let text = lines.join("\n").replace('\n', end);
            let fault = read_bytes("a", text.as_bytes(), format).unwrap_err();
            assert_eq!(fault.place, format!("a, line {line}"), "{end:?}: {fault}");
        }
    }
    let fault = read_bytes("a", b"{\n\"asset\": {\"version\": \"2.0\"},\nx", Format::Gltf).unwrap_err();
    assert_eq!(fault.place, "a, line 3 of the JSON, column 1");
}

const PLY_HEAD: &str =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header";

#[test]
fn what_is_cut_off_or_goes_on_is_said_in_words() {
    let mut files: Vec<(Format, Vec<u8>)> =
        texts().into_iter().map(|(format, text, _)| (format, text.into_bytes())).collect();
    for name in ["plate_binary.ply", "plate_binary.stl", "plates.glb", "plates_41b.msh", "plates_22b.msh"] {
        files.push((Format::from_path(&data(name)).unwrap(), fs::read(data(name)).unwrap()));
    }
    for (format, bytes) in &files {
        let whole = read_bytes("a", bytes, *format).unwrap();
        for tenth in 1..10 {
            let part = &bytes[..bytes.len() * tenth / 10];
            match read_bytes("a", part, *format) {
                // Formats without counts cannot know that something is missing.
                Ok(mesh) => assert!(mesh.points.len() <= whole.points.len(), "{format:?}"),
                Err(fault) => in_words(&fault.to_string()),
            }
        }
        // A header that lies, in each place.
        for at in (0..bytes.len().min(600)).step_by(3) {
            let mut changed = bytes.clone();
            changed[at] = b'~';
            if let Err(fault) = read_bytes("a", &changed, *format) {
                in_words(&fault.to_string());
            }
        }
    }
    for (name, told) in
        [("plate_binary.stl", "after the last triangle"), ("plate_binary.ply", "after the last element")]
    {
        let mut bytes = fs::read(data(name)).unwrap();
        let whole = read(name);
        bytes.extend([0; 7]);
        let mesh = read_bytes("a", &bytes, Format::from_path(&data(name)).unwrap()).unwrap();
        assert_eq!((&mesh.points, &mesh.triangles), (&whole.points, &whole.triangles));
        assert_eq!(mesh.not_read().last(), Some(&format!("not read: 7 bytes {told}")));
    }
}

/// No parser's own words, and one line.
fn in_words(told: &str) {
    let foreign = ["Error", "location", "Couldn't", "Custom", "at line", "offset:", "{", "\\", "\n", "\t", "Invalid"];
    assert!(told.starts_with("a") && told.ends_with('.'), "{told}");
    assert!(!foreign.iter().any(|word| told.contains(word)), "{told}");
}

#[test]
fn triangle_strips_of_ply_keep_their_sense() {
    let points = "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n";
    let head = |encoding: &str| {
        format!(
            "ply\nformat {encoding} 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
             element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
        )
    };
    // A strip, another one behind a separator, and a turn by a point twice.
    let strips = [4, 2, 5, 3, -1, 2, 0, 3, 1, -1, 1, 1, 3];
    let expected = [[4, 2, 5], [5, 2, 3], [2, 0, 3], [3, 0, 1]];
    let words = strips.map(|k: i32| k.to_string()).join("\n");
    let mesh = read_bytes("a", format!("{}{points}13 {words}\n", head("ascii")).as_bytes(), Format::Ply).unwrap();
    assert_eq!(mesh.triangles, expected);
    assert!(mesh.not_read().is_empty(), "{:?}", mesh.not_read());
    let cross = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| mesh.points[k as usize]);
        (b - a).cross(c - a).z
    };
    assert!(mesh.triangles.iter().all(|t| cross(t) < 0.0));
    let mut binary = head("binary_little_endian").into_bytes();
    points.split_whitespace().for_each(|x| binary.extend(x.parse::<f32>().unwrap().to_le_bytes()));
    [13].iter().chain(&strips).for_each(|k: &i32| binary.extend(k.to_le_bytes()));
    assert_eq!(read_bytes("a", &binary, Format::Ply).unwrap().triangles, expected);
}

#[test]
fn a_binary_ply_whose_header_ends_with_cr_alone_keeps_its_first_byte() {
    let mut bytes = fs::read(data("plate_binary.ply")).unwrap();
    let end = bytes.windows(11).position(|part| part == b"end_header\n").unwrap() + 11;
    bytes[..end].iter_mut().filter(|b| **b == b'\n').for_each(|b| *b = b'\r');
    // The first byte of the first number is a line feed.
    bytes[end] = b'\n';
    let mesh = read_bytes("a", &bytes, Format::Ply).unwrap();
    assert_eq!((mesh.points[0].x as f32).to_le_bytes()[0], b'\n');
    assert_eq!(mesh.triangles, read("plate_binary.ply").triangles);
}

#[test]
fn elements_of_higher_order_are_read_by_their_corners_in_every_format() {
    // Two triangles and a quadrilateral of order 2 or 3 along a strip, a line, and their nodes in any order: corners
    // first, then what lies between them. The nodes are numbered by the format.
    let at = |x: f64, y: f64| DVec2::new(x, y);
    let corners = [at(0.0, 0.0), at(2.0, 0.0), at(2.0, 2.0), at(0.0, 2.0), at(4.0, 0.0), at(4.0, 2.0)];
    let elements: [&[usize]; 4] = [&[0, 1, 2], &[0, 2, 3], &[1, 4, 5, 2], &[0, 1]];
    // Nodes between the ends of each side, and inside: for triangles, quadrilaterals and lines.
    let orders: [(usize, [usize; 3]); 3] = [(1, [0, 0, 0]), (1, [0, 1, 0]), (2, [1, 4, 0])];
    for (order, (between, inside)) in orders.into_iter().enumerate() {
        let mut points = corners.to_vec();
        let mut nodes: Vec<Vec<usize>> = Vec::new();
        for element in elements {
            let closed = element.len() > 2;
            let mut of_element = element.to_vec();
            for k in 0..if closed { element.len() } else { 1 } {
                let (from, to) = (corners[element[k]], corners[element[(k + 1) % element.len()]]);
                for i in 1..=between {
                    let p = from.lerp(to, i as f64 / (between + 1) as f64);
                    // Neighbours share the nodes of their side.
                    let known = points.iter().position(|q| q.distance(p) < 1e-9);
                    of_element.push(known.unwrap_or(points.len()));
                    if known.is_none() {
                        points.push(p);
                    }
                }
            }
            let middle = element.iter().map(|&k| corners[k]).sum::<DVec2>() / element.len() as f64;
            for _ in 0..inside[if closed { element.len() - 3 } else { 2 }] {
                of_element.push(points.len());
                points.push(middle);
            }
            nodes.push(of_element);
        }
        let list = |element: &[usize], first: usize| {
            element.iter().map(|k| (k + first).to_string()).collect::<Vec<_>>().join(" ")
        };
        let is_quad = |k: &usize| *k == 2;
        // The types of lines, triangles and quadrilaterals.
        let msh = [[8, 9, 16], [8, 9, 10], [26, 21, 36]][order];
        let vtu = [[21, 22, 23], [21, 22, 28], [35, 69, 70]][order];
        let kind = |types: [i32; 3], k: usize| if k == 3 { types[0] } else { types[1 + usize::from(is_quad(&k))] };
        let mut texts = Vec::new();
        let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ParametricNodes\n".to_owned();
        writeln!(text, "{}", points.len()).unwrap();
        for (k, p) in points.iter().enumerate() {
            // On a vertex, a curve and a surface there are no, one and two parameters.
            writeln!(text, "{} {} {} 0 {} 1{}", k + 7, p.x, p.y, k % 3, " 0.5".repeat(k % 3)).unwrap();
        }
        text += "$EndParametricNodes\n$Elements\n4\n";
        for (k, element) in nodes.iter().enumerate() {
            writeln!(text, "{} {} 2 {} 1 {}", k + 1, kind(msh, k), 1 + k % 2, list(element, 7)).unwrap();
        }
        texts.push((Format::Msh, text + "$EndElements\n"));
        let mut text =
            format!("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 {n} 1 {n}\n2 1 0 {n}\n", n = points.len());
        (0..points.len()).for_each(|k| writeln!(text, "{}", k + 1).unwrap());
        points.iter().for_each(|p| writeln!(text, "{} {} 0", p.x, p.y).unwrap());
        text += "$EndNodes\n$Elements\n4 4 1 4\n";
        for (k, element) in nodes.iter().enumerate() {
            let dimension = if k == 3 { 1 } else { 2 };
            writeln!(text, "{dimension} 1 {} 1\n{} {}", kind(msh, k), k + 1, list(element, 1)).unwrap();
        }
        texts.push((Format::Msh, text + "$EndElements\n"));
        let array = |name: &str, kind: &str, values: String| {
            format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\">{values}</DataArray>")
        };
        let mut end = 0;
        let offsets: Vec<String> = nodes
            .iter()
            .map(|element| {
                end += element.len();
                end.to_string()
            })
            .collect();
        let coordinates: Vec<String> = points.iter().map(|p| format!("{} {} 0", p.x, p.y)).collect();
        let heat: Vec<String> = points.iter().map(|p| (10.0 * p.x).to_string()).collect();
        texts.push((
            Format::Vtu,
            format!(
                "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece><Points><DataArray type=\"Float64\" \
             NumberOfComponents=\"3\" format=\"ascii\">{}</DataArray></Points><PointData>{}</PointData><Cells>{}{}{}\
             </Cells></Piece></UnstructuredGrid></VTKFile>",
                coordinates.join(" "),
                array("heat", "Float64", heat.join(" ")),
                array(
                    "connectivity",
                    "Int64",
                    nodes.iter().map(|element| list(element, 0)).collect::<Vec<_>>().join(" ")
                ),
                array("offsets", "Int64", offsets.join(" ")),
                array("types", "UInt8", (0..4).map(|k| kind(vtu, k).to_string()).collect::<Vec<_>>().join(" ")),
            ),
        ));
        if order > 0 {
            let n = if order == 1 { 2 } else { 3 };
            let mut text = format!("MeshVersionFormatted 2\nDimension 2\nVertices\n{}\n", points.len());
            points.iter().for_each(|p| writeln!(text, "{} {} 0", p.x, p.y).unwrap());
            for (name, of) in
                [(format!("EdgesP{n}"), 3..4), (format!("TrianglesP{n}"), 0..2), (format!("QuadrilateralsQ{n}"), 2..3)]
            {
                writeln!(text, "{name}\n{}", of.len()).unwrap();
                of.for_each(|k| writeln!(text, "{} 5", list(&nodes[k], 1)).unwrap());
            }
            texts.push((Format::Medit, text + "End\n"));
        }
        for (format, text) in texts {
            let mesh = read_bytes("a", text.as_bytes(), format)
                .unwrap_or_else(|fault| panic!("{format:?} {order}: {fault}\n{text}"));
            assert_eq!(mesh.points.iter().map(|p| p.truncate()).collect::<Vec<_>>(), corners, "{format:?} {order}");
            assert_eq!((&mesh.lines[..], &mesh.triangles[..]), (&[[0, 1]][..], &[[0, 1, 2], [0, 2, 3]][..]));
            assert_eq!(mesh.quads, [[1, 4, 5, 2]]);
            let told = format!("not read: mid-side node of an element of higher order ({} times)", points.len() - 6);
            assert!(mesh.not_read().contains(&told), "{format:?} {order}: {:?}", mesh.not_read());
            for data in &mesh.point_data {
                assert_eq!(data.values, corners.map(|p| 10.0 * p.x), "{format:?} {order}");
            }
        }
    }
}

#[test]
fn elements_of_order_2_are_read_by_their_corners_and_their_other_nodes_are_told() {
    let nodes = "*NODE, NSET=ALL\n1, 0, 0\n2, 2, 0\n3, 2, 2\n4, 0, 2\n5, 4, 0\n6, 4, 2\n10, 1, 0\n11, 2, 1\n12, 1, 1\n\
                 13, 3, 0\n14, 4, 1\n15, 3, 2\n16, 0, 1\n17, 1, 2\n";
    for (triangle, quad) in [("CPE6", "CPE8"), ("CPS6M", "CPS8R"), ("STRI65", "S8R"), ("DC2D6", "M3D8")] {
        let text = format!(
            "{nodes}*ELEMENT, TYPE={triangle}, ELSET=LEFT\n1, 1, 2, 3, 10,\n 11, 12\n2, 1, 3, 4, 12, 17, 16\n\
             *ELEMENT, TYPE={quad}, ELSET=RIGHT\n3, 2, 5, 6, 3,\n13, 14, 15, 11\n*ELEMENT, TYPE=B32\n4, 1, 10, 2\n\
             *ELEMENT, TYPE=C3D10\n5, 1, 2, 3, 4, 5, 6,\n 10, 11, 12, 13\n6, 1, 2, 3, 4, 5, 6, 10, 11, 12, 13\n"
        );
        let mesh = read_bytes("a", text.as_bytes(), Format::Inp).unwrap();
        assert_eq!(
            (mesh.points.len(), &mesh.triangles[..], &mesh.quads[..]),
            (6, &[[0, 1, 2], [0, 2, 3]][..], &[[1, 4, 5, 2]][..])
        );
        assert_eq!(mesh.lines, [[0, 1]]);
        assert_eq!(
            (mesh.group_name(2, mesh.triangle_tags[0]), mesh.group_name(2, mesh.quad_tags[0])),
            (Some("LEFT"), Some("RIGHT"))
        );
        assert_eq!(
            mesh.not_read(),
            [
                "not read: element C3D10 (2 times)",
                "not read: node set ALL",
                "not read: mid-side node of an element of higher order (8 times)"
            ]
        );
    }
    // A node that is the middle of one element and a corner of another stays.
    let text = format!("{nodes}*ELEMENT, TYPE=S6\n1, 1, 2, 3, 10, 11, 12\n*ELEMENT, TYPE=S3\n2, 2, 5, 11\n");
    let mesh = read_bytes("a", text.as_bytes(), Format::Inp).unwrap();
    let corner = |t: usize, k: usize| mesh.points[mesh.triangles[t][k] as usize].to_array();
    assert_eq!((corner(1, 1), corner(1, 2)), ([4.0, 0.0, 0.0], [2.0, 1.0, 0.0]));
}

#[test]
fn what_a_file_has_besides_is_told_in_every_format() {
    let square = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\n";
    assert_eq!(
        told(
            Format::Obj,
            &format!(
                "mtllib a\n{square}vn 0 0 1\nvn 0 0 1\no lid\ng part one\nusemtl red\nf 1 2 3\ng none\ncurv 0 1 1 2\n"
            )
        ),
        [
            "not read: group without members: \"lid\" and \"none\"",
            "not read: further name of a group one",
            "not read: statement mtllib (material library), vn (normal) (2 times), usemtl (material) and curv (curve)",
            "not read: vertex colour (3 times)",
        ]
    );
    let nodes = "*HEADING\nany\n*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n*ELEMENT, TYPE=S3, ELSET=ALL\n1, 1, 2, 3\n";
    assert_eq!(
        told(
            Format::Inp,
            &format!(
                "{nodes}*NSET, NSET=RIM\n1, 2\n*SURFACE, NAME=RIM\n1, E1\n*NSET, NSET=PIN\n1\n*ELSET, ELSET=BARS\n7\n\
                 *SURFACE, TYPE=NODE, NAME=TOUCH\nPIN, 1.0\n*MATERIAL, NAME=STEEL\n*ELASTIC\n2e11, .3\n*STEP\n*END STEP\n\
                 *ELEMENT, TYPE=MASS\n8, 1\n"
            )
        ),
        [
            "not read: element MASS",
            "not read: surface TOUCH",
            "not read: keyword *MATERIAL, *ELASTIC and *STEP",
            "not read: set without triangles and quadrilaterals: BARS",
            "not read: node set PIN",
        ]
    );
    let msh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n0 4 \"pin\"\n2 1 \"plate\"\n3 9 \"solid\"\n\
               $EndPhysicalNames\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n1\n1 2 2 1 1 1 2 3\n\
               $EndElements\n$Periodic\n0\n$EndPeriodic\n$NodeData\n1\n\"heat\"\n1\n0\n3\n0\n1\n3\n1 1\n2 1\n3 1\n\
               $EndNodeData\n$NodeData\n1\n\"force\"\n1\n0\n3\n0\n3\n3\n1 1 0 0\n2 1 0 0\n3 1 0 0\n$EndNodeData\n";
    assert_eq!(
        told(Format::Msh, msh),
        [
            "not read: group of volumes \"solid\"",
            "not read: section $Periodic",
            "not read: point data force and heat",
            "not read: group without members: \"pin\"",
        ]
    );
    let medit = "MeshVersionFormatted 2\nDimension 2\nVertices 3\n0 0 0\n1 0 0\n0 1 0\nTriangles 1\n1 2 3 0\nCorners 1\n1\n\
                 Ridges 1\n1\nTetrahedra 1\n1 2 3 1 0\nEnd\n";
    assert_eq!(told(Format::Medit, medit), ["not read: tetrahedron", "not read: section Corners and Ridges"]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nproperty list uchar float uv\n\
               element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n\
               0 0 0 255\n1 0 0 255 9\n0 1 0 255\n3 0 1 2 2 .5 .5\n0 1\nmore\n";
    assert_eq!(
        told(Format::Ply, ply),
        [
            "not read: vertex property red",
            "not read: face property uv",
            "not read: element edge",
            "not read: values of no property, at the end of a line",
            "not read: lines after the last element",
        ]
    );
    let array = |name: &str, components: usize, values: &str| {
        format!(
            "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">{values}</DataArray>"
        )
    };
    let vtu = format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><FieldData>{}</FieldData>\
         <Piece NumberOfPoints=\"3\" NumberOfCells=\"2\"><Points>{}</Points><Cells>{}{}{}</Cells>\
         <PointData>{}{}</PointData><CellData>{}</CellData></Piece></UnstructuredGrid></VTKFile>",
        array("time", 1, "0"),
        array("Points", 3, "0 0 0 1 0 0 0 1 0"),
        array("connectivity", 1, "0 1 2 0"),
        array("offsets", 1, "3 4"),
        array("types", 1, "5 1"),
        array("heat", 1, "1 2 3"),
        array("flow", 3, "1 2 3 1 2 3 1 2 3"),
        array("load", 1, "4 5"),
    );
    assert_eq!(
        told(Format::Vtu, &vtu),
        [
            "not read: cell of points alone",
            "not read: point data flow and heat",
            "not read: field data time",
            "not read: cell data load",
        ]
    );
}

#[test]
fn an_entity_of_several_physical_groups_is_in_all_of_them() {
    // A face, a line and a point in two groups each.
    let text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n0 1 \"pin\"\n0 2 \"origin\"\n1 1 \"wall\"\n\
                1 2 \"south\"\n2 1 \"plate\"\n2 2 \"steel\"\n$EndPhysicalNames\n$Entities\n1 1 1 0\n1 0 0 0 2 1 2\n\
                1 0 0 0 1 0 0 2 1 2 0\n1 0 0 0 1 1 0 2 1 2 0\n$EndEntities\n$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n\
                1 0 0\n0 1 0\n$EndNodes\n$Elements\n3 3 1 3\n0 1 15 1\n1 1\n1 1 1 1\n2 1 2\n2 1 2 1\n3 1 2 3\n$EndElements\n";
    // In version 2 it is listed for each group.
    let names = &text[text.find("$PhysicalNames").unwrap()..text.find("$Entities").unwrap()];
    let two = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{names}$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n$Elements\n6\n\
         1 15 2 1 1 1\n2 15 2 2 1 1\n3 1 2 1 1 1 2\n4 1 2 2 1 1 2\n5 2 2 1 1 1 2 3\n6 2 2 2 1 1 2 3\n$EndElements\n"
    );
    for text in [text, &two] {
        let mesh = read_bytes("a", text.as_bytes(), Format::Msh).unwrap();
        assert!(mesh.not_read().is_empty(), "{:?}", mesh.not_read());
        assert_eq!((mesh.lines.len(), mesh.triangles.len()), (1, 1));
        let groups_of = |dimension: u8, first: Option<u32>| {
            let further = mesh.members.iter().filter(|m| m.dimension == dimension && m.of == [0]).map(|m| m.tag);
            let mut tags: Vec<u32> = first.into_iter().chain(further).collect();
            tags.sort_unstable();
            tags
        };
        assert_eq!(groups_of(0, None), [1, 2]);
        assert_eq!(groups_of(1, Some(mesh.line_tags[0])), [1, 2]);
        assert_eq!(groups_of(2, Some(mesh.triangle_tags[0])), [1, 2]);
    }
}

/// An OBJ file made statement by statement, with the mesh that it must give.
struct Obj {
    text: String,
    mesh: MeshFile,
    textures: usize,
    /// The texture coordinates of all faces' corners; none for faces without them.
    uv: Vec<Vec<u32>>,
    random: XorShift,
}

impl Obj {
    /// As many statements, in an order that no program would choose.
    fn random(seed: u64, statements: usize) -> Obj {
        let mut obj = Obj {
            text: String::new(),
            mesh: MeshFile::default(),
            textures: 0,
            uv: Vec::new(),
            random: XorShift::of(seed),
        };
        let mut group = None;
        for _ in 0..statements {
            match obj.random.below(8) {
                0 => {
                    let name = ["a", "b", "c"][obj.below(3)];
                    group = Some(name);
                    let keyword = ["g", "o"][obj.below(2)];
                    writeln!(obj.text, "{keyword} {name}").unwrap();
                }
                1 => {
                    obj.textures += 1;
                    writeln!(obj.text, "vt 0.5 {}", obj.textures).unwrap();
                }
                2 if !obj.mesh.points.is_empty() => obj.element("l", 2, group),
                3 | 4 if !obj.mesh.points.is_empty() => {
                    let corners = 3 + obj.below(4);
                    obj.element("f", corners, group);
                }
                _ => {
                    let p = DVec3::from_array([(); 3].map(|()| obj.random.next() as f64 / 7.0));
                    obj.mesh.points.push(p);
                    let further = ["", " 2", " .1 .2 .3", " # v 1 2 3"][obj.below(4)];
                    writeln!(obj.text, "v {} {}\\\n{}{further}", p.x, p.y, p.z).unwrap();
                }
            }
        }
        obj
    }

    fn below(&mut self, count: usize) -> usize {
        self.random.below(count)
    }

    /// One of `count` things, and its number in the file: counted from the first, or back from the last.
    fn one_of(&mut self, count: usize) -> (u32, String) {
        let index = self.below(count);
        let number = if self.below(2) == 0 { index as i64 + 1 } else { index as i64 - count as i64 };
        (index as u32, number.to_string())
    }

    fn element(&mut self, keyword: &str, count: usize, group: Option<&str>) {
        let (mut corners, mut uv) = (Vec::new(), Vec::new());
        self.text += keyword;
        for _ in 0..count {
            let (vertex, number) = self.one_of(self.mesh.points.len());
            corners.push(vertex);
            write!(self.text, " {number}").unwrap();
            if keyword == "f" && self.textures > 0 && self.below(8) > 0 {
                let (texture, number) = self.one_of(self.textures);
                uv.push(texture);
                write!(self.text, "/{number}").unwrap();
            } else if self.below(2) == 0 {
                self.text += "//1";
            }
        }
        self.text += "\n";
        let dimension = if keyword == "f" { 2 } else { 1 };
        let tag = group.map_or(0, |name| {
            let named = |group: &&Group| group.dimension == dimension && group.name == name;
            let of_dimension = self.mesh.groups.iter().filter(|group| group.dimension == dimension).count();
            self.mesh.groups.iter().find(named).map_or(of_dimension as u32 + 1, |group| group.tag)
        });
        if let Some(name) = group.filter(|_| self.mesh.group_name(dimension, tag).is_none()) {
            self.mesh.groups.push(Group { dimension, tag, name: name.to_owned() });
        }
        if dimension == 1 {
            self.mesh.lines.push([corners[0], corners[1]]);
            self.mesh.line_tags.push(tag);
            return;
        }
        let has_all = uv.len() == corners.len();
        match corners[..] {
            [a, b, c] => {
                self.mesh.triangles.push([a, b, c]);
                self.mesh.triangle_tags.push(tag);
                self.uv.push(if has_all { uv } else { Vec::new() });
            }
            [a, b, c, d] => {
                self.mesh.quads.push([a, b, c, d]);
                self.mesh.quad_tags.push(tag);
            }
            _ => {
                self.mesh.polygons.push(corners);
                self.mesh.polygon_tags.push(tag);
            }
        }
    }
}

#[test]
fn statements_of_obj_in_any_order_give_the_mesh_that_they_were_made_from() {
    for seed in 1..200 {
        // The last ones have more vertices than one polygon of the reader's own names.
        let obj = Obj::random(seed, if seed < 190 { 1 + seed as usize / 2 } else { 4000 });
        let found = match read_bytes("a.obj", obj.text.as_bytes(), Format::Obj) {
            Ok(found) => found,
            Err(fault) => {
                let empty = obj.mesh.triangles.is_empty() && obj.mesh.quads.is_empty() && obj.mesh.polygons.is_empty();
                assert!(empty, "{seed}: {fault}");
                continue;
            }
        };
        let has = |dimension| obj.mesh.groups.iter().any(|group| group.dimension == dimension);
        let tags = |dimension, tags: &[u32]| if has(dimension) { tags.to_vec() } else { Vec::new() };
        let mut groups = obj.mesh.groups.clone();
        groups.sort_by_key(|group| (group.dimension, group.tag));
        assert_eq!((&found.points, &found.lines), (&obj.mesh.points, &obj.mesh.lines), "{seed}");
        assert_eq!((&found.triangles, &found.quads), (&obj.mesh.triangles, &obj.mesh.quads), "{seed}");
        assert_eq!((&found.polygons, &found.groups), (&obj.mesh.polygons, &groups), "{seed}");
        assert_eq!(found.line_tags, tags(1, &obj.mesh.line_tags), "{seed}");
        assert_eq!(found.triangle_tags, tags(2, &obj.mesh.triangle_tags), "{seed}");
        assert_eq!(found.quad_tags, tags(2, &obj.mesh.quad_tags), "{seed}");
        assert_eq!(found.polygon_tags, tags(2, &obj.mesh.polygon_tags), "{seed}");
        for (triangle, expected) in obj.uv.iter().enumerate() {
            let expected = expected.iter().map(|&k| (0.5, f64::from(k + 1)).into()).collect::<Vec<DVec2>>();
            let uv = found.texture.as_ref().and_then(|texture| texture.of_triangle(triangle));
            assert_eq!(uv.map_or(Vec::new(), |uv| uv.to_vec()), expected, "{seed}: triangle {triangle}");
        }
    }
}

#[test]
fn what_is_wrong_with_an_obj_is_told_with_its_line() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\n\\\n# a\n";
    for (statement, told) in [
        ("f 1 2 4", "line 6: A face or line refers to vertex 4 of 3."),
        ("f 1 2 -4", "line 6: A face or line refers to vertex -4 of 3."),
        ("f 1 0 3", "line 6: A face or line refers to vertex 0 of 3."),
        ("f 1 2 9223372036854775807", "line 6: A face or line refers to vertex 9223372036854775807 of 3."),
        ("f 1 2 -9223372036854775808", "line 6: A face or line refers to vertex -9223372036854775808 of 3."),
        ("f 1 2 99999999999999999999", "line 6: Expected a vertex of the face, found \"99999999999999999999\"."),
        ("f 1 2 \u{e9}", "line 6: Expected a vertex of the face, found"),
        ("f 1 2", "line 6: A face has fewer than three vertices."),
        ("f", "line 6: A face has fewer than three vertices."),
        ("l 1 9", "line 6: A face or line refers to vertex 9 of 3."),
        ("v 1 2", "line 6: Expected a coordinate, found \"\"."),
        ("v 1 2 z", "line 6: Expected a coordinate, found \"z\"."),
        ("v 1 inf 2", "line 6: Expected a coordinate, found \"inf\"."),
    ] {
        for after in ["\n", "", "\nf 1 2 3\n"] {
            let text = format!("{square}{statement}{after}");
            let fault = read_bytes("a.obj", text.as_bytes(), Format::Obj).unwrap_err().to_string();
            assert!(fault.contains(told), "{text}: {fault}");
        }
    }
    // A vertex may come later.
    let text = format!("{square}f 1 2 4\nv 1 2 3\n");
    assert_eq!(read_bytes("a.obj", text.as_bytes(), Format::Obj).unwrap().triangles, [[0, 1, 3]]);
    // References to texture coordinates that are wrong leave faces without texture.
    for texture in ["0", "9", "-2", "x", "-9223372036854775808", "9223372036854775807"] {
        let text = format!("{square}vt 0 0\nf 1/1 2/1 3/{texture}\nf 1/1 2/-1 3/1/7\n");
        let mesh = read_bytes("a.obj", text.as_bytes(), Format::Obj).unwrap();
        let texture = mesh.texture.unwrap();
        assert_eq!([0, 1].map(|triangle| texture.of_triangle(triangle).is_some()), [false, true], "{text}");
    }
}
