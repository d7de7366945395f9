//! Simpler curves: fewer corners, chords in place of arcs and splines, a rectangle in place of an outer loop.

use glam::DVec2;

use super::corners::{chained, loop_of, loops, plane_curves};
use super::document::{Keys, Node};
use super::search::Search;
use crate::core::fault::Fault;
use crate::core::kernel::box_tree::extent;

/// Numbers of corners of the polygon that replaces a closed spline.
const CORNERS: [usize; 2] = [4, 8];
/// Room around the holes when the outer loop becomes a rectangle, relative to their extent.
const ROOM: [f64; 3] = [0.5, 1.0, 2.0];

/// Simplifies the curves.
pub(super) fn reduce(search: &mut Search<'_>) -> Result<(), Fault> {
    outer_rectangle(search)?;
    corners_of_loops(search)?;
    chords(search)?;
    corners_of_polylines(search)?;
    fixed_counts(search)
}

fn table_of<'k>(keys: &'k mut Keys, name: &str) -> Option<&'k mut Keys> {
    keys.tables_mut("curve").find(|curve| curve.word("name") == name)
}

/// Replaces the shape of a curve.
fn reshape(keys: &mut Keys, name: &str, shape: Vec<(&str, Node)>) {
    if let Some(table) = table_of(keys, name) {
        *table = Keys(vec![("name".to_owned(), Node::Text(name.to_owned()))]);
        shape.into_iter().for_each(|(key, node)| table.set(key, node));
    }
}

fn kind(kind: &str) -> (&'static str, Node) {
    ("kind", Node::Text(kind.to_owned()))
}

fn segment(from: DVec2, to: DVec2) -> Vec<(&'static str, Node)> {
    let point = |p: DVec2| Node::point(&p.to_array());
    vec![kind("segment"), ("from", point(from)), ("to", point(to))]
}

fn polygon(points: &[DVec2]) -> Vec<(&'static str, Node)> {
    let points = points.iter().map(|p| Node::point(&p.to_array())).collect();
    vec![kind("polyline"), ("points", Node::List(points)), ("closed", Node::Bare("true".to_owned()))]
}

/// Makes the outer loop of a face a rectangle around its holes and the lines inside, where no other face has its
/// curves.
fn outer_rectangle(search: &mut Search<'_>) -> Result<(), Fault> {
    for face in 0..search.best.keys.list("face").len() {
        let curves = plane_curves(&search.best);
        let Some(keys) = search.best.keys.tables("face").nth(face).cloned() else { continue };
        let outer = keys.names("outer");
        let Some(name) = outer.first().filter(|_| outer.iter().all(|name| uses(&search.best.keys, name) == 1)) else {
            continue;
        };
        let holes = keys.list("holes").iter().flat_map(Node::items).filter_map(Node::text).map(str::to_owned);
        let inside = holes.chain(keys.names("cracks")).chain(keys.names("repeated"));
        let points: Vec<DVec2> =
            inside.filter_map(|name| curves.get(&name)).flat_map(|c| c.polyline(f64::INFINITY)).map(|p| p.1).collect();
        let (low, high) = extent(points.iter().copied());
        let size = (high - low).max_element();
        if points.is_empty() || size <= 0.0 {
            continue;
        }
        for room in ROOM {
            let room = DVec2::splat(room * size);
            let (a, c) = (low - room, high + room);
            let corners = [a, DVec2::new(c.x, a.y), c, DVec2::new(a.x, c.y)];
            let draft = search.best.changed(|keys| {
                reshape(keys, name, polygon(&corners));
                if let Some(face) = keys.tables_mut("face").nth(face) {
                    face.set("outer", Node::names([name]));
                }
            });
            if search.offer(draft)? {
                break;
            }
        }
    }
    Ok(())
}

/// How often the faces name a curve.
fn uses(keys: &Keys, name: &str) -> usize {
    let is_it = |node: &&Node| node.text() == Some(name);
    let of = |face: &Keys| {
        let flat: usize =
            ["outer", "cracks", "repeated"].iter().map(|k| face.list(k).iter().filter(is_it).count()).sum();
        flat + face.list("holes").iter().flat_map(Node::items).filter(is_it).count()
    };
    keys.tables("face").map(of).sum()
}

