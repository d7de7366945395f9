//! Promise: the tables of elements and nodes list the state at hand, and lead from the worst element to the decision
//! that made it.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

mod window_harness;

use eframe::egui::{self, Key, Modifiers, PointerButton, Shape};
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable};
use quadfront::app::window::{App, Command, Direction, Goal, Source};
use quadfront::core::convert::{Event, EventKind};
use quadfront::core::kernel::number::grouped;
use quadfront::core::mesh::{ElementId, Mesh, NodeId};
use quadfront::core::run::LastChanges;
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
    // Text has its words as a value.
    let node = node.accesskit_node();
    node.label().or_else(|| node.value()).unwrap()
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
    assert!(window.query_by_label_contains("Largest loss: step ").is_some());
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

/// Opens the field and enters a text.
fn look_for(window: &mut Window, text: &str) {
    window.key_press_modifiers(Modifiers::COMMAND, Key::F);
    window.run_steps(3);
    type_over(window, "Number or coordinates", text);
    settle(window);
}

#[test]
fn what_is_looked_for_by_number_is_selected_and_framed_and_what_is_gone_is_found_where_it_was() {
    let Some(mut window) = at_the_end("Nodes") else { return };
    let quad = mesh(&window).elements().nth(60).unwrap();
    look_for(&mut window, &format!("quad {}", quad.0));
    assert_eq!(picked(&window), Some(Outlined::Element(quad)));
    assert!(window.query_by_label("Number or coordinates").is_none(), "the field is closed");
    let [a, b] = mesh(&window).ends(mesh(&window).edges().nth(40).unwrap());
    look_for(&mut window, &format!("edge {}-{}", b.0, a.0));
    assert_eq!(picked(&window), Some(Outlined::Edge([b, a])));
    let p = mesh(&window).centroid(quad);
    look_for(&mut window, &format!("{} {}", p.x, p.y));
    assert_eq!(picked(&window), Some(Outlined::Element(quad)));
    look_for(&mut window, "step 40");
    assert_eq!(window.state().state.run().moment.as_ref().unwrap().step, 40);
    // A node of the background mesh that the run removes.
    let before: Vec<NodeId> = mesh(&window).nodes().collect();
    apply(&mut window, Command::Go(Goal::End));
    let gone = before.into_iter().find(|n| !mesh(&window).has_node(*n)).unwrap();
    look_for(&mut window, &format!("node {}", gone.0));
    window.get_by_label(&format!("Node {} does not exist at this step.", gone.0));
    until(&mut window, "the step is known", |window| {
        window.query_by_label_contains("removed it: go to the step before").is_some()
    });
    window.get_by_label_contains("removed it: go to the step before").click();
    settle(&mut window);
    assert!(mesh(&window).has_node(gone));
    assert_eq!(picked(&window), Some(Outlined::Node(gone)));
    apply(&mut window, Command::Go(Goal::Steps(1)));
    assert!(!mesh(&window).has_node(gone), "the next step removes it");
    // A quadrilateral that is still to come.
    apply(&mut window, Command::Go(Goal::Step(0)));
    look_for(&mut window, &format!("quad {}", quad.0));
    window.get_by_label_contains("makes it: go there").click();
    settle(&mut window);
    assert!(mesh(&window).is_quad(quad));
    look_for(&mut window, "lamp 12");
    assert!(window.state().state.view().faults[0].contains("quad 467"));
}

#[test]
fn attempts_that_were_taken_back_are_a_tree_with_links_and_reasons() {
    let Some(mut window) = at_the_end("Front") else { return };
    let run = |window: &Window| window.state().state.run().moment.clone().unwrap();
    apply(&mut window, Command::Go(Goal::Step(0)));
    let back = Goal::Kind(EventKind::RolledBack, Direction::Forward);
    while run(&window).attempts.len() < 3 {
        apply(&mut window, Command::Go(back));
    }
    window.get_by_label("Attempt 1: sides by the rules");
    assert!(window.query_all_by_label_contains("Taken back: ").count() >= 2);
    // The first one is folded; its steps are links.
    let first = run(&window).attempts[0].steps[0].0;
    window.get_by_label("Attempt 1: sides by the rules").click_accesskit();
    window.run_steps(30);
    let link = format!("step {}  ", grouped(first));
    window.get_all_by_label_contains(&link).next().unwrap().click_accesskit();
    settle(&mut window);
    assert_eq!(run(&window).step, first);
}

/// Opens the menu of a row near its left end: tables may be wider than their docks.
fn open_menu(window: &mut Window, row: egui::Rect) {
    let pos = egui::pos2(row.left().max(0.0) + 60.0, row.center().y);
    window.hover_at(pos);
    window.run_steps(3);
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
        window.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
        window.run_steps(2);
    }
}

