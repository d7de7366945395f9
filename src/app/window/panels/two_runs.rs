//! Two runs side by side: their first difference with both reasons, what they end with, and what they have in common.

use eframe::egui::{Align, Align2, ComboBox, Grid, Label, Layout, Rect, RichText, ScrollArea, Sense, Ui, Vec2};

use super::{heading, inset, line, note, on_click, part};
use crate::app::compare::values_that_differ;
use crate::app::window::command::{Command, Rules};
use crate::app::window::pair::{Arrangement, LinkedBy, PairCommand, Which};
use crate::app::window::session::Direction;
use crate::app::window::state::{Pair, ShownDifference, State};
use crate::app::window::theme::{self, ink};
use crate::app::window::words;
use crate::core::record::Report;
use crate::core::record::report::figures::{Better, Figure};
use crate::core::run::compare::{Did, Difference, FirstDifference};
use crate::render::palette::{Palette, Rgba};

/// The figures of the table, with their digits after the point.
const FIGURES: [(&str, usize); 13] = [
    ("quads", 0),
    ("irregular", 1),
    ("good_angles", 1),
    ("min_angle", 1),
    ("max_angle", 1),
    ("jacobian.min", 3),
    ("jacobian.mean", 3),
    ("length.mean", 2),
    ("length.deviation", 2),
    ("rolled_back", 0),
    ("last_resort", 0),
    ("steps", 0),
    ("seconds", 2),
];

/// The width of the names of figures in points.
const NAMES: f32 = 150.0;

/// Shows the panel; `state` is the first run.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        inset().show(ui, |ui| match state.pair() {
            None => begin(ui, state, commands, palette),
            Some(pair) => {
                runs(ui, state, pair, commands, palette);
                difference(ui, pair, commands, palette);
                if let Some(reports) = pair.comparison.as_ref().and_then(|comparison| comparison.reports.as_ref()) {
                    ends(ui, reports, palette);
                }
                overlap(ui, pair, palette);
                ui.add_space(8.0);
                part(ui, "runs", |ui| {
                    ui.horizontal_wrapped(|ui| {
                        for command in [PairCommand::Exchange, PairCommand::Close] {
                            button(ui, &command.name(), command, commands);
                        }
                    });
                });
            }
        });
    });
}

fn begin(ui: &mut Ui, state: &State, commands: &mut Vec<Command>, palette: &Palette) {
    let text = "What would change if? A second run, B, starts at this step with everything that the first one, A, did \
                before it. Change a parameter or the base of B: this panel says where both differ first, why, and what \
                they end with.";
    ui.add(Label::new(line(text, palette.text)).wrap());
    ui.add_space(6.0);
    ui.add_enabled_ui(state.run().moment.is_some(), |ui| {
        button(ui, "Fork at this step  (Ctrl+K)", PairCommand::Fork, commands);
        for rules in Rules::ALL {
            let text = match rules {
                Rules::Paper => "Fork with the paper's parameters",
                Rules::Default => "Fork with the default parameters",
            };
            button(ui, text, PairCommand::ForkWith(rules), commands);
        }
    });
    button(ui, &PairCommand::AskBeside.name(), PairCommand::AskBeside, commands);
}

fn button(ui: &mut Ui, text: &str, command: PairCommand, commands: &mut Vec<Command>) {
    on_click(&ui.button(text), Command::Pair(command), commands);
}

/// The runs with the parameters in which they differ now, how they are linked and shown.
fn runs(ui: &mut Ui, state: &State, pair: &Pair, commands: &mut Vec<Command>, palette: &Palette) {
    for which in Which::ALL {
        ui.horizontal_wrapped(|ui| {
            let name = RichText::new(which.name()).font(theme::semibold(theme::BODY));
            let response = ui.selectable_label(pair.active == which, name);
            let response = response.on_hover_text("Show this run in the panels; changes are made to it");
            on_click(&response, Command::Pair(PairCommand::Activate(which)), commands);
            ui.label(line(about(state, which), palette.text));
        });
    }
    if let Some((which, step)) = pair.fork(Which::ALL.map(|which| state.of(which).run().number)) {
        let (forked, from) = (which.name(), which.other().name());
        ui.label(note(format!("{forked} was forked from {from} at step {}.", words::grouped(step)), palette));
    }
    ui.horizontal_wrapped(|ui| {
        ui.label(note("linked by", palette));
        let list = ComboBox::from_id_salt("link").selected_text(pair.link.name()).width(96.0).show_ui(ui, |ui| {
            for link in LinkedBy::ALL {
                let item = ui.selectable_label(pair.link == link, link.name());
                on_click(&item.on_hover_text(about_link(link)), Command::Pair(PairCommand::Link(link)), commands);
            }
        });
        named(&list.response, "How the runs are linked");
        let list = ComboBox::from_id_salt("arrangement").selected_text(pair.arrangement.name()).width(112.0).show_ui(
            ui,
            |ui| {
                for arrangement in Arrangement::ALL {
                    let item = ui.selectable_label(pair.arrangement == arrangement, arrangement.name());
                    on_click(&item, Command::Pair(PairCommand::Show(arrangement)), commands);
                }
            },
        );
        named(&list.response, "How the runs are shown");
    });
}

