//! Pools of threads, and long work in parts, between which Python handles signals.

use octray_rays::Tracer;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ops::Range;
use std::process;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The time that a part of a long call takes, and after which Ctrl-C ends the call.
pub const PART: Duration = Duration::from_millis(50);

/// Pools by process and number of threads.
type Pools = Vec<((u32, usize), &'static ThreadPool)>;

/// Returns a pool of so many threads. It lives as long as the process; a fork has none of its threads, so it
/// gets a pool of its own. `_py` keeps the lock from being held while another thread forks.
pub fn pool(_py: Python, threads: usize) -> &'static ThreadPool {
    static POOLS: Mutex<Pools> = Mutex::new(Vec::new());
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let key = (process::id(), threads);
    if let Some((_, pool)) = pools.iter().find(|(other, _)| *other == key) {
        return pool;
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("the system gives threads");
    let pool: &'static ThreadPool = Box::leak(Box::new(pool));
    pools.push((key, pool));
    pool
}

/// Calls `run` for parts of `0..count`, without the GIL.
pub fn in_parts(
    py: Python,
    (count, threads): (usize, usize),
    mut run: impl FnMut(Range<usize>) -> PyResult<()> + Send,
) -> PyResult<()> {
    // Rays may be slow: the first part is short.
    let (mut start, mut length) = (0, Tracer::BATCH / 256 * threads);
    while start < count {
        let (end, begun) = (count.min(start + length), Instant::now());
        py.detach(|| run(start..end))?;
        py.check_signals()?;
        // Parts become shorter where rays are slow, and are multiples of a batch where they are fast.
        let factor = PART.as_secs_f64() / begun.elapsed().as_secs_f64().max(1e-9);
        length = ((length as f64 * factor.min(4.0)) as usize).max(threads);
        let batches = Tracer::BATCH * threads;
        // More than a batch on one thread would only be copied once more.
        length = if threads == 1 { length.min(batches) } else { length };
        length -= if length > batches { length % batches } else { 0 };
        start = end;
    }
    Ok(())
}
