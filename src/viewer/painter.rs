//! Paints the pixels of a frame from the film: reprojection, filters, tone mapping, or a false-colour display
//! mode.
//!
//! Buffers are reused from frame to frame, so that a frame allocates nothing.

use super::accumulation::Accumulation;
use super::controls::{Controls, Filter};
use super::display_mode::{self, DisplayMode};
use super::frame::Frame;
use super::minimap::Minimap;
use octray_display::{Blur, Denoiser, Fxaa, History, Samples, rows, walking_speed};
use octray_engine::film::Picture;
use octray_engine::integrate::aovs::{AovSample, Aovs};
use octray_engine::integrate::edge_aovs::DenoiserAovs;
use octray_engine::integrate::meter::PathShape;
use octray_engine::render::aovs::{self, Cost};
use octray_engine::render::{Renderer, Settings};
use octray_engine::tone::Tone;
use octray_formats::scene::Loaded;

/// The sources of a frame or a screenshot.
#[derive(Clone, Copy)]
pub struct FrameInput<'a> {
    pub renderer: &'a Renderer,
    pub scene: &'a Loaded,
    pub accumulation: &'a Accumulation,
    pub controls: &'a Controls,
}

/// The buffers of painting, and the history of earlier frames.
#[derive(Default)]
pub struct Painter {
    mean: Picture,
    pub history: History,
    /// Whether the last frame was reprojected.
    reprojected: bool,
    blur: Blur,
    fxaa: Fxaa,
    denoiser: Denoiser,
    aovs: PerCamera<Aovs>,
    denoiser_aovs: PerCamera<DenoiserAovs>,
    costs: PerCamera<aovs::Map<Cost>>,
    shapes: aovs::Map<PathShape>,
    distances: Vec<f32>,
    /// Largest number of tests of a pixel in the last frame that showed the cost.
    pub most_tests: u32,
    /// The map of the present scene, drawn on first use.
    pub minimap: Option<Minimap>,
}

/// A buffer that is rendered on demand, once per camera.
#[derive(Default)]
struct PerCamera<T> {
    value: T,
    valid: bool,
}

impl<T> PerCamera<T> {
    fn get(&mut self, render_into: impl FnOnce(&mut T)) -> &T {
        if !std::mem::replace(&mut self.valid, true) {
            render_into(&mut self.value);
        }
        &self.value
    }
}

impl Painter {
    /// Derives a walking speed from the frame that was painted last, in scene units per second.
    pub fn walking_speed(&mut self, renderer: &Renderer) -> f64 {
        walking_speed(self.aovs.get(|aovs| renderer.aovs_into(aovs))).into()
    }

    /// Returns the distance of what the middle of the last frame shows; infinite if that is nothing.
    pub fn distance_in_the_middle(&mut self, renderer: &Renderer) -> f32 {
        let aovs = self.aovs.get(|aovs| renderer.aovs_into(aovs));
        let [x, y] = aovs.resolution().map(|side| side / 2);
        aovs.pixel(x, y).distance
    }

    /// Fills the frame's pixels and its minimap.
    pub fn paint(&mut self, input: &FrameInput, frame: &mut Frame) {
        let FrameInput { renderer, scene, accumulation, controls } = *input;
        let Accumulation { film, pose, pose_shown, progressive, .. } = accumulation;
        // Switching reprojection on at a resting camera counts as a new pose.
        let known = *pose_shown && (self.reprojected || !controls.reprojection);
        self.reprojected = controls.reprojection;
        if !known {
            (self.aovs.valid, self.denoiser_aovs.valid, self.costs.valid) = (false, false, false);
        }
        frame.resize(film.resolution());
        film.picture_into(&mut self.mean);
        let first = controls.reprojection && !known;
        let samples = film.samples().max(1);
        if first {
            // Samples that stay in the film must not enter the history as well.
            let own = if *progressive { 0 } else { samples };
            let aovs = self.aovs.get(|aovs| renderer.aovs_into(aovs));
            self.history.reproject(&self.mean, own, aovs, renderer.camera());
        }
        if !controls.reprojection {
            // The history belongs to an earlier camera.
            self.history.reset();
        } else if known || *progressive {
            self.history.blend_static(&self.mean, samples);
        }
        match controls.mode {
            DisplayMode::Picture => self.paint_picture(input, samples, &mut frame.pixels),
            mode => self.paint_mode(mode, input, samples, &mut frame.pixels),
        }
        frame.inset.clear();
        if controls.minimap {
            let aspect = f64::from(frame.width) / f64::from(frame.height);
            let minimap = self.minimap.get_or_insert_with(|| Minimap::new(scene));
            minimap.draw_into(&pose.camera, aspect, &mut frame.inset);
        }
    }

