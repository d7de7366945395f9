//! Walls: boundaries along which a boundary layer asks for rows, and the heights of these rows.

use glam::DVec2;
use rustc_hash::FxHashMap;

/// The rows that a boundary layer asks for at a wall: each is higher than the one before by what its size grows over
/// the height of that one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rows {
    /// Height of the first row, in units of the plane.
    pub first: f64,
    /// Height of a row divided by that of the row before, at least 1.
    pub growth: f64,
    /// Height of the highest rows.
    pub far: f64,
}

impl Rows {
    /// The rows of a boundary layer whose sizes are all multiplied by a factor: the sizes then grow by as much less
    /// over the same distance.
    #[must_use]
    pub fn scaled(self, size_scale: f64) -> Rows {
        let growth = 1.0 + (self.growth - 1.0) * size_scale;
        Rows { first: self.first * size_scale, growth, far: self.far * size_scale }
    }

    /// Heights of the rows from the wall outwards, without end.
    pub fn heights(&self) -> impl Iterator<Item = f64> + use<> {
        let Rows { first, growth, far } = *self;
        std::iter::successors(Some(first), move |height| Some(height * growth)).map(move |height| height.min(far))
    }
}

/// The rows that are asked for at each node of a wall. Nodes of a boundary never move, so their places name them.
#[derive(Clone, Debug, Default)]
pub struct Walls {
    rows: FxHashMap<[u64; 2], Rows>,
}

impl Walls {
    /// Adds a node of a wall. Of several boundary layers that name it the one with the lower first row counts.
    pub fn add(&mut self, node: DVec2, rows: Rows) {
        let known = self.rows.entry(bits(node)).or_insert(rows);
        if rows.first < known.first {
            *known = rows;
        }
    }

    /// The rows that are asked for at a node; `None` where there is no wall.
    pub fn rows_at(&self, node: DVec2) -> Option<Rows> {
        self.rows.get(&bits(node)).copied()
    }

    /// Whether there is no wall.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

/// A place as a key. Adding zero turns -0 into 0.
fn bits(p: DVec2) -> [u64; 2] {
    [p.x + 0.0, p.y + 0.0].map(f64::to_bits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_is_as_much_higher_than_the_one_before_as_asked_up_to_the_highest() {
        let rows = Rows { first: 0.1, growth: 1.5, far: 0.3 };
        let heights: Vec<f64> = rows.heights().take(4).collect();
        for (height, asked) in heights.iter().zip([0.1, 0.15, 0.225, 0.3]) {
            assert!((height - asked).abs() < 1e-15, "{heights:?}");
        }
        let half = rows.scaled(0.5);
        assert_eq!(half, Rows { first: 0.05, growth: 1.25, far: 0.15 });
    }

    #[test]
    fn the_lower_first_row_counts_and_zero_has_one_sign() {
        let rows = |first| Rows { first, growth: 1.2, far: 1.0 };
        let mut walls = Walls::default();
        assert!(walls.is_empty());
        for first in [0.2, 0.1, 0.3] {
            walls.add(DVec2::new(0.0, 1.0), rows(first));
        }
        assert_eq!(walls.rows_at(DVec2::new(-0.0, 1.0)), Some(rows(0.1)));
        assert_eq!(walls.rows_at(DVec2::new(1.0, 0.0)), None);
    }
}
