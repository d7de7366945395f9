//! Promise: the window sweeps parameters while one goes on working, and a cell opens the run that it stands for.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

#[path = "window_harness/pictures.rs"]
mod pictures;
mod window_harness;

use std::time::{Duration, Instant};

use eframe::egui::Vec2;
use egui_kittest::kittest::Queryable;
use pictures::{difference, picture};
use quadfront::app::window::{App, Command, Goal, Lost, PairCommand, Source, SweepCommand, Which};
use quadfront::core::case::Parameters;
use quadfront::core::record::report::figures::Figure;
use quadfront::core::record::sweep::Sweep;
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};

/// The window on example 1, with the panel of the sweep in front.
fn window(size: Vec2) -> Option<Window> {
    if !has_adapter() {
        return None;
    }
    let mut window = start(size, |cc| App::new(cc, Some(Source::BuiltIn("example1".to_owned()))));
    settle(&mut window);
    window.get_by_label("Sweep").click();
    window.run_steps(2);
    Some(window)
}

fn sweep(window: &Window) -> &Sweep {
    window.state().state.sweep().unwrap().sweep.as_ref().unwrap()
}

fn is_running(window: &Window) -> bool {
    window.state().state.sweep().is_some_and(|sweep| sweep.is_running())
}

fn known(window: &Window) -> usize {
    let work = window.state().state.sweep();
    let sweep = work.and_then(|work| work.sweep.as_ref());
    sweep.map_or(0, |sweep| sweep.cells().len() - sweep.missing().len())
}

fn value(window: &Window, cell: usize, figure: &str) -> f64 {
    sweep(window).value(cell, Figure::named(figure).unwrap()).unwrap()
}

/// Waits until the second run is open: it is that of a cell.
fn second_is_the_run_of(window: &mut Window, cell: usize) {
    until(window, "its run is there", |window| {
        let state = &window.state().state;
        let run = state.of(Which::B).run();
        state.pair().is_some() && run.moment.is_some() && !run.is_busy() && run.recorded
    });
    is_the_run_of(window, cell, Which::B);
}

/// What the window has at the end of a run is what the cell says.
fn is_the_run_of(window: &mut Window, cell: usize, which: Which) {
    apply(window, Command::Go(Goal::End));
    until(window, "it is at the end", |window| {
        let run = window.state().state.of(which).run();
        !run.is_busy() && run.is_at_the_end()
    });
    let state = window.state().state.of(which);
    let parameters: &Parameters = &state.run().opened.as_ref().unwrap().run.parameters;
    for (key, of_cell) in sweep(window).values(cell) {
        assert_eq!(parameters.text_of(key).as_deref(), Some(of_cell));
    }
    let mesh = &state.run().moment.as_ref().unwrap().mesh;
    let quads = mesh.elements().filter(|e| mesh.is_quad(*e)).count();
    assert_eq!(quads as f64, value(window, cell, "quads"));
    assert_eq!(mesh.nodes().count() as f64, value(window, cell, "nodes"));
    assert_eq!(window.state().state.sweep().unwrap().at_hand(state), Some(cell), "the cell at hand is outlined");
}

