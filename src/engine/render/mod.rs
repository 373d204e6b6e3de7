//! Renders a scene into a film, with tiles as rayon jobs.

pub mod aovs;
mod methods;
mod settings;

pub use methods::{Methods, SphereChoice, TraversalChoice, TriangleChoice, features_of};
pub use settings::{LaneChoice, PipelineChoice, Settings};

use crate::buffers::{Buffers, Features};
use crate::camera::{MAX_PIXELS, PreparedCamera, Tile};
use crate::film::{Film, TileSums};
use crate::integrate::stats::Stats;
use crate::integrate::{MAX_TILES, Pipeline, Scratch, TraceContext, generate, pipeline_for, trace_path};
use crate::lane::{F32x8, Native, WIDTHS};
use crate::lights::Lights;
use crate::math::{Hit, MISS};
use crate::path_vertex::PathVertex;
use crate::primitives::PrimitiveTables;
use crate::rays::{Candidates, Geometry, Kind, PrimitiveTests, Structure};
use crate::scene::{Camera, Scene};
use crate::threads::Threads;
use rayon::prelude::*;
use std::sync::Arc;

/// The largest product of primitives and tiles for which [`Candidates`] are found: some tens of milliseconds.
/// With more, linear traversal is too slow to render with anyway.
const MAX_CULLING_TESTS: usize = 4_000_000;
/// The largest number of primitives for which they are found again for every frame of a moving camera. This
/// takes 1 to 4 % of a frame of one sample, and saves 0 to 25 % of it, more for larger pictures.
const MAX_CULLED_MOVING: usize = 256;

/// Finds the primitives that each tile's primary rays can hit; leaves `visible` empty if there are more
/// primitives than [`MAX_CULLING_TESTS`] allows, or if the rays have several origins.
fn find_visible(
    visible: &mut Vec<Candidates>,
    geometry: &Geometry,
    camera: &PreparedCamera,
    settings: &Settings,
) {
    let tiles = || Tile::cover(settings.resolution, settings.tile_size);
    let (primitives, count) = (geometry.len(), tiles().count());
    if primitives * count > MAX_CULLING_TESTS || camera.common_origin().is_none() {
        visible.clear();
        return;
    }
    visible.resize_with(count, Candidates::default);
    for (tile, visible) in tiles().zip(visible) {
        geometry.find_in_frustum(visible, &camera.view_frustum([tile.x, tile.y], [tile.width, tile.height]));
    }
}

/// The number of parts of a picture per thread, if it has enough tiles: no thread waits long for the last.
const PARTS_PER_THREAD: usize = 16;

fn check_resolution(resolution: [u32; 2]) {
    let fits = resolution.iter().all(|side| (1..=crate::scene::MAX_SIDE).contains(side));
    assert!(fits, "resolution {resolution:?}");
}

/// Returns the pipeline of a context and its features.
fn pipeline_of(context: &TraceContext, settings: &Settings) -> (Features, Pipeline) {
    let needs = match settings.pipeline {
        PipelineChoice::Auto => context.buffers.needs,
        PipelineChoice::General => Features::ALL,
    };
    pipeline_for(needs, settings.lanes)
}

/// A primary ray and its hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimaryHit {
    /// The pixel's column.
    pub x: u32,
    /// The pixel's row.
    pub y: u32,
    /// The origin of the ray.
    pub origin: [f32; 3],
    /// The ray's direction, of unit length.
    pub direction: [f32; 3],
    /// The distance, infinite for a miss.
    pub t: f32,
    /// The index of the primitive, [`crate::math::MISS`] for a miss.
    pub primitive: u32,
    /// The barycentric weights of a triangle's second and third vertex; 0 elsewhere.
    pub weights: [f32; 2],
}

