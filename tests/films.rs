//! Promise: a film has the frames that were asked for, each the figure of its state; the same film has the same bytes;
//! its captions are the narration; and what cannot be a film is told before any work is done.
#![cfg(feature = "window")]
#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use quadfront::core::case::built_in;
use quadfront::core::convert::{Event, Phase};
use quadfront::core::progress::Nobody;
use quadfront::core::run::{History, Run, explain};

/// A conversion of few steps, and small frames.
const COARSE: [&str; 4] = ["example1", "--set", "size_scale=3", "-q"];
const SMALL: [&str; 2] = ["--size", "120x90"];

fn run(words: &[&[&str]], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quadfront")).args(words.concat()).current_dir(folder).output().unwrap()
}

/// Runs what must succeed; the bytes of a file that it writes.
fn made(words: &[&[&str]], folder: &Path, name: &str) -> Vec<u8> {
    let output = run(&[words, &[&["-o", name]]].concat(), folder);
    let err = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{words:?}: {err}");
    std::fs::read(folder.join(name)).unwrap()
}

/// Runs what must be refused with exit 2 and one line.
fn refused(words: &[&[&str]], folder: &Path) -> String {
    let output = run(words, folder);
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{words:?}: {err}");
    err
}

type Pixels = Vec<[u8; 3]>;

/// A picture: its width and its pixels.
#[derive(Clone, PartialEq)]
struct Picture(u32, Pixels);

/// A film: its frames as they are seen, the seconds that each stays, and how often it plays (0: forever).
struct Seen {
    frames: Vec<Picture>,
    seconds: Vec<f64>,
    plays: u32,
}

fn of_gif(bytes: &[u8]) -> Seen {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).unwrap();
    let width = u32::from(decoder.width());
    let mut canvas = vec![[0; 3]; (width * u32::from(decoder.height())) as usize];
    let (mut frames, mut seconds) = (Vec::new(), Vec::new());
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        seconds.push(f64::from(frame.delay) / 100.0);
        for (i, pixel) in frame.buffer.chunks(4).enumerate() {
            let [w, left, top] = [frame.width, frame.left, frame.top].map(u32::from);
            let at = width * (i as u32 / w + top) + i as u32 % w + left;
            if pixel[3] != 0 {
                canvas[at as usize].copy_from_slice(&pixel[..3]);
            }
        }
        frames.push(Picture(width, canvas.clone()));
    }
    let plays = match decoder.repeat() {
        gif::Repeat::Infinite => 0,
        gif::Repeat::Finite(more) => u32::from(more) + 1,
    };
    Seen { frames, seconds, plays }
}

/// The frames of an animated or a plain PNG without transparency.
fn of_png(bytes: &[u8]) -> Seen {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let (width, height) = (reader.info().width, reader.info().height);
    let control = reader.info().animation_control().copied();
    let mut canvas = vec![[0; 3]; (width * height) as usize];
    let (mut frames, mut seconds) = (Vec::new(), Vec::new());
    for _ in 0..control.map_or(1, |control| control.num_frames) {
        let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut buffer).unwrap();
        let part = reader.info().frame_control().copied();
        let [left, top, w, h] = part.map_or([0, 0, width, height], |p| [p.x_offset, p.y_offset, p.width, p.height]);
        for (i, pixel) in buffer.chunks(3).take((w * h) as usize).enumerate() {
            let at = width * (i as u32 / w + top) + i as u32 % w + left;
            canvas[at as usize].copy_from_slice(pixel);
        }
        seconds.extend(part.map(|part| f64::from(part.delay_num) / f64::from(part.delay_den)));
        frames.push(Picture(width, canvas.clone()));
    }
    Seen { frames, seconds, plays: control.map_or(1, |control| control.num_plays) }
}

/// The picture that `render` makes.
fn rendered(words: &[&[&str]], folder: &Path) -> Picture {
    of_png(&made(&[&[&["render"][..]], words].concat(), folder, "one.png")).frames.remove(0)
}