#[test]
fn a_cell_of_a_sweep_opens_the_run_with_the_same_figures() {
    let Some(mut window) = window(LAPTOP) else { return };
    type_over(&mut window, "Values across", "1.5,2,2.5");
    type_over(&mut window, "Values upward", "120,135");
    assert!(window.query_by_label("6 runs").is_some());
    let before = picture(&mut window, "sweep-before");
    window.get_by_label("Run the sweep").click();
    window.run_steps(2);
    until(&mut window, "the sweep has ended", |window| known(window) == 6 && !is_running(window));
    let after = picture(&mut window, "sweep");
    assert!(difference(&before, &after) > 0.01, "the cells have colours");
    for (cell, name) in [(2, "c = 2.5, theta_rect = 120°"), (3, "c = 1.5, theta_rect = 135°")] {
        let irregular = value(&window, cell, "irregular");
        // All six have three digits of the largest.
        let largest = (0..6).map(|cell| value(&window, cell, "irregular")).fold(0.0, f64::max);
        let label = format!("{name}: {irregular:.*} %", if largest < 10.0 { 2 } else { 1 });
        // A click opens it as the second run.
        window.get_by_label(&label).click();
        window.run_steps(2);
        second_is_the_run_of(&mut window, cell);
        apply(&mut window, Command::Pair(PairCommand::Close));
        // Or in place of the one that is open.
        let number = window.state().state.run().number;
        window.state_mut().apply(Command::Sweep(SweepCommand::Open(cell)));
        until(&mut window, "its run is open", |window| window.state().state.run().number > number);
        settle(&mut window);
        is_the_run_of(&mut window, cell, Which::A);
        window.state_mut().apply(Command::Sweep(SweepCommand::Show));
        window.run_steps(2);
    }
    // What is known already is not swept again; the case's own values of the run that is open now are others.
    type_over(&mut window, "Values across", "1.5,2");
    apply(&mut window, Command::Open(Source::BuiltIn("example1".to_owned())));
    window.get_by_label("Run the sweep").click();
    window.run_steps(2);
    until(&mut window, "the sweep has ended", |window| known(window) == 4 && !is_running(window));
}

/// How many threads of sweeps run or want to, as Linux counts them.
fn at_work() -> usize {
    let Ok(tasks) = std::fs::read_dir("/proc/self/task") else { return 0 };
    let is_at_work = |task: &std::fs::DirEntry| {
        // One that has ended meanwhile has no files.
        let read = |name: &str| std::fs::read_to_string(task.path().join(name)).unwrap_or_default();
        let stat = read("stat");
        let state = stat.rsplit(") ").next().unwrap_or_default().chars().next();
        read("comm").trim() == "sweep" && state == Some('R')
    };
    tasks.filter_map(Result::ok).filter(is_at_work).count()
}

#[test]
fn a_sweep_of_63_runs_takes_all_processors_and_each_stop_is_answered_at_once() {
    let Some(mut window) = window(LAPTOP) else { return };
    assert!(window.query_by_label("63 runs").is_some(), "7 values of c and 9 of theta_rect");
    let processors = std::thread::available_parallelism().unwrap().get();
    let mut took = Vec::new();
    let mut most = 0;
    let mut before = 0;
    // As long as there is something left to stop.
    while took.len() < 20 && before < 40 {
        window.get_by_label("Run the sweep").click();
        window.run_steps(2);
        until(&mut window, "another cell is known", |window| known(window) > before);
        assert_eq!(window.state().state.sweep().unwrap().threads, processors);
        for _ in 0..20 {
            most = most.max(at_work());
        }
        window.get_by_label("Stop the sweep").click();
        let begin = Instant::now();
        while is_running(&window) {
            window.step();
        }
        took.push(begin.elapsed());
        let count = known(&window);
        window.run_steps(2);
        assert_eq!(known(&window), count, "what there is stays, and nothing comes after that");
        before = count;
    }
    took.sort();
    let median = took[took.len() / 2];
    println!("{most} of {processors} threads at work; {} stops, median {median:?}: {took:?}", took.len());
    if cfg!(target_os = "linux") {
        assert_eq!(most, processors);
    }
    // A tenth of a second and a few frames of a slow machine.
    assert!(median < Duration::from_millis(400) && took.len() > 2, "{took:?}");
    // A cell that was known when it was stopped is the run that it stands for.
    let cell = (0..63).find(|cell| sweep(&window).cells()[*cell].is_some()).unwrap();
    window.state_mut().apply(Command::Sweep(SweepCommand::OpenBeside(cell)));
    window.run_steps(2);
    second_is_the_run_of(&mut window, cell);
}