    fn paint_picture(&mut self, input: &FrameInput, samples: u32, pixels: &mut [u32]) {
        let FrameInput { renderer, controls, .. } = input;
        let (mut shown, mut behind) = (&self.mean, Samples::Same(samples));
        if controls.reprojection {
            (shown, behind) = (self.history.shown(), Samples::Each(self.history.counts()));
        }
        if controls.denoiser {
            let aovs = self.aovs.get(|aovs| renderer.aovs_into(aovs));
            let aovs = self.denoiser_aovs.get(|edges| renderer.denoiser_aovs_into(aovs, edges));
            shown = self.denoiser.filter(shown, behind, aovs);
        }
        match controls.filter {
            Filter::None => {}
            Filter::Blur => shown = self.blur.filter(shown),
            Filter::Fxaa => shown = self.fxaa.filter(shown, &controls.tone),
        }
        write(&controls.tone, shown, pixels);
    }

    fn paint_mode(&mut self, mode: DisplayMode, input: &FrameInput, samples: u32, pixels: &mut [u32]) {
        let renderer = input.renderer;
        let &Settings { max_bounces, lanes, .. } = renderer.settings();
        let aovs = self.aovs.get(|aovs| renderer.aovs_into(aovs));
        if matches!(mode, DisplayMode::Bounces | DisplayMode::Lanes) {
            renderer.path_shapes_into(samples - 1, &mut self.shapes);
        }
        match mode {
            DisplayMode::Picture => {}
            DisplayMode::Normals => fill_from_aovs(pixels, aovs, display_mode::normal),
            DisplayMode::Albedo => fill_from_aovs(pixels, aovs, display_mode::albedo),
            DisplayMode::Depth => {
                let range = display_mode::depth_range(aovs, &mut self.distances);
                fill_from_aovs(pixels, aovs, |aov| display_mode::depth(aov, range));
            }
            DisplayMode::Barycentrics => fill_from_aovs(pixels, aovs, display_mode::barycentrics),
            DisplayMode::Lambert => {
                let light = display_mode::light_behind(&input.accumulation.pose.camera);
                fill_from_aovs(pixels, aovs, |aov| display_mode::n_dot_l(aov, light));
            }
            DisplayMode::Bounces => {
                fill(pixels, &self.shapes.pixels, |shape| display_mode::bounces(shape, max_bounces));
            }
            DisplayMode::Lanes => {
                fill(pixels, &self.shapes.pixels, |shape| display_mode::lanes(shape, lanes));
            }
            DisplayMode::Cost => {
                let costs = self.costs.get(|costs| renderer.costs_into(costs));
                let most = costs.pixels.iter().map(display_mode::tests).max().unwrap_or_default();
                fill(pixels, &costs.pixels, |cost| display_mode::cost(cost, most));
                self.most_tests = most;
            }
            DisplayMode::Samples if input.controls.reprojection => {
                fill(pixels, self.history.counts(), |&count| display_mode::samples(count));
            }
            DisplayMode::Samples => pixels.fill(display_mode::samples(samples as f32)),
        }
    }
}

fn fill<T>(pixels: &mut [u32], values: &[T], color: impl Fn(&T) -> u32) {
    pixels.iter_mut().zip(values).for_each(|(pixel, value)| *pixel = color(value));
}

fn fill_from_aovs(pixels: &mut [u32], aovs: &Aovs, color: impl Fn(&AovSample) -> u32) {
    let width = aovs.resolution()[0] as usize;
    for (at, pixel) in pixels.iter_mut().enumerate() {
        *pixel = color(&aovs.pixel((at % width) as u32, (at / width) as u32));
    }
}

/// Tone-maps a picture to display pixels.
fn write(tone: &Tone, picture: &Picture, words: &mut [u32]) {
    let width = picture.width as usize;
    rows::each(words, width, |y, words| tone.words(&picture.pixels[y * width..][..width], words));
}

#[cfg(test)]
mod tests {
    use super::*;
    use octray_formats::scene::load;
    use std::time::Instant;

    /// A viewer without events, which paints frames.
    struct TestViewer {
        scene: Loaded,
        renderer: Renderer,
        accumulation: Accumulation,
        controls: Controls,
        painter: Painter,
    }

