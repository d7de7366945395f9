//! What one conversion comes to.

use quadfront::core::case::Parameters;
use quadfront::core::convert::{Converter, Counts};
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
    let run = |parameters: Parameters| -> Result<_, String> {
        let mut converter = Converter::new(background.mesh.clone(), &background.sizing, parameters);
        converter.run(&mut Nobody).map_err(|fault| fault.to_string())?;
        Ok((measure(&converter.mesh, background)?, converter.counts, converter.last_resort.quads() as u64))
    };
    // Faces are post-processed one after another: no state has all of them as the front leaves them.
    let (before, ..) = run(Parameters { post_processing: false, ..parameters.clone() })?;
    let (mesh, counts, last_resort) = run(parameters.clone())?;
    Ok(Measured { mesh, before, counts, last_resort })
}

fn measure(mesh: &Mesh, background: &Background) -> Result<Statistics, String> {
    mesh.check().map_err(|what| format!("not valid: {what}"))?;
    let export = Export::of(mesh, &background.names);
    if !export.triangles.is_empty() {
        return Err(format!("{} triangles are left", export.triangles.len()));
    }
    Statistics::measure(export.measured(), &background.sizing).map_err(|bad| format!("{bad:?}"))
}