#[test]
fn a_sweep_is_stopped_at_once_and_keeps_what_it_has_while_the_window_goes_on() {
    let Some(mut window) = window(Vec2::new(1600.0, 1000.0)) else { return };
    type_over(&mut window, "Values across", "1:3:0.1");
    assert!(window.query_by_label("189 runs").is_some());
    window.state_mut().apply(Command::Sweep(SweepCommand::Run));
    until(&mut window, "some cells are known", |window| known(window) > 3);
    // One steps meanwhile.
    let step = |window: &Window| window.state().state.run().moment.as_ref().unwrap().step;
    apply(&mut window, Command::Go(Goal::Step(100)));
    assert!(step(&window) == 100 && is_running(&window));
    picture(&mut window, "sweep-running");
    let begin = Instant::now();
    window.get_by_label("Stop the sweep").click();
    while is_running(&window) {
        window.step();
    }
    assert!(
        begin.elapsed() < Duration::from_millis(400),
        "a tenth of a second and a few frames: {:?}",
        begin.elapsed()
    );
    let count = known(&window);
    assert!((4..189).contains(&count), "{count}");
    std::thread::sleep(Duration::from_millis(500));
    window.run_steps(2);
    assert_eq!(known(&window), count, "no cell comes after that");
    assert!(window.query_by_label_contains("stopped, ").is_some());
    // What there is can be saved, in the format of the name.
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.csv", "a.json", "a.svg"] {
        let path = folder.path().join(name);
        window.state_mut().apply(Command::Sweep(SweepCommand::Save));
        window.run_steps(2);
        type_over(&mut window, "Path of the sweep", path.to_str().unwrap());
        until(&mut window, "the sweep is saved", |_| path.exists());
    }
    let csv = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
    assert_eq!(csv.lines().count(), 190);
    let json = std::fs::read_to_string(folder.path().join("a.json")).unwrap();
    assert_eq!(Sweep::parse(&json).unwrap().unwrap(), *sweep(&window));
}

#[test]
fn what_cannot_be_swept_is_said_where_it_is_typed() {
    let Some(mut window) = window(LAPTOP) else { return };
    type_over(&mut window, "Values across", "1:two:1");
    assert!(window.query_by_label_contains("\"two\" is not a number").is_some());
    type_over(&mut window, "Values across", "1:3:0.001");
    assert!(window.query_by_label_contains("too many for the window").is_some());
    window.state_mut().apply(Command::Sweep(SweepCommand::Save));
    window.run_steps(2);
    assert!(window.query_by_label_contains("There is no sweep yet").is_some());
    // A parameter that the run changes at a step would not be that of the cell.
    type_over(&mut window, "Values across", "1,2");
    apply(&mut window, Command::Go(Goal::Step(50)));
    apply(&mut window, Command::Set("c", "1.5".to_owned()));
    window.get_by_label("Run the sweep").click();
    window.run_steps(2);
    until(&mut window, "it is refused", |window| {
        window.query_by_label_contains("The run changes c at step 50").is_some()
    });
    assert!(!is_running(&window));
}

#[test]
fn what_is_swept_is_kept_from_one_start_to_the_next_also_when_the_window_is_killed() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("window.json");
    let begin = || {
        let (source, path) = (Source::BuiltIn("example1".to_owned()), path.clone());
        let mut window = start(LAPTOP, |cc| App::kept(cc, Some(source), Some(path), Lost::default()));
        settle(&mut window);
        window.get_by_label("Sweep").click();
        window.run_steps(2);
        window
    };
    let mut killed = begin();
    type_over(&mut killed, "Values across", "1.625,2.25");
    let mut form = killed.state().state.workspace().sweep.clone();
    (form.axes[1], form.figure) = ((None, form.axes[1].1.clone()), "quality.mean");
    apply(&mut killed, Command::Sweep(SweepCommand::Set(Box::new(form.clone()))));
    until(&mut killed, "it is written", |_| {
        std::fs::read_to_string(&path).is_ok_and(|text| text.contains("1.625,2.25") && text.contains("quality.mean"))
    });
    // The first window is never closed in order.
    let again = begin();
    assert_eq!(again.state().state.workspace().sweep, form);
    assert_eq!(again.get_by_label("Values across").value().as_deref(), Some("1.625,2.25"));
    assert!(again.query_by_label("2 runs").is_some());
}