/// Observes progress and cancels rendering. Its methods are called from all threads at once. `()` observes
/// nothing and never cancels.
pub trait RenderObserver: Sync {
    /// Tests whether to stop. Called before each sample of a tile, or of several that are traced together;
    /// once it returns true, no more samples are taken.
    fn is_cancelled(&self) -> bool;
    /// Called after each such sample with the number of its pixels and of its rays.
    fn sample_done(&self, pixels: usize, rays: u64);
}

impl RenderObserver for () {
    fn is_cancelled(&self) -> bool {
        false
    }
    fn sample_done(&self, _pixels: usize, _rays: u64) {}
}

/// A scene prepared for rendering, and the threads that render it.
pub struct Renderer {
    settings: Settings,
    /// The geometry, if candidates are found again for every camera: see [`MAX_CULLED_MOVING`].
    geometry: Option<Geometry>,
    context: TraceContext,
    features: Features,
    pipeline: Pipeline,
    threads: Threads<Box<Scratch>>,
}

impl Renderer {
    /// Flattens the scene into buffers and starts the threads.
    ///
    /// # Panics
    /// If the settings are outside their documented ranges, their intersection methods are not the robust
    /// ones ([`Renderer::with_tests`]), or the system refuses threads.
    pub fn new(scene: &Scene, settings: Settings) -> Self {
        Self::with_tests(scene, settings, None)
    }
    /// Creates a renderer with the tests of the settings' intersection methods, or `None` for the robust
    /// methods. The engine has no others; `octray_laboratory::methods::renderer` has.
    ///
    /// # Panics
    /// In the cases of [`Renderer::new`], and if there are tests although the methods are robust.
    pub fn with_tests(scene: &Scene, settings: Settings, tests: Option<Arc<dyn PrimitiveTests>>) -> Self {
        let Settings { resolution, tile_size, lanes, threads, .. } = settings;
        check_resolution(resolution);
        let tile_pixels = tile_size[0] as usize * tile_size[1] as usize;
        assert!((1..=MAX_PIXELS).contains(&tile_pixels), "tile size {tile_size:?}");
        assert!(WIDTHS.contains(&lanes), "{lanes} lanes");
        let are_given = tests.is_none() == settings.methods.are_robust();
        assert!(
            are_given,
            "tests of primitives for {:?}: build the renderer by the laboratory",
            settings.methods
        );
        let camera = PreparedCamera::new(&scene.camera, resolution);
        let lights = Lights::new(scene, settings.methods.lights);
        let geometry = scene.geometry();
        let structure = settings.methods.structure(scene, &geometry, lanes, &lights, tests);
        let mut visible = Vec::new();
        if structure.accepts_candidates() {
            find_visible(&mut visible, &geometry, &camera, &settings);
        }
        let is_kept = structure.accepts_candidates() && geometry.len() <= MAX_CULLED_MOVING;
        // A large geometry is freed before the buffers take its memory.
        let geometry = is_kept.then_some(geometry);
        let mut buffers = Buffers::new(scene);
        let primitives = PrimitiveTables::new(scene, |number| lights.sampled_as(number));
        buffers.needs = buffers.needs.with(lights.needs()).with(features_of(scene)).with(camera.needs());
        let context = TraceContext {
            visible,
            buffers,
            primitives,
            lights,
            structure,
            camera,
            width: resolution[0],
            max_bounces: settings.max_bounces,
            seed: settings.seed,
            sampler: settings.methods.sampler,
        };
        let (features, pipeline) = pipeline_of(&context, &settings);
        Self { settings, geometry, context, features, pipeline, threads: Threads::new(threads, Scratch::new) }
    }
    /// Returns the settings of the rendering.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
    /// Changes the seed, for pictures that differ only in their random numbers.
    pub fn set_seed(&mut self, seed: u32) {
        self.settings.seed = seed;
        self.context.seed = seed;
    }
    /// Changes the number of bounces.
    pub fn set_bounces(&mut self, max_bounces: u32) {
        self.settings.max_bounces = max_bounces;
        self.context.max_bounces = max_bounces;
    }
    /// Changes camera, resolution and number of bounces. Earlier films fit only if the resolution is the
    /// same.
    ///
    /// # Panics
    /// If the resolution is outside its documented range.
    pub fn set_view(&mut self, camera: &Camera, resolution: [u32; 2], max_bounces: u32) {
        check_resolution(resolution);
        self.set_bounces(max_bounces);
        self.settings.resolution = resolution;
        let context = &mut self.context;
        context.camera = PreparedCamera::new(camera, resolution);
        context.width = resolution[0];
        let needs = context.buffers.needs.without(Features::RAY_ORIGINS);
        context.buffers.needs = needs.with(context.camera.needs());
        (self.features, self.pipeline) = pipeline_of(context, &self.settings);
        match &self.geometry {
            Some(geometry) => {
                find_visible(&mut context.visible, geometry, &context.camera, &self.settings);
            }
            None => context.visible.clear(),
        }
    }
    /// Returns the geometry in the form that rays are traced through.
    pub fn structure(&self) -> &Structure {
        &self.context.structure
    }
    /// Returns the prepared camera.
    pub fn camera(&self) -> &PreparedCamera {
        &self.context.camera
    }
    /// Returns the features that the pipeline is compiled with: those that the scene needs, or more.
    pub fn features(&self) -> Features {
        self.features
    }
    /// Returns the features that the scene needs.
    pub fn needs(&self) -> Features {
        self.context.buffers.needs
    }
    /// Returns an empty film of this renderer's resolution.
    pub fn film(&self) -> Film {
        Film::new(self.settings.resolution, self.settings.tile_size)
    }
    /// Returns an empty film that also estimates the variance of its samples, for [`crate::adaptive`].
    pub fn film_with_noise(&self) -> Film {
        self.film().with_noise()
    }
    /// Calls `run` on the renderer's threads. One call around many of [`Renderer::add_samples`] saves waking
    /// the threads for each.
    pub fn on_threads<R: Send>(&self, run: impl FnOnce() -> R + Send) -> R {
        self.threads.run(run)
    }
    /// Calls `run` on the renderer's threads with mutable access to the renderer. It occupies one of the
    /// threads, which takes its share of the work that `run` starts.
    pub fn hold<R: Send>(&mut self, run: impl FnOnce(&mut Self) -> R + Send) -> R {
        self.threads.handle().run(|| run(self))
    }
    /// Starts statistics. They cost some time and change no bit of the picture.
    pub fn start_stats(&self) {
        self.threads.for_each_memory(|scratch| scratch.start_stats());
    }
    /// Ends statistics and returns them, summed over all threads.
    pub fn take_stats(&self) -> Stats {
        let mut sum = Stats::default();
        self.threads.for_each_memory(|scratch| sum += &scratch.take_stats());
        sum
    }
    /// Adds `samples` samples to every pixel; their numbers follow those of earlier samples.
    pub fn add_samples(&self, film: &mut Film, samples: u32) {
        self.add_samples_observed(film, samples, &());
    }
    /// Takes samples until every pixel has `samples` more than [`Film::samples`], unless `observer` cancels.
    /// After cancellation tiles differ in their numbers of whole samples; each pixel has the bits that its
    /// own number of samples gives in any other film.
    pub fn add_samples_observed(&self, film: &mut Film, samples: u32, observer: &dyn RenderObserver) {
        let goal = film.samples() + samples;
        self.sample_tiles_to(film, |_, _| goal, observer);
    }
    /// Takes samples until each tile has `goal(tile number, samples so far)` of them, unless `observer`
    /// cancels. A tile that has more keeps them.
    pub fn sample_tiles_to(
        &self,
        film: &mut Film,
        goal: impl Fn(usize, u32) -> u32 + Sync,
        observer: &dyn RenderObserver,
    ) {
        let together = film.tiles.len() / (PARTS_PER_THREAD * self.threads.count());
        let together = together.clamp(1, MAX_TILES);
        let add = |sums: &mut [TileSums]| self.add_to_tiles(sums, &goal, observer);
        film.rays += match self.threads.is_single() {
            true => film.tiles.chunks_mut(together).map(add).sum::<u64>(),
            false => self.threads.run(|| film.tiles.par_chunks_mut(together).map(add).sum::<u64>()),
        };
    }

