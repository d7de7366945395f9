//! The table `[figure]`: the states shown by the figure that embeds the run.

use super::quoted;
use crate::core::case::table::{Table, Value};
use crate::core::convert::Stop;
use crate::core::fault::Fault;
use crate::core::run::{Shown, ShownState};

/// Maximum number of states in a figure.
pub const MOST_STATES: usize = 1000;

pub(super) fn shown(table: &Table<'_>) -> Result<Shown, Fault> {
    table.only(&["drawn", "state"])?;
    let states = table.tables("state")?;
    if states.is_empty() || states.len() > MOST_STATES {
        return Err(table.fault(format!("A figure shows 1 to {MOST_STATES} states, but this has {}", states.len())));
    }
    Ok(Shown {
        states: states.iter().map(state).collect::<Result<_, _>>()?,
        drawn: table.get("drawn").map(|value| value.texts()).transpose()?.unwrap_or_default(),
    })
}

fn state(table: &Table<'_>) -> Result<ShownState, Fault> {
    table.only(&["step", "at", "fingerprint"])?;
    let print = table.need("fingerprint", "\"...\"")?;
    Ok(ShownState {
        step: super::step(table)?,
        at: table.get("at").map(|value| stop(&value)).transpose()?,
        state: print.text()?.parse().map_err(|()| print.wrong("32 hexadecimal digits", "fingerprint = \"...\""))?,
    })
}

fn stop(value: &Value<'_>) -> Result<Stop, Fault> {
    value.text()?.parse().map_err(|()| value.wrong("a stop", "at = \"nq=100\""))
}

pub(super) fn text(shown: &Shown) -> String {
    let mut text = "[figure]\n".to_owned();
    if !shown.drawn.is_empty() {
        let words: Vec<String> = shown.drawn.iter().map(|word| quoted(word)).collect();
        text += &format!("drawn = [{}]\n", words.join(", "));
    }
    text += "state = [\n";
    for ShownState { step, at, state } in &shown.states {
        let at = at.map_or_else(String::new, |at| format!(" at = \"{at}\","));
        text += &format!("    {{ step = {step},{at} fingerprint = \"{state}\" }},\n");
    }
    text + "]\n"
}
