//! Random metrics: uniform, graded, stretched, turning, thin layers, boundary layers, and intersections of them.

use std::f64::consts::TAU;

use super::random::Random;
use super::random_case::Draft;

/// The metric tables of a case.
pub fn text(r: &mut Random, draft: &Draft) -> String {
    let mut text = String::new();
    if r.chance(0.15) {
        text += &format!("gradation = {:?}\n\n", r.range(1.1, 2.0));
    }
    text += &field(r, draft);
    if r.chance(0.2) {
        text += &field(r, draft);
    }
    if r.chance(0.15) {
        text += &boundary_layer(r, draft);
    }
    text
}

/// A number in a formula.
fn n(x: f64) -> String {
    format!("({x:?})")
}

fn field(r: &mut Random, draft: &Draft) -> String {
    let frame = &draft.frame;
    if r.chance(0.1) {
        return format!("[[metric]]\nkind = \"uniform\"\nh = {:?}\n\n", 0.1 * frame.scale);
    }
    // p and q are local coordinates, s is the unit of length, c and d the cosine and sine of the turn.
    let mut helpers = vec![
        ("s", n(frame.scale)),
        ("c", n(libm::cos(frame.turn))),
        ("d", n(libm::sin(frame.turn))),
        ("p", format!("((x - {})*c + (y - {})*d)/s", n(frame.origin.x), n(frame.origin.y))),
        ("q", format!("((y - {})*c - (x - {})*d)/s", n(frame.origin.y), n(frame.origin.x))),
    ];
    let (p0, q0, angle) = (r.range(-0.8, 0.8), r.range(-0.8, 0.8), r.range(0.0, TAU));
    let (gp, gq) = (libm::cos(angle), libm::sin(angle));
    let from_point = format!("hypot(p - {}, q - {})", n(p0), n(q0));
    let from_line = format!("abs({}*p + {}*q - {})", n(gp), n(gq), n(0.5 * p0));
    // (h1, h2, direction of h1 in local coordinates)
    let (h1, h2, g1) = match r.whole(0, 5) {
        0 => {
            let place = if r.chance(0.5) { from_point } else { from_line };
            (format!("{} + {}*{place}", n(r.power(-2.5, -0.7)), n(r.range(0.05, 0.7))), None, None)
        }
        1 => (n(0.1), Some(n(0.1 * r.power(0.0, 4.0))), Some([n(gp), n(gq)])),
        2 => {
            // The direction turns with the place.
            let (a, b) = (r.range(-2.0, 2.0), r.range(-2.0, 2.0));
            helpers.push(("w", format!("{} + {}*p + {}*q", n(angle), n(a), n(b))));
            let ratio = format!("{}*exp({}*sin(3*q))", n(r.power(0.0, 3.5)), n(r.range(0.0, 1.0)));
            (n(0.1), Some(format!("0.1*{ratio}")), Some(["cos(w)".into(), "sin(w)".into()]))
        }
        3 => {
            let across = format!("{} + {}*{from_line}", n(r.power(-4.0, -1.0)), n(r.range(0.05, 0.7)));
            (across, Some(n(r.power(-1.5, 0.5))), Some([n(gp), n(gq)]))
        }
        4 => {
            // Thin about a circle.
            let radius = r.range(0.2, 1.0);
            let across =
                format!("{} + {}*abs({from_point} - {})", n(r.power(-3.5, -1.0)), n(r.range(0.05, 0.7)), n(radius));
            let g1 = [format!("1e9*(p - {}) + 1", n(p0)), format!("1e9*(q - {})", n(q0))];
            (across, Some(n(r.power(-1.5, 0.0))), Some(g1))
        }
        _ => {
            // Example 1, with a ridge.
            helpers.push(("t", from_line.clone()));
            let h = format!("({} + 0.15*t)", n(r.power(-2.5, -1.0)));
            (h.clone(), Some(format!("15*{h}*exp(-3*t)")), Some([n(gp), n(gq)]))
        }
    };
    let mut text = format!("[[metric]]\nkind = \"formula\"\nh1 = \"s*({h1})\"\n");
    if let Some(h2) = h2 {
        text += &format!("h2 = \"s*({h2})\"\n");
    }
    if let Some([g_p, g_q]) = g1 {
        text += &format!("g1 = [\"c*({g_p}) - d*({g_q})\", \"d*({g_p}) + c*({g_q})\"]\n");
    }
    text += "\n[metric.let]\n";
    for (name, formula) in helpers {
        text += &format!("{name} = \"{formula}\"\n");
    }
    text + "\n"
}

fn boundary_layer(r: &mut Random, draft: &Draft) -> String {
    let used = |name: &str| draft.faces.iter().flat_map(|face| &face.outer).any(|n| n == name);
    let names: Vec<&str> = draft.curves.iter().map(|c| c.0.as_str()).filter(|name| used(name)).collect();
    let name = names[r.whole(0, names.len() - 1)];
    let first = r.power(-3.0, -1.3) * draft.frame.scale;
    let mut text = format!(
        "[[metric]]\nkind = \"boundary_layer\"\ncurves = [\"{name}\"]\nfirst = {first:?}\ngrowth = {:?}\n",
        r.range(1.05, 2.0)
    );
    if r.chance(0.5) {
        text += &format!("far = {:?}\n", first * r.range(2.0, 20.0));
    }
    if r.chance(0.3) {
        text += &format!("along = {:?}\n", r.power(-1.5, -0.5) * draft.frame.scale);
    }
    text + "\n"
}
