//! The half of a symmetric planar domain on one side of its mirror line: curves cut there, and the line itself as
//! curves where it runs through a face (docs/algorithm.md, "Symmetry").

use glam::DVec2;

use super::symmetry::{Images, SAME};
use super::{Domain, DomainFace, Extent};
use crate::core::fault::Fault;
use crate::core::geometry::assembly::placed;
use crate::core::geometry::course::Course;
use crate::core::geometry::curve::Curve;
use crate::core::geometry::domain_curve::{CurveId, CurveKind, DomainCurve};
use crate::core::geometry::mirror::{Axis, Joint, Mirror};
use crate::core::geometry::spec::{CurveShape, PointSpec};
use crate::core::geometry::{crossing, inside, loops};
use crate::core::kernel::decimal::point_text;

/// The name of the curves on the mirror line.
const LINE: &str = "mirror line";

/// One half of a symmetric domain.
#[derive(Clone, Debug)]
pub struct Half {
    /// The half. It has all faces by their numbers; those that lie in the other half have no loops.
    pub domain: Domain,
    /// The mirror line and the side that was kept.
    pub mirror: Mirror,
    /// The face that is the image of each face; of two that are each other's images, the half has one.
    pub image_of: Vec<u32>,
    /// What becomes of the curves on the mirror line.
    pub joints: Vec<(CurveId, Joint)>,
    /// The curves that close the half where the mirror line runs through a face, along the line.
    pub lines: Vec<CurveId>,
    /// For each hard point of the half, its index among the points of the whole, and that of its image.
    pub points: Vec<[usize; 2]>,
    /// The image of each curve of the whole domain.
    images: Vec<CurveId>,
}

impl Half {
    /// Gives the half the hard points of the whole that lie in it.
    ///
    /// # Errors
    /// A point without an image, or with an image of another size.
    pub fn give_points(&mut self, all: &[PointSpec]) -> Result<(), Fault> {
        let near = SAME * self.domain.size;
        let (mut kept, axis) = (Vec::new(), self.mirror.axis().word());
        for (own, point) in all.iter().enumerate() {
            let is_on_line = self.mirror.offset(point.at).abs() <= near;
            let at = if is_on_line { self.mirror.foot(point.at) } else { self.mirror.image(point.at) };
            let unlike = |what: String| {
                let what = format!("The domain is not symmetric in {axis}: the point \"{}\" {what}", point.name);
                placed(Fault::new(what), &point.place)
            };
            let Some(image) = all.iter().position(|other| other.at.distance(at) <= near) else {
                let fault = unlike(format!("has no image at {}", point_text(at)));
                return Err(fault.remedy("Add a point there, or remove symmetry"));
            };
            if (all[image].size, all[image].growth) != (point.size, point.growth) {
                let fault = unlike(format!("and its image \"{}\" have unlike sizes", all[image].name));
                return Err(fault.remedy("Give both the same size and growth"));
            }
            if is_on_line || self.mirror.offset(point.at) > 0.0 {
                self.points.push([own, image]);
                kept.push(PointSpec { at: if is_on_line { at } else { point.at }, ..point.clone() });
            }
        }
        self.domain = self.domain.clone().with_points(&kept)?;
        Ok(())
    }

    /// The numbers of segments of `lines`, from the nodes of each curve.
    pub fn segments(&self, chains: &[Vec<u32>]) -> Vec<u32> {
        self.lines.iter().map(|id| chains[id.index()].len() as u32 - 1).collect()
    }

    /// Gives curves of `lines`, in their order, so many segments more than their sizes ask for; negative: fewer.
    pub fn give_segments(&mut self, more: &[i32]) {
        self.domain.more_segments = self.lines.iter().copied().zip(more.iter().copied()).collect();
    }

    /// The names of curves of the whole domain with those of their images.
    pub fn with_images(&self, whole: &Domain, names: &[String]) -> Vec<String> {
        let of_image = whole.curves.iter().zip(&self.images).filter(|(curve, _)| names.contains(&curve.name));
        let of_images = of_image.map(|(_, image)| whole.curves[image.index()].name.clone());
        names.iter().cloned().chain(of_images).collect()
    }

    /// The curves of the half that are parts of curves of the whole domain, given by their indices, or of their images.
    pub fn parts_of(&self, whole: &Domain, curves: &[usize]) -> Vec<usize> {
        let names: Vec<String> = curves.iter().map(|&i| whole.curves[i].name.clone()).collect();
        let names = self.with_images(whole, &names);
        let parts = self.domain.curves.iter().zip(0..).filter(|(curve, _)| names.contains(&curve.name));
        parts.map(|(_, part)| part).collect()
    }
}