fn named(response: &eframe::egui::Response, name: &'static str) {
    use eframe::egui::{Role, WidgetInfo};
    response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, name));
}

fn about_link(link: LinkedBy) -> &'static str {
    match link {
        LinkedBy::Step => "Both stand at the same step",
        LinkedBy::Quad => "Both have the same number of quadrilaterals",
        LinkedBy::Event => "Both stand at the event of the same kind and number, such as the 57th selection of a base",
        LinkedBy::Free => "Each run moves by itself",
    }
}

/// The parameters of a run that differ from those of the other one in the states that are shown, and its case where
/// that differs.
pub fn about(state: &State, which: Which) -> String {
    let [this, other] = [which, which.other()].map(|which| state.of(which).run());
    let (Some(now), Some(opened)) = (&this.moment, &this.opened) else { return "is being opened".to_owned() };
    let mut parts = Vec::new();
    if let (Some(others), Some(beside)) = (&other.moment, &other.opened) {
        if opened.run.case != beside.run.case {
            parts.push(opened.run.case.name.clone());
        }
        let differ = values_that_differ(&now.parameters, &others.parameters);
        parts.extend((!differ.is_empty()).then_some(differ));
    }
    if parts.is_empty() { "no parameter differs here".to_owned() } else { parts.join(", ") }
}

fn difference(ui: &mut Ui, pair: &Pair, commands: &mut Vec<Command>, palette: &Palette) {
    match &pair.comparison {
        _ if pair.is_same => {
            title(ui, "No difference yet", palette);
            let text =
                "Both runs have the same case, parameters and changes. Change a parameter of B, or choose its base.";
            weak(ui, text, palette);
        }
        None => {
            title(ui, "Comparing", palette);
            going_on(ui, pair, palette);
        }
        Some(comparison) => match (&pair.shown, &comparison.first_difference) {
            (_, None) => {
                title(ui, "No difference", palette);
                weak(ui, "Every step of both leads to the same state.", palette);
            }
            (None, Some(found)) => {
                first_difference(ui, pair, found, comparison.differences.as_deref(), commands, palette);
            }
            (Some(shown), Some(_)) => {
                let all = comparison.differences.as_deref().unwrap_or_default();
                further_difference(ui, pair, shown, all, commands, palette);
            }
        },
    }
}

/// What the comparison does, or that it has ended and will tell no more.
fn going_on(ui: &mut Ui, pair: &Pair, palette: &Palette) {
    let text = match &pair.progress {
        Some(progress) => format!("{}…", words::progress(progress)),
        None if pair.is_comparing() => "Working…".to_owned(),
        None => "The comparison has ended with an error.".to_owned(),
    };
    weak(ui, &text, palette);
}

fn title(ui: &mut Ui, text: &str, palette: &Palette) {
    ui.add_space(8.0);
    let text = RichText::new(text).font(theme::semibold(theme::TITLE)).color(ink(palette.strong));
    ui.add(Label::new(text).wrap());
}

fn weak(ui: &mut Ui, text: &str, palette: &Palette) {
    ui.add(Label::new(note(text, palette)).wrap());
}

