//! Loads scenes and creates their renderers in a thread of its own, while frames go on.

use super::frame::Exchange;
use std::sync::Arc;
use std::sync::atomic::Ordering::Release;
use std::thread::{self, JoinHandle};

type Job<T> = Box<dyn FnOnce() -> T + Send>;

/// A runner of one job at a time. Only the last requested job has a result; it supersedes earlier ones.
pub struct Loader<T> {
    running: Option<JoinHandle<T>>,
    /// The job that runs after it.
    next: Option<Job<T>>,
    /// Notified after each job.
    exchange: Arc<Exchange>,
}

impl<T: Send + 'static> Loader<T> {
    pub fn new(exchange: Arc<Exchange>) -> Self {
        Self { running: None, next: None, exchange }
    }
    pub fn request(&mut self, job: impl FnOnce() -> T + Send + 'static) {
        self.next = Some(Box::new(job));
        if self.running.is_none() {
            self.start_next();
        }
    }
    /// Tests whether a result is pending.
    pub fn is_busy(&self) -> bool {
        self.running.is_some()
    }
    /// Returns the result of the last request once it has arrived. A job that panics has none.
    pub fn poll(&mut self) -> Option<T> {
        let finished = self.running.take_if(|job| job.is_finished())?;
        let is_last = self.next.is_none();
        self.start_next();
        finished.join().ok().filter(|_| is_last)
    }

    fn start_next(&mut self) {
        self.running = self.next.take().map(|job| {
            let exchange = self.exchange.clone();
            thread::spawn(move || {
                let result = job();
                exchange.notified.store(true, Release);
                result
            })
        });
    }
}
