use proptest::prelude::*;

use super::*;
use crate::core::case::Case;
use crate::core::mesh::{ElementId, NodeId};
use crate::core::run::{Bookmark, Edit, EditKind};

fn run() -> Run {
    Run::of(built_in::named("example1").unwrap().unwrap())
}

fn edit(step: u64, key: &str, value: &str) -> Edit {
    Edit { step, kind: EditKind::parameter(key, value).unwrap() }
}

#[test]
fn a_link_says_the_state_in_words_and_is_read_from_a_fragment_or_an_address_in_any_order() {
    let mut run = run();
    run.parameters.set("c", "1.8").unwrap();
    let camera = Camera { target: [0.500_000_04, 0.3, 0.0], turn: Camera::OF_THE_PLANE, height: 0.2 };
    let link = Link {
        step: Some(812),
        selected: Some(Sought::Edge([NodeId(104), NodeId(105)])),
        lesson: Some(LessonPlace { name: "figure-14".to_owned(), part: 1 }),
        ..Link::of(&run).unwrap().seen_by(Some(camera))
    };
    let text = "#case=example1&c=1.8&step=812&select=104-105&view=0.5,0.3,0.2&lesson=figure-14&part=2";
    assert_eq!(link.text().unwrap(), text);
    for same in [
        text,
        &text[1..],
        &format!(" https://example.org/quadfront/?x=1{text}\n"),
        "#lesson=figure-14&&part=2&view=.5,%20.3,2e-1&c=1.80&step=812&select=104%2D105&case=example1",
    ] {
        let mut read = Link::parse(same).unwrap();
        // As it was written.
        read.parameters[0].1 = "1.8".to_owned();
        assert_eq!(read, link, "{same}");
    }
    assert!(Link::is_link(text) && Link::is_link(" https://example.org") && !Link::is_link("case=example1"));
}

#[test]
fn a_run_goes_along_where_no_built_in_case_with_parameters_is_it() {
    let plain = Link::of(&run()).unwrap();
    assert_eq!(plain.origin, Some(Origin::Case("example1".to_owned())));
    assert!(plain.parameters.is_empty());
    let mut edited = run();
    edited.set_edits(vec![edit(30, "theta_rect", "120")]);
    let mut marked = run();
    marked.bookmarks.push(Bookmark { step: 3, note: "here & there".to_owned() });
    let mut own = run();
    own.case.text.push_str("# of my own\n");
    own.parameters.set("c", "1.8").unwrap();
    for run in [edited, marked, own] {
        let link = Link::of(&run).unwrap();
        let text = link.text().unwrap();
        assert!(text.starts_with("#run=") && text.len() < 6_000, "{} characters", text.len());
        let read = Link::parse(&text).unwrap();
        assert_eq!(read, link);
        let Some(Origin::Run(text)) = read.origin else { panic!() };
        let read = run_file::parse_alone(&text, "").unwrap();
        assert_eq!((read.edits(), &read.bookmarks), (run.edits(), &run.bookmarks));
        assert_eq!((&read.parameters, &read.case.text), (&run.parameters, &run.case.text));
    }
}

#[test]
fn what_fits_no_link_is_said_with_another_way_to_send_it() {
    let fault = Link::of(&Run::of(Case::of_mesh("a.msh".into(), None))).unwrap_err();
    assert!(fault.what.contains("mesh") && fault.remedy.contains("Save the run"), "{fault}");
    let mut long = run();
    // Digits that no deflating makes short.
    let digits = (0..4000).fold((1_u64, String::new()), |(x, text), _| {
        let x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (x, format!("{text}{:x}", x >> 20))
    });
    long.case.text.push_str(&format!("# {}\n", digits.1));
    let fault = Link::of(&long).unwrap().text().unwrap_err();
    assert_eq!(fault.kind(), FaultKind::Limit);
    assert!(fault.what.contains("16\u{2009}000 are the limit") && fault.remedy.contains("Save the run"), "{fault}");
}

