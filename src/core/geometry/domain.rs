//! Planar domains: faces bounded by outer loops and holes of named curves, with crack lines and repeated lines; faces
//! may share curves.

mod half;
mod symmetry;

pub use half::Half;

use std::sync::Arc;

use glam::{DVec2, DVec3};
use rstar::{AABB, RTree};

use super::assembly::{join_ends, loop_name, placed, resolve};
use super::atlas::Atlas;
use super::crossing::{self, Limits};
use super::domain_curve::{CurveId, CurveKind, DirectedCurve, DomainCurve};
use super::domain_point::DomainPoint;
use super::inside::{self, Chord};
use super::loops;
use super::mirror::Mirror;
use super::space_curve::SpaceCurve;
use super::spec::{CurveSpec, FaceSpec};
use crate::core::fault::Fault;
use crate::core::kernel::box_tree::extent;
use crate::core::kernel::decimal::{number, point_text};

/// A face of the domain.
#[derive(Clone, Debug)]
pub struct DomainFace {
    /// Its name.
    pub name: String,
    /// Groups of faces in which it is, besides its own name.
    pub groups: Vec<String>,
    /// The outer loop, anticlockwise, then the holes, clockwise: the face lies on the left of each.
    pub loops: Vec<Vec<DirectedCurve>>,
    /// Its topological loops (docs/algorithm.md, "Even loops"): boundary walks with the face on their left, with the
    /// cracks and repeated lines attached to them; each must have an even number of segments.
    pub walks: Vec<Vec<DirectedCurve>>,
}

/// Points along a curve, from its start to its end.
#[derive(Clone, Debug, PartialEq)]
pub enum Line {
    /// Of a planar domain.
    Plane(Vec<DVec2>),
    /// Of a domain on surfaces.
    Space(Vec<DVec3>),
}

impl Line {
    /// The points in space.
    pub fn in_space(&self) -> Vec<DVec3> {
        match self {
            Line::Plane(points) => points.iter().map(|p| p.extend(0.0)).collect(),
            Line::Space(points) => points.clone(),
        }
    }
}

/// The geometry in space of a domain on surfaces, which is meshed in the plane of an atlas of charts.
#[derive(Clone, Debug)]
pub struct Spatial {
    /// The charts.
    pub atlas: Arc<Atlas>,
    /// The vertices in space.
    pub vertices: Vec<DVec3>,
    /// The vertex in space that each vertex of the plane is an image of.
    pub vertex_of: Vec<u32>,
    /// The curve in space that each curve of the plane is an image of.
    pub curves: Vec<Arc<SpaceCurve>>,
    /// Points along every named curve, including curves that no face uses: for fields by distance.
    pub polylines: Vec<(String, Vec<DVec3>)>,
}

/// Valid curves and faces: closed loops that neither cross nor touch, except at shared vertices.
#[derive(Clone, Debug)]
pub struct Domain {
    /// The curves that faces use.
    pub curves: Vec<DomainCurve>,
    /// The vertices in the plane.
    pub vertices: Vec<DVec2>,
    /// The faces, in the order of the case.
    pub faces: Vec<DomainFace>,
    /// The hard points.
    pub points: Vec<DomainPoint>,
    /// Larger side of the bounding box.
    pub size: f64,
    /// The geometry in space, if the faces lie on surfaces.
    pub spatial: Option<Arc<Spatial>>,
    /// The number of points of polylines that the given tolerance has merged with others.
    pub merged_points: usize,
    /// The number of ends of curves that the given tolerance has moved to a vertex.
    pub joined_ends: usize,
    /// The line at which it was cut, if it is one half of a symmetric domain.
    mirror: Option<Mirror>,
    /// Curves that get so many segments more than their sizes ask for, or fewer.
    more_segments: Vec<(CurveId, i32)>,
    lower: DVec2,
    upper: DVec2,
    chords: RTree<Chord>,
}

impl Domain {
    /// Builds a domain of curves and faces; curves that no face uses are dropped.
    ///
    /// # Errors
    /// Names that are unknown, given twice, or used wrongly; invalid curves; loops that are open or enclose no area;
    /// curves that cross or touch except at shared end points; holes, cracks and repeated lines outside their face;
    /// faces that overlap.
    pub fn build(curves: Vec<CurveSpec>, faces: Vec<FaceSpec>) -> Result<Domain, Fault> {
        Domain::build_within(curves, faces, None)
    }

