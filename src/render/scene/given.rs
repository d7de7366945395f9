//! An imported surface before it becomes a mesh: its triangles in the colours of their charts, features and seams as
//! lines, and the elements that cause a refusal.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::form::folded;
use super::{Dot, Face, Form, Line, Scene, relative};
use crate::core::discrete::{Division, Edges, Feature, Triangles};
use crate::core::progress::Cancel;
use crate::render::palette::{Palette, Rgba};

/// The surface, and how to draw it.
#[derive(Clone, Copy)]
pub struct Given<'a> {
    /// Its triangles.
    pub mesh: &'a Triangles,
    /// Their edges.
    pub edges: &'a Edges,
    /// The kind of feature of each edge.
    pub features: &'a [Option<Feature>],
    /// Its charts, once they are known.
    pub division: Option<&'a Division>,
    /// Highlighted elements, the cause of a refusal, by their corners: points, edges, triangles and polygons.
    pub marks: &'a [Vec<DVec3>],
    /// The colours.
    pub palette: &'a Palette,
}

/// The share of the error colour in highlighted triangles.
const MARKED: f32 = 0.55;

/// Triangles and edges between two checks for cancellation.
const AT_A_TIME: usize = 1 << 14;

/// Colour and width in points of a feature: the width distinguishes the kinds; defects also have the colour of errors.
pub fn feature_line(palette: &Palette, kind: Feature) -> (Rgba, f32) {
    match kind {
        Feature::Fold => (palette.boundary, 1.75),
        Feature::Region | Feature::Line => (palette.boundary, 2.4),
        Feature::Boundary => (palette.boundary, 3.2),
        Feature::Branching => (palette.front[1], 3.2),
        Feature::Conflict => (palette.broken, 3.2),
    }
}

/// The same of an edge at which a surface is cut only to flatten it.
pub fn seam_line(palette: &Palette) -> (Rgba, f32) {
    (palette.weak, 1.25)
}

/// The triangles that are highlighted or part of a highlighted shape; `None` where there are none.
fn marked(mesh: &Triangles, marks: &[Vec<DVec3>]) -> Vec<bool> {
    let key = |p: DVec3| p.to_array().map(f64::to_bits);
    let corners: Vec<BTreeSet<[u64; 3]>> =
        marks.iter().filter(|mark| mark.len() > 2).map(|mark| mark.iter().map(|&p| key(p)).collect()).collect();
    let mut at: BTreeMap<[u64; 3], Vec<usize>> = BTreeMap::new();
    for (mark, corners) in corners.iter().enumerate() {
        corners.iter().for_each(|&corner| at.entry(corner).or_default().push(mark));
    }
    if at.is_empty() {
        return Vec::new();
    }
    let is_marked = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(key);
        let of = |mark: &usize| corners[*mark].contains(&b) && corners[*mark].contains(&c);
        at.get(&a).is_some_and(|marks| marks.iter().any(of))
    };
    (0..mesh.triangles.len()).map(is_marked).collect()
}

