//! A sweep as JSON, one line for each cell, from which it can also go on.
//!
//! ```json
//! {
//! "sweep": 1,
//! "program": "quadfront 0.1.0",
//! "case": {"name":"example1","title":"...","text":"..."},
//! "inputs": "9c1f...",
//! "parameters": {"size_scale":1,"c":2,...},
//! "axes": [{"key":"c","values":[1.5,1.75,...]},{"key":"theta_rect","values":[110,115,...]}],
//! "figures": [{"name":"quads","unit":"","better":"neither","meaning":"quadrilaterals"},...],
//! "cells": [
//! {"c":1.5,"theta_rect":110,"figures":{"quads":294,...}},
//! {"c":1.75,"theta_rect":110,"refused":"..."},
//! {"c":2,"theta_rect":110},
//! ...
//! ]
//! }
//! ```

use serde_json::{Map, Value, json};

use super::{Axis, Cell, Sweep};
use crate::core::case::{ParameterKind, Parameters};
use crate::core::fault::{Fault, FaultKind};
use crate::core::record::report::figures::{Better, FIGURES};
use crate::core::record::report::{CaseRecord, Program};

/// The supported version of the format.
const VERSION: u64 = 1;

impl Sweep {
    /// The sweep as JSON, with a final line break. A cell that is not known yet has neither `figures` nor `refused`.
    pub fn json(&self) -> String {
        let parameters =
            Parameters::KEYS.iter().map(|key| pair(key, &self.parameters.text_of(key).unwrap_or_default()));
        let axes = self.axes.iter().map(|Axis { key, values }| {
            let values: Vec<_> = values.iter().map(|value| json_of(key, value)).collect();
            format!("{{\"key\":{},\"values\":{}}}", json!(key), json!(values))
        });
        let figures = FIGURES.iter().map(|figure| {
            let (name, unit, meaning) = (json!(figure.name), json!(figure.unit), json!(figure.doc));
            let better = match figure.better {
                Better::Less => "less",
                Better::More => "more",
                Better::Neither => "neither",
            };
            format!("{{\"name\":{name},\"unit\":{unit},\"better\":\"{better}\",\"meaning\":{meaning}}}")
        });
        let CaseRecord { name: case, title, text } = &self.case;
        format!(
            "{{\n\"sweep\": {VERSION},\n\"program\": {},\n\"case\": {{\"name\":{},\"title\":{},\"text\":{}}},\n\
             \"inputs\": \"{}\",\n\"parameters\": {{{}}},\n\"axes\": [{}],\n\"figures\": [{}],\n\"cells\": [\n{}\n]\n}}\n",
            json!(program_text()),
            json!(case),
            json!(title),
            json!(text),
            self.inputs,
            joined(parameters, ","),
            joined(axes, ","),
            joined(figures, ","),
            joined((0..self.cells.len()).map(|k| self.cell_line(k)), ",\n")
        )
    }

    fn cell_line(&self, cell: usize) -> String {
        let mut parts: Vec<_> = self.values(cell).into_iter().map(|(key, value)| pair(key, value)).collect();
        match &self.cells[cell] {
            None => {}
            Some(Cell::Refused(why)) => parts.push(format!("\"refused\":{}", json!(why))),
            Some(Cell::Figures(values)) => {
                let figures = FIGURES.iter().zip(values);
                let figures = figures.map(|(figure, value)| format!("{}:{}", json!(figure.name), number(*value)));
                parts.push(format!("\"figures\":{{{}}}", joined(figures, ",")));
            }
        }
        format!("{{{}}}", parts.join(","))
    }

    /// Reads the JSON of a sweep; `None` if the text is something else.
    ///
    /// # Errors
    /// A sweep of another version of the program, whose cells may differ from those of this one; a damaged one.
    pub fn parse(text: &str) -> Result<Option<Sweep>, Fault> {
        let Ok(Value::Object(record)) = serde_json::from_str(text) else { return Ok(None) };
        let Some(version) = record.get("sweep") else { return Ok(None) };
        let fault = |what: &str| Fault::new(what).of_kind(FaultKind::Syntax).remedy("Make the sweep again");
        let program = record.get("program").and_then(Value::as_str);
        if version.as_u64() != Some(VERSION) || program != Some(&program_text()) {
            return Err(fault("Another version of quadfront made this sweep"));
        }
        read(&record).ok_or_else(|| fault("The record of the sweep is damaged")).map(Some)
    }
}

/// Name and version of this program.
fn program_text() -> String {
    let Program { name, version } = Program::this();
    format!("{name} {version}")
}

fn joined(parts: impl Iterator<Item = String>, between: &str) -> String {
    parts.collect::<Vec<_>>().join(between)
}

fn pair(key: &str, value: &str) -> String {
    format!("\"{key}\":{}", json_of(key, value))
}

/// A parameter's value as JSON: a number, true or false, or a text.
fn json_of(key: &str, value: &str) -> Value {
    let typed = match Parameters::kind_of(key) {
        Some(ParameterKind::Flag) => value.parse().ok().map(Value::Bool),
        Some(kind) if kind.limits().is_some() => value.parse().ok().map(whole_or_not),
        _ => None,
    };
    typed.unwrap_or_else(|| Value::from(value))
}

