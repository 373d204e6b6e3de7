//! Runs the render loop: handles events, moves the camera, accumulates samples until a frame is due,
//! publishes the frame.
//!
//! While the camera rests, samples accumulate in the film from the first one on, with the requested seed: the
//! picture has the bits of `octray render` with the same number of samples. While it moves, each frame starts
//! a new film with a seed of its own, and temporal reprojection supplies the missing samples.

use super::accumulation::{Accumulation, Pose};
use super::display_mode::DisplayMode;
use super::file_watcher::FileWatcher;
use super::frame::{Exchange, Frame};
use super::loader::Loader;
use super::options::{Options, Wake};
use super::overlay::Overlay;
use super::painter::{FrameInput, Painter};
use super::screenshot;
use super::state::{Effect, Event, State};
use super::timing::Summary;
use octray_engine::diagnosis;
use octray_engine::render::{Methods, Renderer, Settings};
use octray_formats::scene::{self, Loaded, SceneError};
use octray_formats::wording::counted;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering::{Acquire, Release};
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant, SystemTime};

const MESSAGE_TIME: Duration = Duration::from_secs(6);
/// Samples per pixel of the picture that is diagnosed.
const DIAGNOSED_SAMPLES: u32 = 16;
/// Most warnings of a scene that are shown.
const MAX_WARNINGS: usize = 4;

type SceneRenderer = (Arc<Loaded>, Renderer);

/// State of the render thread.
pub struct RenderLoop {
    options: Arc<Options>,
    state: State,
    scene: Arc<Loaded>,
    loader: Loader<Result<SceneRenderer, SceneError>>,
    file_watcher: FileWatcher,
    events: Receiver<(Event, Instant)>,
    exchange: Arc<Exchange>,
    wake: Wake,
    accumulation: Accumulation,
    painter: Painter,
    overlay: Overlay,
    frame: Frame,
    /// Time of the oldest event that no frame shows yet.
    oldest_unshown_event: Option<Instant>,
    /// When another scene was requested that no frame shows yet.
    switch_requested: Option<Instant>,
    /// A temporary message, and when it was first shown.
    message: Option<(String, Instant)>,
    /// The error of the requested scene, shown until the scene loads, except while there is a message.
    error: Option<SceneError>,
    /// A time before the last scene was read.
    read: SystemTime,
    screenshot_requested: bool,
    diagnosed: bool,
}

/// Returns the settings that only a new renderer can change.
fn fixed(settings: &Settings) -> (Methods, usize, usize) {
    (settings.methods, settings.threads, settings.lanes)
}

impl RenderLoop {
    /// Renders frames, beginning with a loaded scene, until the viewer quits.
    pub fn run(
        options: Arc<Options>,
        state: State,
        scene: Arc<Loaded>,
        events: Receiver<(Event, Instant)>,
        exchange: Arc<Exchange>,
        wake: Wake,
    ) -> Summary {
        let mut renderer = (options.renderer)(&scene, state.controls.settings(&scene, &options));
        let mut this = Self {
            loader: Loader::new(exchange.clone()),
            file_watcher: FileWatcher::default(),
            accumulation: Accumulation::new(&renderer, &scene),
            painter: Painter::default(),
            overlay: Overlay::default(),
            frame: Frame::default(),
            oldest_unshown_event: None,
            switch_requested: None,
            message: None,
            error: None,
            read: scene.read.unwrap_or_else(SystemTime::now),
            screenshot_requested: false,
            diagnosed: false,
            options,
            state,
            scene,
            events,
            exchange,
            wake,
        };
        this.exchange.ready.store(true, Release);
        this.enter_scene();
        while let Some(prepared) = renderer.hold(|renderer| this.render_frames(renderer)) {
            renderer = this.install(prepared, renderer.settings());
        }
        this.accumulation.summary
    }

    /// Switches to a prepared scene or renderer; `before` are the settings until now.
    fn install(&mut self, (scene, renderer): SceneRenderer, before: &Settings) -> Renderer {
        if Arc::ptr_eq(&scene, &self.scene) {
            // Rates of both widths are shown side by side only if all other settings are the same.
            let now = renderer.settings();
            match fixed(&Settings { lanes: before.lanes, ..*now }) == fixed(before) {
                true => self.accumulation.rates.switch_width(),
                false => self.accumulation.rates.reset(),
            }
        } else {
            self.state.enter_scene(&scene, (self.options.settings)(&scene).max_bounces);
            self.painter.minimap = None;
            self.scene = scene;
            self.error = None;
            self.accumulation.rates.reset();
            self.enter_scene();
        }
        self.accumulation.reset(&renderer, &self.scene);
        self.painter.history.reset();
        renderer
    }

