//! The spacing that a boundary forces on the metric, and what is told of it.

use serde::Serialize;

use crate::core::background::triangulate::divide_by;
use crate::core::background::{DividedDomain, Division, Gaps};
use crate::core::fault::Fault;
use crate::core::geometry::{Course, Domain, DomainCurve};
use crate::core::kernel::decimal::number;
use crate::core::kernel::number::counted;
use crate::core::mesh::TriangleSet;
use crate::core::metric::{ForcedSide, Sizing};

/// How quickly sizes grow from a boundary that forces them, where the case does not say.
const GRADATION: f64 = 1.3;

/// The number of rounds in which sizes are forced: smaller sizes at one place may make segments at another too short.
const ROUNDS: usize = 4;

/// What the boundary makes of the sizes that are asked for.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Spacing {
    /// Segments that are much shorter than asked for, if there are any.
    pub forced: Option<Forced>,
    /// Gaps narrower than asked for, if there are any.
    pub narrow_gaps: Option<NarrowGaps>,
    /// Points of polylines at which they turn by less than `corner_angle`: they are no corners.
    pub smooth_points: usize,
    /// The segments on the mirror line, where they are not as many as the sizes ask for.
    pub mirror_line: Option<MirrorLine>,
}

/// How the mirror line of a symmetric domain is divided, wherever it runs through a face.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct MirrorLine {
    /// The number of segments of each part of it.
    pub segments: Vec<u32>,
    /// The numbers that the sizes ask for.
    pub by_sizes: Vec<u32>,
}

/// Segments from which sizes grow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Forced {
    /// Their number.
    pub segments: usize,
    /// The shortest length.
    pub shortest: f64,
    /// The least metric length, by the sizes that are asked for.
    pub shortest_in_metric: f64,
    /// The ratio by which sizes may grow over a unit length.
    pub gradation: f64,
    /// Whether the case gives that ratio.
    pub gradation_given: bool,
}

/// Stretches of curves that face each other across gaps narrower than asked for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct NarrowGaps {
    /// Pairs of stretches.
    pub pairs: usize,
    /// The least width.
    pub least_width: f64,
    /// Rows of quadrilaterals that are to lie across each.
    pub layers: u32,
    /// Whether both sides of each have equal numbers of segments; otherwise no loops or no triangles allow that.
    pub facing: bool,
}

impl NarrowGaps {
    fn of(gaps: &Gaps) -> Option<NarrowGaps> {
        let widths = gaps.rungs.iter().flatten().map(|[a, b]| a.distance(*b));
        let least_width = widths.fold(f64::INFINITY, f64::min);
        (!gaps.strips.is_empty()).then_some(NarrowGaps {
            pairs: gaps.strips.len(),
            least_width,
            layers: gaps.layers,
            facing: true,
        })
    }
}

impl Forced {
    fn of(sides: &[ForcedSide], gradation: f64, gradation_given: bool) -> Forced {
        let least = |of: fn(&ForcedSide) -> f64| sides.iter().map(of).fold(f64::INFINITY, f64::min);
        Forced {
            segments: sides.len(),
            shortest: least(|side| side.size),
            shortest_in_metric: least(|side| side.metric_size),
            gradation,
            gradation_given,
        }
    }
}

impl Spacing {
    /// Whether the nodes of this division face each other across the gaps.
    pub(super) fn follow(&mut self, divided: &DividedDomain) {
        if let Some(gaps) = &mut self.narrow_gaps {
            gaps.facing = divided.is_facing;
        }
    }

    /// Whether there is nothing to tell.
    pub fn is_plain(&self) -> bool {
        *self == Spacing::default()
    }

