//! Pixels drawn from the same vectors: an SVG of ours as PNG, with the same bytes on every machine.

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use crate::core::fault::Fault;

/// The font of labels.
const FONT: &[u8] = include_bytes!("../../../assets/fonts/IBMPlexSans-Regular.ttf");
/// What a picture may have of pixels on one side.
const MOST: u32 = 20_000;

/// Draws an SVG at `scale` pixels a unit of its own, with a text on what it shows in its metadata (iTXt, `Description`).
///
/// # Errors
/// A size that no picture can have.
pub fn write(svg: &str, scale: f64, description: &str) -> Result<Vec<u8>, Fault> {
    let refuse = |error: String| Fault::new(format!("The picture cannot be drawn: {error}"));
    let mut options = Options { font_family: "IBM Plex Sans".to_owned(), dpi: 72.0, ..Options::default() };
    options.fontdb_mut().load_font_data(FONT.to_vec());
    let tree = Tree::from_str(svg, &options).map_err(|error| refuse(error.to_string()))?;
    let pixels = |length: f32| ((f64::from(length) * scale).round() as u32).max(1);
    let (width, height) = (pixels(tree.size().width()), pixels(tree.size().height()));
    if width > MOST || height > MOST {
        return Err(refuse(format!("{width} x {height} pixels are too many")).remedy("Ask for a smaller size"));
    }
    let mut pixmap = Pixmap::new(width, height).ok_or_else(|| refuse("it has no size".to_owned()))?;
    let to_pixels = Transform::from_scale(width as f32 / tree.size().width(), height as f32 / tree.size().height());
    resvg::render(&tree, to_pixels, &mut pixmap.as_mut());
    let opaque: Vec<u8> = pixmap.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect();
    encode(&opaque, [width, height], description).map_err(|error| refuse(error.to_string()))
}

fn encode(pixels: &[u8], [width, height]: [u32; 2], description: &str) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.add_itxt_chunk("Description".to_owned(), description.to_owned())?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_and_text_become_pixels_and_the_text_stays_readable() {
        let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40pt\" height=\"20pt\" viewBox=\"0 0 40 20\">\
                   <rect width=\"40\" height=\"20\" fill=\"#FFFFFF\"/><rect width=\"20\" height=\"20\" fill=\"#AD4E00\"/>\
                   <text x=\"22\" y=\"15\" font-family=\"IBM Plex Sans\" font-size=\"12\" fill=\"#000000\">A</text></svg>";
        let bytes = write(svg, 2.0, "case one").unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (80, 40));
        let at = |x: usize, y: usize| &pixels[3 * (80 * y + x)..][..3];
        assert_eq!(at(10, 10), [0xAD, 0x4E, 0x00]);
        assert_eq!(at(78, 2), [255; 3]);
        assert!((44..70).any(|x| (8..32).any(|y| at(x, y)[0] < 64)), "the letter is there");
        assert_eq!(reader.info().utf8_text[0].get_text().unwrap(), "case one");
        assert!(write(svg, 1e6, "").is_err());
    }
}
