//! Abaqus input files (`.inp`): nodes, shell elements, element and node sets, and surfaces of element edges.
//! Deliberately absent: materials and steps.

mod read;

use std::collections::BTreeMap;
use std::io::{self, Write};

pub use read::read;

use crate::core::kernel::Shortest;
use crate::core::soup::mesh_file::tag_of;
use crate::core::soup::{Members, MeshFile};

/// Writes nodes (numbered from 1), triangles as S3 and quadrilaterals as S4 (numbered from 1, triangles first); an
/// ELSET for each group of elements; for each group of lines an NSET and a SURFACE of the element edges along its
/// lines; and an NSET for each group of points.
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
    for ((_, tag), number) in mesh.faces().zip(1..) {
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
    let further = |dimension| mesh.members.iter().filter(move |m: &&Members| m.dimension == dimension && m.tag != 0);
    let listed = |members: &Members| members.of.iter().map(|&k| u64::from(k) + 1).collect::<Vec<_>>();
    for members in further(1) {
        for &line in &members.of {
            nodes.entry(members.tag).or_default().extend(mesh.lines[line as usize].map(|node| u64::from(node) + 1));
        }
    }
    // Regions come first: of sets that overlap the reader takes the first one.
    for members in further(2) {
        if let Some(own) = elements.get_mut(&members.tag) {
            own.extend(listed(members));
            own.sort_unstable();
        }
    }
    let alone: Vec<&Members> = further(2).filter(|members| !elements.contains_key(&members.tag)).collect();
    for (tag, numbers) in elements {
        write_set(out, "ELSET", &set_name(mesh.group_name(2, tag), "SURFACE", tag), &numbers)?;
    }
    for members in alone {
        let name = set_name(mesh.group_name(2, members.tag), "SURFACE", members.tag);
        write_set(out, "ELSET", &name, &listed(members))?;
    }
    for members in further(0) {
        let name = set_name(mesh.group_name(0, members.tag), "POINT", members.tag);
        write_set(out, "NSET", &name, &listed(members))?;
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
    for members in further(1) {
        let lines: Vec<usize> = members.of.iter().map(|&i| i as usize).collect();
        edges.entry(members.tag).or_default().extend(mesh.sides_at(&lines).into_iter().flatten());
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
