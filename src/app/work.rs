//! The work of `core` as the commands need it: from a case to a mesh ready to be written, with its report.

use std::io;

use serde::Serialize;

use crate::core::case::{Case, DomainSource, MeshUse, Parameters};
use crate::core::convert::walk::walk_editing;
use crate::core::convert::{self, Candidates, Converter, Event, Phase, StepReport, Stop, Tell, conversion};
use crate::core::fault::Fault;
use crate::core::kernel::number::grouped;
use crate::core::mesh::{Mesh, Names, Touched};
use crate::core::metric::Sizing;
use crate::core::prepare::{Background, Spacing};
use crate::core::progress::{Stage, Watch};
use crate::core::record::{Export, Measured, Report, Statistics};
use crate::core::run::explain::{Narrator, beginning, plain};
use crate::core::run::shown::fingerprint;
use crate::core::run::{Births, Run, ShownState};
use crate::core::soup::MeshFile;
use crate::render::look::{Layer, Look};
use crate::render::picture::{Picture, Seen};

use super::figure::Wanted;
use super::output::Target;

/// Steps kept in the journal where the changes of the last one are drawn.
const HISTORY: usize = 256;

/// The triangles that a conversion starts from.
pub(super) struct Triangles {
    /// Step 0 as a frame of a figure.
    pub frame: FigureFrame,
    /// The mesh with its metric, for files.
    pub file: MeshFile,
    /// Its statistics.
    pub statistics: Statistics,
    /// Repairs made to an imported mesh, and what of its file is not read.
    pub repairs: Vec<String>,
    /// What the boundary makes of the sizes that are asked for.
    pub spacing: Spacing,
}

/// A conversion at its end or at an earlier stop.
pub(super) struct Quads {
    mesh: Mesh,
    /// The state it is in.
    pub shown: ShownState,
    phase: Phase,
    in_force: Parameters,
    /// The mesh, for files.
    pub file: MeshFile,
    /// The report, with its timing still empty.
    pub report: Report,
    /// What a check of the mesh found wrong: then the mesh must not pass for valid.
    pub flaw: Option<Fault>,
}

/// Makes the background mesh of a case, with data for viewing where `shows_data`.
pub(super) fn background(case: &Case, shows_data: bool, watch: &mut dyn Watch) -> Result<Triangles, Fault> {
    let Background { mesh, sizing, names, repairs, spacing, .. } = convert::background(case, watch)?;
    watch.tell(Stage::Check, 0, 0);
    let seen =
        Seen { mesh: &mesh, parameters: &case.parameters, phase: &Phase::Select, changed: &[], candidates: None };
    let shown = ShownState { step: 0, at: Some(Stop::Step(0)), state: fingerprint(&mesh, seen.phase) };
    let frame = FigureFrame::of(&seen, &Look::default(), shown);
    let mut export = Export::of(&mesh, &names);
    let statistics = Statistics::measure(export.measured(), &sizing)?;
    if shows_data {
        export.describe(&mesh, &sizing, None)?;
    } else {
        export.file.metric = Some(export.chart.iter().map(|&p| sizing.metric3_at(p)).collect::<Result<_, _>>()?);
    }
    Ok(Triangles { frame, file: export.file, statistics, repairs, spacing })
}

/// A line of the file of events: what a step did, and the same in a sentence.
#[derive(Serialize)]
struct EventLine<'e> {
    #[serde(flatten)]
    step: &'e StepReport<'e>,
    text: String,
}

/// Converts the case of a run and writes each event to `events` as it happens. The file appears when the conversion is
/// finished.
pub(super) fn convert_writing_events(
    run: &Run,
    at: Option<Stop>,
    events: Option<&Target>,
    shows_data: bool,
    watch: &mut dyn Watch,
) -> Result<Quads, Fault> {
    let Some(events) = events else { return convert(run, at, None, shows_data, watch) };
    let mut quads = None;
    let written = events.write(|out| {
        let mut written = Ok(());
        let mut narrator = Narrator::default();
        let mut tell = |step: &StepReport<'_>| {
            narrator.note(step.event);
            if written.is_ok() {
                let line = EventLine { step, text: plain(&narrator.tell(step.event)) };
                written = serde_json::to_writer(&mut *out, &line).map_err(io::Error::from).and_then(|()| writeln!(out));
            }
        };
        let done = quads.insert(convert(run, at, Some(&mut tell), shows_data, watch));
        // The conversion's own fault is reported below; this error only makes `write` discard the file.
        if done.is_err() { Err(io::Error::other("the conversion failed")) } else { written }
    });
    match quads {
        Some(Err(fault)) => Err(fault),
        Some(Ok(quads)) => written.map(|()| quads),
        // The file could not be created.
        None => Err(written.err().unwrap_or_else(|| Fault::new("Nothing was written"))),
    }
}

