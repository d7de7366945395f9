//! An order in which the rows of a sparse system can be eliminated with little fill-in: nested dissection (George
//! 1973). Two halves come first, each in such an order, then the nodes between them.
//!
//! A part is halved by position. That is good where triangles are about as long as wide. Across long thin ones, such as
//! those of a tube with many sides and few rows, half of the nodes touch the other half, and the factor would be full.
//! There a part is divided at the smallest of its levels: the nodes at the same number of edges from an end of it
//! (George & Liu 1978). Nodes with very many neighbours, such as the centre of a fan, come after all others: eliminated
//! earlier, they would join all their neighbours.

use glam::DVec3;

use crate::core::kernel::box_tree::extent;

/// Largest part that is not divided.
const LEAF: usize = 24;
/// Most nodes between two halves, relative to the square root of the number of nodes: a square grid has 1.
const MOST_BETWEEN: f64 = 4.0;
/// Most neighbours of a node within its part, relative to the same.
const MOST_NEIGHBOURS: f64 = 10.0;
/// Least share of each side of a level.
const LEAST_SHARE: f64 = 0.25;

/// The neighbours of each row, in rows.
#[derive(Clone, Copy)]
pub struct Pattern<'m> {
    /// The offset of each row, then their number.
    pub start: &'m [u32],
    /// Neighbours by row, ascending; the row itself may be among them.
    pub column: &'m [u32],
}

impl<'m> Pattern<'m> {
    fn near(self, row: u32) -> &'m [u32] {
        &self.column[self.start[row as usize] as usize..self.start[row as usize + 1] as usize]
    }
}

/// An order of the rows; `places` are the positions of the nodes. `None` when `goes_on`, called at intervals, returns
/// false.
pub fn order(pattern: Pattern<'_>, places: &[DVec3], goes_on: &dyn Fn() -> bool) -> Option<Vec<u32>> {
    let n = pattern.start.len() - 1;
    let order = Vec::with_capacity(n);
    let mut work = Dissection { pattern, places, part: vec![0; n], level: vec![0; n], parts: 0, order };
    work.divide(&mut (0..n as u32).collect::<Vec<_>>(), goes_on)?;
    Some(work.order)
}

struct Dissection<'m> {
    pattern: Pattern<'m>,
    places: &'m [DVec3],
    /// The part that each node is in, of those at work.
    part: Vec<u32>,
    /// The level of each node, of the part that was divided by levels last.
    level: Vec<u32>,
    /// The number of parts so far.
    parts: u32,
    order: Vec<u32>,
}

/// A part in two, and the nodes between them.
struct Division {
    between: Vec<u32>,
    sides: [Vec<u32>; 2],
}

impl Dissection<'_> {
    fn divide(&mut self, nodes: &mut [u32], goes_on: &dyn Fn() -> bool) -> Option<()> {
        let n = nodes.len();
        if n <= LEAF {
            self.order.extend_from_slice(nodes);
            return Some(());
        }
        if !goes_on() {
            return None;
        }
        let root = (n as f64).sqrt();
        let mut division = self.halved(nodes);
        if division.between.len() as f64 > MOST_BETWEEN * root {
            let (hubs, mut rest) = self.without_hubs(nodes, MOST_NEIGHBOURS * root);
            if !hubs.is_empty() {
                self.divide(&mut rest, goes_on)?;
                self.order.extend(hubs);
                return Some(());
            }
            let other = self.at_a_level(nodes);
            division = other
                .into_iter()
                .fold(division, |best, other| if other.between.len() < best.between.len() { other } else { best });
        }
        for side in &mut division.sides {
            self.divide(side, goes_on)?;
        }
        self.order.extend(division.between);
        Some(())
    }

    /// Halves a part across its longest extent, with the nodes of the first half that touch the second one between
    /// them.
    fn halved(&mut self, nodes: &mut [u32]) -> Division {
        let places = self.places;
        let (low, high) = extent(nodes.iter().map(|&node| places[node as usize]));
        let extent = (high - low).to_array();
        let axis = (1..3).fold(0, |axis, k| if extent[k] > extent[axis] { k } else { axis });
        let at = |node: u32| places[node as usize][axis];
        let half = nodes.len() / 2;
        nodes.select_nth_unstable_by(half, |&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
        let (left, right) = nodes.split_at(half);
        let second = self.mark(right);
        let touches = |node: &u32| self.pattern.near(*node).iter().any(|&near| self.part[near as usize] == second);
        let (between, left) = left.iter().partition(|node| touches(node));
        Division { between, sides: [left, right.to_vec()] }
    }

    /// Marks nodes as a part. Returns its number.
    fn mark(&mut self, nodes: &[u32]) -> u32 {
        self.parts += 1;
        nodes.iter().for_each(|&node| self.part[node as usize] = self.parts);
        self.parts
    }

    /// The nodes of a part with more than so many neighbours in it, and the other ones.
    fn without_hubs(&mut self, nodes: &[u32], most: f64) -> (Vec<u32>, Vec<u32>) {
        let own = self.mark(nodes);
        let near = |node: u32| self.pattern.near(node).iter().filter(|&&near| self.part[near as usize] == own).count();
        nodes.iter().partition(|&&node| near(node) as f64 > most)
    }

    /// Divides a part at the level with the fewest nodes that touch the next one; `None` where no level leaves enough
    /// on both sides.
    fn at_a_level(&mut self, nodes: &[u32]) -> Option<Division> {
        let own = self.mark(nodes);
        // What is reached last lies at an end, where levels are small.
        let end = *self.by_level(nodes, *nodes.iter().min()?, own).last()?;
        let reached = self.by_level(nodes, end, own);
        let n = reached.len() as f64;
        let level = |node: u32| self.level[node as usize];
        let inside = |node: u32| self.pattern.near(node).iter().filter(|&&near| self.part[near as usize] == own);
        let touches_next = |node: u32| inside(node).any(|&near| level(near) > level(node));
        let mut best: Option<(usize, usize, usize)> = None;
        let mut from = 0;
        for same in reached.chunk_by(|&a, &b| level(a) == level(b)) {
            let to = from + same.len();
            if (LEAST_SHARE * n..=n - LEAST_SHARE * n).contains(&(to as f64)) {
                let between = same.iter().filter(|&&node| touches_next(node)).count();
                if best.is_none_or(|best| between < best.0) {
                    best = Some((between, from, to));
                }
            }
            from = to;
        }
        let (_, from, to) = best?;
        let (between, rest): (Vec<u32>, Vec<u32>) = reached[from..to].iter().partition(|&&node| touches_next(node));
        Some(Division { between, sides: [[&reached[..from], &rest].concat(), reached[to..].to_vec()] })
    }

    /// The nodes of a part by their number of edges from `first`, piece after piece where they are not connected.
    fn by_level(&mut self, nodes: &[u32], first: u32, own: u32) -> Vec<u32> {
        const NONE: u32 = u32::MAX;
        nodes.iter().for_each(|&node| self.level[node as usize] = NONE);
        let mut reached: Vec<u32> = Vec::with_capacity(nodes.len());
        let (mut next, mut level) = (0, 0);
        for &start in std::iter::once(&first).chain(nodes) {
            if self.level[start as usize] != NONE {
                continue;
            }
            self.level[start as usize] = level;
            reached.push(start);
            while let Some(&node) = reached.get(next) {
                level = self.level[node as usize] + 1;
                for &near in self.pattern.near(node) {
                    if self.part[near as usize] == own && self.level[near as usize] == NONE {
                        self.level[near as usize] = level;
                        reached.push(near);
                    }
                }
                next += 1;
            }
        }
        reached
    }
}
