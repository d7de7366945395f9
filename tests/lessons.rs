//! Promise: every lesson of the tour resolves against its run, its questions have answers that the next step gives, and
//! a wrong answer gets a reason. Its pages in `tests/snapshots` were read beside the paper. A file that is no lesson is
//! refused with its line, and never ends the program.
//!
//! A change of lessons or words writes the pages anew: `INSTA_UPDATE=always cargo test --locked --no-default-features
//! --test lessons`. Read what has changed.
#![allow(clippy::unwrap_used)]

use std::path::Path;

use proptest::prelude::*;
use quadfront::core::convert::background;
use quadfront::core::convert::{Converter, Event};
use quadfront::core::lesson::{Block, Lesson, MOST_WORDS, built_in, decisions, page};
use quadfront::core::mesh::NodeId;
use quadfront::core::progress::Nobody;
use quadfront::core::question::{Answer, Asked, Choice, Kind, Verdict};
use quadfront::core::run::explain::plain;
use quadfront::core::run::{EdgeFacts, EdgeKind, History, Watched};

/// Calls `look` with every lesson of the tour and its history.
fn tour(mut look: impl FnMut(&Lesson, &mut History)) {
    for (name, _) in built_in::LESSONS {
        let lesson = built_in::named(name).unwrap().unwrap_or_else(|fault| panic!("{fault}"));
        let mut history = History::open(lesson.run(), &mut Nobody).unwrap();
        look(&lesson, &mut history);
    }
}

fn parse(text: &str) -> Result<Lesson, String> {
    Lesson::parse(text, "mine", "mine.md", Path::new("")).map_err(|fault| fault.to_string())
}

#[test]
fn every_lesson_resolves_and_its_page_is_true_of_its_run() {
    let mut all = String::new();
    let mut faults = Vec::new();
    tour(|lesson, history| match page(lesson, history, true) {
        Ok(page) => all += &format!("{page}\n----\n\n"),
        Err(fault) => faults.push(fault.to_string()),
    });
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
    insta::assert_snapshot!(all);
}

#[test]
fn lessons_ask_after_every_second_part_and_shout_at_nobody() {
    tour(|lesson, _| {
        assert!(!lesson.rules.is_empty() && !lesson.section.is_empty(), "{}", lesson.name);
        assert_eq!(built_in::title(&lesson.name), Some(lesson.title.as_str()));
        let mut silent = 0;
        for part in &lesson.parts {
            silent = if part.asks.is_empty() { silent + 1 } else { 0 };
            // The last part may close a lesson.
            assert!(silent <= 2, "{}, line {}: the third part without a question", lesson.name, part.line);
        }
    });
    for (name, text) in built_in::LESSONS {
        assert!(!text.contains('!'), "{name}");
        assert!(
            text.lines()
                .all(|line| line.starts_with("$$") || line.starts_with(['#', '?']) || line.chars().count() <= 120)
        );
    }
}

#[test]
fn every_file_of_the_folder_is_a_lesson_of_the_tour_or_the_template() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/lessons");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        assert!(name == "template" || built_in::named(&name).is_some(), "{name}");
    }
}

#[test]
fn the_template_is_a_lesson_and_the_page_on_lessons_has_it() {
    let lesson = parse(built_in::TEMPLATE).unwrap();
    let mut history = History::open(lesson.run(), &mut Nobody).unwrap();
    let page = page(&lesson, &mut history, true).unwrap();
    assert!(page.contains("*in bold*") && page.contains("180.0\u{b0}"), "{page}");
    let docs = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/lessons.md")).unwrap();
    assert!(docs.contains(built_in::TEMPLATE), "docs/lessons.md has another template than assets/lessons/template.md");
    for kind in Kind::ALL {
        assert!(docs.contains(&format!("| `{}` |", kind.name())), "docs/lessons.md does not tell of {}", kind.name());
    }
}

/// What the next step does, found by a conversion of its own, without a history.
fn next_event(lesson: &Lesson, step: u64) -> (Converter<'static>, Event) {
    let made = background(&lesson.case, &mut Nobody).unwrap();
    let sizing = std::sync::Arc::new(made.sizing.clone());
    let mut converter = Converter::new(made.mesh.clone(), sizing, lesson.case.parameters.clone());
    for _ in 0..step {
        converter.step().unwrap();
    }
    let before = converter.clone();
    (before, converter.step().unwrap())
}

