//! How a file counts its points and elements, so that messages call them as the file does: from 0 or 1, by numbers of its own, kind by
//! kind or all kinds in one row.

use std::sync::Arc;

/// So many things are told by their numbers; of more it is said how many.
const TOLD: usize = 5;

/// The numbers of the points, or of the elements of a kind.
#[derive(Clone, Debug)]
pub enum Count {
    /// One after another from this one.
    From(u64),
    /// That of each; whoever tells of elements without their file has the same list.
    Listed(Arc<Vec<u64>>),
    /// The file has no numbers for them.
    Nothing,
}

/// How a file counts. It is no part of what the mesh is: whatever the numbers, meshes are equal.
#[derive(Clone, Debug, Default)]
pub struct Counting {
    /// Points.
    pub points: Count,
    /// Triangles.
    pub triangles: Count,
    /// Quadrilaterals.
    pub quads: Count,
    /// Polygons of five corners and more.
    pub polygons: Count,
    /// Whether all kinds of elements are counted in one row.
    pub in_one_row: bool,
}

/// The elements of a file as far as it takes to call them by their numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Elements {
    triangles: usize,
    quads: usize,
    polygons: usize,
    counting: Counting,
}

/// Triangles of no file, counted from 1.
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
    /// The count of things with these numbers.
    pub fn of(numbers: &[u64]) -> Count {
        let first = numbers.first().copied().unwrap_or(1);
        let mut row = (0..).map(|i| first.checked_add(i));
        if numbers.iter().all(|&number| row.next() == Some(Some(number))) {
            Count::From(first)
        } else {
            Count::Listed(Arc::new(numbers.to_vec()))
        }
    }

    /// Takes in the number of the next thing, of which there are `before` so far.
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

    pub(super) fn number(&self, index: usize) -> Option<u64> {
        match self {
            Count::From(first) => first.checked_add(index as u64),
            Count::Listed(numbers) => numbers.get(index).copied(),
            Count::Nothing => None,
        }
    }
}

impl Counting {
    /// How a file counts that begins at 0.
    pub fn from_zero() -> Counting {
        let zero = || Count::From(0);
        Counting { points: zero(), triangles: zero(), quads: zero(), polygons: zero(), in_one_row: true }
    }
}

impl Elements {
    /// The elements of a file with so many triangles, quadrilaterals and polygons.
    pub(super) fn new([triangles, quads, polygons]: [usize; 3], counting: Counting) -> Elements {
        Elements { triangles, quads, polygons, counting }
    }

    /// What elements are called, by their places among triangles, quadrilaterals and polygons: "triangle 7", "triangles 3, 7 and 9",
    /// "triangles 3, 7, 9, 10, 12 and 40 more"; "element 7" where several kinds are counted in one row.
    pub fn told(&self, places: &[u32]) -> String {
        let mut places = places.to_vec();
        places.sort_unstable();
        places.dedup();
        let (triangles, quads) = (self.triangles, self.quads);
        let kind = |place: u32| match place as usize {
            place if place < triangles => (["triangle", "triangles"], &self.counting.triangles, place),
            place if place < triangles + quads => {
                (["quadrilateral", "quadrilaterals"], &self.counting.quads, place - triangles)
            }
            place => (["polygon", "polygons"], &self.counting.polygons, place - triangles - quads),
        };
        let alike = |&a: &u32, &b: &u32| kind(a).0 == kind(b).0;
        let number = |&place: &u32| {
            let (_, count, index) = kind(place);
            count.number(index)
        };
        let kinds = [triangles, quads, self.polygons].iter().filter(|n| **n > 0).count();
        if self.counting.in_one_row && kinds > 1 {
            places.sort_by_key(number);
            return things_told(["element", "elements"], places.len(), places.iter().filter_map(number));
        }
        let told = places.chunk_by(alike).map(|of| things_told(kind(of[0]).0, of.len(), of.iter().filter_map(number)));
        told.collect::<Vec<_>>().join(" and ")
    }
}

pub(super) fn things_told([one, several]: [&str; 2], all: usize, numbers: impl Iterator<Item = u64>) -> String {
    let numbers: Vec<String> = numbers.take(TOLD).map(|n| n.to_string()).collect();
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
    fn elements_are_called_as_the_file_counts_them() {
        let mut file = MeshFile {
            triangles: vec![[0; 3]; 10],
            quads: vec![[0; 4]; 2],
            polygons: vec![vec![0; 5]],
            ..MeshFile::default()
        };
        assert_eq!(file.origins()[8..], [8, 9, 10, 10, 11, 11, 12, 12, 12]);
        assert_eq!(file.elements_told(&[6]), "triangle 7");
        assert_eq!(file.elements_told(&[4, 2, 2]), "triangles 3 and 5");
        assert_eq!(file.elements_told(&[0, 1, 2, 3, 4, 5, 6]), "triangles 1, 2, 3, 4, 5 and 2 more");
        assert_eq!(file.elements_told(&[9, 11, 12]), "triangle 10 and quadrilateral 2 and polygon 1");
        (file.counting.quads, file.counting.in_one_row) = (Count::From(40), true);
        assert_eq!(file.elements_told(&[9, 11]), "elements 10 and 41");
        (file.quads, file.polygons) = (Vec::new(), Vec::new());
        file.counting.triangles = Count::of(&[5, 6, 9]);
        assert_eq!(file.elements_told(&[0, 2]), "triangles 5 and 9");
        file.counting.points = Count::Nothing;
        assert_eq!((file.points_told(&[4]), file.points_told(&[4, 5])), ("a point".into(), "2 points".into()));
    }

    #[test]
    fn numbers_in_a_row_take_no_room() {
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
