//! Plots of a run that are not of its mesh: the run over time, and what a step decided. Their numbers are those of the
//! window's timeline and inspector.

use super::{Figure, FigureOptions, Plot, Wanted, carried, described};
use crate::app::work::{FigureFrame, Walked};
use crate::core::convert::{Event, EventKind};
use crate::core::fault::Fault;
use crate::core::kernel::number::grouped;
use crate::core::progress::Watch;
use crate::core::run::explain::{self, beginning, narration, plain, side_margins};
use crate::core::run::history::BUDGET;
use crate::core::run::timeline::{Timeline, Tracked};
use crate::core::run::{History, Run};
use crate::render::picture::Picture;
use crate::render::vector::decision::{self, Decision};
use crate::render::vector::timeline::{self, OverTime};

/// Steps that are recorded between two looks at whether to stop.
const STRETCH: u64 = 4096;
/// Segments of the front that a table lists.
const LISTED: usize = 12;

/// Draws one of these plots at a stop; with `embeds` it contains the run.
///
/// # Errors
/// As the conversion; it ends before the stop.
pub(super) fn make(
    run: &Run,
    wanted: Wanted,
    plot: Plot,
    options: &FigureOptions,
    embeds: bool,
    watch: &mut dyn Watch,
) -> Result<(Figure, FigureFrame), Fault> {
    let background = run.background(watch)?;
    let look = options.look(false);
    let frame = {
        let mut converter = run.start(&background)?;
        let mut walked = Walked::new(run, &mut converter, &look);
        walked.to(wanted.stop, watch, &mut |_, _| Ok(()))?;
        FigureFrame { picture: Picture::default(), ..walked.frame(wanted.at) }
    };
    let step = frame.shown.step;
    let mut history = History::of(run.clone(), &background, BUDGET)?;
    let description = described(run, Some(&frame));
    let run_text = carried(run, &[frame.shown], options, embeds)?;
    let is_timeline = plot == Plot::Timeline;
    // The run over time is as wide as a page.
    let sheet = options.sheet(is_timeline, &run.case.title, &description, run_text.as_deref());
    let page = if is_timeline {
        let track = track(&mut history, watch)?;
        let timeline = Timeline::of(&track, history.log().samples());
        timeline::draw(OverTime { track: &track, timeline: &timeline, now: step }, &sheet)
    } else {
        decision::draw(&decided(&mut history, step)?, &sheet)
    };
    Ok((Figure { page, dots: options.dots() }, frame))
}

/// The record of each step of a run. It is taken as the run goes on: old events are dropped.
fn track(history: &mut History, watch: &mut dyn Watch) -> Result<Vec<Tracked>, Fault> {
    let mut track = Vec::new();
    loop {
        watch.cancel().check()?;
        let log = history.log();
        track.extend((track.len() as u64 + 1..=log.known()).filter_map(|step| Tracked::of(log, step)));
        match (history.end(), history.stuck()) {
            (_, Some(fault)) => return Err(fault.clone()),
            (Some(_), _) => return Ok(track),
            (None, None) => history.extend(track.len() as u64 + STRETCH),
        }
    }
}

/// What a step decided.
fn decided(history: &mut History, step: u64) -> Result<Decision, Fault> {
    history.seek(step.saturating_sub(1))?;
    let before = history.state().looks_at();
    history.seek(step)?;
    let case = history.run().case.name.clone();
    let heading = format!("{case}: step {}, NQ {}", grouped(step), grouped(history.state().standing()));
    let Some(event) = history.event(step)? else {
        let sentences = vec![plain(&beginning(&history.state().mesh))];
        return Ok(Decision { heading, sentences, table: None });
    };
    let selection = history.log().last_of(step, |kind| kind == EventKind::BaseSelected);
    let selected = selection.map_or(Ok(None), |step| history.event(step))?;
    let base = match selected {
        Some(Event::BaseSelected { a, b, .. }) => Some([a, b]),
        _ => None,
    };
    let mut sentences = vec![narration(&event, base)];
    sentences.extend(explain::about(&event, &before, history.state()));
    let mut table = None;
    match (event, &before.candidates, &before.base) {
        (Event::BaseSelected { a, b, .. }, ..) => {
            let selecting = history.selecting()?;
            // That may have gone back.
            history.seek(step)?;
            sentences.extend(selecting.explain(history.state(), a, b).into_iter().flat_map(|told| told.why));
            table = Some(explain::front(&selecting.table, [a, b], LISTED));
        }
        (_, Some(tried), Some(base)) if chooses_a_side(event.kind()) => {
            sentences.extend(side_margins(tried));
            table = Some(explain::candidates(tried, [base.a, base.b][tried.side.index()]));
        }
        _ => {}
    }
    Ok(Decision { heading, sentences: sentences.iter().map(|text| plain(text)).collect(), table })
}

/// Whether a step of this kind looks at candidates for a side edge.
fn chooses_a_side(kind: EventKind) -> bool {
    matches!(kind, EventKind::SideIsFront | EventKind::SideChosen | EventKind::SideSwapped | EventKind::RolledBack)
}
