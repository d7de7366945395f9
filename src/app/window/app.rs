//! The window as eframe runs it: hears the session, turns keys into commands, shows the panels.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use eframe::egui::{self, Context, Frame, Key, Modifiers, Panel, Ui, ViewportCommand};
use eframe::{CreationContext, wgpu};

use super::autosave::Autosave;
use super::command::{Command, keys};
use super::files::{Answer, Watcher, free_path, write_png};
use super::graphics::{self, Lost};
use super::layout::Layout;
use super::panels;
use super::session::{Goal, Source};
use super::settings::{BOTTOM, Settings};
use super::state::{Over, State};
use super::theme;
use super::viewport::Views;
use crate::render::palette::Palette;

/// How long a notice is shown.
const NOTICE: Duration = Duration::from_secs(6);
/// How long after a change it is kept how the window is.
const SETTLED: Duration = Duration::from_millis(1500);

/// The window.
pub struct App {
    /// What it knows.
    pub state: State,
    views: Views,
    layout: Layout,
    /// What the last frame asked for.
    commands: Vec<Command>,
    taken: Arc<Mutex<Option<Arc<egui::ColorImage>>>>,
    /// Whether the last frame asked for this one at once.
    moving: bool,
    lost: Lost,
    /// Whether somebody clears the window in the colour of panels.
    is_cleared: bool,
    /// Where it is kept how the window was left, and what stands there.
    path: Option<PathBuf>,
    written: Option<Settings>,
    /// Since when it is other than what stands there.
    changed: Option<Instant>,
}

impl App {
    /// A window on `source`; on nothing where that is none.
    pub fn new(cc: &CreationContext<'_>, source: Option<Source>) -> App {
        App::kept(cc, source, None, Lost::default())
    }

    /// The same, as the last one was left: what is kept of it is at `path`. `lost` hears whether the graphics device is
    /// lost.
    pub fn kept(cc: &CreationContext<'_>, source: Option<Source>, path: Option<PathBuf>, lost: Lost) -> App {
        theme::install(&cc.egui_ctx);
        let context = cc.egui_ctx.clone();
        if let Some(render) = &cc.wgpu_render_state {
            graphics::install_painter(render);
            let context = context.clone();
            lost.listen(&render.device, move || context.request_repaint());
        }
        let mut state = State::new(Arc::new(move || context.request_repaint()));
        let mut layout = Layout::default();
        let read = path.as_deref().map_or(Ok(None), Settings::read);
        let settings = read.unwrap_or_else(|fault| {
            state.complain(&fault);
            None
        });
        cc.egui_ctx.set_theme(match &settings {
            Some(settings) if !settings.dark => egui::Theme::Light,
            _ => egui::Theme::Dark,
        });
        if let Some(settings) = &settings {
            settings.give(&mut state);
            layout.arrange(Some(&settings.docks));
        }
        if let Some(source) = source {
            state.open(source);
        }
        App {
            state,
            views: Views::default(),
            layout,
            commands: Vec::new(),
            taken: Arc::default(),
            moving: false,
            lost,
            is_cleared: false,
            path,
            written: settings,
            changed: None,
        }
    }

    /// The same in a program that was started then.
    pub fn started(mut self, at: Instant) -> App {
        self.state.times.started = Some(at);
        self
    }

    /// The same in a window that is cleared as [`eframe::App::clear_color`] says.
    pub fn cleared(mut self) -> App {
        self.is_cleared = true;
        self
    }

    /// The same, which keeps its run in a folder while it is worked on and offers what was left there.
    #[must_use]
    pub fn keeping(mut self, folder: Option<PathBuf>) -> App {
        self.state.autosave = folder.map(|folder| Autosave::new(folder, self.state.wake.clone()));
        self
    }

    /// Keeps the run, and hears of files: those that change and those that are written.
    fn files(&mut self, context: &Context) {
        if let Some(mut autosave) = self.state.autosave.take() {
            let (opened, source) = (self.state.opened.clone(), self.state.source.clone());
            let (faults, again) = autosave.look(opened.as_ref(), source.as_ref(), || self.state.run());
            faults.iter().for_each(|fault| self.state.complain(fault));
            if let Some(again) = again {
                context.request_repaint_after(again);
            }
            self.state.autosave = Some(autosave);
        }
        self.state.hear_figures();
        self.state.hear_saving();
        match self.state.watcher.as_ref().and_then(Watcher::news) {
            Some(Ok(name)) => self.state.notice(format!("{name} has changed: Ctrl+R opens it again.")),
            Some(Err(fault)) => self.state.complain(&fault),
            None => {}
        }
    }

