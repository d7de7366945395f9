//! Writes what the window shows as a page with the program inside.

#[cfg(target_arch = "wasm32")]
use std::sync::mpsc::channel;

use super::figures::shown;
#[cfg(not(target_arch = "wasm32"))]
use super::files;
use super::files::{Writing, free_path};
use super::session::{Source, Wake};
use super::state::State;
use crate::app::page::Content;
use crate::core::fault::Fault;
use crate::core::formats::save;

/// Starts to write the page, in the working folder, under a name that is free; none where nothing is open. It shows the
/// lesson, or else the run at the current state.
pub fn begin(state: &State, wake: Wake) -> Option<Writing> {
    let (run, moment) = (state.current_run()?, state.run().moment.clone()?);
    let lesson = match &state.run().source {
        Some(Source::Lesson(name)) if state.study().is_some() => Some(name.clone()),
        _ => None,
    };
    let content = move || match &lesson {
        Some(name) => Content::of_lesson(name),
        None => Content::of_run(&run, shown(&moment)),
    };
    Some(with_template(wake, move |template| write(&content()?, &template?)))
}

fn write(content: &Content, template: &str) -> Result<String, Fault> {
    let stem = content.open.trim_start_matches("#lesson=").trim_end_matches(".toml").trim_end_matches(".md");
    let path = free_path(stem, "html");
    let page = content.within(template)?;
    save::save(&path, |file| file.write_all(page.as_bytes()))?;
    Ok(format!("The page was saved as {}: any browser opens it.", path.display()))
}

/// Does something with the page of the program, which lies beside it.
#[cfg(not(target_arch = "wasm32"))]
fn with_template(
    wake: Wake,
    work: impl FnOnce(Result<String, Fault>) -> Result<String, Fault> + Send + 'static,
) -> Writing {
    files::work(wake, || work(crate::app::page::template()))
}

/// Does something with the page of the program, which the page that shows it has or loads.
#[cfg(target_arch = "wasm32")]
fn with_template(
    wake: Wake,
    work: impl FnOnce(Result<String, Fault>) -> Result<String, Fault> + Send + 'static,
) -> Writing {
    let (tell, told) = channel();
    wasm_bindgen_futures::spawn_local(async move {
        let template = super::web::page::template().await.map_err(|what| {
            let what = what.as_string().unwrap_or_else(|| "it cannot be loaded".to_owned());
            Fault::new(format!("The page of the program is missing: {what}"))
        });
        // Nobody listens once the window has opened something else.
        let _ = tell.send(work(template.map(|page| page.as_string().unwrap_or_default())));
        wake();
    });
    told
}
