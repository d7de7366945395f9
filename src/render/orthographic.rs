//! Orthographic pictures of meshes in space, by default slightly from above. Areas (each of one colour) are drawn
//! unless entirely hidden. Of every line the visible parts are drawn; the hidden parts are left out or drawn more
//! faintly.

use glam::{DVec2, DVec3};

use super::camera::Bearing;
use super::look::HiddenLines;
use super::picture::{Line, Picture};
use crate::core::soup::MeshFile;

/// The number of parts of a line that are tested for visibility.
const PARTS: usize = 12;
/// The test points of an area lie at this share of the way from its corners to its centre.
const WITHIN: f64 = 0.05;

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

    /// Its nearness to the viewer.
    fn depth(&self, p: DVec3) -> f64 {
        p.dot(self.towards)
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
        let [a, b, c, d] = area.corners;
        if (c - a).perp_dot(d - b) < 0.0 {
            area.corners = if c == d { [a, c, b, b] } else { [a, d, c, b] };
        }
    }
}

/// The elements of a mesh as triangles in the picture, sorted into the cells of a grid, for visibility tests.
pub struct Cover {
    view: View,
    triangles: Vec<[DVec3; 3]>,
    cells: Vec<Vec<u32>>,
    low: DVec2,
    cell: f64,
    columns: usize,
    rows: usize,
    /// Differences in depth below this do not count.
    thickness: f64,
}

impl Cover {
    /// The elements of a mesh that hide others in a view.
    pub fn of(mesh: &MeshFile, view: View) -> Cover {
        let at = |n: u32| {
            let p = mesh.points[n as usize];
            view.place(p).extend(view.depth(p))
        };
        let halves = mesh.quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let triangles: Vec<[DVec3; 3]> = mesh.triangles.iter().copied().chain(halves).map(|t| t.map(at)).collect();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for p in triangles.iter().flatten() {
            (low, high) = (low.min(*p), high.max(*p));
        }
        let extent = (high - low).max(DVec3::splat(f64::MIN_POSITIVE));
        let cell = (extent.x * extent.y / (triangles.len().max(1) as f64)).sqrt().max(1e-3 * extent.max_element());
        let (columns, rows) = ((extent.x / cell) as usize + 1, (extent.y / cell) as usize + 1);
        let mut cover = Cover {
            view,
            triangles,
            cells: vec![Vec::new(); columns * rows],
            low: low.truncate(),
            cell,
            columns,
            rows,
            thickness: 4e-3 * extent.max_element(),
        };
        for (t, corners) in cover.triangles.iter().enumerate() {
            let least = corners.iter().fold(DVec3::INFINITY, |m, p| m.min(*p));
            let greatest = corners.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
            let [(c0, r0), (c1, r1)] = [least, greatest].map(|p| cover.cell_of(p.truncate()));
            for row in r0..=r1 {
                for column in c0..=c1 {
                    cover.cells[row * columns + column].push(t as u32);
                }
            }
        }
        cover
    }

    /// The direction of view.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Removes areas that are entirely hidden. The picture must have one area for each triangle, then for each
    /// quadrilateral.
    pub fn hide_areas(&self, picture: &mut Picture, mesh: &MeshFile) {
        let elements = mesh.triangles.iter().map(|t| &t[..]).chain(mesh.quads.iter().map(|q| &q[..]));
        let mut shows = elements.map(|nodes| {
            let places = || nodes.iter().map(|&n| mesh.points[n as usize]);
            let middle = places().sum::<DVec3>() / nodes.len() as f64;
            // Neighbours may hide a corner itself: test points a little inside.
            !places().map(|p| p.lerp(middle, WITHIN)).chain([middle]).all(|p| self.hides(p))
        });
        picture.areas.retain(|_| shows.next().unwrap_or(true));
    }

    /// Removes the hidden parts of lines, or marks them as hidden. `ends` gives the end points of each line in space.
    pub fn hide_lines(&self, picture: &mut Picture, ends: &[[DVec3; 2]], hidden: HiddenLines) {
        let mut lines = Vec::with_capacity(picture.lines.len());
        for (line, [a, b]) in picture.lines.iter().zip(ends) {
            let at = |i: usize| a.lerp(*b, i as f64 / PARTS as f64);
            let is_hidden: [bool; PARTS] = std::array::from_fn(|i| self.hides(at(i).midpoint(at(i + 1))));
            let mut from = 0;
            for same in is_hidden.chunk_by(|a, b| a == b) {
                let to = from + same.len();
                if !same[0] || hidden != HiddenLines::Off {
                    let ends = [from, to].map(|i| self.view.place(at(i)));
                    lines.push(Line { ends, hidden: same[0], ..line.clone() });
                }
                from = to;
            }
        }
        picture.lines = lines;
    }

    fn cell_of(&self, p: DVec2) -> (usize, usize) {
        let q = ((p - self.low) / self.cell).floor().max(DVec2::ZERO);
        ((q.x as usize).min(self.columns - 1), (q.y as usize).min(self.rows - 1))
    }

    /// Whether an element lies in front of the point.
    fn hides(&self, p: DVec3) -> bool {
        let (place, depth) = (self.view.place(p), self.view.depth(p));
        let (column, row) = self.cell_of(place);
        self.cells[row * self.columns + column].iter().any(|&t| {
            let [a, b, c] = self.triangles[t as usize];
            let area = (b - a).truncate().perp_dot((c - a).truncate());
            if area == 0.0 {
                return false;
            }
            let share = |p: DVec2, q: DVec2| (q - p).perp_dot(place - p) / area;
            let (w_c, w_a) = (share(a.truncate(), b.truncate()), share(b.truncate(), c.truncate()));
            let w_b = 1.0 - w_a - w_c;
            w_a >= 0.0 && w_b >= 0.0 && w_c >= 0.0 && w_a * a.z + w_b * b.z + w_c * c.z > depth + self.thickness
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::picture::Role;

    #[test]
    fn figures_and_the_window_look_from_the_same_sides() {
        for side in [Bearing::Iso, Bearing::X, Bearing::Y, Bearing::Z, Bearing::Angles([-70.0, -20.0, 33.0])] {
            let (view, turn) = (View::from(side), side.turn());
            let p = DVec3::new(0.3, -1.1, 2.0);
            assert!((turn * p).distance(view.place(p).extend(view.depth(p))) < 1e-12, "{side}");
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
            Cover::of(&mesh, view).hide_lines(&mut picture, &[ends], hidden);
            picture.lines
        };
        for hidden in HiddenLines::ALL {
            assert_eq!(drawn(1.0, hidden).len(), 1);
        }
        let behind = drawn(-1.0, HiddenLines::Off);
        assert_eq!(behind.len(), 1);
        assert!((behind[0].ends[1].x).abs() < 0.2, "{behind:?}");
        let faint = drawn(-1.0, HiddenLines::Faint);
        assert_eq!(faint.iter().map(|line| line.hidden).collect::<Vec<_>>(), [false, true]);
        assert_eq!((&faint[0], faint[1].ends[0]), (&behind[0], behind[0].ends[1]));
    }
}
