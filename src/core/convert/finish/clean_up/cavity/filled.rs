//! The quadrilaterals of a filling, with first places for its new nodes.

use glam::DVec2;

use super::filling::Filling;

/// Quadrilaterals within a polygon. Nodes are numbered: first those of the polygon, anticlockwise from its first
/// corner, then the new ones.
#[derive(Clone, Debug, Default)]
pub(super) struct Filled {
    /// The corners of each, anticlockwise.
    pub quads: Vec<[u32; 4]>,
    /// The places of all nodes.
    pub places: Vec<DVec2>,
}

/// Nodes along a side, both ends included.
type Chain = Vec<u32>;

/// Carries out a filling of the polygon with nodes at these places, whose sides have so many edges.
pub(super) fn fill(filling: &Filling, sides: &[u32], places: impl Iterator<Item = DVec2>, filled: &mut Filled) {
    filled.quads.clear();
    filled.places.clear();
    filled.places.extend(places);
    let all = filled.places.len() as u32;
    let mut start = 0;
    let chains: Vec<Chain> = sides
        .iter()
        .map(|&edges| {
            let chain = (start..=start + edges).map(|k| k % all).collect();
            start += edges;
            chain
        })
        .collect();
    filled.fill(filling, &chains);
}

fn reversed(chain: &[u32]) -> Chain {
    chain.iter().rev().copied().collect()
}

impl Filled {
    /// Bytes that it takes.
    pub fn bytes(&self) -> usize {
        size_of::<[u32; 4]>() * self.quads.capacity() + size_of::<DVec2>() * self.places.capacity()
    }

    fn at(&self, node: u32) -> DVec2 {
        self.places[node as usize]
    }

    fn new_node(&mut self, place: DVec2) -> u32 {
        self.places.push(place);
        self.places.len() as u32 - 1
    }

    /// A straight line of new nodes between two nodes.
    fn line(&mut self, from: u32, to: u32, edges: u32) -> Chain {
        let (a, b) = (self.at(from), self.at(to));
        let mut chain = vec![from];
        for k in 1..edges {
            let node = self.new_node(a + (b - a) * (f64::from(k) / f64::from(edges)));
            chain.push(node);
        }
        chain.push(to);
        chain
    }

    fn fill(&mut self, filling: &Filling, sides: &[Chain]) {
        let n = sides.len();
        match filling {
            Filling::Grid => self.grid([&sides[0], &sides[1], &sides[2], &sides[3]]),
            Filling::Star(spokes) => {
                // Side k is met after s_(k-1) edges.
                let met = |k: usize| sides[k][spokes[(k + n - 1) % n] as usize];
                let middle = (0..n).map(|k| self.at(met(k))).sum::<DVec2>() / n as f64;
                let middle = self.new_node(middle);
                let lines: Vec<Chain> = (0..n).map(|k| self.line(met(k), middle, spokes[k])).collect();
                for k in 0..n {
                    let before = (k + n - 1) % n;
                    let cut = [k, before].map(|side| spokes[(side + n - 1) % n] as usize);
                    let (first, last) = (&sides[k][..=cut[0]], &sides[before][cut[1]..]);
                    self.grid([first, &lines[k], &reversed(&lines[before]), last]);
                }
            }
            Filling::Corner { corner, along, rest } => {
                let (before, after) = (&sides[(corner + n - 1) % n], &sides[*corner]);
                let [x, z] = along.map(|edges| edges as usize);
                let cut = before.len() - 1 - x;
                let (p, q) = (before[cut], after[z]);
                let bend = self.at(p) + self.at(q) - self.at(after[0]);
                let bend = self.new_node(bend);
                // The rectangle: along the side after the corner, to the bend, to the side before it, back.
                let up = self.line(q, bend, along[0]);
                let across = self.line(bend, p, along[1]);
                self.grid([&after[..=z], &up, &across, &before[cut..]]);
                let inner: Chain = reversed(&across).into_iter().chain(reversed(&up).into_iter().skip(1)).collect();
                let mut left: Vec<Chain> = vec![before[..=cut].to_vec(), inner, after[z..].to_vec()];
                left.extend((1..n - 1).map(|k| sides[(corner + k) % n].clone()));
                self.fill(rest, &left);
            }
            Filling::Layers { layers, grid: [columns, rows] } => {
                let inner = self.layers(&sides[0], *layers, (*columns).min(*rows));
                let mut at = 0;
                let [bottom, right, top, left] = [*columns, *rows, *columns, *rows].map(|edges| {
                    let side: Chain = (at..=at + edges).map(|k| inner[k as usize % inner.len()]).collect();
                    at += edges;
                    side
                });
                self.grid([&bottom, &right, &top, &left]);
            }
            Filling::Line { sides: [i, j], at, length, parts } => {
                let [x, z] = at.map(|edges| edges as usize);
                let line = self.line(sides[*i][x], sides[*j][z], *length);
                for (part, (from, to, line)) in
                    parts.iter().zip([((*j, z), (*i, x), line.clone()), ((*i, x), (*j, z), reversed(&line))])
                {
                    let mut around = vec![line, sides[from.0][from.1..].to_vec()];
                    let mut k = (from.0 + 1) % n;
                    while k != to.0 {
                        around.push(sides[k].clone());
                        k = (k + 1) % n;
                    }
                    around.push(sides[to.0][..=to.1].to_vec());
                    self.fill(part, &around);
                }
            }
        }
    }