#[test]
fn every_frame_of_an_animated_png_is_the_figure_of_its_step_and_that_of_a_gif_comes_near() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let film =
        ["animate", "--from", "step=10", "--to", "step=75", "--every", "step=30", "--rate", "12.5", "--hold", "1"];
    let looks: [&[&str]; 3] = [
        &["--layers", "+changed,+candidates,+h,+scale", "--loop", "once"],
        &["--ink", "dark", "--part=0.5,0.5,0.7", "--loop", "3"],
        &["--ink", "grey"],
    ];
    for (look, plays) in looks.into_iter().zip([1, 3, 0]) {
        let words = [&film[..], &COARSE, &SMALL, look];
        let apng = of_png(&made(&words, here, "a.apng"));
        let gif = of_gif(&made(&words, here, "a.gif"));
        // The last frame is that of --to, although it is nearer.
        let steps = ["step=10", "step=40", "step=70", "step=75"];
        assert_eq!([apng.frames.len(), gif.frames.len()], [4; 2]);
        for (k, step) in steps.into_iter().enumerate() {
            let look: Vec<&str> = look.iter().copied().take_while(|word| *word != "--loop").collect();
            let figure = rendered(&[&["--at", step], &COARSE, &SMALL, &look], here);
            assert!(apng.frames[k] == figure, "{look:?}, {step}");
            assert_eq!(gif.frames[k].0, figure.0);
            let off = |(a, b): (&[u8; 3], &[u8; 3])| a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
            let offs: Vec<u8> = gif.frames[k].1.iter().zip(&figure.1).map(off).collect();
            assert!(offs.iter().all(|off| *off <= 24), "{look:?}, {step}: {:?}", offs.iter().max());
            let exact = offs.iter().filter(|off| **off == 0).count();
            assert!(exact * 10 > offs.len() * 6, "{look:?}, {step}: areas stay as they are, {exact}");
        }
        for film in [apng, gif] {
            assert_eq!(film.seconds, [0.08, 0.08, 0.08, 1.0]);
            assert_eq!(film.plays, plays);
        }
    }
}

#[test]
fn the_image_of_a_half_is_in_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let disk = "version = 1\nsymmetry = \"y\"\n\
                [[curve]]\nname = \"rim\"\nkind = \"circle\"\ncentre = [0, 0]\nradius = 1\n\
                [[face]]\nname = \"f\"\nouter = [\"rim\"]\n[[metric]]\nkind = \"uniform\"\nh = 0.5\n";
    std::fs::write(here.join("disk.toml"), disk).unwrap();
    let case: &[&str] = &["disk.toml", "-q"];
    let film = of_png(&made(&[&["animate", "--every", "20"], case, &SMALL], here, "a.apng"));
    assert!(film.frames.last() == Some(&rendered(&[case, &SMALL], here)));
}

#[test]
fn frames_by_quadrilaterals_and_by_events_are_those_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let film = |words: &[&str]| of_png(&made(&[&["animate"], &COARSE, &SMALL, words], here, "a.apng")).frames;
    let frames = film(&["--from", "nq=3", "--to", "nq=12", "--every", "4"]);
    let figures = ["nq=3", "nq=7", "nq=11", "nq=12"].map(|at| rendered(&[&["--at", at], &COARSE, &SMALL], here));
    assert!(frames == figures);
    // To the end: the end is a frame, whatever the number of quadrilaterals.
    let frames = film(&["--every", "1000"]);
    let figures = ["nq=0", "end"].map(|at| rendered(&[&["--at", at], &COARSE, &SMALL], here));
    assert!(frames == figures);
    let frames = film(&["--from", "step=5", "--to", "step=9", "--every", "event"]);
    assert_eq!(frames.len(), 5);
    // A figure that carries its run is filmed as it looks.
    made(&[&["render", "--at", "nq=5", "--ink", "dark"], &COARSE, &SMALL], here, "dark.svg");
    let frames = of_png(&made(&[&["animate", "dark.svg", "-q", "--to", "nq=2"]], here, "a.apng")).frames;
    assert_eq!(frames.len(), 3);
    assert!(frames[2] == rendered(&[&["--at", "nq=2", "--ink", "dark"], &COARSE, &SMALL], here));
}

#[test]
fn the_same_film_has_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for name in ["a.gif", "a.apng"] {
        let words = ["animate", "--to", "nq=6", "--camera", "follow", "--captions", "--layers", "+changed"];
        let size = ["--size", "240x320"];
        let film = || made(&[&words, &COARSE, &size], here, name);
        let once = film();
        assert!(once == film(), "{name}");
        // On one thread, too.
        let path = here.join(format!("one-{name}"));
        let mut alone = Command::new(env!("CARGO_BIN_EXE_quadfront"));
        alone.args([&words[..], &COARSE, &size].concat()).arg("-o").arg(&path).env("RAYON_NUM_THREADS", "1");
        assert!(alone.current_dir(here).output().unwrap().status.success());
        assert!(std::fs::read(path).unwrap() == once, "{name}");
    }
}

