//! A mesh that a program makes in memory: how it is put together, and what is checked before it is used. Readers of
//! files check as much by themselves.

use glam::{DVec2, DVec3};

use super::counting::Counting;
use super::mesh_file::{Group, MeshFile};
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::tensor::check_sizes;
use crate::core::kernel::{Metric2, Metric3};

impl MeshFile {
    /// A mesh in the plane z = 0: points, and triangles by the indices of their points from 0, anticlockwise. Messages
    /// count from 0 too.
    pub fn in_plane<P: Into<DVec2>>(
        points: impl IntoIterator<Item = P>,
        triangles: impl IntoIterator<Item = [u32; 3]>,
    ) -> MeshFile {
        MeshFile::in_space(points.into_iter().map(|p| p.into().extend(0.0)), triangles)
    }

    /// A mesh in space, likewise; triangles are anticlockwise seen from outside.
    pub fn in_space<P: Into<DVec3>>(
        points: impl IntoIterator<Item = P>,
        triangles: impl IntoIterator<Item = [u32; 3]>,
    ) -> MeshFile {
        MeshFile {
            points: points.into_iter().map(Into::into).collect(),
            triangles: triangles.into_iter().collect(),
            counting: Counting::from_zero(),
            ..MeshFile::default()
        }
    }

    /// The mesh with a size at each point, the same in all directions, in units of its coordinates.
    ///
    /// # Errors
    /// Sizes that are not positive and finite, of the kind [`FaultKind::Metric`].
    pub fn with_sizes(self, sizes: impl IntoIterator<Item = f64>) -> Result<MeshFile, Fault> {
        let tensor = |(point, h): (usize, f64)| match check_sizes(&[h]) {
            Ok(()) => Ok(Metric3::isotropic(h)),
            Err(what) => {
                let fault = Fault::new(format!("The size at the point of index {point}: {what}"));
                Err(fault.of_kind(FaultKind::Metric).remedy("Sizes must be positive and finite"))
            }
        };
        let metric = sizes.into_iter().enumerate().map(tensor).collect::<Result<_, _>>()?;
        Ok(MeshFile { metric: Some(metric), ..self })
    }

    /// The mesh with a metric tensor of the plane at each point, in units of 1 / coordinate squared (eq. 3).
    #[must_use]
    pub fn with_plane_metric(self, metric: impl IntoIterator<Item = Metric2>) -> MeshFile {
        self.with_metric(metric.into_iter().map(|m| m.in_space()))
    }

    /// The mesh with a metric tensor of space at each point, in units of 1 / coordinate squared (eq. 2).
    #[must_use]
    pub fn with_metric(self, metric: impl IntoIterator<Item = Metric3>) -> MeshFile {
        MeshFile { metric: Some(metric.into_iter().collect()), ..self }
    }

    /// The mesh with a named region of triangles, by their indices. A triangle is in the last region that names it; the
    /// triangles of no region are a region too. Sides between regions are kept.
    ///
    /// # Errors
    /// An index of no triangle.
    pub fn with_region(
        mut self,
        name: impl Into<String>,
        triangles: impl IntoIterator<Item = usize>,
    ) -> Result<MeshFile, Fault> {
        let (name, tag) = (name.into(), self.free_tag(2));
        self.triangle_tags.resize(self.triangles.len(), 0);
        for triangle in triangles {
            let Some(own) = self.triangle_tags.get_mut(triangle) else {
                let n = self.triangles.len();
                let what = format!("The region \"{name}\" names triangle {triangle}, but there are only {n}");
                return Err(Fault::new(what).of_kind(FaultKind::Mesh).remedy("Indices count from 0"));
            };
            *own = tag;
        }
        self.groups.push(Group { dimension: 2, tag, name });
        Ok(self)
    }

    /// The mesh with a named line along sides of its triangles, each by the indices of its ends. The sides are kept,
    /// also inside a region.
    #[must_use]
    pub fn with_line(mut self, name: impl Into<String>, sides: impl IntoIterator<Item = [u32; 2]>) -> MeshFile {
        let tag = self.free_tag(1);
        self.line_tags.resize(self.lines.len(), 0);
        self.lines.extend(sides);
        self.line_tags.resize(self.lines.len(), tag);
        self.groups.push(Group { dimension: 1, tag, name: name.into() });
        self
    }

    fn free_tag(&self, dimension: u8) -> u32 {
        let own = self.groups.iter().filter(|group| group.dimension == dimension).map(|group| group.tag);
        let tags = if dimension == 1 { &self.line_tags } else { &self.triangle_tags };
        own.chain(tags.iter().copied()).max().unwrap_or(0) + 1
    }

