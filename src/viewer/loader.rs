//! Scenes are read and made ready in a thread of their own, so that the picture never stands still for them.
//!
//! For: [`Loader`]. May import: `scene`, `render`. Must never know: the state machine, windows.

use crate::render::{Renderer, Settings};
use crate::scene::{self, Loaded, SceneError};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;
use std::time::SystemTime;

/// Where a scene comes from.
#[derive(Clone)]
pub enum Source {
    /// Read it: the name as the command line takes it.
    Name(String),
    /// It is here already, and to be made ready in another way.
    Here(Arc<Loaded>),
}

type Choice = Box<dyn FnOnce(&Loaded) -> Result<Settings, String> + Send>;

/// A scene to be made ready.
pub struct Order {
    pub source: Source,
    /// Given the scene, how it is rendered, or why it cannot be.
    pub settings: Choice,
    /// Is it the scene that is shown already, changed perhaps?
    pub again: bool,
}

/// A scene made ready.
pub struct Ready {
    pub scene: Arc<Loaded>,
    pub renderer: Renderer,
    pub again: bool,
    /// When its files had not been read yet; none if they were not read at all.
    pub read: Option<SystemTime>,
}

/// The thread, and the way there and back.
pub struct Loader {
    orders: Sender<Order>,
    answers: Receiver<Result<Ready, SceneError>>,
    /// Orders without an answer.
    waiting: usize,
}

impl Loader {
    /// `tell` is called when something has become ready.
    pub fn start(tell: impl Fn() + Send + 'static) -> Self {
        let (orders, incoming) = channel::<Order>();
        let (outgoing, answers) = channel();
        thread::spawn(move || {
            for order in incoming {
                if outgoing.send(prepare(order)).is_err() {
                    break;
                }
                tell();
            }
        });
        Self { orders, answers, waiting: 0 }
    }
    pub fn order(&mut self, order: Order) {
        if self.orders.send(order).is_ok() {
            self.waiting += 1;
        }
    }
    /// Is something under way?
    pub fn busy(&self) -> bool {
        self.waiting > 0
    }
    /// What has become ready, or why it has not; what later orders have overtaken is left out.
    pub fn take(&mut self) -> Option<Result<Ready, SceneError>> {
        loop {
            match self.answers.try_recv() {
                Ok(answer) => {
                    self.waiting -= 1;
                    if self.waiting == 0 {
                        return Some(answer);
                    }
                }
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => {
                    self.waiting = 0;
                    return None;
                }
            }
        }
    }
}

fn prepare(order: Order) -> Result<Ready, SceneError> {
    let start = SystemTime::now();
    let (scene, read) = match order.source {
        Source::Name(name) => (Arc::new(scene::load_with_view(&name)?), Some(start)),
        Source::Here(scene) => (scene, None),
    };
    let settings = (order.settings)(&scene).map_err(|why| SceneError::of_use(why, &scene))?;
    Ok(Ready { renderer: Renderer::new(&scene, settings), scene, again: order.again, read })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    fn wait(loader: &mut Loader) -> Result<Ready, SceneError> {
        let start = Instant::now();
        loop {
            if let Some(answer) = loader.take() {
                return answer;
            }
            assert!(start.elapsed() < Duration::from_secs(60), "no answer");
            thread::sleep(Duration::from_millis(1));
        }
    }
    fn order(name: &str) -> Order {
        let settings = Box::new(|scene: &Loaded| Ok(Settings::of(scene)));
        Order { source: Source::Name(name.into()), settings, again: false }
    }

    #[test]
    fn only_the_last_order_is_answered() {
        let mut loader = Loader::start(|| {});
        assert!(!loader.busy());
        for name in ["builtin:three", "builtin:no", "builtin:thesis"] {
            loader.order(order(name));
        }
        assert!(loader.busy());
        assert_eq!(wait(&mut loader).ok().unwrap().scene.name, "builtin:thesis");
        assert!(!loader.busy() && loader.take().is_none());
        loader.order(order("builtin:no"));
        assert!(wait(&mut loader).err().unwrap().to_string().contains("builtin:no"));
    }
}
