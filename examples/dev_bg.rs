#[path = "../benches/meter/mod.rs"]
mod meter;
use quadfront::core::convert::conversion::background;
use quadfront::core::io::built_in;
use quadfront::core::progress::Nobody;
fn main() {
    for _ in 0..2 {
        for (name, sc) in [("uniform", [0.1, 0.0317]), ("example1", [0.0816, 0.0259])] {
            let mut b = None;
            for (s, r) in sc.into_iter().zip([7, 3]) {
                let mut case = built_in::named(name).unwrap().unwrap();
                case.parameters.size_scale = s;
                let (bg, t) = meter::median_of(r, || background(&case, &mut Nobody).unwrap());
                let n = bg.mesh.element_count();
                if let Some((m, u)) = b {
                    println!("{name} {n} {t:.3} {:.0} exp {:.3}", n as f64 / t, meter::exponent([m, n], [u, t]))
                } else {
                    println!("{name} {n} {t:.4} {:.0}", n as f64 / t)
                }
                b = Some((n, t));
            }
        }
    }
}
