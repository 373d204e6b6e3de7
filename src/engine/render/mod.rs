//! From a scene to a film: tiles as rayon jobs.
//!
//! For: [`Renderer`], and [`Watch`] to follow it and stop it; [`survey`] tells what pixels see and take besides light. May import: `film` and everything above it. Must never know: files, terminals, clocks.

pub mod survey;

use crate::buffers::{Buffers, Features};
use crate::camera::Pinhole;
use crate::choice::choices;
use crate::film::{Film, TileSums};
use crate::integrate::queue::{MAX_PIXELS, Work};
use crate::integrate::stats::Stats;
use crate::integrate::{Pipeline, Tile, World, generate as primary, pipeline_for};
use crate::lane::F32x8;
use crate::math::{Hit, MISS};
use crate::scene::{Camera, Scene};
use crate::threads::Threads;
use crate::traverse::{Methods, Primitives, Visible, linear};
use rayon::prelude::*;

choices! {
    /// Which of the pipelines in [`crate::integrate`] renders a scene. The general one measures and tests the gain
    /// of leaving features out.
    pub enum PipelineChoice {
        #[default]
        Needed = "needed", "The pipeline compiled for the smallest set of features that holds the scene's.";
        General = "general", "The pipeline with every feature.";
    }
}

/// What decides a picture besides the scene, and how it is computed: `lanes`, `threads`, `tile_size` and `pipeline` change no bit (but
/// tiles are the blocks by which [`crate::adaptive`] decides how many samples to take).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels: width, height.
    pub resolution: [u32; 2],
    /// Scattering events allowed on a path.
    pub max_bounces: u32,
    pub seed: u32,
    pub methods: Methods,
    /// 1 (scalar path) or 8 (packets).
    pub lanes: usize,
    /// Worker threads, at least 1.
    pub threads: usize,
    /// Pixels of a tile: width, height; at most [`MAX_PIXELS`] together.
    pub tile_size: [u32; 2],
    pub pipeline: PipelineChoice,
    /// The most radiance that a sample may bring to a channel; infinite without a limit, as by default. A limit takes light away: the
    /// picture is darker than the truth by what it cuts off.
    pub clamp: f32,
}

impl Settings {
    /// The scene's own resolution and bounces, packets, and one thread.
    pub fn of(scene: &Scene) -> Self {
        Self {
            resolution: scene.resolution,
            max_bounces: scene.max_bounces,
            seed: 0,
            methods: Methods::default(),
            lanes: 8,
            threads: 1,
            tile_size: Self::TILE_SIZE,
            pipeline: PipelineChoice::default(),
            clamp: f32::INFINITY,
        }
    }
    /// Rows of whole packets, and a queue that stays in the first-level cache.
    pub const TILE_SIZE: [u32; 2] = [16, 16];
}

/// Most primitives times tiles for which [`Visible`] is found: some tens of milliseconds. Beyond it, testing everything is no way to
/// render anyhow.
const MOST_TO_CULL: usize = 4_000_000;
/// Most primitives for which it is found anew for a camera that moves on with every frame. Finding it takes 1 to 4 % of a frame of one sample,
/// and saves 0 to 25 % of it, the more the larger the picture is.
const MOST_TO_CULL_MOVING: usize = 256;

/// Finds what each tile's primary rays can meet; nothing where that is unknown, or there are more primitives than `most`, or too many to find out.
fn find_visible(
    visible: &mut Vec<Visible>,
    scene: &Scene,
    camera: &Pinhole,
    settings: &Settings,
    most: usize,
) {
    let tiles = || Tile::cover(settings.resolution, settings.tile_size);
    let (primitives, count) = (scene.spheres.len() + scene.triangles.len(), tiles().count());
    let too_many = primitives > most || primitives * count > MOST_TO_CULL;
    if !settings.methods.keep_to_their_primitives() || too_many {
        visible.clear();
        return;
    }
    visible.resize_with(count, Visible::default);
    for (tile, visible) in tiles().zip(visible) {
        visible.find(scene, &camera.view_frustum([tile.x, tile.y], [tile.width, tile.height]));
    }
}

fn check_resolution(resolution: [u32; 2]) {
    let fits = resolution.iter().all(|side| (1..=crate::scene::MAX_SIDE).contains(side));
    assert!(fits, "resolution {resolution:?}");
}

