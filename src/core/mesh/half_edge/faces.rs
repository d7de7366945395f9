//! Extraction of the faces of a mesh as separate meshes, and their reassembly: faces share output points, but no
//! elements or nodes, so that each can be converted independently.

use super::slots::Element;
use super::{Mesh, NONE};
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::mesh::journal::Journal;

/// A face extracted from a mesh, with the slots of its nodes and elements in that mesh.
pub struct FaceMesh {
    /// The face alone.
    pub mesh: Mesh,
    nodes: Vec<u32>,
    elements: Vec<u32>,
}

impl Mesh {
    /// The faces: the regions of the elements, ascending.
    pub fn faces(&self) -> Vec<u32> {
        let mut faces: Vec<u32> = self.elements().map(|e| self.region(e)).collect();
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// Whether there are no free slots: then the extracted faces have the ids of the whole, in their order.
    pub fn is_dense(&self) -> bool {
        self.free_nodes.is_empty() && self.free_elements.is_empty()
    }

    /// All faces as separate meshes, by ascending region; the journals are empty. The mesh must be dense.
    pub fn face_meshes(&self) -> Vec<FaceMesh> {
        let faces = self.faces();
        self.grouped(faces.len(), &|region| faces.binary_search(&region).ok())
    }

    /// The mesh of the faces with these regions. The mesh must be dense.
    #[must_use]
    pub fn of_faces(&self, regions: &[u32]) -> Mesh {
        let meshes = self.grouped(1, &|region| regions.contains(&region).then_some(0));
        meshes.into_iter().next().map_or_else(Mesh::default, |face| face.mesh)
    }

    /// One mesh for each group of regions; regions without a group are left out.
    fn grouped(&self, groups: usize, group_of: &dyn Fn(u32) -> Option<usize>) -> Vec<FaceMesh> {
        let (mut nodes, mut elements) = (vec![Vec::new(); groups], vec![Vec::new(); groups]);
        let (mut new_node, mut new_element) = (vec![NONE; self.places.len()], vec![NONE; self.sides.len()]);
        for e in self.elements() {
            if let Some(group) = group_of(self.region(e)) {
                new_element[e.index()] = elements[group].len() as u32;
                elements[group].push(e.0);
            }
        }
        for n in self.nodes() {
            if let Some(group) = group_of(self.region[(self.anchor[n.index()] >> 2) as usize]) {
                new_node[n.index()] = nodes[group].len() as u32;
                nodes[group].push(n.0);
            }
        }
        let extracted = |(nodes, elements): (Vec<u32>, Vec<u32>)| {
            let mesh = self.extract(&nodes, &elements, &new_node, &new_element);
            FaceMesh { mesh, nodes, elements }
        };
        nodes.into_iter().zip(elements).map(extracted).collect()
    }

    /// Puts changed faces back: their additional nodes and elements are appended face by face, as if the faces had been
    /// changed here one after another. The journal is empty afterwards.
    pub fn put_back(&mut self, faces: Vec<FaceMesh>) {
        for FaceMesh { mesh, nodes, elements } in faces {
            let (first_node, first_element) = (self.places.len(), self.sides.len());
            let node = |n: usize| nodes.get(n).map_or_else(|| first_node + n - nodes.len(), |&n| n as usize);
            let element =
                |e: usize| elements.get(e).map_or_else(|| first_element + e - elements.len(), |&e| e as usize);
            let half_edge = |h: u32| if h == NONE { NONE } else { (element(h as usize >> 2) as u32) << 2 | (h & 3) };
            let more_nodes = mesh.places.len() - nodes.len();
            let more_elements = mesh.sides.len() - elements.len();
            self.resize(first_node + more_nodes, first_element + more_elements);
            for own in 0..mesh.places.len() {
                let (uv, metric, anchor, point) = mesh.node_slot(NodeId(own as u32));
                self.put_node(node(own), (uv, metric, half_edge(anchor), point));
            }
            for own in 0..mesh.sides.len() {
                let slot = mesh.element_slot(ElementId(own as u32));
                let origin = slot.origin.map(|n| if n == NONE { NONE } else { node(n as usize) as u32 });
                self.put_element(element(own), &Element { origin, twin: slot.twin.map(half_edge), ..slot });
            }
            self.free_nodes.extend(mesh.free_nodes.iter().map(|n| NodeId(node(n.index()) as u32)));
            self.free_elements.extend(mesh.free_elements.iter().map(|e| ElementId(element(e.index()) as u32)));
            self.closed = [self.free_nodes.len() as u32, self.free_elements.len() as u32];
        }
        self.journal = Journal::default();
    }
}
