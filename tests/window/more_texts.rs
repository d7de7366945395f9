//! The same as in `texts` where more is open: two runs, a finished sweep, notes and messages, a field, menus, and the
//! window for figures, which has room for all of its controls.

use eframe::egui::{Role, Vec2};
use egui_kittest::kittest::Queryable;
use quadfront::app::window::{App, Arrangement, Command, Goal, PairCommand, Source, StudyCommand, SweepCommand, Which};
use quadfront::core::convert::EventKind;
use quadfront::core::lesson::built_in::{self, LESSONS};
use quadfront::core::record::report::figures::FIGURES;

use super::messages::SIZES;
use super::texts::{Found, are_none, faults, nameless, note, walk};
use super::window_harness::{Window, apply, has_adapter, settle, start, until};

fn window(case: &str, size: Vec2) -> Option<Window> {
    if !has_adapter() {
        return None;
    }
    let source = Source::BuiltIn(case.to_owned());
    let mut harness = start(size, |cc| App::new(cc, Some(source)));
    settle(&mut harness);
    if harness.state().state.view().notes {
        apply(&mut harness, Command::Notes);
    }
    Some(harness)
}

fn both_settle(harness: &mut Window) {
    settle(harness);
    until(harness, "both runs are there and compared", |harness| {
        let state = &harness.state().state;
        let is_there = |which| {
            let run = state.of(which).run();
            run.moment.is_some() && !run.is_busy() && run.recorded
        };
        Which::ALL.into_iter().all(is_there)
            && state.pair().is_some_and(|pair| {
                pair.is_same || pair.comparison.as_ref().is_some_and(|found| found.differences.is_some())
            })
    });
}

fn pair(harness: &mut Window, command: PairCommand) {
    harness.state_mut().apply(Command::Pair(command));
    both_settle(harness);
}

/// What is open over the panels.
fn look(harness: &mut Window, what: &str, found: &mut Found) {
    harness.run_steps(4);
    note(found, faults(harness, true), what);
    note(found, nameless(harness, true), what);
}

#[test]
fn no_text_of_two_runs_is_cut_or_covered() {
    let mut found = Found::new();
    for size in SIZES {
        let Some(mut harness) = window("example1", size) else { return };
        harness.state_mut().apply(Command::Pair(PairCommand::Fork));
        both_settle(&mut harness);
        walk(&mut harness, &format!("forked, {} x {}", size.x, size.y), &mut found);
        harness.state_mut().apply(Command::Set("c", "1.5".to_owned()));
        both_settle(&mut harness);
        for theme in ["dark", "light"] {
            for arrangement in Arrangement::ALL {
                pair(&mut harness, PairCommand::Show(arrangement));
                for goal in [None, Some(Goal::Step(600)), Some(Goal::End)] {
                    match goal {
                        None => pair(&mut harness, PairCommand::ToDifference),
                        Some(goal) => {
                            harness.state_mut().apply(Command::Go(goal));
                            both_settle(&mut harness);
                        }
                    }
                    let what = format!("{}, {} x {} {theme}, {goal:?}", arrangement.name(), size.x, size.y);
                    walk(&mut harness, &what, &mut found);
                }
            }
            apply(&mut harness, Command::ToggleTheme);
        }
    }
    are_none(&found);
}

#[test]
fn no_text_of_a_finished_sweep_is_cut_or_covered() {
    let mut found = Found::new();
    for size in SIZES {
        let Some(mut harness) = window("figure-14", size) else { return };
        harness.state_mut().apply(Command::Sweep(SweepCommand::Run));
        until(&mut harness, "the sweep has ended", |harness| {
            let work = harness.state().state.sweep();
            work.is_some_and(|work| !work.is_running() && work.sweep.as_ref().is_some_and(|s| s.missing().is_empty()))
        });
        for theme in ["dark", "light"] {
            for figure in FIGURES {
                let mut form = harness.state().state.workspace().sweep.clone();
                form.figure = figure.name;
                harness.state_mut().apply(Command::Sweep(SweepCommand::Set(Box::new(form))));
                harness.run_steps(4);
                let what = format!("sweep, {}, {} x {} {theme}", figure.name, size.x, size.y);
                note(&mut found, faults(&harness, false), &what);
                note(&mut found, nameless(&harness, false), &what);
            }
            apply(&mut harness, Command::ToggleTheme);
        }
        apply(&mut harness, Command::Sweep(SweepCommand::Save));
        look(&mut harness, &format!("the path of a sweep, {} x {}", size.x, size.y), &mut found);
        apply(&mut harness, Command::Escape);
        // Beside two runs the map is narrower.
        pair(&mut harness, PairCommand::Fork);
        apply(&mut harness, Command::Sweep(SweepCommand::Show));
        walk(&mut harness, &format!("sweep beside two runs, {} x {}", size.x, size.y), &mut found);
    }
    are_none(&found);
}

