//! Promise: the first difference of two runs is the first step after which their states differ, whatever differs later,
//! and what is said of it is what each run did there. The further differences are the decisions that differ although
//! both fronts are the same around the base. Every kind of step says why it did what it did.
#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use quadfront::core::case::{Symmetry, built_in};
use quadfront::core::convert::walk::walk;
use quadfront::core::convert::{Converter, Event, EventKind, Phase, StepReport};
use quadfront::core::mesh::{Mesh, NodeId};
use quadfront::core::progress::Nobody;
use quadfront::core::run::compare::{Difference, FirstDifference, did_at, differences, first_difference};
use quadfront::core::run::shown::fingerprint;
use quadfront::core::run::{EditKind, History, Run};

fn run(name: &str, set: &[(&str, &str)]) -> Run {
    let mut case = built_in::named(name).unwrap().unwrap();
    set.iter().for_each(|(key, value)| case.parameters.set(key, value).unwrap());
    Run::of(case)
}

fn compared(runs: [Run; 2]) -> Option<FirstDifference> {
    let [mut a, mut b] = runs.map(|run| History::open(run, &mut Nobody).unwrap());
    first_difference([&mut a, &mut b], &mut Nobody).unwrap()
}

/// The first step after which the fingerprints of two runs, made anew, differ.
fn by_fingerprints(runs: [&Run; 2]) -> Option<u64> {
    let backgrounds = runs.map(|run| run.background(&mut Nobody).unwrap());
    let [mut a, mut b] = [0, 1].map(|k| {
        let made = &backgrounds[k];
        Converter::new(made.mesh.clone(), &made.sizing, runs[k].parameters.clone())
    });
    let state = |of: &Converter<'_>| fingerprint(&of.mesh, of.phase());
    loop {
        if state(&a) != state(&b) {
            return Some(a.counts.steps.max(b.counts.steps));
        }
        if *a.phase() == Phase::Done {
            return None;
        }
        a.step().unwrap();
        b.step().unwrap();
    }
}

#[test]
fn the_first_difference_is_that_of_the_fingerprints() {
    let pairs: [(&str, &[(&str, &str)]); 7] = [
        ("example1", &[("c", "1.5")]),
        ("example1", &[("theta_rect", "120")]),
        ("example1", &[("smoothing_weights", "determinant")]),
        ("example1", &[("clean_up", "traditional")]),
        ("example4", &[("enhancement", "false")]),
        ("two-faces", &[("seaming", "false")]),
        ("top-smoothing", &[("top_smoothing", "false")]),
    ];
    let mut steps = Vec::new();
    for (name, set) in pairs {
        let [a, b] = [run(name, &[]), run(name, set)];
        let expected = by_fingerprints([&a, &b]);
        let found = compared([a, b]);
        assert_eq!(found.as_ref().map(|found| found.step), expected, "{name} {set:?}");
        steps.push(expected);
    }
    // The pairs are worth comparing: most differ, at several places, and one while the whole mesh is cleaned up.
    steps.dedup();
    assert!(steps.iter().flatten().filter(|&&step| step > 0).count() >= 5, "{steps:?}");
    assert_eq!(steps.iter().filter(|step| step.is_none()).count(), 0, "{steps:?}");
}

