//! Progress on a terminal, and the time of each stage; `core` itself has no clock.

use std::fmt::Write;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use web_time::Instant;

use super::memory::{self, Beside};
use crate::core::fault::Fault;
use crate::core::kernel::number::grouped;
use crate::core::progress::{Cancel, Need, Stage, Watch};

/// The cancellation by Ctrl-C.
pub(super) static INTERRUPT: LazyLock<Cancel> = LazyLock::new(Cancel::new);

/// Whether Ctrl-C leaves time to finish the files under way: set by work that keeps what it has.
pub(super) static KEEPS: AtomicBool = AtomicBool::new(false);

/// Shows progress on standard error where that is a terminal, and measures the time of each stage.
pub(super) struct Progress {
    bar: ProgressBar,
    times: StageTimes,
    total: u64,
    beside: Beside,
}

/// The seconds of each stage, in the order of the work.
#[derive(Default)]
pub(super) struct StageTimes {
    now: Option<(Stage, Instant)>,
    times: Vec<(Stage, f64)>,
}

impl StageTimes {
    /// A stage is under way. Returns whether it has just begun.
    pub fn begin(&mut self, stage: Stage) -> bool {
        let begins = self.now.is_none_or(|(now, _)| now != stage);
        if begins {
            self.close();
            self.now = Some((stage, Instant::now()));
        }
        begins
    }

    /// The seconds of each stage up to now.
    pub fn finish(mut self) -> Vec<(Stage, f64)> {
        self.close();
        self.times
    }

    fn close(&mut self) {
        let Some((stage, since)) = self.now.take() else { return };
        let seconds = since.elapsed().as_secs_f64();
        match self.times.iter_mut().find(|time| time.0 == stage) {
            Some(time) => time.1 += seconds,
            None => self.times.push((stage, seconds)),
        }
    }
}

impl Progress {
    /// Shows nothing where `quiet` or where standard error is not a terminal.
    pub fn new(quiet: bool) -> Progress {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(None, target).with_style(style("{msg}"));
        Progress { bar, times: StageTimes::default(), total: 0, beside: Beside::Nothing }
    }

    /// Counts what the command keeps beside the mesh, where memory is short.
    pub fn keeping(mut self, beside: Beside) -> Progress {
        self.beside = beside;
        self
    }

    /// Clears the line and returns the seconds of each stage, in the order of the work.
    pub fn finish(mut self) -> Vec<(Stage, f64)> {
        std::mem::take(&mut self.times).finish()
    }

    fn begin(&mut self, stage: Stage, total: u64) {
        // Set a style without numbers first, since each of the changes below may be drawn.
        self.bar.set_style(style("{msg}"));
        self.bar.set_message(words(stage));
        self.bar.reset();
        self.set_total(total);
    }

    fn set_total(&mut self, total: u64) {
        self.total = total;
        self.bar.set_length(total);
        self.bar.reset_eta();
        let parts = match self.times.now {
            _ if total == 0 => "{msg}",
            // These count bytes or steps of unequal length.
            Some((Stage::Read | Stage::Repair, _)) => "{msg}: {percent} % {bar:20} {left}",
            _ => "{msg}: {done} of about {all} {bar:20} {left}",
        };
        self.bar.set_style(style(parts));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// A style with numbers formatted as in the rest of the program.
fn style(template: &str) -> ProgressStyle {
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    // Writing to a line of text cannot fail.
    style
        .with_key("done", |state: &ProgressState, out: &mut dyn Write| {
            let _ = out.write_str(&grouped(state.pos()));
        })
        .with_key("all", |state: &ProgressState, out: &mut dyn Write| {
            let _ = out.write_str(&grouped(state.len().unwrap_or(0)));
        })
        .with_key("left", |state: &ProgressState, out: &mut dyn Write| {
            let seconds = state.eta().as_secs_f64();
            let _ =
                if seconds < 9.95 { write!(out, "{seconds:.1} s left") } else { write!(out, "{seconds:.0} s left") };
        })
}

impl Watch for Progress {
    fn tell(&mut self, stage: Stage, done: u64, total: u64) {
        if self.times.begin(stage) {
            self.begin(stage, total);
        } else if total != self.total {
            self.set_total(total);
        }
        self.bar.set_position(done.min(total));
        self.bar.tick();
    }

    fn cancel(&self) -> Cancel {
        INTERRUPT.clone()
    }

    fn allow(&mut self, need: &Need) -> Result<(), Fault> {
        memory::allow(need, self.beside)
    }
}

/// A bar for `left` of `all` equal parts of some work, such as "cells".
pub(super) fn counting(message: &str, parts: &str, all: usize, left: usize, quiet: bool) -> ProgressBar {
    let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(all as u64), target).with_message(message.to_owned());
    bar.set_style(style(&format!("{{msg}}: {{done}} of {{all}} {parts} {{bar:20}} {{left}}")));
    bar.set_position((all - left) as u64);
    bar.reset_eta();
    bar
}

/// The name of a stage of the work.
pub(super) fn words(stage: Stage) -> &'static str {
    match stage {
        Stage::Read => "Reading",
        Stage::Repair => "Repairing the mesh",
        Stage::Chart => "Flattening the surface",
        Stage::Divide => "Dividing the curves",
        Stage::Triangulate => "Triangulating",
        Stage::Adapt => "Adapting the triangles",
        Stage::Convert => "Converting",
        Stage::Finish => "Cleaning up and smoothing",
        Stage::Check => "Checking and measuring",
        Stage::Draw => "Drawing frames",
        Stage::Write => "Writing",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stage_that_recurs_is_listed_once_at_its_first_position() {
        let mut progress = Progress::new(true);
        for (stage, done) in
            [(Stage::Divide, 0), (Stage::Adapt, 0), (Stage::Adapt, 5), (Stage::Divide, 0), (Stage::Convert, 0)]
        {
            progress.tell(stage, done, 10);
        }
        let stages: Vec<_> = progress.finish().into_iter().map(|time| time.0).collect();
        assert_eq!(stages, [Stage::Divide, Stage::Adapt, Stage::Convert]);
    }
}
