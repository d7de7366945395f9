//! The keys of commands.

use eframe::egui::{Key, Modifiers};

use super::{Command, PairCommand, PresentationCommand, StudyCommand};
use crate::app::window::presentation::Chrome;
use crate::app::window::session::{Direction, Goal};
use crate::app::window::view_layer::ViewLayer;
use crate::core::kernel::worded::worded;
use crate::render::camera::Bearing;

worded! {
    /// What keys are for, in the order of the list of keys.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Purpose by name {
        Steps = "Steps",
        Views = "Views",
        Layers = "Layers",
        Files = "Files and changes",
        Lessons = "Lessons",
        Presentation = "Presentations",
        Window = "Window",
    }
}

impl Purpose {
    fn of(command: &Command) -> Purpose {
        match command {
            Command::Go(_)
            | Command::GoTo
            | Command::ToBreakpoint(_)
            | Command::Play
            | Command::Bookmark
            | Command::NoteHere
            | Command::ToLargestLoss
            | Command::FindField
            | Command::FindWorst
            | Command::Pair(_) => Purpose::Steps,
            Command::Layer(_) => Purpose::Layers,
            Command::Study(_) => Purpose::Lessons,
            Command::Fit
            | Command::ShowDecision
            | Command::ToggleFollow
            | Command::TogglePlane
            | Command::ToggleSplit
            | Command::LookFrom(_)
            | Command::HiddenLines
            | Command::ToggleCurved => Purpose::Views,
            Command::OpenPath
            | Command::Reopen
            | Command::CopyLink
            | Command::SavePage
            | Command::SaveRun
            | Command::SaveMesh
            | Command::Export
            | Command::Figures
            | Command::Undo
            | Command::Redo => Purpose::Files,
            Command::Presentation(_) => Purpose::Presentation,
            _ => Purpose::Window,
        }
    }
}

/// The keys by what they are for, each command once with all its keys: plain keys first, then those with Ctrl, Shift
/// and Alt.
pub fn groups() -> Vec<(Purpose, Vec<(String, Command)>)> {
    let mut all = keys_in(Chrome::Presentation);
    all.extend(STUDY);
    all.sort_by_key(|(held, ..)| (held.alt, held.shift, held.command));
    let mut groups = Purpose::ALL.map(|purpose| (purpose, Vec::new())).to_vec();
    for (held, key, command) in all {
        let text = text(held, key);
        let group: &mut Vec<(String, Command)> = &mut groups[Purpose::of(&command) as usize].1;
        match group.iter_mut().find(|known| known.1 == command) {
            Some(known) => known.0 += &format!(", {text}"),
            None => group.push((text, command)),
        }
    }
    groups[Purpose::Window as usize].1.push(("?".to_owned(), Command::Help));
    groups
}

/// A key with what is held, as text.
pub fn text(held: Modifiers, key: Key) -> String {
    let mut text = String::new();
    for (is_held, name) in [(held.command, "Ctrl+"), (held.alt, "Alt+"), (held.shift, "Shift+")] {
        if is_held {
            text += name;
        }
    }
    text + key_name(key)
}

const NONE: Modifiers = Modifiers::NONE;
const SHIFT: Modifiers = Modifiers::SHIFT;
const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

/// All keys and their commands. Those with more modifiers come first, since egui takes Ctrl+Shift+S for Ctrl+S.
pub fn keys() -> Vec<(Modifiers, Key, Command)> {
    let mut keys = vec![
        (CTRL_SHIFT, Key::Z, Command::Redo),
        (CTRL_SHIFT, Key::S, Command::Screenshot),
        (CTRL_SHIFT, Key::L, Command::ToggleTheme),
        (CTRL_SHIFT, Key::E, Command::Figures),
        (CTRL_SHIFT, Key::W, Command::FindWorst),
        (CTRL_SHIFT, Key::G, Command::ToLargestLoss),
        (CTRL_SHIFT, Key::B, Command::NoteHere),
        (SHIFT, Key::V, Command::ToggleSplit),
        (SHIFT, Key::D, Command::ToggleFollow),
        (CTRL, Key::ArrowRight, Command::Go(Goal::Steps(1))),
        (CTRL, Key::ArrowLeft, Command::Go(Goal::Steps(-1))),
        (SHIFT, Key::F5, Command::Presentation(PresentationCommand::Switch)),
        (SHIFT, Key::ArrowRight, Command::Go(Goal::Quads(10))),
        (SHIFT, Key::ArrowLeft, Command::Go(Goal::Quads(-10))),
        (Modifiers::ALT, Key::F5, Command::ToBreakpoint(Direction::Back)),
        (Modifiers::ALT, Key::F8, Command::Pair(PairCommand::SeekDifference(Direction::Back))),
        (CTRL, Key::G, Command::GoTo),
        (CTRL, Key::F, Command::FindField),
        (CTRL, Key::P, Command::Palette),
        (CTRL, Key::Z, Command::Undo),
        (CTRL, Key::Y, Command::Redo),
        (CTRL, Key::O, Command::OpenPath),
        (CTRL, Key::L, Command::CopyLink),
        (CTRL, Key::S, Command::SaveRun),
        (CTRL, Key::M, Command::SaveMesh),
        (CTRL, Key::E, Command::Export),
        (CTRL, Key::B, Command::Bookmark),
        (CTRL, Key::R, Command::Reopen),
        (CTRL, Key::K, Command::Pair(PairCommand::Fork)),
        (NONE, Key::ArrowRight, Command::Go(Goal::Quads(1))),
        (NONE, Key::ArrowLeft, Command::Go(Goal::Quads(-1))),
        (NONE, Key::PageDown, Command::Go(Goal::Quads(1))),
        (NONE, Key::PageUp, Command::Go(Goal::Quads(-1))),
        (NONE, Key::F5, Command::ToBreakpoint(Direction::Forward)),
        (NONE, Key::F8, Command::Pair(PairCommand::SeekDifference(Direction::Forward))),
        (NONE, Key::Home, Command::Go(Goal::Step(0))),
        (NONE, Key::End, Command::Go(Goal::End)),
        (NONE, Key::Space, Command::Play),
        (NONE, Key::F, Command::Fit),
        (NONE, Key::D, Command::ShowDecision),
        (NONE, Key::V, Command::TogglePlane),
        (NONE, Key::I, Command::LookFrom(Bearing::Iso)),
        (NONE, Key::X, Command::LookFrom(Bearing::X)),
        (NONE, Key::Y, Command::LookFrom(Bearing::Y)),
        (NONE, Key::Z, Command::LookFrom(Bearing::Z)),
        (NONE, Key::H, Command::HiddenLines),
        (NONE, Key::C, Command::ToggleCurved),
        (NONE, Key::Escape, Command::Escape),
    ];
    let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];
    keys.extend(digits.into_iter().zip(ViewLayer::ALL).map(|(key, layer)| (NONE, key, Command::Layer(layer))));
    keys
}