    /// Does what a person asks for.
    pub fn apply(&mut self, command: Command) {
        self.state.apply(command);
    }

    fn keys(&mut self, context: &Context) {
        let typing = context.egui_wants_keyboard_input();
        for (modifiers, key, command) in keys() {
            let bare = modifiers.is_none() || modifiers == Modifiers::SHIFT;
            if bare && typing && command != Command::Escape {
                continue;
            }
            if context.input_mut(|input| input.consume_key(modifiers, key)) {
                self.commands.push(command);
            }
        }
        if !typing && context.input(|input| input.key_pressed(Key::Questionmark)) {
            self.commands.push(Command::Help);
        }
    }

    fn play(&mut self, context: &Context) {
        let Some(last) = self.state.playing else { return };
        let period = Duration::from_secs_f32(1.0 / self.state.speed.max(0.1));
        if self.state.is_busy() {
            return;
        }
        let waited = last.elapsed();
        if waited >= period {
            self.state.playing = Some(Instant::now());
            self.state.apply(Command::Go(Goal::Quads(1)));
        } else {
            context.request_repaint_after(period - waited);
        }
    }

    /// How the window is to be found again.
    fn settings(&self, context: &Context) -> Settings {
        let size = context
            .input(|input| input.viewport().inner_rect)
            .map(|rect| [rect.width().round(), rect.height().round()]);
        Settings::of(&self.state, context.theme() == egui::Theme::Dark, size, self.layout.arranged())
    }

    /// Keeps how the window is, a moment after it was changed.
    fn keep(&mut self, context: &Context, at_once: bool) {
        let Some(path) = self.path.clone() else { return };
        let now = self.settings(context);
        if self.written.as_ref() == Some(&now) {
            self.changed = None;
            return;
        }
        let since = *self.changed.get_or_insert_with(Instant::now);
        match SETTLED.checked_sub(since.elapsed()) {
            Some(left) if !at_once && !left.is_zero() => context.request_repaint_after(left),
            _ => {
                if let Err(fault) = now.write(&path) {
                    self.state.complain(&fault);
                }
                // What cannot be written is not tried again until it changes.
                (self.written, self.changed) = (Some(now), None);
            }
        }
    }

    /// Where the graphics device is lost, saves the run and closes the window.
    fn graphics(&mut self, context: &Context) {
        if let Some(fault) = self.lost.refused() {
            self.state.complain(&fault);
        }
        if self.lost.reason().is_some() && !std::mem::replace(&mut self.state.is_lost, true) {
            self.lost.save_was(self.state.save_run());
            context.send_viewport_cmd(ViewportCommand::Close);
        }
    }

    /// Steps on and back where that is being measured.
    fn measure(&mut self, context: &Context, frame: &eframe::Frame) {
        let busy = self.state.is_busy();
        let took = self.state.moment.as_ref().map_or(Duration::ZERO, |moment| moment.took);
        let end = self.state.track.len() as u64;
        let Some(measuring) = &mut self.state.measuring else { return };
        context.request_repaint();
        if let Some(render) = frame.wgpu_render_state() {
            // A frame is done when the card is.
            let _ = render.device.poll(wgpu::PollType::wait_indefinitely());
        }
        if let Some(goal) = measuring.next(!busy, took, end) {
            self.state.apply(Command::Go(goal));
        } else if let Some(told) = measuring.told() {
            println!("{told}");
            self.state.measuring = None;
            self.state.notice(told);
        }
    }

    fn dialogs(&mut self, context: &Context) {
        let answer = self.state.dialog.as_ref().map(|dialog| dialog.answer());
        match answer {
            None => {}
            Some(Answer::Waiting) => context.request_repaint_after(Duration::from_secs(1)),
            Some(answer) => {
                self.state.dialog = None;
                match answer {
                    Answer::File(path) => self.commands.push(Command::Open(Source::File(path))),
                    Answer::Missing => {
                        self.state.overlay = Over::Path;
                        self.state.notice("The system has no file dialog: type the path.".to_owned());
                    }
                    Answer::Nothing | Answer::Waiting => {}
                }
            }
        }
        let dropped = context.input(|input| input.raw.dropped_files.first().map(|file| file.path().to_path_buf()));
        if let Some(path) = dropped {
            self.commands.push(Command::Open(Source::File(path)));
        }
    }

