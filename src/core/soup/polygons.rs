//! Triangulates quadrilaterals and polygons, since a conversion starts from triangles.
//!
//! Ears are clipped in the plane of the polygon's mean normal, the best-shaped ear first, so that nearly planar
//! polygons, convex or not, give triangles without inversions.

use glam::{DVec2, DVec3};

use super::mesh_file::{MeshFile, Texture};
use crate::core::kernel::predicates::orient;

impl MeshFile {
    /// Splits every quadrilateral and polygon into triangles, appended after the existing ones; returns the mesh and
    /// the number of elements split. One that cannot be triangulated (self-intersecting, or without area) is split as a
    /// fan, which later checks reject.
    #[must_use]
    pub fn triangulated(mut self) -> (MeshFile, usize) {
        let cut = self.quads.len() + self.polygons.len();
        if cut == 0 {
            return (self, 0);
        }
        if self.members.iter().any(|members| members.dimension == 2) {
            let origins = self.origins();
            for members in self.members.iter_mut().filter(|members| members.dimension == 2) {
                let is_in = |t: &u32| members.of.binary_search(&origins[*t as usize]).is_ok();
                members.of = (0..origins.len() as u32).filter(is_in).collect();
            }
        }
        let tagged = !self.triangle_tags.is_empty() || !self.quad_tags.is_empty() || !self.polygon_tags.is_empty();
        self.triangle_tags.resize(if tagged { self.triangles.len() } else { 0 }, 0);
        let quads = std::mem::take(&mut self.quads);
        let quad_tags = std::mem::take(&mut self.quad_tags);
        let polygons = std::mem::take(&mut self.polygons);
        let polygon_tags = std::mem::take(&mut self.polygon_tags);
        // The data belongs to the original elements.
        self.element_data.clear();
        let all = quads
            .iter()
            .map(|q| &q[..])
            .zip(tags(&quad_tags))
            .chain(polygons.iter().map(|p| &p[..]).zip(tags(&polygon_tags)));
        let mut texture = self.texture.take();
        let (quads_uv, polygons_uv) = texture
            .as_mut()
            .map_or_else(Default::default, |t| (std::mem::take(&mut t.quads), std::mem::take(&mut t.polygons)));
        let mut uv = quads_uv.iter().map(|q| &q[..]).chain(polygons_uv.iter().map(|p| &p[..]));
        for (polygon, tag) in all {
            let triangles = ears(&self.points, polygon);
            if tagged {
                self.triangle_tags.extend(std::iter::repeat_n(tag, triangles.len()));
            }
            if let (Some(texture), Some(corners)) = (&mut texture, uv.next()) {
                let corner = |k: usize| corners.get(k).copied().unwrap_or(Texture::NONE);
                texture.triangles.extend(triangles.iter().map(|t| t.map(corner)));
            }
            self.triangles.extend(triangles.iter().map(|t| t.map(|k| polygon[k])));
        }
        self.texture = texture;
        (self, cut)
    }
}

fn tags(tags: &[u32]) -> impl Iterator<Item = u32> + '_ {
    tags.iter().copied().chain(std::iter::repeat(0))
}

