//! Metric fields: what gives a tensor at a place (formula, uniform, table, boundary layer, intersection).

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::boundary_layer::BoundaryLayer;
use super::formula::Program;
use super::table::Table;
use super::tensor::{LARGEST_ANISOTROPY, Metric2, Metric3, check_sizes, orthonormal};
use crate::core::fault::Fault;

/// A place where a metric is asked for: its point in space and its parametric coordinates (equal in the plane).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Point in space.
    pub xyz: DVec3,
    /// Parametric coordinates.
    pub uv: DVec2,
}

/// A field that yields no metric at some place: what is wrong and where.
#[derive(Clone, Debug, PartialEq)]
pub struct BadMetric {
    /// What is wrong ("h1 = -0.02 is not positive").
    pub what: String,
    /// Where.
    pub place: Place,
}

impl From<Box<BadMetric>> for Fault {
    fn from(bad: Box<BadMetric>) -> Fault {
        let (p, uv) = (bad.place.xyz, bad.place.uv);
        let place = if p.truncate() == uv && p.z == 0.0 {
            format!("({}, {})", p.x, p.y)
        } else {
            format!("({}, {}, {}), u = {}, v = {}", p.x, p.y, p.z, uv.x, uv.y)
        };
        Fault::new(bad.what).at(place).remedy("The metric must be positive and finite on the whole domain")
    }
}

impl Place {
    /// A place in a planar domain, where the parametric coordinates are x and y.
    #[inline]
    pub fn in_plane(uv: DVec2) -> Place {
        Place { xyz: uv.extend(0.0), uv }
    }
}

/// What the mesher and the converter ask: the metric of eq. (3) at parametric coordinates.
pub trait MetricSource {
    /// The metric at `uv`. A pure function: the same place gives the same bits.
    ///
    /// # Errors
    /// Where the field is not positive definite and finite there (boxed: the happy path is hot).
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>>;
}

impl<T: MetricSource + ?Sized> MetricSource for &T {
    #[inline]
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
        (**self).metric(uv)
    }
}

impl<T: MetricSource + ?Sized> MetricSource for Arc<T> {
    #[inline]
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
        (**self).metric(uv)
    }
}

/// One field as a case gives it; several are intersected.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a case has a handful of them")]
pub enum FieldSpec {
    /// The same size everywhere, in all directions.
    Uniform {
        /// Size.
        h: f64,
    },
    /// Formulas in x, y, z, u, v.
    Formula {
        /// Named helper expressions, each may use those before it.
        helpers: Vec<(String, String)>,
        /// h1, h2, h3; one alone (the others `None`) is isotropic.
        sizes: [Option<String>; 3],
        /// g1, g2, g3, three components each; what is not given is completed (in the plane g3 = z).
        directions: [Option<[String; 3]>; 3],
        /// Where it stands, for messages.
        place: String,
    },
    /// Distance to named curves: size `first` across them, growing by `growth` from row to row.
    BoundaryLayer {
        /// Names of curves.
        curves: Vec<String>,
        /// First height.
        first: f64,
        /// Ratio of a row's height to the one before, at least 1.
        growth: f64,
        /// Size along the curves; `None`: as large as the other fields allow.
        along: Option<f64>,
        /// Largest size that this field asks for across; `None`: as large as the other fields allow.
        far: Option<f64>,
        /// Where it stands, for messages.
        place: String,
    },
}

/// One compiled field.
#[derive(Clone, Debug)]
pub struct Field(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Uniform(Metric3),
    Formula(Box<FormulaField>),
    BoundaryLayer(Box<BoundaryLayer>, String),
    Table(Box<Table>),
}

/// A formula field: the program gives the sizes that are given, then three components of each direction that is given.
#[derive(Clone, Debug)]
struct FormulaField {
    program: Program,
    sizes: usize,
    frame: Frame,
    place: String,
}

/// The directions of a formula field.
#[derive(Clone, Debug)]
enum Frame {
    /// Only h1 is given.
    Isotropic,
    /// They depend on no variable.
    Fixed([DVec3; 3]),
    /// These of the three come from the program.
    Varying([bool; 3]),
}

