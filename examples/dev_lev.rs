use quadfront::core::convert::conversion::{Background, background};
use quadfront::core::convert::converter::Converter;
use quadfront::core::convert::event::Event;
use quadfront::core::io::built_in;
use quadfront::core::progress::Nobody;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut case = built_in::named(&a[1]).unwrap().unwrap();
    case.parameters.size_scale = a[2].parse().unwrap();
    let Background { mesh, sizing, .. } = background(&case, &mut Nobody).unwrap();
    let mut c = Converter::new(mesh, &sizing, case.parameters.clone());
    let mut base: Vec<Vec<f64>> = vec![];
    let mut h: Vec<Vec<f64>> = vec![];
    let mut seams = 0;
    loop {
        let e = c.step().unwrap();
        match e {
            Event::BaseSelected { length_metric, level, .. } => {
                let l = level as usize;
                while base.len() <= l {
                    base.push(vec![]);
                    h.push(vec![])
                }
                base[l].push(length_metric)
            }
            Event::Formed { nodes: [a, b, d, cc], level, .. } => {
                let l = level as usize;
                h[l].push(c.mesh.distance(a, cc));
                h[l].push(c.mesh.distance(b, d));
            }
            Event::Seamed { .. } => seams += 1,
            Event::PostProcessed | Event::Finished => break,
            _ => {}
        }
    }
    println!("seams {seams}");
    let mean = |v: &Vec<f64>| v.iter().sum::<f64>() / v.len().max(1) as f64;
    let sd = |v: &Vec<f64>| {
        let m = mean(v);
        (v.iter().map(|x| (x - m) * (x - m)).sum::<f64>() / v.len().max(1) as f64).sqrt()
    };
    for l in (0..base.len()).step_by(1.max(base.len() / 30)) {
        println!(
            "level {l} n {} base {:.3}±{:.3} side {:.3}±{:.3}",
            base[l].len(),
            mean(&base[l]),
            sd(&base[l]),
            mean(&h[l]),
            sd(&h[l])
        );
    }
}
