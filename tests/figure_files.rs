//! Promise: a figure carries its run. What it shows is had from it again, to the same bytes; sizes are what was asked
//! for; and a figure that somebody has tampered with is told and never a crash.
#![allow(clippy::unwrap_used)]

#[path = "common/environment.rs"]
mod environment;
#[path = "common/xor_shift.rs"]
mod xor_shift;

use std::path::Path;
use std::process::{Command, Output};

use quadfront::core::case::built_in;
use quadfront::core::convert::EventKind;
use quadfront::core::progress::Nobody;
use quadfront::core::record::{figure, run_file};
use quadfront::core::run::{History, Run, explain};
use xor_shift::XorShift;

fn run(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quadfront")).args(arguments).current_dir(folder).output().unwrap()
}

/// Runs what must succeed; what it says on standard error.
fn done(arguments: &[&str], folder: &Path) -> String {
    let output = run(arguments, folder);
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {err}");
    err
}

/// Runs what must be refused with exit 2 and one line.
fn refused(arguments: &[&str], folder: &Path) -> String {
    let output = run(arguments, folder);
    let err = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {err}");
    assert!(err.starts_with("error: ") && err.lines().count() == 1, "{arguments:?}: {err}");
    err
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

const COARSE: &str = "size_scale=2";

#[test]
fn a_figure_is_drawn_again_from_itself_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for options in [
        "--at nq=20",
        "--at step=90 --ink grey --layers +changed,+nodes,-letters --size 60x40mm",
        "--strip nq=5,20,end --columns 2 --transparent",
        "--at nq=20 --layers +candidates",
        "--at nq=20 --part 0.5,0.5,0.4 --size 300x200 --layers +h,+angles,+ellipses,+scale",
        "--plot lengths --ink grey",
        "--at nq=20 --size 300x200 --line-scale 1.5 --font-size 9",
        "--at nq=20 --plot angles",
        "",
    ] {
        let words: Vec<&str> = options.split_whitespace().collect();
        let start = ["render", "example1", "--set", COARSE, "--set", "c=1.8", "-q", "-o", "a.svg"];
        done(&[&start[..], &words].concat(), here);
        assert_eq!(done(&["render", "a.svg", "-q", "-o", "b.svg"], here), "", "the same state is no news");
        assert!(read(here, "a.svg") == read(here, "b.svg"), "{options}");
        let run = run_file::parse(&figure::text_in(&read(here, "a.svg")).unwrap(), "", here).unwrap();
        assert_eq!(run.parameters.c, 1.8);
        // What is asked for now goes before what the figure says.
        done(&["render", "a.svg", "-q", "--dpi", "72", "-o", "c.svg"], here);
        assert_eq!(done(&["render", "c.svg", "-q", "-o", "d.svg"], here), "");
        assert!(read(here, "c.svg") == read(here, "d.svg"), "{options}");
    }
}

/// The values of an attribute that are numbers, of the elements of an SVG with this name.
fn numbers(svg: &str, element: &str, attribute: &str) -> Vec<f64> {
    let (begin, name) = (format!("<{element} "), format!(" {attribute}=\""));
    let elements = svg.split(&begin).skip(1).map(|rest| rest.split_once('>').unwrap().0);
    let values = elements.filter_map(|text| text.split_once(&name)?.1.split('"').next());
    values.map(|value| value.parse().unwrap()).collect()
}

/// The boxes of the plates of labels: their low and high corners.
fn plates(svg: &str) -> Vec<[f64; 4]> {
    let rectangles = svg.split("<rect ").skip(1).map(|rest| rest.split_once('>').unwrap().0);
    let number = |text: &str, name: &str| -> f64 {
        let text = format!(" {text}");
        text.split_once(&format!(" {name}=\"")).unwrap().1.split('"').next().unwrap().parse().unwrap()
    };
    let plates = rectangles.filter(|text| text.contains("fill-opacity"));
    plates
        .map(|text| {
            let [x, y, w, h] = ["x", "y", "width", "height"].map(|name| number(text, name));
            [x, y, x + w, y + h]
        })
        .collect()
}