#[test]
fn a_bad_link_is_refused_with_the_word_and_what_is_possible() {
    let cut = Link { origin: Some(Origin::Run(run_file::alone(&run()).unwrap())), ..Link::default() }.text().unwrap();
    let cut = &cut[..cut.len() - 9];
    let no_run = Link { origin: Some(Origin::Run("version = 1".to_owned())), ..Link::default() }.text().unwrap();
    for (text, what, remedy) in [
        ("#", "Nothing stands after #", "#case=example1"),
        ("https://example.org/page", "Nothing stands after #", "#case=example1"),
        ("#step=3", "Nothing says what to open", "case=NAME"),
        ("#case", "\"case\" has no value", "#case=example1"),
        ("#case=example1&stp=3", "\"stp\" is not known", "\"step\""),
        ("#case=example1&theta_rekt=3", "\"theta_rekt\" is not known", "\"theta_rect\""),
        ("#case=example1&zzzzzzz=3", "not known", "case, run, step, select, view, lesson, part"),
        ("#case=example1&step=1&step=2", "step is given twice", "Leave one"),
        ("#case=example1&step=-1", "step = \"-1\" is not a whole number", "step=812"),
        ("#case=example1&step=99999999999", "not a whole number", "step=812"),
        ("#case=exampel1", "No built-in case is called \"exampel1\"", "\"example1\""),
        ("#case=zzz", "No built-in case", "quadfront cases"),
        ("#case=example1&run=eNo", "both given", "Leave one"),
        ("#case=example1&c=fast", "c = \"fast\" is not a number", "Write a number"),
        ("#case=example1&theta_rect=300", "out of range", "90 to 180"),
        ("#case=example1&select=12", "names nothing that can be selected", "104-105"),
        ("#case=example1&select=.5,.3", "names nothing that can be selected", "node12"),
        ("#case=example1&select=nod", "names nothing that can be selected", "node12"),
        ("#case=example1&view=1,2", "neither three numbers", "view=0.5,0.3,0.2"),
        ("#case=example1&view=1,2,0", "neither three numbers", "positive"),
        ("#case=example1&view=1,2,nan", "neither three numbers", "positive"),
        ("#case=example1&view=0,0,0,0,0,0,0,1", "neither three numbers", "view="),
        ("#case=example1&c=%4", "The value of c is cut off or damaged", "percent"),
        ("#lesson=figure-41", "No lesson of the tour is called \"figure-41\"", "The nearest is \"figure-1"),
        ("#lesson=mine.md", "No lesson of the tour", "quadfront lesson"),
        ("#lesson=figure-14&part=0", "none of the parts of \"figure-14\"", "parts 1 to"),
        ("#lesson=figure-14&part=99", "none of the parts", "parts 1 to"),
        ("#case=example1&part=2", "part is given without lesson", "lesson="),
        ("#lesson=figure-14&c=2", "a lesson has its own run", "case=NAME"),
        ("#run=!", "The run in the link is cut off", "Copy the link anew"),
        (cut, "The run in the link is cut off", "Copy the link anew"),
        (&no_run, "\"run\" is missing", "run = 1"),
    ] {
        let fault = Link::parse(text).unwrap_err();
        assert!(fault.what.contains(what) && fault.remedy.contains(remedy), "{text}: {fault}");
        assert!(fault.place.starts_with("the link"), "{text}: {fault}");
        assert_ne!(fault.kind(), FaultKind::Other, "{text}");
    }
    // A bomb of zeros, which inflates to more than a run file has.
    let bomb = URL_SAFE_NO_PAD.encode(compress_to_vec_zlib(&vec![b' '; 8 << 20], LEVEL));
    assert!(bomb.len() < LONGEST && Link::parse(&format!("#run={bomb}")).unwrap_err().what.contains("damaged"));
}

#[test]
fn no_word_is_the_key_of_a_parameter() {
    assert!(reading::WORDS.iter().all(|word| !Parameters::KEYS.contains(word)));
}

