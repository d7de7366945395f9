//! What is to be seen: areas and lines with a role, in the coordinates of the mesh. Deliberately absent: colours, widths,
//! pixels (`palette` and the writers know them).

use glam::{DVec2, DVec3};

use super::orthographic::{self, View};

use crate::core::convert::parameters::Parameters;
use crate::core::convert::phase::Base;
use crate::core::front::segment::Segment;
use crate::core::io::export::Export;
use crate::core::io::mesh_file::MeshFile;
use crate::core::mesh::half_edge::Mesh;

/// What an area or a line is; writers draw in the order of [`Role::ALL`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// A triangle that is still unconverted.
    LiveTriangle,
    /// A quadrilateral of the result.
    DeadQuad,
    /// An edge between live triangles.
    LiveEdge,
    /// An edge of a quadrilateral.
    DeadEdge,
    /// An edge of the boundary, a crack or a line inside.
    Boundary,
    /// A segment of the merging front, with its class of table 1 (1 to 4).
    Front(u8),
    /// The base segment of the quadrilateral at hand.
    Base,
}

impl Role {
    /// All roles from back to front.
    pub const ALL: [Role; 10] = [
        Role::LiveTriangle,
        Role::DeadQuad,
        Role::LiveEdge,
        Role::DeadEdge,
        Role::Boundary,
        Role::Front(4),
        Role::Front(3),
        Role::Front(2),
        Role::Front(1),
        Role::Base,
    ];
}

/// An area: three or four corners, anticlockwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// What it is.
    pub role: Role,
    /// Corners; a triangle's last one is there twice.
    pub corners: [DVec2; 4],
}

/// A straight line.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What it is.
    pub role: Role,
    /// Ends.
    pub ends: [DVec2; 2],
    /// The least height over this line of the elements beside it, in the units of the mesh: how much room it has.
    pub room: f64,
}

/// A picture: areas, then lines over them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// One line on what it shows.
    pub title: String,
    /// More on what it shows: the case and its parameters.
    pub description: String,
    /// Areas.
    pub areas: Vec<Area>,
    /// Lines, each edge once.
    pub lines: Vec<Line>,
}

/// One side of an element on its way to a line.
struct Side {
    edge: [u32; 2],
    role: Role,
    room: f64,
}

impl Picture {
    /// The picture of a mesh: elements by kind, edges once, the boundary and lines inside over them. A mesh in a plane z =
    /// constant is seen from +z, one in space as `orthographic` has it.
    ///
    /// An edge is of the boundary where one element has it or where the mesh has a line there.
    pub fn of_mesh(mesh: &MeshFile) -> Picture {
        if orthographic::is_flat(mesh) {
            return Picture::as_it_lies(mesh).0;
        }
        let view = View::usual();
        let (mut picture, edges) = Picture::as_it_lies(&orthographic::flattened(mesh, &view));
        let ends: Vec<[DVec3; 2]> = edges.iter().map(|e| e.map(|n| mesh.points[n as usize])).collect();
        orthographic::turn_over(&mut picture);
        orthographic::hide(&mut picture, &ends, mesh, &view);
        picture
    }

    /// The picture of a mesh in the plane, and the nodes of each line.
    fn as_it_lies(mesh: &MeshFile) -> (Picture, Vec<[u32; 2]>) {
        let at = |n: u32| mesh.points[n as usize].truncate();
        let mut picture = Picture::default();
        let mut sides = Vec::with_capacity(mesh.triangles.len() * 3 + mesh.quads.len() * 4 + mesh.lines.len());
        let mut element = |nodes: &[u32], area_role, edge_role| {
            let corner = |k: usize| at(nodes[k.min(nodes.len() - 1)]);
            picture.areas.push(Area { role: area_role, corners: [corner(0), corner(1), corner(2), corner(3)] });
            for (k, &a) in nodes.iter().enumerate() {
                let b = nodes[(k + 1) % nodes.len()];
                let along = at(b) - at(a);
                let height = |n: u32| (along.perp_dot(at(n) - at(a)) / along.length()).abs();
                let others = nodes.iter().filter(|n| **n != a && **n != b);
                // A quadrilateral's two other corners may stand at different heights; the mean tells how crowded it is.
                let room = others.map(|n| height(*n)).sum::<f64>() / (nodes.len() - 2) as f64;
                sides.push(Side { edge: [a.min(b), a.max(b)], role: edge_role, room });
            }
        };
        mesh.triangles.iter().for_each(|t| element(t, Role::LiveTriangle, Role::LiveEdge));
        mesh.quads.iter().for_each(|q| element(q, Role::DeadQuad, Role::DeadEdge));
        let line =
            |l: &[u32; 2]| Side { edge: [l[0].min(l[1]), l[0].max(l[1])], role: Role::Boundary, room: f64::INFINITY };
        // The front of a state is no line of the mesh, and its classes are not in the file.
        let front: Vec<usize> = mesh.front_lines().collect();
        sides.extend(
            mesh.lines.iter().enumerate().filter(|(i, _)| front.binary_search(i).is_err()).map(|(_, l)| line(l)),
        );
        sides.sort_by_key(|side| side.edge);
        let mut edges = Vec::new();
        for same in sides.chunk_by(|a, b| a.edge == b.edge) {
            let highest = same.iter().map(|s| s.role).max().expect("a chunk is never empty");
            let role = if same.len() == 1 { Role::Boundary } else { highest };
            let room = same.iter().map(|s| s.room).fold(f64::INFINITY, f64::min);
            picture.lines.push(Line { role, ends: same[0].edge.map(at), room });
            edges.push(same[0].edge);
        }
        (picture, edges)
    }

