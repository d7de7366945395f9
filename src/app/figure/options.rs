//! The options of figures, on the command line and embedded in the figure.

use std::str::FromStr;

use clap::{Args, Parser};
use glam::DVec2;

use crate::core::fault::Fault;
use crate::core::run::Shown;
use crate::render::camera::Bearing;
use crate::render::look::{FigurePart, HiddenLines, Ink, Layer, Layers, Look};
use crate::render::vector::sheet::{COLUMN, Caption, MILLIMETRE, PAGE, Sheet};
use crate::render::vector::weights::{NOTE, Weights};

/// Dots per inch of line art in print, and of screens.
const PRINT: f64 = 300.0;
const SCREEN: f64 = 96.0;

/// Possible factors on the widths of lines.
pub(in crate::app) const LINE_SCALES: [f64; 2] = [0.1, 20.0];

/// The size of a figure; the height is optional and follows from the content.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::app) enum Size {
    Millimetres(f64, Option<f64>),
    Pixels(u32, Option<u32>),
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Size, String> {
        let usage = "write 84mm, 84x60mm, or pixels such as 1920x1080";
        let (numbers, is_mm) = match text.strip_suffix("mm") {
            Some(numbers) => (numbers, true),
            None => (text, false),
        };
        let (width, height) = match numbers.split_once('x') {
            Some((width, height)) => (width, Some(height)),
            None => (numbers, None),
        };
        if is_mm {
            let side =
                |text: &str| text.trim().trim_end_matches("mm").parse().ok().filter(|x| (5.0..=2000.0).contains(x));
            let sides = side(width).zip(height.map_or(Some(None), |h| side(h).map(Some)));
            return sides.map(|(w, h)| Size::Millimetres(w, h)).ok_or_else(|| format!("{usage} (5 to 2000 mm)"));
        }
        let side = |text: &str| text.trim().parse().ok().filter(|n| (16..=20_000).contains(n));
        let sides = side(width).zip(height.map_or(Some(None), |h| side(h).map(Some)));
        sides.map(|(w, h)| Size::Pixels(w, h)).ok_or_else(|| format!("{usage} (16 to 20000 pixels)"))
    }
}

impl std::fmt::Display for Size {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Size::Millimetres(width, None) => write!(f, "{width}mm"),
            Size::Millimetres(width, Some(height)) => write!(f, "{width}x{height}mm"),
            Size::Pixels(width, None) => write!(f, "{width}"),
            Size::Pixels(width, Some(height)) => write!(f, "{width}x{height}"),
        }
    }
}

/// What a plot shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(in crate::app) enum Plot {
    /// Edge lengths in the metric, as proportions of all edges (fig. 23)
    Lengths,
    /// Smallest and largest angles of the elements (fig. 24)
    Angles,
    /// The run over time: lanes of events, invariants and curves; values at the stop
    Timeline,
    /// What the step of the stop decided, why, and the table of what it chose from
    Decision,
}

impl Plot {
    /// Its name.
    fn name(self) -> &'static str {
        ["lengths", "angles", "timeline", "decision"][self as usize]
    }

    /// Whether it is a histogram of the statistics of a state.
    pub fn is_of_statistics(self) -> bool {
        matches!(self, Plot::Lengths | Plot::Angles)
    }
}

/// The layers of a figure as text: names of all layers, or changes to the default.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::app) struct LayerWords(String);

impl FromStr for LayerWords {
    type Err = String;

    fn from_str(text: &str) -> Result<LayerWords, String> {
        let words = LayerWords(text.to_owned());
        words.named().map(|_| words)
    }
}

impl LayerWords {
    /// Exactly these layers.
    #[cfg(any(test, feature = "window"))]
    pub fn exactly(layers: Layers) -> LayerWords {
        let names: Vec<_> = Layer::ALL.into_iter().filter(|l| layers.has(*l)).map(Layer::name).collect();
        LayerWords(if names.is_empty() { "none".to_owned() } else { names.join(",") })
    }

