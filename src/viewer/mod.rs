//! A window, or a terminal, to walk through a path-traced scene in.
//!
//! For: [`window()`], [`terminal()`] and [`Options`]. May import: everything above it. Must never know: command lines.
//!
//! A front end reports what happens and shows frames; everything else goes on in a thread of its own.
//!
//! | file | what it does |
//! |---|---|
//! | [`mod@window`], [`mod@terminal`] | the front ends |
//! | [`keys`] | what keys do: the table behind state machine and help |
//! | [`state`] | the state machine: from events to camera, choices and things to do |
//! | [`walker`], [`controls`], [`playlist`] | its parts: the camera that walks; what is chosen; the scenes |
//! | [`engine`], [`exposure`] | the thread that traces; what the film sees, and for how long |
//! | [`loader`], [`watch`] | the thread that reads scenes; the files that change |
//! | [`painter`] | from film to pixels: reprojection, filters, tone mapping |
//! | [`views`], [`map`] | what else can be shown |
//! | [`rates`], [`figures`], [`summary`] | how fast it goes, and in words |
//! | [`told`] | Ctrl-C and its like |
//! | [`screenshot`] | a picture, and how to render it again |
//! | [`frame`] | what the engine hands to a front end |
//! | [`canvas`] | a frame enlarged, with text over it |

pub mod canvas;
pub mod controls;
pub mod engine;
pub mod exposure;
pub mod figures;
pub mod frame;
pub mod keys;
pub mod loader;
pub mod map;
pub mod painter;
pub mod playlist;
pub mod rates;
pub mod screenshot;
pub mod state;
pub mod summary;
pub mod terminal;
pub mod told;
pub mod views;
pub mod walker;
pub mod watch;
pub mod window;

pub use summary::Summary;
pub use terminal::terminal;
pub use window::{WindowError, window};

use crate::render::PipelineChoice;
use crate::scene::Loaded;
use crate::tone::Tone;
use crate::traverse::Methods;
use controls::Controls;
use engine::Engine;
use frame::{Exchange, Frame};
use playlist::Playlist;
use state::{Event, State};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

/// Memory that a pixel takes, filters apart: the film, what is remembered of earlier frames and seen of the scene, frames. Measured.
pub const BYTES_PER_PIXEL: usize = 180;

/// What the viewer starts with.
pub struct Options {
    /// Pixels of all scenes' pictures; their own if `None`.
    pub size: Option<[u32; 2]>,
    /// Scattering events on a path in all scenes; their own if `None`.
    pub bounces: Option<u32>,
    pub seed: u32,
    pub pipeline: PipelineChoice,
    /// As in [`crate::render::Settings`].
    pub clamp: f32,
    pub threads: usize,
    /// As many as can be chosen.
    pub most_threads: usize,
    pub lanes: usize,
    pub tone: Tone,
    /// Frames a second to hold by coarser pixels.
    pub target: Option<u32>,
    /// The methods asked for, which may depend on the scene.
    pub methods: Box<dyn Fn(&Loaded) -> Methods + Send + Sync>,
    /// Is there memory for a picture of so many pixels across and down? If not, why.
    pub fits: Box<dyn Fn([u32; 2]) -> Result<(), String> + Send + Sync>,
    /// Ends after so many frames.
    pub frames: Option<u64>,
    /// The folder for screenshots.
    pub screenshots: PathBuf,
}

/// Called by the engine when a frame is there.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// A running engine, as a front end has it.
pub struct Viewer {
    events: Sender<(Event, Instant)>,
    exchange: Arc<Exchange>,
    thread: JoinHandle<Summary>,
}

impl Viewer {
    /// Starts with a scene that is read already, the playlist's current one.
    pub fn start(options: Options, playlist: Playlist, scene: Loaded, wake: Wake) -> Self {
        let bounces = options.bounces.unwrap_or(scene.max_bounces);
        let mut controls = Controls::new(bounces, options.threads, options.lanes, options.tone);
        controls.target = options.target;
        controls.most_threads = options.most_threads;
        let state = State::new(playlist, &scene, controls, options.bounces, Instant::now());
        let (events, incoming) = channel();
        let exchange = Arc::new(Exchange::default());
        let (shared, scene) = (exchange.clone(), Arc::new(scene));
        let thread = std::thread::spawn(move || {
            let _end = End { exchange: shared.clone(), wake: wake.clone() };
            let size = options.size.unwrap_or(scene.resolution);
            shared.give(&mut Frame::announcing(&scene.name, size));
            wake();
            let (engine, renderer) = Engine::new(Arc::new(options), state, scene, incoming, shared, wake);
            engine.run(renderer)
        });
        Self { events, exchange, thread }
    }
    /// Tells what happened just now.
    pub fn send(&self, event: Event) {
        // An engine that is over hears nothing, and need not.
        let _ = self.events.send((event, Instant::now()));
        self.exchange.tell();
    }
    /// The newest frame in exchange for an old one; false, and nothing, if there is no newer one.
    pub fn take(&self, frame: &mut Frame) -> bool {
        self.exchange.take(frame)
    }
    /// Is the engine over, in order or not?
    pub fn is_over(&self) -> bool {
        self.exchange.is_over()
    }
    /// Ends it all. An engine that is still making its first scene ready is left to itself.
    ///
    /// # Panics
    /// If the engine did.
    pub fn finish(self) -> Summary {
        self.send(Event::Quit);
        self.exchange.leave();
        if !self.exchange.is_ready() && !self.exchange.is_over() {
            return Summary::default();
        }
        self.thread.join().expect("the engine ends in order")
    }
}

/// Tells the front end that no frame comes any more, whatever the reason.
struct End {
    exchange: Arc<Exchange>,
    wake: Wake,
}

impl Drop for End {
    fn drop(&mut self) {
        self.exchange.end();
        (self.wake)();
    }
}
