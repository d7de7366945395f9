//! The docks of the panels: side columns keep their widths in points, the view takes the rest.

mod docks;
mod written;

use std::collections::BTreeMap;

use eframe::egui::{self, Rect, Ui, Vec2};
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};
use serde_json::Value;

use super::command::Command;
use crate::core::kernel::worded::worded;
pub use docks::Docks;

/// Widths in points: front, lens, inspector; and the least width of the view.
const LEFT: f32 = 420.0;
const LENS: f32 = 263.0;
const RIGHT: f32 = 332.0;
const VIEW: f32 = 404.0;
/// The width of the panels beside two runs.
const BESIDE: f32 = 400.0;

worded! {
    /// A panel.
    #[derive(PartialOrd, Ord)]
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Pane by name {
        Front = "Front",
        Elements = "Elements",
        Nodes = "Nodes",
        Breakpoints = "Breakpoints",
        Bookmarks = "Bookmarks",
        Space = "Space",
        Quality = "Quality",
        Sweep = "Sweep",
        MetricLens = "Metric lens",
        Parametric = "Parametric",
        Inspector = "Inspector",
        History = "History",
        Parameters = "Parameters",
        Layers = "Layers",
        TwoRuns = "Two runs",
    }
}

/// The gap between docks in points.
const GAP: f32 = 2.0;

/// How many columns there is room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Room {
    /// All four.
    Wide,
    /// The lens column is tabs beside the view.
    Middle,
    /// One side column.
    Narrow,
    /// Two runs: all that is left of the middle is the view, for both of them.
    Pair,
}

/// What is told of the mesh in lists and plots, and what the user has set, in the order of their tabs.
const LISTS: [Pane; 4] = [Pane::Front, Pane::Elements, Pane::Nodes, Pane::Quality];
const MARKS: [Pane; 2] = [Pane::Breakpoints, Pane::Bookmarks];

/// A column of the first arrangement.
struct Column {
    /// Its tabs from top to bottom, with their shares of the height.
    groups: Vec<(Vec<Pane>, f32)>,
    /// Its width in points; none for the view, which takes the rest.
    width: Option<f32>,
}

impl Column {
    /// Its panels, from top to bottom.
    fn panes(&self) -> impl Iterator<Item = Pane> {
        self.groups.iter().flat_map(|group| &group.0).copied()
    }
}

impl Room {
    const ALL: [Room; 4] = [Room::Wide, Room::Middle, Room::Narrow, Room::Pair];

    fn name(self) -> &'static str {
        match self {
            Room::Wide => "wide",
            Room::Middle => "middle",
            Room::Narrow => "narrow",
            Room::Pair => "pair",
        }
    }

    fn of(width: f32, is_pair: bool) -> Room {
        if is_pair && width >= VIEW + BESIDE {
            Room::Pair
        } else if width >= LEFT + LENS + RIGHT + VIEW {
            Room::Wide
        } else if width >= 1100.0 {
            Room::Middle
        } else {
            Room::Narrow
        }
    }

    /// The first arrangement, in a window of this height.
    fn columns(self, height: f32) -> Vec<Column> {
        let beside: &[Pane] = match self {
            Room::Wide => &[Pane::Sweep],
            // The map of a sweep beside two runs opens others.
            Room::Pair => &[Pane::MetricLens, Pane::Parametric],
            _ => &[Pane::Sweep, Pane::MetricLens, Pane::Parametric],
        };
        let mut columns = Vec::new();
        if matches!(self, Room::Wide | Room::Middle) {
            let groups = vec![
                // The plots are beside the mesh, in which their bars light elements.
                (LISTS.to_vec(), 1.0),
                (MARKS.to_vec(), 0.42),
            ];
            columns.push(Column { groups, width: Some(LEFT) });
        }
        columns.push(Column { groups: vec![([&[Pane::Space], beside].concat(), 1.0)], width: None });
        if self == Room::Wide {
            let groups = vec![(vec![Pane::MetricLens], 1.0), (vec![Pane::Parametric], 1.0)];
            columns.push(Column { groups, width: Some(LENS) });
        }
        let (inspector, share) = match self {
            Room::Narrow => (
                [&[Pane::Inspector], &LISTS[..], &MARKS, &[Pane::History, Pane::TwoRuns]].concat(),
                210.0 / height.max(420.0),
            ),
            Room::Pair => {
                let first = [Pane::TwoRuns, Pane::Sweep, Pane::Inspector, Pane::History];
                ([&first[..], &LISTS, &MARKS].concat(), 0.42)
            }
            _ => (vec![Pane::Inspector, Pane::History, Pane::TwoRuns], 0.5),
        };
        let groups = vec![(inspector, 1.0), (vec![Pane::Parameters, Pane::Layers], share)];
        columns.push(Column { groups, width: Some(if self == Room::Pair { BESIDE } else { RIGHT }) });
        columns
    }
}

/// Least and greatest height of the timeline with its buttons in points, and its first height.
pub const TIMELINE_HEIGHTS: [f32; 2] = [140.0, 440.0];
const TIMELINE_HEIGHT: f32 = 236.0;

/// The docks, and the height of the timeline below them.
pub struct Layout {
    pub timeline_height: f32,
    tree: Option<(Tree<Pane>, Room)>,
    /// The column that takes the rest of the width, and the size in the frame before.
    middle: Option<TileId>,
    size: Vec2,
    /// How the user has arranged the docks, by the room for columns.
    arranged: BTreeMap<String, Value>,
    /// Whether the user is moving something.
    edited: bool,
    /// The last requests that were carried out: to arrange the docks, and to show a panel.
    relayouts: u64,
    reveals: u64,
}

