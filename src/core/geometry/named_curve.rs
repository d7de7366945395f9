//! A named space curve, and its image in a chart.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::assembly::placed;
use super::chart::Chart;
use super::image::{Image, ON_SURFACE};
use super::space_curve::SpaceCurve;
use crate::core::fault::Fault;
use crate::core::kernel::decimal::{number, point_text};

/// A named space curve.
pub(in crate::core) struct NamedCurve {
    pub name: String,
    pub curve: Arc<SpaceCurve>,
    pub segments: Option<u32>,
    pub place: String,
    /// Vertices in space at its start and end.
    pub ends: [u32; 2],
}

/// The image of a curve in a chart, on the sheet that `move_by` selects; see [`Lift`](super::lifting::Lift).
/// A curve may be off the surface by `tolerance`, if it is given.
pub(super) fn image_on(
    chart: &Arc<Chart>,
    named: &NamedCurve,
    move_by: DVec2,
    face: &str,
    tolerance: Option<f64>,
) -> Result<Image, Fault> {
    let most = tolerance.unwrap_or(0.0).max(ON_SURFACE * chart.surface().size());
    if let Some((surface, trim)) = named.curve.trim()
        && Arc::ptr_eq(surface, chart.surface())
    {
        return Ok(Image::of_trim(chart, &named.curve, trim, move_by));
    }
    let (start, off) = chart.locate(named.curve.point(0.0));
    let refuse = |distance: f64, at: DVec3| {
        let what = format!("The curve \"{}\" does not lie on the surface of the face \"{face}\"", named.name);
        let fault = Fault::new(format!("{what}: it is {} away", number(distance)))
            .at(format!("at {}", point_text(at)))
            .remedy("Correct the curve, or name another one");
        placed(fault, &named.place)
    };
    if off > most {
        return Err(refuse(off, named.curve.point(0.0)));
    }
    let guess = if move_by == DVec2::ZERO { start } else { chart.of_uv(chart.uv(start) + move_by) };
    Image::projected(chart, &named.curve, guess, most).map_err(|off| refuse(off.distance, off.at))
}
