//! As-rigid-as-possible parametrisation of triangles in the plane (Liu, Zhang, Xu, Gotsman & Gortler 2008): alternates
//! the best rotation of each triangle (local) with a linear solve for the nodes (global). Developable surfaces keep
//! their lengths to rounding. The result need not be injective, so that it is checked.

use glam::{DVec2, DVec3};

use super::edges::Edges;
use super::planar_map::{is_embedded, is_positive, snapped};
use super::sparse::Means;
use crate::core::progress::Cancel;

/// Local/global iterations.
const ROUNDS: usize = 40;
/// Triangles processed between two checks for cancellation.
const BATCH: usize = 1 << 14;
/// Convergence: the largest move relative to the length of the border.
const AT_REST: f64 = 1e-4;
/// Least edge weight relative to that of equilateral triangles: obtuse angles would give negative ones.
const LEAST_WEIGHT: f64 = 1e-2;

/// The nodes in the plane. Those of the border loops (of the given lengths) come first, with the triangles to their
/// left. `None` if the map is not injective, or when cancelled. `tell` receives the progress, from 0 to 1.
///
/// Coordinates are multiples of `grid`, a power of two, so that they stay exact when charts are placed side by side.
pub fn map(
    xyz: &[DVec3],
    triangles: &[[u32; 3]],
    edges: &Edges,
    loops: &[u32],
    grid: f64,
    cancel: &Cancel,
    tell: &mut dyn FnMut(f64),
) -> Option<Vec<DVec2>> {
    let go_on = || (!cancel.is_asked()).then_some(());
    let flat: Vec<[DVec2; 3]> = triangles.iter().map(|t| flattened(t.map(|k| xyz[k as usize]))).collect();
    let weights: Vec<[f64; 3]> = flat.iter().map(weights).collect();
    go_on()?;
    let mut uv = unrolled(triangles, edges, &flat, xyz.len(), cancel)?;
    let border = loops[0] as usize;
    let size = (0..border).map(|k| xyz[k].distance(xyz[(k + 1) % border])).sum::<f64>();
    // Node 0 is fixed, which makes the solution unique.
    let n = xyz.len();
    let mut row: Vec<Vec<(u32, f64)>> = vec![Vec::with_capacity(8); n];
    // Where in the rows of its ends each edge is: a node may have many.
    let mut places: Vec<Option<[u32; 2]>> = vec![None; edges.len()];
    for (at, w) in weights.iter().enumerate() {
        if at.is_multiple_of(BATCH) {
            go_on()?;
        }
        for k in 0..3 {
            let edge = edges.of_side((3 * at + (k + 1) % 3) as u32);
            let ends = edges.get(edge).ends;
            match places[edge] {
                Some(places) => (0..2).for_each(|i| row[ends[i] as usize][places[i] as usize].1 += w[k]),
                None => {
                    places[edge] = Some(ends.map(|end| row[end as usize].len() as u32));
                    (0..2).for_each(|i| row[ends[i] as usize].push((ends[1 - i], w[k])));
                }
            }
        }
    }
    go_on()?;
    let sums: Vec<f64> = row.iter().map(|r| r.iter().map(|w| w.1).sum()).collect();
    let going_on = row.into_iter().zip(&sums).take_while(|_| !cancel.is_asked());
    let rows = going_on.skip(1).map(|(row, sum)| {
        let inside = row.into_iter().filter(|w| w.0 > 0);
        inside.map(|(node, weight)| (node - 1, weight / sum)).collect()
    });
    let means = Means::new(rows);
    go_on()?;
    let solver = means.factored(&xyz[1..], &|| !cancel.is_asked())?;
    let origin = uv[0];
    uv.iter_mut().for_each(|p| *p -= origin);
    for round in 0..ROUNDS {
        go_on()?;
        tell(round as f64 / ROUNDS as f64);
        let mut right = vec![DVec2::ZERO; n];
        for ((t, q), w) in triangles.iter().zip(&flat).zip(&weights) {
            // The best rotation of the triangle, from the weighted sums of u.q and u x q over its sides.
            let mut turn = DVec2::ZERO;
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let (own, lies) = (q[j] - q[i], uv[t[j] as usize] - uv[t[i] as usize]);
                turn += DVec2::new(own.dot(lies), own.perp_dot(lies)) * w[k];
            }
            let turn = turn.try_normalize().unwrap_or(DVec2::X);
            for k in 0..3 {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let side = turn.rotate(q[j] - q[i]) * w[k];
                right[t[j] as usize] += side;
                right[t[i] as usize] -= side;
            }
        }
        go_on()?;
        right.iter_mut().zip(&sums).for_each(|(right, sum)| *right /= *sum);
        let mut moved = 0.0_f64;
        for (p, to) in uv[1..].iter_mut().zip(solver.solve(&right[1..])?) {
            moved = moved.max(p.distance_squared(to));
            *p = to;
        }
        if moved <= (AT_REST * size) * (AT_REST * size) {
            break;
        }
    }
    uv.iter_mut().for_each(|p| *p = snapped(*p, grid));
    (is_positive(triangles, &uv) && is_embedded(&uv, loops)).then_some(uv)
}