    /// The mesh only.
    pub fn mesh() -> LayerWords {
        LayerWords([Layer::Live, Layer::Dead, Layer::Boundary].map(Layer::name).join(","))
    }

    /// Each name with its sign, `None` where it has none.
    fn named(&self) -> Result<Vec<(Option<bool>, Layer)>, String> {
        if self.0 == "none" {
            return Ok(Vec::new());
        }
        let one = |word: &str| {
            let (sign, name) = match word.as_bytes().first() {
                Some(b'+') => (Some(true), &word[1..]),
                Some(b'-') => (Some(false), &word[1..]),
                _ => (None, word),
            };
            let found = Layer::ALL.into_iter().find(|layer| layer.name() == name);
            found.map(|layer| (sign, layer)).ok_or_else(|| {
                let all = Layer::ALL.map(Layer::name).join(", ");
                format!("\"{name}\" is not one of {all}; write names, or +NAME and -NAME to change the default")
            })
        };
        self.0.split(',').map(|word| one(word.trim())).collect()
    }

    fn over(&self, usual: Layers) -> Layers {
        let named = self.named().unwrap_or_default();
        let changes = !named.is_empty() && named.iter().all(|(sign, _)| sign.is_some());
        let mut layers = if changes { usual } else { Layers::default() };
        named.iter().for_each(|(sign, layer)| layers.set(*layer, sign.unwrap_or(true)));
        layers
    }
}

/// X,Y,HEIGHT in units of the case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::app) struct PartWords(pub FigurePart);

impl FromStr for PartWords {
    type Err = String;

    fn from_str(text: &str) -> Result<PartWords, String> {
        let numbers: Option<Vec<f64>> =
            text.split(',').map(|n| n.trim().parse().ok().filter(|x: &f64| x.is_finite())).collect();
        match numbers.as_deref() {
            Some(&[x, y, height]) if height > 0.0 => Ok(PartWords(FigurePart { centre: DVec2::new(x, y), height })),
            _ => Err("write X,Y,HEIGHT in units of the case, for example 0.5,0.5,0.1".to_owned()),
        }
    }
}

/// Parses an ink.
fn ink(text: &str) -> Result<Ink, String> {
    match text {
        "gray" => Ok(Ink::Grey),
        "color" => Ok(Ink::Colour),
        _ => Ink::ALL.into_iter().find(|ink| ink.name() == text).ok_or_else(|| "write grey, colour or dark".to_owned()),
    }
}

/// Parses a style of hidden lines.
fn hidden_lines(text: &str) -> Result<HiddenLines, String> {
    let found = HiddenLines::ALL.into_iter().find(|hidden| hidden.name() == text);
    found.ok_or_else(|| "write off, faint or shown".to_owned())
}

/// Parses a bearing.
fn bearing(text: &str) -> Result<Bearing, String> {
    Bearing::parse(text).ok_or_else(|| "write iso, x, y, z, or degrees AZ,EL such as 33,27".to_owned())
}

fn number(text: &str, range: [f64; 2]) -> Result<f64, String> {
    let [least, most] = range;
    let number = text.parse().ok().filter(|x| (least..=most).contains(x));
    number.ok_or_else(|| format!("write a number from {least} to {most}"))
}

fn dpi(text: &str) -> Result<f64, String> {
    number(text, [10.0, 2400.0])
}

fn line_scale(text: &str) -> Result<f64, String> {
    number(text, LINE_SCALES)
}

/// Parses a size of text.
pub(in crate::app) fn font_size(text: &str) -> Result<f64, String> {
    number(text, [1.0, 200.0])
}

