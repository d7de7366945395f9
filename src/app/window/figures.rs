//! Figures from the window: the current state, or several steps as a strip, made in the background by the code of
//! `render`.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Receiver;

use eframe::egui::ColorImage;

use super::files::{self, Writing, free_path};
use super::film::FilmForm;
use super::session::{Moment, Opened, Wake};
use super::state::{State, ViewCamera};
use crate::core::kernel::worded::worded;

use crate::app::figure::{self, Figure, FigureOptions, LayerWords, PartWords, Size, Wanted};
use crate::app::notes;
use crate::app::output::PictureFormat;
use crate::app::work::{self, FigureFrame};
use crate::core::convert::Stop;
use crate::core::fault::Fault;
use crate::core::formats::save;
use crate::core::mesh::Names;
use crate::core::progress::Nobody;
use crate::core::record::{Export, run_file};
use crate::core::run::shown::fingerprint;
use crate::core::run::{Bookmark, Run, Shown, ShownState};
use crate::render::camera::Bearing;
use crate::render::look::{FigurePart, HiddenLines, Ink, Layer, Layers};
use crate::render::orthographic::View;
use crate::render::picture::Seen;
use crate::render::vector::png;

worded! {
    /// The formats of a figure.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Formats by name {
        /// Vectors.
        Svg = "SVG",
        /// Pixels drawn from them.
        Png = "PNG",
        /// Vectors for print.
        Pdf = "PDF",
        /// Both.
        Both = "SVG and PNG",
    }
}

impl Formats {
    /// Those that this program makes: in a browser none for print.
    pub fn made() -> impl Iterator<Item = Formats> {
        Formats::ALL.into_iter().filter(|formats| !formats.files().is_empty())
    }

    /// The formats of its files.
    fn files(self) -> &'static [PictureFormat] {
        match self {
            Formats::Svg => &[PictureFormat::Svg],
            Formats::Png => &[PictureFormat::Png],
            #[cfg(not(target_arch = "wasm32"))]
            Formats::Pdf => &[PictureFormat::Pdf],
            #[cfg(target_arch = "wasm32")]
            Formats::Pdf => &[],
            Formats::Both => &[PictureFormat::Svg, PictureFormat::Png],
        }
    }
}

worded! {
    /// What a figure shows.
    #[derive(Default)]
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Content by name {
        /// The current state.
        #[default]
        State = "this state",
        /// The steps with a bookmark, side by side.
        Bookmarks = "the bookmarks, side by side",
        /// Stops that the user has typed, side by side.
        Stops = "several NQ, side by side",
        /// Edge lengths of the current state.
        Lengths = "edge lengths (fig. 23)",
        /// Angles of the current state.
        Angles = "angles (fig. 24)",
        /// The run over time.
        Timeline = "the timeline",
        /// What the last step decided.
        Decision = "the decision of this step",
        /// The conversion, from one state to the next.
        Film = "the conversion, as a film",
    }
}

impl Content {
    /// Whether it is a plot, and not a picture of meshes.
    pub fn is_plot(self) -> bool {
        matches!(self, Content::Lengths | Content::Angles | Content::Timeline | Content::Decision)
    }
}

/// How figures are made, as the user has set it.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureForm {
    pub content: Content,
    /// NQ of a strip, separated by commas.
    pub stops: String,
    /// As `--size` takes it; empty: as wide as a column, or a page for a strip.
    pub size: String,
    pub dpi: f64,
    /// The factor on the widths of lines.
    pub line_scale: f64,
    /// As `--font-size` takes it; empty: as usual on paper or on a screen.
    pub font_size: String,
    pub ink: Ink,
    /// Whether the ground is transparent, not white.
    pub transparent: bool,
    /// Layers that differ from the usual ones, and whether they are on.
    pub changed: Vec<(Layer, bool)>,
    /// Whether only the part in view is drawn.
    pub in_view: bool,
    /// The folder; empty: the working folder.
    pub folder: String,
    /// Name without its extension; empty: from case and step.
    pub name: String,
    /// The film, where it shows one.
    pub film: FilmForm,
}

