use quadfront::core::convert::conversion::convert;
use quadfront::core::io::{built_in, export::Export, statistics::Statistics};
use quadfront::core::progress::Nobody;
fn main() {
    let only: Vec<String> = std::env::args().skip(1).collect();
    let sets: &[(&str, &str, f64, usize)] = &[
        ("ex1", "example1", 1.0, 9),
        ("ex1h", "example1", 0.5, 5),
        ("ex1q", "example1", 0.25, 3),
        ("uni10k", "uniform", 0.2, 2),
        ("graded", "graded-plate", 1.0, 3),
        ("polar-2", "polar-2", 1.0, 5),
        ("sqlin", "square-linear", 1.0, 3),
        ("gear", "gear", 1.0, 3),
        ("airfoil", "airfoil", 1.0, 3),
        ("crack", "crack", 1.0, 3),
        ("twofac", "two-faces", 1.0, 3),
        ("polar-1", "polar-1", 1.0, 3),
    ];
    let t0 = std::time::Instant::now();
    for (label, name, s, n) in sets {
        if !only.is_empty() && !only.iter().any(|o| o == label) {
            continue;
        }
        let mut a = [0.0; 12];
        let mut time = 0.0;
        let (mut lo, mut hi) = (180.0f64, 0.0f64);
        for k in 0..*n {
            let mut case = built_in::named(name).unwrap().unwrap();
            case.parameters.size_scale = s * (1.0 + 0.008 * (k as f64 - (*n as f64 - 1.0) / 2.0));
            let t1 = std::time::Instant::now();
            let c = convert(&case, &mut Nobody).unwrap();
            time += t1.elapsed().as_secs_f64();
            let st = Statistics::measure(Export::of(&c.mesh, &c.regions).measured(), &c.sizing).unwrap();
            let f = c.counts.formed as f64;
            let v = [
                st.quads as f64,
                100.0 * st.metric_angles.share_60_120,
                st.irregular.percent,
                st.lengths.mean,
                st.lengths.deviation,
                c.counts.rolled_back as f64 / f * 100.0,
                c.counts.seamed as f64,
                c.counts.right_replaced as f64 / f * 100.0,
                c.counts.rescued as f64 / f * 100.0,
                st.metric_angles.min,
                st.metric_angles.max,
                (c.finished.cleaned_up.refused) as f64 / f,
            ];
            for i in 0..12 {
                a[i] += v[i] / *n as f64
            }
            lo = lo.min(st.metric_angles.min);
            hi = hi.max(st.metric_angles.max);
        }
        println!(
            "{label:8} {:6.0} / {:5.2} / {:5.2} / {:.3}±{:.3}  ang {:3.0}-{:3.0} rb {:5.1}% seam {:4.0} right {:.1}% resc {:.1}% trials/q {:.2} {:.2}s",
            a[0], a[1], a[2], a[3], a[4], lo, hi, a[5], a[6], a[7], a[8], a[11], time
        );
    }
    eprintln!("{:?}", t0.elapsed());
}
