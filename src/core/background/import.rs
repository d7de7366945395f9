//! Import of a planar triangle mesh as background: checked, repaired where a repair is safe, and cut between regions.
//!
//! It refuses curved meshes, meshes of quadrilaterals only, flat triangles that cannot be merged with a neighbour,
//! edges of three triangles, overlaps, hanging nodes beside a gap, and parts with an odd number of triangles. Lines in
//! groups are kept, even inside regions. Coincident nodes remain separate, as the two sides of a crack.

mod odd_parts;

use std::borrow::Cow;
use std::collections::BTreeSet;

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::clash::too_thin;
use super::cut::{Cut, CutMesh, Side, cut, sorted_sides};
use crate::core::discrete::Triangles;
use crate::core::discrete::defects::{capital, crossed, overlapping, used_points};
use crate::core::discrete::further::groups_by_place;
use crate::core::discrete::lines::on_edges;
use crate::core::discrete::repair::retain;
use crate::core::fault::Fault;
use crate::core::kernel::decimal::{number, point_text};
use crate::core::kernel::predicates::{firm, orient};
use crate::core::kernel::{LogMetric3, Metric3};
use crate::core::mesh::{Further, Named, TriangleSet};
use crate::core::progress::Cancel;
use crate::core::soup::{Borders, MeshFile, Repair};

/// A triangle with a smaller ratio of height to longest side is flat (as in `predicates::firm`).
const FLAT: f64 = 1e-7;

/// An imported mesh.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Its triangles in the order of the file, cut between regions and at pinched nodes.
    pub set: TriangleSet,
    /// The point of the file at each node, twice; or the two ends of the divided segment of which the node is the
    /// middle.
    pub origin: Vec<[u32; 2]>,
    /// Names of the regions by number: those of the groups in the file, or their tags.
    pub regions: Vec<Named>,
    /// Names of the lines by number, likewise.
    pub lines: Vec<Named>,
    /// The groups that divide nothing.
    pub further: Further,
    /// The repairs and omissions, sentences without a full stop.
    pub repairs: Vec<String>,
}

impl Imported {
    /// Metrics at the nodes from metrics at the points of the file.
    pub fn at_nodes(&self, metric: &[Metric3]) -> Vec<Metric3> {
        let middle = |a: u32, b: u32| {
            let sum = LogMetric3::ZERO.plus(0.5, &metric[a as usize].ln()).plus(0.5, &metric[b as usize].ln());
            sum.exp()
        };
        self.origin.iter().map(|&[a, b]| if a == b { metric[a as usize] } else { middle(a, b) }).collect()
    }
}

/// Imports a planar triangle mesh. Regions are the tags of the triangles in ascending order. A part is a set of
/// triangles of one region that edges off the lines connect. Parts with odd numbers of triangles become even by the
/// division of sides between parts, as few as possible, of those between two parts the longest. If that is not
/// possible, a part is refused or, with `split_odd`, its longest boundary segment is divided. Points up to `joint` from
/// a side hang on it.
///
/// # Errors
/// All that the module documentation lists, with the triangles as numbered in the file, and coordinates.
pub fn import(file: &MeshFile, split_odd: bool, joint: Option<f64>) -> Result<Imported, Fault> {
    let given = file;
    let (cut, file) = cut_to_triangles(file);
    let mut import = Import::checked(given, &file)?;
    Repair::Triangulated.report(cut, &mut import.repairs);
    import.drop_duplicates();
    import.repair(joint);
    import.orient()?;
    import.check_edges()?;
    overlapping(given, &import.points(), &import.triangles, &import.element)?;
    if joint.is_some() {
        let points = import.points();
        let borders = Borders::of(&points, import.triangles.iter().map(|t| &t[..]));
        import.repairs.extend(borders.not_joined(false, &Cancel::default()));
    }
    import.even_parts(split_odd)?;
    Ok(import.finish())
}

/// The mesh with its larger elements cut into triangles. A mesh of quadrilaterals only is not cut, and refused later:
/// it is the result of a conversion.
fn cut_to_triangles(file: &MeshFile) -> (usize, Cow<'_, MeshFile>) {
    if file.polygons.is_empty() && (file.triangles.is_empty() || file.quads.is_empty()) {
        return (0, Cow::Borrowed(file));
    }
    let (file, cut) = file.clone().triangulated();
    (cut, Cow::Owned(file))
}

