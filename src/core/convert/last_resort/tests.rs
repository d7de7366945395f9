use proptest::prelude::Rng;
use proptest::test_runner::{RngAlgorithm, TestRng};

use super::planner::firm_quad;
use super::*;
use crate::core::convert::last_resort::component::live_components;
use crate::core::kernel::predicates::{convex, firm, positive};
use crate::core::mesh::{PointId, TriangleSet};
use crate::core::metric::MetricPlace;

/// Plans the last resort and carries all of it out.
fn last_resort(mesh: &mut Mesh, component: &[ElementId], source: &dyn MetricSource) -> Result<Outcome, Stuck> {
    let plan = Plan::new(mesh, component, source)?;
    for patch in 0..plan.patches() {
        plan.carry_out(mesh, patch);
    }
    Ok(plan.outcome())
}

/// Seeded random numbers.
struct Random(TestRng);

impl Random {
    fn new(round: u32) -> Self {
        let mut seed = [7; 32];
        seed[..4].copy_from_slice(&round.to_le_bytes());
        Random(TestRng::from_seed(RngAlgorithm::ChaCha, &seed))
    }
    fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 4_294_967_296.0
    }
}

struct Uniform;

impl MetricSource for Uniform {
    fn metric(&self, _: DVec2) -> Result<Metric2, Box<BadMetric>> {
        Ok(UNIT)
    }
}

const UNIT: Metric2 = Metric2 { uu: 1.0, uv: 0.0, vv: 1.0 };

fn rounds(usual: u32) -> u32 {
    std::env::var("QUADFRONT_SOAK_ROUNDS").ok().and_then(|n| n.parse().ok()).unwrap_or(usual)
}

fn mesh_of(uv: Vec<DVec2>, triangles: Vec<[u32; 3]>) -> Mesh {
    let metric = vec![UNIT; uv.len()];
    let (point, region) = ((0..uv.len() as u32).map(PointId).collect(), vec![0; triangles.len()]);
    Mesh::from_triangles(&TriangleSet { uv, point, triangles, region, ..TriangleSet::default() }, metric)
}

/// A mesh, all its elements and the plan for them; they are even in number and firm.
fn planned(uv: Vec<DVec2>, triangles: Vec<[u32; 3]>) -> (Mesh, Vec<ElementId>, Plan) {
    let mesh = mesh_of(uv, triangles);
    let component: Vec<ElementId> = mesh.elements().collect();
    let plan = Plan::new(&mesh, &component, &Uniform).expect("the triangles are firm and even in number");
    (mesh, component, plan)
}

fn points<const N: usize>(uv: [(f64, f64); N]) -> Vec<DVec2> {
    uv.map(DVec2::from).to_vec()
}

fn state(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    mesh.write_state(&mut bytes);
    bytes
}

