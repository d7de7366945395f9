//! Abaqus input files (`.inp`): nodes, shell elements and sets of them, without materials or steps.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec3;

use super::mesh_file::{MeshFile, tag_of};
use super::numbering::{Numbering, sort_by_number};
use super::save::Shortest;
use super::scan::{Scanner, parse_integer, parse_real, shown};
use crate::core::fault::Fault;
use crate::core::progress::Pace;

/// Writes nodes (numbered from 1), triangles as S3 and quadrilaterals as S4 (numbered from 1, triangles first), an ELSET
/// for each group of elements and an NSET for each group of lines.
///
/// # Errors
/// What `out` says.
pub fn write(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    writeln!(out, "*HEADING\nquadfront\n*NODE")?;
    for (p, number) in mesh.points.iter().zip(1u64..) {
        writeln!(out, "{number}, {}, {}, {}", Shortest(p.x), Shortest(p.y), Shortest(p.z))?;
    }
    write_elements(out, "S3", 1, &mesh.triangles)?;
    write_elements(out, "S4", mesh.triangles.len() + 1, &mesh.quads)?;
    let mut elements: BTreeMap<u32, Vec<u64>> = BTreeMap::new();
    let triangle_tags = (0..mesh.triangles.len()).map(|i| tag_of(&mesh.triangle_tags, i));
    let quad_tags = (0..mesh.quads.len()).map(|i| tag_of(&mesh.quad_tags, i));
    for (tag, number) in triangle_tags.chain(quad_tags).zip(1..) {
        if tag != 0 {
            elements.entry(tag).or_default().push(number);
        }
    }
    let mut nodes: BTreeMap<u32, Vec<u64>> = BTreeMap::new();
    for (i, line) in mesh.lines.iter().enumerate() {
        let tag = tag_of(&mesh.line_tags, i);
        if tag != 0 {
            nodes.entry(tag).or_default().extend(line.iter().map(|&node| u64::from(node) + 1));
        }
    }
    for (tag, numbers) in elements {
        write_set(out, "ELSET", &set_name(mesh.group_name(2, tag), "SURFACE", tag), &numbers)?;
    }
    for (tag, mut numbers) in nodes {
        numbers.sort_unstable();
        numbers.dedup();
        write_set(out, "NSET", &set_name(mesh.group_name(1, tag), "CURVE", tag), &numbers)?;
    }
    Ok(())
}

