//! The sweep of the window: conversions of the run that is open for values of one or two of its parameters, on threads
//! of their own, one for each processor.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use super::files::{self, Writing, free_path};
use super::session::{Source, Wake};
use super::state::State;
use crate::app::command_line::Overrides;
use crate::app::output::Target;
use crate::app::sweep::{Outputs, SweepLook, pool};
use crate::app::tasks;
use crate::core::case::Parameters;
use crate::core::fault::Fault;
use crate::core::formats::save;
use crate::core::progress::Cancel;
use crate::core::record::report::figures::{FIGURES, Figure};
use crate::core::record::sweep::{Axis, Cell, DEFAULT_AXES, DEFAULT_FIGURE, Sweep, TIME};
use crate::core::run::Run;

/// The largest number of cells in the window, each of which is something to click.
pub const MOST_CELLS: usize = 2000;

/// What can be done with the sweep.
#[derive(Clone, Debug, PartialEq)]
pub enum SweepCommand {
    /// Show the panel.
    Show,
    /// Change what is swept and shown.
    Set(Box<SweepForm>),
    /// Begin; cells that are known already are kept.
    Run,
    /// End, and keep the cells that are known.
    Stop,
    /// Open the run of a cell as the second one, beside the run that is open.
    OpenBeside(usize),
    /// Open it in place of the run that is open.
    Open(usize),
    /// Ask where to save it.
    Save,
    /// Save it to a path.
    SaveAs(String),
}

impl SweepCommand {
    /// Those that need no more than their names.
    pub const ALL: [SweepCommand; 4] = [SweepCommand::Show, SweepCommand::Run, SweepCommand::Stop, SweepCommand::Save];

    /// Its name in the palette, in menus and in tooltips.
    pub fn name(&self) -> String {
        match self {
            SweepCommand::Show => "Sweep parameters…".into(),
            SweepCommand::Set(_) => "Change the sweep".into(),
            SweepCommand::Run => "Run the sweep".into(),
            SweepCommand::Stop => "Stop the sweep".into(),
            SweepCommand::OpenBeside(cell) => format!("Open run {} of the sweep as second run", cell + 1),
            SweepCommand::Open(cell) => format!("Open run {} of the sweep", cell + 1),
            SweepCommand::Save => "Save the sweep…".into(),
            SweepCommand::SaveAs(path) => format!("Save the sweep as {path}"),
        }
    }
}

/// What is swept and shown, as the user has set it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SweepForm {
    /// The key and the values of each axis; the second may be without a key.
    pub axes: [(Option<&'static str>, String); 2],
    /// The name of the figure.
    pub figure: &'static str,
}

impl Default for SweepForm {
    fn default() -> Self {
        let axis = |text: &str| {
            let (key, values) = text.split_once('=').unwrap_or_default();
            (Parameters::KEYS.into_iter().find(|known| *known == key), values.to_owned())
        };
        SweepForm { axes: DEFAULT_AXES.map(axis), figure: DEFAULT_FIGURE }
    }
}

impl SweepForm {
    /// The axes.
    ///
    /// # Errors
    /// As [`Axis::parse`]; more cells than the window shows.
    pub fn axes(&self) -> Result<Vec<Axis>, Fault> {
        let texts = self.axes.iter().filter_map(|(key, values)| Some(format!("{}={values}", (*key)?)));
        let axes: Vec<Axis> = texts.map(|text| Axis::parse(&text)).collect::<Result<_, _>>()?;
        let count: usize = axes.iter().map(|axis| axis.values.len()).product();
        if count > MOST_CELLS {
            return Err(Fault::new(format!("{count} runs are too many for the window, which shows {MOST_CELLS}"))
                .remedy("Take larger steps, or use quadfront sweep"));
        }
        Ok(axes)
    }

    /// The figure.
    pub fn figure(&self) -> &'static Figure {
        Figure::named(self.figure).unwrap_or(&FIGURES[0])
    }
}

/// What a sweep reports.
enum News {
    Began(Box<Sweep>),
    Cells(Vec<(usize, Cell)>),
    Fault(Fault),
}

/// A sweep, under way or ended.
pub struct SweepWork {
    /// What was open when it began.
    source: Source,
    overrides: Overrides,
    run: Run,
    /// The cells so far; none until it has begun.
    pub sweep: Option<Sweep>,
    /// On how many threads it runs.
    pub threads: usize,
    /// The reports, while it runs.
    news: Option<Receiver<News>>,
    cancel: Cancel,
}

