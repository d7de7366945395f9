//! Pictures laid out on a page, alone or side by side, with marks, captions and a scale bar.

mod caption;
mod frame;
mod marks;

use glam::DVec2;

pub use self::caption::Caption;

use self::frame::PageFrame;
use self::marks::Marks;
use super::page::{Anchor, Cap, Coat, Page, Path, Stroke, width};
use super::weights::Weights;
use crate::render::look::{FigurePart, Layer, Look};
use crate::render::palette::{CROWDED, THIN, figure};
use crate::render::picture::{Line, Picture, Role};

/// Points per millimetre.
pub const MILLIMETRE: f64 = 72.0 / 25.4;

/// The width of a figure in one column of a page, in points.
pub const COLUMN: f64 = 84.0 * MILLIMETRE;

/// The width of a figure across the page, in points.
pub const PAGE: f64 = 174.0 * MILLIMETRE;

/// The gap between the frames of a strip, in points.
const GAP: f64 = 3.0 * MILLIMETRE;

/// Default number of frames side by side.
const COLUMNS: usize = 4;
/// The height of a page of paper for its width.
const PAPER: f64 = std::f64::consts::SQRT_2;
/// A frame narrower than this on paper has no room for caption and scale bar in one row.
const NARROW: f64 = 95.0;

/// The page of a picture.
#[derive(Clone, Copy)]
pub struct Sheet<'a> {
    /// One line on what it shows.
    pub title: &'a str,
    /// A longer description.
    pub description: &'a str,
    /// The text of the embedded run.
    pub run: Option<&'a str>,
    /// Width in points.
    pub width: f64,
    /// Height in points; by default it follows from equal scales along both axes.
    pub height: Option<f64>,
    /// Its look.
    pub look: Look,
    /// Number of frames of a strip side by side.
    pub columns: Option<usize>,
    /// The weights of its medium.
    pub weights: Weights,
    /// The box that is fitted to the page; `None`: that of the picture.
    pub extent: Option<[DVec2; 2]>,
    /// The caption of a single picture.
    pub caption: Option<Caption<'a>>,
}

impl<'a> Sheet<'a> {
    /// A sheet as wide as a column.
    pub fn column(title: &'a str, description: &'a str, look: Look) -> Sheet<'a> {
        let (run, height, columns, extent, caption) = (None, None, None, None, None);
        let weights = Weights::PAPER;
        Sheet { title, description, run, width: COLUMN, height, look, columns, weights, extent, caption }
    }
}

/// Lays one picture out.
pub fn page(picture: &Picture, sheet: &Sheet<'_>) -> Page {
    let (look, weights) = (&sheet.look, &sheet.weights);
    // The scale bar has its own row below the picture, and the caption has its rows below that.
    let bar = if look.layers.has(Layer::Scale) { 1.7 * weights.label() } else { 0.0 };
    let below = bar + sheet.caption.map_or(0.0, |caption| caption.height(sheet.width));
    let part = look.part.map(|part| part_bounds(part, sheet.width, sheet.height));
    let bounds = part.or(sheet.extent).or_else(|| picture.bounds());
    let frame = PageFrame::fit(bounds, sheet.width, sheet.height.map(|h| h - below), sheet);
    let mut page = Page::new(sheet, frame.size.y + below);
    draw(&mut page, picture, &frame, look);
    if bar > 0.0 {
        scale_bar(&mut page, &frame, DVec2::new(frame.size.x - 1.0, frame.size.y + weights.label()), look);
    }
    if let Some(caption) = sheet.caption {
        caption.write(&mut page, sheet.width, frame.size.y + bar);
    }
    page
}

/// Lays pictures out side by side in equal frames of the same scale, each with a letter and its title below, and one
/// scale bar for all.
pub fn strip(pictures: &[Picture], sheet: &Sheet<'_>) -> Page {
    let titles = pictures.iter().enumerate().map(|(k, picture)| format!("({}) {}", letter(k), picture.title));
    let titles = Titles { texts: titles.collect(), size: sheet.weights.label(), may_wrap: false };
    grid(pictures, &titles, sheet.columns.unwrap_or(COLUMNS), sheet)
}

