//! The thread that traces: takes what happened, moves the camera, takes samples until a frame is due, and hands it over.
//!
//! For: [`Engine`]. May import: everything of the viewer but its front ends. Must never know: windows, terminals.
//!
//! While the camera stands, samples gather in the film from the first one on, with the seed that was asked for: the picture is the one that
//! `octray render` makes of as many samples, bit by bit. While it moves, each frame has a film of its own, with random numbers of its own,
//! and history stands in for samples.

use super::controls::Controls;
use super::frame::{Exchange, Frame};
use super::loader::{Loader, Order, Ready, Source};
use super::painter::{Painter, Subject};
use super::rates::Rates;
use super::screenshot::{self, Shot};
use super::state::{Effect, Event, State};
use super::summary::Summary;
use super::watch::Files;
use super::{Options, Wake};
use crate::film::Film;
use crate::render::{Renderer, Settings, Watch};
use crate::scene::{Camera, Scene};
use crate::traverse::Methods;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::thread;
use std::time::{Duration, Instant};

/// Samples after which a standing picture is left as it is, and the machine alone.
const MOST_SAMPLES: u32 = 65_536;
/// How long a message stays.
const MESSAGE: Duration = Duration::from_secs(6);
/// How much coarser or finer a step makes pixels that hold a frame rate, and the dead band around it.
const STEP: f64 = 0.85;

/// What a picture is of.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pose {
    camera: Camera,
    resolution: [u32; 2],
    bounces: u32,
}

/// What only a new renderer can change.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Build {
    methods: Methods,
    threads: usize,
    lanes: usize,
}

impl Build {
    fn of(scene: &Scene, controls: &Controls, options: &Options) -> Self {
        let methods = controls.methods(scene, (options.methods)(scene));
        Self { methods, threads: controls.threads, lanes: controls.lanes }
    }
}

pub struct Engine {
    options: Arc<Options>,
    state: State,
    scene: Arc<Scene>,
    loader: Loader,
    files: Files,
    events: Receiver<(Event, Instant)>,
    exchange: Arc<Exchange>,
    wake: Wake,
    film: Film,
    painter: Painter,
    frame: Frame,
    rates: Rates,
    summary: Summary,
    pose: Pose,
    /// Does the film hold samples of the seed that was asked for, from the first one on?
    still: bool,
    /// Has history heard of this pose?
    known: bool,
    /// Of the pixels that hold a frame rate.
    coarseness: f64,
    /// When the last frame was handed over, and when the next one is due.
    shown: Instant,
    due: Instant,
    /// How long the last sample took, and painting the last frame.
    sample: Duration,
    painting: Duration,
    /// Of the oldest event that no frame shows yet.
    unanswered: Option<Instant>,
    /// When another scene was asked for that is not there yet.
    asked: Option<Instant>,
    /// Did it arrive, and no frame shows it yet?
    arrived: bool,
    message: Option<Instant>,
    shoot: bool,
}

/// Why a renderer is done.
enum Next {
    Swap(Box<Ready>),
    Over,
}

/// Stops samples that take longer than a frame and that nobody waits for once something happens.
struct Impatience<'a> {
    exchange: Option<&'a Exchange>,
    due: Instant,
}

impl Watch for Impatience<'_> {
    fn stop(&self) -> bool {
        self.exchange.is_some_and(Exchange::has_news) && Instant::now() >= self.due
    }
    fn done(&self, _pixels: usize, _rays: u64) {}
}

impl Engine {
    /// Makes the first scene ready.
    pub fn new(
        options: Arc<Options>,
        state: State,
        scene: Arc<Scene>,
        events: Receiver<(Event, Instant)>,
        exchange: Arc<Exchange>,
        wake: Wake,
    ) -> (Self, Renderer) {
        let renderer = Renderer::new(&scene, settings(&scene, &state.controls, &options));
        let film = renderer.film();
        let now = Instant::now();
        let pose = Pose {
            camera: scene.camera,
            resolution: renderer.settings().resolution,
            bounces: state.controls.bounces,
        };
        let engine = Self {
            painter: Painter::default(),
            loader: Loader::start(),
            files: Files::none(),
            frame: Frame::default(),
            rates: Rates::default(),
            summary: Summary::default(),
            pose,
            still: true,
            known: false,
            coarseness: 1.0,
            shown: now,
            due: now,
            sample: Duration::ZERO,
            painting: Duration::ZERO,
            unanswered: None,
            asked: None,
            arrived: false,
            message: None,
            shoot: false,
            options,
            state,
            scene,
            events,
            exchange,
            wake,
            film,
        };
        (engine, renderer)
    }

