//! PLY (Stanford): the elements `vertex` and `face`, in text or binary; the crate `ply-rs-bw` parses. Tags are
//! properties of faces: `region`, and `line1` to `line4` for lines along their sides (the first from the first corner
//! to the second; 0 for none). Names of groups are comments (`comment region 7 left plate`). Deliberately absent: all
//! other elements (edges among them, which common readers refuse) and properties, colours and normals; triangle strips
//! are counted as skipped.

use std::io::{self, Write};

use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};
use rustc_hash::FxHashMap;

use super::scan::{TRUNCATED, shown};
use crate::core::fault::Fault;
use crate::core::kernel::Shortest;
use crate::core::progress::Pace;
use crate::core::soup::mesh_file::tag_of;
use crate::core::soup::{Count, Group, MeshFile};

/// Elements parsed at a time, which bounds the parser's memory.
const BATCH: usize = 256;
/// Dimensions of groups and their keywords in comments.
const KINDS: [(u8, &str); 2] = [(1, "line"), (2, "region")];
/// Face properties: the tags of lines along the sides.
const SIDES: [&str; 4] = ["line1", "line2", "line3", "line4"];

/// Reads a mesh from the bytes of a PLY file: points, triangles, quadrilaterals and polygons, with the lines, tags and
/// names that [`write`](fn@write) writes.
///
/// # Errors
/// What is wrong with the file, with the line of a text file; and faces that refer to a missing vertex.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut reader = Reader::new(bytes);
    let header = Parser::<Ignored>::new().read_header(&mut reader).map_err(|error| parse_fault(name, &error, true))?;
    check_counts(name, &header, reader.get_ref().len())?;
    let mut mesh =
        MeshFile { groups: header.comments.iter().filter_map(|text| group(text)).collect(), ..MeshFile::default() };
    let mut go_on = |reader: &Reader<&[u8]>| pace.goes_on(bytes.len() - reader.get_ref().len(), bytes.len());
    for (kind, element) in &header.elements {
        match kind.as_str() {
            "vertex" => {
                for axis in ["x", "y", "z"] {
                    if !element.properties.contains_key(axis) {
                        return Err(Fault::new(format!("The vertices have no property \"{axis}\""))
                            .at(name)
                            .remedy("Export them with x, y and z"));
                    }
                }
                mesh.points.reserve_exact(element.count);
                each(name, &header, element, &mut reader, &mut go_on, |vertex: Vertex| {
                    if vertex.0.is_finite() {
                        mesh.points.push(vertex.0);
                        return Ok(());
                    }
                    let what = format!("Vertex {} has a non-finite coordinate", mesh.points.len() + 1);
                    Err(Fault::new(what).at(name))
                })?;
            }
            "face" => {
                let tagged = element.properties.contains_key("region");
                let mut count = 0;
                each(name, &header, element, &mut reader, &mut go_on, |face: Face| {
                    count += 1;
                    face.into_mesh(&mut mesh, tagged, count)
                        .map_err(|what| Fault::new(format!("Face {count} {what}")).at(name))
                })?;
            }
            _ => {
                each(name, &header, element, &mut reader, &mut go_on, |_: Ignored| Ok(()))?;
                if kind == "tristrips" {
                    mesh.skipped.push(("triangle strip".to_owned(), element.count));
                }
            }
        }
    }
    mesh.counting.shared = true;
    mesh.counting.points = Count::From(0);
    let points = mesh.points.len();
    let elements =
        mesh.triangles.as_flattened().iter().chain(mesh.quads.as_flattened()).chain(mesh.polygons.iter().flatten());
    let corners = elements.chain(mesh.lines.as_flattened());
    if let Some(corner) = corners.copied().find(|&corner| corner as usize >= points) {
        return Err(Fault::new(format!(
            "A face refers to vertex {corner}, but the last vertex is {}",
            points as i64 - 1
        ))
        .at(name));
    }
    Ok(mesh)
}