/// Lays pictures out as a grid, each with its title below. Unless the sheet says how many stand side by side, the page
/// has about the shape of paper, and the titles have room in one row.
pub fn contact_sheet(pictures: &[Picture], sheet: &Sheet<'_>) -> Page {
    let size = sheet.weights.note();
    let texts: Vec<String> = pictures.iter().map(|picture| picture.title.clone()).collect();
    let widest = texts.iter().map(|text| width(text, size)).fold(size, f64::max) / caption::SHARE;
    let usual = (pictures.len() as f64 / PAPER).sqrt().ceil().min(((sheet.width + GAP) / (widest + GAP)).floor());
    let columns = sheet.columns.unwrap_or(usual.max(1.0) as usize);
    grid(pictures, &Titles { texts, size, may_wrap: true }, columns, sheet)
}

/// The titles of the frames of a grid.
struct Titles {
    texts: Vec<String>,
    size: f64,
    /// Whether they may take several rows.
    may_wrap: bool,
}

impl Titles {
    /// The rows of one of them below a frame of some width.
    fn rows(&self, k: usize, room: f64) -> Vec<&str> {
        let text = self.texts.get(k).map_or("", String::as_str);
        if self.may_wrap { Caption { text, size: self.size, rows: 0 }.wrapped(room) } else { vec![text] }
    }
}

