//! The arguments of the command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};

use super::figure::FigureOptions;
use super::figure::every::Every;
#[cfg(feature = "window")]
use super::film::AnimateArguments;
use super::input::{InputFormat, Stops, Until, input_format, mesh_format, series, setting, stops, until, weld};
use super::output::Target;
use crate::core::fault::Fault;
use crate::core::formats::Format;
use crate::core::question::Series;
use crate::core::record::report::figures::{FIGURES, Figure};
use crate::core::run::Run;
use crate::core::soup::Weld;
use mesh::MeshArguments;

mod mesh;

/// quadfront: anisotropic quadrilateral meshes after Lee & Lee (2002).
#[derive(Parser)]
#[command(name = "quadfront", version, about, max_term_width = 100)]
#[command(
    after_help = "Exit codes: 0 success; 1 the checked or converted mesh is invalid, or runs differ; 2 bad input \
                  or usage; 130 stopped by Ctrl-C."
)]
pub(super) struct Cli {
    /// Without a command, the window opens with example 1
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Subcommand)]
pub(super) enum Command {
    /// Open the window: step through a conversion, forward and back. A mesh is previewed first with its import options,
    /// unless one of them is given here
    Open(OpenArguments),
    /// Make an all-quadrilateral mesh of a case or of a triangle mesh
    Convert(ConvertArguments),
    /// Make the background mesh: the triangles that a conversion starts from, with their metric
    Background(BackgroundArguments),
    /// Check a quadrilateral mesh in a file (exit code 1 if it is invalid)
    Check(CheckArguments),
    /// Compare two runs: the step at which they first differ, why, and what both end with (exit code 1 if they differ)
    Compare(CompareArguments),
    /// Find the smallest case that still shows something: an event, a bad angle, a refusal
    Reduce(ReduceArguments),
    /// Sweep one or two parameters: what a conversion ends with for each of their values, as a heat map or a table
    Sweep(SweepArguments),
    /// Draw a mesh, or states of a conversion, as SVG, PDF or PNG
    Render(RenderArguments),
    /// Make a film of a conversion (GIF, animated PNG)
    #[cfg(feature = "window")]
    Animate(AnimateArguments),
    /// Write the notes on the bookmarked steps of a run as one page (HTML), with a figure of each
    Notes(NotesArguments),
    /// Write a case, a run or a lesson as one page (HTML) with the program inside, which opens in any browser
    Page(PageArguments),
    /// List the lessons of the tour; check a lesson, one of your own too, and print it
    Lesson(LessonArguments),
    /// List the built-in cases
    Cases(CasesArguments),
}

/// The input of a conversion.
#[derive(Args, Default)]
pub(super) struct Source {
    /// A built-in case, a case file or a run file (.toml), a mesh (.msh .mesh .vtu .obj .inp .ply .stl .gltf .glb), a
    /// CAD file (.step .stp .p21), a figure with an embedded run (.svg .png .pdf), or - for standard input
    #[arg(value_name = "CASE|MESH|FIGURE")]
    pub input: String,
    /// Format of standard input: toml (a case), step, msh, mesh, vtu, obj, inp, ply, stl, gltf, glb
    #[arg(long, value_name = "FORMAT", value_parser = input_format)]
    pub from: Option<InputFormat>,
    /// Metric at the nodes of MESH (Medit .sol)
    #[arg(long, value_name = "FILE")]
    pub sol: Option<PathBuf>,
    #[command(flatten)]
    pub overrides: Overrides,
    /// Print no progress and no summary
    #[arg(short, long)]
    pub quiet: bool,
}

impl Source {
    /// The input and how it is read as command-line arguments.
    pub fn words(&self) -> Vec<String> {
        let Source { input, from, sol, overrides, quiet: _ } = self;
        let mut words = vec![input.clone()];
        words.extend(from.map(|from| format!("--from={}", from.word())));
        words.extend(sol.iter().map(|sol| format!("--sol={}", sol.display())));
        words.extend(overrides.set.iter().map(|(key, value)| format!("--set={key}={value}")));
        words.extend(overrides.faces.iter().map(|face| format!("--face={face}")));
        words.extend(overrides.paper.then(|| "--paper".to_owned()));
        words
    }
}