    /// Goes on until somebody quits.
    pub fn run(mut self, mut renderer: Renderer) -> Summary {
        self.watch();
        self.arrive(&renderer);
        while let Next::Swap(ready) = renderer.hold(|renderer| self.serve(renderer)) {
            renderer = self.swap(*ready);
        }
        self.frame.over = true;
        self.exchange.give(&mut self.frame);
        (self.wake)();
        self.summary
    }

    /// Goes on with a scene, or a way to render it, that has become ready.
    fn swap(&mut self, ready: Ready) -> Renderer {
        let Ready { scene, renderer, again } = ready;
        if Arc::ptr_eq(&scene, &self.scene) {
            self.rates.switch();
        } else {
            self.arrived = !again;
            self.state.arrive(&scene, again);
            self.scene = scene;
            self.painter.meet_another_scene();
            self.watch();
            self.rates.forget();
            self.set_message("");
        }
        self.film = renderer.film();
        self.arrive(&renderer);
        renderer
    }

    /// A renderer is new: nothing is known of its pictures.
    fn arrive(&mut self, renderer: &Renderer) {
        let settings = renderer.settings();
        self.pose = Pose {
            camera: self.scene.camera,
            resolution: settings.resolution,
            bounces: settings.max_bounces,
        };
        (self.still, self.known) = (true, false);
        self.painter.forget();
    }

    /// Watches the files of the scene that is shown, and of the one that should be.
    fn watch(&mut self) {
        let wanted = Path::new(self.state.playlist.current());
        self.files.watch(self.scene.files.iter().map(PathBuf::as_path).chain([wanted]));
    }

