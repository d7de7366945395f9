//! What no surface can be made of and nobody can mend for certain: refused with the elements called as the file counts
//! them, and shown.

use glam::{DVec2, DVec3};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::edges::{Edges, Triangles};
use crate::core::fault::Fault;
use crate::core::kernel::decimal::{number, point_text};
use crate::core::kernel::predicates::orient;
use crate::core::soup::mesh_file::MeshFile;
use crate::core::soup::soundness::{Defect, examine};

/// Coordinates beyond this, and meshes smaller than one over this, cannot be reckoned with: products of several of them
/// have no number.
pub(in crate::core) const LARGEST: f64 = 1e30;
/// A surface smaller than this part of how far it is from the origin has too few digits for its normals.
const FAR: f64 = 5e-8;
/// A polygon whose pieces face each other, so that no more than this part of their areas is left as a whole, crosses
/// itself.
const CROSSED: f64 = 0.2;
/// A polygon smaller than this part of its length squared has no area.
const FLAT: f64 = 1e-6;
/// So much of a polygon may lie with its back to the whole, by rounding.
const BACK: f64 = 1e-6;
/// Pairs of triangles that are looked at for each triangle until enough is known of where they overlap.
const PAIRS: usize = 64;

/// A place in space as messages show it, to six digits.
pub(super) fn place(p: DVec3) -> String {
    format!("({}, {}, {})", number(p.x), number(p.y), number(p.z))
}

/// Whether the triangles that are made of a file have points that can be reckoned with; which of the points they have.
///
/// # Errors
/// No triangles, or too many; points that are not there, not finite, beyond [`LARGEST`], or all nearer to each other
/// than one over it.
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
        return Err(Fault::new(format!("The mesh has {} triangles, more than can be numbered", triangles.len())));
    }
    let mut used = vec![false; file.points.len()];
    for (t, origin) in triangles.iter().zip(origins) {
        for &k in t {
            let Some(used) = used.get_mut(k as usize) else {
                let what = format!(
                    "{} has the point {}, and there are {}",
                    capital(&file.describe_elements(&[*origin])),
                    u64::from(k) + 1,
                    file.points.len()
                );
                return Err(Fault::new(what).remedy("Write the mesh again, with all points that its triangles have"));
            };
            *used = true;
        }
    }
    let of_use = || (0..).zip(&file.points).filter(|(k, _)| used[*k as usize]).map(|(k, p): (u32, &DVec3)| (k, *p));
    let is_beyond = |p: DVec3| !p.is_finite() || p.abs().max_element() > LARGEST;
    let beyond: Vec<u32> = of_use().filter(|(_, p)| is_beyond(*p)).map(|(k, _)| k).collect();
    if let Some(&first) = beyond.first() {
        let p = place(file.points[first as usize]);
        let what = match beyond.len() {
            1 => format!("{} is at {p}", capital(&file.describe_points(&beyond))),
            _ => format!("{} are not where points can be, the first at {p}", capital(&file.describe_points(&beyond))),
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
            place(file.points[triangles[0][0] as usize])
        ))
        .remedy("Write it with more digits, or in another unit"));
    }
    if size < 1.0 / LARGEST {
        return Err(Fault::new(format!("The mesh is only {} large", number(size))).remedy("Write it in another unit"));
    }
    Ok(used)
}

/// Whether points have digits enough for normals and areas of what lies between them.
///
/// # Errors
/// A surface far from the origin for its size.
pub(super) fn far_away(mesh: &Triangles) -> Result<(), Fault> {
    let corners = mesh.triangles.as_flattened().iter().map(|&k| mesh.points[k as usize]);
    let ends = corners.map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let [low, high] = ends.unwrap_or([DVec3::ZERO; 2]);
    let (size, away) = ((high - low).max_element(), low.abs().max(high.abs()).max_element());
    if size >= FAR * away {
        return Ok(());
    }
    let what =
        format!("The mesh is {} large and lies {} from the origin: too far for its size", number(size), number(away));
    Err(Fault::new(what).remedy("Move it to the origin: its coordinates have too few digits where it is"))
}