/// The part of a curve between two parameters, and the side of the line on which it lies: 1 where it is kept.
struct Part {
    /// The parameters; the second one is above 1 where the part goes on through the start of a closed curve.
    range: [f64; 2],
    /// The parameters of its ends, from 0 to 1.
    ends: [f64; 2],
    side: i8,
}

impl Domain {
    /// The half of the domain on the side of the mirror line that is kept.
    ///
    /// # Errors
    /// A domain that is not symmetric, and fixed numbers of segments that do not allow equal halves.
    pub fn half(&self, mirror: Mirror) -> Result<Half, Fault> {
        let images = self.mirror_images(&mirror)?;
        let mut cutting = Cutting {
            whole: self,
            images: &images,
            mirror,
            tolerance: SAME * self.size,
            vertices: Vec::new(),
            of_vertex: vec![None; self.vertices.len()],
            on_line: Vec::new(),
            curves: Vec::new(),
            joints: Vec::new(),
            lines: Vec::new(),
        };
        for id in (0..self.curves.len() as u32).map(CurveId) {
            cutting.cut(id)?;
        }
        cutting.close()?;
        let Cutting { vertices, curves, joints, lines, .. } = cutting;
        let names: Vec<String> = self.faces.iter().map(|face| face.name.clone()).collect();
        let walks = loops::walks(&curves, &names, &vertices)?;
        let faces = self.faces.iter().zip(walks).map(|(face, walks)| {
            let mut loops: Vec<Vec<_>> = walks.clone();
            loops.iter_mut().for_each(|steps| steps.retain(|s| curves[s.curve.index()].kind == CurveKind::Boundary));
            loops.retain(|steps| !steps.is_empty());
            // The outer loop comes first: it alone is anticlockwise.
            loops.sort_by_key(|steps| loops::doubled_area(&loops::polygon(&curves, steps)) <= 0.0);
            DomainFace { name: face.name.clone(), groups: face.groups.clone(), loops, walks }
        });
        let faces = faces.collect();
        let tolerance = Extent::of(&self.curves)?.tolerance;
        let chords = inside::chord_tree(&curves, |id, i| {
            let curve = &curves[id.index()];
            crossing::bulge(curve, curve.fine[i as usize], curve.fine[i as usize + 1]) + tolerance
        });
        let domain = Domain { curves, vertices, faces, chords, mirror: Some(mirror), ..self.without_curves() };
        Ok(Half { domain, mirror, image_of: images.faces, joints, lines, points: Vec::new(), images: images.curves })
    }

    /// Its extent alone.
    fn without_curves(&self) -> Domain {
        Domain {
            curves: Vec::new(),
            vertices: Vec::new(),
            faces: Vec::new(),
            points: Vec::new(),
            size: self.size,
            spatial: None,
            merged_points: self.merged_points,
            joined_ends: self.joined_ends,
            mirror: None,
            more_segments: Vec::new(),
            lower: self.lower,
            upper: self.upper,
            chords: rstar::RTree::new(),
        }
    }
}

/// The half as far as it is cut out.
struct Cutting<'a> {
    whole: &'a Domain,
    images: &'a Images,
    mirror: Mirror,
    /// What is this near to the line lies on it.
    tolerance: f64,
    vertices: Vec<DVec2>,
    /// The new vertex of each vertex of the whole, once it is used.
    of_vertex: Vec<Option<u32>>,
    /// Vertices on the line.
    on_line: Vec<u32>,
    curves: Vec<DomainCurve>,
    joints: Vec<(CurveId, Joint)>,
    lines: Vec<CurveId>,
}