    /// As [`Domain::build`], with the distance up to which ends of curves are one vertex, points of a polyline are one
    /// point, and curves touch.
    ///
    /// # Errors
    /// As there, and a tolerance of more than a tenth of the domain.
    pub fn build_within(
        mut curves: Vec<CurveSpec>,
        faces: Vec<FaceSpec>,
        tolerance: Option<f64>,
    ) -> Result<Domain, Fault> {
        let merge = |tolerance: f64| curves.iter_mut().map(|curve| curve.shape.merge_points(tolerance)).sum::<usize>();
        let merged_points = tolerance.map_or(0, merge);
        let (mut curves, lists) = resolve(&curves, &faces)?;
        let plain = Extent::of(&curves)?;
        let extent = plain.within(tolerance)?;
        let vertices = join_ends(&mut curves, extent.size, extent.tolerance)?;
        let moved = |curve: &DomainCurve| {
            let far = |&k: &usize| {
                let vertex = vertices[curve.ends[k] as usize];
                curve.curve.point(k as f64).distance(vertex) > plain.tolerance
            };
            [0, 1].into_iter().filter(far).count()
        };
        let joined_ends = curves.iter().map(moved).sum();
        let mut chains = Vec::with_capacity(faces.len());
        for (spec, list) in faces.iter().zip(&lists) {
            let mut chain = Vec::with_capacity(list.len());
            for (i, ids) in list.iter().enumerate() {
                chain.push(loops::chain(&curves, ids, &spec.name, i).map_err(|f| placed(f, &spec.place))?);
            }
            chains.push(chain);
        }
        let domain = Domain::assemble(curves, vertices, chains, &faces, extent, Borders::Unchecked)?;
        Ok(Domain { merged_points, joined_ends, ..domain })
    }

    /// Builds a domain of curves that meet at `vertices` and are chained into the loops of each face.
    pub(super) fn assemble(
        mut curves: Vec<DomainCurve>,
        vertices: Vec<DVec2>,
        mut chains: Vec<Vec<Vec<DirectedCurve>>>,
        faces: &[FaceSpec],
        extent: Extent,
        borders: Borders,
    ) -> Result<Domain, Fault> {
        let Extent { lower, upper, size, tolerance } = extent;
        let names: Vec<String> = faces.iter().map(|f| f.name.clone()).collect();
        let chords = inside::chord_tree(&curves, |id, i| {
            let curve = &curves[id.index()];
            crossing::bulge(curve, curve.fine[i as usize], curve.fine[i as usize + 1]) + tolerance
        });
        if borders == Borders::Unchecked {
            let face_of = |curve: CurveId| {
                let of = |chain: &&Vec<Vec<DirectedCurve>>| chain.iter().flatten().any(|step| step.curve == curve);
                chains.iter().position(|chain| of(&chain)).map(|face| names[face].as_str())
            };
            crossing::check(&curves, &chords, Limits { tolerance, near: 1e-3 * size }, face_of)?;
        }
        for (f, (spec, chain)) in faces.iter().zip(&mut chains).enumerate() {
            for (i, steps) in chain.iter_mut().enumerate() {
                let area = loops::doubled_area(&loops::polygon(&curves, steps));
                if borders == Borders::Unchecked && area.abs() <= tolerance * tolerance {
                    let what = format!("The {} encloses no area", loop_name(&spec.name, i));
                    return Err(placed(Fault::new(what), &spec.place));
                }
                if (area > 0.0) != (i == 0) {
                    steps.reverse();
                    steps.iter_mut().for_each(|s| s.forward = !s.forward);
                }
                for step in steps {
                    let curve = &mut curves[step.curve.index()];
                    let side = &mut curve.sides[usize::from(!step.forward)];
                    if let Some(other) = side.replace(f as u32) {
                        let what = format!(
                            "The faces \"{}\" and \"{}\" lie on the same side of the curve \"{}\"",
                            names[other as usize], spec.name, curve.name
                        );
                        let fault = Fault::new(what).remedy("Faces may share curves, but must not overlap");
                        return Err(placed(fault, &spec.place));
                    }
                }
            }
        }
        let mut domain = Domain {
            curves,
            vertices,
            faces: Vec::new(),
            points: Vec::new(),
            size,
            spatial: None,
            mirror: None,
            more_segments: Vec::new(),
            merged_points: 0,
            joined_ends: 0,
            lower,
            upper,
            chords,
        };
        let face = |(spec, loops): (&FaceSpec, _)| DomainFace {
            name: spec.name.clone(),
            groups: spec.groups.clone(),
            loops,
            walks: Vec::new(),
        };
        domain.faces = faces.iter().zip(chains).map(face).collect();
        if borders == Borders::Unchecked {
            domain.check_nesting(faces)?;
        }
        let walks = loops::walks(&domain.curves, &names, &domain.vertices)?;
        for (face, walks) in domain.faces.iter_mut().zip(walks) {
            face.walks = walks;
        }
        Ok(domain)
    }

