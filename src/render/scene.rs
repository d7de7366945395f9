//! A state as the graphics card draws it: faces, lines and points with a colour each, in f32 relative to an anchor.
//!
//! Every edge keeps its place for as long as it lives, so that a step of the converter changes a few places of long lists,
//! and only those are sent to the card. Deliberately absent: wgpu (`gpu`), and text, arcs and ellipses, which the window
//! lays over the picture.

mod mesh;
mod overlay;

use glam::{DVec2, DVec3};

pub use mesh::{angles, metric_area};
pub use overlay::{Decision, Outlined, Overlay, front};

use super::colour_map::ColourMap;
use super::palette::Rgba;
use crate::core::mesh::half_edge::Mesh;

/// A filled triangle or quadrilateral.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "window", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub struct Face {
    /// Corners, anticlockwise; a triangle's last one is there twice.
    pub corners: [[f32; 3]; 4],
    /// Its colour; nothing is drawn where it is 0.
    pub colour: u32,
}

/// A straight line of constant width on the screen.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "window", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub struct Line {
    /// Its ends.
    pub ends: [[f32; 3]; 2],
    /// Its colour; nothing is drawn where it is 0.
    pub colour: u32,
    /// Its width in points.
    pub width: f32,
    /// Points drawn and points left out, by turns; a whole line where both are 0.
    pub dash: [f32; 2],
    /// The room that it has: the least height over it of the elements beside it, by which it fades when they become small
    /// on the screen. Negative: it never fades.
    pub room: f32,
}

/// A disc of constant size on the screen, with a ring around it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "window", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub struct Dot {
    /// Its middle.
    pub at: [f32; 3],
    /// Radius in points, the ring included.
    pub radius: f32,
    /// Colour within.
    pub fill: u32,
    /// Colour of the ring.
    pub ring: u32,
    /// Width of the ring in points.
    pub ring_width: f32,
    /// Distance of the nearest neighbour.
    pub room: f32,
    /// Shown where `room` is at least so many points on the screen.
    pub least: f32,
}

/// What elements are coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColourBy {
    /// Live and dead.
    #[default]
    State,
    /// The mean smallest target size at the nodes (eq. 6), by its logarithm.
    HValue,
    /// The smallest angle, in degrees of the plane.
    Angle,
    /// Rows from the boundary.
    Level,
    /// Quality in the metric.
    Quality,
    /// The step that made the element.
    Birth,
    /// Area in the metric.
    Area,
}

impl ColourBy {
    /// All of them, in the order of menus.
    pub const ALL: [ColourBy; 7] = [
        ColourBy::State,
        ColourBy::HValue,
        ColourBy::Angle,
        ColourBy::Level,
        ColourBy::Quality,
        ColourBy::Birth,
        ColourBy::Area,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            ColourBy::State => "live and dead",
            ColourBy::HValue => "H",
            ColourBy::Angle => "smallest angle",
            ColourBy::Level => "level",
            ColourBy::Quality => "quality",
            ColourBy::Birth => "step of birth",
            ColourBy::Area => "metric area",
        }
    }

    /// Its colour map; none where the state is shown.
    pub fn map(self) -> Option<ColourMap> {
        match self {
            ColourBy::State => None,
            ColourBy::HValue | ColourBy::Birth | ColourBy::Area => Some(ColourMap::Viridis),
            ColourBy::Angle | ColourBy::Quality => Some(ColourMap::Cividis),
            ColourBy::Level => Some(ColourMap::Batlow),
        }
    }
}

/// What is drawn of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layers {
    /// Live triangles.
    pub live: bool,
    /// Dead quadrilaterals.
    pub dead: bool,
    /// The merging front.
    pub front: bool,
    /// The boundary.
    pub boundary: bool,
    /// Nodes.
    pub nodes: bool,
    /// Labels.
    pub labels: bool,
    /// Angle arcs.
    pub arcs: bool,
    /// Metric ellipses.
    pub ellipses: bool,
    /// The background mesh.
    pub background: bool,
}

impl Default for Layers {
    fn default() -> Self {
        Layers {
            live: true,
            dead: true,
            front: true,
            boundary: true,
            nodes: true,
            labels: true,
            arcs: true,
            ellipses: false,
            background: false,
        }
    }
}

/// The values that elements are coloured by, and their range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shading {
    /// What is shown.
    pub by: ColourBy,
    /// A value for each element slot; not a number where there is none.
    pub values: Vec<f64>,
    /// The least and greatest value.
    pub range: [f64; 2],
    /// Whether colours go by the logarithm.
    pub logarithmic: bool,
}

/// Everything of one state that the card draws, from back to front: `faces`, `edges`, `over`, `dots`.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What all positions are relative to.
    pub anchor: DVec3,
    /// One for each element slot.
    pub faces: Vec<Face>,
    /// Edges of the mesh, each in its place for as long as it lives.
    pub edges: Vec<Line>,
    /// Front, boundary, decision, selection: in the order in which they are drawn.
    pub over: Vec<Line>,
    /// One for each node slot.
    pub dots: Vec<Dot>,
    /// Dots over everything: the ends of the decision.
    pub over_dots: Vec<Dot>,
    /// Changes with everything above.
    pub generation: u64,
    /// The place of each half-edge slot in `edges`; `u32::MAX` where it has none.
    place: Vec<u32>,
    /// Places that nobody uses.
    free: Vec<u32>,
}

/// A place of the plane relative to the anchor.
fn relative(p: DVec2, anchor: DVec3) -> [f32; 3] {
    (p.extend(0.0) - anchor).as_vec3().to_array()
}

/// A colour that is drawn: 0 stands for nothing.
fn ink(colour: Rgba) -> u32 {
    colour.packed()
}

/// The least and greatest coordinates of a mesh; `None` for an empty one.
pub fn bounds(mesh: &Mesh) -> Option<[DVec2; 2]> {
    mesh.nodes().map(|n| mesh.uv(n)).map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
