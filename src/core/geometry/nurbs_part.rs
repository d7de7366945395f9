//! A part of a NURBS curve of the plane, with parameters of its own in [0, 1].

use glam::DVec2;

use super::nurbs::NurbsCurve;

/// The part of a NURBS from a parameter on, over a span of parameters. Past 1 it goes on from the start of the (closed)
/// curve.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NurbsPart {
    whole: NurbsCurve,
    from: f64,
    span: f64,
}

impl NurbsPart {
    /// All of a curve.
    pub fn all_of(whole: NurbsCurve) -> NurbsPart {
        NurbsPart { whole, from: 0.0, span: 1.0 }
    }

    /// The part of it between two of its parameters.
    pub fn part(&self, from: f64, to: f64) -> NurbsPart {
        NurbsPart { whole: self.whole.clone(), from: self.from + from * self.span, span: (to - from) * self.span }
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.whole.basis().degree()
    }

    /// The control points of the whole curve.
    pub fn control_points(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.whole.control_points()
    }

    /// Point and derivative by `t` in [0, 1].
    pub fn at(&self, t: f64) -> (DVec2, DVec2) {
        let whole = self.from + t * self.span;
        let is_past = whole > 1.0 && self.from + self.span > 1.0;
        let (p, d) = self.whole.at_unit(if is_past { whole - 1.0 } else { whole });
        (p, d * self.span)
    }

    /// The knots inside it, ascending; the start of the whole curve too, if it goes through it.
    pub fn knots(&self) -> impl Iterator<Item = f64> {
        self.inner(self.whole.basis().unit_knots().collect(), true).into_iter()
    }

    /// Those of them at which the derivatives before and after make `is_sharp` true.
    pub fn sharp_knots(&self, is_sharp: impl Fn(DVec2, DVec2) -> bool) -> Vec<f64> {
        let [before, after] = [1.0, 0.0].map(|t| self.whole.at_unit(t).1);
        self.inner(self.whole.sharp_knots(&is_sharp), is_sharp(before, after))
    }

    /// Its own parameters of those of the whole, and of the start of the whole if that is to be among them.
    fn inner(&self, of_whole: Vec<f64>, with_start: bool) -> Vec<f64> {
        let start = with_start.then_some(1.0);
        let again = start.into_iter().chain(of_whole.iter().map(|t| t + 1.0));
        let all = of_whole.iter().copied().chain(again);
        all.map(|t| (t - self.from) / self.span).filter(|&t| t > 0.0 && t < 1.0).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::curve::Curve;
    use super::super::spec::CurveShape;
    use super::*;

    /// A closed curve of four straight sides that begins in the middle of one.
    fn diamond() -> CurveShape {
        let points = [(0.5, -0.5), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (0.5, -0.5)];
        let knots = vec![0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 5.0];
        let points = points.map(|(x, y)| DVec2::new(x, y)).to_vec();
        CurveShape::Nurbs { degree: 1, knots, weights: Vec::new(), points }
    }

    #[test]
    fn a_part_lies_on_the_whole_and_goes_on_through_the_start() {
        let whole = Curve::new(&diamond()).unwrap();
        assert!(whole.closed() && whole.corners().len() == 4);
        for (from, to) in [(0.1, 0.7), (0.5, 1.0), (0.7, 1.5)] {
            let ends = [from, to].map(|t: f64| whole.point(t % 1.0));
            let part = whole.part(from, to, ends);
            for i in 0..=100 {
                let t = f64::from(i) / 100.0;
                let of_whole = from + t * (to - from);
                let expected = whole.point(if of_whole > 1.0 { of_whole - 1.0 } else { of_whole });
                assert!(part.point(t).distance(expected) < 1e-12, "{from} to {to}: {t}");
            }
            // The start is no corner: there the direction does not jump.
            let inside = |t: &&f64| (from < **t && **t < to) || (from < **t + 1.0 && **t + 1.0 < to);
            assert_eq!(part.corners().len(), whole.corners().iter().filter(inside).count(), "{from} to {to}");
            assert!(!part.closed());
        }
    }

    #[test]
    fn parts_of_arcs_and_polylines_have_their_places_and_corners() {
        let arc =
            CurveShape::Arc { centre: DVec2::ONE, radius: 2.0, from_angle: 0.3, to_angle: 0.3 + std::f64::consts::TAU };
        let arc = Curve::new(&arc).unwrap();
        let part = arc.part(0.75, 1.25, [0.75, 0.25].map(|t| arc.point(t)));
        assert!(part.point(0.5).distance(arc.point(0.0)) < 1e-12 && part.corners().is_empty());
        let points: Vec<DVec2> =
            [(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y)).to_vec();
        let frame =
            Curve::new(&CurveShape::Polyline { points: points.clone(), closed: true, corner_angle: 0.0 }).unwrap();
        let part = frame.part(0.625, 1.125, [DVec2::new(2.0, 1.0), DVec2::new(2.0, 0.0)]);
        let corners: Vec<DVec2> = part.corners().iter().map(|&t| part.point(t)).collect();
        assert_eq!(corners, [points[3], points[0]]);
        assert_eq!([part.point(0.0), part.point(1.0)], [DVec2::new(2.0, 1.0), DVec2::new(2.0, 0.0)]);
    }
}
