//! What a link says of its run: the run is open, and gets where the link leads.

use std::sync::Arc;

use super::State;
use crate::app::lesson;
use crate::app::window::session::{Goal, Moment};
use crate::app::window::state::{SurfaceView, outlined};
use crate::app::window::study::{Study, Subject};
use crate::app::window::words;
use crate::core::convert::Phase;
use crate::core::fault::Fault;
use crate::core::record::link::{LessonPlace, Link};

impl State {
    /// The run of a link is open: goes where the link leads, with its lesson.
    pub(super) fn begin_by_link(&mut self, link: Link) {
        let leads_to_part = link.origin.is_none() && (link.step, &link.selected, link.view) == (None, &None, None);
        if let Some(LessonPlace { name, part }) = &link.lesson {
            match lesson::found(name) {
                Ok(lesson) => {
                    let (lesson, source) = (Arc::new(lesson), name.clone());
                    let mut study = Study::of(Subject::Lesson { lesson, source, part: *part });
                    // It waits behind the state that the link names.
                    study.explores = !leads_to_part;
                    self.study = Some(study);
                }
                Err(fault) => self.complain(&fault),
            }
            if leads_to_part {
                return self.teach(*part);
            }
        }
        let is_on_surfaces =
            self.run.opened.as_ref().is_some_and(|opened| opened.background.mesh.embedding().is_some());
        if is_on_surfaces && link.view.is_some_and(|view| view.is_of_the_plane()) {
            self.workspace.surfaces.view = SurfaceView::Plane;
        }
        if let Some(step) = link.step {
            self.go(Goal::Step(step));
        }
        self.run.linked = Some(link);
    }

    /// Selects what a link names in the state that it leads to, and says so where either is not there.
    pub(super) fn arrive_by_link(&mut self, moment: &Moment) {
        if self.run.waiting > 0 {
            return;
        }
        let Some(Link { step, selected, .. }) = self.run.linked.take() else { return };
        if let Some(step) = step.filter(|step| *step > moment.step && moment.phase == Phase::Done) {
            let [end, step] = [moment.step, step].map(words::grouped);
            self.complain(&Fault::new(format!("The run ends at step {end}, before step {step}, which the link names")));
        }
        match selected.map(|selected| selected.find(&moment.mesh)) {
            Some(Ok(found)) => {
                if let Some(before) = self.workspace.come_upon(outlined(found)) {
                    self.follow(&before);
                }
            }
            Some(Err(why)) => {
                let why = why.trim_end_matches('.');
                self.complain(&Fault::new(format!("What the link selects is not there: {why}")));
            }
            None => {}
        }
    }
}