impl Default for FigureForm {
    fn default() -> Self {
        FigureForm {
            content: Content::State,
            stops: "50,100,150".to_owned(),
            size: String::new(),
            dpi: 300.0,
            line_scale: 1.0,
            font_size: String::new(),
            ink: Ink::Colour,
            transparent: false,
            changed: Vec::new(),
            in_view: false,
            folder: String::new(),
            name: String::new(),
            film: FilmForm::default(),
        }
    }
}

impl FigureForm {
    /// Whether the figure is a strip.
    pub fn is_strip(&self) -> bool {
        matches!(self.content, Content::Bookmarks | Content::Stops)
    }

    fn usual(&self) -> Layers {
        Layers::usual(self.ink, self.is_strip())
    }

    /// Whether a layer is drawn.
    pub fn has(&self, layer: Layer) -> bool {
        self.changed.iter().find(|c| c.0 == layer).map_or(self.usual().has(layer), |c| c.1)
    }

    /// Switches a layer.
    pub fn switch(&mut self, layer: Layer, on: bool) {
        self.changed.retain(|c| c.0 != layer);
        if self.usual().has(layer) != on {
            self.changed.push((layer, on));
        }
    }

    /// The same as options of the command line.
    fn options(
        &self,
        part: Option<(FigurePart, f64)>,
        view: Option<(Bearing, HiddenLines)>,
    ) -> Result<FigureOptions, Fault> {
        let wrong = |what: String| Fault::new(format!("The figure's size is not valid: {what}"));
        let text = self.size.trim();
        let mut size: Option<Size> = if text.is_empty() { None } else { Some(text.parse().map_err(wrong)?) };
        if let Some((_, shape)) = part {
            // Unless the page has a shape of its own, it has that of the view.
            let usual = if self.is_strip() { 174.0 } else { 84.0 };
            size = Some(match size.unwrap_or(Size::Millimetres(usual, None)) {
                Size::Millimetres(w, None) => Size::Millimetres(w, Some((10.0 * w * shape).round() / 10.0)),
                Size::Pixels(w, None) => Size::Pixels(w, Some((f64::from(w) * shape).round() as u32)),
                whole => whole,
            });
        }
        let font_size = match self.font_size.trim() {
            "" => None,
            text => Some(figure::font_size(text).map_err(|what| Fault::new(format!("The size of the text: {what}")))?),
        };
        let mut layers = self.usual();
        self.changed.iter().for_each(|(layer, on)| layers.set(*layer, *on));
        let plot = match self.content {
            Content::Lengths => Some(figure::Plot::Lengths),
            Content::Angles => Some(figure::Plot::Angles),
            Content::Timeline => Some(figure::Plot::Timeline),
            Content::Decision => Some(figure::Plot::Decision),
            _ => None,
        };
        Ok(FigureOptions {
            size,
            dpi: (self.dpi != 300.0).then_some(self.dpi),
            line_scale: (self.line_scale != 1.0).then_some(self.line_scale),
            font_size,
            ink: (self.ink != Ink::default()).then_some(self.ink),
            transparent: self.transparent.then_some(true),
            layers: (!self.changed.is_empty()).then(|| LayerWords::exactly(layers)),
            plot,
            part: part.map(|part| PartWords(part.0)),
            view: view.map(|view| view.0),
            hidden: view.map(|view| view.1).filter(|hidden| *hidden != HiddenLines::Off),
            parametric: None,
            captions: None,
            contact_sheet: None,
            columns: None,
        })
    }

    /// The steps of a strip.
    fn wanted(&self, bookmarks: &[Bookmark]) -> Result<Vec<Wanted>, Fault> {
        if self.content == Content::Bookmarks {
            if bookmarks.is_empty() {
                return Err(Fault::new("There are no bookmarks").remedy("Ctrl+B bookmarks the current step"));
            }
            return Ok(bookmarks.iter().map(|mark| Wanted::at(Some(Stop::Step(mark.step)))).collect());
        }
        let stops = crate::app::input::stops(&format!("nq={}", self.stops.replace(' ', "")));
        let stops =
            stops.map_err(|what| Fault::new(format!("\"{}\" is not a valid list of stops: {what}", self.stops)))?;
        Ok(stops.0.into_iter().map(Wanted::at).collect())
    }
}