/// The right answer, by an oracle that knows the event and the mesh before it alone.
fn oracle(asked: &Asked, before: &Converter<'_>, event: &Event) -> Answer {
    let mesh = &before.mesh;
    let base = before.phase().base().map(|base| [base.a, base.b]);
    let yes = |is| Answer::Choice(if is { Choice::Yes } else { Choice::No });
    match (asked.kind, *event) {
        (Kind::Segment, Event::BaseSelected { a, b, .. }) => Answer::Edge([a, b]),
        (Kind::Class, Event::BaseSelected { class, .. }) => {
            Answer::Choice([Choice::First, Choice::Second, Choice::Third, Choice::Fourth][usize::from(class) - 1])
        }
        (Kind::Edge, Event::SideIsFront { side, node }) => Answer::Edge([base.unwrap()[side.index()], node]),
        (Kind::Edge, Event::SideChosen { edge }) => Answer::Edge([base.unwrap()[edge.side.index()], edge.node]),
        (Kind::Edge, Event::SideSwapped { edge, .. }) => {
            // The edge between the two triangles at whose far corners the new one begins and ends.
            Answer::Edge(shared(before, base.unwrap()[edge.side.index()], edge.node))
        }
        (Kind::Edge, Event::TopSwapped { across, .. }) => Answer::Edge(across),
        (Kind::Edge, Event::Enhanced { new: [c, d] }) => Answer::Edge(shared(before, c, d)),
        (Kind::Node, Event::NodeRemoved { node, .. }) => Answer::Node(node),
        (Kind::Top, Event::TopFound { .. }) => Answer::Choice(Choice::There),
        (Kind::Top, Event::TopSwapped { .. }) => Answer::Choice(Choice::Swap),
        (Kind::Top, Event::NodeRemoved { .. }) => Answer::Choice(Choice::Removal),
        (Kind::Top, Event::RolledBack { .. }) => Answer::Choice(Choice::Failure),
        (Kind::Form, event) => yes(matches!(event, Event::Formed { .. })),
        (Kind::Seam, event) => yes(!matches!(event, Event::SeamRefused { .. })),
        (Kind::Split, event) => yes(matches!(event, Event::Split { .. })),
        (Kind::Count, Event::Formed { merged, .. }) => Answer::Number(merged.into()),
        (Kind::Live, _) => match asked.of.unwrap() {
            Watched::Edge(a, b) => {
                let triangles = mesh.elements_at(a).filter(|&e| mesh.is_triangle(e) && mesh.corners(e).any(|n| n == b));
                yes(triangles.count() == 2)
            }
            Watched::Element(e) => yes(mesh.corners(e).count() == 3),
            Watched::Node(_) => panic!("a node is neither live nor dead"),
        },
        (Kind::Angle, _) => {
            let Watched::Node(node) = asked.of.unwrap() else { panic!("a node") };
            // Uniform metric, one sector: the sum of the angles of its triangles in the plane.
            let angle = |e| {
                let others: Vec<NodeId> = mesh.corners(e).filter(|&n| n != node).collect();
                let [p, q] = [0, 1].map(|k| (mesh.uv(others[k]) - mesh.uv(node)).normalize());
                libm::acos(p.dot(q).clamp(-1.0, 1.0)).to_degrees()
            };
            let sum: f64 = mesh.elements_at(node).filter(|&e| mesh.is_triangle(e)).map(angle).sum();
            Answer::Choice(match sum {
                sum if sum <= 30.0 => Choice::Seam,
                sum if sum < 135.0 => Choice::Rectangle,
                sum if sum <= 225.0 + 1e-9 => Choice::Flat,
                _ => Choice::Reversal,
            })
        }
        (kind, event) => panic!("{event:?} does not answer {kind:?}"),
    }
}