struct Import<'a> {
    /// The mesh of the file, and the same cut into triangles.
    given: &'a MeshFile,
    file: &'a MeshFile,
    uv: Vec<DVec2>,
    /// The height of the plane.
    z: f64,
    origin: Vec<[u32; 2]>,
    triangles: Vec<[u32; 3]>,
    /// The region of each triangle, and its element in the file.
    region: Vec<u32>,
    element: Vec<u32>,
    tags: Vec<u32>,
    sides: Vec<Side>,
    /// The groups of lines, and the group of each side on a line, by its nodes in ascending order.
    groups: Vec<Named>,
    lines: FxHashMap<(u32, u32), u32>,
    repairs: Vec<String>,
    coincident: usize,
}

impl<'a> Import<'a> {
    fn checked(given: &'a MeshFile, file: &'a MeshFile) -> Result<Self, Fault> {
        let (n, quads) = (file.triangles.len(), file.quads.len());
        if quads > 0 {
            return Err(Fault::new(format!("The mesh is already quadrilateral: all of its {quads} elements are"))
                .remedy("Give a triangle mesh, or remesh its shape (--use shape)"));
        }
        let origins = given.origins();
        let used = used_points(given, &file.triangles, &origins)?;
        crossed(given, &file.triangles, &origins)?;
        let mut z = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for (p, _) in file.points.iter().zip(&used).filter(|(_, used)| **used) {
            z = (z.0.min(p.z), z.1.max(p.z));
            (low, high) = (low.min(p.truncate()), high.max(p.truncate()));
        }
        if z.1 - z.0 > 1e-9 * (high - low).max_element().max(z.1.abs()) {
            return Err(Fault::new(format!(
                "The mesh is not planar: its z ranges from {} to {}",
                number(z.0),
                number(z.1)
            ))
            .remedy("Give a mesh with constant z"));
        }
        if !file.triangle_tags.is_empty() && file.triangle_tags.len() != n {
            return Err(Fault::new(format!(
                "The mesh has {n} triangles, but {} tags for them",
                file.triangle_tags.len()
            )));
        }
        let tag = |i: usize| file.triangle_tags.get(i).copied().unwrap_or(0);
        let tags: Vec<u32> = (0..n).map(tag).collect::<BTreeSet<u32>>().into_iter().collect();
        let index: FxHashMap<u32, u32> = tags.iter().copied().zip(0..).collect();
        let (groups, group_of) = file.line_groups();
        let mut lines = FxHashMap::default();
        for (&[a, b], group) in file.lines.iter().zip(group_of).filter_map(|(line, group)| Some((line, group?))) {
            lines.entry((a.min(b), a.max(b))).or_insert(group);
        }
        let mut repairs = Vec::new();
        let orphans = used.iter().filter(|u| !**u).count();
        Repair::UnusedPoint.report(orphans, &mut repairs);
        let mut import = Import {
            given,
            file,
            uv: file.points.iter().map(|p| p.truncate()).collect(),
            z: z.0,
            origin: (0..file.points.len() as u32).map(|i| [i, i]).collect(),
            triangles: file.triangles.clone(),
            region: (0..n).map(|i| index[&tag(i)]).collect(),
            element: origins,
            tags,
            sides: Vec::new(),
            groups,
            lines,
            repairs,
            coincident: 0,
        };
        import.coincident = import.count_coincident(&used);
        Repair::CrackPoint.report(import.coincident, &mut import.repairs);
        Ok(import)
    }

    /// The number of used points that coincide exactly with another one.
    fn count_coincident(&self, used: &[bool]) -> usize {
        // Adding zero turns -0 into 0.
        let bits = |p: DVec2| ((p.x + 0.0).to_bits(), (p.y + 0.0).to_bits());
        let mut points: Vec<(u64, u64)> =
            self.uv.iter().zip(used).filter(|(_, u)| **u).map(|(&p, _)| bits(p)).collect();
        points.sort_unstable();
        points.windows(2).filter(|w| w[0] == w[1]).count()
    }

    fn firm(&self, [a, b, c]: [u32; 3]) -> bool {
        firm(self.uv[a as usize], self.uv[b as usize], self.uv[c as usize])
    }

