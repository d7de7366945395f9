//! Elements of second order: their corners stay in the mesh, and their other nodes beside it.

mod division;

use glam::DVec3;

pub(in crate::core) use division::Divided;

use super::counting::Count;
use super::mesh_file::{MeshFile, SecondOrder};

/// The nodes of elements of second order that are no corners, while a file is read: by indices of its points.
#[derive(Default)]
pub(in crate::core) struct Middles {
    /// The ends of a side, and its node.
    sides: Vec<([u32; 2], u32)>,
    /// The corners of a quadrilateral, and the node in its middle.
    centres: Vec<([u32; 4], u32)>,
    /// Nodes in the middle of triangles.
    others: Vec<u32>,
}

impl Middles {
    /// Adds an element of 2, 3 or 4 corners with the nodes of its sides, the first one between the first two corners,
    /// and then perhaps the one in its middle.
    pub fn add(&mut self, corners: &[u32], nodes: &[u32]) {
        let sides = if corners.len() == 2 { 1 } else { corners.len() };
        for (k, &node) in nodes.iter().enumerate() {
            match *corners {
                _ if k < sides => self.sides.push((key(corners[k], corners[(k + 1) % corners.len()]), node)),
                [a, b, c, d] => self.centres.push(([a, b, c, d], node)),
                _ => self.others.push(node),
            }
        }
    }

    /// Moves the nodes from the points of a mesh that is read to [`MeshFile::second_order`]. Those that are corners of
    /// other elements remain points, too.
    pub fn leave(self, mesh: &mut MeshFile) {
        let Middles { sides, centres, others } = self;
        let nodes = sides.iter().map(|side| side.1).chain(centres.iter().map(|centre| centre.1)).chain(others);
        let mut gone = vec![false; mesh.points.len()];
        let mut any = false;
        nodes.for_each(|node| (any, gone[node as usize]) = (true, true));
        if !any {
            return;
        }
        // Ends of sides, too, that no element has as corners: they are as much of the file as the side is.
        sides.iter().flat_map(|side| side.0).for_each(|end| gone[end as usize] = false);
        each_corner(mesh, |corner| gone[*corner as usize] = false);
        let mut next = 0..;
        let index: Vec<u32> = gone.iter().map(|&gone| if gone { 0 } else { next.next().unwrap_or(0) }).collect();
        let to = |k: u32| index[k as usize];
        let at = |node: u32| mesh.points[node as usize];
        // The order of kept points stays.
        let mut all = SecondOrder {
            sides: sides.iter().map(|&(ends, node)| (ends.map(to), at(node))).collect(),
            centres: centres.iter().map(|&(corners, node)| (corners.map(to), at(node))).collect(),
        };
        all.sides.sort_by_key(|side| side.0);
        all.sides.dedup_by_key(|side| side.0);
        all.centres.sort_by_key(|centre| centre.0);
        all.centres.dedup_by_key(|centre| centre.0);
        mesh.second_order = all;
        each_corner(mesh, |corner| *corner = to(*corner));
        let mut lost = 0;
        for members in mesh.members.iter_mut().filter(|members| members.dimension == 0) {
            let before = members.of.len();
            members.of.retain(|&point| !gone[point as usize]);
            members.of.iter_mut().for_each(|point| *point = to(*point));
            lost += before - members.of.len();
        }
        mesh.members.retain(|members| !members.of.is_empty());
        if lost > 0 {
            mesh.omit_many("point in a group", "at a mid-side node", lost);
        }
        if !matches!(mesh.counting.points, Count::Nothing) {
            let kept = (0..gone.len()).filter(|&k| !gone[k]);
            let numbers: Vec<u64> = kept.filter_map(|k| mesh.counting.points.number(k)).collect();
            mesh.counting.points = Count::of(&numbers);
        }
        keep(&mut mesh.points, &gone);
        mesh.metric.as_mut().into_iter().for_each(|metric| keep(metric, &gone));
        mesh.uv.as_mut().into_iter().for_each(|uv| keep(uv, &gone));
        mesh.point_data.iter_mut().for_each(|data| keep(&mut data.values, &gone));
    }
}