/// The entries of the menu of a thing that is open, from top to bottom, and closes it.
fn entries(window: &mut Window, heading: &str) -> Vec<String> {
    const KNOWN: [&str; 8] = [
        "Select",
        "Show in the middle",
        "Decision chain",
        "Go to creation",
        "Last change",
        "Choose as base",
        "Watch",
        "Stop watching",
    ];
    window.run_steps(3);
    let head = window.get_by_label(heading).rect();
    // The inspector has buttons of the same names elsewhere.
    let is_below = |node: &Node<'_>| node.rect().left() < head.right() && node.rect().right() > head.left();
    let mut found: Vec<(f32, String)> = Vec::new();
    for name in KNOWN {
        let here = window.query_all_by_label(name).filter(is_below).filter(|node| node.rect().top() > head.top());
        found.extend(here.map(|node| (node.rect().top(), name.to_owned())));
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    window.key_press(Key::Escape);
    window.run_steps(3);
    assert!(window.query_by_label(heading).is_none(), "the menu is closed");
    found.into_iter().map(|entry| entry.1).collect()
}

const OF_A_QUAD: [&str; 6] =
    ["Select", "Show in the middle", "Decision chain", "Go to creation", "Last change", "Watch"];
const OF_A_NODE: [&str; 5] = ["Select", "Show in the middle", "Go to creation", "Last change", "Watch"];
const OF_AN_EDGE: [&str; 4] = ["Select", "Show in the middle", "Last change", "Watch"];
const OF_A_SEGMENT: [&str; 5] = ["Select", "Show in the middle", "Last change", "Choose as base", "Watch"];

#[test]
fn rows_and_views_have_the_menu_of_what_they_stand_for() {
    let Some(mut window) = at_the_end("Elements") else { return };
    let worst = window.state().state.run().moment.as_ref().unwrap().worst.unwrap().0;
    let name = format!("Quadrilateral {}", worst.0);
    row(&mut window, &name);
    let at = window.get_by_label(&name).rect();
    open_menu(&mut window, at);
    assert_eq!(entries(&mut window, &format!("element {}", worst.0)), OF_A_QUAD);
    // In the view.
    apply(&mut window, Command::Show(Outlined::Element(worst)));
    let middle = window.query_all_by_label_contains("Mesh at step").next().unwrap().rect().center();
    window.hover_at(middle);
    window.run_steps(3);
    let heading = match window.state().state.frame().hovered.unwrap() {
        Outlined::Element(e) => (format!("element {}", e.0), &OF_A_QUAD[..]),
        Outlined::Node(n) => (format!("node {}", n.0), &OF_A_NODE[..]),
        Outlined::Edge([a, b]) => (format!("edge {}\u{2013}{}", a.0, b.0), &OF_AN_EDGE[..]),
    };
    for pressed in [true, false] {
        let (pos, button, modifiers) = (middle, PointerButton::Secondary, Modifiers::NONE);
        window.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
        window.run_steps(1);
    }
    assert_eq!(entries(&mut window, &heading.0), heading.1);
    window.get_by_role_and_label(egui::Role::Tab, "Nodes").click();
    row(&mut window, "Node 0");
    let at = window.get_by_label("Node 0").rect();
    open_menu(&mut window, at);
    assert_eq!(entries(&mut window, "node 0"), OF_A_NODE);
    // On the front, and among the candidates for a side.
    apply(&mut window, Command::Go(Goal::Step(0)));
    let chosen = Goal::Kind(EventKind::SideSwapped, Direction::Forward);
    apply(&mut window, Command::Go(chosen));
    let moment = window.state().state.run().moment.clone().unwrap();
    let base = moment.phase.base().unwrap();
    let segment = moment.front.iter().map(|s| [s.a, s.b]).find(|ends| *ends != [base.a, base.b]).unwrap();
    window.get_by_role_and_label(egui::Role::Tab, "Front").click();
    let name = format!("Segment {} \u{2192} {}", segment[0].0, segment[1].0);
    row(&mut window, &name);
    let at = window.get_by_label(&name).rect();
    open_menu(&mut window, at);
    let heading = format!("edge {}\u{2013}{}", segment[0].0, segment[1].0);
    assert_eq!(entries(&mut window, &heading), OF_A_SEGMENT);
    let refused = moment.refused().into_iter().find(|candidate| !candidate.reason.starts_with("swap")).unwrap();
    let [from, top] = refused.ends;
    let edge = format!("{}\u{2013}{}", from.0, top.0);
    let at = window.get_by_label_contains(&format!("{edge}  ")).rect();
    open_menu(&mut window, at);
    assert_eq!(entries(&mut window, &format!("edge {edge}")), OF_AN_EDGE);
}

/// The texts that were painted in the last frame, but for what is fully transparent.
fn painted(window: &Window) -> Vec<(String, egui::Rect)> {
    fn add(shape: &Shape, texts: &mut Vec<(String, egui::Rect)>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(shape, texts)),
            Shape::Text(text) if text.opacity_factor > 0.0 => {
                texts.push((text.galley.text().to_owned(), text.visual_bounding_rect()));
            }
            _ => {}
        }
    }
    let mut texts = Vec::new();
    window.output().shapes.iter().for_each(|shape| add(&shape.shape, &mut texts));
    texts
}