#[test]
fn lines_and_text_have_the_weights_of_paper_or_of_a_screen() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let drawn = |case: &str, options: &str| {
        let words: Vec<&str> = options.split_whitespace().collect();
        done(&[&["render", case, "-q", "-o", "a.svg"][..], &words].concat(), here);
        String::from_utf8(read(here, "a.svg")).unwrap()
    };
    let within = |numbers: &[f64], [least, most]: [f64; 2]| {
        assert!(numbers.len() > 3 && numbers.iter().all(|n| (least..=most).contains(n)), "{numbers:?}");
    };
    // A point is 4/3 pixels; the base is the widest line.
    for (options, lines, text) in [
        ("--size 84mm", [0.25, 0.75], [6.0, 7.0]),
        ("--size 174mm --ink grey", [0.25, 0.75], [6.0, 7.0]),
        ("--size 700x600", [0.75, 2.25], [9.0, 10.5]),
        ("--size 700x600 --dpi 72", [1.0, 3.0], [12.0, 14.0]),
        ("--size 700x600 --dpi 400", [0.25, 0.75], [6.0, 7.0]),
        ("--size 84mm --line-scale 2 --font-size 9", [0.5, 1.5], [9.0, 10.5]),
        ("--size 700x600 --line-scale 0.5 --font-size 16", [0.375, 1.125], [12.0, 14.0]),
    ] {
        let svg = drawn("figure-14", &format!("--at step=3 --layers=+h,+angles,+scale {options}"));
        let widths = numbers(&svg, "path", "stroke-width");
        within(&widths, lines);
        for bound in lines {
            assert!(widths.contains(&bound), "{options}: {bound} in {widths:?}");
        }
        let sizes = numbers(&svg, "text", "font-size");
        within(&sizes, text);
        assert!(sizes.contains(&text[0]) && sizes.contains(&text[1]), "{options}: {sizes:?}");
        let plates = plates(&svg);
        for (k, a) in plates.iter().enumerate() {
            let covers = |b: &[f64; 4]| a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
            assert!(!plates[k + 1..].iter().any(covers), "{options}: a plate covers another one");
        }
        assert!(plates.len() > 1, "{options}: {} plates", plates.len());
    }
    // Only edges so close to each other that they would merge are thinner: on paper at less than 0.4 pt.
    let crowded = drawn("example1", "--at nq=50 --size 20mm");
    assert!(numbers(&crowded, "path", "stroke-width").contains(&0.12), "{crowded}");
    let screen = drawn("example1", "--at nq=50 --size 1600x1600");
    within(&numbers(&screen, "path", "stroke-width"), [0.75, 2.25]);
    for (options, size) in [("", 6.0), ("--size 640x480", 9.0), ("--size 640x480 --font-size 20", 15.0)] {
        for plot in ["lengths", "angles"] {
            let svg = drawn("example1", &format!("--set {COARSE} --at nq=20 --plot {plot} {options}"));
            assert_eq!(numbers(&svg, "text", "font-size").into_iter().reduce(f64::min), Some(size), "{options}");
        }
    }
}