/// A primary ray and its answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimaryHit {
    pub x: u32,
    pub y: u32,
    pub origin: [f32; 3],
    pub direction: [f32; 3],
    /// Infinite for a miss.
    pub t: f32,
    /// [`crate::math::MISS`] for a miss.
    pub primitive: u32,
    /// Barycentric weights of a triangle's second and third vertex; 0 elsewhere.
    pub weights: [f32; 2],
}

/// What looks on while samples are taken, from all threads at once. `()` does not care.
pub trait Watch: Sync {
    /// Asked before each sample of a tile: shall no more be taken?
    fn stop(&self) -> bool;
    /// Told after each sample of a tile: so many pixels, and the rays that it took.
    fn done(&self, pixels: usize, rays: u64);
}

impl Watch for () {
    fn stop(&self) -> bool {
        false
    }
    fn done(&self, _pixels: usize, _rays: u64) {}
}

/// A scene made ready for tracing.
pub struct Renderer {
    settings: Settings,
    world: World,
    features: Features,
    pipeline: Pipeline,
    threads: Threads<Box<Work>>,
}

impl Renderer {
    /// Flattens the scene into buffers and starts the threads.
    ///
    /// # Panics
    /// If the settings are outside their documented ranges, or the system refuses threads.
    pub fn new(scene: &Scene, settings: Settings) -> Self {
        let Settings { resolution, tile_size, lanes, threads, .. } = settings;
        check_resolution(resolution);
        let tile_pixels = tile_size[0] as usize * tile_size[1] as usize;
        assert!((1..=MAX_PIXELS).contains(&tile_pixels), "tile size {tile_size:?}");
        assert!(lanes == 1 || lanes == 8, "{lanes} lanes");
        let camera = Pinhole::new(&scene.camera, resolution);
        let primitives = Primitives::new(scene, settings.methods, lanes);
        let mut visible = Vec::new();
        if primitives.hierarchy().is_none() {
            find_visible(&mut visible, scene, &camera, &settings, usize::MAX);
        }
        let mut buffers = Buffers::with_lights(scene, settings.methods.lights);
        buffers.needs = buffers.needs.with(linear::features_of(scene));
        let world = World {
            visible,
            buffers,
            primitives,
            camera,
            width: resolution[0],
            max_bounces: settings.max_bounces,
            seed: settings.seed,
            sampler: settings.methods.sampler,
        };
        let needs = match settings.pipeline {
            PipelineChoice::Needed => world.buffers.needs,
            PipelineChoice::General => Features::ALL,
        };
        let (features, pipeline) = pipeline_for(needs, lanes);
        Self { settings, world, features, pipeline, threads: Threads::new(threads, Work::new) }
    }
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
    /// Other random numbers from here on: for pictures that differ in nothing else.
    pub fn set_seed(&mut self, seed: u32) {
        self.settings.seed = seed;
        self.world.seed = seed;
    }
    /// Another camera, resolution and number of bounces from here on, for a renderer that was made for `scene`. Films made before
    /// fit only where the resolution is the same.
    ///
    /// # Panics
    /// If the resolution is outside its documented range.
    pub fn set_view(&mut self, scene: &Scene, camera: &Camera, resolution: [u32; 2], max_bounces: u32) {
        check_resolution(resolution);
        (self.settings.resolution, self.settings.max_bounces) = (resolution, max_bounces);
        let world = &mut self.world;
        world.camera = Pinhole::new(camera, resolution);
        (world.width, world.max_bounces) = (resolution[0], max_bounces);
        if world.primitives.hierarchy().is_none() {
            find_visible(&mut world.visible, scene, &world.camera, &self.settings, MOST_TO_CULL_MOVING);
        }
    }
    /// Where pixels look.
    pub fn camera(&self) -> &Pinhole {
        &self.world.camera
    }
    /// What its pipeline has: the scene's needs, and what shares the pipeline with them.
    pub fn features(&self) -> Features {
        self.features
    }
    /// What the scene needs of its pipeline.
    pub fn needs(&self) -> Features {
        self.world.buffers.needs
    }
    /// An empty film for this renderer's resolution.
    pub fn film(&self) -> Film {
        Film::new(self.settings.resolution, self.settings.tile_size)
    }
    /// An empty film that sums how far samples differ, as [`crate::adaptive`] needs it.
    pub fn film_with_noise(&self) -> Film {
        self.film().with_noise()
    }
    /// Runs something on the renderer's threads. Called around many [`Renderer::add_samples`], it saves waking them for each.
    pub fn on_threads<R: Send>(&self, run: impl FnOnce() -> R + Send) -> R {
        self.threads.run(run)
    }
    /// Runs something on the renderer's threads with the renderer in hand, which may change it. One of the threads is busy with it: it takes its
    /// part in the work that it starts.
    pub fn hold<R: Send>(&mut self, run: impl FnOnce(&mut Self) -> R + Send) -> R {
        self.threads.handle().run(|| run(self))
    }
    /// Notes from here on what samples take, which costs some time of its own and no bit of the picture.
    pub fn start_stats(&self) {
        self.threads.each(|work| work.start_stats());
    }
    /// What was noted, summed over all threads; from here on no more is.
    pub fn take_stats(&self) -> Stats {
        let mut sum = Stats::default();
        self.threads.each(|work| sum += &work.take_stats());
        sum
    }
    /// Adds `samples` samples to every pixel; they are numbered on from those it has had.
    pub fn add_samples(&self, film: &mut Film, samples: u32) {
        self.add_samples_watched(film, samples, &());
    }
    /// Brings every pixel to `samples` more than [`Film::samples`], unless `watch` stops it before. Then tiles are left with different
    /// numbers of samples, all of them whole: a pixel's bits are those that its own number gives it in any other film.
    pub fn add_samples_watched(&self, film: &mut Film, samples: u32, watch: &dyn Watch) {
        let goal = film.samples() + samples;
        self.bring_tiles_watched(film, |_, _| goal, watch);
    }
    /// Brings each tile to the samples that `goal` says, given its number and the samples it has had, unless `watch` stops it before.
    /// A tile that has had more keeps them.
    pub fn bring_tiles_watched(
        &self,
        film: &mut Film,
        goal: impl Fn(usize, u32) -> u32 + Sync,
        watch: &dyn Watch,
    ) {
        let add = |sums: &mut TileSums| self.add_to_tile(sums, goal(sums.tile.number, sums.samples), watch);
        film.rays += match self.threads.alone() {
            true => film.tiles.iter_mut().map(add).sum::<u64>(),
            false => self.threads.run(|| film.tiles.par_iter_mut().map(add).sum::<u64>()),
        };
    }

