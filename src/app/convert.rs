//! `convert` and `background`: from a case or a mesh to files.

use std::process::ExitCode;

use super::command_line::{BackgroundArguments, ConvertArguments};
use super::figure::{self, Figure, FigureOptions, LayerWords};
use super::input::Until;
use super::memory::Beside;
use super::output::{self, MeshTarget, Stream};
use super::progress::Progress;
use super::{FALLS_SHORT, complain, input, work};
use crate::core::case::{Case, Parameters};
use crate::core::convert::Stop;
use crate::core::fault::Fault;
use crate::core::progress::{Stage, Watch};
use crate::core::record::report::background_summary;
use crate::core::run::Shown;
use crate::core::soup::MeshFile;

/// Converts, and writes the requested mesh, report, events and picture.
///
/// Exit code 1 where the result is not valid, as for `check`: then no mesh is written, but report and picture show it.
pub(super) fn convert(arguments: &ConvertArguments) -> Result<ExitCode, Fault> {
    let (source, destination) = (&arguments.source, &arguments.destination);
    let mesh_target = MeshTarget::of(destination)?;
    let targets = [destination.out.as_ref(), arguments.report.as_ref(), arguments.events.as_ref()];
    let messages = output::check(&targets, destination.picture.as_ref())?;
    let mut progress = Progress::new(source.quiet);
    progress.tell(Stage::Read, 0, 0);
    let input = input::read(source, &arguments.mesh.options())?;
    let shown = input.figure.as_ref().and_then(Shown::state);
    let at = match (arguments.at, shown) {
        (Some(Until::Stop(stop)), _) => Some(stop),
        (Some(Until::End), _) => None,
        // A figure selects the state that it shows.
        (None, shown) => shown.and_then(|shown| shown.at.map(|_| Stop::Step(shown.step))),
    };
    let shows_data = mesh_target.as_ref().is_some_and(MeshTarget::shows_data);
    if shows_data {
        progress = progress.keeping(Beside::Data);
    }
    let mut quads = work::convert_writing_events(&input.run, at, arguments.events.as_ref(), shows_data, &mut progress)
        .map_err(|fault| if shown.is_some() { fault.at(source.input.clone()) } else { fault })?;
    progress.tell(Stage::Write, 0, 0);
    // Write only valid meshes.
    if quads.flaw.is_none() {
        write(mesh_target.as_ref(), &quads.file)?;
    }
    if let Some(target) = &destination.picture {
        let options = FigureOptions::default();
        let frame = quads.frame(&options.look(false));
        let figure = Figure::of_run(&input.run, &[frame], &options, input.can_be_embedded())?;
        output::write_figure(target, &figure)?;
    }
    quads.report.timing = progress.finish();
    if let Some(target) = &arguments.report {
        target.write(|out| out.write_all(quads.report.json().as_bytes()))?;
    }
    if let Some(shown) = shown.filter(|shown| arguments.at.is_none() && shown.state != quads.shown.state) {
        Stream::Error.print(&format!("{}\n", figure::another_state(&source.input, shown.step)));
    }
    if !source.quiet {
        messages.print(&quads.report.summary());
        if let Some(at) = at.filter(|_| arguments.at.is_none()) {
            messages.print(&format!("This is the state that the figure shows, {at}. --at end converts to the end.\n"));
        }
        remind(mesh_target.is_none() && destination.picture.is_none() && arguments.events.is_none(), messages);
    }
    let Some(flaw) = &quads.flaw else { return Ok(ExitCode::SUCCESS) };
    complain(flaw);
    if mesh_target.is_some() {
        Stream::Error.print("No mesh was written.\n");
    }
    Ok(ExitCode::from(FALLS_SHORT))
}

/// Makes the background mesh, and writes it with its metric.
pub(super) fn background(arguments: &BackgroundArguments) -> Result<(), Fault> {
    let (source, destination) = (&arguments.source, &arguments.destination);
    let mesh_target = MeshTarget::of(destination)?;
    let messages = output::check(&[destination.out.as_ref()], destination.picture.as_ref())?;
    mesh_target.as_ref().map_or(Ok(()), |target| target.spare(source.sol.as_deref()))?;
    let mut progress = Progress::new(source.quiet);
    progress.tell(Stage::Read, 0, 0);
    let input = input::read(source, &arguments.mesh.options())?;
    let shows_data = mesh_target.as_ref().is_some_and(MeshTarget::shows_data);
    let triangles = work::background(&input.run.case, shows_data, &mut progress)?;
    progress.tell(Stage::Write, 0, 0);
    write(mesh_target.as_ref(), &triangles.file)?;
    if let Some(target) = &destination.picture {
        let options = FigureOptions { layers: Some(LayerWords::mesh()), ..FigureOptions::default() };
        let figure = Figure::of_run(&input.run, &[triangles.frame], &options, input.can_be_embedded())?;
        output::write_figure(target, &figure)?;
    }
    let timing = progress.finish();
    if !source.quiet {
        let (statistics, repairs, spacing) = (&triangles.statistics, &triangles.repairs, &triangles.spacing);
        messages.print(&background_summary(&input.run.case, statistics, repairs, spacing, &timing));
        if let Some(lack) = mesh_target.as_ref().and_then(MeshTarget::lacks_metric) {
            Stream::Error.print(&lack);
        }
        remind(mesh_target.is_none() && destination.picture.is_none(), messages);
    }
    Ok(())
}

fn write(target: Option<&MeshTarget>, mesh: &MeshFile) -> Result<(), Fault> {
    target.map_or(Ok(()), |target| target.write(mesh))
}

/// The origin of a picture: program, case, and parameters that differ from the default.
pub(super) fn describe(case: &Case) -> String {
    let set: Vec<_> = Parameters::KEYS
        .iter()
        .filter_map(|key| {
            let text = case.parameters.text_of(key)?;
            (Parameters::default().text_of(key)? != text).then(|| format!("{key} = {text}"))
        })
        .collect();
    format!(
        "{} {}, case {}{}{}",
        env!("CARGO_PKG_NAME"),
        env!("CARGO_PKG_VERSION"),
        case.name,
        if set.is_empty() { "" } else { ", with " },
        set.join(", ")
    )
}

/// Reminds that no output was requested.
fn remind(no_output: bool, messages: Stream) {
    if no_output {
        messages.print("No mesh was written: -o FILE writes it.\n");
    }
}
