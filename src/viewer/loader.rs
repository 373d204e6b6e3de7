//! Loads scenes and creates their renderers in a thread of its own, so that frames go on meanwhile.
//!
//! For: [`Loader`].

use octray_engine::render::{Renderer, Settings};
use octray_formats::scene::{self, Loaded, SceneError};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

/// Where a scene comes from.
#[derive(Clone)]
pub enum SceneSource {
    /// Load it: a name as on the command line.
    Name(String),
    /// Already loaded; only the renderer is new.
    Loaded(Arc<Loaded>),
}

type ChooseSettings = Box<dyn FnOnce(&Loaded) -> Result<Settings, String> + Send>;

/// A scene to prepare.
pub struct LoadRequest {
    pub source: SceneSource,
    /// Chooses the settings for the scene; the error says why it cannot be rendered.
    pub settings: ChooseSettings,
    /// Whether it is the scene that is shown, possibly changed.
    pub reload: bool,
}

/// A scene with its renderer.
pub struct PreparedScene {
    pub scene: Arc<Loaded>,
    pub renderer: Renderer,
    pub reload: bool,
}

/// The loader thread, and the queues to and from it.
pub struct Loader {
    requests: Sender<LoadRequest>,
    results: Receiver<Result<PreparedScene, SceneError>>,
    /// Requests without a result.
    pending: usize,
}

impl Loader {
    /// `notify` is called after each result.
    pub fn start(notify: impl Fn() + Send + 'static) -> Self {
        let (requests, incoming) = channel::<LoadRequest>();
        let (outgoing, results) = channel();
        thread::spawn(move || {
            for request in incoming {
                if outgoing.send(prepare(request)).is_err() {
                    break;
                }
                notify();
            }
        });
        Self { requests, results, pending: 0 }
    }
    pub fn request(&mut self, request: LoadRequest) {
        if self.requests.send(request).is_ok() {
            self.pending += 1;
        }
    }
    /// Whether a request is pending.
    pub fn busy(&self) -> bool {
        self.pending > 0
    }
    /// The result of the last request, if it is there. Results of superseded requests are dropped.
    pub fn poll(&mut self) -> Option<Result<PreparedScene, SceneError>> {
        loop {
            match self.results.try_recv() {
                Ok(result) => {
                    self.pending -= 1;
                    if self.pending == 0 {
                        return Some(result);
                    }
                }
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => {
                    self.pending = 0;
                    return None;
                }
            }
        }
    }
}

fn prepare(request: LoadRequest) -> Result<PreparedScene, SceneError> {
    let scene = match request.source {
        SceneSource::Name(name) => Arc::new(scene::load_with_view(&name)?),
        SceneSource::Loaded(scene) => scene,
    };
    let settings = (request.settings)(&scene).map_err(|why| SceneError::of_use(why, &scene))?;
    Ok(PreparedScene { renderer: Renderer::new(&scene, settings), scene, reload: request.reload })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    fn wait(loader: &mut Loader) -> Result<PreparedScene, SceneError> {
        let start = Instant::now();
        loop {
            if let Some(result) = loader.poll() {
                return result;
            }
            assert!(start.elapsed() < Duration::from_secs(60), "no result");
            thread::sleep(Duration::from_millis(1));
        }
    }
    fn request_for(name: &str) -> LoadRequest {
        let settings = Box::new(|scene: &Loaded| Ok(Settings::of(scene)));
        LoadRequest { source: SceneSource::Name(name.into()), settings, reload: false }
    }

    #[test]
    fn only_the_last_request_has_a_result() {
        let mut loader = Loader::start(|| {});
        assert!(!loader.busy());
        for name in ["builtin:three", "builtin:no", "builtin:thesis"] {
            loader.request(request_for(name));
        }
        assert!(loader.busy());
        assert_eq!(wait(&mut loader).ok().unwrap().scene.name, "builtin:thesis");
        assert!(!loader.busy() && loader.poll().is_none());
        loader.request(request_for("builtin:no"));
        assert!(wait(&mut loader).err().unwrap().to_string().contains("builtin:no"));
    }
}