    /// The primary rays of one sample of every pixel, and what they hit, tile by tile.
    pub fn primary_hits(&self, sample: u32) -> Vec<PrimaryHit> {
        let mut work = Work::new();
        let spheres = self.world.buffers.spheres.len() as u32;
        let on_triangle = |primitive: u32| primitive != MISS && primitive >= spheres;
        let of_tile = |tile: Tile| {
            let count = match self.settings.lanes {
                1 => primary::<f32, { Features::ALL.0 }>(&self.world, tile, sample, &mut work),
                _ => primary::<F32x8, { Features::ALL.0 }>(&self.world, tile, sample, &mut work),
            };
            let slots = 0..count as u32;
            let hit = |slot: u32| {
                let at = slot as usize;
                let (direction, _) = work.queue.primary::<f32>(at);
                let Hit { t, primitive, u, v } = work.queue.hit::<f32>(at);
                PrimaryHit {
                    x: tile.x + slot % tile.width,
                    y: tile.y + slot / tile.width,
                    origin: self.world.camera.origin::<f32>().get(0).to_array(),
                    direction: direction.get(0).to_array(),
                    t,
                    primitive,
                    weights: if on_triangle(primitive) { [u, v] } else { [0.0; 2] },
                }
            };
            slots.map(hit).collect::<Vec<_>>()
        };
        Tile::cover(self.settings.resolution, self.settings.tile_size).flat_map(of_tile).collect()
    }

    /// Takes samples until the tile has had `goal`; returns the rays.
    fn add_to_tile(&self, sums: &mut TileSums, goal: u32, watch: &dyn Watch) -> u64 {
        let mut work = self.threads.own();
        let mut total = 0;
        while sums.samples < goal && !watch.stop() {
            let rays = (self.pipeline)(&self.world, sums.tile, sums.samples, &mut work);
            if self.settings.clamp < f32::INFINITY {
                work.clamp(self.settings.clamp);
            }
            sums.add(work.radiance());
            work.enter(None);
            watch.done(sums.tile.pixels(), rays);
            total += rays;
        }
        total
    }
}
