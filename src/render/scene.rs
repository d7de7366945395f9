//! A state in the form that the graphics card draws: coloured faces, lines and points, in f32 relative to an anchor.
//!
//! Every edge keeps its slot as long as it exists, so that a step of the converter changes a few slots of long lists,
//! and only those are sent to the card. Deliberately absent: wgpu (see `gpu`), and text, arcs and ellipses, which the
//! window draws over the picture.

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
pub use overlay::{Decision, FRONT, Outlined, Overlay, front};
pub use placed::{Placed, STRETCH};
pub use shading::{ColourBy, Shading, metric_angles, metric_area, space_angles};

use crate::core::mesh::{ElementId, Mesh, NodeId};
use placed::Places;

/// A filled triangle or quadrilateral.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "window", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub struct Face {
    /// Corners, anticlockwise; a triangle repeats its last one.
    pub corners: [[f32; 3]; 4],
    /// The unit normals of the surface at the corners, packed into two numbers each (`form`).
    pub normals: [[i16; 2]; 4],
    /// Its colour; 0 draws nothing.
    pub colour: u32,
}

/// A straight line of constant width on the screen.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "window", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub struct Line {
    /// Its ends.
    pub ends: [[f32; 3]; 2],
    /// Its colour; 0 draws nothing.
    pub colour: u32,
    /// Its width in points.
    pub width: f32,
    /// The dash pattern: points drawn and points left out; solid where both are 0.
    pub dash: [f32; 2],
    /// The room around it: the smallest height over it of the elements beside it. The line fades where they become
    /// small on the screen; with a negative value it never fades.
    pub room: f32,
}

/// A disc of constant size on the screen, with a ring around it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "window", derive(bytemuck::Pod, bytemuck::Zeroable))]
pub struct Dot {
    /// Its centre.
    pub at: [f32; 3],
    /// Radius in points, the ring included.
    pub radius: f32,
    /// Colour inside.
    pub fill: u32,
    /// Colour of the ring.
    pub ring: u32,
    /// Width of the ring in points.
    pub ring_width: f32,
    /// Distance of the nearest neighbour.
    pub room: f32,
    /// It is drawn where `room` is at least this many points on the screen.
    pub least: f32,
}

/// A layer of the window's views.
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

/// Everything that the card draws of one state, from back to front: `faces`, `edges`, `under`, `boundary`, `over`,
/// `dots`, `over_dots`.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The origin of all positions.
    pub anchor: DVec3,
    /// One for each element slot; where elements are drawn curved, as many as `pieces` says.
    pub faces: Placed<Face>,
    /// Edges of the mesh, each in its slot as long as it exists.
    pub edges: Placed<Line>,
    /// The background mesh, and edges that the last operations changed.
    pub under: Placed<Line>,
    /// Edges on the boundary, in slots like those of the mesh.
    pub boundary: Placed<Line>,
    /// Front, decision and selection, in drawing order.
    pub over: Placed<Line>,
    /// One for each node slot.
    pub dots: Placed<Dot>,
    /// Dots on top: the ends of the decision.
    pub over_dots: Placed<Dot>,
    /// It increases with every change of the lists above.
    pub generation: u64,
    /// The form in which the mesh is drawn.
    form: Form,
    /// Faces per element and lines per edge, in each direction, where they are drawn curved.
    pieces: usize,
    /// The position of each node.
    spots: Vec<Spot>,
    /// The nodes at each point that faces share, where elements are drawn curved.
    copies: Vec<Vec<NodeId>>,
    places: Places,
    boundary_places: Places,
    /// The elements highlighted as just changed.
    standing_out: Vec<ElementId>,
}

/// A position relative to the anchor.
fn relative(p: DVec3, anchor: DVec3) -> [f32; 3] {
    (p - anchor).as_vec3().to_array()
}

/// The bounding box of a mesh; `None` for an empty one.
pub fn bounds(mesh: &Mesh) -> Option<[DVec2; 2]> {
    mesh.nodes().map(|n| mesh.uv(n)).map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
