//! The render loop: handles events, moves the camera, accumulates samples until a frame is due, publishes the
//! frame.
//!
//! For: [`RenderLoop`].
//!
//! While the camera rests, samples accumulate in the film from the first one on, with the requested seed: the
//! picture has the bits of `octray render` with the same number of samples. While it moves, each frame starts
//! a new film with a seed of its own, and temporal reprojection supplies the missing samples.

use super::accumulation::{Accumulation, Pose, PoseChange};
use super::controls::Controls;
use super::file_watcher::{self, FileWatcher};
use super::frame::{Exchange, Frame};
use super::loader::{LoadRequest, Loader, PreparedScene, SceneSource};
use super::options::{Options, Wake};
use super::overlay::Overlay;
use super::painter::{FrameInput, Painter};
use super::renderer_config::{RendererConfig, pixels, settings};
use super::screenshot::{self, Shot};
use super::state::{Effect, Event, State};
use super::timing::{RateMeter, Summary};
use octray_engine::render::{Renderer, Settings};
use octray_formats::scene::Loaded;
use octray_formats::wording::counted;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant, SystemTime};

/// How long a message is shown.
const MESSAGE_TIME: Duration = Duration::from_secs(6);
/// Number of a scene's warnings that are shown.
const MAX_WARNINGS: usize = 4;

/// State of the render thread.
pub struct RenderLoop {
    options: Arc<Options>,
    state: State,
    scene: Arc<Loaded>,
    loader: Loader,
    file_watcher: FileWatcher,
    events: Receiver<(Event, Instant)>,
    exchange: Arc<Exchange>,
    wake: Wake,
    accumulation: Accumulation,
    painter: Painter,
    overlay: Overlay,
    frame: Frame,
    rates: RateMeter,
    summary: Summary,
    /// The playlist name of the scene that is shown.
    name: String,
    /// Time of the oldest event that no frame shows yet.
    oldest_unshown_event: Option<Instant>,
    /// When the pending switch to another scene was requested.
    switch_requested: Option<Instant>,
    /// Whether that scene has arrived and no frame shows it yet.
    scene_arrived: bool,
    /// When the temporary message was set.
    message: Option<Instant>,
    /// Why the requested scene could not be loaded; shown until it is, except while a temporary message is
    /// shown.
    error: String,
    /// The files that the failed load requested, missing or faulty.
    error_files: Vec<PathBuf>,
    /// When the last load was requested.
    requested: SystemTime,
    screenshot_requested: bool,
}

/// What follows after the loop with one renderer.
enum Next {
    Swap(Box<PreparedScene>),
    Quit,
}

impl RenderLoop {
    /// Creates the renderer of the first scene.
    pub fn new(
        options: Arc<Options>,
        state: State,
        scene: Arc<Loaded>,
        events: Receiver<(Event, Instant)>,
        exchange: Arc<Exchange>,
        wake: Wake,
    ) -> (Self, Renderer) {
        let renderer = Renderer::new(&scene, settings(&scene, &state.controls, &options));
        let render_loop = Self {
            painter: Painter::default(),
            overlay: Overlay::default(),
            loader: Loader::start({
                let exchange = exchange.clone();
                move || exchange.notify()
            }),
            file_watcher: FileWatcher::new({
                let exchange = exchange.clone();
                move || exchange.notify()
            }),
            frame: Frame::default(),
            rates: RateMeter::default(),
            summary: Summary::default(),
            name: state.playlist.current().to_string(),
            accumulation: Accumulation::new(&renderer, &scene),
            oldest_unshown_event: None,
            switch_requested: None,
            scene_arrived: false,
            message: None,
            error: String::new(),
            error_files: Vec::new(),
            requested: SystemTime::now(),
            screenshot_requested: false,
            options,
            state,
            scene,
            events,
            exchange,
            wake,
        };
        (render_loop, renderer)
    }

    /// Runs until the viewer quits.
    pub fn run(mut self, mut renderer: Renderer) -> Summary {
        self.exchange.set_ready();
        self.watch_files();
        self.show_warnings();
        self.reload_if_changed();
        while let Next::Swap(ready) = renderer.hold(|renderer| self.render_frames(renderer)) {
            renderer = self.install(*ready, renderer.settings());
        }
        self.summary
    }

