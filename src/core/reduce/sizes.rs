//! Simpler metrics: one size in place of formulas and layers, larger sizes, fewer digits.

use super::document::{Keys, Node};
use super::search::Search;
use crate::core::fault::Fault;

/// Sizes relative to the extent of the case that are tried in place of a metric, the coarsest first.
const FRACTIONS: [f64; 8] = [0.5, 0.25, 0.125, 0.0625, 0.03, 0.015, 0.008, 0.004];
/// Keys of metrics that can be left out, each with those that go with it.
const SPARE: [&[&str]; 7] =
    [&["h2", "h3", "g1", "g2", "g3"], &["h3", "g3"], &["g3"], &["g2", "g3"], &["g1", "g2", "g3"], &["along"], &["far"]];
/// Numbers of significant digits that are tried, the fewest first.
const DIGITS: [usize; 6] = [1, 2, 3, 4, 6, 9];

/// Simplifies the metric.
pub(super) fn reduce(search: &mut Search<'_>) -> Result<(), Fault> {
    if search.best.keys.has("metric") {
        one_size(search)?;
        spare_keys(search)?;
        helpers(search)?;
        curves(search)?;
    }
    coarser(search)
}

fn uniform(h: f64) -> Node {
    let text = |text: &str| Node::Text(text.to_owned());
    Node::Table(Keys(vec![("kind".to_owned(), text("uniform")), ("h".to_owned(), Node::number(h))]))
}

/// One size for all metrics, or for each that is not one size.
fn one_size(search: &mut Search<'_>) -> Result<(), Fault> {
    let is_uniform = |metric: &Keys| metric.word("kind") == "uniform";
    if search.best.keys.tables("metric").all(is_uniform) {
        return Ok(());
    }
    let sizes = FRACTIONS.map(|fraction| rounded(fraction * search.finding.extent, 2));
    for h in sizes {
        if search.offer(search.best.changed(|keys| keys.set("metric", Node::List(vec![uniform(h)]))))? {
            return Ok(());
        }
    }
    for term in 0..search.best.keys.list("metric").len() {
        if search.best.keys.tables("metric").nth(term).is_none_or(is_uniform) {
            continue;
        }
        for h in sizes {
            let draft = search.best.changed(|keys| {
                if let Some(Node::List(list)) = keys.get_mut("metric") {
                    list[term] = uniform(h);
                }
            });
            if search.offer(draft)? {
                break;
            }
        }
    }
    Ok(())
}

/// Leaves out keys of metrics that have a default.
fn spare_keys(search: &mut Search<'_>) -> Result<(), Fault> {
    for term in 0..search.best.keys.list("metric").len() {
        for spare in SPARE {
            if search.best.keys.tables("metric").nth(term).is_some_and(|metric| metric.has(spare[0])) {
                let draft = search.best.changed(|keys| {
                    let metric = keys.tables_mut("metric").nth(term);
                    metric.into_iter().for_each(|metric| spare.iter().for_each(|key| metric.remove(key)));
                });
                search.offer(draft)?;
            }
        }
    }
    Ok(())
}

/// Leaves out helper formulas.
fn helpers(search: &mut Search<'_>) -> Result<(), Fault> {
    for term in 0..search.best.keys.list("metric").len() {
        let metric = search.best.keys.tables("metric").nth(term);
        let Some(Node::Table(all)) = metric.and_then(|metric| metric.get("let")).cloned() else { continue };
        search.thin(all.0.len(), |base, kept| {
            let kept = Keys(kept.iter().map(|&i| all.0[i].clone()).collect());
            Some(base.changed(|keys| {
                let Some(metric) = keys.tables_mut("metric").nth(term) else { return };
                if kept.0.is_empty() { metric.remove("let") } else { metric.set("let", Node::Table(kept)) }
            }))
        })?;
    }
    Ok(())
}

/// Leaves out curves of boundary layers and distances.
fn curves(search: &mut Search<'_>) -> Result<(), Fault> {
    for term in 0..search.best.keys.list("metric").len() {
        let names = search.best.keys.tables("metric").nth(term).map_or(Vec::new(), |metric| metric.names("curves"));
        search.thin(names.len(), |base, kept| {
            let kept: Vec<&String> = kept.iter().map(|&i| &names[i]).collect();
            (!kept.is_empty()).then(|| {
                base.changed(|keys| {
                    let metric = keys.tables_mut("metric").nth(term);
                    metric.into_iter().for_each(|metric| metric.set("curves", Node::names(kept.iter().copied())));
                })
            })
        })?;
    }
    Ok(())
}

/// Larger sizes, as long as it still shows and they are smaller than the case.
fn coarser(search: &mut Search<'_>) -> Result<(), Fault> {
    for term in 0..search.best.keys.list("metric").len() {
        for factor in [4.0, 2.0, 1.5, 1.2] {
            loop {
                let metric = search.best.keys.tables("metric").nth(term).filter(|m| m.word("kind") == "uniform");
                let Some(h) = metric.and_then(|metric| metric.get("h")).and_then(Node::value) else { break };
                let larger = rounded(h * factor, 2);
                let draft = search.best.changed(|keys| {
                    let metric = keys.tables_mut("metric").nth(term);
                    metric.into_iter().for_each(|metric| metric.set("h", Node::number(larger)));
                });
                if larger > search.finding.extent || !search.offer(draft)? {
                    break;
                }
            }
        }
    }
    Ok(())
}

/// Fewer digits of all coordinates and sizes.
pub(super) fn shorten_numbers(search: &mut Search<'_>) -> Result<(), Fault> {
    for digits in DIGITS {
        let draft = search.best.changed(|keys| {
            for key in ["surface", "curve", "metric", "background"] {
                keys.get_mut(key).into_iter().for_each(|node| shorten(node, digits));
            }
        });
        if search.offer(draft)? {
            return Ok(());
        }
    }
    Ok(())
}

fn shorten(node: &mut Node, digits: usize) {
    match node {
        // Whole numbers may be counts, and are short.
        Node::Bare(text) if text.contains(['.', 'e', 'E']) => {
            if let Some(value) = node.value() {
                *node = Node::number(rounded(value, digits));
            }
        }
        Node::List(list) => list.iter_mut().for_each(|node| shorten(node, digits)),
        Node::Table(keys) => keys.0.iter_mut().for_each(|(_, node)| shorten(node, digits)),
        Node::Text(_) | Node::Bare(_) => {}
    }
}

/// A number with this many significant digits.
fn rounded(x: f64, digits: usize) -> f64 {
    format!("{x:.*e}", digits.saturating_sub(1)).parse().unwrap_or(x)
}
