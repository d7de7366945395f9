//! The options of films.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser, ValueEnum};

use crate::app::command_line::{Overrides, Source};
use crate::app::figure::FigureOptions;
use crate::app::figure::every::Every;
use crate::app::input::{Until, until};
use crate::app::output::Target;
use crate::core::convert::Stop;
use crate::core::fault::Fault;
use crate::render::film::{FASTEST, LONGEST_HOLD, Playing};

/// The arguments of `animate`.
#[derive(Args)]
pub(in crate::app) struct AnimateArguments {
    /// A built-in case, a case file or a run file (.toml), a mesh, a figure with an embedded run, or - for a case on
    /// standard input
    #[arg(value_name = "CASE|MESH|FIGURE")]
    pub input: String,
    /// Metric at the nodes of MESH (Medit .sol)
    #[arg(long, value_name = "FILE")]
    pub sol: Option<PathBuf>,
    #[command(flatten)]
    pub overrides: Overrides,
    /// Print no progress and no summary
    #[arg(short, long)]
    pub quiet: bool,
    /// Divide one side of each border of MESH that has an odd number of sides, instead of refusing it
    #[arg(long)]
    pub split_odd: bool,
    #[command(flatten)]
    pub film: FilmOptions,
    #[command(flatten)]
    pub figure: FigureOptions,
    /// Write the film (.gif .apng)
    #[arg(short, long, value_name = "FILE")]
    pub out: Target,
}

impl AnimateArguments {
    /// The input. Its format is not an option, since --from is where the film begins.
    pub fn source(&self) -> Source {
        let AnimateArguments { input, sol, overrides, quiet, .. } = self;
        Source { input: input.clone(), from: None, sol: sol.clone(), overrides: overrides.clone(), quiet: *quiet }
    }
}

/// How often a film plays; `None`: until it is stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::app) struct Plays(pub Option<u16>);

impl FromStr for Plays {
    type Err = String;

    fn from_str(text: &str) -> Result<Plays, String> {
        match text {
            "forever" => Ok(Plays(None)),
            "once" => Ok(Plays(Some(1))),
            _ => match text.parse() {
                Ok(0) | Err(_) => Err("write forever, once, or a number from 1 to 65535".to_owned()),
                Ok(plays) => Ok(Plays(Some(plays))),
            },
        }
    }
}

/// The camera of a film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(in crate::app) enum FilmCamera {
    /// It shows the whole mesh, or the part that --part names
    #[default]
    Fixed,
    /// It glides to where the next quadrilateral is formed
    Follow,
}

/// Parses a stop.
fn stop(text: &str) -> Result<Stop, String> {
    text.parse().map_err(|()| "write nq=100 (quadrilaterals) or step=812".to_owned())
}

fn rate(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|rate| (0.1..=FASTEST).contains(rate));
    number.ok_or_else(|| format!("write a number from 0.1 to {FASTEST}"))
}

fn hold(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|seconds| (0.0..=LONGEST_HOLD).contains(seconds));
    number.ok_or_else(|| format!("write a number from 0 to {LONGEST_HOLD}"))
}

/// Options of a film.
#[derive(Args, Clone, Copy, Debug, PartialEq)]
pub(in crate::app) struct FilmOptions {
    /// The first frame: a number of quadrilaterals (nq=100) or of steps (step=812)
    #[arg(long, value_name = "STOP", value_parser = stop, default_value = "nq=0")]
    pub from: Stop,
    /// The last frame: the same, or end
    #[arg(long, value_name = "STOP", value_parser = until, default_value = "end")]
    pub to: Until,
    /// From one frame to the next: a number of quadrilaterals (5) or of steps (step=20), quad for each quadrilateral,
    /// event for each step
    #[arg(long, value_name = "N|quad|event|step=N", default_value = "quad")]
    pub every: Every,
    /// The camera
    #[arg(long, value_name = "CAMERA", default_value = "fixed")]
    pub camera: FilmCamera,
    /// Frames a second, at most 50
    #[arg(long, value_name = "NUMBER", value_parser = rate, default_value = "10")]
    pub rate: f64,
    /// How often it plays
    #[arg(long = "loop", value_name = "N|forever|once", default_value = "forever")]
    pub plays: Plays,
    /// Seconds that the last frame stays
    #[arg(long, value_name = "SECONDS", value_parser = hold, default_value = "2")]
    pub hold: f64,
}

/// Parses options alone, as the window has them.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Words {
    #[command(flatten)]
    options: FilmOptions,
}

impl FilmOptions {
    /// Parses options from command-line arguments.
    ///
    /// # Errors
    /// Arguments that are not options of films.
    pub fn from_words(words: &[String]) -> Result<FilmOptions, Fault> {
        Words::try_parse_from(words).map(|read| read.options).map_err(|error| {
            let line = error.to_string().lines().next().unwrap_or_default().replace("error: ", "");
            Fault::new(format!("The film cannot be made so: {line}"))
        })
    }

    /// How it plays.
    pub fn playing(&self) -> Playing {
        Playing { rate: self.rate, plays: self.plays.0, hold: self.hold }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_are_read() {
        let plays = |text: &str| text.parse::<Plays>().ok().map(|plays| plays.0);
        assert_eq!(["forever", "once", "3"].map(plays), [Some(None), Some(Some(1)), Some(Some(3))]);
        assert_eq!(["0", "70000", "twice"].map(plays), [None; 3]);
    }
}
