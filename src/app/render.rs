//! `render`: draws a mesh file, the mesh of a case, or states of a conversion as a figure.

use super::command_line::RenderArguments;
use super::figure::every::{self, Every, MOST_FRAMES, numbered, too_many};
use super::figure::{self, Figure, FigureOptions, Wanted};
use super::input::{self, Input};
use super::output::{self, Stream, Target};
use super::progress::Progress;
use crate::core::case::ImportOptions;
use crate::core::fault::Fault;
use crate::core::kernel::number::counted;
use crate::core::progress::{Stage, Watch};
use crate::core::record::run_file::MOST_STATES;
use crate::render::picture::Picture;

/// Draws the input.
pub(super) fn render(arguments: &RenderArguments) -> Result<(), Fault> {
    let source = &arguments.source;
    output::check(&[], Some(&arguments.out))?;
    if arguments.at.is_none()
        && arguments.every.is_none()
        && arguments.figure.plot.is_none()
        && let Some(mesh) = input::read_mesh(&source.input, source.from, &mut Progress::new(source.quiet))?
    {
        arguments.figure.check_captions(false).map_err(|fault| fault.remedy("Leave it out for a mesh file"))?;
        let picture =
            Picture { title: source.input.clone(), ..Picture::of_mesh_by(&mesh, &arguments.figure.look(false)) };
        return output::write_figure(&arguments.out, &Figure::of_mesh(&picture, &arguments.figure));
    }
    let mut progress = Progress::new(source.quiet);
    progress.tell(Stage::Read, 0, 0);
    let mesh = ImportOptions { split_odd: arguments.split_odd, ..ImportOptions::default() };
    let input = input::read(source, &mesh)?;
    let shown = input.figure.as_ref();
    let options = arguments.figure.or(shown).map_err(|fault| fault.at(source.input.clone()))?;
    if let Some(every) = arguments.every {
        return several(arguments, &input, every, &options, progress);
    }
    let wanted: Vec<Wanted> = match (&arguments.at, shown) {
        (Some(stops), _) => stops.0.iter().copied().map(Wanted::at).collect(),
        (None, Some(shown)) => Wanted::of(shown),
        (None, None) => vec![Wanted::at(None)],
    };
    let (figure, frames) = figure::make(&input.run, &wanted, &options, input.can_be_embedded(), &mut progress)
        // The embedded run was not written by hand: report its faults as the figure's.
        .map_err(|fault| if shown.is_some() { fault.at(source.input.clone()) } else { fault })?;
    progress.finish();
    if let Some(shown) = shown.filter(|_| arguments.at.is_none())
        && let Some(difference) = figure::difference(&source.input, shown, &frames)
    {
        Stream::Error.print(&format!("{difference}\n"));
    }
    output::write_figure(&arguments.out, &figure)
}

/// Draws states at equal distances: each in a file of its own, which is what `--at` draws of it, or all on one page.
fn several(
    arguments: &RenderArguments,
    input: &Input,
    every: Every,
    options: &FigureOptions,
    mut progress: Progress,
) -> Result<(), Fault> {
    let RenderArguments { at, out, source, .. } = arguments;
    let on_one_page = options.contact_sheet == Some(true);
    options.check(1)?;
    if options.plot.is_some() {
        return Err(Fault::new("Several states are drawn as meshes, not as plots").at("--plot").remedy("Leave it out"));
    }
    let ends = every::ends(at.as_ref())?;
    let look = options.look(on_one_page);
    let embeds = input.can_be_embedded();
    if on_one_page {
        let mut frames = Vec::new();
        every::walk(&input.run, ends, every, &look, &mut progress, &mut |frame| {
            frames.push(frame);
            if frames.len() > MOST_STATES { Err(too_many("The contact sheet", MOST_STATES)) } else { Ok(()) }
        })?;
        progress.tell(Stage::Draw, 0, 0);
        let figure = Figure::of_run(&input.run, &frames, options, embeds)?;
        progress.finish();
        return output::write_figure(out, &figure);
    }
    let Target::File(path) = out else {
        return Err(Fault::new("Several files need names")
            .at("standard output")
            .remedy("Name one, such as -o front.svg"));
    };
    let mut files = 0;
    every::walk(&input.run, ends, every, &look, &mut progress, &mut |frame| {
        files += 1;
        if files > MOST_FRAMES {
            return Err(too_many("The run", MOST_FRAMES));
        }
        let figure = Figure::of_run(&input.run, &[frame], options, embeds)?;
        output::write_figure(&Target::File(numbered(path, files)), &figure)
    })?;
    progress.finish();
    if !source.quiet {
        let [first, last] = [1, files].map(|number| numbered(path, number).display().to_string());
        Stream::Output.print(&format!("{}: {first} to {last}.\n", counted(files as u64, "file")));
    }
    Ok(())
}
