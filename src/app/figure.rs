//! Figures for commands and the window: the states drawn, the style, the size, and the run embedded in the file.

pub(super) mod every;
mod options;
mod told;

pub(super) use options::{FigureOptions, LayerWords, Plot};
#[cfg(feature = "window")]
pub(super) use options::{LINE_SCALES, PartWords, Size, font_size};

use super::convert::describe;
use super::output::PictureFormat;
use super::work::{self, FigureFrame};
use crate::core::convert::Stop;
use crate::core::fault::Fault;
use crate::core::progress::Watch;
use crate::core::record::run_file;
use crate::core::run::{Run, Shown, ShownState};
use crate::render::picture::Picture;
use crate::render::vector::histogram::Histogram;
use crate::render::vector::page::Page;
use crate::render::vector::sheet::{self, Sheet};
use crate::render::vector::svg;

/// A figure, ready to be written.
pub(super) struct Figure {
    /// What is drawn, with the text of the embedded run.
    pub page: Page,
    /// Dots per inch.
    #[cfg_attr(not(feature = "window"), expect(dead_code, reason = "a PNG has them"))]
    dots: f64,
}

impl Figure {
    /// A figure of a mesh without a run.
    pub fn of_mesh(picture: &Picture, options: &FigureOptions) -> Figure {
        let sheet = options.sheet(false, &picture.title, &picture.description, None);
        Figure { page: sheet::page(picture, &sheet), dots: options.dots() }
    }

    /// A figure of states of a run; with `embeds` it contains the run.
    ///
    /// # Errors
    /// The mesh file of the run can no longer be read; no room for a caption.
    pub fn of_run(run: &Run, frames: &[FigureFrame], options: &FigureOptions, embeds: bool) -> Result<Figure, Fault> {
        let strip = options.is_grid(frames.len());
        let description = described(run, if let [frame] = frames { Some(frame) } else { None });
        let states: Vec<ShownState> = frames.iter().map(|frame| frame.shown).collect();
        let embedded = carried(run, &states, options, embeds)?;
        let below = match frames {
            [frame] => options.caption(&frame.caption),
            _ => None,
        };
        below.as_ref().map_or(Ok(()), |caption| options.check_room(caption))?;
        let sheet = options.sheet(strip, &run.case.title, &description, embedded.as_deref());
        let sheet = Sheet { caption: below, ..sheet };
        let page = match frames {
            [FigureFrame { statistics: Some(statistics), .. }] => match options.plot {
                Some(Plot::Angles) => Histogram::of_angles(statistics).draw(&sheet),
                _ => Histogram::of_lengths(statistics).draw(&sheet),
            },
            _ if options.contact_sheet == Some(true) => {
                let named = |frame: &FigureFrame| Picture { title: frame.name.clone(), ..frame.picture.clone() };
                sheet::contact_sheet(&frames.iter().map(named).collect::<Vec<_>>(), &sheet)
            }
            [frame] => sheet::page(&frame.picture, &sheet),
            _ => {
                let captioned =
                    |frame: &FigureFrame| Picture { title: caption(frame.shown.at), ..frame.picture.clone() };
                sheet::strip(&frames.iter().map(captioned).collect::<Vec<_>>(), &sheet)
            }
        };
        Ok(Figure { page, dots: options.dots() })
    }

    /// A plot without a run.
    pub fn of_page(page: Page) -> Figure {
        Figure { page, dots: FigureOptions::default().dots() }
    }

    /// The figure as an SVG.
    pub fn svg(&self) -> String {
        svg::write(&self.page)
    }

    /// The figure as a file.
    ///
    /// # Errors
    /// A size that is not possible.
    pub fn bytes(&self, format: PictureFormat) -> Result<Vec<u8>, Fault> {
        match format {
            PictureFormat::Svg => Ok(self.svg().into_bytes()),
            #[cfg(not(target_arch = "wasm32"))]
            PictureFormat::Pdf => crate::render::vector::pdf::write(&self.page),
            #[cfg(feature = "window")]
            PictureFormat::Png => {
                use crate::render::vector::png;
                let Page { description, run, .. } = &self.page;
                png::write(&self.svg(), self.dots, png::Carried { description, run: run.as_deref() })
            }
        }
    }
}

/// What a figure of a run shows, and at which stop where it shows one state.
fn described(run: &Run, frame: Option<&FigureFrame>) -> String {
    let case = describe(&run.case);
    frame.and_then(|frame| frame.shown.at).map_or_else(|| case.clone(), |at| format!("{case}, at {at}"))
}

/// The text of the run that a figure of these states embeds; `None` where it shall not.
fn carried(run: &Run, states: &[ShownState], options: &FigureOptions, embeds: bool) -> Result<Option<String>, Fault> {
    if !embeds {
        return Ok(None);
    }
    let mut run = run.clone();
    run.shown = Some(Shown { states: states.to_vec(), drawn: options.words() });
    run_file::embedded(&run).map(Some)
}

/// The caption of a stop below its frame.
fn caption(at: Option<Stop>) -> String {
    match at {
        Some(Stop::Quads(quads)) => format!("NQ = {quads}"),
        Some(Stop::Step(step)) => format!("step {step}"),
        None => "end".to_owned(),
    }
}

/// A state that a figure shall show, with its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wanted {
    /// Where to stop; `None`: at the end.
    pub stop: Option<Stop>,
    /// The stop that names it; `None`: the end.
    pub at: Option<Stop>,
}

impl Wanted {
    /// A state named by its stop.
    pub fn at(stop: Option<Stop>) -> Wanted {
        Wanted { stop, at: stop }
    }

    /// The states that a figure shows.
    pub fn of(shown: &Shown) -> Vec<Wanted> {
        let one = |at: Option<Stop>, step| Wanted { stop: at.map(|_| Stop::Step(step)), at };
        shown.states.iter().map(|state| one(state.at, state.step)).collect()
    }
}

/// Runs to the wanted states and draws their figure; with `embeds` it contains the run.
///
/// # Errors
/// As the conversion; several states in one histogram, or with captions.
pub(super) fn make(
    run: &Run,
    wanted: &[Wanted],
    options: &FigureOptions,
    embeds: bool,
    watch: &mut dyn Watch,
) -> Result<(Figure, Vec<FigureFrame>), Fault> {
    options.check(wanted.len())?;
    if let (Some(plot), [wanted]) = (options.plot.filter(|plot| !plot.is_of_statistics()), wanted) {
        let (figure, frame) = told::make(run, *wanted, plot, options, embeds, watch)?;
        return Ok((figure, vec![frame]));
    }
    let look = options.look(options.is_grid(wanted.len()));
    let frames = work::frames(run, wanted, &look, options.plot.is_some(), watch)?;
    Ok((Figure::of_run(run, &frames, options, embeds)?, frames))
}

/// A warning where a state differs from the one that the figure shows.
pub(super) fn difference(name: &str, shown: &Shown, frames: &[FigureFrame]) -> Option<String> {
    let other = shown.states.iter().zip(frames).find(|(then, now)| then.state != now.shown.state)?;
    Some(another_state(name, other.0.step).to_string())
}

/// The fault that a state differs from the one that the figure shows.
pub(super) fn another_state(name: &str, step: u64) -> Fault {
    let version = env!("CARGO_PKG_VERSION");
    Fault::new(format!("quadfront {version} reaches another state at step {step} than the figure shows"))
        .at(name)
        .remedy("The figure was drawn by another version or with other parameters")
}
