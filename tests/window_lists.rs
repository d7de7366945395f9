//! Promise: the tables of elements and nodes list the state at hand, and lead from the worst element to the decision
//! that made it.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

mod window_harness;

use eframe::egui::{Key, Modifiers};
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable};
use quadfront::app::window::{App, Command, Goal, Source};
use quadfront::core::convert::Event;
use quadfront::core::mesh::{ElementId, Mesh};
use quadfront::render::scene::Outlined;
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};

/// The window on example 1 at its end, with one of the tabs in front.
fn at_the_end(tab: &str) -> Option<Window> {
    has_adapter().then(|| {
        let source = Source::BuiltIn("example1".to_owned());
        let mut window = start(LAPTOP, |cc| App::new(cc, Some(source)));
        settle(&mut window);
        apply(&mut window, Command::Go(Goal::End));
        window.get_by_label(tab).click();
        window.run_steps(2);
        window
    })
}

fn mesh(window: &Window) -> &Mesh {
    &window.state().state.run().moment.as_ref().unwrap().mesh
}

fn picked(window: &Window) -> Option<Outlined> {
    window.state().state.document().picked
}

fn label(node: &Node<'_>) -> String {
    node.accesskit_node().label().unwrap()
}

/// Waits until a row is shown.
fn row(window: &mut Window, name: &str) {
    // The inspector may have the name too.
    until(window, name, |window| window.query_all_by_label(name).next().is_some());
}

#[test]
fn the_worst_element_is_the_first_row_and_a_click_selects_it_and_brings_it_into_view() {
    let Some(mut window) = at_the_end("Elements") else { return };
    let worst = mesh(&window).elements().map(|e| (mesh(&window).quality(e), e)).min_by(|a, b| a.0.total_cmp(&b.0));
    let worst = worst.unwrap().1;
    let name = format!("Quadrilateral {}", worst.0);
    row(&mut window, &name);
    let rows = window.get_all_by_label_contains("Quadrilateral ");
    let top = rows.map(|node| (node.rect().top(), label(&node))).min_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(top.unwrap().1, name);
    // The middle of the row may be scrolled out of the panel.
    window.get_by_label(&name).click_accesskit();
    settle(&mut window);
    assert_eq!(picked(&window), Some(Outlined::Element(worst)));
    let camera = window.state().state.view().plane;
    let corners: Vec<_> = mesh(&window).corners(worst).map(|n| mesh(&window).uv(n)).collect();
    let middle = corners.iter().sum::<glam::DVec2>() / 4.0;
    let at = camera.camera.unwrap().project(middle.extend(0.0), camera.size);
    assert!(at.cmpgt(glam::DVec2::ZERO).all() && at.cmplt(camera.size).all(), "{at}");
}

#[test]
fn a_condition_filters_the_elements_and_a_wrong_one_is_explained() {
    let Some(mut window) = at_the_end("Elements") else { return };
    type_over(&mut window, "Filter of elements", "quality < .6 && level > 1");
    let fits = |mesh: &Mesh, e: ElementId| mesh.quality(e) < 0.6 && mesh.level(e) > 1;
    let expected = mesh(&window).elements().filter(|e| fits(mesh(&window), *e)).count();
    let count = format!("{expected} of {} elements", mesh(&window).element_count());
    assert!(expected > 0);
    row(&mut window, &count);
    let shown: Vec<String> = window.get_all_by_label_contains("Quadrilateral ").map(|node| label(&node)).collect();
    for name in shown {
        let id = name.rsplit(' ').next().unwrap().parse().unwrap();
        assert!(fits(mesh(&window), ElementId(id)), "{name}");
    }
    // A word that is begun is completed, and one that is wrong is explained; the list stays as it was.
    type_over(&mut window, "Filter of elements", "space.jac");
    window.get_by_label("Use space.jacobian");
    type_over(&mut window, "Filter of elements", "qualty < .3");
    window.get_by_label_contains("The nearest known field is \"quality\"");
    row(&mut window, &count);
}

