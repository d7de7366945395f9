//! Writes and reads the docks: names of panels in tabs, rows and columns with their shares.

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};
use serde_json::{Value, json};

use super::Pane;

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

/// The docks of a value, and the tile with the main view; none if the value has another form, or a panel is missing or
/// occurs twice.
pub fn read(value: &Value) -> Option<(Tree<Pane>, TileId)> {
    let mut tiles = Tiles::default();
    let root = read_tile(&mut tiles, value, 0)?;
    let mut panes: Vec<Pane> = tiles
        .tiles()
        .filter_map(|tile| match tile {
            Tile::Pane(pane) => Some(*pane),
            Tile::Container(_) => None,
        })
        .collect();
    panes.sort_unstable();
    if panes != Pane::ALL {
        return None;
    }
    let space = tiles.iter().find(|(_, tile)| matches!(tile, Tile::Pane(Pane::Space))).map(|(id, _)| *id)?;
    // The column of the main view is the one below the root.
    let mut middle = space;
    while let Some(parent) = tiles.parent_of(middle).filter(|parent| *parent != root) {
        middle = parent;
    }
    Some((Tree::new(eframe::egui::Id::unique("docks"), root, tiles), middle))
}

fn read_tile(tiles: &mut Tiles<Pane>, value: &Value, depth: usize) -> Option<TileId> {
    if let Some(name) = value.as_str() {
        let pane = Pane::ALL.into_iter().find(|pane| pane.name() == name)?;
        return Some(tiles.insert_pane(pane));
    }
    let fields = value.as_object().filter(|_| depth < DEPTH)?;
    let mut children = |name: &str| -> Option<Vec<TileId>> {
        let list = fields.get(name)?.as_array().filter(|list| !list.is_empty())?;
        list.iter().map(|child| read_tile(tiles, child, depth + 1)).collect()
    };
    if let Some(children) = children("tabs") {
        let mut tabs = Tabs::new(children);
        let active = fields.get("active").and_then(Value::as_u64).unwrap_or(0) as usize;
        if let Some(child) = tabs.children.get(active).copied() {
            tabs.set_active(child);
        }
        return Some(tiles.insert_container(Container::Tabs(tabs)));
    }
    let (dir, children) = match children("row") {
        Some(children) => (LinearDir::Horizontal, children),
        None => (LinearDir::Vertical, children("column")?),
    };
    let shares = fields.get("shares")?.as_array()?;
    let shares: Vec<f32> = shares.iter().filter_map(Value::as_f64).map(|share| share as f32).collect();
    if shares.len() != children.len() || shares.iter().any(|share| !share.is_finite() || *share <= 0.0) {
        return None;
    }
    let mut linear = Linear::new(dir, children.clone());
    for (child, share) in children.into_iter().zip(shares) {
        linear.shares.set_share(child, share);
    }
    Some(tiles.insert_container(Container::Linear(linear)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn docks_are_read_as_they_were_written_and_what_is_none_is_refused() {
        let names: Vec<&str> = Pane::ALL[1..].iter().map(|pane| pane.name()).collect();
        let first = Pane::ALL[0].name();
        let value = json!({ "row": [{ "tabs": [first], "active": 0 }, { "tabs": names, "active": 2 }], "shares": [344.0, 900.0] });
        let (tree, _) = read(&value).unwrap();
        assert_eq!(write(&tree), value);
        for bad in [
            json!(null),
            json!("Inspector"),
            json!({ "tabs": [] }),
            json!({ "row": [first, { "tabs": names }], "shares": [1.0] }),
            json!({ "row": [first, { "tabs": names }], "shares": [1.0, -1.0] }),
            json!({ "row": [first, first, { "tabs": names }], "shares": [1.0, 1.0, 1.0] }),
            json!({ "row": ["No such panel", { "tabs": names }], "shares": [1.0, 1.0] }),
        ] {
            assert!(read(&bad).is_none(), "{bad}");
        }
    }
}