/// The keys of a lesson, which stand for what they stand for elsewhere when none is open.
const STUDY: [(Modifiers, Key, Command); 3] = [
    (NONE, Key::Enter, Command::Study(StudyCommand::Continue)),
    (NONE, Key::H, Command::Study(StudyCommand::Hint)),
    (NONE, Key::E, Command::Study(StudyCommand::Explore)),
];

/// All keys while a lesson or a prediction is under way: `explores`, whether the whole window is shown; `by_operation`,
/// whether the arrows step by operation; `writes`, whether digits are an answer.
pub fn keys_of_study(explores: bool, by_operation: bool, writes: bool) -> Vec<(Modifiers, Key, Command)> {
    let mut own = STUDY.to_vec();
    if explores {
        own.retain(|key| key.2 == Command::Study(StudyCommand::Explore));
    } else if by_operation {
        own.push((NONE, Key::ArrowRight, Command::Go(Goal::Steps(1))));
        own.push((NONE, Key::ArrowLeft, Command::Go(Goal::Steps(-1))));
    }
    let mut keys = keys();
    keys.retain(|key| !own.iter().any(|other| (other.0, other.1) == (key.0, key.1)));
    keys.retain(|key| !(writes && matches!(key.2, Command::Layer(_))));
    keys.extend(own);
    keys
}

/// Keys that mean something else in presentations, or nothing outside of them: those of clickers, which begin and end
/// with F5.
fn presentation_keys() -> Vec<(Modifiers, Key, Command)> {
    [
        (Key::F5, PresentationCommand::Switch),
        (Key::S, PresentationCommand::Spotlight),
        (Key::B, PresentationCommand::Black),
        (Key::Period, PresentationCommand::Black),
    ]
    .map(|(key, command)| (NONE, key, Command::Presentation(command)))
    .to_vec()
}

/// All keys and their commands where so much is around the views, in the order of [`keys`].
pub fn keys_in(chrome: Chrome) -> Vec<(Modifiers, Key, Command)> {
    let mut all = keys();
    if chrome == Chrome::Presentation {
        let bare = all.iter().position(|(held, ..)| held.is_none()).unwrap_or(all.len());
        all.splice(bare..bare, presentation_keys());
    }
    all
}

fn key_name(key: Key) -> &'static str {
    match key {
        Key::ArrowRight => "Right",
        Key::ArrowLeft => "Left",
        Key::Escape => "Esc",
        other => other.name(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_with_more_modifiers_come_first_and_none_is_used_twice() {
        let keys = keys();
        let held = |m: &Modifiers| [m.command, m.alt, m.shift].iter().filter(|held| **held).count();
        assert!(keys.is_sorted_by(|a, b| held(&a.0) >= held(&b.0)));
        for (i, a) in keys.iter().enumerate() {
            assert!(keys[..i].iter().all(|b| (b.0, b.1) != (a.0, a.1)), "{:?}", a.2);
        }
    }

    #[test]
    fn the_list_of_keys_has_every_command_once() {
        let listed: Vec<Command> = groups().into_iter().flat_map(|group| group.1).map(|entry| entry.1).collect();
        for (k, command) in listed.iter().enumerate() {
            assert!(!listed[..k].contains(command), "{command:?}");
        }
        assert!(keys().iter().all(|key| listed.contains(&key.2)));
        let files = &groups()[Purpose::Files as usize].1;
        assert!(files.contains(&("Ctrl+Y, Ctrl+Shift+Z".to_owned(), Command::Redo)), "{files:?}");
    }
}
