//! Links: a state of a run, with what is selected and seen there, as the fragment of an address.
//!
//! ```text
//! #case=example1&c=1.8&step=812&select=104-105&view=0.5,0.3,0.2&lesson=figure-14&part=2
//! ```
//!
//! Words are separated by `&`, and their values are percent-encoded. They are written in this order and read in any:
//!
//! | Word | Value |
//! |---|---|
//! | `case` | the name of a built-in case |
//! | `run` | instead of it: a run file, deflated (RFC 1950), as base64 for addresses without padding |
//! | keys of parameters | their values from step 0 on, as for `--set` |
//! | `step` | the step |
//! | `select` | an edge by its nodes (`104-105`), or `node12`, `element9`, `quad467`, `triangle8`, `segment104-105` |
//! | `view` | in the plane centre and height of the view; in space its centre, its turn (a quaternion) and its height |
//! | `lesson`, `part` | a lesson of the tour and one of its parts, from 1: that of the run, or for after it |

mod reading;
#[cfg(test)]
mod tests;

use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use miniz_oxide::deflate::compress_to_vec_zlib;

use super::run_file;
use crate::core::case::{Parameters, built_in};
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::Shortest;
use crate::core::kernel::number::grouped;
use crate::core::kernel::percent;
use crate::core::run::{Camera, Run, Sought};

/// The greatest length of a link, in characters: programs that pass addresses on cut or refuse much longer ones.
pub const LONGEST: usize = 16_000;

/// How hard a run is deflated: as well as possible.
const LEVEL: u8 = 10;

/// The run that a link leads to, before its parameters are changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// That of a built-in case, by its name.
    Case(String),
    /// One that the link carries, as the text of a run file that needs no other file.
    Run(String),
}

/// A place in the tour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LessonPlace {
    /// The name of the lesson.
    pub name: String,
    /// Its part, from 0.
    pub part: usize,
}

/// A state of a run, with what is selected and seen there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Link {
    /// The run; `None`: that of the lesson.
    pub origin: Option<Origin>,
    /// Keys and values of parameters from step 0 on, as [`Parameters::set`] takes them.
    pub parameters: Vec<(String, String)>,
    /// The step.
    pub step: Option<u64>,
    /// What is selected there: something by its number.
    pub selected: Option<Sought>,
    /// Where the view looks.
    pub view: Option<Camera>,
    /// The lesson. It need not be about the run.
    pub lesson: Option<LessonPlace>,
}

impl Link {
    /// A link to the beginning of a run: by the name of its case where that and parameters say all of it.
    ///
    /// # Errors
    /// A run that starts from a mesh, which is a file of its own.
    pub fn of(run: &Run) -> Result<Link, Fault> {
        if let Some(parameters) = over_built_in(run) {
            let origin = Some(Origin::Case(run.case.name.clone()));
            return Ok(Link { origin, parameters, ..Link::default() });
        }
        let origin = Some(Origin::Run(run_file::alone(run)?));
        Ok(Link { origin, ..Link::default() })
    }

    /// The same, looking where a camera does, but for differences that nobody sees.
    #[must_use]
    pub fn seen_by(mut self, camera: Option<Camera>) -> Link {
        self.view = camera.map(rounded);
        self
    }

    /// The link as text, which begins with `#`.
    ///
    /// # Errors
    /// More than [`LONGEST`] characters.
    pub fn text(&self) -> Result<String, Fault> {
        let mut words: Vec<String> = Vec::new();
        match &self.origin {
            Some(Origin::Case(name)) => words.push(format!("case={}", percent::encoded(name))),
            Some(Origin::Run(text)) => {
                let deflated = compress_to_vec_zlib(text.as_bytes(), LEVEL);
                words.push(format!("run={}", URL_SAFE_NO_PAD.encode(deflated)));
            }
            None => {}
        }
        words.extend(self.parameters.iter().map(|(key, value)| format!("{key}={}", percent::encoded(value))));
        words.extend(self.step.map(|step| format!("step={step}")));
        words.extend(self.selected.as_ref().and_then(selection).map(|value| format!("select={value}")));
        words.extend(self.view.as_ref().map(|camera| format!("view={}", view(camera))));
        if let Some(LessonPlace { name, part }) = &self.lesson {
            words.push(format!("lesson={}", percent::encoded(name)));
            words.extend((*part > 0).then(|| format!("part={}", part + 1)));
        }
        let text = format!("#{}", words.join("&"));
        if text.len() > LONGEST {
            let [long, most] = [text.len(), LONGEST].map(|n| grouped(n as u64));
            return Err(Fault::new(format!("The link would have {long} characters, and {most} are the limit"))
                .of_kind(FaultKind::Limit)
                .remedy("Save the run as a file, and send that"));
        }
        Ok(text)
    }
}

/// The parameters in which a run differs from a built-in case; `None` where it differs in more.
fn over_built_in(run: &Run) -> Option<Vec<(String, String)>> {
    let case = built_in::named(&run.case.name)?.ok()?;
    let is_it = case.text == run.case.text && case.split_odd == run.case.split_odd;
    if !is_it || !run.edits().is_empty() || !run.bookmarks.is_empty() {
        return None;
    }
    let mut parameters = case.parameters;
    let mut changed = Vec::new();
    for key in Parameters::KEYS {
        let value = run.parameters.text_of(key)?;
        if parameters.text_of(key)? != value {
            parameters.set(key, &value).ok()?;
            changed.push((key.to_owned(), value));
        }
    }
    // A list of names that the command line cannot write is said by a run.
    (parameters == run.parameters).then_some(changed)
}

/// What is selected, as a word; `None` for what no number names.
fn selection(sought: &Sought) -> Option<String> {
    Some(match sought {
        Sought::Quad(e) => format!("quad{}", e.0),
        Sought::Triangle(e) => format!("triangle{}", e.0),
        Sought::Element(e) => format!("element{}", e.0),
        Sought::Node(n) => format!("node{}", n.0),
        Sought::Edge([a, b]) => format!("{}-{}", a.0, b.0),
        Sought::Segment([a, b]) => format!("segment{}-{}", a.0, b.0),
        Sought::Place(_) | Sought::Point(_) | Sought::Step(_) | Sought::Quads(_) => return None,
    })
}

fn view(camera: &Camera) -> String {
    let Camera { target: [x, y, z], turn, height } = *camera;
    let numbers = match camera.is_of_the_plane() {
        true => vec![x, y, height],
        false => [x, y, z].into_iter().chain(turn).chain([height]).collect(),
    };
    numbers.into_iter().map(|x| Shortest(x).to_string()).collect::<Vec<_>>().join(",")
}

/// A camera without digits that move nothing by a hundredth of a point, in any view of a usual size.
fn rounded(camera: Camera) -> Camera {
    // What cannot be written in short is left as it is.
    let shorter = |text: String, x: f64| text.parse().map_or(x, |short: f64| short + 0.0);
    let decimals = (5.0 - libm::floor(libm::log10(camera.height))).clamp(0.0, 300.0) as usize;
    Camera {
        target: camera.target.map(|x| shorter(format!("{x:.decimals$}"), x)),
        turn: camera.turn.map(|x| shorter(format!("{x:.6}"), x)),
        height: shorter(format!("{:.5e}", camera.height), camera.height),
    }
}
