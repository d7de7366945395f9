//! The decision chain of a quadrilateral: each step that made it or changed it, with the number that decided.

use eframe::egui::{CursorIcon, Label, RichText, Role, Sense, Ui, WidgetInfo};

use super::{note, part, section, sentence};
use crate::app::window::command::Command;
use crate::app::window::session::{Goal, ToldChain};
use crate::app::window::state::{Lookup, State};
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::mesh::ElementId;
use crate::core::run::{Link, explain};
use crate::render::palette::Palette;

pub fn show(ui: &mut Ui, state: &State, element: ElementId, commands: &mut Vec<Command>, palette: &Palette) {
    let told = match state.run().chain(element) {
        Lookup::Known(told) => told,
        Lookup::Pending => return,
        Lookup::Unasked => return commands.push(Command::TellChain(element)),
    };
    if section(ui, "Decision chain", "up to this step", palette) {
        part(ui, "chain", |ui| links(ui, &told, commands, palette));
    }
}

fn links(ui: &mut Ui, told: &ToldChain, commands: &mut Vec<Command>, palette: &Palette) {
    let Some(chain) = &told.chain else {
        ui.label(note("It is part of the background mesh.", palette));
        return;
    };
    let costliest = chain.costliest();
    if let Some(link) = costliest.map(|k| &chain.links[k]) {
        let name = format!("Largest loss: step {}", words::grouped(link.step));
        let tip = format!(
            "{}. It cost {} of quality",
            words::capital(&words::event(&link.event)),
            words::fixed(link.loss, 2)
        );
        super::on_click(&ui.button(name).on_hover_text(tip), Command::Go(Goal::Step(link.step)), commands);
    }
    let mut before = None;
    for (k, link) in chain.links.iter().enumerate() {
        if k == chain.made + 1 && chain.is_cut {
            ui.label(note("Earlier changes are not listed.", palette));
        }
        step(ui, link, before, costliest == Some(k), commands, palette);
        before = link.quality;
    }
}

/// A step of the chain: a link to it, and below it what it cost and for which parameters it would be the same.
fn step(
    ui: &mut Ui,
    link: &Link,
    before: Option<f64>,
    is_costliest: bool,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let name = format!("step {}", words::grouped(link.step));
    ui.horizontal(|ui| {
        let text = RichText::new(&name).font(theme::medium(theme::TABLE)).color(ink(palette.strong)).underline();
        let response = ui.add(Label::new(text).sense(Sense::click()).selectable(false));
        let label = format!("Chain, {name}: {}", explain::plain(&link.text));
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, label.clone()));
        super::on_click(
            &response.on_hover_cursor(CursorIcon::PointingHand).on_hover_text("Go to this step"),
            Command::Go(Goal::Step(link.step)),
            commands,
        );
        if let Some(after) = link.quality {
            let text = match before {
                Some(before) => format!("quality {} → {}", words::fixed(before, 2), words::fixed(after, 2)),
                None => format!("quality {}", words::fixed(after, 2)),
            };
            ui.label(note(text, palette));
        }
        if is_costliest {
            let text = RichText::new("lost most").font(theme::medium(theme::TABLE)).color(ink(palette.strong));
            ui.label(text.background_color(ink(palette.button)))
                .on_hover_text("Of all these steps, this one cost the quadrilateral most quality");
        }
    });
    ui.indent(&name, |ui| {
        sentence(ui, &words::capital(&link.text), palette.text, palette);
        if let Some(margin) = &link.margin {
            sentence(ui, margin, palette.weak, palette);
        }
    });
}
