//! The thread that traces: takes what happened, moves the camera, takes samples until a frame is due, and hands it over.
//!
//! For: [`Engine`]. May import: everything of the viewer but its front ends. Must never know: windows, terminals.
//!
//! While the camera stands, samples gather in the film from the first one on, with the seed that was asked for: the picture is the one that
//! `octray render` makes of as many samples, bit by bit. While it moves, each frame has a film of its own, with random numbers of its own,
//! and history stands in for samples.

use super::controls::Controls;
use super::exposure::{Change, Exposure, Pose};
use super::frame::{Exchange, Frame};
use super::loader::{Loader, Order, Ready, Source};
use super::painter::{Painter, Subject};
use super::rates::Rates;
use super::screenshot::{self, Shot};
use super::state::{Effect, Event, State};
use super::summary::Summary;
use super::watch::{self, Files};
use super::{Options, Wake};
use crate::render::{Renderer, Settings};
use crate::scene::Loaded;
use crate::traverse::Methods;
use crate::wording::counted;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant, SystemTime};

/// How long a message stays.
const MESSAGE: Duration = Duration::from_secs(6);
/// Warnings of a scene that are shown.
const MOST_WARNINGS: usize = 4;
/// What only a new renderer can change.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Build {
    methods: Methods,
    threads: usize,
    lanes: usize,
}

impl Build {
    fn of(settings: &Settings) -> Self {
        let Settings { methods, threads, lanes, .. } = *settings;
        Self { methods, threads, lanes }
    }
    /// What is chosen for a scene.
    fn wanted(scene: &Loaded, controls: &Controls, options: &Options) -> Self {
        let methods = controls.methods(scene, (options.methods)(scene));
        Self { methods, threads: controls.threads, lanes: controls.lanes }
    }
}

pub struct Engine {
    options: Arc<Options>,
    state: State,
    scene: Arc<Loaded>,
    loader: Loader,
    files: Files,
    events: Receiver<(Event, Instant)>,
    exchange: Arc<Exchange>,
    wake: Wake,
    exposure: Exposure,
    painter: Painter,
    frame: Frame,
    rates: Rates,
    summary: Summary,
    /// When the first scene had just been read.
    started: SystemTime,
    /// The name of the scene that is shown, as the playlist has it.
    name: String,
    /// Of the oldest event that no frame shows yet.
    unanswered: Option<Instant>,
    /// When another scene was asked for that is not there yet.
    asked: Option<Instant>,
    /// Did it arrive, and no frame shows it yet?
    arrived: bool,
    /// Since when there is a message that goes by itself.
    message: Option<Instant>,
    /// Why the scene that should be shown is not there: said until it is, but where something else is to be said for a while.
    error: String,
    /// The files that were looked for in vain, or held what is wrong, where the scene that should be shown is not there.
    blamed: Vec<PathBuf>,
    shoot: bool,
}

/// Why a renderer is done.
enum Next {
    Swap(Box<Ready>),
    Over,
}

impl Engine {
    /// Makes the first scene ready.
    pub fn new(
        options: Arc<Options>,
        state: State,
        scene: Arc<Loaded>,
        events: Receiver<(Event, Instant)>,
        exchange: Arc<Exchange>,
        wake: Wake,
    ) -> (Self, Renderer) {
        let started = SystemTime::now();
        let renderer = Renderer::new(&scene, settings(&scene, &state.controls, &options));
        let engine = Self {
            painter: Painter::default(),
            loader: Loader::start({
                let exchange = exchange.clone();
                move || exchange.tell()
            }),
            files: Files::none({
                let exchange = exchange.clone();
                move || exchange.tell()
            }),
            frame: Frame::default(),
            rates: Rates::default(),
            summary: Summary::default(),
            name: state.playlist.current().to_string(),
            exposure: Exposure::new(&renderer, &scene),
            started,
            unanswered: None,
            asked: None,
            arrived: false,
            message: None,
            error: String::new(),
            blamed: Vec::new(),
            shoot: false,
            options,
            state,
            scene,
            events,
            exchange,
            wake,
        };
        (engine, renderer)
    }

    /// Goes on until somebody quits.
    pub fn run(mut self, mut renderer: Renderer) -> Summary {
        self.exchange.set_ready();
        self.watch();
        self.warn();
        self.catch_up(self.started);
        while let Next::Swap(ready) = renderer.hold(|renderer| self.serve(renderer)) {
            renderer = self.swap(*ready, renderer.settings());
        }
        self.summary
    }

