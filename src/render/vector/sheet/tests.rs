use super::*;
use crate::core::soup::MeshFile;
use crate::render::look::{Ink, Layers};
use crate::render::picture::Mark;
use crate::render::vector::page::rounded;
use crate::render::vector::svg;
use glam::DVec3;

fn svg(picture: &Picture, sheet: &Sheet<'_>) -> String {
    svg::write(&page(picture, sheet))
}

fn strip_svg(pictures: &[Picture], sheet: &Sheet<'_>) -> String {
    svg::write(&strip(pictures, sheet))
}

fn look() -> Look {
    Look { layers: Layers::usual(Ink::Colour, false), ..Look::default() }
}

fn sheet(width: f64, height: Option<f64>) -> Sheet<'static> {
    Sheet { width, height, ..Sheet::column("", "", look()) }
}

fn triangle() -> MeshFile {
    MeshFile { points: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]], ..MeshFile::default() }
}

#[test]
fn a_small_mesh_is_written_as_paths_by_role() {
    let points = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
    let mesh = MeshFile {
        points: points.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(),
        triangles: vec![[1, 2, 5], [1, 5, 4]],
        quads: vec![[0, 1, 4, 3]],
        ..MeshFile::default()
    };
    let sheet = Sheet { title: "a < b & c", ..sheet(202.0, None) };
    insta::assert_snapshot!(svg(&Picture::of_mesh(&mesh), &sheet));
}

#[test]
fn the_frames_of_a_strip_are_equal_and_stand_three_millimetres_apart_with_one_scale_bar() {
    let frame = |title: &str| Picture { title: title.to_owned(), ..Picture::of_mesh(&triangle()) };
    let mut strip_look = look();
    strip_look.layers = Layers::usual(Ink::Colour, true);
    let wide = Sheet { look: strip_look, ..sheet(100.0 + GAP, None) };
    let svg = strip_svg(&[frame("NQ = 1"), frame("NQ = 2")], &wide);
    let starts: Vec<_> = svg.split("<path fill=\"#FFFFFF\" d=\"").skip(1).map(|p| &p[..p.find('L').unwrap()]).collect();
    assert_eq!(starts, ["M1 49", &format!("M{} 49", rounded(51.0 + GAP))]);
    assert!((GAP - 8.504).abs() < 1e-3, "3 mm");
    assert!(svg.contains(">(a) NQ = 1</text>") && svg.contains(">(b) NQ = 2</text>"), "{svg}");
    assert_eq!(svg.matches(">0.2</text>").count(), 1, "{svg}");
    // Several rows are equal too.
    let svg = strip_svg(&["1", "2", "3"].map(frame), &Sheet { columns: Some(2), ..wide });
    let starts: Vec<_> = svg.split("<path fill=\"#FFFFFF\" d=\"").skip(1).map(|p| &p[..p.find('L').unwrap()]).collect();
    let below = rounded(49.0 + 50.0 + 1.9 * sheet(0.0, None).weights.label() + GAP);
    assert_eq!(starts[2], format!("M1 {below}"));
}

#[test]
fn a_picture_of_a_given_size_lies_in_the_middle_and_within() {
    let picture = Picture::of_mesh(&triangle());
    let wide = svg(&picture, &sheet(200.0, Some(102.0)));
    assert!(wide.contains("viewBox=\"0 0 200 102\"") && wide.contains("M50 101"), "{wide}");
    let tall = svg(&picture, &sheet(102.0, Some(200.0)));
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
    let svg = svg(&Picture::of_mesh(&mesh), &sheet(COLUMN, None));
    let thin = svg.split("<path").find(|path| path.contains("stroke-width=\"0.12\"")).unwrap();
    assert_eq!(thin.matches('M').count(), n as usize - 1);
    assert!(!svg.contains("stroke-width=\"0.25\""));
}

#[test]
fn an_empty_and_a_flat_picture_are_finite() {
    let flat = MeshFile { points: vec![DVec3::ZERO; 3], triangles: vec![[0, 1, 2]], ..MeshFile::default() };
    let mut all = look();
    crate::render::look::Layer::ALL.into_iter().for_each(|layer| all.layers.set(layer, true));
    for mut picture in [Picture::default(), Picture::of_mesh(&flat)] {
        let (at, legs) = (DVec2::ZERO, [DVec2::ZERO; 2]);
        picture.marks = vec![
            Mark::Letter { at, from: at, letter: 'A' },
            Mark::Arc { at, legs, text: "0°".to_owned(), always: true },
            Mark::Beside { ends: legs, text: "1".to_owned() },
            Mark::Wedge { at, legs },
        ];
        let sheet = Sheet { look: all, ..sheet(COLUMN, None) };
        for svg in [svg(&picture, &sheet), strip_svg(std::slice::from_ref(&picture), &sheet)] {
            let drawn = svg.split("</style>").last().unwrap();
            assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "{drawn}");
        }
    }
}

#[test]
fn labels_that_would_cover_each_other_or_leave_the_page_are_left_out() {
    let mut picture = Picture::of_mesh(&triangle());
    let beside =
        |x: f64| Mark::Beside { ends: [DVec2::new(x, 0.2), DVec2::new(x + 0.5, 0.2)], text: "0.0253".to_owned() };
    picture.marks = vec![beside(0.1), beside(0.101), beside(0.102), beside(5.0)];
    let svg = svg(&picture, &sheet(202.0, None));
    assert_eq!(svg.matches(">0.0253</text>").count(), 2, "one on each side of the line, and no third");
}

#[test]
fn a_part_is_clipped_and_what_is_not_in_it_is_not_written() {
    let mut mesh = triangle();
    mesh.points.extend([DVec3::new(9.0, 9.0, 0.0), DVec3::new(10.0, 9.0, 0.0), DVec3::new(9.0, 10.0, 0.0)]);
    mesh.triangles.push([3, 4, 5]);
    let mut look = look();
    look.part = Some(FigurePart { centre: DVec2::new(0.5, 0.5), height: 1.0 });
    let svg = svg(&Picture::of_mesh(&mesh), &Sheet { look, ..sheet(100.0, Some(100.0)) });
    assert!(svg.contains("clip-path=\"url(#part0)\"") && svg.contains("M0 100L100 100L0 0Z"), "{svg}");
    let fill = svg.split("<path").skip(1).find(|path| path.contains("fill=\"#FFFFFF\"")).unwrap();
    assert_eq!(fill.matches('Z').count(), 1);
}

#[test]
fn the_ground_can_be_left_out_and_the_run_is_carried() {
    let mut look = look();
    look.transparent = true;
    let sheet = Sheet { run: Some("run = \"<&>\"\n"), look, ..sheet(100.0, None) };
    let svg = svg(&Picture::of_mesh(&triangle()), &sheet);
    assert!(!svg.contains("<rect"), "{svg}");
    assert_eq!(crate::core::record::figure::text_in(svg.as_bytes()).unwrap().trim_start(), "run = \"<&>\"\n");
}
