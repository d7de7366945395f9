//! The table of the front: all segments, sortable and linked with the view. Only the rows in sight are laid out.

use std::cmp::Ordering;

use eframe::egui::{self, Align, Align2, Layout, Rect, RichText, Role, Sense, Ui, Vec2, WidgetInfo};
use egui_extras::{Column, TableBuilder};

use super::{actions, line};
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::case::Selection;
use crate::core::front::Segment;
use crate::core::run::FrontTable;
use crate::core::run::explain::{self, FRONT};
use crate::core::run::front_table::Row;
use crate::render::palette::Palette;
use crate::render::scene::{Decision, Outlined};

const ROW: f32 = 20.0;

/// A column of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FrontColumn {
    Rank,
    Nodes,
    Class,
    HValue,
    Length,
    Key,
    ThetaA,
    ThetaB,
    Level,
    Loop,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    Ascending,
    Descending,
}

/// What the panel keeps for itself.
pub struct FrontState {
    sort: (FrontColumn, Order),
    /// Whether segments of each class are shown.
    classes: [bool; 4],
    /// The last request to scroll that it has followed.
    scrolled: u64,
}

impl Default for FrontState {
    fn default() -> Self {
        FrontState { sort: (FrontColumn::Rank, Order::Ascending), classes: [true; 4], scrolled: 0 }
    }
}

/// Columns with their heads, widths and tooltips.
const COLUMNS: [(FrontColumn, &str, f32, &str); FRONT.len()] = [
    (FrontColumn::Rank, FRONT[0], 28.0, "Rank: the order in which the rules choose"),
    (FrontColumn::Nodes, FRONT[1], 71.0, "Nodes of the segment; live triangles lie to its left"),
    (FrontColumn::Class, FRONT[2], 26.0, "Class of table 1"),
    (FrontColumn::HValue, FRONT[3], 53.0, "H-value, eq. 6, in units of the case"),
    (FrontColumn::Length, FRONT[4], 31.0, "Length in the metric"),
    (FrontColumn::Key, FRONT[5], 54.0, "Key by which segments of a class are ordered"),
    (FrontColumn::ThetaA, FRONT[6], 39.0, "Frontal angle at A, degrees, in the metric of A"),
    (FrontColumn::ThetaB, FRONT[7], 39.0, "Frontal angle at B, degrees, in the metric of B"),
    (FrontColumn::Level, FRONT[8], 19.0, "Level: rows of the front from the boundary"),
    (FrontColumn::Loop, FRONT[9], 17.0, "Loop of the front"),
];

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, local: &mut FrontState, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(moment) = state.run().moment.as_deref() else { return };
    chips(ui, local, moment, palette);
    if moment.front.is_empty() {
        ui.add_space(8.0);
        ui.horizontal(|ui| {
            ui.add_space(14.0);
            let quads = words::counted(moment.mesh.element_count() as u64, "quad");
            ui.label(super::note(format!("The front is closed: the mesh has {quads}."), palette));
        });
        return;
    }
    let rows = rows(local, moment);
    table(ui, state, local, moment, &rows, commands, palette);
}

fn chips(ui: &mut Ui, local: &mut FrontState, moment: &Moment, palette: &Palette) {
    ui.add_space(7.0);
    ui.horizontal(|ui| {
        ui.add_space(8.0);
        ui.spacing_mut().item_spacing.x = 6.0;
        for class in 1..=4_u8 {
            let k = usize::from(class) - 1;
            let count = moment.front.iter().filter(|s| s.class == class).count() as u64;
            let shown = local.classes[k];
            let text = format!("{class}  {}", words::grouped(count));
            let colour = ink(if shown { palette.strong } else { palette.hint });
            let galley = ui.painter().layout_no_wrap(text, theme::medium(theme::TABLE), colour);
            let (rect, response) = ui.allocate_exact_size(galley.size() + Vec2::new(32.0, 6.0), Sense::click());
            response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, shown, format!("Class {class}")));
            let line = ink(if response.hovered() { palette.hint } else { palette.line });
            let fill = ink(if shown { palette.button } else { palette.panel });
            ui.painter().rect(rect, 3.0, fill, (1.0, line), egui::StrokeKind::Inside);
            let swatch = Rect::from_center_size(rect.left_center() + Vec2::new(15.0, 0.0), Vec2::new(12.0, 3.0));
            let fade = if shown { 1.0 } else { 0.35 };
            ui.painter().rect_filled(swatch, 1.5, ink(palette.front[k].faded(fade)));
            let at = Align2::LEFT_CENTER.anchor_size(rect.left_center() + Vec2::new(25.0, 0.0), galley.size()).min;
            ui.painter().galley(at, galley, colour);
            if response.on_hover_text("Show or hide segments of this class in the table").clicked() {
                local.classes[k] = !shown;
            }
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add_space(8.0);
            ui.label(super::note(words::grouped(moment.front.len() as u64), palette))
                .on_hover_text("Segments on the front");
        });
    });
    ui.add_space(5.0);
}

