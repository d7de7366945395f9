//! Writes and reads the docks: names of panels in tabs, rows and columns with their shares. What was written before a
//! panel existed, or with one that is gone, stays as the user has arranged it: a panel that is missing comes to those
//! that it is with in the first arrangement.

use std::collections::BTreeSet;

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};
use serde_json::{Value, json};

use super::{Column, Pane};

/// The greatest depth of nested docks.
const DEPTH: usize = 12;

/// The docks as a value.
pub fn write(tree: &Tree<Pane>) -> Value {
    tree.root().map_or(Value::Null, |root| write_tile(&tree.tiles, root))
}

fn write_tile(tiles: &Tiles<Pane>, id: TileId) -> Value {
    match tiles.get(id) {
        Some(Tile::Pane(pane)) => json!(pane.name()),
        Some(Tile::Container(Container::Tabs(tabs))) => {
            let active = tabs.children.iter().position(|child| Some(*child) == tabs.active);
            let children: Vec<Value> = tabs.children.iter().map(|child| write_tile(tiles, *child)).collect();
            json!({ "tabs": children, "active": active })
        }
        Some(Tile::Container(Container::Linear(linear))) => {
            let share = |id: &TileId| linear.shares.iter().find(|share| share.0 == id).map_or(1.0, |share| *share.1);
            // A splitter is at the same pixel when they are read.
            let shares: Vec<f64> = linear.children.iter().map(|id| f64::from(share(id))).collect();
            let children: Vec<Value> = linear.children.iter().map(|child| write_tile(tiles, *child)).collect();
            let name = if linear.dir == LinearDir::Horizontal { "row" } else { "column" };
            json!({ name: children, "shares": shares })
        }
        // A grid becomes tabs: nothing is lost but the arrangement.
        Some(Tile::Container(Container::Grid(grid))) => {
            let children: Vec<Value> = grid.children().map(|child| write_tile(tiles, *child)).collect();
            json!({ "tabs": children, "active": 0 })
        }
        None => Value::Null,
    }
}

/// The docks of a value with all panels, and the tile with the main view; none if no docks are in it. `columns` is the
/// first arrangement, by which panels that are missing find their place.
pub fn read(value: &Value, columns: &[Column]) -> Option<(Tree<Pane>, TileId)> {
    let mut seen = BTreeSet::new();
    let mut docks = value.is_object().then(|| Dock::read(value, 0, &mut seen))??;
    for pane in columns.iter().flat_map(Column::panes).filter(|pane| !seen.contains(pane)).collect::<Vec<_>>() {
        let (beside, is_after) = company(pane, columns).find(|(other, _)| seen.contains(other))?;
        docks.insert(pane, beside, is_after);
        seen.insert(pane);
    }
    let mut tiles = Tiles::default();
    let root = docks.place(&mut tiles);
    let space = tiles.iter().find(|(_, tile)| matches!(tile, Tile::Pane(Pane::Space))).map(|(id, _)| *id)?;
    // The column of the main view is the one below the root.
    let mut middle = space;
    while let Some(parent) = tiles.parent_of(middle).filter(|parent| *parent != root) {
        middle = parent;
    }
    Some((Tree::new(eframe::egui::Id::unique("docks"), root, tiles), middle))
}

/// The panels that a panel is with in the first arrangement, the nearest ones first, each with whether the panel comes
/// after it: those of its tabs, of its column, and all others.
fn company(pane: Pane, columns: &[Column]) -> impl Iterator<Item = (Pane, bool)> {
    let column = columns.iter().find(|column| column.panes().any(|other| other == pane));
    let tabs = column.and_then(|column| column.groups.iter().find(|group| group.0.contains(&pane)));
    let tabs: &[Pane] = tabs.map_or(&[], |group| &group.0);
    let at = tabs.iter().position(|other| *other == pane).unwrap_or(tabs.len());
    let before = tabs[..at].iter().rev().map(|other| (*other, true));
    let after = tabs[at..].iter().skip(1).map(|other| (*other, false));
    let far = column.into_iter().chain(columns).flat_map(Column::panes).map(|other| (other, true));
    before.chain(after).chain(far)
}

/// Docks, before they are tiles.
enum Dock {
    Pane(Pane),
    /// With the index of the one that is seen.
    Tabs(Vec<Dock>, usize),
    /// Each with its share.
    Line(LinearDir, Vec<(Dock, f32)>),
}

