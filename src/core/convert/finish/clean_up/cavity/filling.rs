//! Fillings of a polygon with quadrilaterals that have few irregular nodes, by the numbers of sides alone.
//!
//! A polygon has n corners, at which one quadrilateral fits, and sides of so many edges each, at whose nodes two fit.
//! By Euler's formula the excesses of the nodes inside sum to n - 4, so that a filling has at least |4 - n| irregular
//! ones. The fillings here have the least number that the counts allow, or two more:
//!
//! - four corners and equal opposite sides: a grid;
//! - three or five corners: one node from which a spoke goes to each side (Bunin 2006);
//! - four corners otherwise: a rectangle is cut off a corner, which leaves five corners and makes a node of three;
//! - two corners: a rectangle is cut off, which leaves three corners; six: a line leaves five on both sides;
//! - no corner: layers along the border, and a grid within them, whose corners are nodes of three.

use smallvec::SmallVec;

/// Most corners of a polygon that is filled.
pub(super) const MOST_CORNERS: usize = 6;
/// Edges of each side, anticlockwise; side k goes from corner k to corner k + 1. A single side is a border without a
/// corner.
pub(super) type Sides = SmallVec<[u32; MOST_CORNERS]>;

/// A way to fill a polygon.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Filling {
    /// Rows and columns.
    Grid,
    /// One node in the middle, from which a spoke of this many edges goes to each side.
    Star(Sides),
    /// A rectangle is cut off a corner; the polygon that is left begins with the side before the corner.
    Corner {
        /// The corner.
        corner: usize,
        /// Edges of the rectangle along the side before the corner and along that after it.
        along: [u32; 2],
        /// The filling of what is left.
        rest: Box<Filling>,
    },
    /// A line from one side to another cuts the polygon in two; both begin with the line.
    Line {
        /// The sides on which it starts and ends.
        sides: [usize; 2],
        /// Edges from the first corner of each side to the line.
        at: [u32; 2],
        /// Edges of the line.
        length: u32,
        /// The fillings to its left and to its right.
        parts: Box<[Filling; 2]>,
    },
    /// So many layers along a border without a corner, and a grid of these rows and columns inside.
    Layers {
        /// The number of layers.
        layers: u32,
        /// Edges of the grid's sides.
        grid: [u32; 2],
    },
}

/// Twice the length of spoke k of a star is the sum of the sides from side k on with these signs: spoke k goes to side
/// k, and L_k = s_(k-1) + s_(k+1). None where a polygon with n corners has no star.
fn signs(n: usize) -> Option<&'static [i64]> {
    match n {
        3 => Some(&[-1, 1, 1]),
        5 => Some(&[1, 1, -1, -1, 1]),
        _ => None,
    }
}

/// The lengths of the spokes of a star; none where they would not be whole and positive.
fn spokes(sides: &[u32]) -> Option<Sides> {
    let (n, signs) = (sides.len(), signs(sides.len())?);
    (0..n)
        .map(|k| {
            let twice: i64 = (0..n).map(|j| signs[j] * i64::from(sides[(k + j) % n])).sum();
            (twice >= 2 && twice % 2 == 0).then_some((twice / 2) as u32)
        })
        .collect()
}

/// The least and the greatest length of the first side with which a star has positive spokes, the other sides given.
fn first_sides(sides: &[u32]) -> Option<[i64; 2]> {
    let (n, signs) = (sides.len(), signs(sides.len())?);
    let mut range = [1, i64::MAX];
    for k in 0..n {
        let rest: i64 = (1..n).map(|j| signs[(n + j - k) % n] * i64::from(sides[j])).sum();
        if signs[(n - k) % n] > 0 {
            range[0] = range[0].max(2 - rest);
        } else {
            range[1] = range[1].min(rest - 2);
        }
    }
    Some(range)
}

/// Quadrilaterals of a star with these spokes.
fn of_star(spokes: &[u32]) -> u64 {
    (0..spokes.len()).map(|k| u64::from(spokes[k]) * u64::from(spokes[(k + 1) % spokes.len()])).sum()
}

