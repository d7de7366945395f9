//! Reading PLY. The header is brought to lines as the crate `ply-rs-bw` takes them; it parses the header and binary
//! elements. Elements in text are read here, since it wants each on one line, and no blank ones.

use glam::DVec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use super::{KINDS, SIDES};
use crate::core::fault::Fault;
use crate::core::formats::scan::{DAMAGED, Scanner, TRUNCATED, parse_integer, parse_real, parse_whole, shown};
use crate::core::progress::Pace;
use crate::core::soup::{Count, Group, MeshFile};

/// Elements parsed at a time, which bounds the parser's memory.
const BATCH: usize = 256;
/// The two names of the list of a face's corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
const AXES: [&str; 3] = ["x", "y", "z"];

/// Reads a mesh from the bytes of a PLY file: points, triangles, quadrilaterals, polygons and triangle strips, with the
/// lines, tags and names that [`write`](super::write) writes.
///
/// # Errors
/// What is wrong with the file, with the line of a text file; and faces that refer to a missing vertex.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut scanner = Scanner::new(name, bytes).watched(pace);
    let header = header(&mut scanner, bytes)?;
    check_counts(&scanner, &header)?;
    let begin = bytes.len() - scanner.left();
    let mut elements = Elements {
        header: &header,
        text: TextLines { scanner, rest: &[], surplus: 0 },
        binary: Reader::new(&bytes[begin..]),
        pace,
        whole: bytes.len(),
    };
    let mut mesh =
        MeshFile { groups: header.comments.iter().filter_map(|text| group(text)).collect(), ..MeshFile::default() };
    let is_tagged = |element: &ElementDef| element.name == "face" && element.properties.contains_key("region");
    let tagged = header.elements.values().any(is_tagged);
    let mut count = 0;
    for (kind, element) in &header.elements {
        match kind.as_str() {
            "vertex" => {
                if let Some(axis) = AXES.iter().find(|axis| !element.properties.contains_key(**axis)) {
                    return Err(Fault::new(format!("The vertices have no property \"{axis}\""))
                        .at(name)
                        .remedy("Export them with x, y and z"));
                }
                mesh.points.reserve_exact(element.count);
                elements.each(element, |vertex: Vertex| {
                    mesh.points.push(vertex.0);
                    if vertex.0.is_finite() {
                        return Ok(());
                    }
                    Err(format!("Vertex {} has a non-finite coordinate", mesh.points.len()))
                })?;
                tell_unused(&mut mesh, element, "vertex property", &|key| AXES.contains(&key));
            }
            "face" => {
                elements.each(element, |face: Face| {
                    count += 1;
                    face.into_mesh(&mut mesh, tagged, count).map_err(|what| format!("Face {count} {what}"))
                })?;
                let is_used = |key: &str| CORNERS.contains(&key) || SIDES.contains(&key) || key == "region";
                tell_unused(&mut mesh, element, "face property", &is_used);
            }
            "tristrips" => {
                elements.each(element, |strip: Face| strip.add_strips(&mut mesh, tagged, &mut count))?;
                tell_unused(&mut mesh, element, "property of strips", &|key| CORNERS.contains(&key));
            }
            _ => {
                elements.each(element, |_: Ignored| Ok(()))?;
                if element.count > 0 {
                    mesh.omit_many("element", kind, element.count);
                }
            }
        }
    }
    elements.tell_rest(&mut mesh);
    mesh.counting.shared = true;
    mesh.counting.points = Count::From(0);
    let points = mesh.points.len();
    let faces =
        mesh.triangles.as_flattened().iter().chain(mesh.quads.as_flattened()).chain(mesh.polygons.iter().flatten());
    let corners = faces.chain(mesh.lines.as_flattened());
    if let Some(corner) = corners.copied().find(|&corner| corner as usize >= points) {
        return Err(Fault::new(format!(
            "A face refers to vertex {corner}, but the last vertex is {}",
            points as i64 - 1
        ))
        .at(name));
    }
    Ok(mesh)
}

