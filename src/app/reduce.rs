//! `reduce`: the smallest case that still shows something.

pub(super) mod child;

use std::path::Path;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::command_line::{ReduceArguments, Source};
use super::input;
use super::output::Stream;
use super::progress::{INTERRUPT, Progress};
use crate::core::case::ImportOptions;
use crate::core::fault::Fault;
use crate::core::kernel::number::counted;
use crate::core::progress::Cancel;
use crate::core::reduce::{Budget, Draft, Finding, Question, Reduced, Size, Written, does_not_show, reduce as search};
use crate::core::run::Run;

/// Reduces a case, and writes the smallest one after each success, so that an interruption keeps it.
pub(super) fn reduce(arguments: &ReduceArguments) -> Result<(), Fault> {
    let ReduceArguments { source, mesh, condition, out, tries } = arguments;
    let question = Question::parse(condition).map_err(|fault| fault.at("--while"))?;
    let input = input::read(source, &mesh.options())?;
    let mut progress = Progress::new(source.quiet);
    let original = Draft::of(&input.run, &mut progress)?;
    progress.finish();
    let mut written = Written::new(out.clone(), &original, &question)?;
    // The hook would print a message for each panic that a try meets.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let (bar, cancel) = (bar(source.quiet), INTERRUPT.clone());
    let (run, start) = (&input.run, &child::convert);
    let work = Reduction { question: &question, run, original: &original, tries: *tries, cancel, start };
    let mut tell = |text: String| {
        bar.set_message(text);
        bar.tick();
    };
    let (done, smallest) = work.go(&source.input, &mut written, &mut tell);
    bar.finish_and_clear();
    std::panic::set_hook(hook);
    if work.cancel.is_asked() {
        Stream::Error.print(&match &smallest {
            Some(size) => format!("Stopped. {} has the smallest case so far: {size}\n", written.path().display()),
            None => "Stopped before anything could be left out. Nothing was written.\n".to_owned(),
        });
    }
    let reduced = done?;
    if !source.quiet {
        let head = format!("{}: {}\n", out.display(), reduced.finding.sentence);
        let lines = reduced.draft.size().changes(&original.size());
        let lines: String = lines.into_iter().map(|line| format!("  {line}\n")).collect();
        Stream::Output.print(&format!("{head}{lines}  {}\n", counted(reduced.tests, "smaller case") + " tried"));
    }
    Ok(())
}

/// The reduction of a run.
pub(super) struct Reduction<'r> {
    /// What the smaller case must still show.
    pub question: &'r Question,
    /// The run.
    pub run: &'r Run,
    /// The same as a draft.
    pub original: &'r Draft,
    /// The largest number of tries.
    pub tries: u64,
    /// Stops it.
    pub cancel: Cancel,
    /// Starts a try in a process of its own, where it may panic.
    pub start: &'r child::Start,
}

impl Reduction<'_> {
    /// Reduces the run, and writes the smallest case after each success, so that an interruption keeps it. `name` is
    /// that of the run in messages; `tell` hears how far it is. Returns what came of it, and the size of the smallest
    /// case that was written.
    pub fn go(
        &self,
        name: &str,
        written: &mut Written,
        tell: &mut dyn FnMut(String),
    ) -> (Result<Reduced, Fault>, Option<Size>) {
        let mut smallest = None;
        (self.reduced(name, written, tell, &mut smallest), smallest)
    }

    fn reduced(
        &self,
        name: &str,
        written: &mut Written,
        tell: &mut dyn FnMut(String),
        smallest: &mut Option<Size>,
    ) -> Result<Reduced, Fault> {
        let Reduction { question, run, original, tries, cancel, start } = self;
        tell("Looking at the case as it is".to_owned());
        let folder = tempfile::tempdir().map_err(|error| {
            Fault::new(format!("Cannot make a temporary folder: {error}"))
                .remedy("A reduction needs a disk: in a browser, save the run and use quadfront reduce")
        })?;
        let panic_of = |path: &Path| -> Result<Option<Finding>, Fault> {
            Ok(child::panic_of(start(path), cancel)?.map(|panic| Finding::panic(&panic)))
        };
        // A try in a file of its own, for another process.
        let in_child = |draft: &Draft, written: &Written| -> Result<Option<Finding>, Fault> {
            let file = written.beside(folder.path());
            file.write_try(draft)?;
            panic_of(file.path())
        };
        let mut found = None;
        for (format, draft) in written.drafts(original) {
            written.choose(format);
            let finding = if question.asks_for_a_panic() {
                in_child(&draft, written)?
            } else {
                question.find(&draft.run()?, Budget::UNLIMITED, cancel)?
            };
            if let Some(finding) = finding {
                found = Some((draft, finding));
                break;
            }
        }
        let Some((draft, first)) = found else {
            return Err(does_not_show(name, question, question.shown_instead(run, cancel)));
        };
        let budget = Budget::like(&first);
        let mut judge = |draft: &Draft| -> Result<Option<Finding>, Fault> {
            let Ok(run) = draft.run() else { return Ok(None) };
            let found = if question.asks_for_a_panic() {
                in_child(draft, written)?
            } else {
                question.find(&run, budget, cancel)?
            };
            Ok(found.filter(|found| found.is_like(&first)))
        };
        let mut hear = |tries: u64, draft: &Draft, finding: &Finding, is_new: bool| {
            tell(format!("Reducing: {} tried; now {}", counted(tries, "case"), draft.size()));
            if is_new {
                written.write(draft, finding, "The reduction has not ended: more may be left out.")?;
                *smallest = Some(draft.size());
            }
            Ok(())
        };
        let done = search(draft, first.clone(), *tries, &mut judge, &mut hear)?;
        let how = if done.is_least {
            format!("{} tried; no part that is left can be left out.", counted(done.tests, "smaller case"))
        } else {
            format!("{} tried; more tries may leave out more.", counted(done.tests, "smaller case"))
        };
        written.write(&done.draft, &done.finding, &how)?;
        let shown = if question.asks_for_a_panic() {
            panic_of(written.path())?
        } else {
            let file = Source { input: written.path().display().to_string(), quiet: true, ..Source::default() };
            question.find(&input::read(&file, &ImportOptions::default())?.run, budget, cancel)?
        };
        if shown.is_some_and(|found| found.is_like(&first)) {
            return Ok(done);
        }
        Err(Fault::new("The case that was written does not show it, though it did in memory")
            .at(written.path().display().to_string())
            .remedy("Report this as a bug, with the case that was reduced"))
    }
}

fn bar(quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let style = ProgressStyle::with_template("{msg}").unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(None, target).with_style(style)
}