impl SecondOrder {
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.sides.is_empty() && self.centres.is_empty()
    }

    /// Multiplies their coordinates.
    pub(in crate::core) fn scale(&mut self, factor: f64) {
        self.sides.iter_mut().for_each(|side| side.1 *= factor);
        self.centres.iter_mut().for_each(|centre| centre.1 *= factor);
    }

    /// The node of a side.
    fn of_side(&self, a: u32, b: u32) -> Option<DVec3> {
        self.sides.binary_search_by_key(&key(a, b), |side| side.0).ok().map(|at| self.sides[at].1)
    }

    /// The node in the middle of a quadrilateral.
    fn of_quad(&self, corners: [u32; 4]) -> Option<DVec3> {
        self.centres.binary_search_by_key(&corners, |centre| centre.0).ok().map(|at| self.centres[at].1)
    }
}

/// The ends of a side, the smaller one first.
fn key(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

fn each_corner(mesh: &mut MeshFile, mut visit: impl FnMut(&mut u32)) {
    mesh.lines.as_flattened_mut().iter_mut().for_each(&mut visit);
    mesh.triangles.as_flattened_mut().iter_mut().for_each(&mut visit);
    mesh.quads.as_flattened_mut().iter_mut().for_each(&mut visit);
    mesh.polygons.iter_mut().flatten().for_each(visit);
}

fn keep<T>(values: &mut Vec<T>, gone: &[bool]) {
    let mut gone = gone.iter();
    values.retain(|_| gone.next() == Some(&false));
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::core::kernel::Metric3;
    use crate::core::soup::{Data, Members};

    #[test]
    fn nodes_that_are_no_corners_leave_the_points_and_all_that_belongs_to_points() {
        // Numbers 10 to 16: the triangle 0, 2, 4 with nodes 1, 3, 5; point 6 is used by nothing.
        let mut mesh = MeshFile {
            points: (0..7).map(|k| DVec3::splat(f64::from(k))).collect(),
            triangles: vec![[0, 2, 4]],
            lines: vec![[2, 4]],
            members: vec![
                Members { dimension: 0, tag: 1, of: vec![3] },
                Members { dimension: 0, tag: 2, of: vec![1, 4] },
                Members { dimension: 2, tag: 3, of: vec![0] },
            ],
            metric: Some((1..8).map(|k| Metric3::isotropic(f64::from(k))).collect()),
            uv: Some((0..7).map(|k| DVec2::splat(f64::from(k))).collect()),
            point_data: vec![Data { name: "heat".into(), values: (0..7).map(f64::from).collect() }],
            ..MeshFile::default()
        };
        mesh.counting.points = Count::From(10);
        let mut middles = Middles::default();
        middles.add(&[0, 2, 4], &[1, 3, 5]);
        middles.add(&[2, 4], &[3]);
        middles.leave(&mut mesh);
        let values = [0.0, 2.0, 4.0, 6.0];
        assert_eq!(mesh.points, values.map(DVec3::splat));
        assert_eq!((&mesh.triangles[..], &mesh.lines[..]), (&[[0, 1, 2]][..], &[[1, 2]][..]));
        let sides = [([0, 1], 1.0), ([0, 2], 5.0), ([1, 2], 3.0)].map(|(ends, x)| (ends, DVec3::splat(x)));
        assert_eq!(mesh.second_order, SecondOrder { sides: sides.to_vec(), centres: Vec::new() });
        assert_eq!(mesh.point_data[0].values, values);
        assert_eq!(mesh.uv.as_ref().unwrap()[..], values.map(DVec2::splat));
        assert_eq!(mesh.metric.as_ref().unwrap()[..], values.map(|k| Metric3::isotropic(k + 1.0)));
        assert_eq!(
            mesh.members,
            [(0, 2, 2), (2, 3, 0)].map(|(dimension, tag, k)| Members { dimension, tag, of: vec![k] })
        );
        assert_eq!(mesh.describe_points(&[1, 3]), "points 12 and 16");
        let told = ["point in a group at a mid-side node (2 times)", "point data heat"];
        assert_eq!(mesh.not_read()[..2], told.map(|words| format!("not read: {words}")));
        assert_eq!(mesh.not_read()[2], "not read: mid-side node of an element of order 2 (3 times)");
    }

    #[test]
    fn a_node_that_is_a_corner_elsewhere_remains_a_point() {
        let points: Vec<DVec3> = (0..4).map(|k| DVec3::splat(f64::from(k))).collect();
        let mut mesh = MeshFile { points, triangles: vec![[0, 1, 2], [1, 2, 3]], ..MeshFile::default() };
        let mut middles = Middles::default();
        middles.add(&[0, 1, 2], &[3]);
        middles.leave(&mut mesh);
        assert_eq!((mesh.points.len(), mesh.second_order.of_side(1, 0)), (4, Some(DVec3::splat(3.0))));
    }
}
