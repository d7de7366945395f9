//! Figures from the window: the state at hand, or several steps as a strip, made beside the window by what `render` is made by.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use super::files::{answers, free_path};
use super::session::{Moment, Opened};
use super::state::State;
use glam::DVec2;

use crate::app::figure::{self, Figure, FigureOptions, LayerWords, PartWords, Size, Wanted};
use crate::app::work::{self, Frame};
use crate::core::convert::walk::Stop;
use crate::core::fault::Fault;
use crate::core::formats::save;
use crate::core::mesh::names::Names;
use crate::core::progress::Nobody;
use crate::core::record::export::Export;
use crate::core::record::run_file;
use crate::core::run::run::Run;
use crate::core::run::shown::{Shown, ShownState, fingerprint};
use crate::render::camera::Bearing;
use crate::render::look::{HiddenLines, Ink, Layer, Layers, Part};
use crate::render::orthographic::View;
use crate::render::picture::{Picture, Seen};

/// What a figure is saved as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Formats {
    /// Vectors.
    Svg,
    /// Pixels drawn from them.
    Png,
    /// Both.
    Both,
}

impl Formats {
    /// How they are called.
    pub fn name(self) -> &'static str {
        match self {
            Formats::Svg => "SVG",
            Formats::Png => "PNG",
            Formats::Both => "SVG and PNG",
        }
    }
}

/// What a figure shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Content {
    /// The state at hand.
    #[default]
    State,
    /// The steps with a bookmark, side by side.
    Bookmarks,
    /// Stops that a person has written, side by side.
    Stops,
    /// Edge lengths of the state at hand.
    Lengths,
    /// Angles of the state at hand.
    Angles,
}

impl Content {
    /// All of them.
    pub const ALL: [Content; 5] =
        [Content::State, Content::Bookmarks, Content::Stops, Content::Lengths, Content::Angles];

    /// How it is called.
    pub fn name(self) -> &'static str {
        match self {
            Content::State => "this state",
            Content::Bookmarks => "the bookmarks, side by side",
            Content::Stops => "several NQ, side by side",
            Content::Lengths => "edge lengths (fig. 23)",
            Content::Angles => "angles (fig. 24)",
        }
    }
}

/// How figures are made, as a person has set it.
pub struct Figures {
    /// Whether the panel is shown.
    pub shown: bool,
    pub content: Content,
    /// NQ of a strip, with commas between.
    pub stops: String,
    /// As `--size` takes it; empty: as wide as a column, or a page.
    pub size: String,
    pub dpi: f64,
    pub grey: bool,
    pub transparent: bool,
    /// Layers that are other than usual.
    pub changed: Vec<(Layer, bool)>,
    /// Only what is in view.
    pub in_view: bool,
    /// Name without its ending; empty: after case and step.
    pub name: String,
    making: Vec<Receiver<Result<String, Fault>>>,
}

impl Default for Figures {
    fn default() -> Self {
        Figures {
            shown: false,
            content: Content::State,
            stops: "50,100,150".to_owned(),
            size: String::new(),
            dpi: 300.0,
            grey: false,
            transparent: false,
            changed: Vec::new(),
            in_view: false,
            name: String::new(),
            making: Vec::new(),
        }
    }
}

impl Figures {
    /// Whether the figure is a strip.
    pub fn is_strip(&self) -> bool {
        matches!(self.content, Content::Bookmarks | Content::Stops)
    }

    /// Whether one is being made.
    pub fn is_busy(&self) -> bool {
        !self.making.is_empty()
    }