fn write_elements<const N: usize>(out: &mut dyn Write, kind: &str, first: usize, list: &[[u32; N]]) -> io::Result<()> {
    if list.is_empty() {
        return Ok(());
    }
    writeln!(out, "*ELEMENT, TYPE={kind}")?;
    for (corners, number) in list.iter().zip(first..) {
        write!(out, "{number}")?;
        for &corner in corners {
            write!(out, ", {}", u64::from(corner) + 1)?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// A set: lines of at most sixteen numbers.
fn write_set(out: &mut dyn Write, keyword: &str, name: &str, numbers: &[u64]) -> io::Result<()> {
    writeln!(out, "*{keyword}, {keyword}={name}")?;
    for line in numbers.chunks(16) {
        let words: Vec<String> = line.iter().map(u64::to_string).collect();
        writeln!(out, "{}", words.join(", "))?;
    }
    Ok(())
}

/// A label as Abaqus takes it: a letter first, then letters, digits and `_`; unique by its tag where a name had to be
/// changed.
fn set_name(name: Option<&str>, kind: &str, tag: u32) -> String {
    let Some(name) = name else { return format!("{kind}_{tag}") };
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).take(60).collect();
    if plain == name && name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        plain
    } else {
        format!("{kind}_{tag}_{plain}")
    }
}

/// What an element type of Abaqus is to us: its number of corners, 0 for what is skipped.
fn corners_of(kind: &str) -> Result<usize, ()> {
    let shells = ["STRI", "S", "CPS", "CPE", "CPEG", "CAX", "M3D", "R3D", "SFM3D", "DS", "DC2D"];
    let lines = ["T2D", "T3D", "B2", "B3", "R2D", "RAX"];
    let letters_end =
        |prefix: &str| kind.strip_prefix(prefix).filter(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    for prefix in shells {
        if let Some(rest) = letters_end(prefix) {
            return match rest.as_bytes()[0] {
                b'3' => Ok(3),
                b'4' => Ok(4),
                _ => Err(()),
            };
        }
    }
    for prefix in lines {
        if let Some(rest) = letters_end(prefix) {
            return if rest.as_bytes()[0] == b'3' || (prefix.starts_with('B') && rest.as_bytes()[0] == b'2') {
                Err(())
            } else {
                Ok(2)
            };
        }
    }
    Ok(0)
}

/// The section that lines of data belong to.
enum Section {
    Nodes,
    Elements(usize),
    Skipped(String),
    Other,
}

/// Reads nodes and elements; sets, parts and everything else are passed over. Nodes and elements come in the order of
/// their numbers.
///
/// # Errors
/// A fault with the line for a malformed node or element, an element of higher order, and numbers that come twice.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut s = Scanner::new(name, bytes).watched(pace);
    let mut mesh = MeshFile::default();
    let (mut node_numbers, mut triangle_numbers, mut quad_numbers) = (Vec::new(), Vec::new(), Vec::new());
    let mut nodes: Option<Numbering> = None;
    let mut skipped: BTreeMap<String, usize> = BTreeMap::new();
    let mut section = Section::Other;
    let mut any = false;
    while let Some(line) = s.line() {
        if line.is_empty() || line.starts_with(b"**") {
            continue;
        }
        if let Some(keyword) = line.strip_prefix(b"*") {
            section = keyword_line(&s, keyword)?;
            if matches!(section, Section::Elements(_)) && nodes.is_none() {
                nodes = Some(number(&s, &mut node_numbers, &mut mesh.points)?);
            }
            any = true;
            continue;
        }
        let mut fields = line.split(|&b| b == b',').map(<[u8]>::trim_ascii);
        match &section {
            Section::Nodes => {
                if nodes.is_some() {
                    return Err(s.fault("Nodes come behind elements").remedy("Put all nodes first"));
                }
                node_numbers.push(whole(&s, fields.next(), "the number of a node")?);
                let mut p = DVec3::ZERO;
                for axis in 0..3 {
                    // Abaqus takes what is left out for zero.
                    let word = fields.next().filter(|word| !word.is_empty()).unwrap_or(b"0");
                    p[axis] = match parse_real(word) {
                        Some(x) if x.is_finite() => x,
                        _ => return Err(s.fault(format!("\"{}\" stands where a coordinate is expected", shown(word)))),
                    };
                }
                mesh.points.push(p);
            }
            Section::Elements(count) => {
                let number = whole(&s, fields.next(), "the number of an element")?;
                let mut corners = [0; 4];
                for corner in &mut corners[..*count] {
                    let node = whole(&s, fields.next(), "a node of the element")?;
                    *corner = nodes.as_ref().and_then(|nodes| nodes.index(node)).ok_or_else(|| {
                        s.fault(format!("Element {number} has the node {node}, which does not exist"))
                    })?;
                }
                match *count {
                    2 => mesh.lines.push([corners[0], corners[1]]),
                    3 => {
                        mesh.triangles.push([corners[0], corners[1], corners[2]]);
                        triangle_numbers.push(number);
                    }
                    _ => {
                        mesh.quads.push(corners);
                        quad_numbers.push(number);
                    }
                }
            }
            Section::Skipped(kind) => match skipped.get_mut(kind) {
                Some(count) => *count += 1,
                None => drop(skipped.insert(kind.clone(), 1)),
            },
            Section::Other => {}
        }
    }
    if !any {
        return Err(Fault::new("There is no keyword line (*NODE, ...)").at(name).remedy("Is it an Abaqus input file?"));
    }
    if nodes.is_none() {
        number(&s, &mut node_numbers, &mut mesh.points)?;
    }
    sort_by_number(&mut triangle_numbers, &mut mesh.triangles, &mut []);
    sort_by_number(&mut quad_numbers, &mut mesh.quads, &mut []);
    mesh.skipped = skipped.into_iter().collect();
    Ok(mesh)
}

/// Puts the points into the order of their numbers, which must not come twice.
fn number(s: &Scanner, numbers: &mut [u64], points: &mut [DVec3]) -> Result<Numbering, Fault> {
    sort_by_number(numbers, points, &mut []);
    Numbering::new(numbers).map_err(|twice| {
        s.fault(format!("Node {twice} comes twice before here"))
            .remedy("Parts and instances are not read: save one flat mesh")
    })
}

fn whole(s: &Scanner, field: Option<&[u8]>, what: &str) -> Result<u64, Fault> {
    let word = field.unwrap_or_default();
    let value = parse_integer(word).and_then(|value| u64::try_from(value).ok());
    value.ok_or_else(|| s.fault(format!("\"{}\" stands where {what} is expected", shown(word))))
}

/// What a keyword line begins.
fn keyword_line(s: &Scanner, line: &[u8]) -> Result<Section, Fault> {
    let text = String::from_utf8_lossy(line).to_ascii_uppercase();
    let mut parts = text.split(',').map(str::trim);
    match parts.next() {
        Some("NODE") => Ok(Section::Nodes),
        Some("ELEMENT") => {
            let kind = parts
                .filter_map(|part| part.split_once('='))
                .find(|(key, _)| key.trim() == "TYPE")
                .map(|(_, kind)| shown(kind.trim().as_bytes()))
                .ok_or_else(|| s.fault("*ELEMENT has no TYPE"))?;
            match corners_of(&kind) {
                Ok(0) => Ok(Section::Skipped(format!("element {kind}"))),
                Ok(count) => Ok(Section::Elements(count)),
                Err(()) => Err(s
                    .fault(format!("Elements of type {kind} are not read"))
                    .remedy("Save the mesh with elements of order 1 (S3, S4)")),
            }
        }
        _ => Ok(Section::Other),
    }
}