#[test]
fn the_first_difference_of_two_values_of_c_is_that_of_the_two_event_files() {
    // What an event did, without the bound that depends on c.
    let did = |event: &Event| {
        let mut json = serde_json::to_value(event).unwrap();
        json.as_object_mut().unwrap().remove("reach");
        json
    };
    let runs = [run("example1", &[]), run("example1", &[("c", "1.5")])];
    let files = runs.each_ref().map(|run| {
        let made = run.background(&mut Nobody).unwrap();
        let mut converter = Converter::new(made.mesh.clone(), &made.sizing, run.parameters.clone());
        let mut lines = Vec::new();
        let mut tell = |told: &StepReport<'_>| lines.push((told.step, *told.event));
        walk(&mut converter, None, &mut Nobody, Some(&mut tell)).unwrap();
        lines
    });
    let differ = files[0].iter().zip(&files[1]).find(|(a, b)| did(&a.1) != did(&b.1));
    let (a, b) = differ.unwrap();
    let found = compared(runs).unwrap();
    assert_eq!(found.step, a.0);
    let [of_a, of_b] = found.did.map(Option::unwrap);
    assert_eq!((of_a.event, of_b.event), (a.1, b.1));
    // Both selected a base segment there, and each says why, and why not the other one.
    assert!(of_a.text.starts_with("base selected: ") && of_b.text.starts_with("base selected: "), "{of_a:?} {of_b:?}");
    let Event::BaseSelected { a: from, b: to, .. } = b.1 else { panic!("{b:?}") };
    let other = format!("{} → {}", from.0, to.0);
    assert!(of_a.why.len() > 1 && of_a.why.last().unwrap().contains(&other), "{of_a:?}");
}

#[test]
fn runs_that_are_the_same_do_not_differ_and_other_backgrounds_differ_at_step_0() {
    assert_eq!(compared([run("example2", &[]), run("example2", &[])]), None);
    // A parameter that nothing here depends on.
    assert_eq!(compared([run("figure-13", &[]), run("figure-13", &[("eps2", "6")])]), None);
    let found = compared([run("example2", &[]), run("example2", &[("size_scale", "0.9")])]).unwrap();
    assert_eq!(found, FirstDifference { step: 0, did: [None, None] });
}

#[test]
fn an_edit_differs_where_it_acts() {
    let plain = run("example4", &[]);
    let mut history = History::open(plain.clone(), &mut Nobody).unwrap();
    // A base segment picked at the first selection after step 300: another one than the front gives.
    history.seek(300).unwrap();
    while *history.state().phase() != Phase::Select {
        history.forward().unwrap();
    }
    let step = history.step();
    let table = quadfront::core::run::FrontTable::of(history.state());
    let Some(Event::BaseSelected { a, b, .. }) = history.forward().unwrap() else { panic!("no base is selected") };
    history.back().unwrap();
    let other = table.rows.iter().find(|row| [row.a, row.b] != [a, b]).unwrap();
    history.edit(EditKind::Base { a: other.a, b: other.b }).unwrap();
    let edited = history.run().clone();
    let found = compared([plain, edited]).unwrap();
    assert_eq!(found.step, step + 1);
    let [_, Some(did)] = found.did else { panic!("{found:?}") };
    assert!(did.text.starts_with("you chose the base"), "{did:?}");
}

/// A node as the oracle sees it: its place, and the metric there.
type Spot = (DVec2, [f64; 3]);

fn spot(mesh: &Mesh, node: NodeId) -> Spot {
    let m = mesh.metric(node);
    (mesh.uv(node), [m.uu, m.uv, m.vv])
}

/// Whether a node of B is that of A: within a tenth of an edge in the metric there.
fn is_same((p, [uu, uv, vv]): &Spot, (q, _): &Spot) -> bool {
    let d = *q - *p;
    (uu * d.x * d.x + 2.0 * uv * d.x * d.y + vv * d.y * d.y).sqrt() <= 0.1
}

fn are_same(a: &[Spot], b: &[Spot]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_same(a, b))
}

/// A selection as the oracle sees it.
struct Turn {
    step: u64,
    /// The front from two nodes before the base to two nodes after it.
    around: Vec<(NodeId, Spot)>,
    /// What each step did, from the selection on, in words, with the nodes that it decided on.
    acts: Vec<(String, Vec<Spot>)>,
    /// The corners of the quadrilateral, where one was formed.
    quad: Option<Vec<Spot>>,
}

impl Turn {
    fn ends(&self, from: usize) -> [NodeId; 2] {
        [self.around[from].0, self.around[from + 1].0]
    }

    fn spots(&self, from: usize, until: usize) -> Vec<Spot> {
        self.around[from..until].iter().map(|node| node.1).collect()
    }
}