    /// Switches to a prepared scene or renderer; `before` are the settings until now.
    fn install(&mut self, ready: PreparedScene, before: &Settings) -> Renderer {
        let PreparedScene { scene, renderer, reload } = ready;
        if Arc::ptr_eq(&scene, &self.scene) {
            // Rates of both widths are shown side by side only if all other settings are the same.
            let now = RendererConfig::of(renderer.settings());
            match now == (RendererConfig { lanes: now.lanes, ..RendererConfig::of(before) }) {
                true => self.rates.switch_width(),
                false => self.rates.reset(),
            }
        } else {
            self.scene_arrived = !reload;
            self.state.enter_scene(&scene, reload, &self.name);
            self.scene = scene;
            self.name = self.state.playlist.current().to_string();
            self.painter.change_scene(reload);
            self.error_files.clear();
            self.error.clear();
            self.watch_files();
            self.rates.reset();
            self.show_warnings();
            self.reload_if_changed();
        }
        self.accumulation.reset(&renderer, &self.scene);
        self.painter.reset_history();
        renderer
    }

    /// Reloads the scene if a file changed or appeared between loading and the start of watching.
    fn reload_if_changed(&mut self) {
        let files = self.scene.files.iter().map(PathBuf::as_path);
        if self.scene.read.is_some_and(|read| file_watcher::is_newer(files, read)) {
            self.load();
        }
    }

    /// Shows the scene's warnings for a while.
    fn show_warnings(&mut self) {
        let warnings = &self.scene.warnings;
        let mut text = warnings.iter().take(MAX_WARNINGS).map(String::as_str).collect::<Vec<_>>().join("\n");
        if let Some(more) = warnings.len().checked_sub(MAX_WARNINGS).filter(|&more| more > 0) {
            text += &format!("\n(and {})", counted(more, "more warning", "more warnings"));
        }
        self.set_message(&text);
    }

    /// Watches the files of the scene that is shown, the requested scene file, and the files of a failed
    /// load.
    fn watch_files(&mut self) {
        let wanted = self.state.playlist.current();
        let wanted = (!wanted.starts_with("builtin:")).then_some(Path::new(wanted));
        let files = self.scene.files.iter().chain(&self.error_files).map(PathBuf::as_path);
        self.file_watcher.watch(files.chain(wanted));
    }

    /// Renders frames with one renderer.
    fn render_frames(&mut self, renderer: &mut Renderer) -> Next {
        // The controls that this renderer was last compared with.
        let mut chosen = None;
        loop {
            self.exchange.clear_notification();
            if self.handle_events() {
                if self.screenshot_requested {
                    self.take_screenshot(renderer);
                }
                return Next::Quit;
            }
            if chosen != Some(self.state.controls) && !self.loader.busy() {
                chosen = Some(self.state.controls);
                self.request_rebuild(renderer);
            }
            match self.loader.poll() {
                Some(Ok(ready)) => return Next::Swap(Box::new(ready)),
                Some(Err(error)) => {
                    self.error = error.to_string();
                    self.switch_requested = None;
                    self.set_message("");
                    // A change of one of these files triggers another attempt.
                    self.error_files = error.files;
                    self.watch_files();
                    let files = self.error_files.iter().map(PathBuf::as_path);
                    if file_watcher::is_newer(files, self.requested) {
                        self.load();
                    }
                    // A rebuild request that this load superseded must be sent again.
                    chosen = None;
                }
                None => {}
            }
            if self.file_watcher.have_changed(Instant::now()) {
                self.load();
            }
            self.state.advance(Instant::now());
            self.update_pose(renderer);
            let measured = (&mut self.rates, &mut self.summary);
            self.accumulation.accumulate(renderer, self.state.rate, &self.exchange, measured);
            if self.exchange.is_closed() {
                continue;
            }
            self.publish_frame(renderer);
            if std::mem::take(&mut self.screenshot_requested) {
                self.take_screenshot(renderer);
            }
            if self.options.frames.is_some_and(|frames| self.summary.frames >= frames) {
                return Next::Quit;
            }
        }
    }

    /// Handles pending events; returns true on quit.
    fn handle_events(&mut self) -> bool {
        while let Ok((event, at)) = self.events.try_recv() {
            if !matches!(event, Event::Rate(_)) {
                self.oldest_unshown_event.get_or_insert(at);
            }
            match self.state.handle(&event, at) {
                Some(Effect::Quit) => return true,
                Some(Effect::Screenshot) => self.screenshot_requested = true,
                Some(Effect::Load) => {
                    self.switch_requested = Some(at);
                    self.load();
                }
                Some(Effect::Reload) => self.load(),
                None => {}
            }
        }
        false
    }

