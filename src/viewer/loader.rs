//! Loads scenes and creates their renderers in a thread of its own, so that frames go on meanwhile.

use super::frame::Exchange;
use std::sync::Arc;
use std::sync::atomic::Ordering::Release;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

type Job<T> = Box<dyn FnOnce() -> T + Send>;

/// Runs one job at a time. Only the last one requested has a result: those before it are superseded.
pub struct Loader<T> {
    /// Where the running job's result arrives.
    running: Option<Receiver<T>>,
    /// Runs after it.
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
    /// Whether a result is pending.
    pub fn is_busy(&self) -> bool {
        self.running.is_some()
    }
    /// The result of the last request, once it is there. A job that panics has none.
    pub fn poll(&mut self) -> Option<T> {
        let result = match self.running.as_ref()?.try_recv() {
            Err(TryRecvError::Empty) => return None,
            result => result.ok(),
        };
        let is_last = self.next.is_none();
        self.start_next();
        result.filter(|_| is_last)
    }

    fn start_next(&mut self) {
        self.running = self.next.take().map(|job| {
            let (sender, result) = channel();
            let exchange = self.exchange.clone();
            thread::spawn(move || {
                // Fails only if the viewer has ended.
                let _ = sender.send(job());
                exchange.notified.store(true, Release);
            });
            result
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::Ordering::Acquire;

    #[test]
    fn only_the_last_request_has_a_result() {
        let exchange = Arc::new(Exchange::default());
        let mut loader = Loader::new(exchange.clone());
        (1..=3).for_each(|number| loader.request(move || number));
        let mut results = Vec::new();
        while loader.is_busy() {
            results.extend(loader.poll());
        }
        assert_eq!(results, [3]);
        loader.request(|| panic!("a job that panics"));
        while loader.is_busy() {
            results.extend(loader.poll());
        }
        assert_eq!(results, [3]);
        while !exchange.notified.load(Acquire) {
            thread::yield_now();
        }
    }
}