/// The front around a segment, from all sides of live triangles on it.
fn around(mesh: &Mesh, ends: [NodeId; 2]) -> Vec<(NodeId, Spot)> {
    let segment = mesh.elements().filter(|e| mesh.is_triangle(*e)).flat_map(|e| mesh.half_edges(e).collect::<Vec<_>>());
    let h = segment.filter(|h| mesh.is_front(*h)).find(|h| mesh.ends(*h) == ends).unwrap();
    let ring: Vec<NodeId> = mesh.front_loop(h).map(|h| mesh.origin(h)).collect();
    let at = |k: isize| ring[k.rem_euclid(ring.len() as isize) as usize];
    (-2..4).map(|k| (at(k), spot(mesh, at(k)))).collect()
}

/// All selections of a run, by a converter of its own.
fn turns(run: &Run) -> Vec<Turn> {
    let made = run.background(&mut Nobody).unwrap();
    let mut converter = Converter::new(made.mesh.clone(), &made.sizing, run.parameters.clone());
    let mut turns: Vec<Turn> = Vec::new();
    let mut is_open = false;
    while *converter.phase() != Phase::Done {
        let event = converter.step().unwrap();
        let mesh = &converter.mesh;
        if let Event::BaseSelected { a, b, .. } = event {
            let around = around(mesh, [a, b]);
            turns.push(Turn { step: converter.counts.steps, around, acts: Vec::new(), quad: None });
            is_open = true;
        }
        if !is_open {
            continue;
        }
        let turn = turns.last_mut().unwrap();
        let json = serde_json::to_value(event).unwrap();
        let mut words = json["kind"].as_str().unwrap().to_owned();
        if words == "rolled_back" {
            words += &format!(" {} {}", json["attempt"], json["why"]["kind"]);
        }
        let ids = match words.as_str() {
            "side_is_front" | "side_divided" | "side_chosen" | "side_swapped" => vec![&json["node"]],
            "top_found" => json["ends"].as_array().unwrap().iter().collect(),
            _ => Vec::new(),
        };
        let nodes = ids.into_iter().map(|id| spot(mesh, NodeId(id.as_u64().unwrap() as u32))).collect();
        turn.acts.push((words, nodes));
        if let Event::Formed { nodes, .. } = event {
            turn.quad = Some(nodes.iter().map(|node| spot(mesh, *node)).collect());
        }
        is_open = !matches!(event.kind(), EventKind::Formed | EventKind::Closed | EventKind::Deferred);
    }
    turns
}

/// The differences of two runs by their definition: every selection of one is held against every one of the other.
fn by_brute_force(a: &[Turn], b: &[Turn]) -> Vec<(Vec<u64>, Vec<[NodeId; 2]>)> {
    let turned = |quad: &[Spot], by: usize| [&quad[by..], &quad[..by]].concat();
    let is_in =
        |turns: &[Turn], holds: &dyn Fn(&[Spot]) -> bool| turns.iter().any(|t| t.quad.as_deref().is_some_and(holds));
    let mut taken = BTreeSet::new();
    let mut found = Vec::new();
    for its in b {
        let free = |own: &&Turn, taken: &BTreeSet<u64>| !taken.contains(&own.step);
        if let Some(own) = a.iter().find(|own| free(own, &taken) && are_same(&own.spots(1, 5), &its.spots(1, 5))) {
            taken.insert(own.step);
            let last = |turn: &Turn| turn.acts.last().unwrap().0.clone();
            let is_alike = match (&own.quad, &its.quad) {
                (Some(own), Some(its)) => are_same(own, its),
                _ => last(own) == last(its),
            };
            if !is_alike {
                let mut acts = own.acts.iter().zip(&its.acts);
                let alike = acts.position(|(own, its)| own.0 != its.0 || !are_same(&own.1, &its.1));
                let at = alike.unwrap_or(own.acts.len().min(its.acts.len()) - 1) as u64;
                found.push((vec![own.step + at, its.step + at], vec![own.ends(2), its.ends(2)]));
            }
            continue;
        }
        // B has selected the segment before the base of A, or the one after it.
        for (own_from, its_from) in [(0, 1), (1, 0)] {
            let are_neighbours =
                |own: &&Turn| are_same(&own.spots(own_from, own_from + 5), &its.spots(its_from, its_from + 5));
            let Some(own) = a.iter().find(|own| free(own, &taken) && are_neighbours(own)) else { continue };
            let (Some(quad), Some(other)) = (&own.quad, &its.quad) else { continue };
            let in_b = is_in(b, &|its| (0..4).any(|by| are_same(quad, &turned(its, by))));
            let in_a = is_in(a, &|own| (0..4).any(|by| are_same(own, &turned(other, by))));
            if !(in_a && in_b) {
                taken.insert(own.step);
                found.push((vec![own.step, its.step], vec![own.ends(2), its.ends(2)]));
                break;
            }
        }
    }
    found.sort();
    found
}

