//! Finds things by number or coordinates, selects them and brings them into view.

use crate::app::window::session::{Ask, Goal};
use crate::app::window::state::{Look, Lookup, Missing, Overlay, State, outlined};
use crate::core::run::Sought;
use crate::render::scene::Outlined;

impl State {
    /// Goes where a text says: to a step, to a number of quadrilaterals, or to something in the current state. What is
    /// not there is said below the field.
    pub(super) fn go_to_text(&mut self, text: &str) {
        self.run.missing = None;
        let sought = match Sought::parse(text) {
            Ok(sought) => sought,
            Err(fault) => return self.complain(&fault),
        };
        let goal = match sought {
            Sought::Step(step) => Some(Goal::Step(step)),
            Sought::Quads(quads) => Some(Goal::ToQuads(quads)),
            _ => None,
        };
        if let Some(goal) = goal {
            self.view.overlay = Overlay::Nothing;
            return self.go(goal);
        }
        let Some(moment) = &self.run.moment else { return };
        match sought.find(&moment.mesh) {
            Ok(found) => {
                self.view.overlay = Overlay::Nothing;
                self.find(outlined(found));
            }
            Err(why) => {
                let (step, begins) = (moment.step, self.begins(&sought, moment.step));
                self.run.missing = Some(Missing { text: text.to_owned(), sought, step, why, ended: None, begins });
                if let Some(watched) = sought.named() {
                    self.inquire(Ask::Ended(watched));
                }
            }
        }
    }

    /// The next recorded step that makes something.
    fn begins(&self, sought: &Sought, step: u64) -> Option<u64> {
        let born = &self.run.born;
        match *sought {
            Sought::Quad(e) | Sought::Element(e) => {
                born.quads.iter().find(|made| made.0 > step && made.1 == e)?.0.into()
            }
            Sought::Node(n) => born.nodes.iter().find(|made| made.0 > step && made.1 == n)?.0.into(),
            _ => None,
        }
    }

    /// Goes to the step that made something, as far as one is recorded.
    pub(super) fn go_to_creation(&mut self, what: Outlined) {
        let Some(step) = self.run.moment.as_ref().map(|moment| moment.step) else { return };
        match what {
            Outlined::Element(e) => self.ask(Ask::Made(e)),
            Outlined::Node(n) => {
                let made = self.run.born.nodes.iter().rev().find(|born| born.0 <= step && born.1 == n);
                match made.map(|born| born.0) {
                    Some(step) => self.go(Goal::Step(step)),
                    None => self.notice("It exists from the beginning.".to_owned()),
                }
            }
            Outlined::Edge(_) => {}
        }
    }

    /// Selects something and brings it into view.
    pub(in crate::app::window::state) fn find(&mut self, what: Outlined) {
        self.change(|document| document.picked = Some(what));
        self.view.look.ask(Look::Near(what));
    }

    /// The same for the quadrilateral of the lowest quality.
    pub(super) fn find_worst(&mut self) {
        match self.run.moment.as_ref().and_then(|moment| moment.worst) {
            Some((e, _)) => self.find(Outlined::Element(e)),
            None => self.notice("There is no quadrilateral yet.".to_owned()),
        }
    }

    /// Goes to the step that cost the selected quadrilateral most quality, once its decision chain is known.
    pub(in crate::app::window::state) fn seek_largest_loss(&mut self) {
        let is_quad = |e| self.run.moment.as_ref().is_some_and(|m| m.mesh.has_element(e) && m.mesh.is_quad(e));
        let Some(Outlined::Element(element)) = self.document().picked.filter(|picked| match picked {
            Outlined::Element(e) => is_quad(*e),
            _ => false,
        }) else {
            let text = "Select a quadrilateral first: Ctrl+Shift+W selects the one of the lowest quality.";
            return self.notice(text.to_owned());
        };
        // While the run is played, the chain waits.
        self.run.playing = None;
        match self.run.chain(element) {
            Lookup::Known(told) => match told.chain.as_ref().map(|chain| chain.costliest().map(|k| &chain.links[k])) {
                Some(Some(link)) => self.go(Goal::Step(link.step)),
                Some(None) => self.notice("No step cost this quadrilateral quality.".to_owned()),
                None => self.notice("This quadrilateral is part of the background mesh.".to_owned()),
            },
            Lookup::Pending => self.run.to_loss = Some(element),
            Lookup::Unasked => {
                self.run.asked_chain = self.inquire(Ask::Chain(element)).map(|step| (step, element));
                self.run.to_loss = Some(element);
            }
        }
    }

    /// Goes to a step and finds something there.
    pub(super) fn find_at(&mut self, step: u64, what: Outlined) {
        self.view.overlay = Overlay::Nothing;
        self.run.find_at = Some((step, what));
        self.go(Goal::Step(step));
    }
}
