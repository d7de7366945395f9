//! `cases`: the built-in cases, and the case of a CAD file.

use std::path::Path;

use serde_json::json;

use super::command_line::CasesArguments;
use super::input;
use super::output::Target;
use crate::core::case::{ImportOptions, built_in};
use crate::core::fault::Fault;
use crate::core::formats::save::load;
use crate::core::kernel::spelling::nearest;
use crate::core::step::is_step;

/// Lists the built-in cases, or prints the file of one.
pub(super) fn cases(arguments: &CasesArguments) -> Result<(), Fault> {
    let text = match (&arguments.name, &arguments.from) {
        (Some(name), _) => file(name)?.to_owned(),
        (None, Some(path)) => of_step(path, &arguments.mesh.options())?,
        (None, None) => list(arguments.json)?,
    };
    Target::StandardOutput.write(|out| out.write_all(text.as_bytes()))
}

/// The text of the case of a STEP file.
fn of_step(path: &Path, options: &ImportOptions) -> Result<String, Fault> {
    let place = path.display().to_string();
    if !is_step(path) {
        return Err(Fault::new("This is not a STEP file by its extension")
            .at(place)
            .remedy("Name a .step, .stp or .p21"));
    }
    Ok(input::step_case(&load(path)?, &path.file_stem().unwrap_or_default().to_string_lossy(), &place, options)?.text)
}

fn file(name: &str) -> Result<&'static str, Fault> {
    let case = built_in::all().find(|case| case.0 == name);
    case.map(|case| case.1).ok_or_else(|| {
        let fault = Fault::new("No built-in case has this name").at(name);
        match nearest(name, built_in::all().map(|case| case.0)) {
            Some(near) => fault.remedy(format!("The nearest is \"{near}\"; quadfront cases lists all")),
            None => fault.remedy("quadfront cases lists all"),
        }
    })
}

fn list(json: bool) -> Result<String, Fault> {
    let titles = |cases: &[(&'static str, &str)]| {
        let titles = cases.iter().filter_map(|case| built_in::named(case.0)?.map(|c| (case.0, c.title)).into());
        titles.collect::<Result<Vec<_>, Fault>>()
    };
    let (cases, figures) = (titles(built_in::CASES)?, titles(built_in::FIGURES)?);
    if json {
        let all = cases.iter().map(|case| (false, case)).chain(figures.iter().map(|case| (true, case)));
        let list: Vec<_> =
            all.map(|(figure, (name, title))| json!({ "name": name, "title": title, "figure": figure })).collect();
        return Ok(format!("{:#}\n", serde_json::Value::from(list)));
    }
    let width = built_in::all().map(|(name, _)| name.len()).max().unwrap_or(0);
    let lines = |titles: &[(&str, String)]| -> String {
        titles.iter().map(|(name, title)| format!("{name:width$}  {title}\n")).collect()
    };
    Ok(format!("{}\nFigures of the paper, one operation each:\n\n{}", lines(&cases), lines(&figures)))
}
