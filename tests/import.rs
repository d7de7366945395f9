//! Promise: a mesh without CAD is opened by a panel that shows how it is taken and what it is like, and converts it.
//!
//! Needs a graphics adapter (see `window_harness`).
#![allow(clippy::unwrap_used)]

#[path = "window_harness/pictures.rs"]
mod pictures;
mod window_harness;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use eframe::egui::Key;
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use pictures::{difference, picture};
use quadfront::MeshUse;
use quadfront::app::window::{App, Command, Gesture, Overrides, Source};
use quadfront::core::case::ImportOptions;
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};

/// A window on nothing.
fn window() -> Option<Window> {
    has_adapter().then(|| start(LAPTOP, |cc| App::new(cc, None)))
}

/// A tube with eight sides and a lid: 45° between its sides, 90° at the lid, open below. So many rows of triangles.
fn tube(rows: u32) -> Vec<[DVec3; 3]> {
    let at = |k: u32, row: u32| {
        let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 8.0);
        DVec3::new(10.0 * cos, 10.0 * sin, 30.0 * f64::from(row) / f64::from(rows))
    };
    let mut triangles = Vec::new();
    for (k, next) in (0..8).map(|k| (k, (k + 1) % 8)) {
        for row in 0..rows {
            let [a, b, c, d] = [at(k, row), at(next, row), at(next, row + 1), at(k, row + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
        triangles.push([DVec3::new(0.0, 0.0, 30.0), at(k, rows), at(next, rows)]);
    }
    triangles
}

fn stl(folder: &Path, name: &str, triangles: &[[DVec3; 3]]) -> PathBuf {
    let mut bytes = vec![0; 80];
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for t in triangles {
        bytes.extend([0; 12]);
        t.iter().flat_map(|p| p.to_array()).for_each(|x| bytes.extend((x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    let path = folder.join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

fn open(harness: &mut Window, path: &Path) {
    harness.state_mut().apply(Command::Open(Source::named(&path.display().to_string())));
    shown(harness);
}

/// Waits for the picture that the panel asks for.
fn shown(harness: &mut Window) {
    // A click takes a frame, what it asks for another.
    harness.run_steps(4);
    until(harness, "it is shown", |window| {
        window.state().state.run().import.as_ref().is_some_and(|import| !import.is_behind())
    });
}

/// Clicks on Convert, which can be done as soon as the mesh is read as the panel says.
fn convert(harness: &mut Window) {
    shown(harness);
    harness.get_by_label("Convert").click();
}

#[test]
fn a_mesh_is_shown_with_its_features_and_charts_and_converted_as_the_panel_says() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = stl(folder.path(), "tube.stl", &tube(6));
    open(&mut harness, &path);
    for text in ["tube.stl", "20 × 20 × 30", "56 feature edges", "8 edges of the boundary", "9 charts", "104"] {
        harness.get_by_label(text);
    }
    let before = picture(&mut harness, "tube-40");
    // The sides are folded by 45 degrees: beyond 60 only the lid's edge is left.
    type_over(&mut harness, "Feature angle", "60");
    shown(&mut harness);
    harness.get_by_label("8 feature edges");
    assert!(harness.query_by_label("56 feature edges").is_none());
    let after = picture(&mut harness, "tube-60");
    assert!(difference(&before, &after) > 0.02, "{}", difference(&before, &after));
    // That is taken back, and done again.
    harness.state_mut().apply(Command::Undo);
    shown(&mut harness);
    harness.get_by_label("56 feature edges");
    harness.state_mut().apply(Command::Redo);
    shown(&mut harness);
    harness.get_by_label("8 feature edges");
    type_over(&mut harness, "Scale", "0.1");
    harness.get_by_label("2 × 2 × 3");
    convert(&mut harness);
    settle(&mut harness);
    let state = &harness.state().state;
    let run = state.current_run().unwrap();
    assert!(
        run.case.text.contains("feature_angle = 60.0") && run.case.text.contains("scale = 0.1"),
        "{}",
        run.case.text
    );
    assert!(!run.case.text.contains("chart_stretch"), "what is as it is is not said");
    let height = |mesh: &quadfront::core::mesh::Mesh| mesh.nodes().map(|n| mesh.xyz(n).z).fold(0.0, f64::max);
    assert!((height(&state.run().moment.as_ref().unwrap().mesh) - 3.0).abs() < 1e-6);
    // A run that is saved keeps it, and opens without a question.
    let saved = folder.path().join("run.toml");
    quadfront::core::record::run_file::write(&saved, &run).unwrap();
    apply(&mut harness, Command::Open(Source::File(saved)));
    let again = harness.state().state.current_run().unwrap();
    assert_eq!(again.case.text, run.case.text);
    assert!(harness.state().state.run().import.is_none());
}

#[test]
fn triangles_are_converted_as_they_are_and_the_panel_comes_back_as_it_was_left() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    open(&mut harness, &stl(folder.path(), "tube.stl", &tube(4)));
    harness.get_by_label("convert its triangles").click();
    harness.run_steps(2);
    convert(&mut harness);
    settle(&mut harness);
    let triangles = harness.state().state.run().opened.as_ref().unwrap().background.mesh.element_count();
    assert_eq!(triangles, 8 * (2 * 4 + 1));
    harness.state_mut().apply(Command::Import);
    shown(&mut harness);
    let import = harness.state().state.run().import.as_ref().unwrap();
    assert_eq!(import.options.used, Some(MeshUse::Triangles));
    // Leaving the panel leaves the run as it is.
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    let state = &harness.state().state;
    assert!(state.run().import.is_none() && state.run().moment.is_some());
}

#[test]
fn what_was_given_stays_as_it_was_given_in_the_panel_and_beyond() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = stl(folder.path(), "tube.stl", &tube(4));
    let options = ImportOptions {
        feature_angle: Some(61.234_567_8),
        chart_stretch: Some(3.217_592_653),
        chord: Some(0.037_1),
        mesh_size: Some(2e12),
        curvature: Some(0.75),
        ..ImportOptions::default()
    };
    let overrides = Overrides { set: vec![("c".to_owned(), "1.75".to_owned())], ..Overrides::default() };
    // A mesh that is opened by its file is shown first.
    harness.state_mut().apply(Command::OpenWith(Source::File(path), Box::new(overrides)));
    shown(&mut harness);
    harness.state_mut().apply(Command::SetImport(Box::new(options.clone()), Gesture::Done));
    shown(&mut harness);
    for field in ["Feature angle", "Chart stretch", "Edge length", "Chord error", "Border error"] {
        harness.get_by_label(field).focus();
        harness.run_steps(2);
        harness.key_press(Key::Tab);
        harness.run_steps(2);
    }
    assert_eq!(harness.state().state.run().import.as_ref().unwrap().options, options);
    let plain = ImportOptions { mesh_size: None, curvature: None, ..options };
    harness.state_mut().apply(Command::SetImport(Box::new(plain), Gesture::Done));
    shown(&mut harness);
    convert(&mut harness);
    settle(&mut harness);
    assert_eq!(harness.state().state.run().moment.as_ref().unwrap().parameters.c, 1.75);
}

#[test]
fn sizes_are_asked_for_in_the_scaled_unit_and_by_curvature() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    open(&mut harness, &stl(folder.path(), "tube.stl", &tube(6)));
    harness.get_by_label("Size of elements").click();
    harness.run_steps(2);
    harness.get_by_label("finer where it is curved").click();
    harness.run_steps(2);
    type_over(&mut harness, "Edge length", "4");
    type_over(&mut harness, "Chord error", "0.02");
    type_over(&mut harness, "Scale", "0.5");
    shown(&mut harness);
    picture(&mut harness, "sizes");
    let options = harness.state().state.run().import.as_ref().unwrap().options.clone();
    assert_eq!((options.mesh_size, options.curvature, options.scale), (Some(2.0), Some(0.02), Some(0.5)));
    convert(&mut harness);
    settle(&mut harness);
    let text = harness.state().state.current_run().unwrap().case.text;
    assert!(text.contains("chord = 0.02") && text.contains("far = 2.0"), "{text}");
}

#[test]
fn a_mesh_in_the_plane_has_no_charts_until_its_shape_is_wanted() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("square.obj");
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.5 0\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n")
        .unwrap();
    open(&mut harness, &path);
    harness.get_by_label("4 edges of the boundary");
    assert!(harness.query_by_label("1 chart").is_none());
    harness.get_by_label("remesh its shape").click();
    shown(&mut harness);
    harness.get_by_label("1 chart");
    picture(&mut harness, "plane");
}

#[test]
fn what_is_mended_is_told_and_what_cannot_be_read_names_file_and_line() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut triangles = tube(4);
    triangles[3].swap(0, 1);
    triangles.push(triangles[0]);
    open(&mut harness, &stl(folder.path(), "tube.stl", &triangles));
    harness.get_by_label("1 duplicate triangle was removed");
    harness.get_by_label("1 triangle was reversed to match neighbours");
    picture(&mut harness, "mended");
    let broken = folder.path().join("broken.obj");
    std::fs::write(&broken, "v 0 0 0\nv 1 0 x\n").unwrap();
    harness.state_mut().apply(Command::Open(Source::File(broken)));
    until(&mut harness, "it is refused", |window| !window.state().state.view().faults.is_empty());
    let state = &harness.state().state;
    assert!(state.run().import.is_none());
    assert!(
        state.view().faults[0].contains("broken.obj, line 2: Expected a coordinate, found \"x\""),
        "{:?}",
        state.view().faults
    );
}

#[test]
fn reading_and_converting_are_cancelled_and_the_window_goes_on() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    // Large enough that it is not done before anybody can press a button.
    let path = stl(folder.path(), "long.stl", &tube(12_000));
    harness.state_mut().apply(Command::Open(Source::File(path.clone())));
    harness.run_steps(2);
    let import = harness.state().state.run().import.as_ref().unwrap();
    assert!(import.loaded.is_none(), "it is still being read");
    harness.get_by_label("Progress");
    harness.get_by_label("Cancel").click();
    harness.run_steps(2);
    assert!(harness.state().state.run().import.is_none() && harness.state().state.view().faults.is_empty());
    // Shorter: its charts are shown before it can be converted.
    let path = stl(folder.path(), "shorter.stl", &tube(2_000));
    harness.state_mut().apply(Command::Open(Source::File(path)));
    until(&mut harness, "it is read", |window| {
        window.state().state.run().import.as_ref().is_some_and(|import| import.loaded.is_some())
    });
    convert(&mut harness);
    harness.run_steps(3);
    assert!(harness.state().state.run().is_opening());
    harness.get_by_label("Cancel").click();
    let begin = Instant::now();
    until(&mut harness, "it is stopped", |window| !window.state().state.run().is_opening());
    assert!(begin.elapsed() < Duration::from_secs(5), "{:?}", begin.elapsed());
    let state = &harness.state().state;
    assert!(
        state.run().import.is_some() && state.run().opened.is_none() && state.view().faults.is_empty(),
        "{:?}",
        state.view().faults
    );
    assert!(!state.run().is_busy());
    harness.get_by_label("Cancel").click();
    harness.run_steps(2);
    assert!(harness.state().state.run().import.is_none());
}