    /// Checks that holes lie inside the outer loop and outside each other, internal lines in their face, and no face in
    /// another.
    fn check_nesting(&self, specs: &[FaceSpec]) -> Result<(), Fault> {
        // The faces and loops that each curve belongs to.
        let mut loops_of = vec![Vec::new(); self.curves.len()];
        for (f, face) in self.faces.iter().enumerate() {
            for (i, steps) in face.loops.iter().enumerate() {
                steps.iter().for_each(|s| loops_of[s.curve.index()].push((f, i)));
            }
        }
        for (c, curve) in self.curves.iter().enumerate() {
            let middle = curve.fine.len() / 2;
            let p = if curve.fine.len() > 2 { curve.fine[middle].1 } else { curve.first().midpoint(curve.last()) };
            // The loops around the point are those that a ray crosses an odd number of times.
            let mut around: Vec<(usize, usize)> = self
                .crossed(p)
                .filter(|id| id.index() != c)
                .flat_map(|id| loops_of[id.index()].iter().copied())
                .collect();
            around.sort_unstable();
            let around: Vec<(usize, usize)> =
                around.chunk_by(|a, b| a == b).filter(|g| g.len() % 2 == 1).map(|g| g[0]).collect();
            let holds = |f: usize| around.contains(&(f, 0)) && !around.iter().any(|&(g, i)| g == f && i > 0);
            let refuse = |f: usize, what: String, remedy: &str| {
                Err(placed(Fault::new(what).at(format!("at {}", point_text(p))).remedy(remedy), &specs[f].place))
            };
            for &(f, i) in &loops_of[c] {
                let name = &self.faces[f].name;
                if i > 0 && !around.contains(&(f, 0)) {
                    let what =
                        format!("The curve \"{}\" of {} lies outside the outer loop", curve.name, loop_name(name, i));
                    return refuse(f, what, "Move the hole inside, or remove it");
                }
                if let Some(&(_, j)) = around.iter().find(|&&(g, j)| g == f && j > 0 && j != i) {
                    let what = format!("The curve \"{}\" of \"{name}\" lies within {}", curve.name, loop_name(name, j));
                    return refuse(f, what, "Make the part inside the hole a separate face");
                }
            }
            let inner = curve.kind != CurveKind::Boundary;
            if let (true, Some(f)) = (inner, curve.sides[0])
                && !holds(f as usize)
            {
                let what =
                    format!("The line \"{}\" lies outside its face \"{}\"", curve.name, self.faces[f as usize].name);
                return refuse(f as usize, what, "Move it inside, or remove it");
            }
            let own = |f: usize| curve.sides.contains(&Some(f as u32));
            let other = around.iter().map(|&(f, _)| f).find(|&f| !own(f) && holds(f));
            if let Some(f) = other {
                let owner = curve.sides.iter().flatten().next().map_or(f, |&f| f as usize);
                let what = format!(
                    "The faces \"{}\" and \"{}\" overlap: the curve \"{}\" lies in the latter",
                    self.faces[owner].name, self.faces[f].name, curve.name
                );
                return refuse(owner, what, "Give the outer face a hole there, or keep the faces apart");
            }
        }
        Ok(())
    }

    /// The curves that a ray from `p` towards -x crosses, once for each crossing.
    fn crossed(&self, p: DVec2) -> impl Iterator<Item = CurveId> {
        let crossings = inside::crossings(&self.chords, &self.curves, p.y, [self.lower.x - self.size, p.x]);
        crossings.into_iter().filter(move |c| c.left_of(p)).map(|c| c.curve)
    }