/// The first step after which the states differ.
fn first_difference(
    ui: &mut Ui,
    pair: &Pair,
    found: &FirstDifference,
    all: Option<&[Difference]>,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    title(ui, &format!("First difference: step {}", words::grouped(found.step)), palette);
    if found.step == 0 {
        weak(ui, "The background meshes differ.", palette);
    } else {
        let before = words::counted(found.step - 1, "step");
        weak(ui, &format!("The first {before} lead to the same states, to the last bit."), palette);
    }
    match all.map(|all| all.len() as u64) {
        None => going_on(ui, pair, palette),
        Some(0) => weak(ui, "No decision differs where both fronts are the same around the base.", palette),
        Some(1) => weak(ui, "One decision differs although both fronts are the same around the base.", palette),
        Some(n) => {
            let n = words::grouped(n);
            weak(ui, &format!("{n} decisions differ although both fronts are the same around the base."), palette);
        }
    }
    seek(ui, "Go there", all.unwrap_or_default(), commands);
    if found.step > 0 {
        decisions(ui, &found.did, palette);
    }
}

/// A decision that differs although both fronts are the same there.
fn further_difference(
    ui: &mut Ui,
    pair: &Pair,
    shown: &ShownDifference,
    all: &[Difference],
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let (place, count) = (words::grouped(shown.place as u64 + 1), words::grouped(all.len() as u64));
    title(ui, &format!("Difference {place} of {count}"), palette);
    let Some(difference) = all.get(shown.place) else { return };
    let [a, b] = difference.steps.map(words::grouped);
    let bases = match difference.not_selected {
        None => "Both fronts are the same around this base; the runs do not make the same of it.",
        Some(_) => "Both fronts are the same around two segments side by side; each run selects another one.",
    };
    weak(ui, &format!("A at step {a}, B at step {b}. {bases}"), palette);
    seek(ui, "First difference", all, commands);
    match &shown.did {
        Some(did) => decisions(ui, did, palette),
        None => going_on(ui, pair, palette),
    }
}

/// The buttons that lead to the differences.
fn seek(ui: &mut Ui, to_first: &str, all: &[Difference], commands: &mut Vec<Command>) {
    ui.add_space(4.0);
    part(ui, "differences", |ui| {
        ui.horizontal_wrapped(|ui| {
            button(ui, to_first, PairCommand::ToDifference, commands);
            ui.add_enabled_ui(!all.is_empty(), |ui| {
                for (text, direction) in
                    [("Previous difference", Direction::Back), ("Next difference", Direction::Forward)]
                {
                    button(ui, text, PairCommand::SeekDifference(direction), commands);
                }
            });
        });
    });
}

fn decisions(ui: &mut Ui, did: &[Option<Did>; 2], palette: &Palette) {
    Which::ALL.into_iter().zip(did).for_each(|(which, did)| decision(ui, which, did.as_ref(), palette));
}

/// What a run did, and why.
fn decision(ui: &mut Ui, which: Which, did: Option<&Did>, palette: &Palette) {
    ui.add_space(6.0);
    let strong = |text: String| {
        Label::new(RichText::new(text).font(theme::semibold(theme::BODY)).color(ink(palette.strong))).wrap()
    };
    let Some(did) = did else {
        ui.add(strong(format!("{}: had ended", which.name())));
        return;
    };
    ui.add(strong(format!("{}: {}", which.name(), did.text)));
    for sentence in &did.why {
        ui.add(Label::new(line(sentence, palette.text)).wrap());
    }
}

/// What both end with, with differences: what is better is green and says so.
fn ends(ui: &mut Ui, [a, b]: &[Report; 2], palette: &Palette) {
    heading(ui, "At the end", "A, B, B − A", palette);
    Grid::new("ends").num_columns(4).striped(true).spacing(Vec2::new(8.0, 3.0)).show(ui, |ui| {
        for (name, digits) in FIGURES {
            if let Some(figure) = Figure::named(name) {
                row(ui, figure, digits, [a, b], palette);
                ui.end_row();
            }
        }
    });
}

