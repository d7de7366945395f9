//! Sparse linear systems of weighted means: x_i = sum_j w_ij x_j + b_i, with positive weights whose sum is at most 1
//! and a symmetric pattern. Solved by LU factors, which need no pivoting here, row by row along the elimination tree
//! (Davis, Direct Methods for Sparse Linear Systems, 2006, chapter 4, there for symmetric matrices), in the order of a
//! nested dissection. Plain loops in a fixed order give the same numbers on every machine, unlike libraries that
//! dispatch on the processor.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};

use super::dissection::{self, Pattern};

/// The matrix I - W in rows, with ascending columns including the diagonal.
pub struct Means {
    start: Vec<u32>,
    column: Vec<u32>,
    value: Vec<f64>,
}

/// Limit on the mean number of entries of L in a column; large surfaces need about 60.
const MOST_FILLED: usize = 400;
/// Rows eliminated between two checks for cancellation.
const BATCH: usize = 64;
const NONE: u32 = u32::MAX;

impl Means {
    /// The matrix with the given rows of column and weight.
    pub fn new(rows: impl Iterator<Item = Vec<(u32, f64)>>) -> Means {
        let mut means = Means { start: vec![0], column: Vec::new(), value: Vec::new() };
        for (i, mut row) in rows.enumerate() {
            row.iter_mut().for_each(|(_, weight)| *weight = -*weight);
            row.push((i as u32, 1.0));
            row.sort_by_key(|&(column, _)| column);
            means.column.extend(row.iter().map(|entry| entry.0));
            means.value.extend(row.iter().map(|entry| entry.1));
            means.start.push(means.column.len() as u32);
        }
        means
    }

    fn rows(&self) -> usize {
        self.start.len() - 1
    }

    fn row(&self, i: usize) -> std::ops::Range<usize> {
        self.start[i] as usize..self.start[i + 1] as usize
    }

    /// The residual b - (I - W) x.
    fn residual(&self, x: &[DVec2], b: &[DVec2]) -> Vec<DVec2> {
        let times = |i: usize| self.row(i).map(|k| self.value[k] * x[self.column[k] as usize]).sum::<DVec2>();
        b.iter().enumerate().map(|(i, b)| b - times(i)).collect()
    }

    /// Factors the matrix; `places` are the positions of the nodes, for the dissection. `None` if the fill-in exceeds
    /// the limit, or when `goes_on`, called at intervals, returns false.
    pub fn factored(self, places: &[DVec3], goes_on: &dyn Fn() -> bool) -> Option<Solver> {
        let n = self.rows();
        let order = dissection::order(Pattern { start: &self.start, column: &self.column }, places, goes_on)?;
        let mut position = vec![0_u32; n];
        order.iter().zip(0..).for_each(|(&old, new)| position[old as usize] = new);
        let tree = self.tree(&order, &position);
        let mut reach = Reach { mark: vec![NONE; n], stack: vec![0; n], path: Vec::new() };
        // Entries of each column of L below the diagonal, which is also the number in each row of U.
        let mut start = vec![0_usize; n + 1];
        for k in 0..n {
            if k.is_multiple_of(BATCH) && !goes_on() {
                return None;
            }
            reach.of(k, self.before(&order, &position, k), &tree).iter().for_each(|&i| start[i as usize + 1] += 1);
        }
        (0..n).for_each(|i| start[i + 1] += start[i]);
        if start[n] > MOST_FILLED * n {
            return None;
        }
        let mut end: Vec<usize> = start[..n].to_vec();
        let mut factors = Factors::of(start[n]);
        let mut diagonal = vec![0.0; n];
        let (mut left, mut above) = (vec![0.0; n], vec![0.0; n]);
        reach.mark.fill(NONE);
        for k in 0..n {
            if k.is_multiple_of(BATCH) && !goes_on() {
                return None;
            }
            let mut pivot = 0.0;
            for at in self.row(order[k] as usize) {
                let i = position[self.column[at] as usize] as usize;
                match i.cmp(&k) {
                    Ordering::Less => {
                        left[i] = self.value[at];
                        above[i] = self.value_at(self.column[at] as usize, order[k]);
                    }
                    Ordering::Equal => pivot = self.value[at],
                    Ordering::Greater => {}
                }
            }
            for &i in reach.of(k, self.before(&order, &position, k), &tree) {
                let i = i as usize;
                let (l, u) = (left[i] / diagonal[i], above[i]);
                (left[i], above[i]) = (0.0, 0.0);
                let so_far = start[i]..end[i];
                let values = factors.lower[so_far.clone()].iter().zip(&factors.upper[so_far.clone()]);
                for (&row, (lower, upper)) in factors.row[so_far].iter().zip(values) {
                    left[row as usize] -= l * upper;
                    above[row as usize] -= lower * u;
                }
                pivot -= l * u;
                (factors.row[end[i]], factors.lower[end[i]], factors.upper[end[i]]) = (k as u32, l, u);
                end[i] += 1;
            }
            diagonal[k] = pivot;
        }
        Some(Solver { means: self, order, start, factors, diagonal })
    }