/// Converts the case of a run to its end or to a stop, with the run's edits, then checks and measures the result. Data
/// for viewing (`shows_data`) are recorded on the way, for which the faces are converted one after another.
pub(super) fn convert(
    run: &Run,
    at: Option<Stop>,
    mut tell: Option<Tell<'_>>,
    shows_data: bool,
    watch: &mut dyn Watch,
) -> Result<Quads, Fault> {
    let case = &run.case_in_force();
    let mut end = (Phase::Done, case.parameters.clone());
    let mut births = None;
    let converted = conversion::convert_by(case, watch, &mut |converter, watch| {
        run.make_edits(converter, 0)?;
        match tell.take() {
            // Nothing observes the steps: convert the faces in parallel, which gives the same state.
            None if at.is_none() && run.edits().is_empty() && !shows_data => converter.run_by_faces(watch)?,
            tell => {
                if shows_data {
                    converter.keep_history();
                    births = Some(Births::of(&converter.mesh));
                }
                walk_editing(converter, at, watch, tell, &mut |c, _| {
                    if let Some(births) = &mut births {
                        births.note(c);
                        shorten(c);
                    }
                    run.make_edits(c, c.counts.steps)
                })?;
            }
        }
        end = (converter.phase().plain(), converter.parameters().clone());
        Ok(())
    })?;
    watch.tell(Stage::Check, 0, 0);
    let data = shows_data.then_some((&converted.sizing, births.as_ref()));
    let (export, mut flaw) = exported(&converted.mesh, &converted.names, data, at.is_some())?;
    if converted.mesh.embedding().is_some() && takes_triangles(case) {
        flaw =
            flaw.map(|fault| fault.remedy("Its triangles allow nothing better here: remesh its shape (--use shape)"));
    }
    let report = Report::of_export(case, &converted, &export, flaw.is_none())?;
    let (phase, in_force) = end;
    let state = fingerprint(&converted.mesh, &phase);
    let shown = ShownState { step: converted.counts.steps, at, state };
    Ok(Quads { mesh: converted.mesh, shown, phase, in_force, file: export.file, report, flaw })
}

impl Quads {
    /// Its frame for a figure.
    pub fn frame(&self, look: &Look) -> FigureFrame {
        let seen =
            Seen { mesh: &self.mesh, parameters: &self.in_force, phase: &self.phase, changed: &[], candidates: None };
        FigureFrame::of(&seen, look, self.shown)
    }
}

/// A state of a run, for a figure.
pub(super) struct FigureFrame {
    /// The picture.
    pub picture: Picture,
    /// The state that it shows.
    pub shown: ShownState,
    /// Its statistics, where they are plotted: of its quadrilaterals, or of its triangles where it has none.
    pub statistics: Option<Statistics>,
    /// What the last step did, in a sentence; empty where that is not known.
    pub caption: String,
    /// Its step and the number of quadrilaterals that stand; empty where that is not known.
    pub name: String,
}

impl FigureFrame {
    /// A state, without statistics and caption.
    pub fn of(seen: &Seen<'_>, look: &Look, shown: ShownState) -> FigureFrame {
        FigureFrame {
            picture: Picture::of_state(seen, look),
            shown,
            statistics: None,
            caption: String::new(),
            name: String::new(),
        }
    }
}

/// The states of a run at several stops.
///
/// # Errors
/// As the conversion; it ends before a stop.
pub(super) fn frames(
    run: &Run,
    wanted: &[Wanted],
    look: &Look,
    plotted: bool,
    watch: &mut dyn Watch,
) -> Result<Vec<FigureFrame>, Fault> {
    let mut frames = Vec::new();
    let mut meshes = Vec::new();
    let converted = conversion::convert_by(&run.case_in_force(), watch, &mut |converter, watch| {
        run.make_edits(converter, 0)?;
        let mut walked = Walked::new(run, converter, look);
        for wanted in wanted {
            walked.to(wanted.stop, watch, &mut |_, _| Ok(()))?;
            frames.push(walked.frame(wanted.at));
            if plotted {
                meshes.push(Export::of(&walked.converter.mesh, &Names::default()));
            }
        }
        Ok(())
    })?;
    for (frame, export) in frames.iter_mut().zip(&meshes) {
        frame.statistics = Some(statistics(export, &converted.sizing)?);
    }
    Ok(frames)
}

