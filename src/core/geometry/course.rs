//! The course of a curve in the plane of a domain: a plane curve, or the image of a space curve in the chart of a face.

use std::sync::Arc;

use glam::DVec2;

use super::curve::{Curve, chords, extent};
use super::image::Image;
use super::spec::CurveShape;
use crate::core::fault::Fault;

/// The polynomial degree assumed for an image when it is divided into chords.
const DEGREE_OF_IMAGE: usize = 4;

/// The course of a curve of a domain, with a parameter in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// A curve of the plane.
    Plane(Curve),
    /// The image of a space curve.
    Image(ImageCourse),
}

/// The image of a space curve in the chart of a face, with cached properties; compared by identity.
#[derive(Clone, Debug)]
pub struct ImageCourse {
    image: Arc<Image>,
    closed: bool,
    corners: Vec<f64>,
    breaks: Vec<f64>,
}

impl PartialEq for ImageCourse {
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
        Course::Image(ImageCourse { image, closed, corners, breaks })
    }

    /// The point at `t` in [0, 1].
    pub fn point(&self, t: f64) -> DVec2 {
        match self {
            Course::Plane(curve) => curve.point(t),
            Course::Image(course) => course.image.point(t),
        }
    }

    /// Point and derivative by `t`; at a corner, the derivative after it.
    pub fn at(&self, t: f64) -> (DVec2, DVec2) {
        match self {
            Course::Plane(curve) => curve.at(t),
            Course::Image(course) => course.image.at(t),
        }
    }

    /// The start point.
    pub fn start(&self) -> DVec2 {
        self.point(0.0)
    }

    /// The end point.
    pub fn end(&self) -> DVec2 {
        self.point(1.0)
    }

    /// Whether its end is exactly its start.
    pub fn closed(&self) -> bool {
        match self {
            Course::Plane(curve) => curve.closed(),
            Course::Image(course) => course.closed,
        }
    }

    /// Whether all its pieces are straight, so that a finer subdivision does not change its course.
    pub fn straight(&self) -> bool {
        match self {
            Course::Plane(curve) => curve.straight(),
            Course::Image(course) => course.image.straight(),
        }
    }

    /// Whether it is an image that is straight between its breaks.
    pub fn polygonal(&self) -> bool {
        matches!(self, Course::Image(course) if course.image.polygonal())
    }

    /// Whether its ends are given coordinates, not computed ones.
    pub fn ends_given(&self) -> bool {
        matches!(self, Course::Plane(curve) if curve.ends_given())
    }

    /// Inner parameters at which the direction jumps, ascending: they become nodes.
    pub fn corners(&self) -> &[f64] {
        match self {
            Course::Plane(curve) => curve.corners(),
            Course::Image(course) => &course.corners,
        }
    }

    /// Parameters between which it is smooth, from 0 to 1: its corners and the knots of a NURBS.
    pub fn breaks(&self) -> Vec<f64> {
        match self {
            Course::Plane(curve) => curve.breaks(),
            Course::Image(course) => course.breaks.clone(),
        }
    }

    /// Lower and upper corner of its bounding box, accurate to a millionth of its size.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let (low, high) = self.hull();
        extent(self.polyline(1e-6 * (high - low).max_element()).into_iter().map(|(_, p)| p))
    }

    /// Points of the curve with their parameters, from 0 to 1, so dense that the distance of the chords from the curve
    /// is at most about `tolerance`. They include all corners. There are at most about 65,000 between two breaks,
    /// however small the tolerance.
    pub fn polyline(&self, tolerance: f64) -> Vec<(f64, DVec2)> {
        match self {
            Course::Plane(curve) => curve.polyline(tolerance),
            Course::Image(course) if course.image.straight() || course.image.polygonal() => {
                course.breaks.iter().map(|&t| (t, self.point(t))).collect()
            }
            Course::Image(course) => {
                chords(&|t| self.point(t), &course.breaks, DEGREE_OF_IMAGE, self.hull(), tolerance)
            }
        }
    }

    /// A box that contains the curve, not always the smallest.
    fn hull(&self) -> (DVec2, DVec2) {
        match self {
            Course::Plane(curve) => curve.hull(),
            Course::Image(course) => extent(course.image.points()),
        }
    }
}
