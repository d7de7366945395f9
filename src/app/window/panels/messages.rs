//! Messages lie over the views, one at a time, so that nothing moves: faults stay until they are closed, notices go by
//! themselves. A log keeps all of them. The offer to recover an autosaved run lies under the menus. Never modal.

use std::time::Duration;

use eframe::egui::{
    self, Align2, Area, Context, Grid, Label, Order, Pos2, Rect, RichText, ScrollArea, Ui, Vec2, Window,
};

use super::{floating, note, on_click};
use crate::app::window::command::Command;
use crate::app::window::icons;
use crate::app::window::state::State;
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::render::palette::Palette;

/// The greatest width of a message.
const WIDTH: f32 = 620.0;
/// The room around messages.
const ROOM: f32 = 10.0;
/// The size of the log.
const LOG: Vec2 = Vec2::new(560.0, 320.0);

/// Shows the message at hand at the bottom of the views, the offer at their top, and the log if it is open.
pub fn show(context: &Context, views: Rect, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    message(context, views, state, commands, palette);
    offer(context, views, state, commands, palette);
    log(context, views, state, commands, palette);
}

/// A small window of its own over the views.
fn over(
    context: &Context,
    name: &str,
    is_interactive: bool,
    at: Pos2,
    pivot: Align2,
    width: f32,
    palette: &Palette,
    show: impl FnOnce(&mut Ui),
) {
    let area = Area::new(egui::Id::unique(name)).order(Order::Foreground).pivot(pivot).fixed_pos(at);
    let area = area.interactable(is_interactive);
    area.show(context, |ui| {
        ui.set_max_width(width.clamp(120.0, WIDTH));
        floating(palette).inner_margin(egui::Margin::symmetric(12, 7)).show(ui, show);
    });
}

fn message(context: &Context, views: Rect, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let faults = &state.view().faults;
    let notice = state.view().notice();
    if faults.is_empty() && notice.is_none() {
        return;
    }
    let at = views.center_bottom() - Vec2::new(0.0, ROOM);
    // What a notice lies over can be clicked.
    let is_interactive = notice.is_none();
    over(context, "message", is_interactive, at, Align2::CENTER_BOTTOM, views.width() - 2.0 * ROOM, palette, |ui| {
        if let Some((text, _)) = notice {
            ui.add(Label::new(RichText::new(text).color(ink(palette.text))).wrap());
            return;
        }
        let Some(fault) = faults.last() else { return };
        ui.horizontal_top(|ui| {
            ui.label(RichText::new(icons::X_CIRCLE).font(theme::regular(theme::ICON)).color(ink(palette.broken)));
            ui.vertical(|ui| {
                ui.add(Label::new(RichText::new(fault).color(ink(palette.strong))).wrap());
                ui.horizontal(|ui| {
                    on_click(&ui.small_button("Close"), Command::CloseFault(faults.len() - 1), commands);
                    if faults.len() > 1 {
                        on_click(&ui.small_button("All messages"), Command::Messages, commands);
                        ui.label(note(format!("and {} more", faults.len() - 1), palette));
                    }
                });
            });
        });
    });
}

fn offer(context: &Context, views: Rect, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let Some((offer, more)) = state.run().autosave.as_ref().and_then(|autosave| autosave.offer()) else { return };
    let at = views.center_top() + Vec2::new(0.0, ROOM);
    over(context, "offer", true, at, Align2::CENTER_TOP, views.width() - 2.0 * ROOM, palette, |ui| {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(icons::RESET).font(theme::regular(theme::ICON)).color(ink(palette.accent)));
            ui.label(RichText::new(&offer.text).color(ink(palette.strong)));
            if offer.opens && ui.button("Recover").clicked() {
                commands.push(Command::OpenKept);
            }
            on_click(&ui.button("Discard"), Command::DiscardKept, commands);
            if more > 0 {
                ui.label(note(format!("and {more} more"), palette));
            }
        });
    });
}

/// All messages, the latest first, with the time since the window was opened and the step.
fn log(context: &Context, views: Rect, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    if !state.view().messages {
        return;
    }
    let mut open = true;
    let size = LOG.min(views.size() - Vec2::splat(6.0 * ROOM)).max(Vec2::splat(120.0));
    Window::new("Messages")
        .open(&mut open)
        .collapsible(false)
        .resizable(false)
        .frame(floating(palette))
        .pivot(Align2::CENTER_CENTER)
        .default_pos(views.center())
        .show(context, |ui| {
            ui.set_width(size.x);
            if state.view().log.messages.is_empty() {
                ui.label(note("There are no messages.", palette));
            }
            ScrollArea::vertical().max_height(size.y).show(ui, |ui| {
                Grid::new("log").num_columns(3).striped(true).show(ui, |ui| {
                    for message in state.view().log.messages.iter().rev() {
                        ui.label(note(clock(message.at), palette)).on_hover_text("minutes since the window was opened");
                        let step = message.step.map_or(String::new(), |step| format!("step {}", words::grouped(step)));
                        ui.label(note(step, palette));
                        let colour = if message.is_fault { palette.broken } else { palette.text };
                        ui.add(Label::new(super::line(&message.text, colour)).wrap());
                        ui.end_row();
                    }
                });
            });
        });
    if !open {
        commands.push(Command::Messages);
    }
}

/// A time as minutes and seconds.
fn clock(time: Duration) -> String {
    format!("{}:{:02}", time.as_secs() / 60, time.as_secs() % 60)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_minutes_and_seconds() {
        assert_eq!([5, 65, 3600].map(|s| clock(Duration::from_secs(s))), ["0:05", "1:05", "60:00"]);
    }
}
