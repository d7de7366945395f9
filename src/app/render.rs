//! `render`: a mesh as it is, or the mesh of a case, as a picture.

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
    if let Some(mesh) = input::read_mesh(&source.input, source.from)? {
        let picture = Picture { title: source.input.clone(), ..Picture::of_mesh(&mesh) };
        return arguments.out.write(|out| out.write_all(svg::write(&picture, svg::COLUMN).as_bytes()));
    }
    let mut progress = Progress::new(source.quiet);
    progress.tell(Stage::Read, 0, 0);
    let input = input::read(source)?;
    let quads = work::convert(&input.case, &mut progress)?;
    progress.finish();
    convert::draw(Some(&arguments.out), &input.case, &quads.file)
}
