use super::*;
use crate::core::progress::{Nobody, Reading};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec2;

/// Two triangles over the unit square, 48 bytes of positions and then indices 0 1 2 3 as bytes, with the given nodes
/// and mode.
fn document(nodes: &str, mode: u8, more: &str) -> String {
    let mut bytes = Vec::new();
    for x in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0] {
        bytes.extend(x.to_le_bytes());
    }
    bytes.extend([0, 1, 2, 3]);
    let data = STANDARD.encode(&bytes);
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{nodes}],
        "meshes": [{{"name": "square", "primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "mode": {mode}}}]}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}},
            {{"bufferView": 1, "componentType": 5121, "count": 4, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 4}}],
        "buffers": [{{"byteLength": 52, "uri": "data:application/octet-stream;base64,{data}"}}]{more}}}"#
    )
}

fn read_text(text: &str) -> Result<MeshFile, Fault> {
    read("a.gltf", text.as_bytes(), None, &Reading::watched(&mut Nobody))
}

fn refused(text: &str) -> String {
    read_text(text).unwrap_err().to_string()
}

#[test]
fn strips_and_fans_become_consistently_oriented_triangles() {
    let strip = read_text(&document(r#"{"mesh": 0}"#, 5, "")).unwrap();
    assert_eq!(strip.triangles, [[0, 1, 2], [2, 1, 3]]);
    let fan = read_text(&document(r#"{"mesh": 0}"#, 6, "")).unwrap();
    assert_eq!(fan.triangles, [[0, 1, 2], [0, 2, 3]]);
    let lines = read_text(&document(r#"{"mesh": 0}"#, 3, "")).unwrap();
    assert_eq!(lines.skipped, [("line".to_owned(), 4)]);
}

#[test]
fn texture_coordinates_survive_welding() {
    let coordinates: Vec<u8> =
        [0.0_f32, 0.0, 0.5, 0.0, 0.0, 0.25, 0.5, 0.25].iter().flat_map(|x| x.to_le_bytes()).collect();
    let text = document(r#"{"mesh": 0}"#, 5, "")
        .replace(r#""POSITION": 0"#, r#""POSITION": 0, "TEXCOORD_0": 2"#)
        .replace(
            r#""type": "SCALAR"}]"#,
            r#""type": "SCALAR"}, {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}]"#,
        )
        .replace(r#""byteLength": 4}]"#, r#""byteLength": 4}, {"buffer": 1, "byteLength": 32}]"#)
        .replace(
            r#""buffers": ["#,
            &format!(
                r#""buffers": [{{"byteLength": 52, "uri": "first"}}, {{"byteLength": 32, "uri": "data:application/octet-stream;base64,{}"}}, "#,
                STANDARD.encode(&coordinates)
            ),
        );
    // The document's own buffer replaces the first.
    let (head, tail) = text.split_once(r#"{"byteLength": 52, "uri": "first"}, "#).unwrap();
    let (second, own) = tail.split_once("}, ").unwrap();
    let (own, rest) = own.split_once("}]").unwrap();
    let mesh = read_text(&format!("{head}{own}}}, {second}}}]{rest}")).unwrap();
    let texture = mesh.texture.unwrap();
    let at = |x: f64, y: f64| DVec2::new(x, y);
    assert_eq!(texture.of_triangle(0), Some([at(0.0, 0.0), at(0.5, 0.0), at(0.0, 0.25)]));
    assert_eq!(texture.of_triangle(1), Some([at(0.0, 0.25), at(0.5, 0.0), at(0.5, 0.25)]));
    assert_eq!(texture.of_triangle(2), None);
}

#[test]
fn all_transforms_above_a_node_apply_and_mirrored_nodes_keep_their_orientation() {
    let nodes = r#"{"children": [1], "translation": [10, 0, 0]}, {"mesh": 0, "name": "mirrored", "scale": [-2, 1, 1]}"#;
    let mesh = read_text(&document(nodes, 5, "")).unwrap();
    assert_eq!(mesh.points[1], DVec3::new(8.0, 0.0, 0.0));
    assert_eq!(mesh.triangles, [[0, 2, 1], [2, 3, 1]]);
    assert_eq!(mesh.groups[0].name, "mirrored");
    let quarter = r#"{"mesh": 0, "rotation": [0, 0, 0.70710678, 0.70710678]}"#;
    let turned = read_text(&document(quarter, 5, "")).unwrap().points[1];
    assert!(turned.distance(DVec3::Y) < 1e-7, "{turned}");
}

#[test]
fn nodes_with_two_parents_or_in_a_cycle_are_refused() {
    let loop_of_two = r#"{"children": [1]}, {"children": [0], "mesh": 0}"#;
    assert!(refused(&document(loop_of_two, 4, "")).contains("own ancestor"));
    let diamond = r#"{"children": [1, 2]}, {"children": [3]}, {"children": [3]}, {"mesh": 0}"#;
    assert!(refused(&document(diamond, 4, "")).contains("Node 3"));
}

#[test]
fn required_extensions_that_change_the_triangles_are_refused_by_name() {
    let with = |name: &str| document(r#"{"mesh": 0}"#, 5, &format!(r#", "extensionsRequired": ["{name}"]"#));
    assert!(refused(&with("KHR_draco_mesh_compression")).contains("KHR_draco_mesh_compression"));
    assert!(refused(&with("EXT_meshopt_compression")).contains("EXT_meshopt_compression"));
    assert!(read_text(&with("KHR_texture_transform")).is_ok());
}

#[test]
fn ranges_beyond_a_buffer_and_indices_beyond_the_points_are_refused() {
    let good = document(r#"{"mesh": 0}"#, 5, "");
    for (from, to, expected) in [
        (r#""count": 4, "type": "VEC3""#, r#""count": 5, "type": "VEC3""#, "beyond the end of the buffer"),
        (
            r#""count": 4, "type": "VEC3""#,
            r#""count": 18446744073709551615, "type": "VEC3""#,
            "beyond the end of the buffer",
        ),
        (r#""byteOffset": 48"#, r#""byteOffset": 49"#, "beyond the end of the buffer"),
        (r#""byteOffset": 48"#, r#""byteOffset": 18446744073709551615"#, "beyond the end of the buffer"),
        // The bytes of 1.0 are 0, 0, 128, 63.
        (r#""byteOffset": 48"#, r#""byteOffset": 12"#, "refers to vertex 128 of 4"),
        (r#""byteLength": 52"#, r#""byteLength": 53"#, "instead of 53"),
        (r#""componentType": 5126"#, r#""componentType": 5123"#, "single precision"),
    ] {
        assert!(good.contains(from), "{from}");
        let message = refused(&good.replace(from, to));
        assert!(message.contains(expected), "{to}: {message}");
    }
}

#[test]
fn external_files_are_read_from_the_folder_only() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    let text = document(r#"{"mesh": 0}"#, 5, "");
    let (start, end) = (text.find("data:").unwrap(), text.rfind("\"}]").unwrap());
    let bytes = STANDARD.decode(text[start..end].rsplit_once(',').unwrap().1).unwrap();
    std::fs::write(inner.join("a b.bin"), &bytes).unwrap();
    std::fs::write(folder.path().join("outside.bin"), &bytes).unwrap();
    let with = |uri: &str| format!("{}{uri}{}", &text[..start], &text[end..]);
    let read = |uri: &str| read("a.gltf", with(uri).as_bytes(), Some(&inner), &Reading::watched(&mut Nobody));
    assert_eq!(read("a%20b.bin").unwrap().triangles.len(), 2);
    let absolute = folder.path().join("outside.bin").display().to_string();
    for uri in
        ["../outside.bin", "%2e%2e/outside.bin", &absolute, "file:///etc/passwd", "http://x/y", "a%2", "none.bin"]
    {
        let message = read(uri).unwrap_err().to_string();
        assert!(!message.contains("panicked") && message.starts_with("a.gltf"), "{message}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.path().join("outside.bin"), inner.join("link.bin")).unwrap();
        assert!(read("link.bin").unwrap_err().to_string().contains("is a link"));
    }
    assert!(read_text(&with("a%20b.bin")).unwrap_err().to_string().contains("external files"));
}

#[test]
fn a_document_that_repeats_its_mesh_too_often_is_refused() {
    let mut nodes = String::from(r#"{"children": ["#);
    let many = 600_000;
    nodes.push_str(&(1..=many).map(|i| i.to_string()).collect::<Vec<_>>().join(","));
    nodes.push_str("]}");
    nodes.push_str(&r#",{"mesh":0}"#.repeat(many));
    assert!(refused(&document(&nodes, 5, "")).contains("too much memory"));
}

#[test]
fn a_header_with_a_wrong_length_is_refused() {
    for length in [0_u32, 11, 12, 4000] {
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        bytes.extend(length.to_le_bytes());
        bytes.extend([0; 20]);
        assert!(read("a.glb", &bytes, None, &Reading::watched(&mut Nobody)).is_err());
    }
    assert!(read("a.glb", b"glTF", None, &Reading::watched(&mut Nobody)).is_err());
}
