//! Even loops (docs/algorithm.md, "Even loops"): which curves get one segment more or fewer, so that every topological
//! loop is even. A linear system over GF(2) with a row for each loop and a column for each curve.

use rustc_hash::FxHashMap;

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
