//! Explanations as text.

use std::fmt;

use super::{Corner, EdgeFacts, EdgeKind, ElementFacts, MetricFacts, NodeFacts, SegmentFacts, plain};
use crate::core::case::Parameters;
use crate::core::mesh::ElementId;
use crate::core::run::front_table::Row;

impl Corner {
    fn words(self, parameters: &Parameters) -> String {
        let limit = |name: &str, angle: f64| format!("{name} = {}", degrees(angle));
        match self {
            Corner::Seam => format!("at most {}: a seam", limit("theta_seam", parameters.theta_seam)),
            Corner::Rectangle => {
                format!("below {}: the neighbouring segment is the side", limit("theta_rect", parameters.theta_rect))
            }
            Corner::Flat => format!("not below {}: a side must be found", limit("theta_rect", parameters.theta_rect)),
            Corner::Reversal => format!("beyond {}: a reversal", limit("theta_revr", parameters.theta_revr)),
        }
    }
}

fn degrees(radians: f64) -> String {
    format!("{:.1} deg", radians.to_degrees())
}

/// A number with five significant digits.
fn five(x: f64) -> String {
    if x == 0.0 || (1e-3..1e5).contains(&x.abs()) {
        let digits = 4 - libm::floor(libm::log10(x.abs().max(1e-3))) as i32;
        format!("{x:.*}", digits.clamp(0, 8) as usize)
    } else {
        format!("{x:.4e}")
    }
}

impl fmt::Display for MetricFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, second] = [0, 1].map(|k| {
            // A direction and its opposite are equivalent: avoid negative zeros.
            let [x, y] = self.directions[k].map(|x| if x.abs() < 5e-4 { 0.0 } else { x });
            format!("h = {} along ({x:.3}, {y:.3}), lambda = {}", five(self.sizes[k]), five(self.lambda[k]))
        });
        write!(f, "{first}; {second}")
    }
}

impl fmt::Display for SegmentFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Row { a, b, class, h_value, length_metric, length_physical, theta, level, .. } = self.row;
        writeln!(f, "Segment {} - {}", a.0, b.0)?;
        for (name, metric) in ["A", "B"].iter().zip(&self.metric) {
            writeln!(f, "  M{name}: {metric}")?;
        }
        let largest = self.smallest_sizes.map(|size| 1.0 / size);
        writeln!(
            f,
            "  H = 1/2 (1/{} + 1/{}) = {} (eq. 6); Hmin = {}",
            five(largest[0]),
            five(largest[1]),
            five(h_value),
            five(self.h_min)
        )?;
        writeln!(
            f,
            "  length: {} in space, {} parametric, {} metric",
            five(length_physical),
            five(self.length_parametric),
            five(length_metric)
        )?;
        for (k, name) in ["A", "B"].iter().enumerate() {
            writeln!(f, "  theta_{name} = {}, {}", degrees(theta[k]), self.corners[k].words(&self.parameters))?;
        }
        let parity = if self.front_loop.segments.is_multiple_of(2) { "even" } else { "odd" };
        writeln!(
            f,
            "  class {class} of table 1 (4.3.3), level {level}, loop {} of {} segments ({parity})",
            self.row.front_loop, self.front_loop.segments
        )?;
        self.why.iter().try_for_each(|sentence| writeln!(f, "  {}", plain(sentence)))
    }
}

impl fmt::Display for NodeFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [u, v] = self.uv;
        let fixed = if self.is_fixed { ", on the boundary" } else { "" };
        writeln!(f, "Node {} at ({u}, {v}){fixed}", self.node.0)?;
        writeln!(f, "  M: {}", self.metric)?;
        let ids = |elements: &[ElementId]| elements.iter().map(|e| e.0.to_string()).collect::<Vec<_>>().join(", ");
        writeln!(f, "  {} edges; live triangles: {}; dead: {}", self.valence, ids(&self.live), ids(&self.dead))?;
        for (_, theta) in &self.sectors {
            writeln!(f, "  frontal angle {theta:.1} deg")?;
        }
        Ok(())
    }
}

impl fmt::Display for EdgeFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            EdgeKind::Live => "live",
            EdgeKind::Front if self.is_boundary => "front, on the boundary",
            EdgeKind::Front => "front",
            EdgeKind::Dead => "dead",
            EdgeKind::Boundary => "boundary",
        };
        let [a, b] = self.ends.map(|n| n.0);
        writeln!(f, "Edge {a} - {b}: {kind}")?;
        writeln!(f, "  length: {} in space, {} metric", five(self.length_physical), five(self.length_metric))
    }
}

impl fmt::Display for ElementFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.is_live { "live triangle" } else { "dead quadrilateral" };
        let nodes = self.nodes.iter().map(|n| n.0.to_string()).collect::<Vec<_>>().join(", ");
        let angles = |list: &[f64]| list.iter().map(|a| format!("{a:.1}")).collect::<Vec<_>>().join(", ");
        writeln!(f, "Element {}: {kind} of nodes {nodes}", self.element.0)?;
        writeln!(f, "  quality {:.3}, level {}, region {}", self.quality, self.level, self.region)?;
        writeln!(f, "  angles in the metric: {} deg", angles(&self.angles_metric))?;
        writeln!(f, "  angles in space: {} deg", angles(&self.angles_physical))?;
        writeln!(f, "  area: {} in space, {} metric", five(self.area), five(self.area_metric))
    }
}
