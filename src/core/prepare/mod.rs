//! Prepares the background mesh of a case and its metric from `geometry`, `metric`, `discrete` and `background`.

mod graded;
mod layers;
mod need;
mod of_domain;
mod of_elements;
mod of_mesh;
mod spacing;
mod symmetric;
mod walls;

use of_domain::{FileLines, from_domain, shape_limits};
use of_elements::from_elements;
use of_mesh::from_mesh;
pub use spacing::{Forced, MirrorLine, NarrowGaps, Spacing};

use crate::core::background::Adapted;
use crate::core::case::{Case, DomainSource};
use crate::core::discrete::relaxing::Ball;
use crate::core::fault::{Fault, FaultKind};
use crate::core::geometry::{Domain, complex};
use crate::core::kernel::predicates::firm;
use crate::core::kernel::spelling::suggestion;
use crate::core::mesh::{Mesh, Names};
use crate::core::metric::Sizing;
use crate::core::progress::Watch;

/// The background triangle mesh of a case with its metric.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Background {
    /// The triangles, with the metric at every node.
    pub mesh: Mesh,
    /// The metric as a function of position.
    pub sizing: Sizing,
    /// The names of its faces and lines.
    pub names: Names,
    /// Counts of the adaptation; zero for a given mesh.
    pub adapted: Adapted,
    /// Repairs of a given mesh, and what of its file is not read, as readable phrases.
    pub repairs: Vec<String>,
    /// What the boundary makes of the sizes that are asked for.
    pub spacing: Spacing,
    /// The numbers of segments of the curves that close the half of a symmetric domain along its mirror line.
    pub mirror_line: Vec<u32>,
    /// Whether it lies on a noisy surface, which may be relaxed.
    pub is_noisy: bool,
}

impl Background {
    /// A mesh whose triangles are given.
    fn given(mesh: Mesh, sizing: Sizing, names: Names) -> Background {
        let (adapted, spacing) = (Adapted::default(), Spacing::default());
        let (repairs, mirror_line) = (Vec::new(), Vec::new());
        Background { mesh, sizing, names, adapted, repairs, spacing, mirror_line, is_noisy: false }
    }
}

/// What a conversion that was tried asks the background to be.
#[derive(Clone, Copy, Debug, Default)]
pub struct Trial<'a> {
    /// In a symmetric domain, so many segments more than their sizes ask for get the curves of
    /// [`Background::mirror_line`], in their order; negative: fewer.
    pub more: &'a [i32],
    /// Where the surface of a given mesh is relaxed.
    pub relaxed: &'a [Ball],
}

/// Makes the background mesh of a case.
///
/// # Errors
/// Faults of the case's geometry, metric or mesh.
pub fn background_with(case: &Case, trial: Trial<'_>, watch: &mut dyn Watch) -> Result<Background, Fault> {
    let has_curves = matches!(case.domain, DomainSource::Curves { .. } | DomainSource::Surfaces(_));
    if !has_curves && !case.parameters.layered_loops.is_empty() {
        return Err(Fault::new("layered_loops names curves, but the case has none")
            .of_kind(FaultKind::Parameter)
            .remedy("Remove it: layers then applies to every loop"));
    }
    if case.symmetry.is_some() && !matches!(case.domain, DomainSource::Curves { .. }) {
        return Err(Fault::new("symmetry is only for planar domains of curves")
            .of_kind(FaultKind::Parameter)
            .remedy("Remove symmetry, or give the domain as [[curve]] and [[face]] in the plane"));
    }
    let whole = |mut domain: Domain| {
        domain.limit_chords(&shape_limits(case), &|_| true);
        from_domain(case, domain, None, FileLines::default(), trial.more, watch)
    };
    let (made, kind) = match &case.domain {
        DomainSource::Curves { curves, faces } => {
            let domain = Domain::build_within(curves.clone(), faces.clone(), case.tolerance);
            (domain.and_then(|domain| domain.with_points(&case.points)).and_then(whole), FaultKind::Geometry)
        }
        DomainSource::Surfaces(spec) => (complex::build(spec).and_then(whole), FaultKind::Geometry),
        DomainSource::Elements { points, triangles, quads } => {
            (from_elements(case, points, triangles, quads), FaultKind::Mesh)
        }
        DomainSource::Mesh { source, taking } => {
            (from_mesh(case, source, taking, trial.relaxed, watch), FaultKind::Mesh)
        }
    };
    let sound = made.and_then(|made| refuse_needles(&made.mesh).map(|()| made));
    let mut made = sound.map_err(|fault| fault.of_kind(kind))?;
    made.repairs.splice(0..0, case.told.iter().cloned());
    watch.cancel().check()?;
    chosen_faces(made, &case.parameters.faces)
}

