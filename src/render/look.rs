//! The look of a figure: ink, background, layers, and the part drawn.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::camera::Bearing;
use super::picture::Role;
use crate::core::kernel::worded::worded;

/// The inks of figures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ink {
    /// For print in black.
    Grey,
    /// For print in colour.
    #[default]
    Colour,
    /// In colour on a dark ground, for screens.
    Dark,
}

worded! {
    /// A layer of the drawing of a state.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
    pub enum Layer by name {
        /// Live triangles.
        Live = "live",
        /// Dead quadrilaterals.
        Dead = "dead",
        /// Elements that the last step changed.
        Changed = "changed",
        /// Boundary, cracks, interior lines.
        Boundary = "boundary",
        /// The merging front, by the classes of table 1.
        Front = "front",
        /// A wedge at every end of a front segment that already has a side: it distinguishes the classes without
        /// colours.
        Wedges = "wedges",
        /// Base, sides and top of the current quadrilateral.
        Decision = "decision",
        /// Candidates for a side edge that the last step did not choose, dotted, each with the reason; on surfaces
        /// without it.
        Candidates = "candidates",
        /// The letters A, B, C and D.
        Letters = "letters",
        /// Nodes.
        Nodes = "nodes",
        /// Class and H-value (eq. 6) of front segments.
        H = "h",
        /// Frontal angles in degrees.
        Angles = "angles",
        /// Metric ellipses, scaled to a quarter of unit length.
        Ellipses = "ellipses",
        /// A scale bar.
        Scale = "scale",
    }
}

impl Ink {
    /// All inks.
    pub const ALL: [Ink; 3] = [Ink::Colour, Ink::Grey, Ink::Dark];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Ink::Colour => "colour",
            Ink::Grey => "grey",
            Ink::Dark => "dark",
        }
    }
}

impl Layer {
    /// The layer of a role.
    pub fn of(role: Role) -> Layer {
        match role {
            Role::LiveTriangle | Role::LiveEdge => Layer::Live,
            Role::DeadQuad | Role::DeadEdge => Layer::Dead,
            Role::Changed | Role::ChangedEdge => Layer::Changed,
            Role::Boundary => Layer::Boundary,
            Role::Front(_) => Layer::Front,
            Role::Refused => Layer::Candidates,
            Role::Side | Role::Top | Role::Base => Layer::Decision,
        }
    }
}

/// A set of layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers(u32);

impl Layers {
    /// The default layers of figures. In grey, wedges distinguish the classes; a strip has no room for letters and
    /// similar marks, and one scale bar serves all its frames.
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

    /// Switches a layer on or off.
    pub fn set(&mut self, layer: Layer, on: bool) {
        let bit = 1 << layer as u32;
        self.0 = if on { self.0 | bit } else { self.0 & !bit };
    }
}

worded! {
    /// How hidden lines are drawn.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "snake_case")]
    pub enum HiddenLines by name {
        /// Not drawn.
        #[default]
        Off = "off",
        /// Drawn faintly.
        Faint = "faint",
        /// Drawn almost like visible lines.
        Shown = "shown",
    }
}

impl HiddenLines {
    /// The next style, cyclically.
    pub fn next(self) -> HiddenLines {
        HiddenLines::ALL[(self as usize + 1) % HiddenLines::ALL.len()]
    }

    /// The opacity of hidden lines.
    pub fn share(self) -> f32 {
        [0.0, 0.2, 0.75][self as usize]
    }
}

/// A part of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FigurePart {
    /// Its centre.
    pub centre: DVec2,
    /// Its height in units of the case; its width follows from the aspect ratio of the page.
    pub height: f64,
}

/// The look of a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// Its ink.
    pub ink: Ink,
    /// Whether the background is left out.
    pub transparent: bool,
    /// The layers drawn.
    pub layers: Layers,
    /// The part drawn; `None`: everything.
    pub part: Option<FigurePart>,
    /// The direction of view on a mesh in space.
    pub from: Bearing,
    /// How hidden lines are drawn.
    pub hidden: HiddenLines,
    /// Whether a mesh on surfaces is drawn in its parametric plane.
    pub parametric: bool,
}
