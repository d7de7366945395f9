//! The window as eframe runs it: hears the session, turns keys into commands, shows the panels.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use eframe::egui::{self, Context, Frame, Key, Modifiers, Panel, Ui, ViewportCommand};
use eframe::{CreationContext, egui_wgpu};

use super::autosave::Autosave;
use super::command::{Command, keys};
use super::files::{Answer, Watcher, free_path, write_png};
use super::layout::Layout;
use super::panels;
use super::session::{Goal, Source};
use super::state::{Over, State};
use super::theme;
use super::viewport::Views;
use crate::render::gpu::Painter;

/// How long a notice is shown.
const NOTICE: Duration = Duration::from_secs(6);

/// The window.
pub struct App {
    /// What it knows.
    pub state: State,
    views: Views,
    layout: Layout,
    /// What the last frame asked for.
    commands: Vec<Command>,
    taken: Arc<Mutex<Option<Arc<egui::ColorImage>>>>,
}

impl App {
    /// A window on `source`; on nothing where that is none.
    pub fn new(cc: &CreationContext<'_>, source: Option<Source>) -> App {
        theme::install(&cc.egui_ctx);
        cc.egui_ctx.set_theme(egui::Theme::Dark);
        if let Some(render) = &cc.wgpu_render_state {
            install_painter(render);
        }
        let context = cc.egui_ctx.clone();
        let mut state = State::new(Arc::new(move || context.request_repaint()));
        if let Some(source) = source {
            state.open(source);
        }
        App { state, views: Views::default(), layout: Layout::default(), commands: Vec::new(), taken: Arc::default() }
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

/// Makes the painter known to egui's renderer.
fn install_painter(render: &egui_wgpu::RenderState) {
    let painter = Painter::new(&render.device, render.target_format);
    render.renderer.write().callback_resources.insert(painter);
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        self.state.hear();
        self.keys(&context);
        self.dialogs(&context);
        for command in std::mem::take(&mut self.commands) {
            self.state.apply(command);
        }
        if std::mem::take(&mut self.state.toggle_theme) {
            let dark = context.theme() == egui::Theme::Dark;
            context.set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
        }
        self.play(&context);
        self.files(&context);
        self.screenshots(&context);
        let palette = theme::palette(context.theme() == egui::Theme::Dark);
        let (state, commands) = (&mut self.state, &mut self.commands);
        let plain = Frame::NONE.fill(theme::ink(palette.panel));
        Panel::top("menus")
            .frame(plain)
            .exact_size(32.0)
            .show(ui, |ui| panels::top::show(ui, state, commands, palette));
        Panel::bottom("time")
            .frame(plain)
            .default_size(216.0)
            .size_range(120.0..=420.0)
            .resizable(true)
            .show(ui, |ui| panels::time::show(ui, state, commands, palette));
        panels::offer::show(ui, state, commands, palette);
        panels::messages::show(ui, state, palette);
        let ground = Frame::NONE.fill(theme::ink(palette.line));
        egui::CentralPanel::default().frame(ground).show(ui, |ui| {
            self.layout.show(ui, state, &mut self.views, commands, palette);
        });
        panels::notes::show(&context, state, palette);
        panels::figure::show(&context, state, commands, palette);
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
        let title = match &self.state.opened {
            Some(opened) => format!("{} – quadfront", opened.case.name),
            None => "quadfront".to_owned(),
        };
        if self.state.title != title {
            self.state.title.clone_from(&title);
            context.send_viewport_cmd(ViewportCommand::Title(title));
        }
    }
}