    /// The entry of a row in a column.
    fn value_at(&self, row: usize, column: u32) -> f64 {
        let row = self.row(row);
        self.column[row.clone()].binary_search(&column).map_or(0.0, |k| self.value[row.start + k])
    }

    /// The positions of a row's entries before its diagonal, in elimination order.
    fn before<'a>(&'a self, order: &[u32], position: &'a [u32], k: usize) -> impl Iterator<Item = u32> + 'a {
        let columns = &self.column[self.row(order[k] as usize)];
        columns.iter().map(|&column| position[column as usize]).filter(move |&i| (i as usize) < k)
    }

    /// The elimination tree: for each row, the first later row that its elimination changes.
    fn tree(&self, order: &[u32], position: &[u32]) -> Vec<u32> {
        let n = self.rows();
        let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
        for k in 0..n as u32 {
            for mut i in self.before(order, position, k as usize) {
                while i != NONE && i < k {
                    let next = std::mem::replace(&mut ancestor[i as usize], k);
                    if next == NONE {
                        parent[i as usize] = k;
                    }
                    i = next;
                }
            }
        }
        parent
    }
}

/// Finds the earlier rows that take part in the elimination of a row, along the elimination tree.
struct Reach {
    mark: Vec<u32>,
    stack: Vec<u32>,
    path: Vec<u32>,
}

impl Reach {
    /// The rows in topological order.
    fn of(&mut self, k: usize, before: impl Iterator<Item = u32>, parent: &[u32]) -> &[u32] {
        let mut top = self.stack.len();
        self.mark[k] = k as u32;
        for mut i in before {
            self.path.clear();
            while self.mark[i as usize] != k as u32 {
                self.mark[i as usize] = k as u32;
                self.path.push(i);
                i = parent[i as usize];
            }
            while let Some(i) = self.path.pop() {
                top -= 1;
                self.stack[top] = i;
            }
        }
        &self.stack[top..]
    }
}

/// The entries of L, and their mirror images in U, column by column of L. Arrays of their own, because each half of a
/// solution reads one of them: its time is that of reading memory.
struct Factors {
    row: Vec<u32>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

impl Factors {
    fn of(entries: usize) -> Factors {
        Factors { row: vec![0; entries], lower: vec![0.0; entries], upper: vec![0.0; entries] }
    }
}

/// A factored matrix.
pub struct Solver {
    means: Means,
    /// The rows in elimination order.
    order: Vec<u32>,
    /// Offset of each column of L.
    start: Vec<usize>,
    factors: Factors,
    diagonal: Vec<f64>,
}

impl Solver {
    /// The solution for right-hand sides of two coordinates, refined once; `None` if it is not finite.
    pub fn solve(&self, b: &[DVec2]) -> Option<Vec<DVec2>> {
        let mut x = self.once(b);
        let more = self.once(&self.means.residual(&x, b));
        x.iter_mut().zip(more).for_each(|(x, more)| *x += more);
        x.iter().all(|x| x.is_finite()).then_some(x)
    }