impl Dock {
    /// The docks of a value without what is unknown, empty, or there a second time; none if nothing is left.
    fn read(value: &Value, depth: usize, seen: &mut BTreeSet<Pane>) -> Option<Dock> {
        if let Some(name) = value.as_str() {
            let pane = Pane::ALL.into_iter().find(|pane| pane.name() == name)?;
            return seen.insert(pane).then_some(Dock::Pane(pane));
        }
        let fields = value.as_object().filter(|_| depth < DEPTH)?;
        let list = |name: &str| fields.get(name).and_then(Value::as_array);
        let mut children = |list: &[Value]| -> Vec<(usize, Dock)> {
            let child = |(k, child)| Some((k, Dock::read(child, depth + 1, seen)?));
            list.iter().enumerate().filter_map(child).collect()
        };
        if let Some(tabs) = list("tabs") {
            let children = children(tabs);
            let active = fields.get("active").and_then(Value::as_u64);
            let active = children.iter().position(|(k, _)| Some(*k as u64) == active).unwrap_or(0);
            let docks: Vec<Dock> = children.into_iter().map(|(_, dock)| dock).collect();
            return (!docks.is_empty()).then_some(Dock::Tabs(docks, active));
        }
        let (dir, line) = match list("row") {
            Some(row) => (LinearDir::Horizontal, row),
            None => (LinearDir::Vertical, list("column")?),
        };
        let share = |k: usize| {
            let share =
                list("shares").and_then(|shares| shares.get(k)).and_then(Value::as_f64).map(|share| share as f32);
            share.filter(|share| share.is_finite() && *share > 0.0)
        };
        // One without a share of its own is as wide as the others.
        let known: Vec<f32> = (0..line.len()).filter_map(share).collect();
        let usual = if known.is_empty() { 1.0 } else { known.iter().sum::<f32>() / known.len() as f32 };
        let docks: Vec<_> = children(line).into_iter().map(|(k, dock)| (dock, share(k).unwrap_or(usual))).collect();
        (!docks.is_empty()).then_some(Dock::Line(dir, docks))
    }

    /// Adds a panel to the tabs of another one, before or after it, without showing it. Returns whether the other one
    /// was found.
    fn insert(&mut self, pane: Pane, beside: Pane, is_after: bool) -> bool {
        match self {
            Dock::Pane(own) if *own == beside => {
                let own = Dock::Pane(*own);
                let (tabs, active) =
                    if is_after { (vec![own, Dock::Pane(pane)], 0) } else { (vec![Dock::Pane(pane), own], 1) };
                *self = Dock::Tabs(tabs, active);
                true
            }
            Dock::Pane(_) => false,
            Dock::Tabs(tabs, active) => {
                let own = tabs.iter().position(|tab| matches!(tab, Dock::Pane(own) if *own == beside));
                let Some(own) = own else { return tabs.iter_mut().any(|tab| tab.insert(pane, beside, is_after)) };
                let at = own + usize::from(is_after);
                tabs.insert(at, Dock::Pane(pane));
                *active += usize::from(at <= *active);
                true
            }
            Dock::Line(_, docks) => docks.iter_mut().any(|(dock, _)| dock.insert(pane, beside, is_after)),
        }
    }

    /// Makes tiles of them.
    fn place(self, tiles: &mut Tiles<Pane>) -> TileId {
        match self {
            Dock::Pane(pane) => tiles.insert_pane(pane),
            Dock::Tabs(docks, active) => {
                let children: Vec<TileId> = docks.into_iter().map(|dock| dock.place(tiles)).collect();
                let mut tabs = Tabs::new(children);
                if let Some(child) = tabs.children.get(active).copied() {
                    tabs.set_active(child);
                }
                tiles.insert_container(Container::Tabs(tabs))
            }
            Dock::Line(dir, docks) => {
                let placed: Vec<_> = docks.into_iter().map(|(dock, share)| (dock.place(tiles), share)).collect();
                let mut linear = Linear::new(dir, placed.iter().map(|child| child.0).collect());
                placed.into_iter().for_each(|(child, share)| linear.shares.set_share(child, share));
                tiles.insert_container(Container::Linear(linear))
            }
        }
    }
}

#[cfg(test)]
mod tests;
