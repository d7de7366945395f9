//! PLY (Stanford): the elements `vertex`, `face` and `tristrips`, in text or binary. Tags are properties of faces:
//! `region`, and `line1` to `line4` for lines along their sides (the first from the first corner to the second; 0 for
//! none). Names of groups are comments (`comment region 7 left plate`). Deliberately absent: all other elements (edges
//! among them, which common readers refuse) and properties, colours and normals, which are told as not read.

mod read;

use std::io::{self, Write};

pub use read::read;
use rustc_hash::FxHashMap;

use crate::core::kernel::Shortest;
use crate::core::soup::mesh_file::tag_of;
use crate::core::soup::{Group, MeshFile};

/// Dimensions of groups and their keywords in comments.
const KINDS: [(u8, &str); 2] = [(1, "line"), (2, "region")];
/// Face properties: the tags of lines along the sides.
const SIDES: [&str; 4] = ["line1", "line2", "line3", "line4"];

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
    for p in &mesh.points {
        writeln!(out, "{} {} {}", Shortest(p.x), Shortest(p.y), Shortest(p.z))?;
    }
    for (i, (corners, tag)) in mesh.faces().enumerate() {
        write!(out, "{}", corners.len())?;
        corners.iter().try_for_each(|corner| write!(out, " {corner}"))?;
        write!(out, " {tag}")?;
        if !lines.is_empty() {
            let [a, b, c, d] = tags_of_sides.get(&i).copied().unwrap_or_default();
            write!(out, " {a} {b} {c} {d}")?;
        }
        writeln!(out)?;
    }
    Ok(())
}
