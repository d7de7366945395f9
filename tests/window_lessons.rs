//! Promise: a learner who reads and clicks gets through the whole tour: every part is told, every question is answered
//! in the window, a wrong answer gets its reason, and progress outlasts the window. Predictions at any state of any run
//! are judged in the same way, and a series that a seed draws is the same one everywhere.
//!
//! Needs a graphics adapter (see `window_harness`). Answers and reasons are those of a second history of the same run;
//! that those are true of the events is the promise of `lessons` and `questions`.
#![allow(clippy::unwrap_used)]

mod window_harness;

use eframe::egui::{Key, Pos2, Vec2};
use egui_kittest::kittest::Queryable;
use quadfront::app::window::{App, Command, Goal, Lost, Source, StudyCommand};
use quadfront::core::lesson::{Lesson, built_in};
use quadfront::core::progress::Nobody;
use quadfront::core::question::{Answer, Asked, Kind, Series, Verdict, draw};
use quadfront::core::run::History;
use quadfront::core::run::explain::plain;
use quadfront::render::scene::Outlined;
use window_harness::{LAPTOP, Window, apply, has_adapter, settle, start, type_over, until};

fn window(source: Source) -> Option<Window> {
    has_adapter().then(|| {
        let mut window = start(LAPTOP, |cc| App::new(cc, Some(source)));
        settle(&mut window);
        window
    })
}

fn click(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    window.run_steps(2);
    settle(window);
}

fn has(window: &Window, text: &str) -> bool {
    window.query_all_by_label_contains(text).next().is_some()
}

/// Waits until what a part or a question has to say is there.
fn taught(window: &mut Window) {
    until(window, "the part is told", |window| {
        window.state().state.study().is_some_and(|study| study.taught.is_some())
    });
    settle(window);
}

fn step(window: &Window) -> u64 {
    window.state().state.run().moment.as_ref().unwrap().step
}

/// An answer that is not right, of the kind that the question asks for.
fn wrong(asked: &Asked, history: &mut History) -> Answer {
    history.seek(asked.step).unwrap();
    let state = history.state();
    let candidates: Vec<Answer> = match asked.kind {
        Kind::Segment => state.mesh.front().map(|h| Answer::Edge(state.mesh.ends(h))).collect(),
        Kind::Edge => state.mesh.edges().map(|h| Answer::Edge(state.mesh.ends(h))).collect(),
        Kind::Node => state.mesh.nodes().map(Answer::Node).collect(),
        Kind::Count => vec![Answer::Number(99)],
        kind => kind.choices().iter().map(|choice| Answer::Choice(*choice)).collect(),
    };
    let judge = |answer: &Answer| asked.judge(state, *answer).unwrap().verdict;
    let worst = candidates.iter().copied().find(|answer| judge(answer) == Verdict::Wrong);
    worst.or_else(|| candidates.into_iter().find(|answer| judge(answer) == Verdict::Partly)).unwrap()
}

/// Gives an answer as a person does: by the button of a choice, or written. Returns once it is judged.
fn give(window: &mut Window, answer: Answer) {
    let before = window.state().state.study().unwrap().tries.len();
    match answer {
        Answer::Choice(choice) => window.get_by_label(&plain(choice.words())).click(),
        answer => type_over(window, "Your answer", &answer.text()),
    }
    window.run_steps(2);
    until(window, "the answer is judged", |window| window.state().state.study().unwrap().tries.len() > before);
}

/// Answers the question at hand first in a wrong way, then in the right one; checks what is said. Returns whether all
/// hints were taken.
fn answer_the_question(window: &mut Window, asked: &Asked, history: &mut History, text: &str) {
    assert!(has(window, &plain(text)), "{text}");
    let bad = wrong(asked, history);
    let judged = asked.judge(history.state(), bad).unwrap();
    give(window, bad);
    assert!(has(window, &plain(&judged.why.join(" "))), "{text} {bad:?}: {:?}", judged.why);
    let word = if judged.verdict == Verdict::Wrong { "No." } else { "In part." };
    assert!(has(window, word), "{text} {bad:?}");
    let hints = asked.hints(history.state());
    if let Some(first) = hints.first() {
        // The teacher's own hint may come first.
        while !has(window, &plain(&first.text)) {
            click(window, "Hint");
        }
    }
    let right = asked.answer();
    let judged = asked.judge(history.state(), right).unwrap();
    give(window, right);
    assert!(has(window, &plain(&judged.why.join(" "))) && has(window, "Yes."), "{text}: {:?}", judged.why);
}