    /// Shows a new scene's warnings for a while, and watches its files.
    fn enter_scene(&mut self) {
        let warnings = &self.scene.warnings;
        let mut text = warnings.iter().take(MAX_WARNINGS).map(String::as_str).collect::<Vec<_>>().join("\n");
        if let Some(more) = warnings.len().checked_sub(MAX_WARNINGS).filter(|&more| more > 0) {
            text += &format!("\n(and {})", counted(more, "more warning", "more warnings"));
        }
        self.message = (!text.is_empty()).then(|| (text, Instant::now()));
        self.diagnosed = false;
        self.watch_files();
    }

    /// Watches the files of the scene that is shown, the requested scene file, and the files of a failed
    /// load. A change of one of them starts another attempt.
    fn watch_files(&mut self) {
        let wanted = self.state.playlist.current();
        let is_built_in = wanted.to_string_lossy().starts_with("builtin:");
        let wanted = (!is_built_in).then_some(Path::new(wanted));
        let files = self.scene.files.iter().chain(self.error.iter().flat_map(|error| &error.files));
        self.file_watcher.watch(files.map(PathBuf::as_path).chain(wanted), self.read);
    }

    /// Renders frames with one renderer until another one is prepared. Returns `None` if the viewer quits.
    fn render_frames(&mut self, renderer: &mut Renderer) -> Option<SceneRenderer> {
        // The controls that this renderer was last compared with.
        let mut chosen = None;
        loop {
            self.exchange.notified.store(false, Release);
            if self.handle_events(renderer) {
                if self.screenshot_requested {
                    self.take_screenshot(renderer);
                }
                return None;
            }
            if chosen != Some(self.state.controls) && !self.loader.is_busy() {
                chosen = Some(self.state.controls);
                let wanted = self.state.controls.settings(&self.scene, &self.options);
                if fixed(&wanted) != fixed(renderer.settings()) {
                    let scene = self.scene.clone();
                    self.request(true, || Ok(scene));
                }
            }
            match self.loader.poll() {
                Some(Ok(prepared)) => return Some(prepared),
                Some(Err(error)) => {
                    self.error = Some(error);
                    self.message = None;
                    self.switch_requested = None;
                    self.watch_files();
                    // A rebuild request that this load superseded must be sent again.
                    chosen = None;
                }
                None => {}
            }
            if self.file_watcher.has_changed(Instant::now()) {
                self.load();
            }
            self.state.advance(Instant::now());
            self.update_pose(renderer);
            self.accumulation.accumulate(renderer, self.state.rate, &self.exchange);
            if self.exchange.closed.load(Acquire) {
                continue;
            }
            self.diagnose(renderer);
            self.publish_frame(renderer);
            if std::mem::take(&mut self.screenshot_requested) {
                self.take_screenshot(renderer);
            }
            if self.options.frames.is_some_and(|frames| self.accumulation.summary.frames >= frames) {
                return None;
            }
        }
    }

    /// Shows the problems of a scene's picture, such as a black one, once and while there is no message.
    fn diagnose(&mut self, renderer: &mut Renderer) {
        let Accumulation { film, progressive, .. } = &self.accumulation;
        if self.diagnosed || !progressive || film.samples() < DIAGNOSED_SAMPLES || self.message.is_some() {
            return;
        }
        self.diagnosed = true;
        let problems = diagnosis::warnings(renderer, &self.scene, film, Some(self.state.controls.tone));
        self.message = (!problems.is_empty()).then(|| (problems.join("\n"), Instant::now()));
    }

    /// Handles pending events; returns true on quit.
    fn handle_events(&mut self, renderer: &Renderer) -> bool {
        while let Ok((event, at)) = self.events.try_recv() {
            if !matches!(event, Event::Rate(_)) {
                self.oldest_unshown_event.get_or_insert(at);
            }
            match self.state.handle(&event, at) {
                Some(Effect::Quit) => return true,
                Some(Effect::Screenshot) => self.screenshot_requested = true,
                Some(Effect::Focus) => match self.painter.distance_in_the_middle(renderer) {
                    distance if distance.is_finite() => self.state.camera_controller.focus_at(distance),
                    _ => self.message = Some(("nothing is in the middle".into(), Instant::now())),
                },
                Some(Effect::Load) => {
                    self.switch_requested = (!self.state.shows_current()).then_some(at);
                    self.load();
                }
                None => {}
            }
        }
        false
    }

