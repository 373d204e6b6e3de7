//! Frame rates, sample rates and latencies.
//!
//! For: [`RateMeter`], the present rates; [`Summary`], the sums of a run. May import: the standard library.
//! Must not know: clocks (durations are passed in), windows.

use std::time::Duration;

/// Number of frames behind the frame rates.
const FRAMES: usize = 256;
/// Least tracing time behind a sample rate.
const MIN_TIME: Duration = Duration::from_millis(100);

/// Measures frame rates over the last frames, and sample rates by width.
#[derive(Clone, Debug)]
pub struct RateMeter {
    /// Seconds from frame to frame: a ring buffer.
    frames: [f32; FRAMES],
    filled: usize,
    next: usize,
    /// Samples of the whole picture since the last rate and their time, by width: SIMD, scalar.
    taken: [(f64, Duration); 2],
    /// The last sample rates, by width.
    sample_rates: [Option<f64>; 2],
    rays: (u64, Duration),
    mrays: f64,
}

/// The present rates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// Frames per second: the median, and the 1 % low.
    pub fps: f64,
    pub low: f64,
    /// Samples of the whole picture per second: SIMD, scalar.
    pub samples: [Option<f64>; 2],
    pub mrays: f64,
}

impl Default for RateMeter {
    fn default() -> Self {
        Self {
            frames: [0.0; FRAMES],
            filled: 0,
            next: 0,
            taken: [(0.0, Duration::ZERO); 2],
            sample_rates: [None; 2],
            rays: (0, Duration::ZERO),
            mrays: 0.0,
        }
    }
}

impl RateMeter {
    /// Records a frame, shown `after` the previous one.
    pub fn frame(&mut self, after: Duration) {
        self.frames[self.next] = after.as_secs_f32();
        self.next = (self.next + 1) % FRAMES;
        self.filled = (self.filled + 1).min(FRAMES);
    }
    /// Records samples of the whole picture, taken with packets of `lanes`.
    pub fn samples(&mut self, lanes: usize, samples: f64, rays: u64, time: Duration) {
        let width = usize::from(lanes == 1);
        let (count, spent) = &mut self.taken[width];
        *count += samples;
        *spent += time;
        if *spent >= MIN_TIME {
            self.sample_rates[width] = Some(*count / spent.as_secs_f64());
            (*count, *spent) = (0.0, Duration::ZERO);
        }
        self.rays.0 += rays;
        self.rays.1 += time;
        if self.rays.1 >= MIN_TIME {
            self.mrays = self.rays.0 as f64 / self.rays.1.as_secs_f64() / 1e6;
            self.rays = (0, Duration::ZERO);
        }
    }
    /// Discards everything: another scene or other settings.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
    /// Discards the frame rates and keeps both widths' sample rates.
    pub fn switch_width(&mut self) {
        let sample_rates = self.sample_rates;
        self.reset();
        self.sample_rates = sample_rates;
    }
    pub fn rates(&self) -> Rates {
        let mut frames = self.frames;
        let frames = &mut frames[..self.filled];
        frames.sort_unstable_by(f32::total_cmp);
        let rate = |share: f64| match frames.len() {
            0 => 0.0,
            some => 1.0 / f64::from(frames[((some - 1) as f64 * share).round() as usize].max(1e-9)),
        };
        Rates { fps: rate(0.5), low: rate(0.99), samples: self.sample_rates, mrays: self.mrays }
    }
}

/// Sums over all frames of a run.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    pub frames: u64,
    /// Samples of whole pictures.
    pub samples: f64,
    /// Time spent on tracing, and on painting frames: filters, tone mapping, text.
    pub tracing: Duration,
    pub painting: Duration,
    /// Time until the last frame.
    pub elapsed: Duration,
    /// Latency from an event to the frame that shows it: maximum, sum, count.
    pub max_latency: Duration,
    pub latency_sum: Duration,
    pub latencies: u64,
    /// Longest time from requesting another scene to its first frame.
    pub max_switch_time: Option<Duration>,
}

impl Summary {
    /// Records a frame, published `after` the previous one, with the latency of the oldest event that it
    /// shows.
    pub fn frame(&mut self, after: Duration, latency: Option<Duration>) {
        self.elapsed += after;
        self.frames += 1;
        if let Some(latency) = latency {
            self.max_latency = self.max_latency.max(latency);
            self.latency_sum += latency;
            self.latencies += 1;
        }
    }
    /// Records a switch to another scene, shown `after` the request.
    pub fn switched(&mut self, after: Duration) {
        self.max_switch_time = self.max_switch_time.max(Some(after));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_have_a_median_and_a_low() {
        let mut rates = RateMeter::default();
        assert_eq!(rates.rates(), Rates::default());
        for number in 0..100 {
            rates.frame(Duration::from_millis(if number % 50 == 7 { 100 } else { 20 }));
        }
        let Rates { fps, low, .. } = rates.rates();
        assert!((fps - 50.0).abs() < 1e-3 && (low - 10.0).abs() < 1e-3, "{fps} {low}");
        for _ in 0..FRAMES {
            rates.frame(Duration::from_millis(10));
        }
        assert!((rates.rates().low - 100.0).abs() < 1e-3, "old frames are forgotten");
    }

    #[test]
    fn both_widths_have_a_rate_side_by_side() {
        let mut rates = RateMeter::default();
        rates.samples(8, 50.0, 1_000_000, Duration::from_millis(50));
        assert_eq!(rates.rates().samples, [None, None], "too short a time");
        rates.samples(8, 50.0, 1_000_000, Duration::from_millis(50));
        rates.switch_width();
        rates.samples(1, 20.0, 400_000, Duration::from_millis(100));
        let Rates { samples, mrays, .. } = rates.rates();
        assert_eq!(samples, [Some(1_000.0), Some(200.0)]);
        assert!((mrays - 4.0).abs() < 1e-9);
        rates.reset();
        assert_eq!(rates.rates(), Rates::default());
    }
}