/// The text of a parameter's value.
fn text_of(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

fn number(value: Option<f64>) -> Value {
    value.map_or(Value::Null, whole_or_not)
}

/// Whole numbers are written without a decimal point.
fn whole_or_not(x: f64) -> Value {
    if x.fract() == 0.0 && x.abs() < 1e15 { Value::from(x as i64) } else { Value::from(x) }
}

fn read(record: &Map<String, Value>) -> Option<Sweep> {
    let case = record.get("case")?;
    let text = |key: &str| Some(case.get(key)?.as_str()?.to_owned());
    let mut parameters = Parameters::default();
    for (key, value) in record.get("parameters")?.as_object()? {
        parameters.set(key, &text_of(value)).ok()?;
    }
    let axes = record.get("axes")?.as_array()?.iter().map(axis).collect::<Option<Vec<_>>>()?;
    super::check(&axes).ok()?;
    let count: usize = axes.iter().map(|axis| axis.values.len()).product();
    let lines = record.get("cells")?.as_array()?;
    let case = CaseRecord { name: text("name")?, title: text("title")?, text: text("text")? };
    let inputs = record.get("inputs")?.as_str()?.parse().ok()?;
    let mut sweep = Sweep { case, inputs, parameters, axes, cells: vec![None; count] };
    if lines.len() != count {
        return None;
    }
    for (k, line) in lines.iter().enumerate() {
        let fits = sweep.values(k).into_iter().all(|(key, value)| line.get(key) == Some(&json_of(key, value)));
        if !fits {
            return None;
        }
        sweep.cells[k] = match (line.get("figures"), line.get("refused")) {
            (None, None) => None,
            (Some(figures), None) => Some(figures_of(figures)?),
            (None, Some(why)) => Some(Cell::Refused(why.as_str()?.to_owned())),
            _ => return None,
        };
    }
    Some(sweep)
}

fn axis(value: &Value) -> Option<Axis> {
    let key = value.get("key")?.as_str()?;
    let &key = Parameters::KEYS.iter().find(|known| **known == key)?;
    let mut parameters = Parameters::default();
    let texts = value.get("values")?.as_array()?.iter().map(|value| {
        parameters.set(key, &text_of(value)).ok()?;
        parameters.text_of(key)
    });
    Some(Axis { key, values: texts.collect::<Option<_>>()? })
}

fn figures_of(value: &Value) -> Option<Cell> {
    let values = FIGURES.iter().map(|figure| match value.get(figure.name)? {
        Value::Null => Some(None),
        number => number.as_f64().map(Some),
    });
    values.collect::<Option<_>>().map(Cell::Figures)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::case::built_in;
    use crate::core::run::Run;

    fn sweep(axes: &[&str]) -> Sweep {
        let mut run = Run::of(built_in::named("example1").unwrap().unwrap());
        run.parameters.set("theta_seam", "33.3").unwrap();
        run.parameters.set("layered_loops", "hole, outer").unwrap();
        let axes = axes.iter().map(|axis| Axis::parse(axis).unwrap()).collect();
        let mut sweep = Sweep::new(&run, axes).unwrap();
        let figures = (0..FIGURES.len()).map(|k| (k != 3).then_some(0.1 * k as f64)).collect();
        sweep.fill(0, Cell::Figures(figures));
        sweep.fill(1, Cell::Refused("a.toml: no \"hole\"".to_owned()));
        sweep
    }

    #[test]
    fn a_sweep_reads_back_from_its_json() {
        for axes in
            [&["c=1.5:2:.25", "theta_rect=110,115.5"][..], &["selection=level,table1"], &["smoothing=true,false"]]
        {
            let sweep = sweep(axes);
            let text = sweep.json();
            assert_eq!(Sweep::parse(&text).unwrap().unwrap(), sweep, "{text}");
        }
    }

    #[test]
    fn what_is_no_sweep_is_none_and_a_damaged_one_is_refused() {
        assert_eq!(Sweep::parse("version = 1"), Ok(None));
        assert_eq!(Sweep::parse("{\"program\": 1}"), Ok(None));
        let text = sweep(&["c=1.5:2:.25"]).json();
        for (from, to, what) in [
            ("\"sweep\": 1", "\"sweep\": 2", "Another version"),
            ("\"program\": \"quadfront ", "\"program\": \"quadfront 0.0.", "Another version"),
            ("\"c\":1.75,", "\"c\":1.8,", "damaged"),
            ("\"quads\":0,", "", "damaged"),
            ("{\"c\":2}", "{\"c\":2,\"refused\":1}", "damaged"),
            ("\"key\":\"c\"", "\"key\":\"k\"", "damaged"),
        ] {
            assert!(text.contains(from), "{from}: {text}");
            let fault = Sweep::parse(&text.replace(from, to)).unwrap_err();
            assert!(fault.what.contains(what), "{to}: {fault}");
        }
    }
}
