//! Defects without a safe repair: faults that name the elements by the file's numbers and show them.

use glam::{DVec2, DVec3};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::edges::{Edges, Triangles};
use crate::core::fault::Fault;
use crate::core::kernel::decimal::{number, point_text};
use crate::core::kernel::predicates::orient;
use crate::core::soup::soundness::examine;
use crate::core::soup::{Defect, MeshFile};

/// Largest coordinate, and inverse of the smallest size of a mesh: beyond, products of several coordinates overflow.
pub(in crate::core) const LARGEST: f64 = 1e30;
/// A surface smaller than this fraction of its distance from the origin has too few digits for its normals.
const FAR: f64 = 5e-8;
/// A polygon crosses itself if its area vector is shorter than this fraction of the summed areas of its pieces.
const CROSSED: f64 = 0.2;
/// A polygon with an area below this fraction of its length squared is degenerate.
const FLAT: f64 = 1e-6;
/// Fraction of a polygon that may face backwards, by rounding.
const BACK: f64 = 1e-6;
/// Limit on the pairs of triangles tested for overlap, for each triangle.
const PAIRS: usize = 64;

/// Checks the points of a file's triangles; returns for each point whether a triangle uses it.
///
/// # Errors
/// No triangles, or too many; missing points, coordinates not finite or beyond [`LARGEST`], or a mesh smaller than its
/// inverse.
pub(in crate::core) fn used_points(
    file: &MeshFile,
    triangles: &[[u32; 3]],
    origins: &[u32],
) -> Result<Vec<bool>, Fault> {
    if triangles.is_empty() {
        let mut others: Vec<String> = file.skipped.iter().map(|(kind, n)| format!("{n} {kind}")).collect();
        let mut note = |n: usize, one: &str, several: &str| match n {
            0 => {}
            1 => others.push(format!("1 {one}")),
            n => others.push(format!("{n} {several}")),
        };
        note(file.lines.len(), "line", "lines");
        note(file.points.len(), "point", "points");
        let others = if others.is_empty() { String::new() } else { format!(", only {}", others.join(" and ")) };
        return Err(Fault::new(format!("The mesh has no triangles{others}")).remedy("Give a mesh of triangles"));
    }
    if triangles.len() > u32::MAX as usize / 8 || file.points.len() > u32::MAX as usize / 8 {
        return Err(Fault::new(format!("The mesh has {} triangles, which is too many", triangles.len())));
    }
    let mut used = vec![false; file.points.len()];
    for (t, origin) in triangles.iter().zip(origins) {
        for &k in t {
            let Some(used) = used.get_mut(k as usize) else {
                let what = format!(
                    "{} refers to point {} of {}",
                    capital(&file.describe_elements(&[*origin])),
                    u64::from(k) + 1,
                    file.points.len()
                );
                return Err(Fault::new(what).remedy("Export the mesh again, with all points of its triangles"));
            };
            *used = true;
        }
    }
    let of_use = || (0..).zip(&file.points).filter(|(k, _)| used[*k as usize]).map(|(k, p): (u32, &DVec3)| (k, *p));
    let is_beyond = |p: DVec3| !p.is_finite() || p.abs().max_element() > LARGEST;
    let beyond: Vec<u32> = of_use().filter(|(_, p)| is_beyond(*p)).map(|(k, _)| k).collect();
    if let Some(&first) = beyond.first() {
        let p = point_text(file.points[first as usize]);
        let what = match beyond.len() {
            1 => format!("{} is at {p}", capital(&file.describe_points(&beyond))),
            _ => format!("{} are out of range, the first at {p}", capital(&file.describe_points(&beyond))),
        };
        let remedy = format!("Coordinates must be finite numbers no larger than {LARGEST:e}");
        let with = |t: &&[u32; 3]| t.iter().any(|k| beyond.binary_search(k).is_ok());
        let rest = |t: &[u32; 3]| t.map(|k| file.points[k as usize]).into_iter().filter(|p| !is_beyond(*p)).collect();
        return Err(Fault::new(what).remedy(remedy).showing(triangles.iter().filter(with).map(rest)));
    }
    let ends = of_use().map(|(_, p)| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let size = ends.map_or(0.0, |[low, high]| (high - low).max_element());
    if size == 0.0 {
        return Err(Fault::new(format!(
            "All points of the mesh are at {}",
            point_text(file.points[triangles[0][0] as usize])
        ))
        .remedy("Export it with more digits, or in another unit"));
    }
    if size < 1.0 / LARGEST {
        return Err(Fault::new(format!("The mesh is only {} across", number(size))).remedy("Export it in another unit"));
    }
    Ok(used)
}

/// Checks that coordinates have enough digits for normals and areas.
///
/// # Errors
/// A surface that is too far from the origin for its size.
pub(super) fn far_from_origin(mesh: &Triangles) -> Result<(), Fault> {
    let corners = mesh.triangles.as_flattened().iter().map(|&k| mesh.points[k as usize]);
    let ends = corners.map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let [low, high] = ends.unwrap_or([DVec3::ZERO; 2]);
    let (size, away) = ((high - low).max_element(), low.abs().max(high.abs()).max_element());
    if size >= FAR * away {
        return Ok(());
    }
    let what =
        format!("The mesh is {} across and {} from the origin, too far for its size", number(size), number(away));
    Err(Fault::new(what).remedy("Move it to the origin: its coordinates have too few digits"))
}

/// Capitalises the first letter.
pub(in crate::core) fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Checks that the polygons that were triangulated do not cross themselves. Adjacent `triangles` with the same origin
/// are the pieces of one polygon.
///
/// # Errors
/// The polygons that do.
pub(in crate::core) fn crossed(file: &MeshFile, triangles: &[[u32; 3]], origins: &[u32]) -> Result<(), Fault> {
    let area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|k| file.points[k as usize]);
        (b - a).cross(c - a)
    };
    let cut = file.triangles.len();
    let mut bad = Vec::new();
    let mut first = cut;
    for pieces in origins[cut..].chunk_by(|a, b| a == b) {
        let of = &triangles[first..first + pieces.len()];
        first += pieces.len();
        let whole: DVec3 = of.iter().map(area).sum();
        let all: f64 = of.iter().map(|t| area(t).length()).sum();
        let corners = || of.as_flattened().iter().map(|&k| file.points[k as usize]);
        let size = corners().map(|p| p.distance(file.points[of[0][0] as usize])).fold(0.0, f64::max);
        // The pieces of a degenerate polygon are removed later.
        if all <= FLAT * size * size {
            continue;
        }
        // A plane polygon that crosses itself has pieces that face backwards.
        let back: f64 = of.iter().map(|t| -area(t).dot(whole)).filter(|dot| *dot > 0.0).sum();
        if back > BACK * all * whole.length() || whole.length() < CROSSED * all {
            bad.push(pieces[0]);
        }
    }
    if bad.is_empty() {
        return Ok(());
    }
    let corners = |&element: &u32| {
        let quads = &file.quads;
        let corners = match quads.get(element as usize - cut) {
            Some(quad) => &quad[..],
            None => &file.polygons[element as usize - cut - quads.len()],
        };
        corners.iter().map(|&k| file.points[k as usize]).collect::<Vec<_>>()
    };
    let verb = if bad.len() == 1 { "crosses itself" } else { "cross themselves" };
    Err(Fault::new(format!("{} {verb}", capital(&file.describe_elements(&bad))))
        .at(format!("at {}", point_text(corners(&bad[0])[0])))
        .remedy("Give the corners in order around it, or split it into triangles")
        .showing(bad.iter().map(corners)))
}

