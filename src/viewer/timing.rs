//! Measures frame rates, pass rates and latencies.
//!
//! The *frame rate* is that of the screen, at most the display's. A pass is one sample of every pixel. The
//! *pass rate* is one over the median time of a pass, as the fps of `octray bench`: time between passes, for
//! painting and for the display, does not count.

use std::collections::VecDeque;
use std::time::Duration;

/// Number of frames that the frame rates are computed from.
const FRAMES: usize = 256;
/// Least tracing time that a pass rate is computed from, unless there are [`MAX_PASSES`].
const MIN_TIME: Duration = Duration::from_millis(250);
/// Most passes that a pass rate is computed from; the memory for their times is allocated at the start.
const MAX_PASSES: usize = 1024;

/// A meter of frame rates over the last frames and of pass rates by width.
#[derive(Clone, Debug)]
pub struct RateMeter {
    /// Seconds from frame to frame, the newest last.
    frames: VecDeque<f32>,
    /// Time of each pass since the last rate.
    times: Vec<Duration>,
    /// Rays of these passes.
    rays: u64,
    /// Passes per second of rendering, by width: SIMD, scalar.
    pub passes: [Option<f64>; 2],
    /// Millions of rays per second.
    pub mrays: f64,
}

impl Default for RateMeter {
    fn default() -> Self {
        let (frames, times) = (VecDeque::with_capacity(FRAMES), Vec::with_capacity(MAX_PASSES));
        Self { frames, times, rays: 0, passes: [None; 2], mrays: 0.0 }
    }
}

impl RateMeter {
    /// Records a frame, shown `after` the previous one.
    pub fn frame(&mut self, after: Duration) {
        if self.frames.len() == FRAMES {
            self.frames.pop_front();
        }
        self.frames.push_back(after.as_secs_f32());
    }
    /// Records a pass with packets of `lanes`, which change only after [`Self::switch_width`].
    pub fn pass(&mut self, lanes: usize, rays: u64, time: Duration) {
        self.times.push(time);
        self.rays += rays;
        let count = self.times.len();
        if count == MAX_PASSES || self.times.iter().sum::<Duration>() >= MIN_TIME {
            // A pass that another program interrupted does not change the median.
            let (_, median, _) = self.times.select_nth_unstable(count / 2);
            let rate = 1.0 / median.as_secs_f64().max(1e-9);
            self.passes[usize::from(lanes == 1)] = Some(rate);
            self.mrays = rate * self.rays as f64 / count as f64 / 1e6;
            self.times.clear();
            self.rays = 0;
        }
    }
    /// Discards everything, for another scene or other settings.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
    /// Discards the frame rates and keeps both widths' pass rates.
    pub fn switch_width(&mut self) {
        *self = Self { passes: self.passes, ..Self::default() };
    }
    /// Returns the median and the 1 % low of the frames per second.
    pub fn fps(&self) -> [f64; 2] {
        let mut frames = Vec::from(self.frames.clone());
        frames.sort_unstable_by(f32::total_cmp);
        [0.5, 0.99].map(|share| match frames.len() {
            0 => 0.0,
            some => 1.0 / f64::from(frames[((some - 1) as f64 * share).round() as usize].max(1e-9)),
        })
    }
}

/// The sums over all frames of a run.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// Frames published by the render loop.
    pub frames: u64,
    /// Passes: samples per pixel, over all frames.
    pub passes: f64,
    /// Time spent on tracing.
    pub tracing: Duration,
    /// Time spent on painting frames: filters, tone mapping, text.
    pub painting: Duration,
    /// Time until the last frame.
    pub elapsed: Duration,
    /// Longest latency from an event to the frame that shows it.
    pub max_latency: Duration,
    /// Sum of the latencies.
    pub latency_sum: Duration,
    /// Number of latencies: frames that show the effect of an event.
    pub latencies: u64,
    /// Longest time from requesting another scene to its first frame; `None` without such a request.
    pub max_switch_time: Option<Duration>,
    /// Frames that a window drew, fewer than published if the display is slower, and the time of scaling
    /// them, drawing their text, and presenting them; `None` in a terminal.
    pub presented: Option<(u64, Duration)>,
}

impl Summary {
    /// Records a frame, published `after` the previous one, with the latency of the oldest event that it
    /// shows.
    pub(crate) fn frame(&mut self, after: Duration, latency: Option<Duration>) {
        self.elapsed += after;
        self.frames += 1;
        if let Some(latency) = latency {
            self.max_latency = self.max_latency.max(latency);
            self.latency_sum += latency;
            self.latencies += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_have_a_median_and_a_low() {
        let mut rates = RateMeter::default();
        assert_eq!(rates.fps(), [0.0; 2]);
        for number in 0..100 {
            rates.frame(Duration::from_millis(if number % 50 == 7 { 100 } else { 20 }));
        }
        let [fps, low] = rates.fps();
        assert!((fps - 50.0).abs() < 1e-3 && (low - 10.0).abs() < 1e-3, "{fps} {low}");
        for _ in 0..FRAMES {
            rates.frame(Duration::from_millis(10));
        }
        assert!((rates.fps()[1] - 100.0).abs() < 1e-3, "old frames are forgotten");
    }

    #[test]
    fn both_widths_have_a_rate_side_by_side() {
        let mut rates = RateMeter::default();
        let take = |lanes, count, ms, rates: &mut RateMeter| {
            (0..count).for_each(|_| rates.pass(lanes, 20_000, Duration::from_millis(ms)));
        };
        take(8, 249, 1, &mut rates);
        assert_eq!(rates.passes, [None, None], "too short a time");
        take(8, 1, 1, &mut rates);
        assert!((rates.mrays - 20.0).abs() < 1e-9);
        rates.switch_width();
        take(1, 50, 5, &mut rates);
        assert_eq!(rates.passes, [Some(1_000.0), Some(200.0)]);
        assert!((rates.mrays - 4.0).abs() < 1e-9);
        rates.reset();
        assert_eq!(rates.passes, [None; 2]);
    }

    #[test]
    fn a_delayed_pass_does_not_change_the_rate() {
        let mut rates = RateMeter::default();
        (0..99).for_each(|_| rates.pass(16, 1_000, Duration::from_millis(1)));
        rates.pass(16, 1_000, Duration::from_millis(400));
        assert_eq!(rates.passes, [Some(1_000.0), None]);
    }
}
