//! The map of a sweep: a cell for each run, with number and colour.

use eframe::egui::{
    Align2, Color32, Grid, Painter, Pos2, Rect, Response, Role, ScrollArea, Sense, Shape, Stroke, StrokeKind, Ui, Vec2,
    WidgetInfo,
};

use super::cell_text;
use crate::app::window::command::Command;
use crate::app::window::panels::{line, note, on_click};
use crate::app::window::state::State;
use crate::app::window::sweep::{SweepCommand, SweepWork};
use crate::app::window::theme::{self, ink};
use crate::core::record::report::figures::{FIGURES, Figure};
use crate::core::record::sweep::{Axis, Cell, Sweep};
use crate::render::palette::Palette;
use crate::render::vector::heat_map::Scale;

/// The least and the greatest size of a cell in points.
const LEAST: Vec2 = Vec2::new(4.0, 4.0);
const MOST: Vec2 = Vec2::new(84.0, 36.0);
/// The room at the right for the scale of colours, and below for its axis and the legend.
const SCALE: f32 = 64.0;
const BELOW: f32 = 62.0;
/// The room above for the name of the second axis.
const ABOVE: f32 = 20.0;
/// The side of the corner of a cell that is a mark.
const CORNER: f32 = 7.0;
const STEPS: u32 = 32;

/// The places of the cells.
struct Places {
    corner: Pos2,
    cell: Vec2,
    shape: [usize; 2],
}

impl Places {
    /// The rectangle of a cell; rows grow upward.
    fn of(&self, cell: usize) -> Rect {
        let (column, row) = (cell % self.shape[0], self.shape[1] - 1 - cell / self.shape[0]);
        Rect::from_min_size(self.corner + self.cell * Vec2::new(column as f32, row as f32), self.cell)
    }

    fn all(&self) -> Rect {
        let [columns, rows] = self.shape.map(|n| n as f32);
        Rect::from_min_size(self.corner, self.cell * Vec2::new(columns, rows))
    }
}

/// Shows the map.
pub fn show(
    ui: &mut Ui,
    window: &State,
    work: &SweepWork,
    sweep: &Sweep,
    figure: &Figure,
    commands: &mut Vec<Command>,
    palette: &Palette,
) {
    let scale = Scale::of(sweep, figure);
    let ticks = theme::regular(theme::HEAD);
    let width =
        |ui: &Ui, text: &str| ui.painter().layout_no_wrap(text.to_owned(), ticks.clone(), Color32::WHITE).size().x;
    let left = sweep
        .axes()
        .get(1)
        .map_or(0.0, |axis| axis.values.iter().map(|value| width(ui, value)).fold(0.0, f32::max) + 8.0);
    let shape = sweep.shape();
    let room = ui.available_size() - Vec2::new(left + SCALE, ABOVE + BELOW);
    let cell = (room / Vec2::new(shape[0] as f32, shape[1] as f32)).clamp(LEAST, MOST);
    ScrollArea::both().auto_shrink([false, false]).show(ui, |ui| {
        let size = cell * Vec2::new(shape[0] as f32, shape[1] as f32) + Vec2::new(left + SCALE, ABOVE + BELOW);
        let (area, _) = ui.allocate_exact_size(size, Sense::hover());
        let places = Places { corner: area.min + Vec2::new(left, ABOVE), cell, shape };
        let painter = ui.painter_at(area);
        for k in 0..sweep.cells().len() {
            let rect = places.of(k);
            let response = ui.interact(rect, ui.scope_id().with(("cell", k)), Sense::click());
            let text = format!("{}: {}", sweep.name(k), cell_text(sweep, k, scale.as_ref(), figure));
            response.widget_info(|| WidgetInfo::labeled(Role::Button, true, text.clone()));
            paint(&painter, rect, sweep, k, scale.as_ref(), figure, palette);
            if response.hovered() {
                outline(&painter, rect, ink(palette.hover));
            }
            let response = tell(response, sweep, k, palette);
            let in_place = ui.input(|input| input.modifiers.shift);
            let open = if in_place { SweepCommand::Open } else { SweepCommand::OpenBeside };
            on_click(&response, Command::Sweep(open(k)), commands);
        }
        marks(&painter, &places, sweep, figure);
        // Of two runs, the one that the panels show has the stronger outline.
        let active = window.active_run();
        for (which, colour) in [(active.other(), palette.hover), (active, palette.selection)] {
            let is_there = which == active || window.pair().is_some();
            if let Some(cell) = work.at_hand(window.of(which)).filter(|_| is_there) {
                outline(&painter, places.of(cell), ink(colour));
            }
        }
        axes(&painter, &places, sweep, palette);
        if let Some(scale) = &scale {
            colours(&painter, places.all(), scale, palette);
        }
        legend(ui, &painter, places.all(), sweep, figure, palette);
    });
}