/// The edge whose two triangles have these far corners.
fn shared(state: &Converter<'_>, c: NodeId, d: NodeId) -> [NodeId; 2] {
    let mesh = &state.mesh;
    let triangles = |node| mesh.elements_at(node).filter(|&e| mesh.is_triangle(e)).collect::<Vec<_>>();
    for at_c in triangles(c) {
        for at_d in triangles(d) {
            let both: Vec<NodeId> = mesh.corners(at_c).filter(|n| mesh.corners(at_d).any(|m| m == *n)).collect();
            if let [a, b] = both[..] {
                return [a, b];
            }
        }
    }
    panic!("no edge lies between {c:?} and {d:?}")
}

fn is_same(one: Answer, other: Answer) -> bool {
    match (one, other) {
        (Answer::Edge([a, b]), Answer::Edge(ends)) => ends == [a, b] || ends == [b, a],
        (one, other) => one == other,
    }
}

/// Everything that somebody may answer.
fn all_answers(asked: &Asked, state: &Converter<'_>) -> Vec<Answer> {
    let mesh = &state.mesh;
    match asked.kind {
        Kind::Segment | Kind::Edge => mesh.edges().map(|h| Answer::Edge(mesh.ends(h))).collect(),
        Kind::Node => mesh.nodes().map(Answer::Node).collect(),
        Kind::Count => (0..12).map(Answer::Number).collect(),
        kind => kind.choices().iter().map(|choice| Answer::Choice(*choice)).collect(),
    }
}

#[test]
fn a_scripted_learner_is_told_right_for_what_the_event_says_and_why_for_everything_else() {
    let (mut asked_at_all, mut answers, mut wrong, mut partly) = (0, 0, 0, 0);
    tour(|lesson, history| {
        for scene in lesson.scenes(history).unwrap() {
            for asked in &scene.asked {
                let (before, event) = next_event(lesson, asked.step);
                let right = oracle(asked, &before, &event);
                let place = format!("{}, step {}, {}", lesson.name, asked.step, asked.kind.name());
                assert!(is_same(asked.answer(), right), "{place}: {:?} is not {right:?}", asked.answer());
                history.seek(asked.step).unwrap();
                asked_at_all += 1;
                for answer in all_answers(asked, history.state()) {
                    let judged = asked.judge(history.state(), answer).unwrap();
                    let why = plain(&judged.why.join(" "));
                    let place = format!("{place}: {}: {why}", answer.words());
                    assert!(why.ends_with('.') && !why.contains(['!', '{']) && judged.why.len() <= 2, "{place}");
                    answers += 1;
                    match judged.verdict {
                        Verdict::Right if is_same(answer, right) => {}
                        // Segments that nothing but their numbers tells apart.
                        Verdict::Right => assert!(why.starts_with("Nothing but its number"), "{place}"),
                        _ => assert!(!is_same(answer, right), "{place}"),
                    }
                    wrong += usize::from(judged.verdict == Verdict::Wrong);
                    partly += usize::from(judged.verdict == Verdict::Partly);
                }
                let read = Answer::parse(asked.kind, &asked.answer().text()).unwrap();
                assert!(is_same(read, right), "{place}");
                assert!(!asked.hints(history.state()).is_empty(), "{place}");
            }
        }
    });
    assert!(asked_at_all > 50 && wrong > 500 && partly > 50, "{asked_at_all} {answers} {wrong} {partly}");
}

#[test]
fn what_is_lit_and_framed_is_there() {
    tour(|lesson, history| {
        for (part, scene) in lesson.parts.iter().zip(lesson.scenes(history).unwrap()) {
            history.seek(scene.step).unwrap();
            let mesh = &history.state().mesh;
            for things in [&scene.frame, &scene.light] {
                assert!(things.all_nodes(mesh).iter().all(|n| mesh.has_node(*n)), "{} {}", lesson.name, part.line);
                assert!(things.edges.iter().all(|[a, b]| mesh.are_joined(*a, *b)), "{} {}", lesson.name, part.line);
                assert!(things.missing.iter().all(|[a, b]| !mesh.are_joined(*a, *b)), "{} {}", lesson.name, part.line);
            }
            let front = scene.light.edges.iter().filter(|_| part.light.as_ref().is_some_and(|l| l.text == "front"));
            for [a, b] in front {
                let kind = EdgeFacts::of(mesh, *a, *b).unwrap().kind;
                let is_front = matches!(kind, EdgeKind::Front) || mesh.is_front_edge(*a, *b);
                assert!(is_front, "{} {}: {kind:?}", lesson.name, part.line);
            }
            let told = decisions(history).unwrap();
            assert!(told.windows(2).all(|pair| pair[1].step == pair[0].step + 1));
            assert!(told.last().is_none_or(|last| last.step == scene.step));
        }
    });
}

