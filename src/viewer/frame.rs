//! Hands frames over from the render loop to a front end.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

/// A frame to show: pixels, minimap, text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// 0x00RRGGBB, row by row from the top.
    pub pixels: Vec<u32>,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The minimap, a square for the upper right corner; empty without one.
    pub inset: Vec<u32>,
    /// Lines of figures; empty if switched off.
    pub figures: String,
    /// A temporary message or an error.
    pub message: String,
    /// Whether to show the help.
    pub help: bool,
    /// Whether to capture the mouse.
    pub mouse_captured: bool,
    /// The window's title.
    pub title: String,
}

impl Frame {
    pub(crate) fn resize(&mut self, [width, height]: [u32; 2]) {
        (self.width, self.height) = (width, height);
        self.pixels.resize(width as usize * height as usize, 0);
    }
}

/// The newest frame, handed over by swapping buffers, so that neither side waits and nothing is copied, and
/// the flags that both threads read. A frame that was not taken is replaced by the next one.
#[derive(Debug, Default)]
pub(crate) struct Exchange {
    /// The newest frame, and whether it is still to be taken.
    frame: Mutex<(Frame, bool)>,
    /// Whether events or results are pending for the render loop.
    pub notified: AtomicBool,
    /// Whether the render loop handles events.
    pub ready: AtomicBool,
    /// Whether the front end has closed: it takes no more frames.
    pub closed: AtomicBool,
}

impl Exchange {
    /// Publishes a frame; `frame` becomes an old one to paint over.
    pub fn publish(&self, frame: &mut Frame) {
        let mut held = self.frame.lock().expect("a swap does not panic");
        std::mem::swap(frame, &mut held.0);
        held.1 = true;
    }
    /// Swaps `frame` for a newer one; returns false and changes nothing if there is none.
    pub fn swap_newer(&self, frame: &mut Frame) -> bool {
        let mut held = self.frame.lock().expect("a swap does not panic");
        let fresh = std::mem::take(&mut held.1);
        if fresh {
            std::mem::swap(frame, &mut held.0);
        }
        fresh
    }
}
