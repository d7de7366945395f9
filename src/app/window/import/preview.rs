//! What reads a mesh beside the window, repairs it, finds its features and charts, and draws them. Of several requests
//! the latest counts: work on an earlier one is stopped.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use glam::DVec3;
use web_time::Instant;

use crate::app::input;
use crate::app::tasks::{self, Post, Serve};
use crate::app::window::session::{EVERY, Wake, words_of};
use crate::app::window::state::Progress;
use crate::app::window::theme;
use crate::core::case::ImportOptions;
use crate::core::discrete::census::count_of;
use crate::core::discrete::chart::charts;
use crate::core::discrete::features::{features, with_lines};
use crate::core::discrete::repair::{repair, unrepaired};
use crate::core::discrete::{Census, Division, Edges, Feature, Repaired, StretchBound, Triangles};
use crate::core::fault::Fault;
use crate::core::formats::format::read_mesh_watched;
use crate::core::progress::{Cancel, Stage, Watch};
use crate::core::record::Export;
use crate::core::soup::{MeshFile, Weld};
use crate::core::{convert, step};
use crate::render::scene::{Given, Scene};

/// Kinds of features, in the order in which they are listed.
pub const KINDS: [Feature; 6] =
    [Feature::Fold, Feature::Region, Feature::Line, Feature::Boundary, Feature::Branching, Feature::Conflict];

/// A surface with more triangles than this is shown with its features before its charts are known.
const LARGE: usize = 20_000;

/// A mesh that has been read and repaired.
pub struct Loaded {
    pub mesh: Triangles,
    edges: Edges,
    pub census: Census,
    /// Whether it lies in the plane z = 0.
    pub is_plane: bool,
    /// Whether sizes are given at its points.
    pub has_metric: bool,
    /// How many regions it has.
    pub regions: usize,
    /// Whether it has named groups.
    pub has_groups: bool,
    /// What was repaired, and what was not read.
    pub repairs: Vec<String>,
    /// The mean length of its edges.
    pub mean_edge: f64,
    /// Its extent along the axes.
    pub extent: DVec3,
    /// Why it cannot be converted with any options; then the mesh is as in the file.
    pub fault: Option<Fault>,
    /// The part, where the file is a CAD file; then the mesh is its background mesh.
    pub part: Option<PartFacts>,
}

/// What is told of a part of a CAD file.
pub struct PartFacts {
    pub faces: usize,
    pub edges: usize,
    pub bodies: usize,
    /// The unit of its lengths.
    pub unit: String,
}

/// The options of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// In radians.
    pub feature_angle: f64,
    /// How far charts may be stretched; none if it has no charts.
    pub bound: Option<StretchBound>,
    /// The elements for which it is refused, by their corners.
    pub marks: Arc<[Vec<DVec3>]>,
    pub dark: bool,
}

/// A picture, with what it shows.
pub struct Shown {
    pub wanted: Wanted,
    /// How many edges are features of each kind, as [`KINDS`] has them.
    pub counts: [usize; KINDS.len()],
    /// The charts; none if they are not known yet or do not exist.
    pub division: Option<Arc<Division>>,
    pub scene: Arc<Scene>,
}

/// What is reported.
pub enum PreviewNews {
    Progress(Progress),
    Loaded(Result<Arc<Loaded>, Fault>),
    Shown(Arc<Shown>),
    /// It cannot be shown with these options.
    Refused(Fault),
}

struct Ask {
    wanted: Wanted,
    generation: u64,
    cancel: Cancel,
}

/// What reads and draws.
pub struct Preview {
    ask: Post<Ask>,
    told: Receiver<PreviewNews>,
    /// Ends what is under way.
    cancel: Cancel,
}

impl Preview {
    /// Starts to read a mesh without the groups that are ignored, or a CAD file; `wake` is called when there is
    /// something to hear.
    pub fn of(path: PathBuf, options: ImportOptions, wake: Wake) -> Preview {
        let (tell, told) = channel();
        let cancel = Cancel::new();
        let reading = cancel.clone();
        let (ask, _) = tasks::serve(move |_| {
            let mut voice = Voice { tell, wake, cancel: reading, last: None };
            let loaded = load(&path, &options, &mut voice).map(Arc::new);
            let read = loaded.as_ref().ok().cloned();
            if !matches!(&loaded, Err(fault) if fault.is_stop()) {
                voice.say(PreviewNews::Loaded(loaded));
            }
            Some(Work { loaded: read?, features: None, division: None, voice })
        });
        Preview { ask, told, cancel }
    }

    /// Asks for a picture in place of the one asked for before. It has this generation; an interim picture has the one
    /// before.
    pub fn ask(&mut self, wanted: Wanted, generation: u64) {
        self.cancel.ask();
        self.cancel = Cancel::new();
        self.ask.send(Ask { wanted, generation, cancel: self.cancel.clone() });
    }

