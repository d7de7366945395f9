//! The background on a noisy surface, relaxed where quadrilaterals would fold over it (docs/algorithm.md, "Noise").

use glam::DVec3;

use super::Converter;
use crate::core::case::{Case, Parameters};
use crate::core::discrete::relaxing::Ball;
use crate::core::fault::Fault;
use crate::core::mesh::Mesh;
use crate::core::prepare::{self, Background, Trial};
use crate::core::progress::{Stage, Watch};

/// How often the surface is relaxed.
const TRIALS: u64 = 6;
/// Larger backgrounds are not tried.
const MOST_TRIANGLES: usize = 500_000;
/// The surface is relaxed over so many times the size of what folds, times the number of the trial.
const AROUND: f64 = 1.5;

/// Converts the background of a noisy surface; where quadrilaterals fold, the surface is relaxed around them and the
/// background made anew, a few times. Returns the one on which the fewest fold.
///
/// # Errors
/// [`Fault::stopped`].
pub(super) fn relaxed(case: &Case, first: Background, watch: &mut dyn Watch) -> Result<Background, Fault> {
    // The surface belongs to the case, so that it does not depend on parameters that may change while a run is open.
    let parameters = case.parameters.with_rules_of(Parameters::default());
    let mut cancel = watch.cancel();
    let (mut best, mut fewest) = (None, usize::MAX);
    let mut balls: Vec<Ball> = Vec::new();
    let mut now = first;
    for trial in 0..=TRIALS {
        watch.tell(Stage::Divide, trial, TRIALS);
        let found = folds(&now, &parameters, &mut cancel);
        cancel.check()?;
        // What cannot be converted, or is too large to be tried, is left to the conversion itself.
        let found = found.unwrap_or_default();
        let count = found.len();
        balls.extend(found.into_iter().map(|ball| Ball { radius: AROUND * (trial + 1) as f64 * ball.radius, ..ball }));
        if count < fewest {
            (best, fewest) = (Some(now), count);
        }
        if count == 0 || trial == TRIALS {
            break;
        }
        let asked = Trial { relaxed: &balls, ..Trial::default() };
        match prepare::background_with(case, asked, &mut cancel) {
            Ok(next) => now = next,
            Err(fault) if fault.is_stop() => return Err(fault),
            Err(_) => break,
        }
    }
    best.ok_or_else(Fault::stopped)
}

/// The balls around the quadrilaterals that fold when a background is converted; `None` where it is not tried.
fn folds(background: &Background, parameters: &Parameters, watch: &mut dyn Watch) -> Option<Vec<Ball>> {
    if background.mesh.element_count() > MOST_TRIANGLES {
        return None;
    }
    let mut converter = Converter::new(background.mesh.clone(), &background.sizing, parameters.clone());
    converter.run_by_faces(watch).ok()?;
    Some(balls(&converter.mesh))
}

fn balls(mesh: &Mesh) -> Vec<Ball> {
    let ball = |corners: Vec<DVec3>| {
        let centre = corners.iter().sum::<DVec3>() / corners.len() as f64;
        Ball { centre, radius: corners.iter().map(|p| p.distance(centre)).fold(0.0, f64::max) }
    };
    mesh.folded().into_iter().map(|e| ball(mesh.corners(e).map(|n| mesh.xyz(n)).collect())).collect()
}
