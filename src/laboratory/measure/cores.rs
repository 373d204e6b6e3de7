//! Pins measuring threads to cores of their own, and finds what other programs took of their time.
//!
//! For: `on_own_cores`, [`Reliability`].
//!
//! A scheduler may leave two threads of a pool on one core for tens of milliseconds while another core is
//! idle. Pinned threads stay apart.
//!
//! What others took is no guess from slow frames. One thread never waits for another: others took its wall
//! time less its processor time, the hypervisor included where the system's clock knows of it. Threads of a
//! pool wait for each other at the end of each frame, which nobody takes from them: others took the time in
//! which such a thread could run and stood in the queue of its core, which the kernel counts.

use super::quantiles::Quantiles;
use serde::Serialize;
use std::sync::OnceLock;
use std::time::Instant;

/// Others took too much where they took more than this share of the time.
const BUSY: f64 = 0.05;

/// How a span of measuring went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Load {
    /// Seconds of processor time, of all threads; `None` where the system does not say.
    pub processor: Option<f64>,
    /// The share of the wall time that others took from the thread that lost most.
    pub taken: Option<f64>,
    /// Whether each thread had a core of its own.
    pub pinned: bool,
}

/// How far a figure can be relied on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reliability {
    /// Whether nothing tells of a busy machine or of too few samples.
    pub reliable: bool,
    /// Whether each measuring thread was pinned to a core of its own: not where there are more threads than
    /// cores, and on Linux alone.
    pub pinned: bool,
    /// The share of the time that other programs took, in the median turn; null where the system does not
    /// say.
    pub taken: Option<f64>,
}

impl Reliability {
    /// Judges the turns of a figure, which has enough samples or has not.
    pub(crate) fn of(loads: &[Load], enough: bool) -> Self {
        let taken: Option<Vec<f64>> = loads.iter().map(|load| load.taken).collect();
        let taken = taken.filter(|taken| !taken.is_empty()).map(|taken| Quantiles::of(taken).median());
        let pinned = loads.iter().all(|load| load.pinned);
        let judged = Self { reliable: enough, pinned, taken };
        Self { reliable: enough && !judged.is_busy(), ..judged }
    }
    /// The reliability of what is made of two figures.
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            reliable: self.reliable && other.reliable,
            pinned: self.pinned && other.pinned,
            taken: self.taken.zip(other.taken).map(|(one, other)| one.max(other)),
        }
    }
    /// Whether others took so much that the figure is wrong.
    pub fn is_busy(&self) -> bool {
        self.taken.is_some_and(|taken| taken > BUSY)
    }
}

/// What one thread has used and lost, in seconds since its beginning.
#[derive(Clone, Copy)]
struct Clock {
    processor: Option<f64>,
    /// Time in the queue of a core; not read for a single thread.
    queued: Option<f64>,
}

/// Runs `work`, which uses this number of threads: the caller alone, or the pool inside which this is called.
/// Each is pinned to a core of its own until the end.
pub(crate) fn on_own_cores<R>(threads: usize, work: impl FnOnce() -> R) -> (R, Load) {
    static CORES: OnceLock<Vec<usize>> = OnceLock::new();
    let cores = CORES.get_or_init(system::cores);
    let enough = threads <= cores.len();
    let before = on_each(threads, |thread| enough.then(|| system::pin(cores[thread])).flatten());
    let clocks = || on_each(threads, |_| system::clock(threads > 1));
    let (old, start) = (clocks(), Instant::now());
    let result = work();
    let (wall, new) = (start.elapsed().as_secs_f64(), clocks());
    on_each(threads, |thread| before[thread].as_ref().map(system::unpin));
    (result, load(wall, &old, &new, before.iter().all(Option::is_some)))
}

/// The load of a span of `wall` seconds, by the clocks of all threads at its ends.
fn load(wall: f64, old: &[Clock], new: &[Clock], pinned: bool) -> Load {
    let spans = |of: fn(&Clock) -> Option<f64>| -> Option<Vec<f64>> {
        old.iter().zip(new).map(|(old, new)| Some(of(new)? - of(old)?)).collect()
    };
    let processor = spans(|clock| clock.processor).map(|used| used.iter().sum());
    let lost = match old.len() {
        1 => processor.map(|used: f64| wall - used),
        _ => spans(|clock| clock.queued).map(|queued| queued.into_iter().fold(0.0, f64::max)),
    };
    Load { processor, taken: lost.map(|lost| (lost / wall).clamp(0.0, 1.0)), pinned }
}

/// Calls `run` on each thread, with its number.
fn on_each<T: Send>(threads: usize, run: impl Fn(usize) -> T + Sync) -> Vec<T> {
    if threads == 1 { vec![run(0)] } else { rayon::broadcast(|thread| run(thread.index())) }
}

/// One hardware thread of each core of the processor before the second of any: `numbers` in this order;
/// `core` names a hardware thread's core.
fn cores_first(numbers: impl Iterator<Item = usize>, core: impl Fn(usize) -> String) -> Vec<usize> {
    let mut seen = Vec::new();
    let rank = |number| {
        let core = core(number);
        let rank = seen.iter().filter(|other| **other == core).count();
        seen.push(core);
        (rank, number)
    };
    let mut ranked: Vec<_> = numbers.map(rank).collect();
    ranked.sort_by_key(|&(rank, _)| rank);
    ranked.into_iter().map(|(_, number)| number).collect()
}