/// Goes through a lesson that is open, at its first part.
fn go_through(window: &mut Window, lesson: &Lesson) {
    let mut history = History::open(lesson.run(), &mut Nobody).unwrap();
    history.extend(u64::MAX);
    for (k, part) in lesson.parts.iter().enumerate() {
        taught(window);
        let place = format!("{}, part {}", lesson.name, k + 1);
        let title = format!("of {} {}", built_in::LESSONS.len(), lesson.title);
        assert!(has(window, &title), "{place}: its title stands in the bar");
        let scene = lesson.scene(k, &mut history).unwrap();
        assert_eq!(step(window), scene.step, "{place}");
        assert!(has(window, &part.heading), "{place}: {}", part.heading);
        assert!(has(window, &format!("{} of {}", k + 1, lesson.parts.len())), "{place}");
        assert!(has(window, &plain(&scene.narration)), "{place}: {}", scene.narration);
        for pieces in scene.text.iter().filter(|pieces| !pieces.is_empty()) {
            let text: String = pieces.iter().map(|shown| shown.text.as_str()).collect();
            assert!(has(window, &plain(&text)), "{place}: {text}");
        }
        // One steps away, and comes back.
        if k == 0 && scene.step > 0 {
            click(window, "Back");
            assert!(step(window) < scene.step, "{place}");
            click(window, "Back to it");
            assert_eq!(step(window), scene.step, "{place}");
        }
        for (q, (ask, asked)) in part.asks.iter().zip(&scene.asked).enumerate() {
            answer_the_question(window, asked, &mut history, &ask.text);
            if q + 1 < part.asks.len() {
                click(window, "Continue");
            }
        }
        if k + 1 < lesson.parts.len() {
            click(window, "Continue");
        }
    }
}

#[test]
fn a_learner_gets_through_the_whole_tour_by_its_labels() {
    let Some(mut window) = window(Source::BuiltIn("figure-14".to_owned())) else { return };
    window.get_by_label("Learn").click();
    window.run_steps(2);
    window.get_by_label_contains("Go on with the tour").click();
    window.run_steps(2);
    let mut questions = 0;
    for (k, (name, _)) in built_in::LESSONS.iter().enumerate() {
        let lesson = built_in::named(name).unwrap().unwrap();
        until(&mut window, "the lesson is open", |window| {
            let study = window.state().state.study();
            study.and_then(|study| study.lesson()).is_some_and(|(open, _)| open.name == *name)
        });
        settle(&mut window);
        assert!(has(&window, &format!("{}, open", lesson.title)), "{name}");
        go_through(&mut window, &lesson);
        questions += lesson.questions();
        let last = k + 1 == built_in::LESSONS.len();
        window.get_by_label(if last { "End of the lesson" } else { "Next lesson" }).click();
        window.run_steps(2);
    }
    let learned = &window.state().state.workspace().learned;
    assert!(built_in::LESSONS.iter().all(|(name, _)| learned.is_done(name)));
    let counted: u32 = learned.by_rule().iter().map(|(_, tally)| tally.all()).sum();
    let right: u32 = learned.by_rule().iter().map(|(_, tally)| tally.right).sum();
    assert_eq!((counted as usize, right), (questions, 0), "the first answer counts, and each was wrong");
    assert!(has(&window, "Back to the lesson"), "the whole window is there again");
}

/// Where the middle of an edge lies on the screen.
fn place_of(window: &Window, ends: [quadfront::core::mesh::NodeId; 2]) -> Pos2 {
    let state = &window.state().state;
    let rect = window.get_by_label_contains("Mesh at step").rect();
    let view = state.view().plane;
    let mesh = &state.run().moment.as_ref().unwrap().mesh;
    let middle = 0.5 * (mesh.uv(ends[0]) + mesh.uv(ends[1]));
    let at = view.camera.unwrap().project(middle.extend(0.0), view.size);
    rect.min + Vec2::new(at.x as f32, at.y as f32)
}