#[test]
fn no_text_of_notes_messages_fields_and_menus_is_cut_or_covered() {
    let mut found = Found::new();
    for size in SIZES {
        let Some(mut harness) = window("example1", size) else { return };
        let at = format!("{} x {}", size.x, size.y);
        let track = &harness.state().state.run().track;
        let failed = track.iter().rposition(|step| step.kind == EventKind::RolledBack).unwrap() as u64 + 1;
        for step in [0, failed, track.len() as u64] {
            apply(&mut harness, Command::Go(Goal::Step(step)));
            apply(&mut harness, Command::Bookmark);
            let text = "Here **all** that was tried is taken back, which a long note says in more than one line.";
            apply(&mut harness, Command::WriteNote(step, text.to_owned()));
        }
        apply(&mut harness, Command::AddBreakpoint("quad.min_angle < 30 && base.level > 2".to_owned()));
        for theme in ["dark", "light"] {
            walk(&mut harness, &format!("bookmarks, {at} {theme}"), &mut found);
            // Nothing of this is in the mesh.
            for text in ["quad 99999", "node 99999", "segment 1-2", "nowhere"] {
                harness.state_mut().apply(Command::FindField);
                harness.run_steps(3);
                harness.get_by_label("Number or coordinates").type_text(text);
                harness.run_steps(2);
                harness.key_press(eframe::egui::Key::Enter);
                look(&mut harness, &format!("{text} is looked for, {at} {theme}"), &mut found);
                harness.state_mut().apply(Command::Escape);
                // What was said lies over the views.
                while !harness.state().state.view().faults.is_empty() {
                    harness.state_mut().apply(Command::CloseFault(0));
                }
                harness.run_steps(2);
            }
            harness.state_mut().apply(Command::Messages);
            look(&mut harness, &format!("messages, {at} {theme}"), &mut found);
            harness.state_mut().apply(Command::Escape);
            apply(&mut harness, Command::ToggleTheme);
        }
        for menu in ["Case", "Parameters", "View", "Figure", "Help", "Layers and colours", "go to…"] {
            harness.get_by_role_and_label(Role::Button, menu).click();
            look(&mut harness, &format!("menu {menu}, {at}"), &mut found);
            harness.key_press(eframe::egui::Key::Escape);
            harness.run_steps(3);
        }
        // The menus of rows and of the view.
        for (tab, row) in [("Front", "Segment "), ("Elements", "Quadrilateral "), ("Nodes", "Node ")] {
            apply(&mut harness, Command::Go(Goal::Step(600)));
            harness.get_by_role_and_label(Role::Tab, tab).click();
            harness.run_steps(4);
            until(&mut harness, "there are rows", |harness| harness.query_all_by_label_contains(row).next().is_some());
            // The first one may be scrolled out of the panel, and rows are wider than it.
            let shown = harness.query_all_by_label_contains(row).nth(2).unwrap().rect();
            let place = shown.left_center() + eframe::egui::Vec2::new(60.0, 0.0);
            let mut seen = Found::new();
            menu_at(&mut harness, place, &format!("menu of {tab}, {at}"), &mut seen);
            // These tables are wider than their docks, and scroll sideways.
            seen.retain(|fault, _| tab == "Front" || !fault.starts_with("cut"));
            found.extend(seen);
        }
        harness.get_by_role_and_label(Role::Tab, "Front").click();
        harness.run_steps(2);
        // Beside the hole in the middle.
        let view = harness.get_by_label_contains("Mesh at step").rect();
        let place = view.min + 0.25 * view.size();
        menu_at(&mut harness, place, &format!("menu of the view, {at}"), &mut found);
    }
    are_none(&found);
}

