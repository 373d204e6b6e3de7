//! Adapts the resolution to hold a target frame rate.

use std::time::Duration;

/// Frame time that a new resolution aims at, relative to the target's.
const TARGET_SHARE: f64 = 0.95;
/// Frame time below which a higher resolution is chosen, relative to the target's.
const MIN_SHARE: f64 = 0.6;
const MIN_RESOLUTION_SCALE: f64 = 0.05;

/// The scale of the resolution, chosen by the time of frames.
#[derive(Clone, Copy, Debug)]
pub struct DynamicResolution {
    /// Scale of the resolution's sides that holds the target frame rate; at most 1.
    pub scale: f64,
    /// Time of the fastest frame since the last decision. A decision needs two frames, because one alone may
    /// have been delayed by another program.
    fastest: Option<Duration>,
    /// Whether the frame time was within the target's bounds at the last decision.
    target_met: bool,
}

impl Default for DynamicResolution {
    fn default() -> Self {
        Self { scale: 1.0, fastest: None, target_met: false }
    }
}

impl DynamicResolution {
    /// Discards the measured frames and keeps the scale, after a change of the resolution or the renderer.
    pub fn restart(&mut self) {
        *self = Self { scale: self.scale, ..Self::default() };
    }

    /// Lowers the scale when frames take longer than the target allows, raises it when there is time.
    /// `needed` is the time of the last frame. A `settled` picture keeps its scale once the target is met.
    pub fn adapt(&mut self, target: Option<u32>, needed: Duration, settled: bool) {
        let Some(target) = target else {
            self.scale = 1.0;
            return;
        };
        let fastest = self.fastest.map_or(needed, |before| before.min(needed));
        let is_first = self.fastest.replace(fastest).is_none();
        if is_first || (self.target_met && settled) {
            return;
        }
        self.fastest = None;
        let (needed, wanted) = (fastest.as_secs_f64(), 1.0 / f64::from(target));
        self.target_met = (wanted * MIN_SHARE..wanted * 1.05).contains(&needed);
        if !self.target_met {
            // Frame time is proportional to the number of pixels, the square of the scale.
            let step = (TARGET_SHARE * wanted / needed.max(1e-9)).sqrt();
            self.scale = (self.scale * step).clamp(MIN_RESOLUTION_SCALE, 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the scale, and its frame time as a share of the target's, after a number of frames on a
    /// machine that takes `ms` milliseconds for all pixels.
    fn after(resolution: &mut DynamicResolution, frames: u32, ms: f64, target: u32) -> (f64, f64) {
        let time = |scale: f64| Duration::from_secs_f64(ms * 1e-3 * scale.powi(2));
        let mut last = Duration::ZERO;
        for _ in 0..frames {
            last = time(resolution.scale);
            resolution.adapt(Some(target), last, false);
        }
        (resolution.scale, last.as_secs_f64() * f64::from(target))
    }

    #[test]
    fn resolution_drops_within_a_few_frames_as_far_as_the_frame_rate_needs_and_no_further() {
        let mut resolution = DynamicResolution::default();
        let mut settle = |target| after(&mut resolution, 3, 100.0, target);
        let [coarse, again, coarser, finer] = [30, 30, 60, 20].map(&mut settle);
        assert!([coarse, coarser, finer].iter().all(|(_, share)| (0.6..1.05).contains(share)));
        assert!(coarse.0 < 1.0 && coarser.0 < coarse.0 && finer.0 > coarse.0);
        assert_eq!(again.0, coarse.0, "at rest");
        assert_eq!(settle(5).0, 1.0);
        assert!(settle(1_000).0 < coarser.0);
        resolution.adapt(None, Duration::ZERO, false);
        assert_eq!(resolution.scale, 1.0);
    }
}
