//! SVG: real vectors, widths in points, the same bytes for the same picture.

use std::fmt::Write;

use glam::DVec2;

use crate::render::palette::{CROWDED, THIN, figure};
use crate::render::picture::{Picture, Role};

/// The width of a figure in one column of a page, in points (84 mm).
pub const COLUMN: f64 = 238.0;

/// Ground left free around the mesh, in points: half of the widest line, and a little.
const MARGIN: f64 = 1.0;

/// The picture as an SVG file `width` points wide on white ground, as high as its equal scales along both axes demand.
pub fn write(picture: &Picture, width: f64) -> String {
    let [low, high] = picture.bounds().unwrap_or([DVec2::ZERO, DVec2::ONE]);
    let size = high - low;
    // A tall picture is not magnified beyond measure, and one without any size still has a scale.
    let span = size.x.max(size.y * 0.1);
    let scale = (width - 2.0 * MARGIN) / if span > 0.0 { span } else { 1.0 };
    let height = size.y * scale + 2.0 * MARGIN;
    let aside = 0.5 * (width - 2.0 * MARGIN - size.x * scale);
    let place = |p: DVec2| (MARGIN + aside + (p.x - low.x) * scale, MARGIN + (high.y - p.y) * scale);
    let (w, h) = (Short(width), Short(height));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}pt\" height=\"{h}pt\" viewBox=\"0 0 {w} {h}\">\n\
         <title>{}</title>\n<desc>{}</desc>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#FFFFFF\"/>\n",
        escaped(&picture.title),
        escaped(&picture.description)
    );
    for role in Role::ALL {
        let style = figure(role);
        if let Some(fill) = style.fill {
            let mut path = Path::default();
            for area in picture.areas.iter().filter(|a| a.role == role) {
                let corners = if area.corners[2] == area.corners[3] { &area.corners[..3] } else { &area.corners[..] };
                path.walk(corners.iter().map(|p| place(*p)), true);
            }
            path.write(&mut svg, &format!("fill=\"{fill}\""));
        }
        if let Some(stroke) = style.stroke {
            for (crowded, stroke_width) in [(true, THIN.min(style.width)), (false, style.width)] {
                let mut path = Path::default();
                // The boundary keeps its width: it is what a reader orients by.
                let thin = |room: f64| role != Role::Boundary && room * scale < CROWDED;
                for line in picture.lines.iter().filter(|l| l.role == role && thin(l.room) == crowded) {
                    path.walk(line.ends.iter().map(|p| place(*p)), false);
                }
                path.write(
                    &mut svg,
                    &format!(
                        "fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{stroke_width}\" stroke-linecap=\"round\""
                    ),
                );
            }
        }
    }
    svg.push_str("</svg>\n");
    svg
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
