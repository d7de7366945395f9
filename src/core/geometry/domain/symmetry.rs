//! Whether a planar domain is its own mirror image, and which curves and faces are images of each other
//! (docs/algorithm.md, "Symmetry").

use glam::DVec2;

use super::Domain;
use crate::core::fault::Fault;
use crate::core::geometry::assembly::placed;
use crate::core::geometry::curve::distance_to_segment;
use crate::core::geometry::domain_curve::{CurveId, DomainCurve};
use crate::core::geometry::mirror::{Axis, Mirror};
use crate::core::kernel::decimal::{number, point_text};

/// What is this near, relative to the size of the domain, is in the same place: the image of a curve, or on the line.
pub(super) const SAME: f64 = 1e-6;

/// The image of each curve and of each face.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Images {
    /// The curve on which the image of the middle of each curve lies.
    pub curves: Vec<CurveId>,
    /// The face that is the image of each face.
    pub faces: Vec<u32>,
}

/// A place on a curve.
struct Near {
    distance: f64,
    curve: CurveId,
    t: f64,
}

impl Domain {
    /// The line in the middle of the domain, perpendicular to an axis.
    pub fn mirror(&self, axis: Axis) -> Mirror {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for curve in &self.curves {
            low = low.min(-reach(curve, &|p| -axis.along(p)));
            high = high.max(reach(curve, &|p| axis.along(p)));
        }
        Mirror::between(axis, low, high)
    }

    /// The images of all curves and faces.
    ///
    /// # Errors
    /// A curve at a point of which no curve of its kind lies at the mirror image, and a face on one side of a curve
    /// that is not the image of the one there.
    pub(super) fn mirror_images(&self, mirror: &Mirror) -> Result<Images, Fault> {
        let mut faces: Vec<Option<u32>> = vec![None; self.faces.len()];
        let mut curves = Vec::with_capacity(self.curves.len());
        for curve in &self.curves {
            let middle = (curve.fine.len() - 1) / 2;
            let mut image = CurveId(0);
            for (k, ends) in curve.fine.windows(2).enumerate() {
                self.near_image(mirror, curve, ends[0].1)?;
                let (p, d) = curve.curve.at(0.5 * (ends[0].0 + ends[1].0));
                let near = self.near_image(mirror, curve, p)?;
                if k == middle {
                    image = near.curve;
                }
                let other = &self.curves[near.curve.index()];
                // What lies to the left of a curve lies to the right of its image that runs the same way.
                let same_way = mirror.image_of_direction(d).dot(other.curve.at(near.t).1) > 0.0;
                for side in [0, 1] {
                    let beyond = other.sides[if same_way { 1 - side } else { side }];
                    match (curve.sides[side], beyond) {
                        (None, None) => {}
                        (Some(face), Some(of_image)) if *faces[face as usize].get_or_insert(of_image) == of_image => {}
                        (face, of_image) => return Err(self.unlike_faces(mirror, [face, of_image], p)),
                    }
                }
            }
            curves.push(image);
        }
        let faces = faces.into_iter().zip(0..).map(|(image, own)| image.unwrap_or(own)).collect();
        Ok(Images { curves, faces })
    }

    /// The place on a curve of the same kind at the image of a point of a curve.
    fn near_image(&self, mirror: &Mirror, curve: &DomainCurve, p: DVec2) -> Result<Near, Fault> {
        let q = mirror.image(p);
        let mut best: Option<Near> = None;
        for (chord, squared) in self.chords.nearest_neighbor_iter_with_distance_2([q.x, q.y]) {
            if best.as_ref().is_some_and(|best| best.distance * best.distance <= squared) {
                break;
            }
            let (id, i) = chord.data;
            let other = &self.curves[id.index()];
            if other.kind != curve.kind {
                continue;
            }
            let (t, distance) = nearest_on(other, i as usize, q);
            if best.as_ref().is_none_or(|best| distance < best.distance) {
                best = Some(Near { distance, curve: id, t });
            }
        }
        match best {
            Some(near) if near.distance <= SAME * self.size => Ok(near),
            other => {
                let axis = mirror.axis().word();
                let away = other.map_or_else(
                    || "there is no curve of its kind".to_owned(),
                    |near| {
                        let name = &self.curves[near.curve.index()].name;
                        format!("the nearest curve there, \"{name}\", is {} away", number(near.distance))
                    },
                );
                let what = format!(
                    "The domain is not symmetric in {axis}: the curve \"{}\" has no image at {}; {away}",
                    curve.name,
                    point_text(q)
                );
                let fault = Fault::new(what).at(format!("at {}", point_text(p)));
                let line = number(mirror.position());
                let remedy = format!("Make both sides of {axis} = {line} images of each other, or remove symmetry");
                Err(placed(fault.remedy(remedy), &curve.place))
            }
        }
    }

    fn unlike_faces(&self, mirror: &Mirror, [face, image]: [Option<u32>; 2], p: DVec2) -> Fault {
        let name = |face: Option<u32>| {
            face.map_or_else(|| "no face".to_owned(), |face| format!("the face \"{}\"", self.faces[face as usize].name))
        };
        let what = format!(
            "The domain is not symmetric in {}: beside {} lies {}, beside its image {}",
            mirror.axis().word(),
            point_text(p),
            name(face),
            name(image)
        );
        Fault::new(what).remedy("Make the faces on both sides images of each other, or remove symmetry")
    }
}

/// The largest value of a linear function of the place on a curve.
fn reach(curve: &DomainCurve, of: &dyn Fn(DVec2) -> f64) -> f64 {
    let most = curve.fine.iter().map(|&(_, p)| of(p)).fold(f64::NEG_INFINITY, f64::max);
    if curve.curve.straight() {
        return most;
    }
    // A chord is nearer to its curve than a hundredth of its length: only near the largest value there can be more.
    let mut best = most;
    for ends in curve.fine.windows(2) {
        let near = ends.iter().map(|&(_, p)| of(p)).fold(f64::NEG_INFINITY, f64::max);
        if near + ends[0].1.distance(ends[1].1) >= most {
            let t = least(&|t| -of(curve.curve.point(t)), [ends[0].0, ends[1].0]);
            best = best.max(of(curve.curve.point(t)));
        }
    }
    best
}

/// The parameter of the place nearest to a point on a chord's part of a curve, and its distance.
fn nearest_on(curve: &DomainCurve, chord: usize, q: DVec2) -> (f64, f64) {
    let ((from, a), (to, b)) = (curve.fine[chord], curve.fine[chord + 1]);
    if curve.curve.straight() {
        let d = b - a;
        let share = ((q - a).dot(d) / d.length_squared()).clamp(0.0, 1.0);
        return (from + share * (to - from), distance_to_segment(q, a, b));
    }
    let t = least(&|t| curve.curve.point(t).distance(q), [from, to]);
    let ends = [(from, a.distance(q)), (to, b.distance(q))];
    ends.into_iter().fold((t, curve.curve.point(t).distance(q)), |best, end| if end.1 < best.1 { end } else { best })
}

/// Where a function that first falls and then rises is least, to a hundred-millionth of the interval.
fn least(of: &dyn Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    for _ in 0..46 {
        let third = (high - low) / 3.0;
        if of(low + third) <= of(high - third) { high -= third } else { low += third }
    }
    0.5 * (low + high)
}
