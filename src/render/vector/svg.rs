//! SVG: real vectors, widths in points, the same bytes for the same picture.

use std::fmt::Write;

use glam::DVec2;

use crate::render::palette::{CROWDED, THIN, figure};
use crate::render::picture::{Picture, Role};

/// The width of a figure in one column of a page, in points (84 mm).
pub const COLUMN: f64 = 238.0;

/// Ground left free around the mesh, in points: half of the widest line, and a little.
const MARGIN: f64 = 1.0;

/// The width of a figure over the whole page, in points (174 mm).
pub const PAGE: f64 = 493.0;

/// Between the frames of a strip, in points (3 mm).
const GAP: f64 = 8.5;

/// Size of labels in points.
const LABEL: f64 = 7.0;

/// The picture as an SVG file `width` points wide on white ground, as high as its equal scales along both axes demand.
pub fn write(picture: &Picture, width: f64) -> String {
    let frame = Frame::fit(picture.bounds(), width);
    let mut svg = head(picture, width, frame.height);
    draw(&mut svg, picture, &frame);
    svg.push_str("</svg>\n");
    svg
}

/// The picture as an SVG file of exactly `size` points, in the middle of it.
pub fn write_sized(picture: &Picture, size: [f64; 2]) -> String {
    let mut frame = Frame::fit(picture.bounds(), size[0]);
    let inner = size[1] - 2.0 * MARGIN;
    let extent = picture.bounds().map_or(DVec2::ONE, |b| b[1] - b[0]);
    if extent.y * frame.scale > inner && extent.y > 0.0 {
        frame.scale = inner / extent.y;
        frame.aside = 0.5 * (size[0] - 2.0 * MARGIN - extent.x * frame.scale);
    }
    frame.above = 0.5 * (inner - extent.y * frame.scale).max(0.0);
    let mut svg = head(picture, size[0], size[1]);
    draw(&mut svg, picture, &frame);
    svg.push_str("</svg>\n");
    svg
}

/// Pictures of one thing side by side, `width` points over all, in equal frames of the same scale with a letter and the title of
/// each below it. Title and description are the file's.
pub fn strip(pictures: &[Picture], title: &str, description: &str, width: f64) -> String {
    let count = pictures.len().max(1) as f64;
    let each = (width - GAP * (count - 1.0)) / count;
    let union = |a: [DVec2; 2], b: [DVec2; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let mut frame = Frame::fit(pictures.iter().filter_map(Picture::bounds).reduce(union), each);
    let whole = Picture { title: title.to_owned(), description: description.to_owned(), ..Picture::default() };
    let mut svg = head(&whole, width, frame.height + 1.7 * LABEL);
    for (picture, letter) in pictures.iter().zip('a'..) {
        draw(&mut svg, picture, &frame);
        // Writing to a String cannot fail.
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" font-family=\"IBM Plex Sans, Arial, sans-serif\" font-size=\"{LABEL}\" \
             fill=\"#000000\">({letter}) {}</text>",
            Short(frame.left + MARGIN),
            Short(frame.height + 1.2 * LABEL),
            escaped(&picture.title)
        );
        frame.left += each + GAP;
    }
    svg.push_str("</svg>\n");
    svg
}

/// Where coordinates of the mesh come to lie.
struct Frame {
    /// The corner at the top left of the mesh, in its coordinates.
    corner: DVec2,
    /// Points for one unit of the mesh.
    scale: f64,
    /// Ground left free beside a tall mesh.
    aside: f64,
    /// Ground left free above a wide one.
    above: f64,
    /// The left edge of the frame.
    left: f64,
    height: f64,
}

impl Frame {
    fn fit(bounds: Option<[DVec2; 2]>, width: f64) -> Frame {
        let [low, high] = bounds.unwrap_or([DVec2::ZERO, DVec2::ONE]);
        let size = high - low;
        // A tall picture is not magnified beyond measure, and one without any size still has a scale.
        let span = size.x.max(size.y * 0.1);
        let scale = (width - 2.0 * MARGIN) / if span > 0.0 { span } else { 1.0 };
        Frame {
            corner: DVec2::new(low.x, high.y),
            scale,
            aside: 0.5 * (width - 2.0 * MARGIN - size.x * scale),
            above: 0.0,
            left: 0.0,
            height: size.y * scale + 2.0 * MARGIN,
        }
    }

    fn place(&self, p: DVec2) -> (f64, f64) {
        let right = MARGIN + self.aside + (p.x - self.corner.x) * self.scale;
        (self.left + right, MARGIN + self.above + (self.corner.y - p.y) * self.scale)
    }
}

fn head(picture: &Picture, width: f64, height: f64) -> String {
    let (w, h) = (Short(width), Short(height));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}pt\" height=\"{h}pt\" viewBox=\"0 0 {w} {h}\">\n\
         <title>{}</title>\n<desc>{}</desc>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#FFFFFF\"/>\n",
        escaped(&picture.title),
        escaped(&picture.description)
    )
}

