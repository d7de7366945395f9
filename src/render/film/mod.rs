//! Films: frames as pixels, one after another, into a GIF or an animated PNG. The same frames give the same bytes.
//! Deliberately absent: what a frame shows.

mod apng;
mod colours;
mod gif;

use std::io::{self, Write};

use super::vector::png::Raster;
use apng::Apng;
use colours::Colours;
use gif::Gif;

/// The largest number of frames a second: viewers show GIFs no faster.
pub const FASTEST: f64 = 50.0;
/// The longest hold at the end in seconds.
pub const LONGEST_HOLD: f64 = 600.0;

/// The formats of films.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmFormat {
    /// At most 256 colours; plays everywhere.
    Gif,
    /// Every pixel exactly.
    Apng,
}

impl FilmFormat {
    /// All formats.
    pub const ALL: [FilmFormat; 2] = [FilmFormat::Gif, FilmFormat::Apng];

    /// The extension of its files.
    pub fn extension(self) -> &'static str {
        match self {
            FilmFormat::Gif => "gif",
            FilmFormat::Apng => "apng",
        }
    }
}

/// How a film plays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playing {
    /// Frames a second, at most [`FASTEST`].
    pub rate: f64,
    /// How often it plays; `None`: until it is stopped.
    pub plays: Option<u16>,
    /// The time in seconds that the last frame stays, at most [`LONGEST_HOLD`].
    pub hold: f64,
}

impl Playing {
    /// The time that frame `k` of `count` stays, in hundredths of a second. They are rounded so that the film as a
    /// whole keeps its rate.
    fn hundredths(&self, k: usize, count: usize) -> u16 {
        let time = |k: usize| (k as f64 * 100.0 / self.rate).round();
        let own = time(k + 1) - time(k);
        if k + 1 == count { own.max((100.0 * self.hold).round()) as u16 } else { own as u16 }
    }
}

/// A film being written, frame by frame.
pub struct Film<'w>(Encoder<'w>);

enum Encoder<'w> {
    Gif(Box<Gif<'w>>),
    Apng(Box<Apng<'w>>),
}

impl<'w> Film<'w> {
    /// Begins a film of so many frames of one size. The colours of a GIF are taken from `samples`, some of its frames;
    /// those that are `kept` (red, green, blue) stay as they are.
    ///
    /// # Errors
    /// What `out` says.
    pub fn begin(
        out: &'w mut dyn Write,
        format: FilmFormat,
        (size, count): ([u32; 2], usize),
        playing: Playing,
        (samples, kept): (&[Raster], &[[u8; 3]]),
        description: &str,
    ) -> io::Result<Film<'w>> {
        Ok(Film(match format {
            FilmFormat::Gif => {
                let colours = Colours::of(samples, kept);
                Encoder::Gif(Box::new(Gif::begin(out, size, count, playing, colours, description)?))
            }
            FilmFormat::Apng => {
                // Frames have the same layers, so one that is opaque says it of all.
                let opaque = samples.iter().all(Raster::is_opaque);
                Encoder::Apng(Box::new(Apng::begin(out, size, count, playing, opaque, description)?))
            }
        }))
    }

    /// Adds the next frames.
    ///
    /// # Errors
    /// What `out` says.
    pub fn add(&mut self, frames: Vec<Raster>) -> io::Result<()> {
        match &mut self.0 {
            Encoder::Gif(gif) => gif.add(&frames),
            Encoder::Apng(apng) => apng.add(frames),
        }
    }

    /// Ends the film.
    ///
    /// # Errors
    /// What `out` says; fewer frames than were announced.
    pub fn finish(self) -> io::Result<()> {
        match self.0 {
            Encoder::Gif(gif) => gif.finish(),
            Encoder::Apng(apng) => apng.finish(),
        }
    }
}

/// A rectangle of pixels: left, top, width and height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Part {
    left: u32,
    top: u32,
    width: u32,
    height: u32,
}

impl Part {
    /// The smallest rectangle around the pixels in which a frame differs from the one before; one pixel where none
    /// does.
    fn changed<T: PartialEq>(before: &[T], now: &[T], [width, height]: [u32; 2]) -> Part {
        let row = |pixels: &[T], y: u32| -> std::ops::Range<usize> {
            debug_assert_eq!(pixels.len(), width as usize * height as usize);
            let from = y as usize * width as usize;
            from..from + width as usize
        };
        let differs = |y: &u32| before[row(before, *y)] != now[row(now, *y)];
        let Some(top) = (0..height).find(differs) else { return Part { left: 0, top: 0, width: 1, height: 1 } };
        let bottom = (top..height).rev().find(differs).unwrap_or(top);
        let (mut left, mut right) = (width, 0);
        for y in top..=bottom {
            let (a, b) = (&before[row(before, y)], &now[row(now, y)]);
            let first = a.iter().zip(b).position(|(a, b)| a != b);
            let last = a.iter().zip(b).rposition(|(a, b)| a != b);
            if let (Some(first), Some(last)) = (first, last) {
                (left, right) = (left.min(first as u32), right.max(last as u32));
            }
        }
        Part { left, top, width: right - left + 1, height: bottom - top + 1 }
    }

    /// The indices of its pixels in a frame of some width.
    fn indices(self, width: u32) -> impl Iterator<Item = usize> {
        let Part { left, top, width: own, height } = self;
        let row = move |y: u32| (y * width + left) as usize..(y * width + left + own) as usize;
        (top..top + height).flat_map(row)
    }
}

#[cfg(test)]
mod tests;