#[test]
fn how_a_mesh_was_taken_is_kept_and_offered_again() {
    if !has_adapter() {
        return;
    }
    let (folder, kept) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let path = stl(folder.path(), "tube.stl", &tube(4));
    let begin = |folder: &Path| {
        let folder = folder.to_path_buf();
        start(LAPTOP, |cc| App::new(cc, None).keeping(Some(folder)))
    };
    let mut harness = begin(kept.path());
    open(&mut harness, &path);
    type_over(&mut harness, "Feature angle", "60");
    convert(&mut harness);
    settle(&mut harness);
    let text = harness.state().state.current_run().unwrap().case.text;
    harness.run_steps(4);
    drop(harness);
    let mut harness = begin(kept.path());
    until(&mut harness, "it is offered", |window| {
        window.state().state.run().autosave.as_ref().is_some_and(|kept| kept.offer().is_some())
    });
    harness.get_by_label("Recover").click();
    settle(&mut harness);
    assert_eq!(harness.state().state.current_run().unwrap().case.text, text);
    assert!(text.contains("feature_angle = 60.0"), "{text}");
}

#[test]
fn of_many_settings_the_newest_is_shown() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    open(&mut harness, &stl(folder.path(), "tube.stl", &tube(400)));
    for degrees in (10..60).step_by(2) {
        let mut options = harness.state().state.run().import.as_ref().unwrap().options.clone();
        options.feature_angle = Some(f64::from(degrees));
        harness.state_mut().apply(Command::SetImport(Box::new(options), Gesture::Done));
        harness.run_steps(1);
    }
    shown(&mut harness);
    let import = harness.state().state.run().import.as_ref().unwrap();
    assert_eq!(import.shown.as_ref().unwrap().wanted.feature_angle, 58.0_f64.to_radians());
}

