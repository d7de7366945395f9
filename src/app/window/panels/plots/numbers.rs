//! What the plots show of one state: counts of edges and quadrilaterals, and the edges and elements of the extremes.

use crate::app::window::session::Moment;
use crate::core::mesh::{ElementId, NodeId};
use crate::render::scene::{metric_angles, space_angles};

/// How many bars a plot has.
pub const BARS: usize = 36;
/// The largest edge length of the bars; longer edges are in the last one.
pub const LONGEST: f64 = 3.0;

/// The smallest and the largest value of something, with what has them.
pub type Extremes<T> = Option<[(T, f64); 2]>;

/// Counts and extremes of a state.
pub struct Numbers {
    /// Edges by metric length: those of quadrilaterals, and others.
    pub lengths: [Vec<u32>; 2],
    pub mean: f64,
    pub edges: Extremes<[NodeId; 2]>,
    /// Quadrilaterals by their smallest and by their largest angle in the metric.
    pub angles: [Vec<u32>; 2],
    /// The smallest and the largest angle of all quadrilaterals in the metric, radians.
    pub in_metric: Extremes<ElementId>,
    /// The same in space.
    pub in_space: Extremes<ElementId>,
}

impl Numbers {
    pub fn of(moment: &Moment) -> Numbers {
        let mesh = &moment.mesh;
        let mut numbers = Numbers {
            lengths: [vec![0; BARS], vec![0; BARS]],
            mean: f64::NAN,
            edges: None,
            angles: [vec![0; BARS], vec![0; BARS]],
            in_metric: None,
            in_space: None,
        };
        let (mut sum, mut count) = (0.0, 0_u32);
        for h in mesh.edges() {
            let length = mesh.length(h);
            let is_of_quad = mesh.is_quad(h.element()) || mesh.twin(h).is_some_and(|t| mesh.is_quad(t.element()));
            numbers.lengths[usize::from(!is_of_quad)][bar(length, LONGEST)] += 1;
            widen(&mut numbers.edges, mesh.ends(h), [length; 2]);
            (sum, count) = (sum + length, count + 1);
        }
        numbers.mean = sum / f64::from(count);
        for e in mesh.elements().filter(|e| mesh.is_quad(*e)) {
            let both = metric_angles(mesh, e);
            for (counts, angle) in numbers.angles.iter_mut().zip(both) {
                counts[bar(angle, std::f64::consts::PI)] += 1;
            }
            widen(&mut numbers.in_metric, e, both);
            widen(&mut numbers.in_space, e, space_angles(mesh, e));
        }
        numbers
    }
}

/// The bar of a value.
fn bar(value: f64, most: f64) -> usize {
    ((value / most * BARS as f64).max(0.0) as usize).min(BARS - 1)
}

/// Takes in the smallest and the largest value of one more; the first of equal ones stays.
fn widen<T: Copy>(extremes: &mut Extremes<T>, of: T, [low, high]: [f64; 2]) {
    let [least, most] = extremes.get_or_insert([(of, low), (of, high)]);
    if low < least.1 {
        *least = (of, low);
    }
    if high > most.1 {
        *most = (of, high);
    }
}
