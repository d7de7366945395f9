//! The names of the faces of a mesh, of the lines on which its fixed sides lie, and of the groups besides.

use std::sync::Arc;

use glam::DVec2;

use super::ids::PointId;

/// A name with its tag in a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Named {
    /// The name.
    pub name: String,
    /// The tag, which is kept in written files.
    pub tag: Option<u32>,
}

/// Names of faces and lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Names {
    /// The name of each face by its number; several faces may have the same name.
    pub faces: Vec<Named>,
    /// The name of each line by its number.
    pub lines: Vec<Named>,
    /// The points at the ends of sides, ascending, and the line on which they lie.
    sides: Vec<([PointId; 2], u32)>,
    /// Groups besides those of faces and lines.
    pub further: Further,
}

/// Groups that divide nothing: of points, and of elements and lines that are also in another group.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Further {
    /// Points that are kept, each with its group, if it is in one.
    pub points: Vec<(Option<Named>, PointId)>,
    /// Groups of lines, each with the numbers of its lines.
    pub lines: Vec<(Named, Vec<u32>)>,
    /// Groups of elements.
    pub faces: Option<Arc<GroupsByPlace>>,
    /// Groups of whole faces, each with the numbers of its faces.
    pub of_faces: Vec<(Named, Vec<u32>)>,
}

/// Groups of elements by their place: an element is in those of the given triangle around its middle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GroupsByPlace {
    /// The corners of the given triangles in the parametric plane.
    pub uv: Vec<DVec2>,
    /// The given triangles.
    pub triangles: Vec<[u32; 3]>,
    /// The groups, each with its triangles by index.
    pub groups: Vec<(Named, Vec<u32>)>,
}

impl Named {
    /// A name without a tag.
    pub fn new(name: impl Into<String>) -> Named {
        Named { name: name.into(), tag: None }
    }

    /// A group of a file; 0 means no tag.
    pub fn tagged(name: impl Into<String>, tag: u32) -> Named {
        Named { name: name.into(), tag: (tag > 0).then_some(tag) }
    }
}

impl Names {
    /// Names of faces, without lines.
    pub fn of_faces(faces: Vec<Named>) -> Names {
        Names { faces, ..Names::default() }
    }

    /// The same names with lines, and the sides on them: the end points in either order and the number of the line. A
    /// side on two lines belongs to the first.
    #[must_use]
    pub fn with_lines(mut self, lines: Vec<Named>, mut sides: Vec<([PointId; 2], u32)>) -> Names {
        sides.iter_mut().for_each(|side| side.0.sort_unstable());
        sides.sort_unstable();
        sides.dedup_by_key(|side| side.0);
        (self.lines, self.sides) = (lines, sides);
        self
    }

    /// The number of the line on which the side between two points lies.
    pub fn line_of(&self, [a, b]: [PointId; 2]) -> Option<u32> {
        let at = self.sides.binary_search_by_key(&[a.min(b), a.max(b)], |side| side.0).ok()?;
        Some(self.sides[at].1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_find_their_line_in_either_direction_and_the_first_of_two() {
        let [a, b, c] = [3, 1, 2].map(PointId);
        let lines = vec![Named::tagged("floor", 7), Named::tagged("wall", 0)];
        let names = Names::default().with_lines(lines, vec![([a, b], 1), ([b, a], 0), ([b, c], 1)]);
        assert_eq!([[a, b], [b, a], [c, b], [a, c]].map(|ends| names.line_of(ends)), [Some(0), Some(0), Some(1), None]);
        assert_eq!(names.lines.iter().map(|line| line.tag).collect::<Vec<_>>(), [Some(7), None]);
    }
}
