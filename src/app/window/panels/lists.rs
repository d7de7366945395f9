//! The tables of elements and nodes: sorted by any column, filtered by a condition, linked with the views. A thread
//! makes the order (`lists`); only the rows in sight are measured here, in the current state.

mod columns;

use std::sync::{Arc, Weak};

use eframe::egui::{self, Align, Layout, RichText, Role, ScrollArea, Sense, Ui, Vec2, WidgetInfo};
use egui_extras::{Column, TableBuilder, TableRow};

use self::columns::{Described, Head};
use super::condition_field::ConditionField;
use super::{actions, inset, line, note};
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::lists::Shown;
use crate::app::window::session::Moment;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::kernel::condition::Condition;
use crate::core::run::{ElementRow, LastChanges, NodeRow, Query, Steps};
use crate::render::palette::Palette;

const ROW: f32 = 20.0;
const HEAD: f32 = 34.0;

/// What a panel keeps for itself.
pub struct ListState {
    /// The field by which it is sorted, and whether the largest comes first.
    field: usize,
    descending: bool,
    /// The condition that is being typed, and the last one that could be read.
    text: String,
    filter: Option<Condition>,
    /// The last request to scroll and the last copy that it has followed.
    scrolled: u64,
    copied: u64,
    /// Whether it is still to scroll to the selection.
    seeks: bool,
    /// The steps of births and last changes, and the run and the state that they are of.
    recorded: Recorded,
}

impl ListState {
    /// A list that is sorted by a field.
    fn by(field: usize) -> ListState {
        ListState {
            field,
            descending: false,
            text: String::new(),
            filter: None,
            scrolled: 0,
            copied: 0,
            seeks: false,
            recorded: Recorded::default(),
        }
    }

    fn query(&self) -> Query {
        Query { field: self.field, descending: self.descending, filter: self.filter.clone() }
    }
}

/// The steps that made and changed what a state of a run has.
#[derive(Default)]
struct Recorded {
    run: u64,
    moment: Weak<Moment>,
    born: Vec<u64>,
    changes: LastChanges,
}

impl Recorded {
    /// Looks them up for another state.
    fn follow<R: Described>(&mut self, state: &State, moment: &Arc<Moment>) {
        let run = state.run();
        if std::mem::replace(&mut self.run, run.number) != run.number {
            self.changes = LastChanges::default();
        }
        if !std::ptr::eq(self.moment.as_ptr(), Arc::as_ptr(moment)) {
            self.moment = Arc::downgrade(moment);
            self.born = R::born(state, moment);
            self.changes.follow(&run.change_log, moment.step);
        }
    }

    fn of<R: Described>(&self, slot: u32) -> Steps {
        let born = self.born.get(slot as usize).copied().unwrap_or(0);
        Steps { born, changed: R::last_change(&self.changes, slot) }
    }
}

/// What both panels keep.
pub struct ListStates {
    pub elements: ListState,
    pub nodes: ListState,
}

impl Default for ListStates {
    fn default() -> Self {
        ListStates { elements: ListState::by(ElementRow::FIRST), nodes: ListState::by(NodeRow::FIRST) }
    }
}

/// Shows the elements.
pub fn elements(ui: &mut Ui, state: &State, local: &mut ListState, commands: &mut Vec<Command>, palette: &Palette) {
    show::<ElementRow>(ui, state, local, commands, palette);
}

/// Shows the nodes.
pub fn nodes(ui: &mut Ui, state: &State, local: &mut ListState, commands: &mut Vec<Command>, palette: &Palette) {
    show::<NodeRow>(ui, state, local, commands, palette);
}

fn show<R: Described>(
    ui: &mut Ui,
    state: &State,
    local: &mut ListState,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let Some(moment) = &state.run().moment else { return };
    local.recorded.follow::<R>(state, moment);
    let lister = R::lister(&state.run().lists);
    inset().show(ui, |ui| {
        let field = ConditionField { name: R::FILTER, hint: R::HINT, fields: R::FIELDS };
        let typed = field.show(ui, &mut local.text, palette);
        if local.text.trim().is_empty() {
            local.filter = None;
        } else if typed.condition.is_some() {
            local.filter = typed.condition;
        }
        ui.add_space(2.0);
        ui.horizontal(|ui| {
            if let Some(shown) = lister.shown() {
                let [found, of] = [shown.listing.slots.len(), shown.listing.of].map(|n| n as u64);
                let text = format!("{} of {}", words::grouped(found), words::counted(of, R::KIND.name()));
                let tip = format!("Measured, filtered and sorted in {:.0} ms", 1e3 * shown.took.as_secs_f64());
                ui.label(note(text, palette)).on_hover_text(tip);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let copy = Command::CopyList(R::KIND, local.query());
                let button = ui.small_button("Copy as CSV");
                button.widget_info(|| WidgetInfo::labeled(Role::Button, true, copy.name()));
                let tip = "Copies these rows in this order with all columns as comma-separated values";
                super::on_click(&button.on_hover_text(tip), copy, commands);
            });
        });
    });
    if let Some(text) = lister.take_text(&mut local.copied) {
        ui.ctx().copy_text(text.to_string());
    }
    let query = local.query();
    if state.run().lists.wants(R::KIND, &query) {
        commands.push(Command::List(R::KIND, query));
    }
    if let Some(shown) = lister.shown() {
        if shown.listing.slots.is_empty() {
            inset().show(ui, |ui| ui.label(note(format!("No {} fits.", R::KIND.name()), palette)));
        } else {
            ScrollArea::horizontal().id_salt(R::KIND.name()).auto_shrink(false).show(ui, |ui| {
                table::<R>(ui, state, local, moment, shown, commands, palette);
            });
        }
    }
}

