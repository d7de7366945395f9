//! Inputs at the edge of what can be meant: each becomes a mesh that keeps the promise, or is refused with a remedy.

use std::path::Path;
use std::sync::mpsc;
use std::time::Duration;

use quadfront::core::case::Case;
use quadfront::core::convert::background;
use quadfront::core::convert::conversion::convert;
use quadfront::core::progress::Nobody;

use super::promise::keep;

const UNIFORM: &str = "[[metric]]\nkind = \"uniform\"\n";

fn polygon(name: &str, points: &[[f64; 2]], more: &str) -> String {
    format!("[[curve]]\nname = \"{name}\"\nkind = \"polyline\"\npoints = {points:?}\nclosed = true\n{more}\n")
}

fn square(size: f64, at: f64) -> String {
    polygon("rim", &[[at, at], [at + size, at], [at + size, at + size], [at, at + size]], "")
}

fn circle(name: &str, x: f64, y: f64, radius: f64) -> String {
    format!("[[curve]]\nname = \"{name}\"\nkind = \"circle\"\ncentre = [{x:?}, {y:?}]\nradius = {radius:?}\n")
}

fn face(outer: &str, more: &str) -> String {
    format!("[[face]]\nname = \"face\"\nouter = [\"{outer}\"]\n{more}\n")
}

fn plate(size: f64, at: f64) -> String {
    let middle = at + 0.5 * size;
    let geometry =
        square(size, at) + &circle("hole", middle, middle, 0.2 * size) + &face("rim", "holes = [[\"hole\"]]");
    format!("{geometry}{UNIFORM}h = {:?}\n", 0.1 * size)
}

/// Quadrilaterals, or the fault.
fn outcome(text: &str) -> Result<usize, String> {
    let text = format!("version = 1\n{text}");
    let (send, receive) = mpsc::channel();
    let inner = text.clone();
    std::thread::spawn(move || {
        let case = Case::parse(&inner, "hostile", "hostile.toml", Path::new(""));
        let kept = case.map_or_else(|fault| Ok(Err(fault)), |case| keep(&case));
        send.send(kept).unwrap();
    });
    match receive.recv_timeout(Duration::from_secs(60)) {
        Ok(Ok(Ok(kept))) => Ok(kept.quads),
        Ok(Ok(Err(fault))) => {
            assert!(!fault.remedy.is_empty(), "{fault} has no remedy\n{text}");
            Err(fault.to_string())
        }
        Ok(Err(broken)) => panic!("{broken}\n{text}"),
        Err(_) => panic!("no end, or a panic\n{text}"),
    }
}

fn meshed(text: &str) -> usize {
    outcome(text).unwrap_or_else(|fault| panic!("{fault}\n{text}"))
}

fn refused(text: &str) -> String {
    outcome(text).map_or_else(|fault| fault, |quads| panic!("{quads} quadrilaterals\n{text}"))
}

#[test]
fn tiny_huge_and_distant_domains_become_the_same_mesh_nearly() {
    let usual = meshed(&plate(1.0, 0.0));
    for (size, at) in [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e6), (1e-20, 0.0), (1e20, 1e20)] {
        let quads = meshed(&plate(size, at));
        assert!(quads.abs_diff(usual) * 10 < usual, "{quads} and not {usual} at {size} {at}");
    }
    assert!(refused(&plate(1.0, 1e12)).contains("across"), "coordinates have no digits left");
}

#[test]
fn thin_domains_are_meshed_whatever_the_size() {
    for thickness in [1e-2, 1e-4, 1e-6] {
        let strip = polygon("rim", &[[0.0, 0.0], [1.0, 0.0], [1.0, thickness], [0.0, thickness]], "");
        for h in [100.0, 0.3, 0.02] {
            meshed(&format!("{strip}{}{UNIFORM}h = {h}\n", face("rim", "")));
        }
        let across = format!("[[metric]]\nkind = \"formula\"\nh1 = 0.05\nh2 = {:?}\n", 0.2 * thickness);
        if thickness >= 1e-4 {
            meshed(&format!("{strip}{}{across}", face("rim", "")));
        }
        let slanting = polygon("rim", &[[0.0, 0.0], [1.0, 0.7], [1.0, 0.7 + thickness], [0.0, thickness]], "");
        meshed(&format!("{slanting}{}{UNIFORM}h = 0.05\n", face("rim", "")));
    }
}

#[test]
fn sharp_corners_are_meshed() {
    for degrees in [10.0, 1.0, 0.1, 0.01] {
        let height = libm::tan(f64::to_radians(degrees));
        for h in [10.0, 0.2, 0.02] {
            let needle = polygon("rim", &[[0.0, 0.0], [1.0, 0.0], [1.0, height]], "");
            meshed(&format!("{needle}{}{UNIFORM}h = {h}\n", face("rim", "")));
            // The same angle as a notch.
            let notch = [[0.0, 0.0], [1.0, -1.0], [1.0, 0.0], [0.1, 0.0], [1.0, height], [1.0, 1.0], [-1.0, 0.5]];
            meshed(&format!("{}{}{UNIFORM}h = {h}\n", polygon("rim", &notch, ""), face("rim", "")));
        }
    }
}