    /// Frame after frame with one renderer.
    fn serve(&mut self, renderer: &mut Renderer) -> Next {
        loop {
            self.exchange.hear();
            if self.listen(renderer) {
                return Next::Over;
            }
            match self.loader.take() {
                Some(Ok(ready)) => return Next::Swap(Box::new(ready)),
                Some(Err(error)) => {
                    self.set_message(&error.to_string());
                    // Whoever mends the file sees the scene.
                    self.watch();
                }
                None => {}
            }
            if self.files.have_changed(Instant::now()) {
                self.load(true);
            }
            self.state.advance(Instant::now());
            self.expose(renderer);
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
    fn listen(&mut self, renderer: &Renderer) -> bool {
        while let Ok((event, at)) = self.events.try_recv() {
            if !matches!(event, Event::Rate(_)) {
                self.unanswered.get_or_insert(at);
            }
            match self.state.handle(&event, at) {
                Some(Effect::Quit) => return true,
                Some(Effect::Screenshot) => self.shoot = true,
                Some(Effect::Load) => {
                    self.asked = Some(at);
                    self.load(false);
                }
                Some(Effect::Reload) => self.load(true),
                None => {}
            }
        }
        let wanted = Build::of(&self.scene, &self.state.controls, &self.options);
        let Settings { methods, threads, lanes, .. } = *renderer.settings();
        if !self.loader.busy() && wanted != (Build { methods, threads, lanes }) {
            self.order(Source::Here(self.scene.clone()), true);
        }
        false
    }

    /// Has the playlist's scene read.
    fn load(&mut self, again: bool) {
        let name = self.state.playlist.current().to_string();
        if !again {
            self.set_message(&format!("reading {name}"));
        }
        self.order(Source::Name(name), again);
    }

    fn order(&mut self, source: Source, again: bool) {
        let (controls, options) = (self.state.controls, self.options.clone());
        let keep = again.then_some(controls.bounces).or(options.bounces);
        let settings = move |scene: &Scene| {
            let bounces = keep.unwrap_or(scene.max_bounces);
            settings(scene, &Controls { bounces, ..controls }, &options)
        };
        self.loader.order(Order { source, settings: Box::new(settings), again });
    }

    /// Takes samples of where the camera is now, at least one, until a frame is due.
    fn expose(&mut self, renderer: &mut Renderer) {
        self.pose(renderer);
        // From when the last one was due: a frame that came late takes nothing from those behind it, but there is no catching up.
        let interval = Duration::from_secs_f64(1.0 / self.state.rate);
        self.due = (self.due + interval).max(self.shown + interval / 2);
        let due = self.due - self.painting.min(interval / 2);
        loop {
            if self.film.samples() >= MOST_SAMPLES {
                thread::sleep(due.saturating_duration_since(Instant::now()));
                break;
            }
            // Whoever looks at a standing picture has one already; whoever moves needs this one.
            let finished = self.still && self.film.samples() > 0;
            let watch = Impatience { exchange: finished.then_some(&self.exchange), due };
            let (start, before) = (Instant::now(), (self.film.pixel_samples(), self.film.rays()));
            renderer.add_samples_watched(&mut self.film, 1, &watch);
            let time = start.elapsed();
            let pixels = f64::from(self.pose.resolution[0]) * f64::from(self.pose.resolution[1]);
            let samples = (self.film.pixel_samples() - before.0) as f64 / pixels;
            self.rates.samples(renderer.settings().lanes, samples, self.film.rays() - before.1, time);
            self.summary.samples += samples;
            self.summary.tracing += time;
            if samples == 1.0 {
                self.sample = time;
            }
            if Instant::now() + self.sample / 2 >= due {
                break;
            }
        }
    }

    /// Points the renderer where the camera is, and gives what it sees a film of its own.
    fn pose(&mut self, renderer: &mut Renderer) {
        let own = self.options.size.unwrap_or(self.scene.resolution);
        let pose = Pose {
            camera: *self.state.walker.camera(),
            resolution: self.state.controls.resolution(own, self.coarseness),
            bounces: self.state.controls.bounces,
        };
        let before = std::mem::replace(&mut self.pose, pose);
        if pose == before {
            if !self.still {
                self.still = true;
                self.film.clear();
                renderer.set_seed(self.options.seed);
            }
            return;
        }
        renderer.set_view(&self.scene, &pose.camera, pose.resolution, pose.bounces);
        (self.known, self.still) = (false, false);
        if pose.bounces != before.bounces || pose.resolution != before.resolution {
            // Another picture, not the same one from elsewhere.
            self.painter.forget();
            self.rates.forget();
            self.still = true;
        }
        if pose.resolution != before.resolution {
            self.film = renderer.film();
        } else {
            self.film.clear();
        }
        let moving = self.options.seed.wrapping_add(1).wrapping_add(self.summary.frames as u32);
        renderer.set_seed(if self.still { self.options.seed } else { moving });
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
            camera: &self.pose.camera,
            film: &self.film,
            controls: &self.state.controls,
            known: self.known,
        };
        self.painter.paint(&subject, &mut self.frame);
        self.known = true;
        if let Some(speed) = self.painter.speed() {
            self.state.speed = f64::from(speed);
        }
        self.frame.caught = self.state.caught;
        self.frame.help = self.state.controls.help;
        let now = Instant::now();
        let since = now - self.shown;
        self.rates.frame(since);
        self.painter.write(&subject, &self.state, &self.rates, self.loader.busy(), &mut self.frame);
        self.hold_rate();
        self.shown = now;
        self.painting = start.elapsed();
        self.summary.painting += self.painting;
        self.summary.frame(since, self.unanswered.take().map(|at| now - at));
        if std::mem::take(&mut self.arrived)
            && let Some(asked) = self.asked.take()
        {
            self.summary.switched(now - asked);
        }
        self.exchange.give(&mut self.frame);
        (self.wake)();
    }

    /// Makes pixels coarser where frames take too long, finer where there is time.
    fn hold_rate(&mut self) {
        let Some(target) = self.state.controls.target else {
            self.coarseness = 1.0;
            return;
        };
        let wanted = 1.0 / f64::from(target);
        // What a frame takes at least; waiting for the display is no reason for coarser pixels.
        let needed = self.sample + self.painting;
        if needed.as_secs_f64() > wanted * 1.05 {
            self.coarseness = (self.coarseness * STEP).max(0.05);
        } else if needed.as_secs_f64() < wanted * STEP.powi(3) && self.coarseness < 1.0 {
            self.coarseness = (self.coarseness / STEP).min(1.0);
        }
    }

    fn set_message(&mut self, text: &str) {
        self.painter.message(text);
        self.message = (!text.is_empty()).then(Instant::now);
    }

    fn shoot(&mut self, renderer: &Renderer) {
        // All pixels of the same number of samples, as whoever renders it again will have them.
        let uneven = self.film.most_samples() - self.film.samples();
        renderer.add_samples(&mut self.film, uneven);
        let shot = Shot {
            scene: &self.scene,
            camera: &self.pose.camera,
            settings: renderer.settings(),
            film: &self.film,
            tone: &self.state.controls.tone,
        };
        let text = match screenshot::take(&self.options.screenshots, &shot) {
            Ok(place) => format!("saved {}.png, .exr and .json", place.display()),
            Err(error) => error.to_string(),
        };
        self.set_message(&text);
    }
}

/// How a scene is rendered as things stand, from its own camera.
fn settings(scene: &Scene, controls: &Controls, options: &Options) -> Settings {
    let Build { methods, threads, lanes } = Build::of(scene, controls, options);
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
