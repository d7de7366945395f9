//! Relaxation of a noisy surface in a few places, where quadrilaterals would fold (docs/algorithm.md, "Noise").

use glam::DVec3;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::edges::{Edges, Groups, Triangles};
use super::features::Feature;

/// Rounds of relaxation.
const ROUNDS: usize = 5;

/// A place where a surface is relaxed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its middle, in the unit of the scaled mesh.
    pub centre: DVec3,
    /// Its radius, in the same unit; points that have an edge into the ball are relaxed too.
    pub radius: f64,
}

/// Moves the points of a surface that are in balls to the mean of their neighbours: points on features to that of their
/// two neighbours along it. Points where features end or branch, and hard points, stay. Returns how many were moved.
pub fn relax(mesh: &mut Triangles, edges: &Edges, features: &[Option<Feature>], balls: &[Ball]) -> usize {
    let widest = balls.iter().map(|ball| ball.radius).fold(0.0, f64::max);
    let centre = |ball: &Ball| GeomWithData::new(ball.centre.to_array(), ball.radius);
    let tree = RTree::bulk_load(balls.iter().map(centre).collect());
    let ends: Vec<u32> = (0..edges.len()).flat_map(|e| edges.get(e).ends).collect();
    let at = Groups::of(ends.len(), mesh.points.len(), |end| ends[end as usize]);
    // The far end of an edge by the number of the near one among `ends`.
    let beyond = |end: u32| ends[(end ^ 1) as usize];
    let mut moved: Vec<(u32, Vec<u32>)> = Vec::new();
    for point in 0..mesh.points.len() as u32 {
        let p = mesh.points[point as usize];
        let own = at.get(point);
        let reach = own.iter().map(|&end| mesh.points[beyond(end) as usize].distance(p)).fold(0.0, f64::max);
        let far = (widest + reach) * (widest + reach);
        let mut near = tree.locate_within_distance(p.to_array(), far);
        if !near.any(|ball| DVec3::from(*ball.geom()).distance(p) <= ball.data + reach) {
            continue;
        }
        let is_feature = |end: &&u32| features[**end as usize / 2].is_some();
        let along: Vec<u32> = own.iter().filter(is_feature).map(|&end| beyond(end)).collect();
        let neighbours = if along.is_empty() { own.iter().map(|&end| beyond(end)).collect() } else { along };
        let stays = own.iter().any(|end| is_feature(&end)) && neighbours.len() != 2;
        if !neighbours.is_empty() && !stays && mesh.hard_number(point).is_none() {
            moved.push((point, neighbours));
        }
    }
    for _ in 0..ROUNDS {
        let mean =
            |around: &[u32]| around.iter().map(|&k| mesh.points[k as usize]).sum::<DVec3>() / around.len() as f64;
        let means: Vec<DVec3> = moved.iter().map(|(_, around)| mean(around)).collect();
        moved.iter().zip(means).for_each(|((point, _), mean)| mesh.points[*point as usize] = mean);
    }
    moved.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::features::{ANGLE, features};
    use crate::core::discrete::fixtures::{cube, plate};

    #[test]
    fn a_spike_is_relaxed_and_nothing_far_from_it() {
        let flat = plate(10, 0.0);
        let mut mesh = flat.clone();
        let spike = mesh.points.iter().position(|p| p.distance(DVec3::new(0.5, 0.5, 0.0)) < 1e-9).unwrap();
        mesh.points[spike].z = 0.3;
        let edges = Edges::of(&mesh.triangles);
        let found = features(&flat, &edges, ANGLE);
        let ball = Ball { centre: DVec3::new(0.5, 0.5, 0.0), radius: 0.1 };
        let moved = relax(&mut mesh, &edges, &found, &[ball]);
        assert!((7..40).contains(&moved), "{moved}");
        assert!(mesh.points.iter().all(|p| p.z < 0.06), "{:?}", mesh.points[spike]);
        let far = |p: &DVec3| p.distance(ball.centre) > 0.5;
        assert!(mesh.points.iter().zip(&flat.points).filter(|(_, q)| far(q)).all(|(p, q)| p == q));
    }

    #[test]
    fn points_on_creases_stay_on_them_and_corners_stay() {
        let clean = cube(6);
        let mut mesh = clean.clone();
        let edges = Edges::of(&mesh.triangles);
        let found = features(&clean, &edges, ANGLE);
        // Everything is relaxed; a cube that is divided evenly is its own mean along its edges.
        let moved = relax(&mut mesh, &edges, &found, &[Ball { centre: DVec3::splat(0.5), radius: 1.0 }]);
        assert_eq!(moved, clean.points.len() - 8);
        let on = |p: &DVec3| p.to_array().iter().filter(|x| **x == 0.0 || **x == 1.0).count();
        for (p, q) in mesh.points.iter().zip(&clean.points) {
            assert_eq!(on(p), on(q));
            assert!(on(q) < 2 || p.distance(*q) < 1e-12, "{p} {q}");
        }
    }
}