/// Joins curves that follow one another in a loop into straight segments.
fn corners_of_loops(search: &mut Search<'_>) -> Result<(), Fault> {
    for (face, hole) in loops(&search.best.keys) {
        let curves = plane_curves(&search.best);
        let Some(names) = search.best.keys.tables("face").nth(face).map(|face| loop_of(face, hole)) else { continue };
        let Some(chain) = chained(&names, &curves) else { continue };
        if names.len() < 3 || names.iter().any(|name| uses(&search.best.keys, name) != 1) {
            continue;
        }
        // Corner i is where curve i begins.
        search.thin(chain.len(), |base, kept| {
            if kept.len() < 3 {
                return None;
            }
            let spans = kept.iter().zip(kept.iter().cycle().skip(1));
            let mut left = Vec::new();
            Some(base.changed(|keys| {
                for (&i, &j) in spans {
                    let name = &chain[i].0;
                    if (i + 1) % chain.len() != j {
                        reshape(keys, name, segment(chain[i].1, chain[j].1));
                    }
                    left.push(name.clone());
                }
                let Some(face) = keys.tables_mut("face").nth(face) else { return };
                let names = Node::names(&left);
                match (hole, face.get_mut("holes")) {
                    (None, _) => face.set("outer", names),
                    (Some(i), Some(Node::List(holes))) => holes[i] = names,
                    _ => {}
                }
            }))
        })?;
    }
    Ok(())
}

/// Replaces open arcs and splines by their chords, and closed splines by polygons.
fn chords(search: &mut Search<'_>) -> Result<(), Fault> {
    for (name, curve) in plane_curves(&search.best) {
        let is_spline = search.best.keys.tables("curve").any(|c| c.word("name") == name && c.word("kind") == "nurbs");
        if !is_spline && (curve.straight() || curve.closed()) {
            continue;
        }
        if !curve.closed() {
            let chord = segment(curve.point(0.0), curve.point(1.0));
            search.offer(search.best.changed(|keys| reshape(keys, &name, chord)))?;
            continue;
        }
        for count in CORNERS {
            let corners: Vec<DVec2> = (0..count).map(|i| curve.point(i as f64 / count as f64)).collect();
            if search.offer(search.best.changed(|keys| reshape(keys, &name, polygon(&corners))))? {
                break;
            }
        }
    }
    Ok(())
}

/// Leaves out corners of polylines; the ends of an open one stay.
fn corners_of_polylines(search: &mut Search<'_>) -> Result<(), Fault> {
    let polylines = search.best.keys.tables("curve").filter(|curve| curve.word("kind") == "polyline");
    let names: Vec<String> = polylines.map(|curve| curve.word("name").to_owned()).collect();
    for name in names {
        let Some(curve) = search.best.keys.tables("curve").find(|curve| curve.word("name") == name) else { continue };
        let points = curve.list("points").to_vec();
        let is_closed = curve.get("closed") == Some(&Node::Bare("true".to_owned())) && points.first() != points.last();
        let (first, count) = if is_closed { (0, points.len()) } else { (1, points.len().saturating_sub(2)) };
        let least = if is_closed || points.first() == points.last() { 3 } else { 2 };
        search.thin(count, |base, kept| {
            let inner = kept.iter().map(|&i| points[first + i].clone());
            let ends = |at: Option<&Node>| at.filter(|_| !is_closed).cloned().into_iter();
            let all: Vec<Node> = ends(points.first()).chain(inner).chain(ends(points.last())).collect();
            (all.len() >= least).then(|| {
                base.changed(|keys| {
                    if let Some(table) = table_of(keys, &name) {
                        table.set("points", Node::List(all));
                    }
                })
            })
        })?;
    }
    Ok(())
}

/// Leaves the numbers of segments to the metric.
fn fixed_counts(search: &mut Search<'_>) -> Result<(), Fault> {
    let fixed = search.best.keys.tables("curve").filter(|curve| curve.has("segments"));
    let names: Vec<String> = fixed.map(|curve| curve.word("name").to_owned()).collect();
    search.thin(names.len(), |base, kept| {
        let free = (0..names.len()).filter(|i| !kept.contains(i));
        Some(base.changed(|keys| {
            free.for_each(|i| {
                if let Some(table) = table_of(keys, &names[i]) {
                    table.remove("segments");
                }
            });
        }))
    })
}