/// A sentence that begins with such words.
pub(in crate::core) fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Whether polygons that were cut cross themselves. What stands next to each other in `triangles` and comes from the
/// same element are the pieces of one.
///
/// # Errors
/// Those that do.
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
        // One without area is taken out by its pieces.
        if all <= FLAT * size * size {
            continue;
        }
        // A plane one that crosses itself has pieces that lie with their backs to the whole.
        let back: f64 = of.iter().map(|t| -area(t).dot(whole)).filter(|dot| *dot > 0.0).sum();
        if back > BACK * all * whole.length() || whole.length() < CROSSED * all {
            bad.push(pieces[0]);
        }
    }
    if bad.is_empty() {
        return Ok(());
    }
    let corners = |&place: &u32| {
        let quads = &file.quads;
        let corners = match quads.get(place as usize - cut) {
            Some(quad) => &quad[..],
            None => &file.polygons[place as usize - cut - quads.len()],
        };
        corners.iter().map(|&k| file.points[k as usize]).collect::<Vec<_>>()
    };
    let verb = if bad.len() == 1 { "crosses itself" } else { "cross themselves" };
    Err(Fault::new(format!("{} {verb}", capital(&file.describe_elements(&bad))))
        .at(format!("at {}", place(corners(&bad[0])[0])))
        .remedy("Give the corners in the order in which they lie around it, or cut it into triangles")
        .showing(bad.iter().map(corners)))
}

/// Whether triangles agree with their neighbours on which side is outside, once they are turned as far as that goes.
///
/// # Errors
/// A surface that has one side only.
pub(super) fn one_sided(file: &MeshFile, mesh: &Triangles, edges: &Edges) -> Result<(), Fault> {
    let conflicts: Vec<[u32; 2]> = (0..edges.len())
        .filter_map(|edge| <[u32; 2]>::try_from(edges.get(edge).sides).ok())
        .filter(|[a, b]| mesh.side(*a) == mesh.side(*b))
        .collect();
    let Some(first) = conflicts.first() else { return Ok(()) };
    let origins: Vec<u32> = conflicts.as_flattened().iter().map(|side| mesh.origin[*side as usize / 3]).collect();
    let at = mesh.points[mesh.side(first[0])[0] as usize];
    Err(Fault::new(format!(
        "The surface has one side only, as a Moebius strip: however its triangles are turned, some disagree with their neighbours, here {}",
        file.describe_elements(&origins)
    ))
    .at(format!("at {}", place(at)))
    .remedy("Cut a gap across it: a mesh has an outside")
    .showing(conflicts.iter().map(|[side, _]| mesh.side(*side).map(|k| mesh.points[k as usize]).to_vec())))
}

/// Whether a mesh in the plane, its triangles anticlockwise, covers no place twice and has no points that hang in
/// sides.
///
/// # Errors
/// Triangles that overlap, and points that hang.
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
            .remedy("Take out what is too much: in the plane a place belongs to one triangle")
            .showing(bad.iter().map(|&t| corners(&triangles[t as usize]).to_vec())));
    }
    let Some(hanging) = hanging else { return Ok(()) };
    // Points that were made by dividing sides are none of the file's.
    let nodes: Vec<u32> = hanging.first.iter().map(|one| one.number as u32 - 1).collect();
    let own: Vec<u32> = nodes.iter().copied().filter(|&k| (k as usize) < file.points.len()).collect();
    let verb =
        if hanging.count == 1 { "hangs in a side of another triangle" } else { "hang in sides of other triangles" };
    let more = hanging.count.saturating_sub(own.len() as u64);
    let and = if more > 0 { format!(" and {more} more") } else { String::new() };
    let first = points[nodes[0] as usize];
    Err(Fault::new(format!("{}{and} {verb}", capital(&file.describe_points(&own))))
        .at(format!("at {}", point_text(first.truncate())))
        .remedy("Divide that side there, or mesh the shape anew (--use shape)")
        .showing(nodes.iter().map(|&k| vec![points[k as usize]])))
}

/// Triangles, anticlockwise, that have more than sides in common with another one, ascending.
fn overlaps(triangles: &[[DVec2; 3]]) -> Vec<u32> {
    let boxed = |t: &[DVec2; 3]| {
        let [low, high] = [t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2])];
        AABB::from_corners(low.to_array(), high.to_array())
    };
    let boxes = (0_u32..).zip(triangles).map(|(i, t)| GeomWithData::new(Rectangle::from_aabb(boxed(t)), i)).collect();
    let tree: RTree<GeomWithData<Rectangle<[f64; 2]>, u32>> = RTree::bulk_load(boxes);
    // Two convex figures are apart where a side of one of them has the other beyond it.
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
