//! The window as eframe runs it: takes in what the session reports, turns keys into commands, shows the panels.

use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use eframe::egui::{self, Context, Frame, Key, Panel, Popup, RawInput, Ui, ViewportCommand};
use eframe::{CreationContext, wgpu};
use web_time::Instant;

use super::clips::FewerClips;
use super::command::{Command, keys_in, keys_of_study};
use super::figures::carried;
use super::files::{free_path, write_png};
use super::graphics::{self, Lost};
use super::layout::{Docks, Layout, Pane, TIMELINE_HEIGHTS};
use super::panels::{self, PanelStates};
use super::presentation::Chrome;
use super::presses::{self, Presses};
use super::session::Source;
use super::settings::Settings;
use super::state::State;
use super::theme;
use super::viewport::Views;
#[cfg(target_arch = "wasm32")]
use super::web;

/// How long after a change the settings are written.
const SETTLED: Duration = Duration::from_millis(1500);

/// How often the window asks a file dialog for its answer.
const DIALOG: Duration = Duration::from_secs(1);

/// The window.
pub struct App {
    /// What the window knows.
    pub state: State,
    /// The views of each run, and what the panels keep of it.
    views: [Views; 2],
    layout: Layout,
    panels: [PanelStates; 2],
    presses: Presses,
    taken: Arc<Mutex<Option<Arc<egui::ColorImage>>>>,
    /// Whether the last frame asked for this one at once.
    moving: bool,
    lost: Lost,
    /// Whether the loss has been dealt with.
    is_lost: bool,
    /// The title that the window has.
    title: String,
    /// Whether eframe clears the window in the colour of the panels.
    is_cleared: bool,
    /// The file of the settings, and the settings that it has.
    path: Option<PathBuf>,
    written: Option<Settings>,
    /// Since when the settings differ from those in the file.
    changed: Option<Instant>,
}

impl App {
    /// A window on `source`, if there is one.
    pub fn new(cc: &CreationContext<'_>, source: Option<Source>) -> App {
        App::kept(cc, source, None, Lost::default())
    }

    /// The same with the settings in the file at `path`. `lost` notices when the graphics device is lost.
    pub fn kept(cc: &CreationContext<'_>, source: Option<Source>, path: Option<PathBuf>, lost: Lost) -> App {
        theme::install(&cc.egui_ctx);
        cc.egui_ctx.add_plugin(FewerClips);
        let context = cc.egui_ctx.clone();
        if let Some(render) = &cc.wgpu_render_state {
            graphics::install_painter(render);
            let context = context.clone();
            lost.listen(&render.device, move || context.request_repaint());
        }
        let (settings, fault) = match path.as_deref().map_or(Ok(None), Settings::read) {
            Ok(settings) => (settings, None),
            Err(fault) => (None, Some(fault)),
        };
        cc.egui_ctx.set_theme(match &settings {
            Some(settings) if !settings.dark => egui::Theme::Light,
            _ => egui::Theme::Dark,
        });
        let workspace = settings.as_ref().map(Settings::workspace).unwrap_or_default();
        let mut state = State::new(Arc::new(move || context.request_repaint()), workspace);
        if let Some(fault) = fault {
            state.complain(&fault);
        }
        if let Some(source) = source {
            state.apply(Command::Open(source));
        }
        App {
            state,
            views: [0, 1].map(Views::of_run),
            layout: settings.as_ref().map(Settings::layout).unwrap_or_default(),
            panels: Default::default(),
            presses: Presses::default(),
            taken: Arc::default(),
            moving: false,
            lost,
            is_lost: false,
            title: String::new(),
            is_cleared: false,
            path,
            written: settings,
            changed: None,
        }
    }

    /// The same in a program that was started at this time.
    pub fn started(mut self, at: Instant) -> App {
        self.panels[0].time.times.started = Some(at);
        self
    }

    /// The same in a window that is cleared as [`eframe::App::clear_color`] says.
    pub fn cleared(mut self) -> App {
        self.is_cleared = true;
        self
    }

    /// The same, which autosaves its run in a folder and offers abandoned runs from it.
    #[must_use]
    pub fn keeping(mut self, folder: Option<PathBuf>) -> App {
        if let Some(folder) = folder {
            self.state.autosave_in(folder);
        }
        self
    }

    /// Does what the user asks for.
    pub fn apply(&mut self, command: Command) {
        self.state.apply(command);
    }

