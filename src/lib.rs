//! Anisotropic quadrilateral meshes by the merging front of Lee & Lee (2002).
//!
//! quadfront turns triangles into quadrilaterals whose sizes and directions follow a metric. It starts from curves in
//! the plane, from faces on curved surfaces, or from a triangle mesh in the plane or in space, and every valid input
//! becomes a valid mesh: quadrilaterals only, conforming, each strictly convex in the parametric plane. A conversion
//! can be run whole or one operation at a time, and any of its states can be drawn.
//!
//! The same case and parameters give the same bytes on every machine.
//!
//! # Where to begin
//!
//! Convert a case and write the mesh:
//!
//! ```
//! use quadfront::{Export, Fault, Format, Nobody, WriteOptions, built_in, convert, write_mesh};
//!
//! fn main() -> Result<(), Fault> {
//!     let case = built_in::named("example1").expect("a built-in case")?;
//!     let converted = convert(&case, &mut Nobody)?;
//!     println!("{} quadrilaterals", converted.mesh.element_count());
//!
//!     let file = Export::of(&converted.mesh, &converted.names).file;
//!     let path = std::env::temp_dir().join("quadfront-example1.msh");
//!     write_mesh(&path, Format::Msh, &file, WriteOptions::default())
//! }
//! ```
//!
//! Convert a triangle mesh in memory: its shape is remeshed with sizes given at its points.
//!
//! ```
//! use quadfront::{Case, Export, Fault, MeshFile, MeshUse, Nobody, Taking, convert};
//!
//! fn main() -> Result<(), Fault> {
//!     let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.5], [0.0, 1.0, 0.5]];
//!     let mesh = MeshFile::in_space(points, [[0, 1, 2], [0, 2, 3]]).with_sizes([0.1, 0.3, 0.3, 0.1])?;
//!
//!     let shape = Taking { used: Some(MeshUse::Shape), ..Taking::default() };
//!     let case = Case::of_mesh_in_memory("ramp", mesh).with_taking(shape);
//!     let converted = convert(&case, &mut Nobody)?;
//!
//!     let quads = Export::of(&converted.mesh, &converted.names).file;
//!     println!("{} points, {} quadrilaterals", quads.points.len(), quads.quads.len());
//!     Ok(())
//! }
//! ```
//!
//! The folder `examples` has more: an STL file, single steps with their events, a figure of a state.
//!
//! | What you have or want | Begin with |
//! |---|---|
//! | a case in TOML (curves, surfaces, metric, parameters) | [`Case::read`], [`Case::parse`], [`built_in`] |
//! | a triangle mesh | [`read_mesh`], [`Case::of_mesh`], [`MeshFile::in_plane`], [`MeshFile::in_space`], [`Case::of_mesh_in_memory`] |
//! | sizes and directions | [`FieldSpec`] in [`Case::fields`], or [`MeshFile::with_sizes`], [`MeshFile::with_metric`] |
//! | quadrilaterals | [`convert`], then [`Export`] and [`write_mesh`] |
//! | progress, and a way to stop | [`Watch`], [`Cancel`] |
//! | single steps | [`background`], then [`Converter::step`], which returns an [`Event`] |
//! | any state, forward and backward | [`Run`], [`History`] |
//! | what a mesh is like | [`Report::of`], [`Statistics`] |
//! | a figure | [`render::picture::Picture`], [`render::vector`] |
//!
//! # Units and conventions
//!
//! Coordinates may be in any unit of length; sizes are in the same unit. A metric tensor is in 1 / length squared: an
//! edge `d` is of unit length where `d . M d = 1` (eqs. 2 and 3). Angles are in radians, except in statistics, reports
//! and explanations, which use degrees as files do. Elements run anticlockwise, in space as seen from outside. Indices
//! in a [`MeshFile`] count from 0.
//!
//! # Errors
//!
//! Bad input is an `Err` with a [`Fault`], which says what is wrong, where, and what to do about it. Match on
//! [`Fault::kind`] to tell faults apart. Nothing panics on bad input.
//!
//! ```
//! use quadfront::{Fault, FaultKind};
//!
//! fn hint(fault: &Fault) -> Option<&'static str> {
//!     match fault.kind() {
//!         FaultKind::Mesh => Some("repair the mesh"),
//!         FaultKind::Limit => Some("ask for larger elements"),
//!         // More kinds may be added.
//!         _ => None,
//!     }
//! }
//! ```
//!
//! # Modules
//!
//! The crate has three parts; the names at the root are re-exported from `core`:
//!
//! | Room | What it is |
//! |---|---|
//! | [`core`] | the converter and what it stands on: geometry, metric, meshes, formats, runs, reports |
//! | [`render`] | pictures of states, in the plane and in space, and SVG |
//! | `app` | the command line and the window (features `cli` and `window`); not for other programs |
//!
//! # Features
//!
//! A library needs none: write `default-features = false`. `cli` adds the command line, `window` the window and figures
//! as pixels. Both are on by default, for the program.
#![cfg_attr(test, allow(clippy::unwrap_used))]

pub mod core;
pub mod render;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod app;

pub use glam;

pub use crate::core::case::{Case, DomainSource, MeshSource, MeshUse, Parameters, Taking, built_in};
pub use crate::core::convert::conversion::convert;
pub use crate::core::convert::{Converted, Converter, Counts, Event, EventKind, Phase, background};
pub use crate::core::fault::{Fault, FaultKind};
pub use crate::core::formats::format::{
    read_bytes as read_mesh_bytes, read_mesh, write_mesh, write_to as write_mesh_to,
};
pub use crate::core::formats::{Format, WriteOptions};
pub use crate::core::kernel::{Metric2, Metric3};
pub use crate::core::mesh::{ElementId, HalfEdgeId, Mesh, Named, Names, NodeId};
pub use crate::core::metric::{FieldSpec, MetricSource, Sizing};
pub use crate::core::prepare::Background;
pub use crate::core::progress::{Cancel, Nobody, Stage, Watch};
pub use crate::core::record::run_file::{read as read_run, write as write_run};
pub use crate::core::record::{Export, Report, Statistics};
pub use crate::core::run::{Edit, EditKind, History, Run};
pub use crate::core::soup::{Group, MeshFile};