/// Options of a figure.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(in crate::app) struct FigureOptions {
    /// Width, or width and height, in millimetres (84mm, 84x60mm) or in pixels (1920x1080) [default: 84mm, a strip
    /// 174mm]
    #[arg(long, value_name = "SIZE")]
    pub size: Option<Size>,
    /// Dots per inch of a PNG, and of a size in pixels [default: 300, with a size in pixels 96]
    #[arg(long, value_name = "NUMBER", value_parser = dpi)]
    pub dpi: Option<f64>,
    /// Factor on the widths of all lines, which are 0.25 to 0.75 pt, and with a size in pixels 1 to 3 pixels
    #[arg(long, value_name = "FACTOR", value_parser = line_scale)]
    pub line_scale: Option<f64>,
    /// Size of notes and numbers in points, with a size in pixels in pixels; captions and letters are a sixth larger
    /// [default: 6 pt, with a size in pixels 12]
    #[arg(long, value_name = "NUMBER", value_parser = font_size)]
    pub font_size: Option<f64>,
    /// Ink: grey, colour, or dark: in colour on a dark ground, for screens
    #[arg(long, value_name = "INK", value_parser = ink)]
    pub ink: Option<Ink>,
    /// Leave out the background
    #[arg(long, value_name = "YES", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub transparent: Option<bool>,
    /// Layers to draw: names out of live, dead, changed, boundary, front, wedges, decision, candidates, letters, nodes,
    /// h, angles, ellipses, scale; or changes to the default (--layers=+h,-letters)
    #[arg(long, value_name = "NAMES", allow_hyphen_values = true)]
    pub layers: Option<LayerWords>,
    /// Draw a plot instead of the mesh
    #[arg(long, value_name = "WHAT")]
    pub plot: Option<Plot>,
    /// Draw only a part: its centre and its height in units of the case
    #[arg(long, value_name = "X,Y,HEIGHT", allow_hyphen_values = true)]
    pub part: Option<PartWords>,
    /// Direction of view on a mesh in space: iso, x, y, z, or azimuth (from -y to the right) and elevation in degrees,
    /// and the roll of the picture
    #[arg(long, value_name = "iso|x|y|z|AZ,EL[,ROLL]", value_parser = bearing, allow_hyphen_values = true)]
    pub view: Option<Bearing>,
    /// Hidden lines of a mesh in space: off, faint or shown
    #[arg(long, value_name = "off|faint|shown", value_parser = hidden_lines)]
    pub hidden: Option<HiddenLines>,
    /// Draw a mesh on surfaces in its parametric plane, chart beside chart
    #[arg(long, value_name = "YES", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub parametric: Option<bool>,
    /// Write below the mesh what the last step did, in a sentence
    #[arg(long, value_name = "YES", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub captions: Option<bool>,
    /// Draw the states as a grid on one page, each with its step and the number of quadrilaterals
    #[arg(long, value_name = "YES", num_args = 0..=1, require_equals = true, default_missing_value = "true")]
    pub contact_sheet: Option<bool>,
    /// Frames side by side in a strip, or on a contact sheet [default: at most 4, in rows of equal length; on a contact
    /// sheet as many as make a page of the shape of paper]
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..=26))]
    pub columns: Option<u32>,
}

/// Parses options alone, as embedded in a figure.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Words {
    #[command(flatten)]
    options: FigureOptions,
}

impl FigureOptions {
    /// The options as command-line arguments.
    pub fn words(&self) -> Vec<String> {
        let part = |PartWords(part): PartWords| format!("{},{},{}", part.centre.x, part.centre.y, part.height);
        let words = [
            self.size.map(|size| format!("--size={size}")),
            self.dpi.map(|dpi| format!("--dpi={dpi}")),
            self.line_scale.map(|factor| format!("--line-scale={factor}")),
            self.font_size.map(|size| format!("--font-size={size}")),
            self.ink.map(|ink| format!("--ink={}", ink.name())),
            self.transparent.map(|yes| format!("--transparent={yes}")),
            self.layers.as_ref().map(|layers| format!("--layers={}", layers.0)),
            self.plot.map(|plot| format!("--plot={}", plot.name())),
            self.part.map(|words| format!("--part={}", part(words))),
            self.view.map(|side| format!("--view={side}")),
            self.hidden.map(|hidden| format!("--hidden={}", hidden.name())),
            self.parametric.map(|yes| format!("--parametric={yes}")),
            self.captions.map(|yes| format!("--captions={yes}")),
            self.contact_sheet.map(|yes| format!("--contact-sheet={yes}")),
            self.columns.map(|columns| format!("--columns={columns}")),
        ];
        words.into_iter().flatten().collect()
    }