    /// The corners of some triangles, for display with a fault.
    fn shapes(&self, triangles: impl IntoIterator<Item = usize>) -> Vec<Vec<DVec3>> {
        let corners = |t: usize| self.triangles[t].map(|k| self.uv[k as usize].extend(self.z)).to_vec();
        triangles.into_iter().map(corners).collect()
    }

    /// The points in space.
    fn points(&self) -> Vec<DVec3> {
        self.uv.iter().map(|p| p.extend(self.z)).collect()
    }

    /// Triangles by their numbers in the file, at the beginning of a sentence.
    fn named(&self, triangles: impl IntoIterator<Item = usize>) -> String {
        let elements: Vec<u32> = triangles.into_iter().map(|t| self.element[t]).collect();
        capital(&self.given.describe_elements(&elements))
    }

    fn drop_duplicates(&mut self) {
        let key = |t: &[u32; 3]| {
            let mut t = *t;
            t.sort_unstable();
            t
        };
        let mut order: Vec<u32> = (0..self.triangles.len() as u32).collect();
        order.sort_unstable_by_key(|&i| (key(&self.triangles[i as usize]), i));
        let mut keep = vec![true; order.len()];
        for w in order.windows(2) {
            keep[w[1] as usize] = key(&self.triangles[w[0] as usize]) != key(&self.triangles[w[1] as usize]);
        }
        let doubles = keep.iter().filter(|k| !**k).count();
        if doubles > 0 {
            retain(&mut self.triangles, &keep);
            retain(&mut self.region, &keep);
            retain(&mut self.element, &keep);
        }
        Repair::DuplicateTriangle.report(doubles, &mut self.repairs);
    }

    /// Removes flat triangles, whose corner the neighbour across the longest side receives, and connects hanging nodes
    /// to the sides on which they lie, unless there is a gap. Lines follow the divided sides.
    fn repair(&mut self, joint: Option<f64>) {
        let mut mesh = Triangles {
            points: self.points(),
            triangles: std::mem::take(&mut self.triangles),
            region: std::mem::take(&mut self.region),
            origin: std::mem::take(&mut self.element),
            ..Triangles::default()
        };
        // Corners at one place are the banks of a crack, and what lies between them is not for others to take.
        let flat = mesh.swap_degenerate(&|mesh, t| {
            let [a, b, c] = mesh.corners(t).map(DVec3::truncate);
            let long = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
            a != b && b != c && c != a && orient(a, b, c).abs() < FLAT * long
        });
        let stitched = mesh.stitch(true, joint, &Cancel::default());
        Repair::DegenerateTriangle.report(flat, &mut self.repairs);
        Repair::HangingPoint.report(stitched, &mut self.repairs);
        if flat + stitched > 0 && !self.lines.is_empty() {
            let mut segments: Vec<([u32; 2], u32)> = self.lines.iter().map(|(&(a, b), &line)| ([a, b], line)).collect();
            segments.sort_unstable();
            self.lines = on_edges(&segments, &mesh, &[]).0.into_iter().map(|([a, b], line)| ((a, b), line)).collect();
        }
        (self.triangles, self.region, self.element) = (mesh.triangles, mesh.region, mesh.origin);
    }

    /// Makes all triangles anticlockwise, and refuses flat ones.
    fn orient(&mut self) -> Result<(), Fault> {
        if self.triangles.is_empty() {
            let shapes = self.given.triangles.iter().map(|t| t.map(|k| self.given.points[k as usize]).to_vec());
            return Err(Fault::new("No triangle of the mesh has an area: the corners of each are collinear")
                .remedy("Export it with more digits, or in another unit")
                .showing(shapes));
        }
        let mut clockwise = 0;
        for t in &mut self.triangles {
            if orient(self.uv[t[0] as usize], self.uv[t[1] as usize], self.uv[t[2] as usize]) < 0.0 {
                t.swap(1, 2);
                clockwise += 1;
            }
        }
        Repair::ClockwiseTriangle.report(clockwise, &mut self.repairs);
        let flat: Vec<usize> = (0..self.triangles.len()).filter(|&i| !self.firm(self.triangles[i])).collect();
        let Some(&first) = flat.first() else { return Ok(()) };
        let [a, b, c] = self.triangles[first].map(|n| self.uv[n as usize]);
        let what = match flat.len() {
            1 => format!("{} is {}", self.named(flat.iter().copied()), too_thin(a, b, c)),
            _ => format!("{} are too flat: the first is {}", self.named(flat.iter().copied()), too_thin(a, b, c)),
        };
        Err(Fault::new(what)
            .at(format!("at {}, {}, {}", point_text(a), point_text(b), point_text(c)))
            .remedy("Repair the mesh there: collapse or swap its longest side")
            .showing(self.shapes(flat)))
    }