/// The run of the films, and the narration of each step.
fn narrated(size_scale: &str) -> (History, Vec<String>) {
    let mut run = Run::of(built_in::named("example1").unwrap().unwrap());
    run.parameters.set("size_scale", size_scale).unwrap();
    let mut history = History::open(run, &mut Nobody).unwrap();
    history.seek(u64::MAX).unwrap();
    let mut base = None;
    let mut told = vec!["Nothing is converted yet: the front is the boundary of the mesh.".to_owned()];
    for event in history.events(1, history.step()).unwrap() {
        if let Event::BaseSelected { a, b, .. } = event {
            base = Some([a, b]);
        }
        told.push(explain::plain(&explain::narration(&event, base)));
    }
    (history, told)
}

/// The texts of an SVG, joined.
fn texts(svg: &str) -> String {
    let texts = svg.split("<text ").skip(1).map(|text| text.split_once('>').unwrap().1.split('<').next().unwrap());
    texts.collect::<Vec<_>>().join(" ").replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
}

#[test]
fn captions_are_the_narration_of_the_step_below_the_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let (_, told) = narrated("3");
    let size = ["--size", "360x300"];
    for step in [0, 1, 2, 5, 40] {
        let at = format!("step={step}");
        let words = ["render", "--at", &at, "--captions", "--layers", "live,dead,front"];
        let svg = String::from_utf8(made(&[&words, &COARSE, &size], here, "a.svg")).unwrap();
        assert_eq!(texts(&svg), told[step], "step {step}");
        // The rows stand below each other, above the lower edge, and the mesh ends above them.
        let height: f64 = svg.split("height=\"").nth(1).unwrap().split("pt").next().unwrap().parse().unwrap();
        let rows: Vec<f64> = svg
            .split("<text ")
            .skip(1)
            .map(|text| text.split(" y=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap())
            .collect();
        assert!(rows.is_sorted() && *rows.last().unwrap() < height - 2.0, "{rows:?} of {height}");
        let drawn = svg.split(" d=\"").skip(1).flat_map(|path| {
            let path = path.split('"').next().unwrap();
            let points = path.split(['M', 'L', 'Z', '\n']).filter(|point| !point.is_empty());
            points.map(|point| point.split(' ').nth(1).unwrap().parse::<f64>().unwrap()).collect::<Vec<_>>()
        });
        assert!(drawn.fold(0.0, f64::max) < rows[0] - 8.0, "step {step}: the caption is below the mesh");
    }
    // Of two frames the one with the longer caption is that of `render`; both have the same room for it.
    let rows = |step: usize| {
        let at = format!("step={step}");
        let svg = made(&[&["render", "--at", &at, "--captions", "--layers", "live"], &COARSE, &size], here, "a.svg");
        String::from_utf8(svg).unwrap().matches("<text ").count()
    };
    let step = (1..60).find(|step| rows(*step) != rows(step + 1)).unwrap();
    let longer = if rows(step) > rows(step + 1) { 0 } else { 1 };
    let [from, to] = [step, step + 1].map(|step| format!("step={step}"));
    let words = ["animate", "--from", &from, "--to", &to, "--every", "event", "--captions"];
    let frames = of_png(&made(&[&words, &COARSE, &size], here, "a.apng")).frames;
    let at = format!("step={}", step + longer);
    assert!(frames[longer] == rendered(&[&["--at", &at, "--captions"], &COARSE, &size], here));
    assert!(frames[1 - longer] != rendered(&[&["--at", &at], &COARSE, &size], here));
}

#[test]
fn no_caption_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    // What is drawn of captions alone leaves the edges of the picture free, in every frame.
    let words =
        ["animate", "--every", "step=7", "--to", "nq=14", "--captions", "--layers", "none", "--size", "300x400"];
    let frames = of_png(&made(&[&words, &COARSE], here, "a.apng")).frames;
    assert!(frames.len() > 10);
    for (k, Picture(width, pixels)) in frames.into_iter().enumerate() {
        let width = width as usize;
        let dark: Vec<usize> = (0..pixels.len()).filter(|i| pixels[*i][0] < 128).collect();
        assert!(!dark.is_empty(), "frame {k} has a caption");
        let at_edge = |i: &usize| i % width < 1 || i % width + 1 >= width || i / width + 1 >= pixels.len() / width;
        assert!(!dark.iter().any(at_edge), "frame {k}");
    }
}