    /// What was done, in phrases without a full stop.
    pub fn phrases(&self) -> Vec<String> {
        let forced = |forced: &Forced| {
            format!(
                "{} shorter than asked for (down to {}, {} in the metric); sizes grow from there by {} over a unit \
                 length{}",
                counted(forced.segments as u64, "boundary segment"),
                number(forced.shortest),
                number(forced.shortest_in_metric),
                number(forced.gradation),
                if forced.gradation_given { "" } else { " (gradation)" }
            )
        };
        let smooth = |points: &usize| {
            format!("{} of polylines without a corner there (corner_angle)", counted(*points as u64, "point"))
        };
        let gaps = |gaps: &NarrowGaps| {
            let (pairs, width) = (counted(gaps.pairs as u64, "narrow gap"), number(gaps.least_width));
            if gaps.facing {
                let rows = if gaps.layers == 1 { String::new() } else { format!(", for {} layers each", gaps.layers) };
                format!("nodes face each other across {pairs}, down to {width} wide{rows}")
            } else {
                format!("{pairs}, down to {width} wide; equal numbers of segments on both sides did not work out")
            }
        };
        let line = |line: &MirrorLine| {
            let list = |numbers: &[u32]| {
                let words: Vec<String> = numbers.iter().map(u32::to_string).collect();
                words.join(", ")
            };
            let (segments, by_sizes) = (list(&line.segments), list(&line.by_sizes));
            format!("mirror line with {segments} segments instead of {by_sizes}, for fewer irregular nodes")
        };
        let points = Some(&self.smooth_points).filter(|points| **points > 0);
        let boundary = self.forced.iter().map(forced).chain(self.narrow_gaps.iter().map(gaps));
        boundary.chain(points.map(smooth)).chain(self.mirror_line.iter().map(line)).collect()
    }
}

/// A domain, divided and triangulated.
pub(super) struct Divided {
    pub divided: DividedDomain,
    pub set: TriangleSet,
    /// The metric by which it was divided: that which was asked for, within the sizes that the boundary forces.
    pub sizing: Sizing,
    pub spacing: Spacing,
    pub gaps: Gaps,
}

/// Divides and triangulates a domain. Curves that face each other across a gap too narrow for `layers` rows get nodes
/// that face each other. Where segments are much shorter than the metric asks for, the metric becomes the intersection
/// with their lengths, which grow inwards, and the domain is divided anew.
pub(super) fn divided(domain: &Domain, asked: &Sizing, layers: u32, gradation: Option<f64>) -> Result<Divided, Fault> {
    let beta = gradation.unwrap_or(GRADATION);
    let division = Division::measure(domain, asked)?;
    let mut gaps = Gaps::find(&division, layers)?;
    let narrow_gaps = NarrowGaps::of(&gaps);
    let mut sizing = asked.clone();
    let (mut divided, mut set) = if gaps.strips.is_empty() {
        divide_by(division)?
    } else {
        sizing = asked.forced(&gaps.sides(), &gaps.rungs, layers, beta);
        let made = Division::measure(domain, &sizing).and_then(|division| divide_by(division.across(&gaps)?));
        match made {
            Ok(made) => made,
            // Where facing nodes do not work out, each curve is divided by itself.
            Err(_) => {
                (gaps, sizing) = (Gaps { layers, ..Gaps::default() }, asked.clone());
                divide_by(division)?
            }
        }
    };
    // Where short segments keep a shape, sizes that grow from them ask for the same in the next round.
    let shaped = divided.shaped;
    let mut sides: Vec<ForcedSide> = Vec::new();
    for _ in 0..ROUNDS {
        if divided.forced.is_empty() {
            break;
        }
        sides.append(&mut divided.forced);
        sizing = asked.forced(&[gaps.sides(), sides.clone()].concat(), &gaps.rungs, layers, beta);
        (divided, set) = divide_by(Division::measure(domain, &sizing)?.across(&gaps)?)?;
    }
    divided.shaped = divided.shaped.max(shaped);
    let is_first = |(id, curve): &(usize, &DomainCurve)| curve.first.index() == *id;
    let courses = domain.curves.iter().enumerate().filter(is_first).map(|(_, curve)| &curve.curve);
    let smooth_points = courses.map(Course::smooth_points).sum();
    let forced = (!sides.is_empty()).then(|| Forced::of(&sides, beta, gradation.is_some()));
    let mut spacing = Spacing { forced, narrow_gaps, smooth_points, mirror_line: None };
    spacing.follow(&divided);
    Ok(Divided { divided, set, sizing, spacing, gaps })
}
