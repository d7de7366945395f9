//! Pictures of the window, four bytes a pixel.

use std::path::Path;

use super::window_harness::Window;

/// What the window shows; kept as a file where `QUADFRONT_PICTURES` names a folder for those who want to look at it.
pub fn picture(window: &mut Window, name: &str) -> Vec<u8> {
    let image = window.render().unwrap();
    if let Some(folder) = std::env::var_os("QUADFRONT_PICTURES") {
        let file = std::fs::File::create(Path::new(&folder).join(format!("{name}.png"))).unwrap();
        let mut encoder = png::Encoder::new(file, image.width(), image.height());
        encoder.set_color(png::ColorType::Rgba);
        encoder.write_header().unwrap().write_image_data(image.as_raw()).unwrap();
    }
    image.into_raw()
}

/// The share of pixels in which two pictures differ by more than a little.
pub fn difference(a: &[u8], b: &[u8]) -> f64 {
    assert_eq!(a.len(), b.len());
    let apart = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 24);
    let count = a.chunks(4).zip(b.chunks(4)).filter(|pair| apart(*pair)).count();
    count as f64 / (a.len() / 4) as f64
}
