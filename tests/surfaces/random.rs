//! The guarantee on random patches with random trims, and on random complexes of faces that share curves.

use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use quadfront::core::convert::conversion::background;
use quadfront::core::progress::Nobody;

use super::{make, parsed};

/// Rounds, or as many as `QUADFRONT_SOAK_ROUNDS` says.
fn rounds(few: u32) -> u32 {
    std::env::var("QUADFRONT_SOAK_ROUNDS").ok().and_then(|n| n.parse().ok()).unwrap_or(few)
}

fn run<S: Strategy>(few: u32, strategy: &S, test: impl Fn(S::Value) -> Result<(), TestCaseError>) {
    let config = ProptestConfig { cases: rounds(few), failure_persistence: None, ..ProptestConfig::default() };
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