    /// Returns the primary rays of one sample of every pixel, and their first hits, tile by tile. Paths may
    /// pass these hits.
    pub fn primary_hits(&self, sample: u32) -> Vec<PrimaryHit> {
        let mut scratch = Scratch::new();
        let ranges = self.context.primitives.ranges;
        let on_triangle = |primitive: u32| primitive != MISS && ranges.are_of_kind(Kind::Triangle, primitive);
        let of_tile = |tile: Tile| {
            let paths = match self.settings.lanes {
                1 => generate::<f32>(&self.context, (0, tile), sample, 0, &mut scratch),
                8 => generate::<F32x8>(&self.context, (0, tile), sample, 0, &mut scratch),
                _ => generate::<Native>(&self.context, (0, tile), sample, 0, &mut scratch),
            };
            let hit = |(at, [x, y]): (usize, [u32; 2])| {
                let ray = self.context.primary_ray::<f32, { Features::ALL.0 }>(&scratch.queue, at);
                let Hit { t, primitive, u, v } = scratch.queue.hit::<f32>(at);
                PrimaryHit {
                    x,
                    y,
                    origin: ray.origin.get(0).to_array(),
                    direction: ray.direction.get(0).to_array(),
                    t,
                    primitive,
                    weights: if on_triangle(primitive) { [u, v] } else { [0.0; 2] },
                }
            };
            paths.zip(tile.places()).map(hit).collect::<Vec<_>>()
        };
        Tile::cover(self.settings.resolution, self.settings.tile_size).flat_map(of_tile).collect()
    }