    fn usual(&self) -> Layers {
        Layers::usual(if self.grey { Ink::Grey } else { Ink::Colour }, self.is_strip())
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

    /// The options of the command line that say the same.
    fn options(&self, part: Option<(Part, f64)>, view: Option<(Bearing, HiddenLines)>) -> Result<FigureOptions, Fault> {
        let wrong = |what: String| Fault::new(format!("The size of the figure is not understood: {what}"));
        let text = self.size.trim();
        let mut size: Option<Size> = if text.is_empty() { None } else { Some(text.parse().map_err(wrong)?) };
        if let Some((_, shape)) = part {
            // The page has the shape of the view, where it has none of its own.
            let usual = if self.is_strip() { 174.0 } else { 84.0 };
            size = Some(match size.unwrap_or(Size::Millimetres(usual, None)) {
                Size::Millimetres(w, None) => Size::Millimetres(w, Some((10.0 * w * shape).round() / 10.0)),
                Size::Pixels(w, None) => Size::Pixels(w, Some((f64::from(w) * shape).round() as u32)),
                whole => whole,
            });
        }
        let mut layers = self.usual();
        self.changed.iter().for_each(|(layer, on)| layers.set(*layer, *on));
        let plot = match self.content {
            Content::Lengths => Some(figure::Plot::Lengths),
            Content::Angles => Some(figure::Plot::Angles),
            _ => None,
        };
        Ok(FigureOptions {
            size,
            dpi: (self.dpi != 300.0).then_some(self.dpi),
            ink: self.grey.then_some(Ink::Grey),
            transparent: self.transparent.then_some(true),
            layers: (!self.changed.is_empty()).then(|| LayerWords::exactly(layers)),
            plot,
            part: part.map(|part| PartWords(part.0)),
            view: view.map(|view| view.0),
            hidden: view.map(|view| view.1).filter(|hidden| *hidden != HiddenLines::Off),
            columns: None,
        })
    }

    /// The steps of a strip.
    fn wanted(&self, bookmarks: &[u64]) -> Result<Vec<Wanted>, Fault> {
        if self.content == Content::Bookmarks {
            if bookmarks.is_empty() {
                return Err(Fault::new("There is no bookmark yet").remedy("Ctrl+B sets one at the step at hand"));
            }
            return Ok(bookmarks.iter().map(|step| Wanted::at(Some(Stop::Step(*step)))).collect());
        }
        let stops = crate::app::input::stops(&format!("nq={}", self.stops.replace(' ', "")));
        let stops = stops.map_err(|what| Fault::new(format!("\"{}\" are no stops: {what}", self.stops)))?;
        Ok(stops.0.into_iter().map(Wanted::at).collect())
    }
}

impl State {
    /// Makes the figure that the panel describes, on a thread of its own, in the working folder.
    pub fn save_figure(&mut self, formats: Formats) {
        let (Some(moment), Some(opened), Some(run)) = (self.moment.clone(), self.opened.clone(), self.run()) else {
            return;
        };
        // Surfaces are seen as in the window; meshes on them are drawn in space whatever it shows.
        let on_surfaces = moment.mesh.embedding().is_some();
        let (camera, size) = match (on_surfaces, self.is_in_space()) {
            (false, _) => (self.camera, self.view_size),
            (true, true) => (self.space.camera, self.space.size),
            (true, false) => (None, DVec2::ZERO),
        };
        let side = camera.filter(|_| on_surfaces).map(|camera| Bearing::of_turn(camera.turn));
        let part = camera.filter(|_| self.figures.in_view && size.min_element() > 0.0).map(|camera| {
            let centre = side.map_or(camera.centre.truncate(), |side| View::from(side).place(camera.centre));
            (Part { centre, height: size.y / camera.points_per_unit() }, size.y / size.x)
        });
        let planned = self.figures.options(part, side.map(|side| (side, self.space.hidden))).and_then(|options| {
            let strip = self.figures.is_strip();
            let wanted = if strip { Some(self.figures.wanted(&self.kept.bookmarks)?) } else { None };
            Ok((options, wanted))
        });
        let (options, wanted) = match planned {
            Ok(planned) => planned,
            Err(fault) => return self.complain(&fault),
        };
        let what = match self.figures.content {
            Content::State => format!("-step-{}", moment.step),
            Content::Lengths => format!("-step-{}-lengths", moment.step),
            Content::Angles => format!("-step-{}-angles", moment.step),
            Content::Bookmarks | Content::Stops => "-strip".to_owned(),
        };
        let name = self.figures.name.trim();
        let stem = if name.is_empty() { format!("{}{what}", run.case.name) } else { name.to_owned() };
        let (tell, told) = channel();
        let wake = self.wake.clone();
        std::thread::spawn(move || {
            let made = match wanted {
                Some(wanted) => {
                    let mut run = run;
                    run.case.parameters = run.parameters.clone();
                    figure::make(&run, &wanted, &options, true, &mut Nobody).map(|made| made.0)
                }
                None => of_state(&moment, &opened, &run, &options),
            };
            // Nobody listens where the window has been closed.
            let _ = tell.send(made.and_then(|figure| write(&figure, &stem, formats)));
            wake();
        });
        self.figures.making.push(told);
    }

    /// The text of the run at the state at hand, as figures carry it; none where a mesh that it starts from is gone.
    pub fn carried(&self) -> Option<String> {
        let (moment, mut run) = (self.moment.as_ref()?, self.run()?);
        run.shown = Some(Shown { states: vec![shown(moment)], drawn: Vec::new() });
        run_file::embedded(&run).ok()
    }

    /// Hears of the figures that were being made.
    pub fn hear_figures(&mut self) {
        for answer in answers(&mut self.figures.making) {
            match answer {
                Ok(names) => self.notice(format!("The figure was saved as {names}.")),
                Err(fault) => self.complain(&fault),
            }
        }
    }
}

/// The state at hand, as a figure says which it is.
fn shown(moment: &Moment) -> ShownState {
    let state = fingerprint(&moment.mesh, &moment.phase);
    ShownState { step: moment.step, at: Some(Stop::Step(moment.step)), state }
}

/// The figure of the state at hand.
fn of_state(moment: &Arc<Moment>, opened: &Arc<Opened>, run: &Run, options: &FigureOptions) -> Result<Figure, Fault> {
    let Moment { mesh, parameters, phase, just_changed, .. } = moment.as_ref();
    let seen = Seen { mesh, parameters, phase, changed: just_changed };
    let statistics = match options.plot {
        Some(_) => Some(work::statistics(&Export::of(mesh, &Names::default()), &opened.background.sizing)?),
        None => None,
    };
    let frame = Frame { picture: Picture::of_state(&seen, &options.look(false)), shown: shown(moment), statistics };
    Figure::of_run(run, &[frame], options, true)
}

/// Writes a figure under names that are free; those, for people.
fn write(figure: &Figure, stem: &str, formats: Formats) -> Result<String, Fault> {
    let mut names: Vec<PathBuf> = Vec::new();
    if formats != Formats::Png {
        let path = free_path(stem, "svg");
        save::save(&path, |out| out.write_all(figure.svg.as_bytes()))?;
        names.push(path);
    }
    if formats != Formats::Svg {
        let path = free_path(stem, "png");
        let pixels = figure.png()?;
        save::save(&path, |out| out.write_all(&pixels))?;
        names.push(path);
    }
    Ok(names.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" and "))
}
