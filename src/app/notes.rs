//! `notes`: the notes on the bookmarked steps of a run as one page: for each step its figure, what it did and why, the
//! attempts so far at the quadrilateral under way, and the note.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, html};

use super::command_line::NotesArguments;
use super::convert::describe;
use super::figure::{Figure, FigureOptions};
use super::input;
use super::output;
use super::progress::Progress;
use super::work::FigureFrame;
use crate::core::case::ImportOptions;
use crate::core::convert::{Candidate, Candidates, Event as Did, EventKind, Stop};
use crate::core::fault::Fault;
use crate::core::kernel::number::{counted, grouped};
use crate::core::progress::{Stage, Watch};
use crate::core::run::explain::{
    about, attempt as words, beginning, capital, edge, event as did, passed, plain, why_rolled_back,
};
use crate::core::run::shown::fingerprint;
use crate::core::run::{Bookmark, Changes, History, Run, ShownState, Tried};
use crate::render::picture::Seen;

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:46rem;margin:2rem auto;padding:0 1rem;\
color:#1b1f23;background:#fff}h1{font-size:1.6rem;line-height:1.25;margin-bottom:.3rem}h2{font-size:1.15rem;\
margin:2.4rem 0 .2rem}.about,.did,.why{color:#57606a;margin:.1rem 0 .6rem}figure{margin:.6rem 0}\
figure img{max-width:100%;height:auto;border:1px solid #d0d7de}code,pre{font-family:ui-monospace,monospace;\
font-size:.92em}pre{overflow-x:auto;background:#f6f8fa;padding:.6rem}table{border-collapse:collapse}\
td,th{border:1px solid #d0d7de;padding:.2rem .5rem}nav a{margin-right:.8rem}";

/// Writes the page.
pub(super) fn notes(arguments: &NotesArguments) -> Result<(), Fault> {
    let NotesArguments { source, figure, out } = arguments;
    output::check(&[Some(out)], None)?;
    let mut progress = Progress::new(source.quiet);
    progress.tell(Stage::Read, 0, 0);
    let input = input::read(source, &ImportOptions::default())?;
    let options = figure.or(None)?;
    let page = page(&input.run, &options, input.can_be_embedded(), &mut progress)
        .map_err(|fault| if fault.place.is_empty() { fault.at(source.input.clone()) } else { fault })?;
    progress.finish();
    out.write(|file| file.write_all(page.as_bytes()))
}

/// The page of a run, as HTML that needs no other file. With `embeds` each figure contains the run.
///
/// # Errors
/// A run without bookmarks, a conversion that cannot continue, cancellation.
pub(super) fn page(run: &Run, options: &FigureOptions, embeds: bool, watch: &mut dyn Watch) -> Result<String, Fault> {
    if options.plot.is_some() {
        return Err(Fault::new("Notes have pictures of the mesh, no histograms").at("--plot").remedy("Leave it out"));
    }
    options.check_captions(false).map_err(|fault| fault.remedy("Leave it out: the page says it beside each figure"))?;
    if run.bookmarks.is_empty() {
        return Err(Fault::new("This run has no bookmarks, and so no notes")
            .remedy("Bookmark steps in the window (Ctrl+B) and save the run (Ctrl+S)"));
    }
    let mut history = History::open(run.clone(), watch)?;
    let mut parts = String::new();
    let total = run.bookmarks.len() as u64;
    for (k, mark) in (0..).zip(&run.bookmarks) {
        watch.tell(Stage::Convert, k, total);
        watch.cancel().check()?;
        parts += &section(run, mark, &mut history, options, embeds)?;
    }
    let title = escaped(&run.case.title);
    let links = run.bookmarks.iter().map(|mark| format!("<a href=\"#step-{}\">step {}</a>", mark.step, mark.step));
    let links = links.collect::<Vec<_>>().join(" ");
    let about = format!("{}; {}", describe(&run.case), counted(total, "bookmarked step"));
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>{title}</h1>\n<p class=\"about\">{}</p>\n<nav>{links}</nav>\n{parts}</body>\n</html>\n",
        escaped(&about)
    ))
}

/// A bookmarked step: its heading, what it did, its figure and its note.
fn section(
    run: &Run,
    mark: &Bookmark,
    history: &mut History,
    options: &FigureOptions,
    embeds: bool,
) -> Result<String, Fault> {
    let Bookmark { step, note } = mark;
    let note = to_html(note);
    history.seek(step.saturating_sub(1))?;
    let looked_at = history.state().looks_at();
    let candidates = looked_at.candidates.as_ref().filter(|_| *step > 0);
    history.take_changes();
    history.seek(*step)?;
    if history.step() < *step {
        let end = grouped(history.step());
        return Ok(format!(
            "<section id=\"step-{step}\">\n<h2>Step {}</h2>\n<p class=\"did\">The run ends before, at step {end}.</p>\n\
             {note}</section>\n",
            grouped(*step)
        ));
    }
    let changed = match history.take_changes() {
        Changes::Some { elements, .. } if *step > 0 => elements,
        _ => Vec::new(),
    };
    let state = history.state();
    let (mesh, phase) = (&state.mesh, state.phase());
    let shown = ShownState { step: *step, at: Some(Stop::Step(*step)), state: fingerprint(mesh, phase) };
    let seen = Seen { mesh, parameters: state.parameters(), phase, changed: &changed, candidates };
    let frame = FigureFrame::of(&seen, &options.look(false), shown);
    let figure = Figure::of_run(run, &[frame], options, embeds)?;
    let quads = counted(state.standing(), "quadrilateral");
    let event = history.event(*step)?;
    let did = event.map_or_else(|| beginning(mesh).trim_end_matches('.').to_owned(), |event| said(&event));
    let mut why = event.map_or_else(Vec::new, |event| about(&event, &looked_at, state));
    why.extend(event.zip(candidates).map_or_else(Vec::new, |(event, tried)| not_chosen(&event, tried)));
    // The one that follows a step is told with it.
    why.extend(history.attempts()?.iter().filter(|tried| !tried.steps.is_empty()).map(attempt));
    let why = list(&why);
    let alt = escaped(&figure.page.description);
    let mut text = String::new();
    // Writing to a String cannot fail. An image keeps the names within each SVG apart.
    let _ = write!(
        text,
        "<section id=\"step-{step}\">\n<h2>Step {} · {quads}</h2>\n<p class=\"did\">{}.</p>\n{why}<figure><img \
         alt=\"{alt}\" src=\"data:image/svg+xml;base64,{}\"></figure>\n{note}</section>\n",
        grouped(*step),
        escaped(&did),
        STANDARD.encode(figure.svg())
    );
    Ok(text)
}

fn said(event: &Did) -> String {
    capital(&plain(&did(event)))
}

/// The candidates for a side edge that a step did not choose, each with the reason.
fn not_chosen(event: &Did, tried: &Candidates) -> Vec<String> {
    let chooses = [EventKind::SideIsFront, EventKind::SideChosen, EventKind::SideSwapped, EventKind::RolledBack];
    if !chooses.contains(&event.kind()) {
        return Vec::new();
    }
    let reason = |candidate: &Candidate| {
        let reason = passed(candidate.passed?, candidate, tried);
        Some(match candidate.swap {
            None => format!("Candidate to node {}: {reason}.", candidate.node.0),
            Some(across) => format!("Candidate to node {}, by a swap of {}: {reason}.", candidate.node.0, edge(across)),
        })
    };
    tried.edges.iter().filter_map(reason).collect()
}

/// An attempt with its steps, and why it was taken back.
fn attempt(tried: &Tried) -> String {
    let number = u32::from(tried.attempt.number) + 1;
    let steps = match (tried.steps.first(), tried.steps.last()) {
        (Some((first, _)), Some((last, _))) if first < last => {
            format!(", steps {} to {}", grouped(*first), grouped(*last))
        }
        (Some((only, _)), _) => format!(", step {}", grouped(*only)),
        _ => String::new(),
    };
    let end = tried.failed().map_or_else(String::new, |why| format!(" Taken back: {}.", why_rolled_back(why)));
    format!("Attempt {number}: {}{steps}.{end}", words(&tried.attempt))
}

/// Sentences as a list.
fn list(sentences: &[String]) -> String {
    if sentences.is_empty() {
        return String::new();
    }
    let items: String = sentences.iter().map(|sentence| format!("<li>{}</li>\n", escaped(&plain(sentence)))).collect();
    format!("<ul class=\"why\">\n{items}</ul>\n")
}

/// A note as HTML. HTML in it is shown as it is written, and links lead to pages or mail only.
fn to_html(note: &str) -> String {
    let options = Options::ENABLE_TABLES | Options::ENABLE_STRIKETHROUGH | Options::ENABLE_TASKLISTS;
    let events = Parser::new_ext(note, options).map(|event| match event {
        Event::Html(text) | Event::InlineHtml(text) => Event::Text(text),
        Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
            Event::Start(Tag::Link { link_type, dest_url: harmless(dest_url), title, id })
        }
        // A page that needs no other file shows no others.
        Event::Start(Tag::Image { link_type, dest_url, title, id }) => {
            Event::Start(Tag::Link { link_type, dest_url: harmless(dest_url), title, id })
        }
        Event::End(pulldown_cmark::TagEnd::Image) => Event::End(pulldown_cmark::TagEnd::Link),
        event => event,
    });
    let mut text = String::new();
    html::push_html(&mut text, events);
    text
}

/// The address of a link, if it can do nothing but lead somewhere.
fn harmless(url: CowStr<'_>) -> CowStr<'_> {
    let is_allowed = ["https:", "http:", "mailto:", "#"].iter().any(|start| url.starts_with(start));
    if is_allowed { url } else { CowStr::from("") }
}

/// A text without characters that HTML takes for its own.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_become_html_in_which_nothing_runs() {
        let html = to_html("a **b** <script>alert(1)</script>\n\n| x | y |\n|---|---|\n| 1 | 2 |\n");
        assert!(html.contains("<strong>b</strong>") && html.contains("<td>1</td>"), "{html}");
        assert!(html.contains("&lt;script&gt;") && !html.contains("<script"), "{html}");
        let html = to_html("[a](javascript:alert(1)) [b](https://b.c) [c](#step-3) ![d](https://d.e/f.png)");
        assert!(!html.contains("javascript") && !html.contains("<img"), "{html}");
        assert!(html.contains("href=\"https://b.c\"") && html.contains("href=\"#step-3\""), "{html}");
        assert_eq!(escaped("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
    }
}
