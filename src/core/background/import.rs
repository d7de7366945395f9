//! An existing triangle mesh as background: checked, repaired where nothing is lost by it, and cut apart between
//! regions.
//!
//! What is refused: curved meshes, meshes of quadrilaterals alone, triangles without room that no neighbour can take
//! in, edges of three triangles, overlaps, points that hang in sides beside a gap, and parts with an odd number of
//! triangles. Lines that are in a group stay, also inside regions. Nodes at the same place are kept apart as the file
//! has them: they are the two sides of a crack. Deliberately absent: reading files (`core/io`).

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::cut::{Cut, CutMesh, Side, cut, sorted_sides};
use super::triangulate::too_thin;
use crate::core::discrete::edges::Triangles;
use crate::core::discrete::lines::on_edges;
use crate::core::discrete::refuse::{capital, crossed, overlapping, used_points};
use crate::core::fault::Fault;
use crate::core::kernel::decimal::{number, point_text};
use crate::core::kernel::disjoint_sets::DisjointSets;
use crate::core::kernel::parity::toggles;
use crate::core::kernel::predicates::{firm, orient};
use crate::core::kernel::spectrum::{LogMetric2, LogMetric3};
use crate::core::kernel::tensor::{Metric2, Metric3};
use crate::core::mesh::names::Named;
use crate::core::mesh::triangle_set::TriangleSet;
use crate::core::progress::Cancel;
use crate::core::soup::mesh_file::MeshFile;

/// A triangle lower than this part of its longest side is none (as `predicates::firm` has it).
const FLAT: f64 = 1e-7;

/// A mesh that has been taken in.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Its triangles in the order of the file, cut apart between regions and at pinched nodes.
    pub set: TriangleSet,
    /// The points of the file that each node stands at: twice the same one, or the two between which a divided segment
    /// got its middle.
    pub origin: Vec<[u32; 2]>,
    /// Names of the regions by number: those of the file's groups, or their tags.
    pub regions: Vec<Named>,
    /// Names of the lines by number, likewise.
    pub lines: Vec<Named>,
    /// What was repaired or left out, sentences without a full stop.
    pub repairs: Vec<String>,
}

impl Imported {
    /// Metrics at the points of the file as metrics at the nodes.
    pub fn at_nodes(&self, metric: &[Metric3]) -> Vec<Metric3> {
        let middle = |a: u32, b: u32| {
            let sum = LogMetric3::ZERO.plus(0.5, &metric[a as usize].ln()).plus(0.5, &metric[b as usize].ln());
            sum.exp()
        };
        self.origin.iter().map(|&[a, b]| if a == b { metric[a as usize] } else { middle(a, b) }).collect()
    }
}

/// Takes in a planar triangle mesh. Regions are the tags of the triangles in ascending order. Of parts (triangles of
/// one region that hang together by edges on no line) with an odd number of triangles two are made even by dividing the
/// longest side on a line between them; one for which that is no way is refused, or where `split_odd` allows, its
/// longest boundary segment that no other region shares is divided.
///
/// # Errors
/// All that the module's doc says, with the triangles as the file counts them, and places.
pub fn import(file: &MeshFile, split_odd: bool) -> Result<Imported, Fault> {
    let given = file;
    let (cut, file) = cut_to_triangles(file);
    let mut import = Import::checked(given, &file)?;
    tell(
        &mut import.repairs,
        cut,
        "quadrilateral or polygon was cut into triangles",
        "quadrilaterals and polygons were cut into triangles",
    );
    import.drop_duplicates();
    import.mend();
    import.orient()?;
    import.check_edges()?;
    overlapping(given, &import.places(), &import.triangles, &import.element)?;
    import.even_parts(split_odd)?;
    Ok(import.finish())
}

