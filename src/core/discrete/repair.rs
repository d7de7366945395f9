//! Makes a surface of the triangles of a file: defects with one safe repair are repaired and reported, others are
//! rejected.

use std::collections::{BTreeSet, VecDeque};

use super::defects::{LARGEST, crossed, far_from_origin, one_sided, overlapping, used_points};
use super::edges::{Edges, Groups, Triangles};
use super::lines::{PointGroups, on_edges, on_points};
use crate::core::fault::Fault;
use crate::core::kernel::box_tree::extent;
use crate::core::mesh::Named;
use crate::core::progress::{Cancel, Stage, Watch};
use crate::core::soup::{Borders, MeshFile, Repair};

/// A triangle whose height is below this fraction of its longest side is degenerate,
const FLAT: f64 = 1e-6;
/// and so is one whose height is below this fraction of the size of the surface.
const LOW: f64 = 1e-6;
/// Rounds of edge swaps: removing one degenerate triangle may create another.
const ROUNDS: usize = 16;
/// Steps for progress.
const STEPS: u64 = 8;

/// A repaired surface.
#[derive(Clone, Debug)]
pub struct Repaired {
    /// The triangles.
    pub mesh: Triangles,
    /// The groups of its hard points, by number.
    pub points: PointGroups,
    /// For each point of the mesh after those of the file, the point of which it is a copy.
    pub copied: Vec<u32>,
    /// The regions, by index.
    pub regions: Vec<Named>,
    /// The lines, by index.
    pub lines: Vec<Named>,
    /// The repairs, as phrases without a full stop.
    pub repairs: Vec<String>,
}

/// The repaired triangles of a file. Splits quadrilaterals and polygons; merges coincident points; inserts hanging
/// points on the border; removes duplicate and degenerate triangles; orients neighbours consistently where possible,
/// and a mesh in a plane z = constant upwards; separates parts that touch in a point. Lines in a group become those of
/// the edges on them. With a `joint`, a distance, points up to there from a side hang on it, borders that end on the
/// edges of other sheets are joined to them ([`Triangles::stitch`]), and borders that nearly touch are told.
///
/// # Errors
/// Defects without a safe repair, named by the file's numbers: no triangles; missing points or coordinates out of
/// range; self-intersecting polygons; one-sided surfaces; overlaps in the plane. [`Fault::stopped`].
pub fn repair(file: &MeshFile, joint: Option<f64>, watch: &mut dyn Watch) -> Result<Repaired, Fault> {
    let mut repairs = Vec::new();
    let cancel = watch.cancel();
    let mut begin = |step: u64| {
        watch.tell(Stage::Repair, step, STEPS);
        cancel.check()
    };
    begin(0)?;
    let (given, plane, origin) = (file, file.is_plane(), file.origins());
    let (file, cut) = file.clone().triangulated();
    begin(1)?;
    Repair::Triangulated.report(cut, &mut repairs);
    let used = used_points(given, &file.triangles, &origin)?;
    crossed(given, &file.triangles, &origin)?;
    Repair::UnusedPoint.report(used.iter().filter(|used| !**used).count(), &mut repairs);
    let tag = |i: usize| file.triangle_tags.get(i).copied().unwrap_or(0);
    let tags: Vec<u32> = (0..file.triangles.len()).map(tag).collect::<BTreeSet<u32>>().into_iter().collect();
    let regions = tags.iter().map(|&tag| file.region(tag)).collect();
    let region = (0..file.triangles.len()).map(|i| tags.partition_point(|&t| t < tag(i)) as u32).collect();
    let texture = file.texture.as_ref().map_or_else(Vec::new, |texture| {
        (0..file.triangles.len()).map(|triangle| texture.of_triangle(triangle)).collect()
    });
    let (lines, line_of) = file.line_groups();
    let segments: Vec<([u32; 2], u32)> =
        file.lines.iter().zip(line_of).filter_map(|(&ends, line)| Some((ends, line?))).collect();
    let mut mesh = Triangles {
        points: file.points,
        triangles: file.triangles,
        region,
        lines: Vec::new(),
        hard: Vec::new(),
        texture,
        origin,
        elements: given.elements(),
    };
    far_from_origin(&mesh)?;
    begin(2)?;
    let welded = mesh.weld(&cancel);
    begin(3)?;
    Repair::MergedPoint.report(welded, &mut repairs);
    let branching = |mesh: &Triangles| -> Result<usize, Fault> {
        let edges = Edges::unless(&mesh.triangles, &cancel)?;
        Ok((0..edges.len()).filter(|&edge| edges.get(edge).sides.len() > 2).count())
    };
    let before = if joint.is_some() { branching(&mesh)? } else { 0 };
    let stitched = mesh.stitch(false, joint, &cancel);
    Repair::HangingPoint.report(stitched, &mut repairs);
    if joint.is_some() && stitched > 0 {
        Repair::BranchingEdge.report(branching(&mesh)?.saturating_sub(before), &mut repairs);
    }
    begin(4)?;
    Repair::DuplicateTriangle.report(mesh.remove_duplicates(&cancel), &mut repairs);
    begin(5)?;
    Repair::DegenerateTriangle.report(mesh.remove_degenerate(), &mut repairs);
    begin(6)?;
    if mesh.triangles.is_empty() {
        let shapes = given.triangles.iter().map(|t| t.map(|k| given.points[k as usize]).to_vec());
        return Err(Fault::new("No triangle of the mesh has an area: the corners of each are collinear")
            .remedy("Export it with more digits, or in another unit")
            .showing(shapes));
    }
    if plane {
        Repair::ClockwiseTriangle.report(mesh.orient_upwards(), &mut repairs);
        overlapping(given, &mesh.points, &mesh.triangles, &mesh.origin)?;
    } else {
        let reversed = mesh.orient(&cancel);
        one_sided(given, &mesh, &Edges::unless(&mesh.triangles, &cancel)?)?;
        Repair::ReversedTriangle.report(reversed, &mut repairs);
    }
    if joint.is_some() {
        let borders = Borders::of(&mesh.points, mesh.triangles.iter().map(|t| &t[..]));
        repairs.extend(borders.not_joined(!plane, &cancel));
    }
    begin(7)?;
    let (copied, separated, pinched) = mesh.separate(&cancel);
    begin(STEPS)?;
    Repair::ContactPoint.report(separated, &mut repairs);
    Repair::PinchedNode.report(pinched, &mut repairs);
    let lost;
    (mesh.lines, lost) = on_edges(&segments, &mesh, &copied);
    Repair::LineOffEdges.report(lost, &mut repairs);
    let (hard, points, lost) = on_points(&given.hard_points(), &mesh, &copied);
    mesh.hard = hard;
    Repair::PointOffCorners.report(lost, &mut repairs);
    Ok(Repaired { mesh, regions, lines, points, copied, repairs })
}