#[test]
fn a_camera_that_follows_shows_the_base_of_every_frame() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let (mut history, _) = narrated("1");
    // Base and sides alone are drawn, so a frame without them is empty.
    let film = ["animate", "--from", "step=1", "--to", "step=160", "--every", "step=4", "--layers", "decision,letters"];
    let fine = ["example1", "-q", "--size", "200x150"];
    let words = [&film[..], &["--camera", "follow"], &fine];
    let frames = of_png(&made(&words, here, "a.apng")).frames;
    for (k, Picture(_, pixels)) in frames.iter().enumerate() {
        let step = (1 + 4 * k as u64).min(160);
        history.seek(step).unwrap();
        let has_base = !matches!(history.state().phase(), Phase::Select) && history.state().phase().base().is_some();
        let is_drawn = pixels.iter().any(|pixel| *pixel != [255; 3]);
        assert_eq!(has_base, is_drawn, "step {step}");
    }
    let fixed = of_png(&made(&[&film, &fine], here, "a.apng")).frames;
    let amber = |frames: &[Picture]| -> usize {
        frames.iter().map(|frame| frame.1.iter().filter(|pixel| **pixel != [255; 3]).count()).sum()
    };
    let [near, far] = [amber(&frames), amber(&fixed)];
    assert!(4 * near > 5 * far, "it is seen from nearer: {near}, {far}");
}

#[test]
fn surfaces_are_filmed_in_space_and_in_their_parametric_plane() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let coarse = ["two-faces", "--set", "size_scale=2", "-q"];
    for look in [&["--view=-30,30"][..], &["--parametric"]] {
        let words = ["animate", "--from", "nq=2", "--to", "nq=4"];
        let frames = of_png(&made(&[&words, &coarse, &SMALL, look], here, "a.apng")).frames;
        assert!(frames.len() == 3 && frames[0] != frames[2]);
        assert!(frames[0] == rendered(&[&["--at", "nq=2"], &coarse, &SMALL, look], here), "{look:?}");
        let words = [&words[..], &["--camera", "follow"], &coarse, &SMALL, look];
        assert!(of_png(&made(&words, here, "a.apng")).frames != frames);
    }
}

#[test]
fn what_cannot_be_a_film_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for (words, told) in [
        (&["-o", "a.mp4"][..], ".gif or .apng"),
        (&["-o", "a"], ".gif or .apng"),
        (&["-o", "-"], ".gif or .apng"),
        (&["-o", "no/a.gif"], "does not exist"),
        (&["--from", "nq=9", "--to", "nq=4", "-o", "a.gif"], "ends where it begins"),
        (&["--from", "nq=9", "--to", "nq=9", "-o", "a.gif"], "ends where it begins"),
        (&["--from", "step=90", "--to", "nq=1", "-o", "a.gif"], "ends where it begins"),
        (&["--from", "nq=99999", "-o", "a.gif"], "before the stop"),
        (&["--to", "step=99999", "-o", "a.gif"], "before the stop"),
        (&["--plot", "angles", "-o", "a.gif"], "no histogram"),
        (&["--transparent", "-o", "a.gif"], "transparent"),
        (&["--camera", "follow", "--part=0,0,1", "-o", "a.gif"], "chooses the part"),
        (&["--size", "9000x9000", "-o", "a.gif"], "too large"),
        (&["--captions", "--size", "160x100", "-o", "a.gif"], "too little room"),
        (&["--every", "0", "-o", "a.gif"], "quad or event"),
        (&["--rate", "0", "-o", "a.gif"], "from 0.1 to 50"),
        (&["--loop", "0", "-o", "a.gif"], "forever, once"),
        (&["--hold", "-1", "-o", "a.gif"], "unexpected argument"),
        (&["--from", "end", "-o", "a.gif"], "nq=100"),
    ] {
        let err = refused(&[&["animate"], &COARSE, words], here);
        assert!(err.contains(told), "{words:?}: {err}");
        assert_eq!(std::fs::read_dir(here).unwrap().count(), 0, "{words:?}");
    }
    let err = refused(&[&["render", "--at", "nq=5", "--captions", "--size", "90x60", "-o", "a.svg"], &COARSE], here);
    assert!(err.contains("too little room"), "{err}");
    let err = refused(&[&["render", "--at", "nq=1,2", "--captions", "-o", "a.svg"], &COARSE], here);
    assert!(err.contains("one state"), "{err}");
}

#[cfg(unix)]
#[test]
fn a_film_that_is_stopped_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let words = ["animate", "example1", "-q", "--every", "event", "--size", "900x900", "-o", "a.gif"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_quadfront"));
    let child = child.args(words).current_dir(here).stderr(Stdio::piped()).spawn().unwrap();
    let begun = || std::fs::read_dir(here).unwrap().count() > 0;
    let waited = (0..600).find(|_| {
        std::thread::sleep(Duration::from_millis(100));
        begun()
    });
    assert!(waited.is_some(), "the temporary file appears");
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr), (Some(130), Vec::new()));
    assert!(!begun(), "nothing is left");
}