    /// The face that contains a point, by the fine polylines; `None` outside and in holes.
    pub fn inside(&self, p: DVec2) -> Option<u32> {
        self.face_beyond(self.crossed(p))
    }

    /// The face that contains a point from which a ray to infinity crosses these curves: the one whose boundary it
    /// crosses an odd number of times.
    fn face_beyond(&self, crossed: impl Iterator<Item = CurveId>) -> Option<u32> {
        let mut odd: smallvec::SmallVec<[u32; 16]> = smallvec::SmallVec::new();
        for curve in crossed.map(|id| &self.curves[id.index()]).filter(|c| c.kind == CurveKind::Boundary) {
            for face in curve.sides.into_iter().flatten() {
                match odd.iter().position(|f| *f == face) {
                    Some(i) => drop(odd.swap_remove(i)),
                    None => odd.push(face),
                }
            }
        }
        odd.into_iter().min()
    }

    /// About `n` points that cover the domain: a square grid inside, and points with the same spacing on all curves.
    pub fn sample_points(&self, n: usize) -> Vec<DVec2> {
        let area: f64 = self
            .faces
            .iter()
            .flat_map(|f| &f.loops)
            .map(|l| 0.5 * loops::doubled_area(&loops::polygon(&self.curves, l)))
            .sum();
        let extent = self.upper - self.lower;
        // A thin slanting domain fills little of its box: the grid is limited to 16 n points.
        let n = n.max(1) as f64;
        let spacing = (area / n).max(extent.x * extent.y / (16.0 * n)).sqrt().max(extent.max_element() / (16.0 * n));
        let mut points = Vec::new();
        for curve in &self.curves {
            for w in curve.fine.windows(2) {
                let parts = (w[0].1.distance(w[1].1) / spacing).ceil().clamp(1.0, 16.0 * n) as usize;
                for i in 0..parts {
                    points.push(curve.curve.point(w[0].0 + (w[1].0 - w[0].0) * i as f64 / parts as f64));
                }
            }
            points.push(curve.last());
        }
        let (columns, rows) = ((extent.x / spacing).ceil() as usize, (extent.y / spacing).ceil() as usize);
        for j in 0..rows {
            let y = self.lower.y + spacing * (j as f64 + 0.5);
            let line = [self.lower.x - self.size, self.upper.x];
            let row = inside::crossings(&self.chords, &self.curves, y, line);
            for i in 0..columns {
                let p = DVec2::new(self.lower.x + spacing * (i as f64 + 0.5), y);
                if self.face_beyond(row.iter().filter(|c| c.left_of(p)).map(|c| c.curve)).is_some() {
                    points.push(p);
                }
            }
        }
        points
    }

    /// The first curve that a ray meets, and its parameter there, by the fine polylines. The ray leaves a curve at the
    /// parameter `s` in the direction `across`, and is `reach` long; it may meet other parts of the same curve.
    pub fn first_across(&self, from: CurveId, s: f64, across: DVec2, reach: f64) -> Option<(CurveId, f64)> {
        let fine = &self.curves[from.index()].fine;
        let own = fine.partition_point(|entry| entry.0 <= s).clamp(1, fine.len() - 1) - 1;
        let start = fine[own].1.lerp(fine[own + 1].1, (s - fine[own].0) / (fine[own + 1].0 - fine[own].0));
        let d = across * reach;
        let (low, high) = (start.min(start + d), start.max(start + d));
        let near = self.chords.locate_in_envelope_intersecting(AABB::from_corners(low.into(), high.into()));
        let mut first: Option<(f64, CurveId, u32, f64)> = None;
        for &(id, i) in near.map(|chord| &chord.data).filter(|&&(id, i)| (id, i as usize) != (from, own)) {
            let [a, b] = [i, i + 1].map(|k| self.curves[id.index()].fine[k as usize].1);
            let along = b - a;
            let (share, far) = ((a - start).perp_dot(d), (a - start).perp_dot(along));
            let sine = d.perp_dot(along);
            let (share, far) = (share / sine, far / sine);
            // Parallel lines give no numbers.
            let meets = (0.0..=1.0).contains(&share) && far > 0.0 && far <= 1.0;
            if meets && first.is_none_or(|best| (far, id, i) < (best.0, best.1, best.2)) {
                first = Some((far, id, i, share));
            }
        }
        let (_, id, i, share) = first?;
        let [t0, t1] = [i, i + 1].map(|k| self.curves[id.index()].fine[k as usize].0);
        Some((id, t0 + (t1 - t0) * share))
    }