#[test]
fn a_click_in_the_view_answers_and_what_is_no_answer_is_told() {
    let Some(mut window) = window(Source::Lesson("figure-14".to_owned())) else { return };
    taught(&mut window);
    // The camera glides until all of A, B, C and D is seen.
    until(&mut window, "the camera has arrived", |window| !window.ctx.has_requested_repaint());
    let lesson = built_in::named("figure-14").unwrap().unwrap();
    let mut history = History::open(lesson.run(), &mut Nobody).unwrap();
    let scene = lesson.scene(0, &mut history).unwrap();
    let Answer::Edge(right) = scene.asked[0].answer() else { panic!("an edge is asked for") };
    // A node is no answer here: the card says so, and the next answer counts.
    apply(&mut window, Command::Pick(Some(Outlined::Node(right[0]))));
    until(&mut window, "it is told", |window| has(window, "is answered by an edge"));
    assert!(window.state().state.study().unwrap().tries.is_empty());
    let at = place_of(&window, right);
    window.hover_at(at);
    window.run_steps(2);
    window.drag_at(at);
    window.drop_at(at);
    window.run_steps(3);
    until(&mut window, "the answer is judged", |window| !window.state().state.study().unwrap().tries.is_empty());
    assert!(has(&window, "Yes."), "{right:?}");
    let tally = window.state().state.study().unwrap().score.tally();
    assert_eq!((tally.right, tally.all()), (1, 1));
    // Keys: Enter goes on; H takes a hint; E explores and comes back.
    window.key_press(Key::Enter);
    window.run_steps(2);
    taught(&mut window);
    assert!(has(&window, "Sometimes nothing can be swapped"));
    window.key_press(Key::H);
    window.run_steps(2);
    assert!(has(&window, "Hint: "));
    let step_of_part = step(&window);
    window.key_press(Key::E);
    window.run_steps(2);
    assert!(window.query_by_label("Inspector").is_some(), "the whole window");
    apply(&mut window, Command::Go(Goal::End));
    apply(&mut window, Command::Set("c", "1.5".to_owned()));
    window.key_press(Key::E);
    window.run_steps(2);
    settle(&mut window);
    assert!(window.query_by_label("Inspector").is_none());
    assert_eq!(step(&window), step_of_part);
    assert!(window.state().state.document().edits.is_empty(), "the run is that of the lesson");
    // A triangle is no answer to a question with choices: the card says what to do.
    let triangle = outlined_triangle(&window);
    // What brings the changes back leads to the whole window: the lesson is not about that run.
    apply(&mut window, Command::Undo);
    assert!(!window.state().state.document().edits.is_empty() && window.query_by_label("Inspector").is_some());
    window.key_press(Key::E);
    window.run_steps(2);
    settle(&mut window);
    assert!(window.state().state.document().edits.is_empty() && step(&window) == step_of_part);
    apply(&mut window, Command::Pick(Some(triangle)));
    assert!(has(&window, "Choose one of the answers."));
    assert!(window.state().state.study().unwrap().tries.is_empty());
}

fn outlined_triangle(window: &Window) -> Outlined {
    let mesh = &window.state().state.run().moment.as_ref().unwrap().mesh;
    Outlined::Element(mesh.elements().next().unwrap())
}

#[test]
fn what_was_learnt_is_kept_and_the_tour_goes_on_where_one_was() {
    if !has_adapter() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("window.json");
    let open = |source| start(LAPTOP, |cc| App::kept(cc, Some(source), Some(path.clone()), Lost::default()));
    let mut window = open(Source::Lesson("figure-12".to_owned()));
    settle(&mut window);
    first_question(&mut window);
    let lesson = built_in::named("figure-12").unwrap().unwrap();
    let mut history = History::open(lesson.run(), &mut Nobody).unwrap();
    let part = window.state().state.study().unwrap().lesson().unwrap().1;
    let scene = lesson.scene(part, &mut history).unwrap();
    give(&mut window, scene.asked[0].answer());
    let learned = window.state().state.workspace().learned.clone();
    std::thread::sleep(std::time::Duration::from_millis(1700));
    window.run_steps(3);
    drop(window);
    let mut window = open(Source::BuiltIn("figure-14".to_owned()));
    settle(&mut window);
    assert_eq!(window.state().state.workspace().learned, learned);
    apply(&mut window, Command::Study(StudyCommand::Resume));
    until(&mut window, "the lesson is open", |window| window.state().state.study().is_some());
    taught(&mut window);
    let study = window.state().state.study().unwrap();
    assert_eq!(study.lesson().map(|(lesson, part)| (lesson.name.as_str(), part)), Some(("figure-12", part)));
    let rule = scene.asked[0].rule.words();
    assert!(has(&window, &format!("{rule}: 1 of 1 right")), "{rule}");
}