impl Scene {
    /// The scene of an imported surface; `None` where cancelled. `generation` must exceed that of all such scenes sent
    /// to the card before.
    pub fn of_given(given: &Given<'_>, generation: u64, cancel: &Cancel) -> Option<Scene> {
        let Given { mesh, edges, features, division, marks, palette } = *given;
        let go_on = |k: usize| !k.is_multiple_of(AT_A_TIME) || !cancel.is_asked();
        let ends = mesh.points.iter().map(|&p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let [low, high] = ends.unwrap_or([DVec3::ZERO; 2]);
        let mut scene = Scene { anchor: 0.5 * (low + high), generation, form: Form::Given, ..Scene::default() };
        scene.pieces = 1;
        let at = |k: u32| relative(mesh.points[k as usize], scene.anchor);
        let fill = |t: usize| match division {
            Some(division) => {
                let number = division.colour[division.chart_of[t] as usize] as usize;
                palette.charts[number % palette.charts.len()]
            }
            None => palette.live,
        };
        let marked = marked(mesh, marks);
        let fill =
            |t: usize| if marked.get(t) == Some(&true) { fill(t).mixed(palette.broken, MARKED) } else { fill(t) };
        let mut faces = Vec::with_capacity(mesh.triangles.len());
        for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
            if !go_on(t) {
                return None;
            }
            let normal = folded(mesh.area_vector(t).normalize_or(DVec3::Z));
            faces.push(Face { corners: [at(a), at(b), at(c), at(c)], normals: [normal; 4], colour: fill(t).packed() });
        }
        let line = |[a, b]: [u32; 2], (colour, width): (Rgba, f32), room: f32| Line {
            ends: [at(a), at(b)],
            colour: colour.packed(),
            width,
            room,
            ..Line::default()
        };
        let (mut plain, mut standing_out) = (Vec::with_capacity(edges.len()), Vec::new());
        let mut seams = division.map_or(&[][..], |division| &division.seams).iter().peekable();
        for edge in 0..edges.len() {
            if !go_on(edge) {
                return None;
            }
            let (at, is_seam) = (edges.get(edge), seams.next_if(|seam| **seam as usize == edge).is_some());
            if let Some(kind) = features[edge] {
                standing_out.push((kind, line(at.ends, feature_line(palette, kind), -1.0)));
            } else if is_seam {
                plain.push(line(at.ends, seam_line(palette), -1.0));
            } else {
                let [p, q] = at.ends.map(|end| mesh.points[end as usize]);
                let height = |side: &u32| mesh.area_vector(*side as usize / 3).length() / p.distance(q);
                let room = at.sides.iter().map(height).fold(f64::INFINITY, f64::min);
                plain.push(line(at.ends, (palette.live_edge, 0.75), room as f32));
            }
        }
        // Defects are drawn over the rest.
        standing_out.sort_by_key(|(kind, _)| std::cmp::Reverse(*kind == Feature::Fold));
        let standing_out: Vec<Line> = standing_out.into_iter().map(|(_, line)| line).collect();
        let (mut outlines, mut dots) = (Vec::new(), Vec::new());
        for mark in marks {
            let corners: Vec<[f32; 3]> = mark.iter().map(|&p| relative(p, scene.anchor)).collect();
            let sides = match corners.len() {
                n @ (1 | 2) => n - 1,
                n => n,
            };
            let colour = palette.broken.packed();
            outlines.extend((0..sides).map(|k| {
                let ends = [corners[k], corners[(k + 1) % corners.len()]];
                Line { ends, colour, width: 3.2, dash: [0.0; 2], room: -1.0 }
            }));
            if let [at] = corners[..] {
                let (ring, ring_width) = (palette.ground.packed(), 1.5);
                dots.push(Dot { at, radius: 6.5, fill: colour, ring, ring_width, room: 1.0, least: 0.0 });
            }
        }
        scene.over.replace(&outlines, generation);
        scene.over_dots.replace(&dots, generation);
        scene.faces.replace(&faces, generation);
        scene.edges.replace(&plain, generation);
        scene.boundary.replace(&standing_out, generation);
        Some(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::discrete::StretchBound;
    use crate::core::discrete::chart::charts;
    use crate::core::discrete::features::{ANGLE, features};
    use crate::core::progress::Nobody;
    use crate::core::soup::MeshFile;
    use crate::render::palette::{DARK, LIGHT};

    /// A tent: two squares with a fold between them.
    fn tent() -> Triangles {
        let file = MeshFile {
            points: [0.0, 1.0]
                .into_iter()
                .flat_map(|y| [(0.0, y, 0.0), (1.0, y, 1.0), (2.0, y, 0.0)].map(DVec3::from))
                .collect(),
            quads: vec![[0, 1, 4, 3], [1, 2, 5, 4]],
            ..MeshFile::default()
        };
        crate::core::discrete::repair::repair(&file, None, &mut Nobody).unwrap().mesh
    }

    #[test]
    fn charts_have_colours_of_their_own_and_features_lines_that_never_fade() {
        let mesh = tent();
        let edges = Edges::of(&mesh.triangles);
        let found = features(&mesh, &edges, ANGLE);
        let charts = charts(&mesh, &edges, &found, StretchBound::default(), &mut Nobody).unwrap();
        let division = Division::of(&mesh, &edges, &found, &charts);
        let draw = |division, palette| {
            let given = Given { mesh: &mesh, edges: &edges, features: &found, division, marks: &[], palette };
            Scene::of_given(&given, 7, &Cancel::default()).unwrap()
        };
        let colours = |scene: &Scene| {
            let mut colours: Vec<u32> = scene.faces.items().iter().map(|face| face.colour).collect();
            colours.sort_unstable();
            colours.dedup();
            colours
        };
        let scene = draw(Some(&division), &DARK);
        assert_eq!((scene.faces.items().len(), colours(&scene).len()), (4, 2));
        assert_eq!(colours(&draw(None, &LIGHT)), [LIGHT.live.packed()]);
        let widths: Vec<f32> = scene.boundary.items().iter().map(|line| line.width).collect();
        assert_eq!(widths.iter().filter(|width| **width == 1.75).count(), 1, "the ridge");
        assert_eq!(widths.len(), 7);
        assert!(scene.boundary.items().iter().all(|line| line.room < 0.0));
        assert_eq!(scene.edges.items().len(), 2, "the diagonals");
    }

    #[test]
    fn what_is_marked_stands_out_in_the_colour_of_errors() {
        let mesh = tent();
        let edges = Edges::of(&mesh.triangles);
        let found = features(&mesh, &edges, ANGLE);
        let [a, b, c] = mesh.corners(0);
        let marks = [vec![b, c, a], vec![a, b], vec![c]];
        let given =
            Given { mesh: &mesh, edges: &edges, features: &found, division: None, marks: &marks, palette: &DARK };
        let scene = Scene::of_given(&given, 1, &Cancel::default()).unwrap();
        let plain = DARK.live.packed();
        let other: Vec<bool> = scene.faces.items().iter().map(|face| face.colour != plain).collect();
        assert_eq!(other, [true, false, false, false]);
        assert_eq!((scene.over.items().len(), scene.over_dots.items().len()), (3 + 1, 1));
        assert!(scene.over.items().iter().all(|line| line.colour == DARK.broken.packed()));
    }

    #[test]
    fn a_scene_that_nobody_wants_any_more_is_not_made() {
        let mesh = tent();
        let edges = Edges::of(&mesh.triangles);
        let found = features(&mesh, &edges, ANGLE);
        let cancel = Cancel::new();
        cancel.ask();
        let given = Given { mesh: &mesh, edges: &edges, features: &found, division: None, marks: &[], palette: &DARK };
        assert!(Scene::of_given(&given, 1, &cancel).is_none());
    }
}