/// The triangles of one polygon, as positions in `polygon`.
fn ears(points: &[DVec3], polygon: &[u32]) -> Vec<[usize; 3]> {
    let p = |k: usize| points[polygon[k] as usize];
    let n = polygon.len();
    // Newell's normal: twice the area vector.
    let normal = (0..n).map(|k| (p(k) - p(0)).cross(p((k + 1) % n) - p(0))).sum::<DVec3>();
    let flat: Vec<DVec2> = match normal.try_normalize() {
        Some(normal) => {
            let (u, v) = normal.any_orthonormal_pair();
            (0..n).map(|k| DVec2::new((p(k) - p(0)).dot(u), (p(k) - p(0)).dot(v))).collect()
        }
        None => vec![DVec2::ZERO; n],
    };
    let mut left: Vec<usize> = (0..n).collect();
    let mut triangles = Vec::with_capacity(n.saturating_sub(2));
    while left.len() > 3 {
        let m = left.len();
        let mut best: Option<(f64, usize)> = None;
        for k in 0..m {
            let [i, j, l] = [left[(k + m - 1) % m], left[k], left[(k + 1) % m]];
            let [a, b, c] = [i, j, l].map(|k| flat[k]);
            let doubled = orient(a, b, c);
            let free = |&&o: &&usize| {
                let q = flat[o];
                ![i, j, l].contains(&o) && orient(a, b, q) >= 0.0 && orient(b, c, q) >= 0.0 && orient(c, a, q) >= 0.0
            };
            if doubled <= 0.0 || left.iter().any(|o| free(&o)) {
                continue;
            }
            // In a quadrilateral, both triangles at a diagonal count.
            let rest = if m == 4 { triangle_quality(c, flat[left[(k + 2) % m]], a) } else { 1.0 };
            let quality = triangle_quality(a, b, c).min(rest);
            if best.is_none_or(|(q, _)| quality > q) {
                best = Some((quality, k));
            }
        }
        let k = best.map_or(1, |(_, k)| k);
        triangles.push([left[(k + m - 1) % m], left[k], left[(k + 1) % m]]);
        left.remove(k);
    }
    triangles.push([left[0], left[1], left[2]]);
    triangles
}

/// 1 for an equilateral triangle, 0 for a degenerate one, negative for an inverted one.
fn triangle_quality(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let sides = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    2.0 * 3.0_f64.sqrt() * orient(a, b, c) / sides.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh(points: &[[f64; 2]], polygon: &[u32]) -> MeshFile {
        MeshFile {
            points: points.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect(),
            polygons: vec![polygon.to_vec()],
            polygon_tags: vec![7],
            ..MeshFile::default()
        }
    }

    fn doubled_areas(mesh: &MeshFile) -> Vec<f64> {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| mesh.points[k as usize].truncate());
            orient(a, b, c)
        };
        mesh.triangles.iter().map(area).collect()
    }

    #[test]
    fn a_concave_quadrilateral_is_split_at_its_reflex_corner() {
        let mut file = mesh(&[[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]], &[]);
        file.polygons.clear();
        file.polygon_tags.clear();
        file.quads = vec![[0, 1, 2, 3]];
        let (file, cut) = file.triangulated();
        assert_eq!(cut, 1);
        assert!(doubled_areas(&file).iter().all(|&a| a > 0.0), "{:?}", file.triangles);
        assert!(file.quads.is_empty() && file.triangle_tags.is_empty());
    }

    #[test]
    fn a_comb_is_split_into_triangles_that_cover_it_and_carry_its_tag() {
        let points = [[0.0, 0.0], [5.0, 0.0], [5.0, 3.0], [4.0, 1.0], [3.0, 3.0], [2.0, 1.0], [1.0, 3.0], [0.0, 1.0]];
        let (file, _) = mesh(&points, &[0, 1, 2, 3, 4, 5, 6, 7]).triangulated();
        let areas = doubled_areas(&file);
        assert_eq!(areas.len(), 6);
        assert!(areas.iter().all(|&a| a > 0.0));
        let shoelace: f64 = (0..8)
            .map(|k| {
                let (p, q) = (points[k], points[(k + 1) % 8]);
                p[0] * q[1] - p[1] * q[0]
            })
            .sum();
        assert!((areas.iter().sum::<f64>() - shoelace).abs() < 1e-12);
        assert_eq!(file.triangle_tags, [7; 6]);
    }

    #[test]
    fn a_polygon_of_one_repeated_point_is_split_as_a_fan() {
        let (file, _) = mesh(&[[1.0, 1.0]], &[0, 0, 0, 0, 0]).triangulated();
        assert_eq!(file.triangles.len(), 3);
    }
}
