//! Timing and memory of the conversion of given triangles, on one thread: the front with its local post-processing, and
//! with the global post-processing after it. Issue figures: 100,000 (uniform) and 50,000 (example 1) quadrilaterals a
//! second by the front, 50,000 and 30,000 with post-processing, cost exponent at most 1.05 up to a million, and at most
//! 1 KiB a quadrilateral at the peak.
#![allow(clippy::unwrap_used)]

use quadfront::core::convert::conversion::{Background, background};
use quadfront::core::convert::converter::Converter;
use quadfront::core::io::built_in;
use quadfront::core::progress::Nobody;

mod meter;

fn main() {
    println!("Conversion, {}", meter::clock());
    println!("case       post-processing      quads    seconds    quads/s  exponent  peak bytes/quad");
    // Scales that give about 10,000, 100,000 and 1,000,000 quadrilaterals.
    for (name, scales) in [("uniform", [0.2, 0.0633, 0.02]), ("example1", [0.163, 0.0516, 0.0163])] {
        let mut before = [None; 2];
        for (scale, runs) in scales.into_iter().zip([3, 3, 1]) {
            let mut case = built_in::named(name).unwrap().unwrap();
            case.parameters.size_scale = scale;
            let Background { mesh, sizing, .. } = background(&case, &mut Nobody).unwrap();
            for (post_processing, before) in [false, true].into_iter().zip(&mut before) {
                let mut parameters = case.parameters.clone();
                parameters.post_processing = post_processing;
                let told = meter::forget_peak();
                let (quads, seconds) = meter::median_of(runs, || {
                    // The copy of the given mesh is part of the measured memory, as a caller's own would be.
                    let mut converter = Converter::new(mesh.clone(), &sizing, parameters.clone());
                    converter.run(&mut Nobody).unwrap();
                    converter.mesh.element_count()
                });
                let peak = meter::peak_memory().filter(|_| told).map(|bytes| bytes / quads as f64);
                let exponent =
                    before.map_or(String::new(), |(n, s)| format!("{:.2}", meter::exponent([n, quads], [s, seconds])));
                *before = Some((quads, seconds));
                println!(
                    "{name:10} {:15} {quads:10} {seconds:10.4} {:10.0} {exponent:>9} {:>16}",
                    if post_processing { "with" } else { "without" },
                    quads as f64 / seconds,
                    peak.map_or("not told".to_owned(), |bytes| format!("{bytes:.0}"))
                );
            }
        }
    }
}
