//! Commands about the state that is shown wait while the session is on the way to another one.

use super::State;
use crate::app::window::command::Command;

impl State {
    /// Keeps a command that has to wait until the states that were asked for are there. Returns one that can be done
    /// now.
    pub(super) fn hold(&mut self, command: Command) -> Option<Command> {
        let is_about_the_state = command.is_about_the_state() && !matches!(command, Command::Pair(_));
        // What goes on from there must not overtake it.
        let goes = matches!(command, Command::Go(_) | Command::ToBreakpoint(_));
        let waits = match self.run.held.is_empty() {
            true => is_about_the_state && self.is_on_the_way(),
            false => is_about_the_state || goes,
        };
        if !waits {
            return Some(command);
        }
        self.run.held.push(command);
        None
    }

    /// Whether another state is on its way.
    fn is_on_the_way(&self) -> bool {
        self.run.is_busy() || self.run.to_loss.is_some()
    }

    /// Whether a note is to be written once the states that were asked for are there.
    pub(in crate::app::window) fn awaits_note(&self) -> bool {
        self.active().run.held.contains(&Command::NoteHere)
    }

    /// Does what has waited, once the session owes no answer.
    pub(in crate::app::window::state) fn release(&mut self) {
        if !self.is_on_the_way() {
            // What has to wait again is held again.
            std::mem::take(&mut self.run.held).into_iter().for_each(|command| self.apply_alone(command));
        }
    }
}
