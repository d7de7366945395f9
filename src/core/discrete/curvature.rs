//! The curvature of a surface of triangles, as sizes at its points: each edge that is no feature contributes its
//! dihedral angle times its direction; the sum over a neighbourhood, divided by its area, is the curvature tensor
//! (Cohen-Steiner & Morvan 2003).

use glam::DVec3;

use super::edges::{Edge, Edges, Triangles};
use super::features::features_beside;
use super::noise::Noise;
use crate::core::fault::Fault;
use crate::core::geometry::Bend;
use crate::core::kernel::Metric3;
use crate::core::metric::Curvature;

/// A symmetric tensor: xx, xy, xz, yy, yz, zz.
type Sum = [f64; 6];

/// Sizes by curvature at the points of a surface (as the field of kind "curvature"); folds beyond `angle` (radians) do
/// not count, nor does noise.
///
/// # Errors
/// A chord or sizes that are not positive.
pub fn curvature_sizes(
    mesh: &Triangles,
    angle: f64,
    noise: Option<&Noise>,
    [chord, least, far]: [f64; 3],
) -> Result<Vec<Metric3>, Fault> {
    let by = Curvature::new(chord, least, far)?;
    Ok(bends(mesh, angle, noise).iter().map(|bend| by.metric(bend.as_ref())).collect())
}

/// The curvature at each point; `None` without a triangle of positive area.
fn bends(mesh: &Triangles, angle: f64, noise: Option<&Noise>) -> Vec<Option<Bend>> {
    let edges = Edges::of(&mesh.triangles);
    let features = features_beside(mesh, &edges, angle, noise);
    let n = mesh.points.len();
    let mut own: Vec<(Sum, f64)> = vec![([0.0; 6], 0.0); n];
    let mut normal = vec![DVec3::ZERO; n];
    for t in 0..mesh.triangles.len() {
        let area = mesh.area_vector(t);
        for node in mesh.triangles[t] {
            own[node as usize].1 += area.length() / 6.0;
            normal[node as usize] += area;
        }
    }
    let smooth: Vec<Edge<'_>> = (0..edges.len()).filter(|&e| features[e].is_none()).map(|e| edges.get(e)).collect();
    for Edge { ends, sides } in &smooth {
        let &[one, other] = *sides else { continue };
        let [a, b] = mesh.side(one).map(|k| mesh.points[k as usize]);
        let along = b - a;
        let long = along.length();
        let normal = |t: usize| noise.map_or_else(|| mesh.area_vector(t), |noise| noise.normal[t]);
        let [n, m] = [one, other].map(|side| normal(side as usize / 3));
        let turn = libm::atan2(n.cross(m).dot(along) / long.max(f64::MIN_POSITIVE), n.dot(m));
        // Half of the edge belongs to each end.
        let weight = 0.5 * turn / long.max(f64::MIN_POSITIVE);
        let d = along;
        let tensor = [d.x * d.x, d.x * d.y, d.x * d.z, d.y * d.y, d.y * d.z, d.z * d.z];
        for end in ends {
            own[*end as usize].0.iter_mut().zip(tensor).for_each(|(sum, part)| *sum += weight * part);
        }
    }
    // Sum over the neighbours too: the few edges of one ring are noisy.
    let mut wide = own.clone();
    for Edge { ends: [a, b], .. } in &smooth {
        for (to, from) in [(*a, *b), (*b, *a)] {
            let (sum, area) = &mut wide[to as usize];
            sum.iter_mut().zip(own[from as usize].0).for_each(|(sum, part)| *sum += part);
            *area += own[from as usize].1;
        }
    }
    wide.iter().zip(&normal).map(|((sum, area), normal)| bend(sum, *area, *normal)).collect()
}

/// The tensor of a neighbourhood as curvatures in its tangent plane. A surface bends across an edge, not along it, so
/// the principal directions are swapped.
fn bend(sum: &Sum, area: f64, normal: DVec3) -> Option<Bend> {
    let normal = normal.try_normalize()?;
    if area <= 0.0 {
        return None;
    }
    let s = normal.any_orthonormal_vector();
    let t = normal.cross(s);
    let by = |p: DVec3, q: DVec3| {
        let [xx, xy, xz, yy, yz, zz] = *sum;
        let applied =
            DVec3::new(xx * q.x + xy * q.y + xz * q.z, xy * q.x + yy * q.y + yz * q.z, xz * q.x + yz * q.y + zz * q.z);
        p.dot(applied) / area
    };
    let (a, b, c) = (by(s, s), by(s, t), by(t, t));
    let angle = 0.5 * libm::atan2(2.0 * b, a - c);
    let [cos, sin] = [libm::cos(angle), libm::sin(angle)];
    let (axis, across) = (s * cos + t * sin, t * cos - s * sin);
    let middle = 0.5 * (a + c);
    let half = (0.25 * (a - c) * (a - c) + b * b).sqrt();
    let (about_axis, about_across) = (middle + half, middle - half);
    let (directions, curvatures) = if about_axis.abs() >= about_across.abs() {
        ([across, -axis], [about_axis, about_across])
    } else {
        ([axis, across], [about_across, about_axis])
    };
    Some(Bend { normal, directions, curvatures })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::features::ANGLE;
    use crate::core::discrete::fixtures::{plate, sphere, tube};

    #[test]
    fn a_ball_and_a_tube_have_the_curvature_of_their_radius_and_a_plate_has_none() {
        for bend in bends(&sphere(16), ANGLE, None).iter().flatten() {
            assert!(bend.curvatures.iter().all(|k| (0.8..1.25).contains(k)), "{bend:?}");
        }
        // A tube about z: bent around, straight along.
        let mesh = tube(48, 40, 4.0);
        let radius = mesh.points[0].truncate().length();
        let (low, high) = mesh.points.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.z), h.max(p.z)));
        let inner = |z: f64| z > low + 0.3 * (high - low) && z < high - 0.3 * (high - low);
        let mut seen = 0;
        for (bend, _) in bends(&mesh, ANGLE, None).iter().zip(&mesh.points).filter(|(_, p)| inner(p.z)) {
            let bend = bend.as_ref().unwrap();
            assert!((bend.curvatures[0] * radius - 1.0).abs() < 0.1, "{bend:?}");
            assert!(bend.curvatures[1].abs() * radius < 0.1 && bend.directions[1].z.abs() > 0.99, "{bend:?}");
            seen += 1;
        }
        assert!(seen > 100);
        assert!(bends(&plate(6, 0.0), ANGLE, None).iter().flatten().all(|bend| bend.curvatures[0].abs() < 1e-12));
    }
}