impl Cutting<'_> {
    /// On which side of the line a point lies.
    fn side(&self, p: DVec2) -> i8 {
        let offset = self.mirror.offset(p);
        if offset.abs() <= self.tolerance { 0 } else { offset.signum() as i8 }
    }

    /// The inner parameters at which a curve meets the line, ascending.
    fn cuts(&self, curve: &DomainCurve) -> Vec<f64> {
        let mut cuts = Vec::new();
        let last = curve.fine.len() - 2;
        let mut before = Some(curve.first()).filter(|&p| self.side(p) == 0);
        let end = Some(curve.last()).filter(|&p| self.side(p) == 0);
        for (i, ends) in curve.fine.windows(2).enumerate() {
            let [(from, p), (to, q)] = [ends[0], ends[1]];
            let found = match (self.side(p), self.side(q)) {
                (_, 0) if i < last => Some((to, q)),
                (a, b) if a * b < 0 => {
                    let (mut near, mut far) = (from, to);
                    for _ in 0..60 {
                        let t = 0.5 * (near + far);
                        let is_near = self.mirror.offset(curve.curve.point(t)).signum() == f64::from(a);
                        if is_near { near = t } else { far = t }
                    }
                    Some((far, curve.curve.point(far)))
                }
                _ => None,
            };
            // A curve that is fine beside the tolerance may have several points on the line.
            let apart = |(_, p): &(f64, DVec2)| {
                [before, end].into_iter().flatten().all(|other| other.distance(*p) > 4.0 * self.tolerance)
            };
            if let Some((t, p)) = found.filter(apart) {
                cuts.push(t);
                before = Some(p);
            }
        }
        cuts
    }

    /// The parts of a curve between the places where it meets the line. A closed curve that crosses it begins there,
    /// unless it begins where others end.
    fn parts(&self, id: CurveId) -> Vec<Part> {
        let curve = &self.whole.curves[id.index()];
        let cuts = self.cuts(curve);
        let start = curve.ends[0];
        let alone = || self.whole.curves.iter().zip(0..).all(|(c, i)| CurveId(i) == id || !c.ends.contains(&start));
        let wraps = curve.ends[0] == curve.ends[1] && !cuts.is_empty() && self.side(curve.first()) != 0 && alone();
        let ends: Vec<f64> = if wraps {
            cuts.iter().copied().chain([cuts[0]]).collect()
        } else {
            [0.0].into_iter().chain(cuts).chain([1.0]).collect()
        };
        let part = |ends: &[f64]| {
            let ends = [ends[0], ends[1]];
            let range = if ends[1] > ends[0] { ends } else { [ends[0], ends[1] + 1.0] };
            Part { side: self.side_of(curve, range), range, ends }
        };
        ends.windows(2).map(part).collect()
    }

    /// The side of the line on which a part lies, by its point farthest from it.
    fn side_of(&self, curve: &DomainCurve, [from, to]: [f64; 2]) -> i8 {
        let within = |t: f64| (from < t && t < to) || (from < t + 1.0 && t + 1.0 < to);
        let middle = 0.5 * (from + to);
        let middle = curve.curve.point(if middle > 1.0 { middle - 1.0 } else { middle });
        let points = curve.fine.iter().filter(|(t, _)| within(*t)).map(|&(_, p)| p).chain([middle]);
        let farther = |a: DVec2, b: DVec2| {
            if self.mirror.offset(b).abs() > self.mirror.offset(a).abs() { b } else { a }
        };
        self.side(points.fold(middle, farther))
    }

    /// Adds the parts of a curve that are kept.
    fn cut(&mut self, id: CurveId) -> Result<(), Fault> {
        let whole = self.whole;
        let curve = &whole.curves[id.index()];
        let parts = self.parts(id);
        let segments = self.segments(id, &parts)?;
        // Vertices of the cuts, by their parameters: two parts meet at each.
        let mut known: Vec<(f64, u32)> = Vec::new();
        for part in parts.iter().filter(|part| part.side >= 0) {
            let mut ends = [0; 2];
            for (end, t) in ends.iter_mut().zip(part.ends) {
                let given = if t == 0.0 { Some(0) } else { (t == 1.0).then_some(1) };
                *end = match (given, known.iter().find(|cut| cut.0 == t)) {
                    (Some(which), _) => self.vertex(curve.ends[which]),
                    (None, Some(&(_, vertex))) => vertex,
                    (None, None) => {
                        let vertex = self.new_vertex(self.mirror.foot(curve.curve.point(t)));
                        known.push((t, vertex));
                        vertex
                    }
                };
            }
            let places = ends.map(|v| self.vertices[v as usize]);
            let Some(mut course) = curve.curve.part(part.range[0], part.range[1], places) else { continue };
            let (mut sides, mut kind) = (curve.sides, curve.kind);
            if part.side == 0 {
                course = line(places)?;
                // Only the half that is kept has a face there.
                let left = self.mirror.offset(self.mirror.foot(places[0]) + (places[1] - places[0]).perp());
                sides[usize::from(left > 0.0)] = None;
                let joint = if kind == CurveKind::Crack { Joint::Open } else { Joint::Shared };
                self.joints.push((CurveId(self.curves.len() as u32), joint));
                kind = CurveKind::Boundary;
            }
            let place = curve.place.clone();
            self.add(curve.name.clone(), course, ends, Role { segments, place, sides, kind });
        }
        Ok(())
    }

    /// The number of segments of each part of a curve that is kept, if the case fixes it.
    fn segments(&self, id: CurveId, parts: &[Part]) -> Result<Option<u32>, Fault> {
        let curve = &self.whole.curves[id.index()];
        let image = self.images.curves[id.index()];
        let other = &self.whole.curves[image.index()];
        let refuse = |what: String, remedy: &str| Err(placed(Fault::new(what).remedy(remedy), &curve.place));
        let count = match (curve.segments, other.segments) {
            (None, None) => return Ok(None),
            (Some(own), Some(of_image)) if own != of_image => {
                let what = format!(
                    "The curve \"{}\" has {own} segments, and its mirror image \"{}\" {of_image}",
                    curve.name, other.name
                );
                return refuse(what, "Give both the same number");
            }
            (own, of_image) => own.or(of_image),
        };
        let kept = parts.iter().filter(|part| part.side > 0).count();
        let away = parts.iter().filter(|part| part.side < 0).count();
        let crosses = kept > 0 && away > 0;
        match count {
            _ if kept == 0 && away > 0 => Ok(None),
            Some(n) if crosses && parts.len() == 2 && kept == 1 && image == id => {
                if n % 2 == 0 {
                    return Ok(Some(n / 2));
                }
                let what =
                    format!("The curve \"{}\" crosses the mirror line and has {n} segments, an odd number", curve.name);
                refuse(what, "Give it an even number: each half gets one half of them")
            }
            Some(_) if parts.len() > 1 => {
                let what = format!(
                    "The curve \"{}\" meets the mirror line several times: its number of segments cannot be halved",
                    curve.name
                );
                refuse(what, "Divide it where it meets the line, or leave the number out")
            }
            count => Ok(count),
        }
    }

    /// The new vertex of a vertex of the whole; what lies near the line is moved onto it.
    fn vertex(&mut self, old: u32) -> u32 {
        if let Some(vertex) = self.of_vertex[old as usize] {
            return vertex;
        }
        let p = self.whole.vertices[old as usize];
        let vertex = self.new_vertex(if self.side(p) == 0 { self.mirror.foot(p) } else { p });
        self.of_vertex[old as usize] = Some(vertex);
        vertex
    }

    fn new_vertex(&mut self, p: DVec2) -> u32 {
        let vertex = self.vertices.len() as u32;
        self.vertices.push(p);
        if self.mirror.holds(p) {
            self.on_line.push(vertex);
        }
        vertex
    }

    /// Adds the mirror line wherever it runs through a face.
    fn close(&mut self) -> Result<(), Fault> {
        let axis = self.mirror.axis();
        let mut on_line = std::mem::take(&mut self.on_line);
        let across = |v: u32| axis.across(self.vertices[v as usize]);
        on_line.sort_by(|&v, &w| across(v).total_cmp(&across(w)).then(v.cmp(&w)));
        let covered: Vec<[u32; 2]> = self.joints.iter().map(|joint| self.curves[joint.0.index()].ends).collect();
        for pair in on_line.windows(2) {
            let ends = [pair[0], pair[1]];
            if covered.contains(&ends) || covered.contains(&[ends[1], ends[0]]) {
                continue;
            }
            let [from, to] = ends.map(|v| self.vertices[v as usize]);
            let Some(face) = self.whole.inside(from.midpoint(to)) else { continue };
            let line = line([from, to])?;
            // The line runs along y with x to its right, or along x with y to its left.
            let kept_left = (axis == Axis::Y) == self.mirror.keeps_upper();
            let mut sides = [None; 2];
            sides[usize::from(!kept_left)] = Some(face);
            let role = Role { segments: None, place: String::new(), sides, kind: CurveKind::Boundary };
            self.lines.push(CurveId(self.curves.len() as u32));
            self.add(LINE.to_owned(), line, ends, role);
        }
        Ok(())
    }

    fn add(&mut self, name: String, course: Course, ends: [u32; 2], role: Role) {
        let Role { segments, place, sides, kind } = role;
        let mut fine = course.polyline(1e-5 * self.whole.size);
        let last = fine.len() - 1;
        fine[0].1 = self.vertices[ends[0] as usize];
        fine[last].1 = self.vertices[ends[1] as usize];
        let first = CurveId(self.curves.len() as u32);
        self.curves.push(DomainCurve {
            name,
            curve: course,
            segments,
            place,
            ends,
            sides,
            kind,
            fine,
            first,
            turning: None,
        });
    }
}

/// A straight course on the mirror line.
fn line([from, to]: [DVec2; 2]) -> Result<Course, Fault> {
    let line = Curve::new(&CurveShape::Segment { from, to });
    line.map(Course::of_curve).map_err(|fault| fault.at(format!("on the mirror line at {}", point_text(from))))
}

/// What a curve of the half has from the curve that it is a part of.
struct Role {
    segments: Option<u32>,
    place: String,
    sides: [Option<u32>; 2],
    kind: CurveKind,
}
