//! The constrained Delaunay triangulation of divided curves (docs/algorithm.md, "Triangulation and cuts"), by face, cut
//! along shared curves, cracks and repeated lines.

use glam::DVec2;
use rustc_hash::{FxHashMap, FxHashSet};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::clash::{Clash, DividedChord, chords_at, clash, too_thin};
use super::cut::{Cut, CutMesh, cut, sorted_sides};
use super::discretise::{DividedDomain, Division};
use crate::core::fault::Fault;
use crate::core::geometry::crossing::crossing_of;
use crate::core::geometry::curve::distance_to_segment;
use crate::core::geometry::{CurveId, CurveKind, Domain, PointOn};
use crate::core::kernel::decimal::point_text;
use crate::core::kernel::predicates::{firm, positive};
use crate::core::mesh::{PointId, TriangleSet};

/// The number of refinements of clashing curves before the domain is refused.
const ROUNDS: usize = 64;
/// A division that has become this many times as fine as the sizes ask for is not refined any more: what clashes even
/// then is no matter of chords. (Each round divides a curve into half as many segments again.)
const FINEST: usize = 1000;
/// The two chords of a corner with a smaller sine in space are refined.
const LEAST_SINE: f64 = 0.02;
/// A chord is refined if its distance from its curve exceeds this fraction of the height of its triangle, since the
/// surface would bulge out.
const MOST_BULGE: f64 = 0.25;

/// Divides the curves of a domain in the metric and triangulates it, for tests.
#[cfg(test)]
pub fn divide_and_triangulate(
    domain: &Domain,
    metric: &dyn crate::core::metric::MetricSource,
) -> Result<(DividedDomain, TriangleSet), Fault> {
    divide_by(Division::measure(domain, metric)?)
}

/// Divides curves that are measured and triangulates their domain; curves whose chords clash are divided more finely
/// (docs/algorithm.md, "Curves divided at equal metric length").
///
/// # Errors
/// What [`Division::even_out`] refuses, and chords that still clash after many refinements.
pub fn divide_by(mut division: Division<'_>) -> Result<(DividedDomain, TriangleSet), Fault> {
    let domain = division.domain;
    division.even_out()?;
    let mut first = None;
    for round in 0.. {
        let divided = division.nodes()?;
        let nodes = divided.nodes.len();
        let is_last = round >= ROUNDS || nodes > FINEST * *first.get_or_insert(nodes);
        match triangulate(domain, &divided) {
            Ok((set, folded)) => {
                // A corner that refinement does not improve is a corner of the surface.
                if is_last || !refined(&mut division, &divided, folded)? {
                    return Ok((divided, set));
                }
            }
            Err(clash) => {
                if is_last || !refined(&mut division, &divided, clash.chords)? {
                    return Err(clash.fault);
                }
            }
        }
    }
    unreachable!("the last round returns")
}

/// Refines curves at some of their chords; `false` if nothing changes.
fn refined(division: &mut Division, divided: &DividedDomain, chords: Vec<DividedChord>) -> Result<bool, Fault> {
    let mut seen: FxHashSet<DividedChord> = FxHashSet::default();
    let mut helped = false;
    for (id, k) in chords {
        // A polygonal curve is refined at each of these chords, any other curve once as a whole.
        let first = division.first(id);
        let [from, to] = [k, k + 1].map(|k| divided.parameters[id.index()][k as usize]);
        if seen.insert((first, if division.is_polygonal(first) { k } else { 0 })) {
            helped |= division.refine(first, [from, to]);
        }
    }
    // Refinement keeps loops even, but not the numbers of pieces that face each other.
    if division.is_unlevel() {
        division.level_ties();
        division.even_out()?;
    }
    Ok(helped)
}

#[derive(Clone, Copy)]
struct Vertex {
    at: Point2<f64>,
    node: u32,
}

impl HasPosition for Vertex {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        self.at
    }
}

