//! Loops: curves of a list chained end to end, and the boundary walks of a face, including the lines attached to its
//! loops.

use glam::DVec2;
use smallvec::SmallVec;

use super::assembly::loop_name;
use super::domain_curve::{CurveId, CurveKind, DirectedCurve, DomainCurve};
use crate::core::fault::Fault;
use crate::core::kernel::box_tree::extent;
use crate::core::kernel::decimal::{number, point_text};
use crate::core::kernel::predicates::orient;

/// Ends that are nearer to each other than this fraction of their loop may be meant to meet.
const NEARLY: f64 = 0.01;

/// Chains curves, given in any order and direction, into one closed loop that begins with the first of them: loop `i`
/// of a face, where 0 is the outer loop.
///
/// # Errors
/// A list that is empty, names a curve twice, leaves loose ends, touches itself at a vertex, or makes several loops.
pub fn chain(curves: &[DomainCurve], list: &[CurveId], face: &str, i: usize) -> Result<Vec<DirectedCurve>, Fault> {
    let what = loop_name(face, i);
    let is_outer = i == 0;
    let Some(&first) = list.first() else {
        return Err(Fault::new(format!("The {what} has no curves")).remedy("Name at least one closed curve"));
    };
    let named = |id: CurveId| &curves[id.index()].name;
    // The ends of the curves, sorted by vertex: (vertex, index in the list, whether the curve ends there).
    let mut ends: Vec<(u32, usize, bool)> = Vec::with_capacity(2 * list.len());
    for (i, id) in list.iter().enumerate() {
        if list[..i].contains(id) {
            return Err(Fault::new(format!("The {what} names the curve \"{}\" twice", named(*id)))
                .remedy("Name it once; an internal line belongs among the repeated lines or the cracks"));
        }
        let [a, b] = curves[id.index()].ends;
        ends.push((a, i, false));
        ends.push((b, i, true));
    }
    ends.sort_unstable();
    let spot = |&(_, i, at_end): &(u32, usize, bool)| {
        let curve = &curves[list[i].index()];
        if at_end { curve.last() } else { curve.first() }
    };
    let mut loose = Vec::new();
    for group in ends.chunk_by(|a, b| a.0 == b.0) {
        if group.len() == 1 {
            loose.push(group[0]);
        } else if group.len() > 2 {
            let mut names: Vec<_> = group.iter().map(|e| format!("\"{}\"", named(list[e.1]))).collect();
            names.dedup();
            return Err(Fault::new(format!(
                "The {what} touches itself: {} ends of {} meet",
                group.len(),
                names.join(", ")
            ))
            .at(format!("at {}", point_text(spot(&group[0]))))
            .remedy(if is_outer {
                "Make a face of each closed part, or move the parts apart"
            } else {
                "List each closed part as a separate hole, or move the parts apart"
            }));
        }
    }
    if let Some(a) = loose.first() {
        let nearest = loose[1..].iter().min_by(|x, y| spot(a).distance(spot(x)).total_cmp(&spot(a).distance(spot(y))));
        let end = |e: &(u32, usize, bool)| {
            format!("\"{}\" {} at {}", named(list[e.1]), if e.2 { "ends" } else { "begins" }, point_text(spot(e)))
        };
        let other =
            nearest.map_or(String::new(), |b| format!(" and {}, {} apart", end(b), number(spot(a).distance(spot(b)))));
        let size = |(low, high): (DVec2, DVec2)| (high - low).max_element();
        let loop_size =
            size(extent(list.iter().flat_map(|id| [curves[id.index()].first(), curves[id.index()].last()])));
        let is_near = nearest.is_some_and(|b| spot(a).distance(spot(b)) <= NEARLY * loop_size);
        return Err(Fault::new(format!("The {what} is open: {}{other}", end(a))).remedy(if is_near {
            "Make these ends meet, or set tolerance (a key of the case) to more than this distance"
        } else {
            "Make these ends meet, or name the curve that joins them"
        }));
    }
    let mut found = vec![DirectedCurve { curve: first, forward: true }];
    let (mut at, mut by) = (curves[first.index()].ends[1], 0);
    while at != curves[first.index()].ends[0] {
        let here = ends.partition_point(|e| e.0 < at);
        let next = if ends[here].1 == by { ends[here + 1] } else { ends[here] };
        by = next.1;
        found.push(DirectedCurve { curve: list[by], forward: !next.2 });
        at = curves[list[by].index()].ends[usize::from(!next.2)];
    }
    if let Some(id) = list.iter().find(|id| !found.iter().any(|f| f.curve == **id)) {
        return Err(Fault::new(format!(
            "The {what} consists of several closed loops: \"{}\" is not connected to \"{}\"",
            named(*id),
            named(first)
        ))
        .remedy("List each hole separately"));
    }
    Ok(found)
}

/// Points of a loop's fine polygon in order, without repeating the first.
pub fn polygon(curves: &[DomainCurve], chain: &[DirectedCurve]) -> Vec<DVec2> {
    let mut points = Vec::new();
    for step in chain {
        let fine = &curves[step.curve.index()].fine;
        let n = fine.len() - 1;
        points.extend((0..n).map(|i| if step.forward { fine[i].1 } else { fine[n - i].1 }));
    }
    points
}