/// The unrepaired triangles of a file, for display when it is rejected; without those that cannot be drawn.
pub fn unrepaired(file: &MeshFile) -> Triangles {
    let mut mesh = Triangles { origin: file.origins(), elements: file.elements(), ..Triangles::default() };
    let (file, _) = file.clone().triangulated();
    (mesh.points, mesh.triangles) = (file.points, file.triangles);
    let is_valid = |k: &u32| mesh.points.get(*k as usize).is_some_and(|p| p.abs().max_element() <= LARGEST);
    let keep: Vec<bool> = mesh.triangles.iter().map(|t| t.iter().all(is_valid)).collect();
    mesh.region = vec![0; mesh.triangles.len()];
    mesh.keep(&keep);
    mesh
}

/// Removes the items whose flag is false.
pub(in crate::core) fn retain<T>(items: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    items.retain(|_| keep.next() != Some(&false));
}

impl Triangles {
    fn keep(&mut self, keep: &[bool]) {
        retain(&mut self.triangles, keep);
        retain(&mut self.region, keep);
        retain(&mut self.texture, keep);
        retain(&mut self.origin, keep);
    }

    /// Removes the texture coordinates of a changed triangle.
    pub(super) fn forget_texture(&mut self, triangle: usize) {
        if let Some(places) = self.texture.get_mut(triangle) {
            *places = None;
        }
    }

    /// Removes triangles with the nodes of an earlier one; returns their number.
    fn remove_duplicates(&mut self, cancel: &Cancel) -> usize {
        let key = |t: &[u32; 3]| {
            let mut t = *t;
            t.sort_unstable();
            t
        };
        let of = |i: u32| key(&self.triangles[i as usize]);
        let mut groups = Groups::of(self.triangles.len(), self.points.len(), |i| of(i)[0]);
        if cancel.is_asked() {
            return 0;
        }
        let mut keep = vec![true; self.triangles.len()];
        for alike in groups.iter_mut() {
            alike.sort_unstable_by_key(|&i| (of(i), i));
            alike.windows(2).for_each(|w| keep[w[1] as usize] = of(w[0]) != of(w[1]));
        }
        self.keep(&keep);
        keep.iter().filter(|k| !**k).count()
    }

