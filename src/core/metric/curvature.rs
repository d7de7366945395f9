//! A field by the curvature of the surface, which bounds the distance of chords from it.
//!
//! The distance of a chord from its arc of radius rho is `eps rho` for the length `h = 2 rho sqrt(eps (2 - eps))`. The
//! two principal curvatures give the sizes in their directions.

use super::boundary_layer::check_named_sizes;
use crate::core::fault::Fault;
use crate::core::geometry::Bend;
use crate::core::kernel::Metric3;
use crate::core::kernel::tensor::LARGEST_ANISOTROPY;

/// Sizes by principal curvatures.
#[derive(Clone, Copy, Debug)]
pub struct Curvature {
    /// `2 sqrt(eps (2 - eps))`: the ratio of size to radius.
    factor: f64,
    least: f64,
    far: f64,
}

impl Curvature {
    /// # Errors
    /// A chord error that is not between 0 and 1, invalid sizes.
    pub fn new(chord: f64, least: f64, far: f64) -> Result<Curvature, Fault> {
        if !(chord > 0.0 && chord <= 1.0) {
            return Err(Fault::new(format!("chord = {chord} is not a fraction of a radius"))
                .remedy("Give the distance of a chord from its arc divided by the radius, such as 0.01"));
        }
        check_named_sizes(&[("least", Some(least)), ("far", Some(far))])?;
        if far < least || far > LARGEST_ANISOTROPY * least {
            return Err(Fault::new(format!(
                "far = {far} is less than least = {least}, or more than {LARGEST_ANISOTROPY:e} times it"
            )));
        }
        Ok(Curvature { factor: 2.0 * (chord * (2.0 - chord)).sqrt(), least, far })
    }

    /// The size for a curvature.
    fn size(&self, curvature: f64) -> f64 {
        let h = self.factor / curvature.abs();
        // Without curvature, h is infinite, and the clamp gives `far`.
        if h.is_nan() { self.far } else { h.clamp(self.least, self.far) }
    }

    /// The metric for the curvature of a surface; in a plane the size `far`.
    pub fn metric(&self, bend: Option<&Bend>) -> Metric3 {
        let Some(bend) = bend else { return Metric3::isotropic(self.far) };
        let h = bend.curvatures.map(|k| self.size(k));
        let lambda = |h: f64| 1.0 / (h * h);
        let [a, b] = bend.directions;
        Metric3::from_eigen([lambda(h[0]), lambda(h[1]), lambda(h[0].max(h[1]))], [a, b, bend.normal])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn the_distance_of_a_chord_from_its_arc_is_the_given_fraction_of_the_radius() {
        for chord in [0.001, 0.01, 0.1] {
            let field = Curvature::new(chord, 1e-3, 1e3).unwrap();
            let bend = Bend { normal: DVec3::Z, directions: [DVec3::X, DVec3::Y], curvatures: [-0.25, 0.0] };
            let m = field.metric(Some(&bend));
            let h = 1.0 / m.xx.sqrt();
            let sagitta = 4.0 - (16.0 - 0.25 * h * h).sqrt();
            assert!((sagitta - chord * 4.0).abs() < 1e-9, "{chord}: {sagitta}");
            assert!((m.yy * 1e6 - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn invalid_fractions_and_sizes_are_refused() {
        for (chord, least, far) in
            [(0.0, 0.1, 1.0), (1.5, 0.1, 1.0), (f64::NAN, 0.1, 1.0), (0.1, 0.0, 1.0), (0.1, 2.0, 1.0)]
        {
            assert!(Curvature::new(chord, least, far).is_err());
        }
    }
}
