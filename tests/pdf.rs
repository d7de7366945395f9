//! Promise: a figure as PDF is the figure as PNG: two readers of PDF open it without a warning and show the same, on
//! paper of the size that was asked for; its text can be selected; it carries its run, also when another program has
//! written it anew; and what is damaged is told and never a crash.
//!
//! The readers are those of poppler and of mupdf. Where they are missing, tests that need them do nothing; where
//! `QUADFRONT_NEEDS_READERS` is set, as by `make test`, that is a failure.
#![cfg(feature = "window")]
#![allow(clippy::unwrap_used)]

#[path = "common/environment.rs"]
mod environment;
#[path = "common/xor_shift.rs"]
mod xor_shift;

use std::path::Path;
use std::process::{Command, Output};

use quadfront::core::record::figure;
use xor_shift::XorShift;

fn run(words: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_quadfront")).args(words).current_dir(folder).output().unwrap()
}

/// Runs what must succeed, without a word.
fn done(line: &str, folder: &Path) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let output = run(&words, folder);
    let err = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(0) && err.is_empty(), "{line}: {err}");
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

/// Runs a reader of PDF, which must say nothing on standard error. Its standard output; `None` where it is missing.
fn reader(words: &[&str], folder: &Path) -> Option<String> {
    match Command::new(words[0]).args(&words[1..]).current_dir(folder).output() {
        Ok(output) => {
            let err = String::from_utf8_lossy(&output.stderr);
            // This is about the reader, which is built so by Debian, and not about the file.
            let err = err.replace("warning: ICC support is not available\n", "");
            assert!(output.status.success() && err.is_empty(), "{words:?}: {err}");
            Some(String::from_utf8_lossy(&output.stdout).into_owned())
        }
        Err(error) => {
            assert!(std::env::var_os("QUADFRONT_NEEDS_READERS").is_none(), "{}: {error}", words[0]);
            eprintln!("{} is missing: nothing was tested", words[0]);
            None
        }
    }
}

/// Figures that have, together, everything that can be drawn; `@` is the name of the file.
const FIGURES: [&str; 13] = [
    "render example1 --set size_scale=2 --at nq=20 -o @",
    "render figure-16 --at step=3 --ink grey --layers +changed,+nodes --size 60x40mm -o @",
    "render example1 --set size_scale=2 --strip nq=5,20,end --columns 2 -o @",
    "render figure-14 --at step=3 --part 0.5,0.5,1 --size 300x200 --layers +h,+angles,+ellipses,+scale -o @",
    "render example1 --at step=3 --layers=+candidates --part=0.5,0.7,0.1 -o @",
    "render figure-14 --at step=3 --layers=+h,+angles,+scale --captions --ink dark -o @",
    "render example1 --set size_scale=2 --at nq=20 --plot lengths --ink grey -o @",
    "render example1 --set size_scale=2 --at nq=20 --plot angles --size 640x480 -o @",
    "render example5 --set size_scale=2 --at nq=60 --view=-60,20 --hidden faint -o @",
    "render two-faces --parametric --size 120mm -o @",
    "render example1 --set size_scale=2 --strip nq=5,20 --part 0.5,0.5,0.4 -o @",
    "convert example1 --set size_scale=2 --picture @",
    "sweep uniform --set size_scale=3 --over c=1:2:.5 --over faces=plate,nothing -o @",
];

/// Draws a figure to a file.
fn drawn(figure: &str, name: &str, folder: &Path) {
    done(&format!("{} -q", figure.replace('@', name)), folder);
}

/// Pixels as red, green and blue, with their width.
struct Pixels {
    width: usize,
    rgb: Vec<[u8; 3]>,
}

fn pixels(bytes: &[u8]) -> Pixels {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().unwrap();
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut data).unwrap();
    let rgb = match info.color_type {
        png::ColorType::Rgb => data[..info.buffer_size()].chunks(3).map(|p| [p[0], p[1], p[2]]).collect(),
        png::ColorType::Grayscale => data[..info.buffer_size()].iter().map(|&p| [p; 3]).collect(),
        other => panic!("{other:?}"),
    };
    Pixels { width: info.width as usize, rgb }
}

impl Pixels {
    /// The mean over squares of pixels, of each colour.
    fn means(&self, side: usize) -> Vec<[f64; 3]> {
        let (columns, rows) = (self.width / side, self.rgb.len() / self.width / side);
        let square = |k: usize| {
            let (x, y) = (k % columns * side, k / columns * side);
            let all = (0..side * side).map(|i| self.rgb[(y + i / side) * self.width + x + i % side]);
            let sum = all.fold([0.0; 3], |sum: [f64; 3], p| std::array::from_fn(|c| sum[c] + f64::from(p[c])));
            sum.map(|sum| sum / (side * side) as f64)
        };
        (0..columns * rows).map(square).collect()
    }
}