#[test]
fn the_further_differences_are_those_of_their_definition_and_lead_to_decisions_at_the_same_front() {
    let pairs: [(&str, &[(&str, &str)]); 7] = [
        ("example1", &[("c", "1.5")]),
        ("example1", &[("theta_rect", "120")]),
        ("example1", &[("placement", "false")]),
        ("example1", &[("clean_up", "traditional")]),
        ("example4", &[("side_deviation", "5")]),
        ("two-faces", &[("seaming", "false")]),
        ("top-smoothing", &[("top_smoothing", "false")]),
    ];
    let mut kinds = BTreeMap::new();
    for (name, set) in pairs {
        let runs = [run(name, &[]), run(name, set)];
        let [a, b] = runs.each_ref().map(turns);
        let expected = by_brute_force(&a, &b);
        let [mut a, mut b] = runs.map(|run| History::open(run, &mut Nobody).unwrap());
        let first = first_difference([&mut a, &mut b], &mut Nobody).unwrap().unwrap();
        let found = differences([&mut a, &mut b], first.step, &mut Nobody).unwrap();
        let plain: Vec<_> = found.iter().map(|d| (d.steps.to_vec(), d.bases.to_vec())).collect();
        assert_eq!(plain, expected, "{name} {set:?}");
        for difference in found.iter().take(20) {
            let Difference { steps, bases, not_selected } = *difference;
            assert!(steps.iter().all(|step| *step >= first.step), "{name} {set:?}: {difference:?}");
            let did = difference.told([&mut a, &mut b]).unwrap().map(Option::unwrap);
            for (k, did) in did.iter().enumerate() {
                let history = [&mut a, &mut b][k].event(steps[k]).unwrap().unwrap();
                assert_eq!(did.event, history);
                assert!(!did.why.is_empty(), "{name} {set:?}: {did:?}");
                *kinds.entry(did.event.kind()).or_insert(0) += 1;
            }
            if let Some(others) = not_selected {
                for (k, did) in did.iter().enumerate() {
                    let Event::BaseSelected { a: from, b: to, .. } = did.event else { panic!("{did:?}") };
                    assert_eq!([from, to], bases[k]);
                    let why_not = format!("Why not {} \u{2192} {}?", others[k][0].0, others[k][1].0);
                    assert!(did.why.iter().any(|sentence| sentence.starts_with(&why_not)), "{did:?}");
                    // They are side by side.
                    assert!(others[k][1] == from || others[k][0] == to, "{difference:?}");
                }
            }
        }
        println!("{name} {set:?}: {} differences from step {}", found.len(), first.step);
    }
    assert!(kinds.len() > 3, "{kinds:?}");
}

