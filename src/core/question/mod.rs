//! Questions about what a run does next: which can be asked at a state, the right answer, and the judgement of any
//! answer with its reason. The right answer is what the next step does, or what the state is; no file holds one.
//! Reasons are those of `run/explain`, so that the inspector, a lesson and a prediction say the same.
//!
//! | what | where |
//! |---|---|
//! | what is asked | [`Kind`] |
//! | a question at a state of a run | [`Asked`] |
//! | an answer, and how it is read from text | [`Answer`], [`Choice`] |
//! | right, partly right or wrong, and why | [`Judged`], [`Verdict`] |
//! | hints: labels first, then what they mean | [`Hint`] |
//! | the rules that answers are about | [`Rule`] |
//! | what was answered so far, by rule, as CSV | [`Score`] |
//! | questions drawn from a run by a seed | [`Series`], [`draw`] |
//! | the next question along a run | [`following`] |

mod rule;
mod choice;
mod kind;
mod answer;
mod judged;
mod selection;
mod side;
mod top;
mod around;
mod entity;
mod place;
mod asked;
mod series;
mod drawn;
mod score;

pub use answer::Answer;
pub(in crate::core) use around::swapped;
pub use asked::Asked;
pub use choice::Choice;
pub use drawn::{Drawn, draw, following};
pub use judged::{Hint, Judged, Verdict};
pub use kind::Kind;
pub use rule::Rule;
pub use score::{Given, Score, Tally};
pub use series::Series;
