//! Writing MSH as text.

use std::io::{self, Write};

use glam::DVec3;

use super::METRIC;
use crate::core::kernel::Shortest;
use crate::core::soup::mesh_file::{ELEMENT_ID, tag_of};
use crate::core::soup::{Group, MeshFile};

/// The version to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// 2.2: one list of nodes, one of elements.
    V2,
    /// 4.1: nodes and elements in blocks by entity.
    V4,
}

/// Writes a mesh as MSH text. Nodes are numbered from 1 in the order of the points, elements from 1: lines, triangles,
/// quadrilaterals. Tags become physical groups; in version 4.1 each tag also becomes a discrete entity of its
/// dimension.
///
/// # Errors
/// Those of `out`.
pub fn write(out: &mut dyn Write, mesh: &MeshFile, version: Version) -> io::Result<()> {
    let number = if version == Version::V2 { "2.2" } else { "4.1" };
    writeln!(out, "$MeshFormat\n{number} 0 8\n$EndMeshFormat")?;
    physical_names(out, &mesh.groups)?;
    let entities = (version == Version::V4).then(|| Entities::of(mesh));
    match &entities {
        None => {
            nodes_2(out, mesh)?;
            elements_2(out, mesh)?;
        }
        Some(entities) => {
            entities.write(out, mesh)?;
            entities.write_nodes(out, mesh)?;
            entities.write_elements(out, mesh)?;
        }
    }
    // Readers that use the order of nodes and elements instead of their tags (meshio) need data in the order in which
    // those are written.
    let nodes: Vec<usize> = match &entities {
        None => (0..mesh.points.len()).collect(),
        Some(entities) => entities.nodes.iter().flatten().map(|&node| node as usize).collect(),
    };
    point_data(out, mesh, &nodes)?;
    // meshio (5.3) refuses version 2.2 with element data. The data of states on the way are worth that, the ids are
    // not.
    for data in mesh.element_data.iter().filter(|data| version == Version::V4 || data.name != ELEMENT_ID) {
        data_header(out, "ElementData", &data.name, 1, mesh.lines.len() + data.values.len())?;
        // They need a value for each line too. Gmsh ignores NaN.
        let kinds = ElementType::all(mesh);
        let mut value = |kind: usize, i: usize| {
            let element = kinds[kind].before + i;
            let value = element.checked_sub(mesh.lines.len()).map_or(f64::NAN, |i| data.values[i]);
            writeln!(out, "{} {}", element + 1, Shortest(value))
        };
        match &entities {
            None => {
                for (kind, elements) in kinds.iter().enumerate() {
                    (0..elements.count).try_for_each(|i| value(kind, i))?;
                }
            }
            Some(entities) => {
                for (entity, lists) in entities.list.iter().zip(&entities.elements) {
                    for (place, list) in lists.iter().enumerate() {
                        let kind = if entity.0 == 1 { 0 } else { 1 + place };
                        list.iter().try_for_each(|&i| value(kind, i as usize))?;
                    }
                }
            }
        }
        writeln!(out, "$EndElementData")?;
    }
    Ok(())
}

/// Writes the metric and the data of points, in this order of the points.
fn point_data(out: &mut dyn Write, mesh: &MeshFile, order: &[usize]) -> io::Result<()> {
    if let Some(metric) = &mesh.metric {
        data_header(out, "NodeData", METRIC, 9, metric.len())?;
        for &node in order {
            let m = &metric[node];
            let rows = [m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz];
            write!(out, "{}", node + 1)?;
            for value in rows {
                write!(out, " {}", Shortest(value))?;
            }
            writeln!(out)?;
        }
        writeln!(out, "$EndNodeData")?;
    }
    for data in &mesh.point_data {
        data_header(out, "NodeData", &data.name, 1, data.values.len())?;
        for &node in order {
            writeln!(out, "{} {}", node + 1, Shortest(data.values[node]))?;
        }
        writeln!(out, "$EndNodeData")?;
    }
    Ok(())
}

/// A name in quotes, on one line.
fn quoted(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c == '"' || c.is_control() { '\'' } else { c }).collect();
    format!("\"{plain}\"")
}