/// Starts to make the figure that the panel describes and to write it, beside the window; does nothing if nothing
/// is open. `wake` is called when it is done.
///
/// # Errors
/// If the form has no meaning.
pub fn begin(state: &State, formats: Formats, wake: Wake) -> Result<Option<Writing>, Fault> {
    let stem = stem(state);
    let make = maker(state)?;
    Ok(make.map(|make| files::work(wake, move || write(&make()?, &stem, formats))))
}

/// Starts to draw the figure in at most so many pixels, beside the window.
///
/// # Errors
/// If the form has no meaning.
pub fn preview(state: &State, most: [f32; 2]) -> Result<Option<Receiver<Result<ColorImage, Fault>>>, Fault> {
    let make = maker(state)?;
    Ok(make.map(|make| {
        files::work(state.wake(), move || {
            let ([width, height], pixels) = png::fitted(&make()?.svg(), most)?;
            Ok(ColorImage::from_rgba_unmultiplied([width as usize, height as usize], &pixels))
        })
    }))
}

/// The files that are written next.
pub fn names(state: &State, formats: Formats) -> Vec<PathBuf> {
    let stem = stem(state);
    formats.files().iter().map(|format| free_path(&stem, format.extension())).collect()
}

/// The path of the figure without its extension.
pub fn stem(state: &State) -> String {
    let form = &state.workspace().figure;
    let step = state.run().moment.as_ref().map_or(0, |moment| moment.step);
    let case = state.run().opened.as_ref().map_or("figure", |opened| opened.run.case.name.as_str());
    let name = match (form.name.trim(), form.content) {
        ("", Content::State) => format!("{case}-step-{step}"),
        ("", Content::Lengths) => format!("{case}-step-{step}-lengths"),
        ("", Content::Angles) => format!("{case}-step-{step}-angles"),
        ("", Content::Timeline) => format!("{case}-step-{step}-timeline"),
        ("", Content::Decision) => format!("{case}-step-{step}-decision"),
        ("", Content::Bookmarks | Content::Stops) => format!("{case}-strip"),
        ("", Content::Film) => format!("{case}-film"),
        (name, _) => name.to_owned(),
    };
    Path::new(form.folder.trim()).join(name).display().to_string()
}

/// Makes a figure, on any thread.
type Maker = Box<dyn FnOnce() -> Result<Figure, Fault> + Send>;

/// What makes the figure that the panel describes; none if nothing is open.
fn maker(state: &State) -> Result<Option<Maker>, Fault> {
    let (run, form) = (state.run(), &state.workspace().figure);
    let (Some(moment), Some(opened), Some(current)) = (run.moment.clone(), run.opened.clone(), state.current_run())
    else {
        return Ok(None);
    };
    let options = options(state, &moment, form.in_view)?;
    let wanted = match form.content {
        Content::Bookmarks | Content::Stops => Some(form.wanted(&state.document().bookmarks)?),
        // They are of the whole run.
        Content::Timeline | Content::Decision => Some(vec![Wanted::at(Some(Stop::Step(moment.step)))]),
        _ => None,
    };
    Ok(Some(Box::new(move || match wanted {
        Some(wanted) => Ok(figure::make(&current, &wanted, &options, true, &mut Nobody)?.0),
        None => of_state(&moment, &opened, &current, &options),
    })))
}

/// The options of the frames of a film.
///
/// # Errors
/// If the form has no meaning.
pub fn options_of_film(state: &State) -> Result<FigureOptions, Fault> {
    let form = &state.workspace().figure;
    let Some(moment) = &state.run().moment else { return Err(Fault::new("Nothing is open")) };
    // A camera that follows chooses the part itself.
    let options = options(state, moment, form.in_view && !form.film.follows)?;
    // Surfaces are filmed as they are seen.
    let parametric = moment.mesh.embedding().is_some() && !state.is_in_space();
    Ok(FigureOptions {
        transparent: None,
        parametric: parametric.then_some(true),
        captions: form.film.captions.then_some(true),
        ..options
    })
}

