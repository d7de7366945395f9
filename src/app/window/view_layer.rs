//! The layers of the views, which the digit keys switch.

use crate::render::scene::Layers;

/// A layer of the views.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewLayer {
    /// Triangles that are still to be converted.
    LiveTriangles,
    /// Finished quadrilaterals.
    DeadQuads,
    /// Segments of the merging front.
    Front,
    /// The boundary.
    Boundary,
    /// Nodes.
    Nodes,
    /// Numbers, letters and H-values.
    Labels,
    /// Arcs at frontal angles.
    AngleArcs,
    /// Unit circles of the metric, at a quarter of their size.
    MetricEllipses,
    /// The mesh from which the conversion started.
    BackgroundMesh,
}

impl ViewLayer {
    /// All layers, in the order of their digits from 1.
    pub const ALL: [ViewLayer; 9] = [
        ViewLayer::LiveTriangles,
        ViewLayer::DeadQuads,
        ViewLayer::Front,
        ViewLayer::Boundary,
        ViewLayer::Nodes,
        ViewLayer::Labels,
        ViewLayer::AngleArcs,
        ViewLayer::MetricEllipses,
        ViewLayer::BackgroundMesh,
    ];

    /// Its name in menus and panels.
    pub fn name(self) -> &'static str {
        match self {
            ViewLayer::LiveTriangles => "live triangles",
            ViewLayer::DeadQuads => "dead quads",
            ViewLayer::Front => "front",
            ViewLayer::Boundary => "boundary",
            ViewLayer::Nodes => "nodes",
            ViewLayer::Labels => "labels",
            ViewLayer::AngleArcs => "angle arcs",
            ViewLayer::MetricEllipses => "metric ellipses",
            ViewLayer::BackgroundMesh => "background mesh",
        }
    }

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