fn physical_names(out: &mut dyn Write, groups: &[Group]) -> io::Result<()> {
    if groups.is_empty() {
        return Ok(());
    }
    writeln!(out, "$PhysicalNames\n{}", groups.len())?;
    for group in groups {
        writeln!(out, "{} {} {}", group.dimension, group.tag, quoted(&group.name))?;
    }
    writeln!(out, "$EndPhysicalNames")
}

fn data_header(out: &mut dyn Write, section: &str, name: &str, components: usize, count: usize) -> io::Result<()> {
    writeln!(out, "${section}\n1\n{}\n1\n0\n3\n0\n{components}\n{count}", quoted(name))
}

fn point(out: &mut dyn Write, p: DVec3) -> io::Result<()> {
    writeln!(out, "{} {} {}", Shortest(p.x), Shortest(p.y), Shortest(p.z))
}

fn corners(out: &mut dyn Write, corners: &[u32]) -> io::Result<()> {
    for &corner in corners {
        write!(out, " {}", u64::from(corner) + 1)?;
    }
    writeln!(out)
}

fn nodes_2(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    writeln!(out, "$Nodes\n{}", mesh.points.len())?;
    for (&p, number) in mesh.points.iter().zip(1..) {
        write!(out, "{number} ")?;
        point(out, p)?;
    }
    writeln!(out, "$EndNodes")
}

fn elements_2(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    let kinds = ElementType::all(mesh);
    writeln!(out, "$Elements\n{}", kinds.iter().map(|kind| kind.count).sum::<usize>())?;
    for kind in kinds {
        for i in 0..kind.count {
            let tag = tag_of(kind.tags, i);
            // The second tag is the entity: one for each group.
            write!(out, "{} {} 2 {tag} {}", kind.before + i + 1, kind.number, tag.max(1))?;
            corners(out, (kind.corners)(mesh, i))?;
        }
    }
    writeln!(out, "$EndElements")
}

/// The elements of one type.
struct ElementType<'a> {
    /// Gmsh's number of the type.
    number: u8,
    dimension: usize,
    count: usize,
    tags: &'a [u32],
    /// Number of elements before them.
    before: usize,
    corners: fn(&MeshFile, usize) -> &[u32],
}

impl ElementType<'_> {
    fn all(mesh: &MeshFile) -> [ElementType<'_>; 3] {
        let (lines, triangles) = (mesh.lines.len(), mesh.triangles.len());
        let of = |number, dimension, count, tags, before, corners| ElementType {
            number,
            dimension,
            count,
            tags,
            before,
            corners,
        };
        [
            of(1, 1, lines, &mesh.line_tags[..], 0, |mesh: &MeshFile, i: usize| &mesh.lines[i][..]),
            of(2, 2, triangles, &mesh.triangle_tags, lines, |mesh, i| &mesh.triangles[i]),
            of(3, 2, mesh.quads.len(), &mesh.quad_tags, lines + triangles, |mesh, i| &mesh.quads[i]),
        ]
    }
}

/// One discrete entity for each dimension and tag, with the nodes classified on it.
struct Entities {
    /// Dimension and tag, ascending: curves before surfaces, so that a shared node belongs to the curve.
    list: Vec<(usize, u32)>,
    /// The elements of each entity: lines or triangles, then quadrilaterals, by index.
    elements: Vec<[Vec<u32>; 2]>,
    /// The nodes of each entity.
    nodes: Vec<Vec<u32>>,
}