impl Field {
    /// Compiles a field; `curves` gives a fine polyline of a named curve.
    ///
    /// Of a formula's directions, one of g1 and g2 alone is completed in the plane (g3 = z), two by their cross product, none by
    /// the coordinate axes; without h3 it is the larger of h1 and h2, which in the plane has no effect.
    ///
    /// # Errors
    /// A size that is no size, a formula that does not compile or leaves too much open, an unknown curve; the place of
    /// the specification goes into the fault.
    pub fn compile(spec: &FieldSpec, curves: &dyn Fn(&str) -> Option<Vec<DVec2>>) -> Result<Field, Fault> {
        let kind = match spec {
            FieldSpec::Uniform { h } => {
                check_sizes(&[*h]).map_err(|what| Fault::new(what.replace("h1", "h")))?;
                Kind::Uniform(Metric3::isotropic(*h))
            }
            FieldSpec::Formula { helpers, sizes, directions, place } => {
                let field = FormulaField::compile(helpers, sizes, directions, place);
                Kind::Formula(Box::new(field.map_err(|fault| at(fault, place))?))
            }
            FieldSpec::BoundaryLayer { curves: names, first, growth, along, far, place } => {
                let mut polylines = Vec::new();
                for name in names {
                    let line = curves(name).ok_or_else(|| {
                        at(Fault::new(format!("The boundary layer names a curve \"{name}\" that is not there")), place)
                    })?;
                    polylines.push(line);
                }
                let layer = BoundaryLayer::new(&polylines, *first, *growth, *along, *far);
                Kind::BoundaryLayer(Box::new(layer.map_err(|fault| at(fault, place))?), place.clone())
            }
        };
        Ok(Field(kind))
    }

    /// A field by a table at the nodes of a triangle mesh in the parametric plane, log-Euclidean between them (spec 2.1.1);
    /// outside the mesh, the value at its nearest point.
    ///
    /// # Errors
    /// Lengths that differ, indices out of range, a triangle without area, a metric that is not positive definite.
    pub fn table(points: &[DVec2], triangles: &[[u32; 3]], metrics: Vec<Metric3>) -> Result<Field, Fault> {
        Ok(Field(Kind::Table(Box::new(Table::new(points, triangles, &metrics)?))))
    }

    /// Whether it gives a tensor of itself; a boundary layer without a size along its curves only cuts back others.
    fn is_tensor(&self) -> bool {
        !matches!(&self.0, Kind::BoundaryLayer(layer, _) if !layer.is_tensor())
    }

    /// The field's metric at a place, intersected with that of the fields before it.
    #[inline]
    fn intersect(&self, others: Option<Metric3>, place: &Place) -> Result<Metric3, Box<BadMetric>> {
        let m = match &self.0 {
            Kind::Uniform(m) => *m,
            Kind::Formula(field) => field.metric(place)?,
            Kind::Table(table) => table.metric(place.uv).ok_or_else(|| nowhere(place, ""))?,
            Kind::BoundaryLayer(layer, origin) => {
                return layer.intersect(others, place.uv).ok_or_else(|| nowhere(place, origin));
            }
        };
        Ok(others.map_or(m, |others| Metric3::intersect(&others, &m)))
    }
}

/// A fault at a place that may be unknown.
fn at(fault: Fault, place: &str) -> Fault {
    if place.is_empty() { fault } else { fault.at(place) }
}

/// What is wrong with a metric and where; `origin` is where its field stands.
#[cold]
fn bad(what: String, origin: &str, place: &Place) -> Box<BadMetric> {
    let what = if origin.is_empty() { what } else { format!("{what} ({origin})") };
    Box::new(BadMetric { what, place: *place })
}

#[cold]
fn nowhere(place: &Place, origin: &str) -> Box<BadMetric> {
    bad("a metric is asked for where the coordinates are not finite".into(), origin, place)
}

