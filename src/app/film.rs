//! `animate`: a film of a conversion. Its frames are the figures of `render`, and the camera stays or follows the
//! decisions.

mod options;
mod plan;

use std::io::{self, Write};

use rayon::prelude::*;

pub(super) use options::{AnimateArguments, FilmCamera, FilmOptions};

use super::convert::describe;
use super::figure::{FigureOptions, Size};
use super::input::{self, Until};
use super::output::{self, Target};
use super::progress::Progress;
use super::work::{FigureFrame, Walked};
use crate::core::case::ImportOptions;
use crate::core::convert::Stop;
use crate::core::fault::Fault;
use crate::core::kernel::number::{counted, grouped};
use crate::core::progress::{Cancel, Stage, Watch};
use crate::core::run::Run;
use crate::render::film::{Film, FilmFormat};
use crate::render::following::{Extent, follow};
use crate::render::look::{FigurePart, Look};
use crate::render::palette;
use crate::render::vector::png::{self, Raster};
use crate::render::vector::sheet::{self, Caption, Sheet};
use crate::render::vector::svg;
use plan::Plan;

/// The width of a film whose size is not said, in pixels.
const WIDTH: u32 = 800;
/// The largest number of pixels of a frame.
const MOST_PIXELS: u64 = 1 << 24;
/// Pixels of the frames that are drawn at the same time, at most.
const AT_ONCE: u64 = 1 << 26;
/// The seconds that a following camera takes to arrive.
const GLIDE: f64 = 0.8;

/// Writes a film.
pub(super) fn animate(arguments: &AnimateArguments) -> Result<(), Fault> {
    let AnimateArguments { split_odd, film, figure, out, .. } = arguments;
    let source = arguments.source();
    let messages = output::check(&[Some(out)], None)?;
    format(out)?;
    let mut progress = Progress::new(source.quiet);
    progress.tell(Stage::Read, 0, 0);
    let mesh = ImportOptions { split_odd: *split_odd, ..ImportOptions::default() };
    let input = input::read(&source, &mesh)?;
    let options = figure.or(input.figure.as_ref()).map_err(|fault| fault.at(source.input.clone()))?;
    let made = make(&input.run, film, &options, out, &mut progress)?;
    progress.finish();
    if !source.quiet {
        messages.print(&format!("{}\n", made.text()));
    }
    Ok(())
}

/// A film that was written.
pub(super) struct Made {
    frames: usize,
    size: [u32; 2],
    seconds: f64,
}

impl Made {
    /// The film in a sentence.
    pub fn text(&self) -> String {
        let Made { frames, size: [width, height], seconds } = self;
        format!("{} of {width} x {height} pixels, {seconds:.1} s.", counted(*frames as u64, "frame"))
    }
}

/// The format that a target names by its extension.
fn format(target: &Target) -> Result<FilmFormat, Fault> {
    let refuse = |place: String| {
        let fault = Fault::new("Films are written as .gif or .apng files").at(place);
        Err(fault.remedy("Name such a file; other programs make .mp4 and .webm of an .apng"))
    };
    let Target::File(path) = target else { return refuse("standard output".to_owned()) };
    let is = |format: &FilmFormat| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(format.extension()));
    FilmFormat::ALL.into_iter().find(is).map_or_else(|| refuse(path.display().to_string()), Ok)
}

/// Makes a film of a run and writes it; the file appears when it is complete.
///
/// # Errors
/// Options that do not fit a film; as the conversion; a file that cannot be written; cancellation.
pub(super) fn make(
    run: &Run,
    film: &FilmOptions,
    figure: &FigureOptions,
    target: &Target,
    watch: &mut dyn Watch,
) -> Result<Made, Fault> {
    let format = format(target)?;
    check(film, figure, format)?;
    let size = figure.size.unwrap_or(Size::Pixels(WIDTH, None));
    let figure = FigureOptions { size: Some(size), ..figure.clone() };
    let look = figure.look(false);
    let background = run.background(watch)?;
    let plan = Plan::of(run, &background, film, &figure, watch)?;
    figure.caption("").map_or(Ok(()), |none| figure.check_room(&Caption { rows: plan.rows, ..none }))?;
    let title = describe(&run.case);
    let artist = Artist::of(&plan, film, &figure, &look, &title);
    let size = png::size(&artist.svg(0, &plan.first), figure.dots())?;
    if u64::from(size[0]) * u64::from(size[1]) > MOST_PIXELS {
        let [width, height] = size;
        return Err(Fault::new(format!("Frames of {width} x {height} pixels are too large for a film"))
            .at("--size")
            .remedy(format!("A frame has at most {} pixels", grouped(MOST_PIXELS))));
    }
    let samples: Result<Vec<Raster>, Fault> =
        plan.samples.par_iter().map(|(k, frame)| artist.raster(*k, frame)).collect();
    let (samples, kept) = (samples?, palette::colours(look.ink));
    watch.cancel().check()?;
    let count = plan.shots.len();
    let description = format!("{title}; {}", counted(count as u64, "frame"));
    written(target, &mut |out| {
        let begun = Film::begin(out, format, (size, count), film.playing(), (&samples, &kept), &description);
        let mut film = begun.map_err(Interruption::Out)?;
        let mut converter = run.start(&background)?;
        let mut walked = Walked::new(run, &mut converter, &look);
        let at_once = at_once(size);
        for (first, shots) in (0..count).step_by(at_once).zip(plan.shots.chunks(at_once)) {
            watch.tell(Stage::Draw, first as u64, count as u64);
            let mut frames = Vec::with_capacity(shots.len());
            for shot in shots {
                // The conversion is part of drawing here.
                walked.to(Some(Stop::Step(shot.step)), &mut watch.cancel(), &mut |_, _| Ok(()))?;
                frames.push(walked.frame(None));
            }
            let drawn = draw(&artist, first, &frames, &watch.cancel())?;
            film.add(drawn).map_err(Interruption::Out)?;
        }
        film.finish().map_err(Interruption::Out)
    })?;
    let film = film.playing();
    Ok(Made { frames: count, size, seconds: (count - 1) as f64 / film.rate + film.hold.max(1.0 / film.rate) })
}

