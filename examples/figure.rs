//! Draws a state of a conversion: quadrilaterals, the merging front in its classes, and the triangles that are left.
//!
//! ```text
//! cargo run --example figure [CASE] [QUADS] [SVG]
//! ```
//!
//! CASE is the name of a built-in case, `example1` where it is left out. The state is the one in which QUADS
//! quadrilaterals stand, 100 where it is left out. SVG is the file to write.

use std::path::PathBuf;

use quadfront::render::look::Look;
use quadfront::render::picture::{Picture, Seen};
use quadfront::render::vector::sheet::{self, Sheet};
use quadfront::render::vector::svg;
use quadfront::{Converter, Fault, FaultKind, Nobody, Phase, background, built_in};

fn main() -> Result<(), Fault> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "example1".to_owned());
    let quads = arguments.next().map_or(Ok(100), |quads| quads.parse());
    let quads: u64 = quads.map_err(|_| Fault::new("QUADS is not a whole number"))?;
    let path = arguments.next().map_or_else(|| std::env::temp_dir().join("quadfront-figure.svg"), PathBuf::from);
    let case = built_in::named(&name).ok_or_else(|| Fault::new(format!("There is no built-in case \"{name}\"")))??;

    let start = background(&case, &mut Nobody)?;
    let mut converter = Converter::new(start.mesh, &start.sizing, case.parameters.clone());
    while converter.standing() < quads && *converter.phase() != Phase::Done {
        converter.step()?;
    }

    let look = Look::default();
    let seen = Seen {
        mesh: &converter.mesh,
        parameters: converter.parameters(),
        phase: converter.phase(),
        // Elements to point out, such as those of the last step.
        changed: &[],
        // What the last step chose a side edge from, for the layer of that name.
        candidates: None,
    };
    let picture = Picture::of_state(&seen, &look);
    let sheet = Sheet::column(&case.title, "A state of the merging front", look);
    std::fs::write(&path, svg::write(&sheet::page(&picture, &sheet)))
        .map_err(|error| Fault::new(error.to_string()).of_kind(FaultKind::Io).at(path.display().to_string()))?;
    println!("step {}, {} quadrilaterals: {}", converter.counts.steps, converter.standing(), path.display());
    Ok(())
}
