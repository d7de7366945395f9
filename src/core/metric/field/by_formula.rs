//! Fields by formulas of sizes and directions.

use glam::DVec3;

use super::{BadMetric, bad};
use crate::core::fault::Fault;
use crate::core::kernel::Metric3;
use crate::core::kernel::tensor::{check_sizes, orthonormal};
use crate::core::metric::formula::Program;
use crate::core::metric::place::MetricPlace;

/// A formula field: the outputs of the program are the given sizes, then three components of each given direction.
#[derive(Clone, Debug)]
pub(super) struct FormulaField {
    program: Program,
    sizes: usize,
    directions: Directions,
    place: String,
}

/// The directions of a formula field.
#[derive(Clone, Debug)]
enum Directions {
    /// None: only h1 is given.
    Isotropic,
    /// Constant and orthonormal.
    Fixed([DVec3; 3]),
    /// Computed by the program: which of the three are given.
    Varying([bool; 3]),
}

impl FormulaField {
    pub fn compile(
        helpers: &[(String, String)],
        sizes: &[Option<String>; 3],
        directions: &[Option<[String; 3]>; 3],
        place: &str,
    ) -> Result<FormulaField, Fault> {
        let count = sizes.iter().flatten().count();
        if count == 0 || sizes[..count].iter().any(Option::is_none) {
            return Err(Fault::new("The sizes of a formula must be h1, or h1 and h2, or h1, h2 and h3"));
        }
        let given = [0, 1, 2].map(|i| directions[i].is_some());
        if count == 1 && given != [false; 3] {
            return Err(Fault::new("Directions have no meaning if h1 is the only size")
                .remedy("Give h2, or leave the directions out"));
        }
        if given == [false, false, true] {
            return Err(Fault::new("g3 alone does not determine g1 and g2").remedy("Give g1 or g2"));
        }
        let mut outputs: Vec<(&str, &str)> = Vec::new();
        for (name, text) in ["h1", "h2", "h3"].into_iter().zip(sizes.iter().flatten()) {
            outputs.push((name, text));
        }
        for (name, components) in ["g1", "g2", "g3"].into_iter().zip(directions) {
            outputs.extend(components.iter().flatten().map(|text| (name, text.as_str())));
        }
        let program = Program::compile(helpers, &outputs)?;
        let constants: Option<Vec<f64>> = (count..outputs.len()).map(|i| program.constant(i)).collect();
        let directions = match constants {
            _ if count == 1 => Directions::Isotropic,
            Some(g) => Directions::Fixed(
                frame_from(given, &g)
                    .map_err(|what| Fault::new(what).remedy("Give directions that are neither zero nor parallel"))?,
            ),
            None => Directions::Varying(given),
        };
        Ok(FormulaField { program, sizes: count, directions, place: place.into() })
    }

    #[inline]
    pub fn metric(&self, place: &MetricPlace) -> Result<Metric3, Box<BadMetric>> {
        let mut out = [0.0; 12];
        self.program.eval(place, &mut out);
        let bad = |what| bad(what, &self.place, place);
        check_sizes(&out[..self.sizes]).map_err(bad)?;
        let lambda = |h: f64| 1.0 / (h * h);
        let h3 = if self.sizes == 3 { out[2] } else { out[0].max(out[1]) };
        let lambdas = [lambda(out[0]), lambda(out[1]), lambda(h3)];
        match &self.directions {
            Directions::Isotropic => Ok(Metric3::isotropic(out[0])),
            Directions::Fixed(g) => Ok(Metric3::from_eigen(lambdas, *g)),
            Directions::Varying(given) => {
                Ok(Metric3::from_eigen(lambdas, frame_from(*given, &out[self.sizes..]).map_err(bad)?))
            }
        }
    }
}

/// Orthonormal directions from the `components` of the given ones.
#[inline]
fn frame_from(given: [bool; 3], components: &[f64]) -> Result<[DVec3; 3], String> {
    let mut next = components.chunks_exact(3).map(DVec3::from_slice);
    let g = given.map(|is_given| if is_given { next.next() } else { None });
    let cross = |a: DVec3, b: DVec3, names: &str| {
        // Normalise first, so that short directions do not seem parallel.
        let product = a.normalize_or_zero().cross(b.normalize_or_zero());
        if product.length() < 1e-9 {
            Err(format!("{names} are parallel, or one is not a direction"))
        } else {
            Ok(product)
        }
    };
    orthonormal(match g {
        [None, None, _] => [DVec3::X, DVec3::Y, DVec3::Z],
        [Some(a), None, None] => [a, cross(DVec3::Z, a, "z and g1")?, DVec3::Z],
        [None, Some(b), None] => [cross(b, DVec3::Z, "g2 and z")?, b, DVec3::Z],
        [Some(a), Some(b), None] => [a, b, cross(a, b, "g1 and g2")?],
        [Some(a), None, Some(c)] => [a, cross(c, a, "g1 and g3")?, c],
        [None, Some(b), Some(c)] => [cross(b, c, "g2 and g3")?, b, c],
        [Some(a), Some(b), Some(c)] => [a, b, c],
    })
}
