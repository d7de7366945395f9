//! Figures as commands and the window make them: what is drawn of a run, how, how large, and what the file carries.

mod options;

pub(super) use options::{FigureOptions, LayerWords, Plot};
#[cfg(feature = "window")]
pub(super) use options::{PartWords, Size};

use super::convert::describe;
use super::work::{self, Frame};
use crate::core::convert::walk::Stop;
use crate::core::fault::Fault;
use crate::core::progress::Watch;
use crate::core::record::run_file;
use crate::core::run::run::Run;
use crate::core::run::shown::Shown;
use crate::render::picture::Picture;
use crate::render::vector::histogram::Histogram;
use crate::render::vector::svg;

/// A figure, ready to be written.
#[cfg_attr(not(feature = "window"), expect(dead_code, reason = "what a PNG carries beside the vectors"))]
pub(super) struct Figure {
    /// Its vectors.
    pub svg: String,
    /// What it shows, in words.
    pub description: String,
    /// The text of the run that it carries.
    pub run: Option<String>,
    dots: f64,
}

impl Figure {
    /// The figure of a mesh that belongs to no run.
    pub fn of_mesh(picture: &Picture, options: &FigureOptions) -> Figure {
        let svg = svg::write(picture, &options.sheet(false, &picture.title, &picture.description, None));
        Figure { svg, description: picture.title.clone(), run: None, dots: options.dots() }
    }

    /// The figure of a run at some of its states.
    ///
    /// # Errors
    /// Where a mesh that the run starts from cannot be read any more.
    pub fn of_run(run: &Run, frames: &[Frame], options: &FigureOptions, carries: bool) -> Result<Figure, Fault> {
        let strip = frames.len() > 1;
        let mut description = describe(&run.case);
        if let [Frame { shown, .. }] = frames
            && let Some(at) = shown.at
        {
            description = format!("{description}, at {at}");
        }
        let carried = if carries {
            let states = frames.iter().map(|frame| frame.shown).collect();
            let shown = Shown { states, drawn: options.words() };
            let mut run = run.clone();
            run.shown = Some(shown);
            Some(run_file::embedded(&run)?)
        } else {
            None
        };
        let sheet = options.sheet(strip, &run.case.title, &description, carried.as_deref());
        let svg = match frames {
            [Frame { statistics: Some(statistics), .. }] => match options.plot {
                Some(Plot::Angles) => Histogram::of_angles(statistics).write(&sheet),
                _ => Histogram::of_lengths(statistics).write(&sheet),
            },
            [frame] => svg::write(&frame.picture, &sheet),
            _ => {
                let captioned = |frame: &Frame| Picture { title: caption(frame.shown.at), ..frame.picture.clone() };
                svg::strip(&frames.iter().map(captioned).collect::<Vec<_>>(), &sheet)
            }
        };
        Ok(Figure { svg, description, run: carried, dots: options.dots() })
    }

    /// The figure as pixels.
    ///
    /// # Errors
    /// A size that no picture can have.
    #[cfg(feature = "window")]
    pub fn png(&self) -> Result<Vec<u8>, Fault> {
        use crate::render::vector::png;
        png::write(&self.svg, self.dots, png::Carried { description: &self.description, run: self.run.as_deref() })
    }
}

/// How a stop is called under a frame.
fn caption(at: Option<Stop>) -> String {
    match at {
        Some(Stop::Quads(quads)) => format!("NQ = {quads}"),
        Some(Stop::Step(step)) => format!("step {step}"),
        None => "end".to_owned(),
    }
}

/// Where to go for a figure, and what it is called there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wanted {
    /// Where to go; `None`: to the end.
    pub stop: Option<Stop>,
    /// How it is called.
    pub at: Option<Stop>,
}

impl Wanted {
    /// What is called by the way to it.
    pub fn at(stop: Option<Stop>) -> Wanted {
        Wanted { stop, at: stop }
    }

    /// The states that a figure shows.
    pub fn of(shown: &Shown) -> Vec<Wanted> {
        let one = |at: Option<Stop>, step| Wanted { stop: at.map(|_| Stop::Step(step)), at };
        shown.states.iter().map(|state| one(state.at, state.step)).collect()
    }
}

/// Runs to the states that are wanted and makes their figure.
///
/// # Errors
/// As the conversion; several states in one histogram.
pub(super) fn make(
    run: &Run,
    wanted: &[Wanted],
    options: &FigureOptions,
    carries: bool,
    watch: &mut dyn Watch,
) -> Result<(Figure, Vec<Frame>), Fault> {
    if options.plot.is_some() && wanted.len() > 1 {
        return Err(Fault::new("A histogram is of one state").at("--plot").remedy("Name one stop with --at"));
    }
    let look = options.look(wanted.len() > 1);
    let frames = work::frames(run, wanted, &look, options.plot.is_some(), watch)?;
    Ok((Figure::of_run(run, &frames, options, carries)?, frames))
}

/// What is to be told where a state is not the one that a figure shows.
pub(super) fn difference(name: &str, shown: &Shown, frames: &[Frame]) -> Option<String> {
    let other = shown.states.iter().zip(frames).find(|(then, now)| then.state != now.shown.state)?;
    Some(another_state(name, other.0.step).to_string())
}

/// That a state is not the one that a figure shows.
pub(super) fn another_state(name: &str, step: u64) -> Fault {
    let version = env!("CARGO_PKG_VERSION");
    Fault::new(format!("quadfront {version} reaches another state at step {step} than the figure shows"))
        .at(name)
        .remedy("It was drawn by another version, or with other parameters")
}