/// Opens a lesson and goes to its first question.
fn first_question(window: &mut Window) {
    taught(window);
    while window.state().state.study().unwrap().posed().is_none() {
        click(window, "Continue");
        taught(window);
    }
}

#[test]
fn an_answer_that_was_shown_before_does_not_count() {
    let Some(mut window) = window(Source::Lesson("figure-12".to_owned())) else { return };
    first_question(&mut window);
    let right = window.state().state.study().unwrap().posed().unwrap().asked.answer();
    click(&mut window, "Show the answer");
    until(&mut window, "it is shown", |window| !window.state().state.study().unwrap().tries.is_empty());
    let part = window.state().state.study().unwrap().lesson().unwrap().1;
    apply(&mut window, Command::Study(StudyCommand::Part(part)));
    taught(&mut window);
    assert!(window.state().state.study().unwrap().is_asking());
    give(&mut window, right);
    assert!(has(&window, "Yes."));
    let state = &window.state().state;
    assert_eq!(state.study().unwrap().score.tally().all(), 0);
    assert!(state.workspace().learned.by_rule().is_empty());
}

#[test]
fn what_a_question_is_about_is_lit_alone() {
    let Some(mut window) = window(Source::Lesson("figure-4".to_owned())) else { return };
    first_question(&mut window);
    let at = step(&window);
    let study = window.state().state.study().unwrap();
    let about = Outlined::Element(quadfront::core::mesh::ElementId(8));
    assert_eq!((study.about(at), study.lit(at)), (Some(about), vec![about]));
    let right = study.posed().unwrap().asked.answer();
    give(&mut window, right);
    let study = window.state().state.study().unwrap();
    assert_eq!(study.lit(at), [about], "with its answer too");
    click(&mut window, "Continue");
    taught(&mut window);
    let study = window.state().state.study().unwrap();
    assert!(study.about(at).is_none() && study.lit(at).len() > 1, "the next part has its own light");
    // Its text does not speak of classes and H-values.
    assert!(!study.labels_segments());
}

#[test]
fn digits_are_an_answer_while_one_is_asked_for_and_layers_else() {
    let Some(mut window) = window(Source::Lesson("figure-13".to_owned())) else { return };
    let layers = |window: &Window| window.state().state.document().layers;
    let before = layers(&window);
    taught(&mut window);
    while window.state().state.study().unwrap().posed().is_none_or(|posed| posed.asked.kind != Kind::Segment) {
        let asks = window.state().state.study().unwrap().is_asking();
        click(&mut window, if asks { "Show the answer" } else { "Continue" });
        taught(&mut window);
    }
    let Answer::Edge([a, b]) = window.state().state.study().unwrap().posed().unwrap().asked.answer() else { panic!() };
    // A slip of the pen is no answer.
    type_over(&mut window, "Your answer", "0-19");
    until(&mut window, "the slip is told", |window| has(window, "There is no edge 0\u{2013}19 at this step"));
    assert!(window.state().state.study().unwrap().tries.is_empty());
    // Nothing has the focus: the digits go into the field nevertheless.
    for c in format!("{}-{}", a.0, b.0).chars() {
        let key = Key::from_name(&c.to_string()).unwrap_or(Key::Minus);
        window.key_press(key);
        window.event(eframe::egui::Event::Text(c.to_string()));
        window.run_steps(2);
    }
    window.key_press(Key::Enter);
    window.run_steps(2);
    until(&mut window, "the answer is judged", |window| !window.state().state.study().unwrap().tries.is_empty());
    assert!(has(&window, "Yes."));
    assert_eq!(layers(&window), before);
    // With the answer there, digits are keys again.
    window.key_press(Key::Num1);
    window.run_steps(2);
    assert_ne!(layers(&window), before);
}

