//! The guarantee on random patches with random trims, and on random complexes of faces that share curves.

use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use quadfront::core::convert::background;
use quadfront::core::progress::Nobody;

use super::{make, parsed};

/// Rounds, or as many as `QUADFRONT_SOAK_ROUNDS` says.
fn run<S: Strategy>(few: u64, strategy: &S, test: impl Fn(S::Value) -> Result<(), TestCaseError>) {
    let config = ProptestConfig {
        cases: crate::environment::number("QUADFRONT_SOAK_ROUNDS").unwrap_or(few) as u32,
        failure_persistence: None,
        ..ProptestConfig::default()
    };
    TestRunner::new_with_rng(config, proptest::test_runner::TestRng::deterministic_rng(Default::default()))
        .run(strategy, test)
        .unwrap();
}

/// A bicubic patch over a square whose points are moved by less than a third of their distance, so that its derivatives
/// never become parallel, bent out of the plane at random.
fn patch() -> impl Strategy<Value = String> {
    prop::collection::vec((-0.3..0.3f64, -0.3..0.3f64, -1.0..1.0f64), 16).prop_map(|moved| {
        let point = |k: usize| {
            let (i, j) = ((k / 4) as f64, (k % 4) as f64);
            let (a, b, c) = moved[k];
            format!("[{}, {}, {}]", i + a, j + b, c)
        };
        let rows: Vec<String> =
            (0..4).map(|i| format!("[{}]", (0..4).map(|j| point(4 * i + j)).collect::<Vec<_>>().join(", "))).collect();
        format!("[[surface]]\nname = \"s\"\nkind = \"bezier\"\npoints = [{}]\n", rows.join(", "))
    })
}

#[test]
fn random_patches_with_random_trims_become_sound_meshes() {
    let hole = (0.3..0.7f64, 0.3..0.7f64, 0.08..0.25f64, prop::bool::ANY);
    let sizes = (0.12..0.5f64, 0.2..1.0f64, -1.0..1.0f64);
    run(16, &(patch(), hole, sizes), |(surface, (u, v, r, cut), (h, ratio, turn))| {
        let trims = if cut {
            format!(
                "[[curve]]\nname = \"hole\"\nkind = \"circle\"\non = \"s\"\ncentre = [{u}, {v}]\nradius = {r}\n\
                 [[face]]\nname = \"f\"\nsurface = \"s\"\nholes = [[\"hole\"]]\n"
            )
        } else {
            "[[face]]\nname = \"f\"\nsurface = \"s\"\n".to_owned()
        };
        let case = parsed(&format!(
            "version = 1\n{surface}{trims}[[metric]]\nkind = \"formula\"\nh1 = {}\nh2 = {h}\ng1 = [1, {turn}, 0.2]\n\
             g2 = [{turn}, -1, 0]\n[[metric]]\nkind = \"curvature\"\nchord = 0.05\nleast = 0.05\nfar = 1\n",
            h * ratio
        ));
        if background(&case, &mut Nobody).is_ok_and(|made| made.mesh.element_count() > 20_000) {
            return Ok(());
        }
        make(&case).assert_sound(&case.text);
        Ok(())
    });
}

#[test]
fn random_fans_of_planes_share_their_line_whatever_their_number() {
    let planes = prop::collection::vec((0.0..360.0f64, 0.5..2.0f64), 1..6);
    run(16, &(planes, 0.15..0.4f64), |(planes, h)| {
        let mut text =
            "version = 1\n[[curve]]\nname = \"line\"\nkind = \"segment\"\nfrom = [0, 0, 0]\nto = [0, 0, 1]\n"
                .to_owned();
        let mut angles: Vec<f64> = planes.iter().map(|p| p.0).collect();
        angles.sort_by(f64::total_cmp);
        // Planes that nearly coincide would lie in each other.
        if angles.windows(2).any(|w| w[1] - w[0] < 5.0) || angles[angles.len() - 1] - angles[0] > 355.0 {
            return Ok(());
        }
        for (k, (angle, reach)) in planes.iter().enumerate() {
            let (sin, cos) = libm::sincos(angle.to_radians());
            let (x, y) = (reach * cos, reach * sin);
            text += &format!(
                "[[surface]]\nname = \"s{k}\"\nkind = \"plane\"\nu = [{x}, {y}, 0]\nv = [0, 0, 1]\n\
                 [[curve]]\nname = \"rim{k}\"\nkind = \"polyline\"\npoints = [[0, 0, 0], [{x}, {y}, 0], [{x}, {y}, 1], [0, 0, 1]]\n\
                 [[face]]\nname = \"f{k}\"\nsurface = \"s{k}\"\nouter = [\"line\", \"rim{k}\"]\n"
            );
        }
        text += &format!("[[metric]]\nkind = \"uniform\"\nh = {h}\n");
        make(&parsed(&text)).assert_sound(&text);
        Ok(())
    });
}