#[test]
fn a_mesh_with_an_odd_border_is_converted_once_a_side_of_it_may_be_divided() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    const SWITCH: &str = "divide a side of odd borders";
    for (name, bend) in [("plane", 0.0), ("bent", 0.1)] {
        // One triangle is missing at a corner: the border has an odd count of sides.
        let text = plate(4, bend).trim_end().rsplit_once('\n').unwrap().0.to_owned();
        let path = folder.path().join(format!("{name}.obj"));
        std::fs::write(&path, text).unwrap();
        open(&mut harness, &path);
        if bend > 0.0 {
            assert!(harness.query_by_label(SWITCH).is_none(), "its shape is meshed anew, with any count");
            harness.get_by_label("convert its triangles").click();
            harness.run_steps(2);
        }
        convert(&mut harness);
        until(&mut harness, "it is refused", |window| {
            window.state().state.run().import.as_ref().is_some_and(|import| import.refused.is_some())
        });
        shown(&mut harness);
        // The remedy is in the words of the panel.
        harness.get_by_label_contains(&format!("(below: {SWITCH})."));
        picture(&mut harness, &format!("odd-{name}"));
        harness.get_by_label(SWITCH).click();
        shown(&mut harness);
        assert!(harness.query_by_label("Refused").is_none());
        // The permission is undone and redone.
        let is_given = |harness: &Window| harness.state().state.run().import.as_ref().unwrap().options.split_odd;
        let mut after = vec![is_given(&harness)];
        for command in [Command::Undo, Command::Redo] {
            harness.state_mut().apply(command);
            harness.run_steps(2);
            after.push(is_given(&harness));
        }
        assert_eq!(after, [true, false, true]);
        convert(&mut harness);
        settle(&mut harness);
        let state = &harness.state().state;
        let triangles = state.run().opened.as_ref().unwrap().background.mesh.element_count();
        assert_eq!(triangles, 32, "31 and a half of one that was divided");
        // The run keeps it.
        let run = state.current_run().unwrap();
        assert!(run.case.split_odd && run.case.text.contains("split_odd = true"), "{}", run.case.text);
        let saved = folder.path().join(format!("{name}.toml"));
        quadfront::core::record::run_file::write(&saved, &run).unwrap();
        apply(&mut harness, Command::Open(Source::File(saved)));
        assert!(harness.state().state.current_run().unwrap().case.split_odd);
    }
}

