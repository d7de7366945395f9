//! What is promised of every mesh, checked from outside.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use quadfront::core::case::Case;
use quadfront::core::convert::conversion::convert_by;
use quadfront::core::convert::{Converter, Phase};
use quadfront::core::fault::Fault;
use quadfront::core::kernel::predicates::convex;
use quadfront::core::mesh::{Mesh, NodeId};
use quadfront::core::progress::Nobody;
use quadfront::core::soup::soundness::examine;
use quadfront::core::soup::{Defect, MeshFile};

/// What came of a case.
pub struct Kept {
    pub triangles: usize,
    pub quads: usize,
    /// Whether triangles were left over after matching, so that edges were divided or rotated.
    pub templates: bool,
}

/// Steps of a conversion for each element that there is: more of them is a machine that does not end. A few triangles
/// that are large for their sizes become many quadrilaterals.
const MOST_STEPS: u64 = 1000;

/// Converts a case and holds the result against everything that is promised.
///
/// `Ok(Err(fault))` where the program refuses the case.
pub fn keep(case: &Case) -> Result<Result<Kept, Fault>, String> {
    keep_by(case, &mut |_| {})
}

/// As [`keep`], with a converter that is prepared before it runs.
pub fn keep_by(case: &Case, prepare: &mut dyn FnMut(&mut Converter<'_>)) -> Result<Result<Kept, Fault>, String> {
    let (mut triangles, mut ends) = (Mesh::default(), true);
    let converted = convert_by(case, &mut Nobody, &mut |converter, _| {
        triangles = converter.mesh.clone();
        prepare(converter);
        while *converter.phase() != Phase::Done && ends {
            converter.step()?;
            let elements = converter.mesh.element_count().min(case.parameters.max_quads as usize) as u64;
            ends = converter.counts.steps < MOST_STEPS * (elements + 100);
        }
        Ok(())
    });
    let converted = match converted {
        Ok(made) if ends => made,
        Ok(made) => return Err(format!("no end after {} steps", made.counts.steps)),
        Err(fault) => return Ok(Err(fault)),
    };
    let quads = converted.mesh;
    triangles.check().map_err(|what| format!("background: {what}"))?;
    quads.check()?;
    for e in quads.elements() {
        if !quads.is_quad(e) {
            return Err(format!("{e:?} is no quadrilateral"));
        }
        let [a, b, c, d] = quads.quad(e).map(|n| quads.uv(n));
        if !convex(a, b, c, d) {
            return Err(format!("{e:?} is not strictly convex: {a} {b} {c} {d}"));
        }
    }
    same("sides on the boundary", &boundary(&triangles), &boundary(&quads))?;
    same("hard points", &hard_points(&triangles), &hard_points(&quads))?;
    same("Euler numbers", &euler(&triangles), &euler(&quads))?;
    even_loops(&quads)?;
    for (region, area) in areas(&triangles) {
        let now = areas(&quads).get(&region).copied().unwrap_or(0.0);
        if (now - area).abs() > 1e-10 * area {
            return Err(format!("region {region} had area {area} and has {now}"));
        }
    }
    sound(&quads)?;
    Ok(Ok(Kept {
        triangles: triangles.element_count(),
        quads: quads.element_count(),
        templates: converted.last_resort.unmatched > 0,
    }))
}

fn same<T: PartialEq + std::fmt::Debug>(what: &str, before: &T, after: &T) -> Result<(), String> {
    if before == after { Ok(()) } else { Err(format!("{what} were {before:?} and are {after:?}")) }
}

/// The places and points of fixed nodes inside, sorted.
fn hard_points(mesh: &Mesh) -> Vec<([u64; 2], u32)> {
    let hard = mesh.nodes().filter(|&n| mesh.is_hard(n));
    let mut all: Vec<_> =
        hard.filter_map(|n| Some((mesh.uv(n).to_array().map(f64::to_bits), mesh.point(n)?.0))).collect();
    all.sort_unstable();
    all
}

/// Every side without a twin: places and points of its ends, and its region; sorted.
fn boundary(mesh: &Mesh) -> Vec<([u64; 4], [u32; 2], u32)> {
    let sides = mesh.elements().flat_map(|e| mesh.half_edges(e)).filter(|&h| mesh.twin(h).is_none());
    let end = |n: NodeId| (mesh.uv(n), mesh.point(n).map_or(u32::MAX, |p| p.0));
    let mut all: Vec<_> = sides
        .map(|h| {
            let ((a, p), (b, q)) = (end(mesh.origin(h)), end(mesh.target(h)));
            ([a.x, a.y, b.x, b.y].map(f64::to_bits), [p, q], mesh.region(h.element()))
        })
        .collect();
    all.sort_unstable();
    all
}

/// Nodes - edges + elements, and the number of fixed nodes.
fn euler(mesh: &Mesh) -> (i64, usize) {
    let (nodes, edges, elements) = (mesh.node_count(), mesh.edges().count(), mesh.element_count());
    (nodes as i64 - edges as i64 + elements as i64, mesh.nodes().filter(|&n| mesh.is_fixed(n)).count())
}

/// Every chain of sides without twins closes, and has an even number of them.
fn even_loops(mesh: &Mesh) -> Result<(), String> {
    let mut seen = vec![false; 4 * mesh.element_slots()];
    for first in mesh.edges().filter(|&h| mesh.twin(h).is_none()) {
        let (mut h, mut count) = (first, 0);
        while !std::mem::replace(&mut seen[h.index()], true) {
            count += 1;
            let node = mesh.target(h);
            h = mesh
                .fan(node)
                .next()
                .filter(|&n| mesh.twin(n).is_none())
                .ok_or(format!("the loop ends at {node:?}"))?;
        }
        if count % 2 != 0 {
            return Err(format!("the loop through {} has {count} sides", mesh.uv(mesh.origin(first))));
        }
    }
    Ok(())
}

/// Area of each region.
fn areas(mesh: &Mesh) -> BTreeMap<u32, f64> {
    let mut areas = BTreeMap::new();
    for e in mesh.elements() {
        let p: Vec<DVec2> = mesh.corners(e).map(|n| mesh.uv(n)).collect();
        let fan = (1..p.len() - 1).map(|k| 0.5 * (p[k] - p[0]).perp_dot(p[k + 1] - p[0]));
        *areas.entry(mesh.region(e)).or_insert(0.0) += fan.sum::<f64>();
    }
    areas
}

/// The mesh as a file would have it is sound: conforming, nothing overlaps, nothing hangs. Points on both sides of a
/// crack are apart at the same place, and faces that meet in a point only pinch it, both by right. On surfaces each
/// chart is held against that in the plane, and their points in space joined; there edges branch by right, and a mesh
/// may be too coarse for its surface.
fn sound(mesh: &Mesh) -> Result<(), String> {
    let in_space = mesh.embedding().is_some();
    let by_right = [Defect::SeamNode, Defect::PinchedNode];
    if in_space {
        only(&file(mesh, &|n| mesh.uv(n).extend(0.0), false), &by_right)?;
        return only(
            &file(mesh, &|n| mesh.xyz(n), true),
            &[by_right[0], by_right[1], Defect::BranchingEdge, Defect::NotConvex],
        );
    }
    only(&file(mesh, &|n| mesh.uv(n).extend(0.0), true), &by_right)
}

/// The quadrilaterals by points, copies of a point `joined` or each by itself.
fn file(mesh: &Mesh, place: &dyn Fn(NodeId) -> DVec3, joined: bool) -> MeshFile {
    let mut number = vec![u32::MAX; mesh.node_slots()];
    let fixed = mesh.nodes().filter_map(|n| mesh.point(n)).map(|p| p.0 + 1).max().filter(|_| joined).unwrap_or(0);
    let mut points = vec![DVec3::ZERO; fixed as usize];
    for n in mesh.nodes() {
        number[n.index()] = match mesh.point(n).filter(|_| joined) {
            Some(p) => {
                points[p.0 as usize] = place(n);
                p.0
            }
            None => {
                points.push(place(n));
                points.len() as u32 - 1
            }
        };
    }
    let quads = mesh.elements().map(|e| mesh.quad(e).map(|n| number[n.index()])).collect();
    let quad_tags = mesh.elements().map(|e| mesh.region(e) + 1).collect();
    MeshFile { points, quads, quad_tags, ..MeshFile::default() }
}

/// Nothing is wrong with the mesh but what may be.
fn only(mesh: &MeshFile, by_right: &[Defect]) -> Result<(), String> {
    match examine(mesh).findings.iter().find(|found| !by_right.contains(&found.defect)) {
        Some(found) => Err(format!("{found}")),
        None => Ok(()),
    }
}
