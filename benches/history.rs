//! Timing of a run's history, on one thread: the targets are 2 ms for a step of one quadrilateral forward or back at
//! 10,000, and for a leap anywhere 16 ms at 10,000 and 100 ms at 100,000 quadrilaterals; 512 MiB for what is kept.
#![allow(clippy::unwrap_used)]

use glam::DVec2;
use quadfront::core::case::{Parameters, built_in};
use quadfront::core::convert::Converter;
use quadfront::core::kernel::Metric2;
use quadfront::core::mesh::{Mesh, PointId, TriangleSet};
use quadfront::core::metric::{Field, FieldSpec, Sizing};
use quadfront::core::progress::Nobody;
use quadfront::core::run::history::BUDGET;
use quadfront::core::run::{FrontTable, History, Run, Selecting};

mod meter;

/// Largest, and larger than 95 and 50 of a hundred, in milliseconds.
fn spread(mut seconds: Vec<f64>) -> [f64; 3] {
    seconds.sort_by(f64::total_cmp);
    let at = |share: f64| 1e3 * seconds[(share * (seconds.len() - 1) as f64) as usize];
    [at(1.0), at(0.95), at(0.5)]
}

fn told([most, high, middle]: [f64; 3]) -> String {
    format!("{most:7.2} {high:7.2} {middle:7.2}")
}

fn timed(work: impl FnOnce()) -> f64 {
    let start = meter::now();
    work();
    meter::since(start)
}

fn go(history: &mut History, step: u64) {
    assert_eq!(history.seek(step).unwrap(), step);
}

fn main() {
    front_table();
    println!("History, {}: largest, 95th of a hundred and median, in milliseconds", meter::clock());
    println!(
        "case          quads    steps  ahead: s  front: s  one quad forward         one quad back            \
         leap                     MiB"
    );
    for (name, scale) in [("uniform", 0.2), ("example1", 0.163), ("uniform", 0.0633), ("example1", 0.0516)] {
        let mut run = Run::of(built_in::named(name).unwrap().unwrap());
        run.parameters.size_scale = scale;
        let background = run.background(&mut Nobody).unwrap();
        let mut converter = run.start(&background).unwrap();
        let plain = timed(|| converter.run(&mut Nobody).unwrap());
        drop(converter);
        let mut history = History::of(run, &background, BUDGET).unwrap();
        let ahead = timed(|| history.extend(u64::MAX));
        let end = history.end().unwrap();
        let mut random = 1_u64;
        let mut any = move || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) % end
        };
        let (mut forward, mut back, mut leap) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..40 {
            let step = any();
            leap.push(timed(|| go(&mut history, step)));
            for _ in 0..40 {
                let (nq, step) = (history.log().nq(history.step()), history.step());
                let Some(next) = history.log().first_with(nq + 1, step) else { continue };
                forward.push(timed(|| go(&mut history, next)));
            }
            for _ in 0..100 {
                let step = history.step();
                let Some(nq) = history.log().nq(step).checked_sub(1) else { continue };
                let Some(next) = history.log().first_with(nq, 0).filter(|&next| next < step) else { continue };
                back.push(timed(|| go(&mut history, next)));
            }
        }
        println!(
            "{name:10} {:8} {end:8} {ahead:9.3} {plain:9.3}  {}  {}  {}  {:.0}",
            history.log().nq(end),
            told(spread(forward)),
            told(spread(back)),
            told(spread(leap)),
            history.memory() as f64 / f64::from(1 << 20)
        );
    }
}

/// The table of a front of 100,000 segments: triangles that lie apart.
fn front_table() {
    let count = 33_334_u32;
    let corner = |k: u32| DVec2::new(f64::from(k / 3 % 200) * 2.0, f64::from(k / 600) * 2.0);
    let set = TriangleSet {
        uv: (0..3 * count).map(|k| corner(k) + [DVec2::ZERO, DVec2::X, DVec2::Y][k as usize % 3]).collect(),
        point: (0..3 * count).map(PointId).collect(),
        triangles: (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        region: vec![0; count as usize],
        ..TriangleSet::default()
    };
    let mesh = Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); 3 * count as usize]);
    let field = Field::compile(&FieldSpec::Uniform { h: 1.0 }, &|_| None).unwrap();
    let converter = Converter::new(mesh, Sizing::new(vec![field], 1.0), Parameters::default());
    let (table, seconds) = meter::median_of(5, || FrontTable::of(&converter));
    let row = *table.choice().unwrap();
    let selecting = Selecting::next(&converter).unwrap();
    let (_, told) = meter::median_of(5, || selecting.explain(&converter, row.a, row.b).unwrap());
    println!(
        "Front table of {} rows: {:.1} ms; one segment explained in it: {:.1} ms",
        table.rows.len(),
        1e3 * seconds,
        1e3 * told
    );
}