impl FormulaField {
    fn compile(
        helpers: &[(String, String)],
        sizes: &[Option<String>; 3],
        directions: &[Option<[String; 3]>; 3],
        place: &str,
    ) -> Result<FormulaField, Fault> {
        let count = sizes.iter().flatten().count();
        if count == 0 || sizes[..count].iter().any(Option::is_none) {
            return Err(Fault::new("The sizes of a formula are neither h1, nor h1 and h2, nor h1, h2 and h3"));
        }
        let given = [0, 1, 2].map(|i| directions[i].is_some());
        if count == 1 && given != [false; 3] {
            return Err(Fault::new("Directions have no meaning where h1 is the only size")
                .remedy("Give h2, or leave the directions out"));
        }
        if given == [false, false, true] {
            return Err(Fault::new("g3 alone leaves g1 and g2 open").remedy("Give g1 or g2"));
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
        let frame = match constants {
            _ if count == 1 => Frame::Isotropic,
            Some(g) => Frame::Fixed(
                frame_from(given, &g)
                    .map_err(|what| Fault::new(what).remedy("Give directions that are neither zero nor parallel"))?,
            ),
            None => Frame::Varying(given),
        };
        Ok(FormulaField { program, sizes: count, frame, place: place.into() })
    }

    #[inline]
    fn metric(&self, place: &Place) -> Result<Metric3, Box<BadMetric>> {
        let mut out = [0.0; 12];
        self.program.eval(place, &mut out);
        let bad = |what| bad(what, &self.place, place);
        check_sizes(&out[..self.sizes]).map_err(bad)?;
        let lambda = |h: f64| 1.0 / (h * h);
        let h3 = if self.sizes == 3 { out[2] } else { out[0].max(out[1]) };
        let lambdas = [lambda(out[0]), lambda(out[1]), lambda(h3)];
        match &self.frame {
            Frame::Isotropic => Ok(Metric3::isotropic(out[0])),
            Frame::Fixed(g) => Ok(Metric3::from_eigen(lambdas, *g)),
            Frame::Varying(given) => {
                Ok(Metric3::from_eigen(lambdas, frame_from(*given, &out[self.sizes..]).map_err(bad)?))
            }
        }
    }
}

/// Orthonormal directions from the `components` of those that are given.
#[inline]
fn frame_from(given: [bool; 3], components: &[f64]) -> Result<[DVec3; 3], String> {
    let mut next = components.chunks_exact(3).map(DVec3::from_slice);
    let g = given.map(|is_given| if is_given { next.next() } else { None });
    let cross = |a: DVec3, b: DVec3, names: &str| {
        // Unit vectors first, so that short directions are not taken for parallel ones.
        let product = a.normalize_or_zero().cross(b.normalize_or_zero());
        if product.length() < 1e-9 { Err(format!("{names} are parallel, or one is no direction")) } else { Ok(product) }
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

/// The metric of a case: the intersection of its fields with all sizes multiplied by one factor.
#[derive(Clone, Debug)]
pub struct Sizing {
    fields: Vec<Field>,
    size_scale: f64,
}

impl Sizing {
    /// Fields to intersect, in any order, and the factor on all sizes.
    ///
    /// # Panics
    /// Without fields, or with a factor that is not positive and finite (the reader of cases refuses both).
    pub fn new(mut fields: Vec<Field>, size_scale: f64) -> Sizing {
        assert!(!fields.is_empty(), "a sizing has at least one field");
        assert!(size_scale > 0.0 && size_scale.is_finite(), "size_scale is positive");
        // Fields that only cut back others come after them; the sort is stable.
        fields.sort_by_key(|field| !field.is_tensor());
        Sizing { fields, size_scale }
    }

    /// The metric M3D of eq. (2) at a place. A pure function: the same place gives the same bits.
    ///
    /// # Errors
    /// Where a field gives no positive finite tensor: which size, its value, the place.
    #[inline]
    pub fn metric3(&self, place: &Place) -> Result<Metric3, Box<BadMetric>> {
        let mut m = self.fields[0].intersect(None, place)?;
        for field in &self.fields[1..] {
            m = field.intersect(Some(m), place)?;
        }
        if self.fields.len() > 1 && !is_held_well(&m) {
            let what = format!("the fields together stretch the metric by more than {LARGEST_ANISOTROPY:e}");
            return Err(bad(what, "", place));
        }
        Ok(if self.size_scale == 1.0 { m } else { m.scaled(self.size_scale) })
    }
}

/// Whether double precision still holds all sizes of an intersection.
#[inline]
fn is_held_well(m: &Metric3) -> bool {
    let (det, trace) = (m.plane().det(), m.xx + m.yy);
    // det / trace^2 is the ratio of the eigenvalues where it is small.
    let plane = det * LARGEST_ANISOTROPY * LARGEST_ANISOTROPY > trace * trace && trace.is_finite();
    plane && if m.is_planar() { m.zz > 0.0 && m.zz.is_finite() } else { m.is_spd() }
}

/// Planar domains, where the parametric coordinates are x and y.
impl MetricSource for Sizing {
    #[inline]
    fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
        Ok(self.metric3(&Place::in_plane(uv))?.plane())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula(helpers: &[(&str, &str)], sizes: &[&str], directions: [Option<[&str; 3]>; 3]) -> FieldSpec {
        FieldSpec::Formula {
            helpers: helpers.iter().map(|h| (h.0.to_string(), h.1.to_string())).collect(),
            sizes: std::array::from_fn(|i| sizes.get(i).map(|s| s.to_string())),
            directions: directions.map(|g| g.map(|g| g.map(str::to_string))),
            place: "case.toml, line 7".into(),
        }
    }

    fn example_1() -> FieldSpec {
        formula(
            &[("r", "abs(x-y)/sqrt(2)")],
            &["0.005+0.15*r", "15*(0.005+0.15*r)*exp(-5.5*r)"],
            [Some(["-1", "1", "0"]), Some(["1", "1", "0"]), None],
        )
    }

    fn wall(along: Option<f64>, far: Option<f64>) -> FieldSpec {
        FieldSpec::BoundaryLayer {
            curves: vec!["wall".into()],
            first: 1e-3,
            growth: 1.25,
            along,
            far,
            place: "case.toml, line 9".into(),
        }
    }

    /// A wall along the x axis from 0 to 2.
    fn curves(name: &str) -> Option<Vec<DVec2>> {
        (name == "wall").then(|| (0..=20).map(|i| DVec2::new(0.1 * f64::from(i), 0.0)).collect())
    }

    fn compile(spec: &FieldSpec) -> Field {
        Field::compile(spec, &curves).unwrap()
    }

    fn sizing(specs: &[FieldSpec]) -> Sizing {
        Sizing::new(specs.iter().map(compile).collect(), 1.0)
    }

    fn bad_at(spec: FieldSpec, x: f64, y: f64) -> String {
        let error = sizing(&[spec]).metric(DVec2::new(x, y)).expect_err("a bad metric");
        assert_eq!(error.place.uv, DVec2::new(x, y));
        Fault::from(error).to_string()
    }

    #[test]
    fn fields_may_be_shared_between_threads() {
        fn check<T: Send + Sync>() {}
        check::<Field>();
        check::<Sizing>();
    }

    #[test]
    fn example_1_is_eq_12() {
        let sizing = sizing(&[example_1()]);
        let p = DVec2::new(0.7, 0.2);
        let m = sizing.metric(p).unwrap();
        let r = 0.5 / 2f64.sqrt();
        let h1 = 0.005 + 0.15 * r;
        let h2 = 15.0 * h1 * libm::exp(-5.5 * r);
        let (across, along) = (DVec2::new(-1.0, 1.0).normalize(), DVec2::new(1.0, 1.0).normalize());
        assert!((m.norm2(h1 * across) - 1.0).abs() < 1e-12);
        assert!((m.norm2(h2 * along) - 1.0).abs() < 1e-12);
        assert!(m.inner(across, along).abs() < 1e-12 * m.norm2(along));
        // On the diagonal it is stretched along it, 15 to 1.
        let m = sizing.metric(DVec2::splat(0.3)).unwrap();
        assert!((m.norm2(0.005 * across) - 1.0).abs() < 1e-12);
        assert!((m.norm2(0.075 * along) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn example_1_has_the_metric_area_of_the_specification() {
        // The unit square less a centred disc of radius 0.2: 265.8 (spec, eq. 12), by the midpoint rule.
        let sizing = sizing(&[example_1()]);
        let n = 400;
        let mut area = 0.0;
        for k in 0..n * n {
            let p = DVec2::new(f64::from(k % n) + 0.5, f64::from(k / n) + 0.5) / f64::from(n);
            if p.distance(DVec2::splat(0.5)) > 0.2 {
                area += sizing.metric(p).unwrap().det().sqrt() / f64::from(n * n);
            }
        }
        assert!((area - 265.8).abs() < 0.5, "{area}");
    }

    #[test]
    fn missing_directions_are_completed() {
        let plane = |directions| sizing(&[formula(&[], &["0.1", "2"], directions)]).metric(DVec2::ZERO).unwrap();
        assert_eq!(plane([None, None, None]), Metric2 { uu: 1.0 / (0.1 * 0.1), uv: 0.0, vv: 0.25 });
        let diagonal = plane([Some(["1", "1", "0"]), Some(["-1", "1", "0"]), None]);
        for same in [
            [Some(["2", "2", "0"]), None, None],
            [None, Some(["-1", "1", "0"]), None],
            [Some(["1", "1", "0"]), None, Some(["0", "0", "-2"])],
            [None, Some(["1", "-1", "0"]), Some(["0", "0", "1"])],
            [Some(["1+0*x", "1", "0"]), None, None],
        ] {
            let m = plane(same);
            assert!((m.uu - diagonal.uu).abs() + (m.uv - diagonal.uv).abs() < 1e-12, "{m:?}");
        }
        let space = sizing(&[formula(&[], &["1", "2", "4"], [None, Some(["0", "0", "1"]), Some(["1", "0", "0"])])]);
        let m = space.metric3(&Place::in_plane(DVec2::ZERO)).unwrap();
        assert_eq!((m.yy, m.zz, m.xx), (1.0, 0.25, 0.0625));
    }

    #[test]
    fn values_that_are_no_sizes_are_refused_with_name_value_and_place() {
        for (h1, message) in [
            ("x-0.27", "h1 = -0.02"),
            ("x-0.25", "h1 = 0 is not positive"),
            ("sqrt(x-1)", "h1 = NaN is not finite"),
            ("1/(x-0.25)", "h1 = inf is not finite"),
            ("ln(0)", "h1 = -inf is not finite"),
        ] {
            let message_found = bad_at(formula(&[], &[h1], [None, None, None]), 0.25, 0.5);
            assert!(message_found.contains(message), "{message_found}");
            assert!(message_found.starts_with("(0.25, 0.5): "), "{message_found}");
            assert!(message_found.contains("(case.toml, line 7)"), "{message_found}");
        }
        let parallel = formula(&[], &["1", "2"], [Some(["1", "x", "0"]), Some(["1", "0.5", "0"]), None]);
        assert!(sizing(std::slice::from_ref(&parallel)).metric(DVec2::X).is_ok());
        assert!(bad_at(parallel, 0.5, 0.0).contains("parallel"));
        let zero = formula(&[], &["1", "2"], [Some(["x", "y", "0"]), None, None]);
        assert!(bad_at(zero, 0.0, 0.0).contains("no direction"));
        assert!(bad_at(formula(&[], &["1", "x"], [None, None, None]), 1e-9, 0.0).contains("factor"));
    }

    #[test]
    fn what_a_formula_leaves_open_is_refused_when_compiled() {
        let fault = |spec| Field::compile(&spec, &curves).expect_err("a fault").to_string();
        let mut h2_only = formula(&[], &["1"], [None, None, None]);
        if let FieldSpec::Formula { sizes, .. } = &mut h2_only {
            sizes.swap(0, 1);
        }
        assert!(fault(h2_only).contains("neither h1"));
        assert!(fault(formula(&[], &[], [None, None, None])).contains("neither h1"));
        assert!(fault(formula(&[], &["1"], [Some(["1", "0", "0"]), None, None])).contains("only size"));
        assert!(fault(formula(&[], &["1", "2"], [None, None, Some(["0", "0", "1"])])).contains("g3 alone"));
        let parallel = formula(&[], &["1", "2"], [Some(["1", "1", "0"]), Some(["2", "2", "0"]), None]);
        assert!(fault(parallel).starts_with("case.toml, line 7: "));
        assert!(fault(formula(&[], &["phi*2"], [None, None, None])).contains("h1 = \"phi*2\""));
        assert!(fault(FieldSpec::Uniform { h: -1.0 }).contains("h = -1 is not positive"));
    }

    #[test]
    fn fields_intersect_and_sizes_scale() {
        let specs = [FieldSpec::Uniform { h: 0.5 }, formula(&[], &["x", "2"], [None, None, None])];
        let both = sizing(&specs);
        assert_eq!(both.metric(DVec2::new(0.25, 0.0)).unwrap(), Metric2 { uu: 16.0, uv: 0.0, vv: 4.0 });
        assert_eq!(both.metric(DVec2::X).unwrap(), Metric2::isotropic(0.5));
        let halved = Sizing::new(specs.iter().map(compile).collect(), 0.5);
        assert_eq!(halved.metric(DVec2::X).unwrap(), Metric2::isotropic(0.25));
    }

    #[test]
    fn a_boundary_layer_grows_with_the_distance_across_its_curves() {
        let alone = sizing(&[wall(Some(0.1), Some(0.05))]);
        for (y, h) in [(0.0, 1e-3), (0.01, 1e-3 + 0.25 * 0.01), (-0.01, 1e-3 + 0.25 * 0.01), (0.5, 0.05)] {
            let m = alone.metric(DVec2::new(1.03, y)).unwrap();
            assert!((m.norm2(DVec2::new(0.0, h)) - 1.0).abs() < 1e-9, "{y}");
            assert!((m.norm2(DVec2::new(0.1, 0.0)) - 1.0).abs() < 1e-9, "{y}");
        }
        // Beyond the end of the wall the distance is to its last point.
        let m = alone.metric(DVec2::new(2.03, 0.04)).unwrap();
        let n = DVec2::new(0.6, 0.8);
        assert!((m.norm2((1e-3 + 0.25 * 0.05) * n) - 1.0).abs() < 1e-9);
        // Rounding beside the wall does not turn the direction.
        let m = alone.metric(DVec2::new(0.3, 1e-17)).unwrap();
        assert!((m.uv / m.vv).abs() < 1e-12);
    }

    #[test]
    fn a_boundary_layer_without_size_along_leaves_that_to_the_others_in_any_order() {
        let uniform = FieldSpec::Uniform { h: 0.2 };
        for specs in [[uniform.clone(), wall(None, None)], [wall(None, None), uniform]] {
            let m = sizing(&specs).metric(DVec2::new(1.0, 0.01)).unwrap();
            assert!((m.uu - 25.0).abs() < 1e-9 && m.uv.abs() < 1e-9, "{m:?}");
            assert!((m.norm2(DVec2::new(0.0, 0.0035)) - 1.0).abs() < 1e-9);
            let far = sizing(&specs).metric(DVec2::new(1.0, 5.0)).unwrap();
            assert_eq!(far, Metric2::isotropic(0.2));
        }
        let alone = sizing(&[wall(None, None)]).metric(DVec2::new(0.51, 0.003)).unwrap();
        assert!(alone.is_spd());
        assert!(alone.eigen().0[0] < 1e-5);
    }

    #[test]
    fn bad_boundary_layers_are_refused() {
        let fault = |change: fn(&mut f64, &mut f64, &mut Option<f64>, &mut Vec<String>)| {
            let mut spec = wall(Some(0.1), Some(0.5));
            if let FieldSpec::BoundaryLayer { first, growth, far, curves, .. } = &mut spec {
                change(first, growth, far, curves);
            }
            Field::compile(&spec, &curves).expect_err("a fault").to_string()
        };
        assert!(fault(|first, _, _, _| *first = 0.0).contains("first = 0"));
        assert!(fault(|first, _, _, _| *first = 1e-9).contains("factor"));
        assert!(fault(|_, growth, _, _| *growth = 0.9).contains("growth = 0.9"));
        assert!(fault(|_, growth, _, _| *growth = f64::NAN).contains("growth"));
        assert!(fault(|_, _, far, _| *far = Some(1e-4)).contains("far is smaller"));
        assert!(fault(|_, _, _, curves| curves.clear()).contains("no length"));
        let unknown = fault(|_, _, _, curves| curves[0] = "wal".into());
        assert!(unknown.starts_with("case.toml, line 9: ") && unknown.contains("\"wal\""), "{unknown}");
    }

    /// A square of 2 n^2 triangles graded towards x = 0, with sizes exp of a linear function at its nodes.
    fn table(n: u32) -> (Vec<DVec2>, Vec<[u32; 3]>, Vec<Metric3>) {
        let at = |i: u32| libm::pow(f64::from(i) / f64::from(n), 4.0);
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for j in 0..=n {
            for i in 0..=n {
                points.push(DVec2::new(at(i), f64::from(j) / f64::from(n)));
                if i < n && j < n {
                    let k = j * (n + 1) + i;
                    // One of the two is clockwise.
                    triangles.extend([[k, k + 1, k + n + 1], [k + n + 2, k + n + 1, k + 1]]);
                }
            }
        }
        let metrics = points.iter().map(|&p| exponential(p)).collect();
        (points, triangles, metrics)
    }

    fn exponential(p: DVec2) -> Metric3 {
        let h = libm::exp(2.0 * p.x - p.y);
        Metric3::from_sizes([0.01 * h, h, 3.0], [DVec3::new(1.0, 2.0, 0.0), DVec3::new(-2.0, 1.0, 0.0), DVec3::Z])
            .unwrap()
    }

    #[test]
    fn a_table_is_log_euclidean_between_its_nodes_and_clamped_outside() {
        let (points, triangles, metrics) = table(12);
        let sizing = Sizing::new(vec![Field::table(&points, &triangles, metrics).unwrap()], 1.0);
        let close = |a: Metric2, b: Metric2| {
            let d = (a.uu - b.uu).abs() + (a.uv - b.uv).abs() + (a.vv - b.vv).abs();
            assert!(d < 1e-11 * (b.uu + b.vv), "{a:?} {b:?}");
        };
        for k in 0..500 {
            let p = DVec2::new((f64::from(k) * 0.618_034).fract(), f64::from(k) / 499.0);
            close(sizing.metric(p).unwrap(), exponential(p).plane());
            let outside = DVec2::new(1.0 + 0.1 * p.x, p.y);
            close(sizing.metric(outside).unwrap(), exponential(DVec2::new(1.0, p.y)).plane());
        }
        for &p in &points {
            close(sizing.metric(p).unwrap(), exponential(p).plane());
        }
        close(sizing.metric(DVec2::new(-1.0, 2.0)).unwrap(), exponential(DVec2::new(0.0, 1.0)).plane());
        assert!(sizing.metric(DVec2::new(f64::NAN, 0.0)).is_err());
    }

    #[test]
    fn a_table_answers_the_same_bits_whatever_was_asked_before() {
        let (points, triangles, metrics) = table(6);
        let sizing = Sizing::new(vec![Field::table(&points, &triangles, metrics).unwrap()], 1.0);
        let places: Vec<DVec2> = (0..200).map(|k| points[(k * 7) % points.len()] * 0.99).collect();
        let forward: Vec<_> = places.iter().map(|&p| sizing.metric(p).unwrap()).collect();
        let backward: Vec<_> = places.iter().rev().map(|&p| sizing.metric(p).unwrap()).collect();
        assert!(forward.iter().eq(backward.iter().rev()));
    }

    #[test]
    fn bad_tables_are_refused() {
        let (points, triangles, metrics) = table(2);
        let fault = |points: &[DVec2], triangles: &[[u32; 3]], metrics: &[Metric3]| {
            Field::table(points, triangles, metrics.to_vec()).expect_err("a fault").to_string()
        };
        assert!(fault(&points[1..], &triangles, &metrics).contains("9 metrics for 8 nodes"));
        assert!(fault(&points, &[], &metrics).contains("no triangles"));
        assert!(fault(&points, &[[0, 1, 99]], &metrics).contains("Triangle 1"));
        assert!(fault(&points, &[[0, 1, 2]], &metrics).contains("no area"));
        let mut bad = metrics.clone();
        bad[3].xy = 1e9;
        assert!(fault(&points, &triangles, &bad).contains("node 4 is not positive definite"));
        let mut bad = points.clone();
        bad[0].x = f64::NAN;
        assert!(fault(&bad, &triangles, &metrics).contains("Node 1"));
    }
}