/// Changes of the parameters of a case before its run begins, in this order: the paper's, the faces, single values.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Set a parameter of the case, for example size_scale=0.5 (repeatable)
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, String)>,
    /// Convert only this face (repeatable)
    #[arg(long = "face", value_name = "NAME")]
    pub faces: Vec<String>,
    /// Use the paper's rules and values instead of the case's; size, layers, faces and limit stay, and --set applies
    /// afterwards. Not the paper's: lengths over the metrics of both ends; exact and firm convexity; the gates of a
    /// formation; parity counted after it; attempts after the left-hand neighbour; small loops, the last resort and
    /// unfolding; the energy by which clean-up smooths (docs/algorithm.md, "Departures from the paper")
    #[arg(long)]
    pub paper: bool,
}

impl Overrides {
    /// Changes the parameters of a run from step 0 on; `option` is the one that sets single values.
    ///
    /// # Errors
    /// An unknown key, or a value of the wrong type or out of range.
    pub(super) fn apply(&self, run: &mut Run, option: &str) -> Result<(), Fault> {
        let parameters = &mut run.parameters;
        if self.paper {
            *parameters = parameters.read_as_paper();
        }
        if !self.faces.is_empty() {
            parameters.faces.clone_from(&self.faces);
        }
        for (key, value) in &self.set {
            parameters.set(key, value).map_err(|fault| fault.at(option))?;
        }
        run.case.parameters = parameters.clone();
        Ok(())
    }
}

/// The outputs of a mesh.
#[derive(Args)]
pub(super) struct Destination {
    /// Write the mesh (.msh .mesh .vtu .obj .inp .ply), or - for standard output
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<Target>,
    /// Format of the mesh, where the extension does not name it: msh, mesh, vtu, obj, inp, ply
    #[arg(long, value_name = "FORMAT", value_parser = mesh_format)]
    pub format: Option<Format>,
    /// Write Gmsh format 2.2 instead of 4.1
    #[arg(long)]
    pub msh2: bool,
    /// Write a picture (.svg .pdf .png), or - for standard output (SVG)
    #[arg(long, value_name = "FILE")]
    pub picture: Option<Target>,
}

/// The figures of a report, with their meaning.
fn figures() -> impl TypedValueParser<Value = &'static Figure> {
    let named = |name: String| Figure::named(&name).expect("a possible value is the name of a figure");
    let all = FIGURES.iter().map(|figure| PossibleValue::new(figure.name).help(figure.doc));
    PossibleValuesParser::new(all).map(named)
}

#[derive(Args)]
pub(super) struct OpenArguments {
    /// A built-in case, a case file or a run file (.toml), a mesh, a figure, which opens at the state it shows, a
    /// lesson (.md), or a link to a state, in quotes: '#case=example1&c=1.8&step=812&select=104-105'
    #[arg(value_name = "CASE|MESH|FIGURE|LESSON|LINK", default_value = "example1")]
    pub input: String,
    #[command(flatten)]
    pub overrides: Overrides,
    #[command(flatten)]
    pub mesh: MeshArguments,
    /// Ask what some steps do, drawn from the run by a seed: the same seed asks the same on every machine, for a class.
    /// The answers can be saved as CSV. Kinds: segment, edge, top, seam, and class, node, form, split, count
    #[arg(long, value_name = "seed=7,count=10", value_parser = series)]
    pub predict: Option<Series>,
}

impl OpenArguments {
    /// Opens an input as it is.
    pub fn of(input: &str) -> OpenArguments {
        OpenArguments {
            input: input.to_owned(),
            overrides: Overrides::default(),
            mesh: MeshArguments::default(),
            predict: None,
        }
    }
}

#[derive(Args)]
pub(super) struct ConvertArguments {
    #[command(flatten)]
    pub source: Source,
    #[command(flatten)]
    pub mesh: MeshArguments,
    #[command(flatten)]
    pub destination: Destination,
    /// Write the report as JSON, or - for standard output
    #[arg(long, value_name = "FILE")]
    pub report: Option<Target>,
    /// Write the event of each step, one JSON object per line, or - for standard output
    #[arg(long, value_name = "FILE.jsonl")]
    pub events: Option<Target>,
    /// Stop at a number of quadrilaterals (nq=100) or steps (step=812) and write the mesh of that state. The run of a
    /// figure stops where it was drawn; end continues to the end
    #[arg(long, value_name = "STOP", value_parser = until)]
    pub at: Option<Until>,
}

