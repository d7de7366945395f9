//! A sweep: one conversion for each value of a parameter, or for each pair of values of two, and what each ends with.
//! Its JSON is also the record from which an interrupted sweep goes on.

mod axis;
mod json;
mod table;

use std::collections::BTreeMap;

pub use axis::Axis;

use super::report::figures::{Better, FIGURES, Figure};
use super::report::{CaseRecord, Report};
use super::run_file;
use crate::core::case::Parameters;
use crate::core::fault::{Fault, FaultKind};
use crate::core::kernel::Fingerprint;
use crate::core::run::Run;

/// The largest number of cells of a sweep.
pub const MOST_CELLS: usize = 10_000;

/// The axes where none is named, as [`Axis::parse`] takes them.
pub const DEFAULT_AXES: [&str; 2] = ["c=1.5:3:0.25", "theta_rect=110:150:5"];

/// The figure shown where none is named.
pub const DEFAULT_FIGURE: &str = "irregular";

/// The figure that differs from run to run.
pub const TIME: &str = "seconds";

/// What a cell ended with.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// The figures of its report, in the order of [`FIGURES`].
    Figures(Vec<Option<f64>>),
    /// Why there is no valid mesh: the message of the fault.
    Refused(String),
}

impl Cell {
    /// The cell of a conversion with this report.
    pub fn of(report: &Report) -> Cell {
        Cell::Figures(FIGURES.iter().map(|figure| figure.of(report)).collect())
    }
}

/// A sweep with the cells that it has so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The case.
    pub case: CaseRecord,
    /// The fingerprint of everything but the parameters that determines a cell.
    inputs: Fingerprint,
    /// The parameters of the case; each axis replaces one of them.
    pub parameters: Parameters,
    /// One axis or two.
    axes: Vec<Axis>,
    /// The cells, `None` where it is not known yet. The first axis varies fastest.
    cells: Vec<Option<Cell>>,
}

impl Sweep {
    /// A sweep of a run, without any cell yet.
    ///
    /// # Errors
    /// No axis or more than two, the same key twice, too many cells, a mesh file that cannot be read.
    pub fn new(run: &Run, axes: Vec<Axis>) -> Result<Sweep, Fault> {
        check(&axes).map_err(|fault| fault.of_kind(FaultKind::Parameter))?;
        let count = axes.iter().map(|axis| axis.values.len()).product();
        Ok(Sweep {
            case: CaseRecord::of(&run.case),
            inputs: run_file::inputs(run)?,
            parameters: run.parameters.clone(),
            axes,
            cells: vec![None; count],
        })
    }

    /// The axes.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The cells; the first axis varies fastest.
    pub fn cells(&self) -> &[Option<Cell>] {
        &self.cells
    }

    /// Numbers of columns and rows.
    pub fn shape(&self) -> [usize; 2] {
        [self.axes[0].values.len(), self.axes.get(1).map_or(1, |axis| axis.values.len())]
    }

    /// The numbers of the cells that are not known yet.
    pub fn missing(&self) -> Vec<usize> {
        (0..self.cells.len()).filter(|k| self.cells[*k].is_none()).collect()
    }

    /// Fills a cell.
    pub fn fill(&mut self, cell: usize, with: Cell) {
        self.cells[cell] = Some(with);
    }

    /// The keys and values of a cell.
    pub fn values(&self, cell: usize) -> Vec<(&'static str, &str)> {
        let columns = self.shape()[0];
        let places = [cell % columns, cell / columns];
        self.axes.iter().zip(places).map(|(axis, k)| (axis.key, axis.values[k].as_str())).collect()
    }

    /// The keys and values of a cell as text: `c = 1.5, theta_rect = 110°`.
    pub fn name(&self, cell: usize) -> String {
        let parts = self.axes.iter().zip(self.values(cell)).map(|(axis, (_, value))| axis.with_value(value));
        parts.collect::<Vec<_>>().join(", ")
    }

    /// The parameters of a cell.
    pub fn parameters_of(&self, cell: usize) -> Parameters {
        let mut parameters = self.parameters.clone();
        for (key, value) in self.values(cell) {
            parameters.set(key, value).expect("an axis has values that its parameter takes");
        }
        parameters
    }

    /// The run of a cell, of the run that is swept.
    #[must_use]
    pub fn run_of(&self, cell: usize, run: &Run) -> Run {
        let mut run = run.clone();
        run.parameters = self.parameters_of(cell);
        run.case.parameters = run.parameters.clone();
        run
    }

    /// The cell with the case's own values, if they are among those of the axes.
    pub fn own(&self) -> Option<usize> {
        (0..self.cells.len()).find(|cell| {
            let mut values = self.values(*cell).into_iter();
            values.all(|(key, value)| self.parameters.text_of(key).as_deref() == Some(value))
        })
    }

    /// The value of a figure in a cell; `None` where the cell is refused or not known yet, or has no such figure.
    pub fn value(&self, cell: usize, figure: &Figure) -> Option<f64> {
        let Some(Cell::Figures(values)) = &self.cells[cell] else { return None };
        let place = FIGURES.iter().position(|known| known.name == figure.name)?;
        values.get(place).copied().flatten()
    }

    /// The cells in which a figure is best; none where neither direction is better or all values are the same.
    pub fn best(&self, figure: &Figure) -> Vec<usize> {
        let values: Vec<_> = (0..self.cells.len()).filter_map(|k| Some((k, self.value(k, figure)?))).collect();
        let numbers = || values.iter().map(|value| value.1);
        let (least, most) = (numbers().reduce(f64::min), numbers().reduce(f64::max));
        let best = match figure.better {
            Better::Less => least,
            Better::More => most,
            Better::Neither => None,
        };
        let best = best.filter(|_| least != most);
        values.iter().filter(|value| Some(value.1) == best).map(|value| value.0).collect()
    }

    /// Takes over the cells of another sweep that are of the same run, and returns their number. `None` if it is of
    /// other inputs: then no cell of it can be.
    pub fn adopt(&mut self, other: &Sweep) -> Option<usize> {
        if other.inputs != self.inputs {
            return None;
        }
        let key = |parameters: Parameters| Parameters::KEYS.map(|key| parameters.text_of(key).unwrap_or_default());
        let known = other.cells.iter().enumerate().filter_map(|(k, cell)| Some((k, cell.as_ref()?)));
        let theirs: BTreeMap<_, _> = known.map(|(k, cell)| (key(other.parameters_of(k)), cell)).collect();
        let mut adopted = 0;
        for cell in self.missing() {
            if let Some(found) = theirs.get(&key(self.parameters_of(cell))) {
                self.cells[cell] = Some((*found).clone());
                adopted += 1;
            }
        }
        Some(adopted)
    }
}

fn check(axes: &[Axis]) -> Result<(), Fault> {
    match axes {
        [_] => {}
        [a, b] if a.key == b.key => {
            return Err(Fault::new(format!("{} is swept twice", a.key)).remedy("Name two different keys"));
        }
        [_, _] => {}
        _ => {
            return Err(Fault::new(format!("A sweep has one axis or two, not {}", axes.len()))
                .remedy("Name one key or two, and set others for the whole sweep"));
        }
    }
    // Each axis has at most MOST_CELLS values: the product cannot overflow.
    let count: usize = axes.iter().map(|axis| axis.values.len()).product();
    if count > MOST_CELLS {
        return Err(Fault::new(format!("The sweep has {count} cells; it may have {MOST_CELLS}"))
            .remedy("Take larger steps or fewer values"));
    }
    Ok(())
}