/// A grid of `columns` by `rows` squares, inner nodes moved by up to `jitter` sides, cut along random diagonals, then
/// scaled by `flat` in height. Diagonals are chosen so that all triangles are positive.
fn jittered_grid(random: &mut Random, columns: usize, rows: usize, jitter: f64, flat: f64) -> Mesh {
    let mut uv = Vec::new();
    for j in 0..=rows {
        for i in 0..=columns {
            let inner = i > 0 && i < columns && j > 0 && j < rows;
            let mut off = || if inner { jitter * (2.0 * random.unit() - 1.0) } else { 0.0 };
            uv.push(DVec2::new(i as f64 + off(), flat * (j as f64 + off())));
        }
    }
    let mut triangles = Vec::new();
    for j in 0..rows {
        for i in 0..columns {
            let a = (j * (columns + 1) + i) as u32;
            let (b, d) = (a + 1, a + columns as u32 + 1);
            let c = d + 1;
            let mut cuts = [[[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]];
            if random.unit() < 0.5 {
                cuts.swap(0, 1);
            }
            let good = |cut: &&[[u32; 3]; 2]| {
                cut.iter().all(|t| {
                    let [a, b, c] = t.map(|n| uv[n as usize]);
                    firm(a, b, c)
                })
            };
            triangles.extend(cuts.iter().find(good).expect("one of the diagonals is good below a jitter of 0.5"));
        }
    }
    mesh_of(uv, triangles)
}

/// Connected parts of some triangles of a mesh.
fn parts(mesh: &Mesh, mut live: Vec<bool>) -> Vec<Vec<ElementId>> {
    let mut parts = Vec::new();
    for e in mesh.elements() {
        if !std::mem::take(&mut live[e.index()]) {
            continue;
        }
        let mut part = vec![e];
        let mut next = 0;
        while let Some(&e) = part.get(next) {
            next += 1;
            for t in mesh.half_edges(e).filter_map(|h| mesh.twin(h)) {
                if std::mem::take(&mut live[t.element().index()]) {
                    part.push(t.element());
                }
            }
        }
        parts.push(part);
    }
    parts
}

fn twice_area(mesh: &Mesh, e: ElementId) -> f64 {
    let p: Vec<DVec2> = mesh.corners(e).map(|n| mesh.uv(n)).collect();
    (2..p.len()).map(|k| (p[k - 1] - p[0]).perp_dot(p[k] - p[0])).sum()
}

/// Sides of some elements against others or the boundary, by the coordinates of their ends.
fn outline(mesh: &Mesh, elements: &[ElementId]) -> Vec<[u64; 4]> {
    let mut is_in = vec![false; mesh.element_slots()];
    elements.iter().for_each(|e| is_in[e.index()] = true);
    let sides = elements.iter().flat_map(|&e| mesh.half_edges(e));
    let mut outline: Vec<[u64; 4]> = sides
        .filter(|&h| mesh.twin(h).is_none_or(|t| !is_in[t.element().index()]))
        .map(|h| {
            let (a, b) = (mesh.uv(mesh.origin(h)), mesh.uv(mesh.target(h)));
            [a.x, a.y, b.x, b.y].map(f64::to_bits)
        })
        .collect();
    outline.sort_unstable();
    outline
}

fn carry_out(mesh: &mut Mesh, plan: &Plan) -> Vec<ElementId> {
    (0..plan.patches()).flat_map(|patch| plan.carry_out(mesh, patch)).collect()
}

/// Carries out a plan and checks everything that the last resort promises.
fn carry_out_and_check(mesh: &mut Mesh, component: &[ElementId], plan: &Plan) {
    let area: f64 = component.iter().map(|&e| twice_area(mesh, e)).sum();
    let border = outline(mesh, component);
    let (elements, nodes) = (mesh.element_count(), mesh.node_count());
    let outside: Vec<(ElementId, Vec<NodeId>)> =
        (mesh.elements()).filter(|e| !component.contains(e)).map(|e| (e, mesh.corners(e).collect())).collect();
    let made = carry_out(mesh, plan);
    let outcome = plan.outcome();
    assert_eq!(mesh.check(), Ok(()));
    assert!(made.iter().all(|&e| mesh.is_quad(e)));
    assert_eq!(made.len(), outcome.quads());
    assert_eq!(mesh.element_count(), elements - component.len() + made.len());
    assert!(mesh.node_count() >= nodes);
    assert_eq!(outline(mesh, &made), border, "the boundary is as it was");
    for (e, corners) in outside {
        assert!(mesh.corners(e).eq(corners), "elements outside are as they were");
    }
    let new_area: f64 = made.iter().map(|&e| twice_area(mesh, e)).sum();
    assert!((new_area - area).abs() <= 1e-9 * area, "{area} became {new_area}");
}

/// Random even regions of a random grid.
fn random_regions(round: u32, random: &mut Random, check: &mut dyn FnMut(&mut Random, &mut Mesh, &[ElementId])) {
    let flat = [1.0, 1.0, 1e-3, 1e-5][round as usize % 4];
    let jitter = 0.49 * random.unit();
    let (columns, rows) = (2 + (9.0 * random.unit()) as usize, 2 + (9.0 * random.unit()) as usize);
    let mut mesh = jittered_grid(random, columns, rows, jitter, flat);
    let missing = [0.0, 0.05, 0.2, 0.35][(round as usize / 4) % 4];
    let live: Vec<bool> = (0..mesh.element_slots()).map(|_| random.unit() >= missing).collect();
    for part in parts(&mesh, live) {
        if part.len() % 2 == 0 {
            check(random, &mut mesh, &part);
        }
    }
}

#[test]
fn any_even_region_becomes_convex_quads_with_its_boundary_as_it_was() {
    let mut total = Outcome::default();
    let mut regions = 0;
    for round in 0..rounds(400) {
        random_regions(round, &mut Random::new(round), &mut |_, mesh, part| {
            let plan = Plan::new(mesh, part, &Uniform).expect("the region is even and its triangles are firm");
            carry_out_and_check(mesh, part, &plan);
            total += plan.outcome();
            regions += 1;
        });
    }
    println!("{regions} regions: {total:?}");
    assert!(total.recut > 0 && total.unmatched_at_all > 0 && total.template_quads > 0, "all means are used: {total:?}");
}

#[test]
fn whatever_is_forbidden_the_result_is_right() {
    for round in 0..rounds(300) {
        random_regions(round, &mut Random::new(1_000_000 + round), &mut |random, mesh, part| {
            let forbid = [Means::Merge, Means::Recut, Means::Templates]
                .map(|_| [0.0, 0.0, 0.3, 0.8, 1.0][(5.0 * random.unit()) as usize]);
            let salt = u64::from(random.0.next_u32());
            // The same question gets the same answer.
            let allowed = |means: Means, [t, u]: [ElementId; 2]| {
                let key = u64::from(t.0.min(u.0)) << 32 | u64::from(t.0.max(u.0));
                let hash = (key ^ salt)
                    .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                    .rotate_left(29)
                    .wrapping_mul(0xbf58_476d_1ce4_e5b9);
                (hash >> 11) as f64 / (1_u64 << 53) as f64 >= forbid[means as usize]
            };
            let plan = Planner::plan(mesh, part, &Uniform, &allowed).expect("the region is even");
            if forbid[0] == 1.0 {
                assert_eq!(plan.outcome().merged, 0);
            }
            carry_out_and_check(mesh, part, &plan);
        });
    }
}

#[test]
fn an_odd_component_is_refused_and_the_mesh_is_as_it_was() {
    let mut mesh = jittered_grid(&mut Random::new(0), 3, 3, 0.2, 1.0);
    let part: Vec<ElementId> = mesh.elements().skip(1).collect();
    let before = state(&mesh);
    assert!(matches!(last_resort(&mut mesh, &part, &Uniform), Err(Stuck::Odd(_))));
    assert_eq!(before, state(&mesh));
}

#[test]
fn a_triangle_with_three_leaves_is_filled_from_its_middle() {
    // No two of the leaves have a partner at once: the only join is all three sides of the middle.
    let uv = points([(0.0, 0.0), (2.0, 0.0), (1.0, 2.0), (2.5, 1.5), (-0.5, 1.5), (1.0, -1.0)]);
    let (mut mesh, component, plan) = planned(uv, vec![[0, 1, 2], [1, 3, 2], [2, 4, 0], [0, 5, 1]]);
    let outcome = plan.outcome();
    assert_eq!((outcome.unmatched, outcome.unmatched_at_all, outcome.divided), (2, 2, 3));
    assert_eq!(outcome.template_quads, 3 + 3 * 5);
    carry_out_and_check(&mut mesh, &component, &plan);
}

#[test]
fn a_pair_that_is_not_convex_is_cut_anew_with_its_neighbour() {
    // The chevron 0-1-2-3 has its notch at 3; with the quadrilateral 1-0-4-5 beside it the cut 3-5 is better than 0-1.
    let uv = points([(-1.0, 1.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.8), (-1.0, 0.0), (0.0, -0.2)]);
    let (mut mesh, component, plan) = planned(uv, vec![[0, 1, 3], [1, 2, 3], [1, 0, 4], [1, 4, 5]]);
    assert_eq!((plan.outcome().recut, plan.outcome().quads()), (2, 2));
    assert_eq!(plan.means(0), Means::Recut);
    carry_out_and_check(&mut mesh, &component, &plan);
    assert!(mesh.are_joined(NodeId(3), NodeId(5)));
}

#[test]
fn two_triangles_on_a_bulging_boundary_are_filled_around_a_new_node() {
    // Both 0-1-5 and 1-2-5 stand on the boundary 0-1-2, which bulges at 1: no cut without a new node is convex.
    let uv = points([(-1.0, 0.0), (0.0, 0.1), (1.0, 0.0), (1.8, 1.0), (0.9, 1.9), (0.0, 1.0)]);
    let (mut mesh, component, plan) = planned(uv, vec![[0, 1, 5], [1, 2, 5], [5, 2, 3], [5, 3, 4]]);
    assert_eq!((plan.outcome().recut, plan.outcome().quads()), (3, 3));
    carry_out_and_check(&mut mesh, &component, &plan);
    assert_eq!(mesh.node_count(), 7);
}

#[test]
fn a_corner_that_is_straight_but_for_rounding_is_not_merged() {
    // By the letter 0-1-2-3 is strictly convex: 1 lies an ulp beside the line from 0 to 2.
    let bulge = 1.0 - f64::EPSILON;
    let uv = vec![DVec2::ZERO, DVec2::new(1.0, bulge), DVec2::new(2.0, 2.0), DVec2::new(0.0, 2.0)];
    assert!(convex(uv[0], uv[1], uv[2], uv[3]));
    let (mut mesh, component, plan) = planned(uv, vec![[0, 1, 3], [1, 2, 3]]);
    assert_eq!((plan.outcome().merged, plan.outcome().template_quads), (0, 10));
    carry_out_and_check(&mut mesh, &component, &plan);
}

#[test]
fn no_template_is_inverted_by_rounding_while_triangles_are_firm() {
    let mut tried = 0;
    for round in 0..rounds(4000) {
        let mut random = Random::new(2_000_000 + round);
        let mut direction = || {
            let angle = std::f64::consts::TAU * random.unit();
            DVec2::new(libm::cos(angle), libm::sin(angle))
        };
        let (along, away) = (direction(), direction());
        let far = if random.unit() < 0.5 { 0.0 } else { libm::exp(20.0 * random.unit()) };
        // As flat as is allowed, give or take.
        let height = (1e-7f64).max(256.0 * f64::EPSILON * (far + 1.0)) * (0.9 + random.unit());
        let a = far * away;
        let b = a + along;
        let c = a + (1.2 * random.unit() - 0.1) * along + height * along.perp();
        let uv = vec![a, b, c, b + c - a, c + a - b, a + b - c];
        let triangles = vec![[0, 1, 2], [1, 3, 2], [2, 4, 0], [0, 5, 1]];
        if triangles.iter().all(|t| firm(uv[t[0] as usize], uv[t[1] as usize], uv[t[2] as usize])) {
            let (mut mesh, _, plan) = planned(uv, triangles);
            assert_eq!(plan.outcome().template_quads, 18);
            carry_out(&mut mesh, &plan);
            assert_eq!(mesh.check(), Ok(()));
            tried += 1;
        }
    }
    assert!(tried > rounds(4000) / 4, "{tried} were firm");
}

#[test]
fn an_inverted_template_is_an_error_that_names_the_triangle() {
    // Two needles back to back, a few ulps high: their union is a dart, so the edge between them has to be divided.
    let uv = vec![
        DVec2::new(1.0, 1.0),
        DVec2::new(2.0, 1.0 + f64::EPSILON),
        DVec2::new(2.5, 1.0 + 4.0 * f64::EPSILON),
        DVec2::new(2.5, 1.0 - 1.0 * f64::EPSILON),
    ];
    assert!(positive(uv[0], uv[1], uv[2]) && positive(uv[0], uv[3], uv[1]));
    let mut mesh = mesh_of(uv, vec![[0, 1, 2], [0, 3, 1]]);
    let component: Vec<ElementId> = mesh.elements().collect();
    let stuck = last_resort(&mut mesh, &component, &Uniform);
    assert!(matches!(stuck, Err(Stuck::TooFlat { .. })), "{stuck:?}");
    assert_eq!(mesh.check(), Ok(()));
}

#[test]
fn a_missing_metric_at_a_new_node_is_an_error_and_the_mesh_is_as_it_was() {
    struct Nowhere;
    impl MetricSource for Nowhere {
        fn metric(&self, uv: DVec2) -> Result<Metric2, Box<BadMetric>> {
            Err(Box::new(BadMetric { what: "nothing here".into(), place: MetricPlace::in_plane(uv) }))
        }
    }
    let uv = points([(0.0, 0.0), (2.0, 0.0), (3.0, 3.0), (1.9, 0.5)]);
    let mut mesh = mesh_of(uv, vec![[0, 1, 3], [1, 2, 3]]);
    let component: Vec<ElementId> = mesh.elements().collect();
    assert!(matches!(last_resort(&mut mesh, &component, &Nowhere), Err(Stuck::Metric(_))));
    assert_eq!((mesh.element_count(), mesh.check()), (2, Ok(())));
}

#[test]
fn what_was_done_is_taken_back_exactly_and_done_again_the_same() {
    let mut mesh = jittered_grid(&mut Random::new(5), 12, 12, 0.45, 1.0);
    let component: Vec<ElementId> = mesh.elements().collect();
    let (before, mark) = (state(&mesh), mesh.mark());
    let outcome = last_resort(&mut mesh, &component, &Uniform).expect("the grid is even");
    let after = state(&mesh);
    mesh.take_back(mark);
    assert!(state(&mesh) == before);
    assert_eq!(last_resort(&mut mesh, &component, &Uniform), Ok(outcome));
    assert!(state(&mesh) == after);
}

#[test]
fn components_are_told_apart_and_counted() {
    // Two squares of two triangles that share nothing, and one lone triangle.
    let mut uv = Vec::new();
    let mut triangles = Vec::new();
    for x in [0.0, 5.0] {
        let a = uv.len() as u32;
        uv.extend([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(u, v)| DVec2::new(x + u, v)));
        triangles.extend([[a, a + 1, a + 2], [a, a + 2, a + 3]]);
    }
    uv.extend([DVec2::new(9.0, 0.0), DVec2::new(10.0, 0.0), DVec2::new(9.0, 1.0)]);
    triangles.push([8, 9, 10]);
    let mut mesh = mesh_of(uv, triangles);
    let components = live_components(&mesh, None);
    let sizes: Vec<_> = components.iter().map(|c| (c.triangles.len(), c.boundary, c.is_even())).collect();
    assert_eq!(sizes, [(2, 4, true), (2, 4, true), (1, 3, false)]);
    last_resort(&mut mesh, &components[1].triangles, &Uniform).expect("two is even");
    assert_eq!(live_components(&mesh, None).len(), 2, "a quadrilateral is live no more");
}

#[test]
fn four_nodes_in_a_row_make_no_quadrilateral_of_rounding() {
    // Nodes of a slanting side, as a discretisation gave them: strictly convex, and each corner has its share.
    let quad = [
        DVec2::new(0.909433962264151, -0.20654739368918124),
        DVec2::new(0.9132075471698113, -0.2136077244017097),
        DVec2::new(0.9169811320754717, -0.22066805511423812),
        DVec2::new(0.9207547169811321, -0.22772838582676647),
    ];
    assert!(convex(quad[0], quad[1], quad[2], quad[3]));
    assert!(!firm_quad(quad));
    assert!(firm_quad([DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y]));
}