    /// Returns the path of one sample of a pixel of the picture, traced by the scalar integrator.
    pub fn path(&mut self, pixel: [u32; 2], sample: u32) -> Vec<PathVertex<f32>> {
        trace_path(&mut self.context, pixel, sample)
    }

    /// Takes samples until each of up to [`MAX_TILES`] tiles has `goal` of them, and returns the number of
    /// rays. Neighbours in this order with equal numbers and goals are traced together.
    fn add_to_tiles(
        &self,
        tiles: &mut [TileSums],
        goal: &impl Fn(usize, u32) -> u32,
        observer: &dyn RenderObserver,
    ) -> u64 {
        let goal = |sums: &TileSums| goal(sums.tile.number, sums.samples);
        let alike = |a: &TileSums, b: &TileSums| (a.samples, goal(a)) == (b.samples, goal(b));
        let runs = tiles.chunk_by_mut(alike);
        runs.map(|tiles| self.add_together(tiles, goal(&tiles[0]), observer)).sum()
    }

    /// Takes the samples of tiles with equal numbers of samples; returns the number of rays.
    fn add_together(&self, tiles: &mut [TileSums], goal: u32, observer: &dyn RenderObserver) -> u64 {
        let mut scratch = self.threads.local();
        let mut traced = [tiles[0].tile; MAX_TILES];
        traced.iter_mut().zip(&*tiles).for_each(|(tile, sums)| *tile = sums.tile);
        let traced = &traced[..tiles.len()];
        let pixels = traced.iter().map(Tile::pixels).sum();
        let mut total = 0;
        while tiles[0].samples < goal && !observer.is_cancelled() {
            let rays = (self.pipeline)(&self.context, traced, tiles[0].samples, &mut scratch);
            if self.settings.clamp < f32::INFINITY {
                scratch.radiance.clamp(traced.len(), self.settings.clamp);
            }
            for (number, sums) in tiles.iter_mut().enumerate() {
                sums.add(scratch.radiance.of_tile(number));
            }
            scratch.observer.begin(None);
            observer.sample_done(pixels, rays);
            total += rays;
        }
        total
    }
}