#[test]
fn the_smallest_domains_are_meshed() {
    for sides in [3, 4] {
        let corners = &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][..sides];
        let quads = meshed(&format!("{}{}{UNIFORM}h = 1\n", polygon("rim", corners, "segments = 4"), face("rim", "")));
        assert!(quads < 20, "{quads}");
    }
    for h in [2.0, 1e3, 1e9] {
        assert!(meshed(&format!("{}{}{UNIFORM}h = {h:?}\n", square(1.0, 0.0), face("rim", ""))) < 20);
        assert!(meshed(&format!("{}{}{UNIFORM}h = {h:?}\n", circle("rim", 0.0, 0.0, 1.0), face("rim", ""))) < 20);
        let triangle = polygon("rim", &[[0.0, 0.0], [1.0, 0.0], [0.3, 1.0]], "");
        assert!(meshed(&format!("{triangle}{}{UNIFORM}h = {h:?}\n", face("rim", ""))) < 20);
    }
}

#[test]
fn many_tiny_holes_and_narrow_gaps_are_meshed() {
    let mut text = square(1.0, 0.0);
    let mut holes = Vec::new();
    for k in 0..100 {
        let name = format!("hole {k}");
        text += &circle(&name, 0.05 + 0.1 * f64::from(k % 10), 0.05 + 0.1 * f64::from(k / 10), 1e-4);
        holes.push(format!("[\"{name}\"]"));
    }
    meshed(&format!("{text}{}{UNIFORM}h = 0.2\n", face("rim", &format!("holes = [{}]", holes.join(", ")))));
    for gap in [1e-2, 1e-4, 1e-6] {
        let text = square(1.0, 0.0) + &circle("a", 0.3, 0.5, 0.1) + &circle("b", 0.5 + gap, 0.5, 0.1);
        meshed(&format!("{text}{}{UNIFORM}h = 0.1\n", face("rim", "holes = [[\"a\"], [\"b\"]]")));
        let crack =
            format!("[[curve]]\nname = \"c\"\nkind = \"segment\"\nfrom = [0.4, 0.3]\nto = [{:?}, 0.3]\n", 1.0 - gap);
        meshed(&format!("{}{crack}{}{UNIFORM}h = 0.1\n", square(1.0, 0.0), face("rim", "cracks = [\"c\"]")));
    }
    let touching = square(1.0, 0.0) + &circle("a", 0.3, 0.5, 0.1) + &circle("b", 0.5, 0.5, 0.1);
    refused(&format!("{touching}{}{UNIFORM}h = 0.1\n", face("rim", "holes = [[\"a\"], [\"b\"]]")));
}

#[test]
fn metrics_that_jump_or_swing_are_meshed() {
    let with = |formula: &str| {
        outcome(&format!(
            "{}{}[parameters]\nmax_quads = 30000\n[[metric]]\nkind = \"formula\"\n{formula}\n",
            square(1.0, 0.0),
            face("rim", "")
        ))
    };
    for formula in [
        "h1 = \"0.02 + 0.1*floor(5*x)\"",
        "h1 = \"0.1*(1.5 + sin(1000*x))\"",
        "h1 = \"max(1e-3, abs(x - y))\"",
        "h1 = 0.001\nh2 = 10\ng1 = [1, 1]",
        "h1 = 0.001\nh2 = 1\ng1 = [\"1 + 0*x\", \"sign(y - 0.5)\"]",
        "h1 = 0.01\nh2 = 100\ng1 = [\"cos(20*x)\", \"sin(20*x)\"]",
        "h1 = \"exp(-4*x)\"",
    ] {
        with(formula).unwrap_or_else(|fault| panic!("{formula}: {fault}"));
    }
    for formula in [
        "h1 = 1e-9",
        "h1 = \"x - 0.5\"",
        "h1 = \"sqrt(x - 0.5)\"",
        "h1 = \"1/(x - x)\"",
        "h1 = \"1e-7 + abs(x - 0.5)\"",
        "h1 = 1e-3\nh2 = 1e300",
        "h1 = 0.1\nh2 = 1\ng1 = [1, 1]\ng2 = [2, 2]",
    ] {
        assert!(with(formula).is_err(), "{formula}");
    }
}

/// A hole of eight sides where the metric asks for some hundreds.
fn coarse_hole_in_a_thin_metric() -> Case {
    let hole = circle("hole", 0.5, 0.5, 0.1) + "segments = 8\n";
    let metric = "[[metric]]\nkind = \"formula\"\nh1 = 0.004\nh2 = 4\ng1 = [1, -0.3]\n";
    let text = format!("version = 1\n{}{hole}{}{metric}", square(1.0, 0.0), face("rim", "holes = [[\"hole\"]]"));
    Case::parse(&text, "hole", "hole.toml", Path::new("")).unwrap()
}

#[test]
fn beside_sides_that_are_much_too_long_no_needles_gather() {
    // Edges beside such a side stay long however often they are divided: each division once halved an altitude, down to
    // the least that is representable.
    let mesh = background(&coarse_hole_in_a_thin_metric(), &mut Nobody).unwrap().mesh;
    let worst = mesh.elements().map(|e| mesh.quality(e)).fold(f64::INFINITY, f64::min);
    assert!(worst > 1e-4, "{worst:e}");
}

#[test]
fn segments_that_were_deferred_are_all_taken_up_again_once_only() {
    // They were after every quadrilateral of the second pass, which is quadratic where the front fails at most of them.
    let converted = convert(&coarse_hole_in_a_thin_metric(), &mut Nobody).unwrap();
    let (steps, triangles) = (converted.counts.steps, converted.triangles as u64);
    assert!(steps < 150 * triangles, "{steps} steps for {triangles} triangles");
}
