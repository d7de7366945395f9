//! The constrained Delaunay triangulation of divided curves (spec 3, step 2), by face, cut apart along shared curves,
//! cracks and repeated lines.

use glam::DVec2;
use rustc_hash::FxHashMap;
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::cut::{Cut, CutMesh, cut};
use super::discretise::{DividedDomain, Division};
use crate::core::fault::Fault;
use crate::core::geometry::crossing::crossing_of;
use crate::core::geometry::domain::{CurveId, CurveKind, Domain};
use crate::core::geometry::place::{number, told};
use crate::core::geometry::predicates::{firm, orient};
use crate::core::mesh::triangle_set::TriangleSet;
use crate::core::metric::field::MetricSource;

/// How often offending curves are divided more finely before the domain is refused.
const ROUNDS: usize = 16;

/// Why divided curves cannot be triangulated: their chords cross or come too close where the curves do not.
#[derive(Clone, Debug)]
pub struct Clash {
    /// The curves that finer division may help.
    pub curves: Vec<CurveId>,
    /// What is wrong, should it not help.
    pub fault: Fault,
}

/// Divides the curves of a domain in the metric and triangulates it; curves whose chords clash are divided more finely
/// (spec 4).
///
/// # Errors
/// What [`super::discretise::divide`] refuses, and chords that still clash after many rounds.
pub fn divide_and_triangulate(
    domain: &Domain,
    metric: &dyn MetricSource,
) -> Result<(DividedDomain, TriangleSet), Fault> {
    let mut division = Division::measure(domain, metric)?;
    division.even_out()?;
    for round in 0.. {
        let divided = division.nodes()?;
        match triangulate(domain, &divided) {
            Ok(set) => return Ok((divided, set)),
            Err(clash) => {
                let helped = clash.curves.iter().filter(|id| division.refine(**id)).count() > 0;
                if !helped || round >= ROUNDS {
                    return Err(clash.fault);
                }
            }
        }
    }
    unreachable!("the rounds end by returning")
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

/// Triangulates divided curves: all faces, without what is outside and in holes. Regions are the faces by number.
///
/// # Errors
/// Chords that cross, touch or coincide, and triangles that are too thin (spec 2.10).
///
/// # Panics
/// Where a boundary loop is odd: [`Division::even_out`] has made them even.
pub fn triangulate(domain: &Domain, divided: &DividedDomain) -> Result<TriangleSet, Box<Clash>> {
    let mesh = triangles(domain, divided)?;
    for nodes in mesh.loops() {
        assert!(
            nodes.len().is_multiple_of(2),
            "the boundary loop through {} is odd",
            told(mesh.set.uv[nodes[0] as usize])
        );
    }
    Ok(mesh.set)
}

fn triangles(domain: &Domain, divided: &DividedDomain) -> Result<CutMesh, Box<Clash>> {
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
    if let Some(t) = kept.iter().find(|&&[a, b, c]| !firm(edges.at(a), edges.at(b), edges.at(c))) {
        return Err(edges.thin(t));
    }
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
    Ok(mesh)
}

/// The Delaunay triangulation of the nodes, and where each is in it. Scaled by a power of two, so that signs are those of
/// the given coordinates.
///
/// Nodes are inserted from coarse to fine along each curve: every round halves the steps of the one before, so that each
/// insertion changes little and begins beside the one before. (spade's bulk loaders need quadratic time for nodes that
/// lie on a few lines, and the one that takes constraints walks a hash set of std, whose order differs between runs.)
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
            Box::new(Clash { curves: Vec::new(), fault: Fault::new(format!("The nodes cannot be triangulated: {e}")) })
        };
        let handle = cdt.insert(Vertex { at, node }).map_err(failed)?;
        if cdt.num_vertices() == count {
            // It has taken the place of another one.
            let other = handles.iter().position(|&h| h == handle).unwrap_or(0) as u32;
            return Err(clash(domain, curves_through(domain, divided, &[other, node]), "come to the same point", p));
        }
        handles[node as usize] = handle;
        Ok(())
    };
    (0..domain.vertices.len() as u32).try_for_each(&mut insert)?;
    let longest = divided.chains.iter().map(Vec::len).max().unwrap_or(0);
    let mut step = longest.next_power_of_two();
    while step > 0 {
        for chain in &divided.chains {
            // Odd multiples of the step, but for the end.
            chain[..chain.len() - 1].iter().skip(step).step_by(2 * step).copied().try_for_each(&mut insert)?;
        }
        step /= 2;
    }
    Ok((cdt, handles))
}

