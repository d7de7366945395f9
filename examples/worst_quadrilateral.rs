//! Converts a built-in case and tells which step cost the worst quadrilateral of the result most quality.
//!
//! ```text
//! cargo run --example worst_quadrilateral [CASE]
//! ```
//!
//! CASE is the name of a built-in case, `example1` where it is left out.

use quadfront::{Converter, Event, Fault, Nobody, Phase, background, built_in};

fn main() -> Result<(), Fault> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "example1".to_owned());
    let case = built_in::named(&name).ok_or_else(|| Fault::new(format!("There is no built-in case \"{name}\"")))??;
    let start = background(&case, &mut Nobody)?;
    let begin = || Converter::new(start.mesh.clone(), &start.sizing, case.parameters.clone());

    // Which quadrilateral is the worst one.
    let mut converter = begin();
    while *converter.phase() != Phase::Done {
        converter.step()?;
    }
    let mesh = &converter.mesh;
    let quads = mesh.elements().filter(|e| mesh.is_quad(*e));
    let Some(worst) = quads.min_by(|a, b| mesh.quality(*a).total_cmp(&mesh.quality(*b))) else {
        println!("no quadrilateral");
        return Ok(());
    };
    println!("element {}: quality {:.3}", worst.0, mesh.quality(worst));

    // The same run again: every step that lowered its quality, since it last became a quadrilateral.
    let mut converter = begin();
    let mut quality = None;
    let mut losses: Vec<(u64, f64, Event)> = Vec::new();
    while *converter.phase() != Phase::Done {
        let event = converter.step()?;
        let mesh = &converter.mesh;
        let now = (mesh.has_element(worst) && mesh.is_quad(worst)).then(|| mesh.quality(worst));
        if quality.is_none() {
            losses.clear();
        }
        let lost = now.map_or(0.0, |now| quality.unwrap_or(1.0) - now);
        if lost > 0.0 {
            losses.push((converter.counts.steps, lost, event));
        }
        quality = now;
    }
    for (step, lost, event) in &losses {
        println!("  step {step}: {}, -{lost:.3}", event.kind().name());
    }
    let costs_less = |a: &&(u64, f64, Event), b: &&(u64, f64, Event)| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0));
    if let Some((step, ..)) = losses.iter().max_by(costs_less) {
        println!("most: step {step}");
    }
    Ok(())
}