type Cdt = ConstrainedDelaunayTriangulation<Vertex>;

/// Triangulates the faces of divided curves, without the outside and holes. Regions are the faces by number. Also
/// returns the chords at which triangles fold over in space: refinement may help.
///
/// # Errors
/// Chords that cross, touch or coincide, and triangles that are too thin (docs/algorithm.md, "Rounding").
///
/// # Panics
/// If a boundary loop is odd: [`Division::even_out`] has made them even.
pub fn triangulate(domain: &Domain, divided: &DividedDomain) -> Result<(TriangleSet, Vec<DividedChord>), Box<Clash>> {
    let (mesh, folded) = triangles(domain, divided)?;
    for nodes in mesh.loops() {
        assert!(
            nodes.len().is_multiple_of(2),
            "the boundary loop through {} is odd",
            point_text(mesh.set.uv[nodes[0] as usize])
        );
    }
    Ok((mesh.set, folded))
}

fn triangles(domain: &Domain, divided: &DividedDomain) -> Result<(CutMesh, Vec<DividedChord>), Box<Clash>> {
    let edges = Edges::new(domain, divided)?;
    let (mut cdt, handles) = load(domain, divided)?;
    edges.constrain(&mut cdt, &handles)?;
    let faces = edges.flood(&cdt, &handles)?;

    let (mut kept, mut region) = (Vec::new(), Vec::new());
    for (face, label) in cdt.inner_faces().zip(&faces) {
        if let Some(f) = *label {
            kept.push(face.vertices().map(|v| v.data().node));
            region.push(f);
        }
    }
    edges.lost(&kept)?;
    edges.turn_thin(&mut kept, &region);
    if let Some(t) = kept.iter().find(|t| !edges.is_firm(**t)) {
        return Err(edges.thin(t));
    }
    let folded = edges.folded(&kept);
    let lines: Vec<([u32; 2], Cut)> = domain
        .curves
        .iter()
        .zip(&divided.chains)
        .filter_map(|(c, chain)| match c.kind {
            CurveKind::Boundary => None,
            CurveKind::Crack => Some((Cut::Crack, chain)),
            CurveKind::Repeated => Some((Cut::Repeated, chain)),
        })
        .flat_map(|(kind, chain)| chain.windows(2).map(move |w| ([w[0], w[1]], kind)))
        .collect();
    let mut mesh = cut(&divided.nodes, kept, region, &lines);
    if domain.spatial.is_some() {
        mesh.join_in_space(&divided.joined, &divided.xyz);
    }
    mesh.set.lines = edges.lines(&mesh);
    if !divided.hard.is_empty() {
        let number: FxHashMap<u32, u32> = divided.hard.iter().copied().collect();
        mesh.set.hard = (0..).zip(&mesh.origin).filter_map(|(node, own)| Some((node, *number.get(own)?))).collect();
    }
    Ok((mesh, folded))
}