/// The polygon that is left of one when a rectangle is cut off a corner: the side before the corner comes first.
pub(super) fn without_corner(sides: &[u32], corner: usize, along: [u32; 2]) -> Sides {
    let n = sides.len();
    let (before, after) = ((corner + n - 1) % n, corner);
    let mut rest: Sides =
        [sides[before] - along[0], along[0] + along[1], sides[after] - along[1]].into_iter().collect();
    rest.extend((1..n - 1).map(|k| sides[(after + k) % n]));
    rest
}

/// The polygons left and right of a line: both begin with it.
pub(super) fn beside_line(sides: &[u32], [i, j]: [usize; 2], at: [u32; 2], length: u32) -> [Sides; 2] {
    let n = sides.len();
    // Left of the line from side i to side j lies what follows side j.
    let part = |from: usize, to: usize, first: u32, last: u32| {
        let mut part: Sides = [length, first].into_iter().collect();
        let mut k = (from + 1) % n;
        while k != to {
            part.push(sides[k]);
            k = (k + 1) % n;
        }
        part.push(last);
        part
    };
    [part(j, i, sides[j] - at[1], at[0]), part(i, j, sides[i] - at[0], at[1])]
}

impl Filling {
    /// Irregular nodes that it makes inside a polygon with this many corners.
    pub fn irregular(&self) -> usize {
        match self {
            Filling::Grid => 0,
            Filling::Star(_) => 1,
            Filling::Corner { rest, .. } => 1 + rest.irregular(),
            Filling::Line { parts, .. } => parts.iter().map(Filling::irregular).sum(),
            Filling::Layers { .. } => 4,
        }
    }

    /// Quadrilaterals that it makes of a polygon with these sides.
    pub fn quads(&self, sides: &[u32]) -> u64 {
        match self {
            Filling::Grid => u64::from(sides[0]) * u64::from(sides[1]),
            Filling::Star(spokes) => of_star(spokes),
            Filling::Corner { corner, along, rest } => {
                u64::from(along[0]) * u64::from(along[1]) + rest.quads(&without_corner(sides, *corner, *along))
            }
            Filling::Line { sides: ends, at, length, parts } => {
                let [left, right] = beside_line(sides, *ends, *at, *length);
                parts[0].quads(&left) + parts[1].quads(&right)
            }
            Filling::Layers { layers, grid: [columns, rows], .. } => {
                u64::from(sides[0]) * u64::from(*layers) + u64::from(*columns) * u64::from(*rows)
            }
        }
    }
}

/// The least number of irregular nodes that a filling of a polygon with these sides can have.
pub(super) fn least_irregular(sides: &[u32]) -> usize {
    match *sides {
        [a, b, c, d] => {
            if a == c && b == d {
                0
            } else {
                2
            }
        }
        [_] => 4,
        _ => sides.len().abs_diff(4),
    }
}

/// Fillings of a polygon with the least number of irregular nodes, where there are any; at different places where there
/// is a choice.
pub(super) fn fillings(sides: &[u32]) -> Vec<Filling> {
    if sides.iter().sum::<u32>() % 2 == 1 {
        return Vec::new();
    }
    match *sides {
        [a, b, c, d] if a == c && b == d => vec![Filling::Grid],
        [_, _, _] | [_, _, _, _, _] => spokes(sides).map(Filling::Star).into_iter().collect(),
        [_, _] | [_, _, _, _] => corners_cut(sides),
        [_, _, _, _, _, _] => lines_cut(sides),
        [border] => layered(border),
        _ => Vec::new(),
    }
}

/// Fillings of a polygon with three or five corners that have two irregular nodes more than the least number: where its
/// sides leave no room for a star, or a star would be too fine or too coarse.
pub(super) fn fillings_with_a_pair(sides: &[u32]) -> Vec<Filling> {
    let n = sides.len();
    if sides.iter().sum::<u32>() % 2 == 1 || !matches!(n, 3 | 5) {
        return Vec::new();
    }
    let mut found = Vec::new();
    for corner in 0..n {
        let [a, b] = [sides[(corner + n - 1) % n], sides[corner]].map(i64::from);
        for x in places(1, a - 1).into_iter().step_by(2) {
            for z in places(1, b - 1).into_iter().step_by(2) {
                let rest = fillings(&without_corner(sides, corner, [x, z]));
                let rest = rest.into_iter().filter(|rest| rest.irregular() == 2).map(Box::new);
                found.extend(rest.map(|rest| Filling::Corner { corner, along: [x, z], rest }));
            }
        }
    }
    found
}

