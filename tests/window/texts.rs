//! No text of the window is cut or lies over another one, at the sizes of usual screens, dark and light; and every
//! control has a name for screen readers.

use std::collections::BTreeMap;

use eframe::egui::accesskit::Action;
use eframe::egui::{Rect, Role, Shape, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use quadfront::app::window::{App, Command, Goal, Source};
use quadfront::core::convert::EventKind;
use quadfront::render::scene::Outlined;

use super::messages::SIZES;
use super::window_harness::{Window, apply, has_adapter, settle, start};

/// The height of a bar of tabs.
const TAB_BAR: f32 = 28.0;

/// What is wrong, and where it was seen first.
pub type Found = BTreeMap<String, String>;

/// A text on the screen: what it says, where, and what of it is seen.
pub struct Text {
    pub said: String,
    pub rect: Rect,
    seen: Rect,
    is_elided: bool,
}

/// All texts that were painted in the last frame.
pub fn texts(harness: &Window) -> Vec<Text> {
    fn add(shape: &Shape, clip: Rect, texts: &mut Vec<Text>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| add(shape, clip, texts)),
            Shape::Text(text) if text.opacity_factor > 0.0 => {
                for row in &text.galley.rows {
                    // What is inked: an indented first line begins with room.
                    let rect = row.visuals.mesh_bounds.translate(text.pos.to_vec2() + row.pos.to_vec2());
                    let seen = rect.intersect(clip);
                    let said = row.text();
                    if rect.is_positive() && seen.is_positive() && !said.trim().is_empty() {
                        texts.push(Text { said, rect, seen, is_elided: text.galley.elided });
                    }
                }
            }
            _ => {}
        }
    }
    let mut texts = Vec::new();
    harness.output().shapes.iter().for_each(|shape| add(&shape.shape, shape.clip_rect, &mut texts));
    texts
}

/// What is wrong with the texts of the last frame.
pub fn faults(harness: &Window, over: bool) -> Vec<String> {
    let texts = texts(harness);
    let tabs: Vec<String> =
        harness.query_all_by_role(Role::Tab).filter_map(|tab| tab.accesskit_node().label()).collect();
    let is_tab = |said: &str| tabs.iter().any(|tab| tab == said);
    let mut faults = Vec::new();
    for text in &texts {
        if text.is_elided {
            faults.push(format!("elided: {}", text.said));
        }
        // What a list has scrolled away above and below is no fault, nor is a tab that a full bar has.
        if text.seen.width() + 1.0 < text.rect.width() && !is_tab(&text.said) {
            faults.push(format!("cut: {} at {:?}, seen {:?}", text.said, text.rect, text.seen));
        }
    }
    // What lies over the views covers texts by intent.
    for (k, a) in texts.iter().enumerate().filter(|_| !over) {
        for b in &texts[..k] {
            let both = a.seen.intersect(b.seen);
            // Slanted letters of equations lean over their neighbours.
            let is_letter = |text: &Text| text.said.trim().chars().count() == 1;
            let least = if is_letter(a) && is_letter(b) { 2.2 } else { 1.0 };
            if both.width() > least && both.height() > 1.0 {
                faults.push(format!("\"{}\" lies over \"{}\" at {both:?}", a.said, b.said));
            }
        }
    }
    faults
}

/// Controls without a name.
pub fn nameless(harness: &Window, over: bool) -> Vec<String> {
    // Splitters and the grounds of tab bars belong to the docks, and those of titles to the windows over the views.
    let is_dock = |rect: Rect| rect.width() < 8.0 || rect.height() < 8.0 || rect.height() == TAB_BAR;
    let is_nameless = |node: &egui_kittest::Node<'_>| {
        let of = node.accesskit_node();
        let is_control = match of.role() {
            Role::Label | Role::ScrollBar | Role::GenericContainer | Role::Window => false,
            Role::Unknown => !over && !is_dock(node.rect()) && of.children().next().is_none(),
            _ => true,
        };
        let has_name = of.label().is_some_and(|label| !label.trim().is_empty());
        is_control && of.data().supports_action(Action::Click) && !has_name
    };
    let found = harness.root().children_recursive().filter(is_nameless);
    found.map(|node| format!("no name: {:?} at {:?}", node.accesskit_node().role(), node.rect())).collect()
}

pub fn note(found: &mut Found, faults: Vec<String>, place: &str) {
    for fault in faults {
        found.entry(fault).or_insert_with(|| place.to_owned());
    }
}

/// Clicks every tab, and looks at what it shows.
pub fn walk(harness: &mut Window, what: &str, found: &mut Found) {
    let tabs: Vec<String> =
        harness.query_all_by_role(Role::Tab).filter_map(|tab| tab.accesskit_node().label()).collect();
    for tab in tabs.iter().rev() {
        // One that is scrolled out of sight, too.
        harness.get_by_role_and_label(Role::Tab, tab).click_accesskit();
        harness.run_steps(4);
        let mut seen = faults(harness, false);
        // These tables are wider than their docks, and scroll sideways.
        seen.retain(|fault| !(["Elements", "Nodes"].contains(&tab.as_str()) && fault.starts_with("cut")));
        note(found, seen, &format!("{what}, {tab}"));
        note(found, nameless(harness, false), &format!("{what}, {tab}"));
    }
}

