//! The work of `core` as the commands need it: from a case to a mesh that can be written, and what is told about it.

use std::collections::BTreeMap;
use std::io;

use crate::core::background::adapt::Adapted;
use crate::core::convert::conversion::{self, Background, Converted};
use crate::core::convert::converter::{Converter, Counts};
use crate::core::convert::phase::Base;
use crate::core::convert::walk::{Stop, Tell, Told, walk_editing};
use crate::core::fault::Fault;
use crate::core::io::case::Case;
use crate::core::io::export::Export;
use crate::core::io::mesh_file::MeshFile;
use crate::core::io::report::{CaseTold, LastResort, Program, Report};
use crate::core::io::statistics::Statistics;
use crate::core::mesh::half_edge::Mesh;
use crate::core::mesh::soundness::{Allow, examine};
use crate::core::metric::field::Place;
use crate::core::progress::{Stage, Watch};
use crate::core::run::run::Run;
use crate::render::picture::Picture;

use super::input::{Stops, stop_text};
use super::output::Target;

/// The triangles that a conversion starts from.
pub(super) struct Triangles {
    /// The mesh with its metric, for files.
    pub file: MeshFile,
    /// What it is like.
    pub statistics: Statistics,
    /// What was mended in a mesh that was given.
    pub repairs: Vec<String>,
}

/// A conversion at its end, or at a stop before it.
pub(super) struct Quads {
    mesh: Mesh,
    /// Where it was stopped, and the base segment there, if there is one.
    stopped: Option<(Stop, Option<Base>)>,
    /// The mesh, for files.
    pub file: MeshFile,
    /// What is told about it; its timing is still empty.
    pub report: Report,
    /// What a check of the mesh found wrong: then there is a bug, and the mesh must not pass for valid.
    pub flaw: Option<Fault>,
}

/// Makes the triangles of a case.
pub(super) fn background(case: &Case, watch: &mut dyn Watch) -> Result<Triangles, Fault> {
    let Background { mesh, sizing, regions, repairs, .. } = conversion::background(case, watch)?;
    watch.tell(Stage::Check, 0, 0);
    let mut export = Export::of(&mesh, &regions);
    let statistics = Statistics::measure(export.measured(), &sizing)?;
    let places = export.file.points.iter().map(|p| Place::in_plane(p.truncate()));
    export.file.metric = Some(places.map(|place| sizing.metric3(&place)).collect::<Result<_, _>>()?);
    Ok(Triangles { file: export.file, statistics, repairs })
}