/// A triangle in its own plane: first corner at the origin, second on the +x axis.
pub fn flattened([a, b, c]: [DVec3; 3]) -> [DVec2; 3] {
    let (e, f) = (b - a, c - a);
    let long = e.length();
    if long == 0.0 {
        return [DVec2::ZERO, DVec2::ZERO, DVec2::new(f.length(), 0.0)];
    }
    let along = e / long;
    [DVec2::ZERO, DVec2::new(long, 0.0), DVec2::new(f.dot(along), e.cross(f).length() / long)]
}

/// Half the cotangents of a triangle's angles, bounded: the weights of the opposite sides.
fn weights(q: &[DVec2; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| {
        let (e, f) = (q[(k + 1) % 3] - q[k], q[(k + 2) % 3] - q[k]);
        let cotangent = e.dot(f) / e.perp_dot(f);
        // The cotangent of 60 degrees, also for a degenerate triangle.
        let plain = 1.0 / 3.0_f64.sqrt();
        let bound = if cotangent.is_finite() { cotangent.min(1e2) } else { plain };
        0.5 * bound.max(LEAST_WEIGHT * plain)
    })
}

/// Initial positions: unrolls the triangles breadth first; the first triangle to reach a node places it. `None` when
/// cancelled.
fn unrolled(
    triangles: &[[u32; 3]],
    edges: &Edges,
    flat: &[[DVec2; 3]],
    nodes: usize,
    cancel: &Cancel,
) -> Option<Vec<DVec2>> {
    let mut uv = vec![None; nodes];
    let mut seen = vec![false; triangles.len()];
    // Starts in the middle of the list.
    let first = triangles.len() / 2;
    for k in 0..3 {
        uv[triangles[first][k] as usize] = Some(flat[first][k]);
    }
    let mut waiting = std::collections::VecDeque::from([first]);
    seen[first] = true;
    let mut looked = 0_usize;
    while let Some(t) = waiting.pop_front() {
        looked += 1;
        if looked.is_multiple_of(BATCH) && cancel.is_asked() {
            return None;
        }
        for side in 0..3 {
            for &other in edges.get(edges.of_side((3 * t + side) as u32)).sides {
                let (o, k) = (other as usize / 3, other as usize % 3);
                if std::mem::replace(&mut seen[o], true) {
                    continue;
                }
                let [i, j, far] = [k, (k + 1) % 3, (k + 2) % 3];
                let at = |k: usize| uv[triangles[o][k] as usize].unwrap_or(DVec2::ZERO);
                let (own, lies) = (flat[o][j] - flat[o][i], at(j) - at(i));
                let turn = DVec2::new(own.dot(lies), own.perp_dot(lies)).try_normalize().unwrap_or(DVec2::X);
                let place = at(i) + turn.rotate(flat[o][far] - flat[o][i]);
                uv[triangles[o][far] as usize].get_or_insert(place);
                waiting.push_back(o);
            }
        }
    }
    Some(uv.into_iter().map(|p| p.unwrap_or(DVec2::ZERO)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::fixtures::{charted, plate, tube};
    use crate::core::discrete::planar_map::StretchBound;

    #[test]
    fn a_developable_surface_keeps_its_lengths() {
        let mesh = tube(48, 40, 10.0);
        let chart = charted(&mesh, 0.7, StretchBound::default()).remove(0);
        for t in &chart.local {
            for k in 0..3 {
                let (a, b) = (t[k] as usize, t[(k + 1) % 3] as usize);
                let space = mesh.points[chart.points[a] as usize].distance(mesh.points[chart.points[b] as usize]);
                assert!((chart.uv[a].distance(chart.uv[b]) / space - 1.0).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn a_bumpy_plate_has_little_stretch() {
        let chart = charted(&plate(20, 0.1), 0.7, StretchBound::default()).remove(0);
        assert!(chart.stretch.shape < 2.0 && chart.stretch.area < 2.0, "{:?}", chart.stretch);
    }

    #[test]
    fn loops_that_cross_touch_or_fold_back_are_not_embedded() {
        let loops = |all: &[&[[f64; 2]]]| {
            let uv: Vec<DVec2> = all.concat().into_iter().map(DVec2::from).collect();
            is_embedded(&uv, &all.iter().map(|l| l.len() as u32).collect::<Vec<_>>())
        };
        assert!(loops(&[&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]]));
        assert!(loops(&[&[[0.0, 0.0], [2.0, 0.0], [1.0, 1e-300], [0.0, 1.0]]]));
        assert!(!loops(&[&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]]));
        assert!(!loops(&[&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 0.0], [0.0, 1.0]]]));
        assert!(!loops(&[&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [0.0, 1.0]]]));
        assert!(!loops(&[&[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]]), "clockwise");
        let square: &[[f64; 2]] = &[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        assert!(loops(&[square, &[[1.0, 1.0], [1.0, 2.0], [2.0, 1.0]]]));
        assert!(!loops(&[square, &[[0.0, 1.0], [1.0, 2.0], [2.0, 1.0]]]), "it touches");
        assert!(!loops(&[square, &[[1.0, 1.0], [2.0, 1.0], [1.0, 2.0]]]), "two that are anticlockwise");
    }
}