#[test]
fn candidates_that_were_refused_are_dotted_with_their_reasons_where_a_side_was_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    let mut run = Run::of(built_in::named("example1").unwrap().unwrap());
    run.parameters.set("size_scale", "2").unwrap();
    let mut history = History::open(run, &mut Nobody).unwrap();
    history.seek(u64::MAX).unwrap();
    let is_swap = |kind| kind == EventKind::SideSwapped;
    let step = history.log().next_of(0, is_swap).unwrap();
    history.seek(step - 1).unwrap();
    let tried = history.state().candidates().unwrap();
    history.seek(step).unwrap();
    let (mesh, base) = (&history.state().mesh, *history.state().phase().base().unwrap());
    let from = [base.a, base.b][tried.side.index()];
    let on_front = |n| mesh.front_between(from, n).or(mesh.front_between(n, from)).is_some();
    let others = tried.edges.iter().filter(|edge| edge.passed.is_some() && !on_front(edge.node));
    let reasons: Vec<String> =
        others.map(|edge| explain::plain(&explain::passed(edge.passed.unwrap(), edge, &tried))).collect();
    assert!(reasons.len() > 1, "{reasons:?}");
    let centre = 0.5 * (mesh.uv(base.a) + mesh.uv(base.b));
    let part = format!("{},{},{}", centre.x, centre.y, 4.0 * mesh.uv(base.a).distance(mesh.uv(base.b)));
    let at = format!("step={step}");
    let svg = |layers: &str, at: &str, part: &str| {
        let asked = ["render", "example1", "--set", COARSE, "--at", at, "--part", part, "--layers", layers];
        done(&[&asked[..], &["-q", "-o", "a.svg"]].concat(), here);
        String::from_utf8(read(here, "a.svg")).unwrap()
    };
    const DOTTED: &str = "stroke-dasharray=\"0.4 1.2\"";
    let drawn = svg("+candidates", &at, &part);
    assert_eq!(drawn.matches(DOTTED).count(), 1, "one path for all of them");
    let path = drawn.split(DOTTED).nth(1).unwrap().split_once(" d=\"").unwrap().1.split('"').next().unwrap();
    assert_eq!(path.matches('M').count(), reasons.len(), "{path}");
    let told = reasons.iter().filter(|reason| drawn.contains(reason.as_str())).count();
    assert!(told > 0, "{reasons:?}");
    assert!(!svg("+changed", &at, &part).contains(DOTTED), "they are drawn where they are asked for");
    // The step that follows chooses no side.
    let next = (step + 1..).find(|step| history.log().kind(*step) == Some(EventKind::Formed)).unwrap();
    assert!(!svg("+candidates", &format!("step={next}"), &part).contains(DOTTED));
    let output = crate::run(&["render", "example1", "-q", "-o", "a.svg", "--layers", "+candidate"], here);
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && err.contains("decision, candidates, letters"), "{err}");
    // On surfaces they are drawn too.
    let surface = Run::of(built_in::named("two-faces").unwrap().unwrap());
    let mut history = History::open(surface, &mut Nobody).unwrap();
    history.extend(2000);
    let step = history.log().next_of(0, |kind| kind == EventKind::SideChosen).unwrap();
    let at = format!("step={step}");
    done(&["render", "two-faces", "--at", &at, "--layers", "+candidates", "-q", "-o", "a.svg"], here);
    history.seek(step - 1).unwrap();
    let told = history.state().candidates().unwrap().edges.len();
    assert_eq!(String::from_utf8(read(here, "a.svg")).unwrap().contains(DOTTED), told > 1, "{told}");
}

#[cfg(feature = "window")]
#[test]
fn pixels_carry_the_run_as_vectors_do() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(&["render", "example1", "--set", COARSE, "--at", "nq=20", "-q", "-o", "a.svg"], here);
    done(&["render", "a.svg", "-q", "-o", "a.png"], here);
    done(&["render", "a.png", "-q", "-o", "b.svg"], here);
    done(&["render", "a.png", "-q", "-o", "b.png"], here);
    assert!(read(here, "a.svg") == read(here, "b.svg"));
    assert!(read(here, "a.png") == read(here, "b.png"));
}

/// Width, height and dots a metre of a PNG, read from its chunks by hand.
#[cfg(feature = "window")]
fn head_of_png(bytes: &[u8]) -> (u32, u32, u32, u8) {
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    assert_eq!(&bytes[12..16], b"IHDR");
    let dots = bytes.windows(4).position(|four| four == b"pHYs").unwrap() + 4;
    assert_eq!((number(dots), bytes[dots + 8]), (number(dots + 4), 1), "square, in metres");
    // The kind of colour: 2 is RGB, 6 with transparency.
    (number(16), number(20), number(dots), bytes[25])
}

#[cfg(feature = "window")]
#[test]
fn sizes_in_millimetres_and_pixels_are_what_was_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for (options, expected) in [
        // 84 mm at 300 dots an inch are 992.1 pixels; 300 dots an inch are 11811 a metre.
        ("", (992, 992, 11811, 2)),
        ("--size 84mm --dpi 600", (1984, 1984, 23622, 2)),
        ("--size 84x60mm", (992, 709, 11811, 2)),
        ("--size 640x480", (640, 480, 3780, 2)),
        ("--size 640x480 --dpi 300 --transparent", (640, 480, 11811, 6)),
        ("--size 174mm --dpi 72 --ink grey", (493, 493, 2835, 2)),
    ] {
        let words: Vec<&str> = options.split_whitespace().collect();
        done(&[&["render", "uniform", "-q", "-o", "a.png"][..], &words].concat(), here);
        assert_eq!(head_of_png(&read(here, "a.png")), expected, "{options}");
    }
    done(&["render", "uniform", "-q", "-o", "a.svg", "--size", "84x60mm"], here);
    let svg = String::from_utf8(read(here, "a.svg")).unwrap();
    assert!(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"238.11pt\" height=\"170.079pt\""));
    let told = refused(&["render", "uniform", "-o", "a.png", "--size", "2000mm", "--dpi", "2400"], here);
    assert!(told.contains("too many"), "{told}");
}