#[test]
fn columns_sort_the_table_and_what_is_selected_in_the_view_is_scrolled_to() {
    let Some(mut window) = at_the_end("Nodes") else { return };
    let most = mesh(&window).nodes().max_by_key(|&n| (mesh(&window).valence(n), std::cmp::Reverse(n))).unwrap();
    row(&mut window, "Node 0");
    window.get_by_label("Sort by valence, edges").click();
    window.run_steps(2);
    window.get_by_label("Sort by valence, edges").click();
    row(&mut window, &format!("Node {}", most.0));
    let first = window.get_all_by_label_contains("Node ").min_by(|a, b| a.rect().top().total_cmp(&b.rect().top()));
    assert_eq!(label(&first.unwrap()), format!("Node {}", most.0));
    // The last one by number is far below.
    window.get_by_label("Sort by number").click();
    let last = mesh(&window).nodes().max().unwrap();
    row(&mut window, "Node 0");
    let name = format!("Node {}", last.0);
    assert!(window.query_by_label(&name).is_none());
    apply(&mut window, Command::Pick(Some(Outlined::Node(last))));
    until(&mut window, "the row and the inspector name it", |window| window.query_all_by_label(&name).count() == 2);
}

#[test]
fn a_list_follows_the_run_and_is_copied_as_csv() {
    let Some(mut window) = at_the_end("Elements") else { return };
    apply(&mut window, Command::Go(Goal::Step(40)));
    let count = format!("{0} of {0} elements", mesh(&window).element_count());
    row(&mut window, &count);
    type_over(&mut window, "Filter of elements", "quad");
    let quads = mesh(&window).elements().filter(|e| mesh(&window).is_quad(*e)).count();
    let count = format!("{quads} of {} elements", mesh(&window).element_count());
    row(&mut window, &count);
    window.get_by_label("Copy the elements as CSV").click();
    let mut text = None;
    for _ in 0..200 {
        window.run_steps(1);
        let commands = &window.output().platform_output.commands;
        text = commands.iter().find_map(|command| match command {
            eframe::egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
        if text.is_some() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let text = text.unwrap();
    assert_eq!(text.lines().count(), quads + 1, "{text}");
    assert!(text.starts_with("id,"));
}

/// The number in the label of a link of a chain.
fn step_of(label: &str) -> u64 {
    let digits = label.strip_prefix("Chain, step ").unwrap().split(':').next().unwrap();
    digits.replace('\u{2009}', "").parse().unwrap()
}

#[test]
fn three_actions_lead_from_a_cold_start_to_the_decision_that_made_the_worst_quadrilateral() {
    let Some(mut window) =
        has_adapter().then(|| start(LAPTOP, |cc| App::new(cc, Some(Source::BuiltIn("example1".to_owned())))))
    else {
        return;
    };
    settle(&mut window);
    // One: to the end.
    window.key_press(Key::End);
    settle(&mut window);
    // Two: the worst quadrilateral.
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::W);
    settle(&mut window);
    let (worst, quality) = window.state().state.run().moment.as_ref().unwrap().worst.unwrap();
    assert_eq!(picked(&window), Some(Outlined::Element(worst)));
    window.get_by_label(&format!("Quadrilateral {}", worst.0));
    until(&mut window, "the chain is told", |window| {
        window.query_all_by_label_contains("Chain, step ").next().is_some()
    });
    // Its last quality is the one that it has, and one step cost most.
    assert!(window.query_all_by_label_contains(&format!("\u{2192} {quality:.2}")).next().is_some());
    window.get_by_label("lost most");
    let links: Vec<String> = window.get_all_by_label_contains("Chain, step ").map(|node| label(&node)).collect();
    assert!(links.len() > 3 && links.is_sorted_by_key(|label| step_of(label)), "{links:?}");
    assert!(links[0].contains("base selected"), "{links:?}");
    // Three: the decision.
    window.get_by_label(&links[0]).click_accesskit();
    settle(&mut window);
    let moment = window.state().state.run().moment.as_ref().unwrap();
    assert_eq!(moment.step, step_of(&links[0]));
    assert!(matches!(moment.event, Some(Event::BaseSelected { .. })));
}
