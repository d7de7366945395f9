//! CAD files: faces on exact surfaces, with the curves that they share, from the boundary representations of STEP (ISO
//! 10303-21; AP203, AP214, AP242). What is read becomes the text of a case, so that a run, a link or an editor has all
//! of it.
//!
//! [`read`] does it in this order: the text (`exchange`, `fields`), the bodies and where they are (`products`), their
//! faces and edges (`topology`, `curves`, `surfaces`), edges that coincide (`sewing`), colours and names (`groups`),
//! and the case (`written`). Deliberately absent: tessellations, wires, dimensions and tolerances of products, offset
//! surfaces.

mod curves;
mod exchange;
mod fields;
mod groups;
mod part;
mod placement;
mod products;
mod sewing;
mod spline;
mod surfaces;
mod text;
mod topology;
mod units;
mod written;

pub use part::{EXTENSIONS, Part, StepOptions, Unit, is_step, read};

/// The remedy for a file that contradicts itself.
const DAMAGED: &str = "The file seems to be damaged: export it again";
/// The remedy for what is not supported.
const SKIP: &str = "Export it as a B-spline, or leave out its faces with --skip-bad-faces";