    /// Requests another renderer if the controls no longer match this one.
    fn request_rebuild(&mut self, renderer: &Renderer) {
        let wanted = RendererConfig::wanted(&self.scene, &self.state.controls, &self.options);
        if wanted != RendererConfig::of(renderer.settings()) {
            self.request(SceneSource::Loaded(self.scene.clone()), true);
        }
    }

    /// Requests the playlist's current scene; a reload if it is the one that is shown.
    fn load(&mut self) {
        let name = self.state.playlist.current().to_string();
        let reload = name == self.name;
        if !reload {
            self.set_message(&format!("reading {name}"));
        }
        // Before the scene is read, so that no change is missed.
        self.watch_files();
        self.requested = SystemTime::now();
        self.request(SceneSource::Name(name), reload);
    }

    fn request(&mut self, source: SceneSource, reload: bool) {
        let (controls, options) = (self.state.controls, self.options.clone());
        let keep = reload.then_some(controls.bounces).or(options.bounces);
        let held = pixels(settings(&self.scene, &controls, &options).resolution);
        let settings = move |scene: &Loaded| {
            let bounces = keep.unwrap_or(scene.max_bounces);
            let settings = settings(scene, &Controls { bounces, ..controls }, &options);
            // The present resolution already has its memory.
            if pixels(settings.resolution) > held {
                (options.fits)(settings.resolution)?;
            }
            Ok(settings)
        };
        self.loader.request(LoadRequest { source, settings: Box::new(settings), reload });
    }

    /// Sets the renderer's pose from the state.
    fn update_pose(&mut self, renderer: &mut Renderer) {
        let own = self.options.size.unwrap_or(self.scene.resolution);
        let pose = Pose {
            camera: *self.state.camera_controller.camera(),
            resolution: self.state.controls.resolution(own, self.accumulation.resolution.scale),
            bounces: self.state.controls.bounces,
        };
        let (seed, frame) = (self.options.seed, self.summary.frames);
        if self.accumulation.set_pose(renderer, &self.scene, pose, seed, frame) == PoseChange::Other {
            self.painter.reset_history();
            self.rates.reset();
        }
    }

    /// Paints a frame and publishes it.
    fn publish_frame(&mut self, renderer: &Renderer) {
        let start = Instant::now();
        if self.message.is_some_and(|since| start - since > MESSAGE_TIME) && !self.loader.busy() {
            self.set_message("");
        }
        let input = FrameInput {
            renderer,
            scene: &self.scene,
            camera: &self.accumulation.pose.camera,
            film: &self.accumulation.film,
            controls: &self.state.controls,
            pose_shown: self.accumulation.pose_shown,
            progressive: self.accumulation.progressive,
            is_current: self.name == self.state.playlist.current(),
        };
        self.painter.paint(&input, &mut self.frame);
        if let Some(speed) = self.painter.speed() {
            self.state.speed = f64::from(speed);
        }
        self.frame.mouse_captured = self.state.mouse_captured;
        self.frame.help = self.state.controls.help;
        self.overlay.write(&input, &self.state, &self.rates, self.loader.busy(), &mut self.frame);
        let now = Instant::now();
        let painting = now - start;
        let since = self.accumulation.frame_shown(now, painting);
        self.accumulation.adapt_resolution(self.state.controls.target);
        self.rates.frame(since);
        self.summary.painting += painting;
        self.summary.frame(since, self.oldest_unshown_event.take().map(|at| now - at));
        if std::mem::take(&mut self.scene_arrived)
            && let Some(switch_requested) = self.switch_requested.take()
        {
            self.summary.switched(now - switch_requested);
        }
        self.exchange.publish(&mut self.frame);
        (self.wake)();
    }

    /// Shows a message for a while; without one, the error if there is one.
    fn set_message(&mut self, text: &str) {
        self.overlay.set_message(if text.is_empty() { &self.error } else { text });
        self.message = (!text.is_empty()).then(Instant::now);
    }

    fn take_screenshot(&mut self, renderer: &Renderer) {
        // As `octray render` does: the same number of samples in every pixel.
        self.accumulation.equalize_samples(renderer);
        let shot = Shot {
            scene: &self.scene,
            camera: &self.accumulation.pose.camera,
            settings: renderer.settings(),
            film: &self.accumulation.film,
            tone: &self.state.controls.tone,
        };
        let text = match screenshot::take(&self.options.screenshots, &shot) {
            Ok(place) => format!("saved {}.png, .exr and .json", place.display()),
            Err(error) => error.to_string(),
        };
        self.set_message(&text);
    }
}
