//! What is seen: cameras, what is open over the window, messages, and requests to the views and panels.

use std::time::Duration;

use glam::DVec2;
use web_time::Instant;

use super::log::MessageLog;
use crate::app::window::layout::Pane;
use crate::app::window::presentation::Chrome;
use crate::core::mesh::ElementId;
use crate::core::run::run;
use crate::render::camera::{Bearing, Camera};
use crate::render::scene::Outlined;

/// How long a notice is shown.
const NOTICE: Duration = Duration::from_secs(6);

/// What is seen, beside what the user has set up.
#[derive(Default)]
pub struct ViewState {
    /// The view of the plane.
    pub plane: ViewCamera,
    /// The view of space.
    pub space: ViewCamera,
    /// Where the main view is to look.
    pub look: Request<Look>,
    /// The row that the table of the front is to scroll to.
    pub scroll: Request<Option<Outlined>>,
    /// The quadrilateral whose decision chain the inspector is to show.
    pub chain: Request<Option<ElementId>>,
    /// The docks are to be arranged as the document says.
    pub relayout: Request<()>,
    /// The bookmarked step whose note is to be written.
    pub note: Request<u64>,
    /// The panel that is to be shown in its tabs.
    pub reveal: Request<Option<Pane>>,
    /// What a bar of a plot stands for, lit up in the views until the next state comes.
    pub lit: Vec<Outlined>,
    /// Changes when the mesh is to be drawn in another way.
    pub style_epoch: u64,
    /// Changes when something that is drawn over the mesh changes.
    pub over_epoch: u64,
    pub overlay: Overlay,
    /// What is around the views.
    pub chrome: Chrome,
    /// Whether a presentation shows nothing.
    pub is_black: bool,
    /// Whether the notes on the case are shown.
    pub notes: bool,
    /// Whether the panel for figures is shown.
    pub figure_panel: bool,
    /// Whether the log of messages is shown.
    pub messages: bool,
    /// Whether the status line tells how long states and frames take.
    pub times: bool,
    pub log: MessageLog,
    /// What went wrong; each message stays until it is closed.
    pub faults: Vec<String>,
    /// What was done last, and when.
    pub(super) notice: Option<(String, Instant)>,
}

impl ViewState {
    /// The notice that is shown, and for how much longer.
    pub fn notice(&self) -> Option<(&str, Duration)> {
        let (text, since) = self.notice.as_ref()?;
        Some((text, NOTICE.checked_sub(since.elapsed())?))
    }
}

/// Where a view looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewCamera {
    /// None until the mesh is fitted to the view.
    pub camera: Option<Camera>,
    /// Whether the view shows the whole mesh, and goes on doing so when its size changes.
    pub is_fitted: bool,
    /// The size of the view in points.
    pub size: DVec2,
}

impl Default for ViewCamera {
    fn default() -> Self {
        ViewCamera { camera: None, is_fitted: true, size: DVec2::ZERO }
    }
}

/// The views that have a camera to be moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewKind {
    Plane,
    Space,
    /// That of a mesh that is about to be converted.
    Import,
}

/// Where the main view is to look next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Look {
    /// At the whole mesh.
    #[default]
    Fit,
    /// As a run says.
    Kept(run::Camera),
    /// At the decision, from near.
    Decision,
    At(Outlined),
    /// At something, from near unless it is seen well already.
    Near(Outlined),
    /// At the whole mesh in space, from a side.
    From(Bearing),
}

/// What is open over the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    #[default]
    Nothing,
    Palette,
    Help,
    GoTo,
    Find,
    Path,
    /// The path of a second run.
    PathBeside,
    Mesh,
    Sweep,
}

/// A request that stands until whoever it is for has taken it, which may be shown only later. Requests are numbered,
/// and the receiver keeps the number of the last one it took.
#[derive(Clone, Copy, Debug, Default)]
pub struct Request<T> {
    number: u64,
    what: T,
}

impl<T: Copy> Request<T> {
    pub(super) fn ask(&mut self, what: T) {
        *self = Request { number: self.number + 1, what };
    }

    /// The request, unless the receiver has taken it before.
    pub fn take(&self, last: &mut u64) -> Option<T> {
        (std::mem::replace(last, self.number) != self.number).then_some(self.what)
    }
}

/// What the panels of one frame ask of the next: it begins anew with every frame.
#[derive(Debug, Default)]
pub struct FrameState {
    /// What the pointer is on, in a view or in a panel.
    pub hovered: Option<Outlined>,
    /// What the words under the pointer mean.
    pub pointed: Vec<Outlined>,
    /// Switch between dark and light.
    pub toggle_theme: bool,
    /// Save a picture of the window.
    pub screenshot: bool,
    /// Copy this to the clipboard.
    pub copied: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_is_taken_once() {
        let (mut request, mut last) = (Request::default(), 0);
        assert_eq!(request.take(&mut last), None);
        request.ask(Look::Decision);
        request.ask(Look::Fit);
        assert_eq!([request.take(&mut last), request.take(&mut last)], [Some(Look::Fit), None]);
    }
}
