//! Reads links, from whoever wrote them.

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use miniz_oxide::inflate::decompress_to_vec_zlib_with_limit;

use super::{LessonPlace, Link, Origin};
use crate::core::case::{Parameters, built_in};
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::percent;
use crate::core::kernel::spelling::nearest;
use crate::core::lesson::built_in as tour;
use crate::core::record::run_file;
use crate::core::run::{Camera, Sought};

/// The words beside the keys of parameters.
pub(super) const WORDS: [&str; 7] = ["case", "run", "step", "select", "view", "lesson", "part"];
/// The greatest length of a run in bytes: one that is inflated beyond it is no run file.
const LARGEST: usize = 4 << 20;
/// Where messages say that something is wrong.
const PLACE: &str = "the link";

/// The words of a link with their values, decoded.
struct Words(Vec<(String, String)>);

impl Link {
    /// Whether a text is a link: a fragment, or an address of the web.
    pub fn is_link(text: &str) -> bool {
        let text = text.trim_start();
        text.starts_with('#') || is_address(text)
    }

    /// Reads a link: the fragment with or without its `#`, or an address that ends with it. What it names exists, and
    /// its parameters have values that they may have.
    ///
    /// # Errors
    /// An unknown word, one that is given twice, a value of another form or out of range, the name of a case or a
    /// lesson that does not exist, and nothing to open.
    pub fn parse(text: &str) -> Result<Link, Fault> {
        read(text).map_err(|fault| fault.of_kind(FaultKind::Syntax).at(PLACE))
    }
}

fn is_address(text: &str) -> bool {
    ["https://", "http://", "file://"].iter().any(|start| text.starts_with(start))
}

fn read(text: &str) -> Result<Link, Fault> {
    let text = text.trim();
    let fragment = match text.split_once('#') {
        Some((_, fragment)) => fragment,
        None if is_address(text) => "",
        None => text,
    };
    let mut words = Words::of(fragment)?;
    let origin = origin(&mut words)?;
    let step = words.take("step").map(|value| step(&value)).transpose()?;
    let selected = words.take("select").map(|value| selected(&value)).transpose()?;
    let view = words.take("view").map(|value| view(&value)).transpose()?;
    let part = words.take("part");
    let lesson = match words.take("lesson") {
        Some(name) => Some(lesson(name, part.as_deref())?),
        None if part.is_some() => {
            return Err(Fault::new("part is given without lesson").remedy("Write lesson=... too"));
        }
        None => None,
    };
    // Parameters are left.
    let Words(parameters) = words;
    for (key, value) in &parameters {
        Parameters::default().set(key, value)?;
    }
    match (&origin, &lesson, parameters.first()) {
        (None, None, _) => Err(Fault::new("Nothing says what to open")
            .remedy("Write case=NAME with a built-in case (quadfront cases lists all), or lesson=NAME")),
        (None, Some(_), Some((key, _))) => Err(Fault::new(format!("{key} is given, but a lesson has its own run"))
            .remedy(format!("Leave {key} out, or write case=NAME too: the lesson then waits beside that run"))),
        _ => Ok(Link { origin, parameters, step, selected, view, lesson }),
    }
}

impl Words {
    fn of(fragment: &str) -> Result<Words, Fault> {
        let mut words: Vec<(String, String)> = Vec::new();
        for word in fragment.split('&').filter(|word| !word.is_empty()) {
            let Some((key, value)) = word.split_once('=') else {
                let fault = Fault::new(format!("\"{}\" has no value", shortened(word)));
                return Err(fault.remedy("Write for example #case=example1&step=812"));
            };
            if !known().any(|known| known == key) {
                return Err(unknown(key));
            }
            let value = percent::decoded(value).ok_or_else(|| {
                Fault::new(format!("The value of {key} is cut off or damaged: \"{}\"", shortened(value)))
                    .remedy("A percent sign is followed by two hexadecimal digits; copy the link anew")
            })?;
            if words.iter().any(|other| other.0 == key) {
                return Err(Fault::new(format!("{key} is given twice")).remedy("Leave one of them out"));
            }
            words.push((key.to_owned(), value));
        }
        if words.is_empty() {
            return Err(Fault::new("Nothing stands after #").remedy("Write for example #case=example1&step=812"));
        }
        Ok(Words(words))
    }

    /// Takes the value of a word out.
    fn take(&mut self, key: &str) -> Option<String> {
        let place = self.0.iter().position(|word| word.0 == key)?;
        Some(self.0.remove(place).1)
    }
}

fn known() -> impl Iterator<Item = &'static str> {
    WORDS.into_iter().chain(Parameters::KEYS)
}