    /// Goes on with a scene, or a way to render it, that has become ready; `before` is how it was rendered until now.
    fn swap(&mut self, ready: Ready, before: &Settings) -> Renderer {
        let Ready { scene, renderer, again, read } = ready;
        if Arc::ptr_eq(&scene, &self.scene) {
            // Only the width is measured side by side: with all else the same.
            let now = Build::of(renderer.settings());
            match now == (Build { lanes: now.lanes, ..Build::of(before) }) {
                true => self.rates.switch(),
                false => self.rates.forget(),
            }
        } else {
            self.arrived = !again;
            self.state.arrive(&scene, again, &self.name);
            self.scene = scene;
            self.name = self.state.playlist.current().to_string();
            self.painter.meet_another_scene(again);
            self.blamed.clear();
            self.error.clear();
            self.watch();
            self.rates.forget();
            self.warn();
        }
        self.exposure.renew(&renderer, &self.scene);
        self.painter.forget();
        if let Some(read) = read {
            self.catch_up(read);
        }
        renderer
    }

    /// Reads the scene again if a file has changed, or appeared, since it was read and before anybody watched it.
    fn catch_up(&mut self, read: SystemTime) {
        if watch::is_newer(self.scene.files.iter().map(PathBuf::as_path), read) {
            self.load();
        }
    }

    /// Says for a while what is odd about the scene; nothing where nothing is.
    fn warn(&mut self) {
        let warnings = &self.scene.warnings;
        let mut text = warnings.iter().take(MOST_WARNINGS).map(String::as_str).collect::<Vec<_>>().join("\n");
        if let Some(more) = warnings.len().checked_sub(MOST_WARNINGS).filter(|&more| more > 0) {
            text += &format!("\n(and {})", counted(more, "more warning", "more warnings"));
        }
        self.set_message(&text);
    }

    /// Watches the files of the scene that is shown, the one that should be, and those that are to blame if that is not there.
    fn watch(&mut self) {
        let wanted = self.state.playlist.current();
        let wanted = (!wanted.starts_with("builtin:")).then_some(Path::new(wanted));
        let files = self.scene.files.iter().chain(&self.blamed).map(PathBuf::as_path);
        self.files.watch(files.chain(wanted));
    }

    /// Frame after frame with one renderer.
    fn serve(&mut self, renderer: &mut Renderer) -> Next {
        // The choices that this renderer was last held against.
        let mut chosen = None;
        loop {
            self.exchange.hear();
            if self.listen() {
                if self.shoot {
                    self.shoot(renderer);
                }
                return Next::Over;
            }
            if chosen != Some(self.state.controls) && !self.loader.busy() {
                chosen = Some(self.state.controls);
                self.rebuild(renderer);
            }
            match self.loader.take() {
                Some(Ok(ready)) => return Next::Swap(Box::new(ready)),
                Some(Err(error)) => {
                    self.error = error.to_string();
                    self.asked = None;
                    self.set_message("");
                    // Whoever mends one of them, or brings what is missing, sees the scene.
                    self.blamed = error.files;
                    self.watch();
                    // An order that this one has overtaken is still to be carried out.
                    chosen = None;
                }
                None => {}
            }
            if self.files.have_changed(Instant::now()) {
                self.load();
            }
            self.state.advance(Instant::now());
            self.point(renderer);
            let measured = (&mut self.rates, &mut self.summary);
            self.exposure.expose(renderer, self.state.rate, &self.exchange, measured);
            if self.exchange.is_left() {
                continue;
            }
            self.show(renderer);
            if std::mem::take(&mut self.shoot) {
                self.shoot(renderer);
            }
            if self.options.frames.is_some_and(|frames| self.summary.frames >= frames) {
                return Next::Over;
            }
        }
    }

    /// Takes in what happened; true at the end of it all.
    fn listen(&mut self) -> bool {
        while let Ok((event, at)) = self.events.try_recv() {
            if !matches!(event, Event::Rate(_)) {
                self.unanswered.get_or_insert(at);
            }
            match self.state.handle(&event, at) {
                Some(Effect::Quit) => return true,
                Some(Effect::Screenshot) => self.shoot = true,
                Some(Effect::Load) => {
                    self.asked = Some(at);
                    self.load();
                }
                Some(Effect::Reload) => self.load(),
                None => {}
            }
        }
        false
    }

    /// Orders another renderer, if this one is not what is chosen.
    fn rebuild(&mut self, renderer: &Renderer) {
        let wanted = Build::wanted(&self.scene, &self.state.controls, &self.options);
        if wanted != Build::of(renderer.settings()) {
            self.order(Source::Here(self.scene.clone()), true);
        }
    }

