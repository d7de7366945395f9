//! A field by the curvature of the surface: chords that stay near it.
//!
//! A chord of length h over an arc of radius rho is `eps rho` away from it where `h = 2 rho sqrt(eps (2 - eps))`. The two
//! principal curvatures give the two sizes in their directions.

use crate::core::fault::Fault;
use crate::core::geometry::surface::Bend;
use crate::core::kernel::tensor::{LARGEST_ANISOTROPY, Metric3};

/// Sizes by principal curvatures.
#[derive(Clone, Copy, Debug)]
pub struct Curvature {
    /// `2 sqrt(eps (2 - eps))`: size over radius.
    factor: f64,
    least: f64,
    far: f64,
}

impl Curvature {
    /// # Errors
    /// A chord error that is not between 0 and 1, sizes that are none.
    pub fn new(chord: f64, least: f64, far: f64) -> Result<Curvature, Fault> {
        if !(chord > 0.0 && chord <= 1.0) {
            return Err(Fault::new(format!("chord = {chord} is no part of a radius"))
                .remedy("Give how far a chord may be from its arc, over the radius: such as 0.01"));
        }
        for (name, size) in [("least", least), ("far", far)] {
            if !(1e-60..=1e60).contains(&size) {
                return Err(Fault::new(format!("{name} = {size} is no size")).remedy("Give a positive finite number"));
            }
        }
        if far < least || far > LARGEST_ANISOTROPY * least {
            return Err(Fault::new(format!(
                "far = {far} is less than least = {least}, or beyond {LARGEST_ANISOTROPY:e} times it"
            )));
        }
        Ok(Curvature { factor: 2.0 * (chord * (2.0 - chord)).sqrt(), least, far })
    }

    /// The size over a curvature.
    fn size(&self, curvature: f64) -> f64 {
        let h = self.factor / curvature.abs();
        // No curvature at all: the size is infinite.
        if h.is_nan() { self.far } else { h.clamp(self.least, self.far) }
    }

    /// The metric of a surface's curvature; in a plane the far size.
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
    fn a_chord_of_the_size_is_the_given_part_of_the_radius_from_its_arc() {
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
    fn what_is_no_part_of_a_radius_or_no_size_is_refused() {
        for (chord, least, far) in
            [(0.0, 0.1, 1.0), (1.5, 0.1, 1.0), (f64::NAN, 0.1, 1.0), (0.1, 0.0, 1.0), (0.1, 2.0, 1.0)]
        {
            assert!(Curvature::new(chord, least, far).is_err());
        }
    }
}
