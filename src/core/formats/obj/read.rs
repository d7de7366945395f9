//! Reading OBJ: the crate `tobj` reads clean lines ([`CleanLines`]); here its elements become those of a mesh, in the
//! order and with the numbers of the file, and its errors get words and the lines of the file.

use glam::{DVec2, DVec3};

use super::clean_lines::{CleanLines, Kept};
use super::statements::{Statements, words};
use crate::core::fault::Fault;
use crate::core::formats::scan::{Scanner, parse_integer, parse_real, shown};
use crate::core::progress::Pace;
use crate::core::soup::{MeshFile, Texture};

/// Reads vertices, triangles, quadrilaterals, polygons and lines.
///
/// # Errors
/// With the line: a malformed vertex, face or line, or a reference to a missing vertex.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let statements = || Statements::new(Scanner::new(name, bytes));
    let mut lines = CleanLines::new(Statements::new(Scanner::new(name, bytes).watched(pace)), statements());
    let found = tobj::load_obj_buf(&mut lines, &tobj::LoadOptions::default(), |_| Ok(Default::default()));
    let found = match found {
        // Without elements there is no model.
        Ok((models, _)) => models.into_iter().next().map(|model| model.mesh).unwrap_or_default(),
        Err(tobj::LoadError::FaceVertexOutOfBounds) => return Err(out_of_bounds(statements())),
        Err(_) => return Err(malformed(&lines)),
    };
    let kept = lines.kept();
    if let Some(vertex) = found.positions.iter().position(|x| !x.is_finite()) {
        return Err(infinite(statements(), vertex / 3));
    }
    mesh_of(found, kept).map_err(|element| too_few_corners(statements(), element))
}

/// The elements that `tobj` has found as a mesh; or, counted over faces and lines, the first face with fewer than three
/// vertices.
fn mesh_of(found: tobj::Mesh, kept: Kept) -> Result<MeshFile, usize> {
    let mut mesh = kept.mesh;
    mesh.points = found.positions.chunks_exact(3).map(DVec3::from_slice).collect();
    let uv = found.texcoords.chunks_exact(2).map(DVec2::from_slice).collect();
    let mut texture = Texture { uv, ..Texture::default() };
    // Where all elements are triangles there are no arities.
    let triangles = if found.face_arities.is_empty() { found.indices.len() / 3 } else { 0 };
    let arities = found.face_arities.iter().copied().chain(std::iter::repeat_n(3, triangles));
    let mut at = 0;
    let ranges = arities.map(|arity| {
        at += arity as usize;
        at - arity as usize..at
    });
    let mut runs = kept.runs.iter().peekable();
    let mut untextured = kept.untextured.iter().peekable();
    let mut run = None;
    let mut faces = 0;
    for (element, range) in ranges.skip(kept.calls).enumerate() {
        run = runs.next_if(|next| next.first == element).or(run);
        let Some(run) = run else { continue };
        let corners = &found.indices[range.clone()];
        if !run.of_faces {
            for ends in corners.windows(2) {
                mesh.lines.push([ends[0], ends[1]]);
                mesh.line_tags.push(run.tag);
            }
            continue;
        }
        faces += 1;
        mesh.push_face(corners, faces).ok_or(element)?.push(run.tag);
        let textured = untextured.next_if(|next| **next == element).is_none();
        match *found.texcoord_indices.get(range).filter(|_| textured).unwrap_or_default() {
            [] => {}
            [a, b, c] => texture.set_triangle(mesh.triangles.len() - 1, [a, b, c]),
            [a, b, c, d] => texture.set_quad(mesh.quads.len() - 1, [a, b, c, d]),
            ref corners => {
                texture.polygons.resize(mesh.polygons.len() - 1, Vec::new());
                texture.polygons.push(corners.to_vec());
            }
        }
    }
    mesh.counting.shared = true;
    mesh.texture = texture.filled(&mesh);
    let has = |dimension| mesh.groups.iter().any(|group| group.dimension == dimension);
    let (faces, lines) = (has(2), has(1));
    if !faces {
        mesh.triangle_tags.clear();
        mesh.quad_tags.clear();
        mesh.polygon_tags.clear();
    }
    if !lines {
        mesh.line_tags.clear();
    }
    mesh.groups.sort_by_key(|group| (group.dimension, group.tag));
    Ok(mesh)
}

/// The fault of the statement that `tobj` has refused: its first word that is not what it must be.
fn malformed(lines: &CleanLines) -> Fault {
    let mut words = words(&lines.statement);
    let (wrong, expected) = match words.next() {
        Some(b"v") => {
            let mut coordinates = [(); 3].map(|()| words.next().unwrap_or_default()).into_iter();
            (coordinates.find(|word| parse_real(word).is_none()), "a coordinate")
        }
        Some(b"l") => (words.find(|word| vertex(word).is_none()), "a vertex of the line"),
        _ => (words.find(|word| vertex(word).is_none()), "a vertex of the face"),
    };
    lines.statements.unexpected(wrong.unwrap_or_default(), expected)
}

/// The number before the first `/` of a corner; negative ones count back from the last vertex so far.
fn vertex(word: &[u8]) -> Option<i64> {
    parse_integer(word.split(|&b| b == b'/').next()?)
}

/// The fault of the first element with a vertex that the file does not have.
fn out_of_bounds(mut s: Statements) -> Fault {
    let mut all = s.clone();
    let count = std::iter::from_fn(|| all.next()).filter(|statement| words(statement).next() == Some(b"v")).count();
    let mut so_far = 0;
    while let Some(statement) = s.next() {
        let mut words = words(&statement);
        match words.next() {
            Some(b"v") => so_far += 1,
            Some(b"f" | b"l") => {
                let exists = |word: &[u8]| match vertex(word) {
                    Some(number @ 0..) => (1..=count as u64).contains(&number.unsigned_abs()),
                    Some(number) => number.unsigned_abs() <= so_far,
                    None => false,
                };
                if let Some(word) = words.find(|word| !exists(word)) {
                    let vertex = word.split(|&b| b == b'/').next().unwrap_or_default();
                    let what = format!("A face or line refers to vertex {} of {count}", shown(vertex));
                    return s.fault_at(s.mark(), what);
                }
            }
            _ => {}
        }
    }
    s.fault_at(s.mark(), "A face or line refers to a vertex that the file does not have")
}

/// The fault of a vertex with an infinite coordinate or one that is not a number.
fn infinite(mut s: Statements, vertex: usize) -> Fault {
    let mut vertices = std::iter::from_fn(|| s.next()).filter(|statement| words(statement).next() == Some(b"v"));
    let statement = vertices.nth(vertex).unwrap_or_default();
    let wrong = words(&statement).skip(1).find(|word| parse_real(word).is_none_or(|x| !x.is_finite()));
    s.unexpected(wrong.unwrap_or_default(), "a coordinate")
}

/// The fault of a face, counted over faces and lines.
fn too_few_corners(mut s: Statements, element: usize) -> Fault {
    let is_element = |statement: &[u8]| matches!(words(statement).next(), Some(b"f" | b"l"));
    std::iter::from_fn(|| s.next()).filter(|statement| is_element(statement)).nth(element);
    s.fault_at(s.mark(), "A face has fewer than three vertices")
}
