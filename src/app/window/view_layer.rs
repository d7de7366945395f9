//! The layers of the views, which the digit keys switch.

use crate::core::kernel::worded::worded;
use crate::render::scene::Layers;

worded! {
    /// A layer of the views, in the order of their digits from 1.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ViewLayer by name {
        /// Triangles that are still to be converted.
        LiveTriangles = "live triangles",
        /// Finished quadrilaterals.
        DeadQuads = "dead quads",
        /// Segments of the merging front.
        Front = "front",
        /// The boundary.
        Boundary = "boundary",
        /// Nodes.
        Nodes = "nodes",
        /// Numbers, letters and H-values.
        Labels = "labels",
        /// Arcs at frontal angles.
        AngleArcs = "angle arcs",
        /// Unit circles of the metric, at a quarter of their size.
        MetricEllipses = "metric ellipses",
        /// The mesh from which the conversion started.
        BackgroundMesh = "background mesh",
    }
}

impl ViewLayer {
    /// Its switch among those of the scene.
    pub fn switch(self, layers: &mut Layers) -> &mut bool {
        match self {
            ViewLayer::LiveTriangles => &mut layers.live,
            ViewLayer::DeadQuads => &mut layers.dead,
            ViewLayer::Front => &mut layers.front,
            ViewLayer::Boundary => &mut layers.boundary,
            ViewLayer::Nodes => &mut layers.nodes,
            ViewLayer::Labels => &mut layers.labels,
            ViewLayer::AngleArcs => &mut layers.arcs,
            ViewLayer::MetricEllipses => &mut layers.ellipses,
            ViewLayer::BackgroundMesh => &mut layers.background,
        }
    }

    /// Whether it is on.
    pub fn is_on(self, mut layers: Layers) -> bool {
        *self.switch(&mut layers)
    }
}