/// A node of a grid of cells, by its three numbers.
type Node = [usize; 3];

/// The sides of the cells of a grid of 2 x 2 x 2 whose nodes are moved: each four nodes in order.
fn sides_of_cells() -> Vec<[Node; 4]> {
    let mut sides = Vec::new();
    for axis in 0..3 {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        for k in 0..27 {
            let corner: Node = [k % 3, k / 3 % 3, k / 9];
            if corner[i] < 2 && corner[j] < 2 {
                let at = |a: usize, b: usize| {
                    let mut node = corner;
                    node[i] += a;
                    node[j] += b;
                    node
                };
                sides.push([at(0, 0), at(1, 0), at(1, 1), at(0, 1)]);
            }
        }
    }
    sides
}

/// Twisted sides of a grid's cells, any of them left out, with up to six faces at an edge, cells closed and open; some
/// edges with a given number of segments, odd or even, some faces with a hole. Where the given numbers cannot be even
/// on all faces the fault says so and names a loop; all else converts.
#[test]
fn random_complexes_of_twisted_faces_are_sound_or_their_odd_loop_is_named() {
    let sides = sides_of_cells();
    let moved = prop::collection::vec((-0.25..0.25f64, -0.25..0.25f64, -0.25..0.25f64), 27);
    let taken = prop::collection::vec(prop::bool::weighted(0.4), sides.len());
    let given = prop::collection::vec(prop::option::weighted(0.25, 2..6u32), 54);
    let holes = prop::collection::vec(prop::bool::weighted(0.2), sides.len());
    run(24, &(moved, taken, given, holes, 0.2..0.5f64), |(moved, taken, given, holes, h)| {
        let place = |n: Node| {
            let (a, b, c) = moved[n[0] + 3 * n[1] + 9 * n[2]];
            format!("[{}, {}, {}]", n[0] as f64 + a, n[1] as f64 + b, n[2] as f64 + c)
        };
        let mut edges: Vec<[Node; 2]> = Vec::new();
        let mut faces = String::new();
        for (k, side) in sides.iter().enumerate().filter(|(k, _)| taken[*k]) {
            let outer: Vec<String> = (0..4)
                .map(|i| {
                    let mut edge = [side[i], side[(i + 1) % 4]];
                    edge.sort_unstable();
                    let found = edges.iter().position(|e| *e == edge).unwrap_or_else(|| {
                        edges.push(edge);
                        edges.len() - 1
                    });
                    format!("\"e{found}\"")
                })
                .collect();
            let [a, b, c, d] = side.map(place);
            faces += &format!("[[surface]]\nname = \"s{k}\"\nkind = \"bezier\"\npoints = [[{a}, {d}], [{b}, {c}]]\n");
            let mut hole = "";
            let text;
            if holes[k] {
                faces += &format!(
                    "[[curve]]\nname = \"h{k}\"\nkind = \"circle\"\non = \"s{k}\"\ncentre = [0.5, 0.45]\nradius = 0.2\n"
                );
                text = format!("holes = [[\"h{k}\"]]\n");
                hole = &text;
            }
            faces += &format!("[[face]]\nname = \"f{k}\"\nsurface = \"s{k}\"\nouter = [{}]\n{hole}", outer.join(", "));
        }
        if edges.is_empty() {
            return Ok(());
        }
        let mut text = "version = 1\n".to_owned();
        for (k, [a, b]) in edges.iter().enumerate() {
            let (a, b) = (place(*a), place(*b));
            text += &format!("[[curve]]\nname = \"e{k}\"\nkind = \"segment\"\nfrom = {a}\nto = {b}\n");
            if let Some(count) = given[k] {
                text += &format!("segments = {count}\n");
            }
        }
        text += &format!("{faces}[[metric]]\nkind = \"uniform\"\nh = {h}\n");
        let case = parsed(&text);
        match background(&case, &mut Nobody) {
            Ok(_) => make(&case).assert_sound(&text),
            Err(fault) => {
                let said = fault.to_string();
                prop_assert!(said.contains("even") && said.contains("loop of \"f"), "{said}\n{text}");
            }
        }
        Ok(())
    });
}
