//! Samples of invariants and statistics along a run. They are taken at keyframes; the cost of a sample depends on what
//! was touched since the last one.

use serde::Serialize;

use super::front_count::FrontCount;
use crate::core::kernel::predicates::{convex, orient};
use crate::core::mesh::{ElementId, Mesh, Touched};

/// The invariants and statistics of a state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sample {
    /// Its step.
    pub step: u64,
    /// The number of quadrilaterals.
    pub nq: u64,
    /// The counts of the front. Every loop is even where those of the background mesh are.
    pub front: FrontCount,
    /// Length of the front in the metric.
    pub front_length: f64,
    /// Smallest quality of a quadrilateral; 1 where there is none.
    pub worst_quality: f64,
    /// The number of elements that are not strictly positive; it must be 0.
    pub inverted: u32,
    /// Area in the parametric plane; it must not change except by rounding.
    pub area: f64,
    /// Area in the metric, from the metrics at the nodes; it changes as nodes sample other points of the field.
    pub area_metric: f64,
    /// Nodes minus edges plus elements; it must not change.
    pub euler: i64,
    /// Once its mirror image is joined to the half of a symmetric domain: the nodes minus the edges that both share.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shared: Option<i64>,
}

impl Sample {
    /// The area and the number of nodes minus edges plus elements that it must have, by the sample of step 0.
    pub(super) fn invariants(&self, first: &Sample) -> (f64, i64) {
        match self.shared {
            None => (first.area, first.euler),
            Some(shared) => (2.0 * first.area, 2 * first.euler - shared),
        }
    }
}

/// The measures of one element.
#[derive(Clone, Copy, Debug)]
struct Measure {
    quality: f32,
    area: f64,
    area_metric: f64,
    inverted: bool,
}

const NOTHING: Measure = Measure { quality: 1.0, area: 0.0, area_metric: 0.0, inverted: false };

/// Number of elements summed together.
const CHUNK: usize = 128;

/// Measures of all elements, kept up to date.
#[derive(Clone, Debug)]
pub(super) struct Measures {
    elements: Vec<Measure>,
    chunks: Vec<(Measure, u32)>,
    stale: Vec<bool>,
    boundary: i64,
    /// The nodes minus the edges that a half will share with its image.
    seam: i64,
    shared: Option<i64>,
}

impl Measures {
    pub fn of(mesh: &Mesh) -> Measures {
        let mut measures = Measures {
            elements: Vec::new(),
            chunks: Vec::new(),
            stale: Vec::new(),
            boundary: boundary(mesh),
            seam: mesh.seam(),
            shared: None,
        };
        measures.grow(mesh);
        for e in mesh.elements() {
            measures.measure(mesh, e);
        }
        measures
    }

    fn grow(&mut self, mesh: &Mesh) {
        self.elements.resize(self.elements.len().max(mesh.element_slots()), NOTHING);
        let chunks = self.elements.len().div_ceil(CHUNK);
        self.chunks.resize(chunks, (NOTHING, 0));
        self.stale.resize(chunks, true);
    }

    fn measure(&mut self, mesh: &Mesh, e: ElementId) {
        let Some(slot) = self.elements.get_mut(e.index()) else { return };
        self.stale[e.index() / CHUNK] = true;
        *slot = if mesh.has_element(e) { measured(mesh, e) } else { NOTHING };
    }

    /// The mirror image of a half was joined to it.
    pub fn mirror(&mut self, mesh: &Mesh) {
        self.boundary = boundary(mesh);
        self.shared = Some(self.seam);
    }

    /// Measures again what was touched since the last sample.
    pub fn update(&mut self, mesh: &Mesh, touched: &Touched) {
        self.grow(mesh);
        for &e in touched.elements() {
            self.measure(mesh, e);
        }
        for &n in touched.nodes() {
            if mesh.has_node(n) {
                for h in mesh.fan(n) {
                    self.measure(mesh, h.element());
                }
            }
        }
    }

    /// The sample of the measured state.
    pub fn sample(&mut self, mesh: &Mesh, step: u64, nq: u64, front: FrontCount, front_length: f64) -> Sample {
        let (mut total, mut inverted) = (NOTHING, 0);
        for (i, elements) in self.elements.chunks(CHUNK).enumerate() {
            if std::mem::take(&mut self.stale[i]) {
                let (mut sum, mut count) = (NOTHING, 0);
                for measure in elements {
                    sum.quality = sum.quality.min(measure.quality);
                    sum.area += measure.area;
                    sum.area_metric += measure.area_metric;
                    count += u32::from(measure.inverted);
                }
                self.chunks[i] = (sum, count);
            }
            let (sum, count) = self.chunks[i];
            total.quality = total.quality.min(sum.quality);
            total.area += sum.area;
            total.area_metric += sum.area_metric;
            inverted += count;
        }
        let elements = mesh.element_count() as i64;
        let triangles = i64::from(front.live);
        let sides = 3 * triangles + 4 * (elements - triangles);
        Sample {
            step,
            nq,
            front,
            front_length,
            worst_quality: f64::from(total.quality),
            inverted,
            area: total.area,
            area_metric: total.area_metric,
            euler: mesh.node_count() as i64 - (sides + self.boundary) / 2 + elements,
            shared: self.shared,
        }
    }
}

/// The number of sides on a boundary.
fn boundary(mesh: &Mesh) -> i64 {
    mesh.elements().flat_map(|e| mesh.half_edges(e)).filter(|&h| mesh.twin(h).is_none()).count() as i64
}

fn measured(mesh: &Mesh, e: ElementId) -> Measure {
    let root = mesh.corners(e).map(|n| mesh.metric_ref(n).det().sqrt()).sum::<f64>() / mesh.sides(e) as f64;
    if mesh.is_triangle(e) {
        let [a, b, c] = mesh.triangle(e).map(|n| mesh.uv(n));
        let area = 0.5 * (b - a).perp_dot(c - a);
        // Live triangles are not part of the result: their quality does not count.
        return Measure { quality: 1.0, area, area_metric: root * area, inverted: orient(a, b, c) <= 0.0 };
    }
    let [a, b, c, d] = mesh.quad(e).map(|n| mesh.uv(n));
    let area = 0.5 * (c - a).perp_dot(d - b);
    Measure { quality: mesh.quality(e) as f32, area, area_metric: root * area, inverted: !convex(a, b, c, d) }
}
