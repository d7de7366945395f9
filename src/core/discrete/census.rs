//! Counts and chart adjacency of a surface of triangles, for display before the conversion.

use super::chart::Chart;
use super::edges::{Edges, Triangles};
use super::features::Feature;
use crate::core::kernel::DisjointSets;

/// Counts of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Points used by triangles.
    pub nodes: usize,
    /// Triangles.
    pub triangles: usize,
    /// Connected components.
    pub components: usize,
    /// Loops of the border; loops that touch count as one.
    pub border_loops: usize,
}

impl Census {
    /// Counts a surface.
    pub fn of(mesh: &Triangles, edges: &Edges) -> Census {
        let points = mesh.points.len();
        let mut is_used = vec![false; points];
        let mut parts = DisjointSets::new(points);
        for &[a, b, c] in &mesh.triangles {
            [a, b, c].iter().for_each(|&k| is_used[k as usize] = true);
            parts.join(a, b);
            parts.join(b, c);
        }
        let mut on_border = vec![false; points];
        let mut loops = DisjointSets::new(points);
        for edge in (0..edges.len()).map(|edge| edges.get(edge)).filter(|edge| edge.sides.len() == 1) {
            edge.ends.iter().for_each(|&end| on_border[end as usize] = true);
            loops.join(edge.ends[0], edge.ends[1]);
        }
        let roots = |sets: &mut DisjointSets, of: &[bool]| {
            (0..points as u32).filter(|&k| of[k as usize] && sets.find(k) == k).count()
        };
        Census {
            nodes: is_used.iter().filter(|used| **used).count(),
            triangles: mesh.triangles.len(),
            components: roots(&mut parts, &is_used),
            border_loops: roots(&mut loops, &on_border),
        }
    }
}

/// Number of feature edges of a kind.
pub fn count_of(features: &[Option<Feature>], kind: Feature) -> usize {
    features.iter().filter(|feature| **feature == Some(kind)).count()
}

/// A surface divided into charts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Division {
    /// Number of charts.
    pub charts: usize,
    /// The chart of each triangle.
    pub chart_of: Vec<u32>,
    /// A small number for each chart, different from those of adjacent charts.
    pub colour: Vec<u32>,
    /// Edges cut only for flattening, not features: between charts and along slits; ascending.
    pub seams: Vec<u32>,
}

impl Division {
    /// The division of a surface with these features and charts.
    pub fn of(mesh: &Triangles, edges: &Edges, features: &[Option<Feature>], charts: &[Chart]) -> Division {
        let mut chart_of = vec![0; mesh.triangles.len()];
        let mut nodes = vec![[0; 3]; mesh.triangles.len()];
        for (number, chart) in (0..).zip(charts) {
            for (&t, local) in chart.triangles.iter().zip(&chart.local) {
                (chart_of[t as usize], nodes[t as usize]) = (number, *local);
            }
        }
        Division::by(edges, features, charts.len(), chart_of, &nodes)
    }

    /// The division of a surface into its regions, which are the faces of a CAD file.
    pub fn of_regions(mesh: &Triangles, edges: &Edges, features: &[Option<Feature>]) -> Division {
        let regions = mesh.region.iter().max().map_or(0, |last| *last as usize + 1);
        Division::by(edges, features, regions, mesh.region.clone(), &mesh.triangles)
    }

    /// The division into so many charts; `nodes` has the nodes of each triangle in its chart.
    fn by(
        edges: &Edges,
        features: &[Option<Feature>],
        charts: usize,
        chart_of: Vec<u32>,
        nodes: &[[u32; 3]],
    ) -> Division {
        let ends = |side: u32| {
            let (t, k) = (nodes[side as usize / 3], side as usize % 3);
            [t[k], t[(k + 1) % 3]]
        };
        let mut beside: Vec<Vec<u32>> = vec![Vec::new(); charts];
        let mut seams = Vec::new();
        for edge in 0..edges.len() {
            let sides = edges.get(edge).sides;
            let Some((&one, others)) = sides.split_first() else { continue };
            let own = chart_of[one as usize / 3];
            for &other in others {
                let across = chart_of[other as usize / 3];
                if across != own {
                    beside[own as usize].push(across);
                    beside[across as usize].push(own);
                }
            }
            if let (&[one, other], None) = (sides, features[edge]) {
                let [a, b] = ends(other);
                if chart_of[other as usize / 3] != own || ends(one) != [b, a] {
                    seams.push(edge as u32);
                }
            }
        }
        let mut colour: Vec<u32> = Vec::with_capacity(charts);
        for near in &beside {
            let taken: Vec<u32> = near.iter().filter_map(|&n| colour.get(n as usize).copied()).collect();
            colour.push((0..).find(|number| !taken.contains(number)).unwrap_or(0));
        }
        Division { charts, chart_of, colour, seams }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::chart::charts;
    use crate::core::discrete::features::{ANGLE, features};
    use crate::core::discrete::fixtures::{beside, cube, plate, sphere, three_half_planes, torus, tube};
    use crate::core::discrete::planar_map::StretchBound;
    use crate::core::progress::Nobody;
    use glam::DVec3;

    fn divided(mesh: &Triangles) -> (Census, Vec<Option<Feature>>, Division) {
        let edges = Edges::of(&mesh.triangles);
        let features = features(mesh, &edges, ANGLE);
        let charts = charts(mesh, &edges, &features, StretchBound::default(), &mut Nobody).unwrap();
        let division = Division::of(mesh, &edges, &features, &charts);
        for edge in 0..edges.len() {
            let own: Vec<u32> =
                edges.get(edge).sides.iter().map(|side| division.chart_of[*side as usize / 3]).collect();
            for pair in own.windows(2).filter(|pair| pair[0] != pair[1]) {
                let [a, b] = [0, 1].map(|k| division.colour[pair[k] as usize]);
                assert!(a != b || own.len() > 2, "adjacent charts have different colours");
                assert!(features[edge].is_some() || division.seams.contains(&(edge as u32)));
            }
        }
        (Census::of(mesh, &edges), features, division)
    }

    #[test]
    fn parts_loops_features_and_charts_are_counted() {
        let (census, features, division) = divided(&cube(2));
        assert_eq!((census.triangles, census.components, census.border_loops), (48, 1, 0));
        assert_eq!((count_of(&features, Feature::Fold), division.charts, division.seams.len()), (24, 6, 0));
        assert!(division.colour.iter().all(|number| *number < 3), "a cube needs three colours");
        let (census, features, _) = divided(&plate(4, 0.0));
        assert_eq!((census.nodes, census.border_loops, count_of(&features, Feature::Boundary)), (25, 1, 16));
        let (_, features, _) = divided(&three_half_planes());
        assert_eq!(count_of(&features, Feature::Branching), 1);
        // Two balls apart, and a ring that is cut more than once.
        assert_eq!(divided(&beside(sphere(5), &sphere(5), 3.0 * DVec3::X)).0.components, 2);
        assert!(!divided(&torus(30, 20)).2.seams.is_empty());
    }

    #[test]
    fn a_slit_is_a_seam_within_one_chart() {
        let (census, _, division) = divided(&tube(24, 10, 4.0));
        assert_eq!((census.border_loops, division.charts), (2, 1));
        assert_eq!(division.seams.len(), 10, "from one end to the other");
    }
}