fn look_at(case: &str, sizes: &[Vec2]) {
    if !has_adapter() {
        return;
    }
    let mut found = Found::new();
    for &size in sizes {
        let source = Source::BuiltIn(case.to_owned());
        let mut harness = start(size, |cc| App::new(cc, Some(source)));
        settle(&mut harness);
        if harness.state().state.view().notes {
            apply(&mut harness, Command::Notes);
        }
        for condition in ["quad.min_angle < 30 && base.level > 2", "kind == rolled_back"] {
            apply(&mut harness, Command::AddBreakpoint(condition.to_owned()));
        }
        apply(&mut harness, Command::Bookmark);
        let track = &harness.state().state.run().track;
        let first = |kind| track.iter().position(|step| step.kind == kind).map(|k| k as u64 + 1);
        let kinds = [EventKind::BaseSelected, EventKind::SideSwapped, EventKind::TopSwapped, EventKind::RolledBack];
        let end = track.len() as u64;
        let mut steps: Vec<u64> = kinds.into_iter().filter_map(first).collect();
        steps.extend([0, end / 2, end / 2 + 1, end / 2 + 2, end]);
        for theme in ["dark", "light"] {
            for &step in &steps {
                apply(&mut harness, Command::Go(Goal::Step(step)));
                apply(&mut harness, Command::Pick(None));
                let what = format!("{case} {} x {} {theme}, step {step}", size.x, size.y);
                walk(&mut harness, &what, &mut found);
                if theme == "light" {
                    continue;
                }
                let moment = harness.state().state.run().moment.clone().unwrap();
                let (e, h) = (moment.mesh.elements().next().unwrap(), moment.mesh.edges().next().unwrap());
                let [a, b] = moment.mesh.ends(h);
                let front = moment.front.last().map(|segment| Outlined::Edge([segment.a, segment.b]));
                for picked in [Outlined::Element(e), Outlined::Edge([a, b]), Outlined::Node(a)].into_iter().chain(front)
                {
                    apply(&mut harness, Command::Pick(Some(picked)));
                    harness.run_steps(4);
                    note(&mut found, faults(&harness, false), &format!("{what}, {picked:?}"));
                }
            }
            apply(&mut harness, Command::ToggleTheme);
        }
        for command in [
            Command::Notes,
            Command::Figures,
            Command::Messages,
            Command::Help,
            Command::Palette,
            Command::FindField,
            Command::GoTo,
            Command::OpenPath,
            Command::SaveMesh,
        ] {
            apply(&mut harness, command.clone());
            harness.run_steps(4);
            let what = format!("{case} {} x {}, {}", size.x, size.y, command.name());
            note(&mut found, faults(&harness, true), &what);
            note(&mut found, nameless(&harness, true), &what);
            apply(&mut harness, Command::Escape);
        }
    }
    are_none(&found);
}

pub fn are_none(found: &Found) {
    let list: Vec<String> = found.iter().take(60).map(|(fault, place)| format!("{fault} ({place})")).collect();
    assert!(found.is_empty(), "{} faults\n{}", found.len(), list.join("\n"));
}

#[test]
fn nothing_lies_over_anything_in_a_window_that_is_too_small() {
    if !has_adapter() {
        return;
    }
    for case in ["example1", "example2"] {
        let source = Source::BuiltIn(case.to_owned());
        let mut harness = start(Vec2::new(640.0, 480.0), |cc| App::new(cc, Some(source)));
        settle(&mut harness);
        let mut found = Found::new();
        for step in [0, 3, 700] {
            apply(&mut harness, Command::Go(Goal::Step(step)));
            walk(&mut harness, case, &mut found);
        }
        found.retain(|fault, _| fault.contains("lies over"));
        assert!(found.is_empty(), "{found:#?}");
        // What opens over the views is no wider than the window.
        harness.get_by_role_and_label(Role::Tab, "Space").click();
        harness.run_steps(3);
        harness.get_by_label("Layers and colours").click();
        harness.run_steps(4);
        let menu = harness.get_by_label("Colour by").rect();
        assert!(menu.width() < 300.0 && menu.right() < 640.0, "{menu:?}");
        apply(&mut harness, Command::Escape);
        for command in [Command::Notes, Command::Messages, Command::Help, Command::Palette] {
            apply(&mut harness, command.clone());
            harness.run_steps(4);
            let cut: Vec<String> = faults(&harness, true).into_iter().filter(|f| f.starts_with("cut")).collect();
            assert!(cut.is_empty(), "{command:?}: {cut:#?}");
            apply(&mut harness, Command::Escape);
        }
    }
}

#[test]
fn no_text_of_a_plane_case_is_cut_or_covered() {
    look_at("example1", &SIZES);
}

#[test]
fn no_text_of_a_surface_is_cut_or_covered() {
    look_at("example2", &SIZES);
}

#[test]
fn no_text_of_a_case_of_the_paper_is_cut_or_covered() {
    look_at("figure-14", &SIZES);
}