fn draw(svg: &mut String, picture: &Picture, frame: &Frame) {
    for role in Role::ALL {
        let style = figure(role);
        if let Some(fill) = style.fill {
            let mut path = Path::default();
            for area in picture.areas.iter().filter(|a| a.role == role) {
                let corners = if area.corners[2] == area.corners[3] { &area.corners[..3] } else { &area.corners[..] };
                path.walk(corners.iter().map(|p| frame.place(*p)), true);
            }
            path.write(svg, &format!("fill=\"{fill}\""));
        }
        if let Some(stroke) = style.stroke {
            for (crowded, stroke_width) in [(true, THIN.min(style.width)), (false, style.width)] {
                let mut path = Path::default();
                // The boundary keeps its width: it is what a reader orients by.
                let thin = |room: f64| role != Role::Boundary && room * frame.scale < CROWDED;
                for line in picture.lines.iter().filter(|l| l.role == role && thin(l.room) == crowded) {
                    path.walk(line.ends.iter().map(|p| frame.place(*p)), false);
                }
                path.write(
                    svg,
                    &format!(
                        "fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{stroke_width}\" stroke-linecap=\"round\""
                    ),
                );
            }
        }
    }
}

/// Many polygons or lines as one path element: no seams between neighbours, and a short file.
#[derive(Default)]
struct Path {
    data: String,
}

impl Path {
    fn walk(&mut self, points: impl Iterator<Item = (f64, f64)>, closed: bool) {
        for (k, (x, y)) in points.enumerate() {
            let letter = if k == 0 { 'M' } else { 'L' };
            // Writing to a String cannot fail.
            let _ = write!(self.data, "{letter}{} {}", Short(x), Short(y));
        }
        self.data.push_str(if closed { "Z\n" } else { "\n" });
    }

    fn write(&self, svg: &mut String, attributes: &str) {
        if !self.data.is_empty() {
            let _ = writeln!(svg, "<path {attributes} d=\"{}\"/>", self.data.trim_end());
        }
    }
}

/// A length in points to a thousandth: finer than any printer, and the same on every machine.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Adding zero turns -0 into 0.
        write!(f, "{}", (self.0 * 1000.0).round() / 1000.0 + 0.0)
    }
}

fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            // XML has no other control characters.
            c if c.is_control() && c != '\n' && c != '\t' => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::io::mesh_file::MeshFile;
    use glam::DVec3;

    #[test]
    fn a_small_mesh_is_written_as_paths_by_role() {
        let points = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
        let mesh = MeshFile {
            points: points.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
            triangles: vec![[1, 2, 5], [1, 5, 4]],
            quads: vec![[0, 1, 4, 3]],
            ..MeshFile::default()
        };
        let picture = Picture { title: "a < b & c".to_owned(), ..Picture::of_mesh(&mesh) };
        insta::assert_snapshot!(write(&picture, 202.0));
    }

    #[test]
    fn the_frames_of_a_strip_are_equal_and_stand_beside_each_other() {
        let mesh = MeshFile {
            points: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            ..MeshFile::default()
        };
        let frame = |title: &str| Picture { title: title.to_owned(), ..Picture::of_mesh(&mesh) };
        let svg = strip(&[frame("nq=1"), frame("nq=2")], "two", "", 108.5);
        let starts: Vec<_> =
            svg.split("<path fill=\"#FFFFFF\" d=\"").skip(1).map(|p| &p[..p.find('L').unwrap()]).collect();
        assert_eq!(starts, ["M1 49", "M59.5 49"]);
        assert!(svg.contains(">(a) nq=1</text>") && svg.contains(">(b) nq=2</text>"), "{svg}");
    }

    #[test]
    fn a_picture_of_a_given_size_lies_in_the_middle_and_within() {
        let mesh = MeshFile {
            points: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            ..MeshFile::default()
        };
        let picture = Picture::of_mesh(&mesh);
        let wide = write_sized(&picture, [200.0, 102.0]);
        assert!(wide.contains("viewBox=\"0 0 200 102\"") && wide.contains("M50 101"), "{wide}");
        let tall = write_sized(&picture, [102.0, 200.0]);
        assert!(tall.contains("M1 150"), "{tall}");
    }

    #[test]
    fn crowded_edges_are_thin_and_none_is_left_out() {
        let n = 1000;
        let mut mesh = MeshFile::default();
        for i in 0..=n {
            let x = f64::from(i) / f64::from(n);
            mesh.points.extend([DVec3::new(x, 0.0, 0.0), DVec3::new(x, 1.0, 0.0)]);
        }
        mesh.quads = (0..n).map(|i| [0, 2, 3, 1].map(|k| k + 2 * i as u32)).collect();
        let svg = write(&Picture::of_mesh(&mesh), COLUMN);
        let thin = svg.split("<path").find(|path| path.contains("stroke-width=\"0.12\"")).unwrap();
        assert_eq!(thin.matches('M').count(), n as usize - 1);
        assert!(!svg.contains("stroke-width=\"0.35\""));
    }

    #[test]
    fn an_empty_and_a_flat_picture_are_finite() {
        for picture in [
            Picture::default(),
            Picture::of_mesh(&MeshFile {
                points: vec![DVec3::ZERO; 3],
                triangles: vec![[0, 1, 2]],
                ..MeshFile::default()
            }),
        ] {
            let svg = write(&picture, COLUMN);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        }
    }
}