/// A plate of `n` by `n` squares as OBJ, bent up along a parabola.
fn plate(n: usize, bend: f64) -> String {
    let mut text = String::new();
    for (x, y) in (0..(n + 1) * (n + 1)).map(|k| (k % (n + 1), k / (n + 1))) {
        text += &format!("v {x} {y} {}\n", bend * (x * x) as f64);
    }
    for a in (0..n * n).map(|k| k % n + k / n * (n + 1) + 1) {
        text += &format!("f {} {} {}\nf {} {} {}\n", a, a + 1, a + n + 2, a, a + n + 2, a + n + 1);
    }
    text
}

/// How much of a picture has about this colour.
fn share_of(picture: &[u8], [r, g, b]: [u8; 3]) -> f64 {
    let alike = |pixel: &&[u8]| pixel.iter().zip([r, g, b]).all(|(a, b)| a.abs_diff(b) < 24);
    picture.chunks(4).filter(alike).count() as f64 / (picture.len() / 4) as f64
}

/// The colour of errors in the dark palette.
const BROKEN: [u8; 3] = [0xFF, 0x6B, 0x8B];

#[test]
fn a_mesh_that_is_refused_is_shown_with_its_elements_marked_and_looked_at_from_near() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    // A small triangle on top of a plate.
    let mut text = plate(40, 0.0);
    text += "v 30.6 10.1 0\nv 30.9 10.1 0\nv 30.8 10.2 0\nf 1682 1683 1684\n";
    let path = folder.path().join("over.obj");
    std::fs::write(&path, text).unwrap();
    open(&mut harness, &path);
    harness.get_by_label("Refused");
    harness.get_by_label("Triangles 861 and 3201 overlap.");
    harness.get_by_label("Remove the overlap: triangles in the plane must not overlap.");
    harness.get_by_label("Mesh of 3\u{2009}201 triangles, as imported, 2 elements marked");
    let near = picture(&mut harness, "refused");
    assert!(share_of(&near, BROKEN) > 0.0005, "{}", share_of(&near, BROKEN));
    let camera = |harness: &Window| harness.state().state.run().import.as_ref().unwrap().view.camera.unwrap();
    let before = camera(&harness);
    assert!(before.centre.distance(DVec3::new(30.5, 10.5, 0.0)) < 1.0, "{:?}", before.centre);
    // The whole of it is a key away, and there is no way to convert it.
    harness.state_mut().apply(Command::Fit);
    harness.run_steps(3);
    assert!(before.scale > 4.0 * camera(&harness).scale);
    harness.state_mut().apply(Command::Convert);
    harness.run_steps(3);
    let state = &harness.state().state;
    assert!(!state.run().is_opening() && state.view().faults.is_empty(), "{:?}", state.view().faults);
}

