//! A pool of worker threads with thread-local memory.

use std::sync::{Arc, Mutex, MutexGuard};

/// A pool of threads, with one working memory for each.
pub struct Threads<W> {
    /// The pool; for a single thread it is empty, and the caller's thread does the work.
    pool: Handle,
    /// The working memories. Their locks are never contended: each thread has its own.
    memories: Vec<Mutex<W>>,
}

impl<W: Send> Threads<W> {
    /// # Panics
    /// If `count` is 0, or the system cannot start the threads.
    pub fn new(count: usize, memory: impl Fn() -> W) -> Self {
        assert!(count >= 1, "no threads");
        let pool = (count > 1).then(|| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
            Arc::new(pool.expect("the system gives threads"))
        });
        Self { pool: Handle(pool), memories: (0..count).map(|_| Mutex::new(memory())).collect() }
    }
    /// Returns the number of worker threads.
    pub fn count(&self) -> usize {
        self.memories.len()
    }
    /// Tests whether the caller's thread is the only one: parallel iterators would start rayon's global pool.
    pub fn is_single(&self) -> bool {
        self.pool.0.is_none()
    }
    /// Calls `run` on these threads, where parallel iterators use all of them. One call around many others
    /// saves waking the threads for each.
    pub fn run<R: Send>(&self, run: impl FnOnce() -> R + Send) -> R {
        self.pool.run(run)
    }
    /// Returns a handle that runs work on these threads without borrowing the memories.
    pub fn handle(&self) -> Handle {
        self.pool.clone()
    }
    /// Calls `run` with each working memory in turn. Must not be called while threads work.
    ///
    /// # Panics
    /// If work panicked while it held one.
    pub fn for_each_memory(&self, mut run: impl FnMut(&mut W)) {
        let memories = self.memories.iter();
        memories
            .for_each(|memory| run(&mut memory.lock().expect("no thread panicked with its working memory")));
    }
    /// Returns the working memory of the current thread, which must be one of these: any caller if there is a
    /// single thread, else one inside [`Threads::run`].
    ///
    /// # Panics
    /// If work panicked while it held the memory.
    pub fn local(&self) -> MutexGuard<'_, W> {
        // If there is a single thread, its caller may belong to another pool and have an index there.
        let thread = if self.is_single() { 0 } else { rayon::current_thread_index().unwrap_or(0) };
        self.memories[thread].lock().expect("no thread panicked with its working memory")
    }
}

/// A handle to a pool; see [`Threads::handle`].
#[derive(Clone)]
pub struct Handle(Option<Arc<rayon::ThreadPool>>);

impl Handle {
    /// Calls `run` like [`Threads::run`].
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
            assert_eq!((threads.count(), threads.is_single()), (count, count == 1));
            threads.run(|| {
                if threads.is_single() {
                    (0..100).for_each(|_| *threads.local() += 1);
                } else {
                    (0..100).into_par_iter().for_each(|_| *threads.local() += 1);
                }
            });
            let done: Vec<i32> = threads.memories.iter().map(|memory| *memory.lock().unwrap()).collect();
            assert_eq!((done.len(), done.iter().sum::<i32>()), (count, 100));
        }
    }

    #[test]
    fn single_thread_works_inside_other_pools() {
        let (outer, inner) = (Threads::new(3, || ()), Threads::new(1, || 0));
        let numbers: Vec<Option<usize>> = outer.run(|| {
            let work = |_| {
                inner.run(|| {
                    *inner.local() += 1;
                    rayon::current_thread_index()
                })
            };
            (0..64).into_par_iter().map(work).collect()
        });
        assert!(numbers.iter().all(Option::is_some), "they are threads of the outer pool");
        assert_eq!(*inner.local(), 64);
    }
}
