//! STL, text or binary. Coincident points are welded, since STL cannot share points between triangles. The solids of a
//! text file become groups. Deliberately absent: writing (STL has no quadrilaterals), normals, and the attribute bytes,
//! whose meaning differs between programs.

use glam::DVec3;

use super::scan::{Scanner, TRUNCATED};
use crate::core::fault::Fault;
use crate::core::progress::Pace;
use crate::core::soup::weld::{SINGLE, weld};
use crate::core::soup::{Count, Counting, Group, MeshFile, Welder};

/// Header of a binary file: 80 free bytes and the number of triangles.
const HEADER: usize = 84;
/// A triangle of a binary file: normal and three corners in single precision, two bytes of attributes.
const TRIANGLE: usize = 50;
/// Triangles welded between two reports of progress.
const BATCH: usize = 1 << 12;

/// Reads a mesh from the bytes of an STL file.
///
/// # Errors
/// With the line or byte: an unexpected word, a number that is malformed or not finite, a truncated file.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    // A binary file may begin with "solid" too, so its length decides.
    if let Some(count) = binary_triangles(bytes) {
        return read_binary(name, bytes, count, pace);
    }
    if bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return read_text(Scanner::new(name, bytes).watched(pace), pace);
    }
    Err(Fault::new("This is not STL: it does not begin with \"solid\", and its length does not fit binary STL")
        .at(name)
        .remedy(TRUNCATED))
}

/// The number of triangles in the header of a binary file, if the file is as long or longer. The bytes at this place of
/// a text file are a number larger than any file.
fn binary_triangles(bytes: &[u8]) -> Option<usize> {
    let count = u32::from_le_bytes(*bytes.get(80..)?.first_chunk()?) as usize;
    let (needed, there) = (count.saturating_mul(TRIANGLE), bytes.len() - HEADER);
    (needed == there || (count > 0 && needed < there)).then_some(count)
}

fn read_binary(name: &str, bytes: &[u8], count: usize, pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut s = Scanner::new(name, bytes);
    s.set_binary();
    let (triangles, trailing) = bytes[HEADER..].split_at(count * TRIANGLE);
    let triangles = triangles.as_chunks::<TRIANGLE>().0;
    let corner = |triangle: &[u8; TRIANGLE], corner: usize| {
        let axis = |axis: usize| {
            let at = 12 * (corner + 1) + 4 * axis;
            f64::from(f32::from_le_bytes([0, 1, 2, 3].map(|k| triangle[at + k])))
        };
        DVec3::new(axis(0), axis(1), axis(2))
    };
    let mut largest: f64 = 0.0;
    for (i, triangle) in triangles.iter().enumerate() {
        for p in [0, 1, 2].map(|k| corner(triangle, k)) {
            if !p.is_finite() {
                let what = format!("Triangle {} has a corner at ({}, {}, {})", i + 1, p.x, p.y, p.z);
                return Err(s.fault_at(HEADER + i * TRIANGLE, what).remedy("Coordinates must be finite numbers"));
            }
            largest = largest.max(p.abs().max_element());
        }
    }
    let (mut welder, mut points) = (Welder::new(SINGLE, largest), Vec::new());
    let mut welded = Vec::with_capacity(triangles.len());
    for part in triangles.chunks(BATCH) {
        if !pace.goes_on(HEADER + welded.len() * TRIANGLE, bytes.len()) {
            break;
        }
        welded.extend(part.iter().map(|t| [0, 1, 2].map(|k| welder.weld(&mut points, corner(t, k)))));
    }
    let counting = Counting { points: Count::Nothing, ..Counting::default() };
    let mut mesh = MeshFile { triangles: welded, points, counting, ..MeshFile::default() };
    if !trailing.is_empty() {
        mesh.omit(&format!("{} bytes", trailing.len()), "after the last triangle");
    }
    Ok(mesh)
}

fn read_text(mut s: Scanner, pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let (mut mesh, mut corners) = (MeshFile::default(), Vec::new());
    let mut solid: u32 = 0;
    while let Some(word) = s.word() {
        if !word.eq_ignore_ascii_case(b"solid") {
            return Err(s.unexpected(word, "\"solid\""));
        }
        solid += 1;
        let name = String::from_utf8_lossy(s.line().unwrap_or_default()).into_owned();
        if !name.is_empty() {
            mesh.groups.push(Group { dimension: 2, tag: solid, name });
        }
        loop {
            let word = s.need("\"facet\" or \"endsolid\"")?;
            if word.eq_ignore_ascii_case(b"endsolid") {
                // The name may follow.
                s.line();
                break;
            }
            if !word.eq_ignore_ascii_case(b"facet") {
                return Err(s.unexpected(word, "\"facet\" or \"endsolid\""));
            }
            keyword(&mut s, "normal")?;
            for _ in 0..3 {
                // Ignored: some programs write words that are not numbers.
                s.need("a normal")?;
            }
            keyword(&mut s, "outer")?;
            keyword(&mut s, "loop")?;
            for _ in 0..3 {
                keyword(&mut s, "vertex")?;
                let mut coordinate = || s.finite("a coordinate");
                corners.push(DVec3::new(coordinate()?, coordinate()?, coordinate()?));
            }
            keyword(&mut s, "endloop")?;
            keyword(&mut s, "endfacet")?;
            mesh.triangle_tags.push(solid);
        }
    }
    mesh.triangles = weld(&mut corners, SINGLE, pace.cancel()).as_chunks().0.to_vec();
    mesh.points = corners;
    mesh.counting.points = Count::Nothing;
    Ok(mesh)
}

fn keyword(s: &mut Scanner, keyword: &str) -> Result<(), Fault> {
    let expected = format!("\"{keyword}\"");
    let word = s.need(&expected)?;
    if word.eq_ignore_ascii_case(keyword.as_bytes()) { Ok(()) } else { Err(s.unexpected(word, &expected)) }
}
