//! The panels in their docks: sides keep their widths in points, the view takes the rest.

use eframe::egui::{self, Color32, Rect, Sense, Stroke, Ui, Vec2, WidgetInfo};
use egui_tiles::{
    Behavior, Container, Linear, LinearDir, SimplificationOptions, TabState, Tabs, Tile, TileId, Tiles, Tree,
    UiResponse,
};

use super::command::Command;
use super::panels;
use super::state::State;
use super::theme::{self, ink};
use super::viewport::{Lens, Views};
use crate::render::palette::Palette;

/// Widths in points: front, lens, inspector; and the least that the view keeps.
const LEFT: f32 = 344.0;
const LENS: f32 = 263.0;
const RIGHT: f32 = 332.0;
const VIEW: f32 = 480.0;

/// A panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pane {
    Front,
    Breakpoints,
    Bookmarks,
    Space,
    Quality,
    MetricLens,
    Parametric,
    Inspector,
    History,
    Parameters,
    Layers,
}

impl Pane {
    fn name(self) -> &'static str {
        match self {
            Pane::Front => "Front",
            Pane::Breakpoints => "Breakpoints",
            Pane::Bookmarks => "Bookmarks",
            Pane::Space => "Space",
            Pane::Quality => "Quality",
            Pane::MetricLens => "Metric lens",
            Pane::Parametric => "Parametric",
            Pane::Inspector => "Inspector",
            Pane::History => "History",
            Pane::Parameters => "Parameters",
            Pane::Layers => "Layers",
        }
    }
}

/// How many columns there is room for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Room {
    /// All four.
    Wide,
    /// The lens column is tabs beside the view.
    Middle,
    /// One side column.
    Narrow,
}

impl Room {
    fn of(width: f32) -> Room {
        if width >= LEFT + LENS + RIGHT + VIEW {
            Room::Wide
        } else if width >= 1100.0 {
            Room::Middle
        } else {
            Room::Narrow
        }
    }
}

/// The docks.
#[derive(Default)]
pub struct Layout {
    tree: Option<(Tree<Pane>, Room)>,
    /// The column that takes what the others leave, and the size at the last frame.
    middle: Option<TileId>,
    size: Vec2,
}

impl Layout {
    /// Shows all panels.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        state: &mut State,
        views: &mut Views,
        commands: &mut Vec<Command>,
        palette: &'static Palette,
    ) {
        let size = ui.available_size();
        let room = Room::of(size.x);
        let reset = std::mem::take(&mut state.reset_layout);
        if reset || self.tree.as_ref().is_none_or(|tree| tree.1 != room) {
            self.build(room, size);
        } else if size != self.size {
            self.keep_sides(size);
        }
        self.size = size;
        let Some((tree, _)) = &mut self.tree else { return };
        let mut docks = Docks { state, views, commands, palette };
        tree.ui(&mut docks, ui);
    }

    fn build(&mut self, room: Room, size: Vec2) {
        let mut tiles = Tiles::default();
        let mut tabs = |panes: &[Pane]| {
            let panes = panes.iter().map(|pane| tiles.insert_pane(*pane)).collect();
            tiles.insert_tab_tile(panes)
        };
        let (left, right, lens);
        let view = match room {
            Room::Wide => tabs(&[Pane::Space, Pane::Quality]),
            _ => tabs(&[Pane::Space, Pane::Quality, Pane::MetricLens, Pane::Parametric]),
        };
        match room {
            Room::Narrow => {
                left = Vec::new();
                right = vec![
                    (tabs(&[Pane::Inspector, Pane::Front, Pane::Breakpoints, Pane::Bookmarks, Pane::History]), 1.0),
                    (tabs(&[Pane::Parameters, Pane::Layers]), 210.0 / size.y.max(420.0)),
                ];
                lens = Vec::new();
            }
            _ => {
                left = vec![(tabs(&[Pane::Front]), 1.0), (tabs(&[Pane::Breakpoints, Pane::Bookmarks]), 0.42)];
                right = vec![
                    (tabs(&[Pane::Inspector, Pane::History]), 1.0),
                    (tabs(&[Pane::Parameters, Pane::Layers]), 0.42),
                ];
                lens = match room {
                    Room::Wide => vec![(tabs(&[Pane::MetricLens]), 1.0), (tabs(&[Pane::Parametric]), 1.0)],
                    _ => Vec::new(),
                };
            }
        }
        let mut columns = Vec::new();
        for (column, width) in [(left, LEFT), (vec![(view, 1.0)], 0.0), (lens, LENS), (right, RIGHT)] {
            let id = match column.len() {
                0 => continue,
                1 => column[0].0,
                _ => {
                    let mut linear = Linear::new(LinearDir::Vertical, column.iter().map(|c| c.0).collect());
                    column.iter().for_each(|c| linear.shares.set_share(c.0, c.1));
                    tiles.insert_container(Container::Linear(linear))
                }
            };
            columns.push((id, width));
        }
        let rest = size.x - columns.iter().map(|c| c.1).sum::<f32>();
        let mut row = Linear::new(LinearDir::Horizontal, columns.iter().map(|c| c.0).collect());
        for (id, width) in columns {
            row.shares.set_share(id, if width > 0.0 { width } else { rest.max(1.0) });
        }
        let root = tiles.insert_container(Container::Linear(row));
        self.middle = Some(view);
        self.tree = Some((Tree::new(egui::Id::unique("docks"), root, tiles), room));
    }

    /// After a change of the window's size the sides are as wide as before.
    fn keep_sides(&mut self, size: Vec2) {
        let (Some((tree, _)), Some(middle)) = (&mut self.tree, self.middle) else { return };
        let Some(root) = tree.root() else { return };
        let Some(Tile::Container(Container::Linear(row))) = tree.tiles.get(root) else { return };
        let children = row.children.clone();
        let widths: Vec<_> = children.iter().map(|id| (*id, tree.tiles.rect(*id).map_or(0.0, |r| r.width()))).collect();
        if row.dir != LinearDir::Horizontal || !children.contains(&middle) || widths.iter().any(|w| w.1 <= 0.0) {
            return;
        }
        let sides: f32 = widths.iter().filter(|w| w.0 != middle).map(|w| w.1).sum();
        if let Some(Tile::Container(Container::Linear(row))) = tree.tiles.get_mut(root) {
            for (id, width) in widths {
                row.shares.set_share(id, if id == middle { (size.x - sides).max(1.0) } else { width });
            }
        }
    }
}