/// Twice the signed area of a polygon.
pub fn doubled_area(points: &[DVec2]) -> f64 {
    let Some(&o) = points.first() else { return 0.0 };
    (1..points.len()).map(|i| (points[i - 1] - o).perp_dot(points[i] - o)).sum()
}

/// The boundary walks of every face: each has the face on its left and continues at each vertex with the first curve
/// clockwise, so that all that is attached to a loop (cracks, repeated lines, loops that touch it) belongs to the same
/// walk, an internal line twice. These are the topological loops that have to be even (docs/algorithm.md, "Even
/// loops").
///
/// # Errors
/// Faces that their curves do not bound: a curve that enters another face at a vertex.
pub fn walks(
    curves: &[DomainCurve],
    faces: &[String],
    vertices: &[DVec2],
) -> Result<Vec<Vec<Vec<DirectedCurve>>>, Fault> {
    let around = rotations(curves, vertices.len());
    // The index of each end in the rotation of its vertex.
    let mut place = vec![[0_usize; 2]; curves.len()];
    for ring in &around {
        for (i, &(id, at_end)) in ring.iter().enumerate() {
            place[id.index()][usize::from(at_end)] = i;
        }
    }
    let left = |d: DirectedCurve| curves[d.curve.index()].sides[usize::from(!d.forward)];
    let mut walks = vec![Vec::new(); faces.len()];
    let mut seen = vec![[false; 2]; curves.len()];
    for start in 0..2 * curves.len() {
        let start = DirectedCurve { curve: CurveId((start / 2) as u32), forward: start % 2 == 0 };
        let Some(face) = left(start) else { continue };
        if seen[start.curve.index()][usize::from(!start.forward)] {
            continue;
        }
        let (mut walk, mut at) = (Vec::new(), start);
        loop {
            walk.push(at);
            seen[at.curve.index()][usize::from(!at.forward)] = true;
            let vertex = curves[at.curve.index()].ends[usize::from(at.forward)];
            let ring = &around[vertex as usize];
            let i = place[at.curve.index()][usize::from(at.forward)];
            let (curve, at_end) = ring[(i + ring.len() - 1) % ring.len()];
            let next = DirectedCurve { curve, forward: !at_end };
            if left(next) != Some(face) {
                let other = &curves[curve.index()];
                let spot = vertices[vertex as usize];
                let fault = Fault::new(match other.kind {
                    CurveKind::Boundary => format!(
                        "The faces overlap: the curve \"{}\" enters the face \"{}\"",
                        other.name, faces[face as usize]
                    ),
                    _ => format!("The line \"{}\" leaves its face and enters \"{}\"", other.name, faces[face as usize]),
                });
                return Err(fault
                    .at(format!("at {}", point_text(spot)))
                    .remedy("Faces may share only curves and vertices; holes must lie inside the outer loop"));
            }
            if seen[curve.index()][usize::from(!next.forward)] {
                debug_assert_eq!(next, start, "turning clockwise is a permutation");
                break;
            }
            at = next;
        }
        walks[face as usize].push(walk);
    }
    Ok(walks)
}

type Ring = SmallVec<[(CurveId, bool); 4]>;

/// The curve ends at each vertex in anticlockwise order; a closed curve has both its ends there.
fn rotations(curves: &[DomainCurve], vertices: usize) -> Vec<Ring> {
    let mut around = vec![Ring::new(); vertices];
    for (i, curve) in curves.iter().enumerate() {
        around[curve.ends[0] as usize].push((CurveId(i as u32), false));
        around[curve.ends[1] as usize].push((CurveId(i as u32), true));
    }
    for ring in around.iter_mut().filter(|ring| ring.len() > 2) {
        // Curves may be tangent: compare them where they cross a small circle about the vertex, whose radius is half
        // the shortest first chord.
        let second = |(id, at_end): (CurveId, bool)| {
            let fine = &curves[id.index()].fine;
            let n = fine.len() - 1;
            if at_end { (fine[n].1, fine[n - 1].1) } else { (fine[0].1, fine[1].1) }
        };
        let shortest = ring.iter().map(|&e| second(e)).map(|(a, b)| a.distance(b)).fold(f64::INFINITY, f64::min);
        let mut directions: SmallVec<[(DVec2, (CurveId, bool)); 4]> = ring
            .iter()
            .map(|&(id, at_end)| (curves[id.index()].leaves(at_end, 0.5 * shortest), (id, at_end)))
            .collect();
        directions.sort_by(|(a, i), (b, j)| {
            let half = |d: &DVec2| d.y < 0.0 || (d.y == 0.0 && d.x < 0.0);
            half(a).cmp(&half(b)).then_with(|| 0.0_f64.total_cmp(&(orient(DVec2::ZERO, *a, *b) + 0.0))).then(i.cmp(j))
        });
        *ring = directions.into_iter().map(|(_, end)| end).collect();
    }
    around
}