const HEAD: &str = "+++\ntitle = \"T\"\ncase = \"figure-14\"\n+++\n";

#[test]
fn what_is_no_lesson_is_refused_with_its_line_and_the_nearest_name() {
    let part = |rest: &str| format!("{HEAD}\n# One\nText.\n{rest}\n");
    let head = |lines: &str| format!("+++\n{lines}\n+++\n# One\nText.\n");
    let words = vec!["word"; MOST_WORDS + 1].join(" ");
    let texts = [
        String::new(),
        "# One\nText.".to_owned(),
        "+++\ntitle = \"T\"".to_owned(),
        head("case = \"figure-14\""),
        head("title = \"T\""),
        head("title = \"T\"\ncase = \"figur-14\""),
        head("title = \"T\"\ncase = \"mine.toml\""),
        head("title = \"T\"\ncase = \"figure-14\"\nrule = [\"seams\"]"),
        head("title = \"T\"\ncase = \"figure-14\"\nrules = [\"seam\"]"),
        head("title = \"T\"\ncase = \"figure-14\"\nrules = [\"zzz\"]"),
        head("title = \"T\"\ncase = \"figure-14\"\n[parameters]\ntheta_rekt = 3"),
        head("title = T"),
        HEAD.to_owned(),
        format!("{HEAD}\nText."),
        format!("{HEAD}\n# One\n"),
        format!("{HEAD}\n# \nText."),
        format!("{HEAD}\n## One\nText."),
        part("## Two"),
        part(&words),
        format!("{HEAD}\n# One {{goo: \"end\"}}\nText."),
        format!("{HEAD}\n# One {{go: \"top_swaped#1\"}}\nText."),
        format!("{HEAD}\n# One {{light: \"crossing\"}}\nText."),
        format!("{HEAD}\n# One {{frame: \"A Q\"}}\nText."),
        part("?edge What? {anser: \"event\"}"),
        part("?edge What? {answer: \"7-9\"}"),
        part("?egde What?"),
        part("?live Is it?"),
        part("?seam Is it? {of: \"7-9\"}"),
        part("?seam Is it?\nMore text."),
        part("\n\n$$ x"),
        part("$$ \\frac{1}{2 $$"),
        part("$$ $$"),
        part("$$ a = b +\n\\fraq{1}{2} $$ half"),
        part("$$ a &= b $$"),
        part("$$ {{thetaA}} $$"),
        part("An <b>odd</b> word"),
        part("\nA {{thetaA}}"),
        part("[x](lights:base)"),
    ];
    let told: Vec<String> = texts.iter().map(|text| parse(text).expect_err(text)).collect();
    assert!(told.iter().all(|fault| fault.starts_with("mine.md, line ")), "{told:#?}");
    insta::assert_snapshot!(told.join("\n"));
}