/// How far two pictures are apart: the mean over all pixels, and the greatest of the means over squares of 8 pixels;
/// of 255.
fn apart(a: &Pixels, b: &Pixels) -> [f64; 2] {
    assert_eq!((a.width, a.rgb.len()), (b.width, b.rgb.len()), "pixels");
    let of = |p: &[u8; 3], q: &[u8; 3]| (0..3).map(|c| f64::from(p[c].abs_diff(q[c]))).sum::<f64>() / 3.0;
    let mean = a.rgb.iter().zip(&b.rgb).map(|(p, q)| of(p, q)).sum::<f64>() / a.rgb.len() as f64;
    let squares = a.means(8).into_iter().zip(b.means(8));
    let greatest = squares.map(|(p, q)| (0..3).map(|c| (p[c] - q[c]).abs()).fold(0.0, f64::max)).fold(0.0, f64::max);
    [mean, greatest]
}

#[test]
fn two_readers_open_a_pdf_without_a_warning_and_show_what_the_png_shows() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for figure in FIGURES {
        drawn(figure, "a.pdf", here);
        drawn(figure, "a.png", here);
        let ours = pixels(&read(here, "a.png"));
        // In as many pixels: a page is not a whole number of them.
        let [width, height] = [ours.width, ours.rgb.len() / ours.width].map(|pixels| pixels.to_string());
        let (w, h) = (width.as_str(), height.as_str());
        let poppler = ["pdftoppm", "-png", "-scale-to-x", w, "-scale-to-y", h, "-singlefile", "a.pdf", "poppler"];
        let mupdf = ["mutool", "draw", "-q", "-w", w, "-h", h, "-f", "-o", "mupdf.png", "a.pdf"];
        if reader(&poppler, here).is_none() || reader(&mupdf, here).is_none() {
            return;
        }
        for name in ["poppler", "mupdf"] {
            let theirs = pixels(&read(here, &format!("{name}.png")));
            let [mean, greatest] = apart(&ours, &theirs);
            println!("{name} {mean:.2} {greatest:.1} {figure}");
            assert!(mean < 4.5 && greatest < 40.0, "{figure}, {name}: {mean:.2}, {greatest:.1}");
        }
    }
}

#[test]
fn text_can_be_selected_in_a_subset_of_the_font_on_a_page_of_true_size() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done("render example1 --set size_scale=2 --strip nq=5,20,end --size 84x60mm -q -o strip.pdf", here);
    let Some(text) = reader(&["pdftotext", "-layout", "strip.pdf", "-"], here) else { return };
    for label in ["(a) NQ = 5", "(b) NQ = 20", "(c) end"] {
        assert!(text.contains(label), "{label}: {text}");
    }
    let info = reader(&["pdfinfo", "strip.pdf"], here).unwrap();
    let field = |name: &str| info.lines().find_map(|line| line.strip_prefix(name)).unwrap_or("").trim();
    // 84 mm are 238.110 pt, 60 mm are 170.079 pt.
    assert!(field("Page size:").starts_with("238.11 x 170.079 pts"), "{info}");
    assert_eq!(field("Pages:"), "1");
    assert!(field("Title:").starts_with("Example 1"), "{info}");
    assert_eq!(field("Creator:"), concat!("quadfront ", env!("CARGO_PKG_VERSION")));
    assert!(!info.contains("Date"), "a date is another one each day: {info}");
    let fonts = reader(&["pdffonts", "strip.pdf"], here).unwrap();
    let rows: Vec<&str> = fonts.lines().skip(2).collect();
    assert_eq!(rows.len(), 1, "{fonts}");
    // Name with the tag of a subset, type, encoding; embedded, subset, with the characters of its glyphs.
    let name = rows[0].split_whitespace().next().unwrap();
    let (tag, font) = name.split_once('+').unwrap();
    assert!(tag.len() == 6 && font.contains("Quadfront"), "{fonts}");
    let words: Vec<&str> = rows[0].split_whitespace().collect();
    let at = words.iter().position(|word| *word == "yes").unwrap();
    assert_eq!(words[at..at + 3], ["yes", "yes", "yes"], "{fonts}");
    // Text that runs upward, and characters beyond ASCII.
    done("render example1 --set size_scale=2 --at nq=20 --plot lengths -q -o plot.pdf", here);
    let text = reader(&["pdftotext", "plot.pdf", "-"], here).unwrap();
    for label in ["proportion of edges", "length of edge in the metric", " \u{b1} "] {
        assert!(text.contains(label), "{label}: {text}");
    }
    // No text, no font.
    done("render example1 --set size_scale=2 --layers live,dead,boundary -q -o bare.pdf", here);
    assert_eq!(reader(&["pdffonts", "bare.pdf"], here).unwrap().lines().count(), 2);
    let words = ["render", "uniform", "--size", "20000", "--dpi", "72", "-o", "wide.pdf"];
    let output = run(&words, here);
    let err = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && err.contains("too large") && err.lines().count() == 1, "{err}");
}

