//! Worker threads, each with working memory of its own.
//!
//! For: [`Threads`]. May import: `rayon`. Must never know: what the work is.

use std::sync::{Arc, Mutex, MutexGuard};

/// So many threads, and as many working memories.
pub struct Threads<W> {
    /// None for one thread: then the caller's own does the work.
    pool: Handle,
    /// The locks are never contended: a thread takes its own.
    memories: Vec<Mutex<W>>,
}

impl<W: Send> Threads<W> {
    /// # Panics
    /// If there are to be none, or the system refuses them.
    pub fn new(count: usize, memory: impl Fn() -> W) -> Self {
        assert!(count >= 1, "no threads");
        let pool = (count > 1).then(|| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
            Arc::new(pool.expect("the system gives threads"))
        });
        Self { pool: Handle(pool), memories: (0..count).map(|_| Mutex::new(memory())).collect() }
    }
    pub fn count(&self) -> usize {
        self.memories.len()
    }
    /// Is the caller's own thread the only one? Then parallel iterators would wake threads that are not of these.
    pub fn alone(&self) -> bool {
        self.pool.0.is_none()
    }
    /// Runs something on these threads, where parallel iterators spread over all of them. Called around many others, it saves waking
    /// them for each.
    pub fn run<R: Send>(&self, run: impl FnOnce() -> R + Send) -> R {
        self.pool.run(run)
    }
    /// What runs work on these threads and does not borrow them.
    pub fn handle(&self) -> Handle {
        self.pool.clone()
    }
    /// All working memories, one after the other. Not while threads work.
    ///
    /// # Panics
    /// If work panicked with one before.
    pub fn each(&self, mut run: impl FnMut(&mut W)) {
        let memories = self.memories.iter();
        memories
            .for_each(|memory| run(&mut memory.lock().expect("no thread panicked with its working memory")));
    }
    /// The working memory of the thread that asks, which is one of these: the caller, where it is alone, else one inside [`Threads::run`].
    ///
    /// # Panics
    /// If work panicked with it before.
    pub fn own(&self) -> MutexGuard<'_, W> {
        // Alone, the caller may be a thread of another pool, with a number there.
        let thread = if self.alone() { 0 } else { rayon::current_thread_index().unwrap_or(0) };
        self.memories[thread].lock().expect("no thread panicked with its working memory")
    }
}

/// Threads to run on; see [`Threads::handle`].
#[derive(Clone)]
pub struct Handle(Option<Arc<rayon::ThreadPool>>);

impl Handle {
    /// As [`Threads::run`].
    pub fn run<R: Send>(&self, run: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            Some(pool) => pool.install(run),
            None => run(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    #[test]
    fn every_thread_has_its_own_memory_and_all_of_the_work_is_done() {
        for count in [1, 2, 3] {
            let threads = Threads::new(count, || 0);
            assert_eq!((threads.count(), threads.alone()), (count, count == 1));
            threads.run(|| {
                if threads.alone() {
                    (0..100).for_each(|_| *threads.own() += 1);
                } else {
                    (0..100).into_par_iter().for_each(|_| *threads.own() += 1);
                }
            });
            let done: Vec<i32> = threads.memories.iter().map(|memory| *memory.lock().unwrap()).collect();
            assert_eq!((done.len(), done.iter().sum::<i32>()), (count, 100));
        }
    }

    #[test]
    fn the_only_thread_works_in_pools_of_others_too() {
        let (outer, inner) = (Threads::new(3, || ()), Threads::new(1, || 0));
        let numbers: Vec<Option<usize>> = outer.run(|| {
            let ask = |_| {
                inner.run(|| {
                    *inner.own() += 1;
                    rayon::current_thread_index()
                })
            };
            (0..64).into_par_iter().map(ask).collect()
        });
        assert!(numbers.iter().all(Option::is_some), "they are threads of the outer pool");
        assert_eq!(*inner.own(), 64);
    }
}