#[cfg(target_os = "linux")]
mod system {
    use super::{Clock, cores_first};
    use rustix::thread::{CpuSet, sched_getaffinity, sched_getcpu, sched_setaffinity};
    use rustix::time::{ClockId, clock_gettime};
    use std::fs::read_to_string;

    /// The cores that this process may use. The first is the one on which the caller runs: the scheduler
    /// chose it, and other programs that measure have others.
    pub fn cores() -> Vec<usize> {
        let Ok(allowed) = sched_getaffinity(None) else { return Vec::new() };
        let here = sched_getcpu();
        let core = |number: usize| {
            let siblings = format!("/sys/devices/system/cpu/cpu{number}/topology/thread_siblings_list");
            read_to_string(siblings).unwrap_or_else(|_| number.to_string())
        };
        let numbers = (here..CpuSet::MAX_CPU).chain(0..here);
        cores_first(numbers.filter(|&number| allowed.is_set(number)), core)
    }
    /// Pins the calling thread; returns where it could run before, or `None` where it cannot be pinned.
    pub fn pin(core: usize) -> Option<CpuSet> {
        let (before, mut one) = (sched_getaffinity(None).ok()?, CpuSet::new());
        one.set(core);
        sched_setaffinity(None, &one).ok().map(|()| before)
    }
    pub fn unpin(before: &CpuSet) {
        // Where it fails, the thread stays where it is.
        let _ = sched_setaffinity(None, before);
    }
    /// The clock of the calling thread, and on request the time it stood in queues.
    pub fn clock(queued: bool) -> Clock {
        let used = clock_gettime(ClockId::ThreadCPUTime);
        let nanoseconds =
            || read_to_string("/proc/thread-self/schedstat").ok()?.split(' ').nth(1)?.parse().ok();
        let queued = if queued { nanoseconds().map(|queued: f64| queued * 1e-9) } else { None };
        Clock { processor: Some(used.tv_sec as f64 + used.tv_nsec as f64 * 1e-9), queued }
    }
}

/// Without pins and clocks.
#[cfg(not(target_os = "linux"))]
mod system {
    use super::Clock;

    pub fn cores() -> Vec<usize> {
        Vec::new()
    }
    pub fn pin(_: usize) -> Option<()> {
        None
    }
    pub fn unpin(_: &()) {}
    pub fn clock(_: bool) -> Clock {
        Clock { processor: None, queued: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::threads::Threads;
    use std::thread::available_parallelism;

    #[test]
    fn load_is_what_others_took_and_not_what_threads_wait_for_each_other() {
        let clock = |processor, queued| Clock { processor: Some(processor), queued };
        let one = load(2.0, &[clock(1.0, None)], &[clock(2.5, None)], true);
        assert_eq!((one.taken, one.processor), (Some(0.25), Some(1.5)));
        // The second thread waits for most of the time, and only once for its core.
        let (old, new) = ([(0.0, 5.0), (0.0, 7.0)], [(2.0, 5.0), (0.5, 7.1)]);
        let [old, new] = [old, new].map(|of| of.map(|(used, queued)| clock(used, Some(queued))));
        let two = load(2.0, &old, &new, false);
        assert!((two.taken.unwrap() - 0.05).abs() < 1e-9 && !two.pinned, "{two:?}");
        assert_eq!(load(2.0, &old, &[clock(2.0, None); 2], true).taken, None);
    }

    #[test]
    fn reliability_is_that_of_the_median_turn() {
        let of = |shares: &[f64], enough| {
            let load = |&taken: &f64| Load { processor: None, taken: Some(taken), pinned: true };
            Reliability::of(&shares.iter().map(load).collect::<Vec<_>>(), enough)
        };
        assert_eq!(
            of(&[0.0, 0.04, 1.0], true),
            Reliability { reliable: true, pinned: true, taken: Some(0.04) }
        );
        let [busy, few] = [of(&[0.0, 0.06, 0.06], true), of(&[0.0], false)];
        assert!(!busy.reliable && busy.is_busy() && !few.reliable && !few.is_busy());
        let both = of(&[0.01], true).and(busy);
        assert_eq!((both.reliable, both.taken), (false, Some(0.06)));
    }

    #[test]
    fn threads_have_a_core_each_while_they_measure_and_all_cores_afterwards() {
        let cores = || available_parallelism().map_or(1, usize::from);
        let all = cores();
        for threads in [1, all.min(2)] {
            let pool = Threads::new(threads, || ());
            let measured = || on_each(threads, |_| (cores(), system::cores().first().copied()));
            let (inside, load) = pool.run(|| on_own_cores(threads, measured));
            if load.pinned {
                assert!(inside.iter().all(|&(cores, _)| cores == 1));
                assert!(threads == 1 || inside[0] != inside[1], "{inside:?}");
            }
            assert_eq!(load.pinned, cfg!(target_os = "linux"));
            assert!(pool.run(|| on_each(threads, |_| cores())).iter().all(|&after| after == all));
        }
    }

    #[test]
    fn cores_come_before_second_threads_of_any() {
        assert_eq!(cores_first([3, 2, 0, 1].into_iter(), |number| (number / 2).to_string()), [3, 0, 2, 1]);
    }
}