/// Reads the header; the scanner stops at the first element.
fn header(scanner: &mut Scanner, bytes: &[u8]) -> Result<Header, Fault> {
    let is_ply = "Check that it is a PLY file";
    let mut lines: Vec<&[u8]> = Vec::new();
    while lines.last().is_none_or(|line| *line != b"end_header") {
        match scanner.line() {
            Some(line) if !lines.is_empty() || line == b"ply" => lines.push(line),
            Some(_) => return Err(scanner.fault("The file does not begin with \"ply\"").remedy(is_ply)),
            None => return Err(scanner.ended("\"end_header\"")),
        }
    }
    // Where lines end with CR alone, a line feed after the header is the first byte of a binary element.
    if bytes.get(3..5).is_some_and(|end| end[0] == b'\r' && end[1] != b'\n') {
        let end = bytes.len() - scanner.left();
        if bytes[..end].ends_with(b"\r\n") {
            scanner.step_back();
        }
    }
    let mut text = Vec::new();
    for line in &lines {
        text.extend(if line.is_empty() { b"comment" } else { *line });
        text.push(b'\n');
    }
    Parser::<Ignored>::new().read_header(&mut Reader::new(&text[..])).map_err(|error: ParseError| {
        let line = error.line().and_then(|line| Some((line, lines.get(line.checked_sub(1)?)?)));
        let fault = match line {
            Some((number, line)) => Fault::new(format!("The header has a line that is not PLY: \"{}\"", shown(line)))
                .at(format!("{}, line {number}", scanner.name())),
            None => Fault::new("The header has no format that is known (ascii 1.0, binary_little_endian 1.0, ...)")
                .at(scanner.name()),
        };
        fault.remedy(is_ply)
    })
}

/// Checks that the rest of the file can hold the counts of the header, and that lists are where they are expected.
fn check_counts(scanner: &Scanner, header: &Header) -> Result<(), Fault> {
    for (kind, element) in &header.elements {
        let least: usize = match header.encoding {
            // A digit and a separator.
            Encoding::Ascii => 2 * element.properties.len(),
            _ => element.properties.values().map(|property| size(&property.data_type)).sum(),
        };
        let (count, left) = (element.count, scanner.left());
        // The last line of a text file may have no line break.
        if count.checked_mul(least).is_none_or(|bytes| bytes > left + 1) || (least == 0 && count > 0) {
            let kind = shown(kind.as_bytes());
            let what = format!("The header declares {count} elements \"{kind}\", but only {left} bytes follow");
            return Err(Fault::new(what).at(scanner.name()).remedy(TRUNCATED));
        }
        for (key, property) in &element.properties {
            let is_corners = matches!(kind.as_str(), "face" | "tristrips") && CORNERS.contains(&key.as_str());
            let is_number = match kind.as_str() {
                "vertex" => AXES.contains(&key.as_str()),
                "face" => key == "region" || SIDES.contains(&key.as_str()),
                _ => false,
            };
            let expected = match &property.data_type {
                PropertyType::List(_, ScalarType::Float | ScalarType::Double) if is_corners => {
                    "a list of whole numbers"
                }
                PropertyType::Scalar(_) if is_corners => "a list of whole numbers",
                PropertyType::List(..) if is_number => "a number",
                _ => continue,
            };
            let what = format!("The property \"{key}\" of the element \"{kind}\" is not {expected}");
            return Err(Fault::new(what).at(scanner.name()).remedy(DAMAGED));
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

fn tell_unused(mesh: &mut MeshFile, element: &ElementDef, kind: &str, is_used: &dyn Fn(&str) -> bool) {
    for key in element.properties.keys().filter(|key| element.count > 0 && !is_used(key)) {
        mesh.omit(kind, key);
    }
}

/// The elements of a file, in their order.
struct Elements<'a> {
    header: &'a Header,
    text: TextLines<'a>,
    binary: Reader<&'a [u8]>,
    pace: &'a dyn Pace,
    whole: usize,
}

impl Elements<'_> {
    /// Reads all elements of one kind.
    fn each<E: PropertyAccess>(
        &mut self,
        element: &ElementDef,
        mut take: impl FnMut(E) -> Result<(), String>,
    ) -> Result<(), Fault> {
        if self.header.encoding == Encoding::Ascii {
            for _ in 0..element.count {
                let item = self.text.element(element)?;
                take(item).map_err(|what| self.text.scanner.fault(what))?;
            }
            return Ok(());
        }
        let name = self.text.scanner.name();
        let parser = Parser::<E>::new();
        let mut part = element.clone();
        let mut left = element.count;
        while left > 0 && self.pace.goes_on(self.whole - self.binary.get_ref().len(), self.whole) {
            part.count = left.min(BATCH);
            left -= part.count;
            let items = parser.read_payload_for_element(&mut self.binary, &part, self.header).map_err(|_| {
                let what = format!("The elements \"{}\" end too early", shown(element.name.as_bytes()));
                Fault::new(what).at(name).remedy(TRUNCATED)
            })?;
            for item in items {
                take(item).map_err(|what| Fault::new(what).at(name))?;
            }
        }
        Ok(())
    }
}

impl Elements<'_> {
    /// Tells of what is left of lines, and after the last element.
    fn tell_rest(&mut self, mesh: &mut MeshFile) {
        let left = self.binary.get_ref().len();
        let is_text = self.header.encoding == Encoding::Ascii;
        if is_text && self.text.surplus > 0 {
            mesh.omit_many("values", "of no property, at the end of a line", self.text.surplus);
        }
        if is_text && self.text.scanner.word().is_some() {
            mesh.omit("lines", "after the last element");
        }
        if !is_text && left > 0 {
            mesh.omit(&format!("{left} bytes"), "after the last element");
        }
    }
}

