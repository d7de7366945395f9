//! The quadrilateral with straight sides in space, measured as the Verdict library does, which VTK and ParaView use and
//! most solvers follow: by its corners alone, whatever surface it lies on.

use glam::DVec3;

/// What Verdict takes for no length and no area.
const NOTHING: f64 = f64::EPSILON;
/// What Verdict gives for a ratio without bound.
const UNBOUNDED: f64 = 1e30;

/// A quadrilateral between straight sides in space, by its corners in order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StraightQuad(pub [DVec3; 4]);

/// Verdict's measures of a quadrilateral.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VerdictMeasures {
    /// Scaled Jacobian, -1 to 1; 1 for a rectangle. See [`StraightQuad::scaled_jacobian`].
    pub scaled_jacobian: f64,
    /// Aspect ratio, from 1; 1 for a square. See [`StraightQuad::aspect_ratio`].
    pub aspect_ratio: f64,
    /// Skew, 0 to 1; 0 for a rectangle. See [`StraightQuad::skew`].
    pub skew: f64,
    /// Warpage, -1 to 1; 1 where it is flat. See [`StraightQuad::warpage`].
    pub warpage: f64,
}

impl StraightQuad {
    /// All of Verdict's measures that we report.
    pub fn measures(&self) -> VerdictMeasures {
        VerdictMeasures {
            scaled_jacobian: self.scaled_jacobian(),
            aspect_ratio: self.aspect_ratio(),
            skew: self.skew(),
            warpage: self.warpage(),
        }
    }

    /// The area vector, times two: the cross product of the diagonals, along the mean normal.
    pub fn double_area(&self) -> DVec3 {
        let [a, b, c, d] = self.0;
        (c - a).cross(d - b)
    }

    /// The sine of each corner against the quadrilateral's own mean normal: its Jacobian there by the lengths of both
    /// sides; 0 where one of these is nothing.
    pub fn corner_sines(&self) -> [f64; 4] {
        let (sides, jacobians) = (self.sides(), self.jacobians());
        std::array::from_fn(|k| {
            let lengths = sides[k].length() * sides[(k + 3) % 4].length();
            if lengths > 0.0 { jacobians[k] / lengths } else { 0.0 }
        })
    }

    /// The least Jacobian of a corner by the lengths of its sides (`quad_scaled_jacobian`). With the last two corners
    /// at one place it is that of the triangle, times 2 over the root of 3.
    pub fn scaled_jacobian(&self) -> f64 {
        let [a, b, c, d] = self.0;
        if c == d {
            let lengths = [b - a, c - b, a - c].map(DVec3::length);
            let product = (lengths[0] * lengths[1]).max(lengths[1] * lengths[2]).max(lengths[2] * lengths[0]);
            let area = (b - a).cross(c - a).length();
            return if product < NOTHING { 0.0 } else { area * 2.0 / 3.0_f64.sqrt() / product };
        }
        if self.sides().iter().any(|side| side.length() < NOTHING) {
            return 0.0;
        }
        self.corner_sines().into_iter().fold(f64::INFINITY, f64::min)
    }

    /// The longest side times the perimeter, by four times the area (`quad_aspect_ratio`); 1e30 where it has no area.
    pub fn aspect_ratio(&self) -> f64 {
        let lengths = self.sides().map(DVec3::length);
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let ratio = longest * lengths.iter().sum::<f64>() / self.jacobians().iter().sum::<f64>();
        if ratio.is_nan() { UNBOUNDED } else { ratio.clamp(-UNBOUNDED, UNBOUNDED) }
    }

    /// The cosine of the angle between the lines that join the middles of opposite sides (`quad_skew`).
    pub fn skew(&self) -> f64 {
        let [a, b, c, d] = self.0;
        let (x, y) = (b + c - d - a, c + d - a - b);
        let (of_x, of_y) = (x.length(), y.length());
        if of_x < NOTHING || of_y < NOTHING { 0.0 } else { (x / of_x).dot(y / of_y).abs() }
    }

    /// The cube of the least cosine between the normals of opposite corners (`quad_warpage`); 2.2e-16 where a corner
    /// has no normal.
    pub fn warpage(&self) -> f64 {
        let normals = self.corner_normals();
        if normals.iter().any(|normal| normal.length() < NOTHING) {
            return NOTHING;
        }
        let [a, b, c, d] = normals.map(|normal| normal / normal.length());
        let cosine = a.dot(c).min(b.dot(d));
        cosine * cosine * cosine
    }

    /// The sides, from each corner to the next.
    fn sides(&self) -> [DVec3; 4] {
        let at = &self.0;
        std::array::from_fn(|k| at[(k + 1) % 4] - at[k])
    }

    /// At each corner the cross product of its sides.
    fn corner_normals(&self) -> [DVec3; 4] {
        let sides = self.sides();
        std::array::from_fn(|k| sides[(k + 3) % 4].cross(sides[k]))
    }

    /// The Jacobian at each corner: the area of the parallelogram of its sides as seen along the mean normal.
    fn jacobians(&self) -> [f64; 4] {
        let normal = self.double_area().normalize_or_zero();
        self.corner_normals().map(|corner| corner.dot(normal))
    }
}
