//! The background of a case. On a noisy surface it depends on where quadrilaterals would fold ([`noisy_surface`]). In a
//! symmetric domain it depends on how finely the mirror line is divided, which is free:
//! a few numbers of segments are tried (docs/algorithm.md, "Symmetry").

use std::f64::consts::SQRT_2;

use super::{Converter, noisy_surface};
use crate::core::case::{Case, Parameters};
use crate::core::fault::Fault;
use crate::core::prepare::{self, Background, MirrorLine, Trial};
use crate::core::progress::{Stage, Watch};

/// Halves of more triangles are not tried.
const MOST_TRIANGLES: usize = 20_000;
/// Segments more that are tried on each part of the line. The numbers stay odd or even, so that loops stay even.
const CHANGES: [i32; 2] = [2, -2];

/// Elements may become so many times more or fewer.
const MOST_MORE: f64 = 1.1;

/// Makes the background mesh of a case. The parts of the mirror line of a symmetric domain get, one after the other,
/// two segments more or fewer than their sizes ask for, if the mesh then has fewer irregular nodes, and about as many
/// elements.
///
/// # Errors
/// Faults of the case's geometry, metric or mesh.
pub fn background(case: &Case, watch: &mut dyn Watch) -> Result<Background, Fault> {
    let mut best = prepare::background_with(case, Trial::default(), watch)?;
    if best.is_noisy {
        return noisy_surface::relaxed(case, best, watch);
    }
    let by_sizes = best.mirror_line.clone();
    if by_sizes.is_empty() || best.mesh.element_count() > MOST_TRIANGLES {
        return Ok(best);
    }
    let mut cancel = watch.cancel();
    // The line belongs to the case, so that it does not depend on parameters that may change while a run is open.
    let parameters = case.parameters.with_rules_of(Parameters::default());
    let Some(first) = Outcome::of(&best, &parameters, &mut cancel) else { return Ok(best) };
    let (mut least, mut more) = (first.irregular, vec![0; by_sizes.len()]);
    let parts = by_sizes.len() as u64;
    for (part, &number) in by_sizes.iter().enumerate() {
        watch.tell(Stage::Divide, part as u64, parts);
        for change in CHANGES.into_iter().filter(|&change| is_near(number, change)) {
            let mut tried = more.clone();
            tried[part] = change;
            let trial = Trial { more: &tried, ..Trial::default() };
            let Ok(other) = prepare::background_with(case, trial, &mut cancel) else { continue };
            let Some(found) = Outcome::of(&other, &parameters, &mut cancel) else { continue };
            if found.irregular < least && is_within(MOST_MORE, found.quads as f64 / first.quads as f64) {
                (best, least, more) = (other, found.irregular, tried);
            }
        }
    }
    watch.cancel().check()?;
    if best.mirror_line != by_sizes {
        best.spacing.mirror_line = Some(MirrorLine { segments: best.mirror_line.clone(), by_sizes });
    }
    Ok(best)
}

/// Whether segments keep their length within a factor of the square root of 2 if their number changes.
fn is_near(number: u32, change: i32) -> bool {
    is_within(SQRT_2, f64::from(number.saturating_add_signed(change)) / f64::from(number))
}

fn is_within(factor: f64, ratio: f64) -> bool {
    (1.0 / factor..=factor).contains(&ratio)
}

/// The mesh that a background becomes.
struct Outcome {
    /// Its irregular nodes inside.
    irregular: usize,
    quads: usize,
}

impl Outcome {
    /// `None` where the conversion fails.
    fn of(background: &Background, parameters: &Parameters, watch: &mut dyn Watch) -> Option<Outcome> {
        let mut converter = Converter::new(background.mesh.clone(), &background.sizing, parameters.clone());
        converter.run_by_faces(watch).ok()?;
        let mesh = &converter.mesh;
        let irregular = mesh.nodes().filter(|&node| !mesh.is_fixed(node) && mesh.valence(node) != 4).count();
        Some(Outcome { irregular, quads: mesh.element_count() })
    }
}
