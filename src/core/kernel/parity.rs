//! Even loops (docs/algorithm.md, "Even loops"): which curves get one segment more or fewer, so that every topological
//! loop is even. A linear system over GF(2) with a row for each loop and a column for each curve.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;

/// Up to this many odd rows the fewest toggles are searched: the search takes 2^n steps.
const MOST_ODD: usize = 14;

/// Solves `A x = b` over GF(2): `x[c]` says whether to toggle column `c`. Row `r` of `A` has ones in the columns
/// `rows[r]` (each at most once: the caller drops a curve that a loop traverses twice), and `odd[r]` is its right-hand
/// side. Columns without a cost are fixed. Cheap columns become pivots first and the other columns stay unchanged, so
/// that the toggles fall on cheap ones (ties by column).
///
/// # Errors
/// A set of rows without a solution: their free columns cancel, and the sum of their right-hand sides is odd.
pub fn toggles(rows: &[Vec<u32>], odd: &[bool], cost: &[Option<f64>]) -> Result<Vec<bool>, Vec<u32>> {
    let mut order: Vec<(f64, u32)> = cost.iter().zip(0..).filter_map(|(c, i)| c.map(|c| (c, i))).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut rank: Vec<Option<u32>> = vec![None; cost.len()];
    for (r, &(_, column)) in order.iter().enumerate() {
        rank[column as usize] = Some(r as u32);
    }
    // Each row holds its columns by rank, its right-hand side, and the given rows that it is the sum of. In echelon
    // form the leading column of each row is its cheapest.
    struct Row {
        columns: Vec<u32>,
        odd: bool,
        sum_of: Vec<u32>,
    }
    let mut reduced: Vec<Row> = Vec::new();
    let mut by_leading: FxHashMap<u32, usize> = FxHashMap::default();
    for (r, columns) in rows.iter().enumerate() {
        let mut columns: Vec<u32> = columns.iter().filter_map(|&c| rank[c as usize]).collect();
        columns.sort_unstable();
        let mut row = Row { columns, odd: odd[r], sum_of: vec![r as u32] };
        while let Some(&pivot) = row.columns.first().and_then(|leading| by_leading.get(leading)) {
            let other = &reduced[pivot];
            row.columns = symmetric_difference(&row.columns, &other.columns);
            row.sum_of = symmetric_difference(&row.sum_of, &other.sum_of);
            row.odd ^= other.odd;
        }
        match row.columns.first() {
            Some(&leading) => {
                by_leading.insert(leading, reduced.len());
                reduced.push(row);
            }
            None if row.odd => return Err(row.sum_of),
            None => {}
        }
    }
    reduced.sort_by_key(|row| std::cmp::Reverse(row.columns[0]));
    let mut toggled = vec![false; cost.len()];
    for row in &reduced {
        // All other columns of the row cost more: they are decided already, or are no pivots and stay unchanged.
        let rest = row.columns[1..].iter().fold(row.odd, |sum, &c| sum ^ toggled[order[c as usize].1 as usize]);
        toggled[order[row.columns[0] as usize].1 as usize] = rest;
    }
    Ok(toggled)
}

/// As [`toggles`], with as few columns as possible, of these the cheapest, where that can be found: every column is in
/// at most two rows, and few rows are odd. Rows are then the vertices of a graph, columns its edges (one of a single
/// row leads to the outside), and the toggles pair the odd vertices by shortest paths.
///
/// # Errors
/// As [`toggles`].
pub fn fewest_toggles(rows: &[Vec<u32>], odd: &[bool], cost: &[Option<f64>]) -> Result<Vec<bool>, Vec<u32>> {
    let feasible = toggles(rows, odd, cost)?;
    let mut ends: Vec<Vec<u32>> = vec![Vec::new(); cost.len()];
    for (r, columns) in (0..).zip(rows) {
        columns.iter().for_each(|&c| ends[c as usize].push(r));
    }
    if ends.iter().any(|ends| ends.len() > 2) {
        return Ok(feasible);
    }
    let outside = rows.len() as u32;
    let mut graph: Vec<Vec<(u32, u32, Path)>> = vec![Vec::new(); rows.len() + 1];
    for (c, (ends, cost)) in (0..).zip(ends.iter().zip(cost)) {
        if let (&[a, ref rest @ ..], Some(cost)) = (&ends[..], cost) {
            let b = rest.first().copied().unwrap_or(outside);
            let step = Path { columns: 1, cost: *cost };
            graph[a as usize].push((b, c, step));
            graph[b as usize].push((a, c, step));
        }
    }
    let mut terminals: Vec<u32> = (0..outside).filter(|&r| odd[r as usize]).collect();
    // The outside takes what is left over of the part that reaches it.
    let (from_outside, _) = shortest(&graph, outside);
    if terminals.iter().filter(|&&r| from_outside[r as usize].is_some()).count() % 2 == 1 {
        terminals.push(outside);
    }
    if terminals.len() > MOST_ODD {
        return Ok(feasible);
    }
    let trees: Vec<_> = terminals.iter().map(|&r| shortest(&graph, r)).collect();
    let between = |a: usize, b: usize| trees[a].0[terminals[b] as usize];
    let mut toggled = vec![false; cost.len()];
    for [a, b] in pairs(terminals.len(), &between) {
        let mut at = terminals[b];
        while let Some((before, column)) = trees[a].1[at as usize] {
            toggled[column as usize] ^= true;
            at = before;
        }
    }
    Ok(toggled)
}

