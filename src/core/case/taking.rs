//! Where the mesh of a case is, and how it is used: its triangles or its shape, feature angle, chart stretch, scale.

use std::path::PathBuf;
use std::sync::Arc;

use super::table::{Table, Value};
use crate::core::discrete::StretchBound;
use crate::core::discrete::features::ANGLE;
use crate::core::fault::Fault;
use crate::core::kernel::Metric3;
use crate::core::soup::{Ignored, MeshFile};

/// Where a mesh is.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MeshSource {
    /// In a file.
    File {
        /// The mesh.
        path: PathBuf,
        /// Its metric at the nodes (Medit `.sol`).
        sol: Option<PathBuf>,
    },
    /// In memory; runs that start from it cannot be saved.
    Memory(Arc<MeshFile>),
}

/// What a mesh is used as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshUse {
    /// Its triangles are converted directly.
    Triangles,
    /// Its shape is remeshed.
    Shape,
}

impl MeshUse {
    /// All uses.
    pub const ALL: [MeshUse; 2] = [MeshUse::Triangles, MeshUse::Shape];

    /// Its name in cases and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            MeshUse::Triangles => "triangles",
            MeshUse::Shape => "shape",
        }
    }

    /// The use of this name.
    pub fn named(name: &str) -> Option<MeshUse> {
        MeshUse::ALL.into_iter().find(|used| used.name() == name)
    }
}

/// How a mesh is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taking {
    /// As triangles or as a shape; by default, triangles for a mesh in the plane and the shape for one in space.
    pub used: Option<MeshUse>,
    /// Edges folded by more than this are kept (radians).
    pub feature_angle: f64,
    /// Limit on the stretch of charts ([`StretchBound::shape`]).
    pub chart_stretch: f64,
    /// Factor for all coordinates.
    pub scale: f64,
}

impl Taking {
    /// Smallest and largest feature angle, in degrees.
    pub const ANGLES: [f64; 2] = [1.0, 180.0];
    /// Smallest and largest chart stretch.
    pub const STRETCHES: [f64; 2] = [1.1, 50.0];
    /// Smallest and largest scale.
    pub const SCALES: [f64; 2] = [1e-9, 1e9];
}

impl Default for Taking {
    fn default() -> Self {
        Taking { used: None, feature_angle: ANGLE, chart_stretch: StretchBound::default().shape, scale: 1.0 }
    }
}

impl Taking {
    /// The stretch bound of charts.
    pub fn bound(&self) -> StretchBound {
        StretchBound { shape: self.chart_stretch, area: self.chart_stretch * self.chart_stretch }
    }

    /// Scales a mesh together with its metric, which is in the unit of the mesh.
    pub fn scale(&self, file: &mut MeshFile) {
        if self.scale == 1.0 {
            return;
        }
        file.points.iter_mut().for_each(|p| *p *= self.scale);
        file.second_order.scale(self.scale);
        let k = 1.0 / (self.scale * self.scale);
        let scaled = |m: &Metric3| Metric3 {
            xx: m.xx * k,
            xy: m.xy * k,
            xz: m.xz * k,
            yy: m.yy * k,
            yz: m.yz * k,
            zz: m.zz * k,
        };
        if let Some(metric) = &mut file.metric {
            metric.iter_mut().for_each(|m| *m = scaled(m));
        }
    }
}

/// Reads the keys that belong to `mesh`.
pub(super) fn taking(table: &Table<'_>) -> Result<Taking, Fault> {
    let mut taking = Taking::default();
    if let Some(value) = table.get("use") {
        let wrong = || value.wrong("a use of a mesh", "use = \"triangles\" or use = \"shape\"");
        taking.used = Some(MeshUse::named(value.text()?).ok_or_else(wrong)?);
    }
    let between = |key: &str, default: f64, [least, most]: [f64; 2], what: &str, unit: &str| match table.get(key) {
        None => Ok(default),
        Some(value) => match value.number()? {
            number if (least..=most).contains(&number) => Ok(number),
            _ => {
                let most = if most < 1e6 { format!("{most}") } else { format!("{most:e}") };
                let least = if least > 1e-6 { format!("{least}") } else { format!("{least:e}") };
                Err(value.wrong(&format!("{what} from {least} to {most}{unit}"), &format!("{key} = {default}")))
            }
        },
    };
    let degrees = between("feature_angle", ANGLE.to_degrees(), Taking::ANGLES, "an angle", " degrees")?;
    taking.feature_angle = degrees.to_radians();
    taking.chart_stretch = between("chart_stretch", taking.chart_stretch, Taking::STRETCHES, "a stretch", "")?;
    taking.scale = between("scale", 1.0, Taking::SCALES, "a factor", "")?;
    Ok(taking)
}

/// Reads the groups that are ignored: all or none, or a list of names.
pub(super) fn ignored(value: &Value<'_>) -> Result<Ignored, Fault> {
    match value.flag() {
        Ok(true) => Ok(Ignored::All),
        Ok(false) => Ok(Ignored::Nothing),
        Err(_) => {
            let wrong = |_| value.wrong("true, false or a list of names", "ignore_groups = [\"load\"]");
            value.texts().map(Ignored::Named).map_err(wrong)
        }
    }
}