/// Checks that the rest of the file can hold the counts of the header.
fn check_counts(name: &str, header: &Header, left: usize) -> Result<(), Fault> {
    for (kind, element) in &header.elements {
        let least: usize = match header.encoding {
            // A digit and a separator.
            Encoding::Ascii => 2 * element.properties.len(),
            _ => element.properties.values().map(|property| size(&property.data_type)).sum(),
        };
        // The last line of a text file may have no line break.
        if element.count.checked_mul(least).is_none_or(|bytes| bytes > left + 1) || (least == 0 && element.count > 0) {
            let (count, kind) = (element.count, shown(kind.as_bytes()));
            let what = format!("The header declares {count} elements \"{kind}\", but only {left} bytes follow");
            return Err(Fault::new(what).at(name).remedy(TRUNCATED));
        }
    }
    Ok(())
}

/// Least number of bytes of a property in a binary file.
fn size(kind: &PropertyType) -> usize {
    let (PropertyType::Scalar(scalar) | PropertyType::List(scalar, _)) = kind;
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Parses all elements of one kind.
fn each<E: PropertyAccess>(
    name: &str,
    header: &Header,
    element: &ElementDef,
    reader: &mut Reader<&[u8]>,
    go_on: &mut dyn FnMut(&Reader<&[u8]>) -> bool,
    mut take: impl FnMut(E) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let parser = Parser::<E>::new();
    let mut part = element.clone();
    let mut left = element.count;
    while left > 0 && go_on(reader) {
        part.count = left.min(BATCH);
        left -= part.count;
        let text = header.encoding == Encoding::Ascii;
        let parsed =
            parser.read_payload_for_element(reader, &part, header).map_err(|error| parse_fault(name, &error, text))?;
        parsed.into_iter().try_for_each(&mut take)?;
    }
    Ok(())
}

/// The parser's error as a fault of one line, without the parser's own prefixes.
fn parse_fault(name: &str, error: &ParseError, text: bool) -> Fault {
    let message = error.to_string();
    let message = message.rsplit("Error: ").next().unwrap_or_default().lines().next().unwrap_or_default();
    let message =
        message.split_once(": ").filter(|(line, _)| line.starts_with("Line ")).map_or(message, |(_, rest)| rest);
    let mut what: String = message.chars().filter(|c| !c.is_control()).take(160).collect();
    if what.is_empty() {
        what = "This is not PLY".to_owned();
    }
    let place = match error.line() {
        Some(line) if text => format!("{name}, line {line}"),
        _ => name.to_owned(),
    };
    Fault::new(what.trim_end_matches('.')).at(place)
}

/// An element that is not read.
struct Ignored;

impl PropertyAccess for Ignored {
    fn new() -> Self {
        Ignored
    }
}

#[derive(Default)]
struct Vertex(DVec3);

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Vertex::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        match number(&value) {
            Some(value) => self.0[axis] = value,
            None => return PropertyAccessResult::UnsupportedType,
        }
        PropertyAccessResult::Set
    }
}

#[derive(Default)]
struct Face {
    corners: Vec<i64>,
    region: f64,
    lines: [f64; 4],
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Face::default()
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        match name {
            "vertex_indices" | "vertex_index" => match value {
                Property::ListChar(list) => self.corners = list.into_iter().map(i64::from).collect(),
                Property::ListUChar(list) => self.corners = list.into_iter().map(i64::from).collect(),
                Property::ListShort(list) => self.corners = list.into_iter().map(i64::from).collect(),
                Property::ListUShort(list) => self.corners = list.into_iter().map(i64::from).collect(),
                Property::ListInt(list) => self.corners = list.into_iter().map(i64::from).collect(),
                Property::ListUInt(list) => self.corners = list.into_iter().map(i64::from).collect(),
                _ => return PropertyAccessResult::UnsupportedType,
            },
            "region" => match number(&value) {
                Some(value) => self.region = value,
                None => return PropertyAccessResult::UnsupportedType,
            },
            _ => {
                let side = SIDES.iter().position(|side| *side == name);
                let (Some(side), Some(value)) = (side, number(&value)) else { return PropertyAccessResult::Ignored };
                self.lines[side] = value;
            }
        }
        PropertyAccessResult::Set
    }
}

