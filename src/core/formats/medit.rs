//! Medit's text formats: meshes (`.mesh`) and their metrics (`.sol`).
//!
//! Deliberately absent: the binary formats (`.meshb`, `.solb`), rejected by [`Format`](super::format::Format); sections
//! other than vertices, required vertices, edges, triangles and quadrilaterals (corners, ridges), which are told as not
//! read.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Write};

use glam::DVec3;

use super::scan::{Scanner, shown};
use crate::core::fault::Fault;
use crate::core::kernel::{Metric3, Shortest};
use crate::core::progress::{Nobody, Pace, Reading};
use crate::core::soup::mesh_file::tag_of;
use crate::core::soup::{Members, MeshFile};

/// Reads a mesh from the bytes of a `.mesh` file; `name` is the file's name in messages. References become tags.
///
/// # Errors
/// With the line: anything that is not such a file.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut s = Scanner::new(name, bytes).with_comments(b'#').watched(pace);
    let dimension = header(&mut s)?;
    let mut mesh = MeshFile::default();
    let (mut skipped, mut required) = (BTreeMap::new(), Vec::new());
    // Elements may precede the vertices: the largest index, with its position in the file, is checked at the end.
    let mut largest = (0, 0);
    while let Some(word) = s.word() {
        match word {
            b"End" => break,
            b"Vertices" => {
                if !mesh.points.is_empty() {
                    return Err(s.fault("There are two sections Vertices"));
                }
                let count = s.count("a number of vertices", 2 * dimension + 2)?;
                mesh.points.reserve_exact(count);
                for _ in 0..count {
                    let mut p = DVec3::ZERO;
                    for axis in 0..dimension {
                        p[axis] = s.finite("a coordinate")?;
                    }
                    s.integer("a reference")?;
                    mesh.points.push(p);
                }
            }
            b"RequiredVertices" => {
                let count = s.count("a number of vertices", 2)?;
                for _ in 0..count {
                    required.push(vertex(&mut s, &mut largest)?);
                }
            }
            b"Edges" | b"EdgesP2" | b"EdgesP3" => {
                let others = [0, 1, 2][order(word) - 1];
                elements(&mut s, &mut mesh.lines, &mut mesh.line_tags, others, &mut mesh.middles, &mut largest)?;
            }
            b"Triangles" | b"TrianglesP2" | b"TrianglesP3" => {
                let others = [0, 3, 7][order(word) - 1];
                elements(
                    &mut s,
                    &mut mesh.triangles,
                    &mut mesh.triangle_tags,
                    others,
                    &mut mesh.middles,
                    &mut largest,
                )?;
            }
            b"Quadrilaterals" | b"QuadrilateralsQ2" | b"QuadrilateralsQ3" => {
                let others = [0, 5, 12][order(word) - 1];
                elements(&mut s, &mut mesh.quads, &mut mesh.quad_tags, others, &mut mesh.middles, &mut largest)?;
            }
            b"Tetrahedra" | b"Hexahedra" | b"Prisms" | b"Pyramids" => {
                let name = match word {
                    b"Tetrahedra" => "tetrahedron",
                    b"Hexahedra" => "hexahedron",
                    b"Prisms" => "prism",
                    _ => "pyramid",
                };
                let count = s.count("a number of elements", 10)?;
                if count > 0 {
                    *skipped.entry(name.to_string()).or_default() += count;
                }
                to_keyword(&mut s);
            }
            _ if word[0].is_ascii_alphabetic() => {
                mesh.omit("section", &shown(word));
                to_keyword(&mut s);
            }
            _ => {
                return Err(s
                    .unexpected(word, "a keyword (Vertices, ...)")
                    .remedy("The count of the previous section may be wrong"));
            }
        }
    }
    if largest.0 > mesh.points.len() {
        let what = format!("An element refers to vertex {} of {}", largest.0, mesh.points.len());
        return Err(s.fault_at(largest.1, what));
    }
    mesh.clear_zero_tags();
    if !required.is_empty() {
        required.sort_unstable();
        required.dedup();
        mesh.members.push(Members { dimension: 0, tag: 0, of: required });
    }
    mesh.skipped = skipped.into_iter().collect();
    Ok(mesh)
}

