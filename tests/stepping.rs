//! Promise: the converter is a machine of steps. Running is a loop over `step()`, stepping back is exact, and whatever
//! walk leads to a step, its state has the same bytes.
#![allow(clippy::unwrap_used)]

use quadfront::core::case::built_in;
use quadfront::core::convert::background;
use quadfront::core::convert::{Converter, Event, Phase};
use quadfront::core::progress::Nobody;

/// Calls `look` with a converter of a built-in case at a coarse size.
fn with_case(name: &str, size_scale: f64, look: impl FnOnce(Converter<'_>)) {
    let mut case = built_in::named(name).unwrap().unwrap();
    case.parameters.size_scale *= size_scale;
    let made = background(&case, &mut Nobody).unwrap();
    look(Converter::new(made.mesh.clone(), &made.sizing, case.parameters.clone()));
}

#[test]
fn running_is_a_loop_over_steps() {
    for name in ["example1", "crack", "two-faces", "gear"] {
        with_case(name, 2.0, |mut stepped| {
            let mut ran = stepped.clone();
            ran.run(&mut Nobody).unwrap();
            stepped.keep_history();
            while *stepped.phase() != Phase::Done {
                stepped.step().unwrap();
            }
            assert_eq!(ran.fingerprint(), stepped.fingerprint(), "{name}");
            assert!(ran.mesh.elements().all(|e| ran.mesh.is_quad(e)));
            ran.mesh.check().unwrap();
        });
    }
}

#[test]
fn faces_at_the_same_time_end_in_the_same_state_as_one_after_another() {
    for (name, size_scale) in
        [("example3", 1.6), ("example5", 1.5), ("example6", 2.0), ("branching", 1.0), ("sphere", 1.5)]
    {
        with_case(name, size_scale, |mut stepped| {
            let mut together = stepped.clone();
            together.run_by_faces(&mut Nobody).unwrap();
            stepped.keep_history();
            let mut faces = Vec::new();
            while *stepped.phase() != Phase::Done {
                if let Event::FaceConverted { region } = stepped.step().unwrap() {
                    faces.push(region);
                    // What was converted stays; what is to come has not begun.
                    let (done, to_come) = (region, region + 1);
                    assert!(stepped.mesh.elements_of(Some(done)).all(|e| stepped.mesh.is_quad(e)));
                    assert!(stepped.mesh.elements_of(Some(to_come)).all(|e| stepped.mesh.is_triangle(e)));
                }
            }
            assert_eq!(together.fingerprint(), stepped.fingerprint(), "{name}");
            assert_eq!((together.counts, together.finished), (stepped.counts, stepped.finished), "{name}");
            assert!(faces.is_sorted() && faces == stepped.mesh.faces(), "{name}: {faces:?}");
            stepped.mesh.check().unwrap();
        });
    }
}

#[test]
fn every_walk_of_steps_forward_and_back_meets_the_same_states() {
    for (name, size_scale) in
        [("example1", 2.0), ("polar-1", 2.0), ("repeated-line", 1.5), ("airfoil", 2.0), ("example5", 3.0)]
    {
        with_case(name, size_scale, |mut converter| {
            let mut rolled_back = 0;
            let mut states = vec![converter.fingerprint()];
            let mut events: Vec<Event> = Vec::new();
            converter.keep_history();
            while *converter.phase() != Phase::Done {
                let event = converter.step().unwrap();
                rolled_back += usize::from(matches!(event, Event::RolledBack { .. }));
                events.push(event);
                states.push(converter.fingerprint());
            }
            assert!(rolled_back > 0, "{name} shows that rollbacks are taken back too");
            for kind in ["swept", "cleaned"] {
                assert!(
                    events.iter().any(|event| event.kind().name() == kind),
                    "{name} shows that {kind} is taken back too"
                );
            }
            // A walk that turns around at every scale, from the end to the beginning and again to the end.
            let mut at = states.len() - 1;
            let mut random = 12_345_u64;
            let mut reached_the_start = false;
            while at < states.len() - 1 || !reached_the_start {
                random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let stretch = 1 + (random >> 33) as usize % 40;
                let back = (random >> 20) % 16 < if reached_the_start { 4 } else { 12 };
                for _ in 0..stretch {
                    if back {
                        if !converter.step_back() {
                            assert_eq!(at, 0);
                            reached_the_start = true;
                            break;
                        }
                        at -= 1;
                    } else if at + 1 < states.len() {
                        assert_eq!(converter.step().unwrap(), events[at], "{name}, step {at}");
                        at += 1;
                    }
                }
                assert_eq!(converter.fingerprint(), states[at], "{name}, step {at}");
            }
        });
    }
}

#[test]
fn the_structure_holds_after_every_formation() {
    with_case("example1", 1.5, |mut converter| {
        while *converter.phase() != Phase::Done {
            if let Event::Formed { .. } | Event::Seamed { .. } | Event::Closed { .. } = converter.step().unwrap() {
                converter.mesh.check().unwrap();
            }
        }
    });
}