#[derive(Args)]
pub(super) struct BackgroundArguments {
    #[command(flatten)]
    pub source: Source,
    #[command(flatten)]
    pub mesh: MeshArguments,
    #[command(flatten)]
    pub destination: Destination,
}

#[derive(Args)]
pub(super) struct CheckArguments {
    /// The mesh, or - for standard input
    pub mesh: String,
    /// Format of standard input: msh, mesh, vtu, obj, inp, ply, stl, gltf, glb
    #[arg(long, value_name = "FORMAT", value_parser = mesh_format)]
    pub from: Option<Format>,
    /// Allow triangles
    #[arg(long)]
    pub triangles: bool,
    /// Allow coincident nodes on the boundary (cracks, surfaces cut open)
    #[arg(long)]
    pub seams: bool,
    /// Allow edges of more than two elements (surfaces that meet in a curve)
    #[arg(long)]
    pub branching: bool,
    /// Merge points of borders first: up to this distance, none (0), or those far below the edges there (auto)
    #[arg(long, value_name = "DISTANCE|auto|0", value_parser = weld, default_value = Weld::AUTO, hide_default_value = true)]
    pub weld: Weld,
    /// Write the findings as JSON, or - for standard output
    #[arg(long, value_name = "FILE")]
    pub report: Option<Target>,
    /// Print only what is wrong
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Args)]
pub(super) struct CompareArguments {
    #[command(flatten)]
    pub source: Source,
    #[command(flatten)]
    pub mesh: MeshArguments,
    /// The other run, with the same options, or a finished mesh of quadrilaterals; without it, the same run with what
    /// --with changes
    #[arg(value_name = "OTHER")]
    pub other: Option<String>,
    /// Set a parameter of the other run, for example c=1.5 (repeatable)
    #[arg(long, value_name = "KEY=VALUE", value_parser = setting)]
    pub with: Vec<(String, String)>,
    /// Use the paper's rules and values in the other run, as --paper does in both
    #[arg(long)]
    pub with_paper: bool,
    /// Print the first N decisions, too, in which both differ although their fronts are the same around the base
    #[arg(long, value_name = "N")]
    pub differences: Option<usize>,
    /// Print the differences and both reports as JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub(super) struct SweepArguments {
    #[command(flatten)]
    pub source: Source,
    #[command(flatten)]
    pub mesh: MeshArguments,
    /// A parameter and its values: key=from:to:step, both ends included, or key=value,value (once or twice) [default:
    /// c=1.5:3:0.25 and theta_rect=110:150:5]
    #[arg(long, value_name = "KEY=VALUES")]
    pub over: Vec<String>,
    /// The figure of the report in picture and summary [default: irregular]. Tables have all figures; the time
    /// (seconds) only where it is shown. Repeatable: the first one is in the picture
    #[arg(long, value_name = "FIGURE", value_parser = figures())]
    pub show: Vec<&'static Figure>,
    /// Write the sweep (.svg .pdf .png .csv .json), also while it goes on (repeatable). A .json that is there is gone
    /// on with: cells of the same case, parameters and version are kept
    #[arg(short, long, value_name = "FILE")]
    pub out: Vec<Target>,
    /// Print one command for each cell, for other machines; each writes its cell to a file in a folder, which is made
    #[arg(long, value_name = "FOLDER", num_args = 0..=1, require_equals = true,
          default_missing_value = "sweep-cells", conflicts_with_all = ["out", "collect", "jobs"])]
    pub list: Option<PathBuf>,
    /// Convert nothing, and take the cells from the files in this folder
    #[arg(long, value_name = "FOLDER", conflicts_with = "jobs")]
    pub collect: Option<PathBuf>,
    /// Cells converted at the same time [default: the number of processors]
    #[arg(short, long, value_name = "NUMBER")]
    pub jobs: Option<NonZeroUsize>,
}