    /// The corner opposite the longest side.
    fn apex(&self, triangle: usize) -> usize {
        let p = self.corners(triangle);
        let long = |k: usize| p[(k + 1) % 3].distance_squared(p[(k + 2) % 3]);
        (0..3).max_by(|&a, &b| long(a).total_cmp(&long(b)).then(b.cmp(&a))).unwrap_or(0)
    }

    /// Whether a triangle has a repeated node.
    fn is_repeated(&self, triangle: usize) -> bool {
        let [a, b, c] = self.triangles[triangle];
        a == b || b == c || c == a
    }

    /// Removes degenerate triangles; returns their number.
    fn remove_degenerate(&mut self) -> usize {
        let (low, high) = extent(self.points.iter().copied());
        let least = LOW * (high - low).max_element();
        let is_flat = |mesh: &Triangles, triangle: usize| {
            let apex = mesh.apex(triangle);
            let p = mesh.corners(triangle);
            let long = p[(apex + 1) % 3].distance_squared(p[(apex + 2) % 3]);
            let area = mesh.area_vector(triangle).length();
            area <= FLAT * long || area <= least * long.sqrt()
        };
        let swapped = self.swap_degenerate(&is_flat);
        // Drop those that remain.
        let keep: Vec<bool> = (0..self.triangles.len()).map(|t| !is_flat(self, t) && !self.is_repeated(t)).collect();
        self.keep(&keep);
        swapped + keep.iter().filter(|k| !**k).count()
    }

    /// Removes flat triangles and those with a repeated node by swapping their longest side, which divides the
    /// neighbour there at the apex; returns their number. Some may remain.
    pub(in crate::core) fn swap_degenerate(&mut self, is_flat: &dyn Fn(&Triangles, usize) -> bool) -> usize {
        let mut taken = 0;
        for _ in 0..ROUNDS {
            let flat: Vec<(usize, usize)> = (0..self.triangles.len())
                .filter(|&t| self.is_repeated(t) || is_flat(self, t))
                .map(|t| (t, self.apex(t)))
                .collect();
            if flat.is_empty() {
                break;
            }
            let edges = Edges::of(&self.triangles);
            let mut keep = vec![true; self.triangles.len()];
            let mut touched = vec![false; self.triangles.len()];
            for (t, apex) in flat {
                if touched[t] {
                    continue;
                }
                let nodes = self.triangles[t];
                let repeated = self.is_repeated(t);
                let side = (3 * t + (apex + 1) % 3) as u32;
                // At the border, with an apex of no other triangle, it is a part of the border: drop it.
                let is_free = |k: usize| edges.get(edges.of_side((3 * t + (apex + k) % 3) as u32)).sides.len() == 1;
                let beyond = edges.get(edges.of_side(side)).sides.iter().copied().find(|&other| other != side);
                if let Some(other) = beyond.filter(|_| !(repeated || is_free(0) && is_free(2))) {
                    let o = other as usize / 3;
                    if touched[o] || !keep[o] {
                        continue;
                    }
                    let k = other as usize % 3;
                    let [a, b, far] = [0, 1, 2].map(|i| self.triangles[o][(k + i) % 3]);
                    if far == nodes[apex] {
                        // Folded onto itself: drop both.
                        keep[o] = false;
                    } else {
                        // The flat triangle's slot takes the second half.
                        self.triangles[o] = [a, nodes[apex], far];
                        self.triangles[t] = [nodes[apex], b, far];
                        self.region[t] = self.region[o];
                        if !self.origin.is_empty() {
                            self.origin[t] = self.origin[o];
                        }
                        self.forget_texture(t);
                        self.forget_texture(o);
                        (touched[o], touched[t]) = (true, true);
                        taken += 1;
                        continue;
                    }
                    touched[o] = true;
                }
                touched[t] = true;
                keep[t] = false;
                taken += 1;
            }
            self.keep(&keep);
        }
        taken
    }

    /// Orients the triangles of a plane mesh towards +z; returns the number reversed.
    fn orient_upwards(&mut self) -> usize {
        let down: Vec<usize> = (0..self.triangles.len()).filter(|&t| self.area_vector(t).z < 0.0).collect();
        down.iter().for_each(|&t| self.reverse(t));
        down.len()
    }

    fn reverse(&mut self, triangle: usize) {
        self.triangles[triangle].swap(1, 2);
        if let Some(Some(places)) = self.texture.get_mut(triangle) {
            places.swap(1, 2);
        }
    }

