//! Parts of a case that can be left out: edits, parameters, options, faces, holes, lines inside, metrics, and whatever
//! nothing names any more.

use std::collections::BTreeSet;

use super::document::{Keys, Node};
use super::draft::Draft;
use super::edits;
use super::search::Search;
use crate::core::fault::Fault;

/// Keys of a case that have a default.
pub(super) const OPTIONS: [&str; 13] = [
    "gradation",
    "corner_angle",
    "tolerance",
    "chord",
    "least_segments",
    "symmetry",
    "split_odd",
    "ignore_groups",
    "use",
    "feature_angle",
    "chart_stretch",
    "scale",
    "weld",
];

/// The lists of curves within a face that can be left out one by one.
const WITHIN: [&str; 3] = ["holes", "cracks", "repeated"];

impl Draft {
    /// The draft after a change of its keys, without what nothing names any more.
    pub(super) fn changed(&self, change: impl FnOnce(&mut Keys)) -> Draft {
        let mut draft = self.clone();
        change(&mut draft.keys);
        tidy(&mut draft.keys);
        draft
    }
}

/// Leaves out what it can.
pub(super) fn reduce(search: &mut Search<'_>) -> Result<(), Fault> {
    edits::reduce(search)?;
    reduce_list(search, "face")?;
    within_faces(search)?;
    reduce_list(search, "point")?;
    reduce_list(search, "metric")?;
    options(search)?;
    parameters(search)
}

/// Leaves out tables of `[[key]]`.
fn reduce_list(search: &mut Search<'_>, key: &str) -> Result<(), Fault> {
    let count = search.best.keys.list(key).len();
    search.thin(count, |base, kept| Some(base.changed(|keys| keys.filter(key, |i, _| kept.contains(&i)))))
}

/// Leaves out holes, cracks and repeated lines of all faces.
fn within_faces(search: &mut Search<'_>) -> Result<(), Fault> {
    let mut parts = Vec::new();
    for (face, keys) in search.best.keys.tables("face").enumerate() {
        for key in WITHIN {
            parts.extend((0..keys.list(key).len()).map(|i| (face, key, i)));
        }
    }
    search.thin(parts.len(), |base, kept| {
        let kept: BTreeSet<_> = kept.iter().map(|&i| parts[i]).collect();
        Some(base.changed(|keys| {
            for (face, keys) in keys.tables_mut("face").enumerate() {
                WITHIN.iter().for_each(|key| keys.filter(key, |i, _| kept.contains(&(face, *key, i))));
            }
        }))
    })
}

/// Takes back options to their defaults.
fn options(search: &mut Search<'_>) -> Result<(), Fault> {
    let set: Vec<&str> = OPTIONS.into_iter().filter(|key| search.best.keys.has(key)).collect();
    search.thin(set.len(), |base, kept| {
        let dropped = (0..set.len()).filter(|i| !kept.contains(i));
        Some(base.changed(|keys| dropped.for_each(|i| keys.remove(set[i]))))
    })
}

/// Takes back parameters to their defaults.
fn parameters(search: &mut Search<'_>) -> Result<(), Fault> {
    let Some(Node::Table(set)) = search.best.keys.get("parameters").cloned() else { return Ok(()) };
    search.thin(set.0.len(), |base, kept| {
        let kept = Keys(kept.iter().map(|&i| set.0[i].clone()).collect());
        Some(base.changed(|keys| keys.set("parameters", Node::Table(kept))))
    })
}

/// Removes what nothing names any more: curves, surfaces, names in metrics and parameters.
pub(super) fn tidy(keys: &mut Keys) {
    let faces: BTreeSet<String> = keys.tables("face").map(|face| face.word("name").to_owned()).collect();
    let mut surfaces: BTreeSet<String> = keys.tables("face").map(|face| face.word("surface").to_owned()).collect();
    let mut curves: BTreeSet<String> = BTreeSet::new();
    for face in keys.tables("face") {
        for key in ["outer", "cracks", "repeated"] {
            curves.extend(face.names(key));
        }
        curves.extend(face.list("holes").iter().flat_map(Node::items).filter_map(Node::text).map(str::to_owned));
    }
    // A surface may be swept by a curve, and a curve lie on a surface that no face has.
    loop {
        let before = (curves.len(), surfaces.len());
        let used = keys.tables("surface").filter(|surface| surfaces.contains(surface.word("name")));
        curves.extend(used.map(|surface| surface.word("curve").to_owned()));
        let used = keys.tables("curve").filter(|curve| curves.contains(curve.word("name")));
        surfaces.extend(used.map(|curve| curve.word("on").to_owned()));
        if before == (curves.len(), surfaces.len()) {
            break;
        }
    }
    let is_used =
        |names: &BTreeSet<String>, node: &Node| node.table().is_some_and(|table| names.contains(table.word("name")));
    keys.filter("curve", |_, node| is_used(&curves, node));
    keys.filter("surface", |_, node| is_used(&surfaces, node));
    let named: Vec<bool> = keys.tables("metric").map(|metric| metric.has("curves")).collect();
    keys.tables_mut("metric").for_each(|metric| metric.only_names("curves", &curves));
    keys.filter("metric", |i, node| !named[i] || node.table().is_some_and(|metric| metric.has("curves")));
    if let Some(Node::Table(parameters)) = keys.get_mut("parameters") {
        parameters.only_names("layered_loops", &curves);
        parameters.only_names("faces", &faces);
        if parameters.0.is_empty() {
            keys.remove("parameters");
        }
    }
}
