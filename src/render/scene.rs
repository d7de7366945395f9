//! A state as the graphics card draws it: faces, lines and points with a colour each, in f32 relative to an anchor.
//!
//! Every edge keeps its place for as long as it lives, so that a step of the converter changes a few places of long lists,
//! and only those are sent to the card. Deliberately absent: wgpu (`gpu`), and text, arcs and ellipses, which the window
//! lays over the picture.

mod placed;
mod form;
mod shading;
mod mesh;
mod overlay;
mod given;

use glam::{DVec2, DVec3};

pub use form::{Form, Spot};
pub use given::{Given, feature_line, seam_line};
pub use mesh::Drawn;
pub use overlay::{Decision, Outlined, Overlay, front};
pub use placed::{Placed, STRETCH};
pub use shading::{ColourBy, Shading, angles, metric_area};

use super::palette::Rgba;
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::ids::{ElementId, NodeId};
use placed::Places;

/// A filled triangle or quadrilateral.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "window", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub struct Face {
    /// Corners, anticlockwise; a triangle's last one is there twice.
    pub corners: [[f32; 3]; 4],
    /// The surface's unit normals at them, folded into two numbers each (`form`).
    pub normals: [[i16; 2]; 4],
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

/// Everything of one state that the card draws, from back to front: `faces`, `edges`, `under`, `boundary`, `over`, `dots`,
/// `over_dots`.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// What all positions are relative to.
    pub anchor: DVec3,
    /// One for each element slot, or where elements are drawn curved so many as `pieces` says.
    pub faces: Placed<Face>,
    /// Edges of the mesh, each in its place for as long as it lives.
    pub edges: Placed<Line>,
    /// The background mesh, and what the last operations changed.
    pub under: Placed<Line>,
    /// Edges on the boundary, in places as those of the mesh.
    pub boundary: Placed<Line>,
    /// Front, decision, selection: in the order in which they are drawn.
    pub over: Placed<Line>,
    /// One for each node slot.
    pub dots: Placed<Dot>,
    /// Dots over everything: the ends of the decision.
    pub over_dots: Placed<Dot>,
    /// Changes with everything above.
    pub generation: u64,
    /// How the mesh is laid out.
    form: Form,
    /// Faces for an element and lines for an edge, each way, where they are drawn curved.
    pieces: usize,
    /// Where each node stands.
    spots: Vec<Spot>,
    /// The nodes at each point that faces share, where elements are drawn curved.
    copies: Vec<Vec<NodeId>>,
    places: Places,
    boundary_places: Places,
    /// What stands out as just changed.
    standing_out: Vec<ElementId>,
}

/// A place relative to the anchor.
fn relative(p: DVec3, anchor: DVec3) -> [f32; 3] {
    (p - anchor).as_vec3().to_array()
}

/// A colour that is drawn: 0 stands for nothing.
fn ink(colour: Rgba) -> u32 {
    colour.packed()
}

/// The least and greatest coordinates of a mesh; `None` for an empty one.
pub fn bounds(mesh: &Mesh) -> Option<[DVec2; 2]> {
    mesh.nodes().map(|n| mesh.uv(n)).map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
