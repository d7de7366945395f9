//! The course of a curve in the plane of a domain: a plane curve, or the image of a space curve in the chart of a face.

use std::sync::Arc;

use glam::DVec2;

use super::curve::{Curve, chords};
use super::image::Image;
use crate::core::kernel::box_tree::extent;

/// The polynomial degree assumed for an image when it is divided into chords.
const DEGREE_OF_IMAGE: usize = 4;

/// The course of a curve of a domain, with a parameter in [0, 1].
#[derive(Clone, Debug)]
pub struct Course {
    path: Path,
    closed: bool,
    corners: Vec<f64>,
    breaks: Vec<f64>,
}

/// A curve of the plane, or the image of a space curve.
#[derive(Clone, Debug)]
enum Path {
    Plane(Curve),
    Image(Arc<Image>),
}

impl Course {
    /// The course of a plane curve.
    pub fn of_curve(curve: Curve) -> Course {
        let (closed, corners, breaks) = (curve.closed(), curve.corners().to_vec(), curve.breaks());
        Course { path: Path::Plane(curve), closed, corners, breaks }
    }

    /// The course of an image.
    pub fn of_image(image: Arc<Image>) -> Course {
        let (corners, breaks) = (image.curve().corners(), image.curve().breaks());
        let closed = image.point(0.0) == image.point(1.0);
        Course { path: Path::Image(image), closed, corners, breaks }
    }

    /// The part of a plane curve between two parameters; see [`Curve::part`]. `None` for an image.
    pub(super) fn part(&self, from: f64, to: f64, ends: [DVec2; 2]) -> Option<Course> {
        match &self.path {
            Path::Plane(curve) => Some(Course::of_curve(curve.part(from, to, ends))),
            Path::Image(_) => None,
        }
    }

    /// The point at `t` in [0, 1].
    pub fn point(&self, t: f64) -> DVec2 {
        match &self.path {
            Path::Plane(curve) => curve.point(t),
            Path::Image(image) => image.point(t),
        }
    }

    /// Point and derivative by `t`; at a corner, the derivative after it.
    pub fn at(&self, t: f64) -> (DVec2, DVec2) {
        match &self.path {
            Path::Plane(curve) => curve.at(t),
            Path::Image(image) => image.at(t),
        }
    }

    /// Whether its end is exactly its start.
    pub fn closed(&self) -> bool {
        self.closed
    }

    /// Whether all its pieces between breaks are straight.
    pub fn straight(&self) -> bool {
        match &self.path {
            Path::Plane(curve) => curve.straight(),
            Path::Image(image) => image.straight(),
        }
    }

    /// Whether it is straight between its corners, so that a finer subdivision does not change its course.
    pub fn straight_between_corners(&self) -> bool {
        self.straight() && self.breaks.len() == self.corners.len() + 2
    }

    /// The number of inner points of a polyline that are no corners.
    pub fn smooth_points(&self) -> usize {
        match &self.path {
            Path::Plane(curve) => curve.smooth_points(),
            Path::Image(image) => image.curve().smooth_points(),
        }
    }

    /// Whether it is an image that is straight between its breaks.
    pub fn polygonal(&self) -> bool {
        matches!(&self.path, Path::Image(image) if image.polygonal())
    }

    /// Whether its ends are given coordinates, not computed ones.
    pub fn ends_given(&self) -> bool {
        matches!(&self.path, Path::Plane(curve) if curve.ends_given())
    }

    /// Inner parameters at which the direction jumps, ascending: they become nodes.
    pub fn corners(&self) -> &[f64] {
        &self.corners
    }

    /// Parameters between which it is smooth, from 0 to 1: its corners and the knots of a NURBS.
    pub fn breaks(&self) -> Vec<f64> {
        self.breaks.clone()
    }

    /// Lower and upper corner of its bounding box, accurate to a millionth of its size; of an image about to a
    /// thousandth, since every point of it is projected.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let (low, high) = self.hull();
        if let Path::Image(_) = &self.path {
            return (low, high);
        }
        extent(self.polyline(1e-6 * (high - low).max_element()).into_iter().map(|(_, p)| p))
    }

    /// Points of the curve with their parameters, from 0 to 1, so dense that the distance of the chords from the curve
    /// is at most about `tolerance`. They include all corners. There are at most about 65,000 between two breaks,
    /// however small the tolerance.
    pub fn polyline(&self, tolerance: f64) -> Vec<(f64, DVec2)> {
        match &self.path {
            Path::Plane(curve) => curve.polyline(tolerance),
            Path::Image(image) if image.straight() || image.polygonal() => {
                self.breaks.iter().map(|&t| (t, self.point(t))).collect()
            }
            Path::Image(_) => chords(&|t| self.point(t), &self.breaks, DEGREE_OF_IMAGE, self.hull(), tolerance),
        }
    }

    /// A box that contains the curve, not always the smallest.
    fn hull(&self) -> (DVec2, DVec2) {
        match &self.path {
            Path::Plane(curve) => curve.hull(),
            Path::Image(image) => extent(image.points()),
        }
    }
}
