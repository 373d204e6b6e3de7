//! From film to the pixels of a frame: reprojection, filters, tone mapping; or another view of the scene.
//!
//! For: [`Painter`]. May import: `display`, `views`, `map`, `figures`. Must never know: events, threads, windows.
//!
//! All memory is kept from frame to frame.

use super::controls::{Controls, Filter};
use super::figures;
use super::frame::Frame;
use super::map::{self, Map};
use super::rates::Rates;
use super::state::State;
use super::views::{self, Sources, View};
use crate::display::{Blur, Denoiser, Fxaa, History, Samples, rows, walking_speed};
use crate::film::{Film, Picture};
use crate::integrate::aovs::Aovs;
use crate::integrate::probe::PathShape;
use crate::render::Renderer;
use crate::render::aovs::{self, Cost};
use crate::scene::{Camera, Scene};
use crate::tone::Tone;
use glam::Vec3;
use std::time::{Duration, Instant};

/// How often figures change: people read them.
const FIGURES: Duration = Duration::from_millis(250);

/// What a frame is painted from.
pub struct Subject<'a> {
    pub renderer: &'a Renderer,
    pub scene: &'a Scene,
    pub camera: &'a Camera,
    pub film: &'a Film,
    pub controls: &'a Controls,
    /// Was a frame painted of this camera and film before?
    pub known: bool,
    /// Do the film's samples stay in it for the next frame?
    pub standing: bool,
    /// Is the scene the one that the playlist stands at?
    pub listed: bool,
}

#[derive(Default)]
pub struct Painter {
    mean: Picture,
    history: History,
    /// Did it show in the last frame?
    reprojected: bool,
    blur: Blur,
    fxaa: Fxaa,
    denoiser: Denoiser,
    guides: Aovs,
    /// Are they of the camera of now?
    guided: bool,
    costs: aovs::Map<Cost>,
    costed: bool,
    shapes: aovs::Map<PathShape>,
    counts: Vec<f32>,
    distances: Vec<f32>,
    /// Drawn when it is first wanted.
    map: Option<Map>,
    /// Of who walks here, once something was seen.
    speed: Option<f32>,
    figures: String,
    /// What they were written of, and when.
    written: Option<(Controls, Instant)>,
    message: String,
}

impl Painter {
    /// Another scene; or, with `again`, the same one as its files have it now: who walks there goes on at the same speed.
    pub fn meet_another_scene(&mut self, again: bool) {
        self.map = None;
        self.speed = self.speed.filter(|_| again);
        self.forget();
    }
    /// What was seen is no more.
    pub fn forget(&mut self) {
        self.history.reset();
    }
    /// How fast to walk through what was seen first of this scene, in scene units a second.
    pub fn speed(&self) -> Option<f32> {
        self.speed
    }
    pub fn message(&mut self, text: &str) {
        self.message.clear();
        self.message.push_str(text);
    }

    /// Fills the frame's pixels and its map.
    pub fn paint(&mut self, subject: &Subject, frame: &mut Frame) {
        let Subject { renderer, film, controls, .. } = *subject;
        // Reprojection that is switched on where the camera stands begins as for a new picture.
        let known = subject.known && (self.reprojected || !controls.reprojection);
        self.reprojected = controls.reprojection;
        if !known {
            (self.guided, self.costed) = (false, false);
        }
        frame.resize(film.resolution());
        film.picture_into(&mut self.mean);
        let first = controls.reprojection && !known;
        if first || controls.denoiser || controls.view != View::Picture || self.speed.is_none() {
            self.see(renderer);
        }
        let samples = film.samples().max(1);
        if first {
            // Samples that stay in the film are not history's as well.
            let own = if subject.standing { 0 } else { samples };
            self.history.reproject(&self.mean, own, &self.guides, renderer.camera());
        }
        if !controls.reprojection {
            // What it knows is of where the camera was when it was last asked.
            self.history.reset();
        } else if known || subject.standing {
            self.history.blend_static(&self.mean, samples);
        }
        match controls.view {
            View::Picture => self.paint_picture(subject, samples, &mut frame.pixels),
            view => self.paint_view(view, subject, samples, &mut frame.pixels),
        }
        self.speed.get_or_insert_with(|| walking_speed(&self.guides));
        frame.inset.clear();
        if controls.map {
            let aspect = f64::from(frame.width) / f64::from(frame.height);
            let map = self.map.get_or_insert_with(|| Map::new(subject.scene));
            map.draw_into(subject.camera, aspect, &mut frame.inset);
            frame.inset_side = map::SIDE;
        }
    }

