//! Triangles of a file made fit to be a surface: what can be mended for certain is mended and told; what is no mesh is refused.

use std::collections::{BTreeSet, VecDeque};

use glam::DVec3;

use super::edges::{Edges, Groups, Triangles};
use super::lines::on_edges;
use super::refuse::{LARGEST, crossed, far_away, one_sided, overlapping, used_points};
use crate::core::fault::Fault;
use crate::core::mesh::names::Named;
use crate::core::progress::{Cancel, Stage, Watch};
use crate::core::soup::mesh_file::MeshFile;

/// A triangle flatter than this part of its longest side has no plane of its own.
const FLAT: f64 = 1e-6;
/// Nor has one that is no higher than this part of the whole surface.
const LOW: f64 = 1e-6;
/// Turning the longest side of a flat triangle may leave another; so often it is tried.
const ROUNDS: usize = 16;
/// What is told of as one step each.
const STEPS: u64 = 8;

/// A surface with the names of its regions and what was mended.
#[derive(Clone, Debug)]
pub struct Sound {
    /// The triangles.
    pub mesh: Triangles,
    /// The points that the mesh has beyond the file's, by those that they were.
    pub copied: Vec<u32>,
    /// Names of the regions by number.
    pub regions: Vec<Named>,
    /// Names of the lines by number.
    pub lines: Vec<Named>,
    /// What was mended, sentences without a full stop.
    pub repairs: Vec<String>,
}

/// The triangles of a file: quadrilaterals and polygons cut; points at one place used as one, and points that hang in sides of
/// the border taken into them; triangles with a node twice or without area, and duplicates, taken out; all
/// turned so that neighbours agree on which side is outside, where that can be; parts that touch in a point set apart. Lines that
/// are in a group become those of the edges that they lie on. A mesh in a plane z = constant looks up.
///
/// # Errors
/// What cannot be mended for certain, with the elements as the file counts them: no triangles; points that are not there or not where
/// points can be; polygons that cross themselves; surfaces with one side; overlaps in the plane. [`Fault::stopped`].
pub fn sound(file: &MeshFile, watch: &mut dyn Watch) -> Result<Sound, Fault> {
    let mut repairs = Vec::new();
    let mut tell = |n: usize, one: &str, several: &str| match n {
        0 => {}
        1 => repairs.push(format!("1 {one}")),
        n => repairs.push(format!("{n} {several}")),
    };
    let cancel = watch.cancel();
    let mut begin = |step: u64| {
        watch.tell(Stage::Mend, step, STEPS);
        cancel.check()
    };
    begin(0)?;
    let (given, plane, origin) = (file, file.is_plane(), file.origins());
    let (file, cut) = file.clone().triangulated();
    begin(1)?;
    tell(cut, "quadrilateral or polygon was cut into triangles", "quadrilaterals and polygons were cut into triangles");
    let used = used_points(given, &file.triangles, &origin)?;
    crossed(given, &file.triangles, &origin)?;
    let orphans = used.iter().filter(|used| !**used).count();
    tell(orphans, "point without triangles was left out", "points without triangles were left out");
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
        texture,
        origin,
        elements: given.elements(),
    };
    far_away(&mesh)?;
    begin(2)?;
    let welded = mesh.weld(&cancel);
    begin(3)?;
    tell(welded, "point lay on another and was made one with it", "points lay on others and were made one with them");
    let stitched = mesh.stitch(false, &cancel);
    tell(stitched, "point hung in a side and was taken into it", "points hung in sides and were taken into them");
    begin(4)?;
    let doubles = mesh.drop_doubles(&cancel);
    tell(doubles, "duplicate triangle was left out", "duplicate triangles were left out");
    begin(5)?;
    let flat = mesh.take_out_flat_ones();
    tell(flat, "triangle without area was taken out", "triangles without area were taken out");
    begin(6)?;
    if mesh.triangles.is_empty() {
        let shapes = given.triangles.iter().map(|t| t.map(|k| given.points[k as usize]).to_vec());
        return Err(Fault::new("No triangle of the mesh has an area: the corners of each lie on a line")
            .remedy("Write it with more digits, or in another unit")
            .showing(shapes));
    }
    if plane {
        let turned = mesh.look_up();
        tell(turned, "clockwise triangle was turned", "clockwise triangles were turned");
        overlapping(given, &mesh.points, &mesh.triangles, &mesh.origin)?;
    } else {
        let turned = mesh.orient(&cancel);
        one_sided(given, &mesh, &Edges::unless(&mesh.triangles, &cancel)?)?;
        tell(
            turned,
            "triangle was turned to agree with its neighbours",
            "triangles were turned to agree with their neighbours",
        );
    }
    begin(7)?;
    let (copied, parted, pinched) = mesh.part(&cancel);
    begin(STEPS)?;
    tell(parted, "point in which parts touched was parted", "points in which parts touched were parted");
    tell(
        pinched,
        "node was split where triangles meet in a point only",
        "nodes were split where triangles meet in a point only",
    );
    let lost;
    (mesh.lines, lost) = on_edges(&segments, &mesh, &copied);
    tell(
        lost,
        "line is on no edge of the mesh and was left out",
        "lines are on no edges of the mesh and were left out",
    );
    Ok(Sound { mesh, regions, lines, copied, repairs })
}

