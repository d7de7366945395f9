//! The course of a curve in the plane of a domain: a plane curve, or the image of a curve in space in a face's chart.

use std::sync::Arc;

use glam::DVec2;

use super::curve::{Curve, chords, extent};
use super::image::Image;
use super::spec::CurveShape;
use crate::core::fault::Fault;

/// Degree of the polynomials that an image is taken for where it is divided into chords.
const DEGREE_OF_IMAGE: usize = 4;

/// Where a curve of a domain runs, with a parameter in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// A curve of the plane.
    Plane(Curve),
    /// The image of a curve in space.
    Image(Picture),
}

/// The image of a curve in space in a face's chart, with what is asked of it often; two are equal where they are the same one.
#[derive(Clone, Debug)]
pub struct Picture {
    image: Arc<Image>,
    closed: bool,
    corners: Vec<f64>,
    breaks: Vec<f64>,
}

impl PartialEq for Picture {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.image, &other.image)
    }
}

impl Course {
    /// The course of a plane shape.
    ///
    /// # Errors
    /// See [`Curve::new`].
    pub fn of_shape(shape: &CurveShape) -> Result<Course, Fault> {
        Curve::new(shape).map(Course::Plane)
    }

    /// The course of an image.
    pub fn of_image(image: Arc<Image>) -> Course {
        let (corners, breaks) = (image.curve().corners(), image.curve().breaks());
        let closed = image.point(0.0) == image.point(1.0);
        Course::Image(Picture { image, closed, corners, breaks })
    }

    /// The point at `t` in [0, 1].
    pub fn point(&self, t: f64) -> DVec2 {
        match self {
            Course::Plane(curve) => curve.point(t),
            Course::Image(picture) => picture.image.point(t),
        }
    }

    /// Point and derivative by `t`; at a corner the derivative of the piece after it.
    pub fn at(&self, t: f64) -> (DVec2, DVec2) {
        match self {
            Course::Plane(curve) => curve.at(t),
            Course::Image(picture) => picture.image.at(t),
        }
    }

    /// Where it begins.
    pub fn start(&self) -> DVec2 {
        self.point(0.0)
    }

    /// Where it ends.
    pub fn end(&self) -> DVec2 {
        self.point(1.0)
    }

    /// Whether it ends exactly where it begins.
    pub fn closed(&self) -> bool {
        match self {
            Course::Plane(curve) => curve.closed(),
            Course::Image(picture) => picture.closed,
        }
    }

    /// Whether all its pieces are straight, so that dividing it more finely changes nothing of its course.
    pub fn straight(&self) -> bool {
        match self {
            Course::Plane(curve) => curve.straight(),
            Course::Image(picture) => picture.image.straight(),
        }
    }

    /// Whether it is an image that runs straight from one of its breaks to the next.
    pub fn polygonal(&self) -> bool {
        matches!(self, Course::Image(picture) if picture.image.polygonal())
    }

    /// Whether its ends are numbers that were given, and not computed.
    pub fn ends_given(&self) -> bool {
        matches!(self, Course::Plane(curve) if curve.ends_given())
    }

    /// Parameters strictly inside at which the direction jumps, ascending: they are kept as nodes.
    pub fn corners(&self) -> &[f64] {
        match self {
            Course::Plane(curve) => curve.corners(),
            Course::Image(picture) => &picture.corners,
        }
    }

    /// Parameters between which it is smooth, from 0 to 1: its corners, and the knots of a NURBS.
    pub fn breaks(&self) -> Vec<f64> {
        match self {
            Course::Plane(curve) => curve.breaks(),
            Course::Image(picture) => picture.breaks.clone(),
        }
    }

    /// Lower and upper corner of its bounding box, to a millionth of its size.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let (low, high) = self.hull();
        extent(self.polyline(1e-6 * (high - low).max_element()).into_iter().map(|(_, p)| p))
    }

    /// Points of the curve with their parameters, from 0 to 1, so dense that the chords are about `tolerance` from the
    /// curve at most. All corners are among them. There are never more than about 65,000 between two breaks, however
    /// small the tolerance.
    pub fn polyline(&self, tolerance: f64) -> Vec<(f64, DVec2)> {
        match self {
            Course::Plane(curve) => curve.polyline(tolerance),
            Course::Image(picture) if picture.image.straight() || picture.image.polygonal() => {
                picture.breaks.iter().map(|&t| (t, self.point(t))).collect()
            }
            Course::Image(picture) => {
                chords(&|t| self.point(t), &picture.breaks, DEGREE_OF_IMAGE, self.hull(), tolerance)
            }
        }
    }

    /// A box that holds the curve, not always the smallest.
    fn hull(&self) -> (DVec2, DVec2) {
        match self {
            Course::Plane(curve) => curve.hull(),
            Course::Image(picture) => extent(picture.image.places()),
        }
    }
}
