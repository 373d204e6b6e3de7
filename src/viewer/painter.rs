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
use crate::display::{Blur, Denoiser, Fxaa, History, Samples, walking_speed};
use crate::film::{Film, Picture};
use crate::integrate::guides::Guides;
use crate::integrate::queue::PathShape;
use crate::output::Tone;
use crate::render::Renderer;
use crate::render::survey::{self, Cost};
use crate::scene::{Camera, Scene};
use glam::Vec3;
use rayon::prelude::*;
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
    /// Is the scene the one that the playlist stands at?
    pub listed: bool,
}

#[derive(Default)]
pub struct Painter {
    mean: Picture,
    history: History,
    blur: Blur,
    fxaa: Fxaa,
    denoiser: Denoiser,
    guides: Guides,
    /// Are they of the camera of now?
    guided: bool,
    costs: survey::Map<Cost>,
    costed: bool,
    shapes: survey::Map<PathShape>,
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
    /// Another scene.
    pub fn meet_another_scene(&mut self) {
        (self.map, self.speed) = (None, None);
        self.forget();
    }
    /// What was seen is no more.
    pub fn forget(&mut self) {
        self.history.forget();
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
        let Subject { renderer, film, controls, known, .. } = *subject;
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
        if controls.reprojection {
            match known {
                true => self.history.still(&self.mean, samples),
                false => self.history.advance(&self.mean, samples, &self.guides, renderer.camera()),
            };
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
            renderer.guides_into(&mut self.guides);
        }
    }

    fn paint_picture(&mut self, subject: &Subject, samples: u32, pixels: &mut [u32]) {
        let Subject { renderer, controls, .. } = *subject;
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
        write(&controls.tone, shown, pixels, renderer.settings().threads > 1);
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
            if state.controls.overlay {
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

/// Writes a picture as a screen shows it, on all threads of the pool that it is called in, if `together`.
fn write(tone: &Tone, picture: &Picture, words: &mut [u32], together: bool) {
    /// Pixels that are worth another thread.
    const PART: usize = 4096;
    match together {
        true => {
            let parts = words.par_chunks_mut(PART).zip(picture.pixels.par_chunks(PART));
            parts.for_each(|(words, pixels)| tone.words(pixels, words));
        }
        false => tone.words(&picture.pixels, words),
    }
}
