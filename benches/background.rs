//! Timing of the background mesh, from a case in memory to a mesh in memory, on one thread: domain, survey of the
//! metric, division of the curves, triangulation, adaptation. Targets: 100,000 triangles a second at 100,000
//! triangles, cost exponent at most 1.1 up to a million.
#![allow(clippy::unwrap_used)]

use quadfront::core::case::{Case, built_in};
use quadfront::core::convert::background;
use quadfront::core::prepare::Background;
use quadfront::core::progress::Nobody;
use quadfront::core::record::{Export, Statistics};

mod meter;

fn main() {
    println!("Background mesh, {}", meter::clock());
    println!("case            triangles    seconds  triangles/s  exponent  unit edges  quality (least, mean)");
    for (name, _) in built_in::CASES {
        row(&built_in::named(name).unwrap().unwrap(), 5, None);
    }
    // Scales that give about 10,000, 100,000 and 1,000,000 triangles.
    for (name, scales) in [("uniform", [0.316, 0.1, 0.0317]), ("example1", [0.258, 0.0816, 0.0259])] {
        let mut before = None;
        for (scale, runs) in scales.into_iter().zip([5, 5, 3]) {
            let mut case = built_in::named(name).unwrap().unwrap();
            case.parameters.size_scale = scale;
            before = Some(row(&case, runs, before));
        }
    }
}

/// Measures a case and prints its row; gives its number of triangles and seconds.
fn row(case: &Case, runs: usize, before: Option<(usize, f64)>) -> (usize, f64) {
    let (Background { mesh, sizing, names, .. }, seconds) =
        meter::median_of(runs, || background(case, &mut Nobody).unwrap());
    let told = Statistics::measure(Export::of(&mesh, &names).measured(), &sizing).unwrap();
    let n = told.triangles;
    let exponent = before.map_or(String::new(), |(m, s)| format!("{:.2}", meter::exponent([m, n], [s, seconds])));
    let quality = told.quality.unwrap();
    println!(
        "{:14} {n:10} {seconds:10.4} {:12.0} {exponent:>9} {:9.1} % {:11.2}, {:.3}",
        case.name,
        n as f64 / seconds,
        100.0 * told.lengths.share_unit,
        quality.min,
        quality.mean
    );
    (n, seconds)
}
