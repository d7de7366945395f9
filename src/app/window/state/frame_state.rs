//! What holds for one frame.

use crate::render::scene::Outlined;

/// What the panels of one frame ask of the next: it begins anew with every frame.
#[derive(Debug, Default)]
pub struct FrameState {
    /// What the pointer is on, in a view or in a panel.
    pub hovered: Option<Outlined>,
    /// Switch between dark and light.
    pub toggle_theme: bool,
    /// Save a picture of the window.
    pub screenshot: bool,
}
