//! The files of a sweep. They are written anew after each cell, so that whatever ends a sweep leaves what it has.

use std::path::Path;

use crate::app::convert::describe;
use crate::app::figure::Figure as Drawn;
use crate::app::output::{self, PictureFormat, Stream, Target};
use crate::core::case::Case;
use crate::core::fault::Fault;
use crate::core::formats::save::load;
use crate::core::record::report::figures::Figure;
use crate::core::record::sweep::Sweep;
use crate::render::vector::heat_map;

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Picture(PictureFormat),
    Csv,
    Json,
}

impl Kind {
    fn of(path: &Path) -> Result<Kind, Fault> {
        if let Some(format) = PictureFormat::named(path) {
            return Ok(Kind::Picture(format));
        }
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("csv") => Ok(Kind::Csv),
            Some("json") => Ok(Kind::Json),
            _ => {
                let known: String =
                    PictureFormat::ALL.iter().map(|format| format!(".{}, ", format.extension())).collect();
                Err(Fault::new("A sweep is not written in this format")
                    .at(path.display().to_string())
                    .remedy(format!("Name a file that ends in {known}.csv or .json")))
            }
        }
    }
}

/// What is shown of a sweep.
#[derive(Clone, Copy)]
pub(in crate::app) struct SweepLook<'a> {
    /// The figure in the picture.
    pub figure: &'a Figure,
    /// Whether tables have the time of each cell.
    pub with_time: bool,
}

/// The files that a sweep is written to, each in the format of its extension.
pub(in crate::app) struct Outputs(Vec<(Target, Kind)>);

impl Outputs {
    /// The outputs with these targets, and the stream for messages.
    ///
    /// # Errors
    /// A target that cannot be written or is there twice, an unknown extension.
    pub fn of(targets: &[Target]) -> Result<(Outputs, Stream), Fault> {
        let messages = output::check(&targets.iter().map(Some).collect::<Vec<_>>(), None)?;
        let kind = |target: &Target| match target {
            Target::File(path) => Kind::of(path),
            Target::StandardOutput => Err(Fault::new("The format is not known")
                .at("standard output")
                .remedy("Name files, such as -o sweep.csv; without any, the sweep is printed as a table")),
        };
        let kinds = targets.iter().map(|target| Ok((target.clone(), kind(target)?)));
        Ok((Outputs(kinds.collect::<Result<_, Fault>>()?), messages))
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Takes over the cells of the sweep from JSON files that an earlier command has left, and returns what is to be
    /// said about it.
    ///
    /// # Errors
    /// A JSON file that cannot be read, or is no sweep: it is not written over.
    pub fn go_on(&self, sweep: &mut Sweep) -> Result<Vec<String>, Fault> {
        let mut said = Vec::new();
        for (target, kind) in &self.0 {
            let (Target::File(path), Kind::Json) = (target, kind) else { continue };
            if !path.exists() {
                continue;
            }
            let name = path.display();
            said.push(match adopt(path, sweep)? {
                Adopted::Cells(0) => format!("{name} has no cell of this sweep and is begun anew.\n"),
                Adopted::Cells(count) => {
                    format!("{name} has {count} of {} cells already: they are kept.\n", sweep.cells().len())
                }
                Adopted::Foreign(why) => format!("{name} is begun anew: {why}.\n"),
                Adopted::NoSweep => {
                    return Err(Fault::new("This file is no sweep and is not written over")
                        .at(name.to_string())
                        .remedy("Remove it, or name another file"));
                }
            });
        }
        Ok(said)
    }

    /// Writes the files.
    pub fn write(&self, case: &Case, sweep: &Sweep, look: SweepLook<'_>) -> Result<(), Fault> {
        for (target, kind) in &self.0 {
            let bytes = match kind {
                Kind::Picture(format) => {
                    let map = heat_map::draw(sweep, look.figure, &describe(case));
                    Drawn::of_page(map).bytes(*format)?
                }
                Kind::Csv => sweep.csv(look.with_time).into_bytes(),
                Kind::Json => sweep.json().into_bytes(),
            };
            target.write(|out| out.write_all(&bytes))?;
        }
        Ok(())
    }
}

/// What a file had for a sweep.
pub(in crate::app) enum Adopted {
    /// So many of its cells that were missing.
    Cells(usize),
    /// A sweep that is of something else, with the reason.
    Foreign(String),
    /// No sweep at all.
    NoSweep,
}

/// Takes over the cells of a sweep from a JSON file.
///
/// # Errors
/// A file that cannot be read.
pub(in crate::app) fn adopt(path: &Path, sweep: &mut Sweep) -> Result<Adopted, Fault> {
    let bytes = load(path)?;
    let Ok(text) = std::str::from_utf8(&bytes) else { return Ok(Adopted::NoSweep) };
    Ok(match Sweep::parse(text) {
        Ok(None) => Adopted::NoSweep,
        Ok(Some(found)) => match sweep.adopt(&found) {
            Some(count) => Adopted::Cells(count),
            None => Adopted::Foreign("it is of another case, mesh or edits".to_owned()),
        },
        Err(fault) => Adopted::Foreign(fault.what),
    })
}
