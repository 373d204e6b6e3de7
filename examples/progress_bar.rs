//! Renders with a progress bar, and saves a file: `cargo run --release --example progress_bar -- PICTURE.png`

use octray_engine::render::{RenderObserver, Renderer, Settings};
use octray_engine::tone::Tone;
use octray_formats::output::save;
use octray_formats::scene::load;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Counts the samples of all threads.
struct Bar {
    done: AtomicUsize,
    all: usize,
}

impl RenderObserver for Bar {
    /// Rendering stops between two samples of some tiles where this is true.
    fn is_cancelled(&self) -> bool {
        false
    }
    fn sample_done(&self, pixels: usize, _rays: u64) {
        let before = self.done.fetch_add(pixels, Ordering::Relaxed);
        let tenth = |done| done * 10 / self.all;
        if tenth(before + pixels) > tenth(before) {
            eprint!("#");
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = load("builtin:spheres")?;
    let samples = 8;
    let settings = Settings { resolution: [240, 135], ..Settings::of(&scene) };
    let renderer = Renderer::new(&scene, settings);
    let mut film = renderer.film();
    let bar = Bar { done: AtomicUsize::new(0), all: 240 * 135 * samples as usize };
    renderer.add_samples_observed(&mut film, samples, &bar);
    eprintln!(" {} rays", film.rays());

    if let Some(path) = std::env::args_os().nth(1).map(PathBuf::from) {
        save(&path, &film.picture(), &Tone::default())?;
    }
    Ok(())
}