/// The edges of the divided curves.
struct Edges<'a> {
    domain: &'a Domain,
    divided: &'a DividedDomain,
    /// The curve of each edge, by its nodes in ascending order.
    curve_of: FxHashMap<(u32, u32), CurveId>,
}

impl<'a> Edges<'a> {
    fn new(domain: &'a Domain, divided: &'a DividedDomain) -> Result<Self, Box<Clash>> {
        let mut edges = Edges { domain, divided, curve_of: FxHashMap::default() };
        edges.curve_of.reserve(divided.nodes.len());
        for (id, a, b) in edges.all() {
            if let Some(other) = edges.curve_of.insert((a.min(b), a.max(b)), id) {
                let middle = divided.nodes[a as usize].midpoint(divided.nodes[b as usize]);
                return Err(clash(domain, vec![id, other], "come to the same line", middle));
            }
        }
        Ok(edges)
    }

    /// Every edge from node to node in its curve's direction.
    fn all(&self) -> impl Iterator<Item = (CurveId, u32, u32)> + use<'a> {
        let chains = self.divided.chains.iter().zip(0..);
        chains.flat_map(|(chain, id)| chain.windows(2).map(move |w| (CurveId(id), w[0], w[1])))
    }

    fn at(&self, node: u32) -> DVec2 {
        self.divided.nodes[node as usize]
    }

    /// Makes every edge an edge of the triangulation.
    fn constrain(&self, cdt: &mut Cdt, handles: &[FixedVertexHandle]) -> Result<(), Box<Clash>> {
        let mut found: Option<(Vec<CurveId>, &str, DVec2)> = None;
        for (id, a, b) in self.all() {
            let (from, to) = (handles[a as usize], handles[b as usize]);
            match cdt.try_add_constraint(from, to).as_slice() {
                [_] => {}
                [] => {
                    for other in cdt.get_conflicting_edges_between_vertices(from, to) {
                        let [c, d] = other.vertices().map(|v| v.data().node);
                        let place =
                            crossing_of([self.at(a), self.at(b)], [self.at(c), self.at(d)]).unwrap_or(self.at(a));
                        let (curves, ..) = found.get_or_insert((vec![id], "cross", place));
                        curves.extend([id].into_iter().chain(self.curve_of.get(&(c.min(d), c.max(d))).copied()));
                    }
                    // A conflict at a vertex has no edge to name.
                    found.get_or_insert((vec![id], "cross", self.at(a)));
                }
                [first, ..] => {
                    // The edge runs through a node, which has split it.
                    let ends = cdt.directed_edge(*first).vertices().map(|v| v.data().node);
                    let through = if ends.contains(&a) {
                        ends.into_iter().find(|&n| n != a)
                    } else {
                        ends.into_iter().find(|&n| n != b)
                    };
                    let through = through.unwrap_or(a);
                    let mut curves = curves_through(self.domain, self.divided, &[through]);
                    curves.insert(0, id);
                    let (all, ..) = found.get_or_insert((Vec::new(), "touch", self.at(through)));
                    all.extend(curves);
                }
            }
        }
        match found {
            None => Ok(()),
            Some((curves, verb, place)) => Err(clash(self.domain, curves, verb, place)),
        }
    }

    /// The face of each triangle, `None` outside. Every chord must have the faces on its sides that its curve has.
    fn flood(&self, cdt: &Cdt, handles: &[FixedVertexHandle]) -> Result<Vec<Option<u32>>, Box<Clash>> {
        // The hull's outside is not among the inner faces: there, nothing is to be labelled.
        let mut labels: Vec<Option<Option<u32>>> = vec![None; cdt.num_inner_faces()];
        let mut walls = vec![false; cdt.num_undirected_edges()];
        let mut seeds = Vec::new();
        let missing = |id| {
            clash(self.domain, vec![id], "cannot be kept as it is divided", self.domain.curves[id.index()].first())
        };
        for (id, a, b) in self.all() {
            let curve = &self.domain.curves[id.index()];
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
                Some(_) => return Err(self.misplaced(id, self.divided.chains[id.index()][0])),
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
                            Some(_) => return Err(self.misplaced(id, self.divided.chains[id.index()][0])),
                        }
                    }
                }
            }
        }
        // What no curve touches lies outside of all.
        Ok(labels.into_iter().map(Option::flatten).collect())
    }

    /// A chord that has jumped over another curve: all curved ones are to be divided more finely.
    fn misplaced(&self, id: CurveId, node: u32) -> Box<Clash> {
        let mut found =
            clash(self.domain, vec![id], "lies on the wrong side of another when divided so coarsely", self.at(node));
        found.curves = (0..self.domain.curves.len() as u32).map(CurveId).collect();
        found
    }

    fn thin(&self, triangle: &[u32; 3]) -> Box<Clash> {
        let [a, b, c] = triangle.map(|n| self.at(n));
        let curves = curves_through(self.domain, self.divided, triangle);
        let names: Vec<String> =
            curves.iter().map(|id| format!("\"{}\"", self.domain.curves[id.index()].name)).collect();
        let fault = Fault::new(format!(
            "The nodes {}, {} and {} of {} make a triangle that is {}",
            told(a),
            told(b),
            told(c),
            names.join(", "),
            too_thin(a, b, c)
        ));
        Box::new(Clash { curves, fault: fault.remedy("Keep the curves further apart there, or ask for smaller sizes") })
    }
}