/// The triangles of a file as they are, to be shown where it is refused; without those that have no place.
pub fn as_given(file: &MeshFile) -> Triangles {
    let mut mesh = Triangles { origin: file.origins(), elements: file.elements(), ..Triangles::default() };
    let (file, _) = file.clone().triangulated();
    (mesh.points, mesh.triangles) = (file.points, file.triangles);
    let is_there = |k: &u32| mesh.points.get(*k as usize).is_some_and(|p| p.abs().max_element() <= LARGEST);
    let keep: Vec<bool> = mesh.triangles.iter().map(|t| t.iter().all(is_there)).collect();
    mesh.region = vec![0; mesh.triangles.len()];
    mesh.keep(&keep);
    mesh
}

impl Triangles {
    fn keep(&mut self, keep: &[bool]) {
        let mut at = keep.iter();
        self.triangles.retain(|_| at.next() != Some(&false));
        let mut at = keep.iter();
        self.region.retain(|_| at.next() != Some(&false));
        let mut at = keep.iter();
        self.texture.retain(|_| at.next() != Some(&false));
        let mut at = keep.iter();
        self.origin.retain(|_| at.next() != Some(&false));
    }

    /// Lets a triangle that was changed lie nowhere on the texture.
    pub(super) fn forget_texture(&mut self, triangle: usize) {
        if let Some(places) = self.texture.get_mut(triangle) {
            *places = None;
        }
    }