    /// Layers along a closed border, each as many quadrilaterals as the border has edges, around a grid so many edges
    /// wide. Returns the nodes of the innermost border.
    fn layers(&mut self, border: &[u32], layers: u32, width: u32) -> Chain {
        // The last node is the first one.
        let mut outer: Chain = border[..border.len() - 1].to_vec();
        let middle = outer.iter().map(|&n| self.at(n)).sum::<DVec2>() / outer.len() as f64;
        let all = f64::from(layers) + 0.5 * f64::from(width);
        for layer in 0..layers {
            // What is left of the way to the middle.
            let share = (all - f64::from(layer) - 1.0) / (all - f64::from(layer));
            let inner: Chain = outer.iter().map(|&n| self.new_node(middle + (self.at(n) - middle) * share)).collect();
            for k in 0..outer.len() {
                let next = (k + 1) % outer.len();
                self.quads.push([outer[k], outer[next], inner[next], inner[k]]);
            }
            outer = inner;
        }
        outer
    }

    /// Rows and columns between four sides, of which opposite ones are equal; places by transfinite interpolation.
    fn grid(&mut self, [bottom, right, top, left]: [&[u32]; 4]) {
        let (columns, rows) = (bottom.len() - 1, right.len() - 1);
        debug_assert!(top.len() == bottom.len() && left.len() == right.len());
        let corners = [bottom[0], bottom[columns], top[0], top[columns]].map(|n| self.at(n));
        let mut lower: Chain = bottom.to_vec();
        for row in 1..=rows {
            let v = row as f64 / rows as f64;
            let upper: Chain = if row == rows {
                reversed(top)
            } else {
                let (first, last) = (left[rows - row], right[row]);
                let (p, q) = (self.at(first), self.at(last));
                let mut chain = Vec::with_capacity(columns + 1);
                chain.push(first);
                for column in 1..columns {
                    let u = column as f64 / columns as f64;
                    let across = p * (1.0 - u) + q * u;
                    let along = self.at(bottom[column]) * (1.0 - v) + self.at(top[columns - column]) * v;
                    let twice = (corners[0] * (1.0 - u) + corners[1] * u) * (1.0 - v)
                        + (corners[3] * (1.0 - u) + corners[2] * u) * v;
                    chain.push(self.new_node(across + along - twice));
                }
                chain.push(last);
                chain
            };
            for column in 0..columns {
                self.quads.push([lower[column], lower[column + 1], upper[column + 1], upper[column]]);
            }
            lower = upper;
        }
    }
}
