//! What is written is the same mesh, to the last bit, to readers that share no code with ours: crates where there are
//! some, else short ones made from the formats' documents (`plain_readers`).

use std::collections::BTreeMap;

use mshio::mshfile::ElementType;
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Property};
use quadfront::core::case::{Case, built_in};
use quadfront::core::convert::background;
use quadfront::core::convert::conversion::convert;
use quadfront::core::formats::format::write_mesh;
use quadfront::core::formats::{Format, WriteOptions, medit};
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::run::Births;
use quadfront::core::soup::MeshFile;
use quadfront::core::soup::mesh_file::BUILT_IN;
use vtkio::Vtk;
use vtkio::model::{Attribute, CellType, DataSet, Piece, VertexNumbers};

use super::names::plate;
use super::plain_readers::{self, Seen};
use super::{MSH2, TEXT, bytes_of, plates};

/// Meshes of every kind: in the plane and in space, mixed, of several faces, with groups of lines.
fn meshes() -> Vec<(String, MeshFile)> {
    let mut meshes = vec![("plates".to_owned(), plates())];
    for name in ["crack", "two-faces", "branching", "sphere"] {
        let mut case = built_in::named(name).unwrap().unwrap();
        case.parameters.size_scale *= 2.0;
        let done = convert(&case, &mut Nobody).unwrap();
        let mut export = Export::of(&done.mesh, &done.names);
        export.describe(&done.mesh, &done.sizing, Some(&Births::of(&done.mesh))).unwrap();
        meshes.push((name.to_owned(), export.file));
    }
    let folder = tempfile::tempdir().unwrap();
    write_mesh(&folder.path().join("a.msh"), Format::Msh, &plate(4, 0.3), WriteOptions::default()).unwrap();
    let text = "version = 1\nmesh = \"a.msh\"\nuse = \"triangles\"\n";
    let done = convert(&Case::parse(text, "a", "a.toml", folder.path()).unwrap(), &mut Nobody).unwrap();
    meshes.push(("a plate with ribs".to_owned(), Export::of(&done.mesh, &done.names).file));
    meshes
}

/// A mesh as a reader ought to see it, each group by what `name` makes of it, and of the lines those that `has` tells.
fn seen(mesh: &MeshFile, has: &dyn Fn(u32) -> bool, name: &dyn Fn(u8, u32) -> String) -> Seen {
    let mut seen = Seen { points: mesh.points.iter().map(|p| p.to_array()).collect(), ..Seen::default() };
    let tag = |tags: &[u32], i: usize| tags.get(i).copied().unwrap_or(0);
    for (i, corners) in mesh.lines.iter().enumerate().filter(|(i, _)| has(tag(&mesh.line_tags, *i))) {
        seen.add(corners, &name(1, tag(&mesh.line_tags, i)));
    }
    mesh.triangles.iter().enumerate().for_each(|(i, t)| seen.add(t, &name(2, tag(&mesh.triangle_tags, i))));
    mesh.quads.iter().enumerate().for_each(|(i, q)| seen.add(q, &name(2, tag(&mesh.quad_tags, i))));
    seen
}

fn group(mesh: &MeshFile, dimension: u8, tag: u32) -> String {
    mesh.group_name(dimension, tag).unwrap_or_default().to_owned()
}

/// Whether lines of a group are in every format that has lines.
fn is_own(mesh: &MeshFile, tag: u32) -> bool {
    tag != 0 && !BUILT_IN.contains(&group(mesh, 1, tag).as_str())
}

#[test]
fn msh_2_is_the_same_mesh_by_the_manual() {
    for (name, mesh) in meshes() {
        let text = String::from_utf8(bytes_of(Format::Msh, &mesh, MSH2)).unwrap();
        assert_eq!(plain_readers::msh_2(&text), seen(&mesh, &|_| true, &|d, tag| group(&mesh, d, tag)), "{name}");
    }
}

