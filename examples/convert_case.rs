//! Converts a case to quadrilaterals and writes them.
//!
//! ```text
//! cargo run --example convert_case [CASE] [MESH]
//! ```
//!
//! CASE is the name of a built-in case or a file in TOML, `example1` where it is left out. MESH is the file to write;
//! its extension says the format (`msh`, `mesh`, `vtu`, `obj`, `inp`, `ply`).

use std::path::{Path, PathBuf};

use quadfront::{Case, Export, Fault, Format, Nobody, Report, WriteOptions, built_in, convert, write_mesh};

fn main() -> Result<(), Fault> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "example1".to_owned());
    let path = arguments.next().map_or_else(|| std::env::temp_dir().join("quadfront-example.msh"), PathBuf::from);

    let case = match built_in::named(&name) {
        Some(case) => case?,
        None => Case::read(Path::new(&name))?,
    };
    // `Nobody` ignores progress; implement `Watch` to show it or to cancel the conversion.
    let converted = convert(&case, &mut Nobody)?;

    print!("{}", Report::of(&case, &converted)?.summary());

    // The mesh as plain lists, without the gaps that a conversion leaves in its numbers.
    let file = Export::of(&converted.mesh, &converted.names).file;
    write_mesh(&path, Format::from_path(&path)?, &file, WriteOptions::default())?;
    println!("written: {}", path.display());
    Ok(())
}