/// The segments that are shown, in their order: their places in the front, with their ranks from 1.
fn rows(local: &FrontState, moment: &Moment) -> Vec<(usize, usize)> {
    let mut rows: Vec<(usize, usize)> = (0..moment.front.len()).map(|i| (i, i + 1)).collect();
    rows.retain(|row| local.classes[usize::from(moment.front[row.0].class) - 1]);
    let (column, order) = local.sort;
    let by = |a: &Segment, b: &Segment| match column {
        FrontColumn::Rank => Ordering::Equal,
        FrontColumn::Nodes => (a.a, a.b).cmp(&(b.a, b.b)),
        FrontColumn::Class => a.class.cmp(&b.class),
        FrontColumn::HValue => a.h_value.total_cmp(&b.h_value),
        FrontColumn::Length => a.length_metric.total_cmp(&b.length_metric),
        FrontColumn::Key => Ordering::Equal,
        FrontColumn::ThetaA => a.theta[0].total_cmp(&b.theta[0]),
        FrontColumn::ThetaB => a.theta[1].total_cmp(&b.theta[1]),
        FrontColumn::Level | FrontColumn::Loop => a.level.cmp(&b.level),
    };
    if column == FrontColumn::Key {
        let parameters = moment.selecting.table.parameters();
        rows.sort_by_key(|row| (moment.rows[row.0].primary_key(parameters), row.1));
    } else if column == FrontColumn::Loop {
        rows.sort_by_key(|row| (moment.rows[row.0].front_loop, row.1));
    } else if column != FrontColumn::Rank {
        rows.sort_by(|a, b| by(&moment.front[a.0], &moment.front[b.0]).then(a.1.cmp(&b.1)));
    }
    if order == Order::Descending {
        rows.reverse();
    }
    rows
}

fn table(
    ui: &mut Ui,
    state: &State,
    local: &mut FrontState,
    moment: &Moment,
    rows: &[(usize, usize)],
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let base = Decision::of(&moment.phase).base;
    let is = |s: &Segment, ends: [_; 2]| [s.a, s.b] == ends || [s.b, s.a] == ends;
    let edge = |what: Option<Outlined>| match what {
        Some(Outlined::Edge(ends)) => Some(ends),
        _ => None,
    };
    let (picked, hovered) = (edge(state.document().picked), edge(state.frame().hovered));
    let decimals = words::decimals(moment.front.iter().map(|s| s.h_value));
    ui.spacing_mut().item_spacing = Vec2::new(1.0, 0.0);
    let mut builder = TableBuilder::new(ui)
        .id_salt("front")
        .striped(true)
        .sense(Sense::click())
        .auto_shrink(false)
        .animate_scrolling(false)
        .cell_layout(Layout::right_to_left(Align::Center));
    // Node numbers of large meshes need more room; a single loop needs no column.
    let most = moment.front.iter().map(|s| s.a.max(s.b).0).max().unwrap_or(0);
    let digits = most.max(1).ilog10() as f32 + 1.0;
    let one_loop = moment.loops.len() < 2;
    for (column, _, width, _) in COLUMNS {
        builder = builder.column(Column::exact(match column {
            FrontColumn::Nodes => width.max(14.5 * digits + 22.0),
            FrontColumn::HValue if digits > 4.0 => 44.0,
            FrontColumn::Level if one_loop => 25.0,
            FrontColumn::Loop if one_loop => 5.0,
            _ => width,
        }));
    }
    builder = builder.column(Column::remainder().at_least(2.0));
    let wanted = edge(state.view().scroll.take(&mut local.scrolled).flatten());
    if let Some(row) = wanted.and_then(|ends| rows.iter().position(|r| is(&moment.front[r.0], ends))) {
        builder = builder.scroll_to_row(row, None);
    }
    let selection = &moment.selecting.table;
    let [key_name, key_words] = explain::key_name(selection.parameters());
    let key_tip = key_tip(selection, key_words);
    let table = builder.header(22.0, |mut header| {
        for (column, name, _, tip) in COLUMNS {
            header.col(|ui| {
                if column == FrontColumn::Key {
                    head(ui, local, column, key_name, &key_tip, palette);
                } else if !(one_loop && column == FrontColumn::Loop) {
                    head(ui, local, column, name, tip, palette);
                }
            });
        }
        header.col(|_| {});
    });
    table.body(|body| {
        body.rows(ROW, rows.len(), |mut row| {
            let (place, rank) = rows[row.index()];
            let segment = &moment.front[place];
            let (is_base, is_picked) = (base.is_some_and(|e| is(segment, e)), picked.is_some_and(|e| is(segment, e)));
            row.set_selected(is_picked);
            row.set_hovered(hovered.is_some_and(|e| is(segment, e)));
            let its_row = &moment.rows[place];
            let mut texts = explain::front_row(selection, its_row, rank, decimals);
            if one_loop {
                texts[FrontColumn::Loop as usize].clear();
            }
            for (k, text) in texts.into_iter().enumerate() {
                row.col(|ui| {
                    if is_base {
                        accent_row(ui, k == 0, palette);
                    }
                    if k == 2 {
                        return class(ui, segment.class, palette);
                    }
                    let colour = match (k, is_base) {
                        (0, _) => palette.weak,
                        _ if COLUMNS[k].0 == FrontColumn::Key && !is_in_reach(selection, its_row) => palette.weak,
                        (_, true) => palette.strong,
                        _ => palette.text,
                    };
                    ui.add(egui::Label::new(line(text, colour)).selectable(false));
                });
            }
            row.col(|ui| {
                if is_base {
                    accent_row(ui, false, palette);
                }
            });
            let response = row.response();
            let name = format!("Segment {}", words::segment([segment.a, segment.b]));
            response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_picked, name.clone()));
            let what = Outlined::Edge([segment.a, segment.b]);
            if response.hovered() {
                commands.push(Command::Hover(what));
            }
            response.context_menu(|ui| actions::menu(ui, state, what, commands));
            if response.double_clicked() {
                commands.push(Command::Show(what));
            } else if response.clicked() {
                commands.push(Command::Pick(Some(what)));
            }
        });
    });
}

