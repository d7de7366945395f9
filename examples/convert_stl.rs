//! Remeshes an STL file with quadrilaterals of one size; its sharp edges are preserved.
//!
//! ```text
//! cargo run --example convert_stl [STL] [SIZE]
//! ```
//!
//! STL is a file in STL, or in another format that is read; by default a small wedge. SIZE is the length of the sides
//! of quadrilaterals, in the units of the file; by default 0.1.

use std::process::ExitCode;

use quadfront::{
    Case, Export, Fault, FaultKind, FieldSpec, Format, MeshUse, Nobody, Taking, WriteOptions, convert, read_mesh,
    read_mesh_bytes, write_mesh,
};

/// The corners of the triangles of a wedge.
const WEDGE: [[[i32; 3]; 3]; 8] = [
    [[0, 0, 0], [0, 1, 0], [1, 1, 0]],
    [[0, 0, 0], [1, 1, 0], [1, 0, 0]],
    [[0, 0, 0], [1, 0, 0], [0, 0, 1]],
    [[0, 1, 0], [0, 1, 1], [1, 1, 0]],
    [[0, 0, 0], [0, 0, 1], [0, 1, 1]],
    [[0, 0, 0], [0, 1, 1], [0, 1, 0]],
    [[1, 0, 0], [1, 1, 0], [0, 1, 1]],
    [[1, 0, 0], [0, 1, 1], [0, 0, 1]],
];

/// The wedge as the text of an STL file.
fn wedge() -> String {
    let corner = |[x, y, z]: &[i32; 3]| format!("vertex {x} {y} {z}\n");
    let facet = |corners: &[[i32; 3]; 3]| {
        let corners: String = corners.iter().map(corner).collect();
        format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
    };
    format!("solid wedge\n{}endsolid wedge\n", WEDGE.iter().map(facet).collect::<String>())
}

fn run() -> Result<(), Fault> {
    let mut arguments = std::env::args().skip(1);
    let mesh = match arguments.next() {
        Some(path) => read_mesh(path.as_ref(), None)?,
        None => read_mesh_bytes("wedge.stl", wedge().as_bytes(), Format::Stl)?,
    };
    let h = arguments.next().map_or(Ok(0.1), |size| size.parse());
    let h = h.map_err(|_| Fault::new("SIZE is not a number"))?;

    let shape = Taking { used: Some(MeshUse::Shape), ..Taking::default() };
    let mut case = Case::of_mesh_in_memory("stl", mesh).with_taking(shape);
    // Several fields are intersected: the smallest size in each direction holds.
    case.fields.push(FieldSpec::Uniform { h });
    let converted = convert(&case, &mut Nobody)?;
    for repair in &converted.repairs {
        println!("repaired: {repair}");
    }

    let file = Export::of(&converted.mesh, &converted.names).file;
    let path = std::env::temp_dir().join("quadfront-stl.obj");
    write_mesh(&path, Format::Obj, &file, WriteOptions::default())?;
    println!("{} quadrilaterals in {}", file.quads.len(), path.display());
    Ok(())
}

fn main() -> ExitCode {
    let Err(fault) = run() else { return ExitCode::SUCCESS };
    // What went wrong is a sentence for people; its kind is for programs.
    eprintln!("{fault}");
    match fault.kind() {
        FaultKind::Io => eprintln!("Is the file where you think it is?"),
        FaultKind::Limit => eprintln!("Try a larger SIZE."),
        _ => {}
    }
    ExitCode::FAILURE
}
