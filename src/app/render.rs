//! `render`: draws a mesh file, the mesh of a case, or states of a conversion as a figure.

use super::command_line::RenderArguments;
use super::figure::{self, Figure, Wanted};
use super::input;
use super::output::{self, Stream};
use super::progress::Progress;
use crate::core::case::ImportOptions;
use crate::core::fault::Fault;
use crate::core::progress::{Stage, Watch};
use crate::render::picture::Picture;

/// Draws the input.
pub(super) fn render(arguments: &RenderArguments) -> Result<(), Fault> {
    let source = &arguments.source;
    output::check(&[], Some(&arguments.out))?;
    if arguments.at.is_none()
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
