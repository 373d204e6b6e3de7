//! Pins measuring threads to cores of their own, and finds what other programs took of their time.
//!
//! A scheduler may leave two threads of a pool on one core for tens of milliseconds while another is idle.
//!
//! The time that other programs took is not guessed from slow frames. A single thread never waits: others
//! took its wall time less its processor time. Threads of a pool wait for each other at the end of each
//! frame: others took the time in which such a thread could run but was in the queue of its core.

use super::quantiles::Quantiles;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::OnceLock;
use std::time::Instant;

/// Others took too much where they took more than this share of the time.
const BUSY: f64 = 0.05;

/// How far a figure can be relied on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Reliability {
    /// Whether neither a busy machine nor too few samples make the figure unreliable.
    pub reliable: bool,
    /// Whether each measuring thread was pinned to a core of its own: not where there are more threads than
    /// cores, and on Linux alone.
    pub pinned: bool,
    /// The share of the time that other programs took, in the median turn; null where the system does not
    /// report it.
    pub taken: Option<f64>,
}

impl Reliability {
    /// Computes the reliability of a span of `wall` seconds; `used` and `queued` are each thread's seconds on
    /// a core and in its queue.
    fn of_span(wall: f64, used: &[Option<f64>], queued: &[Option<f64>], pinned: bool) -> Self {
        let lost = match used {
            [used] => used.map(|used| wall - used),
            _ => queued.iter().try_fold(0.0, |most: f64, queued| Some(most.max((*queued)?))),
        };
        Self { reliable: true, pinned, taken: lost.map(|lost| (lost / wall).clamp(0.0, 1.0)) }
    }
    /// Combines two turns or figures: others took as much as of the one that lost more.
    pub fn worse(&self, other: &Self) -> Self {
        let taken = [self.taken, other.taken].into_iter().flatten().reduce(f64::max);
        Self { reliable: self.reliable && other.reliable, pinned: self.pinned && other.pinned, taken }
    }
    /// Computes the reliability of a figure from its turns, and from whether it has `enough` samples.
    pub fn of(turns: &[Self], enough: bool) -> Self {
        let taken: Option<Vec<f64>> = turns.iter().map(|turn| turn.taken).collect();
        let taken = taken.filter(|taken| !taken.is_empty()).map(|taken| Quantiles::of(taken).median());
        let judged = Self { reliable: enough, pinned: turns.iter().all(|turn| turn.pinned), taken };
        Self { reliable: enough && !judged.is_busy(), ..judged }
    }
    /// Tests whether others took so much that the figure is wrong.
    pub fn is_busy(&self) -> bool {
        self.taken.is_some_and(|taken| taken > BUSY)
    }
}

/// Runs `work`, which uses this number of threads: the caller alone, or the pool inside which this is called.
/// Each is pinned to a core of its own until the end. Returns the result, its seconds, and their reliability.
pub(crate) fn on_own_cores<R>(threads: usize, work: impl FnOnce() -> R) -> (R, f64, Reliability) {
    static CORES: OnceLock<Vec<usize>> = OnceLock::new();
    let cores = CORES.get_or_init(system::cores);
    let core = |thread: usize| cores.get(thread).filter(|_| threads <= cores.len());
    let before = on_each(threads, |thread| core(thread).and_then(|&core| system::pin(core)));
    let clocks = || on_each(threads, |_| [system::processor_time(), system::queue_time()]);
    let (old, start) = (clocks(), Instant::now());
    let result = work();
    let (wall, new) = (start.elapsed().as_secs_f64(), clocks());
    on_each(threads, |thread| before[thread].as_ref().map(system::unpin));
    let span = |which: usize| -> Vec<Option<f64>> {
        old.iter().zip(&new).map(|(old, new)| Some(new[which]? - old[which]?)).collect()
    };
    let is_pinned = before.iter().all(Option::is_some);
    (result, wall, Reliability::of_span(wall, &span(0), &span(1), is_pinned))
}

/// Calls `run` on each thread, with its number.
fn on_each<T: Send>(threads: usize, run: impl Fn(usize) -> T + Sync) -> Vec<T> {
    if threads == 1 { vec![run(0)] } else { rayon::broadcast(|thread| run(thread.index())) }
}

/// Returns the hardware threads, one of each core before the second of any; `core` names the core of one.
fn cores_first(numbers: impl Iterator<Item = usize>, core: impl Fn(usize) -> String) -> Vec<usize> {
    let (mut seen, mut ranks) = (BTreeMap::new(), BTreeMap::<usize, Vec<usize>>::new());
    for number in numbers {
        let rank: &mut usize = seen.entry(core(number)).or_default();
        ranks.entry(*rank).or_default().push(number);
        *rank += 1;
    }
    ranks.into_values().flatten().collect()
}

