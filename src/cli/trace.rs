//! Takes samples until a limit is reached or the user interrupts.
//!
//! For: [`trace`]. May import: `limits`, `interrupt`, `progress`, `render`. Must not know: files.

use super::interrupt::Interrupt;
use super::limits::Limits;
use super::progress::Progress;
use crate::adaptive::{ErrorEstimate, Round};
use crate::film::Film;
use crate::render::{RenderObserver, Renderer};
use crate::report::render::End;
use std::time::{Duration, Instant};

/// Target duration of a chunk of samples: short enough for Ctrl-C to feel immediate, long enough that the
/// overhead of a chunk is negligible.
const CHUNK: Duration = Duration::from_millis(100);
/// Time that a chunk has to finish after Ctrl-C or the deadline, so that every pixel has the same number of
/// samples. A chunk that takes longer stops between tiles.
const GRACE: Duration = Duration::from_millis(300);

/// Adds samples in chunks until a limit is reached or the user interrupts. Returns the time taken and why it
/// ended.
pub fn trace(
    renderer: &Renderer,
    film: &mut Film,
    limits: &Limits,
    interrupt: &Interrupt,
    progress: &Progress,
) -> (Duration, End) {
    let start = Instant::now();
    let deadline = limits.time.map(|time| start + time);
    let mut pace = Pace { chunk: 1, seconds_a_pixel: 0.0 };
    let end = loop {
        let Some(round) = next_round(film, limits) else {
            let met = limits.target.is_some_and(|target| target.met(&ErrorEstimate::of(film)));
            break if met { End::TargetError } else { End::Samples };
        };
        progress.expect(round.forecast);
        if let Some(end) = take_round(renderer, film, &round, &mut pace, deadline, interrupt, progress) {
            break end;
        }
    };
    (start.elapsed(), end)
}

/// The next round; `None` at the end.
fn next_round(film: &Film, limits: &Limits) -> Option<Round> {
    match &limits.target {
        Some(target) => target.next(film),
        None => Round::equal(film, limits.samples),
    }
}

/// The speed of sampling so far.
struct Pace {
    /// Samples per pixel in the next chunk.
    chunk: u32,
    /// Seconds per sample of a pixel; 0 before the first chunk.
    seconds_a_pixel: f64,
}

/// Brings all tiles to their goals, chunk by chunk, so that no tile runs ahead. Returns why it stopped early,
/// if it did.
fn take_round(
    renderer: &Renderer,
    film: &mut Film,
    round: &Round,
    pace: &mut Pace,
    deadline: Option<Instant>,
    interrupt: &Interrupt,
    progress: &Progress,
) -> Option<End> {
    loop {
        let (missing, pixels) = round.missing(film);
        if missing == 0 {
            return None;
        }
        if interrupt.requested() {
            return Some(End::Interrupt);
        }
        let mut chunk = pace.chunk.min(missing);
        let (began, whole) = (Instant::now(), film.samples() > 0);
        if let Some(deadline) = deadline {
            let left = deadline.saturating_duration_since(began).as_secs_f64();
            let fitting = (left / (pixels as f64 * pace.seconds_a_pixel).max(1e-12)) as u32;
            // The first sample starts in any case: a part of the picture is more than none.
            if left == 0.0 || (whole && fitting == 0) {
                return Some(End::TimeLimit);
            }
            chunk = chunk.min(fitting.max(1));
        }
        let late = deadline.map(|deadline| if whole { deadline + GRACE } else { deadline });
        let before = film.pixel_samples();
        let watch = Chunk { began, late, interrupt, progress };
        renderer.sample_tiles_to(film, |tile, had| round.goals[tile].min(had.saturating_add(chunk)), &watch);
        let took = began.elapsed();
        let done = film.pixel_samples() - before;
        pace.seconds_a_pixel = took.as_secs_f64() / (done as f64).max(1.0);
        pace.chunk = next_chunk(chunk, took);
    }
}

