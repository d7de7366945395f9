//! What one conversion comes to.

use quadfront::core::case::Parameters;
use quadfront::core::convert::{Converter, Counts, Phase};
use quadfront::core::mesh::Mesh;
use quadfront::core::prepare::Background;
use quadfront::core::progress::Nobody;
use quadfront::core::record::{Export, Statistics};

/// A converted mesh, measured; what went wrong instead where something did.
pub type Outcome = Result<Measured, String>;

/// What a conversion made.
pub struct Measured {
    pub mesh: Statistics,
    /// What the mesh was like before the post-processing of the whole of it.
    pub before: Statistics,
    /// How often what happened on the front.
    pub counts: Counts,
    /// Quadrilaterals of the last resort.
    pub last_resort: u64,
}

impl Measured {
    /// Quadrilaterals that were made, by whatever means, before clean-up.
    pub fn made(&self) -> u64 {
        self.counts.formed + self.counts.closed + self.last_resort
    }
}

/// Converts a background, checks the mesh and measures it as the front leaves it and at the end.
pub fn convert(background: &Background, parameters: &Parameters) -> Outcome {
    let mut converter = Converter::new(background.mesh.clone(), &background.sizing, parameters.clone());
    while !matches!(converter.phase(), Phase::PostProcess { .. } | Phase::Done) {
        converter.step().map_err(|fault| fault.to_string())?;
    }
    let before = measure(&converter.mesh, background)?;
    converter.run(&mut Nobody).map_err(|fault| fault.to_string())?;
    let mesh = measure(&converter.mesh, background)?;
    Ok(Measured { mesh, before, counts: converter.counts, last_resort: converter.last_resort.quads() as u64 })
}

fn measure(mesh: &Mesh, background: &Background) -> Result<Statistics, String> {
    mesh.check().map_err(|what| format!("not valid: {what}"))?;
    let export = Export::of(mesh, &background.names);
    if !export.triangles.is_empty() {
        return Err(format!("{} triangles are left", export.triangles.len()));
    }
    Statistics::measure(export.measured(), &background.sizing).map_err(|bad| format!("{bad:?}"))
}