    /// Parses options from command-line arguments.
    ///
    /// # Errors
    /// Arguments that are not options of figures.
    pub fn from_words(words: &[String]) -> Result<FigureOptions, Fault> {
        Words::try_parse_from(words).map(|read| read.options).map_err(|error| {
            let line = error.to_string().lines().next().unwrap_or_default().replace("error: ", "");
            Fault::new(format!("The figure has invalid drawing options: {line}"))
        })
    }

    /// These options, completed by those of a figure.
    pub fn or(&self, figure: Option<&Shown>) -> Result<FigureOptions, Fault> {
        let Some(shown) = figure else { return Ok(self.clone()) };
        let theirs = FigureOptions::from_words(&shown.drawn)?;
        macro_rules! completed {
            ($($option:ident),*) => { FigureOptions { $($option: self.$option.clone().or(theirs.$option),)* } };
        }
        Ok(completed!(
            size,
            dpi,
            line_scale,
            font_size,
            ink,
            transparent,
            layers,
            plot,
            part,
            view,
            hidden,
            parametric,
            captions,
            contact_sheet,
            columns
        ))
    }

    /// The look of the figure.
    pub fn look(&self, strip: bool) -> Look {
        let ink = self.ink.unwrap_or_default();
        let usual = Layers::usual(ink, strip);
        Look {
            ink,
            transparent: self.transparent.unwrap_or(false),
            layers: self.layers.as_ref().map_or(usual, |words| words.over(usual)),
            part: self.part.map(|words| words.0),
            from: self.view.unwrap_or_default(),
            hidden: self.hidden.unwrap_or_default(),
            parametric: self.parametric.unwrap_or(false),
        }
    }

    /// Whether several states, or one in the manner of several, are drawn on one page.
    pub fn is_grid(&self, states: usize) -> bool {
        states > 1 || self.contact_sheet == Some(true)
    }

    /// Dots per inch.
    pub fn dots(&self) -> f64 {
        self.dpi.unwrap_or(if matches!(self.size, Some(Size::Pixels(..))) { SCREEN } else { PRINT })
    }