    /// Whether its lists agree with each other.
    ///
    /// # Errors
    /// An element or line with a point that is not there; a polygon without three corners; tags or metric tensors that
    /// are more or fewer than what they belong to; members of groups that are not there; a tensor that is not positive
    /// definite and finite.
    pub(in crate::core) fn check_lists(&self) -> Result<(), Fault> {
        let n = self.points.len();
        let kinds: [(&str, &mut dyn Iterator<Item = &[u32]>); 4] = [
            ("line", &mut self.lines.iter().map(|l| &l[..])),
            ("triangle", &mut self.triangles.iter().map(|t| &t[..])),
            ("quadrilateral", &mut self.quads.iter().map(|q| &q[..])),
            ("polygon", &mut self.polygons.iter().map(|p| &p[..])),
        ];
        for (kind, elements) in kinds {
            for (i, corners) in elements.enumerate() {
                if let Some(bad) = corners.iter().find(|&&k| k as usize >= n) {
                    let what = format!("The {kind} of index {i} uses point {bad}, but there are only {n} points");
                    return Err(Fault::new(what).remedy("Indices count from 0"));
                }
                if kind == "polygon" && corners.len() < 3 {
                    let what = format!("The polygon of index {i} has {} corners", corners.len());
                    return Err(Fault::new(what).remedy("Leave it out"));
                }
            }
        }
        for (kind, tags, count) in [
            ("line", &self.line_tags, self.lines.len()),
            ("triangle", &self.triangle_tags, self.triangles.len()),
            ("quadrilateral", &self.quad_tags, self.quads.len()),
            ("polygon", &self.polygon_tags, self.polygons.len()),
        ] {
            if !tags.is_empty() && tags.len() != count {
                let what = format!("There are {} {kind} tags for {count} {kind}s", tags.len());
                return Err(Fault::new(what).remedy("Give one tag for each, or no tags"));
            }
        }
        let elements = self.triangles.len() + self.quads.len() + self.polygons.len();
        for members in &self.members {
            let count = [n, self.lines.len(), elements][usize::from(members.dimension.min(2))];
            if let Some(bad) = members.of.iter().find(|&&k| k as usize >= count) {
                let what = format!("The group with the tag {} has a member {bad} of only {count}", members.tag);
                return Err(Fault::new(what).remedy("Indices count from 0"));
            }
        }
        let metric = self.metric.as_deref().unwrap_or_default();
        if self.metric.is_some() && metric.len() != n {
            let what = format!("The metric has {} values for {n} points", metric.len());
            return Err(Fault::new(what).remedy("Give one value for each point"));
        }
        match metric.iter().position(|m| !m.is_spd()) {
            Some(point) => {
                let what = format!("The metric at the point of index {point} is not positive definite and finite");
                Err(Fault::new(what).of_kind(FaultKind::Metric).remedy("Its eigenvalues must be positive"))
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_triangles() -> MeshFile {
        MeshFile::in_plane([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], [[0, 1, 2], [0, 2, 3]])
    }

    #[test]
    fn lists_that_do_not_agree_are_refused_with_indices_from_0() {
        let of = |change: fn(&mut MeshFile)| {
            let mut mesh = two_triangles();
            change(&mut mesh);
            mesh.check_lists().unwrap_err().to_string()
        };
        assert!(two_triangles().check_lists().is_ok());
        assert!(of(|m| m.triangles.push([0, 1, 4])).contains("triangle of index 2 uses point 4"));
        assert!(of(|m| m.quads.push([0, 1, 2, 9])).contains("quadrilateral of index 0 uses point 9"));
        assert!(of(|m| m.lines.push([7, 0])).contains("line of index 0 uses point 7"));
        assert!(of(|m| m.polygons.push(vec![0, 1])).contains("polygon of index 0 has 2 corners"));
        assert!(of(|m| m.triangle_tags = vec![1]).contains("1 triangle tags for 2 triangles"));
        assert!(of(|m| m.metric = Some(Vec::new())).contains("has 0 values for 4 points"));
        let flat = Metric3 { xx: 1.0, xy: 2.0, xz: 0.0, yy: 1.0, yz: 0.0, zz: 1.0 };
        let fault = two_triangles().with_metric([flat; 4]).check_lists().unwrap_err();
        assert_eq!(fault.kind(), FaultKind::Metric);
    }

    #[test]
    fn groups_get_tags_of_their_own() {
        let mesh = two_triangles().with_region("left", [1]).unwrap().with_region("right", [0]).unwrap();
        let mesh = mesh.with_line("between", [[0, 2]]).with_line("floor", [[0, 1]]);
        assert_eq!((&mesh.triangle_tags[..], &mesh.line_tags[..]), (&[2, 1][..], &[1, 2][..]));
        assert_eq!((mesh.group_name(2, 1), mesh.group_name(1, 2)), (Some("left"), Some("floor")));
        assert!(two_triangles().with_region("left", [2]).is_err());
    }

    #[test]
    fn sizes_must_be_sizes() {
        let fault = two_triangles().with_sizes([1.0, -1.0, 1.0, 1.0]).unwrap_err();
        assert!(fault.kind() == FaultKind::Metric && fault.what.contains("index 1"), "{fault}");
    }
}