#[test]
fn a_pdf_is_drawn_again_from_itself_to_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for figure in FIGURES.iter().filter(|figure| !figure.starts_with("sweep")) {
        drawn(figure, "a.pdf", here);
        drawn(figure, "a.svg", here);
        assert!(read(here, "a.pdf").starts_with(b"%PDF-1.7"), "{figure}");
        for (from, name) in [("a.pdf", "b.pdf"), ("a.svg", "b.pdf"), ("a.pdf", "b.svg")] {
            done(&format!("render {from} -q -o {name}"), here);
            let like = format!("a{}", &name[1..]);
            assert!(read(here, name) == read(here, &like), "{figure}: {name} of {from}");
        }
        assert_eq!(
            figure::text_in(&read(here, "a.pdf")).unwrap(),
            figure::text_in(&read(here, "a.svg")).unwrap().trim_start(),
            "{figure}"
        );
    }
    done("convert a.pdf -q -o a.vtu", here);
    done("convert a.svg -q -o b.vtu", here);
    assert!(read(here, "a.vtu") == read(here, "b.vtu"));
    // A mesh has no run, and neither has a sweep.
    done("convert uniform --set size_scale=4 -q -o quads.msh", here);
    done("render quads.msh -q -o mesh.pdf", here);
    let output = run(&["render", "mesh.pdf", "-o", "b.svg"], here);
    assert!(String::from_utf8(output.stderr).unwrap().contains("mesh.pdf: This figure contains no run"));
}

#[test]
fn what_other_programs_write_anew_still_opens_and_the_run_can_be_saved_from_it() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done("render example1 --set size_scale=2 --at nq=20 -q -o a.pdf", here);
    done("render example1 --set size_scale=2 --at nq=20 -q -o a.svg", here);
    let run = figure::text_in(&read(here, "a.pdf")).unwrap();
    for options in [&["-z"][..], &["-d"], &["-gggg", "-z", "-f"], &["-l"], &["-a", "-z"]] {
        let Some(_) = reader(&[&["mutool", "clean"], options, &["a.pdf", "other.pdf"]].concat(), here) else { return };
        assert!(read(here, "other.pdf") != read(here, "a.pdf"));
        let found = figure::text_in(&read(here, "other.pdf"));
        if options.contains(&"-a") {
            // As text it is compressed and written in hexadecimal digits.
            assert!(
                found.as_ref().is_ok_and(|found| *found == run)
                    || found.is_err_and(|fault| fault.what.contains("not supported"))
            );
            continue;
        }
        assert!(found.unwrap() == run, "{options:?}");
        done("render other.pdf -q -o b.svg", here);
        assert!(read(here, "a.svg") == read(here, "b.svg"), "{options:?}");
    }
    reader(&["pdfdetach", "-save", "1", "-o", "run.toml", "a.pdf"], here);
    assert_eq!(String::from_utf8(read(here, "run.toml")).unwrap(), run);
}

#[test]
fn a_damaged_pdf_is_told_and_never_a_crash() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    done("render figure-14 --at step=3 -q -o a.pdf", here);
    let whole = read(here, "a.pdf");
    let text = figure::text_in(&whole).unwrap();
    let begins = whole.windows(text.len()).position(|window| window == text.as_bytes()).unwrap();
    for length in (0..whole.len()).step_by(7).chain([begins, begins + 1, begins + text.len(), whole.len() - 1]) {
        match figure::text_in(&whole[..length]) {
            Ok(found) => assert!(found == text && length > begins + text.len(), "{length}"),
            Err(fault) => {
                let told = fault.to_string();
                assert!(told.contains("contains no run") || told.contains("damaged or truncated"), "{length}: {told}");
            }
        }
    }
    for (name, bytes, words) in [
        ("cut.pdf", &whole[..begins + 100], "damaged or truncated"),
        ("none.pdf", b"%PDF-1.7\n%%EOF", "contains no run"),
        ("empty.pdf", b"", "contains no run"),
        ("text.pdf", b"no PDF at all", "contains no run"),
    ] {
        std::fs::write(here.join(name), bytes).unwrap();
        let output = run(&["render", name, "-o", "b.svg"], here);
        let err = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{name}: {err}");
        assert!(
            err.starts_with(&format!("error: {name}: ")) && err.contains(words) && err.lines().count() == 1,
            "{err}"
        );
    }
    // Bytes changed at random around the run.
    let mut source = XorShift::of(1);
    let mut random = |below: usize| source.below(below);
    let rounds = environment::number("QUADFRONT_SOAK_ROUNDS").unwrap_or(3000);
    let (mut same, mut told) = (0, 0);
    for _ in 0..rounds {
        let mut bytes = whole.clone();
        for _ in 0..=random(4) {
            let at = begins.saturating_sub(300) + random(320);
            match random(3) {
                0 => bytes[at] = b"0123456789/<>[]() \nRobjstream"[random(29)],
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, random(256) as u8),
            }
        }
        match figure::text_in(&bytes) {
            Ok(found) if found == text => same += 1,
            Ok(_) => {}
            Err(_) => told += 1,
        }
    }
    assert!(same > 0 && told > rounds / 10, "{same} as they were, {told} refused");
}
