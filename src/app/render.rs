//! `render`: a mesh as it is, the mesh of a case, or a conversion on the way, as a picture.

use super::command_line::RenderArguments;
use super::progress::Progress;
use super::{convert, input, output, work};
use crate::core::fault::Fault;
use crate::core::progress::{Stage, Watch};
use crate::render::picture::Picture;
use crate::render::vector::svg;

/// Draws the input.
pub(super) fn render(arguments: &RenderArguments) -> Result<(), Fault> {
    let source = &arguments.source;
    output::check(&[], Some(&arguments.out))?;
    if arguments.at.is_none()
        && let Some(mesh) = input::read_mesh(&source.input, source.from)?
    {
        let picture = Picture { title: source.input.clone(), ..Picture::of_mesh(&mesh) };
        let svg = svg::write(&picture, svg::COLUMN);
        return output::write_picture(&arguments.out, &svg, convert::PRINT, &picture.title);
    }
    let mut progress = Progress::new(source.quiet);
    progress.tell(Stage::Read, 0, 0);
    let input = input::read(source)?;
    let case = &input.run.case;
    match &arguments.at {
        None => {
            let quads = work::convert(&input.run, None, None, &mut progress)?;
            progress.finish();
            convert::draw(&arguments.out, case, quads.picture(case), arguments.size)
        }
        Some(stops) => {
            let mut frames = work::frames(&input.run, stops, &mut progress)?;
            progress.finish();
            if frames.len() == 1 {
                return convert::draw(&arguments.out, case, frames.remove(0), arguments.size);
            }
            let description = convert::describe(case);
            let strip = svg::strip(&frames, &case.title, &description, svg::PAGE);
            output::write_picture(&arguments.out, &strip, convert::PRINT, &description)
        }
    }
}