/// Reads version and dimension; returns the dimension.
fn header(s: &mut Scanner) -> Result<usize, Fault> {
    if s.need("MeshVersionFormatted")? != b"MeshVersionFormatted" {
        return Err(s
            .fault("The file does not begin with MeshVersionFormatted")
            .remedy("Check that it is a Medit text file"));
    }
    s.whole("a version")?;
    if s.need("Dimension")? != b"Dimension" {
        return Err(s.fault("Expected Dimension after the version"));
    }
    match s.whole("a dimension")? {
        dimension @ (2 | 3) => Ok(dimension as usize),
        other => Err(s.fault(format!("The dimension is {other} instead of 2 or 3"))),
    }
}

/// Moves to the next keyword, past all words that do not start with a letter.
fn to_keyword(s: &mut Scanner) {
    while s.peek().is_some_and(|word| !word[0].is_ascii_alphabetic()) {
        s.word();
    }
}

/// The order of the elements of a section, by the end of its name.
fn order(section: &[u8]) -> usize {
    match section.last() {
        Some(b'2') => 2,
        Some(b'3') => 3,
        _ => 1,
    }
}

/// Reads elements with `others` nodes after their corners, which become `middles`.
fn elements<const N: usize>(
    s: &mut Scanner,
    list: &mut Vec<[u32; N]>,
    tags: &mut Vec<u32>,
    others: usize,
    middles: &mut Vec<u32>,
    largest: &mut (usize, usize),
) -> Result<(), Fault> {
    let count = s.count("a number of elements", 2 * N + 2)?;
    list.reserve_exact(count);
    tags.reserve_exact(count);
    for _ in 0..count {
        let mut corners = [0; N];
        for corner in &mut corners {
            *corner = vertex(s, largest)?;
        }
        for _ in 0..others {
            middles.push(vertex(s, largest)?);
        }
        list.push(corners);
        let tag = s.integer("a reference")?;
        // Negative or large references have no meaning here.
        tags.push(u32::try_from(tag).unwrap_or(0));
    }
    Ok(())
}

/// Reads the number of a vertex, and returns its index.
fn vertex(s: &mut Scanner, largest: &mut (usize, usize)) -> Result<u32, Fault> {
    let number = s.whole("a vertex")?;
    let Ok(index @ 1..) = u32::try_from(number) else {
        return Err(s.fault(format!("An element refers to vertex {number}, which does not exist")));
    };
    if index as usize > largest.0 {
        *largest = (index as usize, s.mark());
    }
    Ok(index - 1)
}

/// Reads the metric at `count` vertices from the bytes of a `.sol` file: at each a size h, which becomes the tensor
/// 1/h^2, or a tensor (in the plane m11 m12 m22, in space m11 m12 m22 m13 m23 m33).
///
/// # Errors
/// With the line: anything that is not such a file, another number of vertices, and a tensor that is not positive
/// definite.
pub fn read_metric(name: &str, bytes: &[u8], count: usize) -> Result<Vec<Metric3>, Fault> {
    read_metric_watched(name, bytes, count, &Reading::watched(&mut Nobody))
}

/// As [`read_metric`], with progress and cancellation.
///
/// # Errors
/// As [`read_metric`], and [`Fault::stopped`].
pub fn read_metric_watched(name: &str, bytes: &[u8], count: usize, pace: &dyn Pace) -> Result<Vec<Metric3>, Fault> {
    let mut s = Scanner::new(name, bytes).with_comments(b'#').watched(pace);
    let dimension = header(&mut s)?;
    while let Some(word) = s.word() {
        if word != b"SolAtVertices" {
            to_keyword(&mut s);
            continue;
        }
        let values = s.count("a number of values", 2)?;
        if values != count {
            let what = format!("The metric has {values} values, but the mesh has {count} vertices");
            return Err(s.fault(what).remedy("Use the .sol that belongs to this mesh"));
        }
        let fields = s.whole("a number of fields")?;
        let kind = s.whole("a type of field")?;
        if fields != 1 || !matches!(kind, 1 | 3) {
            return Err(s
                .fault(format!("{fields} field(s), the first of type {kind}, do not form a metric"))
                .remedy("Give one field, of type 1 (sizes) or 3 (tensors)"));
        }
        let components = if kind == 1 { 1 } else { dimension * (dimension + 1) / 2 };
        s.fits(values as u64, 2 * components, "a number of values")?;
        let read = (1..=count).map(|vertex| tensor(&mut s, components, vertex)).collect();
        return pace.cancel().check().and(read);
    }
    pace.cancel().check()?;
    Err(Fault::new("There is no section SolAtVertices").at(name).remedy("Give the metric at the vertices"))
}

