//! Presses of keys count in their order, however fast they come: what follows a press that moves the focus waits until
//! the focus is there, so that what is typed into a field that is being opened goes into it.

use eframe::egui::{Event, Key, Modifiers};

use super::command::{Command, keys};

/// The presses that wait for a later frame.
#[derive(Default)]
pub struct Presses {
    waiting: Vec<Event>,
    /// Whether the last frame had a press that moves the focus; this one shows where to.
    is_moving: bool,
}

impl Presses {
    /// Leaves in the events of a frame the presses up to the first one that moves the focus. `is_typing` says whether
    /// something has it, `is_awaited` whether a field is about to get it. Returns whether others wait.
    pub fn take(&mut self, events: &mut Vec<Event>, is_typing: bool, is_awaited: bool) -> bool {
        let (pressed, others): (Vec<Event>, _) = std::mem::take(events).into_iter().partition(is_press);
        self.waiting.extend(pressed);
        *events = others;
        let moved = self.waiting.iter().position(|event| moves_focus(event, is_typing));
        let now = match moved {
            _ if is_awaited || std::mem::take(&mut self.is_moving) => 0,
            Some(at) => at + 1,
            None => self.waiting.len(),
        };
        self.is_moving |= now > 0 && moved.is_some();
        events.extend(self.waiting.drain(..now));
        !self.waiting.is_empty()
    }
}

/// Takes the presses of `known` keys out of the events, and returns their commands in order. While one
/// types, keys without Ctrl or Alt stand for themselves, except Escape. A key that is held does not run ahead of what
/// is shown, so that nothing goes on when it is let go.
pub fn commands(
    events: &mut Vec<Event>,
    known: &[(Modifiers, Key, Command)],
    is_typing: bool,
    is_busy: bool,
) -> Vec<Command> {
    let (mut commands, mut repeated) = (Vec::new(), Vec::new());
    events.retain(|event| {
        let Event::Key { key: pressed, modifiers: held, pressed: true, repeat, .. } = event else { return true };
        let is_this = |known: &&(Modifiers, Key, Command)| known.1 == *pressed && held.matches_logically(known.0);
        let Some((modifiers, _, command)) = known.iter().find(is_this) else { return true };
        let is_bare = modifiers.is_none() || *modifiers == Modifiers::SHIFT;
        if is_bare && is_typing && *command != Command::Escape {
            return true;
        }
        let counts = !repeat || command.repeats() && !is_busy && !repeated.contains(command);
        if *repeat {
            repeated.push(command.clone());
        }
        commands.extend(counts.then(|| command.clone()));
        false
    });
    commands
}

fn is_press(event: &Event) -> bool {
    matches!(event, Event::Key { .. } | Event::Text(_) | Event::Ime(_) | Event::Copy | Event::Cut | Event::Paste(_))
}

/// Whether a press opens a field, or leaves the one that has the focus.
fn moves_focus(event: &Event, is_typing: bool) -> bool {
    let Event::Key { key, modifiers, pressed: true, .. } = event else { return false };
    let leaves = is_typing && matches!(key, Key::Enter | Key::Escape);
    leaves || command_of(*modifiers, *key).is_some_and(|command| command.opens_a_field())
}