/// The Delaunay triangulation of the nodes, and their handles. Coordinates are scaled by a power of two, so that the
/// signs of predicates do not change.
///
/// Nodes are inserted from coarse to fine along each curve: every round halves the step, so that each insertion changes
/// little and begins beside the previous one. (The bulk loaders of spade need quadratic time for nodes on a few lines,
/// and the one with constraints iterates over a hash set, whose order differs between runs.)
fn load(domain: &Domain, divided: &DividedDomain) -> Result<(Cdt, Vec<FixedVertexHandle>), Box<Clash>> {
    let largest = divided.nodes.iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    let scale = libm::ldexp(1.0, -libm::ilogb(largest));
    let n = divided.nodes.len();
    let mut cdt = Cdt::with_capacity(n, 3 * n, 2 * n);
    let mut handles = vec![FixedVertexHandle::from_index(0); n];
    let mut insert = |node: u32| {
        let p = divided.nodes[node as usize];
        let at = spade::mitigate_underflow(Point2::new(p.x * scale, p.y * scale));
        let count = cdt.num_vertices();
        let failed = |e| {
            Box::new(Clash { chords: Vec::new(), fault: Fault::new(format!("The nodes cannot be triangulated: {e}")) })
        };
        let handle = cdt.insert(Vertex { at, node }).map_err(failed)?;
        if cdt.num_vertices() == count {
            // It has replaced a node at the same point.
            let other = handles.iter().position(|&h| h == handle).unwrap_or(0) as u32;
            return Err(clash(domain, chords_at(divided, &[other, node]), "have a common point", p));
        }
        handles[node as usize] = handle;
        Ok(())
    };
    (0..domain.vertices.len() as u32).try_for_each(&mut insert)?;
    points_inside(domain, divided).try_for_each(&mut insert)?;
    let longest = divided.chains.iter().map(Vec::len).max().unwrap_or(0);
    let mut step = longest.next_power_of_two();
    while step > 0 {
        for chain in &divided.chains {
            // Odd multiples of the step, except the end.
            chain[..chain.len() - 1].iter().skip(step).step_by(2 * step).copied().try_for_each(&mut insert)?;
        }
        step /= 2;
    }
    Ok((cdt, handles))
}

/// The nodes of hard points inside faces.
fn points_inside<'a>(domain: &'a Domain, divided: &'a DividedDomain) -> impl Iterator<Item = u32> + 'a {
    let inside = |number: u32| domain.points[number as usize].on == PointOn::Face;
    divided.hard.iter().filter(move |(_, number)| inside(*number)).map(|(node, _)| *node)
}

/// The edges of the divided curves.
struct Edges<'a> {
    domain: &'a Domain,
    divided: &'a DividedDomain,
    /// The chord of each edge, by its nodes in ascending order.
    chord_of: FxHashMap<(u32, u32), DividedChord>,
}

impl<'a> Edges<'a> {
    fn new(domain: &'a Domain, divided: &'a DividedDomain) -> Result<Self, Box<Clash>> {
        let mut edges = Edges { domain, divided, chord_of: FxHashMap::default() };
        edges.chord_of.reserve(divided.nodes.len());
        for (chord, a, b) in edges.all() {
            if let Some(other) = edges.chord_of.insert((a.min(b), a.max(b)), chord) {
                let middle = divided.nodes[a as usize].midpoint(divided.nodes[b as usize]);
                return Err(clash(domain, vec![chord, other], "have a common chord", middle));
            }
        }
        Ok(edges)
    }

