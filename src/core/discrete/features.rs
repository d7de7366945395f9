//! Feature edges: those that the mesh of quadrilaterals must keep (docs/algorithm.md, "Features"). An edge is one where
//! the surface ends (one triangle), where it branches (three or more), where its regions meet, where it is folded by
//! more than an angle, where its two triangles disagree on which side is outside, or where it lies on a line that the
//! file has a group for.

use super::creases::creases;
use super::edges::{Edge, Edges, Triangles};
use super::noise::Noise;
use crate::core::fault::Fault;
use crate::core::progress::Cancel;

/// Kind of a feature edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    /// One triangle: the border of the surface.
    Boundary,
    /// Three or more triangles: the surface branches.
    Branching,
    /// Two triangles of opposite orientation.
    Conflict,
    /// Between two regions.
    Region,
    /// Folded by more than the feature angle.
    Fold,
    /// On a line of the file.
    Line,
}

/// The folds that are features where nothing else is said (docs/algorithm.md, "Features").
pub const ANGLE: f64 = 40.0 / 180.0 * std::f64::consts::PI;

/// The kind of feature of each edge by the shape alone, `None` for edges that are no features; `angle` is the feature
/// angle between normals, in radians (0 for a plane surface). In noisy pieces folds are those of smoothed normals.
pub fn features(mesh: &Triangles, edges: &Edges, angle: f64) -> Vec<Option<Feature>> {
    features_and_noise(mesh, edges, angle, &Cancel::default()).unwrap_or_default().0
}

/// The features of a surface, and its noise if it has any.
///
/// # Errors
/// [`Fault::stopped`].
pub fn features_and_noise(
    mesh: &Triangles,
    edges: &Edges,
    angle: f64,
    cancel: &Cancel,
) -> Result<(Vec<Option<Feature>>, Option<Noise>), Fault> {
    let found = features_beside(mesh, edges, angle, None);
    cancel.check()?;
    // Noise that folds no edge changes no feature.
    let noise = if found.contains(&Some(Feature::Fold)) { Noise::of(mesh, edges, cancel)? } else { None };
    let found = if noise.is_some() { features_beside(mesh, edges, angle, noise.as_ref()) } else { found };
    Ok((found, noise))
}

/// The features of a surface with noise that is known.
pub fn features_beside(mesh: &Triangles, edges: &Edges, angle: f64, noise: Option<&Noise>) -> Vec<Option<Feature>> {
    let least_cosine = libm::cos(angle);
    let mut found: Vec<_> = (0..edges.len()).map(|edge| feature(mesh, edges.get(edge), least_cosine)).collect();
    if let Some(noise) = noise {
        let kept: Vec<bool> = found.iter().map(|kind| kind.is_some_and(|kind| kind != Feature::Fold)).collect();
        let creases = creases(mesh, edges, noise, angle, &kept);
        for (e, kind) in found.iter_mut().enumerate().filter(|(e, _)| !kept[*e] && noise.is_inside(edges.get(*e))) {
            *kind = creases[e].then_some(Feature::Fold);
        }
    }
    found
}

/// The number of edges that are folded by more than the feature angle and no features: noise.
pub fn noisy_folds(mesh: &Triangles, edges: &Edges, angle: f64, found: &[Option<Feature>]) -> usize {
    let least_cosine = libm::cos(angle);
    let others = (0..edges.len()).filter(|&edge| found[edge].is_none());
    others.filter(|&edge| feature(mesh, edges.get(edge), least_cosine).is_some()).count()
}

/// Adds the edges on lines of the file.
pub fn with_lines(mut features: Vec<Option<Feature>>, mesh: &Triangles, edges: &Edges) -> Vec<Option<Feature>> {
    for edge in mesh.lines.iter().filter_map(|(ends, _)| edges.between(*ends)) {
        features[edge].get_or_insert(Feature::Line);
    }
    features
}

fn feature(mesh: &Triangles, edge: Edge, least_cosine: f64) -> Option<Feature> {
    let [a, b] = match *edge.sides {
        [_] => return Some(Feature::Boundary),
        [a, b] => [a, b],
        _ => return Some(Feature::Branching),
    };
    if mesh.side(a) == mesh.side(b) {
        return Some(Feature::Conflict);
    }
    let [one, other] = [a, b].map(|corner| corner as usize / 3);
    if mesh.region[one] != mesh.region[other] {
        return Some(Feature::Region);
    }
    let (n, m) = (mesh.area_vector(one), mesh.area_vector(other));
    // A degenerate triangle has no normal, so it is not a fold.
    (n.dot(m) < least_cosine * n.length() * m.length()).then_some(Feature::Fold)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::fixtures::{cube, three_half_planes};

    /// The kinds of all feature edges.
    fn found(mesh: &Triangles, angle: f64) -> Vec<Feature> {
        features(mesh, &Edges::of(&mesh.triangles), angle).into_iter().flatten().collect()
    }

    #[test]
    fn a_cube_has_its_twelve_edges_and_no_diagonals() {
        assert_eq!(found(&cube(2), ANGLE), [Feature::Fold; 24]);
        assert_eq!(found(&cube(2), 1.7), []);
    }

    #[test]
    fn branching_and_boundary_edges_of_half_planes_are_distinguished() {
        let found = found(&three_half_planes(), ANGLE);
        let count = |kind| found.iter().filter(|f| **f == kind).count();
        assert_eq!((count(Feature::Branching), count(Feature::Boundary)), (1, 9));
    }

    #[test]
    fn region_borders_and_orientation_conflicts_are_features() {
        let mut mesh = cube(1);
        mesh.region[0] = 1;
        let count = |mesh: &Triangles, kind| found(mesh, 3.2).into_iter().filter(|f| *f == kind).count();
        assert_eq!(count(&mesh, Feature::Region), 3);
        mesh.region[0] = 0;
        mesh.triangles[0].swap(0, 1);
        assert_eq!(count(&mesh, Feature::Conflict), 3);
    }
}
