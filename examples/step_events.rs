//! Converts a built-in case one operation at a time and prints what each of them did.
//!
//! ```text
//! cargo run --example step_events [CASE] [STEPS]
//! ```
//!
//! CASE is the name of a built-in case, `example1` where it is left out. STEPS is how many operations are printed, 30
//! where it is left out; the rest are counted by kind.

use std::collections::BTreeMap;

use quadfront::{Converter, Event, Fault, Nobody, Phase, background, built_in};

fn main() -> Result<(), Fault> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "example1".to_owned());
    let printed = arguments.next().map_or(Ok(30), |steps| steps.parse());
    let printed: u64 = printed.map_err(|_| Fault::new("STEPS is not a whole number"))?;
    let case = built_in::named(&name).ok_or_else(|| Fault::new(format!("There is no built-in case \"{name}\"")))??;

    // The triangles that the conversion starts from, and the metric.
    let start = background(&case, &mut Nobody)?;
    println!("{}: {} triangles", case.title, start.mesh.element_count());

    let mut converter = Converter::new(start.mesh, &start.sizing, case.parameters.clone());
    let mut rest: BTreeMap<&str, u64> = BTreeMap::new();
    while *converter.phase() != Phase::Done {
        let event = converter.step()?;
        let step = converter.counts.steps;
        if step > printed {
            *rest.entry(event.kind().name()).or_default() += 1;
            continue;
        }
        match event {
            Event::BaseSelected { a, b, class, .. } => {
                println!("step {step}: base segment from node {} to node {}, class {class}", a.0, b.0);
            }
            Event::Formed { .. } => println!("step {step}: quadrilateral {} formed", converter.counts.formed),
            other => println!("step {step}: {}", other.kind().name()),
        }
    }
    println!("the rest:");
    for (kind, count) in rest {
        println!("  {kind}: {count}");
    }
    println!("{} quadrilaterals", converter.mesh.element_count());
    Ok(())
}