    /// The curve of this name.
    pub fn curve(&self, name: &str) -> Option<&DomainCurve> {
        self.curves.iter().find(|c| c.name == name)
    }

    /// The fine polyline of the curve of this name.
    pub fn curve_polyline(&self, name: &str) -> Option<Line> {
        match &self.spatial {
            Some(spatial) => {
                spatial.polylines.iter().find(|(known, _)| known == name).map(|(_, line)| Line::Space(line.clone()))
            }
            None => Some(Line::Plane(self.curve(name)?.fine.iter().map(|&(_, p)| p).collect())),
        }
    }

    /// Whether a curve is closed; on surfaces, whether it is closed in space.
    pub fn is_closed(&self, id: CurveId) -> bool {
        let ends = self.curves[id.index()].ends;
        match &self.spatial {
            Some(spatial) => spatial.vertex_of[ends[0] as usize] == spatial.vertex_of[ends[1] as usize],
            None => ends[0] == ends[1],
        }
    }

    /// The smallest number of segments of a curve: with fewer, a closed curve, or with its mirror image a bent one that
    /// ends on the mirror line twice, would enclose nothing.
    pub fn least_segments(&self, id: CurveId) -> u32 {
        let curve = &self.curves[id.index()];
        let on_line = |p: DVec2| self.mirror.is_some_and(|mirror| mirror.holds(p));
        match self.is_closed(id) {
            true => 3,
            false if on_line(curve.first()) && on_line(curve.last()) && !curve.curve.straight() => 2,
            false => 1,
        }
    }

    /// How many segments more than its sizes ask for a curve gets; negative where it gets fewer.
    pub fn more_segments(&self, id: CurveId) -> i32 {
        self.more_segments.iter().filter(|more| more.0 == id).map(|more| more.1).sum()
    }

    /// All images of the space curve whose first image is `first`, including that one.
    pub fn images(&self, first: CurveId) -> Vec<&DomainCurve> {
        // They are consecutive, beginning with the first.
        self.curves[first.index()..].iter().take_while(|curve| curve.first == first).collect()
    }
}

/// What is known about the boundaries of faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Borders {
    /// Nothing: they must be checked.
    Unchecked,
    /// They bound triangulated charts that exact predicates have shown to be embedded in the plane: they neither cross
    /// nor touch, however close they are.
    Embedded,
}

/// The bounding box, size and length tolerance of a domain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub lower: DVec2,
    pub upper: DVec2,
    pub size: f64,
    pub tolerance: f64,
}

impl Extent {
    /// # Errors
    /// A domain that is too small for double precision at its distance from the origin.
    pub fn of(curves: &[DomainCurve]) -> Result<Extent, Fault> {
        let (lower, upper) = extent(curves.iter().flat_map(|c| <[DVec2; 2]>::from(c.curve.bounds())));
        let size = (upper - lower).max_element();
        let largest = lower.abs().max(upper.abs()).max_element();
        if size < 1e-90 || size < 1e-9 * largest {
            return Err(Fault::new(format!("The whole domain is only {size:e} across, at {}", point_text(lower)))
                .remedy("Scale it up, or move it towards the origin"));
        }
        let tolerance = (1e-9 * size).max(8.0 * f64::EPSILON * largest);
        Ok(Extent { lower, upper, size, tolerance })
    }

    /// The same extent with a given tolerance, no smaller than what rounding needs.
    ///
    /// # Errors
    /// A tolerance of more than a tenth of the size.
    pub fn within(self, tolerance: Option<f64>) -> Result<Extent, Fault> {
        let Some(tolerance) = tolerance else { return Ok(self) };
        if tolerance > 0.1 * self.size {
            return Err(Fault::new(format!(
                "tolerance = {tolerance} is more than a tenth of the domain, which is {} across",
                number(self.size)
            ))
            .remedy("Give a distance at which two points are meant to be one"));
        }
        let largest = self.lower.abs().max(self.upper.abs()).max_element();
        Ok(Extent { tolerance: tolerance.max(8.0 * f64::EPSILON * largest), ..self })
    }
}

#[cfg(test)]
mod tests;