    fn screenshots(&mut self, context: &Context) {
        if std::mem::take(&mut self.state.screenshot) {
            let (taken, wake) = (self.taken.clone(), context.clone());
            context.request_screenshot(move |image| {
                if let Ok(mut taken) = taken.lock() {
                    *taken = Some(image);
                }
                wake.request_repaint();
            });
        }
        let image = self.taken.lock().ok().and_then(|mut taken| taken.take());
        if let Some(image) = image {
            let path = free_path("quadfront-window", "png");
            match write_png(&path, &image, self.state.carried()) {
                Ok(()) => self.state.notice(format!("The window was saved as {}.", path.display())),
                Err(fault) => self.state.complain(&fault),
            }
        }
    }
}

/// Transport, timeline, docks and what floats over them: the window on a run.
fn docks(
    ui: &mut Ui,
    state: &mut State,
    views: &mut Views,
    layout: &mut Layout,
    commands: &mut Vec<Command>,
    palette: &'static Palette,
    plain: Frame,
) {
    // A window that has no room for the timeline does not make it forget its height.
    let squashed = ui.available_height() < state.bottom + BOTTOM[0];
    let time = Panel::bottom(if squashed { "time squashed" } else { "time" })
        .frame(plain)
        .default_size(state.bottom)
        .size_range(BOTTOM[0]..=BOTTOM[1])
        .resizable(true)
        .show(ui, |ui| panels::time::show(ui, state, commands, palette));
    if !squashed {
        state.bottom = time.response.rect.height();
    }
    panels::offer::show(ui, state, commands, palette);
    panels::messages::show(ui, state, palette);
    egui::CentralPanel::default().frame(plain).show(ui, |ui| {
        layout.show(ui, state, views, commands, palette);
    });
    panels::notes::show(ui.ctx(), state, palette);
    panels::figure::show(ui.ctx(), state, commands, palette);
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        self.state.times.frame(std::mem::take(&mut self.moving));
        self.state.times.first(self.views.has_shown());
        self.state.hear();
        self.graphics(&context);
        self.measure(&context, frame);
        self.keys(&context);
        self.dialogs(&context);
        for command in std::mem::take(&mut self.commands) {
            self.state.apply(command);
        }
        if std::mem::take(&mut self.state.toggle_theme) {
            let dark = context.theme() == egui::Theme::Dark;
            context.set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
        }
        self.state.look_at_import(context.theme() == egui::Theme::Dark);
        self.play(&context);
        self.state.hear_soon();
        self.files(&context);
        self.screenshots(&context);
        let palette = theme::palette(context.theme() == egui::Theme::Dark);
        let (state, commands) = (&mut self.state, &mut self.commands);
        // The window is cleared in the colour of panels: every layer over all of it costs where the processor paints.
        let plain = if self.is_cleared { Frame::NONE } else { Frame::NONE.fill(theme::ink(palette.panel)) };
        Panel::top("menus")
            .frame(plain)
            .exact_size(32.0)
            .show(ui, |ui| panels::top::show(ui, state, commands, palette));
        if state.import.is_some() {
            panels::offer::show(ui, state, commands, palette);
            panels::messages::show(ui, state, palette);
            panels::import::show(ui, state, plain, commands, palette);
            egui::CentralPanel::default().frame(plain).show(ui, |ui| {
                self.views.given(ui, state, commands, palette);
            });
        } else {
            docks(ui, state, &mut self.views, &mut self.layout, commands, palette, plain);
        }
        panels::over::show(&context, state, commands, palette);
        if let Some((_, since)) = &self.state.notice {
            match NOTICE.checked_sub(since.elapsed()) {
                Some(left) => context.request_repaint_after(left),
                None => self.state.notice = None,
            }
        }
        if !self.commands.is_empty() {
            context.request_repaint();
        }
        self.keep(&context, false);
        self.moving = context.has_requested_repaint();
        let title = match &self.state.opened {
            Some(opened) => format!("{} – quadfront", opened.case.name),
            None => "quadfront".to_owned(),
        };
        if self.state.title != title {
            self.state.title.clone_from(&title);
            context.send_viewport_cmd(ViewportCommand::Title(title));
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self) {
        if let (Some(path), Some(written)) = (&self.path, &self.written)
            && self.changed.is_some()
        {
            let now = Settings::of(&self.state, written.dark, written.window, self.layout.arranged());
            // The window is gone: there is nobody to tell.
            let _ = now.write(path);
        }
    }
}
