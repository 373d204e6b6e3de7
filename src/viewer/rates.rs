//! How fast it goes: frames as shown, samples as taken.
//!
//! For: [`Rates`]. May import: the standard library. Must never know: clocks (it is told), windows.

use std::time::Duration;

/// Frames behind the figures.
const FRAMES: usize = 256;
/// Least time behind a rate of samples.
const ENOUGH: Duration = Duration::from_millis(100);

/// Times of the last frames, and the rates of both widths.
#[derive(Clone, Debug)]
pub struct Rates {
    /// Seconds from frame to frame: a ring.
    frames: [f32; FRAMES],
    filled: usize,
    next: usize,
    /// Samples of the whole picture and the time they took, by width: SIMD, scalar; and the rays of all.
    taken: [(f64, Duration); 2],
    /// The last rates known, by width.
    known: [Option<f64>; 2],
    rays: (u64, Duration),
    mrays: f64,
}

/// What the figures say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Frames a second in the median, and in the slowest hundredth.
    pub fps: f64,
    pub low: f64,
    /// Samples of the whole picture a second: SIMD, scalar.
    pub samples: [Option<f64>; 2],
    pub mrays: f64,
}

impl Default for Rates {
    fn default() -> Self {
        Self {
            frames: [0.0; FRAMES],
            filled: 0,
            next: 0,
            taken: [(0.0, Duration::ZERO); 2],
            known: [None; 2],
            rays: (0, Duration::ZERO),
            mrays: 0.0,
        }
    }
}

impl Rates {
    /// A frame is shown, so long after the one before.
    pub fn frame(&mut self, after: Duration) {
        self.frames[self.next] = after.as_secs_f32();
        self.next = (self.next + 1) % FRAMES;
        self.filled = (self.filled + 1).min(FRAMES);
    }
    /// Samples of the whole picture were taken by packets of `lanes`.
    pub fn samples(&mut self, lanes: usize, samples: f64, rays: u64, time: Duration) {
        let width = usize::from(lanes == 1);
        let (count, spent) = &mut self.taken[width];
        *count += samples;
        *spent += time;
        if *spent >= ENOUGH {
            self.known[width] = Some(*count / spent.as_secs_f64());
            (*count, *spent) = (0.0, Duration::ZERO);
        }
        self.rays.0 += rays;
        self.rays.1 += time;
        if self.rays.1 >= ENOUGH {
            self.mrays = self.rays.0 as f64 / self.rays.1.as_secs_f64() / 1e6;
            self.rays = (0, Duration::ZERO);
        }
    }
    /// Another scene, or another way to see it: what was known of it says nothing any more.
    pub fn forget(&mut self) {
        *self = Self::default();
    }
    /// Only the other width's rate stays known.
    pub fn switch(&mut self) {
        let known = self.known;
        self.forget();
        self.known = known;
    }
    pub fn figures(&self) -> Figures {
        let mut frames = self.frames;
        let frames = &mut frames[..self.filled];
        frames.sort_unstable_by(f32::total_cmp);
        let rate = |share: f64| match frames.len() {
            0 => 0.0,
            some => 1.0 / f64::from(frames[((some - 1) as f64 * share).round() as usize].max(1e-9)),
        };
        Figures { fps: rate(0.5), low: rate(0.99), samples: self.known, mrays: self.mrays }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_have_a_median_and_a_low() {
        let mut rates = Rates::default();
        assert_eq!(rates.figures(), Figures::default());
        for number in 0..100 {
            rates.frame(Duration::from_millis(if number % 50 == 7 { 100 } else { 20 }));
        }
        let Figures { fps, low, .. } = rates.figures();
        assert!((fps - 50.0).abs() < 1e-3 && (low - 10.0).abs() < 1e-3, "{fps} {low}");
        for _ in 0..FRAMES {
            rates.frame(Duration::from_millis(10));
        }
        assert!((rates.figures().low - 100.0).abs() < 1e-3, "old frames are forgotten");
    }

    #[test]
    fn both_widths_are_known_side_by_side() {
        let mut rates = Rates::default();
        rates.samples(8, 50.0, 1_000_000, Duration::from_millis(50));
        assert_eq!(rates.figures().samples, [None, None], "too short a time");
        rates.samples(8, 50.0, 1_000_000, Duration::from_millis(50));
        rates.switch();
        rates.samples(1, 20.0, 400_000, Duration::from_millis(100));
        let Figures { samples, mrays, .. } = rates.figures();
        assert_eq!(samples, [Some(1_000.0), Some(200.0)]);
        assert!((mrays - 4.0).abs() < 1e-9);
        rates.forget();
        assert_eq!(rates.figures(), Figures::default());
    }
}