    /// The picture of a conversion on the way: the mesh, over it the front by the classes of table 1, and the base segment
    /// where there is one.
    pub fn of_state(mesh: &Mesh, parameters: &Parameters, base: Option<&Base>) -> Picture {
        let file = Export::of(mesh, &[]).file;
        let mut picture = Picture::of_mesh(&file);
        let base = base.and_then(|base| mesh.front_between(base.a, base.b));
        let view = mesh.ground().map(|_| View::usual());
        let (mut front, mut space) = (Picture::default(), Vec::new());
        for h in mesh.front() {
            let segment = Segment::measure(mesh, h, parameters);
            let role = if base == Some(h) { Role::Base } else { Role::Front(segment.class) };
            let in_space = [segment.a, segment.b].map(|n| mesh.xyz(n));
            let ends = in_space.map(|p| view.map_or(p.truncate(), |view| view.place(p)));
            front.lines.push(Line { role, ends, room: f64::INFINITY });
            space.push(in_space);
        }
        if let Some(view) = &view {
            orthographic::hide(&mut front, &space, &file, view);
        }
        picture.lines.append(&mut front.lines);
        picture
    }

    /// The least and greatest coordinates of what is shown; `None` for an empty picture.
    pub fn bounds(&self) -> Option<[DVec2; 2]> {
        let points = self.areas.iter().flat_map(|a| a.corners).chain(self.lines.iter().flat_map(|l| l.ends));
        let points = points.filter(|p| p.is_finite());
        points.map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::mesh::ids::{NodeId, PointId};
    use crate::core::mesh::triangle_set::TriangleSet;
    use crate::core::metric::tensor::Metric2;
    use glam::DVec3;

    /// Two triangles beside a quadrilateral, with a line between them.
    fn mixed() -> MeshFile {
        let points = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
        MeshFile {
            points: points.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
            lines: vec![[4, 1]],
            triangles: vec![[1, 2, 5], [1, 5, 4]],
            quads: vec![[0, 1, 4, 3]],
            ..MeshFile::default()
        }
    }

    #[test]
    fn every_edge_is_there_once_with_the_role_of_its_elements() {
        let picture = Picture::of_mesh(&mixed());
        assert_eq!(picture.areas.len(), 3);
        let count = |role| picture.lines.iter().filter(|l| l.role == role).count();
        assert_eq!((count(Role::Boundary), count(Role::LiveEdge), count(Role::DeadEdge)), (7, 1, 0));
        assert_eq!(picture.bounds(), Some([DVec2::ZERO, DVec2::new(2.0, 1.0)]));
    }

    #[test]
    fn a_state_shows_every_front_segment_once_by_its_class_and_the_base_on_top() {
        let uv = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| DVec2::new(x, y)).to_vec();
        let point = (0..4).map(PointId).collect();
        let set = TriangleSet {
            uv,
            point,
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            region: vec![0; 2],
            ..TriangleSet::default()
        };
        let mesh = Mesh::from_triangles(&set, vec![Metric2::isotropic(1.0); 4]);
        let base = Base { a: NodeId(0), b: NodeId(1), theta: [1.5; 2], length: 1.0, level: 0 };
        let picture = Picture::of_state(&mesh, &Parameters::default(), Some(&base));
        let count = |role| picture.lines.iter().filter(|l| l.role == role).count();
        assert_eq!(
            (count(Role::Front(1)), count(Role::Base), count(Role::LiveEdge), count(Role::Boundary)),
            (3, 1, 1, 4)
        );
        let place = |role| Role::ALL.iter().position(|r| *r == role);
        assert!(place(Role::Base) > place(Role::Front(1)) && place(Role::Front(1)) > place(Role::Boundary));
    }

    #[test]
    fn an_edge_has_the_room_of_the_lower_element_beside_it() {
        let mut mesh = mixed();
        mesh.lines.clear();
        mesh.points[2].x = 1.25;
        mesh.points[5].x = 1.25;
        let picture = Picture::of_mesh(&mesh);
        let shared = picture.lines.iter().find(|l| l.ends == [DVec2::new(1.0, 0.0), DVec2::new(1.0, 1.0)]).unwrap();
        assert_eq!((shared.role, shared.room), (Role::DeadEdge, 0.25));
    }
}