fn paint(
    painter: &Painter,
    rect: Rect,
    sweep: &Sweep,
    cell: usize,
    scale: Option<&Scale>,
    figure: &Figure,
    palette: &Palette,
) {
    let Some((scale, value)) = scale.zip(sweep.value(cell, figure)) else {
        painter.rect_stroke(rect, 0.0, Stroke::new(1.0, ink(palette.line)), StrokeKind::Middle);
        if matches!(sweep.cells()[cell], Some(Cell::Refused(_))) {
            let (inside, stroke) = (rect.shrink(2.0), Stroke::new(1.0, ink(palette.refused)));
            painter.line_segment([inside.left_bottom(), inside.right_top()], stroke);
            painter.line_segment([inside.left_top(), inside.right_bottom()], stroke);
        }
        return;
    };
    painter.rect_filled(rect.shrink(if rect.width() > 8.0 { 0.5 } else { 0.0 }), 0.0, ink(scale.colour(value)));
    let text = painter.layout_no_wrap(scale.text(value), theme::regular(theme::TABLE), ink(scale.ink(value)));
    if text.size().x + 4.0 <= rect.width() && text.size().y <= rect.height() {
        painter.galley(Align2::CENTER_CENTER.align_size_within_rect(text.size(), rect).min, text, Color32::WHITE);
    }
}

fn outline(painter: &Painter, rect: Rect, colour: Color32) {
    painter.rect_stroke(rect, 0.0, Stroke::new(2.0, colour), StrokeKind::Outside);
}

/// Everything that is known of a cell, under the pointer.
fn tell(response: Response, sweep: &Sweep, cell: usize, palette: &Palette) -> Response {
    response.on_hover_ui(|ui| {
        ui.label(line(sweep.name(cell), palette.strong));
        match &sweep.cells()[cell] {
            Some(Cell::Refused(why)) => {
                ui.label(line(why, palette.text));
            }
            Some(Cell::Figures(_)) => {
                // Two columns of figures: one would be higher than a small window.
                let grid = Grid::new("figures of the cell").num_columns(4).spacing(Vec2::new(14.0, 1.0));
                grid.min_row_height(0.0).show(ui, |ui| {
                    let half = FIGURES.len().div_ceil(2);
                    for k in 0..half {
                        for figure in FIGURES.iter().skip(k).step_by(half) {
                            let scale = Scale::of(sweep, figure);
                            ui.label(note(figure.name, palette));
                            ui.label(line(cell_text(sweep, cell, scale.as_ref(), figure), palette.text));
                        }
                        ui.end_row();
                    }
                });
            }
            None => {
                ui.label(note("not computed", palette));
            }
        }
        ui.label(note(
            "A click opens this run as the second one, Shift and click in place of the one that is open.",
            palette,
        ));
    })
}

/// Marks the best cells at the lower right, and the case's own values at the upper left.
fn marks(painter: &Painter, places: &Places, sweep: &Sweep, figure: &Figure) {
    for best in sweep.best(figure) {
        best_mark(painter, places.of(best));
    }
    if let Some(own) = sweep.own() {
        own_mark(painter, places.of(own));
    }
}

fn best_mark(painter: &Painter, rect: Rect) {
    triangle(painter, rect.right_bottom(), Vec2::new(-1.0, -1.0));
}

fn own_mark(painter: &Painter, rect: Rect) {
    triangle(painter, rect.left_top(), Vec2::new(1.0, 1.0));
}

/// A corner of a cell, white with a dark edge: seen on every colour.
fn triangle(painter: &Painter, corner: Pos2, inward: Vec2) {
    let points = vec![corner, corner + Vec2::new(CORNER * inward.x, 0.0), corner + Vec2::new(0.0, CORNER * inward.y)];
    painter.add(Shape::convex_polygon(points, Color32::WHITE, Stroke::new(1.0, Color32::BLACK)));
}