    /// Finds out what pixels see, once for a camera.
    fn see(&mut self, renderer: &Renderer) {
        if !std::mem::replace(&mut self.guided, true) {
            renderer.aovs_into(&mut self.guides);
        }
    }

    fn paint_picture(&mut self, subject: &Subject, samples: u32, pixels: &mut [u32]) {
        let controls = subject.controls;
        let (mut shown, mut behind) = (&self.mean, Samples::Same(samples));
        if controls.reprojection {
            (shown, behind) = (self.history.shown(), Samples::Each(self.history.counts()));
        }
        if controls.denoiser {
            shown = self.denoiser.filter(shown, behind, &self.guides);
        }
        match controls.filter {
            Filter::None => {}
            Filter::Blur => shown = self.blur.filter(shown),
            Filter::Fxaa => shown = self.fxaa.filter(shown, &controls.tone),
        }
        write(&controls.tone, shown, pixels);
    }

    fn paint_view(&mut self, view: View, subject: &Subject, samples: u32, pixels: &mut [u32]) {
        let renderer = subject.renderer;
        match view {
            View::Cost if !std::mem::replace(&mut self.costed, true) => renderer.costs_into(&mut self.costs),
            View::Bounces | View::Lanes => {
                renderer.path_shapes_into(samples - 1, &mut self.shapes);
            }
            View::Samples => {
                self.counts.clear();
                match subject.controls.reprojection {
                    true => self.counts.extend_from_slice(self.history.counts()),
                    false => self.counts.resize(pixels.len(), samples as f32),
                }
            }
            _ => {}
        }
        let range = match view {
            View::Depth => views::range(&self.guides, &mut self.distances),
            _ => [0.0; 2],
        };
        let camera = subject.camera;
        let up = camera.up.normalize();
        let sight = (camera.look_at - camera.position).normalize();
        let sources = Sources {
            guides: &self.guides,
            shapes: &self.shapes,
            costs: &self.costs,
            samples: &self.counts,
            light: (up * 0.8 - sight * 0.5 - sight.cross(up).normalize_or(Vec3::ZERO) * 0.4).normalize(),
            range,
            max_bounces: renderer.settings().max_bounces,
            lanes: renderer.settings().lanes,
        };
        views::paint(view, &sources, pixels);
    }

    /// Writes what the frame says besides its pixels.
    pub fn write(&mut self, subject: &Subject, state: &State, rates: &Rates, busy: bool, frame: &mut Frame) {
        let now = Instant::now();
        let fresh = |&(controls, at): &(Controls, Instant)| controls == state.controls && now - at < FIGURES;
        if !self.written.as_ref().is_some_and(fresh) {
            self.written = Some((state.controls, now));
            self.figures.clear();
            // The help is long: figures make room for it.
            if state.controls.overlay && !state.controls.help {
                figures::write(&mut self.figures, subject, state, &rates.figures(), busy);
            }
        }
        frame.figures.clone_from(&self.figures);
        frame.message.clone_from(&self.message);
        if frame.title != subject.scene.name {
            frame.title.clone_from(&subject.scene.name);
        }
    }
}