/// A mesh of triangles and larger elements with these cut; one of quadrilaterals alone stays, and is refused: it is
/// what a conversion ends with.
fn cut_to_triangles(file: &MeshFile) -> (usize, Cow<'_, MeshFile>) {
    if file.polygons.is_empty() && (file.triangles.is_empty() || file.quads.is_empty()) {
        return (0, Cow::Borrowed(file));
    }
    let (file, cut) = file.clone().triangulated();
    (cut, Cow::Owned(file))
}

struct Import<'a> {
    /// The mesh as the file has it, and cut to triangles.
    given: &'a MeshFile,
    file: &'a MeshFile,
    uv: Vec<DVec2>,
    /// How high the plane lies.
    z: f64,
    origin: Vec<[u32; 2]>,
    triangles: Vec<[u32; 3]>,
    /// Region of each triangle, and the element of the file that it comes from.
    region: Vec<u32>,
    element: Vec<u32>,
    tags: Vec<u32>,
    sides: Vec<Side>,
    /// The groups of lines, and the group of each side in one, by its nodes in ascending order.
    groups: Vec<Named>,
    lines: FxHashMap<(u32, u32), u32>,
    repairs: Vec<String>,
    coincident: usize,
}

impl<'a> Import<'a> {
    fn checked(given: &'a MeshFile, file: &'a MeshFile) -> Result<Self, Fault> {
        let (n, quads) = (file.triangles.len(), file.quads.len());
        if quads > 0 {
            return Err(Fault::new(format!("The mesh has quadrilaterals already: all of its {quads} elements"))
                .remedy("Give a mesh of triangles, or mesh its shape anew (--use shape)"));
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
                "The mesh is not plane: its z runs from {} to {}",
                number(z.0),
                number(z.1)
            ))
            .remedy("Curved meshes are not converted yet: give one with a constant z"));
        }
        if !file.triangle_tags.is_empty() && file.triangle_tags.len() != n {
            return Err(Fault::new(format!(
                "The mesh has {n} triangles and {} tags for them",
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
        tell(&mut repairs, orphans, "point without triangles was left out", "points without triangles were left out");
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
        tell(
            &mut import.repairs,
            import.coincident,
            "point stands at the place of another: taken as the other side of a crack",
            "points stand at the places of others: taken as the other sides of cracks",
        );
        Ok(import)
    }

    /// How many points that are used stand exactly where another one stands.
    fn count_coincident(&self, used: &[bool]) -> usize {
        // Plus zero: -0 is the same place as 0.
        let bits = |p: DVec2| ((p.x + 0.0).to_bits(), (p.y + 0.0).to_bits());
        let mut places: Vec<(u64, u64)> =
            self.uv.iter().zip(used).filter(|(_, u)| **u).map(|(&p, _)| bits(p)).collect();
        places.sort_unstable();
        places.windows(2).filter(|w| w[0] == w[1]).count()
    }

    fn firm(&self, [a, b, c]: [u32; 3]) -> bool {
        firm(self.uv[a as usize], self.uv[b as usize], self.uv[c as usize])
    }

    /// The corners of some triangles, to be shown.
    fn shapes(&self, triangles: impl IntoIterator<Item = usize>) -> Vec<Vec<DVec3>> {
        let places = |t: usize| self.triangles[t].map(|k| self.uv[k as usize].extend(self.z)).to_vec();
        triangles.into_iter().map(places).collect()
    }

    /// Where the points are.
    fn places(&self) -> Vec<DVec3> {
        self.uv.iter().map(|p| p.extend(self.z)).collect()
    }

    fn told(&self, triangles: impl IntoIterator<Item = usize>) -> String {
        let places: Vec<u32> = triangles.into_iter().map(|t| self.element[t]).collect();
        capital(&self.given.describe_elements(&places))
    }

    /// Each triangle once.
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
        tell(&mut self.repairs, doubles, "duplicate triangle was left out", "duplicate triangles were left out");
    }

    /// Takes out triangles too flat to be any, whose corner the neighbour beyond gets, and takes points into the sides
    /// in which they hang where there is no gap; lines run along what these sides become.
    fn mend(&mut self) {
        let mut mesh = Triangles {
            points: self.places(),
            triangles: std::mem::take(&mut self.triangles),
            region: std::mem::take(&mut self.region),
            origin: std::mem::take(&mut self.element),
            ..Triangles::default()
        };
        // Corners at one place are the banks of a crack, and what lies between them is not for others to take.
        let flat = mesh.turn_flat_ones(&|mesh, t| {
            let [a, b, c] = mesh.corners(t).map(DVec3::truncate);
            let long = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
            a != b && b != c && c != a && orient(a, b, c).abs() < FLAT * long
        });
        let stitched = mesh.stitch(true, &Cancel::default());
        tell(&mut self.repairs, flat, "triangle without area was taken out", "triangles without area were taken out");
        tell(
            &mut self.repairs,
            stitched,
            "point hung in a side and was taken into it",
            "points hung in sides and were taken into them",
        );
        if flat + stitched > 0 && !self.lines.is_empty() {
            let mut segments: Vec<([u32; 2], u32)> = self.lines.iter().map(|(&(a, b), &line)| ([a, b], line)).collect();
            segments.sort_unstable();
            self.lines = on_edges(&segments, &mesh, &[]).0.into_iter().map(|([a, b], line)| ((a, b), line)).collect();
        }
        (self.triangles, self.region, self.element) = (mesh.triangles, mesh.region, mesh.origin);
    }

    /// All triangles anticlockwise.
    fn orient(&mut self) -> Result<(), Fault> {
        if self.triangles.is_empty() {
            let shapes = self.given.triangles.iter().map(|t| t.map(|k| self.given.points[k as usize]).to_vec());
            return Err(Fault::new("No triangle of the mesh has an area: the corners of each lie on a line")
                .remedy("Write it with more digits, or in another unit")
                .showing(shapes));
        }
        let mut clockwise = 0;
        for t in &mut self.triangles {
            if orient(self.uv[t[0] as usize], self.uv[t[1] as usize], self.uv[t[2] as usize]) < 0.0 {
                t.swap(1, 2);
                clockwise += 1;
            }
        }
        tell(&mut self.repairs, clockwise, "clockwise triangle was turned", "clockwise triangles were turned");
        let flat: Vec<usize> = (0..self.triangles.len()).filter(|&i| !self.firm(self.triangles[i])).collect();
        let Some(&first) = flat.first() else { return Ok(()) };
        let [a, b, c] = self.triangles[first].map(|n| self.uv[n as usize]);
        let what = match flat.len() {
            1 => format!("{} is {}", self.told(flat.iter().copied()), too_thin(a, b, c)),
            _ => format!("{} are too flat: the first is {}", self.told(flat.iter().copied()), too_thin(a, b, c)),
        };
        Err(Fault::new(what)
            .at(format!("at {}, {}, {}", point_text(a), point_text(b), point_text(c)))
            .remedy("Mend the mesh there: collapse or swap its longest side")
            .showing(self.shapes(flat)))
    }

    /// No edge of more than two triangles, no two triangles on the same side of one.
    fn check_edges(&mut self) -> Result<(), Fault> {
        self.sides = sorted_sides(self.uv.len(), &self.triangles);
        for group in self.sides.chunk_by(same_edge).filter(|g| g.len() > 1) {
            let forward = |s: &Side| self.triangles[s.corner as usize / 3][s.corner as usize % 3] == s.low;
            let of = || group.iter().map(|side| side.corner as usize / 3);
            let what = match group {
                [a, b] if forward(a) == forward(b) => {
                    format!("{} overlap: they lie on the same side of an edge", self.told(of()))
                }
                [_, _] => continue,
                _ => format!("{} share one edge", self.told(of())),
            };
            let (a, b) = (self.uv[group[0].low as usize], self.uv[group[0].high as usize]);
            return Err(Fault::new(what)
                .at(format!("at the edge from {} to {}", point_text(a), point_text(b)))
                .remedy("Take out what is too much: in the plane an edge has one triangle on each side")
                .showing(self.shapes(of())));
        }
        Ok(())
    }

    /// Every part has an even number of triangles, if need be after dividing sides.
    fn even_parts(&mut self, split_odd: bool) -> Result<(), Fault> {
        let mut parts = DisjointSets::new(self.triangles.len());
        let on_line = |side: &Side| self.lines.contains_key(&(side.low, side.high));
        let one_region = |a: &Side, b: &Side| self.region[a.corner as usize / 3] == self.region[b.corner as usize / 3];
        for pair in self.sides.chunk_by(same_edge) {
            if let [a, b] = pair
                && one_region(a, b)
                && !on_line(a)
            {
                parts.join(a.corner / 3, b.corner / 3);
            }
        }
        let part: Vec<u32> = (0..self.triangles.len() as u32).map(|t| parts.find(t)).collect();
        let mut count = vec![0_u32; part.len()];
        part.iter().for_each(|&p| count[p as usize] += 1);
        let Some(first) = (0..part.len()).find(|&p| count[p] % 2 == 1) else { return Ok(()) };
        // The longest side at the boundary of each part, and on lines between each two.
        let mut longest: BTreeMap<_, (f64, &[Side])> = BTreeMap::new();
        for group in self.sides.chunk_by(same_edge) {
            let at = |side: &Side| part[side.corner as usize / 3];
            let between = match group {
                [a] if split_odd => (at(a), None),
                [a, b] if at(a) != at(b) && one_region(a, b) => (at(a).min(at(b)), Some(at(a).max(at(b)))),
                _ => continue,
            };
            let length = self.uv[group[0].low as usize].distance(self.uv[group[0].high as usize]);
            let known = longest.entry(between).or_insert((length, group));
            if length > known.0 {
                *known = (length, group);
            }
        }
        let mut rows: Vec<Vec<u32>> = vec![Vec::new(); part.len()];
        for (column, (one, other)) in (0..).zip(longest.keys()) {
            [Some(*one), *other].into_iter().flatten().for_each(|p| rows[p as usize].push(column));
        }
        let odd: Vec<bool> = count.iter().map(|n| n % 2 == 1).collect();
        let cost: Vec<Option<f64>> =
            longest.values().map(|(length, _)| Some(1.0 / length.max(f64::MIN_POSITIVE))).collect();
        let toggled = toggles(&rows, &odd, &cost).map_err(|blamed| {
            let named = blamed.iter().copied().find(|&p| odd[p as usize]).unwrap_or(first as u32);
            self.odd_fault(&part, named, count[named as usize], split_odd)
        })?;
        let chosen: Vec<Vec<Side>> = longest
            .values()
            .zip(toggled)
            .filter(|(_, toggled)| *toggled)
            .map(|((_, group), _)| group.to_vec())
            .collect();
        let mut halves = FxHashMap::default();
        for sides in &chosen {
            self.divide(sides, &mut halves)?;
        }
        tell(
            &mut self.repairs,
            chosen.len(),
            "boundary segment was divided, so that its part has an even number of triangles",
            "boundary segments were divided, so that their parts have even numbers of triangles",
        );
        self.sides = sorted_sides(self.uv.len(), &self.triangles);
        Ok(())
    }

    /// Divides the sides on one edge, and their triangles with them. `halves` has the triangles that came from each by
    /// dividing.
    fn divide(&mut self, sides: &[Side], halves: &mut FxHashMap<usize, Vec<usize>>) -> Result<(), Fault> {
        let [a, b] = [sides[0].low, sides[0].high];
        let middle = self.uv[a as usize].midpoint(self.uv[b as usize]);
        let m = self.uv.len() as u32;
        self.uv.push(middle);
        self.origin.push([a, b]);
        if let Some(&group) = self.lines.get(&(a.min(b), a.max(b))) {
            self.lines.extend([a, b].map(|end| ((end, m), group)));
        }
        for side in sides {
            let given = side.corner as usize / 3;
            let others = halves.entry(given).or_default();
            let has_both = |t: &usize| [a, b].iter().all(|end| self.triangles[*t].contains(end));
            let t = others.iter().copied().find(has_both).unwrap_or(given);
            let k = (0..3).find(|&k| ![a, b].contains(&self.triangles[t][(k + 2) % 3])).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|i| self.triangles[t][(k + i) % 3]);
            let parts = [[a, m, c], [m, b, c]];
            if parts.iter().any(|&h| !self.firm(h)) {
                return Err(Fault::new(format!("{} is too thin to be divided", self.told([t])))
                    .at(format!("at {}", point_text(middle)))
                    .remedy("Divide another boundary segment of its part in the mesh")
                    .showing(self.shapes([t])));
            }
            others.push(self.triangles.len());
            self.triangles[t] = parts[0];
            self.triangles.push(parts[1]);
            self.region.push(self.region[t]);
            self.element.push(self.element[t]);
        }
        Ok(())
    }

    fn odd_fault(&self, part: &[u32], odd: u32, count: u32, split_odd: bool) -> Fault {
        let member = |t: usize| part[t] == odd;
        let members: Vec<usize> = (0..part.len()).filter(|&t| member(t)).collect();
        let triangles: Vec<[u32; 3]> = members.iter().map(|&t| self.triangles[t]).collect();
        let mesh = cut(&self.uv, triangles, vec![0; count as usize], &[]);
        let loops = mesh.loops();
        let found = loops.iter().find(|l| l.len() % 2 == 1);
        let segments = found.map_or(0, Vec::len);
        let place = found.map_or(DVec2::ZERO, |l| mesh.set.uv[l[0] as usize]);
        let region = match self.tags.len() {
            1 => String::new(),
            _ => format!(" of {}", self.region_name(self.region[odd as usize]).name),
        };
        let mut remedy = "Divide one boundary segment of this part".to_owned();
        if !split_odd {
            remedy += ", or allow that (--split-odd)";
        }
        if self.coincident > 0 {
            remedy += "; or merge points that stand at the same place, if the mesh ought to hang together there";
        }
        let triangles = if count == 1 { "triangle" } else { "triangles" };
        let side = |ends: [u32; 2]| ends.map(|n| mesh.set.uv[n as usize].extend(self.z)).to_vec();
        let sides: Vec<[u32; 2]> =
            found.into_iter().flat_map(|l| (0..l.len()).map(|k| [l[k], l[(k + 1) % l.len()]])).collect();
        let ends: BTreeSet<[u32; 2]> = sides.iter().copied().collect();
        let is_beside = |t: &[u32; 3]| (0..3).any(|k| ends.contains(&[t[k], t[(k + 1) % 3]]));
        let beside =
            members.into_iter().zip(&mesh.set.triangles).filter(|(_, t)| is_beside(t)).map(|(t, _)| self.element[t]);
        let beside = self.given.describe_elements(&beside.collect::<Vec<_>>());
        Fault::new(format!(
            "The boundary loop of {segments} segments leaves a part{region} with {count} {triangles}; an all-quad mesh needs an even count"
        ))
        .at(format!("at {}, sides of {beside}", point_text(place)))
        .remedy(remedy)
        .showing(sides.into_iter().map(side))
    }

    fn region_name(&self, region: u32) -> Named {
        self.file.region(self.tags[region as usize])
    }

    fn finish(mut self) -> Imported {
        let inner = |group: &[Side]| match group {
            [a, b] => self.region[a.corner as usize / 3] == self.region[b.corner as usize / 3],
            _ => false,
        };
        let lines: BTreeSet<(u32, u32)> = self.file.lines.iter().map(|&[a, b]| (a.min(b), a.max(b))).collect();
        let (mut kept, mut lost) = (Vec::new(), 0);
        for group in self.sides.chunk_by(same_edge).filter(|group| inner(group)) {
            let ends = (group[0].low, group[0].high);
            if self.lines.contains_key(&ends) {
                kept.push(([ends.0, ends.1], Cut::Repeated));
            } else if lines.contains(&ends) {
                lost += 1;
            }
        }
        tell(
            &mut self.repairs,
            lost,
            "line inside a region that is in no group is not kept",
            "lines inside regions that are in no group are not kept",
        );
        let names = (0..self.tags.len() as u32).map(|r| self.region_name(r)).collect();
        let single = self.tags.len() == 1 && kept.is_empty();
        let CutMesh { mut set, origin, sides } = cut(&self.uv, self.triangles, self.region, &kept);
        if single {
            // Within one region only a pinched node becomes several.
            let pinched = origin.windows(2).filter(|w| w[0] == w[1]).count();
            tell(
                &mut self.repairs,
                pinched,
                "node was split where triangles meet in a point only",
                "nodes were split where triangles meet in a point only",
            );
        }
        for ends in sides {
            let [a, b] = ends.map(|node| origin[node as usize]);
            if let Some(&group) = self.lines.get(&(a.min(b), a.max(b))) {
                set.lines.push((ends.map(|node| set.point[node as usize]), group));
            }
        }
        let origin = origin.into_iter().map(|n| self.origin[n as usize]).collect();
        Imported { set, origin, regions: names, lines: self.groups, repairs: self.repairs }
    }
}

