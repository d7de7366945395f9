//! Promise: the first rows of a boundary layer stand on the normals of their wall, as high as asked and growing as
//! asked, also where the metric is so stretched that a lean costs next to nothing in it.
#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use glam::DVec2;
use quadfront::core::case::{Case, built_in};
use quadfront::core::convert::conversion::{convert, convert_by};
use quadfront::core::convert::{Converted, Event, Phase};
use quadfront::core::progress::Nobody;
use quadfront::core::record::Export;
use quadfront::core::soup::Allow;
use quadfront::core::soup::soundness::examine;

/// Points and quadrilaterals, and the boundary as far as it is a wall.
struct Walled {
    points: Vec<DVec2>,
    /// Edges of each node.
    joined: BTreeMap<u32, BTreeSet<u32>>,
    /// The quadrilaterals at each node.
    quads: BTreeMap<u32, Vec<[u32; 4]>>,
    /// The nodes before and after each node of the wall.
    wall: BTreeMap<u32, [u32; 2]>,
    boundary: BTreeSet<u32>,
}

/// What the rows at a wall are like: sorted values.
#[derive(Debug)]
struct Rows {
    /// Angles between the first edges off the wall and its normal, degrees. At a corner all directions between the
    /// normals of its two sides are normal.
    lean: Vec<f64>,
    /// Distances of the ends of these edges from the tangent of the wall.
    first: Vec<f64>,
    /// Heights of the second to the fifth row over that of the row before, along columns.
    growth: Vec<f64>,
}

/// The value below which this share of sorted values lies.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    sorted[((sorted.len() - 1) as f64 * share).round() as usize]
}

impl Walled {
    fn of(converted: &Converted, is_wall: impl Fn(DVec2) -> bool) -> Walled {
        let export = Export::of(&converted.mesh, &converted.names);
        let points: Vec<DVec2> = export.file.points.iter().map(|p| p.truncate()).collect();
        let quads = export.quads.iter().map(|quad| quad.map(|n| export.points[n as usize].0));
        let (mut joined, mut at, mut sides) = (BTreeMap::new(), BTreeMap::new(), BTreeSet::new());
        for quad in quads {
            for k in 0..4 {
                let [a, b] = [quad[k], quad[(k + 1) % 4]];
                joined.entry(a).or_insert_with(BTreeSet::new).insert(b);
                joined.entry(b).or_insert_with(BTreeSet::new).insert(a);
                at.entry(a).or_insert_with(Vec::new).push(quad);
                assert!(sides.insert([a, b]));
            }
        }
        let border: Vec<[u32; 2]> = sides.iter().filter(|[a, b]| !sides.contains(&[*b, *a])).copied().collect();
        let mut wall: BTreeMap<u32, [u32; 2]> = BTreeMap::new();
        for [a, b] in border.iter().filter(|side| side.iter().all(|&n| is_wall(points[n as usize]))) {
            wall.entry(*a).or_insert([u32::MAX; 2])[1] = *b;
            wall.entry(*b).or_insert([u32::MAX; 2])[0] = *a;
        }
        wall.retain(|_, beside| !beside.contains(&u32::MAX));
        Walled { points, joined, quads: at, wall, boundary: border.into_iter().flatten().collect() }
    }

    fn vector(&self, a: u32, b: u32) -> DVec2 {
        self.points[b as usize] - self.points[a as usize]
    }

    /// The node after `b` on the line of edges that comes from `a`, where lines cross.
    fn onward(&self, a: u32, b: u32) -> Option<u32> {
        let beside: BTreeSet<u32> = self.quads[&b].iter().filter(|quad| quad.contains(&a)).flatten().copied().collect();
        let mut ahead = self.joined[&b].iter().filter(|n| !beside.contains(n));
        let next = ahead.next().filter(|_| self.joined[&b].len() == 4 && !self.boundary.contains(&b))?;
        ahead.next().is_none().then_some(*next)
    }

    fn rows(&self) -> Rows {
        let mut rows = Rows { lean: Vec::new(), first: Vec::new(), growth: Vec::new() };
        for (&node, &[before, after]) in &self.wall {
            let sides = [self.vector(before, node), self.vector(node, after)].map(DVec2::normalize);
            let normals = sides.map(DVec2::perp);
            for &top in self.joined[&node].iter().filter(|n| !self.boundary.contains(n)) {
                let up = self.vector(node, top);
                let mean = (normals[0] + normals[1]).normalize();
                let turn = normals[0].angle_to(normals[1]).to_degrees();
                let off = mean.angle_to(up).abs().to_degrees();
                // A corner around which the mesh goes has a fan of normals.
                rows.lean.push(if turn < -20.0 { (off + 0.5 * turn).max(0.0) } else { off });
                rows.first.push(if turn.abs() > 20.0 { up.length() } else { mean.dot(up) });
                let (mut from, mut to, mut height) = (node, top, up.length());
                for _ in 0..4 {
                    let Some(next) = self.onward(from, to) else { break };
                    (from, to) = (to, next);
                    let higher = self.vector(from, to).length();
                    rows.growth.push(higher / height);
                    height = higher;
                }
            }
        }
        for values in [&mut rows.lean, &mut rows.first, &mut rows.growth] {
            values.sort_by(f64::total_cmp);
        }
        rows
    }
}

