//! The half of a symmetric domain that is meshed: found, and its metric checked (docs/algorithm.md, "Symmetry").

use glam::DVec2;

use crate::core::case::Symmetry;
use crate::core::fault::{Fault, FaultKind};
use crate::core::geometry::{Axis, Domain, Half, Mirror};
use crate::core::kernel::Metric2;
use crate::core::kernel::decimal::{number, point_text};
use crate::core::mesh::{Mesh, PointId, Symmetry as Images};
use crate::core::metric::{MetricSource, Sizing};

/// The largest relative difference of the squares of two sizes that are each other's images: 1 % of the sizes.
const UNLIKE: f64 = 0.02;
/// The largest angle in radians between directions that are each other's images: fields by distance follow polylines.
const TURNED: f64 = 0.02;
/// Places nearer to the mirror line than this, relative to the size of the domain, are not compared: a metric may jump
/// there.
const AT_LINE: f64 = 1e-6;

/// The half of a domain in which its metric, known at `points` of it, is symmetric too.
///
/// # Errors
/// A domain or a metric that is not symmetric, with the first place where it is not.
pub(super) fn half(domain: &Domain, symmetry: Symmetry, sizing: &Sizing, points: &[DVec2]) -> Result<Half, Fault> {
    let along = |axis| {
        let mirror = domain.mirror(axis);
        let half = domain.half(mirror)?;
        check_metric(&mirror, domain.size, sizing, points)?;
        Ok(half)
    };
    match symmetry {
        Symmetry::X => along(Axis::X),
        Symmetry::Y => along(Axis::Y),
        Symmetry::Auto => along(Axis::X).or_else(|in_x: Fault| {
            along(Axis::Y).map_err(|in_y| {
                let said = |fault: &Fault| match fault.place.as_str() {
                    "" => fault.what.clone(),
                    place => format!("{place}: {}", fault.what),
                };
                Fault::new(format!("No mirror line was found. {}. {}", said(&in_x), said(&in_y)))
                    .of_kind(in_x.kind())
                    .remedy("Make domain and metric symmetric, or remove symmetry")
            })
        }),
    }
}

/// Refuses a metric that is not its own mirror image.
fn check_metric(mirror: &Mirror, size: f64, sizing: &Sizing, points: &[DVec2]) -> Result<(), Fault> {
    for &p in points.iter().filter(|&&p| mirror.offset(p) > AT_LINE * size) {
        let q = mirror.image(p);
        let (here, there) = (sizing.metric(p)?, sizing.metric(q)?);
        if differ(&here, &mirror.image_of_metric(&there)) {
            let sizes = |m: &Metric2| {
                let (lambda, _) = m.eigen();
                lambda.map(|lambda| number(1.0 / lambda.sqrt()))
            };
            let ([long, short], [long_there, short_there]) = (sizes(&here), sizes(&there));
            let axis = mirror.axis().word();
            let what = format!(
                "The metric is not symmetric in {axis}: its sizes are {short} and {long} at {}, {short_there} and \
                 {long_there} at the image {}, or have other directions",
                point_text(p),
                point_text(q)
            );
            return Err(Fault::new(what)
                .of_kind(FaultKind::Metric)
                .remedy(format!("Write it by the distance from {axis} = {}", number(mirror.position()))));
        }
    }
    Ok(())
}

/// Whether two metrics have unlike sizes, or directions in which sizes become unlike.
fn differ(a: &Metric2, b: &Metric2) -> bool {
    let ((lambda, directions), (other, _)) = (a.eigen(), b.eigen());
    (0..2).any(|k| {
        let turned = TURNED * TURNED * lambda[1] / lambda[k];
        (other[k] / lambda[k] - 1.0).abs() > UNLIKE
            || (b.norm2(directions[k]) / lambda[k] - 1.0).abs() > 2.0 * UNLIKE + turned
    })
}

/// The hard points of a half and their images, by their numbers in the case.
pub(super) fn hard_points(half: &Half, mesh: &Mesh, hard: &[(u32, PointId)]) -> Vec<(u32, PointId)> {
    let Some(symmetry) = mesh.symmetry() else { return Vec::new() };
    let images = mesh.image_points(symmetry);
    let both = hard.iter().flat_map(|&(number, point)| {
        let [own, of_image] = half.points[number as usize].map(|k| k as u32);
        let image = images[point.index()];
        [Some((own, point)), (image != point).then_some((of_image, image))]
    });
    both.flatten().collect()
}

/// How the image of the mesh of a half is joined to it; `lines` are the sides on the curves of the half, `hard` its
/// hard points.
pub(super) fn symmetry(mesh: &Mesh, half: &Half, lines: &[([PointId; 2], u32)], hard: &[(u32, PointId)]) -> Images {
    let joint = |curve: u32| half.joints.iter().find(|joint| joint.0.0 == curve).map(|joint| joint.1);
    let borders = lines.iter().filter_map(|&(ends, curve)| Some((ends, joint(curve)?))).collect();
    let hard = hard.iter().map(|(_, point)| *point).collect();
    Images::new(mesh, half.mirror, half.image_of.clone(), borders, hard)
}
