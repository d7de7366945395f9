//! Reading OBJ.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::statements::Statements;
use crate::core::fault::Fault;
use crate::core::formats::scan::{Scanner, parse_integer, parse_real, shown};
use crate::core::progress::Pace;
use crate::core::soup::{EMPTY_GROUP, Group, MeshFile, Texture};

/// Statements that are not read, with what they are about.
const UNREAD: [(&[u8], &str); 9] = [
    (b"vn", "normal"),
    (b"vp", "parameters"),
    (b"p", "point"),
    (b"s", "smoothing group"),
    (b"usemtl", "material"),
    (b"mtllib", "material library"),
    (b"curv", "curve"),
    (b"curv2", "curve on a surface"),
    (b"surf", "surface"),
];

/// Keywords of such statements that are counted.
const MOST_UNREAD: usize = 50;

/// Reads vertices, triangles, quadrilaterals, polygons and lines.
///
/// # Errors
/// With the line: a malformed vertex, face or line, or a reference to a missing vertex.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut s = Statements::new(Scanner::new(name, bytes).watched(pace));
    let mut mesh = MeshFile::default();
    let mut corners: Vec<u32> = Vec::new();
    let mut faces = 0;
    // A face may precede its vertices: the largest index, with its position in the file, is checked at the end.
    let mut largest = (0, 0);
    let [mut names, mut line_names] = [2, 1].map(|dimension| GroupNames { dimension, ..GroupNames::default() });
    let mut texture = Texture::default();
    let mut corners_uv: Vec<u32> = Vec::new();
    let mut colours = 0;
    let mut unread: Vec<(Vec<u8>, usize)> = Vec::new();
    while let Some(statement) = s.next() {
        let mut words = statement.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"v") => {
                let mut p = DVec3::ZERO;
                for axis in 0..3 {
                    let word = words.next().unwrap_or_default();
                    let coordinate = parse_real(word).filter(|x| x.is_finite());
                    p[axis] = coordinate.ok_or_else(|| s.unexpected(word, "a coordinate"))?;
                }
                mesh.points.push(p);
                colours += usize::from(words.nth(2).is_some());
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
                tags.ok_or_else(|| s.fault_at(s.mark(), "A face has fewer than three vertices"))?.push(tag);
                match corners_uv[..] {
                    [a, b, c] => texture.set_triangle(mesh.triangles.len() - 1, [a, b, c]),
                    [a, b, c, d] => texture.set_quad(mesh.quads.len() - 1, [a, b, c, d]),
                    _ => texture.polygons.push(corners_uv.clone()),
                }
            }
            // A group within an object overrides it; a face in several groups belongs to the first.
            Some(b"g" | b"o") => {
                tell_empty(&mut mesh, &names, &line_names);
                names.next = words.next().map(|name| String::from_utf8_lossy(name).into_owned());
                line_names.next.clone_from(&names.next);
                words.for_each(|further| mesh.omit("further name of a group", &shown(further)));
            }
            Some(b"l") => {
                take_corners(&s, words, mesh.points.len(), "line", &mut largest, &mut corners)?;
                let tag = line_names.tag(&mut mesh);
                for ends in corners.windows(2) {
                    mesh.lines.push([ends[0], ends[1]]);
                    mesh.line_tags.push(tag);
                }
            }
            Some(keyword) => match unread.iter().position(|known| known.0 == keyword) {
                Some(at) => unread[at].1 += 1,
                None if unread.len() < MOST_UNREAD => unread.push((keyword.to_vec(), 1)),
                None => {}
            },
            None => {}
        }
    }
    if largest.0 > mesh.points.len() {
        let what = format!("A face or line refers to vertex {} of {}", largest.0, mesh.points.len());
        return Err(s.fault_at(largest.1, what));
    }
    tell_empty(&mut mesh, &names, &line_names);
    for (keyword, count) in unread {
        let about = UNREAD.iter().find(|unread| unread.0 == keyword).map(|unread| format!(" ({})", unread.1));
        mesh.omit_many("statement", &format!("{}{}", shown(&keyword), about.unwrap_or_default()), count);
    }
    if colours > 0 {
        mesh.omit_many("vertex", "colour", colours);
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
#[derive(Default)]
struct GroupNames {
    dimension: u8,
    tags: BTreeMap<String, u32>,
    /// The group of the following elements, until the first of them is read.
    next: Option<String>,
    current: u32,
}

impl GroupNames {
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

/// Tells of a group that ends without any face or line.
fn tell_empty(mesh: &mut MeshFile, names: &GroupNames, line_names: &GroupNames) {
    if let (Some(name), Some(_)) = (&names.next, &line_names.next)
        && ![names, line_names].iter().any(|names| names.tags.contains_key(name))
    {
        mesh.omit(EMPTY_GROUP, &format!("\"{}\"", shown(name.as_bytes())));
    }
}

/// Reads the vertices of a face or line into `corners`; `largest` keeps the largest number so far and its line's mark.
fn take_corners<'w>(
    s: &Statements,
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
