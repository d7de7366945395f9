//! `check`: whether a mesh in a file is valid.

use std::process::ExitCode;

use super::command_line::CheckArguments;
use super::input::{self, InputFormat};
use super::output;
use super::progress::Progress;
use super::{FALLS_SHORT, complain};
use crate::core::fault::Fault;
use crate::core::formats::Format;
use crate::core::progress::Watch;
use crate::core::soup::soundness::examine;
use crate::core::soup::{Allow, Soundness};

/// Checks a mesh: success where it is valid, exit code 1 where not.
pub(super) fn check(arguments: &CheckArguments) -> Result<ExitCode, Fault> {
    let messages = output::check(&[arguments.report.as_ref()], None)?;
    let from = arguments.from.map(InputFormat::Mesh);
    let name = arguments.mesh.as_str();
    if name == "-" && from.is_none() {
        return Err(Fault::new("The format is not known")
            .at("standard input")
            .remedy("Name it, for example --from msh"));
    }
    let mut progress = Progress::new(arguments.quiet);
    let mut mesh = input::read_mesh(name, from, &mut progress)?.ok_or_else(|| {
        let known = Format::ALL.map(|format| format!(".{}", format.extension())).join(", ");
        Fault::new("This is not a mesh, and only meshes can be checked")
            .at(name)
            .remedy(format!("Name a file of one of: {known}"))
    })?;
    let welded = mesh.weld(arguments.weld, &progress.cancel()).map_err(|fault| fault.at(name))?;
    let mut found = examine(&mesh);
    welded.report(&mut found.repairs);
    progress.finish();
    if let Some(target) = &arguments.report {
        let json = serde_json::to_string_pretty(&found).expect("JSON can express all findings");
        target.write(|out| writeln!(out, "{json}"))?;
    }
    if !arguments.quiet {
        messages.print(&facts(name, &found));
    }
    let allow = Allow { triangles: arguments.triangles, seams: arguments.seams, branching: arguments.branching };
    Ok(match found.verdict(allow) {
        Ok(()) => {
            if !arguments.quiet {
                messages.print("sound\n");
            }
            ExitCode::SUCCESS
        }
        Err(fault) => {
            complain(&fault.at(name));
            ExitCode::from(FALLS_SHORT)
        }
    })
}

fn facts(name: &str, found: &Soundness) -> String {
    let mut text = format!(
        "{name}: {} quadrilaterals, {} triangles, {} nodes, {} edges\n\
         {} boundary edges in {} loops, {} pieces, Euler characteristic {}, area {}\n",
        found.quads,
        found.triangles,
        found.nodes,
        found.edges,
        found.boundary_edges,
        found.boundary_loops,
        found.components,
        found.euler,
        found.area
    );
    for told in found.repairs.iter().chain(&found.not_read) {
        text.push_str(told);
        text.push('\n');
    }
    text
}