/// A conversion on its way to the states that figures show.
pub(super) struct Walked<'w, 'a> {
    run: &'w Run,
    look: &'w Look,
    /// The conversion.
    pub converter: &'w mut Converter<'a>,
    /// Its last step.
    pub last: LastStep,
}

/// What figures show of the last step.
#[derive(Default)]
pub(super) struct LastStep {
    event: Option<Event>,
    narrator: Narrator,
    /// What a side was chosen from, and what the next step chooses one from, where that is drawn.
    tried: Option<Candidates>,
    next: Option<Candidates>,
}

impl LastStep {
    /// What it did, in a sentence.
    pub fn caption(&self, mesh: &Mesh) -> String {
        plain(&self.event.as_ref().map_or_else(|| beginning(mesh), |event| self.narrator.tell(event)))
    }

    /// The state after it as a figure; `at` is the stop that names it.
    pub fn frame(&self, converter: &Converter<'_>, look: &Look, at: Option<Stop>) -> FigureFrame {
        let mut changed = Touched::default();
        converter.note_last_step(&mut changed);
        let (mesh, phase) = (&converter.mesh, converter.phase());
        let (changed, candidates) = (changed.elements(), self.tried.as_ref());
        let seen = Seen { mesh, parameters: converter.parameters(), phase, changed, candidates };
        let shown = ShownState { step: converter.counts.steps, at, state: fingerprint(mesh, phase) };
        let name = format!("step {}, NQ {}", grouped(shown.step), grouped(converter.standing()));
        FigureFrame { caption: self.caption(mesh), name, ..FigureFrame::of(&seen, look, shown) }
    }
}

impl<'w, 'a> Walked<'w, 'a> {
    /// Starts at step 0 of a run, whose edits are made.
    pub fn new(run: &'w Run, converter: &'w mut Converter<'a>, look: &'w Look) -> Walked<'w, 'a> {
        if look.layers.has(Layer::Changed) {
            converter.keep_history();
        }
        let next = if look.layers.has(Layer::Candidates) { converter.candidates() } else { None };
        Walked { run, look, converter, last: LastStep { next, ..LastStep::default() } }
    }

    /// Goes on to a stop, or to the end; `each` is told of every step.
    ///
    /// # Errors
    /// As the conversion, and those of `each`; it ends before the stop.
    pub fn to(
        &mut self,
        stop: Option<Stop>,
        watch: &mut dyn Watch,
        each: &mut dyn FnMut(&Converter<'_>, &LastStep) -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let Walked { run, look, converter, last } = self;
        walk_editing(converter, stop, watch, None, &mut |c, event| {
            shorten(c);
            run.make_edits(c, c.counts.steps)?;
            if look.layers.has(Layer::Candidates) {
                (last.tried, last.next) = (last.next.take(), c.candidates());
            }
            last.narrator.note(event);
            last.event = Some(*event);
            each(c, last)
        })
    }

    /// The state that it is in, as a figure; `at` is the stop that names it.
    pub fn frame(&self, at: Option<Stop>) -> FigureFrame {
        self.last.frame(self.converter, self.look, at)
    }
}

/// Drops all but the last step of the journal now and then, where only that one is needed.
fn shorten(converter: &mut Converter<'_>) {
    if converter.history_len() > HISTORY {
        converter.shorten_history(1);
    }
}

/// The statistics of a state: of its quadrilaterals, or of its triangles where it has none.
pub(super) fn statistics(export: &Export, sizing: &Sizing) -> Result<Statistics, Fault> {
    let all = export.measured();
    let of = if all.quads.is_empty() { all } else { Measured { triangles: &[], ..all } };
    Ok(Statistics::measure(of, sizing)?)
}

/// The mesh for other programs, with `data` for viewing, and what the checks of topology, exact convexity and the
/// exported file find wrong with it. Before the end of a conversion (`on_the_way`) it has triangles and a front.
///
/// # Errors
/// The metric cannot be evaluated.
pub(super) fn exported(
    mesh: &Mesh,
    names: &Names,
    data: Option<(&Sizing, Option<&Births>)>,
    on_the_way: bool,
) -> Result<(Export, Option<Fault>), Fault> {
    let mut export = if on_the_way { Export::of_state(mesh, names) } else { Export::of(mesh, names) };
    if let Some((sizing, births)) = data {
        export.describe(mesh, sizing, births)?;
    }
    let flaw = export.flaw(mesh, on_the_way);
    Ok((export, flaw))
}

/// Whether the triangles of a mesh are converted as they are.
fn takes_triangles(case: &Case) -> bool {
    matches!(&case.domain, DomainSource::Mesh { taking, .. } if taking.used == Some(MeshUse::Triangles))
}