/// The rows at the wall of a case, whose mesh is sound.
fn rows(case: &Case, is_wall: impl Fn(DVec2) -> bool) -> Rows {
    let converted = convert(case, &mut Nobody).unwrap();
    let export = Export::of(&converted.mesh, &converted.names);
    examine(&export.file).verdict(Allow::default()).unwrap();
    Walled::of(&converted, is_wall).rows()
}

fn airfoil() -> Case {
    built_in::named("airfoil").unwrap().unwrap()
}

/// Whether a place is on the airfoil, if it is on the boundary at all.
fn is_near_airfoil(p: DVec2) -> bool {
    p.y.abs() < 0.5 && (-0.5..1.5).contains(&p.x)
}

fn assert_within(values: &[f64], share: f64, asked: f64, off: f64) {
    let [low, high] = [0.5 * (1.0 - share), 0.5 * (1.0 + share)].map(|at| quantile(values, at) / asked);
    assert!((1.0 - off..1.0 + off).contains(&low) && (1.0 - off..1.0 + off).contains(&high), "{low} {high}");
}

#[test]
fn the_rows_of_a_blunt_airfoil_at_ratio_40_stand_on_its_normals_as_high_as_asked() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/blunt_airfoil.toml");
    let rows = rows(&Case::read(Path::new(path)).unwrap(), is_near_airfoil);
    assert!(rows.lean.len() > 100 && rows.growth.len() > 300);
    assert!(quantile(&rows.lean, 0.5) <= 15.0 && quantile(&rows.lean, 0.9) <= 30.0, "{:?}", rows.lean);
    assert_within(&rows.first, 0.8, 0.0005, 0.05);
    assert_within(&rows.growth, 0.8, 1.2, 0.05);
}

#[test]
fn the_rows_of_the_built_in_airfoil_stand_on_its_normals() {
    let rows = rows(&airfoil(), is_near_airfoil);
    assert!(quantile(&rows.lean, 0.5) <= 10.0 && quantile(&rows.lean, 0.9) <= 30.0, "{:?}", rows.lean);
    assert_within(&rows.first, 0.8, 0.002, 0.05);
    assert_within(&rows.growth, 0.8, 1.2, 0.05);
}

#[test]
fn sizes_that_are_scaled_scale_the_rows_and_their_growth() {
    let mut case = airfoil();
    case.parameters.set("size_scale", "0.5").unwrap();
    let rows = rows(&case, is_near_airfoil);
    assert!(quantile(&rows.lean, 0.5) <= 10.0, "{:?}", rows.lean);
    assert_within(&rows.first, 0.8, 0.001, 0.05);
    assert_within(&rows.growth, 0.6, 1.1, 0.05);
}

#[test]
fn events_of_rows_say_what_stands_on_the_normals() {
    let mut told = Vec::new();
    convert_by(&airfoil(), &mut Nobody, &mut |converter, _| {
        while *converter.phase() != Phase::Done {
            let before = converter.mesh.clone();
            if let Event::RowLaid { row, nodes, laid, lean } = converter.step()? {
                let moved = before.nodes().filter(|&n| before.uv(n) != converter.mesh.uv(n)).count();
                assert!(moved >= laid as usize && laid <= nodes, "row {row}: {moved} moved, {laid} of {nodes} laid");
                told.push((row, nodes, laid, lean));
            }
        }
        Ok(())
    })
    .unwrap();
    assert!(told.len() > 3 && told.iter().map(|told| told.0).eq(1..=told.len() as u32), "{told:?}");
    let (_, nodes, laid, [before, after]) = told[0];
    assert!(f64::from(laid) > 0.9 * f64::from(nodes) && after < 0.5 * before, "{told:?}");
}

#[test]
fn curves_without_a_boundary_layer_are_no_walls() {
    for name in ["example1", "uniform", "example4"] {
        let done = convert(&built_in::named(name).unwrap().unwrap(), &mut Nobody).unwrap();
        assert_eq!(done.finished.laid, 0, "{name}");
    }
}