/// Shows each panel where egui_tiles wants it.
struct Docks<'a> {
    state: &'a mut State,
    views: &'a mut Views,
    commands: &'a mut Vec<Command>,
    palette: &'static Palette,
}

impl Behavior<Pane> for Docks<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, pane: &mut Pane) -> UiResponse {
        let Docks { state, views, commands, palette } = self;
        let rect = ui.max_rect();
        let ground = match pane {
            Pane::Space | Pane::MetricLens | Pane::Parametric => palette.ground,
            _ => palette.panel,
        };
        ui.painter().rect_filled(rect, 0.0, ink(ground));
        match pane {
            Pane::Space => views.space(ui, state, commands, palette),
            Pane::MetricLens => views.other(ui, state, Lens::Metric, palette),
            Pane::Parametric => views.other(ui, state, Lens::Whole, palette),
            Pane::Front => panels::front::show(ui, state, commands, palette),
            Pane::Breakpoints => panels::breakpoints::show(ui, state, commands, palette),
            Pane::Bookmarks => panels::breakpoints::bookmarks(ui, state, commands, palette),
            Pane::Quality => panels::plots::show(ui, state, commands, palette),
            Pane::Inspector => panels::inspector::show(ui, state, commands, palette),
            Pane::History => panels::history::show(ui, state, commands, palette),
            Pane::Parameters => panels::parameters::show(ui, state, commands, palette),
            Pane::Layers => panels::layers::show(ui, state, commands, palette),
        }
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, pane: &Pane) -> egui::WidgetText {
        pane.name().into()
    }

    fn tab_ui(
        &mut self,
        tiles: &mut Tiles<Pane>,
        ui: &mut Ui,
        id: egui::Id,
        tile: TileId,
        tab: &TabState,
    ) -> egui::Response {
        let name = match tiles.get(tile) {
            Some(Tile::Pane(pane)) => pane.name(),
            _ => "Group",
        };
        let colour = ink(if tab.active { self.palette.strong } else { self.palette.weak });
        let font = if tab.active { theme::medium(theme::BODY) } else { theme::regular(theme::BODY) };
        let text = ui.painter().layout_no_wrap(name.to_owned(), font, colour);
        let (_, rect) = ui.allocate_space(Vec2::new(text.size().x + 20.0, ui.available_height()));
        let response = ui.interact(rect, id, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::selected(egui::Role::Tab, true, tab.active, name));
        if ui.is_rect_visible(rect) && !tab.is_being_dragged {
            let colour = if response.hovered() { ink(self.palette.strong) } else { colour };
            let at = egui::Align2::CENTER_CENTER.align_size_within_rect(text.size(), rect).min;
            ui.painter().galley_with_override_text_color(at, text, colour);
            if tab.active {
                let rule = Rect::from_min_max(
                    rect.left_bottom() + Vec2::new(3.0, -2.0),
                    rect.right_bottom() - Vec2::new(3.0, 0.0),
                );
                ui.painter().rect_filled(rule, 0.0, ink(self.palette.base));
            }
        }
        self.on_tab_button(tiles, tile, response)
    }

    fn top_bar_right_ui(&mut self, tiles: &Tiles<Pane>, ui: &mut Ui, _: TileId, tabs: &Tabs, _: &mut f32) {
        let active = tabs.active.and_then(|id| tiles.get_pane(&id));
        match active {
            Some(Pane::Space) => {
                // The tabs come first: what the legend has no room for is in the help.
                let font = theme::medium(theme::BODY);
                let width = |id: &TileId| {
                    let name = tiles.get_pane(id).map_or("", |pane| pane.name());
                    ui.painter().layout_no_wrap(name.to_owned(), font.clone(), Color32::WHITE).size().x + 20.0
                };
                let tabs: f32 = tabs.children.iter().map(width).sum();
                panels::legend::show(ui, tabs + 12.0, self.state, self.commands, self.palette);
            }
            Some(Pane::Parameters) => panels::parameters::reset(ui, self.state, self.commands),
            _ => {}
        }
    }

    fn tab_bar_height(&self, _: &egui::Style) -> f32 {
        28.0
    }

    fn gap_width(&self, _: &egui::Style) -> f32 {
        2.0
    }

    fn min_size(&self) -> f32 {
        120.0
    }

    fn tab_bar_color(&self, _: &egui::Visuals) -> Color32 {
        ink(self.palette.panel)
    }

    fn tab_bar_hline_stroke(&self, _: &egui::Visuals) -> Stroke {
        Stroke::new(1.0, ink(self.palette.line))
    }

    fn resize_stroke(&self, _: &egui::Style, state: egui_tiles::ResizeState) -> Stroke {
        match state {
            egui_tiles::ResizeState::Idle => Stroke::new(2.0, ink(self.palette.line)),
            _ => Stroke::new(2.0, ink(self.palette.weak)),
        }
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: true, ..SimplificationOptions::default() }
    }
}
