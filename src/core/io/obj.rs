//! Wavefront OBJ: vertices and faces. Deliberately absent: everything else (texture coordinates, normals, materials,
//! lines, groups) is passed over.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec3;

use super::mesh_file::MeshFile;
use super::save::Shortest;
use super::scan::{Scanner, parse_integer, parse_real, shown};
use crate::core::fault::Fault;

/// Reads vertices, triangles and quadrilaterals; polygons with more corners are counted as skipped.
///
/// # Errors
/// A fault with the line for a malformed vertex or face and for a face whose vertex does not exist.
pub fn read(name: &str, bytes: &[u8]) -> Result<MeshFile, Fault> {
    let mut s = Scanner::new(name, bytes);
    let mut mesh = MeshFile::default();
    let mut polygons: BTreeMap<usize, usize> = BTreeMap::new();
    let mut corners: Vec<u32> = Vec::new();
    // A face may stand before its vertices: the largest vertex and where it stands are checked at the end.
    let mut largest = (0, 0);
    while let Some(line) = s.line() {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => {
                let mut p = DVec3::ZERO;
                for axis in 0..3 {
                    let word = words.next().unwrap_or_default();
                    p[axis] = match parse_real(word) {
                        Some(x) if x.is_finite() => x,
                        _ => return Err(s.fault(format!("\"{}\" stands where a coordinate is expected", shown(word)))),
                    };
                }
                mesh.points.push(p);
            }
            Some(b"f") => {
                corners.clear();
                for word in words {
                    let vertex = corner(word, mesh.points.len()).ok_or_else(|| {
                        s.fault(format!("\"{}\" stands where a vertex of the face is expected", shown(word)))
                    })?;
                    if vertex as usize >= largest.0 {
                        largest = (vertex as usize + 1, s.mark());
                    }
                    corners.push(vertex);
                }
                match corners[..] {
                    [a, b, c] => mesh.triangles.push([a, b, c]),
                    [a, b, c, d] => mesh.quads.push([a, b, c, d]),
                    [] | [_] | [_, _] => return Err(s.fault("A face has fewer than three vertices")),
                    _ => *polygons.entry(corners.len()).or_default() += 1,
                }
            }
            _ => {}
        }
    }
    if largest.0 > mesh.points.len() {
        let what = format!("A face has the vertex {}, and there are {}", largest.0, mesh.points.len());
        return Err(s.fault_at(largest.1, what));
    }
    mesh.skipped = polygons.into_iter().map(|(sides, count)| (format!("polygon with {sides} sides"), count)).collect();
    Ok(mesh)
}

/// The zero-based vertex of `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative ones count back from the last vertex so far.
fn corner(word: &[u8], so_far: usize) -> Option<u32> {
    let vertex = parse_integer(word.split(|&b| b == b'/').next()?)?;
    let index = if vertex < 0 { vertex.checked_add(so_far as i64)? } else { vertex - 1 };
    u32::try_from(index).ok().filter(|&index| index < u32::MAX)
}

/// Writes points, triangles and quadrilaterals.
///
/// # Errors
/// What `out` says.
pub fn write(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    for p in &mesh.points {
        writeln!(out, "v {} {} {}", Shortest(p.x), Shortest(p.y), Shortest(p.z))?;
    }
    let faces = mesh.triangles.iter().map(|t| &t[..]).chain(mesh.quads.iter().map(|q| &q[..]));
    for face in faces {
        write!(out, "f")?;
        for &corner in face {
            write!(out, " {}", u64::from(corner) + 1)?;
        }
        writeln!(out)?;
    }
    Ok(())
}
