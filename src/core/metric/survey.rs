//! A survey of a metric before meshing: its extreme sizes, and whether it fails anywhere on the domain.

use glam::DVec2;

use super::field::{MetricSource, Sizing};
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::Metric2;

/// The extremes that a survey found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Survey {
    /// Smallest size, after `size_scale`.
    pub smallest: f64,
    /// Where.
    pub smallest_at: DVec2,
    /// Largest size, after `size_scale`.
    pub largest: f64,
    /// Where.
    pub largest_at: DVec2,
    /// Largest ratio of two sizes at one point.
    pub anisotropy: f64,
    /// Where.
    pub anisotropy_at: DVec2,
}

/// Sizes below this fraction of the domain's extent, or of its largest coordinate, count as zero.
const AS_GOOD_AS_ZERO: f64 = 1e-10;

/// Cells along each side of the domain's bounding box; each search starts at the smallest size of a cell.
const CELLS: usize = 8;

/// A search continues while the relative change of the size over a step exceeds this: it does if the size falls to zero
/// within a few steps, even as the tenth root of the distance.
const HOPEFUL: f64 = 0.02;

/// The search directions, 22.5 degrees apart, so that the search can follow creases.
const DIRECTIONS: [DVec2; 16] = {
    let mut d = [DVec2::ZERO; 16];
    let (c1, c2, c3) = (0.923_879_532_511_286_7, 0.707_106_781_186_547_5, 0.382_683_432_365_089_8);
    let quarter = [(1.0, 0.0), (c1, c3), (c2, c2), (c3, c1)];
    let mut i = 0;
    while i < 4 {
        let (x, y) = quarter[i];
        d[i] = DVec2::new(x, y);
        d[i + 4] = DVec2::new(-y, x);
        d[i + 8] = DVec2::new(-x, -y);
        d[i + 12] = DVec2::new(y, -x);
        i += 1;
    }
    d
};

impl Sizing {
    /// Checks the metric at all given points, which should cover the domain densely, and searches for smaller sizes
    /// within `inside`, from the smallest size of each part of the domain. This finds zeros and negative sizes between
    /// the points if the sizes decrease towards them, but not dips narrower than the spacing of the points.
    ///
    /// # Errors
    /// A point at which the metric fails, or at which a size is almost zero (below 1e-10 of the extent or the largest
    /// coordinate of the points).
    pub fn survey(&self, domain_points: &[DVec2], inside: &dyn Fn(DVec2) -> bool) -> Result<Survey, Fault> {
        let Some(&first) = domain_points.first() else {
            return Err(Fault::new("The domain has no points at which to evaluate the metric"));
        };
        let mut survey = Survey {
            smallest: f64::INFINITY,
            smallest_at: first,
            largest: 0.0,
            largest_at: first,
            anisotropy: 0.0,
            anisotropy_at: first,
        };
        let low = domain_points.iter().fold(first, |low, p| low.min(*p));
        let high = domain_points.iter().fold(first, |high, p| high.max(*p));
        let extent = (high - low).length();
        let nothing = AS_GOOD_AS_ZERO * extent.max(low.abs().max(high.abs()).max_element());
        let mut starts = Starts { low, extent: high - low, of_cell: [None; CELLS * CELLS] };
        for &p in domain_points {
            let size = survey.note(&self.metric(p)?, p);
            let start = starts.at(p);
            if start.is_none_or(|(smallest, _)| size < smallest) {
                *start = Some((size, p));
            }
        }
        let spacing = extent / (domain_points.len() as f64).sqrt();
        for cell in 0..CELLS * CELLS {
            let Some(start) = starts.of_cell[cell] else { continue };
            self.descend(start, 2.0 * spacing, Some(&mut starts), inside, &mut survey)?;
            if survey.smallest < nothing {
                break;
            }
        }
        // Refine only the smallest one to the last digit.
        self.descend((survey.smallest, survey.smallest_at), 2.0 * spacing, None, inside, &mut survey)?;
        if survey.smallest < nothing {
            let p = survey.smallest_at;
            return Err(Fault::new(format!("The size falls to {:e}, which is practically zero", survey.smallest))
                .of_kind(FaultKind::Metric)
                .at(format!("({}, {})", p.x, p.y))
                .remedy("Give the size a lower bound, such as max(h, 0.001)"));
        }
        Ok(survey)
    }

    /// Pattern search for smaller sizes, with steps from `step` down to rounding errors. With `starts`, the starts of
    /// several searches, it ends sooner: where no step changes the size much, so that no zero is near, and in a cell
    /// where another search starts at a smaller size.
    fn descend(
        &self,
        (mut size, mut p): (f64, DVec2),
        mut step: f64,
        mut starts: Option<&mut Starts>,
        inside: &dyn Fn(DVec2) -> bool,
        survey: &mut Survey,
    ) -> Result<(), Fault> {
        const MOST_MOVES: usize = 400;
        let finest = 1e-15 * (p.abs().max_element() + step);
        let mut moves = 0;
        while step > finest && moves < MOST_MOVES {
            let mut best = (size, p);
            let mut largest_change: Option<f64> = None;
            for direction in DIRECTIONS {
                let q = p + step * direction;
                if q != p && inside(q) {
                    let there = survey.note(&self.metric(q)?, q);
                    largest_change = Some(largest_change.unwrap_or(0.0).max((there - size).abs()));
                    if there < best.0 {
                        best = (there, q);
                    }
                }
            }
            if starts.is_some() && largest_change.is_some_and(|change| change < HOPEFUL * size) {
                return Ok(());
            }
            if best.0 < size {
                (size, p) = best;
                moves += 1;
                if starts.as_mut().is_some_and(|s| s.at(p).is_some_and(|(lower, _)| lower < size)) {
                    return Ok(());
                }
            } else {
                step *= 0.5;
            }
        }
        Ok(())
    }
}

