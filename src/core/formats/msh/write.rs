//! Writing MSH as text.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec3;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

use super::METRIC;
use crate::core::kernel::Shortest;
use crate::core::soup::mesh_file::{ELEMENT_ID, tag_of};
use crate::core::soup::{Group, Members, MeshFile};

/// The version to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// 2.2: one list of nodes, one of elements.
    V2,
    /// 4.1: nodes and elements in blocks by entity.
    V4,
}

/// Writes a mesh as MSH text. Nodes are numbered from 1 in the order of the points, elements from 1: lines, triangles,
/// quadrilaterals, points in groups. Tags become physical groups; in version 4.1 the elements of the same groups also
/// become a discrete entity of their dimension. Version 2.2 has no room for further groups of an element.
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
        let points = grouped_points(mesh, version);
        let others = mesh.lines.len() + data.values.len();
        data_header(out, "ElementData", &data.name, 1, others + points.len())?;
        let of_points = |out: &mut dyn Write| (1..=points.len()).try_for_each(|k| writeln!(out, "{} NaN", others + k));
        if version == Version::V4 {
            of_points(out)?;
        }
        // They need a value for each line too. Gmsh ignores NaN.
        let kinds = ElementType::all(mesh);
        let value = |out: &mut dyn Write, kind: usize, i: usize| {
            let element = kinds[kind].before + i;
            let value = element.checked_sub(mesh.lines.len()).map_or(f64::NAN, |i| data.values[i]);
            writeln!(out, "{} {}", element + 1, Shortest(value))
        };
        match &entities {
            None => {
                for (kind, elements) in kinds.iter().enumerate() {
                    (0..elements.count).try_for_each(|i| value(out, kind, i))?;
                }
                of_points(out)?;
            }
            Some(entities) => {
                for (entity, lists) in entities.list.iter().zip(&entities.elements) {
                    for (place, list) in lists.iter().enumerate() {
                        let kind = if entity.0 == 1 { 0 } else { 1 + place };
                        list.iter().try_for_each(|&i| value(out, kind, i as usize))?;
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

/// The points in groups, with these: in version 2.2 once for each group, in 4.1 once.
fn grouped_points(mesh: &MeshFile, version: Version) -> Vec<(u32, Groups)> {
    let mut points: BTreeMap<u32, Groups> = BTreeMap::new();
    for members in mesh.members.iter().filter(|members| members.dimension == 0 && members.tag != 0) {
        members.of.iter().for_each(|&point| points.entry(point).or_default().push(members.tag));
    }
    match version {
        Version::V4 => points.into_iter().collect(),
        Version::V2 => points
            .into_iter()
            .flat_map(|(k, tags)| tags.into_iter().map(move |tag| (k, Groups::from_slice(&[tag]))))
            .collect(),
    }
}

fn elements_2(out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
    let kinds = ElementType::all(mesh);
    let points = grouped_points(mesh, Version::V2);
    let others = kinds.iter().map(|kind| kind.count).sum::<usize>();
    writeln!(out, "$Elements\n{}", others + points.len())?;
    for kind in kinds {
        for i in 0..kind.count {
            let tag = tag_of(kind.tags, i);
            // The second tag is the entity: one for each group.
            write!(out, "{} {} 2 {tag} {}", kind.before + i + 1, kind.number, tag.max(1))?;
            corners(out, (kind.corners)(mesh, i))?;
        }
    }
    for (k, (point, tags)) in points.iter().enumerate() {
        write!(out, "{} {POINT} 2 {} {}", others + k + 1, tags[0], k + 1)?;
        corners(out, &[*point])?;
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

/// The tags of the groups of an element, ascending; empty without any.
type Groups = SmallVec<[u32; 2]>;

/// Gmsh's number of a point element.
const POINT: u8 = 15;

/// One discrete entity for each dimension and set of groups, with the nodes classified on it; and one for each point in
/// a group.
struct Entities {
    points: Vec<(u32, Groups)>,
    /// Dimension and groups, ascending: curves before surfaces, so that a shared node belongs to the curve.
    list: Vec<(usize, Groups)>,
    /// The elements of each entity: lines or triangles, then quadrilaterals, by index.
    elements: Vec<[Vec<u32>; 2]>,
    /// The nodes of each point, then of each entity.
    nodes: Vec<Vec<u32>>,
}

impl Entities {
    fn of(mesh: &MeshFile) -> Self {
        let kinds = ElementType::all(mesh);
        let mut further: FxHashMap<(usize, usize), Groups> = FxHashMap::default();
        for Members { dimension, tag, of } in mesh.members.iter().filter(|members| members.dimension > 0) {
            let in_group = of.iter().map(|&i| (usize::from(*dimension), i as usize));
            in_group.for_each(|element| further.entry(element).or_default().push(*tag));
        }
        let groups = |k: usize, i: usize| -> Groups {
            let mut groups: Groups = Some(tag_of(kinds[k].tags, i)).filter(|&tag| tag != 0).into_iter().collect();
            // Members count quadrilaterals after triangles.
            let place = if k == 2 { kinds[1].count + i } else { i };
            groups.extend(further.get(&(kinds[k].dimension, place)).into_iter().flatten().copied());
            groups.sort_unstable();
            groups
        };
        let mut list: Vec<(usize, Groups)> = Vec::new();
        for (k, kind) in kinds.iter().enumerate() {
            let mut own: Vec<Groups> = (0..kind.count).map(|i| groups(k, i)).collect();
            own.sort_unstable();
            own.dedup();
            list.extend(own.into_iter().map(|groups| (kind.dimension, groups)));
        }
        if list.is_empty() && !mesh.points.is_empty() {
            list.push((2, Groups::new()));
        }
        list.sort_unstable();
        list.dedup();
        let points = grouped_points(mesh, Version::V4);
        let mut elements = vec![[Vec::new(), Vec::new()]; list.len()];
        let mut owner = vec![u32::MAX; mesh.points.len()];
        for (k, kind) in kinds.iter().enumerate() {
            for i in 0..kind.count {
                let own = (kind.dimension, groups(k, i));
                let entity = list.partition_point(|known| *known < own);
                elements[entity][usize::from(k == 2)].push(i as u32);
                for &corner in (kind.corners)(mesh, i) {
                    let owner = &mut owner[corner as usize];
                    *owner = (*owner).min((points.len() + entity) as u32);
                }
            }
        }
        (0..).zip(&points).for_each(|(entity, (point, _))| owner[*point as usize] = entity);
        let mut nodes = vec![Vec::new(); points.len() + list.len()];
        for (node, owner) in (0u32..).zip(owner) {
            // A node without elements belongs to the last entity.
            let entity = if owner == u32::MAX { nodes.len() - 1 } else { owner as usize };
            nodes[entity].push(node);
        }
        Entities { points, list, elements, nodes }
    }

    /// The tag of an entity: that of its group, or without a group or with several, the next free one.
    fn tag(&self, entity: usize) -> u64 {
        let (dimension, groups) = &self.list[entity];
        if let [tag] = groups[..] {
            return u64::from(tag);
        }
        let alike = self.list.iter().filter(|entity| entity.0 == *dimension);
        let largest = alike.flat_map(|entity| &entity.1).max().copied().unwrap_or(0);
        let before = self.list[..entity].iter().filter(|entity| entity.0 == *dimension && entity.1.len() != 1).count();
        u64::from(largest) + 1 + before as u64
    }

    /// Dimension and tag of the points, then of the entities: in the order of `nodes`.
    fn keys(&self) -> impl Iterator<Item = (usize, u64)> + '_ {
        let points = (1..=self.points.len() as u64).map(|tag| (0, tag));
        points.chain((0..self.list.len()).map(|entity| (self.list[entity].0, self.tag(entity))))
    }

    fn write(&self, out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
        let kinds = ElementType::all(mesh);
        let curves = self.list.iter().filter(|entity| entity.0 == 1).count();
        let groups = |groups: &[u32]| groups.iter().fold(groups.len().to_string(), |text, tag| format!("{text} {tag}"));
        writeln!(out, "$Entities\n{} {curves} {} 0", self.points.len(), self.list.len() - curves)?;
        for (tag, (node, own)) in (1..).zip(&self.points) {
            let p = mesh.points[*node as usize];
            writeln!(out, "{tag} {} {} {} {}", Shortest(p.x), Shortest(p.y), Shortest(p.z), groups(own))?;
        }
        for (k, (entity, elements)) in self.list.iter().zip(&self.elements).enumerate() {
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
            write!(out, "{}", self.tag(k))?;
            for value in [low.x, low.y, low.z, high.x, high.y, high.z] {
                write!(out, " {}", Shortest(value))?;
            }
            // Discrete entities have no bounding entities.
            writeln!(out, " {} 0", groups(&entity.1))?;
        }
        writeln!(out, "$EndEntities")
    }

    fn write_nodes(&self, out: &mut dyn Write, mesh: &MeshFile) -> io::Result<()> {
        let count = mesh.points.len();
        let blocks = self.nodes.iter().filter(|nodes| !nodes.is_empty()).count();
        writeln!(out, "$Nodes\n{blocks} {count} {} {count}", count.min(1))?;
        for ((dimension, tag), nodes) in self.keys().zip(&self.nodes).filter(|(_, nodes)| !nodes.is_empty()) {
            writeln!(out, "{dimension} {tag} 0 {}", nodes.len())?;
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
        let others: usize = kinds.iter().map(|kind| kind.count).sum();
        let count = others + self.points.len();
        let blocks: usize = self.elements.iter().flatten().filter(|list| !list.is_empty()).count() + self.points.len();
        writeln!(out, "$Elements\n{blocks} {count} {} {count}", count.min(1))?;
        for (k, (node, _)) in self.points.iter().enumerate() {
            writeln!(out, "0 {} {POINT} 1\n{} {}", k + 1, others + k + 1, u64::from(*node) + 1)?;
        }
        for (k, (entity, elements)) in self.list.iter().zip(&self.elements).enumerate() {
            for (place, list) in elements.iter().enumerate().filter(|(_, list)| !list.is_empty()) {
                let kind = &kinds[if entity.0 == 1 { 0 } else { 1 + place }];
                writeln!(out, "{} {} {} {}", entity.0, self.tag(k), kind.number, list.len())?;
                for &i in list {
                    write!(out, "{}", kind.before + i as usize + 1)?;
                    corners(out, (kind.corners)(mesh, i as usize))?;
                }
            }
        }
        writeln!(out, "$EndElements")
    }
}