/// Converts the case of a run and writes each event to `events` as it happens: the file appears when the conversion is done.
pub(super) fn convert_telling(
    run: &Run,
    at: Option<Stop>,
    events: Option<&Target>,
    watch: &mut dyn Watch,
) -> Result<Quads, Fault> {
    let Some(events) = events else { return convert(run, at, None, watch) };
    let mut quads = None;
    let written = events.write(|out| {
        let mut written = Ok(());
        let mut tell = |told: &Told<'_>| {
            if written.is_ok() {
                written = serde_json::to_writer(&mut *out, told).map_err(io::Error::from).and_then(|()| writeln!(out));
            }
        };
        let done = quads.insert(convert(run, at, Some(&mut tell), watch));
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

/// Converts the case of a run to its end or to a stop, with the run's edits, checks and measures the result.
pub(super) fn convert(
    run: &Run,
    at: Option<Stop>,
    mut tell: Option<Tell<'_>>,
    watch: &mut dyn Watch,
) -> Result<Quads, Fault> {
    let case = &run.case;
    let mut stopped = None;
    let converted = conversion::convert_by(case, watch, &mut |converter, watch| {
        run.make_edits(converter, 0)?;
        walk_editing(converter, at, watch, tell.take(), &mut |c| run.make_edits(c, c.counts.steps))?;
        stopped = at.map(|stop| (stop, converter.phase().base().copied()));
        Ok(())
    })?;
    watch.tell(Stage::Check, 0, 0);
    let of = if at.is_some() { Export::of_state } else { Export::of };
    let export = of(&converted.mesh, &converted.regions);
    // On the way there are triangles; both sides of a crack lie at the same place.
    let flaw = flaw(&converted.mesh, &export.file, Allow { triangles: at.is_some(), seams: true, ..Allow::default() });
    let resort = converted.last_resort.quads();
    let report = Report {
        program: Program::this(),
        case: CaseTold::of(case),
        parameters: case.parameters.clone(),
        background_triangles: converted.triangles,
        regions: converted.regions.len(),
        valid: flaw.is_none(),
        mesh: Statistics::measure(export.measured(), &converted.sizing)?,
        last_resort: LastResort::of(resort, (converted.counts.formed + converted.counts.closed) as usize + resort),
        repairs: converted.repairs.clone(),
        events: events(&converted),
        timing: Vec::new(),
    };
    Ok(Quads { mesh: converted.mesh, stopped, file: export.file, report, flaw })
}

impl Quads {
    /// The picture of it, with the front where it was stopped.
    pub fn picture(&self, case: &Case) -> Picture {
        match &self.stopped {
            Some((stop, base)) => {
                Picture { title: stop_text(*stop), ..Picture::of_state(&self.mesh, &case.parameters, base.as_ref()) }
            }
            None => Picture::of_mesh(&self.file),
        }
    }
}

/// The pictures of a run at several stops, each with its stop as title.
pub(super) fn frames(run: &Run, stops: &Stops, watch: &mut dyn Watch) -> Result<Vec<Picture>, Fault> {
    let mut frames = Vec::new();
    conversion::convert_by(&run.case, watch, &mut |converter, watch| {
        run.make_edits(converter, 0)?;
        for &stop in &stops.0 {
            walk_editing(converter, stop, watch, None, &mut |c| run.make_edits(c, c.counts.steps))?;
            frames.push(Picture { title: stop.map_or_else(|| "end".to_owned(), stop_text), ..picture(converter) });
        }
        Ok(())
    })?;
    Ok(frames)
}

fn picture(converter: &Converter<'_>) -> Picture {
    Picture::of_state(&converter.mesh, converter.parameters(), converter.phase().base())
}

/// Everything that is checked on a mesh: its structure, exact convexity, and the file as others will see it.
fn flaw(mesh: &Mesh, file: &MeshFile, allow: Allow) -> Option<Fault> {
    if let Err(what) = mesh.check() {
        return Some(Fault::new(format!("The mesh is not sound: {what}")));
    }
    examine(file).verdict(allow).err()
}

fn events(converted: &Converted) -> BTreeMap<String, u64> {
    let Adapted { divisions, collapses, swaps, moves } = converted.adapted;
    let (resort, finished) = (converted.last_resort, converted.finished);
    let cleaned_up = finished.cleaned_up;
    let Counts {
        steps,
        formed,
        right_replaced,
        rescued,
        rolled_back,
        deferred,
        seamed,
        transitions,
        split,
        enhanced,
        removed,
        closed,
    } = converted.counts;
    let front = [
        ("front_closed", closed),
        ("front_deferred", deferred),
        ("front_enhanced", enhanced),
        ("front_formed", formed),
        ("front_node_removed", removed),
        ("front_rescued", rescued),
        ("front_right_replaced", right_replaced),
        ("front_rolled_back", rolled_back),
        ("front_seam", seamed),
        ("front_split", split),
        ("front_step", steps),
        ("front_transition_seam", transitions),
    ];
    let counts = [
        ("background_collapse", collapses),
        ("background_division", divisions),
        ("background_move", moves),
        ("background_swap", swaps),
        ("clean_up_collapse", cleaned_up.collapses),
        ("clean_up_doublet", cleaned_up.doublets),
        ("clean_up_opening", cleaned_up.openings),
        ("clean_up_pair", cleaned_up.pairs),
        ("clean_up_refused", cleaned_up.refused),
        ("clean_up_rotation", cleaned_up.rotations),
        ("clean_up_triple", cleaned_up.triples),
        ("last_resort_division", resort.divided),
        ("last_resort_merge", resort.merged),
        ("last_resort_recut", resort.recut),
        ("last_resort_template_quad", resort.template_quads),
        ("smoothing_move", finished.moves),
    ];
    let counts = counts.into_iter().map(|(name, count)| (name, count as u64));
    counts.chain(front).map(|(name, count)| (name.to_owned(), count)).collect()
}