/// The starts of the searches: the smallest size of each cell, with its point.
struct Starts {
    low: DVec2,
    extent: DVec2,
    of_cell: [Option<(f64, DVec2)>; CELLS * CELLS],
}

impl Starts {
    /// The start in the cell that contains a point.
    fn at(&mut self, p: DVec2) -> &mut Option<(f64, DVec2)> {
        let cell = ((p - self.low) / self.extent.max(DVec2::splat(f64::MIN_POSITIVE)) * CELLS as f64).floor();
        let cell = cell.clamp(DVec2::ZERO, DVec2::splat(CELLS as f64 - 1.0));
        &mut self.of_cell[cell.y as usize * CELLS + cell.x as usize]
    }
}

impl Survey {
    /// Takes the metric at a point into account; returns its smallest size.
    fn note(&mut self, m: &Metric2, p: DVec2) -> f64 {
        let (lambda, _) = m.eigen();
        let (large, small) = (1.0 / lambda[0].sqrt(), 1.0 / lambda[1].sqrt());
        if small < self.smallest {
            (self.smallest, self.smallest_at) = (small, p);
        }
        if large > self.largest {
            (self.largest, self.largest_at) = (large, p);
        }
        if large / small > self.anisotropy {
            (self.anisotropy, self.anisotropy_at) = (large / small, p);
        }
        small
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::metric::field::{Field, FieldSpec};

    fn sizing(h1: &str) -> Sizing {
        let spec = FieldSpec::Formula {
            helpers: vec![],
            sizes: [Some(h1.into()), None, None],
            directions: [None, None, None],
            place: "case.toml".into(),
        };
        Sizing::new(vec![Field::compile(&spec, &|_| None).unwrap()], 1.0)
    }

    /// Points 1/40 apart in the unit square.
    fn unit_square() -> Vec<DVec2> {
        (0..41 * 41).map(|k| DVec2::new((k % 41) as f64, (k / 41) as f64) / 40.0).collect()
    }

    fn in_square(p: DVec2) -> bool {
        p.cmpge(DVec2::ZERO).all() && p.cmple(DVec2::ONE).all()
    }

    #[test]
    fn sizes_that_vanish_between_the_points_are_refused_where_they_do() {
        for (h1, near) in [
            ("abs(x-0.503)", DVec2::new(0.503, f64::NAN)),
            ("abs(x-0.503)+1e-16", DVec2::new(0.503, f64::NAN)),
            ("x-0.2", DVec2::new(f64::NAN, f64::NAN)),
            ("abs(x-0.503)-1e-6", DVec2::new(0.503, f64::NAN)),
            ("hypot(x-0.313, y-0.777)", DVec2::new(0.313, 0.777)),
            ("abs(y-0.503*x)", DVec2::new(f64::NAN, f64::NAN)),
            ("0.3*abs(x-0.2*y-0.117)+3*abs(y-0.511)", DVec2::new(0.2192, 0.511)),
            // A sharp minimum elsewhere does not draw all searches to itself.
            ("min(abs(x-0.503), 1e-7+hypot(x-0.1, y-0.1))", DVec2::new(0.503, f64::NAN)),
            ("1/(x-0.5)^2", DVec2::new(0.5, f64::NAN)),
            ("sqrt(x-0.01)", DVec2::new(f64::NAN, f64::NAN)),
            ("ln(x+1e-9)+30", DVec2::new(f64::NAN, f64::NAN)),
        ] {
            let result = sizing(h1).survey(&unit_square(), &in_square);
            if h1.starts_with("ln") {
                assert!(result.is_ok(), "{h1}");
                continue;
            }
            let fault = result.expect_err(h1);
            let inside: Vec<f64> = fault
                .place
                .trim_matches(['(', ')'])
                .split(", ")
                .map(|number| number.parse().expect("the place is two numbers"))
                .collect();
            for (found, wanted) in inside.iter().zip(near.to_array()) {
                assert!(wanted.is_nan() || (found - wanted).abs() < 1e-5, "{h1}: {fault}");
            }
            assert!(in_square(DVec2::from_slice(&inside)), "{h1}: {fault}");
        }
    }

    #[test]
    fn a_zero_outside_the_domain_is_not_a_fault() {
        let right = |p: DVec2| in_square(p) && p.x >= 0.51;
        let points: Vec<_> = unit_square().into_iter().filter(|&p| right(p)).collect();
        let survey = sizing("abs(x-0.503)").survey(&points, &right).unwrap();
        assert!((survey.smallest - 0.007).abs() < 1e-12, "{survey:?}");
        assert!((survey.smallest_at.x - 0.51).abs() < 1e-12);
    }

    #[test]
    fn extremes_are_found_with_their_points() {
        let survey = sizing("0.1+(x-0.333)^2+2*(y-0.777)^2").survey(&unit_square(), &in_square).unwrap();
        assert!((survey.smallest - 0.1).abs() < 1e-12, "{survey:?}");
        assert!(survey.smallest_at.distance(DVec2::new(0.333, 0.777)) < 1e-6);
        assert_eq!(survey.largest_at, DVec2::new(1.0, 0.0));
        assert!((survey.anisotropy - 1.0).abs() < 1e-12);
    }

    #[test]
    fn no_points_are_a_fault() {
        assert!(sizing("1").survey(&[], &in_square).is_err());
        assert!(sizing("1").survey(&[DVec2::ONE], &in_square).is_ok());
    }
}