    /// Whether the graphics device was lost and the window is about to close.
    pub fn is_lost(&self) -> bool {
        self.is_lost
    }

    /// Does what keys and files that are dropped on the window ask for.
    fn input(&mut self, context: &Context) {
        let mut commands = self.keys(context);
        let dropped = context.input(|input| input.raw.dropped_files.clone());
        #[cfg(not(target_arch = "wasm32"))]
        commands.extend(dropped.first().map(|file| Command::Open(Source::of_file(file.path().to_path_buf()))));
        #[cfg(target_arch = "wasm32")]
        {
            if !dropped.is_empty() {
                web::open_dropped(dropped, context);
            }
            for asked in web::asked() {
                match asked {
                    Ok(command) => commands.push(command),
                    Err(fault) => self.state.complain(&fault),
                }
            }
        }
        commands.into_iter().for_each(|command| self.state.apply(command));
    }

    fn keys(&self, context: &Context) -> Vec<Command> {
        let typing = context.egui_wants_keyboard_input();
        let (busy, chrome) = (self.state.run().is_busy(), self.state.chrome());
        let known = match self.state.study().filter(|_| chrome == Chrome::Panels) {
            Some(study) => {
                let writes = self.state.open_question().is_some_and(|posed| posed.asked.kind.choices().is_empty());
                keys_of_study(study.explores, self.state.steps_by_operation(), writes && !study.explores)
            }
            None => keys_in(chrome),
        };
        let mut commands = context.input_mut(|input| presses::commands(&mut input.events, &known, typing, busy));
        if commands.contains(&Command::Escape) && Popup::is_any_open(context) {
            // A menu with all its submenus.
            Popup::close_all(context);
            commands.retain(|command| *command != Command::Escape);
        }
        if !typing && context.input(|input| input.key_pressed(Key::Questionmark)) {
            commands.push(Command::Help);
        }
        commands
    }

    /// The current settings.
    fn settings(&self, context: &Context) -> Settings {
        let size = context
            .input(|input| input.viewport().inner_rect)
            .map(|rect| [rect.width().round(), rect.height().round()]);
        Settings::of(self.state.workspace(), &self.layout, context.theme() == egui::Theme::Dark, size)
    }