    /// Refuses edges of more than two triangles, and two triangles on the same side of an edge.
    fn check_edges(&mut self) -> Result<(), Fault> {
        self.sides = sorted_sides(self.uv.len(), &self.triangles);
        for group in self.sides.chunk_by(same_edge).filter(|g| g.len() > 1) {
            let forward = |s: &Side| self.triangles[s.triangle()][s.corner as usize % 3] == s.low;
            let of = || group.iter().map(Side::triangle);
            let what = match group {
                [a, b] if forward(a) == forward(b) => {
                    format!("{} overlap: they lie on the same side of an edge", self.named(of()))
                }
                [_, _] => continue,
                _ => format!("{} share one edge", self.named(of())),
            };
            let (a, b) = (self.uv[group[0].low as usize], self.uv[group[0].high as usize]);
            return Err(Fault::new(what)
                .at(format!("at the edge from {} to {}", point_text(a), point_text(b)))
                .remedy("Remove the surplus triangles: in the plane an edge has one triangle on each side")
                .showing(self.shapes(of())));
        }
        Ok(())
    }

    fn region_name(&self, region: u32) -> Named {
        self.file.region(self.tags[region as usize])
    }

    fn finish(mut self) -> Imported {
        let inner = |group: &[Side]| match group {
            [a, b] => self.region[a.triangle()] == self.region[b.triangle()],
            _ => false,
        };
        let lines: BTreeSet<(u32, u32)> = self.file.lines.iter().map(|&[a, b]| (a.min(b), a.max(b))).collect();
        let (mut kept, mut lost) = (Vec::new(), 0);
        for group in self.sides.chunk_by(same_edge).filter(|group| inner(group)) {
            let ends = group[0].ends();
            if self.lines.contains_key(&ends) {
                kept.push(([ends.0, ends.1], Cut::Repeated));
            } else if lines.contains(&ends) {
                lost += 1;
            }
        }
        Repair::UngroupedLine.report(lost, &mut self.repairs);
        let names = (0..self.tags.len() as u32).map(|r| self.region_name(r)).collect();
        let single = self.tags.len() == 1 && kept.is_empty();
        let CutMesh { mut set, origin, sides } = cut(&self.uv, self.triangles, self.region, &kept);
        if single {
            // In a single region only pinched nodes are split.
            let pinched = origin.windows(2).filter(|w| w[0] == w[1]).count();
            Repair::PinchedNode.report(pinched, &mut self.repairs);
        }
        for ends in sides {
            let [a, b] = ends.map(|node| origin[node as usize]);
            if let Some(&group) = self.lines.get(&(a.min(b), a.max(b))) {
                set.lines.push((ends.map(|node| set.point[node as usize]), group));
            }
        }
        // Ascending: new nodes have the order of the given ones.
        let origin_of = origin;
        let origin = origin_of.iter().map(|&n| self.origin[n as usize]).collect();
        let faces = groups_by_place(self.given, &set.uv, &set.triangles, &self.element, &mut self.repairs);
        let (mut points, mut lost) = (Vec::new(), 0);
        for (k, named) in self.file.hard_points() {
            let nodes = origin_of.partition_point(|&own| own < k)..origin_of.partition_point(|&own| own <= k);
            lost += usize::from(nodes.is_empty());
            for node in nodes {
                set.hard.push((node as u32, points.len() as u32));
                points.push((named.clone(), set.point[node]));
            }
        }
        Repair::PointOffCorners.report(lost, &mut self.repairs);
        let further = Further { lines: self.file.further_lines(), faces, points, ..Further::default() };
        Imported { set, origin, regions: names, lines: self.groups, further, repairs: self.repairs }
    }
}

fn same_edge(a: &Side, b: &Side) -> bool {
    a.ends() == b.ends()
}

#[cfg(test)]
mod tests;