fn row(ui: &mut Ui, figure: &Figure, digits: usize, reports: [&Report; 2], palette: &Palette) {
    let values = reports.map(|report| figure.of(report));
    let unit = if figure.unit.is_empty() { String::new() } else { format!(", {}", figure.unit) };
    let name = format!("{}{unit}", figure.doc);
    ui.vertical(|ui| {
        ui.set_width(NAMES);
        ui.add(Label::new(note(name, palette)).wrap());
    });
    let right = |ui: &mut Ui, text: String, colour: Rgba| {
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.label(line(text, colour))).inner
    };
    for value in values {
        let text = value.map_or_else(|| words::UNDEFINED.to_owned(), |value| words::fixed(value, digits));
        right(ui, text, palette.text);
    }
    let [Some(a), Some(b)] = values else { return };
    let text = words::fixed(b - a, digits);
    let is_zero = text.bytes().all(|byte| !byte.is_ascii_digit() || byte == b'0');
    let better = match figure.better {
        _ if is_zero => None,
        Better::Neither => None,
        Better::Less => Some(b < a),
        Better::More => Some(b > a),
    };
    let (colour, word) = match better {
        Some(true) => (palette.holds, "B is better"),
        Some(false) => (palette.text, "A is better"),
        None => (palette.weak, "Neither is better"),
    };
    let sign = if b > a && !is_zero { "+" } else { "" };
    right(ui, if is_zero { "0".to_owned() } else { format!("{sign}{text}") }, colour).on_hover_text(word);
}

/// How many quadrilaterals both have in the states that are shown.
fn overlap(ui: &mut Ui, pair: &Pair, palette: &Palette) {
    let Some(overlap) = &pair.overlap else { return };
    heading(ui, "Same quadrilaterals", "in these states", palette);
    let (bar, _) = ui.allocate_exact_size(Vec2::new(ui.available_width(), 8.0), Sense::hover());
    let share = overlap.share();
    ui.painter().rect_filled(bar, 2.0, ink(palette.line));
    let part = Rect::from_min_size(bar.min, Vec2::new(bar.width() * share as f32, bar.height()));
    ui.painter().rect_filled(part, 2.0, ink(palette.dead_edge));
    let [a, b] = overlap.only.each_ref().map(|only| words::grouped(only.len() as u64));
    // Rounded down, so that 100 % means all.
    let percent = words::fixed((share * 1000.0).floor() / 10.0, 1);
    let both = words::counted(overlap.both as u64, "quadrilateral");
    let text = format!(
        "{both} in both ({percent} %): their nodes lie within a tenth of an edge in the metric of A; {a} only in A, {b} \
         only in B."
    );
    ui.add(Label::new(note(text, palette)).wrap());
}

/// The heading of the view of a run: its name, its parameters and its state.
pub fn view_heading(
    ui: &mut Ui,
    rect: Rect,
    state: &State,
    which: Which,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let response = ui.interact(rect, ui.scope_id().with(("heading", which.name())), Sense::click());
    let is_active = state.active_run() == which;
    let label = format!("Run {}", which.name());
    response
        .widget_info(|| eframe::egui::WidgetInfo::selected(eframe::egui::Role::Tab, true, is_active, label.clone()));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, ink(if response.hovered() { palette.button } else { palette.panel }));
    painter.hline(rect.x_range(), rect.bottom() - 0.5, (1.0, ink(palette.line)));
    let name = painter.text(
        rect.left_center() + Vec2::new(12.0, 0.0),
        Align2::LEFT_CENTER,
        which.name(),
        theme::semibold(theme::BODY),
        ink(palette.strong),
    );
    if is_active {
        let rule = Rect::from_min_max(
            eframe::egui::pos2(name.left() - 3.0, rect.bottom() - 2.0),
            eframe::egui::pos2(name.right() + 3.0, rect.bottom()),
        );
        painter.rect_filled(rule, 0.0, ink(palette.base));
    }
    let mut right = rect.right() - 10.0;
    if let Some(moment) = &state.of(which).run().moment {
        let text = format!("{} · step {}", words::counted(moment.standing, "quad"), words::grouped(moment.step));
        let at = rect.right_center() - Vec2::new(10.0, 0.0);
        let drawn = painter.text(at, Align2::RIGHT_CENTER, text, theme::regular(theme::TABLE), ink(palette.text));
        right = drawn.left() - 8.0;
    }
    let left = name.right() + 14.0;
    let mut job = eframe::egui::text::LayoutJob::simple_singleline(
        about(state, which),
        theme::regular(theme::TABLE),
        ink(palette.weak),
    );
    job.wrap = eframe::egui::text::TextWrapping::truncate_at_width((right - left).max(0.0));
    let text = painter.layout_job(job);
    let at = eframe::egui::pos2(left, rect.center().y - 0.5 * text.size().y);
    painter.galley(at, text, ink(palette.weak));
    let tip = format!("{}: {}\nClick: the panels show this run", which.name(), about(state, which));
    on_click(&response.on_hover_text(tip), Command::Pair(PairCommand::Activate(which)), commands);
}