/// What is amiss with a triangle that is not [`firm`], after "is".
pub fn too_thin(a: DVec2, b: DVec2, c: DVec2) -> String {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let ratio = orient(a, b, c) / longest / longest;
    if ratio <= 0.0 {
        "without area".to_owned()
    } else if ratio < 1e-7 {
        format!("only {} as high as it is long, where 1e-7 is the least", number(ratio))
    } else {
        "too small for coordinates so far from the origin".to_owned()
    }
}

/// The curves on which the nodes lie, ascending.
fn curves_through(domain: &Domain, divided: &DividedDomain, nodes: &[u32]) -> Vec<CurveId> {
    let ids = (0..domain.curves.len() as u32).map(CurveId);
    ids.filter(|id| divided.chains[id.index()].iter().any(|n| nodes.contains(n))).collect()
}

/// A clash of curves, the first of which are named.
fn clash(domain: &Domain, mut curves: Vec<CurveId>, verb: &str, at: DVec2) -> Box<Clash> {
    let mut seen = Vec::new();
    curves.retain(|id| !seen.contains(id) && (seen.push(*id), true).1);
    let named = |id: &CurveId| format!("\"{}\"", domain.curves[id.index()].name);
    let what = match curves.as_slice() {
        [] => format!("Curves {verb}"),
        [one] => format!("The curve {} {verb}", named(one)),
        [one, other, ..] => format!("The curves {} and {} {verb} when divided into segments", named(one), named(other)),
    };
    let fault = Fault::new(what)
        .at(format!("at {}", told(at)))
        .remedy("Keep them further apart, ask for smaller sizes there, or fix larger numbers of segments");
    Box::new(Clash { curves, fault })
}

#[cfg(test)]
mod tests;