    /// Orients neighbours at edges of two triangles consistently, part by part, each like the majority of its
    /// triangles; returns the number reversed. A one-sided part (a Moebius strip) keeps edges with a conflict
    /// ([`one_sided`]).
    fn orient(&mut self, cancel: &Cancel) -> usize {
        let Ok(edges) = Edges::unless(&self.triangles, cancel) else { return 0 };
        let mut turned: Vec<Option<bool>> = vec![None; self.triangles.len()];
        let mut count = 0;
        for first in 0..self.triangles.len() {
            if turned[first].is_some() {
                continue;
            }
            turned[first] = Some(false);
            let mut part = vec![first];
            let mut next = 0;
            // Cross conflicts last, so that a one-sided part keeps its conflicts where it has them.
            let mut later: VecDeque<(usize, usize)> = VecDeque::new();
            loop {
                if next == part.len() {
                    let Some((t, other)) = later.pop_front() else { break };
                    if turned[other].is_none() {
                        turned[other] = turned[t].map(|turned| !turned);
                        part.push(other);
                    }
                    continue;
                }
                let t = part[next];
                next += 1;
                for side in 3 * t as u32..3 * t as u32 + 3 {
                    let [a, b] = *edges.get(edges.of_side(side)).sides else { continue };
                    let other = if a == side { b } else { a } as usize / 3;
                    if turned[other].is_none() {
                        if self.side(a) == self.side(b) {
                            later.push_back((t, other));
                        } else {
                            turned[other] = turned[t];
                            part.push(other);
                        }
                    }
                }
            }
            let share = part.iter().filter(|&&t| turned[t] == Some(true)).count();
            let flip = 2 * share > part.len();
            for &t in &part {
                let turn = turned[t] == Some(!flip);
                turned[t] = Some(turn);
                if turn {
                    self.reverse(t);
                    count += 1;
                }
            }
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::features::{Feature, features};
    use crate::core::discrete::fixtures::{border_edges, plate, sphere, torus};
    use crate::core::progress::Nobody;
    use glam::DVec3;

    fn file(mesh: &Triangles) -> MeshFile {
        MeshFile { points: mesh.points.clone(), triangles: mesh.triangles.clone(), ..MeshFile::default() }
    }

    #[test]
    fn neighbours_are_oriented_like_the_majority() {
        let ball = sphere(5);
        let mut given = file(&ball);
        for i in (0..given.triangles.len()).step_by(3) {
            given.triangles[i].swap(0, 1);
        }
        let found = repair(&given, None, &mut Nobody).unwrap();
        assert_eq!(found.repairs, ["100 triangles were reversed to match neighbours".to_owned()]);
        let edges = Edges::of(&found.mesh.triangles);
        assert!(features(&found.mesh, &edges, 3.2).iter().all(|f| *f != Some(Feature::Conflict)));
        let outward = (0..found.mesh.triangles.len())
            .all(|t| found.mesh.area_vector(t).dot(found.mesh.corners(t).iter().sum::<DVec3>()) > 0.0);
        assert!(outward);
    }

    #[test]
    fn removing_flat_triangles_leaves_no_gap() {
        // A point on the diagonal of a square belongs to one side only; a flat triangle closes the gap.
        let mut given = file(&plate(2, 0.0));
        let [a, _, c] = given.triangles[0];
        let middle = given.points.len() as u32;
        let place = (given.points[a as usize] + given.points[c as usize]) * 0.5;
        given.points.push(place);
        let [_, b, _] = given.triangles[0];
        given.triangles[0] = [a, b, middle];
        given.triangles.push([b, c, middle]);
        given.triangles.push([a, middle, c]);
        given.triangles.push([a, a, c]);
        let found = repair(&given, None, &mut Nobody).unwrap();
        assert_eq!((found.mesh.triangles.len(), border_edges(&found.mesh)), (10, 8));
        assert!(found.repairs[0].contains("degenerate"), "{:?}", found.repairs);
    }

    #[test]
    fn duplicates_are_removed_and_invalid_meshes_are_refused() {
        let mut given = file(&torus(6, 5));
        let n = given.triangles.len();
        let [a, b, c] = given.triangles[3];
        given.triangles.push([c, a, b]);
        assert_eq!(repair(&given, None, &mut Nobody).unwrap().mesh.triangles.len(), n);
        given.triangles.push([0, 1, 999]);
        assert!(repair(&given, None, &mut Nobody).unwrap_err().to_string().contains("point 1000"));
        given.triangles.pop();
        given.points[0].y = f64::NAN;
        assert!(repair(&given, None, &mut Nobody).is_err());
        assert!(repair(&MeshFile::default(), None, &mut Nobody).is_err());
    }
}