fn menu_at(harness: &mut Window, at: eframe::egui::Pos2, what: &str, found: &mut Found) {
    harness.hover_at(at);
    harness.run_steps(3);
    // The inspector may have that button too.
    let watches = |harness: &Window| harness.query_all_by_label("Watch").count();
    let before = watches(harness);
    harness.event(eframe::egui::Event::PointerMoved(at));
    for pressed in [true, false] {
        let (button, modifiers) = (eframe::egui::PointerButton::Secondary, eframe::egui::Modifiers::NONE);
        harness.event(eframe::egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        harness.run_steps(2);
    }
    assert_eq!(watches(harness), before + 1, "{what}");
    look(harness, what, found);
    harness.key_press(eframe::egui::Key::Escape);
    harness.run_steps(3);
}

#[test]
fn no_number_of_the_lists_is_cut_where_coordinates_are_noise() {
    let mut found = Found::new();
    let Some(mut harness) = window("wing", SIZES[0]) else { return };
    for tab in ["Elements", "Nodes"] {
        harness.get_by_role_and_label(Role::Tab, tab).click();
        harness.run_steps(20);
        let elided = faults(&harness, false).into_iter().filter(|fault| fault.starts_with("elided")).collect();
        note(&mut found, elided, tab);
    }
    are_none(&found);
}

#[test]
fn the_window_for_figures_has_room_for_all_of_its_controls() {
    let mut found = Found::new();
    for size in SIZES {
        let Some(mut harness) = window("example1", size) else { return };
        apply(&mut harness, Command::Figures);
        harness.run_steps(8);
        let last = harness.get_by_label("Save SVG and PNG").rect();
        let frame = harness.get_by_role_and_label(Role::Window, "Figure").rect();
        assert!(frame.contains_rect(last), "{size}: {last:?} in {frame:?}");
        assert!(frame.top() >= 32.0 && frame.bottom() <= size.y - 32.0, "{size}: {frame:?}");
        look(&mut harness, &format!("figures, {size}"), &mut found);
    }
    are_none(&found);
}

#[test]
fn no_text_of_a_lesson_is_cut_or_covered() {
    let mut found = Found::new();
    for size in SIZES {
        let Some(mut harness) = window("figure-14", size) else { return };
        for (k, (name, _)) in LESSONS.iter().enumerate() {
            // Two lessons of three in one theme, the others in the other one; all of them at the smallest size.
            if size != SIZES[0] && k % 3 > 0 {
                continue;
            }
            if k % 2 == 1 {
                apply(&mut harness, Command::ToggleTheme);
            }
            harness.state_mut().apply(Command::Study(StudyCommand::Open(name)));
            harness.run_steps(2);
            let parts = built_in::named(name).unwrap().unwrap().parts.len();
            for part in 0..parts {
                until(&mut harness, "the part is told", |harness| {
                    let study = harness.state().state.study();
                    study.is_some_and(|study| {
                        let is_here = study.lesson().is_some_and(|(lesson, at)| lesson.name == *name && at == part);
                        is_here && study.taught.is_some() && study.decisions.is_some()
                    })
                });
                settle(&mut harness);
                let what = format!("{name}, part {}, {} x {}", part + 1, size.x, size.y);
                let look = |harness: &mut Window, found: &mut Found| {
                    harness.run_steps(4);
                    note(found, faults(harness, false), &what);
                    note(found, nameless(harness, false), &what);
                };
                look(&mut harness, &mut found);
                let posed = harness.state().state.study().unwrap().posed().cloned();
                if let Some(posed) = posed {
                    posed.hints.iter().for_each(|_| harness.state_mut().apply(Command::Study(StudyCommand::Hint)));
                    look(&mut harness, &mut found);
                    harness.state_mut().apply(Command::Study(StudyCommand::Continue));
                    until(&mut harness, "the answer is judged", |harness| {
                        harness.state().state.study().is_some_and(|study| study.is_answered())
                    });
                    look(&mut harness, &mut found);
                }
                if part + 1 < parts {
                    harness.state_mut().apply(Command::Study(StudyCommand::Part(part + 1)));
                    harness.run_steps(2);
                }
            }
        }
    }
    are_none(&found);
}
