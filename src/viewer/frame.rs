//! What the thread that traces hands to the one that shows.
//!
//! For: [`Frame`] and [`Exchange`]. May import: the standard library. Must never know: how a frame is made or shown.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// Pixels, and what goes with them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// 0x00RRGGBB, row by row from the top.
    pub pixels: Vec<u32>,
    pub width: u32,
    pub height: u32,
    /// A picture to lay over the upper right corner: the map; empty where there is none.
    pub inset: Vec<u32>,
    /// Width of the inset, which is square.
    pub inset_side: u32,
    /// Figures, line by line; empty where nobody wants them.
    pub figures: String,
    /// What went wrong or was done, for a while.
    pub message: String,
    /// Are all keys to be explained?
    pub help: bool,
    /// Is the mouse to be caught?
    pub caught: bool,
    /// Of the window.
    pub title: String,
}

impl Frame {
    /// No picture yet: that a scene is being made ready.
    pub fn announcing(scene: &str, resolution: [u32; 2]) -> Self {
        let mut frame =
            Self { message: format!("making {scene} ready"), title: scene.to_string(), ..Self::default() };
        frame.resize(resolution);
        frame
    }
    pub fn resize(&mut self, [width, height]: [u32; 2]) {
        (self.width, self.height) = (width, height);
        self.pixels.resize(width as usize * height as usize, 0);
    }
}

/// Where frames change hands: nobody waits for anybody, and nothing is copied. A frame that nobody took is overwritten by the next.
#[derive(Debug, Default)]
pub struct Exchange {
    /// And whether nobody has taken it yet.
    frame: Mutex<(Frame, bool)>,
    /// Has something happened that the tracing thread should hear of at once?
    news: AtomicBool,
    /// Is the first scene ready to be traced?
    ready: AtomicBool,
    /// Does nobody wait for another frame?
    leaving: AtomicBool,
    /// Is the last frame given?
    over: AtomicBool,
}

impl Exchange {
    /// Hands a frame over; gets an old one back to paint over.
    pub fn give(&self, frame: &mut Frame) {
        let mut held = self.lock();
        std::mem::swap(frame, &mut held.0);
        held.1 = true;
    }
    /// The newest frame in exchange for an old one; false, and nothing, if there is no newer one.
    pub fn take(&self, frame: &mut Frame) -> bool {
        let mut held = self.lock();
        let fresh = std::mem::take(&mut held.1);
        if fresh {
            std::mem::swap(frame, &mut held.0);
        }
        fresh
    }
    pub fn tell(&self) {
        self.news.store(true, Ordering::Release);
    }
    pub fn hear(&self) {
        self.news.store(false, Ordering::Release);
    }
    pub fn has_news(&self) -> bool {
        self.news.load(Ordering::Acquire)
    }

    /// Events are heard from now on.
    pub fn set_ready(&self) {
        self.ready.store(true, Ordering::Release);
    }
    pub fn is_ready(&self) -> bool {
        self.ready.load(Ordering::Acquire)
    }

    /// No frame is waited for any more.
    pub fn leave(&self) {
        self.leaving.store(true, Ordering::Release);
    }
    pub fn is_left(&self) -> bool {
        self.leaving.load(Ordering::Acquire)
    }

    /// No frame comes any more.
    pub fn end(&self) {
        self.over.store(true, Ordering::Release);
    }
    pub fn is_over(&self) -> bool {
        self.over.load(Ordering::Acquire)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, (Frame, bool)> {
        // A swap cannot panic half done.
        self.frame.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_frame_is_taken_once_and_buffers_go_around() {
        let exchange = Exchange::default();
        let (mut back, mut front) = (Frame::default(), Frame::default());
        assert!(!exchange.take(&mut front));
        for number in 1..=3 {
            back.resize([number, 1]);
            back.pixels[0] = number;
            exchange.give(&mut back);
        }
        assert!(exchange.take(&mut front));
        assert_eq!((front.width, front.pixels[0]), (3, 3));
        assert!(!exchange.take(&mut front));
        assert_eq!(front.width, 3);
    }
}
