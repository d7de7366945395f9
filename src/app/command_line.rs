//! The words of the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use super::figure::FigureOptions;
use super::input::{InputFormat, Stops, Until, input_format, mesh_format, setting, stops, until};
use super::output::Target;
use crate::core::formats::format::Format;

/// quadfront: anisotropic quadrilateral meshes after Lee & Lee (2002).
#[derive(Parser)]
#[command(name = "quadfront", version, about, max_term_width = 100)]
#[command(
    after_help = "Exit codes: 0 done; 1 a checked mesh falls short; 2 bad input or usage; 130 stopped by Ctrl-C."
)]
pub(super) struct Cli {
    /// Without a command the window opens on example 1
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Subcommand)]
pub(super) enum Command {
    /// Open the window: step through a conversion, forward and back. Of a mesh it shows first what it is like and asks how it is
    /// taken, unless one of the options below says it
    Open(OpenArguments),
    /// Make an all-quadrilateral mesh of a case or of a triangle mesh
    Convert(ConvertArguments),
    /// Make the triangles that a conversion starts from, with their metric
    Background(BackgroundArguments),
    /// Examine a quadrilateral mesh in a file: exit 1 when it falls short
    Check(CheckArguments),
    /// Draw a mesh, or the mesh of a case, as SVG or PNG
    Render(RenderArguments),
    /// List the built-in cases
    Cases(CasesArguments),
}

/// What a mesh is made from.
#[derive(Args, Default)]
pub(super) struct Source {
    /// A built-in case, a case file or a run file (.toml), a mesh (.msh .mesh .vtu .obj .inp .ply .stl .gltf .glb), a figure that carries its run (.svg
    /// .png), or - for standard input
    #[arg(value_name = "CASE|MESH|FIGURE")]
    pub input: String,
    /// What is read where the name does not tell: toml (a case), msh, mesh, vtu, obj, inp, ply, stl, gltf, glb
    #[arg(long, value_name = "FORMAT", value_parser = input_format)]
    pub from: Option<InputFormat>,
    /// The metric at the nodes of MESH (Medit)
    #[arg(long, value_name = "FILE")]
    pub sol: Option<PathBuf>,
    /// Set a parameter of the case, for example size_scale=0.5 (may be given several times)
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = setting)]
    pub set: Vec<(String, String)>,
    /// Convert this face only and leave the others out (may be given several times)
    #[arg(long = "face", value_name = "NAME")]
    pub faces: Vec<String>,
    /// The paper's own reading of every parameter of the front, in place of the case's; --set comes after it
    #[arg(long)]
    pub paper: bool,
    /// No progress and no summary
    #[arg(short, long)]
    pub quiet: bool,
}

/// How a mesh that is given is used.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct MeshOptions {
    /// What MESH is used for: its triangles, converted as they are (what a mesh in the plane is used for where nothing is said), or
    /// its shape, meshed anew (a mesh in space)
    #[arg(long = "use", value_name = "triangles|shape", value_parser = ["triangles", "shape"], hide_possible_values = true)]
    pub used: Option<String>,
    /// Divide a side where triangles that are converted as they are have a border with an odd count of sides, instead of refusing them
    #[arg(long)]
    pub split_odd: bool,
    /// Size of elements on MESH, everywhere; with --curvature where it is flat
    #[arg(long, value_name = "H")]
    pub mesh_size: Option<f64>,
    /// Smaller elements where MESH is curved: how far a chord may be from its arc, over the radius (0.01)
    #[arg(long, value_name = "ERR", requires = "mesh_size")]
    pub curvature: Option<f64>,
    /// Folds of MESH beyond this angle in degrees are edges to keep (default 40)
    #[arg(long, value_name = "DEGREES")]
    pub feature_angle: Option<f64>,
    /// How far shapes may be stretched where MESH is laid into the plane (default 4)
    #[arg(long, value_name = "RATIO")]
    pub chart_stretch: Option<f64>,
    /// Multiply the coordinates of MESH (0.001: from millimetres to metres)
    #[arg(long, value_name = "FACTOR")]
    pub scale: Option<f64>,
}

/// Where a mesh goes.
#[derive(Args)]
pub(super) struct Destination {
    /// The mesh: .msh .mesh .vtu .obj .inp .ply, or - for standard output
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<Target>,
    /// The format of the mesh where its name does not tell: msh, mesh, vtu, obj, inp, ply
    #[arg(long, value_name = "FORMAT", value_parser = mesh_format)]
    pub format: Option<Format>,
    /// Write Gmsh's version 2.2 instead of 4.1
    #[arg(long)]
    pub msh2: bool,
    /// A picture (.svg .png), or - for standard output (SVG)
    #[arg(long, value_name = "FILE")]
    pub picture: Option<Target>,
}

#[derive(Args)]
pub(super) struct OpenArguments {
    /// A built-in case, a case file or a run file (.toml), a mesh, or a figure, which opens at the state that it shows
    #[arg(value_name = "CASE|MESH|FIGURE", default_value = "example1")]
    pub input: String,
    #[command(flatten)]
    pub mesh: MeshOptions,
}

