//! GIF: one palette for the whole film, and of each frame what has changed.

use std::io::{self, Write};

use gif::{AnyExtension, DisposalMethod, Encoder, EncodingError, Extension, Frame, Repeat};
use rayon::prelude::*;

use super::colours::Colours;
use super::{Part, Playing};
use crate::render::vector::png::Raster;

/// A GIF being written.
pub struct Gif<'w> {
    encoder: Encoder<&'w mut dyn Write>,
    colours: Colours,
    size: [u32; 2],
    count: usize,
    playing: Playing,
    /// The frame before, and the number of those before it.
    last: Option<Vec<u8>>,
    written: usize,
}

impl<'w> Gif<'w> {
    /// Begins a film.
    pub fn begin(
        out: &'w mut dyn Write,
        size: [u32; 2],
        count: usize,
        playing: Playing,
        colours: Colours,
        description: &str,
    ) -> io::Result<Gif<'w>> {
        let [width, height] = size.map(side);
        let table: Vec<u8> = colours.table().iter().flatten().copied().collect();
        let mut encoder = Encoder::new(out, width?, height?, &table).map_err(written)?;
        let repeat = match playing.plays {
            None => Repeat::Infinite,
            // The format counts repetitions after the first time; none is the absence of the extension.
            Some(plays) => Repeat::Finite(plays.saturating_sub(1)),
        };
        encoder.set_repeat(repeat).map_err(written)?;
        let comment = AnyExtension(Extension::Comment as u8);
        encoder.write_raw_extension(comment, &[description.as_bytes()]).map_err(written)?;
        Ok(Gif { encoder, colours, size, count, playing, last: None, written: 0 })
    }

    /// Adds the next frames.
    pub fn add(&mut self, frames: &[Raster]) -> io::Result<()> {
        let indices: Vec<Vec<u8>> = frames.par_iter().map(|frame| self.colours.indices(&frame.pixels)).collect();
        let before = std::iter::once(self.last.as_ref()).chain(indices.iter().map(Some));
        let pairs: Vec<_> = before.zip(&indices).collect();
        let (size, clear, playing) = (self.size, self.colours.clear(), self.playing);
        let (written_before, count) = (self.written, self.count);
        let compressed: io::Result<Vec<Frame<'static>>> = pairs
            .into_par_iter()
            .enumerate()
            .map(|(k, (before, now))| {
                let mut frame = changed(before, now, size, clear)?;
                frame.delay = playing.hundredths(written_before + k, count);
                frame.make_lzw_pre_encoded();
                Ok(frame)
            })
            .collect();
        for frame in compressed? {
            self.encoder.write_lzw_pre_encoded_frame(&frame).map_err(written)?;
        }
        self.written += frames.len();
        self.last = indices.into_iter().last().or(self.last.take());
        Ok(())
    }

    /// Ends the film.
    pub fn finish(self) -> io::Result<()> {
        if self.written != self.count {
            return Err(io::Error::other(format!("{} of {} frames were drawn", self.written, self.count)));
        }
        self.encoder.into_inner().map_err(written)?.flush()
    }
}

/// What has changed since the frame before; pixels in between that have not are transparent.
fn changed(before: Option<&Vec<u8>>, now: &[u8], size: [u32; 2], clear: u8) -> io::Result<Frame<'static>> {
    let [width, height] = size;
    let whole = Part { left: 0, top: 0, width, height };
    let part = before.map_or(whole, |before| Part::changed(before, now, size));
    let kept = |i: usize| before.is_some_and(|before| before[i] == now[i]);
    let pixels: Vec<u8> = part.indices(width).map(|i| if kept(i) { clear } else { now[i] }).collect();
    Ok(Frame {
        left: side(part.left)?,
        top: side(part.top)?,
        width: side(part.width)?,
        height: side(part.height)?,
        transparent: Some(clear),
        dispose: DisposalMethod::Keep,
        buffer: pixels.into(),
        ..Frame::default()
    })
}

/// A length that the format has room for.
fn side(pixels: u32) -> io::Result<u16> {
    u16::try_from(pixels).map_err(|_| io::Error::other(format!("a GIF has no room for {pixels} pixels side by side")))
}

fn written(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        error => io::Error::other(error.to_string()),
    }
}