#[test]
fn any_state_of_any_run_asks_what_comes_next() {
    let Some(mut window) = window(Source::BuiltIn("example1".to_owned())) else { return };
    apply(&mut window, Command::Go(Goal::ToQuads(30)));
    let from = step(&window);
    let mut history = History::open(window.state().state.current_run().unwrap(), &mut Nobody).unwrap();
    history.extend(u64::MAX);
    apply(&mut window, Command::Study(StudyCommand::Predict));
    let mut last = from;
    for number in 0..8 {
        taught(&mut window);
        let at = step(&window);
        assert!(at >= last, "question {number} is asked at {at}, after {last}");
        last = at;
        let posed = window.state().state.study().unwrap().posed().unwrap().clone();
        history.seek(at).unwrap();
        let asked = Asked::of(&mut history, posed.asked.kind, None).unwrap();
        history.seek(at).unwrap();
        if posed.asked.kind == Kind::Segment {
            // Nothing in the window tells which one, until it is answered.
            let Answer::Edge([a, b]) = asked.answer() else { panic!("a segment") };
            let name = format!("{}\u{2192}{}", a.0, b.0);
            assert!(!has(&window, &name), "{name} is told before it is asked");
            assert!(window.state().state.hides_classes());
        }
        give(&mut window, asked.answer());
        assert!(has(&window, "Yes."), "question {number}");
        click(&mut window, "Continue");
    }
    let score = &window.state().state.study().unwrap().score;
    assert_eq!((score.tally().right, score.streak()), (8, 8));
    click(&mut window, "Explore freely");
    // A run that is changed is asked about as it is then.
    apply(&mut window, Command::Go(Goal::ToQuads(20)));
    apply(&mut window, Command::Set("c", "1.5".to_owned()));
    window.key_press(Key::E);
    window.run_steps(2);
    taught(&mut window);
    let mut changed = History::open(window.state().state.current_run().unwrap(), &mut Nobody).unwrap();
    changed.extend(u64::MAX);
    let kind = window.state().state.study().unwrap().posed().unwrap().asked.kind;
    changed.seek(step(&window)).unwrap();
    let right = Asked::of(&mut changed, kind, None).unwrap().answer();
    give(&mut window, right);
    assert!(has(&window, "Yes."));
    click(&mut window, "Explore freely");
    apply(&mut window, Command::Study(StudyCommand::Leave));
    assert!(window.state().state.study().is_none() && !has(&window, "Back to the question"));
}

#[test]
fn a_class_with_one_seed_is_asked_the_same_and_answers_are_saved() {
    let Some(mut window) = window(Source::BuiltIn("example1".to_owned())) else { return };
    let series: Series = "seed=7,count=10".parse().unwrap();
    apply(&mut window, Command::Study(StudyCommand::PredictSeries(series.clone())));
    let mut history = History::open(window.state().state.current_run().unwrap(), &mut Nobody).unwrap();
    let drawn = draw(&mut history, &series).unwrap();
    assert_eq!(drawn.len(), 10);
    let mut lines = vec!["step,kind,of,answer,right,verdict,rule,hints".to_owned()];
    for (k, question) in drawn.iter().enumerate() {
        taught(&mut window);
        assert_eq!(step(&window), question.step);
        assert!(has(&window, &format!("{} of 10", k + 1)));
        history.seek(question.step).unwrap();
        let asked = Asked::of(&mut history, question.kind, None).unwrap();
        let answer = if k % 3 == 2 { wrong(&asked, &mut history) } else { asked.answer() };
        history.seek(question.step).unwrap();
        let judged = asked.judge(history.state(), answer).unwrap();
        give(&mut window, answer);
        let [kind, verdict, rule] = [question.kind.name(), judged.verdict.name(), judged.rule.name()];
        let right = asked.answer().text();
        lines.push(format!("{},{kind},,{},{right},{verdict},{rule},0", question.step, answer.text()));
        if judged.verdict != Verdict::Right {
            click(&mut window, "Show the answer");
            until(&mut window, "the answer is shown", |window| window.state().state.study().unwrap().is_answered());
            assert!(has(&window, "The answer."), "question {k}");
        }
        click(&mut window, "Continue");
    }
    assert_eq!(window.state().state.study().unwrap().score.csv().trim_end(), lines.join("\n"));
    assert!(window.state().state.study().unwrap().is_over && has(&window, "right"));
}