impl Entities {
    fn of(mesh: &MeshFile) -> Self {
        let kinds = ElementType::all(mesh);
        let mut list: Vec<(usize, u32)> = Vec::new();
        for kind in &kinds {
            let mut tags: Vec<u32> = (0..kind.count).map(|i| tag_of(kind.tags, i)).collect();
            tags.sort_unstable();
            tags.dedup();
            list.extend(tags.iter().map(|&tag| (kind.dimension, tag)));
        }
        if list.is_empty() && !mesh.points.is_empty() {
            list.push((2, 0));
        }
        list.sort_unstable();
        list.dedup();
        let mut elements = vec![[Vec::new(), Vec::new()]; list.len()];
        let mut owner = vec![u32::MAX; mesh.points.len()];
        for (k, kind) in kinds.iter().enumerate() {
            for i in 0..kind.count {
                let entity = list.partition_point(|&known| known < (kind.dimension, tag_of(kind.tags, i)));
                elements[entity][usize::from(k == 2)].push(i as u32);
                for &corner in (kind.corners)(mesh, i) {
                    let owner = &mut owner[corner as usize];
                    *owner = (*owner).min(entity as u32);
                }
            }
        }
        let mut nodes = vec![Vec::new(); list.len()];
        for (node, owner) in (0u32..).zip(owner) {
            // A node without elements belongs to the last entity.
            let entity = if owner == u32::MAX { list.len() - 1 } else { owner as usize };
            nodes[entity].push(node);
        }
        Entities { list, elements, nodes }
    }

    /// The tag of an entity: that of its group, or without a group, the first free one.
    fn tag(&self, (dimension, tag): (usize, u32)) -> u64 {
        if tag > 0 {
            return u64::from(tag);
        }
        1 + self.list.iter().filter(|entity| entity.0 == dimension).map(|entity| u64::from(entity.1)).max().unwrap_or(0)
    }

    fn write(&self, out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
        let kinds = ElementType::all(mesh);
        let curves = self.list.iter().filter(|entity| entity.0 == 1).count();
        writeln!(out, "$Entities\n0 {curves} {} 0", self.list.len() - curves)?;
        for (&entity, elements) in self.list.iter().zip(&self.elements) {
            let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for (place, list) in elements.iter().enumerate() {
                let kind = &kinds[if entity.0 == 1 { 0 } else { 1 + place }];
                for &i in list {
                    for &corner in (kind.corners)(mesh, i as usize) {
                        let p = mesh.points[corner as usize];
                        (low, high) = (low.min(p), high.max(p));
                    }
                }
            }
            if low.x > high.x {
                (low, high) = (DVec3::ZERO, DVec3::ZERO);
            }
            write!(out, "{}", self.tag(entity))?;
            for value in [low.x, low.y, low.z, high.x, high.y, high.z] {
                write!(out, " {}", Shortest(value))?;
            }
            // Discrete entities have no bounding entities.
            match entity.1 {
                0 => writeln!(out, " 0 0")?,
                tag => writeln!(out, " 1 {tag} 0")?,
            }
        }
        writeln!(out, "$EndEntities")
    }

    fn write_nodes(&self, out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
        let count = mesh.points.len();
        let blocks = self.nodes.iter().filter(|nodes| !nodes.is_empty()).count();
        writeln!(out, "$Nodes\n{blocks} {count} {} {count}", count.min(1))?;
        for (&entity, nodes) in self.list.iter().zip(&self.nodes).filter(|(_, nodes)| !nodes.is_empty()) {
            writeln!(out, "{} {} 0 {}", entity.0, self.tag(entity), nodes.len())?;
            for &node in nodes {
                writeln!(out, "{}", u64::from(node) + 1)?;
            }
            for &node in nodes {
                point(out, mesh.points[node as usize])?;
            }
        }
        writeln!(out, "$EndNodes")
    }

    fn write_elements(&self, out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
        let kinds = ElementType::all(mesh);
        let count: usize = kinds.iter().map(|kind| kind.count).sum();
        let blocks: usize = self.elements.iter().flatten().filter(|list| !list.is_empty()).count();
        writeln!(out, "$Elements\n{blocks} {count} {} {count}", count.min(1))?;
        for (&entity, elements) in self.list.iter().zip(&self.elements) {
            for (place, list) in elements.iter().enumerate().filter(|(_, list)| !list.is_empty()) {
                let kind = &kinds[if entity.0 == 1 { 0 } else { 1 + place }];
                writeln!(out, "{} {} {} {}", entity.0, self.tag(entity), kind.number, list.len())?;
                for &i in list {
                    write!(out, "{}", kind.before + i as usize + 1)?;
                    corners(out, (kind.corners)(mesh, i as usize))?;
                }
            }
        }
        writeln!(out, "$EndElements")
    }
}