/// The metric that the triangles themselves imply: in that of a triangle it is equilateral with sides of length 1. At a
/// point it is the log-Euclidean mean over its triangles with equal weights, since each has the same area in its own
/// metric. One for each node; nodes at one point have the same.
pub fn implied_metric(set: &TriangleSet) -> Vec<Metric2> {
    let points = set.point.iter().map(|p| p.index() + 1).max().unwrap_or(0);
    let mut sum = vec![(LogMetric2::ZERO, 0.0_f64); points];
    for t in &set.triangles {
        let ln = implied_by(t.map(|n| set.uv[n as usize])).ln();
        for n in t {
            let (total, count) = &mut sum[set.point[*n as usize].index()];
            *total = total.plus(1.0, &ln);
            *count += 1.0;
        }
    }
    let mean: Vec<Metric2> =
        sum.iter().map(|(total, count)| LogMetric2::ZERO.plus(1.0 / count.max(1.0), total).exp()).collect();
    set.point.iter().map(|p| mean[p.index()]).collect()
}

/// The metric in which a triangle is equilateral with unit sides: 3/2 of the inverse of the sum of `e e^T` over its
/// sides `e`, whose determinant is three times the square of the doubled area.
fn implied_by([a, b, c]: [DVec2; 3]) -> Metric2 {
    let sides = [b - a, c - b, a - c];
    let doubled = orient(a, b, c);
    let factor = 0.5 / (doubled * doubled);
    let sum = |f: fn(DVec2) -> f64| sides.iter().map(|&e| f(e)).sum::<f64>();
    Metric2 { uu: factor * sum(|e| e.y * e.y), uv: -factor * sum(|e| e.x * e.y), vv: factor * sum(|e| e.x * e.x) }
}

fn same_edge(a: &Side, b: &Side) -> bool {
    (a.low, a.high) == (b.low, b.high)
}

fn tell(repairs: &mut Vec<String>, n: usize, one: &str, several: &str) {
    match n {
        0 => {}
        1 => repairs.push(format!("1 {one}")),
        n => repairs.push(format!("{n} {several}")),
    }
}

fn retain<T>(items: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    items.retain(|_| keep.next().copied().unwrap_or(true));
}

#[cfg(test)]
mod tests;