#[test]
fn a_mere_change_of_order_is_no_difference() {
    // On a square that becomes a grid, rows may begin anywhere.
    let plain = run("uniform", &[]);
    let mut history = History::open(plain.clone(), &mut Nobody).unwrap();
    history.seek(0).unwrap();
    let table = quadfront::core::run::FrontTable::of(history.state());
    let far = table.rows[table.in_order()[table.rows.len() / 2]];
    history.edit(EditKind::Base { a: far.a, b: far.b }).unwrap();
    let edited = history.run().clone();
    let [mut a, mut b] = [plain, edited].map(|run| History::open(run, &mut Nobody).unwrap());
    let first = first_difference([&mut a, &mut b], &mut Nobody).unwrap().unwrap();
    assert_eq!(first.step, 1);
    let found = differences([&mut a, &mut b], first.step, &mut Nobody).unwrap();
    assert_eq!(found, []);
}

#[test]
fn every_kind_of_step_says_why() {
    let mut met: BTreeMap<EventKind, u32> = BTreeMap::new();
    let figures = built_in::FIGURES.iter().map(|(name, _)| (*name, vec![]));
    let others: [(&str, Vec<(&str, &str)>); 8] = [
        ("example1", vec![]),
        ("example2", vec![("clean_up", "traditional")]),
        ("example4", vec![("side_deviation", "0"), ("side_split", "1")]),
        ("two-faces", vec![]),
        ("sphere", vec![("size_scale", "2")]),
        ("torus", vec![("size_scale", "2")]),
        ("gear", vec![("theta_seam", "0"), ("splitting", "false")]),
        ("wing", vec![]),
    ];
    let mut mirrored = run("uniform", &[("size_scale", "3")]);
    mirrored.case.symmetry = Some(Symmetry::Auto);
    let runs = figures.chain(others).map(|(name, set)| (name, run(name, &set)));
    for (name, run) in runs.chain([("uniform", mirrored)]) {
        let mut history = History::open(run, &mut Nobody).unwrap();
        history.extend(u64::MAX);
        let kinds: Vec<EventKind> = history.log().kinds(1, history.log().known()).collect();
        for (kind, step) in kinds.into_iter().zip(1..) {
            let seen = met.entry(kind).or_insert(0);
            *seen += 1;
            if *seen > 4 {
                continue;
            }
            let did = did_at(&mut history, step).unwrap().unwrap();
            assert!(
                !did.why.is_empty() && did.why.iter().all(|why| why.ends_with(['.', ':'])),
                "{name}, {step}: {did:?}"
            );
        }
    }
    let never: Vec<_> = EventKind::ALL.iter().filter(|kind| !met.contains_key(kind)).collect();
    assert_eq!(never, [&EventKind::PickLost, &EventKind::Unfolded, &EventKind::Finished]);
}

/// The numbers of a sentence, in their order.
fn numbers(text: &str) -> Vec<f64> {
    let text = text.replace('\u{2212}', "-");
    let parts = text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
    parts.filter_map(|part| part.trim_end_matches('.').parse().ok()).collect()
}