    impl TestViewer {
        fn new() -> Self {
            let scene = Loaded::from(load("builtin:cornell-spheres").unwrap());
            let renderer = Renderer::new(&scene, Settings { resolution: [24, 16], ..Settings::of(&scene) });
            let accumulation = Accumulation::new(&renderer, &scene);
            let controls = Controls::new(renderer.settings(), Tone::default());
            Self { scene, renderer, accumulation, controls, painter: Painter::default() }
        }
        /// Sets the camera's field of view. The same one again is a resting camera.
        fn go(&mut self, field: f32) {
            let mut pose = self.accumulation.pose;
            pose.camera.vertical_fov = field;
            self.accumulation.set_pose(&mut self.renderer, pose);
        }
        /// Adds samples and paints a frame.
        fn paint(&mut self, samples: u32) -> Vec<u32> {
            let Self { scene, renderer, accumulation, controls, painter } = self;
            renderer.add_samples(&mut accumulation.film, samples);
            let mut frame = Frame::default();
            painter.paint(&FrameInput { renderer, scene, accumulation, controls }, &mut frame);
            accumulation.frame_shown(Instant::now(), None);
            frame.pixels
        }
        /// Returns the pixels of the film's mean, without history.
        fn mean(&self) -> Vec<u32> {
            let picture = self.accumulation.film.picture();
            let mut words = vec![0; picture.pixels.len()];
            Tone::default().words(&picture.pixels, &mut words);
            words
        }
    }

    #[test]
    fn history_shows_while_the_camera_moves_and_vanishes_at_rest() {
        let mut viewer = TestViewer::new();
        assert_eq!(viewer.paint(4), viewer.mean(), "no history yet");
        assert_eq!(viewer.painter.history.counts()[0], 4.0);
        assert_eq!(viewer.paint(4), viewer.mean(), "no sample counts twice");
        assert_eq!(viewer.painter.history.counts()[0], 8.0);
        viewer.go(38.5);
        assert_ne!(viewer.paint(1), viewer.mean());
        assert!(viewer.painter.history.counts().iter().any(|&count| count > 1.0));
        viewer.go(38.5);
        assert_ne!(viewer.paint(1), viewer.mean());
        assert_eq!(viewer.paint(63), viewer.mean());
    }

    #[test]
    fn modes_and_the_denoiser_belong_to_the_present_camera() {
        for (mode, denoiser) in
            [(DisplayMode::Normals, false), (DisplayMode::Cost, false), (DisplayMode::Picture, true)]
        {
            let [mut walked, mut fresh] = [(); 2].map(|()| TestViewer::new());
            for viewer in [&mut walked, &mut fresh] {
                viewer.controls.reprojection = false;
                (viewer.controls.mode, viewer.controls.denoiser) = (mode, denoiser);
            }
            let home = walked.paint(1);
            // The seed of a moving camera comes from the number of frames.
            fresh.accumulation.summary.frames = 1;
            walked.go(20.0);
            fresh.go(20.0);
            let there = walked.paint(1);
            assert!(there != home && there == fresh.paint(1), "{mode:?}");
        }
    }

    /// The blended history stands for more samples than the film, and the denoiser must know how many.
    #[test]
    fn the_denoiser_gets_the_sample_counts_of_the_history() {
        let mut viewer = TestViewer::new();
        viewer.controls.denoiser = true;
        viewer.paint(64);
        viewer.go(38.5);
        let shown = viewer.paint(1);
        let Painter { history, denoiser, denoiser_aovs: PerCamera { value: aovs, .. }, .. } =
            &mut viewer.painter;
        let mut words = vec![0; shown.len()];
        let each = denoiser.filter(history.shown(), Samples::Each(history.counts()), aovs);
        write(&Tone::default(), each, &mut words);
        assert!(shown == words);
        write(&Tone::default(), denoiser.filter(history.shown(), Samples::Same(1), aovs), &mut words);
        assert!(shown != words, "it matters here");
    }

    #[test]
    fn history_is_discarded_without_reprojection() {
        let mut viewer = TestViewer::new();
        viewer.paint(4);
        viewer.controls.reprojection = false;
        viewer.go(20.0);
        assert_eq!(viewer.paint(1), viewer.mean());
        viewer.go(20.0);
        assert_eq!(viewer.paint(2), viewer.mean());
        viewer.controls.reprojection = true;
        assert_eq!(viewer.paint(1), viewer.mean(), "no ghost of the pose at which it was switched off");
        assert_eq!(viewer.paint(1), viewer.mean());
        viewer.go(20.5);
        assert_ne!(viewer.paint(1), viewer.mean(), "from here on it remembers reload");
    }
}
