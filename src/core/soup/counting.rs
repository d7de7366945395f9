//! How a file numbers its points and elements, so that messages use the file's numbers: from 0 or 1 or explicit, for
//! each kind of element or for all kinds together.

use std::sync::Arc;

/// A message lists this many numbers and counts the rest.
const LISTED: usize = 5;

/// The numbers of the points, or of the elements of a kind.
#[derive(Clone, Debug)]
pub enum Count {
    /// Consecutive numbers from this one.
    From(u64),
    /// Explicit numbers, shared with [`Elements`].
    Listed(Arc<Vec<u64>>),
    /// The file does not number them.
    Nothing,
}

/// How a file numbers its points and elements. Ignored when meshes are compared.
#[derive(Clone, Debug, Default)]
pub struct Counting {
    /// Points.
    pub points: Count,
    /// Triangles.
    pub triangles: Count,
    /// Quadrilaterals.
    pub quads: Count,
    /// Polygons with five or more corners.
    pub polygons: Count,
    /// Whether all kinds of elements share one sequence of numbers.
    pub shared: bool,
}

/// The numbers of a file's elements, for messages.
#[derive(Clone, Debug, PartialEq)]
pub struct Elements {
    pub(super) triangles: usize,
    pub(super) quads: usize,
    pub(super) polygons: usize,
    pub(super) counting: Counting,
}

/// Triangles numbered from 1, for a mesh without a file.
impl Default for Elements {
    fn default() -> Self {
        Elements { triangles: usize::MAX, quads: 0, polygons: 0, counting: Counting::default() }
    }
}

impl Default for Count {
    fn default() -> Self {
        Count::From(1)
    }
}

impl PartialEq for Counting {
    fn eq(&self, _: &Counting) -> bool {
        true
    }
}

impl Count {
    /// The most compact form of these numbers.
    pub fn of(numbers: &[u64]) -> Count {
        let first = numbers.first().copied().unwrap_or(1);
        let mut row = (0..).map(|i| first.checked_add(i));
        if numbers.iter().all(|&number| row.next() == Some(Some(number))) {
            Count::From(first)
        } else {
            Count::Listed(Arc::new(numbers.to_vec()))
        }
    }

    /// Appends the number of the next item, after `before` items.
    pub fn push(&mut self, before: usize, number: u64) {
        match self {
            Count::From(first) if before == 0 => *first = number,
            Count::From(first) if first.checked_add(before as u64) == Some(number) => {}
            Count::From(first) => {
                *self = Count::Listed(Arc::new((*first..).take(before).chain([number]).collect()));
            }
            Count::Listed(numbers) => Arc::make_mut(numbers).push(number),
            Count::Nothing => {}
        }
    }

    /// Removes the numbers of the items that are gone.
    pub(super) fn keep(&mut self, gone: &[bool]) {
        if !matches!(self, Count::Nothing) {
            let left = (0..gone.len()).filter(|&item| !gone[item]).filter_map(|item| self.number(item));
            *self = Count::of(&left.collect::<Vec<_>>());
        }
    }

    pub(super) fn number(&self, index: usize) -> Option<u64> {
        match self {
            Count::From(first) => first.checked_add(index as u64),
            Count::Listed(numbers) => numbers.get(index).copied(),
            Count::Nothing => None,
        }
    }
}

impl Counting {
    /// Everything from 0, elements of all kinds in one sequence.
    pub fn from_zero() -> Counting {
        let zero = || Count::From(0);
        Counting { points: zero(), triangles: zero(), quads: zero(), polygons: zero(), shared: true }
    }
}

