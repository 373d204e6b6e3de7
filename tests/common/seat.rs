//! A viewer without a window: the test is its front end.
#![allow(dead_code)] // Every test file takes its own part.

use octray::render::Settings;
use octray::tone::Tone;
use octray::viewer::frame::Frame;
use octray::viewer::keys::Key;
use octray::viewer::playlist::Playlist;
use octray::viewer::state::Event;
use octray::viewer::{Options, Viewer};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// What `octray view` starts with where nothing is said, with frames as large as these.
pub fn options(size: [u32; 2], threads: usize, screenshots: &Path) -> Options {
    Options {
        settings: Box::new(move |scene| Settings {
            resolution: size,
            lanes: 8,
            threads,
            ..Settings::of(scene)
        }),
        max_threads: threads,
        tone: Tone::default(),
        target: None,
        renderer: octray::methods::renderer,
        fits: Box::new(|_| Ok(())),
        frames: None,
        screenshots: screenshots.into(),
    }
}

pub struct Seat {
    pub viewer: Viewer,
    /// The last frame that was taken.
    pub frame: Frame,
    made: Arc<AtomicU64>,
}

impl Seat {
    pub fn start(options: Options, names: &[&str]) -> Self {
        let first = octray::scene::load_with_view(names[0]).unwrap();
        let playlist = Playlist::new(names).unwrap();
        let made = Arc::new(AtomicU64::new(0));
        let count = made.clone();
        let wake = move || {
            count.fetch_add(1, Ordering::SeqCst);
        };
        Self {
            viewer: Viewer::start(options, playlist, first, Arc::new(wake)),
            frame: Frame::default(),
            made,
        }
    }
    /// How often a frame was ready.
    pub fn made(&self) -> u64 {
        self.made.load(Ordering::SeqCst)
    }
    pub fn key(&self, key: Key, down: bool) {
        self.viewer.send(Event::Key { key, down, repeat: false });
    }
    pub fn press(&self, key: Key) {
        self.key(key, true);
        self.key(key, false);
    }
}
