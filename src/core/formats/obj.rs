//! Wavefront OBJ: vertices, faces with texture coordinates, lines, and their groups or objects. Deliberately absent:
//! everything else (normals, materials), which is told as not read. The crate `tobj` is the reader, behind a pass that
//! gives it clean lines and keeps what it does not.

mod clean_lines;
mod read;
mod statements;

use std::io::{self, Write};

pub use read::read;

use crate::core::kernel::Shortest;
use crate::core::soup::MeshFile;
use crate::core::soup::mesh_file::tag_of;

/// Writes points, triangles and quadrilaterals, and the lines of named groups, with the names of their groups.
///
/// # Errors
/// Those of `out`.
pub fn write(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    for p in &mesh.points {
        writeln!(out, "v {} {} {}", Shortest(p.x), Shortest(p.y), Shortest(p.z))?;
    }
    let mut group = None;
    for (face, tag) in mesh.faces() {
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