#[test]
fn what_a_conversion_is_refused_for_is_marked_until_the_mesh_is_taken_otherwise() {
    let Some(mut harness) = window() else { return };
    let folder = tempfile::tempdir().unwrap();
    // A hole of three sides in a bent plate.
    let text =
        plate(5, 0.1).lines().filter(|line| *line != "f 15 16 22").fold(String::new(), |text, l| text + l + "\n");
    let path = folder.path().join("hole.obj");
    std::fs::write(&path, text).unwrap();
    open(&mut harness, &path);
    assert!(harness.query_by_label("Refused").is_none());
    assert_eq!(share_of(&picture(&mut harness, "hole"), BROKEN), 0.0);
    harness.get_by_label("convert its triangles").click();
    harness.run_steps(2);
    type_over(&mut harness, "Scale", "0.001");
    convert(&mut harness);
    until(&mut harness, "it is refused", |window| {
        window.state().state.run().import.as_ref().is_some_and(|import| import.refused.is_some())
    });
    shown(&mut harness);
    assert!(harness.state().state.view().faults.is_empty(), "it is told in the panel");
    harness.get_by_label("Mesh of 49 triangles, as imported, 3 elements marked");
    assert!(share_of(&picture(&mut harness, "odd"), BROKEN) > 0.001);
    let import = harness.state().state.run().import.as_ref().unwrap();
    // In the unit of the file, whatever it is scaled to.
    let corners: Vec<DVec3> = import.refused.as_ref().unwrap().shapes.concat();
    assert!(corners.iter().all(|p| p.x > 1.9 && p.x < 3.1 && p.y > 1.9 && p.y < 3.1), "{corners:?}");
    let place = &import.refused.as_ref().unwrap().place;
    assert!(place.ends_with("sides of triangles 16, 25 and 27"), "{place}");
    let options = import.options.clone();
    // Taken otherwise it is not refused.
    harness.get_by_label("remesh its shape").click();
    shown(&mut harness);
    assert!(harness.query_by_label("Refused").is_none());
    harness.get_by_label("Mesh of 49 triangles, as imported");
    // Where nothing was asked before, the panel comes to tell it.
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    harness.state_mut().apply(Command::Open(Source::Mesh(path, options)));
    until(&mut harness, "it is refused again", |window| {
        window.state().state.run().import.as_ref().is_some_and(|import| import.refused.is_some() && !import.is_behind())
    });
    harness.get_by_label("Refused");
}

#[test]
fn a_cad_file_is_shown_with_its_faces_and_its_unit_and_converted_in_the_unit_that_is_chosen() {
    let Some(mut harness) = window() else { return };
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/step/bracket.step");
    open(&mut harness, &path);
    for text in ["bracket.step", "Faces on exact surfaces: choose the unit and the sizes.", "The part"] {
        harness.get_by_label(text);
    }
    let facts = |harness: &Window| {
        let loaded = harness.state().state.run().import.as_ref().unwrap().loaded.clone().unwrap();
        let part = loaded.part.as_ref().unwrap();
        (part.faces, part.edges, part.bodies, part.unit.clone(), loaded.extent)
    };
    let (faces, edges, bodies, unit, extent) = facts(&harness);
    assert_eq!((faces, edges, bodies, unit.as_str()), (9, 21, 1, "mm"));
    harness.get_by_label("9 faces");
    picture(&mut harness, "part");
    let mut options = harness.state().state.run().import.as_ref().unwrap().options.clone();
    options.step.unit = quadfront::core::step::Unit::of_word("m");
    harness.state_mut().apply(Command::SetImport(Box::new(options), Gesture::Done));
    shown(&mut harness);
    let (.., unit, smaller) = facts(&harness);
    assert_eq!(unit, "m");
    assert!((smaller * 1000.0 - extent).length() < 1e-6 * extent.length());
    convert(&mut harness);
    settle(&mut harness);
    let run = harness.state().state.current_run().unwrap();
    assert!(run.case.notes.contains("lengths in m."), "{}", run.case.notes);
    assert_eq!(harness.state().state.run().opened.as_ref().unwrap().background.names.faces.len(), 9);
    // A file that is damaged is refused, with its line.
    let folder = tempfile::tempdir().unwrap();
    let damaged = folder.path().join("damaged.stp");
    let text = std::fs::read_to_string(&path).unwrap().replace("CYLINDRICAL_SURFACE", "OFFSET_SURFACE");
    std::fs::write(&damaged, text).unwrap();
    harness.state_mut().apply(Command::Open(Source::named(&damaged.display().to_string())));
    until(&mut harness, "it is refused", |window| !window.state().state.view().faults.is_empty());
    let fault = harness.state().state.view().faults[0].to_string();
    assert!(fault.contains("damaged.stp, line") && fault.contains("OFFSET_SURFACE"), "{fault}");
}
