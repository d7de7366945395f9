//! Each number of the quality panel says its space and leads to the edge or the element that has it, and the inspector
//! shows the same number there.

use std::sync::Arc;

use eframe::egui::{Rect, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::{DVec2, DVec3};
use quadfront::app::window::{App, Command, Goal, Source};
use quadfront::core::mesh::{ElementId, Mesh, NodeId};
use quadfront::render::scene::Outlined;

use crate::pictures::{difference, picture};
use crate::window_harness::{Window, apply, has_adapter, settle, start};

/// Lengths and angles from coordinates and tensors alone.
mod oracle {
    use super::*;

    /// The length of a vector in the tensor of a node.
    fn norm(mesh: &Mesh, node: NodeId, d: DVec2) -> f64 {
        let m = mesh.metric(node);
        (m.uu * d.x * d.x + 2.0 * m.uv * d.x * d.y + m.vv * d.y * d.y).sqrt()
    }

    /// The length of an edge: the logarithmic mean of its lengths at both ends, by a formula that needs no logarithm.
    pub fn length(mesh: &Mesh, [a, b]: [NodeId; 2]) -> f64 {
        let d = mesh.uv(b) - mesh.uv(a);
        let (l_a, l_b) = (norm(mesh, a, d), norm(mesh, b, d));
        (l_a + 4.0 * (l_a * l_b).sqrt() + l_b) / 6.0
    }

    /// The corners of a quadrilateral, each between its neighbours.
    fn corners(mesh: &Mesh, e: ElementId) -> Vec<[NodeId; 3]> {
        let n: Vec<NodeId> = mesh.corners(e).collect();
        (0..n.len()).map(|k| [n[(k + n.len() - 1) % n.len()], n[k], n[(k + 1) % n.len()]]).collect()
    }

    /// The sides at a corner as vectors in which the metric is Euclidean.
    fn sides(mesh: &Mesh, [last, node, next]: [NodeId; 3]) -> [DVec2; 2] {
        let m = mesh.metric(node);
        // The Cholesky factor of the tensor.
        let l = m.uu.sqrt();
        let (k, n) = (m.uv / l, (m.vv - m.uv * m.uv / m.uu).sqrt());
        [next, last].map(|other| {
            let d = mesh.uv(other) - mesh.uv(node);
            DVec2::new(l * d.x + k * d.y, n * d.y)
        })
    }

    pub fn metric_angles(mesh: &Mesh, e: ElementId) -> Vec<f64> {
        let angle = |[a, b]: [DVec2; 2]| a.perp_dot(b).signum() * libm::acos(a.dot(b) / (a.length() * b.length()));
        corners(mesh, e).into_iter().map(|corner| angle(sides(mesh, corner)).to_degrees()).collect()
    }

    pub fn space_angles(mesh: &Mesh, e: ElementId) -> Vec<f64> {
        let angle = |[last, node, next]: [DVec3; 3]| {
            let (a, b) = (next - node, last - node);
            libm::acos(a.dot(b) / (a.length() * b.length())).to_degrees()
        };
        corners(mesh, e).into_iter().map(|corner| angle(corner.map(|n| mesh.xyz(n)))).collect()
    }

    /// The lowest over the corners of twice the area between the sides over the mean of their squares.
    pub fn quality(mesh: &Mesh, e: ElementId) -> f64 {
        let corner = |[a, b]: [DVec2; 2]| a.perp_dot(b) / (0.5 * (a.length_squared() + b.length_squared()));
        corners(mesh, e).into_iter().map(|c| corner(sides(mesh, c))).fold(f64::INFINITY, f64::min)
    }
}

fn mesh(harness: &Window) -> Arc<Mesh> {
    harness.state().state.run().moment.as_ref().unwrap().mesh.clone()
}

fn picked_element(harness: &Window) -> ElementId {
    match harness.state().state.document().picked {
        Some(Outlined::Element(e)) => e,
        other => panic!("{other:?}"),
    }
}

/// All texts of the window that have a part.
fn texts(harness: &Window, part: &str) -> Vec<String> {
    let nodes = harness.query_all_by_label_contains(part);
    nodes.filter_map(|node| node.accesskit_node().label().or(node.accesskit_node().value())).collect()
}

/// The labels of links that begin with a text.
fn links(harness: &Window, start: &str) -> Vec<String> {
    texts(harness, start).into_iter().filter(|text| text.starts_with(start)).collect()
}

/// The number at the end of a text.
fn number(text: &str) -> f64 {
    text.trim_end_matches('°').rsplit(' ').next().unwrap().replace('\u{2212}', "-").parse().unwrap()
}

/// Whether a text shows a value with this many decimals.
fn shows(text: &str, value: f64, decimals: i32) -> bool {
    (number(text) - value).abs() <= 0.5 * libm::pow(10.0, -f64::from(decimals)) + 1e-9
}

/// Clicks the `k`th of the links of this label.
fn follow(harness: &mut Window, label: &str, k: usize) {
    harness.query_all_by_label(label).nth(k).unwrap().click_accesskit();
    settle(harness);
    harness.run_steps(2);
}

/// What the inspector shows in a line that begins with a text.
fn inspected(harness: &Window, start: &str) -> String {
    links(harness, start).pop().unwrap_or_default()
}

fn extreme(values: impl Iterator<Item = f64>, is_least: bool) -> f64 {
    if is_least { values.fold(f64::INFINITY, f64::min) } else { values.fold(f64::NEG_INFINITY, f64::max) }
}

type Angles = fn(&Mesh, ElementId) -> Vec<f64>;

/// Follows every link of the panel at the current step.
fn check(harness: &mut Window) {
    let at = mesh(harness);
    for (name, is_least) in [("shortest ", true), ("longest ", false)] {
        let [link] = <[String; 1]>::try_from(links(harness, name)).unwrap();
        follow(harness, &link, 0);
        let Some(Outlined::Edge(ends)) = harness.state().state.document().picked else { panic!("{link}") };
        let own = oracle::length(&at, ends);
        let all = extreme(at.edges().map(|h| oracle::length(&at, at.ends(h))), is_least);
        assert!(shows(&link, own, 2) && (own - all).abs() < 1e-9 * all, "{link}: {own}, {all}");
        let shown = texts(harness, " metric,  ").pop().unwrap();
        assert!(shows(shown.split(" metric,").next().unwrap(), own, 2), "{link}: {shown}");
    }
    let quads: Vec<ElementId> = at.elements().filter(|&e| at.is_quad(e)).collect();
    if quads.is_empty() {
        assert!(links(harness, "lowest now").is_empty() && links(harness, "smallest ").is_empty());
        return;
    }
    // First in the metric, then in space.
    let spaces: [(&str, Angles); 2] = [("metric ", oracle::metric_angles), ("space ", oracle::space_angles)];
    for (k, (space, angles)) in spaces.into_iter().enumerate() {
        for (name, is_least) in [("smallest ", true), ("largest ", false)] {
            // The inspector's own lines do not begin so.
            let found = links(harness, name);
            assert_eq!(found.len(), 2, "{found:?}");
            let same = found[..k].iter().filter(|label| **label == found[k]).count();
            follow(harness, &found[k], same);
            let e = picked_element(harness);
            let own = extreme(angles(&at, e).into_iter(), is_least);
            let all = extreme(quads.iter().flat_map(|&e| angles(&at, e)), is_least);
            assert!(shows(&found[k], own, 1) && (own - all).abs() < 1e-6, "{}: {own}, {all}", found[k]);
            let line = inspected(harness, space);
            let text = found[k].trim_start_matches(name).trim_end_matches('°');
            assert!(line.split_whitespace().any(|angle| angle == text), "{space}{text}: {line}");
        }
    }
    let [link] = <[String; 1]>::try_from(links(harness, "lowest now ")).unwrap();
    follow(harness, &link, 0);
    let own = oracle::quality(&at, picked_element(harness));
    let all = extreme(quads.iter().map(|&e| oracle::quality(&at, e)), true);
    assert!(shows(&link, own, 2) && (own - all).abs() < 1e-9, "{link}: {own}, {all}");
    let text = link.trim_start_matches("lowest now ").to_owned();
    assert!(harness.query_all_by_label(&text).next().is_some(), "{text}");
    let Some(link) = links(harness, "lowest when formed ").pop() else { return };
    let before = harness.state().state.run().moment.as_ref().unwrap().step;
    follow(harness, &link, 0);
    let then = mesh(harness);
    let own = oracle::quality(&then, picked_element(harness));
    assert!(shows(&link, own, 2), "{link}: {own}");
    let text = link.trim_start_matches("lowest when formed ").to_owned();
    assert!(harness.query_all_by_label(&text).next().is_some(), "{text}");
    let state = &harness.state().state;
    assert!(state.run().moment.as_ref().unwrap().step <= before);
    let formed = state.run().track[..before as usize].iter().filter_map(|step| step.formed);
    let all = extreme(formed.map(|formed| formed.1), true);
    assert!((own - all).abs() < 1e-9, "{own}, {all}");
}

fn follow_all(name: &str) {
    if !has_adapter() {
        return;
    }
    let source = Source::BuiltIn(name.to_owned());
    let mut harness = start(Vec2::new(1800.0, 1100.0), |cc| App::new(cc, Some(source)));
    settle(&mut harness);
    harness.get_by_label("Quality").click();
    harness.run_steps(3);
    let end = harness.state().state.run().track.len() as u64;
    for goal in [Goal::Step(0), Goal::ToQuads(1), Goal::Step(end / 3), Goal::Step(2 * end / 3), Goal::End] {
        apply(&mut harness, Command::Go(goal));
        apply(&mut harness, Command::Pick(None));
        check(&mut harness);
    }
}

#[test]
fn links_of_a_plane_case_lead_to_what_has_their_number() {
    follow_all("example1");
}

#[test]
fn links_of_a_curved_surface_lead_to_what_has_their_number() {
    follow_all("example2");
}

#[test]
fn links_of_several_faces_lead_to_what_has_their_number() {
    follow_all("wing");
}

/// The part of a picture of the window inside a rectangle, in points.
fn inside(picture: &[u8], width: usize, rect: Rect) -> Vec<u8> {
    let [left, top, right, bottom] =
        [rect.left(), rect.top(), rect.right(), rect.bottom()].map(|x| x.round().max(0.0) as usize);
    (top..bottom).flat_map(|y| picture[4 * (y * width + left)..4 * (y * width + right)].iter().copied()).collect()
}

/// The numbers in a text.
fn numbers(text: &str) -> Vec<f64> {
    let text = text.replace('\u{2009}', "");
    text.split(|c: char| !c.is_ascii_digit() && c != '.').filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn a_click_on_a_bar_lights_what_it_stands_for_in_the_main_view() {
    if !has_adapter() {
        return;
    }
    let size = Vec2::new(1800.0, 1100.0);
    let source = Source::BuiltIn("example1".to_owned());
    let mut harness = start(size, |cc| App::new(cc, Some(source)));
    settle(&mut harness);
    let end = harness.state().state.run().track.len() as u64;
    apply(&mut harness, Command::Go(Goal::Step(end / 2)));
    harness.get_by_label("Quality").click();
    harness.run_steps(3);
    let mesh = mesh(&harness);
    let view = harness.query_all_by_label_contains("Mesh at step").map(|node| node.rect()).next().unwrap();
    let mut found = [0; 2];
    for (k, (plot, head)) in
        [("Plot of angles", "quads whose"), ("Plot of lengths", "edges of")].into_iter().enumerate()
    {
        for share in [0.35, 0.45, 0.55, 0.65] {
            harness.hover_at(view.center());
            harness.run_steps(3);
            let before = picture(&mut harness, "bar-before");
            let rect = harness.get_by_label(plot).rect();
            let at = rect.left_top() + rect.size() * Vec2::new(share, 0.6);
            harness.drag_at(at);
            harness.run_steps(1);
            harness.drop_at(at);
            harness.run_steps(3);
            let told = harness.state().state.view().notice().map(|notice| notice.0.to_owned());
            let told = told.filter(|told| told.contains(head)).unwrap_or_else(|| panic!("{plot}: no bar at {share}"));
            let [count, low, high] = <[f64; 3]>::try_from(numbers(&told)).unwrap();
            // By the oracle, but for what lies at an end of the bar.
            let least = if k == 0 { 1e-6 } else { 0.005 };
            let counted = |slack: f64| {
                let fits = |x: f64| x >= low - slack && x < high + slack;
                if k == 0 {
                    let quads = mesh.elements().filter(|e| mesh.is_quad(*e));
                    let ends = |e| {
                        [true, false].map(|is_least| extreme(oracle::metric_angles(&mesh, e).into_iter(), is_least))
                    };
                    quads.filter(|e| ends(*e).into_iter().any(fits)).count()
                } else {
                    mesh.edges().filter(|h| fits(oracle::length(&mesh, mesh.ends(*h)))).count()
                }
            };
            let lit = harness.state().state.view().lit.clone();
            assert_eq!(lit.len() as f64, count, "{told}");
            assert!((counted(-least)..=counted(least)).contains(&lit.len()), "{told}: {}", counted(0.0));
            assert!(lit.iter().all(|what| matches!(what, Outlined::Element(_)) == (k == 0)));
            harness.hover_at(view.center());
            harness.run_steps(3);
            let after = picture(&mut harness, "bar-after");
            let [before, after] = [before, after].map(|picture| inside(&picture, size.x as usize, view));
            let apart = difference(&before, &after);
            assert!(apart > 1e-4 || lit.is_empty() || found[k] > 0, "{told}: {apart}");
            found[k] += lit.len();
        }
    }
    assert!(found[0] > 0 && found[1] > 0, "{found:?}");
}
