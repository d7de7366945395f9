//! Reading VTU.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use super::{METRIC, TAG, UV};
use crate::core::fault::Fault;
use crate::core::formats::scan::{Scanner, TRUNCATED, shown};
use crate::core::kernel::Metric3;
use crate::core::progress::Pace;
use crate::core::soup::second_order::Middles;
use crate::core::soup::{CELL_DATA, Counting, Data, Group, MeshFile, POINT_DATA};

/// A data array of the file.
struct Array {
    /// The enclosing XML element: "Points", "Cells", "PointData", "CellData" or "FieldData".
    parent: String,
    name: String,
    components: usize,
    values: Values,
    mark: usize,
}

impl Array {
    /// Whether it has a value for each of `items` items.
    fn holds(&self, items: usize) -> bool {
        self.values.len() == self.components * items
    }
}

/// Numbers, in half the memory if all are whole, such as those of cells and tags.
enum Values {
    Whole(Vec<u32>),
    Real(Vec<f64>),
}

impl Values {
    /// Reads the numbers before the next tag, with comments between them.
    fn read(s: &mut Scanner) -> Result<Values, Fault> {
        let mut part = s.part_before(b'<');
        let mut next = || -> Result<Option<f64>, Fault> {
            loop {
                match part.real_if_any()? {
                    None if is_comment(s) && s.skip_past(b"-->") => part = s.part_before(b'<'),
                    value => return Ok(value),
                }
            }
        };
        let mut whole = Vec::new();
        let mut first = None;
        while let Some(value) = next()? {
            if f64::from(value as u32).to_bits() != value.to_bits() {
                first = Some(value);
                break;
            }
            whole.push(value as u32);
        }
        let Some(first) = first else {
            whole.shrink_to_fit();
            return Ok(Values::Whole(whole));
        };
        let mut real: Vec<f64> = whole.into_iter().map(f64::from).chain([first]).collect();
        while let Some(value) = next()? {
            real.push(value);
        }
        real.shrink_to_fit();
        Ok(Values::Real(real))
    }

    fn len(&self) -> usize {
        match self {
            Values::Whole(values) => values.len(),
            Values::Real(values) => values.len(),
        }
    }

    fn at(&self, index: usize) -> f64 {
        match self {
            Values::Whole(values) => f64::from(values[index]),
            Values::Real(values) => values[index],
        }
    }

    fn into_reals(self) -> Vec<f64> {
        match self {
            Values::Whole(values) => values.into_iter().map(f64::from).collect(),
            Values::Real(values) => values,
        }
    }
}

/// Reads a mesh from the bytes of a `.vtu` file with inline text arrays; `name` is the file's name in messages.
///
/// # Errors
/// With the line: anything that is not such a file.
pub fn read(name: &str, bytes: &[u8], pace: &dyn Pace) -> Result<MeshFile, Fault> {
    let mut s = Scanner::new(name, bytes).watched(pace);
    let mut arrays = Vec::new();
    let mut parent = String::new();
    let (mut is_grid, mut pieces) = (false, 0);
    let mut omitted = Vec::new();
    loop {
        s.part_before(b'<');
        if is_comment(&s) && s.skip_past(b"-->") {
            continue;
        }
        if !s.skip_past(b"<") {
            break;
        }
        let mark = s.mark();
        let Some(tag) = s.until(b'>') else {
            return Err(s.fault_at(mark, "A tag is not closed").remedy(TRUNCATED));
        };
        let word = tag.split(|b| b.is_ascii_whitespace() || *b == b'/').next().unwrap_or_default();
        match word {
            b"VTKFile" => {
                is_grid = attribute(tag, "type").as_deref() == Some("UnstructuredGrid");
                if !is_grid || attribute(tag, "compressor").is_some() {
                    return Err(s.fault_at(mark, "This is not an uncompressed UnstructuredGrid").remedy(AS_TEXT));
                }
            }
            b"Piece" => pieces += 1,
            b"Points" | b"Cells" | b"PointData" | b"CellData" | b"FieldData" => parent = shown(word),
            b"DataArray" if !parent.is_empty() && !tag.ends_with(b"/") => {
                if parent == "FieldData" && attribute(tag, "NumberOfComponents").as_deref() != Some("2") {
                    omitted.push(("field data", attribute(tag, "Name").unwrap_or_default()));
                    continue;
                }
                if attribute(tag, "format").as_deref() != Some("ascii") {
                    return Err(s.fault_at(mark, "The array is not inline text").remedy(AS_TEXT));
                }
                let components = attribute(tag, "NumberOfComponents").and_then(|n| n.parse().ok()).unwrap_or(1);
                let values = Values::read(&mut s)?;
                let name = attribute(tag, "Name").unwrap_or_default();
                arrays.push(Array { parent: parent.clone(), name, components, values, mark });
            }
            _ => {}
        }
    }
    if !is_grid || pieces != 1 {
        let what = if is_grid { format!("The file has {pieces} pieces") } else { "This is not a VTK file".to_string() };
        return Err(Fault::new(what).at(name).remedy(AS_TEXT));
    }
    let mut mesh = assemble(&s, name, arrays)?;
    omitted.iter().for_each(|(kind, name)| mesh.omit(kind, name));
    Ok(mesh)
}