#[test]
fn a_candidate_whose_row_is_pointed_at_has_its_name_and_its_reason_in_the_view() {
    let Some(mut window) = at_the_end("Front") else { return };
    apply(&mut window, Command::Go(Goal::Step(0)));
    apply(&mut window, Command::Go(Goal::Kind(EventKind::SideSwapped, Direction::Forward)));
    let refused = window.state().state.run().moment.as_ref().unwrap().refused();
    // In a view of the whole mesh the reasons have no room, and the letters of the base stand there.
    apply(&mut window, Command::Fit);
    let mut seen = 0;
    for candidate in refused.iter().filter(|candidate| !candidate.reason.starts_with("swap")) {
        let [from, top] = candidate.ends.map(|n| n.0);
        let text = format!("{from}\u{2013}{top}  \u{b7}  {}", candidate.reason);
        let find = |window: &Window| painted(window).into_iter().find(|painted| painted.0 == text);
        assert!(find(&window).is_none(), "{text}");
        let row = format!("{from}\u{2013}{top}  ");
        window.get_by_label_contains(&row).scroll_to_me();
        window.run_steps(5);
        window.get_by_label_contains(&row).hover();
        window.run_steps(3);
        let rect = find(&window).unwrap_or_else(|| panic!("{text}: {:?}", painted(&window))).1;
        let view = window.get_by_role(egui::Role::Canvas).rect();
        assert!(view.contains_rect(rect), "{rect} in {view}");
        seen += 1;
    }
    assert!(seen > 0, "{} candidates", refused.len());
}

#[test]
fn the_chain_of_a_row_is_unfolded_and_scrolled_to_and_a_node_leads_to_the_step_that_made_it() {
    let Some(mut window) = at_the_end("Elements") else { return };
    let worst = window.state().state.run().moment.as_ref().unwrap().worst.unwrap().0;
    // The section is folded.
    apply(&mut window, Command::Find(Outlined::Element(worst)));
    row(&mut window, "Decision chain");
    window.get_by_label("Decision chain").click();
    window.run_steps(3);
    assert!(window.query_by_label_contains("Chain, step ").is_none());
    apply(&mut window, Command::Pick(None));
    let name = format!("Quadrilateral {}", worst.0);
    row(&mut window, &name);
    let at = window.get_by_label(&name).rect();
    open_menu(&mut window, at);
    window.run_steps(3);
    window.get_by_label("Decision chain").click();
    until(&mut window, "the chain is unfolded", |window| {
        window.query_all_by_label_contains("Chain, step ").next().is_some()
    });
    assert_eq!(picked(&window), Some(Outlined::Element(worst)));
    window.run_steps(20);
    let (head, first) =
        (window.get_by_label("Decision chain").rect(), window.get_all_by_label_contains("Chain, step "));
    let first = first.map(|node| node.rect().top()).fold(f32::INFINITY, f32::min);
    assert!(head.bottom() <= first && first < LAPTOP.y, "{head} {first}");
    // A node that was made after the beginning.
    let born = window.state().state.run().born.nodes.clone();
    let made = born.into_iter().rev().find(|born| mesh(&window).has_node(born.1)).unwrap();
    apply(&mut window, Command::Made(Outlined::Node(made.1)));
    assert!(mesh(&window).has_node(made.1));
    assert_eq!(window.state().state.run().moment.as_ref().unwrap().step, made.0);
    apply(&mut window, Command::Go(Goal::Steps(-1)));
    assert!(!mesh(&window).has_node(made.1));
}

#[test]
fn the_last_change_of_a_row_is_that_of_its_history() {
    let Some(mut window) = at_the_end("Nodes") else { return };
    row(&mut window, "Node 0");
    window.get_by_label("Sort by last, change").click();
    window.run_steps(2);
    window.get_by_label("Sort by last, change").click();
    // The node that a step changed last comes first, and its history ends with that step.
    let mut log = LastChanges::default();
    let run = window.state().state.run();
    let step = run.moment.as_ref().unwrap().step;
    log.follow(&run.change_log, step);
    let latest = mesh(&window).nodes().max_by_key(|n| (log.of_node(n.0), std::cmp::Reverse(*n))).unwrap();
    let name = format!("Node {}", latest.0);
    until(&mut window, &name, |window| {
        let rows = window.query_all_by_label_contains("Node ");
        let top = rows.min_by(|a, b| a.rect().top().total_cmp(&b.rect().top()));
        top.is_some_and(|node| label(&node) == name)
    });
    apply(&mut window, Command::Pick(Some(Outlined::Node(latest))));
    let link = format!("step {}  ", grouped(log.of_node(latest.0)));
    until(&mut window, &link, |window| window.query_all_by_label_contains(&link).next().is_some());
    let newest = window.get_all_by_label_contains("step ").filter(|node| label(node).starts_with("step "));
    // The heading of a section has a step alone.
    let newest = newest.filter(|node| label(node).contains("  "));
    let newest = newest.min_by(|a, b| a.rect().top().total_cmp(&b.rect().top())).unwrap();
    assert!(label(&newest).starts_with(&link), "{}", label(&newest));
}
