//! Links: opens what one names, and copies one that names the current state.

use super::State;
use super::opening::read;
use crate::app::command_line::Overrides;
use crate::app::window::session::Source;
use crate::app::window::state::Wanted;
use crate::app::window::study::{Study, Subject};
use crate::app::window::words;
use crate::core::fault::Fault;
use crate::core::record::link::{LessonPlace, Link, Origin};
use crate::core::run::Sought;
use crate::render::scene::Outlined;

impl State {
    /// Opens the state that a link names.
    pub(super) fn open_link(&mut self, text: &str) {
        let link = match Link::parse(text) {
            Ok(link) => link,
            Err(fault) => return self.complain(&fault),
        };
        let source = match (&link.origin, &link.lesson) {
            (_, Some(_)) if self.pair.is_some() => {
                return self.notice("A lesson needs the whole window: close the second run first.".to_owned());
            }
            (Some(Origin::Case(name)), _) => Source::BuiltIn(name.clone()),
            (Some(Origin::Run(text)), _) => Source::Linked(text.clone()),
            (None, Some(place)) => Source::Lesson(place.name.clone()),
            // No link that was read is one.
            (None, None) => return,
        };
        let overrides = Overrides { set: link.parameters.clone(), ..Overrides::default() };
        let (named, changed, view) = (source.clone(), overrides.clone(), link.view);
        self.open_read(source, overrides, move || {
            let mut run = read(&named, &changed)?;
            run.camera = view.or(run.camera);
            Ok(run)
        });
        self.wanted = Some(Wanted::Linked(Box::new(link)));
    }

    /// Copies a link that names the state that the panels show.
    pub(super) fn copy_link(&mut self) {
        match self.active().link().map(|link| link.and_then(|link| link.text())) {
            Some(Ok(text)) => {
                let long = words::counted(text.len() as u64, "character");
                self.frame.copied = Some(text);
                self.notice(format!(
                    "The link was copied ({long}): the page in a browser and quadfront open '#…' open this state."
                ));
            }
            Some(Err(fault)) => self.complain(&fault),
            None => self.notice("There is nothing to link to: open a case first.".to_owned()),
        }
    }

    /// A link that names the current state; none where nothing is open.
    pub(in crate::app::window) fn link(&self) -> Option<Result<Link, Fault>> {
        let (run, opened, moment) = (self.current_run()?, self.run.opened.as_ref()?, self.run.moment.as_ref()?);
        let lesson = self.study.as_ref().and_then(place_of);
        let is_of_lesson = matches!(
            (&self.run.source, &lesson), (Some(Source::Lesson(source)), Some(place)) if *source == place.name
        );
        let is_unchanged = (run.edits(), &run.bookmarks) == (opened.run.edits(), &opened.run.bookmarks);
        let link = match is_of_lesson && is_unchanged {
            true => Link::default(),
            false => match Link::of(&run) {
                Ok(link) => link,
                Err(fault) => return Some(Err(fault)),
            },
        };
        let selected = self.document().picked.map(|picked| match picked {
            Outlined::Node(node) => Sought::Node(node),
            // A segment of the front from A to B.
            Outlined::Edge(ends) => Sought::Edge(ends),
            Outlined::Element(element) => Sought::Element(element),
        });
        let selected = selected.filter(|selected| selected.find(&moment.mesh).is_ok());
        let is_told_here = self.shown_study().is_some_and(|study| study.is_about(moment.step));
        if link.origin.is_none() && is_told_here && selected.is_none() {
            // The lesson says where it stands, and what is seen there.
            return Some(Ok(Link { lesson, ..link }));
        }
        Some(Ok(Link { step: Some(moment.step), selected, lesson, ..link }.seen_by(self.moved_camera())))
    }
}

/// The place of a lesson of the tour.
fn place_of(study: &Study) -> Option<LessonPlace> {
    study.tour_place()?;
    match &study.subject {
        Subject::Lesson { source, part, .. } => Some(LessonPlace { name: source.clone(), part: *part }),
        Subject::Prediction { .. } => None,
    }
}