/// The same mesh with its points in the order in which MSH 4.1 has them, by entity: `mshio` counts nodes and passes
/// over their tags where these are all the numbers from 1 on.
fn in_order_of_blocks(mesh: &MeshFile) -> MeshFile {
    let tag = |tags: &[u32], i: usize| tags.get(i).copied().unwrap_or(0);
    let mut owner = vec![(u8::MAX, u32::MAX); mesh.points.len()];
    let mut own = |corners: &[u32], entity: (u8, u32)| {
        corners.iter().for_each(|&k| owner[k as usize] = owner[k as usize].min(entity));
    };
    mesh.lines.iter().enumerate().for_each(|(i, l)| own(l, (1, tag(&mesh.line_tags, i))));
    mesh.triangles.iter().enumerate().for_each(|(i, t)| own(t, (2, tag(&mesh.triangle_tags, i))));
    mesh.quads.iter().enumerate().for_each(|(i, q)| own(q, (2, tag(&mesh.quad_tags, i))));
    let mut order: Vec<usize> = (0..owner.len()).collect();
    order.sort_by_key(|&k| (owner[k], k));
    let mut new = vec![0; order.len()];
    order.iter().zip(0..).for_each(|(&k, at)| new[k] = at);
    let mut mesh = MeshFile { metric: None, uv: None, point_data: vec![], ..mesh.clone() };
    mesh.points = order.iter().map(|&k| mesh.points[k]).collect();
    let lists = [mesh.lines.as_flattened_mut(), mesh.triangles.as_flattened_mut(), mesh.quads.as_flattened_mut()];
    lists.into_iter().flatten().for_each(|k| *k = new[*k as usize]);
    mesh
}

#[test]
fn msh_4_is_the_same_mesh_to_mshio() {
    for (name, mesh) in meshes() {
        let mesh = in_order_of_blocks(&mesh);
        let bytes = bytes_of(Format::Msh, &mesh, TEXT);
        let file = mshio::parse_msh_bytes(&bytes).map_err(|error| format!("{name}: {error}")).unwrap();
        let names = plain_readers::physical_names(std::str::from_utf8(&bytes).unwrap());
        let entities = file.data.entities.unwrap();
        let curves = entities.curves.iter().map(|curve| ((1, curve.tag), &curve.physical_tags));
        let surfaces = entities.surfaces.iter().map(|surface| ((2, surface.tag), &surface.physical_tags));
        let physical: BTreeMap<(i32, i32), i32> =
            curves.chain(surfaces).filter_map(|(entity, tags)| Some((entity, *tags.first()?))).collect();
        let mut found = Seen::default();
        for block in &file.data.nodes.unwrap().node_blocks {
            assert!(block.node_tags.is_none());
            found.points.extend(block.nodes.iter().map(|p| [p.x, p.y, p.z]));
        }
        let mut elements = Vec::new();
        for block in &file.data.elements.unwrap().element_blocks {
            let corners = match block.element_type {
                ElementType::Lin2 => 2,
                ElementType::Tri3 => 3,
                ElementType::Qua4 => 4,
                ref other => panic!("{other:?}"),
            };
            let entity = (block.entity_dim, block.entity_tag);
            let name = physical.get(&entity).map_or("", |tag| names[&(entity.0, *tag)].as_str());
            for element in &block.elements {
                assert_eq!(element.nodes.len(), corners);
                elements.push((element.element_tag, element.nodes.iter().map(|n| *n as u32 - 1).collect(), name));
            }
        }
        elements.sort_unstable();
        elements.iter().for_each(|(_, corners, name): &(u64, Vec<u32>, &str)| found.add(corners, name));
        assert_eq!(found, seen(&mesh, &|_| true, &|d, tag| group(&mesh, d, tag)), "{name}");
    }
}

#[test]
fn medit_is_the_same_mesh_by_its_report_and_so_is_the_metric() {
    for (name, mesh) in meshes() {
        let text = String::from_utf8(bytes_of(Format::Medit, &mesh, TEXT)).unwrap();
        assert_eq!(plain_readers::medit(&text), seen(&mesh, &|_| true, &|_, tag| tag.to_string()), "{name}");
        let Some(metric) = &mesh.metric else { continue };
        let mut sol = Vec::new();
        medit::write_metric(&mut sol, &mesh, metric).unwrap();
        let expected: Vec<Vec<f64>> = metric
            .iter()
            .map(|m| if mesh.is_flat() { vec![m.xx, m.xy, m.yy] } else { vec![m.xx, m.xy, m.yy, m.xz, m.yz, m.zz] })
            .collect();
        assert_eq!(plain_readers::sol(std::str::from_utf8(&sol).unwrap()), expected, "{name}");
    }
}