#[cfg(target_os = "linux")]
mod system {
    use rustix::thread::{CpuSet, sched_getaffinity, sched_getcpu, sched_setaffinity};
    use rustix::time::{ClockId, clock_gettime};
    use std::fs::read_to_string;

    /// Returns the cores that this process may use. The first is the one on which the caller runs: the
    /// scheduler chose it, and other programs that measure have others.
    pub fn cores() -> Vec<usize> {
        let Ok(allowed) = sched_getaffinity(None) else { return Vec::new() };
        let numbers = (sched_getcpu()..CpuSet::MAX_CPU).chain(0..sched_getcpu());
        super::cores_first(numbers.filter(|&number| allowed.is_set(number)), |number| {
            let siblings = format!("/sys/devices/system/cpu/cpu{number}/topology/thread_siblings_list");
            read_to_string(siblings).unwrap_or_else(|_| number.to_string())
        })
    }
    /// Pins the calling thread; returns where it could run before, or `None` where it cannot be pinned.
    pub fn pin(core: usize) -> Option<CpuSet> {
        let (before, mut one) = (sched_getaffinity(None).ok()?, CpuSet::new());
        one.set(core);
        sched_setaffinity(None, &one).ok().map(|()| before)
    }
    /// Undoes [`pin`]; where that fails, the thread stays where it is.
    pub fn unpin(before: &CpuSet) {
        let _ = sched_setaffinity(None, before);
    }
    /// Returns the seconds that the calling thread has used.
    pub fn processor_time() -> Option<f64> {
        let used = clock_gettime(ClockId::ThreadCPUTime);
        Some(used.tv_sec as f64 + used.tv_nsec as f64 * 1e-9)
    }
    /// Returns the seconds that the calling thread could run but was in the queue of a core.
    pub fn queue_time() -> Option<f64> {
        let times = read_to_string("/proc/thread-self/schedstat").ok()?;
        times.split(' ').nth(1)?.parse().ok().map(|queued: f64| queued * 1e-9)
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    pub fn cores() -> Vec<usize> {
        Vec::new()
    }
    pub fn pin(_: usize) -> Option<()> {
        None
    }
    pub fn unpin(_: &()) {}
    pub fn processor_time() -> Option<f64> {
        None
    }
    pub use processor_time as queue_time;
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread::available_parallelism;

    #[test]
    fn others_took_what_is_missing_of_one_thread_and_what_threads_of_a_pool_stood_in_queues() {
        let taken = |used: &[_], queued: &[_]| Reliability::of_span(2.0, used, queued, true).taken;
        assert_eq!(taken(&[Some(1.5)], &[Some(0.0)]), Some(0.25));
        assert_eq!(taken(&[Some(2.0), Some(0.5)], &[Some(0.0), Some(0.25)]), Some(0.125), "one waits");
        assert_eq!(taken(&[Some(2.0); 2], &[Some(0.0), None]), None);
        assert_eq!(cores_first([3, 2, 0, 1].into_iter(), |number| (number / 2).to_string()), [3, 0, 2, 1]);
        // A figure has the reliability of its median turn.
        let turn = |&taken: &f64| Reliability { reliable: true, pinned: true, taken: Some(taken) };
        let of = |turns: &[f64], enough| Reliability::of(&turns.iter().map(turn).collect::<Vec<_>>(), enough);
        assert_eq!(of(&[0.0, 0.04, 1.0], true), turn(&0.04));
        let [busy, few] = [of(&[0.0, 0.06, 0.06], true), of(&[0.0], false)];
        assert!(!busy.reliable && busy.is_busy() && !few.reliable && !few.is_busy());
    }

    #[test]
    fn threads_have_a_core_each_while_they_measure_and_all_cores_afterwards() {
        let cores = || available_parallelism().map_or(1, usize::from);
        let all = cores();
        for threads in [1, all.min(2)] {
            let pool = crate::threads::Threads::new(threads, || ());
            let measured = || on_each(threads, |_| (cores(), system::cores()));
            let (inside, _, reliability) = pool.run(|| on_own_cores(threads, measured));
            assert_eq!(reliability.pinned, cfg!(target_os = "linux"));
            if reliability.pinned {
                assert!(inside.iter().all(|(cores, _)| *cores == 1));
                assert!(threads == 1 || inside[0] != inside[1], "{inside:?}");
            }
            assert!(pool.run(|| on_each(threads, |_| cores())).iter().all(|&after| after == all));
        }
    }
}
