//! States at equal distances along a conversion: frames of a film, files with numbers, the states of a contact sheet.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::app::input::Stops;
use crate::app::work::{FigureFrame, Walked};
use crate::core::convert::{Converter, Stop};
use crate::core::fault::Fault;
use crate::core::kernel::number::grouped;
use crate::core::progress::Watch;
use crate::core::run::Run;
use crate::render::look::Look;

/// The largest number of frames.
pub(in crate::app) const MOST_FRAMES: usize = 20_000;
/// The digits in the names of numbered files: with as many for all of them they sort in their order.
const DIGITS: usize = 5;

/// What lies between two frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::app) enum Every {
    /// So many quadrilaterals.
    Quads(u64),
    /// So many steps.
    Steps(u64),
}

impl FromStr for Every {
    type Err = String;

    fn from_str(text: &str) -> Result<Every, String> {
        let usage = || "write a number of quadrilaterals (5 or nq=5) or of steps (step=20), quad or event".to_owned();
        let number = |text: &str| text.parse().ok().filter(|n| *n > 0).ok_or_else(usage);
        match (text, text.split_once('=')) {
            ("quad", _) => Ok(Every::Quads(1)),
            ("event", _) => Ok(Every::Steps(1)),
            (_, Some(("nq", quads))) => number(quads).map(Every::Quads),
            (_, Some(("step", steps))) => number(steps).map(Every::Steps),
            (quads, None) => number(quads).map(Every::Quads),
            _ => Err(usage()),
        }
    }
}

/// The next state that is a frame.
pub(in crate::app) struct Next {
    every: Every,
    /// The quadrilaterals that stand at the first frame.
    origin: u64,
    stop: Stop,
    /// The step of the last frame.
    noted: u64,
}

impl Next {
    /// After the first frame.
    pub fn new(converter: &Converter<'_>, every: Every) -> Next {
        let (origin, noted) = (converter.standing(), converter.counts.steps);
        let mut next = Next { every, origin, stop: Stop::Step(noted), noted };
        next.advance(converter);
        next
    }

    fn advance(&mut self, converter: &Converter<'_>) {
        self.noted = converter.counts.steps;
        self.stop = match self.every {
            Every::Steps(n) => Stop::Step(self.noted.saturating_add(n)),
            Every::Quads(n) => {
                let done = converter.standing().saturating_sub(self.origin) / n;
                Stop::Quads((done + 1).saturating_mul(n).saturating_add(self.origin))
            }
        };
    }

    /// Whether a state is a frame; then the next one is sought from there on.
    pub fn is_reached(&mut self, converter: &Converter<'_>) -> bool {
        let reached = self.stop.is_reached(converter);
        if reached {
            self.advance(converter);
        }
        reached
    }

    /// Whether a state was the last frame.
    pub fn is_noted(&self, converter: &Converter<'_>) -> bool {
        self.noted == converter.counts.steps
    }
}

/// The fault that there would be too many frames.
pub(in crate::app) fn too_many(what: &str, most: usize) -> Fault {
    Fault::new(format!("{what} would have more than {} frames", grouped(most as u64)))
        .at("--every")
        .remedy("Take fewer, such as --every 20")
}

/// The first and the last state that stops name: by default those of the whole conversion.
///
/// # Errors
/// More than two stops; the end as the first one.
pub(in crate::app) fn ends(stops: Option<&Stops>) -> Result<(Stop, Option<Stop>), Fault> {
    match stops.map_or(&[][..], |stops| &stops.0) {
        [] => Ok((Stop::Step(0), None)),
        [Some(from)] => Ok((*from, None)),
        [Some(from), to] => Ok((*from, *to)),
        _ => Err(Fault::new("With --every, --at names the first and the last state")
            .at("--at")
            .remedy("Write nq=40,48, or nq=40,end, or leave it out for the whole conversion")),
    }
}

/// Goes through a run and hands over a frame for each state at equal distances from one stop to another; the last state
/// is a frame in any case.
///
/// # Errors
/// As the conversion, and those of `each`; it ends before a stop.
pub(in crate::app) fn walk(
    run: &Run,
    (from, to): (Stop, Option<Stop>),
    every: Every,
    look: &Look,
    watch: &mut dyn Watch,
    each: &mut dyn FnMut(FigureFrame) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let background = run.background(watch)?;
    let mut converter = run.start(&background)?;
    let mut walked = Walked::new(run, &mut converter, look);
    let at = |c: &Converter<'_>| Some(Stop::Step(c.counts.steps));
    walked.to(Some(from), watch, &mut |_, _| Ok(()))?;
    each(walked.frame(at(walked.converter)))?;
    let mut next = Next::new(walked.converter, every);
    walked.to(to, watch, &mut |c, last| {
        if next.is_reached(c) { each(last.frame(c, look, at(c))) } else { Ok(()) }
    })?;
    if next.is_noted(walked.converter) { Ok(()) } else { each(walked.frame(at(walked.converter))) }
}

/// The name of a file with its number, from 1: `front.svg` becomes `front-00001.svg`.
pub(in crate::app) fn numbered(path: &Path, number: usize) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{number:0DIGITS$}.{extension}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::input::stops;

    #[test]
    fn distances_are_read() {
        let every = |text: &str| text.parse::<Every>().ok();
        assert_eq!(["5", "nq=5"].map(every), [Some(Every::Quads(5)); 2]);
        assert_eq!(
            ["quad", "event", "step=20"].map(every),
            [Some(Every::Quads(1)), Some(Every::Steps(1)), Some(Every::Steps(20))]
        );
        assert_eq!(["0", "-1", "", "quads", "step=", "step=0", "h=3"].map(every), [None; 7]);
    }

    #[test]
    fn stops_are_the_ends_of_a_range_and_files_have_numbers_that_sort() {
        let range = |text: &str| ends(Some(&stops(text).unwrap())).ok();
        assert_eq!(ends(None), Ok((Stop::Step(0), None)));
        assert_eq!(range("nq=4"), Some((Stop::Quads(4), None)));
        assert_eq!(range("step=4,9"), Some((Stop::Step(4), Some(Stop::Step(9)))));
        assert_eq!(range("nq=4,end"), Some((Stop::Quads(4), None)));
        assert_eq!(["end", "nq=1,2,3"].map(range), [None; 2]);
        assert_eq!(numbered(Path::new("a/b.c.svg"), 12), Path::new("a/b.c-00012.svg"));
    }
}