    /// Takes out triangles with the nodes of an earlier one. How many those were.
    fn drop_doubles(&mut self, cancel: &Cancel) -> usize {
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

    /// The corner opposite to the longest side.
    fn apex(&self, triangle: usize) -> usize {
        let p = self.corners(triangle);
        let long = |k: usize| p[(k + 1) % 3].distance_squared(p[(k + 2) % 3]);
        (0..3).max_by(|&a, &b| long(a).total_cmp(&long(b)).then(b.cmp(&a))).unwrap_or(0)
    }

    /// Whether a triangle has a node twice.
    fn is_repeated(&self, triangle: usize) -> bool {
        let [a, b, c] = self.triangles[triangle];
        a == b || b == c || c == a
    }

    /// Takes out triangles that have no plane of their own or are nearly as low as nothing. How many those were.
    fn take_out_flat_ones(&mut self) -> usize {
        let (low, high) = self
            .points
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        let least = LOW * (high - low).max_element();
        let is_flat = |mesh: &Triangles, triangle: usize| {
            let apex = mesh.apex(triangle);
            let p = mesh.corners(triangle);
            let long = p[(apex + 1) % 3].distance_squared(p[(apex + 2) % 3]);
            let area = mesh.area_vector(triangle).length();
            area <= FLAT * long || area <= least * long.sqrt()
        };
        let turned = self.turn_flat_ones(&is_flat);
        // What is flat after all that is left out.
        let keep: Vec<bool> = (0..self.triangles.len()).map(|t| !is_flat(self, t) && !self.is_repeated(t)).collect();
        self.keep(&keep);
        turned + keep.iter().filter(|k| !**k).count()
    }

    /// Takes out flat triangles, and those with a node twice: the one beyond the longest side gets the corner that stands on that
    /// side. How many those were; some may be left.
    pub(in crate::core) fn turn_flat_ones(&mut self, is_flat: &dyn Fn(&Triangles, usize) -> bool) -> usize {
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
                let twice = self.is_repeated(t);
                let side = (3 * t + (apex + 1) % 3) as u32;
                // One at the border, on whose corner nothing else stands, is a part of that.
                let is_free = |k: usize| edges.get(edges.of_side((3 * t + (apex + k) % 3) as u32)).sides.len() == 1;
                let beyond = edges.get(edges.of_side(side)).sides.iter().copied().find(|&other| other != side);
                if let Some(other) = beyond.filter(|_| !(twice || is_free(0) && is_free(2))) {
                    let o = other as usize / 3;
                    if touched[o] || !keep[o] {
                        continue;
                    }
                    let k = other as usize % 3;
                    let [a, b, far] = [0, 1, 2].map(|i| self.triangles[o][(k + i) % 3]);
                    if far == nodes[apex] {
                        // Folded onto itself: both go.
                        keep[o] = false;
                    } else {
                        // The flat one's place goes to the second half.
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

    /// Turns triangles of a mesh in a plane so that all look up. How many were turned.
    fn look_up(&mut self) -> usize {
        let down: Vec<usize> = (0..self.triangles.len()).filter(|&t| self.area_vector(t).z < 0.0).collect();
        down.iter().for_each(|&t| self.turn(t));
        down.len()
    }

    fn turn(&mut self, triangle: usize) {
        self.triangles[triangle].swap(1, 2);
        if let Some(Some(places)) = self.texture.get_mut(triangle) {
            places.swap(1, 2);
        }
    }

    /// Turns triangles so that neighbours at edges of two agree, part by part, each as the larger share of it was. How many were
    /// turned. A part that has but one side (a Moebius strip) keeps edges at which it disagrees ([`one_sided`]).
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
            // Where neighbours disagree is crossed last: in a part with one side they do so there and nowhere else.
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
                    self.turn(t);
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
    use crate::core::discrete::fixtures::{plate, sphere, torus};
    use crate::core::progress::Nobody;

    fn file(mesh: &Triangles) -> MeshFile {
        MeshFile { points: mesh.points.clone(), triangles: mesh.triangles.clone(), ..MeshFile::default() }
    }

    #[test]
    fn neighbours_that_disagree_are_turned_as_the_larger_share_is() {
        let ball = sphere(5);
        let mut given = file(&ball);
        for i in (0..given.triangles.len()).step_by(3) {
            given.triangles[i].swap(0, 1);
        }
        let found = sound(&given, &mut Nobody).unwrap();
        assert_eq!(found.repairs, ["100 triangles were turned to agree with their neighbours".to_owned()]);
        let edges = Edges::of(&found.mesh.triangles);
        assert!(features(&found.mesh, &edges, 3.2).iter().all(|f| *f != Some(Feature::Conflict)));
        let outward = (0..found.mesh.triangles.len())
            .all(|t| found.mesh.area_vector(t).dot(found.mesh.corners(t).iter().sum::<DVec3>()) > 0.0);
        assert!(outward);
    }

    #[test]
    fn flat_triangles_hand_their_corner_to_the_neighbour_beyond_and_leave_no_gap() {
        // A point on the diagonal of a square belongs to one side only: a flat triangle closes the gap.
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
        let found = sound(&given, &mut Nobody).unwrap();
        let edges = Edges::of(&found.mesh.triangles);
        let borders = (0..edges.len()).filter(|&e| edges.get(e).sides.len() == 1).count();
        assert_eq!((found.mesh.triangles.len(), borders), (10, 8));
        assert!(found.repairs[0].contains("without area"), "{:?}", found.repairs);
    }

    #[test]
    fn duplicates_go_and_what_is_no_mesh_is_refused() {
        let mut given = file(&torus(6, 5));
        let n = given.triangles.len();
        let [a, b, c] = given.triangles[3];
        given.triangles.push([c, a, b]);
        assert_eq!(sound(&given, &mut Nobody).unwrap().mesh.triangles.len(), n);
        given.triangles.push([0, 1, 999]);
        assert!(sound(&given, &mut Nobody).unwrap_err().to_string().contains("point 1000"));
        given.triangles.pop();
        given.points[0].y = f64::NAN;
        assert!(sound(&given, &mut Nobody).is_err());
        assert!(sound(&MeshFile::default(), &mut Nobody).is_err());
    }
}
