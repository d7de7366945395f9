//! How a figure looks: ink, ground, what of a state is drawn, and which part of it.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::camera::Bearing;
use super::picture::Role;

/// The inks of figures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ink {
    /// For pages that are printed in black.
    Grey,
    /// For pages in colour.
    #[default]
    Colour,
}

/// What can be drawn of a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// Live triangles.
    Live,
    /// Dead quadrilaterals.
    Dead,
    /// What the last step changed.
    Changed,
    /// Boundary, cracks, lines inside.
    Boundary,
    /// The merging front by the classes of table 1.
    Front,
    /// A wedge at every end of a front segment that is a side already: it tells the classes apart without colours.
    Wedges,
    /// Base, sides and top of the quadrilateral in the making.
    Decision,
    /// The letters A, B, C and D.
    Letters,
    /// Nodes.
    Nodes,
    /// Class and H-value (eq. 6) of front segments.
    H,
    /// Frontal angles in degrees.
    Angles,
    /// Metric ellipses, at a quarter of unit length.
    Ellipses,
    /// A scale bar.
    Scale,
}

impl Layer {
    /// All layers.
    pub const ALL: [Layer; 13] = [
        Layer::Live,
        Layer::Dead,
        Layer::Changed,
        Layer::Boundary,
        Layer::Front,
        Layer::Wedges,
        Layer::Decision,
        Layer::Letters,
        Layer::Nodes,
        Layer::H,
        Layer::Angles,
        Layer::Ellipses,
        Layer::Scale,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Layer::Live => "live",
            Layer::Dead => "dead",
            Layer::Changed => "changed",
            Layer::Boundary => "boundary",
            Layer::Front => "front",
            Layer::Wedges => "wedges",
            Layer::Decision => "decision",
            Layer::Letters => "letters",
            Layer::Nodes => "nodes",
            Layer::H => "h",
            Layer::Angles => "angles",
            Layer::Ellipses => "ellipses",
            Layer::Scale => "scale",
        }
    }

    /// The layer that a role belongs to.
    pub fn of(role: Role) -> Layer {
        match role {
            Role::LiveTriangle | Role::LiveEdge => Layer::Live,
            Role::DeadQuad | Role::DeadEdge => Layer::Dead,
            Role::Changed | Role::ChangedEdge => Layer::Changed,
            Role::Boundary => Layer::Boundary,
            Role::Front(_) => Layer::Front,
            Role::Side | Role::Top | Role::Base => Layer::Decision,
        }
    }
}

/// A set of layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers(u32);

impl Layers {
    /// What figures show where nothing else is asked for; in grey, wedges tell the classes apart, in a strip letters and the
    /// like would be too many, and one scale bar serves all.
    pub fn usual(ink: Ink, strip: bool) -> Layers {
        let mut layers = Layers::default();
        for layer in [Layer::Live, Layer::Dead, Layer::Boundary, Layer::Front, Layer::Decision] {
            layers.set(layer, true);
        }
        layers.set(Layer::Wedges, ink == Ink::Grey);
        layers.set(Layer::Letters, !strip);
        layers.set(Layer::Scale, strip);
        layers
    }

    /// Whether a layer is on.
    pub fn has(self, layer: Layer) -> bool {
        self.0 & (1 << layer as u32) != 0
    }

    /// Switches a layer.
    pub fn set(&mut self, layer: Layer, on: bool) {
        let bit = 1 << layer as u32;
        self.0 = if on { self.0 | bit } else { self.0 & !bit };
    }
}

/// How lines that faces cover are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HiddenLines {
    /// They are not.
    #[default]
    Off,
    /// Faintly.
    Faint,
    /// Nearly as those that are seen.
    Shown,
}

impl HiddenLines {
    /// All of them.
    pub const ALL: [HiddenLines; 3] = [HiddenLines::Off, HiddenLines::Faint, HiddenLines::Shown];

    /// The next one.
    pub fn next(self) -> HiddenLines {
        match self {
            HiddenLines::Off => HiddenLines::Faint,
            HiddenLines::Faint => HiddenLines::Shown,
            HiddenLines::Shown => HiddenLines::Off,
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            HiddenLines::Off => "off",
            HiddenLines::Faint => "faint",
            HiddenLines::Shown => "shown",
        }
    }

    /// How much is seen of such lines.
    pub fn share(self) -> f32 {
        match self {
            HiddenLines::Off => 0.0,
            HiddenLines::Faint => 0.2,
            HiddenLines::Shown => 0.75,
        }
    }
}

/// A part of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Its middle.
    pub centre: DVec2,
    /// Its height, in units of the case; its width follows from the shape of the page.
    pub height: f64,
}

/// How a figure looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// Its ink.
    pub ink: Ink,
    /// Whether its ground is left out.
    pub transparent: bool,
    /// What is drawn.
    pub layers: Layers,
    /// The part that is drawn; all where there is none.
    pub part: Option<Part>,
    /// From where a mesh in space is seen.
    pub from: Bearing,
    /// How its covered lines are drawn.
    pub hidden: HiddenLines,
}