fn unknown(key: &str) -> Fault {
    let fault = Fault::new(format!("The word \"{}\" is not known", shortened(key)));
    match nearest(key, known()) {
        Some(near) => fault.remedy(format!("The nearest known one is \"{near}\"")),
        None => fault.remedy(format!("Known are {}, and the keys of parameters", WORDS.join(", "))),
    }
}

/// A text for a message, which may come from anywhere.
fn shortened(text: &str) -> String {
    const SHOWN: usize = 40;
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

fn origin(words: &mut Words) -> Result<Option<Origin>, Fault> {
    match (words.take("case"), words.take("run")) {
        (Some(_), Some(_)) => Err(Fault::new("case and run are both given").remedy("Leave one of them out")),
        (Some(name), None) => {
            if built_in::all().any(|case| case.0 == name) {
                return Ok(Some(Origin::Case(name)));
            }
            let fault = Fault::new(format!("No built-in case is called \"{}\"", shortened(&name)));
            Err(match nearest(&name, built_in::all().map(|case| case.0)) {
                Some(near) => fault.remedy(format!("The nearest is \"{near}\"; quadfront cases lists all")),
                None => fault.remedy("quadfront cases lists all"),
            })
        }
        (None, Some(value)) => run(&value).map(Some),
        (None, None) => Ok(None),
    }
}

fn run(value: &str) -> Result<Origin, Fault> {
    let damaged = || {
        Fault::new("The run in the link is cut off or damaged")
            .remedy("Copy the link anew, in whole; or ask for the run as a file")
    };
    let deflated = URL_SAFE_NO_PAD.decode(value).map_err(|_| damaged())?;
    let bytes = decompress_to_vec_zlib_with_limit(&deflated, LARGEST).map_err(|_| damaged())?;
    let text = String::from_utf8(bytes).map_err(|_| damaged())?;
    run_file::parse_alone(&text, "its run")?;
    Ok(Origin::Run(text))
}

fn step(value: &str) -> Result<u64, Fault> {
    value.parse::<u32>().map(u64::from).map_err(|_| {
        Fault::new(format!("step = \"{}\" is not a whole number", shortened(value)))
            .remedy("Write for example step=812")
    })
}

fn selected(value: &str) -> Result<Sought, Fault> {
    match Sought::parse(value) {
        Ok(Sought::Place(_) | Sought::Point(_) | Sought::Step(_) | Sought::Quads(_)) | Err(_) => {
            let fault = Fault::new(format!("select = \"{}\" names nothing that can be selected", shortened(value)));
            Err(fault.remedy("Write for example select=104-105 (an edge), node12, quad467 or triangle8"))
        }
        Ok(sought) => Ok(sought),
    }
}

fn view(value: &str) -> Result<Camera, Fault> {
    let fault = || {
        let what = "is neither three numbers (x, y, height) nor eight (x, y, z, the turn, height)";
        Fault::new(format!("view = \"{}\" {what}", shortened(value)))
            .remedy("Write for example view=0.5,0.3,0.2; the height is positive")
    };
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let numbers: Option<Vec<f64>> = value.split(',').map(number).collect();
    let camera = match numbers.as_deref() {
        Some(&[x, y, height]) => Camera { target: [x, y, 0.0], turn: Camera::OF_THE_PLANE, height },
        Some(&[x, y, z, i, j, k, w, height]) => Camera { target: [x, y, z], turn: [i, j, k, w], height },
        _ => return Err(fault()),
    };
    let has_turn = camera.turn.iter().any(|part| part.abs() > 1e-3);
    if camera.height > 0.0 && has_turn { Ok(camera) } else { Err(fault()) }
}

fn lesson(name: String, part: Option<&str>) -> Result<LessonPlace, Fault> {
    let Some(lesson) = tour::named(&name).transpose()? else {
        let fault = Fault::new(format!("No lesson of the tour is called \"{}\"", shortened(&name)));
        return Err(match nearest(&name, tour::LESSONS.iter().map(|lesson| lesson.0)) {
            Some(near) => fault.remedy(format!("The nearest is \"{near}\"; quadfront lesson lists all")),
            None => fault.remedy("quadfront lesson lists all"),
        });
    };
    let parts = lesson.parts.len();
    let part = match part {
        None => 1,
        Some(text) => text.parse().ok().filter(|part| (1..=parts).contains(part)).ok_or_else(|| {
            Fault::new(format!("part = \"{}\" is none of the parts of \"{name}\"", shortened(text)))
                .remedy(format!("It has parts 1 to {parts}"))
        })?,
    };
    Ok(LessonPlace { name, part: part - 1 })
}