fn table<R: Described>(
    ui: &mut Ui,
    state: &State,
    local: &mut ListState,
    moment: &Moment,
    shown: &Shown,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    ui.spacing_mut().item_spacing = Vec2::new(1.0, 0.0);
    let heads = R::heads(moment);
    let mut builder = TableBuilder::new(ui)
        .id_salt(R::KIND.name())
        .striped(true)
        .sense(Sense::click())
        .auto_shrink(false)
        .animate_scrolling(false)
        .cell_layout(Layout::right_to_left(Align::Center));
    for head in &heads {
        builder = builder.column(Column::exact(head.width));
    }
    builder = builder.column(Column::remainder().at_least(2.0));
    local.seeks |= state.view().scroll.take(&mut local.scrolled).is_some();
    let picked = state.document().picked.and_then(R::slot);
    if std::mem::take(&mut local.seeks)
        && let Some(row) = picked.and_then(|slot| shown.listing.slots.iter().position(|other| *other == slot))
    {
        builder = builder.scroll_to_row(row, None);
    }
    let decimals = heads.iter().map(|head| head.decimals).collect::<Vec<_>>();
    let table = builder.header(HEAD, |mut header| {
        for shown in &heads {
            header.col(|ui| head::<R>(ui, local, shown, palette));
        }
        header.col(|_| {});
    });
    let recorded = &local.recorded;
    let hovered = state.frame().hovered.and_then(R::slot);
    table.body(|body| {
        body.rows(ROW, shown.listing.slots.len(), |mut row| {
            let slot = shown.listing.slots[row.index()];
            let (is_picked, is_hovered) = (picked == Some(slot), hovered == Some(slot));
            row.set_selected(is_picked);
            row.set_hovered(is_hovered);
            let measured = R::row(moment, slot, recorded.of::<R>(slot));
            for (head, decimals) in heads.iter().zip(&decimals) {
                // Until the thread has made the list of this state, it may name what is gone.
                let text = measured.as_ref().map_or(String::new(), |row| columns::text(row, head.field, *decimals));
                let colour = if head.field == 0 { palette.weak } else { palette.text };
                row.col(|ui| _ = ui.add(egui::Label::new(line(text, colour)).selectable(false)));
            }
            row.col(|_| {});
            act::<R>(&row, state, slot, measured.as_ref(), is_picked, commands);
        });
    });
}

/// What a row does when it is pointed at and clicked.
fn act<R: Described>(
    row: &TableRow<'_, '_>,
    state: &State,
    slot: u32,
    measured: Option<&R>,
    is_picked: bool,
    commands: &mut Vec<Command>,
) {
    let Some(measured) = measured else { return };
    let response = row.response();
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_picked, measured.name()));
    let what = R::outlined(slot);
    if response.hovered() {
        commands.push(Command::Hover(what));
    }
    response.context_menu(|ui| actions::menu(ui, state, what, commands));
    if response.double_clicked() {
        commands.push(Command::Show(what));
    } else if response.clicked() {
        commands.push(Command::Find(what));
    }
}

/// The heading of a column: its name above its space and unit. A click sorts by it.
fn head<R: Described>(ui: &mut Ui, local: &mut ListState, head: &Head, palette: &Palette) {
    let is_sorted = local.field == head.field;
    let arrow = if local.descending { icons::CARET_DOWN } else { icons::CARET_UP };
    let colour = ink(if is_sorted { palette.strong } else { palette.weak });
    let font = theme::regular(theme::HEAD);
    let name = if is_sorted { format!("{arrow}{}", head.name) } else { head.name.to_owned() };
    let text = RichText::new(format!("{name}\n{}", head.unit)).font(font).color(colour);
    let response = ui.add(egui::Label::new(text).selectable(false).halign(Align::RIGHT).extend().sense(Sense::click()));
    let whole = format!("Sort by {}", head.whole());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, whole.clone()));
    let field = R::FIELDS[head.field];
    let tip = format!("{}. In conditions: {}", words::capital(field.doc), field.name);
    if response.on_hover_text(tip).clicked() {
        local.descending = is_sorted && !local.descending;
        local.field = head.field;
        local.seeks = true;
    }
}