/// The elements of a text file. Each begins on a line of its own, and may go on in the next ones.
struct TextLines<'a> {
    scanner: Scanner<'a>,
    /// What is left of the current line.
    rest: &'a [u8],
    /// Lines with more than their element has properties.
    surplus: usize,
}

impl<'a> TextLines<'a> {
    fn element<E: PropertyAccess>(&mut self, element: &ElementDef) -> Result<E, Fault> {
        let mut item = E::new();
        for (key, property) in &element.properties {
            let value = match &property.data_type {
                PropertyType::Scalar(_) => Property::Double(self.real()?),
                PropertyType::List(_, kind) => {
                    let word = self.word("a number of values")?;
                    let count = parse_whole(word)
                        .ok_or_else(|| self.scanner.unexpected(word, &format!("the length of \"{key}\"")))?;
                    if matches!(kind, ScalarType::Float | ScalarType::Double) {
                        for _ in 0..count {
                            self.real()?;
                        }
                        Property::ListDouble(Vec::new())
                    } else {
                        Property::ListInt((0..count).map(|_| self.integer()).collect::<Result<_, _>>()?)
                    }
                }
            };
            // Types are checked with the header.
            item.set_property(key, value);
        }
        self.surplus += usize::from(!self.rest.trim_ascii_start().is_empty());
        self.rest = &[];
        Ok(item)
    }

    fn word(&mut self, what: &str) -> Result<&'a [u8], Fault> {
        loop {
            self.rest = self.rest.trim_ascii_start();
            if !self.rest.is_empty() {
                let long = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
                let word;
                (word, self.rest) = self.rest.split_at(long);
                return Ok(word);
            }
            self.rest = self.scanner.line().ok_or_else(|| self.scanner.ended(what))?;
        }
    }

    fn real(&mut self) -> Result<f64, Fault> {
        let word = self.word("a number")?;
        parse_real(word).ok_or_else(|| self.scanner.unexpected(word, "a number"))
    }

    fn integer(&mut self) -> Result<i32, Fault> {
        let word = self.word("a whole number")?;
        let number = parse_integer(word).and_then(|number| i32::try_from(number).ok());
        number.ok_or_else(|| self.scanner.unexpected(word, "a whole number"))
    }
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
        let axis = AXES.iter().position(|axis| *axis == name);
        let (Some(axis), Some(value)) = (axis, number(&value)) else { return PropertyAccessResult::Ignored };
        self.0[axis] = value;
        PropertyAccessResult::Set
    }
}

/// A face, or an element of triangle strips.
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
        if CORNERS.contains(&name) {
            self.corners = match value {
                Property::ListChar(list) => list.into_iter().map(i64::from).collect(),
                Property::ListUChar(list) => list.into_iter().map(i64::from).collect(),
                Property::ListShort(list) => list.into_iter().map(i64::from).collect(),
                Property::ListUShort(list) => list.into_iter().map(i64::from).collect(),
                Property::ListInt(list) => list.into_iter().map(i64::from).collect(),
                Property::ListUInt(list) => list.into_iter().map(i64::from).collect(),
                _ => return PropertyAccessResult::UnsupportedType,
            };
            return PropertyAccessResult::Set;
        }
        let Some(value) = number(&value) else { return PropertyAccessResult::Ignored };
        match SIDES.iter().position(|side| *side == name) {
            Some(side) => self.lines[side] = value,
            None if name == "region" => self.region = value,
            None => return PropertyAccessResult::Ignored,
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

    /// Adds the triangles of strips, which -1 separates. The second triangle of a strip, the fourth and so on have
    /// their corners in the opposite order. Triangles with a corner twice, by which strips turn, are left out.
    fn add_strips(self, mesh: &mut MeshFile, tagged: bool, count: &mut u64) -> Result<(), String> {
        for strip in self.corners.split(|&corner| corner == -1) {
            for (k, corners) in strip.windows(3).enumerate() {
                let [a, b, c] = if k % 2 == 0 { [0, 1, 2] } else { [1, 0, 2] }.map(|at| corners[at]);
                if a == b || b == c || c == a {
                    continue;
                }
                *count += 1;
                let triangle = Face { corners: vec![a, b, c], ..Face::default() };
                triangle.into_mesh(mesh, tagged, *count).map_err(|what| format!("A triangle of a strip {what}"))?;
            }
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