/// What a path takes: fewer columns are better, then lower cost.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Path {
    columns: u32,
    cost: f64,
}

impl Path {
    fn and(self, other: Path) -> Path {
        Path { columns: self.columns + other.columns, cost: self.cost + other.cost }
    }

    /// Sorts like the path: the bits of positive numbers sort like the numbers.
    fn key(self) -> (u32, u64) {
        (self.columns, self.cost.to_bits())
    }
}

/// The best path from a vertex to each other one, and the last step of it: the vertex before and the column.
type Tree = (Vec<Option<Path>>, Vec<Option<(u32, u32)>>);

/// Dijkstra's algorithm; ties go to the lower vertex.
fn shortest(graph: &[Vec<(u32, u32, Path)>], from: u32) -> Tree {
    let (mut best, mut step) = (vec![None; graph.len()], vec![None; graph.len()]);
    let none = Path { columns: 0, cost: 0.0 };
    best[from as usize] = Some(none);
    let mut heap = BinaryHeap::from([Reverse((none.key(), from))]);
    while let Some(Reverse((key, at))) = heap.pop() {
        let Some(here) = best[at as usize].filter(|path: &Path| path.key() == key) else { continue };
        for &(to, column, more) in &graph[at as usize] {
            let there = here.and(more);
            if best[to as usize].is_none_or(|known| there.key() < known.key()) {
                best[to as usize] = Some(there);
                step[to as usize] = Some((at, column));
                heap.push(Reverse((there.key(), to)));
            }
        }
    }
    (best, step)
}

/// The pairs of `n` terminals with the best sum of paths between them.
fn pairs(n: usize, between: &dyn Fn(usize, usize) -> Option<Path>) -> Vec<[usize; 2]> {
    // The best pairs of each set of terminals that are left over, by its bits.
    let mut best: Vec<Option<(Path, usize, usize)>> = vec![None; 1 << n];
    let mut sum: Vec<Option<Path>> = vec![None; 1 << n];
    sum[0] = Some(Path { columns: 0, cost: 0.0 });
    for set in 1_usize..1 << n {
        let a = set.trailing_zeros() as usize;
        for b in (a + 1..n).filter(|b| set >> b & 1 == 1) {
            if let (Some(rest), Some(path)) = (sum[set & !(1 << a) & !(1 << b)], between(a, b)) {
                let all = rest.and(path);
                if best[set].is_none_or(|(known, ..)| all.key() < known.key()) {
                    best[set] = Some((all, a, b));
                }
            }
        }
        sum[set] = best[set].map(|(all, ..)| all);
    }
    let (mut found, mut set) = (Vec::new(), (1 << n) - 1);
    while let Some((_, a, b)) = best[set] {
        found.push([a, b]);
        set &= !(1 << a) & !(1 << b);
    }
    found
}

