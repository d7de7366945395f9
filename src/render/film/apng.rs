//! Animated PNG: every pixel exactly, of each frame the part that has changed.

use std::io::{self, Write};

use png::{BitDepth, BlendOp, ColorType, Encoder, EncodingError, Writer};

use super::{Part, Playing};
use crate::render::vector::png::Raster;

/// An animated PNG being written.
pub struct Apng<'w> {
    writer: Writer<&'w mut dyn Write>,
    /// Bytes of a pixel: 3, and 4 where pixels are transparent.
    bytes: usize,
    count: usize,
    playing: Playing,
    /// The frame before, and the number of those before it.
    last: Option<Raster>,
    written: usize,
}

impl<'w> Apng<'w> {
    /// Begins a film.
    pub fn begin(
        out: &'w mut dyn Write,
        [width, height]: [u32; 2],
        count: usize,
        playing: Playing,
        opaque: bool,
        description: &str,
    ) -> io::Result<Apng<'w>> {
        let mut encoder = Encoder::new(out, width, height);
        encoder.set_color(if opaque { ColorType::Rgb } else { ColorType::Rgba });
        encoder.set_depth(BitDepth::Eight);
        let frames = u32::try_from(count).map_err(io::Error::other)?;
        encoder.set_animated(frames, playing.plays.map_or(0, u32::from)).map_err(explained)?;
        encoder.set_blend_op(BlendOp::Source).map_err(explained)?;
        encoder.add_itxt_chunk("Description".to_owned(), description.to_owned()).map_err(explained)?;
        let bytes = if opaque { 3 } else { 4 };
        Ok(Apng { writer: encoder.write_header().map_err(explained)?, bytes, count, playing, last: None, written: 0 })
    }

    /// Adds the next frames.
    pub fn add(&mut self, frames: Vec<Raster>) -> io::Result<()> {
        frames.into_iter().try_for_each(|frame| self.add_one(frame))
    }

    fn add_one(&mut self, frame: Raster) -> io::Result<()> {
        let [width, height] = frame.size;
        let whole = Part { left: 0, top: 0, width, height };
        let part = self.last.as_ref().map_or(whole, |last| Part::changed(&last.pixels, &frame.pixels, frame.size));
        // A part lies within the frame at every moment, so place before size where it becomes larger.
        self.writer.reset_frame_position().map_err(explained)?;
        self.writer.set_frame_dimension(part.width, part.height).map_err(explained)?;
        self.writer.set_frame_position(part.left, part.top).map_err(explained)?;
        let (numerator, denominator) = self.delay();
        self.writer.set_frame_delay(numerator, denominator).map_err(explained)?;
        let pixels = part.indices(width).flat_map(|i| &frame.pixels[i][..self.bytes]).copied().collect::<Vec<u8>>();
        self.writer.write_image_data(&pixels).map_err(explained)?;
        self.written += 1;
        self.last = Some(frame);
        Ok(())
    }

    /// The time that the next frame stays in seconds, as a fraction: exact where the rate has two decimals.
    fn delay(&self) -> (u16, u16) {
        let is_last = self.written + 1 == self.count;
        if is_last && self.playing.hold * self.playing.rate > 1.0 {
            ((100.0 * self.playing.hold).round() as u16, 100)
        } else {
            (100, (100.0 * self.playing.rate).round() as u16)
        }
    }

    /// Ends the film.
    pub fn finish(self) -> io::Result<()> {
        if self.written != self.count {
            return Err(io::Error::other(format!("{} of {} frames were drawn", self.written, self.count)));
        }
        self.writer.finish().map_err(explained)
    }
}

fn explained(error: EncodingError) -> io::Error {
    match error {
        EncodingError::IoError(error) => error,
        error => io::Error::other(error.to_string()),
    }
}