/// The background mesh of the named faces only, or of all without names. Curves are divided as for all faces.
fn chosen_faces(made: Background, names: &[String]) -> Result<Background, Fault> {
    if names.is_empty() {
        return Ok(made);
    }
    let mut regions = Vec::new();
    for name in names {
        let faces = || made.names.faces.iter().map(|face| &face.name);
        let own = faces().zip(0..).filter(|(face, _)| *face == name || is_part_of(face, name));
        let before = regions.len();
        regions.extend(own.map(|(_, number)| number));
        if regions.len() == before {
            let fault = Fault::new(format!("There is no face \"{}\"", name.escape_debug()));
            let fault = fault.of_kind(FaultKind::Parameter);
            let known = faces().map(String::as_str).collect::<Vec<_>>();
            return Err(fault.remedy(
                suggestion(name, known.iter().copied())
                    .unwrap_or_else(|| format!("The faces are {}", known.join(", "))),
            ));
        }
    }
    if let Some(symmetry) = made.mesh.symmetry() {
        // One of a face and its image is in the half.
        let images: Vec<u32> = regions.iter().map(|&region| symmetry.image_of(region)).collect();
        regions.extend(images);
    }
    let mesh = made.mesh.of_faces(&regions);
    Ok(Background { mesh, ..made })
}

/// Whether a face is a part of a region: "lid, part 2" of "lid".
fn is_part_of(face: &str, region: &str) -> bool {
    face.strip_prefix(region).is_some_and(|rest| rest.starts_with(", part "))
}

/// Rejects triangles so flat that rounding could invert the elements that the last resort makes of them.
fn refuse_needles(mesh: &Mesh) -> Result<(), Fault> {
    for e in mesh.elements().filter(|&e| mesh.is_triangle(e)) {
        let [a, b, c] = mesh.triangle(e).map(|n| mesh.uv(n));
        if !firm(a, b, c) {
            return Err(Fault::new(format!(
                "A triangle of the background mesh is too flat to be converted: {a}, {b}, {c}"
            ))
            .remedy("Widen the boundary there, or use shorter segments or less anisotropic sizes"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use glam::DVec2;

    use super::*;
    use crate::core::metric::MetricSource;
    use crate::core::progress::Nobody;

    /// Two adjacent squares; the left one has small sizes far from the common line.
    const TWO_SQUARES: &str = r#"
        version = 1
        gradation = 1.2
        [[metric]]
        kind = "formula"
        h1 = "0.01 + 0.5 * abs(x + 0.8)"
        [[curve]]
        name = "left"
        kind = "polyline"
        points = [[0, 1], [-1, 1], [-1, 0], [0, 0]]
        [[curve]]
        name = "between"
        kind = "segment"
        from = [0, 0]
        to = [0, 1]
        [[curve]]
        name = "right"
        kind = "polyline"
        points = [[0, 0], [1, 0], [1, 1], [0, 1]]
        [[face]]
        name = "one"
        outer = ["left", "between"]
        [[face]]
        name = "other"
        outer = ["right", "between"]
    "#;

    #[test]
    fn bounded_sizes_are_the_same_on_both_sides_of_a_curve_between_faces() {
        let case = Case::parse(TWO_SQUARES, "two", "two.toml", Path::new("")).unwrap();
        let made = background_with(&case, Trial::default(), &mut Nobody).unwrap();
        let size = |x: f64, y: f64| made.sizing.metric(DVec2::new(x, y)).unwrap().min_size();
        for k in 1..40 {
            let y = f64::from(k) / 40.0;
            let (one, other) = (size(-1e-9, y), size(1e-9, y));
            assert!((one / other - 1.0).abs() < 1e-6, "at y = {y}: {one} and {other}");
        }
    }
}