/// The symmetric difference of two ascending lists.
fn symmetric_difference(a: &[u32], b: &[u32]) -> Vec<u32> {
    let mut both = [a, b].concat();
    // The stable sort merges two ascending runs in linear time.
    both.sort();
    both.chunk_by(|x, y| x == y).filter(|equal| equal.len() == 1).map(|single| single[0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sum(row: &[u32], x: impl Fn(u32) -> bool) -> bool {
        row.iter().fold(false, |s, &c| s ^ x(c))
    }

    proptest! {
        #[test]
        fn solutions_agree_with_brute_force(
            rows in prop::collection::vec(prop::collection::btree_set(0_u32..8, 0..6), 0..7),
            odd in prop::collection::vec(any::<bool>(), 7),
            cost in prop::collection::vec(prop::option::weighted(0.7, 0.0..1.0), 8),
        ) {
            let rows: Vec<Vec<u32>> = rows.into_iter().map(|r| r.into_iter().collect()).collect();
            let allowed = |x: u32| (0..8).all(|c| x >> c & 1 == 0 || cost[c].is_some());
            let solves = |x: u32| (0..rows.len()).all(|r| sum(&rows[r], |c| x >> c & 1 == 1) == odd[r]);
            let feasible = (0..256).any(|x| allowed(x) && solves(x));
            match toggles(&rows, &odd[..rows.len()], &cost) {
                Ok(toggled) => {
                    let x = (0..8).map(|c| u32::from(toggled[c]) << c).sum();
                    prop_assert!(allowed(x) && solves(x));
                }
                Err(blamed) => {
                    prop_assert!(!feasible);
                    // The blamed rows alone prove it.
                    prop_assert!(blamed.iter().fold(false, |s, &r| s ^ odd[r as usize]));
                    for c in (0..8).filter(|&c| cost[c as usize].is_some()) {
                        prop_assert_eq!(blamed.iter().filter(|&&r| rows[r as usize].contains(&c)).count() % 2, 0);
                    }
                }
            }
        }

        #[test]
        fn the_fewest_toggles_are_as_few_as_by_brute_force(
            sides in prop::collection::vec((0_usize..6, 0_usize..6), 1..11),
            odd in prop::collection::vec(any::<bool>(), 5),
            cost in prop::collection::vec(0.01..1.0, 11),
        ) {
            // Part 5 is the outside: it has no row.
            let mut rows = vec![Vec::new(); 6];
            for (c, &(a, b)) in sides.iter().enumerate().filter(|(_, (a, b))| a != b) {
                rows[a].push(c as u32);
                rows[b].push(c as u32);
            }
            rows.pop();
            let cost: Vec<Option<f64>> = cost[..sides.len()].iter().map(|&cost| Some(cost)).collect();
            let solves = |x: u32| (0..5).all(|r| sum(&rows[r], |c| x >> c & 1 == 1) == odd[r]);
            let price = |x: u32| {
                let of = cost.iter().enumerate().filter(|(c, _)| x >> c & 1 == 1);
                (x.count_ones(), of.map(|(_, cost)| cost.unwrap()).sum::<f64>())
            };
            let all = (0..1_u32 << sides.len()).filter(|&x| solves(x)).map(price);
            let least = all.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            match (fewest_toggles(&rows, &odd, &cost), least) {
                (Ok(toggled), Some((count, paid))) => {
                    let x = (0..sides.len()).map(|c| u32::from(toggled[c]) << c).sum();
                    prop_assert!(solves(x));
                    prop_assert_eq!(price(x).0, count);
                    prop_assert!((price(x).1 - paid).abs() < 1e-9);
                }
                (found, least) => prop_assert!(found.is_err() && least.is_none()),
            }
        }

        /// Random complexes: every curve bounds one loop or two, all may be toggled.
        #[test]
        fn complexes_of_free_curves_can_always_be_made_even(
            sides in prop::collection::vec((0_usize..5, 0_usize..6), 1..14),
            counts in prop::collection::vec(1_u32..9, 14),
        ) {
            let mut rows = vec![Vec::new(); 6];
            for (c, &(a, b)) in sides.iter().enumerate() {
                if a != b {
                    rows[a].push(c as u32);
                    rows[b].push(c as u32);
                }
            }
            rows.pop(); // The outside.
            let odd: Vec<bool> = rows.iter().map(|r| sum(r, |c| counts[c as usize] % 2 == 1)).collect();
            let cost: Vec<Option<f64>> = (0..sides.len()).map(|c| Some(1.0 / f64::from(counts[c]))).collect();
            let toggled = toggles(&rows, &odd, &cost).unwrap();
            for (row, odd) in rows.iter().zip(odd) {
                prop_assert_eq!(sum(row, |c| toggled[c as usize]), odd);
            }
        }
    }

    #[test]
    fn the_cheapest_curve_of_a_loop_is_toggled() {
        let toggled = toggles(&[vec![0, 1, 2]], &[true], &[Some(0.5), Some(0.1), Some(0.3)]).unwrap();
        assert_eq!(toggled, [false, true, false]);
    }

    #[test]
    fn a_loop_of_fixed_curves_is_blamed_alone() {
        let rows = [vec![0, 1], vec![1, 2]];
        assert_eq!(toggles(&rows, &[false, true], &[Some(0.1), None, None]), Err(vec![1]));
        assert_eq!(toggles(&rows, &[true, true], &[None, Some(0.1), None]), Ok(vec![false, true, false]));
        assert_eq!(toggles(&rows, &[true, false], &[None, Some(0.1), None]), Err(vec![0, 1]));
    }
}