#[test]
fn inp_is_the_same_mesh_by_the_keyword_reference() {
    for (name, mesh) in meshes() {
        let text = String::from_utf8(bytes_of(Format::Inp, &mesh, TEXT)).unwrap();
        let mut found = plain_readers::abaqus(&text);
        // What is no label of Abaqus is made one, and unique by its tag.
        let label = |dimension: u8, tag: u32| {
            let name = group(&mesh, dimension, tag);
            let plain = name.replace(|c: char| !c.is_ascii_alphanumeric(), "_");
            let kind = if dimension == 1 { "CURVE" } else { "SURFACE" };
            if plain == name { name } else { format!("{kind}_{tag}_{plain}") }
        };
        let mut expected = seen(&mesh, &|tag| tag != 0, &label);
        // Lines come group by group, from whichever side.
        for seen in [&mut found, &mut expected] {
            seen.lines.iter_mut().for_each(|(ends, _)| ends.sort_unstable());
            seen.lines.sort_unstable();
        }
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn obj_is_the_same_mesh_to_tobj() {
    for (name, mesh) in meshes() {
        let bytes = bytes_of(Format::Obj, &mesh, TEXT);
        let (models, _) =
            tobj::load_obj_buf(&mut &bytes[..], &tobj::LoadOptions::default(), |_| Ok(Default::default())).unwrap();
        // It numbers the points of each group for itself: corners are told by their places.
        let mut found: Vec<(String, Vec<[f64; 3]>)> = Vec::new();
        for model in &models {
            let position = |k: &u32| [0, 1, 2].map(|axis| model.mesh.positions[3 * *k as usize + axis]);
            let corners: Vec<[f64; 3]> = model.mesh.indices.iter().map(position).collect();
            // Where all faces of a group are triangles there are no arities.
            let all_triangles = vec![3; corners.len() / 3];
            let arities = &model.mesh.face_arities;
            let mut rest = &corners[..];
            for &n in if arities.is_empty() { &all_triangles } else { arities } {
                let (face, after) = rest.split_at(n as usize);
                found.push((model.name.clone(), face.to_vec()));
                rest = after;
            }
        }
        let seen = seen(&mesh, &|tag| is_own(&mesh, tag), &|d, tag| group(&mesh, d, tag).replace(' ', "_"));
        let faces = seen.faces.iter().map(|(corners, name)| (name, &corners[..]));
        let lines = seen.lines.iter().map(|(ends, name)| (name, &ends[..]));
        let place = |k: &u32| seen.points[*k as usize];
        let expected: Vec<(String, Vec<[f64; 3]>)> =
            faces.chain(lines).map(|(name, corners)| (name.clone(), corners.iter().map(place).collect())).collect();
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn ply_is_the_same_mesh_to_the_bare_crate() {
    for (name, mesh) in meshes() {
        let bytes = bytes_of(Format::Ply, &mesh, TEXT);
        let file = Parser::<DefaultElement>::new().read_ply(&mut &bytes[..]).unwrap();
        let double = |property: &Property| match property {
            Property::Double(x) => *x,
            other => panic!("{other:?}"),
        };
        let whole = |property: &Property| match property {
            Property::Int(k) => *k as u32,
            Property::UInt(k) => *k,
            other => panic!("{other:?}"),
        };
        let mut found = Seen::default();
        for vertex in &file.payload["vertex"] {
            found.points.push(["x", "y", "z"].map(|axis| double(&vertex[axis])));
        }
        for face in &file.payload["face"] {
            let Property::ListInt(corners) = &face["vertex_indices"] else { panic!("{face:?}") };
            let corners: Vec<u32> = corners.iter().map(|&k| k as u32).collect();
            found.add(&corners, &whole(&face["region"]).to_string());
            for (k, side) in ["line1", "line2", "line3", "line4"].iter().enumerate() {
                if let Some(tag) = face.get(*side).map(whole).filter(|tag| *tag != 0) {
                    let n = corners.len();
                    assert!(k < n);
                    found.add(&[corners[k], corners[(k + 1) % n]], &tag.to_string());
                }
            }
        }
        let mut expected = seen(&mesh, &|tag| is_own(&mesh, tag), &|_, tag| tag.to_string());
        // Lines come face by face, from whichever side.
        for seen in [&mut found, &mut expected] {
            seen.lines.iter_mut().for_each(|(ends, _)| ends.sort_unstable());
            seen.lines.sort_unstable();
        }
        assert_eq!(found, expected, "{name}");
        for group in mesh.groups.iter().filter(|group| group.dimension == 2) {
            let comment = format!("region {} {}", group.tag, group.name);
            assert!(file.header.comments.contains(&comment), "{comment}: {:?}", file.header.comments);
        }
    }
}

#[test]
fn vtu_is_the_same_mesh_with_its_data_to_vtkio() {
    for (name, mesh) in meshes() {
        let bytes = bytes_of(Format::Vtu, &mesh, TEXT);
        let DataSet::UnstructuredGrid { pieces, .. } = Vtk::parse_xml(&bytes[..]).unwrap().data else { panic!() };
        let [Piece::Inline(piece)] = &pieces[..] else { panic!() };
        let arrays = |attributes: &[Attribute]| -> BTreeMap<String, (usize, Vec<f64>)> {
            let plain = |attribute: &Attribute| match attribute {
                Attribute::DataArray(array) => {
                    let values = array.data.clone().cast_into::<f64>().unwrap();
                    (array.name.clone(), (array.elem.num_comp() as usize, values))
                }
                Attribute::Field { .. } => panic!(),
            };
            attributes.iter().map(plain).collect()
        };
        let (points, cells) = (arrays(&piece.data.point), arrays(&piece.data.cell));
        let coordinates = piece.points.clone().cast_into::<f64>().unwrap();
        let mut found = Seen { points: coordinates.as_chunks().0.to_vec(), ..Seen::default() };
        let VertexNumbers::XML { connectivity, offsets } = &piece.cells.cell_verts else { panic!() };
        let mut from = 0;
        for ((&to, kind), tag) in offsets.iter().zip(&piece.cells.types).zip(&cells["tag"].1) {
            let corners: Vec<u32> = connectivity[from..to as usize].iter().map(|&k| k as u32).collect();
            let shape = [(2, CellType::Line), (3, CellType::Triangle), (4, CellType::Quad)];
            assert!(shape.contains(&(corners.len(), *kind)), "{kind:?}");
            found.add(&corners, &tag.to_string());
            from = to as usize;
        }
        assert_eq!(found, seen(&mesh, &|tag| is_own(&mesh, tag), &|_, tag| tag.to_string()), "{name}");
        let metric = mesh.metric.iter().flatten().flat_map(|m| [m.xx, m.yy, m.zz, m.xy, m.yz, m.xz]);
        assert_eq!(points.get("metric").map(|array| array.0), mesh.metric.as_ref().map(|_| 6), "{name}");
        assert!(points.get("metric").into_iter().flat_map(|array| array.1.iter().copied()).eq(metric), "{name}");
        let uv = mesh.uv.iter().flatten().flat_map(|p| p.to_array());
        assert!(points.get("uv").into_iter().flat_map(|array| array.1.iter().copied()).eq(uv), "{name}");
        let lines = found.lines.len();
        for data in &mesh.element_data {
            let values = &cells[&data.name].1;
            assert_eq!((&values[..values.len() - lines], values.len() - lines), (&data.values[..], found.faces.len()));
        }
        for group in mesh.groups.iter().filter(|group| group.dimension == 2 || is_own(&mesh, group.tag)) {
            let name = group.name.replace('&', "&amp;");
            let array = format!(" Name=\"{name}\" NumberOfComponents=\"2\" NumberOfTuples=\"1\" format=\"ascii\">\n");
            let pair = format!("{array}{} {}\n", group.tag, group.dimension);
            assert!(std::str::from_utf8(&bytes).unwrap().contains(&pair), "{pair}");
        }
    }
}

#[test]
fn a_mesh_without_a_run_has_neither_levels_nor_births() {
    let case = built_in::named("two-faces").unwrap().unwrap();
    let made = background(&case, &mut Nobody).unwrap();
    let mut export = Export::of(&made.mesh, &made.names);
    export.describe(&made.mesh, &made.sizing, None).unwrap();
    let names: Vec<&str> = export.file.element_data.iter().map(|data| data.name.as_str()).collect();
    assert_eq!(names, ["element_id", "quality", "face"]);
    let faces = &export.file.element_data[2].values;
    let tags = export.file.triangle_tags.iter().map(|&tag| f64::from(tag));
    assert!(faces.iter().copied().eq(tags) && faces.contains(&2.0));
    let quality = &export.file.element_data[1].values;
    assert!(quality.iter().all(|q| (0.0..=1.0 + 1e-12).contains(q)));
}
