//! Sparse linear systems whose rows are weighted means: x_i = sum_j w_ij x_j + b_i, with positive weights that add up to 1 at most.
//! Solved by BiCGSTAB (van der Vorst 1992) with an incomplete factorisation that keeps the pattern (ILU(0)), which exists
//! for such matrices. Plain loops in one order: the same numbers on every machine, which libraries that choose their
//! arithmetic by the processor do not promise.

/// The matrix I - W, row by row: columns ascending, the diagonal among them.
pub struct Means {
    start: Vec<u32>,
    column: Vec<u32>,
    value: Vec<f64>,
    /// Where the diagonal of each row stands.
    diagonal: Vec<u32>,
}

/// Steps that are tried.
const MOST_STEPS: usize = 4000;

/// A matrix with its factors.
pub struct Solver {
    means: Means,
    factors: Vec<f64>,
}

impl Solver {
    /// The solution for a right side, sought from `x` on until no equation misses by more than `near`, or as near as rounding lets it;
    /// `None` where there is none, or where `goes_on`, which is asked before each step, does not want it any more.
    pub fn solve(&self, b: &[f64], x: Vec<f64>, near: f64, goes_on: &mut dyn FnMut() -> bool) -> Option<Vec<f64>> {
        self.means.solve(&self.factors, b, x, near, goes_on)
    }
}

impl Means {
    /// The matrix of rows of columns with weights; the columns are numbered as the rows.
    pub fn new(rows: impl Iterator<Item = Vec<(u32, f64)>>) -> Means {
        let mut means = Means { start: vec![0], column: Vec::new(), value: Vec::new(), diagonal: Vec::new() };
        for (i, mut row) in rows.enumerate() {
            row.iter_mut().for_each(|(_, weight)| *weight = -*weight);
            row.push((i as u32, 1.0));
            row.sort_by_key(|&(column, _)| column);
            for (column, value) in row {
                if column as usize == i {
                    means.diagonal.push(means.column.len() as u32);
                }
                means.column.push(column);
                means.value.push(value);
            }
            means.start.push(means.column.len() as u32);
        }
        means
    }

    fn rows(&self) -> usize {
        self.diagonal.len()
    }

    fn row(&self, i: usize) -> std::ops::Range<usize> {
        self.start[i] as usize..self.start[i + 1] as usize
    }

    fn times(&self, x: &[f64], out: &mut [f64]) {
        for (i, out) in out.iter_mut().enumerate() {
            *out = self.row(i).map(|k| self.value[k] * x[self.column[k] as usize]).sum();
        }
    }

    /// The factors L and U in the pattern of the matrix, L with a unit diagonal.
    fn factors(&self) -> Vec<f64> {
        let mut f = self.value.clone();
        let mut place = vec![u32::MAX; self.rows()];
        for i in 0..self.rows() {
            let row = self.row(i);
            row.clone().for_each(|k| place[self.column[k] as usize] = k as u32);
            for k in row.start..self.diagonal[i] as usize {
                let j = self.column[k] as usize;
                let pivot = self.diagonal[j] as usize;
                f[k] /= f[pivot];
                for l in pivot + 1..self.row(j).end {
                    let at = place[self.column[l] as usize];
                    if at != u32::MAX {
                        f[at as usize] -= f[k] * f[l];
                    }
                }
            }
            row.for_each(|k| place[self.column[k] as usize] = u32::MAX);
        }
        f
    }

    fn precondition(&self, f: &[f64], x: &mut [f64]) {
        for i in 0..self.rows() {
            let before = self.start[i] as usize..self.diagonal[i] as usize;
            x[i] -= before.map(|k| f[k] * x[self.column[k] as usize]).sum::<f64>();
        }
        for i in (0..self.rows()).rev() {
            let pivot = self.diagonal[i] as usize;
            let after = pivot + 1..self.row(i).end;
            x[i] = (x[i] - after.map(|k| f[k] * x[self.column[k] as usize]).sum::<f64>()) / f[pivot];
        }
    }

    /// The matrix with its factors, ready to be solved again and again.
    pub fn factored(self) -> Solver {
        let factors = self.factors();
        Solver { means: self, factors }
    }

    fn solve(
        &self,
        factors: &[f64],
        b: &[f64],
        mut x: Vec<f64>,
        near: f64,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Vec<f64>> {
        let n = self.rows();
        let mut work = vec![0.0; n];
        let (mut p, mut v) = (vec![0.0; n], vec![0.0; n]);
        let mut residual = vec![0.0; n];
        // Begun again from where it stands when it loses its way.
        for _ in 0..8 {
            self.times(&x, &mut work);
            (0..n).for_each(|i| residual[i] = b[i] - work[i]);
            if largest(&residual) <= near {
                return Some(x);
            }
            let shadow = residual.clone();
            let (mut rho, mut alpha, mut omega) = (1.0, 1.0, 1.0);
            p.fill(0.0);
            v.fill(0.0);
            for _ in 0..MOST_STEPS {
                if !goes_on() {
                    return None;
                }
                let new = dot(&shadow, &residual);
                let beta = new / rho * (alpha / omega);
                if !beta.is_finite() || new == 0.0 {
                    break;
                }
                rho = new;
                (0..n).for_each(|i| p[i] = residual[i] + beta * (p[i] - omega * v[i]));
                let mut y = p.clone();
                self.precondition(factors, &mut y);
                self.times(&y, &mut v);
                alpha = rho / dot(&shadow, &v);
                if !alpha.is_finite() {
                    break;
                }
                (0..n).for_each(|i| {
                    x[i] += alpha * y[i];
                    residual[i] -= alpha * v[i];
                });
                let mut z = residual.clone();
                self.precondition(factors, &mut z);
                self.times(&z, &mut work);
                let square = dot(&work, &work);
                omega = if square > 0.0 { dot(&work, &residual) / square } else { 0.0 };
                (0..n).for_each(|i| {
                    x[i] += omega * z[i];
                    residual[i] -= omega * work[i];
                });
                if largest(&residual) <= 0.5 * near || omega == 0.0 || !omega.is_finite() {
                    break;
                }
            }
            if x.iter().any(|x| !x.is_finite()) {
                return None;
            }
        }
        // As near as it gets: whoever asked looks whether that is enough.
        Some(x)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_along_a_line_between_two_fixed_ends_are_linear_or_as_the_weights_pull() {
        let n = 1000;
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
            let mut b = vec![0.0; n as usize];
            b[n as usize - 1] = 1.0 - pull;
            let x =
                Means::new((0..n).map(row)).factored().solve(&b, vec![0.0; n as usize], 1e-13, &mut || true).unwrap();
            for i in 0..n as usize {
                let before = if i == 0 { 0.0 } else { x[i - 1] };
                let after = if i + 1 == n as usize { 1.0 } else { x[i + 1] };
                assert!((x[i] - pull * before - (1.0 - pull) * after).abs() < 1e-12);
            }
            assert!(pull != 0.5 || (x[499] - 500.0 / 1001.0).abs() < 1e-9, "{}", x[499]);
        }
    }
}
