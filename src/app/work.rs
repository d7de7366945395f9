//! The work of `core` as the commands need it: from a case to a mesh that can be written, and what is told about it.

use std::io;

use crate::core::case::parameters::Parameters;
use crate::core::case::{Case, DomainSource, MeshUse};
use crate::core::convert::conversion;
use crate::core::convert::converter::Converter;
use crate::core::convert::phase::Phase;
use crate::core::convert::walk::{StepReport, Stop, Tell, walk_editing};
use crate::core::fault::Fault;
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::half_edge::touched::Touched;
use crate::core::mesh::names::Names;
use crate::core::metric::field::Sizing;
use crate::core::prepare::{self, Background};
use crate::core::progress::{Stage, Watch};
use crate::core::record::export::Export;
use crate::core::record::report::Report;
use crate::core::record::statistics::{Measured, Statistics};
use crate::core::run::births::Births;
use crate::core::run::run::Run;
use crate::core::run::shown::{ShownState, fingerprint};
use crate::core::soup::mesh_file::MeshFile;
use crate::render::look::{Layer, Look};
use crate::render::picture::{Picture, Seen};

use super::figure::Wanted;
use super::output::Target;

/// Steps that are kept where the last one's changes are drawn.
const HISTORY: usize = 256;

/// The triangles that a conversion starts from.
pub(super) struct Triangles {
    /// Step 0 as a frame of a figure.
    pub frame: Frame,
    /// The mesh with its metric, for files.
    pub file: MeshFile,
    /// What it is like.
    pub statistics: Statistics,
    /// Repairs of a given mesh, as readable phrases.
    pub repairs: Vec<String>,
}

/// A conversion at its end, or at a stop before it.
pub(super) struct Quads {
    mesh: Mesh,
    /// The state that it is.
    pub shown: ShownState,
    phase: Phase,
    in_force: Parameters,
    /// The mesh, for files.
    pub file: MeshFile,
    /// What is told about it; its timing is still empty.
    pub report: Report,
    /// What a check of the mesh found wrong: then there is a bug, and the mesh must not pass for valid.
    pub flaw: Option<Fault>,
}

/// Makes the triangles of a case; with the data that are to be looked at where these are shown.
pub(super) fn background(case: &Case, shows_data: bool, watch: &mut dyn Watch) -> Result<Triangles, Fault> {
    let Background { mesh, sizing, names, repairs, .. } = prepare::background(case, watch)?;
    watch.tell(Stage::Check, 0, 0);
    let frame = {
        let (parameters, phase) = (&case.parameters, &Phase::Select);
        let shown = ShownState { step: 0, at: Some(Stop::Step(0)), state: fingerprint(&mesh, phase) };
        let seen = Seen { mesh: &mesh, parameters, phase, changed: &[] };
        Frame { picture: Picture::of_state(&seen, &Look::default()), shown, statistics: None }
    };
    let mut export = Export::of(&mesh, &names);
    let statistics = Statistics::measure(export.measured(), &sizing)?;
    if shows_data {
        export.describe(&mesh, &sizing, None)?;
    } else {
        export.file.metric = Some(export.chart.iter().map(|&p| sizing.metric3_at(p)).collect::<Result<_, _>>()?);
    }
    Ok(Triangles { frame, file: export.file, statistics, repairs })
}

/// Converts the case of a run and writes each event to `events` as it happens: the file appears when the conversion is done.
pub(super) fn convert_telling(
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
        let mut tell = |told: &StepReport<'_>| {
            if written.is_ok() {
                written = serde_json::to_writer(&mut *out, told).map_err(io::Error::from).and_then(|()| writeln!(out));
            }
        };
        let done = quads.insert(convert(run, at, Some(&mut tell), shows_data, watch));
        // What went wrong with the conversion is told in its own words; no file is left of it.
        if done.is_err() { Err(io::Error::other("the conversion failed")) } else { written }
    });
    match quads {
        Some(Err(fault)) => Err(fault),
        Some(Ok(quads)) => written.map(|()| quads),
        // The file could not even be begun.
        None => Err(written.err().unwrap_or_else(|| Fault::new("Nothing was written"))),
    }
}

