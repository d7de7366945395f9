//! `page`: a case, a run or a lesson as one HTML file with the program inside, which opens in any browser without a
//! server.

use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Deserialize, Serialize};

use super::command_line::{PageArguments, Source};
use super::figure::Wanted;
use super::input::Until;
use super::notes::escaped;
use super::progress::Progress;
use super::{input, output, work};
use crate::core::case::{DomainSource, ImportOptions, MeshSource, built_in};
use crate::core::convert::Stop;
use crate::core::fault::{Fault, FaultKind};
use crate::core::formats::metric_beside;
use crate::core::formats::save::{is_file, load, load_text};
use crate::core::lesson::built_in as tour;
use crate::core::progress::{Stage, Watch};
use crate::core::record::link::{LessonPlace, Link};
use crate::core::record::run_file;
use crate::core::run::{Run, Shown, ShownState};
use crate::render::look::Look;

/// The page that `make web` makes: the program without anything to show.
const TEMPLATE: &str = "quadfront-page.html";
/// Where the content stands in it.
const CONTENT: [&str; 2] = ["<script type=\"application/json\" id=\"content\">", "</script>"];
/// Where its title stands.
const TITLE: [&str; 2] = ["<title>", "</title>"];

/// What a page shows, as its JSON says it.
#[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Content {
    /// The title of the page.
    pub title: String,
    /// What the program opens: the name of one of the files, or a link.
    pub open: String,
    /// Files: their names, and their bytes as base64.
    pub files: Vec<(String, String)>,
}

/// Writes a page.
pub(super) fn page(arguments: &PageArguments) -> Result<(), Fault> {
    let PageArguments { source, lesson, at, out } = arguments;
    output::check(&[Some(out)], None)?;
    let template = template()?;
    let name = source.input.as_str();
    let is_case = built_in::all().any(|case| case.0 == name);
    let content = if *lesson || name.ends_with(".md") || tour::title(name).is_some() && !is_case {
        let Source { overrides, from, sol, .. } = source;
        if at.is_some() || from.is_some() || sol.is_some() || *overrides != Default::default() {
            return Err(Fault::new("A lesson says by itself where it stands, and with which parameters")
                .at(name)
                .remedy("Leave the options out"));
        }
        Content::of_lesson(name)?
    } else {
        let mut progress = Progress::new(source.quiet);
        progress.tell(Stage::Read, 0, 0);
        let input = input::read(source, &ImportOptions::default())?;
        let of_figure = input.figure.as_ref().and_then(Shown::state);
        let stop = match (at, of_figure) {
            (Some(Until::Stop(stop)), _) => Some(*stop),
            (Some(Until::End), _) => None,
            (None, Some(shown)) => shown.at.map(|_| Stop::Step(shown.step)),
            (None, None) => Some(Stop::Step(0)),
        };
        let frames = work::frames(&input.run, &[Wanted::at(stop)], &Look::default(), false, &mut progress)?;
        let content = Content::of_run(&input.run, frames[0].shown)?;
        progress.finish();
        content
    };
    let page = content.within(&template)?;
    out.write(|file| file.write_all(page.as_bytes()))
}

impl Content {
    /// A run at a state, with its mesh.
    ///
    /// # Errors
    /// A mesh that cannot be read, or that has further files.
    pub fn of_run(run: &Run, shown: ShownState) -> Result<Content, Fault> {
        let mut run = run.clone();
        run.shown = Some(Shown { states: vec![shown], drawn: Vec::new() });
        let mut files = Vec::new();
        let mut folder = PathBuf::new();
        if let DomainSource::Mesh { source: MeshSource::File { path, sol }, .. } = &run.case.domain {
            if path.extension().is_some_and(|own| own.eq_ignore_ascii_case("gltf")) {
                return Err(Fault::new("A .gltf file may have its points in other files, which a page has not")
                    .of_kind(FaultKind::Mesh)
                    .at(path.display().to_string())
                    .remedy("Save the mesh as .glb, which has all in one file"));
            }
            folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
            let sol = sol.clone().or_else(|| metric_beside(path));
            for file in std::iter::once(path).chain(&sol) {
                // As the run names it: from the folder of the mesh, or by its whole path.
                let name = match file.strip_prefix(&folder) {
                    Ok(near) => near.to_path_buf(),
                    Err(_) => std::path::absolute(file).unwrap_or_else(|_| file.clone()),
                };
                files.push((name.display().to_string(), STANDARD.encode(load(file)?)));
            }
        }
        let open = format!("{}-run.toml", run.case.name);
        files.push((open.clone(), STANDARD.encode(run_file::written_in(&run, &folder)?)));
        Ok(Content { title: run.case.title.clone(), open, files })
    }

    /// A lesson of the tour by its name, or one in a file.
    ///
    /// # Errors
    /// There is none, or it cannot be read.
    pub fn of_lesson(name: &str) -> Result<Content, Fault> {
        let found = super::lesson::found(name)?;
        if tour::title(name).is_some() {
            let lesson = Some(LessonPlace { name: name.to_owned(), part: 0 });
            let open = Link { lesson, ..Link::default() }.text()?;
            return Ok(Content { title: found.title, open, files: Vec::new() });
        }
        let path = Path::new(name);
        let open = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let mut files = vec![(open.clone(), STANDARD.encode(load(path)?))];
        if let Some(case) = &found.case_file {
            let file = path.parent().unwrap_or(Path::new("")).join(case);
            files.push((case.display().to_string(), STANDARD.encode(load(&file)?)));
        }
        Ok(Content { title: found.title, open, files })
    }

