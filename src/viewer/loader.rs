//! Loads scenes and creates their renderers in a thread of its own, so that frames go on meanwhile.
//!
//! For: [`Loader`].

use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;

type Job<T> = Box<dyn FnOnce() -> T + Send>;

/// Runs one job at a time. Only the last one requested has a result: those before it are superseded.
pub struct Loader<T> {
    /// Where the running job's result arrives.
    running: Option<Receiver<T>>,
    /// Runs after it.
    next: Option<Job<T>>,
    /// Called after each job.
    notify: Arc<dyn Fn() + Send + Sync>,
}

impl<T: Send + 'static> Loader<T> {
    pub fn new(notify: impl Fn() + Send + Sync + 'static) -> Self {
        Self { running: None, next: None, notify: Arc::new(notify) }
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
            let notify = self.notify.clone();
            thread::spawn(move || {
                // Fails only if the viewer has ended.
                let _ = sender.send(job());
                notify();
            });
            result
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_request_has_a_result() {
        let (sender, notified) = channel();
        let mut loader = Loader::new(move || sender.send(()).unwrap());
        for number in 1..=3 {
            loader.request(move || number);
        }
        let mut results = Vec::new();
        while loader.is_busy() {
            notified.recv().unwrap();
            results.extend(loader.poll());
        }
        assert_eq!(results, [3]);
        loader.request(|| panic!("a job that panics"));
        while loader.is_busy() {
            results.extend(loader.poll());
        }
        assert_eq!(results, [3]);
    }
}