#[test]
fn a_figure_converts_to_the_state_that_it_shows_and_to_the_end_when_asked() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(&["render", "example1", "--set", COARSE, "--at", "nq=20", "-q", "-o", "a.svg"], here);
    done(&["convert", "a.svg", "-q", "-o", "shown.vtu"], here);
    done(&["convert", "example1", "--set", COARSE, "--at", "nq=20", "-q", "-o", "there.vtu"], here);
    assert!(read(here, "shown.vtu") == read(here, "there.vtu"));
    done(&["convert", "a.svg", "--at", "end", "-q", "-o", "end.vtu"], here);
    done(&["convert", "example1", "--set", COARSE, "-q", "-o", "all.vtu"], here);
    assert!(read(here, "end.vtu") == read(here, "all.vtu"));
    // Pictures beside a conversion carry their run too.
    done(&["convert", "example1", "--set", COARSE, "-q", "--picture", "b.svg"], here);
    done(&["render", "b.svg", "-q", "-o", "c.svg"], here);
    assert!(read(here, "b.svg") == read(here, "c.svg"));
    done(&["background", "example1", "--set", COARSE, "-q", "--picture", "b.svg"], here);
    done(&["render", "b.svg", "-q", "-o", "c.svg"], here);
    assert!(read(here, "b.svg") == read(here, "c.svg"));
}

#[test]
fn another_state_than_the_one_shown_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(&["render", "example1", "--set", COARSE, "--at", "nq=20", "-q", "-o", "a.svg"], here);
    let svg = String::from_utf8(read(here, "a.svg")).unwrap();
    let at = svg.find("fingerprint = \"").unwrap() + 15;
    let other = format!("{}{}{}", &svg[..at], "0".repeat(32), &svg[at + 32..]);
    std::fs::write(here.join("old.svg"), other).unwrap();
    let told = done(&["render", "old.svg", "-q", "-o", "b.svg"], here);
    assert!(told.contains("old.svg: ") && told.contains("another state at step"), "{told}");
    assert!(done(&["convert", "old.svg", "-q", "-o", "b.msh"], here).contains("another state"));
    // With other parameters it is another run.
    assert!(done(&["render", "a.svg", "--set", "c=1.1", "-q", "-o", "b.svg"], here).contains("another state"));
    assert_eq!(done(&["render", "a.svg", "--at", "nq=10", "-q", "-o", "b.svg"], here), "", "this is asked for");
}

#[test]
fn an_external_mesh_is_named_by_path_and_must_be_as_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(&["background", "uniform", "--set", "size_scale=3", "-q", "-o", "plate.mesh"], here);
    done(&["render", "plate.mesh", "--at", "nq=3", "-q", "-o", "a.svg"], here);
    let svg = String::from_utf8(read(here, "a.svg")).unwrap();
    assert!(svg.contains("plate.mesh\", fingerprint = \"") && svg.contains("plate.sol\", fingerprint = \""));
    done(&["render", "a.svg", "-q", "-o", "b.svg"], here);
    assert!(svg.as_bytes() == read(here, "b.svg"));
    let mut mesh = read(here, "plate.mesh");
    mesh.push(b'\n');
    std::fs::write(here.join("plate.mesh"), mesh).unwrap();
    assert!(refused(&["render", "a.svg", "-o", "b.svg"], here).contains("has changed"));
    std::fs::remove_file(here.join("plate.mesh")).unwrap();
    assert!(refused(&["render", "a.svg", "-o", "b.svg"], here).contains("No such file"));
}