    /// Requests the playlist's current scene. It is a reload if the scene is shown already.
    fn load(&mut self) {
        let name = self.state.playlist.current().to_os_string();
        let reload = self.state.shows_current();
        if !reload {
            self.message = Some((format!("reading {}", name.display()), Instant::now()));
        }
        self.read = SystemTime::now();
        // The files are watched before the scene is read, so that no change is missed.
        self.watch_files();
        self.request(reload, move || scene::load_with_view(&name).map(Arc::new));
    }

    /// Requests a renderer for the scene that `load` returns. A reload keeps the chosen bounces.
    fn request(
        &mut self,
        reload: bool,
        load: impl FnOnce() -> Result<Arc<Loaded>, SceneError> + Send + 'static,
    ) {
        let (mut controls, options) = (self.state.controls, self.options.clone());
        let pixels = |settings: &Settings| settings.resolution.map(u64::from).iter().product::<u64>();
        let held = pixels(&controls.settings(&self.scene, &options));
        self.loader.request(move || {
            let scene = load()?;
            if !reload {
                controls.bounces = (options.settings)(&scene).max_bounces;
            }
            let settings = controls.settings(&scene, &options);
            // The memory of the present resolution is allocated already.
            if pixels(&settings) > held {
                (options.fits)(settings.resolution).map_err(|why| SceneError::unusable(why, &scene))?;
            }
            Ok((scene.clone(), (options.renderer)(&scene, settings)))
        });
    }

    fn update_pose(&mut self, renderer: &mut Renderer) {
        let requested = (self.options.settings)(&self.scene).resolution;
        let pose = Pose {
            camera: *self.state.camera_controller.camera(),
            resolution: self.state.controls.resolution(requested, self.accumulation.resolution.scale),
            bounces: self.state.controls.bounces,
        };
        if self.accumulation.set_pose(renderer, pose) {
            self.painter.history.reset();
        }
    }

    fn publish_frame(&mut self, renderer: &Renderer) {
        let start = Instant::now();
        let busy = self.loader.is_busy();
        self.message.take_if(|(_, since)| start - *since > MESSAGE_TIME && !busy);
        let Self { painter, scene, accumulation, state, frame, .. } = self;
        let input = FrameInput { renderer, scene, accumulation, controls: &state.controls };
        painter.paint(&input, frame);
        state.speed.get_or_insert_with(|| painter.walking_speed(renderer));
        frame.mouse_captured = state.mouse_captured;
        frame.help = state.controls.help;
        match (&self.message, &self.error) {
            (Some((text, _)), _) => frame.message.clone_from(text),
            (None, Some(error)) => frame.message = error.to_string(),
            (None, None) => frame.message.clear(),
        }
        frame.title.clone_from(&scene.name);
        self.overlay.write(&input, state, busy, &mut frame.figures);
        if state.controls.mode == DisplayMode::Cost && !frame.figures.is_empty() {
            frame.figures += &format!(", {}", painter.most_tests);
        }
        accumulation.frame_shown(start, self.oldest_unshown_event.take());
        accumulation.adapt_resolution(state.controls.target);
        if let Some(requested) = self.switch_requested.take_if(|_| state.shows_current()) {
            let longest = &mut accumulation.summary.max_switch_time;
            *longest = (*longest).max(Some(requested.elapsed()));
        }
        self.exchange.publish(&mut self.frame);
        (self.wake)();
    }

    fn take_screenshot(&mut self, renderer: &Renderer) {
        // `octray render` gives every pixel the same number of samples too, at least one.
        let film = &mut self.accumulation.film;
        let uneven = film.most_samples().max(1) - film.samples();
        renderer.add_samples(film, uneven);
        let Self { scene, accumulation, state, options, .. } = &*self;
        let input = FrameInput { renderer, scene, accumulation, controls: &state.controls };
        let saved = screenshot::save(&options.screenshots, &input);
        let text = saved.unwrap_or_else(|error| error.to_string());
        self.message = Some((text, Instant::now()));
    }
}