    /// Has the playlist's scene read; once more, if it is the one that is shown.
    fn load(&mut self) {
        let name = self.state.playlist.current().to_string();
        let again = name == self.name;
        if !again {
            self.set_message(&format!("reading {name}"));
        }
        // From before it is read: a change meanwhile is not to be missed.
        self.watch();
        self.order(Source::Name(name), again);
    }

    fn order(&mut self, source: Source, again: bool) {
        let (controls, options) = (self.state.controls, self.options.clone());
        let keep = again.then_some(controls.bounces).or(options.bounces);
        let held = pixels(settings(&self.scene, &controls, &options).resolution);
        let settings = move |scene: &Loaded| {
            let bounces = keep.unwrap_or(scene.max_bounces);
            let settings = settings(scene, &Controls { bounces, ..controls }, &options);
            // What is shown already has its memory.
            if pixels(settings.resolution) > held {
                (options.fits)(settings.resolution)?;
            }
            Ok(settings)
        };
        self.loader.order(Order { source, settings: Box::new(settings), again });
    }

    /// Points the renderer where the camera is.
    fn point(&mut self, renderer: &mut Renderer) {
        let own = self.options.size.unwrap_or(self.scene.resolution);
        let pose = Pose {
            camera: *self.state.walker.camera(),
            resolution: self.state.controls.resolution(own, self.exposure.coarseness),
            bounces: self.state.controls.bounces,
        };
        let (seed, frame) = (self.options.seed, self.summary.frames);
        if self.exposure.point(renderer, &self.scene, pose, seed, frame) == Change::Other {
            self.painter.forget();
            self.rates.forget();
        }
    }

    /// Paints a frame and hands it over.
    fn show(&mut self, renderer: &Renderer) {
        let start = Instant::now();
        if self.message.is_some_and(|since| start - since > MESSAGE) && !self.loader.busy() {
            self.set_message("");
        }
        let subject = Subject {
            renderer,
            scene: &self.scene,
            camera: &self.exposure.pose.camera,
            film: &self.exposure.film,
            controls: &self.state.controls,
            known: self.exposure.known,
            standing: self.exposure.still,
            listed: self.name == self.state.playlist.current(),
        };
        self.painter.paint(&subject, &mut self.frame);
        if let Some(speed) = self.painter.speed() {
            self.state.speed = f64::from(speed);
        }
        self.frame.caught = self.state.caught;
        self.frame.help = self.state.controls.help;
        self.painter.write(&subject, &self.state, &self.rates, self.loader.busy(), &mut self.frame);
        let now = Instant::now();
        let painting = now - start;
        let since = self.exposure.shown(now, painting);
        self.exposure.hold(self.state.controls.target);
        self.rates.frame(since);
        self.summary.painting += painting;
        self.summary.frame(since, self.unanswered.take().map(|at| now - at));
        if std::mem::take(&mut self.arrived)
            && let Some(asked) = self.asked.take()
        {
            self.summary.switched(now - asked);
        }
        self.exchange.give(&mut self.frame);
        (self.wake)();
    }

    /// Says something for a while.
    fn set_message(&mut self, text: &str) {
        self.painter.message(if text.is_empty() { &self.error } else { text });
        self.message = (!text.is_empty()).then(Instant::now);
    }

    fn shoot(&mut self, renderer: &Renderer) {
        // As whoever renders it again will have them.
        self.exposure.even_out(renderer);
        let shot = Shot {
            scene: &self.scene,
            camera: &self.exposure.pose.camera,
            settings: renderer.settings(),
            film: &self.exposure.film,
            tone: &self.state.controls.tone,
        };
        let text = match screenshot::take(&self.options.screenshots, &shot) {
            Ok(place) => format!("saved {}.png, .exr and .json", place.display()),
            Err(error) => error.to_string(),
        };
        self.set_message(&text);
    }
}

fn pixels([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height)
}

/// How a scene is rendered as things stand, from its own camera.
fn settings(scene: &Loaded, controls: &Controls, options: &Options) -> Settings {
    let Build { methods, threads, lanes } = Build::wanted(scene, controls, options);
    Settings {
        resolution: controls.resolution(options.size.unwrap_or(scene.resolution), 1.0),
        max_bounces: controls.bounces,
        seed: options.seed,
        pipeline: options.pipeline,
        clamp: options.clamp,
        methods,
        threads,
        lanes,
        ..Settings::of(scene)
    }
}