#[derive(Args)]
pub(super) struct ConvertArguments {
    #[command(flatten)]
    pub source: Source,
    #[command(flatten)]
    pub mesh: MeshOptions,
    #[command(flatten)]
    pub destination: Destination,
    /// The report as JSON, or - for standard output
    #[arg(long, value_name = "FILE")]
    pub report: Option<Target>,
    /// What each step did, as one JSON object a line, or - for standard output
    #[arg(long, value_name = "FILE.jsonl")]
    pub events: Option<Target>,
    /// Stop where so many quadrilaterals stand (nq=100) or after so many steps (step=812), and write the mesh as it is then; a
    /// figure stops where it was drawn, unless this says end
    #[arg(long, value_name = "STOP", value_parser = until)]
    pub at: Option<Until>,
}

#[derive(Args)]
pub(super) struct BackgroundArguments {
    #[command(flatten)]
    pub source: Source,
    #[command(flatten)]
    pub mesh: MeshOptions,
    #[command(flatten)]
    pub destination: Destination,
}

#[derive(Args)]
pub(super) struct CheckArguments {
    /// The mesh, or - for standard input
    pub mesh: String,
    /// The format of the mesh where its name does not tell: msh, mesh, vtu, obj, inp
    #[arg(long, value_name = "FORMAT", value_parser = mesh_format)]
    pub from: Option<Format>,
    /// Allow triangles
    #[arg(long)]
    pub triangles: bool,
    /// Allow nodes at one place on the boundary (cracks, surfaces cut open)
    #[arg(long)]
    pub seams: bool,
    /// Allow edges of more than two elements (surfaces that meet in a curve)
    #[arg(long)]
    pub branching: bool,
    /// What was found as JSON, or - for standard output
    #[arg(long, value_name = "FILE")]
    pub report: Option<Target>,
    /// Say nothing but what is wrong
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Args)]
pub(super) struct RenderArguments {
    #[command(flatten)]
    pub source: Source,
    /// Divide a side where a border of MESH has an odd count of sides, instead of refusing it
    #[arg(long)]
    pub split_odd: bool,
    /// Draw the conversion where so many quadrilaterals stand (nq=100) or after so many steps (step=812); several, in their
    /// order, side by side (nq=50,100,150,end)
    #[arg(long, visible_alias = "strip", value_name = "STOPS", value_parser = stops)]
    pub at: Option<Stops>,
    #[command(flatten)]
    pub figure: FigureOptions,
    /// The picture (.svg .png), or - for standard output (SVG)
    #[arg(short, long, value_name = "FILE")]
    pub out: Target,
}

#[derive(Args)]
pub(super) struct CasesArguments {
    /// As JSON: name and title of each
    #[arg(long)]
    pub json: bool,
    /// Print the file of one case, to begin one's own from
    #[arg(value_name = "CASE", conflicts_with = "json")]
    pub name: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_words_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }

    #[test]
    fn what_the_issue_writes_is_understood() {
        for line in [
            "quadfront convert example1 --out example1.msh --report example1.json",
            "quadfront convert - -o - --format msh --from toml --set size_scale=0.5 --set c=1.5 --msh2 --quiet",
            "quadfront convert plate.mesh --sol plate.sol --split-odd -o quads.vtu --picture quads.svg",
            "quadfront convert bracket.stl --use shape --mesh-size 2 --curvature 0.01 --scale 0.001 -o quads.obj",
            "quadfront convert bracket.stl --use triangles --feature-angle 30 --chart-stretch 2 -o quads.obj",
            "quadfront convert example1 --paper --events example1.jsonl --at nq=100 -o front.vtu",
            "quadfront render example1 --at step=812 -o front.svg",
            "quadfront render example1 --at nq=50,100,150 -o strip.svg",
            "quadfront background example1 --out triangles.mesh",
            "quadfront check quads.msh --seams --branching",
            "quadfront render example1 -o example1.svg",
            "quadfront render example1 --at step=812 --size 1920x1080 -o front.png",
            "quadfront render example1 --strip nq=50,100,end -o strip.png",
            "quadfront render example1 --at nq=100 --plot lengths --ink grey --size 84x60mm --dpi 600 -o lengths.png",
            "quadfront render a.svg --layers -letters,+h --transparent --part 0.5,-0.5,0.1 -o b.svg",
            "quadfront convert a.svg --at end -o b.msh",
            "quadfront cases --json",
            "quadfront",
            "quadfront open",
            "quadfront open plate.toml",
            "quadfront open bracket.stl --use shape --feature-angle 30",
        ] {
            assert!(Cli::try_parse_from(line.split(' ')).is_ok(), "{line}");
        }
        for line in [
            "quadfront wobble",
            "quadfront convert",
            "quadfront convert a --set size_scale",
            "quadfront check",
            "quadfront convert a --at 5",
            "quadfront convert a.stl --use wobble",
            "quadfront convert a.stl --curvature 0.1",
            "quadfront render a --at nq=2,1 -o a.svg",
        ] {
            assert!(Cli::try_parse_from(line.split(' ')).is_err(), "{line}");
        }
    }
}
