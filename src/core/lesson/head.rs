//! The head of a lesson, TOML between two lines of `+++`: title, section, case, rules and parameters.

use std::path::{Path, PathBuf};

use crate::core::case::table::{Source, Table, Value};
use crate::core::case::{Case, built_in, set_parameters};
use crate::core::fault::Fault;
use crate::core::kernel::spelling::suggestion;
use crate::core::question::Rule;

/// The line before and after the head.
const FENCE: &str = "+++";

/// What the head says.
pub(super) struct Head {
    pub title: String,
    pub section: String,
    pub case: Case,
    pub case_file: Option<PathBuf>,
    pub rules: Vec<Rule>,
}

/// The head, with its lines where the file has them, and the index of the first line after it.
pub(super) fn split<'t>(text: &'t str, file: &str) -> Result<(&'t str, usize), Fault> {
    let remedy = "Begin the file with +++, title = \"...\", case = \"figure-14\" and +++, each on its own line";
    if text.lines().next().is_none_or(|line| line.trim_end() != FENCE) {
        return Err(Fault::new("The head is missing").at(format!("{file}, line 1")).remedy(remedy));
    }
    // The head is what is before the second fence; the first one is no TOML and left out.
    let begin = text.find('\n').map_or(text.len(), |at| at + 1);
    let mut at = begin;
    for (index, line) in text[begin..].split_inclusive('\n').enumerate() {
        if line.trim_end() == FENCE {
            return Ok((&text[begin..at], index + 2));
        }
        at += line.len();
    }
    Err(Fault::new("The head has no end").at(format!("{file}, line 1")).remedy("Write +++ after its last line"))
}

/// Reads the head.
pub(super) fn read(head: &str, file: &str, folder: &Path) -> Result<Head, Fault> {
    // One line before it, as in the file.
    let text = format!("\n{head}");
    let source = Source::new(file, &text);
    let document = source.parse()?;
    let table = Table::document(&source, &document);
    table.only(&["title", "section", "case", "rules", "parameters"])?;
    let place = |fault: Fault| if fault.place.is_empty() { fault.at(format!("{file}, line 2")) } else { fault };
    let title = table.need("title", "\"Fig. 14: the top edge\"").map_err(place)?.text()?.to_owned();
    let section = table.get("section").map(|value| value.text()).transpose()?.unwrap_or_default().to_owned();
    let named = table.need("case", "\"figure-14\"").map_err(place)?;
    let (mut case, case_file) = case(&named, folder)?;
    if let Some(value) = table.get("parameters") {
        set_parameters(&mut case.parameters, &value.table()?)?;
    }
    let rules = match table.get("rules") {
        Some(value) => value.list()?.iter().map(rule).collect::<Result<_, _>>()?,
        None => Vec::new(),
    };
    Ok(Head { title, section, case, case_file, rules })
}

/// A built-in case by its name, or a case file by its path, with that.
fn case(value: &Value<'_>, folder: &Path) -> Result<(Case, Option<PathBuf>), Fault> {
    let name = value.text()?;
    if let Some(case) = built_in::named(name) {
        return Ok((case?, None));
    }
    if name.ends_with(".toml") {
        let case = Case::read(&folder.join(name)).map_err(|fault| fault.at(value.place()))?;
        return Ok((case, Some(PathBuf::from(name))));
    }
    let names = || built_in::all().map(|(name, _)| name);
    let fault = value.fault(format!("There is no case \"{}\"", name.escape_debug()));
    Err(fault.remedy(suggestion(name, names()).unwrap_or_else(|| {
        "quadfront cases lists the built-in ones; one of your own is named by its path, such as \"plate.toml\""
            .to_owned()
    })))
}

fn rule(value: &Value<'_>) -> Result<Rule, Fault> {
    let name = value.text()?;
    let names = || Rule::ALL.iter().map(|rule| rule.name());
    Rule::named(name).ok_or_else(|| {
        let fault = value.fault(format!("There is no rule \"{}\"", name.escape_debug()));
        let known = || format!("Rules are {}", names().collect::<Vec<_>>().join(", "));
        fault.remedy(suggestion(name, names()).unwrap_or_else(known))
    })
}