/// Checks that the triangles are consistently oriented, after an attempt to orient them.
///
/// # Errors
/// A one-sided surface.
pub(super) fn one_sided(file: &MeshFile, mesh: &Triangles, edges: &Edges) -> Result<(), Fault> {
    let conflicts: Vec<[u32; 2]> = (0..edges.len())
        .filter_map(|edge| <[u32; 2]>::try_from(edges.get(edge).sides).ok())
        .filter(|[a, b]| mesh.side(*a) == mesh.side(*b))
        .collect();
    let Some(first) = conflicts.first() else { return Ok(()) };
    let origins: Vec<u32> = conflicts.as_flattened().iter().map(|side| mesh.origin[*side as usize / 3]).collect();
    let at = mesh.points[mesh.side(first[0])[0] as usize];
    Err(Fault::new(format!(
        "The surface is one-sided, like a Moebius strip: its triangles cannot be oriented consistently, here {}",
        file.describe_elements(&origins)
    ))
    .at(format!("at {}", point_text(at)))
    .remedy("Cut a gap across it")
    .showing(conflicts.iter().map(|[side, _]| mesh.side(*side).map(|k| mesh.points[k as usize]).to_vec())))
}

/// Checks that a mesh in the plane with anticlockwise triangles has no overlaps and no hanging points.
///
/// # Errors
/// The overlapping triangles, or the hanging points.
pub(in crate::core) fn overlapping(
    file: &MeshFile,
    points: &[DVec3],
    triangles: &[[u32; 3]],
    origins: &[u32],
) -> Result<(), Fault> {
    let mesh = MeshFile { points: points.to_vec(), triangles: triangles.to_vec(), ..MeshFile::default() };
    let found = examine(&mesh);
    let hanging = found.findings.iter().find(|finding| finding.defect == Defect::HangingNode);
    if hanging.is_none() && found.count(Defect::Overlap) == 0 && found.count(Defect::BranchingEdge) == 0 {
        return Ok(());
    }
    let corners = |t: &[u32; 3]| t.map(|k| points[k as usize]);
    let bad = overlaps(&triangles.iter().map(|t| corners(t).map(DVec3::truncate)).collect::<Vec<_>>());
    if let Some(&first) = bad.first() {
        let named: Vec<u32> = bad.iter().map(|&t| origins[t as usize]).collect();
        let at = corners(&triangles[first as usize]).iter().sum::<DVec3>() / 3.0;
        return Err(Fault::new(format!("{} overlap", capital(&file.describe_elements(&named))))
            .at(format!("at {}", point_text(at.truncate())))
            .remedy("Remove the overlap: triangles in the plane must not overlap")
            .showing(bad.iter().map(|&t| corners(&triangles[t as usize]).to_vec())));
    }
    let Some(hanging) = hanging else { return Ok(()) };
    // Points made by dividing sides are not in the file.
    let nodes: Vec<u32> = hanging.first.iter().map(|one| one.number as u32 - 1).collect();
    let own: Vec<u32> = nodes.iter().copied().filter(|&k| (k as usize) < file.points.len()).collect();
    let verb =
        if hanging.count == 1 { "hangs on a side of another triangle" } else { "hang on sides of other triangles" };
    let more = hanging.count.saturating_sub(own.len() as u64);
    let and = if more > 0 { format!(" and {more} more") } else { String::new() };
    let first = points[nodes[0] as usize];
    Err(Fault::new(format!("{}{and} {verb}", capital(&file.describe_points(&own))))
        .at(format!("at {}", point_text(first.truncate())))
        .remedy("Divide that side there, or remesh the shape (--use shape)")
        .showing(nodes.iter().map(|&k| vec![points[k as usize]])))
}