/// Writes a picture as a screen shows it.
fn write(tone: &Tone, picture: &Picture, words: &mut [u32]) {
    let width = picture.width as usize;
    rows::each(words, width, |y, words| tone.words(&picture.pixels[y * width..][..width], words));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Settings;
    use crate::scene::load;

    /// A viewer without events: what a frame shows of a camera, after so many samples with a seed.
    struct Easel {
        scene: Scene,
        renderer: Renderer,
        film: Film,
        controls: Controls,
        painter: Painter,
    }

    impl Easel {
        fn new() -> Self {
            let scene = load("builtin:cornell-spheres").unwrap();
            let renderer = Renderer::new(&scene, Settings { resolution: [24, 16], ..Settings::of(&scene) });
            let controls = Controls::new(scene.max_bounces, 1, 8, Tone::default());
            Self { film: renderer.film(), renderer, scene, controls, painter: Painter::default() }
        }
        fn go(&mut self, field: f32, seed: u32) {
            self.scene.camera.vertical_fov = field;
            let Scene { camera, max_bounces, .. } = self.scene;
            self.renderer.set_view(&self.scene, &camera, [24, 16], max_bounces);
            self.renderer.set_seed(seed);
            self.film.clear();
        }
        /// Takes more samples and paints.
        fn paint(&mut self, samples: u32, known: bool, standing: bool) -> Vec<u32> {
            self.renderer.add_samples(&mut self.film, samples);
            let mut frame = Frame::default();
            let subject = Subject {
                renderer: &self.renderer,
                scene: &self.scene,
                camera: &self.scene.camera,
                film: &self.film,
                controls: &self.controls,
                known,
                standing,
                listed: true,
            };
            self.painter.paint(&subject, &mut frame);
            frame.pixels
        }
        /// What the film holds, without anything of the past.
        fn mean(&self) -> Vec<u32> {
            let mut words = vec![0; self.film.picture().pixels.len()];
            Tone::default().words(&self.film.picture().pixels, &mut words);
            words
        }
    }

    #[test]
    fn the_past_shows_while_the_camera_moves_and_is_gone_when_it_has_stood() {
        let mut easel = Easel::new();
        assert_eq!(easel.paint(4, false, true), easel.mean(), "nothing is past yet");
        assert_eq!(easel.painter.history.counts()[0], 4.0);
        assert_eq!(easel.paint(4, true, true), easel.mean(), "no sample counts twice");
        assert_eq!(easel.painter.history.counts()[0], 8.0);
        easel.go(38.5, 1);
        assert_ne!(easel.paint(1, false, false), easel.mean());
        assert!(easel.painter.history.counts().iter().any(|&count| count > 1.0));
        easel.go(38.5, 0);
        assert_ne!(easel.paint(1, true, true), easel.mean());
        assert_eq!(easel.paint(63, true, true), easel.mean());
    }

    #[test]
    fn views_and_the_denoiser_are_of_the_camera_of_now() {
        for (view, denoiser) in [(View::Normals, false), (View::Cost, false), (View::Picture, true)] {
            let [mut walked, mut fresh] = [(); 2].map(|()| Easel::new());
            for easel in [&mut walked, &mut fresh] {
                easel.controls.reprojection = false;
                (easel.controls.view, easel.controls.denoiser) = (view, denoiser);
            }
            let home = walked.paint(1, false, true);
            walked.go(20.0, 1);
            fresh.go(20.0, 1);
            let there = walked.paint(1, false, false);
            assert!(there != home && there == fresh.paint(1, false, false), "{view:?}");
        }
    }

    /// What history has blended is of more samples than the film: it is filtered as such.
    #[test]
    fn the_denoiser_is_told_of_the_samples_that_history_stands_for() {
        let mut easel = Easel::new();
        easel.controls.denoiser = true;
        easel.paint(64, false, true);
        easel.go(38.5, 1);
        let shown = easel.paint(1, false, false);
        let Painter { history, denoiser, guides, .. } = &mut easel.painter;
        let mut words = vec![0; shown.len()];
        let each = denoiser.filter(history.shown(), Samples::Each(history.counts()), guides);
        write(&Tone::default(), each, &mut words);
        assert!(shown == words);
        write(&Tone::default(), denoiser.filter(history.shown(), Samples::Same(1), guides), &mut words);
        assert!(shown != words, "it matters here");
    }

    #[test]
    fn nothing_is_remembered_of_places_passed_without_reprojection() {
        let mut easel = Easel::new();
        easel.paint(4, false, true);
        easel.controls.reprojection = false;
        easel.go(20.0, 1);
        assert_eq!(easel.paint(1, false, false), easel.mean());
        easel.go(20.0, 0);
        assert_eq!(easel.paint(2, true, true), easel.mean());
        easel.controls.reprojection = true;
        assert_eq!(easel.paint(1, true, true), easel.mean(), "no ghost of where it was switched off");
        assert_eq!(easel.paint(1, true, true), easel.mean());
        easel.go(20.5, 2);
        assert_ne!(easel.paint(1, false, false), easel.mean(), "from here on it remembers again");
    }
}