fn tensor(s: &mut Scanner, components: usize, vertex: usize) -> Result<Metric3, Fault> {
    let mut m = [0.0; 6];
    for value in &mut m[..components] {
        *value = s.finite("a value of the metric")?;
    }
    let metric = match components {
        1 => {
            if m[0] <= 0.0 {
                return Err(s.fault(format!("The size of vertex {vertex} is {}, not positive", m[0])));
            }
            let inverse = 1.0 / (m[0] * m[0]);
            Metric3 { xx: inverse, xy: 0.0, xz: 0.0, yy: inverse, yz: 0.0, zz: inverse }
        }
        3 => {
            // The file has no entry for z: its size is the geometric mean of the others.
            let zz = (m[0] * m[2] - m[1] * m[1]).sqrt();
            Metric3 { xx: m[0], xy: m[1], xz: 0.0, yy: m[2], yz: 0.0, zz }
        }
        _ => Metric3 { xx: m[0], xy: m[1], xz: m[3], yy: m[2], yz: m[4], zz: m[5] },
    };
    metric.is_spd().then_some(metric).ok_or_else(|| {
        s.fault(format!("The metric of vertex {vertex} is not positive definite"))
            .remedy("Its eigenvalues must be positive")
    })
}

/// Writes a mesh as `.mesh`, in dimension 2 if all z are zero, otherwise 3. Tags become references.
///
/// # Errors
/// Those of `out`.
pub fn write(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    let dimension = dimension(mesh);
    writeln!(out, "MeshVersionFormatted 2\nDimension {dimension}\n\nVertices\n{}", mesh.points.len())?;
    for p in &mesh.points {
        for axis in 0..dimension {
            write!(out, "{} ", Shortest(p[axis]))?;
        }
        writeln!(out, "0")?;
    }
    let required: BTreeSet<u32> = mesh
        .members
        .iter()
        .filter(|members| members.dimension == 0)
        .flat_map(|members| members.of.iter().copied())
        .collect();
    if !required.is_empty() {
        writeln!(out, "\nRequiredVertices\n{}", required.len())?;
        required.iter().try_for_each(|&k| writeln!(out, "{}", u64::from(k) + 1))?;
    }
    write_elements(out, "Edges", &mesh.lines, &mesh.line_tags)?;
    write_elements(out, "Triangles", &mesh.triangles, &mesh.triangle_tags)?;
    write_elements(out, "Quadrilaterals", &mesh.quads, &mesh.quad_tags)?;
    writeln!(out, "\nEnd")
}

fn write_elements<const N: usize>(out: &mut dyn Write, name: &str, list: &[[u32; N]], tags: &[u32]) -> io::Result<()> {
    if list.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n{name}\n{}", list.len())?;
    for (i, corners) in list.iter().enumerate() {
        for &corner in corners {
            write!(out, "{} ", u64::from(corner) + 1)?;
        }
        writeln!(out, "{}", tag_of(tags, i))?;
    }
    Ok(())
}

/// Writes the metric at the points of a mesh as `.sol`, in the same dimension as [`write`](fn@write).
///
/// # Errors
/// Those of `out`.
pub fn write_metric(out: &mut dyn Write, mesh: &MeshFile, metric: &[Metric3]) -> io::Result<()> {
    let dimension = dimension(mesh);
    writeln!(out, "MeshVersionFormatted 2\nDimension {dimension}\n\nSolAtVertices\n{}\n1 3", metric.len())?;
    for m in metric {
        write!(out, "{} {} {}", Shortest(m.xx), Shortest(m.xy), Shortest(m.yy))?;
        if dimension == 3 {
            write!(out, " {} {} {}", Shortest(m.xz), Shortest(m.yz), Shortest(m.zz))?;
        }
        writeln!(out)?;
    }
    writeln!(out, "\nEnd")
}

fn dimension(mesh: &MeshFile) -> usize {
    if mesh.is_flat() { 2 } else { 3 }
}
