#[path = "../benches/meter/mod.rs"]
mod meter;
use quadfront::core::convert::conversion::{Background, background};
use quadfront::core::convert::converter::Converter;
use quadfront::core::io::{built_in, export::Export, statistics::Statistics};
use quadfront::core::progress::{Nobody, Stage, Watch};
struct Lap {
    start: meter::Moment,
    front: Option<f64>,
}
impl Watch for Lap {
    fn tell(&mut self, s: Stage, _: u64, _: u64) {
        if s == Stage::Finish && self.front.is_none() {
            self.front = Some(meter::since(self.start))
        }
    }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    for (name, s) in [("uniform", 0.0633), ("example1", 0.0516)] {
        if a.len() > 1 && a[1] != "both" && a[1] != name {
            continue;
        }
        let mut case = built_in::named(name).unwrap().unwrap();
        case.parameters.size_scale = s;
        for kv in &a[2.min(a.len())..] {
            let (k, v) = kv.split_once('=').unwrap();
            case.parameters.set(k, v).unwrap();
        }
        let Background { mesh, sizing, regions, .. } = background(&case, &mut Nobody).unwrap();
        let mut c = Converter::new(mesh, &sizing, case.parameters.clone());
        let mut lap = Lap { start: meter::now(), front: None };
        c.run(&mut lap).unwrap();
        let t = meter::since(lap.start);
        let f = lap.front.unwrap();
        let n = c.mesh.element_count() as f64;
        let st = Statistics::measure(Export::of(&c.mesh, &regions).measured(), &sizing).unwrap();
        println!(
            "{name} {n} front {:.0}/s all {:.0}/s finish {:.1} us/q  irr {:.2}% 60-120 {:.2} len {:.3}±{:.3} ang {:.0}-{:.0}",
            n / f,
            n / t,
            (t - f) / n * 1e6,
            st.irregular.percent,
            100.0 * st.metric_angles.share_60_120,
            st.lengths.mean,
            st.lengths.deviation,
            st.metric_angles.min,
            st.metric_angles.max
        );
    }
}
