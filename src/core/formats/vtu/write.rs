//! Writing VTU.

use std::fmt::Display;
use std::io::{self, Write};

use super::{METRIC, TAG, UV};
use crate::core::kernel::Shortest;
use crate::core::soup::mesh_file::tag_of;
use crate::core::soup::{Data, MeshFile};

/// Writes a mesh with its data.
///
/// # Errors
/// Those of `out`.
pub fn write(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    let lines = mesh.own_lines();
    let elements = mesh.triangles.len() + mesh.quads.len();
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(out, "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">")?;
    writeln!(out, "<UnstructuredGrid>")?;
    groups(out, mesh, &lines)?;
    let (points, cells) = (mesh.points.len(), elements + lines.len());
    writeln!(out, "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">\n<PointData>")?;
    point_data(out, mesh)?;
    writeln!(out, "</PointData>\n<CellData>")?;
    cell_data(out, mesh, &lines)?;
    writeln!(out, "</CellData>\n<Points>")?;
    array(out, "Float64", "Points", &["X", "Y", "Z"], mesh.points.iter().map(|p| p.to_array().map(Shortest)))?;
    writeln!(out, "</Points>\n<Cells>")?;
    open(out, "Int64", "connectivity", &[""])?;
    mesh.triangles.iter().try_for_each(|corners| row(out, corners))?;
    mesh.quads.iter().try_for_each(|corners| row(out, corners))?;
    lines.iter().try_for_each(|&i| row(out, &mesh.lines[i]))?;
    close(out)?;
    // VTK's cell types, with their numbers of corners and of cells.
    let shapes = [(5, 3, mesh.triangles.len()), (9, 4, mesh.quads.len()), (3, 2, lines.len())];
    let each = || shapes.into_iter().flat_map(|(kind, corners, count)| std::iter::repeat_n((kind, corners), count));
    let mut offset = 0;
    open(out, "Int64", "offsets", &[""])?;
    for (_, corners) in each() {
        offset += corners;
        writeln!(out, "{offset}")?;
    }
    close(out)?;
    array(out, "UInt8", "types", &[""], each().map(|(kind, _)| [kind]))?;
    writeln!(out, "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>")
}

/// Writes the names of the face groups and of the groups of the given lines.
fn groups(out: &mut dyn Write, mesh: &MeshFile, lines: &[usize]) -> io::Result<()> {
    let mut named: Vec<(&str, Vec<[u32; 2]>)> = Vec::new();
    for group in mesh.groups_with(lines) {
        let pair = [group.tag, u32::from(group.dimension)];
        match named.iter_mut().find(|(name, _)| *name == group.name) {
            Some((_, pairs)) => pairs.push(pair),
            None => named.push((&group.name, vec![pair])),
        }
    }
    if named.is_empty() {
        return Ok(());
    }
    writeln!(out, "<FieldData>")?;
    for (name, pairs) in named {
        let (name, tuples) = (escaped(name), pairs.len());
        write!(out, "<DataArray type=\"Int64\" Name=\"{name}\" NumberOfComponents=\"2\" NumberOfTuples=\"{tuples}\" ")?;
        writeln!(out, "format=\"ascii\">")?;
        pairs.iter().try_for_each(|pair| row(out, pair))?;
        close(out)?;
    }
    writeln!(out, "</FieldData>")
}

fn point_data(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    if let Some(metric) = &mesh.metric {
        let tensors = metric.iter().map(|m| [m.xx, m.yy, m.zz, m.xy, m.yz, m.xz].map(Shortest));
        array(out, "Float64", METRIC, &["XX", "YY", "ZZ", "XY", "YZ", "XZ"], tensors)?;
    }
    if let Some(uv) = &mesh.uv {
        array(out, "Float64", UV, &["u", "v"], uv.iter().map(|p| p.to_array().map(Shortest)))?;
    }
    for members in mesh.members.iter().filter(|members| members.dimension == 0) {
        let is_in = (0..mesh.points.len() as u32).map(|k| [u8::from(members.of.binary_search(&k).is_ok())]);
        let name = if members.tag == 0 { "required".to_owned() } else { mesh.named(0, members.tag).name };
        array(out, "UInt8", &name, &[""], is_in)?;
    }
    for Data { name, values } in &mesh.point_data {
        array(out, "Float64", name, &[""], values.iter().map(|value| [Shortest(*value)]))?;
    }
    Ok(())
}

fn cell_data(out: &mut dyn Write, mesh: &MeshFile, lines: &[usize]) -> io::Result<()> {
    let of_lines = lines.iter().map(|&i| tag_of(&mesh.line_tags, i));
    if !mesh.triangle_tags.is_empty() || !mesh.quad_tags.is_empty() || !lines.is_empty() {
        array(out, "Int64", TAG, &[""], mesh.faces().map(|face| face.1).chain(of_lines).map(|tag| [tag]))?;
    }
    let faces = mesh.triangles.len() + mesh.quads.len();
    for members in mesh.members.iter().filter(|members| members.dimension > 0) {
        let own = |of_lines: bool, k: usize| {
            of_lines == (members.dimension == 1) && members.of.binary_search(&(k as u32)).is_ok()
        };
        let all = (0..faces).map(|k| own(false, k)).chain(lines.iter().map(|&k| own(true, k)));
        array(
            out,
            "UInt8",
            &mesh.named(members.dimension, members.tag).name,
            &[""],
            all.map(|is_in| [u8::from(is_in)]),
        )?;
    }
    let beside = if mesh.element_data.is_empty() { Vec::new() } else { mesh.sides_at(lines) };
    for Data { name, values } in &mesh.element_data {
        // A line without an adjacent element gets -1, since VTK does not read NaN.
        let of_lines = beside.iter().map(|element| element.map_or(-1.0, |(element, _)| values[element]));
        array(out, "Float64", name, &[""], values.iter().copied().chain(of_lines).map(|value| [Shortest(value)]))?;
    }
    Ok(())
}

fn escaped(name: &str) -> String {
    let escape = |c: char| match c {
        '&' => "&amp;".to_string(),
        '<' => "&lt;".to_string(),
        '>' => "&gt;".to_string(),
        '"' => "&quot;".to_string(),
        c if c.is_control() => "?".to_string(),
        c => c.to_string(),
    };
    name.chars().map(escape).collect()
}

/// Writes an array row by row; several components have names.
fn array<const N: usize>(
    out: &mut dyn Write,
    kind: &str,
    name: &str,
    components: &[&str],
    rows: impl Iterator<Item = [impl Display; N]>,
) -> io::Result<()> {
    open(out, kind, name, components)?;
    for values in rows {
        row(out, &values)?;
    }
    close(out)
}

fn row(out: &mut dyn Write, values: &[impl Display]) -> io::Result<()> {
    for (k, value) in values.iter().enumerate() {
        write!(out, "{}{value}", if k == 0 { "" } else { " " })?;
    }
    writeln!(out)
}

fn open(out: &mut dyn Write, kind: &str, name: &str, components: &[&str]) -> io::Result<()> {
    write!(out, "<DataArray type=\"{kind}\" Name=\"{}\" ", escaped(name))?;
    if components.len() > 1 {
        write!(out, "NumberOfComponents=\"{}\" ", components.len())?;
        for (k, component) in components.iter().enumerate() {
            write!(out, "ComponentName{k}=\"{component}\" ")?;
        }
    }
    writeln!(out, "format=\"ascii\">")
}

fn close(out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "</DataArray>")
}
