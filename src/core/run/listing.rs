//! Lists of what a mesh consists of: measured, filtered by a condition and sorted by a field, at a cost that depends on
//! what changes.

use super::history::Changes;
use super::last_changes::LastChanges;
use crate::core::kernel::condition::{Condition, Field, Value};
use crate::core::mesh::Mesh;

pub(super) use crate::core::kernel::condition::fields;

/// What a list shows, and in which order.
#[derive(Clone, Debug, PartialEq)]
pub struct Query {
    /// The field by which it is sorted, by its index.
    pub field: usize,
    /// Whether the largest comes first. What does not have the field comes last either way.
    pub descending: bool,
    /// What is shown; `None`: everything.
    pub filter: Option<Condition>,
}

/// The result of a query.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listing {
    /// The slots of what is shown, in order.
    pub slots: Vec<u32>,
    /// How many there are with those that are not shown.
    pub of: usize,
}

/// The steps that made something and changed it last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Steps {
    /// The step of its birth; 0 where the background mesh has it.
    pub born: u64,
    /// The last step that moved or changed it; 0 where none did.
    pub changed: u64,
}

/// Something that can be listed.
pub trait Row: Copy {
    /// Its fields.
    const FIELDS: &'static [Field];

    /// The value of a field, by its index.
    fn value(&self, field: usize) -> Option<Value>;

    /// The number of slots of such things in a mesh.
    fn slots(mesh: &Mesh) -> usize;

    /// Measures what is in a slot.
    fn measure(mesh: &Mesh, slot: u32) -> Option<Self>;

    /// Sets the steps at which it was born and changed.
    fn set_steps(&mut self, steps: Steps);

    /// The step that changed what is in a slot last.
    fn last_change(changes: &LastChanges, slot: u32) -> u64;

    /// Visits the slots that changes may concern.
    fn touched(mesh: &Mesh, changes: &Changes, touch: &mut dyn FnMut(u32));

    /// The number by which it is sorted.
    fn key(&self, field: usize) -> Option<f64> {
        match self.value(field)? {
            Value::Number(number) => Some(number),
            Value::Flag(flag) => Some(f64::from(u8::from(flag))),
            Value::Word(word) => {
                Self::FIELDS[field].holds.words().iter().position(|known| *known == word).map(|k| k as f64)
            }
        }
    }
}

/// The rows of a state by slot, kept up to date.
#[derive(Clone, Debug)]
pub struct Listed<R> {
    rows: Vec<Option<R>>,
}

impl<R> Default for Listed<R> {
    fn default() -> Self {
        Listed { rows: Vec::new() }
    }
}

impl<R: Row> Listed<R> {
    /// Measures again what has changed since the last call; `steps` has those of each slot.
    pub fn follow(&mut self, mesh: &Mesh, changes: &Changes, steps: impl Fn(u32) -> Steps) {
        let slots = R::slots(mesh);
        self.rows.resize(slots, None);
        if *changes == Changes::Everything {
            self.rows.iter_mut().zip(0..).for_each(|(row, slot)| *row = R::measure(mesh, slot));
        } else {
            R::touched(mesh, changes, &mut |slot| {
                if let Some(row) = self.rows.get_mut(slot as usize) {
                    *row = R::measure(mesh, slot);
                }
            });
        }
        for (row, slot) in self.rows.iter_mut().zip(0..) {
            if let Some(row) = row {
                row.set_steps(steps(slot));
            }
        }
    }

    /// The row in a slot.
    pub fn row(&self, slot: u32) -> Option<&R> {
        self.rows.get(slot as usize)?.as_ref()
    }

    /// All rows, by slot.
    pub fn rows(&self) -> impl Iterator<Item = &R> {
        self.rows.iter().flatten()
    }

    /// The slots that a query asks for, in its order; equal ones by slot.
    pub fn list(&self, query: &Query) -> Listing {
        let all = || self.rows.iter().zip(0..).filter_map(|(row, slot)| Some((row.as_ref()?, slot)));
        let fits = |row: &R| query.filter.as_ref().is_none_or(|filter| filter.holds(|field| row.value(field)));
        let mut found: Vec<(f64, u32)> = all()
            .filter(|(row, _)| fits(row))
            .map(|(row, slot)| (row.key(query.field).unwrap_or(f64::NAN), slot))
            .collect();
        found.sort_unstable_by(|a, b| {
            let by_key = match (a.0.is_nan(), b.0.is_nan()) {
                (false, false) if query.descending => b.0.total_cmp(&a.0),
                (false, false) => a.0.total_cmp(&b.0),
                (is_nan, other) => is_nan.cmp(&other),
            };
            by_key.then(a.1.cmp(&b.1))
        });
        Listing { slots: found.into_iter().map(|entry| entry.1).collect(), of: all().count() }
    }
}

/// The rows of a list as comma-separated values: a line with the names of the fields, then a line for each row. Numbers
/// are written in full; what a row does not have is empty.
pub fn csv<'a, R: Row + 'a>(rows: impl Iterator<Item = &'a R>) -> String {
    let names: Vec<&str> = R::FIELDS.iter().map(|field| field.name).collect();
    let mut text = names.join(",") + "\n";
    for row in rows {
        let values: Vec<String> = (0..R::FIELDS.len())
            .map(|field| match row.value(field) {
                None => String::new(),
                Some(Value::Number(number)) => number.to_string(),
                Some(Value::Flag(flag)) => flag.to_string(),
                Some(Value::Word(word)) => word.to_owned(),
            })
            .collect();
        text += &(values.join(",") + "\n");
    }
    text
}
