//! The options of meshes and CAD files.

use clap::Args;

use crate::app::input::{length, mesh_use, unit, weld};
use crate::core::case::{ImportOptions, MeshUse};
use crate::core::soup::{Ignored, Weld};
use crate::core::step::{StepOptions, Unit};

/// How a mesh is imported.
#[derive(Args, Default)]
pub(in crate::app) struct MeshArguments {
    /// Use of MESH: convert its triangles, or remesh its shape [default: triangles in the plane, shape in space]
    #[arg(long = "use", value_name = "triangles|shape", value_parser = mesh_use)]
    used: Option<MeshUse>,
    /// With --use triangles, divide one side of each border that has an odd number of sides, instead of refusing MESH
    #[arg(long)]
    split_odd: bool,
    /// Element size on MESH; with --curvature that of flat regions
    #[arg(long, value_name = "H")]
    mesh_size: Option<f64>,
    /// Smaller elements where MESH or its border is curved: distance of chord and arc, divided by the radius (0.01)
    #[arg(long, value_name = "ERR", requires = "mesh_size")]
    curvature: Option<f64>,
    /// Keep edges of MESH with a fold beyond this angle, in degrees [default: 40]
    #[arg(long, value_name = "DEGREES")]
    feature_angle: Option<f64>,
    /// Limit of the distortion of shapes where MESH is flattened [default: 4]
    #[arg(long, value_name = "RATIO")]
    chart_stretch: Option<f64>,
    /// Multiply the coordinates of MESH (0.001: from millimetres to metres)
    #[arg(long, value_name = "FACTOR")]
    scale: Option<f64>,
    /// Keep the shape of borders of MESH: distance of chord and arc, divided by the radius [default: 0.1]
    #[arg(long, value_name = "ERR")]
    chord: Option<f64>,
    /// Read MESH as if it had no groups, or not those of these names
    #[arg(long, value_name = "NAME,...", num_args = 0..=1, require_equals = true, default_missing_value = "")]
    ignore_groups: Option<String>,
    /// Merge points of borders of MESH up to this distance, none (0), or those far below the edges there (auto)
    #[arg(long, value_name = "DISTANCE|auto|0", value_parser = weld, default_value = Weld::AUTO, hide_default_value = true)]
    weld: Weld,
    /// Unit of the coordinates of STEP: mm, cm, m, um, in, ft [default: that of the file]
    #[arg(long, value_name = "UNIT", value_parser = unit)]
    unit: Option<Unit>,
    /// Distance up to which edges of STEP are one [default: 1e-5 of the diagonal]
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    tolerance: Option<f64>,
    /// Leave out faces of STEP that cannot be taken, instead of refusing the file
    #[arg(long)]
    skip_bad_faces: bool,
}

impl MeshArguments {
    /// The options that they set.
    pub fn options(&self) -> ImportOptions {
        let &MeshArguments {
            used, split_odd, mesh_size, curvature, feature_angle, chart_stretch, scale, chord, ..
        } = self;
        let ignore_groups = match self.ignore_groups.as_deref() {
            None => Ignored::Nothing,
            Some("") => Ignored::All,
            Some(names) => Ignored::Named(names.split(',').map(|name| name.trim().to_owned()).collect()),
        };
        ImportOptions {
            used,
            split_odd,
            mesh_size,
            curvature,
            feature_angle,
            chart_stretch,
            scale,
            chord,
            ignore_groups,
            weld: self.weld,
            step: StepOptions { unit: self.unit, tolerance: self.tolerance, skip_bad_faces: self.skip_bad_faces },
        }
    }

    /// The options as command-line arguments.
    pub fn words(&self) -> Vec<String> {
        let &MeshArguments {
            used, split_odd, mesh_size, curvature, feature_angle, chart_stretch, scale, chord, ..
        } = self;
        let number = |name: &str, value: Option<f64>| value.map(|value| format!("--{name}={value}"));
        let words = [
            used.map(|used| format!("--use={}", used.name())),
            split_odd.then(|| "--split-odd".to_owned()),
            number("mesh-size", mesh_size),
            number("curvature", curvature),
            number("feature-angle", feature_angle),
            number("chart-stretch", chart_stretch),
            number("scale", scale),
            number("chord", chord),
            self.ignore_groups.as_ref().map(|names| match names.as_str() {
                "" => "--ignore-groups".to_owned(),
                names => format!("--ignore-groups={names}"),
            }),
            (self.weld != Weld::Auto).then(|| format!("--weld={}", self.weld.written())),
            self.unit.map(|unit| format!("--unit={}", unit.word())),
            number("tolerance", self.tolerance),
            self.skip_bad_faces.then(|| "--skip-bad-faces".to_owned()),
        ];
        words.into_iter().flatten().collect()
    }
}