impl Default for Layout {
    fn default() -> Self {
        Layout {
            timeline_height: TIMELINE_HEIGHT,
            tree: None,
            middle: None,
            size: Vec2::ZERO,
            arranged: BTreeMap::new(),
            edited: false,
            relayouts: 0,
            reveals: 0,
        }
    }
}

impl Layout {
    /// Shows all panels.
    pub fn show(&mut self, ui: &mut Ui, docks: &mut Docks<'_>) {
        let state = docks.window;
        let size = ui.available_size();
        let room = Room::of(size.x, state.pair().is_some());
        if state.view().relayout.take(&mut self.relayouts).is_some() {
            let kept = state.document().layout.as_ref().and_then(|text| serde_json::from_str::<Value>(text).ok());
            self.arrange(kept.as_ref());
            self.tree = None;
        }
        if self.tree.as_ref().is_none_or(|tree| tree.1 != room) {
            match self.arranged.get(room.name()).and_then(|docks| written::read(docks, &room.columns(size.y))) {
                Some((tree, middle)) => {
                    (self.tree, self.middle) = (Some((tree, room)), Some(middle));
                    self.size = size;
                    self.keep_sides(size);
                }
                None => self.build(room, size),
            }
        } else if size != self.size {
            self.keep_sides(size);
        }
        self.size = size;
        let Some((tree, _)) = &mut self.tree else { return };
        if let Some(Some(pane)) = state.view().reveal.take(&mut self.reveals) {
            tree.make_active(|_, tile| matches!(tile, Tile::Pane(shown) if *shown == pane));
        }
        tree.ui(docks, ui);
        self.edited |= docks.edited;
        if self.edited && !ui.input(|input| input.pointer.any_down()) {
            self.edited = false;
            if let Some(row) = row_of(tree) {
                let all = size.x - gaps(row);
                let sum: f32 = row.children.iter().map(|id| row.shares[*id]).sum();
                let Linear { children, shares, .. } = row;
                children.iter().for_each(|id| shares[*id] *= all / sum);
            }
            self.arranged.insert(room.name().to_owned(), written::write(tree));
            docks.commands.push(Command::Arrange(self.arranged().to_string()));
        }
    }

    /// Where a panel is, if it is seen.
    pub fn place_of(&self, pane: Pane) -> Option<Rect> {
        let (tree, _) = self.tree.as_ref()?;
        let tile = tree.tiles.find_pane(&pane)?;
        tree.tiles.rect(tile).filter(|_| tree.active_tiles().contains(&tile))
    }

    /// How the user has arranged the docks, by the room for columns.
    pub fn arranged(&self) -> Value {
        Value::Object(self.arranged.iter().map(|(room, docks)| (room.clone(), docks.clone())).collect())
    }

    /// Arranges the docks as they were, with panels that they lack at their first places; what are no docks is left
    /// out.
    pub fn arrange(&mut self, arranged: Option<&Value>) {
        self.arranged.clear();
        for room in Room::ALL {
            let docks = arranged.and_then(|arranged| arranged.get(room.name()));
            if let Some(docks) = docks.filter(|docks| written::read(docks, &room.columns(0.0)).is_some()) {
                self.arranged.insert(room.name().to_owned(), docks.clone());
            }
        }
    }

    fn build(&mut self, room: Room, size: Vec2) {
        let mut tiles = Tiles::default();
        let mut middle = None;
        let mut columns = Vec::new();
        for Column { groups, width } in room.columns(size.y) {
            let mut tabs: Vec<(TileId, f32)> = Vec::new();
            for (panes, share) in groups {
                let panes = panes.into_iter().map(|pane| tiles.insert_pane(pane)).collect();
                tabs.push((tiles.insert_tab_tile(panes), share));
            }
            let id = match tabs[..] {
                [(only, _)] => only,
                _ => {
                    let mut linear = Linear::new(LinearDir::Vertical, tabs.iter().map(|tab| tab.0).collect());
                    tabs.iter().for_each(|tab| linear.shares.set_share(tab.0, tab.1));
                    tiles.insert_container(Container::Linear(linear))
                }
            };
            if width.is_none() {
                middle = Some(id);
            }
            columns.push((id, width));
        }
        let mut row = Linear::new(LinearDir::Horizontal, columns.iter().map(|c| c.0).collect());
        let rest = size.x - gaps(&row) - columns.iter().filter_map(|c| c.1).sum::<f32>();
        for (id, width) in columns {
            row.shares.set_share(id, width.unwrap_or(rest.max(1.0)));
        }
        let root = tiles.insert_container(Container::Linear(row));
        self.middle = middle;
        self.tree = Some((Tree::new(egui::Id::unique("docks"), root, tiles), room));
    }

    /// Keeps the widths of the side columns when the window's size changes. The shares of the row are points.
    fn keep_sides(&mut self, size: Vec2) {
        let (Some((tree, _)), Some(middle)) = (&mut self.tree, self.middle) else { return };
        let Some(row) = row_of(tree).filter(|row| row.children.contains(&middle)) else { return };
        let sides: f32 = row.children.iter().filter(|id| **id != middle).map(|id| row.shares[*id]).sum();
        row.shares.set_share(middle, (size.x - gaps(row) - sides).max(1.0));
    }
}

/// The row of columns.
fn row_of(tree: &mut Tree<Pane>) -> Option<&mut Linear> {
    let root = tree.root()?;
    match tree.tiles.get_mut(root)? {
        Tile::Container(Container::Linear(row)) if row.dir == LinearDir::Horizontal => Some(row),
        _ => None,
    }
}

/// The width of all gaps between the columns of a row.
fn gaps(row: &Linear) -> f32 {
    GAP * (row.children.len().max(1) - 1) as f32
}
