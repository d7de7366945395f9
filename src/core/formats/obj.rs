//! Wavefront OBJ: vertices, faces with texture coordinates, lines, and their groups or objects. Deliberately absent:
//! everything else (normals, materials) is ignored.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::{DVec2, DVec3};

use super::scan::{Scanner, parse_integer, parse_real};
use crate::core::fault::Fault;
use crate::core::kernel::Shortest;
use crate::core::progress::Pace;
use crate::core::soup::mesh_file::tag_of;
use crate::core::soup::{Group, MeshFile, Texture};

/// Reads vertices, triangles, quadrilaterals, polygons and lines.
///
/// # Errors
/// With the line: a malformed vertex, face or line, or a reference to a missing vertex.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut s = Scanner::new(name, bytes).watched(pace);
    let mut mesh = MeshFile::default();
    let mut corners: Vec<u32> = Vec::new();
    let mut faces = 0;
    // A face may precede its vertices: the largest index, with its position in the file, is checked at the end.
    let mut largest = (0, 0);
    let (mut names, mut line_names) = (GroupNames::of(2), GroupNames::of(1));
    let mut texture = Texture::default();
    let mut corners_uv: Vec<u32> = Vec::new();
    while let Some(line) = s.line() {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => {
                let mut p = DVec3::ZERO;
                for axis in 0..3 {
                    p[axis] = s.coordinate(words.next().unwrap_or_default())?;
                }
                mesh.points.push(p);
            }
            Some(b"vt") => {
                // A malformed coordinate becomes NaN, and its faces have no texture.
                let mut coordinate = || words.next().and_then(parse_real).unwrap_or(f64::NAN);
                texture.uv.push(DVec2::new(coordinate(), coordinate()));
            }
            Some(b"f") => {
                corners_uv.clear();
                corners_uv.extend(words.clone().map(|word| texture_corner(word, texture.uv.len())));
                take_corners(&s, words, mesh.points.len(), "face", &mut largest, &mut corners)?;
                let tag = names.tag(&mut mesh);
                faces += 1;
                let tags = mesh.push_face(&corners, faces);
                tags.ok_or_else(|| s.fault("A face has fewer than three vertices"))?.push(tag);
                match corners_uv[..] {
                    [a, b, c] => texture.set_triangle(mesh.triangles.len() - 1, [a, b, c]),
                    [a, b, c, d] => texture.set_quad(mesh.quads.len() - 1, [a, b, c, d]),
                    _ => texture.polygons.push(corners_uv.clone()),
                }
            }
            // A group within an object overrides it; a face in several groups belongs to the first.
            Some(b"g" | b"o") => {
                names.next = words.next().map(|name| String::from_utf8_lossy(name).into_owned());
                line_names.next.clone_from(&names.next);
            }
            Some(b"l") => {
                take_corners(&s, words, mesh.points.len(), "line", &mut largest, &mut corners)?;
                let tag = line_names.tag(&mut mesh);
                for ends in corners.windows(2) {
                    mesh.lines.push([ends[0], ends[1]]);
                    mesh.line_tags.push(tag);
                }
            }
            _ => {}
        }
    }
    if largest.0 > mesh.points.len() {
        let what = format!("A face or line refers to vertex {} of {}", largest.0, mesh.points.len());
        return Err(s.fault_at(largest.1, what));
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

/// The groups of faces, or of lines, in the order of their first members.
struct GroupNames {
    dimension: u8,
    tags: BTreeMap<String, u32>,
    /// The group of the following elements, until the first of them is read.
    next: Option<String>,
    current: u32,
}

impl GroupNames {
    fn of(dimension: u8) -> Self {
        GroupNames { dimension, tags: BTreeMap::new(), next: None, current: 0 }
    }

    /// The tag of the next face or line; adds its group to the mesh if this is its first member.
    fn tag(&mut self, mesh: &mut MeshFile) -> u32 {
        if let Some(name) = self.next.take() {
            let new = self.tags.len() as u32 + 1;
            self.current = *self.tags.entry(name.clone()).or_insert(new);
            if self.current == new {
                mesh.groups.push(Group { dimension: self.dimension, tag: new, name });
            }
        }
        self.current
    }
}

/// Reads the vertices of a face or line into `corners`; `largest` keeps the largest number so far and its line's mark.
fn take_corners<'w>(
    s: &Scanner,
    words: impl Iterator<Item = &'w [u8]>,
    so_far: usize,
    of: &str,
    largest: &mut (usize, usize),
    corners: &mut Vec<u32>,
) -> Result<(), Fault> {
    corners.clear();
    for word in words {
        let vertex = corner(word, so_far).ok_or_else(|| s.unexpected(word, &format!("a vertex of the {of}")))?;
        if vertex as usize >= largest.0 {
            *largest = (vertex as usize + 1, s.mark());
        }
        corners.push(vertex);
    }
    Ok(())
}

/// The zero-based vertex of `v`, `v/vt`, `v//vn` or `v/vt/vn`; a negative number counts back from the last vertex so
/// far.
fn corner(word: &[u8], so_far: usize) -> Option<u32> {
    let vertex = parse_integer(word.split(|&b| b == b'/').next()?)?;
    let index = if vertex < 0 { vertex.checked_add(so_far as i64)? } else { vertex - 1 };
    u32::try_from(index).ok().filter(|&index| index < u32::MAX)
}

/// The zero-based texture coordinate of `v/vt` or `v/vt/vn`, numbered like vertices; [`Texture::NONE`] without one.
fn texture_corner(word: &[u8], so_far: usize) -> u32 {
    corner(word.split(|&b| b == b'/').nth(1).unwrap_or_default(), so_far).unwrap_or(Texture::NONE)
}

/// Writes points, triangles and quadrilaterals, and the lines of named groups, with the names of their groups.
///
/// # Errors
/// Those of `out`.
pub fn write(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    for p in &mesh.points {
        writeln!(out, "v {} {} {}", Shortest(p.x), Shortest(p.y), Shortest(p.z))?;
    }
    let triangles = mesh.triangles.iter().enumerate().map(|(i, t)| (&t[..], tag_of(&mesh.triangle_tags, i)));
    let quads = mesh.quads.iter().enumerate().map(|(i, q)| (&q[..], tag_of(&mesh.quad_tags, i)));
    let mut group = None;
    for (face, tag) in triangles.chain(quads) {
        enter(out, &mut group, mesh.group_name(2, tag))?;
        write_corners(out, "f", face)?;
    }
    group = None;
    for i in mesh.own_lines() {
        enter(out, &mut group, mesh.group_name(1, tag_of(&mesh.line_tags, i)))?;
        write_corners(out, "l", &mesh.lines[i])?;
    }
    Ok(())
}

/// Starts a group, unless it is the current one.
fn enter<'n>(out: &mut dyn Write, group: &mut Option<&'n str>, name: Option<&'n str>) -> io::Result<()> {
    if let Some(name) = name.filter(|name| *group != Some(*name)) {
        *group = Some(name);
        // White space would separate several group names.
        writeln!(out, "g {}", name.split_whitespace().collect::<Vec<_>>().join("_"))?;
    }
    Ok(())
}

fn write_corners(out: &mut dyn Write, word: &str, corners: &[u32]) -> io::Result<()> {
    write!(out, "{word}")?;
    for &corner in corners {
        write!(out, " {}", u64::from(corner) + 1)?;
    }
    writeln!(out)
}
