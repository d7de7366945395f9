//! Smaller meshes: fewer regions, pieces, rings and halves; fewer triangles by collapsed edges; single elements.

mod coarsen;
mod subset;

use glam::DVec3;

use self::subset::{Faces, subset};
use super::document::Node;
use super::draft::Draft;
use super::search::Search;
use crate::core::fault::Fault;
use crate::core::kernel::box_tree::extent;
use crate::core::soup::MeshFile;

/// Elements up to which single ones are left out.
const SINGLE: usize = 600;
/// Parts of a mesh that are cut off by a plane, the largest first.
const CUTS: [usize; 4] = [2, 4, 8, 16];
/// Digits of coordinates relative to the extent of the mesh, the fewest first.
const DIGITS: [i32; 4] = [2, 3, 4, 6];

/// Makes the mesh of a case smaller.
pub(super) fn reduce(search: &mut Search<'_>) -> Result<(), Fault> {
    if search.best.mesh().is_none() {
        return Ok(());
    }
    data(search)?;
    regions(search)?;
    pieces(search)?;
    rings(search)?;
    halves(search)?;
    pieces(search)?;
    coarsen::reduce(search)?;
    elements(search)?;
    coarsen::reduce(search)
}

/// Offers a change of the mesh of a draft.
fn changed(draft: &Draft, change: impl FnOnce(&mut MeshFile)) -> Option<Draft> {
    let mut mesh = draft.mesh()?.clone();
    change(&mut mesh);
    Some(draft.with_mesh(mesh))
}

fn offer(search: &mut Search<'_>, change: impl FnOnce(&mut MeshFile)) -> Result<bool, Fault> {
    match changed(&search.best, change) {
        Some(draft) => search.offer(draft),
        None => Ok(false),
    }
}

/// Leaves out what is not shape: the metric, lines, tags.
fn data(search: &mut Search<'_>) -> Result<(), Fault> {
    let Some(mesh) = search.best.mesh() else { return Ok(()) };
    let lines = mesh.lines.len();
    if mesh.metric.is_some() {
        offer(search, |mesh| mesh.metric = None)?;
    }
    if lines > 0 && !offer(search, |mesh| (mesh.lines, mesh.line_tags) = Default::default())? && lines <= SINGLE {
        search.thin(lines, |base, kept| {
            changed(base, |mesh| {
                mesh.lines = kept.iter().map(|&i| mesh.lines[i]).collect();
                mesh.line_tags = kept.iter().filter_map(|&i| mesh.line_tags.get(i).copied()).collect();
            })
        })?;
    }
    Ok(())
}

/// Leaves out regions: elements of one tag; and the tags themselves.
fn regions(search: &mut Search<'_>) -> Result<(), Fault> {
    by_number(search, Faces::tags)?;
    offer(search, |mesh| {
        (mesh.triangle_tags, mesh.quad_tags, mesh.polygon_tags) = Default::default();
        mesh.groups.retain(|group| group.dimension < 2);
    })?;
    Ok(())
}

/// Leaves out connected pieces.
fn pieces(search: &mut Search<'_>) -> Result<(), Fault> {
    by_number(search, Faces::pieces)
}

/// Leaves out elements of the same number, where there are several numbers.
fn by_number(search: &mut Search<'_>, number: impl Fn(&Faces) -> Vec<u32>) -> Result<(), Fault> {
    let Some(mesh) = search.best.mesh() else { return Ok(()) };
    let numbers = number(&Faces::of(mesh));
    let mut known = numbers.clone();
    known.sort_unstable();
    known.dedup();
    if known.len() < 2 {
        return Ok(());
    }
    search.thin(known.len(), |base, kept| {
        let kept: Vec<u32> = kept.iter().map(|&i| known[i]).collect();
        keeping(base, |face| kept.binary_search(&numbers[face]).is_ok())
    })
}

