//! Starts the render loop in a thread of its own and connects a front end to it.

use super::controls::Controls;
use super::frame::{Exchange, Frame};
use super::options::{Options, Wake};
use super::playlist::Playlist;
use super::render_loop::RenderLoop;
use super::state::{Event, State};
use super::timing::Summary;
use octray_formats::scene::Loaded;
#[cfg(unix)]
use signal_hook::{consts, flag};
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::Ordering::{Acquire, Release};
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

/// A front end's handle of a running render loop.
pub struct Viewer {
    events: Sender<(Event, Instant)>,
    exchange: Arc<Exchange>,
    thread: JoinHandle<Summary>,
}

impl Viewer {
    /// Starts with the playlist's current scene, already loaded.
    pub fn start(options: Options, playlist: Playlist, scene: Loaded, wake: Wake) -> Self {
        let requested = (options.settings)(&scene);
        let mut controls = Controls::new(&requested, options.tone);
        (controls.target, controls.max_threads) = (options.target, options.max_threads);
        let state = State::new(playlist, &scene, controls);
        let (events, incoming) = channel();
        let exchange = Arc::new(Exchange::default());
        let (shared, scene) = (exchange.clone(), Arc::new(scene));
        let thread = std::thread::spawn(move || {
            let mut frame = Frame { title: scene.name.clone(), ..Frame::default() };
            frame.message = format!("preparing {}", scene.name);
            frame.resize(requested.resolution);
            shared.publish(&mut frame);
            wake();
            RenderLoop::run(Arc::new(options), state, scene, incoming, shared, wake)
        });
        Self { events, exchange, thread }
    }
    /// Sends an event with the present time.
    pub fn send(&self, event: Event) {
        // Sending fails only if the render loop has ended, which then needs no event.
        let _ = self.events.send((event, Instant::now()));
        self.exchange.notified.store(true, Release);
    }
    /// Swaps `frame` for a newer one; returns false and changes nothing if there is none.
    pub fn swap_newer(&self, frame: &mut Frame) -> bool {
        self.exchange.swap_newer(frame)
    }
    /// Tests whether the render loop has ended, by a panic or otherwise.
    pub(crate) fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }
    /// Ends the render loop, and waits for that unless it is still preparing its first scene.
    ///
    /// # Panics
    /// If the render loop panicked.
    pub fn finish(self) -> Summary {
        self.send(Event::Quit);
        self.exchange.closed.store(true, Release);
        if !self.exchange.ready.load(Acquire) && !self.is_finished() {
            return Summary::default();
        }
        self.thread.join().expect("the render loop does not panic")
    }
}

/// Returns a flag that SIGINT, SIGTERM and SIGHUP set, so that the program can restore the terminal and print
/// its figures before it ends. On systems other than Unix the signals end the program at once.
pub fn exit_flag() -> io::Result<Arc<AtomicBool>> {
    let exit = Arc::default();
    #[cfg(unix)]
    for signal in [consts::SIGTERM, consts::SIGHUP, consts::SIGINT] {
        flag::register(signal, Arc::clone(&exit))?;
    }
    Ok(exit)
}
