//! PNG: an SVG of ours rendered to pixels, with the same bytes on every machine.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use super::page::{FAMILY, FONT};
use crate::core::fault::Fault;
use crate::core::record::figure::KEYWORD;

/// The largest number of pixels on one side, and in total.
const MOST: u32 = 20_000;
const MOST_PIXELS: u64 = 200_000_000;

/// The font of figures, read once.
static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(FONT.to_vec());
    Arc::new(fonts)
});

/// The texts embedded in a PNG.
#[derive(Clone, Copy, Debug, Default)]
pub struct Carried<'a> {
    /// The description of what it shows.
    pub description: &'a str,
    /// The text of the embedded run.
    pub run: Option<&'a str>,
}

/// Pixels in rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Raster {
    /// Width and height.
    pub size: [u32; 2],
    /// Red, green, blue and opacity of each pixel.
    pub pixels: Vec<[u8; 4]>,
}

impl Raster {
    /// Whether every pixel is opaque.
    pub fn is_opaque(&self) -> bool {
        self.pixels.iter().all(|pixel| pixel[3] == u8::MAX)
    }
}

/// The size in pixels of an SVG at this many dots per inch.
///
/// # Errors
/// A size that is not possible.
pub fn size(svg: &str, dpi: f64) -> Result<[u32; 2], Fault> {
    size_of(&tree(svg)?, dpi)
}

fn size_of(tree: &Tree, dpi: f64) -> Result<[u32; 2], Fault> {
    let pixels = |length: f32| ((f64::from(length) * dpi / 72.0).round() as u32).max(1);
    let [width, height] = [pixels(tree.size().width()), pixels(tree.size().height())];
    if width > MOST || height > MOST || u64::from(width) * u64::from(height) > MOST_PIXELS {
        let fault = refuse(format!("{width} x {height} pixels are too many"));
        return Err(fault.remedy("Choose a smaller size or fewer dots per inch"));
    }
    Ok([width, height])
}

/// Renders an SVG at this many dots per inch.
///
/// # Errors
/// As [`size`].
pub fn raster(svg: &str, dpi: f64) -> Result<Raster, Fault> {
    let tree = tree(svg)?;
    let size = size_of(&tree, dpi)?;
    Ok(Raster { size, pixels: pixels(&rendered(&tree, size)?) })
}

/// Red, green, blue and opacity of each pixel.
fn pixels(pixmap: &Pixmap) -> Vec<[u8; 4]> {
    let one = |pixel: &resvg::tiny_skia::PremultipliedColorU8| {
        let colour = pixel.demultiply();
        [colour.red(), colour.green(), colour.blue(), colour.alpha()]
    };
    pixmap.pixels().iter().map(one).collect()
}

/// Renders an SVG at this many dots per inch, transparent where it has no background. It uses no system fonts.
///
/// # Errors
/// A size that is not possible.
pub fn write(svg: &str, dpi: f64, carried: Carried<'_>) -> Result<Vec<u8>, Fault> {
    let raster = raster(svg, dpi)?;
    let opaque = raster.is_opaque();
    let bytes: Vec<u8> = raster.pixels.iter().flat_map(|pixel| &pixel[..if opaque { 3 } else { 4 }]).copied().collect();
    let colour = if opaque { png::ColorType::Rgb } else { png::ColorType::Rgba };
    encode(&bytes, raster.size, colour, dpi, carried).map_err(refuse)
}

/// Renders an SVG in at most so many pixels. Returns its size, and red, green, blue and opacity of each pixel.
///
/// # Errors
/// A picture without a size.
pub fn fitted(svg: &str, [width, height]: [f32; 2]) -> Result<([u32; 2], Vec<u8>), Fault> {
    let tree = tree(svg)?;
    let scale = (width / tree.size().width()).min(height / tree.size().height());
    let size = [tree.size().width(), tree.size().height()].map(|length| ((length * scale).round() as u32).max(1));
    let pixmap = rendered(&tree, size)?;
    Ok((size, pixels(&pixmap).into_flattened()))
}

fn refuse(error: impl std::fmt::Display) -> Fault {
    Fault::new(format!("The picture cannot be rendered: {error}"))
}

fn tree(svg: &str) -> Result<Tree, Fault> {
    let options =
        Options { font_family: FAMILY.to_owned(), dpi: 72.0, fontdb: Arc::clone(&FONTS), ..Options::default() };
    Tree::from_str(svg, &options).map_err(refuse)
}

fn rendered(tree: &Tree, [width, height]: [u32; 2]) -> Result<Pixmap, Fault> {
    let mut pixmap = Pixmap::new(width, height).ok_or_else(|| refuse("it has no size"))?;
    let to_pixels = Transform::from_scale(width as f32 / tree.size().width(), height as f32 / tree.size().height());
    resvg::render(tree, to_pixels, &mut pixmap.as_mut());
    Ok(pixmap)
}

fn encode(
    pixels: &[u8],
    [width, height]: [u32; 2],
    colour: png::ColorType,
    dpi: f64,
    carried: Carried<'_>,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    let per_metre = (dpi / 0.0254).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter }));
    encoder.add_itxt_chunk("Description".to_owned(), carried.description.to_owned())?;
    if let Some(run) = carried.run {
        encoder.add_itxt_chunk(KEYWORD.to_owned(), run.to_owned())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::record::figure::text_in;

    fn decoded(bytes: &[u8]) -> (png::Info<'static>, Vec<u8>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        (reader.info().clone(), pixels)
    }

    #[test]
    fn vectors_and_text_become_pixels_and_what_is_carried_stays_readable() {
        let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40pt\" height=\"20pt\" viewBox=\"0 0 40 20\">\
                   <rect width=\"40\" height=\"20\" fill=\"#FFFFFF\"/><rect width=\"20\" height=\"20\" fill=\"#AD4E00\"/>\
                   <text x=\"22\" y=\"15\" font-family=\"Quadfront Figure\" font-size=\"12\" fill=\"#000000\">A</text></svg>";
        let bytes = write(svg, 144.0, Carried { description: "case one", run: Some("run = 1\nθ") }).unwrap();
        let (info, pixels) = decoded(&bytes);
        assert_eq!((info.width, info.height, info.color_type), (80, 40, png::ColorType::Rgb));
        let at = |x: usize, y: usize| &pixels[3 * (80 * y + x)..][..3];
        assert_eq!(at(10, 10), [0xAD, 0x4E, 0x00]);
        assert_eq!(at(78, 2), [255; 3]);
        assert!((44..70).any(|x| (8..32).any(|y| at(x, y)[0] < 64)), "the letter is there");
        assert_eq!(info.utf8_text[0].get_text().unwrap(), "case one");
        assert_eq!(info.pixel_dims.map(|dims| dims.xppu), Some(5669));
        assert_eq!(text_in(&bytes).unwrap(), "run = 1\nθ");
        assert!(write(svg, 1e6, Carried::default()).is_err());
    }

    #[test]
    fn without_a_ground_a_picture_is_transparent() {
        let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"4pt\" height=\"2pt\" viewBox=\"0 0 4 2\">\
                   <rect width=\"2\" height=\"2\" fill=\"#AD4E00\"/></svg>";
        let (info, pixels) = decoded(&write(svg, 72.0, Carried::default()).unwrap());
        assert_eq!(info.color_type, png::ColorType::Rgba);
        assert_eq!((&pixels[..4], pixels[15]), (&[0xAD, 0x4E, 0x00, 255][..], 0));
    }
}