fn command_of(held: Modifiers, pressed: Key) -> Option<Command> {
    keys().into_iter().find(|(modifiers, key, _)| *key == pressed && held.matches_logically(*modifiers)).map(|k| k.2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::window::command::keys_in;
    use crate::app::window::presentation::Chrome;
    use crate::app::window::presentation::PresentationCommand;
    use crate::app::window::session::{Direction, Goal};

    fn press(key: Key, modifiers: Modifiers) -> Event {
        Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers }
    }

    fn text(text: &str) -> Event {
        Event::Text(text.to_owned())
    }

    #[test]
    fn what_is_typed_behind_a_key_that_opens_a_field_waits_until_the_field_is_there() {
        let mut presses = Presses::default();
        let open = press(Key::P, Modifiers::COMMAND);
        let (enter, right) = (press(Key::Enter, Modifiers::NONE), press(Key::ArrowRight, Modifiers::NONE));
        let moved = Event::PointerGone;
        let mut events = vec![right.clone(), open.clone(), text("end"), enter.clone(), moved.clone(), right.clone()];
        let mut frame = |events: &mut Vec<Event>, is_typing| presses.take(events, is_typing, false);
        assert!(frame(&mut events, false));
        assert_eq!(events, [moved, right.clone(), open]);
        // The field appears.
        events.clear();
        assert!(frame(&mut events, false) && events.is_empty());
        assert!(frame(&mut events, true));
        assert_eq!(events, [text("end"), enter]);
        events.clear();
        assert!(frame(&mut events, false) && events.is_empty());
        assert!(!frame(&mut events, false));
        assert_eq!(events, [right]);
    }

    #[test]
    fn keys_are_commands_in_the_order_in_which_they_are_pressed() {
        let (right, end) = (press(Key::ArrowRight, Modifiers::NONE), press(Key::End, Modifiers::NONE));
        let worst = press(Key::W, Modifiers::COMMAND | Modifiers::SHIFT);
        let held = Event::Key {
            key: Key::ArrowRight,
            physical_key: None,
            pressed: true,
            repeat: true,
            modifiers: Modifiers::NONE,
        };
        let [go, to_end] = [Goal::Quads(1), Goal::End].map(Command::Go);
        let mut events = vec![end.clone(), worst.clone(), right.clone(), right.clone(), text("x")];
        let found = commands(&mut events, &keys(), false, true);
        assert_eq!(found, [to_end, Command::FindWorst, go.clone(), go.clone()]);
        assert_eq!(events, [text("x")]);
        // What is typed stays.
        let mut events = vec![right.clone(), worst, press(Key::Escape, Modifiers::NONE)];
        assert_eq!(commands(&mut events, &keys(), true, false), [Command::FindWorst, Command::Escape]);
        assert_eq!(events, std::slice::from_ref(&right));
        // A key that is held counts once a frame, and not while a state is awaited.
        let mut events = vec![right, held.clone(), held.clone()];
        assert_eq!(commands(&mut events.clone(), &keys(), false, false), [go.clone(), go.clone()]);
        assert_eq!(commands(&mut events, &keys(), false, true), [go]);
    }

    #[test]
    fn keys_of_clickers_are_commands_in_presentations_alone() {
        let (none, b, page) = (Modifiers::NONE, Key::B, Key::PageDown);
        let [switch, _, black] = PresentationCommand::ALL.map(Command::Presentation);
        let next = Command::Go(Goal::Quads(1));
        let f5 = [press(Key::F5, none), press(Key::F5, Modifiers::SHIFT), press(Key::F5, Modifiers::ALT)];
        let pressed = [&f5[..], &[press(b, none), press(Key::Period, none), press(page, none)]].concat();
        let back = Command::ToBreakpoint(Direction::Back);
        let outside = [Command::ToBreakpoint(Direction::Forward), switch.clone(), back.clone(), next.clone()];
        assert_eq!(commands(&mut pressed.clone(), &keys_in(Chrome::Panels), false, false), outside);
        let inside = [switch.clone(), switch, back, black.clone(), black, next];
        assert_eq!(commands(&mut pressed.clone(), &keys_in(Chrome::Presentation), false, false), inside);
    }

    #[test]
    fn presses_wait_for_a_field_that_is_about_to_have_the_focus_and_else_for_nothing() {
        let mut presses = Presses::default();
        let enter = press(Key::Enter, Modifiers::NONE);
        let mut events = vec![text("a")];
        assert!(presses.take(&mut events, false, true) && events.is_empty());
        assert!(!presses.take(&mut events, true, false));
        assert_eq!(events, [text("a")]);
        // Enter that leaves no field.
        let mut events = vec![enter.clone(), text("b")];
        assert!(!presses.take(&mut events, false, false));
        assert_eq!(events, [enter, text("b")]);
    }
}