/// What the key is, and what it is held against.
fn key_tip(table: &FrontTable, key: &str) -> String {
    match table.parameters().selection {
        Selection::Table1 => format!(
            "Key: {key}. Keys below c Hmin = {} are within reach; others, and class 4, are weak and come after them, by H",
            words::size(table.reach())
        ),
        _ => format!("Key: {key}; the smallest comes first"),
    }
}

/// Whether its key counts: with table 1, only within reach.
fn is_in_reach(table: &FrontTable, row: &Row) -> bool {
    table.parameters().selection != Selection::Table1 || table.is_within_reach(row)
}

fn head(ui: &mut Ui, local: &mut FrontState, column: FrontColumn, name: &str, tip: &str, palette: &Palette) {
    let (sorted, order) = (local.sort.0 == column, local.sort.1);
    let arrow = if order == Order::Ascending { icons::CARET_UP } else { icons::CARET_DOWN };
    let text = if sorted { format!("{arrow}{name}") } else { name.to_owned() };
    let colour = ink(if sorted { palette.strong } else { palette.weak });
    let text = RichText::new(text).font(theme::regular(theme::HEAD)).color(colour);
    let response = ui.add(egui::Label::new(text).selectable(false).sense(Sense::click()));
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Sort by {name}")));
    if response.on_hover_text(tip).clicked() {
        let turned = sorted && order == Order::Ascending;
        local.sort = (column, if turned { Order::Descending } else { Order::Ascending });
    }
}

fn accent_row(ui: &Ui, first: bool, palette: &Palette) {
    let rect = ui.max_rect().expand2(Vec2::new(1.0, 0.0));
    ui.painter().rect_filled(rect, 0.0, ink(palette.accent_row));
    if first {
        let bar = Rect::from_min_size(ui.max_rect().left_top(), Vec2::new(3.0, rect.height()));
        ui.painter().rect_filled(bar, 0.0, ink(palette.base));
    }
}

fn class(ui: &mut Ui, class: u8, palette: &Palette) {
    ui.add(egui::Label::new(line(class.to_string(), palette.text)).selectable(false));
    let (rect, _) = ui.allocate_exact_size(Vec2::new(12.0, 3.0), Sense::hover());
    ui.painter().rect_filled(rect, 1.5, ink(palette.front[usize::from(class) - 1]));
}