/// What the panel describes, as options of the command line.
fn options(state: &State, moment: &Moment, in_view: bool) -> Result<FigureOptions, Fault> {
    let form = &state.workspace().figure;
    // Surfaces are seen as in the window; meshes on them are drawn in space whatever it shows.
    let on_surfaces = moment.mesh.embedding().is_some();
    let ViewCamera { camera, size, .. } = match (on_surfaces, state.is_in_space()) {
        (false, _) => state.view().plane,
        (true, true) => state.view().space,
        (true, false) => ViewCamera::default(),
    };
    let side = camera.filter(|_| on_surfaces).map(|camera| Bearing::of_turn(camera.turn));
    let part = camera.filter(|_| in_view && size.min_element() > 0.0).map(|camera| {
        let centre = side.map_or(camera.centre.truncate(), |side| View::from(side).place(camera.centre));
        (FigurePart { centre, height: size.y / camera.points_per_unit() }, size.y / size.x)
    });
    form.options(part, side.map(|side| (side, state.workspace().surfaces.hidden)))
}

/// Starts to write the page with the notes on bookmarked steps, beside the window, in the working folder; does
/// nothing if nothing is open. The figures look as the panel says.
///
/// # Errors
/// If there is no bookmark, or the form has no meaning.
pub fn begin_notes(state: &State, wake: Wake) -> Result<Option<Writing>, Fault> {
    let Some(run) = state.current_run() else { return Ok(None) };
    if run.bookmarks.is_empty() {
        return Err(Fault::new("There are no bookmarks").remedy("Ctrl+B bookmarks the current step"));
    }
    let form = FigureForm { content: Content::State, in_view: false, ..state.workspace().figure.clone() };
    let side = state.view().space.camera.filter(|_| state.is_in_space()).map(|camera| Bearing::of_turn(camera.turn));
    let options = form.options(None, side.map(|side| (side, state.workspace().surfaces.hidden)))?;
    Ok(Some(files::work(wake, move || {
        let page = notes::page(&run, &options, true, &mut Nobody)?;
        let path = free_path(&format!("{}-notes", run.case.name), "html");
        save::save(&path, |file| file.write_all(page.as_bytes()))?;
        Ok(format!("The notes were saved as {}.", path.display()))
    })))
}

/// The text of the run at the current state, as figures carry it; none if the mesh that it starts from is gone.
pub fn carried(state: &State) -> Option<String> {
    let (moment, mut run) = (state.run().moment.as_ref()?, state.current_run()?);
    run.shown = Some(Shown { states: vec![shown(moment)], drawn: Vec::new() });
    run_file::embedded(&run).ok()
}

/// How files name the current state.
pub fn shown(moment: &Moment) -> ShownState {
    let state = fingerprint(&moment.mesh, &moment.phase);
    ShownState { step: moment.step, at: Some(Stop::Step(moment.step)), state }
}

/// The figure of the current state.
fn of_state(moment: &Arc<Moment>, opened: &Arc<Opened>, run: &Run, options: &FigureOptions) -> Result<Figure, Fault> {
    let Moment { mesh, parameters, phase, just_changed, candidates, .. } = moment.as_ref();
    let seen = Seen { mesh, parameters, phase, changed: just_changed, candidates: candidates.as_ref() };
    let statistics = match options.plot {
        Some(_) => Some(work::statistics(&Export::of(mesh, &Names::default()), &opened.background.sizing)?),
        None => None,
    };
    let frame = FigureFrame { statistics, ..FigureFrame::of(&seen, &options.look(false), shown(moment)) };
    Figure::of_run(run, &[frame], options, true)
}

/// Writes a figure under names that are free. Returns the message that says which.
fn write(figure: &Figure, stem: &str, formats: Formats) -> Result<String, Fault> {
    let mut names: Vec<String> = Vec::new();
    let mut keep = |extension: &str, bytes: &[u8]| {
        let path = free_path(stem, extension);
        names.push(path.display().to_string());
        save::save(&path, |out| out.write_all(bytes))
    };
    for format in formats.files() {
        keep(format.extension(), &figure.bytes(*format)?)?;
    }
    Ok(format!("The figure was saved as {}.", names.join(" and ")))
}
