//! The decision chain of a quadrilateral: the base segment it was formed on and why, its sides, its top, its formation,
//! and every later step that moved or changed it, with its quality after each.

use std::collections::BTreeMap;

use super::explain::{self, margins};
use super::front_table::FrontTable;
use super::history::History;
use crate::core::case::Selection;
use crate::core::convert::{Candidates, Event, EventKind};
use crate::core::fault::Fault;
use crate::core::mesh::ElementId;

/// The number of later changes that a chain has at most: the newest.
const CHANGES: usize = 60;

/// A step of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// The step.
    pub step: u64,
    /// What it did.
    pub event: Event,
    /// The same in one line, with the number that decided.
    pub text: String,
    /// For which parameters it would have done the same, all else unchanged; `None` where that is not known.
    pub margin: Option<String>,
    /// The quality of the quadrilateral after the step; `None` before it stands.
    pub quality: Option<f64>,
    /// How much quality the step cost: what its formation lacks to 1, later what it had more before the step.
    pub loss: f64,
}

/// The decision chain of a quadrilateral up to a state.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// The quadrilateral.
    pub element: ElementId,
    /// Its steps, from the selection of the base on.
    pub links: Vec<Link>,
    /// The index of the step that made it.
    pub made: usize,
    /// Whether there are more changes between the step that made it and those listed.
    pub is_cut: bool,
}

impl Chain {
    /// The index of the step that cost most quality; `None` where none did.
    pub fn costliest(&self) -> Option<usize> {
        let worse = |a: &(usize, &Link), b: &(usize, &Link)| a.1.loss.total_cmp(&b.1.loss).then(b.0.cmp(&a.0));
        self.links.iter().enumerate().max_by(worse).filter(|(_, link)| link.loss > 0.0).map(|(k, _)| k)
    }
}

impl History {
    /// The decision chain of a quadrilateral of the current state; `None` for other elements, and for a quadrilateral
    /// that the background mesh has.
    ///
    /// # Errors
    /// A step of the replay failed.
    pub fn chain(&self, element: ElementId) -> Result<Option<Chain>, Fault> {
        let mesh = &self.state().mesh;
        if !mesh.has_element(element) || !mesh.is_quad(element) {
            return Ok(None);
        }
        let Some(made) = self.made(element)? else { return Ok(None) };
        let mut links = self.formation(made)?;
        let at_formation = links.len() - 1;
        let mut touches = self.touches_since(element, made - 1, CHANGES + 1)?;
        let is_cut = touches.len() > CHANGES;
        if is_cut {
            // The quality before the first change that is listed.
            touches.drain(..touches.len() - CHANGES - 1);
        }
        let mut before = 1.0;
        for (k, &(step, quality)) in touches.iter().enumerate() {
            let loss = before - quality;
            before = quality;
            if step == made {
                links[at_formation].quality = Some(quality);
                links[at_formation].loss = loss;
            } else if !(is_cut && k == 0) {
                let event = self.event(step)?.expect("the step is known");
                let text = explain::event(&event);
                links.push(Link { step, event, text, margin: None, quality: Some(quality), loss });
            }
        }
        Ok(Some(Chain { element, links, made: at_formation, is_cut }))
    }

    /// The steps that made a quadrilateral: where it was formed on the front, from the selection of its base on, with
    /// failed attempts in one link each.
    fn formation(&self, made: u64) -> Result<Vec<Link>, Fault> {
        let link = |step: u64, event: Event, text: String, margin: Option<String>| Link {
            step,
            event,
            text,
            margin,
            quality: None,
            loss: 0.0,
        };
        let last = self.event(made)?.expect("the step is known");
        let base = self.log().selection(made - 1).filter(|_| last.kind() == EventKind::Formed);
        let Some(selected) = base else { return Ok(vec![link(made, last, explain::event(&last), None)]) };
        let events = self.events(selected, made)?;
        let failed = events.iter().rposition(|event| event.kind() == EventKind::RolledBack);
        // What the selection of the base and that of each side looked at.
        let (mut table, mut tried) = (None, BTreeMap::new());
        self.replay(selected - 1, made - 1, &mut |step, before, _| {
            table.get_or_insert_with(|| FrontTable::of(before));
            tried.extend(before.candidates().map(|candidates| (step + 1, candidates)));
        })?;
        let mut links = Vec::new();
        for (k, (&event, step)) in events.iter().zip(selected..).enumerate() {
            let is_of_failed = failed.is_some_and(|failed| k < failed) && event.kind() != EventKind::RolledBack;
            if k > 0 && is_of_failed {
                continue;
            }
            let (text, margin) = match (&table, tried.get(&step)) {
                (Some(table), _) if k == 0 => of_base(table, &event),
                (_, Some(tried)) => of_side(tried, &event),
                _ => (explain::event(&event), None),
            };
            links.push(link(step, event, text, margin));
        }
        Ok(links)
    }
}

/// The selection of a base: what decided, and for which parameters it would have been the same.
fn of_base(table: &FrontTable, event: &Event) -> (String, Option<String>) {
    let mut text = explain::event(event);
    let Event::BaseSelected { a, b, key, reach, within_reach, picked, .. } = *event else { return (text, None) };
    let row = table.find(a, b);
    let margin = row.and_then(|row| {
        let theta_rect = table.margin_of_theta_rect(row).map(|margin| margin.map(f64::to_degrees));
        margins(table.margin_of_c(row), theta_rect)
    });
    if !picked && table.parameters().selection == Selection::Table1 {
        if within_reach {
            let [_, name] = explain::key_name(table.parameters());
            let [key, reach] = explain::apart(key, reach);
            text += &format!("; {name} = {key} < c\u{b7}H_{{min}} = {reach}");
        } else {
            text += "; no segment of classes 1 to 3 within reach, and none with a smaller H";
        }
    }
    (text, margin)
}

/// A side: the frontal angle where it is the front, else the second best, and for which parameters it would have been
/// the same.
fn of_side(tried: &Candidates, event: &Event) -> (String, Option<String>) {
    let mut text = explain::event(event);
    match event {
        Event::SideIsFront { side, .. } => {
            let name = ["A", "B"][side.index()];
            let [less, more] = explain::angles_apart(tried.theta, tried.theta_rect);
            text += &format!("; \u{3b8}_{{{name}}} = {less}\u{b0} < \u{3b8}_{{rect}} = {more}\u{b0}");
        }
        Event::SideChosen { .. } | Event::SideSwapped { .. } => {
            text += &explain::second(tried).map_or(String::new(), |second| format!("; {second}"));
        }
        _ => return (text, None),
    }
    (text, explain::side_margins(tried))
}