/// The draft with some of the elements of its mesh; `None` without any.
fn keeping(draft: &Draft, keep: impl Fn(usize) -> bool) -> Option<Draft> {
    let mesh = subset(draft.mesh()?, keep)?;
    Some(draft.with_mesh(mesh))
}

/// Keeps the elements around the place where it shows, ring by ring: the smallest ball first.
fn rings(search: &mut Search<'_>) -> Result<(), Fault> {
    let Some(mesh) = search.best.mesh() else { return Ok(()) };
    let places = &search.finding.places;
    if places.is_empty() {
        return Ok(());
    }
    let scale = search.best.keys.get("scale").and_then(Node::value).unwrap_or(1.0);
    let place = places.iter().sum::<DVec3>() / places.len() as f64 / scale;
    let order = Faces::of(mesh).rings(place);
    let mut count = 2;
    while count < order.len() {
        let mut is_kept = vec![false; order.len()];
        order[..count].iter().for_each(|&face| is_kept[face] = true);
        if let Some(draft) = keeping(&search.best, |face| is_kept[face])
            && search.offer(draft)?
        {
            return Ok(());
        }
        // Between powers of two there is another chance.
        count += (count / 4 * 2).max(2);
    }
    Ok(())
}

/// Cuts off halves along the axes, then smaller parts.
fn halves(search: &mut Search<'_>) -> Result<(), Fault> {
    for cut in CUTS {
        let mut was_cut = true;
        while was_cut {
            was_cut = false;
            for (axis, is_lower) in [(0, true), (0, false), (1, true), (1, false), (2, true), (2, false)] {
                let Some(mesh) = search.best.mesh() else { return Ok(()) };
                let order = Faces::of(mesh).along(axis);
                // An even number of triangles can be converted.
                let drop = (order.len() / cut).next_multiple_of(2);
                if drop >= order.len() {
                    continue;
                }
                let mut is_kept = vec![true; order.len()];
                let part = if is_lower { &order[..drop] } else { &order[order.len() - drop..] };
                part.iter().for_each(|&face| is_kept[face] = false);
                if let Some(draft) = keeping(&search.best, |face| is_kept[face]) {
                    was_cut |= search.offer(draft)?;
                }
            }
        }
    }
    Ok(())
}

/// Leaves out pairs of neighbours, then single elements.
fn elements(search: &mut Search<'_>) -> Result<(), Fault> {
    for pairs in [true, false] {
        let Some(mesh) = search.best.mesh() else { return Ok(()) };
        let faces = Faces::of(mesh);
        if faces.count() > SINGLE {
            return Ok(());
        }
        let groups = if pairs { faces.pairs() } else { (0..faces.count() as u32).collect() };
        let count = groups.iter().max().map_or(0, |most| *most as usize + 1);
        search.thin(count, |base, kept| keeping(base, |face| kept.binary_search(&(groups[face] as usize)).is_ok()))?;
    }
    Ok(())
}

/// Fewer digits of the coordinates.
pub(super) fn shorten_numbers(search: &mut Search<'_>) -> Result<(), Fault> {
    let Some(mesh) = search.best.mesh() else { return Ok(()) };
    let (low, high) = extent(mesh.points.iter().copied());
    let size = (high - low).max_element();
    if size.is_nan() || size <= 0.0 {
        return Ok(());
    }
    let exponent = libm::floor(libm::log10(size)) as i32;
    for digits in DIGITS {
        // The decimals are written, so that the number read is the shortest of its value.
        let decimals = (digits - 1 - exponent).clamp(0, 300) as usize;
        let rounded = |x: f64| format!("{x:.decimals$}").parse::<f64>().map_or(x, |x| x + 0.0);
        if offer(search, |mesh| {
            mesh.points.iter_mut().for_each(|p| *p = DVec3::from_array(p.to_array().map(rounded)));
        })? {
            return Ok(());
        }
    }
    Ok(())
}