    /// The page that shows it.
    ///
    /// # Errors
    /// The template is not a page of the program.
    pub fn within(&self, template: &str) -> Result<String, Fault> {
        // No text of it ends the script in which it stands.
        let json = serde_json::to_string(self).unwrap_or_default().replace('<', "\\u003c");
        let filled = between(template, CONTENT, &json).and_then(|page| {
            let title = format!("{} – quadfront", escaped(&self.title));
            between(&page, TITLE, &title)
        });
        filled.ok_or_else(|| {
            Fault::new("The page of the program has no place for what it shows")
                .at(TEMPLATE)
                .remedy("make web makes it anew")
        })
    }
}

/// A text with what stands between two marks replaced; `None` where the marks are missing.
fn between(text: &str, [begin, end]: [&str; 2], new: &str) -> Option<String> {
    let (before, rest) = text.split_once(begin)?;
    let (_, after) = rest.split_once(end)?;
    Some([before, begin, new, end, after].concat())
}

/// The page of the program, which lies beside it or where a build of it has put it.
///
/// # Errors
/// There is none.
pub(super) fn template() -> Result<String, Fault> {
    let program = std::env::current_exe().ok();
    let beside = program.iter().filter_map(|program| program.parent());
    let places = beside.flat_map(|folder| {
        // Beside the program, in a package, and in a working copy with its `target/release`.
        ["", "../share/quadfront", "../../out/web"].map(|place| folder.join(place).join(TEMPLATE))
    });
    let mut found = places.filter(|path| is_file(path));
    let Some(path) = found.next() else {
        return Err(Fault::new(format!("This quadfront has no {TEMPLATE}, the program as a page"))
            .remedy("make web makes it, in out/web: put it beside the program; packages of quadfront have it"));
    };
    load_text(&path)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::run::shown::fingerprint;

    const PAGE: &str = "<title>quadfront</title><script type=\"application/json\" id=\"content\"></script><p>";

    fn content_of(page: &str) -> Content {
        let json = page.split_once(CONTENT[0]).and_then(|rest| rest.1.split_once(CONTENT[1])).unwrap().0;
        serde_json::from_str(json).unwrap()
    }

    fn shown() -> ShownState {
        let case = built_in::named("figure-14").unwrap().unwrap();
        let made = crate::core::convert::background(&case, &mut crate::core::progress::Nobody).unwrap();
        let phase = crate::core::convert::Phase::Select;
        ShownState { step: 3, at: Some(Stop::Step(3)), state: fingerprint(&made.mesh, &phase) }
    }

    #[test]
    fn a_page_carries_what_it_shows_whatever_characters_that_has() {
        let content = Content {
            title: "A </script> & <b>".to_owned(),
            open: "#lesson=figure-14".to_owned(),
            files: vec![("</script>".to_owned(), STANDARD.encode("</script>"))],
        };
        let page = content.within(PAGE).unwrap();
        assert_eq!(content_of(&page), content);
        assert!(
            page.starts_with("<title>A &lt;/script&gt; &amp; &lt;b&gt; – quadfront</title>") && page.ends_with("<p>")
        );
        // A page that has content already gets the new one.
        let again = Content { open: "b".to_owned(), ..Content::default() };
        assert_eq!(content_of(&again.within(&page).unwrap()), again);
        assert!(content.within("<title></title>").unwrap_err().remedy.contains("make web"));
    }

    #[test]
    fn a_run_of_a_mesh_brings_the_mesh_along() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.obj");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n").unwrap();
        let run = Run::of(crate::core::case::Case::of_mesh(path.clone(), None));
        let content = Content::of_run(&run, shown()).unwrap();
        let names: Vec<&str> = content.files.iter().map(|file| file.0.as_str()).collect();
        assert_eq!((names, content.open.as_str()), (vec!["two.obj", "two-run.toml"], "two-run.toml"));
        // In another folder, as in the memory of a page, the run finds its mesh.
        let other = tempfile::tempdir().unwrap();
        for (name, bytes) in &content.files {
            std::fs::write(other.path().join(name), STANDARD.decode(bytes).unwrap()).unwrap();
        }
        std::fs::remove_file(&path).unwrap();
        let read = run_file::read(&other.path().join(&content.open)).unwrap();
        assert_eq!(read.shown.unwrap().states, [shown()]);

        let gltf = Run::of(crate::core::case::Case::of_mesh("plate.gltf".into(), None));
        assert!(Content::of_run(&gltf, shown()).unwrap_err().remedy.contains(".glb"));
    }

    #[test]
    fn a_lesson_of_ones_own_brings_its_case_along() {
        let folder = tempfile::tempdir().unwrap();
        let case = built_in::all().find(|case| case.0 == "figure-3").unwrap();
        std::fs::write(folder.path().join("mine.toml"), case.1).unwrap();
        let text = tour::TEMPLATE.replace("case = \"figure-3\"", "case = \"mine.toml\"");
        assert!(text.contains("mine.toml"), "the template has another case");
        let path = folder.path().join("mine.md");
        std::fs::write(&path, text).unwrap();
        let content = Content::of_lesson(path.to_str().unwrap()).unwrap();
        let names: Vec<&str> = content.files.iter().map(|file| file.0.as_str()).collect();
        assert_eq!((names, content.open.as_str()), (vec!["mine.md", "mine.toml"], "mine.md"));
        let of_tour = Content::of_lesson("figure-14").unwrap();
        assert_eq!((of_tour.open.as_str(), of_tour.files.len()), ("#lesson=figure-14", 0));
    }
}