/// The anticlockwise triangles whose interiors intersect others, ascending.
fn overlaps(triangles: &[[DVec2; 3]]) -> Vec<u32> {
    let boxed = |t: &[DVec2; 3]| {
        let [low, high] = [t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2])];
        AABB::from_corners(low.to_array(), high.to_array())
    };
    let boxes = (0_u32..).zip(triangles).map(|(i, t)| GeomWithData::new(Rectangle::from_aabb(boxed(t)), i)).collect();
    let tree: RTree<GeomWithData<Rectangle<[f64; 2]>, u32>> = RTree::bulk_load(boxes);
    // Convex polygons are disjoint if a side of one separates them.
    let beyond =
        |a: &[DVec2; 3], b: &[DVec2; 3]| (0..3).any(|k| b.iter().all(|&p| orient(a[k], a[(k + 1) % 3], p) <= 0.0));
    let mut left = PAIRS * triangles.len();
    let mut bad = Vec::new();
    for (i, t) in (0_u32..).zip(triangles) {
        for other in tree.locate_in_envelope_intersecting(boxed(t)).map(|near| near.data).filter(|&other| other > i) {
            let o = &triangles[other as usize];
            if !beyond(t, o) && !beyond(o, t) {
                bad.extend([i, other]);
            }
            left = left.saturating_sub(1);
        }
        if left == 0 {
            break;
        }
    }
    bad.sort_unstable();
    bad.dedup();
    bad
}
