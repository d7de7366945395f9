//! Presentations: beginning and ending one, and what its keys do.

use super::State;
use crate::app::window::command::Command;
use crate::app::window::presentation::{Chrome, PresentationCommand};

impl State {
    /// Does something with a presentation.
    pub(super) fn apply_to_presentation(&mut self, command: PresentationCommand) {
        match command {
            PresentationCommand::Switch if self.view.chrome == Chrome::Presentation => self.end_presentation(),
            PresentationCommand::Switch => {
                self.view.chrome = Chrome::Presentation;
                self.notice("Esc ends the presentation.".to_owned());
            }
            PresentationCommand::Spotlight => {
                let form = &mut self.workspace.presentation;
                form.spotlight = !form.spotlight;
                let told = if form.spotlight { "is on" } else { "is off; S turns it on again" };
                self.notice(format!("The spotlight of presentations {told}."));
            }
            PresentationCommand::Black if self.view.chrome == Chrome::Presentation => {
                self.view.is_black = !self.view.is_black;
            }
            PresentationCommand::Black => self.notice("The screen is black in presentations alone.".to_owned()),
        }
    }

    pub(super) fn end_presentation(&mut self) {
        (self.view.chrome, self.view.is_black) = (Chrome::Panels, false);
        self.view.notice = None;
    }

    /// Lets the camera go where the decision is, or stay: in presentations, or in the window.
    pub(super) fn toggle_follow(&mut self) {
        let follows = match self.view.chrome {
            Chrome::Panels => &mut self.workspace.follows,
            Chrome::Presentation => &mut self.workspace.presentation.follows,
        };
        *follows = !*follows;
        let told = if *follows { "follows the decisions" } else { "stays where it is" };
        self.notice(format!("The camera {told}."));
    }

    /// What is asked for shows the mesh again where the screen is black.
    pub(super) fn lift_black(&mut self, command: &Command) {
        let goes = matches!(command, Command::Go(_) | Command::GoToText(_) | Command::ToBreakpoint(_) | Command::Play);
        let leads = matches!(command, Command::Palette | Command::Help | Command::GoTo | Command::FindField);
        self.view.is_black &= !(goes || leads);
    }
}
