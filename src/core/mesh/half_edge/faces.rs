//! The faces of a mesh as meshes of their own, and all of them together again: faces share no element and no node, only output
//! points, so that each can be converted by itself.

use super::{Mesh, NONE};
use crate::core::mesh::ids::{ElementId, NodeId};
use crate::core::mesh::journal::Journal;

/// A face taken out of a mesh: its nodes and elements in their order, and which slots they have there.
pub struct Part {
    /// The face alone.
    pub mesh: Mesh,
    nodes: Vec<u32>,
    elements: Vec<u32>,
}

impl Mesh {
    /// The regions that elements have, ascending: the faces.
    pub fn faces(&self) -> Vec<u32> {
        let mut faces: Vec<u32> = self.elements().map(|e| self.region(e)).collect();
        faces.sort_unstable();
        faces.dedup();
        faces
    }

    /// Whether nothing is free: then parts have the ids of the whole, in their order.
    pub fn is_dense(&self) -> bool {
        self.free_nodes.is_empty() && self.free_elements.is_empty()
    }

    /// Every face as a mesh of its own, by ascending region; the journals are empty. The mesh must be dense.
    pub fn parts(&self) -> Vec<Part> {
        let faces = self.faces();
        self.grouped(faces.len(), &|region| faces.binary_search(&region).ok())
    }

    /// The faces of these regions alone. The mesh must be dense.
    #[must_use]
    pub fn of_faces(&self, regions: &[u32]) -> Mesh {
        let parts = self.grouped(1, &|region| regions.contains(&region).then_some(0));
        parts.into_iter().next().map_or_else(Mesh::default, |part| part.mesh)
    }

    /// The faces by the group that each region belongs to, if to any.
    fn grouped(&self, groups: usize, group_of: &dyn Fn(u32) -> Option<usize>) -> Vec<Part> {
        let (mut nodes, mut elements) = (vec![Vec::new(); groups], vec![Vec::new(); groups]);
        let (mut new_node, mut new_element) = (vec![NONE; self.uv.len()], vec![NONE; self.sides.len()]);
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
        let half_edge = |h: u32| if h == NONE { NONE } else { new_element[(h >> 2) as usize] << 2 | (h & 3) };
        let node = |n: u32| if n == NONE { NONE } else { new_node[n as usize] };
        let part = |(nodes, elements): (Vec<u32>, Vec<u32>)| {
            let slots = || elements.iter().flat_map(|&e| 4 * e as usize..4 * e as usize + 4);
            let mesh = Mesh {
                uv: nodes.iter().map(|&n| self.uv[n as usize]).collect(),
                metric: nodes.iter().map(|&n| self.metric[n as usize]).collect(),
                anchor: nodes.iter().map(|&n| half_edge(self.anchor[n as usize])).collect(),
                point: nodes.iter().map(|&n| self.point[n as usize]).collect(),
                origin: slots().map(|h| node(self.origin[h])).collect(),
                twin: slots().map(|h| half_edge(self.twin[h])).collect(),
                sides: elements.iter().map(|&e| self.sides[e as usize]).collect(),
                region: elements.iter().map(|&e| self.region[e as usize]).collect(),
                level: elements.iter().map(|&e| self.level[e as usize]).collect(),
                deferred: slots().map(|h| self.deferred[h]).collect(),
                first_level: self.first_level_in(&nodes),
                refusals: self.refusals,
                ground: self.ground.clone(),
                ..Mesh::default()
            };
            Part { mesh, nodes, elements }
        };
        nodes.into_iter().zip(elements).map(part).collect()
    }

    /// Puts the parts back that were taken out and have changed since: nodes and elements that they have more come after all that
    /// are there, part by part, as if the parts had been changed here one after another. The journal is empty then.
    pub fn put_back(&mut self, parts: Vec<Part>) {
        for Part { mesh, nodes, elements } in parts {
            let (first_node, first_element) = (self.uv.len(), self.sides.len());
            let node = |n: usize| nodes.get(n).map_or_else(|| first_node + n - nodes.len(), |&n| n as usize);
            let element =
                |e: usize| elements.get(e).map_or_else(|| first_element + e - elements.len(), |&e| e as usize);
            let half_edge = |h: u32| if h == NONE { NONE } else { (element(h as usize >> 2) as u32) << 2 | (h & 3) };
            let more_nodes = mesh.uv.len() - nodes.len();
            let more_elements = mesh.sides.len() - elements.len();
            self.uv.resize(first_node + more_nodes, glam::DVec2::ZERO);
            self.metric.resize(first_node + more_nodes, crate::core::kernel::tensor::Metric2::isotropic(1.0));
            self.anchor.resize(first_node + more_nodes, NONE);
            self.point.resize(first_node + more_nodes, NONE);
            self.origin.resize(4 * (first_element + more_elements), NONE);
            self.twin.resize(4 * (first_element + more_elements), NONE);
            self.deferred.resize(4 * (first_element + more_elements), false);
            self.sides.resize(first_element + more_elements, 0);
            self.region.resize(first_element + more_elements, 0);
            self.level.resize(first_element + more_elements, 0);
            for own in 0..mesh.uv.len() {
                let n = node(own);
                self.uv[n] = mesh.uv[own];
                self.metric[n] = mesh.metric[own];
                self.anchor[n] = half_edge(mesh.anchor[own]);
                self.point[n] = mesh.point[own];
            }
            for own in 0..mesh.sides.len() {
                let e = element(own);
                for k in 0..4 {
                    let origin = mesh.origin[4 * own + k];
                    self.origin[4 * e + k] = if origin == NONE { NONE } else { node(origin as usize) as u32 };
                    self.twin[4 * e + k] = half_edge(mesh.twin[4 * own + k]);
                    self.deferred[4 * e + k] = mesh.deferred[4 * own + k];
                }
                self.sides[e] = mesh.sides[own];
                self.region[e] = mesh.region[own];
                self.level[e] = mesh.level[own];
            }
            self.free_nodes.extend(mesh.free_nodes.iter().map(|n| NodeId(node(n.index()) as u32)));
            self.free_elements.extend(mesh.free_elements.iter().map(|e| ElementId(element(e.index()) as u32)));
            self.closed = [self.free_nodes.len() as u32, self.free_elements.len() as u32];
        }
        self.journal = Journal::default();
    }
}
