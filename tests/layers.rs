//! Promise: boundary offsetting (paper 4.3.3) makes its rows before anything else, on all loops or on those that are
//! named.
#![allow(clippy::unwrap_used)]

use glam::DVec2;
use quadfront::core::case::built_in;
use quadfront::core::convert::background;
use quadfront::core::convert::conversion::convert;
use quadfront::core::convert::{Converter, Event, Phase};
use quadfront::core::fault::Fault;
use quadfront::core::front::segment::front_level;
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::soup::Allow;
use quadfront::core::soup::soundness::examine;

/// A base segment that was selected: its level, its middle, and the least level that could have been.
struct Selected {
    level: u16,
    middle: DVec2,
    least: u16,
}

/// All selections of example 1 until its first pass ends.
fn selections(set: &[(&str, &str)]) -> Result<Vec<Selected>, Fault> {
    let mut case = built_in::named("example1").unwrap().unwrap();
    for (key, value) in set {
        case.parameters.set(key, value)?;
    }
    let made = background(&case, &mut Nobody)?;
    let mut converter = Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone());
    let mut selected = Vec::new();
    loop {
        let event = converter.step()?;
        let mesh = &converter.mesh;
        match event {
            Event::BaseSelected { a, b, level, .. } => {
                let waiting = mesh.front().filter(|&h| !mesh.is_deferred(h)).map(|h| front_level(mesh, h));
                let middle = mesh.uv(a).midpoint(mesh.uv(b));
                selected.push(Selected { level, middle, least: waiting.min().unwrap() });
            }
            Event::SecondPass => return Ok(selected),
            _ if *converter.phase() == Phase::Done => return Ok(selected),
            _ => {}
        }
    }
}

/// How far a place is from the middle of the hole, which has radius 0.2.
fn from_hole(selected: &Selected) -> f64 {
    selected.middle.distance(DVec2::splat(0.5))
}

#[test]
fn with_two_layers_no_quadrilateral_of_level_2_begins_while_a_lower_level_can_be_selected() {
    for selection in ["table1", "shortest", "smallest_angle", "level"] {
        let all = selections(&[("layers", "2"), ("selection", selection)]).unwrap();
        assert!(all.iter().all(|s| s.level < 2 || s.least >= 2), "{selection}");
        assert!((0..4).all(|level| all.iter().any(|s| s.level == level)), "{selection} comes to every level");
    }
    let free = selections(&[]).unwrap();
    assert!(free.iter().any(|s| s.level >= 2 && s.least < 2), "nothing holds it back without layers");
}

#[test]
fn only_the_loops_that_are_named_get_layers() {
    let all = selections(&[("layers", "2"), ("layered_loops", "hole")]).unwrap();
    let first: Vec<_> = all.iter().take_while(|s| s.level < 2).collect();
    let farthest = first.iter().map(|s| from_hole(s)).fold(0.0, f64::max);
    assert!(first.len() > 20 && farthest < 0.4, "{} rows up to {farthest}", first.len());
    assert!(all.iter().all(|s| s.level < 2 || s.least >= 2));
    // The frame begins where the rows around the hole end.
    assert!(all.iter().any(|s| s.level == 2 && s.middle.min_element() < 1e-9));
    let frame = selections(&[("layers", "2"), ("layered_loops", "frame")]).unwrap();
    assert!(frame[0].middle.min_element() < 1e-9 || frame[0].middle.max_element() > 1.0 - 1e-9);
}

#[test]
fn a_curve_that_is_not_there_is_refused() {
    let fault = selections(&[("layers", "1"), ("layered_loops", "hole, fame")]).err().unwrap().to_string();
    assert!(fault.contains("\"fame\"") && fault.contains("The nearest name is \"frame\""), "{fault}");
    let mut case = built_in::named("figure-5").unwrap().unwrap();
    case.parameters.set("layered_loops", "hole").unwrap();
    let fault = background(&case, &mut Nobody).unwrap_err().to_string();
    assert!(fault.contains("the case has none"), "{fault}");
}

#[test]
fn example_3_converts_with_layers_about_its_openings_and_without() {
    for layers in ["0", "2"] {
        let mut case = built_in::named("example3").unwrap().unwrap();
        case.parameters.set("layers", layers).unwrap();
        case.parameters.set("layered_loops", "round,oval,slot").unwrap();
        let done = convert(&case, &mut Nobody).unwrap();
        let sides = done.mesh.elements().flat_map(|e| done.mesh.half_edges(e));
        let lengths: Vec<f64> = sides.map(|h| done.mesh.length(h)).collect();
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        assert!((0.95..1.05).contains(&mean), "{layers}: {mean}");
        let file = Export::of(&done.mesh, &done.names).file;
        assert!(file.triangles.is_empty() && done.mesh.folded().is_empty());
        examine(&file).verdict(Allow::default()).unwrap();
    }
}