#[test]
fn figures_that_were_tampered_with_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done(&["render", "uniform", "--set", "size_scale=4", "--at", "step=5", "-q", "-o", "a.svg"], here);
    let svg = String::from_utf8(read(here, "a.svg")).unwrap();
    let state = &svg[svg.find("{ step = 5").unwrap()..svg.find("</quadfront:run>").unwrap()];
    let nested = format!("drawn = {}1{}\nstate", "[".repeat(200_000), "]".repeat(200_000));
    let case_in_case = svg.replace("text = '''", &format!("text = '''\n[[{}", "a.".repeat(50_000)));
    let many = format!("state = [{}]\n</quadfront:run>", "{ step = 1, fingerprint = \"\" },".repeat(5000));
    for (what, text, words) in [
        ("none", "<svg xmlns=\"http://www.w3.org/2000/svg\"/>".to_owned(), "contains no run"),
        ("empty", String::new(), "contains no run"),
        ("cut off", svg[..svg.find("[figure]").unwrap()].to_owned(), "damaged"),
        ("no figure", svg.replace("[figure]", "[figures]"), "figures"),
        ("no states", svg.replace(state, "]\n"), "1 to 1000 states"),
        ("many states", svg.replace(&svg[svg.find("state = [").unwrap()..svg.find("<rect").unwrap()], &many), "states"),
        ("far", svg.replace("{ step = 5", "{ step = 4000000000"), "ends after step"),
        ("farther", svg.replace("{ step = 5", "{ step = 99999999999999999999"), "step"),
        ("negative", svg.replace("{ step = 5", "{ step = -5"), "step"),
        ("option", svg.replace("[figure]", "[figure]\ndrawn = [\"--out=/etc/passwd\"]"), "invalid drawing options"),
        ("size", svg.replace("[figure]", "[figure]\ndrawn = [\"--size=9999999999x1\"]"), "invalid drawing options"),
        ("help", svg.replace("[figure]", "[figure]\ndrawn = [\"--help\"]"), "invalid drawing options"),
        ("nested", svg.replacen("state", &nested, 1), ""),
        ("case", case_in_case, ""),
        ("entity", svg.replace("[figure]", "&bomb;[figure]"), "damaged"),
        ("huge", svg.replace("[figure]", &format!("# {}\n[figure]", "x".repeat(17 << 20))), "too long"),
        ("huge quads", svg.replace("size_scale = 4", "size_scale = 1e-9"), ""),
    ] {
        std::fs::write(here.join("bad.svg"), text).unwrap();
        let told = refused(&["render", "bad.svg", "-o", "b.svg"], here);
        assert!(told.contains(words) && told.contains("bad.svg") && told.len() < 2000, "{what}: {told}");
    }
    std::fs::write(here.join("bad.png"), b"\x89PNG\r\n\x1a\n\xff\xff\xff\xffiTXtquadfront run\0").unwrap();
    assert!(refused(&["render", "bad.png", "-o", "b.svg"], here).contains("damaged"));
    assert!(refused(&["render", "nothing.png", "-o", "b.svg"], here).contains("nothing.png"));
}

/// What is changed at random must be a fault or a run, and never a panic.
#[test]
fn figures_with_bytes_changed_at_random_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    done(&["render", "figure-14", "--at", "step=3", "--layers", "+h", "-q", "-o", "a.svg"], folder.path());
    let whole = read(folder.path(), "a.svg");
    // Paths after the run do not matter here.
    let whole = &whole[..whole.windows(5).position(|w| w == b"<path").unwrap()];
    let text = figure::text_in(whole).unwrap();
    let mut source = XorShift::of(1);
    let mut random = |below: usize| source.below(below);
    let rounds = environment::number("QUADFRONT_SOAK_ROUNDS").unwrap_or(3000);
    let mut read = 0;
    for _ in 0..rounds {
        let mut bytes = text.clone().into_bytes();
        for _ in 0..=random(4) {
            if bytes.len() < 2 {
                break;
            }
            let at = random(bytes.len());
            match random(4) {
                0 => bytes[at] = b"0123456789-.[]{}='\"\n&<>e"[random(24)],
                1 => drop(bytes.remove(at)),
                2 => bytes.truncate(at.max(1)),
                _ => {
                    let end = (at + random(40)).min(bytes.len());
                    let piece = bytes[at..end].to_vec();
                    let to = random(bytes.len());
                    bytes.splice(to..to, piece);
                }
            }
        }
        let changed = String::from_utf8_lossy(&bytes).into_owned();
        let svg = format!("<svg>{}</svg>", figure::metadata(&changed));
        if let Ok(found) = figure::text_in(svg.as_bytes())
            && let Ok(run) = run_file::parse(&found, "a", Path::new(""))
        {
            read += 1;
            // What was read can be written and read again.
            let again = run_file::embedded(&run).unwrap();
            assert_eq!(run_file::embedded(&run_file::parse(&again, "a", Path::new("")).unwrap()).unwrap(), again);
        }
    }
    assert!(read > rounds / 100, "some are still runs: {read}");
}