    /// All edges with their chords, in the direction of the curve.
    fn all(&self) -> impl Iterator<Item = (DividedChord, u32, u32)> + use<'a> {
        let chains = self.divided.chains.iter().zip(0..);
        chains.flat_map(|(chain, id)| chain.windows(2).zip(0..).map(move |(w, k)| ((CurveId(id), k), w[0], w[1])))
    }

    fn at(&self, node: u32) -> DVec2 {
        self.divided.nodes[node as usize]
    }

    /// The sides of triangles along curves, each with the first image of its curve.
    fn lines(&self, mesh: &CutMesh) -> Vec<([PointId; 2], u32)> {
        let on_curve = |ends: &[u32; 2]| {
            let [a, b] = ends.map(|node| mesh.origin[node as usize]);
            let (id, _) = self.chord_of.get(&(a.min(b), a.max(b)))?;
            Some((ends.map(|node| mesh.set.point[node as usize]), self.domain.curves[id.index()].first.0))
        };
        mesh.sides.iter().filter_map(on_curve).collect()
    }

    /// Makes every edge an edge of the triangulation.
    fn constrain(&self, cdt: &mut Cdt, handles: &[FixedVertexHandle]) -> Result<(), Box<Clash>> {
        let mut found: Option<(Vec<DividedChord>, &str, DVec2)> = None;
        for (chord, a, b) in self.all() {
            let (from, to) = (handles[a as usize], handles[b as usize]);
            match cdt.try_add_constraint(from, to).as_slice() {
                [_] => {}
                [] => {
                    for other in cdt.get_conflicting_edges_between_vertices(from, to) {
                        let [c, d] = other.vertices().map(|v| v.data().node);
                        let p = crossing_of([self.at(a), self.at(b)], [self.at(c), self.at(d)]).unwrap_or(self.at(a));
                        let (chords, ..) = found.get_or_insert((vec![chord], "cross", p));
                        chords.extend([chord].into_iter().chain(self.chord_of.get(&(c.min(d), c.max(d))).copied()));
                    }
                    // A conflict at a vertex has no edge.
                    found.get_or_insert((vec![chord], "cross", self.at(a)));
                }
                [first, ..] => {
                    // The edge passes through a node, which has split it.
                    let ends = cdt.directed_edge(*first).vertices().map(|v| v.data().node);
                    let through = if ends.contains(&a) {
                        ends.into_iter().find(|&n| n != a)
                    } else {
                        ends.into_iter().find(|&n| n != b)
                    };
                    let through = through.unwrap_or(a);
                    let (chords, ..) = found.get_or_insert((Vec::new(), "touch", self.at(through)));
                    chords.push(chord);
                    chords.extend(chords_at(self.divided, &[through]));
                }
            }
        }
        match found {
            None => Ok(()),
            Some((chords, verb, p)) => Err(clash(self.domain, chords, verb, p)),
        }
    }

    /// The face of each triangle, `None` outside. Every chord must have the same faces on its sides as its curve.
    fn flood(&self, cdt: &Cdt, handles: &[FixedVertexHandle]) -> Result<Vec<Option<u32>>, Box<Clash>> {
        // The outer face is not among the inner faces, and gets no label.
        let mut labels: Vec<Option<Option<u32>>> = vec![None; cdt.num_inner_faces()];
        let mut walls = vec![false; cdt.num_undirected_edges()];
        let mut seeds = Vec::new();
        let missing = |chord: DividedChord| {
            let first = self.domain.curves[chord.0.index()].first();
            clash(self.domain, vec![chord], "is not an edge of the triangulation with this division", first)
        };
        for (id, a, b) in self.all() {
            let curve = &self.domain.curves[id.0.index()];
            let Some(edge) = cdt.get_edge_from_neighbors(handles[a as usize], handles[b as usize]) else {
                return Err(missing(id));
            };
            walls[edge.fix().as_undirected().index()] = curve.kind == CurveKind::Boundary;
            for (side, face) in curve.sides.into_iter().zip([edge.face(), edge.rev().face()]) {
                match face.as_inner() {
                    Some(face) => seeds.push((id, face.fix(), side)),
                    None if side.is_none() => {}
                    None => return Err(self.misplaced(id, a)),
                }
            }
        }
        for &(id, seed, label) in &seeds {
            let mut stack = vec![seed];
            match labels[seed.index() - 1] {
                Some(known) if known == label => continue,
                Some(_) => return Err(self.misplaced(id, self.divided.chains[id.0.index()][0])),
                None => labels[seed.index() - 1] = Some(label),
            }
            while let Some(face) = stack.pop() {
                for edge in cdt.face(face).adjacent_edges() {
                    if walls[edge.fix().as_undirected().index()] {
                        continue;
                    }
                    if let Some(next) = edge.rev().face().as_inner() {
                        let slot = &mut labels[next.index() - 1];
                        match *slot {
                            None => {
                                *slot = Some(label);
                                stack.push(next.fix());
                            }
                            Some(known) if known == label => {}
                            Some(_) => return Err(self.misplaced(id, self.divided.chains[id.0.index()][0])),
                        }
                    }
                }
            }
        }
        // Faces that no curve bounds lie outside.
        Ok(labels.into_iter().map(Option::flatten).collect())
    }

    /// The clash of a chord that has crossed another curve entirely: all curves are refined.
    fn misplaced(&self, chord: DividedChord, node: u32) -> Box<Clash> {
        let mut found = clash(
            self.domain,
            vec![chord],
            "lies on the wrong side of another with this coarse division",
            self.at(node),
        );
        found.chords = self.all().map(|(chord, ..)| chord).collect();
        found
    }

    /// Hard points between a chord and its curve, or a chord through one: the nearest chord is too long.
    fn lost(&self, triangles: &[[u32; 3]]) -> Result<(), Box<Clash>> {
        let mut wanted: Vec<u32> = points_inside(self.domain, self.divided).collect();
        if wanted.is_empty() {
            return Ok(());
        }
        let used: FxHashSet<u32> = triangles.as_flattened().iter().copied().collect();
        wanted.retain(|node| !used.contains(node));
        let Some(&first) = wanted.first() else { return Ok(()) };
        let off = |node: u32, [a, b]: [u32; 2]| distance_to_segment(self.at(node), self.at(a), self.at(b));
        let nearest =
            |node: u32| self.all().min_by(|(_, a, b), (_, c, d)| off(node, [*a, *b]).total_cmp(&off(node, [*c, *d])));
        let chords = wanted.iter().filter_map(|&node| nearest(node)).map(|(chord, ..)| chord).collect();
        Err(clash(self.domain, chords, "leaves a hard point outside when divided into segments", self.at(first)))
    }

    fn is_firm(&self, triangle: [u32; 3]) -> bool {
        let [a, b, c] = triangle.map(|n| self.at(n));
        firm(a, b, c)
    }

    /// Swaps the longest side of triangles that are too thin if both new triangles are positive: three nodes of an
    /// almost straight curve form such a triangle, which can be merged with its neighbour.
    fn turn_thin(&self, triangles: &mut [[u32; 3]], region: &[u32]) {
        let mut thin: Vec<usize> = (0..triangles.len()).filter(|&t| !self.is_firm(triangles[t])).collect();
        // A swap may leave a thin neighbour, which a later round swaps: thin triangles in a row are swapped one by one.
        for _ in 0..ROUNDS {
            if thin.is_empty() {
                return;
            }
            let sides = sorted_sides(self.divided.nodes.len(), triangles);
            let mut touched: FxHashSet<usize> = FxHashSet::default();
            for &t in &thin {
                let long = |k: usize| self.at(triangles[t][k]).distance_squared(self.at(triangles[t][(k + 1) % 3]));
                let Some(k) = (0..3).max_by(|&i, &j| long(i).total_cmp(&long(j)).then(j.cmp(&i))) else { continue };
                let [a, b, apex] = [0, 1, 2].map(|i| triangles[t][(k + i) % 3]);
                let key = (a.min(b), a.max(b));
                let from = sides.partition_point(|side| side.ends() < key);
                let mut beyond = sides[from..].iter().take_while(|side| side.ends() == key);
                let Some(other) = beyond.find(|side| side.triangle() != t) else { continue };
                let (o, i) = (other.triangle(), other.corner as usize % 3);
                if self.chord_of.contains_key(&key)
                    || region[o] != region[t]
                    || touched.contains(&o)
                    || touched.contains(&t)
                {
                    continue;
                }
                let far = triangles[o][(i + 2) % 3];
                let halves = [[a, far, apex], [far, b, apex]];
                let corners = halves.map(|half| half.map(|n| self.at(n)));
                if corners.iter().all(|&[a, b, c]| positive(a, b, c)) {
                    [triangles[t], triangles[o]] = halves;
                    touched.extend([t, o]);
                }
            }
            if touched.is_empty() {
                return;
            }
            thin = (0..triangles.len()).filter(|&t| !self.is_firm(triangles[t])).collect();
        }
    }

    /// Pairs of chords of polygonal curves with a triangle corner between them that is flat or inverted in space
    /// relative to the surface normal, and chords whose distance from their curve is large compared with the height of
    /// their triangle: chords of bent curves close to each other may cross in space even if they do not in the plane.
    /// (Smooth curves are not refined: their sizes follow the surface.)
    fn folded(&self, triangles: &[[u32; 3]]) -> Vec<DividedChord> {
        let Some(spatial) = &self.domain.spatial else { return Vec::new() };
        let is_polygonal = |chord: &DividedChord| self.domain.curves[chord.0.index()].curve.polygonal();
        let chord = |a: u32, b: u32| self.chord_of.get(&(a.min(b), a.max(b))).copied().filter(is_polygonal);
        let mut folded = Vec::new();
        for t in triangles {
            let chords = [0, 1, 2].map(|k| chord(t[k], t[(k + 1) % 3]));
            if chords.iter().all(Option::is_none) {
                continue;
            }
            let p = t.map(|n| self.divided.xyz[n as usize]);
            let area = (p[1] - p[0]).cross(p[2] - p[0]);
            for k in 0..3 {
                let [one, other] = [chords[k], chords[(k + 2) % 3]];
                let (a, b) = (p[(k + 1) % 3] - p[k], p[(k + 2) % 3] - p[k]);
                match (one, other) {
                    // Two chords that meet at an obtuse angle probably belong to one curve: the triangle is no
                    // evidence.
                    (Some(one), Some(other)) if a.dot(b) > 0.0 => {
                        let middle = t.iter().map(|&n| self.at(n)).sum::<DVec2>() / 3.0;
                        let normal = spatial.atlas.at(self.at(t[k]).lerp(middle, 1e-3)).normal();
                        let sine = area.dot(normal) / (a.length() * b.length()).max(f64::MIN_POSITIVE);
                        let bulges = |&chord: &DividedChord| sine < LEAST_SINE || self.bulge(chord) > MOST_BULGE * sine;
                        folded.extend([one, other].into_iter().filter(bulges));
                    }
                    (Some(one), None) if chords.iter().flatten().count() == 1 => {
                        let height = area.length() / a.length_squared().max(f64::MIN_POSITIVE);
                        if self.bulge(one) > MOST_BULGE * height {
                            folded.push(one);
                        }
                    }
                    _ => {}
                }
            }
        }
        folded
    }

    /// The largest distance of a chord from its polygonal curve in space, divided by the length of the chord.
    fn bulge(&self, (id, k): DividedChord) -> f64 {
        let (curve, Some(spatial)) = (&self.domain.curves[id.index()], &self.domain.spatial) else { return 0.0 };
        let [from, to] = [k, k + 1].map(|k| self.divided.parameters[id.index()][k as usize]);
        let [a, b] = [k, k + 1].map(|k| self.divided.xyz[self.divided.chains[id.index()][k as usize] as usize]);
        let along = b - a;
        let off = |t: f64| {
            let p = spatial.curves[id.index()].point(t) - a;
            (p - along * (p.dot(along) / along.length_squared()).clamp(0.0, 1.0)).length()
        };
        let inside = curve.fine.iter().map(|entry| entry.0).filter(|&t| from < t && t < to);
        inside.map(off).fold(0.0, f64::max) / along.length()
    }

    fn thin(&self, triangle: &[u32; 3]) -> Box<Clash> {
        let [a, b, c] = triangle.map(|n| self.at(n));
        let chords = chords_at(self.divided, triangle);
        let mut curves: Vec<CurveId> = chords.iter().map(|chord| chord.0).collect();
        curves.dedup();
        let names: Vec<String> =
            curves.iter().map(|id| format!("\"{}\"", self.domain.curves[id.index()].name)).collect();
        let fault = Fault::new(format!(
            "The nodes {}, {} and {} of {} form a triangle that is {}",
            point_text(a),
            point_text(b),
            point_text(c),
            names.join(", "),
            too_thin(a, b, c)
        ));
        Box::new(Clash { chords, fault: fault.remedy("Move the curves apart there, or reduce the sizes") })
    }
}

#[cfg(test)]
mod tests;