fn grid(pictures: &[Picture], titles: &Titles, columns: usize, sheet: &Sheet<'_>) -> Page {
    let (look, size) = (&sheet.look, titles.size);
    let count = pictures.len().max(1);
    let rows = count.div_ceil(columns.clamp(1, count));
    let columns = count.div_ceil(rows);
    let each = (sheet.width - GAP * (columns - 1) as f64) / columns as f64;
    let most = (0..pictures.len()).map(|k| titles.rows(k, each).len()).max().unwrap_or(1).max(1);
    let caption = 1.9 * size + caption::ROW * size * (most - 1) as f64;
    let has_bar = look.layers.has(Layer::Scale);
    let is_narrow = each < NARROW * sheet.weights.text;
    let own_row = if has_bar && is_narrow && count == rows * columns { 1.5 * size } else { 0.0 };
    let inner = sheet.height.map(|h| (h - own_row - GAP * (rows - 1) as f64) / rows as f64 - caption);
    let union = |a: [DVec2; 2], b: [DVec2; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let part = look.part.map(|part| part_bounds(part, each, inner));
    let all = part.or_else(|| pictures.iter().filter_map(Picture::bounds).reduce(union));
    let first = PageFrame::fit(all, each, inner, sheet);
    let row = first.size.y + caption;
    let height = row * rows as f64 + GAP * (rows - 1) as f64 + own_row;
    let mut page = Page::new(sheet, height);
    for (k, picture) in pictures.iter().enumerate() {
        let left_top = DVec2::new((k % columns) as f64 * (each + GAP), (k / columns) as f64 * (row + GAP));
        let frame = first.moved(left_top);
        draw(&mut page, picture, &frame, look);
        for (k, text) in titles.rows(k, each).into_iter().enumerate() {
            let below = first.size.y + 1.25 * size + caption::ROW * size * k as f64;
            page.text(left_top + DVec2::new(1.0, below), size, Anchor::Start, text);
        }
    }
    if has_bar {
        let y = if own_row > 0.0 { height - 1.05 * size } else { height - caption + 1.25 * size };
        scale_bar(&mut page, &first, DVec2::new(sheet.width - 1.0, y), look);
    }
    page
}

/// a, b, ..., z, aa, ab, ...
fn letter(k: usize) -> String {
    let last = char::from(b'a' + (k % 26) as u8);
    if k < 26 { last.to_string() } else { letter(k / 26 - 1) + &last.to_string() }
}

/// The bounds of a part with the aspect ratio of its page, 3 : 4 where the page has no height.
fn part_bounds(part: FigurePart, width: f64, height: Option<f64>) -> [DVec2; 2] {
    let shape = width / height.unwrap_or(0.75 * width).max(1.0);
    let half = 0.5 * part.height * DVec2::new(shape, 1.0);
    [part.centre - half, part.centre + half]
}

/// Draws a picture in its frame, clipped where it is a part.
fn draw(page: &mut Page, picture: &Picture, frame: &PageFrame, look: &Look) {
    let clip = look.part.is_some();
    if clip {
        page.clip([frame.left_top, frame.left_top + frame.size]);
    }
    let roles = || Role::ALL.into_iter().filter(|role| look.layers.has(Layer::of(*role)));
    roles().for_each(|role| areas(page, picture, frame, look, role));
    for hidden in [true, false] {
        roles().for_each(|role| lines(page, picture, frame, look, role, hidden));
    }
    Marks::new(page, frame, look).draw(&picture.marks);
    if clip {
        page.unclip();
    }
}

fn areas(page: &mut Page, picture: &Picture, frame: &PageFrame, look: &Look, role: Role) {
    let Some(fill) = figure(role, look.ink).fill else { return };
    let mut path = Path::default();
    for area in picture.areas.iter().filter(|a| a.role == role && frame.sees(&a.outline)) {
        path.walk(area.outline.iter().map(|p| frame.place(*p)), true);
    }
    page.path(path, Coat::area(fill));
}

/// Draws the hidden or the visible lines of a role.
fn lines(page: &mut Page, picture: &Picture, frame: &PageFrame, look: &Look, role: Role, hidden: bool) {
    let style = figure(role, look.ink);
    let Some(colour) = style.stroke else { return };
    let weight = page.weights().line;
    let cap = Some(if style.dash.is_some() { Cap::Butt } else { Cap::Round });
    let dash = style.dash.map(|dash| dash.map(|length| length * weight));
    let opacity = if hidden { look.hidden.share() } else { 1.0 };
    for (crowded, width) in [(true, THIN.min(style.width)), (false, style.width)] {
        let mut path = Path::default();
        // The boundary keeps its width, for orientation.
        let thin = |room: f64| role != Role::Boundary && room * frame.scale < CROWDED * weight;
        let here = |l: &&Line| l.role == role && l.hidden == hidden && thin(l.room) == crowded;
        for line in picture.lines.iter().filter(here).filter(|l| frame.sees(&l.ends)) {
            path.walk(line.ends.iter().map(|p| frame.place(*p)), false);
        }
        page.path(path, Coat::line(Stroke { colour, width: width * weight, cap, dash, opacity }));
    }
}

/// Draws a scale bar of a round length that ends at `right`, with the length to its left.
fn scale_bar(page: &mut Page, frame: &PageFrame, right: DVec2, look: &Look) {
    let wanted = 0.3 * frame.size.x / frame.scale;
    if !(wanted.is_finite() && wanted > 0.0) {
        return;
    }
    let power = libm::pow(10.0, libm::floor(libm::log10(wanted)));
    let length = [5.0, 2.0, 1.0].into_iter().map(|k| k * power).find(|l| *l <= wanted).unwrap_or(power);
    let left = right - DVec2::new(length * frame.scale, 0.0);
    let Weights { line, text } = page.weights();
    let note = page.weights().note();
    let middle = DVec2::new(0.0, 0.3 * note);
    let mut path = Path::default();
    path.walk([left - middle, right - middle].into_iter(), false);
    for end in [left, right] {
        path.walk([-1.5, 1.5].into_iter().map(|y| end - middle + DVec2::new(0.0, y * text)), false);
    }
    let stroke = figure(Role::Boundary, look.ink).stroke.unwrap_or_default();
    page.path(path, Coat::line(Stroke::of(stroke, 0.5 * line)));
    page.text(left - DVec2::new(2.5 * text, 0.0), note, Anchor::End, &length_in_words(length));
}

/// A round length as text: 0.2, 50, 2e-7.
fn length_in_words(length: f64) -> String {
    let text = crate::core::kernel::Shortest(libm::round(length * 1e12) / 1e12).to_string();
    if length < 1e-9 { format!("{length:e}") } else { text }
}

#[cfg(test)]
mod tests;
