//! Abaqus input files (`.inp`): nodes, shell elements, element and node sets, and surfaces of element edges.
//! Deliberately absent: materials and steps.

mod read;

use std::collections::BTreeMap;
use std::io::{self, Write};

pub use read::read;

use crate::core::kernel::Shortest;
use crate::core::soup::MeshFile;
use crate::core::soup::mesh_file::tag_of;

/// Writes nodes (numbered from 1), triangles as S3 and quadrilaterals as S4 (numbered from 1, triangles first); an
/// ELSET for each group of elements; and for each group of lines an NSET and a SURFACE of the element edges along its
/// lines.
///
/// # Errors
/// Those of `out`.
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
    let lines: Vec<usize> = (0..mesh.lines.len()).filter(|&i| tag_of(&mesh.line_tags, i) != 0).collect();
    let mut edges: BTreeMap<u32, Vec<(usize, usize)>> = BTreeMap::new();
    for (&i, side) in lines.iter().zip(mesh.sides_at(&lines)) {
        edges.entry(tag_of(&mesh.line_tags, i)).or_default().extend(side);
    }
    for (tag, sides) in edges.into_iter().filter(|(_, sides)| !sides.is_empty()) {
        writeln!(out, "*SURFACE, TYPE=ELEMENT, NAME={}", set_name(mesh.group_name(1, tag), "CURVE", tag))?;
        for (element, side) in sides {
            writeln!(out, "{}, E{}", element + 1, side + 1)?;
        }
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

/// Writes a set, with at most 16 numbers on a line.
fn write_set(out: &mut dyn Write, keyword: &str, name: &str, numbers: &[u64]) -> io::Result<()> {
    writeln!(out, "*{keyword}, {keyword}={name}")?;
    for line in numbers.chunks(16) {
        let words: Vec<String> = line.iter().map(u64::to_string).collect();
        writeln!(out, "{}", words.join(", "))?;
    }
    Ok(())
}

/// A valid Abaqus label: a letter, then letters, digits and `_`. A name that must be changed gets the tag, to stay
/// unique.
fn set_name(name: Option<&str>, kind: &str, tag: u32) -> String {
    let Some(name) = name else { return format!("{kind}_{tag}") };
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).take(60).collect();
    if plain == name && name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        plain
    } else {
        format!("{kind}_{tag}_{plain}")
    }
}
