//! The plan of a film: which states are its frames, known by a first walk through the conversion, and what all of them
//! have in common.

use glam::DVec2;

use super::options::{FilmCamera, FilmOptions};
use crate::app::figure::FigureOptions;
use crate::app::figure::every::{MOST_FRAMES, Next, too_many};
use crate::app::input::Until;
use crate::app::work::{FigureFrame, LastStep, Walked};
use crate::core::convert::{Converter, Phase};
use crate::core::fault::Fault;
use crate::core::mesh::{Mesh, Names, NodeId};
use crate::core::prepare::Background;
use crate::core::progress::Watch;
use crate::core::record::Export;
use crate::core::run::Run;
use crate::render::following::Extent;
use crate::render::look::Look;
use crate::render::orthographic::{self, View};
use crate::render::scene::Decision;

/// At most twice this many frames are kept as samples of the colours.
const SAMPLES: usize = 12;

/// A frame that is still to be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shot {
    /// Its step.
    pub step: u64,
    /// What a camera that follows shows; `None`: everything.
    pub followed: Option<Extent>,
}

/// The plan of a film.
pub(super) struct Plan {
    /// Its frames, at least two.
    pub shots: Vec<Shot>,
    /// The first frame.
    pub first: FigureFrame,
    /// Some frames at equal distances, with their numbers.
    pub samples: Vec<(usize, FigureFrame)>,
    /// The box around the first picture.
    pub extent: Extent,
    /// The rows of the longest caption.
    pub rows: usize,
}

/// The fault that there is no frame after the first.
pub(super) fn ends_where_it_begins() -> Fault {
    let fault = Fault::new("The film ends where it begins, or before");
    fault.at("--to").remedy("Name a later stop, or an earlier one with --from")
}

impl Plan {
    /// Walks through a conversion and notes the frames.
    ///
    /// # Errors
    /// As the conversion; a stop that it does not reach; no second frame; too many.
    pub fn of(
        run: &Run,
        background: &Background,
        film: &FilmOptions,
        figure: &FigureOptions,
        watch: &mut dyn Watch,
    ) -> Result<Plan, Fault> {
        let look = figure.look(false);
        let mut converter = run.start(background)?;
        let mut followed = Followed::of(&converter.mesh, film, &look);
        let mut walked = Walked::new(run, &mut converter, &look);
        walked.to(Some(film.from), watch, &mut |c, _| {
            followed.note(c);
            Ok(())
        })?;
        let first = walked.frame(None);
        let width = figure.sheet(false, "", "", None).width;
        let rows = |caption: &str| figure.caption(caption).map_or(0, |caption| caption.wrapped(width).len());
        let extent = first.picture.bounds().unwrap_or([DVec2::ZERO, DVec2::ONE]);
        let mut plan = Plan { shots: Vec::new(), samples: Vec::new(), extent, rows: 0, first };
        let mut kept = Samples::default();
        let mut add = |c: &Converter<'_>, last: &LastStep, followed: &Followed| {
            plan.rows = plan.rows.max(rows(&last.caption(&c.mesh)));
            kept.offer(plan.shots.len(), || last.frame(c, &look, None));
            plan.shots.push(Shot { step: c.counts.steps, followed: followed.now });
            if plan.shots.len() > MOST_FRAMES {
                return Err(too_many("The film", MOST_FRAMES));
            }
            Ok(())
        };
        add(walked.converter, &walked.last, &followed)?;
        let mut next = Next::new(walked.converter, film.every);
        let to = match film.to {
            Until::Stop(stop) => Some(stop),
            Until::End => None,
        };
        walked.to(to, watch, &mut |c, last| {
            followed.note(c);
            if next.is_reached(c) { add(c, last, &followed) } else { Ok(()) }
        })?;
        // The last state is a frame in any case.
        if !next.is_noted(walked.converter) {
            add(walked.converter, &walked.last, &followed)?;
        }
        if plan.shots.len() < 2 {
            return Err(ends_where_it_begins());
        }
        plan.samples = kept.frames;
        if walked.converter.mesh.symmetry().is_some()
            && let Some([low, high]) = walked.frame(None).picture.bounds()
        {
            // The image of a half lies beyond what the first frame shows.
            plan.extent = [plan.extent[0].min(low), plan.extent[1].max(high)];
        }
        Ok(plan)
    }
}

/// Frames at equal distances, of a number that is not known before.
struct Samples {
    frames: Vec<(usize, FigureFrame)>,
    distance: usize,
}

impl Default for Samples {
    fn default() -> Self {
        Samples { frames: Vec::new(), distance: 1 }
    }
}

impl Samples {
    /// Keeps a frame, or not. Whenever there are too many, every other one is dropped.
    fn offer(&mut self, k: usize, frame: impl FnOnce() -> FigureFrame) {
        if !k.is_multiple_of(self.distance) {
            return;
        }
        self.frames.push((k, frame()));
        if self.frames.len() > 2 * SAMPLES {
            self.distance *= 2;
            self.frames.retain(|(k, _)| k.is_multiple_of(self.distance));
        }
    }
}

/// What a camera follows: the quadrilateral under way or, until the next one is begun, the one before; the whole mesh
/// before the first and after the last one.
struct Followed {
    is_wanted: bool,
    place: Place,
    now: Option<Extent>,
}

/// Where nodes lie in the picture.
enum Place {
    Parametric,
    AsTheyLie,
    Seen(View),
}

impl Followed {
    fn of(mesh: &Mesh, film: &FilmOptions, look: &Look) -> Followed {
        let is_flat = || orthographic::is_flat(&Export::of(mesh, &Names::default()).file);
        let place = match mesh.embedding() {
            Some(_) if look.parametric => Place::Parametric,
            None => Place::Parametric,
            Some(_) if is_flat() => Place::AsTheyLie,
            Some(_) => Place::Seen(View::from(look.from)),
        };
        Followed { is_wanted: film.camera == FilmCamera::Follow, place, now: None }
    }

    fn note(&mut self, converter: &Converter<'_>) {
        if !self.is_wanted {
            return;
        }
        let mesh = &converter.mesh;
        let decision = Decision::of(converter.phase());
        let nodes = decision.letters().map(|(node, _)| node).filter(|node| mesh.has_node(*node));
        let places = nodes.map(|node| self.at(mesh, node)).map(|p| [p, p]);
        let around = places.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        match converter.phase() {
            Phase::PostProcess { .. } | Phase::Mirror | Phase::Done => self.now = None,
            _ => self.now = around.or(self.now),
        }
    }

    fn at(&self, mesh: &Mesh, node: NodeId) -> DVec2 {
        match &self.place {
            Place::Parametric => mesh.uv(node),
            Place::AsTheyLie => mesh.xyz(node).truncate(),
            Place::Seen(view) => view.place(mesh.xyz(node)),
        }
    }
}