    /// What has been reported since the last call.
    pub fn hear(&self) -> Vec<PreviewNews> {
        self.told.try_iter().collect()
    }
}

impl Drop for Preview {
    fn drop(&mut self) {
        self.cancel.ask();
    }
}

struct Voice {
    tell: Sender<PreviewNews>,
    wake: Wake,
    cancel: Cancel,
    last: Option<(Stage, Instant)>,
}

impl Voice {
    fn say(&self, told: PreviewNews) {
        // Nobody listens any more: the window has given up the import.
        let _ = self.tell.send(told);
        (self.wake)();
    }
}

impl Watch for Voice {
    fn tell(&mut self, stage: Stage, done: u64, total: u64) {
        if self.last.is_some_and(|(last, since)| last == stage && since.elapsed() < EVERY) {
            return;
        }
        self.last = Some((stage, Instant::now()));
        self.say(PreviewNews::Progress(Progress { words: words_of(stage), done, total }));
    }

    fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }
}

/// Reads a CAD file: its background mesh, and what was told of it.
fn load_part(
    path: &Path,
    options: &ImportOptions,
    voice: &mut Voice,
) -> Result<(MeshFile, PartFacts, Vec<String>), Fault> {
    let (case, part) = input::read_step(path, options, voice)?;
    let background = convert::background(&case, voice)?;
    let facts =
        PartFacts { faces: part.spec.faces.len(), edges: part.spec.curves.len(), bodies: part.bodies, unit: part.unit };
    Ok((Export::of(&background.mesh, &background.names).file, facts, background.repairs))
}

fn load(path: &Path, options: &ImportOptions, voice: &mut Voice) -> Result<Loaded, Fault> {
    let (mut file, part) = if step::is_step(path) {
        let (file, facts, told) = load_part(path, options, voice)?;
        (file, Some((facts, told)))
    } else {
        (read_mesh_watched(path, None, voice)?, None)
    };
    let ignored = &options.ignore_groups;
    let place = |fault: Fault| if fault.is_stop() { fault } else { fault.at(path.display().to_string()) };
    file.ignore_groups(ignored).map_err(place)?;
    let scale = options.scale.unwrap_or(1.0);
    // A part is what its surfaces are.
    let weld = if part.is_none() { options.weld.before_scaling(scale) } else { Weld::Within(0.0) };
    let welded = file.weld(weld, &voice.cancel).map_err(place)?;
    let mut told = Vec::new();
    welded.scaled(scale).report(&mut told);
    let (is_plane, has_metric, has_groups) = (file.is_plane(), file.metric.is_some(), !file.groups.is_empty());
    let mut not_read = file.not_read();
    let (mut found, fault) = match repair(&file, welded.tolerance, voice) {
        Ok(found) => (found, None),
        Err(fault) if fault.is_stop() => return Err(fault),
        Err(fault) => {
            let mesh = unrepaired(&file);
            if mesh.triangles.is_empty() {
                return Err(place(fault));
            }
            let nothing =
                Repaired { mesh, copied: vec![], regions: vec![], lines: vec![], points: vec![], repairs: vec![] };
            (nothing, Some(fault))
        }
    };
    drop(file);
    found.repairs.splice(0..0, told);
    found.repairs.append(&mut not_read);
    let part = part.map(|(facts, told)| {
        found.repairs = told;
        facts
    });
    let edges = Edges::of(&found.mesh.triangles);
    voice.cancel.check()?;
    let census = Census::of(&found.mesh, &edges);
    let points = &found.mesh.points;
    let length = |edge: usize| {
        let [a, b] = edges.get(edge).ends.map(|end| points[end as usize]);
        a.distance(b)
    };
    let mean_edge = (0..edges.len()).map(length).sum::<f64>() / edges.len().max(1) as f64;
    let used = found.mesh.triangles.as_flattened().iter().map(|&k| points[k as usize]);
    let ends = used.map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let extent = ends.map_or(DVec3::ZERO, |[low, high]| high - low);
    let (regions, repairs) = (found.regions.len(), found.repairs);
    Ok(Loaded {
        mesh: found.mesh,
        edges,
        census,
        is_plane,
        has_metric,
        regions,
        has_groups,
        repairs,
        mean_edge,
        extent,
        fault,
        part,
    })
}

/// What is known of the mesh, and for which options it was computed.
struct Work {
    loaded: Arc<Loaded>,
    features: Option<(f64, Arc<[Option<Feature>]>)>,
    division: Option<(f64, StretchBound, Arc<Division>)>,
    voice: Voice,
}

impl Serve<Ask> for Work {
    fn hear(&mut self, ask: Ask, later: &Receiver<Ask>) -> ControlFlow<()> {
        let ask = later.try_iter().last().unwrap_or(ask);
        self.voice.cancel = ask.cancel.clone();
        // A request that was stopped has no picture: there is a later one.
        if let Err(fault) = self.show(&ask)
            && !fault.is_stop()
        {
            self.voice.say(PreviewNews::Refused(fault));
        }
        ControlFlow::Continue(())
    }
}