impl Elements {
    /// Names elements for a message, by index (triangles, then quadrilaterals, then polygons): "triangle 7", "triangles
    /// 3, 7 and 9", "triangles 3, 7, 9, 10, 12 and 40 more"; "element 7" where several kinds share one sequence.
    pub fn describe(&self, indices: &[u32]) -> String {
        let mut indices = indices.to_vec();
        indices.sort_unstable();
        indices.dedup();
        let (triangles, quads) = (self.triangles, self.quads);
        let kind = |index: u32| match index as usize {
            index if index < triangles => (["triangle", "triangles"], &self.counting.triangles, index),
            index if index < triangles + quads => {
                (["quadrilateral", "quadrilaterals"], &self.counting.quads, index - triangles)
            }
            index => (["polygon", "polygons"], &self.counting.polygons, index - triangles - quads),
        };
        let alike = |&a: &u32, &b: &u32| kind(a).0 == kind(b).0;
        let number = |&index: &u32| {
            let (_, count, within) = kind(index);
            count.number(within)
        };
        let kinds = [triangles, quads, self.polygons].iter().filter(|n| **n > 0).count();
        if self.counting.shared && kinds > 1 {
            indices.sort_by_key(number);
            return enumerate(["element", "elements"], indices.len(), indices.iter().filter_map(number));
        }
        let kinds = indices.chunk_by(alike).map(|of| enumerate(kind(of[0]).0, of.len(), of.iter().filter_map(number)));
        kinds.collect::<Vec<_>>().join(" and ")
    }
}

/// "point 7", "points 3, 7 and 9", "points 1, 2, 3, 4, 5 and 2 more"; without numbers, "a point" or "2 points".
pub(super) fn enumerate([one, several]: [&str; 2], all: usize, numbers: impl Iterator<Item = u64>) -> String {
    let numbers: Vec<String> = numbers.take(LISTED).map(|n| n.to_string()).collect();
    match (&numbers[..], all - numbers.len()) {
        ([], 1) => format!("a {one}"),
        ([], n) => format!("{n} {several}"),
        ([number], 0) => format!("{one} {number}"),
        ([first @ .., last], 0) => format!("{several} {} and {last}", first.join(", ")),
        (numbers, more) => format!("{several} {} and {more} more", numbers.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::soup::mesh_file::MeshFile;

    #[test]
    fn messages_name_elements_by_the_numbers_of_the_file() {
        let mut file = MeshFile {
            triangles: vec![[0; 3]; 10],
            quads: vec![[0; 4]; 2],
            polygons: vec![vec![0; 5]],
            ..MeshFile::default()
        };
        assert_eq!(file.origins()[8..], [8, 9, 10, 10, 11, 11, 12, 12, 12]);
        assert_eq!(file.describe_elements(&[6]), "triangle 7");
        assert_eq!(file.describe_elements(&[4, 2, 2]), "triangles 3 and 5");
        assert_eq!(file.describe_elements(&[0, 1, 2, 3, 4, 5, 6]), "triangles 1, 2, 3, 4, 5 and 2 more");
        assert_eq!(file.describe_elements(&[9, 11, 12]), "triangle 10 and quadrilateral 2 and polygon 1");
        (file.counting.quads, file.counting.shared) = (Count::From(40), true);
        assert_eq!(file.describe_elements(&[9, 11]), "elements 10 and 41");
        (file.quads, file.polygons) = (Vec::new(), Vec::new());
        file.counting.triangles = Count::of(&[5, 6, 9]);
        assert_eq!(file.describe_elements(&[0, 2]), "triangles 5 and 9");
        file.counting.points = Count::Nothing;
        assert_eq!((file.describe_points(&[4]), file.describe_points(&[4, 5])), ("a point".into(), "2 points".into()));
    }

    #[test]
    fn consecutive_numbers_are_stored_as_their_first() {
        let mut count = Count::default();
        for (before, number) in [7, 8, 9].into_iter().enumerate() {
            count.push(before, number);
        }
        assert!(matches!(count, Count::From(7)), "{count:?}");
        count.push(3, 20);
        count.push(4, 21);
        assert_eq!([0, 2, 3, 4].map(|i| count.number(i)), [7, 9, 20, 21].map(Some));
        assert!(matches!(Count::of(&[u64::MAX, 0]), Count::Listed(_)));
    }
}