    /// The sheet it is drawn on.
    pub fn sheet<'a>(&self, strip: bool, title: &'a str, description: &'a str, run: Option<&'a str>) -> Sheet<'a> {
        let point = 72.0 / self.dots();
        let (width, height) = match self.size {
            None => (if strip { PAGE } else { COLUMN }, None),
            Some(Size::Millimetres(width, height)) => (width * MILLIMETRE, height.map(|h| h * MILLIMETRE)),
            Some(Size::Pixels(width, height)) => (f64::from(width) * point, height.map(|h| f64::from(h) * point)),
        };
        let columns = self.columns.map(|columns| columns as usize);
        let (look, weights) = (self.look(strip), self.weights());
        Sheet { title, description, run, width, height, look, columns, weights, extent: None, caption: None }
    }

    /// The weights of lines and text.
    fn weights(&self) -> Weights {
        let pixel = matches!(self.size, Some(Size::Pixels(..))).then(|| 72.0 / self.dots());
        let usual = pixel.map_or(Weights::PAPER, Weights::of_pixels);
        let size = self.font_size.map(|size| size * pixel.unwrap_or(1.0));
        Weights { line: usual.line * self.line_scale.unwrap_or(1.0), text: size.map_or(usual.text, |size| size / NOTE) }
    }

    /// Refuses what does not fit so many states of a run in one figure.
    ///
    /// # Errors
    /// Several states in a plot, or on a contact sheet; captions.
    pub fn check(&self, states: usize) -> Result<(), Fault> {
        let is_grid = self.is_grid(states);
        if self.plot.is_some() && is_grid {
            return Err(Fault::new("A plot shows one state").at("--plot").remedy("Name one stop with --at"));
        }
        self.check_captions(!is_grid && self.plot.is_none())
    }

    /// Refuses captions where a figure does not show one state of a run.
    ///
    /// # Errors
    /// There shall be captions.
    pub fn check_captions(&self, shows_a_state: bool) -> Result<(), Fault> {
        if shows_a_state || self.captions != Some(true) {
            return Ok(());
        }
        Err(Fault::new("A caption says what led to one state of a mesh")
            .at("--captions")
            .remedy("Name one stop with --at, or leave it out"))
    }

    /// Refuses a caption that leaves less than half of a page of given height to the mesh.
    ///
    /// # Errors
    /// It does.
    pub fn check_room(&self, caption: &Caption<'_>) -> Result<(), Fault> {
        let sheet = self.sheet(false, "", "", None);
        if sheet.height.is_none_or(|height| 2.0 * caption.height(sheet.width) <= height) {
            return Ok(());
        }
        let rows = caption.wrapped(sheet.width).len().max(caption.rows);
        Err(Fault::new(format!("{rows} rows of captions leave too little room for the mesh"))
            .at("--size")
            .remedy("Choose a larger size, or leave its height out"))
    }

    /// The caption of a figure, where there shall be one.
    pub fn caption<'a>(&self, text: &'a str) -> Option<Caption<'a>> {
        self.captions.unwrap_or(false).then_some(Caption { text, size: self.weights().label(), rows: 0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_read_back_from_their_arguments() {
        for line in [
            "",
            "--size=84x60mm --dpi=600 --ink=grey --transparent=true --layers=+h,-letters --plot=angles --columns=3",
            "--size=1920 --ink=colour --transparent=false --layers=none --part=-0.5,1e-7,0.25",
            "--size=84.5mm --layers=live,front",
            "--view=-30,27.5,4 --part=0,0,3",
            "--view=x --hidden=faint",
            "--size=640x480 --line-scale=1.5 --font-size=14",
            "--ink=dark --captions=true --parametric=true",
            "--plot=timeline",
            "--plot=decision",
            "--contact-sheet=true --columns=5",
        ] {
            let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
            let options = FigureOptions::from_words(&words).unwrap();
            assert_eq!(FigureOptions::from_words(&options.words()).unwrap(), options, "{line}");
        }
        for line in [
            "--size=3mm",
            "--size=84",
            "--size=x",
            "--dpi=0",
            "--ink=red",
            "--layers=lives",
            "--view=w",
            "--view=0,91",
            "--hidden=no",
            "--line-scale=0",
            "--font-size=nan",
            "a",
            "--out=b",
        ] {
            let words = [line.to_owned()];
            let read = FigureOptions::from_words(&words);
            assert!(read.is_err() || line == "--size=84", "{line}");
        }
    }

    #[test]
    fn layers_are_listed_or_changed() {
        let usual = Layers::usual(Ink::Colour, false);
        let over = |text: &str| text.parse::<LayerWords>().unwrap().over(usual);
        assert!(over("+h").has(Layer::H) && over("+h").has(Layer::Front));
        assert!(!over("-front").has(Layer::Front) && over("-front").has(Layer::Live));
        assert!(over("h").has(Layer::H) && !over("h").has(Layer::Front));
        assert_eq!(LayerWords::exactly(usual).over(Layers::default()), usual);
    }

    #[test]
    fn millimetres_and_pixels_become_points() {
        let size = |text: &str| {
            let options = FigureOptions { size: Some(text.parse().unwrap()), ..FigureOptions::default() };
            let sheet = options.sheet(false, "", "", None);
            (sheet.width, sheet.height, options.dots())
        };
        assert_eq!(size("25.4mm"), (72.0, None, 300.0));
        assert_eq!(size("25.4x50.8mm"), (72.0, Some(144.0), 300.0));
        assert_eq!(size("96x192"), (72.0, Some(144.0), 96.0));
    }
}