const AS_TEXT: &str = "Save it as an unstructured grid in one piece, as inline text without compression";

/// Whether a comment is next.
fn is_comment(s: &Scanner) -> bool {
    s.peek().is_some_and(|word| word.starts_with(b"<!--"))
}

/// The value of an attribute in a tag.
fn attribute(tag: &[u8], name: &str) -> Option<String> {
    let tag = std::str::from_utf8(tag).ok()?;
    let mut rest = tag.split_once(char::is_whitespace)?.1;
    loop {
        let (key, after) = rest.split_once('=')?;
        let after = after.trim_start();
        let quote = after.chars().next().filter(|c| matches!(c, '"' | '\''))?;
        let (value, after) = after[1..].split_once(quote)?;
        if key.trim() == name {
            let plain = value.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
            return Some(plain);
        }
        rest = after;
    }
}

fn assemble(s: &Scanner, name: &str, mut arrays: Vec<Array>) -> Result<MeshFile, Fault> {
    // Arrays are moved out, so that each is freed after use.
    let mut find = |parent: &str, name: &str| {
        let at = arrays.iter().position(|a| a.parent == parent && (name.is_empty() || a.name == name))?;
        Some(arrays.remove(at))
    };
    let missing = |what: &str| Fault::new(format!("There are no {what}")).at(name).remedy(AS_TEXT);
    let mut mesh = MeshFile { counting: Counting::from_zero(), ..MeshFile::default() };
    let points = find("Points", "").ok_or_else(|| missing("points"))?;
    if points.components != 3 || points.values.len() % 3 != 0 || points.values.len() / 3 >= u32::MAX as usize {
        return Err(s.fault_at(points.mark, "The points must have three coordinates each"));
    }
    mesh.points = points.values.into_reals().as_chunks().0.iter().copied().map(DVec3::from_array).collect();
    if let Some(number) = mesh.points.iter().position(|p| !p.is_finite()) {
        return Err(s.fault_at(points.mark, format!("Point {number} has a non-finite coordinate")));
    }
    let connectivity = find("Cells", "connectivity").ok_or_else(|| missing("cells"))?;
    let offsets = find("Cells", "offsets").ok_or_else(|| missing("offsets of cells"))?;
    let types = find("Cells", "types").ok_or_else(|| missing("types of cells"))?;
    if offsets.values.len() != types.values.len() {
        return Err(s.fault_at(types.mark, "The numbers of cell types and offsets differ"));
    }
    if types.values.len() >= u32::MAX as usize {
        return Err(s.fault_at(types.mark, "There are too many cells"));
    }
    // The cells of triangles, quadrilaterals and lines, to find their data.
    let (mut triangle_cells, mut quad_cells, mut line_cells) = (Vec::new(), Vec::new(), Vec::new());
    let mut skipped: BTreeMap<String, usize> = BTreeMap::new();
    let cells = types.values.len();
    let mut from = 0usize;
    let mut points_alone = 0;
    let mut middles = Middles::default();
    for cell in 0..cells {
        let (to, kind) = (offsets.values.at(cell), types.values.at(cell));
        if !(to >= from as f64 && to as usize <= connectivity.values.len()) {
            return Err(s.fault_at(offsets.mark, format!("The offset {to} of cell {cell} is out of range")));
        }
        let corners = from..to as usize;
        from = to as usize;
        let mut indices = [0; 9];
        for (index, at) in indices.iter_mut().zip(corners.clone()) {
            let corner = connectivity.values.at(at);
            if !(corner >= 0.0 && corner < mesh.points.len() as f64 && corner.fract() == 0.0) {
                let what = format!("Cell {cell} refers to point {corner}, which does not exist");
                return Err(s.fault_at(connectivity.mark, what));
            }
            *index = corner as u32;
        }
        // The kind of the element without its other nodes: those of Lagrange cells of order 2 are in the same order.
        let (plain, own) = match (kind as u8, corners.len()) {
            (21 | 68, 3) => (3, 2),
            (22 | 69, 6) | (34, 7) => (5, 3),
            (23, 8) | (28 | 70, 9) => (9, 4),
            of => of,
        };
        if own < corners.len() {
            middles.add(&indices[..own], &indices[own..corners.len()]);
        }
        match (plain, own) {
            (5, 3) => {
                mesh.counting.triangles.push(mesh.triangles.len(), cell as u64);
                mesh.triangles.push([indices[0], indices[1], indices[2]]);
                triangle_cells.push(cell as u32);
            }
            (9, 4) => {
                mesh.counting.quads.push(mesh.quads.len(), cell as u64);
                mesh.quads.push([indices[0], indices[1], indices[2], indices[3]]);
                quad_cells.push(cell as u32);
            }
            (3, 2) => {
                mesh.lines.push([indices[0], indices[1]]);
                line_cells.push(cell as u32);
            }
            (5 | 9 | 3, count) => {
                let what = format!("Cell {cell} of type {kind} has {count} points");
                return Err(s.fault_at(offsets.mark, what));
            }
            (1 | 2, _) => points_alone += 1,
            (21..=23 | 28 | 30 | 34..=36 | 68..=70 | 75..=77, _) => {
                let what = format!("Cells of order 3 or more (type {kind}, {own} points) are not supported");
                return Err(s.fault_at(types.mark, what).remedy("Save the mesh with cells of order 1 or 2"));
            }
            (other, _) => *skipped.entry(format!("VTK cell of type {other}")).or_default() += 1,
        }
    }
    mesh.skipped = skipped.into_iter().collect();
    if points_alone > 0 {
        mesh.omit_many("cell", "of points alone", points_alone);
    }
    drop((connectivity, offsets, types));
    let (points, triangles) = (mesh.points.len(), triangle_cells.len());
    let mut element_cells = triangle_cells;
    element_cells.append(&mut quad_cells);
    for array in arrays {
        match array.parent.as_str() {
            "PointData" if array.name == METRIC && matches!(array.components, 6 | 9) && array.holds(points) => {
                let values = array.values.into_reals();
                let tensors = values.chunks_exact(array.components).zip(0..).map(|(m, point)| {
                    let m = match *m {
                        [xx, yy, zz, xy, yz, xz] => Metric3 { xx, xy, xz, yy, yz, zz },
                        _ => Metric3 { xx: m[0], xy: m[1], xz: m[2], yy: m[4], yz: m[5], zz: m[8] },
                    };
                    let what =
                        || s.fault_at(array.mark, format!("The metric of point {point} is not positive definite"));
                    m.is_spd().then_some(m).ok_or_else(what)
                });
                mesh.metric = Some(tensors.collect::<Result<_, _>>()?);
            }
            "PointData" if array.name == UV && array.components == 2 && array.holds(points) => {
                mesh.uv =
                    Some(array.values.into_reals().as_chunks().0.iter().copied().map(DVec2::from_array).collect());
            }
            "PointData" if array.components == 1 && array.values.len() == points => {
                mesh.point_data.push(Data { name: array.name, values: array.values.into_reals() });
            }
            "CellData" if array.components == 1 && array.values.len() == cells => {
                let value = |&cell: &u32| array.values.at(cell as usize);
                if array.name == TAG {
                    let tags = |cells: &[u32]| cells.iter().map(|cell| value(cell) as u32).collect();
                    let (of_triangles, of_quads) = element_cells.split_at(triangles);
                    (mesh.triangle_tags, mesh.quad_tags) = (tags(of_triangles), tags(of_quads));
                    mesh.line_tags = tags(&line_cells);
                } else {
                    mesh.element_data
                        .push(Data { name: array.name, values: element_cells.iter().map(value).collect() });
                }
            }
            "FieldData" => {
                // Pairs of tag and dimension; others are ignored.
                for &[tag, dimension] in array.values.into_reals().as_chunks().0 {
                    let is_whole = |x: f64, most: f64| x.fract() == 0.0 && (0.0..=most).contains(&x);
                    if is_whole(tag, f64::from(u32::MAX)) && is_whole(dimension, 2.0) {
                        let (dimension, tag) = (dimension as u8, tag as u32);
                        mesh.groups.push(Group { dimension, tag, name: array.name.clone() });
                    }
                }
            }
            "PointData" => mesh.omit(POINT_DATA, &array.name),
            "CellData" => mesh.omit(CELL_DATA, &array.name),
            _ => mesh.omit("array of cells", &array.name),
        }
    }
    mesh.groups.sort_by_key(|group| (group.dimension, group.tag));
    middles.leave(&mut mesh);
    Ok(mesh)
}
