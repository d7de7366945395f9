use super::*;
use clap::CommandFactory;

#[test]
fn the_arguments_do_not_contradict_each_other() {
    Cli::command().debug_assert();
}

#[test]
fn inputs_read_back_from_their_arguments() {
    let line = "quadfront sweep a --from msh --sol b.sol --set c=1.5 --set size_scale=0.5 --face left --paper \
                --use shape --split-odd --mesh-size 0.1 --curvature 0.01 --feature-angle 30 --chart-stretch 3 \
                --scale 0.001 --ignore-groups=a,b";
    let words = |line: &[&str]| match Cli::try_parse_from(line).unwrap().command {
        Some(Command::Sweep(read)) => [read.source.words(), read.mesh.words()].concat(),
        _ => Vec::new(),
    };
    let first = words(&line.split_whitespace().collect::<Vec<_>>());
    assert_eq!(first.len(), 15, "{first:?}");
    let again: Vec<_> = ["quadfront", "sweep"].into_iter().chain(first.iter().map(String::as_str)).collect();
    assert_eq!(words(&again), first);
}

#[test]
fn documented_command_lines_are_accepted() {
    for line in [
        "quadfront convert example1 --out example1.msh --report example1.json",
        "quadfront convert - -o - --format msh --from toml --set size_scale=0.5 --set c=1.5 --msh2 --quiet",
        "quadfront convert plate.mesh --sol plate.sol --split-odd -o quads.vtu --picture quads.svg",
        "quadfront convert bracket.stl --use shape --mesh-size 2 --curvature 0.01 --scale 0.001 -o quads.obj",
        "quadfront convert bracket.stl --use triangles --feature-angle 30 --chart-stretch 2 -o quads.obj",
        "quadfront convert example1 --paper --events example1.jsonl --at nq=100 -o front.vtu",
        "quadfront render example1 --at step=812 -o front.svg",
        "quadfront render example1 --at nq=50,100,150 -o strip.svg",
        "quadfront background example1 --out triangles.mesh",
        "quadfront check quads.msh --seams --branching",
        "quadfront render example1 -o example1.svg",
        "quadfront render example1 --at step=812 --size 1920x1080 -o front.png",
        "quadfront render example1 --strip nq=50,100,end -o strip.png",
        "quadfront render example1 --every 5 --contact-sheet -o sheet.pdf",
        "quadfront render example1 --at nq=40,48 --every event --captions -o step.png",
        "quadfront render example1 --at nq=100 --plot lengths --ink grey --size 84x60mm --dpi 600 -o lengths.png",
        "quadfront render a.svg --layers -letters,+h --transparent --part 0.5,-0.5,0.1 -o b.svg",
        "quadfront convert a.svg --at end -o b.msh",
        "quadfront compare example1 --with c=1.5 --with theta_rect=120",
        "quadfront compare example1 --with-paper --json",
        "quadfront compare a.toml b.toml --set size_scale=0.5",
        "quadfront reduce example1 --while exit_1 -o small.toml --tries 50",
        "quadfront sweep example1 --over c=1.5:3:.25 --over theta_rect=110:150:5 --show irregular -o a.csv",
        "quadfront sweep example1 --over selection=table1,level --list",
        "quadfront sweep example1 --list=cells --over c=1:2:.5",
        "quadfront sweep example1 --collect cells -o a.json --show seconds",
        #[cfg(feature = "window")]
        "quadfront animate a --from nq=0 --to end --every 5 --camera follow --loop once --rate 12.5 -o a.gif",
        #[cfg(feature = "window")]
        "quadfront animate a --from step=20 --to step=90 --every event --captions --size 800x800 -o a.apng",
        "quadfront notes a.toml -o a.html --size 84mm",
        "quadfront cases --json",
        "quadfront",
        "quadfront open",
        "quadfront open plate.toml",
        "quadfront open bracket.stl --use shape --feature-angle 30",
        "quadfront open example1 --paper --set c=1.5 --set size_scale=0.5",
        "quadfront open two-faces --face left --set layers=2",
        "quadfront open example2 --predict seed=7,count=10",
        "quadfront open example2 --predict seed=7,kinds=segment+top",
        "quadfront lesson --open",
        "quadfront lesson figure-14 --open",
    ] {
        assert!(Cli::try_parse_from(line.split(' ')).is_ok(), "{line}");
    }
    for line in [
        "quadfront wobble",
        "quadfront convert",
        "quadfront convert a --set size_scale",
        "quadfront open a --set size_scale",
        "quadfront check",
        "quadfront convert a --at 5",
        "quadfront convert a.stl --use wobble",
        "quadfront convert a.stl --curvature 0.1",
        "quadfront render a --at nq=2,1 -o a.svg",
        "quadfront sweep a --list --collect cells",
        "quadfront sweep a --show wobble",
        "quadfront sweep a --jobs 0",
        "quadfront render a --every 0 -o a.svg",
        "quadfront animate a --every 0 -o a.gif",
        "quadfront animate a --rate 60 -o a.gif",
        "quadfront animate a --from end -o a.gif",
        "quadfront open a --predict seed=x",
        "quadfront lesson a --open --json",
    ] {
        assert!(Cli::try_parse_from(line.split(' ')).is_err(), "{line}");
    }
}
