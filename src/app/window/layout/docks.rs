//! Shows each panel where egui_tiles puts it, with tabs and bars in the style of the window.

use eframe::egui::{self, Color32, Rect, Sense, Stroke, Ui, Vec2, WidgetInfo};
use egui_tiles::{Behavior, EditAction, SimplificationOptions, TabState, Tabs, Tile, TileId, Tiles, UiResponse};

use super::Pane;
use crate::app::window::command::Command;
use crate::app::window::panels::{self, PanelStates};
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::viewport::{Lens, Views, pair};
use crate::render::palette::Palette;

/// All panels and what they need.
pub struct Docks<'a> {
    /// The first run, and with it the window.
    pub window: &'a State,
    /// The run that the panels show, and what they keep of it.
    pub state: &'a State,
    pub local: &'a mut PanelStates,
    /// The views of each run.
    pub views: &'a mut [Views; 2],
    pub commands: &'a mut Vec<Command>,
    pub palette: &'static Palette,
    /// Whether the user has moved something.
    pub edited: bool,
}

impl Behavior<Pane> for Docks<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, pane: &mut Pane) -> UiResponse {
        let Docks { window, state, local, views, commands, palette, .. } = self;
        let beside = &mut views[window.active_run() as usize];
        match pane {
            Pane::Space => match window.pair() {
                Some(pair) => pair::show(ui, window, pair, views, commands, palette),
                None => beside.space(ui, state, commands, palette),
            },
            Pane::MetricLens => beside.other(ui, state, Lens::Metric, palette),
            Pane::Parametric => beside.other(ui, state, Lens::Whole, palette),
            Pane::Front => panels::front::show(ui, state, &mut local.front, commands, palette),
            Pane::Elements => panels::lists::elements(ui, state, &mut local.lists.elements, commands, palette),
            Pane::Nodes => panels::lists::nodes(ui, state, &mut local.lists.nodes, commands, palette),
            Pane::Breakpoints => panels::breakpoints::show(ui, state, &mut local.breakpoints, commands, palette),
            Pane::Bookmarks => panels::bookmarks::show(ui, state, &mut local.bookmarks, commands, palette),
            Pane::Quality => panels::plots::show(ui, state, &mut local.plots, commands, palette),
            Pane::Sweep => panels::sweep::show(ui, window, &mut local.sweep, commands, palette),
            Pane::Inspector => panels::inspector::show(ui, state, &mut local.inspector, commands, palette),
            Pane::History => panels::history::show(ui, state, &mut local.history, commands, palette),
            Pane::Parameters => panels::parameters::show(ui, state, &mut local.parameters, commands, palette),
            Pane::Layers => panels::layers::show(ui, state, commands, palette),
            Pane::TwoRuns => panels::two_runs::show(ui, window, commands, palette),
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
                // The tabs come first; the legend shows as much as there is room for.
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

    fn on_edit(&mut self, action: EditAction) {
        self.edited |= action != EditAction::TileDragged;
    }

    fn tab_bar_height(&self, _: &egui::Style) -> f32 {
        28.0
    }

    fn gap_width(&self, _: &egui::Style) -> f32 {
        super::GAP
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