impl SweepWork {
    /// Begins to sweep a run, which was opened from a source. Takes over the cells that it has in common with an
    /// earlier sweep. `wake` is called when there are cells.
    pub fn begin(
        (source, overrides): (Source, Overrides),
        run: Run,
        axes: Vec<Axis>,
        earlier: Option<Sweep>,
        wake: Wake,
    ) -> SweepWork {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let (tell, news) = channel();
        let cancel = Cancel::new();
        let (own, stop) = (run.clone(), cancel.clone());
        tasks::work(move || {
            // Nobody listens once the sweep has been stopped.
            let tell = |news| {
                let _ = tell.send(news);
                wake();
            };
            // This reads a mesh of the run.
            let mut sweep = match Sweep::new(&own, axes) {
                Ok(sweep) => sweep,
                Err(fault) => return tell(News::Fault(fault)),
            };
            if let Some(earlier) = earlier {
                sweep.adopt(&earlier);
            }
            tell(News::Began(Box::new(sweep.clone())));
            pool::convert(&own, &sweep, threads, &mut |cells| {
                if !cells.is_empty() {
                    tell(News::Cells(cells));
                }
                !stop.is_asked()
            });
        });
        SweepWork { source, overrides, run, sweep: None, threads, news: Some(news), cancel }
    }

    /// Whether it is under way.
    pub fn is_running(&self) -> bool {
        self.news.is_some()
    }

    /// The number of changes that each of its runs makes at steps.
    pub fn edits(&self) -> usize {
        self.run.edits().len()
    }

    /// Ends it. The cells that are known stay.
    pub fn stop(&mut self) {
        self.cancel.ask();
        self.news = None;
    }

    /// Takes in what it reports. Returns a fault because of which it does not begin.
    pub fn hear(&mut self) -> Option<Fault> {
        loop {
            match self.news.as_ref()?.try_recv() {
                Ok(News::Began(sweep)) => self.sweep = Some(*sweep),
                Ok(News::Cells(cells)) => {
                    if let Some(sweep) = &mut self.sweep {
                        cells.into_iter().for_each(|(cell, with)| sweep.fill(cell, with));
                    }
                }
                Ok(News::Fault(fault)) => {
                    self.news = None;
                    return Some(fault);
                }
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => self.news = None,
            }
            if self.sweep.as_ref().is_some_and(|sweep| sweep.missing().is_empty()) {
                self.news = None;
            }
        }
    }

    /// The run of a cell, with what it can be opened from again.
    pub fn run_of(&self, cell: usize) -> Option<(Source, Overrides, Run)> {
        let sweep = self.sweep.as_ref().filter(|sweep| cell < sweep.cells().len())?;
        let mut overrides = self.overrides.clone();
        for (key, value) in sweep.values(cell) {
            overrides.set.retain(|set| set.0 != key);
            overrides.set.push((key.to_owned(), value.to_owned()));
        }
        Some((self.source.clone(), overrides, sweep.run_of(cell, &self.run)))
    }

    /// The cell whose run is open in a state.
    pub fn at_hand(&self, state: &State) -> Option<usize> {
        let (sweep, opened) = (self.sweep.as_ref()?, state.run().opened.as_ref()?);
        let is_same = opened.run.case.text == self.run.case.text
            && state.run().source.as_ref() == Some(&self.source)
            && state.document().edits == self.run.edits();
        sweep.cell_with(&opened.run.parameters).filter(|_| is_same)
    }

    /// A path for it that is free.
    pub fn suggested_path(&self) -> String {
        free_path(&format!("{}-sweep", self.run.case.name), "svg").display().to_string()
    }

    /// Starts to write it in the format of the path's extension; does nothing before it has begun.
    ///
    /// # Errors
    /// If there is such a file, or no such format.
    pub fn save(&self, path: &str, figure: &'static Figure, wake: Wake) -> Result<Option<Writing>, Fault> {
        let Some(sweep) = self.sweep.clone() else { return Ok(None) };
        let path = PathBuf::from(path.trim());
        if save::is_file(&path) {
            let fault = Fault::new("There is a file of this name").at(path.display().to_string());
            return Err(fault.remedy("Choose another name: no file is overwritten"));
        }
        let (outputs, _) = Outputs::of(&[Target::File(path.clone())])?;
        let (case, look) = (self.run.case.clone(), SweepLook { figure, with_time: figure.name == TIME });
        Ok(Some(files::work(wake, move || {
            outputs.write(&case, &sweep, look)?;
            Ok(format!("The sweep was saved as {}.", path.display()))
        })))
    }
}

impl Drop for SweepWork {
    fn drop(&mut self) {
        self.cancel.ask();
    }
}