impl Face {
    fn into_mesh(self, mesh: &mut MeshFile, tagged: bool, number: u64) -> Result<(), String> {
        let corners: Option<Vec<u32>> = self.corners.iter().map(|&corner| u32::try_from(corner).ok()).collect();
        let corners = corners.ok_or("refers to a negative vertex")?;
        for (k, line) in self.lines.into_iter().enumerate().filter(|(k, line)| *line >= 1.0 && *k < corners.len()) {
            mesh.lines.push([corners[k], corners[(k + 1) % corners.len()]]);
            mesh.line_tags.push(line as u32);
        }
        let tags = mesh.push_face(&corners, number).ok_or("has fewer than three vertices")?;
        if tagged {
            // The cast saturates.
            tags.push(self.region as u32);
        }
        Ok(())
    }
}

/// The group declared by a comment.
fn group(comment: &str) -> Option<Group> {
    let (kind, rest) = comment.trim().split_once(' ')?;
    let dimension = KINDS.iter().find(|(_, word)| *word == kind)?.0;
    let (tag, name) = rest.trim().split_once(' ')?;
    Some(Group { dimension, tag: tag.parse().ok()?, name: name.trim().to_owned() })
}

fn number(value: &Property) -> Option<f64> {
    Some(match *value {
        Property::Char(x) => f64::from(x),
        Property::UChar(x) => f64::from(x),
        Property::Short(x) => f64::from(x),
        Property::UShort(x) => f64::from(x),
        Property::Int(x) => f64::from(x),
        Property::UInt(x) => f64::from(x),
        Property::Float(x) => f64::from(x),
        Property::Double(x) => x,
        _ => return None,
    })
}

/// Writes points, triangles and quadrilaterals as text, in double precision, with tags as `region`; lines of named
/// groups as tags of the side of their first face; and the names of the groups as comments.
///
/// # Errors
/// Those of `out`.
pub fn write(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    let lines = mesh.own_lines();
    writeln!(out, "ply\nformat ascii 1.0")?;
    for Group { dimension, tag, name } in mesh.groups_with(&lines) {
        let kind = KINDS.iter().find(|(known, _)| known == dimension).map_or("", |(_, kind)| kind);
        let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        writeln!(out, "comment {kind} {tag} {name}")?;
    }
    writeln!(out, "element vertex {}", mesh.points.len())?;
    writeln!(out, "property double x\nproperty double y\nproperty double z")?;
    writeln!(out, "element face {}", mesh.triangles.len() + mesh.quads.len())?;
    writeln!(out, "property list uchar int vertex_indices\nproperty uint region")?;
    let mut tags_of_sides: FxHashMap<usize, [u32; 4]> = FxHashMap::default();
    for (&i, side) in lines.iter().zip(mesh.sides_at(&lines)) {
        if let Some((face, side)) = side {
            tags_of_sides.entry(face).or_default()[side] = tag_of(&mesh.line_tags, i);
        }
    }
    if !lines.is_empty() {
        SIDES.iter().try_for_each(|side| writeln!(out, "property uint {side}"))?;
    }
    writeln!(out, "end_header")?;
    let tags = |out: &mut dyn Write, face: usize, tag: u32| {
        write!(out, " {tag}")?;
        if !lines.is_empty() {
            let [a, b, c, d] = tags_of_sides.get(&face).copied().unwrap_or_default();
            write!(out, " {a} {b} {c} {d}")?;
        }
        writeln!(out)
    };
    for p in &mesh.points {
        writeln!(out, "{} {} {}", Shortest(p.x), Shortest(p.y), Shortest(p.z))?;
    }
    for (i, [a, b, c]) in mesh.triangles.iter().enumerate() {
        write!(out, "3 {a} {b} {c}")?;
        tags(out, i, tag_of(&mesh.triangle_tags, i))?;
    }
    for (i, [a, b, c, d]) in mesh.quads.iter().enumerate() {
        write!(out, "4 {a} {b} {c} {d}")?;
        tags(out, mesh.triangles.len() + i, tag_of(&mesh.quad_tags, i))?;
    }
    Ok(())
}
