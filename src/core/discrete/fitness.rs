//! Whether the triangles of a mesh are elements, or only draw a shape (docs/algorithm.md, "Triangles that only draw a
//! shape").

use glam::DVec3;

use super::edges::{Edges, Triangles};
use super::features::{ANGLE, features, with_lines};
use crate::core::fault::Fault;
use crate::core::progress::Cancel;
use crate::core::soup::MeshFile;

/// A triangle is slender if its longest side is more than this many times its height.
const SLENDER: f64 = 10.0;
/// Of a mesh that only draws a shape at least this part of the triangles are slender and span their face.
const LEAST_SHARE: f64 = 0.5;

/// How many triangles of a mesh only draw its shape: slender ones with all corners on borders or features, as programs
/// for CAD divide the faces of a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fitness {
    /// Slender triangles that span their face.
    pub spanning: usize,
    /// All triangles.
    pub all: usize,
}

impl Fitness {
    /// Counts the triangles of a surface.
    pub fn of(mesh: &Triangles, edges: &Edges) -> Fitness {
        let all = mesh.triangles.len();
        let slender: Vec<usize> = (0..all).filter(|&t| is_slender(mesh.corners(t))).collect();
        if !is_most(slender.len(), all) {
            return Fitness { spanning: 0, all };
        }
        let mut on_feature = vec![false; mesh.points.len()];
        let found = with_lines(features(mesh, edges, ANGLE), mesh, edges);
        for edge in (0..edges.len()).filter(|&edge| found[edge].is_some()) {
            edges.get(edge).ends.into_iter().for_each(|end| on_feature[end as usize] = true);
        }
        let spans = |t: &&usize| mesh.triangles[**t].iter().all(|&corner| on_feature[corner as usize]);
        Fitness { spanning: slender.iter().filter(spans).count(), all }
    }

    /// Why the repaired mesh of a file only draws a shape, without a full stop; `None` where its triangles are
    /// elements.
    ///
    /// # Errors
    /// [`Fault::stopped`].
    pub fn reason_of(file: &MeshFile, mesh: &Triangles, cancel: &Cancel) -> Result<Option<String>, Fault> {
        if !Fitness::is_open(file) {
            return Ok(None);
        }
        Ok(Fitness::of(mesh, &Edges::unless(&mesh.triangles, cancel)?).reason())
    }

    /// Whether a file may only draw a shape, before it is repaired: it has enough slender triangles. With sizes at its
    /// points, or elements of other kinds, it is of an analysis.
    pub fn is_open(file: &MeshFile) -> bool {
        let corner = |k: u32| file.points.get(k as usize).copied();
        let corners = |t: &&[u32; 3]| match t.map(corner) {
            [Some(a), Some(b), Some(c)] => is_slender([a, b, c]),
            _ => false,
        };
        // Triangles without an area are removed by the repair.
        file.metric.is_none()
            && file.quads.is_empty()
            && file.polygons.is_empty()
            && is_most(2 * file.triangles.iter().filter(corners).count(), file.triangles.len())
    }

    fn reason(&self) -> Option<String> {
        let percent = 100 * self.spanning / self.all.max(1);
        is_most(self.spanning, self.all)
            .then(|| format!("{percent} % of its triangles are slenderer than 1:{SLENDER} and span their face"))
    }
}

fn is_most(count: usize, all: usize) -> bool {
    count > 0 && count as f64 >= LEAST_SHARE * all as f64
}

fn is_slender([a, b, c]: [DVec3; 3]) -> bool {
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
    // Twice the area is the longest side times its height.
    longest > SLENDER * (b - a).cross(c - a).length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::fixtures::{cube, plate, sphere, strip, tube};

    fn reason(mesh: &Triangles) -> Option<String> {
        Fitness::of(mesh, &Edges::of(&mesh.triangles)).reason()
    }

    #[test]
    fn strips_that_span_their_face_draw_a_shape_and_triangles_between_points_inside_are_elements() {
        // Squares of 1 by 12 and 1 by 8.
        assert!(reason(&strip(20, 12.0)).unwrap().starts_with("100 % of its triangles are slenderer than 1:10"));
        assert_eq!(reason(&strip(20, 8.0)), None);
        // A tube of one row of long triangles, and of rows as flat, inside.
        assert!(reason(&tube(24, 1, 8.0)).is_some());
        assert_eq!(reason(&tube(24, 6, 48.0)), None);
        for mesh in [cube(1), cube(4), sphere(6), plate(6, 0.1)] {
            assert_eq!(reason(&mesh), None);
        }
        assert_eq!(reason(&Triangles::default()), None);
    }
}