    fn once(&self, b: &[DVec2]) -> Vec<DVec2> {
        let mut y: Vec<DVec2> = self.order.iter().map(|&old| b[old as usize]).collect();
        let of = |values, i: usize| {
            let column = self.start[i]..self.start[i + 1];
            let values: &[f64] = values;
            self.factors.row[column.clone()].iter().zip(&values[column])
        };
        for i in 0..y.len() {
            let own = y[i];
            of(&self.factors.lower, i).for_each(|(&row, &lower)| y[row as usize] -= lower * own);
        }
        for i in (0..y.len()).rev() {
            let known: DVec2 = of(&self.factors.upper, i).map(|(&row, &upper)| upper * y[row as usize]).sum();
            y[i] = (y[i] - known) / self.diagonal[i];
        }
        let mut x = vec![DVec2::ZERO; y.len()];
        self.order.iter().zip(y).for_each(|(&old, y)| x[old as usize] = y);
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::edges::{Edges, Triangles};
    use crate::core::discrete::fixtures::{double_cone, strip, tube};

    /// Entries of L per node, for means of a node of triangles and its neighbours.
    fn fill_in(mesh: &Triangles) -> f64 {
        let n = mesh.points.len();
        let mut near: Vec<Vec<u32>> = vec![Vec::new(); n];
        let edges = Edges::of(&mesh.triangles);
        for [a, b] in (0..edges.len()).map(|edge| edges.get(edge).ends) {
            near[a as usize].push(b);
            near[b as usize].push(a);
        }
        let rows = near.into_iter().map(|near| {
            let weight = 1.0 / (near.len() + 1) as f64;
            near.into_iter().map(|other| (other, weight)).collect()
        });
        let solver = Means::new(rows).factored(&mesh.points, &|| true).expect("little fill-in");
        let ones = vec![DVec2::ONE; n];
        let x = solver.solve(&ones).expect("a solution");
        let residual = solver.means.residual(&x, &ones).into_iter();
        let largest = residual.fold(0.0_f64, |most, r| most.max(r.abs().max_element()));
        assert!(largest < 1e-9, "{largest}");
        solver.factors.row.len() as f64 / n as f64
    }

    #[test]
    fn fill_in_grows_with_the_number_of_nodes_whatever_the_shape_of_triangles() {
        for (name, make, most) in [
            ("a ring of long triangles", (|n| tube(n, 1, 30.0)) as fn(u32) -> Triangles, 12.0),
            ("a ring of short triangles", |n| tube(n, 1, 0.01), 16.0),
            ("two rows", |n| tube(n, 2, 30.0), 20.0),
            ("a tube of eight sides", |n| tube(8, n / 8, 30.0), 40.0),
            ("a strip", |n| strip(n, 1.0), 12.0),
            ("a strip of slivers", |n| strip(n, 1e4), 12.0),
            ("two hubs", double_cone, 12.0),
        ] {
            let entries = [4000, 32_000].map(|n| fill_in(&make(n)));
            assert!(entries.into_iter().all(|own| own < most), "{name}: {entries:?}");
        }
        // A grid has more than a proportional part, as it must.
        let [small, large] = [32, 128].map(|n| fill_in(&tube(n, n, 1.0)));
        assert!(large < 70.0 && large < 2.0 * small, "{small} and {large}");
    }

    #[test]
    fn means_between_two_fixed_ends_solve_their_equations() {
        let n = 1000;
        let places: Vec<DVec3> = (0..n).map(|i| DVec3::X * f64::from(i * 7 % n)).collect();
        for pull in [0.5, 0.45] {
            let row = |i: u32| {
                let mut row = Vec::new();
                if i > 0 {
                    row.push((i - 1, pull));
                }
                if i + 1 < n {
                    row.push((i + 1, 1.0 - pull));
                }
                row
            };
            // The second coordinate is fixed at the other end.
            let (first, last) = (DVec2::new(0.0, 1.0), DVec2::new(1.0, 0.0));
            let mut b = vec![DVec2::ZERO; n as usize];
            b[0] = pull * first;
            b[n as usize - 1] = (1.0 - pull) * last;
            let x = Means::new((0..n).map(row)).factored(&places, &|| true).unwrap().solve(&b).unwrap();
            for i in 0..n as usize {
                let before = if i == 0 { first } else { x[i - 1] };
                let after = if i + 1 == n as usize { last } else { x[i + 1] };
                assert!((x[i] - pull * before - (1.0 - pull) * after).length() < 1e-12);
            }
            let share = 500.0 / 1001.0;
            assert!(pull != 0.5 || x[499].distance(DVec2::new(share, 1.0 - share)) < 1e-9, "{}", x[499]);
        }
    }

    #[test]
    fn means_on_a_grid_have_small_residual_and_little_fill_in() {
        const N: u32 = 60;
        let places: Vec<DVec3> = (0..N * N).map(|k| DVec3::new(f64::from(k % N), f64::from(k / N), 0.0)).collect();
        let weight = |i: u32, j: u32| f64::from(1 + (i * 31 + j * 17) % 97);
        let rows = (0..N * N).map(|i| {
            let (x, y) = (i % N, i / N);
            let beside =
                [(x > 0, i.wrapping_sub(1)), (x + 1 < N, i + 1), (y > 0, i.wrapping_sub(N)), (y + 1 < N, i + N)];
            let row: Vec<(u32, f64)> = beside.iter().filter(|b| b.0).map(|b| (b.1, weight(i, b.1))).collect();
            // The border is held a little, so that there is one solution.
            let sum: f64 = row.iter().map(|w| w.1).sum::<f64>() + if row.len() < 4 { 1.0 } else { 0.0 };
            row.into_iter().map(|(j, w)| (j, w / sum)).collect()
        });
        let b: Vec<DVec2> =
            (0..N * N).map(|i| DVec2::new(f64::from(i * 13 % 29) - 14.0, f64::from(i * 7 % 31) - 15.0)).collect();
        let solver = Means::new(rows).factored(&places, &|| true).unwrap();
        let x = solver.solve(&b).unwrap();
        let largest = |x: &[DVec2]| x.iter().fold(0.0_f64, |largest, x| x.abs().max_element().max(largest));
        assert!(largest(&solver.means.residual(&x, &b)) < 1e-12 * largest(&x), "{}", largest(&x));
        assert!(solver.factors.row.len() < 24 * (N * N) as usize, "{}", solver.factors.row.len());
        assert!(Means::new((0..2).map(|_| Vec::new())).factored(&places, &|| false).is_none());
    }
}
