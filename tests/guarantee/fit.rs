//! The scale of sizes at which a random case has about the number of quadrilaterals that is wanted.

use quadfront::core::case::{Case, DomainSource};
use quadfront::core::geometry::Domain;
use quadfront::core::metric::{Field, MetricSource, Sizing};

/// Sets the case's size_scale so that it needs about `quads` quadrilaterals. A case that cannot be measured stays as it
/// is: the program is to refuse it.
pub fn fit(case: &mut Case, quads: f64) {
    for _ in 0..6 {
        let Some(now) = needed(case) else { return };
        let factor = (now / quads).sqrt().clamp(0.02, 50.0);
        case.parameters.size_scale = (case.parameters.size_scale * factor).clamp(1e-9, 1e9);
        if (0.9..1.1).contains(&factor) {
            return;
        }
    }
}

/// About how many quadrilaterals follow the metric: where it turns or narrows along its long direction, edges have to
/// be shorter than it asks for.
fn needed(case: &Case) -> Option<f64> {
    let DomainSource::Curves { curves, faces } = &case.domain else { return None };
    let domain = Domain::build(curves.clone(), faces.clone()).ok()?;
    let fields = case.fields.iter().map(|spec| Field::compile(spec, &|name| domain.curve_polyline(name)));
    let sizing = Sizing::new(fields.collect::<Result<_, _>>().ok()?, case.parameters.size_scale);
    let points: Vec<_> = domain.sample_points(200).into_iter().filter(|&p| domain.inside(p).is_some()).collect();
    let mut density = 0.0;
    for &p in &points {
        let ([low, high], [along, _]) = sizing.metric(p).ok()?.eigen();
        let mut length = (1.0 / low.sqrt()).min(0.5 * domain.size);
        for _ in 0..30 {
            let seen = |t: f64| sizing.metric(p + along * t).map_or(1.0, |m| m.norm2(along * length).sqrt());
            if seen(0.5 * length) < 2.0 && seen(-0.5 * length) < 2.0 {
                break;
            }
            length *= 0.7;
        }
        density += high.sqrt() / length;
    }
    let low = points.iter().fold(points[0], |low, p| low.min(*p));
    let high = points.iter().fold(points[0], |high, p| high.max(*p));
    // The share of the box that the domain fills, by a grid of its own.
    let filled = (0..400).filter(|k| {
        let (i, j) = (k % 20, k / 20);
        let t = glam::DVec2::new((f64::from(i) + 0.5) / 20.0, (f64::from(j) + 0.5) / 20.0);
        domain.inside(low + (high - low) * t).is_some()
    });
    let area = (high - low).x * (high - low).y * filled.count().max(1) as f64 / 400.0;
    Some(density / points.len() as f64 * area)
}