#[test]
fn a_formation_says_where_it_placed_each_top_and_by_which_rule() {
    let mut history = History::open(run("example1", &[]), &mut Nobody).unwrap();
    let mut ways = BTreeMap::new();
    history.extend(700);
    for step in 1..700 {
        let Some(Event::Formed { element, nodes: [a, b, d, c], quality, .. }) = history.event(step).unwrap() else {
            continue;
        };
        history.seek(step - 1).unwrap();
        let before = history.state().mesh.clone();
        let Phase::Form { base, .. } = history.state().phase().clone() else { panic!("step {step}") };
        let why = did_at(&mut history, step).unwrap().unwrap().why;
        let mesh = &history.state().mesh;
        // The angle from one direction to another in the metric of a node, in degrees.
        let angle = |at: NodeId, from: DVec2, to: DVec2| {
            let m = mesh.metric(at);
            let root = (m.uu * m.vv - m.uv * m.uv).sqrt();
            let inner = m.uu * from.x * to.x + m.uv * (from.x * to.y + from.y * to.x) + m.vv * from.y * to.y;
            libm::atan2(root * (from.x * to.y - from.y * to.x), inner).to_degrees()
        };
        let sides = [("left", a, b, c, before.uv(d), 1.0), ("right", b, a, d, mesh.uv(c), -1.0)];
        for (side, at, far, top, other_top, sign) in sides {
            let head = format!("The {side} top, node {}, ", top.0);
            let text = why.iter().find_map(|sentence| sentence.strip_prefix(&head)).unwrap();
            let (p, along) = (mesh.uv(at), mesh.uv(far) - mesh.uv(at));
            let (place, measures) = text.split_once(" Its side is ").unwrap();
            let [length, theta] = numbers(measures)[..] else { panic!("{text}") };
            assert!((length - mesh.distance(at, top)).abs() < 6e-4, "{step}: {text}");
            assert!((theta - sign * angle(at, along, mesh.uv(top) - p)).abs() < 0.06, "{text}");
            let moved = mesh.uv(top) - before.uv(top);
            if place.starts_with("stays where it was") {
                assert_eq!(moved, DVec2::ZERO, "{step}: {text}");
                assert_eq!(place.contains("on the front"), before.is_on_front(top), "{step}: {text}");
                *ways.entry("stays").or_insert(0) += 1;
                continue;
            }
            let (rule, way) = place.split_once(" It went there from ").unwrap();
            let [x, y, target, u, v, corner_x, corner_y, share, l] = numbers(rule)[..] else { panic!("{rule}") };
            let (there, unit, corner) = (DVec2::new(x, y), DVec2::new(u, v), DVec2::new(corner_x, corner_y));
            assert!((l - base.length).abs() < 6e-4, "{step}: {text}");
            let target_off = sign * angle(at, along, unit - p) - target;
            assert!(target_off.abs() < 0.2, "{step}: {target_off} {text}");
            let small = 3e-3 * along.length();
            assert!(
                (corner - (other_top - along * (1.0 / base.length).clamp(0.5, 2.0))).length() < small,
                "{step}: {text}"
            );
            let expected = 50.0 + 250.0 * (base.length - 1.0).abs();
            assert!((share - expected.min(100.0)).abs() < 0.06, "{step}: {text}");
            assert!((there - unit.lerp(corner, share / 100.0)).length() < 2.0 * small, "{step}: {text}");
            let wanted = (there - before.uv(top)).length();
            let part = ["all the way", "half of", "a quarter of", "an eighth of", "not at all"].iter();
            let (which, words) = part.enumerate().find(|(_, words)| way.contains(**words)).unwrap();
            let share = [1.0, 0.5, 0.25, 0.125, 0.0][which];
            assert!((moved.length() - share * wanted).abs() < 0.03 * wanted + small, "{step}: {text}");
            *ways.entry(*words).or_insert(0) += 1;
        }
        let shape = why.iter().find(|sentence| sentence.starts_with("It is strictly convex")).unwrap();
        let expected = [[a, b, c], [b, d, a], [d, c, b], [c, a, d]]
            .map(|[at, next, last]| angle(at, mesh.uv(next) - mesh.uv(at), mesh.uv(last) - mesh.uv(at)));
        assert!(numbers(shape).iter().zip(expected).all(|(told, angle)| (told - angle).abs() < 0.06), "{shape}");
        let passed = why.iter().find(|sentence| sentence.starts_with("Its quality is ")).unwrap();
        assert!((numbers(passed)[0] - quality).abs() < 1e-3 && numbers(passed)[1] == 0.15, "{passed}");
        assert!(mesh.is_quad(element));
    }
    assert!(ways.len() > 2 && ways["stays"] > 10 && ways["all the way"] > 10, "{ways:?}");
}

#[test]
fn a_first_difference_in_a_formation_has_the_numbers_of_both_runs() {
    let found = compared([run("example1", &[]), run("example1", &[("placement", "false")])]).unwrap();
    let [a, b] = found.did.map(Option::unwrap);
    assert_eq!([a.event.kind(), b.event.kind()], [EventKind::Formed; 2]);
    assert!(a.why.iter().any(|sentence| sentence.contains("the corner of the parallelogram")), "{a:?}");
    assert!(b.why.iter().any(|sentence| sentence.contains("placement = false")), "{b:?}");
    assert_ne!(a.why, b.why);
}