/// Refuses options that do not fit a film.
fn check(film: &FilmOptions, figure: &FigureOptions, format: FilmFormat) -> Result<(), Fault> {
    if figure.plot.is_some() {
        return Err(Fault::new("A film shows the mesh, no histogram").at("--plot").remedy("Leave it out"));
    }
    if figure.transparent == Some(true) && format == FilmFormat::Gif {
        let fault = Fault::new("A GIF whose frames are drawn over each other cannot be transparent");
        return Err(fault.at("--transparent").remedy("Write an .apng, or leave it out"));
    }
    if figure.part.is_some() && film.camera == FilmCamera::Follow {
        let fault = Fault::new("A camera that follows chooses the part that is drawn").at("--part");
        return Err(fault.remedy("Leave it out, or write --camera fixed"));
    }
    let is_reversed = match (film.from, film.to) {
        (Stop::Quads(from), Until::Stop(Stop::Quads(to))) | (Stop::Step(from), Until::Stop(Stop::Step(to))) => {
            from >= to
        }
        _ => false,
    };
    if is_reversed { Err(plan::ends_where_it_begins()) } else { Ok(()) }
}

/// The number of frames that are drawn at the same time.
fn at_once([width, height]: [u32; 2]) -> usize {
    let pixels = u64::from(width) * u64::from(height);
    ((AT_ONCE / pixels.max(1)) as usize).clamp(1, 4 * rayon::current_num_threads())
}

/// Draws frames on all processors; `first` is the number of the first one.
fn draw(artist: &Artist<'_>, first: usize, frames: &[FigureFrame], cancel: &Cancel) -> Result<Vec<Raster>, Fault> {
    let one = |(k, frame): (usize, &FigureFrame)| {
        cancel.check()?;
        artist.raster(first + k, frame)
    };
    frames.par_iter().enumerate().map(one).collect()
}

/// Draws the frames of a film alike.
struct Artist<'a> {
    figure: &'a FigureOptions,
    look: &'a Look,
    title: &'a str,
    extent: Extent,
    rows: usize,
    /// The part drawn in each frame, where the camera follows.
    parts: Option<Vec<FigurePart>>,
}

impl<'a> Artist<'a> {
    fn of(plan: &Plan, film: &FilmOptions, figure: &'a FigureOptions, look: &'a Look, title: &'a str) -> Artist<'a> {
        let parts = (film.camera == FilmCamera::Follow).then(|| {
            let shape = match figure.sheet(false, "", "", None) {
                Sheet { width, height: Some(height), .. } => width / height,
                // As of a part on a page without a height.
                _ => 4.0 / 3.0,
            };
            let followed: Vec<_> = plan.shots.iter().map(|shot| shot.followed).collect();
            follow(&followed, plan.extent, shape, (GLIDE * film.playing().rate).ceil() as usize)
        });
        Artist { figure, look, title, extent: plan.extent, rows: plan.rows, parts }
    }

    /// Frame `k` as vectors.
    fn svg(&self, k: usize, frame: &FigureFrame) -> String {
        let part = self.parts.as_ref().map_or(self.look.part, |parts| parts.get(k).copied());
        let sheet = self.figure.sheet(false, self.title, "", None);
        let caption = self.figure.caption(&frame.caption).map(|caption| Caption { rows: self.rows, ..caption });
        let look = Look { part, ..sheet.look };
        svg::write(&sheet::page(&frame.picture, &Sheet { look, extent: Some(self.extent), caption, ..sheet }))
    }

    /// Frame `k` as pixels.
    fn raster(&self, k: usize, frame: &FigureFrame) -> Result<Raster, Fault> {
        png::raster(&self.svg(k, frame), self.figure.dots())
    }
}

/// Why writing ended before its end.
enum Interruption {
    /// The file cannot be written.
    Out(io::Error),
    /// Anything else.
    Fault(Fault),
}

impl From<Fault> for Interruption {
    fn from(fault: Fault) -> Interruption {
        Interruption::Fault(fault)
    }
}

/// Writes a file by work that has faults of its own.
fn written(target: &Target, work: &mut dyn FnMut(&mut dyn Write) -> Result<(), Interruption>) -> Result<(), Fault> {
    let mut own = None;
    let done = target.write(|out| match work(out) {
        Ok(()) => Ok(()),
        Err(Interruption::Out(error)) => Err(error),
        Err(Interruption::Fault(fault)) => {
            own = Some(fault);
            // It is reported below; this error only makes `write` discard the file.
            Err(io::Error::other("the film was not finished"))
        }
    });
    own.map_or(done, Err)
}