/// Of how many values one has its number on an axis.
fn thinned(room: f32, cell: f32) -> usize {
    (room / cell).ceil().max(1.0) as usize
}

fn heading(axis: &Axis) -> String {
    if axis.unit().is_empty() { axis.key.to_owned() } else { format!("{} ({})", axis.key, axis.unit()) }
}

fn axes(painter: &Painter, places: &Places, sweep: &Sweep, palette: &Palette) {
    let (all, font) = (places.all(), theme::regular(theme::HEAD));
    let text = |at: Pos2, anchor: Align2, text: &str| {
        painter.text(at, anchor, text, font.clone(), ink(palette.weak));
    };
    let axis = &sweep.axes()[0];
    let widths =
        axis.values.iter().map(|value| painter.layout_no_wrap(value.clone(), font.clone(), Color32::WHITE).size().x);
    let room = widths.fold(0.0, f32::max) + 6.0;
    for k in (0..axis.values.len()).step_by(thinned(room, places.cell.x)) {
        let x = places.of(k).center().x;
        text(Pos2::new(x, all.bottom() + 3.0), Align2::CENTER_TOP, &axis.values[k]);
    }
    text(Pos2::new(all.center().x, all.bottom() + 18.0), Align2::CENTER_TOP, &heading(axis));
    if let Some(axis) = sweep.axes().get(1) {
        for k in (0..axis.values.len()).step_by(thinned(theme::HEAD + 3.0, places.cell.y)) {
            let y = places.of(k * places.shape[0]).center().y;
            text(Pos2::new(all.left() - 5.0, y), Align2::RIGHT_CENTER, &axis.values[k]);
        }
        text(Pos2::new(painter.clip_rect().left(), all.top() - 4.0), Align2::LEFT_BOTTOM, &heading(axis));
    }
}

/// The scale of colours, at the right.
fn colours(painter: &Painter, all: Rect, scale: &Scale, palette: &Palette) {
    let bar = Rect::from_min_size(all.right_top() + Vec2::new(10.0, 0.0), Vec2::new(9.0, all.height().max(30.0)));
    let [low, high] = scale.range;
    let step = bar.height() / STEPS as f32;
    for k in 0..STEPS {
        let value = low + (high - low) * (f64::from(k) + 0.5) / f64::from(STEPS);
        let bottom = bar.bottom() - step * k as f32;
        let part = Rect::from_min_max(Pos2::new(bar.left(), bottom - step), Pos2::new(bar.right(), bottom));
        painter.rect_filled(part, 0.0, ink(scale.colour(value)));
    }
    let font = theme::regular(theme::HEAD);
    let text = |at: Pos2, anchor: Align2, value: f64| {
        painter.text(at + Vec2::new(4.0, 0.0), anchor, scale.text(value), font.clone(), ink(palette.weak));
    };
    text(bar.right_top(), Align2::LEFT_TOP, high);
    if high > low {
        text(bar.right_bottom(), Align2::LEFT_BOTTOM, low);
    }
}

/// What the marks mean, below the map.
fn legend(ui: &mut Ui, painter: &Painter, all: Rect, sweep: &Sweep, figure: &Figure, palette: &Palette) {
    let font = theme::regular(theme::HEAD);
    let mut x = all.left();
    let y = all.bottom() + 47.0;
    let marks = [(!sweep.best(figure).is_empty(), "best"), (sweep.own().is_some(), "the case's own values")];
    for (k, (_, text)) in marks.into_iter().enumerate().filter(|(_, mark)| mark.0) {
        let rect = Rect::from_center_size(Pos2::new(x + 7.0, y), Vec2::new(14.0, 12.0));
        painter.rect_stroke(rect, 0.0, Stroke::new(0.75, ink(palette.line)), StrokeKind::Inside);
        if k == 0 {
            best_mark(painter, rect)
        } else {
            own_mark(painter, rect)
        }
        let at = Pos2::new(x + 20.0, y);
        let drawn = ui.painter().text(at, Align2::LEFT_CENTER, text, font.clone(), ink(palette.weak));
        x = drawn.right() + 16.0;
    }
}