    /// Writes the settings a moment after they have changed.
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
                // After a failure there is no other attempt until they change again.
                (self.written, self.changed) = (Some(now), None);
            }
        }
    }

    /// If the graphics device is lost, saves the run and closes the window.
    fn graphics(&mut self, context: &Context) {
        if let Some(fault) = self.lost.refused() {
            self.state.complain(&fault);
        }
        if self.lost.reason().is_some() && !std::mem::replace(&mut self.is_lost, true) {
            self.lost.save_was(self.state.save_run());
            context.send_viewport_cmd(ViewportCommand::Close);
        }
    }

    /// Goes on with a measurement of times, if there is one.
    fn measure(&mut self, context: &Context, frame: &eframe::Frame) {
        if self.state.run().measuring.is_none() {
            return;
        }
        context.request_repaint();
        if let Some(render) = frame.wgpu_render_state() {
            // A frame is done when the graphics card is; a browser does not tell.
            let _ = render.device.poll(wgpu::PollType::wait_indefinitely());
        }
        self.state.measure_on();
    }

    /// Takes in what worker threads report, and has frames drawn while something is under way.
    fn hear(&mut self, context: &Context) {
        if let Some(wait) = self.state.play_on() {
            context.request_repaint_after(wait);
        }
        self.state.hear_soon();
        if let Some(wait) = self.state.hear_files() {
            context.request_repaint_after(wait);
        }
        for (views, changed) in self.views.iter_mut().zip(self.state.take_changes()) {
            if let Some((changes, slots)) = changed {
                views.note(&changes, slots);
            }
        }
    }

    fn screenshots(&mut self, context: &Context) {
        if self.state.frame().screenshot {
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
            match write_png(&path, &image, carried(&self.state)) {
                Ok(()) => self.state.notice(format!("The window was saved as {}.", path.display())),
                Err(fault) => self.state.complain(&fault),
            }
        }
    }

    /// Shows all panels and does what they ask for. Returns whether the next frame has something new to show.
    fn show(&mut self, ui: &mut Ui) -> bool {
        let context = ui.ctx().clone();
        let palette = theme::palette(context.theme() == egui::Theme::Dark);
        // eframe clears the window in the colour of the panels: with software rendering every full layer costs time.
        let plain = if self.is_cleared { Frame::NONE } else { Frame::NONE.fill(theme::ink(palette.panel)) };
        let mut commands = Vec::new();
        // The panels show one of two runs; the first one stands for the window.
        let (window, state) = (&self.state, self.state.active());
        let (local, asked) = (&mut self.panels[window.active_run() as usize], &mut commands);
        if window.chrome() == Chrome::Panels {
            let menus = Panel::top("menus").frame(plain).exact_size(32.0);
            menus.show(ui, |ui| panels::top::show(ui, window, asked, palette));
        }
        let mut views = ui.available_rect_before_wrap();
        if window.run().import.is_some() {
            panels::import::show(ui, window, plain, asked, palette);
            egui::CentralPanel::default().frame(plain).show(ui, |ui| {
                self.views[0].given(ui, window, asked, palette);
            });
        } else if window.chrome() == Chrome::Presentation {
            views = panels::presentation::show(ui, window, &mut self.views, plain, asked, palette);
        } else if window.shown_study().is_some() {
            panels::study::show(ui, window, &mut self.views[0], &mut local.study, asked, palette);
        } else {
            // A window without room for the timeline must not change the height that the user has chosen.
            let height = &mut self.layout.timeline_height;
            let squashed = ui.available_height() < *height + TIMELINE_HEIGHTS[0];
            let time = Panel::bottom(if squashed { "time squashed" } else { "time" })
                .frame(plain)
                .default_size(*height)
                .size_range(TIMELINE_HEIGHTS[0]..=TIMELINE_HEIGHTS[1])
                .resizable(true)
                .show(ui, |ui| panels::time::show(ui, window, &mut local.time, asked, palette));
            if !squashed {
                *height = time.response.rect.height();
            }
            views = ui.available_rect_before_wrap();
            egui::CentralPanel::default().frame(plain).show(ui, |ui| {
                let views = &mut self.views;
                let mut docks = Docks { window, state, local, views, commands: asked, palette, edited: false };
                self.layout.show(ui, &mut docks);
            });
            // The notes cover neither the mesh nor the breakpoints.
            let place = self.layout.place_of(Pane::Front).unwrap_or(views);
            panels::notes::show(&context, place, state, asked, palette);
            panels::figure::show(&context, window, &mut local.figure, asked, palette);
        }
        panels::messages::show(&context, views, window, asked, palette);
        panels::over::show(&context, window, &mut local.over, asked, palette);
        self.state.end_frame(commands)
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        let times = &mut self.panels[self.state.active_run() as usize].time.times;
        times.frame(std::mem::take(&mut self.moving));
        times.first(self.views[0].has_shown());
        self.state.hear();
        self.graphics(&context);
        self.measure(&context, frame);
        self.state.hear_dialog();
        if self.state.run().is_asking_for_file() {
            context.request_repaint_after(DIALOG);
        }
        self.input(&context);
        if self.state.frame().toggle_theme {
            let dark = context.theme() == egui::Theme::Dark;
            context.set_theme(if dark { egui::Theme::Light } else { egui::Theme::Dark });
        }
        self.state.hear_import(context.theme() == egui::Theme::Dark);
        self.hear(&context);
        self.screenshots(&context);
        if let Some(text) = &self.state.frame().copied {
            context.copy_text(text.clone());
        }
        if self.show(ui) {
            context.request_repaint();
        }
        if let Some((_, left)) = self.state.view().notice() {
            context.request_repaint_after(left);
        }
        self.keep(&context, false);
        self.moving = context.has_requested_repaint();
        let title = match &self.state.run().opened {
            Some(opened) => format!("{} – quadfront", opened.run.case.name),
            None => "quadfront".to_owned(),
        };
        #[cfg(target_arch = "wasm32")]
        web::tell(&self.state, &title);
        if self.title != title {
            self.title.clone_from(&title);
            context.send_viewport_cmd(ViewportCommand::Title(title));
        }
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }

    fn raw_input_hook(&mut self, context: &Context, input: &mut RawInput) {
        let is_typing = context.egui_wants_keyboard_input();
        if self.presses.take(&mut input.events, is_typing, self.state.awaits_note()) {
            context.request_repaint();
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn on_exit(&mut self) {
        if let (Some(path), Some(written)) = (&self.path, &self.written)
            && self.changed.is_some()
        {
            let now = Settings::of(self.state.workspace(), &self.layout, written.dark, written.window);
            // The window is gone: the fault cannot be shown.
            let _ = now.write(path);
        }
    }
}
