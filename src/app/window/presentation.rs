//! A presentation: the view for an audience, in large type and without panels.

use crate::core::kernel::worded::worded;

worded! {
    /// What is around the views. Further ways to show a run without its panels join here.
    #[derive(Default)]
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Chrome by name {
        /// Menus, panels, timeline.
        #[default]
        Panels = "panels",
        /// The sentence of the step, for an audience.
        Presentation = "presentation",
    }
}

worded! {
    /// What can be done with a presentation.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum PresentationCommand by name {
        /// Begin it, or end it.
        Switch = "Presentation",
        /// Dim all but the quadrilateral at hand, or nothing.
        Spotlight = "Spotlight of presentations",
        /// Show nothing, or the mesh again.
        Black = "Black screen in presentations",
    }
}

/// How presentations are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PresentationForm {
    /// Whether all but the quadrilateral at hand is dimmed.
    pub spotlight: bool,
    /// Whether the camera goes where the decision is.
    pub follows: bool,
}

impl Default for PresentationForm {
    fn default() -> Self {
        PresentationForm { spotlight: true, follows: true }
    }
}

/// How a view is for an audience.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Audience {
    /// How much larger labels are than in the window.
    pub type_scale: f32,
    /// Whether all but the quadrilateral at hand is dimmed.
    pub spotlight: bool,
    /// Whether the camera goes where the decision is.
    pub follows: bool,
}