impl Work {
    fn show(&mut self, ask: &Ask) -> Result<(), Fault> {
        let Ask { wanted, generation, cancel } = ask;
        let loaded = self.loaded.clone();
        let Loaded { mesh, edges, .. } = &*loaded;
        let angle = wanted.feature_angle;
        let features = match &self.features {
            Some((of, features)) if *of == angle => features.clone(),
            _ => {
                let found: Arc<[Option<Feature>]> = with_lines(features(mesh, edges, angle), mesh, edges).into();
                self.features = Some((angle, found.clone()));
                found
            }
        };
        let picture = |division: Option<Arc<Division>>, generation: u64| {
            let palette = theme::palette(wanted.dark);
            let given = Given {
                mesh,
                edges,
                features: &features,
                division: division.as_deref(),
                marks: &wanted.marks,
                palette,
            };
            let scene = Scene::of_given(&given, generation, cancel).ok_or_else(Fault::stopped)?;
            let counts = KINDS.map(|kind| count_of(&features, kind));
            Ok::<_, Fault>(Shown { wanted: wanted.clone(), counts, division, scene: Arc::new(scene) })
        };
        let division = match (&self.division, wanted.bound) {
            (_, None) => None,
            (Some((of, bound, division)), Some(wanted)) if (*of, *bound) == (angle, wanted) => Some(division.clone()),
            (_, Some(bound)) => {
                if mesh.triangles.len() > LARGE {
                    // An interim picture, without charts, does not answer the request.
                    let mut first = picture(None, generation - 1)?;
                    first.wanted.bound = None;
                    self.voice.say(PreviewNews::Shown(Arc::new(first)));
                }
                let division = if loaded.part.is_some() {
                    Division::of_regions(mesh, edges, &features)
                } else {
                    Division::of(mesh, edges, &features, &charts(mesh, edges, &features, bound, &mut self.voice)?)
                };
                let division = Arc::new(division);
                self.division = Some((angle, bound, division.clone()));
                Some(division)
            }
        };
        let shown = picture(division, *generation)?;
        self.voice.say(PreviewNews::Shown(Arc::new(shown)));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn wish(degrees: f64) -> Wanted {
        let marks = Arc::default();
        Wanted { feature_angle: degrees.to_radians(), bound: Some(StretchBound::default()), marks, dark: true }
    }

    /// What comes within a while.
    fn next(preview: &Preview, mut is_it: impl FnMut(&PreviewNews) -> bool) -> Option<PreviewNews> {
        let begin = Instant::now();
        while begin.elapsed() < Duration::from_secs(60) {
            match preview.told.recv_timeout(Duration::from_millis(500)) {
                Ok(told) if is_it(&told) => return Some(told),
                Ok(_) => {}
                Err(_) if begin.elapsed() > Duration::from_secs(20) => return None,
                Err(_) => {}
            }
        }
        None
    }

    /// A tetrahedron as text.
    fn tetrahedron(folder: &Path) -> PathBuf {
        let path = folder.join("a.obj");
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
        std::fs::write(&path, text).unwrap();
        path
    }

    #[test]
    fn of_many_wishes_the_last_one_is_shown() {
        let folder = tempfile::tempdir().unwrap();
        let mut preview = Preview::of(tetrahedron(folder.path()), ImportOptions::default(), Arc::new(|| {}));
        assert!(
            next(&preview, |told| matches!(told, PreviewNews::Loaded(Ok(loaded)) if loaded.census.nodes == 4))
                .is_some()
        );
        for k in 1..=150 {
            preview.ask(wish(f64::from(k)), 2 * k as u64);
        }
        let mut shown = 0;
        let last = next(&preview, |told| {
            shown += usize::from(matches!(told, PreviewNews::Shown(_)));
            matches!(told, PreviewNews::Shown(shown) if shown.wanted == wish(150.0))
        });
        let Some(PreviewNews::Shown(last)) = last else { panic!("no picture of the last wish") };
        assert_eq!((last.scene.generation, last.division.as_ref().unwrap().charts > 1), (300, true));
        assert_eq!(last.counts, [0; KINDS.len()], "no fold is beyond 150 degrees");
        assert!(shown < 150, "{shown}");
    }

    #[test]
    fn a_file_that_is_none_is_told_with_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("b.obj");
        std::fs::write(&path, "v 0 0 0\nf 1 2 3\n").unwrap();
        let preview = Preview::of(path, ImportOptions::default(), Arc::new(|| {}));
        let told = next(&preview, |told| matches!(told, PreviewNews::Loaded(Err(_))));
        let Some(PreviewNews::Loaded(Err(fault))) = told else { panic!("no complaint") };
        assert!(fault.place.contains("b.obj, line 2") && fault.what.contains("vertex 3"), "{fault}");
    }
}