/// Places within a range at which a cut is tried.
fn places(from: i64, to: i64) -> SmallVec<[u32; 5]> {
    let mut places: SmallVec<[u32; 5]> = SmallVec::new();
    if from <= to {
        places.extend([1, 3, 5, 7].map(|eighth| (from + (to - from) * eighth / 8) as u32));
        places.dedup();
    }
    places
}

/// Cuts of a rectangle off each corner of a polygon with two or four corners, which leave a star.
fn corners_cut(sides: &[u32]) -> Vec<Filling> {
    let n = sides.len();
    let mut found = Vec::new();
    for corner in 0..n {
        let [a, b] = [sides[(corner + n - 1) % n], sides[corner]].map(i64::from);
        // Where the spokes of what is left are at least 1.
        let (first, second) = if let [_, _, _, _] = *sides {
            let [c, d] = [sides[(corner + 1) % n], sides[(corner + 2) % n]].map(i64::from);
            if a + b < c + d + 2 {
                continue;
            }
            let half = |twice: i64| twice.div_euclid(2);
            (
                (half(3 + d + a - b - c).max(1), half(d + c + a - b - 2).min(a - 1)),
                (half(3 + b + c - a - d).max(1), half(c + b + d - a - 2).min(b - 1)),
            )
        } else {
            let half = |twice: i64| twice.div_euclid(2);
            ((half(a - b + 2).max(1), a - 1), (half(b - a + 2).max(1), b - 1))
        };
        for x in places(first.0, first.1) {
            for z in places(second.0, second.1) {
                let rest = without_corner(sides, corner, [x, z]);
                if let Some(spokes) = spokes(&rest) {
                    let rest = Box::new(Filling::Star(spokes));
                    found.push(Filling::Corner { corner, along: [x, z], rest });
                }
            }
        }
    }
    found
}

/// Lines across a polygon with six corners, with five on both sides, each of the middle length of those that fit.
fn lines_cut(sides: &[u32]) -> Vec<Filling> {
    let mut found = Vec::new();
    for i in 0..3 {
        let ends = [i, i + 3];
        for x in places(1, i64::from(sides[i]) - 1) {
            for z in places(1, i64::from(sides[i + 3]) - 1) {
                let parts = beside_line(sides, ends, [x, z], 0);
                let [Some(a), Some(b)] = parts.each_ref().map(|part| first_sides(part)) else { continue };
                let (least, most) = (a[0].max(b[0]), a[1].min(b[1]));
                // An even number of edges around each part.
                let odd = i64::from(parts[0].iter().sum::<u32>() % 2);
                let length = (least + most).div_euclid(2);
                let length = [length, length + 1].into_iter().find(|length| length % 2 == odd).unwrap_or(length);
                if !(least..=most).contains(&length) {
                    continue;
                }
                let length = length as u32;
                let [left, right] = beside_line(sides, ends, [x, z], length).map(|part| spokes(&part));
                if let (Some(left), Some(right)) = (left, right) {
                    let parts = Box::new([Filling::Star(left), Filling::Star(right)]);
                    found.push(Filling::Line { sides: ends, at: [x, z], length, parts });
                }
            }
        }
    }
    found
}

/// Grids within layers along a border without a corner: square ones and longish ones.
fn layered(border: u32) -> Vec<Filling> {
    let half = border / 2;
    let mut found = Vec::new();
    for columns in [half / 2, half / 3].into_iter().filter(|&columns| columns > 0) {
        found.extend((1..=half / 2).map(|layers| Filling::Layers { layers, grid: [columns, half - columns] }));
    }
    found
}
