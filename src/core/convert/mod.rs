//! From triangles to quadrilaterals: the merging front (paper 4.3), the guarantee (docs/algorithm.md, "The guarantee"),
//! and the post-processing of the whole mesh (docs/algorithm.md, "Post-processing").
//!
//! How a base segment becomes a finished quadrilateral: `select` chooses it (4.3.3); `side` prepares its left side,
//! then its right one, and `top` the edge between their tops (4.3.4); `form` merges the triangles between the four, and
//! where that fails everything is taken back and `form::attempts` finds another way, or the segment is deferred. Around
//! the new quadrilateral `local` swaps, removes and smooths, `seam` closes small angles and `split` narrow regions
//! (4.3.6). `close` converts what the front leaves over: small loops, then the rest by the `last_resort`. `finish`
//! cleans up and smooths the whole (4.3.7).
//!
//! Each step works on a `Front` and returns the next [`Phase`] and an [`Event`]; the `converter` drives them, with one
//! match arm per phase.

mod sums;
mod event;
mod phase;
mod front;
mod relax;
mod wall;
mod select;
mod side;
mod top;
mod form;
mod local;
mod seam;
mod split;
mod close;
mod last_resort;
mod finish;
mod converter;
mod mirror_line;
mod noisy_surface;
pub mod walk;
pub mod conversion;

pub use candidates::{Candidate, Candidates, Passed, SideRule};
pub(in crate::core) use close::{MOST_SEGMENTS, MOST_TRIANGLES};
pub use conversion::Converted;
pub use converter::{Converter, Counts, LookedAt};
pub use event::{Cleaning, Event, EventKind, FewNodes, Mending, Purpose, SeamCorner, SideEdge, Unmerged, Why, WhyKind};
pub use finish::Finished;
pub use finish::clean_up::CleanedUp;
pub use finish::unfold::Unfolded;
pub use form::{Aim, Stays};
pub use front::Gates;
pub use last_resort::component::Component;
pub use last_resort::{Means, Outcome, Plan, Stuck};
pub use mirror_line::background;
pub use phase::{Attempt, Base, FinishPart, Phase};
pub(in crate::core) use seam::{AROUND, MOST_UNLIKE, SHORT};
pub(in crate::core) use split::LEAST_PART;
pub use split::{Narrow, NotSlender, OnFront, SideToCollapse, Slender};
pub(in crate::core) use top::{MOST_CROSSINGS, MOST_SWAPS};
pub use walk::{StepReport, Stop, Tell};

pub use side::candidates;
