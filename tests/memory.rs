//! Promise: what a conversion needs is estimated before memory is spent on it; where there is less it is refused, with
//! the figure and a size scale that fits.
#![allow(clippy::unwrap_used)]

use quadfront::core::case::{Parameters, built_in};
use quadfront::core::convert::conversion::convert;
use quadfront::core::fault::{Fault, FaultKind};
use quadfront::core::progress::{Need, Stage, Watch};
use quadfront::core::record::Export;

/// Notes what is needed, and allows it or not.
struct Keeper {
    needs: Vec<Need>,
    stages: Vec<Stage>,
    allows: bool,
}

impl Keeper {
    fn new(allows: bool) -> Keeper {
        Keeper { needs: Vec::new(), stages: Vec::new(), allows }
    }
}

impl Watch for Keeper {
    fn tell(&mut self, stage: Stage, _: u64, _: u64) {
        self.stages.push(stage);
    }

    fn allow(&mut self, need: &Need) -> Result<(), Fault> {
        self.needs.push(*need);
        if self.allows { Ok(()) } else { Err(Fault::new("not here")) }
    }
}

#[test]
fn about_as_many_quadrilaterals_come_as_were_estimated() {
    for (name, _) in built_in::CASES {
        let case = built_in::named(name).unwrap().unwrap();
        let mut keeper = Keeper::new(true);
        let converted = convert(&case, &mut keeper).unwrap();
        let quads = Export::of(&converted.mesh, &converted.names).quads.len() as f64;
        let need = keeper.needs.last().unwrap();
        assert!((0.6..1.6).contains(&(need.quads / quads)), "{name}: {} and {quads}", need.quads);
        assert_eq!(need.size_scale, Some(case.parameters.size_scale), "{name}");
    }
}

#[test]
fn what_a_watch_does_not_allow_is_not_begun() {
    let mut case = built_in::named("uniform").unwrap().unwrap();
    case.parameters = Parameters { size_scale: 0.02, ..case.parameters };
    let mut keeper = Keeper::new(false);
    let refused = Fault::new("not here").of_kind(FaultKind::Limit);
    assert_eq!(convert(&case, &mut keeper).unwrap_err(), refused);
    assert!(!keeper.stages.contains(&Stage::Adapt));
    let [need] = keeper.needs[..] else { panic!("{:?}", keeper.needs) };
    assert!((need.quads / 1e6 - 1.0).abs() < 0.01, "{need:?}");
    // The scale that fits is the least of three digits.
    let bytes = need.bytes(false);
    let scale = need.size_scale_within(bytes / 4.0, false).unwrap();
    let of = |scale: f64| Need::of(need.quads * (0.02 / scale) * (0.02 / scale), Some(scale));
    assert!(of(scale).bytes(false) <= bytes / 4.0 && of(scale - 1e-4).bytes(false) > bytes / 4.0, "{scale}");
    assert_eq!(need.size_scale_within(1e6, false), None);
}

#[cfg(all(feature = "cli", target_os = "linux"))]
#[test]
fn under_a_limit_of_address_space_a_giant_is_refused_and_the_scale_that_is_named_fits() {
    let convert = |scale: &str| {
        let program = env!("CARGO_BIN_EXE_quadfront");
        let line = format!("ulimit -v 450000; exec '{program}' convert uniform --set size_scale={scale} -q");
        let output = std::process::Command::new("sh").args(["-c", &line]).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, said) = convert("0.005");
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("16\u{2009}000\u{2009}000 quadrilaterals") && said.contains("ulimit -v"), "{said}");
    assert!(said.contains("19 GB of memory") && said.lines().count() == 1, "{said}");
    let scale = said.split("size_scale = ").nth(1).unwrap().split_whitespace().next().unwrap();
    assert!((0.02..0.2).contains(&scale.parse::<f64>().unwrap()), "{said}");
    assert_eq!(convert(scale), (Some(0), String::new()));
}