#[derive(Args)]
pub(super) struct ReduceArguments {
    #[command(flatten)]
    pub source: Source,
    #[command(flatten)]
    pub mesh: MeshArguments,
    /// What the smaller case must still show: a breakpoint condition that holds at some step ('quad.min_angle < 10',
    /// 'kind == seamed'), a condition on the end ('last_resort > 0', 'is refused', 'exit 1'), or 'panics'
    #[arg(long = "while", value_name = "CONDITION")]
    pub condition: String,
    /// Write the smallest case (.toml); a mesh goes beside it
    #[arg(short, long, value_name = "FILE")]
    pub out: PathBuf,
    /// Stop after this many tries
    #[arg(long, value_name = "N", default_value_t = 5000)]
    pub tries: u64,
}

#[derive(Args)]
pub(super) struct RenderArguments {
    #[command(flatten)]
    pub source: Source,
    /// Divide one side of each border of MESH that has an odd number of sides, instead of refusing it
    #[arg(long)]
    pub split_odd: bool,
    /// Draw the conversion at a number of quadrilaterals (nq=100) or steps (step=812); several in ascending order are
    /// drawn side by side (nq=50,100,150,end)
    #[arg(long, visible_alias = "strip", value_name = "STOPS", value_parser = stops)]
    pub at: Option<Stops>,
    /// Draw a state for each so many quadrilaterals (5) or steps (step=20), quad for each quadrilateral, event for
    /// each step: each in a file of its own with a number (front-00001.svg), or all on one page (--contact-sheet). --at
    /// names the first and the last one (nq=40,48) [default: the whole conversion]
    #[arg(long, value_name = "N|quad|event|step=N")]
    pub every: Option<Every>,
    #[command(flatten)]
    pub figure: FigureOptions,
    /// Write the picture (.svg .pdf .png), or - for standard output (SVG)
    #[arg(short, long, value_name = "FILE")]
    pub out: Target,
}

#[derive(Args)]
pub(super) struct NotesArguments {
    #[command(flatten)]
    pub source: Source,
    #[command(flatten)]
    pub figure: FigureOptions,
    /// Write the page (.html), or - for standard output
    #[arg(short, long, value_name = "FILE")]
    pub out: Target,
}

#[derive(Args)]
pub(super) struct PageArguments {
    #[command(flatten)]
    pub source: Source,
    /// The lesson of this name, where a case has it too
    #[arg(long)]
    pub lesson: bool,
    /// The state at which the page opens: nq=100, step=812 or end; without it the first one, or that of a figure
    #[arg(long, value_name = "STOP", value_parser = until)]
    pub at: Option<Until>,
    /// Write the page (.html), or - for standard output
    #[arg(short, long, value_name = "FILE")]
    pub out: Target,
}

#[derive(Args)]
pub(super) struct LessonArguments {
    /// Open it in the window, or the tour
    #[arg(long, conflicts_with_all = ["json", "answers", "list", "template"])]
    pub open: bool,
    /// Print it, or the list, as JSON
    #[arg(long)]
    pub json: bool,
    /// Print each question with its answer and the reason
    #[arg(long, requires = "lesson", conflicts_with = "json")]
    pub answers: bool,
    /// List the lessons of the tour; that is what happens without a lesson too
    #[arg(long, conflicts_with_all = ["lesson", "answers"])]
    pub list: bool,
    /// Print a lesson to begin with, for a file of your own
    #[arg(long, conflicts_with_all = ["lesson", "json", "answers", "list"])]
    pub template: bool,
    /// A lesson of the tour, or the file of one (.md)
    #[arg(value_name = "LESSON")]
    pub lesson: Option<String>,
}

#[derive(Args)]
pub(super) struct CasesArguments {
    /// Print name and title of each case as JSON
    #[arg(long)]
    pub json: bool,
    /// Print the file of one case, as a start for your own
    #[arg(value_name = "CASE", conflicts_with = "json")]
    pub name: Option<String>,
    /// Print the case of a STEP file: its surfaces, edges and faces by name, as a start for your own sizes
    #[arg(long, value_name = "STEP", conflicts_with_all = ["json", "name"])]
    pub from: Option<PathBuf>,
    #[command(flatten)]
    pub mesh: MeshArguments,
}

#[cfg(test)]
mod tests;
