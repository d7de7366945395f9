//! Timing and memory of the conversion of given triangles, on one thread: the front with its local post-processing, and
//! with the global post-processing after it. Targets: 100,000 (uniform) and 50,000 (example 1) quadrilaterals a
//! second by the front, 50,000 and 30,000 with post-processing, cost exponent at most 1.05 up to a million, and at most
//! 1 KiB a quadrilateral at the peak.
#![allow(clippy::unwrap_used)]

use quadfront::core::case::built_in;
use quadfront::core::convert::Converter;
use quadfront::core::convert::background;
use quadfront::core::prepare::Background;
use quadfront::core::progress::{Nobody, Stage, Watch};

mod meter;

fn main() {
    println!("Conversion, {}", meter::clock());
    println!(
        "case           quads   front: s    quads/s  exponent  and finish: s    quads/s  exponent  peak bytes/quad"
    );
    // Scales that give about 10,000, 100,000 and 1,000,000 quadrilaterals.
    let cases = [
        ("uniform", [0.2, 0.0633, 0.0197]),
        ("example1", [0.163, 0.0516, 0.0161]),
        ("example2", [0.154, 0.0475, 0.0148]),
    ];
    for (name, scales) in cases {
        let mut before: Option<(usize, [f64; 2])> = None;
        for scale in scales {
            let mut case = built_in::named(name).unwrap().unwrap();
            case.parameters.size_scale = scale;
            let Background { mesh, sizing, .. } = background(&case, &mut Nobody).unwrap();
            let forgotten = meter::forget_peak();
            let mut converter = Converter::new(mesh, &sizing, case.parameters.clone());
            let mut lap = Lap { start: meter::now(), front: None };
            converter.run(&mut lap).unwrap();
            let seconds = [lap.front.unwrap(), meter::since(lap.start)];
            let n = converter.mesh.element_count();
            let peak = meter::peak_memory().filter(|_| forgotten);
            let exponent = |i: usize| {
                before.map_or(String::new(), |(m, s)| format!("{:.2}", meter::exponent([m, n], [s[i], seconds[i]])))
            };
            println!(
                "{name:10} {n:9} {:10.3} {:10.0} {:>9} {:14.3} {:10.0} {:>9} {:>16}",
                seconds[0],
                n as f64 / seconds[0],
                exponent(0),
                seconds[1],
                n as f64 / seconds[1],
                exponent(1),
                peak.map_or("not told".to_owned(), |bytes| format!("{:.0}", bytes / n as f64))
            );
            before = Some((n, seconds));
        }
    }
}

/// Notes when the front is done.
struct Lap {
    start: meter::Moment,
    front: Option<f64>,
}

impl Watch for Lap {
    fn tell(&mut self, stage: Stage, _: u64, _: u64) {
        if stage == Stage::Finish && self.front.is_none() {
            self.front = Some(meter::since(self.start));
        }
    }
}