#[test]
fn what_is_left_out_of_a_view_cannot_be_seen() {
    for height in [1e-9, 0.31, 7.0, 4e8] {
        let turn = [0.2, -0.3, 0.4, 0.842_614_977_317_635_8];
        let camera = Camera { target: [height / 3.0, -height / 7.0, 1.0 / 3.0], turn, height };
        let seen = Link::default().seen_by(Some(camera)).view.unwrap();
        let point = height / 1000.0;
        for (a, b) in camera.target.into_iter().zip(seen.target).chain([(camera.height, seen.height)]) {
            assert!((a - b).abs() < 0.02 * point, "{height}: {a} {b}");
        }
        assert!(camera.turn.iter().zip(seen.turn).all(|(a, b)| (a - b).abs() < 1e-6));
        assert!(view(&seen).len() < 110, "{}", view(&seen));
    }
}

fn sought() -> impl Strategy<Value = Sought> {
    let id = any::<u32>();
    (0..6_u8, id, id).prop_map(|(kind, a, b)| match kind {
        0 => Sought::Node(NodeId(a)),
        1 => Sought::Quad(ElementId(a)),
        2 => Sought::Triangle(ElementId(a)),
        3 => Sought::Element(ElementId(a)),
        4 => Sought::Edge([NodeId(a), NodeId(b)]),
        _ => Sought::Segment([NodeId(a), NodeId(b)]),
    })
}

fn camera() -> impl Strategy<Value = Camera> {
    let number = -1e6..1e6_f64;
    let turn = prop_oneof![Just(Camera::OF_THE_PLANE), Just([0.5, -0.5, 0.5, 0.5]), Just([0.6, 0.0, 0.0, 0.8])];
    ([number.clone(), number.clone(), number], turn, 1e-9..1e9_f64).prop_map(|(target, turn, height)| {
        let z = if turn == Camera::OF_THE_PLANE { 0.0 } else { target[2] };
        Camera { target: [target[0], target[1], z], turn, height }
    })
}

fn link() -> impl Strategy<Value = Link> {
    let case =
        prop::sample::select(built_in::CASES).prop_map(|case| Run::of(built_in::named(case.0).unwrap().unwrap()));
    let parameters = (0.5..1000.0_f64, 90.0..180.0_f64, any::<bool>(), any::<bool>());
    let lesson = ("[a-z]", 0..2_usize).prop_map(|(_, part)| LessonPlace { name: "figure-14".to_owned(), part });
    let place = (prop::option::of(any::<u32>()), prop::option::of(sought()), prop::option::of(camera()));
    (case, parameters, place, prop::option::of(lesson)).prop_map(
        |(mut run, (c, theta, smoothing, is_edited), (step, selected, view), lesson)| {
            run.parameters.set("c", &c.to_string()).unwrap();
            run.parameters.set("theta_rect", &theta.to_string()).unwrap();
            run.parameters.set("smoothing", &smoothing.to_string()).unwrap();
            if is_edited {
                run.set_edits(vec![edit(7, "theta_seam", "45")]);
            }
            let link = Link::of(&run).unwrap().seen_by(view);
            Link { step: step.map(u64::from), selected, lesson, ..link }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_link_that_is_written_is_read_as_it_was(link in link()) {
        let text = link.text().unwrap();
        prop_assert!(text.bytes().all(|b| b.is_ascii_graphic()));
        prop_assert_eq!(Link::parse(&text).unwrap(), link);
    }

    #[test]
    fn no_text_makes_reading_a_link_fail_otherwise_than_by_a_fault(
        text in any::<String>(),
        words in prop::collection::vec(("[a-z_]{1,6}|case|run|step|select|view|lesson|part|c", ".{0,12}"), 0..5),
    ) {
        let _ = Link::parse(&text);
        let words: Vec<String> = words.iter().map(|(key, value)| format!("{key}={value}")).collect();
        let _ = Link::parse(&format!("#{}", words.join("&")));
    }
}