#[test]
fn what_the_run_does_not_have_is_refused_with_its_line() {
    let resolved = |text: &str| {
        let lesson = parse(text).unwrap();
        let mut history = History::open(lesson.run(), &mut Nobody).unwrap();
        lesson.scenes(&mut history).map(drop).expect_err(text).to_string()
    };
    let part = |attributes: &str, rest: &str| format!("{HEAD}\n# One {{{attributes}}}\nText.\n{rest}\n");
    let told = [
        part("go: \"99999\"", ""),
        part("go: \"nq=99999\"", ""),
        part("go: \"seamed#9\"", ""),
        part("go: \"base_selected#1-5\"", ""),
        part("light: \"top\"", ""),
        part("light: \"C\"", ""),
        part("light: \"node 999\"", ""),
        part("light: \"quad 999\"", ""),
        part("go: \"top_found#1\", light: \"crossings\"", ""),
        part("light: \"class 4 new\"", ""),
        part("go: \"start\"", "?edge What?"),
        part("go: \"end\"", "?segment Which?"),
        part("go: \"start\"", "?live Is it? {of: \"0-3\"}"),
        part("go: \"start\"", "?live Is it? {of: \"front\"}"),
        part("go: \"start\"", "?angle Is it? {of: \"9\"}"),
        format!("{HEAD}\n# One\nThe top {{{{top}}}}."),
        part("go: \"start\"", "\n$$ \\text{top} = {{top}} $$"),
    ]
    .map(|text| resolved(&text));
    assert!(told.iter().all(|fault| fault.starts_with("mine.md, line ")), "{told:#?}");
    insta::assert_snapshot!(told.join("\n"));
}

#[test]
fn an_equation_and_what_it_says_are_read() {
    let text = format!("{HEAD}\n# One\nText.\n\n$$ a^2\n+ b_{{12}} $$ is **said** here\n\nMore.\n?segment\n");
    let lesson = parse(&text).unwrap();
    let Block::Equation { equation, says } = &lesson.parts[0].blocks[1] else { panic!() };
    assert_eq!((equation.tex(), equation.text().as_str(), says.len()), ("a^2 + b_{12}", "a^2 + b_12", 3));
    assert_eq!(lesson.parts[0].blocks.len(), 3);
    assert_eq!(lesson.parts[0].asks[0].text, Kind::Segment.words());
}

#[test]
fn numbers_of_the_state_are_put_into_equations() {
    let text =
        format!("{HEAD}\n# One {{go: \"base_selected#1\"}}\nText {{{{theta_A}}}}.\n\n$$ x < {{{{theta_A}}}} $$\n");
    let lesson = parse(&text).unwrap();
    let mut history = History::open(lesson.run(), &mut Nobody).unwrap();
    let scene = lesson.scene(0, &mut history).unwrap();
    let angle = &scene.text[0][1].text;
    assert!(angle.ends_with('\u{b0}'), "{angle}");
    assert_eq!(scene.equations.len(), 2);
    assert!(scene.equations[0].is_none());
    assert_eq!(scene.equations[1].as_ref().unwrap().text(), format!("x < {angle}"));
    assert!(page(&lesson, &mut history, false).unwrap().contains(&format!("\n    x < {angle}\n")));
}

/// What a hand may write into a lesson.
const SCRAPS: [&str; 34] = [
    "+++",
    "\n",
    "# ",
    "?",
    "?edge ",
    "{",
    "}",
    "\"",
    ":",
    ",",
    "$$",
    "**",
    "_{",
    "{{",
    "}}",
    "[",
    "](light:",
    ")",
    "go",
    "light",
    "C D",
    "class ",
    "#1-1",
    "9999999999999999999999",
    "\u{0}",
    "\u{2009}",
    "\u{1f600}",
    "\\",
    "- ",
    "<b>",
    "```",
    "title = ",
    "[parameters]\n",
    "e\u{301}",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn no_text_ends_the_program(
        which in 0..built_in::LESSONS.len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..20_usize, 0..SCRAPS.len()), 0..12),
    ) {
        let mut characters: Vec<char> = built_in::LESSONS[which].1.chars().collect();
        for (place, gone, scrap) in edits {
            let at = place.index(characters.len() + 1);
            let end = (at + gone).min(characters.len());
            characters.splice(at..end, SCRAPS[scrap].chars());
        }
        let text: String = characters.into_iter().collect();
        match parse(&text) {
            Ok(lesson) if lesson.case.name.starts_with("figure-") => {
                let mut history = History::open(lesson.run(), &mut Nobody).unwrap();
                if let Err(fault) = page(&lesson, &mut history, true) {
                    prop_assert!(fault.to_string().starts_with("mine.md, line "), "{}", fault);
                }
            }
            Ok(_) => {}
            Err(fault) => prop_assert!(fault.starts_with("mine.md, line "), "{}", fault),
        }
    }
}