/// The observer of a chunk: counts progress, and stops the chunk after an interrupt or the deadline.
struct Chunk<'a> {
    began: Instant,
    late: Option<Instant>,
    interrupt: &'a Interrupt,
    progress: &'a Progress,
}

impl RenderObserver for Chunk<'_> {
    fn is_cancelled(&self) -> bool {
        let interrupted = self.interrupt.requested() && self.began.elapsed() >= GRACE;
        interrupted || self.late.is_some_and(|late| Instant::now() >= late)
    }
    fn sample_done(&self, pixels: usize, rays: u64) {
        self.interrupt.set_begun();
        self.progress.add(pixels, rays);
    }
}

/// Samples per pixel of the next chunk: as many as should take [`CHUNK`] at the speed of the last one, and at
/// most four times as many as in the last one, because short times are measured poorly.
fn next_chunk(last: u32, took: Duration) -> u32 {
    let fitting = f64::from(last) * CHUNK.as_secs_f64() / took.as_secs_f64().max(1e-9);
    (fitting as u32).clamp(1, last.saturating_mul(4))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::adaptive::Target;
    use crate::render::Settings;
    use crate::scene;

    #[test]
    fn next_chunk_aims_at_its_time_and_grows_slowly() {
        assert_eq!(next_chunk(10, CHUNK), 10);
        assert_eq!(next_chunk(10, CHUNK * 2), 5);
        assert_eq!(next_chunk(10, CHUNK / 2), 20);
        assert_eq!(next_chunk(10, CHUNK / 100), 40);
        assert_eq!(next_chunk(1, CHUNK * 100), 1);
        assert_eq!(next_chunk(10, Duration::ZERO), 40);
        assert_eq!(next_chunk(u32::MAX, Duration::ZERO), u32::MAX);
    }

    fn traced(limits: Limits, interrupt: &Interrupt) -> (Film, Duration, End) {
        let scene = scene::load("builtin:three").unwrap();
        let settings = Settings { resolution: [40, 24], max_bounces: 1, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let mut film = renderer.film_with_noise();
        let progress = Progress::new(settings.resolution, limits.time);
        let (time, end) = trace(&renderer, &mut film, &limits, interrupt, &progress);
        (film, time, end)
    }

    #[test]
    fn trace_adds_exactly_the_samples_asked_for() {
        for samples in [1, 2, 3, 7, 100] {
            let limits = Limits { samples, target: None, time: None };
            let (film, _, end) = traced(limits, &Interrupt::default());
            assert_eq!((film.samples(), film.most_samples(), end), (samples, samples, End::Samples));
        }
    }

    #[test]
    fn trace_ends_in_time_with_equal_pixels() {
        let time = Duration::from_millis(400);
        let limits = Limits { samples: 1 << 24, target: None, time: Some(time) };
        let (film, took, end) = traced(limits, &Interrupt::default());
        assert_eq!(end, End::TimeLimit);
        assert!(took >= time / 2 && took < time + 2 * GRACE, "{took:?}");
        assert!(film.samples() > 1 && film.samples() == film.most_samples());
    }

    #[test]
    fn trace_says_which_limit_came_first() {
        let target = |error, most| Some(Target { error, least: 16, most });
        let hour = Some(Duration::from_secs(3_600));
        let end = |samples, target, time| traced(Limits { samples, target, time }, &Interrupt::default()).2;
        assert_eq!(end(1 << 14, target(0.5, 1 << 14), hour), End::TargetError);
        assert_eq!(end(32, target(1e-4, 32), hour), End::Samples);
        let moment = Some(Duration::from_millis(50));
        assert_eq!(end(1 << 24, target(1e-4, 1 << 24), moment), End::TimeLimit);
        let interrupt = Interrupt::default();
        interrupt.request();
        assert_eq!(traced(Limits { samples: 8, target: None, time: None }, &interrupt).2, End::Interrupt);
    }
}
