//! Curves of random cases in local coordinates of order 1, and the similarity that takes them to their place.

use glam::DVec2;

/// Where a case lies: turned, scaled and moved.
#[derive(Clone, Copy)]
pub struct Frame {
    pub origin: DVec2,
    pub scale: f64,
    pub turn: f64,
}

impl Frame {
    pub fn place(&self, p: DVec2) -> DVec2 {
        self.origin + self.scale * DVec2::new(libm::cos(self.turn), libm::sin(self.turn)).rotate(p)
    }
}

/// A curve, from its first to its last point.
#[derive(Clone)]
pub enum Curve {
    /// Straight lines; closed when the first point is the last as well.
    Path(Vec<DVec2>),
    /// An arc about a centre, from an angle by an angle.
    Arc { centre: DVec2, radius: f64, from: f64, by: f64 },
    /// A cubic spline, clamped at its ends.
    Spline(Vec<DVec2>),
}

impl Curve {
    pub fn line(a: DVec2, b: DVec2) -> Self {
        Curve::Path(vec![a, b])
    }

    pub fn circle(centre: DVec2, radius: f64, from: f64) -> Self {
        Curve::Arc { centre, radius, from, by: std::f64::consts::TAU }
    }

    /// The arc from a to b that turns by `by` (positive: bulging to the right).
    pub fn arc_between(a: DVec2, b: DVec2, by: f64) -> Self {
        let half = 0.5 * (b - a);
        let centre = a + half + half.perp() / libm::tan(0.5 * by);
        let from = libm::atan2(a.y - centre.y, a.x - centre.x);
        Curve::Arc { centre, radius: centre.distance(a), from, by }
    }

    /// Points along the curve, at most about `spacing` apart.
    pub fn sampled(&self, spacing: f64) -> Vec<DVec2> {
        let mut points = Vec::new();
        let parts = |length: f64| (length / spacing).ceil().clamp(1.0, 200.0) as usize;
        match self {
            Curve::Path(path) => {
                for w in path.windows(2) {
                    let n = parts(w[0].distance(w[1]));
                    points.extend((0..n).map(|k| w[0].lerp(w[1], k as f64 / n as f64)));
                }
                points.extend(path.last());
            }
            Curve::Arc { centre, radius, from, by } => {
                let n = parts(radius * by.abs()).max(4);
                points.extend((0..=n).map(|k| on_circle(*centre, *radius, from + by * k as f64 / n as f64)));
            }
            Curve::Spline(control) => {
                let n = parts(control.windows(2).map(|w| w[0].distance(w[1])).sum());
                let end = (control.len() - 3) as f64;
                points.extend((0..=n).map(|k| on_spline(control, end * k as f64 / n as f64)));
            }
        }
        points
    }

    /// The table of a case file.
    pub fn toml(&self, name: &str, segments: Option<usize>, frame: &Frame) -> String {
        let point = |p: DVec2| {
            let p = frame.place(p);
            format!("[{:?}, {:?}]", p.x, p.y)
        };
        let list = |points: &[DVec2]| points.iter().map(|&p| point(p)).collect::<Vec<_>>().join(", ");
        let shape = match self {
            Curve::Path(path) if path.len() == 2 => {
                format!("kind = \"segment\"\nfrom = {}\nto = {}", point(path[0]), point(path[1]))
            }
            Curve::Path(path) if path[0] == path[path.len() - 1] => {
                format!("kind = \"polyline\"\npoints = [{}]\nclosed = true", list(&path[1..]))
            }
            Curve::Path(path) => format!("kind = \"polyline\"\npoints = [{}]", list(path)),
            Curve::Arc { centre, radius, from, by } => {
                let (from, by) = ((from + frame.turn).to_degrees(), by.to_degrees());
                let centre = point(*centre);
                let radius = radius * frame.scale;
                if by == 360.0 {
                    format!("kind = \"circle\"\ncentre = {centre}\nradius = {radius:?}\nstart_angle = {from:?}")
                } else {
                    let to = from + by;
                    format!(
                        "kind = \"arc\"\ncentre = {centre}\nradius = {radius:?}\nfrom_angle = {from:?}\nto_angle = {to:?}"
                    )
                }
            }
            Curve::Spline(control) => {
                let inner = control.len() - 4;
                let mut knots = vec!["0".to_owned(); 4];
                knots.extend((1..=inner).map(|k| k.to_string()));
                knots.extend(vec![(inner + 1).to_string(); 4]);
                format!("kind = \"nurbs\"\ndegree = 3\nknots = [{}]\npoints = [{}]", knots.join(", "), list(control))
            }
        };
        let segments = segments.map_or(String::new(), |n| format!("segments = {n}\n"));
        format!("[[curve]]\nname = \"{name}\"\n{shape}\n{segments}\n")
    }
}

pub fn on_circle(centre: DVec2, radius: f64, angle: f64) -> DVec2 {
    centre + radius * DVec2::new(libm::cos(angle), libm::sin(angle))
}

/// The point at `t` of the cubic spline with knots 0, 0, 0, 0, 1, 2 ... n, n, n, n (de Boor).
fn on_spline(control: &[DVec2], t: f64) -> DVec2 {
    let last = control.len() - 4;
    let knot = |k: usize| k.saturating_sub(3).min(last + 1) as f64;
    let span = 3 + (t as usize).min(last);
    let mut d = [0, 1, 2, 3].map(|j| control[span - 3 + j]);
    for round in 1..=3 {
        for j in (round..=3).rev() {
            let (low, high) = (knot(j + span - 3), knot(j + 1 + span - round));
            d[j] = d[j - 1].lerp(d[j], (t - low) / (high - low));
        }
    }
    d[3]
}

/// Whether the point lies inside the closed polygon.
pub fn inside(polygon: &[DVec2], p: DVec2) -> bool {
    let mut odd = false;
    for (k, &b) in polygon.iter().enumerate() {
        let a = polygon[(k + polygon.len() - 1) % polygon.len()];
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) {
            odd = !odd;
        }
    }
    odd
}

/// The distance of a point from a segment.
pub fn to_segment(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let share = ((p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    p.distance(a + along * share)
}