/// Converts the case of a run to its end or to a stop, with the run's edits, checks and measures the result; where its data are shown,
/// with these, for which the faces go one after another.
pub(super) fn convert(
    run: &Run,
    at: Option<Stop>,
    mut tell: Option<Tell<'_>>,
    shows_data: bool,
    watch: &mut dyn Watch,
) -> Result<Quads, Fault> {
    let case = &run.case;
    let mut end = (Phase::Done, case.parameters.clone());
    let mut births = None;
    let converted = conversion::convert_by(case, watch, &mut |converter, watch| {
        run.make_edits(converter, 0)?;
        match tell.take() {
            // Nobody looks on the way: the faces go at the same time, to the same state.
            None if at.is_none() && run.edits().is_empty() && !shows_data => converter.run_by_faces(watch)?,
            tell => {
                if shows_data {
                    converter.keep_history();
                    births = Some(Births::of(&converter.mesh));
                }
                walk_editing(converter, at, watch, tell, &mut |c| {
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
        flaw = flaw.map(|fault| fault.remedy("Its triangles leave no better here: mesh its shape anew (--use shape)"));
    }
    let report = Report::of_export(case, &converted, &export, flaw.is_none())?;
    let (phase, in_force) = end;
    let state = fingerprint(&converted.mesh, &phase);
    let shown = ShownState { step: converted.counts.steps, at, state };
    Ok(Quads { mesh: converted.mesh, shown, phase, in_force, file: export.file, report, flaw })
}

impl Quads {
    /// The frame of it, for a figure.
    pub fn frame(&self, look: &Look) -> Frame {
        let (mesh, parameters, phase) = (&self.mesh, &self.in_force, &self.phase);
        let seen = Seen { mesh, parameters, phase, changed: &[] };
        Frame { picture: Picture::of_state(&seen, look), shown: self.shown, statistics: None }
    }
}

/// A state of a run, for a figure.
pub(super) struct Frame {
    /// What is to be seen.
    pub picture: Picture,
    /// Which state it is.
    pub shown: ShownState,
    /// What it is like, where that is plotted: its quadrilaterals, where there are any.
    pub statistics: Option<Statistics>,
}

/// The states of a run at several stops.
///
/// # Errors
/// As the conversion, and where it ends before a stop.
pub(super) fn frames(
    run: &Run,
    wanted: &[Wanted],
    look: &Look,
    plotted: bool,
    watch: &mut dyn Watch,
) -> Result<Vec<Frame>, Fault> {
    let mut frames = Vec::new();
    let mut meshes = Vec::new();
    let watches_changes = look.layers.has(Layer::Changed);
    let converted = conversion::convert_by(&run.case, watch, &mut |converter, watch| {
        run.make_edits(converter, 0)?;
        if watches_changes {
            converter.keep_history();
        }
        for wanted in wanted {
            walk_editing(converter, wanted.stop, watch, None, &mut |c| {
                shorten(c);
                run.make_edits(c, c.counts.steps)
            })?;
            let mut changed = Touched::default();
            converter.note_last_step(&mut changed);
            let (mesh, phase) = (&converter.mesh, converter.phase());
            let (parameters, changed) = (converter.parameters(), changed.elements());
            let seen = Seen { mesh, parameters, phase, changed };
            let shown = ShownState { step: converter.counts.steps, at: wanted.at, state: fingerprint(mesh, phase) };
            frames.push(Frame { picture: Picture::of_state(&seen, look), shown, statistics: None });
            if plotted {
                meshes.push(Export::of(mesh, &Names::default()));
            }
        }
        Ok(())
    })?;
    for (frame, export) in frames.iter_mut().zip(&meshes) {
        frame.statistics = Some(statistics(export, &converted.sizing)?);
    }
    Ok(frames)
}

/// Forgets all but the last step now and then, where a history is kept for that one alone.
fn shorten(converter: &mut Converter<'_>) {
    if converter.history_len() > HISTORY {
        converter.shorten_history(1);
    }
}

/// What a state is like: its quadrilaterals, where there are any, and else its triangles.
pub(super) fn statistics(export: &Export, sizing: &Sizing) -> Result<Statistics, Fault> {
    let all = export.measured();
    let of = if all.quads.is_empty() { all } else { Measured { triangles: &[], ..all } };
    Ok(Statistics::measure(of, sizing)?)
}

/// A mesh for other programs, with its data where they are to be looked at, and what a check finds wrong with it. On the way to the
/// end there are triangles and a front.
///
/// # Errors
/// Where the metric fails.
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
