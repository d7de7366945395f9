//! Orthographic pictures of meshes in space, by default slightly from above. Of areas and lines the visible parts are
//! drawn; hidden parts of lines are left out or drawn more faintly.

mod cover;

use glam::{DVec2, DVec3};

pub use self::cover::{Cover, OnFaces, SeenFace};
use super::camera::Bearing;
use super::look::HiddenLines;
use super::picture::{Area, Line, Picture, Role};
use crate::core::soup::MeshFile;

/// The direction of a view.
#[derive(Clone, Copy, Debug)]
pub struct View {
    right: DVec3,
    up: DVec3,
    towards: DVec3,
}

impl View {
    /// The view from a side.
    pub fn from(side: Bearing) -> View {
        let [(sin_a, cos_a), (sin_e, cos_e), (sin_r, cos_r)] = side.angles().map(|a| libm::sincos(a.to_radians()));
        let right = DVec3::new(cos_a, sin_a, 0.0);
        let up = DVec3::new(-sin_e * sin_a, sin_e * cos_a, cos_e);
        View {
            right: right * cos_r - up * sin_r,
            up: right * sin_r + up * cos_r,
            towards: DVec3::new(cos_e * sin_a, -cos_e * cos_a, sin_e),
        }
    }

    /// The position of a point in the picture.
    pub fn place(&self, p: DVec3) -> DVec2 {
        DVec2::new(p.dot(self.right), p.dot(self.up))
    }

    /// The position of a point in the picture, and its nearness to the viewer.
    pub fn seen(&self, p: DVec3) -> DVec3 {
        self.place(p).extend(p.dot(self.towards))
    }
}

/// Whether a mesh lies in a plane z = constant and needs no projection.
pub fn is_flat(mesh: &MeshFile) -> bool {
    mesh.points.windows(2).all(|w| w[0].z == w[1].z)
}

/// The mesh with its points projected to the picture.
pub fn flattened(mesh: &MeshFile, view: &View) -> MeshFile {
    let points = mesh.points.iter().map(|p| view.place(*p).extend(0.0)).collect();
    MeshFile { points, ..mesh.clone() }
}

/// Reverses areas seen from behind, so that all run anticlockwise and overlapping areas of one path do not cancel.
pub fn turn_over(picture: &mut Picture) {
    for area in &mut picture.areas {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| area.outline[k.min(area.outline.len() - 1)]);
        if (c - a).perp_dot(d - b) < 0.0 {
            area.outline[1..].reverse();
        }
    }
}

/// A mesh in a view.
pub struct Orthographic {
    view: View,
    cover: Cover,
}

impl Orthographic {
    /// The mesh from a side. Its faces are numbered: triangles first, then quadrilaterals.
    pub fn of(mesh: &MeshFile, view: View) -> Orthographic {
        let faces = mesh.triangles.iter().map(|t| &t[..]).chain(mesh.quads.iter().map(|q| &q[..]));
        let cover = Cover::of(faces.map(|nodes| nodes.iter().map(|&n| view.seen(mesh.points[n as usize])).collect()));
        Orthographic { view, cover }
    }

    /// The direction of view.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Leaves of each area what is seen of it. The picture must have one area for each face, in their order.
    pub fn clip_areas(&self, picture: &mut Picture) {
        let whole = std::mem::take(&mut picture.areas);
        for (face, area) in whole.into_iter().enumerate() {
            match self.cover.seen(face) {
                SeenFace::Whole => picture.areas.push(area),
                SeenFace::Parts(outlines) => picture
                    .areas
                    .extend(outlines.into_iter().map(|outline| Area { role: area.role, outline: outline.into() })),
            }
        }
    }

    /// Removes the hidden parts of lines, or marks them as hidden. `ends` gives the end points of each line in space.
    pub fn clip_lines(&self, picture: &mut Picture, ends: &[[DVec3; 2]], hidden: HiddenLines) {
        let mut lines = Vec::with_capacity(picture.lines.len());
        for (line, ends) in picture.lines.iter().zip(ends) {
            let [a, b] = ends.map(|p| self.view.seen(p));
            let on = if line.role == Role::Refused { OnFaces::Diagonal } else { OnFaces::Along };
            for (shares, is_hidden) in self.cover.parts([a, b], on) {
                if !is_hidden || hidden != HiddenLines::Off {
                    lines.push(Line {
                        ends: shares.map(|t| a.lerp(b, t).truncate()),
                        hidden: is_hidden,
                        ..line.clone()
                    });
                }
            }
        }
        picture.lines = lines;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_and_the_window_look_from_the_same_sides() {
        for side in [Bearing::Iso, Bearing::X, Bearing::Y, Bearing::Z, Bearing::Angles([-70.0, -20.0, 33.0])] {
            let (view, turn) = (View::from(side), side.turn());
            let p = DVec3::new(0.3, -1.1, 2.0);
            assert!((turn * p).distance(view.seen(p)) < 1e-12, "{side}");
        }
    }

    #[test]
    fn a_line_behind_an_element_is_left_out_and_one_before_it_is_drawn() {
        let view = View::from(Bearing::Iso);
        let corner = |x: f64, y: f64, z: f64| view.right * x + view.up * y + view.towards * z;
        let mesh = MeshFile {
            points: vec![corner(0.0, 0.0, 0.0), corner(4.0, 0.0, 0.0), corner(4.0, 4.0, 0.0), corner(0.0, 4.0, 0.0)],
            quads: vec![[0, 1, 2, 3]],
            ..MeshFile::default()
        };
        let line = |z: f64| [corner(-2.0, 2.0, z), corner(2.0, 2.0, z)];
        let drawn = |z: f64, hidden: HiddenLines| {
            let ends = line(z);
            let one = Line { role: Role::DeadEdge, ends: ends.map(|p| view.place(p)), room: 1.0, hidden: false };
            let mut picture = Picture { lines: vec![one], ..Picture::default() };
            Orthographic::of(&mesh, view).clip_lines(&mut picture, &[ends], hidden);
            picture.lines
        };
        for hidden in HiddenLines::ALL {
            assert_eq!(drawn(1.0, hidden).len(), 1);
        }
        let behind = drawn(-1.0, HiddenLines::Off);
        assert_eq!(behind.len(), 1);
        assert!(behind[0].ends[1].x.abs() < 1e-12, "it ends where the element begins: {behind:?}");
        let faint = drawn(-1.0, HiddenLines::Faint);
        assert_eq!(faint.iter().map(|line| line.hidden).collect::<Vec<_>>(), [false, true]);
        assert_eq!((&faint[0], faint[1].ends[0]), (&behind[0], behind[0].ends[1]));
    }
}
