//! The table of the nodes of a state, for lists that are sorted and filtered.

use super::history::Changes;
use super::last_changes::LastChanges;
use super::listing::{Listed, Row, Steps, fields};
use crate::core::kernel::condition::Holds::{Flag, Number};
use crate::core::kernel::condition::{Field, Holds, Value};
use crate::core::kernel::worded::worded;
use crate::core::mesh::{Mesh, NodeId};

worded! {
    /// Where a node is.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum NodePlace by name {
        /// On the merging front, maybe on the boundary too.
        Front = "front",
        /// On a boundary, and on no front segment.
        Boundary = "boundary",
        /// Inside a face, and on no front segment.
        Inside = "inside",
    }
}

/// The places as words of conditions.
const PLACE: Holds = Holds::Words { words: &["front", "boundary", "inside"], short: &[] };

/// A node with its place and valence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeRow {
    /// Its id.
    pub node: NodeId,
    /// Coordinates in space.
    pub xyz: [f64; 3],
    /// Parametric coordinates.
    pub uv: [f64; 2],
    /// Number of edges.
    pub valence: u32,
    /// Whether it is irregular (docs/algorithm.md, "Clean-up"): `None` on a boundary, where the report counts none.
    pub is_irregular: Option<bool>,
    /// Where it is.
    pub place: NodePlace,
    /// Its face, from 1.
    pub face: u32,
    /// The steps that made it and changed it last.
    pub steps: Steps,
}

fields! {
    NodeRow;
    "id": Number, "number of the node" => |n| Value::number(n.node.0);
    "x": Number, "coordinate x in space" => |n| Value::number(n.xyz[0]);
    "y": Number, "coordinate y in space" => |n| Value::number(n.xyz[1]);
    "z": Number, "coordinate z in space" => |n| Value::number(n.xyz[2]);
    "u": Number, "parametric coordinate u" => |n| Value::number(n.uv[0]);
    "v": Number, "parametric coordinate v" => |n| Value::number(n.uv[1]);
    "valence": Number, "number of its edges" => |n| Value::number(n.valence);
    "irregular": Flag, "inside a face without four quadrilaterals, six triangles or an equivalent mixture around it" =>
        |n| Some(Value::Flag(n.is_irregular == Some(true)));
    "place": PLACE, "where it is" => |n| Some(Value::Word(n.place.name()));
    "face": Number, "face of the case, from 1" => |n| Value::number(n.face);
    "born": Number, "step that made it; 0 where the background mesh has it" =>
        |n| Value::number(n.steps.born as f64);
    "changed": Number, "last step that moved it or changed its edges; 0 where none did" =>
        |n| Value::number(n.steps.changed as f64);
}

impl NodeRow {
    /// Measures a node that these steps made and changed; `None` where it does not exist.
    pub fn of(mesh: &Mesh, node: NodeId, steps: Steps) -> Option<NodeRow> {
        if !mesh.has_node(node) {
            return None;
        }
        let uv = mesh.uv(node);
        let is_on_boundary = mesh.is_on_boundary(node);
        // A boundary node that the front passes has its front segment as the first or the last edge of its fan.
        let mut arriving = mesh.fan(node).map(|h| mesh.previous(h));
        let is_on_front = mesh.fan(node).any(|h| mesh.is_front(h)) || arriving.any(|h| mesh.is_front(h));
        let place = match (is_on_front, is_on_boundary) {
            (true, _) => NodePlace::Front,
            (false, true) => NodePlace::Boundary,
            (false, false) => NodePlace::Inside,
        };
        Some(NodeRow {
            node,
            xyz: mesh.xyz(node).to_array(),
            uv: [uv.x, uv.y],
            valence: mesh.valence(node) as u32,
            is_irregular: (!is_on_boundary).then(|| !mesh.is_regular(node)),
            place,
            face: mesh.elements_at(node).next().map_or(0, |e| mesh.region(e) + 1),
            steps,
        })
    }
}

impl Row for NodeRow {
    const FIELDS: &'static [Field] = FIELDS;

    fn value(&self, field: usize) -> Option<Value> {
        VALUES[field](self)
    }

    fn slots(mesh: &Mesh) -> usize {
        mesh.node_slots()
    }

    fn measure(mesh: &Mesh, slot: u32) -> Option<NodeRow> {
        NodeRow::of(mesh, NodeId(slot), Steps::default())
    }

    fn set_steps(&mut self, steps: Steps) {
        self.steps = steps;
    }

    fn last_change(changes: &LastChanges, slot: u32) -> u64 {
        changes.of_node(slot)
    }

    fn touched(mesh: &Mesh, changes: &Changes, touch: &mut dyn FnMut(u32)) {
        let Changes::Some { nodes, elements } = changes else { return };
        nodes.iter().for_each(|n| touch(n.0));
        // The front ends or begins at the nodes of an element that changes.
        for &e in elements.iter().filter(|&&e| mesh.has_element(e)) {
            mesh.corners(e).for_each(|n| touch(n.0));
        }
    }
}

/// The nodes of a state, kept up to date.
pub type NodeTable = Listed<NodeRow>;
